"""What must be settled before numpy is imported."""

import gc
import subprocess
import sys
import tomllib
from pathlib import Path

from pipeline import environment
from pipeline.bridge.geometry import BEM_VERSION
from pipeline.tasks.task import MODEL_VERSION

ROOT = Path(__file__).parents[2]


def test_the_command_sets_the_environment_before_numpy_comes():
    """BLAS reads its number of threads once: a shell that sets none must not decide how sums are rounded."""
    code = "import sys, pipeline.__main__; print('numpy' in sys.modules)"
    words = [sys.executable, "-c", code]
    done = subprocess.run(words, cwd=ROOT, check=True, capture_output=True, text=True)
    assert done.stdout == "False\n"


def test_the_version_is_that_of_the_project_and_costs_no_heavy_import():
    """Program, model and coefficients: what decides whether results of another machine count here."""
    heavy = "{'xarray', 'netCDF4', 'numba', 'matplotlib', 'dask', 'distributed', 'capytaine', 'scipy.sparse'}"
    code = (
        "import sys; from pipeline.cli.cli import app; app(['--version'], standalone_mode=False)\n"
        f"assert not {heavy} & set(sys.modules), {heavy} & set(sys.modules)"
    )
    done = subprocess.run([sys.executable, "-c", code], cwd=ROOT, check=True, capture_output=True, text=True)
    version = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]["version"]
    assert done.stdout == f"study {version}, model version {MODEL_VERSION}, BEM version {BEM_VERSION}\n"


def test_garbage_is_left_alone_during_imports_and_collected_again_afterwards():
    """What imports make stays: to look through it, again and again, is a sixth of their time."""
    with environment.importing():
        assert not gc.isenabled()
    assert gc.isenabled()


def test_the_first_run_says_that_it_compiles(tmp_path, monkeypatch):
    """Also after a plan or an interrupted run, which have left some kernels compiled."""
    from solver.coupled.march import march

    monkeypatch.setenv("NUMBA_CACHE_DIR", str(tmp_path))
    assert not environment.compiled(bends=False)
    folder = tmp_path / "solver_0123"
    folder.mkdir()
    (folder / "beam.stiffness-1.py311.nbi").touch()
    assert not environment.compiled(bends=False)
    (folder / f"{march._cache._impl.filename_base}.nbi").touch()
    assert environment.compiled(bends=False)
