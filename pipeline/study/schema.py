"""The tables of a study file: names, types, units, ranges. Lengths in m, masses in kg, all SI."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, get_args

from pydantic import AfterValidator, Field, PrivateAttr, ValidationInfo, model_validator

from pipeline.study.attachments import CoefficientFile
from pipeline.study.axes import Axes, Axis, Samples, Survival, Variant, implied_sea, named, variant_axis
from pipeline.study.floats import Float
from pipeline.study.platform import Platform
from pipeline.study.seas import SeaState, Waves
from pipeline.study.settings import Recording, Solver
from pipeline.study.tables import Depth, Label, Name, Table, Title, fields_of, tables, unit_of
from solver import scene as physics
from solver.sea.current import Current as Stream
from solver.sea.current import CurrentSpeed


@fields_of(physics.Water)
class Water(Table):
    """Still water of constant depth."""

    depth: Depth  # inf for deep water
    if TYPE_CHECKING:
        density: float
        gravity: float


@fields_of(CurrentSpeed)
class CurrentLine(Table):
    """Speed of the current at a depth: straight between the lines of the table, level beyond them."""


@fields_of(Stream)
class Current(Table):
    """A steady current, which the drag of the platform's members feels; waves on it are as in still water."""

    profile: Annotated[tuple[CurrentLine, ...], "Speeds by depth, downwards, in place of `speed` and `exponent`"] = ()


class StudyFile(Table):
    """A whole study file."""

    title: Annotated[Title, "What the study is, in a line"] = ""
    coefficients: Annotated[
        CoefficientFile | None,
        "From others' boundary elements: capytaine's .nc, BEMIO's .h5, WAMIT's .1 (.3, .hst) or .out, Nemoh's .tec; "
        "bodies without the floats' names are the floats in order",
    ] = None
    water: Annotated[Water, "The water"]
    current: Annotated[Current | None, "A steady current"] = None
    waves: Annotated[Waves, "What sea states have in common"] = Waves()
    record: Annotated[Recording, "What is analysed and kept"] = Recording()
    solver: Annotated[Solver, "Numerical choices"] = Solver()
    floats: Annotated[tuple[Float, ...], "The floats, each on its joint"] = ()
    left_out: Annotated[
        tuple[Name, ...],
        AfterValidator(lambda names: tuple(sorted(set(names)))),
        "Floats that are not there, as in a variant with one alone",
    ] = ()
    platform: Annotated[Platform | None, "The elastic platform that carries them"] = None
    axes: Annotated[Axes, "What is varied"] = Axes()
    variants: Annotated[dict[Label, Variant], "Named sets of values, along the dimension variant"] = Field(default={})
    survival: Annotated[Survival | None, "Other values in the sea states above a significant wave height"] = None
    samples: Annotated[Samples | None, "Points of a design space, along the dimension sample"] = None
    sea_states: Annotated[dict[Label, SeaState], "The seas, by label"]
    _folder: Path = PrivateAttr(default=Path())  # of the study file, which files at paths are relative to

    @property
    def context(self) -> dict[str, Path]:
        """That files of other values are to be read in."""
        return {"folder": self._folder}

    @property
    def varied(self) -> tuple[Axis, ...]:
        """The axes over keys: paths and groups, variants, samples."""
        variants = (variant_axis(self.variants),) if self.variants else ()
        samples = (self.samples.axis,) if self.samples else ()
        others = [name for name in ("pto_damping", "hinge_spacing") if getattr(self.axes, name)]
        axes = (*variants, *self.axes.over_keys, *samples)
        if len(self.axes.sea_state or self.sea_states) > 1:  # of which one's Hs is not that of all
            paths = (path.split(".") for axis in axes for path in axis.keys)
            others += [path[-1] for path in paths if path[0] == "sea_states" and path[-1] in ("Hs", "Tp")]
        return named(axes, others)

    @property
    def seas(self) -> dict[str, SeaState]:
        """The sea states that there are tasks in; `base` may bring others."""
        labels = self.axes.sea_state or tuple(self.sea_states)
        return {label: self.sea_states[label] for label in labels if label in self.sea_states}

    @model_validator(mode="after")
    def _keep_folder(self, info: ValidationInfo) -> StudyFile:
        self._folder = (info.context or {}).get("folder", Path())
        return self

    @model_validator(mode="before")
    @classmethod
    def _imply_a_sea(cls, data: Any) -> Any:
        """Axes over keys of the sea need no sea state to start from."""
        if isinstance(data, dict) and "sea_states" not in data and (sea := implied_sea(data.get("axes"))):
            return {**data, "sea_states": {"sea": sea}}
        return data


def units() -> dict[str, str]:
    """Unit of every key that has one; a key means the same in every table."""
    symbols: dict[str, str] = {}
    for table in tables():
        for key, field in table.model_fields.items():
            if (symbol := unit_of(field)) != "-":
                symbols[key] = symbol
    return symbols


def shapes() -> frozenset[str]:
    """Of hulls and sections: what tells their tables apart."""
    fields = (table.model_fields.get("shape") for table in tables())
    return frozenset(word for field in fields if field for word in get_args(field.annotation))
