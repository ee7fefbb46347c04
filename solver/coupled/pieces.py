"""Steps in which a joint's law changes, or swings on an end stop: in pieces that end where it changes.

Within a zone of its law (see joint_law) an axis moves smoothly, so a step is tried with the zones of its start. Where
the collocation's own polynomial leaves one, a piece ends there; the law is then that of the next zone, and
accelerations jump by what the mass matrix says:

    M Δa = -Δf,    Δa = -a of an axis that is held.

Each piece is a step of the same scheme, of the same order: the radiation memory is exact for any length, and what
the wave drives is a polynomial through its samples. On a stop, pieces follow the swing, and grow as far as the axis's
acceleration is a straight line.

As an axis meets its stop, the stop's damper loads the nodes of an elastic platform at once. Modes far faster than the
swing ring with a part of that load, and die early in the hit: the first pieces are such that smooth (see scheme), and
those after them are as long as the swing on a fixed platform asks for.

Middles and ends of pieces are put out beside the samples, with their weights in the means over the time between these:
a hit is shorter than that.

Where a load jumps, all modes of an elastic platform ring, and those that a piece does not follow move the axis as no
polynomial tells: it would be caught while it moves, let go at another load, and damped by what Simpson's rule does not
see. From then on pieces are halved until they keep the energy balance and end where the law changes, and grow as far
as they keep it. Where a load only bends, the piece that ends there is halved if it would make it jump; and any piece
for which Newton's method fails, as from an acceleration that lasts microseconds.
"""

from typing import Any, NamedTuple

import numpy as np

from solver.coupled.between import NODES, nearest
from solver.coupled.energy import JOINT_DAMPING, PTO, stored
from solver.coupled.memory import Memory
from solver.coupled.modal import fill_flexibility
from solver.coupled.newton import factorize, shorter_part, substitute
from solver.coupled.scheme import SMOOTHING, Scheme
from solver.coupled.stages import State
from solver.coupled.step import (
    BEYOND,
    HITS,
    HOLDS,
    LET_GO,
    LOAD,
    NOT_FINITE,
    OK,
    RATE,
    TO_AND_FRO,
    UNTOLD,
    Drive,
    Output,
    Problem,
    Workspace,
    account_work,
    advance,
    attempt,
    copy,
    gap,
    put_stage,
    refresh,
    rings,
)
from solver.kernels import inner_kernel, kernel, lean_kernel, part_kernel
from solver.multibody.joint_law import (
    GONE,
    HELD,
    LINEAR,
    OPEN,
    PRESSED,
    PTO_ZONE,
    SLIPS,
    STOP_ZONE,
    TABLE,
    JointLaw,
    axis_energy,
    axis_load,
    beyond_law,
    holding,
    jumps,
    leaving,
    limited,
    next_zone,
    pto_zone,
    stop_load,
    within_stops,
)
from solver.multibody.minimal import mass_matrix, move

SWING = 16  # pieces in the period of what swings on a stop
SMOOTH = 2  # pieces in the time of one of those, the first ones on an elastic platform
SCAN = 8  # points of a step at which its polynomial is looked at
HALVINGS = 50  # of the interval in which it leaves a zone
NEVER = 2.0  # shares of a step
SHORT = 0.25  # of a step: in such pieces pressure and drag are evaluated at their ends alone
PATIENCE = 2  # iterations of a piece, beyond which Newton's matrix is renewed
SHARE = 8  # pieces that share one
CHANGES = 200  # of laws in one step, at most
# Bend of an axis's acceleration in a piece, times its length, over the axis's largest rate so far: (ωh)³/4 of what
# swings. Pieces above it are halved, and grow as long as it stays below, with the cube of their length.
BEND = 0.03
# Of the energy of an axis's fastest swing so far, by which a piece after a jump may open the balance: some hundred
# pieces a swing then keep it. One of twice the length opens it by GROWTH as much.
OPENED = 1e-5
GROWTH = 2**5
MISSED = 1e-3  # of an axis's largest rate so far, which such a piece may leave where the axis was to turn
KINK = 0.05  # of the load at that rate, by which it may jump where a law that only bends is changed that far off
SHORTEST = 2.0**-14  # of a step: in shorter pieces Newton's tolerance opens the balance
SLIVER = 1e-9  # of a step
LEAST = 1e-13  # of Newton's tolerances [m or rad]
LONGER = 2.0  # times the last one may be what goes on with its parabolas
ONE: Any = np.int64(1)  # a bare 1 is of another type, with which all that it is handed to would be compiled once more


def _gauss() -> tuple[np.ndarray, np.ndarray]:
    """Gauss's points (8,) of 0 to 1, and their shares (8, 2, 3) in integrals up to ½ and 1 of the parabolas that are 1
    at 0, ½ and 1, and 0 at the others."""
    points, weights = np.polynomial.legendre.leggauss(8)
    x = (points + 1) / 2
    tau = np.stack([x / 2, x], axis=1)
    parabolas = [2 * (tau - 0.5) * (tau - 1), -4 * tau * (tau - 1), 2 * tau * (tau - 0.5)]
    return x, (weights / 2)[:, None, None] * [[0.5], [1.0]] * np.stack(parabolas, axis=2)


POINTS, SHARES = _gauss()


class Fine(NamedTuple):
    """What a problem of another step length has of its own."""

    memory: Memory
    inverse: np.ndarray
    H: np.ndarray
    constant: np.ndarray
    drive: Drive  # at the start, the middle and the end
    weight: np.ndarray  # (NODES,)
    smoothing: Scheme
    length: np.ndarray  # (1,) [s] of the step that all this is for; negative where it smooths
    shared: np.ndarray  # (1,) pieces that Newton's matrix has served; 0 if it is of another length or zone
    knots: np.ndarray  # (1,) [s] from the first to the last of the state's accelerations, through which they go on


def new_fine(problem: Problem, drive: Drive) -> Fine:
    """Room for pieces of this problem's steps, driven by so many quantities."""
    return Fine(
        memory=Memory(problem.memory.residue, *(np.empty_like(part) for part in problem.memory[1:])),
        inverse=np.empty_like(problem.inverse),
        H=np.empty_like(problem.H),
        constant=np.empty_like(problem.constant),
        drive=Drive(*(np.empty((3, *part.shape[1:])) for part in drive)),
        weight=np.empty(NODES),
        smoothing=SMOOTHING,
        length=np.zeros(1),
        shared=np.zeros(1, np.int64),
        knots=np.zeros(1),
    )


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

    Between its points an axis goes farther than there by a quarter of the step at its largest rate.
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
def in_contact(problem: Problem, state: State, room: Workspace) -> bool:
    """Whether an axis swings on its stop, or the platform since a load jumped, too fast for a whole step; or an axis
    goes on to its stop with its last acceleration, where a whole step would be tried in vain."""
    if state.ring[0] < problem.dt:
        return True
    start, dt, nc = room.start, problem.dt, problem.structure.carrier.shape[0]
    for n in range(problem.bent.size):
        i = problem.bent[n]
        zone = room.stage.zone[STOP_ZONE, i]
        if abs(zone) == PRESSED and state.pace[i] < dt:
            return True
        y = start.z[i] + dt * (start.dz[i] + 0.5 * dt * state.ddz[2, i - nc])
        if zone == OPEN and not within_stops(problem.bodies.law, i, y, y):
            return True
    return False


@inner_kernel
def bends(problem: Problem, state: State, room: Workspace) -> bool:
    """Whether the step that the stages hold leaves a zone, or is too long for a swing on a stop."""
    return _first(problem, state, room, problem.dt)[0] < NEVER or _too_long(problem, state, room, problem.dt)


@inner_kernel
def in_pieces(
    problem: Problem, drive: Drive, sample: int, state: State, room: Workspace, fine: Fine, output: Output
) -> tuple[int, int]:
    """Advance `state` by the step from `sample` on; (outcome, iterations). Pieces end at the step's middle, too."""
    used = changes = 0
    at, i, kind = NEVER, -1, STOP_ZONE
    fine.shared[0], fine.knots[0], room.newton.rate[0] = 0, problem.dt, np.inf
    most = np.inf  # length of the next piece, after one too long
    before = _stored(problem, state, room)
    for half in range(2):
        row, done, whole = sample + half, 0.0, 0.5 * problem.dt
        first, cut = _open_row(output, row), 0.0  # length of a piece that ends where an axis leaves its zone
        while done < whole * (1 - SLIVER):
            length = cut if cut > 0 else _length(problem, state, room, min(whole - done, most), fine)
            other = _of_length(problem, length, _smooths(problem, state, room), fine)
            outcome, spent = _piece(other, drive, sample + half + 2 * done / problem.dt, problem.dt, state, room, fine)
            used += spent
            if outcome != OK:
                if length <= SHORTEST * problem.dt:
                    return outcome, used
                most, cut, fine.shared[0] = 0.5 * length, 0.0, 0
                _forget(state)
                move(problem.bodies, room.start.z, room.start.dz, room.stage.motion[1])  # whose matrix is Newton's
                continue
            if cut > 0:
                cut = 0.0
                if kind == PTO_ZONE and _misses(problem, length, state, room, i):
                    most = 0.5 * length
                    if jumps(problem.bodies.law, i):
                        state.ring[0] = most
                    continue
            else:
                if not _smooths(problem, state, room) and _too_long(problem, state, room, length):
                    _halve(problem, state, room, length)
                    _again(state, room, fine)
                    continue
                if state.ring[0] < np.inf:
                    share = _opened(problem, other, state, room, fine, before)
                    if share > 1 and length > SHORTEST * problem.dt:
                        state.ring[0] = 0.5 * length
                        _again(state, room, fine)
                        continue
                    if share * GROWTH < 1:
                        state.ring[0] = max(state.ring[0], 2 * length) if 2 * length < problem.dt else np.inf
                at, i, kind = _first(problem, state, room, length)
                if 0 < at < NEVER:
                    cut = length * at
                    _again(state, room, fine)
                    continue
            if at > 0:
                _keep(problem, length, state, room, fine, output, row, done / whole)
                _take(problem, other, state, room, fine, output, row)
                done, most = done + length, np.inf
                before = _stored(problem, state, room)
            if at < NEVER:
                changes += 1
                fine.shared[0] = 0
                if changes > CHANGES:
                    return TO_AND_FRO, used
                if not _change(problem, state, room, i, kind, at == 0, length, output.contact[row]):
                    return NOT_FINITE, used
                output.between.follows[0] = kind == STOP_ZONE and abs(room.stage.zone[STOP_ZONE, i]) != PRESSED
                before = _stored(problem, state, room)
        put_stage(room, ONE, output, row)
        _close_row(output, row, first)
    room.newton.first[0] = 0.0
    _go_on(state, fine, problem.dt)
    return OK, max(used, 4)  # so that Newton's matrix is renewed


@part_kernel
def _length(problem: Problem, state: State, room: Workspace, left: float, fine: Fine) -> float:
    """Of the next piece [s]: all that is left of the half, or a whole part of it.

    That of the last one where rounding alone is between them: its constants serve again.
    """
    pace = min(left, state.ring[0])
    for n in range(problem.bent.size):
        i = problem.bent[n]
        if abs(room.stage.zone[STOP_ZONE, i]) == PRESSED:
            pace = min(pace, state.pace[i])
    length = left / np.ceil(left / pace - SLIVER)
    last = abs(fine.length[0])
    return last if abs(length - last) < SLIVER * length else length


@part_kernel
def _piece(
    other: Problem, drive: Drive, sample: float, dt: float, state: State, room: Workspace, fine: Fine
) -> tuple[int, int]:
    """The stages of a step of the problem `other` that starts at a sample, which need not be whole, of steps of dt."""
    for n in (1, 2):
        _sample(drive, sample + n * other.dt / dt, n, fine)
    if fine.shared[0] == 0 and not refresh(other, room):
        return NOT_FINITE, 0
    room.newton.first[0] = 0.0  # what the stages hold is of another length
    room.newton.rate[0] *= max(1.0, other.dt / fine.knots[0]) ** 2  # as what the matrix leaves out goes
    _go_on(state, fine, other.dt)
    outcome, spent = attempt(other, fine.drive, ONE, state, room)
    fine.shared[0] = 0 if spent > PATIENCE else (fine.shared[0] + 1) % SHARE
    return outcome, spent


@part_kernel
def _take(
    problem: Problem, other: Problem, state: State, room: Workspace, fine: Fine, output: Output, row: int
) -> None:
    """The piece's end becomes the next one's start; what presses on the stops is noted."""
    smooths = fine.length[0] < 0
    account_work(other, fine.drive, ONE, state, room)
    note(problem, room, output, other.dt, row, row)
    if smooths:
        _settle(problem, state, room)
    else:
        _quicken(problem, state, room, other.dt)
    advance(other, state, room)
    if smooths:  # of a start whose accelerations the scheme passes over
        _forget(state)


@lean_kernel
def _open_row(output: Output, row: int) -> int:
    """How many rows are kept before those of pieces up to the output's `row`."""
    between = output.between
    output.lead[row] = 0.0
    between.follows[0] = True
    return int(between.number[0])


@part_kernel
def _keep(
    problem: Problem,
    length: float,
    state: State,
    room: Workspace,
    fine: Fine,
    output: Output,
    row: int,
    done: float,
) -> None:
    """Both stages of a piece, which begins at the share `done` of the time up to `row`, with their weights in it.

    The scheme's own weights: Simpson's; where loads jump at its start, of which the stages know nothing, the middle's.
    """
    between, n = output.between, output.between.number[0]
    if n + 2 > between.at.size:
        output.lead[row] = UNTOLD
    if output.lead[row] == UNTOLD:
        return
    share = length / (0.5 * problem.dt)
    simpson = between.follows[0] and not _smooths(problem, state, room)
    w = problem.scheme.work if simpson else fine.smoothing.work
    if done == 0:
        output.lead[row] += share * w[0]
    else:
        between.weight[n - 1] += share * w[0]
    for s in range(2):
        put_stage(room, s, between, n + s)
        between.at[n + s] = row - 1 + done + 0.5 * (s + 1) * share
        between.weight[n + s] = share * w[1 + s]
        between.row[n + s] = row
        between.contact[n + s] = 0.0
        for k in range(problem.bent.size):
            i = problem.bent[k]
            pto = room.stage.zone[PTO_ZONE, i]
            between.contact[n + s, k, HOLDS] = 1.0 if pto == HELD else 0.0
            between.contact[n + s, k, LET_GO] = 1.0 if abs(pto) == GONE else 0.0
            between.contact[n + s, k, BEYOND] = _over_law(problem, room, s, i)
    between.number[0] = n + 2
    between.follows[0] = True


@lean_kernel
def _close_row(output: Output, row: int, first: int) -> None:
    """Where there was no room for all pieces up to `row`, none are kept."""
    if output.lead[row] == UNTOLD:
        output.between.number[0] = first


@part_kernel
def note(problem: Problem, room: Workspace, output: Output, length: float, middle: int, end: int) -> None:
    """Of a step of this length [s], of which half goes to each of the output's rows `middle` and `end`: the stages'
    loads on the stops, where larger than those noted there, with all loads then, and what is held or let go of."""
    stage, rows = room.stage, (middle, end)
    for n in range(problem.bent.size):
        i = problem.bent[n]
        pto = stage.zone[PTO_ZONE, i]
        for s in range(2):
            load = stop_load(problem.bodies.law, i, stage.zone[STOP_ZONE, i], stage.z[s, i], stage.dz[s, i])
            contact = output.contact[rows[s], n]
            if load > contact[LOAD]:
                contact[LOAD] = load
                for b in range(stage.wrench.shape[1]):
                    copy(stage.wrench[s, b], output.struck[rows[s], n, b])
            contact[HOLDS] += length / problem.dt if pto == HELD else 0.0
            contact[LET_GO] = 1.0 if abs(pto) == GONE else 0.0
            contact[BEYOND] = _over_law(problem, room, s, i)


@kernel(inline="always")
def _over_law(problem: Problem, room: Workspace, s: int, i: int) -> float:
    stage, law = room.stage, problem.bodies.law
    return beyond_law(law, i, stage.zone[PTO_ZONE, i], stage.z[s, i], stage.dz[s, i], stage.residual[s, i])


@inner_kernel
def _forget(state: State) -> None:
    """Nothing to extrapolate from: loads have jumped."""
    for n in range(2):
        copy(state.ddz[2], state.ddz[n])
        copy(state.force[2], state.force[n])


@inner_kernel
def _go_on(state: State, fine: Fine, length: float) -> None:
    """The next step, of this length [s], goes on with the parabolas of the last one, unless far longer."""
    share = length / fine.knots[0]
    fine.knots[0] = length
    if share > LONGER:
        _forget(state)
    elif share != 1:
        _space(state.ddz, share)
        _space(state.force, share)


@lean_kernel
def _space(knots: np.ndarray, share: float) -> None:
    """Values (3, n) at -1, -1/2 and 0 become those at -share, -share/2 and 0, of the same parabolas."""
    for i in range(knots.shape[1]):
        a, b, c = knots[0, i], knots[1, i], knots[2, i]
        first, second = share * (a - 4 * b + 3 * c), share * share * (2 * a - 4 * b + 2 * c)
        knots[0, i], knots[1, i] = c - first + second, c - 0.5 * first + 0.25 * second


@inner_kernel
def _again(state: State, room: Workspace, fine: Fine) -> None:
    """The next step is a part of that in the stages, and goes on with its parabolas."""
    if fine.length[0] > 0:
        nc = room.stage.ddz.shape[1] - state.ddz.shape[1]
        _turn_back(room.stage.ddz[:, nc:], state.ddz)
        _turn_back(room.stage.force, state.force)


@lean_kernel
def _turn_back(stages: np.ndarray, knots: np.ndarray) -> None:
    """Values (3, n) at -1 and -1/2 of the parabolas through those at 0, 1/2 and 1, these two in the stages (2, n)."""
    for i in range(knots.shape[1]):
        a, b, c = knots[2, i], stages[0, i], stages[1, i]
        knots[0, i], knots[1, i] = 6 * a - 8 * b + 3 * c, 3 * a - 3 * b + c


# ---- the length of pieces


@part_kernel
def _bend(problem: Problem, state: State, room: Workspace, i: int, length: float) -> float:
    """Of coordinate i's acceleration in the stages, times their step's length, over its largest rate so far."""
    stage, nc = room.stage, problem.structure.carrier.shape[0]
    bend = abs(state.ddz[2, i - nc] - 2 * stage.ddz[0, i] + stage.ddz[1, i]) * length
    rate = _fastest(state, room, i)
    return bend / rate if rate > 0 else 0.0


@part_kernel
def _too_long(problem: Problem, state: State, room: Workspace, length: float) -> bool:
    """Whether a step of this length [s] does not follow a swing on a stop."""
    for n in range(problem.bent.size):
        i = problem.bent[n]
        presses = abs(room.stage.zone[STOP_ZONE, i]) == PRESSED
        if presses and length > problem.pace[i] * (1 + SLIVER) and _bend(problem, state, room, i, length) > 2 * BEND:
            return True
    return False


@inner_kernel
def _begin_swing(problem: Problem, state: State, i: int) -> None:
    """Axis i meets its stop: pieces that smooth what that sets ringing, then such that follow the swing.

    On a platform that rings since a load jumped, energy tells the pieces' length, and nothing may take of it.
    """
    smooth = rings(problem) and state.ring[0] == np.inf
    state.jolt[i] = SMOOTH if smooth else 0
    state.pace[i] = problem.swing[i] / SMOOTH if smooth else problem.pace[i]


@part_kernel
def _smooths(problem: Problem, state: State, room: Workspace) -> bool:
    """Whether the next piece does: one of the first on a stop."""
    if state.ring[0] < np.inf:
        return False
    for n in range(problem.bent.size):
        i = problem.bent[n]
        if state.jolt[i] > 0 and abs(room.stage.zone[STOP_ZONE, i]) == PRESSED:
            return True
    return False


@part_kernel
def _settle(problem: Problem, state: State, room: Workspace) -> None:
    """One piece less to smooth; after the last one those that follow the swing."""
    for n in range(problem.bent.size):
        i = problem.bent[n]
        if state.jolt[i] > 0 and abs(room.stage.zone[STOP_ZONE, i]) == PRESSED:
            state.jolt[i] -= 1
            if state.jolt[i] == 0:
                state.pace[i] = problem.swing[i]


@inner_kernel
def _halve(problem: Problem, state: State, room: Workspace, length: float) -> None:
    for n in range(problem.bent.size):
        i = problem.bent[n]
        if abs(room.stage.zone[STOP_ZONE, i]) == PRESSED:
            state.pace[i] = max(min(problem.pace[i], length), 0.5 * length)


@part_kernel
def _quicken(problem: Problem, state: State, room: Workspace, length: float) -> None:
    """Twice the pace where an axis's acceleration is so straight that it will be in a piece of that length, too."""
    for n in range(problem.bent.size):
        i = problem.bent[n]
        longer = 2 * state.pace[i] / length  # pieces may be shorter than their pace
        presses = abs(room.stage.zone[STOP_ZONE, i]) == PRESSED
        if presses and _bend(problem, state, room, i, length) * longer**3 < BEND:
            state.pace[i] *= 2


@part_kernel
def _stored(problem: Problem, state: State, room: Workspace) -> float:
    """Energy [J] at the start of a piece that is to keep the balance."""
    start = room.start
    if state.ring[0] == np.inf:
        return 0.0
    return stored(
        problem.bodies, problem.structure, state.p, state.dp, state.zone, start.z, start.dz, room.stage.motion[1]
    )


@inner_kernel
def _opened(problem: Problem, other: Problem, state: State, room: Workspace, fine: Fine, before: float) -> float:
    """By how many times what it may a piece opens the energy balance, with the energy [J] before it."""
    swing = 0.0
    for n in range(problem.bent.size):
        i = problem.bent[n]
        swing = max(swing, 0.5 * room.newton.mass[i, i] * _fastest(state, room, i) ** 2)
    opened = abs(before + gap(other, fine.drive, ONE, state, room))
    return opened / (OPENED * swing) if opened > 0 else 0.0


@part_kernel
def _fastest(state: State, room: Workspace, i: int) -> float:
    """Rate of axis i so far [m/s or rad/s]."""
    return max(state.fastest[i], abs(room.stage.dz[1, i]))


@inner_kernel
def _misses(problem: Problem, length: float, state: State, room: Workspace, i: int) -> bool:
    """Whether a piece that was to end where axis i changes its law is too long for that, on a platform that rings."""
    law, stage = problem.bodies.law, room.stage
    zone = stage.zone[PTO_ZONE, i]
    if zone == HELD or not (rings(problem) and length > SHORTEST * problem.dt):
        return False
    y, dy, fastest = stage.z[1, i], stage.dz[1, i], _fastest(state, room, i)
    if jumps(law, i):
        return abs(leaving(law, i, PTO_ZONE, zone, y, dy)) > MISSED * fastest
    load = _taken(law, i, zone, y, dy)
    next_load = _taken(law, i, next_zone(law, i, PTO_ZONE, zone, y, dy), y, dy)
    return abs(next_load - load) > KINK * abs(_taken(law, i, pto_zone(law, i, y, fastest), y, fastest))


@part_kernel
def _taken(law: JointLaw, i: int, zone: int, y: float, dy: float) -> float:
    """Load of axis i's power take-off by a zone's formula."""
    return axis_load(law, i, OPEN, zone, y, dy).pto


# ---- where a zone ends


@part_kernel
def _first(problem: Problem, state: State, room: Workspace, h: float) -> tuple[float, int, int]:
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
        now = _beyond(problem, state, room, h, i, kind, n / SCAN)
        if now > 0 and before > 0 and n == 1 and now > before:
            return 0.0
        if now > 0 and not before > 0:
            low, high = (n - 1) / SCAN, n / SCAN
            for _ in range(HALVINGS):
                middle = 0.5 * (low + high)
                if _beyond(problem, state, room, h, i, kind, middle) > 0:
                    high = middle
                else:
                    low = middle
            if kind == PTO_ZONE and room.stage.zone[kind, i] >= TABLE and high < SLIVER:
                return 0.0  # where lines cross the way there tells no piece: see _change
            return high
        before = now
    return 0.0 if before > 0 else NEVER


@part_kernel
def _beyond(problem: Problem, state: State, room: Workspace, h: float, i: int, kind: int, x: float) -> float:
    """> 0 where axis i is beyond its zone at the share x of the step, by the collocation's polynomials."""
    stage, law, zone = room.stage, problem.bodies.law, room.stage.zone[kind, i]
    if kind == PTO_ZONE and zone == HELD:
        r0, r1, r2 = state.held[i], stage.residual[0, i], stage.residual[1, i]
        load = r0 + x * (-3 * r0 + 4 * r1 - r2) + 2 * x * x * (r0 - 2 * r1 + r2)
        return max(load - holding(law, i, 1), -load - holding(law, i, -1))
    y, dy = _way(problem, state, room, h, i, x)
    return leaving(law, i, kind, zone, y, dy)


@part_kernel
def _way(problem: Problem, state: State, room: Workspace, h: float, i: int, x: float) -> tuple[float, float]:
    """Position and rate of axis i there."""
    start, stage, nc = room.start, room.stage, problem.structure.carrier.shape[0]
    a0, a1, a2 = state.ddz[2, i - nc], stage.ddz[0, i], stage.ddz[1, i]
    if _smooths(problem, state, room):
        a0 = 2 * a1 - a2
    b, c, t = -3 * a0 + 4 * a1 - a2, 2 * (a0 - 2 * a1 + a2), x * h
    dy = start.dz[i] + t * (a0 + x * (b / 2 + x * c / 3))
    y = start.z[i] + t * start.dz[i] + t * t * (a0 / 2 + x * (b / 6 + x * c / 12))
    return y, dy


# ---- behind it


@inner_kernel
def _change(
    problem: Problem,
    state: State,
    room: Workspace,
    i: int,
    kind: int,
    at_once: bool,
    length: float,
    contact: np.ndarray,
) -> bool:
    """Axis i enters its next zone where the state is; False where the masses are singular.

    Of a table it leaves a piece at once into that where the stages, of a step of this length [s], have it next: where
    lines cross, as at rest, the borders do not tell.
    """
    start, nc = room.start, problem.structure.carrier.shape[0]
    law, old = problem.bodies.law, room.stage.zone[kind, i]
    if kind == PTO_ZONE and old == HELD:
        up, down = holding(law, i, 1) - state.held[i], holding(law, i, -1) + state.held[i]
        new = SLIPS if up < down else -SLIPS
    else:
        new = next_zone(law, i, kind, old, start.z[i], start.dz[i])
    if at_once and kind == PTO_ZONE and old >= TABLE:
        y, dy = _way(problem, state, room, length, i, 1 / SCAN)
        soon = pto_zone(law, i, y, dy)
        new = soon if soon != old else new
    if kind == STOP_ZONE and abs(new) == PRESSED:
        _begin_swing(problem, state, i)
        for n in range(problem.bent.size):
            if problem.bent[n] == i and new * start.dz[i] > 0:  # else it is slowed as it comes free, and presses again
                contact[n, HITS] += 1
                contact[n, RATE] = max(contact[n, RATE], abs(start.dz[i]))
    if kind == PTO_ZONE and rings(problem) and jumps(law, i):
        state.ring[0] = min(state.ring[0], 0.5 * problem.dt)
    if kind == PTO_ZONE and new == HELD:
        start.dz[i] = 0.0
        state.dz[i - nc] = 0.0
    if not _enter(problem, state, room, i, kind, new):
        return False
    if kind == PTO_ZONE and new == HELD:
        load = state.held[i]
        if load > holding(law, i, 1) or -load > holding(law, i, -1):
            return _enter(problem, state, room, i, kind, SLIPS if load > 0 else -SLIPS)
    return True


@inner_kernel
def _enter(problem: Problem, state: State, room: Workspace, i: int, kind: int, new: int) -> bool:
    """The zone, and the accelerations and powers that go with it."""
    law, stage, start = problem.bodies.law, room.stage, room.start
    old, pto = stage.zone[STOP_ZONE, i], stage.zone[PTO_ZONE, i]
    before = axis_load(law, i, old, pto, start.z[i], start.dz[i])
    stage.zone[kind, i] = new
    state.zone[kind, i] = new
    stops, pto = stage.zone[STOP_ZONE, i], stage.zone[PTO_ZONE, i]
    after = axis_load(law, i, stops, pto, start.z[i], start.dz[i])
    state.work[JOINT_DAMPING] += axis_energy(law, i, old, start.z[i]) - axis_energy(law, i, stops, start.z[i])
    change = after.pto - before.pto + after.loss - before.loss + after.spring - before.spring
    state.power[PTO] += (after.pto - before.pto) * start.dz[i]
    state.power[JOINT_DAMPING] += (after.loss - before.loss) * start.dz[i]
    move(problem.bodies, start.z, start.dz, stage.motion[1])
    done = _jump(problem, state, room, i, change)
    _forget(state)
    return done


@kernel(no_cpython_wrapper=True)
def _jump(problem: Problem, state: State, room: Workspace, axis: int, change: float) -> bool:
    """Accelerations of modes and joints after the load against an axis has changed; False where M is singular.

    Of carriers, which modes move by S: Δa_c = -S Sᵀ (M Δa)_c, and Δp̈ = -Sᵀ (M Δa)_c.
    """
    S, (nc, nm), nz = problem.structure.carrier, problem.structure.carrier.shape, state.zone.shape[1]
    M, K, pivot = np.empty((nz, nz)), np.empty((nz, nz)), np.empty(nz, np.int64)
    mass_matrix(problem.bodies, room.stage.motion[1], M)
    K[:] = M
    for i in range(nc):
        K[i] = 0.0
        for k in range(nc):
            yields = 0.0
            for m in range(nm):
                yields += S[i, m] * S[k, m]
            for j in range(nz):
                K[i, j] += yields * M[k, j]
        K[i, i] += 1.0
    update, moved = np.zeros(nz), np.zeros(nz)
    update[axis] = state.held[axis] - change
    for n in range(problem.bent.size):
        i = problem.bent[n]
        if room.stage.zone[PTO_ZONE, i] == HELD:
            K[i] = 0.0
            K[i, i] = 1.0
            update[i] = -state.ddz[2, i - nc]
    if not factorize(K, pivot):
        return False
    substitute(K, pivot, update)
    for i in range(nz):
        for j in range(nz):
            moved[i] += M[i, j] * update[j]
    for n in range(problem.bent.size):
        i = problem.bent[n]
        if room.stage.zone[PTO_ZONE, i] == HELD:
            state.held[i] -= moved[i] + (change if i == axis else 0.0)
        else:
            state.held[i] = 0.0
    for m in range(nm):
        for i in range(nc):
            state.ddp[m] -= S[i, m] * moved[i]
            state.force[2, m] -= S[i, m] * moved[i]
    state.ddz[2] += update[nc:]
    return True


# ---- the constants of a piece


@part_kernel
def _of_length(problem: Problem, length: float, smooths: bool, fine: Fine) -> Problem:
    """The problem for steps of this length [s]; Newton's tolerance goes by that: on a stop loads are large."""
    share, scheme = length / problem.dt, fine.smoothing if smooths else problem.scheme
    own = -length if smooths else length
    if fine.length[0] != own:
        _fill_memory(problem.beta, length, fine.memory)
        fill_flexibility(problem.structure, length, scheme, fine.inverse, fine.H)
        shorter_part(problem.bodies, problem.constant, problem.dt, length, fine.constant)
        fine.length[0], fine.shared[0] = own, 0
    return Problem(
        problem.bodies,
        problem.structure,
        fine.memory,
        fine.inverse,
        fine.H,
        fine.constant,
        problem.stiffness,
        problem.beta,
        problem.bent,
        problem.pace,
        problem.swing,
        length,
        max(problem.tolerance * share, LEAST),
        problem.near / share,
        problem.iterations,
        True,
        share <= SHORT,
        scheme,
    )


@lean_kernel
def _fill_memory(beta: np.ndarray, h: float, memory: Memory) -> None:
    """Decay, weights and direct part for steps of h [s], see assembly.memory; by Gauss's rule."""
    memory.direct[:] = 0.0
    for q in range(beta.size):
        half = np.exp(beta[q] * (h / 2))
        memory.decay[0, q], memory.decay[1, q] = half, half * half
        for s in range(2):
            for j in range(3):
                memory.weight[s, j, q] = 0.0
        for g in range(POINTS.size // 2):  # in pairs: what is left of one is what is lost of the other
            lost = np.exp(beta[q] * (h / 2 * POINTS[g]))
            left = half / lost
            for j in range(3):
                memory.weight[0, j, q] += h * (SHARES[g, 0, j] * left + SHARES[-1 - g, 0, j] * lost)
                memory.weight[1, j, q] += h * (SHARES[g, 1, j] * left * left + SHARES[-1 - g, 1, j] * lost * lost)
        for s in range(2):
            for j in range(2):
                real, imag = memory.weight[s, 1 + j, q].real, memory.weight[s, 1 + j, q].imag
                for i in range(memory.residue.shape[1]):
                    for k in range(memory.residue.shape[2]):
                        residue = memory.residue[q, i, k]
                        memory.direct[s, j, i, k] += residue.real * real - residue.imag * imag


@lean_kernel
def _sample(drive: Drive, at: float, n: int, fine: Fine) -> None:
    """What the wave drives at a sample that need not be whole, as row n of the piece's own drive."""
    first, count = nearest(at, drive.modal.shape[0], fine.weight), min(NODES, drive.modal.shape[0])
    own = fine.drive
    own.field[n] = 0.0
    own.excitation[n] = 0.0
    own.modal[n] = 0.0
    own.station[n] = 0.0
    own.wet[n] = 0.0
    own.push[n] = 0.0
    for j in range(count):
        w, m = fine.weight[j], first + j
        _add(w, drive.field[m], own.field[n])
        _add(w, drive.modal[m], own.modal[n])
        for b in range(own.excitation.shape[1]):
            _add(w, drive.excitation[m, b], own.excitation[n, b])
        for d in range(own.station.shape[1]):
            _add(w, drive.station[m, d], own.station[n, d])
        _add(w, drive.wet[m], own.wet[n])
        for d in range(own.push.shape[1]):
            _add(w, drive.push[m, d], own.push[n, d])


@inner_kernel
def _add(weight: float, source: np.ndarray, target: np.ndarray) -> None:
    for i in range(source.size):
        target[i] += weight * source[i]
