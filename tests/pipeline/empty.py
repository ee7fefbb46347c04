"""A large study of empty tasks, and an engine that has nothing to do; for timing, killing and breaking the pipeline."""

from __future__ import annotations

import ctypes
import os
import time
from collections.abc import Callable
from pathlib import Path
from types import SimpleNamespace

import numpy as np

from pipeline.bridge import engine
from pipeline.tasks.task import wave_seed

STUDY = """
[water]
depth = 50.0
[waves]
band = [0.7, 3.4]
[[floats]]
name = "only"
hull = {{ shape = "sphere", radius = 1.0, draft = 1.0 }}
mass = 2147.0
inertia = [859.0, 859.0, 859.0]
hinge = [0.0, 0.0, 2.6]
arm = [-2.36, 0.0, -2.6]
[solver]
method = "frequency"
[axes]
seed = [{seeds}]
[sea_states]
calm = {{ Hs = 0.5, Tp = 5.0 }}
"""


def study(folder: Path, tasks: int) -> Path:
    """A study file with so many tasks."""
    path = folder / "empty.toml"
    path.write_text(STUDY.format(seeds=", ".join(map(str, range(tasks)))))
    return path


def coefficients(geometry):
    return geometry.key.encode() * 1000


def without_physics(one, compute):
    """An engine with `one` geometry's coefficients for each, and this for its tasks; it shares nothing out."""
    return engine.Engine(
        share=nothing,
        coefficients=lambda geometries, _shares: [one(geometry) for geometry in geometries],
        compute=compute,
        judge=nothing,
        reduce=nothing,
        statics=nothing,
    )


def require_whole(data, key):
    """These coefficients are no netCDF file."""
    if data != key.encode() * 1000:
        raise ValueError(key)


def compute(parameters, data):
    """Numbers that depend on the parameters alone, after EMPTY_SECONDS and with EMPTY_MEGABYTES.

    EMPTY_SLOW_SEED: only this realization takes them. EMPTY_COMPILED: it holds the interpreter meanwhile.
    EMPTY_LOG: a file that gets a line for each call. EMPTY_GATE: a file without which no call ends.
    EMPTY_UNMET: what odd realizations do not meet.
    """
    if log := os.environ.get("EMPTY_LOG"):
        with open(log, "a") as file:
            file.write(f"{parameters.seed}\n")
    env, slow = os.environ, os.environ.get("EMPTY_SLOW_SEED")
    hard = slow is None or int(slow) == parameters.seed
    space = np.ones(int(float(env.get("EMPTY_MEGABYTES", "0")) * 2**17) if hard else 0)
    pause = float(env.get("EMPTY_SECONDS", "0")) if hard else 0.0
    if env.get("EMPTY_COMPILED"):
        ctypes.PyDLL(None).sleep(int(pause))  # and nothing else runs in this process, as in a compiled kernel
    else:
        time.sleep(pause)
    while (gate := env.get("EMPTY_GATE")) and not os.path.exists(gate):
        time.sleep(0.01)
    rng = np.random.default_rng([*wave_seed(parameters), len(data)])
    variables = {"wave_elevation": (("statistic",), rng.normal(size=5) * space[:1].sum(initial=1.0))}
    coords = {"statistic": np.array(["max", "min", "mean", "rms", "std"])}
    attrs = {"energy_residual": rng.random(), "unmet": env.get("EMPTY_UNMET", "") if parameters.seed % 2 else ""}
    return SimpleNamespace(variables=variables, coords=coords, attrs=attrs, series={})


def nothing(*_):
    """No objection, nothing to hand on."""


ENGINE = without_physics(coefficients, compute)


def install(put: Callable[[object, str, object], None] = setattr) -> None:
    """This engine in place of the true one."""
    from pipeline import environment
    from pipeline.bridge import cache
    from pipeline.cli import actions

    put(actions, "REPORTED", 0)
    put(environment, "compiled", lambda _bends: True)  # nothing that this engine runs is ever compiled
    put(cache.Cache.__init__, "__defaults__", (require_whole,))
    put(engine, "Engine", lambda: ENGINE)


def main() -> None:
    """The command line, with this engine."""
    from pipeline import __main__

    install()
    __main__.main()


if __name__ == "__main__":
    # Workers import the engine by the name of this file.
    import empty

    empty.main()
