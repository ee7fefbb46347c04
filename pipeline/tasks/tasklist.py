"""The tasks of a study, or some of them, as numbers: a task is made when it is asked for.

A task costs 16 bytes here, so that a million of them are no burden.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Hashable, Iterator, Mapping, Sequence, Set
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple, TypeVar

import numpy as np

from pipeline.study.schema import StudyFile
from pipeline.study.seas import SeaState, Waves
from pipeline.tasks.task import Label, Task, axes, blocks, cell, dimensions, sea_at
from pipeline.terminal import passing

Key = TypeVar("Key", bound=Hashable)
SEAS = ("sea.", "sea_states.", "waves.form", "waves.spectrum")  # what paths begin with that change seas


class Seas(NamedTuple):
    """The seas of tasks, along the axes that change them."""

    dims: tuple[str, ...]
    numbers: np.ndarray  # (m,), of the cells along these axes that have tasks
    each: list[tuple[SeaState, Waves]]  # m, with what they have in common
    places: np.ndarray  # (n,), which of them each task has


@dataclass(frozen=True, eq=False, kw_only=True)
class Tasks:
    """Cells of a study, the last axis fastest, and the ids of the tasks in them."""

    study: StudyFile
    cells: np.ndarray  # (n,) i8
    ids: np.ndarray  # (n,) u8, an id is 16 hexadecimal digits

    @classmethod
    def of(cls, study: StudyFile) -> Tasks:
        """The tasks in all cells; cells may share one."""
        return cls.unnamed(study).named

    @classmethod
    def unnamed(cls, study: StudyFile) -> Tasks:
        """The tasks in all cells, without their ids, which take time."""
        cells = np.sort(np.concatenate([_cells(axes(study), part) for part in blocks(study)]))
        return cls(study=study, cells=cells, ids=np.zeros(len(cells), "u8"))

    @property
    def named(self) -> Tasks:
        """The same tasks with their ids."""
        ids = (int(self.task(int(number)).id, 16) for number in passing(self.cells, len(self), "naming tasks"))
        return Tasks(study=self.study, cells=self.cells, ids=np.fromiter(ids, "u8", len(self)))

    @property
    def unique(self) -> Tasks:
        """Every task once, where it stands first."""
        return self.part(np.sort(np.unique(self.ids, return_index=True)[1]))

    def where(self, wanted: Callable[[Task], bool]) -> Tasks:
        """The tasks for which `wanted` holds."""
        return self.part(np.fromiter((n for n, task in enumerate(self.passing()) if wanted(task)), "i8"))

    def fastest(self, names: Set[str]) -> Tasks:
        """The same tasks in the order in which these axes vary fastest."""
        slowest_first = sorted(self._table, key=lambda name: name in names)
        return self.part(np.lexsort([self.places(name) for name in reversed(slowest_first)]))

    def ordered(self, place: Callable[[str], tuple[str, int]]) -> Tasks:
        """The same tasks in the order of their ids' places, those of one place as they stand."""
        places = [place(f"{known:016x}") for known in self.ids.tolist()]
        return self.part(np.array(sorted(range(len(places)), key=places.__getitem__), "i8"))

    def split(self, key: Callable[[Task], Key]) -> dict[Key, Tasks]:
        """Groups with the same key, in the order in which the keys come."""
        numbers: dict[Key, int] = {}
        mine = np.fromiter((numbers.setdefault(key(task), len(numbers)) for task in self.passing()), "i8", len(self))
        return {one: self.part(np.flatnonzero(mine == number)) for one, number in numbers.items()}

    def __len__(self) -> int:
        return len(self.cells)

    def __iter__(self) -> Iterator[Task]:
        for number, known in zip(self.cells, self.ids, strict=True):
            yield self.task(int(number), f"{known:016x}")

    def passing(self, words: str = "looking at tasks") -> Iterator[Task]:
        """The tasks, one after another, for a pass that may take long."""
        return passing(self, len(self), words)

    def places(self, name: str) -> np.ndarray:
        """Where each cell (n,) is along an axis."""
        counts = [*map(len, self._table.values())]
        axis = list(self._table).index(name)
        return self.cells // math.prod(counts[axis + 1 :]) % counts[axis]

    def labels(self, number: int) -> dict[str, Label]:
        """Labels of a cell along every axis."""
        label_of = {}
        for name, values in self._backwards:
            number, place = divmod(number, len(values))
            label_of[name] = values[place]
        return {name: label_of[name] for name in self._table}

    def task(self, number: int, known: str = "") -> Task:
        """The task in a cell."""
        return cell(self.study, self.labels(number), self._varied, known)

    @cached_property
    def seas(self) -> Seas:
        """The seas of the tasks."""
        changing = {axis.name for axis in self.study.varied if any(path.startswith(SEAS) for path in axis.keys)}
        dims = tuple(name for name in self._table if name == "sea_state" or name in changing)
        along = np.ravel_multi_index([self.places(name) for name in dims], [len(self._table[name]) for name in dims])
        numbers, first, places = np.unique(along, return_index=True, return_inverse=True)
        each = [sea_at(self.study, self.labels(int(cell))) for cell in self.cells[first]]
        return Seas(dims, numbers, each, places)

    def part(self, chosen: np.ndarray) -> Tasks:
        """Those at these places, or for which that is true."""
        return Tasks(study=self.study, cells=self.cells[chosen], ids=self.ids[chosen])

    @cached_property
    def _table(self) -> dict[str, tuple[Label, ...]]:
        return axes(self.study)

    @cached_property
    def _backwards(self) -> list[tuple[str, tuple[Label, ...]]]:
        return list(reversed(self._table.items()))

    @cached_property
    def _varied(self) -> tuple[str, ...]:
        return tuple(dimensions(self.study))


def _cells(table: Mapping[str, Sequence[Label]], wanted: Mapping[str, Set[Label]]) -> np.ndarray:
    """Numbers (n,) of the cells with a wanted label along every axis, ascending; no other cell is visited."""
    places = [
        np.array([place for place, label in enumerate(values) if name not in wanted or label in wanted[name]], int)
        for name, values in table.items()
    ]
    return np.ravel_multi_index(np.ix_(*places), [len(values) for values in table.values()]).ravel()
