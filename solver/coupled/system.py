"""A scene as arrays: constants of a run, its initial state, and the march block by block."""

from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import cached_property, lru_cache

import numpy as np

from solver import limits, motions
from solver.coupled import assembly, stretching
from solver.coupled import support as supports
from solver.coupled.energy import AT_START, GAP, SCALE, WORKS, energy, open_by
from solver.coupled.equilibrium import (
    Differences,
    balance,
    differences,
    equilibrium,
    righting,
    symmetric_stiffness,
    weights,
)
from solver.coupled.march import GROSSLY, march
from solver.coupled.memory import Memory
from solver.coupled.modal import Structure, WaterAbout, drag
from solver.coupled.pieces.fine import new_fine
from solver.coupled.pieces.pace import SWING
from solver.coupled.pieces.pieces import CHANGES
from solver.coupled.stages import State
from solver.coupled.step import (
    EXCURSION,
    NOT_CONVERGED,
    OK,
    TO_AND_FRO,
    UNBALANCED,
    Drive,
    Output,
    Problem,
    new_output,
    new_problem,
    new_workspace,
)
from solver.coupled.support import Support
from solver.errors import InputError, SimulationFailed, StepTooLong
from solver.hydrodynamics.bem.coefficients import DOFS, Hydrodynamics
from solver.hydrodynamics.bem.mean_hull import motion_lengths
from solver.hydrodynamics.hull.mesh import Hull
from solver.hydrodynamics.radiation import memory as radiation
from solver.keys import Bits, Same, shared
from solver.limits import slides
from solver.multibody import joint_law
from solver.multibody.minimal import Bodies, mass_matrix, move, new_motion
from solver.scene import Float, Platform, Scene, Settings, Water
from solver.sea.current import Current
from solver.sea.field import WaveField, wave_field
from solver.sea.realization import CALM, ramp
from solver.sea.series import Factored, WaveSeries, factored
from solver.structure.load_history import LoadHistory

FELT = 0.1  # of a float's largest force per wave amplitude: by no more do waves push whose pressure may be linear
BLOCK_STEPS = 256  # steps a block: small enough for the cache, large enough for BLAS and for Python
LEAST = 1e-13  # of Newton's tolerances [m or rad]
ROUNDING = 1e-12  # of the weights' energy and work: 2e-16 a step, in some 1e6 steps of either sign
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
        stride = 0.1 * min(1.0, *(f.hull.size for f in self.scene.floats), 1.0)
        return _at_rest(Same(self.bodies), Same(self.structure), Bits(self._steady()), stride)

    def _steady(self) -> np.ndarray:
        """Modal loads (nm,) of the current and of the load histories' start on the frame at rest."""
        if self.still:
            return np.zeros(self.structure.omega.size)
        first = self.drive(self.besides(np.zeros(1)))
        return first.modal[0] + self.drag_at_rest(first.station[0])

    def drag_at_rest(self, flow: np.ndarray) -> np.ndarray:
        """Modal drag (nm,) of water of velocity flow (nd, ns) at the stations, on the frame at rest."""
        load = np.zeros((2, self.structure.omega.size))
        if flow.any():
            both = np.stack([flow, flow])
            water = WaterAbout(both, np.zeros((2, 0)), np.zeros((2, 0, 0)))
            drag(self.structure, water, np.zeros(load.shape), 1, load, np.empty(both.shape), np.empty(2))
        return load[1]

    @property
    def histories(self) -> tuple[LoadHistory, ...]:
        """The platform's loads that go with time."""
        return self.scene.platform.load_histories if self.scene.platform else ()

    def besides(self, t: np.ndarray) -> np.ndarray:
        """What no wave drives, among the columns of the rows (m, columns): current at the stations, applied loads."""
        out, at, support = np.zeros((len(t), len(self.rows))), self.layout, self.support
        assert support is not None, "asked of a scene with a current or loads on a platform"
        out[:, at.station] = support.stream.ravel()
        if self.histories:
            force = np.concatenate([history.at(t)[:, history.axes] for history in self.histories], axis=1)
            out[:, at.modal] = force @ support.applied
            if support.forces is not None:
                out[:, at.forces] = force @ support.forces.applied
        return out

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
        kept = ("equilibrium", "_at_rest", "differences", "factored")
        vars(other).update({name: value for name, value in vars(self).items() if name in kept})
        return other

    @property
    def newton_tolerance(self) -> float:
        """For this step: positions change by dt² of the accelerations, and those give the forces [m or rad]."""
        radius = min((f.hull.largest_radius for f in self.scene.floats), default=1.0)
        share = min(1.0, radius) * min(1.0, self.dt / self.scene.usual_step) ** 2
        return max(self.scene.settings.newton_tolerance * share, LEAST)

    @property
    def terms(self) -> tuple[int, ...]:
        """Number of terms of the local wave field around each float; none where its pressure is linear."""
        return tuple(np.diff(self.bodies.first_term).tolist())

    @property
    def least_energy(self) -> float:
        """Least scale of the energy balance [J]: rounding and Newton's tolerance open it by BALANCE of that.

        Newton's tolerance τ leaves open τ² Σ|Kᵢᵢ| (the signs: what rests on springs alone may be unstable beside),
        and rounding a share of the weights' energy, which buoyancy's work cancels, and of what a current has bent.
        """
        newton = self.newton_tolerance**2 * np.abs(np.diag(self.stiffness)).sum()
        bent = 0.0 if self.still else 0.5 * float(np.sum((self.structure.omega * self.equilibrium[1]) ** 2))
        return float(newton + ROUNDING * (weights(self.bodies) + bent)) / BALANCE

    def start(self) -> State:
        """Let go at rest from still-water equilibrium plus the floats' offsets, accelerations consistent."""
        body, nm = self.bodies, self.structure.omega.size
        nz, nc = body.mechanism.size, self.structure.carrier.shape[0]
        z, p = (part.copy() for part in self.equilibrium)
        z[nc:] += np.concatenate([np.zeros(0), *(f.per_axis("offset") for f in self.scene.floats)])
        s = self.scene.settings
        samples = self.rows.sum(axis=1).real[None] * ramp(0.0, s.ramp, s.ramp_form)
        first = self.drive(samples if self.still else samples + self.besides(np.zeros(1)))
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
            energy=np.array([0.0, self.least_energy, 0.0]),
            zone=zone,
            held=held,
            pace=self.pace,
            jolt=np.zeros(nz, np.int64),
            ring=np.full(1, np.inf),
            fastest=np.zeros(nz),
        )
        state.energy[AT_START] = energy(body, self.structure, state)
        return state

    @property
    def bent(self) -> np.ndarray:
        """Coordinates whose joint's law has several zones."""
        return np.flatnonzero(joint_law.bent(self.bodies.law))

    def zones_at(self, z: np.ndarray) -> np.ndarray:
        """(2, nz) of the joints' laws where the floats are let go at rest at z (nz,)."""
        zone = np.zeros((2, z.size), np.int64)
        joint_law.zones_at_rest(self.bodies.law, z, zone)
        for i in np.flatnonzero(joint_law.tabled(self.bodies.law) | joint_law.turning(self.bodies.law)):
            zone[joint_law.PTO_ZONE, i] = joint_law.pto_zone(self.bodies.law, int(i), z[i], 0.0)
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
        if not joint_law.stopped(self.bodies.law).any():
            return np.full(self.bodies.mechanism.size, np.inf)
        (nc, nm), nz = self.structure.carrier.shape, self.bodies.mechanism.size
        compliance, mass = np.zeros(nz), _whole_mass(self, self.equilibrium[0])[first:, first:]
        compliance[nc:] = np.diag(np.linalg.inv(mass))[nm - first :]
        rates = joint_law.stop_rates(self.bodies.law, compliance)
        return np.divide(2 * np.pi / SWING, rates, out=np.full(nz, np.inf), where=rates > 0)

    def problem(self) -> Problem:
        """The arrays and tolerances of a march."""
        bent, zone = self.bent, np.zeros((2, self.bodies.mechanism.size), np.int64)
        joint_law.zones_at_rest(self.bodies.law, self.equilibrium[0], zone)
        on_stops = np.zeros(zone.shape[1])
        on_stops[bent] = [joint_law.tangent(self.bodies.law, i, *zone[:, i])[0] for i in bent]
        structure = self.structure
        if self.support is not None and self.support.stretched is not None:
            structure = structure._replace(drag=self.support.stretched.drag)
        return new_problem(
            self.bodies,
            structure,
            self.memory,
            self.stiffness - np.diag(on_stops),
            beta=self.fit.beta if self.fit is not None else np.zeros(0),
            bent=bent,
            pace=self.pace,
            swing=self.swing,
            dt=self.dt,
            tolerance=self.newton_tolerance,
            iterations=ITERATIONS,
        )

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
            water, depth = np.ascontiguousarray(samples[:, at.water]), self.scene.water.depth
            flow, wet, push = stretching.stretched(self.support.stretched, self.waves, depth, water)
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
    load, wrench = balance(bodies, z)
    return shared(load), shared(wrench)


@lru_cache(maxsize=KNOWN)
def _at_rest(
    bodies: Same[Bodies], structure: Same[Structure], steady: Bits[np.ndarray], stride: float
) -> tuple[Resting, np.ndarray, np.ndarray]:
    """What stands for a scene at rest, and its equilibrium; scenes that differ in their seas alone have one object."""
    frame = structure.value
    still = bodies.value._replace(law=joint_law.at_rest(bodies.value.law))
    z, p = _equilibrium(Bits((still, frame.omega, frame.carrier, steady.value)), stride)
    return Bits((bodies.value, frame, z.copy())), z, p


@lru_cache(maxsize=KNOWN)
def _equilibrium(
    scene: Bits[tuple[Bodies, np.ndarray, np.ndarray, np.ndarray]], stride: float
) -> tuple[np.ndarray, np.ndarray]:
    """Of floats, frequencies, carriers and loads of the structure; scenes that differ in what damps them share it."""
    z, p = equilibrium(*scene.value, stride)
    return shared(z), shared(p)


def prepare(scene: Scene, hydrodynamics: Hydrodynamics | None, fit: radiation.RadiationMemory | None = None) -> System:
    """The scene as arrays, with another radiation memory if given; InputError for coefficients of another scene."""
    settings, water = scene.settings, scene.water
    dt = scene.usual_step if settings.time_step is None else settings.time_step
    if hydrodynamics is not None and scene.floats:
        _check_same(scene, hydrodynamics)
    waves = wave_field(scene.sea, water.depth, water.gravity, scene.current)
    support = None
    if scene.platform is not None:
        platform = scene.platform.undamped()
        if settings.method == "frequency" and platform.wave_stretching != "none":  # which is of second order
            platform = replace(platform, wave_stretching="none")
        reduced = supports.reduce_platform(
            platform,
            waves,
            water,
            tuple(scene.platform.hinge_nodes[f.name] for f in scene.floats),
            planar=scene.planar,
            modes=settings.modes,
            stations=settings.stations_per_element,
            outputs=settings.outputs,
            damping=scene.platform.damping,
        )
        support = supports.damped(reduced, scene.platform.damping)
    if fit is None and scene.floats and settings.radiation and settings.method == "time":
        hulls, ways = tuple(f.hull for f in scene.floats), motions.of_scene(scene)
        fit = remembered(hydrodynamics, hulls, settings.memory_tolerance or radiation.USUAL, ways)
    na = len(scene.floats) * len(hydrodynamics.dofs) if hydrodynamics else 0
    added_mass = np.zeros((na, na))
    if hydrodynamics is not None and settings.radiation:
        added_mass = fit.added_mass_inf if fit else hydrodynamics.added_mass_inf
    height = scene.sea.parameters()["Hm0"]
    reaches = _reaches(scene, height) if any(scene.nonlinear) else [0.0] * len(scene.floats)
    reach = max((r for r, nonlinear in zip(reaches, scene.nonlinear, strict=True) if nonlinear), default=0.0)
    near = waves.near(reach, settings.field_tolerance)
    if near != waves:
        _require_hardly_felt(scene, hydrodynamics, waves, near, reach)
    terms = assembly.terms_of(scene, near, reaches)
    felt = near if any(scene.nonlinear) else None
    still = scene.water, scene.current, scene.sea.heading, scene.floats, scene.platform, scene.settings
    body = _bodies(*still, felt, support, hydrodynamics, Bits(added_mass), terms)
    rows, layout = assembly.wave_rows(scene, waves, near, support, hydrodynamics, terms)
    return System(
        scene=scene,
        bodies=body,
        support=support,
        structure=assembly.structure(support),
        fit=fit,
        memory=assembly.memory(fit, dt, na),
        rows=rows,
        layout=layout,
        waves=waves,
        near=near,
        dt=dt,
    )


@lru_cache(maxsize=KNOWN)
def _bodies(
    water: Water,
    current: Current | None,
    heading: float,
    floats: tuple[Float, ...],
    platform: Platform | None,
    settings: Settings,
    field: WaveField | None,
    support: Support | None,
    hydrodynamics: Hydrodynamics | None,
    added_mass: Bits[np.ndarray],
    terms: tuple[int, ...],
) -> Bodies:
    """Scenes that differ in their seas alone share them, unless they are pushed where they are."""
    sea = replace(CALM, heading=heading) if field is None else field.sea
    scene = Scene(water=water, sea=sea, current=current, floats=floats, platform=platform, settings=settings)
    field = wave_field(sea, water.depth, water.gravity, current) if field is None else field
    return assembly.bodies(scene, field, support, hydrodynamics, added_mass.value, terms)


def _require_hardly_felt(
    scene: Scene, h: Hydrodynamics | None, waves: WaveField, near: WaveField, reach: float
) -> None:
    """Refuse waves that no series around the floats carries, unless they push them little: see FELT."""
    felt = 1.0
    if h is not None:
        nb, lengths = len(scene.floats), motion_lengths(tuple(f.hull for f in scene.floats), h.dofs)
        short = waves.sea.omega[near.sea.amplitude != waves.sea.amplitude]
        pushed, most = (
            (np.abs(h.excitation(omega)) / lengths).reshape(omega.size, nb, -1).max(axis=(0, 2))
            for omega in (short, h.omega)
        )
        felt = float(np.max((pushed / most)[np.array(scene.nonlinear)]))
    if not felt <= FELT:
        said = f"too short for a series {reach:.3g} m around a float that feels them by {felt:.0%} of the largest wave"
        raise InputError("sea", waves.shortest, f"{said} force per amplitude, > {FELT:.0%}: end the band lower")


def _check_same(scene: Scene, h: Hydrodynamics) -> None:
    """Refuse coefficients of other floats, other water or other waves than the scene's."""
    water, places = scene.water, np.array([f.centre for f in scene.floats])
    pairs = {
        "floats": (len(places), len(h.centres)),
        "water.depth": (water.depth, h.depth),
        "water.density": (water.density, h.density),
        "water.gravity": (water.gravity, h.gravity),
        "settings.gap_damping": (scene.settings.gap_damping, h.settings.get("gap_damping", 0.0)),
        "settings.gap_width": (scene.settings.gap_width, h.settings.get("gap_width", 0.0)),
    }
    for key, (value, limit) in pairs.items():
        if value != limit:
            raise InputError(key, value, f"must be {limit:g}, that of the coefficients")
    if not np.abs(places - h.centres).max(initial=0.0) <= 1e-6:
        raise InputError("floats", places.tolist(), f"must be where the coefficients' floats are, {h.centres.tolist()}")
    if len(places) > 1 and scene.settings.interaction != h.interacting:
        said = f"must be {str(h.interacting).lower()}, as of the coefficients"
        raise InputError("settings.interaction", scene.settings.interaction, said)
    waves = scene.sea.amplitude.any() and (scene.settings.diffraction or scene.settings.froude_krylov == "linear")
    if waves and abs(np.exp(1j * scene.sea.heading) - np.exp(1j * h.heading)) > 1e-6:
        raise InputError("sea.heading", scene.sea.heading, f"must be {h.heading:g} rad, that of the coefficients")
    if not scene.planar and len(h.dofs) < len(DOFS):
        raise InputError("coefficients", " ".join(h.dofs), f"must have {', '.join(DOFS)}: the scene is not planar")


@lru_cache(maxsize=8)
def remembered(
    h: Hydrodynamics,
    hulls: tuple[Hull, ...],
    tolerance: float,
    ways: tuple[tuple[str, ...], ...],
    importance: Bits[np.ndarray] | None = None,
) -> radiation.RadiationMemory:
    """The memory of a set of coefficients, of bodies with these motions: tasks that differ in sea, damping or support
    share its fit.
    """
    moved = h.moved(ways)
    usual = importance is None and h.memory_tolerance == tolerance
    if h.memory is not None and usual and np.all(h.moved(h.memory_motions) == moved):
        return h.memory
    lengths = motion_lengths(hulls, h.dofs)
    asked = None if importance is None else importance.value
    known = h.omega, h.added_mass, h.radiation_damping, h.added_mass_inf
    return radiation.fit(*known, tolerance, lengths, h.body, moved, asked, h.resolved)


def _reaches(scene: Scene, height: float) -> list[float]:
    """How far from rest each hull's wetted surface gets [m]: at ±0.8 rad of its arm and ±0.2 rad of what carries it."""
    reaches, flat = limits.radii(scene), motions.in_plane(scene)
    for b, item in enumerate(scene.floats):
        seen, carrier, hinge = limits.sight(flat[b]), scene.carriers[b], np.array(item.hinge, float)
        reaches[b] += _way(item, seen * (item.centre - hinge), 0.8, height)
        while carrier >= 0:
            by, point = scene.floats[carrier], hinge
            hinge, carrier = np.array(by.hinge, float), scene.carriers[carrier]
            reaches[b] += _way(by, seen * (point - hinge), 0.2, height)
    return reaches


def _way(item: Float, lever: np.ndarray, angle: float, height: float) -> float:
    """How far the end of a lever gets: turned by an angle, or sliding from where it is let go, or where a preload
    brings it that nothing but springs holds, by twice the wave height [m].
    """
    turned = 2 * np.sin(angle / 2) * float(np.linalg.norm(lever))
    springs, pushed = item.per_axis("stiffness") + item.per_axis("pto_stiffness"), np.abs(item.per_axis("preload"))
    held = (springs > 0) & np.array([name in DOFS[:2] for name in item.motion], bool)
    start = np.maximum(np.abs(item.per_axis("offset")), np.divide(pushed, springs, out=0 * pushed, where=held))
    ways = zip(item.motion, start.tolist(), strict=True)
    return max((x + 2 * height if slides(name) else turned for name, x in ways), default=0.0)


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
    """At t = 0, from all loads at rest: accelerations of modes and joints, the modal load of the hinges, and (nz,)
    what holds the axes that do not move."""
    frame, body = system.structure, system.bodies
    nc, nm = frame.carrier.shape
    r, _ = balance(body, z, field=first.field[0], excitation=first.excitation[0])
    shape, whole = frame.carrier, _whole_mass(system, z)
    load = np.concatenate([shape.T @ r[:nc] - frame.omega**2 * p + first.modal[0], r[nc:]])
    if system.scene.current is not None:  # else waves grow from nothing
        load[:nm] += system.drag_at_rest(first.station[0])
    if first.push.size:
        load[:nm] += np.tensordot(frame.station, first.push[0], axes=2)
    at_rest = np.flatnonzero(joint_law.holds(body.law))
    rows, free, known = nm + at_rest - nc, whole.copy(), load.copy()
    free[rows], known[rows] = np.eye(len(whole))[rows], 0.0
    acceleration = np.linalg.solve(free, known)
    held = np.zeros(z.size)
    held[at_rest] = (load - whole @ acceleration)[rows]
    ddp, ddz = acceleration[:nm], acceleration[nm:]
    return ddp, ddz, ddp + frame.omega**2 * p - first.modal[0], held


def blocks(system: System, state: State, steps: int, done: int = 0) -> Iterator[tuple[np.ndarray, Output, np.ndarray]]:
    """March from step `done` to step `steps`, yielding (wave samples, output, times) block by block.

    `state` is that after `done` steps, and all that a run needs to go on: to the last bit where `done` is a
    multiple of BLOCK_STEPS, elsewhere to Newton's tolerance.
    """
    h, series = system.dt / 2, system.series(system.dt)
    problem, empty = system.problem(), system.drive(np.zeros((1, len(system.rows))))
    room = new_workspace(system.bodies, system.structure)
    fine = new_fine(problem, empty) if problem.bent.size else None
    # Up to the longest wave's period after the start little has been exchanged, and that with a jolt.
    quiet = int(2 * np.pi / system.scene.sea.omega.min() / system.dt)
    for first in range(done, steps, BLOCK_STEPS):
        count = min(BLOCK_STEPS, steps - first)
        samples = series.block(2 * first, 2 * count + 1)
        output = new_output(problem, 2 * count)
        outcome, sample, _ = march(problem, system.drive(samples), state, room, fine, quiet - first, output)
        if outcome != OK:
            raise _failure(outcome, (2 * first + sample) * h, system, state)
        yield samples[1:], output, (2 * first + 1 + np.arange(2 * count)) * h


def _failure(outcome: int, t: float, system: System, state: State) -> SimulationFailed:
    when = f"at t = {t:.1f} s"
    if outcome == EXCURSION:
        told = limits.explain(system.scene, state.z, system.bodies.limit, when)
        return SimulationFailed(told + _stability(system, state.z))
    if outcome == UNBALANCED:
        stored = energy(system.bodies, system.structure, state)
        return unbalanced(energy_residual(state.work, stored, state.energy, state.energy[GAP]), GROSSLY, t, system)
    troubles = {
        NOT_CONVERGED: f"no convergence in {ITERATIONS} iterations",
        TO_AND_FRO: f"a joint's law changes over {CHANGES} times in a step",
    }
    return StepTooLong(f"{troubles.get(outcome, 'not finite')} {when}: reduce time_step = {system.dt:g} s")


def _stability(system: System, joints: np.ndarray) -> str:
    """How far from rest a hinge that is beyond its bounds rights itself, for the message that says so."""
    bodies, first = system.bodies, system.bodies.mechanism.size - joints.size
    low, high = bodies.limit[first:].T
    beyond = np.flatnonzero((joints <= low) | (joints >= high))
    names = [axis for f in system.scene.floats for axis in f.motion]
    if not beyond.size or slides(names[beyond[0]]):
        return ""
    i = first + int(beyond[0])
    back, forth = righting(bodies, system.equilibrium[0], i, limits.FALLEN_OVER)
    return f"; in still water it rights itself between {back:+.2f} and {forth:+.2f} rad"


def energy_residual(work: np.ndarray, stored: float, exchanged: np.ndarray, allowed: float = 0.0) -> float:
    """Gap of the energy balance, but for `allowed` [J], over the largest exchanged so far; see energy.open_by."""
    gap = open_by(work, stored, exchanged) - allowed
    return float(abs(gap) / exchanged[SCALE]) if gap else 0.0


def unbalanced(gap: float, limit: float, t: float, system: System) -> StepTooLong:
    """The error of a run whose energy balance is open by too large a share of the energy exchanged."""
    return StepTooLong(
        f"energy balance at t = {t:.1f} s open by {gap:.1e} of the energy exchanged, > {limit:g}: reduce time_step ="
        f" {system.dt:g} s and newton_tolerance = {system.scene.settings.newton_tolerance:g}"
    )
