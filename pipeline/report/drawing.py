"""How figures look: one plain style, colours that colour-blind readers can tell apart, labels beside what they name."""

from __future__ import annotations

import base64
import io
import math
from collections.abc import Iterable, Iterator, Sequence
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure
    from matplotlib.lines import Line2D

# Okabe and Ito's colours, as far as they are dark enough on white.
COLOURS = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#56B4E9", "#E69F00")
MARKERS = ("o", "s", "^", "D", "v", "P")
DASHES = ("-", "--", ":", "-.")
HIDDEN = 0.01  # of the height of axes: a line that is nowhere further from another hides it
COLUMNS = 6  # of marks in a row above a figure, where there is room
# Of files, with what is not to be written into them: dates, of which each file would be another.
FORMS: dict[str, dict[str, None]] = {"svg": {"Date": None}, "png": {"Software": None}, "pdf": {"CreationDate": None}}
MARGIN = 0.04  # of an axis's length, beside it, so that marks at its ends are whole
TICKS, SHORT = 5, 100.0  # numbers that each have their tick; largest over smallest of a short logarithmic axis
INK, FAINT, PAPER = "#333333", "#dddddd", "#000000"
WATER, SAND, STEEL = "#dcebf5", "#d9cfbf", "#8a8f94"


@contextmanager
def plain(size: float = 9.0) -> Iterator[None]:
    """The one style, with text of `size` points."""
    import matplotlib as mpl

    style: dict[Any, Any] = {
        "font.family": "DejaVu Sans",  # it comes with matplotlib: the same figure on every machine
        "font.size": size,
        "axes.titlesize": size,
        "axes.titlelocation": "left",
        "axes.labelsize": size,
        "xtick.labelsize": 0.9 * size,
        "ytick.labelsize": 0.9 * size,
        "lines.markersize": 0.5 * size,
        "axes.spines.top": False,
        "axes.spines.right": False,
        "axes.edgecolor": INK,
        "axes.labelcolor": INK,
        "axes.axisbelow": True,
        "axes.grid": True,
        "axes.grid.axis": "x",
        "grid.color": FAINT,
        "grid.linewidth": 0.6,
        "text.color": INK,
        "xtick.color": INK,
        "ytick.color": INK,
        "svg.hashsalt": "wecplatform",  # the same figure, the same bytes
    }
    with mpl.rc_context(style):
        yield


def colour(index: int) -> str:
    """Colour number `index`; after the last comes the first again."""
    return COLOURS[index % len(COLOURS)]


def marker(index: int) -> str:
    """Marker number `index`, another where colours begin again."""
    return MARKERS[index // len(COLOURS) % len(MARKERS)]


def dash(index: int) -> str:
    """Style of line number `index`, another where colours begin again."""
    return DASHES[index // len(COLOURS) % len(DASHES)]


def together(every: Iterable[Axes], labels: Iterable[str]) -> list[list[str]]:
    """Of these labels those that lines have, in one list those that hide one another in all axes, the top one last."""
    lines: dict[str, list[tuple[Axes, Line2D]]] = {}
    for axes in every:
        for line in axes.lines:
            lines.setdefault(str(line.get_label()), []).append((axes, line))
    groups: list[list[str]] = []
    for label in filter(lines.__contains__, labels):
        over = (group for group in groups if _hide(lines[group[0]], lines[label]))
        if (group := next(over, None)) is None:
            groups.append([label])
        else:
            group.append(label)
    return groups


def _hide(ones: Sequence[tuple[Axes, Line2D]], others: Sequence[tuple[Axes, Line2D]]) -> bool:
    if len(ones) != len(others):
        return False
    return all(
        axes is there and _near(axes, one, other) for (axes, one), (there, other) in zip(ones, others, strict=True)
    )


def _near(axes: Axes, one: Line2D, other: Line2D) -> bool:
    """Whether there are lines through the same x whose y hardly differ; those without points hide nothing."""
    first, second = (np.asarray(line.get_xydata(), float) for line in (one, other))
    if first.shape != second.shape or not np.isfinite(first).all(axis=1).any():
        return False
    low, high = axes.get_ylim()
    room = np.array([0.0, HIDDEN * abs(high - low)])
    return bool(((abs(first - second) <= room) | (np.isnan(first) & np.isnan(second))).all())


def legend(axes: Axes, **place: Any) -> None:
    """Names of the lines, those together that hide one another: their mark is that of the one on top."""
    marks = dict(zip(*axes.get_legend_handles_labels()[::-1], strict=True))
    groups = together([axes], marks)
    style: dict[str, Any] = {"frameon": False, "fontsize": "small"} | place
    axes.legend([marks[group[-1]] for group in groups], map(", ".join, groups), **style)


def above(figure: Figure, marks: Sequence[Line2D]) -> None:
    """A key above a figure, in as many columns as there is room for."""
    style: dict[str, Any] = {"handletextpad": 0.2, "columnspacing": 1.2, "frameon": False}
    for columns in range(min(len(marks), COLUMNS), 0, -1):
        key = figure.legend(handles=marks, loc="outside upper right", ncols=columns, **style)
        if columns == 1 or key.get_window_extent().width <= figure.bbox.width:
            return
        key.remove()


def canvas(width: float, height: float) -> Figure:
    """An empty figure, in inches, without a window or global state."""
    from matplotlib.figure import Figure

    return Figure(figsize=(width, height), layout="constrained")


def svg(figure: Figure) -> str:
    """A figure as a data URI: its ids are apart from those of other figures on the page."""
    return "data:image/svg+xml;base64," + base64.b64encode(rendered(figure, "svg")).decode()


def rendered(figure: Figure, form: str, dpi: float = 100.0) -> bytes:
    """A figure as a file of one of the FORMS, the same from the same data; dpi: of pixels."""
    buffer = io.BytesIO()
    literal(figure)
    figure.savefig(buffer, format=form, dpi=dpi, metadata=FORMS[form])
    return buffer.getvalue()


def literal(figure: Figure) -> None:
    """Have texts drawn as they are: those of users may have a $ or two. Powers of ten along an axis are formulas."""
    from matplotlib.text import Text

    scales = [axis for axes in figure.axes for axis in (axes.xaxis, axes.yaxis)]
    marks = {axis: axis.get_ticklabels(which="both") for axis in scales}  # made now, where they have not been
    powers = {mark for axis, some in marks.items() if axis.get_scale() == "log" for mark in some}
    for text in set(figure.findobj(Text)) - powers:
        text.set_parse_math(False)


def categories(axes: Axes, names: Sequence[str]) -> None:
    """Names down the y axis, the first on top, with hairlines between them."""
    axes.set_yticks(range(len(names)), names)
    axes.set_ylim(len(names) - 0.5, -0.5)
    axes.tick_params(axis="y", length=0)
    axes.spines["left"].set_visible(False)
    for edge in range(1, len(names)):
        axes.axhline(edge - 0.5, color=FAINT, linewidth=0.6, zorder=0)


def decades(axes: Axes, low: float, high: float) -> None:
    """A logarithmic x axis over whole decades and a mark's width, with no numbers between them."""
    from matplotlib.ticker import LogLocator, NullFormatter

    axes.set_xscale("log")
    first, last = math.floor(math.log10(low)), max(math.ceil(math.log10(high)), math.floor(math.log10(low)) + 1)
    beyond = MARGIN * (last - first)
    axes.set_xlim(10.0 ** (first - beyond), 10.0 ** (last + beyond))
    axes.xaxis.set_major_locator(LogLocator(numticks=6))
    axes.xaxis.set_minor_formatter(NullFormatter())


def ratios(axes: Axes, places: np.ndarray) -> None:
    """A logarithmic x axis with numbers at its own places if they are few, at 1, 2, 5 if it is short, else at tens."""
    from matplotlib.ticker import LogLocator, NullFormatter, StrMethodFormatter

    known = np.unique(places)
    axes.set_xscale("log")
    if known.size <= TICKS:
        axes.set_xticks(known, [f"{number:g}" for number in known])
    elif known[-1] < SHORT * known[0]:
        axes.xaxis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
        axes.xaxis.set_major_formatter(StrMethodFormatter("{x:g}"))
    axes.xaxis.set_minor_formatter(NullFormatter())


def lanes(count: int) -> list[float]:
    """Offsets of so many series within a category, the first on top."""
    return [(i - (count - 1) / 2) * 0.8 / max(count, 1) for i in range(count)]
