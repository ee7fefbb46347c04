"""What six rotors absorb on a moored platform, held and on fixed axes, beside six single ones: `make jeju`.

    python -m studies.jeju [RESULTS]

Reads the collected study, prints a table and draws studies/jeju.png.
"""

import sys
from pathlib import Path

import matplotlib as mpl
import numpy as np
import xarray as xr

from pipeline.bridge import hulls, scenes
from pipeline.bridge.loading import load
from pipeline.study.hulls import Duck
from pipeline.tasks.task import expand

mpl.use("Agg")
import matplotlib.pyplot as plt
from matplotlib.axes import Axes
from matplotlib.patches import Polygon, Rectangle

HERE = Path(__file__).parent
STUDY = HERE / "jeju-rotors.toml"
ARRAYS = {
    "fixed-axis": ("fixed axes", "#1f6fb4"),
    "held": ("platform held", "#2f8f4e"),
    "floating": ("afloat", "#e07b16"),
}
SINGLE = ("one alone", "#777777")
WIDTH = 60.0  # m, of the six rotors
SHOWN = 1e6  # N m s/rad, the damping of the figure


def opened(results: Path) -> xr.Dataset:
    """The collected dataset."""
    path = results / "jeju-rotors" / "statistics.nc"
    if not path.exists():
        sys.exit(f"{path}: not there yet; `make jeju` makes it")
    with xr.open_dataset(path) as data:
        return data.load()


def mean_power(data: xr.Dataset) -> xr.DataArray:
    """Of all rotors together [W]; a float that is not there adds nothing, the platform has no power take-off."""
    return data.absorbed_power.sel(statistic="mean").sum("float", min_count=1)


def q_factor(data: xr.Dataset) -> xr.DataArray:
    """Mean power of an array over that of six rotors alone in the same waves."""
    power = mean_power(data)
    return power / (6 * power.sel(variant="single"))


def by_period(data: xr.Dataset) -> xr.Dataset:
    """Rotation per wave amplitude [rad/m] of each rotor, and q, over the period of the waves of white noise."""
    noise = data.sel(sea_state="noise", pto_damping=SHOWN)
    omega = noise.wave_frequency.sel(variant="single")
    rao = noise.rao.sel(axis="hinge").assign_coords(component=2 * np.pi / omega.values).rename(component="period")
    squares = (rao**2).sum("float", min_count=1)  # power of a linear damper: half c omega² |rao|² an amplitude squared
    return xr.Dataset({"rao": rao, "q": squares / (6 * squares.sel(variant="single"))}).sortby("period")


def table(data: xr.Dataset) -> str:
    """Mean power, capture width over the rotors' width, and q of every sea with rotors in all variants, and damping."""
    power, q = mean_power(data), q_factor(data)
    lines = [f"{'sea':15}{'damping':>9}  " + "".join(f"{name:>23}" for name in ("six single", *ARRAYS))]
    lines.append(f"{'':15}{'MN m s':>9}  " + "".join(f"{'kW':>9}{'width':>7}{'q':>7}" for _ in range(1 + len(ARRAYS))))
    for sea in (str(s) for s in data.sea_state.values if s not in ("noise", "small")):
        for damping in data.pto_damping.values:
            cells = []
            for name in ("single", *ARRAYS):
                at = {"sea_state": sea, "pto_damping": damping, "variant": name}
                times = 6 if name == "single" else 1
                share = times * power.sel(at) / data.wave_power.sel(at) / WIDTH
                cells.append(
                    f"{times * float(power.sel(at)) / 1e3:9.1f}{float(share):7.2f}{times * float(q.sel(at)):7.2f}"
                )
            lines.append(f"{sea:15}{damping / 1e6:9.1f}  " + "".join(cells))
    lines += [drift(data, sea, damping) for sea in ("usual", "rated") for damping in data.pto_damping.values]
    for sea in ("small", "regular"):
        at = {"sea_state": sea, "pto_damping": 2e6}
        march, linear = (float(power.sel({**at, "variant": name})) for name in ("pair-time", "pair"))
        lines.append(f"two amidships, {sea}: {march:.4g} W in the time domain, {linear:.4g} W in frequency")
    return "\n".join(lines)


def drift(data: xr.Dataset, sea: str, damping: float) -> str:
    """Mean force on all afloat, what it moves the platform by, and its motion about that."""
    here = data.sel(variant="floating", sea_state=sea, pto_damping=damping)
    surge = here.sel(float="platform", axis="surge")
    numbers = (here.drift_force.sel(direction="x") / 1e3, surge.drift_offset, surge.slow_drift)
    force, offset, slow, fast = (float(x) for x in (*numbers, surge.motion.sel(statistic="std")))
    return (
        f"afloat, {sea}, {damping / 1e6:g} MN m s: mean drift {force:.1f} kN, offset {offset:.2f} m, std of slow drift"
        f" {slow:.2f} m, of surge with the waves {fast:.2f} m; energy to {float(here.energy_residual):.1%}"
    )


def draw_layout(axes: Axes) -> None:
    """The scene from above: outlines of the waterplane's bodies, and where the waves come from."""
    floats = next(iter(expand(load(STUDY).content))).parameters.floats
    for item in floats:
        x, y, _ = scenes.floating(item).centre
        hull = hulls.hull(item.hull)
        if isinstance(item.hull, Duck):
            low, width = hull.vertices[:, 0].min(), np.ptp(hull.vertices[:, 0])
            axes.add_patch(
                Rectangle((x + low, y - item.hull.width / 2), width, item.hull.width, fc="#9cc3e4", ec="k", lw=0.6)
            )
            axes.plot([x, x], y + np.array([-0.5, 0.5]) * item.hull.width, "k--", lw=0.8)
            axes.annotate(item.name.removeprefix("rotor-"), (x - 4, y), ha="center", va="center", fontsize=8)
        else:
            for panel in hull.panels[np.all(hull.panels[:, :, 2] > 0, axis=1)]:
                axes.add_patch(Polygon(panel[:, :2] + [x, y], fc="#d9d9d9", ec="none"))
    for x in (-14, 14):
        axes.plot([x, x], [-25, 25], color="0.5", lw=1, zorder=0)
    for y in (-25, 25):
        axes.plot([-14, 14], [y, y], color="0.5", lw=1, zorder=0)
    axes.annotate("", (-24, 0), (-34, 0), arrowprops={"arrowstyle": "->", "color": "#1f6fb4"})
    axes.annotate("waves", (-29, 1.5), ha="center", fontsize=8, color="#1f6fb4")
    axes.set(
        xlim=(-36, 24), ylim=(-31, 31), aspect="equal", xlabel="x [m]", ylabel="y [m]", title="From above; dashed: axes"
    )


def draw(data: xr.Dataset, path: Path) -> None:
    """Layout, rotation of front and rear rotors, q by period, power by damping."""
    figure, ((above, turning), (gain, power)) = plt.subplots(2, 2, figsize=(10, 8))
    draw_layout(above)
    curves = by_period(data)
    single = curves.rao.sel(variant="single", float="rotor-2")
    turning.plot(curves.period, single, color=SINGLE[1], lw=1.6, label=SINGLE[0])
    for name in ("fixed-axis", "floating"):
        words, colour = ARRAYS[name]
        for rotor, style in (("rotor-2", "-"), ("rotor-5", "--")):
            row = "front" if rotor == "rotor-2" else "rear"
            turning.plot(
                curves.period, curves.rao.sel(variant=name, float=rotor), style, color=colour, label=f"{words}, {row}"
            )
    turning.set(
        xlabel="period [s]", ylabel="rotation [rad/m]", title="Middle rotors, rotation per wave amplitude", xlim=(3, 14)
    )
    for name, (words, colour) in ARRAYS.items():
        gain.plot(curves.period, curves.q.sel(variant=name), color=colour, label=words)
    gain.axhline(1, color="0.4", lw=0.8)
    gain.set(xlabel="period [s]", ylabel="q", title="Power over that of six rotors alone", xlim=(3, 14), ylim=(0, None))
    means = mean_power(data).sel(sea_state="rated") / 1e3
    power.plot(
        data.pto_damping / 1e6, 6 * means.sel(variant="single"), "o-", color=SINGLE[1], label="six times one alone"
    )
    for name, (words, colour) in ARRAYS.items():
        power.plot(data.pto_damping / 1e6, means.sel(variant=name), "o-", color=colour, label=words)
    power.set(
        xscale="log",
        xlabel="damping of each [MN m s/rad]",
        ylabel="kW",
        title="Mean power, Hs 3 m, Tp 7.5 s",
        ylim=(0, None),
    )
    power.set_xticks(data.pto_damping / 1e6, [f"{x / 1e6:g}" for x in data.pto_damping.values])
    power.minorticks_off()
    for axes in (turning, gain, power):
        axes.grid(lw=0.4, color="0.88")
        axes.spines[["top", "right"]].set_visible(False)
        axes.legend(frameon=False, fontsize=8)
    figure.tight_layout()
    figure.savefig(path, dpi=110)


def main(arguments: list[str]) -> int:
    """The table, and the figure."""
    data = opened(Path(arguments[0]) if arguments else Path("results"))
    print(table(data))
    draw(data, HERE / "jeju.png")
    print(f"figure in {HERE / 'jeju.png'}")
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
