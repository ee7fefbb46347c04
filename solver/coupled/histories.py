"""What load histories do to a frame: which of its modes they set swinging, and what a march's samples miss of them.

By the frame's modes alone, as if no float hung on it. Sizes are those of structure.ringing.
"""

from functools import lru_cache
from typing import NamedTuple

import numpy as np

from solver.coupled.ritz import FAINT, of_whole
from solver.coupled.support import Support
from solver.coupled.system import System
from solver.structure.load_history import LoadHistory
from solver.structure.ringing import Sizes, lines, parabolas, products, sizes

SWINGS = 0.01  # of all that moves the frame: what swings by more is followed


class Moved(NamedTuple):
    """How much a frame's modes (nm,) move."""

    omega: np.ndarray  # their frequencies [rad/s]
    swings: np.ndarray  # about where slow loads would push them
    histories: np.ndarray  # with that
    whole: float  # all of them together, in waves, too
    borne: np.ndarray  # what the ground bears of their swings along x, y or z, of all that it bears along it

    @property
    def swung(self) -> np.ndarray:
        """Frequencies [rad/s] of those that the loads set swinging."""
        return self.omega[(self.swings > SWINGS * self.whole) | (self.borne > SWINGS)]


def moved(system: System) -> Moved:
    """Of a system with load histories, by these and by its waves."""
    support, sea = system.support, system.scene.sea.omega
    assert support is not None, "asked of a scene with loads on a platform"
    omega, told = support.omega, _by_histories(support, system.histories, _end(system))
    histories = np.hypot(told.swings, told.pushed)
    in_waves = system.rows[system.layout.modal] / (
        omega[:, None] ** 2 - sea**2 - 2j * (support.damping * omega)[:, None] * sea
    )
    both = np.hypot(histories, np.linalg.norm(omega[:, None] * in_waves, axis=1) / np.sqrt(2))
    on_ground = omega * np.abs(support.thrust)
    borne = of_whole(on_ground, told.swings, np.linalg.norm(on_ground * both, axis=1), FAINT)
    return Moved(omega, told.swings, histories, float(np.linalg.norm(both)), borne.max(axis=0, initial=0.0))


@lru_cache(maxsize=2)
def _by_histories(support: Support, histories: tuple[LoadHistory, ...], end: float) -> Sizes:
    """By the loads alone, whatever the step."""
    return sizes(lines(histories, end), support.omega, support.damping, support.applied)


class Driven(NamedTuple):
    """Loads and modes over a record, means in row 0; others, whose squares' sums are variances, go about these."""

    force: np.ndarray  # (k, na) of the load histories [N]
    p: np.ndarray  # (k, nm)
    dp: np.ndarray
    ddp: np.ndarray


def driven(system: System) -> Driven:
    """By a system's load histories alone, at its steps."""
    support, discard = system.support, system.scene.settings.discard
    assert support is not None, "asked of a scene with loads on a platform"
    applied, span = support.applied, (discard, _end(system))
    R = products(system.histories, system.dt, span, support.omega, support.damping, applied)
    return Driven(*np.split(R[:, 1:], len(applied) + support.omega.size * np.arange(3), axis=1))


def missed(system: System, step: float) -> float:
    """What parabolas through start, middle and end of each step [s] do otherwise than the loads, of all that moves."""
    support = system.support
    if support is None or not system.histories or not (told := moved(system)).whole > 0:
        return 0.0
    some = told.histories > SWINGS * told.whole
    taken = parabolas(system.histories, step, _end(system))
    off = lines(system.histories, _end(system)).less(taken)
    size = sizes(off, support.omega[some], support.damping[some], support.applied[:, some])
    return float(np.linalg.norm(size.whole) / told.whole)


def unswung(system: System) -> float:
    """What they set swinging of the frame's modes that are not kept, of all that moves."""
    support = system.support
    if support is None or not support.unswung or not (told := moved(system)).whole > 0:
        return 0.0
    return float(support.unswung * np.linalg.norm(told.histories) / told.whole)


def _end(system: System) -> float:
    return system.scene.settings.discard + system.scene.settings.duration
