"""A sea state's tables -> the solver's spectrum, and its realization."""

from __future__ import annotations

import dataclasses
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, Protocol, assert_never

import numpy as np

from pipeline.study import columns
from pipeline.study.seas import (
    Components,
    Elevation,
    Irregular,
    MeasuredSpectrum,
    Regular,
    SeaState,
    Shape,
    Still,
    Waves,
    WhiteNoise,
    frequencies,
    shaping,
)
from solver.errors import InputError

if TYPE_CHECKING:
    from solver.sea.realization import Realization
    from solver.sea.spectrum import Spectrum


class Peaked(Protocol):
    """A spectrum of wind waves: besides its height and density, where that is largest."""

    @property
    def Hs(self) -> float:
        """[m]."""

    @property
    def peak_frequency(self) -> float:
        """[rad/s]."""

    def density(self, omega: np.ndarray) -> np.ndarray:
        """S(ω) [m² s/rad]."""


COLUMNS = {  # that the files of seas are read for
    MeasuredSpectrum: ("omega", "S"),
    Components: ("amplitude", "omega", "phase"),
    Elevation: ("time", "elevation"),
}


def realize(sea: SeaState, waves: Waves, seed: Sequence[int]) -> Realization:
    """The solver's realization, which tells of columns that its file has for nothing; raises InputError."""
    made = _realize(sea, waves, seed)
    if not isinstance(sea, MeasuredSpectrum | Components | Elevation):
        return made
    others = columns.unread(sea.file, COLUMNS[type(sea)])
    notes = [f"{sea.file} has columns that are not read: {', '.join(others)}"] if others else []
    return dataclasses.replace(made, notes=(*made.notes, *notes))


def _realize(sea: SeaState, waves: Waves, seed: Sequence[int]) -> Realization:
    from solver.sea import realization as make

    match sea:
        case Still():
            return dataclasses.replace(make.CALM, heading=waves.heading)
        case Regular():
            return make.regular(height=sea.height, period=sea.period, phase=sea.phase, heading=waves.heading)
        case Components():
            lines = columns.read(sea.file, COLUMNS[Components])
            return make.components(**lines, heading=waves.heading)
        case Elevation():
            record = columns.read(sea.file, COLUMNS[Elevation])
            return make.measured(**record, band=_needed(waves.band), heading=waves.heading)
        case Irregular() | WhiteNoise() | MeasuredSpectrum():
            return make.realize(
                spectrum(sea, waves),
                components=waves.components,
                band=_needed(frequencies(sea, waves)),
                intervals=waves.intervals,
                heading=waves.heading,
                seed=seed,
            )
        case _:
            assert_never(sea)


def _needed(span: tuple[float, float] | None) -> tuple[float, float]:
    if span is None:
        raise InputError("waves.band", "nothing", "is missing [rad/s]")
    return span


def spectrum(sea: Irregular | WhiteNoise | MeasuredSpectrum, waves: Waves) -> Spectrum:
    """The solver's spectrum of a random sea."""
    from solver.sea import spectrum as shapes

    match sea:
        case WhiteNoise():
            return shapes.WhiteNoise(Hs=sea.Hs, band=_needed(waves.band))
        case MeasuredSpectrum():
            table = columns.read(sea.file, COLUMNS[MeasuredSpectrum])
            columns.require_rising(sea.file, "omega", table["omega"])
            return shapes.Tabulated(**table)
        case Irregular():
            return shape(sea, waves)


def shape(sea: Irregular, waves: Waves) -> Peaked:
    """The solver's spectrum with a peak; what the sea state leaves open is as in [waves]."""
    made: Peaked = _class(sea.spectrum or waves.spectrum)(Hs=sea.Hs, Tp=sea.Tp, **shaping(sea, waves))
    return made


def _class(word: Shape) -> Any:
    """pierson-moskowitz -> PiersonMoskowitz."""
    from solver.sea import spectrum as shapes

    return getattr(shapes, "".join(part.capitalize() for part in word.split("-")))
