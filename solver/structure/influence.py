"""Section forces and reactions as linear maps of the loads on a moving frame.

The frame bends under its loads F, the inertia of its motion d̈ and its damping, K d = F - C ḋ - M d̈ (mode acceleration:
Craig, Structural Dynamics, 1981). With an element's own consistent loads f, inertia and damping among them, its end
bears ± (k d - f): elastic forces, in balance at every node, however few shapes the motion is made of and however long
the elements. Damping acts within the frame, so that the ground, which bears it, too, gives
K d + C ḋ - (F - M d̈) on a clamped degree of freedom, as if K d were F - M d̈: what balances loads and inertia. The
springs of a foundation and the soil give -k d of that same d.
"""

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from scipy import sparse

from solver.keys import shared
from solver.structure import beam, recovery, statics, water
from solver.structure.frame_model import FrameModel
from solver.structure.members import Member

SLAB = 2**22  # numbers of an array made on the way


@dataclass(frozen=True, eq=False, kw_only=True)
class Wanted:
    """Which section forces and which reactions are asked for: ny = k + nr + 6 nb."""

    end: np.ndarray  # (k,) numbered 2 e (start) and 2 e + 1 (end of element e)
    component: np.ndarray  # (k,) which of members.FORCES, on the face whose outward normal is local +x
    grounded: np.ndarray  # (nr,) degrees of freedom, clamped or on springs
    buried: tuple[Member, ...] = ()  # nb that soil holds by three forces and three moments

    @property
    def moments(self) -> np.ndarray:
        """Which of the ny are moments."""
        return np.concatenate([self.component, self.grounded % 6, np.tile(np.arange(6), len(self.buried))]) >= 3

    @property
    def empty(self) -> bool:
        """Whether nothing is asked for."""
        return not (self.end.size or self.grounded.size or self.buried)


@dataclass(frozen=True, eq=False, kw_only=True)
class Influence:
    """On each of the ny forces: y = Σ nodalᵀ F + withinᵀ f, global axes."""

    model: FrameModel
    nodal: np.ndarray  # (6n, ny) of unit loads on the nodes
    element: np.ndarray  # (ny,) the element whose own loads count besides; -1 of a reaction
    within: np.ndarray  # (ny, 12) of that element's consistent loads

    def of_points(self, at: water.Stations) -> np.ndarray:
        """Of unit point loads at the stations, (ns, 3, ny)."""
        return _of_points(self, at)

    def of_inertia(self, M: sparse.csr_array, density: float, shapes: np.ndarray) -> np.ndarray:
        """Of unit accelerations along shapes (6n, nm) of mass M, the water's included, (nm, ny): that of - M d̈."""
        out = (M @ shapes).T @ self.nodal
        elements, place = np.unique(self.element[self.element >= 0], return_inverse=True)
        own = element_masses(self.model, density, tuple(elements.tolist())) @ shapes[self.model.dofs[elements]]
        out[:, self.element >= 0] += np.einsum("ya,yam->my", self.within[self.element >= 0], own[place])
        return -out

    def of_straining(self, wanted: Wanted, omega: np.ndarray, shapes: np.ndarray, inertia: np.ndarray) -> np.ndarray:
        """Of unit rates along shapes (6n, nm) with damping K, less what `inertia` of ω² says of it, (nm, ny).

        That of natural modes is the same, K φ = ω² M φ. Static shapes strain the frame elsewhere than their inertia.
        """
        ends = 6 * wanted.end + wanted.component
        strained = np.zeros(inertia.shape)
        strained[:, : ends.size] = (recovery.section_force_matrix(self.model)[ends] @ shapes).T
        return -(omega[:, None] ** 2 * inertia + strained)

    def at_rest(
        self, wanted: Wanted, displacement: np.ndarray, load: np.ndarray, element_loads: np.ndarray
    ) -> np.ndarray:
        """(ny,) of the static displacement (6n,) under `load`, of which element_loads (ne, 12) are spread."""
        forces = recovery.section_forces(self.model, displacement, element_loads)[wanted.end, wanted.component]
        of_soil = [self.model.soil_reaction(member)[0] @ displacement for member in wanted.buried]
        held = self.model.K[wanted.grounded] @ displacement - load[wanted.grounded]
        on_feet = np.where(_clamped(self.model, wanted), held, -self.model.ground[wanted.grounded] @ displacement)
        return np.concatenate([forces, on_feet, *of_soil])


def influence(model: FrameModel, wanted: Wanted) -> Influence:
    """By one static solution for each force, K being symmetric."""
    k = len(wanted.end)
    element, row = wanted.end // 2, 6 * (wanted.end % 2) + wanted.component
    stiffness = model.softened_stiffness
    T = model.transform[element]
    face = recovery.FACE[row, None]
    blocks = face * np.einsum("ya,yab->yb", stiffness[element, row], T)
    clamped = _clamped(model, wanted)
    on_feet = np.where(clamped[:, None], model.K[wanted.grounded].toarray(), -model.ground[wanted.grounded].toarray())
    reactions = np.concatenate([on_feet, *(model.soil_reaction(member)[0] for member in wanted.buried)])
    unit = np.zeros((model.K.shape[0], k + len(reactions)))
    unit[model.dofs[element], np.arange(k)[:, None]] = blocks
    unit[:, k:] = reactions.T
    nodal = statics.static(model, unit)
    nodal[wanted.grounded[clamped], k + np.flatnonzero(clamped)] -= 1.0
    none = np.zeros((len(reactions), 12))
    # Loads of the ends in local axes are T⁻ᵀ of those of the nodes: T itself where no arm is between them.
    to_ends = [np.linalg.inv(t).T if e in model.levers else t for e, t in zip(element.tolist(), T, strict=True)]
    return Influence(
        model=model,
        nodal=nodal,
        element=np.concatenate([element, np.full(len(reactions), -1)]),
        within=np.concatenate([-face * np.reshape(to_ends, (-1, 12, 12))[np.arange(k), row], none]),
    )


def _clamped(model: FrameModel, wanted: Wanted) -> np.ndarray:
    """Which of the degrees of freedom that have a reaction (nr,) are not on springs."""
    return ~np.isin(wanted.grounded, model.free)


@lru_cache(maxsize=8)
def _of_points(influence: Influence, at: water.Stations) -> np.ndarray:
    """See there; seas that share their stations share it."""
    out = np.empty((len(at.element), 3, influence.element.size))
    size = max(1, SLAB // max(1, 12 * influence.element.size))
    for part in (slice(i, i + size) for i in range(0, len(out), size)):
        own = at.element[part, None, None] == influence.element
        out[part] = at.shape[part] @ (influence.nodal[at.dofs[part]] + np.where(own, influence.within.T, 0.0))
    return shared(out)


@lru_cache(maxsize=8)
def element_masses(model: FrameModel, density: float, elements: tuple[int, ...]) -> np.ndarray:
    """Mass of some elements with the water's (k, 12, 12), global axes [kg, kg m, kg m2]."""
    steel = []
    for e in elements:
        T, density_of_steel = model.transform[e], model.member_of(e).material.density
        local = beam.mass(density_of_steel, model.sections[e], model.length[e], model.shear[e])
        steel.append(T.T @ model.released(e, local, both=True) @ T)
    return shared(water.element_masses(model, density, np.array(elements, int)) + np.reshape(steel, (-1, 12, 12)))
