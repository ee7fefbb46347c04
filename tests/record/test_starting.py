"""What a record in a random sea lacks of its motions for it began at rest, is told."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from pytest import approx

from solver.coupled.preparation import prepare
from solver.hydrodynamics.hull.revolution import Revolution
from solver.record import starting
from solver.record.starting import from_rest
from solver.run import simulate
from solver.scene import Float
from solver.sea.realization import CALM, regular
from solver.statistics import STATISTICS
from tests.awkward import RHO, known, scene, sea


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


def test_a_shape_that_moves_by_rounding_alone_lacks_nothing():
    """Yaw of a round spar, 5.6 s, next to which nothing else moves."""
    item, _ = spar(100.0, duration=60.0)
    yawing = replace(item.floats[0], motion=("yaw",), stiffness=(5e3,), damping=(60.0,), quadratic_damping=(0.0,))
    item = replace(item, floats=(yawing,))
    assert not notes(item, known(item, 0.4, 2.5, 10))
