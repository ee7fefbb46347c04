"""What linearised drag leaves out of the quadratic one: forces of higher orders, as lines of their own.

They have a spectrum where the waves have none, too, and so drive a platform at resonances below and above their
band. That of forces at two places goes by the covariance of the velocities there, R = ½ Re Σ x x'* exp(-iωτ) (see
linear_drag):

    S(ω) = (1/π) ∫ Σ n! aₙaₙ' R(τ)ⁿ exp(iωτ - ½(bτ)²) dτ,

in bands of width b as all spectra here. Few places tell of all others, by a Cholesky decomposition with pivots; at each
frequency one pattern, the one that moves the frame most, stands for all forces: it is nearly all of them.
"""

from typing import NamedTuple

import numpy as np
from scipy.linalg import lapack

from solver.coupled import linear_drag
from solver.frequency.stations import Stations
from solver.record.spectra import bands

ORDERS = 3  # times the fastest wave's frequency: of higher orders next to nothing is faster
SMOOTH, EACH = 10, 6  # frequencies up to the waves' highest, and more of them about a resonance of the frame
ALIKE = 32  # highest frequencies of seas in an octave that are told apart
LEFT = 3e-3  # share of the forces that places which are looked at do not tell of
REACH = 4.0  # over a band's width: times apart up to which covariances are looked at
TURNS = 5  # of the power method: the largest pattern is many times the next


class Nodes(NamedTuple):
    """Frequencies that stand for all up to ORDERS times the waves' highest."""

    omega: np.ndarray  # (ne,) [rad/s]
    width: np.ndarray  # (ne,) of what each stands for [rad/s]


def nodes(highest: float, own: np.ndarray, half: np.ndarray, share: np.ndarray, unit: float = 1.0) -> Nodes:
    """Evenly spaced in Λ, which rises by SMOOTH up to the fastest wave, by as much above it, and by EACH at each
    resonance that is the frame's:

    Λ(ω) = SMOOTH f(ω/ω_max) + EACH Σ share (1/π) atan((ω - ω₀)/γ), in which a resonance's response is level; f(x) is x
    up to 1 and (1 + x)/2 above, where the forces are smooth and small.

    own: ω₀ (m,); half: γ (m,), half of its width; share (m,) of its energy that is the frame's. Neither width nor the
    highest frequency need be exact, so that seas that are alike share the nodes: they are powers of 2 of a unit
    [rad/s], that of the scene, so that models have those of full scale.
    """
    highest = unit * 2.0 ** (np.floor(ALIKE * np.log2(highest / unit)) / ALIKE)
    half = unit * 2.0 ** np.round(np.log2(half / unit))
    near, end = own[:, None] + half[:, None] * np.tan(np.linspace(-1.5, 1.5, 16 * EACH)), ORDERS * highest
    at = np.union1d(np.linspace(0.0, end, 16 * ORDERS * SMOOTH + 1), near[(near > 0) & (near < end)])
    apart, x = (at[:, None] - own) / half, at / highest
    rise = SMOOTH * np.minimum(x, 0.5 + 0.5 * x) + EACH * np.arctan(apart) @ share / np.pi
    count = int(np.ceil(rise[-1] - rise[0]))
    each = (rise[-1] - rise[0]) / count
    omega = np.interp(rise[0] + each * (np.arange(count) + 0.5), rise, at)
    apart = (omega[:, None] - own) / half
    smooth = SMOOTH / np.where(omega < highest, highest, 2 * highest)
    return Nodes(omega, each / (smooth + EACH * (1 / (1 + apart**2)) @ (share / half) / np.pi))


def forces(stations: Stations, omega: np.ndarray, duration: float, at: Nodes) -> np.ndarray:
    """At the stations of a frame that does not move, (nd ns, ne) [N]: lines of no phase of the waves'."""
    flow, frame = stations.flow(None), stations.frame
    U = np.zeros(flow.shape[1::-1]) if stations.stream is None else stations.stream.T
    of = linear_drag.beyond(U, linear_drag.covariance(flow))
    x = np.einsum("smd,dsw->msw", of.e, flow).reshape(-1, flow.shape[-1])
    terms = _Terms(of.terms.swapaxes(0, 1).reshape(-1, of.terms.shape[-1]), x)
    unit = frame.drag * of.e.transpose(2, 1, 0)  # of a term's force, (nd, m, ns)
    moved = sum(frame.station[:, d, None] * unit[d] for d in range(len(unit))).reshape(len(frame.station), -1)
    w = at.omega[:, None]
    gain = frame.scale / np.abs(frame.omega**2 - w**2 - 2j * frame.damping * frame.omega * w)  # of modes, (ne, nm)
    picked = terms.at(_telling(terms, np.linalg.norm(gain, axis=0) @ np.abs(moved)))
    if not len(picked.x):
        return np.zeros((len(stations.water), at.omega.size), complex)
    spread = np.linalg.solve(picked.covariance(picked), picked.covariance(terms)).T
    spectrum = _spectrum(picked, omega, bands(omega, duration).width, at.omega)
    pattern = spread @ _largest(spectrum, gain[:, :, None] * (moved @ spread)).T
    each = np.sum(unit[..., None] * pattern.reshape(*unit.shape[1:], -1), axis=1)
    return each.reshape(-1, at.omega.size) * np.sqrt(2 * at.width)


class _Terms(NamedTuple):
    """n numbers Σ aₙ Hₙ(x)."""

    each: np.ndarray  # √n! aₙ (n, 4), see linear_drag.Beyond
    x: np.ndarray  # (n, 2 nw) parts of lines

    def at(self, places: np.ndarray) -> "_Terms":
        """Some of them."""
        return _Terms(self.each[places], self.x[places])

    def covariance(self, other: "_Terms") -> np.ndarray:
        """At one time (n, m)."""
        return self.of(other, 0.5 * self.x @ other.x.T)

    def of(self, other: "_Terms", R: np.ndarray) -> np.ndarray:
        """Σ n! aₙaₙ' Rⁿ where the covariance of x is R (n, m, …)."""
        total = np.zeros(R.T.shape)
        for a, b in zip(self.each.T[::-1], other.each.T[::-1], strict=True):
            total = total * R.T + np.outer(b, a)
        return total.T * R * R


def _telling(terms: _Terms, weight: np.ndarray) -> np.ndarray:
    """Which (r,) tell of the others, as far as they matter (n,), but for LEFT of the largest."""
    R = 0.5 * np.sum(terms.x**2, axis=1)
    size = weight**2 * np.sum(terms.each**2 * R[:, None] ** np.arange(2, 6), axis=1)
    heavy = np.flatnonzero(size > LEFT * size.max(initial=0.0))
    if not heavy.size:
        return heavy
    of, weight = terms.at(heavy), weight[heavy]
    _, order, r, _ = lapack.dpstrf(weight[:, None] * of.covariance(of) * weight, tol=LEFT * size.max())
    return heavy[order[:r] - 1]


def _spectrum(terms: _Terms, omega: np.ndarray, width: float, at: np.ndarray) -> np.ndarray:
    """S (ne, n, n), one-sided."""
    step, n = np.pi / (ORDERS * omega.max()), len(terms.x)  # twice as often as the fastest of the forces turns
    tau = step * np.arange(1 + int(REACH / (width * step)))
    turned = _powers(np.exp(-1j * step * omega), tau.size)
    x = terms.x.view(complex)
    pairs = (x.conj()[:, None] * x).reshape(n * n, -1).view(float)
    C = terms.of(terms, 0.5 * (pairs @ turned.view(float).T).reshape(n, n, -1))
    seen = step / np.pi * np.exp(-0.5 * (width * tau) ** 2)
    seen[0] /= 2
    half = np.moveaxis((seen * C) @ np.exp(1j * tau[:, None] * at), -1, 0)
    return half + np.swapaxes(half.conj(), 1, 2)


def _powers(z: np.ndarray, count: int) -> np.ndarray:
    """zⁿ for n < count, (count, nz): in turn as many more as are known."""
    out = np.ones((count, z.size), complex)
    known = 1
    while known < count:
        more = out[known : 2 * known]
        np.multiply(out[: len(more)], z, out=more)
        z, known = z * z, 2 * known
    return out


def _largest(S: np.ndarray, moves: np.ndarray) -> np.ndarray:
    """Of numbers with spectra S (ne, r, r), lines (ne, r) of what goes together and moves most by (ne, m, r)."""
    M = np.swapaxes(moves, 1, 2) @ moves
    y = M.sum(axis=2, keepdims=True).astype(complex)
    for _ in range(TURNS):
        y = M @ (S @ y)
        y /= np.linalg.norm(y, axis=1, keepdims=True)
    seen = (S @ y)[..., 0]
    size = np.sum(y[..., 0].conj() * seen, axis=1, keepdims=True).real
    return np.divide(seen, np.sqrt(size.clip(min=0.0)), out=np.zeros_like(seen), where=size > 0)
