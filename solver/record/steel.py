"""An elastic platform's forces as outputs: reactions and their sums, section forces, stress of fixed fibres."""

from collections.abc import Callable, Iterator
from functools import cached_property
from typing import NamedTuple

import numpy as np

from solver.coupled.forces import Forces
from solver.coupled.places import FATIGUE, FIBRES, REACTIONS, SAME, SECTIONS, STRESSES, TOPS, UTILISATION, Ends
from solver.record import fatigue
from solver.record.spectra import crossings, moments
from solver.record.utilisation import bending_utilisation, shear_utilisation
from solver.scene import Fatigue, Settings
from solver.structure.legs import BENDING
from solver.structure.members import FORCES
from solver.structure.tubular import Resistance, resistance

Labelled = tuple[tuple[str, ...], np.ndarray]

DIMS = {
    "reaction_force": ("foot", "direction"),
    "reaction_moment": ("foot", "direction"),
    "base_shear": ("direction",),
    "overturning_moment": ("direction",),
    "pile_force": ("leg",),
    "section_force": ("member", "end", "force"),
    "section_moment": ("member", "end", "moment"),
    "member_stress": ("member", "end", "member_fibre"),
    "fibre_stress": ("leg", "fibre"),
    "fibre_stress_top": ("leg", "fibre"),
    "utilisation": ("tube",),
    "shear_utilisation": ("tube",),
}


class Spread(NamedTuple):
    """How k numbers of a channel are all that it puts out: others are as they are, or their negatives."""

    place: np.ndarray  # (…) which of the k
    sign: np.ndarray  # (…) or (), 1 or -1

    def of(self, values: np.ndarray) -> np.ndarray:
        """(m, …) of values (m, k)."""
        return values[:, self.place] * self.sign

    def squares(self, values: np.ndarray) -> np.ndarray:
        """(m, …) of values (m, k) of which each sign has the same."""
        return values[:, self.place]

    def table(self, table: np.ndarray) -> np.ndarray:
        """Statistics (…, 5) of those (k, 5)."""
        high, low, mean, *even = np.moveaxis(table[self.place], -1, 0)
        same = self.sign > 0
        return np.stack([np.where(same, high, -low), np.where(same, low, -high), self.sign * mean, *even], axis=-1)


class Steel:
    """Channels of the outputs that a scene asks for, each a linear function of the frame's forces y (m, ny)."""

    def __init__(self, forces: Forces, settings: Settings):
        self.forces, self.places, self.outputs, self.fatigue = forces, forces.places, settings.outputs, settings.fatigue
        self.feet, self.extreme = forces.places.feet, forces.places.feet.extreme
        self.legs = {"": self.feet, **({"_top": forces.places.tops} if TOPS in self.outputs else {})}
        columns = {"": self.places.columns.feet, "_top": self.places.columns.tops}
        self._alike = {at: self._fibres(ends, columns[at]) for at, ends in self.legs.items()}
        self._bent = {at: columns[at][legs] for at, (legs, _) in self._alike.items()}
        self.thickness = {at: self.legs[at].thickness[legs] for at, (legs, _) in self._alike.items()}
        self.stress = {at: self.legs[at].stress[legs] for at, (legs, _) in self._alike.items()}
        self.stress[STRESSES] = self.places.ends.stress
        self.material_factor = settings.utilisation.material_factor

    @property
    def point(self) -> np.ndarray:
        """(3,) where the overturning moment is taken about: amid the feet, at the height of the lowest [m]."""
        foot = self.places.foot
        return np.array([*foot[:, :2].mean(axis=0), foot[:, 2].min()])

    def compression(self, y: np.ndarray) -> np.ndarray:
        """N/A, c My/Iy, c Mz/Iz at the legs' feet, (m, nl, 3)."""
        return y.take(self.places.columns.feet, axis=1) * self.extreme

    def fibres(self, bent: np.ndarray, at: str) -> np.ndarray:
        """Signed stress (m, k, nf), tension positive, of N, My, Mz at an end of some legs (m, k, 3)."""
        return (bent.swapaxes(0, 1) @ self.stress[at]).swapaxes(0, 1)

    def ends(self, y: np.ndarray) -> dict[str, np.ndarray]:
        """N, My, Mz (m, k, 3) at the ends of legs whose fibres differ from others', by what outputs there end in."""
        return {at: y.take(columns, axis=1) for at, columns in self._bent.items()}

    def every_fibre(self, y: np.ndarray) -> np.ndarray:
        """Signed stress (m, nl, nf) of all fibres at the legs' feet."""
        return self._alike[""][1].of(self.fibres(self.ends(y)[""], "").reshape(len(y), -1))

    def channels(self, y: np.ndarray) -> Iterator[tuple[str, np.ndarray]]:
        """Name and values (m, …) of each output, from samples, from lines or from values at rest."""
        for name, values in self.differing(y):
            yield name, self.spread[name].of(values) if name in self.spread else values

    def differing(self, y: np.ndarray) -> Iterator[tuple[str, np.ndarray]]:
        """The same, but (m, k) alone of what is another's, or its negative, as `spread` has it."""
        at = self.places.columns
        for name, columns in self._selected.items():
            yield name, y.take(columns, axis=1)
        if REACTIONS in self.outputs:
            shear, overturning = np.split(y.take(at.reactions.ravel(), axis=1) @ self._sums, 2, axis=1)
            yield "base_shear", shear
            yield "overturning_moment", overturning
        if STRESSES in self.outputs:
            bent = y.take(at.sections[..., BENDING].reshape(-1, 3), axis=1)
            yield "member_stress", self.fibres(bent, STRESSES).reshape(len(y), len(self.places.members), 2, -1)
        if FIBRES in self.outputs:
            for end, bent in self.ends(y).items():
                yield f"fibre_stress{end}", self.fibres(bent, end).reshape(len(y), -1)
        if UTILISATION in self.outputs:
            bent, sheared = self.utilisation(y)
            yield "utilisation", np.maximum(bent, sheared)
            yield "shear_utilisation", sheared

    @cached_property
    def spread(self) -> dict[str, Spread]:
        """Of the channels in which some are others, or their negatives."""
        first, sign = self.forces.first, self.forces.sign
        every = {
            name: Spread(np.searchsorted(self._selected[name], first[columns]), sign[columns])
            for name, columns in self._columns.items()
        }
        if FIBRES in self.outputs:
            every |= {f"fibre_stress{end}": spread for end, (_, spread) in self._alike.items()}
        if UTILISATION in self.outputs:
            every |= dict.fromkeys(("utilisation", "shear_utilisation"), Spread(self.places.twin, np.ones(())))
        return every

    @cached_property
    def _columns(self) -> dict[str, np.ndarray]:
        """Which of y (…) are channels as they are."""
        at = self.places.columns
        some: dict[str, np.ndarray] = {}
        if REACTIONS in self.outputs:
            some |= {"reaction_force": at.reactions[:, :3], "reaction_moment": at.reactions[:, 3:]}
            if at.feet.size:
                some["pile_force"] = at.feet[:, 0]
        if SECTIONS in self.outputs:
            some |= {"section_force": at.sections[..., :3], "section_moment": at.sections[..., 3:]}
        return some

    @cached_property
    def _selected(self) -> dict[str, np.ndarray]:
        """(k,) those of them that differ."""
        return {name: np.unique(self.forces.first[columns]) for name, columns in self._columns.items()}

    def _fibres(self, legs: Ends, columns: np.ndarray) -> tuple[np.ndarray, Spread]:
        """Which legs (k,) have fibres that differ from other legs', and how those are all (nl, nf)."""
        first, sign, (nl, nf) = self.forces.first, self.forces.sign, legs.fibre.shape[:2]
        stress = np.zeros((nl, nf, first.size))  # of unit forces of those that differ
        for leg, unit, column in zip(stress, np.nan_to_num(legs.stress), columns, strict=True):
            for force, of in zip(unit, column, strict=True):
                leg[:, first[of]] += sign[of] * force
        wall = np.where(np.isnan(legs.fibre[..., 0]), np.nan, legs.thickness[:, None])
        return _alike(stress, np.nan_to_num(wall, nan=-1.0))

    def utilisation(self, y: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Largest of tubes that differ (m, no): of axial force and bending at all points; of shear, torsion at ends."""
        of, places = self._resistance, self.places
        bent = bending_utilisation(y, places.columns.along, places.points, of)
        Vy, Vz, T = np.moveaxis(y.take(places.columns.shear, axis=1), -1, 0)
        sheared = shear_utilisation(Vy, Vz, T, Resistance(*(values[:, None] for values in of)))
        return bent, sheared.max(axis=-1)

    @cached_property
    def _sums(self) -> np.ndarray:
        """(6 nc, 6) from the reactions to the whole's force and moment about `point`, -ΣF and -Σ(r × F + M)."""
        lever = self.places.foot - self.point
        sums = np.tile(-np.eye(6), (len(lever), 1, 1))
        sums[:, :3, 3:] = np.cross(np.eye(3), lever[:, None])  # -r × F of unit forces
        return sums.reshape(-1, 6)

    @cached_property
    def _resistance(self) -> Resistance:
        """Of each tube that is looked at (no,)."""
        frame = self.places.influence.model.frame
        each = [resistance(m, frame.buckling_length(m), self.material_factor) for m in self.places.tubes]
        return Resistance(*map(np.array, zip(*each, strict=True)))

    @property
    def counts(self) -> bool:
        """Whether all samples of the fibres are needed, and not their statistics alone."""
        return bool({FIBRES, FATIGUE} & set(self.outputs))

    def counted(self, bent: dict[str, np.ndarray], seconds: float) -> tuple[dict[str, Labelled], tuple[str, ...]]:
        """Crossing rates and damage, and what failed, of samples of what `ends` gives, in a time [s]."""
        across = {at: self.stress[at].swapaxes(1, 2) for at in bent}  # each fibre's history along memory
        stress = {at: np.moveaxis(across[at] @ forces.transpose(1, 2, 0), -1, 0) for at, forces in bent.items()}
        rates = {at: fatigue.crossing_rate(x, seconds) for at, x in stress.items()}
        return self._counted(rates, lambda at, how: fatigue.of_samples(stress[at], seconds, self.thickness[at], how))

    def expected(self, lines: np.ndarray, omega: np.ndarray) -> tuple[dict[str, Labelled], tuple[str, ...]]:
        """The same of a Gaussian process, from lines (nw, ny) of the forces."""
        X = {at: self.fibres(forces, at) for at, forces in self.ends(lines).items()}
        rates = {at: crossings(moments(omega, x)) for at, x in X.items()}
        return self._counted(rates, lambda at, how: fatigue.of_lines(X[at], omega, self.thickness[at], how))

    def _counted(
        self, rates: dict[str, np.ndarray], reckon: Callable[[str, Fatigue], fatigue.Damage]
    ) -> tuple[dict[str, Labelled], tuple[str, ...]]:
        out: dict[str, Labelled] = {}
        failed: list[str] = []
        for at, rate in rates.items():
            legs, spread = self._alike[at]
            found = {"fibre_stress{}_crossing_rate": rate} if FIBRES in self.outputs else {}
            if FATIGUE in self.outputs:
                damage = reckon(at, self.fatigue)
                found |= {"damage{}": damage.per_hour, "equivalent_range{}": damage.equivalent}
                for leg, fibre, note in damage.failed:
                    where = f"fatigue of leg {legs[leg] + 1}, fibre {fibre + 1}"
                    failed.append(f"{where}: the count failed: {note}{', at the top' if at else ''}")
            out |= {name.format(at): (("leg", "fibre"), spread.of(x.reshape(1, -1))[0]) for name, x in found.items()}
        return out, tuple(failed)

    def coords(self) -> dict[str, np.ndarray]:
        """Labels of the dimensions."""
        return {
            "foot": np.array(self.places.grounded),
            "member": np.array(self.places.members),
            "tube": np.array(self.places.checked),
            "end": np.array(["start", "end"]),
            "member_fibre": np.arange(1, self.places.ends.fibre.shape[1] + 1),
            "force": np.array(FORCES[:3]),
            "moment": np.array(FORCES[3:]),
            "fibre": np.arange(1, self.feet.fibre.shape[1] + 1),
        }

    def variables(self) -> dict[str, Labelled]:
        """Where what is put out is: the moment's point, the fibres."""
        out: dict[str, Labelled] = {}
        if REACTIONS in self.outputs:
            out["moment_point"] = ("direction",), self.point
        if STRESSES in self.outputs:
            places = self.places.ends.fibre.reshape(len(self.places.members), 2, -1, 2)
            out |= {f"member_fibre_{axis}": (DIMS["member_stress"], places[..., i]) for i, axis in enumerate("yz")}
        if self.counts:
            y, z = np.moveaxis(self.feet.fibre, -1, 0)
            out["fibre_place"] = ("leg", "fibre", "direction"), self.feet.place
            out["fibre_angle"] = ("leg", "fibre"), np.arctan2(z, y)
        return out

    def attrs(self) -> dict[str, float | str]:
        """By which rules damage was reckoned."""
        if FATIGUE not in self.outputs:
            return {}
        how = self.fatigue
        words = f"curve {how.curve}, {how.environment}, {how.edition}, SCF {how.scf:g}"
        return {"fatigue": words, "equivalent_exponent": how.exponent, "equivalent_cycles": how.cycles}


def _alike(stress: np.ndarray, wall: np.ndarray) -> tuple[np.ndarray, Spread]:
    """Of legs (nl, nf, n) those (k,) whose fibres are not another leg's in another order, walls (nl, nf) included."""
    (nl, nf), close = wall.shape, SAME * np.abs(stress).max(initial=0.0)
    legs: list[int] = []
    place = np.empty((nl, nf), int)
    for j in range(nl):
        for k, i in enumerate([*legs, j]):
            same = np.abs(stress[i] - stress[j][:, None]).max(axis=-1, initial=0.0) <= close
            same &= wall[i] == wall[j][:, None]
            if i == j or same.any(axis=1).all():
                place[j] = k * nf + (np.arange(nf) if i == j else same.argmax(axis=1))
                legs += [j] * (i == j)
                break
    return np.array(legs, int), Spread(place, np.ones(()))
