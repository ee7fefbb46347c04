"""Drag at a frame's stations and what it does, by sums over stations and lines; K need not be symmetric."""

import numpy as np
from pytest import approx

from solver.coupled import linear_drag
from solver.coupled.modal import Structure
from solver.frequency.stations import Stations

NW, NM, ND, NS = 5, 3, 2, 4


def made(stream=None):
    """Stations, the water's velocity (nd, ns, nw) and modal rates (nm, nw), all at random."""
    random = np.random.default_rng(7)

    def lines(*shape):
        return random.normal(size=shape) + 1j * random.normal(size=shape)

    frame = Structure(
        omega=np.ones(NM), damping=np.zeros(NM), carrier=np.zeros((0, NM)), station=random.normal(size=(NM, ND, NS)),
        drag=random.uniform(1, 2, NS), scale=np.ones(NM),
    )  # fmt: skip
    water = lines(ND, NS, NW)
    return Stations(frame, water.reshape(ND * NS, NW), stream), water, lines(NM, NW)


def test_drag_goes_by_what_flows_past_the_moving_frame():
    stations, water, rate = made()
    flow = water - np.einsum("mw,mds->dsw", rate, stations.frame.station)
    K = linear_drag.of_lines(np.moveaxis(flow, -1, 0)) * stations.frame.drag[:, None, None]
    assert stations.equivalent(rate) == approx(K)
    K = linear_drag.of_lines(np.moveaxis(water, -1, 0)) * stations.frame.drag[:, None, None]
    assert stations.equivalent(None) == approx(K)


def test_what_drag_does_by_any_map_of_it():
    stations, water, rate = made()
    random, shape = np.random.default_rng(2), stations.frame.station
    K, maps = random.normal(size=(NS, ND, ND)), random.normal(size=(6, ND, NS))
    damping, force = stations.acting(K, maps)
    assert damping == approx(np.einsum("kds,sde,nes->kn", maps, K, shape))
    assert force == approx(np.einsum("kds,sde,esw->kw", maps, K, water))
    flow = water - np.einsum("mw,mds->dsw", rate, shape)
    assert force - damping @ rate == approx(np.einsum("kds,sde,esw->kw", maps, K, flow))
