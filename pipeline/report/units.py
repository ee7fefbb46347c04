"""Units in which others print what a dataset has in its own: kN for N, deg for rad, t for kg."""

from __future__ import annotations

import math
import re

from pipeline.report.yearly import HOUR, YEAR
from pipeline.results.variables import udunits

PREFIXES = {"k": 1e3, "M": 1e6, "G": 1e9, "m": 1e-3}
PREFIXED = ("m", "N", "Pa", "W", "J", "s", "rad")
OTHERS = {  # so many of the unit that datasets have
    "rad": {"deg": math.pi / 180, "°": math.pi / 180},
    "kg": {"t": 1e3, "g": 1e-3},
    "s": {"min": 60.0, "h": HOUR, "year": YEAR * HOUR},
    "h": {"s": 1 / HOUR, "min": 60.0 / HOUR, "year": YEAR},
    "1": {"-": 1.0, "%": 0.01},
}
PART = re.compile(r"(?P<name>[^\s\d-]+|-|1)(?P<power>-?\d+)?")  # of a unit: s-1


def factor(symbol: str, own: str) -> float | None:
    """How many of a dataset's unit one of another is; None where they are not of one kind, part by part."""
    parts, owns = _parts(symbol), own.split()
    each = [size for pair in zip(parts, owns, strict=False) if (size := _of_part(*pair)) is not None]
    return math.prod(each) if len(parts) == len(owns) == len(each) else None


def allowed(own: str) -> str:
    """What a unit may be instead of a dataset's own, in words."""
    names = list(dict.fromkeys(match["name"] for part in own.split() if (match := PART.fullmatch(part))))
    others = [f"{' or '.join(OTHERS[name])} for {name}" for name in names if name in OTHERS]
    prefixed = [name for name in names if name in PREFIXED]
    more = [f"{', '.join(PREFIXES)} before {' or '.join(prefixed)}"] * bool(prefixed) + others
    return f"{own}, with {', '.join(more)}" if more else own


def _parts(symbol: str) -> list[str]:
    """N m s/rad as N, m, s, rad-1."""
    return [word for word in udunits(symbol.strip()).split() if word != "1"] or ["1"]


def _of_part(part: str, own: str) -> float | None:
    if part == own:
        return 1.0
    match, wanted = PART.fullmatch(part), PART.fullmatch(own)
    if match is None or wanted is None or match["power"] != wanted["power"]:
        return None
    name, of = match["name"], wanted["name"]
    size = OTHERS.get(of, {}).get(name)
    if size is None and of in PREFIXED and name[1:] == of:
        size = PREFIXES.get(name[0])
    return None if size is None else size ** int(wanted["power"] or 1)
