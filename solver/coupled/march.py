"""The time loop: Lobatto IIIA collocation, fourth order and A-stable, on the coupled system.

A step of length dt has its collocation points at 0, ½ and 1, so records are uniform with dt/2
and meet the equations of motion at every sample. Stage values from stage accelerations a:
    v_s = v₀ + dt Σ A_sj a_j,    q_s = q₀ + dt Σ A_sj v_j,    A = [5 8 -1; 4 16 4]/24.
Each step is solved by Newton's method with the matrix of the step's start. The structure's
modes are eliminated exactly by their flexibility at the hinge nodes, however many there are
and however stiff; the radiation memory is exact for velocities quadratic in time.
"""

from typing import NamedTuple

import numpy as np

from solver.kernels import fast_lean_kernel, kernel, lean_kernel
from solver.multibody.minimal import (
    loads,
    mass_matrix,
    move,
    new_motion,
    powers,
    pressures,
    project_active,
    stored_energy,
)

A0 = np.array([5 / 24, 1 / 6])  # weight of the step's start
A = np.array([[8 / 24, -1 / 24], [4 / 6, 1 / 6]])  # weights of the stages ½ and 1
C = np.array([0.5, 1.0])
AA0, AA = A @ A0, A @ A
SIMPSON = np.array([1 / 6, 4 / 6, 1 / 6])

REFRESH = 8  # steps that share Newton's matrix while it serves
WATCH = 8  # steps after which the energy balance is looked at
# Pressure and drag are evaluated again where a stage has moved by so many tolerances since; nearer than that
# the hydrostatic stiffness stands for the change, and what is left of it, (dt ω)²/5, is below the tolerance.
NEAR = 25.0

OK, NOT_CONVERGED, EXCURSION, NOT_FINITE, UNBALANCED = 0, 1, 2, 3, 4
GROSSLY = 0.1  # of the wave's work, by which the energy balance is never open
# Work [J] of: pressure and excitation, radiation memory, PTO, other damping of the joints,
# wave inertia on the frame, drag on the frame, structural damping.
WORKS = ("wave", "radiation", "pto", "joint_damping", "frame_inertia", "frame_drag", "structural")


class Structure(NamedTuple):
    """Modes of the support and its drag stations; all empty for a fixed support."""

    omega: np.ndarray  # (nm,) [rad/s]
    damping: np.ndarray  # (nm,) ratio
    carrier: np.ndarray  # (nc, nm) carrier coordinates of unit modal amplitude
    station: np.ndarray  # (nm, nd, ns) normal displacement at the drag stations
    drag: np.ndarray  # (ns,) ½ρ C_D D times length [kg/m]
    scale: np.ndarray  # (nm,) largest displacement of unit amplitude, for convergence


class Memory(NamedTuple):
    """Radiation memory for one step length: see solver.hydrodynamics.radiation.memory."""

    residue: np.ndarray  # (p, na, na) complex
    decay: np.ndarray  # (2, p) complex exp(β c dt)
    weight: np.ndarray  # (2, 3, p) complex, stage s from velocities at 0, ½, 1
    direct: np.ndarray  # (2, 2, na, na) load at stage s from velocity at stage j


class Drive(NamedTuple):
    """Samples of all that the wave drives; first axis time, samples dt/2 apart."""

    field: np.ndarray  # (m, nb, 2, terms)
    excitation: np.ndarray  # (m, nb, 6)
    modal: np.ndarray  # (m, nm)
    station: np.ndarray  # (m, nd, ns) particle velocity normal to the members


class State(NamedTuple):
    """What one step hands to the next; arrays are updated in place."""

    z: np.ndarray  # (nj,) joint coordinates
    dz: np.ndarray  # (nj,)
    ddz: np.ndarray  # (3, nj) at the last three samples, newest last
    p: np.ndarray  # (nm,) modal amplitudes
    dp: np.ndarray  # (nm,)
    ddp: np.ndarray  # (nm,)
    force: np.ndarray  # (3, nm) drag and hinge part of the modal load, last three samples
    memory: np.ndarray  # (p, na) complex
    power: np.ndarray  # (len(WORKS),) at the last sample
    work: np.ndarray  # (len(WORKS),) [J] since the start
    energy: np.ndarray  # (3,) [J] stored at the start, scale of what has been exchanged since, gap soon after the start


class Output(NamedTuple):
    """Samples after the first: row i belongs to sample i + 1 of the drive."""

    z: np.ndarray  # (m, nz) carriers, then joints
    dz: np.ndarray  # (m, nz)
    p: np.ndarray  # (m, nm)
    wrench: np.ndarray  # (m, nb, 6) load of each float on its hinge node's side [N, N m]


@lean_kernel(inline="always")
def _copy(source, target):
    """target <- source (n,); numba's own assignment allocates, should the two overlap."""
    for i in range(target.size):
        target[i] = source[i]


@lean_kernel
def _factor(K, pivot):
    """LU factors of K in place, rows exchanged; False when singular."""
    n = K.shape[0]
    for k in range(n):
        best = k
        for i in range(k + 1, n):
            if abs(K[i, k]) > abs(K[best, k]):
                best = i
        pivot[k] = best
        if not abs(K[best, k]) > 0:
            return False
        if best != k:
            for j in range(n):
                K[k, j], K[best, j] = K[best, j], K[k, j]
        for i in range(k + 1, n):
            factor = K[i, k] / K[k, k]
            K[i, k] = factor
            if factor != 0:
                for j in range(k + 1, n):
                    K[i, j] -= factor * K[k, j]
    return True


@lean_kernel
def _substitute(K, pivot, b):
    """b <- K⁻¹ b with the factors of `_factor`."""
    n = K.shape[0]
    for k in range(n):
        best = pivot[k]
        if best != k:
            b[k], b[best] = b[best], b[k]
    for k in range(n):
        for i in range(k + 1, n):
            b[i] -= K[i, k] * b[k]
    for k in range(n - 1, -1, -1):
        for j in range(k + 1, n):
            b[k] -= K[k, j] * b[j]
        b[k] /= K[k, k]


@fast_lean_kernel
def _drag(structure, water, dp, force, flow):
    """Modal drag of relative velocity, ½ρC_D D|u-v|(u-v), added to force; power [W] on the frame.

    water, flow (nd, ns): particle velocity, and room for the frame's own. Stations are
    innermost, so that both products with the modal shapes run along memory.
    """
    nm, nd, ns = structure.station.shape
    flow[:] = 0.0
    for m in range(nm):
        for d in range(nd):
            for i in range(ns):
                flow[d, i] += structure.station[m, d, i] * dp[m]
    power = 0.0
    for i in range(ns):
        square = 0.0
        for d in range(nd):
            square += (water[d, i] - flow[d, i]) ** 2
        size = structure.drag[i] * np.sqrt(square)
        for d in range(nd):
            own = flow[d, i]
            flow[d, i] = size * (water[d, i] - own)
            power += flow[d, i] * own
    for m in range(nm):
        total = 0.0
        for d in range(nd):
            for i in range(ns):
                total += structure.station[m, d, i] * flow[d, i]
        force[m] += total
    return power


@kernel
def flexibility(structure, dt):
    """D⁻¹ (nm, 2, 2) of each mode's stages and H (2, nc, 2, nc) of the carriers.

    D = I + 2ζω dt A + ω² dt² AA maps a mode's stage accelerations to its stage loads.
    """
    nc, nm = structure.carrier.shape
    inverse = np.empty((nm, 2, 2))
    H = np.zeros((2, nc, 2, nc))
    for m in range(nm):
        c, k = 2 * structure.damping[m] * structure.omega[m] * dt, (structure.omega[m] * dt) ** 2
        D = np.eye(2) + c * A + k * AA
        det = D[0, 0] * D[1, 1] - D[0, 1] * D[1, 0]
        inverse[m, 0, 0], inverse[m, 1, 1] = D[1, 1] / det, D[0, 0] / det
        inverse[m, 0, 1], inverse[m, 1, 0] = -D[0, 1] / det, -D[1, 0] / det
        for s in range(2):
            for l in range(2):
                for i in range(nc):
                    for j in range(nc):
                        H[s, i, l, j] += inverse[m, s, l] * structure.carrier[i, m] * structure.carrier[j, m]
    return inverse, H


@kernel
def _constant_part(bodies, memory, stiffness, dt, constant):
    """Stage loads from stage accelerations (2nz, 2nz) of all but the mass, at rest.

    Newton's matrix need only be near the true one: the mass follows the motion, the small rest does not.
    """
    nz = bodies.damping.size
    motion, still = new_motion(bodies), np.zeros(nz)
    move(bodies, still, still, motion)
    B = np.empty((nz, nz))
    constant[:] = 0.0
    for s in range(2):
        for j in range(2):
            project_active(bodies, motion, memory.direct[s, j], B)
            for l in range(2):
                for i in range(nz):
                    for k in range(nz):
                        constant[s * nz + i, l * nz + k] += dt * A[j, l] * B[i, k]
        for l in range(2):
            for i in range(nz):
                for k in range(nz):
                    constant[s * nz + i, l * nz + k] += dt * dt * AA[s, l] * stiffness[i, k]
                constant[s * nz + i, l * nz + i] += dt * A[s, l] * (bodies.pto[i] + bodies.damping[i])


@kernel
def _newton_matrix(bodies, motion, H, constant, M, Z, K):
    """Z (2nz, 2nz): stage loads from stage accelerations; K: Newton's matrix with the frame."""
    nz, nc = bodies.damping.size, H.shape[1]
    mass_matrix(bodies, motion, M)
    Z[:] = constant
    for s in range(2):
        for i in range(nz):
            for k in range(nz):
                Z[s * nz + i, s * nz + k] += M[i, k]
    K[:] = Z
    for s in range(2):
        for i in range(nc):
            row = s * nz + i
            K[row] = 0.0
            for l in range(2):
                for k in range(nc):
                    factor = H[s, i, l, k]
                    for col in range(2 * nz):
                        K[row, col] += factor * Z[l * nz + k, col]
            K[row, row] += 1.0


@lean_kernel
def _memory_loads(memory, history, velocity, out):
    """Memory load (2, na) at both stages: history plus the stages' own velocities (2, na)."""
    for s in range(2):
        for i in range(out.shape[1]):
            total = history[s, i]
            for j in range(2):
                for k in range(out.shape[1]):
                    total += memory.direct[s, j, i, k] * velocity[j, k]
            out[s, i] = total


@lean_kernel
def _memory_history(memory, state, velocity, history):
    """Load (2, na) at the stages from the memory so far and the velocity at the step's start."""
    history[:] = 0.0
    for q in range(memory.residue.shape[0]):
        for s in range(2):
            for k in range(velocity.size):
                r = memory.decay[s, q] * state.memory[q, k] + memory.weight[s, 0, q] * velocity[k]
                for i in range(velocity.size):
                    history[s, i] += (memory.residue[q, i, k] * r).real


@lean_kernel
def _remember(memory, state, start, stages):
    """Memory states at the step's end from velocities at its three points."""
    for q in range(memory.residue.shape[0]):
        for k in range(start.size):
            state.memory[q, k] = (
                memory.decay[1, q] * state.memory[q, k]
                + memory.weight[1, 0, q] * start[k]
                + memory.weight[1, 1, q] * stages[0, k]
                + memory.weight[1, 2, q] * stages[1, k]
            )


@lean_kernel
def _stages(structure, state, inverse, known, force, z0, dz0, dt, p, dp, ddp, z, dz, ddz):
    """Stage values of modes, carriers and joints from modal loads and joint accelerations.

    Returns the largest change of a modal displacement [m] since the last call.
    """
    nc, nm = structure.carrier.shape
    change = 0.0
    for m in range(nm):
        f0, f1 = known[0, m] + force[0, m], known[1, m] + force[1, m]
        ddp[0, m] = inverse[m, 0, 0] * f0 + inverse[m, 0, 1] * f1
        ddp[1, m] = inverse[m, 1, 0] * f0 + inverse[m, 1, 1] * f1
    for s in range(2):
        for m in range(nm):
            a0, a1, a2 = state.ddp[m], ddp[0, m], ddp[1, m]
            dp[s, m] = state.dp[m] + dt * (A0[s] * a0 + A[s, 0] * a1 + A[s, 1] * a2)
            new = state.p[m] + dt * C[s] * state.dp[m] + dt * dt * (AA0[s] * a0 + AA[s, 0] * a1 + AA[s, 1] * a2)
            change = max(change, abs(new - p[s, m]) * structure.scale[m])
            p[s, m] = new
        for i in range(nc):
            q0 = q1 = q2 = 0.0
            for m in range(nm):
                q0 += structure.carrier[i, m] * p[s, m]
                q1 += structure.carrier[i, m] * dp[s, m]
                q2 += structure.carrier[i, m] * ddp[s, m]
            z[s, i], dz[s, i], ddz[s, i] = q0, q1, q2
        for i in range(nc, z.shape[1]):
            a0, a1, a2 = state.ddz[2, i - nc], ddz[0, i], ddz[1, i]
            dz[s, i] = dz0[i] + dt * (A0[s] * a0 + A[s, 0] * a1 + A[s, 1] * a2)
            z[s, i] = z0[i] + dt * C[s] * dz0[i] + dt * dt * (AA0[s] * a0 + AA[s, 0] * a1 + AA[s, 1] * a2)
    return change


@lean_kernel
def _carry(structure, amplitude, out):
    """out[:nc] = carrier coordinates of modal amplitudes (nm,)."""
    nc, nm = structure.carrier.shape
    for i in range(nc):
        total = 0.0
        for m in range(nm):
            total += structure.carrier[i, m] * amplitude[m]
        out[i] = total


@lean_kernel
def _predict(structure, state, modal, sample, dt, known, force, ddz):
    """What is known of the stages' modal loads, and the rest extrapolated from the last step.

    Loads, not accelerations, of the modes are extrapolated: stiff modes ring in the latter.
    """
    nc, nm = structure.carrier.shape
    for s in range(2):
        a, b, c = (1.0, -3.0, 3.0) if s == 0 else (3.0, -8.0, 6.0)
        for m in range(nm):
            w, cv = structure.omega[m], state.dp[m] + dt * A0[s] * state.ddp[m]
            cq = state.p[m] + dt * C[s] * state.dp[m] + dt * dt * AA0[s] * state.ddp[m]
            known[s, m] = modal[sample + s, m] - 2 * structure.damping[m] * w * cv - w * w * cq
            force[s, m] = a * state.force[0, m] + b * state.force[1, m] + c * state.force[2, m]
        for i in range(state.z.size):
            ddz[s, nc + i] = a * state.ddz[0, i] + b * state.ddz[1, i] + c * state.ddz[2, i]


@lean_kernel
def _newton_side(structure, inverse, known, drag, residual, ddz, side):
    """Newton's right-hand side (2nz,).

    For a carrier its acceleration under all loads less the present one, for a joint its residual.
    """
    nz, (nc, nm) = residual.shape[1], structure.carrier.shape
    for s in range(2):
        for i in range(nz):
            side[s * nz + i] = residual[s, i] if i >= nc else -ddz[s, i]
    for m in range(nm):
        f0, f1 = known[0, m] + drag[0, m], known[1, m] + drag[1, m]
        for i in range(nc):
            f0 += structure.carrier[i, m] * residual[0, i]
            f1 += structure.carrier[i, m] * residual[1, i]
        a0 = inverse[m, 0, 0] * f0 + inverse[m, 0, 1] * f1
        a1 = inverse[m, 1, 0] * f0 + inverse[m, 1, 1] * f1
        for i in range(nc):
            side[i] += structure.carrier[i, m] * a0
            side[nz + i] += structure.carrier[i, m] * a1


class Workspace(NamedTuple):
    """What a march of one step length computes once, and its scratch: two rows for two stages."""

    inverse: np.ndarray  # (nm, 2, 2), H: see flexibility
    H: np.ndarray
    constant: np.ndarray  # (2nz, 2nz) of Newton's matrix
    stage: tuple  # of Motion, at ½ and 1
    M: np.ndarray
    Z: np.ndarray
    K: np.ndarray
    pivot: np.ndarray
    z0: np.ndarray
    dz0: np.ndarray
    velocity0: np.ndarray
    z: np.ndarray
    dz: np.ndarray
    ddz: np.ndarray
    p: np.ndarray
    dp: np.ndarray
    ddp: np.ndarray
    known: np.ndarray
    force: np.ndarray
    drag: np.ndarray
    velocity: np.ndarray
    history: np.ndarray
    load: np.ndarray
    residual: np.ndarray
    wrench: np.ndarray
    external: np.ndarray
    pressure: np.ndarray
    anchor: np.ndarray
    since: np.ndarray
    works: np.ndarray
    update: np.ndarray
    flow: np.ndarray


def workspace(bodies, structure, memory, stiffness, dt) -> Workspace:
    """For `march` with steps of dt; stiffness (nz, nz) of the floats at rest, for Newton's matrix alone."""
    nb, nz = bodies.axes.size, bodies.damping.size
    nm, na = structure.omega.size, nb * bodies.active.size
    inverse, H = flexibility(structure, dt)
    constant = np.empty((2 * nz, 2 * nz))
    _constant_part(bodies, memory, stiffness, dt, constant)
    return Workspace(
        inverse=inverse,
        H=H,
        constant=constant,
        stage=(new_motion(bodies), new_motion(bodies)),
        M=np.empty((nz, nz)),
        pivot=np.empty(2 * nz, np.int64),
        update=np.empty(2 * nz),
        wrench=np.empty((2, nb, 6)),
        pressure=np.empty((2, nb, 6)),
        external=np.empty((2, nb, 6)),
        works=np.zeros((3, len(WORKS))),
        flow=np.empty(structure.station.shape[1:]),
        velocity0=np.empty(na),
        **{name: np.empty((2 * nz, 2 * nz)) for name in ("Z", "K")},
        **{name: np.empty(nz) for name in ("z0", "dz0", "since")},
        **{name: np.zeros((2, nz)) for name in ("z", "dz", "ddz", "residual", "anchor")},
        **{name: np.zeros((2, nm)) for name in ("p", "dp", "ddp", "known", "force", "drag")},
        **{name: np.empty((2, na)) for name in ("velocity", "history", "load")},
    )


@lean_kernel
def march(bodies, structure, memory, drive, state, own, dt, tolerance, iterations, quiet, output):
    """Advance `state` through all samples of `drive`; return (outcome, sample, iterations used).

    own: see workspace. tolerance: Newton's last update of any stage position [m or rad]. Every WATCH steps the
    energy balance is looked at: what opened up to step `quiet`, under the jolt of the start, it may keep. On an
    outcome other than OK, `sample` is where the run stopped; a state is never left with NaN unnoticed.
    """
    inverse, H, constant, stage, M, Z, K, pivot = (
        own.inverse, own.H, own.constant, own.stage, own.M, own.Z, own.K, own.pivot
    )  # fmt: skip
    z0, dz0, velocity0, z, dz, ddz = own.z0, own.dz0, own.velocity0, own.z, own.dz, own.ddz
    p, dp, ddp, known, force, drag = own.p, own.dp, own.ddp, own.known, own.force, own.drag
    velocity, history, load, residual, wrench = own.velocity, own.history, own.load, own.residual, own.wrench
    external, pressure, anchor, since = own.external, own.pressure, own.anchor, own.since
    works, update, flow = own.works, own.update, own.flow
    nz, (nc, nm) = bodies.damping.size, structure.carrier.shape
    nj = nz - nc
    steps = (drive.modal.shape[0] - 1) // 2
    _carry(structure, state.p, z0)
    _carry(structure, state.dp, dz0)
    _copy(state.z, z0[nc:])
    _copy(state.dz, dz0[nc:])
    move(bodies, z0, dz0, stage[1])  # where a step ends the next one starts
    _copy(stage[1].active_velocity, velocity0)
    used = spent = 0
    for step in range(steps):
        _memory_history(memory, state, velocity0, history)
        if step % WATCH == 0:
            gap = open_by(state.work, _stored(bodies, structure, state, z0, dz0, stage[1]), state.energy)
            if step <= quiet:
                state.energy[2] = gap
            if not abs(gap - state.energy[2]) <= GROSSLY * state.energy[1]:
                return UNBALANCED, 2 * step, used
        if step % REFRESH == 0 or spent > 2:
            _newton_matrix(bodies, stage[1], H, constant, M, Z, K)
            if not _factor(K, pivot):
                return NOT_FINITE, 2 * step, used
        _predict(structure, state, drive.modal, 2 * step + 1, dt, known, force, ddz)
        p[:] = np.inf
        converged, spent = False, 0
        while spent < iterations:
            spent += 1
            used += 1
            change = _stages(structure, state, inverse, known, force, z0, dz0, dt, p, dp, ddp, z, dz, ddz)
            for s in range(2):
                move(bodies, z[s], dz[s], stage[s])
                _copy(stage[s].active_velocity, velocity[s])
            _memory_loads(memory, history, velocity, load)
            # What is dear and varies slowly is computed once a step, as a rule.
            moved = 0.0
            for s in range(2):
                for i in range(nz):
                    moved = max(moved, abs(z[s, i] - anchor[s, i]))
            if spent == 1 or nz == 0 or moved > NEAR * tolerance:
                _copy(z[0], anchor[0])
                _copy(z[1], anchor[1])
                drag[:] = 0.0
                for s in range(2):
                    sample = 2 * step + 1 + s
                    pressures(bodies, stage[s], drive.field[sample], pressure[s])
                    works[1 + s, 5] = _drag(structure, drive.station[sample], dp[s], drag[s], flow)
            for s in range(2):
                for i in range(nz):
                    since[i] = z[s, i] - anchor[s, i]
                excitation = drive.excitation[2 * step + 1 + s]
                loads(
                    bodies, z[s], dz[s], ddz[s], stage[s], pressure[s], since, excitation, load[s],
                    residual[s], wrench[s], external[s],
                )  # fmt: skip
            _newton_side(structure, inverse, known, drag, residual, ddz, update)
            _substitute(K, pivot, update)
            for s in range(2):
                for i in range(nz):
                    change = max(change, dt * dt * abs(update[s * nz + i]) * 0.2)
                for i in range(nj):
                    ddz[s, nc + i] += update[s * nz + nc + i]
                _copy(drag[s], force[s])
                for i in range(nc):
                    value = residual[s, i]
                    for j in range(2 * nz):
                        value -= Z[s * nz + i, j] * update[j]
                    for m in range(nm):
                        force[s, m] += structure.carrier[i, m] * value
            if not np.isfinite(np.sum(update)):
                return NOT_FINITE, 2 * step + 1, used
            if change < tolerance:
                converged = True
                break
        if not converged:
            return NOT_CONVERGED, 2 * step + 1, used
        # The last update is free accuracy: carry it into the stage values.
        _stages(structure, state, inverse, known, force, z0, dz0, dt, p, dp, ddp, z, dz, ddz)
        for s in range(2):
            move(bodies, z[s], dz[s], stage[s])
            _copy(stage[s].active_velocity, velocity[s])
        # So are the joints' forces with it: of the accelerations before they are off by mass times the update.
        _memory_loads(memory, history, velocity, load)
        for s in range(2):
            for i in range(nz):
                since[i] = z[s, i] - anchor[s, i]
            loads(
                bodies, z[s], dz[s], ddz[s], stage[s], pressure[s], since, drive.excitation[2 * step + 1 + s], load[s],
                residual[s], wrench[s], external[s],
            )  # fmt: skip
        for i in range(nz):
            if not bodies.limit[i, 0] < z[1, i] < bodies.limit[i, 1]:
                _copy(z[1, nc:], state.z)
                return EXCURSION, 2 * step + 2, used
        # Work by Simpson's rule over the step's three points.
        for s in range(2):
            inertia = structural = 0.0
            for m in range(nm):
                inertia += drive.modal[2 * step + 1 + s, m] * dp[s, m]
                structural += 2 * structure.damping[m] * structure.omega[m] * dp[s, m] ** 2
            powers(bodies, dz[s], stage[s], external[s], load[s], works[1 + s, :4])
            works[1 + s, 4], works[1 + s, 6] = inertia, structural
        _copy(state.power, works[0])
        for i in range(state.work.size):
            state.work[i] += dt * (SIMPSON[0] * works[0, i] + SIMPSON[1] * works[1, i] + SIMPSON[2] * works[2, i])
        _copy(works[2], state.power)
        _remember(memory, state, velocity0, velocity)
        _copy(velocity[1], velocity0)
        _copy(state.ddz[2], state.ddz[0])
        _copy(state.force[2], state.force[0])
        for s in range(2):
            _copy(ddz[s, nc:], state.ddz[1 + s])
            _copy(force[s], state.force[1 + s])
            row = 2 * step + s
            _copy(z[s], output.z[row])
            _copy(dz[s], output.dz[row])
            _copy(p[s], output.p[row])
            for b in range(wrench.shape[1]):
                _copy(wrench[s, b], output.wrench[row, b])
        _copy(z[1], z0)
        _copy(dz[1], dz0)
        _copy(z0[nc:], state.z)
        _copy(dz0[nc:], state.dz)
        _copy(p[1], state.p)
        _copy(dp[1], state.dp)
        _copy(ddp[1], state.ddp)
    return OK, 2 * steps, used


@lean_kernel
def _stored(bodies, structure, state, z, dz, motion):
    total = stored_energy(bodies, z, dz, motion)
    for m in range(structure.omega.size):
        total += 0.5 * (state.dp[m] ** 2 + (structure.omega[m] * state.p[m]) ** 2)
    return total


@kernel
def energy(bodies, structure, state):
    """Stored energy [J] of floats and modes, radiation memory excluded."""
    nc, nz = structure.carrier.shape[0], bodies.damping.size
    z, dz, motion = np.zeros(nz), np.zeros(nz), new_motion(bodies)
    _carry(structure, state.p, z)
    _carry(structure, state.dp, dz)
    z[nc:], dz[nc:] = state.z, state.dz
    move(bodies, z, dz, motion)
    return _stored(bodies, structure, state, z, dz, motion)


@lean_kernel
def open_by(work, stored, energy):
    """Gap [J] of the balance, wave work - (PTO + radiation + drag + structural + change of stored energy).

    work (len(WORKS),) since the start and `stored` now [J]; energy: see State. Its scale, the largest of these terms
    so far, is renewed: as a rule the wave's work; in free decay, where all return to nothing once a period, what
    went to and fro.
    """
    wave, radiation, pto, other = work[0], work[1], work[2], work[3]
    inertia, drag, structural = work[4], work[5], work[6]
    given, gained = wave + inertia + max(drag, 0.0), stored - energy[0]
    taken = radiation + pto + other + structural - min(drag, 0.0)
    energy[1] = max(energy[1], abs(given), abs(taken), abs(gained))
    return given - taken - gained
