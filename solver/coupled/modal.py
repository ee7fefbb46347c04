"""The support's modes within a step: eliminated exactly by their flexibility at the floats' nodes, and their drag."""

from typing import NamedTuple

import numpy as np

from solver.coupled.scheme import LOBATTO, Scheme
from solver.kernels import fast_lean_kernel, kernel, lean_kernel, whole_kernel

ROUNDS = 40  # that tell within some per cent how much drag answers


class Structure(NamedTuple):
    """Modes of the support and its drag stations; all empty for a fixed support."""

    omega: np.ndarray  # (nm,) [rad/s]
    damping: np.ndarray  # (nm,) ratio
    carrier: np.ndarray  # (nc, nm) carrier coordinates of unit modal amplitude
    station: np.ndarray  # (nm, nd, ns) normal displacement at the drag stations
    drag: np.ndarray  # (ns,) ½ρ C_D D times length [kg/m]
    scale: np.ndarray  # (nm,) largest displacement of unit amplitude, for convergence


class WaterAbout(NamedTuple):
    """About the drag stations at both stages of a step."""

    flow: np.ndarray  # (2, nd, ns) particle velocity normal to the members [m/s]
    wet: np.ndarray  # (2, ns) share of what each stands for; (2, 0): all of it, and no push
    push: np.ndarray  # (2, nd, ns) of the waves' inertia, besides that to still water [N]


@fast_lean_kernel(forceinline=True)
def drag(
    structure: Structure,
    water: WaterAbout,
    dp: np.ndarray,
    since: int,
    force: np.ndarray,
    flow: np.ndarray,
) -> None:
    """Modal drag of relative velocity, ½ρC_D D|u-v|(u-v), at a step's stages from `since` on, added to force (2, nm).

    flow (2, nd, ns) is left with the stations' drag [N]. Stations are innermost, so that both products with the modal
    shapes run along memory.
    """
    for s in range(since, 2):
        flow[s] = 0.0
        for d in range(flow.shape[1]):
            _add_rates(structure.station, d, dp[s], flow[s, d])
        _relative_drag(structure.drag, water.flow[s], flow[s])
        if water.wet.size:
            _partly_wet(water.wet[s], water.push[s], flow[s])
        for d in range(flow.shape[1]):
            _add_loads(structure.station, d, flow[s, d], force[s])


@fast_lean_kernel(forceinline=True)
def _add_rates(station: np.ndarray, d: int, rate: np.ndarray, flow: np.ndarray) -> None:
    """flow (ns,) += Σ station[:, d] rate (nm,); two modes at once, for each has to fetch the flow and put it back.

    `station[:, d]` as an array would not be known to run along memory, and loops over it would not be SIMD's.
    """
    nm = rate.size
    for m in range(0, nm - 1, 2):
        first, second, x, y = station[m, d], station[m + 1, d], rate[m], rate[m + 1]
        for i in range(flow.size):
            flow[i] += first[i] * x + second[i] * y
    if nm % 2:
        last, x = station[nm - 1, d], rate[nm - 1]
        for i in range(flow.size):
            flow[i] += last[i] * x


@fast_lean_kernel(forceinline=True)
def _add_loads(station: np.ndarray, d: int, flow: np.ndarray, force: np.ndarray) -> None:
    """force (nm,) += station[:, d] flow (ns,) of drag."""
    nm = force.size
    for m in range(0, nm - 1, 2):
        first, second, x, y = station[m, d], station[m + 1, d], 0.0, 0.0
        for i in range(flow.size):
            x += first[i] * flow[i]
            y += second[i] * flow[i]
        force[m] += x
        force[m + 1] += y
    if nm % 2:
        last, x = station[nm - 1, d], 0.0
        for i in range(flow.size):
            x += last[i] * flow[i]
        force[nm - 1] += x


@fast_lean_kernel(forceinline=True)
def _relative_drag(size: np.ndarray, water: np.ndarray, flow: np.ndarray) -> None:
    """flow (nd, ns) <- drag [N] of water beside stations that move by it [m/s].

    In a frame's usual two directions along memory by rows of their own, several stations at once.
    """
    if flow.shape[0] == 2:
        u, v, x, y = water[0], water[1], flow[0], flow[1]
        for i in range(size.size):
            along, across = u[i] - x[i], v[i] - y[i]
            factor = size[i] * np.sqrt(along * along + across * across)
            x[i], y[i] = factor * along, factor * across
        return
    for i in range(size.size):
        square = 0.0
        for d in range(flow.shape[0]):
            square += (water[d, i] - flow[d, i]) ** 2
        factor = size[i] * np.sqrt(square)
        for d in range(flow.shape[0]):
            flow[d, i] = factor * (water[d, i] - flow[d, i])


@fast_lean_kernel(forceinline=True)
def _partly_wet(wet: np.ndarray, push: np.ndarray, flow: np.ndarray) -> None:
    """flow (nd, ns) <- of stations of which a share is wet (ns,), and what pushes besides (nd, ns) [N]."""
    for d in range(flow.shape[0]):
        for i in range(wet.size):
            flow[d, i] = wet[i] * flow[d, i] + push[d, i]


def answer(structure: Structure, resistance: np.ndarray, inverse: np.ndarray, dt: float) -> float:
    """By how many times as much the drag changes by what a change of it moves within a step.

    Spectral radius, by rounds, of what drag SᵀRS by stage rates dt A D⁻¹ makes of stage loads, see `flexibility`;
    resistance R (ns, nd, nd) [N s/m].
    """
    if not resistance.any():
        return 0.0
    station, rates = structure.station, dt * LOBATTO.A @ inverse
    load, sizes = np.random.default_rng(0).normal(size=(structure.omega.size, 2)), np.ones(ROUNDS)
    for n in range(ROUNDS):
        moved = np.tensordot(station, (rates @ load[..., None])[..., 0], (0, 0))  # (nd, ns, 2)
        load = np.tensordot(station, np.einsum("sde,esk->dsk", resistance, moved), 2)
        sizes[n] = np.linalg.norm(load)
        if not sizes[n] > 0:  # at stations that no mode moves
            return 0.0
        load /= sizes[n]
    return float(np.exp(np.log(sizes[ROUNDS // 2 :]).mean()))  # they go to and fro with a pair of complex ones


@whole_kernel
def flexibility(structure: Structure, dt: float) -> tuple[np.ndarray, np.ndarray]:
    """D⁻¹ (nm, 2, 2) of each mode's stages and H (2, nc, 2, nc) of the carriers.

    D = I + 2ζω dt A + ω² dt² AA maps a mode's stage accelerations to its stage loads.
    """
    nc, nm = structure.carrier.shape
    inverse, H = np.empty((nm, 2, 2)), np.empty((2, nc, 2, nc))
    fill_flexibility(structure, dt, LOBATTO, inverse, H)
    return inverse, H


@kernel
def fill_flexibility(structure: Structure, dt: float, scheme: Scheme, inverse: np.ndarray, H: np.ndarray) -> None:
    """D⁻¹ and H of `flexibility`, by one of the schemes, into arrays that are there."""
    (nc, nm), A, AA = structure.carrier.shape, scheme.A, scheme.AA
    H[:] = 0.0
    for m in range(nm):
        c, k = 2 * structure.damping[m] * structure.omega[m] * dt, (structure.omega[m] * dt) ** 2
        d00, d01 = 1.0 + c * A[0, 0] + k * AA[0, 0], c * A[0, 1] + k * AA[0, 1]
        d10, d11 = c * A[1, 0] + k * AA[1, 0], 1.0 + c * A[1, 1] + k * AA[1, 1]
        det = d00 * d11 - d01 * d10
        inverse[m, 0, 0], inverse[m, 1, 1] = d11 / det, d00 / det
        inverse[m, 0, 1], inverse[m, 1, 0] = -d01 / det, -d10 / det
        for i in range(nc):
            for j in range(i + 1):
                both = structure.carrier[i, m] * structure.carrier[j, m]
                for s in range(2):
                    for l in range(2):
                        H[s, i, l, j] += inverse[m, s, l] * both
    for i in range(nc):
        for j in range(i):
            for s in range(2):
                for l in range(2):
                    H[s, j, l, i] = H[s, i, l, j]


@lean_kernel
def carry(structure: Structure, amplitude: np.ndarray, out: np.ndarray) -> None:
    """out[:nc] = carrier coordinates of modal amplitudes (nm,)."""
    nc, nm = structure.carrier.shape
    for i in range(nc):
        total = 0.0
        for m in range(nm):
            total += structure.carrier[i, m] * amplitude[m]
        out[i] = total
