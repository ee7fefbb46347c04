"""Energy balance of a run: works by name, stored energy, and the gap between them."""

import numpy as np

from solver.coupled.modal import Structure, carry
from solver.coupled.stages import State
from solver.kernels import lean_kernel, part_kernel, whole_kernel
from solver.multibody.bodies import Bodies, Motion, new_motion
from solver.multibody.minimal import move, stored_energy

# Work [J] of: pressure, of still water too, lines and excitation, radiation memory, PTO, other losses of the joints,
# wave inertia and load histories on the frame, drag of waves and current on the frame, structural damping.
WORKS = ("wave", "radiation", "pto", "joint_damping", "frame_inertia", "frame_drag", "structural")
WAVE, RADIATION, PTO, JOINT_DAMPING, FRAME_INERTIA, FRAME_DRAG, STRUCTURAL = range(len(WORKS))
BROUGHT = (WAVE, FRAME_INERTIA, FRAME_DRAG)  # to what is stored; the others take from it

# Of `State.energy` [J]: stored at the start, scale of what has been exchanged since, gap soon after the start.
AT_START, SCALE, GAP = range(3)


@part_kernel
def stored(
    bodies: Bodies,
    structure: Structure,
    p: np.ndarray,
    dp: np.ndarray,
    zone: np.ndarray,
    z: np.ndarray,
    dz: np.ndarray,
    motion: Motion,
) -> float:
    """Energy stored in floats and modes [J], radiation memory excluded, of one instant.

    p, dp (nm,), z, dz (nz,) and zone (2, nz) of the joints' laws.
    """
    total = stored_energy(bodies, zone, z, dz, motion)
    for m in range(structure.omega.size):
        total += 0.5 * (dp[m] ** 2 + (structure.omega[m] * p[m]) ** 2)
    return total


@whole_kernel
def energy(bodies: Bodies, structure: Structure, state: State) -> float:
    """Stored energy [J] of floats and modes, radiation memory excluded."""
    nc, nz = structure.carrier.shape[0], bodies.mechanism.size
    z, dz, motion = np.zeros(nz), np.zeros(nz), new_motion(bodies)
    carry(structure, state.p, z)
    carry(structure, state.dp, dz)
    z[nc:], dz[nc:] = state.z, state.dz
    move(bodies, z, dz, motion)
    return stored(bodies, structure, state.p, state.dp, state.zone, z, dz, motion)


@lean_kernel
def open_by(work: np.ndarray, now: float, energy: np.ndarray) -> float:
    """Gap [J] of the balance: what is BROUGHT, less the other works and the change of stored energy.

    work (len(WORKS),) since the start and what is stored `now` [J]; energy: see State. Its scale, the largest of
    these terms so far, is renewed: as a rule the wave's work; in free decay, where all return to nothing once a
    period, what went to and fro.
    """
    drag = work[FRAME_DRAG]
    brought, gained = work[WAVE] + work[FRAME_INERTIA] + max(drag, 0.0), now - energy[AT_START]
    taken = work[RADIATION] + work[PTO] + work[JOINT_DAMPING] + work[STRUCTURAL] - min(drag, 0.0)
    energy[SCALE] = max(energy[SCALE], abs(brought), abs(taken), abs(gained))
    return brought - taken - gained
