"""The bound on power: what a tuned body takes in linear theory, and a warning above it."""

from dataclasses import replace
from math import inf

import numpy as np
import pytest
from pytest import approx
from scipy.interpolate import CubicSpline

from solver.hydrodynamics.hull.box import box
from solver.hydrodynamics.hull.panel_hull import PanelHull
from solver.hydrodynamics.hull.revolution import Revolution
from solver.hydrodynamics.hull.ring import ring
from solver.record.bound import above, largest_power, power_per_wavenumber, wave_power
from solver.run import simulate
from solver.scene import Float, Scene, Settings, Water
from solver.sea.realization import Realization
from tests.once import solve

OMEGA = 1.3  # [rad/s]
HULL = Revolution.sphere(radius=5.0, draft=5.0)


def ball(motion, **law):
    mass = 1000.0 * HULL.volume
    return Float(name="ball", hull=HULL, mass=mass, inertia=(0.4 * mass * 25,) * 3, hinge=(0, 0, 0),
                 motion=(motion,), **law)  # fmt: skip


def scene(item, depth):
    sea = Realization(omega=np.array([OMEGA]), amplitude=np.array([0.1 + 0j]), peak_frequency=OMEGA)
    settings = Settings(method="frequency", froude_krylov="linear")
    return Scene(water=Water(depth=depth, density=1000.0), sea=sea, floats=(item,), settings=settings)


@pytest.mark.parametrize("motion, number, gain", [("heave", 1, 1.0), ("surge", 0, 2.0)])
@pytest.mark.parametrize("depth", [inf, pytest.param(9.0, marks=pytest.mark.slow)])
def test_a_tuned_body_takes_just_that(motion, number, gain, depth):
    """ω²(M + A) = C by a mechanism's inertia or a spring, and as much damping as it radiates: P = G J/k, to 1 %."""
    known = solve((HULL,), np.zeros((1, 3)), depth=depth, density=1000.0, omega=np.linspace(0.9, 1.7, 5), panels=300)
    A, B = (CubicSpline(known.omega, x[:, number, number])(OMEGA) for x in (known.added_mass, known.radiation_damping))
    item = ball(motion)
    missing = OMEGA**2 * (item.mass + A) - known.hydrostatic_stiffness[number, number]
    tuned = {"stiffness": missing} if missing > 0 else {"mechanism_inertia": -missing / OMEGA**2}
    item = replace(item, pto_damping=float(B), **tuned)
    whole = scene(item, depth)
    k = gain * 0.5 * 1000 * 9.81 * 0.1**2
    variables = simulate(whole, known).variables
    (power,), (width,) = variables["absorbed_power"][1][:, 2], variables["capture_width"][1]
    assert power == approx(largest_power(whole), rel=0.01)
    assert width == approx(power / wave_power(whole), rel=1e-12)
    if depth == inf:
        assert largest_power(whole) == approx(k * 9.81 / (2 * OMEGA) * 9.81 / OMEGA**2, rel=1e-9)


@pytest.mark.parametrize(
    ("motion", "arm", "axis", "gain"),
    [
        (("yaw",), (10.0, 0, 0), (0, 1, 0), 2), (("yaw",), (0.0, 0, 0), (0, 1, 0), 0),
        (("pitch",), (0, 0, -4.0), (0, 1, 0), 2), (("pitch",), (3.0, 0, -4.0), (0, 1, 0), 3),
        (("roll",), (0, 3.0, 0), (0, 1, 0), 3), (("hinge",), (4.0, 0, 0), (0, 0, 1), 2),
        (("hinge",), (4.0, 0, -1.0), (0, 1, 0), 3), (("heave", "sway"), (4.0, 0, 0), (0, 1, 0), 3),
        (("heave", "yaw"), (0, 0, 0), (0, 1, 0), 1),
    ],
)  # fmt: skip
def test_what_a_joint_moves_its_hull_by_is_what_it_radiates(motion, arm, axis, gain):
    item = replace(ball("heave"), motion=motion, arm=arm, hinge=tuple(-np.array(arm)), axis=axis)
    whole = scene(item, inf)
    assert largest_power(whole) == approx(gain * power_per_wavenumber(whole), rel=1e-12)


def test_waves_carry_what_their_group_does():
    """Deep, ρg²H²T/32π; in a hundredth of a wave's length of water ρgH²/8 √gh, to (kh)²/2; two waves are a sum."""
    deep, period = scene(ball("heave"), inf), 2 * np.pi / OMEGA
    assert wave_power(deep) == approx(1000 * 9.81**2 * 0.2**2 * period / (32 * np.pi), rel=1e-12)
    slow = Realization(omega=np.array([0.05]), amplitude=np.array([0.1j]), peak_frequency=0.05)
    shallow = replace(deep, water=Water(depth=15.0, density=1000.0), sea=slow)
    assert wave_power(shallow) == approx(1000 * 9.81 * 0.1**2 / 2 * np.sqrt(9.81 * 15.0), rel=0.05**2 * 15 / 9.81)
    both = Realization(omega=np.array([0.05, OMEGA]), amplitude=np.array([0.1j, 0.1]), peak_frequency=OMEGA)
    parts = wave_power(shallow) + wave_power(replace(shallow, sea=deep.sea))
    assert wave_power(replace(shallow, sea=both)) == approx(parts, rel=1e-12)


def taking(power):
    """Statistics of a float."""
    return {"absorbed_power": np.full((1, 5), power)}


def test_more_than_that_is_told():
    whole = scene(ball("heave", pto_damping=1e5), inf)
    most = largest_power(whole)
    assert list(above(whole, taking(0.99 * most), 0.0)) == []
    (told,) = above(whole, taking(1.5 * most), 0.2)
    assert list(above(whole, taking(1.5 * most), 0.3)) == []  # within its error
    assert "floats.ball absorbs" in told and "linear theory" in told
    # A float let go takes what it was lifted by, too.
    lifted = -0.6 * most * whole.settings.duration
    assert list(above(whole, taking(1.5 * most), 0.2, lifted)) == []
    assert list(above(whole, taking(1.5 * most), 0.2, -lifted)) == [told]
    two = replace(whole, floats=(*whole.floats, replace(whole.floats[0], name="other", hinge=(30.0, 0, 0))))
    assert largest_power(two) == inf


def test_rings_are_round_and_boxes_are_not():
    whole = scene(ball("heave", pto_damping=1e5), inf)

    def most(hull):
        return largest_power(replace(whole, floats=(replace(whole.floats[0], hull=hull),)))

    well = ring(((3.0, -4.0), (6.0, -4.0), (6.0, 2.0), (3.0, 2.0)))
    assert most(well) == largest_power(whole)
    assert most(box(length=4.0, width=4.0, height=3.0, draft=1.5)) == inf
    turned = well.vertices * np.where(np.arange(3) == 0, 1.001, 1.0)
    assert most(PanelHull.of(turned, well.faces)) == inf


@pytest.mark.parametrize("method", ["frequency", "time"])
@pytest.mark.parametrize("motion", ["yaw", "roll"])
def test_what_moves_by_rounding_alone_is_not_judged(motion, method):
    """A round float that waves cannot turn takes 1e-31 W, and a thousand times that is no more."""
    whole = scene(ball(motion, pto_damping=1e5, stiffness=1e6), inf)
    settings = Settings(method=method, froude_krylov="linear", duration=20 * np.pi / OMEGA, discard=30.0)
    whole = replace(whole, settings=settings)
    known = {"depth": inf, "density": 1000.0, "omega": np.linspace(0.5, 4.0, 20), "panels": 108, "planar": False}
    record = simulate(whole, solve((HULL,), np.zeros((1, 3)), **known))
    assert "warnings" not in record.attrs
    assert record.attrs["mesh_effect"] < 0.02, record.attrs
