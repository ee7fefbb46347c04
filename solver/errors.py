"""Types of errors: bad input, and a simulation that cannot go on."""

from collections.abc import Iterable
from math import inf


class InputError(ValueError):
    """A value that physics or numerics cannot accept; names key, value and limit.

    The pipeline prefixes the study file's name, so that a user reads
    ``studies/buan.toml: floats.front.mass = -1: must be > 0 kg``.
    """

    def __init__(self, key: str, value: object, limit: str, others: "tuple[InputError, ...]" = ()) -> None:
        super().__init__(f"{key} = {value}: {limit}")
        self.key, self.value, self.limit = key, value, limit
        self.others = others  # what else the same input has wrong

    def __reduce__(self) -> tuple[type["InputError"], tuple[object, ...]]:
        return type(self), (self.key, self.value, self.limit, self.others)


def refuse(problems: Iterable[InputError]) -> None:
    """Raise the first of the problems, with the others in its `others`; return if there are none."""
    if problems := tuple(problems):
        problems[0].others = problems[1:]
        raise problems[0]


class SimulationFailed(RuntimeError):
    """The time loop stopped early; the message names the quantity, the time and a remedy."""


class StepTooLong(SimulationFailed):
    """A failed simulation that a smaller step may help; when t [s], and the gap in the energy balance
    where that is why."""

    def __init__(self, message: str, gap: float = inf, t: float = 0.0) -> None:
        super().__init__(message)
        self.gap, self.t = gap, t
