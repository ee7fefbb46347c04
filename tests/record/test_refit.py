"""A memory fitted again to what little-damped motions ask of it, in scenes unlike each other."""

from dataclasses import replace

import numpy as np
import pytest
from pytest import approx

from solver import motions
from solver.coupled.linear import impedance, linear_model
from solver.coupled.moving import excitation
from solver.coupled.natural import system_modes
from solver.coupled.preparation import prepare, remembered
from solver.errors import SimulationFailed
from solver.record import refit
from solver.record.effects import coefficient_effects
from solver.scene import EndStops
from solver.sea.realization import CALM, components
from tests.awkward import SCENES

UNDAMPED = {"pto_damping": 0.0, "damping": 0.0, "critical_damping": 0.0}


def undamped(name, shape=0, **settings):
    """A scene without power take-off in a wave of the period of one of its shapes; its coefficients."""
    item, h = SCENES[name]()
    item = replace(item, floats=tuple(replace(f, **UNDAMPED) for f in item.floats))
    period = system_modes(prepare(item, h), h).period[shape]
    wave = components(
        amplitude=np.array([1e-3]), omega=np.array([2 * np.pi / period]), phase=np.zeros(1), heading=item.sea.heading
    )
    return replace(item, sea=wave, settings=replace(item.settings, **settings)), h


@pytest.mark.parametrize(("name", "shape"), [("big_beside_small", 1), ("flap", 0), ("model_scale", 0)])
def test_what_swings_by_its_own_radiation_gets_its_own_fit(name, shape):
    item, h = undamped(name, shape)
    usual, fitted = prepare(item, h), refit.prepared(item, h)
    before, after = (coefficient_effects(system, h)[0] for system in (usual, fitted))
    assert before > refit.SWAYED and after < 1.5 * refit.SWAYED  # coarse meshes' curves have no better one
    damping = fitted.fit.frequency(np.geomspace(1e-2, 1e2, 500)).real
    assert np.linalg.eigvalsh(damping).min() > -1e-9 * np.abs(damping).max()


def test_nothing_is_fitted_again_where_nothing_moves():
    """Though stops would be met by what a memory sways."""
    item, h = SCENES["flap"]()
    stops = EndStops(lower=-0.04, upper=0.04, stiffness=1e8)
    still = replace(item, floats=(replace(item.floats[0], end_stops=stops),), sea=CALM)
    assert same(refit.prepared(still, h).fit, prepare(still, h).fit)
    assert not same(refit.prepared(replace(still, sea=item.sea), h).fit, prepare(still, h).fit)


def same(fit, other):
    """Whether two fits are of the same data, in whichever order they were made."""
    return fit.error == other.error and np.array_equal(fit.beta, other.beta)


def test_the_usual_fit_stays_where_it_is_asked_for_or_good_enough_or_dear(monkeypatch):
    item, h = undamped("flap")
    asked, usual = undamped("flap", memory_tolerance=5e-3)[0], prepare(item, h).fit
    assert same(refit.prepared(asked, h).fit, usual)
    damped, _ = SCENES["flap"]()
    assert same(refit.prepared(damped, h).fit, usual)
    assert not same(refit.prepared(item, h).fit, usual)
    monkeypatch.setattr(refit, "FEW", 0)
    assert not same(refit.prepared(item, h).fit, usual)
    monkeypatch.setattr(refit, "USUAL", 0.5 * usual.error)  # which it has not met
    assert same(refit.prepared(item, h).fit, usual)
    monkeypatch.undo()
    monkeypatch.setattr(refit, "MANY", 0)
    assert same(refit.prepared(item, h).fit, usual)


def test_where_no_fit_comes_as_close_as_is_asked_the_best_there_is_stays(monkeypatch):
    item, h = SCENES["duck"]()
    floats = (replace(item.floats[0], pto_damping=1e-3),)
    item = replace(item, floats=floats, settings=replace(item.settings, froude_krylov="linear"))
    usual, fitted = prepare(item, h), refit.prepared(item, h)
    before, after = (coefficient_effects(system, h)[0] for system in (usual, fitted))
    assert refit.SWAYED < after < 0.7 * before
    finer = replace(item, settings=replace(item.settings, time_step=0.02, newton_tolerance=1e-7))
    with monkeypatch.context() as once:
        once.setattr(refit, "_swayed", None)  # runs that are repeated with shorter steps do not seek it again
        assert refit.prepared(finer, h).fit is fitted.fit
    monkeypatch.setattr(refit, "TIMES", (1e4,))
    refit._suited.cache_clear()
    assert refit.prepared(item, h).fit is usual.fit
    refit._suited.cache_clear()


def test_poles_are_the_coefficients_and_shares_the_seas_whatever_came_before():
    """Other seas, and their order, leave a fit as it is to the bit."""
    (one, h), (other, _) = undamped("big_beside_small", 1), undamped("big_beside_small", 1)
    wave = components(
        amplitude=np.array([1e-3]), omega=1.05 * one.sea.omega, phase=np.zeros(1), heading=one.sea.heading
    )
    other = replace(other, sea=wave)

    def fits(*items):
        for kept in (refit._sampled, refit._poles, refit._weighed):
            kept.cache_clear()
        return [refit.prepared(item, h).fit for item in items]

    (first, second), (late, early) = fits(one, other), fits(other, one)
    assert np.array_equal(first.residue, early.residue) and np.array_equal(second.residue, late.residue)
    assert first is not second
    moving = h, tuple(f.hull for f in one.floats), motions.of_scene(one), refit.LOOSE
    usual, sampled = prepare(one, h).fit, refit._sampled(*moving)
    numbers = refit._numbers(usual, sampled)
    assert numbers == [0, *sorted({int(np.ceil(share * usual.beta.size)) for share in refit.MORE})]
    found = [refit._poles(*moving, n) for n in numbers[1:]]
    for fit in (first, second):
        assert any(np.array_equal(fit.beta, poles) for poles in (usual.beta, *found))


def test_more_poles_are_not_sought_where_those_there_may_be_come_not_near():
    item, h = undamped("big_beside_small", 1)
    moving = h, tuple(f.hull for f in item.floats), motions.of_scene(item), refit.LOOSE
    usual, sampled = prepare(item, h).fit, refit._sampled(*moving)
    assert len(refit._numbers(usual, sampled)) > 1
    assert refit._numbers(replace(usual, error=1.01 * refit.HOPELESS * refit.USUAL), sampled) == [0]
    most = replace(usual, beta=np.full(sampled.most, usual.beta[0]))
    assert refit._numbers(most, sampled) == [0, sampled.most]


def weightless():
    """A scene, its coefficients, their memory, and them with another whose A∞ is that of water that rings in a gap."""
    item, h = SCENES["model_scale"]()
    usual = prepare(item, h).fit
    lost = replace(usual, added_mass_inf=-10 * usual.added_mass_inf)
    ways = {"memory_tolerance": refit.USUAL, "memory_motions": motions.of_scene(item)}
    return item, h, usual, replace(h, memory=lost, **ways)


def test_a_memory_that_leaves_no_mass_is_fitted_again_with_that_of_the_boundary_elements(monkeypatch):
    item, h, usual, known = weightless()
    with pytest.raises(SimulationFailed, match="is not above zero"):
        system_modes(prepare(item, known), known)
    asked = replace(item, settings=replace(item.settings, memory_tolerance=refit.USUAL))  # which are not fitted again
    for one in (item, asked):
        fitted = refit.prepared(one, known)
        system_modes(fitted, known)
        assert fitted.fit.error <= refit.USUAL
        assert coefficient_effects(fitted, known)[0] < 2 * refit.SWAYED
    hulls, ways = tuple(f.hull for f in item.floats), motions.of_scene(item)

    def off(fit):
        return np.abs(fit.added_mass_inf - h.added_mass_inf).max()

    assert same(fitted.fit, remembered(known, hulls, refit.USUAL, ways, refit.HOLDS[0]))
    assert off(fitted.fit) < off(usual)
    with monkeypatch.context() as once:  # held no harder than it must
        held = dict.fromkeys(refit.HOLDS[:2], known.memory) | {refit.HOLDS[2]: usual}
        once.setattr(refit, "remembered", lambda *asked: held[asked[-1]])
        assert refit.prepared(asked, known).fit is usual


def test_coefficients_that_leave_no_mass_themselves_are_told(monkeypatch):
    item, _, _, known = weightless()
    known = replace(known, added_mass_inf=known.memory.added_mass_inf)
    monkeypatch.setattr(refit, "remembered", None)  # no other fit helps
    asked = replace(item, settings=replace(item.settings, memory_tolerance=refit.USUAL))
    with pytest.raises(SimulationFailed, match="is not above zero: are coefficients and inertia those"):
        system_modes(refit.prepared(asked, known), known)


def test_no_fit_to_the_motions_takes_their_mass(monkeypatch):
    item, h = undamped("flap")
    usual = prepare(item, h).fit
    monkeypatch.setattr(refit, "TIMES", refit.TIMES[:1])
    monkeypatch.setattr(refit, "MORE", ())
    refit._suited.cache_clear()
    assert not same(refit.prepared(item, h).fit, usual)
    refit._suited.cache_clear()
    monkeypatch.setattr(refit, "_has_mass", lambda _, known: known in {usual, h})
    assert same(refit.prepared(item, h).fit, usual)
    refit._suited.cache_clear()


@pytest.mark.parametrize("name", ["big_beside_small", "soft_mooring"])
def test_importance_is_what_a_small_change_of_the_impedance_does(name):
    """By a second solution, with one entry of Y changed at one frequency."""
    item, h = SCENES[name]()
    system = prepare(item, h)
    model, counts, omega = linear_model(system), refit.importance(system, h), h.omega
    Y, force = impedance(system, h, omega), excitation(system, h, omega) @ model.active
    X = model.response(omega, Y, force)
    inside = np.flatnonzero(counts.any(axis=(1, 2)))
    assert set(inside) >= set(np.flatnonzero((omega > item.sea.omega.min()) & (omega < item.sea.omega.max())))
    w = inside[inside.size // 2]
    for i, j in zip(*np.nonzero(counts[w]), strict=True):
        small = 1e-6 * np.abs(Y[w]).max()
        other = Y[[w]]
        other[0, i, j] += small
        change = np.abs(model.response(omega[[w]], other, force[[w]])[0] - X[w])
        largest = np.abs(X[inside]).max(axis=0)
        assert counts[w, i, j] == approx(
            np.max(change / np.maximum(np.abs(X[w]), refit.LEAST * largest)) / small, rel=1e-3
        )
