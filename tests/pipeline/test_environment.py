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
