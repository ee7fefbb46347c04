"""One task's record as a netCDF file."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from typing import Any, Protocol

import numpy as np

from pipeline.results.netcdf import Variable, content, from_bytes
from pipeline.results.packs import Made
from pipeline.results.variables import RENAMED, SERIES, axis_units, meaning
from pipeline.study import seas
from pipeline.tasks.task import Parameters, wave_seed

# How long it took is no part of what came out: no two runs agree on it.
TIMINGS = ("wall_time", "prepare_time", "march_time")
TASK = {"coordinates": "task"}  # so that records side by side know whose they are
ALONG_AXES = {"coordinates": "task axis_unit"}
SAMPLES = 4  # of a decimated series in the shortest wave

Labelled = tuple[tuple[str, ...], Any]


class Record(Protocol):
    """What the solver hands back: statistics by name, with dimensions, and audit figures."""

    @property
    def variables(self) -> Mapping[str, Labelled]:
        """Name -> dimensions and values of statistics, envelopes and other results."""

    @property
    def coords(self) -> Mapping[str, Any]:
        """Dimension -> labels."""

    @property
    def attrs(self) -> Mapping[str, Any]:
        """Single numbers and words: settings, audit, times."""

    @property
    def series(self) -> Mapping[str, Labelled]:
        """Name -> dimensions and values of time series, if they are kept; `time` is one of them."""


def made(record: Record, parameters: Parameters, provenance: Mapping[str, Any]) -> tuple[Made, str]:
    """What its file holds, and the digest of its content: provenance is in the first and not in the second."""
    variables = dict(_variables(record, _thinning(record, parameters)))
    digest = content(variables)
    attrs = {
        "Conventions": "CF-1.11",
        "title": "Record of one task",
        "history": "computed by `study run`",
        **provenance,
    }
    attrs |= {"parameters": parameters.canonical(), "wave_seed": " ".join(map(str, wave_seed(parameters)))}
    attrs |= _chosen(parameters)
    attrs |= {k: str(v) for k, v in record.attrs.items() if not _is_figure(v)}
    attrs |= {k: float(v) for k, v in record.attrs.items() if k in TIMINGS}
    variables["task"] = Variable((), np.array(provenance["task"]), meaning("task"))
    return (variables, attrs), digest


def _chosen(parameters: Parameters) -> dict[str, str]:
    """What the study left out and the program chose."""
    sea, waves = parameters.sea_state, parameters.waves
    if waves.band is not None or not isinstance(sea, seas.Irregular) or (span := seas.frequencies(sea, waves)) is None:
        return {}
    return {"waves_band": f"{span[0]:.4g} to {span[1]:.4g} rad/s, chosen by the peak's frequency"}


def decode(data: bytes) -> dict[str, Variable]:
    """Variables and coordinates of a record's file."""
    return from_bytes(data)[0]


def _thinning(record: Record, parameters: Parameters) -> slice:
    """Which samples of the series are kept: all, or about SAMPLES in the shortest wave; all in still water."""
    span = seas.frequencies(parameters.sea_state, parameters.waves)
    if parameters.record.series != "decimated" or "time" not in record.series or span is None:
        return slice(None)
    _, time = record.series["time"]
    if len(time) < 2:
        return slice(None)
    shortest = 2 * math.pi / span[1]
    return slice(None, None, max(1, int(shortest / SAMPLES / (time[1] - time[0]) + 1e-9)))


def _variables(record: Record, kept: slice) -> Iterator[tuple[str, Variable]]:
    """Coordinates that are used, statistics, figures of the audit, time series."""
    series = {n if n == "time" else n + SERIES: (_renamed(dims), v[kept]) for n, (dims, v) in record.series.items()}
    arrays = {**record.variables, **series}
    used = {dim for dims, _ in arrays.values() for dim in dims}
    axes = [str(axis) for axis in record.coords.get("axis", ())]
    for name, labels in sorted(record.coords.items()):
        if name in used:
            yield name, Variable((name,), _narrow(labels), meaning(name))
    if "axis" in used:
        yield "axis_unit", Variable(("axis",), np.array(axis_units(axes)), meaning("axis_unit"))
    for name, (dims, array) in sorted(arrays.items()):
        label, beside = RENAMED.get(name, name), ALONG_AXES if "axis" in dims else TASK
        attrs = meaning(label, axes) | ({} if (label,) == tuple(dims) else beside)
        yield label, Variable(tuple(dims), _narrow(array), attrs)
    for name, value in sorted(record.attrs.items()):
        if _is_figure(value) and name not in TIMINGS:
            label = RENAMED.get(name, name)
            yield label, Variable((), np.asarray(float(value)), meaning(label) | TASK)


def _renamed(dims: Sequence[str]) -> tuple[str, ...]:
    return tuple(RENAMED.get(dim, dim) for dim in dims)


def _narrow(values: Any) -> np.ndarray:
    """Whole numbers as the file has them, so that content read is content written."""
    array = np.asarray(values)
    return array.astype("i4", casting="same_kind") if array.dtype.kind in "iu" else array


def _is_figure(value: object) -> bool:
    return isinstance(value, (int, float, np.number)) and not isinstance(value, bool)


def differences(a: Mapping[str, Variable], b: Mapping[str, Variable]) -> list[str]:
    """Which variables differ between a record and a new one, and by how much; none if they have the same content."""
    lines = [f"{name}: only in the {'old' if name in a else 'new'} record" for name in sorted(a.keys() ^ b.keys())]
    return lines + [f"{name}: {words}" for name in sorted(a.keys() & b.keys()) for words in _changes(a[name], b[name])]


def _changes(old: Variable, new: Variable) -> Iterator[str]:
    """Each way in which a variable differs from the old one."""
    x, y = old.values, new.values
    if x.shape != y.shape or x.dtype != y.dtype:
        yield f"{x.dtype}{x.shape} became {y.dtype}{y.shape}"
    elif x.dtype.kind in "UO" and not np.array_equal(x, y):
        yield "other labels"
    elif x.dtype.kind not in "UO" and x.tobytes() != y.tobytes():
        with np.errstate(invalid="ignore"):
            yield f"differs by up to {np.nanmax(np.abs(x - y)):.3g}"
    if old.dims != new.dims:
        yield f"dimensions {', '.join(old.dims)} became {', '.join(new.dims)}"
    for key in sorted(old.attrs.keys() | new.attrs.keys()):
        if str(old.attrs.get(key)) != str(new.attrs.get(key)):
            yield f"{key} {old.attrs.get(key)} became {new.attrs.get(key)}"
