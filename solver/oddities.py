"""Sentences for the user on what is odd about a scene."""

from collections.abc import Iterator, Sequence

import numpy as np

from solver import limits
from solver.balance import FLUSH, OUT, TONNE, UNDER, heaved, held, imbalance, moored_at
from solver.hydrodynamics.hull.clearance import borders, openings
from solver.mooring import Line, line_pulls, odd_lines
from solver.scene import DOFS, LEVEL, Float, Platform, Scene, Water, unit_along
from solver.sea.field import wave_field
from solver.structure.frame import Frame

TURNED = 0.2  # [rad] that a float may rest from where it is given
# Of its draft, freeboard or top's depth, by which it may rest higher or deeper: in short waves motions err by as much.
HEAVED = 0.1
WATERS = 900.0, 1300.0  # [kg/m3]: less is no water, nor is more, the Dead Sea's is 1240
FASTEST = 12.0  # [m/s]: no tide runs faster, Saltstraumen's has 11
LARGEST = 500.0  # [m]: no hull is longer, the longest ship has 458 m
GYRATION = 0.1, 10.0  # of the edge of a cube as large as a hull, and of its size: radii of gyration are between them
FAR = 10.0  # hulls' sizes, from their reference point: no centre of gravity is as far
FEW = 10.0  # mean periods: from one record of so many to the next the std of a random sea scatters by a fifth
PARTLY = 0.01  # of a std: what a part of a wave's period may change of a mean
LONG = 2.0  # hulls' sizes, from their reference point: none is longer
AWAY = 2.0  # hulls' sizes, from their reference point: no fairlead is as far
RAISED = 0.01  # of the depth, by which a clamped foot, or an anchor on which a line lies, may be above the seabed
STEEPEST = (8.0, 15.0), (1 / 15, 1 / 25)  # 2π Hs/(g Tp²) that seas have by Tp [s], DNV-RP-C205


def warnings(scene: Scene, joints: np.ndarray | None = None) -> tuple[str, ...]:
    """Sentences for the user, the key first; joints (nj,): at rest, where that is known."""
    return (*of_undamped(scene, joints), *idle(scene), *_locked_one_way(scene))


def idle(scene: Scene) -> Iterator[str]:
    """A sentence for each part that is given of a power take-off that is not there."""
    for f in scene.floats:
        yield from (f"floats.{f.name}.{part}: does nothing without a power take-off" for part in f.idle)


def _locked_one_way(scene: Scene) -> Iterator[str]:
    """A sentence for each axis that more friction than its float weighs holds, in one sense alone."""
    for f in scene.floats:
        lever = np.linalg.norm(f.arm) + f.hull.size
        weight = f.mass * scene.water.gravity * np.where(f.turns, lever, 1.0)
        for axis, share, load, most in zip(f.motion, f.per_axis("one_way"), f.per_axis("coulomb"), weight, strict=True):
            if abs(share) == 1 and load > most:
                yield (
                    f"floats.{f.name}.coulomb: {load:.3g} {'N m' if unit_along(axis) == 'rad' else 'N'} holds {axis} in"
                    f" one sense alone, for one_way = {share:g}, so that it ratchets: one_way = 0 locks it"
                )


def of_undamped(scene: Scene, joints: np.ndarray | None = None) -> tuple[str, ...]:
    """Those that scenes share which differ in their dampers alone."""
    sentences = [*_of_water(scene)]
    sentences += [text for f in scene.floats for text in imbalance(f, scene.water, scene.floats)]
    sentences += [text for f in scene.floats for text in held(f, scene.water, scene.floats)]
    sentences += [text for f in scene.floats for text in (*_of_units(f), *_of_inertia(f, scene.water))]
    sentences += [*_of_lines(scene, joints)]
    sentences += [f"floats.{f.name}.hull: {note}" for f in scene.floats for note in getattr(f.hull, "notes", ())]
    for group in scene.sharing:
        if len(edges := openings([f.hull for f in group], [f.centre for f in group])):
            names = ", ".join(f"floats.{f.name}" for f in group if borders(f.hull, f.centre, edges))
            sentences.append(
                f"{names}: meshes leave {len(edges)} edges open below still water, a slip that is let pass"
            )
    width = scene.settings.gap_width
    if width > 0 and not scene.has_gap(width):
        sentences.append(f"solver.gap_width: no gap or well at rest is narrower than {width:g} m, so no lid damps any")
    if scene.platform is not None:
        sentences += [*_of_platform(scene, scene.platform), *_pierced(scene, scene.platform)]
    sentences += [
        *_pushed(scene, joints),
        *_drifting(scene),
        *_lidded(scene),
        *_too_short(scene),
        *_partly(scene),
        *_too_steep(scene),
        *overdamped(scene),
    ]
    rest = () if joints is None else (*_turned(scene, joints), *_risen(scene, joints))
    return (*sentences, *(f"sea: {note}" for note in scene.sea.notes), *rest)


def _of_lines(scene: Scene, joints: np.ndarray | None) -> Iterator[str]:
    """Sentences for lines, of floats at joints (nj,), or as they are given."""
    for f, (lines, place) in zip(scene.floats, moored_at(scene, joints), strict=True):
        texts = *odd_lines(lines, place), *_lying(lines, place, scene.water.depth)
        yield from (f"floats.{f.name}.lines: {text}" for text in texts)


def _lying(lines: Sequence[Line], place: np.ndarray, depth: float) -> Iterator[str]:
    """A sentence for each line that lies, at rest, on a seabed at its anchor where the water's is far below."""
    for number, (line, pull) in enumerate(zip(lines, line_pulls(lines, place), strict=True), 1):
        lies = line.length + pull[2] / line.weight
        if lies > 0 and _above_seabed(line.anchor[2], depth):
            yield (
                f"line {number} lies over {lies:.4g} m at rest on a seabed at its anchor, z = {line.anchor[2]:g} m,"
                f" where the water has depth = {depth:g}: is the anchor or the depth another?"
            )


def _of_water(scene: Scene) -> Iterator[str]:
    """Sentences for water and a current whose numbers look as of other units."""
    low, high = WATERS
    if not low <= (density := scene.water.density) <= high:
        yield f"water.density: {density:g} kg/m3 is none of water, {low:g} to {high:g} kg/m3: is it in other units?"
    if scene.current is not None:
        speeds = [scene.current.speed or 0.0, *(line.speed for line in scene.current.profile)]
        if (fastest := max(speeds)) > FASTEST:
            yield f"current: {fastest:g} m/s is faster than any tide, {FASTEST:g} m/s: is it in other units?"


def _of_units(item: Float) -> Iterator[str]:
    """Sentences for a float whose size or stops look as of other units, or whose axis is no joint's."""
    if item.motion and "hinge" not in item.motion and not np.array_equal(item.axis, LEVEL):
        yield f"floats.{item.name}.axis: is of a hinge; {', '.join(item.motion)} go along or about x, y and z"
    if item.hull.size > LARGEST:
        where = f"floats.{item.name}.hull: reaches {item.hull.size:.4g} m, as no hull does"
        yield f"{where}: is it in other units{item.in_millimetres}?"
    if (away := float(np.linalg.norm(item.cog))) > FAR * item.hull.size:
        where = (
            f"floats.{item.name}.cog: lies {away:.4g} m from the reference point of a hull of {item.hull.size:.4g} m"
        )
        yield f"{where}: is it in other units?"
    for number, line in enumerate(item.lines, 1):
        if (away := float(np.linalg.norm(line.fairlead))) > AWAY * item.hull.size:
            yield (
                f"floats.{item.name}.lines: the fairlead of line {number} lies {away:.4g} m from the reference point of"
                f" a hull of {item.hull.size:.4g} m: fairleads are from there, not from the origin"
            )
    start, low, high = (np.abs(item.per_axis(name)) for name in ("offset", "end_stops.lower", "end_stops.upper"))
    for axis, at, farthest in zip(item.motion, start, np.maximum(low, high), strict=True):
        if limits.slides(axis) and at > LONG * item.hull.size:
            where = f"floats.{item.name}.offset: {at:.4g} m of {axis} is further than its hull is long"
            yield f"{where}, which reaches {item.hull.size:.4g} m: is it in other units?"
        for name, far in (("offset", at), ("end_stops", farthest)):
            if not limits.slides(axis) and far > np.pi:
                yield (
                    f"floats.{item.name}.{name}: {far:g} rad of {axis} is more than half a turn, where no float"
                    f" comes: {'is it' if name == 'offset' else 'are they'} in degrees?"
                )


def _of_inertia(item: Float, water: Water) -> Iterator[str]:
    """A sentence for each axis about which a float turns with a radius of gyration that is of no such hull.

    By its mass and by what it displaces, for a mass of other units is told by itself. A long hull has a small radius
    about its length, though not beside the edge of a cube of what it displaces.
    """
    edge = np.cbrt(item.hull.volume)
    least, most = GYRATION[0] * edge, GYRATION[1] * item.hull.size
    masses = np.array([item.mass, water.density * item.hull.volume])
    for axis, d in zip(np.array(item.motion)[item.turns], item.directions[item.turns], strict=True):
        radii = np.sqrt(d @ item.inertia_tensor @ d / masses)
        if not ((least <= radii) & (radii <= most)).any():
            in_tonnes = least / np.sqrt(TONNE) < radii[0] < least
            asked = "is it in t m2, where kg m2 are needed?" if in_tonnes else "is it or the hull in other units?"
            yield (
                f"floats.{item.name}.inertia: a radius of gyration of {radii[0]:.3g} m about {axis}, with a mass of"
                f" {item.mass:.4g} kg, is of no hull that reaches {item.hull.size:.3g} m and displaces a cube of"
                f" {edge:.3g} m: {asked}"
            )


def _of_platform(scene: Scene, platform: Platform) -> Iterator[str]:
    """Sentences for a frame that buckles or bends too far at rest, for its member that is thickest beside waves, for
    those that lie in still water's surface or that nothing loads there, for its thinnest tube that is utilised, for
    numbers as of other units, for members given twice, and for feet clamped in mid-water.
    """
    # With scipy's parts, for scenes with a platform alone.
    from solver.structure import in_water, slenderness, slips, tubular

    water = scene.water
    still = in_water.dynamic_model(platform.frame, water.density, water.gravity, softened=platform.geometric_stiffness)
    yield from in_water.too_soft(*still)
    waves = wave_field(scene.sea, water.depth, water.gravity, scene.current)
    yield from slenderness.too_thick(still[0], waves, lacking=1.0 if platform.wave_inertia == "relative" else 0.0)
    rough = bool(np.any(scene.sea.amplitude))
    yield from in_water.unloaded(platform.frame, waves=rough, current=scene.current is not None)
    if platform.wave_stretching == "none":
        yield from in_water.left_dry(platform.frame)
    if "utilisation" in scene.settings.outputs:
        yield from tubular.too_thin(platform.frame.members)
    yield from slips.of_materials(platform.frame.members)
    yield from slips.of_growth(platform.frame)
    yield from slips.of_twins(platform.frame.members)
    yield from slips.on_feet(platform.frame, platform.load_histories)
    yield from _in_mid_water(platform.frame, water.depth)


def _in_mid_water(frame: Frame, depth: float) -> Iterator[str]:
    """A sentence for feet clamped well above the seabed, as all are in deep water, which has none."""
    feet = {name: frame.nodes[name][2] for name in frame.clamped}
    if raised := [name for name, z in feet.items() if z < 0 and _above_seabed(z, depth)]:
        highest = max(feet[name] for name in raised)
        where = f"{highest + depth:.3g} m at most, in water of {depth:g} m"
        if np.isinf(depth):
            where = f"z = {highest:g} m at most, in water without one, depth = inf"
        yield (
            f"platform.clamped: {', '.join(raised)} above the seabed, {where}: what holds a foot there, or is the"
            " depth another?"
        )


def _above_seabed(z: float, depth: float) -> bool:
    """By more than RAISED of the depth, or of no depth at all."""
    return z > (RAISED - 1) * depth


def _pierced(scene: Scene, platform: Platform) -> Iterator[str]:
    """A sentence for each float in whose waterplane at rest a member stands that waves load."""
    from solver.hydrodynamics.hull.gaps import outline
    from solver.hydrodynamics.hull.mesh import inside as within

    loaded = [m for m in platform.frame.members if m.drag_coefficient > 0 or m.inertia_coefficient > 1]
    nodes = platform.frame.nodes
    ends = np.reshape([[*nodes[m.start], *nodes[m.end]] for m in loaded], (-1, 2, 3))
    ends = ends + np.reshape([[m.start_offset, m.end_offset] for m in loaded], (-1, 2, 3))
    crossing = (ends[:, 0, 2] < 0) != (ends[:, 1, 2] < 0)
    (x0, y0, z0), (x1, y1, z1) = ends[crossing].transpose(1, 2, 0)
    share = z0 / (z0 - z1)
    places = np.column_stack([x0 + share * (x1 - x0), y0 + share * (y1 - y0)])
    for f in scene.floats:
        through = within(places, outline(f.hull) + f.centre[:2])
        if names := [loaded[i].name for i in np.flatnonzero(crossing)[through]]:
            yield (
                f"floats.{f.name}: {', '.join(names)} of the platform runs through its hull, which is whole in the"
                " water's loads, as the member is: does it stand in a well?"
            )


def _turned(scene: Scene, joints: np.ndarray) -> Iterator[str]:
    """A sentence for each axis on which a float rests, at joints (nj,), elsewhere than its coefficients are of."""
    names = [(f.name, axis) for f in scene.floats for axis in f.motion]
    solved = "diffraction, radiation" if scene.settings.hydrodynamic_axes == "space" else "diffraction"
    for (name, axis), at in zip(names, joints, strict=True):
        if axis not in DOFS[:3] and abs(at) > TURNED:
            yield (
                f"floats.{name} rests at {at:+.2f} rad of {axis} from where it is given, which {solved} and linear"
                " buoyancy are of"
            )


def _risen(scene: Scene, joints: np.ndarray) -> Iterator[str]:
    """A sentence for each float that rests, at joints (nj,), far above or below where its loads are of."""
    s = scene.settings
    for (f, up, share, of), nonlinear in zip(heaved(scene, joints), scene.nonlinear, strict=True):
        loads = "diffraction, radiation and linear " + ("pressure of the waves" if of == UNDER else "buoyancy")
        if nonlinear:
            loads = "diffraction and radiation" if s.diffraction or s.radiation else ""
        if loads and (share > HEAVED or of == OUT):  # whose buoyancy is that under water
            yield (
                f"floats.{f.name} rests {abs(up):.3g} m {'above' if up > 0 else 'below'} where it is given,"
                f" {share:.0%} of its {of}: {loads} are of its place there"
            )


def _pushed(scene: Scene, joints: np.ndarray | None) -> Iterator[str]:
    """A sentence for each axis that is beyond an end stop at rest, where floats are given, and so is pushed off it."""
    lower, upper, works = (
        np.concatenate([np.zeros(0), *(f.per_axis(f"end_stops.{name}") for f in scene.floats)])
        for name in ("lower", "upper", "stiffness")
    )
    names = [(f.name, axis) for f in scene.floats for axis in f.motion]
    for j in np.flatnonzero((works > 0) & ((lower > 0) | (upper < 0))):
        (name, axis), to = names[j], "" if joints is None else f" to {joints[j]:+.3g}"
        yield (
            f"floats.{name}.end_stops: {lower[j]:+g} to {upper[j]:+g} {unit_along(axis)} of {axis} leave out its"
            f" rest, 0: a stop pushes it away{to} before the run begins"
        )


def _lidded(scene: Scene) -> Iterator[str]:
    """A sentence for each hull that ends at still water, where pressure is taken up to the waves' surface."""
    for f, nonlinear in zip(scene.floats, scene.nonlinear, strict=True):
        if nonlinear and f.hull.closed and abs(f.hull.freeboard) <= FLUSH * f.hull.draft:
            yield (
                f"floats.{f.name}.hull ends at still water: waves that rise go over its top; a mesh of the wetted part"
                ' alone needs what is above for body-nonlinear pressure, or froude_krylov = "linear"'
            )


def _drifting(scene: Scene) -> Iterator[str]:
    """A sentence for each axis on which waves may push a float out of the series of its body-nonlinear pressure."""
    slides = any(set(f.motion) & set(DOFS[:2]) for f in scene.floats)
    if not slides or not any(scene.nonlinear) or not scene.sea.amplitude.any():
        return
    from solver.coupled.preparation import around  # with the system's parts, for floats that slide alone

    waves = wave_field(scene.sea, scene.water.depth, scene.water.gravity, scene.current)
    near, _, terms = around(scene, waves)
    slidings = limits.slidings(scene, near, limits.ways(scene, near, terms))
    for f, away, pushed in zip(scene.floats, slidings, limits.pushed(scene, waves), strict=True):
        for axis, far in pushed.items():
            if far > away:
                yield (
                    f"floats.{f.name}: waves may push it further than {away:.3g} m along {axis}, up to where its"
                    " body-nonlinear pressure is known about its place at rest, and a run ends there: hold it by a"
                    ' stiffer mooring, or set froude_krylov = "linear", which has no such bound'
                )


def _too_short(scene: Scene) -> Iterator[str]:
    """A sentence for a record of a sea of several waves that has few of their mean periods."""
    length, mean = scene.settings.duration, scene.sea.parameters()["Tz"]
    if scene.sea.omega.size > 1 and length < FEW * mean:  # no mean period in still water
        yield (
            f"record.duration: {length:g} s are {length / mean:.2g} mean periods of the waves, {mean:.3g} s, and less"
            f" than {FEW:g} tell little of a sea: is it in other units?"
        )


def _partly(scene: Scene) -> Iterator[str]:
    """A sentence for a march whose record has a part of one wave's period that counts: over n periods the mean of a
    cosine is |sin πn|/πn at most.
    """
    omega = scene.sea.omega[np.abs(scene.sea.amplitude) > 0]
    if omega.size != 1 or scene.settings.method == "frequency":
        return
    length, period = scene.settings.duration, 2 * np.pi / float(omega[0])
    n = length / period
    off = np.sqrt(2) * abs(np.sin(np.pi * n)) / (np.pi * n)
    if off > PARTLY:
        whole = max(round(n), 1)
        yield (
            f"record.duration: {length:g} s are {n:.3g} periods of the wave, of which the part makes means err by up to"
            f" {off:.1%} of a std: {whole * period:.6g} s are {whole}"
        )


def _too_steep(scene: Scene) -> Iterator[str]:
    """A sentence for a sea of several waves that is steeper than nature's; white noise has no peak to tell by.

    Its Hs and Tp are those that were asked for, whatever a realization has of them.
    """
    height, peak = scene.sea.nominal or (scene.sea.parameters()[name] for name in ("Hm0", "Tp"))
    steepness, steepest = 2 * np.pi * height / (scene.water.gravity * peak**2), np.interp(peak, *STEEPEST)
    if scene.sea.omega.size > 1 and steepness > steepest:
        yield (
            f"sea: waves of Hs = {height:.3g} m and Tp = {peak:.3g} s have a steepness 2π Hs/(g Tp²) of"
            f" {steepness:.3g}, above {steepest:.3g}, the limit of natural seas (DNV-RP-C205): a model test may"
            " be so steep, no open sea is"
        )


def overdamped(scene: Scene) -> Iterator[str]:
    """A sentence for each axis whose `critical_damping` is that of no oscillation; a run makes linear damping of it."""
    for f in scene.floats:
        for axis, ratio in zip(f.motion, f.per_axis("critical_damping"), strict=True):
            if ratio > 1:
                yield (
                    f"floats.{f.name}.critical_damping: {ratio:g} times the critical damping of {axis}, which swings no"
                    " more from 1 on: is it in per cent?"
                )
