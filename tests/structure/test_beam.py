"""One element: equilibrium, exact integrals, section constants."""

import operator
from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from solver.errors import InputError
from solver.structure import beam, sections

L, E, G, RHO = 3.7, 2.1e11, 8.33e10, 7850.0
PIPE = sections.tube(diameter=0.45, thickness=0.012)
PLANK = sections.solid_rectangle(width=0.3, height=0.1)
SHEARING = replace(PLANK, shear_factor=0.02)  # far from Euler-Bernoulli, and not alike in both planes
PHI = beam.shear_parameters(E, G, SHEARING, L)
ROUNDING = 1e-12  # relative to the largest entry; sums of 12 terms lose 1-2 digits of 16


def integral(function):
    """∫ over the element by six Gauss points, exact for every polynomial that occurs here."""
    node, weight = np.polynomial.legendre.leggauss(6)
    return sum(w * L / 2 * function((s + 1) / 2) for s, w in zip(node, weight, strict=True))


def rigid_motions(x):
    """Three shifts and three turns, (12, 6), of an element with its ends at x (2, 3)."""
    motions = np.zeros((2, 6, 6))
    for end in range(2):
        motions[end, :3, :3] = motions[end, 3:, 3:] = np.eye(3)
        motions[end, :3, 3:] = np.cross(np.eye(3), x[end]).T
    return motions.reshape(12, 6)


@pytest.mark.parametrize("section", [PIPE, PLANK, SHEARING])
@pytest.mark.parametrize("end", [(3, 2, 1), (0, 0, 3.7), (0, 0, -3.7), (-1, 0, 0), (1e-9, 0, 2)])
def test_rigid_motions_give_no_force(section, end):
    T = beam.to_global(beam.rotation((0, 0, 0), end))
    length = np.linalg.norm(end)
    K = T.T @ beam.stiffness(E, G, section, length) @ T
    forces = K @ rigid_motions(np.array([(0, 0, 0), end], float))
    assert np.abs(forces).max() < ROUNDING * np.abs(K).max() * length


@pytest.mark.parametrize("section", [PLANK, SHEARING])
def test_stiffness_has_six_elastic_motions_and_six_rigid_ones(section):
    scale = np.tile([1, 1, 1, 1 / L, 1 / L, 1 / L], 2)  # metres for all, or the ranks mix units
    values = np.linalg.eigvalsh(beam.stiffness(E, G, section, L) * np.outer(scale, scale))
    assert np.abs(values[:6]).max() < ROUNDING * values[-1]
    assert values[6] > 1e-6 * values[-1]


def test_mass_is_the_integral_of_the_shape_functions():
    by_shapes = integral(lambda s: RHO * PIPE.area * beam.displacement_shape(s, L).T @ beam.displacement_shape(s, L))
    twist = integral(lambda s: RHO * PIPE.Ip * np.outer(beam.rotation_shape(s, L)[0], beam.rotation_shape(s, L)[0]))
    M = beam.mass(RHO, PIPE, L)
    assert pytest.approx(M, abs=ROUNDING * M.max()) == by_shapes + twist


def test_a_shearing_beams_mass_is_the_integral_of_its_shapes_and_rotations():
    A, j = RHO * SHEARING.area, RHO * np.diag([SHEARING.Ip, SHEARING.Iy, SHEARING.Iz])

    def moving(s):
        shift, turn = beam.displacement_shape(s, L, PHI), beam.rotation_shape(s, L, PHI)
        return A * shift.T @ shift + turn.T @ j @ turn

    M = beam.mass(RHO, SHEARING, L, PHI)
    assert pytest.approx(M, abs=ROUNDING * M.max()) == integral(moving)


def test_a_shearing_beams_stiffness_is_its_energy_in_bending_and_shear():
    """∫ EI ψ'² + κGA (v' - ψ)² dx in both planes; slopes by differences that are exact for cubics and parabolas."""
    h, one = 0.5, SHEARING

    def strained(s):
        shift = [beam.displacement_shape(s + k * h, L, PHI) for k in (-2, -1, 1, 2)]
        slope = (shift[0] - 8 * shift[1] + 8 * shift[2] - shift[3]) / (12 * h * L)
        turn = beam.rotation_shape(s, L, PHI)
        bent = (beam.rotation_shape(s + h, L, PHI) - beam.rotation_shape(s - h, L, PHI)) / (2 * h * L)
        sheared = [slope[1] - turn[2], slope[2] + turn[1]]
        kGA = one.shear_factor * G * one.area
        parts = [
            (E * one.area, slope[0]), (G * one.J, bent[0]), (E * one.Iy, bent[1]), (E * one.Iz, bent[2]),
            (kGA, sheared[0]), (kGA, sheared[1]),
        ]  # fmt: skip
        return sum(size * np.outer(of, of) for size, of in parts)

    K = beam.stiffness(E, G, one, L)
    assert pytest.approx(integral(strained), abs=ROUNDING * K.max()) == K
    assert min(PHI) > 0.01
    assert PHI[0] == pytest.approx(9 * PHI[1])


@pytest.mark.parametrize("shear", [beam.NO_SHEAR, PHI])
def test_geometric_stiffness_is_the_integral_of_the_slopes(shear):
    h = 0.5  # differences that are exact for cubics

    def slopes(s):
        shift = [beam.displacement_shape(s + k * h, L, shear)[1:] for k in (-2, -1, 1, 2)]
        slope = (shift[0] - 8 * shift[1] + 8 * shift[2] - shift[3]) / (12 * h * L)
        return -7e4 * slope.T @ slope

    Kg = beam.geometric_stiffness((-7e4, -7e4), L, shear)
    assert pytest.approx(integral(slopes), abs=ROUNDING * np.abs(Kg).max()) == Kg
    Kg = beam.geometric_stiffness((0.0, -7e4), L, shear)
    assert pytest.approx(integral(lambda s: s * slopes(s)), abs=ROUNDING * np.abs(Kg).max()) == Kg


def test_an_unyielding_section_is_euler_bernoullis_with_rotary_inertia():
    """κ -> ∞: stiffness and shapes are the old ones, the mass has ∫ρI v'² besides."""
    stiff = replace(PLANK, shear_factor=1e14)
    phi = beam.shear_parameters(E, G, stiff, L)
    K = beam.stiffness(E, G, PLANK, L)
    assert beam.stiffness(E, G, stiff, L) == pytest.approx(K, abs=ROUNDING * K.max())
    assert beam.displacement_shape(0.3, L, phi) == pytest.approx(beam.displacement_shape(0.3, L), abs=ROUNDING)
    rotary = RHO * np.diag([0, PLANK.Iy, PLANK.Iz])
    turning = integral(lambda s: beam.rotation_shape(s, L).T @ rotary @ beam.rotation_shape(s, L))
    M = beam.mass(RHO, PLANK, L)
    assert beam.mass(RHO, stiff, L, phi) == pytest.approx(M + turning, abs=ROUNDING * M.max())


# Cowper (1966), Table 1, for ν = 0, 0.3 and 0.5: circle, thin-walled round tube, rectangle.
@pytest.mark.parametrize(
    ("poisson", "circle", "thin", "rectangle"),
    [(0.0, 0.857, 0.500, 0.833), (0.3, 0.886, 0.531, 0.850), (0.5, 0.900, 0.545, 0.857)],
)
def test_shear_factors_are_cowpers(poisson, circle, thin, rectangle):
    assert sections.tube_shear_factor(2.0, 1.0, poisson) == pytest.approx(circle, abs=6e-4)
    assert sections.tube_shear_factor(2.0, 1e-5, poisson) == pytest.approx(thin, abs=6e-4)
    assert sections.rectangle_shear_factor(poisson) == pytest.approx(rectangle, abs=6e-4)


def test_rotations_are_the_derivatives_of_displacements():
    s, h = 0.3, 1e-5
    ahead, behind = (beam.displacement_shape(s + step, L) for step in (h, -h))
    slope = (ahead - behind) / (2 * h * L)
    # Central difference of a cubic: error h²/6 times its third derivative (12), far below 1e-8.
    assert beam.rotation_shape(s, L)[2] == pytest.approx(slope[1], abs=1e-8)
    assert beam.rotation_shape(s, L)[1] == pytest.approx(-slope[2], abs=1e-8)


@pytest.mark.parametrize(("s", "first"), [(0.0, 0), (1.0, 6)])
def test_shapes_at_the_ends_are_the_end_displacements(s, first):
    for shear in (beam.NO_SHEAR, PHI):
        assert beam.displacement_shape(s, L, shear) == pytest.approx(np.eye(12)[first : first + 3])
        assert beam.rotation_shape(s, L, shear) == pytest.approx(np.eye(12)[first + 3 : first + 6])


@given(
    s=st.floats(0, 1),
    end=st.tuples(*[st.floats(-9, 9)] * 3).filter(lambda p: np.hypot(*p[:2]) + abs(p[2]) > 0.1),
)
def test_shapes_reproduce_rigid_motions_in_any_direction(s, end):
    start = np.array([1.0, -2.0, 0.5])
    x = np.array([start, start + end])
    shape = beam.in_global(beam.displacement_shape(s, np.linalg.norm(end), PHI), beam.to_global(beam.rotation(*x)))
    at = x[0] + s * np.array(end)
    expected = np.hstack([np.eye(3), np.cross(np.eye(3), at).T])
    assert shape @ rigid_motions(x) == pytest.approx(expected, abs=1e-12 * 100)  # arms up to 20 m, squared


@given(end=st.tuples(*[st.floats(-9, 9)] * 3).filter(lambda p: np.linalg.norm(p) > 1e-3))
def test_local_axes_are_a_right_handed_frame(end):
    R = beam.rotation((0, 0, 0), end)
    assert pytest.approx(np.eye(3), abs=1e-12) == R @ R.T
    assert np.linalg.det(R) == pytest.approx(1)
    assert R[0] == pytest.approx(np.array(end) / np.linalg.norm(end))


def test_a_horizontal_plank_lies_flat_and_a_vertical_one_is_wide_along_y():
    assert beam.rotation((0, 0, 0), (2, 1, 0))[2] == pytest.approx([0, 0, 1])
    assert beam.rotation((0, 0, 0), (0, 0, 5))[1] == pytest.approx([0, 1, 0])
    assert beam.rotation((0, 0, 5), (0, 0, 0))[1] == pytest.approx([0, 1, 0])


def test_uniform_load_has_the_fixed_end_moments_of_the_handbook():
    w = 1300.0
    load = beam.distributed_load(np.array([0, w, w]), L)
    half, moment = w * L / 2, w * L**2 / 12
    assert load == pytest.approx([0, half, half, 0, -moment, moment, 0, half, half, 0, moment, -moment])


@given(s0=st.floats(0, 1), s1=st.floats(0, 1))
def test_load_on_parts_adds_up_to_the_load_on_the_whole(s0, s1):
    q = np.array([10.0, -20.0, 30.0])
    cuts = [0.0, *sorted((s0, s1)), 1.0]
    for shear in (beam.NO_SHEAR, PHI):
        parts = sum(beam.distributed_load(q, L, span, shear) for span in pairwise(cuts))
        assert parts == pytest.approx(beam.distributed_load(q, L, shear=shear), abs=1e-11)


def test_tube_is_the_difference_of_two_rods():
    outer, inner = (sections.tube(diameter=d, thickness=d / 2) for d in (0.45, 0.426))
    for name in ("area", "Iy", "Iz", "J", "Ip"):
        assert getattr(PIPE, name) == pytest.approx(getattr(outer, name) - getattr(inner, name))
    assert (PIPE.fibre, PIPE.diameter) == (0.225, 0.45)


@pytest.mark.parametrize(
    "section, solid, holes",
    [
        (sections.box(0.4, 0.6, 0.05), (0.4, 0.6), [(0.3, 0.5, 0.0)]),
        (sections.i_beam(0.4, 0.6, 0.05, 0.03), (0.4, 0.6), [(0.185, 0.5, 0.1075), (0.185, 0.5, -0.1075)]),
    ],
)
def test_sections_of_plates_are_rectangles_less_rectangles(section, solid, holes):
    """Holes by width, height and y of their middle."""
    b, h = solid
    assert section.area == pytest.approx(b * h - sum(w * t for w, t, _ in holes), rel=1e-12)
    assert section.Iy == pytest.approx((b * h**3 - sum(w * t**3 for w, t, _ in holes)) / 12, rel=1e-12)
    assert section.Iz == pytest.approx(
        b**3 * h / 12 - sum(w**3 * t / 12 + w * t * y**2 for w, t, y in holes), rel=1e-12
    )
    assert section.Ip == pytest.approx(section.Iy + section.Iz) and section.fibre == pytest.approx(np.hypot(b, h) / 2)
    assert {(abs(y), abs(z)) for y, z in section.fibres} == {(b / 2, h / 2)} and len(section.fibres) == 4


def test_torsion_of_thin_walls():
    """Closed: a square tube of side a has J = a³t, as far as t is small; open: strips one beside another."""
    torsion = operator.attrgetter("J")
    for t in (1e-2, 1e-3):
        assert torsion(sections.box(1 + t, 1 + t, t)) == pytest.approx(t, rel=2 * t)
    strips = sum(torsion(sections.solid_rectangle(a, b)) for a, b in ((0.4, 0.004), (0.4, 0.004), (0.6, 0.003)))
    assert torsion(sections.i_beam(0.4, 0.6, 0.004, 0.003)) == pytest.approx(strips, rel=0.01)


def test_a_general_section_is_what_is_said_of_it():
    box = sections.box(0.4, 0.6, 0.05)
    same = sections.general(area=box.area, Iy=box.Iy, Iz=box.Iz, J=box.J, fibres=box.corners, wall=0.05)
    assert same == box
    assert sections.general(0.1, 1e-3, 2e-3, 1e-3, [(0.0, 0.5), (0.1, -0.2)], 0.02, 1.2).fibre == 0.5


def test_second_moments_are_the_integrals_over_the_section():
    """Iy = ∫z² dA, Iz = ∫y² dA: width along y, height along z."""
    b, h, R = 0.3, 0.1, 0.2
    assert (PLANK.Iy, PLANK.Iz) == pytest.approx((b * h**3 / 12, h * b**3 / 12))
    rod = sections.tube(diameter=2 * R, thickness=R)
    assert (rod.Iy, rod.Iz, rod.J) == pytest.approx(np.pi * R**4 * np.array([1 / 4, 1 / 4, 1 / 2]))


# Timoshenko & Goodier, Theory of Elasticity: J = k1 a b³, printed to three or four digits.
@pytest.mark.parametrize(("ratio", "k1"), [(1, 0.1406), (1.5, 0.196), (2, 0.229), (3, 0.263), (10, 0.312)])
def test_torsion_of_rectangles_is_timoshenkos(ratio, k1):
    tall = sections.solid_rectangle(width=0.2, height=0.2 * ratio)
    flat = sections.solid_rectangle(width=0.2 * ratio, height=0.2)
    assert tall.J / (ratio * 0.2**4) == pytest.approx(k1, abs=6e-4)
    assert flat.J == tall.J


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: sections.tube(diameter=-1, thickness=0.1), r"section.diameter = -1: must be > 0 m"),
        (lambda: sections.tube(diameter=1, thickness=0), r"section.thickness = 0: must be > 0 m"),
        (
            lambda: sections.tube(diameter=1, thickness=0.6),
            r"section.thickness = 0.6: must be <= .* 0.5 m",
        ),
        (lambda: sections.solid_rectangle(width=float("nan"), height=1), r"section.width = nan"),
        (lambda: sections.box(0.4, 0.6, 0.2), r"section.thickness = 0.2: must be < half the smaller side, 0.2 m"),
        (lambda: sections.i_beam(0.4, 0.6, 0.3, 0.1), r"section.flange = 0.3: must be < half the height"),
        (lambda: sections.i_beam(0.4, 0.6, 0.1, 0.5), r"section.web = 0.5: must be <= the width"),
        (lambda: sections.solid_rectangle(width=1, height=float("inf")), r"section.height = inf"),
        (lambda: replace(PIPE, shear_factor=0.0), r"section.shear_factor = 0.0: must be > 0"),
    ],
)
def test_bad_sections_are_refused(make, message):
    with pytest.raises(InputError, match=message):
        make()


@pytest.mark.parametrize(
    ("make", "first", "last"),
    [
        (sections.tube, (0.6, 0.02), (0.3, 0.01)),
        (sections.solid_rectangle, (0.4, 0.2), (0.3, 0.3)),
        (sections.box, (0.4, 0.3, 0.02), (0.2, 0.2, 0.01)),
        (sections.i_beam, (0.2, 0.3, 0.02, 0.01), (0.2, 0.6, 0.02, 0.02)),
    ],
)
def test_a_taper_goes_straight_from_one_section_to_the_other(make, first, last):
    ends = make(*first), replace(make(*last), shear_factor=0.5)
    assert sections.between(*ends, 0.25) == make(*(0.75 * np.array(first) + 0.25 * np.array(last)))
    ends = replace(ends[0], shear_factor=0.9), ends[1]
    assert [sections.between(*ends, share) for share in (0, 1)] == list(ends)
    assert sections.between(*ends, 0.25).shear_factor == pytest.approx(0.8)
