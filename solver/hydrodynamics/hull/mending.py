"""Meshes as files have them made surfaces: points that coincide made one, copies left out, panels wound alike."""

import numpy as np
import scipy  # sparse is slow to import, and the command line needs scenes but rarely meshes

from solver.errors import InputError
from solver.hydrodynamics.hull import surface


def welded(vertices: np.ndarray, faces: np.ndarray) -> tuple[np.ndarray, np.ndarray, list[str]]:
    """Coinciding points made one, panels without area and duplicates left out; and notes of both."""
    extent = np.ptp(vertices[faces.ravel()], axis=0).max()
    vertices, faces = surface.one_each(vertices, faces)
    faces = _collapsed(faces)
    flat = surface.areas(vertices[faces]) <= (surface.WELD * extent) ** 2 / 2
    _, kept = np.unique(_corners(faces), axis=0, return_index=True)
    twice = np.ones(len(faces), bool)
    twice[kept] = False
    counts = [(flat.sum(), "without area"), ((twice & ~flat).sum(), "given twice")]
    return vertices, faces[~(flat | twice)], [f"left out: {n} panels {what}" for n, what in counts if n]


def _corners(faces: np.ndarray) -> np.ndarray:
    """Of each panel, in order, whichever it begins at and however it is wound: three and -1 of triangles."""
    triangle = (faces[:, 2] == faces[:, 3])[:, None]
    return np.sort(np.where(triangle & (np.arange(4) == 3), -1, faces), axis=1)


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
    order = np.argsort(place, kind="stable")
    shared = order[count[place[order]] == 2].reshape(-1, 2)
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
