"""What is recorded, and by which numerics."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Annotated, Any, Literal, get_args

from solver.errors import InputError, refuse
from solver.hydrodynamics.hull import edges
from solver.hydrodynamics.hull.mesh import PANELS
from solver.hydrodynamics.hull.panel_hull import PanelHull
from solver.hydrodynamics.hull.revolution import Revolution
from solver.hydrodynamics.hull.standing import stands
from solver.quantities import Quantity, require_ranges, take_tuples

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
# The paths that are not slow.
STANDARD = {"accuracy": "standard", "formulation": "minimal", "memory": "state-space", "surface": "quadrature"}


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
    azimuths: Annotated[
        int,
        Quantity(least=1, most=1000),
        "Of the wetted surface's quadrature, full circle; more of hulls with a radius above two 1/k of the mean wave",
    ] = 12
    arc_points: Annotated[
        int,
        Quantity(least=1, most=1000),
        "Quadrature points on a meridian's arc, or on each part of one that is longer than four 1/k of the mean wave",
    ] = 6
    line_points: Annotated[
        int,
        Quantity(least=1, most=1000),
        "Quadrature points on a meridian's straight part, or on each part of one that is longer than two of these",
    ] = 3
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
        Quantity(least=1e-8, below=1),
        "Of the radiation memory's fit; left out, 5e-3 or, where that sways the motions by over 0.3 %, by their change",
    ] = None
    stations_per_element: Annotated[
        int,
        Quantity(least=1, most=1000),
        "Points of an element at which drag is taken, more in a sheared current; in long ones of each 1/k",
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
    hydrodynamic_axes: Annotated[
        Literal["space", "body"],
        "Along whose axes diffraction, radiation and linear Froude-Krylov forces act as a float turns",
    ] = "space"
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
        "Error asked of every mean, relative to the rms, and of every rms and std; it chooses panels and, marching, the"
        " knobs from time_step on",
    ] = None

    def __post_init__(self) -> None:
        take_tuples(self)
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
        for name, usual in STANDARD.items():
            if (written := getattr(self, name)) != usual:
                yield InputError(f"settings.{name}", written, needs.format(f'"{usual}"'))
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

    @property
    def minimal(self) -> str:
        """What the minimal formulation takes, of that which is set otherwise; empty where it is in use."""
        return ", ".join(f'{name} = "{usual}"' for name, usual in STANDARD.items() if getattr(self, name) != usual)


MOST_PANELS = 4 * PANELS  # of any tolerance
LEFT, LEFT_AT_EDGES = 2e-3, 1e-2  # of the motions, by PANELS: smooth hulls, and boxes 0.4 to 1 m deep, 4e-3 to 3e-2


def panels_for(tolerance: float | None, hulls: Sequence[Revolution | PanelHull] = ()) -> int:
    """Panels a body: what extrapolation from two meshes leaves falls about as h³, at sharp edges of meshes as h^p.

    Panels go as h^-2; p is that of `edges.order`, 1.1 of boxes.
    """
    if tolerance is None:
        return PANELS
    sharpest = max((hull.sharpest for hull in hulls if isinstance(hull, PanelHull)), default=0.0)
    left, order = (LEFT_AT_EDGES, edges.order(sharpest)) if sharpest > edges.SHARP else (LEFT, 3.0)
    return min(round(PANELS * max(1.0, left / tolerance) ** (2 / order)), MOST_PANELS)


def needs_coefficients(settings: Settings, hulls: Sequence[Revolution | PanelHull], depth: float) -> bool:
    """Whether anything depends on coefficients of floats with these hulls; pressure on those that stand is linear."""
    s = settings
    linear = s.froude_krylov != "body-nonlinear" or any(stands(h, depth) for h in hulls)
    return bool(hulls) and (s.radiation or s.diffraction or linear)
