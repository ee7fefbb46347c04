"""Quantities that the incident wave drives, as rows of one matrix.

Each linear quantity of the sea (elevation, a coefficient of the local pressure field, a
particle velocity, a diffraction force) is y(t) = Re Σᵢ Wᵢ exp(-iωᵢt) with a complex
row W each. Rows are stacked and evaluated together: see solver.sea.series.
"""

from dataclasses import dataclass, replace
from functools import cached_property, lru_cache
from math import factorial

import numpy as np
import scipy  # special is slow to import
from numpy.typing import ArrayLike

from solver.errors import InputError
from solver.sea.current import Current
from solver.sea.dispersion import wavenumbers
from solver.sea.realization import Realization
from solver.sea.series import ROUNDING

MOST_TERMS = 120  # of the field around a float
FIELDS = 32  # seas, and sizes of hulls in them, that a process keeps
LOST = 1e-4  # share of the amplitudes that rounding may take from that series


@dataclass(frozen=True)
class WaveField:
    """A realization in water of one depth, and a current: rows of its kinematics at points (…, 3) [m]."""

    sea: Realization
    depth: float
    gravity: float
    current: Current | None = None

    @cached_property
    def k(self) -> np.ndarray:
        """Wavenumbers (n,) [1/m]."""
        return wavenumbers(self.sea.omega, self.depth, self.gravity)

    @property
    def direction(self) -> np.ndarray:
        """Unit vector of propagation (3,)."""
        return np.array([np.cos(self.sea.heading), np.sin(self.sea.heading), 0.0])

    def _phase(self, points: ArrayLike) -> np.ndarray:
        s, place = np.unique(np.asarray(points, float) @ self.direction, return_inverse=True)
        return (self.sea.amplitude * np.exp(1j * self.k * s[:, None]))[place]

    def elevation(self, points: ArrayLike) -> np.ndarray:
        """η [m]: rows (…, n)."""
        return self._phase(points)

    def swing(self, points: ArrayLike) -> tuple[np.ndarray, np.ndarray]:
        """Particle velocity [m/s] along the heading and upward: rows (…, n); zero above z = 0 is not implied.

        ω cosh k(z+h)/sinh kh and -iω sinh k(z+h)/sinh kh.
        """
        z, place = np.unique(np.asarray(points, float)[..., 2], return_inverse=True)
        rise = np.exp(self.k * z[:, None])
        image = np.zeros_like(rise) if np.isinf(self.depth) else np.exp(-self.k * (z[:, None] + 2 * self.depth))
        scale = 0.0 if np.isinf(self.depth) else np.exp(-2 * self.k * self.depth)
        common = self.sea.omega * self._phase(points) / (1 - scale)
        return common * (rise + image)[place], -1j * common * (rise - image)[place]

    def velocity(self, points: ArrayLike) -> np.ndarray:
        """The same along x, y and z: rows (…, 3, n)."""
        along, up = self.swing(points)
        velocity = np.empty((*along.shape[:-1], 3, self.k.size), complex)
        velocity[..., :2, :] = self.direction[:2, None] * along[..., None, :]
        velocity[..., 2, :] = up
        return velocity

    def acceleration(self, points: ArrayLike) -> np.ndarray:
        """∂u/∂t [m/s²]: rows (…, 3, n)."""
        return -1j * self.sea.omega * self.velocity(points)

    def stream(self, points: np.ndarray) -> np.ndarray:
        """Velocity of the current at points (n, 3), (n, 3) [m/s]; above still water it is that there."""
        if self.current is None:
            return np.zeros(points.shape)
        return self.current.velocity(np.minimum(points[:, 2], 0.0), self.depth)

    def local_pressure(self, centre: np.ndarray, terms: int) -> np.ndarray:
        """Rows (2, terms, n) of Re Cₙ, Im Cₙ [m^(1-n)]: dynamic head p/ρg = Re Σ Cₙ ζⁿ.

        ζ = (z - z₀) + i(s - s₀). cosh k(z+h)/cosh kh e^{iks} splits into e^{kζ} and
        e^{-2kh} e^{-k ζ̄}; as Re(D ζ̄ⁿ) = Re(D̄ ζⁿ), finite depth costs no further terms.
        """
        z0 = float(centre[2])
        deep = 0.0 if np.isinf(self.depth) else np.exp(-2 * self.k * self.depth)
        base = self._phase(centre) / (1 + deep)
        n = np.arange(terms)
        power = self.k ** n[:, None] / np.array([factorial(i) for i in n], float)[:, None]
        direct = base * np.exp(self.k * z0) * power
        image = base * deep * np.exp(-self.k * z0) * power * (-1.0) ** n[:, None]
        return np.stack([direct + image, -1j * (direct - image)])

    @property
    def shortest(self) -> str:
        """The shortest wave, for messages."""
        return f"waves down to {2 * np.pi / self.k.max():.3g} m"

    @property
    def mean_length(self) -> float:
        """1/k of the mean wave [m], the elevation's root mean square over the slope's; inf in still water."""
        power = np.abs(self.sea.amplitude) ** 2
        return float(np.sqrt(power.sum() / (power @ self.k**2))) if power.any() else np.inf

    def near(self, radius: float, tolerance: float) -> "WaveField":
        """Of the waves that a series within `radius` [m] carries: all of them, or those of kr <= ln(LOST/ROUNDING)."""
        return _near(self, radius, tolerance) if self.sea.amplitude.any() else self

    def terms_for(self, radius: float, tolerance: float) -> int:
        """Terms so that the tail Σ|aᵢ|(kᵢr)ⁿ/n! within `radius` [m] is below tolerance·Σ|aᵢ|."""
        if not self.sea.amplitude.any():
            return 1
        return _terms(self, radius, tolerance)

    def radius_for(self, terms: int, tolerance: float) -> float:
        """Radius [m] within which `terms` leave out no more than tolerance·Σ|aᵢ|; inf without waves."""
        if not self.sea.amplitude.any():
            return np.inf
        low, high = 0.0, 10 * terms / self.k.max()
        for _ in range(40):
            middle = (low + high) / 2
            low, high = (middle, high) if self.tail(terms, middle) < tolerance else (low, middle)
        return low

    def left_out(self, terms: int, radius: float) -> float:
        """The tail after `terms` within `radius` [m], as a share of Σ|aᵢ|; 0 without waves."""
        return self.tail(terms, radius) if self.sea.amplitude.any() else 0.0

    def tail(self, n: int, radius: float) -> float:
        """Σ|aᵢ|(kᵢr)ᵐ/m! over m >= n, relative to Σ|aᵢ|: e^kr times the regularized incomplete gamma function."""
        amplitude, kr = np.abs(self.sea.amplitude), self.k * radius
        rest = np.exp(np.minimum(kr, 700.0)) * scipy.special.gammainc(n, kr)
        return float(amplitude @ rest / amplitude.sum())


@lru_cache(maxsize=FIELDS)
def wave_field(sea: Realization, depth: float, gravity: float, current: Current | None) -> WaveField:
    """Of a sea; tasks in the same one share it."""
    return WaveField(sea, depth, gravity, current)


@lru_cache(maxsize=FIELDS)
def _near(field: WaveField, radius: float, tolerance: float) -> WaveField:
    if _carried(field, radius, tolerance) is not None:
        return field
    long = field.k * radius <= np.log(LOST / ROUNDING)
    return replace(field, sea=replace(field.sea, amplitude=np.where(long, field.sea.amplitude, 0.0)))


def _terms(field: WaveField, radius: float, tolerance: float) -> int:
    terms = _carried(field, radius, tolerance)
    if terms is None:
        raise InputError(
            "sea", field.shortest, f"too short for a series {radius:.3g} m around a float: end the band lower"
        )
    return terms


@lru_cache(maxsize=FIELDS)
def _carried(field: WaveField, radius: float, tolerance: float) -> int | None:
    """Terms of the series; None where no number of them is enough."""
    # Terms grow to e^kr before they fall: what is rounded off them must stay small.
    amplitude, growth = np.abs(field.sea.amplitude), np.exp(np.minimum(field.k * radius, 700.0))
    if ROUNDING * (amplitude @ growth) < LOST * amplitude.sum():
        for n in range(2, MOST_TERMS):
            if field.tail(n, radius) < tolerance:
                return n
    return None
