"""The radiation memory fitted to coefficients: poles by vector fitting, then passive residues."""

from dataclasses import dataclass, replace

import numpy as np

from solver.errors import InputError, SimulationFailed
from solver.hydrodynamics.radiation.memory import RadiationMemory
from solver.hydrodynamics.radiation.passivity import (
    UNPASSIVE,
    Constraint,
    enforce,
    least_damping,
    own_transfers,
    radiates,
)
from solver.hydrodynamics.radiation.rational import FEWEST, basis, complex_residues, mixed, relocated, starting_poles

USUAL = 5e-3  # tolerance, where none is asked for
PAIRS = 30  # of poles, at most
FALL = 6  # misfits count less beyond the peak of the diagonal, as its frequency over ω to this power
HOPELESS = 4  # times the tolerance: so far away no weights will help
LOOSER = 2  # times the tolerance, where it is not met: of poles chosen for less, passive residues are more easily found
UNRESOLVED = 0.1  # of what misfits count, where frequencies are too far apart
BETTER = 0.9  # of a misfit above the tolerance: what one with more poles must have
LOST = 1.0  # a misfit as large as what is fitted
LOOSE = 0.5  # of the peak's frequency: where the BEM's A∞ is one more sample
SETTLE, EQUALIZE = 4, 12  # relocations of the poles: with even weights, then with weights that lower the largest misfit


def fit(
    omega: np.ndarray,
    added_mass: np.ndarray,
    radiation_damping: np.ndarray,
    added_mass_inf: np.ndarray,
    tolerance: float = USUAL,
    lengths: np.ndarray | None = None,
    body: np.ndarray | None = None,
    moved: np.ndarray | None = None,
    resolved: np.ndarray | None = None,
    hold: float = LOOSE,
    certain: np.ndarray | None = None,
) -> RadiationMemory:
    """The passive memory of least order whose misfit of B - iωA is at most `tolerance`, else one of nearly the best.

    omega: (nw,) > 0 [rad/s]; added_mass, radiation_damping: (nw, n, n); added_mass_inf: (n, n).
    Misfits of entry ij are relative to sqrt(y_i y_j), y_i the largest |B_ii - iω(A_ii - A∞_ii)|, and
    beyond the frequency ω_p where the diagonal over `lengths`² peaks they count less, 1/(1 + (ω/ω_p)⁶): velocities
    fall off about so fast, seas with ω^-2.5, the wave's force on a hull with ω^-2, and mass with ω^-1; and waves
    reflected between bodies ripple there faster than the BEM's frequencies show. A∞ is fitted along:
    the BEM's has an error too, and counts as one more sample at `hold` times ω_p.
    Frequencies at which the damping is far from passive are left out: water caught between bodies resonates there, and
    boundary elements say nothing. Y(0) = 0 holds exactly: there is no damping of slow drift. `lengths` (n,) [m] tell
    motions that radiate nothing but mesh error, such as a sphere turning: 1 for translations, the body's size for
    rotations; ones by default. `body` (n,) tells whose they are, and beside which they are judged, if not beside all
    that there are; by default one has them all. `certain` (n,) radiate more than that, however little; by default
    nobody knows of any. `moved` (n,) are the motions that there are, all by default: the damping of these must be
    passive. What they do to the others is load on joints, without work, and fitted beside; the rest is zero, and all of
    it where none that there is radiates more than mesh error.
    resolved: (nw,) whether frequencies are close enough to each other to tell what goes on between them, all by
    default: elsewhere no poles are sought, and misfits count UNRESOLVED of that.
    """
    if not 0 < tolerance < LOST:
        raise InputError("memory_tolerance", tolerance, f"must be between 0 and {LOST:g}")
    found = samples(omega, added_mass, radiation_damping, added_mass_inf, lengths, body, moved, resolved, hold, certain)
    if found is None:  # as a cylinder in yaw
        none = np.zeros((0, *added_mass_inf.shape), complex)
        return RadiationMemory(beta=np.zeros(0, complex), residue=none, added_mass_inf=added_mass_inf, error=0.0)
    if found.most < FEWEST:
        raise SimulationFailed(f"radiation memory: {found.resolved.sum()} frequencies that tell anything are too few")
    looser, known = tolerance, dict[int, float]()
    while looser < LOST:
        memory = found.simplest(tolerance, looser, known)
        if memory is not None:
            return memory
        looser *= LOOSER
    raise SimulationFailed(
        "radiation memory: no passive fit comes closer to the coefficients than their own size; where water resonates"
        " in a gap between bodies they are too sharp: solver.gap_damping and gap_width damp it, interaction = false"
        ' leaves it out, and method = "frequency" needs no memory'
    )


def samples(
    omega: np.ndarray,
    added_mass: np.ndarray,
    radiation_damping: np.ndarray,
    added_mass_inf: np.ndarray,
    lengths: np.ndarray | None = None,
    body: np.ndarray | None = None,
    moved: np.ndarray | None = None,
    resolved: np.ndarray | None = None,
    hold: float = LOOSE,
    certain: np.ndarray | None = None,
) -> "Samples | None":
    """What `fit` fits, of its arguments; None where nothing that moves radiates more than mesh error."""
    n = len(added_mass_inf)
    lengths = np.ones(n) if lengths is None else np.asarray(lengths, float)
    body = np.zeros(n, int) if body is None else body
    moved = np.ones(n, bool) if moved is None else np.asarray(moved, bool)
    size = own_transfers(omega, added_mass, radiation_damping, added_mass_inf).max(axis=0)
    certain = np.zeros(n, bool) if certain is None else certain
    heard = radiates(size, lengths, body) | certain
    if not np.any(moved & heard):
        return None
    heard |= radiates(size, lengths, body, moved)
    impedance = added_mass + 1j * radiation_damping / omega[:, None, None]
    least = least_damping(impedance[:, moved][:, :, moved], lengths[moved], body[moved])
    sound = least >= -UNPASSIVE
    if sound.mean() < 0.5:
        worst = float(omega[least.argmin()])
        raise SimulationFailed(
            f"radiation memory: the damping takes power from the waves it radiates at {(~sound).sum()} of {omega.size}"
            f" frequencies, most at {worst:.4g} rad/s: these are no coefficients of passive bodies"
        )
    told = sound if resolved is None else sound & resolved
    known = added_mass[sound], radiation_damping[sound], added_mass_inf
    return Samples.of(omega[sound], *known, lengths, heard, moved, told[sound], sound, hold)


@dataclass(frozen=True, eq=False, kw_only=True)
class _Candidate:
    """Poles, with the least-squares problem of the scaled residues and A∞ and its free solution's misfit."""

    poles: np.ndarray
    span: np.ndarray  # of residues with Y(0) = 0
    columns: np.ndarray
    target: np.ndarray
    error: float
    even: np.ndarray  # (nw,) the weights of `columns` were `weight` times these


@dataclass(frozen=True, eq=False, kw_only=True)
class Samples:
    """Samples of conj(Y) + iωA∞ = B + iωA at s = iω, scaled to 1, of m entries.

    Only of those motions that radiate: first the upper triangle of the n that there are, then rows of others in them.
    """

    omega: np.ndarray  # (nw,)
    resolved: np.ndarray  # (nw,) bool
    samples: np.ndarray  # (nw, m) complex
    weight: np.ndarray  # (nw,) of the least squares
    counts: np.ndarray  # (nw, m) what a misfit counts, of that
    usual: np.ndarray  # (nw, m) the same where nothing is more important than its share of the largest
    sound: np.ndarray  # bool, which of all frequencies these are
    infinite: np.ndarray  # (m,) scaled A∞
    n: int
    anchor: float  # at which A∞ is one more sample [rad/s]
    entries: tuple[np.ndarray, np.ndarray]  # (m,) rows and columns
    scale: np.ndarray  # (m,) sqrt(y_i y_j)
    whole_infinite: np.ndarray  # (N, N) [kg, ...] A∞ of all motions

    @classmethod
    def of(
        cls,
        omega: np.ndarray,
        added_mass: np.ndarray,
        damping: np.ndarray,
        infinite: np.ndarray,
        lengths: np.ndarray,
        heard: np.ndarray,
        moved: np.ndarray,
        resolved: np.ndarray,
        sound: np.ndarray,
        hold: float,
    ) -> "Samples":
        """Samples of the motions that radiate, which are `heard` (n,); arguments as of `fit`."""
        transfer = damping + 1j * omega[:, None, None] * (added_mass - infinite)
        diagonal = own_transfers(omega, added_mass, damping, infinite)
        own, other = np.flatnonzero(heard & moved), np.flatnonzero(heard & ~moved)
        upper, root = np.triu_indices(len(own)), np.sqrt(diagonal.max(axis=0))
        i = np.concatenate([own[upper[0]], np.repeat(other, len(own))])
        j = np.concatenate([own[upper[1]], np.tile(own, len(other))])
        peak = omega[np.argmax((diagonal / lengths**2)[:, own].sum(axis=1))]
        whole_infinite, scale = (infinite + infinite.T) / 2, root[i] * root[j]
        total = transfer + 1j * omega[:, None, None] * infinite
        counts = 1 / (1 + (omega[:, None] / peak) ** FALL)
        counts = counts * np.where(resolved, 1.0, UNRESOLVED)[:, None]
        counts = np.repeat(counts, i.size, axis=1)
        weight = counts.max(axis=1)
        return cls(
            omega=omega,
            resolved=resolved,
            samples=(total[:, i, j] / scale + total[:, j, i] / scale) / 2,
            weight=weight,
            counts=counts / weight[:, None],
            usual=counts / weight[:, None],
            sound=sound,
            infinite=whole_infinite[i, j] / scale,
            n=len(own),
            anchor=float(hold * peak),
            entries=(i, j),
            scale=scale,
            whole_infinite=whole_infinite,
        )

    @property
    def most(self) -> int:
        """Pairs of poles that can be told."""
        return min(PAIRS, len(self.omega) // 2, 2 * int(self.resolved.sum()) // 3)

    def counting(self, importance: np.ndarray) -> "Samples":
        """With misfits that count as much as they change of what the memory is for, where that is more.

        importance: of a unit of each entry at all frequencies, (nw', n', n') of all motions.
        """
        i, j = self.entries
        asked = np.maximum(importance[self.sound][:, i, j], importance[self.sound][:, j, i]) * self.scale
        usual = self.usual * self.weight[:, None]
        counts = np.maximum(usual, asked * np.where(self.resolved, 1.0, UNRESOLVED)[:, None])
        weight = counts.max(axis=1)
        return replace(self, weight=weight, counts=counts / weight[:, None], usual=usual / weight[:, None])

    def with_poles(self, poles: np.ndarray) -> RadiationMemory | None:
        """The passive fit of residues to these poles (p,) that leaves the least of what counts; None if all is lost."""
        best, misfit = self._solved(poles, even := np.ones(self.omega.size))
        for _ in range(1, EQUALIZE):
            even = _evened(even, misfit)
            candidate, misfit = self._solved(poles, even)
            if candidate.error < best.error:
                best = candidate
        return self.passive(best, LOST)

    def simplest(self, asked: float, looser: float, known: dict[int, float]) -> RadiationMemory | None:
        """The passive fit of least order with the misfit asked for; else the best that is within the looser one.

        known: misfits that no fit with so many pairs falls below; they are added to.
        """
        best, tolerance = None, looser
        for pairs in range(FEWEST, self.most + 1):
            if known.get(pairs, 0.0) > tolerance:
                continue
            candidate = self.unconstrained(pairs, tolerance)
            known[pairs] = candidate.error / (HOPELESS if candidate.error > HOPELESS * tolerance else 1)
            memory = self.passive(candidate, tolerance) if candidate.error <= tolerance else None
            if memory is not None:
                best, tolerance = memory, max(asked, BETTER * memory.error)
                if memory.error <= asked:
                    break
        return best

    def unconstrained(self, pairs: int, tolerance: float) -> _Candidate:
        """Poles by vector fitting, and how well they do without regard to passivity.

        Least squares leave their largest misfit where samples are few. After the poles have settled
        each sample's weight is therefore multiplied by the root of its misfit, again and again
        (Lawson 1961), and the best of these fits is kept.
        """
        at, even = self.resolved, np.ones(self.omega.size)
        poles = starting_poles(self.omega[at], pairs)
        best: _Candidate | None = None
        strictly = mixed((self.samples - 1j * self.omega[:, None] * self.infinite)[at], tolerance)
        for n in range(SETTLE + EQUALIZE):
            poles = relocated(poles, self.omega[at], strictly, (self.weight * even)[at])
            if n < SETTLE:
                continue
            candidate, misfit = self._solved(poles, even)
            if best is None or candidate.error < best.error:
                best = candidate
            if best.error > HOPELESS * tolerance:
                break
            even = _evened(even, misfit)
        assert best is not None  # EQUALIZE > 0
        return best

    def _solved(self, poles: np.ndarray, even: np.ndarray) -> tuple[_Candidate, np.ndarray]:
        """Least squares with fixed poles, and the largest misfit at each frequency (nw,)."""
        span = np.linalg.svd(basis(poles, np.zeros(1)).real)[2][1:].T
        weight = (self.weight * even)[:, None]
        columns = weight * np.column_stack([basis(poles, self.omega) @ span, 1j * self.omega])
        target = weight * self.samples
        anchor = np.append(np.zeros(span.shape[1]), self.anchor)
        columns = np.vstack([columns.real, columns.imag, anchor])
        target = np.vstack([target.real, target.imag, self.anchor * self.infinite])
        residual = columns @ np.linalg.lstsq(columns, target, rcond=None)[0] - target
        misfit = self._misfit(residual, self.counts, even)
        fitted = _Candidate(
            poles=poles, span=span, columns=columns, target=target, error=float(misfit.max()), even=even
        )
        return fitted, misfit

    def passive(self, candidate: _Candidate, tolerance: float) -> RadiationMemory | None:
        """The nearest residues and A∞ with Re Y >= 0 at all frequencies; None where their misfit is larger."""
        n, poles, span = self.n, candidate.poles, candidate.span
        own, other = np.split(candidate.target, [n * (n + 1) // 2], axis=1)
        counts = self.counts[:, : own.shape[1]]

        def misfit(solution: np.ndarray) -> float:
            return float(self._misfit(candidate.columns @ solution - own, counts, candidate.even).max())

        solution = enforce(candidate.columns, own, Constraint(poles=poles, span=span, n=n), misfit, tolerance)
        if solution is None or misfit(solution) > tolerance:
            return None
        solution = np.hstack([solution, np.linalg.lstsq(candidate.columns, other, rcond=None)[0]])
        residue, infinite = np.zeros((len(poles), *self.whole_infinite.shape), complex), self.whole_infinite.copy()
        for i, j in (self.entries, self.entries[::-1]):
            residue[:, i, j] = complex_residues(poles, span @ solution[:-1]) * self.scale
            infinite[i, j] = solution[-1] * self.scale
        error = float(self._misfit(candidate.columns @ solution - candidate.target, self.usual, candidate.even).max())
        return RadiationMemory(beta=poles, residue=residue, added_mass_inf=infinite, error=error)

    def _misfit(self, residual: np.ndarray, counts: np.ndarray, even: np.ndarray) -> np.ndarray:
        real, imag = residual[:-1].reshape(2, len(self.omega), -1)
        return np.asarray((counts * np.hypot(real, imag)).max(axis=1) / even)


def _evened(even: np.ndarray, misfit: np.ndarray) -> np.ndarray:
    """Weights (nw,) that lower the largest misfit (nw,) of these."""
    more = even * np.sqrt(np.maximum(misfit / misfit.max(), 1e-2))
    return np.asarray(more / np.sqrt(np.mean(more**2)))
