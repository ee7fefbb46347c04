"""Panel-wise pressure loads against closed forms and against the wetted-surface quadrature."""

import itertools

import numpy as np
import pytest
from numba import typeof
from pytest import approx

from solver.errors import InputError
from solver.hydrodynamics.hull.revolution import Revolution
from solver.hydrodynamics.pressure.froude_krylov import Incident, pressure_load
from solver.hydrodynamics.pressure.quadrature import quadrature, quadrature_room
from solver.reference.panels import Mesh, _elevation, _head, calm, half, panel_load, revolution_mesh, volume, waves_at
from solver.sea.field import WaveField
from solver.sea.realization import realize
from solver.sea.spectrum import PiersonMoskowitz

BUAN = Revolution.hemisphere_cylinder(radius=1.0, height=0.6)
RHO_G = 1025 * 9.81
CENTRE = np.array([-3.86, 0.0, 0.0])
CALM = calm(depth=50.0)
DEPTH = 50.0


def turned(axis, angle):
    x, y, z = np.asarray(axis, float) / np.linalg.norm(axis)
    K = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    return np.eye(3) + np.sin(angle) * K + (1 - np.cos(angle)) * K @ K


def box(size, *, shift=(0, 0, 0)):
    """A closed box of edge lengths `size` about `shift`, six panels, normals outwards."""
    corner = np.array(list(itertools.product((-0.5, 0.5), repeat=3))) * size + shift
    faces = [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]]
    return Mesh(corner, np.array(faces))


def load(mesh, position, rotation, waves=CALM, *, wheeler=False):
    out = np.zeros(6)
    panel_load(np.asarray(position, float), rotation, mesh, waves, RHO_G, wheeler, out)
    return out


def sea(heading=0.0, depth=DEPTH):
    real = realize(PiersonMoskowitz(Hs=1.28, Tp=5.46), components=130, band=(0.7, 3.4), seed=1, heading=heading)
    return real, WaveField(real, depth, 9.81)


def test_still_water_and_waves_are_of_one_type():
    """Or the load on panels is compiled for each; fields keep their wavenumbers from being written to."""
    k = np.array([0.1])
    k.setflags(write=False)
    there = waves_at(k, [1.0], [1.0 + 0j], depth=DEPTH, heading=0.0, t=0.0)
    assert list(map(typeof, there)) == list(map(typeof, calm()))


def by_quadrature(shift, rotation, t, *, heading=0.0, depth=DEPTH, wheeler=False):
    """The same load from the local field and the quadrature, both far finer than any mesh here."""
    real, field = sea(heading, depth)
    rows = field.local_pressure(CENTRE, 30)
    c = np.ascontiguousarray((rows * np.exp(-1j * real.omega * t)).sum(axis=-1).real)
    rule = quadrature(BUAN, azimuths=256, arc_points=30, line_points=30, half=False, mean_length=np.inf)
    out, direction = np.zeros(6), field.direction[:2].copy()
    waves = Incident(*c, 99, CENTRE, direction, RHO_G, wheeler, depth)
    pressure_load(CENTRE + shift, rotation, rule, waves, quadrature_room(rule), out)
    return out


def waves(t, *, heading=0.0, depth=DEPTH):
    real, field = sea(heading, depth)
    return waves_at(field.k, real.omega, real.amplitude, depth=depth, heading=heading, t=t)


def test_buan_float_has_the_papers_panels_over_the_whole_hull():
    mesh = revolution_mesh(BUAN, along=71, around=120)
    assert len(mesh.faces) == 8520
    assert volume(mesh) == approx(np.pi * (2 / 3 + 0.6), rel=1e-12)
    assert load(mesh, np.zeros(3), np.eye(3))[2] == approx(RHO_G * np.pi * 2 / 3, rel=1e-12)


def test_sphere_without_a_ring_at_the_waterline_has_its_volumes_too():
    sphere = Revolution.sphere(radius=5.0, draft=4.3)
    mesh = revolution_mesh(sphere, along=31, around=40)
    assert volume(mesh) == approx(4 / 3 * np.pi * 125, rel=1e-9)
    assert load(mesh, np.zeros(3), np.eye(3))[2] == approx(RHO_G * sphere.volume, rel=1e-7)


@pytest.mark.parametrize("tilt", [0.0, 0.3, 1.1])
def test_submerged_body_floats_with_its_volume(tilt):
    """Archimedes, exact on any closed polyhedron: force ρgV at the volume's centroid."""
    mesh, R = box((1.0, 2.0, 0.5), shift=(0.1, 0, 0.2)), turned((1, 2, 0.5), tilt)
    force = load(mesh, (3, 1, -5), R)
    lever = R @ [0.1, 0, 0.2]
    assert force == approx(RHO_G * np.array([0, 0, 1, lever[1], -lever[0], 0]), abs=1e-9 * RHO_G)


@pytest.mark.parametrize("tilt", [0.0, 0.1, 0.4])
def test_tilted_box_has_the_righting_moment_of_its_wedges(tilt):
    """Box a wide, 1 long, half under water, turned by θ about y: V = a d, righting lever in closed form.

    With draft d on the axis: moment about the waterline centre Mᵧ = -ρg sinθ [a³/12 (1 + tan²θ/2) - a d²/2].
    """
    a, d = 2.0, 0.6
    mesh = box((a, 1.0, 2.0), shift=(0, 0, 1.0 - d))
    force = load(mesh, np.zeros(3), turned((0, 1, 0), tilt))
    # Turned about the waterline's centre, the displaced area stays a·d (walls cut, no corner).
    moment = -RHO_G * np.sin(tilt) * (a**3 / 12 * (1 + np.tan(tilt) ** 2 / 2) - a * d**2 / 2)
    assert force == approx(np.array([0, 0, RHO_G * a * d, 0, moment, 0]), abs=1e-10 * RHO_G)


def test_cube_on_its_corner_is_cut_to_a_tetrahedron():
    """The lowest corner of a cube, diagonal upright, h under water: V = (√3/2) h³, and no moment."""
    R = turned(np.cross([1, 1, 1], [0, 0, 1]), np.arccos(1 / np.sqrt(3)))
    h = 0.5  # below 2/3·... of the first neighbouring corner, 1/√3
    force = load(box((1.0, 1.0, 1.0)), (0, 0, np.sqrt(3) / 2 - h), R)
    assert force == approx(np.array([0, 0, RHO_G * np.sqrt(3) / 2 * h**3, 0, 0, 0]), abs=1e-10 * RHO_G)


def test_triangles_and_quadrilaterals_agree():
    quads = box((1.0, 1.0, 1.0))
    f = quads.faces
    halves = np.concatenate([f[:, [0, 1, 2, 2]], f[:, [0, 2, 3, 3]]])
    triangles = Mesh(quads.vertices, np.ascontiguousarray(halves))  # as all others are: not to compile for these alone
    R = turned((1, 0.4, 0.2), 0.7)
    assert load(triangles, (0, 0, 0.1), R) == approx(load(quads, (0, 0, 0.1), R), abs=1e-10 * RHO_G)


STATES = [((0, 0, 0), 0.0, 37.3), ((0.1, 0, 0.2), 0.3, 41.0), ((-0.1, 0, -0.3), -0.2, 52.7), ((0, 0.1, 0.1), 0.1, 60.1)]


@pytest.mark.parametrize("wheeler", [False, True])
def test_second_order_in_the_panel_size_towards_the_quadrature(wheeler):
    along = np.array([18, 36, 72])
    error = np.zeros(3)
    for shift, angle, t in STATES:
        exact = by_quadrature(shift, turned((0, 1, 0), angle), t, wheeler=wheeler)
        for n, count in enumerate(along):
            mesh = revolution_mesh(BUAN, along=count, around=2 * count)
            got = load(mesh, CENTRE + shift, turned((0, 1, 0), angle), waves(t), wheeler=wheeler)
            error[n] += np.sum((got - exact)[[0, 2, 4]] ** 2)
    # The waterline crosses panels anywhere, so single states scatter a little about order 2.
    assert np.polyfit(np.log(1 / along), np.log(np.sqrt(error)), 1)[0] == approx(2, abs=0.1)


@pytest.mark.parametrize("heading, depth", [(0.7, 50.0), (0.0, 8.0), (2.1, np.inf)])
def test_any_heading_and_depth(heading, depth):
    mesh, R = revolution_mesh(BUAN, along=71, around=120), turned((1, 2, 0), 0.2)
    got = load(mesh, CENTRE + np.array([0, 0, 0.1]), R, waves(37.3, heading=heading, depth=depth))
    exact = by_quadrature([0, 0, 0.1], R, 37.3, heading=heading, depth=depth)
    assert np.abs(got - exact).max() < 2e-4 * exact[2]  # polygons in place of curves, second order in a panel's 0.05 m


@pytest.mark.parametrize("depth", [3.0, 50.0, np.inf])
def test_sums_of_components_are_the_librarys(depth):
    """Of 130 waves, down to the bottom and above the surface: 1e-14 of the sum of amplitudes times e^(kz)."""
    rng = np.random.default_rng(2)
    k, omega, a = np.sort(rng.uniform(0.05, 2.0, 130)), rng.uniform(1, 3, 130), rng.normal(size=(130, 2)) @ [1, 1j]
    at = waves_at(k, omega, a, depth=depth, heading=0.4, t=7.3, factor=0.8)
    turned, fade = 0.8 * a * np.exp(-7.3j * omega), np.exp(-2 * k * depth)
    for s, z in zip(rng.uniform(-60, 60, 200), rng.uniform(-min(depth, 60), 2, 200), strict=True):
        rise = (np.exp(k * z) + fade * np.exp(-k * z)) / (1 + fade)
        assert _elevation(at, s) == approx((turned * np.exp(1j * k * s)).sum().real, abs=1e-13 * np.abs(a).sum())
        assert _head(at, s, z) == approx(
            (turned * rise * np.exp(1j * k * s)).sum().real, abs=1e-13 * 50 * np.abs(a).sum()
        )


def test_half_a_hull_bears_half_the_load():
    mesh, (real, field) = revolution_mesh(BUAN, along=12, around=20), sea()
    waves = waves_at(field.k, real.omega, real.amplitude, depth=DEPTH, heading=0.0, t=3.0)
    R, at = turned((0, 1, 0), 0.3), np.add(CENTRE, (0.2, 0, 0.1))
    whole, part = load(mesh, at, R, waves), load(half(mesh), at, R, waves)
    size = np.abs(whole).max()  # loads that cancel leave its rounding
    assert 2 * part[[0, 2, 4]] == approx(whole[[0, 2, 4]], abs=1e-11 * size)
    assert whole[[1, 3, 5]] == approx(0, abs=1e-11 * size)
    assert half(revolution_mesh(BUAN, along=12, around=21)) is None


def test_open_and_inside_out_meshes_are_refused():
    cube = box((1.0, 1.0, 1.0))
    with pytest.raises(InputError, match="closed"):
        volume(Mesh(cube.vertices, cube.faces[:5]))
    with pytest.raises(InputError, match="volume -1"):
        volume(Mesh(cube.vertices, cube.faces[:, ::-1]))
