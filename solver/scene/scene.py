"""Water, sea, floats and support together, and what of each the others or the method refuse."""

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from itertools import combinations

import numpy as np

from solver.errors import InputError, refuse
from solver.hydrodynamics.hull.clearance import openings, reach, slips, touching
from solver.hydrodynamics.hull.gaps import gaps
from solver.hydrodynamics.hull.mesh import PANELS, panel_side
from solver.hydrodynamics.hull.meshfile import KEY
from solver.hydrodynamics.hull.panel_hull import PanelHull
from solver.hydrodynamics.hull.standing import ON_SEABED, stands
from solver.hydrodynamics.hull.surface import point_text
from solver.hydrodynamics.hull.swing import Stroke, meeting
from solver.quantities import take_tuples
from solver.scene.arrangement import is_planar, lines_mirrored, on_others, out_of_place, unlisted
from solver.scene.floats import STARTS, Float
from solver.scene.platform import Platform
from solver.scene.settings import Settings
from solver.scene.turning import turned_over
from solver.scene.water import STILL_WATER, Water
from solver.sea.current import Current
from solver.sea.realization import CALM, Realization
from solver.structure.frame import Frame
from solver.structure.tubular import may_be_utilised, of_no_metal, resistance

MISPLACED = 1e-6  # of a frame's size, that a hinge may lie off its node
FINEST = 200  # shares of its width that a gap is looked for by
MOST_STEPS = 10_000_000  # of one run: 23 days of sea at the default step
STEPS = 9  # in the shortest period that a scene has to follow
MOST_SECTIONS = 200  # members whose section forces are put out, and nodes whose accelerations are
MOST_CHECKED = 500  # elements whose utilisation is


@dataclass(frozen=True, slots=True, kw_only=True)
class Scene:
    """Water, one realization of the sea, a current, floats, and their support (None: fixed in space)."""

    water: Water
    sea: Realization = CALM
    current: Current | None = None  # which the members' drag feels alone
    floats: tuple[Float, ...] = ()
    platform: Platform | None = None
    settings: Settings = field(default_factory=Settings)

    def __post_init__(self) -> None:
        take_tuples(self)
        refuse(self._problems())

    def _problems(self) -> Iterator[InputError]:
        yield from self._carrier_problems()
        yield from self._fixed_problems()
        for f in self.floats:
            yield from out_of_place(f, self.water)
            yield from turned_over(f)
            if self.settings.froude_krylov == "body-nonlinear" and not f.hull.closed:
                yield InputError(
                    f"floats.{f.name}.hull",
                    "an open mesh",
                    'must be closed for body-nonlinear pressure; or set froude_krylov = "linear"',
                )
            for line in f.lines:
                if line.anchor[2] < -self.water.depth * (1 + ON_SEABED):
                    limit = f"must not lie below the seabed, z = {-self.water.depth:g} m"
                    yield InputError(f"floats.{f.name}.lines.anchor", line.anchor, limit)
        yield from self._open_hulls()
        for a, b in (pair for group in self.sharing for pair in combinations(group, 2)):
            if touching(a.hull, a.centre, b.hull, b.centre):
                key, gap = f"distance of floats.{a.name} and floats.{b.name}", np.linalg.norm(a.centre - b.centre)
                limit = f"must be > {reach(a.hull) + reach(b.hull):g} m, or their surfaces apart, which touch"
                yield InputError(key, f"{gap:g} m", limit)
        for f in (f for f in self.floats if any(f.stroke)):
            for first, second, places in self.meetings({f.name: f.stroke}):
                limit = f"must keep floats.{first} and floats.{second} apart, which meet at {places}"
                unit = "m" if f.jointed.slides else "rad"
                yield InputError(f"floats.{f.name}.end_stops", "{:g} to {:g}".format(*f.stroke) + f" {unit}", limit)
        yield from self._seabed_problems()
        yield from self._output_problems()
        yield from self._drift_problems()
        yield from self._law_problems()
        yield from self._load_problems()
        settings, longest = self.settings, self.longest_step
        marching = settings.method == "time" and settings.tolerance is None and self.sea.amplitude.any()
        if marching and (step := settings.time_step) is not None and step > longest:
            limit = f"must be <= {longest:.3g} s, a sixth of the shortest wave's period, {6 * longest:.3g} s"
            yield InputError("settings.time_step", step, limit)

    def _seabed_problems(self) -> Iterator[InputError]:
        if self.platform is None:
            return
        frame = self.platform.frame
        if frame.soil is not None:
            if frame.seabed != -self.water.depth:
                limit = f"must be that of the water, {-self.water.depth:g} m"
                yield InputError("platform.soil.seabed", frame.seabed, limit)
            return
        for key, place in frame.places():
            if place[2] < -self.water.depth - STILL_WATER:
                limit = f"must not lie below the seabed, z = {-self.water.depth:g} m, where there is no soil"
                yield InputError(f"platform.{key}", place, limit)

    def _open_hulls(self) -> Iterator[InputError]:
        for group in self.sharing:
            hulls = [f.hull for f in group]
            if not any(isinstance(hull, PanelHull) for hull in hulls):
                continue
            edges = openings(hulls, [f.centre for f in group])
            for f in group if len(edges) and not slips(hulls, edges) else ():
                if isinstance(f.hull, PanelHull) and len(f.hull.holes):
                    where = ", ".join(f"{x:.4g}" for x in edges[0].mean(axis=0) - f.centre)
                    limit = f"must be closed below still water: {len(edges)} open edges, the first near ({where}) m"
                    adjoining = "; only where floats adjoin, and interact, may faces be missing"
                    yield InputError(f"floats.{f.name}.{KEY}", f.hull.name, limit + adjoining)

    def _fixed_problems(self) -> Iterator[InputError]:
        if minimal := self.settings.minimal:
            for f in self.floats:
                if not f.motion:
                    yield InputError(f"floats.{f.name}.motion", "[]", f"a fixed body needs {minimal}")
                if f.lines:
                    yield InputError(f"floats.{f.name}.lines", f"{len(f.lines)} lines", f"catenaries need {minimal}")
        moving = {""} if self.platform else set()
        for f, standing in zip(self.floats, self.standing, strict=True):
            if f.motion or f.on in moving:
                moving.add(f.name)
            if standing and f.on in moving:
                limit = f"stands on the seabed, and must not be carried by {f.on or 'the platform'}, which moves"
                yield InputError(f"floats.{f.name}.hull", f"draft {f.hull.draft:g} m", limit)

    def _output_problems(self) -> Iterator[InputError]:
        outputs = self.settings.outputs
        if self.settings.rao and self.settings.method == "time" and self.sea.amplitude.any():
            apart = np.diff(self.sea.omega, prepend=0.0).min()
            if not self.settings.duration * apart >= 2 * np.pi * (1 - 1e-9):
                limit = f"must be >= {2 * np.pi / apart if apart else np.inf:.4g} s for rao, to tell the waves apart"
                yield InputError("settings.duration", self.settings.duration, limit)
        if self.platform is None:
            return
        at_feet = [name for name in ("fibre_stress", "fatigue") if name in outputs]
        if at_feet and not self.platform.legs:
            yield InputError("settings.outputs", at_feet[0], "is of the feet of legs: platform.legs must name some")
        if "leg_tops" in outputs and not at_feet:
            yield InputError("settings.outputs", "leg_tops", "is of fibre_stress or fatigue: ask for one of them, too")
        if "utilisation" in outputs:
            yield from self._utilisation_problems(self.platform.frame)
        members = len(self.platform.frame.members)
        for name in {"section_forces", "member_stress"} & set(outputs) if members > MOST_SECTIONS else ():
            limit = f"must be left out with more than {MOST_SECTIONS} members; there are {members}"
            yield InputError("settings.outputs", name, limit)
        if "accelerations" in outputs and (nodes := len(self.platform.frame.nodes)) > MOST_SECTIONS:
            limit = f"must be left out with more than {MOST_SECTIONS} nodes; there are {nodes}"
            yield InputError("settings.outputs", "accelerations", limit)
        if "static_part" in outputs and not (
            self.platform.legs or {"reactions", "section_forces", "member_stress"} & set(outputs)
        ):
            limit = "is of legs, reactions, section_forces or member_stress: name some"
            yield InputError("settings.outputs", "static_part", limit)

    def _utilisation_problems(self, frame: Frame) -> Iterator[InputError]:
        tubes = list(filter(may_be_utilised, frame.members))
        if not tubes:
            limit = "is of tubes whose material has a yield_strength: there is none"
            yield InputError("settings.outputs", "utilisation", limit)
        if slips := [*of_no_metal(tubes)]:  # of which a slender wall would be told at each tube
            yield from slips
            return
        for member in tubes:
            if member.end_section is not None:
                limit = "must be left out for utilisation: 6.5 of N-004, of cones, is not here"
                yield InputError(f"platform.members.{member.name}.end_section", member.end_section.shape, limit)
            if member.flooded is False and frame.ends(member)[:, 2].min() < 0:
                limit = "must be left out below still water for utilisation: 6.3.9 of N-004, of pressure, is not here"
                yield InputError(f"platform.members.{member.name}.flooded", False, limit)
            try:
                resistance(member, frame.buckling_length(member), self.settings.utilisation.material_factor)
            except InputError as error:
                yield error
        if (count := sum(m.elements for m in tubes)) > MOST_CHECKED:
            limit = f"must be left out with more than {MOST_CHECKED} elements of tubes; there are {count}"
            yield InputError("settings.outputs", "utilisation", limit)

    def _drift_problems(self) -> Iterator[InputError]:
        """What the waves far off do not tell of, or tell wrongly."""
        s, key = self.settings, "settings.outputs"
        if "drift" not in s.outputs:
            return
        if s.method != "frequency":
            yield InputError(key, "drift", 'needs method = "frequency"')
        whole = s.diffraction and s.radiation and s.interaction and s.froude_krylov != "none"
        if not (self.floats and whole):
            limit = "is of floats that feel whole waves: diffraction, radiation and interaction, linear Froude-Krylov"
            yield InputError(key, "drift", limit)

    def _law_problems(self) -> Iterator[InputError]:
        """Joint laws that the method does not have."""
        s, jumping = self.settings, ("coulomb", "one_way", "latch_load", "declutch_load")
        for f in self.floats if s.method == "frequency" else ():
            if f.pto_table is not None and not f.pto_table.alike:
                limit = 'needs method = "time": it goes by position, or is not alike in both senses'
                given = "pto_table" if f.pto_table.finer is None else "pto_law"
                yield InputError(f"floats.{f.name}.{given}", "given", limit)
        for f in self.floats:
            for name in (*jumping, "force_limit", "end_stops"):
                value, usual = getattr(f, name), STARTS.get(name)  # None of end stops
                if value is usual or (usual is not None and not np.any(np.not_equal(value, usual))):
                    continue
                value = "given" if name == "end_stops" else value
                if s.method == "frequency" and name in ("end_stops", "one_way", "latch_load", "declutch_load"):
                    yield InputError(f"floats.{f.name}.{name}", value, 'needs method = "time": it is not linear')
                elif s.minimal and name in jumping:
                    yield InputError(f"floats.{f.name}.{name}", value, f"needs {s.minimal}: it jumps")

    def _load_problems(self) -> Iterator[InputError]:
        """Currents and loads that change with time, where nothing or no method takes them."""
        s, histories = self.settings, self.platform.load_histories if self.platform else ()
        if self.current:
            if self.platform is None:
                yield InputError("current", "given", "acts on the members of an elastic platform: needs one")
            if self.current.exponent and np.isinf(self.water.depth):
                yield InputError("current.exponent", self.current.exponent, "needs water of finite depth, or a profile")
            if s.minimal:
                yield InputError("current", "given", f"needs {s.minimal}")
        if self.platform and self.platform.wave_stretching != "none" and s.minimal:
            yield InputError("platform.wave_stretching", self.platform.wave_stretching, f"needs {s.minimal}")
        for history in histories:
            key, end = f"platform.load_histories.{history.node}", s.discard + s.duration
            if s.method == "frequency":
                yield InputError(key, "given", 'needs method = "time": it is no response to waves')
            elif s.minimal:
                yield InputError(key, "given", f"needs {s.minimal}")
            elif history.time[0] > 0 or history.time[-1] < end * (1 - 1e-9):
                span = f"{history.time[0]:g} to {history.time[-1]:g} s"
                yield InputError(f"{key}.time", span, f"must last from 0 to {end:g} s, the end of the run")

    def _carrier_problems(self) -> Iterator[InputError]:
        names = [f.name for f in self.floats]
        yield from on_others((f.name, f.on) for f in self.floats) if self.platform else unlisted(self.floats)
        for i, f in enumerate(self.floats):
            if names.index(f.name) < i:
                yield InputError("floats.name", f.name, f"given {names.count(f.name)} times, must be unique")
            if self.platform and f.name not in self.platform.hinge_nodes:
                yield InputError("platform.hinge_nodes", f.name, "no node carries this float's hinge")
            elif self.platform:
                yield from self._misplaced(f, self.platform)

    def _misplaced(self, f: Float, platform: Platform) -> Iterator[InputError]:
        """A hinge whose node is not there, or elsewhere."""
        key, node, nodes = "platform.hinge_nodes", platform.hinge_nodes[f.name], platform.frame.nodes
        if node not in nodes:
            yield InputError(key, node, f"must be a node of the frame, which carries the hinge of {f.name}")
            return
        place, size = np.array(nodes[node]), np.ptp(list(nodes.values()), axis=0).max()
        if not np.linalg.norm(place - f.hinge) <= MISPLACED * size:
            hinged = point_text(np.array(f.hinge))
            yield InputError(key, node, f"lies at {point_text(place)}, and must where {f.name} is hinged, at {hinged}")

    @property
    def sharing(self) -> tuple[tuple[Float, ...], ...]:
        """The floats by what water they share: all of them the same, or without interaction each its own."""
        return (self.floats,) if self.settings.interaction else tuple((f,) for f in self.floats)

    @property
    def offsets(self) -> np.ndarray:
        """(nj,) of all floats' axes, from their rest [m or rad]."""
        return np.concatenate([np.zeros(0), *(f.per_axis("offset") for f in self.floats)])

    def has_gap(self, width: float) -> bool:
        """Whether water at rest has a gap between floats, or a well, in which no circle of that diameter [m] fits."""
        for group in self.sharing:
            hulls, centres = [f.hull for f in group], np.array([f.centre for f in group])
            length = min(width / 4, *(panel_side(hull, PANELS) for hull in hulls))
            length = max(length, width / FINEST)  # or a small body's would be laid all round a large one
            if len(gaps(hulls, centres, width, length)):
                return True
        return False

    def meetings(self, strokes: Mapping[str, Stroke]) -> Iterator[tuple[str, str, str]]:
        """Names of floats whose hulls meet as joints of one axis move within `strokes` [rad or m], and at which places.

        Of those on one support, or of which one carries the other: of others the joints do not tell how near they get.
        """
        for a, b in (pair for group in self.sharing for pair in combinations(group, 2)):
            # What carries the other takes it along.
            first = strokes.get(a.name, (0.0, 0.0)) if b.on != a.name else (0.0, 0.0)
            second = strokes.get(b.name, (0.0, 0.0)) if a.on != b.name else (0.0, 0.0)
            if any((*first, *second)) and (b.on in (a.on, a.name) or a.on == b.name):
                at = meeting(a.jointed, b.jointed, (first, second))
                if at is not None:
                    moved = (pair[:2] for pair in zip((a, b), at, (b, a), strict=True) if pair[2].on != pair[0].name)
                    each = (f"{place:+.3g} {'m' if item.jointed.slides else 'rad'}" for item, place in moved)
                    yield a.name, b.name, " and ".join(each)

    @property
    def carriers(self) -> tuple[int, ...]:
        """Number of the float that carries each float's hinge; -1: the support."""
        names = [f.name for f in self.floats]
        return tuple(names.index(f.on) if f.on else -1 for f in self.floats)

    def bearers(self, b: int) -> Iterator[int]:
        """Number of a float, and of each that carries the one before, up to the support."""
        carriers = self.carriers
        while b >= 0:
            yield b
            b = carriers[b]

    @property
    def standing(self) -> tuple[bool, ...]:
        """Which floats stand on the seabed."""
        return tuple(stands(f.hull, self.water.depth) for f in self.floats)

    @property
    def nonlinear(self) -> tuple[bool, ...]:
        """On which floats pressure is integrated up to the waves' surface; on those that stand it is linear."""
        asked = self.settings.froude_krylov == "body-nonlinear"
        return tuple(asked and not standing for standing in self.standing)

    @property
    def longest_step(self) -> float:
        """A sixth of the shortest wave's period [s]."""
        return float(2 * np.pi / self.sea.omega.max() / 6)

    @property
    def usual_step(self) -> float:
        """By the shortest wave [s]: STEPS in its period, to two digits downwards."""
        return two_digits(6 * self.longest_step / STEPS)

    @property
    def planar(self) -> bool:
        """Scene and sea are mirror images of themselves in y = 0, so nothing leaves the plane."""
        flat = is_planar(self.floats, self.sea.heading, self.current)
        return flat and stays_in_plane(self.platform, self.floats, self.water)


def stays_in_plane(platform: Platform | None, floats: Iterable[Float], water: Water) -> bool:
    """Whether a platform that floats are on is its own image in y = 0, and nothing pulls it out of that plane."""
    return platform is None or (platform.symmetric(water) and lines_mirrored(floats))


def two_digits(step: float) -> float:
    """The largest number of two digits that is not above a step."""
    digit = 10.0 ** (np.floor(np.log10(step)) - 1)
    return float(f"{np.floor(step / digit * (1 + 1e-9)) * digit:.2g}")


def require_waves(scene: Scene) -> None:
    """Refuse the frequency domain in a still sea."""
    if scene.settings.method == "frequency" and not scene.sea.amplitude.any():
        raise InputError("settings.method", "frequency", "needs waves: a decay is a matter of the time domain")
