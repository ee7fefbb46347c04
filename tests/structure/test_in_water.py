"""What is told of a frame that buckles or bends too far under what it bears at rest."""

from dataclasses import replace

import numpy as np
import pytest
from pytest import approx

from solver.errors import InputError
from solver.oddities import warnings
from solver.run import simulate
from solver.scene import Platform, Scene, Settings, Water
from solver.sea.realization import CALM, regular
from solver.structure.frame import Frame
from solver.structure.in_water import dynamic_model
from solver.structure.members import Material, Member, PointLoad, PointMass
from solver.structure.sections import tube

HEIGHT, SECTION = 25.0, tube(1.2, 0.02)
SEA = Water(depth=20.0)


def scene(E=2.1e11, mass=12e3, push=0.0, method="time", **changes):
    """A pile in the water, with a mass and a level force on its top."""
    steel = Material(E=E, G=8e10, density=1e-3)
    pile = Member(name="pile", start="foot", end="top", elements=8, section=SECTION, material=steel, flooded=True)
    frame = Frame(
        nodes={"foot": (0.0, 0.0, -20.0), "top": (0.0, 0.0, HEIGHT - 20.0)},
        members=(replace(pile, inertia_coefficient=2.0),),
        clamped=("foot",),
        masses=(PointMass(node="top", mass=mass),),
        loads=(PointLoad(node="top", force=(push, 0.0, 0.0)),),
    )
    settings = Settings(duration=102.0, discard=50.0, ramp=20.0, method=method, froude_krylov="linear")
    platform = Platform(frame=frame, legs=("pile",), **changes)
    return Scene(water=SEA, sea=regular(height=0.5, period=6.0), floats=(), platform=platform, settings=settings)


def heaviest(E):
    """Mass whose weight is Euler's load of a cantilever, π²EI/4L² [kg], lightened by what it displaces."""
    return np.pi**2 * E * SECTION.Iy / (4 * HEIGHT**2) / 9.81


@pytest.mark.parametrize("method", ["time", "frequency"])
def test_a_frame_beyond_eulers_load_is_told_by_both_methods(method):
    """And not one that bears 2 % less: what the pile displaces lifts it a little."""
    heavy, light = (scene(mass=share * heaviest(2.1e11), method=method) for share in (1.02, 0.98))
    record = simulate(heavy)
    factor = record.attrs["buckling_factor"]
    assert factor == approx(1 / 1.02, rel=0.01)
    assert record.attrs["warnings"].startswith(
        f"platform: its buckling_factor is {factor:.3g}, so {factor:.3g} times its weight and constant loads buckle it;"
        " it stands here because without geometric_stiffness they do not soften it"
    )
    assert "buckling" not in simulate(light).attrs.get("warnings", "")


def test_a_pinned_strut_of_one_element_buckles_as_euler_has_it():
    """Of two that hold the pile's top the one that is pressed: it has no shape of its own to buckle in."""
    L, pinned, pipe = 20.0, ("My", "Mz"), tube(0.2, 0.008)
    whole = scene(mass=1e3, push=4e5)
    frame, steel = whole.platform.frame, whole.platform.frame.members[0].material
    struts = [
        Member(name=foot, start=foot, end="top", elements=1, section=pipe, material=steel,
               start_release=pinned, end_release=pinned)
        for foot in ("left", "right")
    ]  # fmt: skip
    nodes = frame.nodes | {"left": (-L, 0.0, HEIGHT - 20.0), "right": (L, 0.0, HEIGHT - 20.0)}
    held = replace(frame, nodes=nodes, members=(*frame.members, *struts), clamped=("foot", "left", "right"))
    factor = dynamic_model(held, 1025.0, 9.81, softened=False)[2]
    assert factor == approx(np.pi**2 * 2.1e11 * pipe.Iy / L**2 / 2e5, rel=0.02)
    with pytest.raises(InputError, match=r"gravity is 1\.7\d times the Euler load"):
        dynamic_model(held, 1025.0, 9.81, softened=True)


def test_what_softens_it_is_refused_and_not_told():
    heavy = scene(mass=1.02 * heaviest(2.1e11), geometric_stiffness=True)
    with pytest.raises(InputError, match=r"geometric_stiffness = True: gravity is 1\.\d+ times the Euler load"):
        warnings(heavy)
    assert warnings(scene(mass=0.9 * heaviest(2.1e11), geometric_stiffness=True)) == ()


@pytest.mark.parametrize("way", [1, -1])
def test_a_frame_bent_by_more_than_a_few_percent_is_told(way):
    """By PL³/3EI of a level force, to whichever side."""
    of_unit = HEIGHT**3 / (3 * 2.1e11 * SECTION.Iy)
    near, far = (scene(push=way * share * HEIGHT / of_unit) for share in (0.0299, 0.0301))
    assert warnings(near) == ()
    (text,) = warnings(far)
    assert text == (
        "platform: weight, buoyancy and constant loads move it by 0.753 m at (0, 0, 5), 0.03 of its size, 25 m, where"
        " displacements are taken for small: most likely a slip of units in stiffness, mass or load"
    )


def test_where_it_bends_most_is_named():
    """A beam across two posts sags amid, where no node has a name."""
    steel = Material(E=2.1e11, G=8e10, density=7850.0)
    nodes = {"a": (0, 0, -20), "b": (30, 0, -20), "c": (0, 0, 5), "d": (30, 0, 5)}
    thin, stiff = tube(0.08, 0.005), tube(1.0, 0.05)
    members = tuple(
        Member(name=x + y, start=x, end=y, elements=4, section=section, material=steel)
        for x, y, section in (("a", "c", stiff), ("c", "d", thin), ("b", "d", stiff))
    )
    frame = Frame(nodes=nodes, members=members, clamped=("a", "b"))
    (text,) = warnings(replace(scene(), sea=CALM, platform=Platform(frame=frame)))
    assert "at (15, 0, 5)" in text


def test_pascals_given_as_megapascals_are_told():
    told = warnings(scene(E=210e3))
    assert [text.split(" ")[1] for text in told] == [
        "its",
        "weight,",
        "E",
    ]  # the factor, the displacement, and the unit


def test_buan_buckles_under_its_deck_twice(buan):
    """CASES.md, section 1: its mean stress is met only with its deck's weight once more as a static load."""
    assert [text.partition(",")[0] for text in warnings(buan.scene())] == ["platform: its buckling_factor is 0.445"]
