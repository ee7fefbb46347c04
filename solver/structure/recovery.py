"""Section forces and stresses from nodal displacements.

(N, Vy, Vz, T, My, Mz) in local axes act on the face whose outward normal is local +x, so that
tension is positive. Element ends are numbered 2 e (start) and 2 e + 1 (end).
"""

from collections.abc import Iterable
from functools import lru_cache

import numpy as np
from scipy import sparse

from solver.structure.frame_model import FrameModel, sparse_sum
from solver.structure.sections import Section

FACE = np.repeat([-1.0, 1.0], 6)  # nodal forces at the start act on the face -x


@lru_cache(maxsize=8)
def section_force_matrix(model: FrameModel) -> sparse.csr_array:
    """S, sparse (12 ne, 6n): (S @ d).reshape(2 ne, 6) are the section forces of d (6n,) [N, N m].

    Of the nodal displacements alone; what a load spread within an element adds is in
    `section_forces`.
    """
    blocks = FACE[:, None] * (model.softened_stiffness @ model.transform)
    rows = np.arange(model.dofs.size).reshape(-1, 12)
    return sparse_sum(blocks, rows, model.dofs, (model.dofs.size, model.K.shape[0]))


def section_forces(model: FrameModel, displacement: np.ndarray, element_loads: np.ndarray) -> np.ndarray:
    """Static section forces at every element end, (2 ne, 6) [N, N m]: ± (k d - f).

    `element_loads` f (ne, 12), local axes, are the consistent loads within the elements (self
    weight, buoyancy): without them the foot would miss half an element's weight.
    """
    of_nodes = section_force_matrix(model) @ displacement
    return (of_nodes - np.tile(FACE, len(model.elements)) * element_loads.ravel()).reshape(-1, 6)


def section_properties(model: FrameModel) -> np.ndarray:
    """(A, Iy, Iz, c) at every element end, (2 ne, 4) [m2, m4, m4, m]."""
    return properties(model.section_at(end) for end in range(2 * len(model.elements)))


def properties(sections: Iterable[Section]) -> np.ndarray:
    """(A, Iy, Iz, c) of each, (n, 4)."""
    return np.array([(section.area, section.Iy, section.Iz, section.fibre) for section in sections]).reshape(-1, 4)
