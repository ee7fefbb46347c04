"""The frequency domain: against closed forms, long samples, and the march of linear scenes."""

from dataclasses import replace

import numpy as np
import pytest
from pytest import approx
from scipy.integrate import dblquad

from solver.coupled import linear_drag as drag
from solver.coupled.linear import impedance, linear_model
from solver.coupled.moving import _waterplane, surface_past
from solver.coupled.preparation import prepare
from solver.errors import InputError, SimulationFailed
from solver.frequency import condensed, gaussian, response
from solver.frequency.case import case_of
from solver.frequency.condensed import LANES, Condensed, _lanes, _side_by_side
from solver.frequency.gaussian import Process
from solver.frequency.response import respond
from solver.hydrodynamics.hull.box import box
from solver.hydrodynamics.hull.revolution import Revolution
from solver.hydrodynamics.hull.ring import ring
from solver.remarks import bared
from solver.run import simulate
from solver.scene import Float, Settings
from solver.sea.realization import components, regular
from solver.statistics import moments
from tests.awkward import SCENES, known, scene, sea

LINES = np.array([5, 6, 7, 9, 11, 14, 17])  # of a sea that repeats


def linear(item, **settings):
    """A scene with linear pressure."""
    return replace(item, settings=replace(item.settings, froude_krylov="linear", **settings))


def frequency(item, h, **settings):
    return simulate(linear(item, method="frequency", **settings), h)


@pytest.mark.parametrize(("a", "b"), [(1.0, 0.0), (1.0, 1e-9), (1.0, 0.04), (0.7, 0.3), (0.5, 0.5), (0.0, 0.0)])
def test_drag_of_a_gaussian_velocity(a, b):
    """⟨|u|I + uuᵀ/|u|⟩ by quadrature; in one direction √(8/π)σ."""
    K = drag.of_gaussian(np.diag([a, b]))

    def mean(f):
        def integrand(y, x):
            u = np.array([np.sqrt(a) * x, np.sqrt(b) * y])
            size = np.linalg.norm(u)
            return f(u, size) * np.exp(-(x * x + y * y) / 2) / (2 * np.pi) if size > 0 else 0.0

        return 4 * dblquad(integrand, 0, 8, 0, 8, epsabs=1e-7)[0]

    exact = [mean(lambda u, size, i=i: size + u[i] ** 2 / size) for i in (0, 1)]
    assert np.diag(K) == approx(exact, abs=2e-5)
    assert drag.of_gaussian(np.array([[a]]))[0, 0] == approx(np.sqrt(8 * a / np.pi))


def test_drag_turns_with_the_velocity():
    S, angle = np.diag([0.9, 0.2]), 0.7
    R = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
    assert drag.of_gaussian(R @ S @ R.T) == approx(R @ drag.of_gaussian(S) @ R.T)
    assert drag.of_harmonic(R @ np.array([0.9, 0.2j])) == approx(R @ drag.of_harmonic(np.array([0.9, 0.2j])) @ R.T)


@pytest.mark.parametrize(("a", "b"), [(0.9, 0.2), (0.5, 0.5), (0.6, 0.0), (0.0, 0.0)])
def test_drag_in_a_plane_is_that_of_the_plane_in_space(a, b):
    """In two directions by a closed form, in three by eigenvectors: the third has the mean speed alone."""
    flat = np.cos(0.7) * np.eye(2) + np.sin(0.7) * np.array([[0, -1], [1, 0]])
    S = flat @ np.diag([a, b]) @ flat.T
    lean = np.linalg.qr(np.random.default_rng(2).normal(size=(3, 3)))[0]
    whole = lean.T @ drag.of_gaussian(lean @ np.pad(S, (0, 1)) @ lean.T) @ lean
    assert whole[:2, :2] == approx(drag.of_gaussian(S), abs=1e-7)  # where b/a is rounding, K goes with its root
    assert whole[2] == approx(np.array([0, 0, np.trace(drag.of_gaussian(S)) / 3]), abs=1e-7)


def test_drag_of_a_harmonic():
    """8U/3π along a line; round a circle the speed is always U."""
    assert drag.of_harmonic(np.array([0.8 + 0.6j]))[0, 0] == approx(8 / (3 * np.pi), rel=1e-4)
    assert drag.of_harmonic(np.array([1.0, 1j])) == approx(np.eye(2))


@pytest.mark.parametrize("phase", [0.0, 0.03, 1.0])
def test_drag_of_a_flat_ellipse(phase):
    """(8/3π)U along it, (4/3π)U across, and neither by the other, whatever the phase; in a current, too."""
    flat = np.array([0.8, 1e-5j])
    K = drag.of_harmonic(flat * np.exp(1j * phase))
    assert np.diag(K) == approx(0.8 / (3 * np.pi) * np.array([8, 4]), rel=5e-3)  # phases: 64
    _, L = drag.harmonic_in_stream(np.array([0.4, 0.0]), flat * np.exp(1j * phase))
    assert np.abs([K[0, 1], K[1, 0], L[0, 1], L[1, 0]]).max() < 1e-9


@pytest.mark.parametrize(
    "mean", [(-5.0, 0.0, 0.0), (-5.0, 0.3, 0.8), (-5.0, 3.0, -2.0), (-5.0, 20.0, 9.0), (-5.0, 0, 1e4)]
)
@pytest.mark.parametrize("flat", [False, pytest.param(True, marks=pytest.mark.slow)])
def test_stress_of_the_most_compressive_fibre(mean, flat):
    """Against all instants of its own lines; as large as they come in an hour, on average."""
    random, mean = np.random.default_rng(3), np.array(mean, float)
    omega = np.sort(random.uniform(0.7, 2.0, 40))  # none comes back within the hour
    X = (random.normal(size=(40, 3)) + 1j * random.normal(size=(40, 3))) * 0.15 * np.array([0.4, 1.0, 0.7])
    if flat:
        X[:, 2] = 0.0
    table = gaussian.compression_table(mean[None], X[:, None], Process(omega, 3600.0))[0]
    t = np.arange(0, 3600.0, 0.25)
    records = []
    for _ in range(20):
        turned = X * np.exp(2j * np.pi * random.uniform(size=(40, 1)))
        a, b, c = (mean + (np.exp(-1j * np.outer(t, omega)) @ turned).real).T
        records.append(moments((a - np.hypot(b, c))[:, None])[0])
    high, low, level, _, _ = np.mean(records, axis=0)
    std = np.sqrt(np.mean(np.array(records)[:, 4] ** 2))
    assert table[2] == approx(level, abs=0.02 * std)
    assert table[4] == approx(std, rel=0.03)
    assert table[1] == approx(low, abs=0.35 * std)  # Rayleigh: a narrower band's
    assert table[0] >= high - 0.1 * std


def test_no_fibre_is_relieved_of_more_than_the_axial_force():
    """Of a moment that goes round, too: every fibre's own largest stress is far above that."""
    random, omega = np.random.default_rng(5), np.linspace(0.7, 2.0, 40)
    X = random.normal(size=(40, 1, 3)) + 1j * random.normal(size=(40, 1, 3))
    X[..., 0] = 0.0
    assert gaussian.compression_table(np.array([[-5.0, 0.0, 0.0]]), X, Process(omega, 3600.0))[0, 0] == approx(-5.0)


def test_statistics_of_several_lines():
    """Std and largest of each by sums over its lines; none is larger than the sum of them, and what is not a number
    stays so."""
    random, omega = np.random.default_rng(4), np.linspace(0.7, 2.0, 30)
    X = random.normal(size=(30, 2, 2)) + 1j * random.normal(size=(30, 2, 2))
    X[:, 0, 1], X[1:, 1, 1] = np.nan, 0.0
    table = gaussian.table(np.full((2, 2), 3.0), X, Process(omega, 1000.0))
    top, bottom, mean, rms, std = np.moveaxis(table - [3.0, 3.0, 3.0, 0.0, 0.0], -1, 0)
    power = np.abs(X) ** 2
    m0, m2 = power.sum(axis=0) / 2, np.einsum("w,wij->ij", omega**2, power) / 2
    u = np.sqrt(2 * np.log(np.sqrt(m2 / m0) / (2 * np.pi) * 1000.0))
    assert std == approx(np.sqrt(m0), nan_ok=True)
    assert mean == approx(0.0) and bottom == approx(-top, nan_ok=True)
    assert rms == approx(np.hypot(3.0, std), nan_ok=True)
    assert top[:, 0] == approx(((u + np.euler_gamma / u) * np.sqrt(m0))[:, 0])
    assert np.isnan(top[0, 1]) and top[1, 1] == approx(abs(X[0, 1, 1]))


def test_extremes_of_many_hours():
    """Elevation of a real sea: the narrow band's expected extremes are a few percent large."""
    waves = sea(Hs=2.0)
    table = gaussian.table(np.array(0.3), waves.amplitude, Process(waves.omega, 1000.0))
    random, t = np.random.default_rng(0), np.arange(0, 1000.0, 0.2)
    largest = []
    for _ in range(60):
        phases = np.exp(2j * np.pi * random.uniform(size=waves.omega.size))
        largest.append((np.exp(-1j * np.outer(t, waves.omega)) @ (waves.amplitude * phases)).real.max())
    assert table[0] - 0.3 == approx(np.mean(largest), rel=0.1)
    assert 0.3 - table[1] == approx(table[0] - 0.3)
    assert table[4] == approx(0.5, rel=0.02)


def test_power_of_a_gaussian_rate():
    """⟨c v²⟩ and its std √2 cσ² for one axis, by many lines; two axes that do not know each other add in squares."""
    count = 3000
    omega = np.linspace(0.8, 1.2, 2 * count)
    V = np.zeros((omega.size, 2), complex)
    V[::2, 0], V[1::2, 1] = 0.1, 0.2
    c, power = np.array([2.0, 3.0]), 0.5 * np.array([count * 0.01, count * 0.04])
    table = gaussian.power_table(c, V, Process(omega, 3600.0))
    assert table[2] == approx(c @ power)
    assert table[4] == approx(np.sqrt(2) * np.linalg.norm(c * power), rel=3e-4)
    one = gaussian.power_table(c[:1], V[:1, :1], Process(omega[:1], 3600.0))
    assert one == approx([0.02, 0, 0.01, np.sqrt(0.375) * 0.02, 0.02 / np.sqrt(8)], abs=1e-9)


@pytest.mark.parametrize("count", [2, 3, 5])
def test_power_of_few_lines_varies_less_than_a_gaussians(count):
    """Of two axes that know each other, beside a long sample at frequencies of which no two pairs have the same sum."""
    random = np.random.default_rng(count)
    V = random.normal(size=(count, 2)) + 1j * random.normal(size=(count, 2))
    omega, c = np.array([1, 4, 13, 40, 121])[:count], np.array([2.0, 3.0])
    t = 2 * np.pi * np.arange(500) / 500
    power = (np.exp(-1j * np.outer(t, omega)) @ V).real ** 2 @ c
    table = gaussian.power_table(c, V, Process(omega.astype(float), 1e4))
    assert table[2:] == approx([power.mean(), np.sqrt(np.mean(power**2)), power.std()])


def repeating(item, height):
    """Few waves that come back after a minute of the scene's own time, small enough for all to be linear."""
    unit = np.median(item.sea.omega) / 10
    amplitude = height * np.linspace(1.0, 0.4, LINES.size)
    return replace(
        item,
        sea=components(amplitude=amplitude, omega=unit * LINES, phase=LINES**2 % 7, heading=item.sea.heading)
        if item.sea.heading
        else components(amplitude=amplitude, omega=unit * LINES, phase=LINES**2 % 7),
    ), 2 * np.pi / unit


@pytest.mark.parametrize(
    "name", [pytest.param(n, marks=[pytest.mark.slow] * (n in ("flap", "oblique"))) for n in sorted(SCENES)]
)
def test_small_linear_waves_are_the_marchs(name):
    """std of every coordinate, force, displacement and stress, mean power, all means: to 0.5 %."""
    item, h = SCENES[name]()
    if item.platform:
        outputs = ("reactions", "section_forces", "fibre_stress", "leg_tops")
        item = replace(item, settings=replace(item.settings, outputs=outputs))
    size = min((f.hull.size for f in item.floats), default=1.0)
    item, period = repeating(item, 1e-4 * size)
    if name == "soft_mooring":  # what is let go at the start must have died away
        item = replace(item, floats=tuple(replace(f, damping=(1.2e5, 0, 0)) for f in item.floats))
    numerics = {"newton_tolerance": 1e-11 * size, "memory_tolerance": 1e-3, "time_step": period / 400}
    lasting = {"duration": 2 * period, "discard": 8 * period, "ramp": 3 * period, "ramp_form": "cosine"}
    march, lines = simulate(linear(item, **numerics, **lasting), h), frequency(item, h, **numerics, **lasting)
    tables = [key for key, (dims, _) in march.variables.items() if "statistic" in dims]
    assert len(tables) >= 2
    for key in tables:
        table, exact = (record.variables[key][1].reshape(-1, 5) for record in (lines, march))
        table, exact = table[~np.isnan(exact[:, 2])], exact[~np.isnan(exact[:, 2])]
        _, _, mean, rms, std = exact.T
        if key == "absorbed_power":
            assert table[:, 2] == approx(mean, rel=1e-2), key
            continue
        # What is nearly zero by cancellation is judged beside the largest of its kind.
        assert np.all(np.abs(table[:, 4] - std) <= 5e-3 * std + 3e-4 * std.max()), key
        assert np.all(np.abs(table[:, 2] - mean) <= 1e-3 * rms.max()), key


@pytest.mark.parametrize(("coefficient", "within"), [(1.0, 0.01), (8.0, 0.025)])
def test_drag_of_the_legs_is_the_marchs(coefficient, within):
    """Legs alone in waves of 3 m, stiff ones bent by little else, too: linearised drag has (8/3π)^½ of what it is.

    ⟨(|u|u)²⟩ = 3σ⁴, of which (8/π) σ⁴ are in phase with u, and of the rest what is no faster than the waves counts.
    """
    bare, _ = SCENES["bare_legs"]()
    members = [replace(m, drag_coefficient=coefficient * (m.drag_coefficient > 0)) for m in bare.platform.frame.members]
    platform = replace(bare.platform, frame=replace(bare.platform.frame, members=tuple(members)))
    waves = sea(Hs=3.0, Tp=8.0, band=(0.35, 2.4), heading=np.pi / 6)
    item = linear(replace(bare, platform=platform, sea=waves), duration=3600.0)
    dragless = tuple(replace(m, drag_coefficient=0.0) for m in members)
    without = replace(platform, frame=replace(platform.frame, members=dragless))
    records = simulate(item), frequency(item, None), frequency(replace(item, platform=without), None)
    exact, table, without = (r.variables["top_displacement"][1][0, 0, 4] for r in records)
    assert without < 0.91 * exact
    assert table == approx(exact, rel=within)


def test_modes_that_follow_are_what_the_whole_equation_has():
    """Weak drag couples all modes; where it is strong none only follows."""
    item, h = SCENES["unequal_legs"]()
    system = prepare(linear(item, method="frequency"), h)
    model, omega = linear_model(system), 3 * item.sea.omega  # among the modes' own
    Y, (nm, n) = impedance(system, h, item.sea.omega), (system.structure.omega.size, len(model.mass))
    random = np.random.default_rng(2)
    force = random.normal(size=(omega.size, n)) + 1j * random.normal(size=(omega.size, n))
    mix, damping = random.normal(size=(nm, nm)), np.zeros((n, n))
    damping[:nm, :nm] = 0.05 / nm * mix @ mix.T
    damping[nm:, nm:] = 0.01 * np.diag(np.diag(model.mass)[nm:])
    equation = Condensed(model, omega, Y, damping[:nm, :nm])
    assert 0 < equation.stiff.size < nm
    X = np.zeros((n, omega.size), complex)
    for _ in range(20):
        X = equation.response(force.T + equation.apart(damping) @ (1j * omega * X), damping)
    Z = model.dynamic_stiffness(omega, Y) - 1j * omega[:, None, None] * damping
    exact = np.linalg.solve(Z, force[..., None])[..., 0]
    assert np.all(np.abs(X.T - exact) < 1e-9 * np.abs(exact).max(axis=0))
    assert not Condensed(model, omega, Y, 1e4 * damping[:nm, :nm]).stiff.size


def test_coordinates_that_only_others_hold_are_solved_for():
    """At a resonance without damping nothing is left on the diagonal; waves beside it, and others', are not harmed."""
    random, (nw, nz, nk) = np.random.default_rng(4), (LANES + 3, 4, 2)
    Z = random.normal(size=(nk, nk)) + 0.1 * random.normal(size=(nw, nk, nk)) + 0j
    Lambda, f, g = (random.normal(size=n) + 0j for n in ((nw, nz, nz), (nk, nw), (nz, nw)))
    Z[0, range(nk), range(nk)], Z[1] = 0.0, [[1, 2], [2, 4]]  # of no rounding
    T, x, z = random.normal(size=(nz, nk)), f.copy(), g.copy()
    omega, arrays = np.ones(_lanes(nw).shape), (_side_by_side(Z), np.zeros((nk, nk)), _side_by_side(Lambda))
    condensed._solve(omega, *arrays, T, x, z)
    assert np.isnan(x[:, 1]).all()
    for w in (0, *range(2, nw)):
        exact = np.linalg.solve(Z[w], f[:, w] - T.T @ Lambda[w] @ g[:, w])
        assert np.allclose(x[:, w], exact, rtol=1e-12)
        assert np.allclose(z[:, w], Lambda[w] @ (T @ exact + g[:, w]), rtol=1e-12)


def test_scenes_that_differ_in_their_dampers_alone_share_a_case():
    item, h = SCENES["duck"]()
    item = linear(item, method="frequency")

    def changed(**changes):
        return replace(item, floats=(replace(item.floats[0], **changes),))

    usual = case_of(item, h)
    assert case_of(changed(pto_damping=1.0, damping=2.0, quadratic_damping=3.0), h) is usual
    others = {"stiffness": 1.0, "coulomb": 1.0, "force_limit": 1e9, "mechanism_inertia": 1.0, "mass": 1e5}
    assert all(case_of(changed(**{name: value}), h) is not usual for name, value in others.items())
    assert case_of(replace(item, sea=sea(seed=9)), h) is not usual


def test_drag_agrees_with_its_own_result(monkeypatch):
    """Rounds that end early are as exact as they say; changes that each are a third of the last add up to its half."""
    bare, _ = SCENES["bare_legs"]()
    item = linear(bare, method="frequency")
    soon = respond(item, None)
    monkeypatch.setattr(response, "AGREED", 1e-13)
    exact = respond(item, None)
    std, known = (np.linalg.norm(r.X, axis=0) for r in (soon, exact))
    assert 3 <= soon.rounds < exact.rounds
    assert np.all(np.abs(std - known) < 1e-5 * known)
    assert response._ahead(0.9, 0.3) == approx(0.15)
    assert response._ahead(0.3, 0.3) == response._ahead(np.inf, 1.0) == response._ahead(1e4, 0.1) == np.inf


def test_quadratic_damping_of_a_joint_is_the_marchs():
    item, h = SCENES["duck"]()
    item = linear(
        replace(item, floats=(replace(item.floats[0], quadratic_damping=3e6, pto_damping=0.0),)), duration=2000.0
    )
    item = replace(item, sea=replace(item.sea, amplitude=0.1 * item.sea.amplitude))
    exact, table = (r.variables["rotation"][1][0, 4] for r in (simulate(item, h), frequency(item, h)))
    assert table == approx(exact, rel=5e-3)


@pytest.mark.parametrize("scene", ["model_scale", "duck"])
@pytest.mark.parametrize("quadratic", [10.0, 3e4, 3e8])
def test_a_damper_that_is_all_that_holds_agrees_with_its_own_result(scene, quadratic):
    """In a few rounds: by itself it lets a float move too much, then too little, and to and fro."""
    item, h = SCENES[scene]()
    (body,), size = item.floats, item.floats[0].mass
    bent = replace(item, floats=(replace(body, quadratic_damping=quadratic * size),))
    lines = respond(linear(bent, method="frequency"), h)
    rate = np.sqrt(0.5 * np.sum(np.abs(lines.omega[:, None] * lines.Z) ** 2, axis=0))[0]
    damping = quadratic * size * np.sqrt(8 / np.pi) * rate * (1 + lines.excess[0] / 8)
    alike = replace(item, floats=(replace(body, damping=damping),))
    assert approx(respond(linear(alike, method="frequency"), h).Z, rel=3e-3) == lines.Z
    assert lines.rounds < 12


def test_what_a_mesh_does_is_what_it_does_to_the_damped_motion():
    """Quadratic damping counts in it, as the linear one that it is like."""
    item, h = SCENES["duck"]()
    (body,), quadratic = item.floats, 3e6
    bent = replace(item, floats=(replace(body, quadratic_damping=quadratic),))
    lines = respond(linear(bent, method="frequency"), h)
    rate = np.sqrt(0.5 * np.sum(np.abs(lines.omega * lines.Z[:, 0]) ** 2))
    damping = quadratic * np.sqrt(8 / np.pi) * rate * (1 + lines.excess[0] / 8)
    alike = replace(item, floats=(replace(body, damping=damping),))
    told, exact, without = (frequency(one, h).attrs["mesh_effect"] for one in (bent, alike, item))
    assert told == approx(exact, rel=1e-3)
    assert exact == approx(simulate(linear(alike), h).attrs["mesh_effect"], rel=1e-6)
    assert abs(without / exact - 1) > 0.1


@pytest.mark.parametrize("law", [{"coulomb": 500.0}, {"pto_damping": 1.2e5, "force_limit": 700.0}])
def test_a_bent_power_take_off_takes_the_marchs_power(law):
    """Statistically linearised: as much power from a Gaussian rate; the rate of a bent one is not quite Gaussian."""
    item, h = SCENES["duck"]()
    linear_pto = {"pto_damping": 0.0, "coulomb": 0.0} | law
    item = linear(replace(item, floats=(replace(item.floats[0], **linear_pto),)), duration=2000.0)
    item = replace(item, sea=replace(item.sea, amplitude=0.1 * item.sea.amplitude))
    march, lines = simulate(item, h), frequency(item, h)
    for name, column, allowed in (("rotation", 4, 0.08), ("absorbed_power", 2, 0.05)):
        exact, table = (r.variables[name][1][0, column] for r in (march, lines))
        assert table == approx(exact, rel=allowed), name
    bare = linear(replace(item, floats=(replace(item.floats[0], coulomb=0.0, force_limit=np.inf),)), duration=2000.0)
    (unbent,) = frequency(bare, h).variables["rotation"][1][:, 4]
    assert abs(unbent / march.variables["rotation"][1][0, 4] - 1) > 0.1


def test_extremes_are_within_what_a_law_allows_and_strokes_are_told():
    """Of a Gaussian rate the mean size is 0.8 of the std; a linear model does not know of a limit."""
    item, h = SCENES["duck"]()
    law = replace(item.floats[0], pto_damping=1.2e5, coulomb=0.0, force_limit=700.0)
    item = linear(replace(item, floats=(law,)), duration=2000.0, outputs=("pto_force", "pto_stroke"))
    march, lines = simulate(item, h).variables, frequency(item, h).variables
    force, power = lines["pto_force"][1][0, 0], lines["absorbed_power"][1][0]
    assert force[:2].tolist() == [700.0, -700.0]
    fastest = lines["pto_rate"][1][0, 0, 0]  # in one sense; in either it is some per cent more
    assert 700.0 * fastest < power[0] < 1.1 * 700.0 * fastest
    for name in ("pto_stroke", "pto_travel"):
        assert lines[name][0] == march[name][0]
        assert lines[name][1] == approx(march[name][1], rel=0.25), name


@pytest.mark.parametrize("share", [0.9, 0.99, 1.01, 1.1])
def test_friction_that_just_holds_agrees_with_its_own_result(share):
    """F = 4/π F_c at one frequency: next to it each round of the plain iteration leaves nearly the same."""
    item, h = SCENES["duck"]()
    item = replace(item, sea=regular(height=0.02, period=3.0))
    stiff = frequency(replace(item, floats=(replace(item.floats[0], pto_damping=1e12),)), h, outputs=("pto_force",))
    most = stiff.variables["pto_force"][1][0, 0, 0] * np.pi / 4
    body = replace(item.floats[0], pto_damping=0.0, coulomb=share * most)
    told = frequency(replace(item, floats=(body,)), h)
    free = frequency(replace(item, floats=(replace(body, coulomb=0.0),)), h)
    moves = told.variables["rotation"][1][0, 4] / free.variables["rotation"][1][0, 4]
    assert (moves > 1e-3) == (share < 1) and moves < 1


def test_an_axis_that_friction_locks_has_an_answer():
    """What moves less than a millionth of the waves is held, and bears what a stiff axis does."""
    item, h = SCENES["duck"]()
    (body,) = item.floats
    locked, stiff = (replace(body, **law) for law in ({"coulomb": 1e9}, {"stiffness": 1e12}))
    told, exact = (
        frequency(replace(item, floats=(one,)), h, outputs=("pto_force",)).variables for one in (locked, stiff)
    )
    assert told["rotation"][1][0, 4] < 1e-6
    force = told["hinge_force"][1], exact["hinge_force"][1]
    assert force[0] == approx(force[1], rel=1e-3, abs=1e-3 * np.abs(force[1]).max())


def test_one_wave_is_a_harmonic_not_a_gaussian():
    item, h = SCENES["flap"]()
    item = replace(item, sea=regular(height=0.02, period=6.0))
    march = simulate(linear(item, duration=60.0, discard=120.0, ramp=60.0), h)
    lines = frequency(item, h)
    for key in ("rotation", "absorbed_power", "hinge_force"):
        exact, table = (r.variables[key][1].reshape(-1, 5) for r in (march, lines))
        spread = exact[:, 4].max()
        assert table == approx(exact, abs=0.02 * max(spread, np.ptp(exact[:, :2], axis=1).max())), key


def test_motions_per_wave():
    """RAO in the frequency domain: what the model responds with to a wave of 1 m."""
    item, h = SCENES["duck"]()
    record = frequency(item, h, rao=True)
    one = replace(item, sea=regular(height=2.0, period=2 * np.pi / item.sea.omega[20]))
    lines = respond(linear(one, method="frequency"), h)
    assert record.variables["rao"][1][0, 0, 20] == approx(abs(lines.Z[0, 0]))


def test_spectra_of_a_linear_march_are_those_of_the_lines():
    """Cross-spectra of a quarter of an hour: every output's response, coherence near one, spectrum."""
    item, h = SCENES["duck"]()
    small = replace(item, sea=replace(item.sea, amplitude=item.sea.amplitude / 20))
    march = simulate(linear(small, spectra=True, duration=900.0), h).variables
    lines = frequency(small, h, spectra=True, duration=900.0).variables
    assert "absorbed_power_coherence" in march and "absorbed_power_coherence" not in lines
    waves = lines["wave_elevation_spectrum"][1]
    some = waves > 0.05 * waves.max()
    for key in ("rotation", "hinge_force"):
        H = [v[f"{key}_response"][1] * np.exp(1j * v[f"{key}_response_phase"][1]) for v in (march, lines)]
        assert H[0][..., some] == approx(H[1][..., some], abs=0.05 * np.nanmax(np.abs(H[1])))
        S = [v[f"{key}_spectrum"][1][..., some] for v in (march, lines)]
        assert S[0].sum() == approx(S[1].sum(), rel=0.05)
        # Where the response changes within a band, as it does where it nearly vanishes, neither of them is one.
        coherence = [v[f"{key}_coherence"][1][..., some] for v in (march, lines)]
        assert coherence[0] == approx(coherence[1], abs=0.03, nan_ok=True)
    assert march["rotation_coherence"][1][..., some][..., :10].min() > 0.99
    assert lines["rotation_response"][0] == ("float", "frequency_band")


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"froude_krylov": "body-nonlinear"}, 'froude_krylov = body-nonlinear: needs "linear" or "none" with method'),
        ({"keep_series": True}, "keep_series = True: needs to be left out with method"),
        ({"formulation": "augmented"}, 'settings.formulation = augmented: needs "minimal" with method'),
        ({"memory": "convolution"}, 'settings.memory = convolution: needs "state-space" with method'),
        ({"surface": "panels"}, 'settings.surface = panels: needs "quadrature" with method'),
        ({"accuracy": "reference"}, 'settings.accuracy = reference: needs "standard" with method'),
    ],
)
def test_what_no_linear_response_gives_is_refused(changes, message):
    """By what was written, and by that alone."""
    with pytest.raises(InputError, match=message) as caught:
        Settings(**({"method": "frequency", "froude_krylov": "linear"} | changes))
    assert not caught.value.others


def test_a_tolerance_is_met_or_said_not_to_be():
    item, h = SCENES["duck"]()
    loose, strict = (linear(item, method="frequency", tolerance=asked) for asked in (0.1, 1e-6))
    told = [simulate(each, h).attrs for each in (loose, strict)]
    assert told[0]["unmet"] == "" and told[0]["estimated_error"] < 0.1
    assert told[1]["unmet"].startswith("tolerance = 1e-06: the estimated error is")


@pytest.mark.parametrize("waves", [1, 3])
def test_what_does_not_radiate_responds(waves):
    """Of a hinged float in one wave and in several, the march's std."""
    item, h = SCENES["flap"]()
    few = np.arange(item.sea.omega.size) % (item.sea.omega.size // waves) == item.sea.omega.size // (2 * waves)
    sea = replace(item.sea, omega=item.sea.omega[few], amplitude=item.sea.amplitude[few] / 50)
    settings = replace(item.settings, radiation=False, time_step=None)
    quiet = replace(item, sea=sea, settings=settings, floats=tuple(replace(f, pto_damping=3e8) for f in item.floats))
    lines, march = frequency(quiet, h, duration=600.0), simulate(linear(quiet, duration=600.0, discard=200.0), h)
    std = [record.variables["rotation"][1][..., 4] for record in (lines, march)]
    assert std[0] == approx(std[1], rel=0.02)


def test_still_water_has_no_response():
    item, h = SCENES["duck"]()
    with pytest.raises(InputError, match="needs waves"):
        frequency(scene(item.floats, waves=replace(item.sea, amplitude=0 * item.sea.amplitude)), h)


def test_a_wave_at_which_nothing_holds_the_scene_is_named():
    """A spring and a mass alone, in their resonance."""
    item, h = SCENES["flap"]()
    calm = linear(
        replace(item, floats=(replace(item.floats[0], pto_damping=0.0),)), method="frequency", radiation=False
    )
    model = linear_model(prepare(calm, h))
    resonance = float(np.sqrt(model.stiffness[0, 0] / model.mass[0, 0]))
    near = replace(calm, sea=regular(height=0.1, period=2 * np.pi / resonance))
    with pytest.raises(SimulationFailed, match=f"singular at a wave of {resonance:.4g} rad/s"):
        simulate(near, h)


@pytest.mark.parametrize("name", ["duck", "soft_mooring"])
def test_what_a_stationary_response_makes_no_use_of_is_said(name):
    """Of one axis, and of one of several."""
    item, h = SCENES[name]()
    (body,) = item.floats
    offset = 0.1 if len(body.motion) == 1 else (0.0, 0.3, 0.0)
    usual = frequency(item, h)
    given = frequency(replace(item, floats=(replace(body, offset=offset),)), h, time_step=0.05)
    added = given.attrs["skipped"].removeprefix(usual.attrs["skipped"])
    assert [text.split(":")[0] for text in added.split("; ")[1:]] == [f"floats.{body.name}.offset", "time_step"]
    for key, (_, values) in usual.variables.items():
        assert np.array_equal(values, given.variables[key][1], equal_nan=values.dtype.kind == "f"), key


@pytest.mark.parametrize("name", ["oblique", "big_beside_small", "unequal_legs"])
def test_a_wave_group_is_told_as_it_is(name):
    """Waves of known phases that meet: what a march's record has, of power's std and of extremes, too."""
    scene, h = SCENES[name]()
    omega = 1.0 + 0.05 * np.arange(25)
    height = 0.002 * np.exp(-(((omega - 1.5) / 0.4) ** 2))
    group = components(amplitude=height, omega=omega, phase=omega * 90.0, heading=scene.sea.heading)
    settings = replace(scene.settings, froude_krylov="linear", duration=80.0, discard=60.0, ramp=20.0)
    scene = replace(scene, sea=group, settings=settings)
    march, told = simulate(scene, h), simulate(replace(scene, settings=replace(settings, method="frequency")), h)
    for of in ("wave_elevation", "rotation", "motion", "absorbed_power", "hinge_force", "top_displacement"):
        if of in march.variables:
            exact, ours = (r.variables[of][1] for r in (march, told))
            size = np.nanmax(exact[..., 4], initial=0.0)
            used = exact[..., 4] > 0.02 * size
            assert ours[used] == approx(exact[used], rel=0.02, abs=0.02 * size)
    assert told.variables["wave_elevation"][1][0] == approx(height.sum(), rel=0.01)


def test_lines_that_no_wave_makes_widen_the_sum_of_those_of_waves():
    omega = np.array([0.5, 0.75, 3.1])
    X = np.array([[1.0, 0], [2j, 1e-9], [0.5, 1.0]])
    of = Process(omega, 8 * np.pi * 40, others=1, begin=3.0)
    t = of.begin + 2 * np.pi / 0.75 / 16 * np.arange(3)
    values = of.sampled(X)
    sum_of_waves = np.cos(0.5 * t) + 2 * np.sin(0.75 * t)
    assert values[:3, 0] == approx(sum_of_waves * np.sqrt(5.25 / 5))
    assert values.std(axis=0) == approx([np.sqrt(5.25 / 2), np.sqrt(0.5)], rel=1e-3)
    told, random = (gaussian.table(np.ones(2), X, process) for process in (of, Process(omega, of.duration)))
    assert told[0] == approx(gaussian.tabulated([1 + values])[0]) and told[1] == approx(random[1])


@pytest.mark.parametrize(("Hs", "said"), [(1.3, "beyond its freeboard of 0.6 m"), (1.1, ""), (2.2, "0.6 m")])
def test_a_surface_that_moves_past_an_end_of_a_hull_is_told(Hs, said):
    """By half the significant height past what a damper holds: past what follows long waves by next to nothing."""
    item, h = SCENES["oblique"]()
    waves = sea(Hs=Hs, heading=np.pi / 6)
    size = 2 * gaussian.spread(waves.amplitude[:, None])[0]
    held = replace(item, sea=waves, floats=tuple(replace(f, pto_damping=1e12) for f in item.floats))
    told = frequency(held, h).attrs.get("warnings", "")
    assert (f"by {size:.3g} m, beyond" in told) == bool(said) and said in told
    of = case_of(linear(held, method="frequency"), h)
    past = surface_past(of.system, of.met, respond(linear(held, method="frequency"), h).Z)
    assert past == approx(size, rel=1e-3)
    ball, known = SCENES["soft_mooring"]()
    free = linear(replace(ball, sea=regular(height=4.0, period=18.0, heading=0.0)), method="frequency")
    of = case_of(free, known)
    assert surface_past(of.system, of.met, respond(free, known).Z) < 0.2  # of 2 m


def test_of_a_long_hull_that_pitches_the_ends_are_looked_at():
    """A box of 16 m by its pitch alone, and following a wave as long as 12 of it by its height and slope."""
    hull = box(length=16.0, width=5.0, height=1.5, draft=1.0)
    mass, free = 1025 * hull.volume, {"motion": ("heave", "pitch"), "damping": (5e3, 5e4)}
    long = Float(name="long", hull=hull, mass=mass, inertia=(4e5, 1.6e6, 1.8e6), hinge=(0.0, 0.0, 0.0), **free)
    alone = {"radiation": False, "diffraction": False, "froude_krylov": "linear"}
    item = scene((long,), waves=regular(height=2.0, period=11.0, heading=0.0), **alone)
    system = prepare(item, known(item, 0.3, 3.0, 5))
    one, surface = np.ones(1, bool), _waterplane(system).surface
    assert surface_past(system, one, np.array([[0.0, 5.0]])) == approx(8 * 5.0, rel=0.03)  # beside the wave's 1 m
    slope = (surface[0, 1] - surface[0, 2]) / 16
    assert abs(slope) == approx((2 * np.pi / 11) ** 2 / 9.81, rel=0.05)  # of deep water
    assert surface_past(system, one, np.array([[surface[0, 0], -slope]])) < 0.06


def test_linear_marches_tell_it_too_and_those_with_the_whole_hull_do_not():
    item, h = SCENES["oblique"]()
    held = replace(item, sea=regular(height=1.4, period=6.0, heading=np.pi / 6))
    held = replace(held, floats=tuple(replace(f, pto_damping=1e9) for f in item.floats))
    for method, pressure, told in (("frequency", "linear", 1), ("time", "linear", 1), ("time", "body-nonlinear", 0)):
        settings = replace(item.settings, method=method, froude_krylov=pressure, duration=12.0, discard=12.0, ramp=6.0)
        said = simulate(replace(held, settings=settings), h).attrs.get("warnings", "")
        assert said.count("the wave moves the surface past it, or past a side of it, by 0.7 m, beyond") == told * 2


def test_each_end_of_a_hull_is_named():
    item, _ = SCENES["oblique"]()
    hulls = [
        item.floats[0].hull,
        Revolution.vertical_cylinder(radius=1.0, draft=0.4, freeboard=0.9),
        ring(((0.2, -3.0), (1.0, -3.0), (1.0, -0.7), (0.2, -0.7))),
    ]
    floats = [replace(item.floats[0], hull=hull) for hull in hulls]
    told = list(bared(floats, np.array([0.65, 0.45, 0.75]), 9))
    ends = ("freeboard of 0.6 m", "draft of 0.4 m", "top's depth of 0.7 m")
    assert [end in words for words, end in zip(told, ends, strict=True)] == [True] * 3
    assert not list(bared(floats, np.array([0.55, 0.35, 0.65]), 9))
