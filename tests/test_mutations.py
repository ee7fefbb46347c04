"""The table of deliberate faults fits the sources: a fault that cannot be planted says nothing of the tests."""

import ast
from pathlib import Path

import pytest

from tests.mutations import mutations

ROOT = Path(__file__).parents[1]


@pytest.mark.parametrize("mutation", mutations(), ids=str)
def test_a_fault_can_be_planted_and_its_tests_exist(mutation):
    text = (ROOT / mutation.file).read_text()
    assert text.count(mutation.old) == 1 and mutation.new != mutation.old
    ast.parse(text.replace(mutation.old, mutation.new))
    for test in mutation.tests:
        file, _, name = test.partition("::")
        assert (ROOT / file).exists()
        assert not name or f"def {name}(" in (ROOT / file).read_text()
