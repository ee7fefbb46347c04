"""A sea state's tables -> the solver's spectrum, and its realization."""

from __future__ import annotations

import dataclasses
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, Protocol, assert_never

import numpy as np

from pipeline.study import columns
from pipeline.study.seas import (
    FURTHER,
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


def realize(sea: SeaState, waves: Waves, seed: Sequence[int]) -> Realization:
    """The solver's realization; raises InputError."""
    from solver.sea import realization as make

    match sea:
        case Still():
            return dataclasses.replace(make.CALM, heading=waves.heading)
        case Regular():
            return make.regular(height=sea.height, period=sea.period, phase=sea.phase, heading=waves.heading)
        case Components():
            lines = columns.read(sea.file, ("amplitude", "omega", "phase"))
            return make.components(**lines, heading=waves.heading)
        case Elevation():
            record = columns.read(sea.file, ("time", "elevation"))
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
            table = columns.read(sea.file, ("omega", "S"))
            columns.require_rising(sea.file, "omega", table["omega"])
            return shapes.Tabulated(**table)
        case Irregular():
            return shape(sea, waves)


def shape(sea: Irregular, waves: Waves) -> Peaked:
    """The solver's spectrum with a peak; what the sea state leaves open is as in [waves]."""
    word = sea.spectrum or waves.spectrum
    further = {key: getattr(sea, key) or getattr(waves, key) for key in FURTHER[word]}
    made: Peaked = _class(word)(Hs=sea.Hs, Tp=sea.Tp, **further)
    return made


def _class(word: Shape) -> Any:
    """pierson-moskowitz -> PiersonMoskowitz."""
    from solver.sea import spectrum as shapes

    return getattr(shapes, "".join(part.capitalize() for part in word.split("-")))
