"""A ball wholly under water: what is exact of it, its limit far down, and the same answer body-nonlinear and linear."""

import numpy as np
import pytest
from pytest import approx

from solver.hydrodynamics.hull.panel_hull import PanelHull
from solver.run import simulate
from solver.scene import Float, Scene, Settings, Water
from solver.sea.realization import components
from tests.once import solve

RHO, G, RADIUS, DOWN = 1025.0, 9.81, 1.5, 4.5
OMEGA = np.array([0.4, 0.6, 0.8, 1.0, 1.2, 1.4])


def ball(rows=10, columns=20):
    """Its centre DOWN below still water."""
    polar, round_ = np.pi * np.arange(1, rows) / rows, 2 * np.pi * np.arange(columns) / columns
    ring = [(np.sin(p) * np.cos(a), np.sin(p) * np.sin(a), np.cos(p)) for p in polar for a in round_]
    points = np.array([(0, 0, 1), *ring, (0, 0, -1)])
    at = 1 + np.arange((rows - 1) * columns).reshape(rows - 1, columns)
    after, last = np.roll(at, -1, axis=1), len(points) - 1
    faces = [(0, at[0, j], after[0, j], after[0, j]) for j in range(columns)]
    faces += [(at[i, j], at[i + 1, j], after[i + 1, j], after[i, j]) for i in range(rows - 2) for j in range(columns)]
    faces += [(at[-1, j], last, after[-1, j], after[-1, j]) for j in range(columns)]
    return PanelHull.of(points * RADIUS + (0, 0, -DOWN), np.array(faces))


@pytest.fixture(scope="module")
def hull():
    return ball()


@pytest.fixture(scope="module")
def known(hull):
    return solve((hull,), np.zeros((1, 3)), depth=np.inf, omega=OMEGA, density=RHO, planar=True)


def test_buoyancy_is_all_there_is_at_rest(hull, known):
    assert known.displaced_mass[0] == approx(RHO * hull.volume, rel=1e-9)
    assert known.buoyancy_centre[0] == approx(-DOWN, rel=1e-6)
    heave = known.dofs.index("heave")
    assert np.abs(known.hydrostatic_stiffness[heave]).max() < 1e-6 * RHO * G * RADIUS**2


def test_the_incident_waves_force_is_that_at_the_centre(hull, known):
    """-ρgkV exp(-kd) upwards, down under a crest, and i times that along x: the mean of a harmonic over a ball."""
    k = OMEGA**2 / G
    surge, heave = (known.froude_krylov[:, known.dofs.index(name)] for name in ("surge", "heave"))
    exact = -RHO * G * k * hull.volume * np.exp(-k * DOWN)
    assert np.abs(heave / exact - 1).max() < 1e-3 and np.abs(surge / (1j * exact) - 1).max() < 1e-3


def test_radiation_and_waves_forces_are_of_one_piece(known):
    """Haskind: B = k|X|²/(4 ρg c_g) in heave, k|X|²/(8 ρg c_g) in surge, of deep water; far from walls A∞ is ρV/2."""
    k, group = OMEGA**2 / G, G / (2 * OMEGA)
    for name, share in (("surge", 8), ("heave", 4)):
        i = known.dofs.index(name)
        X = known.froude_krylov[:, i] + known.diffraction[:, i]
        assert known.radiation_damping[:, i, i] == approx(k * np.abs(X) ** 2 / (share * RHO * G * group), rel=0.01)
        assert known.added_mass_inf[i, i] == approx(known.displaced_mass[0] / 2, rel=0.03)


def test_body_nonlinear_at_a_millimetre_is_linear(hull, known):
    wave = components(amplitude=np.array([1e-3]), omega=np.array([0.9]), phase=np.zeros(1))
    item = Float(
        name="ball", hull=hull, mass=0.9 * RHO * hull.volume, inertia=(2e4,) * 3, cog=(0, 0, -DOWN), hinge=(0, 0, 0),
        motion=("surge", "heave"), stiffness=(2e4, 4e4), pto_damping=(5e3, 5e3),
        preload=(0.0, -0.1 * RHO * G * hull.volume),
    )  # fmt: skip
    std = []
    for pressure in ("body-nonlinear", "linear"):
        chosen = Settings(duration=120.0, discard=150.0, froude_krylov=pressure)
        record = simulate(Scene(water=Water(depth=np.inf), sea=wave, floats=(item,), settings=chosen), known)
        std.append(record.variables["motion"][1][0, :, 4])
    assert std[0] == approx(std[1], rel=2e-3)
