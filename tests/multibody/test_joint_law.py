"""The joints' law: passive, its spring a potential, and asked by all in one place."""

import re
from pathlib import Path

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st
from pytest import approx

import solver
from solver.coupled.assembly import joint_law
from solver.multibody.joint_law import (
    HELD,
    LIMITED,
    LINEAR,
    OPEN,
    PRESSED,
    PTO_ZONE,
    RELEASED,
    SLIPS,
    STOP_ZONE,
    Couplings,
    JointLaw,
    axis_damping,
    axis_energy,
    axis_load,
    end_stops,
    stop_load,
    tangent,
)
from solver.multibody.linearised import damping_of_gaussian, damping_of_harmonic
from solver.multibody.load_table import NO_POINTS, tables
from solver.multibody.of_axes import absorbing, bent, joint_energy, joint_loads
from solver.multibody.zones import leaving, limited, next_zone, off_stop, pto_zone, stops_zone, within_stops

LAW = JointLaw(
    pto_damping=np.array([3e3, 0.0, 0.0, 2e3, 4e3]),
    damping=np.array([1e3, 2e3, 0.0, 0.0, 0.0]),
    quadratic_damping=np.array([2e3, 0.0, 0.0, 0.0, 0.0]),
    stiffness=np.array([5e3, 0.0, 7e3, 0.0, 0.0]),
    pto_stiffness=np.array([-1e3, 0.0, 0.0, 0.0, 0.0]),
    preload=np.array([0.0, 0.0, -2e3, 0.0, 0.0]),
    coulomb=np.array([0.0, 0.0, 0.0, 500.0, 0.0]),
    force_limit=np.array([np.inf, np.inf, np.inf, 4e3, 6e3]),
    declutch_load=np.full(5, np.inf),
    latch_load=np.zeros(5),
    one_way=np.array([0.0, 0.0, 0.0, 0.0, -0.75]),
    end_stops=end_stops(
        np.array([0.0, -1.0, 0.0, 0.0, -2.0]),
        np.array([0.0, 2.0, 0.0, 0.0, 3.0]),
        np.array([0.0, 6e3, 0.0, 0.0, 0.0]),
        np.array([0.0, 3e3, 0.0, 0.0, 2e3]),
    ),
    couplings=Couplings(*np.zeros((2, 0), np.int64), *np.zeros((2, 0))),
    moorings=joint_law(()).moorings,
    tables=tables([NO_POINTS] * 5),
)
AXES = range(LAW.pto_damping.size)
values = st.floats(-10, 10)


def load_at(i, y, dy):
    """In the zones where y, dy lie."""
    return axis_load(LAW, i, stops_zone(LAW, i, y, dy), pto_zone(LAW, i, y, dy), y, dy)


@given(y=values, dy=values)
def test_the_law_takes_power_at_any_position_and_rate(y, dy):
    for i in AXES:
        load = load_at(i, y, dy)
        assert load.pto * dy >= 0 and load.loss * dy >= 0


@given(y=values)
def test_the_spring_is_the_slope_of_what_it_stores(y):
    """A parabola's central difference is exact but across a stop's bound, 0.1 away; the rest is rounding of 0.5 MJ."""
    slope = [(joint_energy(LAW, (y + 0.1) * e) - joint_energy(LAW, (y - 0.1) * e)) / 0.2 for e in np.eye(len(AXES))]
    kinks = [0.0, 6e3 * 0.1 if min(abs(y + 1), abs(y - 2)) < 0.1 else 0.0, 0.0, 0.0, 0.0]
    for i in AXES:
        assert slope[i] == approx(load_at(i, y, 0.0).spring, abs=kinks[i] + 1e-7)


def test_damping_at_rest_is_the_slope_there():
    """To the quadratic part, 1e-6 of the linear one at this rate; for a one-way power take-off between both senses'."""
    for i in (0, 1, 2):
        load = load_at(i, 0.3, 1e-6)
        assert (load.pto + load.loss) / 1e-6 == approx(axis_damping(LAW, i), rel=1e-6)
    both = [load_at(4, 0.0, dy).pto / dy for dy in (-1e-6, 1e-6)]
    assert np.mean(both) == approx(axis_damping(LAW, 4)) and both == approx([4e3, 1e3])


@given(y=values, dy=values)
def test_a_stop_is_a_spring_and_a_damper_beyond_its_bound_that_do_not_pull(y, dy):
    for i, (low, high, k, c) in {1: (-1.0, 2.0, 6e3, 3e3), 4: (-2.0, 3.0, 0.0, 2e3)}.items():
        over, under = max(0.0, y - high), max(0.0, low - y)
        push = max(0.0, k * over + c * dy) if over else -max(0.0, k * under - c * dy) if under else 0.0
        bare = axis_load(LAW, i, OPEN, pto_zone(LAW, i, y, dy), y, dy)
        load = load_at(i, y, dy)
        total = load.loss + load.spring - bare.loss - bare.spring
        assert total == approx(push, abs=1e-9)
        assert stop_load(LAW, i, stops_zone(LAW, i, y, dy), y, dy) == approx(abs(push), abs=1e-9)
        samples = joint_loads(LAW, *np.full((2, 1, len(AXES)), [[[y]], [[dy]]]))  # which no zone tells what came before
        stored, lost = samples.spring[0, i] - bare.spring, samples.loss[0, i] - bare.loss
        assert [stored, stored + lost] == approx([k * (over - under), push], abs=1e-9)


@given(dy=values)
def test_a_power_take_off_has_a_constant_part_a_limit_and_a_sense(dy):
    assert load_at(3, 0.0, dy).pto == approx(np.sign(dy) * min(2e3 * abs(dy) + 500, 4e3) if dy else 0.0)
    assert load_at(4, 0.0, dy).pto == approx((0.25 if dy > 0 else 1.0) * np.sign(dy) * min(4e3 * abs(dy), 6e3))


@given(y=values, dy=values)
def test_a_zone_ends_where_the_next_one_begins(y, dy):
    """Where y, dy lie nothing is left; from the zone before, what comes next leads there."""
    for i in (1, 3, 4):
        for kind, here in ((STOP_ZONE, stops_zone(LAW, i, y, dy)), (PTO_ZONE, pto_zone(LAW, i, y, dy))):
            assert not leaving(LAW, i, kind, here, y, dy) > 0
    here, low, high = stops_zone(LAW, 1, y, dy), -1.0, 2.0
    side = 1 if y > (low + high) / 2 else -1
    # What presses comes free before it is off the stop, if it comes off.
    before = [OPEN, side * RELEASED] + [side * PRESSED] * (not low <= y <= high)
    for zone in before:
        way = [zone]
        while leaving(LAW, 1, STOP_ZONE, way[-1], y, dy) > 0:
            way.append(next_zone(LAW, 1, STOP_ZONE, way[-1], y, dy))
            assert len(way) < 4
        loads = [sum(axis_load(LAW, 1, z, LINEAR, y, dy)) for z in (way[-1], here)]
        meets = zone == side * RELEASED and low <= y <= high and side * dy > 0  # it will be on the stop again
        assert meets or loads[0] == approx(loads[1], abs=1e-9)


@given(y=st.tuples(values, values), at=st.floats(0, 1), dy=values)
def test_what_stays_leaves_no_zone(y, at, dy):
    """Axis 1 has stops, axis 3 a limit, axis 0 neither."""
    low, high = min(y), max(y)
    for i in (0, 1, 3):
        inside = [leaving(LAW, i, kind, OPEN, low + at * (high - low), dy) for kind in (STOP_ZONE, PTO_ZONE)]
        assert not (within_stops(LAW, i, low, high) and inside[0] > 0) and (limited(LAW, i) or inside[1] <= 0)
    assert [limited(LAW, i) for i in (0, 1, 3)] == [False, False, True]
    assert within_stops(LAW, 0, low, high) and within_stops(LAW, 1, -0.9, 1.9)
    assert not within_stops(LAW, 1, -0.9, 2.0) and not within_stops(LAW, 1, -1.0, 1.9)


@given(y=values)
def test_who_comes_free_of_a_stop_is_off_it_where_it_ends(y):
    assert off_stop(LAW, 1, RELEASED, y) == (y < 2.0) and off_stop(LAW, 1, -RELEASED, y) == (y > -1.0)
    assert not off_stop(LAW, 1, PRESSED, y) and not off_stop(LAW, 1, OPEN, y)


def test_tangents_are_the_slopes_in_each_zone():
    cases = [(1, PRESSED, LINEAR), (1, -PRESSED, LINEAR), (1, RELEASED, LINEAR), (4, OPEN, SLIPS), (4, OPEN, -SLIPS),
             (4, OPEN, LIMITED), (3, OPEN, HELD), (3, OPEN, -SLIPS)]  # fmt: skip
    for i, stops, pto in cases:
        total = [sum(axis_load(LAW, i, stops, pto, y, dy)) for y, dy in ((1.0, 2.0), (1.5, 2.0), (1.0, 2.5))]
        stiffness, damping = tangent(LAW, i, stops, pto)
        assert (total[1] - total[0]) / 0.5 == approx(stiffness + LAW.stiffness[i], abs=1e-9)
        assert (total[2] - total[0]) / 0.5 == approx(damping + axis_damping(LAW, i), abs=1e-9)


def test_only_what_has_several_zones_is_bent():
    assert bent(LAW).tolist() == [False, True, False, True, True]


def test_a_stop_stores_energy_while_an_axis_presses_on_it():
    assert axis_energy(LAW, 1, PRESSED, 3.0) == axis_energy(LAW, 1, -PRESSED, -2.0) == 3e3
    assert axis_energy(LAW, 1, RELEASED, 3.0) == axis_energy(LAW, 1, OPEN, 1.9) == 0.0


@settings(max_examples=15)
@given(size=st.floats(0.01, 20))
def test_linearised_power_take_offs_absorb_as_much(size):
    """Against means of f ẏ over a sine's phases and over the normal distribution; at rest what is linear is left."""
    one = LAW._replace(one_way=np.zeros(len(AXES)))
    x = np.linspace(-9, 9, 9001)
    w = np.exp(-(x**2) / 2)
    phase = (np.arange(4000) + 0.5) * np.pi / 4000
    cases = [(damping_of_harmonic, np.sin(phase), 1 / 4000), (damping_of_gaussian, x, w / w.sum())]
    for equivalent, shape, weight in cases:
        rates = np.repeat(size * shape[:, None], len(AXES), axis=1)
        power = np.sum(np.atleast_1d(weight)[:, None] * joint_loads(one, 0 * rates, rates).pto * rates, axis=0)
        square = np.sum(weight * (size * shape) ** 2)
        assert equivalent(one, np.full(len(AXES), size)) == approx(power / square, rel=1e-5)
        assert equivalent(one, np.zeros(len(AXES))).tolist() == one.pto_damping.tolist()


def test_a_saturated_damper_has_its_describing_function():
    """(2c/π)(asin s + s (1 - s²)^½), s = F_max/cV: 0.8 and 0.6 make a case without roots."""
    law = LAW._replace(force_limit=np.full(len(AXES), 6e3), coulomb=np.zeros(len(AXES)))
    exact = 2 * 4e3 / np.pi * (np.arcsin(0.6) + 0.6 * 0.8)
    assert damping_of_harmonic(law, np.full(len(AXES), 2.5))[4] == approx(exact, rel=1e-12)
    assert damping_of_harmonic(law, np.full(len(AXES), 1.4))[4] == approx(4e3, rel=1e-12)
    friction = damping_of_harmonic(law._replace(coulomb=np.full(len(AXES), 100.0)), np.full(len(AXES), 0.5))[1]
    assert friction == approx(4 * 100.0 / (np.pi * 0.5), rel=1e-12)


def test_samples_of_all_axes_are_those_of_each():
    y, dy = np.random.default_rng(0).normal(size=(2, 5, len(AXES)))
    for part, values_ in joint_loads(LAW, y, dy)._asdict().items():
        each = [[getattr(load_at(i, y[s, i], dy[s, i]), part) for i in AXES] for s in range(5)]
        assert np.array_equal(values_, each)


def test_an_axis_absorbs_where_its_load_does():
    loads = joint_loads(LAW, np.zeros((1, len(AXES))), np.ones((1, len(AXES))))
    assert absorbing(LAW).tolist() == (loads.pto[0] > 0).tolist() == [True, False, False, True, True]


def test_nobody_else_reads_the_laws_numbers():
    """So that a further kind of law is in these files, and the scene's that have its inputs."""
    home = Path(solver.__file__).parent
    reading = re.compile(r"\blaw\.\w|pto_damping|quadratic_damping|force_limit")
    readers = {str(p.relative_to(home)) for p in home.rglob("*.py") if reading.search(p.read_text())}
    law = {f"multibody/{name}.py" for name in ("joint_law", "zones", "of_axes", "linearised")}
    assert readers == law | {"scene/floats.py", "scene/scene.py"}


def test_what_has_neither_stiffness_nor_damping_has_no_stops():
    assert LAW.end_stops.lower.tolist() == [-np.inf, -1.0, -np.inf, -np.inf, -2.0]
    assert LAW.end_stops.upper.tolist() == [np.inf, 2.0, np.inf, np.inf, 3.0]
