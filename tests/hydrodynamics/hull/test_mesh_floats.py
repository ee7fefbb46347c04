"""Scenes whose floats are panel meshes: against hulls of revolution, the reference path, and closed forms."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from pytest import approx

from solver.errors import InputError
from solver.hydrodynamics.hull.panel_hull import PanelHull
from solver.hydrodynamics.hull.revolution import Revolution
from solver.record.refit import prepared
from solver.reference.run import simulate_reference
from solver.run import simulate
from solver.scene import Float, Scene, Settings, Water
from solver.sea.realization import CALM, regular
from tests.hydrodynamics.shapes import box, fine_box, meshed
from tests.once import solve

HULL = Revolution.hemisphere_cylinder(radius=1.0, height=0.6)
BARGE = fine_box((2.0, 3.0, 1.5), (0, 0, 0.25), 0.5)  # 0.5 m of draft
WATER = Water(depth=50.0)
PANELS = {"panels": 108, "depth": 50.0, "omega": np.linspace(0.3, 7.0, 20)}


@cache
def coefficients(hulls, centres, planar=True):
    return solve(hulls, np.array(centres), planar=planar, **PANELS)


def hinged(hull, name="front", side=-1, **changes):
    fields = {"mass": 1025 * hull.volume, "inertia": (859.0,) * 3, "pto_damping": 1e5} | changes
    return Float(name=name, hull=hull, hinge=(side * 1.5, 0, 2.6), arm=(side * 2.36, 0, -2.6), **fields)


def scene(*floats, sea=CALM, **settings):
    fields = {"duration": 30.0, "discard": 10.0, "ramp": 10.0, "keep_series": True} | settings
    return Scene(water=WATER, sea=sea, floats=floats, settings=Settings(**fields))


def series(record, name="rotation"):
    return np.asarray(record.series[name][1])


def test_a_meshed_float_moves_as_the_one_of_revolution(buan):
    """Both kinds in one scene, fixed platform; then the meshed one at the front."""
    floats = hinged(HULL), hinged(HULL, "rear", 1)
    known = coefficients((HULL, HULL), tuple(map(tuple, (f.centre for f in floats))))
    whole = series(simulate(scene(*floats, sea=buan.sea()), known))
    mesh = meshed(HULL, 30)
    mixed = replace(floats[0], hull=mesh, mass=1025 * mesh.volume)
    ours = series(simulate(scene(mixed, floats[1], sea=buan.sea()), known))
    # The same coefficients; 30 panels along the meridian give the load to 1e-3.
    assert np.sqrt(np.mean((ours - whole) ** 2)) < 3e-3 * np.sqrt(np.mean(whole**2))


@pytest.mark.parametrize("motion", [("heave",), pytest.param(("hinge",), marks=pytest.mark.slow)])
def test_decay_of_a_barge_as_on_the_reference_path(motion):
    """Panel-wise pressure of the paper and augmented coordinates, from 0.3 m or 0.2 rad."""
    item = hinged(BARGE, motion=motion, offset=0.3 if motion == ("heave",) else 0.2, pto_damping=0.0)
    known = coefficients((BARGE,), (tuple(item.centre),))
    decay = scene(item, duration=2.0, discard=0.0, ramp=0.0, time_step=0.05, newton_tolerance=1e-9)
    ours = simulate(decay, known)
    slow = simulate_reference(decay, known, kernel=prepared(decay, known).fit, surface="panels")
    name = "motion" if motion == ("heave",) else "rotation"
    # Hydrostatics are exact on both sides, and so is the collocation: iterations end at 1e-9, measured 1e-8.
    assert np.abs(series(ours, name) - series(slow, name)).max() < 1e-7


def test_small_heave_of_a_box_has_its_closed_form_stiffness():
    """At rest and 1 mm lower: the reaction of a guided box is ρgS per metre, whichever way pressure is computed."""
    loads = []
    for kind in ("body-nonlinear", "linear"):
        item = Float(name="box", hull=BARGE, mass=1025 * 3.0, inertia=(1e3,) * 3, hinge=(0, 0, 0), arm=(0, 0, 0),
                     motion=("heave",), stiffness=1e6, offset=0.0)  # fmt: skip
        heavy = replace(item, mass=item.mass + 100.0)
        known = coefficients((BARGE,), ((0.0, 0.0, 0.0),))
        record = simulate(scene(heavy, duration=1.0, discard=0.0, ramp=0.0, froude_krylov=kind), known)
        loads.append(series(record, "motion")[-1].ravel()[0])
    assert loads == approx([-100 * 9.81 / (1025 * 9.81 * 6.0 + 1e6)] * 2, rel=1e-6)


def test_linear_barge_off_its_reference_point_rests_level():
    """Buoyancy ahead of the hinge's float centre: weight above it balances, and a free barge stays level."""
    hull = PanelHull.of(*box((2.0, 3.0, 1.5), (0.4, 0.0, 0.25)))
    item = Float(name="box", hull=hull, mass=1025 * 3.0, inertia=(2e3,) * 3, cog=(0.4, 0, 0), hinge=(0, 0, 0),
                 arm=(0, 0, 0), motion=("heave", "pitch"))  # fmt: skip
    known = coefficients((hull,), ((0.0, 0.0, 0.0),))
    for kind in ("linear", "body-nonlinear"):
        record = simulate(scene(item, duration=2.0, discard=0.0, ramp=0.0, froude_krylov=kind), known)
        assert np.abs(series(record, "motion")).max() < 1e-9


@pytest.mark.parametrize(
    ("centre", "cog", "joint"),
    [
        pytest.param((0.4, 0.0, 0.25), (0.45, 0.0, -0.2), {"motion": ("heave", "pitch")}, marks=pytest.mark.slow),
        ((0.4, 0.3, 0.25), (0.45, 0.25, -0.2), {"motion": ("heave", "roll", "pitch")}),
        pytest.param(
            (0.4, 0.3, 0.25), (0.45, 0.25, -0.2),
            {"arm": (2.0, 0.5, -1.0), "axis": (0.3, 1.0, 0.0), "damping": 1e4}, marks=pytest.mark.slow,
        ),
    ],
)  # fmt: skip
@pytest.mark.parametrize("sea", [pytest.param(CALM, marks=pytest.mark.slow), regular(height=0.2, period=3.0)])
def test_linear_lopsided_hulls_move_alike_on_both_paths(centre, cog, joint, sea):
    """Buoyancy and weight, both off the reference point, balance at the same attitude: calm water leaves it there."""
    hull = PanelHull.of(*box((2.0, 3.0, 1.5), centre))
    fields = {"arm": (0, 0, 0), **joint}
    item = Float(name="box", hull=hull, mass=1025 * 3.0, inertia=(2e3, 1e3, 3e3), cog=cog,
                 hinge=tuple(-np.array(fields["arm"])), **fields)  # fmt: skip
    known = coefficients((hull,), ((0.0, 0.0, 0.0),), planar=False)
    linear = scene(item, sea=sea, duration=3.0, discard=0.0, ramp=0.0, froude_krylov="linear", time_step=0.05,
                   newton_tolerance=1e-11)  # fmt: skip
    name = "motion" if "motion" in joint else "rotation"
    fast, slow = simulate(linear, known), simulate_reference(linear, known, kernel=prepared(linear, known).fit)
    # Both are of fourth order at a sixtieth of the period; angles or quaternions differ in its constant.
    assert series(slow, name) == approx(series(fast, name), abs=1e-6)
    assert series(slow, "hinge_force") == approx(series(fast, "hinge_force"), abs=1e-5 * 1025 * 3.0 * 9.81)
    assert sea is not CALM or np.ptp(series(slow, name), axis=0).max() < 1e-9


def test_a_lopsided_hull_leaves_the_plane():
    lopsided = PanelHull.of(*box((2.0, 3.0, 1.5), (0, 0.2, 0.25)))
    assert scene(hinged(BARGE)).planar and not scene(hinged(lopsided)).planar


def test_an_open_mesh_is_for_linear_forces():
    vertices, faces = box((2.0, 3.0, 1.5), (0, 0, 0.25))
    hull = PanelHull.of(vertices, faces[:5])
    assert scene(hinged(hull), froude_krylov="linear").floats
    with pytest.raises(InputError, match="must be closed") as error:
        scene(hinged(hull))
    assert error.value.key == "floats.front.hull"


def test_a_mesh_through_the_seabed_is_refused():
    deep = PanelHull.of(*box((2.0, 2.0, 120.0)))
    with pytest.raises(InputError, match="seabed"):
        scene(hinged(deep))
