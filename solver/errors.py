"""What can go wrong, as types: bad input, and a simulation that cannot go on."""


class InputError(ValueError):
    """A value that physics or numerics cannot accept; names key, value and limit.

    The pipeline prefixes the study file's name, so that a user reads
    ``studies/buan.toml: floats.front.mass = -1: must be > 0 kg``.
    """

    def __init__(self, key: str, value: object, limit: str):
        super().__init__(f"{key} = {value}: {limit}")
        self.key, self.value, self.limit = key, value, limit

    def __reduce__(self):
        return type(self), (self.key, self.value, self.limit)


class SimulationFailed(RuntimeError):
    """The time loop stopped early: what, when, and what would help."""


class StepTooLong(SimulationFailed):
    """Among these, the one that a smaller step may help."""
