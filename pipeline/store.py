"""Results on disk: results/<study>/tasks/<id>/{parameters.json, record.nc, status.json}.

A file appears whole or not at all. status.json is written last and carries the checksum of the
record, so a task is done when its status says so and its record still has that checksum.
"""

from __future__ import annotations

import contextlib
import hashlib
import json
import os
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal

from filelock import FileLock, Timeout

from pipeline.tasks import Task

State = Literal["done", "failed", "missing", "stale", "damaged"]


@dataclass(frozen=True, kw_only=True)
class Entry:
    """What the disk knows of a task."""

    state: State
    folder: Path
    status: dict[str, Any]

    @property
    def record(self) -> Path:
        """The task's record; there is one only if it is done or stale."""
        return self.folder / "record.nc"


def write_atomic(path: Path, data: bytes) -> None:
    """Write to a temporary name beside `path`, flush to the disk, rename: a crash leaves old or new."""
    part = path.with_name(f".{path.name}.{os.getpid()}.part")
    try:
        with part.open("wb") as file:
            file.write(data)
            file.flush()
            os.fsync(file.fileno())
        os.replace(part, path)
    except BaseException:
        with contextlib.suppress(OSError):
            part.unlink(missing_ok=True)
        raise
    sync_folder(path.parent)


def sync_folder(folder: Path) -> None:
    """Make renames and removals in a folder durable."""
    descriptor = os.open(folder, os.O_RDONLY)
    try:
        os.fsync(descriptor)
    finally:
        os.close(descriptor)


def write_json(path: Path, data: object) -> None:
    """A JSON file, indented for people."""
    write_atomic(path, (json.dumps(data, indent=1, allow_nan=False) + "\n").encode())


def read_json(path: Path) -> dict[str, Any] | None:
    """The content of a JSON file, None if it is not there or not whole."""
    try:
        data = json.loads(path.read_bytes())
    except (OSError, ValueError):
        return None
    return data if isinstance(data, dict) else None


class Store:
    """The tasks folder of one study."""

    def __init__(self, results: Path, study: str):
        self.root = results / study
        self.tasks = self.root / "tasks"

    def folder(self, task_id: str) -> Path:
        """Where a task's files are."""
        return self.tasks / task_id

    def look(self, task: Task, *, checksums: bool = False) -> Entry:
        """The state of a task from its files; `checksums` reads the record as well."""
        entry = self._look(task.id, checksums)
        if entry.state == "missing":
            for older in task.older_ids:
                past = self._look(older, checksums)
                if past.state == "done":
                    return Entry(state="stale", folder=past.folder, status=past.status)
        return entry

    def _look(self, task_id: str, checksums: bool) -> Entry:
        folder = self.folder(task_id)
        status = read_json(folder / "status.json") or {}
        state: State = {"done": "done", "failed": "failed"}.get(status.get("state", ""), "missing")  # type: ignore[assignment]
        if state == "done" and not self._whole(folder / "record.nc", status, checksums):
            state = "damaged"
        return Entry(state=state, folder=folder, status=status)

    @staticmethod
    def _whole(record: Path, status: dict[str, Any], checksums: bool) -> bool:
        try:
            if record.stat().st_size != status.get("bytes"):
                return False
            return not checksums or sha256(record.read_bytes()) == status.get("sha256")
        except OSError:
            return False

    def begin(self, task: Task) -> Path:
        """Make the folder and write the parameters; an older outcome is withdrawn first."""
        folder = self.folder(task.id)
        if not folder.is_dir():
            folder.mkdir(parents=True)
        status = folder / "status.json"
        if status.exists():
            status.unlink()
            sync_folder(folder)
        described = {"id": task.id, "model_version": task.version, "labels": dict(task.labels)}
        write_json(
            folder / "parameters.json",
            described | {"parameters": json.loads(task.parameters.canonical())},
        )
        return folder

    def done(self, task: Task, record: bytes, status: dict[str, Any]) -> None:
        """Keep a task's record; the status, written last, makes it count."""
        folder = self.begin(task)
        write_atomic(folder / "record.nc", record)
        write_json(
            folder / "status.json",
            {"state": "done", "id": task.id, "model_version": task.version, "bytes": len(record)}
            | {"sha256": sha256(record), "finished": timestamp()}
            | status,
        )

    def failed(self, task: Task, status: dict[str, Any]) -> None:
        """Keep why a task failed."""
        folder = self.begin(task)
        head = {
            "state": "failed",
            "id": task.id,
            "model_version": task.version,
            "finished": timestamp(),
        }
        write_json(folder / "status.json", head | status)

    @contextlib.contextmanager
    def lock(self, waiting: Callable[[str], None]) -> Iterator[None]:
        """One writer for a study. The lock dies with its process, so a killed run leaves none behind."""
        self.root.mkdir(parents=True, exist_ok=True)
        lock, holder = FileLock(self.root / ".lock"), self.root / ".lock.json"
        try:
            lock.acquire(timeout=0)
        except Timeout:
            who = read_json(holder) or {}
            waiting(
                f"{self.root} is in use by process {who.get('pid', '?')} on {who.get('host', '?')} "
                f"since {who.get('since', '?')}; waiting, and then doing what it leaves undone"
            )
            lock.acquire()
        try:
            host = os.uname().nodename
            write_json(holder, {"pid": os.getpid(), "host": host, "since": timestamp()})
            yield
        finally:
            with contextlib.suppress(OSError):
                holder.unlink(missing_ok=True)
            lock.release()


def sha256(data: bytes) -> str:
    """Checksum of a file's bytes."""
    return hashlib.sha256(data).hexdigest()


def timestamp() -> str:
    """Now, UTC, ISO 8601."""
    return time.strftime("%Y-%m-%dT%H:%M:%SZ", time.gmtime())
