"""What the points at which a frame's drag is taken leave out, told by each record, against many points."""

from dataclasses import replace

import numpy as np
import pytest

from solver.coupled.preparation import prepare
from solver.record import probe
from solver.run import simulate
from solver.scene import Platform
from solver.sea.realization import CALM
from solver.statistics import apart
from solver.structure.frame import Frame
from solver.structure.load_history import LoadHistory
from solver.structure.members import Member, PointMass
from solver.structure.sections import tube
from tests.awkward import STEEL, bare_legs, scene, sea, unequal_legs

JUDGED = ("top_displacement", "bottom_stress")


def column():
    """Slender, from the seabed through the surface, of few elements; in steep waves."""
    member = Member(
        name="m", start="foot", end="top", elements=4, section=tube(0.6, 0.02), material=STEEL,
        drag_coefficient=1.0, inertia_coefficient=2.0,
    )  # fmt: skip
    nodes, mass = {"foot": (0.0, 0.0, -20.0), "top": (0.0, 0.0, 8.0)}, PointMass(node="top", mass=5e3)
    frame = Frame(nodes=nodes, members=(member,), clamped=("foot",), masses=(mass,))
    return scene([], depth=20.0, waves=sea(Hs=2.0, Tp=6.0), platform=Platform(frame=frame, legs=("m",))), None


def with_stations(item, count, stretching="none"):
    settings = replace(item.settings, stations_per_element=count, time_step=0.15, duration=100.0)
    return replace(item, settings=settings, platform=replace(item.platform, wave_stretching=stretching))


@pytest.mark.parametrize(
    ("made", "stretching"),
    [(made, "none") for made in (column, unequal_legs, bare_legs)]
    + [(column, "wheeler")]
    + [pytest.param(made, "wheeler", marks=pytest.mark.slow) for made in (unequal_legs, bare_legs)],
)
def test_records_tell_what_their_stations_do(made, stretching):
    """True error over estimate between 1/3 and 3, to still water and to the waves' surface."""
    item, h = made()
    few, many = (simulate(with_stations(item, n, stretching), h) for n in (2, 10))
    true = max(apart(few.variables[name][1], many.variables[name][1]) for name in JUDGED)
    told = few.attrs["stations_effect"]
    assert true > 3e-5
    assert 1 / 3 < true / told < 3
    assert few.attrs["estimated_error"] >= told > 5 * many.attrs["stations_effect"]


LET_GO = np.array([0.0, 0.1, 0.2, 300.0])


def released(count):
    """A pile let go from a pull in still water, where drag alone takes from its sway; two elements."""
    item, pull = (
        column()[0],
        LoadHistory(node="top", time=LET_GO, force=np.outer([1, 1, 0, 0], [2e4, 0, 0])),
    )
    member = replace(item.platform.frame.members[0], elements=2, drag_coefficient=200.0)
    frame = replace(item.platform.frame, members=(member,))
    platform = replace(item.platform, frame=frame, load_histories=(pull,), damping_ratio=0.0)
    settings = replace(item.settings, stations_per_element=count, discard=0.5, duration=25.0, ramp=0.0)
    return simulate(replace(item, sea=CALM, platform=platform, settings=settings), None)


def test_what_sways_in_still_water_is_damped_by_the_cube_of_its_shape():
    one, two, many = (released(count) for count in (1, 2, 10))
    off = [apart(of.variables["top_displacement"][1], many.variables["top_displacement"][1]) for of in (one, two)]
    assert off[1] < 3e-4 < off[0]
    assert 1 / 3 < off[0] / one.attrs["stations_effect"] < 3
    assert two.attrs["stations_effect"] == 0


def test_near_stations_are_not_looked_at_again(monkeypatch):
    item = column()[0]
    true = [simulate(with_stations(item, n)).variables for n in (3, 10)]
    assert max(apart(*(v[name][1] for v in true)) for name in JUDGED) < probe.FAR
    calls = []
    monkeypatch.setattr(probe, "prepare", lambda scene, *_: calls.append(scene) or prepare(scene, None))
    for count, told in ((1, True), (2, True), (3, False)):
        calls.clear()
        effect = simulate(with_stations(item, count)).attrs["stations_effect"]
        assert bool(calls) == told == (effect > 0)
