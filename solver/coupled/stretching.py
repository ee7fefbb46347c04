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

from solver.kernels import inner_kernel, whole_kernel
from solver.keys import Same
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
    inertia: np.ndarray  # (ns,) see surroundings.inertia_size, wet [kg]
    stream: np.ndarray  # (nd, ns) velocity of the current [m/s]
    reach: float  # of the highest crest and the lowest trough [m]
    extrapolated: bool


class Levels(NamedTuple):
    """At which heights waves are summed, place after place, and how the water at the stations at rest goes by them."""

    first: np.ndarray  # (np + 1,) number of each place's first
    height: np.ndarray  # (nl,) upwards at each place [m]
    inverse: np.ndarray  # (nl, CUBIC) of the cubic from each on: 1/Π(zᵢ - zₖ) [1/m³]
    below: np.ndarray  # (ns,) the first of the cubic's levels for each station
    weight: np.ndarray  # (ns, CUBIC) and their weights, 0 above still water


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
def _levels(same: Same[Stretched], field: WaveField) -> Levels:
    s, shortest = same.value, field.k[np.abs(field.sea.amplitude) > 0].max(initial=1e-9)
    top, spacing = s.reach if s.extrapolated else 0.0, SPACING / shortest
    grid, each = [top + spacing], []
    while grid[-1] > s.height.min(initial=0.0) - s.reach or len(grid) < CUBIC:
        grid.append(grid[-1] - max(spacing, -DEEPER * grid[-1]))
    every = np.array(grid[::-1])
    for i in range(s.place.size):
        mine = s.height[s.of_place == i]
        a, b = np.searchsorted(every, [mine.min() - s.reach, min(mine.max() + s.reach, top)])
        start = min(max(a - 2, 0), every.size - CUBIC)
        each.append(every[start : max(b + 2, start + CUBIC)])
    first, height = np.cumsum([0, *map(len, each)]), np.concatenate([np.zeros(0), *each])
    four = height[np.minimum(np.arange(height.size)[:, None] + np.arange(CUBIC), height.size - 1)]
    apart = four[:, :, None] - four[:, None, :] + np.eye(CUBIC)
    with np.errstate(divide="ignore"):  # of no cubic, at the end
        inverse = 1 / apart.prod(axis=2)
    below, weight = np.zeros(s.height.size, int), np.zeros((s.height.size, CUBIC))
    at = Levels(first, height, inverse, below, weight)
    at_rest(s, at)
    return at


def rows(s: Stretched, field: WaveField) -> np.ndarray:
    """What waves do at the levels, KINDS of each in turn, then their elevation at the places (KINDS nl + np, n)."""
    at = _levels(Same(s), field)
    there = np.outer(np.repeat(s.place, np.diff(at.first)), field.direction)
    there[:, 2] = at.height
    swing = np.stack(field.swing(there))
    moved = np.concatenate([swing, -1j * field.sea.omega * swing]).transpose(1, 0, 2)
    return np.concatenate([moved.reshape(-1, field.k.size), field.elevation(np.outer(s.place, field.direction))])


def stretched(
    s: Stretched, field: WaveField, depth: float, water: np.ndarray, first: int
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Of samples water (m, …), from the first column on those of `rows`: velocity (m, nd, ns) [m/s] normal to the
    members at the stations, the share wet (m, ns) of each, and push (m, nd, ns) [N], what the waves' inertia is beyond
    that to still water.
    """
    shape = len(water), *s.stream.shape
    flow, wet, push = np.empty(shape), np.empty((len(water), s.height.size)), np.empty(shape)
    stretch(s, _levels(Same(s), field), depth, water, first, flow, wet, push)
    return flow, wet, push


@whole_kernel
def stretch(
    s: Stretched,
    at: Levels,
    depth: float,
    water: np.ndarray,
    first: int,
    flow: np.ndarray,
    wet: np.ndarray,
    push: np.ndarray,
) -> None:
    """Fill `stretched`'s answers."""
    ns, nd = s.along.shape
    surface, weight = first + KINDS * at.height.size, np.empty(CUBIC)
    for i in range(len(water)):
        for j in range(ns):
            place, z = s.of_place[j], s.height[j]
            eta = max(water[i, surface + place], (SHALLOWEST - 1) * depth)
            low, high = s.bounds[j]
            share = 1.0 if eta >= high else 0.0 if eta <= low else (eta - low) / (high - low)
            wet[i, j] = share
            if share == 0 and z >= 0:
                flow[i, :, j] = push[i, :, j] = 0.0
                continue
            middle = low + share * (z - low)  # of what is wet
            level = middle if s.extrapolated else min((middle - eta) / (1 + eta / depth), 0.0)
            below = cubic(at, place, level, weight)
            u = w = du = dw = 0.0
            for n in range(CUBIC):
                now, before = first + KINDS * (below + n), first + KINDS * (at.below[j] + n)
                u += weight[n] * water[i, now]
                w += weight[n] * water[i, now + 1]
                du += share * weight[n] * water[i, now + 2] - at.weight[j, n] * water[i, before + 2]
                dw += share * weight[n] * water[i, now + 3] - at.weight[j, n] * water[i, before + 3]
            for d in range(nd):
                along, up = s.along[j, d], s.up[j, d]
                flow[i, d, j] = along * u + up * w + s.stream[d, j]
                push[i, d, j] = s.inertia[j] * (along * du + up * dw)


@whole_kernel
def at_rest(s: Stretched, at: Levels) -> None:
    """Fill in what of the levels is at the stations themselves."""
    for j in range(s.height.size):
        at.below[j] = cubic(at, s.of_place[j], s.height[j], at.weight[j])
        if s.height[j] >= 0:
            at.weight[j] = 0.0


@inner_kernel
def cubic(at: Levels, place: int, z: float, weight: np.ndarray) -> int:
    """The first of the CUBIC levels of a place about a height, and the weights (CUBIC,) of them there."""
    a, b = at.first[place], at.first[place + 1] - CUBIC
    while a < b:
        middle = (a + b + 1) // 2
        if at.height[middle + 1] <= z:
            a = middle
        else:
            b = middle - 1
    for i in range(CUBIC):
        weight[i] = at.inverse[a, i]
        for k in range(CUBIC):
            if k != i:
                weight[i] *= z - at.height[a + k]
    return a
