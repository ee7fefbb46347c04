"""Where in a step an axis leaves the zone of its joint's law."""

from solver.coupled.pieces.pace import SLIVER, smooths
from solver.coupled.problem import Problem, Workspace
from solver.coupled.stages import State
from solver.kernels import kernel, part_kernel
from solver.multibody.joint_law import HELD, LINEAR, OPEN, PTO_ZONE, STOP_ZONE, TABLE, holding
from solver.multibody.zones import leaving, limited, within_stops

SCAN = 8  # points of a step at which its polynomial is looked at
HALVINGS = 50  # of the interval in which it leaves a zone
NEVER = 2.0  # shares of a step


@part_kernel
def undisturbed(problem: Problem, room: Workspace) -> bool:
    """Whether no axis may leave its zone in the step that the stages hold, and none is on a stop, held or let go.

    Most steps are so.
    """
    for n in range(problem.bent.size):
        i = problem.bent[n]
        if not (_stays(problem, room, problem.dt, i, STOP_ZONE) and _stays(problem, room, problem.dt, i, PTO_ZONE)):
            return False
    return True


@kernel(inline="always")
def _stays(problem: Problem, room: Workspace, h: float, i: int, kind: int) -> bool:
    """Whether axis i is off its stops, or its power take-off linear, and surely stays so in a step of h [s].

    Between its points, half a step apart, an axis goes farther than there by a quarter of the step at its largest rate;
    by twice that here, for its rate may be larger between them.
    """
    law, start, stage = problem.bodies.law, room.start, room.stage
    if kind == PTO_ZONE:
        return stage.zone[PTO_ZONE, i] == LINEAR and not limited(law, i)
    if stage.zone[STOP_ZONE, i] != OPEN:
        return False
    reach = 0.5 * h * max(abs(start.dz[i]), abs(stage.dz[0, i]), abs(stage.dz[1, i]))
    low, high = min(start.z[i], stage.z[0, i], stage.z[1, i]), max(start.z[i], stage.z[0, i], stage.z[1, i])
    return within_stops(law, i, low - reach, high + reach)


@part_kernel
def first_to_leave(problem: Problem, state: State, room: Workspace, h: float) -> tuple[float, int, int]:
    """Share of a step of h [s] at which an axis is the first to leave a zone, the axis, the zone's kind; else NEVER."""
    first, axis, kind = NEVER, -1, STOP_ZONE
    for n in range(problem.bent.size):
        i = problem.bent[n]
        for k in (STOP_ZONE, PTO_ZONE):
            at = NEVER if _stays(problem, room, h, i, k) else _leaves(problem, state, room, h, i, k)
            if at < first:
                first, axis, kind = at, i, k
    return first, axis, kind


@part_kernel
def _leaves(problem: Problem, state: State, room: Workspace, h: float, i: int, kind: int) -> float:
    """Share of the step at which axis i leaves its zone; at once if it begins beyond and goes further or stays."""
    before = _beyond(problem, state, room, h, i, kind, 0.0)
    if before > 0 and kind == PTO_ZONE and room.stage.zone[kind, i] == HELD:
        return 0.0
    for n in range(1, SCAN + 1):
        low, high = (n - 1) / SCAN, n / SCAN
        now = _beyond(problem, state, room, h, i, kind, high)
        if now > 0 and before > 0 and n == 1:  # further on, or by rounding alone before and past all of a narrow zone
            within = _within(problem, state, room, h, i, kind, high)
            if within > 0:
                low, before = within, 0.0
            elif now > before:
                return 0.0
        if now > 0 and not before > 0:
            for _ in range(HALVINGS):
                middle = 0.5 * (low + high)
                if _beyond(problem, state, room, h, i, kind, middle) > 0:
                    high = middle
                else:
                    low = middle
            if kind == PTO_ZONE and room.stage.zone[kind, i] >= TABLE and high < SLIVER:
                return 0.0  # where lines cross the way there tells no piece: see change_law
            return high
        before = now
    return 0.0 if before > 0 else NEVER


@part_kernel
def _within(problem: Problem, state: State, room: Workspace, h: float, i: int, kind: int, x: float) -> float:
    """A share of the step, of x and halves of halves of it, at which axis i is in its zone; 0 if at none."""
    for _ in range(HALVINGS):
        x *= 0.5
        if not _beyond(problem, state, room, h, i, kind, x) > 0:
            return x
    return 0.0


@part_kernel
def _beyond(problem: Problem, state: State, room: Workspace, h: float, i: int, kind: int, x: float) -> float:
    """> 0 where axis i is beyond its zone at the share x of the step, by the collocation's polynomials."""
    stage, law, zone = room.stage, problem.bodies.law, room.stage.zone[kind, i]
    if kind == PTO_ZONE and zone == HELD:
        r0, r1, r2 = state.held[i], stage.residual[0, i], stage.residual[1, i]
        load = r0 + x * (-3 * r0 + 4 * r1 - r2) + 2 * x * x * (r0 - 2 * r1 + r2)
        return max(load - holding(law, i, 1), -load - holding(law, i, -1))
    y, dy = way(problem, state, room, h, i, x)
    return leaving(law, i, kind, zone, y, dy)


@part_kernel
def way(problem: Problem, state: State, room: Workspace, h: float, i: int, x: float) -> tuple[float, float]:
    """Position and rate of axis i there."""
    start, stage, nc = room.start, room.stage, problem.structure.carrier.shape[0]
    a0, a1, a2 = state.ddz[2, i - nc], stage.ddz[0, i], stage.ddz[1, i]
    if smooths(problem, state, room):
        a0 = 2 * a1 - a2
    b, c, t = -3 * a0 + 4 * a1 - a2, 2 * (a0 - 2 * a1 + a2), x * h
    dy = start.dz[i] + t * (a0 + x * (b / 2 + x * c / 3))
    y = start.z[i] + t * start.dz[i] + t * t * (a0 / 2 + x * (b / 6 + x * c / 12))
    return y, dy
