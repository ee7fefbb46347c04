"""What must be settled before numpy is imported."""

import subprocess
import sys
from pathlib import Path


def test_the_command_sets_the_environment_before_numpy_comes():
    """BLAS reads its number of threads once: a shell that sets none must not decide how sums are rounded."""
    code = "import sys, pipeline.__main__; print('numpy' in sys.modules)"
    words = [sys.executable, "-c", code]
    done = subprocess.run(words, cwd=Path(__file__).parents[2], check=True, capture_output=True, text=True)
    assert done.stdout == "False\n"


def test_the_first_run_says_that_it_compiles(tmp_path, monkeypatch):
    """Also after a plan or an interrupted run, which have left some kernels compiled."""
    from pipeline import environment
    from solver.coupled.march import march

    monkeypatch.setenv("NUMBA_CACHE_DIR", str(tmp_path))
    assert not environment.compiled()
    folder = tmp_path / "solver_0123"
    folder.mkdir()
    (folder / "beam.stiffness-1.py311.nbi").touch()
    assert not environment.compiled()
    (folder / f"{march._cache._impl.filename_base}.nbi").touch()
    assert environment.compiled()
