"""The wave field around each float is known as far as that float gets, by terms of its own."""

from dataclasses import replace

import numpy as np
import pytest
from pytest import approx

from solver import limits
from solver.coupled.natural import require_stable
from solver.coupled.preparation import prepare
from solver.hydrodynamics.hull.panel_hull import PanelHull
from solver.hydrodynamics.hull.revolution import Revolution
from solver.mooring import Line, Mooring
from solver.multibody.bodies import new_motion, pressure_room
from solver.multibody.minimal import move, pressures
from solver.multibody.way import ways
from solver.remarks import left_series
from solver.run import simulate
from solver.scene import Float
from solver.sea.realization import CALM
from solver.statistics import STATISTICS
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
    left = limits.BeyondSeries(system.scene, system.near, system.terms)
    left.add(system.bodies, np.repeat(z, limits.THIN, axis=0))
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


def on_an_arm(turned, drawn=False, size=1.0, **changes):
    """A ball on an arm of 15 m across the waves at a size, which a preload holds turned by an angle, or drawn there."""
    at = np.array([-np.sin(turned) * 15, np.cos(turned) * 15, -2.0]) if drawn else np.array([0.0, 15.0, -2.0])
    item = Float(
        name="ball", hull=Revolution.hemisphere_cylinder(radius=1.5 * size, height=1.5 * size),
        mass=7245.3 * size**3, inertia=(1.5e4 * size**5,) * 3, cog=(0, 0, -0.3 * size), hinge=(0, 0, 2.0 * size),
        arm=tuple((at * size).tolist()), motion=("yaw", "heave"), damping=(3e6 * size**4.5, 2e4 * size**2.5),
        stiffness=(4e6 * size**4, 0.0), preload=(0.0 if drawn else 4e6 * size**4 * turned, 0.0),
    )  # fmt: skip
    waves = sea(Hs=size, Tp=4.5 * size**0.5, band=(0.7 / size**0.5, 3.8 / size**0.5))
    times = {"duration": 60.0 * size**0.5, "discard": 20.0 * size**0.5, "ramp": 10.0 * size**0.5}
    whole = awkward.scene((replace(item, **changes),), depth=40.0 * size, waves=waves, **times)
    return bare(whole)


@pytest.mark.parametrize("size", [1.0, 1 / 20])
def test_a_float_held_far_from_where_it_is_given_is_in_the_waves_of_its_rest(size):
    """As one that is drawn there: about where it is given the series of its reach is none."""
    told, drawn = (simulate(on_an_arm(-1.4, drawn, size)) for drawn in (False, True))
    stds, means = (
        [record.variables["motion"][1][0, :, k] for record in (told, drawn)]
        for k in (STATISTICS.index("std"), STATISTICS.index("mean"))
    )
    assert stds[0] == approx(stds[1], rel=1e-3)
    assert means[0] - [-1.4, 0] == approx(means[1], abs=1e-3 * stds[1].min())
    assert told.attrs["field_error"] < 1e-4
    assert "out of the series" not in told.attrs["warnings"]


def test_a_float_that_leaves_the_series_of_its_waves_is_told():
    """For as long as it is out: at its rest, or now and then for moments, it is not."""
    system = prepare(on_an_arm(-1.0), None)
    rest = system.joints_at_rest
    near, far = rest, rest + np.array([1.4, 0.0])
    for states, said in ((np.tile(near, (9, 1)), False), (np.tile(far, (9, 1)), True)):
        left = left_out(system, states)
        assert any("ball went" in note for note in left_series(system.scene, left)) == said
    way = ways(system.bodies, far[None])[0, 0]
    assert way == approx(15 * (np.sin(0.4) + np.sin(1.0)), rel=1e-6)
    whole = system.near.left_out(system.terms[0], limits.radii(system.scene)[0] + way)
    assert left.largest == approx(whole) and left.rms()[0] == approx(whole, rel=0.1)
    seldom = left_out(system, np.concatenate([np.tile(near, (99, 1)), far[None]]))
    assert seldom.largest == left.largest and seldom.rms()[0] == approx(left.rms()[0] / 10, rel=1e-6)


def test_what_rests_beside_where_it_is_given_by_little_keeps_its_middle():
    """Of what settles the series is about where it is given, and its bounds; heave's are of the water on a long arm."""
    settled, moved = (prepare(on_an_arm(turned), None) for turned in (-0.005, -1.4))
    assert np.all(settled.bodies.about == settled.bodies.reference) and settled.bodies.limit[1].sum() == 0
    assert moved.bodies.about[0] == approx([15 * np.sin(1.4), 15 * np.cos(1.4), 0.0])
    assert moved.bodies.limit[0].sum() == approx(-2.8) and moved.bodies.limit[1].sum() == approx(0, abs=1e-9)
