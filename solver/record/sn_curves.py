"""S-N curves of DNVGL-RP-C203 (April 2016): in air, in sea water with cathodic protection, and in free corrosion.

log N = log a - m log(Δσ (t/t_ref)ᵏ), Δσ in MPa, t_ref = 25 mm for plates, thinner ones as t_ref (section 2.4.1). Curves
of two slopes meet at their knee of 10ⁿ cycles: log a₁ = n + m₁ (log a₂ - n)/m₂. T, of tubular joints, is left out:
its reference thickness and exponent go with the joint.
"""

from dataclasses import dataclass

import numpy as np

THICK = 0.025  # t_ref [m]
SECOND = 5.0  # m₂
MPA = 1e6
# Curve: m₁, log a₁ in air, log a₁ with cathodic protection, log a₂ of both, log a in free corrosion (m = 3), k.
TABLE = {
    "B1": (4.0, 15.117, 14.917, 17.146, 12.436, 0.0),
    "B2": (4.0, 14.885, 14.685, 16.856, 12.262, 0.0),
    "C": (3.0, 12.592, 12.192, 16.320, 12.115, 0.05),
    "C1": (3.0, 12.449, 12.049, 16.081, 11.972, 0.10),
    "C2": (3.0, 12.301, 11.901, 15.835, 11.824, 0.15),
    "D": (3.0, 12.164, 11.764, 15.606, 11.687, 0.20),
    "E": (3.0, 12.010, 11.610, 15.350, 11.533, 0.20),
    "F": (3.0, 11.855, 11.455, 15.091, 11.378, 0.25),
    "F1": (3.0, 11.699, 11.299, 14.832, 11.222, 0.25),
    "F3": (3.0, 11.546, 11.146, 14.576, 11.068, 0.25),
    "G": (3.0, 11.398, 10.998, 14.330, 10.921, 0.25),
    "W1": (3.0, 11.261, 10.861, 14.101, 10.784, 0.25),
    "W2": (3.0, 11.107, 10.707, 13.845, 10.630, 0.25),
    "W3": (3.0, 10.970, 10.570, 13.617, 10.493, 0.25),
}


@dataclass(frozen=True, slots=True, kw_only=True)
class SNCurve:
    """Cycles to failure N = a S⁻ᵐ, with the second slope for ranges below that of the knee, 0 where there is none."""

    slope: tuple[float, float]  # m₁, m₂
    log_a: tuple[float, float]  # for S in MPa
    knee: float  # range at which they meet [Pa]
    thickness_exponent: float  # k

    def thicker(self, thickness: np.ndarray) -> np.ndarray:
        """By what a range on a plate of that thickness [m] counts as larger."""
        return np.maximum(thickness / THICK, 1.0) ** self.thickness_exponent

    def damage(self, ranges: np.ndarray) -> np.ndarray:
        """1/N of ranges [Pa], those of the thickness effect included."""
        low = ranges < self.knee
        m, log_a = (np.where(low, pair[1], pair[0]) for pair in (self.slope, self.log_a))
        return 10.0**-log_a * (ranges / MPA) ** m


def curve(name: str, environment: str) -> SNCurve:
    """By the names of the tables."""
    m1, air, protected, log_a2, free, k = TABLE[name]
    if environment == "free-corrosion":
        return SNCurve(slope=(3.0, 3.0), log_a=(free, free), knee=0.0, thickness_exponent=k)
    log_a1 = air if environment == "air" else protected
    # Where the two lines meet, to the last digit: the tables' own are rounded.
    knee = MPA * 10.0 ** ((log_a2 - log_a1) / (SECOND - m1))
    return SNCurve(slope=(m1, SECOND), log_a=(log_a1, log_a2), knee=knee, thickness_exponent=k)
