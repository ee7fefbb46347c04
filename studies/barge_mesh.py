"""Writes barge.gdf: a quarter of a barge 4 m long, 3 m wide and 1.2 m high, half of it under water."""

from pathlib import Path

import numpy as np

LENGTH, WIDTH, HEIGHT, SIDE = 4.0, 3.0, 1.2, 0.25  # m; longest side of a panel


def face(corner: tuple[float, ...], along: tuple[float, ...], up: tuple[float, ...]) -> np.ndarray:
    """Panels (n, 4, 3) of a rectangle; along x up points into the water."""
    start, side, rise = (np.array(v, float) for v in (corner, along, up))
    n, m = (int(np.ceil(np.linalg.norm(v) / SIDE)) for v in (side, rise))
    cells = [(i, j) for i in range(n) for j in range(m)]
    steps = np.array([(0, 0), (1, 0), (1, 1), (0, 1)])
    return np.array([[start + (i + a) / n * side + (j + b) / m * rise for a, b in steps] for i, j in cells])


def quarter() -> np.ndarray:
    """Bottom, deck, end and side at x > 0, y > 0."""
    x, y, z = LENGTH / 2, WIDTH / 2, HEIGHT / 2
    return np.concatenate(
        [
            face((0, 0, -z), (0, y, 0), (x, 0, 0)),
            face((0, 0, z), (x, 0, 0), (0, y, 0)),
            face((x, 0, -z), (0, y, 0), (0, 0, 2 * z)),
            face((0, y, -z), (0, 0, 2 * z), (x, 0, 0)),
        ]
    )


if __name__ == "__main__":
    rows = ["   ".join(" ".join(f"{v:.4f}" for v in p) for p in panel) for panel in quarter()]
    head = ["Barge, 4 x 3 x 1.2 m, draft 0.6 m", "1.0 9.80665 ULEN GRAV", "1 1 ISX ISY", str(len(rows))]
    Path(__file__).with_name("barge.gdf").write_text("\n".join([*head, *rows, ""]))
