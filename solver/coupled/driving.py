"""What the waves of one sea drive on an elastic platform: rows of loads and velocities, one column a wave."""

from dataclasses import replace
from functools import lru_cache
from typing import NamedTuple

import numpy as np

from solver.coupled.support import KNOWN, Support
from solver.coupled.typical import of_one_speed
from solver.keys import shared
from solver.lines import real_by_complex
from solver.sea.field import WaveField

NODES = 16, 32, 48, 64  # of curves over wavenumbers
SMOOTH = 1e-11  # of the largest of its kind, between them
ROUNDING = 1e-13  # of the largest pattern of a flow: what is less counts as none


def share_curve(support: Support, count: int) -> bool:
    """Whether seas of so many waves are of a curve over typical waves."""
    return 1 < support.typical.k.size < count


class Driven(NamedTuple):
    """Complex rows of what n waves drive on a support."""

    modes: np.ndarray  # (nm, n) inertia load
    stations: np.ndarray  # (ns, nd, n) normal particle velocity
    forces: np.ndarray  # (r, n) what the inertia load does to the frame's forces
    left_out: np.ndarray  # (nt, n) and to what is left out of the tops


@lru_cache(maxsize=KNOWN)
def driven(support: Support, field: WaveField) -> Driven:
    """By one sea; from a curve over typical waves where those are fewer than its own."""
    curve = _curve(support) if share_curve(support, field.k.size) else None
    rows = _rows(support, field) if curve is None else curve.at(field)
    (ns, nd, _), sizes = support.station_shape.shape, [part.shape[1] for part in _maps(support)]
    modes, left_out, borne, stations = np.split(rows, np.cumsum(sizes))
    return Driven(modes, stations.reshape(ns, nd, field.k.size), borne, left_out)


@lru_cache(maxsize=KNOWN)
def patterns(support: Support) -> np.ndarray | None:
    """Orthonormal (nd ns, r) that the flow at the stations is made of in all seas that share a curve; None without one.

    r is much less than nd ns: what waves do at many depths differs little.
    """
    curve, (ns, nd, _) = _curve(support), support.station_shape.shape
    if curve is None:
        return None
    at_nodes = curve.values[:, curve.values.shape[1] - ns * nd :].reshape(len(curve.nodes), ns, nd)
    flow = at_nodes.T.reshape(nd * ns, len(curve.nodes))
    shapes, size, _ = np.linalg.svd(np.concatenate([flow.real, flow.imag], axis=1), full_matrices=False)
    return shared(np.ascontiguousarray(shapes[:, size > ROUNDING * size.max(initial=0.0)]))


class _Curve(NamedTuple):
    """Rows per amplitude over log k: the polynomial through Chebyshev's nodes, by its barycentric formula."""

    nodes: np.ndarray  # (n,)
    values: np.ndarray  # (n, m) complex

    def at(self, field: WaveField) -> np.ndarray:
        """(m, nw) of a sea."""
        n = len(self.nodes)
        weight = (-1.0) ** np.arange(n) * np.sin((np.arange(n) + 0.5) * np.pi / n)
        away = np.log(field.k)[:, None] - self.nodes
        share = weight / np.where(away == 0, np.finfo(float).tiny ** 0.1, away)
        share /= share.sum(axis=1, keepdims=True)
        rows = real_by_complex(share, self.values)
        rows *= field.sea.amplitude[:, None]
        return rows.T


@lru_cache(maxsize=KNOWN)
def _curve(support: Support) -> _Curve | None:
    """Over the typical waves, to rounding of the largest of each kind of row; None where no number of nodes is enough.

    Many seas share it, and it costs less than what the water does at each place.
    """
    typical, ends = support.typical, np.log(support.typical.k[[0, -1]])
    sizes = np.cumsum([part.shape[1] for part in _maps(support)])
    for n in NODES:
        nodes = ends.mean() + np.ptp(ends) / 2 * np.cos((np.arange(n) + 0.5) * np.pi / n)
        curve = _Curve(nodes, _rows(support, _unit(nodes, typical)).T)
        between = _unit((nodes[1:] + nodes[:-1]) / 2, typical)
        kinds = (np.split(rows, sizes) for rows in (curve.at(between), _rows(support, between)))
        if all(
            np.abs(a - b).max(initial=0.0) <= SMOOTH * np.abs(b).max(initial=0.0) for a, b in zip(*kinds, strict=True)
        ):
            return curve
    return None


def _unit(log_k: np.ndarray, like: WaveField) -> WaveField:
    """Waves of 1 m."""
    field = of_one_speed(np.exp(log_k), like.sea.heading, like.depth, like.gravity)
    return replace(field, sea=replace(field.sea, amplitude=np.ones(log_k.size, complex)))


def _maps(support: Support) -> tuple[np.ndarray, ...]:
    """From du/dt at the places (2 np, …) to modes, what is left out, and forces."""
    forces = np.zeros((len(support.waves), 0)) if support.forces is None else support.forces.waves
    return support.waves, support.left_out.waves, forces


def _rows(support: Support, field: WaveField) -> np.ndarray:
    """Of modes, of what is left out, of forces, of stations, (m, n)."""
    push = -1j * field.sea.omega * np.concatenate(field.swing(support.places))
    rows = real_by_complex(np.concatenate(_maps(support), axis=1).T, push)
    return np.concatenate([rows, support.flow(field).reshape(-1, field.k.size)])
