"""Drag beyond the linear one: against closed forms, long samples of the whole drag, and the march."""

from dataclasses import replace

import numpy as np
import pytest
from pytest import approx

from solver.coupled import linear_drag
from solver.frequency import beyond
from solver.frequency.case import case_of
from solver.frequency.response import respond
from solver.run import simulate
from solver.scene import Settings
from solver.sea.realization import realize, regular
from solver.sea.spectrum import PiersonMoskowitz
from tests.awkward import SCENES, sea

STEEP = sea(Hs=3.0, Tp=8.0, band=(0.35, 2.5), heading=np.pi / 6)
DENSE = {"components": 400, "band": (0.7, 3.4), "heading": np.pi / 6}  # fewer waves meet a resonance by chance


def lines(item, h=None):
    item = replace(item, settings=replace(item.settings, froude_krylov="linear", method="frequency"))
    return case_of(item, h), respond(item, h)


def covariance(a, b, R):
    """(d, d) of the terms `a` at one place with those `b` at another, whose velocities have the covariance R (d, d)."""
    r = a.e @ R @ b.e.T
    return a.e.T @ sum(np.outer(a.terms[:, n - 2], b.terms[:, n - 2]) * r**n for n in range(2, 6)) @ b.e


@pytest.mark.parametrize("r", [-0.6, 0.2, 0.8])
def test_higher_orders_of_a_gaussians_square(r):
    """⟨|u|u |v|v⟩ = [(4r² + 2) asin r + 6r(1 - r²)^½]/π (Borgman 1967), of which 8r/π is linear; what is left is r⁷."""
    one = linear_drag.beyond(np.zeros(1), np.eye(1))
    exact = ((4 * r**2 + 2) * np.arcsin(r) + 6 * r * np.sqrt(1 - r**2)) / np.pi - 8 * r / np.pi
    assert covariance(one, one, np.array([[r]]))[0, 0] == approx(exact, rel=0.03 * r**4)


@pytest.mark.parametrize("U", [(0.0, 0.0), (0.5, 0.2), (2.5, -1.0)])
def test_terms_are_what_is_not_linear_of_the_drag(U):
    """In a plane, of two velocities that are alike in part: against 10⁶ pairs of them."""
    random, U = np.random.default_rng(5), np.array(U)
    mix = np.array([[0.8, 0.0], [0.3, 0.5]])
    x = random.normal(size=(2, 500_000, 2)) @ mix.T
    pairs = 0.7 * x[0] + np.sqrt(1 - 0.49) * x[1], x[0]
    drag = [np.linalg.norm(u + U, axis=1, keepdims=True) * (u + U) for u in (*pairs, *(-p for p in pairs))]
    (a, b), S = (np.concatenate(part) for part in (drag[::2], drag[1::2])), mix @ mix.T
    F, K = linear_drag.in_stream(U, S)
    terms = linear_drag.beyond(U, S)
    exact = (a - F).T @ (b - F) / len(a) - K @ (0.7 * S) @ K.T
    found = covariance(terms, terms, 0.7 * S)
    assert np.abs(found - exact).max() < 0.06 * np.abs(exact).max()
    turn = np.array([[0.6, -0.8], [0.8, 0.6]])
    turned = linear_drag.beyond(turn @ U, turn @ S @ turn.T)
    assert covariance(turned, turned, 0.7 * turn @ S @ turn.T) == approx(turn @ found @ turn.T)


def test_terms_in_space_are_those_of_their_plane():
    S, lean = np.diag([0.5, 0.2]), np.linalg.qr(np.random.default_rng(2).normal(size=(3, 3)))[0]
    flat, whole = linear_drag.beyond(np.zeros(2), S), linear_drag.beyond(np.zeros(3), lean @ np.pad(S, (0, 1)) @ lean.T)
    found = lean.T @ covariance(whole, whole, lean @ np.pad(0.9 * S, (0, 1)) @ lean.T) @ lean
    assert found == approx(np.pad(covariance(flat, flat, 0.9 * S), (0, 1)), abs=1e-12)


def test_flow_along_a_line_has_the_terms_of_that_line():
    along, size = np.array([0.6, 0.8]), np.array([[0.7]])
    line, plane = (
        linear_drag.beyond(np.array([0.3]), size),
        linear_drag.beyond(0.3 * along, 0.7 * np.outer(along, along)),
    )
    found, one = covariance(plane, plane, 0.5 * np.outer(along, along)), covariance(line, line, np.array([[0.5]]))
    assert found == approx(one[0, 0] * np.outer(along, along))


def test_nodes_integrate_resonances_and_what_is_between_them():
    """Of a narrow and a wide one, and a smooth curve; one that is not the frame's has no nodes of its own."""
    own, half = np.array([0.39, 1.6]), np.array([0.004, 0.05])
    at = beyond.nodes(4.0, own, half, np.ones(2))
    for w, g in zip(own, half, strict=True):
        exact = g * (np.arctan((12.0 - w) / g) + np.arctan(w / g))
        assert np.sum(at.width / (1 + ((at.omega - w) / g) ** 2)) == approx(exact, rel=0.02)
    assert np.sum(at.width * np.exp(-at.omega)) == approx(1 - np.exp(-12.0), rel=0.02)
    even = beyond.nodes(4.0, own, half, np.zeros(2))
    assert even.omega == approx(np.append(np.arange(0.2, 4.0, 0.4), np.arange(4.4, 12.0, 0.8)), rel=1e-3)
    assert even.width == approx(np.repeat([0.4, 0.8], 10))
    model = beyond.nodes(3.3 * 20**0.5, own * 20**0.5, 1.3 * half * 20**0.5, np.ones(2), 20**0.5)
    assert model.omega == approx(beyond.nodes(3.3, own, 1.3 * half, np.ones(2)).omega * 20**0.5)


@pytest.mark.parametrize("stream", [False, True])
def test_lines_are_those_of_the_whole_drag(stream):
    """Modal forces of |u|u - F - Ku of long samples, below the fastest wave, a fifth of it and above it."""
    bare, _ = SCENES["bare_legs"]()
    item = replace(bare, sea=STEEP)
    case, _ = lines(item)
    stations, frame = case.stations, case.system.structure
    if stream:
        flow = np.broadcast_to(np.array([0.4, 0.3, 0.0])[: stations.on[0], None], stations.on)
        stations = type(stations)(frame, stations.water.view(complex), flow)
    at, static = beyond.nodes(float(case.waves.max()), *np.zeros((3, 0))), frame.scale / frame.omega**2
    found = stations.shape @ beyond.forces(stations, case.waves, case.process.duration, at) * static[:, None]
    ends = np.cumsum(at.width)[[1, 9, -1]]
    exact = samples(stations, frame, case.waves, ends[-1]) * static[:, None]
    parts = (found, [2, 10]), (exact, (1200.0 / (2 * np.pi) * ends[:2]).astype(int))
    powers = [[np.sum(np.abs(part) ** 2) for part in np.split(x, at, axis=1)] for x, at in parts]
    assert powers[0] == approx(powers[1], rel=0.05)


def samples(stations, frame, omega, highest):
    """Lines (nm, n) of the modal forces, below a frequency: in the mean of 200 seas of one spectrum."""
    random, n, T = np.random.default_rng(6), 2**12, 1200.0
    water = stations.water.view(complex).reshape(*stations.on, -1)
    U = np.zeros(stations.on) if stations.stream is None else stations.stream
    F, K = linear_drag.of_parts_in(U, stations.flow(None))
    place, squares = np.round(omega * T / (2 * np.pi)).astype(int), 0.0
    for _ in range(200):
        turned = water * (random.normal(size=omega.size) + 1j * random.normal(size=omega.size)) / np.sqrt(2)
        spectrum = np.zeros((*stations.on, n // 2 + 1), complex)
        np.add.at(spectrum, (..., place), turned)
        u = np.fft.irfft(spectrum.conj() * n / 2, n)
        whole = u + U[..., None]
        rest = np.linalg.norm(whole, axis=0) * whole - F.T[..., None] - np.einsum("sde,esn->dsn", K, u)
        modal = np.einsum("kds,dsn->kn", frame.station * frame.drag, rest)
        squares = squares + np.abs(np.fft.rfft(modal)[:, 1:] * 2 / n) ** 2
    return np.sqrt(squares / 200)[:, : int(highest * T / (2 * np.pi))]


@pytest.mark.slow
def test_it_drives_a_resonance_below_the_waves():
    """Three legs of unequal height under a heavy deck: the march's std, of which the linear response lacks a tenth."""
    bare, _ = SCENES["bare_legs"]()
    frame = replace(bare.platform.frame, masses=(replace(bare.platform.frame.masses[0], mass=6e7),))
    waves = realize(PiersonMoskowitz(Hs=3.0, Tp=5.5), seed=1, **DENSE)
    item = replace(bare, platform=replace(bare.platform, frame=frame, damping_ratio=0.05), sea=waves)
    case, response = lines(item)
    assert 0.2 < case.modes.omega[0] < 0.6 < case.waves.min()
    settings = {"froude_krylov": "linear", "duration": 6 * 3600.0, "discard": 2000.0}
    march = simulate(replace(item, settings=Settings(**settings)))
    table = simulate(replace(item, settings=Settings(**settings, method="frequency")))
    exact, std = (r.variables["top_displacement"][1][0, 0, 4] for r in (march, table))
    tops = np.tensordot(response.X[: case.waves.size], case.channels.legs.tops, axes=1)[:, 0, 0]
    assert std == approx(exact, rel=0.05)
    assert np.linalg.norm(tops) / np.sqrt(2) < 0.9 * exact


def test_swell_of_few_waves_drives_nothing_far_below_it():
    """Nothing is left where its spectrum is rounding, and no number fails."""
    bare, _ = SCENES["bare_legs"]()
    swell = sea(Hs=1.0, Tp=6.0, band=(1.0, 1.03), heading=0.5)
    case, response = lines(replace(bare, sea=swell))
    assert np.all(np.isfinite(response.X))
    below = response.X[case.waves.size :][(case.nodes.omega > 0.3) & (case.nodes.omega < 0.7)]
    assert np.linalg.norm(below) < 1e-3 * np.linalg.norm(response.X)


def test_without_drag_or_in_one_wave_there_is_none():
    bare, _ = SCENES["bare_legs"]()
    frame = bare.platform.frame
    smooth = replace(frame, members=tuple(replace(m, drag_coefficient=0.0) for m in frame.members))
    one = regular(height=1.0, period=6.0, heading=0.5)
    for item in (replace(bare, platform=replace(bare.platform, frame=smooth)), replace(bare, sea=one)):
        case, response = lines(item)
        assert len(response.X) == case.waves.size
