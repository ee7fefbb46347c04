"""Loads that go with time, in waves: short ones, those of modes that waves do not move, and coarse elements."""

from dataclasses import replace

import numpy as np
import pytest
from pytest import approx

from solver.coupled import support
from solver.coupled.histories import missed, moved
from solver.coupled.preparation import prepare
from solver.run import simulate
from solver.scene import Platform
from solver.sea.realization import CALM
from solver.structure import modes
from solver.structure.frame import Frame
from solver.structure.load_history import LoadHistory
from solver.structure.members import Member, PointMass
from solver.structure.sections import tube
from tests.awkward import STEEL, raking, scene, sea

SWELL = sea(Hs=0.02, Tp=8.0, band=(0.6, 1.0))


def struck(times, force, node="deck", cut=1, **settings):
    """The raking platform in a low swell; force along x at times, 0 before and after."""
    end = 80.0
    history = LoadHistory(
        node=node,
        time=np.array([0.0, *times, end]),
        force=np.outer([0.0, *force, 0.0], [1.0, 0.0, 0.0]),
    )
    item = raking()
    chosen = {"outputs": (), "time_step": None, "duration": 60.0, "discard": 20.0, "ramp": 5.0} | settings
    platform = replace(item.platform, load_histories=(history,), damping_ratio=0.01).cut(cut)
    return replace(item, sea=SWELL, platform=platform, settings=replace(item.settings, **chosen))


def blow(start, **settings):
    """A half sine of 50 ms."""
    at = np.linspace(0.0, 0.05, 11)
    return struck(start + at, 2e5 * np.sin(np.pi * at / 0.05).clip(min=0), **settings)


def ringing(omega, **settings):
    """A sine from 1 s on."""
    at = np.arange(1.0, 79.0, 2 * np.pi / omega / 40)
    return struck(at, 1e3 * np.sin(omega * (at - at[0])), **settings)


def stds(record):
    return record.variables["top_displacement"][1][..., 4]


def apart(ours, theirs):
    """Of what moves most."""
    used = theirs > 0.1 * theirs.max()
    return np.abs(ours[used] / theirs[used] - 1).max()


@pytest.mark.slow
def test_a_blow_does_the_same_whenever_it_comes():
    """Also between the samples of the step that the waves alone would have."""
    records = [simulate(blow(start)) for start in (30.0, 30.17, 30.29)]
    reference = simulate(blow(30.0, time_step=0.0025))
    for record in records:
        error = apart(stds(record), stds(reference))
        assert error < 3e-3 and error < 3 * record.attrs["estimated_error"] + 1e-4
    assert records[0].attrs["time_step"] < 0.1 * prepare(blow(30.0), None).scene.usual_step


def test_a_step_that_misses_a_blow_says_so():
    """Samples of half that step, too, are all beside it."""
    record, reference = simulate(blow(30.17, time_step=0.3)), simulate(blow(30.17, time_step=0.0025))
    error = apart(stds(record), stds(reference))
    assert error > 0.3 and 1 / 3 < error / record.attrs["discretization_error"] < 3


def test_what_a_step_misses_falls_with_it():
    system = prepare(blow(30.17), None)
    told = [missed(system, step) for step in (0.3, 0.04, 0.01, 0.0025)]
    assert told[0] > 0.3 and all(b < 0.5 * a for a, b in zip(told[:-1], told[1:], strict=True)) and told[-1] < 1e-3
    calm = replace(system.scene, platform=replace(system.scene.platform, load_histories=()))
    assert missed(prepare(calm, None), 0.3) == 0


@pytest.mark.slow
def test_modes_that_a_load_sets_swinging_are_kept():
    """One mode alone is asked for; the load rings the fourth."""
    omega = prepare(ringing(10.0, modes="all"), None).support.omega[3]
    few, every = (simulate(ringing(omega, modes=count)) for count in (1, "all"))
    error = apart(stds(few), stds(every))
    assert error < 0.02 and error < 3 * few.attrs["estimated_error"] + 1e-4
    system = prepare(ringing(omega, modes=1), None)
    assert np.abs(system.support.omega / omega - 1).min() < 1e-9
    assert approx(omega) in list(moved(system).swung)


@pytest.mark.parametrize("cut", [1, pytest.param(2, marks=pytest.mark.slow)])
def test_elements_that_shift_a_resonance_are_told(cut):
    omega = prepare(ringing(10.0, cut=8, modes="all"), None).support.omega[4]
    coarse, fine = (simulate(ringing(omega, cut=n)) for n in (cut, 8))
    error = apart(stds(coarse), stds(fine))
    assert error > 1e-3 and 1 / 3 < error / coarse.attrs["elements_effect"] < 3


def test_histories_choose_among_the_lowest_modes_of_a_large_frame(monkeypatch):
    scene = blow(30.11, cut=4, modes=2)
    usual = prepare(scene, None).support
    monkeypatch.setattr(modes, "LARGE", scene.platform.frame.freedoms - 1)
    for many, close in ((30, True), (2, False)):
        monkeypatch.setattr(modes, "MANY", many)
        support._reduced.cache_clear()
        few = prepare(scene, None).support
        assert (few.omega.size == usual.omega.size and few.omega == approx(usual.omega, rel=1e-6)) == close


def mast(shape, force, waves, foundation=None, **settings):
    """Two tubes through the points of `shape` with 3 t on top, off their axis; a triangle of 0.13 s halfway up."""
    nodes = dict(zip(("foot", "mid", "top"), shape, strict=True))
    members = [
        Member(name=name, start=start, end=end, elements=8, section=tube(0.5, 0.012), material=STEEL)
        for name, start, end in (("low", "foot", "mid"), ("high", "mid", "top"))
    ]
    mass = PointMass(node="top", mass=3e3, cog=(0.8, 0.0, 0.3), inertia=(500.0, 800.0, 600.0))
    stands = {"foundation": {"foot": foundation}} if foundation else {"clamped": ("foot",)}
    frame = Frame(nodes=nodes, members=tuple(members), masses=(mass,), **stands)
    time = np.array([0.0, 1.0, 1.05, 1.13, 30.0])
    blow = LoadHistory(node="mid", time=time, force=np.outer([0, 0, 1, 0, 0], force))
    platform = Platform(frame=frame, legs=("low",), load_histories=(blow,), damping_ratio=0.03)
    chosen = {"outputs": ("section_forces", "reactions"), "duration": 12.0, "discard": 0.0, "ramp": 0.0} | settings
    return scene([], depth=10.0, platform=platform, waves=waves, **chosen)


LEANING = ((3.0, -2.0, -9.0), (4.0, -1.0, 2.0), (5.0, 0.5, 15.0)), (40e3, -10e3, 5e3), CALM
UPRIGHT = ((0.0, 0.0, -10.0), (0.0, 0.0, 2.0), (0.0, 0.0, 15.0)), (40e3, 0.0, -3e3), SWELL
SPRINGS = (2e8, 2e8, 5e8, 4e8, 4e8, 1e8)


@pytest.mark.parametrize(
    ("item", "springs", "modes"), [(LEANING, None, 6), (UPRIGHT, SPRINGS, 3)], ids=["leaning", "upright"]
)
def test_modes_that_bear_a_blow_and_hardly_move_are_kept(item, springs, modes):
    """Those that stretch the mast, whose tops move by some thousandth of its sway: its axial force is theirs."""
    few = simulate(mast(*item, springs, modes=modes))
    every = simulate(mast(*item, springs, modes="all", time_step=0.001))
    for name in ("section_force", "base_shear"):
        ours, theirs = (record.variables[name][1][..., 4] for record in (few, every))
        assert apart(ours, theirs) < min(5e-4, few.attrs["estimated_error"])


def test_a_mode_that_bears_nothing_is_not_kept():
    """Across the plane in which the upright mast and its blow lie the ground bears rounding, however it swings."""
    turned = prepare(mast(*UPRIGHT, modes=3), None).support
    assert np.abs(turned.thrust[1]).max() < 1e-6 * np.abs(turned.thrust).max()
    assert turned.omega.size < 15 and 0 < turned.unswung < 0.01
