"""Members in soil against closed forms, published coefficients and invariances."""

from dataclasses import replace

import numpy as np
import pytest
from pytest import approx

from solver.errors import InputError
from solver.scene import Platform, Scene, Water
from solver.structure import recovery, statics, water
from solver.structure.frame import Frame
from solver.structure.frame_model import assemble
from solver.structure.members import Member, PointLoad
from solver.structure.sections import tube
from solver.structure.soil import Soil, SoilSpring

SEABED, H, M = -20.0, 3e5, 8e5
PILE = tube(1.0, 0.03)


def pile(steel, n, springs, *, length=60.0, load=(H, 0.0, 0.0), top=SEABED, **fields):
    """A pile whose head is at the seabed, in n elements, without its weight."""
    chosen = {"section": PILE, "elements": n, **fields}
    member = Member(name="pile", start="foot", end="head", material=replace(steel, density=1e-6), **chosen)
    nodes = {"foot": (0, 0, top - length), "head": (0, 0, top)}
    loads = (PointLoad(node="head", force=load),)
    return assemble(Frame(nodes=nodes, members=(member,), loads=loads, soil=Soil(seabed=SEABED, springs=springs)))


def even(k, axial=1e5, torsional=1e5):
    return (SoilSpring(depth=0.0, lateral=k, axial=axial, torsional=torsional),)


def bent(model):
    return statics.static(model, statics.point_load(model))


def test_a_long_pile_in_even_soil_bends_as_hetenyi_has_it_to_fourth_order(steel):
    """y = 2Hβ/k and θ = 2Hβ²/k at its head, β = (k/4EI)^¼; most moment 0.3224 H/β, at π/4β."""
    k = 2e7
    beta = (k / (4 * steel.E * PILE.Iy)) ** 0.25
    errors = []
    for n in (40, 80):
        model = pile(steel, n, even(k))
        d = bent(model).reshape(-1, 6)
        head = d[model.node_index["head"]]
        errors.append(np.abs(np.array([head[0] * k / (2 * H * beta), head[4] * k / (2 * H * beta**2)]) - 1))
    assert np.log2(errors[0] / errors[1]) == approx(4, abs=0.1)
    assert errors[1].max() < 5e-6
    moment = recovery.section_forces(model, d.ravel(), np.zeros((80, 12)))[1::2, 4]
    z = model.xyz[model.elements[:, 1], 2] - SEABED
    assert np.interp(-np.pi / (4 * beta), z, np.abs(moment)) == approx(0.3224 * H / beta, rel=5e-3)


def test_a_long_pile_in_soil_that_stiffens_with_depth_is_matlock_and_reeses(steel):
    """k = n z: y = 2.435 H T³/EI at the head and most moment 0.772 H T, T = (EI/n)^⅕ (Matlock and Reese, 1960)."""
    n = 5e6
    springs = (SoilSpring(depth=0.0, lateral=0.0, axial=1e5, torsional=1e5), SoilSpring(depth=60.0, lateral=60.0 * n))
    model = pile(steel, 120, springs)
    d, T = bent(model), (steel.E * PILE.Iy / n) ** 0.2
    assert d[model.translations("head")][0] == approx(2.435 * H * T**3 / (steel.E * PILE.Iy), rel=3e-3)
    moment = np.abs(recovery.section_forces(model, d, np.zeros((120, 12)))[:, 4]).max()
    assert moment == approx(0.772 * H * T, rel=1e-3)


@pytest.mark.parametrize("kind", ["axial", "torsional"])
def test_a_pile_that_is_pulled_or_twisted_hangs_on_its_sides(steel, kind):
    """u = P/(λ EA tanh λL) at the head, λ = (k/EA)^½; twisted by GJ."""
    k, L, P = 4e7, 30.0, 1e6
    stiffness, direction = (steel.E * PILE.area, 2) if kind == "axial" else (steel.G * PILE.J, 5)
    springs = (SoilSpring(**{"depth": 0.0, "lateral": 1e7, "axial": 1e5, "torsional": 1e5, kind: k}),)
    rate = np.sqrt(k / stiffness)
    exact = P / (rate * stiffness * np.tanh(rate * L))
    errors = []
    for n in (20, 40):
        model = pile(steel, n, springs, length=L)
        load = np.zeros(6 * len(model.xyz))
        load[6 * model.node_index["head"] + direction] = P
        errors.append(abs(statics.static(model, load)[6 * model.node_index["head"] + direction] / exact - 1))
    assert np.log2(errors[0] / errors[1]) == approx(2, abs=0.05)
    assert errors[1] < 1e-3


def test_soil_holds_a_leaning_member_across_and_along_it_wherever_elements_end(steel):
    """A stiff member, half in soil of two layers: its springs about its own axes, and no more; one element or seven."""
    stiff = replace(steel, E=1e18, G=1e18)
    springs = (
        SoilSpring(depth=0.0, lateral=2e6, axial=3e5, torsional=4e6),
        SoilSpring(depth=3.0, lateral=2e6, axial=3e5, torsional=4e6),
        SoilSpring(depth=3.0, lateral=5e6, axial=1e6, torsional=4e6),
    )
    foot, head = np.array([3.0, -2.0, SEABED - 8.0]), np.array([0.0, 0.0, SEABED + 4.0])
    L, axis = np.linalg.norm(head - foot), (head - foot) / np.linalg.norm(head - foot)
    x = foot + (head - foot) * (np.arange(48_000)[:, None] + 0.5) / 48_000
    below = SEABED - x[:, 2]
    across, along = np.where(below < 3, 2e6, 5e6) * (below > 0), np.where(below < 3, 3e5, 1e6) * (below > 0)
    along_axis = np.outer(axis, axis)
    stiffness = (across.sum() * (np.eye(3) - along_axis) + along.sum() * along_axis) * L / 48_000
    for n in (1, 7):
        member = Member(name="m", start="foot", end="head", elements=n, section=PILE, material=stiff)
        frame = Frame(
            nodes={"foot": tuple(foot), "head": tuple(head)},
            members=(member,),
            soil=Soil(seabed=SEABED, springs=springs),
        )
        model = assemble(frame)
        rows, place = model.soil_reaction(member)
        moved = np.tile([1e-3, 2e-3, -3e-3, 0, 0, 0], len(model.xyz))
        assert place == approx(head - (head - foot) / 3)
        assert rows[:3] @ moved == approx(-stiffness @ moved[:3], rel=1e-6)
        arm = x - place
        pressed = -(across[:, None] * moved[:3] + (along - across)[:, None] * (axis @ moved[:3]) * axis) * L / 48_000
        assert rows[3:] @ moved == approx(np.cross(arm, pressed).sum(axis=0), rel=1e-5)
        twist = np.concatenate([np.concatenate([np.cross(axis, p - place), axis]) for p in model.xyz])
        assert rows[3:] @ twist == approx(-4e6 * L * 2 / 3 * axis, rel=1e-6)


def test_water_ends_where_soil_begins(line):
    """Added mass, inner water and drag of a pile through the seabed are those of its part above; buoyancy is not."""
    wet = {"drag_coefficient": 1.0, "inertia_coefficient": 2.0, "flooded": True, "clamped": ("start",)}
    through = line(7, start=(0, 0, -30.0), end=(0, 0, 5.0), soil=Soil(seabed=-20.0, springs=even(1e7)), **wet)
    above = line(5, start=(0, 0, -20.0), end=(0, 0, 5.0), **wet)
    for of in (lambda m: water.added_mass(m, 1e3), lambda m: water.inner_mass(m, 1e3), water.drag_matrix):
        assert of(through)[::6, ::6].sum() == approx(of(above)[::6, ::6].sum())
    assert water.stations(through, 2).position[:, 2].min() > -20.0
    assert water.buoyancy_load(through, 1e3, 10.0).sum() == approx(1.5 * water.buoyancy_load(above, 1e3, 10.0).sum())
    whole = line(5, start=(0, 0, -20.0), end=(0, 0, 5.0), soil=Soil(seabed=-19.999, springs=even(1e7)), **wet)
    assert len(water.stations(whole, 2).position) == len(water.stations(above, 2).position)


def test_what_soil_does_not_hold_is_refused(steel):
    with pytest.raises(InputError, match="soil = pile: must hold what stands on it, which is free to turn about z"):
        pile(steel, 2, even(1e7, torsional=0.0))
    with pytest.raises(InputError, match="soil = pile: must hold what stands on it, which is free to move along z"):
        pile(steel, 2, even(1e7, axial=0.0))
    with pytest.raises(InputError, match=r"soil = below z = -20 m: must meet a member: none is as deep"):
        pile(steel, 2, even(1e7), top=SEABED + 60.0)
    with pytest.raises(InputError, match=r"soil\[1\]\.depth = 1.0: must be >= 2 m, the depth of the line before"):
        Soil(seabed=SEABED, springs=(SoilSpring(depth=2.0, lateral=1.0), SoilSpring(depth=1.0, lateral=1.0)))
    with pytest.raises(InputError, match="soil = at z = -inf m: needs water of a finite depth"):
        Soil(seabed=-np.inf, springs=even(1e7))
    frame = pile(steel, 2, even(1e7)).frame
    with pytest.raises(InputError, match=r"platform\.soil\.seabed = -20.0: must be that of the water, -25 m"):
        Scene(water=Water(depth=25.0), floats=(), platform=Platform(frame=frame, legs=(), hinge_nodes={}))
