"""Short runs through every kernel of the time loop; `NUMBA_DISABLE_JIT=1 python tests/interpreted.py IN OUT`.

IN: coefficients as the pipeline's cache keeps them; OUT: the motions (npz).
"""

import sys
from pathlib import Path

import numpy as np

from pipeline.bridge import cache
from solver.coupled.blocks import blocks
from solver.coupled.preparation import prepare
from solver.hydrodynamics.bem.coefficients import Hydrodynamics
from tests.conftest import floats, scene

SECONDS = 3.0
SHORT = {"ramp": 1.0, "discard": 0.0, "duration": SECONDS}


def motions(coefficients: Hydrodynamics) -> dict[str, np.ndarray]:
    """(m, …) z, p and hinge wrench of each scene."""
    linear = {"froude_krylov": "linear", "pressure": "extrapolated"}
    guided = floats(motion=("heave", "pitch"), pto_damping=(1e4, 0.0), quadratic_damping=(1e3, 0.0))
    scenes = {
        "elastic": scene("elastic", **SHORT),
        "guided": scene("fixed", floats=guided, **SHORT),
        "linear": scene("fixed", **linear, **SHORT),
        "no floats": scene("elastic-no-floats", **SHORT),
    }
    series = {}
    for name, item in scenes.items():
        system = prepare(item, coefficients if item.floats else None)
        parts = [out for _, out, _ in blocks(system, system.start(), round(SECONDS / system.dt))]
        for field in ("z", "p", "wrench"):
            series[f"{name}, {field}"] = np.concatenate([getattr(out, field) for out in parts])
    return series


if __name__ == "__main__":
    np.savez(sys.argv[2], **motions(cache.decode(Path(sys.argv[1]).read_bytes())))
