"""One number beside a published one: verdict, table, CSV, and the files of published numbers."""

import csv
from dataclasses import dataclass
from pathlib import Path
from typing import Literal

import numpy as np

REFERENCE = Path(__file__).parents[2] / "tests" / "published"
OUT = Path("results/validate")
SIGNS = {"both": "", "below": "<", "above": ">"}
LEGEND = (
    "published: by others, or the exact or independent solution that the quantity names; allowed: absolute\n"
    "difference, with < or >: what others found is that ours lies below or above; shown: not judged."
)


@dataclass(frozen=True, kw_only=True)
class Check:
    """One published number beside ours.

    allowed: absolute difference, inf where a number is only shown. side "below" (or "above"): what
    others found is that ours lies below (above) `published`, a bound; the difference may then have
    only that sign, or `allowed` at most of the other. note: why a difference remains.
    """

    case: str
    quantity: str
    ours: float
    published: float
    allowed: float = np.inf
    side: Literal["both", "below", "above"] = "both"
    note: str = ""

    @property
    def difference(self) -> float:
        """Ours less published."""
        return self.ours - self.published

    @property
    def passed(self) -> bool:
        """Whether the difference is allowed; never for what is not a number."""
        over = {"both": abs(self.difference), "below": self.difference, "above": -self.difference}[self.side]
        return bool(over <= self.allowed) and bool(np.isfinite(self.ours))

    @property
    def verdict(self) -> str:
        """ok, OUTSIDE, or shown (not judged)."""
        if not self.passed:
            return "OUTSIDE"
        return "shown" if np.isinf(self.allowed) else "ok"


def columns(name: str) -> dict[str, np.ndarray]:
    """Columns of a file of published numbers."""
    rows = [line for line in (REFERENCE / name).read_text().splitlines() if not line.startswith("#")]
    values = np.array([[float(x) for x in line.split(",")] for line in rows[1:]]).T
    return dict(zip(rows[0].split(","), values, strict=True))


def text(checks: list[Check]) -> str:
    """The table, and under it the notes that it refers to."""
    notes = list(dict.fromkeys(c.note for c in checks if c.note))
    wide = [max(map(len, column)) + 2 for column in zip(*[(c.case, c.quantity) for c in checks], strict=True)]
    head = f"{'ours':>12s}{'published':>12s}{'difference':>12s}{'allowed':>10s} verdict"
    lines = [f"{'case':{wide[0]}s}{'quantity':{wide[1]}s}{head}"]
    for c in checks:
        allowed = "" if np.isinf(c.allowed) else f"{SIGNS[c.side]}{c.allowed:.2g}"
        numbers = f"{c.ours:12.6g}{c.published:12.6g}{c.difference:12.2g}{allowed:>10s}"
        mark = f" [{notes.index(c.note) + 1}]" if c.note else ""
        lines.append(f"{c.case:{wide[0]}s}{c.quantity:{wide[1]}s}{numbers} {c.verdict}{mark}")
    return "\n".join([*lines, LEGEND, *(f"[{i}] {note}" for i, note in enumerate(notes, 1))])


def write(checks: list[Check], path: Path) -> None:
    """The table as CSV."""
    with path.open("w", newline="") as file:
        rows = csv.writer(file)
        rows.writerow(["case", "quantity", "ours", "published", "difference", "allowed", "side", "verdict", "note"])
        for c in checks:
            rows.writerow([c.case, c.quantity, c.ours, c.published, c.difference, c.allowed, c.side, c.verdict, c.note])
