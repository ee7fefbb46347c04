"""results/stress/report.html: the map, the comparisons and every scene with its outcome and message."""

from collections.abc import Iterable, Sequence
from html import escape

import numpy as np
import xarray as xr

STYLE = (
    "body{font:15px/1.5 system-ui,sans-serif;margin:2rem auto;max-width:75rem;padding:0 1rem;color:#222}"
    "img{max-width:100%}table{border-collapse:collapse;font-size:13px}"
    "td,th{padding:.15rem .8rem .15rem 0;text-align:left;vertical-align:top}tr+tr{border-top:1px solid #ddd}"
)


def page(data: xr.Dataset, comparisons: Iterable[tuple[str, float, float]], bad: Sequence[str]) -> str:
    """The whole page; the map is stress.png beside it."""
    outcomes, numbers = np.unique(data.outcome.values, return_counts=True)
    counts = ", ".join(f"{n} {o}" for o, n in zip(outcomes, numbers, strict=True))
    verdict = f"{len(bad)} as they should not be: " + "; ".join(bad) if bad else "All as it should be."
    compared = [(name, f"{value:.1e}", f"{bound:.0e}") for name, value, bound in comparisons]
    columns = [data[n].values for n in ("family", "x", "y", "outcome", "energy_residual", "message")]
    scenes = [(f, x, y, o, "" if np.isnan(e) else f"{e:.1e}", m) for f, x, y, o, e, m in zip(*columns, strict=True)]
    return (
        f'<!doctype html><html lang="en"><meta charset="utf-8"><title>Stability</title><style>{STYLE}</style>'
        f"<h1>Where the coupled solver is stable</h1><p>{data.sizes['case']} scenes: {counts}. {escape(verdict)}</p>"
        '<img src="stress.png" alt="Map of the scenes: outcome by colour">'
        "<h2>Comparisons between scenes</h2>" + _table(("comparison", "value", "at most"), compared)
        + "<h2>Scenes</h2>" + _table(("family", "", "", "outcome", "energy residual", "message"), scenes)
    )  # fmt: skip


def _table(head: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    cells = [[f"<th>{escape(h)}</th>" for h in head], *([f"<td>{escape(c)}</td>" for c in row] for row in rows)]
    return "<table>" + "".join("<tr>" + "".join(row) for row in cells) + "</table>"
