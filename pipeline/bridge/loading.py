"""From a study file to a checked study, or to one clear message."""

from __future__ import annotations

from pathlib import Path

from pipeline.bridge import checks
from pipeline.study.reading import StudyError, parsed
from pipeline.tasks.study import Study


def load(path: Path) -> Study:
    """Read and check a study file; raise StudyError."""
    content, bases = parsed(path)
    if problems := checks.problems(content, based=bool(bases)):
        raise StudyError(path, map(str, problems))
    return Study(path=path, content=content, bases=bases)
