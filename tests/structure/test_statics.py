"""Any mesh gives beam theory's static answer; frames turn with their loads; Euler's load."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.optimize import brentq
from scipy.spatial.transform import Rotation

from solver.errors import InputError
from solver.structure import recovery, statics, water
from solver.structure.frame import Frame
from solver.structure.frame_model import assemble
from solver.structure.in_water import dynamic_model
from solver.structure.members import Member, PointLoad, PointMass
from solver.structure.sections import general, solid_rectangle, tube
from tests.structure.axial import pushed

ROUNDING = 1e-8  # K of fine meshes is conditioned about 1e7: 1e-16 becomes 1e-9
TIP_LOAD = (3e3, -2e3, 5e3)
W = 9.81


@pytest.mark.parametrize("n", [1, 2, 7, 30])
def test_tip_load_on_a_cantilever_in_any_mesh(line, pipe, steel, n):
    model = line(n, loads=(PointLoad(node="end", force=TIP_LOAD),))
    tip = statics.static(model, statics.point_load(model))[model.translations("end")]
    bending = 12**3 / (3 * steel.E * pipe.Iy)
    expected = np.array(TIP_LOAD) * [12 / (steel.E * pipe.area), bending, bending]
    assert tip == pytest.approx(expected, rel=ROUNDING)


def test_a_plank_bends_about_either_axis_by_its_own_moment(line, steel):
    """F L³/3EI of a plank lying flat, three times as wide as high: pushed aside it is nine times as stiff."""
    plank = solid_rectangle(width=0.3, height=0.1)
    model = line(3, section=plank, loads=(PointLoad(node="end", force=(0.0, 1e3, 1e3)),))
    tip = statics.static(model, statics.point_load(model))[model.translations("end")]
    aside, up = 0.1 * 0.3**3 / 12, 0.3 * 0.1**3 / 12
    assert tip[1:] == pytest.approx(1e3 * 12**3 / (3 * steel.E) / np.array([aside, up]), rel=ROUNDING)


@pytest.mark.parametrize("n", [1, 3])
def test_a_shearing_cantilever_in_any_mesh(line, pipe, steel, n):
    """Under a tip load FL³/3EI + FL/κGA; under its weight wL⁴/8EI + wL²/2κGA, and wL, wL²/2 at the foot."""
    L, section = 1.5, replace(pipe, shear_factor=0.53)
    kGA = 0.53 * steel.G * pipe.area
    model = line(n, end=(L, 0, 0), section=section, loads=(PointLoad(node="end", force=TIP_LOAD),))
    tip = statics.static(model, statics.point_load(model))[model.translations("end")]
    assert tip[1:] == pytest.approx(np.array(TIP_LOAD[1:]) * (L**3 / (3 * steel.E * pipe.Iy) + L / kGA), rel=ROUNDING)
    w = steel.density * pipe.area * W
    d = statics.static(model, statics.gravity_load(model, W))
    assert d[model.translations("end")][2] == pytest.approx(
        -w * L**4 / (8 * steel.E * pipe.Iy) - w * L**2 / (2 * kGA), rel=ROUNDING
    )
    foot = recovery.section_forces(model, d, statics.self_weight(model, W))[0]
    assert foot[[2, 4]] == pytest.approx([-w * L, w * L**2 / 2], rel=ROUNDING)


def test_a_cone_bends_as_it_should_to_second_order_in_its_mesh(line, steel):
    """F L³/3EI of its thick end times thick over thin; its volume, and the stress of the thin end at that end."""
    L, thick, thin = 12.0, 0.6, 0.3
    exact = TIP_LOAD[1] * L**3 / (3 * steel.E * np.pi / 64 * thick**4) * thick / thin
    frustum = np.pi * L / 12 * (thick**2 + thick * thin + thin**2)

    def errors(n):
        ends = {"section": tube(thick, thick / 2), "end_section": tube(thin, thin / 2)}
        model = line(n, **ends, loads=(PointLoad(node="end", force=(0, TIP_LOAD[1], 0)),))
        tip = statics.static(model, statics.point_load(model))[model.translations("end")][1]
        weight = -statics.gravity_load(model, W)[2::6].sum()
        assert recovery.section_properties(model)[-1] == pytest.approx(
            [np.pi / 4 * thin**2, *2 * [np.pi / 64 * thin**4], thin / 2]
        )
        return np.array([tip / exact, weight / (steel.density * frustum * W)]) - 1

    assert np.log2(errors(10) / errors(20)) == pytest.approx(2, abs=0.02)
    assert np.abs(errors(20)).max() < 1.5e-3


@pytest.mark.parametrize("flooded", [None, True, False])
def test_a_tapered_member_may_be_given_from_either_end(line, flooded):
    """Its stiffness, mass, weight and water are those of the same member, stood on its head."""
    wide, narrow = replace(tube(0.6, 0.02), shear_factor=0.6), replace(tube(0.3, 0.01), shear_factor=0.5)
    water_of = {"drag_coefficient": 1.0, "inertia_coefficient": 2.0, "flooded": flooded}
    places = {"start": (0, 0, -10.0), "end": (3.0, 1.0, 2.0)}
    up = line(3, **places, section=wide, end_section=narrow, clamped=("start",), **water_of)
    down = line(
        3, start=places["end"], end=places["start"], section=narrow, end_section=wide, clamped=("end",), **water_of
    )
    turned = np.array([1, 0, 3, 2])
    at = (6 * turned[:, None] + np.arange(6)).ravel()
    for A, B in (
        (up.K, down.K),
        (up.M, down.M),
        (water.added_mass(up, 1e3), water.added_mass(down, 1e3)),
        (water.inner_mass(up, 1e3), water.inner_mass(down, 1e3)),
    ):
        assert B.toarray()[np.ix_(at, at)] == pytest.approx(A.toarray(), rel=1e-9, abs=1e-9 * abs(A).max() + 1e-30)
    load = water.static_load(up, 1e3, W)
    assert water.static_load(down, 1e3, W)[at] == pytest.approx(load, rel=1e-9, abs=1e-9 * abs(load).max())
    assert recovery.section_properties(down)[::-1] == pytest.approx(recovery.section_properties(up))


@pytest.mark.parametrize(
    ("first", "last", "message"),
    [
        (tube(0.5, 0.01), solid_rectangle(0.5, 0.5), "solid-rectangle: must be of shape tube"),
        (
            general(0.1, 1e-3, 1e-3, 1e-3, [(0.1, 0.1)], 0.01),
            tube(0.5, 0.01),
            "tube: a general section does not taper",
        ),
        (replace(tube(0.5, 0.01), shear_factor=0.5), tube(0.4, 0.01), "must have a shear_factor if the section"),
    ],
)
def test_a_taper_between_unlike_sections_is_refused(line, first, last, message):
    with pytest.raises(InputError, match=rf"members\.pile\.end_section = .*{message}"):
        line(2, section=first, end_section=last)


def test_loads_on_one_node_add_up(line):
    each = [PointLoad(node="end", force=force) for force in (TIP_LOAD, (1.0, 2.0, 3.0))]
    model = line(1, loads=tuple(each))
    assert statics.point_load(model)[model.translations("end")] == pytest.approx(np.add(TIP_LOAD, (1.0, 2.0, 3.0)))


@pytest.mark.parametrize("n", [1, 2, 7, 30])
def test_own_weight_on_a_cantilever_in_any_mesh(line, pipe, steel, n):
    model = line(n)
    tip = statics.static(model, statics.gravity_load(model, W))[model.translations("end")]
    w = steel.density * pipe.area * W
    assert tip[2] == pytest.approx(-w * 12**4 / (8 * steel.E * pipe.Iy), rel=ROUNDING)


@pytest.mark.parametrize("n", [2, 4, 10])
def test_own_weight_between_two_walls(line, pipe, steel, n):
    model = line(n, clamped=("start", "end"))
    displacement = statics.static(model, statics.gravity_load(model, W)).reshape(-1, 6)
    middle = displacement[model.member_nodes["pile"][n // 2], 2]
    w = steel.density * pipe.area * W
    assert middle == pytest.approx(-w * 12**4 / (384 * steel.E * pipe.Iy), rel=ROUNDING)


@pytest.mark.parametrize("n", [1, 3, 10])
def test_column_shortens_under_its_weight_and_its_top(line, pipe, steel, n):
    model = line(n, end=(0, 0, 12), masses=(PointMass(node="end", mass=4e4),))
    top = statics.static(model, statics.gravity_load(model, W))[model.translations("end")]
    half_own = steel.density * pipe.area * 12 / 2
    assert top == pytest.approx([0, 0, -(4e4 + half_own) * W * 12 / (steel.E * pipe.area)], abs=1e-12)


PIN = ("My", "Mz")


@pytest.mark.parametrize("n", [1, 3])
def test_a_propped_beam_bears_its_weight(line, pipe, steel, n):
    """Clamped, and pinned at its end: 5wL/8 and wL²/8 at the clamp, 3wL/8 and no moment at the pin, with any mesh."""
    model = line(n, clamped=("start", "end"), end_release=PIN)
    w = steel.density * pipe.area * W
    d = statics.static(model, statics.gravity_load(model, W))
    forces = recovery.section_forces(model, d, statics.self_weight(model, W))
    assert forces[0, [2, 4]] == pytest.approx([-5 / 8 * w * 12, w * 12**2 / 8], rel=ROUNDING)
    assert forces[-1, [2, 4]] == pytest.approx([3 / 8 * w * 12, 0], abs=ROUNDING * w * 12**2)


def hinged(steel, pipe, meshes=(2, 3), **hinge):
    """Two beams of 5 m and 7 m between walls, joined by a hinge, with a load there."""
    nodes = {"a": (0, 0, 0), "b": (3, 4, 0), "c": (3 + 4.2, 4 + 5.6, 0)}
    made = {"section": pipe, "material": steel}
    members = (
        Member(name="ab", start="a", end="b", elements=meshes[0], **made, **hinge),
        Member(name="bc", start="b", end="c", elements=meshes[1], **made),
    )
    load = (PointLoad(node="b", force=(0, 0, -1e4)),)
    return assemble(Frame(nodes=nodes, members=members, clamped=("a", "c"), loads=load))


@pytest.mark.parametrize("meshes", [(1, 1), (2, 3)])
def test_a_hinge_between_two_cantilevers(steel, pipe, meshes):
    """They share the load by 3EI/a³ and 3EI/b³; but for a hinge about the level axis alone My stays."""
    EI = steel.E * pipe.Iy
    model = hinged(steel, pipe, meshes, end_release=("My",))
    d = statics.static(model, statics.point_load(model))
    assert d[model.translations("b")][2] == pytest.approx(-1e4 / (3 * EI / 5**3 + 3 * EI / 7**3), rel=ROUNDING)
    ends = (recovery.section_force_matrix(model) @ d).reshape(-1, 6)
    assert np.abs(ends[2 * meshes[0] - 1 : 2 * meshes[0] + 1, 4]).max() < ROUNDING * 1e4
    rigid = hinged(steel, pipe, meshes)
    other = hinged(steel, pipe, meshes, end_release=("Mz",))
    joined = [statics.static(m, statics.point_load(m))[m.translations("b")][2] for m in (rigid, other)]
    assert joined[0] == pytest.approx(-1e4 * (5 * 7) ** 3 / (3 * EI * 12**3), rel=ROUNDING)
    assert joined[1] == pytest.approx(joined[0], rel=ROUNDING)


SPRUNG = ("N", "Vy", "Vz", "T", "My", "Mz")
STIFFNESS = (3e6, 4e5, 5e5, 6e6, 7e6, 8e6)


@pytest.mark.parametrize("n", [1, 3])
def test_a_foot_on_springs_gives_way_by_them(line, pipe, steel, n):
    """Of F at the end of L: F/EA + F/k along it, FL³/3EI + F/k + FL²/kθ across it, TL/GJ + T/k about it."""
    EI, L, k = steel.E * pipe.Iy, 12.0, np.array(STIFFNESS)
    push = (1e5, 2e3, 5e3)
    model = line(n, start_release=SPRUNG, start_spring=STIFFNESS, loads=(PointLoad(node="end", force=push),))
    d = statics.static(model, statics.point_load(model))
    N, V, W = push
    across = lambda F, shift, turn: F * (L**3 / (3 * EI) + 1 / shift + L**2 / turn)  # noqa: E731
    expected = [N * (L / (steel.E * pipe.area) + 1 / k[0]), across(V, k[1], k[5]), across(W, k[2], k[4])]
    assert d[model.translations("end")] == pytest.approx(expected, rel=ROUNDING)
    ends = recovery.section_forces(model, d, np.zeros((n, 12)))
    assert ends[0] == pytest.approx([N, V, W, 0, -W * L, V * L], abs=1e-6 * N)


@pytest.mark.parametrize("n", [1, 4])
def test_a_sagging_end_on_a_spring(line, pipe, steel, n):
    """w on L between a fixed end and a spring kθ: a pin would turn by wL³/48EI; M (1/kθ + L/4EI) is that."""
    EI, L, k, w = steel.E * pipe.Iy, 12.0, 7e6, 1e3
    held = {"clamped": ("start", "end"), "distributed_load": (0.0, 0.0, -w)}
    model = line(n, end_release=("My",), end_spring=(0, 0, 0, 0, k, 0), **held)
    q = statics.distributed_load(model)
    ends = recovery.section_forces(model, statics.static(model, model.total(q)), q)
    assert abs(ends[-1][4]) == pytest.approx(w * L**3 / (48 * EI) / (1 / k + L / (4 * EI)), rel=1e-9)


def test_springs_tie_from_nothing_to_all(line, steel, pipe):
    """As a pin where they are nothing, as one piece where they are stiff; those of what is not released are named."""

    def foot(k, **fields):
        springs = {"start_spring": (0, 0, 0, 0, k, k)} if k else {}
        return line(2, clamped=("start", "end"), **springs, **fields).element_stiffness[0]

    pin, whole = foot(0.0, start_release=PIN), foot(0.0)
    assert foot(1e-6, start_release=PIN) == pytest.approx(pin, abs=1e-5)
    assert foot(1e18, start_release=PIN) == pytest.approx(whole, abs=1e-8 * np.abs(whole).max())
    with pytest.raises(InputError, match=r"pile\.start_spring = .*: must be 0 for Vz, or start_release must name it"):
        line(2, start_release=PIN, start_spring=(0, 0, 1e3, 0, 0, 0))


def test_pinned_braces_bear_no_moment(steel, pipe):
    """A triangle whose strut is pinned at both ends bears F/cos of its slope in it but for what the post takes."""
    nodes = {"foot": (0, 0, 0), "wall": (6, 0, 0), "top": (0, 0, 8)}
    made = {"section": pipe, "material": steel, "elements": 1}
    post = Member(name="post", start="foot", end="top", **made)
    strut = Member(name="strut", start="wall", end="top", start_release=PIN, end_release=PIN, **made)
    load = (PointLoad(node="top", force=(1e5, 0, 0)),)
    model = assemble(Frame(nodes=nodes, members=(post, strut), clamped=("foot", "wall"), loads=load))
    d = statics.static(model, statics.point_load(model))
    forces = (recovery.section_force_matrix(model) @ d).reshape(-1, 6)
    assert np.abs(forces[2:, [1, 2, 4, 5]]).max() < 1e-3
    N, V = forces[2, 0], 3 * steel.E * pipe.Iy / 8**3 * d[model.translations("top")][0]
    assert pytest.approx(-(1e5 - V), rel=1e-6) == N * 0.6
    assert 0 < V < 1e3


@pytest.mark.parametrize("n", [1, 3])
def test_a_rigid_end_carries_on_what_bends_before_it(line, pipe, steel, n):
    """F at 3 m beyond and 0.8 m above the end of 9 m: v + hθ under F and Fh, and what its arm twists."""
    EI, L, h, up = steel.E * pipe.Iy, 9.0, 3.0, 0.8
    push = (0.0, 2e3, 5e3)
    model = line(n, end=(12, 0, up), end_offset=(-h, 0, -up), loads=(PointLoad(node="end", force=push),))
    d = statics.static(model, statics.point_load(model))
    bent = L**3 / (3 * EI) + 2 * h * L**2 / (2 * EI) + h**2 * L / EI  # of a unit force
    twist = 2e3 * -up * L / (steel.G * pipe.J)
    assert d[model.translations("end")] == pytest.approx(
        [5e3 * up * -(L**2 / 2 + h * L) / EI, 2e3 * bent - up * twist, 5e3 * bent], rel=ROUNDING
    )
    ends = recovery.section_forces(model, d, np.zeros((n, 12)))
    assert ends[0] == pytest.approx([0, 2e3, 5e3, 2e3 * -up, -5e3 * 12, 2e3 * 12], abs=1e-4)
    assert ends[-1] == pytest.approx([0, 2e3, 5e3, 2e3 * -up, -5e3 * h, 2e3 * h], abs=1e-4)


def test_frames_with_offsets_move_rigidly_and_weigh_where_their_members_are(steel, pipe):
    made = {"section": pipe, "material": steel, "elements": 3}
    nodes = {"a": (0, 0, 0), "b": (0, 1, 8), "c": (6, -1, 8)}
    off = {"start_offset": (0.5, -0.4, 0.3), "end_offset": (-0.2, 0.6, -0.7)}
    members = (
        Member(name="ab", start="a", end="b", **made, **off),
        Member(name="bc", start="b", end="c", **made, **off),
    )
    model = assemble(Frame(nodes=nodes, members=members, clamped=("a",)))
    rigid = np.zeros((len(model.xyz), 6, 6))
    rigid[:, :3, :3] = rigid[:, 3:, 3:] = np.eye(3)
    rigid[:, :3, 3:] = np.array([np.cross(np.eye(3), x).T for x in model.xyz])
    rigid = rigid.reshape(-1, 6)
    assert np.abs(model.K @ rigid).max() < 1e-10 * abs(model.K).max()
    weight, moment, mass = np.zeros(3), np.zeros(3), 0.0
    for member in members:
        start, end = np.add(nodes[member.start], off["start_offset"]), np.add(nodes[member.end], off["end_offset"])
        own = steel.density * pipe.area * np.linalg.norm(end - start)
        mass += own
        weight += [0, 0, -own * W]
        moment += np.cross((start + end) / 2, [0, 0, -own * W])
    assert rigid.T @ statics.gravity_load(model, W) == pytest.approx([*weight, *moment])
    assert (rigid.T @ model.M @ rigid)[:3, :3] == pytest.approx(mass * np.eye(3))


def test_a_mass_beside_its_node_bends_the_column_by_its_moment(line, pipe, steel):
    """At levers x and y: M L²/2EI at the top, and the foot bears M = mg r."""
    body = PointMass(node="end", mass=2e3, cog=(1.5, -0.5, 2.0), inertia=(1e3,) * 3)
    model = line(3, end=(0, 0, 12), masses=(body,))
    load = statics.gravity_load(model, W)
    d = statics.static(model, load)
    top = d[model.translations("end")]
    assert top[:2] == pytest.approx(2e3 * W * np.array([1.5, -0.5]) * 12**2 / (2 * steel.E * pipe.Iy), rel=ROUNDING)
    foot = (model.K @ d - load)[6 * model.node_index["start"] + np.arange(6)]
    weight = (2e3 + steel.density * pipe.area * 12) * W
    assert foot == pytest.approx([0, 0, weight, -2e3 * W * 0.5, -2e3 * W * 1.5, 0], abs=1e-6 * weight)


def test_a_frame_on_any_foundation_moves_as_the_spring_and_then_bends(line, pipe, steel):
    """All six couple: the foot moves by k⁻¹ (F, M), what stands on it turns with it, and bends besides."""
    rng = np.random.default_rng(3)
    root = rng.normal(size=(6, 6)) * 1e4
    k = root @ root.T
    force = np.array(TIP_LOAD)
    load = (PointLoad(node="end", force=TIP_LOAD),)
    clamped = line(2, end=(3, -4, 12), loads=load)
    model = line(2, end=(3, -4, 12), clamped=(), foundation={"start": tuple(map(tuple, k))}, loads=load)
    foot = np.linalg.solve(k, np.concatenate([force, np.cross([3, -4, 12], force)]))
    bent = statics.static(clamped, statics.point_load(clamped))[clamped.translations("end")]
    d = statics.static(model, statics.point_load(model))
    assert d[:6] == pytest.approx(foot, rel=1e-6)
    assert d[model.translations("end")] == pytest.approx(bent + foot[:3] + np.cross(foot[3:], [3, -4, 12]), rel=1e-6)


def frame_of_two(steel, pipe, h, span, feet):
    """A portal in the xz plane, pushed along x at both corners by 500 N each; `feet` go to the frame."""
    nodes = {"a": (0, 0, 0), "b": (0, 0, h), "c": (span, 0, h), "d": (span, 0, 0)}
    members = tuple(
        Member(name=i + j, start=i, end=j, elements=2, section=pipe, material=steel) for i, j in ("ab", "bc", "cd")
    )
    push = tuple(PointLoad(node=n, force=(500.0, 0, 0)) for n in "bc")
    return assemble(Frame(nodes=nodes, members=members, loads=push, **feet))


def test_a_portal_on_pins_and_on_stiff_springs(steel, pipe):
    """Free to rock F h²l/12EI + F h³/6EI and 2F h³/EAl² of the legs' stretch; very stiff springs are clamps."""
    h, span = 12.0, 7.0
    EI, EA = steel.E * pipe.Iy, steel.E * pipe.area
    pins = dict.fromkeys("ad", (1e20, 1e20, 1e20, 1e20, 0.0, 1e20))
    model = frame_of_two(steel, pipe, h, span, {"foundation": pins})
    sway = statics.static(model, statics.point_load(model))[model.translations("b")[0]]
    pinned = 1e3 * (h**2 * span / (12 * EI) + h**3 / (6 * EI) + 2 * h**3 / (EA * span**2))
    assert sway == pytest.approx(pinned, rel=1e-6)
    stiff, clamped = (
        frame_of_two(steel, pipe, h, span, feet)
        for feet in ({"foundation": dict.fromkeys("ad", (1e16,) * 6)}, {"clamped": ("a", "d")})
    )
    a, b = (statics.static(m, statics.point_load(m)) for m in (stiff, clamped))
    assert a == pytest.approx(b, abs=1e-6 * np.abs(b).max())
    assert b[clamped.translations("b")[0]] < 0.5 * sway


def portal(steel, pipe, turn, meshes=(3, 2, 4)):  # pipe: of any section that is the same all round
    """Two legs of different length and a beam, loaded at one corner, the whole turned by `turn`."""
    points = {"a": (0, 0, 0), "b": (0, 1, 8), "c": (6, -1, 8), "d": (7, 0, 1)}
    nodes = {name: tuple(turn @ np.array(point, float)) for name, point in points.items()}
    pairs = zip(("a", "b", "c"), ("b", "c", "d"), meshes, strict=True)
    members = tuple(Member(name=i + j, start=i, end=j, elements=n, section=pipe, material=steel) for i, j, n in pairs)
    loads = (PointLoad(node="b", force=tuple(turn @ TIP_LOAD)),)
    return assemble(Frame(nodes=nodes, members=members, clamped=("a", "d"), loads=loads))


@pytest.mark.parametrize("seed", range(4))
@pytest.mark.parametrize("shear_factor", [None, 0.01])
def test_a_turned_frame_moves_by_the_turned_displacements(steel, pipe, seed, shear_factor):
    pipe = replace(pipe, shear_factor=shear_factor)
    turn = Rotation.random(rng=np.random.default_rng(seed)).as_matrix()
    plain, turned = portal(steel, pipe, np.eye(3)), portal(steel, pipe, turn)
    here, there = (statics.static(m, statics.point_load(m)).reshape(-1, 2, 3) for m in (plain, turned))
    assert there == pytest.approx(here @ turn.T, abs=ROUNDING * np.abs(here).max())


@pytest.mark.parametrize("shear_factor", [None, 0.01])
def test_patch_any_mesh_of_the_members_gives_the_same_corner(steel, pipe, shear_factor):
    pipe = replace(pipe, shear_factor=shear_factor)
    coarse = portal(steel, pipe, np.eye(3), meshes=(1, 1, 1))
    fine = portal(steel, pipe, np.eye(3), meshes=(13, 5, 8))
    corner = [statics.static(m, statics.point_load(m)).reshape(-1, 6)[m.node_index["c"]] for m in (coarse, fine)]
    assert corner[0] == pytest.approx(corner[1], abs=ROUNDING * np.abs(corner[0]).max())


def test_supports_carry_what_is_loaded(steel, pipe):
    model = portal(steel, pipe, np.eye(3))
    load = statics.gravity_load(model, W) + statics.point_load(model)
    reaction = (model.K @ statics.static(model, load) - load).reshape(-1, 6)[:, :3]
    clamped = [model.node_index["a"], model.node_index["d"]]
    total = load.reshape(-1, 6)[:, :3].sum(axis=0)
    assert reaction[clamped].sum(axis=0) == pytest.approx(-total, rel=ROUNDING)
    assert np.abs(np.delete(reaction, clamped, axis=0)).max() < ROUNDING * np.abs(total).max()


def euler_load(steel, pipe):
    return np.pi**2 * steel.E * pipe.Iy / (4 * 12**2)


def test_cantilever_buckles_at_eulers_load_to_fourth_order(line, steel, pipe):
    meshes = np.array([1, 2, 4, 8])
    column = [line(n, end=(0, 0, 12), loads=(PointLoad(node="end", force=(0, 0, -1e3)),)) for n in meshes]
    load = [1e3 * statics.buckling_factor(m, pushed(m, statics.point_load(m)), W) for m in column]
    error = np.array(load) / euler_load(steel, pipe) - 1
    # Consistent matrices bound the load from above, by (kh)⁴/720.
    assert error[-1] == pytest.approx((np.pi / 2 / 8) ** 4 / 720, rel=0.05)
    assert np.polyfit(np.log(meshes), np.log(error), 1)[0] == pytest.approx(-4, abs=0.1)


def test_a_shearing_column_buckles_at_engessers_load(line, steel, pipe):
    """P = Pe/(1 + Pe/κGA) (Engesser 1891), with κ so low that shear takes a third of it."""
    euler = euler_load(steel, pipe)
    kGA = 2 * euler
    section = replace(pipe, shear_factor=kGA / (steel.G * pipe.area))
    meshes = np.array([8, 16, 32])
    push = (PointLoad(node="end", force=(0, 0, -1e3)),)
    column = [line(n, end=(0, 0, 12), section=section, loads=push) for n in meshes]
    load = [1e3 * statics.buckling_factor(m, pushed(m, statics.point_load(m)), W) for m in column]
    error = np.array(load) / (euler / (1 + euler / kGA)) - 1
    assert 0 < error[-1] < 1e-4
    assert np.polyfit(np.log(meshes), np.log(error), 1)[0] == pytest.approx(-2, abs=0.1)


def test_a_column_between_pins_buckles_at_eulers_load(line, steel, pipe):
    """π²EI/L² to fourth order: released ends' shapes are condensed as their stiffness is."""
    meshes = np.array([4, 8, 16])
    push = (PointLoad(node="end", force=(0, 0, -1e3)),)
    pins = {"start_release": PIN, "end_release": PIN}
    nodes = {"start": (0, 0, 0), "end": (0, 0, 12)}
    slide = {"clamped": ("start",), "foundation": {"end": (1e15, 1e15, 0, 1e15, 1e15, 1e15)}}
    base = (PointMass(node="end", mass=1.0, inertia=(1.0,) * 3),)  # which turns with the node alone
    load = []
    for n in meshes:
        column = Member(name="column", start="start", end="end", elements=n, section=pipe, material=steel, **pins)
        model = assemble(Frame(nodes=nodes, members=(column,), loads=push, masses=base, **slide))
        load.append(1e3 * statics.buckling_factor(model, pushed(model, statics.point_load(model)), W))
    error = np.array(load) / (np.pi**2 * steel.E * pipe.Iy / 12**2) - 1
    assert 0 < error[-1] < 1e-5
    assert np.polyfit(np.log(meshes), np.log(error), 1)[0] == pytest.approx(-4, abs=0.2)


@pytest.mark.parametrize("height", [-2.0, 0.0, 3.0])
def test_a_weight_on_a_lever_buckles_its_column_sooner(line, steel, pipe, height):
    """tan kL = 1/kh, k² = P/EI, of a weight at a height h above the end that it turns with."""
    model = line(
        8,
        end=(0, 0, 12),
        material=replace(steel, density=1e-6),
        masses=(PointMass(node="end", mass=1e3, cog=(0, 0, height)),),
    )
    factor = statics.buckling_factor(model, pushed(model, statics.gravity_load(model, W)), W)
    k = brentq(lambda k: np.cos(12 * k) - k * height * np.sin(12 * k), 1e-6, np.pi / 12)
    assert factor * 1e3 * W == pytest.approx(k**2 * steel.E * pipe.Iy, rel=1e-4)


@pytest.mark.parametrize("offset", ["end", "start"])
def test_a_column_with_a_rigid_end_buckles_sooner(line, steel, pipe, offset):
    """tan kL = 1/kh where the upper end, h long, is rigid; π²EI/4L² of what bends where the foot is."""
    h, push = 3.0, (PointLoad(node="end", force=(0, 0, -1e3)),)
    arm = {"end_offset": (0, 0, -h)} if offset == "end" else {"start_offset": (0, 0, h)}
    model = line(8, end=(0, 0, 12), loads=push, **arm)
    factor = statics.buckling_factor(model, pushed(model, statics.point_load(model)), W)
    k = brentq(lambda k: np.cos(9 * k) - k * h * np.sin(9 * k), 1e-6, np.pi / 9) if offset == "end" else np.pi / 18
    assert factor * 1e3 == pytest.approx(k**2 * steel.E * pipe.Iy, rel=1e-4)


def test_a_pulled_column_never_buckles(line):
    model = line(4, end=(0, 0, 12), loads=(PointLoad(node="end", force=(0, 0, 1e3)),))
    assert statics.buckling_factor(model, pushed(model, statics.point_load(model)), W) == np.inf


def test_own_weight_buckles_a_column_at_greenhills_height(line, steel, pipe):
    """w L³ / EI = 9/4 j², j = 1.866350859 the first zero of J_{-1/3} (Greenhill 1881), to fourth order."""
    w, meshes, error = steel.density * pipe.area * W, np.array([4, 8, 16]), []
    for n in meshes:
        model = line(n, end=(0, 0, 12))
        N = pushed(model, statics.gravity_load(model, W), statics.self_weight(model, W))
        factor = statics.buckling_factor(model, N, W)
        assert dynamic_model(model.frame, 1e3, W, softened=False)[2] == pytest.approx(factor)
        error.append(factor * w * 12**3 / (steel.E * pipe.Iy) / (9 / 4 * 1.866350859**2) - 1)
    assert 0 < error[-1] < 1e-6
    assert np.polyfit(np.log(meshes), np.log(error), 1)[0] == pytest.approx(-4, abs=0.1)


def test_compression_softens_and_tension_stiffens(line, steel, pipe):
    def sway(axial):
        force = (1e3, 0, axial)
        model = line(8, end=(0, 0, 12), loads=(PointLoad(node="end", force=force),))
        load = statics.point_load(model)
        softened = statics.with_geometric_stiffness(model, pushed(model, load), 9.81)
        return statics.static(softened, load)[model.translations("end")[0]]

    # Beam-column under a tip load: δ = P/(N k) (tan kL - kL), k² = N/EI (Timoshenko & Gere, 1.28).
    N = euler_load(steel, pipe) / 2
    k = np.sqrt(N / (steel.E * pipe.Iy))
    # (kh)⁴/720 = 5e-7, doubled by the nearness of the Euler load.
    assert sway(-N) == pytest.approx(1e3 / (N * k) * (np.tan(12 * k) - 12 * k), rel=1.5e-6)
    assert sway(N) == pytest.approx(1e3 / (N * k) * (12 * k - np.tanh(12 * k)), rel=1.5e-6)


def test_axial_force_is_the_section_force(steel, pipe):
    """At both ends of each element, of weight along it, too."""
    model = portal(steel, pipe, np.eye(3))
    load, weight = statics.point_load(model) + statics.gravity_load(model, W), statics.self_weight(model, W)
    forces = recovery.section_forces(model, statics.static(model, load), weight).reshape(-1, 2, 6)
    N = pushed(model, load, weight)
    assert pytest.approx(forces[..., 0], rel=1e-6) == N and np.abs(np.diff(N)).max() > 1e2
