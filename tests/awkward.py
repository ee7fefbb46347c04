"""Small scenes unlike Buan, through which every feature goes: asymmetric, off-centre, big beside small, and so on.

Each is (scene, coefficients or None); boundary elements are coarse, for what is tested is not their error.
"""

from dataclasses import replace
from functools import cache

import numpy as np

from solver.balance import balanced
from solver.coupled.boundary import coefficients
from solver.hydrodynamics.bem.coefficients import Hydrodynamics
from solver.hydrodynamics.hull.duck import duck as duck_hull
from solver.hydrodynamics.hull.panel_hull import PanelHull
from solver.hydrodynamics.hull.revolution import Revolution
from solver.scene import Float, Platform, Scene, Settings, Water
from solver.sea.realization import realize
from solver.sea.spectrum import PiersonMoskowitz
from solver.structure.frame import Frame
from solver.structure.members import Material, Member, PointLoad, PointMass
from solver.structure.sections import solid_rectangle, tube
from solver.structure.soil import Soil, SoilSpring
from tests.once import solve

RHO, SMALL = 1025.0, 108
BALL = Revolution.hemisphere_cylinder(radius=1.0, height=0.6)
BUOYED = RHO * 2 / 3 * np.pi  # mass that floats the ball [kg]
STEEL = Material(E=2.1e11, G=8.33e10, density=7850.0)
MODEL = 1 / 20


def sea(Hs=1.0, Tp=5.5, band=(0.7, 3.4), heading=0.0, seed=4):
    return realize(PiersonMoskowitz(Hs=Hs, Tp=Tp), components=60, band=band, seed=seed, heading=heading)


def scene(floats, *, depth=50.0, waves=None, platform=None, **settings) -> Scene:
    chosen = {"duration": 200.0, "discard": 50.0, "ramp": 30.0} | settings
    waves = sea() if waves is None else waves
    return Scene(
        water=Water(depth=depth), sea=waves, floats=tuple(floats), platform=platform, settings=Settings(**chosen)
    )


def known(item: Scene, low: float, high: float, count: int = 24, panels: int = SMALL) -> Hydrodynamics:
    """Coefficients at `count` frequencies [rad/s] from coarse meshes."""
    return solve(
        tuple(f.hull for f in item.floats), np.array([f.centre for f in item.floats]), depth=item.water.depth,
        heading=item.sea.heading, omega=np.linspace(low, high, count), planar=item.planar, panels=panels,
        interaction=item.settings.interaction,
    )  # fmt: skip


def vacuum(item: Scene) -> Hydrodynamics:
    """Coefficients of floats that displace nothing, where they neither radiate, diffract nor feel waves."""
    h = coefficients(item)
    assert h is not None, "of a scene with floats"
    return replace(h, hydrostatic_stiffness=0 * h.hydrostatic_stiffness, displaced_mass=0 * h.displaced_mass)


def prism(outline: list[tuple[float, float]], width: float) -> PanelHull:
    """The closed hull of an outline in x and z, seen whole from its points' mean, over `width` in y [m]."""
    n, flat = len(outline), np.array(outline, float)
    rows = np.linspace(-width / 2, width / 2, 5)
    ring = np.array([(x, y, z) for y in rows for x, z in flat])
    middle = [(*flat.mean(axis=0),)]
    ends = np.array([(x, y, z) for y in rows[[0, -1]] for x, z in middle])
    faces = [
        (r * n + i, r * n + (i + 1) % n, (r + 1) * n + (i + 1) % n, (r + 1) * n + i)
        for r in range(len(rows) - 1) for i in range(n)
    ]  # fmt: skip
    last = (len(rows) - 1) * n
    for i in range(n):
        j = (i + 1) % n
        faces += [(i, j, len(ring), len(ring)), (last + j, last + i, len(ring) + 1, len(ring) + 1)]
    return PanelHull.of(np.concatenate([ring, ends]), np.array(faces))


@cache
def duck():
    """Beak towards the waves, c.o.g. off the reference point, hinged at the stern's axis."""
    hull = prism([(-2.4, -0.2), (-1.2, -1.0), (0, -1.2), (1.0, -0.9), (1.2, 0), (0.9, 0.8), (0, 1.0), (-1.4, 0.5)], 4.0)
    item = Float(
        name="duck", hull=hull, mass=RHO * hull.volume, inertia=(3e4, 2.5e4, 3e4), hinge=(0.5, 0, 0.0),
        arm=(-0.5, 0, 0), cog=(hull.buoyancy_point[0], 0, -0.55), pto_damping=4e4,
    )  # fmt: skip
    whole = scene([item], waves=sea(Hs=0.6))
    return whole, known(whole, 0.4, 6.0)


@cache
def big_beside_small():
    """A hull of 6 m radius beside one of 1 m, each on its hinge."""
    big = Revolution.vertical_cylinder(radius=6.0, draft=4.0, freeboard=3.0)
    floats = [
        Float(
            name="big", hull=big, mass=RHO * big.volume, inertia=(6e6,) * 3, hinge=(0, 0, 3.0), arm=(-12.0, 0, -3.0),
            pto_damping=2e7,
        ),
        Float(
            name="small", hull=BALL, mass=BUOYED, inertia=(859.0,) * 3, hinge=(0, 0, 2.6), arm=(2.36, 0, -2.6),
            pto_damping=1e5,
        ),
    ]  # fmt: skip
    whole = scene(floats, depth=100.0, waves=sea(Hs=0.8, Tp=7.0, band=(0.5, 2.2)))
    return whole, known(whole, 0.3, 4.0, 28)


@cache
def model_scale():
    """Buan's front float at 1:20."""
    ball = Revolution.hemisphere_cylinder(radius=MODEL, height=0.6 * MODEL)
    item = Float(
        name="model", hull=ball, mass=BUOYED * MODEL**3, inertia=(859.0 * MODEL**5,) * 3,
        hinge=(-1.5 * MODEL, 0, 2.6 * MODEL), arm=(-2.36 * MODEL, 0, -2.6 * MODEL), pto_damping=1e5 * MODEL**4.5,
    )  # fmt: skip
    time = np.sqrt(MODEL)
    waves = sea(Hs=1.28 * MODEL, Tp=5.46 * time, band=(0.7 / time, 3.4 / time))
    whole = scene([item], depth=2.5, waves=waves, duration=50.0, discard=12.0, ramp=8.0)
    return whole, known(whole, 0.3 / time, 7.0 / time)


@cache
def soft_mooring():
    """A barge free in its plane, whose mooring gives it a surge period of a minute."""
    hull = prism([(-5, -1.2), (5, -1.2), (5, 1.0), (-5, 1.0)], 8.0)
    mass = RHO * hull.volume
    item = Float(
        name="barge", hull=hull, mass=mass, inertia=(8e5, 1.2e6, 1.6e6), hinge=(0, 0, 0), cog=(0.2, 0, -0.3),
        motion=("surge", "heave", "pitch"), stiffness=(1.3 * mass * (2 * np.pi / 65) ** 2, 0, 0), damping=(2e3, 0, 0),
    )  # fmt: skip
    whole = scene([item], waves=sea(Hs=0.5, Tp=7.0, band=(0.6, 2.0)), froude_krylov="linear")
    return whole, known(whole, 0.3, 3.5, panels=2 * SMALL)


@cache
def flap():
    """Hinged at its foot, which would fall over but for its buoyancy."""
    hull = prism([(-0.9, -8.0), (0.9, -8.0), (0.9, 2.5), (-0.9, 2.5)], 10.0)
    item = Float(
        name="flap", hull=hull, mass=0.45 * RHO * hull.volume, inertia=(2e6, 9e5, 1.5e6), hinge=(0, 0, -9.0),
        arm=(0, 0, 9.0), cog=(0, 0, -4.0), pto_damping=2e7,
    )  # fmt: skip
    whole = scene([item], depth=11.0, waves=sea(Hs=1.0, Tp=8.0, band=(0.45, 1.6)))
    return whole, known(whole, 0.4, 3.2)


@cache
def oblique():
    """Waves at 30 degrees at a pair that is not in line with them."""
    common = {"hull": BALL, "mass": BUOYED, "inertia": (859.0,) * 3, "pto_damping": 1e5}
    floats = [
        Float(name="a", hinge=(-1.5, -2.0, 2.6), arm=(-2.36, 0, -2.6), **common),
        Float(name="b", hinge=(1.5, 1.0, 2.6), arm=(2.0, 1.25, -2.6), axis=(-0.53, 0.848, 0), **common),
    ]
    whole = scene(floats, waves=sea(Hs=0.8, heading=np.pi / 6))
    return whole, known(whole, 0.4, 6.0, 20)


def rotors(*, front=None, rear=None, **changes) -> Scene:
    """Two ducks that differ, beaks fore and aft, hinged off the middle of a moored barge that their weight trims.

    front, rear: other fields of theirs; changes: of the barge.
    """
    fields = {"motion": ("surge", "heave", "pitch"), "stiffness": (4e4, 0, 0), "damping": (4e3, 1e3, 1e4)} | changes
    barge = Float(
        name="barge", hull=prism([(-4, -1.5), (4, -1.5), (4, 1.5), (-4, 1.5)], 10.0), mass=1.0, inertia=(9e5, 7e5, 1e6),
        hinge=(0.5, 0, 0.0), arm=(-0.5, 0, 0), cog=(0, 0, -0.4), **fields,
    )  # fmt: skip
    small = duck_hull(radius=1.0, beak=2.2, elevation=0.3, submergence=0.5, width=5.0)
    large = duck_hull(radius=1.3, beak=2.6, elevation=np.pi - 0.5, submergence=0.7, width=7.0)
    first = Float(
        name="front", on="barge", hull=small, mass=0.8 * RHO * small.volume, inertia=(2e4, 1.2e4, 2e4),
        hinge=(-7.0, 0, -0.5), arm=(0, 0, 0.5), cog=(0, 0, -0.6), **{"pto_damping": 4e4, **(front or {})},
    )  # fmt: skip
    second = Float(
        name="rear", on="barge", hull=large, mass=1.0, inertia=(5e4, 3e4, 5e4), hinge=(7.5, 0, -0.6),
        arm=(0.2, 0, 0.6), cog=(0, 0, -0.7), **{"pto_damping": 6e4, **(rear or {})},
    )  # fmt: skip
    floats = balanced([barge, first, second], Water(depth=np.inf, density=RHO), [("mass", "x"), ("x",), ("mass", "x")])
    waves = sea(Hs=0.5, Tp=4.5, band=(0.8, 3.0))
    return scene(floats, depth=np.inf, waves=waves, froude_krylov="linear")


def tripod(elements: int = 2) -> Platform:
    """Three legs of unequal height under a beam, not planar, each member of few elements."""
    nodes = {"deck": (0.0, 0.3, 3.0), "hinge:float": (-1.5, 0.0, 3.0)}
    members = []
    for name, x, y, z in (("a", -4.0, -3.0, -25.0), ("b", -3.0, 4.0, -16.0), ("c", 5.0, 0.0, -25.0)):
        nodes["foot " + name] = (x, y, z)
        members.append(
            Member(
                name=name, start="foot " + name, end="deck", elements=elements, section=tube(0.6, 0.02), material=STEEL,
                drag_coefficient=1.0, inertia_coefficient=2.0,
            )
        )  # fmt: skip
    arm = Member(
        name="arm", start="deck", end="hinge:float", elements=1, section=solid_rectangle(0.4, 0.4), material=STEEL
    )
    frame = Frame(
        nodes=nodes, members=(*members, arm), clamped=("foot a", "foot b", "foot c"),
        masses=(PointMass(node="deck", mass=3e4),),
    )  # fmt: skip
    return Platform(frame=frame, legs=("a", "b", "c"), hinge_nodes={"float": "hinge:float"})


@cache
def unequal_legs():
    """A float on a platform whose legs differ, in waves at 30 degrees."""
    item = Float(
        name="float", hull=BALL, mass=BUOYED, inertia=(859.0,) * 3, hinge=(-1.5, 0, 3.0), arm=(-2.36, 0, -3.0),
        pto_damping=1e5,
    )  # fmt: skip
    whole = scene([item], depth=25.0, waves=sea(Hs=0.8, heading=np.pi / 6), platform=tripod())
    return whole, known(whole, 0.45, 6.0, 20)


def bare_legs():
    """That platform alone."""
    whole = unequal_legs()[0]
    return replace(whole, floats=(), platform=replace(whole.platform, hinge_nodes={})), None


def raking(factor=1.0, **settings):
    """Two legs that lean to each other across y = 0 and one in that plane, in waves from ahead."""
    nodes = {"deck": (0.0, 0.0, 3.0), "a": (-4.0, -3.0, -25.0), "b": (-4.0, 3.0, -25.0), "c": (5.0, 0.0, -20.0)}
    section, steel = tube(0.508, 0.016), replace(STEEL, yield_strength=355e6)
    legs = [
        Member(
            name=f"leg {foot}", start=foot, end="deck", elements=2, section=section, material=steel,
            drag_coefficient=1.0, inertia_coefficient=2.0,
        )
        for foot in "abc"
    ]  # fmt: skip
    legs[1] = replace(legs[1], moment_factor=factor)
    frame = Frame(
        nodes=nodes, members=tuple(legs), clamped=("a", "b", "c"), masses=(PointMass(node="deck", mass=3e4),),
        loads=(PointLoad(node="deck", force=(2e4, 0.0, -9e5)),),
    )  # fmt: skip
    platform = Platform(frame=frame, legs=("leg a", "leg b", "leg c"))
    return scene(
        [],
        depth=25.0,
        platform=platform,
        **{"outputs": ("utilisation",), "time_step": 0.1, "duration": 60.0, **settings},
    )


@cache
def soft_ground():
    """That float and platform on springs, with a leaning deck and legs that shear: one pinned and half held, one off
    its nodes, one tapered."""
    whole, h = unequal_legs()
    frame = whole.platform.frame
    members = [replace(m, section=replace(m.section, shear_factor=0.3)) for m in frame.members]
    members[0] = replace(members[0], end_release=("T", "My", "Mz"), end_spring=(0, 0, 0, 0, 2e7, 4e7))
    members[1] = replace(members[1], start_offset=(0.3, -0.2, 0.5), end_offset=(-0.4, 0.5, -0.6))
    members[2] = replace(members[2], end_section=replace(tube(0.45, 0.015), shear_factor=0.35))
    pile = np.diag([6e7, 6e7, 4e8, 5e8, 5e8, 2e8])  # a pile's head, whose shift and turn go together
    pile[0, 4] = pile[4, 0] = -1.2e8
    pile[1, 3] = pile[3, 1] = 1.2e8
    deck = PointMass(
        node="deck", mass=3e4, cog=(0.5, -0.4, 1.5), inertia=(8e4, 9e4, 1.2e5), products_of_inertia=(5e3, -4e3, 3e3)
    )
    soft = {"foot a": (5e7, 8e7, 3e8, 4e8, 3e8, 1e8), "foot b": tuple(map(tuple, pile.tolist()))}
    stands = replace(frame, members=tuple(members), masses=(deck,), clamped=("foot c",), foundation=soft)
    return replace(whole, platform=replace(whole.platform, frame=stands)), h


@cache
def on_piles():
    """That float and platform, whose legs go on below the seabed as two leaning piles, one on a spring at its tip."""
    whole, h = unequal_legs()
    frame = whole.platform.frame
    piles = {"a": (-6.0, -4.0, -40.0), "c": (5.0, 0.0, -33.0)}
    nodes = {**frame.nodes, **{f"tip {leg}": place for leg, place in piles.items()}}
    driven = tuple(
        replace(frame.members[0], name=f"pile {leg}", start=f"tip {leg}", end=f"foot {leg}", elements=4)
        for leg in piles
    )
    springs = (
        SoilSpring(depth=0.0, lateral=1e6, axial=2e6, torsional=1e6),
        SoilSpring(depth=6.0, lateral=3e7, axial=8e6, torsional=1e7),
    )
    stands = replace(
        frame, nodes=nodes, members=(*frame.members, *driven), clamped=("foot b",),
        foundation={"tip c": (0.0, 0.0, 5e7, 0.0, 0.0, 0.0)}, soil=Soil(seabed=-25.0, springs=springs),
    )  # fmt: skip
    return replace(whole, platform=replace(whole.platform, frame=stands)), h


SCENES = {
    f.__name__: f
    for f in (duck, big_beside_small, model_scale, soft_mooring, flap, oblique, unequal_legs, bare_legs)
}  # fmt: skip
