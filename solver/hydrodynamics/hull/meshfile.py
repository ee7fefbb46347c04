"""Panel meshes from the content of a file: STL, WAMIT's GDF, Nemoh's .dat, HydroStar's .hst, Wavefront's OBJ, and what
capytaine reads besides.

Every reader gives vertices (nv, 3) [m] and faces (nf, 4); a triangle gives one corner twice in a row.
Symmetry that a format declares is unfolded here. Nothing is judged: see `surface`.
"""

import io
import re
import struct
from collections.abc import Iterator
from contextlib import contextmanager

import numpy as np

from solver.errors import InputError
from solver.hydrodynamics.hull.surface import merged, mirrored
from solver.hydrodynamics.library import capytaine

FOOT = 0.3048  # [m]
FEET = (31.0, 33.0)  # gravity [ft/s²] of a GDF file whose lengths are feet
WORDS = ("pnl", "hams", "nemoh", "mar")  # formats that capytaine reads, text
# What moves no panel of HydroStar's: names, units of its output, and which panels are the body's that it has.
HEADER = ("PROJECT", "USER", "USERS", "REFLENGTH", "RHO", "GRAVITY", "NUMPANEL")
ROUNDING = 1e-12  # of a polygon's area: what its corners, as 64-bit numbers, span on a line
KEY = "hull.file"


def read(name: str, data: bytes) -> tuple[np.ndarray, np.ndarray]:
    """Vertices and faces of the file `name`, whose extension says how `data` is to be read."""
    kind = name.rpartition(".")[2].lower()
    if not data.strip():
        raise InputError(KEY, name, "is empty")
    try:
        vertices, faces = READERS.get(kind, _by_capytaine)(data, kind)
    except InputError:
        raise
    except (ValueError, IndexError, KeyError, AssertionError, OverflowError, struct.error) as error:
        raise InputError(KEY, name, f"is not a readable {kind} mesh: {error}") from None
    if not len(faces):
        raise InputError(KEY, name, "holds no panels")
    if not np.all(np.isfinite(vertices)):
        raise InputError(KEY, name, "has coordinates that are not finite numbers")
    if faces.min() < 0 or faces.max() >= len(vertices):
        raise InputError(KEY, name, "has panels with corners that are no points of it")
    return vertices, faces


def _stl(data: bytes, _kind: str) -> tuple[np.ndarray, np.ndarray]:
    """Triangles, binary (50 bytes each after a count) or in words."""
    count = struct.unpack_from("<I", data, 80)[0] if len(data) >= 84 else 0
    more = len(data) - 84 - 50 * count
    if more == 0 or (0 < more < 50 and b"facet" not in data.lower()):  # some writers pad what they write
        record = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attribute", "<u2")])
        corners = np.frombuffer(data, record, count, 84)["corners"].astype(float)
    else:
        number = r"\s+(\S+)"
        numbers = re.findall(r"vertex" + 3 * number, _text(data), re.IGNORECASE)
        if not numbers or len(numbers) % 3:
            raise ValueError(f"{len(numbers)} corners, three for each triangle are needed")
        corners = np.array(numbers, float).reshape(-1, 3, 3)
    faces = np.arange(corners.size // 3).reshape(-1, 3)
    return corners.reshape(-1, 3), faces[:, [0, 1, 2, 2]]


def _gdf(data: bytes, _kind: str) -> tuple[np.ndarray, np.ndarray]:
    """WAMIT, low order: title; ULEN GRAV; ISX ISY; count; four corners of each panel.

    ULEN only scales WAMIT's output; coordinates are lengths, in feet where GRAV is.
    """
    lines = _text(data).splitlines()
    gravity = float(lines[1].split()[1])
    isx, isy = (int(word) for word in lines[2].split()[:2])
    count = int(lines[3].split()[0])
    numbers = np.array(" ".join(lines[4:]).replace("D", "E").replace("d", "e").split(), float)
    if not {isx, isy} <= {0, 1}:
        raise ValueError(f"ISX = {isx}, ISY = {isy}: 0 or 1 is needed, for walls and B-splines are not known here")
    if numbers.size != 12 * count:
        raise ValueError(f"{numbers.size} coordinates, {count} panels need {12 * count}")
    unit = FOOT if FEET[0] < gravity < FEET[1] else 1.0
    faces = np.arange(4 * count).reshape(-1, 4)
    return _unfolded(numbers.reshape(-1, 3) * unit, faces, isx, isy)


def _nemoh(data: bytes, _kind: str) -> tuple[np.ndarray, np.ndarray]:
    """Nemoh: "2 symmetric"; number x y z up to a line that starts with 0; corners from 1, up to another."""
    rows = [line.split() for line in _text(data).splitlines() if line.strip()]
    ends = [i for i, row in enumerate(rows[1:], 1) if float(row[0]) == 0]
    vertices = np.array([row[1:4] for row in rows[1 : ends[0]]], float)
    faces = np.array([row[:4] for row in rows[ends[0] + 1 : ends[1] if len(ends) > 1 else None]], int) - 1
    return _unfolded(vertices, faces, 0, int(rows[0][1]))


def _hydrostar(data: bytes, _kind: str) -> tuple[np.ndarray, np.ndarray]:
    """HydroStar: a header; points, mostly numbered; corners of panels by those, in "TYPE 1" after the panel's own."""
    index: dict[int, int] = {}
    points: list[list[float]] = []
    faces: list[list[int]] = []
    planes, within, own = 0, "", 0
    for number, line in enumerate(_text(data).splitlines(), 1):
        with _told_of(number, line):
            match line.replace(":", " ").split():
                case ["ENDFILE", *_]:
                    break
                case ["COORDINATES" | "PANEL" as within, *kind]:
                    own = int(kind == ["TYPE", "1"])
                case ["ENDCOORDINATES" | "ENDPANEL"]:
                    within = ""
                case [*label, x, y, z] if within == "COORDINATES" and len(label) <= 1:
                    if index.setdefault(int(label[0]) if label else len(points) + 1, len(points)) < len(points):
                        raise ValueError("the same number again")
                    points.append([float(x), float(y), float(z)])
                case [*row] if within == "PANEL" and len(row) - own in (3, 4):
                    corners = [index[int(word)] for word in row[own:]]
                    faces.append([*corners, corners[-1]][:4])
                case [word, *values] if word not in HEADER and word[0] not in "#!":
                    planes = max(planes, _planes(word, values))
    return _unfolded(*_arrays(points, faces), planes == 2, planes > 0)


def _planes(word: str, values: list[str]) -> int:
    """How many planes of symmetry a line of HydroStar's header declares: y = 0, then x = 0."""
    match [word, *values]:
        case ["NBBODY", "1"] | ["SYMMETRY_BODY", "0", "1"]:  # the latter is BEMRosetta's for a whole body
            return 0
        case ["SYMMETRY", ("0" | "1" | "2") as planes] | ["SYMMETRY_BODY", "1", ("0" | "1" | "2") as planes]:
            return int(planes)
        case ["NBBODY", *_] | ["SYMMETRY_BODY", _, _]:
            raise ValueError("one body alone is known here, as number 1: a file of each is needed")
    raise ValueError(f"{word} with {len(values)} values is not known here")


def _obj(data: bytes, _kind: str) -> tuple[np.ndarray, np.ndarray]:
    """Wavefront: points "v x y z"; panels "f" by their numbers, from 1 or, negative, back from the last so far, and
    texture or normal after a slash. What else a line begins with moves no panel, but for curved surfaces and calls."""
    points: list[list[float]] = []
    faces: list[list[int]] = []
    for number, line in enumerate(_text(data).splitlines(), 1):
        with _told_of(number, line):
            match line.split():
                case ["v", x, y, z, *_]:
                    points.append([float(x), float(y), float(z)])
                case ["f", a, b, c, *more]:
                    corners = [_counted(int(word.split("/")[0]), len(points)) for word in (a, b, c, *more)]
                    faces += _parts(np.array(corners), np.array([points[i] for i in corners]))
                case ["v" | "f" | "surf" | "call" as word, *values]:
                    raise ValueError(f"{word} with {len(values)} values is not known here")
    return _arrays(points, faces)


def _arrays(points: list[list[float]], faces: list[list[int]]) -> tuple[np.ndarray, np.ndarray]:
    return np.array(points, float).reshape(-1, 3), np.array(faces, int).reshape(-1, 4)


def _counted(number: int, count: int) -> int:
    """From 0, of a corner counted from 1 or, negative, back from the last of `count` points."""
    if not 1 <= abs(number) <= count:
        raise KeyError(number)
    return number - 1 if number > 0 else count + number


def _parts(labels: np.ndarray, corners: np.ndarray) -> list[list[int]]:
    """A polygon (n,) of corners (n, 3) as panels of four: one of more corners in triangles, cut off one by one where
    they jut out and hold no other corner (ears), the shortest cut first, which leaves the fewest slivers."""
    if len(labels) <= 4:
        return [[*labels, labels[-1]][:4]]
    parts = []
    while len(labels) > 3:
        before, after = np.roll(corners, 1, axis=0), np.roll(corners, -1, axis=0)
        normal = np.cross(corners, after).sum(axis=0)  # twice the area
        least = ROUNDING * normal @ normal
        juts = np.cross(corners - before, after - corners) @ normal > least
        for i in np.argsort(np.linalg.norm(after - before, axis=1)):
            ear = np.array([before[i], corners[i], after[i]])
            others = corners[~np.any(np.all(corners[:, None] == ear, axis=2), axis=1)]
            sides = np.cross(np.roll(ear, -1, axis=0) - ear, others[:, None] - ear) @ normal  # of each corner left
            if juts[i] and not np.any(np.all(sides >= -least, axis=1)):
                break
        else:
            raise ValueError("has no area, or its sides cross")
        parts.append([labels[i - 1], labels[i], *[labels[(i + 1) % len(labels)]] * 2])
        labels, corners = np.delete(labels, i), np.delete(corners, i, axis=0)
    return [*parts, [*labels, labels[-1]]]


@contextmanager
def _told_of(number: int, line: str) -> Iterator[None]:
    """What is wrong in a line names it."""
    try:
        yield
    except KeyError as error:
        raise ValueError(f"line {number}: {error} is no point before it") from None
    except ValueError as error:
        raise ValueError(f"line {number}, {line.strip()!r}: {error}") from None


def _by_capytaine(data: bytes, kind: str) -> tuple[np.ndarray, np.ndarray]:
    """HAMS's files; with meshio or trimesh installed also theirs."""
    stream = io.StringIO(_text(data)) if kind in WORDS else io.BytesIO(data)
    try:
        mesh = capytaine().load_mesh(stream, file_format=kind).merged()
    except ValueError as error:
        if "nsupported mesh format" not in str(error):
            raise
        known = (
            "known are stl, gdf, dat, hst, obj, pnl; what meshio reads, too, once it is installed: pip install meshio"
        )
        raise ValueError(known) from None
    return np.asarray(mesh.vertices, float), np.asarray(mesh.faces, int)


READERS = {"stl": _stl, "gdf": _gdf, "dat": _nemoh, "hst": _hydrostar, "obj": _obj}


def _text(data: bytes) -> str:
    return data.decode("utf-8-sig", errors="replace")


def _unfolded(vertices: np.ndarray, faces: np.ndarray, x: int, y: int) -> tuple[np.ndarray, np.ndarray]:
    """The surface with its images in the planes x = 0 and y = 0."""
    whole = (vertices, faces)
    for unfold, sign in ((x, [-1, 1, 1]), (y, [1, -1, 1])):
        if unfold:
            whole = merged([whole, mirrored(whole, np.array(sign, float))])
    return whole
