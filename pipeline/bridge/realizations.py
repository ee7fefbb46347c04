"""A sea state's tables -> the solver's spectrum, and its realization."""

from __future__ import annotations

import dataclasses
from collections.abc import Sequence
from typing import TYPE_CHECKING, assert_never

from pipeline.study import columns
from pipeline.study.seas import (
    Components,
    Elevation,
    Irregular,
    MeasuredSpectrum,
    Regular,
    SeaState,
    Still,
    Waves,
    WhiteNoise,
    frequencies,
)
from solver.errors import InputError

if TYPE_CHECKING:
    from solver.sea.realization import Realization
    from solver.sea.spectrum import Jonswap, PiersonMoskowitz, Spectrum


def realize(sea: SeaState, waves: Waves, seed: Sequence[int]) -> Realization:
    """The solver's realization; raises InputError."""
    from solver.sea import realization as make

    match sea:
        case Still():
            return dataclasses.replace(make.CALM, heading=waves.heading)
        case Regular():
            return make.regular(height=sea.height, period=sea.period, phase=sea.phase, heading=waves.heading)
        case Components():
            given = columns.read(sea.file, ("amplitude", "omega", "phase"))
            return make.components(**given, heading=waves.heading)
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
            return shapes.Tabulated(**columns.read(sea.file, ("omega", "S")))
        case Irregular():
            return shape(sea, waves)


def shape(sea: Irregular, waves: Waves) -> Jonswap | PiersonMoskowitz:
    """The solver's spectrum with a peak."""
    from solver.sea import spectrum as shapes

    if (sea.spectrum or waves.spectrum) == "jonswap":
        return shapes.Jonswap(Hs=sea.Hs, Tp=sea.Tp, gamma=sea.gamma or waves.gamma)
    return shapes.PiersonMoskowitz(Hs=sea.Hs, Tp=sea.Tp, form=sea.form or waves.form)
