"""Rotors on a floating platform: limits in which the answer is that of a simpler scene."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from pytest import approx

from solver.balance import imbalance
from solver.coupled.preparation import prepare
from solver.frequency.response import respond
from solver.hydrodynamics.hull.duck import duck
from solver.scene import Float
from solver.sea.realization import components
from tests.awkward import RHO, known, rotors, scene

OMEGA = np.linspace(0.9, 2.9, 9)
WAVES = components(amplitude=np.full(OMEGA.size, 0.01), omega=OMEGA, phase=np.zeros(OMEGA.size))
HELD = {"motion": (), "stiffness": 0.0, "damping": 0.0}


@cache
def coefficients():
    return known(rotors(), 0.8, 3.0, 6)


def response(item, h):
    """Of the joints' axes to waves of unit height (nw, nj)."""
    item = replace(item, sea=WAVES, settings=replace(item.settings, method="frequency"))
    return respond(item, h).Z / 0.01


def test_nothing_is_out_of_balance():
    item = rotors()
    item = replace(item, settings=replace(item.settings, method="frequency"))
    assert [text for f in item.floats for text in imbalance(f, item.water, item.floats)] == []
    assert np.abs(prepare(item, coefficients()).equilibrium[0]).max() < 1e-9


@pytest.mark.parametrize("how", [pytest.param("stiff", marks=pytest.mark.slow), "heavy"])
def test_a_platform_that_hardly_moves_is_a_fixed_axis(how):
    """By the mooring alone, or by its mass, whose weight a constant load bears; in proportion to how little."""
    h, gaps = coefficients(), []
    fixed = response(rotors(**HELD), h)
    for much in (1e5, 1e7):
        if how == "stiff":
            item = rotors(stiffness=(1e5 * much, 1e5 * much, 1e6 * much))
        else:
            barge, *others = rotors().floats
            more = (much / 100 - 1) * barge.mass
            barge = replace(  # no pendulum: its weight acts at the height of the joint
                barge, mass=barge.mass + more, inertia=tuple(i * much / 100 for i in barge.inertia),
                cog=(barge.cog[0], 0.0, 0.0), preload=(0, 9.81 * more, -9.81 * more * (barge.cog[0] - 0.5)),
            )  # fmt: skip
            item = replace(rotors(), floats=(barge, *others))
        free = response(item, h)
        assert np.abs(free[:, :3]).max() < 1e5 / much
        gaps.append(np.abs(free[:, 3:] - fixed).max() / np.abs(fixed).max())
    assert gaps[0] < 0.1 and gaps[1] == approx(gaps[0] / 100, rel=0.2)


def test_locked_rotors_are_one_body_with_the_platform():
    """Against (K - ω²M - iω(D + B - iωA)) X = F of the whole, its terms summed over the bodies about the joint."""
    h, item = coefficients(), rotors(front=HELD | {"pto_damping": 0.0}, rear=HELD | {"pto_damping": 0.0})
    J, M, C = np.zeros((9, 3)), np.zeros((3, 3)), np.zeros((3, 3))
    for b, f in enumerate(item.floats):
        x = f.centre[0] - 0.5  # of the reference point from the joint, both at z = 0
        J[3 * b : 3 * b + 3] = np.eye(3) + np.outer([0, 1, 0], [0, 0, -x])
        gx, gz = x + f.cog[0], f.cog[2]
        inertia = f.inertia[1] + f.mass * (gx**2 + gz**2)
        M += [[f.mass, 0, f.mass * gz], [0, f.mass, -f.mass * gx], [f.mass * gz, -f.mass * gx, inertia]]
        C[2, 2] -= 9.81 * f.mass * gz
    # The platform's buoyancy turns where it is in the body: what is off the joint is in balance over the whole.
    C += J.T @ h.hydrostatic_stiffness @ J + np.diag([4e4, 0, 0])
    D, Y = np.diag([4e3, 1e3, 1e4]), J.T @ h.impedance(OMEGA) @ J  # B - iω A
    force = h.excitation(OMEGA) @ J
    exact = [np.linalg.solve(C - w**2 * M - 1j * w * (D + Y[k]), force[k]) for k, w in enumerate(OMEGA)]
    assert response(item, h) == approx(np.array(exact), rel=1e-6, abs=1e-7 * np.abs(exact).max())


def pair(*distances):
    """Small rotors alike in a row across the waves, on fixed axes, each at a distance from the first [m]."""
    hull = duck(radius=0.6, beak=1.4, elevation=0.3, submergence=0.3, width=1.5)
    mass = RHO * hull.volume
    floats = [
        Float(
            name=f"r{y:g}", hull=hull, mass=mass, inertia=(0.5 * mass, 0.4 * mass, 0.5 * mass), hinge=(0, y, -0.3),
            arm=(0, 0, 0.3), cog=(hull.buoyancy_point[0], 0, -0.35), pto_damping=2e3,
        )
        for y in (0.0, *distances)
    ]  # fmt: skip
    return scene(floats, depth=np.inf, froude_krylov="linear")


@pytest.mark.slow
def test_rotors_far_apart_are_single_ones():
    """What the other sends spreads over a circle: its share falls as the root of the distance, here to 0.41."""
    alone = response(pair(), known(pair(), 0.8, 3.0, 12))[:, 0]
    gaps = []
    for distance in (10.0, 60.0):
        both = pair(distance)
        x = response(both, known(both, 0.85, 2.95, round(8 + distance)))
        assert x[:, 0] == approx(x[:, 1], rel=1e-6)
        gaps.append(np.abs(x[:, 0] / alone - 1).max())
    assert gaps[0] > 0.02 and gaps[1] < 0.55 * gaps[0]
