"""What is odd about a scene, or was met in its run, is told."""

from dataclasses import replace

import numpy as np
import pytest

from solver.oddities import beyond_tables
from solver.power_takeoff import PtoTable
from solver.run import simulate
from tests.awkward import flap, soft_mooring
from tests.test_balance import ball


def lines_in(waves, item, h):
    """The record in the frequency domain, of waves so many times higher."""
    sea = replace(item.sea, amplitude=waves * item.sea.amplitude)
    return simulate(replace(item, sea=sea, settings=replace(item.settings, method="frequency")), h)


@pytest.mark.parametrize(("make", "table", "axis"), [(flap, "rotation", "hinge"), (soft_mooring, "motion", "pitch")])
def test_a_linear_model_tells_of_angles_that_are_not_small(make, table, axis):
    item, h = make()
    item = replace(item, settings=replace(item.settings, froude_krylov="linear"))
    usual = lines_in(1.0, item, h)
    std = usual.variables[table][1].reshape(-1, 5)[-1, 4]
    small, large = (lines_in(angle / std, item, h).attrs.get("warnings", "") for angle in (0.149, 0.151))
    assert f"the std of {axis} is 0.15 rad" in large
    assert "small angles" not in small
    assert "surge" not in large


@pytest.mark.parametrize("scale", [1.0, 1 / 50])
@pytest.mark.parametrize(("low", "high", "told"), [(-0.9, 0.9, 0), (-1.1, 0.9, 1), (-0.9, 1.1, 1), (-1.1, 1.1, 1)])
def test_either_end_of_a_table_is_one_that_a_rate_may_leave(low, high, told, scale):
    top = 0.1 * scale**0.5
    pto = PtoTable(velocity=(0.0, top), force=(0.0, 2e3 * scale**3))
    item = ball(motion=("heave",), pto_table=pto)
    no_places = np.zeros(1)
    met = (np.array([no_places, [end * top]]) for end in (low, high))
    assert len(list(beyond_tables([item], *met))) == told
