"""Kinematics of a chain against finite differences and rigid-body identities."""

import numpy as np
import pytest

from solver.multibody.chain import PRISMATIC, REVOLUTE, Chain, kinematics

H = 1e-6


def random_chain(rng, n=7):
    axes = rng.normal(size=(n, 3))
    return Chain(
        rng.integers(0, 2, n),
        axes / np.linalg.norm(axes, axis=1, keepdims=True),
        rng.normal(size=(n, 3)),
        np.arange(n),
    )


def at(chain, reference, y, dy):
    n = chain.kind.size
    out = np.empty(3), np.empty((3, 3)), np.empty((6, n)), np.empty(6), np.empty(6)
    kinematics(chain, reference, y, dy, *out)
    return out


@pytest.mark.parametrize("seed", range(5))
def test_velocity_and_bias_are_derivatives(seed):
    rng = np.random.default_rng(seed)
    chain, reference = random_chain(rng), rng.normal(size=3)
    y, dy = rng.normal(size=7), rng.normal(size=7)
    _, R, J, velocity, bias = at(chain, reference, y, dy)
    (p1, R1, _, v1, _), (p0, R0, _, v0, _) = (at(chain, reference, y + s * H * dy, dy) for s in (1, -1))
    spin = (R1 - R0) / (2 * H) @ R.T
    # Central differences with h = 1e-6: truncation h² and rounding 1e-16/h, both well below 1e-7.
    assert np.abs((p1 - p0) / (2 * H) - velocity[:3]).max() < 1e-7
    assert np.abs([spin[2, 1], spin[0, 2], spin[1, 0]] - velocity[3:]).max() < 1e-7
    assert np.abs((v1 - v0) / (2 * H) - bias).max() < 1e-7
    assert np.abs(J @ dy - velocity).max() < 1e-12
    assert np.abs(R @ R.T - np.eye(3)).max() < 1e-14


def test_hinge_keeps_its_point_and_length():
    chain = Chain(np.array([REVOLUTE]), np.array([[0, 1.0, 0]]), np.array([[-1.5, 0, 2.6]]), np.array([0]))
    arm = np.array([-2.36, 0, -2.6])
    for angle in (-1.2, 0.3, 2.0):
        position, R, *_ = at(chain, chain.point[0] + arm, np.array([angle]), np.ones(1))
        assert np.abs(position - R @ arm - chain.point[0]).max() < 1e-14


def test_positive_rotation_lifts_a_float_on_the_weather_side():
    chain = Chain(np.array([REVOLUTE]), np.array([[0, 1.0, 0]]), np.array([[0, 0, 2.6]]), np.array([0]))
    position, *_ = at(chain, np.array([-2.36, 0, 0]), np.array([0.1]), np.zeros(1))
    assert position[2] > 0.2


def test_guide_moves_along_its_axis_alone():
    chain = Chain(np.array([PRISMATIC]), np.array([[0, 0, 1.0]]), np.zeros((1, 3)), np.array([0]))
    position, R, J, _, bias = at(chain, np.array([4.0, 0, 0]), np.array([0.7]), np.array([2.0]))
    assert np.array_equal(position, [4, 0, 0.7]) and np.array_equal(R, np.eye(3))
    assert np.array_equal(J[:, 0], [0, 0, 1, 0, 0, 0]) and not bias.any()
