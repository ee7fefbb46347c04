"""Writes jeju-platform.gdf: four columns in the corners of a truss that water passes through; a quarter, one column."""

from pathlib import Path

import numpy as np

X, Y, RADIUS, DRAFT, FREEBOARD, SIDES = 14.0, 25.0, 3.0, 10.0, 4.0, 16  # of the column's axis and the column [m]


def column() -> np.ndarray:
    """Panels (n, 4, 3) of a prism as wide in the water as a round column: side, bottom, top."""
    turn = 2 * np.pi / SIDES
    angle = turn * np.arange(SIDES + 1)
    ring = RADIUS * np.sqrt(turn / np.sin(turn)) * np.column_stack([np.cos(angle), np.sin(angle)]) + [X, Y]
    a, b, middle = ring[:-1], ring[1:], np.full((SIDES, 2), [X, Y])
    low, high = -DRAFT, FREEBOARD
    corners = [
        [(a, low), (b, low), (b, high), (a, high)],
        [(middle, low), (b, low), (a, low), (a, low)],
        [(middle, high), (a, high), (b, high), (b, high)],
    ]
    return np.concatenate([np.stack([np.insert(p, 2, z, axis=1) for p, z in quad], axis=1) for quad in corners])


if __name__ == "__main__":
    rows = ["   ".join(" ".join(f"{v:.5f}" for v in p) for p in panel) for panel in column()]
    head = ["Four columns, 3 m radius, draft 10 m, at x = +-14 m, y = +-25 m", "1.0 9.80665 ULEN GRAV", "1 1 ISX ISY"]
    Path(__file__).with_name("jeju-platform.gdf").write_text("\n".join([*head, str(len(rows)), *rows, ""]))
