"""A scene: everything that one simulation needs, as frozen, validated inputs.

Frame: x along the waves for heading 0, z upwards from still water, rotations right-handed.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import Literal

import numpy as np

from solver.errors import InputError
from solver.hydrodynamics.hull.panel_hull import PanelHull
from solver.hydrodynamics.hull.revolution import Revolution
from solver.sea.realization import CALM, Realization
from solver.structure.frame import Frame

STEP = 0.2  # [s], the default, to which Newton's tolerance refers


@dataclass(frozen=True, slots=True, kw_only=True)
class Water:
    """Still water of constant depth (inf allowed)."""

    depth: float  # [m]
    density: float = 1025.0  # [kg/m3]
    gravity: float = 9.81  # [m/s2]

    def __post_init__(self):
        for key in ("depth", "density", "gravity"):
            if not getattr(self, key) > 0:
                raise InputError(f"water.{key}", getattr(self, key), "must be > 0")


DOFS = ("surge", "sway", "heave", "roll", "pitch", "yaw")
PerAxis = float | tuple[float, ...]


@dataclass(frozen=True, slots=True, kw_only=True)
class Float:
    """A rigid float on a rigid, massless arm, joined to the support, or to another float, at the hinge point.

    The reference point (hinge + arm at rest) lies at still water, on the axis of a hull of revolution; motion and
    hydrodynamic loads refer to it. `motion` lists the axes that the joint leaves free, in order
    from the support: "hinge" (rotation about `axis`) or rigid-body motions at the hinge point,
    such as ("heave",) for a guided float or ("surge", "heave", "pitch") for one free in a plane.
    Damping, stiffness, mechanism inertia and offset are one number for a single axis, else one
    for each. Units are those of the axis: N s/m and N/m, or N m s/rad and N m/rad.
    """

    name: str
    hull: Revolution | PanelHull
    mass: float  # [kg]
    inertia: tuple[float, float, float]  # about the c.o.g., own axes [kg m2]
    cog: tuple[float, float, float] = (0.0, 0.0, 0.0)  # from the reference point [m]
    hinge: tuple[float, float, float]  # at rest [m]
    arm: tuple[float, float, float] = (0.0, 0.0, 0.0)  # from the hinge to the reference point [m]
    axis: tuple[float, float, float] = (0.0, 1.0, 0.0)
    motion: tuple[str, ...] = ("hinge",)
    on: str = ""  # the float that carries the hinge, such as a floating platform; "": the support
    pto_damping: PerAxis = 0.0
    damping: PerAxis = 0.0  # besides the PTO, linear
    quadratic_damping: PerAxis = 0.0
    stiffness: PerAxis = 0.0  # a linear spring about the position at rest
    mechanism_inertia: PerAxis = 0.0  # of what turns or slides with the axis, besides the float
    offset: PerAxis = 0.0  # from equilibrium, where the float is let go at t = 0 [m or rad]

    def __post_init__(self):
        key = f"floats.{self.name}"
        if not self.mass > 0:
            raise InputError(f"{key}.mass", self.mass, "must be > 0 kg")
        if "hinge" in self.motion and not np.linalg.norm(self.axis) > 0:
            raise InputError(f"{key}.axis", self.axis, "must not have zero length")
        if not self.motion or len(set(self.motion)) < len(self.motion) or set(self.motion) - {"hinge", *DOFS}:
            raise InputError(f"{key}.motion", self.motion, f"must list hinge, {', '.join(DOFS)}, each at most once")
        for name in ("pto_damping", "damping", "quadratic_damping", "stiffness", "mechanism_inertia", "offset"):
            values = self.per_axis(name)
            if name != "offset" and not np.all(values >= 0):
                raise InputError(f"{key}.{name}", getattr(self, name), "must be >= 0")

    def per_axis(self, name: str) -> np.ndarray:
        """A quantity of the joint for each axis (n,)."""
        given = np.atleast_1d(np.asarray(getattr(self, name), float))
        if given.size == 1 and not given.any():
            return np.zeros(len(self.motion))
        if given.size != len(self.motion):
            raise InputError(
                f"floats.{self.name}.{name}", getattr(self, name), f"needs one number for each of {self.motion}"
            )
        return given

    @property
    def centre(self) -> np.ndarray:
        """Reference point at rest (3,) [m]."""
        return np.add(self.hinge, self.arm)


@dataclass(frozen=True, slots=True, kw_only=True)
class Platform:
    """A bottom-fixed elastic support: a beam frame, its damping and where floats are hinged."""

    frame: Frame
    legs: tuple[str, ...] = ()  # members whose displacements and stresses are put out
    # Of every mode in water [-]: with the wetted members' added mass, without the floats.
    damping_ratio: float = 0.01
    hinge_nodes: Mapping[str, str] = field(default_factory=dict)  # float -> node
    geometric_stiffness: bool = False
    # "standard": C_M rho V du/dt - (C_M - 1) rho V a; "relative" (Heo et al. 2022, eq. 16, as
    # printed): (C_M - 1) rho V (du/dt - a), which leaves out the undisturbed wave's pressure.
    wave_inertia: Literal["standard", "relative"] = "standard"

    def __hash__(self):
        """Equal platforms have equal text; what no wave changes is kept for the next task with this one."""
        return hash(repr(self))


@dataclass(frozen=True, slots=True, kw_only=True)
class Settings:
    """Record and numerics. The defaults hold the errors that `make bench` prints."""

    duration: float = 3600.0  # analysed [s]
    discard: float = 100.0  # before that [s]
    ramp: float = 50.0  # [s]
    ramp_form: Literal["paper", "cosine"] = "paper"
    time_step: float = STEP  # [s]; samples are half a step apart
    modes: int | Literal["all"] = 6  # lowest modes kept, besides static load shapes
    azimuths: int = 12  # of the wetted-surface quadrature, full circle
    arc_points: int = 6
    line_points: int = 3
    panel_size: float = 0.5  # longest side of a mesh's triangles, of the hull's size and of 1/k of the mean wave
    field_tolerance: float = 1e-4  # of the local wave field, relative to the sum of amplitudes
    memory_tolerance: float = 5e-3  # of the radiation memory's fit
    stations_per_element: int = 2  # drag
    # Pressure above still water. Wheeler's vanishes at the surface and agrees with published
    # body-nonlinear codes in steep waves; Airy's extrapolated is the Buan paper's.
    pressure: Literal["wheeler", "extrapolated"] = "wheeler"
    # Hydrostatics go with it: nonlinear only with "body-nonlinear". "none" leaves diffraction alone.
    froude_krylov: Literal["body-nonlinear", "linear", "none"] = "body-nonlinear"
    diffraction: bool = True
    radiation: bool = True
    # Newton's last update of a position [m or rad] in a step of STEP; in less as their square: forces are as exact.
    newton_tolerance: float = 1e-5
    keep_series: bool = False
    rao: bool = False  # motion per wave amplitude, wave by wave
    # "reference" is the paper's method throughout: the augmented formulation, convolution, panels and all modes.
    # Each can be had alone; convolution and panels take the augmented formulation with them. Slow.
    accuracy: Literal["standard", "reference"] = "standard"
    formulation: Literal["minimal", "augmented"] = "minimal"
    memory: Literal["state-space", "convolution"] = "state-space"
    surface: Literal["quadrature", "panels"] = "quadrature"
    # Relative error of every mean, rms and std; where given, it chooses the knobs above from time_step on.
    tolerance: float | None = None

    def __post_init__(self):
        if self.tolerance is not None and not 1e-6 <= self.tolerance <= 0.1:
            raise InputError("settings.tolerance", self.tolerance, "must be between 1e-6 and 0.1")
        if self.tolerance is not None and self.paths.formulation == "augmented":
            raise InputError("settings.tolerance", self.tolerance, "chooses the knobs of the standard paths only")
        positive = ("duration", "time_step", "newton_tolerance", "memory_tolerance", "field_tolerance", "panel_size")
        for key in positive:
            if not getattr(self, key) > 0:
                raise InputError(f"settings.{key}", getattr(self, key), "must be > 0")
        for key in ("discard", "ramp"):
            if not getattr(self, key) >= 0:
                raise InputError(f"settings.{key}", getattr(self, key), "must be >= 0 s")

    @property
    def paths(self) -> "Settings":
        """With every path that `accuracy` and the others imply."""
        if self.accuracy == "reference":
            whole = {"formulation": "augmented", "memory": "convolution", "surface": "panels", "modes": "all"}
            return self if all(getattr(self, k) == v for k, v in whole.items()) else replace(self, **whole)
        slow = self.memory == "convolution" or self.surface == "panels"
        return replace(self, formulation="augmented") if slow and self.formulation == "minimal" else self


PANELS = 432  # a body, of the finer of the boundary elements' two meshes


def panels_for(tolerance: float | None) -> int:
    """Panels a body: what is left after extrapolation from two meshes falls about as h³, panels^-3/2."""
    finer = 1.0 if tolerance is None else max(1.0, 2e-3 / tolerance)
    return min(round(PANELS * finer ** (2 / 3)), 4 * PANELS)


@dataclass(frozen=True, slots=True, kw_only=True)
class Scene:
    """Water, one realization of the sea, floats, and their support (None: fixed in space)."""

    water: Water
    sea: Realization = CALM
    floats: tuple[Float, ...] = ()
    platform: Platform | None = None
    settings: Settings = Settings()

    def __post_init__(self):
        names = [f.name for f in self.floats]
        if len(set(names)) < len(names):
            raise InputError("floats.name", names, "must differ")
        for f in self.floats:
            lowest = f.centre[2] - f.hull.draft
            if not lowest > -self.water.depth:
                raise InputError(
                    f"floats.{f.name}",
                    f"lowest point at z = {lowest:g} m",
                    f"must stay above the seabed at z = {-self.water.depth:g} m",
                )
            if self.settings.froude_krylov == "body-nonlinear" and not f.hull.closed:
                raise InputError(
                    f"floats.{f.name}.hull",
                    "a mesh that is open above still water",
                    'must be closed for body-nonlinear pressure; or set froude_krylov = "linear"',
                )
            if abs(f.centre[2]) > 1e-9:
                raise InputError(f"floats.{f.name}.arm", f.arm, "hinge + arm must end at still water, z = 0 m")
            if self.platform and f.name not in self.platform.hinge_nodes:
                raise InputError("platform.hinge_nodes", f.name, "no node carries this float's hinge")
            if f.on and self.platform:
                raise InputError(f"floats.{f.name}.on", f.on, "must be empty: the platform carries every float")
            if f.on and f.on not in names[: names.index(f.name)]:
                raise InputError(f"floats.{f.name}.on", f.on, "must name a float that is listed before")
        self._check_time_step()

    def _check_time_step(self):
        if self.settings.tolerance is None and self.settings.time_step > self.longest_step:
            raise InputError(
                "settings.time_step",
                self.settings.time_step,
                f"must be <= {self.longest_step:.3g} s, a sixth of the shortest wave's period",
            )

    @property
    def carriers(self) -> tuple[int, ...]:
        """Number of the float that carries each float's hinge; -1: the support."""
        names = [f.name for f in self.floats]
        return tuple(names.index(f.on) if f.on else -1 for f in self.floats)

    @property
    def longest_step(self) -> float:
        """A sixth of the shortest wave's period [s]."""
        return float(np.pi / 3 / self.sea.omega.max())

    @property
    def planar(self) -> bool:
        """Scene and sea are mirror images of themselves in y = 0, so nothing leaves the plane."""
        return self.sea.heading % np.pi == 0 and all(
            f.hinge[1] == f.arm[1] == f.cog[1] == 0
            and f.hull.symmetry[1]
            and not set(f.motion) & {"sway", "roll", "yaw"}
            and ("hinge" not in f.motion or f.axis[0] == f.axis[2] == 0)
            for f in self.floats
        )
