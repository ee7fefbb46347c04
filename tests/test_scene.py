"""What a scene's inputs refuse: key, value and limit of all that is wrong with them, before anything runs."""

import pickle
from dataclasses import fields, is_dataclass, replace

import numpy as np
import pytest

from solver.errors import InputError
from solver.hydrodynamics.hull.revolution import Revolution
from solver.mooring import Mooring
from solver.scene import EndStops, Float, Platform, Scene, Settings, Water
from solver.sea.current import Current, CurrentSpeed
from solver.sea.realization import realize
from solver.sea.spectrum import PiersonMoskowitz
from solver.structure.frame import Frame
from tests.awkward import unequal_legs

BALL = Revolution.sphere(radius=2.0, draft=1.0)  # widest above still water
FREE = {"hull": BALL, "mass": 1e4, "inertia": (1e4,) * 3, "hinge": (0.0, 0.0, 0.0), "motion": ("heave",)}


def one(**changes):
    return Float(name="a", **FREE | changes)


def carried(**changes):
    """On a platform, of which the hinge's node may be another."""
    whole = unequal_legs()[0]
    return replace(whole, platform=replace(whole.platform, **changes))


def two(apart, **changes):
    return Scene(water=Water(depth=50.0), floats=(one(**changes), replace(one(), name="b", hinge=(apart, 0.0, 0.0))))


def drawn(**changes):
    return realize(PiersonMoskowitz(Hs=1.0, Tp=5.0), components=9, band=(0.5, 2.0), seed=0, **changes)


@pytest.mark.parametrize(
    ("build", "message"),
    [
        (lambda _: carried(hinge_nodes={"float": "nose"}), "platform.hinge_nodes = nose: must be a node of the frame"),
        (lambda _: carried(hinge_nodes={"float": "deck"}), "and must where float is hinged, at (-1.5, 0, 3)"),
        (lambda _: Water(depth=-1.0), "water.depth = -1.0: must be > 0 m"),
        (lambda _: Water(depth=np.nan), "water.depth = nan: must be > 0 m"),
        (lambda _: Water(depth=1.0, density=np.inf), "water.density = inf: must be finite kg/m3"),
        (lambda _: Settings(modes=0), "settings.modes = 0: must be >= 1"),
        (lambda _: Settings(tolerance=0.2), "settings.tolerance = 0.2: must be <= 0.1"),
        (
            lambda _: one(inertia=(1.0, 2.0, 3.1)),
            "floats.a.inertia = (1.0, 2.0, 3.1): must meet the triangle inequality",
        ),
        (lambda _: one(damping=()), "floats.a.damping = (): needs one number for each of heave"),
        (lambda _: one(motion=("yaw", "yaw")), "floats.a.motion = ('yaw', 'yaw'): must name each axis once, of hinge,"),
        (
            lambda _: one(motion=("hinge",), axis=(0, 0, 2), arm=(0, 0, 1)),
            "a.arm = (0, 0, 1): must not lie along the hinge",
        ),
        (
            lambda _: two(3.9),
            "distance of floats.a and floats.b = 3.9 m: must be > 4 m, or their surfaces apart, which touch",
        ),
        (lambda _: two(9.0, on="b"), "floats.a.on = b: must name a float that is listed before"),
        (lambda buan: buan.platform(damping_ratio=1.0), "platform.damping_ratio = 1.0: must be < 1"),
        (
            lambda buan: Platform(frame=buan.frame(), legs=("leg1", "leg9")),
            "platform.legs[1] = leg9: must be one of leg1,",
        ),
        (
            lambda buan: buan.scene(water=Water(depth=49.9)),
            "platform.nodes.foot1 = (-1.5, 1.2, -50.0): must not lie below",
        ),
        (
            lambda buan: Scene(water=buan.water, sea=buan.regular(0.1, 2.0), settings=Settings(time_step=0.53)),
            "settings.time_step = 0.53: must be <= 0.524 s, a sixth of the shortest wave's period, 3.14 s",
        ),
        (lambda _: Settings(froude_krylov="nonlinear"), "froude_krylov = nonlinear: must be one of body-nonlinear, li"),
        (lambda _: Settings(modes="most"), "settings.modes = most: must be one of all, or a number"),
        (lambda _: Settings(outputs=("reactions", "wear")), "settings.outputs = wear: must be one of reactions, "),
        (lambda buan: buan.platform(wave_stretching="wheel"), "platform.wave_stretching = wheel: must be one of none"),
        (lambda _: PiersonMoskowitz(Hs=1.0, Tp=5.0, form="T1"), "spectrum.form = T1: must be one of peak, mean"),
        (lambda _: drawn(intervals="equal"), "intervals = equal: must be one of random, even"),
    ],
)
def test_what_cannot_be_is_refused(buan, build, message):
    with pytest.raises(InputError) as caught:
        build(buan)
    assert message in str(caught.value)


def test_bounds_belong_to_their_range_or_not_as_they_say():
    assert Settings(discard=0.0, ramp=0.0, modes=1, tolerance=0.1).discard == 0
    assert Water(depth=np.inf).depth == np.inf
    assert one(inertia=(1.0, 2.0, 3.0)) and two(4.001).floats


def test_all_that_is_wrong_with_an_input_is_told_at_once():
    """A study file's reader mends them together."""
    with pytest.raises(InputError) as caught:
        one(mass=-1.0, inertia=(1.0, 1.0, 3.0), damping=(1.0, 2.0), offset=(0.0, 0.1))
    error = pickle.loads(pickle.dumps(caught.value))
    keys = [problem.key for problem in (error, *error.others)]
    assert keys == ["floats.a.mass", "floats.a.damping", "floats.a.offset", "floats.a.inertia"]


def with_lists(inputs):
    """With a list or an array wherever it has a tuple."""
    given = {f.name: getattr(inputs, f.name) for f in fields(inputs) if f.init}
    for name, value in given.items():
        if isinstance(value, tuple):
            each = [with_lists(one) if is_dataclass(one) else one for one in value]
            given[name] = np.array(each) if each and all(isinstance(x, float) for x in each) else each
        elif isinstance(value, Platform | Frame | Settings | Current | EndStops):
            given[name] = with_lists(value)
    return replace(inputs, **given)


def test_lists_and_arrays_are_tuples():
    """By which scenes are known again: a hash of a list is none, and was told so in the middle of a run."""
    whole = unequal_legs()[0]
    stops = EndStops(lower=(-0.4,), upper=(0.4,), stiffness=(1e6,))
    held = replace(whole.floats[0], end_stops=stops, stiffness=(2.0,))
    rows = tuple(map(tuple, np.eye(6).tolist()))
    assert hash(Mooring(stiffness=np.eye(6))) == hash(Mooring(stiffness=rows))
    current = Current(profile=(CurrentSpeed(depth=0.0, speed=1.0),))
    whole = replace(whole, floats=(held,), current=current, settings=replace(whole.settings, outputs=("pto_force",)))
    loose = with_lists(whole)
    assert loose == whole and hash(loose.floats) == hash(whole.floats) and hash(loose.settings) == hash(whole.settings)
    assert hash(loose.platform.frame) == hash(whole.platform.frame) and hash(loose.current) == hash(current)
