"""Waves and sea states: their tables, and the frequencies they need."""

from __future__ import annotations

import math
from typing import Annotated, Any, Literal

import numpy as np
from pydantic import AfterValidator, Discriminator, Field, Tag

from pipeline.study import columns
from pipeline.study.attachments import File
from pipeline.study.tables import Count, Number, Positive, Seed, Table, Unit, divisible

# The classes of solver.sea.spectrum that have a peak, in lower case; their fields besides Hs and Tp are keys below.
Shape = Literal["pierson-moskowitz", "jonswap"]
FURTHER: dict[Shape, tuple[str, ...]] = {"pierson-moskowitz": ("form",), "jonswap": ("gamma",)}
Form = Literal["peak", "mean"]  # "mean": Tp holds the mean period T1, as in the Pierson-Moskowitz form of ITTC
Frequency = Annotated[float, Field(strict=True, allow_inf_nan=False, gt=0, le=100), AfterValidator(divisible)]
Gamma = Annotated[Number, Field(ge=1, le=7), Unit("-")]


# Ends of the band of an irregular sea without waves.band, over its peak's frequency. Of Pierson-Moskowitz's variance
# exp(-5/4 / x^4) lies below x: 2e-9 below the first; and 1.5 % above the second, where waves are short and steps small.
USUAL_BAND = (0.5, 3.0)
FINE = 4  # steps of an octave in which the upper end of what coefficients must cover goes
DIGITS = 9  # of a number of steps
PEAK_OVER_MEAN = 2 * math.pi / (0.8 * 692) ** 0.25  # Tp / T1 of Pierson-Moskowitz, in the form of ITTC
SHAPE = "spectrum", "form", "gamma"  # keys of [waves] that a sea may have, too
PERIOD = "What Tp holds: the peak period, or the mean period T1"


class Waves(Table):
    """What sea states have in common: shape, frequencies, direction."""

    spectrum: Annotated[Shape, "Spectrum of irregular seas"] = "pierson-moskowitz"
    form: Annotated[Form, PERIOD] = "peak"
    gamma: Annotated[Gamma, "Peak enhancement of JONSWAP"] = 3.3
    components: Annotated[Count, Field(le=10_000), "Number of waves in a realization of a random sea"] = 130
    band: Annotated[
        tuple[Frequency, Frequency] | None,
        Unit("rad/s"),
        "Frequencies of random waves; left out, half to three times the peak's of each irregular sea",
    ] = None
    intervals: Annotated[
        Literal["random", "even"], "Widths of the band's intervals; with even ones the sea repeats itself"
    ] = "random"
    heading: Annotated[
        Number, Field(ge=-2 * math.pi, le=2 * math.pi), Unit("rad"), "Where waves go: 0 along +x, positive to +y"
    ] = 0.0
    base_seed: Annotated[Seed, "Other phases of all realizations"] = 0


KIND = "Kind of sea"


class Sea(Table):
    """What every sea state may have."""

    occurrence: Annotated[
        Positive | None, "How often it comes, hours a year or any such weight: of means over sea states, no task"
    ] = None


class Irregular(Sea):
    """Random waves: a row of a scatter table, with the shape of [waves] unless it says otherwise."""

    kind: Annotated[Literal["irregular"], KIND] = "irregular"
    Hs: Annotated[Positive, Unit("m"), "Significant wave height"]
    Tp: Annotated[Positive, Unit("s"), "Peak period"]
    spectrum: Annotated[Shape | None, "Another spectrum than that of [waves]"] = None
    form: Annotated[Form | None, PERIOD] = None
    gamma: Annotated[Gamma | None, "Peak enhancement of JONSWAP"] = None


class WhiteNoise(Sea):
    """Random waves of the same density everywhere in waves.band."""

    kind: Annotated[Literal["white-noise"], KIND]
    Hs: Annotated[Positive, Unit("m"), "Significant wave height"]


class MeasuredSpectrum(Sea):
    """Random waves with a spectrum from a file: omega [rad/s], S [m2 s/rad] (or frequency [Hz], S [m2/Hz])."""

    kind: Annotated[Literal["spectrum"], KIND]
    file: Annotated[File, "CSV file beside the study: omega [rad/s], S [m2 s/rad]"]


class Regular(Sea):
    """One wave of this height, crest to trough: height/2 cos(omega t - phase) at the origin."""

    kind: Annotated[Literal["regular"], KIND]
    height: Annotated[Positive, Unit("m"), "Wave height, crest to trough"]
    period: Annotated[Positive, Unit("s"), "Wave period"]
    phase: Annotated[Number, Unit("rad"), "At the origin: height/2 cos(omega t - phase)"] = 0.0


class Components(Sea):
    """Waves one by one from a file: amplitude [m], omega [rad/s] (or frequency [Hz]), phase [rad]."""

    kind: Annotated[Literal["components"], KIND]
    file: Annotated[
        File, "CSV file beside the study: amplitude [m], omega [rad/s], phase [rad], of amplitude cos(omega t - phase)"
    ]


class Elevation(Sea):
    """A measured record at the origin from a file: time [s], elevation [m]; its lines in waves.band are kept."""

    kind: Annotated[Literal["elevation"], KIND]
    file: Annotated[File, "CSV file beside the study: time [s], elevation [m]"]


class Still(Sea):
    """No waves: free decay from the floats' offsets."""

    kind: Annotated[Literal["still"], KIND]


def _kind(table: Any) -> str:
    return f"<{table.get('kind', 'irregular') if isinstance(table, dict) else getattr(table, 'kind', 'irregular')}>"


SeaState = Annotated[
    Annotated[Irregular, Tag("<irregular>")]
    | Annotated[WhiteNoise, Tag("<white-noise>")]
    | Annotated[MeasuredSpectrum, Tag("<spectrum>")]
    | Annotated[Regular, Tag("<regular>")]
    | Annotated[Components, Tag("<components>")]
    | Annotated[Elevation, Tag("<elevation>")]
    | Annotated[Still, Tag("<still>")],
    Discriminator(_kind),
]


def is_random(sea: SeaState) -> bool:
    """Whether realizations differ; otherwise seeds and numbers of components decide nothing."""
    return isinstance(sea, (Irregular, WhiteNoise, MeasuredSpectrum))


def labels(sea: SeaState, waves: Waves) -> dict[str, float]:
    """The numbers by which people know a sea state, and how often it comes, as coordinates of the dataset."""
    return _known(sea, waves) | ({} if sea.occurrence is None else {"occurrence": sea.occurrence})


def _known(sea: SeaState, waves: Waves) -> dict[str, float]:
    match sea:
        case Irregular():
            return {"Hs": sea.Hs, "Tp": sea.Tp * _peak_over(sea, waves)}
        case WhiteNoise():
            return {"Hs": sea.Hs}
        case Regular():
            return {"wave_height": sea.height, "wave_period": sea.period}
        case _:
            return {}


def _peak_over(sea: Irregular, waves: Waves) -> float:
    """The spectrum's peak period over what the key Tp holds."""
    mean = (sea.spectrum or waves.spectrum, sea.form or waves.form) == ("pierson-moskowitz", "mean")
    return PEAK_OVER_MEAN if mean else 1.0


def height(sea: SeaState) -> float:
    """Significant wave height [m]: the one given, or 4√m₀ of what a file has; 0 of a regular wave and of none."""
    match sea:
        case Irregular() | WhiteNoise():
            return sea.Hs
        case MeasuredSpectrum():
            omega, density = columns.read(sea.file, ("omega", "S")).values()
            columns.require_rising(sea.file, "omega", omega)
            variance = np.trapezoid(density, omega)
        case Components():
            amplitude, omega, phase = columns.read(sea.file, ("amplitude", "omega", "phase")).values()
            _, of = np.unique(omega, return_inverse=True)  # waves of one frequency are one wave
            waves = np.bincount(of, amplitude * np.cos(phase)), np.bincount(of, amplitude * np.sin(phase))
            variance = np.sum(np.square(waves)) / 2
        case Elevation():
            variance = np.var(columns.read(sea.file, ("elevation",))["elevation"])
        case _:
            return 0.0
    return 4 * math.sqrt(float(variance))


def deciding(sea: SeaState, waves: Waves) -> tuple[SeaState, Waves]:
    """Both without what decides nothing in this sea, as how often it comes; what it says of its shape goes to [waves].

    Ids of old results have three exceptions: a spectrum stays in the sea that alone has it, where it is not the usual
    one, [waves] keep theirs in seas that have no such shape, and their band and heading in still water.
    """
    sea = sea.model_copy(update={"occurrence": None})
    if not is_random(sea):
        return sea, Waves(band=waves.band, heading=waves.heading)
    usual = Waves()
    if not isinstance(sea, Irregular):
        return sea, waves.model_copy(update={"form": usual.form, "gamma": usual.gamma})
    word = sea.spectrum or waves.spectrum
    shape = {"spectrum": word} | shaping(sea, waves)
    none = dict.fromkeys(SHAPE)
    default = {key: getattr(usual, key) for key in SHAPE}
    if word in (waves.spectrum, usual.spectrum):
        return sea.model_copy(update=none), waves.model_copy(update=default | shape)
    return sea.model_copy(update=none | shape), waves.model_copy(update=default)


def shaping(sea: Irregular, waves: Waves) -> dict[str, Any]:
    """What a spectrum takes besides height and period; what the sea leaves open is as in [waves]."""
    return {key: getattr(sea, key) or getattr(waves, key) for key in FURTHER[sea.spectrum or waves.spectrum]}


def frequencies(sea: SeaState, waves: Waves) -> tuple[float, float] | None:
    """Lowest and highest frequency of the waves [rad/s]; None in still water, or where waves.band is missing."""
    match sea:
        case Still():
            return None
        case Regular():
            return (2 * math.pi / sea.period,) * 2
        case Components():
            omega = columns.read(sea.file, ("omega",))["omega"]
            return float(omega.min()), float(omega.max())
        case MeasuredSpectrum() if waves.band is None:
            omega = columns.read(sea.file, ("omega",))["omega"]
            return float(omega[omega > 0].min(initial=math.inf)), float(omega.max())
        case Irregular() if waves.band is None:
            peak = 2 * math.pi / sea.Tp / _peak_over(sea, waves)
            return USUAL_BAND[0] * peak, USUAL_BAND[1] * peak
        case _:
            return waves.band


def band(sea: SeaState, waves: Waves, least: float = 0.0, unit: float = 1.0) -> tuple[float, float] | None:
    """Frequencies that coefficients must cover; None if any will do.

    Without waves.band steps of an octave at its low end and a quarter of one at its high, where panels cost with ω⁸, so
    that waves of about the same period share their coefficients; not below `least` [rad/s], where the waves are not.
    The steps are of `unit` [rad/s], which goes with the scene's size, so that a model has its original's.
    """
    if waves.band is not None or (span := frequencies(sea, waves)) is None:
        return waves.band
    low, high = span
    # Rounded: a model's are its original's but for the last digits.
    below = unit * 2.0 ** math.floor(round(math.log2(low / unit), DIGITS))
    above = unit * 2.0 ** (math.ceil(round(FINE * math.log2(high / unit), DIGITS)) / FINE)
    return max(below, min(low, least)), above
