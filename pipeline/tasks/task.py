"""A study as a product of axes; a task as its parameters, whose hash is its name."""

from __future__ import annotations

import hashlib
import itertools
import json
import math
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence, Set
from dataclasses import dataclass
from functools import cached_property, lru_cache, partial
from typing import Any, NamedTuple

from pipeline.study import seas
from pipeline.study.attachments import Attachment, CoefficientFile
from pipeline.study.floats import Float
from pipeline.study.layout import hinge_nodes, spaced
from pipeline.study.paths import keys_at, with_values
from pipeline.study.platform import Platform
from pipeline.study.schema import Current, StudyFile, Water
from pipeline.study.seas import SeaState, Waves
from pipeline.study.settings import Recording, Solver
from pipeline.study.tables import Same, Seed, Table, Vector
from pipeline.study.words import last, told, word

# Raise it when the physics or a default changes: older results then count as stale, not as done.
MODEL_VERSION = 58
AXES = ("sea_state", "platform", "pto_damping", "hinge_spacing", "seed")

Label = str | float | int


class Parameters(Table):
    """All that decides a task's numbers, and nothing else: labels and order are not in it."""

    water: Water
    waves: Waves = Waves()
    sea_state: SeaState
    record: Recording = Recording()
    solver: Solver = Solver()
    floats: tuple[Float, ...] = ()
    platform: Platform | None = None
    current: Current | None = None
    coefficients: CoefficientFile | None = None
    seed: Seed = 0

    def canonical(self) -> str:
        """One text for one physics: declared types, sorted keys, nothing that is at its default."""
        texts = ((name, _text(getattr(self, name))) for name in sorted(type(self).model_fields) if self._told(name))
        return "{" + ",".join(f'"{name}":{text}' for name, text in texts) + "}"

    def _told(self, name: str) -> bool:
        field = type(self).model_fields[name]
        return field.is_required() or getattr(self, name) != field.default


@dataclass(frozen=True, kw_only=True)
class Task:
    """A cell of the study: its labels along the axes, and its parameters."""

    labels: Mapping[str, Label]
    make: Callable[[], Parameters]  # not the parameters themselves: a million tasks must be small
    version: int = MODEL_VERSION
    varied: tuple[str, ...] = AXES  # the axes worth naming, for people
    known: str = ""  # its id, if that is known already

    @cached_property
    def parameters(self) -> Parameters:
        """All that decides its numbers."""
        return self.make()

    @cached_property
    def id(self) -> str:
        """Same physics, same folder, on every machine."""
        return self.known or digest(self.parameters.canonical(), self.version)

    @property
    def older_versions(self) -> range:
        """Earlier model versions, newest first."""
        return range(self.version - 1, 0, -1)

    def under(self, versions: Sequence[int]) -> list[str]:
        """Names of the same task under model versions."""
        text = self.parameters.canonical() if versions else ""
        return [digest(text, version) for version in versions]

    @property
    def written_labels(self) -> dict[str, Label]:
        """As JSON can hold them, which has no infinity."""
        return {k: v if isinstance(v, str) or math.isfinite(v) else str(v) for k, v in self.labels.items()}

    def __str__(self) -> str:
        return ",".join(f"{axis}={label}" for axis, label in self.labels.items() if axis in self.varied)


def digest(text: str, version: int) -> str:
    """16 hexadecimal digits: two of a million tasks collide with a chance of 3e-8."""
    return hashlib.sha256(f"{version}:{text}".encode()).hexdigest()[:16]


def canonical(data: Any) -> str:
    """JSON with sorted keys; -0.0 is written as 0.0, for they are the same number."""
    return json.dumps(_plain_zeros(data), sort_keys=True, allow_nan=False, separators=(",", ":"))


def _text(value: Any) -> str:
    """Of a table, of several, of a file, or of a number."""
    if isinstance(value, Table):
        return _table_text(Same(value))
    if isinstance(value, Attachment):
        return canonical(value.identity)
    return f"[{','.join(map(_text, value))}]" if isinstance(value, tuple) else canonical(value)


@lru_cache(maxsize=1024)
def _table_text(same: Same[Table]) -> str:
    """Tasks share most of their tables, and a platform's is long."""
    return canonical(same.table.model_dump(mode="json", exclude_defaults=True))


def _plain_zeros(data: Any) -> Any:
    if isinstance(data, dict):
        return {key: _plain_zeros(value) for key, value in data.items()}
    if isinstance(data, list):
        return [_plain_zeros(value) for value in data]
    return data + 0.0 if isinstance(data, float) else data


def wave_seed(parameters: Parameters) -> tuple[int, ...]:
    """Entropy of the wave record: study's base seed, the sea itself, number of the realization.

    Not the task: an elastic and a fixed platform meet the same waves.
    """
    words = _sea_words(Same(parameters.sea_state), Same(parameters.waves))
    return parameters.waves.base_seed, *words, parameters.seed


@lru_cache(maxsize=128)  # one for tasks that share it
def _sea_words(sea_state: Same[SeaState], waves: Same[Waves]) -> tuple[int, ...]:
    sea = {
        "sea_state": sea_state.table.model_dump(mode="json", exclude_defaults=True),
        "waves": waves.table.model_dump(mode="json", exclude_defaults=True, exclude={"base_seed", "heading"}),
    }
    words = hashlib.sha256(canonical(sea).encode()).digest()
    return tuple(int.from_bytes(words[i : i + 4], "little") for i in range(0, 16, 4))


def axes(study: StudyFile) -> dict[str, tuple[Label, ...]]:
    """Values along every axis; an axis that neither the study nor its floats give is left out."""
    listed = study.axes
    values_of: dict[str, tuple[Label, ...] | None] = {
        "sea_state": listed.sea_state or tuple(study.sea_states),
        "platform": supports(study),
        "pto_damping": listed.pto_damping or _common_damping(study),
        "hinge_spacing": listed.hinge_spacing or _spacing(study),
        **{axis.name: axis.labels for axis in study.varied},
        "seed": listed.seed or (0,),
    }
    return {name: values for name, values in values_of.items() if values}


def at_labels(study: StudyFile, labels: Mapping[str, Label]) -> StudyFile:
    """The study with the keys that its axes vary at what these labels stand for; PathError where that cannot be."""
    return _placed(Same(study), tuple(axis.labels.index(labels[axis.name]) for axis in study.varied))


def sea_at(study: StudyFile, labels: Mapping[str, Label]) -> tuple[SeaState, Waves]:
    """The sea with these labels, and what it has in common with others."""
    study = at_labels(study, labels)
    return study.sea_states[str(labels["sea_state"])], study.waves


@lru_cache(maxsize=128)  # the last axes vary fastest: tasks one after another share what the first ones make
def _placed(same: Same[StudyFile], places: tuple[int, ...]) -> StudyFile:
    """The study with its first axes over keys at these places."""
    if not places:
        return same.table
    axis = same.table.varied[len(places) - 1]
    return with_values(_placed(same, places[:-1]), axis.at(places[-1]))


def first_labels(study: StudyFile) -> dict[str, Label]:
    """Of the first task: where variants go along parts of axes, of the first one's."""
    return firsts(study)({})


def firsts(study: StudyFile) -> Callable[[Mapping[str, Label]], dict[str, Label]]:
    """What gives the labels of the first task, variant by variant, that has some of them; none where no task has."""
    table, parts = axes(study), blocks(study)

    def first(wanted: Mapping[str, Label]) -> dict[str, Label]:
        for part in parts:
            if all(label in part.get(name, (label,)) for name, label in wanted.items()):
                return {**{name: next(iter(part.get(name, values))) for name, values in table.items()}, **wanted}
        return {}

    return first


def supports(study: StudyFile) -> tuple[str, ...]:
    """The platform axis; without it, elastic if there is a platform and fixed if there is none."""
    return study.axes.platform or (("elastic",) if study.platform else ("fixed",))


def dimensions(study: StudyFile) -> list[str]:
    """The axes that are dimensions of the dataset: those listed, and sea states if there are several."""
    given = {axis.name for axis in study.varied} | {name for name in AXES if getattr(study.axes, name)}
    return [name for name, values in axes(study).items() if name in given or len(values) > 1]


class Coordinate(NamedTuple):
    """A value with each label of a dimension: the label itself, or that of a key."""

    key: str
    dimension: str
    values: tuple[Label, ...]


def coordinates(study: StudyFile) -> dict[str, Coordinate]:
    """What goes along the axes, by each of its names: a dimension's, a key's path, the dataset's for it."""
    found: dict[str, Coordinate] = {}
    for axis in study.varied:
        for key, values in axis.coordinates.items():
            one = Coordinate(axis.name if axis.own else key, axis.name, values)
            found |= {key: one, axis.names.get(key, key): one}
    return found | {name: Coordinate(name, name, values) for name, values in axes(study).items()}


def blocks(study: StudyFile) -> list[dict[str, Set[Label]]]:
    """The parts that make up the study, as labels along some axes, in their order: all of it, or one a variant."""
    if not any(variant.axes for variant in study.variants.values()):
        return [{}]
    table, known = axes(study), coordinates(study)
    parts: list[dict[str, Set[Label]]] = []
    for name, variant in study.variants.items():
        part: dict[str, Set[Label]] = {"variant": {name}}
        for key, values in variant.axes.items():
            _, along, own = known[key]
            wanted = set(standing_for(values, own))
            labels = (label for label, value in zip(table[along], own, strict=True) if value in wanted)
            part[along] = dict.fromkeys(label for label in labels if label in part.get(along, table[along])).keys()
        parts.append(part)
    return parts


def standing_for(values: Iterable[object], labels: Sequence[Label]) -> list[Label | None]:
    """The label that each value stands for, however a file gives it: 2018 is "2018", too; None where there is none."""
    same, written = {label: label for label in labels}, {word(label): label for label in labels}
    return [same.get(told(value), written.get(word(value))) for value in values]


def expand(study: StudyFile) -> Iterator[Task]:
    """All tasks, the last axis fastest."""
    table, varied, parts = axes(study), tuple(dimensions(study)), blocks(study)
    for values in itertools.product(*table.values()):
        labels = dict(zip(table, values, strict=True))
        if any(all(labels[name] in part[name] for name in part) for part in parts):
            yield cell(study, labels, varied)


def cell(study: StudyFile, labels: Mapping[str, Label], varied: tuple[str, ...], known: str = "") -> Task:
    """The task with these labels."""
    return Task(labels=labels, make=partial(_parameters, study, labels), varied=varied, known=known)


def _parameters(study: StudyFile, labels: Mapping[str, Label]) -> Parameters:
    study = at_labels(study, labels)
    sea = study.sea_states[str(labels["sea_state"])]
    apart: frozenset[str] = frozenset()
    if study.survival and seas.height(sea) > study.survival.Hs:
        study, apart = surviving(Same(study)), _damped_apart(Same(study))
    spacing = float(labels["hinge_spacing"]) if study.axes.hinge_spacing else None
    floats = _floats(Same(study), spacing, labels["pto_damping"] if study.axes.pto_damping else None, apart)
    platform = None
    if study.platform and labels["platform"] != "fixed":
        platform = _with_hinges(Same(study.platform), tuple(hinge_nodes(floats).items()))
    floats = (
        () if labels["platform"] == "elastic-no-floats" else tuple(f for f in floats if f.name not in study.left_out)
    )
    alone, waves = _deciding(Same(sea), Same(study.waves))
    return Parameters(
        water=study.water,
        waves=waves,
        sea_state=alone,
        record=_recording(Same(study.record), platform is not None),
        solver=study.solver,
        floats=floats,
        platform=platform,
        current=study.current if platform else None,
        coefficients=study.coefficients if floats else None,
        seed=int(labels["seed"]) if seas.is_random(sea) else 0,
    )


@lru_cache(maxsize=128)  # one for tasks that share it
def _deciding(sea: Same[SeaState], waves: Same[Waves]) -> tuple[SeaState, Waves]:
    return seas.deciding(sea.table, waves.table)


@lru_cache(maxsize=128)  # one for tasks that share it
def _recording(record: Same[Recording], steel: bool) -> Recording:
    return record.table.deciding(steel)


@lru_cache(maxsize=128)  # one for tasks that share it
def surviving(same: Same[StudyFile]) -> StudyFile:
    """The study with the values that hold above survival.Hs; PathError where that cannot be."""
    keys = dict(same.table.survival.keys) if same.table.survival else {}
    if "left_out" in keys:  # what the study leaves out does not come back
        keys["left_out"] = [*dict.fromkeys([*same.table.left_out, *keys["left_out"]])]
    return with_values(same.table, keys)


@lru_cache(maxsize=128)  # one for tasks that share it
def _damped_apart(same: Same[StudyFile]) -> frozenset[str]:
    """Floats whose damping in high seas is that of [survival], whatever it is along its axis."""
    paths = same.table.survival.keys if same.table.survival else ()
    keys = [key for path in paths for key in keys_at(same.table, path)]
    return frozenset(key[1] for key in keys if key[0] == "floats" and "pto_damping" in key[2:3])


@lru_cache(maxsize=128)  # one for tasks that share it
def _with_hinges(same: Same[Platform], hinges: tuple[tuple[str, Vector], ...]) -> Platform:
    return same.table.model_copy(update={"nodes": {**same.table.nodes, **dict(hinges)}})


@lru_cache(maxsize=128)  # one for tasks that share it
def _floats(
    same: Same[StudyFile], spacing: float | None, damping: Label | None, apart: frozenset[str]
) -> tuple[Float, ...]:
    """With the hinges so far apart and that damping, where these vary, but of floats that are damped apart."""
    floats = same.table.floats
    if spacing is not None:
        floats = spaced(floats, spacing)
    if damping is not None:
        along = {f.name for f in floats if f.motion} - apart
        floats = tuple(f.model_copy(update={"pto_damping": damping}) if f.name in along else f for f in floats)
    return floats


def _common_damping(study: StudyFile) -> tuple[float, ...] | None:
    if _varies_floats(study, "pto_damping", "motion"):
        return None
    values = {f.pto_damping for f in study.floats if f.motion}
    common = values.pop() if len(values) == 1 else None
    return (common,) if isinstance(common, float) else None


def _varies_floats(study: StudyFile, *keys: str) -> bool:
    """Whether an axis over a path varies one of these keys of a float."""
    paths = (path for axis in study.varied for path in axis.keys)
    return any(path.startswith("floats.") and last(path).partition(".")[0] in keys for path in paths)


def _spacing(study: StudyFile) -> tuple[float, ...] | None:
    if (
        _varies_floats(study, "hinge", "motion")
        or len(study.floats) != 2
        or any(f.motion != ("hinge",) for f in study.floats)
    ):
        return None
    a, b = (f.hinge[0] for f in study.floats)
    return (abs(a - b),)
