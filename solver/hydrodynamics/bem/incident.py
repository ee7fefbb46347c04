"""The incident wave about hulls at rest, and where the seabed may be left out."""

from dataclasses import dataclass

import numpy as np

from solver.sea.dispersion import group_share, over_depth, wavenumber, wavenumbers

FADED = 20.0  # kh, at which nothing of a wave is left at the seabed
DEEP = 2e-4  # share of a coefficient below which the seabed is left out; see Sea.seabed_share


def arrival(k: np.ndarray, heading: float, places: np.ndarray, columns: int) -> np.ndarray:
    """exp(ik(x cosβ + y sinβ)): the wave at the places (nb, 3) [m] of bodies over that at x = y = 0, (nw, nb columns).

    k (nw,) [1/m]; a body has so many columns.
    """
    way = places[:, 0] * np.cos(heading) + places[:, 1] * np.sin(heading)
    return np.asarray(np.exp(1j * np.multiply.outer(k, np.repeat(way, columns))))


@dataclass(frozen=True, kw_only=True)
class Sea:
    """Water of constant depth [m, may be inf] and the unit wave that travels towards `heading` [rad]."""

    depth: float
    density: float
    gravity: float
    heading: float

    def wavenumber(self, omega: float) -> float:
        """k [1/m] of ω [rad/s]."""
        return float(wavenumber(omega, self.depth, self.gravity))

    def wavenumbers(self, omega: np.ndarray) -> np.ndarray:
        """The same of several (nw,)."""
        return wavenumbers(omega, self.depth, self.gravity)

    def seabed(self, k: float, radius: float, draft: float) -> float:
        """Depth to solve with: infinite where the seabed does not matter to bodies so wide and so deep [m]."""
        return np.inf if self.seabed_share(k, radius, draft) < DEEP else self.depth

    def seabed_share(self, k: float, radius: float, draft: float) -> float:
        """Relative change of a coefficient by the seabed: (a/d) (kd)^-2.5 + 0.7 (a/d)³, d = h - draft beneath the hull.

        Its waves fade as exp(-2kh), its images do not: both terms are measured, on hemispheres; the second is that of a
        heaving one's added mass at infinite frequency. That of a cylinder is 10 and 20 % two and 1.2 radii above the
        seabed, told 9 and 40 %. Or more, as damping has it of bodies that are small beside the depth: by what waves of
        the same period and height carry away in deep water and here, tanh kh (1 + 2kh/sinh 2kh) as much.
        """
        under, kh = self.depth - draft, k * self.depth
        slender = radius / under
        carried = 2 * np.tanh(kh) * group_share(k, self.depth) - 1 if kh < FADED else 0.0
        return float(max(slender * (k * under) ** -2.5 + 0.7 * slender**3, carried))

    def seabed_error(self, omega: np.ndarray, radius: float, draft: float) -> float:
        """Largest share of a coefficient that the seabed has at frequencies (nw,) where it is left out."""
        shares = [self.seabed_share(k, radius, draft) for k in (*map(self.wavenumber, omega), np.inf)]
        return max([share for share in shares if share < DEEP], default=0.0)

    def pressure(self, points: np.ndarray, omega: float) -> np.ndarray:
        """Pressure (np,) [Pa/m] of the unit incident wave."""
        return self.wave(points, omega)[0]

    def wave(self, points: np.ndarray, omega: float) -> tuple[np.ndarray, np.ndarray]:
        """Pressure (np,) [Pa/m] and velocity (np, 3) [1/s] of the unit incident wave."""
        k = self.wavenumber(omega)
        x, y, z = points.T
        c, s = np.cos(self.heading), np.sin(self.heading)
        phase = np.exp(1j * k * (x * c + y * s))
        pressure, climb = (phase * share for share in over_depth(k, z, self.depth))
        velocity = self.gravity * k / omega * np.column_stack([c * pressure, s * pressure, -1j * climb])
        return self.density * self.gravity * pressure, velocity
