"""Tensions and loads of mooring lines that motions pull far from their slope at rest, in the frequency domain."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from pytest import approx

from solver.coupled.equilibrium import balance
from solver.frequency import gaussian
from solver.frequency.case import case_of
from solver.frequency.catenaries import held, slopes, tension_table, without_lines
from solver.frequency.response import respond
from solver.mooring import Line
from solver.run import simulate
from solver.sea.realization import regular
from solver.statistics import STATISTICS
from tests import awkward

MEAN, STD, MAX = (STATISTICS.index(name) for name in ("mean", "std", "max"))


@cache
def barge():
    """The awkward barge between lines that are nearly taut."""
    whole, h = awkward.soft_mooring()
    lines = (
        Line(anchor=(-90.0, 0.0, -50.0), fairlead=(-5.0, 0.0, -0.5), length=98.9, weight=300.0, EA=2e7),
        Line(anchor=(110.0, 0.0, -50.0), fairlead=(5.0, 0.0, -0.5), length=117.0, weight=250.0, EA=2e7),
    )
    item = replace(whole, floats=(replace(whole.floats[0], stiffness=0.0, lines=lines),))
    return replace(item, settings=replace(item.settings, method="frequency")), h


def moving(height=1.0):
    """Case and response."""
    item, h = barge()
    item = replace(item, sea=replace(item.sea, amplitude=height * item.sea.amplitude))
    case = case_of(item, h)
    return case, respond(item, h)


def drawn(case, response):
    """Places of all coordinates that are as likely as the response."""
    return case.system.equilibrium[0] + gaussian._normal(gaussian.covariance(response.Z, response.Z))


def test_tensions_are_those_of_gaussian_motions():
    """Mean and std of what places drawn from them have, that are far from those of its slope."""
    case, response = moving(2.0)
    z = case.system.equilibrium[0]
    told, every = (
        tension_table(case, response.Z, z),
        case.channels.line_tension(case.system.bodies, drawn(case, response)),
    )
    assert told[:, MEAN] == approx(every.mean(axis=0), rel=2e-3)
    assert told[:, STD] == approx(every.std(axis=0), rel=0.02)
    rest = case.channels.line_tension(case.system.bodies, z[None])[0]
    assert told[0, MEAN] > 1.02 * rest[0]
    assert told[0, MAX] > rest[0] + 1.2 * gaussian.peak(response.Z[:, :1], case.process)[0] * told[0, STD]


def test_lines_are_linearised_by_what_they_do_in_the_mean():
    """⟨Q⟩ and ⟨Q zᵀ⟩S⁻¹ of places drawn; together with the slope at rest the load's best line."""
    case, response = moving(2.0)
    body, z, every = case.system.bodies, case.system.equilibrium[0], drawn(case, response)
    of, S = held(case, response.Z, z), gaussian.covariance(response.Z, response.Z)
    loads, on_floats = (
        a - b for a, b in zip(balance(body, every)[:2], balance(without_lines(body), every)[:2], strict=True)
    )
    at_rest, there = (
        a[0] - b[0] for a, b in zip(balance(body, z[None])[:2], balance(without_lines(body), z[None])[:2], strict=True)
    )
    size = loads.std(axis=0)
    assert np.abs((loads.mean(axis=0) - at_rest - of.load) / size).max() < 0.01
    assert np.abs(on_floats.mean(axis=0) - there - of.wrench).max() < 0.01 * np.abs(on_floats).std(axis=0).max()
    K = -np.linalg.lstsq(every - z, loads - loads.mean(axis=0), rcond=None)[0].T
    step = 1e-4 * np.eye(len(z))
    slope = [
        np.subtract(balance(body, z + way * step)[0], balance(without_lines(body), z + way * step)[0])
        for way in (1, -1)
    ]
    tangent = (slope[1] - slope[0]).T / 2e-4
    spread = np.sqrt(np.diag(S))
    scale = np.abs(K * spread[:, None] * spread).max()
    assert np.abs((K - tangent - of.stiffness) * spread[:, None] * spread).max() < 0.01 * scale
    assert np.abs((K - tangent) * spread[:, None] * spread).max() > 0.05 * scale


def test_small_motions_have_the_slopes_statistics():
    case, response = moving(1e-3)
    z = case.system.equilibrium[0]
    told = tension_table(case, response.Z, z)
    level = case.channels.line_tension(case.system.bodies, z[None])[0]
    usual = gaussian.table(level, response.Z @ slopes(case, z), case.process)
    assert (told - level[:, None])[:, [0, 1]] == approx((usual - level[:, None])[:, [0, 1]], rel=2e-3)
    assert told[:, STD] == approx(usual[:, STD], rel=1e-3) and told[:, MEAN] == approx(usual[:, MEAN], rel=1e-6)
    assert simulate(case.system.scene, case.hydrodynamics).attrs["linearisation_effect"] < 1e-4


@pytest.mark.parametrize("height", [0.8, 1.4])
def test_one_wave_pulls_lines_as_a_march_does(height):
    """Mean, std and largest tension, and how far the barge is shifted, within what is told; with slopes far from it."""
    item, h = barge()
    sea = regular(height=height, period=7.0)
    settings = replace(item.settings, duration=210.0, discard=600.0)
    told, marched = (
        simulate(replace(item, sea=sea, settings=replace(settings, method=method)), h)
        for method in ("frequency", "time")
    )
    (ours, surge), (exact, shifted) = (
        (record.variables["line_tension"][1], record.variables["motion"][1][0, 0]) for record in (told, marched)
    )
    case = case_of(replace(item, sea=sea), h)
    usual = gaussian.spread(respond(case.system.scene, h).Z @ slopes(case, case.system.equilibrium[0]))
    error = told.attrs["estimated_error"]
    off = np.abs(ours[:, STD] / exact[:, STD] - 1)
    assert off.max() < 1.5 * error and off.max() > error / 6 and error < 0.09
    assert np.abs(usual / exact[:, STD] - 1).max() > 2 * off.max()
    assert ours[:, MEAN] == approx(exact[:, MEAN], rel=0.015) and ours[:, MAX] == approx(exact[:, MAX], rel=0.05)
    assert surge[MEAN] == approx(shifted[MEAN], rel=0.03) and surge[MEAN] < -0.1
