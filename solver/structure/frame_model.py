"""A frame as arrays: its mesh of elements, their matrices, and the sums of these over the frame."""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np
import scipy

from solver.rigid import lever
from solver.structure import beam
from solver.structure.frame import Frame
from solver.structure.members import Member
from solver.structure.sections import Section


@dataclass(frozen=True, kw_only=True, eq=False)
class FrameModel:
    """A frame as arrays: n nodes, ne elements; (ux, uy, uz, θx, θy, θz) at each node."""

    frame: Frame
    xyz: np.ndarray  # (n, 3) [m]
    node_index: Mapping[str, int]  # named nodes
    elements: np.ndarray  # (ne, 2) node numbers
    dofs: np.ndarray  # (ne, 12) numbers of the element's degrees of freedom
    member: np.ndarray  # (ne,) index of the element's member
    sections: Sequence[Section]  # (ne,)
    member_elements: Mapping[str, range]  # in order from start to end
    member_nodes: Mapping[str, np.ndarray]  # in order from start to end
    free: np.ndarray  # numbers of the degrees of freedom that are not clamped
    length: np.ndarray  # (ne,) [m]
    rotation: np.ndarray  # (ne, 3, 3) rows = local axes
    levers: Mapping[int, np.ndarray]  # (2, 3) from the nodes to the ends [m], of elements with rigid offsets
    transform: np.ndarray  # (ne, 12, 12) T: displacements of the ends in local axes, of those of the nodes
    shear: np.ndarray  # (ne, 2) φ in the planes xy and xz; 0 of Euler-Bernoulli's beams
    element_stiffness: np.ndarray  # (ne, 12, 12) local axes, with the soil round it
    axial: np.ndarray  # (ne,) EA/L, of released ends what is left of it [N/m]
    soil: Mapping[int, np.ndarray]  # (12, 12) local axes, of the elements that are in it
    K: "scipy.sparse.csr_array"  # (6n, 6n), foundations included, clamped supports not yet removed
    M: "scipy.sparse.csr_array"  # (6n, 6n), consistent and lumped
    ground: "scipy.sparse.csr_array"  # (6n, 6n) stiffness of the foundations
    # (ne, 12, 12) local axes, what axial forces add to the stiffness; None: not taken into account
    element_geometric: np.ndarray | None = None
    condensation: Mapping[int, np.ndarray] = field(default_factory=dict)  # C (12, 12) of elements with released ends

    def member_of(self, element: int) -> Member:
        """The member that an element is part of."""
        return self.frame.members[self.member[element]]

    def section_at(self, end: int) -> Section:
        """Of an element's end, numbered 2 e (start) and 2 e + 1 (end)."""
        member = self.member_of(end // 2)
        return member.section_at(((end + 1) // 2 - self.member_elements[member.name][0]) / member.elements)

    @property
    def size(self) -> float:
        """Longest side [m] of the box that holds its nodes."""
        return float(np.ptp(self.xyz, axis=0).max())

    @property
    def arms(self) -> np.ndarray:
        """(6n,) by which moments are loads of one unit: 1, and the frame's size [m] of those that turn."""
        return np.where(np.arange(6 * len(self.xyz)) % 6 < 3, 1.0, self.size)

    @property
    def ends(self) -> np.ndarray:
        """Places of the elements' ends (ne, 2, 3) [m]."""
        return _ends(self.xyz[self.elements], self.levers)

    def released(self, element: int, local: np.ndarray, *, both: bool = False) -> np.ndarray:
        """A row, or rows (…, 12), of an element's end displacements as rows of its nodes'; or on both sides, CᵀAC."""
        if element not in self.condensation:
            return local
        C = self.condensation[element]
        return C.T @ local @ C if both else local @ C

    @property
    def softened_stiffness(self) -> np.ndarray:
        """(ne, 12, 12) local axes, with what gravity takes of it where that is asked for."""
        return (
            self.element_stiffness
            if self.element_geometric is None
            else self.element_stiffness + self.element_geometric
        )

    def soil_reaction(self, member: Member) -> tuple[np.ndarray, np.ndarray]:
        """Force and moment of the soil on a member, as rows (6, 6n) of the displacement, and the place (3,) of both.

        Where the member enters the seabed, or its upper end below it.
        """
        ends = self.frame.ends(member)
        upper, lower = ends[np.argsort(-ends[:, 2])]
        if upper[2] > self.frame.seabed:
            upper = upper + (upper[2] - self.frame.seabed) / (upper[2] - lower[2]) * (lower - upper)
        rows = np.zeros((6, self.K.shape[0]))
        for e in (e for e in self.member_elements[member.name] if e in self.soil):
            T, dofs = self.transform[e], self.dofs[e]
            rigid = np.concatenate([lever(self.xyz[node] - upper) for node in self.elements[e]])
            rows[:, dofs] -= rigid.T @ T.T @ self.soil[e] @ T
        return rows, upper

    def translations(self, node: str) -> np.ndarray:
        """Numbers of the three translations of a named node."""
        return 6 * self.node_index[node] + np.arange(3)

    def total(self, loads: np.ndarray) -> np.ndarray:
        """Element loads (ne, 12) in local axes, summed as one vector (6n,) in global axes."""
        in_global = np.einsum("ekj,eak->eaj", self.rotation, loads.reshape(-1, 4, 3))
        for e, arms in self.levers.items():
            in_global[e, 1::2] += np.cross(arms, in_global[e, ::2])
        vector = np.zeros(6 * len(self.xyz))
        np.add.at(vector, self.dofs, in_global.reshape(-1, 12))
        return vector


def assemble(frame: Frame) -> FrameModel:
    """Mesh, element matrices, K and M of the paper's eq. 15, supports not yet removed.

    Named nodes come first, then the members' interior nodes. Released ends are condensed out of the matrices.
    """
    xyz, node_index, member_nodes = _mesh(frame)
    elements = np.concatenate([np.column_stack([nodes[:-1], nodes[1:]]) for nodes in member_nodes.values()])
    counts = [member.elements for member in frame.members]
    member = np.repeat(np.arange(len(counts)), counts)
    ends = np.cumsum(counts)
    dofs = (6 * elements[:, :, None] + np.arange(6)).reshape(-1, 12)
    levers = _levers(frame)
    places = _ends(xyz[elements], levers)
    length = np.linalg.norm(places[:, 1] - places[:, 0], axis=1)
    rotation = np.array([beam.rotation(*pair) for pair in places])
    T = np.array([beam.to_global(R) for R in rotation])
    for e, arms in levers.items():
        T[e] = T[e] @ scipy.linalg.block_diag(*map(lever, arms))
    sections = [section for member in frame.members for section in member.sections]
    parts = list(zip([frame.members[i].material for i in member], sections, length, strict=True))
    stiffness = np.array([beam.stiffness(m.E, m.G, section, L) for m, section, L in parts])
    shear = np.array([beam.shear_parameters(m.E, m.G, section, L) for m, section, L in parts])
    mass = np.array([beam.mass(m.density, s, L, phi) for (m, s, L), phi in zip(parts, shear, strict=True)])
    condensation = {}
    for e, released, springs in _released(frame):
        C = condensation[e] = beam.condensation(stiffness[e], released, springs)
        stiffness[e], mass[e] = beam.condensed_stiffness(stiffness[e], C, springs), C.T @ mass[e] @ C
    axial = stiffness[:, 0, 0].copy()
    soil = {}
    for e in np.flatnonzero(places[:, :, 2].min(axis=1) < frame.seabed).tolist():
        assert frame.soil is not None, "nothing is below it elsewhere"
        C = condensation.get(e, np.eye(12))
        soil[e] = C.T @ frame.soil.element(places[e], shear[e]) @ C
        stiffness[e] += soil[e]
    size = 6 * len(xyz)
    K = scatter(stiffness, T, dofs, size)
    ground = on_nodes([(node_index[name], frame.foundation_matrix(name)) for name in frame.foundation], size)
    return FrameModel(
        frame=frame,
        xyz=xyz,
        node_index=node_index,
        elements=elements,
        dofs=dofs,
        member=member,
        sections=sections,
        member_elements={m.name: range(end - m.elements, end) for m, end in zip(frame.members, ends, strict=True)},
        member_nodes=member_nodes,
        free=frame.free(node_index, size),
        length=length,
        rotation=rotation,
        levers=levers,
        transform=T,
        shear=shear,
        element_stiffness=stiffness,
        axial=axial,
        soil=soil,
        K=K + ground if frame.foundation else K,
        M=scatter(mass, T, dofs, size) + on_nodes([(node_index[m.node], m.matrix) for m in frame.masses], size),
        ground=ground,
        condensation=condensation,
    )


def _levers(frame: Frame) -> dict[int, np.ndarray]:
    """From nodes to ends (2, 3), of the elements at the ends of members with rigid offsets."""
    found: dict[int, np.ndarray] = {}
    first = 0
    for member in frame.members:
        for place, e, offset in ((0, 0, member.start_offset), (1, member.elements - 1, member.end_offset)):
            if any(offset):
                found.setdefault(first + e, np.zeros((2, 3)))[place] = offset
        first += member.elements
    return found


def _ends(places: np.ndarray, levers: Mapping[int, np.ndarray]) -> np.ndarray:
    """Places of the elements' ends (ne, 2, 3) [m], of those of their nodes."""
    ends = places.copy()
    for e, arms in levers.items():
        ends[e] += arms
    return ends


def _released(frame: Frame) -> Iterator[tuple[int, np.ndarray, np.ndarray]]:
    """Elements that have released ends: which of their displacements (12,), and on what springs (12,)."""
    first = 0
    for member in frame.members:
        for e in sorted({0, member.elements - 1}):
            if (released := member.releases(start=e == 0, end=e == member.elements - 1)).any():
                yield first + e, released, member.springs
        first += member.elements


def _mesh(frame: Frame) -> tuple[np.ndarray, dict[str, int], dict[str, np.ndarray]]:
    """Coordinates, named node numbers, and the nodes along each member."""
    xyz = [np.asarray(point, float) for point in frame.nodes.values()]
    node_index = {name: i for i, name in enumerate(frame.nodes)}
    member_nodes = {}
    for member in frame.members:
        start, end = node_index[member.start], node_index[member.end]
        first, last = frame.ends(member)
        line = np.linspace(first, last, member.elements + 1)
        inner = np.arange(len(xyz), len(xyz) + member.elements - 1)
        xyz.extend(line[1:-1])
        member_nodes[member.name] = np.array([start, *inner, end])
    return np.array(xyz), node_index, member_nodes


def scatter(matrices: np.ndarray, T: np.ndarray, dofs: np.ndarray, size: int) -> "scipy.sparse.csr_array":
    """Element matrices (ne, 12, 12) in local axes, summed as one sparse matrix in global axes; T as in FrameModel."""
    return sparse_sum(T.transpose(0, 2, 1) @ matrices @ T, dofs, dofs, (size, size))


def sparse_sum(
    blocks: np.ndarray, rows: np.ndarray, columns: np.ndarray, shape: tuple[int, int]
) -> "scipy.sparse.csr_array":
    """Sparse sum of dense blocks (nb, r, c) placed at rows (nb, r) and columns (nb, c)."""
    i = np.broadcast_to(rows[:, :, None], blocks.shape).ravel()
    j = np.broadcast_to(columns[:, None, :], blocks.shape).ravel()
    return scipy.sparse.csr_array(scipy.sparse.coo_array((blocks.ravel(), (i, j)), shape=shape))


def on_nodes(matrices: Iterable[tuple[int, np.ndarray]], size: int) -> "scipy.sparse.csr_array":
    """Matrices (6, 6) of nodes, summed as one sparse matrix."""
    pairs = list(matrices)
    dofs = np.array([6 * node + np.arange(6) for node, _ in pairs], int).reshape(-1, 6)
    return sparse_sum(np.array([matrix for _, matrix in pairs]).reshape(-1, 6, 6), dofs, dofs, (size, size))
