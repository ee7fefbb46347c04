"""How far bodies get from what the series of the waves around them are about."""

import numpy as np

from solver.kernels import whole_lean_kernel
from solver.multibody.bodies import Bodies, new_motion
from solver.multibody.minimal import move


def ways(bodies: Bodies, states: np.ndarray) -> np.ndarray:
    """√(s² + z²) (m, nb) [m] of the reference points, s along the waves, at states z (m, nz)."""
    found = np.zeros((len(states), bodies.axes.size))
    _ways(bodies, np.ascontiguousarray(states), np.zeros(states.shape[1]), found)
    return found


@whole_lean_kernel
def _ways(bodies: Bodies, states: np.ndarray, still: np.ndarray, found: np.ndarray) -> None:
    motion, along = new_motion(bodies), bodies.wave_direction
    for i in range(len(states)):
        move(bodies, states[i], still, motion)
        for b in range(bodies.axes.size):
            x, about = motion.position[b], bodies.about[b]
            s = (x[0] - about[0]) * along[0] + (x[1] - about[1]) * along[1]
            found[i, b] = np.sqrt(s * s + x[2] * x[2])
