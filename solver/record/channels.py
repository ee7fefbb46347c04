"""What is put out of a scene, by which names and labels."""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np

from solver.coupled.natural import SystemModes
from solver.coupled.support import Support
from solver.multibody.bodies import Bodies, new_motion
from solver.multibody.joint_law import JointLaw
from solver.multibody.minimal import line_tensions
from solver.multibody.of_axes import borne_at_most, pto_bounds, working_rates
from solver.power_takeoff import PtoEfficiency
from solver.record import steel
from solver.record.bound import wave_power
from solver.record.spectra import MOMENTS, Bands, cross_spectra, waveless
from solver.record.steel import Steel
from solver.scene import Scene
from solver.sea.dispersion import wavenumbers
from solver.statistics import STATISTICS
from solver.structure.legs import compressive

ELEVATION = "wave_elevation"
FAINT = 0.05  # a wave below this share of the largest one is less than what others make a float do at its frequency
Labelled = tuple[tuple[str, ...], np.ndarray]


@dataclass(frozen=True, eq=False, kw_only=True)
class Record:
    """name -> (dims, values) for variables and time series, coordinates, and scalars."""

    variables: Mapping[str, Labelled]
    coords: Mapping[str, np.ndarray]
    attrs: Mapping[str, float | str]
    series: Mapping[str, Labelled] = field(default_factory=dict)


DIMS = {
    "wave_elevation": (),
    "rotation": ("float",),
    "motion": ("float", "axis"),
    "absorbed_power": ("float",),
    "electrical_power": ("float",),
    "pto_force": ("float", "axis"),
    "pto_rate": ("float", "axis"),
    "latched": ("float", "axis"),
    "declutched": ("float", "axis"),
    "hinge_force": ("float", "direction"),
    "line_tension": ("line",),
    "top_displacement": ("leg", "direction"),
    "bottom_stress": ("leg",),
    "node_acceleration": ("node", "direction"),
    **steel.DIMS,
}


class Channels:
    """What is put out of a scene, by name and label, and how motions and loads are told as that."""

    def __init__(self, scene: Scene, support: Support | None):
        self.scene = scene
        self.legs = support.legs if support is not None else None
        forces = support.forces if support is not None else None
        self.steel = Steel(forces, scene.settings) if forces is not None else None
        self.frequencies = support.dry_omega if support is not None else np.zeros(0)
        self.static_tops = support.static_tops if support is not None else np.zeros((0, 3))
        asked = "accelerations" in scene.settings.outputs  # which a probe's scene is not
        self.nodes = support.nodes if support is not None and asked else ()
        self.node_shapes = support.node_shapes if support is not None else np.zeros((0, 0, 3))
        floats = scene.floats
        self.owner = np.array([b for b, f in enumerate(floats) for _ in f.motion], int)  # of each joint axis
        self.names = [name for f in floats for name in f.motion]
        self.axes = list(dict.fromkeys(self.names))
        self.lines = [f"{f.name} {i}" for f in floats for i in range(1, len(f.lines) + 1)]

    @cached_property
    def wave_power(self) -> float:
        """Of the scene's sea [W/m]."""
        return wave_power(self.scene)

    def motions(self, joint: np.ndarray) -> Iterator[tuple[str, np.ndarray]]:
        """`rotation` and `motion` of the joints' axes (m, nj), NaN along axes that a float does not have."""
        moved = self.by_axis(joint)
        if "hinge" in self.axes:
            yield "rotation", moved[:, :, self.axes.index("hinge")]
        if self.axes not in (["hinge"], []):
            yield "motion", moved

    def by_axis(self, joint: np.ndarray) -> np.ndarray:
        """(m, nb, number of axes) of (m, nj)."""
        out = np.full((len(joint), len(self.scene.floats), len(self.axes)), np.nan, joint.dtype)
        out[:, self.owner, [self.axes.index(name) for name in self.names]] = joint
        return out

    def at_axes(self, joint: np.ndarray) -> Labelled:
        """A variable of the record, of one number for each joint (nj,)."""
        return ("float", "axis"), self.by_axis(joint[None])[0]

    def line_tension(self, bodies: Bodies, z: np.ndarray) -> np.ndarray:
        """(m, number of lines) at the bodies' coordinates z (m, nz)."""
        tension = np.zeros((len(z), len(self.lines)))
        line_tensions(bodies, np.ascontiguousarray(z), new_motion(bodies), tension)
        return tension

    def hinge_force(self, wrench: np.ndarray) -> np.ndarray:
        """(m, nb, 3) of all loads on the floats (m, nb, 6)."""
        force = -wrench[:, :, :3]
        for b, carrier in reversed(list(enumerate(self.scene.carriers))):
            if carrier >= 0:  # whose own joint bears what it carries, too
                force[:, carrier] += force[:, b]
        return force

    def accelerations(self, ddp: np.ndarray) -> Iterator[tuple[str, np.ndarray]]:
        """Of the frame's nodes (m, nn, 3), where asked for, of the modes' (m, nm)."""
        if self.nodes:
            yield "node_acceleration", np.tensordot(ddp, self.node_shapes, axes=1)

    def moments(self, of: Mapping[str, tuple[np.ndarray, np.ndarray]]) -> dict[str, Labelled]:
        """Variables of each output's rate of crossings (…) and spectral moments (len(MOMENTS), …)."""
        out: dict[str, Labelled] = {}
        for name, (rate, of_order) in of.items():
            out[f"{name}_crossing_rate"] = DIMS[name], rate
            out |= {f"{name}_m{order}": (DIMS[name], m) for order, m in zip(MOMENTS, of_order, strict=True)}
        return out

    def record(
        self,
        tables: Mapping[str, np.ndarray],
        attrs: Mapping[str, float | str],
        *,
        modes: SystemModes | None = None,
        envelopes: tuple[np.ndarray, np.ndarray] | None = None,
        rao: np.ndarray | None = None,
        series: Mapping[str, np.ndarray] | None = None,
        counted: tuple[Mapping[str, Labelled], tuple[str, ...]] = ({}, ()),
        spectra: Mapping[str, Labelled] | None = None,
        further: Mapping[str, Labelled] | None = None,
    ) -> Record:
        """The record of statistics (…, 5) of each channel, of the legs' envelopes, and of motions per wave (nw, nj).

        counted: other variables of the steel, and what failed of them. further: of the floats, their axes, the whole.
        """
        variables: dict[str, Labelled] = {name: ((*DIMS[name], "statistic"), table) for name, table in tables.items()}
        coords = {
            "statistic": np.array(STATISTICS),
            "float": np.array([f.name for f in self.scene.floats]),
            "direction": np.array(["x", "y", "z"]),
        }
        if self.lines:
            coords["line"] = np.array(self.lines)
        if self.legs is not None:
            coords["leg"], coords["height"] = np.arange(1, len(self.legs.twin) + 1), self.legs.height
            variables["static_displacement"] = ("leg", "direction"), self.static_tops
        if self.steel is not None:
            coords |= self.steel.coords()
            if "static_part" in self.scene.settings.outputs:
                static = dict(self.steel.channels(self.steel.forces.at_rest[None]))
                if self.legs is not None:
                    static["bottom_stress"] = compressive(self.steel.compression(self.steel.forces.at_rest[None]))
                variables |= {f"{name}_static": (DIMS[name], values[0]) for name, values in static.items()}
            variables |= self.steel.variables() | dict(counted[0])
            unmet = "; ".join(note for note in (str(attrs.get("unmet", "")), *counted[1]) if note)
            attrs = {**attrs, **self.steel.attrs(), "unmet": unmet}
        attrs = {**attrs, "wave_power": (flux := self.wave_power)}
        if self.scene.floats and flux > 0:
            variables["capture_width"] = ("float",), tables["absorbed_power"][:, STATISTICS.index("mean")] / flux
        for name, values in zip(("displacement_envelope", "stress_envelope"), envelopes or (), strict=False):
            variables[name] = ("leg", "height"), values
        if self.frequencies.size:
            coords["mode"] = np.arange(1, self.frequencies.size + 1)
            variables["natural_frequency"] = (("mode",), self.frequencies)
        if self.scene.platform is not None:
            attrs = {**attrs, "structural_damping": str(self.scene.platform.damping)}
        if self.nodes:
            coords["node"] = np.array(self.nodes)
        if modes is not None and modes.omega.size:
            coords["system_mode"] = np.arange(1, modes.omega.size + 1)
            variables["system_period"] = ("system_mode",), modes.period
            attrs = {**attrs, "system_shapes": "; ".join(modes.names)}
        if rao is not None:
            variables |= self._rao(rao)
        if spectra is not None:
            variables |= spectra
            coords["frequency_band"] = np.arange(1, len(variables["band_frequency"][1]) + 1)
        variables |= further or {}
        used = {dim for dims, _ in variables.values() for dim in dims}
        if "axis" in used:
            coords["axis"] = np.array(self.axes)
        if "component" in used:  # of drift too, which fixed bodies have
            coords["component"] = np.arange(1, self.scene.sea.omega.size + 1)
            variables["wave_frequency"] = ("component",), self.scene.sea.omega
        kept = {name: (("time", *DIMS.get(name, ())), values) for name, values in (series or {}).items()}
        return Record(variables=variables, coords=coords, attrs=attrs, series=kept)

    def ahead(self, name: str) -> np.ndarray:
        """How far along the waves each is whose output this is (n,), or what carries the whole, that of one [m]."""
        heading = self.scene.sea.heading
        places = np.reshape(list(self._places((*DIMS[name], "")[0])), (-1, 3))
        return places @ np.array([np.cos(heading), np.sin(heading), 0.0])

    def _places(self, dim: str) -> Iterable[np.ndarray | Sequence[float]]:
        """Of what a dimension counts (n, 3) [m], or one of the whole."""
        floats, platform = self.scene.floats, self.scene.platform
        if dim == "float":
            return (f.centre for f in floats)
        if dim == "line":
            return (f.centre for f in floats for _ in f.lines)
        if not dim or platform is None:  # the waves themselves
            return [(0.0, 0.0, 0.0)]
        frame, members = platform.frame, {m.name: m for m in platform.frame.members}
        if dim == "node":
            return (frame.nodes[node] for node in self.nodes)
        assert self.steel is not None, "asked of what a frame puts out"
        of = self.steel.places
        named = {"leg": platform.legs, "member": of.members, "tube": of.checked}
        if dim in named:
            return (frame.ends(members[member]).mean(axis=0) for member in named[dim])
        return of.foot if dim == "foot" else [of.foot.mean(axis=0)]

    def spectra(
        self, at: Bands, omega: np.ndarray, wave: np.ndarray, outputs: Iterable[tuple[str, np.ndarray]]
    ) -> dict[str, Labelled]:
        """Variables of the response of each output's lines (n, …) to the wave's (n,) at omega (n,)."""
        out: dict[str, Labelled] = {"band_frequency": (("frequency_band",), at.omega)}
        water, none = self.scene.water, waveless(at, self.scene.sea.omega[self.scene.sea.amplitude != 0])
        for name, lines in outputs:
            shape, flat = lines.shape[1:], lines.reshape(len(lines), -1)
            ahead = self.ahead(name)

            def later(omega: np.ndarray, ahead: np.ndarray = ahead, m: int = flat.shape[1]) -> np.ndarray:
                phase = np.exp(1j * np.outer(wavenumbers(omega, water.depth, water.gravity), ahead))
                return np.repeat(phase, m // len(ahead), axis=1)

            response = cross_spectra(omega, wave, flat, at, later if ahead.any() else None)
            parts = {"spectrum": response.density}
            if name != ELEVATION:
                H = response.transfer
                of_waves = {"response": np.abs(H), "response_phase": np.angle(H), "coherence": response.coherence}
                parts |= {part: np.where(none[:, None], np.nan, values) for part, values in of_waves.items()}
            for part, values in parts.items():
                numbers = np.moveaxis(values, 0, -1).reshape(*shape, len(at.omega))
                out[f"{name}_{part}"] = (*DIMS[name], "frequency_band"), numbers
        return out

    def _rao(self, amplitudes: np.ndarray) -> dict[str, Labelled]:
        """Motion per wave amplitude, wave by wave; NaN where a wave is too small to divide by."""
        wave = self.scene.sea.amplitude
        tells, none = np.abs(wave) > FAINT * np.abs(wave).max(), np.full(amplitudes.shape, np.nan, complex)
        each = np.divide(amplitudes, wave[:, None], out=none, where=tells[:, None])
        rao = np.moveaxis(self.by_axis(each), 0, -1)
        dims = ("float", "axis", "component")
        return {"rao": (dims, np.abs(rao)), "rao_phase": (dims, np.angle(rao))}


def bound(tables: dict[str, np.ndarray], scene: Scene, channels: Channels, law: JointLaw, fastest: np.ndarray) -> None:
    """Keep the extremes of statistics (…, 5) within the law of the joints, in place.

    A parabola does not know where a quantity is cut off, or jumps; nor does a linear model. fastest (nj,): rates.
    """
    load = pto_bounds(law)
    largest = channels.by_axis(borne_at_most(law)[None])[0][..., None]
    fastest = np.minimum(fastest, working_rates(law))
    known = np.isfinite(load) & np.isfinite(fastest)
    power = np.multiply(load, fastest, out=np.full(load.size, np.inf), where=known)
    most = np.array([power[channels.owner == b].sum() for b in range(len(scene.floats))])[:, None]
    given = [f.pto_efficiency or PtoEfficiency() for f in scene.floats]
    least, high = (np.array([e.electrical(x) for e, x in zip(given, side, strict=True)]) for side in (-most, most))
    limits = {
        **dict.fromkeys(("latched", "declutched"), (0.0, 1.0)),
        "pto_force": (-largest, largest),
        "absorbed_power": (-most, most),
        "electrical_power": (least, high),
    }
    for name, ends in limits.items():
        if name in tables:
            tables[name][..., :2] = np.clip(tables[name][..., :2], *ends)
