"""Wave loads on floats that slide are those of the waves where the float is."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from pytest import approx

from solver.coupled.moving import along_waves
from solver.coupled.preparation import prepare
from solver.coupled.sliding import leaders, places, rows
from solver.hydrodynamics.hull.revolution import Revolution
from solver.multibody.bodies import new_motion, pressure_room
from solver.multibody.minimal import move, pressures
from solver.run import simulate
from solver.scene import Float
from solver.sea.field import wave_field
from solver.sea.realization import regular
from tests.awkward import BALL, BUOYED, RHO, known, scene, sea
from tests.record.test_beside import soft

SOFT = 1500.0  # [N/m]


@cache
def moored(heading=0.0, far=0.0, preload=0.0, **settings):
    """A drum on soft springs that carries a ball on an arm, given `far` along the waves or pulled there by a load."""
    drum = Revolution.vertical_cylinder(radius=3.0, draft=2.0, freeboard=2.0)
    ahead, mass = np.array([np.cos(heading), np.sin(heading), 0.0]), RHO * drum.volume - 0.35 * BUOYED
    motion = ("surge", "sway", "heave", "pitch") if heading else ("surge", "heave")
    of_axis = {"stiffness": (SOFT, SOFT, 0.0, 0.0), "damping": (1e4, 1e4, 2e4, 2e5), "preload": (*preload * ahead, 0.0)}
    axes = [("surge", "sway", "heave", "pitch").index(axis) for axis in motion]
    carrier = Float(
        name="drum", hull=drum, mass=mass, inertia=(6 * mass,) * 3, hinge=tuple(far * ahead), cog=(0.1, 0, -0.5),
        motion=motion, **{name: tuple(values[i] for i in axes) for name, values in of_axis.items()},
    )  # fmt: skip
    ball = Float(
        name="ball", on="drum", hull=BALL, mass=BUOYED, inertia=(0.4 * BUOYED,) * 3, arm=(4.0, 0, -1.5),
        hinge=tuple(far * ahead + np.array([4.0, 0, 1.5])), pto_damping=4e4,
    )  # fmt: skip
    waves, chosen = sea(Hs=1.2, Tp=5.0, band=(0.8, 2.6), heading=heading), {"time_step": 0.08, "duration": 120.0}
    whole = scene([carrier, ball], waves=waves, froude_krylov="body-nonlinear", discard=40.0, **chosen, **settings)
    return whole, known(whole, 0.7, 2.8, 12)


@pytest.mark.parametrize("heading", [pytest.param(0.0, marks=pytest.mark.slow), 0.6])
def test_a_float_pulled_along_the_waves_goes_as_one_let_go_there(heading):
    """By a wavelength of the shorter ones: all of the record but the place is that of the scene moved there."""
    far = 6.0
    there, pulled = simulate(*moored(heading, far)), simulate(*moored(heading, preload=far * SOFT))
    for name in ("rotation", "hinge_force", "absorbed_power"):
        expected = there.variables[name][1]
        assert pulled.variables[name][1] == approx(
            expected, rel=1e-4, abs=1e-4 * np.nanmax(np.abs(expected)), nan_ok=True
        )
    way = pulled.variables["motion"][1] - there.variables["motion"][1]
    assert way[0, 0, 0] == approx(far * np.cos(heading), abs=1e-3)


def test_loads_are_those_of_each_wave_where_the_float_is():
    """Within the field's tolerance of the sum of all, as far as the series of the pressure reaches."""
    system, (item, h) = prepare(*moored(0.6)), moored(0.6)
    force = (h.excitation(item.sea.omega, "diffraction") * item.sea.amplitude[:, None]).T.reshape(2, 6, -1)
    body, motion, rng, loads = system.bodies, new_motion(system.bodies), np.random.default_rng(2), np.empty((2, 2, 6))
    swing = along_waves(system, h)[[0, 0]]
    left = item.settings.field_tolerance * np.abs(force).sum(axis=-1).reshape(2, 2, 3).max(axis=-1)
    for t, share in zip(rng.uniform(0, 300, 8), rng.uniform(-0.7, 0.7, 8), strict=True):
        far, turn = share * body.reach[0], np.exp(-1j * item.sea.omega * t)
        move(body, np.array([far * np.cos(0.6), far * np.sin(0.6), 0.1, 0.05, -0.1]), np.zeros(5), motion)
        samples = np.real(system.rows[system.layout.field] @ turn).copy()
        pressures(body, motion, samples, pressure_room(body), loads[0])
        samples[2 * body.first_term[-1] :] = 0.0
        pressures(body, motion, samples, pressure_room(body), loads[1])
        s = way = ((motion.position - body.reference) @ system.waves.direction)[[0, 0]]
        for _ in range(9):
            s = way - (swing * np.exp(1j * system.waves.k * s[:, None]) @ turn).real
        expected = (force * np.exp(1j * system.waves.k * s[:, None])[:, None] @ turn).real
        assert np.all(np.abs(loads[0] - loads[1] - expected) <= np.repeat(left, 3, axis=1))


def test_what_does_not_slide_along_the_waves_has_loads_at_rest():
    item, h = moored()
    waves = prepare(item, h).waves
    hinged = replace(item.floats[1], on="", name="alone")
    column = replace(hinged, hinge=(4.0, 0, -20.0), arm=(0, 0, 20.0))
    across = replace(item.floats[0], motion=("sway", "heave"))
    assert leaders(item, waves) == (0, 0)
    for alone, leader in ((hinged, -1), (column, 0), (across, -1)):
        assert leaders(replace(item, floats=(alone,)), waves) == (leader,)
    system = prepare(replace(item, settings=replace(item.settings, froude_krylov="linear")), h)
    assert system.bodies.reach.tolist() == [0, 0] and np.all(system.rows[system.layout.excitation].any(axis=1)[[0, 2]])


def test_terms_are_as_few_as_the_reach_asks_for():
    force, k = np.ones((1, 3, 4), complex), np.array([0.1, 0.3, 0.9, 1.6])
    counts = [places(force, k, (0,), (r,), 1e-4).terms[0] for r in (0.0, 0.1, 1.0, 10.0)]
    assert counts[0] == 0 and counts[1] < counts[2] < counts[3] < 1.6 * 10 + 20
    assert places(0 * force, k, (0,), (10.0,), 1e-4).terms == (0,)
    assert rows(force, k, places(force, k, (0,), (10.0,), 1e-4)).shape == (counts[3], 3, 4)


def test_only_what_keeps_the_phases_of_rest_is_told_to_have_strayed():
    (far, h), near = moored(preload=6 * SOFT), moored(preload=0.8 * SOFT)[0]
    near = replace(near, sea=replace(near.sea, amplitude=near.sea.amplitude / 4))  # 1 m: 0.3 rad
    for item, kind, told in ((far, "body-nonlinear", False), (far, "linear", True), (near, "linear", False)):
        kept = replace(item, settings=replace(item.settings, froude_krylov=kind))
        said = [text for text in simulate(kept, h).attrs.get("warnings", "").split("; ") if "phases of" in text]
        assert bool(said) is told


@pytest.mark.parametrize(("away", "turns", "own"), [(25.0, "yaw", True), (25.0, "heave", False), (4.5, "yaw", False)])
def test_what_stands_far_out_on_a_carrier_that_turns_has_a_place_of_its_own(away, turns, own):
    item, _ = moored()
    hub = replace(item.floats[0], motion=(turns,), stiffness=(1e5,), damping=(0.0,), preload=(0.0,))
    post = replace(item.floats[1], on=hub.name, hinge=(-4.0, away, 1.5), motion=(), pto_damping=0.0)
    field = wave_field(item.sea, item.water.depth, item.water.gravity, None)
    assert leaders(replace(item, floats=(hub, post)), field) == (-1, 1 if own else -1)


def test_the_mean_force_of_a_wave_does_not_go_by_how_far_it_pushes():
    """0.11 m or 0.27 m on springs of 1000 and 400 N/m, 4 % of the wave's length: with the phases of rest 48 % more."""
    item, h = soft(400.0, 4e3)
    settings = replace(item.settings, duration=40 * 5.71, discard=1000.0)
    waves = regular(height=1.0, period=5.71)
    force = []
    for spring in (1000.0, 400.0):
        buoy = replace(item.floats[0], stiffness=(spring, 0.0))
        record = simulate(replace(item, sea=waves, settings=settings, floats=(buoy,)), h)
        force.append(spring * record.variables["motion"][1][0, 0, 2])
    assert force[1] == approx(force[0], rel=0.02)


def test_a_float_that_drifts_from_its_neighbour_is_told_so_and_none_that_drift_together():
    """What they radiate and scatter to each other is that at their distance at rest."""
    item, h = moored(preload=6 * SOFT)
    wall = replace(item.floats[1], name="wall", on="", hinge=(4.0, 0, 1.5), motion=(), pto_damping=0.0)
    for floats, told in ((item.floats, False), ((item.floats[0], wall), True)):
        said = simulate(replace(item, floats=floats), h).attrs.get("warnings", "")
        assert ("along the waves, 2" in said and "its place at rest beside floats.wall" in said) is told
        assert "floats.wall went" not in said


@pytest.mark.parametrize("heading", [pytest.param(0.0, marks=pytest.mark.slow), np.pi / 4])
def test_a_float_held_on_both_axes_goes_as_far_along_oblique_waves_as_along_others(heading):
    """A buoy pulled 20 m, all of it along the waves, and the field about it is as good there."""
    far, ahead = 20.0, np.array([np.cos(heading), np.sin(heading)])
    item = moored(heading)[0]
    drum = replace(
        item.floats[0], motion=("surge", "sway", "heave"), stiffness=(SOFT, SOFT, 0.0), damping=(1e4, 1e4, 2e4),
        preload=(*(far * SOFT * ahead), 0.0), mass=RHO * item.floats[0].hull.volume,
    )  # fmt: skip
    alone = replace(item, floats=(drum,))
    record = simulate(alone, known(alone, 0.7, 2.8, 12))
    assert record.attrs["field_error"] < 1e-2
    assert record.variables["motion"][1][0, :2, 2] @ ahead == approx(far, abs=1.5)


def test_waves_too_short_to_be_summed_push_a_float_where_it_is():
    item = moored()[0]
    drum = replace(item.floats[0], mass=RHO * item.floats[0].hull.volume, preload=(6 * SOFT, 0.0), offset=(6.0, 0.0))
    alone = replace(item, floats=(drum,), sea=regular(height=0.05, period=1.2))
    there = replace(alone, floats=(replace(drum, preload=0.0, hinge=(6.0, 0, 0)),))
    (pulled, system), (given, _) = (
        (simulate(each, h), prepare(each, h)) for each, h in ((x, known(x, 0.7, 5.6, 12)) for x in (alone, there))
    )
    assert not system.near.sea.amplitude.any() and np.isfinite(system.bodies.reach).all()
    assert pulled.variables["hinge_force"][1] == approx(given.variables["hinge_force"][1], rel=1e-3, abs=2.0)
