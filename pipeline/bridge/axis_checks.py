"""What a study varies, as far as no task need be made to see what is wrong with it: axes, variants, high seas."""

from __future__ import annotations

import itertools
import math
from collections import Counter
from collections.abc import Iterable, Iterator, Mapping

from pipeline.results.variables import COORDINATES, VARIABLES, output_of
from pipeline.study import seas
from pipeline.study.axes import TAKEN, Axis
from pipeline.study.inherit import KINDS
from pipeline.study.paths import PathError, keys_at, with_value
from pipeline.study.schema import StudyFile
from pipeline.study.words import told
from pipeline.tasks.task import AXES, Label, axes, blocks, coordinates, standing_for, supports
from solver.errors import InputError

MOST_TASKS = 10_000_000  # far more than anybody has asked for, and already days of work
MOST_AXES = 24  # over keys, each of which is a dimension of the dataset
MOST_NAMED = 20  # labels of an axis in a message
SHORT = {"pto_damping": "floats.*.pto_damping", "hinge_spacing": "floats.*.hinge.0"}  # what named axes decide, last
SURVIVING = ("floats", "left_out", "platform", "solver")  # tables and keys of which others may hold in high seas


def paths(study: StudyFile) -> Iterator[InputError]:
    """Paths that lead nowhere, values that may not stand there, names that others have."""
    if len(study.varied) > MOST_AXES:
        yield InputError(
            "axes", f"{len(study.varied)} keys", f"must be <= {MOST_AXES}; [[axes.together]] varies several"
        )
        return
    limit = "is the name of another dimension, coordinate or output"
    others = TAKEN | VARIABLES.keys() | COORDINATES.keys() - set(AXES)

    def taken(name: str) -> bool:
        return name in others or output_of(name) in VARIABLES

    words = Counter(word.partition(" ")[0] for group in study.axes.together for word in group.beside)
    words.update(axes(study).keys())
    for group in study.axes.together:
        if taken(group.name) or getattr(study.axes, group.name, None):
            yield InputError("axes.together.name", group.name, limit)
        for word, values in group.beside.items():
            if taken(name := word.partition(" ")[0]) or words[name] > 1:
                yield InputError(f'axes.together."{word}"', list(values), limit)
    for axis in study.varied:
        together, right = [axis.at(place) for place in range(len(axis.labels))], True
        for path, values in axis.keys.items():
            if not values:
                yield InputError(f'axes."{path}"', "[]", "needs at least one value")
            for label, given in zip(axis.labels, together, strict=True):
                if path in given and (limit := _objection(study, path, given) or _above(study, path, given)):
                    yield InputError(_place(axis, path, label), told(given[path]), limit)
                    right = False
                    break
        if right:  # a list that is taken apart for its values may have one twice
            yield from repeated(f'axes."{next(iter(axis.keys)) if axis.own else axis.name}"', axis.labels)
    yield from _survival(study)
    names = Counter(axis.name for axis in study.varied)
    for name in (name for name, count in names.items() if count > 1):
        yield InputError("axes", name, "is the name of two dimensions; rename one in [[axes.together]]")


def named(study: StudyFile) -> Iterator[InputError]:
    axes = study.axes
    for name in AXES:
        values = getattr(axes, name)
        if values is not None and not values:
            yield InputError(f"axes.{name}", "[]", "needs at least one value")
        yield from repeated(f"axes.{name}", values or ())
    lengths = [len(values) for name in AXES if (values := getattr(axes, name))]
    lengths += [len(axis.labels) for axis in study.varied]
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
        limit = f"needs exactly 2 floats, and the study has {len(study.floats)}"
        yield InputError("axes.hinge_spacing", list(axes.hinge_spacing), limit)
    elif axes.hinge_spacing and study.floats[0].hinge[0] == study.floats[1].hinge[0]:
        yield InputError("axes.hinge_spacing", list(axes.hinge_spacing), "needs hinges at two different x")
    if axes.pto_damping and not study.floats:
        yield InputError("axes.pto_damping", list(axes.pto_damping), "needs [[floats]]")
    # A motion that names an axis twice is refused for that.
    elif axes.pto_damping and (several := [f.name for f in study.floats if len(f.motion) == len({*f.motion}) > 1]):
        path = f'"floats.{several[0]}.pto_damping"'
        limit = f"needs floats with a single axis, and {several[0]} has several: vary {path} by lists instead"
        yield InputError("axes.pto_damping", list(axes.pto_damping), limit)


def _survival(study: StudyFile) -> Iterator[InputError]:
    """Values in high seas that lead nowhere, or that nothing would come of."""
    if study.survival is None:
        return
    for path, value in study.survival.keys.items():
        if limit := _surviving(study, path, study.survival.keys):
            yield InputError(f'survival."{path}"', value, limit)
    if not study.survival.keys and not any(_in_high_seas(path) for axis in study.varied for path in axis.keys):
        yield InputError("survival", "{}", 'needs keys that change, as "floats.*.coulomb" = 1e9, or left_out')
    unknown = set(study.axes.sea_state or ()) - study.sea_states.keys()
    if unknown or any(path.startswith("sea") for axis in study.varied for path in axis.keys):
        return  # which are judged elsewhere
    try:
        highest = max(map(seas.height, study.seas.values()))
    except InputError:  # of a file, which is judged with its sea
        return
    if not highest > study.survival.Hs:
        limit = f"no sea of the study is above it: the highest has Hs = {highest:g} m"
        yield InputError("survival.Hs", study.survival.Hs, limit)


def _above(study: StudyFile, path: str, together: Mapping[str, object]) -> str:
    """What is wrong with a value that a dimension has for high seas."""
    inner = _in_high_seas(path)
    if not (inner and study.survival):
        return ""
    beside = {_in_high_seas(other): value for other, value in together.items() if _in_high_seas(other)}
    return _surviving(study, inner, beside)


def _in_high_seas(path: str) -> str:
    """The path of another value in high seas; nothing of another key's."""
    head, _, rest = path.partition(".")
    return rest if head == "survival" and rest != "Hs" else ""


def _surviving(study: StudyFile, path: str, together: Mapping[str, object]) -> str:
    """What is wrong with a value in high seas, or with its path."""
    first = path.partition(".")[0]
    if first not in SURVIVING:
        return f"must be a key of {', '.join(SURVIVING)}"
    if study.axes.hinge_spacing and first == "floats" and "hinge" in path.split("."):
        return "must be left out beside axes.hinge_spacing, which alone decides on hinges"
    return _objection(study, path, together)


def _objection(study: StudyFile, path: str, together: Mapping[str, object]) -> str:
    """What is wrong with a path or its value; nothing where that is another's fault, of those that come with it."""
    try:
        with_value(study, path, together[path], together)
    except PathError as error:
        return str(error) if error.path in ("", path) else ""
    return ""


def _place(axis: Axis, path: str, label: Label) -> str:
    """Where a study file gives a key its value."""
    above = {"variant": f"variants.{label}", "sample": "samples"}.get(axis.name, "axes")
    return f'{above}."{path}"'


def overlaps(study: StudyFile) -> Iterator[InputError]:
    """Keys that two dimensions vary, by whatever paths; of a variant, from which axes may go on, what those decide.

    Another shape or kind that it brings in needs all keys of its table, whatever becomes of them.
    """
    short = [Axis(name, (), {name: ()}) for name in SHORT if getattr(study.axes, name)]
    for one, other in itertools.combinations((*study.varied, *short), 2):
        decided = _reached(study, other)
        if one.name == "variant":
            whole = {path.rpartition(".")[0] for path in one.keys if path.rpartition(".")[2] in KINDS}
            own = [path for path in one.keys if path.rpartition(".")[0] not in whole]
            twice = [path for path in own if all(_within(key, decided) for key in _keys(study, path))]
        else:
            pairs = itertools.product(_reached(study, one), decided)
            twice = [".".join(max(a, b)) for a, b in pairs if a[: len(b)] == b[: len(a)]]
        if twice:
            along = f"{one.name} and {other.name}"
            limit = f"is varied along two dimensions, {along}, of which the second would decide alone"
            yield InputError("axes", f'"{twice[0]}"', limit)


def _reached(study: StudyFile, axis: Axis) -> list[tuple[str, ...]]:
    """The keys that an axis varies; one that is part of another has a longer way."""
    return [key for path in axis.keys for key in _keys(study, path)]


def _keys(study: StudyFile, path: str) -> Iterator[tuple[str, ...]]:
    return keys_at(study, SHORT.get(path, path))


def _within(key: tuple[str, ...], others: Iterable[tuple[str, ...]]) -> bool:
    """Whether it is one of the others, or a part of one."""
    return any(key[: len(other)] == other for other in others)


def variants(study: StudyFile) -> Iterator[InputError]:
    """Parts of axes that the study does not have."""
    table, known = axes(study), coordinates(study)
    for name, variant in study.variants.items():
        for key, values in variant.axes.items():
            where = f"variants.{name}.axes.{key}"
            if key not in known or known[key].dimension == "variant":
                others = ", ".join(other for other in table if other != "variant")
                yield InputError(where, list(values), f"must be an axis of the study: {others}")
                continue
            if not values:
                yield InputError(where, "[]", "needs at least one value")
            own = list(dict.fromkeys(known[key].values))
            listed = ", ".join(map(str, own[:MOST_NAMED]))
            for value, found in zip(values, standing_for(values, own), strict=True):
                if found is None:
                    yield InputError(where, told(value), f"must be on the study's own axis: {listed}")


def empty(study: StudyFile) -> Iterator[InputError]:
    """Variants along parts of one dimension that have nothing in common."""
    for part in blocks(study):
        for along in (name for name, labels in part.items() if not labels):
            (variant,) = part["variant"]
            yield InputError(f"variants.{variant}.axes", along, "has no label with all of the values given")


def repeated(key: str, values: Iterable[object]) -> Iterator[InputError]:
    for value, count in Counter(values).items():
        if count > 1:
            yield InputError(key, value, f"given {count} times, must be unique")
