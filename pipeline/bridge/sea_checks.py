"""Refusals of sea states: breaking waves, waves outside their band, files that hold no sea."""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator
from functools import partial
from typing import get_args

from pipeline.bridge import realizations
from pipeline.bridge.objections import objections
from pipeline.study import seas
from pipeline.study.axes import UNCHANGED
from pipeline.study.schema import StudyFile
from pipeline.study.seas import Components, Elevation, Irregular, Regular, SeaState, Shape, Still, Waves, WhiteNoise
from solver.errors import InputError

LARGEST_PERIOD = 60.0  # longer waves are no longer wind waves [s]
HIGHEST = 100.0  # frequency; shorter waves are ripples [rad/s]
MOST = 10_000  # waves of one sea, from a file


def problems(study: StudyFile) -> Iterator[InputError]:
    """Of the waves, and of every sea state."""
    from solver.sea.realization import require_rising

    waves = study.waves
    if not study.sea_states:
        yield InputError("sea_states", "{}", "needs at least one sea state")
    if waves.band and (falling := list(objections(partial(require_rising, waves.band)))):
        yield from falling
        return
    if waves.form != "peak" and "form" not in seas.FURTHER[waves.spectrum]:
        yield _foreign("waves", "form", waves.form, waves.spectrum)
    # Whatever its value: it decides of no wave, and yet whoever gives it means it to.
    if "gamma" in waves.model_fields_set and not any("gamma" in seas.FURTHER[each] for each in _shapes(study)):
        yield _foreign("waves", "gamma", waves.gamma, waves.spectrum)
    rare = [label for label, sea in study.seas.items() if sea.occurrence is None]
    if 0 < len(rare) < len(study.seas):
        limit = "is missing: all sea states have one, or none"
        yield InputError(f"sea_states.{rare[0]}.occurrence", "nothing", limit)
    for label, sea in study.seas.items():
        key = f"sea_states.{label}"
        alone = list(_sea(key, sea, study))
        yield from alone or [*_coverage(key, sea, study), *_resolution(key, sea, study)]


def highest_frequency(study: StudyFile) -> float:
    """Of all waves in the study [rad/s]; next to nothing if there are none."""
    spans = (seas.frequencies(sea, study.waves) for sea in study.seas.values())
    return max((span[1] for span in spans if span), default=1e-9)


def _sea(key: str, sea: SeaState, study: StudyFile) -> Iterator[InputError]:
    """The sea state by itself."""
    waves = study.waves
    if waves.band is None and isinstance(sea, WhiteNoise | Elevation):
        yield InputError("waves.band", "nothing", f"is missing [rad/s], and {key} is a sea of kind {sea.kind}")
        return
    if isinstance(sea, Irregular):
        yield from _shape(key, sea, study)
        peak = 2 * math.pi / realizations.shape(sea, waves).peak_frequency
        yield from _period(f"{key}.Tp", sea.Tp) or _breaking(f"{key}.Hs", sea.Hs, peak, study)
    elif isinstance(sea, Regular):
        yield from _period(f"{key}.period", sea.period) or _breaking(f"{key}.height", sea.height, sea.period, study)
    elif not isinstance(sea, Still):
        yield from _realization(key, sea, study)


def _shape(key: str, sea: Irregular, study: StudyFile) -> Iterator[InputError]:
    shape = sea.spectrum or study.waves.spectrum
    for name, value in sea:
        known = name in ("kind", "Hs", "Tp", "spectrum", "occurrence", *seas.FURTHER[shape])
        if not known and value not in (None, "peak"):  # whose period is the peak's, form = "peak" is true of it
            yield _foreign(key, name, value, shape)


def _shapes(study: StudyFile) -> Iterator[Shape]:
    """Of [waves], of sea states, and along axes."""
    yield study.waves.spectrum
    yield from (sea.spectrum for sea in study.seas.values() if isinstance(sea, Irregular) and sea.spectrum)
    for axis in study.varied:
        found = (value for path, values in axis.keys.items() if path.endswith(".spectrum") for value in values)
        yield from (value for value in found if value is not UNCHANGED)


def _foreign(key: str, name: str, value: object, shape: Shape) -> InputError:
    """The objection to a key that other spectra have."""
    takers = " or ".join(f'"{each}"' for each in get_args(Shape) if name in seas.FURTHER[each])
    return InputError(f"{key}.{name}", value, f'is for spectrum = {takers}, not "{shape}"')


def _period(key: str, period: float) -> list[InputError]:
    if period > LARGEST_PERIOD:
        return [InputError(key, period, f"must be <= {LARGEST_PERIOD:g} s")]
    shortest = 2 * math.pi / HIGHEST
    return [InputError(key, period, f"must be >= {shortest:.3g} s")] if period < shortest else []


def _breaking(key: str, height: float, period: float, study: StudyFile) -> Iterator[InputError]:
    """The limit of a regular wave; for random ones Hs at a typical period."""
    from solver.sea.dispersion import breaking_height

    limit = breaking_height(period, study.water.depth, study.water.gravity)
    if not height <= limit:
        reason = f"must be <= {limit:.3g} m, where waves of {period:.3g} s break (0.142 L tanh kh)"
        yield InputError(key, height, reason)


def _realization(key: str, sea: SeaState, study: StudyFile) -> Iterator[InputError]:
    """Files and noise have no period in the study file: their realization is judged, by its Hm0 and Tz."""
    try:
        made = realizations.realize(sea, study.waves, (0,))
    except InputError as error:
        where = (
            f"{key}.file" if error.key in ("file", "band") or not hasattr(sea, "file") else f"{key}.file: {error.key}"
        )
        yield InputError(where, getattr(sea, "file", error.value) if error.key == "band" else error.value, error.limit)
        return
    figures = made.parameters()
    if made.omega.size > MOST:
        yield InputError(f"{key}.file", f"{made.omega.size} waves", f"must be <= {MOST}")
    elif not figures["Hm0"] > 0:
        yield InputError(f"{key}.file", getattr(sea, "file", sea.kind), "has no waves in waves.band")
    else:
        name = f"{key}.Hs" if isinstance(sea, WhiteNoise) else f"{key}.file: Hm0"
        yield from _breaking(name, float(f"{figures['Hm0']:.3g}"), figures["Tz"], study)


def _coverage(key: str, sea: SeaState, study: StudyFile) -> Iterator[InputError]:
    """Whether the waves lie in waves.band, and coefficients can be had at their frequencies."""
    from solver.sea.dispersion import SHALLOWEST, first_solved, longest

    waves, water = study.waves, study.water
    span = seas.frequencies(sea, waves)
    if isinstance(sea, Irregular):
        span = (realizations.shape(sea, waves).peak_frequency,) * 2
    if waves.band and span and not isinstance(sea, Elevation | WhiteNoise):
        low, high = waves.band
        if not low <= span[0] <= span[1] <= high:
            name, value, what = named(key, sea)
            outside = span[1] if span[1] > high else span[0]
            limit = f"must put {what}, {outside:.3g} rad/s, inside waves.band = [{low:g}, {high:g}]"
            yield InputError(name, value, limit)
    least = longest(water.depth, water.gravity)
    wanted = seas.band(sea, waves, first_solved(water.depth, water.gravity))
    if study.floats and not study.coefficients and wanted and wanted[0] <= least:
        start = f"must start where kh > {SHALLOWEST:g} in {water.depth:g} m, above {least:.4g} rad/s"
        if waves.band:
            yield InputError("waves.band", list(wanted), start)
            return
        name, value, _ = named(key, sea)
        reason = f"needs coefficients from {wanted[0]:.4g} rad/s on, which {start}"
        if isinstance(value, float):  # a period: all frequencies go with it
            reason = f"must be <= {math.floor(100 * value * wanted[0] / least) / 100:g} s: it {reason}"
        yield InputError(name, value, reason)


def _resolution(key: str, sea: SeaState, study: StudyFile) -> Iterator[InputError]:
    """Two waves can be told apart in a record that is as long as their beat, one from a mean in its period.

    The frequency domain analyses no record.
    """
    varied = (values for axis in study.varied for path, values in axis.keys.items() if path == "solver.method")
    marched = "time" in {study.solver.method, *itertools.chain(*varied)}
    spacing = _spacing(sea, study.waves) if study.record.rao and marched else math.inf
    beat = 2 * math.pi / spacing if spacing > 0 else math.inf
    if study.record.duration < beat:
        limit = f"must be >= {beat:.4g} s for record.rao, to tell the waves of {key} and a mean apart"
        yield InputError("record.duration", study.record.duration, limit)


def _spacing(sea: SeaState, waves: Waves) -> float:
    """Smallest difference of two frequencies of a sea, of which a mean is one of zero [rad/s]."""
    if isinstance(sea, Still):
        return math.inf
    if isinstance(sea, Regular):
        return 2 * math.pi / sea.period
    if isinstance(sea, Components | Elevation):
        omega = realizations.realize(sea, waves, (0,)).omega
        return min((float(b - a) for a, b in itertools.pairwise((0.0, *omega))), default=math.inf)
    span = seas.frequencies(sea, waves) or (0.0, math.inf)
    width = (span[1] - span[0]) / waves.components
    # Random intervals have edges up to 0.4 of a width from even ones, and their middles half of that each.
    apart, first = (0.6, 0.3) if waves.intervals == "random" else (1.0, 0.5)
    return min(apart * width, span[0] + first * width)


def of_sea(error: InputError, key: str, sea: SeaState) -> InputError:
    """An objection to the band of coefficients, under the key that gives a sea its frequencies."""
    name, value, _ = named(key, sea)
    return InputError(name, value, f"needs coefficients at {error.value} rad/s, which {error.limit}")


def named(key: str, sea: SeaState) -> tuple[str, object, str]:
    """Key and value that give a sea its frequency, and what that is."""
    match sea:
        case Irregular():
            return f"{key}.Tp", sea.Tp, "the peak"
        case Regular():
            return f"{key}.period", sea.period, "its frequency"
        case _:
            return f"{key}.file", getattr(sea, "file", ""), "all waves"
