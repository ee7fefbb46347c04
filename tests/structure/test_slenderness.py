"""Morison's inertia load beside MacCamy and Fuchs's: limits, tabulated Bessel functions, seas, what is told."""

from dataclasses import replace

import numpy as np
import pytest
from pytest import approx
from scipy.special import h1vp

from solver.oddities import warnings
from solver.run import simulate
from solver.scene import Platform, Scene, Settings, Water
from solver.sea.field import WaveField
from solver.sea.realization import CALM, components, regular
from solver.structure import slenderness
from solver.structure.frame import Frame
from solver.structure.frame_model import assemble
from solver.structure.members import MarineGrowth, Material, Member
from solver.structure.sections import tube
from solver.structure.slenderness import diffracted, overloaded

DEPTH = 20.0
STIFF = Material(E=2.1e13, G=8.0e12, density=7850.0)


def pile(diameter=8.0, name="pile", **changes):
    fields = {"elements": 4, "section": tube(diameter, 0.08), "material": STIFF, "inertia_coefficient": 2.0} | changes
    return Member(name=name, start="foot", end="top", **fields)


def frame(*members, **changes):
    nodes = {"foot": (0.0, 0.0, -DEPTH), "top": (0.0, 0.0, 5.0)}
    return Frame(nodes=nodes, members=members or (pile(),), clamped=("foot",), **changes)


def sea(*periods, height=0.5):
    of = {"amplitude": [height / 2] * len(periods), "phase": [0.3] * len(periods)}
    return components(omega=2 * np.pi / np.array(periods), **of)


def excess(*periods, of=None, lacking=0.0):
    return overloaded(assemble(of or frame()), WaveField(sea(*periods), DEPTH, 9.81), lacking)


def scene(waves, of=None):
    platform = Platform(frame=of or frame(), legs=("pile",))
    settings = Settings(duration=200.0, discard=100.0, ramp=50.0, outputs=("reactions",))
    return Scene(water=Water(depth=DEPTH), sea=waves, floats=(), platform=platform, settings=settings)


def test_long_waves_meet_a_thin_cylinder():
    ka = np.array([1e-2, 1e-3, 1e-4])
    assert np.all(np.abs(diffracted(ka) - 1) < ka**2 * np.log(1 / ka))
    assert diffracted(ka) == approx(1, abs=1e-3)


@pytest.mark.parametrize(
    ("ka", "J", "Y"),
    [
        (1.0, (0.7651976866, 0.4400505857), (0.0882569642, -0.7812128213)),
        (2.0, (0.2238907791, 0.5767248078), (0.5103756726, -0.1070324315)),
    ],
)
def test_shorter_ones_by_tables(ka, J, Y):
    """Abramowitz and Stegun, tables 9.1: J₁' = J₀ - J₁/ka, and so Y₁'."""
    slope = np.hypot(J[0] - J[1] / ka, Y[0] - Y[1] / ka)
    assert diffracted(np.array(ka)) == approx(2 / (np.pi * ka**2 * slope), rel=1e-9)


def test_at_five_diameters_a_twentieth_is_left_out():
    assert diffracted(np.pi / slenderness.SHORTEST) == approx(0.943, abs=1e-3)


@pytest.mark.parametrize(("period", "told"), [(4.0, 0.47), (5.0, 0.07)])
def test_the_base_shear_of_a_stiff_pile_is_as_much_too_large(period, told):
    """Of the march, against MacCamy and Fuchs's over the whole depth, 4ρgA/k² tanh kh/|H₁'(ka)|."""
    record = simulate(scene(regular(height=0.5, period=period)))
    k = WaveField(sea(period), DEPTH, 9.81).k[0]
    exact = 4 * 1025 * 9.81 * 0.25 / k**2 * np.tanh(k * DEPTH) / abs(h1vp(1, 4 * k)) / np.sqrt(2)
    std = record.variables["base_shear"][1][0, -1]
    assert std / exact - 1 == approx(told, abs=0.01)
    assert excess(period).excess == approx(std / exact - 1, abs=2e-3)  # drag and the pile's own sway
    assert f"the std of its inertia load is {told:.0%} too large" in record.attrs["warnings"]


def test_each_wave_counts_by_its_load():
    """However deep it reaches, on a pile of one element, too."""
    k = WaveField(sea(8.0, 3.0), DEPTH, 9.81).k
    loads = np.tanh(k * DEPTH)  # over g|a|, the integral of ω² cosh k(z+h)/sinh kh
    exact = loads * diffracted(4 * k)
    told = excess(8.0, 3.0, of=frame(pile(elements=1)))
    assert told.excess == approx(np.linalg.norm(loads) / np.linalg.norm(exact) - 1, rel=1e-6)


def test_the_worst_member_is_named_with_its_growth():
    grown = frame(pile(6.0, "thin"), pile(8.0), growth=(MarineGrowth(depth=0.0, thickness=0.1, density=1300.0),))
    worst = excess(4.0, of=grown)
    assert (worst.name, worst.diameter) == ("pile", approx(8.2))
    assert worst.excess > excess(4.0).excess
    (text,) = [t for t in warnings(scene(sea(4.0), grown)) if "Morison" in t]
    assert text == (
        "platform.members.pile, 8.2 m in diameter with marine growth: Morison's equation does not hold in waves shorter"
        f" than 5 diameters, 41 m or 5.14 s, and in this sea the std of its inertia load is {worst.excess:.0%} too"
        " large (MacCamy and Fuchs 1954)"
    )


def test_other_coefficients_are_of_other_loads():
    """What C_M = 1.6 already leaves out is no fault; above 2 the shape makes it more, and diffraction less of that."""
    usual = excess(4.0).excess
    assert excess(4.0, of=frame(pile(inertia_coefficient=1.6))).excess == approx(0.8 * (1 + usual) - 1)
    assert excess(4.0, of=frame(pile(inertia_coefficient=2.5))).excess == approx(usual)
    assert excess(4.0, lacking=1.0).excess == approx(0.5 * (1 + usual) - 1)


def told(waves, of=None):
    return [text for text in warnings(scene(waves, of)) if "Morison" in text]


def test_what_is_thin_dry_or_calm_has_no_such_warning(buan):
    assert told(sea(4.0)) and told(sea(5.0))
    assert told(sea(5.1)) == told(CALM) == []  # 5 diameters are 5.07 s
    swell, more = (components(amplitude=[1.0, a], omega=[1.1, 1.5], phase=[0.0, 0.0]) for a in (0.4, 0.6))
    assert told(swell) == [] and told(more)  # 3 and 6 % too large
    assert told(sea(4.0), frame(pile(inertia_coefficient=1.0))) == []
    assert not any("Morison" in text for text in warnings(buan.scene()))


def test_the_papers_form_of_inertia_lacks_half():
    relative = scene(sea(4.0))
    relative = replace(relative, platform=replace(relative.platform, wave_inertia="relative"))
    assert not any("Morison" in text for text in warnings(relative))
