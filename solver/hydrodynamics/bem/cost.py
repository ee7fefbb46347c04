"""How long boundary elements take, told before there is a Green function."""

import time
from statistics import median

import numpy as np
from scipy.linalg import lu_factor

from solver.hydrodynamics.bem.mesh import Mesh
from solver.hydrodynamics.bem.problem import Problem
from solver.hydrodynamics.bem.seabed import Box, Work, clearance
from solver.hydrodynamics.bem.turned import Alike
from solver.hydrodynamics.hull import mesh as meshes
from solver.hydrodynamics.hull.standing import stands

# Processor time [s] on the machine of solver/README.md: `python -m studies.benchmark.boundary` prints all but NODE.
FREE, SEABED = 3.7e-7, 2.9e-6  # Green function of a pair of panels, in deep water and above a seabed that matters
NODE = 8e-10  # what each of a body's nodes adds to one in deep water, see `seabed`
FACTORED = 1e-10  # a system's factorization, over the cube of its panels
PROBE, PROBES = 400, 5  # panels of a system, and how often it is factorized, to see how fast a machine is


def seconds(problem: Problem) -> float:
    """Processor time [s] to solve a problem, to a factor of 3: Green function and factorizations, no damping lids."""
    return sum(_together(alone) for alone in problem.apart.values()) if problem.flow else 0.0


def pace() -> float:
    """How many times as long as that this machine takes, beside all else that it does now: by factorizations."""
    matrix = np.eye(PROBE) + 1j * np.random.default_rng(0).random((PROBE, PROBE))
    clock = []
    for _ in range(PROBES + 1):  # the first loads the library
        lu_factor(matrix)
        clock.append(time.perf_counter())
    return float(median(np.diff(clock))) / (FACTORED * PROBE**3)


def _together(problem: Problem) -> float:
    """Images of a plane of symmetry are seen, not solved for; each is the mirror of a system of its own."""
    images = len(meshes.mirror_planes(problem.hulls, problem.centres)[1])
    waves = [*(problem.seas[0].wavenumber(w) for w in problem.omega), np.inf]
    points, stand = [h.surface_points()[0] for h in problem.hulls], [stands(h, problem.depth) for h in problem.hulls]
    drafts = [hull.draft for hull, footed in zip(problem.hulls, stand, strict=True) if not footed]
    clear = clearance(problem.depth, max(drafts, default=problem.depth), standing=problem.standing)
    nodes = [
        np.array([Box.about(of, clear, k).count if np.isfinite(problem.seabed(k)) else 0 for of in points])
        for k in waves
    ]
    total = 0.0
    for n in problem.divisions:
        where = problem.meshed, problem.centres, problem.dofs, problem.base, n, problem.depth
        mesh = Mesh.build(*where, lids=problem.lids, narrow=problem.meshing.narrow)
        part = mesh.part.nb_faces
        seen, sent = (np.bincount(of, minlength=len(points)) for of in (mesh.bodies, mesh.bodies[:part]))
        asked, close = _asked(mesh.alike), _asked(mesh.footed[-1]) if mesh.standing.any() else 0
        total += len(waves) * images * FACTORED * part**3
        for m in nodes:
            near = not all(stand) and Work.of(m, seen, sent, np.array(stand)).pays
            free = FREE * asked + SEABED * close + NODE * m.mean() * images * part**2
            total += free if near else SEABED * asked
    return total


def _asked(alike: list[Alike]) -> int:
    """For how many pairs of panels the Green function is asked."""
    return sum(len(pairs.at) * pairs.sources.nb_faces for pairs in alike)
