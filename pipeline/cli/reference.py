"""The keys of study files, as a table on the terminal and as Markdown, and what datasets have."""

from __future__ import annotations

import difflib
from collections.abc import Iterable, Iterator, Sequence

from rich.console import Console
from rich.markup import escape
from rich.table import Table

from pipeline.results.variables import KNOBS, OF_OUTPUTS, VARIABLES
from pipeline.study import reference
from pipeline.study.reference import Key
from solver.errors import InputError

COLUMNS = ("key", "unit", "default", "values", "meaning")
WIDTH = 150  # characters; where nobody knows how wide a page is


def print_keys(word: str, console: Console) -> None:
    """All keys, or those with a word in path, values or meaning."""
    found, every = reference.find(word), reference.find()
    if not found:
        words = {part.casefold() for key in every for part in key.path.replace("_", ".").split(".")}
        close = difflib.get_close_matches(word.casefold(), words, n=1)
        raise InputError("WORD", word, f"is in no key; did you mean {close[0]}?" if close else "is in no key")
    _print(COLUMNS, map(cells, found), console)


def print_outputs(word: str, console: Console) -> None:
    """All that datasets may have, and what goes with each output as <name>_spectrum does, or those with a word."""
    every = {name: (of.units or "", of.long_name) for table in (VARIABLES, KNOBS) for name, of in table.items()}
    every |= {f"<name>{suffix}": (unit.format("<unit>"), words) for suffix, (unit, words) in OF_OUTPUTS.items()}
    rows = [(name, unit.replace("{axis}", "m or rad").replace("{load}", "N or N m"), words)
            for name, (unit, words) in every.items() if word.casefold() in f"{name} {words}".casefold()]  # fmt: skip
    if not rows:
        close = difflib.get_close_matches(word, every, n=1)
        raise InputError("WORD", word, f"is in no output; did you mean {close[0]}?" if close else "is in no output")
    _print(("output", "unit", "meaning"), rows, console)


def _print(columns: Sequence[str], rows: Iterable[Iterable[str]], console: Console) -> None:
    table = Table(box=None, pad_edge=False)
    for i, name in enumerate(columns):
        table.add_column(name, overflow="fold", no_wrap=i == 0)
    for row in rows:
        table.add_row(*map(escape, row))
    (console if console.is_terminal else Console(file=console.file, width=WIDTH)).print(table)


def cells(key: Key) -> tuple[str, ...]:
    """One row of the table."""
    kinds = f" ({', '.join(key.of)})" if key.of else ""
    return key.path, key.unit.removeprefix("-"), key.default, key.values, key.meaning + kinds


def markdown() -> str:
    """Every table with its keys."""
    return "\n".join(_sections())


def _sections() -> Iterator[str]:
    for name, (about, keys) in reference.tables().items():
        yield f"### {f'[{name}]' if name else 'Above all tables'}\n"
        if about:
            yield f"{about}\n"
        yield _table(keys)


def _table(keys: Iterable[Key]) -> str:
    rows = [" | ".join(COLUMNS), " | ".join(["---"] * len(COLUMNS))]
    for key in keys:
        path, unit, default, values, meaning = (cell.replace("|", "\\|") for cell in cells(key))
        code = [f"`{text}`" if text and text != "required" else text for text in (path, default)]
        rows.append(" | ".join([code[0], unit, code[1], values, meaning]))
    return "".join(f"| {row} |\n" for row in rows)
