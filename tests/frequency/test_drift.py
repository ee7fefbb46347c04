"""Mean and slow drift of rotors on a moored barge, waves aslant, and of one axis in closed form."""

from dataclasses import replace
from functools import cache
from types import SimpleNamespace

import numpy as np
import pytest
from pytest import approx

from solver.errors import InputError
from solver.frequency import drift
from solver.frequency.case import case_of
from solver.frequency.response import respond
from solver.hydrodynamics.bem import bem, far_field
from solver.hydrodynamics.hull.revolution import Revolution
from solver.run import simulate
from solver.scene import Float
from solver.sea.realization import realize
from solver.sea.spectrum import PiersonMoskowitz
from tests.awkward import duck, rotors, scene, sea

HEADING = 0.5
ALL = ("surge", "sway", "heave", "roll", "pitch", "yaw")
MOORED = {"motion": ALL, "stiffness": (4e4, 5e4, 0, 0, 0, 3e6), "damping": (4e3, 5e3, 1e3, 1e4, 1e4, 2e5)}


def drifting(heading, **changes):
    item = rotors(**(MOORED | changes))
    waves = sea(Hs=1.0, Tp=6.0, band=(0.7, 1.7), heading=heading)
    settings = replace(item.settings, method="frequency", rao=True, outputs=("drift",), duration=3600.0)
    return replace(item, sea=waves, settings=settings)


@cache
def coefficients():
    """For waves aslant from both sides."""
    floats, omega = rotors().floats, np.linspace(0.65, 1.75, 7)
    problem = bem.Problem.of(
        tuple(f.hull for f in floats), np.array([f.centre for f in floats]), depth=np.inf, omega=omega,
        headings=(HEADING, -HEADING), planar=False, panels=200, far_field=True,
    )  # fmt: skip
    return bem.united(problem, [bem.part(problem)])


@cache
def records():
    return [simulate(drifting(b), h) for b, h in zip((HEADING, -HEADING), coefficients(), strict=True)]


def afloat(added):
    """Impedance of a constant added mass."""
    return lambda mu: -1j * mu[:, None, None] * added


@pytest.mark.slow
def test_energy_far_off_is_that_of_rotors_and_dampers():
    """To the error of a coarse mesh of the barge, whose edges count: 2 %, and 1.2 % with twice as many panels."""
    record = records()[0]
    assert record.attrs["energy_residual"] < 0.03
    item, h = drifting(HEADING), coefficients()[0]
    response = respond(item, h)
    rate = np.abs(response.omega[:, None] * response.Z) ** 2 / 2
    damping = np.array([*MOORED["damping"], 4e4, 6e4])
    assert np.sum(drift.waves_of(case_of(item, h), response).absorbed_power) == approx(np.sum(rate @ damping), rel=0.04)


def test_energy_that_one_wave_lacks_makes_up_for_none_that_another_has():
    item, h = drifting(HEADING), coefficients()[0]
    case, response = case_of(item, h), respond(item, h)
    waves, off = drift.waves_of(case, response), np.zeros(response.omega.size)
    off[:2] = 10 * waves.outgoing_power.sum() * np.array([1, -1])
    wrong = SimpleNamespace(absorbed_power=waves.absorbed_power + off, outgoing_power=waves.outgoing_power)
    assert drift.energy_residual(case, response, wrong) == approx(20.0, rel=0.02)


def test_the_moment_is_about_the_supports_joint():
    """As of the same waves seen from there: H exp(ik d·e) of modes whose origin is d further on."""
    item, h = drifting(HEADING), coefficients()[0]
    waves = drift.waves_of(case_of(item, h), respond(item, h))
    d, k = np.subtract([0.5, 0.0], h.far_field.origin), waves.omega[:, None] ** 2 / 9.81
    m = np.arange(waves.modes.shape[1]) - waves.modes.shape[1] // 2
    angle = 2 * np.pi * np.arange(m.size) / m.size
    H = (
        waves.modes
        @ np.exp(1j * np.outer(m, angle))
        * np.exp(1j * k * (np.stack([np.cos(angle), np.sin(angle)], -1) @ d))
    )
    there = waves.amplitude * np.exp(1j * k[:, 0] * (d @ [np.cos(HEADING), np.sin(HEADING)]))
    about = replace(waves, modes=far_field.modes(H), amplitude=there).drift_moment.sum()
    assert records()[0].attrs["drift_moment"] == approx(about, rel=1e-3)
    assert abs(about - waves.drift_moment.sum()) > 0.02 * abs(about)


@pytest.mark.slow
def test_drift_turns_with_the_waves():
    """From the other side: the same along x, the opposite across and about the vertical."""
    one, other = records()
    (fx, fy, _), (gx, gy, _) = (r.variables["drift_force"][1] for r in (one, other))
    assert gx == approx(fx, rel=1e-6) and gy == approx(-fy, rel=1e-6) and fy > 0.1 * fx > 0
    assert other.attrs["drift_moment"] == approx(-one.attrs["drift_moment"], rel=1e-6)
    assert abs(one.attrs["drift_moment"]) > 0.1 * fx


def test_offset_is_that_of_the_mooring():
    record = records()[0]
    force, per_wave = (record.variables[name][1] for name in ("drift_force", "drift_force_per_wave"))
    amplitude = np.abs(drifting(HEADING).sea.amplitude)
    assert force[:2] == approx(per_wave[:2] @ amplitude**2)
    offset, std = (record.variables[name][1] for name in ("drift_offset", "slow_drift"))
    at = [list(record.coords["axis"]).index(name) for name in ("surge", "sway", "yaw")]
    loads = np.array([*force[:2], record.attrs["drift_moment"]])
    assert offset[0, at] == approx(loads / [4e4, 5e4, 3e6])
    assert np.all(std[0, at] > 0.2 * np.abs(offset[0, at])) and record.attrs["unmet"] == ""
    assert np.isnan(np.delete(offset[0], at)).all() and np.isnan(offset[1:]).all()


def test_the_force_of_each_wave_is_told_of_bodies_that_are_fixed():
    """Two that differ, waves aslant, one of them without height: the parts are those of the sum, by their frequency."""
    pillar = Revolution.vertical_cylinder(radius=2.0, draft=3.0, freeboard=2.0)
    first = Float(name="pillar", hull=pillar, mass=4e4, inertia=(9e3,) * 3, hinge=(-6.0, 1.0, 0), motion=())
    floats = (first, replace(duck()[0].floats[0], motion=(), pto_damping=0.0))
    waves = sea(band=(0.8, 2.0), heading=HEADING)
    waves = replace(waves, amplitude=np.where(np.arange(60) == 7, 0.0, waves.amplitude))
    item = scene(
        floats, depth=np.inf, waves=waves, method="frequency", froude_krylov="linear", rao=True, outputs=("drift",)
    )
    h = bem.solve(
        tuple(f.hull for f in floats), np.array([f.centre for f in floats]), depth=np.inf, heading=HEADING,
        omega=np.linspace(0.7, 2.1, 5), planar=False, panels=108, far_field=True,
    )  # fmt: skip
    record = simulate(item, h)
    told, dims = record.variables["drift_force_per_wave"][1], record.variables["drift_force_per_wave"][0]
    assert record.variables["wave_frequency"][1] == approx(waves.omega) and dims == ("direction", "component")
    assert list(record.coords["component"]) == list(range(1, 61)) and "rao" not in record.variables
    assert np.flatnonzero(np.isnan(told[0])).tolist() == [7]
    force = np.nansum(told * np.abs(waves.amplitude) ** 2, axis=1)[:2]
    assert force == approx(record.variables["drift_force"][1][:2]) and np.all(force > 0)


def test_a_tolerance_not_met_is_said_beside_the_drift():
    item = drifting(HEADING)
    strict = replace(item, settings=replace(item.settings, tolerance=1e-6))
    assert simulate(strict, coefficients()[0]).attrs["unmet"].startswith("tolerance = 1e-06: ")


@pytest.mark.parametrize("slowest", [0.05, 0.15])
def test_slow_drift_of_one_axis_is_that_of_all_pairs_of_waves(slowest):
    """σ² = Σ 2|aᵢaⱼTᵢⱼ|²/|C - μ²M - iμD|² over all pairs, μ = ωᵢ - ωⱼ, where S_F is level, and where it falls."""
    waves = realize(PiersonMoskowitz(Hs=3.0, Tp=8.0), components=600, band=(0.4, 2.0), seed=1, intervals="even")
    M, C = 1.6e7, 1.6e7 * slowest**2
    T = 3e4 * (waves.omega - 0.6)  # of both signs, and of none in the mean of two
    D = 0.2 * M * slowest  # 10 % of critical
    a2 = np.abs(waves.amplitude) ** 2
    i, j = np.triu_indices(a2.size, 1)
    mu = waves.omega[j] - waves.omega[i]
    exact = np.sqrt(np.sum(2 * a2[i] * a2[j] * (T[i] + T[j]) ** 2 / 4 / np.abs(C - mu**2 * M - 1j * mu * D) ** 2))
    model = SimpleNamespace(
        length=np.ones(2), stiffness=np.diag([1.0, C]), damping=np.diag([1.0, D]), mass=np.diag([1.0, 0.3 * M])
    )
    slow = drift.slow_load(waves.omega, waves.amplitude, (T * a2)[:, None], 3600.0)
    level = np.sum(2 * a2[i] * a2[j] * (T[i] + T[j]) ** 2 / 4)
    assert np.trapezoid(slow.power[:, 0, 0], slow.mu) == approx(level, rel=0.01)
    mean, std, unmet = drift.moved(model, np.array([1]), afloat(np.diag([0.0, 0.7 * M])), np.array([T @ a2]), slow)
    assert mean[0] == approx(T @ a2 / C) and not unmet
    assert std[0] == approx(exact, rel=0.03)


def test_slow_loads_of_many_waves_are_the_sums_over_their_pairs():
    """Each with each, itself too, by the band about their distance; of two loads that go together."""
    waves, width = realize(PiersonMoskowitz(Hs=3.0, Tp=8.0), components=60, band=(0.4, 2.0), seed=3), None
    w, a2 = waves.omega, np.abs(waves.amplitude) ** 2
    T = np.stack([3e4 * w**2, 1e4 * (1.2 - w)], axis=1)
    slow = drift.slow_load(w, waves.amplitude, T * a2[:, None], 3600.0)
    width = slow.mu[1]
    both = 0.5 * (T[:, None] + T) * np.sqrt(np.outer(a2, a2))[:, :, None]
    for mu, found in zip(slow.mu[::7], slow.power[::7], strict=True):
        apart = w[:, None] - w
        g = np.exp(-0.5 * ((apart - mu) / width) ** 2) + np.exp(-0.5 * ((apart + mu) / width) ** 2)
        exact = np.einsum("ij,ijk,ijl->kl", g / (width * np.sqrt(2 * np.pi)), both, both)
        assert found == approx(exact, abs=1e-3 * np.abs(slow.power).max())


@pytest.mark.parametrize("omega", [[1.5, 2.0], [1.0, 1.143], [0.9, 1.4, 1.1, 1.55]])
def test_few_waves_drift_as_their_pairs_do(omega):
    """On the resonance, 0.143 rad/s, and off it: the force of one wave is steady, and no pair has a band."""
    w, C, M, D = np.array(omega), 1e5, 1e5 / 0.143**2, 1e6
    a, T = 0.1 * np.exp(1j * w), 3e4 * (w - 0.6)
    i, j = np.triu_indices(w.size, 1)
    H = 1 / np.abs(C - (w[j] - w[i]) ** 2 * M - 1j * (w[j] - w[i]) * D)
    exact = np.sqrt(np.sum(0.5 * (np.abs(a[i] * a[j]) * (T[i] + T[j]) * H) ** 2))
    model = SimpleNamespace(length=np.ones(1), stiffness=np.diag([C]), damping=np.diag([D]), mass=np.diag([M]))
    slow = drift.slow_load(w, a, (T * np.abs(a) ** 2)[:, None], 3600.0)
    _, std, _ = drift.moved(model, np.array([0]), afloat(np.zeros((1, 1))), np.array([1.0]), slow)
    assert std[0] == approx(exact, rel=1e-9)


def test_few_waves_of_a_spectrum_drift_as_many():
    """Waves further apart than the resonance, 0.04 rad/s, stand for others beside them."""
    M, zeta, found = 1.6e7, 0.15, []
    model = SimpleNamespace(
        length=np.ones(1), stiffness=np.diag([M * 0.04**2]), damping=np.diag([2 * zeta * 0.04 * M]), mass=np.diag([M]),
    )  # fmt: skip
    for count in (24, 40, 1500):
        waves = realize(PiersonMoskowitz(Hs=3.0, Tp=8.0), components=count, band=(0.5, 2.2), seed=1)
        a2 = np.abs(waves.amplitude) ** 2
        slow = drift.slow_load(waves.omega, waves.amplitude, (3e4 * waves.omega**2 * a2)[:, None], 3600.0)
        found.append(drift.moved(model, np.array([0]), afloat(np.zeros((1, 1))), np.array([1.0]), slow)[1][0])
    assert found == approx([found[-1]] * 3, rel=0.1)


def test_two_axes_drift_as_each_would_along_its_own():
    """Turned by 30 degrees, so that mooring and force couple them."""
    c, s = np.cos(np.pi / 6), np.sin(np.pi / 6)
    R, mu = np.array([[c, -s], [s, c]]), np.linspace(0, 1.0, 21)
    C, D, M, S = np.diag([4e4, 9e4]), np.diag([8e3, 2e4]), np.diag([1e6, 1.2e6]), np.diag([3e9, 5e8])
    spectrum = np.exp(-3 * mu)[:, None, None] * S
    own = SimpleNamespace(length=np.ones(2), stiffness=C, damping=D, mass=M)
    turned = SimpleNamespace(length=np.ones(2), stiffness=R @ C @ R.T, damping=R @ D @ R.T, mass=R @ M @ R.T)
    both, none = np.arange(2), afloat(np.zeros((2, 2)))
    mean, std, _ = drift.moved(own, both, none, np.array([3e4, 1e4]), drift.SlowLoad(mu, spectrum, False))
    other, turned_std, _ = drift.moved(
        turned, both, none, R @ [3e4, 1e4], drift.SlowLoad(mu, R @ spectrum @ R.T, False)
    )
    assert other == approx(R @ mean) and turned_std**2 == approx(np.diag(R @ np.diag(std**2) @ R.T), rel=1e-3)


def test_axes_without_a_load_of_their_own_follow():
    """As surge and pitch of a hull held below its centre of gravity do, where both are told and one is loaded."""
    own = SimpleNamespace(
        length=np.ones(2), stiffness=np.array([[2e4, 1.8e5], [1.8e5, 4e6]]), damping=np.diag([4e3, 9e4]),
        mass=np.array([[7e5, 9e5], [9e5, 3e7]]),
    )  # fmt: skip
    mu, none = np.linspace(0, 1.0, 21), afloat(np.zeros((2, 2)))
    slow = np.exp(-3 * mu)[:, None, None] * np.array([[3e9]])
    mean, std, _ = drift.moved(own, np.array([0]), none, np.array([3e3]), drift.SlowLoad(mu, slow, False))
    both = drift.moved(
        own, np.arange(2), none, np.array([3e3, 0.0]), drift.SlowLoad(mu, slow * np.diag([1.0, 0.0]), False)
    )
    assert mean[0] == approx(both[0][0], rel=1e-9) and std[0] == approx(both[1][0], rel=1e-9)
    assert mean[0] > 1.5 * 3e3 / 2e4


def test_what_nothing_holds_or_damps_has_no_drift():
    none, slow = np.zeros((2, 2)), drift.SlowLoad(np.arange(3.0), np.ones((3, 1, 1)), False)
    model = SimpleNamespace(length=np.ones(2), stiffness=none, damping=none, mass=np.eye(2))
    mean, std, unmet = drift.moved(model, np.array([0]), afloat(none), np.array([3.0]), slow)
    assert np.isnan([*mean, *std]).all() and "nothing holds" in unmet
    model.stiffness = np.eye(2)
    mean, std, unmet = drift.moved(model, np.array([0]), afloat(none), np.array([3.0]), slow)
    assert mean == approx(3.0) and np.isnan(std).all() and "nothing damps" in unmet
    one = drift.SlowLoad(np.zeros(1), np.zeros((1, 1, 1)), True)
    assert drift.moved(model, np.array([0]), afloat(none), np.array([3.0]), one) == (approx(3.0), approx(0.0), "")


def test_an_axis_that_no_load_reaches_need_be_neither_held_nor_damped():
    """Yaw of a round buoy, whose mesh is turned by 1e-5 of the force times its length; where yaw is coupled to what is
    loaded it counts, whatever loads it has."""
    loaded, slow = np.diag([1.0, 0.0]), np.exp(-np.arange(3.0))[:, None, None] * np.diag([1e6, 1e-2])
    model = SimpleNamespace(
        length=np.array([1.0, 10.0]), stiffness=2e4 * loaded, damping=4e3 * loaded, mass=1e5 * np.eye(2)
    )
    of, none = drift.SlowLoad(np.arange(3.0), slow, False), afloat(np.zeros((2, 2)))
    mean, std, unmet = drift.moved(model, np.arange(2), none, np.array([3e3, 0.3]), of)
    one = SimpleNamespace(length=np.ones(1), **{k: getattr(model, k)[:1, :1] for k in ("stiffness", "damping", "mass")})
    alone = drift.moved(
        one, np.array([0]), afloat(np.zeros((1, 1))), np.array([3e3]), of._replace(power=slow[:, :1, :1])
    )
    assert not unmet and mean == approx([alone[0][0], 0.0]) and std == approx([alone[1][0], 0.0]) and std[0] > 0
    model.stiffness = model.stiffness + np.array([[0.0, 1.0], [1.0, 0.0]])
    assert "nothing holds" in drift.moved(model, np.arange(2), none, np.array([3e3, 0.0]), of)[2]


@pytest.mark.parametrize(
    ("motion", "arm", "told"),
    [
        (("surge", "yaw"), 0.0, (True, None, False)), (("surge", "pitch", "sway", "yaw"), 0.0, (True, True, False)),
        (("yaw", "pitch"), 0.0, (None, None, False)), (("sway", "surge", "yaw"), 0.0, (True, True, True)),
        (("sway", "surge", "yaw"), 3.0, (True, True, True)),
    ],
)  # fmt: skip
def test_what_a_joint_that_guides_bears_turns_nothing(motion, arm, told):
    """A round buoy has no moment about its axis: that about the fixed vertical is of the guide's force where it is.

    On an arm it has one about its joint's.
    """
    hull = Revolution.vertical_cylinder(radius=2.0, draft=3.0, freeboard=2.0)
    springs = {"surge": 8e3, "sway": 8e3, "yaw": 1e5, "pitch": 3e5}
    stiffness = tuple(springs[axis] for axis in motion)
    buoy = Float(
        name="buoy", hull=hull, mass=1025.0 * hull.volume, inertia=(9e4,) * 3, cog=(0, 0, -1.0), hinge=(arm, 0, 0),
        arm=(-arm, 0, 0), motion=motion, stiffness=stiffness, damping=tuple(k / 10 for k in stiffness),
    )  # fmt: skip
    waves = sea(band=(0.8, 2.0), heading=0.7)
    item = scene((buoy,), depth=np.inf, waves=waves, method="frequency", froude_krylov="linear", outputs=("drift",))
    h = bem.solve(
        (hull,), np.zeros((1, 3)), depth=np.inf, heading=0.7, omega=np.linspace(0.7, 2.1, 4), planar=False, panels=108,
        far_field=True,
    )  # fmt: skip
    record = simulate(item, h)
    axes = list(record.coords["axis"])
    for name in ("drift_offset", "slow_drift"):
        for axis, known in zip(("surge", "sway", "yaw"), told, strict=True):
            assert known is None or np.isfinite(record.variables[name][1][0, axes.index(axis)]) == known
    assert ("not of yaw" in record.attrs["unmet"]) == (not told[2])


def test_one_wave_does_not_drift_slowly():
    slow = drift.slow_load(np.array([1.0]), np.array([1j]), np.array([[2e3, 1e3]]), 3600.0)
    model = SimpleNamespace(length=np.ones(2), stiffness=np.eye(2), damping=np.eye(2), mass=np.eye(2))
    mean, std, unmet = drift.moved(model, np.arange(2), afloat(np.zeros((2, 2))), np.array([2e3, 1e3]), slow)
    assert mean == approx([2e3, 1e3]) and std == approx([0.0, 0.0]) and not unmet


@pytest.mark.parametrize("changes", [{"method": "time"}, {"interaction": False}, {"radiation": False}])
def test_drift_of_what_the_waves_far_off_do_not_tell_is_refused(changes):
    item = drifting(HEADING)
    with pytest.raises(InputError, match="drift"):
        replace(item, settings=replace(item.settings, **changes))


def test_coefficients_without_the_waves_far_off_are_refused():
    item, h = duck()
    settings = replace(item.settings, method="frequency", froude_krylov="linear", outputs=("drift",))
    with pytest.raises(InputError, match="far field"):
        simulate(replace(item, settings=settings), h)
    assert h.far_field is None
