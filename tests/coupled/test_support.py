"""Wave loads on an elastic support: Morison on a pile in closed form, and the reduced basis."""

from dataclasses import replace

import numpy as np
import pytest
from pytest import approx

from solver.coupled import driving, ritz, support, surroundings, typical
from solver.coupled.modal import Structure, WaterAbout, answer, drag, flexibility
from solver.coupled.scheme import LOBATTO
from solver.errors import InputError
from solver.run import simulate
from solver.scene import Platform, Scene, Settings, Water
from solver.sea.field import WaveField
from solver.sea.realization import Realization, components
from solver.statistics import STATISTICS
from solver.structure import water
from solver.structure.frame import Frame
from solver.structure.frame_model import assemble
from solver.structure.members import Material, Member, PointLoad, PointMass
from solver.structure.sections import tube
from tests.awkward import tripod
from tests.structure.test_water import nodal_load

OCEAN = Water(depth=30.0)
OMEGA = 2 * np.pi / 12.0


def pile(elements=40):
    """VERIFICATION: D = 6 m, depth 30 m, amplitude 3 m, T = 12 s, C_D = 1, C_M = 2, to still water."""
    leg = Member(
        name="pile", start="foot", end="top", elements=elements, section=tube(6.0, 0.1),
        material=Material(E=2.1e11, G=8e10, density=7850.0), drag_coefficient=1.0, inertia_coefficient=2.0,
    )  # fmt: skip
    return Frame(nodes={"foot": (0, 0, -30), "top": (0, 0, 0)}, members=(leg,), clamped=("foot",))


@pytest.fixture
def waves():
    sea = Realization(omega=np.array([OMEGA]), amplitude=np.array([3.0 + 0j]), peak_frequency=OMEGA)
    return WaveField(sea, 30.0, 9.81)


def inertia(waves, at, **changes):
    size = surroundings.inertia_size(Platform(frame=pile(), **changes), at, OCEAN)
    return (size[:, None] * waves.acceleration(at.position)[:, 0])[:, 0]


def drag_force(waves, at):
    """Drag at the crest on each station of a pile at rest [N]."""
    u = waves.velocity(at.position)[:, 0, 0].real
    return 0.5 * OCEAN.density * at.drag * at.diameter * at.weight * np.abs(u) * u


@pytest.mark.parametrize("heading", [0.0, 0.7])
def test_water_moves_past_the_members_as_the_field_says(heading):
    """Velocity less what is along the member, station by station: of legs side by side, and of leaning ones."""
    sea = components(amplitude=[1.0, 0.4], omega=[0.8, 1.1], phase=[0.3, 2.0], heading=heading)
    field, model = WaveField(sea, 25.0, 9.81), assemble(tripod().frame)
    at = water.stations(model, 3)
    velocity = field.velocity(at.position)
    along = np.einsum("si,sin->sn", at.tangent, velocity)
    across = velocity - at.tangent[:, :, None] * along[:, None]
    assert surroundings.normal_flow(at, field) == approx(across, abs=1e-13)
    around, size = surroundings.surroundings(at, heading), np.linspace(1.0, 2.0, len(at.weight))
    swing = np.concatenate(field.swing(around.places))
    assert around.std(swing) == approx(np.sqrt(0.5 * np.sum(np.abs(across) ** 2, axis=(1, 2))), rel=1e-12)
    nodal = surroundings.nodal_loads(model, at, around.by_swing(size), swing)
    assert nodal == approx(nodal_load(at, across * (size / at.weight)[:, None, None], len(nodal)), abs=1e-12)


def test_legs_in_the_same_wave_share_places():
    """Two side by side, in waves along x and in others."""
    one, nodes = pile(), {}
    for y in (-3.0, 3.0):
        nodes |= {f"{name}{y}": (x, y, z) for name, (x, _, z) in one.nodes.items()}
    members = [replace(one.members[0], name=f"leg{y}", start=f"foot{y}", end=f"top{y}") for y in (-3.0, 3.0)]
    pair = Frame(nodes=nodes, members=tuple(members), clamped=("foot-3.0", "foot3.0"))
    at = water.stations(assemble(pair), 3)
    assert [len(surroundings.surroundings(at, heading).places) for heading in (0.0, 0.7)] == [120, 240]


@pytest.mark.parametrize("loads", [4, 30])
def test_principal_loads_are_the_singular_vectors_of_many_and_of_few(loads):
    random = np.random.default_rng(1)
    patterns = np.zeros((18, loads))
    patterns[[1, 2, 5, 9, 10, 11, 17]] = random.normal(size=(7, 3)) @ random.normal(size=(3, loads))
    patterns[[1, 2, 5, 9, 10, 11, 17]] += 1e-5 * random.normal(size=(7, loads))
    left = np.linalg.svd(patterns)[0][:, :3]
    shapes = ritz._principal(patterns)
    assert shapes.shape == (18, 3)
    assert shapes @ shapes.T == approx(left @ left.T, abs=1e-8)


def test_published_pile(waves):
    at = water.stations(assemble(pile()), 2)
    assert np.abs(inertia(waves, at).sum()) == approx(1_343_264, rel=1e-5)
    assert drag_force(waves, at).sum() == approx(205_475, rel=1e-5)
    lever = at.position[:, 2] + 30
    drag, mass = drag_force(waves, at) @ lever, np.abs(inertia(waves, at)) @ lever
    phase = np.linspace(0, 2 * np.pi, 20_001)
    moment = drag * np.abs(np.cos(phase)) * np.cos(phase) + mass * np.sin(phase)
    assert moment.max() == approx(2.18588e7, rel=1e-5)


def test_drag_of_the_reduced_platform_is_the_published_piles(waves):
    """At the crest, on a platform that does not move, from the coefficients and velocities that enter the march."""
    s = reduced(waves)
    u = driving.driven(s, waves).stations[:, 0, 0].real
    assert s.drag @ (np.abs(u) * u) == approx(205_475, rel=1e-5)


def test_printed_morison_has_half_the_inertia_load(waves):
    """C_M - 1 in place of C_M = 2 (eq. 16 of Heo et al. as printed)."""
    at = water.stations(assemble(pile()), 2)
    assert inertia(waves, at, wave_inertia="relative") == approx(inertia(waves, at) / 2)


def reduced(waves, modes=4, **changes):
    return support.reduce_platform(
        Platform(frame=pile(), **changes), waves, OCEAN, (), planar=True, modes=modes, stations=2
    )


@pytest.mark.parametrize("modes", [4, 5])
@pytest.mark.parametrize("partly", [False, True])
def test_kernel_drag_is_that_of_relative_velocity(waves, partly, modes):
    """Modal force of ½ρC_D D|u - v|(u - v) at both stages, summed over stations in plain numpy.

    Of stations that are wet in part that share, and what pushes besides. At a step's end alone nothing is done before.
    """
    s, random = reduced(waves, modes), np.random.default_rng(0)
    one = driving.driven(s, waves).stations[..., 0].T
    u = np.stack([one.real, one.imag])
    shape = np.ascontiguousarray(s.station_shape.transpose(2, 1, 0))
    structure = Structure(s.omega, 0 * s.omega, s.carrier, shape, s.drag, 0 * s.omega)
    dp = random.normal(size=(2, s.omega.size))
    wet = random.uniform(size=(2, s.drag.size)) if partly else np.zeros((2, 0))
    push = 1e3 * random.normal(size=u.shape) if partly else np.zeros((2, 1, 0))
    force, flow = np.ones_like(dp), np.empty_like(u)
    drag(structure, WaterAbout(u, wet, push), dp, 0, force, flow)
    v = np.einsum("mdn,sm->sdn", shape, dp)
    load = s.drag * np.linalg.norm(u - v, axis=1, keepdims=True) * (u - v)
    if partly:
        load = wet[:, None] * load + push
    assert flow == approx(load, rel=1e-12)
    assert force == approx(1 + np.einsum("mdn,sdn->sm", shape, load), rel=1e-12)
    late = np.ones_like(dp)
    drag(structure, WaterAbout(u, wet, push), dp, 1, late, flow)
    assert (late[0] == 1).all() and (late[1] == force[1]).all()


def test_basis_is_orthonormal_and_holds_the_static_answer(waves):
    """However few modes are kept, the static shapes make the quasi-static response exact."""
    s = reduced(waves, modes=2)
    every = reduced(waves, modes="all")
    model = assemble(pile())
    M = model.M + water.added_mass(model, OCEAN.density)
    assert s.shapes.T @ (M @ s.shapes) == approx(np.eye(s.omega.size), abs=1e-8)
    few, all_modes = (x.shapes @ (driving.driven(x, waves).modes / x.omega[:, None] ** 2) for x in (s, every))
    assert few == approx(all_modes, abs=1e-6 * np.abs(all_modes).max())


def pair_of_piles(apart, top=0.0):
    """Two piles behind each other and a beam between their tops, in water of as many elements as its waves ask for."""
    one, nodes, count = pile(elements=12), {}, 20 if top == 0.0 else max(20, int(apart / 3))
    for x in (0.0, apart):
        nodes |= {f"foot{x}": (x, 0.0, -30.0), f"top{x}": (x, 0.0, top)}
    legs = [replace(one.members[0], name=f"leg{x}", start=f"foot{x}", end=f"top{x}") for x in (0.0, apart)]
    beam = replace(legs[0], name="beam", start="top0.0", end=f"top{apart}", elements=count)
    return Frame(nodes=nodes, members=(*legs, beam), clamped=("foot0.0", f"foot{apart}"))


def many_waves(heading=0.0, components=130):
    omega = np.sort(np.random.default_rng(3).uniform(0.3, 2.2, components))
    return WaveField(Realization(omega=omega, amplitude=0.1 / omega + 0j, heading=heading), 30.0, 9.81)


@pytest.mark.parametrize(("apart", "most"), [(8.0, 20), (45.0, 45), (170.0, 120)])
def test_shapes_of_typical_waves_hold_the_static_answer_to_all_waves(apart, most):
    """Fewer waves than the sea has, whose shapes serve each of its waves and its drag: of piles near or far apart, and
    a beam in the water between them, along which the phase turns."""
    sea, platform = many_waves(), Platform(frame=pair_of_piles(apart, top=-3.0))
    few, every = (
        support.reduce_platform(platform, sea, OCEAN, (), planar=False, modes=modes, stations=2) for modes in (2, "all")
    )
    assert few.typical.k.size < most and few.typical.k.min() <= sea.k.min() and sea.k.max() <= few.typical.k.max()
    answers = [s.shapes @ (driving.driven(s, sea).modes / s.omega[:, None] ** 2) for s in (few, every)]
    off, size = (np.linalg.norm(answer, axis=0) for answer in (answers[0] - answers[1], answers[1]))
    assert np.all(off < 1e-3 * size)
    drag = [np.einsum("sdm,sdn->mn", s.station_shape, driving.driven(s, sea).stations) for s in (few, every)]
    answers = [s.shapes @ (load / s.omega[:, None] ** 2) for s, load in zip((few, every), drag, strict=True)]
    assert answers[0] == approx(answers[1], abs=3e-3 * np.abs(answers[1]).max())


@pytest.mark.parametrize("scale", [1 / 16, 1 / 20, 30.0])
def test_a_model_has_the_shapes_of_full_scale(scale):
    """Their frequencies by the root of its size, as many of them: what counts as small goes by no unit."""
    omegas = []
    for size in (1.0, scale):
        steel, legs = Material(E=2.1e11 * size, G=8e10 * size, density=7850.0), []
        nodes = {"deck": (0.0, 0.3 * size, 3.0 * size), "hinge": (-1.5 * size, 0.0, 3.0 * size)}
        for name, (x, y, z) in {"a": (-4, -3, -25), "b": (-3, 4, -20), "c": (5, 0, -25)}.items():
            nodes[f"foot {name}"] = (x * size, y * size, z * size)
            legs.append(
                Member(
                    name=name, start=f"foot {name}", end="deck", elements=2, section=tube(0.6 * size, 0.02 * size),
                    material=steel, drag_coefficient=1.0, inertia_coefficient=2.0,
                )
            )  # fmt: skip
        arm = Member(
            name="arm", start="deck", end="hinge", elements=1, section=tube(0.4 * size, 0.02 * size), material=steel
        )
        feet = tuple(name for name in nodes if name.startswith("foot"))
        frame = Frame(nodes=nodes, members=(*legs, arm), clamped=feet)
        sea = many_waves(heading=0.5)
        sea = replace(sea.sea, omega=sea.sea.omega / np.sqrt(size), amplitude=size * sea.sea.amplitude)
        field, water_ = WaveField(sea, 25.0 * size, 9.81), Water(depth=25.0 * size)
        reduced = support.reduce_platform(
            Platform(frame=frame), field, water_, ("hinge",), planar=False, modes=4, stations=2
        )
        omegas.append(reduced.omega * np.sqrt(size))
    assert omegas[1] == approx(omegas[0], rel=1e-6)


def test_seas_of_few_waves_have_their_own_shapes():
    sea = many_waves(components=5)
    few = support.reduce_platform(Platform(frame=pile()), sea, OCEAN, (), planar=True, modes=2, stations=2)
    assert few.typical.k == approx(sea.k)
    still = replace(sea, sea=replace(sea.sea, amplitude=np.zeros(5, complex)))
    assert typical.typical_waves(still, water.stations(assemble(pile()), 4), 30.0).k.size == 0


@pytest.mark.parametrize(("apart", "heading"), [(8.0, 0.0), (45.0, 0.7)])
def test_rows_come_from_a_curve_over_typical_waves_to_rounding(apart, heading):
    sea, platform = many_waves(heading), Platform(frame=pair_of_piles(apart), legs=("leg0.0",))
    options = {"planar": False, "modes": 2, "stations": 2}
    s = support.reduce_platform(platform, sea, OCEAN, (), **options)
    curve, exact = driving._curve(s), driving._rows(s, sea)
    assert curve is not None
    louder = replace(sea, sea=replace(sea.sea, amplitude=2 * sea.sea.amplitude))
    assert support.reduce_platform(platform, louder, OCEAN, (), **options) is s
    kinds = np.cumsum([part.shape[1] for part in driving._maps(s)])
    for rows, true in zip(np.split(curve.at(sea), kinds), np.split(exact, kinds), strict=True):
        assert len(true) and rows == approx(true, abs=1e-11 * np.abs(true).max())
    assert curve.at(driving._unit(curve.nodes, sea)) == approx(curve.values.T, rel=1e-11)


def test_waves_that_no_curve_follows_are_reckoned_one_by_one():
    """A kilometre between two piles: the phase turns too often."""
    sea, platform = many_waves(components=1500), Platform(frame=pair_of_piles(1000.0))
    s = support.reduce_platform(platform, sea, OCEAN, (), planar=False, modes=2, stations=2)
    assert s.typical.k.size < 1500 and driving._curve(s) is None
    assert np.array_equal(driving.driven(s, sea).modes, driving._rows(s, sea)[: s.omega.size])


def test_added_mass_lowers_the_frequencies(waves):
    s = reduced(waves, modes="all")
    assert s.omega[0] < s.dry_omega[0]


def test_flexibility_inverts_the_stage_equations():
    """D⁻¹ of a mode: stage accelerations from stage loads by the collocation rule itself."""
    omega, zeta, dt = 3.0, 0.02, 0.2
    empty = np.zeros((1, 1, 0))
    structure = Structure(np.array([omega]), np.array([zeta]), np.ones((1, 1)), empty, np.zeros(0), np.ones(1))
    inverse, H = flexibility(structure, dt)
    D = np.eye(2) + 2 * zeta * omega * dt * LOBATTO.A + (omega * dt) ** 2 * LOBATTO.AA
    assert inverse[0] @ D == approx(np.eye(2), abs=1e-14)
    assert H[:, 0, :, 0] == approx(inverse[0])


def test_how_much_drag_answers_is_the_spectral_radius_of_what_it_moves(waves):
    """Of stage loads by drag -SᵀRS on stage rates dt A D⁻¹, a matrix of all modes at both stages."""
    s, random, dt = reduced(waves, 5), np.random.default_rng(2), 0.3
    shape = np.ascontiguousarray(s.station_shape.transpose(2, 1, 0))
    structure = Structure(s.omega, 0.02 + 0 * s.omega, s.carrier, shape, s.drag, 0 * s.omega)
    nm, nd, ns = shape.shape
    root = random.normal(size=(ns, nd, nd))
    resistance = 1e3 * (root @ root.swapaxes(1, 2))
    inverse, _ = flexibility(structure, dt)
    damping = np.einsum("mds,sde,nes->mn", shape, resistance, shape)
    moved = np.einsum("mn,nab->manb", damping, dt * LOBATTO.A @ inverse).reshape(2 * nm, 2 * nm)
    radius = np.abs(np.linalg.eigvals(moved)).max()
    assert answer(structure, resistance, inverse, dt) == approx(radius, rel=0.1)
    assert answer(structure, 3 * resistance, inverse, dt) == approx(3 * answer(structure, resistance, inverse, dt))
    assert answer(structure, 0 * resistance, inverse, dt) == 0.0
    assert answer(structure._replace(station=0 * shape), resistance, inverse, dt) == 0.0


def test_weight_on_a_pushed_column_bends_it_further_and_its_foot_bears_that():
    """δ = (tan kL/k - L) H/P, k = √(P/EI), of a light column under a weight P and a push H; M = HL + Pδ at its foot."""
    L, H, mass, section = 12.0, 5e3, 20e3, tube(0.4, 0.02)
    material = Material(E=2.1e11, G=8e10, density=1.0)
    column = Member(name="column", start="foot", end="top", elements=12, section=section, material=material)
    frame = Frame(
        nodes={"foot": (0.0, 0.0, 1.0), "top": (0.0, 0.0, 1.0 + L)}, members=(column,), clamped=("foot",),
        masses=(PointMass(node="top", mass=mass),), loads=(PointLoad(node="top", force=(H, 0.0, 0.0)),),
    )  # fmt: skip
    platform = Platform(frame=frame, legs=("column",), geometric_stiffness=True)
    settings = Settings(duration=5.0, discard=0.0, ramp=0.0, outputs=("reactions", "section_forces"))
    known = simulate(Scene(water=OCEAN, platform=platform, settings=settings)).variables
    P, mean = mass * OCEAN.gravity, STATISTICS.index("mean")
    k = np.sqrt(P / (material.E * section.Iy))
    bent = (np.tan(k * L) / k - L) * H / P
    most = H * L + P * bent
    assert known["static_displacement"][1][0, 0] == approx(bent, rel=1e-4)
    assert known["reaction_moment"][1][0, 1, mean] == approx(-most, rel=1e-4)
    assert np.abs(known["section_moment"][1][0, 0, 1:, mean]).max() == approx(most, rel=1e-4)
    stress = -P / section.area - most * 0.2 / section.Iy
    assert known["bottom_stress"][1][0, mean] == approx(stress, rel=1e-3)


def lopsided(turned):
    """A pile with a mass beside it, in a wave along x or, all of it turned by a right angle, along y: its record."""
    level = np.array([[0, -1, 0], [1, 0, 0], [0, 0, 1]]) if turned else np.eye(3)
    mass = PointMass(node="top", mass=2e5, cog=tuple(level @ [3.0, 3.0, 1.0]))
    platform = Platform(frame=replace(pile(elements=2), masses=(mass,)), legs=("pile",))
    sea = components(amplitude=[1.0], omega=[0.8], phase=[0.0], heading=np.pi / 2 if turned else 0.0)
    settings = Settings(duration=20.0, discard=0.0, ramp=5.0)
    item = Scene(water=OCEAN, sea=sea, platform=platform, settings=settings)
    assert not item.planar
    return simulate(item).variables["top_displacement"][1][0]


def test_a_lopsided_frame_leaves_the_plane_of_waves_along_x():
    """As the same frame turned by a right angle does in waves along y."""
    along, across = lopsided(False), lopsided(True)
    x, y, z = along[:, STATISTICS.index("std")]
    assert y > 1e-5 * x > 0
    assert across[:, STATISTICS.index("std")] == approx(np.array([y, x, z]), rel=1e-5)


@pytest.mark.parametrize("odd", [{"drag_coefficient": 0.7}, {"inertia_coefficient": 1.6}])
def test_half_a_platform_stands_for_its_mirror_image_only(buan, odd):
    """One leg of other water coefficients: structure and masses are symmetric, loads are not."""
    frame = buan.frame()
    first, *others = frame.members
    uneven = buan.platform(frame=replace(frame, members=(replace(first, **odd), *others)))
    field = WaveField(buan.sea(), 50.0, 9.81)
    options = {"modes": 2, "stations": 2}
    with pytest.raises(InputError, match="symmetric frame, its coefficients of drag and inertia included"):
        support.reduce_platform(uneven, field, buan.water, (), planar=True, **options)
    assert support.reduce_platform(uneven, field, buan.water, (), planar=False, **options).drag.size
