"""Columns of numbers: whatever ends a line, none is lost."""

import tracemalloc

import numpy as np
import pytest

from pipeline.bridge.realizations import COLUMNS
from pipeline.study import columns
from pipeline.study.attachments import Attachment
from solver.errors import InputError

READ = [
    *COLUMNS.values(),
    ("time", "Fx", "Fz"),
    ("velocity", "force"),
    ("position", "velocity", "force"),
    ("amplitude",),
]
MARKS = ["\n", "\r\n", "\r", "\v", "\f", "\x1c", "\x1d", "\x1e", "\x85", "\u2028", "\u2029"]  # that end lines


def of(text):
    return Attachment.of("x.csv", text.encode())


def written(wanted, table, end="\n"):
    return "".join(",".join(map(str, row)) + end for row in (wanted, *table))


@pytest.mark.parametrize("mark", MARKS, ids=ascii)
@pytest.mark.parametrize("wanted", READ, ids="-".join)
def test_whatever_ends_a_line_no_sample_is_lost(wanted, mark):
    """A mark in a remark, before the header, behind it, and at all lines' ends; numbers that may be any of these."""
    table = np.arange(1.0, 4.0)[:, None] + np.arange(len(wanted))
    text = written(wanted, table)
    behind = text.replace("\n", f"{mark}\n", 1)
    for each in (f"# exported{mark}\n{text}", f"{mark}{text}", behind, written(wanted, table, mark)):
        read = columns.read(of(each), wanted)
        assert np.array_equal(np.stack(list(read.values()), axis=1), table)


@pytest.mark.parametrize("mark", MARKS, ids=ascii)
def test_faults_have_the_number_of_their_line_whatever_ends_those_before(mark):
    place = 1 + len(f"# exported{mark}\n".splitlines())
    for line, text in ((place + 1, "0,x\n"), (place + 2, "0,1\n1\n"), (place + 3, "0,1\n# so far\f1")):
        with pytest.raises(InputError, match=rf"line {line}, column elevation: '.?' must be a finite number"):
            columns.read(of(f"# exported{mark}\ntime,elevation\n{text}"), ("time", "elevation"))


def test_remarks_between_numbers_are_passed_over():
    read = columns.read(of("# a\ntime,elevation\n0,1\n\n  # b\n1,2\n"), ("time", "elevation"))
    assert [list(values) for values in read.values()] == [[0.0, 1.0], [1.0, 2.0]]


def test_a_long_file_is_read_line_by_line():
    """In less than three times the room of its text and its numbers: all its lines at once alone take more."""
    table = np.random.default_rng(0).random((20_000, 2))
    file = of(written(("time", "elevation"), table))
    tracemalloc.start()
    columns.read(file, ("time", "elevation"))
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert peak < 3 * (len(file.data) + table.nbytes)
