"""Warnings about scenes: weight against displacement along each axis of a joint."""

from dataclasses import replace

import numpy as np
import pytest

from solver.balance import imbalance, warnings
from solver.hydrodynamics.hull.revolution import Revolution
from solver.scene import Float, Scene, Water
from solver.sea.realization import CALM, measured

DEEP = Water(depth=np.inf, density=1000.0)
SPHERE = Revolution.sphere(radius=5.0, draft=5.0)
DISPLACED = 1000 * 2 / 3 * np.pi * 125


def ball(**changes):
    fields = {"mass": DISPLACED, "hinge": (0, 0, 0), "arm": (0, 0, 0), "motion": ("heave",)} | changes
    return Float(name="ball", hull=SPHERE, inertia=(2.6e6,) * 3, **fields)


@pytest.mark.parametrize(("share", "count"), [(0.991, 0), (1.009, 0), (0.988, 1), (1.012, 1)])
@pytest.mark.parametrize("joint", [{}, {"motion": ("hinge",), "hinge": (-20, 0, 3), "arm": (20, 0, -3)}])
def test_one_percent_of_the_weight_is_the_limit(share, count, joint):
    odd = imbalance(ball(mass=share * DISPLACED, **joint), DEEP)
    assert len(odd) == count
    assert all(f"mass {share * DISPLACED:g} kg, displaced {DISPLACED:g} kg" in text for text in odd)


@pytest.mark.parametrize(("motion", "arm"), [("surge", 0), ("pitch", 0), ("yaw surge", 0), ("hinge", 20)])
def test_what_cannot_move_up_and_down_is_not_weighed(motion, arm):
    """A vertical hinge axis carries any weight, and so does a pitch axis below it."""
    held = {"motion": tuple(motion.split()), "axis": (0, 0, 1), "hinge": (-arm, 0, 0), "arm": (arm, 0, 0)}
    item = ball(mass=0.5 * DISPLACED, **held)
    assert imbalance(item, DEEP) == []


def test_an_eccentric_mass_tilts_what_may_pitch():
    """0.06 m of 5 m is more than a hundredth of the radius."""
    assert imbalance(ball(cog=(0.04, 0, -2), motion=("heave", "pitch")), DEEP) == []
    (text,) = imbalance(ball(cog=(0.06, 0, -2), motion=("heave", "pitch")), DEEP)
    assert "pitch: moment of weight" in text
    assert imbalance(ball(cog=(0.06, 0, -2)), DEEP) == []


def test_notes_of_the_sea_are_told():
    t = np.arange(50.0)
    sea = measured(time=t, elevation=np.cos(t), band=(0.5, 2.0))
    calm = Scene(water=DEEP, sea=CALM, floats=(ball(),))
    assert warnings(calm) == ()
    assert [text.split(":")[0] for text in warnings(replace(calm, sea=sea))] == ["sea"]
