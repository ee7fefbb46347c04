"""All records of a study as one labelled dataset, results/<study>/statistics.nc."""

from __future__ import annotations

import hashlib
import json
import math
from collections.abc import Iterator, Mapping, Sequence
from itertools import groupby
from pathlib import Path
from typing import Any

import numpy as np

from pipeline import environment
from pipeline.results.arrays import INNER, Arrays
from pipeline.results.netcdf import Variable, to_file
from pipeline.results.status import read_json
from pipeline.results.store import Entry, Store, appearing, together, write_json
from pipeline.results.variables import FOUND, KNOBS, along, axis_units, meaning, meaning_of, of_path
from pipeline.study import seas
from pipeline.study.reading import StudyError
from pipeline.tasks.study import Study
from pipeline.tasks.task import MODEL_VERSION, Label, axes, dimensions

ALONG_MODE = "natural_frequency"
LOWEST = 6  # modes: a table of the whole dataset has a row for every combination of labels, with all 708 too many
SAME = 1e-9  # relative difference below which two frequencies are one
MARK = ".statistics.json"  # beside the dataset: what it was made of
NO_STATE = ""  # the mark that no records have: the dataset is collected again
TOLD = ("failure", "unmet", "warnings")  # of an entry, in words
NO_TASK = "no task"  # the state of a cell that its variant does not go along
LAYOUT = 10  # raise it when the dataset's form changes, so that it is written anew


Cell = tuple[int, ...]


def current(study: Study, store: Store) -> Path:
    """The dataset's path. One that was made of the same records stays as it is, and they are not read."""
    path, mark = store.root / "statistics.nc", _fingerprint(study, store)
    if path.is_file() and read_json(store.root / MARK) == {"of": mark, "sha256": checksum(path)}:
        return path
    return _collect(study, store, mark)[0]


def collect(study: Study, store: Store) -> tuple[Path, dict[str, int]]:
    """Write the dataset of whatever is there; its path, and how many tasks are in which state."""
    return _collect(study, store, _fingerprint(study, store))


def outdated(study: Study, store: Store) -> str:
    """Why the dataset has to be collected again; empty if it need not be, as one that came without mark or records."""
    path, mark = store.root / "statistics.nc", read_json(store.root / MARK)
    if not path.exists():
        return "was not there"
    if mark is None and (store.root / MARK).exists() and store.begun():
        return "had a mark that cannot be read"
    if mark is not None and mark.get("sha256") != checksum(path):
        return "was not what had been collected"
    if mark is not None and store.begun() and mark.get("of") != _fingerprint(study, store):
        return "held a damaged record" if mark.get("of") == NO_STATE else "was of other records than are there"
    return ""


def _collect(study: Study, store: Store, mark: str) -> tuple[Path, dict[str, int]]:
    table, path = axes(study.content), store.root / "statistics.nc"
    shape = tuple(len(values) for values in table.values())
    store.root.mkdir(parents=True, exist_ok=True)
    arrays = Arrays(shape, store.root)
    kinds = {"status": "U8", "task": "U16"} | dict.fromkeys(TOLD, "O")
    words = {name: np.full(shape, "", dtype=kind) for name, kind in kinds.items()}
    words["status"][...] = NO_TASK
    words["task"].ravel()[study.tasks.cells] = [f"{number:016x}" for number in study.tasks.ids.tolist()]
    tasks = study.tasks.ordered(store.packs.row)  # a pack is opened once for all that it has
    cells = zip(*(places.tolist() for places in np.unravel_index(tasks.cells, shape)), strict=True)
    as_looked = True
    looked = ((cell, store.look(task)) for cell, task in zip(cells, tasks.passing("collecting"), strict=True))
    for _, beside in groupby(looked, lambda one: one[1].record if one[1].place else one[0]):
        places, entries = zip(*beside, strict=True)
        for cell, entry, state in zip(places, entries, _fill(arrays, places, entries), strict=True):
            words["status"][cell] = state
            as_looked &= state == entry.state
            for name in TOLD:
                words[name][cell] = getattr(entry, name)
    with appearing(path) as part:
        to_file(part, *_dataset(study, table, arrays, words))
    states, numbers = np.unique(words["status"][once(words["task"])], return_counts=True)
    # What only reading found damaged looks the same once it is mended, to the same bits.
    write_json(store.root / MARK, {"of": mark if as_looked else NO_STATE, "sha256": checksum(path)})
    return path, {str(s): int(n) for s, n in zip(states, numbers, strict=True)}


def once(tasks: np.ndarray) -> np.ndarray:
    """Where a task stands first, of tasks by cell: cells share one, as all realizations of a regular sea do."""
    first = np.zeros(tasks.shape, bool)
    names, places = np.unique(tasks, return_index=True)
    first.ravel()[places[names != ""]] = True
    return first


def checksum(path: Path) -> str:
    """SHA-256 of a file, read in pieces."""
    with path.open("rb") as file:
        return hashlib.file_digest(file, "sha256").hexdigest()


def _fill(arrays: Arrays, cells: Sequence[Cell], entries: Sequence[Entry]) -> list[str]:
    """Numbers of cells whose records lie in one file, where they are whole; the cells' states."""
    there = [n for n, entry in enumerate(entries) if entry.state in ("done", "stale")]
    states: list[str] = [entry.state for entry in entries]
    try:
        if there:
            records = together([entries[n] for n in there])
            arrays.add([cells[n] for n in there], _lowest(records))
            arrays.put([cells[n] for n in there], "wall_time", [entries[n].status.wall_time for n in there])
    except (OSError, ValueError):
        if len(cells) > 1:
            return [state for pair in zip(cells, entries, strict=True) for state in _fill(arrays, pair[:1], pair[1:])]
        return ["damaged"]
    return states


def _lowest(record: Mapping[str, Variable]) -> dict[str, Variable]:
    """Records with their lowest modes alone."""
    kept = {"mode": slice(LOWEST)}
    return {
        name: v._replace(values=v.values[tuple(kept.get(dim, slice(None)) for dim in v.dims)])
        for name, v in record.items()
    }


def _fingerprint(study: Study, store: Store) -> str:
    """What the dataset is made of: the study's cells and the content of the records in them.

    Not how long those took: a task run again to the same bits leaves the dataset as it is.
    """
    digest = hashlib.sha256()
    words = study.content.model_dump(mode="json", include={"axes", "samples", "sea_states", "title", "variants"})
    digest.update(json.dumps([LAYOUT, words, dimensions(study.content)], sort_keys=True).encode())
    for task in study.tasks.passing("looking at records"):
        entry = store.look(task)
        made = [task.written_labels, task.id, entry.state, entry.status.content, entry.failure]
        digest.update(json.dumps(made).encode())
    return digest.hexdigest()


def _dataset(
    study: Study,
    table: Mapping[str, Sequence[Label]],
    arrays: Arrays,
    words: Mapping[str, np.ndarray],
) -> tuple[dict[str, Variable], dict[str, Any]]:
    """Variables and attributes of the file."""
    for dim in ("height", "mode", "system_mode"):
        arrays.sort(dim)
    outer = dimensions(study.content)
    keep = tuple(slice(None) if name in outer else 0 for name in table)
    axes_met = list(arrays.labels.get("axis", ()))
    coordinates = _coordinates(study, table, outer, arrays)
    variables: dict[str, Variable] = {}
    knobs: dict[str, float] = {}
    for name in sorted(arrays.values):
        values, inner = arrays.whole(name), arrays.dims[name]
        if name in coordinates and name in KNOBS and _given(values, coordinates[name], table):
            continue
        if name in KNOBS.keys() - coordinates and (knob := _single(values[..., None], len(table))) is not None:
            knobs[name] = float(knob[0])
        elif name == ALONG_MODE and (single := _single(values, len(table))) is not None:
            variables[name] = Variable(inner, single, meaning(name))
        else:
            # Beside what an axis gives: "balance", none at all, or what a tolerance chose in its place.
            own = f"{name}{FOUND}" if name in coordinates else name
            variables[own] = Variable((*outer, *inner), values[keep], meaning(name, axes_met))
    for name, texts in words.items():
        variables[name] = Variable(tuple(outer), np.asarray(texts[keep]), meaning(name))
    return coordinates | with_coordinates(variables, coordinates), _attributes(study) | knobs


def _given(values: np.ndarray, axis: Variable, table: Mapping[str, Sequence[Label]]) -> bool:
    """Whether an axis gives what records hold, wherever both are numbers."""
    if axis.values.dtype.kind not in "fiu":
        return True
    given = axis.values.reshape([len(labels) if name in axis.dims else 1 for name, labels in table.items()])
    return bool(np.all(np.isclose(values, given, atol=0.0, rtol=SAME) | np.isnan(values) | np.isnan(given)))


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
    """Labels along every dimension; an axis with one value is a scalar; heights and periods go with the sea state."""
    coords = {}
    varied = {axis.name: axis for axis in study.content.varied}
    motions = {f.name: f.motion for f in study.content.floats}
    for name, values in table.items():
        labels = _words_or_numbers(values)
        attrs = meaning_of(varied[name], motions) if name in varied else meaning(name)
        coords[name] = Variable((name,) if name in outer else (), labels if name in outer else labels[0], attrs)
    for axis in varied.values():
        for name, values, attrs in along(axis, motions):
            coords[name] = Variable((axis.name,), _words_or_numbers(values), attrs)
    if titles := [variant.title or name for name, variant in study.content.variants.items()]:
        coords["variant_title"] = Variable(("variant",), _words_or_numbers(titles), meaning("variant_title"))
    if "pto_damping" in table and "pto_damping" not in varied:
        damping = coords["pto_damping"]
        attrs = of_path("floats.*.pto_damping", table["pto_damping"], motions)
        coords["pto_damping"] = damping._replace(attrs={**attrs, **damping.attrs})
    known = dict(_of_seas(study, table, outer))
    if "Tp" in varied and varied["Tp"].own and not np.isin(table["Tp"], known["Tp"].values).all():
        (path,) = varied["Tp"].keys  # which holds mean periods
        coords["Tp"] = coords["Tp"]._replace(attrs=of_path(path, table["Tp"], motions))
    coords = known | coords
    used = {dim for inner in arrays.dims.values() for dim in inner}
    for dim in INNER:
        if dim in used:
            labels = np.array(list(arrays.labels[dim]))
            coords[dim] = Variable((dim,), labels, meaning(dim))
    if "axis" in used:
        coords["axis_unit"] = Variable(("axis",), np.array(axis_units(arrays.labels["axis"])), meaning("axis_unit"))
    return coords


def _of_seas(
    study: Study, table: Mapping[str, Sequence[Label]], outer: Sequence[str]
) -> Iterator[tuple[str, Variable]]:
    """The numbers by which people know the seas of the tasks: along sea states, and along what else changes them."""
    dims, cells, met, _ = study.tasks.seas
    shape = tuple(len(table[name]) for name in dims)
    known = [seas.labels(*sea) for sea in met]
    there = np.isin(np.arange(math.prod(shape)), cells).reshape(shape)
    for name in dict.fromkeys(key for one in known for key in one):
        numbers = np.full(shape, np.nan)
        numbers[there] = [one.get(name, np.nan) for one in known]
        yield name, _where_it_differs(Variable(dims, numbers, meaning(name)), there, outer)


def _where_it_differs(variable: Variable, there: np.ndarray, outer: Sequence[str]) -> Variable:
    """Without the dimensions along which numbers are the same wherever there is a task, but for sea states."""
    dims, numbers, attrs = variable
    for dim in variable.dims:
        axis = dims.index(dim)
        some = np.take_along_axis(numbers, there.argmax(axis, keepdims=True), axis)
        same = (numbers == some) | np.isnan(numbers) & np.isnan(some) | ~there
        if same.all() and not (dim == "sea_state" and dim in outer):
            dims, numbers, there = (*dims[:axis], *dims[axis + 1 :]), some.squeeze(axis), np.asarray(there.any(axis))
    return Variable(dims, numbers, attrs)


def _words_or_numbers(values: Sequence[Any]) -> np.ndarray:
    return np.array(list(values), dtype=object if isinstance(values[0], str) else None)


def with_coordinates(variables: dict[str, Variable], coordinates: Mapping[str, Variable]) -> dict[str, Variable]:
    """Name the coordinates that are not dimensions, as CF asks, and mark what is missing."""
    marked = {}
    for name, (dims, values, attrs) in variables.items():
        others = [c for c, v in coordinates.items() if (c,) != v.dims and set(v.dims) <= set(dims)]
        more: dict[str, Any] = {"coordinates": " ".join(others)} if others else {}
        if values.dtype.kind == "f":
            more["_FillValue"] = np.nan
        marked[name] = Variable(dims, values, dict(attrs) | more)
    return marked


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


def opened(path: Path) -> Any:
    """The dataset as xarray.Dataset, read as far as it is used, and again when used again."""
    import xarray as xr

    try:
        return xr.open_dataset(path, cache=False, engine="netcdf4")
    except OSError:
        raise StudyError(path, ["is damaged; `study collect` makes it again"]) from None


def loaded(path: Path) -> Any:
    """The dataset as xarray.Dataset, read whole."""
    with opened(path) as data:
        return data.load()
