"""Drag at a frame's stations and what it does, by sums over stations and lines; K need not be symmetric."""

from dataclasses import replace

import numpy as np
import pytest
from pytest import approx

from solver.coupled import linear_drag
from solver.coupled.modal import Structure
from solver.frequency.case import case_of
from solver.frequency.stations import Stations
from tests.awkward import SCENES, sea

NW, NM, ND, NS = 5, 3, 2, 4


def made(stream=None, *, few=False):
    """Stations, the water's velocity (nd, ns, nw) and modal rates (nm, nw), all at random; by its patterns if few."""
    random = np.random.default_rng(7)

    def lines(*shape):
        return random.normal(size=shape) + 1j * random.normal(size=shape)

    frame = Structure(
        omega=np.ones(NM), damping=np.zeros(NM), carrier=np.zeros((0, NM)), station=random.normal(size=(NM, ND, NS)),
        drag=random.uniform(1, 2, NS), scale=np.ones(NM),
    )  # fmt: skip
    water = lines(ND, NS, NW)
    water[:, -1] = 0.5 * water[:, 0]
    flat = water.reshape(ND * NS, NW)
    shapes = np.linalg.svd(flat.view(float))[0][:, : ND * (NS - 1)] if few else None
    return Stations(frame, flat, stream, shapes), water, lines(NM, NW)


@pytest.mark.parametrize("few", [False, True])
def test_drag_goes_by_what_flows_past_the_moving_frame(few):
    """By the covariance of patterns and modes, as by that of the flow itself; lines after the waves are the modes'."""
    stations, water, rate = made(few=few)
    flow = water - np.einsum("mw,mds->dsw", rate, stations.frame.station)
    assert stations.covariance(rate) == approx(linear_drag.covariance(stations.flow(rate)))
    more = np.concatenate([rate, rate[:, :2]], axis=1)
    assert stations.covariance(more) == approx(linear_drag.covariance(stations.flow(more)))
    K = linear_drag.of_lines(np.moveaxis(flow, -1, 0)) * stations.frame.drag[:, None, None]
    assert stations.equivalent(rate) == approx(K)
    K = linear_drag.of_lines(np.moveaxis(water, -1, 0)) * stations.frame.drag[:, None, None]
    assert stations.equivalent(None) == approx(K)


@pytest.mark.parametrize("few", [False, True])
def test_what_drag_does_by_any_map_of_it(few):
    stations, water, rate = made(few=few)
    random, shape = np.random.default_rng(2), stations.frame.station
    K, maps = random.normal(size=(NS, ND, ND)), random.normal(size=(6, ND, NS))
    damping, force = stations.acting(K, maps)
    assert damping == approx(np.einsum("kds,sde,nes->kn", maps, K, shape))
    assert force == approx(np.einsum("kds,sde,esw->kw", maps, K, water))
    flow = water - np.einsum("mw,mds->dsw", rate, shape)
    assert force - damping @ rate == approx(np.einsum("kds,sde,esw->kw", maps, K, flow))


@pytest.mark.parametrize("name", ["bare_legs", "unequal_legs"])
def test_seas_share_the_patterns_of_their_flow(name):
    """Which leave nothing of any of them."""
    item, h = SCENES[name]()
    item = replace(item, settings=replace(item.settings, method="frequency", froude_krylov="linear"))
    shared = []
    for seed in (1, 2):
        case = case_of(replace(item, sea=sea(seed=seed, heading=item.sea.heading)), h)
        water, (known, lines) = case.stations.water, case.stations.factors
        shared.append(known)
        assert len(lines) < 0.3 * len(water)
        assert np.abs(known @ lines - water).max() < 1e-10 * np.abs(water).max()
    assert shared[0] is shared[1]
