"""The one table of names: what every output is called, its unit, and what it means."""

from __future__ import annotations

from typing import NamedTuple


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
    "motion": Meaning(None, "Motion of the float along each free axis of its joint, from rest, in m or rad"),
    "rao": Meaning(None, "Amplitude of the motion along each free axis per wave amplitude, in m/m or rad/m"),
    "rao_phase": Meaning("rad", "Lag of that motion behind the elevation at the origin"),
    "wave_frequency": Meaning("rad s-1", "Angular frequency of each wave of the realization"),
    "absorbed_power": Meaning("W", "Mechanical power absorbed by the power take-off"),
    "pto_moment": Meaning("N m", "Moment of the power take-off on the float about the hinge axis"),
    "hinge_force": Meaning("N", "Force of the hinge on the float"),
    "hinge_moment": Meaning("N m", "Moment of the hinge on the float, without that of the power take-off"),
    "top_displacement": Meaning("m", "Displacement of the top of the leg from static equilibrium"),
    "bottom_stress": Meaning("Pa", "Stress of the most compressive fibre at the bottom of the leg"),
    "displacement_envelope": Meaning("m", "Largest absolute displacement along the leg"),
    "stress_envelope": Meaning("Pa", "Largest absolute stress along the leg"),
    "wave_elevation": Meaning(
        "m", "Elevation of the sea surface at the origin", "sea_surface_height_above_mean_sea_level"
    ),
    "natural_frequency": Meaning("rad s-1", "Natural angular frequency of the dry platform"),
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
    "buckling_factor": Meaning("1", "Euler load over gravity load of the platform"),
    "samples_per_second": Meaning("s-1", "Samples of the record in a second"),
    "stored_energy_change": Meaning("J", "Change of kinetic and potential energy over the run"),
    "work_wave": Meaning("J", "Work of wave pressure and excitation on the floats"),
    "work_radiation": Meaning("J", "Work of the radiation memory"),
    "work_pto": Meaning("J", "Work taken by the power take-offs"),
    "work_joint_drag": Meaning("J", "Work taken by quadratic damping in the joints"),
    "work_frame_inertia": Meaning("J", "Work of wave inertia loads on the platform"),
    "work_frame_drag": Meaning("J", "Work of drag on the platform"),
    "work_structural": Meaning("J", "Work taken by structural damping"),
    "repeat_period": Meaning("s", "Time after which the wave record repeats itself"),
    "energy_residual": Meaning("1", "Energy that the balance does not account for, as a share of the wave work"),
    "constraint_drift": Meaning("m", "Largest distance of a hinge from its place"),
    "discretization_error": Meaning("1", "Estimated relative error of the time discretization"),
    "static_stress": Meaning("Pa", "Static stress at the bottom of the leg, without waves"),
    "time_step": Meaning("s", "Time step"),
    "wall_time": Meaning("s", "Time that the task took to compute"),
    "status": Meaning(None, "Outcome of the task: done, failed, missing, stale (older model) or damaged"),
    "task": Meaning(None, "Identity of the task"),
    "unmet": Meaning(None, "What was asked of the task and not met, empty if all was"),
}

COORDINATES = {
    "sea_state": Meaning(None, "Label of the sea state"),
    "Hs": Meaning("m", "Nominal significant wave height", WAVE + "significant_height"),
    "Tp": Meaning("s", "Nominal peak period", WAVE + "period_at_variance_spectral_density_maximum"),
    "wave_height": Meaning("m", "Height of the regular wave, crest to trough"),
    "wave_period": Meaning("s", "Period of the regular wave"),
    "platform": Meaning(None, "Support of the floats"),
    "pto_damping": Meaning("N m s rad-1", "Rotational damping of each power take-off"),
    "hinge_spacing": Meaning("m", "Distance of the hinges along x"),
    "seed": Meaning("1", "Number of the wave realization"),
    "float": Meaning(None, "Name of the float"),
    "component": Meaning("1", "Number of the wave in its realization, from 1"),
    "axis": Meaning(None, "Free axis of the joint"),
    "leg": Meaning(None, "Name of the leg"),
    "direction": Meaning(None, "Axis of the component"),
    "height": Meaning("m", "Height above the foot of the leg", "height"),
    "statistic": Meaning(None, "Over the analysed time; max, min of parabolas through samples, std with ddof 0"),
    "mode": Meaning("1", "Number of the mode, from 1"),
    "elapsed_time": Meaning("s", "Time since the start of the simulation"),
}

# Tp is a nominal coordinate of the study, and CF wants a calendar behind the name time.
RENAMED = {"Tp": "Tp_realized", "time": "elapsed_time"}
# What a time series is called beside the statistics of the same variable.
SERIES = "_series"


def meaning(name: str) -> dict[str, str]:
    """Attributes of a variable or coordinate; an unlisted one is only named."""
    name = name.removesuffix(SERIES)
    known = VARIABLES.get(name) or COORDINATES.get(name)
    attrs = known.attrs() if known else {"long_name": name.replace("_", " ")}
    return attrs | {"positive": "up"} if name == "height" else attrs
