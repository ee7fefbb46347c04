"""Surfaces of triangles and quadrilaterals: edges, clipping, splitting.

Indexed: vertices (nv, 3) [m], faces (nf, 4); loose: panels (n, 4, 3) [m], corners not shared.
Corners run counter-clockwise seen from the water; a triangle gives its last corner twice.
"""

from collections.abc import Sequence

import numpy as np
import scipy  # sparse and spatial are slow to import, and the command line needs scenes but rarely meshes

PAIRS = 2**20  # of points and triangles at a time
WELD = 1e-6  # of the extent: closer points are one; files in single precision hold 1e-7
SAME = 1e-12  # of the extent: closer points are one in the file itself, but for rounding as it was shifted and turned
ON = 1e-5  # of the extent: what is closer to still water or to a plane of symmetry lies on it, as in turned files
TIE = 1e-3  # of a length: sides that differ by less are as long as each other, whatever noise their corners have


def mirrored(piece: tuple[np.ndarray, np.ndarray], mirror: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Vertices and faces of a mirror image, normals still outwards."""
    vertices, faces = piece
    if np.prod(mirror) > 0:
        return vertices * mirror, faces
    # Wound back from the same corner: a panel that is not plane keeps the diagonal it folds along.
    triangle = (faces[:, 2] == faces[:, 3])[:, None]
    return vertices * mirror, np.where(triangle, faces[:, [0, 2, 1, 1]], faces[:, [0, 3, 2, 1]])


def placed(vertices: np.ndarray, origin: Sequence[float], rotation: Sequence[float], scale: float) -> np.ndarray:
    """scale · Rz Ry Rx (vertices - origin), (nv, 3) [m]; rotation: angles about x, y and z [rad]."""
    R = np.eye(3)
    for axis, angle in enumerate(rotation):
        i, j = (axis + 1) % 3, (axis + 2) % 3
        turn = np.eye(3)
        turn[i, i] = turn[j, j] = np.cos(angle)
        turn[j, i] = np.sin(angle)
        turn[i, j] = -turn[j, i]
        R = turn @ R
    return scale * (vertices - np.asarray(origin, float)) @ R.T


def merged(pieces: list[tuple[np.ndarray, np.ndarray]]) -> tuple[np.ndarray, np.ndarray]:
    """Vertices and faces of several pieces as one."""
    starts = np.cumsum([0] + [len(v) for v, _ in pieces[:-1]])
    faces = [f + start for start, (_, f) in zip(starts, pieces, strict=True)]
    return np.concatenate([v for v, _ in pieces]), np.concatenate(faces)


def triangles(panels: np.ndarray) -> np.ndarray:
    """Each panel as one or two triangles, (n, 3, 3), folded along its first diagonal."""
    second = np.any(panels[:, 2] != panels[:, 3], axis=1)
    return np.concatenate([panels[:, :3], panels[second][:, [0, 2, 3]]])


def area_vectors(corners: np.ndarray) -> np.ndarray:
    """n dS (n, 3) [m²] of triangles (n, 3, 3)."""
    return np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]) / 2


def quad_vectors(corners: np.ndarray) -> np.ndarray:
    """The same of panels (n, 4, 3), by their diagonals."""
    return np.cross(corners[:, 2] - corners[:, 0], corners[:, 3] - corners[:, 1]) / 2


def areas(panels: np.ndarray) -> np.ndarray:
    """[m²] (n,) of panels (n, 4, 3), of the triangles on both sides of their first diagonal."""
    halves = (area_vectors(panels[:, corners]) for corners in ([0, 1, 2], [0, 2, 3]))
    return np.asarray(sum(np.linalg.norm(half, axis=1) for half in halves))


def connected(links: np.ndarray, count: int) -> tuple[int, np.ndarray]:
    """How many connected parts `count` points have with links (n, 2) between them, and the part of each (count,)."""
    graph = scipy.sparse.coo_array((np.ones(len(links)), tuple(links.T)), shape=(count,) * 2)
    parts, part = scipy.sparse.csgraph.connected_components(graph, directed=False)
    return int(parts), part


def one_each(vertices: np.ndarray, indices: np.ndarray, within: float = WELD) -> tuple[np.ndarray, np.ndarray]:
    """Points that coincide `within` a share of the extent made one, and the indices of all into what is left."""
    extent = np.ptp(vertices[indices.ravel()], axis=0).max()
    near = scipy.spatial.cKDTree(vertices).query_pairs(within * extent, output_type="ndarray")
    _, place = connected(near, len(vertices))
    return vertices[np.unique(place, return_index=True)[1]], place[indices]


def edges(faces: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Directed edges (ne, 2) of all faces, and the face (ne,) of each."""
    pairs = np.stack([faces, np.roll(faces, -1, axis=1)], axis=-1).reshape(-1, 2)
    owner = np.repeat(np.arange(len(faces)), 4)
    real = pairs[:, 0] != pairs[:, 1]
    return pairs[real], owner[real]


def met_twice(place: np.ndarray, count: np.ndarray) -> np.ndarray:
    """Pairs (n, 2) of edges in one place, of the place (ne,) of each, where these have two by their count (np,)."""
    order = np.argsort(place, kind="stable")
    return order[count[place[order]] == 2].reshape(-1, 2)


def unmatched(lines: np.ndarray) -> np.ndarray:
    """What of edges (n, 2, 3), cut where ends of others lie on them, is left of those that no other one covers."""
    ends = lines.reshape(-1, 3)
    if not len(ends):
        return lines
    vertices, pairs = one_each(ends, np.arange(len(ends)).reshape(-1, 2))
    pairs, _ = cut_where_corners_lie(vertices, pairs, np.zeros(len(pairs), int))
    return vertices[pairs[_alone(pairs)]]


def enclosed(lines: np.ndarray) -> float:
    """Most that closed outlines of edges (n, 2, 3) can enclose [m²]: circles of their lengths."""
    _, outline = outlines(lines)
    length = np.bincount(outline, np.linalg.norm(lines[:, 1] - lines[:, 0], axis=1))
    return float(np.sum(length**2) / (4 * np.pi))


def outlines(lines: np.ndarray) -> tuple[int, np.ndarray]:
    """How many separate outlines edges (n, 2, 3) make up, and the outline (n,) of each edge."""
    if not len(lines):
        return 0, np.zeros(0, int)
    vertices, pairs = one_each(lines.reshape(-1, 3), np.arange(2 * len(lines)).reshape(-1, 2))
    count, part = connected(pairs, len(vertices))
    return count, part[pairs[:, 0]]


def _alone(pairs: np.ndarray) -> np.ndarray:
    """Which edges (ne, 2), in either sense, are there once (ne,)."""
    _, place, count = np.unique(np.sort(pairs, axis=1), axis=0, return_inverse=True, return_counts=True)
    return count[place] == 1


def cut_where_corners_lie(vertices: np.ndarray, pairs: np.ndarray, owner: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Edges (ne, 2) and their owners (ne,), those of one face alone cut at the ends of others that lie on them."""
    alone = _alone(pairs)
    ends = np.unique(pairs[alone])
    if not len(ends):
        return pairs, owner
    tree, close = scipy.spatial.cKDTree(vertices[ends]), WELD * np.ptp(vertices, axis=0).max()
    cut, whose = [pairs[~alone]], [owner[~alone]]
    for (a, b), face in zip(pairs[alone], owner[alone], strict=True):
        along = vertices[b] - vertices[a]
        length = np.linalg.norm(along)
        near = ends[tree.query_ball_point((vertices[a] + vertices[b]) / 2, length / 2)]
        way = (vertices[near] - vertices[a]) @ along / length
        off = np.linalg.norm(vertices[near] - vertices[a] - way[:, None] * along / length, axis=1)
        on = (off < close) & (way > close) & (way < length - close)
        chain = np.array([a, *near[on][np.argsort(way[on])], b])
        cut.append(np.column_stack([chain[:-1], chain[1:]]))
        whose.append(np.full(len(chain) - 1, face))
    return np.concatenate(cut), np.concatenate(whose)


def point_text(point: np.ndarray) -> str:
    """Coordinates [m], for messages."""
    return "(" + ", ".join(f"{x:.4g}" for x in point) + ") m"


def column_volume(panels: np.ndarray) -> np.ndarray:
    """∫ z n_z dS (n,) of each panel."""
    total = np.zeros(len(panels))
    for corners in (panels[:, :3], panels[:, [0, 2, 3]]):
        total += corners[:, :, 2].mean(axis=1) * area_vectors(corners)[:, 2]
    return total


def volume(panels: np.ndarray) -> float:
    """Between wetted panels (n, 4, 3) and still water [m³], ∫ z n_z dS."""
    return float(column_volume(panels).sum())


def turns_round(panels: np.ndarray, points: np.ndarray) -> np.ndarray:
    """How often panels (n, 4, 3) with normals outwards wind round points (m, 3): 1 within a closed surface, 0 outside.

    Solid angles of the triangles over 4π (van Oosterom and Strackee 1983); a half on it, any number near holes.
    """
    middle = points.mean(axis=0) if len(points) else 0.0  # near to which rounding takes the least of dot products
    corners, points = triangles(panels) - middle, points - middle
    a, b, c = np.moveaxis(corners, 1, 0)
    normals = np.cross(b - a, c - a)
    total = np.zeros(len(points))
    for first in range(0, len(points), max(1, PAIRS // len(corners))):
        p = points[first : first + max(1, PAIRS // len(corners))]
        la, lb, lc = (np.sqrt(np.maximum(_seen_dot(p, corner, corner), 0.0)) for corner in (a, b, c))
        triple = np.sum(a * normals, axis=1) - p @ normals.T
        bent = la * lb * lc + _seen_dot(p, a, b) * lc + _seen_dot(p, b, c) * la + _seen_dot(p, c, a) * lb
        total[first : first + len(p)] = 2 * np.arctan2(triple, bent).sum(axis=1)
    return total / (4 * np.pi)


def _seen_dot(p: np.ndarray, a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """(a - p)·(b - p) (m, n) of points p (m, 3) with a and b (n, 3): of products of matrices, a sixth of the time."""
    return np.sum(a * b, axis=1) - p @ (a + b).T + np.sum(p**2, axis=1)[:, None]


def alike(panels: np.ndarray, other: np.ndarray, tolerance: float) -> bool:
    """Whether two surfaces of flat panels are one, however they are cut: plane by plane of equal moments.

    Up to the second, within `tolerance` [m] at the distance that the surfaces reach.
    """
    reach = np.abs(panels).max()
    corners = np.concatenate([triangles(panels), triangles(other)])
    vector = area_vectors(corners)
    area = np.linalg.norm(vector, axis=1)
    normal = vector / area[:, None]
    first = len(triangles(panels))
    key = np.column_stack([reach * normal, np.einsum("ni,ni->n", normal, corners[:, 0])])
    # Thousands of panels may lie in one plane, and have millions of pairs: first what rounds to the same.
    cells, cell = np.unique(np.round(key / tolerance), axis=0, return_inverse=True)
    near = scipy.spatial.cKDTree(cells).query_pairs(6.0, output_type="ndarray")  # 4, and half a cell's diagonal twice
    planes, part = connected(near, len(cells))
    plane = part[cell]
    middles = (corners + np.roll(corners, -1, axis=1)) / 2  # integrate second degrees exactly
    x = np.concatenate([np.ones((*middles.shape[:2], 1)), middles / reach], axis=2)
    moments = np.einsum("n,nki,nkj->nij", area / 3, x, x).reshape(len(x), -1)
    moments[first:] *= -1
    gap = np.zeros((planes, moments.shape[1]))
    np.add.at(gap, plane, moments)
    size = np.bincount(plane, area, planes)
    return bool(np.all(np.abs(gap) <= 4 * tolerance / reach * (size + reach * np.sqrt(size))[:, None]))


def below(panels: np.ndarray, axis: int = 2, *, sign: int = 1) -> np.ndarray:
    """The parts of panels (n, 4, 3) where sign times the coordinate is negative, corners near 0 moved onto it.

    One that is not plane is cut as it is folded, along its first diagonal.
    """
    if not len(panels):
        return panels
    extent = np.ptp(panels.reshape(-1, 3), axis=0).max()
    panels = onto(panels, [axis], extent)
    level = sign * panels[:, :, axis]
    inside = level.min(axis=1) < 0
    whole = inside & (level.max(axis=1) <= 0)
    crossed = panels[inside & ~whole]
    folded = _warp(crossed) > ON * extent
    crossed = np.concatenate([crossed[~folded], triangles(crossed[folded])[:, [0, 1, 2, 2]]])
    cut = [piece for p in crossed for piece in _cut(p, sign * p[:, axis])]
    pieces = onto(np.concatenate([panels[whole], np.array(cut).reshape(-1, 4, 3)]), [axis], extent)
    return pieces[areas(pieces) > (WELD * extent) ** 2]


def _warp(panels: np.ndarray) -> np.ndarray:
    """Distance (n,) [m] of one diagonal of panels (n, 4, 3) from the other."""
    first, second = panels[:, 2] - panels[:, 0], panels[:, 3] - panels[:, 1]
    across = np.cross(first, second)
    size = np.linalg.norm(across, axis=1)
    apart = np.abs(np.einsum("ni,ni->n", across, panels[:, 1] - panels[:, 0]))
    return np.divide(apart, size, out=np.zeros(len(panels)), where=size > 0)


def onto(points: np.ndarray, axes: Sequence[int], extent: float) -> np.ndarray:
    """Points (..., 3) of a surface of some extent [m], those near the planes 0 of some axes moved onto them."""
    near = (np.abs(points) < ON * extent) & np.isin(np.arange(3), axes)
    return np.where(near, 0.0, points)


def _cut(panel: np.ndarray, level: np.ndarray) -> list[np.ndarray]:
    """A panel's part below level 0 as triangles and quadrilaterals."""
    if np.all(panel[2] == panel[3]):
        panel, level = panel[:3], level[:3]
    polygon = []
    for p, q, h, g in zip(panel, np.roll(panel, -1, axis=0), level, np.roll(level, -1), strict=True):
        if h <= 0:
            polygon.append(p)
        if h * g < 0:
            polygon.append(p + h / (h - g) * (q - p))
    last = len(polygon) - 1
    return [np.array([polygon[0], polygon[i], polygon[i + 1], polygon[min(i + 2, last)]]) for i in range(1, last, 2)]


def split(panels: np.ndarray, size: float) -> np.ndarray:
    """Panels halved across their longest sides until no side exceeds `size` [m] by more than TIE."""
    done = []
    while len(panels):
        sides = np.linalg.norm(panels - np.roll(panels, -1, axis=1), axis=2)
        long = sides.max(axis=1) > (1 + TIE) * size
        done.append(panels[~long])
        panels, sides = panels[long], sides[long]
        flat = np.all(panels[:, 2] == panels[:, 3], axis=1)
        panels = np.concatenate([_halved_triangles(panels[flat], sides[flat]), _halved(panels[~flat], sides[~flat])])
    return np.concatenate(done) if done else panels


def _halved(panels: np.ndarray, sides: np.ndarray) -> np.ndarray:
    """Quadrilaterals cut across the longer pair of sides."""
    turn = np.maximum(sides[:, 1], sides[:, 3]) > (1 + TIE) * np.maximum(sides[:, 0], sides[:, 2])
    a, b, c, d = np.moveaxis(np.where(turn[:, None, None], np.roll(panels, -1, axis=1), panels), 1, 0)
    low, high = (a + b) / 2, (c + d) / 2
    return np.concatenate([np.stack([a, low, high, d], axis=1), np.stack([low, b, c, high], axis=1)])


def _halved_triangles(panels: np.ndarray, sides: np.ndarray) -> np.ndarray:
    """Triangles cut from the middle of the longest side."""
    sides = sides[:, [0, 1, 3]]
    longest = (sides >= (1 - TIE) * sides.max(axis=1, keepdims=True)).argmax(axis=1)
    index = (np.arange(3) + longest[:, None]) % 3
    a, b, c = np.moveaxis(panels[np.arange(len(panels))[:, None], index], 1, 0)
    m = (a + b) / 2
    return np.concatenate([np.stack([a, m, c, c], axis=1), np.stack([m, b, c, c], axis=1)])


def quartered(panels: np.ndarray) -> np.ndarray:
    """Each panel as four with sides half as long."""
    a, b, c, d = np.moveaxis(panels, 1, 0)
    ab, bc, cd, da = (a + b) / 2, (b + c) / 2, (c + d) / 2, (d + a) / 2
    m = (a + b + c + d) / 4
    quads = [(a, ab, m, da), (ab, b, bc, m), (m, bc, c, cd), (da, m, cd, d)]
    ca = (c + a) / 2
    thirds = [(a, ab, ca, ca), (ab, b, bc, bc), (ca, bc, c, c), (ab, bc, ca, ca)]
    flat = np.all(c == d, axis=1)
    return np.concatenate([np.stack(q, axis=1)[~flat] for q in quads] + [np.stack(t, axis=1)[flat] for t in thirds])


def divided(panels: np.ndarray, along: np.ndarray, across: np.ndarray) -> np.ndarray:
    """Each panel in parts whose corners are at shares 0 to 1 of its first and third sides, and of the others."""
    u, v = (x[..., None, None] for x in np.meshgrid(along, across, indexing="ij"))
    a, b, c, d = np.moveaxis(panels, 1, 0)
    nodes = (1 - v) * (a + u * (b - a)) + v * (d + u * (c - d))  # so that a triangle's last corners stay one
    cells = np.stack([nodes[:-1, :-1], nodes[1:, :-1], nodes[1:, 1:], nodes[:-1, 1:]], axis=3)
    return cells.reshape(-1, 4, 3)
