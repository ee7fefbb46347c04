"""The time that boundary elements will take: by pairs of panels that a solution then asks the Green function for."""

import itertools
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from pytest import approx

from solver.hydrodynamics.bem import bem, cost, mesh
from solver.hydrodynamics.hull import mesh as meshes
from solver.hydrodynamics.hull.box import box
from solver.hydrodynamics.hull.panel_hull import PanelHull
from solver.hydrodynamics.hull.revolution import Revolution
from solver.scene import PANELS
from tests.awkward import prism

BALL, OTHER = Revolution.sphere(radius=5.0, draft=5.0), Revolution.sphere(radius=4.0, draft=4.0)
RAFT = box(length=20.0, width=10.0, height=4.0, draft=2.0)
SUNK = prism([(-3, -9.0), (4, -8.0), (3, -5.0), (-3, -6.0)], 8.0)
PLATE = Revolution.profile([(0.0, -35.1), (15.0, -35.1), (15.0, -35.0), (3.0, -35.0), (3.0, 3.0)])
PILE = Revolution.vertical_cylinder(radius=2.0, draft=20.0, freeboard=4.0)
SCENES = {
    "a body of revolution": ((BALL,), [(0, 0, 0)], np.inf, {}),
    "above a seabed that matters": ((BALL,), [(0, 0, 0)], 20.0, {}),
    "close above a seabed": ((BALL,), [(0, 0, 0)], 7.0, {}),
    "beside a pile": ((PILE, RAFT), [(0, 0, 0), (13, 0, 0)], 20.0, {}),
    "beside its image": ((RAFT, RAFT), [(-10.5, 0, 0), (10.5, 0, 0)], 40.0, {}),
    "no plane of symmetry": ((BALL, RAFT), [(0, 0, 0), (9, 30, 0)], np.inf, {"planar": False}),
    "too many panels to halve": ((RAFT,) * 5, [(0, 12 * n, 0) for n in range(5)], np.inf, {"planar": False}),
    "under water": ((SUNK,), [(0, 0, 0)], 40.0, {}),
    "a heave plate": ((PLATE,), [(0, 0, 0)], np.inf, {}),
    "each alone": ((BALL, OTHER, BALL), [(-20, 0, 0), (0, 0, 0), (20, 0, 0)], np.inf, {"interaction": False}),
    "with more panels": ((RAFT,), [(0, 0, 0)], np.inf, {"panels": 4 * PANELS}),
}


class Counted:
    """A Green function that costs nothing, and how long a true one would have taken for as many pairs [s]."""

    def __init__(self):
        self.seconds = 0.0

    def evaluate(self, points, part, *, water_depth, wavenumber, adjoint_double_layer, diagonal_term_in_double_layer):
        del wavenumber, adjoint_double_layer, diagonal_term_in_double_layer
        seen, solved = len(points), part.nb_faces
        self.seconds += seen * solved * (cost.SEABED if np.isfinite(water_depth) else cost.FREE)
        return np.zeros((seen, solved), complex), np.eye(seen, solved, dtype=complex)


@pytest.mark.parametrize(
    "name", [pytest.param(name, marks=[pytest.mark.slow] * name.startswith("too many")) for name in SCENES]
)
def test_foreseen_are_the_pairs_of_panels_that_are_solved(name, monkeypatch):
    hulls, centres, depth, how = SCENES[name]
    problem = bem.Problem.of(hulls, np.array(centres, float), depth=depth, omega=np.linspace(0.3, 2.0, 3), **how)
    counted = Counted()
    monkeypatch.setattr(mesh, "green_function", lambda: counted)
    monkeypatch.setattr(mesh, "lu_factor", lambda matrix: None)
    monkeypatch.setattr(mesh, "lu_solve", lambda factors, rhs: rhs)
    monkeypatch.setattr(cost, "FACTORED", 0.0)
    monkeypatch.setattr(cost, "NODE", 0.0)
    bem.part(problem)
    # One solution of these four has no lids; meshes have about as many panels as are asked for.
    assert counted.seconds / cost.seconds(problem) == approx(0.9, abs=0.2)


def test_dense_meshes_cost_what_their_coarser_ones_do():
    azimuth, polar = np.linspace(0, 2 * np.pi, 81)[:-1], np.linspace(0, np.pi, 41)
    points = [(np.sin(t) * np.cos(p), np.sin(t) * np.sin(p), np.cos(t)) for t in polar for p in azimuth]
    corners = [(i * 80 + j, i * 80 + 80 + j, i * 80 + 80 + (j + 1) % 80, i * 80 + (j + 1) % 80)
               for i in range(40) for j in range(80)]  # fmt: skip
    dense = PanelHull.of(np.array(points) * 3.0, np.array(corners))
    problem = bem.Problem.of((dense,), np.zeros((1, 3)), depth=np.inf, omega=np.array([1.0]))
    assert len(dense.wetted) > 1500
    finer, _ = (meshes.panels(problem.meshed[0], problem.base[0], refine=n)[1] for n in problem.divisions)
    assert len(finer) == approx(864, rel=0.2)
    assert cost.seconds(problem) < cost.FREE * 2 * len(dense.wetted) ** 2 / 4


def test_factorizations_count_where_nothing_is_symmetric():
    apart = np.array([[0.0, 0, 0], [9, 30, 0]])
    problem = bem.Problem.of((BALL, RAFT), apart, depth=np.inf, omega=np.array([1.0]))
    mirrored = replace(problem, centres=np.array([[0.0, 0, 0], [30, 0, 0]]))
    assert cost.seconds(problem) > 1.9 * cost.seconds(mirrored)


def test_a_machine_s_pace_goes_by_the_time_of_a_factorization(monkeypatch):
    """On one that takes half a second each time, whatever the first takes."""
    clock = itertools.accumulate([9.0, *cost.PROBES * [0.5], 0.5])
    monkeypatch.setattr(cost, "time", SimpleNamespace(perf_counter=clock.__next__))
    assert cost.pace() == approx(0.5 / (cost.FACTORED * cost.PROBE**3))
