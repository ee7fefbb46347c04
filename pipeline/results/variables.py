"""The one table of names: what every output is called, its unit, and what it means."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from fnmatch import fnmatchcase
from functools import lru_cache
from typing import Any, NamedTuple

from pipeline.study.axes import Axis
from pipeline.study.paths import unit
from pipeline.study.words import labels, last


class Meaning(NamedTuple):
    """CF attributes of a variable; the standard name only where CF has one."""

    units: str | None
    long_name: str
    standard_name: str | None = None

    def attrs(self) -> dict[str, str]:
        """As netCDF attributes."""
        named = zip(("units", "long_name", "standard_name"), self, strict=True)
        return {key: value for key, value in named if value is not None}


WAVE = "sea_surface_wave_"

VARIABLES = {
    "rotation": Meaning("rad", "Rotation of the float about its hinge axis, from rest, right-handed"),
    "motion": Meaning("{axis}", "Motion of the float along each free axis of its joint, from rest"),
    "band_frequency": Meaning("rad s-1", "Middle of the band of frequencies"),
    "rao": Meaning("{axis} m-1", "Amplitude of the motion along each free axis per wave amplitude"),
    "rao_phase": Meaning("rad", "Lag of that motion behind the elevation at the origin"),
    "wave_frequency": Meaning("rad s-1", "Angular frequency of each wave of the realization"),
    "mass": Meaning("kg", "Mass of the float, given or found from weight and buoyancy"),
    "cog": Meaning("m", "Centre of gravity of the float, from its reference point, given or found"),
    "preload": Meaning("{load}", "Constant load along the axis, given or found to hold the float: N, or N m"),
    "absorbed_power": Meaning("W", "Mechanical power absorbed by the power take-off"),
    "capture_width": Meaning("m", "Width of the waves' crests that carries the mean power which the float absorbs"),
    "electrical_power": Meaning(
        "W",
        "Electrical power of the power take-off, what its stiffness exchanges included; NaN of floats without"
        " pto_efficiency, whose absorbed_power stands for it",
    ),
    "pto_force": Meaning("{load}", "Load of the power take-off on the float along each free axis: N, or N m"),
    "pto_rate": Meaning("{axis} s-1", "Rate of each free axis, at which the power take-off works"),
    "pto_stroke": Meaning("{axis}", "Farthest way of an axis from one end to the other in the analysed time"),
    "pto_travel": Meaning("{axis} h-1", "Way of an axis to and fro, an hour"),
    "latched": Meaning("1", "Whether the axis is held by its latch; the mean is the share of the time"),
    "declutched": Meaning("1", "Whether the power take-off has let go of the axis; the mean is the share of the time"),
    "hinge_force": Meaning("N", "Force of the hinge on the float"),
    "line_tension": Meaning("N", "Tension of the mooring line at its fairlead, where the float is: quasi-static"),
    "end_stop_hits": Meaning("1", "Number of times that the float met an end stop of its joint in the analysed time"),
    "end_stop_hit_rate": Meaning("h-1", "Number of times that the float met an end stop of its joint, an hour"),
    "impact_rate": Meaning("{axis} s-1", "Largest rate at which an axis of the joint met an end stop"),
    "end_stop_load": Meaning("{load}", "Largest load of an end stop on an axis of the joint: N, or N m"),
    "drift_force": Meaning("N", "Mean drift force of the waves on all floats together, of second order; x and y"),
    "drift_force_per_wave": Meaning("N m-2", "Mean drift force of each wave of the realization, per amplitude squared"),
    "drift_moment": Meaning("N m", "Mean drift moment about the vertical through the support's joint, or the origin"),
    "drift_offset": Meaning("{axis}", "Mean offset of the moored support by drift force and moment, linear"),
    "slow_drift": Meaning("{axis}", "Standard deviation of the moored support's slow drift about that offset"),
    "top_displacement": Meaning("m", "Displacement of the top of the leg from static equilibrium"),
    "static_displacement": Meaning("m", "Displacement of the top of the leg by weight, buoyancy and constant loads"),
    "node_acceleration": Meaning("m s-2", "Acceleration of the platform's node"),
    "bottom_stress": Meaning("Pa", "Stress of the most compressive fibre at the bottom of the leg"),
    "displacement_envelope": Meaning("m", "Largest absolute displacement along the leg"),
    "stress_envelope": Meaning("Pa", "Largest size of a stress in the section along the leg, |N/A| + |M|c/I"),
    "reaction_force": Meaning("N", "Force of the ground on the foot, weight and static loads included"),
    "reaction_moment": Meaning(
        "N m", "Moment of the ground on the foot, or of soil about where its member enters the seabed"
    ),
    "base_shear": Meaning("N", "Force of the platform on the ground, all feet together"),
    "overturning_moment": Meaning("N m", "Moment of the platform on the ground about moment_point, all feet together"),
    "moment_point": Meaning("m", "Place that overturning_moment is about: amid the feet, as low as the lowest"),
    "pile_force": Meaning("N", "Effective axial force at the foot of the leg, tension positive"),
    "section_force": Meaning("N", "Section force at the end of the member, on the face towards its end, own axes"),
    "section_moment": Meaning("N m", "Section moment at the end of the member, on the face towards its end, own axes"),
    "member_stress": Meaning("Pa", "Stress of a fixed fibre at the end of the member, tension positive"),
    "member_fibre_y": Meaning("m", "Place of the member's fibre along its own axis y"),
    "member_fibre_z": Meaning("m", "Place of the member's fibre along its own axis z"),
    "fibre_stress": Meaning("Pa", "Stress of a fixed fibre at the foot of the leg, tension positive"),
    "fibre_stress_top": Meaning("Pa", "Stress of a fixed fibre at the top of the leg, tension positive"),
    "fibre_place": Meaning("m", "Place of the fibre from the leg's axis"),
    "fibre_angle": Meaning("rad", "Angle of the fibre in the leg's section, from its axis y towards its axis z"),
    "utilisation": Meaning(
        "1", "Largest of the tube by NORSOK N-004, 6.3: axial force, bending, buckling, shear; fails above 1"
    ),
    "shear_utilisation": Meaning("1", "The part of it by shear and torsion at the tube's ends, NORSOK N-004, 6.3.5"),
    "damage": Meaning("h-1", "Fatigue damage by Miner's sum, an hour"),
    "damage_top": Meaning("h-1", "Fatigue damage at the top of the leg by Miner's sum, an hour"),
    "equivalent_range": Meaning("Pa", "Range of hot-spot stress that does the same damage in equivalent_cycles"),
    "equivalent_range_top": Meaning("Pa", "Range of hot-spot stress at the top that does the same damage"),
    "equivalent_exponent": Meaning("1", "Exponent m of the damage-equivalent range"),
    "equivalent_cycles": Meaning("h-1", "Cycles that the damage-equivalent range refers to"),
    "wave_elevation": Meaning(
        "m", "Elevation of the sea surface at the origin", "sea_surface_height_above_mean_sea_level"
    ),
    "natural_frequency": Meaning(
        "rad s-1", "Natural angular frequency of the platform without added mass, lowest first"
    ),
    "system_period": Meaning("s", "Natural period of the coupled system in water, undamped, slowest first"),
    "Hm0": Meaning("m", "Significant wave height of the realization", WAVE + "significant_height"),
    "Tp_realized": Meaning("s", "Peak period of the realization", WAVE + "period_at_variance_spectral_density_maximum"),
    "Te": Meaning(
        "s",
        "Energy period of the realization",
        WAVE + "mean_period_from_variance_spectral_density_inverse_frequency_moment",
    ),
    "Tz": Meaning(
        "s",
        "Zero-upcrossing period of the realization, from moments",
        WAVE + "mean_period_from_variance_spectral_density_second_frequency_moment",
    ),
    "wave_power": Meaning("W m-1", "Mean power that the realization's waves carry through a metre of their crests"),
    "buckling_factor": Meaning("1", "Factor on its weight and constant loads by which the platform buckles"),
    "stored_energy_change": Meaning("J", "Change of kinetic and potential energy over the run"),
    "work_wave": Meaning(
        "J", "Work on the floats of the water's pressure, of still water too, of lines and excitation"
    ),
    "work_radiation": Meaning("J", "Work of the radiation memory"),
    "work_pto": Meaning("J", "Work taken by the power take-offs"),
    "work_joint_damping": Meaning("J", "Work taken by damping in the joints besides the power take-offs"),
    "work_frame_inertia": Meaning("J", "Work of wave inertia loads and load histories on the platform"),
    "work_frame_drag": Meaning("J", "Work of drag on the platform"),
    "work_structural": Meaning("J", "Work taken by structural damping"),
    "energy_residual": Meaning("1", "What the energy balance is open by, over the largest energy exchanged"),
    "constraint_drift": Meaning("m", "Largest distance of a hinge from its place"),
    "constraint_drift_velocity": Meaning("m s-1", "Largest velocity at which a hinge leaves its place"),
    "constraint_drift_acceleration": Meaning("m s-2", "Largest acceleration at which a hinge leaves its place"),
    "estimated_error": Meaning(
        "1", "Estimated relative error of any mean, rms or std: step, samples, quadrature, memory, mesh, laws"
    ),
    "discretization_error": Meaning("1", "Estimated relative error of the time discretization"),
    "sampling_error": Meaning("1", "Estimated relative error of samples: jumps between them, the record's ends"),
    "field_error": Meaning("1", "Share of the wave amplitudes' sum that the local series left out at a hull, at most"),
    "seabed_error": Meaning("1", "Share of a coefficient that the seabed has, at most, where it was left out"),
    "quadrature_error": Meaning("1", "Estimated relative error of the pressure's quadrature"),
    "memory_effect": Meaning(
        "1", "Relative error that the misfit of the radiation memory makes in the linear response, or beside the waves"
    ),
    "mesh_error": Meaning("1", "Estimated relative error of the coefficients by the boundary elements' mesh, at most"),
    "mesh_effect": Meaning("1", "Relative error that the boundary elements' mesh makes in the linear response"),
    "stations_effect": Meaning("1", "Relative error by the stations of the frame's drag, of a run with twice as many"),
    "law_effect": Meaning("1", "Relative error by the tables of power take-offs' laws, of runs with finer ones"),
    "drag_effect": Meaning("1", "Relative error by what the members' linear drag leaves out, in the frequency domain"),
    "linearisation_effect": Meaning(
        "1", "Relative error by what linear loads leave of those of joints and lines, in the frequency domain"
    ),
    "rotation_effect": Meaning(
        "1", "Relative error by arms' exact rotation, also at resonances below the waves, in the frequency domain"
    ),
    "shapes_effect": Meaning("1", "Relative error that the frame's left-out shapes make in the linear response"),
    "elements_effect": Meaning("1", "Relative error that the frame's elements make in the linear response"),
    "memory_error": Meaning("1", "Largest relative misfit of the radiation memory"),
    "memory_poles": Meaning("1", "Number of exponentials of the radiation memory"),
    "drag_rounds": Meaning("1", "Rounds until the linearised drag agreed with its own result"),
    "wall_time": Meaning("s", "Time that the task took to compute"),
    "status": Meaning(None, "Outcome of the task: done, failed, missing, stale (older model), damaged; or no task"),
    "task": Meaning(None, "Identity of the task"),
    "failure": Meaning(None, "Why the task failed, empty if it did not"),
    "unmet": Meaning(None, "What was asked of the task and not met, empty if all was"),
    "warnings": Meaning(None, "What is odd about the task, empty if nothing is"),
}

# One number each for a record.
OF_RECORDS = (
    "end_stop_hits", "end_stop_hit_rate", "impact_rate", "end_stop_load", "pto_stroke", "pto_travel",
    "drift_force", "drift_moment", "drift_offset", "slow_drift",
)  # fmt: skip

# Numerical choices. A dataset has those that are the same in all its tasks as attributes of the file.
KNOBS = {
    "tolerance": Meaning("1", "Relative error that was asked for"),
    "time_step": Meaning("s", "Time step"),
    "modes": Meaning("1", "Number of the platform's lowest modes that are kept, besides static load shapes"),
    "azimuths": Meaning("1", "Number of azimuths of the pressure's quadrature"),
    "arc_points": Meaning("1", "Number of quadrature points on a meridian's arc"),
    "line_points": Meaning("1", "Number of quadrature points on a meridian's straight part"),
    "panel_size": Meaning("1", "Longest side of a mesh's triangles, relative to the hull and to the mean wave"),
    "field_tolerance": Meaning("1", "Tolerance of the local wave field, relative to the sum of amplitudes"),
    "memory_tolerance": Meaning("1", "Tolerance of the radiation memory's fit"),
    "stations_per_element": Meaning("1", "Number of points of an element at which drag is taken"),
    "newton_tolerance": Meaning("m", "Newton's last update of a position, or of an angle in rad"),
}

COORDINATES = {
    "sea_state": Meaning(None, "Label of the sea state"),
    "Hs": Meaning("m", "Nominal significant wave height", WAVE + "significant_height"),
    "Tp": Meaning("s", "Nominal peak period", WAVE + "period_at_variance_spectral_density_maximum"),
    "occurrence": Meaning("1", "How often the sea state comes, as a weight of means over sea states"),
    "wave_height": Meaning("m", "Height of the regular wave, crest to trough"),
    "wave_period": Meaning("s", "Period of the regular wave"),
    "platform": Meaning(None, "Support of the floats"),
    "pto_damping": Meaning(None, "Damping of each power take-off"),  # in the unit of the floats' axes, see of_path
    "hinge_spacing": Meaning("m", "Distance of the hinges along x"),
    "seed": Meaning("1", "Number of the wave realization"),
    "variant": Meaning(None, "Name of the set of values"),
    "variant_title": Meaning(None, "What the variant is"),
    "float": Meaning(None, "Name of the float"),
    "component": Meaning("1", "Number of the wave in its realization, from 1"),
    "axis": Meaning(None, "Free axis of the joint"),
    "axis_unit": Meaning(None, "Unit of motion along the axis; of loads it is N along m, N m about rad"),
    "line": Meaning(None, "Mooring line: its float, and its number there from 1"),
    "leg": Meaning("1", "Number of the leg in the study file, from 1"),
    "direction": Meaning(None, "Axis of the component"),
    "node": Meaning(None, "Name of the platform's node"),
    "foot": Meaning(None, "Name of the node, clamped or on a foundation; soil:<member> of what soil holds"),
    "member": Meaning(None, "Name of the member"),
    "tube": Meaning(None, "Name of the tube that is utilised"),
    "end": Meaning(None, "End of the member"),
    "force": Meaning(None, "Axial force N, shear forces Vy and Vz"),
    "moment": Meaning(None, "Torsion T, bending moments My and Mz"),
    "member_fibre": Meaning("1", "Number of the fibre in the member's section: eight round a tube, or its corners"),
    "fibre": Meaning("1", "Number of the fibre in the leg's section: eight round a tube, a rectangle's corners"),
    "height": Meaning("m", "Height above the foot of the leg", "height"),
    "statistic": Meaning(
        None,
        "Over the analysed time; max, min of parabolas through samples, in the frequency domain as expected of it; std"
        " with ddof 0",
    ),
    "mode": Meaning("1", "Number of the mode, from 1"),
    "system_mode": Meaning("1", "Number of the system's shape, from 1; a record's system_shapes says what moves"),
    "frequency_band": Meaning("1", "Number of the band of frequencies that spectra are means over, from 1"),
    "elapsed_time": Meaning("s", "Time since the start of the simulation"),
}

# Tp is a nominal coordinate of the study, and CF wants a calendar behind the name time.
RENAMED = {"Tp": "Tp_realized", "time": "elapsed_time"}
# What a time series is called beside the statistics of the same variable.
SERIES = "_series"
# What an output is called where an axis over its key has the name.
FOUND = "_found"
# What goes with an output, and is called after it: unit from its own, and meaning.
OF_OUTPUTS = {
    "_response": ("{} m-1", "Amplitude per wave amplitude"),
    "_response_phase": ("rad", "Lag behind the elevation at the origin"),
    "_coherence": ("1", "Share of the variance that follows the waves linearly"),
    "_spectrum": ("{}2 s rad-1", "Variance density by angular frequency"),
    "_crossing_rate": ("s-1", "Upcrossings of its mean a second"),
    "_m0": ("{}2", "Spectral moment of order 0"),
    "_m1": ("{}2 rad s-1", "Spectral moment of order 1"),
    "_m2": ("{}2 rad2 s-2", "Spectral moment of order 2"),
    "_m4": ("{}2 rad4 s-4", "Spectral moment of order 4"),
    "_static": ("{}", "Of weight, buoyancy and constant loads alone"),
}
LOADS = {"m": "N", "rad": "N m"}  # unit of a load along an axis by that of its motion
SLIDING = {"surge", "sway", "heave"}  # the other axes turn


def output_of(name: str) -> str:
    """The output that what has this name goes with, or the name itself."""
    suffixes = (SERIES, FOUND, *OF_OUTPUTS)
    return next((name.removesuffix(suffix) for suffix in suffixes if name.endswith(suffix)), name)


def known(name: str) -> bool:
    """Whether a dataset may have an output, or what goes with one, of this name."""
    return any(each in table for each in (name, output_of(name)) for table in (VARIABLES, KNOBS, COORDINATES))


def axis_units(axes: Iterable[str]) -> list[str]:
    """Unit of motion along each axis."""
    return ["m" if axis in SLIDING else "rad" for axis in axes]


def meaning(name: str, axes: Iterable[str] = ()) -> dict[str, str]:
    """Attributes of a variable or coordinate; an unlisted one is only named.

    axes: of the joints; where some slide and some turn, what goes with both has no unit but theirs.
    """
    return dict(_meaning(name, tuple(axes)))


@lru_cache(maxsize=1024)
def _meaning(name: str, axes: tuple[str, ...]) -> dict[str, str]:
    name = name.removesuffix(SERIES).removesuffix(FOUND)
    for suffix, (pattern, words) in OF_OUTPUTS.items():
        if name.endswith(suffix):
            return _spectral(_meaning(name.removesuffix(suffix), axes), pattern, words)
    known = VARIABLES.get(name) or KNOBS.get(name) or COORDINATES.get(name)
    attrs = known.attrs() if known else {"long_name": name.replace("_", " ")}
    if "{" in attrs.get("units", ""):
        pattern, units = attrs.pop("units"), set(axis_units(axes))
        attrs |= {"units": pattern.format(axis=(of := units.pop()), load=LOADS[of])} if len(units) == 1 else {}
    return attrs | {"positive": "up"} if name == "height" else attrs


def _spectral(of: dict[str, str], pattern: str, words: str) -> dict[str, str]:
    """Attributes of an output's spectrum and the like, from the output's own; without units where that has none."""
    own, rest = of.get("units", ""), pattern.removeprefix("{}2")
    if own == "1" and rest != pattern:  # "12" would be twelve
        units = {"units": rest.strip() or "1"}
    elif own or "{}" not in pattern:
        units = {"units": pattern.format(f"({own})" if " " in own and rest != pattern else own)}
    else:
        units = {}
    return {**units, "long_name": f"{words}: {of['long_name']}"}


def meaning_of(axis: Axis, motions: Mapping[str, Sequence[str]]) -> dict[str, str]:
    """Attributes of a dimension over keys: unit and path of its only key; motions: of each float's joint."""
    if axis.name in COORDINATES and not any(" or " in unit(path) for path in axis.keys):  # which goes by the motions
        attrs = COORDINATES[axis.name].attrs()
        return attrs if axis.own or not axis.keys else {**attrs, "comment": f"Values of {', '.join(axis.keys)}"}
    if not axis.own:
        units = {} if isinstance(axis.labels[0], str) else {"units": "1"}
        return {**units, "long_name": f"Values of {', '.join(axis.keys)}"}
    return of_path(next(iter(axis.keys)), axis.labels, motions)


def along(axis: Axis, motions: Mapping[str, Sequence[str]]) -> Iterator[tuple[str, tuple[Any, ...], dict[str, str]]]:
    """Name, values and attributes of what changes together along a dimension."""
    for path, values in axis.keys.items():
        if not axis.own and path not in axis.partial:
            shown = labels(values)
            yield axis.names[path], shown, of_path(path, shown, motions)
    for word, values in axis.beside.items():
        name, _, symbol = word.removesuffix("]").partition(" [")
        unit_of = {} if isinstance(labels(values)[0], str) else {"units": udunits(symbol)}
        yield name, labels(values), {"long_name": name.replace("_", " "), **unit_of}


def of_path(path: str, shown: Sequence[object], motions: Mapping[str, Sequence[str]]) -> dict[str, str]:
    """Attributes of values of a key; motions: of each float's joint, by which the key's unit may go."""
    attrs = {"long_name": f"{last(path).replace('_', ' ')} ({path})"}
    if isinstance(shown[0], str):
        return attrs
    turning, _, sliding = unit(path).partition(" or ")
    place = last(path).rpartition(".")[2]
    if place.isdecimal() and "," in turning:
        return attrs  # a list whose numbers have several units
    which = path.split(".")[1] if path.startswith("floats.") else ""  # a name, or a pattern of several
    own = [of for name, of in motions.items() if fnmatchcase(name, which)]
    one = slice(int(place), int(place) + 1) if place.isdecimal() else slice(None)
    along = {axis for each in own or motions.values() for axis in each[one]}
    if sliding and ((along & SLIDING and along - SLIDING) or (place.isdecimal() and not along)):
        return attrs  # some of the axes turn and some slide
    return {"units": udunits(sliding if sliding and along <= SLIDING else turning), **attrs}


def udunits(symbol: str) -> str:
    """N m s/rad as N m s rad-1; nothing and - as 1."""
    above, slash, below = symbol.partition("/")
    if symbol in ("", "-"):
        return "1"
    letters = below.rstrip("0123456789")
    return f"{above} {letters}-{below[len(letters) :] or 1}" if slash else above
