"""What the seabed adds to the influence of panels on each other, where bodies are small beside their height above it.

Above a seabed at depth h the Green function of a source at z' is that of deep water, of the same K = ω²/g, and, R away,

    ∫ J₀(μR) f(z) f(z') e^(-2μh) / (1 - q e^(-2μh)) dμ,  f(z) = q e^(μz) + e^(-μz),  q = (μ + K)/(μ - K),

from 0 to ∞ beneath the poles at K and k, K = k tanh kh (from Wehausen and Laitone 1960, eq. 13.18, less 13.17). All
its images lie 2(h - draft) away or more: it is smooth, found at a few nodes about each body, and interpolated between.
"""

from dataclasses import dataclass
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np
from numpy.polynomial import chebyshev
from scipy.special import jv

from solver.lines import real_by_complex

MISSED = 1e-5  # of what the seabed adds, by too few nodes, but for a factor of up to 5
FEWEST, MOST = 3, 30  # nodes along an axis; more do not pay
WORTH = 800  # products of matrices that take as long as one influence of a panel on another above a seabed
FLAT = 0.05  # of a box's largest width, its least
BENEATH = 4.0  # by which J₀ may grow beneath the poles, as e to that power
TAIL = 30.0  # where the integrand has fallen by e to that power
GAUSS = np.polynomial.legendre.leggauss(12)


def nodes_along(half: np.ndarray, clear: float, k: float) -> np.ndarray:
    """Nodes (3,) of a box of half widths b (3,) [m], its images `clear` [m] below it, waves k [1/m]; MOST: too few.

    n of them miss ρ⁻ⁿ of a function that is analytic within the ellipse of foci ±b and semiaxes b(ρ ± 1/ρ)/2 (Trefethen
    2013, Approximation Theory and Approximation Practice, chapter 8): images lie off a level axis, sinh(log ρ) =
    clear/b, and on the upright one, cosh(log ρ) = 1 + clear/b. Of a wave, which reaches the images by exp(-k clear),
    they miss its n-th term, (ekb/2n)ⁿ at most.
    """
    clear = max(clear, 0.0)  # a hull that stands on the seabed may reach below it by rounding
    images = np.append(np.arcsinh(clear / half[:2]), np.arccosh(1 + clear / half[2]))
    n = np.arange(FEWEST, MOST)[:, None]
    waves = n * np.log(2 * n / (np.e * k * half)) + k * clear if np.isfinite(k) else np.inf
    return FEWEST + np.sum(np.minimum(n * images, waves) < -np.log(MISSED), axis=0)


class Work(NamedTuple):
    """Of bodies on each other (nb, nb), by nodes: products of P K Q, P (n, m) and Q (m', np) being real; K, complex."""

    first: np.ndarray  # of P K first
    last: np.ndarray  # of K Q first
    asked: np.ndarray  # pairs of panels
    far: np.ndarray  # bool, whether their images are: not those of two bodies that stand on the seabed

    @classmethod
    def of(cls, nodes: np.ndarray, seen: np.ndarray, sent: np.ndarray, standing: np.ndarray) -> "Work":
        """Nodes (nb,) of bodies, panels (nb,) of theirs at which, and of which, influences are, and which stand."""
        at, panels = nodes[:, None], seen[:, None]
        far = ~np.logical_and.outer(standing, standing)
        return cls(panels * nodes * (at + 2 * sent), 2 * sent * at * (nodes + panels), panels * sent, far)

    @property
    def pays(self) -> bool:
        """Whether nodes take less time than the panels, each on all others."""
        return bool(np.sum((np.minimum(self.first, self.last) - WORTH * self.asked)[self.far]) < 0)


def deep_wavenumber(k: float, depth: float) -> float:
    """K = k tanh kh [1/m] of a wave k [1/m], that of one as fast in deep water."""
    return float(k * np.tanh(k * depth)) if np.isfinite(k) else k


class Path(NamedTuple):
    """Points of the integral's path."""

    mu: np.ndarray  # (nq,) [1/m]
    weight: np.ndarray  # (nq,) e^(-2μh) / (1 - q e^(-2μh)) dμ, but for the growth of f
    q: np.ndarray  # (nq,)
    depth: float  # h [m]

    @classmethod
    def beneath(cls, k: float, depth: float, clear: float, reach: float) -> "Path":
        """Poles at K and k; clear [m]: least 2h + z + z'; reach [m]: most R."""
        deep = deep_wavenumber(k, depth)
        step = min(BENEATH / max(reach, clear), deep / 2)
        ends, end = [0.0], TAIL / clear
        while ends[-1] < end:  # as wide as the path is far from poles, where J₀ and the images allow that
            away = ends[-1] - k if np.isfinite(k) else 0.0
            ends.append(ends[-1] + max(2 * step, min(away, 2 * BENEATH / max(reach, clear))))
        corner = step * (1 - 1j) if np.isfinite(k) else 0.0
        corners = np.concatenate([[0.0], corner + np.array(ends)]) if corner else np.array(ends)
        half = np.diff(corners)[:, None] / 2
        mu = (corners[:-1, None] + half * (1 + GAUSS[0])).ravel()
        q = (mu + deep) / (mu - deep) if np.isfinite(k) else np.full(mu.shape, -1.0)
        return cls(mu, (half * GAUSS[1]).ravel() / (1 - q * np.exp(-2 * mu * depth)), q, depth)

    def f(self, z: np.ndarray) -> np.ndarray:
        """e^(-μh) f(z) (nz, nq)."""
        return self.q * np.exp(np.multiply.outer(z - self.depth, self.mu)) + np.exp(
            -np.multiply.outer(z + self.depth, self.mu)
        )


@dataclass(frozen=True)
class Box:
    """About the middles of a body's panels, or other points of it."""

    middle: np.ndarray  # (3,) [m]
    half: np.ndarray  # (3,) half its widths [m]
    counts: np.ndarray  # (3,) of nodes

    @classmethod
    def about(cls, points: np.ndarray, clear: float, k: float) -> "Box":
        """points (np, 3) [m] of one body; clear, k: see nodes_along."""
        low, high = points.min(axis=0), points.max(axis=0)
        half = np.maximum(high - low, FLAT * np.max(high - low)) / 2
        return cls((low + high) / 2, half, nodes_along(half, clear, k))

    @property
    def count(self) -> int:
        """Of all nodes."""
        return int(np.prod(self.counts))

    @cached_property
    def axes(self) -> list[np.ndarray]:
        """Nodes along each axis [m]."""
        return [m + h * chebyshev.chebpts1(n) for m, h, n in zip(self.middle, self.half, self.counts, strict=True)]

    @cached_property
    def level(self) -> np.ndarray:
        """x, y of the nodes (number along x times that along y, 2) [m]."""
        return np.stack(np.meshgrid(*self.axes[:2], indexing="ij"), axis=-1).reshape(-1, 2)

    def polynomials(self, points: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Those that are 1 at one node and 0 at others, at points (np, 3): values (np, n), gradients (np, n, 3)."""
        value, slope = zip(*map(_along, ((points - self.middle) / self.half).T, self.counts), strict=True)

        def product(*factors: np.ndarray) -> np.ndarray:
            return np.einsum("pi,pj,pk->pijk", *factors).reshape(len(points), self.count)

        gradient = [product(*(slope[j] if i == j else value[j] for j in range(3))) for i in range(3)]
        return product(*value), np.stack(gradient, axis=-1) / self.half


def _along(x: np.ndarray, count: int) -> tuple[np.ndarray, np.ndarray]:
    """Lagrange's polynomials (nx, count) of Chebyshev's points of -1 to 1, and their slopes."""
    terms = np.linalg.inv(chebyshev.chebvander(chebyshev.chebpts1(count), count - 1))
    slopes = chebyshev.chebvander(x, count - 2) @ chebyshev.chebder(terms)
    return chebyshev.chebvander(x, count - 1) @ terms, slopes


def between(path: Path, at: Box, of: Box) -> np.ndarray:
    """The integral [1/m] from the nodes of one box to those of another, (n, m)."""
    apart, index = np.unique(np.linalg.norm(at.level[:, None] - of.level, axis=-1).round(9), return_inverse=True)
    (here, there) = (path.f(box.axes[2]) for box in (at, of))
    upright = (here[:, None] * there).reshape(-1, len(path.mu)) * path.weight
    found = jv(0, np.multiply.outer(apart, path.mu)) @ upright.T
    found = found[index.reshape(-1)].reshape(len(at.level), len(of.level), len(here), len(there))
    return np.asarray(found.transpose(0, 2, 1, 3).reshape(len(at.level) * len(here), -1))


def clearance(depth: float, draft: float, *, standing: bool) -> float:
    """How far images lie off [m]: of bodies of this draft at most on each other, and on others that stand there."""
    return (depth - draft) * (1 if standing else 2)


def added(
    whole: Any, bodies: np.ndarray, standing: np.ndarray, part: Any, depth: float, k: float
) -> tuple[np.ndarray, np.ndarray] | None:
    """S and D (np, nf) by which panels of `part` influence more the np panels of `whole`; None where it does not pay.

    Both capytaine meshes, the part first in the whole; bodies (np,) whose panels they are; waves k [1/m] in `depth`.
    Bodies standing (np,) on the seabed touch their images there: none of theirs on each other. Signs and 4π as
    capytaine's.
    """
    if standing.all():
        return None
    draft, nf = -whole.vertices[whole.faces[~standing], 2].min(), part.nb_faces
    clear = clearance(depth, draft, standing=bool(standing.any()))
    own = [np.flatnonzero(bodies == b) for b in np.unique(bodies)]
    sources = [mine[mine < nf] for mine in own]
    boxes = [Box.about(whole.faces_centers[mine], clear, k) for mine in own]
    nodes, seen, sent = (np.array(n) for n in ([box.count for box in boxes], *([*map(len, x)] for x in (own, sources))))
    work = Work.of(nodes, seen, sent, np.array([standing[mine[0]] for mine in own]))
    if not work.pays:
        return None
    reach = float(np.linalg.norm(np.ptp(whole.faces_centers[:, :2], axis=0)))
    path = Path.beneath(k, depth, clear, reach)
    here = [box.polynomials(whole.faces_centers[mine])[0] for box, mine in zip(boxes, own, strict=True)]
    there = [_sent(box, part, mine) for box, mine in zip(boxes, sources, strict=True)]
    single, double = influences = np.zeros((2, len(bodies), nf), path.mu.dtype)
    for a, b in zip(*np.nonzero(np.triu(work.far)), strict=True):
        kernel = between(path, boxes[a], boxes[b]) / (-4 * np.pi)
        for at, of, each in ((a, b, kernel), (b, a, kernel.T))[: 1 + (a != b)]:
            place, early = np.ix_(own[at], sources[of]), work.first[at, of] <= work.last[at, of]
            some = here[at] @ each if early else each
            for influence, polynomials in zip(influences, there[of], strict=True):
                found = _by_real(some, polynomials)
                influence[place] = found if early else _by_real(found.T, here[at].T).T
    return single, double


def _by_real(one: np.ndarray, other: np.ndarray) -> np.ndarray:
    """Their product, of which the second is real; waves of no length have a first one that is, too."""
    return real_by_complex(other.T, one.T).T if np.iscomplexobj(one) else np.asarray(one @ other)


def _sent(box: Box, part: Any, own: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Polynomials and their slopes along normals (n, number of panels), times the panels' areas."""
    values, gradients = box.polynomials(part.faces_centers[own])
    slopes = np.einsum("pni,pi->pn", gradients, part.faces_normals[own])
    return values.T * part.faces_areas[own], slopes.T * part.faces_areas[own]
