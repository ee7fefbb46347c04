"""What a power take-off is said to do: its force, its electrical power, and reactive control against the theory."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from pytest import approx

from solver.errors import InputError, SimulationFailed
from solver.frequency import gaussian
from solver.frequency.gaussian import Process
from solver.hydrodynamics.bem import bem
from solver.hydrodynamics.hull.revolution import Revolution
from solver.power_takeoff import PtoEfficiency
from solver.run import simulate
from solver.scene import Float, Scene, Settings, Water
from solver.sea.realization import regular
from tests import awkward

BALL = Revolution.sphere(radius=5.0, draft=5.0)
OMEGA, HEIGHT, RHO, G = 0.9, 0.2, 1025.0, 9.81


@cache
def coefficients():
    omega = np.unique(np.append(np.linspace(0.3, 3.2, 30), OMEGA))
    return bem.solve((BALL,), np.zeros((1, 3)), depth=np.inf, omega=omega, panels=awkward.SMALL)


def ball(**law):
    return Float(name="ball", hull=BALL, mass=RHO * BALL.volume, inertia=(2.6e6,) * 3, cog=(0, 0, -2.0),
                 hinge=(0, 0, 0), motion=("heave",), **law)  # fmt: skip


def scene(*floats, **settings):
    period = 2 * np.pi / OMEGA
    # Samples are 80 in a period: as many as in ten of them, the first not once more at the end.
    given = {"duration": (10 - 1 / 80) * period, "discard": 40 * period, "ramp": 10 * period, "time_step": period / 40,
             "froude_krylov": "linear"} | settings  # fmt: skip
    waves = regular(height=HEIGHT, period=period)
    return Scene(water=Water(depth=np.inf), sea=waves, floats=floats, settings=Settings(**given))


def impedance(omega=OMEGA):
    """Mass with added mass, radiation damping, and buoyancy's stiffness in heave."""
    h = coefficients()
    i = int(np.argmin(np.abs(h.omega - omega)))
    return RHO * BALL.volume + h.added_mass[i, 1, 1], h.radiation_damping[i, 1, 1], h.hydrostatic_stiffness[1, 1]


def reactive():
    """Conjugate to the water's at OMEGA: c = B, k = ω²(m + A) - ρgS, which is negative below the ball's own period."""
    mass, damping, stiffness = impedance()
    return {"pto_damping": damping, "pto_stiffness": OMEGA**2 * mass - stiffness}


def statistic(record, name, which, *at):
    return float(record.variables[name][1][(*at, ["max", "min", "mean", "rms", "std"].index(which))])


def test_reactive_control_takes_all_that_a_heaving_body_can():
    """J/k of a wave of power J = ρg²a²/4ω a metre, in deep water: to the mesh's share of Haskind's relation."""
    best = RHO * G**2 * (HEIGHT / 2) ** 2 / (4 * OMEGA) * G / OMEGA**2
    law = reactive()
    assert law["pto_stiffness"] < 0
    controlled = simulate(scene(ball(**law), method="frequency"), coefficients())
    assert statistic(controlled, "absorbed_power", "mean", 0) == approx(best, rel=0.01)
    passive = simulate(scene(ball(pto_damping=law["pto_damping"]), method="frequency"), coefficients())
    assert statistic(passive, "absorbed_power", "mean", 0) < 0.9 * best
    # Whose stiffness it is does not matter to what moves.
    plain = {"stiffness": law["pto_stiffness"], "pto_damping": law["pto_damping"]}
    spring = simulate(scene(ball(**plain), method="frequency"), coefficients())
    for name in ("motion", "absorbed_power"):
        assert np.array_equal(spring.variables[name][1], controlled.variables[name][1])


def expected_electrical(X, c, k, efficiency):
    """Mean of η P⁺ + P⁻/η_m for P = cẏ² + k y ẏ = a + b cos 2θ of a harmonic of amplitude X.

    a = ½cV², b = ½V (c²V² + k²X²)^½; with γ = acos(-a/b), ⟨P⁺⟩ = (aγ + b sin γ)/π.
    """
    V = OMEGA * X
    a, b = c * V**2 / 2, V / 2 * np.hypot(c * V, k * X)
    gamma = np.arccos(-a / b)
    absorbed = (a * gamma + b * np.sin(gamma)) / np.pi
    return efficiency.generating * absorbed + (a - absorbed) / efficiency.motoring


def test_electrical_power_of_a_harmonic_is_its_closed_form():
    law, efficiency = reactive(), PtoEfficiency(generating=0.9, motoring=0.7)
    law["pto_stiffness"] *= 0.5
    item = scene(ball(**law, pto_efficiency=efficiency), outputs=("pto_force",))
    record = simulate(item, coefficients())
    X = np.sqrt(2) * statistic(record, "motion", "std", 0, 0)
    c, k = law["pto_damping"], law["pto_stiffness"]
    assert statistic(record, "electrical_power", "mean", 0) == approx(
        expected_electrical(X, c, k, efficiency), rel=2e-3
    )
    assert statistic(record, "electrical_power", "min", 0) < 0 <= statistic(record, "absorbed_power", "min", 0)
    # The stiffness only lends: mechanical power in the mean is what the damping takes.
    assert statistic(record, "absorbed_power", "mean", 0) == approx(c * (OMEGA * X) ** 2 / 2, rel=1e-3)
    assert statistic(record, "pto_force", "std", 0, 0) == approx(np.hypot(c * OMEGA, k) * X / np.sqrt(2), rel=1e-3)
    assert record.attrs["energy_residual"] < 1e-3
    # Both ways without loss it is the mechanical power.
    lossless = simulate(
        replace(item, floats=(replace(item.floats[0], pto_efficiency=PtoEfficiency()),)), coefficients()
    )
    a, b = (statistic(lossless, name, "mean", 0) for name in ("electrical_power", "absorbed_power"))
    assert a == approx(b, rel=2e-3)


def test_electrical_power_in_the_frequency_domain_is_that_of_the_march():
    """Of a wave to the time domain's own error, extremes too."""
    law, efficiency = reactive(), PtoEfficiency(generating=0.9, motoring=0.7)
    law["pto_stiffness"] *= 0.5
    time, frequency = (
        simulate(scene(ball(**law, pto_efficiency=efficiency), **method), coefficients())
        for method in ({}, {"method": "frequency"})
    )
    assert time.variables["electrical_power"][0] == frequency.variables["electrical_power"][0]
    a, b = (record.variables["electrical_power"][1][0] for record in (time, frequency))
    assert a == approx(b, abs=5e-3 * np.abs(b).max())


def axes_at_work(dampers, stiffness, level):
    """Two axes that go together in 40 waves, and the waves' frequencies."""
    dice, omega = np.random.default_rng(5), np.linspace(0.5, 1.5, 40)
    lines = dice.normal(size=(40, 2, 2)) @ [1.0, 1j] * [0.1, 0.3] @ [[1.0, 0.5], [0.0, 1.0]]
    position = lines * np.exp(-8 * (omega - 1.0) ** 2)[:, None]
    c, k, mean = map(np.array, (dampers, stiffness, level))
    return gaussian.Axes(lambda v: c * v, c, k, mean, position, -1j * omega[:, None] * position), omega


def electrical(efficiency, axes, omega):
    absorbed = gaussian.power_table(axes.damping, axes.rate, Process(omega, 3600.0))
    return gaussian.electrical_table(efficiency, axes, absorbed, Process(omega, 3600.0))


@pytest.mark.parametrize("level", [(0.0, 0.0), (0.4, -0.2)])
def test_expected_electrical_power_of_several_axes_is_that_of_many_records(level):
    """Phases at random: 1e5 instants, whose mean is within 1 %, std within 2 %."""
    axes, omega = axes_at_work((2.0, 0.7), (-3.0, 1.5), level)
    efficiency = PtoEfficiency(generating=0.85, motoring=0.6)
    table = electrical(efficiency, axes, omega)
    dice = np.random.default_rng(1)
    turned = np.exp(2j * np.pi * dice.random((100_000, 40)))
    y, v = ((turned @ lines).real for lines in (axes.position, axes.rate))
    power = efficiency.electrical((axes.damping * v + axes.stiffness * (axes.level + y)) * v).sum(axis=1)
    largest, least, mean, rms, std = table
    assert (mean, std) == (approx(power.mean(), abs=0.01 * std), approx(power.std(), rel=0.02))
    assert rms == approx(np.hypot(mean, std), rel=1e-12)
    if not any(level):  # of 1e3 cycles: beyond almost all instants, and within what all waves in phase give
        assert np.quantile(power, 0.999) < largest < 1.5 * power.max()
        assert 1.5 * power.min() < least < np.quantile(power, 0.001)


def test_expected_electrical_power_of_one_axis_is_its_closed_form():
    """½(1 ± ρ') of E|f v| = (2/π) σ_f σ_v ((1 - ρ²)^½ + ρ asin ρ), ρ = cσ_v/σ_f; of a damper η times the mechanical."""
    efficiency = PtoEfficiency(generating=0.85, motoring=0.6)
    for k in (-3.0, -0.2, 8.0):
        axes, omega = axes_at_work((2.0, 1e-9), (k, 0.0), (0.0, 0.0))
        mean = electrical(efficiency, axes, omega)[2]
        y, v = (np.sqrt(0.5 * np.sum(np.abs(lines[:, 0]) ** 2)) for lines in (axes.position, axes.rate))
        f = np.hypot(2.0 * v, k * y)
        rho = 2.0 * v / f
        size = 2 / np.pi * f * v * (np.sqrt(1 - rho**2) + rho * np.arcsin(rho))
        whole = 2.0 * v**2
        assert mean == approx(0.85 * (size + whole) / 2 - (size - whole) / 2 / 0.6, rel=1e-6)
    axes, omega = axes_at_work((2.0, 0.7), (0.0, 0.0), (0.1, 0.0))
    mechanical = gaussian.power_table(axes.damping, axes.rate, Process(omega, 3600.0))
    assert electrical(efficiency, axes, omega) == approx(0.85 * mechanical)


def test_the_force_is_that_of_the_law_in_time_and_in_frequency():
    law = reactive() | {"preload": 3e4}
    law["pto_stiffness"] *= 0.3
    time = simulate(scene(ball(**law), outputs=("pto_force",), keep_series=True), coefficients())
    y, force = time.series["motion"][1][:, 0, 0], time.series["pto_force"][1][:, 0, 0]
    rate = np.gradient(y, time.series["time"][1])
    inner = slice(2, -2)
    expected = -(law["pto_stiffness"] * y + law["pto_damping"] * rate)
    assert force[inner] == approx(expected[inner], abs=5e-3 * np.abs(force).max())
    frequency = simulate(scene(ball(**law), outputs=("pto_force",), method="frequency"), coefficients())
    for which in ("mean", "std", "max", "min", "rms"):
        a, b = (statistic(r, "pto_force", which, 0, 0) for r in (time, frequency))
        assert a == approx(b, rel=0.01, abs=0.01 * np.abs(force).max()), which


def test_a_limited_force_is_never_more_and_axes_that_are_not_there_are_told_apart():
    whole, known = awkward.soft_mooring()
    limit = 2e3
    item = replace(whole.floats[0], pto_damping=(0, 1e5, 0), force_limit=(np.inf, limit, np.inf))
    settings = replace(whole.settings, outputs=("pto_force",), duration=30.0, discard=10.0, ramp=5.0)
    record = simulate(replace(whole, floats=(item,), settings=settings), known)
    dims, values = record.variables["pto_force"]
    assert dims == ("float", "axis", "statistic") and record.coords["axis"].tolist() == ["surge", "heave", "pitch"]
    assert values[0, 1, :2] == approx([limit, -limit], rel=1e-9)
    assert np.all(values[0, [0, 2]] == 0) and "electrical_power" not in record.variables


def test_what_is_put_out_changes_nothing_else():
    whole, known = awkward.duck()
    settings = replace(whole.settings, duration=30.0, discard=10.0, ramp=5.0)
    whole = replace(whole, settings=settings)
    told = replace(
        whole, settings=replace(settings, outputs=("pto_force",)),
        floats=(replace(whole.floats[0], pto_efficiency=PtoEfficiency(generating=0.8)),),
    )  # fmt: skip
    plain, more = simulate(whole, known), simulate(told, known)
    assert set(more.variables) - set(plain.variables) == {"pto_force", "electrical_power"}
    for name, (_, values) in plain.variables.items():
        assert np.array_equal(more.variables[name][1], values, equal_nan=True), name
    # A damper gives nothing back.
    a, b = (more.variables[name][1] for name in ("electrical_power", "absorbed_power"))
    assert a == approx(0.8 * b, rel=1e-12)


def test_control_that_lets_a_float_fall_away_or_has_no_meaning_is_refused():
    stiffness = impedance()[2]
    with pytest.raises(SimulationFailed, match="unstable: ball heave falls away"):
        simulate(scene(ball(pto_stiffness=-1.01 * stiffness)), coefficients())
    assert simulate(scene(ball(stiffness=-0.5 * stiffness), method="frequency"), coefficients()).attrs["unmet"] == ""
    with pytest.raises(InputError, match=r"floats.ball.pto_stiffness = .*: must be 0 beside a force_limit"):
        ball(pto_stiffness=1.0, force_limit=1e3)
    with pytest.raises(InputError, match=r"floats.ball.pto_efficiency.motoring = 1.1: must be <= 1"):
        ball(pto_efficiency=PtoEfficiency(motoring=1.1))


@pytest.mark.parametrize("method", ["time", "frequency"])
def test_fixed_floats_have_no_power_take_off_to_tell_of(method):
    fixed = replace(ball(), motion=())
    outputs = ("pto_force", "pto_stroke")
    record = simulate(scene(fixed, outputs=outputs, method=method), coefficients())
    assert not {"pto_force", "pto_stroke", "pto_rate"} & set(record.variables)
    assert statistic(record, "hinge_force", "std", 0, 2) > 0


def test_where_friction_turns_largest_and_least_positions_are_those_of_the_turn():
    """A parabola through samples before and after it would go 0.5 % beyond."""
    law = {"coulomb": 0.4 * 1e5, "damping": 1e5}
    coarse, fine = (
        simulate(scene(ball(**law), outputs=("pto_stroke",), time_step=2 * np.pi / OMEGA / n), coefficients())
        for n in (20, 320)
    )
    for which in ("max", "min"):
        assert statistic(coarse, "motion", which, 0, 0) == approx(statistic(fine, "motion", which, 0, 0), rel=1e-3)
    assert coarse.variables["pto_stroke"][1] == approx(fine.variables["pto_stroke"][1], rel=1e-3)
