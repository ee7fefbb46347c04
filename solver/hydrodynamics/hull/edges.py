"""Edges at which a hull juts out, and panels that are narrow there.

Along such an edge that turns by α the potential goes as r^(π/(π+α)), of which even panels of side h miss h^p,
p = 2π/(π+α) in the end and nearer to 1 at the usual h, whatever the order elsewhere. Where panels are cut at CUT of
their width, boxes 0.5 to 3 m deep have 0.2 to 0.5 of the error, with twice the panels.
"""

import numpy as np

from solver.hydrodynamics.hull import mending, surface

SHARP = np.pi / 6  # edges that turn by less are left as they are [rad]
CUT = 0.25  # of a panel's width, from the edge on
NEAR = 1e-6  # of the extent: what is as near to an edge lies on it


def jutting(panels: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Sides (n, 2, 3) along which two panels meet and jut out, and by how much the surface turns there (n,) [rad].

    Panels may meet along parts of their sides: then it is the sides of both.
    """
    vertices, faces, _ = mending.welded(panels.reshape(-1, 3), np.arange(4 * len(panels)).reshape(-1, 4))
    sides, owner = surface.edges(faces)
    pairs, side = surface.cut_where_corners_lie(vertices, sides, np.arange(len(sides)))
    _, place, count = np.unique(np.sort(pairs, axis=1), axis=0, return_inverse=True, return_counts=True)
    shared = side[surface.met_twice(place, count)]
    one, other = owner[shared].T
    corners = vertices[faces]
    normals = surface.quad_vectors(corners)
    normals /= np.linalg.norm(normals, axis=1)[:, None]
    away = np.sum((corners.mean(axis=1)[other] - corners.mean(axis=1)[one]) * normals[one], axis=1)
    turn = np.arccos(np.clip(np.sum(normals[one] * normals[other], axis=1), -1, 1))
    juts = away < 0
    lines, line = np.unique(np.sort(sides[shared[juts]].reshape(-1, 2), axis=1), axis=0, return_inverse=True)
    most = np.zeros(len(lines))
    np.maximum.at(most, line, np.repeat(turn[juts], 2))
    return vertices[lines], most


def order(turn: float) -> float:
    """p of the error h^p of even panels as wide as ours at an edge that turns by so much: 1.0 to 1.2 of boxes."""
    return float(2 * (np.pi / (np.pi + turn)) ** 1.5)


def narrowed(panels: np.ndarray, lines: np.ndarray, turn: np.ndarray) -> np.ndarray:
    """Panels (n, 4, 3) cut along those of their sides that lie on SHARP ones of edges, see `jutting`."""
    cut = _on(panels, lines[turn > SHARP])
    flat = np.all(panels[:, 2] == panels[:, 3], axis=1)
    triangles, of_triangles = panels[flat], cut[flat]
    quads, of_quads = [panels[~flat]], [cut[~flat]]
    for _ in range(3):  # a side of a triangle at a time: what is cut off has four
        some = of_triangles[:, 0]
        (a, b, c, _), (_, right, _, left) = np.moveaxis(triangles[some], 1, 0), of_triangles[some].T
        along, across = b + CUT * (c - b), a + CUT * (c - a)
        quads.append(np.stack([a, b, along, across], axis=1))
        of_quads.append(np.stack([np.zeros_like(left), right, np.zeros_like(left), left], axis=1))
        triangles[some], of_triangles[some, 0] = np.stack([across, along, c, c], axis=1), False
        triangles, of_triangles = triangles[:, [1, 2, 0, 0]], of_triangles[:, [1, 3, 2, 0]]
    return np.concatenate([triangles, _cut(np.concatenate(quads), np.concatenate(of_quads))])


def _cut(quads: np.ndarray, sides: np.ndarray) -> np.ndarray:
    """Quadrilaterals cut along some of their sides (n, 4)."""
    done = []
    for first, right, last, left in np.unique(sides, axis=0).tolist():
        u = np.concatenate([[0.0], [CUT] * left, [1 - CUT] * right, [1.0]])
        v = np.concatenate([[0.0], [CUT] * first, [1 - CUT] * last, [1.0]])
        alike = np.all(sides == (first, right, last, left), axis=1)
        done.append(surface.divided(quads[alike], u, v))
    return np.concatenate(done) if done else quads


def _on(panels: np.ndarray, lines: np.ndarray) -> np.ndarray:
    """Which sides of panels (n, 4), from each corner to the next, lie on edges (ne, 2, 3)."""
    least = NEAR * np.ptp(panels.reshape(-1, 3), axis=0).max()
    start, along = lines[:, 0], lines[:, 1] - lines[:, 0]
    length = np.linalg.norm(along, axis=1)
    corners, place = np.unique(panels.reshape(-1, 3), axis=0, return_inverse=True)
    on = np.empty((len(corners), len(lines)), bool)
    for n, corner in enumerate(corners):
        share = np.sum((corner - start) * along, axis=1) / length**2
        beside = np.linalg.norm(corner - start - share.clip(0, 1)[:, None] * along, axis=1)
        on[n] = beside < least
    on = on[place.reshape(-1, 4)]
    return np.any(on & np.roll(on, -1, axis=1), axis=2)
