"""Section forces and reactions of moving frames: balance, closed forms, and elements of any length."""

from dataclasses import replace
from types import SimpleNamespace as Namespace

import numpy as np
import pytest
from pytest import approx

from solver.coupled import forces, support, surroundings
from solver.coupled.blocks import blocks
from solver.coupled.forces import Part
from solver.coupled.places import Columns, Places
from solver.coupled.preparation import prepare
from solver.errors import InputError
from solver.record.steel import Steel
from solver.run import simulate
from solver.scene import Platform, Scene, Settings, Water
from solver.sea.field import WaveField
from solver.sea.realization import CALM, ramp, regular
from solver.structure import beam, in_water, recovery, statics, water
from solver.structure.frame import Frame
from solver.structure.influence import Wanted, influence
from solver.structure.members import Material, Member, PointLoad, PointMass
from solver.structure.sections import solid_rectangle, tube
from tests.awkward import on_piles, soft_ground, tripod, unequal_legs

EVERYTHING = ("reactions", "section_forces", "fibre_stress")
RHO, G = 1025.0, 9.81


PLATFORMS = pytest.mark.parametrize("made", [unequal_legs, soft_ground, on_piles])


RAYLEIGH = {"rayleigh_mass": 0.05, "rayleigh_stiffness": 0.02}


def marched(made, damping_ratio=0.05, rayleigh=None, **changes):
    """A float on three unequal legs in waves at 30 degrees: the system, its steel, a block of samples."""
    item, h = made()
    chosen = {"outputs": EVERYTHING, "time_step": 0.1, **changes}
    platform = replace(item.platform, damping_ratio=damping_ratio, **(rayleigh or {}))
    system = prepare(replace(item, platform=platform, settings=replace(item.settings, **chosen)), h)
    steel = Steel(system.support.forces, system.scene.settings)
    *_, (samples, output, times) = blocks(system, system.start(), 512)
    s = system.scene.settings
    turn = np.exp(-1j * np.outer(times, system.scene.sea.omega)) * ramp(times, s.ramp)[:, None]
    parts = output.dp, output.ddp, output.carried, output.drag
    y = steel.forces.of(samples[:, system.layout.forces], *parts)
    return system, steel, turn, output, y


@PLATFORMS
def test_reactions_balance_all_loads_and_inertia(made):
    """Forces and moments about the origin, each by integrals over the members and none by the frame's stiffness."""
    system, steel, turn, output, y = marched(made)
    sea, platform = system.scene.water, system.scene.platform
    model, _, _ = support.dynamic_model(platform, sea)
    M = model.M + water.added_mass(model, sea.density)
    drag, carried, ddp = output.drag, output.carried, output.ddp
    reactions = y[:, steel.places.columns.reactions]
    at = water.stations(model, water.EXACT, support.INERTIA / system.waves.k.max())
    acceleration = (system.waves.acceleration(at.position) @ turn.T).real  # (ns, 3, m)
    normal = np.eye(3) - at.tangent[:, :, None] * at.tangent[:, None, :]
    inertia = (at.inertia * sea.density * np.pi / 4 * at.diameter**2 * at.weight)[:, None, None] * (
        normal @ acceleration
    )
    total = about_origin(at.position, inertia.transpose(2, 0, 1))
    drags = water.stations(model, 2, support.DRAG * system.waves.mean_length)
    wet = drags.drag > 0
    total += about_origin(drags.position[wet], drag.transpose(0, 2, 1))
    hinge = model.xyz[model.node_index["hinge:float"]]
    total += np.concatenate([carried[:, :3], carried[:, 3:] + np.cross(hinge, carried[:, :3])], axis=1)
    rigid = rigid_motions(model.xyz)
    total -= ddp @ system.support.shapes.T @ (M @ rigid)
    feet = steel.places.foot
    total += about_origin(feet, reactions[..., :3])
    total[:, 3:] += reactions[..., 3:].sum(axis=1)
    scale = np.abs(about_origin(feet, reactions[..., :3])).max(axis=0)
    assert np.abs(total / scale).max() < 1e-9
    names = dict(steel.channels(y))
    assert names["base_shear"] == approx(-reactions[..., :3].sum(axis=1))
    moved = -(about_origin(feet - steel.point, reactions[..., :3])[:, 3:] + reactions[..., 3:].sum(axis=1))
    assert names["overturning_moment"] == approx(moved)


def about_origin(position, force):
    """(m, 6) force and moment about the origin of forces (m, ns, 3) at positions (ns, 3)."""
    return np.concatenate([force.sum(axis=1), np.cross(position, force).sum(axis=1)], axis=1)


def rigid_motions(xyz):
    """Displacements (6n, 6) of all nodes: three translations, three rotations about the origin."""
    out = np.zeros((len(xyz), 6, 6))
    out[:, :3, :3] = out[:, 3:, 3:] = np.eye(3)
    for i in range(3):
        out[:, :3, 3 + i] = np.cross(np.eye(3)[i], xyz)
    return out.reshape(-1, 6)


def test_springs_give_what_they_are_pushed_by():
    """-k u of the feet on foundations, static part by itself; and all reactions at rest carry all that weighs."""
    system, steel, _, output, y = marched(soft_ground, 0.0, modes="all", newton_tolerance=1e-9)
    platform, sea = system.scene.platform, system.scene.water
    model, at_rest, _ = support.dynamic_model(platform, sea)
    reactions, still = (x[:, steel.places.columns.reactions] for x in (y, steel.forces.at_rest[None]))
    moved = (output.p @ system.support.shapes.T).reshape(len(y), -1, 6)
    for node in ("foot a", "foot b"):
        k, foot = platform.frame.foundation_matrix(node), steel.places.grounded.index(node)
        at = model.node_index[node]
        force = -moved[:, at] @ k
        size = np.abs(reactions[:, foot, [0, 0, 0, 4, 4, 4]]).max(axis=0)
        assert np.all(np.abs(force - reactions[:, foot]).max(axis=0) < 1e-4 * size)
        assert still[0, foot] == approx(-k @ at_rest.reshape(-1, 6)[at], rel=1e-6)
    load = water.static_load(model, sea.density, sea.gravity).reshape(-1, 6)
    total = load.sum(axis=0)
    total[3:] += np.cross(model.xyz, load[:, :3]).sum(axis=0)
    feet = steel.places.foot
    held = np.concatenate(
        [still[0, :, :3].sum(axis=0), (still[0, :, 3:] + np.cross(feet, still[0, :, :3])).sum(axis=0)]
    )
    assert held == approx(-total, abs=1e-6 * np.abs(total).max())


@PLATFORMS
def test_tops_are_stressed_as_the_members_ends(made):
    """Fibres at the upper end of each leg, σ = N/A + My z/Iy - Mz y/Iz; one leg is given from its top downwards."""
    item, h = made()
    frame = item.platform.frame
    first = frame.members[0]
    ends = {
        f"{end}{what}": getattr(first, f"{other}{what}")
        for what in ("", "_offset", "_release", "_spring")
        for end, other in (("start", "end"), ("end", "start"))
    }
    frame = replace(frame, members=(replace(first, **ends), *frame.members[1:]))
    outputs = ("section_forces", "fibre_stress", "leg_tops", "member_stress")
    _, steel, *_, y = marched(lambda: (replace(item, platform=replace(item.platform, frame=frame)), h), outputs=outputs)
    names, places = dict(steel.channels(y)), steel.places
    for leg, name in enumerate(item.platform.legs):
        member = next(m for m in frame.members if m.name == name)
        foot, top = (1, 0) if name == first.name else (0, 1)
        force, moment = (names[key][:, places.members.index(name)] for key in ("section_force", "section_moment"))
        for key, end in (("fibre_stress", foot), ("fibre_stress_top", top)):
            section = member.section_at(end)
            y_, z = section.fibres.T
            bent = moment[:, end, 1, None] * z / section.Iy - moment[:, end, 2, None] * y_ / section.Iz
            exact = force[:, end, 0, None] / section.area + bent
            assert names[key][:, leg] == approx(exact, abs=1e-6)
            assert names["member_stress"][:, places.members.index(name), end] == approx(exact, abs=1e-6)
    assert np.abs(names["fibre_stress_top"]).max() > 1e5


@PLATFORMS
def test_two_elements_bear_the_same_where_they_meet(made):
    """So that a tube is looked at there once: of waves, drag and inertia the end of one is the next one's start."""
    system, steel, *_ = marched(made, outputs=("reactions",))
    model = steel.places.influence.model
    e = np.array(model.member_elements[system.scene.platform.frame.members[0].name])
    ends = np.ravel([2 * e[:-1] + 1, 2 * e[1:]])
    wanted = Wanted(end=np.repeat(ends, 6), component=np.tile(np.arange(6), ends.size), grounded=np.zeros(0, int))
    found = influence(model, wanted)
    at = water.stations(model, water.EXACT)
    M = model.M + water.added_mass(model, RHO)
    for effect in (found.of_points(at), found.of_inertia(M, RHO, system.support.shapes)):
        one, other = np.split(effect.reshape(-1, 2, len(e) - 1, 6), 2, axis=1)
        assert np.abs(one - other).max() <= 1e-9 * np.abs(effect).max()


def test_forces_of_few_are_the_forces_of_all():
    """Maps of rank 7 to 40 forces, of any units: kept are 7, and all 40 come out to rounding."""
    rng = np.random.default_rng(5)
    wanted = Wanted(end=np.zeros(28, int), component=np.repeat(np.arange(4), 7), grounded=np.repeat([2, 5], 6))
    mix = rng.normal(size=(7, 40)) * np.where(wanted.moments, 1e3, 1.0)
    units = {"waves": 1e2, "inertia": 1e4, "damping": 1e7, "carried": 1.0, "drag": 1e-3, "applied": 1.0}
    maps = {name: unit * rng.normal(size=(5, 7)) @ mix for name, unit in units.items()}
    columns = Columns.of(*[(0, 3)] * 5, (40,))
    bare = Namespace(model=Namespace(frame=Namespace(members=())))
    none = {
        "feet": None,
        "tops": None,
        "ends": None,
        "members": (),
        "checked": (),
        "grounded": (),
        "foot": np.zeros((0, 3)),
    }
    tubes = {"twin": np.zeros(0, int), "points": np.zeros(0, int)}
    places = Places(wanted=wanted, columns=columns, influence=bare, **none, **tubes)
    few = forces.reduced(places, np.arange(40.0), **maps)
    assert few.parts[0].spread.shape == (7, 33)
    for name, values in maps.items():
        found = few.whole(getattr(few, name))[:, few.places.columns.reactions]
        assert found == approx(values, abs=1e-12 * np.abs(values).max())
    assert few.at_rest[few.places.columns.reactions].tolist() == list(range(40))
    parts = {name: rng.normal(size=(9, 5)) / unit for name, unit in units.items()}
    motion = (parts[name] for name in ("damping", "inertia", "carried"))
    y = few.of(parts["waves"] @ few.waves, *motion, parts["drag"])
    expected = sum(part @ maps[name] for name, part in parts.items() if name != "applied")
    assert y[:, few.places.columns.reactions] == approx(expected, abs=1e-12 * np.abs(expected).max())


@PLATFORMS
def test_feet_bear_what_the_ground_gives(made):
    """A foot's section forces, turned to global axes, are the ground's reaction, but for damping within the frame."""
    for damping_ratio, within in ((0.0, 1e-9), (0.01, 0.04)):
        system, steel, _, _, y = marched(made, damping_ratio)
        model, _, _ = support.dynamic_model(system.scene.platform, system.scene.water)
        columns = steel.places.columns
        sections, reactions = y[:, columns.sections], y[:, columns.reactions]
        for name in (n for n in ("a", "b", "c") if f"foot {n}" in steel.places.grounded):
            row, foot = steel.places.members.index(name), steel.places.grounded.index("foot " + name)
            first = model.member_elements[name][0]
            turned = sections[:, row, 0].reshape(-1, 2, 3) @ model.rotation[first]
            arm = model.ends[first, 0] - model.xyz[model.elements[first, 0]]  # from the foot to the leg's start
            turned[:, 1] += np.cross(arm, turned[:, 0])
            gap = np.abs(turned.reshape(-1, 6) + reactions[:, foot]).max(axis=0)
            assert np.all(gap <= within * np.abs(reactions[:, foot, [0, 0, 0, 4, 4, 4]]).max(axis=0))


@pytest.mark.parametrize("rayleigh", [None, RAYLEIGH], ids=["ratio", "rayleigh"])
@PLATFORMS
def test_sections_bear_what_the_shapes_strain(made, rayleigh):
    """All ends of the legs: k d of all shapes, less what acts within the elements, inertia and damping included."""
    system, steel, turn, output, y = marched(made, rayleigh=rayleigh, modes="all", newton_tolerance=1e-9)
    model, _, _ = support.dynamic_model(system.scene.platform, system.scene.water)
    sections = y[:, steel.places.columns.sections]
    strained = (output.p @ (recovery.section_force_matrix(model) @ system.support.shapes).T).reshape(len(y), -1, 6)
    feet = 3 * len(steel.feet.axes)
    wanted = steel.places.wanted.end[feet::6]
    sections = sections.reshape(len(y), -1, 6)[:, :6]  # of the legs: the arm's is one with the hinge's load
    nodes_alone = strained[:, wanted][:, :6]
    within = within_elements(system, steel, turn, output)
    both = nodes_alone + within[:, feet : feet + 36].reshape(len(y), 6, 6)
    for kind in range(6):
        size = np.abs(sections[..., kind]).max()
        assert both[..., kind] == approx(sections[..., kind], abs=1e-4 * size), kind
    bending = np.abs(nodes_alone - sections)[..., 4].max()
    assert bending > 0.05 * np.abs(sections[..., 4]).max()  # which two elements a leg would be off without


@PLATFORMS
def test_what_damps_by_the_stiffness_is_borne_alike_by_few_shapes_and_by_all(made):
    """Static shapes strain the frame about the floats' hinges, where their inertia is not."""
    rayleigh = {"rayleigh_mass": 0.0, "rayleigh_stiffness": 0.02}
    few, every = (marched(made, 0.0, rayleigh, modes=modes) for modes in (3, "all"))
    stds = [
        y[:, steel.places.columns.sections].reshape(len(y), -1, 6).std(axis=0) for _, steel, _, _, y in (few, every)
    ]
    for kind in range(6):
        assert stds[0][:, kind] == approx(stds[1][:, kind], rel=5e-3, abs=2e-3 * stds[1][:, kind].max()), kind


def within_elements(system, steel, turn, output):
    """What acts inside the elements alone adds at their ends, (m, ny): consistent loads, reversed."""
    model, _, _ = support.dynamic_model(system.scene.platform, system.scene.water)
    places, density = steel.places, system.scene.water.density
    alone = replace(places.influence, nodal=np.zeros_like(places.influence.nodal))
    at = water.stations(model, water.EXACT, support.INERTIA / system.waves.k.max())
    size = surroundings.inertia_size(system.scene.platform, at, system.scene.water)
    loads = size[:, None, None] * -1j * system.scene.sea.omega * surroundings.normal_flow(at, system.waves)
    rows = np.tensordot(alone.of_points(at), loads, axes=([0, 1], [0, 1]))
    waves = (turn @ rows.T).real
    M = model.M + water.added_mass(model, density)
    moving = replace(steel.forces, inertia=alone.of_inertia(M, density, system.support.shapes))
    drags = water.stations(model, 2, support.DRAG * system.waves.mean_length)
    of_drag = support.forces.of_drag(
        replace(places, influence=alone), drags, drags.drag > 0, np.ones(3, bool), planar=False
    )
    beta, omega = system.scene.platform.rayleigh_stiffness, system.structure.omega[:, None]
    damping = (2 * system.structure.damping[:, None] * omega - beta * omega**2) * moving.inertia  # β strains, within
    none = np.zeros((len(steel.forces.carried), len(rows)))
    n, every = len(rows), slice(0, len(rows))
    all_kept = Part(every, every, slice(None), np.zeros((n, 0)), np.zeros(0, int), np.zeros((0, n)))
    alone_maps = replace(moving, damping=damping, carried=none, drag=of_drag, parts=(all_kept,), at_rest=np.zeros(n))
    return alone_maps.of(waves, output.dp, output.ddp, output.carried, output.drag)


def pile(elements, *, period=12.0, amplitude=3.0, stiffer=1e4, section=None, **settings):
    """A pile of 6 m through 30 m of water, as in the published check of Morison's load."""
    depth, D = 30.0, 6.0
    steel = Material(E=2.1e11 * stiffer, G=8.33e10 * stiffer, density=7850.0)
    member = Member(
        name="pile", start="foot", end="top", elements=elements, section=section or tube(D, 0.06), material=steel,
        drag_coefficient=1.0, inertia_coefficient=2.0,
    )  # fmt: skip
    frame = Frame(nodes={"foot": (0, 0, -depth), "top": (0, 0, 6.0)}, members=(member,), clamped=("foot",))
    water_ = Water(depth=depth, density=RHO)
    sea = regular(height=2 * amplitude, period=period)
    chosen = {"duration": 3 * period, "discard": 2 * period, "ramp": period, "time_step": period / 120} | settings
    return Scene(
        water=water_, sea=sea, platform=Platform(frame=frame, legs=("pile",)),
        settings=Settings(outputs=EVERYTHING, **chosen),
    )  # fmt: skip


@pytest.mark.parametrize("elements", [1, 2, 10])
def test_a_pile_bears_morisons_load(elements):
    """Largest shear and moment at the mudline: drag 205,475 N, inertia 1,343,264 N, together 2.18588e7 N m."""
    v = simulate(pile(elements, stations_per_element=8)).variables
    assert v["overturning_moment"][1][1, 0] == approx(2.18588e7, rel=2e-3)
    shear = v["base_shear"][1][0]
    # Both parts' sum over a period: F(t) = I sin + D |cos| cos.
    angle = np.linspace(0, 2 * np.pi, 2001)
    force = 1343264 * np.sin(angle) + 205475 * np.abs(np.cos(angle)) * np.cos(angle)
    assert shear[0] == approx(force.max(), rel=2e-3)
    assert shear[4] == approx(force[:-1].std(), rel=2e-3)
    section = tube(6.0, 0.06)
    weight = 36 * section.area * 7850 * G - 30 * section.area * RHO * G
    assert v["base_shear"][1][2, 2] == approx(-weight, rel=1e-9)
    bending = 2.18588e7 * 3.0 / section.Iy
    still = -weight / section.area
    worst = v["fibre_stress"][1][0]  # (fibre, statistic)
    assert worst[:, 0].max() == approx(still + bending, rel=2e-3)
    assert worst[:, 1].min() == approx(v["bottom_stress"][1][0, 1], rel=2e-3) == approx(still - bending, rel=2e-3)


@pytest.mark.parametrize(("elements", "within"), [(1, 1.5e-2), (2, 5e-3), (10, 1e-4)])
def test_long_elements_bear_what_short_ones_do(elements, within):
    """A slender pile that sways: few elements and 40, every force of the foot, the top and the pile's fibres."""
    scenes = [pile(n, stiffer=1.0, amplitude=1.0, period=7.0, section=tube(1.2, 0.03)) for n in (elements, 40)]
    coarse, fine = (simulate(s).variables for s in scenes)
    for name in ("base_shear", "overturning_moment", "fibre_stress", "section_moment", "bottom_stress"):
        a, b = coarse[name][1], fine[name][1]
        assert a == approx(b, abs=within * np.abs(b).max()), name
    shapes_alone = simulate(replace(scenes[0], settings=replace(scenes[0].settings, outputs=()))).variables
    assert shapes_alone["bottom_stress"][1] == approx(coarse["bottom_stress"][1], rel=1e-6)


@pytest.mark.parametrize("splayed", [pytest.param(1.0, marks=pytest.mark.slow), 5.0])
def test_a_planar_scene_bears_what_it_does_in_space(buan, splayed):
    """Buan's legs in waves along x: half of the stations stand for all; turned by a hair, none are left out."""
    settings = {"outputs": EVERYTHING, "time_step": 0.2, "duration": 40.0, "discard": 10.0, "ramp": 5.0, "modes": "all"}
    sea = buan.sea(Hs=1.0)
    frame = buan.frame()
    nodes = {name: (x, splayed * y if "foot" in name else y, z) for name, (x, y, z) in frame.nodes.items()}
    settings["platform"] = buan.platform(frame=replace(frame, nodes=nodes))
    planar = simulate(buan.scene("elastic-no-floats", sea=sea, **settings)).variables
    turned = replace(sea, heading=1e-9)
    space = simulate(buan.scene("elastic-no-floats", sea=turned, **settings)).variables
    for name in ("reaction_force", "reaction_moment", "base_shear", "section_moment", "fibre_stress", "bottom_stress"):
        a, b = planar[name][1], space[name][1]
        assert a == approx(b, abs=1e-5 * np.abs(b[..., 4]).max() + 1e-8 * np.abs(b).max()), name


def test_fibres_of_a_rectangle_have_its_own_sides():
    """Corners of a beam bent both ways: ± My h/2Iy ± Mz b/2Iz, not half a diagonal."""
    section = solid_rectangle(0.8, 0.2)
    assert section.fibres == approx(np.array([[0.4, 0.1], [-0.4, 0.1], [-0.4, -0.1], [0.4, -0.1]]))
    steel = Material(E=2.1e11, G=8.33e10, density=7850.0)
    member = Member(name="post", start="foot", end="top", elements=2, section=section, material=steel)
    masses = (PointMass(node="top", mass=1e3),)
    nodes = {"foot": (0, 0, -10.0), "top": (2.0, 1.0, 2.0)}
    push = (3e3, -5e3, 0.0)
    loads = (PointLoad(node="top", force=push),)
    frame = Frame(nodes=nodes, members=(member,), clamped=("foot",), masses=masses, loads=loads)
    still = Scene(
        water=Water(depth=10.0), platform=Platform(frame=frame, legs=("post",)), sea=replace(CALM, heading=0.5),
        settings=Settings(duration=1.0, discard=0.0, outputs=EVERYTHING, time_step=0.1),
    )  # fmt: skip
    v = simulate(still).variables
    L = np.linalg.norm(np.subtract(nodes["top"], nodes["foot"]))
    model = support.dynamic_model(still.platform, still.water)[0]
    R, q = model.rotation[0], 7850 * section.area * G
    # Moment of the weights about the foot, in the member's axes; buoyancy of the wet ten twelfths.
    up = RHO * G * section.area
    arm = np.subtract(nodes["top"], nodes["foot"])
    share = 10 / 12
    moment = np.cross(arm, [0, 0, -1e3 * G]) + np.cross(arm / 2, [0, 0, -q * L])
    moment += np.cross(arm, push)
    moment += np.cross(arm * share / 2, [0, 0, up * L * share])
    force = R @ np.add([0, 0, -1e3 * G - q * L + up * L * share], push)
    local = R @ moment
    y, z = section.fibres.T
    expected = force[0] / section.area + local[1] * z / section.Iy - local[2] * y / section.Iz
    assert v["fibre_stress"][1][0, :, 2] == approx(expected, rel=1e-9)
    assert v["fibre_place"][1][0] == approx(section.fibres @ R[1:], abs=1e-12)
    assert v["section_force"][1][0, 0, 0, 2] == approx(force[0], rel=1e-9)


def test_sections_without_legs_and_fibres_with_none():
    scene = pile(2)
    bare = replace(scene.platform, legs=())
    with pytest.raises(InputError, match=r"settings\.outputs = fibre_stress: is of the feet of legs"):
        replace(scene, platform=bare)
    alone = replace(scene, platform=bare, settings=replace(scene.settings, outputs=("reactions",)))
    assert "pile_force" not in simulate(alone).variables
    with pytest.raises(InputError, match="must be one of reactions"):
        replace(scene, settings=replace(scene.settings, outputs=("tears",)))


def test_softened_frames_balance_their_softened_stiffness():
    """With geometric stiffness a foot bears what K + Kg strains: the moment of the weight that has swayed aside."""
    platform = replace(tripod(4), geometric_stiffness=True, hinge_nodes={})
    model, at_rest, _ = support.dynamic_model(platform, Water(depth=25.0))
    field = WaveField(regular(height=1.0, period=6.0), 25.0, G)
    options = {"planar": False, "modes": 6, "stations": 2, "outputs": ("reactions", "section_forces")}
    s = support.reduce_platform(platform, field, Water(depth=25.0), (), **options)
    influence = s.forces.places.influence
    load = np.random.default_rng(0).normal(size=model.K.shape[0])
    load[model.dofs[0]] *= 0
    d = statics.static(model, load)
    given = support._places(platform, Water(depth=25.0), options["outputs"]).columns  # as the influence has them
    y = (influence.nodal.T @ load)[None]
    sections, reactions = y[:, given.sections], y[:, given.reactions]
    assert reactions.ravel() == approx(
        model.K[s.forces.places.wanted.grounded] @ d - load[s.forces.places.wanted.grounded]
    )
    e = model.member_elements["b"][-1]
    k = model.element_stiffness[e] + model.element_geometric[e]
    end = (k @ beam.to_global(model.rotation[e]) @ d[model.dofs[e]])[6:]
    assert sections[0, s.forces.places.members.index("b"), 1] == approx(end)
    assert at_rest.shape == d.shape


def test_softened_feet_on_springs_give_what_the_springs_do():
    """-k u, with a heavy mass high above the foot's node and a rigid offset at it, whose levers lean with the foot."""
    steel = Material(E=2.1e11, G=8.33e10, density=7850.0)
    leg = Member(
        name="leg", start="foot", end="top", elements=4, section=tube(0.5, 0.02), material=steel,
        start_offset=(1.0, 0.0, 2.0),
    )  # fmt: skip
    frame = Frame(
        nodes={"foot": (0, 0, 5.0), "top": (0, 0, 25.0)}, members=(leg,),
        masses=(PointMass(node="top", mass=7e4), PointMass(node="foot", mass=5e5, cog=(0, 0, 4.0))),
        loads=(PointLoad(node="top", force=(2e4, 0.0, 0.0)),), foundation={"foot": (5e7, 5e7, 3e8, 4e8, 4e8, 1e8)},
    )  # fmt: skip
    model, d, _ = in_water.dynamic_model(frame, 1025.0, G, softened=True)
    feet = 6 * model.node_index["foot"] + np.arange(6)
    wanted, load = (
        Wanted(end=np.zeros(0, int), component=np.zeros(0, int), grounded=feet),
        water.static_load(model, 1025.0, G),
    )
    by_influence = influence(model, wanted)
    at_rest = by_influence.at_rest(wanted, d, load, water.spread_load(model, 1025.0, G))
    assert at_rest == approx(-model.ground[feet] @ d)
    assert at_rest == approx(by_influence.nodal.T @ load, abs=1e-6 * np.abs(at_rest).max())
