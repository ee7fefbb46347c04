"""Natural frequencies against closed forms and tables, with their order in the mesh."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.linalg import expm
from scipy.optimize import brentq
from scipy.sparse import csr_array

from solver.errors import InputError
from solver.structure import statics
from solver.structure.frame import Frame
from solver.structure.frame_model import assemble
from solver.structure.members import Member, PointLoad, PointMass
from solver.structure.modes import frequencies, mirror, modes, modes_in, static_remainder, symmetric_basis
from solver.structure.sections import tube, tube_shear_factor
from tests.structure.axial import pushed

LENGTH = 12.0
AXIAL, TORSION, BENDING = [0], [3], [1, 5]
# The platform's spectrum spans (ω_max / ω_1)² = 1.6e9, and eigh is backward stable: it leaves about
# 2e-16 times as much in the lowest mode.
SPREAD = 1e-6


def lowest_of(model, kind, count):
    """Lowest frequencies of a line along x, each node free in some kinds of motion only."""
    free = model.free[np.isin(model.free % 6, kind)]
    return modes(model.K, model.M, free, count).omega


def bending(beta, steel, pipe):
    """ω = β² sqrt(EI/ρA) / L²"""
    return np.square(beta) * np.sqrt(steel.E * pipe.Iz / (steel.density * pipe.area)) / LENGTH**2


def order(meshes, computed, exact):
    """Slope of log(error) over log(h)."""
    return -np.polyfit(np.log(meshes), np.log(np.array(computed) / exact - 1), 1)[0]


# Ratio of tip mass to beam mass, and the first two roots β of the characteristic equation.
TIP_MASS = [
    (0, 1.87510407, 4.69409113),
    (0.5, 1.41996443, 4.11113339),
    (1, 1.24791741, 4.03113944),
    (5, 0.87002146, 3.94998049),
]


@pytest.mark.parametrize(("ratio", "first", "second"), TIP_MASS)
def test_cantilever_with_a_tip_mass(line, steel, pipe, ratio, first, second):
    beam_mass = steel.density * pipe.area * LENGTH
    tip = (PointMass(node="end", mass=ratio * beam_mass),) if ratio else ()
    omega = lowest_of(line(16, masses=tip), BENDING, 2)
    # Error of the second mode: (βh)⁴/1440 = 5e-6.
    assert omega == pytest.approx(bending([first, second], steel, pipe), rel=1e-5)


@pytest.mark.parametrize(("clamped", "beta"), [(("start",), 4.694091132974175), (("start", "end"), 4.730040744862704)])
def test_bending_frequencies_are_fourth_order_in_the_mesh(line, steel, pipe, clamped, beta):
    meshes = [4, 8, 16]
    index = len(clamped) % 2  # second mode of the cantilever, first between two walls
    omega = [lowest_of(line(n, clamped=clamped), BENDING, 2)[index] for n in meshes]
    assert order(meshes, omega, bending(beta, steel, pipe)) == pytest.approx(4, abs=0.1)


def test_clamped_and_pinned(line, steel, pipe):
    """β = 3.926602312 by a release at the end; shapes of released ends keep the order of the mesh."""
    meshes = [4, 8, 16]
    pinned = {"clamped": ("start", "end"), "end_release": ("My", "Mz")}
    omega = [lowest_of(line(n, **pinned), BENDING, 1)[0] for n in meshes]
    assert order(meshes, omega, bending(3.926602312047919, steel, pipe)) == pytest.approx(4, abs=0.1)


def test_clamped_and_sliding(line, steel, pipe):
    model = line(16)
    slope = 6 * model.node_index["end"] + 5
    free = np.setdiff1d(model.free[np.isin(model.free % 6, BENDING)], slope)
    omega = modes(model.K, model.M, free, 2).omega
    # tan β + tanh β = 0
    assert omega == pytest.approx(bending([2.365020372, 5.497803919], steel, pipe), rel=2e-5)


def tip_body(steel, section, L, mass, inertia, lever, low, high):
    """Frequencies [rad/s] of a cantilever with a body whose c.o.g. is `lever` beyond its end.

    v = A(cos βx - cosh βx) + B(sin βx - sinh βx) with, at L, -EI v‴ = ω²m(v + d v') and
    EI v'' = ω²[m d(v + d v') + J v'], of the body's virtual work.
    """
    EI, line = steel.E * section.Iz, steel.density * section.area

    def free_end(beta):
        c, s, ch, sh = np.cos(beta * L), np.sin(beta * L), np.cosh(beta * L), np.sinh(beta * L)
        v = np.array([c - ch, s - sh])
        dv, ddv, dddv = beta * np.array([-s - sh, c - ch]), beta**2 * np.array([-c - ch, -s - sh]), 0
        dddv = beta**3 * np.array([s - sh, -c - ch])
        w2 = beta**4 * EI / line
        of_cog = v + lever * dv
        rows = [EI * dddv + w2 * mass * of_cog, EI * ddv - w2 * (mass * lever * of_cog + inertia * dv)]
        return np.linalg.det(np.array(rows) / [[beta**3 * EI], [beta**2 * EI]]) / ch

    beta = np.linspace(low, high, 2001)
    signs = np.sign([free_end(b) for b in beta])
    roots = [brentq(free_end, *beta[i : i + 2], xtol=1e-13) for i in np.flatnonzero(np.diff(signs))]
    return np.square(roots) * np.sqrt(EI / line)


@pytest.mark.parametrize("lever", [0.0, 1.5, -0.8])
def test_cantilever_with_a_tip_body_and_its_rotary_inertia(line, steel, pipe, lever):
    mass, inertia = 0.7 * steel.density * pipe.area * LENGTH, 0.2 * steel.density * pipe.area * LENGTH**3 / 3
    exact = tip_body(steel, pipe, LENGTH, mass, inertia, lever, 0.02, 0.6)[:3]
    body = PointMass(node="end", mass=mass, cog=(lever, 0, 0), inertia=(inertia,) * 3)
    assert lowest_of(line(24, masses=(body,)), BENDING, 3) == pytest.approx(exact, rel=1e-5)
    point = lowest_of(line(24, masses=(PointMass(node="end", mass=mass),)), BENDING, 3)
    assert np.all(np.abs(exact / point - 1)[1:] > 0.05)


def timoshenko(steel, section, L, low, high):
    """Frequencies [rad/s] of a cantilever, det = 0 of its exact transfer matrix between clamp and free end.

    (v, ψ, M, V)' = A (v, ψ, M, V): v' = ψ + V/κGA, ψ' = M/EI, M' = -V - ρIω²ψ, V' = -ρAω²v (Timoshenko 1921).
    """
    kGA, EI = section.shear_factor * steel.G * section.area, steel.E * section.Iz
    rA, rI = steel.density * section.area, steel.density * section.Iz

    def free_end(omega):
        w2 = omega**2
        A = np.array([[0, 1, 0, 1 / kGA], [0, 0, 1 / EI, 0], [0, -rI * w2, 0, -1], [-rA * w2, 0, 0, 0]])
        scale = np.array([1, 1 / L, EI / L**2, EI / L**3])  # of one size, or the determinant is rounding
        return np.linalg.det(expm(A * scale / scale[:, None] * L)[2:, 2:])

    omega = np.linspace(low, high, 4001)
    signs = np.array([free_end(w) for w in omega])
    return np.array([brentq(free_end, *omega[i : i + 2], xtol=1e-10) for i in np.flatnonzero(np.diff(np.sign(signs)))])


def test_a_short_thick_cantilever_converges_to_timoshenkos_frequencies(line, steel):
    L, section = 2.0, replace(tube(0.8, 0.1), shear_factor=tube_shear_factor(0.8, 0.1, steel.poisson))
    exact = timoshenko(steel, section, L, 50.0, 12000.0)[:3]
    plain = np.array([1.87510407, 4.69409113, 7.85475744]) ** 2 * np.sqrt(
        steel.E * section.Iz / (steel.density * section.area * L**4)
    )
    assert np.all(exact < [0.86, 0.6, 0.45] * plain)  # what the slender theory would be off
    meshes = np.array([8, 16, 32])
    omega = [lowest_of(line(n, end=(L, 0, 0), section=section), BENDING, 3) for n in meshes]
    error = np.array(omega) / exact - 1
    assert np.all(error > 0)
    assert error[-1] == pytest.approx(0, abs=2e-3)
    rate = -np.polyfit(np.log(meshes), np.log(error), 1)[0]
    assert rate == pytest.approx([2, 2, 2], abs=0.1)  # where φ > 1 shapes are nearly straight


def test_a_mass_on_a_light_pile_sways_on_its_foundation(line, steel, pipe):
    """ω² = 1/m f with the flexibility f = L³/3EI + L²/k_θ + 1/k_x of pile, rocking and sliding."""
    light = replace(steel, density=1e-4)
    kx, rocking = 2e7, 3e8
    flexibility = LENGTH**3 / (3 * steel.E * pipe.Iy) + LENGTH**2 / rocking + 1 / kx
    model = line(
        4, end=(0, 0, LENGTH), material=light, clamped=(), foundation={"start": (kx, kx, 1e9, rocking, rocking, 1e9)},
        masses=(PointMass(node="end", mass=5e4),),
    )  # fmt: skip
    omega = modes(model.K, model.M, model.free, 2).omega
    assert omega == pytest.approx([(5e4 * flexibility) ** -0.5] * 2, rel=1e-6)


@pytest.mark.parametrize("kind", [AXIAL, TORSION])
def test_rods_are_second_order_in_the_mesh(line, steel, pipe, kind):
    stiffness, inertia = {0: (steel.E, 1), 3: (steel.G * pipe.J, pipe.Ip)}[kind[0]]
    exact = np.pi / 2 * np.sqrt(stiffness / (steel.density * inertia)) / LENGTH
    meshes = [4, 8, 16]
    omega = [lowest_of(line(n), kind, 1)[0] for n in meshes]
    assert order(meshes, omega, exact) == pytest.approx(2, abs=0.02)
    assert omega[-1] == pytest.approx(exact, rel=np.pi**2 / 96 / 16**2 * 1.05)  # (π h / 2L)² / 24 is the leading term


@pytest.mark.parametrize("end", [(LENGTH, 0, 0), (0, 0, LENGTH), (0, 0, -LENGTH), (4.8, -9.6, 5.3665631459995)])
def test_direction_does_not_matter(line, steel, pipe, end):
    model = line(8, end=end)
    omega = modes(model.K, model.M, model.free, 2).omega
    assert omega == pytest.approx(bending([1.87510407] * 2, steel, pipe), rel=1e-5)


def test_modes_are_mass_normalised_and_of_fixed_sign(platform):
    normal = modes(platform.K, platform.M, platform.free)
    assert normal.shapes.shape == (732, 708)
    generalized = [normal.shapes.T @ matrix @ normal.shapes for matrix in (platform.M, platform.K)]
    # Plain differences: pytest.approx needs seconds for half a million numbers.
    assert np.abs(generalized[0] - np.eye(708)).max() < 1e-9
    stiffness = np.diag(normal.omega**2)
    assert np.abs(generalized[1] - stiffness).max() < 1e-9 * stiffness.max()
    clamped = np.setdiff1d(np.arange(732), platform.free)
    assert not normal.shapes[clamped].any()
    leading = normal.shapes.max(axis=0) / -normal.shapes.min(axis=0)
    assert leading.min() > 1 - 1e-6


def test_all_modes_together_are_the_static_flexibility(platform):
    load = statics.point_load(platform)
    load[platform.translations("hinge1")] += [3e4, 0, 1e4]
    every = modes(platform.K, platform.M, platform.free)
    few = modes(platform.K, platform.M, platform.free, 5)
    exact = statics.static(platform, load)
    left = static_remainder(every, load, exact)
    assert np.abs(left).max() < SPREAD * np.abs(exact).max()
    by_few = few.shapes @ (few.shapes.T @ load / few.omega**2)
    assert by_few + static_remainder(few, load, exact) == pytest.approx(exact, abs=1e-15)


def test_symmetric_modes_are_modes_of_the_whole(platform):
    basis = symmetric_basis(platform)
    assert basis.shape == (
        732,
        354,
    )  # half the 116 free nodes off the plane, 6 each, and 3 of each hinge node
    assert abs(basis.T @ basis - np.eye(354)).max() < 1e-15
    half = modes_in(basis, platform.K, platform.M)
    residual = platform.K @ half.shapes - platform.M @ half.shapes * half.omega**2
    assert np.abs(residual[platform.free]).max() < 1e-9 * abs(platform.K).max() * np.abs(half.shapes).max()
    whole = modes(platform.K, platform.M, platform.free).omega
    nearest = np.abs(whole - half.omega[:, None]).min(axis=1)
    assert (nearest / half.omega).max() < 1e-6


def test_symmetric_modes_answer_symmetric_loads_completely(platform):
    load = statics.point_load(platform)
    load[platform.translations("hinge1")] += [3e4, 0, 1e4]
    half = modes_in(symmetric_basis(platform), platform.K, platform.M)
    exact = statics.static(platform, load)
    left = static_remainder(half, load, exact)
    assert np.abs(left).max() < SPREAD * np.abs(exact).max()


def test_a_lopsided_frame_has_no_mirror(line, steel, pipe):
    assert mirror(line(3)) is not None
    assert mirror(line(3, end=(12, 1, 0))) is None
    assert symmetric_basis(line(3, end=(12, 1, 0))) is None
    nodes = {"a": (0, 1, 0), "b": (0, -1, 0), "top": (5, 0, 0)}
    members = tuple(Member(name=i, start=i, end="top", elements=2, section=pipe, material=steel) for i in ("a", "b"))
    shape = {"nodes": nodes, "members": members}
    assert mirror(assemble(Frame(**shape, clamped=("a", "b")))) is not None
    assert mirror(assemble(Frame(**shape, clamped=("a",)))) is None
    lean = (PointMass(node="b", mass=1.0),)
    assert mirror(assemble(Frame(**shape, clamped=("a",), masses=lean))) is None


@pytest.mark.parametrize("count", [1, 2, 4])
def test_nodes_at_one_place_are_each_mirrored_onto_their_own_kind(steel, pipe, count):
    """A beam across the plane of symmetry through a node that stands on it, and two braces that cross there."""
    nodes = {"a": (0, 2, 0), "b": (0, -2, 0), "c": (0, 2, 4), "d": (0, -2, 4), "on": (0, 0, 2), "foot": (3, 0, 2)}
    ends = ("a", "d"), ("b", "c"), ("a", "c"), ("b", "d"), ("foot", "on")
    members = [
        Member(name="".join(pair), start=pair[0], end=pair[1], elements=count, section=pipe, material=steel)
        for pair in ends
    ]
    model = assemble(Frame(nodes=nodes, members=tuple(members), clamped=("a", "b", "foot")))
    image = mirror(model)
    assert image is not None and abs(image @ image - np.eye(image.shape[0])).max() == 0
    assert abs(image @ model.K @ image.T - model.K).max() < 1e-9 * abs(model.K).max()


def test_count_limits_the_modes(line):
    model = line(4)
    all_of_them = modes(model.K, model.M, model.free)
    assert len(all_of_them.omega) == 24
    assert modes(model.K, model.M, model.free, 3).omega == pytest.approx(all_of_them.omega[:3])
    assert len(modes(model.K, model.M, model.free, 99).omega) == 24


def test_a_frame_beyond_its_euler_load_is_refused(line, steel, pipe):
    euler = np.pi**2 * steel.E * pipe.Iy / (4 * LENGTH**2)
    model = line(4, end=(0, 0, LENGTH), loads=(PointLoad(node="end", force=(0, 0, -1.1 * euler)),))
    softened = statics.with_geometric_stiffness(model, pushed(model, statics.point_load(model)), 9.81)
    for either in (modes, frequencies):
        with pytest.raises(InputError, match=r"must be > 0: the frame buckles"):
            either(softened.K, softened.M, softened.free)


@pytest.mark.parametrize(("stiffer", "density"), [(1e2, 10.0), (1e4, 0.01)])
def test_stiff_light_members_leave_slow_modes_as_they_are(steel, pipe, stiffer, density):
    """A mass on a nearly rigid, nearly massless arm: as on a rigid one, whose end moves by u + θ x r."""
    light = replace(steel, E=steel.E * stiffer, G=steel.G * stiffer, density=density)
    nodes = {"foot": (0, 0, 0), "top": (0, 0, 50.0), "end": (2.0, 0, 50.0)}
    leg = Member(name="leg", start="foot", end="top", elements=20, section=pipe, material=steel)
    arm = Member(name="arm", start="top", end="end", elements=4, section=pipe, material=light)
    model = assemble(
        Frame(nodes=nodes, members=(leg, arm), clamped=("foot",), masses=(PointMass(node="end", mass=1e4),))
    )
    bare = assemble(Frame(nodes={k: nodes[k] for k in ("foot", "top")}, members=(leg,), clamped=("foot",)))
    move = np.zeros((3, bare.K.shape[0]))
    top = 6 * bare.node_index["top"]
    move[:, top : top + 3], move[:, top + 3 : top + 6] = np.eye(3), -np.cross(np.eye(3), [2.0, 0, 0]).T
    exact = modes(bare.K, bare.M + csr_array(1e4 * move.T @ move), bare.free, 4).omega
    # What bends and weighs of the arm: 2e-2/stiffer; and rounding of K's largest entry, EA/L of the arm's elements,
    # beside the leg's 3EI/L³: 1e-16 * 4e6 * stiffer.
    within = 2e-2 / stiffer + 1e-9 * stiffer
    lump = PointMass(node="top", mass=1e4, cog=(2.0, 0, 0))
    lumped = assemble(replace(bare.frame, masses=(lump,)))
    assert modes(lumped.K, lumped.M, lumped.free, 4).omega == pytest.approx(exact, rel=1e-9)
    assert modes(model.K, model.M, model.free, 4).omega == pytest.approx(exact, rel=within)
    every = modes(model.K, model.M, model.free).omega
    assert every[:4] == pytest.approx(exact, rel=within)
    assert frequencies(model.K, model.M, model.free) == pytest.approx(every, rel=1e-9 * stiffer)


def test_a_pointed_cone_sways_as_published(line, steel):
    """ω = 8.719 and 21.15 (EI/ρA)^½/L² of the foot's section: a complete cone on its base (Cranch and Adler, 1956)."""
    foot, tip = tube(0.6, 0.3), tube(6e-5, 3e-5)
    unit = np.sqrt(steel.E * foot.Iz / (steel.density * foot.area)) / LENGTH**2
    omega = lowest_of(line(80, section=foot, end_section=tip), BENDING, 2) / unit
    assert omega == pytest.approx([8.719, 21.15], rel=2e-3)
