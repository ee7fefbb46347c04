"""The march's load on panel meshes: closed forms, the quadrature of revolution, the paper's panels, invariances."""

import numpy as np
import pytest
from pytest import approx

from solver.errors import InputError
from solver.hydrodynamics.hull.panel_hull import PanelHull
from solver.hydrodynamics.hull.revolution import Revolution
from solver.hydrodynamics.hull.surface import split
from solver.hydrodynamics.pressure.froude_krylov import Incident
from solver.hydrodynamics.pressure.wetted_panels import longest_side, panels_pressure, panels_room, wetted_panels
from solver.reference.panels import Mesh, panel_load
from solver.sea.field import WaveField
from solver.sea.realization import realize
from solver.sea.spectrum import PiersonMoskowitz
from tests.hydrodynamics.shapes import box, loose, meshed
from tests.reference.test_panels import BUAN, CENTRE, RHO_G, STATES, by_quadrature, sea, turned, waves

BARGE = PanelHull.of(*box((3.0, 2.0, 2.0), (0, 0, 0.4)))  # 0.6 m of draft
STILL = np.zeros((2, 1))
T = 37.3


def field(t, *, heading=0.0, depth=50.0, centre=CENTRE):
    real, waves_ = sea(heading, depth)
    return np.ascontiguousarray((waves_.local_pressure(centre, 40) * np.exp(-1j * real.omega * t)).sum(axis=-1).real)


def load(hull, shift, rotation, c=STILL, *, side=1e9, half=False, wheeler=False, **sea_):
    centre, heading, depth = sea_.get("centre", CENTRE), sea_.get("heading", 0.0), sea_.get("depth", 50.0)
    rule = wetted_panels([None, hull], [0.0, side], [False, half])
    out, direction = np.zeros(6), np.array([np.cos(heading), np.sin(heading)])
    waves = Incident(*c, 99, centre, direction, RHO_G, wheeler, depth)
    panels_pressure(1, centre + np.array(shift), rotation, rule, waves, panels_room(rule), out)
    return out


@pytest.mark.parametrize("tilt", [0.0, 0.1, -0.3])
def test_tilted_box_has_the_righting_moment_of_its_wedges(tilt):
    """M = -ρg b sinθ [a³/12 (1 + tan²θ/2) - a d²/2] of a wall-sided box, turned about the waterline's centre."""
    a, b, d = 3.0, 2.0, 0.6
    moment = -RHO_G * b * np.sin(tilt) * (a**3 / 12 * (1 + np.tan(tilt) ** 2 / 2) - a * d**2 / 2)
    force = load(BARGE, np.zeros(3), turned((0, 1, 0), tilt))
    assert force == approx(np.array([0, 0, RHO_G * a * b * d, 0, moment, 0]), abs=1e-10 * RHO_G)


@pytest.mark.parametrize("axis, angle", [((1, 0, 0), 0.5), ((1, 2, 0.5), 0.7), ((0.3, -1, 2), 2.5)])
def test_submerged_body_floats_with_its_volume_whatever_its_attitude(axis, angle):
    R = turned(axis, angle)
    lever = R @ [0, 0, 0.4]
    expected = RHO_G * 12 * np.array([0, 0, 1, lever[1], -lever[0], 0])
    assert load(BARGE, (0, 0, -5), R) == approx(expected, abs=1e-9 * RHO_G)
    assert np.abs(load(BARGE, (0, 0, 5), R)).max() == 0


def test_cube_on_its_corner_is_cut_to_a_tetrahedron():
    R = turned(np.cross([1, 1, 1], [0, 0, 1]), np.arccos(1 / np.sqrt(3)))
    cube, h = PanelHull.of(*box((1.0, 1.0, 1.0))), 0.5
    force = load(cube, (0, 0, np.sqrt(3) / 2 - h), R)
    assert force == approx(np.array([0, 0, RHO_G * np.sqrt(3) / 2 * h**3, 0, 0, 0]), abs=1e-10 * RHO_G)


def test_wheeler_pressure_vanishes_at_the_surface():
    flat = np.array([[0.5], [0.0]])  # η = 0.5 m everywhere
    force = load(BARGE, (0, 0, 0.5), np.eye(3), flat, wheeler=True)
    assert force[2] == approx(RHO_G * 3 * 2 * 0.6, rel=1e-12)


@pytest.mark.parametrize("wheeler", [pytest.param(False, marks=pytest.mark.slow), True])
def test_second_order_towards_the_quadrature_of_revolution(wheeler):
    along, error = np.array([18, 36, 72]), np.zeros(3)
    hulls = [meshed(BUAN, int(n)) for n in along]
    for shift, angle, t in STATES:
        R = turned((0, 1, 0), angle)
        exact = by_quadrature(shift, R, t, wheeler=wheeler)
        for n, hull in enumerate(hulls):
            error[n] += np.sum((load(hull, shift, R, field(t), wheeler=wheeler) - exact)[[0, 2, 4]] ** 2)
    # Measured 2.01 over these states.
    assert np.polyfit(np.log(1 / along), np.log(np.sqrt(error)), 1)[0] == approx(2, abs=0.05)


@pytest.mark.parametrize("heading, depth", [(0.7, 50.0), (0.0, 8.0), (2.1, np.inf)])
def test_any_heading_and_depth(heading, depth):
    R, hull = turned((1, 2, 0), 0.2), meshed(BUAN, 60)
    got = load(hull, (0, 0, 0.1), R, field(T, heading=heading, depth=depth), heading=heading, depth=depth)
    exact = by_quadrature([0, 0, 0.1], R, T, heading=heading, depth=depth)
    assert np.abs(got - exact).max() < 5e-4 * exact[2]  # second order in a panel's 0.06 m


@pytest.mark.parametrize("wheeler", [False, True])
def test_agrees_with_the_papers_panels_on_the_same_box(wheeler):
    """130 components at the centroids of 0.1 m panels, without a series or middles of sides."""
    panels = split(BARGE.panels, 0.1)
    mesh, R, twin = Mesh(*loose(panels)), turned((1, 2, 0), 0.2), np.zeros(6)
    panel_load(CENTRE + np.array([0, 0, 0.1]), R, mesh, waves(T), RHO_G, wheeler, twin)
    got = load(BARGE, (0, 0, 0.1), R, field(T), side=0.25, wheeler=wheeler)
    assert np.abs(got - twin).max() < 1.5e-4 * twin[2]  # the centroids' second order: measured 8e-5


def test_default_side_against_a_fine_one():
    """Within 1e-3 of the load of the wave, over states and for a hull small and one large for its waves."""
    for size in ((3.0, 2.0, 2.0), (12.0, 6.0, 2.0)):
        hull = PanelHull.of(*box(size))
        side = longest_side(hull, 0.5, sea()[1])
        wave = error = 0
        for shift, angle, t in STATES:
            R, c = turned((0, 1, 0), angle), field(t)
            fine = load(hull, shift, R, c, side=0.2, half=True)
            wave += (fine - load(hull, shift, R, half=True)) ** 2
            error += (load(hull, shift, R, c, side=side, half=True) - fine) ** 2
        assert np.sqrt((error / np.where(wave > 0, wave, 1)).max()) < 1e-3


@pytest.mark.parametrize("wheeler", [False, True])
def test_half_the_hull_suffices_in_a_planar_scene(wheeler):
    c, R = field(T), turned((0, 1, 0), 0.2)
    whole, half = (load(BARGE, (0, 0, 0.1), R, c, side=0.3, half=h, wheeler=wheeler) for h in (False, True))
    # The two halves of the whole are cut into triangles that are no mirror images: their error, not rounding.
    assert half == approx(whole, abs=1e-5 * whole[2])


def test_hull_and_waves_turned_together():
    """About the vertical by any angle: the load turns with them, however the mesh is drawn."""
    Q, R = turned((0, 0, 1), 0.8), turned((1, 2, 0), 0.3)
    here = load(BARGE, (0, 0, 0.1), R, field(T, centre=np.zeros(3)), side=0.5, centre=np.zeros(3))
    c = field(T, heading=0.8, centre=np.zeros(3))
    there = load(BARGE, (0, 0, 0.1), Q @ R, c, side=0.5, centre=np.zeros(3), heading=0.8)
    assert there == approx(np.concatenate([Q @ here[:3], Q @ here[3:]]), abs=1e-9 * here[2])
    redrawn = PanelHull.of(BARGE.vertices @ Q.T, BARGE.faces)
    again = load(redrawn, (0, 0, 0.1), Q @ R @ Q.T, c, side=0.5, centre=np.zeros(3), heading=0.8)
    assert again == approx(there, abs=1e-9 * here[2])


def test_a_shift_with_the_waves_changes_nothing():
    """Moved by dx, with the series still about the old centre, or about the new one."""
    near = load(BARGE, (0.4, 0, 0), np.eye(3), field(T), side=0.3)
    moved = CENTRE + np.array([0.4, 0, 0])
    about = load(BARGE, (0, 0, 0), np.eye(3), field(T, centre=moved), side=0.3, centre=moved)
    assert about == approx(near, abs=1e-9 * near[2])


def test_slope_of_the_load_is_the_hydrostatic_stiffness():
    """Finite differences at rest against the waterplane's moments, for a hull without any symmetry."""
    hull = PanelHull.of(*box((3.0, 2.0, 2.0), (0.5, 0.3, 0.4)))
    S, Sx, Sy, Sxx, Sxy, Syy = hull.waterplane
    vx, vy, vz = hull.volume * hull.buoyancy_point
    stiffness = np.array([[S, Sy, -Sx, 0], [Sy, Syy + vz, -Sxy, -vx], [-Sx, -Sxy, Sxx + vz, -vy]])

    def at(axis, way):
        shift, R = (np.array([0, 0, way]), np.eye(3)) if axis is None else (np.zeros(3), turned(axis, way))
        return load(hull, shift, R)[2:5]

    restoring = [(at(axis, -1e-5) - at(axis, 1e-5)) / 2e-5 for axis in (None, (1, 0, 0), (0, 1, 0), (0, 0, 1))]
    assert np.abs(np.array(restoring).T / RHO_G - stiffness).max() < 1e-6


def test_waves_too_short_for_the_series_are_refused():
    real = realize(PiersonMoskowitz(Hs=1.28, Tp=5.46), components=130, band=(0.7, 6.0), seed=1)
    with pytest.raises(InputError, match="end the band lower"):
        WaveField(real, 50.0, 9.81).terms_for(40.0, 1e-5)


def test_a_hull_of_revolution_has_no_triangles():
    ball = meshed(Revolution.sphere(radius=1.0, draft=1.0), 8)
    rule = wetted_panels([None, ball, None], [0, 9, 0], [False, True, False])
    assert rule.first_triangle[1] == 0 and rule.first_triangle[2] == rule.first_triangle[3] == len(rule.corners)
