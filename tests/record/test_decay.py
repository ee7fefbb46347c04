"""What errors of coefficients do to floats let go in still water: against marches, in scenes unlike each other."""

from dataclasses import replace

import numpy as np
import pytest
from pytest import approx

from solver.coupled.preparation import prepare
from solver.hydrodynamics.hull.revolution import Revolution
from solver.record import decay, refit
from solver.record.effects import coefficient_effects
from solver.record.sampling import least_force
from solver.run import simulate
from solver.scene import Float
from solver.sea.realization import CALM
from tests.awkward import RHO, SCENES, known, scene

UNDAMPED = {"pto_damping": 0.0, "damping": 0.0, "critical_damping": 0.0}


def let_go(item, damped=True, duration=40.0, offset=0.02):
    """Every axis from a small offset, linear."""
    change = {} if damped else UNDAMPED
    floats = (replace(f, offset=(offset,) * len(f.motion), **change) for f in item.floats)
    settings = replace(
        item.settings, froude_krylov="linear", duration=duration, discard=0.0, ramp=0.0, time_step=duration / 4000
    )
    return replace(item, sea=CALM, floats=tuple(floats), settings=settings)


def spar_with_a_plate():
    """Whose heave hardly radiates: it rings for hours, in a band far narrower than frequencies are apart."""
    hull = Revolution.profile([(5.0, -12.0), (5.0, -11.0), (1.5, -11.0), (1.5, 3.0)])
    spar = Float(
        name="spar", hull=hull, mass=RHO * hull.volume, inertia=(2.6e6,) * 3, cog=(0, 0, -2), hinge=(0, 0, 0),
        motion=("heave",),
    )  # fmt: skip
    item = scene([spar])
    return item, known(item, 0.15, 3.0, 30)


def changed(a, b, item):
    """Largest change of a mean or std, relative to the std, of motions and of forces that are not small."""
    small = {"hinge_force": least_force(item).max()}
    changes = []
    for name, least in (("motion", 1e-3), ("rotation", 1e-3), ("hinge_force", 0.05)):
        if name in a.variables:
            x, y = (record.variables[name][1].reshape(-1, 5) for record in (a, b))
            used = x[:, 4] > max(least * x[:, 4].max(), small.get(name, 0.0))
            changes += [*np.abs(y - x)[used][:, [2, 4]].max(axis=1) / x[used, 4]]
    return max(changes)


@pytest.mark.parametrize(
    ("name", "damped", "duration"),
    [
        ("big_beside_small", True, 40.0), ("soft_mooring", False, 40.0), ("flap", True, 40.0),
        *(pytest.param(*case, marks=pytest.mark.slow) for case in [
            ("big_beside_small", False, 40.0), ("soft_mooring", False, 400.0), ("plate", False, 40.0),
            ("duck", False, 40.0), ("plate", False, 600.0),
        ]),
    ],
)  # fmt: skip
def test_mesh_effect_of_a_decay_is_what_the_march_shows(name, damped, duration):
    """With coefficients, and with those off by their estimated error; and by what two fits of the memory differ."""
    item, h = spar_with_a_plate() if name == "plate" else SCENES[name]()
    item = let_go(item, damped, duration)
    usual, off = (simulate(item, each) for each in (h, h.shifted))
    memory, told = coefficient_effects(refit.prepared(item, h), h)
    other, _ = coefficient_effects(refit.prepared(item, h.shifted), h.shifted)
    assert told / 3 - memory - other < changed(usual, off, item) < 3 * told + memory + other


@pytest.mark.parametrize(
    ("name", "damped", "duration"),
    [("soft_mooring", True, 20.0), ("soft_mooring", False, 400.0), ("oblique", True, 20.0), ("model_scale", True, 5.0),
     pytest.param("flap", True, 20.0, marks=pytest.mark.slow)],
)  # fmt: skip
def test_a_decay_is_the_march_s(name, damped, duration):
    """With the fit that the march has; both ends of the record, and the forces that joints bear."""
    item, h = SCENES[name]()
    item = let_go(item, damped, duration, offset=1e-3)
    item = replace(item, settings=replace(item.settings, keep_series=True))
    system = refit.prepared(item, h)
    span = decay._span(system, h)
    told = decay._decay(system, span, system.fit.frequency(span.omega))
    series = simulate(item, h).series
    motion = series["motion" if "motion" in series else "rotation"][1].reshape(len(series["time"][1]), -1)
    moves = np.isfinite(motion).all(axis=0)
    marched = [np.interp(span.times, series["time"][1], x) for x in motion[:, moves].T]
    own = told.motions[:, system.structure.omega.size :]
    for x, y in zip(marched, own.T, strict=True):
        assert x - x.mean() == approx(y - y.mean(), abs=0.03 * np.ptp(own))
    force = series["hinge_force"][1].reshape(len(series["time"][1]), -1)
    settled = span.times > 4 * span.times[0]  # a jump at the start is told as a swing
    borne = told.forces.reshape(span.times.size, -1)
    for x, y in zip(force.T, borne.T, strict=True):
        if np.ptp(y[settled]) > 0.05 * np.ptp(borne[settled], axis=0).max():
            there = np.interp(span.times, series["time"][1], x)
            assert there[settled] - there.mean() == approx(y[settled] - y.mean(), abs=0.05 * np.ptp(y))


def test_what_is_not_let_go_has_no_decay():
    item, h = SCENES["soft_mooring"]()
    calm = replace(let_go(item), floats=tuple(replace(f, offset=0.0) for f in item.floats))
    assert coefficient_effects(prepare(calm, h), h) == (0.0, 0.0)


def test_of_a_short_record_more_is_judged():
    """Far shorter than any wave that coefficients are known for."""
    item, h = SCENES["soft_mooring"]()
    brief, longer = (coefficient_effects(prepare(let_go(item, duration=each), h), h) for each in (0.01, 1.0))
    assert brief == approx(longer)
    assert all(0 < effect < 0.1 for effect in brief)


def test_of_a_long_record_what_frequencies_do_for_is_judged(monkeypatch):
    item, h = SCENES["soft_mooring"]()
    item = let_go(item, duration=4000.0)
    whole = coefficient_effects(prepare(item, h), h)
    monkeypatch.setattr(decay, "MOST", 2000)
    span = decay._span(prepare(item, h), h)
    assert 2001 <= span.omega.size < 2050 and 50 < span.times[-1] < 4000.0
    assert coefficient_effects(prepare(item, h), h) == approx(whole, rel=0.5)


@pytest.mark.parametrize(
    ("name", "start"), [("model_scale", "+0.02 rad of hinge"), ("soft_mooring", "+0.01 rad of pitch")]
)
def test_a_record_that_begins_when_a_decay_is_over_says_so(name, start):
    """At 1:20; and of a barge let go in heave and pitch alone, whose surge has no offset. In waves, none is."""
    item, h = SCENES[name]()
    floats = tuple(replace(f, offset=0.02 if len(f.motion) == 1 else (0.0, 0.02, 0.01)) for f in item.floats)
    whole, ripples = 2 * item.settings.duration, replace(item.sea, amplitude=1e-5 * item.sea.amplitude)
    told, left = [], []
    for share, sea in ((0.0, CALM), (0.6, CALM), (0.6, ripples)):
        span = {"discard": share * whole, "duration": (1 - share) * whole, "ramp": 0.0}
        settings = replace(item.settings, froude_krylov="linear", **span)
        record = simulate(replace(item, sea=sea, floats=floats, settings=settings), h)
        motion = record.variables["rotation" if name == "model_scale" else "motion"][1].reshape(-1, 5)
        size = np.ravel(floats[0].offset)
        left.append(max((motion[:, 0] - motion[:, 1])[size > 0] / 2 / size[size > 0]))
        told.append([text for text in record.attrs.get("warnings", "").split("; ") if ".offset: " in text])
    early, late, waves = told
    assert early == waves == [] and len(late) == 1
    assert f"let go from {start}, it swings by" in late[0] and left[1] < decay.LEFT < left[0]
