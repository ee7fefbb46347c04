"""Cost against size: record length, wave components, floats and modes; and the memory of a long record."""

import subprocess
import sys
from collections.abc import Sequence
from dataclasses import replace

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.ticker import NullFormatter
from scipy.linalg import block_diag

from solver.hydrodynamics.bem.coefficients import Hydrodynamics
from solver.run import simulate
from solver.scene import Scene
from solver.sea.dispersion import wavenumber
from solver.sea.realization import realize
from solver.sea.spectrum import PiersonMoskowitz
from studies.benchmark.case import OUT, RUNS, coefficients, scene, with_settings

SECONDS = 900.0
LENGTHS = [450, 900, 1800, 3600, 10800]  # s
COMPONENTS = [33, 65, 130, 260, 520]
PAIRS = [1, 2, 3, 4]
MODES = [6, 12, 24, 48, 96, 192]
APART = 100.0  # between pairs, whose waves are left out of one another [m]
# VmHWM, not getrusage's maximum: a child inherits that from the process that started it.
LONG = """
from pathlib import Path
from studies.benchmark.case import coefficients, scene, with_settings
from solver.run import simulate
simulate(with_settings(scene("elastic"), duration=10800.0), coefficients()[0])
print(next(int(x.split()[1]) / 1024 for x in Path("/proc/self/status").read_text().splitlines() if "VmHWM" in x))
"""


def pairs(count: int) -> tuple[Scene, Hydrodynamics]:
    """`count` pairs of the fixed case in a row, far apart."""
    one, (h, _) = scene("fixed"), coefficients()
    k = wavenumber(h.omega, h.depth, h.gravity)
    arrival = np.exp(1j * np.outer(k, np.repeat(APART * np.arange(count), h.added_mass.shape[1])))

    def blocks(x):
        return np.array([block_diag(*[m] * count) for m in x])

    known = replace(
        h,
        added_mass=blocks(h.added_mass),
        radiation_damping=blocks(h.radiation_damping),
        added_mass_inf=block_diag(*[h.added_mass_inf] * count),
        diffraction=np.tile(h.diffraction, count) * arrival,
        froude_krylov=np.tile(h.froude_krylov, count) * arrival,
        hydrostatic_stiffness=block_diag(*[h.hydrostatic_stiffness] * count),
        displaced_mass=np.tile(h.displaced_mass, count),
        error=None,
        buoyancy_centre=np.tile(h.buoyancy_centre, count),
        centres=np.concatenate([h.centres + np.array([APART * i, 0, 0]) for i in range(count)]),
    )
    floats = tuple(
        replace(f, name=f"{f.name}{i}", hinge=(f.hinge[0] + APART * i, *f.hinge[1:]))
        for i in range(count)
        for f in one.floats
    )
    # A looser fit for all: fitting is done once a geometry, and not what is timed here.
    return with_settings(replace(one, floats=floats), duration=SECONDS, memory_tolerance=0.1), known


def _sea(components: int):
    return realize(
        PiersonMoskowitz(Hs=1.28, Tp=5.46), components=components, band=(0.7, 3.4), intervals="random", heading=0.0,
        seed=(1,),
    )  # fmt: skip


def marches(cases: list[tuple[Scene, Hydrodynamics]]) -> list[float]:
    """Median times of the march [s], run in turn: what slows the machine slows all; what is prepared is kept."""
    times = [[simulate(*case).attrs["march_time"] for case in cases] for _ in range(RUNS + 1)]
    return np.median(times[1:], axis=0).tolist()


def measure() -> dict[str, tuple[Sequence[float], list[float]]]:
    """Quantity -> (sizes, times of the march [s])."""
    known, _ = coefficients()
    elastic = scene("elastic")
    short = with_settings(elastic, duration=SECONDS)
    times_of: dict[str, tuple[Sequence[float], list[float]]] = {
        "record length [s]": (LENGTHS, marches([(with_settings(elastic, duration=float(t)), known) for t in LENGTHS])),
        "wave components": (COMPONENTS, marches([(replace(short, sea=_sea(n)), known) for n in COMPONENTS])),
        "floats (fixed platform)": ([2 * n for n in PAIRS], marches([pairs(n) for n in PAIRS])),
        "modes kept": (MODES, marches([(with_settings(short, modes=m), known) for m in MODES])),
    }
    for name, (sizes, times) in times_of.items():
        order = np.polyfit(np.log(sizes), np.log(times), 1)[0]
        print(f"{name:26s}" + "".join(f"{n:>8g}: {t:6.2f} s" for n, t in zip(sizes, times, strict=True)))
        print(f"{'':26s}grows as size^{order:.2f}")
    return times_of


def memory_of_three_hours() -> float:
    """Largest resident memory [MB] of a process that simulates a 3-hour record."""
    done = subprocess.run([sys.executable, "-c", LONG], capture_output=True, text=True, check=True)
    return float(done.stdout)


def picture(times_of: dict[str, tuple[Sequence[float], list[float]]]) -> None:
    """One panel a quantity, with a line of linear growth."""
    figure, panels = plt.subplots(1, len(times_of), figsize=(12, 3.2), sharey=True)
    for axes, (name, (sizes, times)) in zip(panels, times_of.items(), strict=True):
        axes.loglog(sizes, times, "o-", label="measured")
        axes.loglog(sizes, times[0] * np.array(sizes) / sizes[0], "--", color="0.6", label="linear")
        axes.set_xticks(sizes, [f"{size:g}" for size in sizes])
        axes.xaxis.set_minor_formatter(NullFormatter())
        axes.set_xlabel(name)
        axes.spines[["top", "right"]].set_visible(False)
    panels[0].set_ylabel("time of the march [s]")
    panels[0].legend(frameon=False)
    figure.suptitle("Cost against size: Buan, one core")
    figure.tight_layout()
    figure.savefig(OUT / "scaling.png", dpi=130)
    plt.close(figure)
