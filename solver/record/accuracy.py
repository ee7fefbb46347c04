"""An error asked for becomes settings: a first guess by known laws, and finer ones where a run's start says so.

Without one the step alone is chosen: by the scene's periods, and shorter where a run's start says so. The tables of
power take-offs' laws are finer where it says so, with and without one.
"""

from collections.abc import Iterator, Mapping
from dataclasses import replace
from typing import Any

import numpy as np

from solver.power_takeoff import PtoTable
from solver.record.probe import UNTOLD, with_tables
from solver.scene import Scene, Settings, two_digits

ATTEMPTS = 6  # at most; each but the last costs the first probe.PROBE steps of a run, and their audit
RULES = [(8, 4, 2), (12, 6, 3), (16, 12, 6), (24, 16, 8)]
MARGIN = 2.0  # of the tolerance over the estimate, which is a sample
# What of (tolerance / MARGIN)² the estimate's square may have of each; all together half of tolerance², so that what no
# setting changes (the BEM's mesh is chosen before, see scene.panels_for) has the rest. Where laws jump samples err, and
# the step less.
SHARE = {"discretization_error": 0.5, "sampling_error": 0.5, "quadrature_error": 0.25, "memory_effect": 0.25}
CHOSEN = (
    "time_step", "field_tolerance", "newton_tolerance", "azimuths", "arc_points", "line_points", "stations_per_element",
)  # fmt: skip
SHAPES = 0.25  # and of the frame's shapes, of its drag, and of tables of laws, which are cheap
STEP_ORDER = 4
SAMPLES_ORDER = 1.5  # jumps lie anywhere between samples: in gaps half as wide and twice as many
USUAL = 5e-4  # of the usual step, where the guess starts from
DEFAULT = 1e-3  # what the step may err by where none is given, and the tables


def first_guess(scene: Scene) -> Settings:
    """What the defaults say, scaled to the tolerance where the law is known; rather too coarse than too fine."""
    s, tolerance = scene.settings, _tolerance(scene.settings)
    azimuths, arc, line = RULES[0 if tolerance >= 1e-2 else 1]
    step = scene.usual_step * (SHARE["discretization_error"] ** 0.5 * tolerance / MARGIN / USUAL) ** (1 / STEP_ORDER)
    return replace(
        s,
        field_tolerance=min(1e-3, tolerance / 20),
        newton_tolerance=min(1e-5, tolerance / 200),
        modes=s.modes if tolerance > 1e-4 or s.modes == "all" else 4 * s.modes,
        azimuths=azimuths,
        arc_points=arc,
        line_points=line,
        stations_per_element=2 if tolerance > 4e-4 else 4,
        time_step=min(step, scene.longest_step),
    )


def overruled(asked: Settings, used: Mapping[str, Any]) -> Iterator[str]:
    """A note on each setting that is given and of which a tolerance has used another value."""
    usual = Settings()
    for name in CHOSEN:
        given = getattr(asked, name)
        if given not in (getattr(usual, name), used[name]):
            yield f"{name} = {given:g}: tolerance chooses it, {used[name]:g}"


def improved(scene: Scene, told: Mapping[str, float]) -> Scene | None:
    """The scene with finer settings or tables for a run that has `told` its estimates; None where these are enough."""
    s = scene.settings
    settings = shortened(s, told) if s.tolerance is None else refined(s, told)
    allowed = DEFAULT if s.tolerance is None else SHAPES**0.5 * s.tolerance / MARGIN
    met = s.tolerance is not None and MARGIN * told["estimated_error"] <= s.tolerance
    better = scene if met or not allowed < told["law_effect"] < UNTOLD else with_tables(scene, PtoTable.by_judged)
    if settings is None and better.floats == scene.floats:
        return None
    return replace(better, settings=settings or s)


def refined(settings: Settings, told: Mapping[str, float]) -> Settings | None:
    """Finer settings for a run that has `told` its estimates; None where they meet the tolerance or nothing helps.

    Each part comes to its own share, also where another stands against the tolerance.
    """
    allowed = _tolerance(settings) / MARGIN
    if told["estimated_error"] <= allowed:
        return None
    over = {name: told[name] / (share**0.5 * allowed) for name, share in SHARE.items()}
    finer = settings
    if (step := max(over["discretization_error"], over["sampling_error"] ** (STEP_ORDER / SAMPLES_ORDER))) > 1:
        finer = _shorter(finer, step)
    if isinstance(settings.modes, int) and told["shapes_effect"] > SHAPES**0.5 * allowed:
        finer = replace(finer, modes=2 * settings.modes)
    if told["stations_effect"] > SHAPES**0.5 * allowed:
        finer = replace(finer, stations_per_element=2 * settings.stations_per_element)
    at = RULES.index((settings.azimuths, settings.arc_points, settings.line_points))
    if over["quadrature_error"] > 1 and at + 1 < len(RULES):
        azimuths, arc, line = RULES[at + 1]
        finer = replace(finer, azimuths=azimuths, arc_points=arc, line_points=line, panel_size=settings.panel_size / 2)
    return None if finer == settings else finer


def shortened(settings: Settings, told: Mapping[str, float]) -> Settings | None:
    """A shorter step for a run whose chosen one errs by more than DEFAULT; else None."""
    over = told["discretization_error"] / DEFAULT
    return _shorter(settings, over) if over > 1 else None


def _shorter(settings: Settings, over: float) -> Settings:
    """With the step that errs `over` times less."""
    assert settings.time_step is not None, "asked of a run, with its step"
    share = float(np.clip(0.9 * over ** (-1 / STEP_ORDER), 0.3, 0.9))
    return replace(settings, time_step=two_digits(share * settings.time_step))


def _tolerance(settings: Settings) -> float:
    assert settings.tolerance is not None, "asked of settings that choose their own numerics"
    return settings.tolerance
