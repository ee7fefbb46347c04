"""What several tests need, made once a run: boundary elements and files that one worker makes the others read."""

import copyreg
import os
import pickle
from collections.abc import Callable
from dataclasses import replace
from hashlib import sha256
from pathlib import Path
from types import MappingProxyType

import numpy as np
from filelock import FileLock

from solver.hydrodynamics.bem import bem
from solver.hydrodynamics.bem.coefficients import Hydrodynamics
from solver.hydrodynamics.hull.mesh import Hull

FOLDER = "COEFFICIENTS_OF_THIS_RUN"  # in the environment, made and removed by conftest.py


def read_only(mapping: dict) -> MappingProxyType:
    """What their settings are, which pickle knows by no name."""
    return MappingProxyType(mapping)


copyreg.pickle(MappingProxyType, lambda proxy: (read_only, (dict(proxy),)))


def solve(hulls: tuple[Hull, ...], centres: np.ndarray, **water) -> Hydrodynamics:
    """`bem.solve` of these."""
    if FOLDER not in os.environ:  # not under pytest
        return bem.solve(hulls, centres, **water)
    assert "PYTEST_CURRENT_TEST" in os.environ, "in a test or a fixture: all workers import all files before they begin"
    new = tuple(map(replace, hulls))  # without what they remember of themselves, some in this worker and more in that
    asked = sha256(pickle.dumps((new, centres, sorted(water.items())))).hexdigest()
    folder = made(asked, lambda folder: (folder / "h").write_bytes(pickle.dumps(bem.solve(hulls, centres, **water))))
    return pickle.loads((folder / "h").read_bytes())


def made(name: str, make: Callable[[Path], object]) -> Path:
    """The folder of this name, with what `make` has put into it."""
    folder = Path(os.environ[FOLDER]) / name
    with FileLock(f"{folder}.lock"):
        if not folder.exists():
            part = folder.with_suffix(".part")
            part.mkdir(exist_ok=True)
            make(part)
            part.rename(folder)
    return folder
