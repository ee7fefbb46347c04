"""The nightly run, with quick commands in place of the slow ones."""

import re
import sys
from pathlib import Path

import pytest

from tests import nightly


def python(program):
    return (sys.executable, "-c", program)


GOOD, BAD = python("print('fine')"), python("import sys; print('no', file=sys.stderr); sys.exit(3)")


def test_a_check_that_fails_stops_no_other_and_the_whole(tmp_path, capsys):
    logs = tmp_path / "results" / "nightly"
    assert nightly.main({"first": GOOD, "bad": BAD, "absent": ("no-such-program",), "last": GOOD}, logs) == 1
    table = [line.split() for line in capsys.readouterr().out.splitlines() if str(logs) in line]
    assert [(row[0], row[1]) for row in table] == [
        ("first", "passed"), ("bad", "FAILED"), ("absent", "FAILED"), ("last", "passed"),
    ]  # fmt: skip
    assert [Path(row[-1]).read_text() for row in table[:2]] == ["fine\n", "no\n"]
    assert "no-such-program" in (logs / "absent.log").read_text()


def test_all_passed_is_0(tmp_path):
    assert nightly.main({"good": GOOD}, tmp_path) == 0


@pytest.mark.parametrize("name", nightly.TARGETS)
def test_every_target_is_in_the_makefile(name):
    assert re.search(rf"^{name}:", (nightly.ROOT / "Makefile").read_text(), re.M)
