"""All of a scene's record that its dampers have no part in: scenes that differ in them alone share it."""

from dataclasses import dataclass, fields, replace
from functools import cached_property, lru_cache
from typing import Any, NamedTuple

import numpy as np

from solver.coupled.driving import patterns, share_curve
from solver.coupled.linear import LinearModel, impedance, impedance_anywhere, linear_model, wave_force
from solver.coupled.moving import excitation
from solver.coupled.natural import SystemModes, require_stable, system_modes
from solver.coupled.preparation import prepare
from solver.coupled.support import Support
from solver.coupled.system import System, loads_at_rest
from solver.frequency import beyond, gaussian
from solver.frequency.condensed import Condensed
from solver.frequency.stations import Stations
from solver.hydrodynamics.bem.coefficients import Hydrodynamics
from solver.lines import real_by_complex
from solver.multibody.joint_law import JointLaw
from solver.multibody.of_axes import DAMPERS, damped, dampers
from solver.oddities import of_undamped
from solver.record.channels import Channels
from solver.record.effects import unlike
from solver.scene import Float, Scene

OTHERS = tuple(f.name for f in fields(Float) if f.name not in DAMPERS)
KNOWN = 2  # cases that a process keeps
NARROW = 1e-4  # of its frequency: half of a resonance's width, at least


class _Undamped:
    """A scene that equals all that differ from it in their dampers alone."""

    def __init__(self, scene: Scene):
        self.scene = scene
        floats = tuple(tuple(getattr(f, name) for name in OTHERS) for f in scene.floats)
        self._rest = scene.water, scene.sea, scene.current, scene.platform, scene.settings, floats

    def __hash__(self) -> int:
        return hash(self._rest)

    def __eq__(self, other: object) -> bool:
        return isinstance(other, _Undamped) and self._rest == other._rest


def case_of(scene: Scene, hydrodynamics: Hydrodynamics | None) -> "Case":
    """The case of a scene; SimulationFailed where its equilibrium is not stable."""
    return _case(_Undamped(scene), hydrodynamics)


@lru_cache(maxsize=KNOWN)
def _case(undamped: _Undamped, hydrodynamics: Hydrodynamics | None) -> "Case":
    scene = undamped.scene
    system = prepare(replace(scene, floats=tuple(map(_bare, scene.floats))), hydrodynamics)
    require_stable(system)
    return Case(system, hydrodynamics)


@lru_cache
def _bare(item: Float) -> Float:
    """Without its dampers; seas share it."""
    none: dict[str, Any] = dict.fromkeys(DAMPERS, 0.0)
    return replace(item, **none)


class Pushed(NamedTuple):
    """By the waves, with forces that are off."""

    more: np.ndarray  # (n, nl) force beyond the usual one
    excitation: np.ndarray  # (nl, nb, 6)


class Shifted(NamedTuple):
    """What coefficients off by their estimated error change of a case."""

    equation: Condensed
    impedance: np.ndarray  # (nl, na, na)
    pushed: Pushed
    unlike: float  # by how much forces are off, see effects.unlike


@dataclass(frozen=True, eq=False)
class Case:
    """A scene without its dampers, in its sea; n coordinates of its model.

    nl lines: of the nw waves that are not of zero height, then of the drag beyond the linear one, which no wave makes.
    """

    system: System
    hydrodynamics: Hydrodynamics | None

    @cached_property
    def model(self) -> LinearModel:
        """Of the system."""
        return linear_model(self.system)

    @cached_property
    def modes(self) -> SystemModes:
        """Of the system."""
        return system_modes(self.system, self.hydrodynamics)

    @cached_property
    def channels(self) -> Channels:
        """Of the scene."""
        return Channels(self.system.scene, self.system.support)

    @cached_property
    def sea_parameters(self) -> dict[str, float]:
        """Of its waves."""
        return self.system.scene.sea.parameters()

    @cached_property
    def warnings(self) -> tuple[str, ...]:
        """What is odd about the scene."""
        return of_undamped(self.system.scene, self.system.joints_at_rest)

    @cached_property
    def met(self) -> np.ndarray:
        """Which of the sea's waves have a height: others have no response."""
        return np.abs(self.system.scene.sea.amplitude) > 0

    @cached_property
    def waves(self) -> np.ndarray:
        """ω (nw,) of the waves [rad/s]."""
        return self.system.scene.sea.omega[self.met]

    @cached_property
    def nodes(self) -> beyond.Nodes:
        """Lines of the drag beyond the linear one, dense about resonances as narrow as drag and frame make them.

        What radiates makes them wider. One wave alone has none.
        """
        if not self.stations.size or self.waves.size == 1:
            return beyond.Nodes(np.zeros(0), np.zeros(0))
        highest, nm, damping = float(self.waves.max()), self.model.modes.shape[1], self.model.damping.copy()
        damping[:nm, :nm] += self.stations.against(self.at_rest)
        below = (self.modes.omega > 0) & (self.modes.omega < beyond.ORDERS * highest)
        own, shapes = self.modes.omega[below], self.modes.shapes[:, below]
        half = np.maximum(np.sum(shapes * (damping @ shapes), axis=0) / 2, NARROW * own)
        scene = self.system.scene
        assert scene.platform is not None, "drag is a platform's"
        size = np.ptp(list(scene.platform.frame.nodes.values()), axis=0).max()
        unit = float(np.sqrt(scene.water.gravity / size))
        return beyond.nodes(highest, own, half, np.sum(shapes[:nm] ** 2, axis=0), unit)

    @cached_property
    def omega(self) -> np.ndarray:
        """(nl,) [rad/s]."""
        return np.concatenate([self.waves, self.nodes.omega])

    @cached_property
    def amplitude(self) -> np.ndarray:
        """Of the waves' elevation (nl,) [m]."""
        return self.padded(self.system.scene.sea.amplitude[self.met])

    def padded(self, of_waves: np.ndarray) -> np.ndarray:
        """(…, nl) of what waves alone have (…, nw)."""
        out = np.zeros((*of_waves.shape[:-1], self.omega.size), complex)
        out[..., : self.waves.size] = of_waves
        return out

    @cached_property
    def process(self) -> gaussian.Process:
        """That lines are of: as long as a march's, and from when that is where phases are known."""
        s, sea = self.system.scene.settings, self.system.scene.sea
        return gaussian.Process(self.omega, s.duration, self.nodes.omega.size, s.discard if sea.known else None)

    @cached_property
    def rows(self) -> np.ndarray:
        """All that the waves drive (m, nw)."""
        return self.system.rows if self.met.all() else self.system.rows[:, self.met]

    @cached_property
    def modal(self) -> np.ndarray:
        """Load of the waves on the modes (nm, nl)."""
        return self.padded(self.rows[self.system.layout.modal])

    @cached_property
    def impedance(self) -> np.ndarray:
        """Y (nl, na, na) of what radiates."""
        return self._impedance(self.hydrodynamics)

    def impedance_at(self, omega: np.ndarray) -> np.ndarray:
        """The same (nw, na, na) at any ω from 0 on; nothing without coefficients."""
        if self.hydrodynamics is None:
            return np.zeros((omega.size, *2 * (len(self.model.active),)))
        return impedance_anywhere(self.system, self.hydrodynamics, omega)

    def driven(self, omega: np.ndarray, load: np.ndarray, damping: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """X (ne, k, n) by k loads (ne, k, n) each at any ω, with further damping (n, n), and Y (ne, na, na)."""
        Y = self.impedance_at(omega)
        Z = self.model.dynamic_stiffness(omega, Y) - 1j * omega[:, None, None] * damping
        return np.linalg.solve(Z, load.swapaxes(1, 2)).swapaxes(1, 2), Y

    def _impedance(self, h: Hydrodynamics | None) -> np.ndarray:
        """By other coefficients."""
        if h is None:
            return np.zeros((self.omega.size, *2 * (len(self.model.active),)))
        Y, at = impedance(self.system, h, self.waves), self.nodes.omega
        return np.concatenate([Y, impedance_anywhere(self.system, h, at)]) if at.size else Y

    @cached_property
    def radiating(self) -> np.ndarray:
        """Force of the waves on what radiates (nl, na)."""
        rows = self.padded(self.rows[self.system.layout.excitation])
        on_floats = rows.T.reshape(self.omega.size, len(self.system.scene.floats), 6)
        return on_floats[..., self.system.bodies.active].reshape(self.omega.size, len(self.model.active))

    @cached_property
    def excitation(self) -> np.ndarray:
        """The same on the floats, at rest (nl, nb, 6)."""
        return self.model.pushed(self.radiating)

    @cached_property
    def force(self) -> np.ndarray:
        """F (n, nl) of the waves, without drag."""
        return np.ascontiguousarray(wave_force(self.model, self.radiating, self.modal).T)

    @cached_property
    def stations(self) -> Stations:
        """Where the frame has drag."""
        support, water = self.system.support, self.rows[self.system.layout.station]
        many = support is not None and share_curve(support, self.met.size)
        stream = support.stream if support else None
        return Stations(self.system.structure, water, stream, patterns(support) if many else None)

    @property
    def of_drag(self) -> np.ndarray:
        """Maps (r + nt, nd, ns) from the stations' drag to the frame's forces and what is left out of its tops."""
        if self.system.support is None:
            return np.zeros((0, *self.system.structure.station.shape[1:]))
        return _of_drag(self.system.support)

    def drag(self, rate: np.ndarray | None) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """K, and what it does to the modes (see Stations), where they move at rates (nm, nw), if they do."""
        if not self.stations.size:
            nm = self.system.structure.omega.size
            return np.zeros((0, 0, 0)), np.zeros((nm, nm)), np.zeros((nm, self.omega.size), complex)
        K = self.at_rest if rate is None else self.stations.equivalent(rate)
        return K, *self.pushed(K, self.system.structure.station)

    def pushed(self, K: np.ndarray, on: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """By maps (k, nd, ns) of the drag: damping of what it does against modal rates (k, nm), and else (k, nl).

        Beyond the linear one it goes with the mean square of the flow that K is of.
        """
        against, of_water = self.stations.acting(K, on)
        if not self.nodes.omega.size:
            return against, of_water
        maps = on * (np.einsum("sii->s", K) * self._share + (self._share == 0)) ** 2
        rest = real_by_complex(maps.reshape(len(on), len(self.rest)), self.rest)
        return against, np.concatenate([of_water, rest], axis=1)

    @cached_property
    def _share(self) -> np.ndarray:
        """Of K's trace where the frame does not move (ns,): what a unit is; 0 where there is none."""
        at_rest = np.einsum("sii->s", self.at_rest)
        return np.divide(1.0, at_rest, out=np.zeros(at_rest.size), where=at_rest > 0)

    @cached_property
    def at_rest(self) -> np.ndarray:
        """K where the frame does not move."""
        return self.stations.equivalent(None)

    @cached_property
    def drag_at_rest(self) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """What drag does where the frame does not move."""
        return self.drag(None)

    @cached_property
    def force_at_rest(self) -> np.ndarray:
        """F (n, nl) with the drag on a frame that does not move."""
        force, of_water = self.force.copy(), self.drag_at_rest[2]
        force[: len(of_water)] += of_water
        return force

    @cached_property
    def equation(self) -> Condensed:
        """Without dampers."""
        return Condensed(self.model, self.omega, self.impedance, self.drag_at_rest[1])

    @cached_property
    def rest(self) -> np.ndarray:
        """Drag on a frame that does not move beyond the linear one (nd ns, nl - nw) [N]."""
        if not self.nodes.omega.size:
            return np.zeros((len(self.stations.water), 0), complex)
        return beyond.forces(self.stations, self.waves, self.process.duration, self.nodes)

    @cached_property
    def shifted(self) -> Shifted | None:
        """By coefficients off by their estimated error; None without one."""
        h = self.hydrodynamics
        if h is None or h.shifted is h:
            return None
        pushed, impedance = self.pushed_by(h.shifted), self._impedance(h.shifted)
        off = unlike(self.force, self.force + pushed.more)
        return Shifted(self.equation.radiating(impedance), impedance, pushed, off)

    def pushed_by(self, h: Hydrodynamics) -> Pushed:
        """By forces of other coefficients."""
        pushed = (self.padded(excitation(self.system, h, self.waves).T) * self.amplitude).T
        force = np.ascontiguousarray(wave_force(self.model, pushed, self.modal).T)
        return Pushed(force - self.force, self.model.pushed(pushed))

    @property
    def loads_at_rest(self) -> tuple[np.ndarray, np.ndarray]:
        """JᵀW (nz,) and W (nb, 6) of the floats."""
        return loads_at_rest(self.system.resting)

    def carried_by(self, x: np.ndarray) -> np.ndarray:
        """JᵀW (nc,) on the carriers, of a steady x (n,)."""
        held = self.model.floats[0, : self.system.structure.carrier.shape[0]]
        return np.asarray(-held @ (self.model.shape @ x))

    def shift(self, load: np.ndarray, more: np.ndarray | None = None) -> np.ndarray:
        """C⁻¹ f (n,) of a steady load (n,), with more stiffness (n, n); what nothing holds stays where it is."""
        if more is None:
            return np.asarray(self._flexibility @ load)
        held, n = self._held.copy(), load.size
        held[:n, :n] += more
        return np.linalg.solve(held, np.append(load, np.zeros(len(held) - n)))[:n]

    @cached_property
    def _flexibility(self) -> np.ndarray:
        n = len(self.model.stiffness)
        return np.asarray(np.linalg.inv(self._held)[:n, :n])

    @cached_property
    def _held(self) -> np.ndarray:
        """C, and of each shape that nothing holds a row and a column that do."""
        free = self.modes.shapes[:, self.modes.omega == 0]
        return np.block([[self.model.stiffness, free], [free.T, np.zeros((free.shape[1],) * 2)]])

    def law(self, floats: tuple[Float, ...]) -> JointLaw:
        """Of the same joints with these floats' dampers."""
        carriers = np.zeros(self.system.structure.carrier.shape[0])
        more = {name: np.concatenate([carriers, *(f.per_axis(name) for f in floats)]) for name in DAMPERS}
        return damped(self.system.bodies.law, more)

    def linear_damping(self, law: JointLaw) -> np.ndarray:
        """(nj,) of the law's dampers, which the model does not have."""
        return (dampers(law) - dampers(self.system.bodies.law))[self.system.structure.carrier.shape[0] :]


@lru_cache(maxsize=KNOWN)
def _of_drag(support: Support) -> np.ndarray:
    """Scenes on one platform share it."""
    forces = [support.forces.drag] if support.forces is not None else []
    maps = np.concatenate([*forces, support.left_out.drag], axis=1)
    return maps.T.reshape(maps.shape[1], *support.station_shape.shape[1::-1])
