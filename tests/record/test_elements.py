"""What a frame's elements leave out, told by each record, against the same frame with many."""

from dataclasses import replace
from itertools import product

import numpy as np
import pytest

from solver.coupled.preparation import prepare
from solver.coupled.support import _within
from solver.record import elements
from solver.run import simulate
from solver.scene import Platform
from solver.sea.realization import CALM
from solver.statistics import STATISTICS
from solver.structure.frame import Frame
from solver.structure.frame_model import assemble
from solver.structure.load_history import LoadHistory
from solver.structure.members import Member, PointMass
from tests.awkward import STEEL, bare_legs, on_piles, raking, scene, tripod, tube, unequal_legs

RMS, STD = map(STATISTICS.index, ("rms", "std"))
JUDGED = ("top_displacement", "bottom_stress", "base_shear", "overturning_moment")


def cut(item, count, outputs=("reactions",)):
    """With so many elements a member."""
    platform = replace(tripod(count), hinge_nodes=item.platform.hinge_nodes)
    settings = replace(item.settings, method="frequency", froude_krylov="linear", outputs=outputs)
    return replace(item, platform=platform, settings=settings)


@pytest.mark.parametrize("count", [1, 2])
@pytest.mark.parametrize("made", [unequal_legs, bare_legs])
def test_records_tell_what_their_elements_do(made, count):
    """True error over estimate between 1/3 and 3, with a float and without, of legs of one element and of two."""
    item, h = made()
    few, many = (simulate(cut(item, n), h) for n in (count, 16))
    stds = [[record.variables[name][1][..., STD] for name in JUDGED] for record in (few, many)]
    true = max(np.max(np.abs(a - b)[b > 0.1 * b.max()] / b[b > 0.1 * b.max()]) for a, b in zip(*stds, strict=True))
    told = few.attrs["elements_effect"]
    assert 1 / 3 < true / told < 3
    assert few.attrs["estimated_error"] >= told > 1e-4 > many.attrs["elements_effect"]


@pytest.mark.parametrize("count", [2, 8])
def test_records_tell_what_sections_of_the_middle_do(count):
    """Of a tripod of cones, within the same factors."""
    records = []
    for n in (count, 96):
        item, h = unequal_legs()
        item = cut(item, n)
        frame = item.platform.frame
        cones = tuple(replace(m, end_section=tube(0.35, 0.012)) if m.name in "abc" else m for m in frame.members)
        cone = replace(item.platform, frame=replace(frame, members=cones))
        records.append(simulate(replace(item, platform=cone), h))
    few, many = ([record.variables[name][1][..., STD] for name in JUDGED] for record in records)
    true = max(np.max(np.abs(a - b)[b > 0.1 * b.max()] / b[b > 0.1 * b.max()]) for a, b in zip(few, many, strict=True))
    assert 1 / 3 < true / records[0].attrs["elements_effect"] < 3


WIDE, NARROW = tube(1.2, 0.02), tube(0.4, 0.02)


def pushed(count, *tubes, slow=False, **settings):
    """Two legs that lean to each other, of one tube below and another on top, and turned round; on top 8 t and a force
    that changes at random, or slowly and steadily."""
    nodes = {"a": (0.0, 0.0, -15.0), "b": (7.0, 3.0, -15.0), "top": (1.0, 0.5, 9.0)}
    legs = tuple(
        Member(
            name=foot, start=foot, end="top", elements=count, section=below, end_section=above, material=STEEL,
            inertia_coefficient=2.0,
        )
        for foot, below, above in (("a", *tubes), ("b", *tubes[::-1]))
    )  # fmt: skip
    mass = PointMass(node="top", mass=8e3, cog=(1.0, 0.5, 1.0))
    frame = Frame(nodes=nodes, members=legs, clamped=("a", "b"), masses=(mass,))
    time, drawn = np.arange(0.0, 60.1, 0.5), np.random.default_rng(3)
    random = drawn.normal(loc=[2e4, 0.0, 0.0], scale=3e4, size=(time.size, 3))
    force = np.outer(time, [1e3, 5e2, 0.0]) if slow else random
    load = LoadHistory(node="top", time=time, force=force)
    platform = Platform(frame=frame, legs=("a", "b"), load_histories=(load,), damping_ratio=0.03)
    chosen = {"outputs": ("reactions",), "duration": 40.0, "discard": 20.0, "ramp": 10.0} | settings
    return scene([], depth=15.0, platform=platform, waves=CALM, **chosen)


@pytest.mark.parametrize(
    ("counts", "tubes", "slow"),
    [((2, 4, 8), (WIDE, NARROW), False), ((4,), (WIDE, NARROW), True), ((1,), (NARROW, NARROW), False)],
    ids=["tapers", "slowly", "straight"],
)
def test_records_tell_what_elements_do_under_load_histories(counts, tubes, slow):
    """In still water, of rms and std along each axis: what bends without swinging, and what weight bears, too."""
    *some, many = (simulate(pushed(n, *tubes, slow=slow)) for n in (*counts, 48))
    for few in some:
        true = 0.0
        for name, statistic in product(JUDGED, (RMS, STD)):
            a, b = (record.variables[name][1][..., statistic] for record in (few, many))
            true = max(true, np.max(np.abs(a - b)[b > 0.1 * b.max()] / b[b > 0.1 * b.max()]))
        assert 1 / 3 < true / few.attrs["elements_effect"] < 3


def test_frames_without_legs_are_judged_by_all_that_moves():
    """What is told of them is what tops do that nothing puts out."""
    few, many = (simulate(pushed(count, WIDE, NARROW)).variables["top_displacement"][1] for count in (4, 48))
    item = pushed(4, WIDE, NARROW, outputs=())
    told = simulate(replace(item, platform=replace(item.platform, legs=()))).attrs["elements_effect"]
    assert 1 / 3 < np.abs(few / many - 1)[..., STD].max() / told < 3


def test_elements_are_judged_by_what_a_record_has():
    """Of tops, fibres and base shear without means and with them; a line's square is twice its variance."""
    item = pushed(4, WIDE, NARROW, outputs=("reactions", "fibre_stress"), time_step=0.01)
    record, system = simulate(item), prepare(item, None)
    told = iter([*elements._stds(system, None, item.settings)])
    names = "top_displacement", "fibre_stress", "base_shear", "overturning_moment"
    for name in names:
        for statistic in (STD, RMS):
            values = record.variables[name][1][..., statistic].ravel()
            ours = np.array([next(told) for _ in values]) / np.sqrt(2)
            assert np.array_equal(ours > 0, values > elements.SMALL * values.max())
            assert ours[ours > 0] == pytest.approx(values[ours > 0], rel=1e-3)


def test_a_march_tells_the_same():
    """The effect is that of the linear response in the scene's sea, whatever way the record comes about."""
    item, h = unequal_legs()
    marched = replace(cut(item, 1), settings=replace(item.settings, outputs=("reactions",), duration=30.0))
    told = [simulate(scene, h).attrs["elements_effect"] for scene in (marched, cut(item, 1))]
    assert told[0] == pytest.approx(told[1], rel=1e-3)


@pytest.mark.parametrize("outputs", [("section_forces",), ("utilisation", "leg_tops", "fatigue")])
def test_legs_are_compared_with_themselves_whatever_is_asked_for(outputs):
    """Of mirrored legs one is looked at, which are others' images as the outputs have it."""
    item = raking(outputs=outputs)
    plain = replace(item, settings=replace(item.settings, outputs=()))
    told = [simulate(scene).attrs["elements_effect"] for scene in (item, plain)]
    assert told[0] == pytest.approx(told[1], rel=1e-6) and told[1] > elements.FINE


def test_fine_elements_are_not_looked_at_again(monkeypatch):
    item = cut(bare_legs()[0], 16)
    support = prepare(item, None).support
    monkeypatch.setattr(elements, "prepare", None)
    assert 0 < elements.elements_effect(item, None, support) < 1e-5


@pytest.mark.slow
def test_what_is_left_out_of_an_element_falls_with_the_fourth_power_of_its_length():
    """What soil holds along a member and what moves along a short thick one fall with the second; nothing tapers."""
    item = on_piles()[0]
    frame = item.platform.frame
    many = item.platform.cut(2).frame

    def left_out(frame):
        *straight, tapers = _within(assemble(frame), item.water.density)
        assert tapers == 0.0
        return np.array(straight)

    rough, fine = map(left_out, (frame, many))
    assert rough / fine == pytest.approx(np.array([4, 16]))
    short = replace(frame, members=tuple(replace(m, elements=200) for m in frame.members))
    shorter = replace(frame, members=tuple(replace(m, elements=400) for m in frame.members))
    rough, fine = map(left_out, (short, shorter))
    assert rough / fine == pytest.approx(4)
