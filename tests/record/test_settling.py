"""Whether a record of one wave still has what is left of its start."""

from dataclasses import replace

import numpy as np
import pytest
from pytest import approx

from solver.record.channels import Channels
from solver.record.settling import Settling
from solver.run import simulate
from solver.sea.realization import components

PERIOD = 2 * np.pi / 1.2


def notes(scene, motion, step=0.05):
    """Of positions (m, nj) that a function has of time, in blocks."""
    settling, s, channels = Settling(scene), scene.settings, Channels(scene, None)
    times = np.arange(0.0, s.discard + s.duration, step)
    for block in np.array_split(times, 7):
        settling.add(block, dict(channels.motions(motion(block))))
    return list(settling.notes(channels))


def in_a_wave(buan, **changes):
    given = {"sea": buan.regular(0.1, 1.2), "duration": 100.0, "discard": 10.0, "ramp": 5.0} | changes
    return buan.scene("fixed", **given)


def swinging(share, slow=0.3):
    """Two axes in a wave, one of which has so much more at the start, which dies within the record."""
    return lambda t: np.stack(
        [
            0.1 + 0.05 * np.cos(1.2 * t),
            0.3 + 0.04 * np.cos(1.2 * t) + share * 0.04 * np.exp(-t / 40) * np.cos(slow * t),
        ],
        axis=1,
    )


def test_what_is_left_of_the_start_is_named_by_the_axis(buan):
    scene = in_a_wave(buan)
    assert notes(scene, swinging(0.0)) == []
    (note,) = notes(scene, swinging(1.0))
    assert note.startswith("floats.rear: rotation is not periodic yet, its std 0.03")
    assert note.endswith("what is left of the start is in all statistics; a longer discard takes it out")


def test_what_grows_is_nothing_of_the_start(buan):
    """As parametric resonance does."""
    (note,) = notes(in_a_wave(buan), lambda t: swinging(0.1 * np.exp(t / 20), 0.6)(t))
    assert note.startswith("floats.rear: rotation is not periodic yet") and "of the start" not in note
    assert note.endswith("it still grows, and a longer discard tells to what")


def test_whole_periods_are_compared(buan):
    """Whatever the record's length is of the wave's; not a record of less than three, and no random sea."""
    for periods in (3.1, 4.4, 5.9):
        for step in (0.005, 0.24, 0.29, 0.34):  # whose samples do not end with them
            assert notes(in_a_wave(buan, duration=periods * PERIOD), swinging(0.0), step=step) == []
    assert notes(in_a_wave(buan, duration=2.9 * PERIOD), swinging(1.0)) == []
    assert notes(in_a_wave(buan, sea=buan.sea()), swinging(1.0)) == []


def test_an_axis_that_hardly_moves_is_not_judged(buan):
    assert notes(in_a_wave(buan), lambda t: 1e-4 * swinging(1.0)(t)) == []


def test_legs_are_judged_without_floats_too(buan):
    """By their tops, however little they move; not by the stress at their feet, which has corners."""
    scene = buan.scene("elastic-no-floats", sea=buan.regular(0.1, 1.2), duration=100.0, discard=10.0, ramp=5.0)
    channels = Channels(scene, None)
    for share, expected in ((0.0, []), (1.0, ["platform: top_displacement of leg 2 along x is not periodic yet"])):
        settling, t = Settling(scene), np.arange(0.0, 110.0, 0.05)
        tops = 1e-9 * np.stack([swinging(share)(t), *[swinging(0.0)(t)] * 2], axis=2)
        settling.add(t, {"bottom_stress": 1e3 * swinging(1.0)(t), "top_displacement": tops})
        assert [note.partition(",")[0] for note in settling.notes(channels)] == expected


def test_a_wave_beside_one_of_no_height_is_alone(buan):
    one = in_a_wave(buan, discard=0.0)
    beside = components(amplitude=[0.5, 0.0], omega=[one.sea.omega[0], 2 * one.sea.omega[0]], phase=[0.0, 0.0])
    both = components(amplitude=[0.5, 0.1], omega=beside.omega, phase=[0.0, 0.0])
    parts = [Settling(replace(one, sea=sea)).parts for sea in (one.sea, beside, both)]
    assert parts[0] == parts[1] != [] and np.ptp(parts[0][0]) < np.ptp(parts[2][0]) == approx(100.0 / 3)


@pytest.mark.slow
def test_a_run_says_so(buan, coefficients):
    early = in_a_wave(buan, discard=0.0)
    late = replace(early, settings=replace(early.settings, discard=40.0))
    told = [str(simulate(scene, coefficients).attrs.get("warnings", "")) for scene in (early, late)]
    assert ["not periodic" in words for words in told] == [True, False]
