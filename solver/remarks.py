"""Sentences for the user on what a run met that is beyond some part of its model."""

from collections.abc import Iterator, Mapping, Sequence

import numpy as np

from solver.balance import FLUSH, UNDER, moored_at
from solver.hydrodynamics.hull.swing import inside
from solver.limits import ROUGH, BeyondSeries
from solver.mooring import line_pulls
from solver.scene import DOFS, Float, Scene, load_unit_along, unit_along
from solver.sea.field import wave_field
from solver.statistics import FAINT, STATISTICS, of_joints

STEEP = 1.2  # factor by which extremes may exceed those of Gaussian responses
RINGS = 0.2  # share of a variance by what rings between the waves
APART = 1.1  # factor by which extremes may miss those of Gaussian rates or forces; of power it is the square
STRAYED = 0.5  # [rad] of the mean wave that it may go from where linear wave loads have their phases
SHOVED = 0.1  # times the std of a motion: a mean that counts
SWUNG = 0.15  # [rad] that the std of its angles may be in a linear model
HANGING = 1.1  # times the weight of a line that hangs straight down at rest: it pulls so where waves lift its float


def strayed(scene: Scene, axes: Sequence[str], tables: Mapping[str, np.ndarray]) -> Iterator[str]:
    """A sentence for each float that went far from where linear wave loads have their phases, or from another float."""
    if "motion" not in tables or not scene.settings.diffraction or not scene.sea.amplitude.any():
        return
    waves = wave_field(scene.sea, scene.water.depth, scene.water.gravity, scene.current)
    ways = np.array(_along_waves(scene, axes, tables, waves.direction))
    most = np.abs(ways).max(axis=1, initial=0.0)
    for b, (f, nonlinear) in enumerate(zip(scene.floats, scene.nonlinear, strict=True)):
        far, place = most[b], "where it is given, which the phases of linear wave loads are of"
        if nonlinear:  # from one that went less far
            apart = np.abs(ways[b] - ways).max(axis=1) * (most <= most[b]) * scene.settings.interaction
            other, far = scene.floats[int(np.argmax(apart))].name, apart.max()
            place = f"its place at rest beside floats.{other}, by which they scatter and radiate waves to each other"
        if far > STRAYED * waves.mean_length:
            yield (
                f"floats.{f.name} went {far:.3g} m along the waves, {far / waves.mean_length:.2g} rad of the mean wave,"
                f" from {place}: no part of the estimated error"
            )


def _along_waves(
    scene: Scene, axes: Sequence[str], tables: Mapping[str, np.ndarray], direction: np.ndarray
) -> list[np.ndarray]:
    """Mean, highest and lowest way (3,) of each float by what slides, its carriers with it."""
    ways: list[np.ndarray] = []
    told = [STATISTICS.index(name) for name in ("mean", "max", "min")]
    for f, carrier, motion in zip(scene.floats, scene.carriers, tables["motion"][..., told], strict=True):
        way = ways[carrier].copy() if carrier >= 0 else np.zeros(len(told))
        for axis, of_axis in zip(axes, motion, strict=True):
            if axis in f.motion and axis in DOFS[:2]:
                mean, *ends = f.direction(axis) @ direction * of_axis
                way += mean, max(ends), min(ends)
        ways.append(way)
    return ways


def of_motions(
    scene: Scene, axes: Sequence[str], tables: Mapping[str, np.ndarray], joints: np.ndarray
) -> Iterator[str]:
    """Sentences for motions, of which `tables` has statistics, that are too large for some part of a model.

    joints (nj,): at rest.
    """
    yield from met(scene, axes, tables)
    yield from swung(scene, axes, tables)
    yield from strayed(scene, axes, tables)
    yield from shoved(scene, axes, tables, joints)
    yield from snapped(scene, tables, joints)


def snapped(scene: Scene, tables: Mapping[str, np.ndarray], joints: np.ndarray) -> Iterator[str]:
    """A sentence for each line, taut at rest, whose least tension is about the weight of what hangs straight down.

    joints (nj,): at rest.
    """
    if "line_tension" not in tables:
        return
    least = iter(tables["line_tension"][:, STATISTICS.index("min")])
    for f, (lines, place) in zip(scene.floats, moored_at(scene, joints), strict=True):
        for number, (line, pull) in enumerate(zip(lines, line_pulls(lines, place), strict=True), 1):
            hanging = line.weight * (place[2] + line.fairlead[2] - line.anchor[2])
            tension = next(least)
            if tension < HANGING * hanging and line.weight * line.length < np.linalg.norm(pull):
                yield (
                    f"floats.{f.name}.lines: line {number}, {np.linalg.norm(pull):.4g} N at rest, goes slack, down to"
                    f" {tension:.4g} N: as it snaps a run depends on its last digits, which the estimated error does"
                    " not tell; other steps or seeds tell how much"
                )


def shoved(scene: Scene, axes: Sequence[str], tables: Mapping[str, np.ndarray], joints: np.ndarray) -> Iterator[str]:
    """A sentence for each horizontal axis along which waves keep a float, of body-nonlinear pressure, off its rest.

    joints (nj,): there.
    """
    if "motion" not in tables or scene.current is not None or not scene.sea.amplitude.any():
        return
    mean, std = (tables["motion"][..., STATISTICS.index(name)] for name in ("mean", "std"))
    rest, least = iter(joints), FAINT**2 * float(np.abs(scene.sea.amplitude).sum())
    for b, (f, nonlinear) in enumerate(zip(scene.floats, scene.nonlinear, strict=True)):
        for axis, at in zip(f.motion, rest, strict=False):
            off, size = mean[b, axes.index(axis)] - at, std[b, axes.index(axis)]
            if nonlinear and axis in DOFS[:2] and abs(off) > max(SHOVED * size, least):
                yield (
                    f"floats.{f.name}: its mean {axis}, {off:.2g} m from rest, is by the incident waves' pressure on"
                    " the wet hull, without that of second order of the waves it sends out, and may be several times"
                    ' too large: outputs = ["drift"] of the frequency domain has both; no part of the estimated error'
                )


def met(scene: Scene, axes: Sequence[str], tables: Mapping[str, np.ndarray]) -> Iterator[str]:
    """A sentence for floats that meet at places between the extremes of a run, of which `tables` has statistics."""
    if not axes:
        return
    high, low = (of_joints(tables)[..., STATISTICS.index(name)] for name in ("max", "min"))
    strokes = {}
    for b, f in enumerate(scene.floats):
        if len(f.motion) == 1:
            j = axes.index(f.motion[0])
            strokes[f.name] = inside(f.jointed, low[b, j], high[b, j])
    for a, b_, at in scene.meetings(strokes):
        yield f"floats.{a} and floats.{b_} meet at {at}, where they came; no load tells of it"


def swung(scene: Scene, axes: Sequence[str], tables: Mapping[str, np.ndarray]) -> Iterator[str]:
    """A sentence for each axis about which a float turns by more than linear buoyancy's small angles."""
    if not axes:
        return
    moved = of_joints(tables)
    for f, exact, of_axes in zip(scene.floats, scene.nonlinear, moved[..., STATISTICS.index("std")], strict=True):
        for axis, angle in zip(axes, of_axes, strict=True):
            if not exact and axis not in DOFS[:3] and angle > SWUNG:
                yield (
                    f"floats.{f.name}: the std of {axis} is {angle:.2g} rad, and linear pressure is one of small"
                    " angles: what they leave out goes with their square, and is no part of the estimated error"
                )


def bared(floats: Sequence[Float], moved: np.ndarray, waves: int) -> Iterator[str]:
    """A sentence for each float of which a third of waves, or the one, moves the surface past its middle or a side, by
    `moved` (nb,), beyond an end of its hull."""
    for f, far in zip(floats, moved, strict=True):
        above = f.hull.freeboard if f.hull.closed and abs(f.hull.freeboard) > FLUSH * f.hull.draft else np.inf
        ends = {UNDER: -above} if above < 0 else {"draft": f.hull.draft, "freeboard": above}
        end = min(ends, key=ends.__getitem__)
        if far > ends[end]:
            yield (
                f"floats.{f.name}: {'the wave' if waves == 1 else 'a third of waves'} moves the surface past it, or"
                f" past a side of it, by {far:.3g} m, beyond its {end} of {ends[end]:.3g} m, and linear pressure knows"
                ' no end of a hull: no part of the estimated error, but solver.method = "time" has it, with'
                " body-nonlinear forces"
            )


def drag_driven(factor: float, shaken: float, wear: float) -> Iterator[str]:
    """Sentences where drag makes extremes of a frame exceed Gaussian ones by a factor, where what is not linear of it
    makes a share of a motion, and where it does a factor of the damage that Gaussian ranges do.
    """
    if factor > STEEP:
        yield (
            "platform: drag, which goes by the velocity's square, drives the legs: expect largest displacements and"
            f" stresses up to {factor:.2g} times those of the linear responses that max and min are of"
        )
    if shaken > 0.5:
        yield (
            f"platform: {shaken:.0%} of the variance of a displacement or acceleration is by what is not linear of drag"
            " and comes in bursts: expect the largest up to twice those that max and min are of"
        )
    if wear > STEEP:
        yield (
            "platform: ranges of stress that drag drives are not Gaussian: expect, within a factor of 2,"
            f" {wear:.2g} times the damage told"
        )


def pulled(factor: float, rings: float) -> Iterator[str]:
    """Sentences where steel bears loads of joints that bend, rings by a share of its variance, and its extremes exceed
    Gaussian ones by a factor."""
    if rings > RINGS:
        yield (
            f"platform: {rings:.0%} of the variance of a force or stress is by what joints' loads ring between the"
            " waves, in bursts: expect the largest up to twice those told, up to four times in one wave, and damage"
            " within a factor of ten"
        )
    if factor > APART:
        yield (
            "platform: steel bears loads of joints that are not Gaussian: expect its largest forces and stresses, where"
            f" these are most of them, {factor:.2g} times those told, and damage by as much in its ranges"
        )


def skewed(factor: float) -> Iterator[str]:
    """A sentence where arms that turn make extremes of joints' forces exceed Gaussian ones by a factor."""
    if factor > APART:
        yield (
            "floats: arms turn, and forces of joints are not linear: expect largest ones up to"
            f" {factor:.2g} times those that max and min have"
        )


def swings_up(scene: Scene, joint: int, size: float) -> str:
    """Where a response is left for one of twice the waves' period, by a joint, in waves over 1/size as high."""
    name, axis = [(f.name, axis) for f in scene.floats for axis in f.motion][joint]
    amplitude = np.abs(scene.sea.amplitude)
    one, root = np.count_nonzero(amplitude) == 1, float(np.linalg.norm(amplitude))
    height = (2 if one else np.sqrt(8)) * root / size
    waves, what = ("wave's frequency", "waves") if one else ("waves' frequencies", "seas of a significant height")
    return (
        f"floats.{name}: {axis} swings up at half the {waves}, as {what} above about {height:.2g} m make"
        " it, which no linear response has: rotation_effect is 1 for what is not known, and only a run in time tells"
        ' how far (solver.method = "time")'
    )


def beyond_lines(scene: Scene, told: np.ndarray, exact: np.ndarray) -> str:
    """Joints (nj,) whose std [m or rad] is told as less than half of what arms that turn make it; none: no words."""
    units = dict.fromkeys(DOFS[:3], "m")
    joints = [(f"floats.{f.name} {axis}", units.get(axis, "rad")) for f in scene.floats for axis in f.motion]
    lacking = [f"{joints[j][0]}, about {exact[j]:.2g} {joints[j][1]}" for j in np.flatnonzero(exact > 2 * told)]
    words = "most of the std is of second order, by what turns, and in no linear response, of"
    return f"{words} {'; '.join(lacking)}" * bool(lacking)


def left_series(scene: Scene, out: BeyondSeries) -> Iterator[str]:
    """A sentence for each float that left the series of the waves around it for so long, or so far, that it counts."""
    for item, way, left in zip(scene.floats, out.furthest, out.rms(), strict=True):
        if left > ROUGH:
            yield (
                f"floats.{item.name} went {way:.3g} m along the waves or up from its place at rest, out of the series"
                f" of the waves about that, which leaves out {left:.2g} of the amplitudes' sum (rms, at most) on its"
                " hull: no part of the estimated error; hold it by more stiffness or damping, or end the band lower"
            )


def beyond_tables(floats: Sequence[Float], low: np.ndarray, high: np.ndarray) -> Iterator[str]:
    """A sentence for each axis whose motion or rate, met from `low` to `high` (2, nj), leaves the range in which the
    load of its power take-off is given, where that is not level at the range's end."""
    axes = [(f, axis, points) for f in floats for axis, points in zip(f.motion, f.pto_points, strict=True)]
    for j, (item, axis, points) in enumerate(axes):
        if points is None:
            continue
        y, v, load = points
        for k, (what, given, lines) in enumerate((("position", y, load), ("rate", v, load.T))):
            if given.size and (
                (low[k, j] < given[0] and np.any(lines[0] != lines[1]))
                or (high[k, j] > given[-1] and np.any(lines[-1] != lines[-2]))
            ):
                unit = unit_along(axis) + "/s" * k
                yield (
                    f"floats.{item.name}: the {what} of {axis} was {low[k, j]:+.3g} to {high[k, j]:+.3g} {unit}, beyond"
                    f" {given[0]:+.3g} to {given[-1]:+.3g} {unit}, in which the load of its power take-off is given:"
                    " beyond that it stays what it is at the ends"
                )


def stopped(floats: Sequence[Float], friction: np.ndarray, load: np.ndarray) -> Iterator[str]:
    """A sentence for each axis that friction (nj,) holds in a linear model, though not against the largest load that
    waves put on it, of statistics (nj, 5)."""
    axes = [(f.name, axis) for f in floats for axis in f.motion]
    for (name, axis), holding, of in zip(axes, friction, load, strict=True):
        most, std = of[STATISTICS.index("max")], of[STATISTICS.index("std")]
        if most > holding:
            yield (
                f"floats.{name}: friction holds {axis} in the linear model, {holding:.4g} {load_unit_along(axis)}"
                f" against {std:.4g} (std) and {most:.4g} at most by waves: it moves now and then, and only a run in"
                " time tells how far"
            )
