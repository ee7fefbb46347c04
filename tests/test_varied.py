"""Estimates of errors on scenes that were drawn, not chosen: each is a claim that another method can refute."""

from dataclasses import replace

import numpy as np
import pytest

from solver.errors import SimulationFailed
from solver.record.effects import together
from solver.record.sampling import least_force
from solver.run import simulate
from solver.statistics import STATISTICS, apart
from tests.awkward import known
from tests.varied import SWITCHING, varied

NAMES = ("motion", "rotation", "absorbed_power", "hinge_force", "top_displacement", "bottom_stress")
OF_LINES = ("shapes_effect", "elements_effect", "law_effect", "drag_effect", "linearisation_effect", "rotation_effect")
SLIGHT = 0.01  # error below which a wrong estimate of it misleads nobody
# None [rad, m, W], as of a latch that never lets go.
HELD = {"rotation": 1e-6, "motion": 1e-6, "absorbed_power": 1e-3}
SEEDS = range(24)


def marched(seed, **changes):
    """Scene, coefficients and the march's record; what cannot stand or swings through is another scene's matter."""
    try:
        scene, words = varied(seed, **changes)
        low, high = scene.sea.omega[[0, -1]]
        h = known(scene, 0.5 * low, min(3 * high, 6.5), 22)
        return scene, h, simulate(scene, h), words
    except SimulationFailed as error:
        pytest.skip(str(error))


@pytest.fixture(scope="module", params=SEEDS)
def drawn(request):
    return marched(request.param)


def worst(record, exact, scene):
    least = {"hinge_force": np.max(least_force(scene))} | HELD
    both = [name for name in NAMES if name in record.variables]
    return max(apart(*(of.variables[name][1] for of in (record, exact)), least.get(name, 0.0)) for name in both)


@pytest.mark.slow
def test_the_frequency_domain_tells_how_far_it_is_from_a_march(drawn):
    """Both with the same mesh. Where it says 1, that is much, and no more is known of it."""
    scene, h, march, words = drawn
    lines = simulate(replace(scene, settings=replace(scene.settings, method="frequency")), h)
    memory = march.attrs["memory_effect"]  # which lines have no error of
    true, told = worst(lines, march, scene), together([memory, *(lines.attrs[name] for name in OF_LINES)])
    assert true < max(SLIGHT, 3 * told), words
    assert told < 1.0 or true > 0.1, words


@pytest.mark.slow
def test_the_march_tells_how_far_it_is_from_shorter_steps(drawn):
    require_told(*drawn)


@pytest.mark.slow
@pytest.mark.parametrize("seed", SEEDS)
def test_marches_of_laws_that_switch_tell_it_too(seed):
    require_told(*marched(seed, laws=SWITCHING))


def require_told(scene, h, march, words):
    finer = {"time_step": march.attrs["time_step"] / 4, "newton_tolerance": 1e-9}
    exact = simulate(replace(scene, settings=replace(scene.settings, **finer)), h)
    told = together([march.attrs["discretization_error"], march.attrs["sampling_error"]])
    assert worst(march, exact, scene) < max(SLIGHT, 3 * told), words
    assert march.attrs["energy_residual"] < 1e-3, words


@pytest.mark.slow
def test_body_nonlinear_forces_in_low_waves_are_linear(drawn):
    """A thousandth of the waves' height; friction holds all still there, and what creeps is nobody's answer."""
    scene, h, _, words = drawn
    if any(np.any(f.per_axis("coulomb")) for f in scene.floats):
        pytest.skip("friction")
    low = replace(scene, sea=replace(scene.sea, amplitude=1e-3 * scene.sea.amplitude))
    linear, exact = (
        simulate(replace(low, settings=replace(low.settings, froude_krylov=pressure)), h).variables
        for pressure in ("linear", "body-nonlinear")
    )
    at = STATISTICS.index("std")
    for name in (name for name in NAMES if name in linear):
        a, b = (np.nan_to_num(of[name][1][..., at]) for of in (linear, exact))
        assert np.abs(a - b).max() <= 3e-3 * a.max(), (name, words)
