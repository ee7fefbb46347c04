"""Hulls of revolution against quadrature and closed forms; panels against the exact hull."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from solver.errors import InputError
from solver.hydrodynamics.bem.mesh import Mesh
from solver.hydrodynamics.hull.mesh import lid, mirror_planes, mirrored, panels, quarters
from solver.hydrodynamics.hull.revolution import Revolution, Segment
from tests.hydrodynamics.shapes import bowl

HULLS = {
    "float": Revolution.hemisphere_cylinder(radius=1.0, height=0.6),
    "sphere, shallow": Revolution.sphere(radius=3.0, draft=2.0),
    "sphere, deep": Revolution.sphere(radius=3.0, draft=4.5),
    "cylinder": Revolution.vertical_cylinder(radius=2.0, draft=1.0, freeboard=0.5),
    "spar with a plate": Revolution.profile(
        [(4.0, -10.0), (4.0, -9.0), (1.0, -9.0), (1.0, -3.0), (2.0, -2.0), (2.0, 1.0)]
    ),
}
size = st.floats(0.1, 20.0)


@pytest.fixture(params=HULLS.values(), ids=HULLS.keys())
def hull(request):
    return request.param


def corners(vertices, faces):
    a, b, c, d = np.moveaxis(vertices[faces], 1, 0)
    return a, b, c, d, np.cross(c - a, d - b) / 2  # area vectors


def test_float_displaces_a_hemisphere():
    hull = HULLS["float"]
    assert hull.volume == pytest.approx(2 / 3 * np.pi, rel=1e-14)
    assert hull.centre_of_buoyancy == pytest.approx(-3 / 8, rel=1e-14)
    assert hull.wetted_area == pytest.approx(2 * np.pi, rel=1e-14)
    assert hull.waterplane_radius == hull.draft == hull.largest_radius == 1.0


@given(radius=size, part=st.floats(0.05, 1.95))
def test_sphere_is_the_cap_formula(radius, part):
    draft = part * radius
    hull = Revolution.sphere(radius=radius, draft=draft)
    assert hull.volume == pytest.approx(np.pi * draft**2 * (3 * radius - draft) / 3, rel=1e-11)
    assert hull.wetted_area == pytest.approx(2 * np.pi * radius * draft, rel=1e-11)
    assert hull.waterplane_radius == pytest.approx(np.sqrt(draft * (2 * radius - draft)), rel=1e-9)


def test_a_profile_is_what_it_goes_through():
    hull = Revolution.profile([(2.0, -1.0), (2.0, 0.5)])
    assert hull == HULLS["cylinder"]
    cone = Revolution.profile([(0.0, -3.0), (2.0, 1.0)])  # 3 m deep, 1.5 m wide at still water
    assert cone.volume == pytest.approx(np.pi * 1.5**2 * 3 / 3, rel=1e-14)
    assert cone.centre_of_buoyancy == pytest.approx(-3 / 4, rel=1e-14)
    assert cone.waterplane_radius == pytest.approx(1.5)
    spar = HULLS["spar with a plate"]
    frustum = np.pi / 3 * (1 + 2 + 4)
    assert spar.volume == pytest.approx(np.pi * (16 + 6 + 4 * 2) + frustum, rel=1e-14)


@pytest.mark.parametrize("scale", [1e-3, 1.0, 1e3])
@pytest.mark.parametrize("rim", [[-2.2e-16], [-1e-9], [1e-9], [-1e-5], [-1e-9, 1e-9]])
def test_a_profiles_points_a_rounding_off_still_water_lie_on_it(rim, scale):
    """No panels without an area between them and still water."""

    def profile(*rim):
        return Revolution.profile(scale * np.array([(0.0, -3.0), (2.0, -2.0), *((3.0, z) for z in rim), (3.0, 2.0)]))

    assert profile(*rim) == profile(0.0)
    assert profile(-1e-3) != profile(0.0)  # draughts of a millimetre are those of the drawing


def test_volume_and_buoyancy_are_those_of_surface_quadrature(hull):
    # Divergence theorem: V = ∮ x n_x dS, and of z²/2: V z_b = ∮ z²/2 n_z dS. Rounding only.
    points, areas = hull.surface_points()
    assert np.sum(points[:, 0] * areas[:, 0]) == pytest.approx(hull.volume, rel=1e-12)
    moment = np.sum(points[:, 2] ** 2 / 2 * areas[:, 2])
    assert moment == pytest.approx(hull.volume * hull.centre_of_buoyancy, rel=1e-12)
    assert np.sum(np.linalg.norm(areas, axis=1)) == pytest.approx(hull.wetted_area, rel=1e-12)


def test_arcs_end_at_their_angles(hull):
    for arc in (s for s in hull.meridian if s.centre is not None):
        ends = [(arc.radius * np.sin(phi), arc.centre - arc.radius * np.cos(phi)) for phi in arc.angles]
        assert ends == [pytest.approx(arc.start, abs=1e-12), pytest.approx(arc.end, abs=1e-12)]


def test_mesh_has_the_exact_volume_and_waterplane_and_looks_outwards(hull):
    vertices, faces = panels(hull, 300)
    a, b, c, d, area = corners(vertices, faces)
    # Exact by construction when a panel is two triangles; rounding only.
    tetrahedra = sum(np.einsum("ij,ij->", x, np.cross(y, z)) / 6 for x, y, z in ((a, b, c), (a, c, d)))
    assert tetrahedra == pytest.approx(hull.volume, rel=1e-12)
    assert -area[:, 2].sum() == pytest.approx(np.pi * hull.waterplane_radius**2, rel=1e-12)
    assert np.all(vertices[:, 2] <= 0)
    top = corners(*lid(hull, 300))[4]
    assert top[:, 2].sum() == pytest.approx(area[:, 2].sum(), rel=1e-12)  # the lid closes the hull, seen from inside


def test_panels_are_well_shaped_also_at_the_pole(hull):
    vertices, faces = panels(hull, 432)
    loop = vertices[faces][:, [0, 1, 2, 3, 0]]
    edges = np.linalg.norm(np.diff(loop, axis=1), axis=2)
    assert 300 < len(faces) < 800
    # Clustered rows at edges are up to 5 times longer than wide; a polar lattice would give 20 and more.
    assert (edges.max(axis=1) / edges.min(axis=1)).max() < 6


@pytest.mark.parametrize("refine", [1, 2, 3])
def test_panels_go_by_a_bodys_size_and_not_by_how_many_points_it_is_drawn_through(refine):
    count = [len(panels(bowl(points), 48, refine=refine)[1]) for points in (7, 11, 21, 41, 90)]
    assert count == 5 * [48 * refine**2]
    vertices, _ = panels(bowl(41), 48, refine=refine)
    # On the line, but for what makes the volume exact.
    assert np.hypot(np.hypot(*vertices.T[:2]) / 3, vertices[:, 2] / 4) == pytest.approx(1, abs=0.06 / refine)


def test_quarters_and_mirrors_make_the_same_hull(hull):
    for share, images in ((1, ([1, 1, 1], [1, -1, 1], [-1, 1, 1], [-1, -1, 1])), (2, ([1, 1, 1], [1, -1, 1]))):
        pieces = [mirrored(panels(hull, 108, quarters=share), np.array(m)) for m in images]
        assert sum(corners(*p)[4][:, 2].sum() for p in pieces) == pytest.approx(-np.pi * hull.waterplane_radius**2)


def test_symmetry_planes_are_found():
    a, b = HULLS["float"], HULLS["cylinder"]
    assert len(mirror_planes((a,), np.array([[3.0, 2.0, 0.0]]))[1]) == 4
    assert len(mirror_planes((a, a), np.array([[-4.0, 0, 0], [4.0, 0, 0]]))[1]) == 4
    assert len(mirror_planes((a, b), np.array([[-4.0, 0, 0], [4.0, 0, 0]]))[1]) == 2
    assert len(mirror_planes((a, a), np.array([[-4.0, 0, 0], [4.0, 1, 0]]))[1]) == 1
    assert [quarters(np.array([x, 0.0, 0.0]), 4) for x in (-1.0, 0.0, 1.0)] == [0, 1, 2]


@pytest.mark.parametrize("scale", [0.01, 1.0, 100.0])
@pytest.mark.parametrize("off", [-4e-9, -1e-9, 1e-10, 2e-9, 1e-8, 1e-6])
def test_places_a_hair_off_a_plane_are_on_it_for_all_that_ask(scale, off):
    """A ring of bodies laid out with 3.141592654: no body is meshed twice, and none is left out."""
    hull = Revolution.vertical_cylinder(radius=2.0 * scale, draft=2.0 * scale, freeboard=scale)
    centres = scale * np.array([[10.0, 0.0, 0.0], [-10.0, off, 0.0]])
    mesh = Mesh.build((hull, hull), centres, ("heave",), (108, 108), 1, np.inf, lids=())
    areas = mesh.whole.faces_areas
    both = [areas[mesh.bodies == b].sum() for b in (0, 1)]
    one = Mesh.build((hull,), centres[:1], ("heave",), (108,), 1, np.inf, lids=()).whole.faces_areas.sum()
    assert both == pytest.approx([one, one], rel=1e-9)


@pytest.mark.parametrize(
    ("make", "key"),
    [
        (lambda: Revolution.sphere(radius=-1.0, draft=1.0), "hull.radius"),
        (lambda: Revolution.sphere(radius=1.0, draft=2.0), "hull.draft"),
        (lambda: Revolution.vertical_cylinder(radius=1.0, draft=1.0, freeboard=0.0), "hull.freeboard"),
        (lambda: Revolution(meridian=(Segment(start=(0.0, -1.0), end=(1.0, 1.0)),)), "hull.meridian"),
        (lambda: Revolution(meridian=(Segment(start=(0.0, 1.0), end=(0.0, 2.0)),)), "hull.meridian"),
        (lambda: Revolution.profile([]), "hull.points"),
        (lambda: Revolution.profile([(1.0, 1.0), (1.0, 2.0)]), "hull.points"),
        (lambda: Revolution.profile([(-1.0, -1.0), (1.0, 2.0)]), "hull.points"),
        (lambda: Revolution.profile([(1.0, -1.0), (0.0, -0.5), (1.0, 1.0)]), "hull.points"),
        (lambda: Revolution.profile([(1.0, -1.0), (1.0, -1.0), (1.0, 1.0)]), "hull.points"),
        (lambda: Revolution.profile([(1.0, -1.0), (1.0 + 1e-15, -1.0), (1.0, 1.0)]), "hull.points"),
        (lambda: Revolution.profile([(2.0, -1e-9), (2.0, 1.0)]), "hull.points"),
        (lambda: Revolution.profile([(1.0, -1.0), (2.0, 1.0), (1.0, -0.5), (0.5, 2.0)]), "hull.points"),
        (lambda: Revolution.profile([(1.0, -1.0), (1.0, 1.0), (2.0, -0.5), (3.0, 2.0)]), "hull.points"),
        (lambda: Revolution.profile([(1.0, -3.0), (1.0, -2.0), (3.0, -2.5), (0.5, -2.5), (2.0, 1.0)]), "hull.points"),
        (lambda: panels(HULLS["float"], 4), "panels"),
    ],
)
def test_bad_shapes_name_key_value_and_limit(make, key):
    with pytest.raises(InputError, match="must") as error:
        make()
    assert error.value.key == key
