"""What several tests need, made once a run: boundary elements and files that one worker makes the others read."""

import copyreg
import os
import pickle
from collections.abc import Callable
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
    folder = made(asked, lambda folder: (folder / "h").write_bytes(pickle.dumps(bem.solve(*scene, **keywords))))
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
