"""A replayed task as a moving picture: the scene's side view, its waves and a clock."""

from __future__ import annotations

import io
import math
import textwrap
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from pipeline.bridge.replay import Pose, Replay
from pipeline.report import sketch
from pipeline.report.drawing import WATER, colour, literal, plain
from pipeline.results.store import appearing
from pipeline.tasks.task import Parameters

if TYPE_CHECKING:
    from matplotlib.lines import Line2D
    from matplotlib.patches import Polygon
    from PIL.Image import Image

ALONG = 240  # places at which the waves' surface is drawn
LETTERS = 11  # of a title, an inch
FINE = 1e-6  # by which a power of ten may be rounded
SHADES = 256  # of a picture's colours, those of the first for all


def write(path: Path, scene: Parameters, replay: Replay, title: str, pause: int, told: Callable[[float], None]) -> None:
    """A GIF of the replay's times, `pause` ms each. scene: as it is drawn at rest; told: the share that is done."""
    with plain(), appearing(path) as part:
        frames = pictures(scene, replay, title, told)
        rest: dict[str, Any] = {"save_all": True, "append_images": frames, "duration": pause, "loop": 0}
        # One after another: all of them at once would fill the memory.
        next(frames).save(part, format="GIF", **rest)


def pictures(scene: Parameters, replay: Replay, title: str, told: Callable[[float], None]) -> Iterator[Image]:
    """At each of the times, one after another."""
    from PIL import Image

    film, palette = Film(scene, replay, title), None
    size = film.figure.canvas.get_width_height()
    for number, pose in enumerate(replay.poses()):
        film.show(number, pose)
        dots = io.BytesIO()
        film.figure.savefig(dots, format="rgba", dpi=film.figure.dpi)
        picture = Image.frombytes("RGBA", size, dots.getvalue()).convert("RGB")
        palette = palette or picture.quantize(SHADES)
        yield picture.quantize(palette=palette, dither=Image.Dither.NONE)
        told((number + 1) / len(replay.times))


class Film:
    """The side view, of which one instant after another is shown."""

    def __init__(self, scene: Parameters, replay: Replay, title: str):
        self.replay = replay
        stations = replay.stations()
        self.rest = [np.array(bar) for bar in sketch.members(scene, stations)] if stations else []
        self.figure, self.views = sketch.views(scene, sketch.about_water(scene, _reached(replay, self.rest)))
        self.title = textwrap.fill(title, int(LETTERS * self.figure.get_figwidth()))
        self.magnified = f"; the platform's displacements × {replay.magnify:g}" * bool(stations and replay.magnify != 1)
        step = float(np.diff(replay.times[:2]).sum()) or 1.0
        self.digits = max(1, -math.floor(math.log10(step) + FINE))
        self.clock = self.figure.suptitle(self.words(replay.times[-1]), x=0.01, ha="left")
        literal(self.figure)
        self.figure.draw_without_rendering()
        self.figure.set_layout_engine("none")  # nothing else moves, and the time is not spent again
        self.sea = [_sea(view) for view in self.views]
        self.crests = [replay.elevation(x) for _, _, x in self.sea]

    def words(self, t: float) -> str:
        """Above the picture: which task it is, and when."""
        return f"{self.title}\nt = {t:.{self.digits}f} s{self.magnified}"

    def show(self, number: int, pose: Pose) -> None:
        """The scene as it is at that of the times."""
        self.clock.set_text(self.words(self.replay.times[number]))
        for view, (water, surface, x), crests in zip(self.views, self.sea, self.crests, strict=True):
            low = view.axes.get_ylim()[0]
            surface.set_ydata(crests[number])
            water.set_xy(np.stack([[x[0], *x, x[-1]], [low, *crests[number], low]], axis=-1))
            _place(view, self.rest, pose)


def _place(view: sketch.Drawn, rest: Sequence[np.ndarray], pose: Pose) -> None:
    for bar, outline, moved in zip(view.members, rest, pose.members, strict=False):
        bar.set_xy(_bent(outline, moved))
    for patch, outline in zip(view.hulls, pose.hulls, strict=True):
        patch.set_xy(outline)
    for arm, *ends in zip(view.arms, pose.hinges, pose.centres, strict=True):
        arm.set_data(*np.transpose(ends))
    for number, dot in view.hinges.items():
        dot.set_data(*pose.hinges[number][:, None])
    for number, name in view.names.items():
        name.xy = pose.centres[number, 0], pose.hulls[number][:, 1].min()
    for line, (x, z) in zip(view.lines, np.concatenate([*pose.fairleads, np.zeros((0, 2))]), strict=True):
        points = np.array(line.get_xydata())
        points[0] = x, z
        line.set_data(*points.T)


def _bent(outline: np.ndarray, moved: np.ndarray) -> np.ndarray:
    """A member's outline, of which both sides move alike; one that is seen end on moves as a whole."""
    sides = np.concatenate([moved, moved[::-1]])
    return np.asarray(outline + (sides if len(sides) == len(outline) else moved.mean(axis=0)))


def _sea(view: sketch.Drawn) -> tuple[Polygon, Line2D, np.ndarray]:
    """Water and its surface in place of still water's, and x of the points along it."""
    from matplotlib.patches import Polygon

    view.axes.autoscale(False)
    view.water.remove()
    view.surface.remove()
    water = Polygon(np.zeros((1, 2)), facecolor=WATER, linewidth=0, zorder=0.5)
    view.axes.add_patch(water)
    x = np.linspace(*view.axes.get_xlim(), ALONG)
    (surface,) = view.axes.plot(x, 0 * x, color=colour(0), linewidth=0.8, zorder=0.6)
    return water, surface, x


def _reached(replay: Replay, rest: Sequence[np.ndarray]) -> Iterator[sketch.Point]:
    """Corners of what floats and members above the water sweep, and the highest and lowest wave at the origin."""
    poses = list(replay.poses())
    swept = [*zip(*(pose.hulls for pose in poses), strict=True)]
    for number, outline in enumerate(rest):
        dry = outline[:, 1] > 0
        swept += [[_bent(outline, pose.members[number])[dry] for pose in poses]] * bool(dry.any())
    for outlines in swept:
        points = np.concatenate(outlines)
        yield from map(tuple, (points.min(axis=0), points.max(axis=0)))
    crests, x = replay.elevation(np.zeros(1)), poses[0].centres[:1, 0]
    yield from ((float(at), float(level)) for at in x for level in (crests.min(), crests.max()))
