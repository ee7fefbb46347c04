"""Elements that a member has where none are given, against what they are to leave out at most."""

from dataclasses import replace

import numpy as np
import pytest

from solver.errors import InputError
from solver.structure import fineness
from solver.structure.fineness import FEWEST, LEFT_OUT, MOST, by_inertia, divided
from solver.structure.frame import Frame
from solver.structure.frame_model import assemble
from solver.structure.members import MarineGrowth, Member
from solver.structure.modes import modes
from solver.structure.sections import box, tube
from tests.structure.test_soil import bent, even, pile

WATER = {"density": 1025.0, "gravity": 9.81}


def column(steel, *, length=50.0, elements=1, section=None, **fields):
    member = Member(
        name="leg",
        start="foot",
        end="top",
        elements=elements,
        section=section or tube(0.5, 0.02),
        material=steel,
        **fields,
    )
    return Frame(nodes={"foot": (0, 0, -length), "top": (0, 0, 0)}, members=(member,), clamped=("foot",))


BARE = np.zeros(2)


def elements(frame):
    return divided(frame, {"leg", "pile"}, **WATER).members[0].elements


@pytest.mark.parametrize("count", [8, 16])
def test_what_inertia_leaves_out_is_what_a_modes_square_is_too_large_by(steel, count):
    """Of a cantilever's second mode: ω² by (βL/n)⁴/720, where βL = 4.694."""
    frame = column(steel, elements=count)
    omega = [modes(m.K, m.M, m.free, 3).omega[2] for m in (assemble(frame), assemble(column(steel, elements=64)))]
    leg = frame.members[0]
    told = omega[1] ** 2 * by_inertia(leg, leg.section, 50.0 / count, 0.0, BARE)
    assert (omega[0] / omega[1]) ** 2 - 1 == pytest.approx(told, rel=0.05)


def test_elements_are_halved_until_no_more_is_left_out(steel):
    """Powers of two, at least as many as an axial load needs; a thicker leg has longer ones."""
    thin, thick = (column(steel, section=tube(D, D / 25)) for D in (0.3, 1.5))
    counts = [elements(frame) for frame in (thin, thick)]
    assert FEWEST <= counts[1] < counts[0] <= MOST
    assert all(np.log2(n) % 1 == 0 for n in counts)
    leg, omega2 = thin.members[0], 2 * np.pi * 9.81 / (fineness.SHORTEST * 0.3)
    usual, half = (omega2 * by_inertia(leg, leg.section, 50.0 / n, 1025.0, BARE) for n in (counts[0], counts[0] / 2))
    assert usual < LEFT_OUT < half


def test_given_elements_stay(steel):
    frame = column(steel, elements=3)
    assert divided(frame, set(), **WATER) == frame
    assert elements(column(steel, length=2.0)) == FEWEST


def test_a_pile_in_soil_has_elements_that_its_head_does_not_notice(steel):
    """By Hetényi's 2Hβ/k, within what the soil may leave out."""
    model = pile(steel, 1, even(2e7))
    many = divided(model.frame, {"pile"}, **WATER)
    k, section = 2e7, many.members[0].section
    beta = (k / (4 * steel.E * section.Iy)) ** 0.25
    head = bent(assemble(many)).reshape(-1, 6)[1, 0]
    assert many.members[0].elements > FEWEST
    assert head == pytest.approx(2 * 3e5 * beta / k, rel=LEFT_OUT)


def test_a_taper_has_elements_that_follow_it(steel):
    cone = column(steel, length=10.0, section=tube(2.0, 0.05), end_section=tube(1.0, 0.025))
    straight = column(steel, length=10.0, section=tube(1.0, 0.025))
    assert elements(cone) > elements(straight)


def test_more_than_a_platform_may_have_are_refused(steel, monkeypatch):
    monkeypatch.setattr(fineness, "MOST_OF_ALL", 3)
    with pytest.raises(InputError, match=r"members = 4 elements: must be <= 3"):
        elements(column(steel, length=2.0))


def test_water_that_moves_with_a_member_counts(steel):
    """Around it by C_M - 1, in it where it is flooded."""
    bare, wet = (column(steel, inertia_coefficient=c).members[0] for c in (1.0, 2.0))
    flooded = column(steel, inertia_coefficient=1.0, flooded=True).members[0]
    section = bare.section
    alone, around, within = (by_inertia(m, section, 5.0, 1025.0, BARE) for m in (bare, wet, flooded))
    own = steel.density * section.area
    assert around / alone == pytest.approx(1 + 1025.0 * np.pi / 4 * 0.5**2 / own)
    assert within / alone == pytest.approx(1 + 1025.0 * np.pi / 4 * 0.46**2 / own)


def test_growth_that_moves_with_a_member_counts(steel):
    """By its own mass, and by the water round a thicker member; as thick as anywhere on it."""
    lines = tuple(
        MarineGrowth(depth=z, thickness=t, density=1300.0) for z, t in ((0.0, 0.02), (20.0, 0.1), (40.0, 0.0))
    )
    frame = replace(column(steel, inertia_coefficient=2.0), growth=lines)
    growth = fineness.thickest(frame, frame.ends(frame.members[0]))
    assert growth == pytest.approx([0.1, 1300.0])
    step = (*lines[:2], MarineGrowth(depth=20.0, thickness=0.0, density=1300.0))
    assert fineness.thickest(replace(frame, growth=step), frame.ends(frame.members[0])) == pytest.approx(growth)
    (member,), bare, whole = frame.members, np.pi / 4 * 0.5**2, np.pi / 4 * 0.7**2
    alone, grown = (by_inertia(member, member.section, 5.0, 1025.0, g) for g in (BARE, growth))
    square = replace(member, section=box(0.5, 0.5, 0.01), inertia_coefficient=1.0)
    none, some = (by_inertia(square, square.section, 5.0, 1025.0, g) for g in (BARE, growth))
    assert none == some  # it grows on what is round alone
    own = steel.density * member.section.area
    assert grown / alone == pytest.approx((own + 1025.0 * whole + 1300.0 * (whole - bare)) / (own + 1025.0 * bare))
    assert elements(frame) >= elements(replace(frame, growth=()))
