"""What is the same is made, or looked at, once: arrays as keys of caches, the first of things that are alike."""

from collections.abc import Callable, Iterator
from typing import Any, Generic, TypeVar

import numpy as np

T = TypeVar("T")


class Bits(Generic[T]):
    """Something that equals all that have the same types, shapes and bits: arrays, numbers, tuples of them."""

    def __init__(self, value: T):
        self.value = value
        self._bits = tuple(_bits(value))
        self._hash = hash(self._bits)

    def __hash__(self) -> int:
        return self._hash

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Bits) and self._bits == other._bits


class Same(Generic[T]):
    """Something that equals itself alone: sooner told from others than by its bits, where it is made once."""

    def __init__(self, value: T):
        self.value = value

    def __hash__(self) -> int:
        return id(self.value)

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Same) and self.value is other.value


def _bits(value: Any) -> Iterator[tuple[str, tuple[int, ...], bytes]]:
    if isinstance(value, tuple):
        for part in value:
            yield from _bits(part)
    else:
        array = np.asarray(value)
        yield array.dtype.str, array.shape, array.tobytes()


def shared(array: np.ndarray) -> np.ndarray:
    """The array, which nobody may write to any more: others have it, too."""
    array.setflags(write=False)
    return array


def firsts(count: int, alike: Callable[[int, int], bool]) -> np.ndarray:
    """(count,) of each of so many things the first one that it is like, maybe itself, by alike(first, other)."""
    found = np.arange(count)
    for j in range(count):
        found[j] = next((i for i in range(j) if found[i] == i and alike(i, j)), j)
    return found
