"""Bodies that stand on the seabed: MacCamy and Fuchs's cylinder, the limit of a narrow gap, what the ground bears."""

import re
from dataclasses import replace
from math import inf

import numpy as np
import pytest
from pytest import approx
from scipy.special import h1vp

from solver.coupled.boundary import coefficients
from solver.coupled.preparation import prepare
from solver.errors import InputError
from solver.hydrodynamics.bem import bem
from solver.hydrodynamics.hull.box import box
from solver.hydrodynamics.hull.panel_hull import PanelHull
from solver.hydrodynamics.hull.revolution import Revolution
from solver.hydrodynamics.hull.standing import stands
from solver.run import simulate
from solver.scene import Float, Scene, Settings, Water
from solver.sea.dispersion import wavenumber
from solver.sea.realization import realize
from solver.sea.spectrum import PiersonMoskowitz
from tests.once import solve

RHO, G = 1025.0, 9.81
BALL = Revolution.hemisphere_cylinder(radius=1.0, height=0.6)
CAISSON = box(length=3.0, width=5.0, height=8.0, draft=6.0)
PLACES = np.array([[3.0, -2.0, 0.0], [6.5, 1.0, 0.0]])
IN_LINE = PLACES * (1, 0, 1)


def excitation(h):
    return h.diffraction + h.froude_krylov


def test_the_forces_on_a_cylinder_are_maccamys_and_fuchss():
    """F = 4ρg tanh(kh) / (k² H₁'(ka)) along the waves, about the seabed M = F (kh tanh kh + sech kh - 1) / (k tanh kh).

    MacCamy and Fuchs (1954), Wave forces on piles; off the origin, with the phase of the wave there.
    """
    a, depth, x = 4.0, 20.0, 7.0
    hull = Revolution.vertical_cylinder(radius=a, draft=depth, freeboard=3.0)
    h = bem.solve((hull,), [[x, 0, 0]], depth=depth, omega=np.array([0.35, 1.2, 2.0]), density=RHO, panels=108)
    k = wavenumber(h.omega, depth, G)
    kh = k * depth
    force = 4 * RHO * G * np.tanh(kh) / (k**2 * h1vp(1, k * a)) * np.exp(1j * k * x)
    moment = force * (kh * np.tanh(kh) + 1 / np.cosh(kh) - 1) / (k * np.tanh(kh))
    surge, heave, pitch = excitation(h).T
    assert np.abs(surge / force - 1).max() < 3e-3 and np.abs((pitch + depth * surge) / moment - 1).max() < 3e-3
    assert np.abs(heave).max() < 1e-9 * np.abs(surge).max()
    assert h.settings["seabed_error"] == 0  # it is never left out


@pytest.mark.slow
def test_a_caisson_is_the_limit_of_one_over_a_narrow_gap():
    """In oblique waves, on it and on a float beside it, off the origin: half the gap is half the way to the limit."""

    def forces(gap):
        hull = box(length=3.0, width=5.0, height=8.0 - gap, draft=6.0 - gap)
        water = {"depth": 6.0, "omega": np.array([1.4]), "heading": 0.4, "planar": False, "panels": 216}
        h = solve((hull, BALL), PLACES, **water)
        return excitation(h)[0, [0, 1]], excitation(h)[0, 6:]

    limit, near, far = (forces(gap) for gap in (0.0, 0.1, 0.2))
    for which, off in ((0, 0.1), (1, 0.02)):
        there, halfway = (np.linalg.norm(x[which] - limit[which]) for x in (far, near))
        assert halfway / there == approx(0.5, abs=0.08) and there < off * np.linalg.norm(limit[which])


def scene(**settings):
    stood = Float(name="caisson", hull=CAISSON, mass=3e5, inertia=(1e6,) * 3, hinge=tuple(IN_LINE[0]), motion=())
    ball = Float(
        name="ball", hull=BALL, mass=RHO * BALL.volume, inertia=(859.0,) * 3, hinge=tuple(IN_LINE[1]),
        motion=("heave",), pto_damping=2e3,
    )  # fmt: skip
    waves = realize(PiersonMoskowitz(Hs=0.3, Tp=4.5), components=20, band=(0.9, 2.4), seed=1)
    chosen = {"duration": 40.0, "discard": 10.0, "ramp": 5.0, "radiation": False} | settings
    return Scene(water=Water(depth=6.0), sea=waves, floats=(stood, ball), settings=Settings(**chosen))


@pytest.mark.slow
def test_the_ground_bears_weight_less_buoyancy_and_the_waves_on_the_walls():
    """Whether the float beside it is linear or not; the foot feels the water's pressure at rest, and no wave's."""
    h = solve((CAISSON, BALL), IN_LINE, depth=6.0, omega=np.linspace(0.8, 2.5, 5), panels=108)
    records = [simulate(scene(froude_krylov=kind), h) for kind in ("linear", "body-nonlinear")]
    one, other = (r.variables["hinge_force"][1][0] for r in records)
    assert one == approx(other, rel=1e-9, abs=1e-3)
    statistic = list(records[0].coords["statistic"])
    assert one[2, statistic.index("mean")] == approx((3e5 - RHO * CAISSON.volume) * G, rel=1e-6)
    assert one[2, statistic.index("std")] < 1e-6 * one[0, statistic.index("std")]
    item = scene(method="frequency", froude_krylov="linear")
    std = np.sqrt(np.sum(np.abs(h.excitation(item.sea.omega)[:, 0] * item.sea.amplitude) ** 2) / 2)
    assert simulate(item, h).variables["hinge_force"][1][0, 0, statistic.index("std")] == approx(std, rel=1e-9)


def test_coefficients_are_of_the_waves_on_what_stands_and_of_these_hulls():
    """Whose pressure is linear beside a float whose is not; a hull of the same form a hundredth larger is another."""
    item = scene(diffraction=False)
    h = coefficients(item)
    with pytest.raises(InputError, match=r"sea.heading = 0.3: must be 0 rad, that of the coefficients"):
        prepare(replace(item, sea=replace(item.sea, heading=0.3)), h)
    stood, ball = item.floats
    larger = Revolution.hemisphere_cylinder(radius=1.01, height=0.6)
    with pytest.raises(InputError, match=r"floats.ball.hull = 22\d\d.* kg displaced: must displace 21\d\d"):
        prepare(replace(item, floats=(stood, replace(ball, hull=larger))), h)


def test_what_stands_has_a_flat_foot_and_does_not_move():
    deep = Revolution.profile([(3.0, -6.0), (1.0, -4.0), (1.0, 2.0)])
    assert stands(deep, 6.0) and not stands(deep, 6.1) and not stands(deep, inf) and stands(CAISSON, 6.0)
    assert not stands(Revolution.sphere(radius=4.0, draft=6.0), 6.0)  # which touches it
    assert not stands(Revolution.profile([(0.0, -6.0), (3.0, -4.0), (3.0, 2.0)]), 6.0)
    with pytest.raises(InputError, match=r"caisson.hull = .*: must stay above the seabed, 6 m, or with motion = \[\]"):
        replace(scene(), floats=(replace(scene().floats[0], motion=("surge",)),))
    caisson, most = scene().floats[0], "above the seabed, 6 m, or with motion = [] stand on it with a flat foot"
    inclined = CAISSON.vertices + np.outer((CAISSON.vertices[:, 2] == -6.0) & (CAISSON.vertices[:, 0] > 0), (0, 0, 0.1))
    large = box(length=30.0, width=50.0, height=80.0, draft=60.0), " (hull.scale is 0.001 of a mesh in mm)"
    for hull, told in ((PanelHull.of(inclined, CAISSON.faces), ", which its mesh must have"), large):
        with pytest.raises(InputError, match=re.escape(most + told) + "$"):
            replace(scene(), floats=(replace(caisson, hull=hull),))
    with pytest.raises(InputError, match="the same where a flat foot stands"):
        bem.solve((Revolution.sphere(radius=4.0, draft=6.0),), [[0, 0, 0]], depth=6.0)
    stood, ball = scene().floats
    base = replace(ball, name="base", hinge=(-20.0, 0.0, 0.0))
    with pytest.raises(InputError, match="must not be carried by base, which moves"):
        replace(scene(), floats=(base, replace(stood, on="base"), ball))
