"""What boundary elements are to solve: hulls, their places, panels, frequencies; and what is refused of that."""

from dataclasses import dataclass, replace
from functools import cached_property, partial
from typing import NamedTuple

import numpy as np

from solver.errors import InputError
from solver.hydrodynamics.bem.coefficients import DOFS, PLANAR
from solver.hydrodynamics.bem.far_field import orders
from solver.hydrodynamics.bem.grid import RESOLVED, frequency_grid
from solver.hydrodynamics.bem.incident import Sea
from solver.hydrodynamics.hull import mesh as meshes
from solver.hydrodynamics.hull import surface
from solver.hydrodynamics.hull.clearance import openings, slips, touching
from solver.hydrodynamics.hull.coarse import dense, fewer
from solver.hydrodynamics.hull.mesh import Hull
from solver.hydrodynamics.hull.panel_hull import PanelHull
from solver.hydrodynamics.hull.standing import stands
from solver.sea.dispersion import SHALLOWEST, longest

DIVISIONS = 3, 2, 1  # of one base mesh: a family, so that its h² error can be extrapolated away, and the rest be judged
HALVED = 2, 1  # the same where a hull is a mesh, which is as its author made it, or coarser, and halved
FINER = 6.0  # times the panels that a body gets, at most, where waves of the scene are shorter than that
LIDDED = 4  # times a mesh's usual panels that its lid is as fine as
AFFORDABLE = 3e6  # panels squared over mirror images of a halved mesh, 3 s a frequency; larger ones are solved unhalved


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
            omega = frequency_grid(hulls, at, depth=depth, gravity=gravity, panels=panels, interaction=interaction)
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
    def largest(self) -> tuple[float, float]:
        """Radius of the widest body and draft of the deepest [m]."""
        return max(h.largest_radius for h in self.hulls), max(h.draft for h in self.hulls)

    @cached_property
    def standing(self) -> bool:
        """Whether a body stands on the seabed, which is then never left out."""
        return any(stands(h, self.depth) for h in self.hulls)

    def seabed(self, k: float) -> float:
        """Depth to solve with [m], infinite where the seabed does not matter; see Sea."""
        return self.depth if self.standing else self.seas[0].seabed(k, *self.largest)

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

    @cached_property
    def lids(self) -> tuple[int, ...]:
        """What to ask `lid` for, of each body, in all its meshes.

        One as coarse as the coarsest does for hulls of revolution (measured on hemispheres and discs). Inside meshes,
        which may be shallow or thin out towards the waterline, one coarser than this lets irregular frequencies
        through, above all on the coarser mesh (measured on ducks). More panels need no finer one.
        """
        usual = _counts(self.hulls, min(self.panels, meshes.PANELS), self.seas[0].wavenumber(self.omega[-1]))
        return tuple(
            LIDDED * most if isinstance(hull, PanelHull) else count
            for hull, most, count in zip(self.hulls, usual, self.base, strict=True)
        )

    @property
    def divisions(self) -> tuple[int, ...]:
        """Of the base mesh, to solve for."""
        return self.meshing.divisions

    @cached_property
    def base(self) -> tuple[int, ...]:
        """Panels of each body in the base mesh; no fewer are had than are asked for where that is more than usual."""
        divided = max(self.divisions) ** 2
        if self.panels <= meshes.PANELS:
            return tuple(count // divided for count in self.counts)
        return tuple(meshes.at_least(h, -(-count // divided)) for h, count in zip(self.hulls, self.counts, strict=True))

    @cached_property
    def meshed(self) -> tuple[Hull, ...]:
        """The hulls as panels show them: dense meshes coarser."""
        return tuple(
            fewer(hull, count, self.divisions[0]) if isinstance(hull, PanelHull) else hull
            for hull, count in zip(self.hulls, self.counts, strict=True)
        )

    @property
    def coarser(self) -> str:
        """Which hulls have fewer panels than their meshes, and which dense ones do not."""
        notes = []
        for hull, made, count, base in zip(self.hulls, self.meshed, self.counts, self.base, strict=True):
            if not (isinstance(hull, PanelHull) and isinstance(made, PanelHull)):
                continue
            if made.finer is not None:
                panels = made.finer if self.divisions[0] > 1 else made.wetted
                off = surface.volume(panels) / hull.volume - 1
                notes.append(f"hull {hull.name}: {len(panels)} panels for {len(hull.wetted)} (volume {off:+.1e})")
            elif dense(hull, count):
                solved = self.divisions[0] ** 2 * meshes.halved_count(hull, base, narrow=self.meshing.narrow)
                why = "other hulls close it" if len(hull.holes) else "fewer do not keep its edges and corners"
                notes.append(f"hull {hull.name}: {solved} panels for its dense mesh's {len(hull.wetted)}, as {why}")
        return "; ".join(dict.fromkeys(notes))


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
