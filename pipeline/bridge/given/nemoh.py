"""Nemoh's RadiationCoefficients.tec and ExcitationForce.tec, in SI; amplitude and phase [rad] of Re{X exp(-iωt)}.

Nemoh.cal in the folder above says the water, each body's motions and the point it turns about; without it, as capytaine
exports, each body has six motions about its own reference point.
"""

from __future__ import annotations

import json
import math
import re
from collections.abc import Iterator
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from pipeline.study.attachments import NEMOH, Attachment

if TYPE_CHECKING:
    from solver.hydrodynamics.bem.given import Given

RADIATION, EXCITATION, INCIDENT, CASE = NEMOH
AXES = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))
TRANSLATION, ROTATION = 1, 2
_Rows = list[tuple[int, list[str]]]  # of Nemoh.cal: number of the line, words before an exclamation mark


class _Case(NamedTuple):
    """What Nemoh.cal says."""

    columns: tuple[tuple[int, str], ...]
    points: np.ndarray  # of each body, NaN where it turns about none
    density: float
    gravity: float
    depth: float


def read(file: Attachment, _density: float, _gravity: float) -> Given:
    """The files of a run, by the name of one of them."""
    from solver.hydrodynamics.bem.given import Given
    from solver.scene import DOFS

    texts: dict[str, str] = json.loads(file.data)
    if missing := {RADIATION, EXCITATION} - texts.keys():
        raise ValueError(f"needs {' and '.join(sorted(missing))} beside it")
    case = _case(texts[CASE]) if CASE in texts else None
    radiation = [rows for _, rows in _zones(texts[RADIATION], RADIATION)]
    n = len(radiation)
    omega = radiation[0][:, 0]
    columns = case.columns if case else tuple((k // 6, DOFS[k % 6]) for k in range(n))
    if n != len(columns) or (not case and n % 6):
        told = f"{CASE} has {len(columns)}" if case else f"without {CASE} it must be six for each body"
        raise ValueError(f"{RADIATION} has {n} motions, {told}")
    both = np.stack([_pairs(rows, omega, n, RADIATION) for rows in radiation], axis=2)  # motion last
    headings, excitation = _forces(texts[EXCITATION], omega, n, EXCITATION)
    incident = None
    if INCIDENT in texts:
        others, incident = _forces(texts[INCIDENT], omega, n, INCIDENT)
        if not np.array_equal(others, headings):
            raise ValueError(f"{INCIDENT} has other directions than {EXCITATION}")
    return Given(
        name=file.name,
        omega=omega,
        added_mass=both[..., 0],
        radiation_damping=both[..., 1],
        added_mass_inf=None,
        headings=headings,
        excitation=excitation,
        froude_krylov=incident,
        columns=columns,
        bodies=("",) * len(case.points) if case else (),
        points=case.points if case else None,
        depth=case.depth if case else None,
        density=case.density if case else None,
        gravity=case.gravity if case else None,
    )


def _zones(text: str, name: str) -> Iterator[tuple[str, np.ndarray]]:
    """Titles of the blocks and their numbers (nw, 1 + 2n); long rows may be broken over lines."""
    head, *blocks = [part for part in re.split(r"^(?=[A-Za-z])", text, flags=re.M) if part.strip()] or [""]
    if not blocks:
        raise ValueError(f"{name} has no blocks of numbers")
    named = head.count('"') // 2  # the frequency and two numbers of each motion; capytaine writes dots
    if named and "rad/s" not in head:
        raise ValueError(f"must be over w (rad/s), is over {head.splitlines()[0].partition('=')[2].strip()}")
    for block in blocks:
        title, _, body = block.partition("\n")
        width = named or len(body.partition("\n")[0].split())
        try:
            yield title, np.array(body.split(), float).reshape(-1, width)
        except ValueError:
            raise ValueError(f"{name}: below {title!r} are no whole rows of {width} numbers") from None


def _pairs(rows: np.ndarray, omega: np.ndarray, n: int, name: str) -> np.ndarray:
    """Both numbers of n columns (nw, n, 2)."""
    if rows.shape != (len(omega), 1 + 2 * n) or not np.array_equal(rows[:, 0], omega):
        raise ValueError(f"{name} must have the frequencies and {n} motions of {RADIATION} in every block")
    return rows[:, 1:].reshape(len(omega), n, 2)


def _forces(text: str, omega: np.ndarray, n: int, name: str) -> tuple[np.ndarray, np.ndarray]:
    """Directions (nh,) [rad] and forces (nw, nh, n)."""
    headings, forces = [], []
    for title, rows in _zones(text, name):
        told = re.search(r"(beta|angle)\s*=\s*([-+.\dEe]+)", title)
        if told is None:
            raise ValueError(f"{name}: no direction in {title!r}")
        headings.append(math.radians(float(told[2])) if told[1] == "beta" else float(told[2]))
        size, phase = np.moveaxis(_pairs(rows, omega, n, name), 2, 0)
        forces.append(size * np.exp(1j * phase))
    return np.array(headings), np.stack(forces, axis=1)


def _case(text: str) -> _Case:
    numbered = enumerate(text.splitlines(), 1)
    rows = [(at, line.partition("!")[0].split()) for at, line in numbered if not line.startswith("---")]
    density, gravity, depth = (_numbers(rows, 1)[0] for _ in range(3))
    if any(_numbers(rows, 2)):
        raise ValueError(f"{CASE}: waves must be measured at the origin, XEFF YEFF = 0 0")
    columns: list[tuple[int, str]] = []
    points: list[tuple[float, ...]] = []
    for body in range(_count(rows)):
        del rows[:2]  # mesh file, its size
        motions = [_motion(_numbers(rows, 7)) for _ in range(_count(rows))]
        forces = [_motion(_numbers(rows, 7)) for _ in range(_count(rows))]
        if motions != forces:
            raise ValueError(f"{CASE}: body {body + 1} must have a force for each of its motions, about the same point")
        del rows[: _count(rows)]
        columns += [(body, name) for name, _ in motions]
        about = {point for _, point in motions if point is not None}
        if len(about) > 1:
            raise ValueError(f"{CASE}: body {body + 1} turns about several points")
        points.append(about.pop() if about else (math.nan,) * 3)
    return _Case(tuple(columns), np.array(points), density, gravity, depth if depth > 0 else math.inf)


def _numbers(rows: _Rows, count: int) -> list[float]:
    """The first ones of the next row, which is taken; refused where they are none, or the file ends before."""
    if not rows:
        raise ValueError(f"{CASE} ends before all bodies, motions and forces that it announces are told")
    line, words = rows.pop(0)
    try:
        numbers = [float(word) for word in words[:count]]
    except ValueError:
        numbers = []
    if len(numbers) < count or not all(map(math.isfinite, numbers)):
        raise ValueError(
            f"{CASE} line {line} must begin with {count} number{'s' * (count > 1)}, is {' '.join(words)!r}"
        )
    return numbers


def _count(rows: _Rows) -> int:
    return int(_numbers(rows, 1)[0])


def _motion(numbers: list[float]) -> tuple[str, tuple[float, ...] | None]:
    """Name of a motion, and the point of a rotation."""
    from solver.scene import DOFS

    kind, axis, point = numbers[0], tuple(numbers[1:4]), tuple(numbers[4:])
    if kind not in (TRANSLATION, ROTATION) or axis not in AXES:
        told = " ".join(f"{number:g}" for number in numbers)
        raise ValueError(f"{CASE}: motions must be along or about x, y or z, not {told}")
    name = DOFS[AXES.index(axis) + (3 if kind == ROTATION else 0)]
    return name, point if kind == ROTATION else None
