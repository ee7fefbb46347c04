"""The figure of the README from results/buan/statistics.nc: `make figure` writes studies/buan.png."""

import sys
from pathlib import Path

import matplotlib as mpl
import numpy as np
import xarray as xr

from pipeline import study

mpl.use("Agg")
import matplotlib.pyplot as plt

FRONT, REAR, STEEL, WATER = "#d55e00", "#0072b2", "0.25", "#56b4e9"


def side_view(axes, content) -> None:
    """Legs, deck, arms and floats to scale; the lower legs are cut off."""
    nodes = dict(content.platform.nodes) | {f"hinge:{f.name}": f.hinge for f in content.floats}
    for member in content.platform.members:
        (x0, _, z0), (x1, _, z1) = nodes[member.start], nodes[member.end]
        axes.plot([x0, x1], [z0, z1], color=STEEL, lw=3 if member.drag_coefficient else 5, solid_capstyle="round")
    for item, color in zip(content.floats, (FRONT, REAR), strict=True):
        x, z = item.hinge[0] + item.arm[0], item.hinge[2] + item.arm[2]
        r, h = item.hull.radius, item.hull.height
        turn = np.linspace(np.pi, 2 * np.pi, 60)
        outline = [(x + r, z + h), (x - r, z + h), *zip(x + r * np.cos(turn), z + r * np.sin(turn), strict=True)]
        axes.fill(*np.array(outline).T, color=color, alpha=0.85, lw=0, zorder=3)
        axes.plot([item.hinge[0], x], [item.hinge[2], z + h], color=color, lw=2)
        axes.plot(item.hinge[0], item.hinge[2], "o", color="w", mec=color, ms=7, zorder=4)
        axes.text(x, z - r - 0.5, item.name, ha="center", va="top", color=color)
    s = np.linspace(-7, 7, 200)
    axes.plot(s, 0.25 * np.cos(0.9 * s), color=WATER, lw=1.5, zorder=1)
    axes.annotate("", (-4.6, 1.9), (-6.6, 1.9), arrowprops={"arrowstyle": "->", "color": WATER})
    axes.text(-5.6, 2.1, "waves", ha="center", color=WATER)
    axes.text(0, -5.6, "50 m to the seabed", ha="center", fontsize=9, color=STEEL, backgroundcolor="w")
    axes.set(xlim=(-7, 7), ylim=(-6, 4), aspect="equal")
    axes.axis("off")


def envelopes(axes, data) -> None:
    """Largest stress along front and rear legs, with and without floats (representative sea)."""
    sea = data.stress_envelope.sel(sea_state="representative") / 1e6
    for platform, style in (("elastic", "-"), ("elastic-no-floats", "--")):
        for leg, color, name in ((1, FRONT, "front legs"), (3, REAR, "rear legs")):
            mean = sea.sel(platform=platform, leg=leg).mean("seed")
            label = name if platform == "elastic" else f"{name}, no floats"
            axes.plot(mean, sea.height, style, color=color, lw=1.6, label=label)
    axes.set(xlabel="largest |stress| [MPa]", ylabel="height above the seabed [m]", xlim=(0, None))
    axes.legend(frameon=False, fontsize=8, loc="center left")


def power(axes, data) -> None:
    """Mean absorbed power by sea state: bars span the seeds."""
    mean = data.absorbed_power.sel(statistic="mean") / 1e3
    order = data.Hs.argsort().values
    for name, color in (("front", FRONT), ("rear", REAR)):
        for platform, mark, shift in (("elastic", "o", -0.08), ("fixed", "s", 0.08)):
            part = mean.sel(float=name, platform=platform).isel(sea_state=order)
            x = np.arange(len(order)) + shift
            axes.vlines(x, part.min("seed"), part.max("seed"), color=color, lw=2)
            axes.plot(x, part.mean("seed"), mark, color=color, mfc="w", ms=5, label=f"{name}, {platform}")
    states = data.sea_state.values[order]
    heights = data.Hs.values[order]
    labels = [f"{'rep.' if s == 'representative' else s}\n{h:.2f}" for s, h in zip(states, heights, strict=True)]
    axes.set_xticks(range(len(order)), labels, fontsize=8)
    axes.set(ylabel="mean absorbed power [kW]", xlabel="sea state, Hs [m]", ylim=(0, None))
    axes.legend(frameon=False, fontsize=8, loc="lower right")


def main() -> int:
    """Draw the three panels side by side."""
    content = study.load(Path("studies/buan.toml")).content
    with xr.open_dataset("results/buan/statistics.nc") as data:
        figure, panels = plt.subplots(1, 3, figsize=(13, 4.4), width_ratios=(1.25, 1, 1.2))
        side_view(panels[0], content)
        envelopes(panels[1], data)
        power(panels[2], data)
    for axes in panels[1:]:
        axes.spines[["top", "right"]].set_visible(False)
    figure.tight_layout()
    figure.savefig("studies/buan.png", dpi=110)
    return 0


if __name__ == "__main__":
    sys.exit(main())
