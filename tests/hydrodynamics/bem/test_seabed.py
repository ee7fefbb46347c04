"""What the seabed adds: beside series of eigenfunctions and of images, and all pairs of panels asked of capytaine."""

from dataclasses import replace
from functools import partial
from types import SimpleNamespace

import numpy as np
import pytest
from pytest import approx
from scipy.optimize import brentq
from scipy.special import j0, k0, y0

from solver.hydrodynamics.bem import bem, green, mesh, seabed
from solver.hydrodynamics.hull.box import box
from solver.hydrodynamics.hull.revolution import Revolution
from solver.hydrodynamics.hull.ring import ring
from tests.awkward import prism

BALL, SMALL = Revolution.sphere(radius=2.5, draft=2.5), Revolution.sphere(radius=1.0, draft=0.4)
MODEL = Revolution.sphere(radius=0.05, draft=0.05)
RAFT = box(length=20.0, width=10.0, height=4.0, draft=2.0)
SUNK = prism([(-3, -9.0), (4, -8.0), (3, -5.0), (-3, -6.0)], 8.0)
SPAR = Revolution.profile([[15.0, -29.0], [15.0, -28.0], [3.0, -28.0], [3.0, 8.0]])
CAISSON = box(length=4.0, width=3.0, height=8.0, draft=6.0)
SLOW = "big beside small", "beside a caisson", "about a pile", "a gap with a lid"
PILE = Revolution.vertical_cylinder(radius=1.0, draft=12.0, freeboard=2.0)
FLOAT = ring(((4.0, -1.5), (4.0, 1.0), (1.5, 1.0), (1.5, -1.5)))
SCENES = {  # hulls, centres, depth, further
    "a pair": ((BALL, BALL), [(0, 6, 0), (0, -6, 0)], 15.0, {}),
    "big beside small": ((RAFT, SMALL), [(0, 0, 0), (13, 7, 0)], 40.0, {"planar": False}),
    "under water": ((SUNK,), [(0, 0, 0)], 14.0, {"planar": False}),
    "a spar": ((SPAR,), [(0, 0, 0)], 45.0, {}),
    "a model": ((MODEL,), [(0, 0, 0)], 0.2, {}),
    "beside a caisson": ((CAISSON, SMALL), [(0, 0, 0), (4, 0, 0)], 6.0, {}),
    "about a pile": ((PILE, FLOAT), [(0, 0, 0), (0, 0, 0)], 12.0, {}),
    "a gap with a lid": ((RAFT, RAFT), [(0, 5.5, 0), (0, -5.5, 0)], 20.0, {"gap_damping": 0.02, "gap_width": 2.0}),
}


def between(K, depth, apart):
    """Two boxes of 3 m, `apart` [m]: what the seabed adds from nodes of one to those of the other, and the nodes."""
    k = np.inf if np.isinf(K) else brentq(lambda k: k * np.tanh(k * depth) - K, 0, K + 1 / depth, xtol=1e-15)
    half, counts = np.array([1.5, 1.5, 0.25]), np.array([4, 3, 3])
    at, of = (seabed.Box(np.array([x, x / 12, -0.25]), half, counts) for x in (0.0, apart))
    path = seabed.Path.beneath(k, depth, 2 * (depth - 0.5), apart + 4.0)
    nodes = (np.stack(np.meshgrid(*box.axes, indexing="ij"), axis=-1).reshape(-1, 3) for box in (at, of))
    return k, seabed.between(path, at, of), *nodes


def eigenfunctions(k, depth, at, of):
    """The whole Green function: John's series (Wehausen and Laitone 1960, eq. 13.19), for waves exp(-iωt)."""
    R, z, there = np.hypot(*np.moveaxis(at[:, None, :2] - of[:, :2], -1, 0)), at[:, 2][:, None], of[:, 2]
    K = k * np.tanh(k * depth)
    waves = np.cosh(k * (z + depth)) * np.cosh(k * (there + depth)) / np.cosh(k * depth) ** 2
    energy = (k / np.cosh(k * depth)) ** 2 * depth + K
    total = 2 * np.pi * k**2 / energy * waves * (1j * j0(k * R) - y0(k * R))
    for m in range(1, 300):
        low, high = (m - 0.5) * np.pi / depth, m * np.pi / depth
        root = brentq(lambda x: x * np.sin(x * depth) + K * np.cos(x * depth), low, high)
        share = 4 * (root**2 + K**2) / (depth * (root**2 + K**2) - K)
        total += share * np.cos(root * (z + depth)) * np.cos(root * (there + depth)) * k0(root * R)
    return total


@pytest.mark.parametrize(("K", "apart"), [(0.4, 8.0), (0.04, 12.0), (0.0145, 25.0), (0.0017, 12.0), (1e-5, 12.0)])
def test_two_depths_differ_as_by_eigenfunctions(K, apart):
    """In deep water that series does not converge. kh from 0.014 to 4.8."""
    (k, shallow, at, of), (other, deep, _, _) = (between(K, depth, apart) for depth in (12.0, 40.0))
    told = eigenfunctions(k, 12.0, at, of) - eigenfunctions(other, 40.0, at, of)
    assert np.abs(shallow - deep - told).max() < 1e-7 * np.abs(told).max()


@pytest.mark.parametrize("kh", [0.101, 0.18, 0.3, 1.0, 5.0])
def test_capytaines_function_for_finite_depth_is_that_of_eigenfunctions(kh):
    """From still water to the seabed; by its own sums of exponentials it is 2 % off where kh = 0.18."""
    depth, side = 4.0, 1e-3
    of = np.array([[0.0, 0.0, -0.3], [0, 0, -3], [0, 0, -3.9]])
    at = np.array([[r, 0.0, z] for r in (0.5, 1.0, 4.0, 20.0) for z in (-0.3, -3.0, -3.9)])
    square = side / 2 * np.array([[-1.0, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0]])
    panels = green.joined([(square + place, np.arange(4)[None]) for place in of])
    single, _ = green.green_function().evaluate(
        at, panels, water_depth=depth, wavenumber=kh / depth, adjoint_double_layer=False,
        diagonal_term_in_double_layer=False,
    )  # fmt: skip
    told = eigenfunctions(kh / depth, depth, at, of)
    assert np.abs(single * -4 * np.pi / side**2 - told).max() < 4e-4 * np.abs(told).max()


def test_at_infinite_frequency_it_is_a_series_of_images():
    """Mirrored in the seabed alike, in still water with another sign."""
    _, found, at, of = between(np.inf, 12.0, 8.0)
    R, z, there = np.linalg.norm(at[:, None, :2] - of[:, :2], axis=-1), at[:, 2][:, None], of[:, 2]
    terms = np.array([
        (-1) ** n * sum(sign / np.hypot(R, 24.0 * (n + 1) + x) for sign, x in (
            (1, -z - there), (1, z + there), (-1, z - there), (-1, there - z)))
        for n in range(4001)
    ])  # fmt: skip
    images = terms.sum(axis=0) - terms[-1] / 2
    assert np.abs(found - images).max() < 1e-7 * np.abs(images).max()


@pytest.mark.parametrize(
    ("depth", "k", "counts"),
    [(50.0, 0.02, (3, 3, 3)), (12.0, 0.3, (5, 5, 4)), (6.0, 0.02, (7, 7, 5)), (6.0, 0.5, (7, 7, 5))],
)
def test_so_many_nodes_miss_no_more_than_is_said(depth, k, counts):
    """Of a box of 5 by 5 by 2.5 m, from a corner of it, beside many more nodes."""
    clear, half, middle = 2 * (depth - 2.5), np.array([2.5, 2.5, 1.25]), np.array([0, 0, -1.25])
    enough = seabed.nodes_along(half, clear, k)
    assert tuple(enough) == counts
    path = seabed.Path.beneath(k, depth, clear, 8.0)
    points = middle + half * np.random.default_rng(1).uniform(-1, 1, (40, 3))
    corner = seabed.Box(np.array([2.4, 2.4, -2.4]), 0.1 * np.ones(3), np.ones(3, int) * 2)
    few, many = (
        box.polynomials(points)[0] @ seabed.between(path, box, corner)
        for box in (seabed.Box(middle, half, enough), seabed.Box(middle, half, enough + 6))
    )
    assert 1e-9 < np.abs(few - many).max() / np.abs(many).max() < 8 * seabed.MISSED


@pytest.mark.parametrize(
    "name",
    [pytest.param(name, marks=[pytest.mark.slow] * (name in SLOW)) for name in SCENES],
)
def test_coefficients_are_those_of_all_pairs_of_panels(name, monkeypatch):
    """Relative to the geometric mean of both motions' own; in deep water they are 2 to 40 % off."""
    hulls, centres, depth, how = SCENES[name]
    omega = np.sqrt(9.81 * np.array([0.5 * np.tanh(0.5), 1.0 * np.tanh(1.0)]) / depth)
    problem = bem.Problem.of(hulls, np.array(centres, float), depth=depth, omega=omega, **how)
    solved = partial(bem._coefficients, omega=omega, refine=1, infinite=True)
    monkeypatch.setattr(seabed, "WORTH", 1e9)
    smooth = solved(problem)
    monkeypatch.setattr(seabed, "WORTH", 0.0)
    direct, deep = solved(problem), solved(replace(problem, depth=np.inf))
    size = np.sqrt(np.abs(np.einsum("wii->wi", direct.impedance)))
    scale = size[:, :, None] * size[:, None]
    assert np.all(np.abs(smooth.impedance - direct.impedance) <= 5e-4 * scale)  # 0: heave of what stands
    assert np.any(np.abs(deep.impedance - direct.impedance) > 1e-2 * scale)
    assert smooth.infinite == approx(direct.infinite, abs=5e-4 * np.abs(direct.infinite).max())
    assert smooth.diffraction == approx(direct.diffraction, abs=5e-4 * np.abs(direct.diffraction).max())


def built_of(problem, refine):
    where = problem.meshed, problem.centres, problem.dofs, problem.base, refine, problem.depth
    return mesh.Mesh.build(*where, lids=problem.lids)


def test_it_is_left_to_capytaine_close_above_the_seabed():
    problem = bem.Problem.of((BALL,), np.zeros((1, 3)), depth=3.0)
    built = built_of(problem, 3)
    panels = built.whole, built.bodies, np.tile(built.standing, len(built.mirrors)), built.part
    assert seabed.added(*panels, 3.0, 0.1) is None
    assert seabed.added(*panels, 30.0, 0.1) is not None


def test_bodies_that_stand_on_the_seabed_are_left_to_capytaine_on_each_other(monkeypatch):
    """And on others not; alone, and a wide one, whose nodes would be too many, in all."""
    assert [seabed.clearance(6.0, 1.0, standing=some) for some in (False, True)] == [10.0, 5.0]
    green_function, asked = green.green_function(), []

    def evaluate(points, part, *, water_depth, **how):
        asked.append((len(points), part.nb_faces, water_depth))
        return green_function.evaluate(points, part, water_depth=water_depth, **how)

    monkeypatch.setattr(mesh, "green_function", lambda: SimpleNamespace(evaluate=evaluate))
    wide = box(length=40.0, width=40.0, height=8.0, draft=6.0)
    for hulls, apart, far in (((CAISSON, SMALL), 4.0, True), ((CAISSON,), 0.0, False), ((wide, SMALL), 22.0, False)):
        centres = np.array([[0.0, 0, 0], [apart, 0, 0]])[: len(hulls)]
        built = built_of(bem.Problem.of(hulls, centres, depth=6.0, panels=108), 1)
        built._influences(0.1, 6.0)
        stands, part = built.standing.sum(), built.part.nb_faces
        ng = len(built.mirrors)
        assert (0 < stands < part) == (len(hulls) == 2)
        if far:
            assert asked == [(ng * part, part, np.inf), (ng * stands, stands, 6.0)]
        else:
            assert {depth for *_, depth in asked} == {6.0}
        asked.clear()


@pytest.mark.parametrize("draft", [18.0, 18.8])
def test_the_seabed_is_kept_beneath_deep_hulls(draft):
    """However narrow: at infinite frequency it adds 10 and 20 % to the added mass of these in heave."""
    hull = Revolution.vertical_cylinder(radius=1.0, draft=draft, freeboard=2.0)
    near, deep = (
        bem.Problem.of((hull,), np.zeros((1, 3)), depth=depth, omega=np.array([2.6])) for depth in (20, np.inf)
    )
    assert near.seabed(np.inf) == near.seabed(near.seas[0].wavenumber(2.6)) == 20.0
    heave = [bem._coefficients(p, p.omega, 1, infinite=True).infinite[1, 1] for p in (near, deep)]
    assert heave[0] / heave[1] == approx(1.105 if draft == 18.0 else 1.2, abs=0.02)
