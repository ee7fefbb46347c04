"""What an arm's exact rotation does, of second order: forces keep their place on a lever that turns.

With the motions J(z)ż of the reference points, loads W on the floats and s = (z, ż, z̈), JᵀW is of second order in waves

    (JᵀW)₂ = ½ Σᵢⱼ sᵢsⱼ ∂ᵢ∂ⱼ(JᵀW in still water) + Σᵢ zᵢ ∂ᵢJᵀ W',

W' what waves and radiation's memory add to the loads in still water. Two waves make a load at the difference of their
frequencies. It drives a shape φ of unit inertia that swings below all waves and is damped by little, B, and whose
spectrum S of φᵀ(JᵀW)₂ is flat there, with the variance

    ⟨y²⟩ = π S(ω₀)/(2Bω₀²).

No line of the linear response has it: `rotation_effect` tells how much it is. What second-order motions add has no
mean, for those are rates of something that stays. By the mean the coordinates shift by C⁻¹⟨(JᵀW)₂⟩, as the march's do
(`python -m studies.validate frequency-domain`), 0.02 rad of Buan's front float. The record's means have it.

The linear model is about those at rest all the same. In Buan's representative sea, platform fixed, it would have 2.6
and 1.0 % more power about the shifted ones, and a march that preloads hold at rest on average has 2.6 and 2.2 % less
than the linear model; by itself it has 0.3 and 1.3 % less. What else is of third order, levers averaged over their turn
and motions at sums and differences of two frequencies, takes more than the shift gives; the shift without it would be
worse than neither. How much all of it is: see harmonics, and of what is slower than all waves `below_the_waves`.
"""

from collections.abc import Iterable, Mapping
from dataclasses import replace
from functools import lru_cache
from typing import NamedTuple

import numpy as np

from solver.coupled.equilibrium import balance
from solver.coupled.system import Resting, known_differences
from solver.frequency import second_order
from solver.frequency.case import KNOWN, NARROW, Case
from solver.frequency.catenaries import held, without_lines
from solver.frequency.drag_effect import Effect
from solver.frequency.gaussian import covariance
from solver.frequency.harmonics import BelowWaves, turning_effect
from solver.frequency.outputs import Forces
from solver.frequency.response import Response
from solver.lines import real_by_complex, some, squares
from solver.multibody.joint_law import JointLaw
from solver.record.beside import LIGHTLY, below
from solver.statistics import STATISTICS

ROUNDING = 1e-12  # of the largest variance
# Coordinates of floats, for all differences of frequencies and for resonances alone: the memory that curvatures of more
# take goes with their cube.
CURVED, LARGEST = 48, 96
MANY, BINS = 40, 12  # waves that stand for all of a sea, and frequencies for their differences
HOLE = 0.5  # of what waves are apart: where their differences leave so much out, these are few
REACH = 2.0  # standard deviations of a band of frequencies, each as wide as waves are apart


class _Swinging(NamedTuple):
    """A shape below the waves, and what makes its load; np pairs of waves whose frequencies differ by about its own."""

    omega: float
    shape: np.ndarray  # φ (n,)
    radiated: float  # part of B
    along: second_order.Along
    pairs: np.ndarray  # (2, np)
    apart: np.ndarray  # (np,) their frequencies [rad/s]
    band: np.ndarray | None  # g (np,) [s/rad] of each; None where differences leave the shape's own frequency out

    def seen(self, B: float) -> np.ndarray:
        """g (np,) by damping B: of waves that are few, or evenly spaced, by |H|² at each."""
        if self.band is not None:
            return self.band
        H = 1 / (self.omega**2 - self.apart**2 - 1j * B * self.apart)
        return np.asarray(2 * B * self.omega**2 / np.pi * np.abs(H) ** 2)


def turned(case: Case, response: Response) -> Response:
    """With what it adds to the means; where no joint turns and no line holds, nothing."""
    if not (second_order.turning(case.system.resting).angles.any() or case.channels.lines):
        return response
    (x, wrench, carried), was = mean_shift(case, response), response.mean
    mean = was._replace(x=was.x + x, wrench=was.wrench + wrench, carried=was.carried + carried)
    return replace(response, mean=mean)


def mean_shift(case: Case, response: Response) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Of the linear model's coordinates (n,) [m, rad, ...] and the loads on the floats (nb, 6) and, by them, on the
    carriers (nc,), without drag's."""
    model, resting, borne = case.model, case.system.resting, response.wrench
    turning, states = second_order.turning(resting), second_order.states(response.omega, response.Z)
    nz, n = turning.angles.size, states.shape[1]
    together = covariance(states, np.concatenate([states, borne.reshape(len(borne), -1)], axis=1))
    load, wrench = _in_still_water(resting, together[:, :n])
    of_lines = held(case, response.Z, case.system.equilibrium[0]) if case.channels.lines else None
    if of_lines is not None:  # far from quadratic
        load, wrench = load + of_lines.load, wrench + of_lines.wrench
    slopes = known_differences(resting).wrench.reshape(3, -1, nz).swapaxes(1, 2).reshape(n, -1)
    of_waves = together[:nz, n:] - together[:nz, :n] @ slopes  # ⟨zᵢ W'⟩
    load += np.tensordot(of_waves, turning.levers.reshape(nz, -1, nz), 2)
    wrench += np.einsum("ibrs,ibs->br", turning.directions, of_waves.reshape(nz, -1, 6))
    if of_lines is None:
        x = case.shift(model.shape.T @ load)
    else:
        x = case.shift(model.shape.T @ load, model.shape.T @ of_lines.stiffness @ model.shape)
        load -= of_lines.stiffness @ model.shape @ x
        wrench += of_lines.slope @ model.shape @ x
    on_carriers = case.carried_by(x)
    return x, wrench + model.wrench[0] @ x, on_carriers + load[: on_carriers.size]


def _in_still_water(resting: Resting, of_states: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """½ Σᵢⱼ ⟨sᵢsⱼ⟩ ∂ᵢ∂ⱼ of JᵀW (nz,) and W (nb, 6) but for lines', along principal directions of the covariance of s
    (3nz, 3nz)."""
    body, _, z = resting.value
    variance, ways = np.linalg.eigh(of_states)
    used = variance > ROUNDING * variance.max(initial=0.0)
    body = without_lines(body)
    sides = second_order.NEAR * np.concatenate([ways[:, used].T, -ways[:, used].T, np.zeros((1, len(ways)))])
    at, rate, acceleration = np.split(sides, 3, axis=-1)
    half, n = variance[used] / (2 * second_order.NEAR**2), int(used.sum())
    load, wrench, *_ = balance(body, z + at, rate, acceleration)
    of_load, of_wrench = (np.tensordot(half, f[:n] + f[n : 2 * n] - 2 * f[-1], 1) for f in (load, wrench))
    return of_load, of_wrench


def rotation_effect(
    case: Case, law: JointLaw, response: Response, frame: Forces, told: Mapping[str, np.ndarray]
) -> Effect:
    """What angles that are not small change, see harmonics, or what they drive below the waves; told: statistics."""
    angles, free = second_order.turning(case.system.resting).angles, np.full(case.system.resting.value[2].size, True)
    free[case.system.structure.carrier.shape[0] :] = ~response.stuck  # what friction holds moves by next to nothing
    if not response.Z[:, angles & free].any():
        return Effect(0.0, 1.0)
    compression = told["bottom_stress"][..., STATISTICS.index("std")] if "bottom_stress" in told else np.zeros(0)
    swinging = resonant(case, response)
    slow, all_of_it = slow_motions(case, response, swinging) ** 2, angles.size <= CURVED
    if all_of_it:
        slow += below_the_waves(case, response)
    others = _others(case, (of.shape for of, _ in swinging))
    return turning_effect(case, law, response, frame, angles, BelowWaves(others, slow, all_of_it, compression))


def _others(case: Case, shapes: Iterable[np.ndarray] = ()) -> np.ndarray:
    """(n, n) by which loads (…, n) keep what moves neither shapes (n,) nor those that nothing holds."""
    mass = case.model.mass
    moved = np.array([*case.modes.shapes[:, case.modes.omega == 0].T, *shapes]).reshape(-1, len(mass))
    inertia = moved @ mass
    return np.asarray(np.eye(len(mass)) - moved.T @ np.linalg.solve(inertia @ moved.T, inertia))


class _Slowly(NamedTuple):
    """A case at frequencies below its waves."""

    omega: np.ndarray  # (K,) [rad/s]
    Z: np.ndarray  # (K, n, n) without dampers
    others: np.ndarray  # (n, nz) of loads on the floats, but for what moves a shape that nothing holds
    width: float  # between waves that stand for all: what resonates more narrowly is damped more, see slow_motions


@lru_cache(maxsize=KNOWN)
def _slowly(case: Case) -> _Slowly:
    omega, model = case.waves, case.model
    width = float(np.ptp(omega) / min(MANY, omega.size))
    at = np.geomspace(min(width / 3, omega.min()) or omega.min(), omega.min(), BINS)
    Z = model.dynamic_stiffness(at, case.impedance_at(at))
    return _Slowly(at, Z - 2j * width * at[:, None, None] * model.mass, _others(case).T @ model.shape.T, width)


def below_the_waves(case: Case, response: Response) -> np.ndarray:
    """Variance (n,) of what differences of frequencies below the waves move, but for narrow resonances:

    Σ ½|Z⁻¹f|² over pairs of waves, f = ½ (z⋆b + b⋆z + s⋆Hs) of their z, s and b = W' on levers, the second conjugate.
    At most MANY waves stand for those beside them, half of these for equal shares of what turns, half evenly.
    """
    waves, model, resting = case.waves.size, case.model, case.system.resting
    if waves == 1:
        return np.zeros(len(model.mass))
    of, order = _slowly(case), np.argsort(case.waves)
    power = squares(response.Z[:waves, second_order.turning(resting).angles]).sum(axis=1)[order]
    power = np.maximum(power, ROUNDING * power.max())
    group = np.arange(waves)
    if waves > MANY:
        share = np.cumsum(power / power.sum() + 1 / waves) * MANY / 2
        group = np.minimum(share, MANY - 0.5).astype(int)
    first = np.flatnonzero(np.diff(group, prepend=-1))  # of each group
    whole, fourth = (np.add.reduceat(x, first) for x in (power, power**2))
    largest = np.lexsort((-power, group))[first]
    place, height = order[largest], np.sqrt(whole / power[largest])
    omega = case.waves[place]
    apart = omega[:, None] - omega + np.diag(np.full(omega.size, of.width / 3))
    weight = 1 - np.diag(1 + fourth / whole**2) / 2
    i, j = np.nonzero((weight > 0) & (apart > 0) & (apart < case.waves.min()))
    near = np.searchsorted(np.sqrt(of.omega[1:] * of.omega[:-1]), apart[i, j])
    X, z, wrench = (some(each, place, height) for each in (response.X, response.Z, response.wrench))
    s, both = second_order.states(omega, z), second_order.both(resting)
    half = real_by_complex(both.reshape(-1, both.shape[-1]), s.T).reshape(*both.shape[:2], omega.size)
    half = half.swapaxes(1, 2) @ np.concatenate([second_order.added(case, omega, X, wrench), s], axis=1).conj().T
    load = 0.5 * np.sqrt(weight[i, j] / 2) * (half[:, i, j] + half[:, j, i].conj())
    square = np.array([part @ part.conj().T for part in (load[:, near == k] for k in range(of.omega.size))])
    receptance = np.linalg.solve(of.Z - 1j * of.omega[:, None, None] * response.damping, of.others)
    return np.asarray(np.sum(receptance @ square * receptance.conj(), axis=(0, 2)).real)


def resonant(case: Case, response: Response) -> list[tuple[_Swinging, float]]:
    """Shapes below the waves that are damped lightly, and by how much, B; by next to nothing, if by nothing."""
    damping, found = case.model.damping + response.damping, []
    for of in _swinging(case):
        B = float(of.shape @ damping @ of.shape + of.radiated)
        if 2 * LIGHTLY * of.omega > B:
            found.append((of, max(B, 2 * NARROW * of.omega)))
    return found


def slow_motions(case: Case, response: Response, swinging: Iterable[tuple[_Swinging, float]]) -> np.ndarray:
    """Their std (n,) of the linear model's coordinates [m, rad, ...]."""
    waves, variance = case.waves.size, np.zeros(len(case.model.mass))
    swinging = list(swinging)
    if not swinging:
        return variance
    added = second_order.added(case, case.waves, response.X[:waves], response.wrench[:waves])
    for of, B in swinging:
        S = _spectrum(of, of.seen(B), case.waves, response.Z[:waves], added)
        variance += np.pi * S / (2 * B * of.omega**2) * of.shape**2
    return np.sqrt(variance)


def _spectrum(of: _Swinging, band: np.ndarray, omega: np.ndarray, z: np.ndarray, added: np.ndarray) -> float:
    """S of its load at its own frequency, one-sided: ½ Σ |f|² g over the pairs of waves omega (nw,),

    see second_order.Along. added: W' (nw, 6nb).
    """
    each, (i, j) = (z, second_order.states(omega, z), added), of.pairs
    f = second_order.load(of.along.first(*each).take(i, axis=0), of.along.second(*each).take(j, axis=0))
    return float(0.5 * squares(f) @ band)


@lru_cache(maxsize=KNOWN)
def _swinging(case: Case) -> tuple[_Swinging, ...]:
    """The shapes below the waves; none of a single wave, nor without floats."""
    model, omega, shapes = case.model, case.waves, below(case.system, case.hydrodynamics)
    if not (shapes.omega.size and case.system.scene.floats) or len(model.shape) > LARGEST:
        return ()
    width, order, found = np.ptp(omega) / (omega.size - 1), np.argsort(omega), []
    for own, shape, radiated in zip(shapes.omega, shapes.shapes, shapes.radiated, strict=True):
        along = second_order.Along.of(case.system.resting, model.shape @ shape)
        begin, end = np.searchsorted(omega[order], [omega + own - REACH * width, omega + own + REACH * width])
        higher = order[np.concatenate([np.arange(*ends) for ends in zip(begin, end, strict=True)])]
        pairs = np.stack([higher, np.repeat(np.arange(omega.size), end - begin)])
        apart = np.subtract(*omega[pairs])
        off = (apart - own) / width
        band = None if _left_out(off) else np.exp(-0.5 * off**2) / (width * np.sqrt(2 * np.pi))
        found.append(_Swinging(own, shape, radiated, along, pairs, apart, band))
    return tuple(found)


def _left_out(off: np.ndarray) -> bool:
    """Whether those (np,) next to zero on either side are far from each other."""
    above, below = (side[side >= 0].min(initial=np.inf) for side in (off, -off))
    return bool(above + below > HOLE)
