"""What a frame's linearised drag leaves out of its statistics, as each record tells, against the march."""

import re
from dataclasses import replace
from functools import cache
from types import SimpleNamespace

import numpy as np
import pytest
from pytest import approx
from scipy.stats import kurtosis

from solver.frequency import drag_effect, gaussian
from solver.run import simulate
from solver.scene import Platform, Settings
from solver.sea.current import Current
from solver.sea.realization import realize, regular
from solver.sea.spectrum import Jonswap, PiersonMoskowitz
from solver.structure.frame import Frame
from solver.structure.members import Member, PointMass
from solver.structure.sections import tube
from tests.awkward import SCENES, STEEL, scene

SLANTED = np.pi / 6
ONE = regular(height=3.0, period=8.0, heading=SLANTED)
JUDGED = ("top_displacement", "bottom_stress")


def rough(Hs=3.0):
    return realize(PiersonMoskowitz(Hs=Hs, Tp=8.0), components=200, band=(0.4, 2.2), seed=3, heading=SLANTED)


def pile(waves):
    """Slender, stiff, off the origin: nearly all of its load is drag."""
    nodes = {"foot": (4.0, -7.0, -30.0), "top": (4.0, -7.0, 3.0)}
    stiff = replace(STEEL, E=2.1e13, G=8e12)
    member = Member(
        name="pile", start="foot", end="top", elements=4, section=tube(0.25, 0.02), material=stiff,
        drag_coefficient=1.1, inertia_coefficient=1.9,
    )  # fmt: skip
    frame = Frame(nodes=nodes, members=(member,), clamped=("foot",))
    platform = Platform(frame=frame, legs=("pile",), hinge_nodes={}, damping_ratio=0.05)
    return scene([], depth=30.0, waves=waves, platform=platform)


def dragged(item, factor, waves):
    """With as much more drag."""
    frame = item.platform.frame
    members = tuple(replace(m, drag_coefficient=factor * m.drag_coefficient) for m in frame.members)
    platform = replace(item.platform, frame=replace(frame, members=members), damping_ratio=0.05)
    return replace(item, platform=platform, sea=waves)


def legs(factor, waves=None):
    return dragged(SCENES["bare_legs"]()[0], factor, rough() if waves is None else waves), None


def legs_in_one(harmonic):
    item, h = legs(5.0, regular(height=0.5, period=harmonic * 2 * np.pi / 14.66, heading=SLANTED))
    return replace(item, current=Current(speed=0.5, direction=0.3)) if harmonic == 2 else item, h


def legs_across(factor):
    """A current across the wave."""
    item, h = legs(factor, regular(height=0.7, period=5.0, heading=SLANTED))
    return replace(item, current=Current(speed=0.5, direction=2.2)), h


def floating(factor):
    item, h = SCENES["unequal_legs"]()
    return dragged(item, factor, item.sea), h


def in_current(speed):
    return replace(legs(5.0)[0], current=Current(speed=speed, direction=0.3)), None


def pile_in_current(speed, Hs):
    return replace(pile(rough(Hs)), current=Current(speed=speed, direction=SLANTED)), None


@cache
def records(build, *of):
    item, h = build(*of)
    whole = 50 * 2 * np.pi / item.sea.omega[0] if item.sea.omega.size == 1 else 3600.0  # periods
    settings = {"duration": whole, "discard": 200.0, "ramp": 60.0, "froude_krylov": "linear"}
    return [
        simulate(replace(item, settings=Settings(**settings, **method)), h) for method in ({}, {"method": "frequency"})
    ]


def of_pile(waves):
    return pile(waves), None


def tables(records, name):
    """Of what is not next to nothing beside others of its kind."""
    march, lines = (record.variables[name][1].reshape(-1, 5) for record in records)
    moves = march[:, 4] > 0.05 * march[:, 4].max()
    return march[moves], lines[moves]


CASES = [
    (of_pile, rough(5.0)), (legs, 5.0), (legs, 20.0, rough(0.8)), (floating, 50.0), (in_current, 1.0),
    (pile_in_current, 0.6, 3.0), (pile_in_current, 1.0, 3.0),
]  # fmt: skip


@pytest.mark.parametrize(
    "case", [pytest.param(case, marks=[pytest.mark.slow] * (n % 2)) for n, case in enumerate(CASES)]
)
def test_what_linear_drag_leaves_is_told(case):
    """Means, rms and std of displacements and stresses, within a factor of 2.5."""
    both = records(*case)
    true, told = apart(both), both[1].attrs["drag_effect"]
    assert 0.4 < told / true < 2.5 or max(told, true) < 4e-3, (told, true)
    assert both[1].attrs["estimated_error"] >= told


def apart(records):
    """The largest error of lines."""
    true = 0.0
    for name in JUDGED:
        march, lines = tables(records, name)
        mean, rms, std = np.abs(lines - march)[:, 2:].T
        true = max(true, np.max(np.maximum(mean, rms) / march[:, 3]), np.max(std / march[:, 4]))
    return true


@pytest.mark.parametrize(
    "case", [(of_pile, regular(height=6.0, period=9.0)), (legs, 20.0, ONE), (legs_in_one, 2), (legs_across, 20.0)]
)
def test_one_waves_drag_agrees_with_its_own_harmonics(case):
    """Of a frame that these move, too; what they change at the wave's own frequency is told."""
    both = records(*case)
    true, told = apart(both), both[1].attrs["drag_effect"]
    assert true < 3e-3 and true / 2.5 < told < 2.5 * true, (told, true)


@pytest.mark.parametrize("harmonic", [2, 3, 5])
def test_a_waves_harmonic_may_meet_a_resonance(harmonic):
    """That of the legs at 14.7 rad/s; the second in a current alone."""
    both = records(legs_in_one, harmonic)
    for name in JUDGED:
        march, lines = tables(both, name)
        assert lines[:, 2:] == approx(march[:, 2:], rel=0.03, abs=2e-3 * np.abs(march).max()), name


def shaken(waves, diameter=0.6, ratio=0.01):
    """Records by march and lines of a slender pile with a mass on top."""
    nodes = {"foot": (0.0, 0.0, -20.0), "top": (0.0, 0.0, 6.0)}
    member = Member(
        name="pile", start="foot", end="top", elements=4, section=tube(diameter, 0.02), material=STEEL,
        drag_coefficient=1.0, inertia_coefficient=2.0,
    )  # fmt: skip
    frame = Frame(nodes=nodes, members=(member,), clamped=("foot",), masses=(PointMass(node="top", mass=5e3),))
    platform = Platform(frame=frame, legs=("pile",), hinge_nodes={}, damping_ratio=ratio)
    item = scene([], depth=20.0, waves=waves, platform=platform)
    outputs = ("accelerations", "fatigue")
    settings = {"duration": 400.0 if waves is ONE else 2400.0, "discard": 200.0, "froude_krylov": "linear"}
    return [
        simulate(replace(item, settings=Settings(**settings, outputs=outputs, **method)), None)
        for method in ({}, {"method": "frequency"})
    ]


@pytest.mark.parametrize("of", [(6.0,), (1.5,), (6.0, 1.0), (6.0, 0.6, 0.2)], ids=str)
def test_drag_shakes_nodes_above_the_waves_frequencies(of):
    """Periods of 2.3 and 1.2 s, damping 1 and 20 %: half of an acceleration and more is by lines above the waves."""
    march, lines = shaken(rough(of[0]), *of[1:])
    exact, found = (record.variables["node_acceleration"][1][-1, 0] for record in (march, lines))
    true = abs(found[4] / exact[4] - 1)
    assert true < 0.25 and true / 3 < lines.attrs["drag_effect"] < 3 * max(true, 0.05)
    if "variance of a node's acceleration" in lines.attrs.get("warnings", ""):
        assert found[0] < 1.1 * exact[0] < 2.4 * found[0]
    exact, found = (record.variables["damage"][1].max() for record in (march, lines))
    assert found == approx(exact, rel=0.25)


@pytest.mark.parametrize("diameter", [0.6, 1.0])
def test_one_waves_harmonics_are_those_of_the_march(diameter):
    """Of accelerations, most of them above the wave; of stresses, displacements and damage, extremes as well."""
    march, lines = shaken(ONE, diameter)
    for name in ("node_acceleration", "top_displacement", "bottom_stress", "damage"):
        exact, found = (record.variables[name][1] for record in (march, lines))
        assert found == approx(exact, rel=0.08, abs=0.02 * np.nanmax(np.abs(exact))), name
    assert lines.attrs["drag_effect"] < 0.03


@pytest.mark.parametrize(
    "case",
    [
        (of_pile, rough(5.0)), (legs, 5.0), (floating, 50.0), (pile_in_current, 1.0, 3.0),
    ],
)  # fmt: skip
def test_extremes_that_drag_drives_are_told(case):
    """Of the tops by the factor that a warning says, within 20 %."""
    both = records(*case)
    factor = float(re.search("up to ([0-9.]+) times those of the linear responses", both[1].attrs["warnings"])[1])
    march, lines = tables(both, "top_displacement")
    largest, of_lines = (np.abs(table[:, :2]).max(axis=1) for table in (march, lines))
    assert largest / of_lines == approx(factor, rel=0.2)


def test_damage_in_swell_that_drag_drives_is_told():
    """Of stresses far from Gaussian, several times that of their ranges; within a factor of 2."""
    sea = {"components": 200, "band": (0.35, 0.9), "heading": SLANTED}
    both = [shaken(realize(Jonswap(Hs=3.0, Tp=12.0, gamma=6.0), seed=seed, **sea)) for seed in (1, 2)]
    march, told = (sum(records[n].variables["damage"][1].max() for records in both) for n in (0, 1))
    factor = float(re.search("within a factor of 2, ([0-9.]+) times the damage", both[0][1].attrs["warnings"])[1])
    assert march > 2 * told and 0.5 < factor / (march / told) < 2


@pytest.mark.parametrize("speed", [0.5, 1.0])
def test_a_current_takes_damage_by_drag_back(speed):
    """It makes crests larger and troughs smaller, and no range: 4 times was warned of."""
    item = replace(pile(rough(2.5)), current=Current(speed=speed, direction=SLANTED))
    settings = {"duration": 3600.0, "discard": 100.0, "outputs": ("fatigue",), "froude_krylov": "linear"}
    both = [simulate(replace(item, settings=Settings(method=m, **settings)), None) for m in ("time", "frequency")]
    march, told = (record.variables["damage"][1].max() for record in both)
    said = re.search("within a factor of 2, ([0-9.]+) times the damage", both[1].attrs["warnings"])
    assert 0.5 < (float(said[1]) if said else 1.0) / (march / told) < 2


@pytest.mark.parametrize("case", [(legs, 1.0, rough(0.5)), (legs, 0.0), (floating, 1.0), (pile_in_current, 2.0, 0.8)])
def test_little_drag_leaves_little(case):
    item, h = case[0](*case[1:])
    lines = simulate(replace(item, settings=Settings(froude_krylov="linear", method="frequency", duration=3600.0)), h)
    assert lines.attrs["drag_effect"] < 1e-3
    assert "drag, which goes" not in lines.attrs.get("warnings", "")


@pytest.mark.parametrize(("mean", "current"), [((0.0, 0.0), 0.0), ((3.0, -1.0), 0.0), ((3.0, -1.0), 0.8)])
def test_bending_by_drag_is_that_of_long_samples(mean, current):
    """(S g(z)/√V, s ξ) turned by 0.7: what its size lacks in mean and variance, across it next to nothing."""
    dice, turn = np.random.default_rng(3), np.array([[np.cos(0.7), np.sin(0.7)], [-np.sin(0.7), np.cos(0.7)]])
    S, s, n = 2.0, 1.5, 2_000_000
    z, xi = dice.normal(size=(2, n))
    force = np.abs(current + z) * (current + z)
    g, V = (force - force.mean()) / np.mean(force * z), force.var() / np.mean(force * z) ** 2
    flow = np.array([[[current]], [[1.0]], [[1.0]]])
    law = drag_effect._Law(*flow, mean=force.mean(), slope=np.mean(force * z))
    lines = np.array([[S / np.sqrt(V), 0.0], [0.0, 0.0]]) * np.sqrt(2)  # of z, then of ξ
    whole, part = np.zeros((2, 2, 1, 3), complex)
    part[:, 0, 1:] = lines @ turn
    whole[:, 0, 1:] = np.array([[S, 0.0], [s, 0.0]]) * np.sqrt(2) @ turn
    level = np.array([[5.0, *(np.array(mean) @ turn)]])
    size = [np.hypot(S * x + s * xi + mean[0], mean[1]) for x in (z, g / np.sqrt(V))]
    less, more = (a - b for a, b in zip(*[(x.mean(), x.var()) for x in size], strict=True))
    found = drag_effect._Bending.of(law, level, whole, part, lines[:, 0]).lacks(law)
    assert found[0] == approx(less, abs=4e-3) and found[1] == approx(-more, abs=0.03)
    assert gaussian.spread(whole[:, 0, 1:] @ turn.T) == approx([np.hypot(S, s), 0.0], abs=1e-9)


@pytest.mark.parametrize(("own", "ratio"), [(8.0, 0.05), (2.0, 0.05), (0.9, 0.02), (0.9, 0.1)])
def test_a_frame_that_swings_is_nearer_to_gaussian_than_its_drag(own, ratio):
    """Kurtosis of a mode that |q|q alone drives, of a record, beside that of the part which is told to be kept."""
    rng = np.random.default_rng(3)
    w = np.sort(rng.uniform(0.5, 1.6, 120))

    def spectrum(omega):
        return np.where((omega > w[0]) & (omega < w[-1]), np.exp(-1.25 * (0.9 / omega) ** 4) / omega**5, 0.0)

    def gain(omega):
        return 1 / (own * (own - 2j * ratio * omega) - omega**2)

    f = 2 * np.pi * np.fft.rfftfreq(2**20, 0.25)
    f[0] = 1e-9
    q = np.fft.irfft(np.sqrt(spectrum(f)) * (rng.normal(size=f.size) + 1j * rng.normal(size=f.size)))
    q /= q.std()
    exact = kurtosis(np.fft.irfft(gain(f).conj() * np.fft.rfft(np.abs(q) * q)))
    case = SimpleNamespace(
        waves=w, system=SimpleNamespace(structure=SimpleNamespace(omega=np.array([own]), damping=np.array([ratio])))
    )
    push = np.sqrt(spectrum(w)) * np.exp(2j * np.pi * rng.random(w.size))
    moved = gain(w) * push
    kept = drag_effect._followed(case, 0, 0.0, moved, moved, push, 3)
    assert kept * (35 / 3 - 3) == approx(exact, rel=0.45)
    assert kept > 0.92 or own < 8


def test_harmonics_of_drag_are_no_ringing_of_joints():
    """Across the wave a current's drag has even harmonics alone, which sections bear much of; its float has a
    damper that hardly goes with the rate's square."""
    item, h = floating(20.0)
    outputs = "reactions", "section_forces"
    settings = replace(item.settings, method="frequency", froude_krylov="linear", outputs=outputs)
    floats = tuple(replace(f, quadratic_damping=5.0) for f in item.floats)
    waves, stream = regular(height=0.7, period=5.0, heading=SLANTED), Current(speed=0.5, direction=2.2)
    told = simulate(replace(item, sea=waves, current=stream, floats=floats, settings=settings), h).attrs
    assert "joints' loads ring" not in told.get("warnings", "")
