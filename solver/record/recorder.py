"""What a run leaves: statistics, envelopes and, if asked for, time series."""

from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np

from solver.coupled.assembly import Layout, joint_law
from solver.coupled.between import NODES, interpolate
from solver.coupled.natural import SystemModes
from solver.coupled.problem import BEYOND, CONTACT, HITS, HOLDS, LET_GO, LOAD, RATE, UNCUT, Between, Output
from solver.coupled.support import Support
from solver.multibody.bodies import Bodies
from solver.multibody.of_axes import (
    bent,
    declutched,
    holds,
    joint_loads,
    latched,
    pto_bounds,
    pto_loads,
    stop_damping,
    stopped,
)  # fmt: skip
from solver.record.channels import ELEVATION, Channels, Labelled, Record, bound
from solver.record.corners import ends_of, missed
from solver.record.fatigue import crossing_rate
from solver.record.sampling import Cuts
from solver.record.settling import Settling
from solver.record.spectra import Harmonics, all_lines, bands, lines_of, moments
from solver.scene import Scene
from solver.statistics import Statistics
from solver.structure.legs import Largest, compressive

INNER = RATES, STROKES = "rates", "strokes"  # statistics of the axes that others are made of
# By the size of moments and shear, which have a corner where these pass zero: the least are those of samples.
CORNERED = "utilisation", "shear_utilisation"
# Though loads jump; at a hard stop a rate does so between samples, too, and a parabola would go beyond either side.
CONTINUOUS = "wave_elevation", "line_tension", "top_displacement"
POSITIONS = "rotation", "motion", STROKES  # too, but where friction turns with the rate, which then has a corner


class Recorder:
    """Takes in the march's blocks and keeps only what the record needs."""

    def __init__(
        self,
        scene: Scene,
        support: Support | None,
        *,
        layout: Layout,
        bodies: Bodies | None = None,
        judged: bool = False,
    ):
        """bodies: needed where floats have lines; judged: whether samples are to show what the step does."""
        self.scene, self.layout, self.channels, self.bodies = scene, layout, Channels(scene, support), bodies
        self.law = joint_law(scene.floats)
        self.judged = support.judged if judged and support is not None and support.judged.size else None
        steel = self.channels.steel
        self.spread = steel.spread if steel is not None else {}  # of channels that are taken in where they differ
        self.statistics: dict[str, Statistics] = {}  # of each channel
        self.shapes: dict[str, tuple[int, ...]] = {}
        self.least: dict[str, np.ndarray] = {}  # of CORNERED
        legs = self.channels.legs
        self.largest = legs.nothing() if legs is not None else None
        self.contact = np.zeros((int(bent(self.law).sum()), len(CONTACT)))  # of the axes that may have stops
        self.struck = np.full((2, len(scene.floats), 3), -np.inf)  # of hinge forces on stops, upwards and downwards
        self.series: dict[str, list[np.ndarray]] = {}
        self.bounded = bool(np.isfinite(pto_bounds(self.law)).any())
        control = ("latched", latched(self.law), HOLDS), ("declutched", declutched(self.law), LET_GO)
        self.control = {name: (axes, column) for name, axes, column in control if axes.any()}
        self.bent: dict[str, list[np.ndarray]] = {}  # N, My, Mz where samples are counted
        self.cuts: dict[str, list[Cuts]] = {}  # of the series
        self.taken = 0  # samples
        self.whole = True  # the last step
        self.last: dict[str, np.ndarray] = {}  # sample (1, n) of each channel, and of the waves' rows the nearest ones
        self.waves = np.zeros((0, 0))
        self.moved = [np.zeros(0), *np.zeros((2, 0, self.channels.owner.size))]  # time, positions, rates of the last
        efficiencies = {b: f.pto_efficiency for b, f in enumerate(scene.floats) if f.pto_efficiency is not None}
        self.lossy = {b: efficiency for b, efficiency in efficiencies.items() if efficiency.uneven}
        self.seconds = [np.inf, -np.inf]
        wanted = scene.settings.rao and self.channels.axes and scene.sea.amplitude.any()
        self.harmonics = Harmonics(scene.sea.omega) if wanted else None
        waves = scene.settings.spectra and scene.sea.amplitude.any()
        self.bands = bands(scene.sea.omega, scene.settings.duration) if waves else None
        self.moments = "moments" in scene.settings.outputs
        self.settling = Settling(scene)
        self.continuous = {*CONTINUOUS, *(() if holds(self.law).any() else POSITIONS)}

    def add(self, times: np.ndarray, output: Output, samples: np.ndarray) -> None:
        """Take in a block; statistics begin after `discard` and end after `duration`."""
        s = self.scene.settings
        inside = (times > s.discard - 1e-9) & (times < s.discard + s.duration + 1e-9)
        if not inside.any():
            return
        kept = slice(int(inside.argmax()), int(inside.argmax() + inside.sum()))
        forces, steel = self._forces(kept, output, samples), self.channels.steel
        smooth = self._smooth(output.lead[kept] == UNCUT)
        channels = dict(self._channels(kept, output, samples, forces))
        self.settling.add(times[kept], channels)
        self._enlarge(output.p[kept], forces, smooth)
        if steel is not None and forces is not None and steel.counts:
            for at, end in steel.ends(forces).items():
                self.bent.setdefault(at, []).append(end)
        self.seconds = [min(self.seconds[0], times[kept][0]), times[kept][-1]]
        if self.contact.size:
            contact = output.contact[kept, :, : len(CONTACT)]
            hits = self.contact[:, HITS] + contact[..., HITS].sum(axis=0)
            self.contact = np.maximum(self.contact, contact.max(axis=0))
            self.contact[:, HITS] = hits
            force = self.channels.hinge_force(output.struck[kept][contact[..., LOAD] > 0])
            self.struck = np.maximum(self.struck, np.max([force, -force], axis=1, initial=-np.inf))
        for name, values in channels.items():
            self.shapes[name] = values.shape[1:]
            everywhere = None if name in self.continuous else smooth
            self.statistics.setdefault(name, Statistics()).add(values.reshape(len(values), -1), everywhere)
        self._lower(channels)
        if output.between.number[0]:
            self._amend(kept, channels, output, samples)
        if self.lossy:
            self._round(times[kept], kept, output)
        self.taken += len(times[kept])
        self.last = {name: values.reshape(len(values), -1)[-1:] for name, values in channels.items()}
        self.waves = samples[-NODES:]
        channels = {name: values for name, values in channels.items() if name not in INNER}
        if s.keep_series or self.bands is not None or self.moments:
            for name, values in {**channels, "time": times[kept]}.items():
                self.series.setdefault(name, []).append(values)
        if self.harmonics is not None:
            self.harmonics.add(times[kept], output.z[kept, output.z.shape[1] - self.channels.owner.size :])

    def _smooth(self, whole: np.ndarray) -> np.ndarray:
        """Whether a sample's step and the one before it are whole (m,): in one that is cut, loads may jump."""
        before, self.whole = np.append(self.whole, whole[:-1]), whole[-1]
        return whole & before

    def _amend(self, kept: slice, channels: Mapping[str, np.ndarray], output: Output, samples: np.ndarray) -> None:
        """Where steps are cut, pieces tell the mean over the time between two samples in place of both's own mean."""
        between, first, before = output.between, kept.start, self.waves if self.last else samples[:0]
        cut = np.flatnonzero(output.lead[kept] >= 0) + first
        cut = cut[int(not self.last and cut[:1].tolist() == [first]) :]  # whose start is in no block
        if not cut.size:
            return
        some = slice(*np.searchsorted(between.row[: between.number[0]], [cut[0], cut[-1] + 1]))
        parts: list[Any] = [*(part[some] for part in between[:-1]), between.number]
        pieces = Between(*parts)
        count = len(pieces.row)
        waves = np.empty((count, samples.shape[1]))
        known = np.r_[self.layout.elevation, self.layout.forces]  # all of the waves that channels are made of
        near, there = np.concatenate([before[:, known], samples[:, known]]), np.empty((count, known.size))
        interpolate(near, pieces.at + len(before), np.empty(NODES), there)
        waves[:, known] = there
        forces = self._forces(slice(None), pieces, waves)
        told = dict(self._channels(slice(None), pieces, waves, forces))
        self._lower(told)
        self._enlarge(pieces.p, forces)
        weight = np.concatenate([pieces.weight, output.lead[cut] - 0.5, np.full(cut.size, -0.5)])
        of = np.searchsorted(cut, np.concatenate([pieces.row, cut, cut]))
        more = int(bool(self.last))  # sample of the block before
        here = cut - first + more
        ends, of_ends = ends_of(here, len(output.lead[kept]) + more)
        weights = np.concatenate([weight, of_ends])
        for name, values in channels.items():
            if name != "latched":  # which is a mean over that time already
                flat, new = values.reshape(len(values), -1), told[name].reshape(count, -1)
                flat = np.concatenate([self.last[name], flat]) if more else flat
                own = np.concatenate([new, flat[here - 1], flat[here]])
                self.statistics[name].amend(np.concatenate([own, flat[ends]]), weights)
                if self.scene.settings.keep_series and name not in INNER:
                    sums = np.zeros((2, cut.size, own.shape[1]))
                    for total, power in zip(sums, (own, own**2), strict=True):
                        np.add.at(total, of, weight[:, None] * power)
                    self.cuts.setdefault(name, []).append(Cuts(cut - first + self.taken, *sums))

    def _round(self, times: np.ndarray, kept: slice, output: Output) -> None:
        """Where steps are whole, corners of electrical power add to the sums of its samples and of their squares."""
        first, more = output.z.shape[1] - self.channels.owner.size, len(self.moved[0])
        now = times, output.z[kept, first:], output.dz[kept, first:]
        t, y, v = (np.concatenate(parts) for parts in zip(self.moved, now, strict=True))
        self.moved = [t[-1:], y[-1:], v[-1:]]
        if len(t) == 1:
            return
        whole = (self._at_work(output.contact[kept])[0] == 1) & (output.lead == UNCUT)[kept, None]
        lacks = np.zeros((2, len(times), len(self.scene.floats)))
        for b, efficiency in self.lossy.items():
            works = whole[1 - more :] & (self.channels.owner == b)
            row, *both = missed(y, v, t[1] - t[0], lambda y, v: pto_loads(self.law, y, v) * v, works, efficiency)
            for sums, lack in zip(lacks[..., b], both, strict=True):
                np.add.at(sums, row - more, lack)
        self.statistics["electrical_power"].add_to_sums(*lacks.sum(axis=1))
        if self.scene.settings.keep_series and (some := np.flatnonzero(lacks.any(axis=(0, 2)))).size:
            self.cuts.setdefault("electrical_power", []).append(Cuts(some + self.taken, *lacks[:, some]))

    def _forces(self, kept: slice, output: Output | Between, samples: np.ndarray) -> np.ndarray | None:
        """Of the frame, as the steel's outputs ask for them."""
        if self.channels.steel is None:
            return None
        forces, parts = self.channels.steel.forces, (output.dp, output.ddp, output.carried, output.drag)
        y = forces.of(samples[kept, self.layout.forces], *(part[kept] for part in parts))
        y += forces.at_rest
        return y

    def _lower(self, channels: Mapping[str, np.ndarray]) -> None:
        """The least of CORNERED, by samples or pieces (m, k)."""
        for name in channels.keys() & set(CORNERED):
            self.least[name] = np.minimum(self.least.get(name, np.inf), channels[name].min(axis=0))

    def _enlarge(self, p: np.ndarray, forces: np.ndarray | None, smooth: np.ndarray | None = None) -> None:
        """The legs' largest values; of pieces, which no parabola goes through, where nothing is told of that."""
        legs, steel = self.channels.legs, self.channels.steel
        if legs is None or steel is None or self.largest is None or forces is None:
            return
        largest = self.largest if smooth is not None else Largest(*self.largest[:3], *legs.nothing()[3:])
        legs.enlarge(largest, p, steel.compression(forces), np.zeros(len(p), bool) if smooth is None else smooth)

    def _channels(
        self, kept: slice, output: Output | Between, samples: np.ndarray, forces: np.ndarray | None
    ) -> Iterator[tuple[str, np.ndarray]]:
        channels = self.channels
        yield "wave_elevation", samples[kept, self.layout.elevation][:, 0]
        nb, nj = len(self.scene.floats), channels.owner.size
        if nb:
            first = output.z.shape[1] - nj
            joint, rate = (np.ascontiguousarray(part[kept, first:]) for part in (output.z, output.dz))
            yield from channels.motions(joint)
            at_work, beyond = self._at_work(output.contact[kept])
            absorbed = joint_loads(self.law, joint, rate).pto * rate * at_work
            yield "absorbed_power", absorbed @ (channels.owner[:, None] == np.arange(nb))
            if self.bounded:
                yield RATES, rate
            if "pto_stroke" in self.scene.settings.outputs and self.channels.axes:
                yield STROKES, np.concatenate([joint, np.abs(rate)], axis=1)
                yield "pto_rate", channels.by_axis(rate)
            yield from self._pto(joint, rate, at_work, beyond)
            yield from self._control(output.contact[kept])
            yield "hinge_force", channels.hinge_force(output.wrench[kept])
            if channels.lines:
                assert self.bodies is not None, "asked of scenes with lines"
                yield "line_tension", channels.line_tension(self.bodies, output.z[kept])
        if self.judged is not None:
            yield "node_displacement", np.tensordot(output.p[kept], self.judged, axes=1)
        yield from channels.accelerations(output.ddp[kept])
        if channels.steel is None or forces is None:
            return
        if channels.legs is not None:
            yield "top_displacement", channels.legs.top_displacement(output.p[kept])
            yield "bottom_stress", compressive(channels.steel.compression(forces))
        yield from channels.steel.differing(forces)

    def _at_work(self, contact: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """(m, nj) 0 where a power take-off has let go of its axis, else 1; the load it bears beyond joint_loads."""
        shape = len(contact), self.channels.owner.size
        at_work, beyond = np.ones(shape), np.zeros(shape)
        if contact.shape[1]:
            at_work[:, bent(self.law)] -= contact[:, :, LET_GO]
            beyond[:, bent(self.law)] = contact[:, :, BEYOND]
        return at_work, beyond

    def _control(self, contact: np.ndarray) -> Iterator[tuple[str, np.ndarray]]:
        """Share of the time in which axes are held by a latch, or let go of; NaN on axes without the one or other."""
        for name, (axes, column) in self.control.items():
            share = np.full((len(contact), axes.size), np.nan)
            share[:, axes] = contact[:, axes[bent(self.law)], column]
            yield name, self.channels.by_axis(share)

    def _pto(
        self, joint: np.ndarray, rate: np.ndarray, at_work: np.ndarray, beyond: np.ndarray
    ) -> Iterator[tuple[str, np.ndarray]]:
        """Force and electrical power of the power take-offs at positions and rates (m, nj), where asked for."""
        floats, channels = self.scene.floats, self.channels
        wanted = "pto_force" in self.scene.settings.outputs and channels.axes
        if not wanted and all(f.pto_efficiency is None for f in floats):
            return
        load = pto_loads(self.law, joint, rate) * at_work
        if wanted:
            yield "pto_force", channels.by_axis(0.0 - load - beyond)
        electrical = np.full((len(joint), len(floats)), np.nan)
        for b, f in enumerate(floats):
            if f.pto_efficiency is not None:
                own = channels.owner == b
                electrical[:, b] = f.pto_efficiency.electrical(load[:, own] * rate[:, own]).sum(axis=1)
        if not np.isnan(electrical).all():
            yield "electrical_power", electrical

    def tables(self) -> dict[str, np.ndarray]:
        """Statistics (…, 5) of each channel."""
        tables = {name: each.table() for name, each in self.statistics.items() if name not in INNER}
        for name, least in self.least.items():
            tables[name][:, 1] = least
        known = {
            name: self.spread[name].table(table) if name in self.spread else table.reshape(*self.shapes[name], -1)
            for name, table in tables.items()
        }
        if self.largest is not None and self.channels.legs is not None:
            known["bottom_stress"][:, 0] = self.largest.relieved[self.channels.legs.twin]
        if "hinge_force" in known:  # a hit is shorter than the time between samples
            force = known["hinge_force"]
            force[..., 0] = np.maximum(force[..., 0], self.struck[0])
            force[..., 1] = np.minimum(force[..., 1], -self.struck[1])
        for name in known.keys() & self.control.keys():  # as what holds, or has let go, or not
            share = np.clip(known[name][..., 2], 0.0, 1.0)
            known[name][..., 3], known[name][..., 4] = np.sqrt(share), np.sqrt(share * (1 - share))
        fastest = np.full(self.channels.owner.size, np.inf)
        if RATES in self.statistics:
            fastest = np.abs(self.statistics[RATES].table()[:, :2]).max(axis=1)
        bound(known, self.scene, self.channels, self.law, fastest)
        return known

    def samples(self) -> dict[str, np.ndarray]:
        """Of each channel (m, …), and their times (m,), where series are kept."""
        samples = {name: np.concatenate(blocks) for name, blocks in self.series.items()}
        return {name: self.spread[name].of(x) if name in self.spread else x for name, x in samples.items()}

    def amended(self) -> dict[str, Cuts]:
        """What pieces change of each channel's samples, where series are kept."""
        cuts = {name: Cuts(*map(np.concatenate, zip(*parts, strict=True))) for name, parts in self.cuts.items()}
        for name in cuts.keys() & self.spread.keys():
            row, value, square = cuts[name]
            all_ = self.spread[name].of(value), self.spread[name].squares(square)
            cuts[name] = Cuts(row, *(part.reshape(len(row), -1) for part in all_))
        return cuts

    def record(
        self, tables: dict[str, np.ndarray], attrs: Mapping[str, float | str], modes: SystemModes | None = None
    ) -> Record:
        """The record of all blocks, `tables` their own; the system's natural periods, if known."""
        legs, largest, steel = self.channels.legs, self.largest, self.channels.steel
        counted: tuple[Mapping[str, Labelled], tuple[str, ...]] = ({}, ())
        if steel is not None and self.bent:
            bent = {at: np.concatenate(blocks) for at, blocks in self.bent.items()}
            counted = steel.counted(bent, self.seconds[1] - self.seconds[0])
        return self.channels.record(
            tables,
            attrs,
            modes=modes,
            envelopes=legs.envelopes(largest) if legs is not None and largest is not None else None,
            rao=self.harmonics.amplitudes() if self.harmonics is not None else None,
            series=self.samples() if self.scene.settings.keep_series else None,
            counted=counted,
            spectra=self._spectra() if self.bands is not None and self.series else None,
            further={**dict(self._at_joints()), **(self._moments(tables) if self.moments and self.series else {})},
        )

    def _spectra(self) -> dict[str, Labelled]:
        """Of all channels, by cross-spectra of their samples with the elevation's."""
        assert self.bands is not None, "asked of a record that has them"
        samples = self.samples()
        step = float(np.diff(samples.pop("time")[:2])[0])
        omega, wave = lines_of(samples[ELEVATION][:, None], step, self.bands)
        flat = ((name, values.reshape(len(values), -1), values.shape[1:]) for name, values in samples.items())
        lines = ((name, lines_of(x, step, self.bands)[1].reshape(-1, *shape)) for name, x, shape in flat)
        return self.channels.spectra(self.bands, omega, wave[:, 0], lines)

    def _moments(self, tables: Mapping[str, np.ndarray]) -> dict[str, Labelled]:
        """Of all channels, by what crosses their means and by their samples' spectra, which sum up to their variance.

        A taper weighs the record's middle, so that by itself the sum is that but on average.
        """
        samples = self.samples()
        times = samples.pop("time")
        found = {}
        for name, values in samples.items():
            omega, lines = all_lines(values, float(times[1] - times[0]))
            tapered, std = moments(omega, lines), tables[name][..., -1]
            share = np.divide(std**2, tapered[0], out=np.ones_like(std), where=tapered[0] > 0)
            found[name] = crossing_rate(values, self.seconds[1] - self.seconds[0]), share * tapered
        return self.channels.moments(found)

    def _at_joints(self) -> Iterator[tuple[str, Labelled]]:
        """CONTACT of axes with stops over the record, hits also an hour; the stroke of power take-offs if asked for."""
        channels, hours = self.channels, (self.seconds[1] - self.seconds[0]) / 3600
        if (some := stopped(self.law)).any():
            contact = np.full((channels.owner.size, len(CONTACT)), np.nan)
            contact[some] = self.contact[some[bent(self.law)]]
            at_once = stop_damping(self.law)[some] * contact[some, RATE]  # before a piece's first stage
            contact[some, LOAD] = np.maximum(contact[some, LOAD], at_once)
            hits = np.array([np.nansum(contact[channels.owner == b, HITS]) for b in range(len(self.scene.floats))])
            yield CONTACT[HITS], (("float",), hits)
            if hours > 0:
                yield "end_stop_hit_rate", (("float",), hits / hours)
            for name, values in zip(CONTACT[1:], contact.T[1:], strict=True):
                yield name, channels.at_axes(values)
        if STROKES in self.statistics:
            way, size = np.split(self.statistics[STROKES].table(), 2)
            yield "pto_stroke", channels.at_axes(way[:, 0] - way[:, 1])
            yield "pto_travel", channels.at_axes(3600 * size[:, 2])
