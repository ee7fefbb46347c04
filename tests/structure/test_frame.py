"""Inputs refused with their reason; assembly counts, order and total mass."""

import numpy as np
import pytest

from solver.errors import InputError
from solver.structure.frame import Frame
from solver.structure.frame_model import assemble
from solver.structure.members import Material, Member, PointLoad, PointMass
from solver.structure.modes import modes
from solver.structure.sections import solid_rectangle

NODES = {"foot": (0, 0, -9), "knee": (0, 0, 0), "hand": (4, 0, 0)}
ROWS = np.eye(6)
CROSS = np.outer(np.eye(6)[0], np.eye(6)[4]) + np.outer(np.eye(6)[4], np.eye(6)[0])
SLIDES, SPINS = (0.0, 1e6, 1e6, 1e8, 1e8, 1e8), (1e6, 1e6, 1e6, 0.0, 0.0, 0.0)


@pytest.fixture
def member(steel, pipe):
    def build(name, start, end, elements=3, **fields):
        return Member(
            name=name,
            start=start,
            end=end,
            elements=elements,
            **{"section": pipe, "material": steel} | fields,
        )

    return build


@pytest.fixture
def bent(member):
    def build(**fields):
        members = (member("leg", "foot", "knee"), member("arm", "knee", "hand", 2))
        return Frame(**{"nodes": NODES, "members": members, "clamped": ("foot",)} | fields)

    return build


def test_members_share_named_nodes_and_make_their_own_between(bent):
    model = assemble(bent())
    assert model.xyz.shape == (3 + 2 + 1, 3)
    assert model.elements.shape == (5, 2)
    assert len(model.free) == 6 * 5
    assert list(model.member) == [0, 0, 0, 1, 1]
    assert model.member_elements["arm"] == range(3, 5)
    assert model.xyz[model.member_nodes["leg"], 2] == pytest.approx([-9, -6, -3, 0])
    assert model.member_nodes["leg"][-1] == model.member_nodes["arm"][0] == model.node_index["knee"]
    assert (
        model.elements[3:].tolist()
        == np.column_stack([model.member_nodes["arm"][:-1], model.member_nodes["arm"][1:]]).tolist()
    )


def test_matrices_are_symmetric_and_carry_the_whole_mass(bent, pipe, steel):
    model = assemble(bent(masses=(PointMass(node="hand", mass=500.0), PointMass(node="hand", mass=20.0))))
    assert abs(model.K - model.K.T).max() <= 1e-15 * abs(model.K).max()
    assert abs(model.M - model.M.T).max() <= 1e-15 * abs(model.M).max()
    for axis in range(3):
        shift = np.tile(np.eye(6)[axis], len(model.xyz))
        assert shift @ model.M @ shift == pytest.approx(520 + steel.density * pipe.area * 13)


def test_moment_of_inertia_about_the_foot_is_that_of_rods_and_point(bent, pipe, steel):
    model = assemble(bent(masses=(PointMass(node="hand", mass=500.0),)))
    arm = model.xyz - NODES["foot"]
    turn = np.hstack([np.cross([0, 1, 0], arm), np.tile([0, 1, 0], (len(arm), 1))]).ravel()
    line = steel.density * pipe.area
    rods = line * 9**3 / 3 + line * (4**3 / 3 + 4 * 9**2)
    assert turn @ model.M @ turn == pytest.approx(rods + 500 * (9**2 + 4**2))


def test_a_rigid_body_on_a_node_has_its_own_inertia_and_steiners(bent):
    """About the foot and about axes through it: J + m(r²I - r rᵀ), products of inertia included."""
    body = PointMass(
        node="hand", mass=500.0, cog=(0.5, -0.7, 1.1), inertia=(900.0, 800.0, 700.0),
        products_of_inertia=(50.0, -60.0, 70.0),
    )  # fmt: skip
    bare, loaded = assemble(bent()), assemble(bent(masses=(body,)))
    arm = loaded.xyz - NODES["foot"]
    turns = [np.hstack([np.cross(axis, arm), np.tile(axis, (len(arm), 1))]).ravel() for axis in np.eye(3)]
    shifts = [np.tile(np.concatenate([axis, np.zeros(3)]), len(arm)) for axis in np.eye(3)]
    rigid = np.array(shifts + turns)
    added = rigid @ (loaded.M - bare.M) @ rigid.T
    r = np.add(NODES["hand"], body.cog) - NODES["foot"]
    J = np.array([[900.0, -50.0, 60.0], [-50.0, 800.0, -70.0], [60.0, -70.0, 700.0]])
    assert added[:3, :3] == pytest.approx(500 * np.eye(3))
    assert added[3:, 3:] == pytest.approx(J + 500 * (r @ r * np.eye(3) - np.outer(r, r)))
    momentum = 500 * np.cross(np.eye(3), r)  # of a turn about each axis
    assert added[3:, :3] == pytest.approx(momentum)


def test_order_of_members_does_not_matter(bent):
    frame = bent()
    turned = bent(members=frame.members[::-1])
    a, b = assemble(frame), assemble(turned)
    assert np.sort(a.K.diagonal()) == pytest.approx(np.sort(b.K.diagonal()))


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"clamped": ("toe",)}, r"clamped\[0\] = toe: must be one of foot, knee, hand"),
        ({"clamped": ()}, r"clamped = \[\]: needs at least one node"),
        ({"clamped": ("foot", "foot")}, r"clamped = foot: given 2 times"),
        ({"members": ()}, r"members = \[\]: needs at least one member"),
        ({"masses": (PointMass(node="toe", mass=1),)}, r"masses\[0\].node = toe: must be one of"),
        ({"loads": (PointLoad(node="toe", force=(0, 0, 1)),)}, r"loads\[0\].node = toe: must be one of"),
        ({"nodes": NODES | {"hand": (0, 0, 0)}}, r"nodes.hand = .*: must not coincide with knee"),
        ({"nodes": NODES | {"hand": (0, 0)}}, r"nodes.hand = .*: must be three finite"),
        (
            {"nodes": NODES | {"hand": (0, 0, float("nan"))}},
            r"nodes.hand = .*: must be three finite",
        ),
        ({"nodes": NODES | {"far": (9, 9, 9)}}, r"nodes = far: must be joined to a clamped node"),
        ({"foundation": {"toe": (1.0,) * 6}}, r"foundation.toe = toe: must be one of"),
        ({"foundation": {"foot": (1.0,) * 6}}, r"foundation.foot = .*: is clamped, too"),
        ({"foundation": {"hand": (1.0,) * 5}}, r"foundation.hand = .*: must be six finite stiffnesses"),
        (
            {"foundation": {"hand": (1.0, 1.0, float("inf"), 1.0, 1.0, 1.0)}},
            r"foundation.hand = .*: must be six finite",
        ),
        ({"foundation": {"hand": (1.0, 1.0, 1.0, 1.0, -1.0, 1.0)}}, r"foundation.hand = .*: must not have a negative"),
        (
            {"foundation": {"hand": ROWS + np.eye(6)[[1]].T @ np.eye(6)[[3]]}},
            r"foundation.hand = 6 x 6: must be symmetric: row 2 has 1 in column 4, row 4 0 in column 2",
        ),
        ({"foundation": {"hand": ROWS + 2 * CROSS}}, r"foundation.hand = 6 x 6: must not have a negative"),
        ({"foundation": {"hand": np.ones((6, 5))}}, r"foundation.hand = 6 x 5: must be six finite stiffnesses"),
        (
            {"foundation": {"hand": np.diag([1.0, 1, 1, 1, 0, 1]) + CROSS}},
            r"(?s)foundation.hand = .*: must not have a neg",
        ),
        ({"clamped": (), "foundation": {"foot": SLIDES}}, r"foundation = foot: .* free to move along x"),
        (
            {"clamped": (), "foundation": {"foot": SPINS, "knee": SPINS}},
            r"foundation = foot, knee: .* free to turn about z",
        ),
        ({"foundation": {"far": (1.0,) * 6}, "nodes": NODES | {"far": (9, 9, 9)}}, r"nodes = far: must be joined"),
    ],
)
def test_bad_frames_are_refused(bent, change, message):
    with pytest.raises(InputError, match=message):
        bent(**change)


def test_feet_that_hold_together_are_enough(bent):
    """Pinned feet apart in x and z, and one that keeps the frame from turning about the line between them."""
    assert bent(clamped=(), foundation={"foot": SPINS, "hand": (1e6, 1e6, 1e6, 1e3, 0.0, 0.0)}).grounded == (
        "foot",
        "hand",
    )
    with pytest.raises(InputError, match=r"foundation = foot, hand: .* is free to turn about"):
        bent(clamped=(), foundation={"foot": SPINS, "hand": SPINS})


@pytest.mark.parametrize(
    ("first", "second", "message"),
    [
        ({"end_release": ("Mx",)}, {}, r"members.leg.end_release = Mx: must be one of N, Vy, Vz, T, My, Mz"),
        ({"end_release": ("My", "T", "My")}, {}, r"members.leg.end_release = My: given 2 times, must be unique"),
        ({"start_release": ("T",), "end_release": ("T",)}, {}, r"members.leg.start_release = .* member itself free"),
        ({"start_release": ("My", "Vz"), "end_release": ("My",)}, {}, r"members.leg.start_release = .* itself free"),
        ({"end_release": ("T",)}, {}, r"members = leg: with their releases leave hand free to move along y"),
        ({"start_release": ("My",)}, {}, r"members = leg: with their releases leave .* free to"),
        ({"end_release": ("My",)}, {"start_release": ("My",)}, r"members = leg, arm: with their releases leave"),
        ({}, {"start_release": ("N",)}, r"members = arm: with their releases leave hand free to move along x"),
    ],
)
def test_releases_that_leave_a_mechanism_are_refused(member, bent, first, second, message):
    with pytest.raises(InputError, match=message):
        bent(members=(member("leg", "foot", "knee", **first), member("arm", "knee", "hand", **second)))


def test_a_node_that_nothing_turns_needs_no_spring_but_inertia(member, bent):
    """A foot that springs keep from turning under a pinned leg: it has stiffness, and nothing that turns with it."""
    leg = member("leg", "foot", "knee", start_release=("My", "Mz"))
    stands = {"clamped": ("hand",), "foundation": {"foot": (1e8,) * 6}}
    members = (leg, member("arm", "knee", "hand"))
    with pytest.raises(
        InputError, match=r"members = leg: with their releases leave foot without inertia to turn about"
    ):
        bent(members=members, **stands)
    base = PointMass(node="foot", mass=1e3, inertia=(1e3,) * 3)
    model = assemble(bent(members=members, masses=(base,), **stands))
    assert np.all(np.isfinite(modes(model.K, model.M, model.free).omega))


def test_offsets_that_leave_nothing_of_a_member_are_refused(member, bent):
    with pytest.raises(InputError, match=r"members.leg.start_offset = .* must leave some of the way"):
        bent(members=(member("leg", "foot", "knee", start_offset=(0, 0, 5.0), end_offset=(0, 0, -4.0)),))
    for offsets, message in (
        ({"end_offset": (0, 0, -9.5)}, r"end_offset = \(0, 0, -9.5\): must leave some of the way between its nodes$"),
        ({"start_offset": (0, 0, 2.0), "end_offset": (0, 0, -8.5)}, r"end_offset = .* its nodes, with start_offset$"),
        ({"start_offset": (0, 0, 11.0), "end_offset": (1.0, 0, 1.0)}, r"start_offset = .* its nodes, with end_offset$"),
    ):
        with pytest.raises(InputError, match=r"^members\.leg\." + message):
            bent(members=(member("leg", "foot", "knee", **offsets),))
    with pytest.raises(InputError, match=r"members.leg.end_offset = .*: must be finite m"):
        member("leg", "foot", "knee", end_offset=(0, 0, float("inf")))
    moved = bent(members=(member("leg", "foot", "knee"), member("arm", "knee", "hand", start_offset=(0.5, 0, -20.0))))
    assert dict(moved.places())["members.arm.start_offset"] == (0.5, 0, -20.0)


def test_a_floating_part_is_refused(member, bent):
    members = (member("leg", "foot", "knee"), member("spar", "hand", "far"))
    with pytest.raises(InputError, match=r"nodes = hand, far: must be joined"):
        bent(nodes=NODES | {"far": (9, 9, 9)}, members=members)


def test_two_members_of_one_name_are_refused(member, bent):
    members = (member("leg", "foot", "knee"), member("leg", "knee", "hand"))
    with pytest.raises(InputError, match=r"members = leg: given 2 times"):
        bent(members=members)


def test_an_unknown_end_is_refused(member, bent):
    with pytest.raises(InputError, match=r"members.leg.end = toe: must be one of"):
        bent(members=(member("leg", "foot", "toe"),))


@pytest.mark.parametrize(
    ("fields", "message"),
    [
        ({"elements": 0}, r"members.leg.elements = 0: must be a whole number >= 1"),
        ({"elements": 2.5}, r"members.leg.elements = 2.5"),
        ({"end": "foot"}, r"members.leg.end = foot: must differ from start"),
        ({"drag_coefficient": -1}, r"members.leg.drag_coefficient = -1: must be >= 0"),
        ({"inertia_coefficient": 0.5}, r"members.leg.inertia_coefficient = 0.5: must be >= 1"),
        (
            {"drag_coefficient": 1, "section": solid_rectangle(1, 1)},
            r"members.leg.section.diameter = 0.0: must be > 0 m",
        ),
    ],
)
def test_bad_members_are_refused(member, fields, message):
    with pytest.raises(InputError, match=message):
        member(**{"name": "leg", "start": "foot", "end": "knee"} | fields)


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: Material(E=0, G=1, density=1), r"material.E = 0: must be > 0 Pa"),
        (lambda: Material(E=1, G=1, density=-1), r"material.density = -1: must be > 0 kg/m3"),
        (lambda: PointMass(node="a", mass=0), r"masses.a.mass = 0: must be > 0 kg"),
        (
            lambda: PointMass(node="a", mass=1, inertia=(1, -1, 1)),
            r"masses.a.inertia = \(1, -1, 1\): must be >= 0 kg m2",
        ),
        (lambda: PointMass(node="a", mass=1, inertia=(1, 2, 4)), r"masses.a.inertia = \(1, 2, 4\): no body has such"),
        (
            lambda: PointMass(node="a", mass=1, inertia=(2, 2, 2), products_of_inertia=(1.1, 0, 0)),
            r"masses.a.inertia = \(2, 2, 2\): no body has such moments",
        ),
        (lambda: PointMass(node="a", mass=1, cog=(0, 0, float("nan"))), r"masses.a.cog = .* must be finite m"),
        (lambda: PointLoad(node="a", force=(1, 2)), r"loads.a = \(1, 2\): must be three finite"),
    ],
)
def test_bad_materials_masses_and_loads_are_refused(make, message):
    with pytest.raises(InputError, match=message):
        make()
