"""Linear wave loads on floats that slide: with the phases that the waves have where the float has drifted to.

At a distance s along the waves from where the coefficients are given a body feels the same waves later,

    F(t, s) = Re Σⱼ Fⱼ exp(ikⱼs - iωⱼt),   exp(ikru) = J₀(kr) + 2 Σₙ iⁿ Jₙ(kr) Tₙ(u),   u = s/r from -1 to 1

(Jacobi and Anger), so that a few of Chebyshev's polynomials of its place tell the load wherever it drifts within r.
Body-nonlinear pressure is that of the place anyway; at rest, diffraction's phases would be another sea's.

A linear force is that on a body about its mean place. What the waves themselves swing it by, Re Σ Xⱼ exp(ikⱼs - iωⱼt)
by the linear model, is no part of s: it would add to the force, of second order, some terms without those beside them.
"""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from scipy.special import jv

from solver import limits
from solver.scene import Scene
from solver.sea.field import WaveField

FAR = 0.5  # [rad]: an arm that takes a float a radian of the mean wave within this turn is a long one


class Places(NamedTuple):
    """Of each float whose place counts for its loads, how far that may be along the waves [m], by how many terms.

    None and 0 where loads are those at rest.
    """

    leader: tuple[int, ...]
    reach: tuple[float, ...]
    terms: tuple[int, ...]


def reaches(
    scene: Scene, leader: tuple[int, ...], near: WaveField, terms: Sequence[int], reach: float, rest: limits.Rest
) -> tuple[float, ...]:
    """(nb,) [m] of the floats that have a leader, from where they are given.

    near: of the waves whose pressure is integrated; terms: of its series about each float's rest, which ends the way;
    reach: where none is.
    """
    if max(leader, default=-1) < 0 or not scene.sea.amplitude.any():
        return (0.0,) * len(scene.floats)
    ways = limits.ways(scene, near, terms) if near.sea.amplitude.any() else [reach] * len(leader)
    off = [abs(float((x - f.centre) @ near.direction)) for x, f in zip(rest.places, scene.floats, strict=True)]
    return tuple(way + off[a] if a >= 0 else 0.0 for a, way in zip(leader, ways, strict=True))


def leaders(scene: Scene, waves: WaveField) -> tuple[int, ...]:
    """Of each float the one whose place counts, itself or what carries it; -1: none, of linear pressure for one.

    That is the last one from the support on that slides along the waves, or that an axis, of its own or of what carries
    it, turns on an arm long enough to do so, see FAR.
    """
    found: list[int] = []
    if not any(scene.nonlinear):
        return (-1,) * len(scene.floats)
    for b, (f, carrier) in enumerate(zip(scene.floats, scene.carriers, strict=True)):
        slides = np.any(limits.ahead(f, waves.direction) > limits.ROUNDING)
        moved = slides or FAR * _lever(scene, b, waves) > waves.mean_length
        found.append(b if moved else found[carrier] if carrier >= 0 else -1)
    return tuple(found)


def _lever(scene: Scene, b: int, waves: WaveField) -> float:
    """How far 1 rad of an axis, its own or a carrier's, takes a float along the waves [m], at most."""
    centre, turning = scene.floats[b].centre, (scene.floats[owner] for owner in scene.bearers(b))
    arms = [
        np.cross(f.direction(axis), centre - f.hinge) for f in turning for axis in f.motion if not limits.slides(axis)
    ]
    return max((abs(float(arm @ waves.direction)) for arm in arms), default=0.0)


def places(
    force: np.ndarray, k: np.ndarray, leader: tuple[int, ...], reach: Sequence[float], tolerance: float
) -> Places:
    """Of loads (nb, nr, n) per wave: what is left out within reach (nb,) is below tolerance·Σ|Fⱼ| of each."""
    terms = [0] * len(reach)
    for b, (r, size) in enumerate(zip(reach, np.abs(force), strict=True)):
        if r > 0 and size.any():
            n = np.arange(int(1.2 * r * k.max()) + 40)  # beyond which Jₙ is nothing
            left = np.cumsum(2 * np.abs(jv(n[:, None], k * r))[::-1], axis=0)[::-1]
            terms[b] = int(np.argmax(np.all(left @ size.T <= tolerance * size.sum(axis=1), axis=1)))
    return Places(leader, tuple(r if n else 0.0 for r, n in zip(reach, terms, strict=True)), tuple(terms))


def rows(lines: np.ndarray, k: np.ndarray, to: Places) -> np.ndarray:
    """(Σ terms, m, n), float by float and term by term, of what waves drive where each is given (nb, m, n)."""
    parts = [np.zeros((0, *lines.shape[1:]), complex)]
    for line, reach, count in zip(lines, to.reach, to.terms, strict=True):
        n = np.arange(count)[:, None]
        wave = np.where(n > 0, 2, 1) * 1j**n * jv(n, k * reach)
        parts.append(wave[:, None] * line)
    return np.concatenate(parts)
