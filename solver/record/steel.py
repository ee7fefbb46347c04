"""An elastic platform's forces as outputs: reactions and their sums, section forces, stress of fixed fibres."""

from collections.abc import Callable, Iterator
from functools import cached_property

import numpy as np

from solver.coupled.forces import FATIGUE, FIBRES, REACTIONS, SECTIONS, STRESSES, TOPS, UTILISATION, Forces
from solver.record import fatigue
from solver.record.spectra import crossings, moments
from solver.record.utilisation import bending_utilisation, shear_utilisation
from solver.scene import Fatigue, Settings
from solver.structure.frame import FORCES
from solver.structure.legs import BENDING
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


class Steel:
    """Channels of the outputs that a scene asks for, each a linear function of the frame's forces y (m, ny)."""

    def __init__(self, forces: Forces, settings: Settings):
        self.forces, self.places, self.outputs, self.fatigue = forces, forces.places, settings.outputs, settings.fatigue
        self.feet, self.extreme = forces.places.feet, forces.places.feet.extreme
        self.legs = {"": self.feet, **({"_top": forces.places.tops} if TOPS in self.outputs else {})}
        self.stress = {at: ends.stress for at, ends in self.legs.items()} | {STRESSES: forces.places.ends.stress}
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
        """Signed stress (m, nl, nf), tension positive, of N, My, Mz at an end of the legs (m, nl, 3)."""
        return (bent.swapaxes(0, 1) @ self.stress[at]).swapaxes(0, 1)

    def ends(self, y: np.ndarray) -> dict[str, np.ndarray]:
        """N, My, Mz (m, nl, 3) at the ends of the legs where fibres are looked at, by what outputs there end in."""
        columns = {"": self.places.columns.feet, "_top": self.places.columns.tops}
        return {at: y.take(columns[at], axis=1) for at in self.legs}

    def channels(self, y: np.ndarray) -> Iterator[tuple[str, np.ndarray]]:
        """Name and values (m, …) of each output, from samples, from lines or from values at rest."""
        at = self.places.columns
        if REACTIONS in self.outputs:
            force, moment = y.take(at.reactions[:, :3], axis=1), y.take(at.reactions[:, 3:], axis=1)
            yield "reaction_force", force
            yield "reaction_moment", moment
            shear, overturning = np.split(y.take(at.reactions.ravel(), axis=1) @ self._sums, 2, axis=1)
            yield "base_shear", shear
            yield "overturning_moment", overturning
            if at.feet.size:
                yield "pile_force", y.take(at.feet[:, 0], axis=1)
        if SECTIONS in self.outputs:
            yield "section_force", y.take(at.sections[..., :3], axis=1)
            yield "section_moment", y.take(at.sections[..., 3:], axis=1)
        if STRESSES in self.outputs:
            bent = y.take(at.sections[..., BENDING].reshape(-1, 3), axis=1)
            yield "member_stress", self.fibres(bent, STRESSES).reshape(len(y), len(self.places.members), 2, -1)
        if FIBRES in self.outputs:
            for end, bent in self.ends(y).items():
                yield f"fibre_stress{end}", self.fibres(bent, end)
        if UTILISATION in self.outputs:
            bent, sheared = self.utilisation(y)
            yield "utilisation", np.maximum(bent, sheared)
            yield "shear_utilisation", sheared

    def utilisation(self, y: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Largest of each tube (m, nk): of axial force and bending at all its points; of shear, torsion at its ends."""
        of, places = self._resistance, self.places
        bent = bending_utilisation(y, places.columns.along, places.points, of)
        Vy, Vz, T = np.moveaxis(y.take(places.columns.shear, axis=1), -1, 0)
        sheared = shear_utilisation(Vy, Vz, T, Resistance(*(values[:, None] for values in of)))
        return bent[:, places.twin], sheared.max(axis=-1)[:, places.twin]

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
        return self._counted(
            rates, lambda at, how: fatigue.of_samples(stress[at], seconds, self.legs[at].thickness, how)
        )

    def expected(self, lines: np.ndarray, omega: np.ndarray) -> tuple[dict[str, Labelled], tuple[str, ...]]:
        """The same of a Gaussian process, from lines (nw, ny) of the forces."""
        X = {at: self.fibres(forces, at) for at, forces in self.ends(lines).items()}
        rates = {at: crossings(moments(omega, x)) for at, x in X.items()}
        return self._counted(rates, lambda at, how: fatigue.of_lines(X[at], omega, self.legs[at].thickness, how))

    def _counted(
        self, rates: dict[str, np.ndarray], reckon: Callable[[str, Fatigue], fatigue.Damage]
    ) -> tuple[dict[str, Labelled], tuple[str, ...]]:
        dims: tuple[str, ...] = ("leg", "fibre")
        out: dict[str, Labelled] = {}
        failed: list[str] = []
        for at, rate in rates.items():
            if FIBRES in self.outputs:
                out[f"fibre_stress{at}_crossing_rate"] = dims, rate
            if FATIGUE in self.outputs:
                damage = reckon(at, self.fatigue)
                out |= {f"damage{at}": (dims, damage.per_hour), f"equivalent_range{at}": (dims, damage.equivalent)}
                failed += [f"{note}, at the top" if at else note for note in damage.failed]
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
