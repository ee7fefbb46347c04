"""Mean and slow drift of rotors on a moored barge, waves aslant, and of one axis in closed form."""

from dataclasses import replace
from functools import cache
from types import SimpleNamespace

import numpy as np
import pytest
from pytest import approx

from solver.coupled.system import prepare
from solver.errors import InputError
from solver.frequency import drift
from solver.frequency.response import respond
from solver.hydrodynamics.bem import bem
from solver.run import simulate
from solver.sea.realization import realize
from solver.sea.spectrum import PiersonMoskowitz
from tests.awkward import duck, rotors, sea

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


def test_energy_far_off_is_that_of_rotors_and_dampers():
    """To the error of a coarse mesh of the barge, whose edges count: 2 %, and 1.2 % with twice as many panels."""
    record = records()[0]
    assert record.attrs["energy_residual"] < 0.03
    system, h = prepare(drifting(HEADING), coefficients()[0]), coefficients()[0]
    response = respond(system, h)
    rate = np.abs(response.omega[:, None] * response.Z) ** 2 / 2
    damping = np.array([*MOORED["damping"], 4e4, 6e4])
    assert np.sum(drift.waves_of(system, response, h).absorbed_power) == approx(np.sum(rate @ damping), rel=0.04)


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


def test_slow_drift_of_one_axis_is_that_of_all_pairs_of_waves():
    """σ² = Σ 2|aᵢaⱼT|²/|C - μ²M - iμD|² over all pairs, μ = ωᵢ - ωⱼ, where S(ω)S(ω + μ) is flat over the resonance."""
    waves = realize(PiersonMoskowitz(Hs=3.0, Tp=8.0), components=1500, band=(0.4, 2.0), seed=1, intervals="even")
    C, D, M, T = 4.0e4, 8e4, 1.6e7, 3e4  # a resonance at 0.05 rad/s, with 5 % of critical damping
    a2 = np.abs(waves.amplitude) ** 2
    i, j = np.triu_indices(a2.size, 1)
    mu = waves.omega[j] - waves.omega[i]
    exact = np.sqrt(np.sum(2 * a2[i] * a2[j] * T**2 / np.abs(C - mu**2 * M - 1j * mu * D) ** 2))
    model = SimpleNamespace(stiffness=np.diag([1.0, C]), damping=np.diag([1.0, D]), mass=np.diag([1.0, M - 2e6]))
    scene = SimpleNamespace(settings=SimpleNamespace(duration=3600.0))
    near = drift.noise(scene, SimpleNamespace(omega=waves.omega))
    loads, added = T * a2[:, None], np.diag([0.0, 2e6])
    mean, std, unmet = drift.moved(model, np.array([1]), added, loads, near)
    assert mean[0] == approx(T * 2 * (3.0 / 4) ** 2 / C, rel=0.05) and not unmet  # Σ|a|² = 2 m₀
    assert std[0] == approx(exact, rel=0.08)


def test_what_nothing_holds_or_damps_has_no_drift():
    none = np.zeros((2, 2))
    model = SimpleNamespace(stiffness=none, damping=none, mass=np.eye(2))
    mean, std, unmet = drift.moved(model, np.array([0]), none, np.ones((3, 1)), np.eye(3))
    assert np.isnan([*mean, *std]).all() and "nothing holds" in unmet
    model.stiffness = np.eye(2)
    mean, std, unmet = drift.moved(model, np.array([0]), none, np.ones((3, 1)), np.eye(3))
    assert mean == approx(3.0) and np.isnan(std).all() and "nothing damps" in unmet


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
