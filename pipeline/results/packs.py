"""Records of frequency-domain tasks, many to a file: results/<study>/packs/<number>.nc, with the dimension `task`.

What is the same in all of them is there once. Beside it <number>.jsonl has a line for each, as status.json has it: it
appears last, and each line has the task's id and the checksum of the records. A task in several packs is the last's.
"""

from __future__ import annotations

import hashlib
import re
import time
from collections.abc import Iterator, Mapping, Sequence
from functools import lru_cache
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from pipeline.results.netcdf import Variable, from_bytes, to_bytes
from pipeline.results.status import Status

TASK = "task"  # the dimension
ATTRIBUTE = "attribute_"  # before the name of a record's attribute that is another in each
LINE = re.compile(rb'\{"id": "([0-9a-f]{16})", "model_version": (\d+)')  # how one begins
FRESH = 1e9  # a folder that changed so lately may change again without another time [ns]

Made = tuple[Mapping[str, Variable], Mapping[str, Any]]  # variables and attributes of a record


class Row(NamedTuple):
    """A record in a pack."""

    pack: str  # its checksum
    number: int
    data: bytes  # of the pack, with its first record; the others come with that one


def packed(records: Sequence[Made]) -> list[Row]:
    """Each record's row; those of one form go together."""
    alike: dict[tuple[object, ...], list[int]] = {}
    for n, record in enumerate(records):
        alike.setdefault(_form(record), []).append(n)
    rows: dict[int, Row] = {}
    for members in alike.values():
        data = to_bytes(*_stacked([records[n] for n in members]))
        pack = hashlib.sha256(data).hexdigest()
        rows |= {n: Row(pack, row, b"" if row else data) for row, n in enumerate(members)}
    return [rows[n] for n in range(len(records))]


def _form(record: Made) -> tuple[object, ...]:
    """What records in one file have in common: names, dimensions, sizes, labels and their attributes."""
    variables, attrs = record
    each = (
        (name, v.dims, v.values.shape, v.values.dtype.kind, str(v.attrs), (name,) == v.dims and v.values.tobytes())
        for name, v in variables.items()
    )
    return (*each, *((name, type(value)) for name, value in attrs.items()))


def _stacked(records: Sequence[Made]) -> Made:
    first, attrs = records[0]
    variables = {name: _together([variables[name] for variables, _ in records], each=name == TASK) for name in first}
    texts = {name: [of[name] for _, of in records] for name in attrs}
    for name, values in texts.items():
        if len(set(values)) > 1:
            variables[ATTRIBUTE + name] = Variable((TASK,), np.array(values), {"long_name": f"Attribute {name}"})
    return variables, {name: values[0] for name, values in texts.items() if ATTRIBUTE + name not in variables}


def _together(each_one: Sequence[Variable], *, each: bool) -> Variable:
    """One variable of several: once where they are the same to the bit, unless there is to be one for each."""
    first = each_one[0]
    if not each and all(v.values.tobytes() == first.values.tobytes() for v in each_one[1:]):
        return first
    return Variable((TASK, *first.dims), np.stack([v.values for v in each_one]), first.attrs)


def taken(pack: Made, number: int) -> Made:
    """A record out of a pack."""
    variables, attrs = pack
    mine = {
        name: Variable(v.dims[1:], v.values[number, ...], v.attrs) if v.dims[:1] == (TASK,) else v
        for name, v in variables.items()
    }
    own = {name: mine.pop(name).values.item() for name in variables if name.startswith(ATTRIBUTE)}
    return mine, {**attrs, **{name.removeprefix(ATTRIBUTE): value for name, value in own.items()}}


class Place(NamedTuple):
    """Where a task stands among the packs."""

    records: Path
    number: int
    status: Status

    @property
    def checksum(self) -> str:
        """Of the pack as it is; raises OSError."""
        return _checksum(self.records, self.records.stat().st_mtime_ns)

    def record(self) -> Made:
        """The task's; raises OSError or ValueError unless the pack is whole."""
        variables, attrs = taken(_opened(self.records, self.records.stat().st_mtime_ns), self.number)
        if self.checksum != self.status.sha256 or variables[TASK].values != self.status.id:
            raise ValueError("the pack's content is not what was written")
        return variables, attrs


def together(places: Sequence[Place]) -> dict[str, Variable]:
    """Variables of several records of a pack, those that differ with the dimension `task`; raises as `record` does."""
    path, checksum = places[0].records, places[0].checksum
    variables, numbers = _opened(path, path.stat().st_mtime_ns)[0], [place.number for place in places]
    mine = {name: _rows(v, numbers) for name, v in variables.items() if not name.startswith(ATTRIBUTE)}
    if any(place.status.sha256 != checksum for place in places) or mine[TASK].values.tolist() != [
        place.status.id for place in places
    ]:
        raise ValueError("the pack's content is not what was written")
    return mine


def _rows(variable: Variable, numbers: list[int]) -> Variable:
    return variable._replace(values=variable.values[numbers]) if variable.dims[:1] == (TASK,) else variable


class Packs:
    """The packs of a study."""

    def __init__(self, folder: Path):
        self.folder = folder
        self._lines: dict[str, tuple[Path, int, int, int]] = {}  # file, row, and where in it the row begins and ends
        self._versions: set[int] = set()
        self._read: set[str] = set()
        self._changed = -1
        self._last = -1  # number of the last pack

    def find(self, task_id: str) -> Place | None:
        """The last outcome of a task in a pack, None if there is none."""
        self._look()
        if (line := self._lines.get(task_id)) is None:
            return None
        path, number, start, end = line
        try:
            status = Status.model_validate_json(_content(path, path.stat().st_mtime_ns)[start:end])
        except (OSError, ValueError):
            return None
        return Place(path.with_suffix(".nc"), number, status)

    def __contains__(self, task_id: str) -> bool:
        """Whether a task has an outcome in a pack."""
        self._look()
        return task_id in self._lines

    @property
    def versions(self) -> set[int]:
        """Model versions of which a pack has outcomes."""
        self._look()
        return self._versions

    def row(self, task_id: str) -> tuple[str, int]:
        """Where a task's last outcome lies among all: its pack and its row; before all of them if in none."""
        self._look()
        path, number, *_ = self._lines.get(task_id, (Path(), -1))
        return path.name, number

    def next(self, count: int) -> list[Path]:
        """Records of so many packs to come, after all that are there: of a task in several the last counts."""
        # Looked for once, and again where another run's are there: for each of thousands of packs it would be slow.
        if self._last < 0 or self._record(self._last + 1).exists():
            self._last = max((int(path.stem) for path in self.folder.glob("*") if path.stem.isdecimal()), default=0)
        self._last += count
        return [self._record(self._last - n) for n in reversed(range(count))]

    def _record(self, number: int) -> Path:
        return self.folder / f"{number:06d}.nc"

    def strays(self, known: set[str]) -> Iterator[Path]:
        """Records of packs from which no known task has its outcome, and what lies beside them."""
        self._look()
        used = {path.stem for task, (path, *_) in self._lines.items() if task in known}
        yield from sorted(path for path in self.folder.glob("*") if path.stem not in used)

    def _look(self) -> None:
        """Read which tasks are in packs that were not there before."""
        now = changed(self.folder)
        if now == self._changed:
            return
        names = sorted(path.name for path in self.folder.glob("*.jsonl")) if now else []
        if self._read - set(names):
            self._lines, self._versions, self._read = {}, set(), set()
        for name in names:
            if name not in self._read:
                self._take(self.folder / name)
        self._read, self._changed = set(names), unless_fresh(now)

    def _take(self, path: Path) -> None:
        start = 0
        for number, line in enumerate(lines(path)):
            if match := LINE.match(line):
                self._lines[match[1].decode()] = path, number, start, start + len(line)
                self._versions.add(int(match[2]))
            start += len(line)


def changed(folder: Path) -> int:
    """When a folder last did [ns], 0 if there is none."""
    try:
        return folder.stat().st_mtime_ns
    except OSError:
        return 0


def unless_fresh(changed: int) -> int:
    """A time that a folder shows until it changes again; -1, which is none, if it may do so without showing it."""
    return -1 if time.time_ns() - changed < FRESH else changed


def lines(path: Path) -> list[bytes]:
    """Of a pack's statuses, or of a task's; none if they cannot be read."""
    try:
        return path.read_bytes().splitlines(keepends=True)
    except OSError:
        return []


# By path and time of the last change: tasks looked at one after another are in few packs, one for each sea.
@lru_cache(maxsize=128)
def _content(path: Path, _changed: int) -> bytes:
    return path.read_bytes()


@lru_cache(maxsize=256)
def _checksum(path: Path, _changed: int) -> str:
    return hashlib.sha256(path.read_bytes()).hexdigest()


@lru_cache(maxsize=2)
def _opened(path: Path, _changed: int) -> Made:
    return from_bytes(path.read_bytes())
