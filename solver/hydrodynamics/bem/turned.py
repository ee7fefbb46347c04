"""Pairs of panels that are alike: one is turned about the vertical axis, or mirrored, onto the other.

Turns by 2π/N bring rings of N panels onto themselves, and rings of N and of M by 2π/g, g their greatest common divisor.
The influence of panel j on panel i is that of hj on hi for each such turn h, followed by a mirror or not: of all j that
these bring onto each other one is asked for. A hull of revolution has rings of many panels; those round its pole, and
cells of a ring's lid, come four at a time. Which panels are turned onto which is seen on the mesh, whatever the hulls.
"""

from collections.abc import Callable, Iterator
from functools import cache, partial
from math import gcd
from typing import NamedTuple

import numpy as np
import scipy  # spatial is slow to import, and a run with known coefficients needs none

from solver.hydrodynamics.bem.green import Panels

Turned = Callable[[int], np.ndarray]  # onto which panel each is turned by 2π over a number
SAME = 1e-9  # of the extent: corners as close to each other's images are these


class Alike(NamedTuple):
    """Influences of panels of one order on those of another, and by which of them all are known."""

    at: np.ndarray  # (na,) the panels of the whole that are influenced; of the same order, first the sources
    sources: Panels  # mesh of ns panels of the part
    own: bool  # whether these are among those influenced
    of: list[np.ndarray]  # of each h: those panels of the part that it brings onto a source,
    source: list[np.ndarray]  # this source,
    seen: list[np.ndarray]  # (na,) and onto which of `at` it brings each of them

    def spread(self, influence: np.ndarray, out: np.ndarray) -> None:
        """Of the sources (ns, na), to all pairs in those of the part on the whole (nf, n)."""
        for of, source, seen in zip(self.of, self.source, self.seen, strict=True):
            out[np.ix_(of, self.at)] = influence[source].take(seen, axis=1)


def alike(whole: Panels, part: Panels, mirrors: int) -> list[Alike]:
    """All influences of the part on the whole, which it begins and so many mirror images complete, about x = y = 0."""
    n, nf = whole.nb_faces, part.nb_faces
    # The second image is that in y = 0; a half's, and a quarter's, are swapped by it.
    mirror = np.arange(n).reshape(-1, min(mirrors, 2), nf)[:, ::-1].ravel()
    turned = cache(partial(_turned, whole))
    orders = _orders(whole, turned) if mirrors == 4 else np.ones(n, int)
    return list(_pairs(whole, part, orders, mirror, turned))


def _pairs(whole: Panels, part: Panels, orders: np.ndarray, mirror: np.ndarray, turned: Turned) -> Iterator[Alike]:
    place = np.empty(len(orders), int)
    of_part, near = orders[: part.nb_faces], SAME * np.abs(whole.vertices).max()
    for order_at in np.unique(orders).tolist():
        at = np.flatnonzero(orders == order_at)
        for order_of in np.unique(of_part).tolist():
            of = np.flatnonzero(of_part == order_of)
            shared = gcd(order_at, order_of)
            steps = {order: _repeated(turned(order), order // shared) for order in (order_at, order_of)}
            images = _images(np.where(orders == order_at, steps[order_at], steps[order_of]), shared, mirror)
            # From how far on a source counts as a point its panel's first corner tells, which may be another one.
            same = np.abs(whole.faces_radiuses[images[:, of]] - whole.faces_radiuses[of]) < near
            onto = np.where(same, images[:, of], len(orders))
            first, element = onto.min(axis=0), onto.argmin(axis=0)
            sources, source = np.unique(first, return_inverse=True)
            own = np.isin(at, sources)
            at = np.concatenate([at[own], at[~own]])
            place[at] = np.arange(len(at))
            some = [element == h for h in np.unique(element)]
            yield Alike(
                at=at,
                sources=part.of(sources),
                own=bool(own.any()),
                of=[of[mine] for mine in some],
                source=[source[mine] for mine in some],
                seen=[place[images[h, at]] for h in np.unique(element)],
            )


def _repeated(onto: np.ndarray, times: int) -> np.ndarray:
    """Where each panel (n,) comes by so many turns; -1, which stays some panel, only where no one asks."""
    place = np.arange(len(onto))
    for _ in range(times):
        place = onto[place]
    return place


def _images(turned: np.ndarray, order: int, mirror: np.ndarray) -> np.ndarray:
    """Where each panel (n,) comes by turns 0 to order - 1, and by the same after the mirror (2 order, n)."""
    turns = [np.arange(len(turned))]
    while len(turns) < order:
        turns.append(turned[turns[-1]])
    return np.concatenate([turns, np.stack(turns)[:, mirror]])


def _orders(whole: Panels, turned: Turned) -> np.ndarray:
    """The largest N (n,) of each panel by whose turns it comes onto N panels; 2 where two mirrors make that."""
    middle, extent = whole.faces_centers, np.abs(whole.vertices).max()
    rings = np.round(np.column_stack([np.hypot(*middle[:, :2].T), middle[:, 2]]) / (1e3 * SAME * extent))
    counts = np.unique(np.unique(rings, axis=0, return_counts=True)[1])
    orders = np.full(len(middle), 2)
    for order in sorted({int(c) // k for c in counts for k in (1, 2) if c % (4 * k) == 0}):
        onto = turned(order)
        round_all = onto >= 0
        for _ in range(order):
            round_all &= round_all[onto]
        orders[round_all] = order
    return orders


def _turned(whole: Panels, order: int) -> np.ndarray:
    """Which panel each one (n,) is turned onto by 2π/order about the axis, -1: none."""
    c, s = np.cos(2 * np.pi / order), np.sin(2 * np.pi / order)
    turn = np.array([[c, s, 0.0], [-s, c, 0.0], [0.0, 0.0, 1.0]])
    extent, corners = np.abs(whole.vertices).max(), whole.vertices[whole.faces]
    middles, normals = whole.faces_centers, whole.faces_normals * extent
    tree = scipy.spatial.cKDTree(np.concatenate([middles, normals], axis=1))
    away, found = tree.query(np.concatenate([middles @ turn, normals @ turn], axis=1))
    gaps = np.linalg.norm((corners @ turn)[:, :, None] - corners[found][:, None], axis=-1).min(axis=2).max(axis=1)
    return np.where(np.maximum(away, gaps) < SAME * extent, found, -1)
