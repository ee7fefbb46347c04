"""What is put out along the legs: displacements and fibre stresses as linear maps of modal amplitudes."""

from dataclasses import dataclass

import numpy as np

from solver.errors import InputError
from solver.structure import recovery, statics, water
from solver.structure.frame import FrameModel

BENDING = [0, 4, 5]  # N, My, Mz among the section forces


@dataclass(frozen=True, eq=False, kw_only=True)
class Legs:
    """Maps for nl legs of nh nodes, of which no respond each in their own way (mirror images do not)."""

    height: np.ndarray  # (nh,) above the leg's foot [m]
    twin: np.ndarray  # (nl,) which of the no legs responds like it, or as its mirror image in y = 0
    mirrored: np.ndarray  # (nl,) bool
    displacement: np.ndarray  # (nm, no, nh, 3) [m]
    fibre: np.ndarray  # (3, nm, no, ne, 2) N/A, c My/Iy, c Mz/Iz at both ends of each element [Pa]
    static_fibre: np.ndarray  # (3, no, ne, 2)

    def response(self, p: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Displacement (m, no, nh, 3) [m], and stress (m, no, ne, 2) [Pa] of the most compressive fibre."""
        axial, about_y, about_z = (
            _map(p, shape) + static for shape, static in zip(self.fibre, self.static_fibre, strict=True)
        )
        about_y *= about_y
        about_z *= about_z
        about_y += about_z
        return _map(p, self.displacement), axial - np.sqrt(about_y, out=about_y)

    def of_all(self, displacement: np.ndarray) -> np.ndarray:
        """(…, no, 3) of the legs that are computed -> (…, nl, 3)."""
        return displacement[..., self.twin, :] * np.where(self.mirrored[:, None], [1.0, -1.0, 1.0], 1.0)


def at_nodes(ends: np.ndarray) -> np.ndarray:
    """Of the values (…, ne, 2) at the elements' ends, the larger of those that meet at each node, (…, ne + 1)."""
    first, last = ends[..., :1, 0], ends[..., -1:, 1]
    return np.concatenate([first, np.maximum(ends[..., 1:, 0], ends[..., :-1, 1]), last], axis=-1)


def outputs(names, model: FrameModel, sea, at_rest: np.ndarray, shapes: np.ndarray) -> Legs:
    """Maps for the named members from the basis shapes (6n, nm), with the static forces of rest."""
    nm = shapes.shape[1]
    loads = statics.self_weight(model, sea.gravity) + water.buoyancy(model, sea.density, sea.gravity)
    still = recovery.section_forces(model, at_rest, loads).reshape(-1, 2, 6)[..., BENDING]
    moving = (recovery.section_force_matrix(model) @ shapes).reshape(-1, 2, 6, nm)[:, :, BENDING]
    A, Iy, Iz, c = np.moveaxis(recovery.section_properties(model).reshape(-1, 2, 4), -1, 0)
    to_stress = np.stack([1 / A, c / Iy, c / Iz], axis=-1)
    still, moving = still * to_stress, moving * to_stress[..., None]
    counts = {leg: len(model.member_elements[leg]) for leg in names}
    if len(set(counts.values())) > 1:
        raise InputError("platform.legs", counts, "must have as many elements each: they share the heights")
    displacement, fibre, static = [], [], []
    for leg in names:
        nodes, elements = model.member_nodes[leg], np.array(model.member_elements[leg])
        end = slice(None)
        if model.xyz[nodes[0], 2] > model.xyz[nodes[-1], 2]:  # foot first
            nodes, elements, end = nodes[::-1], elements[::-1], slice(None, None, -1)
        displacement.append(shapes.reshape(-1, 6, nm)[nodes, :3])
        fibre.append(moving[elements][:, end])
        static.append(still[elements][:, end])
    own, twin, mirrored = _alike(np.array(displacement))
    return Legs(
        height=model.xyz[nodes, 2] - model.xyz[nodes[0], 2],
        twin=twin,
        mirrored=mirrored,
        displacement=np.ascontiguousarray(np.moveaxis(np.array(displacement)[own], -1, 0)),
        fibre=np.ascontiguousarray(np.moveaxis(np.array(fibre)[own], (-1, -2), (1, 0))),
        static_fibre=np.ascontiguousarray(np.moveaxis(np.array(static)[own], -1, 0)),
    )


def _alike(displacement: np.ndarray) -> tuple[list[int], np.ndarray, np.ndarray]:
    """Of legs (nl, nh, 3, nm) those whose response is their own; which of them each follows; which are mirrored."""
    own: list[int] = []
    twin, mirrored = np.zeros(len(displacement), int), np.zeros(len(displacement), bool)
    mirror, close = np.array([1.0, -1.0, 1.0])[:, None], 1e-9 * np.abs(displacement).max()
    for i, leg in enumerate(displacement):
        for place, j in enumerate(own):
            same = np.allclose(leg, displacement[j], rtol=0, atol=close)
            if same or np.allclose(leg, displacement[j] * mirror, rtol=0, atol=close):
                twin[i], mirrored[i] = place, not same
                break
        else:
            twin[i] = len(own)
            own.append(i)
    return own, twin, mirrored


def _map(p: np.ndarray, shapes: np.ndarray) -> np.ndarray:
    """Modal amplitudes (m, nm) times shapes (nm, …): (m, …)."""
    return (p @ shapes.reshape(len(shapes), -1)).reshape(len(p), *shapes.shape[1:])
