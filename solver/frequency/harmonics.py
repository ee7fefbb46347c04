"""What waves move where arms turn exactly, by harmonic balance: to tell how much the linear response errs.

x = X₀ + Re Σ Xₘ exp(-i m·ω t) over sums m·ω of the frequencies of a wave or two, of some order at most. With the loads
JᵀW of the march's own kernel at some instants, the waves' and the radiated ones W' on levers J(z) that turn, and N what
all of it has beyond the linear model's loads,

    Z(m·ω) Xₘ = Fₘ + Nₘ(X)

again until it agrees with its own result. Drag, dampers and loads by rate stay as they were linearised. The instants
are those of waves whose frequencies are whole numbers, `steps`, of which no two sums are the same.

For a sea two of its waves stand that share what turns the arms, each as high as half of that is. Their own lines tell
by how much the linear response is more or less, sums and differences what is there besides; beside the sea's response.
n equal waves have 1 - 1/2n of what Gaussian ones make: the part along x of x³ is 3(1 - 1/2n)σ²x, and so is the square
of x² at sums of frequencies; that at differences 1 - 1/n.
"""

from collections.abc import Iterator
from functools import lru_cache
from typing import NamedTuple

import numpy as np

from solver.frequency import gaussian
from solver.frequency.case import KNOWN, Case
from solver.frequency.drag_effect import Effect
from solver.frequency.exact import Lattice, Linear, Waves, beyond
from solver.frequency.outputs import Forces
from solver.frequency.response import Response
from solver.frequency.shape import warped
from solver.frequency.steps import Steps
from solver.frequency.subharmonics import growing
from solver.lines import real_parts, some, squares
from solver.multibody.joint_law import JointLaw
from solver.record.probe import UNTOLD
from solver.record.response import absorbs
from solver.record.sampling import least_force
from solver.remarks import beyond_lines, swings_up
from solver.statistics import FAINT

NO_BALANCE = "rotation_effect is 1 for what is not known: no response was found that agrees with exact angles"
STILL = 1e-4  # of the slowest wave's frequency: no sum is slower
ROUNDS = 20  # of which awkward scenes need 2 to 8 up to 0.3 rad
GROWS, IN_VAIN = 3.0, 4  # times the least change, and rounds since that, which no more rounds make agree
ROUNDING = 1e-10  # of the linear motions
STANDS = 0.5  # of a response's square: waves that have less of it stand for no more than they have
AGREED = 0.05  # last change of the harmonics, of what turning changes of them


ONE = Lattice.of((1,), 5, 24)  # ten harmonics change what is told by less than 1e-4 of it, up to 0.3 rad
TWO = Lattice.of((1, 7), 3, 25)


class _Standing(NamedTuple):
    """Waves that stand for all."""

    place: np.ndarray  # (nw,) which
    height: np.ndarray  # (nw,) how many times as high
    several: float  # equal waves whose squares scatter as those of all

    def lines(self, each: np.ndarray) -> np.ndarray:
        """Theirs (nw, …) of those of all waves."""
        return some(each, self.place, self.height)


class BelowWaves(NamedTuple):
    """What two waves do not tell."""

    others: np.ndarray  # (n, n) leaves of loads what moves no resonance below the waves and nothing without stiffness
    variance: np.ndarray  # (n,) of motions below the waves
    all_of_it: bool  # whether all differences of frequencies are in that, or resonances alone
    compression: np.ndarray  # (legs,) std of `bottom_stress` [Pa], which no line has


def turning_effect(
    case: Case, law: JointLaw, response: Response, frame: Forces, angles: np.ndarray, slow: BelowWaves
) -> Effect:
    """What turning changes of a response; UNTOLD where no round agrees, or what does is left: see subharmonics.

    angles (nz,): which of the floats' coordinates turn one.
    """
    standing = _standing(case, response, angles)
    waves = _waves(case, standing)
    lattice, omega, length = waves.lattice, waves.omega, case.model.length
    linear = lattice.first(standing.lines(response.X))
    Z = waves.Z - 1j * omega[:, None, None] * response.damping
    onto = np.tile(case.model.shape, (omega.size, 1, 1))
    onto[1:][np.abs(omega[1:]) < case.waves.min()] @= slow.others
    mobility = np.linalg.solve(Z[1:], onto[1:].swapaxes(1, 2))
    X, least, nearest, steps = linear, np.inf, 0, Steps(length)
    for rounds in range(ROUNDS):
        with np.errstate(over="ignore", invalid="ignore"):
            load, wrench = beyond(case, waves, X @ case.model.shape.T)
        found = linear.copy()
        found[0] += case.shift((load[0] @ onto[0]).real)
        found[1:] += (mobility @ load[1:, :, None])[..., 0]
        change, whole, size = (np.abs(x * length).max() for x in (found - X, found - linear, linear))
        if change < least:
            least, nearest = change, rounds
        if not (change < GROWS * least or change <= ROUNDING * size) or rounds - nearest == IN_VAIN:
            break
        if change <= max(AGREED * whole, ROUNDING * size):  # of one hinge along its body's axes nothing else is left
            if (of := growing(case, response, found)) is not None:
                return Effect(UNTOLD, 1.0, note=swings_up(case.system.scene, of.joint, of.size))
            # What is borne where axes are free is little: the last change's inertia and all else of it belongs to that.
            wrench = case.model.loads(omega, found - X, waves.Y, wrench)
            borne = response.wrench, lattice.first(standing.lines(response.wrench)), wrench
            told, usual, exact = map(case.channels.hinge_force, borne)
            further = found - linear
            carried = _carried(case, waves, load, (load[:, None] @ onto)[:, 0], further)
            of_motions, note = _of_motions(case, law, waves, response, linear, found, slow)
            error = max(
                of_motions,
                _of_tops(case, waves, response, linear, found),
                _of_forces(case, waves, told, usual, exact),
                *_of_frame(case, waves, frame, standing.lines(frame.lines), further, carried, slow.compression),
            )
            each = (lines.reshape(len(lines), -1) for lines in (told, usual, exact))
            return Effect(error, _extremes(case, waves, standing, *each), note=note)
        X = steps.after(X, found)
    return Effect(UNTOLD, 1.0, note=NO_BALANCE)


def _extremes(case: Case, waves: Waves, of: _Standing, told: np.ndarray, usual: np.ndarray, exact: np.ndarray) -> float:
    """Largest ones to be expected of joints' forces, lines `told` (nl, m), over those of Gaussian ones, as in a sea.

    More by γ(u - 1/u)/6 of skewness γ, and by the kurtosis, u σ Gaussian (Winterstein 1988); ⟨y₁²y₂⟩ of n equal waves
    goes as 2 - 1.5/n. usual, exact: lines (nk, m).
    """
    if case.waves.size == 1:
        return 1.0
    linear, y = (waves.lattice.at_instants(np.concatenate([0 * x[:1], x[1:]])) for x in (usual, exact))
    square, size = np.mean(y**2, axis=0), squares(told).sum(axis=0)
    least = 2 * np.repeat(least_force(case.system.scene), 3) ** 2
    used = (square > 0) & (size > np.maximum(least, FAINT**2 * size.max(initial=0.0)))
    if not used.any():
        return 1.0
    more = (2 - 1.5 / of.several) / (2 - 1.5 / len(of.place))
    skewness = np.abs(np.mean(y[:, used] ** 3, axis=0)) / square[used] ** 1.5 * more
    beyond = np.mean(y[:, used] ** 4, axis=0) / square[used] ** 2
    beyond -= np.mean(linear[:, used] ** 4, axis=0) / np.mean(linear[:, used] ** 2, axis=0) ** 2
    u = gaussian.peak(told[:, used], case.process)
    return float(np.max(warped(u, np.maximum(beyond, 0.0)) / u + skewness * (u - 1 / u) / 6))


def _standing(case: Case, response: Response, angles: np.ndarray) -> _Standing:
    """Each at the middle of a share of what turns levers."""
    power = squares(response.Z[: case.waves.size, angles]).sum(axis=1)
    order, count = np.argsort(case.waves), min(2, case.waves.size)
    share = np.cumsum(power[order]) / power.sum()
    place = order[np.searchsorted(share, (np.arange(count) + 0.5) / count)]
    place = place[: 1 + int(place[0] != place[-1])]
    several = max(power.sum() ** 2 / np.sum(power**2), len(place))
    return _Standing(place, np.sqrt(power.sum() / len(place) / power[place]), several)


def _waves(case: Case, of: _Standing) -> Waves:
    n, waves = of.several, len(of.place)
    lattice, linear = (ONE, TWO)[waves - 1], _linear(case, tuple(of.place.tolist()))
    more = np.full(linear.omega.size, (1 - 0.5 / n) / (1 - 0.5 / waves))
    if waves > 1:
        more[lattice.sums.any(axis=1) & (lattice.sums.sum(axis=1) == 0)] = (1 - 1 / n) / (1 - 1 / waves)
    return Waves.of(case, lattice, more, linear, of.lines(case.excitation))


@lru_cache(maxsize=KNOWN)
def _linear(case: Case, place: tuple[int, ...]) -> Linear:
    """Of sums of waves that stand for all: often those with other dampers."""
    sums = (ONE, TWO)[len(place) - 1].sums
    omega, slowest = sums @ case.waves[list(place)], STILL * case.waves.min()  # a shape may have no stiffness
    omega[1:] = np.where(np.abs(omega[1:]) < slowest, slowest, omega[1:])
    return Linear.of(case, omega)


def _grown(waves: Waves, full: np.ndarray, usual: np.ndarray, exact: np.ndarray) -> np.ndarray:
    """Squares (…) of a response (…), as its lines (nk, …) grow by exact ones in place of the usual."""
    own = waves.lattice.own
    was, grown = (squares(lines[own]).sum(axis=0) for lines in (usual, exact))
    others = waves.more.copy()
    others[[0, *own]] = 0.0
    besides = np.tensordot(others, squares(exact), 1)
    change = np.divide(grown - was, was, out=np.zeros(was.shape), where=was > 0)
    change *= np.minimum(1.0, np.divide(was, STANDS * full, out=np.ones(was.shape), where=full > 0))
    return np.maximum(full * (1 + waves.more[own[0]] * change) + besides, 0.0)


def _of_motions(
    case: Case, law: JointLaw, waves: Waves, response: Response, linear: np.ndarray, X: np.ndarray, slow: BelowWaves
) -> tuple[float, str]:
    """Largest relative error of a coordinate's std, and of its rate's square, mean and std, where that is power
    absorbed. How its square varies is told as by these waves: second harmonics do more to it than to its mean.

    Joints count that move by second order alone; these in words.
    """
    rate = waves.omega[:, None]
    powers = squares(response.X)
    square, of_rate = powers.sum(axis=0), response.omega**2 @ powers
    told = (np.abs(waves.omega) < case.waves.min()) & slow.all_of_it
    grown = _grown(waves, square, linear, np.where(told[:, None], 0.0, X)) + 2 * slow.variance
    std, nm = np.sqrt(0.5 * np.array([square, grown])), case.model.modes.shape[1]
    moved = case.model.length * std
    used = np.concatenate([moved[0, :nm], moved[:, nm:].max(axis=0)]) > FAINT * moved.max(initial=0.0)
    takes = used & absorbs(case.system, law)
    power = _grown(waves, of_rate, rate * linear, rate * X)
    varies = [np.std(waves.lattice.at_instants(-1j * rate * x)[:, takes] ** 2, axis=0) for x in (linear, X)]
    pairs = moved[:, used], np.array([of_rate, power])[:, takes], np.array(varies)
    before, after = np.concatenate(pairs, axis=1)
    off = np.divide(np.abs(after - before), after, out=np.sign(before), where=after > 0)
    return float(off.max(initial=0.0)), beyond_lines(case.system.scene, *(used * std)[:, nm:])


def _of_tops(case: Case, waves: Waves, response: Response, linear: np.ndarray, X: np.ndarray) -> float:
    """The same of the std of the legs' tops along x, y and z: loads that turn may push them to the side."""
    if case.channels.legs is None:
        return 0.0
    tops = case.channels.legs.tops
    modes = tops.reshape(len(tops), -1)
    full, usual, exact = (lines[:, : len(tops)] @ modes for lines in (response.X[: case.waves.size], linear, X))
    square = squares(full).sum(axis=0)
    return _changed(square, _grown(waves, square, usual, exact))


def _of_forces(case: Case, waves: Waves, forces: np.ndarray, usual: np.ndarray, exact: np.ndarray) -> float:
    """The same of joints' forces (nl, nb, 3), but for those that count as zero."""
    square = squares(forces).sum(axis=0)
    return _changed(square, _grown(waves, square, usual, exact), 2 * least_force(case.system.scene) ** 2)


def _changed(square: np.ndarray, grown: np.ndarray, least: np.ndarray | float = 0.0) -> float:
    """Of the roots of squares; those below `least`, or FAINT beside the largest, count as that."""
    size = np.sqrt(np.maximum(np.maximum(grown, least), FAINT**2 * grown.max(initial=0.0)))
    off = np.abs(np.sqrt(grown) - np.sqrt(square))
    return float(np.divide(off, size, out=np.zeros(size.shape), where=size > 0).max(initial=0.0))


def _of_frame(
    case: Case,
    waves: Waves,
    frame: Forces,
    own: np.ndarray,
    further: np.ndarray,
    carried: np.ndarray,
    compression: np.ndarray,
) -> Iterator[float]:
    """The same of what the frame's steel bears, lines `own` (nw, ny), by further motions (nk, n), their drag aside, and
    loads of the floats on the carriers (nk, nc)."""
    support, steel, P = case.system.support, case.channels.steel, further[1:, : case.system.structure.omega.size]
    if support is None or support.forces is None or steel is None:
        return
    lattice, usual, added = waves.lattice, waves.lattice.first(own), np.zeros((len(further), own.shape[1]), complex)
    rate = -1j * waves.omega[1:, None]
    added[1:] = support.forces.whole(support.forces.of_motion(rate * P, rate**2 * P, carried[1:]))
    every = (steel.channels(lines) for lines in (frame.lines, usual, usual + added))
    for (_, lines), (_, before), (_, after) in zip(*every, strict=True):
        square = squares(lines).sum(axis=0)
        yield _changed(square, _grown(waves, square, before, after))
    varies = []
    for lines in (usual, usual + added):
        axial, *bending = np.moveaxis(steel.compression(frame.level + lattice.at_instants(lines)), -1, 0)
        varies.append(np.var(axial - np.hypot(*bending), axis=0))
    change, full = waves.more[lattice.own[0]] * np.subtract(*varies[::-1]), 2 * compression**2
    yield _changed(full, np.maximum(full + 2 * change, 0.0))


def _carried(case: Case, waves: Waves, load: np.ndarray, more: np.ndarray, further: np.ndarray) -> np.ndarray:
    """On the carriers (nk, nc) by N (nk, nz), of which `more` (nk, n) makes the further motions (nk, n)."""
    model = case.model
    borne = load - (waves.against @ (further @ model.shape.T)[..., None])[..., 0]
    # What of N makes none would speed a shape up, and so is borne by that one's inertia.
    freely = np.linalg.solve(model.mass, real_parts((load @ model.shape - more).T)).view(complex)
    borne -= (model.floats[2] @ (model.shape @ freely)).T
    return np.asarray(borne[:, : case.system.structure.carrier.shape[0]])
