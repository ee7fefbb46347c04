"""The scene of a study file in side view, to scale."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Sequence
from itertools import chain, repeat
from typing import TYPE_CHECKING, Any, NamedTuple

from pipeline.report.drawing import INK, SAND, STEEL, WATER, canvas, colour
from pipeline.study.floats import Float
from pipeline.study.platform import General, Section, Tube
from pipeline.study.schema import StudyFile
from pipeline.study.seas import Still
from pipeline.tasks.task import Parameters, cell, first_labels

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure
    from matplotlib.lines import Line2D
    from matplotlib.patches import Patch, Polygon
    from matplotlib.text import Annotation

Point = tuple[float, float]  # x, z [m]
DIGITS = 3  # of places that are one [m]
BELOW = 4  # points, of a hull is its name
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


class Drawn(NamedTuple):
    """What moves of a side view."""

    axes: Axes
    water: Patch
    surface: Line2D
    members: list[Polygon]
    hulls: list[Polygon]
    arms: list[Line2D]
    hinges: dict[int, Line2D]  # by number of the float
    lines: list[Line2D]  # of the moorings, float after float
    names: dict[int, Annotation]  # by number of the first float that each is of


def members(scene: Parameters, stations: Sequence[int] = ()) -> Iterator[list[Point]]:
    """The outline of every member of the platform, seen along y: so many points on its one side, then on the other."""
    if scene.platform is None:
        return
    nodes = scene.platform.nodes
    for member, count in zip(scene.platform.members, chain(stations, repeat(2)), strict=False):
        ends = member.section, member.end_section or member.section
        widths = [_width(scene.platform.sections[name]) for name in ends]
        (x0, _, z0), (x1, _, z1) = nodes[member.start], nodes[member.end]
        (dx0, _, dz0), (dx1, _, dz1) = member.start_offset, member.end_offset
        yield _bar((x0 + dx0, z0 + dz0), (x1 + dx1, z1 + dz1), widths, count)


def _width(section: Section) -> float:
    """As it is drawn [m]."""
    if isinstance(section, Tube):
        return section.diameter
    return 2 * max(abs(z) for _, z in section.fibres) if isinstance(section, General) else section.height


def _bar(start: Point, end: Point, widths: list[float], count: int) -> list[Point]:
    """A straight bar, as wide as it is at either end; a square if it is seen end on."""
    (x0, z0), (x1, z1), h = start, end, max(widths) / 2
    length = math.hypot(x1 - x0, z1 - z0)
    if length < FEW:
        return [(x0 - h, z0 - h), (x0 + h, z0 - h), (x0 + h, z0 + h), (x0 - h, z0 + h)]
    nx, nz = (z0 - z1) / length / 2, (x1 - x0) / length / 2
    a, b = widths
    along = [i / (count - 1) for i in range(count)]
    axis = [(x0 + s * (x1 - x0), z0 + s * (z1 - z0), a + s * (b - a)) for s in along]
    return [(x + w * nx, z + w * nz) for x, z, w in axis] + [(x - w * nx, z - w * nz) for x, z, w in reversed(axis)]


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


def whole(scene: Parameters, near: Box | None = None) -> Box:
    """From the seabed, or the deepest pile, to the highest point; near: the surroundings of the water line."""
    near = near or about_water(scene)
    bars = [point for bar in members(scene) for point in bar]
    left, right = min([near.left, *(x for x, _ in bars)]), max([near.right, *(x for x, _ in bars)])
    feet = min([near.low, *(z for _, z in bars)])
    in_soil = scene.platform is not None and scene.platform.soil
    low = feet if in_soil else max(-scene.water.depth, feet)
    low -= 0.04 * (near.high - low)
    least = 0.15 * (near.high - low)  # a single pile needs room for its axis' numbers
    aside = max(0.0, least - (right - left) / 2)
    return Box(left - aside, right + aside, low, near.high)


def about_water(scene: Parameters, more: Iterable[Point] = ()) -> Box:
    """The floats, the hinges and what stands beside them, and more points."""
    points = [*more] + [p for f in scene.floats for p in [*float_outline(f), (f.hinge[0], f.hinge[2])]]
    bars = [p for bar in members(scene) for p in bar]
    high = max([z for _, z in [*points, *bars]], default=0.0)
    points = points + [p for p in bars if p[1] > -high] or [(-1.0, 0.0), (1.0, 0.0)]
    xs, zs = [x for x, _ in points], [0.0, *(z for _, z in points)]
    margin = 0.15 * max(max(xs) - min(xs), max(zs) - min(zs))
    low = max(min(zs) - 1.5 * margin, -scene.water.depth - margin)
    return Box(min(xs) - margin, max(xs) + margin, low, max(zs) + margin)


def draw(axes: Axes, scene: Parameters, box: Box) -> Drawn:
    """Water, seabed, platform, floats, arms, hinges and mooring lines."""
    from matplotlib.patches import Polygon

    tall, depth = box.high - box.low, scene.water.depth
    water = axes.axhspan(-depth if math.isfinite(depth) else -10 * tall, 0.0, color=WATER, linewidth=0)
    drawn = Drawn(axes, water, axes.axhline(0.0, color=colour(0), linewidth=0.8), [], [], [], {}, [], {})
    if math.isfinite(depth):
        axes.axhspan(-depth - tall, -depth, color=SAND, linewidth=0)
    for bar in members(scene):
        drawn.members.append(Polygon(bar, facecolor=STEEL, edgecolor=INK, linewidth=0.4))
        axes.add_patch(drawn.members[-1])
    for index, item in enumerate(scene.floats):
        hull = Polygon(float_outline(item), facecolor=colour(index), edgecolor=INK, linewidth=0.6, alpha=0.85)
        drawn.hulls.append(hull)
        axes.add_patch(hull)
        (x, _, z), hinge = centre(item), item.hinge
        for start, end in lines(item):
            drawn.lines.extend(
                axes.plot([start[0], end[0]], [start[1], end[1]], color=INK, linewidth=0.8, linestyle=":")
            )
        drawn.arms.extend(axes.plot([hinge[0], x], [hinge[2], z], color=INK, linewidth=1.6, solid_capstyle="round"))
        drawn.arms[-1].set_visible("hinge" in item.motion)  # a guide has none
        if "hinge" in item.motion:
            style: dict[str, Any] = {"color": "white", "markeredgecolor": INK, "markersize": 5, "zorder": 4}
            (drawn.hinges[index],) = axes.plot(hinge[0], hinge[2], "o", **style)
    axes.set_xlim(box.left, box.right, auto=True)
    axes.set_ylim(box.low, box.high, auto=True)
    axes.set_aspect("equal", adjustable="box")
    axes.grid(visible=False)
    axes.set_xlabel("x [m]")
    return drawn


def label(axes: Axes, scene: Parameters) -> dict[int, Annotation]:
    """Names of the floats, which it returns, the depth of the water, and the way the waves go."""
    places: dict[Point, list[int]] = {}  # floats behind one another share a place
    for index, item in enumerate(scene.floats):
        at = round(centre(item)[0], DIGITS), round(min(z for _, z in float_outline(item)), DIGITS)
        places.setdefault(at, []).append(index)
    texts = {}
    for (x, low), (first, *others) in places.items():
        words = ", ".join(scene.floats[index].name for index in (first, *others))
        shade = INK if others else colour(first)
        beneath: dict[str, Any] = {"xytext": (0, -BELOW), "textcoords": "offset points", "ha": "center", "va": "top"}
        texts[first] = axes.annotate(words, (x, low), color=shade, **beneath)
    corner: dict[str, Any] = {"transform": axes.transAxes, "fontsize": "small"}
    axes.text(0.02, 0.02, _depth(scene), ha="left", va="bottom", color=colour(0), **corner)
    along = math.cos(scene.waves.heading)
    if abs(along) > 0.1 and not isinstance(scene.sea_state, Still):
        ends = [(0.02, 0.92), (0.2, 0.92)]
        start, tip = ends if along > 0 else ends[::-1]
        style: dict[str, Any] = {"arrowstyle": "->", "color": INK, "shrinkA": 0, "shrinkB": 0}
        axes.annotate("", tip, start, xycoords="axes fraction", arrowprops=style)
        axes.text(0.11, 0.93, "waves", ha="center", va="bottom", **corner)
        if scene.waves.heading:  # which a side view shows foreshortened
            axes.text(0.02, 0.9, f"heading {scene.waves.heading:g} rad", ha="left", va="top", **corner)
    return texts


def _depth(scene: Parameters) -> str:
    depth = scene.water.depth
    return f"water {depth:g} m deep" if math.isfinite(depth) else "deep water"


def side_view(study: StudyFile) -> Figure | None:
    """The whole depth, if there is a platform, and the surroundings of the water line, both to scale."""
    scene = first_scene(study)
    if not scene.floats and scene.platform is None:
        return None
    figure, _ = views(scene, about_water(scene))
    return figure


def views(scene: Parameters, near: Box) -> tuple[Figure, list[Drawn]]:
    """The figure, and what is in it; near: the surroundings of the water line."""
    if scene.platform is None:
        figure = canvas(6.0, 4.2)
        return figure, [close_up(figure.add_subplot(), scene, near)]
    all_ = whole(scene, near)
    figure = canvas(9.0, 5.2)
    wide = max(1.0, (near.right - near.left) / (near.high - near.low))
    tall = max(0.25, (all_.right - all_.left) / (all_.high - all_.low))
    left, right = figure.subplots(1, 2, width_ratios=[tall, wide])
    drawn = [draw(left, scene, all_)]
    left.set_ylabel("z [m]")
    left.set_title("whole depth")
    if -scene.water.depth > all_.low:  # beyond the axes it would leave these no room
        left.text(all_.right, -scene.water.depth, " seabed", va="top", fontsize="small")
    drawn.append(close_up(right, scene, near))
    right.set_title("at the water line")
    return figure, drawn


def close_up(axes: Axes, scene: Parameters, near: Box | None = None) -> Drawn:
    """The surroundings of the water line, as much as the axes hold."""
    drawn = draw(axes, scene, near or about_water(scene))
    axes.set_aspect("equal", adjustable="datalim")
    drawn.names.update(label(axes, scene))
    axes.set_ylabel("z [m]")
    return drawn
