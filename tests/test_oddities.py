"""What is odd about a scene, or was met in its run, is told."""

from dataclasses import replace

import numpy as np
import pytest

from solver.errors import SimulationFailed
from solver.hydrodynamics.hull.panel_hull import PanelHull
from solver.hydrodynamics.hull.revolution import Revolution
from solver.hydrodynamics.hull.ring import ring
from solver.limits import pushed
from solver.mooring import Line
from solver.oddities import overdamped, warnings
from solver.power_takeoff import PtoEfficiency, PtoTable
from solver.remarks import beyond_tables, shoved, snapped, strayed
from solver.run import simulate
from solver.scene import EndStops, Float
from solver.sea.current import Current, CurrentSpeed
from solver.sea.field import wave_field
from solver.sea.realization import components, realize, regular
from solver.sea.spectrum import Jonswap, PiersonMoskowitz
from solver.statistics import STATISTICS
from tests.awkward import bare_legs, flap, prism, scene, soft_mooring, unequal_legs
from tests.record.test_beside import soft
from tests.test_balance import WHOLE, ball, buoy


def lines_in(waves, item, h):
    """The record in the frequency domain, of waves so many times higher."""
    sea = replace(item.sea, amplitude=waves * item.sea.amplitude)
    return simulate(replace(item, sea=sea, settings=replace(item.settings, method="frequency")), h)


@pytest.mark.parametrize(
    ("make", "table", "axis"),
    [pytest.param(flap, "rotation", "hinge", marks=pytest.mark.slow), (soft_mooring, "motion", "pitch")],
)
def test_a_linear_model_tells_of_angles_that_are_not_small(make, table, axis):
    item, h = make()
    item = replace(item, settings=replace(item.settings, froude_krylov="linear"))
    usual = lines_in(1.0, item, h)
    std = usual.variables[table][1].reshape(-1, 5)[-1, 4]
    small, large = (lines_in(angle / std, item, h).attrs.get("warnings", "") for angle in (0.149, 0.151))
    assert f"the std of {axis} is 0.15 rad" in large
    assert "small angles" not in small
    assert "surge" not in large


@pytest.mark.parametrize(("froude_krylov", "told"), [("linear", True), ("none", True), ("body-nonlinear", False)])
def test_a_march_of_linear_buoyancy_tells_of_large_angles(froude_krylov, told):
    item, h = flap()
    settings = replace(item.settings, froude_krylov=froude_krylov, discard=0.0, duration=20.0)
    swinging = replace(item.floats[0], offset=(0.4,), pto_damping=1e6)
    record = simulate(replace(item, settings=settings, floats=(swinging,)), h)
    assert ("the std of hinge is" in record.attrs.get("warnings", "")) is told


def test_a_line_is_strained_where_its_float_rests():
    """A tether drawn nearly slack that half of the buoyancy stretches by a tenth."""
    item, _ = soft_mooring()
    (buoy,) = item.floats
    pull = 0.5 * buoy.mass * 9.81
    line = Line(anchor=(0, 0, -30.0), fairlead=(0, 0, 0), length=29.9, weight=5.0, EA=10 * pull)
    light = replace(buoy, motion=("heave",), mass=0.5 * buoy.mass, stiffness=0.0, damping=0.0, lines=(line,))
    whole = replace(item, floats=(light,))
    assert not any("strained" in text for text in warnings(whole))
    (told,) = (text for text in warnings(whole, np.array([0.1 * 29.9])) if "strained" in text)
    assert "lines: line 1 is strained by 0.1" in told


def test_parts_of_a_power_take_off_that_is_not_there_are_told():
    item, h = flap()
    (f,) = item.floats
    parts = {"force_limit": 1e5, "one_way": 1.0, "pto_efficiency": PtoEfficiency(generating=0.9)}
    for damping, told in ((0.0, 3), (1e6, 0)):
        texts = warnings(replace(item, floats=(replace(f, pto_damping=damping, **parts),)))
        assert sum("does nothing without a power take-off" in text for text in texts) == told
    lines = replace(item, floats=(replace(f, pto_damping=1e6, **(parts | {"one_way": 0.0})),))
    record = simulate(replace(lines, settings=replace(item.settings, method="frequency", froude_krylov="linear")), h)
    assert "does nothing" not in record.attrs.get("warnings", "")
    assert not any("does nothing" in text for text in warnings(replace(item, floats=(replace(f, pto_damping=0.0),))))


def test_a_leg_through_a_hull_is_told():
    """That crosses still water within its waterplane, and that waves load; not in a well, nor beside it."""
    whole, _ = unequal_legs()
    (f,) = whole.floats
    foot, deck = (np.array(whole.platform.frame.nodes[name]) for name in ("foot a", "deck"))
    x, y, _ = foot + foot[2] / (foot[2] - deck[2]) * (deck - foot)
    well = ring(((2.0, -0.5), (3.0, -0.5), (3.0, 0.5), (2.0, 0.5)))
    solid = Revolution.vertical_cylinder(radius=3.0, draft=0.5, freeboard=0.5)
    for hull, told in ((solid, True), (well, False), (f.hull, False)):
        arm = f.arm if hull is f.hull else tuple(np.subtract((x, y, 0.0), f.hinge))
        texts = warnings(replace(whole, floats=(replace(f, hull=hull, arm=arm),)))
        assert any("runs through its hull" in text for text in texts) is told


def test_an_axis_that_no_joint_has_is_told():
    item, _ = soft_mooring()
    (buoy,) = item.floats
    inclined = replace(buoy, axis=(1.0, 0.0, 1.0))
    fixed = replace(inclined, motion=(), stiffness=0.0, damping=0.0)
    for each, told in ((inclined, True), (buoy, False), (fixed, False)):
        assert any("axis: is of a hinge" in text for text in warnings(replace(item, floats=(each,)))) is told


@pytest.mark.parametrize(
    ("offset", "told"),
    [
        ((1.0, 1.99, 3.1), []),
        ((-2.01, 0.0, 0.0), ["m of surge is further"]),
        ((0.0, 20.0, 0.0), ["m of heave is further"]),
        ((0.0, 0.0, -90.0), ["rad of yaw is more than half a turn, where no float comes: is it in degrees?"]),
    ],
)
def test_a_float_that_is_let_go_as_no_float_is_is_told(offset, told):
    """Further than its hull is long, or round by more than half a turn; so far it is let go all the same."""
    item, _ = soft_mooring()
    (buoy,) = item.floats
    size = buoy.hull.size
    away = replace(buoy, motion=("surge", "heave", "yaw"), offset=(size * offset[0], size * offset[1], offset[2]))
    texts = [text for text in warnings(replace(item, floats=(away,))) if "offset" in text]
    assert len(texts) == len(told) and all(part in text for part, text in zip(told, texts, strict=True))


def test_end_stops_that_no_float_reaches_are_told():
    item, _ = soft_mooring()
    for upper, told in ((3.1, False), (45.0, True)):
        stops = EndStops(lower=(0.0, -1.0), upper=(99.0, upper), stiffness=(1e5, 1e5))
        stopped = replace(item.floats[0], motion=("heave", "yaw"), stiffness=0.0, damping=0.0, end_stops=stops)
        texts = [text for text in warnings(replace(item, floats=(stopped,))) if "are they in degrees" in text]
        assert len(texts) == told


@pytest.mark.parametrize(("stiffness", "told_so"), [(400.0, False), (100.0, True), (0.0, True)])
def test_a_float_that_waves_push_out_of_its_series_is_told_before_it_runs(stiffness, told_so):
    """In this sea, not across the waves or by linear pressure; in one 20 times lower only what nothing holds."""
    item, _ = soft(stiffness, 0.0)
    across = replace(item.floats[0], motion=("sway", "heave"))
    linear = replace(item, settings=replace(item.settings, froude_krylov="linear"))
    low = replace(item, sea=replace(item.sea, amplitude=item.sea.amplitude / 20))
    others = linear, replace(item, floats=(across,)), low
    told = [any("waves may push it further" in text for text in warnings(each)) for each in (item, *others)]
    assert told == [told_so, False, False, stiffness == 0]


def test_a_run_ends_where_a_float_is_told_to_leave_its_series():
    item, h = soft(30.0, 0.0)
    assert any("further than 20.8 m along surge" in text for text in warnings(item))
    with pytest.raises(SimulationFailed, match=r"beyond -20\.84 to \+20\.84: the float drifted out"):
        simulate(item, h)


@pytest.mark.parametrize("heading", [0.25, 0.75, 1.25, 1.75])
def test_a_float_that_goes_far_along_the_waves_is_told_whatever_their_heading(heading):
    """Ten metres to either side, along the waves or against them."""
    item, _ = soft_mooring()
    barge = replace(item.floats[0], motion=("surge", "sway"), stiffness=(0, 0), damping=(0, 0))
    waves = replace(item.sea, heading=heading * np.pi)
    axes, table = ["surge", "sway"], np.zeros((1, 2, 5))
    ends = 10.0 * np.array([np.cos(waves.heading), np.sin(waves.heading)])
    table[0, :, STATISTICS.index("max")], table[0, :, STATISTICS.index("min")] = np.abs(ends), -np.abs(ends)
    settings = replace(item.settings, diffraction=True)
    (said,) = strayed(replace(item, floats=(barge,), sea=waves, settings=settings), axes, {"motion": table})
    assert "floats.barge went 10 m along the waves" in said


def test_waves_are_summed_as_far_as_they_may_push_a_float_and_no_further():
    """On a spring of 100 N/m it drifts by 9 m, and the series about it is as good as asked there."""
    records = [simulate(*soft(stiffness, 0.0)) for stiffness in (100.0, 4e3)]
    ways = [record.variables["motion"][1].reshape(-1, 5)[0, 0] for record in records]
    assert ways[0] > 8 and ways[1] < 2
    assert all(record.attrs["field_error"] < 1e-3 for record in records)


@pytest.mark.parametrize("depth", [np.inf, 3.0])
def test_waves_push_a_float_and_all_that_it_carries_against_the_springs_of_each_axis(depth):
    """In water of 2kh, n of group over phase velocity times the mean force of deep water, n = 1 + 2kh/sinh 2kh."""
    item, _ = soft(400.0, 0.0)
    waves = replace(item.sea, heading=np.pi / 3)
    field = wave_field(waves, depth, 9.81, None)
    both = 1 + (2 * field.k * depth / np.sinh(2 * field.k * depth) if depth < np.inf else 0.0)
    load = 1025.0 * 9.81 * 0.5 * np.sum(both * np.abs(waves.amplitude) ** 2)  # of each metre of width
    buoy = replace(item.floats[0], motion=("surge", "sway", "heave"), stiffness=(400.0, 200.0, 0.0))
    hinged = replace(buoy, motion=("hinge",), stiffness=(0.0,), arm=(-5.0, 0, -1.0))
    carried = (
        replace(hinged, name=name, on=on, hinge=(x, 0, 1.0))
        for name, on, x in (("arm", "buoy", -5.0), ("tip", "arm", -15.0))
    )
    far = pushed(replace(item, floats=(buoy, *carried), sea=waves), field)
    assert far[0] == pytest.approx({"surge": 18 * load / 2 / 400, "sway": 18 * load * np.sqrt(3) / 2 / 200})
    assert far[1:] == [{}, {}]


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


@pytest.mark.parametrize(
    ("density", "told"), [(1.025, True), (899.0, True), (901.0, False), (1299.0, False), (1301.0, True)]
)
def test_a_density_that_no_water_has_is_told(density, told):
    item, _ = flap()
    texts = warnings(replace(item, water=replace(item.water, density=density)))
    assert any(text.startswith(f"water.density: {density:g} kg/m3") for text in texts) is told


@pytest.mark.parametrize(("coulomb", "one_way", "told"), [(1e9, 1.0, True), (1e9, 0.9, False), (1e3, -1.0, False)])
def test_an_arm_that_is_locked_in_one_sense_is_told(coulomb, one_way, told):
    item, _ = unequal_legs()
    locked = replace(item, floats=(replace(item.floats[0], coulomb=coulomb, one_way=one_way),))
    texts = [text for text in warnings(locked) if "so that it ratchets" in text]
    assert [text.startswith("floats.float.coulomb: 1e+09 N m holds hinge") for text in texts] == [True] * told


@pytest.mark.parametrize("speed", [11.9, 12.1])
@pytest.mark.parametrize("table", [False, True])
def test_a_current_that_no_tide_has_is_told(speed, table):
    item, _ = bare_legs()
    lines = tuple(CurrentSpeed(depth=depth, speed=v) for depth, v in ((0.0, 1.0), (5.0, speed)))
    current = Current(profile=lines) if table else Current(speed=speed)
    texts = warnings(replace(item, current=current))
    assert any(text.startswith(f"current: {speed:g} m/s") for text in texts) is (speed > 12)


@pytest.mark.parametrize(("deeper", "told"), [(0.0, False), (0.2, False), (0.3, True), (5.0, True), (np.inf, True)])
def test_a_foot_clamped_above_the_seabed_is_told(deeper, told):
    """From one hundredth of 25 m of water on; in deep water there is no seabed for it to be at."""
    item, _ = bare_legs()
    texts = warnings(replace(item, water=replace(item.water, depth=25.0 + deeper)))
    feet = ", ".join(item.platform.frame.clamped)
    assert any(text.startswith(f"platform.clamped: {feet} above the seabed") for text in texts) is told
    assert not any("inf m" in text for text in texts)


@pytest.mark.parametrize(("upper", "told_so"), [(3.1, False), (30.0, True)])
def test_stops_of_a_hinge_beyond_half_a_turn_are_told(upper, told_so):
    item = flap()[0]
    stops = EndStops(lower=-1.0, upper=upper, stiffness=1e5)
    texts = warnings(replace(item, floats=(replace(item.floats[0], end_stops=stops),)))
    assert any("end_stops: 30 rad of hinge" in text for text in texts) is told_so


@pytest.mark.parametrize(("scale", "told_so"), [(1.0, False), (1000.0, True)])
def test_a_mesh_in_other_units_is_told(scale, told_so):
    item = soft_mooring()[0]
    mesh = item.floats[0].hull
    hull = PanelHull.of(scale * mesh.vertices, mesh.faces)
    large = replace(item, floats=(replace(item.floats[0], hull=hull),), water=replace(item.water, depth=np.inf))
    assert any("hull.scale is 0.001 of a mesh in mm" in text for text in warnings(large)) is told_so


@pytest.mark.parametrize(("density", "told_so"), [(7.85, True), (7850.0, False)])
def test_steel_in_tonnes_is_told(density, told_so):
    item = unequal_legs()[0]
    frame = item.platform.frame
    members = tuple(replace(m, material=replace(m.material, density=density)) for m in frame.members)
    platform = replace(item.platform, frame=replace(frame, members=members))
    assert any("density 7.85 kg/m3" in text for text in warnings(replace(item, platform=platform))) is told_so


@pytest.mark.parametrize(("periods", "told_so"), [(0.5, True), (9.9, True), (10.1, False)])
def test_a_record_of_few_mean_periods_is_told(periods, told_so):
    """Those of zero up-crossings, 2π (m₀/m₂)^½ of two like waves; of one wave a single period tells all."""
    item, _ = flap()
    first, second = 1.0, 1.5
    mean = 2 * np.pi * np.sqrt(2 / (first**2 + second**2))
    several = components(amplitude=[0.1, 0.1], omega=[first, second], phase=[0.0, 1.0])
    settings = replace(item.settings, duration=periods * mean, discard=0.0, ramp=0.0)
    told = [text for text in warnings(replace(item, sea=several, settings=settings)) if "mean periods" in text]
    assert [f"{periods * mean:g} s are {periods:.2g} mean" in text for text in told] == [True] * told_so
    one = regular(height=0.2, period=2 * np.pi)
    assert not any("mean periods" in text for text in warnings(replace(item, sea=one, settings=settings)))


@pytest.mark.parametrize(
    ("periods", "told"),
    [(13.2, "2.0% of a std: 26 s are 13"), (0.4, "107.0% of a std: 2 s are 1"), (13.01, ""), (400.5, "")],
)
def test_a_part_of_a_waves_period_is_told(periods, told):
    """That differs from the whole as the mean of cos does, at most: |sin πn|/πn, over 1/√2."""
    item, _ = flap()
    settings = replace(item.settings, duration=2 * periods, discard=0.0, ramp=0.0)
    item = replace(item, sea=regular(height=0.2, period=2.0), settings=settings)
    found = [text for text in warnings(item) if "periods of the wave" in text]
    assert len(found) == bool(told) and all(told in text for text in found)
    cos = np.cos(2 * np.pi * (np.linspace(0.0, periods, 20001)[1:] + np.linspace(0.0, 1.0, 50)[:, None]))
    if told:
        assert f"{np.sqrt(2) * np.abs(cos.mean(axis=1)).max():.1%}" in told
    linear = replace(item, settings=replace(settings, method="frequency", froude_krylov="linear"))
    assert not any("periods of the wave" in text for text in warnings(linear))


@pytest.mark.parametrize(("ratio", "told_so"), [(1.0, False), (5.0, True)])
def test_more_than_critical_damping_is_told_before_and_by_the_record(ratio, told_so):
    """Whose run knows linear damping alone; beside whatever else is odd."""
    item, h = flap()
    item = replace(item, settings=replace(item.settings, froude_krylov="linear"))
    damped = replace(item, floats=(replace(item.floats[0], pto_damping=0.0, critical_damping=ratio),))
    text = "floats.flap.critical_damping: 5 times the critical damping of hinge"
    assert any(told.startswith(text) for told in warnings(damped)) is told_so
    assert [told.startswith(text) for told in overdamped(damped)] == [True] * told_so
    bare = lines_in(1.0, replace(damped, floats=(replace(damped.floats[0], critical_damping=0.5),)), h)
    record = lines_in(1.0, damped, h).attrs.get("warnings", "")
    assert record.startswith(text) is told_so and record.endswith(bare.attrs.get("warnings", ""))


@pytest.mark.parametrize(
    ("froude_krylov", "rest", "mean", "std", "told"),
    [
        ("body-nonlinear", 0.0, 0.2, 1.0, True), ("linear", 0.0, 0.2, 1.0, False),
        ("body-nonlinear", 9.0, 9.0, 1.0, False), ("body-nonlinear", 9.0, 9.2, 1.0, True),
        ("body-nonlinear", 0.0, 1e-16, 1e-17, False),
    ],
)  # fmt: skip
def test_a_mean_that_the_incident_waves_alone_make_is_told(froude_krylov, rest, mean, std, told):
    """From where a pull keeps it, not by that; nor of pressure that is linear and has none, nor rounding."""
    item, _ = soft_mooring()
    item = replace(item, settings=replace(item.settings, froude_krylov=froude_krylov))
    table = np.zeros((1, 3, 5))
    table[..., STATISTICS.index("std")], table[:, 0, STATISTICS.index("mean")] = std, mean
    said = "; ".join(shoved(item, ["surge", "heave", "pitch"], {"motion": table}, np.array([rest, 0.0, 0.0])))
    assert ("floats.barge: its mean surge, 0.2 m from rest, is by the incident waves' pressure" in said) == told
    assert bool(said) == told


@pytest.mark.parametrize(
    ("away", "length", "rest", "least", "told"),
    [
        (0.0, 27.4, 7.71e4, 5e3, True), (0.0, 27.4, 7.71e4, 2e4, False), (0.0, 31.0, 8.25e3, 1e3, False),
        (100.0, 104.0, 8.098e4, 9e3, True), (100.0, 104.0, 8.098e4, 2e4, False),
    ],
)  # fmt: skip
def test_a_taut_line_that_goes_slack_is_told(away, length, rest, least, told):
    """Down to the weight of what hangs, 8.2 kN; not to its own, of which the seabed bears a part; no slack one."""
    item, _ = soft_mooring()
    (barge,) = item.floats
    line = Line(anchor=(-away, 0.0, -30.0), fairlead=(0.0, 0.0, -2.5), length=length, weight=300.0, EA=2e7)
    item = replace(item, floats=(replace(barge, lines=(line,)),))
    table = {"line_tension": np.full((1, 5), least)}
    said = "; ".join(snapped(item, table, np.zeros(3)))
    assert (f"floats.barge.lines: line 1, {rest:.4g} N at rest, goes slack, down to {least:.4g} N" in said) == told
    assert not told or not list(snapped(item, {}, np.zeros(3)))
    # Given elsewhere, from where it goes to the same place.
    lower = replace(line, fairlead=(0.0, 0.0, -3.5))
    moved = replace(item, floats=(replace(item.floats[0], hinge=(20.0, 0.0, 0.0), lines=(lower,)),))
    assert "; ".join(snapped(moved, table, np.array([-20.0, 1.0, 0.0]))) == said


@pytest.mark.parametrize(("far", "told"), [(2.01, True), (1.99, False)])
def test_a_fairlead_far_off_its_hull_is_told(far, told):
    """As global coordinates are."""
    item, _ = soft_mooring()
    (barge,) = item.floats
    away = far * barge.hull.size
    line = Line(anchor=(-90.0, 0.0, -50.0), fairlead=(away, 0.0, 0.0), length=130.0, weight=300.0, EA=2e7)
    texts = warnings(replace(item, floats=(replace(barge, lines=(line,)),)))
    assert any(f"the fairlead of line 1 lies {away:.4g} m from the reference point" in text for text in texts) is told


@pytest.mark.parametrize(
    ("depth", "z", "length", "told"),
    [
        (50.0, -50.0, 130.0, False), (50.0, -49.6, 130.0, False), (50.0, -49.4, 130.0, True),
        (50.0, -30.0, 90.0, False), (50.0, -30.0, 110.0, True), (np.inf, -50.0, 130.0, True),
    ],
)  # fmt: skip
def test_a_line_that_lies_above_the_seabed_is_told(depth, z, length, told):
    """From one hundredth of the depth on; a taut one lies nowhere, and its anchor may be on anything."""
    item, _ = soft_mooring()
    (barge,) = item.floats
    line = Line(anchor=(-90.0, 0.0, z), fairlead=(-5.0, 0.0, 0.0), length=length, weight=300.0, EA=2e7)
    item = replace(item, water=replace(item.water, depth=depth), floats=(replace(barge, lines=(line,)),))
    assert any("on a seabed at its anchor" in text for text in warnings(item)) is told


@pytest.mark.parametrize(
    ("Tp", "limit"), [(2.0, 1 / 15), (8.0, 1 / 15), (11.5, 4 / 75), (15.0, 1 / 25), (20.0, 1 / 25)]
)
def test_a_sea_steeper_than_those_of_nature_is_told(Tp, limit):
    """Of several waves, by the period of the highest; white noise has no peak."""
    item, high = buoy(WHOLE / 2), limit * 9.81 * Tp**2 / (2 * np.pi)
    for share, told in ((0.99, False), (1.01, True)):
        Hs = share * high
        waves = components(amplitude=[Hs / np.sqrt(8), 1e-6], omega=[2 * np.pi / Tp, 7.0], phase=[0.0, 0.0])
        assert any("limit of natural seas" in text for text in warnings(replace(item, sea=waves))) is told
    alone = replace(item, sea=regular(height=1.5 * high, period=Tp))
    assert not any("limit of natural seas" in text for text in warnings(alone))


@pytest.mark.parametrize("seed", [0, 1])
@pytest.mark.parametrize(
    ("spectrum", "Tp"),
    [(Jonswap(Hs=3.0, Tp=5.0), 5.0), (PiersonMoskowitz(Hs=3.0, Tp=4.0, form="mean"), 8 * np.pi / (0.8 * 692) ** 0.25)],
)
def test_a_steep_sea_is_told_with_the_numbers_that_it_was_given(spectrum, Tp, seed):
    """Not with those of a realization, 50 waves of which none is at the peak: nobody knows these."""
    item, waves = buoy(WHOLE / 2), realize(spectrum, components=50, band=(0.8, 4.0), seed=seed)
    steepness = 2 * np.pi * 3.0 / (9.81 * Tp**2)
    (text,) = (text for text in warnings(replace(item, sea=waves)) if "limit of natural seas" in text)
    assert f"Hs = 3 m and Tp = {Tp:.3g} s have a steepness 2π Hs/(g Tp²) of {steepness:.3g}, above" in text


@pytest.mark.parametrize(
    ("factor", "told"), [(1.0, ""), (1e-3, "in t m2"), (1e-6, "other units"), (1e6, "other units")]
)
def test_an_inertia_of_no_such_hull_is_told(factor, told):
    item = buoy(WHOLE / 2, motion=("heave", "pitch"), damping=0.0, inertia=(factor * 0.02,) * 3)
    texts = [text for text in warnings(item) if ".inertia: a radius of gyration" in text]
    assert len(texts) == bool(told) and all("about pitch" in text and told in text for text in texts)
    sliding = replace(item, floats=(replace(item.floats[0], motion=("heave",)),))
    assert not any("gyration" in text for text in warnings(sliding))


def test_a_long_hull_may_turn_about_its_length():
    """A cylinder fifty times as long as it is wide, about its axis."""
    spar = Revolution.vertical_cylinder(radius=1.0, draft=95.0, freeboard=5.0)
    item = buoy(95e3 * np.pi, hull=spar, motion=("yaw",), inertia=(2.5e8, 2.5e8, 1.5e5))
    assert not any("gyration" in text for text in warnings(item))


@pytest.mark.parametrize(
    ("top", "pressure", "told"),
    [
        (0.0, "body-nonlinear", True),
        (0.0, "linear", False),
        (0.5, "body-nonlinear", False),
        (-0.4, "body-nonlinear", False),
    ],
)
def test_a_hull_that_ends_at_still_water_is_told_where_waves_go_over_it(top, pressure, told):
    hull = prism([(-1.0, -2.0), (1.0, -2.0), (1.0, top), (-1.0, top)], 2.0)
    item = Float(
        name="lid", hull=hull, mass=1025 * hull.volume, inertia=(2e3,) * 3, hinge=(0, 0, 0.0), motion=("heave",),
        stiffness=1e5,
    )  # fmt: skip
    words = warnings(scene([item], froude_krylov=pressure))
    assert any("floats.lid.hull ends at still water" in text for text in words) == told
