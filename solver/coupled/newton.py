"""Newton's method for a step: the matrix of a step's start, its factors, and the right-hand side."""

from typing import NamedTuple

import numpy as np

from solver.coupled.memory import Memory
from solver.coupled.modal import Structure
from solver.coupled.scheme import LOBATTO, Scheme
from solver.coupled.stages import Stages
from solver.kernels import fast_lean_kernel, inner_kernel, kernel, lean_kernel, part_kernel, whole_kernel
from solver.multibody.bodies import Bodies, Motion, new_motion
from solver.multibody.joint_law import HELD, PTO_ZONE, STOP_ZONE, add_coupled_damping, axis_damping, tangent
from solver.multibody.minimal import mass_matrix, move, project_active

A, AA = LOBATTO.A, LOBATTO.AA  # near enough, in pieces of the other scheme, for what does not change in a step


class Zones(NamedTuple):
    """Where the joints are in their laws, see joint_law."""

    zone: np.ndarray  # (2, nz)
    bent: np.ndarray  # coordinates that have several


class Newton(NamedTuple):
    """Scratch, and the factors that some steps share."""

    mass: np.ndarray  # (nz, nz)
    Z: np.ndarray  # (2nz, 2nz) stage loads from stage accelerations
    K: np.ndarray  # (2nz, 2nz) Newton's matrix with the frame, then its factors
    pivot: np.ndarray  # (2nz,)
    update: np.ndarray  # (2nz,) of the stage accelerations
    first: np.ndarray  # (1,) what the first one of the last step moved a position by [m or rad]; 0 for none to go by
    rate: np.ndarray  # (1,) share of the first one that the second one was, in the last piece that needed both


def new_newton(nz: int) -> Newton:
    """Room for nz coordinates at both stages."""
    return Newton(
        mass=np.empty((nz, nz)),
        Z=np.empty((2 * nz, 2 * nz)),
        K=np.empty((2 * nz, 2 * nz)),
        pivot=np.empty(2 * nz, np.int64),
        update=np.empty(2 * nz),
        first=np.zeros(1),
        rate=np.full(1, np.inf),
    )


@lean_kernel
def factorize(K: np.ndarray, pivot: np.ndarray) -> bool:
    """LU factors of K (n, n) in place; pivot (n,): the row exchanged with each. False when singular."""
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


@fast_lean_kernel
def substitute(K: np.ndarray, pivot: np.ndarray, b: np.ndarray) -> None:
    """b (n,) <- K⁻¹ b with the factors of `factorize`, along their rows."""
    n = K.shape[0]
    for k in range(n):
        best = pivot[k]
        if best != k:
            b[k], b[best] = b[best], b[k]
    for k in range(n):
        total = b[k]
        for j in range(k):
            total -= K[k, j] * b[j]
        b[k] = total
    for k in range(n - 1, -1, -1):
        total = b[k]
        for j in range(k + 1, n):
            total -= K[k, j] * b[j]
        b[k] = total / K[k, k]


@whole_kernel
def constant_part(bodies: Bodies, memory: Memory, stiffness: np.ndarray, dt: float, constant: np.ndarray) -> None:
    """Stage loads from stage accelerations (2nz, 2nz) of all but the mass, at rest.

    Newton's matrix need only be near the true one: the mass follows the motion, the small rest does not.
    """
    nz = bodies.mechanism.size
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
    _add_damping(bodies, dt, constant)


@kernel(inline="always")
def _add_damping(bodies: Bodies, dt: float, constant: np.ndarray) -> None:
    """The joints' part of it."""
    nz = bodies.mechanism.size
    for s in range(2):
        for l in range(2):
            block = constant[s * nz : (s + 1) * nz, l * nz : (l + 1) * nz]
            for i in range(nz):
                block[i, i] += dt * A[s, l] * axis_damping(bodies.law, i)
            add_coupled_damping(bodies.law, dt * A[s, l], block)


@inner_kernel
def shorter_part(bodies: Bodies, whole: np.ndarray, dt: float, length: float, constant: np.ndarray) -> None:
    """constant_part for steps of a length [s] from that, `whole`, of longer ones of dt.

    The joints' damping goes by dt, stiffness by dt², and so does the radiation memory, nearly.
    """
    share = length / dt
    for i in range(whole.shape[0]):
        for j in range(whole.shape[0]):
            constant[i, j] = share * share * whole[i, j]
    _add_damping(bodies, length - share * share * dt, constant)


@inner_kernel
def newton_matrix(
    bodies: Bodies,
    motion: Motion,
    zones: Zones,
    H: np.ndarray,
    constant: np.ndarray,
    dt: float,
    scheme: Scheme,
    newton: Newton,
) -> None:
    """Fill newton.Z, and newton.K from it; H (2, nc, 2, nc): see modal.flexibility; constant: see constant_part."""
    mass, Z, K = newton.mass, newton.Z, newton.K
    nz, nc = bodies.mechanism.size, H.shape[1]
    mass_matrix(bodies, motion, mass)
    for i in range(2 * nz):
        for k in range(2 * nz):
            Z[i, k] = constant[i, k]
    for s in range(2):
        for i in range(nz):
            for k in range(nz):
                Z[s * nz + i, s * nz + k] += mass[i, k]
    for n in range(zones.bent.size):
        i = zones.bent[n]
        stiffness, damping = tangent(bodies.law, i, zones.zone[STOP_ZONE, i], zones.zone[PTO_ZONE, i])
        for s in range(2):
            for l in range(2):
                Z[s * nz + i, l * nz + i] += dt * dt * scheme.AA[s, l] * stiffness + dt * scheme.A[s, l] * damping
    for i in range(2 * nz):
        for k in range(2 * nz):
            K[i, k] = Z[i, k]
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
    for n in range(zones.bent.size):
        i = zones.bent[n]
        if zones.zone[PTO_ZONE, i] == HELD:  # its acceleration is the unknown of its own row
            for s in range(2):
                K[s * nz + i] = 0.0
                K[s * nz + i, s * nz + i] = 1.0


@part_kernel
def newton_side(structure: Structure, inverse: np.ndarray, stage: Stages, side: np.ndarray) -> None:
    """Newton's right-hand side (2nz,) from the stages' residuals.

    For a carrier its acceleration under all loads less the present one, for a joint its residual.
    """
    known, drag, residual, ddz = stage.known, stage.drag, stage.residual, stage.ddz
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


@part_kernel
def hold(bent: np.ndarray, stage: Stages, side: np.ndarray) -> None:
    """On Newton's right-hand side (2nz,), axes that are held have no acceleration."""
    nz = stage.z.shape[1]
    for n in range(bent.size):
        i = bent[n]
        if stage.zone[PTO_ZONE, i] == HELD:
            for s in range(2):
                side[s * nz + i] = -stage.ddz[s, i]
