"""An error asked for becomes settings: pilot runs tell which knob is too coarse, and which too fine."""

from collections.abc import Callable, Mapping
from dataclasses import replace

import numpy as np

from solver.record.audit import MARGIN, PROBE
from solver.scene import Scene, Settings

PILOTS = 6
RULES = [(8, 4, 2), (12, 6, 3), (12, 8, 4), (16, 12, 6), (24, 16, 8)]
MEMORIES = [3e-2, 1e-2, 5e-3, 2e-3, 1e-3, 3e-4]
# What the sum of the estimates may be made of; the BEM's mesh is chosen before, see scene.panels_for.
SHARE = {"discretization_error": 0.4, "quadrature_error": 0.2, "memory_effect": 0.2}
STEP_ORDER = 4


def settled(scene: Scene, run: Callable[[Scene], Mapping[str, float | str]]) -> Scene:
    """The scene with settings whose estimated error meets `tolerance`, as pilot runs of PROBE seconds tell.

    run: scene -> attributes of its record. A tolerance that no pilot meets leaves the finest settings; the
    record's `estimated_error` says what they came to.
    """
    goal = scene.settings.tolerance / MARGIN
    settings = _first_guess(scene)
    for _ in range(PILOTS):
        pilot = replace(settings, discard=0.0, duration=PROBE, keep_series=False)
        told = run(replace(scene, settings=pilot))
        better = _step(_rule(_memory(settings, told, goal), told, goal), told, goal, scene.longest_step)
        if better == settings:
            break
        settings = better
    return replace(scene, settings=settings)


def _first_guess(scene: Scene) -> Settings:
    """What the defaults say, scaled to the tolerance where the law is known."""
    s, tolerance = scene.settings, scene.settings.tolerance
    size = min((f.hull.largest_radius for f in scene.floats), default=1.0)
    return replace(
        s,
        tolerance=None,
        field_tolerance=min(1e-3, tolerance / 20),
        newton_tolerance=min(1e-5, tolerance / 200) * size,
        modes=s.modes if tolerance > 1e-4 or s.modes == "all" else 4 * s.modes,
        azimuths=RULES[1][0],
        arc_points=RULES[1][1],
        line_points=RULES[1][2],
        stations_per_element=2 if tolerance > 4e-4 else 4,
        time_step=min(s.time_step, scene.longest_step),
    )


def _step(s: Settings, told, goal: float, longest: float) -> Settings:
    error, share = told["discretization_error"], SHARE["discretization_error"] * goal
    if share / 8 < error <= share:
        return s
    factor = 0.9 * (share / max(error, 1e-12)) ** (1 / STEP_ORDER)
    step = min(s.time_step * float(np.clip(factor, 0.3, 1.6)), longest)
    return s if error <= share and step < 1.1 * s.time_step else replace(s, time_step=step)


def _rule(s: Settings, told, goal: float) -> Settings:
    now = (s.azimuths, s.arc_points, s.line_points)
    at = RULES.index(now)
    if told["quadrature_error"] > SHARE["quadrature_error"] * goal and at + 1 < len(RULES):
        azimuths, arc, line = RULES[at + 1]
        return replace(s, azimuths=azimuths, arc_points=arc, line_points=line, panel_size=s.panel_size / 2)
    return s


def _memory(s: Settings, told, goal: float) -> Settings:
    finer = [m for m in MEMORIES if m < s.memory_tolerance]
    if told["memory_effect"] > SHARE["memory_effect"] * goal and finer:
        return replace(s, memory_tolerance=finer[0])
    return s
