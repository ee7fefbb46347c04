"""The Buan platform (heo-koo-kim-2022, Table 2 and CASES section 1) and a generic steel."""

import dataclasses

import pytest

from solver.structure.frame import Frame
from solver.structure.frame_model import assemble
from solver.structure.members import Material, Member, PointLoad, PointMass
from solver.structure.sections import solid_rectangle, tube

G_ACC = 9.81
DECK_WEIGHT = 980e3  # [N], a quarter on each leg top
TOP = 2.6  # leg height 52.6 m less depth 50 m


def buan_frame(ring, link):
    steel = Material(E=2.1e11, G=8.33e10, density=78.6e3 / G_ACC)
    corners = {"1": (-1.5, 1.2), "2": (-1.5, -1.2), "3": (1.5, 1.2), "4": (1.5, -1.2)}
    nodes = {f"foot{i}": (x, y, -50.0) for i, (x, y) in corners.items()}
    nodes |= {f"top{i}": (x, y, TOP) for i, (x, y) in corners.items()}
    nodes |= {"hinge1": (-1.5, 0.0, TOP), "hinge2": (1.5, 0.0, TOP)}
    leg = tube(diameter=0.45, thickness=0.012)
    water = {"drag_coefficient": 1.0, "inertia_coefficient": 2.0}
    legs = [
        Member(
            name=f"leg{i}",
            start=f"foot{i}",
            end=f"top{i}",
            elements=29,
            section=leg,
            material=steel,
            **water,
        )
        for i in corners
    ]
    sides = [("1", "2"), ("3", "4"), ("1", "3"), ("2", "4")]
    deck = [
        Member(
            name=f"ring{i}{j}",
            start=f"top{i}",
            end=f"top{j}",
            elements=1,
            section=ring,
            material=steel,
        )
        for i, j in sides
    ]
    deck += [
        Member(
            name=f"link{i}{j}",
            start=f"hinge{i}",
            end=f"top{j}",
            elements=1,
            section=link,
            material=steel,
        )
        for i, j in (("1", "1"), ("1", "2"), ("2", "3"), ("2", "4"))
    ]
    share = DECK_WEIGHT / 4
    return Frame(
        nodes=nodes,
        members=(*legs, *deck),
        clamped=tuple(f"foot{i}" for i in corners),
        masses=tuple(PointMass(node=f"top{i}", mass=share / G_ACC) for i in corners),
        loads=tuple(PointLoad(node=f"top{i}", force=(0.0, 0.0, -share)) for i in corners),
    )


@pytest.fixture(scope="session")
def platform():
    """Ring and links of one solid square, 0.641 m: 51.4 t over the 15.6 m of deck beams."""
    side = (51.4e3 / (78.6e3 / G_ACC) / 15.6) ** 0.5
    square = solid_rectangle(width=side, height=side)
    return assemble(buan_frame(ring=square, link=square))


@pytest.fixture(scope="session")
def steel():
    return Material(E=2.1e11, G=8.33e10, density=7850.0)


@pytest.fixture(scope="session")
def pipe():
    return tube(diameter=0.45, thickness=0.012)


@pytest.fixture(scope="session")
def line(steel, pipe):
    """A straight pipe of n elements from the clamped `start`; `clamped` may name both ends."""

    def build(
        n,
        start=(0.0, 0.0, 0.0),
        end=(12.0, 0.0, 0.0),
        clamped=("start",),
        section=pipe,
        material=steel,
        **fields,
    ):
        own = {key: fields.pop(key) for key in {f.name for f in dataclasses.fields(Member)} & fields.keys()}
        pile = Member(
            name="pile",
            start="start",
            end="end",
            elements=n,
            section=section,
            material=material,
            **own,
        )
        return assemble(Frame(nodes={"start": start, "end": end}, members=(pile,), clamped=clamped, **fields))

    return build
