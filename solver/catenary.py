"""Elastic catenaries: mooring lines of constant weight between anchors on the seabed and fairleads above them.

Irvine (1981), Cable structures; the equations are those of Jonkman (2007, NREL/TP-500-41958, 2-35 to 2-38), without
friction on the seabed, on which a line lies from its anchor on as far as it does not hang. Lines are quasi-static:
neither their inertia nor the water's drag on them counts.
"""

from typing import NamedTuple

import numpy as np

from solver.kernels import inner_kernel, lean_kernel

ROUNDS = 100  # of Newton's method
CLOSE = 1e-8  # of the line's length, that its end may be off before the last step
LEAST = 1e-9  # of a line's weight: tensions that are sought are no less; of its length: spans and heights


class Lines(NamedTuple):
    """The lines of all bodies, body by body."""

    first: np.ndarray  # (nb + 1,) number of each body's first line
    anchor: np.ndarray  # (n, 3) [m]
    fairlead: np.ndarray  # (n, 3) from the body's reference point, in the body [m]
    length: np.ndarray  # (n,) unstretched [m]
    weight: np.ndarray  # (n,) in water [N/m]
    EA: np.ndarray  # (n,) [N]


@lean_kernel
def ends(H: float, V: float, length: float, weight: float, EA: float) -> tuple[float, float, float, float, float]:
    """Span and height [m] that tensions H along and V up at the fairlead give; ∂span/∂H, ∂span/∂V, ∂height/∂V [m/N].

    ∂height/∂H is ∂span/∂V.
    """
    top, foot = V / H, (V - weight * length) / H
    rise, lift = np.sqrt(1 + top * top), 1.0
    span, height, by_V = H * length / EA, 0.0, length / EA
    if foot < 0:  # a part lies on the seabed
        foot = 0.0
        span += length - V / weight
        height, by_V = V * V / (2 * EA * weight), V / (EA * weight)
    else:
        lift = np.sqrt(1 + foot * foot)
        height = (V - weight * length / 2) * length / EA
    bent = np.arcsinh(top) - np.arcsinh(foot)
    span += H / weight * bent
    height += H / weight * (rise - lift)
    along = (bent - top / rise + foot / lift) / weight + length / EA
    return span, height, along, (1 / rise - 1 / lift) / weight, (top / rise - foot / lift) / weight + by_V


@lean_kernel
def tensions(span: float, height: float, length: float, weight: float, EA: float) -> tuple[float, float]:
    """Tensions H along and V up [N] at a fairlead `span` from the anchor and `height` above it [m]; H = 0 if slack."""
    span, height = max(span, LEAST * length), max(height, LEAST * length)
    # EA (√(1 + 2wh/EA) - 1), as which of a stiff line next to nothing would be left
    hanging = 2 * weight * height / (1 + np.sqrt(1 + 2 * weight * height / EA))
    if length - hanging / weight >= span:  # it hangs straight down, and lies slack
        return 0.0, hanging
    least = LEAST * weight * length
    # Jonkman (2007), equations 2-39 to 2-41; stretched lines begin as their springs do.
    straight = np.sqrt(span * span + height * height)
    bend = 0.2 if length <= straight else np.sqrt(max(3 * ((length**2 - height**2) / span**2 - 1), 1e-4))
    stretch = EA * max(straight / length - 1, 0.0) / straight
    H = max(weight * span / (2 * bend), stretch * span)
    V = weight / 2 * (height / np.tanh(bend) + length) + stretch * height
    for _ in range(ROUNDS):
        x, z, xH, xV, zV = ends(H, V, length, weight, EA)
        dx, dz = span - x, height - z
        det = xH * zV - xV * xV
        dH, dV = (zV * dx - xV * dz) / det, (xH * dz - xV * dx) / det
        way = min(1.0, 4 * (H + least) / max(abs(dH), least), 0.9 * H / max(-dH, least))
        way = min(way, 4 * (V + least) / max(abs(dV), least), 0.9 * V / max(-dV, least))
        H, V = max(H + way * dH, least), max(V + way * dV, least)
        if max(abs(dx), abs(dz)) < CLOSE * length:  # and this last step squared that
            break
    return H, V


@lean_kernel
def line_pull(
    lines: Lines, i: int, position: np.ndarray, rotation: np.ndarray
) -> tuple[float, float, float, float, float, float]:
    """Where line i's fairlead is from the body's reference point, x, y, z [m], and its pull, fx, fy, fz [N].

    position (3,) [m], rotation (3, 3): of the body.
    """
    u, v, w = lines.fairlead[i, 0], lines.fairlead[i, 1], lines.fairlead[i, 2]
    x = rotation[0, 0] * u + rotation[0, 1] * v + rotation[0, 2] * w
    y = rotation[1, 0] * u + rotation[1, 1] * v + rotation[1, 2] * w
    z = rotation[2, 0] * u + rotation[2, 1] * v + rotation[2, 2] * w
    along = lines.anchor[i, 0] - position[0] - x
    aside = lines.anchor[i, 1] - position[1] - y
    span, height = np.sqrt(along * along + aside * aside), position[2] + z - lines.anchor[i, 2]
    H, V = tensions(span, height, lines.length[i], lines.weight[i], lines.EA[i])
    share = H / max(span, LEAST * lines.length[i])
    return x, y, z, share * along, share * aside, -V


@inner_kernel
def add_lines(lines: Lines, b: int, position: np.ndarray, rotation: np.ndarray, load: np.ndarray) -> None:
    """Load (6,) [N, N m] of body b's lines about its reference point at `position`, turned by `rotation`, added."""
    for i in range(lines.first[b], lines.first[b + 1]):
        x, y, z, fx, fy, fz = line_pull(lines, i, position, rotation)
        load[0] += fx
        load[1] += fy
        load[2] += fz
        load[3] += y * fz - z * fy
        load[4] += z * fx - x * fz
        load[5] += x * fy - y * fx
