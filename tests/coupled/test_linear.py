"""The one linear model: against coefficients alone, and its use in judging coefficients."""

from dataclasses import replace

import numpy as np
import pytest
from pytest import approx
from scipy.interpolate import CubicSpline

from solver.coupled import driving, linear, moving, natural, preparation, ritz, support
from solver.coupled import system as systems
from solver.coupled.equilibrium import balance, differences
from solver.coupled.linear import impedance, linear_model
from solver.coupled.preparation import prepare
from solver.frequency import case
from solver.hydrodynamics.hull.panel_hull import PanelHull
from solver.record import effects
from solver.record.effects import coefficient_effects, shapes_effect
from solver.record.response import carried, in_waves
from solver.run import simulate
from solver.scene import DOFS, Float
from solver.sea.current import Current
from solver.sea.realization import regular
from tests.awkward import RHO, SCENES, known, scene
from tests.hydrodynamics.shapes import box

HINGED = ("duck", "big_beside_small", "model_scale", "flap")


def hinged_by_hand(scene, h):
    """J (n, nb), M without added mass, and C (nb, nb) of hinges about y: from the potential of weight and buoyancy.

    A point at r from the hinge has z'' = -r_z: weight at the c.o.g. gives -m g r_z, buoyancy at the reference point
    +ρgV r_z, and what the motion of the hull changes of it are the coefficients.
    """
    nr, nb, g = len(h.dofs), len(scene.floats), h.gravity
    J, M, C = np.zeros((nr * nb, nb)), np.zeros((nb, nb)), np.zeros((nb, nb))
    for b, f in enumerate(scene.floats):
        six = np.array([f.arm[2], 0, -f.arm[0], 0, 1, 0])
        J[b * nr : (b + 1) * nr, b] = six[[DOFS.index(d) for d in h.dofs]]
        lever = np.add(f.arm, f.cog)
        M[b, b] = f.inertia[1] + f.mass * (lever[0] ** 2 + lever[2] ** 2)
        C[b, b] = g * (h.displaced_mass[b] * f.arm[2] - f.mass * lever[2])
    return J, M, C + J.T @ h.hydrostatic_stiffness @ J


@pytest.mark.parametrize("name", HINGED)
def test_model_is_that_of_coefficients_alone(name):
    scene, h = SCENES[name]()
    system = prepare(replace(scene, settings=replace(scene.settings, froude_krylov="linear")), h)
    model, (J, M, C) = linear_model(system), hinged_by_hand(scene, h)
    infinite = J.T @ system.fit.added_mass_inf @ J
    assert model.mass == approx(M + infinite, rel=1e-9, abs=1e-9 * np.abs(infinite).max())
    assert model.stiffness == approx(C, rel=1e-6, abs=1e-6 * np.abs(C).max())
    assert np.diag(model.damping) == approx([f.pto_damping for f in scene.floats], rel=1e-6)
    omega = np.linspace(*h.omega[[0, -1]], 7)
    A, B = (CubicSpline(h.omega, x)(omega) for x in (h.added_mass, h.radiation_damping))
    Y = B - 1j * omega[:, None, None] * (A - system.fit.added_mass_inf)
    force = h.excitation(omega) @ J
    w, D = omega[:, None, None], np.diag([f.pto_damping for f in scene.floats])
    exact = np.linalg.solve(-(w**2) * (M + J.T @ A @ J) - 1j * w * (D + J.T @ B @ J) + C, force[..., None])[..., 0]
    assert model.response(omega, Y, force) == approx(exact, rel=1e-6, abs=1e-9 * np.abs(exact).max())


@pytest.mark.parametrize("name", HINGED)
def test_tangent_of_nonlinear_pressure_is_the_linear_stiffness(name):
    scene, h = SCENES[name]()
    _, _, C = hinged_by_hand(scene, h)
    # Panels and quadrature, on hulls that are not plane; the duck's waterline lies on slanted panels.
    assert linear_model(prepare(scene, h)).stiffness == approx(C, rel=2e-3, abs=1e-3 * np.abs(C).max())


@pytest.mark.parametrize("name", ["unequal_legs", "bare_legs"])
def test_modes_eliminated_answer_as_all_together(name):
    """Each frequency's whole matrix solved at once, and the floats alone on the modes' flexibility."""
    scene, h = SCENES[name]()
    linear = replace(scene, settings=replace(scene.settings, froude_krylov="linear", method="frequency"))
    system = prepare(linear, h)
    model, omega = linear_model(system), scene.sea.omega
    Y = impedance(system, h, omega) if h is not None else np.zeros((omega.size, 0, 0))
    force = np.random.default_rng(0).normal(size=(omega.size, 2, len(model.mass))) @ np.diag(1 / model.length)
    force = model.modes.max() * (force[:, 0] + 1j * force[:, 1])
    whole = np.linalg.solve(model.dynamic_stiffness(omega, Y), force[..., None])[..., 0]
    assert model.response(omega, Y, force) == approx(whole, rel=1e-8, abs=1e-10 * np.abs(whole).max())
    w = omega[:, None, None]
    Z = model.stiffness - w**2 * model.mass - 1j * w * (model.damping + model.active.T @ Y @ model.active)
    assert model.dynamic_stiffness(omega, Y) == approx(Z, abs=1e-12 * np.abs(Z).max())


@pytest.mark.parametrize("name", ["unequal_legs", "bare_legs"])
def test_shapes_effect_is_what_all_shapes_show(name, monkeypatch):
    """With few of the static shapes, for all of them leave out less than the drag's rounds do."""
    monkeypatch.setattr(ritz, "PATTERN", 0.3)
    support._reduced.cache_clear()
    scene, h = SCENES[name]()
    linear = replace(scene, settings=replace(scene.settings, froude_krylov="linear", method="frequency"))

    def stds(modes):
        whole = replace(linear, settings=replace(linear.settings, modes=modes))
        return simulate(whole, h).variables["top_displacement"][1][..., 4], shapes_effect(prepare(whole, h), h)

    (usual, told), (exact, none) = stds(6), stds("all")
    true = np.abs(usual / exact - 1)[exact > 1e-3 * exact.max()].max()
    assert told > 1e-5 and 1 / 3 < true / told < 3
    assert none < 1e-9
    support._reduced.cache_clear()


@pytest.mark.parametrize("method", ["frequency", "time"])
def test_shapes_effect_is_what_mean_drag_of_waves_in_a_current_does(method):
    """Its profile over the depth is another than that of the current alone, which the static shapes hold."""
    legs, current = SCENES["bare_legs"]()[0], Current(speed=0.8, exponent=0.2, direction=0.6)
    legs = replace(legs, sea=regular(height=3.0, period=7.0, heading=-0.9), current=current)
    asked = {"froude_krylov": "linear", "method": method, "duration": 56.0, "ramp": 14.0}
    asked |= {"time_step": 0.1} if method == "time" else {}
    usual, exact = (simulate(replace(legs, settings=replace(legs.settings, **asked, modes=n))) for n in (6, "all"))
    ours, theirs = (record.variables["top_displacement"][1] for record in (usual, exact))
    true = np.abs((ours - theirs)[..., 2] / theirs[..., 3]).max()
    assert usual.attrs["shapes_effect"] == approx(true, rel=0.1) and true > 1e-2
    assert exact.attrs["shapes_effect"] < 1e-9


@pytest.mark.parametrize(("drag", "legs"), [(0.0, True), (1.0, False), (0.0, False)])
def test_shapes_effect_without_drag_or_legs(drag, legs):
    """Legs that the waves do not drag on, and none whose tops are put out."""
    scene, _ = SCENES["bare_legs"]()
    frame = scene.platform.frame
    members = tuple(replace(m, drag_coefficient=drag if m.in_water else 0.0) for m in frame.members)
    platform = replace(scene.platform, frame=replace(frame, members=members), legs=scene.platform.legs if legs else ())
    system = prepare(replace(scene, platform=platform), None)
    assert (shapes_effect(system, None) > 0) == legs
    lines = replace(scene.settings, froude_krylov="linear", method="frequency")
    told = simulate(replace(scene, platform=platform, settings=lines), None).attrs["shapes_effect"]
    assert (told > 0) == legs


@pytest.mark.parametrize(
    ("method", "kept"),
    [("frequency", (case._case,)), ("time", (natural._system_modes, systems._equilibrium))],
)
def test_what_is_kept_of_another_damping_changes_no_bit(method, kept):
    """All is as in a process that knows no other scene."""
    scene, h = SCENES["unequal_legs"]()
    scene = replace(scene, settings=replace(scene.settings, froude_krylov="linear", method=method, duration=60.0))
    other = replace(scene, floats=tuple(replace(f, pto_damping=3 * f.pto_damping, damping=1e5) for f in scene.floats))
    simulate(scene, h)
    before = [known.cache_info().hits for known in kept]
    after = simulate(other, h)
    assert all(known.cache_info().hits > hits for known, hits in zip(kept, before, strict=True))
    forget()
    same_bits(simulate(other, h), after)


@pytest.mark.parametrize("method", ["frequency", "time"])
def test_what_is_kept_of_another_sea_changes_no_bit(method):
    """One that is alike: the platform, and that with twice as many elements, is reduced once for both."""
    scene, h = SCENES["unequal_legs"]()
    scene = replace(scene, settings=replace(scene.settings, froude_krylov="linear", method=method, duration=60.0))
    other = replace(scene, sea=replace(scene.sea, amplitude=1.2 * np.roll(scene.sea.amplitude, 1)))
    forget()
    simulate(scene, h)
    before = [known.cache_info().misses for known in (support._reduced, preparation._bodies)]
    after = simulate(other, h)
    assert [known.cache_info().misses for known in (support._reduced, preparation._bodies)] == before
    forget()
    same_bits(simulate(other, h), after)


def forget():
    """All that a process keeps of other scenes."""
    kept = (support._reduced, driving._curve, driving.driven, preparation._bodies, systems._equilibrium)
    kept += (systems._at_rest, systems.known_differences, systems.loads_at_rest, linear._linear_model, linear_model)
    for cached in (*kept, case._case, natural._system_modes):
        cached.cache_clear()


def same_bits(one, other):
    for name, (_, values) in one.variables.items():
        assert np.asarray(values).tobytes() == np.asarray(other.variables[name][1]).tobytes()


@pytest.mark.parametrize(
    "name", ["duck", "soft_mooring", *(pytest.param(n, marks=pytest.mark.slow) for n in ("flap", "oblique"))]
)
def test_mesh_effect_is_what_the_march_shows(name, monkeypatch):
    """Linear floats, with coefficients and with those off by their estimated error: statistics change by as much.

    And by what two fits of the memory may differ in. Errors of forces that others cancel are not counted by themselves.
    """
    monkeypatch.setattr(effects, "UNSURE", 0.0)
    scene, h = SCENES[name]()
    linear = replace(
        scene, settings=replace(scene.settings, froude_krylov="linear", memory_tolerance=1e-3, duration=600.0)
    )
    usual, off = (simulate(linear, known).variables for known in (h, h.shifted))
    changes = []
    for key in {"rotation", "motion", "absorbed_power", "hinge_force"} & set(usual):
        a, b = (v[key][1].reshape(-1, 5) for v in (usual, off))
        used = a[:, 4] > 1e-3 * a[:, 4].max(initial=1e-30)
        changes.append(np.abs(b[used, 4] / a[used, 4] - 1).max(initial=0))
    memory, told = coefficient_effects(prepare(linear, h), h)
    assert told / 3 < max(changes) < 3 * told + 2 * memory


@pytest.mark.parametrize("name", ["duck", "oblique", "unequal_legs"])
def test_waves_push_floats_without_coefficients_as_by_theirs(name):
    """What their hulls feel of the incident waves; and so what they put on a frame."""
    item, h = SCENES[name]()
    alone, known = (
        replace(item, settings=replace(item.settings, radiation=False, diffraction=False, froude_krylov=kind))
        for kind in ("body-nonlinear", "linear")
    )
    ours, theirs = prepare(alone, None), prepare(known, h)
    force = moving.force_of_waves(theirs, h)
    # About its own equilibrium each: nonlinear pressure is that of the hull's panels.
    assert moving.force_of_waves(ours, None) == approx(force, abs=1e-3 * np.abs(force).max())
    X = in_waves(theirs, h).X
    borne = carried(theirs, h, X)
    assert carried(ours, None, X) == approx(borne, abs=1e-3 * np.abs(borne).max(initial=0.0))


def test_impedance_beyond_the_frequencies_solved_for():
    """Below them B ∝ ω² and A is as there, so that what drifts slowly is damped by little; above A → A∞ and B → 0."""
    item, h = SCENES["soft_mooring"]()
    system = prepare(item, h)
    (low, high), limit = h.omega[[0, -1]], system.bodies.added_mass
    ends = impedance(system, h, np.array([low, high]))
    Y = linear.impedance_anywhere(system, h, np.array([0.0, low / 2, low, high, 2 * high]))
    assert np.all(Y[0] == 0) and Y[2:4] == approx(ends, rel=1e-12)
    assert Y[1].real == approx(ends[0].real / 4) and Y[1].imag / (low / 2) == approx(ends[0].imag / low)
    assert Y[4].real == approx(ends[1].real / 4)
    far = Y[4].imag / (2 * high)  # A∞ - A
    assert far == approx(ends[1].imag / high / 4) and np.all(np.abs(far) < 0.02 * np.abs(limit).max())


def moored_box(**changes):
    """Free in all motions, c.o.g. and place off any symmetry, in waves from the side."""
    hull = PanelHull.of(*box((4.0, 6.0, 3.0), (0.2, -0.3, 0.0)))
    item = Float(
        name="box", hull=hull, mass=RHO * hull.volume, inertia=(1.2e5, 8e4, 1.5e5), hinge=(0.4, 0.6, 0.0),
        cog=(hull.buoyancy_point[0], hull.buoyancy_point[1], -0.4), motion=DOFS,
        stiffness=(3e4, 3e4, 1e4, 1e4, 1e4, 3e5), damping=(1e4, 1e4, 1e4, 2e4, 2e4, 5e4),
    )  # fmt: skip
    still = {"froude_krylov": "linear", "radiation": False, "diffraction": False, "duration": 60.0, "discard": 240.0}
    waves = regular(height=1e-3, period=3.5, heading=0.5)
    whole = scene([replace(item, **changes)], waves=waves, **still)
    return whole, known(whole, 0.5, 3.5, 8)


def test_linear_hydrostatics_have_a_potential_and_are_linear_about_one_axis():
    """∂(JᵀW)/∂z is symmetric far from rest, too; a turn about y alone is borne as it is large."""
    whole, h = moored_box()
    body, random = prepare(whole, h).bodies, np.random.default_rng(1)
    for size in (1e-5, 1e-2, 0.6):
        K = differences(body, size * random.uniform(-1, 1, 6)).residual[0]
        assert np.abs(K - K.T).max() < 1e-7 * np.abs(K).max()
    nonlinear = replace(whole, settings=replace(whole.settings, froude_krylov="body-nonlinear"))
    tangents = [linear_model(prepare(item, h)).stiffness for item in (whole, nonlinear)]
    assert tangents[0] == approx(tangents[1], rel=1e-3, abs=1e-4 * np.abs(tangents[1]).max())
    pitched = replace(whole, floats=(replace(whole.floats[0], mass=1e-3, inertia=(1.0, 1.0, 1.0), stiffness=0.0),))
    body, angles = prepare(pitched, h).bodies, np.array([-0.5, 0.0, 0.02, 0.5, 1.0])
    moment = balance(body, np.outer(angles, np.eye(6)[4]))[0][:, 4]
    assert moment - moment[1] == approx(-h.hydrostatic_stiffness[4, 4] * angles, rel=1e-6)


@pytest.mark.slow
@pytest.mark.parametrize("preload", [(0, 0, 0, 5e4, 0, 0), (0, 0, 0, 5e4, 8e4, 0)])
def test_a_float_that_rests_tilted_answers_alike_by_march_and_lines(preload):
    """Yaw by roll, which no buoyancy holds, is half of it where the tangent is not symmetric."""
    whole, h = moored_box(preload=preload)
    stds = [
        simulate(replace(whole, settings=replace(whole.settings, method=m)), h).variables["motion"][1][0, :, 4]
        for m in ("time", "frequency")
    ]
    assert stds[0][5] > 0.01 * stds[0].max()
    assert stds[1] == approx(stds[0], rel=5e-3)
    asked = replace(whole.settings, time_step=0.05, duration=20.0, discard=0.0)
    paths = (asked, replace(asked, formulation="augmented"))
    a, b = (simulate(replace(whole, settings=s), h).variables["motion"][1][0, :, 4] for s in paths)
    assert a == approx(b, rel=1e-3)
