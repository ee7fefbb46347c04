"""What workers need before their first step: imported by the process that they are forked from."""

from importlib import import_module

from pipeline import environment

NAMES = (
    "distributed", "solver.run", "pipeline.bridge.scenes", "pipeline.bridge.cache", "pipeline.results.records",
    "pipeline.cli.cli",
)  # fmt: skip

with environment.importing():
    for name in NAMES:
        import_module(name)
