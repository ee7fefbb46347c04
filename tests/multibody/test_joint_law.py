"""The joints' law: passive, its spring a potential, and asked by all in one place."""

import re
from pathlib import Path

import numpy as np
from hypothesis import given
from hypothesis import strategies as st
from pytest import approx

import solver
from solver.multibody.joint_law import JointLaw, absorbing, axis_damping, axis_load, joint_energy, joint_loads

LAW = JointLaw(
    pto=np.array([3e3, 0.0, 0.0]),
    damping=np.array([1e3, 2e3, 0.0]),
    quadratic=np.array([2e3, 0.0, 0.0]),
    spring=np.array([5e3, 0.0, 7e3]),
)
AXES = range(LAW.pto.size)
values = st.floats(-10, 10)


@given(y=values, dy=values)
def test_the_law_takes_power_at_any_position_and_rate(y, dy):
    for i in AXES:
        load = axis_load(LAW, i, y, dy)
        assert load.pto * dy >= 0 and load.loss * dy >= 0


@given(y=values)
def test_the_spring_is_the_slope_of_what_it_stores(y):
    """A parabola's central difference is exact; what is left is rounding of its 50 kJ."""
    slope = [(joint_energy(LAW, (y + 0.1) * e) - joint_energy(LAW, (y - 0.1) * e)) / 0.2 for e in np.eye(3)]
    assert slope == approx([axis_load(LAW, i, y, 0.0).spring for i in AXES], abs=1e-8)


def test_damping_at_rest_is_the_slope_there():
    """To the quadratic part, 1e-6 of the linear one at this rate."""
    for i in AXES:
        load = axis_load(LAW, i, 0.3, 1e-6)
        assert (load.pto + load.loss) / 1e-6 == approx(axis_damping(LAW, i), rel=1e-6)


def test_samples_of_all_axes_are_those_of_each():
    y, dy = np.random.default_rng(0).normal(size=(2, 5, 3))
    for part, values_ in joint_loads(LAW, y, dy)._asdict().items():
        each = [[getattr(axis_load(LAW, i, y[s, i], dy[s, i]), part) for i in AXES] for s in range(5)]
        assert np.array_equal(values_, each)


def test_an_axis_absorbs_where_its_load_does():
    loads = joint_loads(LAW, np.zeros((1, 3)), np.ones((1, 3)))
    assert absorbing(LAW).tolist() == (loads.pto[0] > 0).tolist() == [True, False, False]


def test_nobody_else_reads_the_laws_numbers():
    """So that a further kind of law is one file, and the two that describe it: the scene and the seam to arrays."""
    home = Path(solver.__file__).parent
    reading = re.compile(r"\blaw\.\w|pto_damping|quadratic_damping")
    readers = {str(p.relative_to(home)) for p in home.rglob("*.py") if reading.search(p.read_text())}
    assert readers == {"multibody/joint_law.py", "scene.py", "coupled/assembly.py"}
