"""Floats, and the joints that hold them."""

from collections.abc import Iterator, Sequence
from dataclasses import MISSING, dataclass, fields
from typing import Annotated, get_type_hints

import numpy as np

from solver.errors import InputError, refuse
from solver.hydrodynamics.hull.panel_hull import PanelHull
from solver.hydrodynamics.hull.revolution import Revolution
from solver.hydrodynamics.hull.swing import Jointed, Stroke
from solver.mooring import SIX, AxisMooring, Line, Mooring, line_loads, none
from solver.power_takeoff import PtoEfficiency, PtoTable
from solver.quantities import PerAxis, Quantity, out_of_range, take_tuples
from solver.rigid import inertia_tensor, is_of_a_body

DOFS = ("surge", "sway", "heave", "roll", "pitch", "yaw")
LEVEL = (0.0, 1.0, 0.0)  # a hinge's axis, across waves along x
Vector = tuple[float, float, float]


@dataclass(frozen=True, slots=True, kw_only=True)
class EndStops:
    """Springs and dampers at the ends of a joint's stroke; they push and do not pull. A stop without both is none."""

    lower: Annotated[PerAxis, Quantity("rad or m"), "Position of the axis, from rest, below which a stop pushes"]
    upper: Annotated[PerAxis, Quantity("rad or m"), "Position above which a stop pushes"]
    stiffness: Annotated[PerAxis, Quantity("N m/rad or N/m", least=0), "Of the stops"]
    damping: Annotated[PerAxis, Quantity("N m s/rad or N s/m", least=0), "Of the stops, while they push"] = 0.0

    def __post_init__(self) -> None:
        take_tuples(self)


@dataclass(frozen=True, slots=True, kw_only=True)
class Float:
    """A rigid float on a rigid, massless arm, joined to the support, or to another float, at the hinge point.

    The reference point (hinge + arm at rest) lies at still water, on the axis of a hull of revolution; motion and
    hydrodynamic loads refer to it. `motion` lists the axes that the joint leaves free, in order
    from the support: "hinge" (rotation about `axis`) or rigid-body motions at the hinge point,
    such as ("heave",) for a guided float or ("surge", "heave", "pitch") for one free in a plane; none for a body that
    is fixed to what carries it, such as a caisson.
    What belongs to the joint (PER_AXIS) is one number for a single axis, else one for each.
    Units are those of the axis: N s/m and N/m, or N m s/rad and N m/rad.
    """

    name: str
    hull: Revolution | PanelHull
    mass: Annotated[float, Quantity("kg", above=0), "Mass of the float"]
    inertia: Annotated[
        Vector, Quantity("kg m2", above=0), "Moments of inertia about the body's axes through the c.o.g."
    ]
    products_of_inertia: Annotated[
        Vector, Quantity("kg m2"), "Integrals of xy, xz and yz over the mass, about the c.o.g."
    ] = (0.0, 0.0, 0.0)
    cog: Annotated[Vector, Quantity("m"), "Centre of gravity, from the reference point at still water"] = (
        0.0,
        0.0,
        0.0,
    )
    hinge: Annotated[Vector, Quantity("m"), "The joint's point, at rest"]
    arm: Annotated[Vector, Quantity("m"), "From the hinge to the reference point, at rest"] = (0.0, 0.0, 0.0)
    axis: Annotated[Vector, Quantity("-"), "Direction of the hinge's axis"] = LEVEL
    motion: Annotated[tuple[str, ...], "What the joint leaves free, in order from the support"] = ("hinge",)
    on: Annotated[str, 'The float, listed before, that carries the hinge; "" is the platform or the ground'] = ""
    pto_damping: Annotated[PerAxis, Quantity("N m s/rad or N s/m", least=0), "Damping of the power take-off"] = 0.0
    pto_stiffness: Annotated[
        PerAxis,
        Quantity("N m/rad or N/m"),
        "Stiffness of the power take-off; < 0 for reactive control",
    ] = 0.0
    pto_table: Annotated[PtoTable | None, "Load of the power take-off by rate, in place of its damping"] = None
    pto_efficiency: Annotated[PtoEfficiency | None, "Of the power take-off, for electrical_power"] = None
    damping: Annotated[PerAxis, Quantity("N m s/rad or N s/m", least=0), "Linear damping besides the PTO"] = 0.0
    critical_damping: Annotated[
        PerAxis,
        Quantity("-", least=0, most=10),
        "More linear damping: as makes an axis alone, radiation included, damped by this share of critical",
    ] = 0.0
    quadratic_damping: Annotated[
        PerAxis, Quantity("N m s2/rad2 or N s2/m2", least=0), "Damping by the square of the velocity"
    ] = 0.0
    stiffness: Annotated[PerAxis, Quantity("N m/rad or N/m"), "Of a linear spring, at ease at rest"] = 0.0
    preload: Annotated[PerAxis, Quantity("N m or N"), "A constant load along the axis"] = 0.0
    # As hydraulics have at constant pressure.
    coulomb: Annotated[
        PerAxis,
        Quantity("N m or N", least=0),
        "Load of the power take-off whatever the rate, absorbed; it holds what is at rest",
    ] = 0.0
    force_limit: Annotated[
        PerAxis, Quantity("N m or N", above=0, infinite=True), "That the power take-off's load does not exceed"
    ] = np.inf
    declutch_load: Annotated[
        PerAxis,
        Quantity("N m or N", above=0, infinite=True),
        "Of the power take-off, beyond which it lets go of the axis until that turns round",
    ] = np.inf
    latch_load: Annotated[
        PerAxis,
        Quantity("N m or N", least=0),
        "Up to which a latch holds an axis that has come to rest; beyond, it lets go until the next rest",
    ] = 0.0
    one_way: Annotated[
        PerAxis,
        Quantity("-", least=-1, most=1),
        "Share that the power take-off's load lacks in motion in the negative sense; < 0: in the positive",
    ] = 0.0
    end_stops: Annotated[EndStops | None, "Springs and dampers at the ends of the stroke"] = None
    lines: Annotated[tuple[Line, ...], "Catenary lines from the float to the seabed"] = ()
    mooring: Annotated[Mooring | None, "Lines whose load along an axis depends on the other axes, too"] = None
    mechanism_inertia: Annotated[
        PerAxis, Quantity("kg m2 or kg", least=0), "Of what moves with the axis besides the float"
    ] = 0.0
    offset: Annotated[PerAxis, Quantity("rad or m"), "From equilibrium, where the float is let go at t = 0"] = 0.0

    def __post_init__(self) -> None:
        take_tuples(self)
        key = f"floats.{self.name}"
        tables = [(name, getattr(self, name)) for name in ("end_stops", "pto_efficiency")]
        within = [e for name, table in tables if table is not None for e in out_of_range(table, f"{key}.{name}")]
        refuse([*out_of_range(self, key), *within, *self._joint_problems(key), *self._body_problems(key)])

    def _joint_problems(self, key: str) -> Iterator[InputError]:
        if "hinge" in self.motion and not any(self.axis):
            yield InputError(f"{key}.axis", self.axis, "must not be zero")
        if len(set(self.motion)) < len(self.motion) or set(self.motion) - {"hinge", *DOFS}:
            yield InputError(f"{key}.motion", self.motion, f"must name each axis once, of hinge, {', '.join(DOFS)}")
            return  # nobody knows how many axes are meant
        if "hinge" in self.motion and any(self.axis):
            turns = [self.direction(name) for name in self.motion if name not in DOFS[:3]]
            if len(turns) > 1 and np.linalg.matrix_rank(turns) < len(turns):
                yield InputError(
                    f"{key}.motion", self.motion, f"must turn about different axes; the hinge's {self.axis}"
                )
        given = {name: v for name, usual in STARTS.items() if (v := self._joint(name)) is not None and v is not usual}
        unfit = [name for name, v in given.items() if not _fits(v, STARTS[name], len(self.motion))]
        each = f"needs one number for each of {', '.join(self.motion)}"
        for name in unfit:
            limit = each if self.motion else "must be left out: a fixed body has no axis"
            yield InputError(f"{key}.{name}", given[name], limit)
        if not unfit:
            yield from self._law_problems(key)
        n = len(self.motion)
        if self.mooring is not None and (not n or len(self.mooring.stiffness) not in (n, SIX)):
            limit = f"must be {n} x {n}, for {', '.join(self.motion)}, or 6 x 6"
            limit = limit if n else "must be left out: a fixed body has no axis"
            yield InputError(f"{key}.mooring.stiffness", self.mooring.stiffness, limit)
        if self.lines and not n:
            yield InputError(f"{key}.lines", f"{len(self.lines)} lines", "must be left out: a fixed body has no axis")
        for line in self.lines:
            if not line.anchor[2] < (z := self.centre[2] + line.fairlead[2]):
                yield InputError(f"{key}.lines.anchor", line.anchor, f"must be below the fairlead, at z = {z:g} m")

    def _law_problems(self, key: str) -> Iterator[InputError]:
        if self.pto_table is not None:
            yield from self._table_problems(f"{key}.pto_table", self.pto_table.axis)
        limits = [name for name in ("force_limit", "declutch_load") if getattr(self, name) != STARTS[name]]
        for name in limits:
            if np.any(self.per_axis("coulomb") >= self.per_axis(name)):
                yield InputError(f"{key}.coulomb", self.coulomb, f"must be < {name}")
            if np.any((self.per_axis("pto_stiffness") != 0) & np.isfinite(self.per_axis(name))):
                yield InputError(f"{key}.pto_stiffness", self.pto_stiffness, f"must be 0 beside a {name}")
        if "declutch_load" in limits:
            lets_go = np.isfinite(self.per_axis("declutch_load"))
            if lets_go.any() and not np.any(lets_go & (self.per_axis("pto_damping") > 0)):
                yield InputError(f"{key}.declutch_load", self.declutch_load, "needs pto_damping, which reaches it")
            if np.any(lets_go & np.isfinite(self.per_axis("force_limit"))):
                yield InputError(f"{key}.declutch_load", self.declutch_load, "must be left out beside a force_limit")
        if self.end_stops is not None:
            low, high = self.per_axis("end_stops.lower"), self.per_axis("end_stops.upper")
            some = (self.per_axis("end_stops.stiffness") > 0) | (self.per_axis("end_stops.damping") > 0)
            if np.any(some & ~(low < high)):
                yield InputError(f"{key}.end_stops.lower", self.end_stops.lower, "must be < upper")

    def _table_problems(self, key: str, axis: str) -> Iterator[InputError]:
        if axis not in self.motion and (axis or len(self.motion) != 1):
            yield InputError(f"{key}.axis", axis, f"must be one of {', '.join(self.motion) or 'no axis: it is fixed'}")
            return
        i = self.motion.index(axis) if axis else 0
        for name in ("pto_damping", "coulomb", "force_limit", "declutch_load", "latch_load", "one_way"):
            if self.per_axis(name)[i] != STARTS[name]:
                yield InputError(key, "given", f"needs {name} to be left out on that axis: the table has it all")

    def _body_problems(self, key: str) -> Iterator[InputError]:
        if not is_of_a_body(self.inertia_tensor):
            limit = "must meet the triangle inequality: no principal moment above the sum of the others"
            told = "inertia, products_of_inertia" if any(self.products_of_inertia) else "inertia"
            value = (*self.inertia, *self.products_of_inertia) if any(self.products_of_inertia) else self.inertia
            yield InputError(f"{key}.{told}", value, limit)
        upright = self.motion == ("hinge",) and self.axis[0] == self.axis[1] == 0
        if upright and np.linalg.norm(np.cross(self.arm, self.axis)) < 1e-9 * np.linalg.norm(self.axis):
            yield InputError(f"{key}.arm", self.arm, "must not lie along the hinge axis: the float would only spin")

    @property
    def idle(self) -> list[str]:
        """What is given of a power take-off that nothing else makes one."""
        makers = (self.per_axis(name) for name in ("pto_damping", "pto_stiffness", "coulomb", "latch_load"))
        if not self.motion or self.pto_table is not None or any(made.any() for made in makers):
            return []
        given = [name for name in ("force_limit", "one_way") if np.any(self.per_axis(name) != STARTS[name])]
        return given + ["pto_efficiency"] * (self.pto_efficiency is not None)

    @property
    def in_millimetres(self) -> str:
        """What to say of a mesh that is too large to be in m; nothing of other hulls."""
        return " (hull.scale is 0.001 of a mesh in mm)" if isinstance(self.hull, PanelHull) else ""

    @property
    def inertia_tensor(self) -> np.ndarray:
        """About the c.o.g., along the body's axes (3, 3) [kg m2]."""
        return inertia_tensor(self.inertia, self.products_of_inertia)

    def per_axis(self, name: str) -> np.ndarray:
        """A quantity of the joint for each axis (n,); those of end stops by "end_stops.lower" and so on."""
        value = self._joint(name)
        values = np.atleast_1d(np.asarray(STARTS[name] if value is None else value, float))
        return values if values.size == len(self.motion) else np.full(len(self.motion), values[0])

    def _joint(self, name: str) -> PerAxis | None:
        """A quantity of the joint as it is given; None without its table."""
        if "." not in name:
            value: PerAxis = getattr(self, name)
            return value
        table, _, part = name.rpartition(".")
        holder = getattr(self, table)
        return getattr(holder, part) if holder is not None else None

    def direction(self, name: str) -> np.ndarray:
        """Of an axis of the joint, along which it slides or about which it turns (3,)."""
        return np.divide(self.axis, np.linalg.norm(self.axis)) if name == "hinge" else np.eye(3)[DOFS.index(name) % 3]

    @property
    def directions(self) -> np.ndarray:
        """Of all axes of the joint (n, 3)."""
        return np.array([self.direction(name) for name in self.motion]).reshape(-1, 3)

    @property
    def turns(self) -> np.ndarray:
        """Which axes of the joint (n,) turn; the others slide."""
        return np.array([name not in DOFS[:3] for name in self.motion], bool)

    @property
    def jointed(self) -> Jointed:
        """Its hull and the axis of its joint, which has one, or of what carries another."""
        axis = self.motion[0] if len(self.motion) == 1 else "heave"
        direction = tuple(self.direction(axis).tolist())
        return Jointed(self.hull, tuple(self.hinge), tuple(self.arm), direction, axis in DOFS[:3])

    @property
    def stroke(self) -> Stroke:
        """Of a joint of one axis between its end stops [rad or m]; none without."""
        if len(self.motion) != 1 or self.end_stops is None:
            return 0.0, 0.0
        low, high = (float(self.per_axis(f"end_stops.{end}")[0]) for end in ("lower", "upper"))
        return low, high

    @property
    def moored(self) -> AxisMooring:
        """The mooring along the joint's axes; zero without one."""
        if self.mooring is None:
            return none(len(self.motion))
        J, n = self._jacobian(np.add(self.arm, self.mooring.point)), len(self.motion)
        H = np.zeros((n, n, 6))  # as an axis turns about n, what later ones move it by turns, too: n × J
        for i, j in zip(*np.triu_indices(n), strict=True):
            H[i, j] = H[j, i] = *np.cross(J[3:, i], J[:3, j]), *np.cross(J[3:, i], J[3:, j]) / 2
        return self.mooring.on_axes(J, H)

    @property
    def moored_at_a_point(self) -> bool:
        """Whether that is so by matrices 6 x 6 near rest alone, for some axis turns."""
        return self.mooring is not None and len(self.mooring.stiffness) == SIX and bool(self.turns.any())

    def _jacobian(self, lever: Sequence[float] | np.ndarray) -> np.ndarray:
        """Motion (6, n) of a point, from the hinge on (3,), by the joint's axes, at rest."""
        J = np.zeros((6, len(self.motion)))
        for i, name in enumerate(self.motion):
            d, slides = self.direction(name), name in DOFS[:3]
            J[:, i] = (*d, 0, 0, 0) if slides else (*np.cross(d, lever), *d)
        return J

    @property
    def pulls(self) -> np.ndarray:
        """Constant loads along the joint's axes at rest (n,) [N or N m]: of preloads and of all lines."""
        pulls = np.asarray(self.moored.pretension) + self.per_axis("preload")
        return pulls + self._jacobian(self.arm).T @ line_loads(self.lines, self.centre) if self.lines else pulls

    @property
    def pto_points(self) -> list[tuple[np.ndarray, np.ndarray, np.ndarray] | None]:
        """Positions, rates and loads of the power take-off's table, for each axis; None where there is no table."""
        points: list[tuple[np.ndarray, np.ndarray, np.ndarray] | None] = [None] * len(self.motion)
        if self.pto_table is not None:
            points[self.motion.index(self.pto_table.axis or self.motion[0])] = self.pto_table.points
        return points

    @property
    def centre(self) -> np.ndarray:
        """Reference point at rest (3,) [m]."""
        return np.add(self.hinge, self.arm)


def _fits(value: PerAxis, usual: float, axes: int) -> bool:
    """Whether there is a number for each axis; one that says nothing does for all."""
    if isinstance(value, (float, int)):
        return axes == 1 or value == usual
    return np.size(value) == axes or (np.size(value) > 0 and not np.any(np.asarray(value) != usual))


def _of_joints(inputs: type, table: str = "") -> dict[str, float]:
    """Of each quantity that joints have for each axis: its default; nothing where a table of them is left out."""
    return {
        f"{table}{f.name}": 0.0 if f.default is MISSING else f.default
        for f in fields(inputs)
        if get_type_hints(inputs)[f.name] == PerAxis
    }


STARTS = _of_joints(Float) | _of_joints(EndStops, "end_stops.")
PER_AXIS = tuple(STARTS)


def unit_along(axis: str) -> str:
    """Of the position along an axis of a joint."""
    return "m" if axis in DOFS[:3] else "rad"


def load_unit_along(axis: str) -> str:
    """Of a load along an axis of a joint."""
    return "N" if axis in DOFS[:3] else "N m"
