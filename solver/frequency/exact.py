"""The march's own loads of what moves by lines at sums of a few frequencies: see harmonics, subharmonics."""

from itertools import product
from typing import NamedTuple

import numpy as np

from solver.coupled.equilibrium import balance
from solver.coupled.linear import jacobian, of_waves
from solver.frequency.case import Case
from solver.lines import real_by_complex


class Lattice(NamedTuple):
    """Of nw waves; nt instants."""

    sums: np.ndarray  # m (nk, nw), none of them first
    own: np.ndarray  # (nw,) which are the waves' own
    phases: np.ndarray  # (nt, nk)
    back: np.ndarray  # (nt, nk) from the instants to lines

    @classmethod
    def of(cls, steps: tuple[int, ...], order: int, instants: int) -> "Lattice":
        """All sums of an order at most, each or its negative."""
        every = product(range(-order, order + 1), repeat=len(steps))
        some = [m for m in every if 0 < sum(map(abs, m)) <= order and next(n for n in m if n) > 0]
        sums = np.array([(0,) * len(steps), *some])
        own = [some.index(tuple(row)) + 1 for row in np.eye(len(steps), dtype=int).tolist()]
        phases = np.exp(-2j * np.pi * np.outer(np.arange(instants), sums @ steps) / instants)
        share = np.where(sums.any(axis=1), 2.0, 1.0) / instants
        return cls(sums, np.array(own), phases, share * phases.conj())

    def at_instants(self, lines: np.ndarray) -> np.ndarray:
        """(nt, n) of lines (nk, n)."""
        return self.phases.real @ lines.real - self.phases.imag @ lines.imag

    def lines(self, x: np.ndarray) -> np.ndarray:
        """(nk, n) of what is so at the instants (nt, n)."""
        return real_by_complex(x.T, self.back).T

    def first(self, lines: np.ndarray) -> np.ndarray:
        """(nk, …) of the waves' own (nw, …)."""
        every = np.zeros((len(self.sums), *lines.shape[1:]), complex)
        every[self.own] = lines
        return every


class Linear(NamedTuple):
    """The linear model by lines."""

    omega: np.ndarray  # m·ω (nk,); below zero the conjugate's
    Y: np.ndarray  # (nk, na, na)
    Z: np.ndarray  # dynamic stiffness (nk, n, n) without dampers
    against: np.ndarray  # load against these (nk, nz, nz)

    @classmethod
    def of(cls, case: Case, omega: np.ndarray) -> "Linear":
        """At frequencies (nk,) of either sign."""
        Y = case.impedance_at(np.abs(omega))
        Y[omega < 0] = Y[omega < 0].conj()
        against = case.model.of_floats(omega, Y)
        return cls(omega, Y, case.model.assembled(omega, against), against)


class Waves(NamedTuple):
    """What stays from round to round; all by lines."""

    lattice: Lattice
    more: np.ndarray  # (nk,) times what these lines show is what those make for which they stand
    omega: np.ndarray  # m·ω (nk,); below zero the conjugate's
    Y: np.ndarray  # (nk, na, na)
    excitation: np.ndarray  # (nk, nb, 6)
    force: np.ndarray  # on the floats' coordinates by that, at rest (nk, nz)
    Z: np.ndarray  # dynamic stiffness (nk, n, n) without dampers
    against: np.ndarray  # load against these (nk, nz, nz), of the linear model

    @classmethod
    def of(cls, case: Case, lattice: Lattice, more: np.ndarray, linear: Linear, excitation: np.ndarray) -> "Waves":
        """With the waves' own excitation (nw, nb, 6)."""
        lines, (body, _, rest), (omega, Y, Z, against) = lattice.first(excitation), case.system.resting.value, linear
        at_rest = jacobian(body, rest)
        force = lines.reshape(len(lines), -1) @ at_rest.reshape(-1, at_rest.shape[-1])
        return cls(lattice, more, omega, Y, lines, force, Z, against)


def beyond(case: Case, waves: Waves, Z: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """N (nk, nz) on the floats' coordinates, of lines Z (nk, nz), and all loads W on the floats (nk, nb, 6)."""
    body, _, rest = case.system.resting.value
    lattice, model, rate = waves.lattice, case.model, -1j * waves.omega[:, None]
    z, dz, ddz = np.split(lattice.at_instants(np.concatenate([Z, rate * Z, rate**2 * Z], axis=1)), 3, axis=1)
    at = balance(body, rest + z, dz, ddz)
    lever, directions = of_waves(body, at, rest)
    nt, nb, _, nz = lever.shape
    lever = lever.reshape(nt, 6 * nb, nz)
    V = lattice.lines((lever @ dz[..., None])[..., 0] @ model.along)
    radiated = (waves.Y @ V[..., None])[..., 0]
    water = lattice.at_instants(waves.excitation.reshape(len(V), 6 * nb) - radiated @ model.along.T)
    load = at.load + (water[:, None] @ lever)[:, 0]
    if body.turning:
        water = (directions @ water.reshape(nt, nb, 6, 1)).reshape(nt, 6 * nb)
    every = lattice.lines(np.concatenate([load, at.wrench.reshape(nt, 6 * nb) + water], axis=1))
    more = every[:, :nz] + (waves.against @ Z[..., None])[..., 0] - waves.force
    more[0] -= case.loads_at_rest[0]
    return more, every[:, nz:].reshape(-1, nb, 6)
