"""Coefficients of hulls that are meshes, against those of hulls of revolution and against published numbers."""

from dataclasses import replace
from functools import partial

import numpy as np
import pytest
from pytest import approx

from solver.errors import InputError
from solver.hydrodynamics.bem import bem, extrapolation
from solver.hydrodynamics.bem import mesh as bem_mesh
from solver.hydrodynamics.bem import problem as bem_problem
from solver.hydrodynamics.bem.green import green_function, joined
from solver.hydrodynamics.hull import mesh as meshes
from solver.hydrodynamics.hull import surface
from solver.hydrodynamics.hull.duck import duck
from solver.hydrodynamics.hull.edges import order
from solver.hydrodynamics.hull.panel_hull import PanelHull
from solver.hydrodynamics.hull.revolution import Revolution
from solver.hydrodynamics.library import capytaine
from solver.run import simulate
from solver.scene import Float, Scene, Settings, Water
from solver.sea.realization import regular
from tests.hydrodynamics.shapes import box, fine_box, graded_box, loose, meshed

SPHERE = Revolution.sphere(radius=1.0, draft=1.0)
CYLINDER = Revolution.vertical_cylinder(radius=1.0, draft=0.5, freeboard=0.5)
BARGE = fine_box((4.0, 2.0, 1.0), (0.5, 0.3, 0.0), 0.5)
G, RHO = 9.81, 1000.0
OMEGA = np.sqrt(G * np.array([0.3, 1.0, 2.0]))
solve = partial(bem.solve, density=RHO, gravity=G, omega=OMEGA, depth=np.inf)
NAMES = ("added_mass", "radiation_damping", "diffraction", "froude_krylov", "added_mass_inf")


def share(a, b):
    """Largest difference over all coefficients of one kind, of the kind's largest."""
    return max(np.abs(getattr(a, n) - getattr(b, n)).max() / np.abs(getattr(b, n)).max() for n in NAMES)


def test_meshed_sphere_approaches_the_sphere_at_second_order():
    exact = solve((SPHERE,), [[0, 0, 0]], omega=OMEGA[:2])
    along = np.array([10, 20])
    error = [share(solve((meshed(SPHERE, n),), [[0, 0, 0]], omega=OMEGA[:2]), exact) for n in along]
    # The sphere's error, 1.5e-3, and the collocation's bend the line between two meshes.
    assert np.log(error[0] / error[1]) / np.log(2) == approx(2, abs=0.2)
    assert error[1] < 0.01


@pytest.mark.slow
def test_meshed_cylinder_in_finite_depth():
    exact = solve((CYLINDER,), [[0, 0, 0]], depth=10.0, omega=OMEGA[:2])
    ours = solve((meshed(CYLINDER, 16),), [[0, 0, 0]], depth=10.0, omega=OMEGA[:2])
    assert share(ours, exact) < 5e-3  # measured 7e-3, 3e-3, 1e-3 with 12, 16, 24 panels along the meridian
    assert ours.hydrostatic_stiffness == approx(exact.hydrostatic_stiffness, rel=5e-3, abs=1e-9 * RHO * G)


def test_the_lid_removes_irregular_frequencies(monkeypatch):
    # Interior eigenmodes of the hemisphere: Ka = 2.56 in heave, 4 in surge.
    omega = np.sqrt(G * np.array([2.45, 2.5, 2.55, 2.6, 2.65, 3.9, 4.0, 4.1]))
    run = partial(solve, (meshed(SPHERE, 12),), [[0, 0, 0]], omega=omega)

    def roughness(h):
        curves = np.stack([h.radiation_damping[:, i, i] / h.omega / h.displaced_mass[0] for i in (0, 1)])
        return np.abs(curves - [np.polynomial.Polynomial.fit(omega, c, 2)(omega) for c in curves]).max()

    with_lid = roughness(run())
    build = bem.Mesh.build
    monkeypatch.setattr(bem.Mesh, "build", lambda *args, lids, **_: build(*args, lids=()))
    assert with_lid < 2e-3  # as for hulls of revolution
    assert roughness(run()) > 5 * with_lid


def test_no_irregular_frequency_is_left_in_a_duck_on_either_mesh():
    """Where it thins out at the waterline; a lid four times as coarse made seven times the damping at 4.35 rad/s."""
    omega = np.array([4.2, 4.35, 4.5])
    hull = duck(radius=2.0, beak=4.5, elevation=0.4, submergence=0.8, width=6.0)
    for of_mesh in bem.part(bem.Problem.of((hull,), np.zeros((1, 3)), depth=np.inf, omega=omega))[0]:
        damping = of_mesh.impedance[:, 1, 1].imag
        assert damping.min() > 0 and np.abs(np.diff(damping, 2)).max() < 0.05 * damping.max()


@pytest.mark.parametrize("images", [1, 2])
def test_symmetry_planes_change_nothing(monkeypatch, images):
    hull = PanelHull.of(*box((3.0, 2.0, 1.0)))
    run = partial(solve, (hull,), [[0.4, -2, 0]], omega=OMEGA[1:2], planar=False, heading=0.5)
    both, planes = run(), meshes.mirror_planes
    assert len(planes((hull,), np.array([[0.4, -2, 0]]))[1]) == 4
    monkeypatch.setattr(meshes, "mirror_planes", lambda *args: (planes(*args)[0], planes(*args)[1][:images]))
    assert share(run(), both) < 1e-7  # the same panels in another order: rounding only


def test_a_turned_mesh_meets_turned_waves():
    """The hull and the waves turned by 40 degrees: forces and motions turn with them."""
    c, s = np.cos(0.7), np.sin(0.7)
    R = np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]])
    turned = PanelHull.of(BARGE.vertices @ R.T, BARGE.faces)
    run = partial(solve, omega=OMEGA[1:2], planar=False, panels=108)
    a, b = run((BARGE,), [[0, 0, 0]], heading=0.2), run((turned,), [[0, 0, 0]], heading=0.9)
    T = np.kron(np.eye(2), R)
    for name in ("diffraction", "froude_krylov"):
        x, y = getattr(a, name) @ T.T, getattr(b, name)
        # The lattice of the lid stays along x and y, which the hull does not: measured 1.3e-3; panels leave 4e-2.
        assert np.abs(x - y).max() < 2e-3 * np.abs(y).max()
    for name in ("added_mass", "hydrostatic_stiffness"):
        x, y = T @ getattr(a, name) @ T.T, getattr(b, name)
        assert np.abs(x - y).max() < 2e-3 * np.abs(y).max()


def test_barge_hydrostatics_in_closed_form():
    h = solve((BARGE,), [[0, 0, 0]], omega=OMEGA[:1], planar=False)
    V, S, xs, ys, zb = 4.0, 8.0, 0.5, 0.3, -0.25
    roll, pitch = 4 * 8 / 12 + S * ys**2 + V * zb, 2 * 64 / 12 + S * xs**2 + V * zb
    K = np.zeros((6, 6))
    K[2:5, 2:] = [
        [S, S * ys, -S * xs, 0],
        [S * ys, roll, -S * xs * ys, -V * xs],
        [-S * xs, -S * xs * ys, pitch, -V * ys],
    ]
    assert h.hydrostatic_stiffness == approx(RHO * G * K, abs=1e-9 * RHO * G)
    # In long waves the Froude-Krylov force is the slope and height of still water on that stiffness.
    slow = solve((BARGE,), [[0, 0, 0]], omega=np.array([0.05]), planar=False)
    assert slow.froude_krylov[0, 2].real == approx(RHO * G * S, rel=1e-3)


def test_mixed_scenes_and_far_apart_bodies():
    run = partial(solve, planar=False, panels=108, omega=OMEGA[1:2])
    far = run((SPHERE, BARGE), [[-200, 0, 0], [200, 0, 0]])
    for i, hull in enumerate((SPHERE, BARGE)):
        block, alone = slice(6 * i, 6 * i + 6), run((hull,), [[0, 0, 0]])
        # A scattered wave falls as 1/sqrt(kL), there and back: measured 8e-4.
        assert np.abs(far.added_mass[:, block, block] - alone.added_mass).max() < 2e-3 * np.abs(alone.added_mass).max()


def test_a_pair_of_equal_barges_is_its_own_mirror_image():
    hull = PanelHull.of(*box((2.0, 2.0, 1.0)))
    _, mirrors = meshes.mirror_planes((hull, hull), np.array([[-3.0, 0, 0], [3, 0, 0]]))
    assert len(mirrors) == 4
    h = solve((hull, PanelHull.of(*box((2.0, 2.0, 1.0)))), [[-3, 0, 0], [3, 0, 0]], panels=108)
    sign = np.array([-1, 1, -1])
    swapped = h.radiation_damping[:, [3, 4, 5]][:, :, [3, 4, 5]] * np.multiply.outer(sign, sign)
    assert swapped == approx(h.radiation_damping[:, :3, :3], rel=1e-9, abs=1e-9 * np.abs(swapped).max())


@pytest.mark.slow
def test_a_large_mesh_is_solved_as_given(monkeypatch):
    monkeypatch.setattr(bem_problem, "AFFORDABLE", 1e3)
    h = solve((BARGE,), [[0, 0, 0]], omega=OMEGA[:1])
    assert h.settings["panels"] == h.settings["panels_coarse"] >= len(BARGE.wetted)
    monkeypatch.undo()
    finest = solve((BARGE,), [[0, 0, 0]], omega=OMEGA[:1], panels=1700)
    # Told from the count of panels alone, the error is of the right size: measured 0.5 to 1.2 of it.
    assert 0.3 < share(h, finest) / h.mesh_error < 1.5


def test_one_mesh_tells_the_error_of_each_body_by_its_own_panels():
    """It falls as h² of panels narrower at edges and of smooth hulls, as edges let it of even ones, as h of plates."""
    few, many = (fine_box((4.0, 2.0, 1.0), (0, 0, 0), side) for side in (0.26, 0.13))
    count = [len(hull.wetted) for hull in (few, many)]
    assert count[1] == 4 * count[0]

    def told(*hulls, narrow, asked=108):
        return extrapolation.of_one_mesh(hulls, (asked,) * len(hulls), narrow=narrow)

    even, finer = (told(hull, narrow=False) for hull in (few, many))
    assert even == pytest.approx(0.6 / count[0] ** 0.5, rel=0.03)  # whose true error is 0.62 / √n
    assert np.log2(even / finer) == pytest.approx(order(np.pi / 2))
    assert told(few, narrow=True) == pytest.approx(0.045 * 180 / meshes.halved_count(few, 108))
    assert told(few, many, many, few, narrow=False) == even
    ball = Revolution.sphere(radius=1.0, draft=1.0)
    assert told(ball, narrow=True) == pytest.approx(0.045 * 180 / meshes.halved_count(ball, 108))
    plate = fine_box((4.0, 4.0, 0.1), (0, 0, -2.0), 0.4)
    assert told(plate, narrow=True) == pytest.approx(0.045 * (180 / meshes.halved_count(plate, 108)) ** 0.5)


def test_long_hulls_side_by_side_do_not_touch():
    hull = PanelHull.of(*box((1.0, 6.0, 1.0)))
    solve((hull, hull), [[-1, 0, 0], [1, 0, 0]], omega=OMEGA[:1], panels=108)
    with pytest.raises(InputError, match="overlap"):
        solve((hull, hull), [[-0.4, 0, 0], [0.4, 0, 0]], omega=OMEGA[:1])
    with pytest.raises(InputError, match="draft"):
        solve((hull,), [[0, 0, 0]], depth=0.4)


def test_triangles_and_quadrilaterals_agree():
    corners = surface.triangles(BARGE.panels)
    triangles = PanelHull.of(*loose(np.concatenate([corners, corners[:, 2:]], axis=1)))
    a, b = (solve((hull,), [[0, 0, 0]], omega=OMEGA[1:2], panels=108) for hull in (triangles, BARGE))
    assert share(a, b) < a.mesh_error + b.mesh_error < 0.07  # measured 0.012 and 0.058


def test_a_model_has_the_mesh_error_of_what_it_is_a_model_of():
    """Forces and moments, of other units, count alike at any scale."""
    scale = 1 / 20
    model = PanelHull.of(scale * BARGE.vertices, BARGE.faces)
    waves = {"depth": 30.0, "omega": OMEGA[:2]}, {"depth": 30.0 * scale, "omega": OMEGA[:2] / scale**0.5}
    errors = [
        solve((hull,), [[0, 0, 0]], panels=108, **w).mesh_error for hull, w in zip((BARGE, model), waves, strict=True)
    ]
    assert errors[1] == pytest.approx(errors[0], rel=5e-3)


@pytest.mark.slow
def test_the_error_that_edges_leave_is_what_it_is_said_to_be(monkeypatch):
    """Beside seven times as many panels, narrow at all edges. Of roll two errors cancel from one mesh to the next."""
    monkeypatch.setattr(bem_problem, "AFFORDABLE", 1e9)
    graded = graded_box((4.0, 2.0, 1.0), 0.16)
    run = partial(solve, centres=[[0, 0, 0]], omega=OMEGA[1:2], planar=False, heading=0.5)
    exact, h = run((graded,), panels=len(graded.wetted)), run((PanelHull.of(*box((4.0, 2.0, 1.0))),), panels=432)
    for name, at in (
        ("added_mass", np.s_[0, [0, 1, 4, 5], [0, 1, 4, 5]]),
        ("radiation_damping", np.s_[0, [0, 1, 2], [0, 1, 2]]),
        ("diffraction", np.s_[0, [0, 1]]),
    ):
        true, told = np.abs(getattr(h, name) - getattr(exact, name))[at], np.abs(getattr(h.error, name))[at]
        assert np.all((true > told / 3) & (true < 3 * told))
        assert np.all(true < 0.012 * np.abs(getattr(exact, name)[at]))


def test_panels_are_as_capytaine_finds_them_one_by_one():
    """Of four corners that are not in one plane, and of three."""
    corners = surface.triangles(BARGE.wetted)
    pieces = [meshes.panels(SPHERE, 108), meshes.indexed(corners[:, [0, 1, 2, 2]])]
    ours = joined(pieces)
    vertices, faces = surface.merged(pieces)
    theirs = capytaine().Mesh(vertices=vertices, faces=faces, auto_clean=False, auto_check=False)
    for name in ("nb_faces", "faces_areas", "faces_centers", "faces_normals", "faces_radiuses"):
        assert getattr(ours, name) == approx(getattr(theirs, name), abs=1e-13)
    for mine, other in zip(ours.quadrature_points, theirs.quadrature_points, strict=True):
        assert mine == approx(other, abs=1e-13)


class Broken:
    """The Green function, not finite where panel `of` acts on the middle of panel `at`."""

    def __init__(self, at, of, part):
        self.at, self.of, self.part, self.sound = at, of, part, green_function()

    def evaluate(self, *args, **kwargs):
        both = self.sound.evaluate(*args, **kwargs)
        both[self.part][self.at, self.of] = np.nan
        return both


def test_panels_whose_influence_is_not_finite_are_named(monkeypatch):
    """But on the edge of a panel, in its plane, dipoles do nothing. Of two bodies, the second's panel."""
    hulls, centres = (BARGE, SPHERE), np.array([[-3.0, 0, 0], [3, 1, 0]])
    mesh = bem.Mesh.build(hulls, centres, bem.DOFS, (108, 108), 1, np.inf, lids=())
    bottom, ball = np.flatnonzero(np.isclose(mesh.part.faces_normals[:, 2], -1.0))[:2], mesh.part.nb_faces - 1
    exact = mesh.forces(mesh.solve(mesh.motions, 1.0, np.inf), 12)
    for at, of, part in ((0, ball, 1), (bottom[0], ball, 0)):
        monkeypatch.setattr(bem_mesh, "green_function", lambda here=(at, of, part): Broken(*here))
        with pytest.raises(
            InputError, match="hulls = body 2, of revolution: boundary elements fail on 1 panels"
        ) as error:
            mesh.solve(mesh.motions, 1.0, np.inf)
        assert surface.point_text(mesh.part.faces_centers[of] + mesh.origin) in str(error.value)
    monkeypatch.setattr(bem_mesh, "green_function", lambda: Broken(*bottom, 0))
    with pytest.raises(InputError, match="body 1, mesh"):
        mesh.solve(mesh.motions, 1.0, np.inf)
    monkeypatch.setattr(bem_mesh, "green_function", lambda: Broken(*bottom, 1))
    lost = mesh.forces(mesh.solve(mesh.motions, 1.0, np.inf), 12)
    assert lost == approx(exact, abs=5e-3 * np.abs(exact).max())  # what waves of the one panel do at the other


def test_added_mass_below_zero_is_refused(monkeypatch):
    """Of one motion, and of two whose own is above zero; in yaw a round body has less than none by mesh error."""
    limits = bem.extrapolated

    def changed(entries):
        def infinite(*args):
            best, left = limits(*args)
            for (i, j), value in entries.items():
                best[1][i, j] = best[1][j, i] = value * np.sqrt(best[1][i, i] * best[1][j, j])
            return best, left

        monkeypatch.setattr(bem, "extrapolated", infinite)
        solve((BARGE, SPHERE), [[-3, 0, 0], [3, 0, 0]], omega=OMEGA[:1], planar=False, panels=108)

    with pytest.raises(InputError, match=r"hulls = body 2, of revolution: .* not positive, above all in heave \(-"):
        changed({(8, 8): -0.3})
    with pytest.raises(InputError, match=r"hulls = body 1, mesh: .* not positive, above all in (sway|roll)"):
        changed({(1, 3): 1.3})
    changed({(11, 11): -1.0})
    changed({(3, 3): 0.02, (1, 3): 1.2})  # as of a ball that turns about an axis near its centre


@pytest.mark.slow
def test_what_panels_do_to_a_hemisphere_s_power_is_told():
    """Limits of three meshes agree at some frequencies, and errors of force and added mass cancel at others."""
    k = np.array([0.4, 0.5, 0.8, 1.2, 1.6])
    usual, fine = (solve((SPHERE,), np.zeros((1, 3)), panels=panels, omega=np.sqrt(G * k)) for panels in (432, 2700))
    item = Float(
        name="sphere", hull=SPHERE, mass=RHO * SPHERE.volume, inertia=(9e2,) * 3, hinge=(0, 0, 0),
        motion=("heave",), pto_damping=2e3,
    )  # fmt: skip
    true, told = [], []
    for omega in np.sqrt(G * k):
        settings = Settings(duration=600.0, discard=100.0, method="frequency", froude_krylov="linear")
        sea = regular(height=0.01, period=2 * np.pi / omega)
        scene = Scene(water=Water(depth=np.inf, density=RHO, gravity=G), sea=sea, floats=(item,), settings=settings)
        ours, exact = (simulate(scene, h) for h in (usual, fine))
        power, best = (r.variables["absorbed_power"][1][0, 2] for r in (ours, exact))
        true.append(abs(power / best - 1))
        told.append(ours.attrs["mesh_effect"])
    ratio = np.divide(true, told)
    assert np.max(ratio) < 4 and np.max(true) > 5e-4 and 1 / 3 < np.max(true) / np.max(told) < 3, (true, told)


def test_errors_told_are_the_same_wherever_a_float_is():
    """Along the waves and across: what three meshes leave had the phase of the waves' arrival, and power with it."""
    here, *moved = (
        solve((CYLINDER,), np.array([[x, y, 0.0]]), panels=108) for x, y in ((0.0, 0.0), (1.0, 0.0), (0.0, 1.0))
    )
    for h in moved:
        waves = here.error.diffraction * h.arrival(OMEGA)
        for told, known in zip(h.error, here.error._replace(diffraction=waves), strict=True):
            assert told == approx(known, rel=1e-6, abs=1e-9 * np.abs(known).max())


def test_long_waves_push_a_body_as_if_it_moved_against_their_water():
    """One mesh's errors of forces and of radiation are one by G. I. Taylor's relation, wherever the body is."""
    hull, omega = PanelHull.of(*box((6.0, 4.0, 3.0))), np.linspace(0.25, 0.5, 4)
    h = bem.solve(
        (hull,), np.array([[30.0, -20.0, 0.0]]), depth=40.0, heading=0.7, omega=omega, planar=False, panels=108
    )
    known, apart = (np.abs(error[:, :3]) for error in (h.error.diffraction, h.forced.diffraction - h.diffraction))
    assert np.all(apart < 0.1 * known)
    alone = replace(h, error=None)
    assert alone.forced is alone


ROUND = {
    "disc": Revolution.vertical_cylinder(radius=3.0, draft=2.0, freeboard=2.0),
    "can": Revolution.vertical_cylinder(radius=3.0, draft=10.0, freeboard=2.0),
    "spar": Revolution.vertical_cylinder(radius=3.0, draft=60.0, freeboard=2.0),
    "ball": SPHERE,
}


@pytest.mark.parametrize("name", ROUND)
def test_more_panels_than_usual_are_had_where_they_are_asked_for(name):
    """Rings and sectors divide them: of a disc 686 were 576, as many as nobody asks for; nor far more than that."""
    hull = ROUND[name]

    def had(panels):
        problem = bem_problem.Problem.of((hull,), np.zeros((1, 3)), depth=np.inf, omega=OMEGA / 9, panels=panels)
        return problem.divisions[0] ** 2 * meshes.halved_count(hull, problem.base[0])

    for asked in (433, 500, 686, 900, 1200, 1728):
        assert asked <= had(asked) <= 2.3 * asked
    usual = 9 * meshes.halved_count(hull, meshes.PANELS // 9)
    assert had(meshes.PANELS) == usual  # as many as there are by default, whatever that is
    assert had(300) == 9 * meshes.halved_count(hull, 300 // 9)


def test_a_coarsest_mesh_that_does_not_resolve_a_wave_tells_no_more_than_the_finer_ones():
    """A thin disk's rang at Ka = 9: of its heave 618 % were told, where 14 % are true."""
    h, exact = 1 / np.array([3.0, 2.0, 1.0]), np.linspace(1.0, 2.0, 12)

    def of(size, rings):
        value = exact * (1 + 0.1 * size**2 + 0.02 * size**3)
        value[-1] += 10.0 * rings
        return extrapolation.Solution(
            value[:, None, None] + 0j, np.ones((1, 1)), value[:, None, None] + 0j, np.zeros((12, 0, 0)), 0.0, 400
        )

    motions = np.ones(1), np.zeros(1, int)
    quiet, ringing = (
        extrapolation.extrapolated(
            [of(size, rings) for size, rings in zip(h, of_each, strict=True)], (3, 2, 1), motions
        )
        for of_each in ((0, 0, 0), (0, 0, 1))
    )
    assert np.array_equal(quiet[0][0], ringing[0][0])
    assert ringing[1][0][:-1] == approx(quiet[1][0][:-1])
    step = np.abs(quiet[0][0] - of(h[0], 0).impedance)[:, 0, 0]
    assert abs(ringing[1][0][-1, 0, 0]) == approx(3 * step.max())
    assert np.all(np.abs(quiet[1][0][:, 0, 0]) < step)
