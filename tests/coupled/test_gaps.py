"""A scene with a damping lid in time and in frequencies, and what it says where there is none."""

from dataclasses import replace

import numpy as np
import pytest
from pytest import approx

from solver.coupled.preparation import prepare
from solver.errors import InputError
from solver.hydrodynamics.radiation.fitting import USUAL
from solver.oddities import warnings
from solver.run import simulate
from solver.scene import Settings
from studies.validation import gaps
from tests.once import solve

RING, BOXES = gaps.SCENES


def known(item):
    """By coarse panels."""
    s = item.settings
    return solve(
        tuple(f.hull for f in item.floats), np.array([f.centre for f in item.floats]), depth=item.water.depth,
        omega=np.linspace(0.15, 4.2, 40), panels=108, gap_damping=s.gap_damping, gap_width=s.gap_width,
    )  # fmt: skip


@pytest.mark.slow
@pytest.mark.parametrize("name", [RING, BOXES])
def test_a_memory_fits_what_a_lid_damps(name):
    """And floats give as much power in time as in the frequency domain; without a lid neither, see studies.validate."""
    march, lines = (gaps.scene(name, 0.1, method) for method in ("time", "frequency"))
    h = known(march)
    record = simulate(march, h)
    assert record.attrs["memory_error"] < USUAL and not record.attrs["unmet"]
    assert abs(record.attrs["energy_residual"]) < 1e-5
    assert gaps.power(record) == approx(gaps.power(simulate(lines, h)), rel=0.02)


@pytest.mark.slow
def test_coefficients_have_the_lid_that_the_scene_says():
    item = gaps.scene(BOXES, 0.1, "frequency")
    with pytest.raises(InputError, match=r"settings.gap_damping = 0.2: must be 0.1, that of the coefficients"):
        prepare(replace(item, settings=replace(item.settings, gap_damping=0.2)), known(item))


def test_a_lid_that_lies_nowhere_is_told():
    item = gaps.scene(RING, 0.1, "frequency")
    assert not [text for text in warnings(item) if "gap" in text]
    wide = replace(item, settings=replace(item.settings, gap_width=0.3))
    assert "solver.gap_width: no gap or well at rest is narrower than 0.3 m, so no lid damps any" in warnings(wide)
    for width in (0.7, 20.0, 50.0):  # of any that gaps are narrower than
        wider = replace(item, settings=replace(item.settings, gap_width=width))
        assert not [text for text in warnings(wider) if "gap" in text], width
    alone = replace(item, settings=replace(item.settings, interaction=False))
    assert [text for text in warnings(alone) if "gap" in text]  # the ring's own well is wider, and no other body in it


@pytest.mark.parametrize("given", [{"gap_damping": 0.1}, {"gap_width": 0.1}])
def test_damping_and_width_go_together(given):
    (name,) = given
    other = {"gap_damping": "gap_width", "gap_width": "gap_damping"}[name]
    with pytest.raises(InputError, match=rf"settings.{other} = 0.0: must be > 0 with {name} = 0.1"):
        Settings(**given)
