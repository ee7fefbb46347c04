"""What a record has of its start: how much it lacks of a lasting sea's motions, and what it has besides.

A shape of unit inertia whose resonance is among the waves and that is damped by B has, a time t after waves have set
in, 1 - exp(-Bt) of the variance that it will have. A record from t₁ on, of duration T, so lacks on average

    exp(-Bt₁) (1 - exp(-BT))/(BT)

of what resonates; less where damping is quadratic, and so less at first. In one wave the record tells by itself: see
settling. A shape that no wave is near, of frequency ω₀, goes with them, q = Σ φᵀCX exp(-iωt)/ω₀². With z = q + iq'/ω₀
of that the ramp r(t) leaves

    e(t) = c exp(-(½B + iω₀)(t - t₀)),    c = -∫ exp((½B + iω₀)(s - t₀)) r'(s) z(s) ds

after its end t₀, which adds ½|c|² exp(-B(t₁ - t₀)) (1 - exp(-BT))/(BT) to the variance. What no stiffness holds,
ω₀ = 0, keeps a velocity instead: a record tells how far that takes it.
"""

from collections.abc import Iterator, Mapping
from typing import NamedTuple

import numpy as np

from solver.coupled.linear import linear_model
from solver.coupled.natural import system_modes
from solver.coupled.system import System
from solver.hydrodynamics.bem.coefficients import Hydrodynamics
from solver.multibody import of_axes
from solver.record.beside import radiating, unradiated
from solver.record.channels import Channels
from solver.record.response import in_waves
from solver.record.sampling import least_motion
from solver.record.settling import Settling
from solver.scene import Settings, unit_along
from solver.sea.realization import ramp
from solver.statistics import FAINT, STATISTICS, of_joints

LACKS = 0.05  # of a std: what is said
WELL = 0.01  # of it: what the discard leaves that is told
LEFT = 0.01  # of a std: what is said of the start's own swinging
DRIFTS = 0.1  # of a std, by which the mean of what nothing holds goes on between a record's first and last third
LONG = 10.0  # times 1/B: after that nothing is left of it
SHARED = 0.1  # of what a shape moves most, or of what moves an axis
TURNS = 0.5  # rad of a shape's own swing in a run: less is a drift, by next to no stiffness or by its rounding
FAST = 4.0  # times the fastest wave's frequency: waves that set in swing nothing faster
OFTEN = 20  # instants of a ramp, in the shortest period
AT_ONCE = 1_000_000  # of them times waves: a long ramp of many has a hundred times as many
ROUNDING = 1e-9  # of a frequency: less damping is none
WIDTHS = 2.0  # of a resonance, B, to either side, which have 84 % of it


class _Begun(NamedTuple):
    """Shapes (m, n) of unit inertia, some of the system's."""

    own: np.ndarray  # (m,) [rad/s]
    shapes: np.ndarray
    B: np.ndarray  # (m,) [1/s]
    names: list[str]

    @classmethod
    def of(cls, system: System, h: Hydrodynamics | None, which: np.ndarray) -> "_Begun":
        modes = system_modes(system, h)
        own, shapes = modes.omega[which], modes.shapes[:, which].T
        B = np.maximum(unradiated(system, h, shapes) + radiating(system, h, own, shapes)[1], 0.0)
        return cls(own, shapes, B, [name for name, here in zip(modes.names, which, strict=True) if here])

    def lasts(self, begin: float, duration: float) -> np.ndarray:
        """Mean (m,) of exp(-Bt) over a record."""
        of = np.maximum(self.B * duration, 1e-9)
        return np.asarray(np.exp(-self.B * begin) * -np.expm1(-of) / of)

    def near(self, omega: np.ndarray) -> np.ndarray:
        """Which of waves (nw,) are by each shape's resonance (m, nw)."""
        return np.abs(omega - self.own[:, None]) <= WIDTHS * self.B[:, None]

    def enough(self, k: int, discard: float, share: float) -> str:
        """By which discard a share of a variance, told with this one [s], comes down to WELL of the std."""
        return f"discard = {discard + np.log(share / (2 * WELL)) / self.B[k]:.2g} leaves {WELL:.0%}"

    def said(self, k: int) -> str:
        """Name and period of one."""
        return f"{self.names[k]}, {2 * np.pi / self.own[k]:.3g} s,"


def _moving(system: System, squares: np.ndarray) -> np.ndarray:
    """Which coordinates (n,) waves move at all, of Σ|X|² (n,)."""
    moves = linear_model(system).length * np.sqrt(squares)
    return np.asarray(moves > max(FAINT * moves.max(), least_motion(system.scene)))


def _braked(system: System, shapes: np.ndarray) -> np.ndarray:
    """Which shapes (m, n) turn or shift a joint that friction or a latch holds now and then, which no damping tells."""
    carriers, modes = system.structure.carrier.shape[0], system.structure.omega.size
    way = np.abs(shapes) * linear_model(system).length
    held = np.concatenate([np.zeros(modes, bool), of_axes.holds(system.bodies.law)[carriers:]])
    return np.asarray(way[:, held].max(axis=1, initial=0.0) > SHARED * way.max(axis=1))


def left_over(system: System, h: Hydrodynamics | None) -> Iterator[str]:
    """A sentence for the shape by whose swinging on any coordinate's std is above the waves' by most, if by LEFT."""
    s, sea = system.scene.settings, system.scene.sea
    met, held = sea.amplitude != 0, ~_loose(system, h)
    if not (met.any() and held.any()):
        return
    of, omega = _Begun.of(system, h, held), sea.omega[met]
    since = max(s.discard - s.ramp, 0.0)
    on = ~of.near(omega).any(axis=1) & (of.own < FAST * omega.max()) & (of.B * since < LONG)
    on &= ~_braked(system, of.shapes)
    if not on.any():
        return
    of = _Begun(of.own[on], of.shapes[on], of.B[on], [of.names[k] for k in np.flatnonzero(on)])
    X = in_waves(system, h).X[met]
    q = X @ (linear_model(system).stiffness @ of.shapes.T) / of.own**2
    share = 0.5 * (np.abs(_kicked(of, omega, q, s)) ** 2 * of.lasts(since, s.duration))[:, None] * of.shapes**2
    squares = np.sum(np.abs(X) ** 2, axis=0)
    if not (used := _moving(system, squares)).any():
        return
    share = share[:, used] / (0.5 * squares[used])
    k, j = np.unravel_index(share.argmax(), share.shape)
    std = np.sqrt(1 + share[k, j]) - 1
    if std > LEFT:
        damped = of.B[k] > ROUNDING * of.own[k]
        ends = of.enough(int(k), s.ramp + since, share[k, j]) if damped else "nothing damps it"
        above = f"by the linear response a std is some {std:.1%} above a lasting sea's"
        yield f"{of.said(k)} still swings as the start made it: {above}; {ends}"


def _kicked(of: _Begun, omega: np.ndarray, q: np.ndarray, s: Settings) -> np.ndarray:
    """c (m,) of shapes that waves omega (nw,) move by q (nw, m)."""
    count = int(np.ceil(s.ramp * OFTEN * max(omega.max(), of.own.max()) / (2 * np.pi))) + 1
    edges = np.linspace(0.0, s.ramp, count + 1)
    at, rise = (edges[1:] + edges[:-1]) / 2, np.diff(ramp(edges, s.ramp, s.ramp_form))
    if not s.ramp:
        at, rise = np.zeros(1), np.ones(1)
    parts, c = at.size * omega.size // AT_ONCE + 1, np.zeros(of.own.size, complex)
    for times, rises in zip(np.array_split(at, parts), np.array_split(rise, parts), strict=True):
        turning = np.exp(-1j * np.outer(times, omega))
        z = (turning @ q).real + 1j * (turning @ (-1j * omega[:, None] * q)).real / of.own
        c -= rises @ (np.exp(np.outer(times - s.ramp, of.B / 2 + 1j * of.own)) * z)
    return c


def _loose(system: System, h: Hydrodynamics | None) -> np.ndarray:
    """Which shapes (m,) nothing brings back within a run."""
    s = system.scene.settings
    return np.asarray(system_modes(system, h).omega * (s.discard + s.duration) < TURNS)


def drifting(
    system: System, h: Hydrodynamics | None, settling: Settling, channels: Channels, tables: Mapping[str, np.ndarray]
) -> Iterator[str]:
    """A sentence for each joint's axis that next to no stiffness holds and whose mean goes on by more than DRIFTS."""
    scene, means, loose = system.scene, settling.means(), _loose(system, h)
    if means is None or not loose.any():
        return
    joints = slice(-len(channels.names), None)
    moves = system_modes(system, h).shapes[joints] ** 2  # by a push along each
    std, (first, last) = (
        of[..., channels.owner, [channels.axes.index(axis) for axis in channels.names]]
        for of in (of_joints(tables)[..., STATISTICS.index("std")], means)
    )
    size = std * linear_model(system).length[joints]
    free = moves[:, loose].sum(axis=1) > SHARED * moves.sum(axis=1)
    free &= size > max(FAINT * size.max(), least_motion(scene))
    for j in np.flatnonzero(free & (np.abs(last - first) > (DRIFTS + settling.parts_of_waves) * std)):
        item, axis, unit = scene.floats[channels.owner[j]], channels.names[j], unit_along(channels.names[j])
        yield (
            f"floats.{item.name}: next to no stiffness holds its {axis}, which keeps what the start or a mean load"
            f" gives it: its mean goes from {first[j]:.3g} {unit} in the record's first third to {last[j]:.3g} in its"
            f" last, beside a std of {std[j]:.3g} that has it, too; stiffness, as of a mooring, ends it"
        )


def from_rest(system: System, h: Hydrodynamics | None) -> Iterator[str]:
    """A sentence for the shape by which any coordinate's std lacks most, if that is more than LACKS."""
    s, sea = system.scene.settings, system.scene.sea
    met, modes = sea.amplitude != 0, system_modes(system, h)
    inside = (modes.omega > sea.omega[met].min(initial=np.inf)) & (modes.omega < sea.omega[met].max(initial=0.0))
    if not inside.any():
        return
    of, since = _Begun.of(system, h, inside), max(s.discard - s.ramp, 0.0)
    lacking = of.lasts(since, s.duration)
    if not np.any(lacking > LACKS):
        return
    size = np.abs(in_waves(system, h).X) ** 2
    used = _moving(system, total := size.sum(axis=0))
    lost = lacking * np.max((of.near(sea.omega) @ size)[:, used] / total[used], axis=1, initial=0.0)
    lost *= ~_braked(system, of.shapes)
    k = int(lost.argmax())
    std = 1 - np.sqrt(1 - lost[k])
    if std > LACKS:
        yield (
            f"{of.said(k)} begins at rest and takes {1 / of.B[k]:.2g} s to swing as it will in"
            f" these waves: a std is some {std:.0%} below a lasting sea's; {of.enough(k, s.ramp + since, lost[k])}"
        )
