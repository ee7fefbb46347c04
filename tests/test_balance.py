"""Warnings about scenes: weight against displacement along each axis of a joint."""

from dataclasses import replace

import numpy as np
import pytest

from solver.balance import balanced, held, imbalance
from solver.errors import InputError, SimulationFailed
from solver.hydrodynamics.hull.duck import duck
from solver.hydrodynamics.hull.panel_hull import PanelHull
from solver.hydrodynamics.hull.revolution import Revolution
from solver.mooring import Line, Mooring, line_pulls
from solver.oddities import warnings
from solver.run import simulate
from solver.scene import EndStops, Float, Scene, Settings, Water
from solver.sea.realization import CALM, measured, regular
from solver.statistics import STATISTICS
from tests.awkward import sea
from tests.hydrodynamics.shapes import fine_box

DEEP = Water(depth=np.inf, density=1000.0)
SPHERE = Revolution.sphere(radius=5.0, draft=5.0)
DISPLACED = 1000 * 2 / 3 * np.pi * 125


def ball(**changes):
    fields = {"mass": DISPLACED, "hinge": (0, 0, 0), "arm": (0, 0, 0), "motion": ("heave",)} | changes
    return Float(name="ball", hull=SPHERE, inertia=(2.6e6,) * 3, **fields)


@pytest.mark.parametrize(("share", "count"), [(0.991, 0), (1.009, 0), (0.988, 1), (1.012, 1)])
@pytest.mark.parametrize("joint", [{}, {"motion": ("hinge",), "hinge": (-20, 0, 3), "arm": (20, 0, -3)}])
def test_one_percent_of_the_weight_is_the_limit(share, count, joint):
    odd = imbalance(ball(mass=share * DISPLACED, **joint), DEEP)
    assert len(odd) == count
    assert all(f"mass {share * DISPLACED:g} kg, displaced {DISPLACED:g} kg" in text for text in odd)


def test_a_preload_or_lines_that_are_the_reason_are_named():
    """By themselves where weight and buoyancy balance each other."""
    told = "floats.ball is out of equilibrium: {}. It settles before the run begins"
    down = Mooring(stiffness=((0.0,) * 6,) * 6, pretension=(0.0, 0.0, -2e5, 0.0, 0.0, 0.0))
    held, pulled = "along heave a preload of -1e+05 N", "a pull of mooring or lines of -2e+05 N"
    assert imbalance(ball(preload=-1e5), DEEP) == (told.format(held),)
    assert imbalance(ball(mooring=down), DEEP) == (told.format(f"along heave {pulled}"),)
    assert imbalance(ball(preload=-1e5, mooring=down), DEEP) == (told.format(f"{held} and {pulled}"),)
    hinge = {"motion": ("hinge",), "hinge": (-20, 0, 3), "arm": (20, 0, -3)}
    assert imbalance(ball(**hinge, preload=4e6), DEEP) == (told.format("along hinge a preload of 4e+06 N m"),)
    (text,) = imbalance(ball(**hinge, preload=4e6, mass=0.9 * DISPLACED), DEEP)
    assert "(-10.00%); hinge: moment of weight " in text and "; along hinge a preload of 4e+06 N m. It" in text
    assert "along" not in imbalance(ball(mass=0.9 * DISPLACED), DEEP)[0]
    both = imbalance(ball(mass=1.008 * DISPLACED, preload=-0.008 * DISPLACED * DEEP.gravity), DEEP)[0]
    assert "(+0.80%); along heave a preload of " in both  # neither of which is out of balance by itself


def test_water_does_not_hold_what_is_wholly_under_it():
    """A box whose tether was forgotten: boundary elements would be solved for a run that finds no equilibrium."""
    box = Float(
        name="box", hull=fine_box((4.0, 4.0, 2.0), (0.0, 0.0, -6.0), 1.0), mass=3e4, inertia=(1e5,) * 3,
        hinge=(0, 0, 0), motion=("heave",),
    )  # fmt: skip
    (told,) = imbalance(box, DEEP)
    assert told.endswith(
        "before the run begins, if springs or lines hold it: water does not hold what is wholly under it"
    )
    assert not imbalance(replace(box, mass=3.2e4), DEEP)


def test_mass_that_balances_a_pull_is_no_reason():
    """Heave is in balance by both; surge and pitch are not, pitch by the pull or by where the weight is."""
    whole = (4e4, 0.0, -2e5, 0.0, 2e6, 0.0)
    item = ball(motion=("surge", "heave", "pitch"), mooring=Mooring(stiffness=((0.0,) * 6,) * 6, pretension=whole))
    (found,) = balanced([item], DEEP, [("mass",)])
    assert abs(found.mass / DISPLACED - 1) > 0.03
    surge, pitch = (f"along {name} a pull of mooring or lines of" for name in ("surge", "pitch"))
    assert imbalance(found, DEEP) == (
        f"floats.ball is out of equilibrium: {surge} 4e+04 N; {pitch} 2e+06 N m. It settles before the run begins",
    )
    (text,) = imbalance(replace(found, cog=(1.0, 0.0, -1.0)), DEEP)
    assert f"{surge} 4e+04 N; pitch: moment of weight " in text and "kg" not in text


def test_a_pretension_summed_over_lines_leaves_rounding_alone():
    """Of tethers whose pulls along surge cancel but for that."""
    pulls = Mooring(stiffness=((0.0,) * 6,) * 6, pretension=(-1e-10, 2e-10, 0.0, 0.0, 0.0, 0.0))
    item = ball(motion=("surge", "sway", "heave"), mooring=pulls)
    assert imbalance(item, DEEP) == ()
    (text,) = imbalance(replace(item, mooring=replace(pulls, pretension=(-1.0, 2e-10, 0.0, 0.0, 0.0, 0.0))), DEEP)
    assert "surge" in text and "sway" not in text


def line(angle, length=128.0):
    """Of a spread mooring, its fairlead 4 m and its anchor 120 m from the middle."""
    x, y = np.cos(angle), np.sin(angle)
    ends = {"anchor": (120 * x, 120 * y, -40.0), "fairlead": (4 * x, 4 * y, -1.0)}
    return Line(**ends, length=length, weight=600.0, EA=2e8)


@pytest.mark.parametrize("count", [2, 3, 4])
@pytest.mark.parametrize("start", [0.0, np.pi / 2])
def test_lines_that_balance_each_other_leave_rounding_alone(count, start):
    """And balance = "mass" leaves nothing of what they pull down."""
    lines = tuple(line(round(start + 2 * np.pi * i / count, 6)) for i in range(count))
    item = ball(motion=("surge", "sway", "heave"), cog=(0, 0, -1), lines=lines)
    (found,) = balanced([item], DEEP, [("mass",)])
    assert np.abs(found.pulls[:2]).max() > 0 and imbalance(found, DEEP) == ()
    carried = (rotor(on="raft", motion=()), replace(item, on="rotor", motion=("heave",)))
    floats = balanced([raft(), *carried], DEEP, [("mass", "x", "y"), (), ()])
    assert imbalance(floats[0], DEEP, floats) == ()


def test_a_line_that_pulls_by_more_than_the_others_is_told():
    """By its pull alone: mass and displacement, 4 % apart by what lines pull down, are no reason for it."""
    lines = (line(0.0, length=127.0), line(np.pi))
    item = ball(motion=("surge", "heave"), cog=(0, 0, -1), lines=lines)
    (found,) = balanced([item], DEEP, [("mass",)])
    (text,) = imbalance(found, DEEP)
    pull = f"along surge a pull of mooring or lines of {found.pulls[0]:.4g} N"
    assert text == f"floats.ball is out of equilibrium: {pull}. It settles before the run begins"


def tied(strain, scale=1.0, EA=1e6, **changes):
    """Off the middle on an arm, two lines nearly without weight: one at ease, one that its straight way strains."""
    centre, way = np.array([4.0, 1.0, 0.0]), np.array([-30.0, 12.0, -40.0])
    L, lines = np.linalg.norm(way), []
    for fairlead, length in (((2.0, 0, -1), 1.02 * L), ((-1.0, 2, 0), L / (1 + strain))):
        anchor = tuple(scale * (centre + fairlead + way))
        at = {"anchor": anchor, "fairlead": tuple(scale * np.array(fairlead)), "length": scale * length}
        lines.append(Line(**at, weight=1e-3 * scale**2, EA=EA * scale**3))
    joint = {"hinge": tuple(scale * np.array([-3.0, 0, 2])), "arm": tuple(scale * np.array([7.0, 1, -2]))}
    hull = Revolution.sphere(radius=5 * scale, draft=5 * scale)
    fields = {"mass": 1000 * hull.volume, "motion": ("pitch", "heave"), "lines": tuple(lines)} | joint | changes
    return Float(name="ball", hull=hull, inertia=(2.6e6 * scale**5,) * 3, **fields)


@pytest.mark.parametrize("scale", [1.0, 1 / 30])
def test_a_line_that_is_strained_at_rest_is_told(scale):
    """By 5 % or more, of its length without tension, however light the line and whatever the scale."""
    told = [warnings(Scene(water=DEEP, sea=CALM, floats=(tied(strain, scale),))) for strain in (0.0495, 0.0505)]
    slack, taut = ([text for text in texts if text.startswith("floats.ball.lines: ")] for texts in told)
    L = scale * np.sqrt(30**2 + 12**2 + 40**2)
    number, apart = f"line 2 is strained by 0.051 at rest, {0.0505e6 * scale**3:.4g} N", f"it spans {L:.4g} m"
    assert slack == [] and len(taut) == 1 and number in taut[0] and apart in taut[0]


@pytest.mark.parametrize("scale", [1.0, 1 / 30])
def test_a_line_that_is_slack_at_rest_is_told(scale):
    """Longer than the water is deep and the anchor far, or on a heap; not a tether upright."""
    item = tied(0.0, scale)
    upright = replace(item.lines[0], anchor=(*(item.centre + item.lines[0].fairlead)[:2], -40.0 * scale))
    lines = {share: replace(item.lines[1], length=share * scale * (40 + np.hypot(30, 12))) for share in (0.999, 1.001)}
    lines |= {"tether": replace(upright, length=38.9 * scale), "heap": replace(upright, length=39.1 * scale)}
    told = {}
    for name, line in lines.items():
        scene = Scene(water=DEEP, sea=CALM, floats=(replace(item, lines=(item.lines[0], line)),))
        told[name] = [text for text in warnings(scene) if "slack at rest" in text]
    assert told[0.999] == told["tether"] == []
    assert all(len(told[name]) == 1 and "lines: line 2 is slack" in told[name][0] for name in (1.001, "heap"))


@pytest.mark.parametrize("scale", [1.0, 1 / 30])
@pytest.mark.parametrize("preload", [0.0, -1e5])
def test_lines_that_pull_a_float_under_are_named(scale, preload):
    """In place of what it carries, which is nothing; beside a preload, if there is one."""
    item = tied(0.6, scale, EA=1e7, preload=(0.0, preload * scale**3))
    with pytest.raises(InputError) as caught:
        balanced([item], DEEP, [("mass",)])
    down = (
        f"a pull of mooring or lines of {item.pulls[1] - preload * scale**3:.4g} N; line 2 is strained by 0.6 at rest"
    )
    held = f"a preload of {preload * scale**3:.4g} N and " if preload else ""
    assert caught.value.key == "floats.ball.mass" and "carries" not in caught.value.limit
    assert f" N, do not bear along heave {held}{down}" in caught.value.limit
    assert item.pulls[1] < -DISPLACED * scale**3 * DEEP.gravity


def test_what_a_float_carries_is_told_where_that_is_out_of_balance():
    """A raft that balances under a rotor on another, both too light; one sentence of heave, roll and pitch together."""
    (base,) = balanced([raft()], DEEP, [("mass", "x", "y")])
    first, second = rotor("first", (-20.0, 4.0)), rotor("second", (15.0, -3.0), AFT, on="first")
    floats = (base, replace(first, on="raft"), second)
    (text,) = imbalance(base, DEEP, floats)
    mass, displaced = sum(f.mass for f in floats), 1000 * sum(f.hull.volume for f in floats)
    own = f"mass {base.mass:g} kg, displaced {base.mass:g} kg (+0.00%)"
    both = f"with first, second: mass {mass:g} kg, displaced {displaced:g} kg ({mass / displaced - 1:+.2%})"
    assert text.startswith(f"floats.raft is out of equilibrium: {own}; {both}; roll: moment of weight and of what it")
    assert "; pitch: moment of weight and of what it carries" in text and text.count("kg (") == 2
    (text,) = imbalance(second, DEEP, floats)
    assert "with" not in text and "carries" not in text


def test_what_heaves_on_a_float_presses_on_it_by_its_preload_alone():
    """A ball in a guide on a rotor on the raft: its weight and load are its own affair, 3e6 N that keep it up are the
    raft's."""
    joint = {"on": "rotor", "cog": (0, 0, -2.0), "hinge": (-20.0, 4.0, 0)}
    light = ball(mass=0.5 * DISPLACED, preload=3e6, **joint)
    (base,) = balanced([raft()], DEEP, [("mass", "x", "y")])
    arm = rotor(at=(-20.0, 4.0), on="raft", mass=1000 * ROTOR.volume, motion=())
    load = rotor("load", (-20.0, 4.0), on="ball", motion=())
    (text,) = imbalance(base, DEEP, (base, arm, light, load))
    assert (
        "with rotor: mass" in text and "; along heave loads of joints and lines of what it carries of -3e+06 N" in text
    )
    assert "loads of" not in "".join(imbalance(base, DEEP, (base, arm, replace(light, preload=0.0))))


@pytest.mark.parametrize(("motion", "arm"), [("surge", 0), ("pitch", 0), ("yaw surge", 0), ("hinge", 20)])
def test_what_cannot_move_up_and_down_is_not_weighed(motion, arm):
    """A vertical hinge axis carries any weight, and so does a pitch axis below it."""
    held = {"motion": tuple(motion.split()), "axis": (0, 0, 1), "hinge": (-arm, 0, 0), "arm": (arm, 0, 0)}
    item = ball(mass=0.5 * DISPLACED, **held)
    assert imbalance(item, DEEP) == ()


def test_an_eccentric_mass_tilts_what_may_pitch():
    """0.06 m of 5 m is more than a hundredth of the radius."""
    assert imbalance(ball(cog=(0.04, 0, -2), motion=("heave", "pitch")), DEEP) == ()
    (text,) = imbalance(ball(cog=(0.06, 0, -2), motion=("heave", "pitch")), DEEP)
    assert "pitch: moment of weight" in text
    assert imbalance(ball(cog=(0.06, 0, -2)), DEEP) == ()


def test_notes_of_the_sea_are_told():
    t = np.arange(50.0)
    sea = measured(time=t, elevation=np.cos(t), band=(0.5, 2.0))
    calm = Scene(water=DEEP, sea=CALM, floats=(ball(),))
    assert warnings(calm) == ()
    assert [text.split(":")[0] for text in warnings(replace(calm, sea=sea))] == ["sea"]


ROTOR = duck(radius=3.0, beak=6.0, elevation=0.5, submergence=1.5, width=8.0)
AFT = duck(radius=3.0, beak=6.0, elevation=np.pi - 0.5, submergence=1.5, width=8.0)
HULL = Revolution.vertical_cylinder(radius=6.0, draft=5.0, freeboard=3.0)


def rotor(name="rotor", at=(-20.0, 0.0), hull=ROTOR, **changes):
    fields = {"mass": 0.8 * 1000 * hull.volume, "cog": (0, 0, -1.0), "hinge": (*at, -1.5), "arm": (0, 0, 1.5)} | changes
    return Float(name=name, hull=hull, inertia=(2e6,) * 3, **fields)


def raft(**changes):
    """A moored hull under whatever it carries, free in all six motions."""
    fields = {"mass": 1.0, "hinge": (2.0, 1.0, 0.0), "arm": (-2.0, -1.0, 0.0), "cog": (0, 0, -2.0)} | changes
    motion = ("surge", "sway", "heave", "roll", "pitch", "yaw")
    fields = {"motion": motion, "stiffness": (1e5, 1e5, 0, 0, 0, 1e7)} | fields
    return Float(name="raft", hull=HULL, inertia=(5e6,) * 3, **fields)


def test_a_rotor_of_given_mass_has_its_weight_where_its_moment_is_that_of_the_buoyancy():
    """m x_g = rho V x_b about the axis, which lies below the reference point."""
    (found,) = balanced([rotor()], DEEP, [("x",)])
    assert found.cog == pytest.approx((ROTOR.buoyancy_point[0] / 0.8, 0, -1.0), rel=1e-12)
    assert found.mass == 0.8 * 1000 * ROTOR.volume
    assert len(imbalance(rotor(), DEEP)) == 1 and imbalance(found, DEEP) == ()


def test_mass_and_place_together():
    (found,) = balanced([rotor()], DEEP, [("mass", "x", "y")])
    assert found.mass == pytest.approx(1000 * ROTOR.volume, rel=1e-12)
    assert found.cog == pytest.approx((*ROTOR.buoyancy_point[:2], -1.0), abs=1e-12)
    assert found.cog[1] == 0.0


@pytest.mark.parametrize("k", [0, 1])
def test_about_an_oblique_axis_either_place_will_do(k):
    item = rotor(axis=(0.6, 0.8, 0.1), cog=(0.3, -0.2, -1.0))
    (found,) = balanced([item], DEEP, ["xy"[k]])
    assert found.cog[1 - k] == item.cog[1 - k] and found.cog[k] != item.cog[k]
    weight, buoyancy = (
        found.mass * (found.centre + found.cog - found.hinge),
        1000 * ROTOR.volume * (found.centre + ROTOR.buoyancy_point - found.hinge),
    )
    assert np.cross(weight - buoyancy, [0, 0, 1.0]) @ [0.6, 0.8, 0.1] == pytest.approx(0, abs=1e-6)


def test_a_platform_bears_what_its_rotors_weigh_in_water():
    """Two light rotors that differ, one of them locked, aside of the middle: force and moments by hand."""
    light, locked = rotor(at=(-20.0, 4.0)), rotor("locked", (15.0, -3.0), AFT, motion=(), mass=1e5)
    light = replace(light, on="raft")
    locked = replace(locked, on="raft")
    base, first, second = balanced([raft(), light, locked], DEEP, [("mass", "x", "y"), ("x",), ()])
    lift = 0.2 * 1000 * ROTOR.volume  # kg, of the light one at its hinge
    down, up = 1e5 * np.array([15.0, -3.0]), 1000 * AFT.volume * (np.array([15.0, -3.0]) + AFT.buoyancy_point[:2])
    mass = 1000 * HULL.volume + lift + 1000 * AFT.volume - 1e5
    assert base.mass == pytest.approx(mass, rel=1e-12)
    assert base.cog == pytest.approx((*((lift * np.array([-20.0, 4.0]) + up - down) / mass), -2.0), rel=1e-12)
    assert second == locked and first.cog[0] == pytest.approx(ROTOR.buoyancy_point[0] / 0.8)
    for item in (base, first, second):
        assert imbalance(item, DEEP, (base, first, second)) == ()


def test_lines_that_pull_are_balanced_too():
    """1e5 N down where a float's buoyancy is, 3 m from its joint: that much less mass, in the same place."""
    down = (0.0, 0.0, -1e5, 0.0, 0.0, 0.0)
    lines = Mooring(stiffness=((0.0,) * 6,) * 6, pretension=down)
    item = ball(arm=(3.0, 0, 0), motion=("heave", "pitch"), mooring=lines)
    (found,) = balanced([item], DEEP, [("mass", "x")])
    assert found.mass == pytest.approx(DISPLACED - 1e5 / DEEP.gravity)
    assert found.centre[0] + found.cog[0] - found.hinge[0] == pytest.approx(3.0)
    assert imbalance(found, DEEP) == ()


def test_a_held_float_has_the_load_that_is_missing():
    """A ball 20 t too light, a rotor; what is held twice is held as once."""
    light = ball(mass=DISPLACED - 2e4, preload=500.0)
    (kept,) = balanced([light], DEEP, [("hold",)])
    assert kept.preload == pytest.approx((-2e4 * DEEP.gravity,)) and kept.mass == light.mass
    assert len(imbalance(light, DEEP)) == 1 and imbalance(kept, DEEP) == ()
    assert balanced([kept], DEEP, [("hold",)])[0].preload == pytest.approx(kept.preload)
    (turned,) = balanced([rotor(cog=(0.7, 0, -1.0))], DEEP, [("hold",)])
    about = 1000 * ROTOR.volume * DEEP.gravity * (0.8 * 0.7 - ROTOR.buoyancy_point[0])  # of weight less buoyancy
    assert turned.preload == pytest.approx((-about,))


@pytest.mark.parametrize("share", [1e-3, 0.49, 0.51, 1.0, 1.99, 2.01, 1e3])
@pytest.mark.parametrize("joint", [{}, {"motion": ("hinge",), "hinge": (-20, 0, 3), "arm": (20, 0, -3)}])
def test_a_mass_of_another_order_that_is_held_is_told(share, joint):
    """Where its weight is beyond a half to twice the buoyancy: the load that holds it is more than either."""
    (kept,) = balanced([ball(mass=share * DISPLACED, **joint)], DEEP, [("hold",)])
    told = warnings(Scene(water=DEEP, sea=CALM, floats=(kept,)))
    assert len(told) == (not 0.5 <= share <= 2)
    assert all(f"{'hinge' if joint else 'heave'} holds what weight" in text for text in told)
    assert all(f"mass {share * DISPLACED:g} kg, displaced {DISPLACED:g} kg" in text for text in told)


def test_loads_that_balance_no_weight_are_not_weighed():
    """A pretension in surge, a twist in yaw, a trim of a spar about its middle."""
    loads = {"motion": ("surge", "heave", "yaw"), "preload": (1e9, 0.0, 1e9)}
    assert held(ball(**loads), DEEP) == ()
    assert held(ball(motion=("pitch",), cog=(0.5, 0, -2), preload=(DISPLACED * 9.81 * 0.5,)), DEEP) == ()


def test_what_a_float_is_held_with_its_carrier_bears():
    """A guide on a raft that keeps a light ball down: the raft lifts what the ball does not weigh."""
    base, light = balanced([raft(), replace(ball(mass=0.5 * DISPLACED), on="raft")], DEEP, [("mass",), ("hold",)])
    assert base.mass == pytest.approx(1000 * HULL.volume + 0.5 * DISPLACED)
    assert light.preload == pytest.approx((-0.5 * DISPLACED * DEEP.gravity,))


def test_what_holds_a_float_up_its_carrier_bears():
    """Lines to its carrier or a preload of 0.9 of what it displaces; of what cannot heave, a line to the seabed."""
    half = {"mass": 0.1 * DISPLACED, "on": "raft"}
    held = 0.9 * DISPLACED * DEEP.gravity
    lines = Mooring(stiffness=((0.0,),), pretension=(-held,))
    for joint in (
        {"preload": -held},
        {"mooring": lines},
        {"preload": -2 * held, "mooring": replace(lines, pretension=(held,))},
    ):
        base, _ = balanced([raft(), ball(**half | joint)], DEEP, [("mass",), ()])
        assert base.mass == pytest.approx(1000 * HULL.volume + 0.9 * DISPLACED)
    item = ball(motion=("pitch",), on="raft", hinge=(3.0, 0, 0), lines=(line(0.4, length=126.0),))
    ((x, y, z),) = line_pulls(item.lines, item.centre)
    floats = balanced([raft(hinge=(0, 0, 0), arm=(0, 0, 0)), item], DEEP, [("mass",), ()])
    assert floats[0].mass == pytest.approx(1000 * HULL.volume + z / DEEP.gravity)
    (text,) = imbalance(floats[0], DEEP, floats)
    told = "along {} loads of joints and lines of what it carries of {:.4g} N"
    assert told.format("surge", x) in text and told.format("sway", y) in text and told.format("heave", z) not in text
    assert balanced(floats, DEEP, [("hold",), ()])[0].preload[:2] == pytest.approx((-x, -y))
    (text,) = imbalance(replace(floats[0], motion=("surge",), stiffness=1e5), DEEP, floats)
    assert told.format("surge", x) in text and "kg" not in text  # what cannot move up and down is not weighed


@pytest.mark.parametrize("axes", [("pitch",), ("heave", "pitch"), ("surge", "pitch"), ("heave",)])
def test_the_solver_finds_at_rest_what_lines_of_a_carried_float_were_balanced_with(axes):
    """By its own statics: a ball held by lines to the seabed and to the raft that carries it, which is held, too."""
    from solver.coupled.preparation import prepare

    n, motion = len(axes), ("surge", "sway", "heave", "roll", "pitch", "yaw")
    kept = Mooring(stiffness=tuple(map(tuple, 1e7 * np.eye(n))), pretension=tuple(3e4 * np.arange(1, n + 1)))
    base = raft(
        mass=1000 * HULL.volume, motion=motion, stiffness=(1e7, 1e7, 0, 1e8, 1e8, 1e8), hinge=(0, 0, 0), arm=(0, 0, 0)
    )
    item = ball(
        motion=axes,
        on="raft",
        hinge=(16.0, 2.0, 1.0),
        arm=(0, 0, -1.0),
        mooring=kept,
        lines=(line(0.4, 126.0), line(2.0)),
    )
    floats = balanced([base, item], DEEP, [("mass", "hold"), ("hold",)])
    assert [imbalance(f, DEEP, floats) for f in floats] == [(), ()]
    scene = Scene(water=DEEP, floats=floats, settings=Settings(diffraction=False, radiation=False))
    rest, _ = prepare(scene, None).equilibrium
    assert np.abs(rest).max() < 1e-5  # the quadrature's of the buoyancy


@pytest.mark.parametrize(("motion", "borne"), [(("heave",), 1), (("heave", "pitch"), 0)])
def test_the_moment_that_no_axis_of_a_float_takes_its_carrier_bears(motion, borne):
    """Of a ball in a guide, whose weight is off its middle; where it pitches by itself, that moment turns it alone."""
    joint = {"on": "raft", "hinge": (3.0, 0, 0), "cog": (0.4, 0, -1.0), "motion": motion}
    base, _ = balanced([raft(), ball(**joint)], DEEP, [("mass", "x", "y"), ()])
    level, _ = balanced([raft(), ball(**joint | {"cog": (0, 0, -1.0)})], DEEP, [("mass", "x", "y"), ()])
    assert base.mass == level.mass == pytest.approx(1000 * HULL.volume)
    assert base.cog[0] - level.cog[0] == pytest.approx(-borne * 0.4 * DISPLACED / base.mass)


@pytest.mark.parametrize(
    "sought",
    [[("mass", "x", "y"), ("x",), ("mass", "x")], [("mass", "x", "y"), ("hold",), ("hold",)], [("hold",)] * 3],
)
def test_the_solver_finds_what_was_balanced_at_rest(sought):
    """Its own statics, on another path: joints and platform stay where they are."""
    from solver.coupled.preparation import prepare
    from solver.hydrodynamics.bem import bem

    floats = balanced(
        [raft(), replace(rotor(at=(-20.0, 4.0)), on="raft"), replace(rotor("aft", (15.0, -9.0), AFT), on="raft")],
        DEEP, sought,
    )  # fmt: skip
    assert [imbalance(item, DEEP, floats) for item in floats] == [(), (), ()]
    scene = Scene(water=DEEP, floats=floats, settings=Settings(diffraction=False, radiation=False))
    known = bem.solve(
        tuple(f.hull for f in floats), np.array([f.centre for f in floats]), depth=np.inf, density=1000.0,
        omega=np.array([0.8, 1.2]), planar=False, panels=108,
    )  # fmt: skip
    rest, _ = prepare(scene, known).equilibrium
    assert np.abs(rest).max() < 1e-9


OBLIQUE = [((1, 1, 0), "pitch"), ((1, 1, 0), "roll"), ((1, -2, 0.7), "yaw"), ((1, 0.4, 2), "pitch")]


@pytest.mark.parametrize(("axis", "other"), OBLIQUE)
@pytest.mark.parametrize("sought", ["hold", "xy"])
def test_loads_about_axes_that_are_no_right_angle_apart_rest_in_what_carries_them(axis, other, sought):
    """By the solver's own statics: an arm that turns about two axes, held, on a raft that is held, or has its c.o.g.
    where nothing turns it."""
    from solver.coupled.preparation import prepare

    base = Float(
        name="raft", hull=fine_box((6.0, 6.0, 3.0), (0, 0, 0), 1.5), mass=54000.0, inertia=(2e5,) * 3, hinge=(0, 0, 0),
        motion=("roll", "pitch"), stiffness=(1e5, 1e5),
    )  # fmt: skip
    arm = Float(
        name="arm", hull=Revolution.sphere(radius=1.0, draft=1.0), mass=5000.0, inertia=(2e3,) * 3, on="raft",
        hinge=(4, 0, 0), arm=(3, 2, 0), axis=axis, motion=("hinge", other), stiffness=(1e5, 1e5),
    )  # fmt: skip
    floats = balanced([base, arm], DEEP, [("hold",) if sought == "hold" else ("x", "y"), ("hold",)])
    scene = Scene(water=DEEP, floats=floats, settings=Settings(diffraction=False, radiation=False))
    rest, _ = prepare(scene, None).equilibrium
    assert np.abs(rest).max() < 1e-5  # the quadrature's of the buoyancy; a tenth of a radian by a load that is amiss
    assert [imbalance(item, DEEP, floats) for item in floats] == [(), ()]


def test_all_moments_of_what_two_axes_hold_go_to_the_carrier():
    """(7, 2) m from its middle the raft bears the arm's weight less its buoyancy, whatever axes hold that."""
    arm = ball(
        mass=DISPLACED + 2e4, on="raft", hinge=(4, 0, 0), arm=(3, 2, 0), axis=(1, 1, 0), motion=("hinge", "pitch")
    )
    base, _ = balanced([raft(mass=1000 * HULL.volume, hinge=(0, 0, 0), arm=(0, 0, 0)), arm], DEEP, [("hold",)] * 2)
    load = 2e4 * DEEP.gravity
    assert base.preload == pytest.approx((0, 0, load, 2 * load, -7 * load, 0), abs=1e-6 * load)


@pytest.mark.parametrize("twist", [0.0, 1e6])
def test_a_preload_along_a_hinge_that_is_not_level_is_balanced_by_weight(twist):
    """And so is what a ball that it carries twists it by about the vertical."""
    item, carried = rotor(axis=(0.6, 0.8, 0.5), preload=3e5), ball(on="rotor", motion=("yaw",), preload=twist)
    found, _ = balanced([item, carried], DEEP, [("x", "y"), ()])
    weight, buoyancy = (
        -found.mass * DEEP.gravity * (found.centre + found.cog - found.hinge),
        1000 * ROTOR.volume * DEEP.gravity * (found.centre + ROTOR.buoyancy_point - found.hinge),
    )
    about = item.direction("hinge")
    assert np.cross(weight + buoyancy, [0, 0, 1.0]) @ about == pytest.approx(-3e5 + twist * about[2])


@pytest.mark.parametrize(
    ("floats", "sought", "key", "words"),
    [
        ([rotor(axis=(1, 0, 0))], ["x"], "floats.rotor.cog", "does not turn the float about its hinge's axis"),
        (
            [raft(), replace(rotor(mass=2e6), on="raft")],
            [("mass",), ()],
            "floats.raft.mass",
            r"do not bear what the float carries, -[\d.e+]+ N$",
        ),
    ],
)
def test_what_no_weight_balances_is_refused(floats, sought, key, words):
    with pytest.raises(InputError, match=words) as caught:
        balanced(floats, DEEP, sought)
    assert caught.value.key == key


def capsizing(aside=0.01, **changes):
    """A cylinder in roll whose weight and springs do not right it, a little out of balance."""
    item = Float(
        name="can", hull=Revolution.vertical_cylinder(radius=1.8, draft=1.5, freeboard=1.5), mass=15268.0,
        inertia=(2e4,) * 3, hinge=(0.0, 0.0, 0.0), cog=(0.0, aside, 0.0), motion=("roll",), damping=1e4, **changes,
    )  # fmt: skip
    settings = Settings(duration=5.0, discard=0.0, ramp=0.0, radiation=False, diffraction=False)
    return Scene(water=DEEP, floats=(item,), settings=settings)


def test_a_float_that_rests_on_its_side_is_told_or_refused():
    """Coefficients are of where it is given; beyond a right angle nothing is."""
    text = simulate(capsizing(stiffness=26e3), None).attrs["warnings"]
    assert text.startswith("floats.can rests at -") and "rad of roll from where it is given" in text
    assert "warnings" not in simulate(capsizing(stiffness=40e3), None).attrs
    with pytest.raises(SimulationFailed, match=r"can roll rests at -1\.57 in still water, beyond -1\.57 to \+1\.57"):
        simulate(capsizing(aside=0.3), None)


@pytest.mark.parametrize("scale", [1.0, 1 / 30])
@pytest.mark.parametrize(
    ("low", "high", "way"), [(0.02, 0.5, 1), (-0.3, -0.01, -1), (0.0, 0.5, 0), (-0.1, 0.5, 0), (0.02, 0.5, 0)]
)
def test_end_stops_that_leave_out_the_rest_are_told(low, high, way, scale):
    """Before a run and of its record, of the axis that has them; not where they begin at it, nor of a damper alone."""
    damper = way == 0 and low > 0
    stops = EndStops(
        lower=(-scale, low), upper=(scale, high), damping=(scale**2.5, scale**4.5),
        stiffness=(1e4 * scale**2, 0.0 if damper else 1e6 * scale**4),
    )  # fmt: skip
    axes = {"motion": ("heave", "hinge"), "damping": (1e4 * scale**2.5, 1e6 * scale**4.5)}
    item = tied(0.0, scale, cog=(0, 0, -scale), end_stops=stops, lines=(), **axes)
    settings = Settings(duration=1.0, discard=0.0, ramp=0.0, radiation=False, diffraction=False)
    scene = Scene(water=DEEP, floats=balanced([item], DEEP, [("mass", "x")]), settings=settings)
    record = simulate(scene, None)
    rest, told = record.variables["rotation"][1][0, 2], record.attrs.get("warnings", "")
    if way:
        (before,), words = (
            warnings(scene),
            f"{low:+g} to {high:+g} rad of hinge leave out its rest, 0: a stop pushes it",
        )
        assert before == f"floats.ball.end_stops: {words} away before the run begins"
        assert told == f"floats.ball.end_stops: {words} away to {rest:+.3g} before the run begins" and way * rest > 1e-3
    else:
        assert warnings(scene) == () and told == "" and abs(rest) < 1e-9


def test_a_slip_of_a_mesh_is_told_of_its_float():
    """One small face is missing of the second of two boxes."""
    whole = fine_box((4.0, 4.0, 2.0), (0, 0, 0), 0.25)
    lowest = np.argmin(whole.vertices[whole.faces].mean(axis=1)[:, 2])
    hulls = {"whole": whole, "torn": PanelHull.of(whole.vertices, np.delete(whole.faces, lowest, axis=0))}
    floats = [
        Float(
            name=name, hull=hull, mass=1000 * hull.volume, inertia=(4e4,) * 3, hinge=(9.0 * b, 0, 0), motion=("heave",)
        )
        for b, (name, hull) in enumerate(hulls.items())
    ]  # fmt: skip
    told = warnings(Scene(water=DEEP, sea=CALM, floats=tuple(floats), settings=Settings(froude_krylov="linear")))
    slips = [text for text in told if "slip" in text]
    assert slips == ["floats.torn: meshes leave 4 edges open below still water, a slip that is let pass"]


@pytest.mark.parametrize("joint", [{}, {"motion": ("hinge",), "hinge": (-2e4, 0, 3), "arm": (2e4, 0, -3)}])
@pytest.mark.parametrize(
    ("share", "asked"),
    [(0.9, ""), (1e-2, ""), (3e-3, ""), (1.9e-3, "t"), (1e-3, "t"), (6e-4, "t"), (4e-4, "m"), (1e-9, "m"), (5e3, "m")],
)
@pytest.mark.parametrize("mesh", [False, True])
def test_a_hull_of_another_unit_than_its_mass_is_said_to_be_so(joint, share, asked, mesh):
    """Whether the float settles or is held; a hull in mm taken for m displaces 1e9 times its mass, one in t 1e3."""
    item = ball(mass=share * DISPLACED, **joint)
    if mesh:
        hull = fine_box((8.0, 8.0, 8.0), (0.0, 0.0, 0.0), 4.0)
        item = replace(item, hull=hull, mass=share * 1000 * hull.volume)
    (held_item,) = balanced((item,), DEEP, [("hold",)])
    (settles,), (holds,) = imbalance(item, DEEP), held(held_item, DEEP) or ("",)
    scaled = " (of a mesh in mm hull.scale is 0.001)" if mesh else ""
    for text in (settles, holds):
        assert text.endswith("is its mass in t, where kg are needed?") == (asked == "t")
        assert text.endswith(f"is its hull, which reaches {item.hull.size:.4g} m, in m{scaled}?") == (asked == "m")


def buoy(mass, scale=1.0, hull=None, **changes):
    """A cylinder free in heave, linear, of a draft of 0.12 and a freeboard of 0.1 m times the scale."""
    usual = Revolution.vertical_cylinder(radius=0.1 * scale, draft=0.12 * scale, freeboard=0.1 * scale)
    item = Float(
        name="buoy", hull=hull or usual, mass=mass * scale**3,
        **{"hinge": (0.0,) * 3, "motion": ("heave",), "damping": 2.0, "inertia": (0.01 * scale**5,) * 3, **changes},
    )  # fmt: skip
    settings = Settings(
        duration=2.0, discard=0.0, ramp=0.0, radiation=False, diffraction=False, froude_krylov="linear", time_step=0.05
    )
    return Scene(water=Water(depth=np.inf, density=1000.0), floats=(item,), settings=settings)


WHOLE = 1000 * np.pi * 0.1**2 * 0.22  # displaced by the whole hull [kg]


@pytest.mark.parametrize("scale", [1.0, 20.0])
@pytest.mark.parametrize("method", ["time", "frequency"])
def test_what_cannot_float_is_refused_and_what_hardly_does_is_told(scale, method):
    """By its whole displacement, whatever linear buoyancy has above it; a preload lifts it out."""
    time = np.sqrt(scale)
    waves = sea(Hs=1e-3 * scale, Tp=1.1 * time, band=(3.0 / time, 14.0 / time))
    waves = waves if method == "frequency" else CALM

    def told(mass, preload=0.0):
        item = replace(buoy(mass, scale, preload=preload * scale**3), sea=waves)
        settings = replace(item.settings, method=method)
        return simulate(replace(item, settings=settings), None).attrs["warnings"]

    for mass, preload, words in ((1.001 * WHOLE, 0.0, "under water"), (0.1, 2.0, "out of the water")):
        with pytest.raises(SimulationFailed, match=rf"no static equilibrium of floats.buoy: .* whole hull {words}"):
            told(mass, preload)
    assert "100% of its freeboard: diffraction" in told(0.999 * WHOLE)
    assert "97% of its draft: diffraction" in told(0.1)


@pytest.mark.parametrize("pressure", ["linear", "body-nonlinear"])
@pytest.mark.parametrize(
    ("up", "words"),
    [(0.011, ""), (0.013, "above where it is given, 11% of its draft"), (-0.009, ""), (-0.013, "below where it is")],
)
def test_a_float_that_rests_higher_or_deeper_by_a_tenth_is_told(pressure, up, words):
    """Of its draft, or with linear buoyancy of its freeboard, where it heaves and where its arm lifts it; without
    coefficients nothing of a body-nonlinear one is of where it is given."""
    linear = pressure == "linear"
    loads = "diffraction, radiation and linear buoyancy are of" if linear else "diffraction and radiation are of"
    if words and up < 0:
        words += " given, 13% of its freeboard" if linear else " given, 11% of its draft"
    heaving, turning = buoy(1.0), buoy(1.0, motion=("hinge",), hinge=(-0.5, 0.0, 0.0), arm=(0.5, 0.0, 0.0))
    for whole, joint in ((heaving, up), (turning, -np.arcsin(up / 0.5))):
        for solved in (True, False):
            s = replace(whole.settings, froude_krylov=pressure, diffraction=solved)
            texts = warnings(replace(whole, settings=s), np.array([joint]))
            told = [text for text in texts if "are of its place there" in text]
            assert len(told) == (bool(words) and (linear or solved))
            assert all(words in text and loads in text for text in told)


@pytest.mark.slow
@pytest.mark.parametrize(("period", "low", "high"), [(4.0, 0.08, 0.14), (6.0, 0.005, 0.04)])
def test_a_sphere_given_a_tenth_of_its_draft_too_deep_errs_in_short_waves(period, low, high):
    """Body-nonlinear: its diffraction and radiation are of a draft of 5 m, and it rests at 4.5."""
    at_rest = Revolution.sphere(radius=5.0, draft=4.5)
    settings = Settings(duration=60.0, discard=180.0, ramp=40.0)
    std = []
    for hull in (SPHERE, at_rest):
        item = replace(ball(mass=1000 * np.pi * 4.5**2 * (15 - 4.5) / 3, pto_damping=1e5), hull=hull)
        whole = Scene(water=DEEP, sea=regular(height=0.2, period=period), floats=(item,), settings=settings)
        std.append(simulate(whole).variables["motion"][1][0, 0, STATISTICS.index("std")])
    assert low < std[0] / std[1] - 1 < high


def test_what_is_carried_sinks_with_what_carries_it():
    """A hull fixed to another one, which alone is heavy."""
    whole = buoy(5.0)
    (item,) = whole.floats
    tall = replace(item, hull=Revolution.vertical_cylinder(radius=0.1, draft=0.12, freeboard=0.5), mass=13.0)
    low = replace(item, name="low", on="buoy", motion=(), damping=(), hinge=(1.0, 0.0, 0.0), mass=3.8)
    with pytest.raises(SimulationFailed, match=r"no static equilibrium of floats\.low"):
        simulate(replace(whole, floats=(tall, low)), None)
    alone = replace(tall, mass=1.01 * 1000 * np.pi * 0.1**2 * 0.62)  # by more of its draft than of its freeboard
    with pytest.raises(SimulationFailed, match=r"no static equilibrium of floats\.buoy: .* whole hull under water"):
        simulate(replace(whole, floats=(alone,)), None)


def test_a_hull_under_water_that_comes_out_of_it_at_rest_is_told_and_one_wholly_out_is_refused():
    corners, faces = wetted_box()
    deep = PanelHull.of(corners - (0, 0, 0.3), faces)  # from 0.3 to 0.5 m deep

    def told(up):
        spring = 9.81 * 500 * deep.volume / up
        return simulate(buoy(0.5 * 1000 * deep.volume, hull=deep, stiffness=spring), None).attrs.get("warnings", "")

    assert "97% of its top's depth" in told(0.29)
    assert "rests 0.32 m above where it is given, 10% of its height out of the water" in told(0.32)
    with pytest.raises(
        SimulationFailed, match=r"would rest 0\.51 m above where it is given, its whole hull out of the water"
    ):
        told(0.51)


@pytest.mark.parametrize(
    ("pressure", "up", "words"),
    [
        ("linear", 0.029, ""),
        ("linear", 0.031, "10% of its top's depth: diffraction, radiation and linear pressure of the waves are of"),
        ("linear", -0.031, "10% of its top's depth"),
        ("linear", -0.33, "110% of its top's depth"),
        ("body-nonlinear", 0.029, ""),
        ("body-nonlinear", 0.031, "10% of its top's depth: diffraction and radiation are of"),
        ("body-nonlinear", 0.32, "107% of its top's depth: diffraction and radiation are of"),
    ],
)
def test_a_hull_under_water_that_rests_elsewhere_in_it_is_told(pressure, up, words):
    """By its top's depth; incident waves' nonlinear pressure is of its rest."""
    corners, faces = wetted_box()
    deep = PanelHull.of(corners - (0, 0, 0.3), faces)
    whole = buoy((1 - np.sign(up) * 0.5) * 1000 * deep.volume, hull=deep, stiffness=9.81 * 500 * deep.volume / abs(up))
    alone = replace(whole, settings=replace(whole.settings, froude_krylov=pressure))
    solved = replace(alone, settings=replace(alone.settings, diffraction=True))
    told = [text for text in warnings(solved, np.array([up])) if "are of its place there" in text]
    assert len(told) == bool(words) and all(words in text for text in told)
    # Without coefficients nothing of a body-nonlinear one is of where it is given; linear pressure is.
    in_record = "are of its place there" in simulate(alone, None).attrs.get("warnings", "")
    assert in_record == bool(words) * (pressure == "linear")


def test_hulls_under_water_those_that_do_not_heave_and_open_meshes_go_on():
    corners, faces = wetted_box()
    deep = PanelHull.of(corners - (0, 0, 0.3), faces)
    moored = buoy(0.5 * 1000 * deep.volume, hull=deep, stiffness=2000.0)
    box = PanelHull.of(corners, faces)
    hinged = buoy(9.0, motion=("pitch",), cog=(0.02, 0, -0.1))
    nonlinear = buoy(5.0)
    nonlinear = replace(nonlinear, settings=replace(nonlinear.settings, froude_krylov="body-nonlinear"))
    for whole in (moored, hinged, nonlinear):
        assert "are of its place there" not in simulate(whole, None).attrs.get("warnings", "")
    for share, words in ((0.5, "above where it is given, 50% of its draft"), (1.4, "40% of its draft")):
        assert words in simulate(buoy(1000 * box.volume * share, hull=box), None).attrs["warnings"]


def wetted_box():
    """Of 0.2 m, to still water alone, with a lid there."""
    corners = np.array([(x, y, z) for z in (-0.2, 0.0) for x, y in ((-1, -1), (1, -1), (1, 1), (-1, 1))], float)
    corners[:, :2] *= 0.1
    return corners, np.array([(0, 3, 2, 1), (4, 5, 6, 7), (0, 1, 5, 4), (1, 2, 6, 5), (2, 3, 7, 6), (3, 0, 4, 7)])
