"""Rings round a well: closed forms of what they displace, and the limit of a narrow well."""

from functools import partial
from math import inf

import numpy as np
import pytest
from pytest import approx

from solver.errors import InputError
from solver.hydrodynamics.bem import bem
from solver.hydrodynamics.hull import mesh as meshes
from solver.hydrodynamics.hull.panel_hull import PanelHull
from solver.hydrodynamics.hull.revolution import Revolution
from solver.hydrodynamics.hull.ring import ring

SECTION = ((10.0, -3.0), (10.0, 2.0), (3.0, 2.0), (3.0, -3.0))


def lopsided(well, x, y):
    """The ring of 10 m with its well off the axis by (x, y) m, and of another radius [m]."""
    round_ = ring(((10.0, -3.0), (10.0, 2.0), (well, 2.0), (well, -3.0)))
    vertices = round_.vertices + (np.hypot(*round_.vertices.T[:2]) < 1.1 * well)[:, None] * (x, y, 0.0)
    return PanelHull.of(vertices, round_.faces)


def test_volume_and_waterplane_are_exact():
    hull = ring(SECTION)
    area = np.pi * (10.0**2 - 3.0**2)
    assert hull.volume == approx(3 * area, rel=1e-12) and hull.symmetry == (True, True)
    assert hull.buoyancy_point == approx([0, 0, -1.5], abs=1e-12)
    assert hull.waterplane[0] == approx(area, rel=1e-12)
    assert hull.waterplane[3] == approx(np.pi / 4 * (10.0**4 - 3.0**4), rel=0.01)  # of polygons
    cone = ring(((4.0, -1.0), (2.0, 1.0), (2.0, -1.0)))  # its outer side a frustum's: π/3 (16 + 12 + 9) - 4π
    assert cone.volume == approx(np.pi * (37 / 3 - 4), rel=1e-12)


def test_either_way_round_is_the_same():
    one, other = ring(SECTION), ring(SECTION[::-1])
    assert one.volume == approx(other.volume, rel=1e-12) and not one.notes == other.notes == ()


def test_a_narrow_well_is_none():
    """A fortieth of the area is left out; its water goes along in surge, and bears nothing in heave."""
    omega, water = np.array([0.5, 0.8]), {"depth": inf, "density": 1000.0, "panels": 200}
    solid = Revolution.vertical_cylinder(radius=5.0, draft=3.0, freeboard=2.0)
    holed = ring(((5.0, -3.0), (5.0, 2.0), (0.8, 2.0), (0.8, -3.0)))
    a, b = (bem.solve((hull,), np.zeros((1, 3)), omega=omega, **water) for hull in (solid, holed))
    i = a.dofs.index("surge"), a.dofs.index("heave")
    inside = np.array([1000 * np.pi * 0.8**2 * 3.0, 0.0])
    # 5 % less in heave, on 2,048 panels of 64 sides, too.
    assert b.added_mass[:, i, i] == approx((a.added_mass[:, i, i] + inside) * (1, 0.95), rel=0.02)
    assert b.radiation_damping[:, i, i] == approx(a.radiation_damping[:, i, i], rel=0.06)


@pytest.mark.parametrize(
    ("hull", "quarters", "least"),
    [(ring(SECTION), 1, 0.9), (lopsided(3.5, 2.0, -1.0), 4, 0.9), (lopsided(7.0, -1.0, 0.5), 4, 0.85)],
)
def test_the_lid_covers_what_is_between_hull_and_well(hull, quarters, least):
    vertices, faces = meshes.lid(hull, 108, quarters=quarters)
    corners = vertices[faces]
    down = np.cross(corners[:, 2] - corners[:, 0], corners[:, 3] - corners[:, 1])[:, 2] / 2
    assert np.all(down < 0) and least < -4 / quarters * down.sum() / hull.waterplane[0] < 1
    shrunk = corners + 0.1 * (corners.mean(axis=1, keepdims=True) - corners)  # nothing reaches out
    points = np.concatenate([shrunk, (shrunk + np.roll(shrunk, 1, axis=1)) / 2]).reshape(-1, 3)[:, :2]
    assert meshes.inside(points, hull.waterline).all()


def test_no_irregular_frequency_is_left_between_hull_and_well(monkeypatch):
    """At 2.15 rad/s a wave stands across 8 m of a ring 3 m deep; water in the well does at 3 rad/s and above."""
    omega, hull = np.linspace(2.05, 2.25, 5), lopsided(2.0, 0.5, 0.0)
    run = partial(bem.solve, (hull,), np.array([[12.0, -7.0, 0.0]]), depth=inf, density=1000.0, panels=250)

    def heave(h):
        """Impedance over that of the displaced water's mass."""
        return (h.radiation_damping / h.omega[:, None, None] - 1j * h.added_mass)[:, 1, 1] / h.displaced_mass[0]

    def roughness(h):
        curve = heave(h).real
        return np.abs(curve - np.polynomial.Polynomial.fit(omega, curve, 2)(omega)).max()

    lidded, finer = run(omega=omega), run(omega=omega[2:3], panels=600)
    assert roughness(lidded) < 2e-4 and lidded.radiation_damping[:, range(2), range(2)].min() > 0
    assert np.abs(heave(lidded)[2] - heave(finer)[0]) < 0.05
    build = bem.Mesh.build
    monkeypatch.setattr(bem.Mesh, "build", lambda *args, lids, **_: build(*args, lids=()))
    assert roughness(run(omega=omega)) > 5 * roughness(lidded)


@pytest.mark.parametrize(
    "points, told",
    [
        (((3.0, -1.0), (3.0, 1.0), (0.0, 1.0)), r"points = \(0.0, 1.0\): must be off the axis"),
        (((3.0, -1.0), (3.0, 1.0), (2.0, 1.0), (3.0, -1.0)), "the outline closes by itself"),
        (((3.0, -1.0), (1.0, 0.5), (3.0, 1.0), (1.0, -2.0)), r"\(1.0, 0.5\)\): must not cross or touch another side"),
    ],
)
def test_outlines_that_cannot_be_are_refused(points, told):
    with pytest.raises(InputError, match=told):
        ring(points)


def test_an_outline_may_have_a_point_twice():
    outline = np.array([[[0, 0], [1, 0]], [[1, 0], [1, 0]], [[1, 0], [1, 1]], [[1, 1], [0, 0]]], float)
    feet, gaps = meshes.nearest(np.array([[0.5, -1.0], [1.2, 0.5], [2.0, -1.0]]), outline)
    assert feet == approx(np.array([[0.5, 0], [1, 0.5], [1, 0]])) and gaps == approx([1, 0.2, 2**0.5])
