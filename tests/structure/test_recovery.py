"""Section forces of beam theory at every node, and the stress of the worst fibre."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from solver.structure import recovery, statics
from solver.structure.legs import compressive
from solver.structure.members import PointLoad, PointMass
from solver.structure.sections import solid_rectangle

W = 9.81


def weight_forces(model):
    displacement = statics.static(model, statics.gravity_load(model, W))
    return recovery.section_forces(model, displacement, statics.self_weight(model, W)).reshape(-1, 2, 6)


@pytest.mark.parametrize("n", [1, 2, 7])
def test_own_weight_of_a_cantilever(line, pipe, steel, n):
    forces = weight_forces(line(n))
    w = steel.density * pipe.area * W
    x = 12 * np.arange(n + 1) / n
    at = np.column_stack([x[:-1], x[1:]])
    # Face +x at x carries the weight of the part beyond: V_z = -(-w (L - x)), M_y = +w (L - x)²/2.
    assert forces[:, :, 2] == pytest.approx(-w * (12 - at), abs=1e-5)
    assert forces[:, :, 4] == pytest.approx(w * (12 - at) ** 2 / 2, abs=1e-5)
    assert forces[:, :, [0, 1, 3, 5]] == pytest.approx(0, abs=1e-5)


@pytest.mark.parametrize("n", [1, 3])
def test_column_carries_its_top_and_itself(line, pipe, steel, n):
    forces = weight_forces(line(n, end=(0, 0, 12), masses=(PointMass(node="end", mass=4e4),)))
    column_mass = steel.density * pipe.area * 12
    assert forces[0, 0, 0] == pytest.approx(-(4e4 + column_mass) * W)
    assert forces[-1, 1, 0] == pytest.approx(-4e4 * W)


def test_tip_load_gives_shear_and_moments_by_their_signs(line):
    model = line(4, loads=(PointLoad(node="end", force=(7e3, 2e3, 3e3)),))
    displacement = statics.static(model, statics.point_load(model))
    root = (recovery.section_force_matrix(model) @ displacement).reshape(-1, 6)[0]
    # Moments about the root of the forces on the part beyond: r × F, r = (12, 0, 0).
    assert root == pytest.approx([7e3, 2e3, 3e3, 0, -36e3, 24e3], abs=1e-4)


def test_neighbours_agree_where_no_load_acts(platform):
    load = statics.point_load(platform)
    load[platform.translations("hinge1")] += [3e4, 1e3, 1e4]
    forces = recovery.section_force_matrix(platform) @ statics.static(platform, load)
    leg = forces.reshape(-1, 2, 6)[platform.member_elements["leg1"]]
    assert leg[1:, 0] == pytest.approx(leg[:-1, 1], abs=1e-7 * np.abs(leg).max())


def test_rigid_motion_gives_no_section_force(platform):
    S = recovery.section_force_matrix(platform)
    scale = abs(platform.K).max()
    for axis in range(3):
        shift = np.tile(np.eye(6)[axis], len(platform.xyz))
        turns = np.tile(np.eye(3)[axis], (len(platform.xyz), 1))
        turn = np.hstack([np.cross(np.eye(3)[axis], platform.xyz), turns]).ravel()
        assert np.abs(S @ shift).max() < 1e-13 * scale
        assert np.abs(S @ turn).max() < 1e-13 * scale * 50  # arms up to 50 m


def compressive_stress(model, forces):
    A, Iy, Iz, c = recovery.section_properties(model).T
    return compressive(forces[..., [0, 4, 5]] / np.stack([A, Iy / c, Iz / c], axis=-1))


def test_stress_of_a_bent_pipe_is_the_closed_form(line, pipe):
    model = line(1)
    forces = np.tile([-2e5, 0, 0, 5e4, 3e4, -4e4], (2, 1))
    expected = -2e5 / pipe.area - 5e4 * 0.225 / pipe.Iy
    assert compressive_stress(model, forces) == pytest.approx([expected, expected])
    # and for a record of them, time first
    record = np.stack([forces, 2 * forces, 0 * forces])
    assert compressive_stress(model, record)[:, 0] == pytest.approx([expected, 2 * expected, 0])


@given(My=st.floats(-1e5, 1e5), Mz=st.floats(-1e5, 1e5))
def test_rectangles_are_on_the_safe_side_of_their_corner(line, My, Mz):
    b, h = 0.3, 0.2
    model = line(1, section=solid_rectangle(width=b, height=h))
    stress = compressive_stress(model, np.tile([0, 0, 0, 0, My, Mz], (2, 1)))[0]
    corner = -(abs(My) * h / 2 / (b * h**3 / 12) + abs(Mz) * b / 2 / (h * b**3 / 12))
    assert stress <= corner * (1 - 1e-12) + 1e-6
    # Never more than the whole diagonal in the place of the shorter half side.
    assert abs(stress) <= abs(corner) * np.hypot(b, h) / min(b, h) * (1 + 1e-12) + 1e-6
