"""Study files to start from, with comments; each runs as it is."""

from __future__ import annotations

import shlex
from pathlib import Path
from typing import Literal

from pipeline.study.reading import StudyError, check_name

STARTERS = Path(__file__).with_name("starters")
Kind = Literal["buan", "sphere", "floating", "mesh"]
MESH = "mesh.gdf"


def write(path: Path, kind: Kind) -> list[Path]:
    """The study file and what it needs beside it; StudyError where something is there already."""
    check_name(path)
    text = (STARTERS / f"{kind}.toml").read_text(encoding="utf-8")
    mesh = path.with_suffix(".gdf")
    made = {path: text.replace("{name}.toml", shlex.quote(path.name)).replace("{mesh}", mesh.name).encode()}
    if kind == "mesh":
        made[mesh] = (STARTERS / MESH).read_bytes()
    if there := [each for each in made if each.exists() or each.is_symlink()]:
        raise StudyError(path, [f"NAME = {path.stem}: {there[0]} is there already, and is not written over"])
    path.parent.mkdir(parents=True, exist_ok=True)
    for each, data in made.items():
        with each.open("xb") as file:
            file.write(data)
    return list(made)
