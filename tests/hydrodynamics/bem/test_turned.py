"""Pairs of panels that are turned onto each other: coefficients are those of the Green function of all pairs."""

from types import SimpleNamespace

import numpy as np
import pytest
from pytest import approx

from solver.hydrodynamics.bem import bem, green, mesh, turned
from solver.hydrodynamics.bem.mesh import Mesh
from solver.hydrodynamics.hull.box import box
from solver.hydrodynamics.hull.revolution import Revolution
from solver.hydrodynamics.hull.ring import ring
from tests.awkward import prism

FLOAT = ring(((10.0, -2.5), (10.0, 2.0), (3.25, 2.0), (3.25, -3.5)))
SPAR = Revolution.profile([(15.0, -35.0), (15.0, -34.0), (3.0, -34.0), (3.0, 5.0)])
NEEDLE = Revolution.vertical_cylinder(radius=0.5, draft=4.0, freeboard=1.0)
BALL = Revolution.sphere(radius=5.0, draft=5.0)
SUNK = ring(((4.0, -30.0), (4.0, -28.0), (2.0, -28.0), (2.0, -30.0)))
SQUARE = box(length=8.0, width=8.0, height=3.0, draft=1.5)
RAFT = prism([(-4.0, -12.0), (4.0, -12.0), (4.0, -10.0), (-4.0, -10.0)], 5.0)
HERE, THERE = [0.0, 0.0, 0.0], [123.4, -56.7, 0.0]
SCENES = {  # hulls, centres, depth, further, and the most of all pairs that is asked for
    "a sphere": ((BALL,), [THERE], np.inf, {}, 0.84),
    "two bodies": ((SPAR, FLOAT), [HERE, HERE], np.inf, {}, 0.46),
    "their gap with a lid": ((SPAR, FLOAT), [HERE, HERE], np.inf, {"gap_damping": 0.05, "gap_width": 0.6}, 0.5),
    "close above a seabed": ((BALL,), [HERE], 7.0, {}, 0.84),
    "seabed further down": ((BALL,), [HERE], 15.0, {}, 0.84),
    "unlike sizes, off the origin": ((NEEDLE, FLOAT), [THERE, THERE], np.inf, {}, 0.49),
    "one deep under water": ((BALL, SUNK), [HERE, HERE], 60.0, {}, 0.38),
    "a box about a spar's axis": ((NEEDLE, RAFT), [[0, 0, 0], [0, 0, 0]], np.inf, {}, 0.94),
    "a square box": ((SQUARE,), [HERE], np.inf, {}, 0.55),
    "side by side": ((BALL, NEEDLE), [[0, 0, 0], [9, 0, 0]], np.inf, {}, 1.0),
}


def problem_of(name, **further):
    hulls, centres, depth, how, _ = SCENES[name]
    omega = np.array([0.7])
    return bem.Problem.of(hulls, np.array(centres), depth=depth, omega=omega, planar=False, **how, **further)


def coarse(problem):
    """Its coarsest mesh."""
    where = problem.meshed, problem.centres, problem.dofs, problem.base, 1, problem.depth
    return Mesh.build(*where, lids=problem.lids, gap_width=problem.gap_width, narrow=problem.meshing.narrow)


def asked(mesh):
    """Share of all pairs that the Green function is asked for."""
    pairs = sum(len(some.at) * some.sources.nb_faces for some in mesh.alike)
    return pairs / (mesh.whole.nb_faces * mesh.part.nb_faces)


def all_asked(monkeypatch):
    monkeypatch.setattr(turned, "_orders", lambda whole, _: np.ones(whole.nb_faces, int))


@pytest.mark.parametrize("name", SCENES)
def test_influences_are_those_of_all_pairs(name, monkeypatch):
    problem = problem_of(name)
    few = coarse(problem)
    assert 0.9 * SCENES[name][-1] < asked(few) <= SCENES[name][-1]
    all_asked(monkeypatch)
    every = coarse(problem)
    assert asked(every) == 1.0
    for k in (0.1, np.inf):
        found, told = (mesh._influences(k, problem.seabed(k)) for mesh in (few, every))
        for one, other, tolerance in zip(found, told, (1e-12, 1e-9), strict=True):
            assert np.abs(one - other).max() < tolerance * np.abs(other).max()


@pytest.mark.parametrize("name", ["a sphere", "their gap with a lid"])
def test_coefficients_are_those_of_all_pairs(name, monkeypatch):
    """At oblique headings, with the waves far off."""
    problem = problem_of(name, panels=108, headings=(0.3, 2.0), far_field=True)
    few = bem.part(problem)
    all_asked(monkeypatch)
    for one, other in zip(few[0], bem.part(problem)[0], strict=True):
        for found, told in zip(one[:4], other[:4], strict=True):
            assert found == approx(told, abs=1e-10 * np.abs(told).max(initial=0.0), rel=1e-8)


def test_round_about_another_axis_is_asked_in_full():
    """A ball off the only plane of symmetry that is left."""
    problem = bem.Problem.of((BALL, NEEDLE), np.array([[0.0, 0, 0], [9, 4, 0]]), depth=np.inf, panels=108)
    assert asked(coarse(problem)) == 1.0


def test_influences_of_all_pairs_are_those_that_the_green_function_gives(monkeypatch):
    """Copied nowhere."""
    green_function, given = green.green_function(), []

    def evaluate(*where, **how):
        given.extend(green_function.evaluate(*where, **how))
        return given

    monkeypatch.setattr(mesh, "green_function", lambda: SimpleNamespace(evaluate=evaluate))
    found = coarse(problem_of("side by side"))._influences(0.1, np.inf)
    assert len(given) == 2 and all(np.shares_memory(*both) for both in zip(found, given, strict=True))


def test_panels_turned_within_themselves_are_not_alike():
    """Oblong ones at the corners of a square are onto each other's middles, not onto each other's corners."""
    oblong = np.array([[0.9, 0.8, -1], [1.1, 0.8, -1], [1.1, 1.2, -1], [0.9, 1.2, -1]])
    across = oblong[:, [1, 0, 2]][::-1]
    for pieces, order in (((oblong,) * 4, 2), ((oblong, across, oblong, across), 4)):
        signs = ([1, 1, 1], [-1, 1, 1], [-1, -1, 1], [1, -1, 1])
        corners = [p * s if np.prod(s) > 0 else (p * s)[::-1] for p, s in zip(pieces, signs, strict=True)]
        whole = green.joined([(corner, np.arange(4)[None]) for corner in corners])
        assert turned._orders(whole, lambda n, of=whole: turned._turned(of, n)).tolist() == [order] * 4
