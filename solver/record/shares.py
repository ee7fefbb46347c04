"""How much of a record swings in shapes beside its waves, by which a memory's misfit counts there.

With x = Σ φ q of the system's shapes, of unit inertia, q = φᵀ(M + A(ω) - A∞)x. What of q is beside the waves moves an
output, that is c for q = 1, by the share ⟨q²⟩|c|² of its variance.
"""

import numpy as np

from solver.coupled.linear import impedance_anywhere, linear_model
from solver.coupled.system import System
from solver.hydrodynamics.bem.coefficients import Hydrodynamics
from solver.record.beside import beside, effects, waves
from solver.record.channels import Channels
from solver.record.effects import joint_forces, memory_effect
from solver.record.probe import least_sizes
from solver.record.spectra import all_lines
from solver.statistics import FAINT, STATISTICS


class Shares:
    """Of the variance of any output's that each shape beside the waves has."""

    def __init__(self, system: System, h: Hydrodynamics | None):
        """Nothing is taken in where no shape would count by all of it, and nothing told: 1."""
        self.system, self.swung = system, list[np.ndarray]()
        self.along = np.zeros((len(linear_model(system).mass), 0))
        if h is None or system.fit is None or not (of := beside(system, h)).omega.size:
            return
        if effects(system, h, system.fit.frequency).max() > memory_effect(system, h, 0.0):
            model, Y = linear_model(system), impedance_anywhere(system, h, of.omega)
            added = np.einsum("mi,mij->mj", of.moved, -Y.imag) / of.omega[:, None]
            self.own, self.along = of.omega, model.mass @ of.shapes.T + (added @ model.active).T
            self.outputs = _outputs(system, of.omega, of.shapes, Y)

    def add(self, times: np.ndarray, p: np.ndarray, z: np.ndarray) -> None:
        """Take in a block of modes p (m, nm) and of carriers and joints z (m, nz)."""
        if self.along.size:
            s, (nc, nm) = self.system.scene.settings, self.system.structure.carrier.shape
            kept = (times > s.discard) & (times <= s.discard + s.duration)
            self.swung.append(np.concatenate([p[:, :nm], z[:, nc:]], axis=1)[kept] @ self.along)

    def of(self, tables: dict[str, np.ndarray]) -> np.ndarray | float:
        """Shares (m,), each of the output of which it is most, by their statistics (…, 5)."""
        if not self.swung:
            return 1.0
        omega, lines = all_lines(np.concatenate(self.swung), self.system.dt / 2)
        slowest, fastest = waves(self.system)
        apart = np.where(self.own < slowest, omega[:, None] < slowest, omega[:, None] > fastest)
        square = 0.5 * np.sum(np.abs(lines) ** 2 * apart, axis=0)
        stds = {name: tables[name][..., STATISTICS.index("std")] for name in self.outputs}
        least, most = least_sizes(self.system, {n: std for n, std in stds.items() if n != "hinge_force"}), 0.0
        for name, unit in self.outputs.items():
            size = np.maximum(stds[name], np.maximum(FAINT * np.nanmax(stds[name]), least[name]))
            parts = np.abs(unit) ** 2 / size**2
            most = np.maximum(most, square * np.nanmax(parts.reshape(len(unit), -1), axis=1))
        return np.minimum(most, 1.0)


def _outputs(system: System, omega: np.ndarray, shapes: np.ndarray, Y: np.ndarray) -> dict[str, np.ndarray]:
    """What shapes (m, n) of frequencies omega (m,) are of outputs (m, …)."""
    channels, nm = Channels(system.scene, system.support), system.structure.omega.size
    units = dict(channels.motions(shapes[:, nm:]))
    units["hinge_force"] = joint_forces(system, omega, shapes + 0j, Y, np.zeros(Y.shape[:2], complex))
    if channels.legs is not None:
        units["top_displacement"] = channels.legs.top_displacement(shapes[:, :nm])
    return units
