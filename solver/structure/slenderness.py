"""Morison's inertia load in waves beside which a member is not thin, against MacCamy and Fuchs (1954).

On a vertical circular cylinder of radius a on the seabed waves of amplitude A and their diffraction exert per length
4ρgA/k cosh k(z+h)/cosh kh / |H₁'(ka)|, where Morison's equation with C_M = 2 has 2ρπa² gkA cosh k(z+h)/cosh kh.
"""

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np
from scipy.special import h1vp

from solver.sea.dispersion import frequency
from solver.sea.field import WaveField
from solver.structure import water
from solver.structure.fineness import SHORTEST
from solver.structure.frame_model import FrameModel

THIN = 2.0  # C_M of a thin cylinder; more of it has another shape, of which no wave's length tells
LET_PASS = 0.05  # share of the load's std by which it may be too large


class Overloaded(NamedTuple):
    """The member whose inertia load is furthest above what diffraction leaves of it."""

    name: str
    diameter: float  # the largest in water, with growth [m]
    excess: float  # share by which the load's std in the sea at hand is too large


def diffracted(ka: np.ndarray) -> np.ndarray:
    """MacCamy and Fuchs's load over Morison's with C_M = 2, 2/(π (ka)² |H₁'(ka)|): 1 in long waves."""
    return np.asarray(2 / (np.pi * ka**2 * np.abs(h1vp(1, ka))))


def overloaded(model: FrameModel, field: WaveField, lacking: float = 0.0) -> Overloaded | None:
    """None where all waves are longer than SHORTEST diameters of what is in water.

    lacking: what is left out of C_M. Of each wave the sizes of the load along a member are summed.
    """
    k, at = field.k, water.stations(model, water.EXACT)
    if not SHORTEST * at.diameter.max(initial=0.0) * k.max() > 2 * np.pi:
        return None
    at = water.stations(model, water.EXACT, 1 / k.max())
    push = np.abs(field.swing(at.position)[0]) * field.sea.omega * (at.weight * at.diameter**2)[:, None]
    coefficient = np.minimum(at.inertia - lacking, THIN)
    member, loads = model.member[at.element], np.zeros((2, len(model.frame.members), k.size))
    for load, size in zip(loads, (coefficient[:, None], THIN * diffracted(k * at.diameter[:, None] / 2)), strict=True):
        np.add.at(load, member, size * push)
    std, exact = np.linalg.norm(loads, axis=2)
    excess = np.divide(std, exact, out=np.zeros(std.size), where=exact > 0) - 1
    worst = int(excess.argmax())
    diameter = float(at.diameter[member == worst].max(initial=0.0))
    return Overloaded(model.frame.members[worst].name, diameter, float(excess[worst]))


def too_thick(model: FrameModel, field: WaveField, lacking: float = 0.0) -> Iterator[str]:
    """A sentence for that member, where it is more than LET_PASS."""
    worst = overloaded(model, field, lacking)
    if worst is not None and worst.excess > LET_PASS:
        shortest = SHORTEST * worst.diameter
        period = 2 * np.pi / frequency(2 * np.pi / shortest, field.depth, field.gravity)
        growth = " with marine growth" if model.frame.growth else ""
        yield (
            f"platform.members.{worst.name}, {worst.diameter:.3g} m in diameter{growth}: Morison's equation"
            f" does not hold in waves shorter than {SHORTEST:g} diameters, {shortest:.3g} m or {period:.3g} s,"
            f" and in this sea the std of its inertia load is {worst.excess:.0%} too large (MacCamy and Fuchs 1954)"
        )
