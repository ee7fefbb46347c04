"""An error asked for: settings follow it, and the record's estimate stands beside it."""

from dataclasses import replace

import pytest
from pytest import approx

from solver.errors import InputError
from solver.record.accuracy import settled
from solver.run import simulate
from solver.scene import PANELS, panels_for


def test_tighter_tolerance_takes_shorter_steps_and_meets_its_estimate(buan, coefficients):
    loose, tight = (simulate(buan.scene("fixed", tolerance=t), coefficients).attrs for t in (3e-2, 5e-3))
    assert tight["time_step"] < loose["time_step"]
    # The coefficients are given here, coarse ones of the tests: their share cannot be bought with settings.
    assert all(a["estimated_error"] - 1.25 * a["mesh_effect"] <= a["tolerance"] for a in (loose, tight))


def test_pilots_stop_when_nothing_is_left_to_improve(buan):
    scene = buan.scene("fixed", tolerance=1e-2)
    told = {"discretization_error": 1e-3, "quadrature_error": 0.0, "memory_effect": 0.0}
    calls = []
    found = settled(scene, lambda pilot: calls.append(pilot) or told)
    assert len(calls) == 1 and calls[0].settings.duration == 120.0
    assert found.settings.tolerance is None and found.settings.duration == scene.settings.duration


def test_step_follows_the_fourth_order(buan):
    """16 times the error allowed is half the step, with a tenth to spare."""
    scene = buan.scene("fixed", tolerance=1e-3)
    share = 0.4 * 1e-3 / 1.25
    errors = iter([16 * share, share])
    found = settled(
        scene,
        lambda _: {"discretization_error": next(errors), "quadrature_error": 0.0, "memory_effect": 0.0},
    )
    assert found.settings.time_step == approx(0.9 / 2 * scene.settings.time_step)


def test_mesh_follows_the_tolerance():
    assert panels_for(None) == panels_for(2e-3) == PANELS
    assert panels_for(2e-3 / 8) == 4 * PANELS == panels_for(1e-6)


def test_tolerance_out_of_range_is_refused(buan):
    with pytest.raises(InputError, match="tolerance"):
        replace(buan.scene().settings, tolerance=0.5)


def test_record_says_what_it_skipped(buan, coefficients):
    whole = simulate(buan.scene(duration=20.0, discard=0.0), coefficients).attrs["skipped"]
    fixed = simulate(buan.scene("fixed", duration=20.0, discard=0.0), coefficients).attrs["skipped"]
    assert "mirror symmetry" in whole and "708" in whole and "support is fixed" not in whole
    assert "support is fixed" in fixed and "708" not in fixed
