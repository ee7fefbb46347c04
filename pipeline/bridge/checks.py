"""A study that cannot run, refused before anything does: what a study alone can get wrong, and what the solver says.

What the solver's inputs refuse is not judged here: they are built, and their objections passed on.
"""

from __future__ import annotations

import itertools
import math
from collections import Counter
from collections.abc import Iterable, Iterator
from functools import partial

import numpy as np

from pipeline.bridge import scenes, sea_checks
from pipeline.study.layout import HINGE
from pipeline.study.schema import StudyFile
from pipeline.tasks.task import Label, axes, cell, supports
from solver.errors import InputError

# Far more than anybody has asked for, and already days of work or all of a machine's memory.
MOST_STEPS = 10_000_000  # of one run: 23 days of sea at the default step
MOST_TASKS = 10_000_000
MOST_FLOATS = 100
MOST_ELEMENTS = 10_000  # of a platform


def problems(study: StudyFile) -> list[InputError]:
    """Everything wrong with a study whose types and ranges are right; what its parts lack before what they make."""
    each = [*sea_checks.problems(study), *_axes(study), *_recording(study), *_parts(study)]
    return list({str(problem): problem for problem in each or _scenes(study)}.values())


def _axes(study: StudyFile) -> Iterator[InputError]:
    axes = study.axes
    for name in type(axes).model_fields:
        values = getattr(axes, name)
        if values is not None and not values:
            yield InputError(f"axes.{name}", "[]", "needs at least one value")
        yield from _repeated(f"axes.{name}", values or ())
    lengths = [len(values) for name in type(axes).model_fields if (values := getattr(axes, name))]
    if (count := math.prod(lengths, start=1 if axes.sea_state else len(study.sea_states))) > MOST_TASKS:
        yield InputError("axes", f"{count} tasks", f"must be <= {MOST_TASKS}: split the study")
    for label in axes.sea_state or ():
        if label not in study.sea_states:
            known = ", ".join(study.sea_states)
            yield InputError("axes.sea_state", label, f"must be one of [sea_states]: {known}")
    for support in supports(study):
        if support != "fixed" and not study.platform:
            yield InputError("axes.platform", support, "needs a [platform] table")
        if support == "fixed" and not study.floats:
            yield InputError("axes.platform", support, "without [[floats]] leaves nothing to simulate")
    if axes.hinge_spacing and len(study.floats) != 2:
        yield InputError("axes.hinge_spacing", f"with {len(study.floats)} floats", "needs exactly 2 floats")
    elif axes.hinge_spacing and study.floats[0].hinge[0] == study.floats[1].hinge[0]:
        yield InputError("axes.hinge_spacing", list(axes.hinge_spacing), "needs hinges at two different x")
    if axes.pto_damping and not study.floats:
        yield InputError("axes.pto_damping", 0, "needs [[floats]]")
    elif axes.pto_damping and (several := [f.name for f in study.floats if len(f.motion) > 1]):
        limit = f"needs floats with a single axis, and {several[0]} has several: give its own list"
        yield InputError("axes.pto_damping", list(axes.pto_damping), limit)


def _repeated(key: str, values: Iterable[object]) -> Iterator[InputError]:
    for value, count in Counter(values).items():
        if count > 1:
            yield InputError(key, value, f"given {count} times, must be unique")


def _recording(study: StudyFile) -> Iterator[InputError]:
    record = study.record
    if record.ramp > record.discard:
        yield InputError("record.ramp", record.ramp, f"must be <= record.discard = {record.discard:g} s")
    longest, step = record.discard + record.duration, study.solver.time_step
    if step is not None and study.solver.tolerance is None and longest > MOST_STEPS * step:
        limit = f"must be >= {longest / MOST_STEPS:.3g} s, or {longest:g} s take more than {MOST_STEPS} steps"
        yield InputError("solver.time_step", step, limit)


def _parts(study: StudyFile) -> Iterator[InputError]:
    """The solver's objections to floats, sections and members, each by itself; and to too many of them."""
    if len(study.floats) > MOST_FLOATS:
        yield InputError("floats", f"{len(study.floats)} floats", f"must be <= {MOST_FLOATS}")
        return
    if study.platform and (count := sum(m.elements for m in study.platform.members)) > MOST_ELEMENTS:
        yield InputError("platform.members", f"{count} elements", f"must be <= {MOST_ELEMENTS}")
        return
    for item in study.floats:
        yield from scenes.objections(partial(scenes.in_place, item, study.water))
    if table := study.platform:
        yield from _repeated("platform.legs", table.legs)
        for node, place in table.nodes.items():
            if node.startswith(HINGE):
                yield InputError(f"platform.nodes.{node}", list(place), "comes with its float; leave it out")
        for name in table.sections:
            yield from scenes.objections(partial(scenes.section, name, table))
        for member in table.members:
            yield from scenes.objections(partial(scenes.member, member, table))


def _scenes(study: StudyFile) -> Iterator[InputError]:
    """The solver's objections to the scenes: one for each support and place of the hinges, with the shortest wave."""
    from solver.sea.realization import Realization

    shortest = Realization(omega=np.array([sea_checks.highest_frequency(study)]), amplitude=np.array([1e-9 + 0j]))
    for labels in _configurations(study):
        yield from scenes.objections(partial(scenes.scene, cell(study, labels, ()).parameters, shortest))


def _configurations(study: StudyFile) -> Iterator[dict[str, Label]]:
    """Labels of one task for each of them; sea states and seeds are judged by themselves."""
    varied = {name: values if name == "hinge_spacing" else values[:1] for name, values in axes(study).items()}
    # The report draws a platform also where no task has one.
    varied["platform"] = tuple({*supports(study), *(["elastic-no-floats"] if study.platform else [])})
    return (dict(zip(varied, labels, strict=True)) for labels in itertools.product(*varied.values()))
