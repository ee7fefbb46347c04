"""Bodies that do not move, in the same water as those that do; and bodies inside the outlines of others."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from solver.coupled.preparation import prepare
from solver.errors import InputError
from solver.hydrodynamics.bem import bem
from solver.hydrodynamics.hull import mesh as meshes
from solver.hydrodynamics.hull.clearance import touching
from solver.hydrodynamics.hull.panel_hull import PanelHull
from solver.hydrodynamics.hull.revolution import Revolution
from solver.run import simulate
from solver.scene import Float, Scene, Settings, Water
from solver.sea.realization import CALM, realize, regular
from solver.sea.spectrum import PiersonMoskowitz
from tests import awkward
from tests.once import solve

RHO, DEPTH = 1025.0, 60.0
BALL = Revolution.hemisphere_cylinder(radius=1.0, height=0.6)
PILLAR = Revolution.vertical_cylinder(radius=2.0, draft=3.0, freeboard=2.0)
SEA = realize(PiersonMoskowitz(Hs=0.4, Tp=4.5), components=40, band=(0.8, 3.0), seed=1)


def heaving(name, hull, x, **joint):
    return Float(
        name=name, hull=hull, mass=RHO * hull.volume, inertia=(9e3,) * 3, hinge=(x, 0, 0), motion=("heave",), **joint
    )


def scene(*floats, **settings):
    chosen = {"duration": 60.0, "discard": 10.0, "ramp": 5.0, "froude_krylov": "linear"} | settings
    return Scene(water=Water(depth=DEPTH), sea=SEA, floats=floats, settings=Settings(**chosen))


@cache
def known():
    """Of pillar and ball."""
    omega = np.linspace(0.5, 7.0, 15)
    return solve((PILLAR, BALL), np.array([[0.0, 0, 0], [5.0, 0, 0]]), depth=DEPTH, omega=omega, panels=108)


FIXED = replace(heaving("pillar", PILLAR, 0.0), motion=())
BALL_AT = heaving("ball", BALL, 5.0, pto_damping=2e3)


@pytest.mark.parametrize(
    ("method", "own", "apart"),
    [("frequency", True, 1e-6), ("time", False, 1e-6), pytest.param("time", True, 5e-3, marks=pytest.mark.slow)],
)
def test_a_fixed_body_is_one_too_heavy_to_move(monkeypatch, method, own, apart):
    """Among others' waves, and for what it bears along x, which no inertia of its own heave touches.

    With a memory of all motions, or each with that of its own: then to the fit's tolerance.
    """
    if not own:
        monkeypatch.setattr("solver.motions.of_scene", lambda _: ())
    heavy = heaving("pillar", PILLAR, 0.0, mechanism_inertia=1e13)
    fixed, held = (simulate(scene(f, BALL_AT, method=method), known()).variables for f in (FIXED, heavy))
    ours, theirs = fixed["motion"][1][1], held["motion"][1][1]
    assert np.abs(ours - theirs).max() < apart * np.abs(theirs).max()
    ours, theirs = fixed["hinge_force"][1][:, 0], held["hinge_force"][1][:, 0]
    assert np.abs(ours - theirs).max() < apart * np.abs(theirs).max()
    assert np.isnan(fixed["motion"][1][0]).all() and np.all(fixed["absorbed_power"][1][0] == 0)


@pytest.mark.slow
@pytest.mark.parametrize("method", ["frequency", "time"])
def test_what_a_mesh_does_to_a_fixed_body_is_told_of_its_force(method):
    """It moves nothing and takes no power: what holds it is off by what nine times the panels change it by."""
    usual, fine = (simulate(scene(FIXED, method=method, tolerance=1e-4), h) for h in (known_alone(), known_alone(972)))
    ours, exact = (r.variables["hinge_force"][1][0, [0, 2], 4] for r in (usual, fine))
    told, true = usual.attrs["mesh_effect"], np.abs(ours / exact - 1).max()
    assert told / 3 < true < 3 * told
    assert usual.attrs["estimated_error"] >= told > 1e-4 and "tolerance" in usual.attrs["unmet"]


def test_what_a_record_s_ends_do_is_told_where_nothing_moves():
    """Its force alone is judged: records of a few periods, as they end anywhere, against those of finer samples."""
    apart, told = [], []
    for duration in np.linspace(20.0, 24.0, 9):
        short = {"duration": duration, "discard": 12.0}
        usual, fine = (simulate(scene(FIXED, **short, time_step=h), known_alone()) for h in (0.1, 0.0125))
        ours, exact = (r.variables["hinge_force"][1][0, 0] for r in (usual, fine))  # max, min, mean, rms, std
        apart.append(np.abs(ours - exact)[2:] / exact[4])
        told.append(usual.attrs["sampling_error"])
    true = np.mean(apart, axis=0).max()
    assert true > 5e-4 and true / 3 < np.median(told) < 3 * true, (true, told)
    calm = simulate(replace(scene(FIXED, duration=20.0), sea=CALM), known_alone())
    assert calm.attrs["sampling_error"] == 0


def test_a_fixed_body_alone_bears_the_waves():
    """Along x: the excitation's root of half the squared amplitudes; along z weight less buoyancy in the mean."""
    heavy = replace(FIXED, mass=2 * FIXED.mass)
    record = simulate(scene(heavy, method="frequency", rao=True), alone := known_alone())
    force = dict(zip(record.coords["statistic"], record.variables["hinge_force"][1][0, 0], strict=True))
    excitation = alone.excitation(SEA.omega)[:, 0] * SEA.amplitude
    assert force["std"] == pytest.approx(np.sqrt(np.sum(np.abs(excitation) ** 2) / 2), rel=1e-9)
    mean = record.variables["hinge_force"][1][0, 2, list(record.coords["statistic"]).index("mean")]
    assert mean == pytest.approx(FIXED.mass * 9.81, rel=1e-9)
    assert not record.variables.keys() & {"motion", "rotation", "rao"}


@cache
def known_alone(panels=108):
    return solve((PILLAR,), np.zeros((1, 3)), depth=DEPTH, omega=np.linspace(0.5, 7.0, 22), panels=panels)


def test_on_legs_that_bend_a_fixed_body_pushes_as_in_the_frequency_domain():
    whole, _ = awkward.unequal_legs()
    fixed = replace(whole.floats[0], motion=(), pto_damping=0.0)
    dry = {"radiation": False, "diffraction": False, "froude_krylov": "linear", "duration": 60.0, "ramp": 10.0}
    whole = replace(whole, floats=(fixed,), sea=regular(height=0.5, period=5.0))
    march, lines = (
        simulate(replace(whole, settings=replace(whole.settings, **dry, method=method))).variables
        for method in ("time", "frequency")
    )
    for name in ("top_displacement", "hinge_force"):
        ours, theirs = (record[name][1][..., 4] for record in (march, lines))
        assert np.abs(ours - theirs).max() < 0.05 * theirs.max()


def test_a_fixed_body_has_no_joint_and_no_augmented_path():
    with pytest.raises(InputError, match="a fixed body has no axis"):
        replace(FIXED, pto_damping=1e3)
    with pytest.raises(InputError, match=r'motion = .*: a fixed body needs formulation = "minimal", surface = "q'):
        scene(FIXED, BALL_AT, formulation="augmented", surface="panels")


def ring(inner, outer, draft, top, count=24):
    """An annulus on end."""
    line = [(inner, -draft), (outer, -draft), (outer, top), (inner, top)]
    angle = 2 * np.pi * np.arange(count) / count
    vertices = np.array([(r * np.cos(a), r * np.sin(a), z) for r, z in line for a in angle])
    faces = [
        (p * count + i, p * count + (i + 1) % count, (p + 1) % 4 * count + (i + 1) % count, (p + 1) % 4 * count + i)
        for p in range(4)
        for i in range(count)
    ]
    return PanelHull.of(vertices, np.array(faces))


def test_bodies_are_judged_by_their_surfaces():
    pool, here = ring(2.0, 4.0, 2.0, 1.0), np.zeros(3)
    for hull, at, touches in [
        (BALL, [0.0, 0, 0], False), (BALL, [0.8, 0, 0], False), (BALL, [1.2, 0, 0], True), (BALL, [3.0, 0, 0], True),
        (BALL, [5.1, 0, 0], False), (PILLAR, [0.0, 0, 0], True),
    ]:  # fmt: skip
        assert touching(pool, here, hull, np.array(at)) == touching(hull, np.array(at), pool, here) == touches, at
    # One inside another, whose surfaces nowhere meet; and one deep below another, within its outline.
    assert touching(PILLAR, here, Revolution.sphere(radius=0.5, draft=0.5), here)


def test_a_float_in_a_moonpool_has_its_own_place_and_motions():
    pool, here = ring(2.0, 4.0, 2.0, 1.0), np.zeros((2, 3))
    _, mirrors = meshes.mirror_planes((pool, BALL), here)
    assert len(mirrors) == 4
    assert [list(meshes.partner((pool, BALL), here, m)) for m in mirrors] == [[0, 1]] * 4
    both = bem.solve((pool, BALL), here, depth=DEPTH, omega=np.array([1.0, 1.5]), panels=108)
    alone = bem.solve((BALL,), here[:1], depth=DEPTH, omega=np.array([1.0, 1.5]), panels=108)
    # The ring's walls let less water by: a float moves more of it in there than in the open.
    assert both.added_mass[0, 4, 4] > 1.2 * alone.added_mass[0, 1, 1] > 0
    assert both.added_mass[:, :3, :3] != pytest.approx(both.added_mass[:, 3:, 3:])


def test_floats_on_both_sides_of_the_middle_are_mirror_images():
    """The same coefficients from half the panels as from all of them."""
    centres = np.array([[0.0, 0, 0], [-3.0, 3.5, 0], [-3.0, -3.5, 0]])
    hulls = (PILLAR, BALL, BALL)
    _, mirrors = meshes.mirror_planes(hulls, centres)
    assert mirrors.tolist() == [[1, 1, 1], [1, -1, 1]]
    assert [meshes.quarters(at, 2) for at in centres] == [2, 4, 0]
    run = {"depth": DEPTH, "omega": np.array([1.2]), "planar": False, "heading": 0.4, "panels": 108}
    half = bem.solve(hulls, centres, **run)
    # A tenth of a millimetre out of the middle, nothing is a mirror image.
    off = np.add(centres, [[0, 0, 0], [0, 1e-4, 0], [0, 0, 0]])
    assert len(meshes.mirror_planes(hulls, off)[1]) == 1
    whole = bem.solve(hulls, off, **run)
    for name in ("added_mass", "radiation_damping", "diffraction", "froude_krylov"):
        a, b = getattr(half, name), getattr(whole, name)
        assert np.abs(a - b).max() < 2e-3 * np.abs(b).max(), name


def test_linear_scenes_may_drift_as_far_as_they_do():
    """A bound is there for the waves summed about the place at rest, which linear loads do not look at."""
    free = replace(heaving("ball", BALL, 0.0), motion=("surge", "heave"), stiffness=(10.0, 0.0))
    bounds = {
        kind: prepare(scene(free, froude_krylov=kind), solo()).bodies.limit for kind in ("linear", "body-nonlinear")
    }
    assert np.all(np.isinf(bounds["linear"])) and np.all(np.isfinite(bounds["body-nonlinear"]))


@cache
def solo():
    return solve((BALL,), np.zeros((1, 3)), depth=DEPTH, omega=np.linspace(0.5, 7.0, 22), panels=108)


def test_where_floats_are_lifted_out_there_are_the_waves_alone():
    empty = Scene(water=Water(depth=DEPTH), sea=SEA, settings=Settings(duration=60.0, discard=10.0, ramp=10.0))
    record = simulate(empty)
    assert record.attrs["estimated_error"] == 0.0 and [*record.variables] == ["wave_elevation"]
    assert record.variables["wave_elevation"][1].shape == (5,)
