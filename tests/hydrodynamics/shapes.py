"""Meshes of simple shapes, and files that hold them."""

import itertools
import struct

import numpy as np

from solver.hydrodynamics.hull import meshfile
from solver.hydrodynamics.hull.panel_hull import PanelHull
from solver.hydrodynamics.hull.revolution import Revolution
from solver.hydrodynamics.hull.surface import split, triangles
from solver.reference.panels import revolution_mesh


def box(size, centre=(0, 0, 0)):
    """Vertices and faces of a closed box, six quadrilaterals with normals outwards."""
    corner = np.array(list(itertools.product((-0.5, 0.5), repeat=3))) * size + centre
    return corner, np.array([[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]])


def bowl(points, *, radius=3.0, draft=4.0):
    """Half an ellipse through so many points, under an upright wall."""
    angle = np.linspace(0, np.pi / 2, points)[:-1]
    line = np.column_stack([radius * np.sin(angle), -draft * np.cos(angle)])
    return Revolution.profile([*line, (radius, 0.0), (radius, 2.0)])


def read(name, content):
    """The hull in a file's content, bytes or text."""
    data = content if isinstance(content, bytes) else content.encode()
    return PanelHull.of(*meshfile.read(name, data), name=name)


def loose(panels):
    """Vertices and faces of panels (n, 4, 3)."""
    faces, flat = np.arange(4 * len(panels)).reshape(-1, 4), np.all(panels[:, 2] == panels[:, 3], axis=1)
    faces[flat, 3] = faces[flat, 2]
    return panels.reshape(-1, 3), faces


def fine_box(size, centre, length):
    vertices, faces = box(size, centre)
    return PanelHull.of(*loose(split(vertices[faces], length)))


def graded_box(size, length):
    """A box half under water, there with panels that are narrow at its edges: sines of even ones of some length."""
    even, half = fine_box(size, (0, 0, 0), length), np.array(size) / [2, 2, 4]
    middle = np.array([0.0, 0.0, -half[2]])
    narrow = middle + half * np.sin(np.pi / 2 * np.clip((even.vertices - middle) / half, -1, 1))
    return PanelHull.of(np.where(even.vertices[:, 2:] < 1e-9, narrow, even.vertices), even.faces)


def meshed(hull: Revolution, along: int) -> PanelHull:
    return PanelHull.of(*revolution_mesh(hull, along=along, around=2 * along))


def stl(panels, *, text=False):
    corners = triangles(panels)
    if text:
        rows = (" ".join(f"vertex {x:.9e} {y:.9e} {z:.9e}" for x, y, z in t) for t in corners)
        facets = (f"facet normal 0 0 0 outer loop {r} endloop endfacet" for r in rows)
        return "\n".join(["solid a", *facets, "endsolid a"])
    record = (struct.pack("<12fH", 0, 0, 0, *t.ravel(), 0) for t in corners)
    head = b"solid, as some programs begin binary files too".ljust(80)
    return head + struct.pack("<I", len(corners)) + b"".join(record)


def gdf(panels, *, isx=0, isy=0, gravity=9.80665, unit=1.0):
    rows = (" ".join(f"{x:.9f}" for x in p.ravel() / unit) for p in panels)
    return f"a title\n 1.0 {gravity} ULEN GRAV\n {isx} {isy} ISX ISY\n {len(panels)}\n" + "\n".join(rows)


def nemoh(vertices, faces, *, symmetric=0):
    points = (f"{i} {x:.9f} {y:.9f} {z:.9f}" for i, (x, y, z) in enumerate(vertices, 1))
    corners = (" ".join(map(str, f + 1)) for f in faces)
    return "\n".join([f"2 {symmetric}", *points, "0 0. 0. 0.", *corners, "0 0 0 0", ""])


def hst(vertices, faces, *, header="NBBODY 1", first=1):
    points = "\n".join(f"{i} {x:.9f} {y:.9f} {z:.9f}" for i, (x, y, z) in enumerate(vertices, first))
    corners = "\n".join(" ".join(map(str, [i, *(f + first)])) for i, f in enumerate(faces, 1))
    return f"{header}\nCOORDINATES\n{points}\nENDCOORDINATES\nPANEL TYPE 1\n{corners}\nENDPANEL\nENDFILE\n"


def obj(vertices, faces):
    points = "\n".join(f"v {x:.9f} {y:.9f} {z:.9f}" for x, y, z in vertices)
    return points + "\n" + "\n".join(" ".join(map(str, ["f", *(f + 1)])) for f in faces)
