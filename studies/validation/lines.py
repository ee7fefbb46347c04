"""The frequency domain beside the march: small linear waves, Buan's years, and linear beside body-nonlinear."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from solver.coupled.boundary import coefficients
from solver.errors import SimulationFailed
from solver.frequency.case import case_of
from solver.frequency.response import respond
from solver.frequency.rotation import mean_shift
from solver.hydrodynamics.bem import bem
from solver.hydrodynamics.bem.coefficients import Hydrodynamics
from solver.record.channels import Record
from solver.run import simulate
from solver.scene import Scene
from solver.sea.realization import components, realize
from solver.sea.spectrum import PiersonMoskowitz
from studies.validation import drawing
from studies.validation.cases import buan, scene
from studies.validation.checks import Check
from studies.validation.drawing import BLUE, GREEN, GREY, ORANGE, RED
from tests.awkward import rotors

SMALL = 1e-4  # sum of the waves' amplitudes [m]: an arm's rotation is exact, and linear to as much
LINES, BETWEEN = 24, 0.02  # waves at multiples of so many rad/s: the record comes back after 314 s
DUCKS = (0.3, 10.0, 70)  # least and largest frequency of the ducks' coefficients [rad/s], and how many
LOWER = 20.0  # waves lower by that, and drag coefficients higher, leave drag as it is and an arm's rotation linear
SMALL_MESH = 108  # panels of each of them
YEARS = ("2017", "2018", "2019", "2020", "2021")
HEIGHTS = (0.5, 1.0, 1.5, 2.0, 2.5, 3.0)  # Hs [m], all of the same steepness
OUTPUTS = ("rotation", "motion", "hinge_force", "top_displacement", "bottom_stress")
CASE = "frequency domain"
SWAY = (
    "What is not linear drives the sway at its resonance below the waves: body-nonlinear floats most, then drag, which"
    " the frequency domain has, then the arms' exact rotation, which it does not have."
)
ROTATION = (
    "An arm's rotation is exact in the march, which takes from the rear float's power as the waves' height squared."
)
TURNS = (
    "The mean angle of an arm that turns gives power, what else is of third order takes more: the linear model has"
    " neither."
)
CALM, LONG = 2500.0, 4 * 3600.0  # after which the sway has forgotten the start, and a record of it [s]


def both(item: Scene, h: Hydrodynamics | None, **changes) -> tuple[Record, Record]:
    """Records of the march and of the frequency domain, both linear."""
    linear = replace(item, settings=replace(item.settings, froude_krylov="linear", memory_tolerance=1e-3, **changes))
    lines = replace(linear, settings=replace(linear.settings, method="frequency"))
    return simulate(linear, h), simulate(lines, h)


def std(record: Record, name: str) -> np.ndarray:
    """Of all channels of an output, (n,)."""
    return record.variables[name][1].reshape(-1, 5)[:, 4]


def power(record: Record) -> float:
    """Mean of all floats [W]."""
    return float(record.variables["absorbed_power"][1][:, 2].sum())


def frequency_domain() -> list[Check]:
    """Every output of five scenes in small waves; Buan's years; the figure of linear beside body-nonlinear."""
    checks: list[Check] = []
    for name, item in {
        "Buan, fixed": buan("fixed"),
        "Buan, elastic": buan("elastic"),
        "hinged sphere": scene("hinged-sphere"),
        "floats on a floating platform": scene("floating", sea_state="moderate"),
    }.items():
        checks += _small_waves(name, item, coefficients)
    ducks = rotors()
    ducks = replace(ducks, settings=replace(ducks.settings, interaction=False))
    checks += _small_waves("two ducks on a barge, each body's waves alone", ducks, _coarse)
    known = coefficients(buan("fixed"))
    return checks + _years(known) + _turning(known) + _sway(known) + _heights(known)


def _coarse(item: Scene) -> Hydrodynamics:
    """Coefficients of bodies that do not feel each other's waves: no memory fits those caught in the gaps."""
    return bem.solve(
        tuple(f.hull for f in item.floats), np.array([f.centre for f in item.floats]), depth=item.water.depth,
        heading=item.sea.heading, omega=np.linspace(*DUCKS), planar=item.planar, panels=SMALL_MESH, interaction=False,
    )  # fmt: skip


def _small_waves(name: str, item: Scene, solved: Callable[[Scene], Hydrodynamics | None]) -> list[Check]:
    """Of both methods with the same coefficients, whatever their mesh."""
    low, high = (int(np.ceil(w / BETWEEN)) for w in item.sea.omega[[0, -1]])
    numbers = np.unique(np.linspace(low, high - 1, LINES).astype(int))
    sea = components(amplitude=np.full(numbers.size, SMALL / LINES), omega=BETWEEN * numbers, phase=numbers**2 % 7)
    small = replace(item, sea=sea)
    period = 2 * np.pi / BETWEEN
    march, lines = both(
        small, solved(small), duration=2 * period, discard=3 * period, ramp=period, ramp_form="cosine",
        newton_tolerance=1e-11, rao=True, time_step=0.05,
    )  # fmt: skip
    checks = []
    rao = {"march": march, "lines": lines}
    motion = {key: r.variables["rao"][1] * np.exp(1j * r.variables["rao_phase"][1]) for key, r in rao.items()}
    difference, size = (
        np.nan_to_num(np.abs(x)).max(axis=-1) for x in (motion["lines"] - motion["march"], motion["march"])
    )
    apart = difference[size > 0] / size[size > 0]
    checks.append(
        Check(
            case=CASE, quantity=f"{name}: worst RAO, difference over largest", ours=float(apart.max()),
            published=0.0, allowed=5e-3,
        )
    )  # fmt: skip
    for key in OUTPUTS:
        if key in march.variables:
            ours, other = std(lines, key), std(march, key)
            used = other > 0.02 * np.nanmax(other)
            worst = float(np.max(np.abs(ours[used] / other[used] - 1)))
            quantity = f"{name}: std of {key}, worst over the march's"
            checks.append(Check(case=CASE, quantity=quantity, ours=1 + worst, published=1.0, allowed=5e-3))
    return checks


def _years(known: Hydrodynamics | None) -> list[Check]:
    """Real seas: drag is quadratic there and an arm's rotation exact. An hour's mean power would scatter by 1 %.

    And with that drag in low waves: what is left is by its linearisation.
    """
    checks = []
    for year in YEARS:
        usual = scene("buan", sea_state=year, platform="elastic", seed=0)
        low = f", waves {LOWER:g} times lower and as much more drag"
        for words, item, allowed, note in (("", usual, 0.015, ROTATION), (low, _low(usual), 0.01, "")):
            march, lines = both(item, known, discard=CALM, duration=LONG)
            sway = float(std(lines, "top_displacement")[0] / std(march, "top_displacement")[0])
            told = f"Buan {year}, linear floats, elastic{words}: "
            checks += [
                Check(
                    case=CASE, quantity=told + "std of the tops in x, over the march's", ours=sway, published=1.0,
                    allowed=0.03, note=SWAY,
                ),
                Check(
                    case=CASE, quantity=told + "mean power, over the march's", ours=power(lines) / power(march),
                    published=1.0, allowed=allowed, note=note,
                ),
            ]  # fmt: skip
    return checks


def _low(item: Scene) -> Scene:
    """The scene in waves LOWER times lower, with as much more drag."""
    return replace(_with_drag(item, LOWER), sea=replace(item.sea, amplitude=item.sea.amplitude / LOWER))


def _with_drag(item: Scene, factor: float) -> Scene:
    """The scene with drag coefficients of its platform times a factor."""
    platform = item.platform
    assert platform is not None, "asked of the elastic platform"
    members = tuple(replace(m, drag_coefficient=factor * m.drag_coefficient) for m in platform.frame.members)
    return replace(item, platform=replace(platform, frame=replace(platform.frame, members=members)))


def _turning(known: Hydrodynamics | None) -> list[Check]:
    """What arms that turn do to linear floats on a fixed platform: their mean angles, and the power that goes by them.

    Preloads move the place about which the model is linear, or hold the march on average where it would be at rest.
    """
    checks, item = [], buan("fixed")
    march, lines = both(item, known, duration=LONG)
    half, _ = both(replace(item, sea=replace(item.sea, amplitude=item.sea.amplitude / 2)), known, duration=LONG)
    linear = replace(item, settings=replace(item.settings, froude_krylov="linear", method="frequency"))
    case = case_of(linear, known)
    stiffness, shift = np.diag(case.model.stiffness), mean_shift(case, respond(linear, known))[0]
    rest = case.system.equilibrium[0]
    angle, angle_of_half = (r.variables["rotation"][1][:, 2] for r in (march, half))
    moved = both(_preloaded(item, stiffness * shift), known, duration=LONG)[1]
    held = both(_preloaded(item, -stiffness * (angle - rest)), known, duration=LONG)[0]
    taken = {name: r.variables["absorbed_power"][1][:, 2] for name, r in
             (("march", march), ("lines", lines), ("moved", moved), ("held", held))}  # fmt: skip
    for b, f in enumerate(item.floats):
        told = f"Buan, linear floats, fixed, {f.name}: "
        ratio = 0.25 * shift[b] / (angle_of_half[b] - rest[b])
        checks.append(
            Check(
                case=CASE, quantity=told + "mean angle of second order, over the march's in half the height",
                ours=float(ratio), published=1.0, allowed=0.03,
            )
        )  # fmt: skip
        checks += [
            Check(
                case=CASE, quantity=told + quantity, ours=float(ours[b] / taken["lines"][b]), published=1.0, note=TURNS
            )
            for quantity, ours in (
                ("mean power about that angle, over that about rest", taken["moved"]),
                ("mean power of the march held at rest on average, over the linear model's", taken["held"]),
                ("mean power of the march, over the linear model's", taken["march"]),
            )
        ]
    return checks


def _preloaded(item: Scene, loads: np.ndarray) -> Scene:
    """The scene with loads on its hinges (nb,)."""
    floats = zip(item.floats, loads.tolist(), strict=True)
    return replace(item, floats=tuple(replace(f, preload=load) for f, load in floats))


def _sway(known: Hydrodynamics | None) -> list[Check]:
    """What drives the platform at its resonance: shown with and without drag, linear and body-nonlinear floats."""
    usual = scene("buan", sea_state="2018", platform="elastic", seed=0)
    dragless = _with_drag(usual, 0.0)
    checks = []
    for words, item in {"": usual, ", no drag": dragless}.items():
        march, lines = both(item, known, discard=CALM)
        whole = simulate(replace(item, settings=replace(item.settings, discard=CALM)), known)
        for floats, other in {"linear": march, "body-nonlinear": whole}.items():
            ratio = float(std(lines, "top_displacement")[0] / std(other, "top_displacement")[0])
            told = f"Buan 2018, {floats} floats{words}: std of the tops in x after {CALM:g} s, over the march's"
            checks.append(Check(case=CASE, quantity=told, ours=ratio, published=1.0, note=SWAY))
    return checks


def _heights(known: Hydrodynamics | None) -> list[Check]:
    """Linear over body-nonlinear in higher and higher seas, shown; the years' as markers."""
    base = buan("elastic")
    band, count = (float(base.sea.omega[0]), float(base.sea.omega[-1])), base.sea.omega.size
    seas = {}
    for Hs in HEIGHTS:
        spectrum = PiersonMoskowitz(Hs=Hs, Tp=4.83 * np.sqrt(Hs))
        seas[Hs] = realize(spectrum, components=count, band=band, seed=3)
    rising = {Hs: row for Hs, sea in seas.items() if (row := _over(replace(base, sea=sea), known))}
    years = [scene("buan", sea_state=year, platform="elastic", seed=0) for year in YEARS]
    seen = {item.sea.parameters()["Hm0"]: row for item in years if (row := _over(item, known))}
    labels = ("rotation, front", "hinge force x, front", "top displacement x", "mean power")
    figure, (axis,) = drawing.axes(1, width=6.5)
    for i, (label, colour) in enumerate(zip(labels, (BLUE, ORANGE, GREEN, RED), strict=True)):
        axis.plot(list(rising), [row[i] for row in rising.values()], "-", color=colour, label=label)
        axis.plot(list(seen), [row[i] for row in seen.values()], "o", color=colour, ms=4)
    axis.axhline(1.0, color=GREY, lw=0.8)
    axis.set(
        xlabel="Hs [m]", ylabel="linear / body-nonlinear",
        title="Frequency domain over body-nonlinear march, Buan elastic (dots: 2017 to 2021)",
    )  # fmt: skip
    axis.legend()
    drawing.save(figure, "frequency-domain")
    return [
        Check(case=CASE, quantity=f"Hs {Hs:g} m: {label}, linear over body-nonlinear", ours=row[i], published=1.0)
        for Hs, row in rising.items()
        for i, label in enumerate(labels)
    ]


def _over(item: Scene, known: Hydrodynamics | None) -> tuple[float, ...]:
    """Nothing where a float swings through."""
    try:
        march = simulate(item, known)
    except SimulationFailed:
        return ()
    lines = simulate(replace(item, settings=replace(item.settings, method="frequency", froude_krylov="linear")), known)
    ratios = [std(lines, key)[0] / std(march, key)[0] for key in ("rotation", "hinge_force", "top_displacement")]
    return (*map(float, ratios), power(lines) / power(march))
