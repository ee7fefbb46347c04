"""Weight against buoyancy of floats at rest: what balances them, and sentences for those that are out of balance."""

from collections.abc import Collection, Iterator, Sequence
from dataclasses import replace
from functools import lru_cache

import numpy as np

from solver.errors import InputError, refuse
from solver.hydrodynamics.hull.panel_hull import PanelHull
from solver.mooring import Line, line_pulls, odd_lines
from solver.scene import DOFS, Float, Scene, Water, load_unit_along, poses, unlisted

KNOWN = 64  # floats that a process keeps
LEVEL = 1e-9  # next to nothing, of a direction or of the hull's size
ODD = 1e3  # times the mass, or a part of it: what a hull displaces has lengths in another unit
TONNE, NEARLY = 1e3, 2.0  # [kg]; a mass in t is told by what is displaced within this factor of it
ALLOWED = 0.01  # share of the weight or its moment that may be out of balance
ROUNDING = 1e-9  # of what is allowed: a load that is none
OUT = "height out of the water"  # of a hull that is given under it
UNDER = "top's depth"  # of a hull that is given under it, and stays there
FLUSH = 1e-3  # of its draft: a mesh that rises no higher is one of the wetted part alone, with a lid
LEVEL_AXES = DOFS[:2]  # along which neither weight nor buoyancy acts


@lru_cache(maxsize=KNOWN)
def imbalance(item: Float, water: Water, floats: tuple[Float, ...] = ()) -> tuple[str, ...]:
    """A sentence for a float of whose joint weight and buoyancy at rest, with those of what it carries, differ by over
    ALLOWED along an axis, with the reasons along each such axis.

    A float so held moves to its equilibrium before the run; that is rarely what was meant.
    """
    displaced, borne = water.density * item.hull.volume, list(_borne(item, floats))
    pressed, _ = _carried(item, water, floats)
    pressed[2] -= sum(load for f in borne for _, load in _loads(f, water))
    weighed, reasons = False, []
    preloads = item.per_axis("preload")
    for (name, weight, buoyancy, pull), preload in zip(_along(item, water, floats), preloads, strict=True):
        limit = ALLOWED * max(abs(weight), abs(buoyancy), _least(item, name, displaced * water.gravity, floats))
        if abs(weight + buoyancy + pull) <= limit:
            continue
        # Else it is by the pull alone, or by that of what it carries: neither weighs along the horizontal.
        if name not in LEVEL_AXES and (abs(weight + buoyancy) > limit or abs(pull) <= limit):
            weighed |= name == "heave" or "heave" not in item.motion
            if name not in DOFS[:3]:
                what = "weight and of what it carries" if any(f.on == item.name for f in floats) else "weight"
                reasons.append(f"{name}: moment of {what} {weight:.4g} N m, of buoyancy {buoyancy:.4g} N m")
        loads = preload, pull - preload, item.direction(name) @ pressed if name in DOFS[:3] else 0.0
        reasons += _pulled(name, *(load if abs(load) > ROUNDING * limit else 0.0 for load in loads))
    told = "; ".join([*([_weighed(item, borne, water)] if weighed else []), *reasons])
    if not told:
        return ()
    settles = "It settles before the run begins"
    if weighed and not item.hull.waterplane[0] > LEVEL * item.hull.size**2:
        settles += ", if springs or lines hold it: water does not hold what is wholly under it"
    return (f"floats.{item.name} is out of equilibrium: {told}. {settles}" + _odd(item, water),)


def _hung(item: Float, floats: Sequence[Float]) -> Iterator[Float]:
    """All that a float carries, and what that carries."""
    for f in [f for f in floats if f.on == item.name]:
        yield f
        yield from _hung(f, floats)


def _borne(item: Float, floats: Sequence[Float]) -> Iterator[Float]:
    """Those whose weight and buoyancy it bears: of what heaves it bears the load of the joint."""
    for f in [f for f in floats if f.on == item.name and "heave" not in f.motion]:
        yield f
        yield from _borne(f, floats)


def _weighed(item: Float, borne: Sequence[Float], water: Water) -> str:
    """Mass and displacement [kg] of a float, and those summed with the floats that do not heave on it."""
    told = []
    for group, words in (([item], ""), ([item, *borne], f"with {', '.join(f.name for f in borne)}: ")):
        mass, displaced = sum(f.mass for f in group), water.density * sum(f.hull.volume for f in group)
        told.append(f"{words}mass {mass:g} kg, displaced {displaced:g} kg ({mass / displaced - 1:+.2%})")
    return "; ".join(told if borne else told[:1])


def _pulled(name: str, preload: float, lines: float, pressed: float) -> Iterator[str]:
    """Constant loads of a joint along an axis, beside weight and buoyancy; nothing where there are none."""
    loads = {
        "a preload": preload,
        "a pull of mooring or lines": lines,
        "loads of joints and lines of what it carries": pressed,
    }
    if told := [f"{word} of {load:.4g} {load_unit_along(name)}" for word, load in loads.items() if load]:
        yield f"along {name} {' and '.join(told)}"


@lru_cache(maxsize=KNOWN)
def held(item: Float, water: Water, floats: tuple[Float, ...] = ()) -> tuple[str, ...]:
    """Axes along which a preload is more than the less of weight and buoyancy, so that one is twice the other.

    It keeps any mass where it is, one in other units, too. Moments are of the displaced weight at the hull's size, at
    least; where neither acts along an axis they tell nothing of its preload.
    """
    displaced = water.density * item.hull.volume
    sentences = []
    for (name, *both, _), pull in zip(_along(item, water, floats), item.per_axis("preload"), strict=True):
        weight, buoyancy = both
        if any(both) and abs(pull) > max(min(map(abs, both)), _least(item, name, displaced * water.gravity, floats)):
            sentences.append(
                f"floats.{item.name}: a preload of {pull:.4g} {load_unit_along(name)} in {name} holds what"
                f" weight, {weight:.4g}, and buoyancy, {buoyancy:.4g}, do not balance within a factor of 2: mass"
                f" {item.mass:g} kg, displaced {displaced:g} kg" + _odd(item, water)
            )
    return tuple(sentences)


def _odd(item: Float, water: Water) -> str:
    """What to look at where a float's hull and mass cannot be of one body."""
    times = water.density * item.hull.volume / item.mass
    if TONNE / NEARLY < times < TONNE * NEARLY:
        return "; is its mass in t, where kg are needed?"
    if 1 / ODD < times < ODD:
        return ""
    mesh = " (of a mesh in mm hull.scale is 0.001)" if isinstance(item.hull, PanelHull) else ""
    return f"; is its hull, which reaches {item.hull.size:.4g} m, in m{mesh}?"


def _along(item: Float, water: Water, floats: Sequence[Float]) -> Iterator[tuple[str, float, float, float]]:
    """Axes of a joint; along each the load at rest of weight and what is carried, of buoyancy, and of the joint."""
    force, moment = _carried(item, water, floats)
    for name, pull in zip(item.motion, item.pulls, strict=True):
        weight, buoyancy = (_work(item, name, *load) for load in _loads(item, water))
        weight += float(item.direction(name) @ (force if name in DOFS[:3] else moment))
        yield name, weight, buoyancy, pull


def _loads(item: Float, water: Water) -> Iterator[tuple[np.ndarray, float]]:
    """Point and vertical force of weight and of buoyancy, at rest."""
    yield item.centre + item.cog, -item.mass * water.gravity
    yield item.centre + item.hull.buoyancy_point, water.density * item.hull.volume * water.gravity


def _carried(item: Float, water: Water, floats: Sequence[Float]) -> tuple[np.ndarray, np.ndarray]:
    """Force (3,) [N] and moment about a float's joint (3,) [N m], at rest, of the floats that it carries."""
    force, moment = np.zeros(3), np.zeros(3)
    for f in floats:
        if f.on == item.name:
            load, turning = _passed_on(f, water, floats)
            force += load
            moment += turning + np.cross(np.subtract(f.hinge, item.hinge), load)
    return force, moment


def _passed_on(item: Float, water: Water, floats: Sequence[Float]) -> tuple[np.ndarray, np.ndarray]:
    """Force (3,) [N] and moment (3,) [N m] of a float on its joint: what its axes leave, and their constant loads."""
    force, moment = _carried(item, water, floats)
    for point, load in _loads(item, water):
        force[2] += load
        moment += _moment(point - item.hinge, load)
    for line, pull in zip(item.lines, line_pulls(item.lines, item.centre), strict=True):
        force += pull
        moment += np.cross(np.add(item.arm, line.fairlead), pull)
    constant, (turns, D) = item.per_axis("preload") + item.moored.pretension, _turns(item)
    slides = item.directions[~turns]
    force -= slides.T @ (slides @ force + constant[~turns])
    return force, moment - np.linalg.pinv(D) @ (D @ moment + constant[turns])


def _turns(item: Float) -> tuple[np.ndarray, np.ndarray]:
    """Which of a joint's axes (n,) turn, and their directions D (k, 3).

    Loads p (k,) along them are those of the moment D⁺p: axes may be oblique to each other, and a moment about one is
    then one about the others, too.
    """
    return item.turns, item.directions[item.turns]


def _along_heave(item: Float, loads: np.ndarray) -> float:
    """Of loads (n,) along a joint's axes; 0 where it does not heave."""
    return float(loads @ [name == "heave" for name in item.motion]) if item.motion else 0.0


def _moment(lever: np.ndarray, force: float) -> np.ndarray:
    """Of a vertical force (3,) [N m]."""
    x, y, _ = lever
    return np.array([y * force, -x * force, 0.0])


def _work(item: Float, name: str, point: np.ndarray, force: float) -> float:
    """Work of a vertical force at a point for a unit of the axis [N or N m]."""
    if name in DOFS[:3]:
        return force if name == "heave" else 0.0
    return float(item.direction(name) @ _moment(point - item.hinge, force))


def _least(item: Float, name: str, buoyancy: float, floats: Sequence[Float]) -> float:
    """What a load along an axis is held against, beside weight and buoyancy [N or N m].

    Moments are small where both forces pass by the axis: then the hull's size is the lever. Along the horizontal, where
    neither acts, pulls are held against the sum of their sizes, with what is carried: of lines that balance each other
    rounding is left.
    """
    if name not in LEVEL_AXES:
        return 0.0 if name == "heave" else buoyancy * item.hull.scale
    i = item.motion.index(name)
    every = (line_pulls(f.lines, f.centre) for f in (item, *_hung(item, floats)))
    lines = sum(float(np.linalg.norm(pulls, axis=1).sum()) for pulls in every)
    pulls = lines + float(abs(item.moored.pretension[i]) + abs(item.per_axis("preload")[i]))
    return max(pulls, ROUNDING / ALLOWED * buoyancy)  # less is left of a pretension that is summed over lines


def moored_at(scene: Scene, joints: np.ndarray | None) -> Iterator[tuple[list[Line], np.ndarray]]:
    """Of each float at joints (nj,), or as it is given: its lines, as it has turned their fairleads, and its place."""
    at = np.zeros(scene.offsets.size) if joints is None else joints
    for f, (R, place) in zip(scene.floats, poses(scene.floats, scene.carriers, at), strict=True):
        yield [replace(line, fairlead=tuple((R @ line.fairlead).tolist())) for line in f.lines], place


def heaved(scene: Scene, joints: np.ndarray) -> Iterator[tuple[Float, float, float, str]]:
    """Floats with how far [m] each rests above where it is given, and how much that is of its draft, or where one of
    linear buoyancy sinks of its freeboard, if that is more; of one that is given under water how much of its top's
    depth, or how much of its height it has out of the water.

    joints (nj,): at rest. Of meshes that end at still water none knows the freeboard.
    """
    at = poses(scene.floats, scene.carriers, joints)
    for item, nonlinear, (_, place) in zip(scene.floats, scene.nonlinear, at, strict=True):
        up, hull = float(place[2] - item.centre[2]), item.hull
        above = hull.freeboard if hull.closed and abs(hull.freeboard) > FLUSH * hull.draft else np.inf
        if above < 0 and (nonlinear or up < -above):
            yield item, up, -abs(up) / above, UNDER
        elif above < 0:
            yield item, up, (up + above) / (hull.draft + above), OUT
        elif -up / above > min(abs(up) / hull.draft, 1.0) and not nonlinear:
            yield item, up, -up / above, "freeboard"
        else:
            yield item, up, abs(up) / hull.draft, "draft"


def balanced(floats: Sequence[Float], water: Water, sought: Sequence[Collection[str]]) -> tuple[Float, ...]:
    """Floats with the mass, the place of the c.o.g. and the preloads that hold them at rest as they are given.

    sought: for each float, of "mass", whose weight is the buoyancy less the vertical load of what the float carries,
    and of "x" and "y", the place of the c.o.g. from which no moment turns the float about its joint; where only one of
    the two is sought, about the hinge's axis, if it has one. What is not sought stays. "hold" adds to the preloads what
    is then still out of balance along each axis.
    """
    refuse(unlisted(floats))
    done = list(floats)
    for i in reversed(range(len(done))):  # what is carried is listed after what carries it
        if {*sought[i]} - {"hold"}:
            done[i] = _balanced(done[i], water, done, sought[i])
        if "hold" in sought[i]:
            left = np.array([weight + buoyancy + pull for _, weight, buoyancy, pull in _along(done[i], water, done)])
            done[i] = replace(done[i], preload=tuple((done[i].per_axis("preload") - left).tolist()))
    return tuple(done)


def _balanced(item: Float, water: Water, floats: Sequence[Float], sought: Collection[str]) -> Float:
    displaced, ((*_, carried), turning) = water.density * item.hull.volume, _carried(item, water, floats)
    pulls, (turns, D) = item.pulls, _turns(item)
    mass = displaced + (carried + _along_heave(item, pulls)) / water.gravity if "mass" in sought else item.mass
    if not mass > 0:
        lift = f"{displaced:.6g} kg displaced, {displaced * water.gravity:.4g} N"
        limit = f"leaves nothing: {lift}, do not bear {_told(item, carried)}"
        raise InputError(f"floats.{item.name}.mass", "balance", limit)
    places = [axis for axis in "xy" if axis in sought]
    if not places:
        return replace(item, mass=mass)
    # Weight makes no moment about the vertical, so it bears what axes take of that by a level one, as it does pulls.
    moment = turning[:2] + np.linalg.pinv(D[:, :2]) @ (D[:, 2] * turning[2] + pulls[turns])
    moment += _moment(item.centre + item.hull.buoyancy_point - item.hinge, displaced * water.gravity)[:2]
    lever = (item.centre + item.cog - item.hinge)[:2]
    weight = mass * water.gravity
    whole = np.array([-moment[1], moment[0]]) / weight  # from which no moment is left: (y, -x) of the weight's lever
    if len(places) == 2:
        lever = whole
    else:
        k = "xy".index(places[0])
        axis = item.direction("hinge")[:2] if "hinge" in item.motion else np.eye(2)[1 - k]
        if abs(axis[1 - k]) < LEVEL:
            limit = f"does not turn the float about its hinge's axis ({axis[0]:g}, {axis[1]:g}, ...)"
            raise InputError(f"floats.{item.name}.cog", f"balance along {places[0]}", limit)
        lever[k] = whole[k] + axis[k] / axis[1 - k] * (lever[1 - k] - whole[1 - k])
    found = lever + np.subtract(item.hinge, item.centre)[:2]
    found[np.abs(found) < LEVEL * item.hull.size] = 0.0  # rounding, which would be no mirror image
    x, y = (float(found[k]) if axis in places else item.cog[k] for k, axis in enumerate("xy"))
    return replace(item, mass=mass, cog=(x, y, item.cog[2]))


def _told(item: Float, carried: float) -> str:
    """What the buoyancy bears beside the weight, that of the floats carried [N] first, and which lines are odd."""
    axes = zip(item.motion, item.per_axis("preload"), item.pulls, strict=True)
    along = (_pulled(name, preload, pull - preload, 0.0) for name, preload, pull in axes if name == "heave")
    borne = [f"what the float carries, {carried:.4g} N"] * bool(carried) + [text for texts in along for text in texts]
    return "; ".join([" and ".join(borne), *odd_lines(item.lines, item.centre)])
