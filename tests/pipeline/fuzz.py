"""Random study files, made from studies/buan.toml: never a traceback, always a message that names a key.

python tests/pipeline/fuzz.py [FILES] [SEED]
"""

from __future__ import annotations

import json
import math
import random
import re
import sys
import tempfile
from collections.abc import Iterator
from pathlib import Path

from pipeline import preflight
from pipeline.run import Engine
from pipeline.study import StudyError, load, read
from pipeline.tasks import expand

BUAN = Path(__file__).parents[2] / "studies" / "buan.toml"
JUNK = (
    *(0, -1, 1, 2**63, -(2**70), 10**400, 0.0, -0.0, 1e-300, 1e300, -1e9, math.nan, math.inf, -math.inf),
    *("", " ", "a", "é\u202e", "x" * 5000, "[red]", "{}", "%s", "\x00", "hinge:front", "elastic", "tube", True, False),
    *([], {}, [[]], [{}], [1, 2, 3], [0.0, 0.0, 0.0], ["a"], {"a": 1}, {"shape": "cube"}, {"shape": []}, [None]),
)
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
        holder[key] = dice.choice(JUNK)
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
        at = dice.randrange(len(data))
        how = dice.randrange(3)
        if how == 0:
            data[at] = dice.randrange(256)
        elif how == 1:
            del data[at : at + dice.randint(1, 40)]
        else:
            data[at:at] = data[at : at + dice.randint(1, 200)]
    return bytes(data)


def one(path: Path, dice: random.Random, engine: Engine) -> str:
    """Write, load and plan one random study; what came of it. Anything but StudyError is a bug."""
    if dice.random() < 0.2:
        path.write_bytes(spoil(BUAN.read_bytes(), dice))
    else:
        data = read(BUAN)
        for _ in range(dice.randint(1, 3)):
            mutate(data, dice)
        path.write_text("\n".join(f"{json.dumps(k)} = {toml(v)}" for k, v in data.items()), encoding="utf-8")
    try:
        study = load(path)
        tasks = list(expand(study.content))
        assert all(task.id and task.geometry is not False for task in tasks[:20])
        preflight.check(study, tasks, engine)
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
