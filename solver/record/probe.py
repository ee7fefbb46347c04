"""What a run is judged by, from its start: the same again with half the step, or with finer parts."""

import time
from collections.abc import Callable, Iterator, Mapping
from dataclasses import replace
from functools import partial
from typing import Any

import numpy as np

from solver.coupled import assembly
from solver.coupled.blocks import blocks
from solver.coupled.histories import missed
from solver.coupled.linear import linear_model
from solver.coupled.preparation import prepare
from solver.coupled.problem import HITS, UNCUT, Output
from solver.coupled.stages import State, copied
from solver.coupled.system import System
from solver.errors import StepTooLong
from solver.hydrodynamics.bem.coefficients import Hydrodynamics
from solver.multibody.bodies import Bodies, new_motion, pressure_room
from solver.multibody.minimal import move, pressures
from solver.multibody.of_axes import taking
from solver.power_takeoff import PtoTable
from solver.record.beside import bounced
from solver.record.channels import Channels
from solver.record.effects import coefficient_effects, memory_effect, shapes_effect, step_effect, together
from solver.record.elements import elements_effect
from solver.record.recorder import Recorder
from solver.record.sampling import (
    LAST,
    at_ends,
    between_samples,
    expected_error,
    from_start,
    least_force,
    of_every_other,
)
from solver.scene import Scene
from solver.statistics import FAINT, STATISTICS, apart, moments

PROBE = 600  # usual steps of a scene: length of the run with half the step
STATES = 48  # at which the pressure's quadrature is compared with a finer one
NEXT = 1e-6  # of the time between samples, that a time counts as the next one's
NEARLY = 1e-3  # of a record, that is no whole number of periods or samples
RESTS = 1e-9  # of g: what is pushed by less
FAR = 2e-5  # of what stations may leave out unseen
UNTOLD = 1.0  # an error that no run tells
MOTIONS = ("rotation", "motion", "top_displacement", "node_displacement")
POWERS = "absorbed_power", "electrical_power"


def probed(scene: Scene, steps: int) -> Scene:
    """A scene whose record is of so many steps from the start, as samples.

    Without the outputs asked for: their sums and stresses follow what is judged, and single forces that are small
    beside others of their kind would ask for a step of their own.
    """
    s = scene.settings
    assert s.time_step is not None, "asked of a scene that runs, with its step"
    changes: dict[str, Any] = {"discard": 0.0, "duration": steps * s.time_step, "outputs": ()}
    return replace(scene, settings=replace(s, **changes, rao=False, spectra=False, keep_series=True))


class Probe:
    """Keeps what PROBE usual steps of a run are judged by: their samples, and some states.

    They are the run's first ones; and where a float meets a stop or a step is cut only later, or a load history bends
    most, as many again from then on. With a tolerance it is all the rest once stops were met in these and are again: a
    float that hangs for seconds where it would tip over may err more by that than by all else, and no part tells when.
    """

    def __init__(
        self, system: System, first: int = 0, state: State | None = None, *, rest: bool = False, seconds: float = 0.0
    ):
        """From step `first` on, before which the run was in that state; rest: to the run's end; seconds: that judging
        has taken so far."""
        s = system.scene.settings
        left = s.discard + s.duration - first * system.dt
        self.system, self.first, self.state, self.rest = system, first, state, rest
        self.steps = max(1, int((left if rest else min(PROBE * system.scene.usual_step, left)) / system.dt))
        short = probed(system.scene, self.steps)
        self.recorder = _judging(short, system)
        self.states: list[tuple[np.ndarray, np.ndarray]] = []
        self.full = self.cut = False  # whether any step is
        self.seconds = seconds
        self._errors: dict[str, float] = {}
        self._before: dict[str, float] = {}

    def add(self, times: np.ndarray, output: Output, samples: np.ndarray) -> None:
        """Take in a block, of those that the steps reach into."""
        if self.full:
            return
        times = times - self.first * self.system.dt
        self.recorder.add(times, output, samples)
        pressure, every = samples[:, self.system.layout.field], max(1, 2 * self.steps // STATES)
        inside = int(np.sum(times < self.steps * self.system.dt))
        taken = range(0, inside, every)
        self.cut |= bool(np.any(output.lead[:inside] != UNCUT))
        if not self.rest:  # whose step alone is judged
            self.states += [(output.z[i].copy(), pressure[i].copy()) for i in taken]
        self.full = bool(times[-1] >= self.steps * self.system.dt * (1 - 1e-9))

    def unaware(self, output: Output) -> bool:
        """Whether the floats meet a stop in a block, or a step is cut, and none was in what has been judged; or where a
        tolerance is asked for, a stop once more."""
        hits = output.contact[..., HITS].any() and (self._all_else or not self.recorder.contact[:, HITS].any())
        cut = np.any(output.lead != UNCUT) and not self.cut
        return bool(self._errors) and bool(hits or cut)

    @property
    def _all_else(self) -> bool:
        """Whether hits that follow ask for judging the rest of the run."""
        return self.system.scene.settings.tolerance is not None and bool(self.recorder.contact[:, HITS].any())

    def before(self, bend: float, times: np.ndarray) -> bool:
        """Whether a load history bends most at a time in a block, and what has been judged was before."""
        return bool(self._errors) and times[0] - self.system.dt / 2 < bend <= times[-1]

    def again(self, first: int, state: State) -> "Probe":
        """Another from there on, whose errors are the larger of both."""
        later = Probe(self.system, first, state, rest=self._all_else, seconds=self.seconds)
        later._before = self._errors
        return later

    @property
    def fresh(self) -> bool:
        """Whether the probe is full and its errors are not known yet."""
        return self.full and not self._errors

    def errors(self, hydrodynamics: Hydrodynamics | None) -> dict[str, float]:
        """Relative errors of any mean, rms or std by their causes, and `estimated_error`."""
        if not self._errors:
            clock = time.perf_counter()
            parts = step_errors(self, hydrodynamics)
            if self.states:
                parts["quadrature_error"] = quadrature_error(self.system, self)
            if self._before:
                parts = {name: max(error, parts.get(name, 0.0)) for name, error in self._before.items()}
                del parts["estimated_error"]
            else:
                memory, mesh_effect = coefficient_effects(self.system, hydrodynamics)
                parts |= {
                    "memory_effect": max(memory, self._of_bounces(self.recorder, hydrodynamics)),
                    "mesh_effect": mesh_effect,
                    "shapes_effect": shapes_effect(self.system, hydrodynamics),
                    "elements_effect": elements_effect(
                        self.system.scene, hydrodynamics, self.system.support, self.system
                    ),
                    "stations_effect": stations_effect(self, hydrodynamics),
                    "law_effect": law_effect(self, hydrodynamics),
                }
            self._errors = {**parts, "estimated_error": together(parts.values())}
            self.seconds += time.perf_counter() - clock
        return self._errors

    def know(self, shares: np.ndarray | float, recorder: Recorder, hydrodynamics: Hydrodynamics | None) -> None:
        """Take in what shares of the record swing beside the waves, when it is over: before, `memory_effect` is as if
        all did; and how often stops are met."""
        if hydrodynamics is not None and (np.any(np.asarray(shares) < 1) or recorder.contact[:, HITS].any()):
            effect = memory_effect(self.system, hydrodynamics, shares)
            bounces = self._of_bounces(recorder, hydrodynamics)
            parts = {**self.errors(hydrodynamics), "memory_effect": max(effect, bounces)}
            del parts["estimated_error"]
            self._errors = {**parts, "estimated_error": together(parts.values())}

    def notes(self, recorder: Recorder) -> Iterator[str]:
        """A sentence where stops are met after what has been judged, and no tolerance asks for judging that."""
        hits, judged = (int(each.contact[:, HITS].sum()) for each in (recorder, self.recorder))
        if hits > judged and not self.rest and self.system.scene.settings.tolerance is None:
            yield (
                f"end stops are met {hits} times, and the step is judged by the first of them alone: where floats are"
                " hardly damped or hang about between hits, as where they would tip over, discretization_error may be"
                " many times as much;"
                " with a tolerance all of them are judged"
            )

    def _of_bounces(self, recorder: Recorder, h: Hydrodynamics | None) -> float:
        system, hits = self.system, recorder.contact[:, HITS]
        if h is None or system.fit is None or not hits.any():
            return 0.0
        period = system.scene.sea.parameters()["Te"]  # a bounce is felt about as long
        share = np.nan_to_num(hits * period / recorder.scene.settings.duration, nan=1.0).clip(max=1.0)
        return bounced(system, h, system.fit.frequency, share)


def _judging(scene: Scene, system: System) -> Recorder:
    """Takes in blocks of the system's for a `probed` scene."""
    return Recorder(scene, system.support, layout=system.layout, bodies=system.bodies, judged=True)


def sharpest_bend(scene: Scene) -> float:
    """Time [s] of a run at which the slope of a load history changes most; infinite without one that has a bend."""
    histories = scene.platform.load_histories if scene.platform else ()
    end = scene.settings.discard + scene.settings.duration
    return max((history.bend(end) for history in histories), default=(0.0, np.inf))[1]


def step_errors(probe: Probe, h: Hydrodynamics | None) -> dict[str, float]:
    """Of every mean, rms and std of the record, from what is judged of it and a run of that with half the step.

    `discretization_error`: the scheme is of fourth order, so that run differs by 15/16 of the error; or what the steps
    miss of load histories or do to what is damped by little, where that is more, of which such a run may know as
    little. `sampling_error`, where a joint's law may jump: what lies between samples half a step apart, by that run's;
    and the record's ends, or where nothing is discarded, that no sample is at the start.
    """
    system, scene = probe.system, probe.recorder.scene
    half, finer = system.with_step(system.dt / 2), _judging(scene, system)
    state, done = half.start() if probe.state is None else copied(probe.state), 2 * probe.first
    for samples, output, times in blocks(half, state, done + 2 * probe.steps, done):
        add_halved(finer, system, times - probe.first * system.dt, output, samples)
    own = probe.recorder.samples()
    step, between = against_half(system, probe.recorder, own, finer)
    # Of a later part, whose ends are not the record's.
    ends = ends_error(system, scene, own) if probe.state is None else statistics_error(system, scene, at_ends, own)
    step = max(step * 16 / 15, missed(system, system.dt), step_effect(system, h))
    return {"discretization_error": step, "sampling_error": together((between, ends))}


def add_halved(finer: Recorder, system: System, times: np.ndarray, output: Output, samples: np.ndarray) -> None:
    """Take in a block of the system's run with half the step: where a joint's law may jump all samples, else every
    other one."""
    if system.bent.size:
        finer.add(times, output, samples)
    else:
        finer.add(times[1::2], output.thinned(), samples[1::2])


def against_half(
    system: System, usual: Recorder, own: Mapping[str, np.ndarray], finer: Recorder
) -> tuple[float, float]:
    """Errors by what a `finer` run with half the step, taken in as by `add_halved`, tells otherwise, and by what lies
    between samples, where a joint's law may jump; own: samples of the usual one."""
    jumps, between = system.bent.size > 0, 0.0
    exact, cut = finer.samples(), usual.amended()
    pieces = of_every_other(exact, finer.amended(), cut) if jumps else finer.amended()
    if jumps:  # of samples twice as near to each other as the record's
        between = statistics_error(system, usual.scene, partial(between_samples, cut=pieces), exact)
        exact = {name: x[1::2] for name, x in exact.items()}
    differ = partial(expected_error, cut=(cut, pieces))
    return statistics_error(system, usual.scene, differ, own, exact), between


def ends_error(system: System, short: Scene, samples: Mapping[str, np.ndarray]) -> float:
    """By the record's ends; of a record that begins well within these samples, by what there is at its start.

    samples: of a `short` part of it, from the run's start.
    """
    s, count = system.scene.settings, len(samples["time"])
    gap = short.settings.duration / count
    if s.discard <= NEXT * gap:
        return statistics_error(system, short, from_start, samples)
    skipped = int(np.ceil(s.discard / gap - NEXT)) - 1  # the first one after the gap before it
    if skipped > count / 2:
        share = s.duration / short.settings.duration  # a shorter record is off by more of its ends
        if share < 1 and _of_whole_periods(system, gap):
            return 0.0
        return statistics_error(system, short, lambda x, least, _: at_ends(x, least, share), samples)
    settings = replace(short.settings, duration=short.settings.duration * (1 - skipped / count))
    rest = {name: x[skipped:] for name, x in samples.items()}
    # Past its ramp a sea goes on as all of it; what decays, or comes in, as its end.
    last = 1.0 if np.count_nonzero(system.scene.sea.amplitude) > 1 and s.discard >= s.ramp else LAST
    return statistics_error(system, replace(short, settings=settings), partial(at_ends, begins=True, last=last), rest)


def _of_whole_periods(system: System, gap: float) -> bool:
    """Whether the record of a single wave ends as it begins, and its samples, with those at both ends, fill it.

    gap: between samples [s].
    """
    sea, s = system.scene.sea, system.scene.settings
    omega = sea.omega[np.abs(sea.amplitude) > 0]
    samples = np.floor((s.discard + s.duration) / gap + NEXT) - np.ceil(s.discard / gap - NEXT) + 1
    periods = s.duration * omega / (2 * np.pi)
    whole = np.abs(np.append(periods - np.round(periods), samples * gap / s.duration - 1)) < NEARLY
    return omega.size == 1 and bool(whole.all())


def stations_effect(probe: Probe, h: Hydrodynamics | None) -> float:
    """Relative error of any mean, rms or std by the stations of a frame's drag: of the same run with twice as many.

    Gauss points that stand for a length l each, n to a piece, err by some (l/2λ)²ⁿ/20 of what waves do whose wave
    number is 1/λ, and of what a member's motion does, with the cube of its shape, 2λ the wet part of it; none where
    that is no more than FAR, and waves stop at still water.
    """
    system, s = probe.system, probe.system.scene.settings
    support, points = system.support, s.stations_per_element
    if support is None or support.drag_length == 0 or probe.state is not None:
        return 0.0
    share = max(support.drag_length / (2 * system.waves.mean_length), support.drag_share)
    if support.stretched is None and share ** (2 * points) / 20 < FAR:
        return 0.0
    settings = replace(s, stations_per_element=2 * points, outputs=())
    return _apart(system, probe.recorder, _start(probe, replace(system.scene, settings=settings), h))


def law_effect(probe: Probe, h: Hydrodynamics | None) -> float:
    """The same by the tables of power take-offs, of laws that are known by finer ones.

    Both runs have the lines of the finer tables: steps that are cut elsewhere would tell of the step.
    """
    scene = probe.system.scene
    if probe.state is not None or not knows_finer(scene):
        return 0.0
    tables = (with_tables(scene, of) for of in (PtoTable.on_finer_lines, PtoTable.by_finer))
    try:
        return _apart(probe.system, *(_start(probe, other, h) for other in tables))
    except StepTooLong:  # for so many lines, though not for the run's own
        return UNTOLD


def knows_finer(scene: Scene) -> bool:
    """Whether a law of a power take-off is known by a finer table."""
    return any(f.pto_table is not None and f.pto_table.finer is not None for f in scene.floats)


def with_tables(scene: Scene, of: Callable[[PtoTable], PtoTable]) -> Scene:
    """The scene with other tables of its power take-offs."""
    floats = (replace(f, pto_table=of(f.pto_table)) if f.pto_table is not None else f for f in scene.floats)
    return replace(scene, floats=tuple(floats))


def _start(probe: Probe, scene: Scene, h: Hydrodynamics | None) -> Recorder:
    """Of what is judged of a run, by another scene."""
    system = prepare(scene, h, probe.system.fit)
    recorder = _judging(replace(probe.recorder.scene, floats=scene.floats), system)
    for samples, output, times in blocks(system, system.start(), probe.steps):
        recorder.add(times, output, samples)
    return recorder


def _apart(system: System, usual: Recorder, finer: Recorder) -> float:
    """Relative error of any mean, rms or std by what the start of a finer run tells otherwise."""
    differ = partial(expected_error, cut=(usual.amended(), finer.amended()))
    return statistics_error(system, finer.scene, differ, usual.samples(), finer.samples())


def statistics_error(
    system: System, short: Scene, error: Callable[..., float], *samples: Mapping[str, np.ndarray]
) -> float:
    """Error to expect of any mean, rms or std of the system's record, by an `error` of sampling.

    samples: of a `short` part of it, the best ones last. Motions do not count where none exceeds Newton's tolerance;
    nor does anything, there, without waves, which load what is held, too.
    """
    scene = system.scene
    stds = {name: samples[-1][name].std(axis=0) for name in MOTIONS if name in samples[-1]}
    largest = max((np.nanmax(std, initial=0.0) for std in stds.values()), default=0.0)
    moves = largest > 10 * system.newton_tolerance * bool(scene.floats)
    if not moves and not scene.sea.amplitude.any():
        return 0.0
    longer = max(1.0, scene.settings.duration / short.settings.duration)
    least = least_sizes(system, stds) if moves else {"hinge_force": least_force(scene)}
    # What is on or off between two samples has another std where they are nearer.
    other = ("time", "wave_elevation", "latched", "declutched", *(() if moves else (*MOTIONS, *POWERS)))
    driven = [{name: x for name, x in of.items() if name not in other} for of in samples]
    return error(*driven, least, longer) if driven[-1] else 0.0  # of waves alone, where nothing is in the water


def least_sizes(system: System, stds: Mapping[str, np.ndarray]) -> dict[str, np.ndarray]:
    """What counts as zero though it may be the largest of its kind: joint forces as `least_force` says, motions that
    move a hull or the structure [m] by FAINT² of what the furthest of all do (legs may bend by FAINT of a float's
    swing), and power of floats whose power take-offs move by no more. stds: of MOTIONS.
    """
    scene, channels = system.scene, Channels(system.scene, None)
    length = linear_model(system).length[None, system.structure.omega.size :]
    reach = dict.fromkeys(MOTIONS, np.ones(())) | {name: x[0] for name, x in channels.motions(length)}
    least = FAINT**2 * max(np.nanmax(reach[name] * std, initial=0.0) for name, std in stds.items())
    sizes = {name: least / reach[name] for name in stds} | {"hinge_force": least_force(scene)}
    name = "motion" if "motion" in stds else "rotation"
    if name in stds:  # not where all floats are fixed
        rest = ~_working(system, channels, stds[name] > sizes[name])
        sizes |= dict.fromkeys(POWERS, np.where(rest, np.inf, 0.0))
    return sizes


def _working(system: System, channels: Channels, moves: np.ndarray) -> np.ndarray:
    """Whether any axis (nb, …) with a power take-off moves, of each float (nb,)."""
    law = assembly.joint_law(system.scene.floats)
    taken = channels.by_axis(taking(law)[None].astype(float))[0] == 1
    return np.any(taken & moves.reshape(taken.shape), axis=1)


def quadrature_error(system: System, probe: Probe) -> float:
    """Of mean and std of the pressure's load on the joints, against twice the points, relative to that std.

    Of joints that it moves by more than Newton's tolerance, of all where one is moved so far, or, in waves, whose rest
    it shifts so far; and FAINT as much as those that it moves most. Off by more than it varies it tells none: UNTOLD.
    """
    if not system.bodies.nonlinear.any():
        return 0.0
    s = system.scene.settings
    finer = {name: 2 * getattr(s, name) for name in ("azimuths", "arc_points", "line_points")}
    scene = replace(system.scene, settings=replace(s, panel_size=s.panel_size / 2, **finer))
    fine = system.bodies._replace(**assembly.rules(scene, system.near))
    usual, exact = (_joint_loads(body, probe.states) for body in (system.bodies, fine))
    joints = slice(system.structure.carrier.shape[0], None)
    # About the exact mean: weight bears the rest of it, and what varies is what moves the floats.
    usual, exact = (moments((load - exact.mean(axis=0))[:, joints]) for load in (usual, exact))
    least, model = system.newton_tolerance * np.abs(np.diag(system.stiffness))[joints], linear_model(system)
    pushed = (model.length / np.diag(model.mass))[system.structure.omega.size :] * exact[:, -1]  # [m/s²]
    # What next to nothing pushes rests: rounding, where no spring says how much of it there is.
    moves = np.std([z[joints] for z, _ in probe.states], axis=0).max(initial=0.0) > system.newton_tolerance
    shifts = np.abs(usual - exact)[:, STATISTICS.index("mean")] > least
    counts = (exact[:, -1] > least) | moves | (shifts & system.scene.sea.amplitude.any())
    used = counts & (pushed > max(FAINT * pushed.max(initial=0.0), RESTS * system.scene.water.gravity))
    return min(max((apart(a, b) for a, b in zip(usual[used], exact[used], strict=True)), default=0.0), UNTOLD)


def _joint_loads(body: Bodies, states: list[tuple[np.ndarray, np.ndarray]]) -> np.ndarray:
    """Jᵀ F of the pressure's load F at some states, (m, nz)."""
    motion, room, load = new_motion(body), pressure_room(body), np.empty((body.axes.size, 6))
    loads = np.zeros((len(states), body.mechanism.size))
    for row, (z, pressure) in zip(loads, states, strict=True):
        move(body, z, np.zeros(z.size), motion)
        pressures(body, motion, pressure, room, load)
        for b in range(body.axes.size):
            n = body.axes[b]
            row[body.coordinate[b, :n]] += motion.jacobian[b, :, :n].T @ load[b]
    return loads
