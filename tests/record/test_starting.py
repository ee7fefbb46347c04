"""What a record lacks of its motions for it began at rest, and what it has besides, is told."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from pytest import approx

from solver.coupled.preparation import prepare
from solver.hydrodynamics.hull.revolution import Revolution
from solver.record import starting
from solver.record.channels import Channels
from solver.record.settling import Settling
from solver.record.starting import drifting, from_rest, left_over
from solver.reference.run import simulate_reference
from solver.run import simulate
from solver.scene import EndStops, Float
from solver.sea.realization import CALM, components, regular
from solver.statistics import STATISTICS, moments
from tests.awkward import RHO, bare_legs, known, scene, sea


@cache
def spar(damping=0.0, quadratic=0.0, **settings):
    """A deep thin column that heaves with its own period of 6.6 s in waves of 6 s, and hardly radiates."""
    hull = Revolution.vertical_cylinder(radius=0.6, draft=10.0, freeboard=3.0)
    item = Float(
        name="spar", hull=hull, mass=RHO * hull.volume, inertia=(4e5, 4e5, 4e3), hinge=(0, 0, 0), cog=(0, 0, -7.0),
        motion=("heave",), damping=(damping,), quadratic_damping=(quadratic,),
    )  # fmt: skip
    given = {"duration": 300.0, "discard": 30.0, "ramp": 10.0, "froude_krylov": "linear"} | settings
    whole = scene([item], waves=sea(Hs=0.5, Tp=6.0, band=(0.6, 2.0)), **given)
    return whole, known(whole, 0.4, 2.5, 30)


def notes(item, h):
    return list(from_rest(prepare(item, h), h))


def told(note):
    return float(note.split("some ")[1].split("%")[0]) / 100


def heave(item, h, seeds, **settings):
    """Root of the mean square of its std in several realizations."""
    std = []
    for seed in seeds:
        waves = sea(Hs=0.5, Tp=6.0, band=(0.6, 2.0), seed=seed)
        other = replace(item, sea=waves, settings=replace(item.settings, **settings))
        std.append(simulate(other, h).variables["motion"][1][0, 0, STATISTICS.index("std")])
    return np.sqrt(np.mean(np.square(std)))


@pytest.mark.parametrize("damping", [100.0, pytest.param(200.0, marks=pytest.mark.slow)])
def test_it_is_what_short_marches_lack_of_lasting_seas(damping):
    """Of sixty realizations, by which the std of so narrow a band is known to 6 %."""
    item, h = spar(damping, duration=100.0, discard=15.0)
    (note,) = notes(item, h)
    lacking = 1 - heave(item, h, range(60)) / heave(item, h, range(60), method="frequency")
    assert note.startswith("spar heave, 6.") and told(note) == approx(lacking, rel=0.25)


def test_the_discard_that_it_names_leaves_as_much_as_it_says(monkeypatch):
    item, h = spar(100.0)
    (note,) = notes(item, h)
    discard = float(note.split("discard = ")[1].split()[0])
    assert notes(replace(item, settings=replace(item.settings, discard=discard)), h) == []
    monkeypatch.setattr(starting, "LACKS", 1e-3)
    (left,) = notes(replace(item, settings=replace(item.settings, discard=discard)), h)
    assert told(left) == 0.01 and note.endswith("leaves 1%")


def test_nothing_is_said_of_what_is_damped_nor_of_one_wave_or_none():
    item, h = spar(100.0)
    assert notes(*spar(3e3)) == [] and notes(*spar(100.0, 5e4)) == []
    one = regular(height=0.5, period=6.0)
    assert notes(replace(item, sea=one), h) == [] and notes(replace(item, sea=CALM), h) == []


@pytest.mark.parametrize("waves", [(0.75,), (0.7, 1.4)], ids=["one", "two"])
@pytest.mark.parametrize("ramp", [{"ramp": 10.0}, {"ramp": 25.0, "ramp_form": "cosine"}, {"ramp": 0.0}], ids=str)
def test_what_the_start_leaves_of_a_shape_s_own_swinging_is_told(waves, ramp, monkeypatch):
    """Within a fifth of what marches have besides a lasting sea's std; and the discard that leaves a hundredth."""
    item, h = spar(20.0)
    few = components(amplitude=np.full(len(waves), 0.2), omega=np.array(waves), phase=np.arange(len(waves)) * 1.0)
    settings = replace(item.settings, duration=400.0, **ramp)
    item = replace(item, sea=few, settings=settings)
    (note,) = left_over(prepare(item, h), h)
    monkeypatch.setattr(starting, "AT_ONCE", 10)
    assert list(left_over(prepare(item, h), h)) == [note]
    lasting = simulate(replace(item, settings=replace(settings, method="frequency")), h)
    record = simulate(item, h)
    std = [each.variables["motion"][1][0, 0, STATISTICS.index("std")] for each in (record, lasting)]
    assert std[0] / std[1] - 1 == approx(told(note), rel=0.2)
    assert any(text in record.attrs["warnings"] for text in (note, "is not periodic yet"))
    discard = float(note.split("discard = ")[1].split()[0])
    assert not list(left_over(prepare(replace(item, settings=replace(settings, discard=1.05 * discard)), h), h))
    less = replace(item, settings=replace(settings, discard=0.9 * discard))
    assert list(left_over(prepare(less, h), h)) and 1.05 * discard > item.settings.discard


def test_nothing_is_said_of_a_start_in_still_water_nor_of_what_is_damped():
    for item, h in (spar(20.0), spar(3e3)):
        few = components(amplitude=np.full(2, 0.2), omega=np.array([0.7, 1.4]), phase=np.zeros(2))
        damped = item.floats[0].damping == (3e3,)
        system = prepare(replace(item, sea=few if damped else CALM), h)
        assert not list(left_over(system, h))


def test_a_shape_that_rounding_alone_damps_is_damped_by_nothing():
    item, h = spar(1e-9, radiation=False)
    few = components(amplitude=np.full(1, 0.2), omega=np.array([0.75]), phase=np.zeros(1))
    (note,) = left_over(prepare(replace(item, sea=few), h), h)
    assert note.endswith("; nothing damps it")


HELD = [
    {"latch_load": 1e9},
    {"latch_load": 50.0},
    {"coulomb": 1e9},
    {"end_stops": EndStops(lower=-0.1, upper=0.1, stiffness=1e6)},
]
WIDE = EndStops(lower=-9.0, upper=9.0, stiffness=1e6)


@pytest.mark.parametrize("law", HELD)
def test_nothing_is_said_of_an_axis_that_is_held(law):
    item, h = spar(20.0)
    few = components(amplitude=np.full(2, 0.2), omega=np.array([0.7, 1.4]), phase=np.zeros(2))
    laws = {"end_stops": WIDE}, law
    free, held = (replace(item, floats=(replace(item.floats[0], **of),)) for of in laws)
    assert [len(list(left_over(prepare(replace(each, sea=few), h), h))) for each in (free, held)] == [1, 0]
    item, h = spar(100.0, duration=100.0, discard=15.0)
    free, held = (replace(item, floats=(replace(item.floats[0], **of),)) for of in laws)
    assert [len(notes(each, h)) for each in (free, held)] == [1, 0]


def test_a_platform_that_no_wave_loads_has_nothing_of_its_start():
    item, _ = bare_legs()
    frame, none = item.platform.frame, {"drag_coefficient": 0.0, "inertia_coefficient": 1.0}
    members = tuple(replace(m, **none) for m in frame.members)
    spared = replace(item, platform=replace(item.platform, frame=replace(frame, members=members)))
    assert not list(left_over(prepare(spared, None), None)) and not list(from_rest(prepare(spared, None), None))


def test_a_shape_that_moves_by_rounding_alone_lacks_nothing():
    """Yaw of a round spar, 5.6 s, next to which nothing else moves."""
    item, _ = spar(100.0, duration=60.0)
    yawing = replace(item.floats[0], motion=("yaw",), stiffness=(5e3,), damping=(60.0,), quadratic_damping=(0.0,))
    item = replace(item, floats=(yawing,))
    assert not notes(item, known(item, 0.4, 2.5, 10))


@pytest.mark.parametrize(
    ("waves", "run"),
    [((0.75,), simulate), ((0.7, 1.4), simulate), pytest.param((0.75,), simulate_reference, marks=pytest.mark.slow)],
)
def test_what_nothing_holds_goes_on_as_the_start_made_it_and_is_told(waves, run):
    """A spar that surges and heaves; one on a spring has no such sentence, nor has still water."""
    item, _ = spar(20.0)
    few = components(amplitude=np.full(len(waves), 0.2), omega=np.array(waves), phase=np.arange(len(waves)) * 1.0)
    surging = replace(item.floats[0], motion=("surge", "heave"), damping=(0.0, 20.0))
    h = known(replace(item, floats=(surging,)), 0.4, 2.5, 30)
    told = []
    for stiffness, sea_ in ((0.0, few), (3e3, few), (0.0, CALM)):
        record = run(replace(item, floats=(replace(surging, stiffness=(stiffness, 0.0)),), sea=sea_), h)
        told.append([text for text in record.attrs.get("warnings", "").split("; ") if "no stiffness holds" in text])
        if told == [told[-1]]:
            mean, std = record.variables["motion"][1][0, 0, [STATISTICS.index(name) for name in ("mean", "std")]]
    assert [len(texts) for texts in told] == [1, 0, 0]
    text = told[0][0]
    first, last = (float(text.split(words)[1].split()[0]) for words in ("goes from", "third to"))
    assert text.startswith("floats.spar: next to no stiffness holds its surge, which keeps")
    assert (first + last) / 2 == approx(mean, rel=0.03) and f"beside a std of {std:.3g} that" in text


@pytest.mark.parametrize("axis", ["surge", "sway", "yaw"])
def test_a_tenth_of_a_std_between_thirds_is_told_of_any_axis_that_nothing_holds(axis):
    """Besides what waves make of parts' means in a sea of several; not of one that hardly moves, nor that is held."""
    item, _ = spar(20.0)
    motion = tuple(dict.fromkeys((axis, "heave", "yaw")))
    item = replace(item, floats=(replace(item.floats[0], motion=motion, damping=(20.0,) * len(motion)),))
    one, two = (components(amplitude=[0.2, more], omega=[0.7, 1.4], phase=[0.0, 0.0]) for more in (0.0, 0.2))

    def axes(waves, share, size=1.0, of=0):
        """Told, of positions of which one drifts by so much of the std of all its motion."""
        bare = replace(item.settings, radiation=False, diffraction=False, froude_krylov="body-nonlinear")
        whole = replace(item, sea=waves, settings=bare)
        system, channels, settling = prepare(whole, None), Channels(whole, None), Settling(whole)
        t = np.arange(0.0, 330.0, 0.05)
        z = 0.1 * np.cos(0.7 * t)[:, None] * np.ones(len(motion))
        z[:, of] += share * 0.0707 * 1.5 * t / 300
        z[:, 0] *= size
        settling.add(t, dict(channels.motions(z)))
        table = moments(z[t > 30]).reshape(1, len(motion), 5)
        return list(drifting(system, None, settling, channels, {"motion": table}))

    assert axes(one, 0.09) == [] and len(axes(one, 0.12)) == 1 and len(axes(one, -0.12)) == 1
    assert axes(two, 0.12) == [] and len(axes(two, 0.2)) == 1
    assert axes(one, 0.12, size=1e-9) == [] and axes(one, 0.12, of=1) == []
    (text,) = axes(one, 1.0)
    assert text.startswith(f"floats.spar: next to no stiffness holds its {axis},") and (" rad in" in text) == (
        axis == "yaw"
    )
