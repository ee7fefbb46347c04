"""Means of second order by the exact rotation of arms, against the linear march in waves that come back."""

from dataclasses import replace

import numpy as np
import pytest
from pytest import approx

from solver.frequency.case import case_of
from solver.frequency.response import respond
from solver.frequency.rotation import mean_shift
from solver.run import simulate
from tests.awkward import SCENES
from tests.frequency.test_frequency import linear, repeating


@pytest.mark.parametrize(
    ("name", "height"),
    [("duck", 0.03), ("flap", 0.01), ("oblique", 0.03), ("big_beside_small", 0.03), ("unequal_legs", 0.03)],
)
def test_mean_angles_are_the_marchs(name, height):
    """c.o.g. off the reference point, a foot below, two that differ, a platform that moves.

    To 5 %: in lower waves the mean is no more than what statics leave of the equilibrium, higher ones are not small.
    """
    item, h = SCENES[name]()
    size = min(f.hull.size for f in item.floats)
    numerics = {"newton_tolerance": 1e-11 * size, "memory_tolerance": 1e-3}
    item, period = repeating(item, height * size)
    lasting = {"duration": period, "discard": 5 * period, "ramp": 2 * period, "ramp_form": "cosine"}
    item = linear(item, **numerics, **lasting, time_step=period / 400)
    lines = linear(item, method="frequency")
    case = case_of(lines, h)
    shift = mean_shift(case, respond(lines, h))
    joints = len(item.floats)
    found = simulate(item, h).variables["rotation"][1][:, 2] - case.system.equilibrium[0][-joints:]
    assert np.abs(shift[-joints:] - found).max() < 0.05 * np.abs(found).max()


def test_mean_angles_grow_with_the_waves_height_squared():
    item, h = SCENES["flap"]()
    angles = []
    for height in (0.5, 1.0):
        lines = linear(replace(item, sea=replace(item.sea, amplitude=height * item.sea.amplitude)), method="frequency")
        angles.append(mean_shift(case_of(lines, h), respond(lines, h)))
    assert angles[1] == approx(4 * angles[0], rel=1e-6)
