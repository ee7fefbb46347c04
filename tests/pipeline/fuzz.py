"""Random study files, made from those in studies/: never a traceback, always a message that names a key.

python tests/pipeline/fuzz.py [FILES] [SEED]
"""

from __future__ import annotations

import copy
import json
import math
import random
import re
import sys
import tempfile
from collections.abc import Iterator
from pathlib import Path

from pipeline.bridge import preflight
from pipeline.bridge.engine import Engine
from pipeline.bridge.geometry import geometry_of
from pipeline.bridge.loading import load
from pipeline.study.reading import StudyError, read
from pipeline.tasks.task import expand

STUDIES = sorted((Path(__file__).parents[2] / "studies").glob("*.toml"))
# Tables and keys that no study of the project has; a few of them go into every random file.
MORE = {
    "sea_states": {
        "still": {"kind": "still"},
        "regular": {"kind": "regular", "height": 0.5, "period": 6.0, "phase": 0.1},
        "noise": {"kind": "white-noise", "Hs": 0.2},
        "jonswap": {"Hs": 0.5, "Tp": 5.0, "spectrum": "jonswap", "gamma": 2.0},
        "mean": {"Hs": 0.5, "Tp": 5.0, "form": "mean"},
        "spectrum": {"kind": "spectrum", "file": "spectrum.csv"},
        "components": {"kind": "components", "file": "components.csv"},
        "elevation": {"kind": "elevation", "file": "elevation.csv"},
    },
    "floats": {
        "motion": ["surge", "heave", "pitch"],
        "axis": [0.1, 1.0, 0.0],
        "damping": [1e3, 0.0, 1e4],
        "quadratic_damping": 10.0,
        "stiffness": [1e4, 0.0, 0.0],
        "preload": [100.0, 0.0, 0.0],
        "coulomb": [0.0, 500.0, 0.0],
        "force_limit": [1e4, 1e4, 1e5],
        "one_way": [0.0, 1.0, 0.0],
        "end_stops": {"lower": -1.0, "upper": [0.5, 1.0, 0.5], "stiffness": [1e6, 0.0, 0.0], "damping": 0.0},
        "mechanism_inertia": 100.0,
        "offset": [0.0, 0.5, 0.1],
    },
    "record": {"rao": True, "series": "decimated"},
}
CSV = {
    "spectrum.csv": "omega [rad/s], S\n0.5, 0.0\n1.0, 0.1\n3.0, 0.0\n",
    "components.csv": "frequency [Hz], amplitude, phase [deg]\n0.2, 0.1, 30\n0.25, 0.05, 0\n",
    "elevation.csv": "time, elevation\n" + "".join(f"{0.5 * t},{0.1 * math.cos(0.6 * t)}\n" for t in range(200)),
}


def deep(levels: int) -> object:
    """Lists in tables in lists."""
    value: object = 1
    for level in range(levels):
        value = [value] if level % 2 else {"a": value}
    return value


JUNK = (
    *(0, -1, 1, 10**9, 2**63, -(2**70), 10**400, 0.0, -0.0, 1e-300, 1e300, -1e9, math.nan, math.inf, -math.inf),
    *(5e-324, 1e-20, 1e-9, 1e9, 1e20, -1e20, 1e308, -1e308, [1e20, -1e20, 1e20], [1e-20, 1e-20, 1e-20]),
    *(
        "",
        " ",
        "a",
        "..",
        "/dev/zero",
        "/",
        "random.toml",
        "-x",
        "\x1b[31m",
        "\ud7ff",
        "1e400",
        "2019-13-45",
        "é\u202e",
        "x" * 5000,
        "[red]",
        "{}",
        "%s",
        "\x00",
        "hinge:front",
        "elastic",
        "tube",
        True,
        False,
    ),
    *(deep(30), deep(150), ["a", "a"], [0, 0], list(range(3000)), {str(i): {} for i in range(3000)}),
    *([], {}, [[]], [{}], [1, 2, 3], [0.0, 0.0, 0.0], ["a"], {"a": 1}, {"shape": "cube"}, {"shape": []}, [None]),
)
FILES = {name: text.encode() for name, text in CSV.items()}
FILES |= {path.name: path.read_bytes() for path in (*STUDIES, *STUDIES[0].parent.glob("*.gdf"))}
# A key and what is said of it, or the place of a mistake in the TOML.
NAMED = re.compile(r"^\S+\.toml: (.* = .*: .+|\S+: is missing.*|is not .+)", re.S)


def places(data: object, path: tuple = ()) -> Iterator[tuple]:
    """Paths to everything inside."""
    items = data.items() if isinstance(data, dict) else enumerate(data) if isinstance(data, list) else ()
    for key, value in items:
        yield (*path, key)
        yield from places(value, (*path, key))


def mutate(data: dict, dice: random.Random) -> None:
    """One change: replace, scale, remove, rename, double or swap."""
    path = dice.choice(list(places(data)))
    holder = data
    for key in path[:-1]:
        holder = holder[key]
    key, how = path[-1], dice.choice(("replace", "replace", "scale", "remove", "rename", "double", "swap"))
    if how == "replace":
        holder[key] = copy.deepcopy(dice.choice(JUNK))
    elif how == "scale" and type(holder[key]) in (int, float):
        holder[key] *= dice.choice((-1, 1e-6, 0.5, 3, 1e6))
    elif how == "remove":
        del holder[key]
    elif how == "rename" and isinstance(holder, dict):
        holder[dice.choice((str(key) + "s", str(key)[1:], "", "é", "x.y"))] = holder.pop(key)
    elif how == "double" and isinstance(holder, list):
        holder.append(holder[key])
    elif how == "swap":
        other = dice.choice(list(holder) if isinstance(holder, dict) else range(len(holder)))
        holder[key], holder[other] = holder[other], holder[key]


def toml(value: object) -> str:
    """A value as TOML, tables inline."""
    if isinstance(value, dict):
        return "{" + ", ".join(f"{json.dumps(str(k))} = {toml(v)}" for k, v in value.items()) + "}"
    if isinstance(value, list):
        return "[" + ", ".join(map(toml, value)) + "]"
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, float):
        return "nan" if math.isnan(value) else ("inf" if value > 0 else "-inf") if math.isinf(value) else repr(value)
    return json.dumps(value) if not isinstance(value, int) else str(value)


def spoil(text: bytes, dice: random.Random) -> bytes:
    """A few bytes changed, lost or doubled."""
    data = bytearray(text)
    for _ in range(dice.randint(1, 3)):
        at = dice.randint(0, len(data))  # of a file of which nothing is left, too
        how = dice.randrange(3)
        if how == 0:
            data[at : at + 1] = bytes([dice.randrange(256)])
        elif how == 1:
            del data[at : at + dice.randint(1, 40)]
        else:
            data[at:at] = data[at : at + dice.randint(1, 200)]
    return bytes(data)


def enrich(data: dict, dice: random.Random) -> None:
    """Some of what the project's studies do without."""
    for table, keys in MORE.items():
        places = data.get(table, {}) if table != "floats" else dice.choice(data.get("floats") or [{}])
        for key in dice.sample(sorted(keys), dice.randint(0, len(keys))):
            places[key] = copy.deepcopy(keys[key])
        if table != "floats":
            data[table] = places


def write_files(folder: Path, dice: random.Random) -> None:
    """The files that seas, hulls and bases are in, sometimes spoilt."""
    for name, data in FILES.items():
        (folder / name).write_bytes(spoil(data, dice) if dice.random() < 0.3 else data)


def one(path: Path, dice: random.Random, engine: Engine) -> str:
    """Write, load and plan one random study; what came of it. Anything but StudyError is a bug."""
    study = dice.choice(STUDIES)
    write_files(path.parent, dice)
    if dice.random() < 0.2:
        header = ".".join("a" * dice.choice((2, 25, 1000)))
        path.write_bytes(spoil(study.read_bytes(), dice) + dice.choice((b"", f"\n[{header}]\nb = 1\n".encode())))
    else:
        data = read(study)
        if dice.random() < 0.6:
            enrich(data, dice)
        for _ in range(dice.randint(1, 3)):
            mutate(data, dice)
        text = "\n".join(f"{json.dumps(k)} = {toml(v)}" for k, v in data.items())
        path.write_text(dice.choice(("", "", "\ufeff")) + text, encoding="utf-8")
    try:
        study = load(path)
        tasks = list(expand(study.content))
        preflight.judge(study, tasks, engine)
        assert all(task.id and geometry_of(task.parameters) is not False for task in tasks[:20])
    except StudyError as error:
        for problem in error.problems:
            assert NAMED.match(problem), f"names no key: {problem!r}"
        return "refused"
    return "accepted"


def files(folder: Path, count: int, seed: int) -> dict[str, int]:
    """So many; how many were refused."""
    counts = {"refused": 0, "accepted": 0}
    # Frames take 0.4 s each to reduce; scenes are built all the same.
    engine = Engine(reduce=lambda _: None)
    for number in range(count):
        dice = random.Random(f"{seed}-{number}")
        try:
            counts[one(folder / "random.toml", dice, engine)] += 1
        except BaseException:
            print(f"file {number} of seed {seed}:\n{(folder / 'random.toml').read_bytes()[-3000:]!r}", file=sys.stderr)
            raise
    return counts


if __name__ == "__main__":
    count, seed = map(int, (*sys.argv[1:], *("2000", "0")[len(sys.argv) - 1 :]))
    with tempfile.TemporaryDirectory() as folder:
        print(files(Path(folder), count, seed), "no traceback, every message names a key")
