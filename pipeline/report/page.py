"""The report as one file: results/<study>/report.html, tables and figures of a collected dataset."""

from __future__ import annotations

import itertools
import math
import re
from collections import Counter
from collections.abc import Iterator, Set
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from pipeline.report import figures, ranking, report
from pipeline.report.captions import entries, held
from pipeline.report.drawing import plain, rendered, svg
from pipeline.report.figures import Results
from pipeline.report.overview import TEXT, overview
from pipeline.report.periods import natural_periods
from pipeline.report.published import read_published
from pipeline.report.tables import of_survivors
from pipeline.report.template import PAGE
from pipeline.results import dataset
from pipeline.results.status import FEW, MANY, without_numbers
from pipeline.results.store import write_atomic
from pipeline.study.axes import UNCHANGED
from pipeline.study.schema import StudyFile
from pipeline.tasks.study import Study
from pipeline.tasks.task import axes

if TYPE_CHECKING:
    from matplotlib.figure import Figure

VERSION = "version_"
LONGEST, DPI = 80, 200.0  # letters of a figure's file name, and its pixels


def results_of(study: Study, path: Path) -> Results:
    """A study beside its dataset and the published numbers, if there are any."""
    published = read_published(study.published) if study.published else []
    return Results(study=study, data=dataset.loaded(path), published=published, tasks=path.parent / "tasks")


def write(study: Study, path: Path) -> Path:
    """The report beside the dataset at `path`."""
    page = path.with_name("report.html")
    write_atomic(page, html(results_of(study, path)).encode())
    return page


def write_figure(study: Study, path: Path, figure: Path) -> None:
    """The one-figure summary, PNG."""
    results = results_of(study, path)
    with plain(TEXT):
        write_atomic(figure, rendered(overview(results), "png"))


def write_figures(study: Study, path: Path, form: str) -> Iterator[Path]:
    """Each of the report's figures by itself, in the folder `figures` beside the dataset at `path`."""
    folder = path.with_name("figures")
    folder.mkdir(exist_ok=True)
    for title, _, figure in _made(results_of(study, path)):
        words = re.sub(r"\W+", "-", re.sub(r"-(?=\d)", "minus-", title.lower())).strip("-")
        file = folder / f"{words[:LONGEST]}.{form}"
        write_atomic(file, rendered(figure, form, DPI))
        yield file


def html(results: Results) -> str:
    """The whole page."""
    from jinja2 import Environment, StrictUndefined

    page = Environment(autoescape=True, undefined=StrictUndefined, trim_blocks=True, lstrip_blocks=True)
    return page.from_string(PAGE).render(
        title=results.data.attrs.get("title", results.study.name),
        facts=facts(results),
        troubles={
            "Not done": troubles(results),
            "Asked and not met": unmet(results),
            "Warnings": warnings(results),
            "Published numbers that name what this study does not have": report.strange(
                results.data, results.published, results.study.content
            ),
        },
        tables=(beside := published_tables(results)),
        survivors=of_survivors(row for table in beside for row in table["rows"]),
        verdicts=report.verdicts(results.data, results.published),
        summary=[] if report.speaks(results.data, results.published) else list(report.summary_rows(results.data)),
        figures=list(drawn(results)),
        periods=list(natural_periods(results)),
        held=held(results),
        named=held(results, *(dim for row in results.published for dim in row.selection)),
        answers=report.answers(results.data),
        again=ranking.again(results.study.content, results.data),
    )


def facts(results: Results) -> list[tuple[str, str]]:
    """What was run, and with what."""
    attributes = {str(key): str(value) for key, value in results.data.attrs.items()}
    varied = {name: values for name, values in axes(results.study.content).items() if len(values) > 1}
    cells = math.prod(len(values) for values in varied.values())
    product = " × ".join(f"{name.replace('_', ' ')} ({len(values)})" for name, values in varied.items())
    count = _asked(results).size or cells
    duration, discard = _lengths(results.study.content, "duration"), _lengths(results.study.content, "discard")
    every = ", every task" if len(duration) == len(discard) == 1 else ""
    rows = [
        ("Study", results.study.path.name),
        ("Tasks", f"{_states(results)} of {count}" + (f" = {product}" if varied and count == cells else "")),
        ("Record", f"{_range(duration)} s analysed after {_range(discard)} s{every}"),
        ("Estimated error", report.estimated(results.data)),
        ("Source", attributes.get("source", "")),
        ("Signs", attributes.get("sign_conventions", "")),
    ]
    parts = {k.removeprefix(VERSION): v for k, v in attributes.items() if k.startswith(VERSION)}
    versions = [f"{name.replace('_', ' ')} {value}" for name, value in parts.items() if name != "host"]
    return [row for row in [*rows, ("Versions", ", ".join(versions))] if row[1]]


def _lengths(content: StudyFile, key: str) -> set[float]:
    """What tasks have of a length of records [s]: the study's own, or those of the axis over it."""
    path, own = f"record.{key}", getattr(content.record, key)
    values = next((axis.keys[path] for axis in content.varied if path in axis.keys), (UNCHANGED,))
    return {own if value is UNCHANGED else value for value in values}


def _range(numbers: Set[float]) -> str:
    return " to ".join(f"{number:g}" for number in sorted({min(numbers), max(numbers)}))


def _asked(results: Results) -> np.ndarray:
    """States of the tasks, in a row."""
    if "status" not in results.data:
        return np.array([], str)
    return np.asarray(results.data["status"].values[dataset.once(results.data["task"].values)].astype(str))


def _states(results: Results) -> str:
    states, counts = np.unique(_asked(results), return_counts=True)
    return ", ".join(f"{count} {state}" for state, count in zip(states, counts, strict=True))


def troubles(results: Results) -> list[str]:
    """Tasks that are not done, the first of them by name, and why."""
    return _named(results, "status", "done", "failure")


def unmet(results: Results) -> list[str]:
    """Tasks that did not meet what was asked, the first of them by name."""
    return _named(results, "unmet", "")


def warnings(results: Results) -> list[str]:
    """What is odd about tasks, and about how many; those whose words differ in numbers alone together, as the first."""
    if "warnings" not in results.data:
        return []
    words = results.data["warnings"].values.astype(str)[dataset.once(results.data["task"].values)].tolist()
    counts, first = Counter(map(without_numbers, words)), {without_numbers(text): text for text in words[::-1]}
    del counts[""]
    lines = [f"{first[alike]} ({count} of {len(words)} tasks)" for alike, count in counts.most_common(MANY)]
    return lines + ([f"and {len(counts) - MANY} more"] if len(counts) > MANY else [])


def _named(results: Results, name: str, usual: str, more: str = "") -> list[str]:
    """Tasks of which a word is not the usual one, where they stand first, and that word, with more of them if any.

    Those whose words differ in numbers alone are together, with the first one's.
    """
    if name not in results.data:
        return []
    words, reasons = results.data[name], results.data[more].values if more in results.data else None
    alike: dict[str, tuple[str, list[tuple[int, ...]]]] = {}
    unusual = (words.values.astype(str) != usual) & dataset.once(results.data["task"].values)
    for place in map(tuple, np.argwhere(unusual)):
        reason = str(reasons[place]) if reasons is not None else ""
        text = f"{words.values[place]}{': ' if reason else ''}{reason}"
        alike.setdefault(without_numbers(text), (text, []))[1].append(place)
    lines = []
    for text, places in itertools.islice(alike.values(), MANY):
        cells = (words[place] for place in places[:FEW])
        labels = "; ".join(", ".join(f"{dim} {cell[dim].values}" for dim in words.dims) for cell in cells)
        others = f" and {len(places) - FEW} more" if len(places) > FEW else ""
        lines.append(f"{labels}{others}: {text}".removeprefix(": "))
    left = sum(len(places) for _, places in itertools.islice(alike.values(), MANY, None))
    return lines + ([f"and {left} more"] if left else [])


def published_tables(results: Results) -> list[dict[str, Any]]:
    """The published tables: rows of text, and the sentences about numbers that are far off."""
    made = []
    for title, mine in report.tables(results.data, results.published).items():
        rows = [report.line(r, n) for r, n in mine]
        made.append({"title": title, "rows": rows, "sentences": list(report.sentences(mine))})
    return made


def drawn(results: Results) -> Iterator[dict[str, str]]:
    """Every figure, as the page has it."""
    for title, caption, figure in _made(results):
        crosses = " Crosses: published." if figures.crossed(figure) else ""
        yield {"title": title, "caption": caption + crosses, "source": svg(figure)}


def _made(results: Results) -> Iterator[tuple[str, str, Figure]]:
    """Title, caption and figure, of every one that the dataset has the variables for."""
    for title, caption, make in entries(results):
        with plain():
            figure = make(results)
            if figure is not None:
                yield title, caption, figure
