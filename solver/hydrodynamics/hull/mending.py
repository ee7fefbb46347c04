"""Meshes as files have them made surfaces: points that coincide made one, copies left out, panels wound alike."""

from collections import Counter
from collections.abc import Sequence

import numpy as np
import scipy  # sparse is slow to import, and the command line needs scenes but rarely meshes

from solver.errors import InputError
from solver.hydrodynamics.hull import surface

FEW = 20  # panels, which may well have more edges that are open than others
APART = 0.8  # of all panels' sides: of bricks half are alone, of panels that nothing joins all


def once(vertices: np.ndarray, faces: np.ndarray) -> tuple[np.ndarray, np.ndarray, list[str], int]:
    """Of panels with the same corners in a file one; a note of the others, and how many were wound the other way.

    One between neighbours closes a surface, to which `oriented` turns it; of a plate's two sides one closes nothing.
    None of a wall between two bodies, each of which has it.
    """
    vertices, faces = surface.one_each(vertices, faces, surface.SAME)
    faces = _collapsed(faces)
    first, stack, sense = _stacks(vertices, faces)
    inside = _walls(vertices, faces[first], np.bincount(stack, sense) == 0)
    alike = ~np.isin(stack, np.flatnonzero(inside))
    copies, against = int(alike.sum() - np.sum(~inside)), int(np.sum(sense[alike] < 0))
    note = f"left out: {copies} panels given twice" + (f", {against} of them wound the other way" if against else "")
    walls = f"left out: {inside.sum()} panels of walls between bodies, on either side"
    notes = [text for text, some in ((note, copies), (walls, inside.any())) if some]
    return vertices, faces[np.sort(first[~inside])], notes, against


def require_joined(vertices: np.ndarray, faces: np.ndarray, key: str, name: str) -> None:
    """Refuse panels most of which share no edge with another: their corners do not meet."""
    pairs, _ = surface.edges(faces)
    _, count = np.unique(np.sort(pairs, axis=1), axis=0, return_counts=True)
    alone = int(np.sum(count == 1))
    if len(faces) > FEW and alone > APART * len(pairs):
        near, _ = scipy.spatial.cKDTree(vertices).query(vertices, k=2)
        gap = float(np.median(near[:, 1]))
        limit = (
            f"is open at {alone} of its {len(count)} edges: corners of panels beside each other lie {gap:.2g} m apart,"
            f" and are joined within {surface.WELD * np.ptp(vertices, axis=0).max():.2g} m; join them where it was made"
        )
        raise InputError(key, name, limit)


def _walls(vertices: np.ndarray, faces: np.ndarray, both: np.ndarray) -> np.ndarray:
    """Which faces (n, 4), of those that are there either way round (n,), lie where others close without them.

    A patch of such is a wall where two others meet at every edge of its rim.
    """
    two, rest = faces[both], faces[~both]
    wall = np.zeros(len(faces), bool)
    if not (len(two) and surface.areas(vertices[rest]).any()):
        return wall
    pairs, owner = surface.edges(np.concatenate([two, rest]))
    _, place = np.unique(np.sort(pairs, axis=1), axis=0, return_inverse=True)
    own = owner < len(two)
    mine, others = (np.bincount(place[some], minlength=place.max() + 1) for some in (own, ~own))
    patch, _ = _patches(two)
    rim = own & (mine[place] == 1)
    closed, all_ = (
        np.bincount(patch[owner[some]], minlength=patch.max() + 1) for some in (rim & (others[place] == 2), rim)
    )
    wall[both] = ((closed == all_) & (all_ > 0))[patch]
    return wall


def welded(
    vertices: np.ndarray, faces: np.ndarray, planes: Sequence[int] = ()
) -> tuple[np.ndarray, np.ndarray, list[str]]:
    """Points near planes 0 of some axes on them, coinciding ones made one; and notes of panels that are left out.

    Those are without area, duplicates, or folds: what is so thin that its two sides have come to lie on each other.
    Their edges run against each other: without both of them their neighbours meet. Of two wound alike one has to stay.
    """
    extent = np.ptp(vertices[faces.ravel()], axis=0).max()
    near = surface.onto(vertices, planes, extent)
    moved = np.any(near != vertices, axis=1)[faces].any(axis=1)
    vertices, faces = surface.one_each(near, faces)
    faces = _collapsed(faces)
    flat = surface.areas(vertices[faces]) <= (surface.WELD * extent) ** 2 / 2
    flat |= np.any(faces[:, :2] == faces[:, 2:], axis=1)  # folded along a diagonal
    folded = _flattened(vertices, faces, moved)
    rest = np.flatnonzero(~(flat | folded))
    first, stack, sense = _stacks(vertices, faces[rest])
    even = np.bincount(stack, sense) == 0
    folded[rest[even[stack]]] = True
    kept = rest[np.sort(first[~even])]
    area = surface.areas(vertices[faces[folded]]).sum() / 2
    thin = f"of what is thinner than {2 * surface.ON * extent:.2g} m and so folds flat, {area:.2g} m2 on each side"
    lone, double = np.sum(flat & ~folded), np.sum(~(flat | folded)) - len(kept)
    counts = [(lone, "without area"), (double, "given twice"), (folded.sum(), thin)]
    return vertices, faces[kept], [f"left out: {n} panels {what}" for n, what in counts if n]


def triangulated(panels: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Vertices (nv, 3) and faces (nf, 4) of the triangles of panels (n, 4, 3), corners that coincide made one."""
    corners = surface.triangles(panels)
    faces = np.arange(3 * len(corners)).reshape(-1, 3)[:, [0, 1, 2, 2]]
    return welded(corners.reshape(-1, 3), faces)[:2]


def hanging(vertices: np.ndarray, triangles: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """On the sides of which triangles (nf, 4) corners of others lie (nf,); all sides (ne, 2), cut there, and whose.

    One so thin that its own corner lies on a side meets its neighbours as it is.
    """
    pairs, owner = surface.cut_where_corners_lie(vertices, *surface.edges(triangles))
    count = np.bincount(owner, minlength=len(triangles))
    starts = np.unique(np.column_stack([owner, pairs[:, 0]]), axis=0)
    return (count > 3) & (np.bincount(starts[:, 0], minlength=len(triangles)) == count), pairs, owner


def _flattened(vertices: np.ndarray, faces: np.ndarray, moved: np.ndarray) -> np.ndarray:
    """Which panels (nf,) in a plane 0 cover what others there cover the other way round, some `moved` (nf,) onto it.

    However each side is cut: in a plane, patches with the same rim are the same.
    """
    folded = np.zeros(len(faces), bool)
    for axis in range(3):
        some = np.flatnonzero(np.all(vertices[faces, axis] == 0, axis=1))
        patch, rims = _patches(faces[some])
        backs = [frozenset((line, -way) for line, way in rim) for rim in rims]
        gone: set[frozenset[tuple[int, int]]] = set()
        known = set(rims)
        for rim, back, new in zip(rims, backs, np.bincount(patch, moved[some], len(rims)), strict=True):
            if new and back in known:
                gone |= {rim, back}
        folded[some] |= np.array([rim in gone for rim in rims], bool)[patch]
    return folded


def _patches(faces: np.ndarray) -> tuple[np.ndarray, list[frozenset[tuple[int, int]]]]:
    """Each panel's patch (nf,), up to the edges of one or more than two, and the rim of each: edges, and which way."""
    pairs, owner = surface.edges(faces)
    _, place, count = np.unique(np.sort(pairs, axis=1), axis=0, return_inverse=True, return_counts=True)
    patches, patch = surface.connected(owner[surface.met_twice(place, count)], len(faces))
    ways = [Counter[int]() for _ in range(patches)]
    for n, line, way in zip(patch[owner], place, np.where(pairs[:, 0] < pairs[:, 1], 1, -1), strict=True):
        ways[n][line] += way
    return patch, [frozenset((line, way) for line, way in rim.items() if way) for rim in ways]


def _stacks(vertices: np.ndarray, faces: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Of panels with the same corners: the first (n,) of each stack, each one's stack (nf,), and 1 or -1 (nf,) for
    the way that it is wound, as the first or against it."""
    triangle = (faces[:, 2] == faces[:, 3])[:, None]  # repeats its last corner, whichever that is
    corners = np.sort(np.where(triangle & (np.arange(4) == 3), -1, faces), axis=1)
    _, first, stack = np.unique(corners, axis=0, return_index=True, return_inverse=True)
    normals = surface.quad_vectors(vertices[faces])
    return first, stack, np.where(np.sum(normals * normals[first[stack]], axis=1) < 0, -1, 1)


def _collapsed(faces: np.ndarray) -> np.ndarray:
    """Quadrilaterals of which two neighbouring corners are one, as triangles."""
    same = faces == np.roll(faces, -1, axis=1)
    shift = np.where(same.any(axis=1), same.argmax(axis=1) - 2, 0)
    return faces[np.arange(len(faces))[:, None], (np.arange(4) + shift[:, None]) % 4]


def oriented(
    vertices: np.ndarray, faces: np.ndarray, key: str, name: str
) -> tuple[np.ndarray, np.ndarray, np.ndarray, list[str]]:
    """Faces wound alike with normals out of the body, open edges (ne, 2), each face's part, notes of what was turned.

    Panels may meet along parts of their sides, with corners of one on a side of another. A part's volume is
    ∫ z n_z dS, which a rim at z = 0 leaves unchanged: inside out where it is negative.
    """
    pairs, owner = surface.cut_where_corners_lie(vertices, *surface.edges(faces))
    _, place, count = np.unique(np.sort(pairs, axis=1), axis=0, return_inverse=True, return_counts=True)
    if count.max() > 2:
        point = vertices[pairs[np.argmax(count[place] > 2), 0]]
        raise InputError(key, name, f"{count.max()} panels meet at an edge near {surface.point_text(point)}: two may")
    shared = surface.met_twice(place, count)
    turned, part = _consistent(len(faces), owner[shared], pairs[shared[:, 0], 0] == pairs[shared[:, 1], 0])
    if turned is None:
        raise InputError(key, name, "is a surface with one side only, so it encloses nothing")
    faces = np.where(turned[:, None], _reversed(faces), faces)
    corners = vertices[faces]
    inside_out = np.bincount(part, surface.column_volume(corners)) < 0
    faces = np.where(inside_out[part][:, None], _reversed(faces), faces)
    notes = [f"turned: {turned.sum()} panels wound against their neighbours"] if turned.any() else []
    notes += ["the mesh was inside out: its normals were turned into the water"] if inside_out.any() else []
    return faces, pairs[count[place] == 1], part, notes


def _reversed(faces: np.ndarray) -> np.ndarray:
    return surface.mirrored((np.zeros((1, 3)), faces), np.array([1.0, 1.0, -1.0]))[1]


def _consistent(count: int, neighbours: np.ndarray, against: np.ndarray) -> tuple[np.ndarray | None, np.ndarray]:
    """Faces to turn (count,) so that neighbours (n, 2) agree, None where no choice does; and each one's part."""
    a, b = neighbours.T if len(neighbours) else np.zeros((2, 0), int)
    parts, part = surface.connected(neighbours.reshape(-1, 2), count)
    turned = np.zeros(count, bool)
    if not against.any():
        return turned, part
    graph = scipy.sparse.coo_array((np.where(against, 2.0, 1.0), (a, b)), shape=(count, count)).tocsr()
    differs = graph.todok()
    for start in np.unique(part, return_index=True)[1]:
        sequence, before = scipy.sparse.csgraph.breadth_first_order(graph, start, directed=False)
        for face in sequence[1:]:
            other = before[face]
            turned[face] = turned[other] ^ (max(differs[face, other], differs[other, face]) > 1)
    # The fewer of each part are turned.
    many = np.bincount(part, turned, parts) > np.bincount(part, minlength=parts) / 2
    turned ^= many[part]
    agree = np.all((turned[a] ^ turned[b]) == against)
    return (turned if agree else None), part
