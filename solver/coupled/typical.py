"""Waves that stand for those of many seas: what a platform's shapes are made of, and curves over wavenumbers."""

from functools import lru_cache

import numpy as np

from solver.sea.current import Current
from solver.sea.dispersion import frequency
from solver.sea.field import WaveField
from solver.sea.realization import Realization
from solver.structure import water

OCTAVE = 2  # so many wavenumbers in it, counted from a length's own: their loads stand for those of all between
KNOWN = 8  # of them that a process keeps


def typical_waves(field: WaveField, at: water.Stations, size: float) -> WaveField:
    """Waves that load stations in the patterns of all those of a sea: of a velocity of 1 m/s at the surface.

    Their wavenumbers are half an octave apart, and no more than turn the phase by a radian on the stations' way along
    the heading, so that many seas have the same; a sea of fewer waves has its own. size: of the structure [m].
    """
    k = field.k if field.sea.amplitude.any() else np.zeros(0)
    if k.size > 1:
        first, last = np.floor(np.log2(k.min() * size) * OCTAVE), np.ceil(np.log2(k.max() * size) * OCTAVE)
        way = float(np.ptp(at.position @ field.direction)) if len(at.position) else 0.0
        low, high = (2 ** (end / OCTAVE) * way / size for end in (first, last))
        if last - first + 1 + high - low < k.size:
            turned = np.arange(np.ceil(low), high) / way if way > 0 else np.zeros(0)
            k = np.union1d(2 ** (np.arange(first, last + 1) / OCTAVE) / size, turned)
    return _waves(tuple(k.tolist()), field.sea.heading, field.depth, field.gravity, field.current)


@lru_cache(maxsize=KNOWN)
def _waves(k: tuple[float, ...], heading: float, depth: float, gravity: float, current: Current | None) -> WaveField:
    """One object for all who ask for the same."""
    return of_one_speed(np.array(k), heading, depth, gravity, current)


def of_one_speed(
    k: np.ndarray, heading: float, depth: float, gravity: float, current: Current | None = None
) -> WaveField:
    """Waves of wavenumbers k whose velocity at the surface of deep water is 1 m/s."""
    omega = frequency(k, depth, gravity)
    sea = Realization(omega=omega, amplitude=(1 / omega).astype(complex), heading=heading)
    return WaveField(sea, depth, gravity, current)
