"""Lines of numbers, as WAMIT prints them: what they lack, and where they contradict each other."""

from __future__ import annotations

from typing import NamedTuple, NoReturn

import numpy as np

PRINTED = 1e-3  # relative: numbers that differ by less may be the same, printed otherwise,
NOTHING = 1e-6  # and those that are less of the largest in their column
POLAR = 0.02  # of a force: what its modulus and phase, in whole degrees, may be from its parts,
FAINT = 1e-3  # and of the largest of its motion


class Lines(NamedTuple):
    """Numbers by rows, NaN where a row is short, and where they are in their file."""

    kind: str
    numbers: tuple[int, ...]
    table: np.ndarray

    def refuse(self, row: int, text: str) -> NoReturn:
        """Of one of the rows."""
        raise ValueError(f"{self.kind} line {self.numbers[row]} {text}")


def lines(text: str, kind: str, *, width: int, keys: int, least: int = 0) -> Lines:
    """Those of numbers, `least` to `width` of them; a heading is passed over.

    ValueError where other text follows, a number that must be there is not finite, or two rows tell otherwise of the
    same, which their first `keys` numbers say.
    """
    numbers: list[int] = []
    rows: list[list[float]] = []
    for number, line in enumerate(text.splitlines(), 1):
        words = line.replace("D", "E").split()
        try:
            values = [float(word) for word in words[:width]]
        except ValueError:
            if rows:
                raise ValueError(f"{kind} line {number} is no row of numbers: {line.strip()[:40]}") from None
            continue
        if words and len(values) < (least or width):
            raise ValueError(f"{kind} line {number} has {len(values)} numbers, {width} are needed")
        if not np.isfinite(values[: least or width]).all():
            raise ValueError(f"{kind} line {number} has a number that is not finite: {line.strip()[:40]}")
        if words:
            numbers.append(number)
            rows.append(values + [np.nan] * (width - len(values)))
    read = Lines(kind, tuple(numbers), np.array(rows).reshape(-1, width))
    _require_one(read, keys)
    return read


def _require_one(read: Lines, keys: int) -> None:
    """Refuse two rows of the same whose numbers differ by more than printing does."""
    _, first, which = np.unique(read.table[:, :keys], axis=0, return_index=True, return_inverse=True)
    before, told = first[which.ravel()], np.nan_to_num(read.table[:, keys:])
    small = NOTHING * np.abs(told).max(axis=0, initial=0.0)
    others = np.flatnonzero(~np.isclose(told, told[before], rtol=PRINTED, atol=small).all(axis=1))
    if len(others):
        one = read.numbers[before[others[0]]]
        read.refuse(others[0], f"tells of the same as line {one} with other numbers: are two runs in one file?")


def require_polar(read: Lines, motion: int = 2) -> None:
    """Refuse forces whose modulus and phase, in degrees or radians, are not those of their parts, the last two."""
    size, angle, real, imaginary = read.table[:, motion + 1 :].T
    told = real + 1j * imaginary
    which = np.unique(read.table[:, motion], return_inverse=True)[1].ravel()
    largest = np.zeros(which.max(initial=0) + 1)
    np.fmax.at(largest, which, np.abs(told))
    may = np.fmax(POLAR * np.abs(told), FAINT * largest[which])

    def off(phase: np.ndarray) -> np.ndarray:
        return np.flatnonzero(np.abs(size * np.exp(1j * phase) - told) > may)

    wrong = min(off(np.radians(angle)), off(angle), key=len)
    if size.any() and len(wrong):  # some leave modulus and phase out
        turned = len(off(-np.radians(angle))) < len(wrong)
        text = f"has a modulus and phase that are not those of its real and imaginary part, as {len(wrong)} rows have"
        read.refuse(wrong[0], f"{text}{'; the phase has the other sign' if turned else ''}")
