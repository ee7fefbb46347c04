"""Parametric resonance of arms in one wave: where it begins, against marches and closed forms."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from pytest import approx

from solver.frequency import second_order, subharmonics
from solver.frequency.case import case_of
from solver.frequency.harmonics import NO_BALANCE, ONE
from solver.frequency.response import respond
from solver.hydrodynamics.hull.box import box
from solver.run import simulate
from solver.scene import Float
from solver.sea.realization import components, realize, regular
from solver.sea.spectrum import Jonswap
from solver.statistics import STATISTICS
from tests.awkward import RHO, SCENES, known, scene

STD, FULL = STATISTICS.index("std"), 28.0  # length of the tether [m]


@cache
def tethered(size=FULL, turns=("pitch",), heading=0.0):
    """A buoy under water on one taut tether from the seabed, a power take-off along it, that swings in some 16 s."""
    s = size / FULL
    hull, mass = box(length=8.8 * s, width=8.8 * s, height=5 * s, draft=8.5 * s), 2.4e5 * s**3
    none = (0.0,) * len(turns)
    item = Float(
        name="buoy", hull=hull, mass=mass, inertia=(2.0e6 * s**5, 2.6e6 * s**5, 3.2e6 * s**5), cog=(0, 0, -6.4 * s),
        hinge=(0, 0, -size), arm=(0, 0, size), motion=(*turns, "heave"), stiffness=(*none, 4e5 * s**2),
        preload=(*none, -9.81 * (RHO * hull.volume - mass)), pto_damping=(*none, 2e5 * s**2.5),
        damping=(*(1e7 * s**4.5 for _ in turns), 0.0),
    )  # fmt: skip
    time = np.sqrt(s)
    waves = regular(height=0.1 * s, period=7.5 * time, heading=heading)
    lasting = {"duration": 600 * time, "discard": 8000 * time, "ramp": 30 * time}
    whole = scene([item], depth=30 * s, waves=waves, froude_krylov="linear", **lasting)
    return whole, known(whole, 0.25 / time, 2.0 / time, 16)


def in_waves(height, period=7.5, *, method="frequency", of=tethered, **given):
    """Record in waves as high and long at full scale."""
    item, h = of(**given)
    s = given.get("size", FULL) / FULL
    waves = regular(height=height * s, period=period * np.sqrt(s), heading=given.get("heading", 0.0))
    return simulate(replace(item, sea=waves, settings=replace(item.settings, method=method)), h)


def told(record):
    """Whether it swings up, and the least height told [m], 0 if none."""
    words = str(record.attrs.get("warnings", ""))
    assert NO_BALANCE not in words
    height = float(words.partition(" above about ")[2].partition(" m ")[0] or 0.0)
    assert (record.attrs["rotation_effect"] == 1.0) is (height > 0)
    return height


def angle(record):
    return np.nanmax(np.hypot.reduce(record.variables["motion"][1][0, :-1, STD], axis=0))


@pytest.mark.parametrize(
    ("period", "begins", "given"),
    [
        (7.5, 1.385, {}),
        (8.0, 0.955, {}),
        (9.0, 1.76, {}),
        (7.5, 1.385, {"size": FULL / 20}),
        (7.5, 1.37, {"turns": ("roll", "pitch"), "heading": 0.6}),
    ],
)
def test_it_begins_where_marches_leave_the_response(period, begins, given):
    """By 4 % of the height; from half as high again within 10 %. In oblique waves nothing stays in a plane."""
    for height, swings in ((0.96 * begins, False), (1.04 * begins, True)):
        lines, march = (in_waves(height, period, method=method, **given) for method in ("frequency", "time"))
        assert bool(angle(march) > 1.3 * angle(lines)) is bool(told(lines)) is swings
    least = told(in_waves(1.5 * begins, period, **given)) / (given.get("size", FULL) / FULL)
    assert least == approx(begins, rel=0.1)


def test_far_from_twice_the_period_nothing_swings_up():
    for period, height in ((6.0, 3.0), (5.0, 2.0), (12.0, 1.5)):
        lines, march = (in_waves(height, period, method=method) for method in ("frequency", "time"))
        assert not told(lines)
        assert angle(march) == approx(angle(lines), rel=2 * lines.attrs["rotation_effect"])


def test_it_names_the_axis_and_the_run_that_tells():
    words = str(in_waves(1.5).attrs["warnings"])
    assert "floats.buoy: pitch swings up at half the wave's frequency" in words and 'method = "time"' in words


def test_more_damping_keeps_it_from_that():
    item, h = tethered()
    damped = replace(item, floats=(replace(item.floats[0], damping=(5e7, 0.0)),))
    assert told(in_waves(1.5)) and not told(in_waves(1.5, of=lambda: (damped, h)))


def in_seas(Hs, gamma, *, size=FULL, count=150):
    """Records of one sea by lines and by a march."""
    item, h = tethered(size)
    s = size / FULL
    waves = Jonswap(Hs=Hs * s, Tp=8 * np.sqrt(s), gamma=gamma)
    waves = realize(waves, components=count, band=(0.4 / np.sqrt(s), 1.8 / np.sqrt(s)), seed=2)
    lasting = replace(item.settings, duration=3600 * np.sqrt(s), discard=1200 * np.sqrt(s))
    scenes = (replace(item, sea=waves, settings=replace(lasting, method=m)) for m in ("frequency", "time"))
    return [simulate(each, h) for each in scenes]


@pytest.mark.parametrize(("gamma", "begins"), [(1.0, 2.7), (3.3, 2.1), (7.0, 1.9)])
def test_in_seas_it_begins_where_marches_have_much_more(gamma, begins):
    """From a fifth above the height told on by over a third; a fifth below it, what is told holds as ever."""
    for Hs, swings in ((0.8 * begins, False), (1.2 * begins, True)):
        lines, march = in_seas(Hs, gamma)
        more = angle(march) / angle(lines) - 1
        assert bool(told(lines)) is swings
        if swings:
            assert more > 0.35 and told(lines) == approx(begins, rel=0.04)
        else:
            assert more < 3 * lines.attrs["rotation_effect"]


def test_in_seas_a_model_tells_the_same():
    lines, _ = in_seas(2.5, 3.3, size=FULL / 20)
    assert 20 * told(lines) == approx(2.1, rel=0.06)  # two digits
    assert "swings up at half the waves' frequencies, as seas of a significant height" in lines.attrs["warnings"]


def test_two_waves_are_a_sea_and_one_split_in_two_is_one():
    """Each with half of the sum's square: μ² adds up. A third wave far off is no part of it."""
    item, h = tethered()

    def least(omega, amplitude):
        waves = components(amplitude=np.array(amplitude), omega=np.array(omega), phase=np.zeros(len(omega)))
        record = simulate(replace(item, sea=waves, settings=replace(item.settings, method="frequency")), h)
        return told(record) / (4 * np.sqrt(0.5 * np.dot(amplitude, amplitude)))

    one = told(in_waves(1.5, 2 * np.pi / 0.8)) / 1.5
    assert least([0.8, 0.8001], np.full(2, 0.75 / np.sqrt(2))) == approx(one, rel=0.05)
    assert least([0.8, 0.8001, 1.6], [0.6, 0.6, 0.01]) == approx(least([0.8, 0.8001], [0.6, 0.6]), rel=1e-3)


def test_what_a_wave_makes_of_a_shape_is_the_slope_of_the_exact_loads(monkeypatch):
    """Of a duck in one small wave, where all three parts count; what velocities of second order radiate is left out."""
    item, h = SCENES["duck"]()
    waves = regular(height=1e-3, period=4.0)
    monkeypatch.setattr(subharmonics, "BESIDE", 1e3)
    item = replace(item, sea=waves, settings=replace(item.settings, method="frequency", froude_krylov="linear"))
    case, found = case_of(item, h), respond(item, h)
    (of,) = subharmonics._halved(case)
    s, added = second_order.states(case.waves, found.Z), second_order.added(case, case.waves, found.X, found.wrench)
    _, b = subharmonics._slopes(case, subharmonics._waves(case), ONE.first(found.X))
    along = case.model.shape @ of.shape
    assert of.pushed(found.Z, s, added) == approx(along @ b[: along.size, : along.size] @ along, rel=5e-3)


def test_mathieus_equation_grows_where_its_closed_form_says():
    """Two coordinates turned into each other, of which one is damped too much; and two that are the same."""
    g, d, h = 0.05, 0.02, 0.15  # about a frequency of 1, of unit inertia
    Z = np.diag([d - 2j * g, d - 4j * g])
    turn = np.array([[0.8, -0.6], [0.6, 0.8]])
    B = np.linalg.solve(turn @ Z @ turn.T, h / 2 * np.eye(2))
    square, ways = subharmonics.largest(B)
    assert square == approx((h / 2) ** 2 / (d**2 + (2 * g) ** 2)) and abs(ways[1] / ways[0]) == approx(0.75)
    same, _ = subharmonics.largest(h / 2 * np.diag(1 / Z[[0, 0], [0, 0]]))
    assert same == approx(square)
    apart, _ = subharmonics.largest(np.array([[0, h], [h * np.exp(2j), 0]]))  # one pushes on the other, not locked
    assert apart == 0.0


def test_further_lines_change_little(monkeypatch):
    largest, sizes = subharmonics.largest, []
    monkeypatch.setattr(subharmonics, "largest", lambda B: sizes.append(largest(B)[0]) or largest(B))
    for odd in ([1], [1, 3], [1, 3, 5, 7, 9]):
        monkeypatch.setattr(subharmonics, "ODD", np.array(odd))
        in_waves(1.5)
    first, usual, more = np.sqrt(sizes)
    assert usual == approx(more, rel=1e-3) and first == approx(more, rel=0.05)
