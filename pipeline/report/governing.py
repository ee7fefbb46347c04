"""Which sea state governs: where each load and motion of a study is largest, in which sea, and what the next has."""

from __future__ import annotations

import math
from collections.abc import Hashable, Iterator, Sequence
from typing import TYPE_CHECKING

import numpy as np

from pipeline.report.tables import Table, of_none, of_survivors
from pipeline.report.yearly import Counts, cells, counts, failures, lost, named, once_told, realized, shared
from pipeline.results.arrays import INNER
from pipeline.results.variables import meaning

if TYPE_CHECKING:
    import xarray as xr

ASKED_FOR = (  # of the steel, by `outputs`
    "node_acceleration", "fibre_stress", "fibre_stress_top", "member_stress", "utilisation", "section_force",
    "section_moment", "base_shear", "overturning_moment", "pile_force", "reaction_force", "reaction_moment",
)  # fmt: skip
# In this order; of what has statistics the larger of max and -min.
OF = (
    "rotation", "motion", "pto_force", "pto_stroke", "impact_rate", "end_stop_load", "hinge_force", "line_tension",
    "top_displacement", "bottom_stress", *ASKED_FOR,
)  # fmt: skip
# Along these what differs in kind has a line each, and a mean means nothing.
COMPONENTS = "axis", "direction", "force", "moment"
SEVERAL = 8  # designs that have lines of their own; of more the largest has one
NOTHING = 1e-6  # of a variable's largest: less of another component governs nothing
SAME = 1e-6  # of the largest: by less no sea has more than others
HEADER = ("", "largest of", "where", "in", "mean", "unit", "[least, largest]", "next in", "mean", "realizations")
NOTE = (
    "Largest magnitude in a record, in the frequency domain the one to be expected, mean over realizations, of the"
    " place and the sea state where that is largest; in brackets the realizations' least and largest. Next: the same"
    " of the sea state that comes second, wherever it is largest there. Extremes scatter: more seeds tell seas apart"
    " that are near each other."
)


def table(data: xr.Dataset) -> Table:
    """Of a study with several sea states."""
    lines = list(rows(data)) if data.sizes.get("sea_state", 1) > 1 else []
    lines += of_none(lost(data), len(HEADER), SEVERAL) if lines else []
    return Table("Governing sea states", HEADER, lines, NOTE + of_survivors(lines))


def rows(data: xr.Dataset) -> Iterator[tuple[str, ...]]:
    """Of every platform and other label, each load and motion along its components, as text."""
    for name in OF:
        if name not in data or "sea_state" not in data[name].dims or (name == "rotation" and "motion" in data):
            continue
        each = realized(data, _magnitudes(data[name].compute()))
        designs = [dim for dim in each.dims if dim not in ("sea_state", "seed", *INNER)]
        apart = designs if math.prod(each.sizes[dim] for dim in designs) <= SEVERAL else []
        components = [dim for dim in COMPONENTS if dim in each.dims]
        places = [dim for dim in each.dims if dim not in (*apart, *components)]
        same = shared(data, apart)
        least = NOTHING * float(each.max())
        for labels, place in cells(each.transpose(*apart, *components, ...), places):
            if float((part := each.isel(place)).max()) > least:
                along, of = labels[len(apart) :], once_told(labels[: len(apart)], place, same)
                if of is None:
                    continue
                words = ", ".join(of), " ".join([name, *along])
                yield *words, *_of_part(part, unit(data[name], components, along))


def unit(values: xr.DataArray, components: Sequence[Hashable], along: Sequence[object]) -> str:
    """Of a component, labels `along` those dimensions: the variable's own, or that of its axis."""
    own = [str(label) for dim, label in zip(components, along, strict=True) if dim == "axis"]
    return str(values.attrs.get("units", "") or meaning(str(values.name), own).get("units", ""))


def _magnitudes(values: xr.DataArray) -> xr.DataArray:
    if "statistic" not in values.dims:
        return abs(values)
    return abs(values.sel(statistic=["max", "min"])).max("statistic")


def _of_part(part: xr.DataArray, of: str) -> Iterator[str]:
    """Where, in which sea, how much, the realizations' least and largest, the next sea, its mean, and realizations."""
    mean = part.mean("seed") if "seed" in part.dims else part
    places = [dim for dim in mean.dims if dim != "sea_state"]
    by_sea = mean.max(places).fillna(-1.0)
    first, second = np.argsort(-by_sea.values, kind="stable")[:2]
    known, alike = int((by_sea >= 0).sum()), bool((by_sea >= (1 - SAME) * by_sea[first]).all())
    at: dict[Hashable, int] = {"sea_state": int(first)}
    at |= {dim: int(place) for dim, place in mean.isel(at).argmax(places).items()} if places else {}
    there = part.isel(at)
    yield ", ".join(named(dim, part[dim].values[at[dim]]) for dim in places if part.sizes[dim] > 1)
    sea = "any" if alike else str(part["sea_state"].values[first])
    yield sea + f" (of {known} among {by_sea.size})" * (known < by_sea.size)
    yield f"{float(mean.isel(at)):.4g}"
    yield of
    low, high = (f"{float(end):.4g}" for end in (there.min(), there.max()))
    yield f"[{low}, {high}]" if low != high else ""
    next_sea = str(part["sea_state"].values[second]), f"{float(by_sea[second]):.4g}"
    yield from next_sea if known > 1 and not alike else ("-", "-")
    number, failed = counts(there), failures(part)
    of_designs = failed.max([dim for dim in failed.dims if dim in INNER])
    yield str(Counts(number.least, number.most, of_designs.sum()))
