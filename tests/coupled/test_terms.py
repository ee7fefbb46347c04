"""The wave field around each float is known as far as that float gets, by terms of its own."""

from dataclasses import replace

import numpy as np
import pytest
from pytest import approx

from solver import limits
from solver.coupled.natural import require_stable
from solver.coupled.preparation import prepare
from solver.hydrodynamics.hull.panel_hull import PanelHull
from solver.mooring import Line, Mooring
from solver.multibody.bodies import new_motion, pressure_room
from solver.multibody.minimal import move, pressures
from solver.multibody.way import ways
from solver.run import simulate
from solver.scene import Float
from solver.sea.realization import CALM
from tests import awkward
from tests.awkward import BALL, BUOYED, RHO, big_beside_small, rotors, sea, soft_mooring
from tests.hydrodynamics.shapes import box


def bare(item, **settings):
    """The scene by pressure alone, which asks for no coefficients."""
    asked = {"froude_krylov": "body-nonlinear", "radiation": False, "diffraction": False} | settings
    return replace(item, settings=replace(item.settings, **asked))


def apart(item, y):
    """The scene with its floats moved across the waves, each by as much further than the one before."""
    floats = (replace(f, hinge=(f.hinge[0], f.hinge[1] + n * y, f.hinge[2])) for n, f in enumerate(item.floats))
    return replace(item, floats=tuple(floats))


def states(item, count=20):
    """Coordinates (count, nj) as far out as is reckoned with: 0.8 rad, 0.2 of what carries others, two wave heights."""
    height, carried = item.sea.parameters()["Hm0"], {f.on for f in item.floats}
    most = [
        2 * height if limits.slides(axis) else 0.2 if f.name in carried else 0.8
        for f in item.floats
        for axis in f.motion
    ]
    return np.random.default_rng(3).uniform(-1, 1, (count, len(most))) * most


def head(system, points, t):
    """Re Σ a cosh k(z+h)/cosh kh exp(i(ks - ωt)) at points (n, 3), of every wave by itself."""
    k, h = system.near.k, system.near.depth
    s, z = points @ system.near.direction, points[:, 2:]
    profile = np.exp(k * z) if np.isinf(h) else np.cosh(k * (z + h)) / np.cosh(k * h)
    return (system.near.sea.amplitude * profile * np.exp(1j * (s[:, None] * k - system.near.sea.omega * t))).sum(1).real


def gaps(system, terms):
    """Of each float the largest gap between so many terms and all waves, as a share of their sum (nb,)."""
    item, rng, worst = system.scene, np.random.default_rng(5), np.zeros(len(system.scene.floats))
    motion, still = new_motion(system.bodies), np.zeros(system.bodies.mechanism.size)
    for z, t in zip(states(item), rng.uniform(0, 500, 20), strict=True):
        move(system.bodies, z, still, motion)
        samples = np.real(system.rows[system.layout.field] @ np.exp(-1j * system.near.sea.omega * t))
        for b, (count, size) in enumerate(zip(terms, limits.radii(item), strict=True)):
            angle = rng.uniform(0, 2 * np.pi, 50)
            points = motion.position[b] + size * np.stack([np.cos(angle), 0 * angle, np.sin(angle)], axis=1)
            first, last = 2 * system.bodies.first_term[b : b + 2]
            real, imag = samples[first:last].reshape(2, -1)[:, :count]
            way = points - system.bodies.reference[b]
            series = np.polynomial.polynomial.polyval(way[:, 2] + 1j * way @ system.near.direction, real + 1j * imag)
            worst[b] = max(worst[b], np.abs(series.real - head(system, points, t)).max())
    return worst / np.abs(system.near.sea.amplitude).sum()


@pytest.mark.parametrize("made", [lambda: big_beside_small()[0], rotors], ids=["big beside small", "rotors"])
def test_the_series_around_each_float_is_the_whole_field_wherever_its_hull_gets(made):
    """Within the tolerance; with half the terms, or those of the smallest, it would not be."""
    item = made()
    system = prepare(bare(item), None)
    assert np.all(gaps(system, system.terms) < item.settings.field_tolerance)
    assert np.all(gaps(system, [n // 2 for n in system.terms]) > item.settings.field_tolerance)
    assert gaps(system, [min(system.terms)] * len(system.terms)).max() > item.settings.field_tolerance


def test_a_small_hull_beside_a_big_one_has_the_terms_that_it_has_alone():
    item = bare(big_beside_small()[0])
    system, alone = (prepare(replace(item, floats=floats), None) for floats in (item.floats, item.floats[1:]))
    assert system.terms[1] < system.terms[0] / 2 and alone.terms == system.terms[1:]
    assert system.bodies.surface_terms[1] < system.bodies.surface_terms[0]
    at = system.layout.field
    assert at.stop - at.start == 2 * sum(system.terms)
    assert np.all(system.rows[at][2 * system.terms[0] :] == alone.rows[alone.layout.field])
    # And its slides end where its own series does.
    guided = replace(item, floats=tuple(replace(f, motion=("heave",)) for f in item.floats))
    system = prepare(guided, None)
    for (low, high), terms, f in zip(system.bodies.limit, system.terms, guided.floats, strict=True):
        assert -low == high == system.near.radius_for(terms, limits.ROUGH) - f.hull.size


def test_without_waves_or_with_linear_pressure_there_are_next_to_no_terms():
    item = bare(big_beside_small()[0])
    calm = replace(item, sea=replace(item.sea, amplitude=0 * item.sea.amplitude))
    assert prepare(calm, None).terms == (1, 1)
    assert prepare(bare(item, froude_krylov="none"), None).terms == (0, 0)


@pytest.mark.parametrize("formulation", ["minimal", "augmented"])
def test_floats_that_feel_no_waves_are_afloat_all_the_same(formulation):
    """Whatever else is left out, too: K = ρgA."""
    item = Float(
        name="ball", hull=BALL, mass=BUOYED, inertia=(800.0,) * 3, hinge=(0, 0, 0), motion=("heave",), offset=0.1
    )
    whole = awkward.scene(
        (item,), waves=CALM, froude_krylov="none", radiation=False, diffraction=False, formulation=formulation,
        duration=8.0, discard=0.0, ramp=0.0, time_step=0.05, keep_series=True,
    )  # fmt: skip
    record = simulate(whole)
    z, t = record.series["motion"][1][:, 0, 0], record.series["time"][1]
    assert z == approx(0.1 * np.cos(np.sqrt(1025 * 9.81 * np.pi / BUOYED) * t), abs=1e-4)


def left_out(system, z):
    """By the series about the floats at states z (m, nz)."""
    left = limits.LeftOut(system.scene, system.near, system.terms)
    left.add(ways(system.bodies, z))
    return left


def loaded(system, t=77.0):
    """Loads (m, nb, 6) of the pressure on all floats at some states."""
    motion, room = new_motion(system.bodies), pressure_room(system.bodies)
    samples = np.real(system.rows[system.layout.field] @ np.exp(-1j * system.near.sea.omega * t)).copy()
    loads = np.zeros((20, len(system.scene.floats), 6))
    for z, load in zip(states(system.scene), loads, strict=True):
        move(system.bodies, z, np.zeros(z.size), motion)
        pressures(system.bodies, motion, samples, room, load)
    return loads


def test_what_lies_off_the_middle_and_stays_in_its_plane_is_as_in_the_middle():
    """Meshes and hulls of revolution in waves along x: half of each is integrated, in as many terms."""
    for item in (rotors(), big_beside_small()[0]):
        middle, off = (prepare(bare(apart(item, y)), None) for y in (0.0, 5.0))
        assert middle.scene.planar and not off.scene.planar
        assert off.terms == middle.terms and loaded(off) == approx(loaded(middle), rel=1e-12, abs=1e-9)
        errors = [left_out(x, 0.3 * np.ones((1, x.bodies.mechanism.size))).largest for x in (off, middle)]
        assert errors[0] == approx(errors[1], rel=1e-12) and errors[0] > 0


def test_halves_are_of_hulls_alone_that_are_symmetric_and_stay_in_their_plane():
    """Not of a box beside its middle, nor where a barge rolls, with what it carries, or waves come from the side."""
    item = bare(rotors())
    side = PanelHull.of(*box((2.0, 2.0, 2.0), (0, 0.3, 0)))
    beside = Float(name="side", hull=side, mass=RHO * 4, inertia=(2e3,) * 3, hinge=(0, 9, 0), motion=("heave",))
    ball = replace(beside, name="ball", hull=BALL, mass=BUOYED, hinge=(0, 15, 0))
    barge = replace(item.floats[0], motion=("heave", "roll"), stiffness=0.0, damping=0.0)
    more, rolling = (replace(item, floats=x) for x in ((*item.floats, beside, ball), (barge, *item.floats[1:])))
    askew = replace(item, sea=sea(Hs=0.5, Tp=4.5, band=(0.8, 3.0), heading=0.3))
    halves = [prepare(one, None).bodies.panels.copies.tolist() for one in (item, more, rolling, askew)]
    assert halves == [[2.0] * 3, [2.0, 2.0, 2.0, 1.0, 1.0], [1.0] * 3, [1.0] * 3]


def test_the_field_reaches_where_a_preload_brings_what_springs_alone_hold():
    """Preload or line: the series is about there, of as many terms as where it is given, and its slides end there."""
    whole = bare(soft_mooring()[0])
    stiffness = whole.floats[0].stiffness

    def pushed(surge, **changes):
        item = replace(whole.floats[0], preload=(surge, 0.0, 0.0), **changes)
        return prepare(replace(whole, floats=(item,)), None)

    taut = Line(anchor=(100.0, 0, -50.0), fairlead=(5.0, 0, 0), length=80.0, weight=500.0, EA=1e7)
    moored = {"mooring": Mooring(stiffness=(stiffness, (0, 0, 0), (0, 0, 0))), "stiffness": 0.0}
    far, alike = (pushed(12.0 * stiffness[0], **springs) for springs in ({}, moored))
    require_stable(far)
    assert far.joints_at_rest[0] == approx(12.0)
    still = pushed(0.0)
    assert alike.terms == far.terms == still.terms
    assert far.bodies.about[0] - still.bodies.about[0] == approx([12.0, 0, 0], abs=1e-9)
    assert far.bodies.limit[0] - still.bodies.limit[0] == approx(12.0)
    pulled = pushed(0.0, lines=(taut,))
    require_stable(pulled)
    assert pulled.joints_at_rest[0] > still.bodies.limit[0, 1]
    assert pulled.bodies.about[0, 0] == approx(pulled.joints_at_rest[0] + still.bodies.about[0, 0])
