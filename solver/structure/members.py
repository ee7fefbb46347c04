"""What a frame is made of: frozen inputs, and what is refused among them."""

from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Annotated, Literal, get_args

import numpy as np

from solver.errors import InputError, refuse
from solver.quantities import Quantity, out_of_range, require_ranges, take_tuples
from solver.rigid import inertia_tensor, is_of_a_body, lever
from solver.structure.sections import Section, between

ROUNDING = 1e-9  # of a matrix's size, by which it may fall short of being symmetric and positive
Force = Literal["N", "Vy", "Vz", "T", "My", "Mz"]  # on a section, along and about the local axes
FORCES: tuple[Force, ...] = get_args(Force)
Vector = tuple[float, float, float]
Springs = tuple[float, float, float, float, float, float]  # in the order of FORCES
NONE: Springs = (0.0, 0.0, 0.0, 0.0, 0.0, 0.0)


@dataclass(frozen=True, slots=True, kw_only=True)
class Material:
    """A linear elastic material."""

    E: Annotated[float, Quantity("Pa", above=0), "Young's modulus"]
    G: Annotated[float, Quantity("Pa", above=0), "Shear modulus"]
    density: Annotated[float, Quantity("kg/m3", above=0), "Density of the material"]
    yield_strength: Annotated[float | None, Quantity("Pa", above=0), "Yield strength, by which tubes are utilised"] = (
        None
    )

    def __post_init__(self) -> None:
        require_ranges(self, "material")

    @property
    def poisson(self) -> float:
        """Poisson's ratio ν = E/2G - 1 [-]."""
        return self.E / (2 * self.G) - 1


@dataclass(frozen=True, slots=True, kw_only=True)
class Member:
    """A straight beam from one named node to another, of equal elements; prismatic ones, also where it tapers.

    Wave loads act on a member only if it has water coefficients: C_D > 0 or C_M > 1.
    """

    name: str
    start: str
    end: str
    elements: int
    section: Section
    end_section: Section | None = None
    material: Material
    drag_coefficient: Annotated[float, Quantity("-", least=0), "Morison's C_D"] = 0.0
    inertia_coefficient: Annotated[
        float, Quantity("-", least=1), "Morison's C_M = 1 + C_a, for waves longer than five diameters"
    ] = 1.0
    # True: water inside below still water, which moves with the member across its axis. False: sealed, with the
    # buoyancy of its outer volume. None: neither, as Heo et al. (2022) have it.
    flooded: Annotated[bool | None, "Whether a tube is full of water or sealed; left out, neither"] = None
    # A pin: ("My", "Mz"). The node that the end is at moves on with the other members.
    start_release: Annotated[tuple[Force, ...], "Forces, along its own axes, that its start does not pass on"] = ()
    end_release: Annotated[tuple[Force, ...], "Forces, along its own axes, that its end does not pass on"] = ()
    start_spring: Annotated[
        Springs,
        Quantity("N/m, N m", least=0),
        "Springs that pass on what is released there all the same: N, Vy, Vz, T, My, Mz",
    ] = NONE
    end_spring: Annotated[Springs, Quantity("N/m, N m", least=0), "The same at its end; 0 of what is not released"] = (
        NONE
    )
    buckling_length: Annotated[
        float | None, Quantity("m", above=0), "Effective length kl for utilisation; left out, the member's own"
    ] = None
    moment_factor: Annotated[
        float, Quantity("-", above=0, most=1), "C_m for utilisation, N-004's Table 6-2; 1 is on the safe side"
    ] = 1.0
    distributed_load: Annotated[Vector, Quantity("N/m"), "Constant load per length, wind, along the global axes"] = (
        0.0, 0.0, 0.0,
    )  # fmt: skip
    start_offset: Annotated[Vector, Quantity("m"), "From its first node to its start, rigid, along the global axes"] = (
        0.0, 0.0, 0.0,
    )  # fmt: skip
    end_offset: Annotated[Vector, Quantity("m"), "From its last node to its end, rigid, along the global axes"] = (
        0.0, 0.0, 0.0,
    )  # fmt: skip

    def __post_init__(self) -> None:
        take_tuples(self)
        refuse(self._problems(f"members.{self.name}"))

    def _problems(self, key: str) -> Iterator[InputError]:
        yield from out_of_range(self, key)
        if self.elements < 1 or int(self.elements) != self.elements:
            yield InputError(f"{key}.elements", self.elements, "must be a whole number >= 1")
        if self.start == self.end:
            yield InputError(f"{key}.end", self.end, "must differ from start: zero length")
        if self.end_section is not None:
            yield from self._taper_problems(f"{key}.end_section", self.end_section)
        if self.in_water and self.section.diameter == 0:
            yield InputError(f"{key}.section.diameter", 0.0, "must be > 0 m for a member with water coefficients")
        if self.flooded is not None and self.section.diameter == 0:
            yield InputError(f"{key}.flooded", self.flooded, "is of tubes: leave it out")
        elif self.flooded is not None and self.section.area > (circle := np.pi / 4 * self.section.diameter**2):
            limit = f"must be <= {circle:.4g} m2, the circle of its diameter, of a member that is flooded or sealed"
            yield InputError(f"{key}.section.area", self.section.area, limit)
        for end in ("start_release", "end_release"):
            for name, count in Counter(getattr(self, end)).items():
                if count > 1:
                    yield InputError(f"{key}.{end}", name, f"given {count} times, must be unique")
        for end in ("start", "end"):
            springs, released = getattr(self, f"{end}_spring"), getattr(self, f"{end}_release")
            if idle := [name for name, k in zip(FORCES, springs, strict=True) if k and name not in released]:
                limit = f"must be 0 for {', '.join(idle)}, or {end}_release must name it"
                yield InputError(f"{key}.{end}_spring", springs, limit)

    def _taper_problems(self, key: str, last: Section) -> Iterator[InputError]:
        shape = self.section.shape
        if not shape:
            yield InputError(
                key, last.shape or "general", "a general section does not taper: give its parts as members"
            )
        elif last.shape != shape:
            yield InputError(key, last.shape or "general", f"must be of shape {shape}, as the section at its start")
        elif (last.shear_factor is None) != (self.section.shear_factor is None):
            yield InputError(key, last.shear_factor, "must have a shear_factor if the section at its start has one")

    def section_at(self, share: float) -> Section:
        """At a share of the way from its start to its end."""
        return self.section if self.end_section is None else between(self.section, self.end_section, share)

    @property
    def sections(self) -> list[Section]:
        """Of its elements: of a tapered member each has that of its middle."""
        return [self.section_at((i + 0.5) / self.elements) for i in range(self.elements)]

    def releases(self, *, start: bool = True, end: bool = True) -> np.ndarray:
        """Which ends' displacements (12,) are released in an element that has the member's start, its end, or both."""
        return np.array(
            [start and name in self.start_release for name in FORCES]
            + [end and name in self.end_release for name in FORCES]
        )

    @property
    def springs(self) -> np.ndarray:
        """(12,) [N/m, N m] that tie its released ends to their nodes."""
        return np.concatenate([self.start_spring, self.end_spring])

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
        take_tuples(self)
        key = f"masses.{self.node}"
        require_ranges(self, key)
        if not is_of_a_body(self.tensor):
            limit = "no body has such moments: each principal one must be <= the sum of the other two"
            raise InputError(f"{key}.inertia", self.inertia, limit)

    @property
    def tensor(self) -> np.ndarray:
        """Inertia about the c.o.g. (3, 3) [kg m2]."""
        return inertia_tensor(self.inertia, self.products_of_inertia)

    @property
    def matrix(self) -> np.ndarray:
        """Mass (6, 6) as the node has it [kg, kg m, kg m2]: the c.o.g. moves by u + θ × r."""
        rigid = lever(self.cog)[:3]
        matrix = self.mass * rigid.T @ rigid
        matrix[3:, 3:] += self.tensor
        return matrix


@dataclass(frozen=True, slots=True, kw_only=True)
class PointLoad:
    """A constant force on a node."""

    node: str
    force: Annotated[Vector, Quantity("N"), "Constant force, along the global axes"]

    def __post_init__(self) -> None:
        take_tuples(self)
        if np.shape(self.force) != (3,) or not np.all(np.isfinite(self.force)):
            raise InputError(f"loads.{self.node}", self.force, "must be three finite forces [N]")


@dataclass(frozen=True, slots=True, kw_only=True)
class MarineGrowth:
    """What grows on members that have a diameter, at one depth: a line of a table, as NORSOK N-003 gives it."""

    depth: Annotated[float, Quantity("m", least=0), "Below still water"]
    thickness: Annotated[float, Quantity("m", least=0), "Of the layer all round a member"]
    density: Annotated[float, Quantity("kg/m3", above=0), "Of the layer, with the water in it"]
