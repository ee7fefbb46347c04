"""The wetted-surface quadrature against closed forms, finer rules and invariances."""

from functools import partial

import numpy as np
import pytest
from pytest import approx

from solver.hydrodynamics.hull.revolution import Revolution
from solver.hydrodynamics.pressure.froude_krylov import Incident, pressure_load
from solver.hydrodynamics.pressure.quadrature import azimuths_for, quadrature, quadrature_room
from solver.sea.dispersion import wavenumber
from solver.sea.field import WaveField
from solver.sea.realization import realize
from solver.sea.spectrum import PiersonMoskowitz

BUAN = Revolution.hemisphere_cylinder(radius=1.0, height=0.6)
RHO_G = 1025 * 9.81
CENTRE = np.array([-3.86, 0.0, 0.0])
STILL = np.zeros((2, 1))


def pitched(angle):
    c, s = np.cos(angle), np.sin(angle)
    return np.array([[c, 0, s], [0, 1, 0], [-s, 0, c]])


def load(hull, shift, angle, field, *, azimuths=16, arc=8, line=4, half=False, wheeler=False, depth=50.0):
    rule = quadrature(hull, azimuths=azimuths, arc_points=arc, line_points=line, half=half, mean_length=np.inf)
    out = np.zeros(6)
    waves = Incident(*field, 99, CENTRE, np.array([1.0, 0.0]), RHO_G, wheeler, depth)
    pressure_load(CENTRE + shift, pitched(angle), rule, waves, quadrature_room(rule), out)
    return out


def waves(t=37.3, terms=24):
    sea = realize(PiersonMoskowitz(Hs=1.28, Tp=5.46), components=130, band=(0.7, 3.4), seed=1)
    rows = WaveField(sea, 50.0, 9.81).local_pressure(CENTRE, terms)
    return np.ascontiguousarray((rows * np.exp(-1j * sea.omega * t)).sum(axis=-1).real)


@pytest.mark.parametrize("heave, volume", [
    (0.0, 2 / 3 * np.pi),
    (-0.35, 2 / 3 * np.pi + 0.35 * np.pi),  # into the cylinder
    (0.4, np.pi * 0.6**2 * (3 - 0.6) / 3),  # spherical cap of height 0.6 m
    (-2.0, 2 / 3 * np.pi + 0.6 * np.pi),  # overtopped: the closed hull is wet all over
    (1.5, 0.0),  # in the air
])  # fmt: skip
def test_still_water_gives_archimedes(heave, volume):
    force = load(BUAN, np.array([0, 0, heave]), 0.0, STILL, arc=12)
    assert force[2] == approx(RHO_G * volume, rel=1e-9, abs=1e-6)
    assert np.abs(force[[0, 1, 3, 4, 5]]).max() < 1e-8 * RHO_G


def test_tilted_hull_in_still_water_has_no_sway_and_archimedes_moment():
    """Heeled about its centre, the hemisphere keeps its displacement; the cylinder gives the righting moment."""
    force = load(BUAN, np.zeros(3), 0.3, STILL, azimuths=64, arc=12, line=8)
    assert force[0] == approx(0, abs=1e-6 * RHO_G)
    # A wedge of waterplane emerges and another submerges: the exact moment is that of the displaced volume.
    fine = load(BUAN, np.zeros(3), 0.3, STILL, azimuths=512, arc=40, line=40)
    assert force == approx(fine, abs=1e-5 * RHO_G)
    # Pressure on the sphere passes by its centre; on the wall, wet up to tan θ cos φ: π/16 tan³θ cos θ.
    assert fine[4] == approx(-RHO_G * np.pi / 16 * np.tan(0.3) ** 3 * np.cos(0.3), abs=1e-5 * RHO_G)
    # A wedge of the hemisphere comes out, one of the cylinder goes in.
    assert fine[2] == approx(RHO_G * 2 / 3 * (np.pi - 0.3 + np.tan(0.3)), abs=1e-5 * RHO_G)


@pytest.mark.parametrize("wheeler", [False, True])
def test_load_in_waves_is_the_sum_of_every_waves_pressure(wheeler):
    """Shifted, pitched, in 3 m of water: ρg(head - z) under the surface, wave by wave, on a fine lattice."""
    depth, t, shift, angle = 3.0, 37.3, np.array([0.3, 0.0, 0.1]), 0.2
    sea = realize(PiersonMoskowitz(Hs=1.28, Tp=5.46), components=40, band=(0.7, 3.4), seed=1)
    rows = WaveField(sea, depth, 9.81).local_pressure(CENTRE, 24)
    field = np.ascontiguousarray((rows * np.exp(-1j * sea.omega * t)).sum(axis=-1).real)
    got = load(BUAN, shift, angle, field, azimuths=64, arc=24, line=24, wheeler=wheeler, depth=depth)

    k = wavenumber(sea.omega, depth, 9.81)
    phi = 2 * np.pi * (np.arange(64) + 0.5) / 64
    psi, up = np.pi / 2 * (np.arange(600) + 0.5) / 600, 0.6 * (np.arange(600) + 0.5) / 600
    out, down = np.concatenate([np.sin(psi), np.ones(600)]), np.concatenate([-np.cos(psi), up])
    along = np.concatenate([np.sin(psi) * np.pi / 2 / 600, np.full(600, 0.6 / 600)])  # r ds
    slope = np.concatenate([-np.cos(psi), np.zeros(600)])  # of the normal, downwards
    body = np.stack([np.outer(out, np.cos(phi)), np.outer(out, np.sin(phi)), np.outer(down, np.ones(64))], -1)
    normal = np.stack([np.outer(out, np.cos(phi)), np.outer(out, np.sin(phi)), np.outer(slope, np.ones(64))], -1)
    lever, normal = body @ pitched(angle).T, normal @ pitched(angle).T
    x, z = (CENTRE + shift + lever)[..., 0], (shift + lever)[..., 2]
    arrived = sea.amplitude * np.exp(1j * (k * x[..., None] - sea.omega * t))
    eta = arrived.sum(-1).real
    at = ((z - eta) / (1 + eta / depth) if wheeler else z)[..., None]
    head = (arrived * np.cosh(k * (at + depth)) / np.cosh(k * depth)).sum(-1).real
    force = -(RHO_G * np.where(z < eta, head - z, 0) * along[:, None] * 2 * np.pi / 64)[..., None] * normal
    expected = np.concatenate([force.sum(axis=(0, 1)), np.cross(lever, force).sum(axis=(0, 1))])
    assert got == approx(expected, abs=3e-3 * RHO_G)


BALL = Revolution.sphere(radius=1.0, draft=1.0)


@pytest.mark.parametrize("hull, shift, angle, volume", [
    (BUAN, 0.95, 0.37, 0.05**2 * np.pi * (3 - 0.05) / 3),  # a cap beside the pole is wet, and neither pole nor rim
    (BALL, 0.95, -0.37, 0.05**2 * np.pi * (3 - 0.05) / 3),
    (BALL, -0.95, 0.37, 4 / 3 * np.pi - 0.05**2 * np.pi * (3 - 0.05) / 3),  # and here one is dry
])  # fmt: skip
def test_a_cap_between_ends_and_middle_of_an_arc_counts(hull, shift, angle, volume):
    force = load(hull, np.array([0, 0, shift]), angle, STILL, azimuths=4096, arc=12)
    assert force[2] == approx(RHO_G * volume, rel=1e-5)
    assert np.abs(force[[0, 1, 3, 4, 5]]).max() < 1e-4 * RHO_G


def test_a_tilted_hull_that_is_hardly_wet_is_pushed_by_a_force_without_jumps():
    """Buoyancy's slope is the waterplane's area: in 0.1 mm it cannot change by more than a few times that."""
    shifts = np.arange(0.9, 1.0, 1e-4)
    force = [load(BUAN, np.array([0, 0, shift]), 0.37, STILL, azimuths=12, arc=6)[2] for shift in shifts]
    assert np.abs(np.diff(force)).max() < 5 * RHO_G * np.pi * (1 - 0.9**2) * 1e-4


def test_slope_of_buoyancy_is_the_waterplane():
    up, down = (load(BUAN, np.array([0, 0, s * 1e-4]), 0.0, STILL, arc=10)[2] for s in (1, -1))
    assert -(up - down) / 2e-4 == approx(RHO_G * np.pi, rel=1e-6)


@pytest.mark.parametrize("shift, angle, error", [
    ((0, 0, 0), 0.0, 1e-7),
    ((0.1, 0, 0.2), 0.3, 1e-7),
    ((-0.1, 0, -0.4), -0.5, 2e-4),  # the waterline runs over the edge of the flat top: a kink in azimuth
    ((0.2, 0, -1.2), 0.4, 1e-5),
])  # fmt: skip
def test_default_rule_against_a_fine_one(shift, angle, error):
    field, shift = waves(), np.array(shift)
    fine = load(BUAN, shift, angle, field, azimuths=512, arc=40, line=40)
    assert np.abs(load(BUAN, shift, angle, field) - fine).max() < error * abs(fine[2])


@pytest.mark.parametrize("wheeler", [False, True])
def test_half_the_azimuths_suffice_in_a_planar_scene(wheeler):
    field = waves()
    whole, half = (load(BUAN, np.array([0, 0, 0.1]), 0.2, field, half=h, wheeler=wheeler) for h in (False, True))
    assert half == approx(whole, abs=1e-9 * abs(whole[2]))


def test_half_of_an_odd_number_of_azimuths_is_rounded_up():
    rule = partial(quadrature, BUAN, arc_points=6, line_points=3, half=True, mean_length=np.inf)
    assert [len(rule(azimuths=n).azimuth) for n in (1, 12, 13)] == [1, 6, 7]


@pytest.mark.parametrize(
    "hull",
    [
        Revolution.vertical_cylinder(radius=2.0, draft=22.0, freeboard=3.0),  # 2.6 % off by three points along it
        Revolution.vertical_cylinder(radius=20.0, draft=5.0, freeboard=2.0),  # 2.2 % by twelve azimuths
        Revolution.sphere(radius=20.0, draft=20.0),
    ],
)
def test_points_keep_to_the_waves_on_hulls_that_are_large_beside_them(hull):
    sea = realize(PiersonMoskowitz(Hs=1.5, Tp=7.0), components=60, band=(0.45, 2.7), seed=0)
    field = WaveField(sea, 60.0, 9.81)
    rows, length, forces = field.local_pressure(np.zeros(3), 60), field.mean_length, np.zeros((2, 20, 6))
    for more, loads in zip((1, 4), forces, strict=True):
        azimuths = azimuths_for([hull], more * 12, length)
        points = {"azimuths": azimuths, "arc_points": more * 6, "line_points": more * 3}
        rule = quadrature(hull, **points, half=False, mean_length=length)
        for t, force in zip(np.arange(100.0, 150.0, 2.5), loads, strict=True):
            local = np.ascontiguousarray((rows * np.exp(-1j * sea.omega * t)).sum(axis=-1).real)
            waves = Incident(*local, 99, np.zeros(3), np.array([1.0, 0.0]), RHO_G, False, 60.0)
            pressure_load(np.array([0.1, 0.0, 0.3]), np.eye(3), rule, waves, quadrature_room(rule), force)
    usual, exact = forces[..., [0, 2]]
    assert np.all((usual - exact).std(axis=0) < 2e-3 * exact.std(axis=0))


def test_small_wave_gives_the_linear_force_and_the_quadratic_rest():
    """F(ε) - F(0) is linear in a small wave; what remains falls with ε²."""
    field, still = waves(), load(BUAN, np.zeros(3), 0.0, STILL, arc=20, line=20)
    sizes = np.array([1e-2, 5e-3, 2.5e-3])
    plus, minus = ([load(BUAN, np.zeros(3), 0.0, s * e * field, arc=20, line=20) for e in sizes] for s in (1, -1))
    even = np.abs(np.array(plus) + np.array(minus) - 2 * still)[:, 0]
    assert np.polyfit(np.log(sizes), np.log(even), 1)[0] == approx(2, abs=0.05)


def test_wheeler_pressure_vanishes_at_the_surface():
    """With Wheeler's stretching a hull just under the surface feels ρg(η - z): Archimedes on a flat wave."""
    flat = np.array([[0.5], [0.0]])  # η = 0.5 m, head uniform
    force = load(BUAN, np.array([0, 0, 0.5]), 0.0, flat, arc=12, wheeler=True)
    assert force[2] == approx(RHO_G * 2 / 3 * np.pi, rel=1e-9)
