"""The map: what came of each scene, family by family."""

from pathlib import Path

import matplotlib as mpl
import numpy as np
import xarray as xr
from matplotlib.patches import Patch

mpl.use("Agg")
import matplotlib.pyplot as plt

# Accurate, accurate enough, coarse: by the estimated error of the time step.
COLOURS = {
    "error < 0.1 %": "#1b7837",
    "error < 1 %": "#7fbf7b",
    "error >= 1 %": "#d9f0d3",
    "repeated with a quarter of the step": "#6baed6",
    "named failure": "#fdae61",
    "refused": "#d0d0d0",
    "NaN, traceback, hang": "#d7191c",
}
MAPS = {  # family: (title, x label, y label)
    "step x stiffness": ("elastic platform, Hs 1.28 m", "platform stiffness (times)", "step / shortest wave period"),
    "step x Hs": ("fixed platform, Tp 7 s", "Hs [m]", "step / shortest wave period"),
    "Hs x Tp": ("elastic platform, sea states", "Tp [s]", "Hs [m]"),
    "Hs x Tp, stops": ("the same with end stops at 0.9 rad", "Tp [s]", "Hs [m]"),
    "mass x stiffness": (
        "elastic platform, default step; from 2 up the floats sink",
        "platform stiffness (times)",
        "float mass / displacement",
    ),
    "mass x PTO": ("fixed platform, default step", "PTO damping (times optimum)", "float mass / displacement"),
    "modes x damping": ("elastic platform, default step", "structural damping", "modes, besides static shapes"),
    "reference path": ("reference path, error against the fast one", "collocation", "step / shortest wave period"),
}


def _kind(outcome: str, error: float) -> str:
    if outcome == "ok":
        return "error < 0.1 %" if error < 1e-3 else "error < 1 %" if error < 1e-2 else "error >= 1 %"
    named = {"refused": "refused", "failed": "named failure", "repeated": "repeated with a quarter of the step"}
    return named.get(outcome, "NaN, traceback, hang")


def _order(values: np.ndarray) -> list[str]:
    return list(dict.fromkeys(values.tolist()))


def _cell(axes, x: int, y: int, outcome: str, error: float, width: float = 1.0) -> None:
    kind = _kind(outcome, error)
    axes.add_patch(plt.Rectangle((x, y), width, 1, facecolor=COLOURS[kind], edgecolor="white"))
    if np.isfinite(error):
        dark = kind == "error < 0.1 %"
        axes.text(x + width / 2, y + 0.5, f"{np.log10(max(error, 1e-12)):.0f}".replace("-", "−"), ha="center",
                  va="center", fontsize=7, color="white" if dark else "black")  # fmt: skip


def _map(axes, data: xr.Dataset, title: str, across: str, up: str) -> None:
    columns, lines = _order(data.x.values), _order(data.y.values)
    for x, y, outcome, error in zip(
        data.x.values, data.y.values, data.outcome.values, data.discretization_error.values, strict=True
    ):
        _cell(axes, columns.index(x), lines.index(y), outcome, error)
    axes.set(xlim=(0, len(columns)), ylim=(0, len(lines)), xlabel=across, ylabel=up)
    axes.set_xticks(np.arange(len(columns)) + 0.5, columns, fontsize=8)
    axes.set_yticks(np.arange(len(lines)) + 0.5, lines, fontsize=8)
    axes.set_title(title, fontsize=9, loc="left")
    axes.tick_params(length=0)
    axes.spines[:].set_visible(False)


def _strip(axes, data: xr.Dataset) -> None:
    """Single scenes as a list: a cell and its name, in four columns."""
    per = int(np.ceil(data.sizes["case"] / 4))
    for i, (family, x, y, outcome, error) in enumerate(
        zip(data.family.values, data.x.values, data.y.values, data.outcome.values,
            data.discretization_error.values, strict=True)
    ):  # fmt: skip
        column, line = 12 * (i // per), per - 1 - i % per
        _cell(axes, column, line, outcome, error, width=1.6)
        axes.text(column + 1.8, line + 0.5, f"{family}: {x}" + (f", {y}" if y else ""), fontsize=7.5, va="center")
    axes.set(xlim=(0, 48), ylim=(0, per))
    axes.set_title("single scenes", fontsize=9, loc="left")
    axes.axis("off")


def picture(data: xr.Dataset, path: Path) -> None:
    """Draw and save the map."""
    figure, axes = plt.subplot_mosaic(
        [["step x stiffness", "step x Hs", "Hs x Tp"], ["mass x stiffness", "mass x PTO", "modes x damping"],
         ["reference path", "Hs x Tp, stops", "."], ["single", "single", "single"]],
        figsize=(14, 17), height_ratios=(1, 1, 1, 1),
    )  # fmt: skip
    for family, labels in MAPS.items():
        _map(axes[family], data.isel(case=np.flatnonzero(data.family.values == family)), *labels)
    elsewhere = [*MAPS, "restart"]  # a restart is judged by its bits alone
    _strip(axes["single"], data.isel(case=np.flatnonzero(~np.isin(data.family.values, elsewhere))))
    handles = [Patch(color=colour, label=name) for name, colour in COLOURS.items()]
    figure.legend(handles=handles, loc="upper center", ncols=4, frameon=False, fontsize=9)
    note = "numbers: power of ten of the time step's estimated relative error"
    figure.text(0.5, 0.935, note, ha="center", fontsize=9)
    figure.tight_layout(rect=(0, 0, 1, 0.93))
    figure.savefig(path, dpi=110)
    plt.close(figure)
