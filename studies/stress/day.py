"""Constraint drift of the augmented formulation over a day: `python -m studies.stress.day [hours]`.

Both floats of the Buan study on their hinges, six DOF a body with multipliers, by the trapezoidal rule: weight, the
linear buoyancy of the hemisphere under the representative sea's elevation, and a tenth of the PTO's damping, for
large motions. Loads this cheap make a day affordable, and constraints do not know where loads come from. Exit
status 1 if a hinge is ever off its place by more than 1e-9 m.
"""

import sys
import time

import numpy as np

from solver.reference.augmented import Body, mechanism
from solver.reference.joints import GROUND, Frames, Hinge
from solver.reference.run import CONSTRAINTS, STILL
from solver.reference.twoloop import PrescribedSurroundings, integrate
from solver.scene import Scene
from solver.sea.field import WaveField
from studies.benchmark.case import scene

HOUR, LIMIT = 3600.0, 1e-9


def loads(case: Scene):
    """forces(t, frames): load (2, 6) about the floats' centres."""
    water, sea, floats = case.water, case.sea, case.floats
    rows = WaveField(sea, water.depth, water.gravity).elevation(np.array([f.centre for f in floats]))
    weight = np.array([f.mass for f in floats]) * water.gravity
    stiffness = water.density * water.gravity * np.pi * floats[0].hull.largest_radius ** 2
    pto = 0.1 * np.concatenate([f.per_axis("pto_damping") for f in floats])

    def forces(t: float, frames: Frames) -> np.ndarray:
        out = np.zeros((len(floats), 6))
        surface = (rows @ np.exp(-1j * sea.omega * t)).real
        out[:, 2] = weight - stiffness * (frames.position[: len(floats), 2] - surface)
        out[:, 4] = -pto * frames.velocity[: len(floats), 4]
        return out

    return forces


def main(hours: float) -> int:
    """A line for each hour, with the largest gaps so far."""
    case = scene("fixed")
    bodies = tuple(Body(mass=f.mass, inertia=f.inertia, cog=f.cog, position=f.centre) for f in case.floats)
    joints = tuple(
        Hinge(first=GROUND, second=b, point=f.hinge, axis=(0, 1, 0)) for b, f in enumerate(case.floats)
    )  # fmt: skip
    prescribed = PrescribedSurroundings(loads(case), ())
    system, state = mechanism(bodies, joints, prescribed.supports(0, 0.0), gravity=(0, 0, -case.water.gravity))
    start, largest, reported = time.perf_counter(), np.zeros(3), 0
    way = {"dt": case.settings.time_step, "stages": 2, "tolerance": CONSTRAINTS, "still": STILL}
    for sample in integrate(system, state, prescribed, t_end=hours * HOUR, **way):
        largest = np.maximum(largest, sample.errors)
        if sample.time >= (reported + 1) * HOUR - 1e-6:
            reported += 1
            spent = (time.perf_counter() - start) / 60
            position, velocity, acceleration = largest
            print(
                f"{reported} h: hinges off their places by {position:.1e} m, {velocity:.1e} m/s,"
                f" {acceleration:.1e} m/s2; {spent:.0f} min, {spent * (hours / reported - 1):.0f} to go",
                flush=True,
            )
    return int(not largest[0] <= LIMIT)


if __name__ == "__main__":
    sys.exit(main(float(sys.argv[1]) if len(sys.argv) > 1 else 24.0))
