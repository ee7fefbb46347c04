"""Fast and reference path side by side: same force model to rounding, the paper's terms to a thousandth."""

from dataclasses import replace

import numpy as np
import pytest
from pytest import approx

from solver.coupled.preparation import around, prepare
from solver.errors import InputError, SimulationFailed
from solver.hydrodynamics.hull.revolution import Revolution
from solver.hydrodynamics.radiation.memory import RadiationMemory
from solver.reference.convolution import Convolution, CosineTransform
from solver.reference.loads import PressureForce, held
from solver.reference.run import simulate_reference
from solver.run import simulate
from solver.scene import EndStops, Float, Platform, Scene, Settings, Water
from solver.sea.field import wave_field
from solver.sea.realization import CALM, realize, regular
from solver.sea.spectrum import PiersonMoskowitz
from solver.structure.frame import Frame
from solver.structure.members import Material, Member, PointMass
from solver.structure.sections import solid_rectangle, tube
from tests.awkward import known, sea
from tests.awkward import scene as awkward_scene
from tests.once import solve

HULL = Revolution.hemisphere_cylinder(radius=1.0, height=0.6)
CENTRES = np.array([[-3.86, 0, 0], [3.86, 0, 0]])
# Both paths far below what is asked of them, so that what differs is the formulation.
FINE = {
    "newton_tolerance": 1e-11,
    "field_tolerance": 1e-12,
    "keep_series": True,
    "ramp": 5.0,
    "discard": 0.0,
    "memory_tolerance": 0.05,
}


@pytest.fixture(scope="module")
def coefficients():
    omega = np.concatenate([np.linspace(0.6, 4.0, 18), np.linspace(4.5, 9.0, 8)])
    return solve((HULL, HULL), CENTRES, depth=50.0, omega=omega, panels=108)


def floats(**more):
    common = {"hull": HULL, "mass": 2147.0, "inertia": (859.0,) * 3, "pto_damping": 1e5, **more}
    return (
        Float(name="front", hinge=(-1.5, 0, 2.6), arm=(-2.36, 0, -2.6), **common),
        Float(name="rear", hinge=(1.5, 0, 2.6), arm=(2.36, 0, -2.6), **common),
    )


def pile():
    """One column with a deck arm to each hinge: the least platform that sways, bends and turns."""
    steel = Material(E=2.1e11, G=8.33e10, density=8010.0)
    nodes = {"foot": (0, 0, -50), "top": (0, 0, 2.6), "h1": (-1.5, 0, 2.6), "h2": (1.5, 0, 2.6)}
    leg = tube(1.2, 0.02)
    beam = solid_rectangle(0.6, 0.6)
    column = Member(
        name="leg", start="foot", end="top", elements=8, section=leg, material=steel,
        drag_coefficient=1.0, inertia_coefficient=2.0,
    )  # fmt: skip
    arms = [Member(name=h, start=h, end="top", elements=1, section=beam, material=steel) for h in ("h1", "h2")]
    return Frame(
        nodes={k: tuple(map(float, v)) for k, v in nodes.items()},
        members=(column, *arms),
        clamped=("foot",),
        masses=(PointMass(node="top", mass=5e4),),
    )


def scene(*, elastic=False, duration=8.0, sea=None, items=None, heading=0.0, **settings):
    sea = sea or realize(PiersonMoskowitz(Hs=1.28, Tp=5.46), components=130, band=(0.7, 3.4), seed=3, heading=heading)
    platform = Platform(frame=pile(), legs=("leg",), hinge_nodes={"front": "h1", "rear": "h2"}) if elastic else None
    options = Settings(**{**FINE, "duration": duration, "time_step": 0.05, **settings})
    return Scene(water=Water(depth=50.0), sea=sea, floats=items or floats(), platform=platform, settings=options)


def both(item, h, **options):
    fast, slow = series(simulate(item, h)), series(simulate_reference(item, h, **options))
    assert slow["time"] == approx(fast["time"], abs=1e-9)
    return fast, slow


def series(record):
    return {name: values for name, (_, values) in record.series.items()}


def apart(name, slow, fast):
    """Largest RMS difference of any channel, relative to the RMS about the mean of the largest."""
    slow, fast = (x[name].reshape(len(x["time"]), -1) for x in (slow, fast))
    moving = ~np.isnan(fast).any(axis=0)
    slow, fast = slow[:, moving], fast[:, moving]
    return np.sqrt(np.mean((slow - fast) ** 2, axis=0)).max() / fast.std(axis=0).max()


def alike(item, h):
    """Options with which only the formulation differs: the fitted kernel, pressure by quadrature."""
    return {"kernel": prepare(item, h).fit, "surface": "quadrature"}


def test_convolution_is_the_state_space_of_the_same_kernel():
    """K = Re r e^(βt): the exact answer for a velocity quadratic in each step is the recursion's."""
    memory = RadiationMemory(
        beta=np.array([-0.4 + 1.3j]), residue=np.array([[[2.0 - 0.7j]]]), added_mass_inf=np.zeros((1, 1)), error=0.0
    )
    dt, c = 0.1, np.array([0.0, 0.5, 1.0])
    convolution = Convolution(memory, dt=dt, c=c, steps=40)
    for n in range(40):
        t = (n + c) * dt
        load = convolution.load(2, (t**2)[:, None])[0]
        convolution.remember((t**2)[:, None])
        b, T = memory.beta[0], t[2]
        # ∫ e^(b(T-s)) s² ds = 2 (e^(bT) - 1)/b³ - 2T/b² - T²/b
        exact = memory.residue[0, 0, 0] * (2 * (np.exp(b * T) - 1) / b**3 - 2 * T / b**2 - T**2 / b)
        assert load == approx(exact.real, abs=1e-13)


@pytest.mark.parametrize("elastic", [False, pytest.param(True, marks=pytest.mark.slow)])
def test_formulations_agree(coefficients, elastic):
    """Augmented and minimal, multipliers and d'Alembert, convolution and state space, same pressures: 1e-8.

    What is left is the time discretization, fourth order in both but not the same constant (turning
    by quaternions or by angles): 2e-9 of the rotation's RMS at 0.05 s.
    """
    item = scene(elastic=elastic, modes="all", duration=5.0)
    fast, slow = simulate(item, coefficients), simulate_reference(item, coefficients, **alike(item, coefficients))
    assert slow.attrs["constraint_drift"] <= 1e-10
    for name in ("work_wave", "work_radiation", "work_pto", "stored_energy_change", "work_structural"):
        assert slow.attrs[name] == approx(fast.attrs[name], rel=1e-7, abs=1e-9)
    assert slow.attrs["energy_residual"] < 1e-7
    for name in ("rotation", "hinge_force", "absorbed_power"):
        assert slow.variables[name][1] == approx(fast.variables[name][1], rel=1e-6, abs=1e-6)
    fast, slow = series(fast), series(slow)
    assert apart("rotation", slow, fast) < 1e-8
    assert apart("hinge_force", slow, fast) < 1e-7  # a force is a second derivative of the motion
    if elastic:
        assert apart("top_displacement", slow, fast) < 2e-8
        assert apart("bottom_stress", slow, fast) < 1e-7


@pytest.mark.slow
def test_formulations_differ_by_the_fourth_order_of_the_step(coefficients):
    steps = np.array([0.2, 0.1])
    error = []
    for dt in steps:
        item = scene(time_step=dt, duration=5.0)
        fast, slow = both(item, coefficients, **alike(item, coefficients))
        error.append(apart("rotation", slow, fast))
    assert np.log2(error[0] / error[1]) == approx(4, abs=0.3)


@pytest.mark.parametrize("heading", [0.0, pytest.param(np.pi, marks=pytest.mark.slow)])
def test_the_papers_own_terms(coefficients, heading):
    """2,160 panels are right to 1e-3 of the pressure, the fit to 5e-3 of eq. 14; and mirrored seas are alike."""
    h = coefficients if heading == 0 else solve((HULL, HULL), CENTRES, depth=50.0, omega=coefficients.omega,
                                                heading=heading, panels=108)  # fmt: skip
    item = scene(duration=3.0, time_step=0.15, newton_tolerance=1e-6, heading=heading, ramp=0.0, memory_tolerance=5e-3)
    fast, slow = both(item, h, panels=(36, 60), kernel=CosineTransform.of(h), surface="panels")
    assert apart("rotation", slow, fast) < 5e-3


JOINTS = {
    "hinge": {"pto_damping": 3e3, "damping": 1e3, "quadratic_damping": 2e3, "stiffness": 5e3, "offset": 0.1,
              "mechanism_inertia": 2e4},
    "heave": {"pto_damping": 3e3, "damping": 1e3, "quadratic_damping": 2e3, "stiffness": 5e3, "offset": 0.1,
              "mechanism_inertia": 3e3},
    "surge heave pitch": {"pto_damping": (1e3, 2e3, 3e3), "stiffness": (4e3, 0.0, 1e3), "offset": (0.1, 0.1, 0.05),
                          "mechanism_inertia": (500.0, 0.0, 3e3)},
    "pitch heave": {"pto_damping": (5e4, 2e3), "offset": (0.05, 0.1), "mechanism_inertia": (2e3, 100.0)},
}  # fmt: skip


@pytest.mark.parametrize(
    "motion, elastic",
    [
        ("hinge", False),
        pytest.param("heave", True, marks=pytest.mark.slow),
        ("surge heave pitch", False),
        pytest.param("surge heave pitch", True, marks=pytest.mark.slow),
        pytest.param("pitch heave", True, marks=pytest.mark.slow),
    ],
)
def test_every_kind_of_joint_and_joint_load(coefficients, motion, elastic):
    """Let go from an offset in calm water: springs, dampers and mechanisms on one axis or several.

    A float with several axes on an elastic platform rings faster than 0.05 s shows; with a quarter of it both
    formulations agree to 1e-7, falling as the step's fourth power.
    """
    length = {"time_step": 0.0125, "duration": 0.5} if elastic and " " in motion else {"duration": 1.5}
    item = scene(sea=CALM, items=floats(motion=tuple(motion.split()), **JOINTS[motion]), elastic=elastic, **length)
    fast, slow = both(item, coefficients, **alike(item, coefficients))
    name = "rotation" if motion == "hinge" else "motion"
    assert apart(name, slow, fast) < 1e-6
    assert apart("hinge_force", slow, fast) < 1e-5
    assert slow[name].ravel()[0] == approx(np.ravel(JOINTS[motion]["offset"])[0], abs=5e-3)


@pytest.mark.slow
def test_stops_and_limits_in_both_formulations(coefficients):
    """The reference finds no instants: in short steps, on a spring and a limit without jumps, both agree to 1e-3."""
    stops = EndStops(lower=-0.05, upper=0.3, stiffness=4e5)
    law = {"pto_damping": 2e4, "offset": 0.15, "force_limit": 4e3, "preload": 500.0}
    item, free = (
        scene(sea=CALM, items=floats(end_stops=ends, **law), duration=3.0, time_step=0.025) for ends in (stops, None)
    )
    fast, slow = both(item, coefficients, **alike(item, coefficients))
    assert apart("rotation", slow, fast) < 1e-3
    assert apart("rotation", series(simulate(free, coefficients)), fast) > 0.05  # the front float met its lower stop


@pytest.mark.parametrize(
    "diffraction, radiation", [(True, False), *(pytest.param(False, r, marks=pytest.mark.slow) for r in (True, False))]
)
def test_switches_and_linear_floats(coefficients, diffraction, radiation):
    item = scene(duration=3.0, froude_krylov="linear", diffraction=diffraction, radiation=radiation, ramp=0.0)
    fast, slow = both(item, coefficients, **alike(item, coefficients))
    assert apart("rotation", slow, fast) < 1e-7


def test_a_platform_without_floats():
    item = replace(scene(elastic=True, modes="all", time_step=0.1), floats=())
    fast, slow = both(item, None)
    assert apart("top_displacement", slow, fast) < 1e-7 and apart("bottom_stress", slow, fast) < 1e-7


@pytest.mark.slow
def test_accuracy_reference_turns_every_approximation_off(coefficients):
    item = scene(duration=0.6, time_step=0.15, ramp=0.0, accuracy="reference", elastic=True)
    paths = item.settings.paths
    assert (paths.formulation, paths.memory, paths.surface, paths.modes) == (
        "augmented",
        "convolution",
        "panels",
        "all",
    )
    record, standard = (
        simulate(item, coefficients),
        simulate(replace(item, settings=replace(item.settings, accuracy="standard")), coefficients),
    )
    assert record.variables.keys() == standard.variables.keys()
    assert all(record.variables[n][1].shape == standard.variables[n][1].shape for n in record.variables)
    assert record.attrs["surface"] == "panels" and record.attrs["modes"] == "all"
    assert record.attrs["discretization_error"] > 0 and record.attrs["constraint_drift"] <= 1e-10


def test_waves_on_a_frame_are_judged_at_the_same_times_by_both_steps(coefficients):
    """A quarter of the longer step apart the loads of waves that set in differ by a tenth."""
    record = simulate(scene(duration=4.0, time_step=0.2, ramp=2.0, elastic=True, formulation="augmented"), coefficients)
    assert 1e-6 < record.attrs["discretization_error"] < 2e-3


def test_a_model_let_go_in_still_water_asks_for_no_wave(coefficients):
    """Of 1 rad/s, below all that a small body is solved for."""
    high = coefficients.omega > 1.1
    names = ("omega", "added_mass", "radiation_damping", "diffraction", "froude_krylov")
    few = replace(coefficients, error=None, **{name: getattr(coefficients, name)[high] for name in names})
    given = scene(items=floats(offset=0.05), duration=2.0, sea=CALM, froude_krylov="linear", ramp=0.0)
    fast, slow = both(given, few, **alike(given, few))
    assert apart("rotation", slow, fast) < 1e-6


@pytest.mark.parametrize("discard", [0.0, 1.0])
def test_a_decay_s_samples_tell_of_its_ends_here_too(discard):
    """A sphere off its guide: half of the first gap is left out, or the first sample, later, counts in full; both err
    by far more than the step does."""
    hull = Revolution.sphere(radius=1.0, draft=0.9)
    ball = Float(
        name="ball", hull=hull, mass=1025.0 * hull.volume, inertia=(900.0,) * 3, hinge=(0.2, 0.1, 0.0),
        cog=(0.05, 0, -0.2), motion=("heave",), offset=0.2,
    )  # fmt: skip
    settings = {"duration": 3.0, "ramp": 0.0, "discard": discard, "froude_krylov": "linear"}
    ours, exact = (
        awkward_scene([ball], waves=CALM, time_step=step, accuracy=way, **settings)
        for step, way in ((0.1, "reference"), (0.025, "standard"))
    )
    h = known(replace(exact, sea=sea()), 0.3, 8.0, 8)
    records = [simulate(item, h) for item in (ours, exact)]
    true = abs(np.divide(*(record.variables["motion"][1][0, 0, 4] for record in records)) - 1)
    told = records[0].attrs
    assert true > 5e-3 and 1 / 3 < true / told["sampling_error"] < 3
    assert told["discretization_error"] < 1e-3 < told["sampling_error"] < told["estimated_error"]


@pytest.mark.slow
def test_convolution_tells_what_damping_of_few_frequencies_asks_for(coefficients):
    """Added mass other than theirs: against the response to one wave by what they say."""
    some = np.arange(coefficients.omega.size) % 3 == 1
    names = ("omega", "added_mass", "radiation_damping", "diffraction", "froude_krylov")
    few = replace(coefficients, error=None, **{name: getattr(coefficients, name)[some] for name in names})
    items, period = floats(pto_damping=1e4), 2 * np.pi / 2.2
    given = scene(items=items, duration=4 * period, memory="convolution", froude_krylov="linear")
    wave = replace(given, sea=regular(height=0.05, period=period))
    settings = replace(wave.settings, discard=20.0, time_step=period / 20, keep_series=False)
    slow = simulate(replace(wave, settings=settings), few)
    lines = simulate(replace(wave, settings=replace(settings, method="frequency", memory="state-space")), few)
    std = [record.variables["rotation"][1][..., 4] for record in (slow, lines)]
    told, true = slow.attrs["memory_effect"], np.abs((std[0] / std[1]) ** 2 - 1).max()  # of power
    assert told > 0.01 and true / 2 < told < 2 * true


@pytest.mark.parametrize("path", [{"memory": "convolution"}, {"surface": "panels"}, {"formulation": "augmented"}])
def test_each_path_alone(path):
    settings = Settings(**path).paths
    assert settings.formulation == "augmented" and settings.modes == 6
    assert all(getattr(settings, name) == value for name, value in path.items())


@pytest.mark.parametrize("elastic", [False, True])
def test_a_damper_too_stiff_for_its_iterations_is_an_outcome(coefficients, elastic):
    """Damping that would stop the arm within 1e-5 s: not that soon, and said with time, quantity and advice."""
    item = scene(elastic=elastic, items=floats(pto_damping=1e9), duration=0.5, ramp=0.0, formulation="augmented")
    told = r"runs away at t = 0\.0\d* s, last change .* m or rad: reduce time_step = 0\.0125 s.* \(second attempt"
    with pytest.raises(SimulationFailed, match=told):
        simulate(item, coefficients)


def test_what_it_cannot_do_is_named():
    with pytest.raises(InputError, match="tolerance"):
        Settings(accuracy="reference", tolerance=1e-3)
    odd = floats(motion=("heave", "roll", "surge", "pitch"), pto_damping=0.0)[0]
    with pytest.raises(InputError, match=r"floats\.front\.motion"):
        held(odd)


@pytest.mark.slow
def test_two_hundred_seconds_coupled():
    """The whole paper's way on the Buan platform, elastic, against the fast one: what studies/reference.py prints."""
    from studies.reference import ALLOWED, differences

    assert all(difference < ALLOWED for _, _, difference, judged in differences() if judged)


@pytest.mark.parametrize("heave", [-1.0, 1.0])
def test_pressure_on_a_deep_float_in_short_waves(heave):
    """These are too short for a series of two of its sizes: it is as far as the float gets, and the panels' there."""
    spar = Revolution.vertical_cylinder(radius=2.0, draft=22.0, freeboard=3.0)
    item = Float(name="spar", hull=spar, mass=2.8e5, inertia=(8e6,) * 3, hinge=(0.0, 0.0, 0.0), motion=("heave",))
    waves = realize(PiersonMoskowitz(Hs=1.5, Tp=7.0), components=60, band=(0.45, 2.7), seed=0)
    deep = Scene(water=Water(depth=60.0), sea=waves, floats=(item,))
    field = wave_field(waves, 60.0, deep.water.gravity, None)
    near, reach, _ = around(deep, field)
    assert near == field and reach > spar.size + abs(heave)
    with pytest.raises(InputError, match="too short"):
        field.terms_for(2 * spar.size, 1e-9)
    place = np.array([0.0, 0.0, heave]), np.eye(3)
    force = [PressureForce(deep, field, kind, (80, 64), None) for kind in ("quadrature", "panels")]
    series, panels = (of.at(3.0, 1.0)(0, *place) - of.at(3.0, 0.0)(0, *place) for of in force)
    assert series == approx(panels, abs=2e-3 * np.abs(panels).max() * spar.size)
