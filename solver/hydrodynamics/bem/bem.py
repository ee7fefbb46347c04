"""Linear potential flow about hulls by boundary elements; capytaine evaluates the Green function.

The mirror planes, the systems and the forces are ours, so that every right-hand side of a frequency
shares one factorization, and parts that a symmetry makes zero are never solved. Conventions: see `coefficients`.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property, partial
from types import MappingProxyType
from typing import Any, NamedTuple

import numpy as np

from solver.errors import InputError
from solver.hydrodynamics.bem.alone import assembled
from solver.hydrodynamics.bem.coefficients import DOFS, PLANAR, Hydrodynamics, MeshError, symmetric
from solver.hydrodynamics.bem.extrapolation import TWO_MESHES, Solution, extrapolated, of_edges, of_plates
from solver.hydrodynamics.bem.far_field import FarField, orders
from solver.hydrodynamics.bem.grid import RESOLVED, frequency_grid
from solver.hydrodynamics.bem.incident import Sea
from solver.hydrodynamics.bem.mean_hull import at_rest, body_name, froude_krylov, motion_lengths
from solver.hydrodynamics.bem.mesh import Mesh
from solver.hydrodynamics.hull import mesh as meshes
from solver.hydrodynamics.hull import surface
from solver.hydrodynamics.hull.clearance import openings, slips, touching
from solver.hydrodynamics.hull.coarse import fewer
from solver.hydrodynamics.hull.mesh import Hull
from solver.hydrodynamics.hull.panel_hull import PanelHull
from solver.hydrodynamics.hull.standing import stands
from solver.hydrodynamics.radiation.passivity import radiates
from solver.sea.dispersion import SHALLOWEST, longest

__all__ = [
    "DOFS", "PLANAR", "Hydrodynamics", "Problem", "frequency_grid", "part", "require_solvable", "solve", "united",
]  # fmt: skip

DIVISIONS = 3, 2, 1  # of one base mesh: a family, so that its h² error can be extrapolated away, and the rest be judged
HALVED = 2, 1  # the same where a hull is a mesh, which is as its author made it, or coarser, and halved
METHODS = {1: "one mesh as given", 2: "h2-extrapolated from two meshes", 3: "h2-extrapolated from two of three meshes"}
FINER = 6.0  # times the panels that a body gets, at most, where waves of the scene are shorter than that
AFFORDABLE = 3e6  # panels squared over mirror images of a halved mesh, 3 s a frequency; larger ones are solved unhalved
NEGATIVE = -0.1  # least eigenvalue of A∞, scaled to a diagonal of 1: far below what errors of meshes leave, 0.06 to 1


def solve(hulls: tuple[Hull, ...], centres: np.ndarray, *, heading: float = 0.0, **water: Any) -> Hydrodynamics:
    """Coefficients of `hulls` at `centres` (nb, 3) [m] for waves towards `heading` [rad]; see Problem for the rest."""
    problem = Problem.of(hulls, centres, headings=(heading,), **water)
    return united(problem, [part(problem)])[0]


@dataclass(frozen=True, eq=False, kw_only=True)
class Problem:
    """What is solved; any number of headings share what radiates.

    Each coefficient is the h² extrapolation from a mesh of about `panels` a body and one of 4/9 as many. A hull
    that is a mesh is solved as it is, or halved until it has panels / 4, and with all sides halved once more; one of
    more than twice as many panels in place of that with coarser ones, see `coarse`.
    """

    hulls: tuple[Hull, ...]
    centres: np.ndarray  # (nb, 3) [m]
    depth: float  # [m, may be inf]
    density: float
    gravity: float
    headings: tuple[float, ...]  # [rad]
    omega: np.ndarray  # (nw,) [rad/s]
    waves_to: float  # [rad/s] see Hydrodynamics
    dofs: tuple[str, ...]
    panels: int
    interaction: bool  # without, each body is alone in the water, and equal ones are solved for once
    far_field: bool  # whether the waves far off are wanted
    # On still water where no circle of this diameter fits ∂φ/∂z = (1 + iε) ω²/g φ: see Mesh.
    gap_damping: float  # ε
    gap_width: float  # [m]
    flow: bool  # whether bodies radiate or diffract; without nothing is solved, and waves' pressure alone is known

    @classmethod
    def of(
        cls,
        hulls: tuple[Hull, ...],
        centres: np.ndarray,
        *,
        depth: float,
        density: float = 1025.0,
        gravity: float = 9.81,
        headings: tuple[float, ...] = (0.0,),
        omega: np.ndarray | None = None,
        waves_to: float = np.inf,
        planar: bool = True,
        panels: int = meshes.PANELS,
        interaction: bool = True,
        far_field: bool = False,
        gap_damping: float = 0.0,
        gap_width: float = 0.0,
        flow: bool = True,
    ) -> "Problem":
        """Checked, see require_solvable; frequencies as frequency_grid chooses them unless given."""
        at = np.asarray(centres, float).reshape(-1, 3)
        if omega is None:
            omega = frequency_grid(hulls, at, depth=depth, gravity=gravity, interaction=interaction)
        grid = np.asarray(omega, float)
        require_solvable(hulls, at, depth, grid, gravity, panels, interaction=interaction)
        return cls(
            hulls=hulls,
            centres=at,
            depth=depth,
            density=density,
            gravity=gravity,
            headings=headings,
            omega=grid,
            waves_to=waves_to,
            dofs=PLANAR if planar else DOFS,
            panels=panels,
            interaction=interaction or len(hulls) == 1,
            far_field=far_field,
            gap_damping=gap_damping,
            gap_width=gap_width,
            flow=flow,
        )

    @cached_property
    def apart(self) -> "dict[Hull, Problem]":
        """Problems that have nothing to do with each other, one for each hull; of bodies that interact, itself."""
        if self.interaction:
            return {self.hulls[0]: self}
        alone = partial(replace, self, centres=np.zeros((1, 3)), interaction=True)
        return {hull: alone(hulls=(hull,)) for hull in self.hulls}

    @cached_property
    def seas(self) -> list[Sea]:
        """One for each heading."""
        return [Sea(depth=self.depth, density=self.density, gravity=self.gravity, heading=h) for h in self.headings]

    @cached_property
    def largest(self) -> float:
        """Radius of the largest body [m]."""
        return max(h.largest_radius for h in self.hulls)

    @cached_property
    def standing(self) -> bool:
        """Whether a body stands on the seabed, which is then never left out."""
        return any(stands(h, self.depth) for h in self.hulls)

    def seabed(self, k: float) -> float:
        """Depth to solve with [m], infinite where the seabed does not matter; see Sea."""
        return self.depth if self.standing else self.seas[0].seabed(k, self.largest)

    @cached_property
    def counts(self) -> tuple[int, ...]:
        """Panels of each body: as asked for, or half or a quarter of that, PANELS at least, if that is solved better.

        One mesh of more panels is farther off than the limit of two, and even ones than those narrower at edges.
        """
        asked = [n for n in (self.panels, self.panels // 2, self.panels // 4) if n >= meshes.PANELS] or [self.panels]
        tried = [_counts(self.hulls, n, self.seas[0].wavenumber(self.omega[-1])) for n in asked]
        if len(tried) == 1:
            return tried[0]
        return max(tried, key=lambda counts: _meshing(self.hulls, self.centres, counts))  # two before one, narrow last

    @cached_property
    def orders(self) -> int:
        """M of the far field's modes; -1 where it is not wanted."""
        if not self.far_field:
            return -1
        origin, _ = meshes.mirror_planes(self.hulls, self.centres)
        away = np.linalg.norm(self.centres - origin, axis=1) + [h.largest_radius for h in self.hulls]
        return orders(self.seas[0].wavenumber(self.omega[-1]), float(away.max()))

    @cached_property
    def meshing(self) -> "Meshing":
        """Of the hulls."""
        return _meshing(self.hulls, self.centres, self.counts)

    @property
    def divisions(self) -> tuple[int, ...]:
        """Of the base mesh, to solve for."""
        return self.meshing.divisions

    @cached_property
    def base(self) -> tuple[int, ...]:
        """Panels of each body in the base mesh."""
        return tuple(count // max(self.divisions) ** 2 for count in self.counts)

    @cached_property
    def meshed(self) -> tuple[Hull, ...]:
        """The hulls as panels show them: dense meshes coarser."""
        return tuple(
            fewer(hull, count, self.divisions[0]) if isinstance(hull, PanelHull) else hull
            for hull, count in zip(self.hulls, self.counts, strict=True)
        )

    @property
    def coarser(self) -> str:
        """Which hulls have fewer panels than their meshes."""
        notes = []
        for hull, made in zip(self.hulls, self.meshed, strict=True):
            if isinstance(hull, PanelHull) and isinstance(made, PanelHull) and made.finer is not None:
                panels = made.finer if self.divisions[0] > 1 else made.wetted
                off = surface.volume(panels) / hull.volume - 1
                notes.append(f"hull {hull.name}: {len(panels)} panels for {len(hull.wetted)} (volume {off:+.1e})")
        return "; ".join(dict.fromkeys(notes))


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
    seabed_error = 0.0 if problem.standing else problem.seas[0].seabed_error(problem.omega, problem.largest)
    settings |= {"method": f"direct, {how}, lid on the waterplane", "green_function": "Delhommeau"}
    settings |= {"seabed_error": seabed_error} | ({"coarser": problem.coarser} if problem.coarser else {})
    return settings


def _limits(problem: Problem, solutions: list[Solution]) -> tuple[list[np.ndarray], list[np.ndarray]]:
    """Of zero panel size, and what is left of the error."""
    lengths = motion_lengths(problem.hulls, problem.dofs)
    body = np.repeat(np.arange(len(problem.hulls)), len(problem.dofs))
    plates = [found for found in map(meshes.plates, problem.meshed, problem.counts) if found]
    share = TWO_MESHES if plates else of_edges(problem.meshed, problem.base, narrow=problem.meshing.narrow)
    best, left = extrapolated(solutions, problem.divisions, (lengths, body), share)
    if plates and len(solutions) <= len(HALVED):
        left = of_plates(plates, left, best)
    _require_positive(problem, best[1], lengths, body)
    return best, left


def _require_positive(problem: Problem, infinite: np.ndarray, lengths: np.ndarray, body: np.ndarray) -> None:
    """Refuse added mass at infinite frequency (n, n) that is not positive: half of vᵀA∞v is the water's energy.

    Motions with next to nothing of it, see `radiates`, may have less than none by their mesh's error.
    """
    size = np.abs(np.diag(infinite))
    heard = np.flatnonzero(radiates(size, lengths, body))
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
    mesh = build(lids=True, gap_width=problem.gap_width)
    n, sea = mesh.motions.shape[-1], seas[0]
    limit = np.zeros((0, 0))
    if infinite:  # no irregular frequency there, and no damping: φ = 0 on all still water
        bare = build(lids=False)
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


def _counts(hulls: tuple[Hull, ...], panels: int, k: float) -> tuple[int, ...]:
    """Panels of each body: `panels`, more on one so large that its own would not resolve the shortest wave, k [1/m]."""
    needed = [h.wetted_area * (k / RESOLVED) ** 2 for h in hulls]
    return tuple(round(min(max(panels, n), FINER * panels)) for n in needed)


class Meshing(NamedTuple):
    """How hulls that are meshes are solved for."""

    divisions: tuple[int, ...]  # of the base mesh, the finer first
    narrow: bool  # whether panels may be narrower at edges


def _meshing(hulls: tuple[Hull, ...], centres: np.ndarray, counts: tuple[int, ...]) -> Meshing:
    """Two meshes, narrower at edges where that does not cost too much; only one where even two even ones do."""
    if not any(isinstance(h, PanelHull) for h in hulls):
        return Meshing(DIVISIONS, narrow=True)
    _, mirrors = meshes.mirror_planes(hulls, centres)
    divided = HALVED[0] ** 2
    for narrow in (True, False):
        count = sum(
            divided * meshes.halved_count(fewer(h, n, HALVED[0]), n // divided, narrow=narrow)
            if isinstance(h, PanelHull)
            else n
            for h, n in zip(hulls, counts, strict=True)
        )
        if count**2 / len(mirrors) <= AFFORDABLE:
            return Meshing(HALVED, narrow)
    return Meshing(HALVED[1:], narrow=True)


def require_solvable(
    hulls: tuple[Hull, ...],
    centres: np.ndarray,
    depth: float,
    omega: np.ndarray,
    gravity: float,
    panels: int,
    *,
    interaction: bool = True,
) -> None:
    """Refuse hulls, places, depth and frequencies that `solve` cannot handle; arguments as there."""
    if len(hulls) != len(centres) or not len(hulls):
        raise InputError("centres", len(centres), f"must be one for each of the {len(hulls)} hulls")
    if np.any(centres[:, 2] != 0):
        raise InputError("centres", centres[:, 2].tolist(), "must lie in the still-water plane, z = 0 m")
    if not interaction and len(hulls) > 1:
        for hull, centre in zip(hulls, centres, strict=True):
            require_solvable((hull,), centre[None], depth, omega, gravity, panels)
        return
    if panels < 108:
        raise InputError("panels", panels, "must be at least 108 a body")
    if len(edges := openings(hulls, list(centres))) and not slips(hulls, edges):
        raise InputError("hulls", f"{len(edges)} open edges", "must close each other's openings below still water")
    deepest = max(h.draft for h in hulls)
    if not all(depth > h.draft or stands(h, depth) for h in hulls):
        limit = f"must be greater than the draft, {deepest} m, or the same where a flat foot stands on the seabed"
        raise InputError("depth", depth, limit)
    if omega[0] <= 0 or np.any(np.diff(omega) <= 0):
        raise InputError("omega", omega.tolist(), "must increase from above 0 rad/s")
    if omega[0] <= longest(depth, gravity):
        raise InputError("omega", omega[0], f"must have kh > {SHALLOWEST:g} in the depth of {depth} m")
    for i, j in zip(*np.triu_indices(len(hulls), 1), strict=True):
        if touching(hulls[i], centres[i], hulls[j], centres[j]):
            raise InputError("centres", centres[[i, j]].tolist(), "bodies must not touch or overlap")
