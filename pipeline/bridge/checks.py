"""A study that cannot run, refused before anything does: what a study alone can get wrong, and what the solver says.

What the solver's inputs refuse is not judged here: they are built, and their objections passed on.
"""

from __future__ import annotations

import itertools
from collections.abc import Callable, Iterable, Iterator, Sequence
from functools import lru_cache, partial

import numpy as np

from pipeline.bridge import axis_checks, platforms, scenes, sea_checks
from pipeline.bridge.axis_checks import MOST_NAMED
from pipeline.bridge.objections import objections
from pipeline.study import seas
from pipeline.study.axes import Axes, Axis
from pipeline.study.layout import HINGE
from pipeline.study.platform import Platform
from pipeline.study.schema import StudyFile
from pipeline.study.settings import RULES
from pipeline.study.tables import Same
from pipeline.study.words import told
from pipeline.tasks.task import (
    AXES,
    Label,
    at_labels,
    axes,
    blocks,
    cell,
    firsts,
    supports,
    surviving,
)
from solver.errors import InputError
from solver.scene import MOST_STEPS, OF_FLOATS, OF_STEEL, on_others

MOST_FLOATS = 100  # far more than anybody has asked for, and already all of a machine's memory
MOST_TRIED = 10  # values of an axis, with as many of another
NUMERICS = "record.", "solver."  # tables of what makes the solver's settings

Judge = Callable[[StudyFile], Iterable[InputError]]


def problems(study: StudyFile, *, based: bool = False) -> list[InputError]:
    """Everything wrong with a study whose types and ranges are right; what its parts lack before what they make.

    based: whether it stands on another, of which no table can be taken back.
    """
    later: tuple[Judge, ...] = (
        axis_checks.overlaps,
        axis_checks.variants,
        axis_checks.empty,
        *([] if based else [_idle]),
        partial(_at_each_value, judge=_contents),
        partial(_at_each_value, judge=_scenes),
        _together,
    )
    # A path to one of two floats of a name leads to the first of them, or, meant for the other, nowhere.
    each = [*axis_checks.repeated("floats.name", (f.name for f in study.floats))]
    each = each or [*axis_checks.paths(study), *axis_checks.named(study)]
    for judge in later:
        each = each or [*judge(study)]
    return list({str(problem): problem for problem in each}.values())


def _at_each_value(study: StudyFile, judge: Judge) -> Iterator[InputError]:
    """Of the study at the first values of its axes; at each other value of one of them, what is new there."""
    common: set[str] = set()
    for content, prefix in _each_value(study):
        for problem in judge(content):
            if prefix is None:
                common.add(str(problem))
                yield problem
            elif str(problem) not in common:
                yield InputError(*prefix, str(problem))


def _contents(study: StudyFile) -> Iterator[InputError]:
    yield from sea_checks.problems(study)
    yield from _recording(study)
    if study.coefficients and len(study.floats) > 1 and not study.solver.interaction:
        limit = "must be true: `coefficients` from a file are of floats that interact"
        yield InputError("solver.interaction", "false", limit)
    if study.coefficients and study.solver.gap_damping > 0:
        limit = "must be 0: `coefficients` from a file have the damping that they have"
        yield InputError("solver.gap_damping", study.solver.gap_damping, limit)
    if study.current and not study.platform:
        yield InputError("current", "given", "acts on the members of an elastic platform: needs a [platform] table")
    yield from _left_out(study)
    yield from _parts(study)


def _each_value(study: StudyFile) -> Iterator[tuple[StudyFile, tuple[str, object] | None]]:
    """The study at the labels of its first task, and with each other label of one of its axes over keys; which that is.

    So each variant that goes along parts of the axes; what other seas and supports have had stands for these.
    """
    first_with = firsts(study)
    met: dict[object, set[tuple[str, Label]]] = {}  # labels, by what the named axes have beside them
    given = {"sea_state", *(name for name in AXES if getattr(study.axes, name))}  # keys' axes may have others' names
    for number, part in enumerate(blocks(study)):
        named = tuple((name, tuple(part[name])) for name in AXES if name in part.keys() & given)
        known = met.setdefault(named, set())
        first = first_with({name: next(iter(labels)) for name, labels in part.items()})
        yield _narrowed(at_labels(study, first), named), ("variant", first["variant"]) if number else None
        if study.survival and not number:
            yield _narrowed(surviving(Same(at_labels(study, first))), named), ("survival.Hs", study.survival.Hs)
        known.update(first.items())
        for axis in study.varied:
            for place, label in enumerate(axis.labels):
                if (axis.name, label) not in known and label in part.get(axis.name, (label,)):
                    known.add((axis.name, label))
                    yield _narrowed(at_labels(study, {**first, axis.name: label}), named), _at(axis, place)


def _narrowed(study: StudyFile, named: tuple[tuple[str, tuple[Label, ...]], ...]) -> StudyFile:
    """With parts of the named axes alone."""
    return study.model_copy(update={"axes": study.axes.model_copy(update=dict(named))}) if named else study


def _at(axis: Axis, place: int) -> tuple[str, object]:
    """What a label is called in messages: the only key and its value, or the dimension and its label."""
    if not axis.own:
        return axis.name, axis.labels[place]
    path, values = next(iter(axis.keys.items()))
    return f'axes."{path}"', told(values[place])


def _together(study: StudyFile) -> Iterator[InputError]:
    """What record and numerics have against values of two axes, each of which they let pass; once for two axes.

    Of many values some are tried, in the first task that has both.
    """
    first_with = firsts(study)
    first = first_with({})
    bear = [axis for axis in study.varied if any(path.startswith(NUMERICS) for path in axis.keys)]
    tried = {axis.name: _some([label for label in axis.labels if label != first[axis.name]]) for axis in bear}
    for one, other in itertools.combinations(bear, 2):
        for labels in itertools.product(tried[one.name], tried[other.name]):
            both = first_with(dict(zip((one.name, other.name), labels, strict=True)))
            if both and (problems := list(objections(partial(scenes.settings, at_labels(study, both))))):
                limit = f"with {other.name} = {labels[1]}: {problems[0]}"
                yield InputError(*_at(one, one.labels.index(labels[0])), limit)
                break


def _some(labels: Sequence[Label]) -> Sequence[Label]:
    return labels[:: 1 + len(labels) // MOST_TRIED]


def _waves(study: StudyFile) -> bool:
    """Whether any sea has some."""
    return any(not isinstance(sea, seas.Still) for sea in study.seas.values())


def _recording(study: StudyFile) -> Iterator[InputError]:
    record = study.record
    if _waves(study) and record.ramp > record.discard and study.solver.method == "time":
        usual = "" if "ramp" in record.model_fields_set else ", as it is where none is given"
        yield InputError("record.ramp", record.ramp, f"must be <= record.discard = {record.discard:g} s{usual}")
    if (steel := [name for name in record.outputs if name in OF_STEEL]) and not study.platform:
        yield InputError("record.outputs", steel, "are of an elastic platform: needs a [platform] table")
    for name in OF_FLOATS:
        if name in record.outputs and not study.floats:
            yield InputError("record.outputs", name, "is of floats: needs [[floats]]")
    longest, step = record.discard + record.duration, study.solver.time_step
    if step is not None and study.solver.tolerance is None and longest > MOST_STEPS * step:
        limit = f"must be >= {longest / MOST_STEPS:.3g} s, or {longest:g} s take more than {MOST_STEPS} steps"
        yield InputError("solver.time_step", step, limit)


def _idle(study: StudyFile) -> Iterator[InputError]:
    """Rules of outputs that no task has, and yet whoever gives them means them to."""
    records = [content.record for content, _ in _each_value(study)]
    for name in RULES:
        given = any(name in record.model_fields_set for record in records)
        if given and not any(name in record.outputs for record in records):
            yield InputError(f"record.{name}", "given", f"is of the output {name}: ask for it in record.outputs, too")


def _left_out(study: StudyFile) -> Iterator[InputError]:
    names = [f.name for f in study.floats]
    for name in study.left_out:
        if name not in names:
            yield InputError("left_out", name, f"must be one of the floats: {', '.join(names[:MOST_NAMED])}")
    nothing = study.left_out and not set(names) - set(study.left_out) and not study.platform
    if nothing and not study.survival:  # in high seas alone there may be nothing in the water
        yield InputError("left_out", list(study.left_out), "leaves nothing to simulate")
    for f in study.floats:
        if f.on in study.left_out and f.name not in study.left_out:
            yield InputError("left_out", f.on, f"must not carry a float that stays: floats.{f.name}.on = {f.on}")


def _parts(study: StudyFile) -> Iterator[InputError]:
    """The solver's objections to floats, sections and members, each by itself; and to too many of them."""
    if len(study.floats) > MOST_FLOATS:
        yield InputError("floats", f"{len(study.floats)} floats", f"must be <= {MOST_FLOATS}")
        return
    for item in study.floats:
        yield from objections(partial(scenes.in_place, item, study.water))
    if table := study.platform:
        if "elastic" in supports(study):  # whose frame has a node for each float that no member need join
            yield from on_others((f.name, f.on) for f in study.floats if f.name not in study.left_out)
        yield from _platform(Same(table))


@lru_cache(maxsize=4)
def _platform(same: Same[Platform]) -> tuple[InputError, ...]:
    """Values of an axis that do not change the platform share them."""
    return tuple(_of_platform(same.table))


def _of_platform(table: Platform) -> Iterator[InputError]:
    yield from axis_checks.repeated("platform.legs", table.legs)
    written = table.damping_ratio if "damping_ratio" in table.model_fields_set else 0.0
    if written and (table.rayleigh_mass or table.rayleigh_stiffness):
        limit = "must be 0 or left out beside rayleigh_mass or rayleigh_stiffness, which damp instead of it"
        yield InputError("platform.damping_ratio", written, limit)
    for node, place in table.nodes.items():
        if node.startswith(HINGE):
            yield InputError(f"platform.nodes.{node}", list(place), "comes with its float; leave it out")
    for name in table.sections:
        yield from objections(partial(platforms.section, name, table))
    for member in table.members:
        yield from objections(partial(platforms.member, member, table))


def _scenes(study: StudyFile) -> Iterator[InputError]:
    """The solver's objections to the scenes: one for each support and place of the hinges, with the shortest wave."""
    from solver.sea.realization import Realization

    omega = np.array([sea_checks.highest_frequency(study)])
    shortest = Realization(omega=omega, amplitude=np.array([1e-9 * _waves(study) + 0j]))
    fixed = _as_it_is(study)
    for labels in _configurations(fixed):
        yield from objections(partial(scenes.scene, cell(fixed, labels, ()).parameters, shortest))


def _as_it_is(study: StudyFile) -> StudyFile:
    """Without its axes over keys."""
    axes = Axes.model_validate({name: values for name in AXES if (values := getattr(study.axes, name)) is not None})
    return study.model_copy(update={"axes": axes, "variants": {}, "samples": None, "survival": None})


def _configurations(study: StudyFile) -> Iterator[dict[str, Label]]:
    """Labels of one task for each of them; sea states and seeds are judged by themselves."""
    varied = {name: values if name == "hinge_spacing" else values[:1] for name, values in axes(study).items()}
    # The report draws a platform also where no task has one.
    varied["platform"] = tuple({*supports(study), *(["elastic-no-floats"] if study.platform else [])})
    return (dict(zip(varied, labels, strict=True)) for labels in itertools.product(*varied.values()))
