"""Arrays over a whole study, filled one record at a time, or several of one form at once."""

from __future__ import annotations

import tempfile
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from pipeline.results.netcdf import Variable
from pipeline.results.packs import TASK

# Dimensions of a record, in the order in which they follow those of the study.
INNER = (
    "float", "axis", "line", "leg", "foot", "node", "member", "tube", "end", "fibre", "member_fibre", "force", "moment",
    "direction", "height", "statistic", "mode", "system_mode", "component", "frequency_band",
)  # fmt: skip
LARGE = 2**25  # an array above this is kept in a file, and the system decides what of it is in memory [bytes]


class Arrays:
    """Variables over the cells of a study; NaN where no record has a number."""

    def __init__(self, shape: tuple[int, ...], folder: Path):
        self.shape, self.folder = shape, folder
        self.labels: dict[str, dict[Any, int]] = {}
        self.dims: dict[str, tuple[str, ...]] = {}
        self.values: dict[str, np.ndarray] = {}

    def add(self, cells: Sequence[tuple[int, ...]], records: Mapping[str, Variable]) -> None:
        """Take in a record at a cell of the study, or several: what differs among those has the dimension `task`."""
        places = {dim: self._places(dim, v.values.tolist()) for dim, v in records.items() if dim in INNER}
        for name, (dims, values, _) in records.items():
            if name not in places and set(dims) <= {*places, TASK} and values.dtype.kind in "fiub":
                inner = tuple(dim for dim in INNER if dim in dims)
                target = self._array(name, inner)
                order = [dims.index(dim) for dim in (TASK, *inner) if dim in dims]
                here = np.reshape(cells, (len(cells), len(self.shape), *(1,) * len(inner)))
                target[(*np.moveaxis(here, 1, 0), *np.ix_(*(places[dim] for dim in inner)))] = values.transpose(order)

    def put(self, cells: Sequence[tuple[int, ...]], name: str, values: Sequence[float]) -> None:
        """Single numbers at cells."""
        self._array(name, ())[tuple(np.transpose(cells))] = values

    def whole(self, name: str) -> np.ndarray:
        """A variable, with a place for every label met."""
        return self._array(name, self.dims[name])

    def sort(self, dim: str) -> None:
        """Put the labels of a dimension in ascending order."""
        order = sorted(known := self.labels.get(dim, {}))
        index = [known[label] for label in order]
        if index == sorted(index):
            return
        for name, inner in self.dims.items():
            if dim in inner:
                axis = len(self.shape) + inner.index(dim)
                self.values[name] = self.whole(name).take(index, axis=axis)
        self.labels[dim] = {label: i for i, label in enumerate(order)}

    def _places(self, dim: str, labels: Iterable[Any]) -> np.ndarray:
        known = self.labels.setdefault(dim, {})
        return np.array([known.setdefault(label, len(known)) for label in labels], dtype=int)

    def _array(self, name: str, inner: tuple[str, ...]) -> np.ndarray:
        """The array of a variable, grown to hold all labels met so far."""
        full = self.shape + tuple(len(self.labels[dim]) for dim in inner)
        old = self.values.get(name)
        if old is None or old.shape != full:
            self.values[name] = self._empty(full)
            self.dims[name] = inner
            if old is not None:
                self.values[name][tuple(slice(n) for n in old.shape)] = old
        return self.values[name]

    def _empty(self, shape: tuple[int, ...]) -> np.ndarray:
        if np.prod(shape) * 8 <= LARGE:
            return np.full(shape, np.nan)
        with tempfile.TemporaryFile(dir=self.folder) as file:  # gone from the folder at once, whatever happens
            space = np.memmap(file, dtype=float, mode="w+", shape=shape)
        space[...] = np.nan
        return space
