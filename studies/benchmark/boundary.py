"""What boundary elements cost beside what `study plan` foresees: `python -m studies.benchmark.boundary`.

Processor time of one core.
"""

import time
from collections.abc import Callable, Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np
from capytaine.green_functions.delhommeau import Delhommeau
from scipy.linalg import lu_factor

from pipeline.bridge.geometry import bem_problem, geometry_of
from solver.hydrodynamics.bem import cost
from solver.hydrodynamics.bem.bem import part
from solver.hydrodynamics.bem.green import green_function, joined
from solver.hydrodynamics.bem.grid import frequency_grid
from solver.hydrodynamics.bem.problem import Problem
from solver.hydrodynamics.hull import mesh as meshes
from solver.hydrodynamics.hull import meshfile
from solver.hydrodynamics.hull.box import box
from solver.hydrodynamics.hull.duck import duck
from solver.hydrodynamics.hull.mesh import Hull
from solver.hydrodynamics.hull.panel_hull import PanelHull
from solver.hydrodynamics.hull.revolution import Revolution
from studies.benchmark.case import task

EVERY = 10  # of the frequencies, one is solved for
BARGE = Path("studies/barge.gdf")


def seconds(function: Callable[..., object], *arguments: object) -> float:
    """Processor time of one call [s]."""
    start = time.process_time()
    function(*arguments)
    return time.process_time() - start


def parts() -> tuple[float, float, float]:
    """Processor time [s] of a pair of panels, free and above a seabed; of a factorization, over its panels cubed."""
    mesh = joined([meshes.panels(Revolution.sphere(radius=5.0, draft=5.0), 600)])
    pairs = mesh.nb_faces**2

    def pair(depth: float) -> float:
        def evaluate(k: float) -> None:
            green_function().evaluate(mesh, mesh, water_depth=depth, wavenumber=k, adjoint_double_layer=False)

        evaluate(0.1)  # import, and read the table
        return float(np.mean([seconds(evaluate, k) for k in (0.05, 0.1, 0.2, 0.4)])) / pairs

    matrix = np.eye(600) + 1j * np.random.default_rng(0).random((600, 600))
    return pair(np.inf), pair(20.0), seconds(lu_factor, matrix) / 600**3


def problems() -> Iterator[tuple[str, Problem]]:
    """Scenes as unlike as their costs are."""
    raft, barge = box(length=20.0, width=10.0, height=4.0, draft=2.0), meshfile.read(BARGE.name, BARGE.read_bytes())
    rotor = duck(radius=1.3, beak=2.6, elevation=0.3, submergence=0.7, width=7.0)
    sunk = PanelHull.of(barge[0] - (0.0, 0.0, 6.0), barge[1])
    geometry = geometry_of(task("elastic").parameters)
    assert geometry is not None, "the pair has floats"
    yield "Buan's pair", bem_problem([geometry])
    yield "two rotors", _problem((rotor, rotor), [(-8, 0, 0), (8, 0, 0)], np.inf)
    yield "two boxes in 40 m", _problem((raft, raft), [(-10.5, 0, 0), (10.5, 0, 0)], 40.0)
    yield "box beside mesh", _problem((raft, PanelHull.of(*barge)), [(0, 0, 0), (5, 30, 0)], 40.0, planar=False)
    yield "mesh under water in 40 m", _problem((sunk,), [(0, 0, 0)], 40.0)


def _problem(
    hulls: tuple[Hull, ...], centres: list[tuple[float, ...]], depth: float, *, planar: bool = True
) -> Problem:
    at = np.array(centres, float)
    return Problem.of(hulls, at, depth=depth, omega=frequency_grid(hulls, at, depth=depth), planar=planar)


def table() -> None:
    """Print what parts cost, and solutions beside what was foreseen."""
    free, seabed, factored = parts()
    print(f"Green function of a pair of panels: {free:.2g} s, above a seabed {seabed:.2g} s;", end=" ")
    print(f"factorization over panels cubed: {factored:.2g} s")
    print(f"this machine takes {cost.pace():.2f} times as long as the one of cost.py, as `study plan` takes it")
    table_time = seconds(lambda: Delhommeau(tabulation_cache_dir=None))
    print(f"the Green function's table, once for each machine: {table_time:.0f} s")
    for name, whole in problems():
        some = replace(whole, omega=whole.omega[::EVERY])
        told, spent = cost.seconds(some), seconds(part, some)
        print(f"  {name:28s}{len(some.omega):3d} of {len(whole.omega)} frequencies: {spent:6.2f} s,", end=" ")
        print(f"over what was foreseen {spent / told:.2f}; all {cost.seconds(whole):.0f} s")


if __name__ == "__main__":
    table()
