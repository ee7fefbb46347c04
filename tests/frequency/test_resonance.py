"""Resonances between a sea's waves are told, with how many waves would resolve them."""

import re
from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from solver.frequency.case import case_of
from solver.frequency.resonance import unresolved
from solver.frequency.response import respond_in
from solver.hydrodynamics.hull.revolution import Revolution
from solver.run import simulate
from solver.scene import Float
from solver.sea.realization import realize
from solver.sea.spectrum import PiersonMoskowitz
from tests.awkward import RHO, flap, known, scene, soft_mooring

HULL = Revolution.vertical_cylinder(radius=10.0, draft=6.0, freeboard=5.0)
BAND = 0.35, 2.2


def waves(components=130, Tp=8.0, seed=0):
    spectrum = PiersonMoskowitz(Hs=0.1, Tp=Tp)
    return realize(spectrum, components=components, band=BAND, seed=seed, intervals="even")


@cache
def buoy():
    """Whose pitch, in the midst of the waves, hardly radiates."""
    item = Float(
        name="buoy", hull=HULL, mass=RHO * HULL.volume, inertia=(5e7, 5e7, 9e7), hinge=(0, 0, 0), cog=(0, 0, -1.0),
        motion=("heave", "pitch"),
    )  # fmt: skip
    whole = scene([item], depth=80.0, waves=waves(), froude_krylov="linear", method="frequency")
    return whole, known(whole, 0.3, 2.4)


def told(sea, damping=0.0, item=None, h=None):
    """Sentences, and the response."""
    whole, own = buoy()
    floats = tuple(replace(f, damping=(0.0, damping)) for f in whole.floats)
    whole, h = (replace(whole, sea=sea, floats=floats), own) if item is None else (item, h)
    case = case_of(whole, h)
    response = respond_in(case, case.law(whole.floats))
    return list(unresolved(case, response)), response


def scatter(components):
    """Of the std of pitch by where the lines fall: bands that begin a little later."""
    stds = []
    for share in np.arange(4) / 4:
        shifted = BAND[0] + share * (BAND[1] - BAND[0]) / components
        sea = realize(
            PiersonMoskowitz(Hs=0.1, Tp=8.0), components=components, band=(shifted, BAND[1]), seed=0, intervals="even"
        )
        stds.append(np.linalg.norm(told(sea)[1].X[:, 1]))
    return np.ptp(stds) / np.mean(stds)


def test_a_resonance_between_waves_is_told_with_how_many_would_resolve_it():
    (text,) = told(waves())[0]
    found = re.fullmatch(
        r"components: waves are 0\.014 rad/s apart where buoy pitch of period \S+ s resonates over (\S+) rad/s:"
        r" (\d+) components would resolve it",
        text,
    )
    assert found is not None
    assert text in str(simulate(*buoy()).attrs["warnings"])
    width, needed = float(found[1]), int(found[2])
    assert needed == pytest.approx(2 * (BAND[1] - BAND[0]) / width, rel=0.06)
    assert told(waves(int(0.9 * needed)))[0] and not told(waves(needed))[0]
    assert scatter(130) > 0.2 and scatter(needed) < 0.02


def test_damping_makes_it_wider():
    """By B over inertia, with the added mass of its own frequency."""
    case = case_of(*buoy())
    pitch = case.modes.names.index("buoy pitch")
    damping = 0.03 / case.modes.shapes[1, pitch] ** 2
    assert told(waves(), 0.7 * damping)[0] and not told(waves(), damping)[0]


def test_what_waves_do_not_reach_or_have_no_random_phases_is_not_told():
    assert not told(waves(Tp=2.2))[0]
    assert not told(replace(waves(), known=True))[0]
    assert not told(waves(8))[0]


@pytest.mark.parametrize("make", [soft_mooring, flap])
def test_scenes_that_resolve_theirs_are_not_told(make):
    item, h = make()
    item = replace(item, settings=replace(item.settings, method="frequency", froude_krylov="linear"))
    assert not told(None, item=item, h=h)[0]
