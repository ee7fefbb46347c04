"""Figures of one look: ours as lines, published numbers as markers."""

import matplotlib as mpl
import numpy as np

from studies.validation.checks import OUT

mpl.use("Agg")
import matplotlib.pyplot as plt

plt.rcParams |= {"axes.titlesize": 10, "axes.labelsize": 9, "xtick.labelsize": 8, "ytick.labelsize": 8}

MARK = {"ls": "", "ms": 5, "mfc": "white", "mew": 1.1}  # of a published number
BLUE, ORANGE, GREEN, RED, GREY = "#1f6fb4", "#e07b16", "#2f8f4e", "#b8323a", "#777777"


def axes(count: int = 1, *, width: float = 4.6, height: float = 3.6, **options):
    """A figure and `count` axes (array) side by side."""
    figure, grid = plt.subplots(1, count, figsize=(max(width * count, 6.4), height), squeeze=False, **options)
    return figure, grid[0]


def save(figure, name: str, *, legend=None) -> None:
    """One PNG; a legend in every axes, or in those of `legend`."""
    for each in figure.axes:
        each.spines[["top", "right"]].set_visible(False)
        each.grid(lw=0.4, color="0.88")
        each.set_axisbelow(True)
        if (legend is None or each in np.atleast_1d(legend)) and each.get_legend_handles_labels()[0]:
            each.legend(frameon=False, fontsize=7.5)
    figure.tight_layout()
    OUT.mkdir(parents=True, exist_ok=True)
    figure.savefig(OUT / f"{name}.png", dpi=140)
    plt.close(figure)
