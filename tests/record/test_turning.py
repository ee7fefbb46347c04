"""Added inertia of coefficients that keep their directions, of a float that turns."""

from dataclasses import replace

import numpy as np
import pytest

from solver.coupled.linear import linear_model
from solver.coupled.preparation import prepare
from solver.record.channels import Channels
from solver.record.turning import turning
from tests.awkward import flap, model_scale


def told(item, h, std):
    system, channels = prepare(item, h), Channels(item, None)
    return system, list(turning(system, channels, {"rotation": np.full((1, 5), std)}))


@pytest.mark.parametrize("std", [0.2, 0.5])
def test_a_flap_loses_inertia_as_it_turns(std):
    """A foot's lever r above its hinge goes along by r cos θ and down by r sin θ; of a wall in surge A₁₁ is most."""
    item, h = flap()
    system, (text,) = told(item, h, std)
    A, r = system.bodies.added_mass, 9.0
    at = [list(np.flatnonzero(system.bodies.active == i)) for i in (0, 2, 4)]
    (x,), (z,), (ry,) = at

    def inertia(angle):
        lever = np.zeros(len(A))
        lever[[x, z, ry]] = r * np.cos(angle), -r * np.sin(angle), 1.0
        return lever @ A @ lever

    change = (0.5 * (inertia(std) + inertia(-std)) - inertia(0.0)) / linear_model(system).mass[0, 0]
    assert change < -0.02 and f"by {change:+.1%}" in text and f"{std:g} rad" in text


def test_nothing_is_said_of_bodies_as_heavy_either_way_nor_of_small_angles():
    assert not told(*flap(), 0.02)[1] and not told(*model_scale(), 0.15)[1]
    item, h = flap()
    dry = replace(item, settings=replace(item.settings, radiation=False))
    assert not list(turning(prepare(dry, h), Channels(dry, None), {"rotation": np.full((1, 5), 0.5)}))
