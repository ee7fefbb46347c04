"""An elastic platform's forces as outputs: reactions and their sums, section forces, stress of fixed fibres."""

from collections.abc import Callable, Iterator
from functools import cached_property

import numpy as np

from solver.coupled.forces import FATIGUE, FIBRES, REACTIONS, SECTIONS, UTILISATION, Forces
from solver.record import fatigue
from solver.scene import Fatigue, Settings
from solver.structure.frame import FORCES
from solver.structure.tubular import Resistance, resistance, utilisation

Labelled = tuple[tuple[str, ...], np.ndarray]

DIMS = {
    "reaction_force": ("foot", "direction"),
    "reaction_moment": ("foot", "direction"),
    "base_shear": ("direction",),
    "overturning_moment": ("direction",),
    "pile_force": ("leg",),
    "section_force": ("member", "end", "force"),
    "section_moment": ("member", "end", "moment"),
    "fibre_stress": ("leg", "fibre"),
    "utilisation": ("tube",),
}


class Steel:
    """Channels of the outputs that a scene asks for, each a linear function of the frame's forces y (m, ny)."""

    def __init__(self, forces: Forces, settings: Settings):
        self.forces, self.places, self.outputs, self.fatigue = forces, forces.places, settings.outputs, settings.fatigue
        self.feet = forces.places.feet
        self.material_factor = settings.utilisation.material_factor

    @property
    def point(self) -> np.ndarray:
        """(3,) where the overturning moment is taken about: amid the feet, at the height of the lowest [m]."""
        foot = self.places.foot
        return np.array([*foot[:, :2].mean(axis=0), foot[:, 2].min()])

    def compression(self, y: np.ndarray) -> np.ndarray:
        """N/A, c My/Iy, c Mz/Iz at the legs' feet, (m, nl, 3)."""
        return self.places.split(y)[0] * self.feet.extreme

    def fibres(self, y: np.ndarray) -> np.ndarray:
        """Signed stress (m, nl, nf) at the legs' feet, tension positive."""
        return np.einsum("mlf,lfp->mlp", self.places.split(y)[0], self.feet.stress)

    def channels(self, y: np.ndarray) -> Iterator[tuple[str, np.ndarray]]:
        """Name and values (m, …) of each output, from samples, from lines or from values at rest."""
        feet, sections, reactions = self.places.split(y)
        if REACTIONS in self.outputs:
            force, moment = reactions[..., :3], reactions[..., 3:]
            yield "reaction_force", force
            yield "reaction_moment", moment
            yield "base_shear", -force.sum(axis=1)
            lever = self.places.foot - self.point
            yield "overturning_moment", -(np.cross(lever, force) + moment).sum(axis=1)
            if feet.shape[1]:
                yield "pile_force", feet[..., 0]
        if SECTIONS in self.outputs:
            yield "section_force", sections[..., :3]
            yield "section_moment", sections[..., 3:]
        if FIBRES in self.outputs:
            yield "fibre_stress", self.fibres(y)
        if UTILISATION in self.outputs:
            yield "utilisation", self.utilisation(y)

    def utilisation(self, y: np.ndarray) -> np.ndarray:
        """Largest along each tube (m, nk), at the ends of its elements."""
        N, My, Mz = np.moveaxis(self.places.along_tubes(y), -1, 0)
        ends = 2 * self.places.elements
        return np.maximum.reduceat(utilisation(N, My, Mz, self._resistance), np.cumsum(ends) - ends, axis=1)

    @cached_property
    def _resistance(self) -> Resistance:
        """At both ends of each element of the tubes."""
        frame = self.places.influence.model.frame
        members = {m.name: m for m in frame.members}
        tubes = [members[name] for name in self.places.checked]
        each = [resistance(m, frame.buckling_length(m), self.material_factor) for m in tubes]
        repeats = 2 * self.places.elements
        return Resistance(*(np.repeat(np.array(values), repeats) for values in zip(*each, strict=True)))

    @property
    def counts(self) -> bool:
        """Whether all samples of the fibres are needed, and not their statistics alone."""
        return bool({FIBRES, FATIGUE} & set(self.outputs))

    def counted(self, feet: np.ndarray, seconds: float) -> tuple[dict[str, Labelled], tuple[str, ...]]:
        """Crossing rates and damage, and what failed, of samples of N, My, Mz at the feet (m, nl, 3) in a time [s]."""
        stress = np.einsum("mlf,lfp->mlp", feet, self.feet.stress)
        rates = fatigue.crossing_rate(stress, seconds)
        return self._counted(rates, lambda how: fatigue.of_samples(stress, seconds, self.feet.thickness, how))

    def expected(self, lines: np.ndarray, omega: np.ndarray) -> tuple[dict[str, Labelled], tuple[str, ...]]:
        """The same of a Gaussian process, from lines (nw, ny) of the forces."""
        X = self.fibres(lines)
        power = np.abs(X) ** 2
        m0, m2 = power.sum(axis=0), np.tensordot(omega**2, power, axes=1)
        rates = np.sqrt(np.divide(m2, m0, out=np.full_like(m0, np.nan), where=m0 > 0)) / (2 * np.pi)
        return self._counted(rates, lambda how: fatigue.of_lines(X, omega, self.feet.thickness, how))

    def _counted(
        self, rates: np.ndarray, reckon: Callable[[Fatigue], fatigue.Damage]
    ) -> tuple[dict[str, Labelled], tuple[str, ...]]:
        dims: tuple[str, ...] = ("leg", "fibre")
        out: dict[str, Labelled] = {}
        if FIBRES in self.outputs:
            out["fibre_stress_crossing_rate"] = dims, rates
        if FATIGUE not in self.outputs:
            return out, ()
        damage = reckon(self.fatigue)
        return {**out, "damage": (dims, damage.per_hour), "equivalent_range": (dims, damage.equivalent)}, damage.failed

    def coords(self) -> dict[str, np.ndarray]:
        """Labels of the dimensions."""
        return {
            "foot": np.array(self.places.grounded),
            "member": np.array(self.places.members),
            "tube": np.array(self.places.checked),
            "end": np.array(["start", "end"]),
            "force": np.array(FORCES[:3]),
            "moment": np.array(FORCES[3:]),
            "fibre": np.arange(1, self.feet.fibre.shape[1] + 1),
        }

    def variables(self) -> dict[str, Labelled]:
        """Where what is put out is: the moment's point, the fibres."""
        out: dict[str, Labelled] = {}
        if REACTIONS in self.outputs:
            out["moment_point"] = ("direction",), self.point
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
