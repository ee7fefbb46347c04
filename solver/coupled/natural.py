"""What the linear model says of a scene: stability, natural periods and shapes, critical damping, the usual step."""

import contextlib
from collections.abc import Callable
from dataclasses import replace
from functools import lru_cache
from typing import NamedTuple

import numpy as np
from scipy import linalg
from scipy.interpolate import CubicSpline

from solver import limits
from solver.balance import UNDER, heaved
from solver.coupled.histories import missed, moved
from solver.coupled.linear import LinearModel, linear_model
from solver.coupled.preparation import prepare
from solver.coupled.support import Support
from solver.coupled.system import System
from solver.errors import InputError, SimulationFailed
from solver.hydrodynamics.bem.coefficients import Hydrodynamics
from solver.keys import Bits, shared
from solver.limits import slides
from solver.multibody.of_axes import pto_stiffness_at_rest
from solver.scene import MOST_STEPS, STEPS, Scene, two_digits, unit_along

UNSTABLE = -1e-6  # of the largest stiffness: below it is not the rounding of a motion that nothing holds
UNHELD = 1e-7  # of the fastest shape's frequency: a slower one is the rounding of one that nothing holds
PLATFORM = 6  # shapes that are told, besides one for each joint: the slowest of all
KNOWN = 32  # undamped scenes that a process keeps
SPARE = 20  # shapes beyond those told, of which they are made where the added mass is another
ROUNDS, AGREED = 50, 1e-9  # of added mass and frequency in turn
MOVES = 0.3  # of the largest motion: what moves by less is not part of a shape's name
FAR = 100.0  # times its frequency without waves: there an axis has none
FRAME = "platform "  # and the axis, in a shape's name
MISSED, SHORTER = 5e-4, 0.6  # of all that moves a frame; and of a step that misses more
DRAWN = 20  # steps in the period of a decay, which is looked at as a curve

Added = Callable[[float], np.ndarray]  # ω -> A - A∞ + iB (n, n)


class SystemModes(NamedTuple):
    """Of the coupled system in water, undamped, slowest first; n coordinates of the linear model."""

    omega: np.ndarray  # (m,) [rad/s]
    shapes: np.ndarray  # (n, m)
    names: tuple[str, ...]  # what moves in each

    @property
    def period(self) -> np.ndarray:
        """(m,) [s], infinite where nothing holds the shape."""
        return np.divide(2 * np.pi, self.omega, out=np.full(self.omega.shape, np.inf), where=self.omega > 0)


def system_modes(system: System, h: Hydrodynamics | None) -> SystemModes:
    """(C - ω²(M + Eᵀ(A(ω) - A∞)E)) φ = 0, each φ with the added mass of its own frequency.

    The slowest, PLATFORM more than there are joints. Beyond the frequencies solved for the nearest one's added mass
    stands; what nothing holds has ω = 0.
    """
    model, radiates = linear_model(system), system.scene.settings.radiation
    undamped = _Undamped(model.stiffness, model.mass, model.active, model.length, system.bodies.added_mass)
    return _system_modes(Bits(undamped), h if radiates else None, _joints(system.scene), system.support)


class _Undamped(NamedTuple):
    """Of a linear model what has no part in damping, see there; and A∞ (na, na)."""

    stiffness: np.ndarray
    mass: np.ndarray
    active: np.ndarray
    length: np.ndarray
    added_mass: np.ndarray


@lru_cache(maxsize=KNOWN)
def _system_modes(
    undamped: Bits[_Undamped], h: Hydrodynamics | None, joints: tuple[str, ...], support: Support | None
) -> SystemModes:
    """Scenes that differ in what damps them share their modes."""
    model = undamped.value
    n = len(model.mass)
    count = min(n, len(joints) + PLATFORM)
    if not count:
        return SystemModes(np.zeros(0), np.zeros((n, 0)), ())
    kept = min(n, count + SPARE)
    try:
        value, basis = linalg.eigh(model.stiffness, model.mass, subset_by_index=(0, kept - 1))
    except linalg.LinAlgError:
        lightest = linalg.eigh(model.mass, subset_by_index=(0, 0))[1][:, 0]
        name = _name(joints, model.length, lightest, support)
        text = f"the mass that moves in {name}, added mass at infinite frequency included, is not above zero"
        asked = "are coefficients and inertia those of these floats, and is no hull just under the surface, where water"
        raise SimulationFailed(f"{text}: {asked} rings over its top?") from None
    added = _added(model.active @ basis, model.added_mass, h)
    low, high = (h.omega[0], h.omega[-1]) if h is not None else (0.0, 0.0)
    # Many shapes have the added mass of the last frequency known.
    known = lru_cache(lambda omega: _in_water(value, added(omega).real))
    settled = [_settled(value, lambda omega: known(min(max(omega, low), high)), i) for i in range(count)]
    pairs = [(omega, basis @ shape) for omega, shape in settled if np.isfinite(omega)]
    omega = np.array([omega for omega, _ in pairs])
    omega = shared(np.where(omega > UNHELD * omega.max(initial=0.0), omega, 0.0))
    shapes = shared(np.array([shape for _, shape in pairs]).reshape(-1, n).T)
    return SystemModes(omega, shapes, tuple(_name(joints, model.length, s, support) for s in shapes.T))


class _InWater(NamedTuple):
    """With the added mass of one frequency, in the shapes at infinite frequency, slowest first."""

    squares: np.ndarray  # (m,) ω²
    shapes: np.ndarray  # (n, m)

    def pair(self, i: int) -> tuple[float, np.ndarray]:
        """ω and shape of the i-th, infinite and nought where it has no mass."""
        if i >= self.squares.size:
            return np.inf, np.zeros(len(self.shapes))
        return float(np.sqrt(max(self.squares[i], 0.0))), self.shapes[:, i]


def _in_water(stiffness: np.ndarray, added: np.ndarray) -> _InWater:
    """Of shapes whose stiffness is `stiffness` (n,), and whose mass is one without what is added (n, n)."""
    mass = np.eye(len(stiffness)) + added
    squares, shapes = _squares(stiffness, (mass + mass.T) / 2)
    order = np.argsort(squares)
    return _InWater(squares[order], shapes[:, order])


def _settled(stiffness: np.ndarray, in_water: Callable[[float], _InWater], i: int) -> tuple[float, np.ndarray]:
    """ω and shape where the added mass is that of ω itself, of the i-th slowest shape.

    In the shapes at infinite frequency, whose stiffness is `stiffness` (n,) and whose mass is one. Each i has a
    frequency of its own, for in order of frequency shapes do not change places, however they pass into each other.
    Added mass and frequency in turn, halfway where that would leave those between which there is one.
    """
    omega, below, above = float(np.sqrt(max(stiffness[i], 0.0))), 0.0, np.inf
    for _ in range(ROUNDS):
        own, shape = in_water(omega).pair(i)
        if own == omega or abs(own - omega) <= AGREED * own < np.inf:
            break
        below, above = (omega, above) if own > omega else (below, omega)
        omega = own if below < own < above or np.isinf(above) else (below + above) / 2
    return own, shape


def _squares(stiffness: np.ndarray, mass: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """ω² (m,) and shapes (n, m) of stiffness (n,) and mass (n, n).

    By the inverse problem, whose 1/ω² are above zero: waves caught between bodies may make the added mass so negative
    that a shape has none in all, and no frequency.
    """
    if stiffness.min() <= 0:
        with contextlib.suppress(np.linalg.LinAlgError):  # of a mass that is not positive
            return linalg.eigh(np.diag(stiffness), mass)
        stiffness = np.maximum(stiffness, -UNSTABLE * stiffness.max())
    root = np.sqrt(stiffness)
    inverse, shapes = np.linalg.eigh(mass / np.outer(root, root))
    real = inverse > 0
    return 1 / inverse[real], shapes[:, real] / (root[:, None] * np.sqrt(inverse[real]))


def _added(active: np.ndarray, added_mass: np.ndarray, h: Hydrodynamics | None) -> Added:
    """Of what radiates E x; added_mass: A∞. Without coefficients nothing radiates."""
    if h is None:
        return lambda _: np.zeros((active.shape[1],) * 2, complex)
    curve, first, last = _added_curve(h), h.omega[0], h.omega[-1]
    return lambda omega: active.T @ (curve(min(max(omega, first), last)) - added_mass) @ active


@lru_cache(maxsize=KNOWN)
def _added_curve(h: Hydrodynamics) -> CubicSpline:
    """A + iB (na, na) at any ω from the first to the last known."""
    return CubicSpline(h.omega, h.added_mass + 1j * h.radiation_damping)


def _joints(scene: Scene) -> tuple[str, ...]:
    return tuple(f"{f.name} {axis}" for f in scene.floats for axis in f.motion)


def _name(joints: tuple[str, ...], length: np.ndarray, shape: np.ndarray, support: Support | None) -> str:
    """What moves, the largest first, against it with a minus sign: "front hinge - rear hinge", "platform x"."""
    nm = len(shape) - len(joints)
    motions = dict(zip(joints, shape[nm:] * length[nm:], strict=True))
    if support is not None:
        moved = (support.shapes @ shape[:nm]).reshape(-1, 6)[:, :3]
        node, axis = np.unravel_index(np.argmax(np.abs(moved)), moved.shape)
        motions[FRAME + "xyz"[axis]] = moved[node, axis]
    first, *rest = sorted(motions, key=lambda name: -abs(motions[name]))
    told = [name for name in rest if abs(motions[name]) >= MOVES * abs(motions[first])]
    return first + "".join(f" {'+' if motions[name] * motions[first] > 0 else '-'} {name}" for name in told)


def require_stable(system: System) -> None:
    """Raise SimulationFailed where a small push takes the floats away from their equilibrium, with the shape; and
    where they rest beyond a bound.
    """
    nc, joints = system.structure.carrier.shape[0], system.joints_at_rest
    if (first := limits.beyond(system.scene, joints, system.bodies.limit)) is not None:
        j, item, axis = first
        low, high = system.bodies.limit[nc + j]
        remedy = "check its mass and centre of gravity (cog), or hold it by stiffness or a preload"
        if slides(axis):
            remedy = 'place it where it rests, hold it by a stiffer spring, or set froude_krylov = "linear"'
        raise SimulationFailed(
            f"{item.name} {axis} rests at {joints[j]:+.2f} in still water, beyond {low:+.2f} to {high:+.2f}: {remedy}"
        )
    if over := limits.overturned(system.scene, joints):
        raise SimulationFailed(f"{over}, where it rests in still water: check its mass and centre of gravity (cog)")
    heaves: set[str] = set()
    for (f, up, share, of), nonlinear in zip(heaved(system.scene, joints), system.scene.nonlinear, strict=True):
        if "heave" in f.motion or f.on in heaves:
            heaves.add(f.name)
        whole = share >= 1 and of != UNDER and (up > 0 or of != "draft")
        if whole and f.name in heaves and not nonlinear:
            way, where = ("above", "out of the water") if up > 0 else ("below", "under water")
            raise SimulationFailed(
                f"no static equilibrium of floats.{f.name}: it would rest {abs(up):.3g} m {way} where it is given, its"
                f" whole hull {where}, which linear buoyancy does not tell: check its mass, {f.mass:g} kg with"
                f" {system.scene.water.density * f.hull.volume:g} kg displaced, and what else it bears"
            )
    sizes = linear_model(system).length[system.structure.omega.size :]
    if not sizes.size:
        return
    K = system.stiffness[nc:, nc:] / np.outer(sizes, sizes)
    value, shape = np.linalg.eigh(K)
    if value[0] < UNSTABLE * np.abs(value).max():
        falls = shape[:, 0] / sizes
        of_pto = float(falls**2 @ pto_stiffness_at_rest(system.bodies.law, system.equilibrium[0])[nc:])
        moves = np.abs(shape[:, 0]) >= MOVES * np.abs(shape[:, 0]).max()
        names = [name for name, moved in zip(_joints(system.scene), moves, strict=True) if moved]
        scale, unit = 1.0, "N per metre of motion"
        if len(names) == 1 and not slides(names[0].rpartition(" ")[2]):
            scale, unit = sizes[moves][0] ** 2, "N m/rad"
        parts, remedy = "", "lower the centre of gravity (cog), or hold it by stiffness"
        if of_pto:
            parts = f", {scale * (value[0] - of_pto):.4g} of water, weight and springs and {scale * of_pto:.4g} of the"
            parts += " power take-off"
        if of_pto < 0 < value[0] - of_pto:
            remedy = "let the power take-off push it away less, or hold it by stiffness"
        raise SimulationFailed(
            f"the equilibrium in still water is unstable: {', '.join(names)} falls away with a stiffness of"
            f" {scale * value[0]:.3g} {unit}{parts}; {remedy}"
        )


def require_upright(system: System) -> None:
    """Refuse offsets from rest, as known here, with which a run would end where it begins."""
    scene, rest, bounds = system.scene, system.joints_at_rest, system.bodies.limit
    offsets = scene.offsets
    if not offsets.any():
        return
    if (first := limits.beyond(scene, rest + offsets, bounds)) is not None:
        j, item, axis = first
        low, high = bounds[len(bounds) - len(rest) + j] - rest[j]
        limit = (
            f"must be within {low:+.3g} to {high:+.3g} {unit_along(axis)} of {axis}, from its rest at {rest[j]:+.3g}"
        )
        raise InputError(f"floats.{item.name}.offset", f"{offsets[j]:g} {unit_along(axis)}", limit)
    if over := limits.overturned(scene, rest + offsets):
        raise InputError("floats.offset", ", ".join(f"{x:g}" for x in offsets), f"must leave floats upright: {over}")


def with_usual_step(system: System, modes: SystemModes) -> System:
    """With the step of the shortest wave and of the scene's own periods, unless one is given.

    STEPS in the shortest wave's period and in each of the floats' own that is not below half of that: what is faster
    follows the waves without swinging, and the scheme is stable. In still water STEPS in all of them, and DRAWN in
    those that the offsets set swinging; a frame without floats stands still there. STEPS, too, in those of a frame's
    modes that load histories set swinging, and steps that miss no more than MISSED of these loads; and in all of its
    shapes where accelerations are asked for, which floats with loads that are not linear shake.
    """
    if system.scene.settings.time_step is not None:
        return system
    sea = system.scene.sea
    if sea.amplitude.any() or not system.scene.floats:
        floats = np.array([not name.startswith(FRAME) for name in modes.names], bool)
        periods = modes.period[floats & (modes.period > np.pi / sea.omega.max())]
        step = min([system.scene.usual_step, *(modes.period if system.shaken else periods) / STEPS])
    else:
        step = min([*_swinging(system, modes) / DRAWN, *modes.period / STEPS], default=system.scene.usual_step)
    step, s = step if np.isfinite(step) else system.scene.usual_step, system.scene.settings
    least, what = (s.discard + s.duration) / MOST_STEPS, "the scene's own periods"
    if system.histories:
        step = two_digits(min([step, *2 * np.pi / STEPS / moved(system).swung]))
        while step > least and missed(system, step) > MISSED:
            step, what = two_digits(SHORTER * step), "load histories"
    if (step := two_digits(step)) < least:
        what += f" ask for steps of {step:g} s, more than {MOST_STEPS} in {s.discard + s.duration:g} s"
        raise SimulationFailed(f"{what}: set solver.time_step, if nothing sets the fastest of them swinging")
    return system.with_step(step)


def _swinging(system: System, modes: SystemModes) -> np.ndarray:
    """Periods (m,) of the shapes that a scene let go from its offsets swings in."""
    model, nm = linear_model(system), system.structure.omega.size
    start = np.zeros(len(model.mass))
    start[nm:] = system.scene.offsets
    reach = np.abs(modes.shapes * model.length[:, None]).max(axis=0, initial=0.0)
    reach *= np.abs(modes.shapes.T @ model.mass @ start)
    return modes.period[(reach >= MOVES * reach.max(initial=0.0)) & (reach > 0)]


def with_critical_damping(scene: Scene, h: Hydrodynamics | None) -> Scene:
    """The scene with `critical_damping` κ as the linear damping of each axis that makes it κ of critical.

    B = 2κ(M + A(ω₀))ω₀ - b(ω₀), of the axis by itself: ω₀² (M + A(ω₀)) = C, b what radiates. In addition to `damping`.
    """
    if not any(np.any(f.critical_damping) for f in scene.floats):
        return scene
    system = prepare(scene, h)
    model = linear_model(system)
    radiating = h if scene.settings.radiation else None
    added = _added(model.active, system.bodies.added_mass, radiating)
    known = np.zeros(0) if radiating is None else radiating.omega
    coordinate, floats = system.structure.omega.size, []
    for f in scene.floats:
        damping = f.per_axis("damping").copy()
        for i, (name, ratio) in enumerate(zip(f.motion, f.per_axis("critical_damping"), strict=True)):
            if ratio > 0:
                key = f"floats.{f.name}.critical_damping" + f" of {name}" * (len(f.motion) > 1)
                damping[i] += _damping(model, added, known, coordinate, ratio, key)
            coordinate += 1
        floats.append(replace(f, damping=tuple(damping.tolist()), critical_damping=0.0))
    return replace(scene, floats=tuple(floats))


def _damping(model: LinearModel, added: Added, known: np.ndarray, axis: int, ratio: float, key: str) -> float:
    C, M = model.stiffness[axis, axis], model.mass[axis, axis]
    if not C > 0:
        raise InputError(key, ratio, "needs an axis that something restores")
    omega = _own(lambda omega: omega**2 * (M + added(omega)[axis, axis].real) - C, float(np.sqrt(C / M)), known)
    change = added(omega)[axis, axis]
    critical, radiated = 2 * (M + change.real) * omega, change.imag
    if radiated > ratio * critical:
        raise InputError(key, ratio, f"must be >= {radiated / critical:.3g}: radiation alone damps as much")
    return float(ratio * critical - radiated)


def _own(excess: Callable[[float], float], still: float, known: np.ndarray) -> float:
    """The ω nearest to `still` at which `excess`, below zero at 0 and above it at infinity, vanishes.

    Where water rings between bodies their added mass rises and falls, and there are several. known: frequencies
    between which it is a smooth curve.
    """
    from scipy.optimize import brentq

    at = np.unique(np.concatenate([[still / FAR, still, still * FAR], known]))
    above = np.array([excess(omega) > 0 for omega in at])
    ends = np.flatnonzero(above[1:] != above[:-1])
    return min((float(brentq(excess, at[k], at[k + 1])) for k in ends), key=lambda omega: abs(omega - still))
