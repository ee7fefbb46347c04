"""Physical nonsense, refused before anything runs; one check, one generator of problems."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Collection, Iterable, Iterator

from pipeline.bridge import sea_checks
from pipeline.study.layout import HINGE, hinge_nodes, spaced
from pipeline.study.schema import Float, PanelMesh, Platform, StudyFile, Tube
from pipeline.tasks.task import supports
from solver.errors import InputError

STILL_WATER = 1e-9  # a reference point this near to z = 0 is at still water [m]
STEPS_A_PERIOD = 6  # fewer time steps in the shortest wave do not describe it
# Far more than anybody has asked for, and already days of work or all of a machine's memory.
MOST_STEPS = 10_000_000  # of one run: 23 days of sea at the default step
MOST_TASKS = 10_000_000
MOST_FLOATS = 100
MOST_ELEMENTS = 10_000  # of a platform


PER_AXIS = ("pto_damping", "damping", "quadratic_damping", "stiffness", "mechanism_inertia", "offset")


def problems(study: StudyFile) -> Iterator[InputError]:
    """Everything wrong with a study whose types and ranges are right."""
    seas = list(sea_checks.problems(study))
    yield from seas
    yield from _axes(study)
    yield from _recording(study, math.inf if seas else sea_checks.shortest_period(study))
    yield from _floats(study)
    if study.platform:
        yield from _platform(study.platform, study)


def _axes(study: StudyFile) -> Iterator[InputError]:
    axes = study.axes
    for name in type(axes).model_fields:
        values = getattr(axes, name)
        if values is not None and not values:
            yield InputError(f"axes.{name}", "[]", "needs at least one value")
        yield from _unique(f"axes.{name}", values or ())
    lengths = [len(values) for name in type(axes).model_fields if (values := getattr(axes, name))]
    if (count := math.prod(lengths, start=1 if axes.sea_state else len(study.sea_states))) > MOST_TASKS:
        yield InputError("axes", f"{count} tasks", f"must be <= {MOST_TASKS}: split the study")
    for label in axes.sea_state or ():
        if label not in study.sea_states:
            known = ", ".join(study.sea_states)
            yield InputError("axes.sea_state", label, f"must be one of [sea_states]: {known}")
    for support in supports(study):
        if support != "fixed" and not study.platform:
            yield InputError("axes.platform", support, "needs a [platform] table")
        if support == "fixed" and not study.floats:
            yield InputError("axes.platform", support, "without [[floats]] leaves nothing to simulate")
    if axes.hinge_spacing and len(study.floats) != 2:
        yield InputError("axes.hinge_spacing", f"with {len(study.floats)} floats", "needs exactly 2 floats")
    elif axes.hinge_spacing and study.floats[0].hinge[0] == study.floats[1].hinge[0]:
        yield InputError("axes.hinge_spacing", list(axes.hinge_spacing), "needs hinges at two different x")
    if axes.pto_damping and not study.floats:
        yield InputError("axes.pto_damping", 0, "needs [[floats]]")
    elif axes.pto_damping and (several := [f.name for f in study.floats if len(f.motion) > 1]):
        limit = f"needs floats with a single axis, and {several[0]} has several: give its own list"
        yield InputError("axes.pto_damping", list(axes.pto_damping), limit)


def _recording(study: StudyFile, shortest: float) -> Iterator[InputError]:
    record, step = study.record, study.solver.time_step
    if record.ramp > record.discard:
        yield InputError("record.ramp", record.ramp, f"must be <= record.discard = {record.discard:g} s")
    if not 1 <= record.duration <= 1e6:
        yield InputError("record.duration", record.duration, "must be from 1 to 1e6 s")
    if record.discard > 1e5:
        yield InputError("record.discard", record.discard, "must be <= 1e5 s")
    longest = record.discard + record.duration
    if study.solver.tolerance is None and longest > MOST_STEPS * step:
        limit = f"must be >= {longest / MOST_STEPS:.3g} s, or {longest:g} s take more than {MOST_STEPS} steps"
        yield InputError("solver.time_step", step, limit)
    if study.solver.tolerance is None and step > shortest / STEPS_A_PERIOD:
        limit = f"must be <= {shortest / STEPS_A_PERIOD:.3g} s, a sixth of the shortest wave period {shortest:.3g} s"
        yield InputError("solver.time_step", step, limit)


def _floats(study: StudyFile) -> Iterator[InputError]:
    yield from _unique("floats.name", [f.name for f in study.floats])
    if len(study.floats) > MOST_FLOATS:
        yield InputError("floats", f"{len(study.floats)} floats", f"must be <= {MOST_FLOATS}")
        return
    for item in study.floats:
        yield from _float(item, study)
    if study.axes.hinge_spacing and len(study.floats) == 2:
        for spacing in study.axes.hinge_spacing:
            yield from _overlaps(spaced(study.floats, spacing))
    else:
        yield from _overlaps(study.floats)


def _overlaps(floats: tuple[Float, ...]) -> Iterator[InputError]:
    for i, b in enumerate(floats):
        for a in floats[:i]:
            gap = math.hypot(*(a.hinge[j] + a.arm[j] - b.hinge[j] - b.arm[j] for j in (0, 1)))
            if isinstance(a.hull, PanelMesh) or isinstance(b.hull, PanelMesh):
                continue  # how far a mesh reaches is for the solver to say
            touching = a.hull.radius + b.hull.radius
            if gap < touching:
                limit = f"must be >= {touching:g} m, or the floats cut each other"
                yield InputError(f"distance of floats.{a.name} and floats.{b.name}", f"{gap:g} m", limit)


def _float(item: Float, study: StudyFile) -> Iterator[InputError]:
    key, hull = f"floats.{item.name}", item.hull
    draft = getattr(hull, "draft", 0.0)
    if hull.shape == "sphere" and draft >= 2 * hull.radius:
        yield InputError(f"{key}.hull.draft", draft, f"must be < the diameter, {2 * hull.radius:g} m")
    reference = item.hinge[2] + item.arm[2]
    if reference - draft <= -study.water.depth:
        limit = (
            f"must stay above the seabed: lowest point at z = {reference - draft:g} m, depth {study.water.depth:g} m"
        )
        yield InputError(f"{key}.arm", list(item.arm), limit)
    elif abs(reference) > STILL_WATER:
        limit = f"must bring the reference point to still water, z = 0; hinge + arm gives z = {reference:g} m"
        yield InputError(f"{key}.arm", list(item.arm), limit)
    yield from _joint(item)
    a, b, c = sorted(item.inertia)
    if c > (a + b) * (1 + 1e-9):
        limit = "must meet the triangle inequality: no moment above the sum of the others"
        yield InputError(f"{key}.inertia", list(item.inertia), limit)


def _joint(item: Float) -> Iterator[InputError]:
    key = f"floats.{item.name}"
    if len(set(item.motion)) < len(item.motion):
        yield InputError(f"{key}.motion", list(item.motion), "must name each axis once")
    if "hinge" in item.motion and math.dist(item.axis, (0, 0, 0)) == 0:
        yield InputError(f"{key}.axis", list(item.axis), "must not be zero")
    elif item.motion == ("hinge",) and item.axis[:2] == (0, 0) and _distance(item.arm, item.axis) < 1e-9:
        yield InputError(f"{key}.arm", list(item.arm), "must not lie along the hinge axis: the float would only spin")
    for name in PER_AXIS:
        value = getattr(item, name)
        count = len(value) if isinstance(value, tuple) else 1
        if value != 0 and count != len(item.motion):
            given = list(value) if isinstance(value, tuple) else value
            yield InputError(f"{key}.{name}", given, f"needs one number for each of {', '.join(item.motion)}")


def _distance(point: tuple[float, ...], axis: tuple[float, ...]) -> float:
    """Distance of a point from a line through the origin [m]."""
    along = sum(p * a for p, a in zip(point, axis, strict=True)) / math.hypot(*axis)
    return math.sqrt(max(0.0, math.hypot(*point) ** 2 - along**2))


def _platform(platform: Platform, study: StudyFile) -> Iterator[InputError]:
    nodes = {**platform.nodes, **hinge_nodes(study.floats)}
    yield from _unique("platform.members", [m.name for m in platform.members])
    yield from _unique("platform.legs", platform.legs)
    if (count := sum(m.elements for m in platform.members)) > MOST_ELEMENTS:
        yield InputError("platform.members", f"{count} elements", f"must be <= {MOST_ELEMENTS}")
        return
    if not platform.members:
        yield InputError("platform.members", "[]", "needs at least one member")
    if not platform.clamped:
        yield InputError("platform.clamped", "[]", "needs at least one node, or the platform floats away")
    for node in platform.nodes:
        if node.startswith(HINGE):
            yield InputError(f"platform.nodes.{node}", list(nodes[node]), "comes with its float; leave it out")
    named = [
        (f"platform.members.{m.name}.{end}", getattr(m, end)) for m in platform.members for end in ("start", "end")
    ]
    named += [(f"platform.clamped[{i}]", n) for i, n in enumerate(platform.clamped)]
    named += [(f"platform.masses[{i}].node", m.node) for i, m in enumerate(platform.masses)]
    named += [(f"platform.loads[{i}].node", load.node) for i, load in enumerate(platform.loads)]
    for key, node in named:
        yield from _known(key, node, nodes)
    yield from _members(platform, nodes)
    ends = {end for m in platform.members for end in (m.start, m.end)}
    for node, place in nodes.items():
        if node not in ends:
            yield InputError(f"platform.nodes.{node}", list(place), "must be the end of a member")
        elif place[2] < -study.water.depth - STILL_WATER:
            limit = f"must not lie below the seabed, z = {-study.water.depth:g} m"
            yield InputError(f"platform.nodes.{node}", list(place), limit)


def _members(platform: Platform, nodes: dict[str, tuple[float, float, float]]) -> Iterator[InputError]:
    for name, section in platform.sections.items():
        if isinstance(section, Tube) and section.thickness > section.diameter / 2:
            limit = f"must be <= diameter / 2 = {section.diameter / 2:g} m"
            yield InputError(f"platform.sections.{name}.thickness", section.thickness, limit)
    for member in platform.members:
        key = f"platform.members.{member.name}"
        yield from _known(f"{key}.section", member.section, platform.sections)
        yield from _known(f"{key}.material", member.material, platform.materials)
        if {member.start, member.end} <= nodes.keys() and nodes[member.start] == nodes[member.end]:
            yield InputError(f"{key}.end", member.end, f"must lie apart from {member.start}: zero length")
        if member.elements > 1000:
            yield InputError(f"{key}.elements", member.elements, "must be <= 1000")
    for i, leg in enumerate(platform.legs):
        yield from _known(f"platform.legs[{i}]", leg, {m.name: m for m in platform.members})


def _known(key: str, name: str, known: Collection[str]) -> Iterator[InputError]:
    if name not in known:
        yield InputError(key, name, f"must be one of {', '.join(known)}")


def _unique(key: str, names: Iterable[object]) -> Iterator[InputError]:
    for name, count in Counter(names).items():
        if count > 1:
            yield InputError(key, name, f"given {count} times, must be unique")
