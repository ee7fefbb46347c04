"""The augmented formulation: derivatives, published mechanisms, energy, drift and order of accuracy."""

import itertools

import numpy as np
import pytest
from pytest import approx
from scipy.integrate import solve_ivp

from solver.errors import InputError, StepTooLong
from solver.multibody.chain import PRISMATIC, REVOLUTE, Chain, kinematics
from solver.reference.augmented import Body, mechanism, rotation_of, spin
from solver.reference.joints import GROUND, Ball, Frames, Guide, Hinge, constraints, equations, row_count
from solver.reference.twoloop import mechanical_energy, simulate_mechanism
from studies.validation.mechanisms import DOWN, FOUR_BAR, LIGHT, PENDULUM, four_bars, pendulum, tip

H = 1e-6


def random_frames(rng, count=3):
    q = rng.normal(size=(count, 4))
    q /= np.linalg.norm(q, axis=1, keepdims=True)
    return q, Frames(rng.normal(size=(count, 3)), rotation_of(q), rng.normal(size=(count, 6)), np.zeros((count, 6)))


def moved(q, frames, dt):
    """Frames after a time dt at constant velocity and angular velocity."""
    turned = q + dt * spin(frames.velocity[:, 3:], q) / 2
    turned /= np.linalg.norm(turned, axis=1, keepdims=True)
    return frames._replace(position=frames.position + dt * frames.velocity[:, :3], rotation=rotation_of(turned))


@pytest.mark.parametrize("seed", range(3))
def test_jacobian_and_Qd_are_derivatives(seed):
    """Ċ = J v and C̈ = J̇ v at constant velocities, for rows far from being satisfied."""
    rng = np.random.default_rng(seed)
    q, frames = random_frames(rng)
    joints = [kind(first=0, second=1, point=rng.normal(size=3)) for kind in (Ball, Hinge, Guide)]
    joints += [
        kind(first=1, second=GROUND, point=rng.normal(size=3), axis=rng.normal(size=3)) for kind in (Hinge, Guide)
    ]
    rows = equations(tuple(joints), frames)
    q, frames = random_frames(rng)  # other poses than those in which the joints were closed
    m = row_count(rows)
    assert m == 3 + 4 * 5

    def at(f):
        C, J, bias = np.empty(m), np.empty((m, 18)), np.empty(m)
        constraints(rows, f, C, J, bias)
        return C, J @ f.velocity.ravel(), bias

    (plus, rate_plus, _), (minus, rate_minus, _) = at(moved(q, frames, H)), at(moved(q, frames, -H))
    _, rate, bias = at(frames)
    # Central differences, h = 1e-6: truncation h² and rounding 1e-16/h, times values of about 10.
    assert (plus - minus) / (2 * H) == approx(rate, abs=2e-8)
    assert (rate_plus - rate_minus) / (2 * H) == approx(bias, abs=1e-7)


@pytest.mark.slow
def test_pendulum_of_the_benchmark_library():
    """A01. Its threshold is 1e-3; fourth order leaves 1.4e-6 at this step, 1e-7 at half of it."""
    _, run = pendulum(10.0, 0.02)
    middle = len(run.time) // 2
    assert run.position[middle, 0, :2] == approx(PENDULUM[5.0], abs=2e-6)
    assert run.position[-1, 0, :2] == approx(PENDULUM[10.0], abs=2e-6)


@pytest.mark.slow
def test_four_bar_passes_its_singular_positions():
    """A02, N = 2, through the flat position several times; three rotations share one DOF."""
    bodies, run = four_bars(2, 10.0, 0.01)
    assert tip(run)[-1] == approx([*FOUR_BAR, 0], abs=1e-5)  # fourth order: 1e-7 at half the step
    E = mechanical_energy(bodies, run, DOWN)
    assert np.ptp(E) < 1e-4 * 9.81


def test_what_does_not_settle_is_an_outcome():
    """A load that is another one whenever asked for moves the stages by dt² ΔF/m for ever: taken on request alone."""
    body, sizes = (Body(mass=2.0, inertia=(0.1, 0.2, 0.3), position=(0, 0, 0)),), itertools.cycle([1e-3, -1e-3, 0.0])

    def load(t, _frames):
        return np.array([[next(sizes) if t > 0 else 0.0, 0, 0, 0, 0, 0]])

    with pytest.raises(StepTooLong, match=r"does not settle in 60 iterations at t = 0\.050 s, last change .\..e-06"):
        simulate_mechanism(body, (), load, 0.2, 0.05)
    assert len(simulate_mechanism(body, (), load, 0.2, 0.05, stuck=1e-5).time) == 9


def test_what_is_not_finite_is_an_outcome():
    """A load that becomes NaN after half a second: no sample is NaN, the run ends then and says so."""
    body = (Body(mass=2.0, inertia=(0.1, 0.2, 0.3), position=(0.5, 0, 0)),)
    joint = (Hinge(first=GROUND, second=0, point=(0, 0, 0)),)
    for start, when in ((0.5, r"0\.[56]\d\d"), (0.0, r"0\.000")):
        load = {True: np.zeros((1, 6)), False: np.full((1, 6), np.nan)}
        with pytest.raises(StepTooLong, match=rf"is not finite at t = {when} s, .*: reduce time_step = 0\.05 s"):
            simulate_mechanism(body, joint, lambda t, _, start=start, load=load: load[t < start], 1.0, 0.05)


@pytest.mark.parametrize("damping", [1e5, 1e12])
def test_a_damper_too_stiff_for_the_step_is_an_outcome(damping):
    """Iterated, its change grows by about c dt/I each time: told long before it is too large for a number."""
    body = (Body(mass=2.0, inertia=(0.1, 0.2, 0.3), position=(0.5, 0, 0)),)
    joint = (Hinge(first=GROUND, second=0, point=(0, 0, 0)),)
    with pytest.raises(StepTooLong, match=r"runs away at t = 0\.050 s, last change .*: reduce time_step = 0\.05 s"):
        simulate_mechanism(body, joint, lambda _, f: -damping * f.velocity[:1] * [0, 0, 0, 0, 1, 0], 1.0, 0.05)


@pytest.mark.slow
def test_forty_four_bars():
    """A02 as published: 81 bodies; in the flat position 41 DOF, and as many multipliers too many."""
    _, run = four_bars(40, 10.0, 0.01)
    assert tip(run)[-1] == approx([0.18051223, 0.98357274, 0], abs=1e-4)  # a tenth of the library's high precision


@pytest.mark.parametrize("stages, order", [pytest.param(2, 2, marks=pytest.mark.slow), (3, 4)])
def test_order_of_accuracy(stages, order):
    swing = solve_ivp(
        lambda _, y: [y[1], -9.81 * np.sin(y[0])], (0, 1.2), [-np.pi / 2, 0], rtol=1e-12, atol=1e-12, dense_output=True
    )
    dt = np.array([0.04, 0.02, 0.01]) / (1 if stages == 3 else 4)
    error = []
    for h in dt:
        _, run = pendulum(1.2, h, stages=stages)
        x, y, _ = run.position[:, 0].T
        error.append(np.abs(np.arctan2(x, -y) - swing.sol(run.time)[0]).max())
    assert np.polyfit(np.log(dt), np.log(error), 1)[0] == approx(order, abs=0.1)


def test_constraints_do_not_drift():
    """A spinning double pendulum in space, 5 s: the two loops hold 1e-10 at all three levels."""
    bodies = (
        Body(
            mass=2.0, inertia=(0.1, 0.2, 0.3), position=(0.5, 0, 0), cog=(0.1, 0.05, 0), velocity=(0, 0, 0, 0.0, 0, 0)
        ),
        Body(mass=1.0, inertia=(0.1, 0.1, 0.05), position=(1.0, 0, -0.5)),
    )
    joints = (
        Ball(first=GROUND, second=0, point=(0, 0, 0)),
        Hinge(first=0, second=1, point=(1.0, 0, 0), axis=(0.2, 1, 0)),
    )
    run = simulate_mechanism(bodies, joints, None, 5.0, 0.05)
    assert max(run.errors) <= 1e-10
    tip = np.einsum("tij,j->ti", run.rotation[:, 0], [-0.5, 0, 0]) + run.position[:, 0]
    assert np.abs(tip).max() < 1e-9


@pytest.mark.slow
def test_constraints_do_not_drift_in_an_hour():
    """Every stage is put back on the constraints, so the gap is the tolerance's whatever the time.

    36,000 steps: the last ten minutes' largest gap is no larger than the first ten's, so a day's is not either.
    """
    body = (Body(mass=2.0, inertia=(0.1, 0.2, 0.3), position=(0.5, 0, 0), cog=(0.1, 0.05, 0)),)
    joint = (Hinge(first=GROUND, second=0, point=(0, 0, 0), axis=(0.2, 1.0, 0)),)
    run = simulate_mechanism(body, joint, None, 3600.0, 0.1)
    assert max(run.errors) <= 1e-12
    gap = np.linalg.norm(np.einsum("tij,j->ti", run.rotation[:, 0], [-0.5, 0, 0]) + run.position[:, 0], axis=1)
    first, last = gap[run.time < 600].max(), gap[run.time > 3000].max()
    assert last < 1e-11 and last <= 1.5 * first + 1e-15


@pytest.mark.slow
def test_energy_is_kept_to_the_order_of_the_scheme():
    bodies = (
        Body(mass=2.0, inertia=(0.1, 0.2, 0.3), position=(0.5, 0, 0), cog=(0.1, 0.05, 0)),
        Body(mass=1.0, inertia=(0.1, 0.1, 0.05), position=(1.0, 0, -0.5)),
    )
    joints = (Hinge(first=GROUND, second=0, point=(0, 0, 0)), Ball(first=0, second=1, point=(1.0, 0, 0)))
    lost = [np.ptp(mechanical_energy(bodies, simulate_mechanism(bodies, joints, None, 2.0, h))) for h in (0.02, 0.01)]
    assert np.log2(lost[0] / lost[1]) == approx(4, abs=0.3)


def test_spinning_body_keeps_its_angular_momentum():
    """Free in space, tumbling about its intermediate axis: H = R I Rᵀ ω."""
    body = (Body(mass=1.0, inertia=(1.0, 2.0, 3.0), position=(0, 0, 0), velocity=(0, 0, 0, 0.01, 2.0, 0.02)),)
    run = simulate_mechanism(body, (), None, 5.0, 0.02, gravity=(0, 0, 0))
    R, w = run.rotation[:, 0], run.velocity[:, 0, 3:]
    momentum = np.einsum("tij,j,tkj,tk->ti", R, np.array([1.0, 2.0, 3.0]), R, w)
    assert np.abs(momentum - momentum[0]).max() < 1e-5  # fourth order at 0.04 rad a step
    assert np.abs(R @ np.swapaxes(R, 1, 2) - np.eye(3)).max() < 1e-14


def test_a_body_seen_from_beside_its_centre_of_gravity_spins_about_that():
    """Free in space: the centre of gravity, that is at rest, stays where it is, and the origin goes round it."""
    turning, cog, place = np.array([0.3, -1.1, 2.0]), np.array([0.3, 0.2, -0.4]), np.array([1.0, 2.0, 3.0])
    start = (*-np.cross(turning, cog), *turning)
    body = (Body(mass=2.0, inertia=(1.0, 1.0, 1.0), position=tuple(place), cog=tuple(cog), velocity=start),)
    run = simulate_mechanism(body, (), None, 3.0, 0.02, gravity=(0, 0, 0))
    centre = run.position[:, 0] + run.rotation[:, 0] @ cog
    assert np.abs(centre - (place + cog)).max() < 1e-6
    assert np.ptp(run.position[:, 0], axis=0).min() > 0.3


def test_a_hinge_bears_the_moment_of_what_hangs_beside_it():
    """A weight 0.7 m along the axis: W up, and 0.7 W about x."""
    body = (Body(mass=2.0, inertia=LIGHT, position=(0, 0.7, -1.5)),)
    run = simulate_mechanism(body, (Hinge(first=GROUND, second=0, point=(0, 0, 0)),), None, 0.1, 0.05)
    assert run.joint_load[-1, 0] == approx(2 * 9.81 * np.array([0, 0, 1, 0.7, 0, 0]), abs=1e-9)


def test_hinge_force_of_a_hanging_and_a_swinging_weight():
    """At rest the hinge carries the weight; at the bottom of a 90° swing three times as much."""
    body = (Body(mass=2.0, inertia=LIGHT, position=(0, 0, -1.5)),)
    joint = (Hinge(first=GROUND, second=0, point=(0, 0, 0)),)
    at_rest = simulate_mechanism(body, joint, None, 0.1, 0.05)
    assert at_rest.joint_load[-1, 0] == approx([0, 0, 2 * 9.81, 0, 0, 0], abs=1e-9)
    _, run = pendulum(1.0, 0.01)
    assert run.joint_load[:, 0, 1].max() == approx(3 * 9.81, rel=1e-4)  # the samples miss the lowest point a little


def test_guide_lets_a_body_fall_along_its_axis_only():
    axis = np.array([0.6, 0.0, 0.8])
    body = (Body(mass=3.0, inertia=(1.0, 2.0, 3.0), position=(1, 2, 3), cog=(0.3, 0.2, 0.1)),)
    joint = (Guide(first=GROUND, second=0, point=(0.5, 0, 0), axis=tuple(axis)),)
    run = simulate_mechanism(body, joint, None, 1.0, 0.1)
    way = -0.5 * 9.81 * 0.8 * run.time**2
    assert run.position[:, 0] == approx([1, 2, 3] + way[:, None] * axis, abs=1e-9)
    # What the guide holds: the weight's part across the axis, and its moment about the joint's point.
    force = 3 * 9.81 * (np.array([0, 0, 1]) - 0.8 * axis)
    assert run.joint_load[-1, 0, :3] == approx(force, abs=1e-8)


def test_moving_support_drives_a_hinged_body_as_the_minimal_chain_has_it():
    """A float's arm on a node that shakes in x, z and pitch: same angle as minimal coordinates, to 1e-8.

    Reference: one equation for the joint, Jᵀ(M a - f) = 0 with the chain's J and bias, integrated to 1e-12.
    """
    hinge, arm, inertia, mass = np.array([-1.5, 0, 2.6]), np.array([-2.36, 0, -2.6]), 859.0, 2147.0
    size, rate, phase = np.array([0.3, 0.1, 0.05]), np.array([1.1, 2.3, 1.7]), np.array([0.2, 1.0, 2.0])

    def node(t):
        a = rate * t + phase
        return size * (np.sin(a) - np.sin(phase)), size * rate * np.cos(a), -size * rate**2 * np.sin(a)

    def support(t):
        y, dy, ddy = node(t)
        c, s = np.cos(y[2]), np.sin(y[2])
        R = np.array([[c, 0, s], [0, 1, 0], [-s, 0, c]])
        six = np.zeros((2, 6))
        six[:, [0, 2, 4]] = dy, ddy
        return np.add(hinge, [y[0], 0, y[1]]), R, *six

    chain = Chain(
        np.array([PRISMATIC, PRISMATIC, REVOLUTE, REVOLUTE]),
        np.array([[1.0, 0, 0], [0, 0, 1], [0, 1, 0], [0, 1, 0]]),
        np.tile(hinge, (4, 1)),
        np.arange(4),
    )
    M = np.diag([mass] * 3 + [1.0, inertia, 1.0])

    def swing(t, y):
        node_at, node_rate, node_acceleration = node(t)
        out = np.empty(3), np.empty((3, 3)), np.empty((6, 4)), np.empty(6), np.empty(6)
        kinematics(chain, hinge + arm, np.append(node_at, y[0]), np.append(node_rate, y[1]), *out)
        J, bias = out[2], out[4]
        free = M @ (J[:, :3] @ node_acceleration + bias) + [0, 0, 9.81 * mass, 0, 0, 0]
        return [y[1], -(J[:, 3] @ free) / (J[:, 3] @ M @ J[:, 3])]

    start_rate = node(0.0)[1]
    out = np.empty(3), np.empty((3, 3)), np.empty((6, 4)), np.empty(6), np.empty(6)
    kinematics(chain, hinge + arm, np.zeros(4), np.append(start_rate, 0.0), *out)
    body = (Body(mass=mass, inertia=(1.0, inertia, 1.0), position=tuple(hinge + arm), velocity=tuple(out[3])),)
    run = simulate_mechanism(
        body, (Hinge(first=1, second=0, point=tuple(hinge)),), None, 2.0, 0.005, supports=(support,)
    )
    exact = solve_ivp(swing, (0, 2.0), [0.0, 0.0], rtol=1e-11, atol=1e-12).y[0, -1]
    relative = support(2.0)[1].T @ run.rotation[-1, 0]
    assert np.arctan2(relative[0, 2], relative[0, 0]) == approx(exact, abs=1e-8)


def test_bad_mechanisms_are_refused():
    with pytest.raises(InputError, match="mass = 0"):
        Body(mass=0.0, inertia=LIGHT, position=(0, 0, 0))
    body = Body(mass=1.0, inertia=LIGHT, position=(0, 0, 0))
    with pytest.raises(InputError, match="zero length"):
        mechanism((body,), (Hinge(first=GROUND, second=0, point=(0, 0, 0), axis=(0, 0, 0)),), Frames(
            np.zeros((0, 3)), np.zeros((0, 3, 3)), np.zeros((0, 6)), np.zeros((0, 6))), gravity=DOWN)  # fmt: skip
    with pytest.raises(InputError, match="stages = 4"):
        pendulum(0.1, 0.01, stages=4)
