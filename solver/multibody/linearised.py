"""Linear damping that absorbs the same on average, of harmonic and Gaussian rates."""

import numpy as np
from scipy.special import erf, ndtri

from solver.multibody.joint_law import JointLaw
from solver.multibody.load_table import equivalent_damping
from solver.multibody.of_axes import joint_loads, positioned

FAR = 40.0  # standard deviations
EVEN = (np.arange(720) + 0.5) / 720  # of the range of a probability
GAUSSIAN = ndtri(EVEN)  # samples of rates of rms 1


def damping_of_gaussian(law: JointLaw, std: np.ndarray) -> np.ndarray:
    """⟨f_pto ẏ⟩/⟨ẏ²⟩ (n,) of Gaussian rates with std (n,): the linear damping that takes as much power.

    With a = (F_max - F_c)/c_pto and x = a/σ: c (erf(x/√2) - √(2/π) x exp(-x²/2)) for what is linear, and
    √(2/π)/σ times F_c (1 - exp(-x²/2)) + F_max exp(-x²/2). At σ = 0 that of the linear part alone. Of tables the mean
    slope.
    """
    x, rate, constant = _reached(law, std)
    beyond = np.exp(-0.5 * x**2)
    with_limit = np.sqrt(2 / np.pi) * (constant * (1 - beyond) + _limit(law, beyond)) / rate
    linear = law.pto_damping * (erf(x / np.sqrt(2)) - np.sqrt(2 / np.pi) * np.minimum(x, FAR) * beyond)
    whole = np.where(std > 0, linear + with_limit, law.pto_damping)
    return whole + equivalent_damping(law.tables, std, lambda x: 0.5 * erf(x / np.sqrt(2)))


def damping_at_rest(law: JointLaw) -> np.ndarray:
    """The same (n,) of rates that are next to nothing."""
    return law.pto_damping + law.tables.slope


def beyond_rest(law: JointLaw, whole: np.ndarray) -> np.ndarray:
    """What a `whole` damping (n,), by one of these, is beyond that at rest, by how much there is of it in either sense.

    Of tables by position, too, only that at rest is known.
    """
    return ~positioned(law) * (1 - np.abs(law.one_way) / 2) * (whole - damping_at_rest(law))


def damping_of_harmonic(law: JointLaw, amplitude: np.ndarray) -> np.ndarray:
    """The same (n,) of a rate V sin θ, V (n,): its describing function, with sin θ₁ = a/V where the limit is reached.

    (4/π) [c (θ₁/2 - sin 2θ₁/4) + (F_c (1 - cos θ₁) + F_max cos θ₁)/V]
    """
    x, rate, constant = _reached(law, amplitude)
    at = np.arcsin(np.minimum(1.0, x))
    beyond = np.where(x < 1, np.cos(at), 0.0)
    linear = law.pto_damping * (at / 2 - np.sin(2 * at) / 4)
    total = 4 / np.pi * (linear + (constant * (1 - beyond) + _limit(law, beyond)) / rate)
    whole = np.where(amplitude > 0, total, law.pto_damping)
    return whole + equivalent_damping(law.tables, amplitude, _share_of_harmonic)


def damping_of_lines(law: JointLaw, length: np.ndarray, *, single: bool) -> np.ndarray:
    """The same (n,) of rates that are lines with √Σ|X|² (n,): a single harmonic, or several, which are Gaussian."""
    return damping_of_harmonic(law, length) if single else damping_of_gaussian(law, length / np.sqrt(2))


def rest(law: JointLaw, rms: np.ndarray, samples: np.ndarray) -> np.ndarray:
    """⟨(f - cẏ)²⟩^½ (n,): what the linear damping that takes as much power leaves of the loads f by rate.

    Of rates with rms (n,), as they are distributed: samples (m, n) or (m, 1) of rms 1.
    """
    rates = samples * rms
    loads = joint_loads(law, np.zeros(rates.shape), rates)
    f, square = loads.pto + loads.loss, np.sum(rates**2, axis=0)
    c = np.divide(np.sum(f * rates, axis=0), square, out=np.zeros(rms.size), where=square > 0)
    return np.sqrt(np.mean((f - c * rates) ** 2, axis=0))


def _share_of_harmonic(x: np.ndarray) -> np.ndarray:
    """∫ 2 cos²θ dθ/2π of the phases at which sin θ is below x, from those of the mean."""
    at = np.arcsin(np.clip(x, -1, 1))
    return 2 / np.pi * (at / 2 + np.sin(2 * at) / 4)


def _reached(law: JointLaw, rate: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Of n axes: rate at which F_max is reached over a rate, that rate or 1 where it is zero, and F_c."""
    some = np.where(rate > 0, rate, 1.0)
    limiting = np.divide(
        law.force_limit - law.coulomb, law.pto_damping, out=np.full(rate.shape, np.inf), where=law.pto_damping > 0
    )
    return limiting / some, some, law.coulomb


def _limit(law: JointLaw, share: np.ndarray) -> np.ndarray:
    """F_max times a share, which is zero where there is no limit."""
    return np.where(np.isfinite(law.force_limit), law.force_limit, 0.0) * share
