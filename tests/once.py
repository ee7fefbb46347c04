"""Boundary elements that several tests need, solved once a run: what one worker solves the others read."""

import copyreg
import os
import pickle
from hashlib import sha256
from pathlib import Path
from types import MappingProxyType

from filelock import FileLock

from solver.hydrodynamics.bem import bem
from solver.hydrodynamics.bem.coefficients import Hydrodynamics

FOLDER = "COEFFICIENTS_OF_THIS_RUN"  # in the environment, made and removed by conftest.py


def read_only(mapping: dict) -> MappingProxyType:
    """What their settings are, which pickle knows by no name."""
    return MappingProxyType(mapping)


copyreg.pickle(MappingProxyType, lambda proxy: (read_only, (dict(proxy),)))


def solve(*scene, **keywords) -> Hydrodynamics:
    """`bem.solve` of these hulls, centres, water, ..."""
    if FOLDER not in os.environ:  # not under pytest
        return bem.solve(*scene, **keywords)
    assert "PYTEST_CURRENT_TEST" in os.environ, "in a test or a fixture: all workers import all files before they begin"
    asked = sha256(pickle.dumps((scene, sorted(keywords.items())))).hexdigest()
    file = Path(os.environ[FOLDER]) / asked
    with FileLock(f"{file}.lock"):
        if not file.exists():
            file.write_bytes(pickle.dumps(bem.solve(*scene, **keywords)))
    return pickle.loads(file.read_bytes())
