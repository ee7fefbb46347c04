"""Quadratic drag as the linear one that differs least from it in mean square: |u|u ≈ K u.

Over all instants of u, K = ⟨|u|u uᵀ⟩⟨u uᵀ⟩⁻¹. For a Gaussian u that is ⟨∂(|u|u)/∂u⟩ = ⟨|u| I + u uᵀ/|u|⟩, in one
direction √(8/π) σ (Borgman 1969); for one harmonic of amplitude U it is 8U/3π (Lorentz).

In a current u = U + u', |u|u ≈ F + K u' with the mean F = ⟨|u|u⟩ and K = ⟨∂(|u|u)/∂u⟩. In one direction, of a Gaussian,

    F = (U² + σ²) erf(U/√2σ) + √(2/π) σU exp(-U²/2σ²),   K = 2⟨|u|⟩ = 2U erf(U/√2σ) + √(8/π) σ exp(-U²/2σ²).

In a plane |u|³ = ⅜∮|u·e|³ dφ over all directions e(φ), whose gradient and curvature are 3|u|u and 3 ∂(|u|u)/∂u:

    F = ⅜∮⟨|s|s⟩ e dφ,   K = ¾∮⟨|s|⟩ e eᵀ dφ,   s = u·e with mean U·e and variance eᵀSe.

What that leaves out is of higher orders, by Hermite's polynomials Hₙ of x = s - U·e, and no part of it goes with u, at
any time apart. With σ the std of s, φ the density of a normal number and r = U·e/σ (Borgman 1967; Price's theorem),

    |s|s = F + K x + Σ aₙ Hₙ(x),   n! a₂ = 2 erf(r/√2),   n! aₙ = 4 φ⁽ⁿ⁻³⁾(r)/σⁿ⁻²,

and of two such numbers x, x' with covariance R the n-th terms have the covariance n! aₙaₙ' Rⁿ. In still water the third
order has 0.94 of all that is not linear, the fifth 0.05.
"""

from typing import NamedTuple

import numpy as np
from scipy.special import ellipe, ellipkm1, erf

from solver.kernels import whole_kernel

PHASES = 64  # of a harmonic: its mean of |u|³ is then exact to 1e-5
TURNS = 2 * np.pi * np.arange(PHASES) / PHASES
NARROW = 1e-6  # of an ellipse's length: what goes with a narrower side goes as its limit, to as much squared
ROUND = 1e-6  # of two variances that count as the same
AGREED = 1e-8  # of two numbers: their arithmetic-geometric mean is theirs, to rounding
STEADY = 1e-9  # times its mean: the std of a number that does not vary
FEW = 4  # directions of half a circle that terms of higher orders need
FACTORIALS = np.array([2.0, 6.0, 24.0, 120.0])  # of the orders from 2 on that count
DIRECTIONS = 360  # of half a circle: what their bend across a current without waves leaves is 2e-5 of the speed


def of_gaussian(S: np.ndarray) -> np.ndarray:
    """K (…, d, d) [m/s] of Gaussian velocities with covariance S (…, d, d) [m²/s²] that lie in a plane.

    With variances a ≥ b in that plane, m = 1 - b/a, and complete elliptic integrals E(m), K(m): mean speed
    √(2a/π) E, and ⟨u₁²/|u|⟩ = √(2a/π) (E - (b/a) K)/m; the other direction has the rest of the mean speed.
    """
    if S.shape[-1] == 2:
        K = np.empty(S.shape)
        _in_plane(np.ascontiguousarray(S).reshape(-1, 2, 2), K.reshape(-1, 2, 2))
        return K
    a, b, plane, axes = _principal(S)
    ratio = np.divide(b, a, out=np.ones(a.shape), where=a > 0)
    m, scale = 1 - ratio, np.sqrt(2 * a / np.pi)
    mean = ellipe(m)
    less = ratio * ellipkm1(np.maximum(1 - m, np.finfo(float).tiny))
    along = np.divide(mean - less, m, out=np.array(mean / 2), where=m > ROUND)
    uneven = scale * (along - mean / 2)
    return (scale * mean)[..., None, None] * (np.eye(S.shape[-1]) + plane / 2) + uneven[..., None, None] * axes


@whole_kernel
def _in_plane(S: np.ndarray, K: np.ndarray) -> None:
    """K (n, 2, 2) of covariances S (n, 2, 2), as above, where a frame has many and asks again every round.

    By the arithmetic-geometric mean M of 1 and (b/a)^½: K(m) = π/2M, E = (1 - qm) K, (E - (b/a) K)/m = (1 - q) K with
    q = ½ + Σ 2ⁿ⁻¹ cₙ²/m over its differences cₙ, n ≥ 1.
    """
    for i in range(len(S)):
        half, middle, across = (S[i, 0, 0] - S[i, 1, 1]) / 2, (S[i, 0, 0] + S[i, 1, 1]) / 2, S[i, 0, 1]
        size = np.hypot(half, across)
        a, b = middle + size, max(middle - size, 0.0)
        x, y, q, share = 1.0, np.sqrt(b / a) if b > 0 else 0.0, 0.5, 1.0
        m = 1 - y * y
        while y > 0 and x - y > AGREED:
            q += share * ((x - y) / 2) ** 2 / m
            x, y, share = (x + y) / 2, np.sqrt(x * y), 2 * share
        integral = np.pi / (x + y)
        mean = integral * (1 - q * m) if y > 0 else 1.0
        along = integral * (1 - q) if y > 0 else 1.0
        scale = np.sqrt(2 * max(a, 0.0) / np.pi)
        uneven = scale * (along - 0.5 * mean) / size if size > 0 else 0.0
        K[i, 0, 0] = 1.5 * scale * mean + uneven * half
        K[i, 1, 1] = 1.5 * scale * mean - uneven * half
        K[i, 0, 1] = K[i, 1, 0] = uneven * across


def _principal(S: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """The two largest variances (…), of one direction the other is 0; sum and difference of the projections (…, d, d)
    on their axes.
    """
    d = S.shape[-1]
    value, axis = np.linalg.eigh(S)
    first, second = (axis[..., i, None] * axis[..., None, :, i] for i in (-1, -min(d, 2)))
    if d == 1:
        return value[..., -1].clip(min=0.0), np.zeros(value.shape[:-1]), first, first
    return value[..., -1].clip(min=0.0), value[..., -2].clip(min=0.0), first + second, first - second


def in_stream(U: np.ndarray, S: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """F (…, d) [m²/s²] and K (…, d, d) [m/s] of Gaussian velocities in a plane, mean U (…, d), covariance S (…, d, d).

    The plane is where U and S are largest; a direction that has neither has the mean speed as its K.
    """
    if U.shape[-1] == 1:
        force, speed = _along(U, np.sqrt(S[..., 0].clip(min=0.0)))
        return force, 2 * speed[..., None]
    plane = np.linalg.eigh(S + U[..., :, None] * U[..., None, :])[1][..., -2:]
    angle = (np.arange(DIRECTIONS) + 0.5) * np.pi / DIRECTIONS
    e = plane @ np.array([np.cos(angle), np.sin(angle)])  # (…, d, nφ)
    variance = np.einsum("...ip,...ij,...jp->...p", e, S, e)
    force, speed = _along(np.einsum("...i,...ip->...p", U, e), np.sqrt(variance.clip(min=0.0)))
    step = np.pi / DIRECTIONS  # the other half of the circle is alike
    F = 0.75 * step * np.einsum("...p,...ip->...i", force, e)
    K = 1.5 * step * np.einsum("...p,...ip,...jp->...ij", speed, e, e)
    across = np.eye(U.shape[-1]) - plane @ np.swapaxes(plane, -1, -2)
    return F, K + 0.5 * step * speed.sum(axis=-1)[..., None, None] * across


class Beyond(NamedTuple):
    """Terms of |u|u beyond the linear ones, Σ e aₙ Hₙ(x), x = (u - U)·e, over m directions."""

    e: np.ndarray  # (…, m, d)
    terms: np.ndarray  # √n! aₙ (…, m, 4), from n = 2 on


def beyond(U: np.ndarray, S: np.ndarray) -> Beyond:
    """Of Gaussian velocities in a plane, as in `in_stream`."""
    if U.shape[-1] == 1:
        return Beyond(np.ones((*U.shape, 1)), _terms(U, np.sqrt(S[..., 0])))
    size, axes = np.linalg.eigh(S + U[..., :, None] * U[..., None, :])
    if np.all(size[..., -2] <= ROUND * size[..., -1]):  # all along lines
        e, weight = np.swapaxes(axes[..., -1:], -1, -2), 1.0
    else:
        angle, weight = (np.arange(FEW) + 0.5) * np.pi / FEW, 0.75 * np.pi / FEW
        e = np.stack([np.cos(angle), np.sin(angle)], axis=-1) @ np.swapaxes(axes[..., -2:], -1, -2)
    std = np.sqrt(np.sum((e @ S) * e, axis=-1).clip(min=0.0))
    return Beyond(e, weight * _terms(np.sum(e * U[..., None, :], axis=-1), std))


def _terms(mean: np.ndarray, std: np.ndarray) -> np.ndarray:
    """√n! aₙ (…, 4) of |s|s; none where nothing varies."""
    inverse = np.divide(1.0, std, out=np.zeros(std.shape), where=std > STEADY * np.abs(mean))
    r = mean * inverse
    bell = 4 * np.exp(-0.5 * r**2) / np.sqrt(2 * np.pi) * inverse
    higher = np.stack([bell, -bell * r * inverse, bell * (r**2 - 1) * inverse**2], axis=-1)
    return np.concatenate([2 * erf(r / np.sqrt(2))[..., None], higher], axis=-1) / np.sqrt(FACTORIALS)


def _along(mean: np.ndarray, std: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """⟨|s|s⟩ and ⟨|s|⟩ of Gaussian numbers."""
    ratio = np.divide(mean, std, out=np.copysign(np.inf, mean), where=std > STEADY * np.abs(mean)) / np.sqrt(2)
    bell, sign = np.sqrt(2 / np.pi) * std * np.exp(-(ratio**2)), erf(ratio)
    return (mean**2 + std**2) * sign + mean * bell, mean * sign + bell


def harmonic_in_stream(mean: np.ndarray, U: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """F (…, d) and K (…, d, d), which differs least in mean square, of velocities mean + Re{U exp(-iωt)}, (…, d).

    Along an axis of the ellipse K is 2⟨|w|w cos⟩/a or 2⟨|w|w sin⟩/b; along others, and a side too narrow for that, its
    limit, 2⟨∂|w|w/∂w sin²⟩: see of_harmonic. None where nothing varies.
    """
    p, q, a, b = _ellipse(U)
    cos, sin = np.cos(TURNS), np.sin(TURNS)
    whole = mean[..., None] + (a * p)[..., None] * cos + (b * q)[..., None] * sin
    size = np.linalg.norm(whole, axis=-2, keepdims=True)
    drag = size * whole
    wide, varies = b > NARROW * a, a > 0
    along, across = (2 * (drag * weight).mean(axis=-1) for weight in (cos, sin))
    along = np.divide(along, a, out=np.zeros(along.shape), where=varies)
    across = np.divide(across, b, out=np.zeros(across.shape), where=varies & wide)
    d = U.shape[-1]
    weighted = np.divide(whole * sin**2, size, out=np.zeros(whole.shape), where=size > 0)
    outer = np.einsum("...in,...jn->...ij", weighted, whole)
    slope = 2 * (outer / TURNS.size + (size[..., 0, :] * sin**2).mean(axis=-1)[..., None, None] * np.eye(d))
    q = q * (wide & varies)
    rest = np.eye(d) - _outer(p, p) - _outer(q, q)
    return drag.mean(axis=-1), _outer(along, p) + _outer(across, q) + varies[..., None] * (slope @ rest)


def of_harmonic(U: np.ndarray) -> np.ndarray:
    """K (…, d, d) [m/s] of velocities Re{U exp(-iωt)}, U (…, d) [m/s]: 2⟨|u| cos²⟩ along the ellipse u = a cos + b sin,

    2⟨|u| sin²⟩ across, as in the limit of no width, too: of a flow in a plane what crosses that is rounding.
    """
    p, _, a, b = _ellipse(U)
    size = np.hypot(a * np.cos(TURNS), b * np.sin(TURNS))
    along, across = (2 * (size * weight**2).mean(axis=-1)[..., None, None] for weight in (np.cos(TURNS), np.sin(TURNS)))
    return (along - across) * _outer(p, p) + across * np.eye(U.shape[-1])


def _ellipse(U: np.ndarray) -> tuple[np.ndarray, ...]:
    """Unit vectors p and q (…, d) of the axes of Re{U exp(-iωt)}, and half its widths a >= b (…, 1); zero of none."""
    turned = U * np.exp(-0.5j * np.angle(np.sum(U * U, axis=-1, keepdims=True)))
    a = np.linalg.norm(turned.real, axis=-1, keepdims=True)
    p = np.divide(turned.real, a, out=np.zeros(U.shape), where=a > 0)
    other = turned.imag - np.sum(turned.imag * p, axis=-1, keepdims=True) * p
    b = np.linalg.norm(other, axis=-1, keepdims=True)
    return p, np.divide(other, b, out=np.zeros(U.shape), where=b > 0), a, b


def _outer(x: np.ndarray, y: np.ndarray) -> np.ndarray:
    return x[..., :, None] * y[..., None, :]


def of_lines(u: np.ndarray) -> np.ndarray:
    """K (n, d, d) of velocities of lines (nw, d, n): of one harmonic, or of a Gaussian process."""
    return of_parts(parts(u))


def parts(u: np.ndarray) -> np.ndarray:
    """Real and imaginary parts (d, n, 2 nw) of lines (nw, d, n), side by side."""
    return np.ascontiguousarray(np.moveaxis(u, 0, -1)).view(float)


def of_parts(u: np.ndarray) -> np.ndarray:
    """The same of lines as their parts (d, n, 2 nw)."""
    if u.shape[-1] == 2:
        return of_harmonic(u.view(complex)[..., 0].T)
    return of_gaussian(covariance(u))


def of_parts_in(stream: np.ndarray, u: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """F (n, d) and K (n, d, d) of a current (d, n) and lines as in of_parts (d, n, 2 nw)."""
    if u.shape[-1] == 2:
        return harmonic_in_stream(stream.T, u.view(complex)[..., 0].T)
    return in_stream(stream.T, covariance(u))


def equivalent(stream: np.ndarray, water: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Mean (ns, nd) [m²/s²] and K (ns, nd, nd) [m/s] of velocities (nw, nd, ns) in a current; those of waves without
    height are none."""
    water = water[np.any(water, axis=(1, 2))]
    if not stream.any():
        return np.zeros(stream.T.shape), of_lines(water)
    return of_parts_in(stream, parts(water))


def covariance(u: np.ndarray) -> np.ndarray:
    """(n, d, d) of lines as in of_parts (d, n, 2 nw)."""
    d, n = u.shape[:2]
    S = np.empty((n, d, d))
    for i, j in np.ndindex(d, d):
        S[:, i, j] = S[:, j, i] if j < i else 0.5 * np.einsum("sw,sw->s", u[i], u[j])
    return S


def by_station(K: np.ndarray, u: np.ndarray) -> np.ndarray:
    """K u (m, d, n) of vectors u (m, d, n) at n stations, K (n, d, d)."""
    return np.einsum("ijn,mjn->min", np.ascontiguousarray(np.moveaxis(K, 0, -1)), u)
