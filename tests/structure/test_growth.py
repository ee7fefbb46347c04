"""Marine growth and distributed loads on members: closed forms of masses, weights and deflections."""

from dataclasses import replace

import numpy as np
import pytest
from pytest import approx

from solver.coupled import support, surroundings
from solver.errors import InputError
from solver.scene import Platform, Water
from solver.structure import recovery, sections, statics, water
from solver.structure.frame import Frame
from solver.structure.frame_model import assemble
from solver.structure.members import MarineGrowth
from tests.awkward import on_piles, soft_ground, tripod

RHO, W = 1025.0, 9.81
LAYERS = (  # nothing above 1 m, 5 cm from there, thinner below 3 m, level below 6 m
    MarineGrowth(depth=1.0, thickness=0.0, density=1325.0),
    MarineGrowth(depth=1.0, thickness=0.05, density=1325.0),
    MarineGrowth(depth=3.0, thickness=0.05, density=1325.0),
    MarineGrowth(depth=6.0, thickness=0.02, density=1400.0),
)


@pytest.fixture
def pile(line):
    """From 7.3 m under water to 4.7 m above: no mesh below has a node at a line of the table, or at the surface."""

    def build(n, growth=LAYERS, **fields):
        water = {"drag_coefficient": 1.0, "inertia_coefficient": 1.8}
        return line(n, start=(0.0, 0.0, -7.3), end=(0.0, 0.0, 4.7), growth=growth, **water | fields)

    return build


def along(f, lines=(1.0, 3.0, 6.0, 7.3)):
    """∫ f(thickness, density, depth) over the depths that have growth, by many points in each part."""
    node, weight = np.polynomial.legendre.leggauss(12)
    total = 0.0
    for a, b in zip(lines[:-1], lines[1:], strict=True):
        depth = a + (b - a) * (node + 1) / 2
        thickness = np.interp(depth, [1.0, 3.0, 6.0], [0.05, 0.05, 0.02])
        density = np.interp(depth, [1.0, 3.0, 6.0], [1325.0, 1325.0, 1400.0])
        total += (b - a) / 2 * weight @ f(thickness, density, depth)
    return total


def layer(thickness):
    return np.pi / 4 * ((0.45 + 2 * thickness) ** 2 - 0.45**2)


def shift(model, axis):
    return np.tile(np.eye(6)[axis], len(model.xyz))


@pytest.mark.parametrize("n", [1, 2, 7])
def test_growth_moves_as_a_mass_all_round_whatever_the_mesh(pile, n):
    model = pile(n)
    M = water.growth_mass(model)
    mass = along(lambda t, d, _: d * layer(t))
    for axis in range(3):
        assert shift(model, axis) @ M @ shift(model, axis) == approx(mass)
    turns = np.tile([0.0, 1.0, 0.0], (len(model.xyz), 1))
    turn = np.hstack([np.cross(turns, model.xyz), turns]).ravel()
    assert turn @ M @ turn == approx(along(lambda t, d, z: d * layer(t) * z**2))
    every = water.element_masses(model, RHO, np.arange(n)).sum(axis=0)
    up = np.tile([0, 0, 1, 0, 0, 0], 2)
    assert up @ every @ up == approx(mass)  # the water's moves across alone


@pytest.mark.parametrize("n", [1, 2, 7])
def test_water_meets_the_growths_diameter(pile, n):
    model = pile(n)
    outer = along(lambda t, _d, _z: np.pi / 4 * (0.45 + 2 * t) ** 2) + np.pi / 4 * 0.45**2 * 1.0  # bare above 1 m
    Ma = water.added_mass(model, RHO)
    assert shift(model, 0) @ Ma @ shift(model, 0) == approx(0.8 * RHO * outer)
    at = water.stations(model, 3)
    assert at.weight @ at.diameter == approx(along(lambda t, _d, _z: 0.45 + 2 * t) + 0.45)
    assert shift(model, 1) @ water.drag_matrix(model) @ shift(model, 1) == approx(at.weight @ at.diameter)


@pytest.mark.parametrize("n", [1, 2, 7])
@pytest.mark.parametrize("flooded", [None, True, False])
def test_growth_floats_by_its_own_volume(pile, n, flooded):
    """(ρ - ρ_g) g of its volume besides the member's own, whatever is inside."""
    grown, bare = pile(n, flooded=flooded), pile(n, growth=(), flooded=flooded)
    net = water.static_load(grown, RHO, W) - water.static_load(bare, RHO, W)
    assert net @ shift(grown, 2) == approx(along(lambda t, d, _z: (RHO - d) * W * layer(t)))
    assert net @ shift(grown, 0) == approx(0, abs=1e-9)


def test_growth_stiffens_and_strengthens_nothing(pile):
    grown, bare = pile(3), pile(3, growth=())
    assert (grown.K != bare.K).nnz == 0
    assert np.array_equal(recovery.section_properties(grown), recovery.section_properties(bare))


def test_even_growth_is_a_thicker_pile_that_is_no_stiffer(line, steel):
    """Flooded or not: the same mass, added mass, drag and weight in water as of a section with those numbers."""
    t, density = 0.06, 1300.0
    growth = (MarineGrowth(depth=0.0, thickness=t, density=density),)
    box = {"start": (0.0, 0.0, -9.0), "end": (2.0, 1.0, -3.0), "drag_coefficient": 0.8, "inertia_coefficient": 1.7}
    tube = sections.tube(0.45, 0.012)
    grown = line(2, growth=growth, **box)
    whole = tube.area * steel.density + layer(t) * density
    heavy = line(
        2,
        section=replace(tube, diameter=0.45 + 2 * t),
        material=replace(steel, density=whole / tube.area),
        **box,
    )
    for of in (water.added_mass, lambda model, _: water.drag_matrix(model)):
        assert abs(of(grown, RHO) - of(heavy, RHO)).max() < 1e-9 * abs(of(heavy, RHO)).max()
    M = grown.M + water.growth_mass(grown)
    length = np.linalg.norm([2.0, 1.0, 6.0])
    for axis in range(3):
        assert shift(grown, axis) @ M @ shift(grown, axis) == approx(whole * length)
    net = (RHO * (tube.area + layer(t)) - whole) * W
    assert water.static_load(grown, RHO, W) @ shift(grown, 2) == approx(net * length)
    # As one bar under that load: bent as a closed form of its clamped end, by the load across it.
    tip = statics.static(grown, water.static_load(grown, RHO, W))[6:9]
    axis = np.array([2.0, 1.0, 6.0]) / length
    across = net * (np.array([0, 0, 1]) - axis[2] * axis)
    assert tip - (tip @ axis) * axis == approx(across * length**4 / (8 * steel.E * tube.Iy), rel=1e-9)


def test_growth_lowers_the_frequencies_of_a_platform():
    """The mass that moves is the growth's more, and no frequency is higher."""
    frame = tripod().frame
    grown = replace(frame, growth=LAYERS)
    ocean = Water(depth=25.0)
    models = [support.dynamic_model(Platform(frame=each), ocean)[0] for each in (frame, grown)]
    more = models[1].M - models[0].M
    assert abs(more - water.growth_mass(models[1])).max() < 1e-9 * abs(more).max()
    bare, heavy = (support._dry_frequencies(model) for model in models)
    assert np.all(heavy <= bare * (1 + 1e-9)) and heavy[0] < 0.999 * bare[0]


def test_nothing_grows_where_nothing_is_given(pile):
    bare, none = pile(3, growth=()), pile(3, growth=(MarineGrowth(depth=0, thickness=0.0, density=1300.0),))
    assert water.growth_mass(bare).nnz == 0 and not water.growth_load(bare, RHO, W).any()
    assert abs(water.added_mass(bare, RHO) - water.added_mass(none, RHO)).max() == 0


@pytest.mark.parametrize(
    ("lines", "message"),
    [
        ([(0, -0.1, 1300)], r"marine_growth\[0\]\.thickness = -0\.1: must be >= 0 m"),
        ([(-2, 0.1, 1300)], r"marine_growth\[0\]\.depth = -2: must be >= 0 m"),
        ([(0, 0.1, 0)], r"marine_growth\[0\]\.density = 0: must be > 0 kg/m3"),
        ([(5, 0.1, 1300), (3, 0.1, 1300)], r"marine_growth\[1\]\.depth = 3: must be >= 5 m, the depth of the line"),
        ([(5, 0.1, 1300), (5, 0.2, 1300), (5, 0, 1300)], r"marine_growth\[2\]\.depth = 5: is given three times"),
    ],
)
def test_bad_tables_are_refused(pile, lines, message):
    keys = ("depth", "thickness", "density")
    with pytest.raises(InputError, match=message):
        pile(1, growth=tuple(MarineGrowth(**dict(zip(keys, line, strict=True))) for line in lines))


def test_wave_loads_on_growth_are_those_of_its_diameter():
    """Morison's on a battered leg: inertia as D², drag as D, at the same places."""
    ocean, bare, loads = Water(depth=25.0), tripod().frame, []
    grown = replace(bare, growth=(MarineGrowth(depth=0.0, thickness=0.15, density=1325.0),))
    for frame in (bare, grown):
        at = water.stations(assemble(frame), 3)
        loads.append((surroundings.inertia_size(Platform(frame=frame), at, ocean), surroundings.drag_size(at, ocean)))
    (inertia, drag), (more_inertia, more_drag) = loads
    assert more_inertia == approx(inertia * 1.5**2) and more_drag == approx(drag * 1.5)


@pytest.mark.parametrize("n", [1, 4])
def test_a_distributed_load_bends_a_cantilever_as_its_formula(line, steel, pipe, n):
    """qL⁴/8EI, foot moment qL²/2 and shear qL, of a load across a leaning member; N of what is along it."""
    end = np.array([3.0, 0.0, 4.0])
    q = np.array([-40.0, 30.0, 30.0])  # along y, and across in the plane: (-4, 0, 3)·10
    model = line(n, end=tuple(end), distributed_load=tuple(q))
    load = statics.distributed_load(model)
    tip = statics.static(model, model.total(load))[6:9]
    L, bent = 5.0, 5.0**4 / (8 * steel.E * pipe.Iy)
    assert tip == approx(np.array([-40.0, 30.0, 30.0]) * bent, rel=1e-9)
    foot = recovery.section_forces(model, statics.static(model, model.total(load)), load)[0]
    assert np.hypot(foot[4], foot[5]) == approx(np.linalg.norm(q) * L**2 / 2)
    assert np.hypot(foot[1], foot[2]) == approx(np.linalg.norm(q) * L)
    assert foot[0] == approx(0, abs=1e-6)


@pytest.mark.parametrize("made", [soft_ground, on_piles])
def test_reactions_at_rest_carry_growth_and_distributed_loads(made):
    """Forces and moments about the origin, on the soft ground with offsets, a pin and legs that shear, and in soil."""
    item, _ = made()
    frame = item.platform.frame
    members = tuple(replace(m, distributed_load=(30.0 + i, -20.0, 5.0 * i)) for i, m in enumerate(frame.members))
    frame: Frame = replace(frame, members=members, growth=LAYERS)
    platform = replace(item.platform, frame=frame)
    model, at_rest, _ = support.dynamic_model(platform, item.water)
    places = support._places(platform, item.water, ("reactions",))
    still = support._forces_at_rest(platform, item.water, places)[places.columns.reactions]
    plain = replace(frame, growth=(), members=tuple(replace(m, distributed_load=(0, 0, 0)) for m in members))
    load = water.static_load(assemble(plain), item.water.density, W).reshape(-1, 6)
    force, moment = load[:, :3].sum(axis=0), (load[:, 3:] + np.cross(model.xyz, load[:, :3])).sum(axis=0)
    for member in members:
        a, b = frame.ends(member)
        whole = np.array(member.distributed_load) * np.linalg.norm(b - a)
        force, moment = force + whole, moment + np.cross((a + b) / 2, whole)
        if not member.in_water:
            continue
        x = a + (b - a) * (np.arange(40_000)[:, None] + 0.5) / 40_000
        thickness, density = frame.grown(x[:, 2])
        bare = np.repeat([section.diameter for section in member.sections], len(x) // member.elements)
        lift = (item.water.density - density) * W * np.pi / 4 * ((bare + 2 * thickness) ** 2 - bare**2)
        lift[(x[:, 2] > 0) | (x[:, 2] < frame.seabed)] = 0.0
        part = lift[:, None] * np.array([0, 0, np.linalg.norm(b - a) / 40_000])
        force, moment = force + part.sum(axis=0), moment + np.cross(x, part).sum(axis=0)
    assert still[:, :3].sum(axis=0) == approx(-force, abs=1e-4 * np.abs(force).max())
    turned = (still[:, 3:] + np.cross(places.foot, still[:, :3])).sum(axis=0)
    assert turned == approx(-moment, abs=1e-4 * np.abs(moment).max())
    assert at_rest.any()
