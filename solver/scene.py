"""A scene: everything that one simulation needs, as frozen, validated inputs.

Frame: x along the waves for heading 0, z upwards from still water, rotations right-handed.
"""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import MISSING, dataclass, field, fields, replace
from itertools import combinations
from typing import Annotated, Any, Literal, NamedTuple, get_args, get_type_hints

import numpy as np

from solver.errors import InputError, refuse
from solver.hydrodynamics.hull.clearance import openings, reach, slips, touching
from solver.hydrodynamics.hull.meshfile import KEY
from solver.hydrodynamics.hull.panel_hull import PanelHull
from solver.hydrodynamics.hull.revolution import Revolution
from solver.hydrodynamics.hull.standing import ON_SEABED, stands
from solver.hydrodynamics.hull.swing import Hinged, Stroke, meeting
from solver.mooring import SIX, AxisMooring, Line, Mooring, line_loads, none
from solver.power_takeoff import PtoEfficiency, PtoTable
from solver.quantities import Quantity, out_of_range, require_ranges
from solver.sea.current import Current
from solver.sea.realization import CALM, Realization
from solver.structure.frame import Frame
from solver.structure.load_history import LoadHistory, in_plane
from solver.structure.tubular import may_be_utilised, resistance

STEPS = 9  # in the shortest period that a scene has to follow
OfSteel = Literal[
    "reactions",
    "section_forces",
    "member_stress",
    "fibre_stress",
    "fatigue",
    "leg_tops",
    "utilisation",
    "accelerations",
    "static_part",
]
OfFloats = Literal["pto_force", "pto_stroke", "drift"]
OfAll = Literal["moments"]
Output = Literal[OfSteel, OfFloats, OfAll]
OF_STEEL, OF_FLOATS, OUTPUTS = map(get_args, (OfSteel, OfFloats, Output))
MOST_STEPS = 10_000_000  # of one run: 23 days of sea at the default step
MOST_SECTIONS = 200  # members whose section forces are put out, and nodes whose accelerations are
MOST_CHECKED = 500  # elements whose utilisation is
STILL_WATER = 1e-9  # a reference point this near to z = 0 is at still water [m]


@dataclass(frozen=True, slots=True, kw_only=True)
class Water:
    """Still water of constant depth (inf allowed)."""

    depth: Annotated[float, Quantity("m", above=0, infinite=True), "Depth of the water; inf for deep water"]
    density: Annotated[float, Quantity("kg/m3", above=0), "Density of the water"] = 1025.0
    gravity: Annotated[float, Quantity("m/s2", above=0), "Acceleration of gravity"] = 9.81

    def __post_init__(self) -> None:
        require_ranges(self, "water")


DOFS = ("surge", "sway", "heave", "roll", "pitch", "yaw")
Vector = tuple[float, float, float]
PerAxis = float | tuple[float, ...]  # of a joint: a number for its only axis, or one for each


@dataclass(frozen=True, slots=True, kw_only=True)
class EndStops:
    """Springs and dampers at the ends of a joint's stroke; they push and do not pull. A stop without both is none."""

    lower: Annotated[PerAxis, Quantity("rad or m"), "Position of the axis, from rest, below which a stop pushes"]
    upper: Annotated[PerAxis, Quantity("rad or m"), "Position above which a stop pushes"]
    stiffness: Annotated[PerAxis, Quantity("N m/rad or N/m", least=0), "Of the stops"]
    damping: Annotated[PerAxis, Quantity("N m s/rad or N s/m", least=0), "Of the stops, while they push"] = 0.0


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
    cog: Annotated[Vector, Quantity("m"), "Centre of gravity, from the reference point at still water"] = (
        0.0,
        0.0,
        0.0,
    )
    hinge: Annotated[Vector, Quantity("m"), "The joint's point, at rest"]
    arm: Annotated[Vector, Quantity("m"), "From the hinge to the reference point, at rest"] = (0.0, 0.0, 0.0)
    axis: Annotated[Vector, Quantity("-"), "Direction of the hinge's axis"] = (0.0, 1.0, 0.0)
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
        key = f"floats.{self.name}"
        tables = [(name, getattr(self, name)) for name in ("end_stops", "pto_efficiency")]
        within = [e for name, table in tables if table is not None for e in out_of_range(table, f"{key}.{name}")]
        refuse([*out_of_range(self, key), *within, *self._joint_problems(key), *self._body_problems(key)])

    def _joint_problems(self, key: str) -> Iterator[InputError]:
        if "hinge" in self.motion and not any(self.axis):
            yield InputError(f"{key}.axis", self.axis, "must not be zero")
        if len(set(self.motion)) < len(self.motion) or set(self.motion) - {"hinge", *DOFS}:
            yield InputError(f"{key}.motion", self.motion, f"must name each axis once, of hinge, {', '.join(DOFS)}")
        elif "hinge" in self.motion and any(self.axis):
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
            if not line.anchor[2] < self.centre[2] + line.fairlead[2]:
                yield InputError(f"{key}.lines.anchor", line.anchor, f"must be below the fairlead, {line.fairlead} m")

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
        moments = sorted(self.inertia)
        if moments[2] > (moments[0] + moments[1]) * (1 + 1e-9):
            limit = "must meet the triangle inequality: no moment above the sum of the others"
            yield InputError(f"{key}.inertia", self.inertia, limit)
        upright = self.motion == ("hinge",) and self.axis[0] == self.axis[1] == 0
        if upright and np.linalg.norm(np.cross(self.arm, self.axis)) < 1e-9 * np.linalg.norm(self.axis):
            yield InputError(f"{key}.arm", self.arm, "must not lie along the hinge axis: the float would only spin")

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
    def hinged(self) -> Hinged:
        """Its hull and hinge."""
        return Hinged(self.hull, tuple(self.hinge), tuple(self.arm), tuple(self.direction("hinge").tolist()))

    @property
    def stroke(self) -> Stroke:
        """Of a hinge between its end stops [rad]; none without."""
        if self.motion != ("hinge",) or self.end_stops is None:
            return 0.0, 0.0
        low, high = (float(self.per_axis(f"end_stops.{end}")[0]) for end in ("lower", "upper"))
        return low, high

    @property
    def moored(self) -> AxisMooring:
        """The mooring along the joint's axes; zero without one."""
        if self.mooring is None:
            return none(len(self.motion))
        J, n = self._jacobian, len(self.motion)
        H = np.zeros((n, n, 3))  # as an axis turns about n, what later ones move it by turns, too: n × J
        for i, j in zip(*np.triu_indices(n), strict=True):
            H[i, j] = H[j, i] = np.cross(J[3:, i], J[:3, j])
        return self.mooring.on_axes(J, H)

    @property
    def _jacobian(self) -> np.ndarray:
        """Motion (6, n) of the reference point by the joint's axes, at rest."""
        J = np.zeros((6, len(self.motion)))
        for i, name in enumerate(self.motion):
            d, slides = self.direction(name), name in DOFS[:3]
            J[:, i] = (*d, 0, 0, 0) if slides else (*np.cross(d, self.arm), *d)
        return J

    @property
    def pulls(self) -> np.ndarray:
        """Constant loads along the joint's axes at rest (n,) [N or N m]: of preloads and of all lines."""
        pulls = np.asarray(self.moored.pretension) + self.per_axis("preload")
        return pulls + self._jacobian.T @ line_loads(self.lines, self.centre) if self.lines else pulls

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
    return np.size(value) == axes or not np.any(np.asarray(value) != usual)


def _of_joints(inputs: type, table: str = "") -> dict[str, float]:
    """Of each quantity that joints have for each axis: its default; nothing where a table of them is left out."""
    return {
        f"{table}{f.name}": 0.0 if f.default is MISSING else f.default
        for f in fields(inputs)
        if get_type_hints(inputs)[f.name] == PerAxis
    }


STARTS = _of_joints(Float) | _of_joints(EndStops, "end_stops.")
PER_AXIS = tuple(STARTS)


class StructuralDamping(NamedTuple):
    """Of a platform's modes, in water or dry: one ratio, or Rayleigh's C = αM + βK, M with or without added mass."""

    ratio: float
    alpha: float = 0.0  # [1/s]
    beta: float = 0.0  # [s]
    dry: bool = False

    @property
    def even(self) -> bool:
        """Whether all modes have one ratio."""
        return self.alpha == self.beta == 0.0

    def of(self, omega: np.ndarray, share: np.ndarray) -> np.ndarray:
        """Ratio ζ (nm,) of modes of natural frequency ω (nm,) in water: 2ζω = α + βω² of Rayleigh's.

        share (nm,): of their mass that is not added mass, μ. Given dry, ζ is ζμ^½ in water, for ω_dry² = ω²/μ, and α is
        αμ.
        """
        mass = share if self.dry else np.ones(omega.shape)
        if self.even:
            return self.ratio * np.sqrt(mass)
        return 0.5 * (self.alpha * mass / omega + self.beta * omega)

    def __str__(self) -> str:
        """As records have it."""
        where = "dry" if self.dry else "in water"
        if self.even:
            return f"{self.ratio:g} of critical in each mode {where}"
        return f"Rayleigh's, {self.alpha:g} 1/s of the mass {where}, {self.beta:g} s of the stiffness"


@dataclass(frozen=True, slots=True, kw_only=True)
class Platform:
    """A bottom-fixed elastic support: a beam frame, its damping and where floats are hinged."""

    frame: Frame
    legs: Annotated[tuple[str, ...], "Members whose displacements and stresses are put out"] = ()
    damping_ratio: Annotated[
        float, Quantity("-", least=0, below=1), "Of every mode in water: with the members' added mass, without floats"
    ] = 0.01
    damping_of: Annotated[
        Literal["water", "dry"], "Whether damping is that of the modes in water, or of those without added mass"
    ] = "water"
    rayleigh_mass: Annotated[
        float,
        Quantity("1/s", least=0),
        "Rayleigh's α: damping αM + βK, M with the members' added mass, instead of a ratio",
    ] = 0.0
    rayleigh_stiffness: Annotated[float, Quantity("s", least=0), "Rayleigh's β: damping αM + βK instead of a ratio"] = (
        0.0
    )
    hinge_nodes: Mapping[str, str] = field(default_factory=dict)  # float -> node
    geometric_stiffness: Annotated[bool, "Whether the legs' weight bends them further"] = False
    # "standard": C_M rho V du/dt - (C_M - 1) rho V a; "relative" (Heo et al. 2022, eq. 16, as
    # printed): (C_M - 1) rho V (du/dt - a), which leaves out the undisturbed wave's pressure.
    wave_inertia: Annotated[Literal["standard", "relative"], "Morison inertia: the whole, or the paper's eq. 16"] = (
        "standard"
    )
    wave_stretching: Annotated[
        Literal["none", "wheeler", "extrapolated"],
        "Morison's load in the march: to still water, or to the surface, with water stretched to it or extrapolated",
    ] = "none"

    load_histories: tuple[LoadHistory, ...] = ()

    def __post_init__(self) -> None:
        members = [member.name for member in self.frame.members]
        strange = [(i, leg) for i, leg in enumerate(self.legs) if leg not in members]
        unknown = [InputError(f"platform.legs[{i}]", leg, f"must be one of {', '.join(members)}") for i, leg in strange]
        refuse([*out_of_range(self, "platform"), *unknown, *self._history_problems()])

    def symmetric(self, sea: Water) -> bool:
        """Whether frame and load histories are mirror images of themselves in y = 0."""
        from solver.structure import in_water  # slow to import, for sparse matrices, and the command line rarely asks

        if not in_plane(self.load_histories, self.frame.nodes):
            return False
        return in_water.symmetric(self.frame, sea.density, sea.gravity, softened=self.geometric_stiffness)

    @property
    def damping(self) -> StructuralDamping:
        """Of its modes."""
        given = self.damping_ratio, self.rayleigh_mass, self.rayleigh_stiffness
        return StructuralDamping(*given, dry=self.damping_of == "dry")

    def cut(self, times: int) -> "Platform":
        """With so many times as many elements."""
        members = tuple(replace(m, elements=times * m.elements) for m in self.frame.members)
        return replace(self, frame=replace(self.frame, members=members))

    def undamped(self) -> "Platform":
        """What has the same modes."""
        return replace(self, damping_ratio=0.0, damping_of="water", rayleigh_mass=0.0, rayleigh_stiffness=0.0)

    def _history_problems(self) -> Iterator[InputError]:
        for i, history in enumerate(self.load_histories):
            if history.node not in self.frame.nodes:
                limit = f"must be one of {', '.join(self.frame.nodes)}"
                yield InputError(f"platform.load_histories[{i}].node", history.node, limit)

    def __hash__(self) -> int:
        """By names alone, which is quick; what no wave changes is kept for the next task with an equal platform."""
        return hash((self.legs, *self.frame.nodes, *self.hinge_nodes))


@dataclass(frozen=True, slots=True, kw_only=True)
class Fatigue:
    """How damage is reckoned at the legs' ends: S-N curve, hot spot, and what equivalent ranges refer to."""

    curve: Annotated[
        Literal["B1", "B2", "C", "C1", "C2", "D", "E", "F", "F1", "F3", "G", "W1", "W2", "W3"], "S-N curve"
    ] = "D"
    environment: Annotated[
        Literal["air", "seawater-cp", "free-corrosion"], "Where the hot spot is; cp: with cathodic protection"
    ] = "seawater-cp"
    edition: Annotated[Literal["DNVGL-RP-C203:2016"], "Whose S-N curves"] = "DNVGL-RP-C203:2016"
    scf: Annotated[float, Quantity("-", above=0, most=100), "Hot-spot stress over the section's"] = 1.0
    thickness: Annotated[
        float | None, Quantity("m", above=0), "Of the plate, which counts above 25 mm; left out, the section's wall"
    ] = None
    # Residual stresses of welds keep them in tension: their ranges count whole.
    mean_stress: Annotated[
        Literal["none", "base-material", "stress-relieved"],
        "Whether what of a range is compression counts as 0.6 (base-material) or 0.8 (stress-relieved welds) of itself",
    ] = "none"
    exponent: Annotated[float, Quantity("-", least=1, most=20), "Exponent m of the damage-equivalent range"] = 3.0
    cycles: Annotated[float, Quantity("1/h", above=0), "Cycles an hour that the equivalent range refers to"] = 3600.0

    def __post_init__(self) -> None:
        require_ranges(self, "settings.fatigue")


@dataclass(frozen=True, slots=True, kw_only=True)
class Utilisation:
    """How tubes are utilised, by NORSOK N-004, 6.3."""

    material_factor: Annotated[float, Quantity("-", least=1, most=2), "Material factor γ_M of the resistances"] = 1.15

    def __post_init__(self) -> None:
        require_ranges(self, "settings.utilisation")


@dataclass(frozen=True, slots=True, kw_only=True)
class Settings:
    """Record and numerics. The defaults hold the errors that `make bench` prints."""

    duration: Annotated[float, Quantity("s", above=0), "Time that is analysed"] = 3600.0
    discard: Annotated[float, Quantity("s", least=0), "Time before that, which is left out"] = 100.0
    ramp: Annotated[float, Quantity("s", least=0), "Time in which waves grow from nothing"] = 50.0
    ramp_form: Annotated[Literal["paper", "cosine"], "How they grow: by eq. 21 of Heo, Koo and Kim, or a cosine"] = (
        "paper"
    )
    # Samples are half a step apart.
    time_step: Annotated[
        float | None,
        Quantity("s", above=0),
        "Time step; left out, by the waves and the scene's own periods, and less where a run's start asks for it",
    ] = None
    modes: Annotated[
        int | Literal["all"], Quantity(least=1, most=1000), "Lowest modes of the platform, besides static load shapes"
    ] = 6
    azimuths: Annotated[int, Quantity(least=1, most=1000), "Of the wetted surface's quadrature, full circle"] = 12
    arc_points: Annotated[int, Quantity(least=1, most=1000), "Quadrature points on a meridian's arc"] = 6
    line_points: Annotated[int, Quantity(least=1, most=1000), "Quadrature points on a meridian's straight part"] = 3
    panel_size: Annotated[
        float,
        Quantity(least=0.01, most=10),
        "Longest side of a mesh's triangles, over the hull's size and 1/k of the mean wave",
    ] = 0.5
    field_tolerance: Annotated[
        float, Quantity(least=1e-14, most=1), "Of the wave field around a float, relative to the sum of amplitudes"
    ] = 1e-4
    memory_tolerance: Annotated[
        float | None,
        Quantity(least=1e-8, most=1),
        "Of the radiation memory's fit; left out, 5e-3 or, where that sways the motions by over 0.3 %, by their change",
    ] = None
    stations_per_element: Annotated[
        int, Quantity(least=1, most=1000), "Points of an element at which drag is taken; in long ones of each 1/k"
    ] = 2
    # Wheeler's vanishes at the surface and agrees with published body-nonlinear codes in steep waves; Airy's
    # extrapolated is the Buan paper's.
    pressure: Annotated[Literal["wheeler", "extrapolated"], "Wave pressure above still water"] = "wheeler"
    froude_krylov: Annotated[
        Literal["body-nonlinear", "linear", "none"],
        "Froude-Krylov forces, and hydrostatics with them; none leaves diffraction and linear hydrostatics",
    ] = "body-nonlinear"
    diffraction: Annotated[bool, "Whether floats diffract waves"] = True
    radiation: Annotated[bool, "Whether floats radiate waves"] = True
    interaction: Annotated[bool, "Whether floats feel waves that others diffract and radiate"] = True
    # ∂φ/∂z = (1 + iε) ω²/g φ: the same water rings as without, and loses εω of its energy in a second.
    gap_damping: Annotated[
        float,
        Quantity("-", least=0, most=1),
        "Damping ε of a lid on water in narrow gaps and wells: a pressure ρμφ resists it, μ = εω",
    ] = 0.0
    gap_width: Annotated[
        float, Quantity("m", least=0), "Of those gaps and wells: water at rest where no circle of this diameter fits"
    ] = 0.0
    # Newton's last update of a position [m or rad] in a step by the shortest wave, for hulls of 1 m radius and more;
    # for smaller ones as their radius, in shorter steps as their square: forces are as exact.
    newton_tolerance: Annotated[
        float, Quantity(least=1e-14, most=1), "Newton's last update of a position [m or rad] in a step"
    ] = 1e-5
    # "frequency": statistics of the linear model's stationary response, drag linearised; no series, no envelopes.
    method: Annotated[Literal["time", "frequency"], "March in time, or response of the linear model"] = "time"
    keep_series: bool = False
    rao: Annotated[bool, "Whether motion per wave amplitude is put out, wave by wave"] = False
    spectra: Annotated[
        bool, "Whether each output's response per wave amplitude, coherence with the waves and spectrum are put out"
    ] = False
    outputs: Annotated[
        tuple[Output, ...],
        "What else is put out: of an elastic platform, of power take-offs, mean and slow drift of floats, or of all",
    ] = ()
    fatigue: Annotated[Fatigue, "By which rules damage is reckoned"] = Fatigue()
    utilisation: Annotated[Utilisation, "By which factors tubes are utilised"] = Utilisation()
    # "reference" is the paper's method throughout: the augmented formulation, convolution, panels and all modes.
    # Each can be had alone; convolution and panels take the augmented formulation with them. Slow.
    accuracy: Annotated[Literal["standard", "reference"], "The fast way, or the paper's own, slow, throughout"] = (
        "standard"
    )
    formulation: Annotated[
        Literal["minimal", "augmented"], "Coordinates: of the joints, or 6 a body and multipliers"
    ] = "minimal"
    memory: Annotated[Literal["state-space", "convolution"], "Radiation memory: exponentials, or convolution"] = (
        "state-space"
    )
    surface: Annotated[Literal["quadrature", "panels"], "Pressure on the hull: by Gauss points, or panel by panel"] = (
        "quadrature"
    )
    tolerance: Annotated[
        float | None,
        Quantity(least=1e-6, most=0.1),
        "Relative error asked of every mean, rms and std; it chooses panels and, marching, the knobs from time_step on",
    ] = None

    def __post_init__(self) -> None:
        require_ranges(self, "settings")
        if self.tolerance is not None and self.paths.formulation == "augmented":
            raise InputError("settings.tolerance", self.tolerance, "chooses the knobs of the standard paths only")
        if (self.gap_damping > 0) != (self.gap_width > 0):
            name, other = ("gap_width", "gap_damping") if self.gap_damping > 0 else ("gap_damping", "gap_width")
            raise InputError(f"settings.{name}", 0.0, f"must be > 0 with {other} = {getattr(self, other):g}")
        if self.method == "frequency":
            refuse(self._frequency_problems())

    def _frequency_problems(self) -> Iterator[InputError]:
        """What no linear response to waves can give."""
        needs = 'needs {} with method = "frequency"'
        if self.froude_krylov == "body-nonlinear":
            yield InputError("settings.froude_krylov", self.froude_krylov, needs.format('"linear" or "none"'))
        if self.keep_series:
            yield InputError("settings.keep_series", self.keep_series, needs.format("to be left out"))
        if self.paths.formulation == "augmented":
            yield InputError("settings.formulation", "augmented", needs.format('"minimal", and accuracy "standard"'))
        if "utilisation" in self.outputs:
            yield InputError("settings.outputs", "utilisation", 'needs method = "time": it is not linear')
        if "fatigue" in self.outputs and self.fatigue.mean_stress != "none":
            limit = 'needs method = "time": a spectrum says nothing of each range\'s mean'
            yield InputError("settings.fatigue.mean_stress", self.fatigue.mean_stress, limit)

    @property
    def paths(self) -> "Settings":
        """With every path that `accuracy` and the others imply."""
        if self.accuracy == "reference":
            whole: dict[str, Any] = {
                "formulation": "augmented",
                "memory": "convolution",
                "surface": "panels",
                "modes": "all",
            }
            return self if all(getattr(self, k) == v for k, v in whole.items()) else replace(self, **whole)
        slow = self.memory == "convolution" or self.surface == "panels"
        return replace(self, formulation="augmented") if slow and self.formulation == "minimal" else self


PANELS = 432  # a body, of the finer of the boundary elements' two meshes
MOST_PANELS = 4 * PANELS  # of any tolerance


def panels_for(tolerance: float | None) -> int:
    """Panels a body: what is left after extrapolation from two meshes falls about as h³, panels^-3/2."""
    finer = 1.0 if tolerance is None else max(1.0, 2e-3 / tolerance)
    return min(round(PANELS * finer ** (2 / 3)), MOST_PANELS)


def unlisted(floats: Sequence[Float]) -> Iterator[InputError]:
    """Of floats that are on one that is not listed before them."""
    names = [f.name for f in floats]
    for i, f in enumerate(floats):
        if f.on and f.on not in names[:i]:
            yield InputError(f"floats.{f.name}.on", f.on, "must name a float that is listed before")


def needs_coefficients(settings: Settings, hulls: Sequence[Revolution | PanelHull], depth: float) -> bool:
    """Whether anything depends on coefficients of floats with these hulls; pressure on those that stand is linear."""
    s = settings
    linear = s.froude_krylov == "linear" or (s.froude_krylov != "none" and any(stands(h, depth) for h in hulls))
    return bool(hulls) and (s.radiation or s.diffraction or linear)


@dataclass(frozen=True, slots=True, kw_only=True)
class Scene:
    """Water, one realization of the sea, a current, floats, and their support (None: fixed in space)."""

    water: Water
    sea: Realization = CALM
    current: Current | None = None  # which the members' drag feels alone
    floats: tuple[Float, ...] = ()
    platform: Platform | None = None
    settings: Settings = Settings()

    def __post_init__(self) -> None:
        refuse(self._problems())

    def _problems(self) -> Iterator[InputError]:
        yield from self._carrier_problems()
        yield from self._fixed_problems()
        for f in self.floats:
            yield from out_of_place(f, self.water)
            if self.settings.froude_krylov == "body-nonlinear" and not f.hull.closed:
                yield InputError(
                    f"floats.{f.name}.hull",
                    "an open mesh",
                    'must be closed for body-nonlinear pressure; or set froude_krylov = "linear"',
                )
            for line in f.lines:
                if line.anchor[2] < -self.water.depth * (1 + ON_SEABED):
                    limit = f"must not lie below the seabed, z = {-self.water.depth:g} m"
                    yield InputError(f"floats.{f.name}.lines.anchor", line.anchor, limit)
        yield from self._open_hulls()
        for a, b in (pair for group in self.sharing for pair in combinations(group, 2)):
            if touching(a.hull, a.centre, b.hull, b.centre):
                key, gap = f"distance of floats.{a.name} and floats.{b.name}", np.linalg.norm(a.centre - b.centre)
                limit = f"must be > {reach(a.hull) + reach(b.hull):g} m, or the floats touch"
                yield InputError(key, f"{gap:g} m", limit)
        for f in (f for f in self.floats if any(f.stroke)):
            for first, second, angles in self.meetings({f.name: f.stroke}):
                limit = f"must keep floats.{first} and floats.{second} apart, which meet at {angles} rad"
                yield InputError(f"floats.{f.name}.end_stops", "{:g} to {:g} rad".format(*f.stroke), limit)
        yield from self._seabed_problems()
        yield from self._output_problems()
        yield from self._drift_problems()
        yield from self._law_problems()
        yield from self._load_problems()
        settings, longest = self.settings, self.longest_step
        marching = settings.method == "time" and settings.tolerance is None and self.sea.amplitude.any()
        if marching and (step := settings.time_step) is not None and step > longest:
            limit = f"must be <= {longest:.3g} s, a sixth of the shortest wave's period, {6 * longest:.3g} s"
            yield InputError("settings.time_step", step, limit)

    def _seabed_problems(self) -> Iterator[InputError]:
        if self.platform is None:
            return
        frame = self.platform.frame
        if frame.soil is not None:
            if frame.seabed != -self.water.depth:
                limit = f"must be that of the water, {-self.water.depth:g} m"
                yield InputError("platform.soil.seabed", frame.seabed, limit)
            return
        for key, place in frame.places():
            if place[2] < -self.water.depth - STILL_WATER:
                limit = f"must not lie below the seabed, z = {-self.water.depth:g} m, where there is no soil"
                yield InputError(f"platform.{key}", place, limit)

    def _open_hulls(self) -> Iterator[InputError]:
        for group in self.sharing:
            hulls = [f.hull for f in group]
            if not any(isinstance(hull, PanelHull) for hull in hulls):
                continue
            edges = openings(hulls, [f.centre for f in group])
            for f in group if len(edges) and not slips(hulls, edges) else ():
                if isinstance(f.hull, PanelHull) and len(f.hull.holes):
                    where = ", ".join(f"{x:.4g}" for x in edges[0].mean(axis=0) - f.centre)
                    limit = f"must be closed below still water: {len(edges)} open edges, the first near ({where}) m"
                    adjoining = "; only where floats adjoin, and interact, may faces be missing"
                    yield InputError(f"floats.{f.name}.{KEY}", f.hull.name, limit + adjoining)

    def _fixed_problems(self) -> Iterator[InputError]:
        if self.settings.paths.formulation == "augmented":
            for f in self.floats:
                if not f.motion:
                    limit = 'a fixed body needs formulation = "minimal", and accuracy = "standard"'
                    yield InputError(f"floats.{f.name}.motion", "[]", limit)
                if f.lines:
                    limit = 'catenaries need formulation = "minimal", and accuracy = "standard"'
                    yield InputError(f"floats.{f.name}.lines", f"{len(f.lines)} lines", limit)
        moving = {""} if self.platform else set()
        for f, standing in zip(self.floats, self.standing, strict=True):
            if f.motion or f.on in moving:
                moving.add(f.name)
            if standing and f.on in moving:
                limit = f"stands on the seabed, and must not be carried by {f.on or 'the platform'}, which moves"
                yield InputError(f"floats.{f.name}.hull", f"draft {f.hull.draft:g} m", limit)

    def _output_problems(self) -> Iterator[InputError]:
        outputs = self.settings.outputs
        if strange := sorted(set(outputs) - set(OUTPUTS)):
            yield InputError("settings.outputs", strange[0], f"must be of {', '.join(OUTPUTS)}")
        if self.platform is None:
            return
        at_feet = [name for name in ("fibre_stress", "fatigue") if name in outputs]
        if at_feet and not self.platform.legs:
            yield InputError("settings.outputs", at_feet[0], "is of the feet of legs: platform.legs must name some")
        if "leg_tops" in outputs and not at_feet:
            yield InputError("settings.outputs", "leg_tops", "is of fibre_stress or fatigue: ask for one of them, too")
        if "utilisation" in outputs:
            yield from self._utilisation_problems(self.platform.frame)
        members = len(self.platform.frame.members)
        for name in {"section_forces", "member_stress"} & set(outputs) if members > MOST_SECTIONS else ():
            limit = f"must be left out with more than {MOST_SECTIONS} members; there are {members}"
            yield InputError("settings.outputs", name, limit)
        if "accelerations" in outputs and (nodes := len(self.platform.frame.nodes)) > MOST_SECTIONS:
            limit = f"must be left out with more than {MOST_SECTIONS} nodes; there are {nodes}"
            yield InputError("settings.outputs", "accelerations", limit)
        if "static_part" in outputs and not (
            self.platform.legs or {"reactions", "section_forces", "member_stress"} & set(outputs)
        ):
            yield InputError("settings.outputs", "static_part", "is of legs, reactions or section_forces: name some")

    def _utilisation_problems(self, frame: Frame) -> Iterator[InputError]:
        tubes = list(filter(may_be_utilised, frame.members))
        if not tubes:
            limit = "is of tubes whose material has a yield_strength: there is none"
            yield InputError("settings.outputs", "utilisation", limit)
        for member in tubes:
            if member.end_section is not None:
                limit = "must be left out for utilisation: 6.5 of N-004, of cones, is not here"
                yield InputError(f"platform.members.{member.name}.end_section", member.end_section.shape, limit)
            if member.flooded is False and frame.ends(member)[:, 2].min() < 0:
                limit = "must be left out below still water for utilisation: 6.3.9 of N-004, of pressure, is not here"
                yield InputError(f"platform.members.{member.name}.flooded", False, limit)
            try:
                resistance(member, frame.buckling_length(member), self.settings.utilisation.material_factor)
            except InputError as error:
                yield error
        if (count := sum(m.elements for m in tubes)) > MOST_CHECKED:
            limit = f"must be left out with more than {MOST_CHECKED} elements of tubes; there are {count}"
            yield InputError("settings.outputs", "utilisation", limit)

    def _drift_problems(self) -> Iterator[InputError]:
        """What the waves far off do not tell of, or tell wrongly."""
        s, key = self.settings, "settings.outputs"
        if "drift" not in s.outputs:
            return
        if s.method != "frequency":
            yield InputError(key, "drift", 'needs method = "frequency"')
        whole = s.diffraction and s.radiation and s.interaction and s.froude_krylov != "none"
        if not (self.floats and whole):
            limit = "is of floats that feel whole waves: diffraction, radiation and interaction, linear Froude-Krylov"
            yield InputError(key, "drift", limit)

    def _law_problems(self) -> Iterator[InputError]:
        """Joint laws that the method does not have."""
        s, jumping = self.settings, ("coulomb", "one_way", "latch_load", "declutch_load")
        for f in self.floats if s.method == "frequency" else ():
            if f.pto_table is not None and not f.pto_table.alike:
                limit = 'needs method = "time": it goes by position, or is not alike in both senses'
                yield InputError(f"floats.{f.name}.pto_table", "given", limit)
        for f in self.floats:
            for name in (*jumping, "force_limit", "end_stops"):
                value, usual = getattr(f, name), STARTS.get(name)  # None of end stops
                if value is usual or (usual is not None and not np.any(np.not_equal(value, usual))):
                    continue
                value = "given" if name == "end_stops" else value
                if s.method == "frequency" and name in ("end_stops", "one_way", "latch_load", "declutch_load"):
                    yield InputError(f"floats.{f.name}.{name}", value, 'needs method = "time": it is not linear')
                elif s.paths.formulation == "augmented" and name in jumping:
                    yield InputError(f"floats.{f.name}.{name}", value, 'needs formulation = "minimal": it jumps')

    def _load_problems(self) -> Iterator[InputError]:
        """Currents and loads that change with time, where nothing or no method takes them."""
        s, histories = self.settings, self.platform.load_histories if self.platform else ()
        augmented = 'needs formulation = "minimal", and accuracy = "standard"'
        if self.current:
            if self.platform is None:
                yield InputError("current", "given", "acts on the members of an elastic platform: needs one")
            if self.current.exponent and np.isinf(self.water.depth):
                yield InputError("current.exponent", self.current.exponent, "needs water of finite depth, or a profile")
            if s.paths.formulation == "augmented":
                yield InputError("current", "given", augmented)
        if self.platform and self.platform.wave_stretching != "none" and s.paths.formulation == "augmented":
            yield InputError("platform.wave_stretching", self.platform.wave_stretching, augmented)
        for history in histories:
            key, end = f"platform.load_histories.{history.node}", s.discard + s.duration
            if s.method == "frequency":
                yield InputError(key, "given", 'needs method = "time": it is no response to waves')
            elif s.paths.formulation == "augmented":
                yield InputError(key, "given", augmented)
            elif history.time[0] > 0 or history.time[-1] < end * (1 - 1e-9):
                span = f"{history.time[0]:g} to {history.time[-1]:g} s"
                yield InputError(f"{key}.time", span, f"must last from 0 to {end:g} s, the end of the run")

    def _carrier_problems(self) -> Iterator[InputError]:
        names = [f.name for f in self.floats]
        if self.platform is None:
            yield from unlisted(self.floats)
        for i, f in enumerate(self.floats):
            if names.index(f.name) < i:
                yield InputError("floats.name", f.name, f"given {names.count(f.name)} times, must be unique")
            if self.platform and f.name not in self.platform.hinge_nodes:
                yield InputError("platform.hinge_nodes", f.name, "no node carries this float's hinge")
            if f.on and self.platform:
                yield InputError(f"floats.{f.name}.on", f.on, "must be empty: the platform carries every float")

    @property
    def sharing(self) -> tuple[tuple[Float, ...], ...]:
        """The floats by what water they share: all of them the same, or without interaction each its own."""
        return (self.floats,) if self.settings.interaction else tuple((f,) for f in self.floats)

    def meetings(self, strokes: Mapping[str, Stroke]) -> Iterator[tuple[str, str, str]]:
        """Names of floats whose hulls meet as some turn on their hinges within `strokes` [rad], and at which angles.

        Of those on one support, or of which one carries the other: of others the hinges do not tell how near they get.
        """
        for a, b in (pair for group in self.sharing for pair in combinations(group, 2)):
            # What carries the other takes it along.
            first = strokes.get(a.name, (0.0, 0.0)) if b.on != a.name else (0.0, 0.0)
            second = strokes.get(b.name, (0.0, 0.0)) if a.on != b.name else (0.0, 0.0)
            if any((*first, *second)) and (b.on in (a.on, a.name) or a.on == b.name):
                at = meeting(a.hinged, b.hinged, (first, second))
                if at is not None:
                    yield a.name, b.name, "{:+.3g} and {:+.3g}".format(*at)

    @property
    def carriers(self) -> tuple[int, ...]:
        """Number of the float that carries each float's hinge; -1: the support."""
        names = [f.name for f in self.floats]
        return tuple(names.index(f.on) if f.on else -1 for f in self.floats)

    @property
    def standing(self) -> tuple[bool, ...]:
        """Which floats stand on the seabed."""
        return tuple(stands(f.hull, self.water.depth) for f in self.floats)

    @property
    def nonlinear(self) -> tuple[bool, ...]:
        """On which floats pressure is integrated up to the waves' surface; on those that stand it is linear."""
        asked = self.settings.froude_krylov == "body-nonlinear"
        return tuple(asked and not standing for standing in self.standing)

    @property
    def longest_step(self) -> float:
        """A sixth of the shortest wave's period [s]."""
        return float(2 * np.pi / self.sea.omega.max() / 6)

    @property
    def usual_step(self) -> float:
        """By the shortest wave [s]: STEPS in its period, to two digits downwards."""
        return two_digits(6 * self.longest_step / STEPS)

    @property
    def planar(self) -> bool:
        """Scene and sea are mirror images of themselves in y = 0, so nothing leaves the plane."""
        flat = is_planar(self.floats, self.sea.heading, self.current)
        return flat and (self.platform is None or self.platform.symmetric(self.water))


def two_digits(step: float) -> float:
    """The largest number of two digits that is not above a step."""
    digit = 10.0 ** (np.floor(np.log10(step)) - 1)
    return float(f"{np.floor(step / digit * (1 + 1e-9)) * digit:.2g}")


def is_planar(floats: Iterable[Float], heading: float, current: Current | None = None) -> bool:
    """Whether floats, waves of that heading [rad] and current are mirror images of themselves in y = 0."""
    if current is not None and current.direction % np.pi != 0:
        return False
    return heading % np.pi == 0 and all(
        f.hinge[1] == f.arm[1] == f.cog[1] == 0
        and f.hull.symmetry[1]
        and not set(f.motion) & {"sway", "roll", "yaw"}
        and ("hinge" not in f.motion or f.axis[0] == f.axis[2] == 0)
        for f in floats
    )


def out_of_place(item: Float, water: Water) -> Iterator[InputError]:
    """A float that at rest reaches the seabed and does not stand on it, or whose reference point is not at z = 0."""
    key, z = f"floats.{item.name}.arm", item.centre[2]
    if not (z - item.hull.draft > -water.depth or (stands(item.hull, water.depth) and not item.motion)):
        lowest = f"lowest point at z = {z - item.hull.draft:g} m, depth {water.depth:g} m"
        limit = f"must stay above the seabed, or with motion = [] stand on it with a flat foot: {lowest}"
        yield InputError(key, item.arm, limit)
    elif abs(z) > STILL_WATER:
        limit = f"must bring the reference point to still water, z = 0; hinge + arm gives z = {z:g} m"
        yield InputError(key, item.arm, limit)


def require_waves(scene: Scene) -> None:
    """Refuse the frequency domain in a still sea."""
    if scene.settings.method == "frequency" and not scene.sea.amplitude.any():
        raise InputError("settings.method", "frequency", "needs waves: a decay is a matter of the time domain")
