"""A checked study: where it came from, what is in it, and its tasks."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

from pipeline.study.schema import StudyFile
from pipeline.tasks.tasklist import Tasks


@dataclass(frozen=True, kw_only=True)
class Study:
    """A checked study and where it came from."""

    path: Path
    content: StudyFile
    bases: tuple[Path, ...] = ()  # the files that it stands on, nearest first

    @property
    def published(self) -> Path | None:
        """The published numbers beside the file, or beside the nearest base that has some."""
        tables = (path.with_name(f"{path.stem}-published.csv") for path in (self.path, *self.bases))
        return next((table for table in tables if table.exists()), None)

    @property
    def name(self) -> str:
        """The file's stem; it names the results folder."""
        return self.path.stem

    @cached_property
    def tasks(self) -> Tasks:
        """The tasks in all its cells; cells may share one."""
        return Tasks.of(self.content)
