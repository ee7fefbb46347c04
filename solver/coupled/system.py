"""A scene as arrays: constants of a run, its waves sample by sample, and its initial state."""

from dataclasses import dataclass, replace
from functools import cached_property, lru_cache

import numpy as np

from solver.coupled import assembly, linear_drag, stretching
from solver.coupled.energy import AT_START, SCALE, WORKS, energy
from solver.coupled.equilibrium import Differences, balance, differences, equilibrium, symmetric_stiffness, weights
from solver.coupled.memory import Memory
from solver.coupled.modal import Structure, WaterAbout, drag
from solver.coupled.pieces.pace import SWING
from solver.coupled.problem import LEAST, Drive, Problem, new_problem
from solver.coupled.stages import State
from solver.coupled.support import Support
from solver.errors import SimulationFailed
from solver.hydrodynamics.radiation import memory as radiation
from solver.keys import Bits, Same, shared
from solver.multibody import joint_law, of_axes, zones
from solver.multibody.bodies import Bodies, new_motion
from solver.multibody.minimal import mass_matrix, move
from solver.scene import Scene
from solver.sea.field import WaveField
from solver.sea.realization import ramp
from solver.sea.series import Factored, WaveSeries, factored
from solver.structure.load_history import LoadHistory

SHAKEN = 1e-2  # with which modes' accelerations are off by 1 or 2 %
FELT = 0.1  # of a float's largest force per wave amplitude: by no more do waves push whose pressure may be linear
BLOCK_STEPS = 256  # steps a block: small enough for the cache, large enough for BLAS and for Python
ROUNDING = 1e-12  # of the weights' energy and work: 2e-16 a step, in some 1e6 steps of either sign
LAST_BIT = np.finfo(float).eps
BALANCE = 1e-3  # every record's energy balance closes to so much of the energy exchanged
KNOWN = 32  # scenes at rest that a process keeps
ITERATIONS = 40  # of Newton's method; two or three suffice where a step is sane
Resting = Bits[tuple[Bodies, Structure, np.ndarray]]


@dataclass(frozen=True, eq=False, kw_only=True)
class System:
    """A scene as arrays, for one step length."""

    scene: Scene
    bodies: Bodies
    support: Support | None
    structure: Structure
    fit: radiation.RadiationMemory | None
    memory: Memory
    rows: np.ndarray
    layout: assembly.Layout
    waves: WaveField
    near: WaveField  # of the waves whose pressure is integrated where the floats are; that of others is linear
    dt: float

    @cached_property
    def equilibrium(self) -> tuple[np.ndarray, np.ndarray]:
        """Coordinates z (nz,) and modal amplitudes p (nm,) at rest without waves, under the loads of the start."""
        _, z, p = self._at_rest
        return z.copy(), p.copy()  # kernels are compiled once more for arrays that nobody may write to

    @property
    def joints_at_rest(self) -> np.ndarray:
        """(nj,) of z in equilibrium."""
        return self.equilibrium[0][self.structure.carrier.shape[0] :]

    @cached_property
    def _at_rest(self) -> tuple[Resting, np.ndarray, np.ndarray]:
        stride = 0.1 * min([1.0, *(f.hull.size for f in self.scene.floats)])
        try:
            return _at_rest(Same(self.bodies), Same(self.structure), Bits(self._steady()), stride)
        except SimulationFailed as error:
            names = ", ".join(f"{f.name} {axis}" for f in self.scene.floats for axis in f.motion)
            raise SimulationFailed(f"{error}; joints: {names}") from None

    def _steady(self) -> np.ndarray:
        """Modal loads (nm,) of the current and of the load histories' start on the frame at rest."""
        if self.still:
            return np.zeros(self.structure.omega.size)
        samples = np.zeros((1, len(self.rows)))
        self.besides(np.zeros(1), samples)
        first = self.drive(samples)
        return first.modal[0] + self.drag_at_rest(first)

    @property
    def marched(self) -> Structure:
        """The structure with the drag of stations up to the waves' surface, where that is asked for."""
        stretched = self.support.stretched if self.support is not None else None
        return self.structure if stretched is None else self.structure._replace(drag=stretched.drag)

    def drag_at_rest(self, drive: Drive) -> np.ndarray:
        """Modal load (nm,) of the drive's first sample at the stations, on the frame at rest."""
        load = np.zeros((2, self.structure.omega.size))
        both = WaterAbout(*(np.repeat(part[:1], 2, axis=0) for part in (drive.station, drive.wet, drive.push)))
        if both.flow.any() or both.push.any():
            drag(self.marched, both, np.zeros(load.shape), 1, load, np.empty(both.flow.shape))
        return load[1]

    @property
    def histories(self) -> tuple[LoadHistory, ...]:
        """The platform's loads that go with time."""
        return self.scene.platform.load_histories if self.scene.platform else ()

    def besides(self, t: np.ndarray, out: np.ndarray) -> None:
        """Add what no wave drives to columns of the rows (m, columns): current at the stations, applied loads."""
        at, support = self.layout, self.support
        assert support is not None, "asked of a scene with a current or loads on a platform"
        out[:, at.station] += support.stream.ravel()
        if self.histories:
            force = np.concatenate([history.at(t)[:, history.axes] for history in self.histories], axis=1)
            out[:, at.modal] += force @ support.applied
            if support.forces is not None:
                out[:, at.forces] += force @ support.forces.applied

    @property
    def resting(self) -> Resting:
        """Equal for all scenes that move alike in still water, about the same equilibrium."""
        return self._at_rest[0]

    @cached_property
    def differences(self) -> Differences:
        """Of the floats' loads there."""
        return known_differences(self.resting)

    @property
    def stiffness(self) -> np.ndarray:
        """Tangent stiffness (nz, nz) of the floats there: buoyancy, weight, springs and their levers."""
        return symmetric_stiffness(self.differences.residual[0])

    @cached_property
    def factored(self) -> Factored:
        """The rows in fewer, for the march; the frame's forces to rounding of the largest of their kind.

        Those that symmetry makes zero are rounding themselves, in which nothing depends on anything.
        """
        size = np.linalg.norm(self.rows, axis=1)
        if self.support is not None and self.support.forces is not None:
            borne, moments = size[self.layout.forces], self.support.forces.moments
            for kind in (moments, ~moments):
                borne[kind] = borne[kind].max(initial=0.0)
        return factored(self.rows, size)

    def with_step(self, dt: float) -> "System":
        """The same scene at another step; what does not depend on it is not computed again."""
        scene = replace(self.scene, settings=replace(self.scene.settings, time_step=dt))
        memory = assembly.memory(self.fit, dt, self.bodies.added_mass.shape[0])
        other = replace(self, scene=scene, dt=dt, memory=memory)
        kept = ("equilibrium", "_at_rest", "differences", "factored", "drag_of_water")
        vars(other).update({name: value for name, value in vars(self).items() if name in kept})
        return other

    @property
    def newton_tolerance(self) -> float:
        """For this step: positions change by dt² of the accelerations, and those give the forces [m or rad].

        Where accelerations are asked for that loads of floats shake, SHAKEN of that: so does what Newton leaves.
        """
        radius = min((f.hull.largest_radius for f in self.scene.floats), default=1.0)
        share = min(1.0, radius) * min(1.0, self.dt / self.scene.usual_step) ** 2
        share *= SHAKEN if self.shaken else 1.0
        return max(self.scene.settings.newton_tolerance * share, LEAST)

    @property
    def terms(self) -> tuple[int, ...]:
        """Number of terms of the local wave field around each float; none where its pressure is linear."""
        return tuple(np.diff(self.bodies.first_term).tolist())

    def least_energy(self, steps: int = 0) -> float:
        """Least scale of the energy balance [J] then: rounding and Newton's tolerance open it by BALANCE of that.

        Newton's tolerance τ leaves open τ² Σ|Kᵢᵢ| (the signs: what rests on springs alone may be unstable beside),
        and rounding a share of the weights' energy, which buoyancy's work cancels, and of what a current has bent.
        The latter drifts: a last bit of a load leaves a bent mode p a velocity for good. It moves p by less than half a
        last bit a step, ε p/2, which is none, while the flow's load ω²p works on it: ε of what is bent, each step.
        """
        newton = self.newton_tolerance**2 * np.abs(np.diag(self.stiffness)).sum()
        bent = 0.0 if self.still else 0.5 * float(np.sum((self.structure.omega * self.equilibrium[1]) ** 2))
        return float(newton + ROUNDING * (weights(self.bodies) + bent) + LAST_BIT * steps * bent) / BALANCE

    def start(self) -> State:
        """Let go at rest from still-water equilibrium plus the floats' offsets, accelerations consistent."""
        body, nm = self.bodies, self.structure.omega.size
        nz, nc = body.mechanism.size, self.structure.carrier.shape[0]
        z, p = (part.copy() for part in self.equilibrium)
        z[nc:] += self.scene.offsets
        s = self.scene.settings
        samples = self.rows.sum(axis=1).real[None] * ramp(0.0, s.ramp, s.ramp_form)
        if not self.still:
            self.besides(np.zeros(1), samples)
        first = self.drive(samples)
        zone, (ddp, ddz, load, held) = self.zones_at(z), _initial_acceleration(self, z, p, first)
        state = State(
            z=z[nc:],
            dz=np.zeros(nz - nc),
            ddz=np.tile(ddz, (3, 1)),
            p=p,
            dp=np.zeros(nm),
            ddp=ddp,
            force=np.tile(load, (3, 1)),
            memory=np.zeros((self.memory.residue.shape[0], self.memory.direct.shape[2]), complex),
            power=np.zeros(len(WORKS)),
            work=np.zeros(len(WORKS)),
            energy=np.array([0.0, self.least_energy(), 0.0]),
            zone=zone,
            held=held,
            pace=self.pace,
            jolt=np.zeros(nz, np.int64),
            ring=np.full(1, np.inf),
            fastest=np.zeros(nz),
        )
        state.energy[AT_START] = energy(body, self.structure, state)
        rest = self.equilibrium[0]
        at_rest = energy(body, self.structure, state._replace(z=rest[nc:].copy(), zone=self.zones_at(rest)))
        # What offsets hold goes to and fro, and where nothing is lost the sum of what is stored does not tell of it.
        state.energy[SCALE] = max(state.energy[SCALE], abs(state.energy[AT_START] - at_rest))
        return state

    @property
    def shaken(self) -> bool:
        """Whether accelerations are asked for of a frame with floats whose loads are not linear, or drag in one wave:
        each of its harmonics may meet a shape; in a sea they are spread, and next to nothing as fast.
        """
        bent = bool(self.bent.size) or bool(of_axes.drag(self.bodies.law).any()) or bool(self.bodies.nonlinear.any())
        chimes = bool(self.structure.drag.any()) and np.count_nonzero(self.scene.sea.amplitude) == 1
        return "accelerations" in self.scene.settings.outputs and (bent or chimes)

    @property
    def bent(self) -> np.ndarray:
        """Coordinates whose joint's law has several zones."""
        return np.flatnonzero(of_axes.bent(self.bodies.law))

    def zones_at(self, z: np.ndarray) -> np.ndarray:
        """(2, nz) of the joints' laws where the floats are let go at rest at z (nz,)."""
        zone = np.zeros((2, z.size), np.int64)
        zones.zones_at_rest(self.bodies.law, z, zone)
        for i in np.flatnonzero(of_axes.tabled(self.bodies.law) | of_axes.turning(self.bodies.law)):
            zone[joint_law.PTO_ZONE, i] = zones.pto_zone(self.bodies.law, int(i), z[i], 0.0)
        return zone

    @property
    def pace(self) -> np.ndarray:
        """(nz,) [s] in which a swing on an end stop is followed, of all that its modes let move."""
        return self._follows(0)

    @property
    def swing(self) -> np.ndarray:
        """(nz,) [s] in which it is where the platform does not move."""
        return self._follows(self.structure.omega.size)

    def _follows(self, first: int) -> np.ndarray:
        """(nz,) [s] of what swings on an end stop, of modes and joints from `first` on."""
        if not of_axes.stopped(self.bodies.law).any():
            return np.full(self.bodies.mechanism.size, np.inf)
        (nc, nm), nz = self.structure.carrier.shape, self.bodies.mechanism.size
        compliance, mass = np.zeros(nz), _whole_mass(self, self.equilibrium[0])[first:, first:]
        compliance[nc:] = np.diag(np.linalg.inv(mass))[nm - first :]
        rates = of_axes.stop_rates(self.bodies.law, compliance)
        # Finer as steps are: a run with half the step tells what both leave out.
        pieces = SWING * max(1.0, self.scene.usual_step / self.dt)
        return np.divide(2 * np.pi / pieces, rates, out=np.full(nz, np.inf), where=rates > 0)

    def problem(self) -> Problem:
        """The arrays and tolerances of a march."""
        bent, zone = self.bent, np.zeros((2, self.bodies.mechanism.size), np.int64)
        zones.zones_at_rest(self.bodies.law, self.equilibrium[0], zone)
        on_stops = np.zeros(zone.shape[1])
        on_stops[bent] = [joint_law.tangent(self.bodies.law, i, *zone[:, i])[0] for i in bent]
        return new_problem(
            self.bodies,
            self.marched,
            self.memory,
            self.stiffness - np.diag(on_stops),
            beta=self.fit.beta if self.fit is not None else np.zeros(0),
            bent=bent,
            pace=self.pace,
            swing=self.swing,
            resistance=self.drag_of_water[1],
            dt=self.dt,
            tolerance=self.newton_tolerance,
            iterations=ITERATIONS,
        )

    @cached_property
    def drag_of_water(self) -> tuple[np.ndarray, np.ndarray]:
        """Mean F (ns, nd) [N] and resistance R (ns, nd, nd) [N s/m] of the frame's stations, by drag linearised by the
        water's own velocity."""
        drag, (_, nd, ns) = self.structure.drag, self.structure.station.shape
        if self.support is None or not drag.any():
            return np.zeros((ns, nd)), np.zeros((ns, nd, nd))
        mean, slope = linear_drag.equivalent(self.support.stream, self.water_at_stations)
        return drag[:, None] * mean, drag[:, None, None] * slope

    @property
    def water_at_stations(self) -> np.ndarray:
        """Velocity (nw, nd, ns) of the waves' water at the frame's stations."""
        shape = self.structure.station.shape[1:]
        return np.asarray(self.rows[self.layout.station].T.reshape(self.scene.sea.omega.size, *shape))

    def series(self, dt: float, block: int = 2 * BLOCK_STEPS + 1) -> WaveSeries:
        """All that the wave drives, at samples dt/2 apart, blocks of at most `block`."""
        s, besides = self.scene.settings, None if self.still else self.besides
        grow = lambda t: ramp(t, s.ramp, s.ramp_form)  # noqa: E731
        return WaveSeries(self.factored, self.scene.sea.omega, dt / 2, block, grow, besides)

    @property
    def still(self) -> bool:
        """Whether nothing but waves drives the scene."""
        return self.scene.current is None and not self.histories

    def drive(self, samples: np.ndarray) -> Drive:
        """Columns of the wave series (m, columns) as the march reads them."""
        nb, (_, nd, ns) = len(self.scene.floats), self.structure.station.shape
        m, at = len(samples), self.layout
        flow, wet, push = np.ascontiguousarray(samples[:, at.station]), np.zeros((m, 0)), np.zeros((m, nd, 0))
        if self.support is not None and self.support.stretched is not None:
            of, depth = self.support.stretched, self.scene.water.depth
            flow, wet, push = stretching.stretched(of, self.waves, depth, samples, at.water.start)
        return Drive(
            field=np.ascontiguousarray(samples[:, at.field]),
            excitation=np.ascontiguousarray(samples[:, at.excitation]).reshape(m, nb, 6),
            modal=np.ascontiguousarray(samples[:, at.modal]),
            station=flow.reshape(m, nd, ns),
            wet=wet,
            push=push,
        )


@lru_cache(maxsize=KNOWN)
def known_differences(scene: Resting) -> Differences:
    """Scenes that differ in their seas alone share them."""
    bodies, _, z = scene.value
    return differences(bodies, z)


@lru_cache(maxsize=KNOWN)
def loads_at_rest(scene: Resting) -> tuple[np.ndarray, np.ndarray]:
    """JᵀW (nz,) and W (nb, 6) of the floats there."""
    bodies, _, z = scene.value
    load, wrench, *_ = balance(bodies, z)
    return shared(load), shared(wrench)


@lru_cache(maxsize=KNOWN)
def _at_rest(
    bodies: Same[Bodies], structure: Same[Structure], steady: Bits[np.ndarray], stride: float
) -> tuple[Resting, np.ndarray, np.ndarray]:
    """What stands for a scene at rest, and its equilibrium; scenes that differ in their seas alone have one object."""
    frame = structure.value
    still = bodies.value._replace(law=of_axes.at_rest(bodies.value.law))
    z, p = _equilibrium(Bits((still, frame.omega, frame.carrier, steady.value)), stride)
    return Bits((bodies.value, frame, z.copy())), z, p


@lru_cache(maxsize=KNOWN)
def _equilibrium(
    scene: Bits[tuple[Bodies, np.ndarray, np.ndarray, np.ndarray]], stride: float
) -> tuple[np.ndarray, np.ndarray]:
    """Of floats, frequencies, carriers and loads of the structure; scenes that differ in what damps them share it."""
    z, p = equilibrium(*scene.value, stride)
    return shared(z), shared(p)


def _whole_mass(system: System, z: np.ndarray) -> np.ndarray:
    """Of modes and joints (nm + nj, nm + nj), with the floats at z (nz,)."""
    body, shape = system.bodies, system.structure.carrier
    nz, (nc, nm) = body.mechanism.size, shape.shape
    motion, M = new_motion(body), np.zeros((nz, nz))
    move(body, z, np.zeros(nz), motion)
    mass_matrix(body, motion, M)
    return np.block(
        [[np.eye(nm) + shape.T @ M[:nc, :nc] @ shape, shape.T @ M[:nc, nc:]], [M[nc:, :nc] @ shape, M[nc:, nc:]]]
    )


def _initial_acceleration(
    system: System, z: np.ndarray, p: np.ndarray, first: Drive
) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """At t = 0, from all loads at rest: accelerations of modes and joints, the modal load of hinges, drag and
    push, and (nz,) what holds the axes that do not move."""
    frame, body = system.structure, system.bodies
    nc, nm = frame.carrier.shape
    r, *_ = balance(body, z, field=first.field[0], excitation=first.excitation[0])
    shape, whole = frame.carrier, _whole_mass(system, z)
    load = np.concatenate([shape.T @ r[:nc] - frame.omega**2 * p + first.modal[0], r[nc:]])
    load[:nm] += system.drag_at_rest(first)
    at_rest = np.flatnonzero(of_axes.holds(body.law))
    rows, free, known = nm + at_rest - nc, whole.copy(), load.copy()
    free[rows], known[rows] = np.eye(len(whole))[rows], 0.0
    acceleration = np.linalg.solve(free, known)
    held = np.zeros(z.size)
    held[at_rest] = (load - whole @ acceleration)[rows]
    ddp, ddz = acceleration[:nm], acceleration[nm:]
    return ddp, ddz, ddp + frame.omega**2 * p - first.modal[0], held
