"""What of a frame looks as of other units is told with the scene's other oddities."""

from dataclasses import replace

import numpy as np
import pytest

from solver.errors import InputError
from solver.oddities import warnings
from solver.sea.current import Current
from solver.sea.realization import CALM
from solver.structure.frame import Frame
from solver.structure.in_water import unloaded
from solver.structure.load_history import LoadHistory
from solver.structure.members import MarineGrowth, Member, PointLoad
from solver.structure.sections import general, tube
from solver.structure.soil import Soil, SoilSpring
from tests.awkward import bare_legs


def told(word, **frame):
    """Sentences with a word of bare legs, their frame with other parts."""
    item, _ = bare_legs()
    platform = replace(item.platform, frame=replace(item.platform.frame, **frame))
    return [text for text in warnings(replace(item, platform=platform)) if word in text]


def made_of(**changes):
    members = bare_legs()[0].platform.frame.members
    return tuple(replace(m, material=replace(m.material, **changes)) for m in members)


@pytest.mark.parametrize(
    ("changes", "word"),
    [
        ({"G": 8e7}, "Poisson's ratio E/2G - 1 = 1.31e+03, and materials have -0.1 to 0.5"),
        ({"G": 6.9e10}, "Poisson's ratio"),  # 0.52
        ({"G": 1.2e11}, "Poisson's ratio"),  # -0.13
        ({"E": 210.0}, "E = 210 Pa is of no material"),
        ({"E": 9e7, "G": 3e7}, "E = 9e+07 Pa is of no material"),
        ({"E": 2e13, "G": 8e12}, "E = 2e+13 Pa is of no material"),
        ({"yield_strength": 355.0}, "yield_strength = 355 Pa is of no material, 1e+06 to 3e+09 Pa: is it in MPa?"),
        ({"yield_strength": 3.1e9}, "yield_strength = 3.1e+09 Pa"),
    ],
)
def test_a_material_in_other_units_is_told_once(changes, word):
    (text,) = told("platform.materials", members=made_of(**changes))
    assert text.startswith("platform.materials: ") and word in text


@pytest.mark.parametrize(
    "changes", [{}, {"G": 1.05e11}, {"E": 1.1e10, "G": 4.4e9}, {"E": 9e12, "G": 4e12}, {"yield_strength": 355e6}]
)
def test_materials_that_there_are_are_not_told(changes):
    assert not told("platform.materials", members=made_of(**changes))


@pytest.mark.parametrize(
    ("thickness", "depths", "at"), [(80.0, (0.0, 10.0), 80.0), (0.08, (0.0, 10.0), 0.0), (80.0, (24.0, 30.0), 80.0)]
)
def test_growth_in_millimetres_is_told(thickness, depths, at):
    """Of tubes half a metre wide, of what is in water."""
    growth = tuple(MarineGrowth(depth=depth, thickness=thickness, density=1300.0) for depth in depths)
    texts = told("platform.marine_growth", growth=growth)
    assert [f"{at:g} m all round" in text for text in texts] == [True] * (at > 0)


def test_growth_deeper_than_a_frame_is_none_of_it():
    thin = MarineGrowth(depth=0.0, thickness=0.05, density=1300.0)
    growth = (thin, replace(thin, depth=26.0), replace(thin, depth=30.0, thickness=90.0))
    assert not told("platform.marine_growth", growth=growth)


@pytest.mark.parametrize("clamped", [True, False])
def test_a_load_on_a_foot_is_told(clamped):
    item, _ = bare_legs()
    frame = item.platform.frame
    node = frame.clamped[0] if clamped else next(name for name in frame.nodes if name not in frame.clamped)
    history = LoadHistory(node=node, time=np.array([0.0, 250.0]), force=np.ones((2, 3)))
    loaded = replace(item, platform=replace(item.platform, load_histories=(history, history)))
    texts = [text for text in warnings(loaded) if text.startswith(f"platform.load_histories: {node} is clamped")]
    assert len(texts) == clamped


@pytest.mark.parametrize("clamped", [True, False])
def test_a_constant_load_on_a_foot_is_told(clamped):
    frame = bare_legs()[0].platform.frame
    node = frame.clamped[0] if clamped else "deck"
    assert len(told("platform.loads", loads=(PointLoad(node=node, force=(1e6, 0.0, 0.0)),))) == clamped


def test_a_member_in_another_is_told():
    first, *others = bare_legs()[0].platform.frame.members
    again = replace(first, name="again", start=first.end, end=first.start)
    assert len(told("platform.members.again: lies in a,", members=(first, *others, again))) == 1
    beside = replace(again, start_offset=(0.0, 0.5, 0.0))
    assert not told("platform.members.again", members=(first, *others, beside))


@pytest.mark.parametrize(
    ("bare", "current", "sentence"),
    [
        ((), True, None),
        (("a",), False, "platform.members.a: in water without"),
        (("a", "b", "c"), False, "platform.members.a and 2 more: all that is in water is without"),
    ],
)
def test_members_that_no_wave_loads_are_told(bare, current, sentence):
    """Of what is in water; an arm above it is none of them, and in still water nothing is missed."""
    item, _ = bare_legs()
    none = {"drag_coefficient": 0.0, "inertia_coefficient": 1.0}
    frame = item.platform.frame
    members = tuple(replace(m, **none) if m.name in bare else m for m in frame.members)
    members = tuple(replace(m, section=tube(0.4, 0.02)) if m.name == "arm" else m for m in members)
    item = replace(
        item,
        platform=replace(item.platform, frame=replace(frame, members=members)),
        current=Current(speed=1.0) if current else None,
    )
    texts = [text for text in warnings(item) if "pass through it" in text or text.startswith("current:")]
    assert [text.startswith(sentence) for text in texts] == [True] if sentence else not texts
    assert not [text for text in warnings(replace(item, sea=CALM, current=None)) if "pass through it" in text]


@pytest.mark.parametrize(("loaded", "sentences"), [("leg", []), ("pile", ["current: no member in water"])])
def test_a_pile_in_the_soil_is_no_member_in_water(loaded, sentences):
    """Nothing is missed of one without coefficients, and those of one load nothing."""
    shared = {"section": tube(1.5, 0.03), "material": made_of()[0].material, "elements": 1}
    pile, leg = (
        Member(name=name, start=start, end=end, drag_coefficient=float(name == loaded), **shared)
        for name, start, end in (("pile", "tip", "bed"), ("leg", "bed", "top"))
    )
    frame = Frame(
        nodes={"tip": (0.0, 0.0, -45.0), "bed": (0.0, 0.0, -20.0), "top": (0.0, 0.0, 8.0)},
        members=(pile, replace(leg, inertia_coefficient=2.0)),
        foundation={"tip": (0.0, 0.0, 1e8, 0.0, 0.0, 1e8)},
        soil=Soil(seabed=-20.0, springs=(SoilSpring(depth=0.0, lateral=2e7),)),
    )
    assert [text[:27] for text in unloaded(frame, waves=True, current=True)] == sentences


def test_a_current_that_nothing_drags_on_is_told():
    item, _ = bare_legs()
    frame = item.platform.frame
    smooth = tuple(replace(m, drag_coefficient=0.0) for m in frame.members)
    item = replace(item, platform=replace(item.platform, frame=replace(frame, members=smooth)))
    told = [
        any(text.startswith("current: no member") for text in warnings(replace(item, current=current)))
        for current in (None, Current(speed=1.0))
    ]
    assert told == [False, True]


@pytest.mark.parametrize(("area", "refused"), [(0.19, False), (0.2, True)])
@pytest.mark.parametrize("flooded", [True, False])
def test_a_section_larger_than_the_tube_that_holds_water_is_refused(area, refused, flooded):
    """π/4 0.5² is 0.1963 m2; of what is neither flooded nor sealed the diameter is for drag alone."""
    leg = bare_legs()[0].platform.frame.members[0]
    large = general(area, 2e-3, 2e-3, 2e-3, ((0.25, 0.0),), 0.02, diameter=0.5)
    assert replace(leg, section=large, flooded=None)
    if not refused:
        assert replace(leg, section=large, flooded=flooded).section.hollow > 0
        return
    with pytest.raises(InputError, match=r"section\.area = 0\.2: must be <= 0\.1963 m2"):
        replace(leg, section=large, flooded=flooded)
