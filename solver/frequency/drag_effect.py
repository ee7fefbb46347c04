"""What the members' linearised drag leaves out of a frame's statistics, by how far from Gaussian drag is.

Drag in a current U is |U + u|(U + u) = F + σ_F g(z) of a normal number z, where ⟨gz⟩ = 1 and ⟨g²⟩ = V: see _Law.
Without one g is |z|z/√(8/π), V is 3π/8, and drag is far from Gaussian: ⟨g⁴⟩ is 35/3 V². In one that waves never turn
g tends to z and a little that is even, which makes extremes of one sense larger. Where drag makes a part S of a stress
by bending, and all else a Gaussian rest s, that stress is

    S g(z)/√V + s ξ;

of a frame that swings among the waves S is what is as far from Gaussian, and belongs to the rest else: see _followed.

Its higher orders are lines of the case (see beyond), or harmonics of one wave (see ringing). In a sea they go with how
fast the water is, and so does what damps them, which lines do not know: see UNSURE.
"""

from collections.abc import Iterator, Mapping
from typing import NamedTuple

import numpy as np

from solver.frequency import gaussian
from solver.frequency.case import Case
from solver.frequency.outputs import Lacks, Rung
from solver.frequency.response import Response
from solver.frequency.stations import Stations
from solver.statistics import FAINT, STATISTICS, apart

BINS = 512  # of frequencies up to the fastest wave's, in _followed
UNSURE = 0.2  # of the size of lines beyond the linear drag's: marches have 0.85 to 1.2 times those of slender piles
LITTLE = 2e-2  # share of the variance of the legs' tops below which no statistic of their stress is off by 1e-3


Z, OF_Z = gaussian.nodes(40)
XI = np.linspace(-5.0, 5.0, 61)  # evenly, for what is smooth but for a corner
OF_XI = np.exp(-0.5 * XI**2) / np.exp(-0.5 * XI**2).sum()
WEIGHT = np.outer(OF_Z, OF_XI).ravel()
LEAST = 1e-3  # of how far odd orders go: a fifth of a mode's part by drag counts as that at least
SLOPE = 5  # of damage by stress, as that of many small ranges


class Effect(NamedTuple):
    """Of what a linear response leaves out."""

    error: float  # of any mean, rms or std, relative
    extremes: float  # factor by which the largest are to be expected beyond those told
    shaken: float = 0.0  # share of orders above the linear one in tops' displacements or nodes' accelerations, squared
    wear: float = 1.0  # factor by which more damage, if asked for, is to be expected at the feet than that told
    note: str = ""  # what is to be said of an error that is not known, or whose it is


class _Law(NamedTuple):
    """Drag on the frame's foremost mode where its linear part is a normal number z: ns stations that have flows U + az.

    What goes with z is as large as the whole flow in that direction; a station counts by how much of it does.
    """

    stream: np.ndarray  # U (ns, nd) [m/s]
    wave: np.ndarray  # a (ns, nd) [m/s]
    push: np.ndarray  # (ns, nd) of the mode by its drag
    mean: float
    slope: float
    even: float = 1.0  # share of what is even that is left

    @classmethod
    def of(cls, stations: Stations, rate: np.ndarray, mode: int, Q: np.ndarray) -> "_Law":
        """At modal rates (nm, nw), of lines Q (nw,) of a mode's force."""
        if stations.stream is None:
            none = np.zeros((0, 0))
            return cls(none, none, none, 0.0, float(OF_Z @ np.abs(Z) ** 3))
        flow, frame = stations.flow(rate), stations.frame
        along = 0.5 * flow @ Q.view(float) / gaussian.spread(Q[:, None])
        size = np.linalg.norm(along, axis=0)
        e = np.divide(along, size, out=np.zeros(along.shape), where=size > 0)
        std = np.sqrt(0.5 * np.sum(np.einsum("ds,dsw->sw", e, flow) ** 2, axis=1))
        share = frame.drag * np.divide(size, std, out=np.zeros(size.shape), where=std > 0)
        g = cls(stations.stream.T, (std * e).T, (share * frame.station[mode]).T, 0.0, 1.0)
        force = g(Z)
        return g._replace(mean=float(OF_Z @ force), slope=float(OF_Z @ (force * Z)))

    def drag(self, z: np.ndarray) -> np.ndarray:
        """|u|u (…, ns, nd) of the flows."""
        flow = self.stream + np.multiply.outer(z, self.wave)
        return np.linalg.norm(flow, axis=-1, keepdims=True) * flow

    def __call__(self, z: np.ndarray) -> np.ndarray:
        """g, of any shape."""
        if not self.push.size:  # nor a current
            return np.abs(z) * z / self.slope
        g, opposite = ((np.tensordot(self.drag(x), self.push, axes=2) - self.mean) / self.slope for x in (z, -z))
        return g - 0.5 * (1 - self.even) * (g + opposite)

    def turned(self, sense: np.ndarray, z: np.ndarray) -> np.ndarray:
        """±g(±z)/√V, of what goes with the mode's force or against it."""
        return sense * self(sense * z) / np.sqrt(self.variance)

    @property
    def variance(self) -> float:
        """V."""
        return float(OF_Z @ self(Z) ** 2)


def drag_effect(case: Case, response: Response, rung: Rung, told: Mapping[str, np.ndarray]) -> Effect:
    """rung: with all that rings; told: statistics of tops and feet."""
    channels, support, waves = case.channels, case.system.support, case.waves.size
    if support is None or channels.legs is None or not case.stations.size:
        return Effect(0.0, 1.0)
    push, nm = response.drag.modes[:waves], len(channels.legs.tops)
    tops, of_tops = channels.legs.tops.reshape(nm, -1), told["top_displacement"].reshape(-1, len(STATISTICS))
    std = of_tops[:, STATISTICS.index("std")]
    moved = std > FAINT * std.max()
    tops, of_tops, std = tops[:, moved], of_tops[moved], std[moved]
    own, at = case.system.structure.omega, case.waves[:, None]
    p = push / (own**2 - 2j * case.system.structure.damping * own * at - at**2)
    driven = p @ tops
    if not driven.any():
        return Effect(0.0, 1.0)
    if rung.lacks is not None:
        return Effect(_of_one(case, rung, rung.lacks, tops, of_tops, told), 1.0)
    of_drag = slice(waves, case.omega.size)  # beside joints' loads
    shaken = gaussian.share(rung.X @ tops, of_drag)
    if channels.nodes:
        nodes = support.node_shapes.reshape(nm, -1)
        accelerations = rung.process.omega[:, None] ** 2 * rung.X @ nodes
        shaken = max(shaken, gaussian.share(accelerations, of_drag))
    error = UNSURE * shaken
    if not np.any(gaussian.spread(driven) ** 2 > LITTLE * std**2):
        return Effect(error, 1.0, shaken)
    top = int(np.argmax(gaussian.spread(driven)))
    m = int(np.argmax(np.abs(tops[:, top]) * np.linalg.norm(p, axis=0)))
    Q = push[:, m]
    g = _Law.of(case.stations, (-1j * case.waves[:, None] * response.X[:waves, :nm]).T, m, Q)
    whole, mean = response.X[:, :nm] @ tops, of_tops[:, STATISTICS.index("mean")]
    D, T, drag = p[:, m], response.X[:waves, m], response.damping[m, m]
    odd, even = _followed(case, m, 0.0, D, D, Q, 3), _followed(case, m, drag, T, D, Q, 2)
    kept, wear = max(odd, LEAST) ** 0.25, 1.0
    g = g._replace(even=float(np.clip(even / kept**3, -1 / kept, 1 / kept)))
    extremes = _beyond_rayleigh(g, kept * driven, Q, std, mean, gaussian.peak(whole, case.process))
    if channels.steel is not None:
        first = channels.legs.first
        level, lines = (channels.steel.compression(y)[:, first] for y in rung.frame)
        part = kept * channels.steel.compression(_forces_by_drag(case, response, p))[:, first]
        bending = _Bending.of(g, level[0], lines, part, Q)
        error = max(error, _apart(told["bottom_stress"][first], *bending.lacks(g)))
        if "fatigue" in case.system.scene.settings.outputs:
            # What is even in the drag, in a current, makes one sense larger and the other smaller: no range changes.
            wear = bending.wear(g._replace(even=0.0))
    return Effect(error, extremes, shaken, wear)


def _of_one(
    case: Case, rung: Rung, lacks: Lacks, tops: np.ndarray, of_tops: np.ndarray, told: Mapping[str, np.ndarray]
) -> float:
    """By one wave's harmonics, which change the mean and its own line: of tops (nm, n), statistics (n, 5), and feet."""
    steel, legs = case.channels.steel, case.channels.legs
    (level, first), lines = lacks.X @ tops, rung.X @ tops
    lines[0] += first
    error = apart(of_tops, gaussian.table(of_tops[:, STATISTICS.index("mean")] + level.real, lines, rung.process))
    if steel is not None and legs is not None:
        (mean,), lines, (level, first) = (steel.compression(y)[:, legs.first] for y in (*rung.frame, lacks.forces))
        lines[0] += first
        feet = gaussian.compression_table(mean + level.real, lines, rung.process)
        error = max(error, apart(told["bottom_stress"][legs.first], feet))
    return error


def _followed(case: Case, m: int, damping: float, T: np.ndarray, D: np.ndarray, Q: np.ndarray, order: int) -> float:
    """How far ⟨TⁿTₙ⟩ goes, by what order n of the drag moves of its foremost mode m: 1 at most, where that follows.

    A mode that swings adds up many of its forces q, unit normal ones of std σ: with R the covariance of its motion T
    and q before, and a term Hₙ(q) beside q, ⟨TⁿTₙ⟩ = σ ∫ h(τ) R(τ)ⁿ dτ of that, h from force to motion; where it
    follows Sⁿ⁺¹, S the std of what q moves, D. T, D and forces Q (nw,); damping: besides the mode's own.
    """
    w, structure = case.waves, case.system.structure
    step = w.max() / BINS
    S, sigma = gaussian.spread(np.stack([D, Q], axis=1))
    power, place = T * Q.conj() / sigma, np.rint(w / step).astype(int)
    c = np.bincount(place, power.real, 4 * BINS + 1) - 1j * np.bincount(place, power.imag, 4 * BINS + 1)
    terms = np.fft.rfft((2 * BINS * np.fft.irfft(c)) ** order) / (8 * BINS)
    terms[1:] *= 2
    at, own = step * np.arange(terms.size), structure.omega[m]
    gain = 1 / (own**2 - 1j * (2 * own * structure.damping[m] + damping) * at - at**2)
    return float(np.clip(sigma * np.sum(terms * gain).real / S ** (order + 1), -1.0, 1.0))


def _beyond_rayleigh(
    g: _Law, driven: np.ndarray, Q: np.ndarray, std: np.ndarray, mean: np.ndarray, peak: np.ndarray
) -> float:
    """Factor for the largest mean + S g(z)/√V + s ξ, in either sense, where z² + ξ² = u², reached as often as u by a
    Gaussian; of lines (nw, n) that drag drives.
    """
    part = np.minimum(np.sqrt(g.variance) * gaussian.spread(driven), std)
    turn = np.linspace(0.0, np.pi / 2, 40)[:, None]
    rest, sense = np.sqrt(std**2 - part**2) * peak * np.sin(turn), _sense(driven, Q)
    largest = [way * mean + np.max(part * g.turned(way * sense, peak * np.cos(turn)) + rest, axis=0) for way in (1, -1)]
    return float(np.max(largest / (np.abs(mean) + std * peak), initial=1.0))


def _apart(told: np.ndarray, mean: np.ndarray, variance: np.ndarray) -> float:
    """Largest relative error of mean, rms or std (n, 5) by what their mean and variance lack (n,)."""
    level, rms, std = told[:, 2:].T
    spread = np.abs(np.sqrt((std**2 + variance).clip(min=0.0)) / std - 1)
    size = np.abs(np.sqrt(((level + mean) ** 2 + std**2 + variance).clip(min=0.0)) / rms - 1)
    return float(np.max([np.abs(mean) / rms, size, spread]))


def _forces_by_drag(case: Case, response: Response, p: np.ndarray) -> np.ndarray:
    """Of the frame (nw, ny), by its drag and modes p (nw, nm) that this alone moves."""
    support, rate = case.system.support, -1j * case.waves[:, None]
    if support is None or support.forces is None:
        return np.zeros((len(p), 0))
    forces, none = support.forces, np.zeros((len(p), case.system.structure.carrier.shape[0]))
    return forces.whole(forces.of_motion(rate * p, rate**2 * p, none) + response.drag.forces[: len(p)])


def _sense(lines: np.ndarray, Q: np.ndarray) -> np.ndarray:
    """1 or -1 (…) where lines (nw, …) go with lines (nw,), or against them."""
    return np.where(np.tensordot(Q.conj(), lines, axes=1).real < 0, -1.0, 1.0)


class _Bending(NamedTuple):
    """Of legs (n,), along the line in which drag bends each most; across it as large as in the mean square."""

    mean: np.ndarray
    other: np.ndarray  # rms of what lies across
    driven: np.ndarray  # std of the drag's part,
    rest: np.ndarray  # and of all else
    sense: np.ndarray  # see _sense

    @classmethod
    def of(cls, g: _Law, mean: np.ndarray, whole: np.ndarray, part: np.ndarray, Q: np.ndarray) -> "_Bending":
        """Of means (n, 3) and lines (nl, n, 3), of the drag's part those of the waves (nw, n, 3)."""
        of_whole, of_part = _second(whole), _second(part)
        angle = 0.5 * np.arctan2(2 * of_part[2], of_part[0] - of_part[1])
        cos, sin = np.cos(angle), np.sin(angle)

        def along(moments: np.ndarray) -> np.ndarray:
            return cos**2 * moments[0] + sin**2 * moments[1] + 2 * sin * cos * moments[2]

        mean = np.array([cos * mean[:, 1] + sin * mean[:, 2], cos * mean[:, 2] - sin * mean[:, 1]])
        variance = along(of_whole)
        driven = np.minimum(np.sqrt(g.variance * along(of_part)), np.sqrt(variance))
        other = np.sqrt(mean[1] ** 2 + (of_whole[0] + of_whole[1] - variance).clip(min=0.0))
        sense = _sense(cos * part[..., 1] + sin * part[..., 2], Q)
        return cls(mean[0], other, driven, np.sqrt((variance - driven**2).clip(min=0.0)), sense)

    def lacks(self, g: _Law) -> tuple[np.ndarray, np.ndarray]:
        """What mean and variance of the compression lack."""
        before, after = (np.hypot(self.mean + x, self.other) for x in self._varies(g))
        less = WEIGHT @ (after - before)
        return -less, WEIGHT @ (after**2 - before**2) - (WEIGHT @ after) ** 2 + (WEIGHT @ before) ** 2

    def wear(self, g: _Law) -> float:
        """Factor for damage that goes by ranges to the power SLOPE."""
        before, after = (WEIGHT @ np.abs(x) ** SLOPE for x in self._varies(g))
        return float(np.max(np.divide(after, before, out=np.ones(before.shape), where=before > 0)))

    def _varies(self, g: _Law) -> Iterator[np.ndarray]:
        """Of Gaussian drag, and of drag as it is (nq, n)."""
        z = Z[:, None, None] * np.ones(self.driven.size)
        for x in (z, g.turned(self.sense, z)):
            yield (self.driven * x + self.rest * XI[:, None]).reshape(-1, self.driven.size)


def _second(lines: np.ndarray) -> np.ndarray:
    """Variances about both axes and covariance (3, n) of bending, lines (nw, n, 3)."""
    b, c = lines[..., 1], lines[..., 2]
    return 0.5 * np.sum([np.abs(b) ** 2, np.abs(c) ** 2, (b * c.conj()).real], axis=1)
