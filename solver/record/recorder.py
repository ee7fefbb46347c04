"""What a run leaves: statistics, envelopes and, if asked for, time series."""

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np

from solver.coupled.assembly import Layout, joint_law
from solver.coupled.march import Output
from solver.coupled.support import Support
from solver.multibody.joint_law import joint_loads
from solver.record.spectra import Harmonics
from solver.scene import Scene
from solver.statistics import STATISTICS, Statistics

FAINT = 1e-3  # a wave below this share of the largest one says nothing of a float

Labelled = tuple[tuple[str, ...], np.ndarray]


@dataclass(frozen=True, eq=False, kw_only=True)
class Record:
    """name -> (dims, values) for variables and time series, coordinates, and scalars."""

    variables: Mapping[str, Labelled]
    coords: Mapping[str, np.ndarray]
    attrs: Mapping[str, float | str]
    series: Mapping[str, Labelled] = field(default_factory=dict)


class Recorder:
    """Takes in the march's blocks and keeps only what the record needs."""

    def __init__(self, scene: Scene, support: Support | None, *, layout: Layout):
        self.scene, self.layout = scene, layout
        self.legs = support.legs if support is not None else None
        self.frequencies = support.dry_omega if support is not None else np.zeros(0)
        floats = scene.floats
        self.owner = np.array([b for b, f in enumerate(floats) for _ in f.motion], int)  # of each joint axis
        self.names = [name for f in floats for name in f.motion]
        self.axes = list(dict.fromkeys(self.names))
        self.law = joint_law(floats)
        self.statistics = Statistics()
        self.shapes: dict[str, tuple[int, ...]] = {}  # of the channels, in the order of the statistics
        self.largest = self.legs.nothing() if self.legs is not None else None
        self.series: dict[str, list[np.ndarray]] = {}
        wanted = scene.settings.rao and floats and scene.sea.amplitude.any()
        self.harmonics = Harmonics(scene.sea.omega) if wanted else None

    def add(self, times: np.ndarray, output: Output, samples: np.ndarray) -> None:
        """Take in a block; statistics begin after `discard` and end after `duration`."""
        s = self.scene.settings
        inside = (times > s.discard - 1e-9) & (times < s.discard + s.duration + 1e-9)
        if not inside.any():
            return
        kept = slice(int(inside.argmax()), int(inside.argmax() + inside.sum()))
        channels = dict(self._channels(kept, output, samples))
        self.shapes = {name: values.shape[1:] for name, values in channels.items()}
        self.statistics.add(np.concatenate([v.reshape(len(v), -1) for v in channels.values()], axis=1))
        if s.keep_series:
            for name, values in {**channels, "time": times[kept]}.items():
                self.series.setdefault(name, []).append(values)
        if self.harmonics is not None:
            self.harmonics.add(times[kept], output.z[kept, -self.owner.size :])

    def _channels(self, kept: slice, output: Output, samples: np.ndarray):
        yield "wave_elevation", samples[kept, self.layout.elevation][:, 0]
        nb, nj = len(self.scene.floats), self.owner.size
        if nb:
            joint, rate = output.z[kept, -nj:], output.dz[kept, -nj:]
            moved = np.full((len(joint), nb, len(self.axes)), np.nan)
            moved[:, self.owner, [self.axes.index(name) for name in self.names]] = joint
            if "hinge" in self.axes:
                yield "rotation", moved[:, :, self.axes.index("hinge")]
            if self.axes != ["hinge"]:
                yield "motion", moved
            absorbed = joint_loads(self.law, joint, rate).pto * rate
            yield "absorbed_power", absorbed @ (self.owner[:, None] == np.arange(nb))
            force = -output.wrench[kept, :, :3]
            for b, carrier in reversed(list(enumerate(self.scene.carriers))):
                if carrier >= 0:  # whose own joint bears what it carries, too
                    force[:, carrier] += force[:, b]
            yield "hinge_force", force
        if self.legs is not None:
            tops, feet = self.legs.response(output.p[kept], self.largest)
            yield "top_displacement", tops
            yield "bottom_stress", feet

    def tables(self) -> dict[str, np.ndarray]:
        """Statistics (…, 5) of each channel."""
        ends = np.cumsum([np.prod(shape, dtype=int) for shape in self.shapes.values()])
        tables = np.split(self.statistics.table(), ends[:-1])
        return {name: t.reshape(*shape, -1) for (name, shape), t in zip(self.shapes.items(), tables, strict=True)}

    def record(self, attrs: Mapping[str, float | str]) -> Record:
        """The record of all blocks."""
        dims = {
            "wave_elevation": (),
            "rotation": ("float",),
            "motion": ("float", "axis"),
            "absorbed_power": ("float",),
            "hinge_force": ("float", "direction"),
            "top_displacement": ("leg", "direction"),
            "bottom_stress": ("leg",),
        }
        variables: dict[str, Labelled] = {
            name: ((*dims[name], "statistic"), table) for name, table in self.tables().items()
        }
        coords = {
            "statistic": np.array(STATISTICS),
            "float": np.array([f.name for f in self.scene.floats]),
            "direction": np.array(["x", "y", "z"]),
        }
        if self.legs is not None:
            coords["leg"], coords["height"] = np.arange(1, len(self.legs.twin) + 1), self.legs.height
            displacement, stress = self.legs.envelopes(self.largest)
            variables["displacement_envelope"] = ("leg", "height"), displacement
            variables["stress_envelope"] = ("leg", "height"), stress
        if self.frequencies.size:
            coords["mode"] = np.arange(1, self.frequencies.size + 1)
            variables["natural_frequency"] = (("mode",), self.frequencies)
        if self.harmonics is not None:
            variables |= self._rao(self.harmonics)
            coords["component"] = np.arange(1, self.scene.sea.omega.size + 1)
        if "motion" in self.shapes or self.harmonics is not None:
            coords["axis"] = np.array(self.axes)
        series = {name: (("time", *dims.get(name, ())), np.concatenate(v)) for name, v in self.series.items()}
        return Record(variables=variables, coords=coords, attrs=attrs, series=series)

    def _rao(self, fit: Harmonics) -> dict[str, Labelled]:
        """Motion per wave amplitude, wave by wave; NaN where a wave is too small to divide by."""
        wave = self.scene.sea.amplitude
        wave = np.where(np.abs(wave) > FAINT * np.abs(wave).max(), wave, np.nan)
        found = np.full((len(self.scene.floats), len(self.axes), wave.size), np.nan, complex)
        found[self.owner, [self.axes.index(name) for name in self.names]] = (fit.amplitudes() / wave[:, None]).T
        dims = ("float", "axis", "component")
        return {
            "rao": (dims, np.abs(found)),
            "rao_phase": (dims, np.angle(found)),
            "wave_frequency": (("component",), self.scene.sea.omega),
        }
