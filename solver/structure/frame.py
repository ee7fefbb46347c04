"""Frozen inputs of a frame of beams, and what is refused among them; `frame_model` makes arrays of them."""

import contextlib
from collections import Counter
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np
import scipy  # its parts are imported when first used: the command line needs frames but rarely their matrices

from solver.errors import InputError, refuse
from solver.quantities import of_no_unit, out_of_range, take_tuples
from solver.rigid import lever
from solver.structure import beam
from solver.structure.members import ROUNDING, MarineGrowth, Member, PointLoad, PointMass, Vector
from solver.structure.soil import Soil, falling

COINCIDENT = 1e-9  # two nodes closer than this share of the frame's size are one
HELD = 1e-13  # a rigid body's softest direction over its stiffest, below which nothing holds it
DIRECTIONS = "move along x", "move along y", "move along z", "turn about x", "turn about y", "turn about z"

Stiffness = tuple[float, ...] | tuple[tuple[float, ...], ...]


@dataclass(frozen=True, kw_only=True)
class Frame:
    """Named nodes, members between them, feet that are clamped or on springs, lumped masses and static loads."""

    nodes: Mapping[str, Vector]  # name -> (x, y, z) [m]
    members: tuple[Member, ...]
    clamped: tuple[str, ...] = ()
    masses: tuple[PointMass, ...] = ()
    loads: tuple[PointLoad, ...] = ()
    # node -> stiffness of the ground under it along and about the global axes: six, or (6, 6) [N/m, N, N m]
    foundation: Mapping[str, Stiffness] = field(default_factory=dict)
    growth: tuple[MarineGrowth, ...] = ()  # straight between its lines, downwards, and level beyond them
    soil: Soil | None = None  # round what is below the seabed

    def __hash__(self) -> int:
        """Of the text, for a mapping has none; equal frames that are written otherwise, 10 for 10.0, share nothing."""
        return hash(self._text)

    @cached_property
    def _text(self) -> str:
        return repr(self)  # of a hundred elements, as dear as all else that a task asks of caches

    def __post_init__(self) -> None:
        take_tuples(self)
        refuse(self._coordinate_problems())
        refuse(self._name_problems())
        refuse(self._growth_problems())
        refuse(self._offset_problems())
        refuse(self._foundation_problems())
        refuse(self._support_problems())
        refuse(self._release_problems())

    def grown(self, z: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Thickness [m] and density [kg/m3] of the growth at heights z (n,)."""
        if not self.growth:
            return np.zeros(z.shape), np.zeros(z.shape)
        depth, thickness, density = np.array([(line.depth, line.thickness, line.density) for line in self.growth]).T
        return np.interp(-z, depth, thickness), np.interp(-z, depth, density)

    @property
    def grounded(self) -> tuple[str, ...]:
        """The feet: clamped nodes, and those on foundations."""
        return (*self.clamped, *self.foundation)

    @property
    def freedoms(self) -> int:
        """How many degrees of freedom of its nodes, those within members too, are not clamped."""
        return 6 * (len(self.nodes) - len(self.clamped) + sum(member.elements - 1 for member in self.members))

    @property
    def seabed(self) -> float:
        """z [m] below which there is soil in place of water."""
        return -np.inf if self.soil is None else self.soil.seabed

    @property
    def buried(self) -> list[Member]:
        """Members with a part in soil."""
        return [m for m in self.members if self.ends(m)[:, 2].min() < self.seabed]

    def foundation_matrix(self, node: str) -> np.ndarray:
        """Stiffness (6, 6) of the ground under a node [N/m, N, N m]."""
        given = np.array(self.foundation[node], float)
        return np.diag(given) if given.ndim == 1 else given

    def free(self, node_index: Mapping[str, int], size: int) -> np.ndarray:
        """Which of 6n = size degrees of freedom are not clamped, of nodes numbered by name."""
        clamped = [6 * node_index[name] + np.arange(6) for name in self.clamped]
        return np.setdiff1d(np.arange(size), np.ravel(clamped))

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
                limit = f"must not coincide with {(other := names[gap.argmin()])}"
                hinge = next((node for node in (name, other) if node.startswith("hinge:")), "")
                named = f": {hinge} is the float's own node there, which members may name" if hinge else ""
                yield InputError(f"nodes.{name}", self.nodes[name], limit + named)

    def ends(self, member: Member) -> np.ndarray:
        """Places of a member's start and end (2, 3) [m], at the ends of their rigid offsets."""
        nodes = np.array([self.nodes[member.start], self.nodes[member.end]], float)
        return nodes + np.array([member.start_offset, member.end_offset])

    def buckling_length(self, member: Member) -> float:
        """Of a member [m]: its own, where it has no other."""
        start, end = self.ends(member)
        return float(np.linalg.norm(end - start)) if member.buckling_length is None else member.buckling_length

    def places(self) -> Iterator[tuple[str, tuple[float, ...]]]:
        """Keys and places [m] of the nodes, and of the ends of members that rigid offsets move."""
        for name, place in self.nodes.items():
            yield f"nodes.{name}", place
        for member in self._off_nodes():
            for end, offset, place in zip(
                ("start", "end"), (member.start_offset, member.end_offset), self.ends(member), strict=True
            ):
                if any(offset):
                    yield f"members.{member.name}.{end}_offset", tuple(place.tolist())

    def _off_nodes(self) -> Iterator[Member]:
        """Members that have a rigid offset."""
        return (m for m in self.members if any((*m.start_offset, *m.end_offset)))

    def _offset_problems(self) -> Iterator[InputError]:
        """Offsets that leave nothing of a member, or turn it round."""
        for member in self._off_nodes():
            apart, between = np.subtract(self.nodes[member.end], self.nodes[member.start]), self.ends(member)
            if not (between[1] - between[0]) @ apart > COINCIDENT * apart @ apart:
                taken = {"start": member.start_offset @ apart, "end": -(member.end_offset @ apart)}
                other, worse = sorted(taken, key=lambda end: taken[end])
                limit = "must leave some of the way between its nodes"
                if any(getattr(member, f"{other}_offset")):
                    limit += f", with {other}_offset"
                key = f"{worse}_offset"
                yield InputError(f"members.{member.name}.{key}", getattr(member, key), limit)

    def _name_problems(self) -> Iterator[InputError]:
        if not self.members:
            yield InputError("members", "[]", "needs at least one member")
        if self.soil is not None and not self.buried:
            yield InputError("soil", f"below z = {self.seabed:g} m", "must meet a member: none is as deep")
        if not self.grounded and self.soil is None:
            limit = "needs at least one node, or one on a foundation, or soil: the frame floats away"
            yield InputError("clamped", "[]", limit)
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

    def _growth_problems(self) -> Iterator[InputError]:
        for i, line in enumerate(self.growth):
            yield from out_of_range(line, f"marine_growth[{i}]")
        yield from falling([line.depth for line in self.growth], "marine_growth")

    def _foundation_problems(self) -> Iterator[InputError]:
        for node, given in self.foundation.items():
            key, shape = f"foundation.{node}", np.shape(given)
            told = given if len(shape) == 1 else " x ".join(map(str, shape))  # 36 numbers would hide the reason
            if node in self.clamped:
                yield InputError(key, told, "is clamped, too: leave it out of one of them")
            if shape not in ((6,), (6, 6)) or not np.all(np.isfinite(given)):
                yield InputError(key, told, "must be six finite stiffnesses, or six rows of six")
                continue
            matrix = self.foundation_matrix(node)
            k = of_no_unit(matrix)
            if (gap := np.abs(k - k.T)).max() > ROUNDING:
                i, j = np.unravel_index(np.argmax(gap), gap.shape)
                limit = f"must be symmetric: row {i + 1} has {matrix[i, j]:g} in column {j + 1}"
                yield InputError(key, told, f"{limit}, row {j + 1} {matrix[j, i]:g} in column {i + 1}")
            elif np.linalg.eigvalsh(k)[0] < -ROUNDING:
                yield InputError(key, told, "must not have a negative stiffness in any direction")

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
        for node in (*self.foundation, *(member.start for member in self.buried)):
            if node not in held and neighbours[node]:
                part = joined({node})
                held |= part
                yield from self._loose(part)
        floating = [name for name in self.nodes if name not in held]
        if floating:
            limit = "must be joined to a clamped node by members, to one on a foundation, or to soil"
            yield InputError("nodes", ", ".join(floating), limit)

    def _release_problems(self) -> Iterator[InputError]:
        """Releases that let a member, or a node among members in one piece each, move without a force or a mass."""
        if not any(member.releases().any() for member in self.members):
            return
        number = {name: 6 * i + np.arange(6) for i, name in enumerate(self.nodes)}
        size = 6 * len(number)
        # Stiffness and mass: with releases, and the diagonals without.
        left, whole = np.zeros((2, size, size)), np.zeros((2, size))
        for member in self.members:
            ends, section, material = self.ends(member), member.section_at(0.5), member.material
            L = float(np.linalg.norm(ends[1] - ends[0]))
            arms = scipy.linalg.block_diag(lever(member.start_offset), lever(member.end_offset))
            T = beam.to_global(beam.rotation(*ends)) @ arms
            shear = beam.shear_parameters(material.E, material.G, section, L)
            stiffness = beam.stiffness(material.E, material.G, section, L)
            own = np.array([stiffness, beam.mass(material.density, section, L, shear)])
            ground = np.zeros((2, 12, 12))
            if self.soil is not None:
                ground[0] = self.soil.element(ends, shear)
            try:
                C = beam.condensation(stiffness, member.releases(), member.springs)
            except np.linalg.LinAlgError:
                limit = "with end_release leaves the member itself free to move or turn"
                yield InputError(f"members.{member.name}.start_release", member.start_release, limit)
                return
            at = np.concatenate([number[member.start], number[member.end]])
            seen = np.array([beam.condensed_stiffness(stiffness, C, member.springs), C.T @ own[1] @ C])
            left[:, at[:, None], at] += T.T @ (seen + C.T @ ground @ C) @ T
            whole[:, at] += np.diagonal(T.T @ (own + ground) @ T, axis1=1, axis2=2)
        on_nodes = [(0, node, self.foundation_matrix(node)) for node in self.foundation]
        on_nodes += [(1, item.node, item.matrix) for item in self.masses]
        for kind, node, matrix in on_nodes:
            at = number[node]
            left[kind, at[:, None], at] += matrix
            whole[kind, at] += np.diag(matrix)
        free = self.free({name: i for i, name in enumerate(self.nodes)}, left.shape[1])
        names = ", ".join(m.name for m in self.members if m.releases().any())
        for kept, before, word in zip(left, whole, ("free to", "without inertia to"), strict=True):
            if free.size and (loose := _loosest(kept, before, free)) is not None:
                node, direction = list(self.nodes)[loose // 6], DIRECTIONS[loose % 6]
                yield InputError("members", names, f"with their releases leave {node} {word} {direction}")
                return

    def _loose(self, part: set[str]) -> Iterator[InputError]:
        """A part that stands on foundations and in soil alone, and can move as a rigid body."""
        founded = [node for node in self.foundation if node in part]
        held = [(node, np.array(self.nodes[node]), self.foundation_matrix(node)) for node in founded]
        held += [at for member in self.buried if member.start in part for at in self._in_soil(member)]
        places = np.array([place for _, place, _ in held])
        size = np.ptp([self.nodes[node] for node in part], axis=0).max()
        rigid = np.zeros((6, 6))
        for arm, (_, _, stiffness) in zip(places - places.mean(axis=0), held, strict=True):
            move = np.eye(6)
            move[:3, 3:] = np.cross(np.eye(3), arm).T
            move[:, 3:] /= size
            rigid += move.T @ stiffness @ move
        values, vectors = np.linalg.eigh(rigid)
        if not values[0] > HELD * values[-1]:
            direction = DIRECTIONS[int(np.abs(vectors[:, 0]).argmax())]
            limit = f"must hold what stands on it, which is free to {direction}"
            key = "foundation" if held[0][0] in self.foundation else "soil"
            yield InputError(key, ", ".join(dict.fromkeys(name for name, _, _ in held)), limit)

    def _in_soil(self, member: Member) -> Iterator[tuple[str, np.ndarray, np.ndarray]]:
        """Its name, a place (3,) [m] and the soil's stiffness there (6, 6), for each point of a sum over its length."""
        assert self.soil is not None, "asked of members that are in it"
        ends = self.ends(member)
        turn = np.kron(np.eye(2), beam.rotation(*ends))
        for s, weight, (along, across, about) in self.soil.points(ends):
            own = weight * np.linalg.norm(ends[1] - ends[0]) * np.array([along, across, across, about, 0, 0])
            yield member.name, ends[0] + s * (ends[1] - ends[0]), turn.T @ (own[:, None] * turn)


def _loosest(kept: np.ndarray, whole: np.ndarray, free: np.ndarray) -> int | None:
    """The degree of freedom that takes most part in a motion which releases leave without stiffness or mass, if any.

    whole: the diagonal without releases.
    """
    size = 1 / np.sqrt(whole[free])
    scaled = size[:, None] * kept[np.ix_(free, free)] * size
    with contextlib.suppress(np.linalg.LinAlgError):  # at once, where nothing is loose
        scipy.linalg.cholesky(scaled - beam.LOOSE * np.eye(free.size), overwrite_a=True, check_finite=False)
        return None
    values, vectors = np.linalg.eigh(scaled)
    return None if values[0] >= beam.LOOSE else int(free[np.abs(vectors[:, 0]).argmax()])
