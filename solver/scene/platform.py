"""The elastic support of floats."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, replace
from typing import Annotated, Literal, NamedTuple

import numpy as np

from solver.errors import InputError, refuse
from solver.quantities import Quantity, out_of_range, take_tuples
from solver.scene.water import Water
from solver.structure.frame import Frame
from solver.structure.load_history import LoadHistory, in_plane


class StructuralDamping(NamedTuple):
    """Of a platform's modes, in water or dry: one ratio, or Rayleigh's C = αM + βK, M with or without added mass."""

    ratio: float
    alpha: float = 0.0  # [1/s]
    beta: float = 0.0  # [s]
    dry: bool = False

    @property
    def even(self) -> bool:
        """Whether all modes have one ratio."""
        return self.alpha == self.beta == 0.0

    def of(self, omega: np.ndarray, share: np.ndarray) -> np.ndarray:
        """Ratio ζ (nm,) of modes of natural frequency ω (nm,) in water: 2ζω = α + βω² of Rayleigh's.

        share (nm,): of their mass that is not added mass, μ. Given dry, ζ is ζμ^½ in water, for ω_dry² = ω²/μ, and α is
        αμ.
        """
        mass = share if self.dry else np.ones(omega.shape)
        if self.even:
            return self.ratio * np.sqrt(mass)
        return 0.5 * (self.alpha * mass / omega + self.beta * omega)

    def __str__(self) -> str:
        """As records have it."""
        where = "dry" if self.dry else "in water"
        if self.even:
            return f"{self.ratio:g} of critical in each mode {where}"
        return f"Rayleigh's, {self.alpha:g} 1/s of the mass {where}, {self.beta:g} s of the stiffness"


@dataclass(frozen=True, slots=True, kw_only=True)
class Platform:
    """A bottom-fixed elastic support: a beam frame, its damping and where floats are hinged."""

    frame: Frame
    legs: Annotated[tuple[str, ...], "Members whose displacements and stresses are put out"] = ()
    damping_ratio: Annotated[
        float, Quantity("-", least=0, below=1), "Of every mode in water: with the members' added mass, without floats"
    ] = 0.01
    damping_of: Annotated[
        Literal["water", "dry"], "Whether damping is that of the modes in water, or of those without added mass"
    ] = "water"
    rayleigh_mass: Annotated[
        float,
        Quantity("1/s", least=0),
        "Rayleigh's α: damping αM + βK, M with the members' added mass, instead of a ratio",
    ] = 0.0
    rayleigh_stiffness: Annotated[float, Quantity("s", least=0), "Rayleigh's β: damping αM + βK instead of a ratio"] = (
        0.0
    )
    hinge_nodes: Mapping[str, str] = field(default_factory=dict)  # float -> node
    geometric_stiffness: Annotated[bool, "Whether the legs' weight bends them further"] = False
    # "standard": C_M rho V du/dt - (C_M - 1) rho V a; "relative" (Heo et al. 2022, eq. 16, as
    # printed): (C_M - 1) rho V (du/dt - a), which leaves out the undisturbed wave's pressure.
    wave_inertia: Annotated[Literal["standard", "relative"], "Morison inertia: the whole, or the paper's eq. 16"] = (
        "standard"
    )
    wave_stretching: Annotated[
        Literal["none", "wheeler", "extrapolated"],
        "Morison's load in the march: to still water, or to the surface, with water stretched to it or extrapolated",
    ] = "none"

    load_histories: tuple[LoadHistory, ...] = ()

    def __post_init__(self) -> None:
        take_tuples(self)
        members = [member.name for member in self.frame.members]
        strange = [(i, leg) for i, leg in enumerate(self.legs) if leg not in members]
        unknown = [InputError(f"platform.legs[{i}]", leg, f"must be one of {', '.join(members)}") for i, leg in strange]
        refuse([*out_of_range(self, "platform"), *unknown, *self._history_problems()])

    def symmetric(self, sea: Water) -> bool:
        """Whether frame and load histories are mirror images of themselves in y = 0."""
        from solver.structure import in_water  # slow to import, for sparse matrices, and the command line rarely asks

        if not in_plane(self.load_histories, self.frame.nodes):
            return False
        return in_water.symmetric(self.frame, sea.density, sea.gravity, softened=self.geometric_stiffness)

    @property
    def damping(self) -> StructuralDamping:
        """Of its modes."""
        given = self.damping_ratio, self.rayleigh_mass, self.rayleigh_stiffness
        return StructuralDamping(*given, dry=self.damping_of == "dry")

    def cut(self, times: int) -> "Platform":
        """With so many times as many elements."""
        members = tuple(replace(m, elements=times * m.elements) for m in self.frame.members)
        return replace(self, frame=replace(self.frame, members=members))

    def undamped(self) -> "Platform":
        """What has the same modes."""
        return replace(self, damping_ratio=0.0, damping_of="water", rayleigh_mass=0.0, rayleigh_stiffness=0.0)

    def _history_problems(self) -> Iterator[InputError]:
        for i, history in enumerate(self.load_histories):
            if history.node not in self.frame.nodes:
                limit = f"must be one of {', '.join(self.frame.nodes)}"
                yield InputError(f"platform.load_histories[{i}].node", history.node, limit)

    def __hash__(self) -> int:
        """By names alone, which is quick; what no wave changes is kept for the next task with an equal platform."""
        return hash((self.legs, *self.frame.nodes, *self.hinge_nodes))
