"""All records of a study as one labelled dataset, results/<study>/statistics.nc."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from pipeline import environment
from pipeline.netcdf import Variable, to_bytes
from pipeline.records import decode
from pipeline.store import Entry, Store, read_json, sha256, write_atomic, write_json
from pipeline.study import Study
from pipeline.tasks import MODEL_VERSION, Label, Task, axes, dimensions, expand
from pipeline.variables import meaning

# Dimensions of a record, in the order in which they follow the study's own.
INNER = ("float", "leg", "direction", "height", "statistic", "mode")
ALONG_MODE = "natural_frequency"
SAME = 1e-9  # relative difference below which two frequencies are one
LAYOUT = 1  # raise it when the dataset's form changes, so that it is written anew


class Arrays:
    """Arrays over the whole study, filled one record at a time; what nothing fills stays NaN."""

    def __init__(self, shape: tuple[int, ...]):
        self.shape = shape
        self.labels: dict[str, dict[Any, int]] = {}
        self.dims: dict[str, tuple[str, ...]] = {}
        self.values: dict[str, np.ndarray] = {}

    def add(self, cell: tuple[int, ...], record: Mapping[str, Variable]) -> None:
        """Take a record in at a cell of the study."""
        places = {dim: self._places(dim, v.values.tolist()) for dim, v in record.items() if dim in INNER}
        for name, (dims, values, _) in record.items():
            if name not in places and set(dims) <= places.keys() and values.dtype.kind in "fiub":
                own = tuple(dim for dim in INNER if dim in dims)
                target = self._array(name, own)
                target[cell + np.ix_(*(places[dim] for dim in own))] = values.transpose([dims.index(d) for d in own])

    def put(self, cell: tuple[int, ...], name: str, value: float) -> None:
        """A single number at a cell."""
        self._array(name, ())[cell] = value

    def sort(self, dim: str) -> None:
        """Put the labels of a dimension in ascending order."""
        order = sorted(self.labels.get(dim, {}))
        index = [self.labels[dim][label] for label in order]
        for name, own in self.dims.items():
            if dim in own and index:
                self._array(name, own)
                self.values[name] = self.values[name].take(index, axis=len(self.shape) + own.index(dim))
        self.labels[dim] = {label: i for i, label in enumerate(order)}

    def _places(self, dim: str, labels: Iterable[Any]) -> np.ndarray:
        known = self.labels.setdefault(dim, {})
        return np.array([known.setdefault(label, len(known)) for label in labels], dtype=int)

    def _array(self, name: str, own: tuple[str, ...]) -> np.ndarray:
        """The array of a variable, grown to hold all labels met so far."""
        full = self.shape + tuple(len(self.labels[dim]) for dim in own)
        old = self.values.get(name)
        if old is None or old.shape != full:
            self.values[name] = np.full(full, np.nan)
            self.dims[name] = own
            if old is not None:
                self.values[name][tuple(slice(n) for n in old.shape)] = old
        return self.values[name]


def collect(study: Study, store: Store, *, anew: bool = True) -> tuple[Path, dict[str, int]]:
    """Write the dataset of whatever is there; its path, and how many tasks are in which state.

    Not `anew`: leave a dataset that was made of the same records as it is, without reading them.
    """
    table = axes(study.content)
    shape = tuple(len(values) for values in table.values())
    tasks = list(expand(study.content))
    entries = {task.id: store.look(task) for task in tasks}
    path, mark = store.root / "statistics.nc", _fingerprint(study, tasks, entries)
    known = read_json(store.root / ".statistics.json") or {}
    if not anew and known.get("of") == mark and path.exists() and known.get("sha256") == sha256(path.read_bytes()):
        return path, known["counts"]
    arrays = Arrays(shape)
    status = np.full(shape, "missing", dtype=object)
    names = np.full(shape, "", dtype=object)
    for cell, task in zip(np.ndindex(*shape), tasks, strict=True):
        entry = entries[task.id]
        status[cell], names[cell] = _fill(arrays, cell, entry), task.id
    data = to_bytes(*_dataset(study, table, arrays, status, names))
    write_atomic(path, data)
    states, numbers = np.unique(status.astype(str), return_counts=True)
    counts = {str(s): int(n) for s, n in zip(states, numbers, strict=True)}
    write_json(store.root / ".statistics.json", {"of": mark, "sha256": sha256(data), "counts": counts})
    return path, counts


def _fill(arrays: Arrays, cell: tuple[int, ...], entry: Entry) -> str:
    """A cell's numbers, if its record is whole; its state."""
    if entry.state not in ("done", "stale"):
        return entry.state
    try:
        data = entry.record.read_bytes()
    except OSError:
        return "damaged"
    if sha256(data) != entry.status.get("sha256"):
        return "damaged"
    arrays.add(cell, decode(data))
    arrays.put(cell, "wall_time", float(entry.status.get("wall_time", np.nan)))
    return entry.state


def _fingerprint(study: Study, tasks: Sequence[Task], entries: Mapping[str, Entry]) -> str:
    """What the dataset is made of: the study's cells and the records in them."""
    cells = [[dict(task.labels), task.id, entries[task.id].state, entries[task.id].status] for task in tasks]
    seas = study.content.model_dump(mode="json", include={"sea_states", "title"})
    text = json.dumps([LAYOUT, seas, dimensions(study.content), cells], sort_keys=True)
    return hashlib.sha256(text.encode()).hexdigest()


def _dataset(
    study: Study,
    table: Mapping[str, Sequence[Label]],
    arrays: Arrays,
    status: np.ndarray,
    names: np.ndarray,
) -> tuple[dict[str, Variable], dict[str, Any]]:
    """Variables and attributes of the file."""
    for dim in ("height", "mode"):
        arrays.sort(dim)
    outer = dimensions(study.content)
    keep = tuple(slice(None) if name in outer else 0 for name in table)
    variables: dict[str, Variable] = {}
    for name in sorted(arrays.values):
        values, own = arrays._array(name, arrays.dims[name]), arrays.dims[name]
        if name == ALONG_MODE and (single := _single(values, len(table))) is not None:
            variables[name] = Variable(own, single, meaning(name))
        else:
            variables[name] = Variable((*outer, *own), values[keep], meaning(name))
    for name, words in (("status", status), ("task", names)):
        variables[name] = Variable(tuple(outer), np.asarray(words[keep], dtype=object), meaning(name))
    coordinates = _coordinates(study, table, outer, arrays)
    return coordinates | _with_coordinates(variables, coordinates), _attributes(study)


def _single(values: np.ndarray, outer: int) -> np.ndarray | None:
    """Values along the last dimension, if they are the same wherever there are any."""
    rows = values.reshape(-1, values.shape[-1]) if outer else values[None]
    rows = rows[~np.isnan(rows).all(axis=1)]
    if len(rows) and np.allclose(rows, rows[0], rtol=SAME, atol=0, equal_nan=True):
        return np.asarray(rows[0])
    return None


def _coordinates(
    study: Study, table: Mapping[str, Sequence[Label]], outer: Sequence[str], arrays: Arrays
) -> dict[str, Variable]:
    """Labels along every dimension; an axis with one value is a scalar; Hs and Tp go with the sea state."""
    found = {}
    for name, values in table.items():
        text = isinstance(values[0], str)
        labels = np.array(list(values), dtype=object if text else None)
        found[name] = Variable((name,) if name in outer else (), labels if name in outer else labels[0], meaning(name))
    seas = [study.content.sea_states[str(label)] for label in table["sea_state"]]
    for name in ("Hs", "Tp"):
        heights = np.array([getattr(sea, name) for sea in seas])
        dims = ("sea_state",) if "sea_state" in outer else ()
        found[name] = Variable(dims, heights if dims else heights[0], meaning(name))
    used = {dim for own in arrays.dims.values() for dim in own}
    for dim in INNER:
        if dim in used:
            labels = np.array(list(arrays.labels[dim]))
            found[dim] = Variable((dim,), labels, meaning(dim) | ({"positive": "up"} if dim == "height" else {}))
    return found


def _with_coordinates(variables: dict[str, Variable], coordinates: Mapping[str, Variable]) -> dict[str, Variable]:
    """Name the coordinates that are not dimensions, as CF asks, and mark what is missing."""
    found = {}
    for name, (dims, values, attrs) in variables.items():
        others = [c for c, v in coordinates.items() if (c,) != v.dims and set(v.dims) <= set(dims)]
        more: dict[str, Any] = {"coordinates": " ".join(others)} if others else {}
        if values.dtype.kind == "f":
            more["_FillValue"] = np.nan
        found[name] = Variable(dims, values, dict(attrs) | more)
    return found


def _attributes(study: Study) -> dict[str, Any]:
    return {
        "Conventions": "CF-1.11",
        "title": study.content.title or study.name,
        "source": f"wecplatform, model version {MODEL_VERSION}, sources {environment.commit() or 'unknown'}",
        "history": f"collected by `study collect {study.path.name}`",
        "study": study.path.name,
        "sign_conventions": "x along heading 0, z up from still water, right-handed rotations about +y",
        **{f"version_{k}": v for k, v in environment.provenance().items()},
    }


def load(path: Path) -> Any:
    """The dataset as xarray.Dataset, read whole."""
    import xarray as xr

    with xr.open_dataset(path) as data:
        return data.load()
