"""What is damped by so little that a run's start does not tell what the step does to it."""

from dataclasses import replace

import numpy as np
import pytest
from pytest import approx

from solver.coupled.linear import linear_model
from solver.coupled.natural import system_modes
from solver.coupled.preparation import prepare
from solver.record.accuracy import DEFAULT
from solver.record.effects import step_effect
from solver.run import simulate
from solver.scene import Scene
from solver.sea.realization import regular
from solver.statistics import FAINT, STATISTICS
from solver.structure.members import PointMass
from tests.awkward import SCENES, bare_legs

STD = STATISTICS.index("std")


def legs(ratio, *, off=1.0, drag=0.0, height=0.02, begin=8.0, end=16.0, **settings) -> Scene:
    """Unequal legs of a damping ratio ζ in a wave of their lowest frequency ω times 1 + `off` ζ, told between two
    times, in 1/ζω."""
    item = bare_legs()[0]
    frame = item.platform.frame
    members = tuple(replace(m, drag_coefficient=drag * (m.name in item.platform.legs)) for m in frame.members)
    frame = replace(frame, members=members, masses=(PointMass(node="deck", mass=6e5),))
    item = replace(item, platform=replace(item.platform, frame=frame, damping_ratio=ratio))
    own = system_modes(prepare(item, None), None).omega.min()
    wave = replace(regular(height=height, period=2 * np.pi / (own * (1 + off * ratio))), heading=0.5)
    times = {"ramp": 5.0, "discard": begin / (ratio * own), "duration": (end - begin) / (ratio * own)}
    return replace(item, sea=wave, settings=replace(item.settings, **times, **settings))


def errors(item: Scene, name: str = "top_displacement") -> tuple[float, float]:
    """Largest relative error of a std by the step, by one of a third of it; and as it is told."""
    usual = simulate(item, None)
    third = replace(item.settings, time_step=usual.attrs["time_step"] / 3, tolerance=None)
    finer = simulate(replace(item, settings=third), None)
    a, b = (record.variables[name][1][..., STD] for record in (usual, finer))
    return np.max(abs(a / b - 1)[b > FAINT * b.max()]) * 81 / 80, usual.attrs["discretization_error"]


@pytest.mark.parametrize("given", [
    {"ratio": 0.002}, {"ratio": 0.005, "off": -1.0}, {"ratio": 0.02},
    {"ratio": 0.002, "begin": 0.0, "end": 0.5}, {"ratio": 0.002, "begin": 0.0, "end": 3.0},
    {"ratio": 0.002, "drag": 60.0, "height": 0.3},
], ids=["hardly", "below", "lightly", "begins", "swings-up", "drag"])  # fmt: skip
def test_errors_of_resonances_are_told(given):
    """By steps of a seventh of the period; those of a run's start were a tenth to a hundredth of the true ones."""
    true, told = errors(legs(**given, time_step=0.2))
    assert 1 / 3 < true / told < 3


@pytest.mark.parametrize("name", ["duck", "oblique"])
def test_errors_of_floats_that_nothing_but_pressure_moves_are_told(name):
    """Without coefficients; power goes twice as wrong as the std."""
    item, ratio = SCENES[name]()[0], 0.005
    item = replace(item, settings=replace(item.settings, radiation=False, diffraction=False))
    system = prepare(item, None)
    own, inertia = system_modes(system, None).omega.min(), np.diag(linear_model(system).mass)
    damped = (replace(f, pto_damping=float(2 * ratio * own * M)) for f, M in zip(item.floats, inertia, strict=True))
    wave = replace(regular(height=1e-4, period=2 * np.pi / (own * (1 + ratio))), heading=item.sea.heading)
    times = {"ramp": 5.0, "discard": 8 / (ratio * own), "duration": 8 / (ratio * own), "time_step": 0.7 / own}
    item = replace(item, floats=tuple(damped), sea=wave, settings=replace(item.settings, **times))
    true, told = errors(item, "rotation")
    assert 1 / 3 < 2 * true / told < 3 and true > 0.01


def test_far_from_resonance_a_step_does_what_it_tells():
    item = legs(0.02, off=-15.0, time_step=0.2)
    assert errors(item)[0] == approx(step_effect(prepare(item, None), None), rel=0.08)


def test_steps_follow_them():
    """Those that nobody gave, and those of a tolerance."""
    true, told = errors(legs(0.002))
    assert told < DEFAULT and 1 / 3 < true / told < 3
    true, told = errors(legs(0.002, tolerance=2e-2))
    assert DEFAULT < true < 1e-2 and 1 / 3 < true / told < 3
