"""A scene by the paper's method: the slow, independent twin of `simulate`, and its record.

Augmented floats, every coupling iterated to convergence; with `accuracy = "reference"` panel-wise pressure, direct
convolution and all modes, too. It shares with `simulate` the scene, the BEM's coefficients, the structure's modes, the
joints' laws and where it starts, and nothing of the floats' mechanics or the time loop; with that accuracy nothing of
the memory or the pressure integral.
"""

import time
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from scipy.spatial.transform import Rotation

from solver import limits
from solver.coupled.assembly import joint_law
from solver.coupled.blocks import energy_residual, unbalanced
from solver.coupled.driving import driven
from solver.coupled.energy import FRAME_DRAG, FRAME_INERTIA, STRUCTURAL, WORKS
from solver.coupled.moving import along_waves
from solver.coupled.natural import require_stable, require_upright, system_modes, with_usual_step
from solver.coupled.problem import BEYOND, CONTACT, LOAD, Output, whole_output
from solver.coupled.sliding import leaders
from solver.coupled.system import BALANCE, System
from solver.errors import SimulationFailed
from solver.hydrodynamics.bem.coefficients import Hydrodynamics, cautions, coarser, coefficient_errors
from solver.multibody.of_axes import bent, joint_energy, stop_loads
from solver.oddities import warnings
from solver.record.audit import doubts, unmet
from solver.record.bound import above
from solver.record.channels import Record
from solver.record.decay import Transfer, died
from solver.record.effects import coefficient_effects, shapes_effect, together
from solver.record.elements import elements_effect
from solver.record.probe import PROBE, add_halved, against_half, ends_error, probed
from solver.record.recorder import Recorder
from solver.record.refit import prepared
from solver.record.starting import drifting, from_rest
from solver.record.turning import turning
from solver.reference import axes as joint_axes
from solver.reference.augmented import (
    NO_SUPPORTS,
    Body,
    Mechanism,
    MechanismState,
    inertia_and_bias,
    lobatto,
    mechanism,
)
from solver.reference.convolution import CosineTransform, Kernel
from solver.reference.elastic import ElasticSupport, FixedSupport
from solver.reference.joints import AxesJoint, Frames, Hinge
from solver.reference.loads import Floats, PressureForce, Surface, held
from solver.reference.twoloop import Sample, integrate
from solver.remarks import of_motions
from solver.scene import Float, Scene
from solver.sea.realization import ramp

STAGES = 3  # of Lobatto's collocation
CONSTRAINTS = 1e-10  # tolerance of position, velocity and acceleration [m, m/s, m/s2]
STILL = 1e-7  # [m or rad] the last change that ends a step's iterations, where the settings do not ask for less
BLOCK = 256  # steps whose samples are kept before the record takes them in


@dataclass(frozen=True, eq=False, kw_only=True)
class Case:
    """A scene at t = 0 by the chosen paths."""

    scene: Scene
    system: System  # the fast path's: wave rows, modes and what the audit needs
    mechanism: Mechanism
    state: MechanismState
    floats: Floats
    support: FixedSupport | ElasticSupport
    steps: int


def simulate_reference(
    scene: Scene,
    hydrodynamics: Hydrodynamics | None = None,
    *,
    kernel: Kernel | None = None,
    surface: Surface | None = None,
    panels: tuple[int, int] = (71, 120),
    stages: int = STAGES,
    tolerance: float = CONSTRAINTS,
    progress: Callable[[float], None] = lambda _share: None,
) -> Record:
    """The record of `scene` by the augmented formulation; defaults follow `scene.settings`.

    kernel: retardation function, by default eq. 14's of the BEM's damping, or the fitted one where the
    settings keep the state space. surface: how pressure is integrated. panels: along the meridian and around.
    stages: 3 for the fourth-order collocation, 2 for the trapezoidal rule. tolerance: of the constraints.
    progress: told the share of the record that is done, some hundred steps apart.
    """
    clock = time.perf_counter()
    options: dict[str, Any] = {"kernel": kernel, "surface": surface, "panels": panels, "stages": stages}
    case = _case(scene, hydrodynamics, **options)
    require_stable(case.system)
    require_upright(case.system)
    ready = time.perf_counter()
    recorder = Recorder(scene, case.system.support, layout=case.system.layout)
    start, probe = (
        Recorder(probed(case.scene, steps), case.system.support, layout=case.system.layout)
        for steps in (_start_steps(case), _probe_steps(case))
    )
    samples = _march(case, tolerance)
    first = next(samples)
    before, errors = _stored(case, first.frames), np.array(first.errors)
    for times, output, waves, gaps, end in _blocks(case, samples):
        frames = end
        recorder.add(times, output, waves)
        start.add(times, output, waves)
        probe.add(times, output, waves)
        errors = np.maximum(errors, gaps)
        progress(times[-1] / (case.steps * case.system.dt))
    work, stored = _works(case), _stored(case, frames)
    change = float(stored - before)
    residual = energy_residual(work, stored, np.array([before, case.system.least_energy(case.steps)]))
    if not residual <= BALANCE:
        raise unbalanced(residual, BALANCE, times[-1], case.system)
    marched = time.perf_counter()
    audited = _errors(case, hydrodynamics, start, probe, options, tolerance)
    attrs = {
        "energy_residual": residual,
        **{f"work_{name}": float(value) for name, value in zip(WORKS, work, strict=True)},
        "stored_energy_change": change,
        "constraint_drift": float(errors[0]),
        "constraint_drift_velocity": float(errors[1]),
        "constraint_drift_acceleration": float(errors[2]),
        **audited,
        **coefficient_errors(hydrodynamics),
        "unmet": "; ".join(unmet(case.scene, case.system.fit, audited, hydrodynamics)),
        "skipped": "; ".join(coarser(hydrodynamics)),
        **_told(case.scene),
        "buckling_factor": case.system.support.buckling_factor if case.system.support else np.inf,
        "prepare_time": ready - clock,
        "march_time": marched - ready,
        **scene.sea.parameters(),
    }
    told = warnings(scene, case.system.joints_at_rest)
    tables, channels = recorder.tables(), recorder.channels
    late, doubted = died(channels, tables), doubts(case.scene.settings, audited)
    if odd := (
        *told,
        *of_motions(scene, channels.axes, tables, case.system.joints_at_rest),
        *turning(case.system, channels, tables),
        *late,
        *recorder.settling.notes(channels),
        *drifting(case.system, hydrodynamics, recorder.settling, channels, tables),
        *from_rest(case.system, hydrodynamics),
        *above(scene, tables, audited["estimated_error"], change),
        *cautions(hydrodynamics),
        *doubted,
    ):
        attrs["warnings"] = "; ".join(odd)
    attrs["wall_time"] = time.perf_counter() - clock
    return recorder.record(tables, attrs, system_modes(case.system, hydrodynamics))


def _told(scene: Scene) -> dict[str, float | str]:
    s = scene.settings
    names = ("accuracy", "formulation", "memory", "surface", "modes", "time_step", "stations_per_element")
    return {name: getattr(s.paths, name) for name in names}


def _case(
    scene: Scene,
    h: Hydrodynamics | None,
    *,
    kernel: Kernel | None,
    surface: Surface | None,
    panels: tuple[int, int],
    stages: int,
) -> Case:
    system = prepared(replace(scene, settings=scene.settings.paths), h)
    system = with_usual_step(system, system_modes(system, h))
    scene, dt, h = system.scene, system.dt, h if scene.floats else None
    s = scene.settings
    if not s.radiation or h is None:
        kernel = None
    elif kernel is None:
        kernel = CosineTransform.of(h) if s.memory == "convolution" else system.fit
    steps = int(np.ceil((s.discard + s.duration) / dt - 1e-9))
    _, A = lobatto(stages)
    support: FixedSupport | ElasticSupport = FixedSupport()
    if scene.platform is not None and system.support is not None:
        nodes = np.array([f.hinge for f in scene.floats], float).reshape(-1, 3)
        rows = driven(system.support, system.waves)
        support = ElasticSupport(system.support, rows, nodes, A.sum(axis=1), A, dt)
    force = PressureForce(scene, system.waves, surface or s.surface, panels, h, system.bodies.about)
    found = max(leaders(scene, system.waves), default=-1)
    swing = along_waves(system, h) if h is not None and found >= 0 else None
    floats = Floats(scene, h, kernel, force, support, dt=dt, A=A, steps=steps, swing=swing)
    bodies, state = _at_rest(scene, system, floats, support, kernel)
    return Case(
        scene=scene, system=system, mechanism=bodies, state=state, floats=floats, support=support, steps=steps
    )  # fmt: skip


def _at_rest(
    scene: Scene, system: System, floats: Floats, support: FixedSupport | ElasticSupport, kernel: Kernel | None
) -> tuple[Mechanism, MechanismState]:
    """Mechanism and state where the fast path lets go: equilibrium in still water plus offsets, modes at rest."""
    start, nb = system.start(), len(scene.floats)
    ends = np.cumsum([len(a.turns) for a in floats.axes])
    for stage in floats.way:
        stage[:] = np.split(start.z, ends[:-1]) if nb else []
    supports = NO_SUPPORTS
    if isinstance(support, ElasticSupport):
        support.start(start.p, start.ddp)
        supports = support.frames(0)
    drawn: list[Body] = []
    bodies: list[Body] = []
    joints, still = [], np.zeros(6)
    for b, (item, carrier) in enumerate(zip(scene.floats, scene.carriers, strict=True)):
        way = floats.way[0][b]
        for poses, y in ((bodies, way), (drawn, 0 * way)):
            node = joint_axes.Node(np.array(item.hinge, float), np.eye(3), still, still)
            if scene.platform is not None:
                node = joint_axes.Node(*(x[b] for x in supports))
            elif carrier >= 0:
                arm, pose = item.hinge - scene.floats[carrier].centre, poses[carrier]
                turned = Rotation.from_quat(pose.rotation, scalar_first=True).as_matrix()
                node = joint_axes.on_body(arm, np.array(pose.position), turned, still, still)
            poses.append(_body(item, *joint_axes.body_at(floats.axes[b], node, y, 0 * way)[:2]))
        # Its node, the last, is where the floats are drawn.
        joints.append(_joint(item, carrier if carrier >= 0 else support.frame_number(b), b, node))
    A = None  # of what turns it is part of the mechanisms' inertia
    if kernel is not None and not floats.turning:
        A = floats.along @ kernel.added_mass_inf @ floats.along.T
    world: dict[str, Any] = {"gravity": (0, 0, -scene.water.gravity), "added_mass": A}
    # The joints are closed where the floats are drawn; from there they let the axes move.
    return mechanism(drawn, joints, supports, **world)[0], mechanism(bodies, joints, supports, **world)[1]


def _body(item: Float, position: np.ndarray, rotation: np.ndarray) -> Body:
    turned = tuple(Rotation.from_matrix(rotation).as_quat(scalar_first=True))
    return Body(
        mass=item.mass,
        inertia=item.inertia,
        products_of_inertia=item.products_of_inertia,
        cog=item.cog,
        position=tuple(position),
        rotation=turned,
    )


def _joint(item: Float, first: int, second: int, node: joint_axes.Node) -> Hinge | AxesJoint:
    """The paper's hinge, or what keeps the axes of another joint."""
    slides, turns, inner = held(item)
    to_space = [tuple(tuple(node.rotation @ d) for d in axes) for axes in (slides, turns)]
    point = tuple(node.position)
    if not slides and len(turns) == 1:
        return Hinge(first=first, second=second, point=point, axis=to_space[1][0])
    return AxesJoint(first=first, second=second, point=point, slides=to_space[0], turns=to_space[1], inner=inner)


def _march(case: Case, tolerance: float) -> Iterator[Sample]:
    """The start's sample, then two of every step."""
    dt, stages = case.system.dt, len(case.floats.weight)
    still = min(STILL, case.scene.settings.newton_tolerance)
    options: dict[str, Any] = {"dt": dt, "stages": stages, "tolerance": tolerance, "still": still}
    return integrate(case.mechanism, case.state, case.floats, t_end=case.steps * dt, **options)


def _blocks(
    case: Case, samples: Iterable[Sample]
) -> Iterator[tuple[np.ndarray, Output, np.ndarray, np.ndarray, Frames]]:
    """(times, samples as the fast march puts them out, wave rows' samples, constraint errors, frames at the end)."""
    rows, stages = [], len(case.floats.weight)
    pressed: np.ndarray | None = None
    for n, sample in enumerate(samples, 1):
        rows.append(_row(case, (n - 1) % (stages - 1) + 1, sample))
        if len(rows) == BLOCK * (stages - 1) or n == case.steps * (stages - 1):
            times, errors, *parts = (np.array(x) for x in zip(*rows, strict=True))
            contact = _contact(case, *parts[:2], pressed=pressed)
            pressed = contact[-1:, :, LOAD] > 0
            struck = np.repeat(parts[3][:, None], contact.shape[1], axis=1)
            yield times, whole_output(parts, contact, struck), _waves(case, times), errors.max(axis=0), sample.frames
            rows = []


def _row(case: Case, stage: int, sample: Sample) -> tuple[Any, ...]:
    """Time, errors of the constraints, and the parts of an Output."""
    floats, none = case.floats, np.zeros(0)
    z, dz = (np.concatenate([none, *values[stage]]) for values in (floats.way, floats.rate))
    if limits.beyond(case.scene, z, case.system.bodies.limit) or limits.overturned(case.scene, z):
        when = f"at t = {sample.time:.1f} s"
        raise SimulationFailed(limits.explain(case.scene, z, case.system.bodies.limit, when))
    p, *loads = case.support.sample(stage)
    return sample.time, sample.errors, z, dz, p, -floats.force[stage], *loads


def _contact(case: Case, z: np.ndarray, dz: np.ndarray, *, pressed: np.ndarray | None) -> np.ndarray:
    """As an Output's, of the stops alone, as the samples have it: a hit is where a load begins.

    pressed (1, n): which stops bear one in the sample before; None at the start.
    """
    law = joint_law(case.scene.floats)
    some = bent(law)
    load = stop_loads(law, z, dz)[:, some]
    begins = np.diff(load > 0, axis=0, prepend=load[:1] > 0 if pressed is None else pressed) & (load > 0)
    contact = np.zeros((*load.shape, BEYOND + 1))
    contact[..., : len(CONTACT)] = np.stack([begins, begins * np.abs(dz[:, some]), load], axis=-1)
    return contact


def _waves(case: Case, times: np.ndarray) -> np.ndarray:
    """Samples (m, columns) of the wave rows that the record reads."""
    s, layout = case.scene.settings, case.system.layout
    turn = np.exp(-1j * np.multiply.outer(times, case.scene.sea.omega)) * ramp(times, s.ramp, s.ramp_form)[:, None]
    out = np.zeros((len(times), len(case.system.rows)))
    for at in (layout.elevation, layout.forces):
        out[:, at] = (turn @ case.system.rows[at].T).real
    return out


def _works(case: Case) -> np.ndarray:
    """Works (len(WORKS),) in the order of WORKS [J]."""
    work = case.floats.work.copy()
    work[[FRAME_INERTIA, STRUCTURAL, FRAME_DRAG]] = case.support.work
    return work


def _stored(case: Case, frames: Frames) -> float:
    """Kinetic energy (added mass included), of gravity, springs and modes [J], where a step has just ended."""
    floats, body, nb = case.floats, case.mechanism, len(case.scene.floats)
    if not nb:
        return case.support.energy
    M, Q = np.empty((6 * nb, 6 * nb)), np.empty(6 * nb)
    inertia_and_bias(body, frames, M, Q)
    if floats.turning:
        M += floats.added_mass(frames)
    v = frames.velocity[:nb].ravel()
    total = case.support.energy + v @ M @ v / 2
    for b, (law, inertia) in enumerate(zip(floats.law, floats.inertia, strict=True)):
        height = frames.position[b, 2] + frames.rotation[b, 2] @ body.cog[b]
        total -= body.mass[b] * body.gravity[2] * height
        total += joint_energy(law, floats.way[0][b]) + inertia @ floats.rate[0][b] ** 2 / 2
    return float(total)


def _start_steps(case: Case) -> int:
    """Steps whose samples tell of the record's ends: PROBE usual ones, or all."""
    return max(1, int(min(PROBE * case.scene.usual_step / case.system.dt, case.steps)))


def _probe_steps(case: Case) -> int:
    """Steps that are repeated with half their length: those, or a quarter of all."""
    return max(1, min(_start_steps(case), case.steps // 4))


def _by_damping(system: System, h: Hydrodynamics | None) -> Transfer | None:
    """Y of eq. 14's kernel about the system's added mass, where that is the memory."""
    s = system.scene.settings
    if h is None or not s.radiation or s.memory != "convolution":
        return None
    kernel, apart = CosineTransform.of(h), h.added_mass_inf - system.bodies.added_mass
    return lambda w: kernel.frequency(w) - 1j * np.multiply.outer(w, apart)


def _errors(
    case: Case, h: Hydrodynamics | None, start: Recorder, probe: Recorder, options: dict[str, Any], tolerance: float
) -> dict[str, float]:
    """Estimated errors of the step, by a run with half of it, of samples, by that and the run's own start, and of the
    BEM."""
    order = 2 * options["stages"] - 2
    short = replace(probed(case.scene, _probe_steps(case)).settings, time_step=case.system.dt / 2)
    half = _case(replace(case.scene, settings=short), h, **options)
    finer = Recorder(probe.scene, half.system.support, layout=half.system.layout)
    samples = _march(half, tolerance)
    next(samples)  # the start's, which no record takes in
    for times, output, waves, *_ in _blocks(half, samples):
        add_halved(finer, case.system, times, output, waves)
    step, between = against_half(case.system, probe, probe.samples(), finer)
    ends = ends_error(case.system, start.scene, start.samples())
    memory, mesh = coefficient_effects(case.system, h, _by_damping(case.system, h))
    parts = {
        "discretization_error": step / (1 - 0.5**order),
        "sampling_error": together((between, ends)),
        "memory_effect": memory,
        "mesh_effect": mesh,
        "shapes_effect": shapes_effect(case.system, h),
        "elements_effect": elements_effect(case.scene, h, case.system.support, case.system),
    }
    return {**parts, "estimated_error": together(parts.values())}
