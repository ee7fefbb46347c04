"""What the waves far off carry away is what the bodies lose, and closed forms of mean drift."""

import numpy as np
import pytest
from pytest import approx
from scipy.special import jvp, yvp

from solver.errors import InputError
from solver.hydrodynamics.bem import bem, far_field
from solver.hydrodynamics.hull.duck import duck
from solver.hydrodynamics.hull.revolution import Revolution
from solver.sea.dispersion import wavenumber

RHO, G = 1025.0, 9.81
WATER = {"density": RHO, "gravity": G}


def solved(hulls, centres, **how):
    problem = bem.Problem.of(hulls, np.array(centres, float), planar=False, far_field=True, **(WATER | how))
    halves = [bem.part(problem, n, 2) for n in range(2)]
    return bem.united(problem, halves)


@pytest.fixture(scope="module")
def ducks():
    """An asymmetric pair off the origin, in water of 6 m, waves aslant."""
    hulls = tuple(duck(radius=1.0, beak=beak, elevation=0.4, submergence=0.5, width=2.0) for beak in (1.8, 2.2))
    omega = np.array([0.9, 1.6])
    return solved(hulls, [(3, 1, 0), (7, 4, 0)], depth=6.0, omega=omega, headings=(0.6, 2.0), panels=216)


def test_haskind_and_damping_from_the_far_field(ducks):
    h, other = ducks
    largest = np.sqrt(np.einsum("wii->wi", h.radiation_damping)).max(axis=0)
    B = far_field.radiation_damping(h.far_field, h.omega, depth=6.0, **WATER)
    assert np.abs((B - h.radiation_damping) / np.outer(largest, largest)).max() < 0.02
    for at in (h, other):
        e = np.array([np.cos(at.heading), np.sin(at.heading)])
        arrival = np.exp(1j * wavenumber(h.omega, 6.0) * (at.far_field.origin @ e))
        X = far_field.excitation(at.far_field, at.heading, **WATER) * arrival[:, None]
        exact = at.excitation(at.omega)
        assert np.all(np.abs(X - exact).max(axis=0) < 0.02 * np.abs(exact).max(axis=0))


def test_waves_beyond_the_frequencies_solved_for_are_refused(ducks):
    with pytest.raises(InputError, match=r"omega = .* must be within 0.9 to 1.6 rad/s"):
        ducks[0].waves(np.array([1.7]), np.ones(1), np.zeros((1, 6)))


@pytest.mark.parametrize("moving", [0.0, 0.7])
def test_energy_that_bodies_take_is_missing_far_off(ducks, moving):
    """Whatever they do; ½Re F·V* by pressure, and not a share of it where they are held."""
    random, h = np.random.default_rng(1), ducks[0]
    a = np.full(2, 0.8 * np.exp(1.1j))
    V = moving * (random.normal(size=(2, 12)) + 1j * random.normal(size=(2, 12)))
    waves = h.waves(h.omega, a, V)
    force = a[:, None] * h.excitation(h.omega) - np.einsum("wij,wj->wi", h.radiation_damping, V)
    work = 0.5 * np.sum(force * V.conj(), axis=1).real
    assert waves.absorbed_power == approx(work, abs=1e-2 * np.abs(waves.outgoing_power).max())
    assert (np.abs(work).min() > 0.1 * waves.outgoing_power.min()) == bool(moving)


def havelock(ka):
    """F/(ρg a² R) of waves on a vertical cylinder in deep water (Havelock 1940)."""
    m, size = np.arange(15), jvp(np.arange(16), ka) ** 2 + yvp(np.arange(16), ka) ** 2
    return 4 / (np.pi**2 * ka**3) * np.sum((1 - m * (m + 1) / ka**2) ** 2 / (size[:-1] * size[1:]))


def test_drift_of_a_cylinder_is_havelocks():
    """Along the waves, nothing across and no moment about it; so deep that waves do not see its end."""
    ka, beta = np.array([1.0, 1.5, 2.0]), 0.3
    assert havelock(10.0) == approx(2 / 3, rel=0.03)  # total reflection, ½ρg a² sin²
    hull = Revolution.vertical_cylinder(radius=1.0, draft=4.0, freeboard=1.0)
    (h,) = solved((hull,), [(2, -1, 0)], depth=np.inf, omega=np.sqrt(G * ka), headings=(beta,), panels=432)
    waves = h.waves(h.omega, np.full(3, 2j), np.zeros((3, 6)))
    along = waves.drift_force @ [np.cos(beta), np.sin(beta)] / (RHO * G * 4)
    assert along == approx([havelock(x) for x in ka], rel=3e-3)
    assert waves.drift_force @ [-np.sin(beta), np.cos(beta)] == approx(np.zeros(3), abs=3e-3 * RHO * G)
    assert waves.drift_moment == approx(np.zeros(3), abs=3e-3 * RHO * G)


def synthetic(h, heading=0.4, amplitude=1.3 - 0.2j, depth=7.0):
    return far_field.Waves(
        omega=np.array([1.1]), amplitude=np.array([amplitude]), modes=h[None], heading=heading, depth=depth, **WATER
    )


def test_a_point_absorber_is_pushed_by_twice_its_power_over_c():
    """Alike all round it sends out as much as it takes, at most; then F = 2P/c."""
    k = float(wavenumber(1.1, 7.0))
    outgoing = RHO * 1.1 / (8 * far_field.spread(k, 7.0))
    amplitude = 1.3 - 0.2j
    waves = synthetic(np.array([0, RHO * G * amplitude / (4 * outgoing), 0]))
    crest = 0.5 * RHO * G * abs(amplitude) ** 2 * 1.1 / k * (0.5 + k * 7.0 / np.sinh(2 * k * 7.0))
    assert waves.absorbed_power[0] == approx(crest / k)  # Budal and Falnes: a crest's length over 2π
    assert waves.outgoing_power == approx(waves.absorbed_power)
    F = 2 * waves.absorbed_power[0] * k / 1.1
    assert waves.drift_force[0] == approx([F * np.cos(0.4), F * np.sin(0.4)])
    assert waves.drift_moment == approx(0.0, abs=1e-9 * F)


def test_drift_goes_with_the_bodies():
    """The same waves seen from elsewhere: power and force do not change, the moment by the force's lever."""
    random, M, k = np.random.default_rng(2), 20, float(wavenumber(1.1, 7.0))
    h = np.zeros(2 * M + 1, complex)
    h[M - 3 : M + 4] = random.normal(size=7) + 1j * random.normal(size=7)
    angle, (x, y) = 2 * np.pi * np.arange(2 * M + 1) / (2 * M + 1), (6.0, -3.5)  # of the bodies, from the origin
    here = synthetic(h, amplitude=np.exp(1j * k * (x * np.cos(0.4) + y * np.sin(0.4))))
    H = np.array([far_field.towards(h, a) for a in angle]) * np.exp(-1j * k * (x * np.cos(angle) + y * np.sin(angle)))
    there = synthetic(far_field.modes(H), amplitude=1.0)
    assert there.absorbed_power == approx(here.absorbed_power)
    assert there.drift_force == approx(here.drift_force)
    fx, fy = here.drift_force[0]
    assert there.drift_moment == approx(here.drift_moment + x * fy - y * fx)
    assert abs(x * fy - y * fx) > 0.1 * abs(here.drift_moment[0])


def test_waves_far_off_are_not_known_unless_asked_for():
    h = bem.solve(
        (Revolution.sphere(radius=1.0, draft=1.0),),
        np.zeros((1, 3)),
        depth=np.inf,
        omega=np.array([1.0, 2.0]),
        panels=108,
    )
    with pytest.raises(InputError, match="far field"):
        h.waves(h.omega, np.ones(2), np.zeros((2, 3)))
