"""Rigid bodies without water: floats whose axes are not their principal ones, and what swings without loss."""

from dataclasses import replace

import numpy as np
import pytest
from pytest import approx

from solver.errors import InputError
from solver.hydrodynamics.hull.revolution import Revolution
from solver.reference.run import _body
from solver.rigid import inertia_tensor
from solver.run import simulate
from solver.scene import Float, Scene
from solver.sea.realization import CALM
from tests import awkward

BALL, BEAD = (Revolution.sphere(radius=r, draft=r) for r in (1.0, 0.03))
DRY = {"radiation": False, "diffraction": False, "froude_krylov": "none"}
BRIEF = {"duration": 4.0, "discard": 0.0, "ramp": 0.0}
TURNS = ("roll", "pitch", "yaw")
ONE = Float(
    name="one", hull=BALL, mass=3000.0, inertia=(800.0, 1500.0, 1100.0), cog=(0.2, -0.1, -0.3), hinge=(0, 0, 1.0),
    arm=(0, 0, -1.0), motion=TURNS, stiffness=(4e4, 5e4, 2e4), offset=(0.5, -0.4, 0.7), damping=(300.0,) * 3,
)  # fmt: skip
OTHER = Float(
    name="other", hull=BEAD, mass=400.0, inertia=(150.0, 90.0, 120.0), cog=(0.3, 0.5, -0.7), hinge=(1.5, 0.8, 1.0),
    arm=(0, 0, -1.0), motion=(), on="one",
)  # fmt: skip


def still(*floats, **settings) -> Scene:
    return awkward.scene(floats, depth=np.inf, waves=CALM, **DRY | BRIEF | settings)


def together() -> Float:
    """Both as one body, by Steiner's theorem."""
    mass, tensor = ONE.mass + OTHER.mass, np.zeros((3, 3))
    at = {f: np.array(f.centre - ONE.centre + f.cog) for f in (ONE, OTHER)}
    cog = sum(f.mass * place for f, place in at.items()) / mass
    for f, place in at.items():
        r = place - cog
        tensor += inertia_tensor(f.inertia, (0, 0, 0)) + f.mass * (r @ r * np.eye(3) - np.outer(r, r))
    products = tuple(-tensor[i, j] for i, j in ((0, 1), (0, 2), (1, 2)))
    return replace(ONE, mass=mass, cog=tuple(cog), inertia=tuple(np.diag(tensor)), products_of_inertia=products)


def test_two_rigid_parts_are_one_body_with_their_products_of_inertia():
    """Turning by up to 0.7 rad about three axes."""
    plain = replace(together(), products_of_inertia=(0.0, 0.0, 0.0))
    scenes = (still(*floats) for floats in ((ONE, OTHER), (together(),), (plain,)))
    apart, one, other = (simulate(item, awkward.vacuum(item)) for item in scenes)
    exact, told = apart.variables["motion"][1][0], one.variables["motion"][1][0]
    assert np.abs(exact[:, :2]).max() > 0.4
    assert told == approx(exact, abs=1e-6)
    without = other.variables["motion"][1][0]
    assert np.abs(without - exact).max() > 0.02
    assert one.variables["system_period"][1] == approx(apart.variables["system_period"][1], rel=1e-9)


def test_the_papers_formulation_has_them_too():
    body = _body(together(), np.zeros(3), np.eye(3))
    assert body.inertia_tensor == approx(together().inertia_tensor)


@pytest.mark.parametrize(("products", "planar"), [((0, 50.0, 0), True), ((50.0, 0, 0), False), ((0, 0, 50.0), False)])
def test_a_body_that_is_no_mirror_image_leaves_the_plane(products, planar):
    flat = {"motion": ("surge", "heave", "pitch"), "offset": (0.0,) * 3, "cog": (0.2, 0, -0.3)}
    item = replace(ONE, **flat, products_of_inertia=products)
    assert still(item).planar is planar


def test_no_body_has_a_principal_moment_above_the_sum_of_the_others():
    replace(ONE, inertia=(100.0,) * 3, products_of_inertia=(49.9, 0, 0))
    with pytest.raises(InputError, match="triangle inequality"):
        replace(ONE, inertia=(100.0,) * 3, products_of_inertia=(50.1, 0, 0))


@pytest.mark.parametrize("damping", [0.0, 1.0])
def test_a_decay_that_loses_next_to_nothing_is_judged_by_what_swings(damping):
    """Two springs whose axes take energy from each other, whose sum stays: it goes to and fro as an offset has it."""
    swinging = Float(
        name="b", hull=BALL, mass=2146.755, inertia=(800.0,) * 3, cog=(0.4, 0, 0), hinge=(0, 0, 0),
        damping=(damping,) * 2, motion=("surge", "yaw"), stiffness=(4000.0, 3000.0), offset=(0.5, 0.8),
    )  # fmt: skip
    attrs = simulate(still(swinging, duration=60.0)).attrs
    assert attrs["repeated"] == "" and 1e-6 < attrs["energy_residual"] < 3e-4
