"""What floats that are let go from offsets do in still water, by the linear model; and what errors of coefficients do
to that.

With s = σ - iω the motions q = x - x₀ have the transform

    Q(s) = -[s²M + s(D + EᵀY(ω + iσ)E) + C]⁻¹ C x₀/s,    q(t) = exp(σt)/π Re ∫₀^∞ Q exp(-iωt) dω.

A small σ makes the resonances of what hardly dies wide enough to be summed, whatever its damping; Y(ω + iσ) is
Y + iσ Y', for coefficients change slowly.
"""

from collections.abc import Callable, Iterator, Mapping
from functools import lru_cache
from typing import NamedTuple

import numpy as np
from scipy.fft import next_fast_len

from solver.coupled.linear import impedance_anywhere, linear_model
from solver.coupled.system import System
from solver.hydrodynamics.bem.coefficients import Hydrodynamics
from solver.record.channels import Channels
from solver.record.response import absorbs
from solver.record.sampling import least_force
from solver.scene import unit_along
from solver.statistics import FAINT, STATISTICS, of_joints

PERIODS = 50  # of the slowest motion that coefficients know, in the time for which spectra are told, at least
LOST = 6.0  # σ times that time: exp(-LOST) of what is left of the motions at its end counts at its start
BEYOND = 3  # times the highest frequency solved, up to which there are frequencies
SHORTEST = 4  # periods of the shortest wave: of shorter records so much is judged
MOST = 2**15  # frequencies, and
ENTRIES = 8_000_000  # numbers in their impedances; of longer records what that is enough for is judged
LEFT = 0.01  # of an offset, still swinging: errors of coefficients make as much of it


def spectrum(system: System, omega: np.ndarray, Y: np.ndarray) -> np.ndarray:
    """X (nw, n), (1 - Z⁻¹C) x₀/(-iω), at any complex ω."""
    model, start = linear_model(system), offsets(system)
    pushed = np.broadcast_to(model.stiffness @ start, (omega.size, start.size))
    return (start - model.response(omega, Y, pushed)) / (-1j * omega[:, None])


Transfer = Callable[[np.ndarray], np.ndarray]  # Y (nw, na, na) of a memory, at any ω (nw,)


class _Decay(NamedTuple):
    """Of n coordinates and nb floats, at nt times of the record."""

    motions: np.ndarray  # (nt, n) from where they are let go
    rates: np.ndarray  # (nt, n)
    forces: np.ndarray  # (nt, nb, 3) that the joints bear


class _Span(NamedTuple):
    omega: np.ndarray  # (nw,) from 0 on, evenly
    sigma: float
    time_step: float  # of the series that they tell
    at: np.ndarray  # (nt,) which of it are of the record

    @property
    def times(self) -> np.ndarray:
        """(nt,) [s]."""
        return self.time_step * self.at


def offsets(system: System) -> np.ndarray:
    """x₀ (n,), where the motions start."""
    start = np.zeros(len(linear_model(system).mass))
    start[system.structure.omega.size :] = system.scene.offsets
    return start


def by_memory(system: System, h: Hydrodynamics, transfer: Transfer) -> float:
    """What the memory's misfit changes of any mean or std of a decay, relative to that std, and of mean power."""
    if not offsets(system).any():
        return 0.0
    exact, span = _exact(system, h)
    return _changed(system, exact, _decay(system, span, transfer(span.omega)))


def by_mesh(system: System, h: Hydrodynamics) -> float:
    """The same by coefficients off by their estimated error."""
    if not offsets(system).any():
        return 0.0
    exact, span = _exact(system, h)
    return _changed(system, exact, _decay(system, span, impedance_anywhere(system, h.shifted, span.omega)))


@lru_cache(maxsize=1)
def _exact(system: System, h: Hydrodynamics) -> "tuple[_Decay, _Span]":
    span = _span(system, h)
    return _decay(system, span, impedance_anywhere(system, h, span.omega)), span


def died(channels: Channels, tables: Mapping[str, np.ndarray]) -> Iterator[str]:
    """A sentence where of a decay less than LEFT of every offset swings in the record of statistics (…, 5)."""
    floats = channels.scene.floats
    start = channels.by_axis(channels.scene.offsets[None])[0]
    if channels.scene.sea.amplitude.any() or not np.nan_to_num(start).any():
        return
    moved = of_joints(tables)
    high, low = (moved[..., STATISTICS.index(name)] for name in ("max", "min"))
    swing, size = (high - low) / 2, np.abs(start)
    share = np.divide(swing, size, out=np.zeros(size.shape), where=size > 0)
    b, i = np.unravel_index(share.argmax(), share.shape)
    if share[b, i] < LEFT:
        unit = unit_along(channels.axes[i])
        yield (
            f"floats.{floats[b].name}.offset: let go from {start[b, i]:+.3g} {unit} of {channels.axes[i]}, it swings by"
            f" {swing[b, i]:.2g} {unit} in the record, no float by a larger share: errors, told relative to what is"
            " left, are not those of the decay"
        )


def _span(system: System, h: Hydrodynamics) -> _Span:
    s, low = system.scene.settings, h.omega[0]
    high = BEYOND * h.omega[-1]
    end = s.discard + max(s.duration, SHORTEST * 2 * np.pi / h.omega[-1])
    most = min(MOST, ENTRIES // len(h.added_mass_inf) ** 2)
    count = next_fast_len(int(min(max(2 * end, PERIODS * 2 * np.pi / low) * high / (2 * np.pi), most)) + 1)
    whole = count * 2 * np.pi / high
    step, end = whole / (2 * count), min(end, whole / 2)
    times = step * np.arange(2 * count)
    of_record = np.flatnonzero((times > min(s.discard, end / 2)) & (times <= end))
    return _Span(high / count * np.arange(count), LOST / whole, step, of_record)


def _decay(system: System, span: _Span, Y: np.ndarray) -> _Decay:
    model, step, start = linear_model(system), span.omega[1], offsets(system)
    w = span.omega + 1j * span.sigma
    Y = Y + 1j * span.sigma * np.gradient(Y, step, axis=0)
    rate = -1j * w[:, None]
    Q = spectrum(system, w, Y) - start / rate
    held = model.wrench[0] @ start / rate[..., None]  # which those of Q at last take back
    forces = Channels(system.scene, None).hinge_force(model.loads(w, Q, Y, held))
    every = np.concatenate([Q.T, (rate * Q).T, forces.reshape(w.size, -1).T]).conj()
    series = np.fft.irfft(every, 2 * w.size) * (w.size * step / np.pi)
    kept = (np.exp(span.sigma * span.times) * series[:, span.at]).T
    motions, rates, borne = np.split(kept, [start.size, 2 * start.size], axis=1)
    return _Decay(motions, rates, borne.reshape(span.at.size, -1, 3))


def _changed(system: System, exact: _Decay, other: _Decay) -> float:
    std = exact.motions.std(axis=0)
    moved = linear_model(system).length * std
    used = moved > FAINT * moved.max(initial=0.0)
    force = exact.forces.std(axis=0)
    least = np.maximum(least_force(system.scene), FAINT * force.max(axis=1, keepdims=True))
    takes = used & absorbs(system, system.bodies.law)
    power, true = (np.mean(each.rates[:, takes] ** 2, axis=0) for each in (other, exact))
    changes = [
        _off(exact.motions[:, used], other.motions[:, used], std[used]),
        _off(exact.forces, other.forces, np.maximum(force, least)),
        np.abs(power / true - 1),
    ]
    return float(max(change.max(initial=0.0) for change in changes))


def _off(x: np.ndarray, y: np.ndarray, size: np.ndarray) -> np.ndarray:
    return np.asarray(np.maximum(np.abs(y.std(axis=0) - x.std(axis=0)), np.abs((y - x).mean(axis=0))) / size)
