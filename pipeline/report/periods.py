"""Natural periods of the coupled system in water, and what moves in each shape."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING

from pipeline.results.netcdf import from_bytes
from pipeline.results.packs import Packs

if TYPE_CHECKING:
    from pipeline.report.figures import Results

PERIODS, SHAPES = "system_period", "system_shapes"


def natural_periods(results: Results) -> Iterator[tuple[str, list[tuple[str, str]]]]:
    """Of each support, from its first record that has any: period [s] and what moves."""
    if results.tasks is None or "task" not in results.data:
        return
    for platform in results.labels("platform"):
        cells = results.values("task", platform=platform, **results.first)
        tables = (_table(results.tasks, str(task)) for task in cells.values.ravel())
        if table := next((table for table in tables if table), None):
            yield str(platform), table


def _table(tasks: Path, task: str) -> list[tuple[str, str]]:
    """Empty where there is no such record, or it is damaged."""
    alone = tasks / task / "record.nc"
    try:
        if not alone.exists() and (place := Packs(tasks.with_name("packs")).find(task)):
            variables, attrs = place.record()
        else:
            variables, attrs = from_bytes(alone.read_bytes())
        shapes = str(attrs[SHAPES]).split("; ")
        return [(f"{period:.4g}", shape) for period, shape in zip(variables[PERIODS].values, shapes, strict=True)]
    except (OSError, ValueError, KeyError):
        return []
