"""Diffraction and radiation along a float's own axes, as it turns."""

from dataclasses import replace

import numpy as np
import pytest
from pytest import approx

from solver.coupled.equilibrium import balance
from solver.coupled.preparation import prepare
from solver.multibody.bodies import new_motion
from solver.multibody.minimal import mass_matrix, move, stored_energy, take_inertia
from solver.record.channels import Channels
from solver.record.turning import turning
from solver.run import simulate
from solver.scene import Float
from solver.sea.realization import CALM, Realization
from tests import awkward

BRIEF = {"duration": 6.0, "discard": 0.0, "ramp": 0.0}


def along_body(scene, **settings):
    return replace(scene, settings=replace(scene.settings, hydrodynamic_axes="body", **settings))


def sprung_flap(amplitude):
    """On a spring in place of a waterplane, its buoyancy on its weight: only its water and the spring are left."""
    scene, h = awkward.flap()
    mass = float(h.displaced_mass[0])
    flap = replace(scene.floats[0], mass=mass, cog=(0, 0, 0), stiffness=3e7, pto_damping=6e6)
    one = Realization(omega=np.array([0.8]), amplitude=np.array([amplitude + 0j]))
    h = replace(h, hydrostatic_stiffness=0 * h.hydrostatic_stiffness)
    return replace(scene, floats=(flap,), sea=one), h


def test_a_linear_flap_is_linear_however_far_it_turns():
    """(I + A)q̈ + Bq̇ + Cq = F about its hinge, by 0.8 rad; along space's axes it is another."""
    scene, h = sprung_flap(2.5)
    scene = along_body(scene, froude_krylov="linear", duration=8 * 2 * np.pi / 0.8, discard=300.0)
    march, linear = (simulate(s, h) for s in (scene, along_body(scene, method="frequency")))
    for name in ("rotation", "absorbed_power"):
        told, exact = (of.variables[name][1][0] for of in (march, linear))
        assert told == approx(exact, rel=3e-3, abs=3e-3 * exact.max())
    assert linear.variables["rotation"][1][0, 0] > 0.7
    turned, usual = (of.variables["hinge_force"][1][0, :, 4] for of in (march, linear))
    assert linear.attrs["rotation_effect"] == approx(1 - usual[2] / turned[2], rel=0.1)  # all else is rounding
    still = replace(scene, settings=replace(scene.settings, hydrodynamic_axes="space"))
    other = simulate(still, h).variables["absorbed_power"][1][0, 2]
    assert abs(other / linear.variables["absorbed_power"][1][0, 2] - 1) > 0.1


def pair() -> tuple[Float, Float]:
    """A free body without symmetry, and one that turns on it about an axis of its own."""
    one = Float(
        name="one", hull=awkward.BALL, mass=2000.0, inertia=(300.0, 500.0, 400.0), cog=(0.2, 0.1, -0.6),
        hinge=(0.3, 0, 0.4), arm=(-0.3, 0, -0.4), motion=("surge", "sway", "heave", "roll", "pitch", "yaw"),
    )  # fmt: skip
    other = replace(one, name="other", on="one", hinge=(2.0, 1.0, 0.2), arm=(1.5, 0.5, -0.2), motion=("hinge",))
    return one, replace(other, axis=(0.6, 0.0, 0.8))


def test_loads_are_lagrange_s_of_the_water_s_energy():
    """JᵀW = -(d/dt ∂T/∂ż - ∂T/∂z) of T = ½ VᵀA∞V and the bodies' own, V along their own axes."""
    floats = pair()
    dry = awkward.scene(floats, depth=np.inf, waves=CALM, radiation=False, diffraction=False, froude_krylov="none")
    random = np.random.default_rng(5)
    cross = random.normal(size=(12, 12))
    added = np.diag([900.0, 2500.0, 4000.0, 700.0, 1500.0, 400.0] * 2) + 60 * (cross + cross.T)
    body = prepare(along_body(dry), awkward.vacuum(dry)).bodies._replace(added_mass=added)
    z, dz, ddz = random.normal(size=(3, 7)) * [[0.4], [1.0], [1.0]]

    def inertia(z: np.ndarray) -> np.ndarray:
        motion, zone, M = new_motion(body), np.zeros((2, 7), np.int64), np.empty((7, 7))
        rates = [np.zeros(7), *np.eye(7), *(a + b for a in np.eye(7) for b in np.eye(7))]
        T = np.empty(len(rates))
        for k, rate in enumerate(rates):
            move(body, z, rate, motion)
            T[k] = stored_energy.py_func(body, zone, z, rate, motion)
        T -= T[0]
        M = T[8:].reshape(7, 7) - T[1:8] - T[1:8, None]
        known = np.empty((7, 7))
        mass_matrix(body, motion, known)
        assert known == approx(M, abs=1e-8 * M.max())
        wrench = np.zeros((2, 6))
        take_inertia(body, motion, ddz, wrench)
        along = motion.jacobian[1].T @ wrench[1]
        along[:6] += motion.jacobian[0, :, :6].T @ wrench[0]
        assert -along == approx(M @ ddz, abs=1e-8 * M.max())
        return M

    slopes = np.array([(inertia(z + h) - inertia(z - h)) / 2e-5 for h in 1e-5 * np.eye(7)])
    lagrange = inertia(z) @ ddz + np.einsum("k,kij,j", dz, slopes, dz) - np.einsum("i,kij,j->k", dz, slopes, dz) / 2
    moving, at_rest = (balance(body, z, *rates)[0] for rates in ((dz, ddz), (0 * dz, 0 * ddz)))
    assert at_rest - moving == approx(lagrange, abs=1e-6 * np.abs(lagrange).max())
    in_space = balance(body._replace(turning=False), z, dz, ddz)[0]
    assert np.abs(in_space - moving).max() > 0.1 * np.abs(lagrange).max()


@pytest.mark.parametrize("linear", [True, pytest.param(False, marks=pytest.mark.slow)])
@pytest.mark.parametrize("name", ["flap", "oblique"])
def test_the_augmented_formulation_agrees(name, linear):
    scene, h = awkward.SCENES[name]()
    froude_krylov = "linear" if linear else "body-nonlinear"
    scene = along_body(scene, froude_krylov=froude_krylov, time_step=0.1, tolerance=None, **BRIEF)
    fast = simulate(scene, h)
    slow = simulate(along_body(scene, formulation="augmented"), h)
    for of in ("rotation", "hinge_force"):
        exact = slow.variables[of][1]
        assert fast.variables[of][1] == approx(exact, abs=1e-5 * np.abs(exact).max())
    assert fast.attrs["energy_residual"] < 1e-6


def test_what_turns_with_its_body_needs_no_warning():
    scene, h = awkward.flap()
    told = [
        list(turning(s, Channels(s.scene, None), {"rotation": np.full((1, 5), 0.4)}))
        for s in (prepare(scene, h), prepare(along_body(scene), h))
    ]
    assert len(told[0]) == 1 and not told[1]


def test_what_turning_adds_is_told_in_the_frequency_domain():
    """A flap's weight and buoyancy, and its hinge's force, which turns with it: 0.22 rad, vertical force 17 % more."""
    scene, h = awkward.flap()
    one = Realization(omega=np.array([0.85]), amplitude=np.array([2.0 + 0j]))
    scene = along_body(replace(scene, sea=one), froude_krylov="linear", duration=20 * 2 * np.pi / 0.85, discard=300.0)
    march, linear = (simulate(s, h) for s in (scene, along_body(scene, method="frequency")))
    (true, _, vertical), (told, _, linear_one) = (
        (of.variables["hinge_force"][1][0, 0, 2], *of.variables["hinge_force"][1][0, [0, 2], 4])
        for of in (march, linear)
    )
    assert true == approx(told, rel=0.02)  # mean of what turns: the linear model's own is none
    assert linear.attrs["rotation_effect"] == approx(1 - linear_one / vertical, rel=0.02)
