"""Results on disk: results/<study>/tasks/<id>/{record.nc, status.json}, or many short tasks together, see packs.

A file appears whole or not at all. status.json is written last and carries the checksum of the
record and the task's id, so a task is done when its status says so, has its id and was not copied
from elsewhere, and its record still has that checksum. Besides, it has the task's parameters, labels
and provenance; a failed task has it alone. A task's own folder goes before a pack.
"""

from __future__ import annotations

import contextlib
import ctypes
import hashlib
import json
import os
import secrets
import shlex
import shutil
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, Literal

from filelock import FileLock, Timeout

from pipeline.results import packs
from pipeline.results.netcdf import Variable, from_bytes
from pipeline.results.packs import Made, Packs, Place, Row
from pipeline.results.status import Status, read_json, read_status
from pipeline.study.reading import StudyError
from pipeline.tasks.task import Task

CONTAINER = secrets.token_hex(4)  # two that share a folder may number processes alike; forked ones differ by number
LEFT = 3600.0  # a part to which nothing is written for so long is a killed run's [s]
MANY = 4  # files from which on one flush of the file system is sooner done than one for each
_syncfs = getattr(ctypes.CDLL(None, use_errno=True), "syncfs", None)  # Linux alone has it

State = Literal["done", "failed", "missing", "stale", "damaged"]
UNFINISHED = ("missing", "damaged")  # what a run has to do; failed and stale tasks wait until they are asked for


@dataclass(frozen=True, kw_only=True)
class Entry:
    """What the disk knows of a task."""

    state: State
    folder: Path
    status: Status
    place: Place | None = None  # among others, in a pack

    @property
    def record(self) -> Path:
        """The file with the task's record; there is one only if it is done or stale."""
        return self.place.records if self.place else self.folder / "record.nc"

    def made(self) -> Made:
        """The task's record; raises OSError or ValueError unless it is whole."""
        if self.place:
            return self.place.record()
        data = self.record.read_bytes()
        if sha256(data) != self.status.sha256:
            raise ValueError("the record is not what was written")
        return from_bytes(data)

    @property
    def unmet(self) -> str:
        """What was asked of its record and not met, in a sentence; empty if there is none."""
        return self.status.unmet if self.state in ("done", "stale") else ""

    @property
    def warnings(self) -> str:
        """What is odd about its record, in sentences; empty if nothing is."""
        return self.status.warnings if self.state in ("done", "stale") else ""

    @property
    def failure(self) -> str:
        """Why it failed; empty if it did not."""
        error = self.status.error if self.state == "failed" else None
        return f"{error.kind}: {error.message}" if error else ""


def together(entries: Sequence[Entry]) -> Mapping[str, Variable]:
    """Variables of the records of one file, with the dimension `task` where several differ; raises as `made` does."""
    places = [entry.place for entry in entries if entry.place]
    return packs.together(places) if places else entries[0].made()[0]


def _holds(folder: Path) -> bool:
    """Whether there is anything in a folder."""
    try:
        with os.scandir(folder) as inside:
            return next(inside, None) is not None
    except OSError:
        return False


@contextlib.contextmanager
def appearing(path: Path) -> Iterator[Path]:
    """A temporary name beside `path` to write to; then flush to the disk and rename: old or new, never half."""
    part = _partial(path)
    try:
        yield part
        flush([part], path.parent)
        settle(part, path)
    except BaseException as error:
        with contextlib.suppress(OSError):
            part.unlink(missing_ok=True)
        if isinstance(error, OSError) and error.strerror and error.filename in (None, str(part)):
            error.filename = str(path)
        raise


def settle(part: Path, path: Path) -> None:
    """Give a finished file its name, whatever had it."""
    if path.is_dir():
        remove(path)
    os.replace(part, path)


def remove(path: Path) -> None:
    """A file, or a folder with all that is in it, if there is one."""
    if path.is_dir() and not path.is_symlink():
        shutil.rmtree(path)
    else:
        path.unlink(missing_ok=True)


def write_atomic(path: Path, data: bytes) -> None:
    """A whole file, or none."""
    with appearing(path) as part:
        part.write_bytes(data)


def _partial(path: Path) -> Path:
    return path.with_name(f".{path.name}.{os.getpid()}-{CONTAINER}.part")


def leftovers(folder: Path) -> Iterator[Path]:
    """What killed runs have left half written; not what others, with a lock or without, may be writing now."""
    for part in folder.glob(".*.part"):
        with contextlib.suppress(FileNotFoundError):  # it has got its name meanwhile
            if time.time() - part.stat().st_mtime > LEFT:
                yield part


def _part(path: Path, data: bytes) -> tuple[Path, Path]:
    part = _partial(path)
    try:
        part.write_bytes(data)
    except BaseException:
        with contextlib.suppress(OSError):
            part.unlink(missing_ok=True)
        raise
    return part, path


def flush(paths: Sequence[Path], folder: Path) -> None:
    """Make files durable: one by one, or many by one flush of the file system that `folder` is on."""
    many = len(paths) > MANY and _syncfs is not None
    for path in [folder] if many else paths:
        descriptor = os.open(path, os.O_RDONLY)
        try:
            if not (many and _syncfs):
                os.fsync(descriptor)
            elif _syncfs(descriptor):
                raise OSError(ctypes.get_errno(), os.strerror(ctypes.get_errno()), str(folder))
        finally:
            os.close(descriptor)


def _described(task: Task, status: dict[str, Any], parameters: dict[str, Any]) -> bytes:
    """The content of status.json."""
    head = {"id": task.id, "model_version": task.version, "finished": timestamp()}
    text = json.dumps(head | status | {"parameters": parameters}, allow_nan=False, ensure_ascii=False)
    return (text + "\n").encode("utf-8", "replace")  # an error's message may hold bytes that are no text


def _estimating(task: Task) -> dict[str, Any]:
    """What estimates of time need of a task's parameters; a pack has all of them with its records."""
    return task.parameters.model_dump(include={"record": {"duration", "discard"}, "solver": {"method"}})


def write_json(path: Path, data: object) -> None:
    """A JSON file, indented for people."""
    write_atomic(path, (json.dumps(data, indent=1, allow_nan=False) + "\n").encode())


class Store:
    """The tasks folder of one study."""

    def __init__(self, results: Path, study: str):
        self.results = results
        self.root = results / study
        self.tasks = self.root / "tasks"
        self.packs = Packs(self.root / "packs")
        self._of: set[int] = set()  # model versions of tasks' folders that have been read
        self._read: set[str] = set()  # which, and which had no outcome yet
        self._unread: set[str] = set()
        self._changed = -1

    def command(self, verb: str, study: Path, *words: str) -> str:
        """What to type about a study whose results are here."""
        where = [] if self.results == Path("results") else ["--results", str(self.results)]
        return shlex.join(["study", verb, str(study), *words, *where])

    def folder(self, task_id: str) -> Path:
        """Where a task's files are."""
        return self.tasks / task_id

    def look(self, task: Task, *, checksums: bool = False) -> Entry:
        """The state of a task from its files; `checksums` reads the record as well."""
        entry = self._look(task.id, checksums)
        if entry.state == "missing":
            for older in filter(self._named, self._older(task)):
                past = self._look(older, checksums)
                if past.state == "done":
                    return replace(past, state="stale")
        return entry

    def _older(self, task: Task) -> list[str]:
        """Names of a task under earlier model versions that may be here."""
        versions = self._versions()
        return task.under([version for version in task.older_versions if version in versions])

    def _versions(self) -> set[int]:
        """Model versions of which there are outcomes; a name is always of one."""
        changed = packs.changed(self.tasks)
        if changed != self._changed:
            self._unread = set(os.listdir(self.tasks) if changed else ()) - self._read
            self._changed = packs.unless_fresh(changed)
        for name in tuple(self._unread):
            for line in filter(None, map(packs.LINE.match, packs.lines(self.folder(name) / "status.json"))):
                self._of.add(int(line[2]))
                self._read.add(name)
                self._unread.discard(name)
        return self._of | self.packs.versions

    def _named(self, task_id: str) -> bool:
        """Whether anything has this name."""
        return os.path.exists(f"{self.tasks}/{task_id}") or task_id in self.packs

    def begun(self) -> bool:
        """Whether there is any task's folder, or a pack."""
        return any(_holds(folder) for folder in (self.tasks, self.packs.folder))

    def _look(self, task_id: str, checksums: bool) -> Entry:
        folder = self.folder(task_id)
        entry = Entry(state="missing", folder=folder, status=read_status(folder / "status.json"))
        if entry.status.state == "missing" and (place := self.packs.find(task_id)):
            entry = replace(entry, status=place.status, place=place)
        status, state = entry.status, entry.status.state
        copied = state != "missing" and status.id != task_id
        damaged = copied or (state == "done" and not self._whole(entry, checksums))
        return replace(entry, state="damaged" if damaged else state)

    @staticmethod
    def _whole(entry: Entry, checksums: bool) -> bool:
        try:
            if entry.record.stat().st_size != entry.status.bytes:
                return False
            found = entry.place.checksum if checksums and entry.place else ""
            return not checksums or (found or sha256(entry.record.read_bytes())) == entry.status.sha256
        except OSError:
            return False

    def keep(self, outcomes: Sequence[tuple[Task, bytes | Row | None, dict[str, Any]]]) -> None:
        """Keep records, and failures without one: all flushed to the disk at once, each whole or not at all.

        The status, renamed last, makes a record count.
        """
        self.root.mkdir(parents=True, exist_ok=True)
        parts: list[tuple[Path, Path]] = []
        packs: dict[str, list[tuple[Task, Row, dict[str, Any]]]] = {}
        try:
            for task, record, status in outcomes:
                if isinstance(record, Row):
                    packs.setdefault(record.pack, []).append((task, record, status))
                    continue
                folder = self._begin(task)
                made: dict[str, Any] = {"state": "failed"}
                if record is not None:
                    made = {"state": "done", "bytes": len(record), "sha256": sha256(record)}
                    parts.append(_part(folder / "record.nc", record))
                parameters = task.parameters.model_dump(mode="json", exclude_defaults=True)
                parts.append(_part(folder / "status.json", _described(task, made | status, parameters)))
            for path, members in zip(self.packs.next(len(packs)), packs.values(), strict=True):
                parts += self._pack(path, members)
            flush([part for part, _ in parts], self.root)
            for part, path in parts:
                settle(part, path)
        except BaseException as error:
            for part, _ in parts:
                with contextlib.suppress(OSError):
                    part.unlink(missing_ok=True)
            if isinstance(error, OSError) and error.strerror and error.filename is None:  # of a disk that is full
                error.filename = str(self.root)
            raise

    def _pack(self, path: Path, members: Sequence[tuple[Task, Row, dict[str, Any]]]) -> Iterator[tuple[Path, Path]]:
        """Files of a pack, its lines last; older outcomes of its tasks are withdrawn first."""
        path.parent.mkdir(exist_ok=True)
        members = sorted(members, key=lambda member: member[1].number)
        data = members[0][1].data
        about = {"state": "done", "bytes": len(data), "sha256": sha256(data)}
        for task, _, _ in members:
            if (folder := self.folder(task.id)).exists():
                self._withdraw(folder)
        yield _part(path, data)
        lines = [_described(task, about | of, _estimating(task)) for task, _, of in members]
        yield _part(path.with_suffix(".jsonl"), b"".join(lines))

    def _begin(self, task: Task) -> Path:
        """Make the folder; an older outcome is withdrawn first, and a killed run's leftovers removed."""
        folder = self.folder(task.id)
        try:
            folder.mkdir()
        except FileNotFoundError:
            folder.mkdir(parents=True)
        except FileExistsError:
            if not folder.is_dir():
                remove(folder)
                folder.mkdir()
            self._withdraw(folder)
        return folder

    @staticmethod
    def _withdraw(folder: Path) -> None:
        """An older outcome, and a killed run's leftovers."""
        remove(folder / "status.json")
        flush([folder], folder)
        for part in folder.glob(".*.part"):
            remove(part)

    @contextlib.contextmanager
    def lock(self, waiting: Callable[[str], None]) -> Iterator[None]:
        """One writer for a study. The lock dies with its process, so a killed run leaves none behind."""
        try:
            self.root.mkdir(parents=True, exist_ok=True)
        except (FileNotFoundError, NotADirectoryError, PermissionError) as error:  # which no second call mends
            raise StudyError(self.root, [f"no folder can be made there: {error.strerror}"]) from None
        if (self.root / ".lock").is_dir():
            remove(self.root / ".lock")
        lock = FileLock(self.root / ".lock")
        try:
            lock.acquire(timeout=0)
        except Timeout:
            waiting(f"{self.root} is in use by {self.holder()}; waiting, and then doing what it leaves undone")
            lock.acquire()
        try:
            if gone := self.holder():
                waiting(f"{self.root} was left by {gone}, which did not come to its end; going on from there")
            for part in (*leftovers(self.root), *leftovers(self.packs.folder)):
                remove(part)
            mine = {"pid": os.getpid(), "host": os.uname().nodename, "since": timestamp()}
            write_json(self.root / ".lock.json", mine)
            yield
        finally:
            with contextlib.suppress(OSError):
                (self.root / ".lock.json").unlink(missing_ok=True)
            lock.release()

    def holder(self) -> str:
        """Who says that it works on the study; empty if nobody does."""
        return _named(read_json(self.root / ".lock.json"))

    def at_work(self) -> str:
        """The same; empty if that is a process of this machine that has ended."""
        who = read_json(self.root / ".lock.json")
        return "" if who and _ended(who) else _named(who)


def _named(who: Mapping[str, Any] | None) -> str:
    return f"process {who.get('pid')} on {who.get('host')} since {who.get('since')}" if who else ""


def _ended(who: Mapping[str, Any]) -> bool:
    """Whether a process of this machine is gone; of others nobody knows."""
    if who.get("host") != os.uname().nodename or not isinstance(who.get("pid"), int):
        return False
    try:
        os.kill(who["pid"], 0)
    except OSError as error:  # another user's process may not be asked, and is there
        return isinstance(error, ProcessLookupError)
    return False


def sha256(data: bytes) -> str:
    """Checksum of a file's bytes."""
    return hashlib.sha256(data).hexdigest()


def timestamp() -> str:
    """Now, UTC, ISO 8601."""
    return time.strftime("%Y-%m-%dT%H:%M:%SZ", time.gmtime())
