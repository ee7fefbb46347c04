"""Frozen inputs of a frame of beams, and their assembly into arrays."""

from collections import Counter
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from typing import Annotated, Literal, get_args

import numpy as np
import scipy  # sparse is slow to import, and the command line needs frames but rarely their matrices

from solver.errors import InputError, refuse
from solver.quantities import Quantity, of_no_unit, out_of_range, require_ranges
from solver.structure import beam
from solver.structure.beam import Section

COINCIDENT = 1e-9  # two nodes closer than this share of the frame's size are one
ROUNDING = 1e-9  # of a matrix's size, by which it may fall short of being symmetric and positive
HELD = 1e-13  # a rigid body's softest direction over its stiffest, below which nothing holds it
DIRECTIONS = "move along x", "move along y", "move along z", "turn about x", "turn about y", "turn about z"


Force = Literal["N", "Vy", "Vz", "T", "My", "Mz"]  # on a section, along and about the local axes
FORCES: tuple[Force, ...] = get_args(Force)
Vector = tuple[float, float, float]
Stiffness = tuple[float, ...] | tuple[tuple[float, ...], ...]


@dataclass(frozen=True, slots=True, kw_only=True)
class Material:
    """A linear elastic material."""

    E: Annotated[float, Quantity("Pa", above=0), "Young's modulus"]
    G: Annotated[float, Quantity("Pa", above=0), "Shear modulus"]
    density: Annotated[float, Quantity("kg/m3", above=0), "Density of the material"]

    def __post_init__(self) -> None:
        require_ranges(self, "material")

    @property
    def poisson(self) -> float:
        """Poisson's ratio ν = E/2G - 1 [-]."""
        return self.E / (2 * self.G) - 1


@dataclass(frozen=True, slots=True, kw_only=True)
class Member:
    """A straight prismatic beam from one named node to another; equal elements.

    Wave loads act on a member only if it has water coefficients: C_D > 0 or C_M > 1.
    """

    name: str
    start: str
    end: str
    elements: int
    section: Section
    material: Material
    drag_coefficient: Annotated[float, Quantity("-", least=0), "Morison's C_D"] = 0.0
    inertia_coefficient: Annotated[float, Quantity("-", least=1), "Morison's C_M = 1 + C_a"] = 1.0
    # True: water inside below still water, which moves with the member across its axis. False: sealed, with the
    # buoyancy of its outer volume. None: neither, as Heo et al. (2022) have it.
    flooded: Annotated[bool | None, "Whether a tube is full of water or sealed; left out, neither"] = None
    # A pin: ("My", "Mz"). The node that the end is at moves on with the other members.
    start_release: Annotated[tuple[Force, ...], "Forces, along its own axes, that its start does not pass on"] = ()
    end_release: Annotated[tuple[Force, ...], "Forces, along its own axes, that its end does not pass on"] = ()
    start_offset: Annotated[Vector, Quantity("m"), "From its first node to its start, rigid, along the global axes"] = (
        0.0, 0.0, 0.0,
    )  # fmt: skip
    end_offset: Annotated[Vector, Quantity("m"), "From its last node to its end, rigid, along the global axes"] = (
        0.0, 0.0, 0.0,
    )  # fmt: skip

    def __post_init__(self) -> None:
        refuse(self._problems(f"members.{self.name}"))

    def _problems(self, key: str) -> Iterator[InputError]:
        yield from out_of_range(self, key)
        if self.elements < 1 or int(self.elements) != self.elements:
            yield InputError(f"{key}.elements", self.elements, "must be a whole number >= 1")
        if self.start == self.end:
            yield InputError(f"{key}.end", self.end, "must differ from start: zero length")
        if self.in_water and self.section.diameter == 0:
            yield InputError(f"{key}.section.diameter", 0.0, "must be > 0 m for a member with water coefficients")
        if self.flooded is not None and self.section.diameter == 0:
            yield InputError(f"{key}.flooded", self.flooded, "is of tubes: leave it out")
        for end in ("start_release", "end_release"):
            for name in getattr(self, end):
                if name not in FORCES:
                    yield InputError(f"{key}.{end}", name, f"must be one of {', '.join(FORCES)}")

    def releases(self, *, start: bool = True, end: bool = True) -> np.ndarray:
        """Which ends' displacements (12,) are released in an element that has the member's start, its end, or both."""
        return np.array(
            [start and name in self.start_release for name in FORCES]
            + [end and name in self.end_release for name in FORCES]
        )

    @property
    def in_water(self) -> bool:
        """Whether wave loads act on the part below still water."""
        return self.drag_coefficient > 0 or self.inertia_coefficient > 1


@dataclass(frozen=True, slots=True, kw_only=True)
class PointMass:
    """A rigid body on a node; without inertia and lever a mass that resists translation alone."""

    node: str
    mass: Annotated[float, Quantity("kg", above=0), "Mass, without extent where nothing else is given"]
    cog: Annotated[Vector, Quantity("m"), "Centre of gravity, from the node"] = (0.0, 0.0, 0.0)
    inertia: Annotated[
        Vector,
        Quantity("kg m2", least=0),
        "Moments of inertia about axes through the c.o.g. along the global ones",
    ] = (0.0, 0.0, 0.0)
    products_of_inertia: Annotated[
        Vector, Quantity("kg m2"), "Integrals of xy, xz and yz over the mass, about the c.o.g."
    ] = (0.0, 0.0, 0.0)

    def __post_init__(self) -> None:
        key = f"masses.{self.node}"
        require_ranges(self, key)
        tensor = self.tensor
        spread = np.trace(tensor) / 2 * np.eye(3) - tensor  # ∫ r rᵀ dm, of which no direction can have less than none
        if np.linalg.eigvalsh(spread)[0] < -ROUNDING * np.trace(tensor):
            limit = "no body has such moments: each principal one must be <= the sum of the other two"
            raise InputError(f"{key}.inertia", self.inertia, limit)

    @property
    def tensor(self) -> np.ndarray:
        """Inertia about the c.o.g. (3, 3) [kg m2]."""
        xy, xz, yz = self.products_of_inertia
        return np.diag(self.inertia) - np.array([[0, xy, xz], [xy, 0, yz], [xz, yz, 0]])

    @property
    def matrix(self) -> np.ndarray:
        """Mass (6, 6) as the node has it [kg, kg m, kg m2]: the c.o.g. moves by u + θ × r."""
        rigid = beam.lever(self.cog)[:3]
        matrix = self.mass * rigid.T @ rigid
        matrix[3:, 3:] += self.tensor
        return matrix


@dataclass(frozen=True, slots=True, kw_only=True)
class PointLoad:
    """A constant force on a node."""

    node: str
    force: Annotated[Vector, Quantity("N"), "Constant force, along the global axes"]

    def __post_init__(self) -> None:
        if np.shape(self.force) != (3,) or not np.all(np.isfinite(self.force)):
            raise InputError(f"loads.{self.node}", self.force, "must be three finite forces [N]")


@dataclass(frozen=True, slots=True, kw_only=True)
class Frame:
    """Named nodes, members between them, feet that are clamped or on springs, lumped masses and static loads."""

    nodes: Mapping[str, Vector]  # name -> (x, y, z) [m]
    members: tuple[Member, ...]
    clamped: tuple[str, ...] = ()
    masses: tuple[PointMass, ...] = ()
    loads: tuple[PointLoad, ...] = ()
    # node -> stiffness of the ground under it along and about the global axes: six, or (6, 6) [N/m, N, N m]
    foundation: Mapping[str, Stiffness] = field(default_factory=dict)

    def __hash__(self) -> int:
        """Equal frames have equal text; a mapping alone would have no hash."""
        return hash(repr(self))

    def __post_init__(self) -> None:
        refuse(self._coordinate_problems())
        refuse(self._name_problems())
        refuse(self._offset_problems())
        refuse(self._foundation_problems())
        refuse(self._support_problems())
        refuse(self._release_problems())

    @property
    def grounded(self) -> tuple[str, ...]:
        """The feet: clamped nodes, and those on foundations."""
        return (*self.clamped, *self.foundation)

    def foundation_matrix(self, node: str) -> np.ndarray:
        """Stiffness (6, 6) of the ground under a node [N/m, N, N m]."""
        given = np.array(self.foundation[node], float)
        return np.diag(given) if given.ndim == 1 else given

    def _coordinate_problems(self) -> Iterator[InputError]:
        for name, xyz in self.nodes.items():
            if np.shape(xyz) != (3,) or not np.all(np.isfinite(xyz)):
                yield InputError(f"nodes.{name}", xyz, "must be three finite coordinates [m]")
                return
        names, places = list(self.nodes), np.array(list(self.nodes.values()), float).reshape(-1, 3)
        size = np.ptp(places, axis=0).max(initial=0.0)
        for i, name in enumerate(names[1:], start=1):
            gap = np.linalg.norm(places[:i] - places[i], axis=1)
            if gap.min() <= COINCIDENT * size:
                yield InputError(f"nodes.{name}", self.nodes[name], f"must not coincide with {names[gap.argmin()]}")

    def ends(self, member: Member) -> np.ndarray:
        """Places of a member's start and end (2, 3) [m], at the ends of their rigid offsets."""
        nodes = np.array([self.nodes[member.start], self.nodes[member.end]], float)
        return nodes + np.array([member.start_offset, member.end_offset])

    def places(self) -> Iterator[tuple[str, tuple[float, ...]]]:
        """Keys and places [m] of the nodes, and of the ends of members that rigid offsets move."""
        for name, place in self.nodes.items():
            yield f"nodes.{name}", place
        for member in (m for m in self.members if any((*m.start_offset, *m.end_offset))):
            for end, offset, place in zip(
                ("start", "end"), (member.start_offset, member.end_offset), self.ends(member), strict=True
            ):
                if any(offset):
                    yield f"members.{member.name}.{end}_offset", tuple(place.tolist())

    def _offset_problems(self) -> Iterator[InputError]:
        """Offsets that leave nothing of a member, or turn it round."""
        for member in (m for m in self.members if any((*m.start_offset, *m.end_offset))):
            apart, between = np.subtract(self.nodes[member.end], self.nodes[member.start]), self.ends(member)
            if not (between[1] - between[0]) @ apart > COINCIDENT * apart @ apart:
                offsets = member.start_offset, member.end_offset
                limit = "must leave some of the way between its nodes, offsets"
                yield InputError(f"members.{member.name}.start_offset", offsets, limit)

    def _name_problems(self) -> Iterator[InputError]:
        if not self.members:
            yield InputError("members", "[]", "needs at least one member")
        if not self.grounded:
            yield InputError("clamped", "[]", "needs at least one node, or one on a foundation: the frame floats away")
        for key, names in (("members", [member.name for member in self.members]), ("clamped", self.clamped)):
            for name, count in Counter(names).items():
                if count > 1:
                    yield InputError(key, name, f"given {count} times, must be unique")
        for key, node in self._mentioned():
            if node not in self.nodes:
                yield InputError(key, node, f"must be one of {', '.join(self.nodes)}")

    def _mentioned(self) -> Iterator[tuple[str, str]]:
        """Keys under which nodes are mentioned, and those nodes."""
        for member in self.members:
            yield f"members.{member.name}.start", member.start
            yield f"members.{member.name}.end", member.end
        yield from ((f"clamped[{i}]", node) for i, node in enumerate(self.clamped))
        yield from ((f"foundation.{node}", node) for node in self.foundation)
        yield from ((f"masses[{i}].node", mass.node) for i, mass in enumerate(self.masses))
        yield from ((f"loads[{i}].node", load.node) for i, load in enumerate(self.loads))

    def _foundation_problems(self) -> Iterator[InputError]:
        for node, given in self.foundation.items():
            key = f"foundation.{node}"
            if node in self.clamped:
                yield InputError(key, given, "is clamped, too: leave it out of one of them")
            if np.shape(given) not in ((6,), (6, 6)) or not np.all(np.isfinite(given)):
                yield InputError(key, given, "must be six finite stiffnesses, or six rows of six")
                continue
            k = of_no_unit(self.foundation_matrix(node))
            if np.abs(k - k.T).max() > ROUNDING:
                yield InputError(key, given, "must be symmetric")
            elif np.linalg.eigvalsh(k)[0] < -ROUNDING:
                yield InputError(key, given, "must not have a negative stiffness in any direction")

    def _support_problems(self) -> Iterator[InputError]:
        """Every node hangs on a clamped one or on foundations that hold it, or the stiffness is singular."""
        neighbours: dict[str, set[str]] = {name: set() for name in self.nodes}
        for member in self.members:
            neighbours[member.start].add(member.end)
            neighbours[member.end].add(member.start)

        def joined(reached: set[str]) -> set[str]:
            held: set[str] = set()
            while reached:
                held |= reached
                reached = {other for name in reached for other in neighbours[name]} - held
            return held

        held = joined(set(self.clamped))
        for node in self.foundation:
            if node not in held and neighbours[node]:
                part = joined({node})
                held |= part
                yield from self._loose(part)
        floating = [name for name in self.nodes if name not in held]
        if floating:
            limit = "must be joined to a clamped node by members, or to one on a foundation"
            yield InputError("nodes", ", ".join(floating), limit)

    def _release_problems(self) -> Iterator[InputError]:
        """Releases that let a member, or a node among members in one piece each, move without a force or a mass."""
        if not any(member.releases().any() for member in self.members):
            return
        number = {name: 6 * i + np.arange(6) for i, name in enumerate(self.nodes)}
        left, whole = np.zeros(
            (2, 2, 6 * len(number), 6 * len(number))
        )  # stiffness and mass, with releases and without
        for member in self.members:
            ends, section, material = self.ends(member), member.section, member.material
            L = float(np.linalg.norm(ends[1] - ends[0]))
            arms = scipy.linalg.block_diag(beam.lever(member.start_offset), beam.lever(member.end_offset))
            T = beam.to_global(beam.rotation(*ends)) @ arms
            shear = beam.shear_parameters(material.E, material.G, section, L)
            stiffness = beam.stiffness(material.E, material.G, section, L)
            own = np.array([stiffness, beam.mass(material.density, section, L, shear)])
            try:
                C = beam.condensation(stiffness, member.releases())
            except np.linalg.LinAlgError:
                limit = "with end_release leaves the member itself free to move or turn"
                yield InputError(f"members.{member.name}.start_release", member.start_release, limit)
                return
            at = np.concatenate([number[member.start], number[member.end]])
            left[:, at[:, None], at] += T.T @ C.T @ own @ C @ T
            whole[:, at[:, None], at] += T.T @ own @ T
        on_nodes = [(0, node, self.foundation_matrix(node)) for node in self.foundation]
        on_nodes += [(1, item.node, item.matrix) for item in self.masses]
        for kind, node, matrix in on_nodes:
            at = number[node]
            left[kind, at[:, None], at] += matrix
            whole[kind, at[:, None], at] += matrix
        free = _free(self, {name: i for i, name in enumerate(self.nodes)}, left.shape[1])
        names = ", ".join(m.name for m in self.members if m.releases().any())
        for kept, before, word in zip(left, whole, ("free to", "without inertia to"), strict=True):
            if free.size and (loose := _loosest(kept, before, free)) is not None:
                node, direction = list(self.nodes)[loose // 6], DIRECTIONS[loose % 6]
                yield InputError("members", names, f"with their releases leave {node} {word} {direction}")
                return

    def _loose(self, part: set[str]) -> Iterator[InputError]:
        """A part that stands on foundations alone, and can move as a rigid body."""
        feet = [node for node in self.foundation if node in part]
        places = np.array([self.nodes[node] for node in feet])
        size = np.ptp([self.nodes[node] for node in part], axis=0).max()
        rigid = np.zeros((6, 6))
        for node, arm in zip(feet, places - places.mean(axis=0), strict=True):
            move = np.eye(6)
            move[:3, 3:] = np.cross(np.eye(3), arm).T
            move[:, 3:] /= size
            rigid += move.T @ self.foundation_matrix(node) @ move
        values, vectors = np.linalg.eigh(rigid)
        if not values[0] > HELD * values[-1]:
            direction = DIRECTIONS[int(np.abs(vectors[:, 0]).argmax())]
            limit = f"must hold what stands on it, which is free to {direction}"
            yield InputError("foundation", ", ".join(feet), limit)


@dataclass(frozen=True, kw_only=True, eq=False)
class FrameModel:
    """A frame as arrays: n nodes, ne elements; (ux, uy, uz, θx, θy, θz) at each node."""

    frame: Frame
    xyz: np.ndarray  # (n, 3) [m]
    node_index: Mapping[str, int]  # named nodes
    elements: np.ndarray  # (ne, 2) node numbers
    dofs: np.ndarray  # (ne, 12) numbers of the element's degrees of freedom
    member: np.ndarray  # (ne,) index of the element's member
    member_elements: Mapping[str, range]  # in order from start to end
    member_nodes: Mapping[str, np.ndarray]  # in order from start to end
    free: np.ndarray  # numbers of the degrees of freedom that are not clamped
    length: np.ndarray  # (ne,) [m]
    rotation: np.ndarray  # (ne, 3, 3) rows = local axes
    levers: Mapping[int, np.ndarray]  # (2, 3) from the nodes to the ends [m], of elements with rigid offsets
    transform: np.ndarray  # (ne, 12, 12) T: displacements of the ends in local axes, of those of the nodes
    shear: np.ndarray  # (ne, 2) φ in the planes xy and xz; 0 of Euler-Bernoulli's beams
    element_stiffness: np.ndarray  # (ne, 12, 12) local axes
    K: "scipy.sparse.csr_array"  # (6n, 6n), foundations included, clamped supports not yet removed
    M: "scipy.sparse.csr_array"  # (6n, 6n), consistent and lumped
    ground: "scipy.sparse.csr_array"  # (6n, 6n) stiffness of the foundations
    # (ne, 12, 12) local axes, what axial forces add to the stiffness; None: not taken into account
    element_geometric: np.ndarray | None = None
    condensation: Mapping[int, np.ndarray] = field(default_factory=dict)  # C (12, 12) of elements with released ends

    def member_of(self, element: int) -> Member:
        """The member that an element is part of."""
        return self.frame.members[self.member[element]]

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
        T[e] = T[e] @ scipy.linalg.block_diag(*map(beam.lever, arms))
    owner = [frame.members[i] for i in member]
    pairs = list(zip(owner, length, strict=True))
    stiffness = np.array([beam.stiffness(m.material.E, m.material.G, m.section, L) for m, L in pairs])
    shear = np.array([beam.shear_parameters(m.material.E, m.material.G, m.section, L) for m, L in pairs])
    mass = np.array(
        [beam.mass(m.material.density, m.section, L, phi) for (m, L), phi in zip(pairs, shear, strict=True)]
    )
    condensation = _condensation(frame, stiffness)
    for e, C in condensation.items():
        stiffness[e], mass[e] = C.T @ stiffness[e] @ C, C.T @ mass[e] @ C
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
        member_elements={m.name: range(end - m.elements, end) for m, end in zip(frame.members, ends, strict=True)},
        member_nodes=member_nodes,
        free=_free(frame, node_index, size),
        length=length,
        rotation=rotation,
        levers=levers,
        transform=T,
        shear=shear,
        element_stiffness=stiffness,
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


def _condensation(frame: Frame, stiffness: np.ndarray) -> dict[int, np.ndarray]:
    """C (12, 12) of the elements that have released ends."""
    found, first = {}, 0
    for member in frame.members:
        for e in sorted({0, member.elements - 1}):
            released = member.releases(start=e == 0, end=e == member.elements - 1)
            if released.any():
                found[first + e] = beam.condensation(stiffness[first + e], released)
        first += member.elements
    return found


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


def _loosest(kept: np.ndarray, whole: np.ndarray, free: np.ndarray) -> int | None:
    """The degree of freedom that takes most part in a motion which releases leave without stiffness or mass, if any."""
    size = 1 / np.sqrt(np.diag(whole)[free])
    values, vectors = np.linalg.eigh(size[:, None] * kept[np.ix_(free, free)] * size)
    return None if values[0] >= beam.LOOSE else int(free[np.abs(vectors[:, 0]).argmax()])


def _free(frame: Frame, node_index: Mapping[str, int], size: int) -> np.ndarray:
    clamped = [6 * node_index[name] + np.arange(6) for name in frame.clamped]
    return np.setdiff1d(np.arange(size), np.ravel(clamped))
