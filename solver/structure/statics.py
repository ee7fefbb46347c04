"""Dead loads, static equilibrium, and what the axial force does to the stiffness."""

from dataclasses import replace
from functools import lru_cache

import numpy as np
from numpy.typing import ArrayLike
from scipy import linalg, sparse
from scipy.sparse.linalg import SuperLU, splu

from solver.structure import beam, lanczos
from solver.structure.frame_model import FrameModel, on_nodes, scatter

ROUNDING = 1e-10  # a share of the largest |1/λ| that rounding alone can make positive
PULLED = 1e-8  # and of it that is left where most of a large frame is pulled: of few that are pushed, 1e-3 at 1e-5


@lru_cache(maxsize=8)
def self_weight(model: FrameModel, g: float) -> np.ndarray:
    """Consistent weight ρAg of each element, local axes [N, N m], (ne, 12)."""
    density = np.array([m.material.density for m in model.frame.members])[model.member]
    weight = density * [section.area for section in model.sections] * g
    down = model.rotation @ [0.0, 0.0, -1.0]
    parts = zip(weight[:, None] * down, model.length, model.shear, strict=True)
    loads = [beam.distributed_load(q, L, shear=shear) for q, L, shear in parts]
    return np.array([model.released(e, load) for e, load in enumerate(loads)])


@lru_cache(maxsize=8)
def distributed_load(model: FrameModel) -> np.ndarray:
    """Consistent loads of the members' constant loads per length, local axes [N, N m], (ne, 12)."""
    given = np.array([m.distributed_load for m in model.frame.members])[model.member]
    loads = np.zeros((len(given), 12))
    for e in np.flatnonzero(given.any(axis=1)).tolist():
        local = model.rotation[e] @ given[e]
        loads[e] = model.released(e, beam.distributed_load(local, model.length[e], shear=model.shear[e]))
    return loads


def gravity_load(model: FrameModel, g: float) -> np.ndarray:
    """Weight of the elements and of the point masses, at the end of their levers, [N, N m], (6n,)."""
    load = model.total(self_weight(model, g))
    for item in model.frame.masses:
        x, y, _ = item.cog
        load[model.translations(item.node)[2] + np.arange(3)] += item.mass * g * np.array([-1, -y, x])
    return load


def point_load(model: FrameModel) -> np.ndarray:
    """The frame's static point loads [N], (6n,)."""
    load = np.zeros(6 * len(model.xyz))
    for item in model.frame.loads:
        load[model.translations(item.node)] += item.force
    return load


def static(model: FrameModel, load: np.ndarray) -> np.ndarray:
    """Displacement [m, rad] under a load: K d = f on the free degrees of freedom, else zero.

    Load and answer are (6n,), or (6n, nl) for several loads. K without its clamped rows and columns: eq. 15 at rest.
    """
    displacement = np.zeros(np.shape(load))
    displacement[model.free] = _factors(model).solve(load[model.free])
    return displacement


@lru_cache(maxsize=8)
def _factors(model: FrameModel) -> SuperLU:
    """K without its clamped rows and columns."""
    return splu(model.K[model.free][:, model.free].tocsc())


def axial_force(model: FrameModel, displacement: np.ndarray, spread: np.ndarray) -> np.ndarray:
    """Axial force at both ends of each element, tension positive [N], (ne, 2): EA/L (u2 - u1) and what its load between
    them, spread (ne, 12) in local axes, adds at one and takes at the other.
    """
    ends = displacement.reshape(-1, 6)[model.elements, :3]
    for e, arms in model.levers.items():
        ends[e] += np.cross(displacement.reshape(-1, 6)[model.elements[e], 3:], arms)
    stretch = np.einsum("ei,ei->e", ends[:, 1] - ends[:, 0], model.rotation[:, 0])
    return (model.axial * stretch)[:, None] + spread[:, [0, 6]] * [1.0, -1.0]


def _element_geometric(model: FrameModel, N: np.ndarray) -> np.ndarray:
    """Of each element, (ne, 12, 12) in local axes, by the axial force at its ends (ne, 2)."""
    parts = zip(N, model.length, model.shear, strict=True)
    elements = [beam.geometric_stiffness(ends, L, shear) for ends, L, shear in parts]
    return np.array([model.released(e, Kg, both=True) for e, Kg in enumerate(elements)])


def _geometric(model: FrameModel, N: np.ndarray, elements: np.ndarray, g: float) -> sparse.csr_array:
    """Kg of elements (ne, 12, 12), of rigid offsets and of the point masses' levers, sparse (6n, 6n)."""
    size = 6 * len(model.xyz)
    Kg = scatter(elements, model.transform, model.dofs, size)
    levers = [(model.node_index[m.node], [0, 0, -m.mass * g], m.cog) for m in model.frame.masses if any(m.cog)]
    for e, arms in model.levers.items():  # the element pulls its nodes towards each other
        levers += zip(model.elements[e], np.outer(N[e] * (1, -1), model.rotation[e, 0]), arms, strict=True)
    return Kg + on_nodes([(node, _tilting(*by)) for node, *by in levers], size) if levers else Kg


def _tilting(force: ArrayLike, arm: ArrayLike) -> np.ndarray:
    """Stiffness (6, 6) [N m] of a force (3,) that stays as it is at the end of an arm (3,) that its node turns.

    Its point moves by θ × r and, to second order, θ × (θ × r)/2: F·r about the two axes across the force. What
    other arms add as the node tilts and twists at once is left out, as the elements' twist is.
    """
    K = np.zeros((6, 6))
    size = float(np.linalg.norm(force))
    if size:
        along = np.divide(force, size)
        K[3:, 3:] = np.dot(force, arm) * (np.eye(3) - np.outer(along, along))
    return K


def with_geometric_stiffness(model: FrameModel, N: np.ndarray, g: float) -> FrameModel:
    """The model with K + Kg of axial forces N (ne, 2): compression softens it."""
    elements = _element_geometric(model, N)
    return replace(model, K=model.K + _geometric(model, N, elements, g), element_geometric=elements)


def buckling_factor(model: FrameModel, N: np.ndarray, g: float) -> float:
    """Smallest λ > 0 with det(K + λ Kg) = 0 under λ times the load that makes N (ne, 2); inf if it never buckles.

    1/λ is the largest eigenvalue of -Kg x = μ K x. Below 1 the load exceeds the Euler load.
    """
    free = model.free
    if _pulled(model, N):
        return np.inf
    Kg = _geometric(model, N, _element_geometric(model, N), g)[free][:, free]
    K = model.K[free][:, free]
    if free.size > lanczos.DENSE:
        found = lanczos.largest(lambda x: -_factors(model).solve(Kg @ x), K, 1, PULLED)
        other, largest = found.least, found.value[0]
    else:
        other, *_, largest = linalg.eigh(-Kg.toarray(), K.toarray(), eigvals_only=True)
    compressed = largest > ROUNDING * max(abs(other), abs(largest))
    return 1 / largest if compressed else np.inf


def _pulled(model: FrameModel, N: np.ndarray) -> bool:
    """Whether axial forces N (ne, 2) leave nothing compressed but by rounding, and no lever can tilt."""
    arms = bool(model.levers) or any(any(m.cog) for m in model.frame.masses)
    return not arms and bool(N.min() >= -ROUNDING * np.abs(N).max())
