"""Linear potential flow about hulls by boundary elements; capytaine evaluates the Green function.

The mirror planes, the systems and the forces are ours, so that every right-hand side of a frequency
shares one factorization, and parts that a symmetry makes zero are never solved. Conventions: see `coefficients`.
"""

from collections.abc import Sequence
from functools import partial
from types import MappingProxyType
from typing import Any

import numpy as np

from solver.errors import InputError
from solver.hydrodynamics.bem.alone import assembled
from solver.hydrodynamics.bem.coefficients import DOFS, PLANAR, Hydrodynamics, MeshError, symmetric
from solver.hydrodynamics.bem.extrapolation import TWO_MESHES, Solution, extrapolated, of_edges, of_one_mesh, of_plates
from solver.hydrodynamics.bem.far_field import FarField
from solver.hydrodynamics.bem.grid import frequency_grid
from solver.hydrodynamics.bem.mean_hull import at_rest, body_name, froude_krylov, motion_lengths
from solver.hydrodynamics.bem.mesh import Mesh
from solver.hydrodynamics.bem.problem import HALVED, Problem, require_solvable
from solver.hydrodynamics.hull import mesh as meshes
from solver.hydrodynamics.hull.mesh import Hull
from solver.hydrodynamics.radiation.passivity import radiates

__all__ = [
    "DOFS", "PLANAR", "Hydrodynamics", "Problem", "frequency_grid", "part", "require_solvable", "solve", "united",
]  # fmt: skip

METHODS = {1: "one mesh as given", 2: "h2-extrapolated from two meshes", 3: "h2-extrapolated from two of three meshes"}
ACTIVE = 0.02  # of the largest of A + iB/ω: less of negative damping is a mesh's error
LITTLE = 0.02  # of a body's most added mass over squared levers
NEGATIVE = -0.1  # least eigenvalue of A∞, scaled to a diagonal of 1: far below what errors of meshes leave, 0.06 to 1


def solve(hulls: tuple[Hull, ...], centres: np.ndarray, *, heading: float = 0.0, **water: Any) -> Hydrodynamics:
    """Coefficients of `hulls` at `centres` (nb, 3) [m] for waves towards `heading` [rad]; see Problem for the rest."""
    problem = Problem.of(hulls, centres, headings=(heading,), **water)
    return united(problem, [part(problem)])[0]


def part(problem: Problem, first: int = 0, step: int = 1) -> list[list[Solution]]:
    """Of each problem apart, and of each mesh, the finest first: frequencies `first`, first + step, and so on.

    Infinite frequency goes with 0.
    """
    return [_solutions(alone, first, step) for alone in problem.apart.values()]


def _solutions(problem: Problem, first: int, step: int) -> list[Solution]:
    omega = problem.omega[first::step]
    if not problem.flow:
        return [_nothing(problem, omega.size)]
    return [_coefficients(problem, omega, n, infinite=first == 0) for n in problem.divisions]


def united(problem: Problem, parts: Sequence[list[list[Solution]]]) -> list[Hydrodynamics]:
    """Coefficients for each heading, from all parts in order of their first frequencies."""
    found = {
        hull: _united(alone, pieces)
        for (hull, alone), pieces in zip(problem.apart.items(), zip(*parts, strict=True), strict=True)
    }
    if problem.interaction:
        return found[problem.hulls[0]]
    each = [found[hull] for hull in problem.hulls]
    return [assembled(alone, problem.centres) for alone in zip(*each, strict=True)]


def _united(problem: Problem, parts: Sequence[list[Solution]]) -> list[Hydrodynamics]:
    hulls, omega, seas = problem.hulls, problem.omega, problem.seas
    solutions = [_interleaved(pieces) for pieces in zip(*parts, strict=True)]
    best, error = list(solutions[0][:4]), None
    if problem.flow:
        best, left = _limits(problem, solutions)
        error = MeshError(left[0].real, left[0].imag * omega[:, None, None], left[1], left[2])
    impedance, impedance_inf, diffraction, far = best
    settings = _settings(problem, solutions)
    origin, n = meshes.mirror_planes(hulls, problem.centres)[0][:2], len(impedance_inf)
    return [
        Hydrodynamics(
            omega=omega,
            added_mass=impedance.real,
            radiation_damping=impedance.imag * omega[:, None, None],
            added_mass_inf=impedance_inf,
            diffraction=diffraction[:, h],
            froude_krylov=froude_krylov(hulls, problem.centres, problem.dofs, sea, omega),
            settings=MappingProxyType(settings),
            error=error and error._replace(diffraction=error.diffraction[:, h]),
            far_field=FarField(origin, far[:, :n], far[:, n + h]) if problem.far_field else None,
            waves_to=problem.waves_to,
            **at_rest(hulls, problem.centres, problem.dofs, sea),
        )
        for h, sea in enumerate(seas)
    ]


def _settings(problem: Problem, solutions: list[Solution]) -> dict[str, Any]:
    """How it was solved, as files have it."""
    settings: dict[str, Any] = {"panels": solutions[0].panels, "panels_coarse": solutions[-1].panels}
    if problem.gap_damping > 0:
        settings |= {"gap_damping": problem.gap_damping, "gap_width": problem.gap_width}
    if not problem.flow:
        return settings | {"method": "none: nothing radiates or diffracts"}
    meshed = len(problem.divisions)
    how = f"finest of {meshed} meshes, damping lid" if solutions[0].lid > 0 else METHODS[meshed]
    seabed_error = 0.0 if problem.standing else problem.seas[0].seabed_error(problem.omega, *problem.largest)
    settings |= {"method": f"direct, {how}, lid on the waterplane", "green_function": "Delhommeau"}
    settings |= {"seabed_error": seabed_error} | ({"coarser": problem.coarser} if problem.coarser else {})
    return settings


def _limits(problem: Problem, solutions: list[Solution]) -> tuple[list[np.ndarray], list[np.ndarray]]:
    """Of zero panel size, and what is left of the error."""
    lengths = motion_lengths(problem.hulls, problem.dofs)
    body = np.repeat(np.arange(len(problem.hulls)), len(problem.dofs))
    plates = [found for found in map(meshes.plates, problem.meshed, problem.counts) if found]
    share = TWO_MESHES if plates else of_edges(problem.meshed, problem.base, narrow=problem.meshing.narrow)
    if len(solutions) == 1:
        share = of_one_mesh(problem.meshed, problem.base, narrow=problem.meshing.narrow)
    best, left = extrapolated(solutions, problem.divisions, (lengths, body), share)
    if plates and len(solutions) <= len(HALVED):
        left = of_plates(plates, left, best)
    _require_positive(problem, best[1], lengths, body)
    _require_damped(problem, best[0], lengths, body)
    own = np.arange(len(body))
    off, less = left[0].imag[:, own, own], -best[0].imag[:, own, own]
    left[0].imag[:, own, own] = np.where(np.abs(off) < less, less, off)  # damping less than none is off by that
    return best, left


def _require_damped(problem: Problem, impedance: np.ndarray, lengths: np.ndarray, body: np.ndarray) -> None:
    """Refuse A + iB/ω (nw, n, n) of a motion that takes power from the waves it radiates at most frequencies.

    Where next to nothing radiates, as from within a moonpool above its own frequencies, the sign is the panels' noise.
    """
    own = np.einsum("wii->wi", impedance)
    size = np.abs(own).max(axis=0)
    negative = own.imag < -ACTIVE * size
    for i in np.flatnonzero((np.mean(negative, axis=0) > 0.5) & radiates(size, lengths, body)):
        w = int(own[:, i].imag.argmin())
        what = f"damping of {problem.dofs[i % len(problem.dofs)]} is negative at {np.sum(negative[:, i])} of"
        what += (
            f" {len(own)} frequencies, most at {problem.omega[w]:.4g} rad/s ({problem.omega[w] * own[w, i].imag:.3g})"
        )
        raise InputError(
            "hulls", body_name(problem.hulls, body[i]), f"{what}: is it a film of water beside its panels?"
        )


def _require_positive(problem: Problem, infinite: np.ndarray, lengths: np.ndarray, body: np.ndarray) -> None:
    """Refuse added mass at infinite frequency (n, n) that is not positive: half of vᵀA∞v is the water's energy.

    Motions with little of it, see `radiates`, may have less than none by their mesh's error, also together with
    others: a ball moves no water as it turns about its own centre.
    """
    size = np.abs(np.diag(infinite))
    heard = np.flatnonzero(radiates(size, lengths, body, least=LITTLE))
    scale = np.sqrt(size[heard])
    value, shape = np.linalg.eigh(infinite[np.ix_(heard, heard)] / np.multiply.outer(scale, scale))
    if value.min(initial=0.0) < NEGATIVE:
        worst = heard[np.argmax(np.abs(shape[:, 0]))]
        where = f"above all in {problem.dofs[worst % len(problem.dofs)]} ({infinite[worst, worst]:.3g})"
        limit = f"added mass at infinite frequency is not positive, {where}: do panels lie in each other?"
        raise InputError("hulls", body_name(problem.hulls, body[worst]), limit)


def _nothing(problem: Problem, count: int) -> Solution:
    """Where bodies neither radiate nor diffract."""
    n = len(problem.hulls) * len(problem.dofs)
    impedance, force = np.zeros((count, n, n), complex), np.zeros((count, len(problem.headings), n), complex)
    return Solution(impedance, np.zeros((n, n)), force, np.zeros((count, 0, 0), complex), 0.0, 0)


def _interleaved(pieces: Sequence[Solution]) -> Solution:
    """The solution of one mesh at all frequencies, from that at every n-th one from the first, second ... n-th on."""
    index = np.argsort(np.concatenate([k + len(pieces) * np.arange(len(p.impedance)) for k, p in enumerate(pieces)]))
    return pieces[0]._replace(
        impedance=np.concatenate([p.impedance for p in pieces])[index],
        diffraction=np.concatenate([p.diffraction for p in pieces])[index],
        far=np.concatenate([p.far for p in pieces])[index],
    )


def _coefficients(problem: Problem, omega: np.ndarray, refine: int, *, infinite: bool) -> Solution:
    """At frequencies (nw,), of one mesh; A(inf) is empty where it is not asked for."""
    hulls, centres, dofs, seas = problem.meshed, problem.centres, problem.dofs, problem.seas
    where = hulls, centres, dofs, problem.base, refine, problem.depth
    build = partial(Mesh.build, *where, narrow=problem.meshing.narrow)
    mesh = build(lids=problem.lids, gap_width=problem.gap_width)
    n, sea = mesh.motions.shape[-1], seas[0]
    limit = np.zeros((0, 0))
    if infinite:  # no irregular frequency there, and no damping: φ = 0 on all still water
        bare = build(lids=())
        potentials = bare.solve(bare.motions, np.inf, problem.seabed(np.inf))
        limit = symmetric(sea.density * bare.forces(potentials, n).real)
    impedance = np.empty((len(omega), n, n), complex)
    diffraction = np.empty((len(omega), len(seas), n), complex)
    far = np.empty((len(omega), (n + len(seas)) * problem.far_field, max(2 * problem.orders + 1, 0)), complex)
    for i, w in enumerate(omega):
        loss = problem.gap_damping * w**2 / sea.gravity * mesh.gap.any()
        sources = np.concatenate([mesh.motions, mesh.scattered(seas, w, loss)], axis=2)
        k = sea.wavenumber(w)
        potentials = mesh.solve(sources, k, problem.seabed(k), loss)
        forces = sea.density * mesh.forces(potentials, sources.shape[2])
        impedance[i], diffraction[i] = symmetric(forces[:n]), 1j * w * forces[n:]
        if problem.far_field:
            far[i] = mesh.far_field(potentials, sources, mesh.plane_waves(k, sea.depth, problem.orders), loss)
            far[i, n:] /= [s.pressure(mesh.origin[None], w) / (s.density * s.gravity) for s in seas]  # phase zero there
    lid = float(mesh.part.faces_areas[mesh.gap].sum()) * len(mesh.mirrors)
    return Solution(impedance, limit, diffraction, far, lid, int(mesh.wet.sum()) * len(mesh.mirrors))
