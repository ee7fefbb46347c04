"""Which motions joints leave floats: by hand for single ones, by the march's own Jacobians for machines."""

from dataclasses import replace

import numpy as np
import pytest

from solver.coupled.preparation import prepare
from solver.motions import of_scene, possible
from solver.multibody.bodies import new_motion
from solver.multibody.minimal import move
from solver.scene import DOFS, Float
from tests.awkward import BALL, BUOYED, rotors, scene

COMMON = {"hull": BALL, "mass": BUOYED, "inertia": (859.0,) * 3, "hinge": (0.0, 0.0, 0.0)}


def one(name="a", **changes):
    return Float(name=name, **COMMON | changes)


@pytest.mark.parametrize(
    ("joint", "motions"),
    [
        ({"motion": ()}, ""),
        ({"motion": ("heave",)}, "heave"),
        ({"motion": ("surge", "heave")}, "surge heave"),
        ({"motion": ("pitch",)}, "pitch"),  # about its own reference point
        ({"motion": ("heave", "pitch")}, "heave pitch"),
        ({"motion": ("pitch", "heave")}, "surge heave pitch"),  # slides along an axis that pitches
        ({"motion": ("roll", "pitch")}, "roll pitch yaw"),  # about an axis that rolls
        ({"motion": ("yaw", "heave")}, "heave yaw"),
        # The arm hangs: heave only where it has swung, which a linear scene's does, too.
        ({"motion": ("hinge",), "hinge": (0.0, 0.0, 5.0), "arm": (0.0, 0.0, -5.0)}, "surge heave pitch"),
        (
            {"motion": ("hinge",), "hinge": (3.0, 0.0, 0.0), "arm": (-3.0, 0.0, 0.0), "axis": (0, 0, 1)},
            "surge sway yaw",
        ),
        ({"motion": ("hinge",), "arm": (0.0, -3.0, 0.0), "hinge": (0, 3, 0), "axis": (1, 1, 0)}, " ".join(DOFS[:5])),
    ],
)
def test_what_a_joint_leaves_free(joint, motions):
    assert possible([one(**joint)], planar=False, elastic=False) == (tuple(motions.split()),)


def test_an_elastic_platform_moves_what_it_carries_in_every_way():
    guided = [one(motion=("heave",)), one("b", motion=())]
    assert possible(guided, planar=True, elastic=True) == (("surge", "heave", "pitch"),) * 2
    assert possible(guided, planar=False, elastic=True) == (DOFS,) * 2
    assert possible(guided, planar=False, elastic=False) == (("heave",), ())


def leaning():
    """A float in waves from the side that slides in another which turns about a tilted axis, and one beside them."""
    arm = {"hinge": (-6.0, 1.0, 3.0), "arm": (-2.0, 0.0, -3.0)}
    floats = [
        one("arm", axis=(0.6, 0.8, 0.0), **arm),
        one("slide", on="arm", motion=("heave",), hinge=(-2.0, 6.0, 0.0)),
        one("guided", motion=("surge", "heave"), hinge=(8.0, 0.0, 0.0)),
    ]
    return scene(floats)


@pytest.mark.parametrize("build", [rotors, leaning])
def test_the_motions_are_those_of_the_march(build):
    whole = build()
    dry = replace(whole.settings, radiation=False, diffraction=False, froude_krylov="body-nonlinear")
    bodies = prepare(replace(whole, settings=dry), None).bodies
    motion, random, found = new_motion(bodies), np.random.default_rng(3), np.zeros((len(bodies.axes), 6))
    for z in random.normal(size=(3, bodies.mechanism.size)):
        move(bodies, z, np.zeros(z.size), motion)
        for b, n in enumerate(bodies.axes):
            found[b] = np.maximum(found[b], np.abs(motion.jacobian[b, :, :n]).max(axis=1, initial=0.0))
    assert of_scene(whole) == tuple(tuple(d for d, x in zip(DOFS, row, strict=True) if x > 1e-12) for row in found)
