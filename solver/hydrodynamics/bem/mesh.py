"""Panels of the wetted surface at rest, and the boundary problem of one frequency on them."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy.linalg import lu_factor, lu_solve

from solver.errors import InputError
from solver.hydrodynamics.bem.far_field import PlaneWaves, modes, plane_waves
from solver.hydrodynamics.bem.green import Panels, green_function, joined
from solver.hydrodynamics.bem.incident import Sea
from solver.hydrodynamics.bem.mean_hull import body_name, unit_motions
from solver.hydrodynamics.bem.seabed import added, deep_wavenumber
from solver.hydrodynamics.bem.turned import Alike, alike
from solver.hydrodynamics.hull import mesh as meshes
from solver.hydrodynamics.hull.gaps import gaps
from solver.hydrodynamics.hull.mesh import Hull
from solver.hydrodynamics.hull.standing import stands, walls
from solver.hydrodynamics.hull.surface import WELD, divided, mirrored, point_text


@dataclass(frozen=True, eq=False, kw_only=True)
class Mesh:
    """The part of the wetted surface that `mirrors` complete, and all of it, about `origin`.

    And of lids: inside the hulls against irregular frequencies; and damping ones, on water in gaps. There a pressure
    ρμφ resists the water and takes ½ρμK|φ|² of power from each m²: with μ = εω, ∂φ/∂z = (1 + iε) Kφ, K = ω²/g
    (Chen 2004, Hydrodynamics in offshore and naval applications; Orcina, OrcaWave's theory). As ∂G/∂z = KG, Green's
    identity keeps of φ ∂G/∂z - G ∂φ/∂z only -iεKφ G, a layer of sources, and a point of still water is seen whole.
    """

    mirrors: np.ndarray  # (ng, 3) of signs, the identity first
    origin: np.ndarray  # (3,) where the mirror planes cross [m]
    part: Panels  # nf panels
    whole: Panels  # ng nf panels, mirror by mirror
    wet: np.ndarray  # (nf,) True on hulls, False on lids
    gap: np.ndarray  # (nf,) True on damping lids
    standing: np.ndarray  # (nf,) True on bodies that stand on the seabed, and inside them
    motions: np.ndarray  # (ng, nf, n) normal velocity of each unit motion, 0 on lids
    bodies: np.ndarray  # (ng nf,) whose panels the whole's are; one more than there are for those of damping lids
    names: tuple[str, ...]  # of the bodies, and of damping lids

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
        lids: tuple[int, ...],
        gap_width: float = 0.0,
        narrow: bool = True,
    ) -> "Mesh":
        """The meshes of `hulls` at `centres` (nb, 3) [m]; count of each, refine: see mesh.panels; of lids: mesh.lid.

        Hulls that stand on the seabed, in `depth` [m], have no panels there. gap_width: of gaps with damping lids [m];
        narrow: see mesh.panels.
        """
        origin, mirrors = meshes.mirror_planes(hulls, centres)
        places = meshes.on_planes(hulls, centres - origin)
        pieces, owners, hulled = [], [], []
        for b, (hull, at, count) in enumerate(zip(hulls, places, counts, strict=True)):
            share = meshes.quarters(at, len(mirrors))
            if not share:
                continue
            wetted = meshes.panels(hull, count, refine=refine, quarters=share, narrow=narrow)
            made = [walls(*wetted, depth) if stands(hull, depth) else wetted]
            made += [meshes.lid(hull, lids[b], quarters=share)] if lids else []
            for i, (vertices, faces) in enumerate(made):
                pieces.append((vertices + at, faces))
                owners.append(np.full(len(faces), b))
                hulled.append(np.full(len(faces), i == 0))
        if gap_width > 0:
            side = min(map(meshes.panel_side, hulls, counts))
            lid = meshes.part_of(gaps(hulls, centres - origin, gap_width, side), 4 // len(mirrors))
            even = np.linspace(0, 1, refine + 1)
            pieces.append(meshes.indexed(divided(lid, even, even)))
            owners.append(np.full(len(pieces[-1][1]), len(hulls)))
            hulled.append(np.zeros(len(pieces[-1][1]), bool))
        part, whole = joined(pieces), joined([mirrored(p, m) for m in mirrors for p in pieces])
        wet, body = np.concatenate(hulled), np.concatenate(owners)
        gap = body == len(hulls)
        partners = (meshes.partner(hulls, centres - origin, m) for m in mirrors)
        bodies = np.concatenate([np.append(partner, len(hulls))[body] for partner in partners])
        owner = np.minimum(bodies, len(hulls) - 1)  # lids do not move, whosever they are
        motions = unit_motions(whole.faces_centers, whole.faces_normals, owner, centres - origin, dofs)
        motions = motions.reshape(len(mirrors), len(wet), -1) * wet[:, None]
        return cls(
            mirrors=mirrors,
            origin=origin,
            part=part,
            whole=whole,
            wet=wet,
            gap=gap,
            standing=np.array([*(stands(hull, depth) for hull in hulls), False])[body],
            motions=motions,
            bodies=bodies,
            names=(*(body_name(hulls, b) for b in range(len(hulls))), "lid of a gap"),
        )

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
        single, double = (influence.reshape(nf, ng, nf) for influence in self._influences(k, seabed))
        if loss:
            lid = np.flatnonzero(self.gap)
            double[lid] = 1j * loss * single[lid]
            double[lid, 0, lid] += 1
        potentials = []
        for sign in meshes.symmetry_classes(self.mirrors):
            source = np.tensordot(sign, normal_velocity, 1) / ng
            if np.abs(source).max() > 1e-12 * np.abs(normal_velocity).max():
                rhs = (sign @ single).T @ source
                potentials.append((sign, lu_solve(lu_factor((sign @ double).T), rhs)))
        return potentials

    @cached_property
    def alike(self) -> list[Alike]:
        """Of which panels the Green function is asked for."""
        return alike(self.whole, self.part, len(self.mirrors))

    @cached_property
    def footed(self) -> tuple[tuple[np.ndarray, ...], Panels, list[Alike]]:
        """Of standing bodies: where their influences on each other are among all; their panels, and those asked for."""
        of, at = np.flatnonzero(self.standing), np.flatnonzero(np.tile(self.standing, len(self.mirrors)))
        whole, part = self.whole.of(at), self.part.of(of)
        return np.ix_(of, at), whole, alike(whole, part, len(self.mirrors))

    def _influences(self, k: float, seabed: float) -> tuple[np.ndarray, np.ndarray]:
        """S and D (nf, ng nf) of the part's panels at the middles of the whole's."""
        standing = np.tile(self.standing, len(self.mirrors))
        more = added(self.whole, self.bodies, standing, self.part, seabed, k) if np.isfinite(seabed) else None
        depth, wave = (np.inf, deep_wavenumber(k, seabed)) if more else (seabed, k)
        single, double = _asked(self.whole, len(self.standing), self.alike, wave, depth)
        if more and self.standing.any():
            place, whole, pairs = self.footed
            single[place], double[place] = _asked(whole, len(place[0]), pairs, k, seabed)
        self._require_finite(single, double)
        double[~np.isfinite(double)] = 0.0
        if more:
            single += more[0].T
            double += more[1].T
        return single, double

    def _require_finite(self, single: np.ndarray, double: np.ndarray) -> None:
        """Refuse influences (nf, ng nf) of panels that are not finite, but of dipoles on a middle on their edge."""
        of, at = np.nonzero(~(np.isfinite(single) & np.isfinite(double)))
        away = self.whole.faces_centers[at] - self.part.faces_centers[of]
        off = np.abs(np.sum(away * self.part.faces_normals[of], axis=1))
        wrong = of[(off > WELD * self.part.faces_radiuses[of]) | ~np.isfinite(single[of, at])]
        if len(wrong):
            place = point_text(self.part.faces_centers[wrong[0]] + self.origin)
            limit = (
                f"boundary elements fail on {len(set(wrong))} panels, one near {place}: are they drawn out to needles?"
            )
            raise InputError("hulls", self.names[self.bodies[wrong[0]]], limit)

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


def _asked(whole: Panels, count: int, alike: list[Alike], k: float, depth: float) -> tuple[np.ndarray, np.ndarray]:
    """S and D (count, n) of the first panels on all by the Green function; what it gives of all pairs is not copied."""
    of_all = np.empty((2, count, whole.nb_faces), complex)
    for pairs in alike:
        influences = green_function().evaluate(
            whole.faces_centers[pairs.at],
            pairs.sources,
            water_depth=depth,
            wavenumber=k,
            adjoint_double_layer=False,
            diagonal_term_in_double_layer=pairs.own,
        )
        if len(alike) == len(pairs.of) == 1:  # turns bring none onto others
            return influences[0].T, influences[1].T
        for influence, out in zip(influences, of_all, strict=True):
            pairs.spread(influence.T, out)
    return of_all[0], of_all[1]
