"""What is odd about a scene, or was met in its run, is told."""

from dataclasses import replace

import numpy as np
import pytest

from solver.errors import SimulationFailed
from solver.oddities import beyond_tables, warnings
from solver.power_takeoff import PtoTable
from solver.run import simulate
from tests.awkward import bare_legs, flap, soft_mooring
from tests.record.test_slow import soft
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


@pytest.mark.parametrize(("froude_krylov", "told"), [("linear", True), ("body-nonlinear", False)])
def test_a_march_of_linear_buoyancy_tells_of_large_angles(froude_krylov, told):
    item, h = flap()
    settings = replace(item.settings, froude_krylov=froude_krylov, discard=0.0, duration=20.0)
    swinging = replace(item.floats[0], offset=(0.4,), pto_damping=1e6)
    record = simulate(replace(item, settings=settings, floats=(swinging,)), h)
    assert ("the std of hinge is" in record.attrs.get("warnings", "")) is told


@pytest.mark.parametrize(("stiffness", "pushed"), [(1e3, False), (400.0, True), (0.0, True)])
def test_a_float_that_waves_push_out_of_its_series_is_told_before_it_runs(stiffness, pushed):
    """In this sea, not across the waves or by linear pressure; in one 20 times lower only what nothing holds."""
    item, _ = soft(stiffness, 0.0)
    across = replace(item.floats[0], motion=("sway", "heave"))
    linear = replace(item, settings=replace(item.settings, froude_krylov="linear"))
    low = replace(item, sea=replace(item.sea, amplitude=item.sea.amplitude / 20))
    others = linear, replace(item, floats=(across,)), low
    told = [any("waves may push it further" in text for text in warnings(each)) for each in (item, *others)]
    assert told == [pushed, False, False, stiffness == 0]


def test_a_run_ends_where_a_float_is_told_to_leave_its_series():
    item, h = soft(400.0, 0.0)
    simulate(*soft(1e3, 0.0))
    assert any("further than 4.07 m along surge" in text for text in warnings(item))
    with pytest.raises(SimulationFailed, match=r"beyond -4\.07 to \+4\.07: the float drifted out"):
        simulate(item, h)


@pytest.mark.parametrize("scale", [1.0, 1 / 50])
@pytest.mark.parametrize(("low", "high", "told"), [(-0.9, 0.9, 0), (-1.1, 0.9, 1), (-0.9, 1.1, 1), (-1.1, 1.1, 1)])
def test_either_end_of_a_table_is_one_that_a_rate_may_leave(low, high, told, scale):
    top = 0.1 * scale**0.5
    pto = PtoTable(velocity=(0.0, top), force=(0.0, 2e3 * scale**3))
    item = ball(motion=("heave",), pto_table=pto)
    no_places = np.zeros(1)
    met = (np.array([no_places, [end * top]]) for end in (low, high))
    assert len(list(beyond_tables([item], *met))) == told


@pytest.mark.parametrize(
    ("height", "stretching", "told"), [(0.0, "none", 1), (-0.1, "none", 0), (0.1, "none", 0), (0.0, "wheeler", 0)]
)
def test_members_in_still_waters_surface_are_told_once(height, stretching, told):
    """Two that cross there, not an upright one, nor one that no water loads."""
    item, _ = bare_legs()
    frame = item.platform.frame
    leg = frame.members[0]
    ends = {"west": (-3.0, 0.5, height), "east": (4.0, 0.5, height), "up": (4.0, 0.5, 6.0)}
    braces = [
        replace(leg, name=name, start=start, end=end, **dry)
        for name, start, end, dry in (
            ("long", "west", "east", {}),
            ("cross", "east", next(iter(frame.clamped)), {}),
            ("back", "east", "west", {}),
            ("bare", "west", "east", {"drag_coefficient": 0.0, "inertia_coefficient": 1.0}),
            ("post", "east", "up", {}),
        )
    ]
    braced = replace(frame, nodes={**frame.nodes, **ends}, members=(*frame.members, *braces))
    item = replace(item, platform=replace(item.platform, frame=braced, wave_stretching=stretching))
    texts = [text for text in warnings(item) if "at z = 0" in text]
    assert len(texts) == told and all(text.startswith("platform.members.long and 1 more: ") for text in texts)
