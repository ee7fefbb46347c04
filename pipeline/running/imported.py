"""What workers need before their first step: imported by the process that they are forked from."""

from importlib import import_module

from pipeline import environment
from pipeline.bridge import engine

with environment.importing():
    for name in ("distributed", "pipeline.cli.cli", "scipy.io"):
        import_module(name)
engine.import_solver()
