"""Waves' loads on a frame up to their surface: the water as it moves there, and how much of each station is wet.

Wheeler's stretching (1970) moves the water at a height z' below the surface η as linear theory does at

    z = (z' - η) / (1 + η/d),

so that what is at still water goes with the surface; extrapolated, z = z', linear theory goes on above still water.
Both are looked up between levels at which the waves are summed, by cubics. Stations stay where they are, from the
seabed to above any crest; each bears Morison's load on what of its length the water has reached. What the march has of
that as a linear sum of waves, their inertia to still water, is completed here.
"""

from functools import lru_cache
from typing import NamedTuple

import numpy as np

from solver.kernels import inner_kernel, whole_lean_kernel
from solver.sea.field import WaveField
from solver.structure.water import DRY, Splash, Stations

KNOWN = 8
SPACING = 0.35  # of levels over 1/k of the shortest wave: a cubic misses (3/128)(0.35)⁴ = 4e-4 of it
DEEPER = 0.25  # and over the depth: of waves that reach there no more
KINDS = 4  # of rows at a level: velocity along the heading and upward, acceleration
CUBIC = 4  # levels that it goes through
PIECE = 0.125  # of the mean wave's 1/k: stations of pieces that the surface passes now and then
LEVEL = 0.1  # rise over length of a member that the surface passes at once, across it, rather than along
SHALLOWEST = 0.1  # of the depth: lower no trough gets


class Stretched(NamedTuple):
    """ns stations of a frame that waves may reach, in nd directions; they stand at np places along the heading."""

    place: np.ndarray  # (np,) [m]
    of_place: np.ndarray  # (ns,) number of each station's
    height: np.ndarray  # (ns,) z [m]
    bounds: np.ndarray  # (ns, 2) heights of the surface at which each begins to be wet, and wholly is [m]
    along: np.ndarray  # (ns, nd) normal velocity for unit velocity along the heading
    up: np.ndarray  # (ns, nd) and for unit velocity upward
    drag: np.ndarray  # (ns,) ½ρ C_D D w, wet [kg/m]
    inertia: np.ndarray  # (ns,) C_M ρ πD²/4 w, wet [kg]
    stream: np.ndarray  # (nd, ns) velocity of the current [m/s]
    reach: float  # of the highest crest and the lowest trough [m]
    extrapolated: bool


class Levels(NamedTuple):
    """At which heights waves are summed, place after place."""

    first: np.ndarray  # (np + 1,) number of each place's first
    height: np.ndarray  # (nl,) upwards at each place [m]


def splash(field: WaveField) -> Splash:
    """In powers of two, which seas that are alike share: as high as the sum of all amplitudes, often as Hm0."""
    amplitude = np.abs(field.sea.amplitude)
    if not amplitude.any():
        return DRY
    sizes = np.array([2 * amplitude.sum(), 2 * np.sqrt(8) * np.linalg.norm(amplitude), PIECE * field.mean_length])
    return Splash(*(2.0 ** np.floor(np.log2(sizes))).tolist())


def wet_bounds(at: Stations) -> np.ndarray:
    """Heights (ns, 2) [m] between which the axis of what each station stands for lies; of a level member, its tube."""
    rise = np.sort(at.reach * at.tangent[:, 2:], axis=1)
    level = np.abs(at.tangent[:, 2]) < LEVEL
    return at.position[:, 2:] + np.where(level[:, None], at.diameter[:, None] * np.array([-0.5, 0.5]), rise)


@lru_cache(maxsize=KNOWN)
def levels(heights: tuple[tuple[float, float], ...], top: float, shortest: float, reached: float) -> Levels:
    """For places whose stations stand between two heights, under crests and above troughs of `reached` [m].

    top: highest level that counts; shortest: 1/k of that wave [m].
    """
    every = [top + SPACING * shortest]
    lowest = min((low for low, _ in heights), default=0.0) - reached
    while every[-1] > lowest or len(every) < CUBIC:
        every.append(every[-1] - max(SPACING * shortest, -DEEPER * every[-1]))
    grid = np.array(every[::-1])
    each = []
    for low, high in heights:
        a, b = np.searchsorted(grid, [low - reached, min(high + reached, top)])
        start = max(a - 2, 0)
        each.append(grid[start : max(b + 2, start + CUBIC)])
    return Levels(np.cumsum([0, *map(len, each)]), np.concatenate([np.zeros(0), *each]))


def levels_for(s: Stretched, field: WaveField) -> Levels:
    """In the waves of a sea."""
    ends = [s.height[s.of_place == i] for i in range(s.place.size)]
    heights = tuple((float(z.min()), float(z.max())) for z in ends)
    k = field.k[np.abs(field.sea.amplitude) > 0].max(initial=1e-9)
    return levels(heights, s.reach if s.extrapolated else 0.0, float(1 / k), s.reach)


def rows(s: Stretched, at: Levels, field: WaveField) -> np.ndarray:
    """What waves do at the levels, KINDS of each in turn, then their elevation at the places (KINDS nl + np, n)."""
    there = np.outer(np.repeat(s.place, np.diff(at.first)), field.direction)
    there[:, 2] = at.height
    swing = np.stack(field.swing(there))
    moved = np.concatenate([swing, -1j * field.sea.omega * swing]).transpose(1, 0, 2)
    return np.concatenate([moved.reshape(-1, field.k.size), field.elevation(np.outer(s.place, field.direction))])


@whole_lean_kernel
def stretch(
    s: Stretched, at: Levels, depth: float, water: np.ndarray, flow: np.ndarray, push: np.ndarray, wet: np.ndarray
) -> None:
    """From samples water (m, columns of `rows`) velocity flow (m, nd, ns) [m/s] normal to the members at the stations,
    the share wet (m, ns) of each, and push (m, nd, ns) [N]: what the waves' inertia is beyond that to still water.
    """
    ns, nd = s.along.shape
    surface = KINDS * at.height.size
    for i in range(len(water)):
        for j in range(ns):
            place, z = s.of_place[j], s.height[j]
            eta = max(water[i, surface + place], (SHALLOWEST - 1) * depth)
            low, high = s.bounds[j]
            share = 1.0 if eta >= high else 0.0 if eta <= low else (eta - low) / (high - low)
            middle = low + share * (z - low)  # of what is wet
            level = middle if s.extrapolated else min((middle - eta) / (1 + eta / depth), 0.0)
            first, last = at.first[place], at.first[place + 1]
            u, w, du, dw = _between(water[i], at.height, first, last, level)
            _, _, du0, dw0 = _between(water[i], at.height, first, last, z) if z < 0 else (0.0, 0.0, 0.0, 0.0)
            wet[i, j] = share
            for d in range(nd):
                along, up = s.along[j, d], s.up[j, d]
                flow[i, d, j] = along * u + up * w + s.stream[d, j]
                push[i, d, j] = s.inertia[j] * (along * (share * du - du0) + up * (share * dw - dw0))


@inner_kernel
def _between(
    water: np.ndarray, height: np.ndarray, first: int, last: int, z: float
) -> tuple[float, float, float, float]:
    """KINDS at a height, by the cubic through four of the levels first … last - 1 about it."""
    a, b = first + 1, last - 3  # where the cubic's second level may be
    while a < b:
        middle = (a + b + 1) // 2
        if height[middle] <= z:
            a = middle
        else:
            b = middle - 1
    u = w = du = dw = 0.0
    for i in range(a - 1, a + 3):
        weight = 1.0
        for k in range(a - 1, a + 3):
            if k != i:
                weight *= (z - height[k]) / (height[i] - height[k])
        u += weight * water[KINDS * i]
        w += weight * water[KINDS * i + 1]
        du += weight * water[KINDS * i + 2]
        dw += weight * water[KINDS * i + 3]
    return u, w, du, dw
