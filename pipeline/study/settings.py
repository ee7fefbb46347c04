"""The tables of what is recorded and of numerical choices."""

from __future__ import annotations

from dataclasses import fields
from typing import TYPE_CHECKING, Annotated, Literal

from pydantic import AfterValidator, Field, model_validator

from pipeline.study.tables import NotNegative, Number, Table, fields_of
from solver import scene as physics

DEFAULT = physics.Settings()
RULES = ("fatigue", "utilisation")  # outputs with a table of their own


# An id leaves out what is at its default: whoever changes a default raises tasks.task.MODEL_VERSION.
@fields_of(physics.Fatigue)
class Fatigue(Table):
    """By which rules damage is reckoned, where `outputs` ask for it."""


@fields_of(physics.Utilisation)
class Utilisation(Table):
    """By which factors tubes are utilised (NORSOK N-004, 6.3), where `outputs` ask for it."""


def _once(outputs: tuple[str, ...]) -> tuple[str, ...]:
    """In one order, each once: one meaning, one identity."""
    return tuple(name for name in physics.OUTPUTS if name in outputs)


@fields_of(physics.Settings, ("duration", "discard", "ramp", "ramp_form", "rao", "spectra", "outputs"))
class Recording(Table):
    """What of the simulated time is analysed."""

    duration: Annotated[Number, Field(ge=1, le=1e6)] = DEFAULT.duration
    discard: Annotated[NotNegative, Field(le=1e5)] = DEFAULT.discard
    series: Annotated[
        Literal["none", "decimated", "full"],
        "Time series that records keep; decimated: four samples in the shortest wave",
    ] = "none"
    outputs: Annotated[
        tuple[physics.Output, ...],
        AfterValidator(_once),
        "What else is put out: of an elastic platform's steel, of power take-offs, and mean and slow drift of floats",
    ] = ()
    fatigue: Annotated[Fatigue, "By which rules damage is reckoned"] = Fatigue()
    utilisation: Annotated[Utilisation, "By which factors tubes are utilised"] = Utilisation()
    if TYPE_CHECKING:
        ramp: float = DEFAULT.ramp
        rao: bool = DEFAULT.rao
        spectra: bool = DEFAULT.spectra

    def deciding(self, steel: bool) -> Recording:
        """Without the rules of outputs that there are not, for want of an elastic platform or because none asks."""
        idle = (name for name in RULES if not steel or name not in self.outputs)
        return self.model_copy(update={name: type(self).model_fields[name].default for name in idle})


@fields_of(physics.Settings, {f.name for f in fields(physics.Settings)} - {*Recording.model_fields, "keep_series"})
class Solver(Table):
    """Numerical choices, as the solver names and defaults them."""

    if TYPE_CHECKING:
        froude_krylov: str = DEFAULT.froude_krylov
        interaction: bool = DEFAULT.interaction
        gap_damping: float = DEFAULT.gap_damping
        gap_width: float = DEFAULT.gap_width
        method: str = DEFAULT.method
        accuracy: str = DEFAULT.accuracy
        tolerance: float | None = DEFAULT.tolerance
        time_step: float | None = DEFAULT.time_step

    @model_validator(mode="after")
    def _linear_where_nothing_else_is(self) -> Solver:
        """Left to default, Froude-Krylov forces are linear in the frequency domain; not a key that was set, though."""
        if self.method == "frequency" and "froude_krylov" not in self.model_fields_set:
            self.__dict__["froude_krylov"] = "linear"
        return self
