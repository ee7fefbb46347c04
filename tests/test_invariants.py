"""What holds for every scene, tried on random ones: energy, passivity, mirror, similarity, superposition, rest.

EXAMPLES=100 pytest tests/test_invariants.py tries more of them, as `make stress` does. The order at
which the balance closes is in coupled/test_march, reciprocity and decoupling of the boundary elements in
hydrodynamics/bem/test_bem, passivity of the fit at all frequencies in hydrodynamics/radiation/test_radiation.
"""

import os
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from pytest import approx

from solver import statistics
from solver.coupled.blocks import blocks
from solver.coupled.preparation import prepare
from solver.record.sampling import least_force
from solver.run import simulate
from solver.scene import DOFS

SHORT = {"duration": 30.0, "discard": 10.0, "ramp": 10.0}
EXAMPLES = int(os.environ.get("EXAMPLES", "8"))
few = settings(max_examples=EXAMPLES)

# Seas that a float with this damping rides without being thrown over.
seas = st.tuples(st.floats(0.05, 0.8), st.floats(4.5, 8.0), st.integers(0, 2**16))
dampings = st.floats(5e4, 1e6)
masses = st.floats(0.4, 1.3)


def floats(buan, mass, front, rear):
    """Unlike damping on the two floats, so that an exchange of them shows."""
    whole = 1025 * 2 / 3 * np.pi
    a, b = buan.floats(mass=mass * whole, inertia=(859.0 * mass,) * 3)
    return replace(a, pto_damping=front), replace(b, pto_damping=rear)


def history(scene, coefficients):
    """z (m, nz) and hinge wrench (m, nb, 6) of the whole run."""
    system = prepare(scene, coefficients)
    steps = round((scene.settings.discard + scene.settings.duration) / system.dt)
    parts = [(out.z, out.wrench) for _, out, _ in blocks(system, system.start(), steps)]
    return [np.concatenate(x) for x in zip(*parts, strict=True)]


@few
@given(sea=seas, mass=masses, front=dampings, rear=dampings, support=st.sampled_from(["fixed", "elastic"]))
def test_energy_balance_closes_and_the_memory_is_passive(buan, coefficients, sea, mass, front, rear, support):
    scene = buan.scene(support, sea=buan.sea(sea[2], *sea[:2]), floats=floats(buan, mass, front, rear), **SHORT)
    attrs = simulate(scene, coefficients).attrs
    assert attrs["energy_residual"] < 1e-3
    # From rest, whatever the motion: the memory holds no more than flowed into it.
    assert attrs["work_radiation"] >= 0
    assert attrs["work_pto"] > 0 and attrs["work_structural"] >= 0
    assert attrs["constraint_drift"] < 1e-12


@few
@given(sea=seas, mass=masses, front=dampings, rear=dampings)
def test_mirrored_scene_gives_the_mirrored_answer(buan, coefficients, sea, mass, front, rear):
    """x -> -x, heading 0 -> π: the floats change places with their dampings, rotations change sign."""
    exchanged = coefficients.diffraction.reshape(-1, 2, 3)[:, ::-1] * np.array([-1, 1, -1])
    there = replace(coefficients, heading=np.pi, diffraction=exchanged.reshape(-1, 6))
    exact = {"newton_tolerance": 1e-9, **SHORT}
    along = buan.scene("fixed", sea=buan.sea(sea[2], *sea[:2]), floats=floats(buan, mass, front, rear), **exact)
    against = replace(
        along, sea=buan.sea(sea[2], *sea[:2], heading=np.pi), floats=floats(buan, mass, rear, front)
    )  # fmt: skip
    (z, wrench), (mirrored, other) = history(along, coefficients), history(against, there)
    assert mirrored == approx(-z[:, ::-1], abs=1e-7)
    sign = np.array([-1, 1, 1, 1, -1, 1])  # of Fx, Fz, My; the rest is zero
    assert other == approx(sign * wrench[:, ::-1], abs=1e-6 * np.abs(wrench).max())


@few
@given(sea=seas, scale=st.floats(0.2, 5.0), density=st.floats(0.5, 2.0))
def test_similar_scenes_move_alike(buan, coefficients, sea, scale, density):
    """Froude's law for any length scale, and any density of water and bodies: the same angles at times √scale."""
    scene = buan.scene("fixed", sea=buan.sea(sea[2], *sea[:2]), time_step=0.2, newton_tolerance=1e-10, **SHORT)
    model, known = _similar(scene, scale, density), _similar_coefficients(coefficients, scale, density)
    (z, wrench), (same, loads) = history(scene, coefficients), history(model, known)
    # Both converge to one motion; what differs is the rounding in the memory's fit.
    assert same == approx(z, abs=1e-6)
    force = density * scale**3
    assert loads[..., :3] == approx(force * wrench[..., :3], abs=1e-5 * force * np.abs(wrench[..., :3]).max())


def _similar(scene, scale, density):
    time, s, sea = np.sqrt(scale), scene.settings, scene.sea
    mass = density * scale**3

    def body(f):
        return replace(
            f, hull=f.hull.__class__.hemisphere_cylinder(radius=scale, height=0.6 * scale), mass=mass * f.mass,
            inertia=tuple(mass * scale**2 * np.array(f.inertia)), hinge=tuple(scale * np.array(f.hinge)),
            arm=tuple(scale * np.array(f.arm)), pto_damping=mass * scale**2 / time * f.pto_damping,
        )  # fmt: skip

    longer = {name: time * getattr(s, name) for name in ("duration", "discard", "ramp")}
    if s.time_step is not None:
        longer["time_step"] = time * s.time_step
    return replace(
        scene,
        water=replace(scene.water, depth=scale * scene.water.depth, density=density * scene.water.density),
        sea=replace(sea, omega=sea.omega / time, amplitude=scale * sea.amplitude),
        floats=tuple(body(f) for f in scene.floats),
        settings=replace(s, **longer),
    )


def _similar_coefficients(h, scale, density):
    turns = np.array([DOFS.index(d) >= 3 for d in h.dofs] * len(h.centres))
    arm = scale**turns
    both, time, mass = np.outer(arm, arm), np.sqrt(scale), density * scale**3
    return replace(
        h, omega=h.omega / time, added_mass=mass * both * h.added_mass, added_mass_inf=mass * both * h.added_mass_inf,
        radiation_damping=mass / time * both * h.radiation_damping, diffraction=mass / scale * arm * h.diffraction,
        froude_krylov=mass / scale * arm * h.froude_krylov, displaced_mass=mass * h.displaced_mass, error=None,
        hydrostatic_stiffness=mass / scale * both * h.hydrostatic_stiffness, centres=scale * h.centres,
        depth=scale * h.depth, density=density * h.density,
    )  # fmt: skip


@pytest.mark.parametrize("scale", [1 / 20, 20.0])
def test_models_give_the_scaled_answers_by_themselves(buan, coefficients, scale):
    """No numerical key is set: step and tolerances follow the scene, and each errs by 1e-3 at most."""
    scene = buan.scene("fixed", duration=100.0)
    full = simulate(scene, coefficients)
    model = simulate(_similar(scene, scale, 1.0), _similar_coefficients(coefficients, scale, 1.0))
    assert model.attrs["time_step"] == approx(np.sqrt(scale) * full.attrs["time_step"], rel=0.25)
    units = {"rotation": 1.0, "absorbed_power": scale**3.5, "hinge_force": scale**3}
    least = {"hinge_force": units["hinge_force"] * least_force(scene)}
    for name, unit in units.items():
        a, b = (record.variables[name][1] for record in (model, full))
        assert statistics.apart(a, unit * b, least.get(name, 0.0)) < 2e-3


@pytest.mark.parametrize("scale", [1 / 20, 20.0])
def test_models_rest_too(buan, coefficients, scale):
    """Weights differ by 20⁸ between the two; in neither is rounding taken for an error."""
    calm = replace(buan.sea(), amplitude=np.zeros(130, complex))
    scene = _similar(buan.scene("fixed", sea=calm, newton_tolerance=1e-11, **SHORT), scale, 1.0)
    record = simulate(scene, _similar_coefficients(coefficients, scale, 1.0))
    assert record.attrs["repeated"] == "" and record.attrs["energy_residual"] < 1e-4


@pytest.fixture(scope="module")
def apart(coefficients):
    """Coefficients of two floats that do not feel each other, and of either alone."""
    blocks = np.kron(np.eye(2), np.ones((3, 3)))
    matrices = ("added_mass", "radiation_damping", "added_mass_inf")
    h = replace(coefficients, **{name: blocks * getattr(coefficients, name) for name in matrices})
    return h, [alone(h, b) for b in (0, 1)]


@few
@given(sea=seas, front=dampings, rear=dampings)
def test_floats_that_do_not_feel_each_other_move_as_ifalone(buan, apart, sea, front, rear):
    both, single = apart
    scene = buan.scene("fixed", sea=buan.sea(sea[2], *sea[:2]), floats=floats(buan, 1.0, front, rear), **SHORT)
    together = history(scene, both)[0]
    for b, item in enumerate(scene.floats):
        z = history(replace(scene, floats=(item,)), single[b])[0][:, 0]
        # Memories are fits of the same kernels to 1e-2, with room for one pair of poles more or less.
        assert together[:, b] == approx(z, abs=3e-3 * np.abs(z).max())


def alone(h, b):
    block = slice(3 * b, 3 * b + 3)
    matrices = {n: getattr(h, n)[..., block, block] for n in ("added_mass", "radiation_damping", "added_mass_inf")}
    return replace(
        h, **matrices, error=None, diffraction=h.diffraction[:, block], froude_krylov=h.froude_krylov[:, block],
        hydrostatic_stiffness=h.hydrostatic_stiffness[block, block], displaced_mass=h.displaced_mass[b : b + 1],
        buoyancy_centre=h.buoyancy_centre[b : b + 1], centres=h.centres[b : b + 1],
    )  # fmt: skip


@few
@given(mass=st.floats(0.4, 1.0), damping=st.floats(0.0, 1e6), support=st.sampled_from(["fixed", "elastic"]))
def test_without_waves_nothing_moves_from_equilibrium(buan, coefficients, mass, damping, support):
    """Wherever the floats rest: to the rounding of weight and buoyancy that cancel, with room for the modes.

    Heavier floats rest with the hull's edge near the surface, where the quadrature's load has steps of 1e-7 rad.
    """
    calm = replace(buan.sea(), amplitude=np.zeros(130, complex))
    z, _ = history(buan.scene(support, sea=calm, floats=floats(buan, mass, damping, damping), **SHORT), coefficients)
    assert np.ptp(z, axis=0).max() < 1e-9
