"""The scene of a study file in side view, to scale."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import TYPE_CHECKING, Any, NamedTuple

from pipeline.report.drawing import INK, SAND, STEEL, WATER, canvas, colour
from pipeline.study.floats import Float
from pipeline.study.platform import General, Section, Tube
from pipeline.study.schema import StudyFile
from pipeline.tasks.task import Parameters, cell, first_labels

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

Point = tuple[float, float]  # x, z [m]
DIGITS = 3  # of places that are one [m]
FEW = 1e-9  # m; shorter is seen end on


class Box(NamedTuple):
    """Edges of the side view [m]."""

    left: float
    right: float
    low: float
    high: float


def first_scene(study: StudyFile) -> Parameters:
    """Of the first task, with its platform and its floats whichever of the two it is without."""
    return cell(study, first_labels(study) | {"platform": "elastic"}, ()).parameters


def members(scene: Parameters) -> Iterator[list[Point]]:
    """The outline of every member of the platform, seen along y."""
    if scene.platform is None:
        return
    nodes = scene.platform.nodes
    for member in scene.platform.members:
        ends = member.section, member.end_section or member.section
        widths = [_width(scene.platform.sections[name]) for name in ends]
        (x0, _, z0), (x1, _, z1) = nodes[member.start], nodes[member.end]
        (dx0, _, dz0), (dx1, _, dz1) = member.start_offset, member.end_offset
        yield _bar((x0 + dx0, z0 + dz0), (x1 + dx1, z1 + dz1), widths)


def _width(section: Section) -> float:
    """As it is drawn [m]."""
    if isinstance(section, Tube):
        return section.diameter
    return 2 * max(abs(z) for _, z in section.fibres) if isinstance(section, General) else section.height


def _bar(start: Point, end: Point, widths: list[float]) -> list[Point]:
    """A straight bar, as wide as it is at either end; a square if it is seen end on."""
    (x0, z0), (x1, z1), h = start, end, max(widths) / 2
    length = math.hypot(x1 - x0, z1 - z0)
    if length < FEW:
        return [(x0 - h, z0 - h), (x0 + h, z0 - h), (x0 + h, z0 + h), (x0 - h, z0 + h)]
    nx, nz = (z0 - z1) / length / 2, (x1 - x0) / length / 2
    a, b = widths
    return [
        (x0 + a * nx, z0 + a * nz),
        (x1 + b * nx, z1 + b * nz),
        (x1 - b * nx, z1 - b * nz),
        (x0 - a * nx, z0 - a * nz),
    ]


def float_outline(item: Float) -> list[Point]:
    """The float's hull at rest, seen along y."""
    from pipeline.bridge import hulls

    x, _, z = centre(item)
    return [(x + r, z + h) for r, h in hulls.outline(item.hull)]


def centre(item: Float) -> tuple[float, float, float]:
    """The float's reference point at rest [m]."""
    from pipeline.bridge import scenes

    x, y, z = map(float, scenes.floating(item).centre)
    return x, y, z


def lines(item: Float) -> Iterator[tuple[Point, Point]]:
    """Fairlead and anchor of each mooring line: straight, however it hangs."""
    from pipeline.bridge import scenes

    placed = scenes.floating(item)
    for line in placed.lines:
        x, _, z = map(float, placed.centre + line.fairlead)
        yield (x, z), (line.anchor[0], line.anchor[2])


def whole(scene: Parameters) -> Box:
    """From the seabed, or the deepest pile, to the highest point."""
    near = about_water(scene)
    bars = [point for bar in members(scene) for point in bar]
    left, right = min([near.left, *(x for x, _ in bars)]), max([near.right, *(x for x, _ in bars)])
    feet = min([near.low, *(z for _, z in bars)])
    in_soil = scene.platform is not None and scene.platform.soil
    low = (feet if in_soil else max(-scene.water.depth, feet)) - 2.0
    least = 0.15 * (near.high - low)  # a single pile needs room for its axis' numbers
    aside = max(0.0, least - (right - left) / 2)
    return Box(left - aside, right + aside, low, near.high)


def about_water(scene: Parameters) -> Box:
    """The floats, the hinges and what stands beside them."""
    points = [p for f in scene.floats for p in [*float_outline(f), (f.hinge[0], f.hinge[2])]]
    deck = [p for bar in members(scene) for p in bar if p[1] > -1.0]
    points = points + deck or [(-1.0, 0.0), (1.0, 0.0)]
    xs, zs = [x for x, _ in points], [z for _, z in points]
    margin = 0.12 * (max(xs) - min(xs)) + 0.3
    low = max(min([*zs, -1.0]) - 1.5 * margin, -scene.water.depth - margin)
    return Box(min(xs) - margin, max(xs) + margin, low, max([*zs, 0.0]) + margin)


def draw(axes: Axes, scene: Parameters, box: Box) -> None:
    """Water, seabed, platform, floats, arms, hinges and mooring lines."""
    from matplotlib.patches import Polygon

    tall, depth = box.high - box.low, scene.water.depth
    axes.axhspan(-depth if math.isfinite(depth) else -10 * tall, 0.0, color=WATER, linewidth=0)
    axes.axhline(0.0, color=colour(0), linewidth=0.8)
    if math.isfinite(depth):
        axes.axhspan(-depth - tall, -depth, color=SAND, linewidth=0)
    for bar in members(scene):
        axes.add_patch(Polygon(bar, facecolor=STEEL, edgecolor=INK, linewidth=0.4))
    for index, item in enumerate(scene.floats):
        axes.add_patch(Polygon(float_outline(item), facecolor=colour(index), edgecolor=INK, linewidth=0.6, alpha=0.85))
        (x, _, z), hinge = centre(item), item.hinge
        for start, end in lines(item):
            axes.plot([start[0], end[0]], [start[1], end[1]], color=INK, linewidth=0.8, linestyle=":")
        axes.plot([hinge[0], x], [hinge[2], z], color=INK, linewidth=1.6, solid_capstyle="round")
        if "hinge" in item.motion:
            axes.plot(hinge[0], hinge[2], "o", color="white", markeredgecolor=INK, markersize=5, zorder=4)
    axes.set_xlim(box.left, box.right, auto=True)
    axes.set_ylim(box.low, box.high, auto=True)
    axes.set_aspect("equal", adjustable="box")
    axes.grid(visible=False)
    axes.set_xlabel("x [m]")


def label(axes: Axes, scene: Parameters) -> None:
    """Names of the floats, the depth of the water, and the way the waves go."""
    places: dict[Point, dict[str, str]] = {}  # names and colours; floats behind one another share a place
    for index, item in enumerate(scene.floats):
        at = round(centre(item)[0], DIGITS), round(min(z for _, z in float_outline(item)), DIGITS)
        places.setdefault(at, {})[item.name] = colour(index)
    for (x, low), named in places.items():
        shade = INK if len(named) > 1 else next(iter(named.values()))
        axes.text(x, low - 0.15, ", ".join(named), ha="center", va="top", color=shade)
    corner: dict[str, Any] = {"transform": axes.transAxes, "fontsize": "small"}
    axes.text(0.02, 0.02, _depth(scene), ha="left", va="bottom", color=colour(0), **corner)
    along = math.cos(scene.waves.heading)
    if abs(along) > 0.1:
        ends = [(0.02, 0.92), (0.2, 0.92)]
        start, tip = ends if along > 0 else ends[::-1]
        style: dict[str, Any] = {"arrowstyle": "->", "color": INK, "shrinkA": 0, "shrinkB": 0}
        axes.annotate("", tip, start, xycoords="axes fraction", arrowprops=style)
        axes.text(0.11, 0.93, "waves", ha="center", va="bottom", **corner)
        if scene.waves.heading:  # which a side view shows foreshortened
            axes.text(0.02, 0.9, f"heading {scene.waves.heading:g} rad", ha="left", va="top", **corner)


def _depth(scene: Parameters) -> str:
    depth = scene.water.depth
    return f"water {depth:g} m deep" if math.isfinite(depth) else "deep water"


def side_view(study: StudyFile) -> Figure | None:
    """The whole depth, if there is a platform, and the surroundings of the water line, both to scale."""
    scene = first_scene(study)
    if not scene.floats and scene.platform is None:
        return None
    near, all_ = about_water(scene), whole(scene)
    if scene.platform is None:
        figure = canvas(6.0, 4.2)
        close_up(figure.add_subplot(), scene)
        return figure
    figure = canvas(9.0, 5.2)
    wide = max(1.0, (near.right - near.left) / (near.high - near.low))
    tall = max(0.25, (all_.right - all_.left) / (all_.high - all_.low))
    left, right = figure.subplots(1, 2, width_ratios=[tall, wide])
    draw(left, scene, all_)
    left.set_ylabel("z [m]")
    left.set_title("whole depth")
    if -scene.water.depth > all_.low:  # beyond the axes it would leave these no room
        left.text(all_.right, -scene.water.depth, " seabed", va="top", fontsize="small")
    close_up(right, scene)
    right.set_title("at the water line")
    return figure


def close_up(axes: Axes, scene: Parameters) -> None:
    """The surroundings of the water line, as much as the axes hold."""
    draw(axes, scene, about_water(scene))
    axes.set_aspect("equal", adjustable="datalim")
    label(axes, scene)
    axes.set_ylabel("z [m]")
