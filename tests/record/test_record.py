"""When a record's samples were taken, and which of them count."""

from dataclasses import replace

import numpy as np
import pytest
from pytest import approx

from solver.run import simulate
from solver.sea.realization import ramp

SPRING = 4e4  # [N/m]


@pytest.mark.parametrize("formulation", ["minimal", "augmented"])
def test_every_sample_stands_at_its_time(buan, coefficients, formulation):
    """Floats guided in heave that feel no waves, z = z0 cos ωt, beside the elevation: both known at every instant."""
    items = buan.floats(motion=("heave",), stiffness=SPRING, offset=0.2, pto_damping=0.0)
    scene = buan.scene(
        "fixed", floats=items, sea=buan.sea(Hs=0.3), time_step=0.1, discard=2.0, duration=6.0, ramp=4.0,
        froude_krylov="none", diffraction=False, radiation=False, keep_series=True, formulation=formulation,
    )  # fmt: skip
    record = simulate(scene, coefficients)
    t, z, elevation = (record.series[name][1] for name in ("time", "motion", "wave_elevation"))
    assert t == approx(2.0 + 0.05 * np.arange(121), abs=1e-9)  # both ends count, half a step apart
    omega = np.sqrt((1025 * 9.81 * np.pi + SPRING) / items[0].mass)
    # Fourth order at 0.5 rad a step: 2e-3 in phase after 80 steps; one sample would be 0.25 rad.
    assert z[:, :, 0] == approx(np.outer(0.2 * np.cos(omega * t), [1, 1]), abs=0.02 * 0.2)
    waves = (scene.sea.amplitude * np.exp(-1j * np.outer(t, scene.sea.omega))).sum(axis=1).real
    assert elevation == approx(waves * ramp(t, 4.0), abs=1e-9)
    assert record.variables["wave_elevation"][1][2:] == approx(
        [elevation.mean(), np.sqrt(np.mean(elevation**2)), elevation.std()], rel=1e-9, abs=1e-12
    )  # fmt: skip
    longer = replace(scene, settings=replace(scene.settings, discard=0.0, duration=8.0))
    assert simulate(longer, coefficients).series["motion"][1][-121:] == approx(z, abs=1e-9)
