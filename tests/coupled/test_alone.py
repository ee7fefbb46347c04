"""Floats without interaction: each in its own water, by the boundary elements and all that follows."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from solver.coupled.boundary import coefficients
from solver.coupled.linear import linear_model
from solver.coupled.preparation import prepare
from solver.errors import InputError
from solver.hydrodynamics.bem import bem
from solver.hydrodynamics.bem import problem as bem_problem
from solver.hydrodynamics.hull.revolution import Revolution
from solver.run import simulate
from solver.scene import Scene, Water
from tests import awkward
from tests.once import solve

OMEGA = np.array([1.0, 2.0])
RUN = {"depth": 20.0, "heading": 0.4, "omega": OMEGA, "planar": False, "panels": awkward.SMALL}
PILLAR = Revolution.vertical_cylinder(radius=0.8, draft=1.2, freeboard=0.5)


@cache
def alone_beside():
    """A hull of 6 m beside one of 1 m, that do not feel each other's waves."""
    whole = awkward.big_beside_small()[0]
    settings = replace(whole.settings, interaction=False, duration=60.0, discard=20.0, ramp=20.0)
    whole = replace(whole, settings=settings)
    return whole, known(whole)


def known(item, **changed):
    given = {"depth": item.water.depth, "omega": np.linspace(0.3, 4.0, 28), "planar": item.planar}
    return solve(
        tuple(f.hull for f in item.floats), np.array([f.centre for f in item.floats]), heading=item.sea.heading,
        panels=awkward.SMALL, **({"interaction": False} | given | changed),
    )  # fmt: skip


def test_each_block_is_that_of_the_body_alone_in_its_place():
    duck = awkward.duck()[0].floats[0].hull
    hulls, centres = (PILLAR, duck, PILLAR), np.array([[-3.0, 1.0, 0], [5.0, -2.0, 0], [4.0, 7.0, 0]])
    h = bem.solve(hulls, centres, interaction=False, **RUN)
    between = np.kron(np.eye(3), np.ones((6, 6))) == 0
    for b, (hull, centre) in enumerate(zip(hulls, centres, strict=True)):
        own = bem.solve((hull,), centre[None], **RUN)
        part = slice(6 * b, 6 * b + 6)
        for name in ("added_mass", "radiation_damping", "added_mass_inf", "hydrostatic_stiffness"):
            expected = getattr(own, name)
            got = getattr(h, name)[..., part, part]
            assert got == pytest.approx(expected, abs=1e-9 * np.abs(expected).max()), name
            assert np.all(getattr(h, name)[..., between] == 0), name
        for name in ("diffraction", "froude_krylov"):
            expected = getattr(own, name)
            assert getattr(h, name)[:, part] == pytest.approx(expected, abs=1e-9 * np.abs(expected).max()), name
        assert (h.displaced_mass[b], h.buoyancy_centre[b]) == (own.displaced_mass[0], own.buoyancy_centre[0])
    assert h.mesh_error > 0 and not h.interacting


def test_floats_alone_that_neither_radiate_nor_diffract_have_statics_and_froude_krylov_forces():
    hulls, centres = (PILLAR, PILLAR), np.array([[-3.0, 1.0, 0], [5.0, -2.0, 0]])
    bare, h = (bem.solve(hulls, centres, interaction=False, flow=flow, **RUN) for flow in (False, True))
    assert not bare.radiation_damping.any() and bare.error is None and bare.mesh_error == 0
    for name in ("froude_krylov", "hydrostatic_stiffness", "displaced_mass"):
        assert np.array_equal(getattr(bare, name), getattr(h, name))


@pytest.mark.slow
def test_equal_hulls_are_solved_once_and_one_alone_as_ever(monkeypatch):
    solved, plain = [], bem._coefficients
    monkeypatch.setattr(bem, "_coefficients", lambda own, *a, **k: solved.append(own.hulls) or plain(own, *a, **k))
    bem.solve((PILLAR, PILLAR), np.array([[0.0, 0, 0], [9.0, 0, 0]]), interaction=False, **RUN)
    assert solved == [(PILLAR,)] * len(bem_problem.DIVISIONS)
    one = replace(awkward.oblique()[0].floats[0], name="one")
    scene = awkward.scene([one], waves=awkward.sea(heading=0.5), tolerance=0.1)
    ours, plain = (coefficients(replace(scene, settings=replace(scene.settings, interaction=i))) for i in (False, True))
    for name in ("omega", "added_mass", "radiation_damping", "diffraction", "froude_krylov"):
        assert np.array_equal(getattr(ours, name), getattr(plain, name)), name
    assert dict(ours.settings) == dict(plain.settings) and ours.interacting
    assert ours.waves_to == scene.sea.omega.max()


@pytest.mark.slow
def test_far_apart_it_makes_next_to_no_difference():
    # A wave scattered by one has fallen to (a/L)^½ of itself, in a share (ka)² of the incident one: some 2 % there.
    left, right = (replace(f, hinge=(f.hinge[0] + x, f.hinge[1], f.hinge[2]))
                   for f, x in zip(awkward.oblique()[0].floats, (-150.0, 150.0), strict=True))  # fmt: skip
    waves = awkward.sea(Hs=0.5, Tp=6.0, band=(0.9, 1.3), heading=0.3)
    std = {}
    for interaction in (True, False):
        scene = awkward.scene(
            [left, right], waves=waves, method="frequency", froude_krylov="linear", interaction=interaction
        )
        # More frequencies than waves reflected over 300 m need, in a narrow band.
        h = known(scene, omega=np.linspace(0.88, 1.32, 60), interaction=interaction, depth=50.0)
        std[interaction] = simulate(scene, h).variables["rotation"][1][:, 4]
    assert std[False] == pytest.approx(std[True], rel=0.02)
    assert np.abs(std[False] / std[True] - 1).max() > 1e-6


def test_they_move_as_if_each_were_there_by_itself():
    whole, h = alone_beside()
    record = simulate(whole, h)
    off = h.added_mass.shape[-1] // 2
    memory = prepare(whole, h).fit
    assert np.abs(memory.residue[:, :off, off:]).max() < 1e-9 * np.abs(memory.residue).max()
    for b, item in enumerate(whole.floats):
        scene = replace(whole, floats=(item,))
        single = simulate(scene, known(scene, interaction=True))
        for name in ("rotation", "absorbed_power"):
            both, one = record.variables[name][1][b], single.variables[name][1][0]
            # Each has the same time step; memories are fits of the same kernels to 5e-3.
            assert both[2:] == pytest.approx(one[2:], rel=1e-2, abs=1e-2 * one[3]), (item.name, name)
    assert record.attrs["energy_residual"] < 1e-3
    assert "interaction: switched off" in record.attrs["skipped"]


@pytest.mark.slow
def test_the_reference_path_agrees():
    whole, h = alone_beside()
    settings = replace(whole.settings, duration=8.0, discard=0.0, ramp=4.0, froude_krylov="linear", keep_series=True)
    scene = replace(whole, settings=settings)
    fast = simulate(scene, h).series["rotation"][1]
    slow = replace(scene, settings=replace(settings, formulation="augmented"))
    assert simulate(slow, h).series["rotation"][1] == pytest.approx(fast, abs=2e-3 * np.abs(fast).max())


def test_linear_model_and_time_have_no_terms_between_them():
    whole, h = alone_beside()
    model = linear_model(prepare(whole, h))
    for matrix in (model.mass, model.damping, model.stiffness):
        assert abs(matrix[0, 1]) < 1e-9 * np.sqrt(matrix[0, 0] * matrix[1, 1])


def test_they_may_stand_in_each_other_and_mixed_up_coefficients_are_refused():
    a, b = awkward.oblique()[0].floats
    inside = replace(b, hinge=a.hinge, arm=(a.arm[0], a.arm[1] + 0.2, a.arm[2]))
    with pytest.raises(InputError, match="or their surfaces apart, which touch"):
        Scene(water=Water(depth=50.0), floats=(a, inside))
    settings = {"method": "frequency", "froude_krylov": "linear", "interaction": False}
    scene = awkward.scene([a, inside], waves=awkward.oblique()[0].sea, **settings)
    given = {"omega": np.linspace(0.5, 6.0, 16), "planar": False}
    both = simulate(scene, known(scene, **given)).variables["rotation"][1]
    for item, rotation in zip(scene.floats, both, strict=True):
        one = replace(scene, floats=(item,))
        assert rotation == pytest.approx(simulate(one, known(one, **given)).variables["rotation"][1][0], rel=1e-6)
    apart = awkward.oblique()[0]
    with pytest.raises(InputError, match=r"settings.interaction = True: must be false"):
        prepare(apart, known(apart, omega=OMEGA))
    off = replace(apart, settings=replace(apart.settings, interaction=False))
    with pytest.raises(InputError, match=r"settings.interaction = False: must be true"):
        prepare(off, awkward.oblique()[1])
