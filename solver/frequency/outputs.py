"""Outputs of a response: lines of what goes with the waves, and statistics of them and of what no line makes."""

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from solver.frequency import gaussian
from solver.frequency.bent import absorbed_table, borne_table, pto_load, rate_load
from solver.frequency.case import Case
from solver.frequency.catenaries import slopes, tension_table
from solver.frequency.response import Response
from solver.frequency.shape import reached
from solver.multibody.joint_law import JointLaw
from solver.multibody.of_axes import drag
from solver.record.channels import ELEVATION, Labelled
from solver.scene import DOFS
from solver.statistics import STATISTICS

Output = tuple[str, np.ndarray, np.ndarray]  # name, mean (…), lines (nl, …)


class Forces(NamedTuple):
    """Of an elastic platform's frame, ny of them."""

    level: np.ndarray  # (1, ny) mean
    lines: np.ndarray  # (nl, ny)


class Lacks(NamedTuple):
    """What harmonics of drag change of one wave's response: of its mean, then of its own line."""

    X: np.ndarray  # (2, nm) modes
    forces: np.ndarray  # (2, ny) of the frame


class Rung(NamedTuple):
    """How an elastic platform moves, and what it and the joints bear, with what bent loads ring."""

    process: gaussian.Process
    X: np.ndarray  # (nl, nm) modes
    frame: Forces
    joints: np.ndarray | None = None  # (nb, 3, 5) statistics of `hinge_force` where that has such lines
    extremes: float = 1.0  # of steel to be expected, over those of Gaussian lines, where they are larger
    rings: float = 0.0  # share of steel's variance by lines that no wave makes
    lacks: Lacks | None = None


def strokes(case: Case, response: Response) -> Iterator[tuple[str, Labelled]]:
    """Of power take-offs, if asked for: from one end to the other, and the way in an hour, 3600 ⟨|v|⟩, of rates with
    kurtosis κ beyond a Gaussian's 1 - κ/24 of that."""
    if "pto_stroke" not in case.system.scene.settings.outputs or not case.channels.axes:
        return
    joints, rates = joint_lines(case, response), rate_lines(case, response)
    ends = reached(gaussian.table(np.zeros(joints.shape[1]), joints, case.process), response.excess[1])
    of_rates = case.process.sampled(rates)
    usual = np.sqrt(2 / np.pi) * gaussian.spread(rates) if of_rates is None else np.abs(of_rates).mean(axis=0)
    size = usual * (1 - response.excess[0] / 24)
    yield "pto_stroke", case.channels.at_axes(ends[:, 0] - ends[:, 1])
    yield "pto_travel", case.channels.at_axes(3600 * size)


def joint_lines(case: Case, response: Response) -> np.ndarray:
    """Lines of the joints' axes (nl, nj)."""
    return response.Z[:, case.system.structure.carrier.shape[0] :]


def rate_lines(case: Case, response: Response) -> np.ndarray:
    """Lines of their rates (nl, nj)."""
    return -1j * response.omega[:, None] * joint_lines(case, response)


def mean_forces(case: Case, response: Response) -> np.ndarray:
    """Of the joints (nb, 3)."""
    return case.channels.hinge_force((case.loads_at_rest[1] + response.mean.wrench)[None])[0]


def tables_of(process: gaussian.Process, outputs: list[Output]) -> dict[str, np.ndarray]:
    """Statistics of outputs, all at once."""
    if not outputs:
        return {}
    ends = np.cumsum([lines[0].size for _, _, lines in outputs])
    every = np.concatenate([lines.reshape(len(lines), -1) for _, _, lines in outputs], axis=1)
    mean = np.empty(every.shape[1])
    for end, (_, level, lines) in zip(ends, outputs, strict=True):
        mean[end - lines[0].size : end] = np.ravel(level)
    table = gaussian.table(mean, every, process)
    return {
        name: table[end - lines[0].size : end].reshape(*lines.shape[1:], -1)
        for end, (name, _, lines) in zip(ends, outputs, strict=True)
    }


def _of_law(case: Case, axes: np.ndarray) -> np.ndarray:
    """Which axes of the system's law some of the joints' are, of a mask (nj,)."""
    return case.system.structure.carrier.shape[0] + np.flatnonzero(axes)


def bend(case: Case, response: Response, law: JointLaw, linear: list[Output], tables: dict[str, np.ndarray]) -> None:
    """By the whole law, and rates and motions of the shape that it makes, in place: how far and how fast axes move, and
    what they bear, `pto_force`, and along an axis that slides the joint's `hinge_force`, with all that goes by rate.

    Axes that friction holds bear what the linear model says. On a float, which tilts, a joint has part of what it bears
    across its axis along it: of second order, but beside a limit most of the largest. Of these no less is told than by
    lines.
    """
    scene, channels, rates = case.system.scene, case.channels, rate_lines(case, response)
    nc = case.system.structure.carrier.shape[0]
    by_rate = response.bends | (drag(law)[nc:] > 0)
    if not by_rate.any():
        return
    owner, of_lines = channels.owner, {name: lines for name, _, lines in linear}
    place = owner, [channels.axes.index(name) for name in channels.names]
    for name, kappa in (("pto_rate", response.excess[0]), ("motion", response.excess[1])):
        if name in tables:
            tables[name][place] = reached(tables[name][place], kappa)
    if "rotation" in tables:
        hinged = [name == "hinge" for name in channels.names]
        turned = owner[hinged]
        tables["rotation"][turned] = reached(tables["rotation"][turned], response.excess[1, hinged])
    tilts = np.array(scene.carriers)[owner] >= 0
    slides, moved = np.array([name in DOFS[:3] for name in channels.names], bool), ~response.stuck
    for name, which, of, order in (
        ("pto_force", moved & by_rate, pto_load, channels.axes),
        ("hinge_force", moved & slides & by_rate, rate_load, DOFS),
    ):
        axes = np.flatnonzero(which)
        if name in tables and axes.size:
            at = owner[axes], [order.index(channels.names[j]) for j in axes]
            usual, lines = tables[name][at], of_lines[name][:, *at]
            at_rate = of(law, nc + axes), rates[:, axes]
            found = borne_table(*at_rate, usual, lines, case.process, response.excess[0, axes])
            wider = tilts[axes] & (name == "hinge_force")
            found[wider, 0] = np.maximum(found[wider, 0], usual[wider, 0])
            found[wider, 1] = np.minimum(found[wider, 1], usual[wider, 1])
            tables[name][at] = found


def of_squares(case: Case, response: Response, rung: Rung, law: JointLaw) -> Iterator[tuple[str, np.ndarray]]:
    """Name and statistics of what no line makes."""
    scene, channels = case.system.scene, case.channels
    if channels.lines:
        z = case.system.equilibrium[0] + case.model.shape @ response.mean.x
        yield "line_tension", tension_table(case, response.Z, z)
    if scene.floats:
        pto, rates = response.pto, rate_lines(case, response)
        by_law = (response.bends & ~response.stuck) | (response.excess[0] != 0)
        owned = [channels.owner == b for b in range(len(scene.floats))]
        powers = [
            absorbed_table(pto_load(law, _of_law(case, i)), rates[:, i], case.process, response.excess[0, i])
            if np.any(by_law & i)
            else gaussian.power_table(pto[i], rates[:, i], case.process)
            for i in owned
        ]
        yield "absorbed_power", np.array(powers)
        if any(f.pto_efficiency for f in scene.floats):
            yield "electrical_power", np.array(list(_electrical(case, response, law, owned, powers)))
    if channels.steel is not None and channels.legs is not None:
        level, lines = (channels.steel.compression(y)[:, channels.legs.first] for y in rung.frame)
        of_legs = gaussian.compression_table(level[0], lines, rung.process)
        yield "bottom_stress", of_legs[channels.legs.twin]


def _electrical(
    case: Case, response: Response, law: JointLaw, owned: list[np.ndarray], absorbed: list[np.ndarray]
) -> Iterator[np.ndarray]:
    """Statistics of each float's electrical power, by that absorbed; NaN of those without an efficiency."""
    scene, joints = case.system.scene, joint_lines(case, response)
    level = (case.system.equilibrium[0] + case.model.shape @ response.mean.x)[-joints.shape[1] :]
    rates = rate_lines(case, response)
    for f, i, power in zip(scene.floats, owned, absorbed, strict=True):
        if f.pto_efficiency is None:
            yield np.full(len(STATISTICS), np.nan)
            continue
        load = pto_load(law, _of_law(case, i)), response.pto[i], f.per_axis("pto_stiffness")
        axes = gaussian.Axes(*load, level[i], joints[:, i], rates[:, i])
        yield gaussian.electrical_table(f.pto_efficiency, axes, power, case.process)


def outputs(case: Case, response: Response) -> Iterator[Output]:
    """Of all that goes with the waves but a platform's."""
    system, channels, mean = case.system, case.channels, response.mean
    scene = system.scene
    z = system.equilibrium[0] + case.model.shape @ mean.x
    yield ELEVATION, np.zeros(()), case.amplitude
    if scene.floats:
        nc, joints = system.structure.carrier.shape[0], joint_lines(case, response)
        means = dict(channels.motions(z[None, nc:]))
        for name, lines in channels.motions(joints):
            yield name, means[name][0], lines
        pto, rates = response.pto, rate_lines(case, response)
        if "pto_stroke" in scene.settings.outputs and channels.axes:
            yield "pto_rate", np.zeros(()), channels.by_axis(rates)
        if "pto_force" in scene.settings.outputs and channels.axes:
            k = np.concatenate([f.per_axis("pto_stiffness") for f in scene.floats])
            level, lines = channels.by_axis(-(k * z[nc:])[None])[0], channels.by_axis(-(pto * rates + k * joints))
            yield "pto_force", level, lines
        yield "hinge_force", mean_forces(case, response), channels.hinge_force(response.wrench)
        if channels.lines:
            yield "line_tension", channels.line_tension(system.bodies, z[None])[0], response.Z @ slopes(case, z)


def platform_outputs(case: Case, response: Response, rung: Rung) -> Iterator[Output]:
    """Of a platform, that are linear."""
    channels, frame, p = case.channels, rung.frame, case.system.equilibrium[1]
    if channels.legs is not None:
        tops = channels.legs.tops.reshape(p.size, -1)
        means, lines = (x @ tops for x in (p + response.mean.x[: p.size], rung.X))
        on = channels.legs.tops.shape[1:]
        yield "top_displacement", means.reshape(on), lines.reshape(-1, *on)
    if channels.nodes:
        for name, lines in channels.accelerations(-(rung.process.omega[:, None] ** 2) * rung.X):
            yield name, np.zeros(()), lines
    if channels.steel is not None:
        means = dict(channels.steel.channels(frame.level))
        for name, values in channels.steel.channels(frame.lines):
            yield name, means[name][0], values


def frame_forces(case: Case, response: Response) -> Forces:
    """Of the frame, that are asked for."""
    if case.system.support is None or case.system.support.forces is None:
        return Forces(np.zeros((1, 0)), np.zeros((response.omega.size, 0)))
    forces = case.system.support.forces
    nc, nm = case.system.structure.carrier.shape
    still = case.loads_at_rest[0][:nc] + response.mean.carried
    dp = -1j * response.omega[:, None] * response.X[:, :nm]
    ddp = -1j * response.omega[:, None] * dp
    level = (still @ forces.carried + response.mean.drag.ravel() @ forces.drag)[None]
    lines = case.padded(case.rows[case.system.layout.forces]).T
    lines += forces.of_motion(dp, ddp, response.carried) + response.drag.forces
    return Forces(forces.whole(level) + forces.at_rest, forces.whole(lines))
