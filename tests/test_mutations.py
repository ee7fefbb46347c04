"""The table of deliberate faults fits the sources: a fault that cannot be planted says nothing of the tests."""

import ast
from pathlib import Path

import pytest

from tests.mutations import mutations

ROOT = Path(__file__).parents[1]


@pytest.mark.parametrize("file", sorted({mutation.file for mutation in mutations()}))
def test_faults_can_be_planted_and_their_tests_exist(file):
    text = (ROOT / file).read_text()
    faults = [mutation for mutation in mutations() if mutation.file == file]
    assert [str(m) for m in faults if text.count(m.old) != 1 or m.new == m.old] == []
    for fault in faults:
        ast.parse(_changed(text, fault))
    tests = {test.partition("::")[::2] for fault in faults for test in fault.tests}
    missing = [
        (path, name)
        for path, name in tests
        if not (ROOT / path).exists() or (name and f"def {name}(" not in (ROOT / path).read_text())
    ]
    assert missing == []


def _changed(text, fault):
    """What a fault leaves of the functions that it is in: they stand two lines apart, and a whole file takes long."""
    first = text.index(fault.old)
    last = first + len(fault.old)
    begin, end = max(text.rfind("\n\n\n", 0, first), 0), text.find("\n\n\n", last) % (len(text) + 1)
    return text[begin:first] + fault.new + text[last:end]
