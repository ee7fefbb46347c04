"""Mooring lines beyond their slope at rest: their tensions as floats move, and how much else they hold these by.

Of Gaussian motions z, of covariance S, few normal numbers y tell all: of a line's tension T(z) those that its slope g
goes with, z = Sg/(gᵀSg)^½ y, at rest and where that has pulled it taut. Of a single wave, and of known phases, it is
that of samples.

Loads Q(z) of all lines are linearised statistically (Roberts and Spanos 1990): in the mean they are ⟨Q⟩ and ⟨Q yᵀ⟩ y.
The linear model has ⟨Q⟩, and the slope at rest.
"""

from functools import lru_cache
from typing import NamedTuple

import numpy as np

from solver.coupled.equilibrium import balance
from solver.coupled.linear import KNOWN
from solver.coupled.system import Resting
from solver.frequency import gaussian
from solver.frequency.case import Case
from solver.frequency.response import Response
from solver.lines import lengths
from solver.mooring import lines_of
from solver.multibody.bodies import Bodies
from solver.multibody.joint_law import JointLaw
from solver.record.effects import response_error
from solver.statistics import STATISTICS

NEAR = 1e-4  # [m or rad] to either side, of slopes
TAUT = 2.0  # standard deviations, to where a line's slope is another
COUNTS = 17, 7, 3  # nodes along each normal number, those that matter most first
ROUND = 72  # places on the circle of largest ones
LITTLE = 1e-6  # of a slope's or a stiffness's largest part: less is none
STD, MEAN, RMS = (STATISTICS.index(name) for name in ("std", "mean", "rms"))


class _Normal(NamedTuple):
    """Nodes of k independent normal numbers."""

    y: np.ndarray  # (m, k)
    weight: np.ndarray  # (m,)

    @classmethod
    def of(cls, k: int) -> "_Normal":
        y, weight = zip(*map(gaussian.nodes, COUNTS[:k]), strict=True)
        grids = (np.stack(np.meshgrid(*each, indexing="ij"), axis=-1).reshape(-1, k) for each in (y, weight))
        return cls(next(grids), next(grids).prod(axis=1))


def tension_table(case: Case, Z: np.ndarray, z: np.ndarray) -> np.ndarray:
    """Statistics (number of lines, 5) of the tensions by motions of lines Z (nl, nz) about z (nz,)."""
    body, channels, process = case.system.bodies, case.channels, case.process
    if process.known:
        return gaussian.tabulated(channels.line_tension(body, z + block) for block in process.blocks(Z))
    S, table = gaussian.covariance(Z, Z), []
    for i, g in enumerate(slopes(case, z).T):
        ways = _ways(case, z, S, i, g)
        normal = _Normal.of(len(ways))

        def tension(y: np.ndarray, i: int = i, ways: np.ndarray = ways) -> np.ndarray:
            return channels.line_tension(body, z + y @ ways)[:, i]

        told = tension(normal.y)
        mean = normal.weight @ told
        std = np.sqrt(normal.weight @ (told - mean) ** 2)
        angle = 2 * np.pi * np.arange(ROUND) / ROUND
        circle = np.stack([np.cos(angle), np.sin(angle)], axis=-1)[:, : len(ways)]
        ends = tension(gaussian.peak(Z @ g[:, None], process)[0] * circle)
        table.append([ends.max(), ends.min(), mean, np.hypot(mean, std), std])
    return np.array(table)


def slopes(case: Case, z: np.ndarray) -> np.ndarray:
    """∂T/∂z (nz, number of lines)."""
    steps = NEAR * np.eye(z.size)
    high, low = (case.channels.line_tension(case.system.bodies, z + way * steps) for way in (1, -1))
    return (high - low) / (2 * NEAR)


def _ways(case: Case, z: np.ndarray, S: np.ndarray, i: int, g: np.ndarray) -> np.ndarray:
    """Motions (k, nz), two at most, by unit normal numbers that line i's tension goes with, slope g (nz,) at rest."""
    size = np.sqrt(g @ S @ g)
    if not size > 0:
        return np.zeros((1, z.size))
    first = S @ g / size
    taut = slopes(case, z + TAUT * first)[:, i]
    other = taut - (taut @ first) / size * g
    left = other @ S @ other
    if not left > LITTLE * (taut @ S @ taut):
        return first[None]
    return np.stack([first, S @ other / np.sqrt(left)])


class Held(NamedTuple):
    """What lines do to floats that move, nz coordinates."""

    load: np.ndarray  # ⟨Q⟩ (nz,) less Q at rest
    wrench: np.ndarray  # (nb, 6) the same of their loads on the floats
    stiffness: np.ndarray  # -∂⟨Q⟩/∂z (nz, nz) beyond that of Q at rest
    slope: np.ndarray  # (nb, 6, nz) the same of their loads on the floats, with their sign
    rest: np.ndarray  # (nz,) std of what else they do, where that is most
    along: np.ndarray  # (nz,) motions' coefficients of the unit number that goes with


def held(case: Case, Z: np.ndarray, z: np.ndarray) -> Held:
    """By motions of lines Z (nl, nz) about z (nz,): of those three numbers of unit variance by which lines hold the
    most, normal ones, or of a single wave those of its phases."""
    at_rest = case.system.equilibrium[0]
    size, axes = np.linalg.eigh(gaussian.covariance(Z, Z))
    moves = size > LITTLE**2 * size.max()
    if not moves.any():
        none, nb = np.zeros(z.size), case.system.bodies.axes.size
        return Held(none, np.zeros((nb, 6)), np.zeros((z.size, z.size)), np.zeros((nb, 6, z.size)), none, none)
    L, back = axes[:, moves] * np.sqrt(size[moves]), axes[:, moves] / np.sqrt(size[moves])
    K, by_z = _slopes_at_rest(case.system.resting)
    stiff, turn = np.linalg.eigh(L.T @ (K + K.T) @ L / 2)
    turn = turn[:, np.argsort(-np.abs(stiff))[: len(COUNTS)]]
    ways, back = (L @ turn).T, back @ turn
    normal = _Normal.of(len(ways))
    if len(Z) == 1:
        y = gaussian.one_period(Z) @ back
        normal = _Normal(y, np.full(len(y), 1 / len(y)))
    Q, on_floats = _line_loads(case.system.bodies, np.concatenate([at_rest[None], z + normal.y @ ways]))
    mean = normal.weight @ Q[1:]
    slope = (normal.weight[:, None] * normal.y).T @ Q[1:]
    more = -ways @ slope.T - ways @ K @ ways.T
    of_wrench = np.tensordot((normal.weight[:, None] * normal.y).T, on_floats[1:], 1) - np.tensordot(ways, by_z, 1)
    left = (Q[1:] - mean - normal.y @ slope) @ ways.T
    variance, most = np.linalg.eigh(left.T @ (normal.weight[:, None] * left))
    return Held(
        load=mean - Q[0],
        wrench=np.tensordot(normal.weight, on_floats[1:], 1) - on_floats[0],
        stiffness=back @ ((more + more.T) / 2) @ back.T,
        slope=np.moveaxis(np.tensordot(back, of_wrench, 1), 0, -1),
        rest=np.sqrt(variance[-1].clip(min=0.0)) * back @ most[:, -1],
        along=back @ most[:, -1],
    )


def lines_effect(case: Case, law: JointLaw, response: Response, tensions: np.ndarray) -> float:
    """Relative error of motions, powers and `tensions` (n, 5) by lines that are held to their slopes at rest.

    By their mean stiffness, and by what is left of their loads, which moves the floats against their motions.
    """
    Z, model, omega = response.Z, case.model, response.omega
    z = case.system.equilibrium[0] + model.shape @ response.mean.x
    of = held(case, Z, z)
    added = model.shape.T @ of.stiffness @ model.shape
    D = model.assembled(omega, model.of_floats(omega, case.impedance)) - 1j * omega[:, None, None] * response.damping
    force = np.stack([response.X @ added.T, np.outer(Z @ of.along, of.rest @ model.shape)], axis=-1)
    changed, more = np.moveaxis(np.linalg.solve(D + added, force), -1, 0)
    sizes = (lengths(x.T) for x in (more, response.X))
    other = (response.X - changed) * (1 - np.minimum(_share(*sizes), 1.0))
    waves = slice(case.waves.size)
    moved = response_error(case.system, law, case.waves, response.X[waves], other[waves])
    exact = tension_table(case, other @ model.shape.T, z)
    apart = np.abs(exact - tensions)
    of_size, of_std = (_share(apart[:, which], exact[:, [k]]) for which, k in (([MEAN, RMS], RMS), ([STD], STD)))
    return float(max(moved, of_size.max(initial=0.0), of_std.max(initial=0.0)))


def _share(part: np.ndarray, whole: np.ndarray) -> np.ndarray:
    return np.divide(part, whole, out=np.zeros(part.shape), where=whole > 0)


def without_lines(body: Bodies) -> Bodies:
    """The same bodies, held by all else."""
    return body._replace(lines=lines_of([()] * body.axes.size)) if body.lines.length.size else body


def _line_loads(body: Bodies, z: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Q (m, nz), and what the lines do to the floats (m, nb, 6), at coordinates (m, nz)."""
    with_, others = balance(body, z), balance(without_lines(body), z)
    return with_.load - others.load, with_.wrench - others.wrench


@lru_cache(maxsize=KNOWN)
def _slopes_at_rest(resting: Resting) -> tuple[np.ndarray, np.ndarray]:
    """-∂Q/∂z (nz, nz), and the loads on the floats by z (nz, nb, 6); the same in all seas."""
    body, _, z = resting.value
    (high, on_floats), (low, others) = (_line_loads(body, z + side * NEAR * np.eye(z.size)) for side in (1, -1))
    return (low - high) / (2 * NEAR), (on_floats - others) / (2 * NEAR)
