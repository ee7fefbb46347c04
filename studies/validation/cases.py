"""Scenes of the study files beside this folder."""

from pathlib import Path

from pipeline.bridge import scenes
from pipeline.bridge.loading import load
from pipeline.tasks.task import expand
from solver.scene import Scene


def scene(name: str, **labels) -> Scene:
    """The first task of studies/NAME.toml with these labels."""
    content = load(Path(__file__).parents[1] / f"{name}.toml").content
    task = next(t for t in expand(content) if all(t.labels[k] == v for k, v in labels.items()))
    return scenes.scene(task.parameters)


def buan(platform: str) -> Scene:
    """The Buan study's first realization of the representative sea on one of its platforms."""
    return scene("buan", sea_state="representative", platform=platform, seed=0)
