"""Linear potential flow about hulls by boundary elements; capytaine evaluates the Green function.

The mirror planes, the systems and the forces are ours, so that every right-hand side of a frequency
shares one factorization, and parts that a symmetry makes zero are never solved. Conventions: see `coefficients`.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property, partial
from types import MappingProxyType
from typing import Any, NamedTuple

import numpy as np
from scipy.linalg import lu_factor, lu_solve

from solver.errors import InputError
from solver.hydrodynamics.bem.alone import assembled
from solver.hydrodynamics.bem.coefficients import DOFS, PLANAR, Hydrodynamics, MeshError, symmetric
from solver.hydrodynamics.bem.far_field import FarField, PlaneWaves, modes, orders, plane_waves
from solver.hydrodynamics.bem.green import green_function, joined
from solver.hydrodynamics.bem.incident import Sea
from solver.hydrodynamics.bem.mean_hull import at_rest, froude_krylov, motion_lengths, unit_motions
from solver.hydrodynamics.bem.table import clear
from solver.hydrodynamics.hull import mesh as meshes
from solver.hydrodynamics.hull import surface
from solver.hydrodynamics.hull.clearance import openings, slips, touching
from solver.hydrodynamics.hull.coarse import fewer
from solver.hydrodynamics.hull.gaps import gaps
from solver.hydrodynamics.hull.mesh import Hull
from solver.hydrodynamics.hull.panel_hull import PanelHull
from solver.hydrodynamics.hull.plates import Plates
from solver.hydrodynamics.hull.standing import stands, walls
from solver.hydrodynamics.hull.surface import divided, mirrored
from solver.hydrodynamics.radiation.passivity import UNPASSIVE, least_damping
from solver.sea.dispersion import SHALLOWEST, first_solved, longest

__all__ = [
    "DOFS", "PLANAR", "Hydrodynamics", "Problem", "frequency_grid", "part", "require_solvable", "solve", "united",
]  # fmt: skip

DIVISIONS = 3, 2, 1  # of one base mesh: a family, so that its h² error can be extrapolated away, and the rest be judged
HALVED = 2, 1  # the same where a hull is a mesh, which is as its author made it, or coarser, and halved
METHODS = {1: "one mesh as given", 2: "h2-extrapolated from two meshes", 3: "h2-extrapolated from two of three meshes"}
NEXT = 3  # power of h that is left without the h² error: of edges, and of spheres, which have one in the waterplane
LEAST = 0.25  # over the panels: of a coefficient, that three meshes may leave where their limits happen to agree
TWO_MESHES = 0.5  # of the h² error, that is left of it at least: measured on a sphere of 216 and 864 triangles
IRREGULAR = 1.5  # times what even panels leave, that a dense mesh made coarser does: 1.4 to 3.2 in A of five hulls
NARROWED = 0.5  # of what even panels leave at edges, that narrower ones do: 0.2 to 0.5 of boxes 0.5 to 3 m deep
ONE_MESH = 0.6  # over √panels: error of one mesh, as measured on a box of 224 panels; finer and smoother ones have less
# Of the wavenumber times a panel's side: up to here coefficients err by 2 % of the added mass at most, at 2.5 by 80 %
# (heave and surge of a hemisphere and of a cylinder, against eight times the panels).
RESOLVED = 2.0
# Parts thinner than panels are wide: times that error, where panels of the two faces are each other's images; where
# they are not, of the coefficient, for each time that a panel is as wide as the part is thick. Measured on heave plates
# of 1/20 to 1/150 of their radius, from the finest to the coarsest meshes.
ALIKE_PLATES, UNLIKE_PLATES = 4.0, 0.02
FINER = 6.0  # times the panels that a body gets, at most, where waves of the scene are shorter than that
AFFORDABLE = 3e6  # panels squared over mirror images of a halved mesh, 3 s a frequency; larger ones are solved unhalved


class Solution(NamedTuple):
    """Of one mesh at nw frequencies, for nh headings."""

    impedance: np.ndarray  # (nw, n, n) A + iB/ω
    infinite: np.ndarray  # (n, n) A∞
    diffraction: np.ndarray  # (nw, nh, n) force
    far: np.ndarray  # (nw, n + nh, 2M + 1) modes of H, of each motion and heading; empty where not asked for
    lid: float  # area of damping lids [m²]
    panels: int  # on hulls


def frequency_grid(
    hulls: tuple[Hull, ...],
    centres: np.ndarray,
    *,
    depth: float,
    gravity: float = 9.81,
    count: int = 40,
    band: tuple[float, float] | None = None,
    panels: int = 432,
    interaction: bool = True,
) -> np.ndarray:
    """Frequencies [rad/s] from Ka = 0.02 (or kh = SHALLOWEST) to Ka = 10, K = ω²/g, a a radius; and all of `band`.

    None above that, not of the band, which meshes of about `panels` a body do not resolve: RESOLVED.
    `count` even ones for a body alone. A wave reflected between bodies L apart turns the phase
    of a force by 2kL: the spacing is then at most g/(4ωL), 1 rad, up to Ka = 2 and through the band. Without
    interaction none is. Hulls with heave plates have some moved by 0.3 % at most: see `clear`.
    """
    radii = [h.largest_radius for h in hulls]
    low = max(np.sqrt(0.02 * gravity / max(radii)), first_solved(depth, gravity))
    high, resolved = np.sqrt(np.array([10, 2]) * gravity / min(h.scale for h in hulls))
    high = min(high, np.sqrt(RESOLVED * gravity / max(np.sqrt(h.wetted_area / panels) for h in hulls)))
    if band is not None:
        low, high, resolved = min(low, band[0]), max(high, band[1]), max(resolved, band[1])
    at = np.asarray(centres, float).reshape(-1, 3)
    apart = np.linalg.norm(at[:, None] - at, axis=-1).max() if interaction else 0.0
    # Grid points divide the integral of their density evenly, so that the spacing varies smoothly.
    omega = np.linspace(low, high, 4001)
    density = (count - 1) / (high - low) + 0.0 * omega
    density = np.maximum(density, 4 * apart / gravity * omega / (1 + (omega / resolved) ** 16))
    index = np.concatenate([[0.0], np.cumsum((density[1:] + density[:-1]) / 2 * np.diff(omega))])
    grid = np.interp(np.linspace(0, index[-1], int(np.ceil(index[-1] - 1e-6)) + 1), index, omega)
    return clear(grid, hulls, depth, gravity)


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
    # On still water where no circle of this diameter fits ∂φ/∂z = (1 + iε) ω²/g φ: see _Mesh.
    gap_damping: float  # ε
    gap_width: float  # [m]

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
        panels: int = 432,
        interaction: bool = True,
        far_field: bool = False,
        gap_damping: float = 0.0,
        gap_width: float = 0.0,
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
        """Panels of each body."""
        return _counts(self.hulls, self.panels, self.seas[0].wavenumber(self.omega[-1]))

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
    hulls, omega, divisions, seas = problem.hulls, problem.omega, problem.divisions, problem.seas
    solutions = [_interleaved(pieces) for pieces in zip(*parts, strict=True)]
    lengths = motion_lengths(hulls, problem.dofs)
    body = np.repeat(np.arange(len(hulls)), len(problem.dofs))
    plates = [found for found in map(meshes.plates, problem.meshed, problem.counts) if found]
    share = TWO_MESHES if plates else _of_edges(problem.meshed, problem.base, narrow=problem.meshing.narrow)
    (impedance, impedance_inf, diffraction, far), left = _extrapolated(solutions, divisions, (lengths, body), share)
    if plates and len(solutions) <= len(HALVED):
        left = _of_plates(plates, left, (impedance, impedance_inf, diffraction, far))
    lid = solutions[0].lid
    how = f"finest of {len(divisions)} meshes, damping lid" if lid > 0 else METHODS[len(divisions)]
    settings = {
        "panels": solutions[0].panels,
        "panels_coarse": solutions[-1].panels,
        "method": f"direct, {how}, lid on the waterplane",
        "green_function": "Delhommeau",
        "seabed_error": 0.0 if problem.standing else seas[0].seabed_error(omega, problem.largest),
        **({"coarser": problem.coarser} if problem.coarser else {}),
    }
    if problem.gap_damping > 0:
        settings |= {"gap_damping": problem.gap_damping, "gap_width": problem.gap_width}
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
            error=MeshError(left[0].real, left[0].imag * omega[:, None, None], left[1], left[2][:, h]),
            far_field=FarField(origin, far[:, :n], far[:, n + h]) if problem.far_field else None,
            waves_to=problem.waves_to,
            **at_rest(hulls, problem.centres, problem.dofs, sea),
        )
        for h, sea in enumerate(seas)
    ]


def _interleaved(pieces: Sequence[Solution]) -> Solution:
    """The solution of one mesh at all frequencies, from that at every n-th one from the first, second ... n-th on."""
    index = np.argsort(np.concatenate([k + len(pieces) * np.arange(len(p.impedance)) for k, p in enumerate(pieces)]))
    return pieces[0]._replace(
        impedance=np.concatenate([p.impedance for p in pieces])[index],
        diffraction=np.concatenate([p.diffraction for p in pieces])[index],
        far=np.concatenate([p.far for p in pieces])[index],
    )


@dataclass(frozen=True, eq=False, kw_only=True)
class _Mesh:
    """The part of the wetted surface that `mirrors` complete, and all of it, as capytaine meshes about `origin`.

    And of lids: inside the hulls against irregular frequencies; and damping ones, on water in gaps. There a pressure
    ρμφ resists the water and takes ½ρμK|φ|² of power from each m²: with μ = εω, ∂φ/∂z = (1 + iε) Kφ, K = ω²/g
    (Chen 2004, Hydrodynamics in offshore and naval applications; Orcina, OrcaWave's theory). As ∂G/∂z = KG, Green's
    identity keeps of φ ∂G/∂z - G ∂φ/∂z only -iεKφ G, a layer of sources, and a point of still water is seen whole.
    """

    mirrors: np.ndarray  # (ng, 3) of signs, the identity first
    origin: np.ndarray  # (3,) where the mirror planes cross [m]
    part: Any  # nf panels
    whole: Any  # ng nf panels, mirror by mirror
    wet: np.ndarray  # (nf,) True on hulls, False on lids
    gap: np.ndarray  # (nf,) True on damping lids
    motions: np.ndarray  # (ng, nf, n) normal velocity of each unit motion, 0 on lids

    @classmethod
    def build(
        cls,
        hulls: tuple[Hull, ...],
        centres: np.ndarray,
        dofs: tuple[str, ...],
        counts: tuple[int, ...],
        refine: int,
        depth: float,
        *,
        lids: bool,
        gap_width: float = 0.0,
        narrow: bool = True,
    ) -> "_Mesh":
        """The meshes of `hulls` at `centres` (nb, 3) [m], lids on request; count of each, refine: see mesh.panels.

        Hulls that stand on the seabed, in `depth` [m], have no panels there. gap_width: of gaps with damping lids [m];
        narrow: see mesh.panels.
        """
        origin, mirrors = meshes.mirror_planes(hulls, centres)
        # A lid half as fine does as well as one that matches the hull (measured on the hemisphere).
        hull_panels: Callable[..., tuple[np.ndarray, np.ndarray]] = partial(meshes.panels, narrow=narrow)
        makers = [(hull_panels, refine), (meshes.lid, max(1, refine // 2))][: 1 + lids]
        pieces, owners, hulled = [], [], []
        for b, (hull, at, count) in enumerate(zip(hulls, centres - origin, counts, strict=True)):
            share = meshes.quarters(at, len(mirrors))
            for make, times in makers if share else ():
                vertices, faces = make(hull, count, refine=times, quarters=share)
                if make is hull_panels and stands(hull, depth):
                    vertices, faces = walls(vertices, faces, depth)
                pieces.append((vertices + at, faces))
                owners.append(np.full(len(faces), b))
                hulled.append(np.full(len(faces), make is hull_panels))
        if gap_width > 0:
            side = min(np.sqrt(2 * h.wetted_area / count) for h, count in zip(hulls, counts, strict=True))
            lid = meshes.part_of(gaps(hulls, centres - origin, gap_width, side), 4 // len(mirrors))
            even = np.linspace(0, 1, refine + 1)
            pieces.append(meshes.indexed(divided(lid, even, even)))
            owners.append(np.zeros(len(pieces[-1][1]), int))
            hulled.append(np.zeros(len(pieces[-1][1]), bool))
        part, whole = joined(pieces), joined([mirrored(p, m) for m in mirrors for p in pieces])
        wet, body = np.concatenate(hulled), np.concatenate(owners)
        gap = np.arange(len(wet)) >= len(wet) - (len(hulled[-1]) if gap_width > 0 else 0)
        bodies = np.concatenate([meshes.partner(hulls, centres - origin, m)[body] for m in mirrors])
        motions = unit_motions(whole.faces_centers, whole.faces_normals, bodies, centres - origin, dofs)
        motions = motions.reshape(len(mirrors), len(wet), -1) * wet[:, None]
        return cls(mirrors=mirrors, origin=origin, part=part, whole=whole, wet=wet, gap=gap, motions=motions)

    def scattered(self, seas: Sequence[Sea], omega: float, loss: float) -> np.ndarray:
        """Normal velocities (ng, nf, number of seas) that cancel those of the unit incident waves, 0 on lids;

        on damping ones, of this `loss` [1/m], what the incident waves' φ adds to sources, see `solve`.
        """
        points, normals = self.whole.faces_centers + self.origin, self.whole.faces_normals
        normal = np.stack([np.sum(sea.wave(points, omega)[1] * normals, axis=1) for sea in seas], axis=-1)
        total = -(normal.reshape(len(self.mirrors), -1, len(seas)) * self.wet[:, None])
        if loss:
            total[:, self.gap] -= 1j * loss * self.incident(seas, omega)
        return total

    def incident(self, seas: Sequence[Sea], omega: float) -> np.ndarray:
        """φ = p/(iρω) (ng, number of panels, number of seas) of the unit incident waves on damping lids."""
        points = (self.whole.faces_centers + self.origin).reshape(len(self.mirrors), -1, 3)[:, self.gap]
        waves = [sea.pressure(points.reshape(-1, 3), omega) / (1j * sea.density * omega) for sea in seas]
        return np.stack(waves, axis=-1).reshape(*points.shape[:2], len(seas))

    def solve(
        self, normal_velocity: np.ndarray, k: float, seabed: float, loss: float = 0.0
    ) -> list[tuple[np.ndarray, np.ndarray]]:
        """The outgoing potentials with ∂φ/∂n = normal_velocity (ng, nf, nc): of each class of symmetry that they have

        its signs χ(g) (ng,) and φ (nf, nc) of the part; on the image g it is χ(g) φ. Green's identity
        D φ = S ∂φ/∂n, class by class: its share of the motion, mean of χ(g) v_g over the images g, drives
        D = sum of χ(g) D_g. On damping lids of loss εK [1/m] sources are normal_velocity - iεKφ.
        """
        ng, nf, _ = normal_velocity.shape
        single, double = green_function().evaluate(
            self.whole, self.part, water_depth=seabed, wavenumber=k, adjoint_double_layer=False
        )
        # In a panel's plane its dipoles do not act, on its edge neither, where slips of a mesh bring another's middle.
        double[~np.isfinite(double)] = 0.0
        single, double = single.reshape(ng, nf, nf), double.reshape(ng, nf, nf)
        if loss:
            lid = np.flatnonzero(self.gap)
            double[:, :, lid] = 1j * loss * single[:, :, lid]
            double[0, lid, lid] += 1
        potentials = []
        for sign in meshes.symmetry_classes(self.mirrors):
            source = np.tensordot(sign, normal_velocity, 1) / ng
            if np.abs(source).max() > 1e-12 * np.abs(normal_velocity).max():
                rhs = np.tensordot(sign, single, 1) @ source
                potentials.append((sign, lu_solve(lu_factor(np.tensordot(sign, double, 1)), rhs)))
        return potentials

    def forces(self, potentials: list[tuple[np.ndarray, np.ndarray]], count: int) -> np.ndarray:
        """-∫ φ n dS (nc, n) of `count` potentials."""
        weight = (self.wet * self.part.faces_areas)[:, None]
        total = np.zeros((count, self.motions.shape[-1]), complex)
        for sign, potential in potentials:
            total -= potential.T @ (weight * np.tensordot(sign, self.motions, 1))
        return total

    def plane_waves(self, k: float, depth: float, most: int) -> PlaneWaves:
        """On the whole, about the origin: see far_field."""
        return plane_waves(self.whole.faces_centers, self.whole.faces_normals, k, depth, most)

    def far_field(
        self,
        potentials: list[tuple[np.ndarray, np.ndarray]],
        normal_velocity: np.ndarray,
        waves: PlaneWaves,
        loss: float = 0.0,
    ) -> np.ndarray:
        """Modes (nc, 2M + 1) of H = ∫ (φ ∂ψ/∂n - ψ ∂φ/∂n) dS, on damping lids of -∫ ψ (normal_velocity - iεKφ) dS."""
        ng, nf, _ = normal_velocity.shape
        value, slope = (part.reshape(ng, nf, -1) for part in waves)
        weight = (self.wet * self.part.faces_areas)[:, None]
        lid = (self.gap * self.part.faces_areas)[:, None]
        total = -np.tensordot(normal_velocity * (weight + lid), value, ([0, 1], [0, 1]))
        for sign, potential in potentials:
            total += potential.T @ (weight * np.tensordot(sign, slope, 1))
            if loss:
                total += potential.T @ (1j * loss * lid * np.tensordot(sign, value, 1))
        return modes(total)


def _coefficients(problem: Problem, omega: np.ndarray, refine: int, *, infinite: bool) -> Solution:
    """At frequencies (nw,), of one mesh; A(inf) is empty where it is not asked for."""
    hulls, centres, dofs, seas = problem.meshed, problem.centres, problem.dofs, problem.seas
    where = hulls, centres, dofs, problem.base, refine, problem.depth
    build = partial(_Mesh.build, *where, narrow=problem.meshing.narrow)
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


def _extrapolated(
    solutions: list[Solution],
    divisions: tuple[int, ...],
    motions: tuple[np.ndarray, np.ndarray],
    share: float = TWO_MESHES,
) -> tuple[list[np.ndarray], list[np.ndarray]]:
    """Limits of zero panel size, error ~ h² ~ 1/divisions², and what is left of the error, with its sign.

    From three meshes: as h^NEXT, by how much the limits of the finer and of the coarser two differ, LEAST at least. One
    solution counts as its limit, and how far off follows from its panels alone. Where water between bodies resonates
    at a frequency that goes with the mesh there is no such limit, and the finest mesh stands; with damping lids at
    all frequencies, for what is lost there is felt at others. motions: lengths and bodies, as of `least_damping`;
    share: of the step from the finer of two meshes to their limit, that is left.
    """
    *finest, lid, count = solutions[0]
    if len(solutions) == 1:
        return finest, [ONE_MESH / np.sqrt(count) * x for x in finest]
    best = _limits(solutions[:2], divisions[:2])
    if lid > 0:
        return finest, [b - f for b, f in zip(best, finest, strict=True)]
    of_limit, of_finest = (least_damping(each[0], *motions) for each in (best, finest))
    lost = (of_limit < -UNPASSIVE) & (of_limit < 2 * of_finest)
    for k in (0, 2, 3):  # what has a frequency
        best[k][lost] = finest[k][lost]
    if len(solutions) == 2:
        return best, [share * (b - f) for b, f in zip(best, finest, strict=True)]
    left = (divisions[1] / divisions[0]) ** NEXT
    coarser = _limits(solutions[1:], divisions[1:])
    differ = (left / (1 - left) * (b - c) for b, c in zip(best, coarser, strict=True))
    return best, [_at_least(LEAST / count, b, off) for b, off in zip(best, differ, strict=True)]


def _at_least(share: float, x: np.ndarray, off: np.ndarray) -> np.ndarray:
    """What x is off by, and no less than its share; real and imaginary parts by themselves."""
    if np.iscomplexobj(x):
        return _at_least(share, x.real, off.real) + 1j * _at_least(share, x.imag, off.imag)
    return np.where(np.abs(off) < share * np.abs(x), share * x, off)


def _of_edges(hulls: tuple[Hull, ...], counts: tuple[int, ...], *, narrow: bool) -> float:
    """What two meshes, the coarser of these counts, leave of the error, over the step from the finer to their limit.

    At an edge that turns by α the error of even panels goes as h^p, see `edges`; of 2^p - 1 parts the limit for an
    error ~ h² takes three. Of panels as wide as ours p is 1.0 to 1.2 of boxes, 1.3 to 1.5 where α is 50 degrees. To
    take the limit by that order is no way out: added mass and damping would not be of one cause, nor damping of the
    waves far off. Panels narrower at edges leave NARROWED as much; those of a dense mesh made coarser IRREGULAR.
    """
    shares = [TWO_MESHES]
    for hull, count in zip(hulls, counts, strict=True):
        if isinstance(hull, PanelHull):
            left = 3 / (2 ** (2 * (np.pi / (np.pi + hull.sharpest)) ** 1.5) - 1) - 1
            narrower = narrow and (hull.finer is not None or meshes.halving(hull, count).narrow)
            share = max(TWO_MESHES, NARROWED * left if narrower else left)
            shares.append(share if hull.finer is None else IRREGULAR * share)
    return max(shares)


def _of_plates(plates: list[Plates], left: list[np.ndarray], best: Sequence[np.ndarray]) -> list[np.ndarray]:
    """What is left of the error of meshes of two sizes or one, of hulls with plates."""
    unlike = max(found.unlike for found in plates)
    if unlike > 0:
        return [error + UNLIKE_PLATES * unlike * x for error, x in zip(left, best, strict=True)]
    return [ALIKE_PLATES * error for error in left]


def _limits(pair: Sequence[Solution], divisions: tuple[int, ...]) -> list[np.ndarray]:
    fine, coarse = (n**2 for n in divisions)
    return [f + (f - c) * (coarse / (fine - coarse)) for f, c in zip(*(s[:-2] for s in pair), strict=True)]


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
