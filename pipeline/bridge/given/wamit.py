"""WAMIT's numeric files (.1 added mass and damping, .3 or .2 exciting force, .hst) and its .out.

Numbers are without units: A/(ρLᵏ), B/(ρωLᵏ), k = 3, 4 or 5 by how many of the two motions turn; X/(ρgLᵐ), m = 2 or 3;
C/(ρgLᵏ⁻¹). L is 1 m in the numeric files, which do not tell it, and said in .out. Phases of Re{X exp(+iωt)}; moments
about each body's origin.
"""

from __future__ import annotations

import json
import re
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from pipeline.bridge.given.lines import lines, require_polar

if TYPE_CHECKING:
    from pipeline.study.attachments import Attachment
    from solver.hydrodynamics.bem.given import Given

ZERO, INFINITE = -1.0, 0.0  # periods that stand for zero and for infinite frequency
OUT_RADIATION = r"ADDED-MASS(?: AND DAMPING)? COEFFICIENTS[^\n]*\n[^\n]*\n(.*?)(?:\n\s*\n\s*\n|\Z)"  # in .out
EXCITING = "EXCITING FORCES AND MOMENTS"  # of a title in .out
FORCES = (".3", ".2")  # by diffraction, by Haskind's relation


class _Table(NamedTuple):
    """Rows of the numeric files: period, indices from 1, numbers."""

    radiation: np.ndarray  # (nr, 5) PER I J A B, B = 0 in the limits
    force: np.ndarray  # (nf, 7) PER BETA I Mod Pha Re Im
    stiffness: np.ndarray  # (ns, 3) I J C
    incident: np.ndarray  # as force


def read(file: Attachment, density: float, gravity: float) -> Given:
    """The files that go with one of them by name."""
    texts: dict[str, str] = json.loads(file.data)
    force = next((kind for kind in FORCES if kind in texts), None)
    if ".1" not in texts or force is None:
        raise ValueError(f"needs .1 and .3 (or .2) beside each other, has {', '.join(texts)}")
    table = _Table(
        radiation=_radiation(texts[".1"]),
        force=_forces(texts[force], force),
        stiffness=lines(texts.get(".hst", ""), ".hst", width=3, keys=2).table,
        incident=_forces(texts.get(".3fk", ""), ".3fk"),
    )
    for kind, rows in {".1": table.radiation, force: table.force}.items():
        if not len(rows):
            raise ValueError(f"{kind} has no rows of numbers")
    return _given(file.name, table, density=density, gravity=gravity)


def _radiation(text: str) -> np.ndarray:
    """Rows of .1, which have no damping in the limits alone."""
    read = lines(text, ".1", width=5, keys=3, least=4)
    lacks = np.flatnonzero(~np.isfinite(read.table[:, 4]) & (read.table[:, 0] > 0))
    if len(lacks):
        more = f", nor have {len(lacks) - 1} others" if len(lacks) > 1 else ""
        read.refuse(lacks[0], f"has no damping that is finite, the fifth number at finite periods{more}")
    whole: np.ndarray = np.nan_to_num(read.table)
    return whole


def _forces(text: str, kind: str) -> np.ndarray:
    read = lines(text, kind, width=7, keys=3)
    require_polar(read)
    return read.table


def _given(
    name: str,
    table: _Table,
    *,
    density: float,
    gravity: float,
    length: float = 1.0,
    depth: float | None = None,
    points: np.ndarray | None = None,
) -> Given:
    """Arrays with units from the rows; without points nothing says how many bodies without motions come after them."""
    from solver.hydrodynamics.bem.given import Given
    from solver.scene import DOFS

    period, i, j = table.radiation[:, 0], *(table.radiation[:, k].astype(int) - 1 for k in (1, 2))
    forces = [_motions(rows[:, 2]) for rows in (table.force, table.incident) if len(rows)]
    numbered = set().union({0}, i, j, *forces, _motions(table.stiffness[:, :2].ravel()))
    n = 6 * max(1 + int(max(numbered)) // 6, 0 if points is None else len(points))
    turns = np.arange(n) % 6 >= 3
    unit = density * length ** (3.0 + turns[:, None] + turns)
    periods = np.unique(period[period > 0])
    added, damping, infinite = np.zeros((2, len(periods), n, n)), None, None
    at = np.searchsorted(periods, period)
    real = period > 0
    _require_whole(table.radiation, n)
    for part, column in enumerate((3, 4)):
        added[part][at[real], i[real], j[real]] = table.radiation[real, column]
    omega = 2 * np.pi / periods
    damping = added[1] * unit * omega[:, None, None]
    if (limit := period == INFINITE).any():
        infinite = np.zeros((n, n))
        infinite[i[limit], j[limit]] = table.radiation[limit, 3]
        infinite *= unit
    headings = np.unique(table.force[:, 1])
    stiffness = None
    if len(table.stiffness):
        stiffness = np.zeros((n, n))
        rows, columns = (table.stiffness[:, k].astype(int) - 1 for k in (0, 1))
        stiffness[rows, columns] = table.stiffness[:, 2]
        stiffness *= density * gravity * length ** (2.0 + turns[:, None] + turns)
    forced = _force(table.force, periods, headings, turns, length)
    present = np.array(sorted(_motions(table.radiation[real, 1]).intersection(*forces)), int)
    return Given(
        name=name,
        omega=omega,
        added_mass=(added[0] * unit)[:, present[:, None], present],
        radiation_damping=damping[:, present[:, None], present],
        added_mass_inf=None if infinite is None else infinite[np.ix_(present, present)],
        headings=np.radians(headings),
        excitation=density * gravity * forced[..., present],
        froude_krylov=None
        if not len(table.incident)
        else density * gravity * _force(table.incident, periods, headings, turns, length)[..., present],
        columns=tuple((k // 6, DOFS[k % 6]) for k in present),
        bodies=() if points is None else ("",) * (n // 6),
        points=points,
        stiffness=None if stiffness is None else stiffness[np.ix_(present, present)],
        depth=depth,
        density=density,
        gravity=gravity,
        time_sign=1,
    )


def _require_whole(radiation: np.ndarray, n: int) -> None:
    """Refuse rows that are missing: WAMIT leaves out what symmetry makes zero, which is so at all periods, and is of no
    motion of one body on the same one of another.
    """
    i, j = (radiation[:, k].astype(int) - 1 for k in (1, 2))
    periods, at = np.unique(radiation[:, 0], return_inverse=True)
    has = np.zeros((len(periods), n, n), bool)
    has[at, i, j] = True
    some: np.ndarray = np.any(has, axis=0)
    told, own = periods != ZERO, np.flatnonzero(np.diagonal(some))
    some[np.ix_(own, own)] |= np.equal.outer(own % 6, own % 6)
    lacks = np.argwhere(some & ~has & told[:, None, None])
    if len(lacks):
        w, row, column = lacks[0]
        period = "infinite frequency" if periods[w] == INFINITE else f"period {periods[w]:g} s"
        raise ValueError(f"lacks added mass of motions {row + 1} and {column + 1} at {period}")


def _motions(numbers: np.ndarray) -> set[int]:
    """Indices from 0 of the motions with these numbers."""
    return {int(number) - 1 for number in numbers}


def _force(rows: np.ndarray, periods: np.ndarray, headings: np.ndarray, turns: np.ndarray, length: float) -> np.ndarray:
    """(nw, nh, n) over ρg, conjugated to Re{X exp(-iωt)}; refused where a period or heading of a motion is missing."""
    force = np.zeros((len(periods), len(headings), len(turns)), complex)
    has = np.zeros(force.shape, bool)
    rows = rows[np.isin(rows[:, 0], periods)]
    w, h, i = np.searchsorted(periods, rows[:, 0]), np.searchsorted(headings, rows[:, 1]), rows[:, 2].astype(int) - 1
    force[w, h, i], has[w, h, i] = rows[:, 5] - 1j * rows[:, 6], True
    lacks = ~has[..., sorted(_motions(rows[:, 2]))].all(axis=(1, 2))  # others the run left out
    if lacks.any():
        missing = periods[lacks][0]
        raise ValueError(f"the exciting force lacks period {missing:g} s, which added mass has, in some heading")
    return force * length ** (2.0 + turns)


def read_out(file: Attachment, density: float, _gravity: float) -> Given:
    """The printed output, with length scale, depth, places of the bodies and the angles of their axes, to which all
    numbers refer; phases are whole degrees there.

    It tells the water's density only where the run's force control file did; `density` stands for it elsewhere.
    """
    from solver.hydrodynamics.bem.given import turned

    text = file.data.decode("latin-1")
    number = r"([-+0-9.Ee]+|infinite)"
    gravity, length, depth = (
        float(_found(text, f"{word}:\\s+{number}").replace("infinite", "inf"))
        for word in ("Gravity", "Length scale", "Water depth")
    )
    if told := re.search(f"Water density:\\s+{number}", text):
        density = float(told[1])
    place = rf"XBODY =\s*{number}\s+YBODY =\s*{number}\s+ZBODY =\s*{number}(?:\s+PHIBODY =\s*{number})?"
    places = np.array([[float(v or 0) for v in found] for found in re.findall(place, text)])
    radiation, force = [], []
    for part in re.split(r"Wave period", text)[1:]:
        period = _period(part.splitlines()[0])
        if block := re.search(OUT_RADIATION, part, re.S):
            least = 4 if period > 0 else 3  # without damping in the limits
            rows = lines(block.group(1), f"period {period:g} s,", width=4, keys=2, least=least).table
            radiation += [[period, *row] for row in np.nan_to_num(rows).tolist()]
        force += _out_forces(part, period)
    heave = [float(found) for found in re.findall(rf"C\(3,3\),C\(3,4\),C\(3,5\):\s*{number}", text)]
    stiffness = np.array([[6 * b + 3, 6 * b + 3, value] for b, value in enumerate(heave)]).reshape(-1, 3)
    table = _Table(np.array(radiation), np.array(force), stiffness, np.zeros((0, 7)))
    if not len(table.radiation) or not len(table.force):
        raise ValueError("has no added mass, or no exciting forces")
    points = places[:, :3] if len(places) else None
    given = _given(file.name, table, density=density, gravity=gravity, length=length, depth=depth, points=points)
    return turned(given, np.radians(places[:, 3])) if len(places) else given


def _found(text: str, pattern: str) -> str:
    match = re.search(pattern, text)
    if match is None:
        raise ValueError(f"has no line with {pattern.partition(':')[0]}")
    return match.group(1)


def _period(line: str) -> float:
    """Of a line such as "(sec) = 3.1E+00 ..."; words stand for the limits."""
    if not (words := line.partition("=")[2].split()):
        raise ValueError("a wave period has no number: is the file cut off?")
    word = words[0]
    return {"infinite": ZERO, "zero": INFINITE}.get(word) if word[0].isalpha() else float(word)  # type: ignore[return-value]


def _out_forces(part: str, period: float) -> list[list[float]]:
    """Rows as of .3 of the forces by diffraction, else of those by Haskind's relation."""
    for title in ("DIFFRACTION", "HASKIND"):
        block = part.partition(f"{title} {EXCITING}")[2]
        if not block:
            continue
        rows = []
        # RAOs, drift forces and others follow by the same headings, in rows of the same form.
        for piece in block.partition(EXCITING)[0].split("Wave Heading (deg) :")[1:]:
            beta = float(piece.split()[0])
            if "Mod[X" not in piece:
                break
            for line in piece.splitlines()[1:]:
                words = line.split()
                if len(words) == 3 and words[0].lstrip("-").isdigit():
                    size, phase = float(words[1]), float(words[2])
                    i = abs(int(words[0]))
                    if not np.isfinite([size, phase]).all():
                        raise ValueError(f"period {period:g} s, force of motion {i} is not finite: {line.strip()}")
                    at = size * np.exp(1j * np.radians(phase))
                    rows.append([period, beta, i, size, phase, at.real, at.imag])
                elif "Mod[" not in line and any(map(str.isalpha, line)):
                    break
        return rows
    return []
