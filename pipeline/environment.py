"""A process and where it runs: what is set before numpy and numba are imported, folders, and digests of the sources."""

from __future__ import annotations

import contextlib
import errno
import gc
import hashlib
import os
import platform
import stat
import subprocess
import tempfile
from collections.abc import Iterator
from functools import cache
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
THREADS = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "NUMBA_NUM_THREADS")
MARCH = "*/march.march-*.nbi"  # numba's index of the time loop, which calls all other kernels and is compiled last
STATICS = "*/equilibrium._balances-*.nbi"  # that of the loads anywhere, by which it is found where floats rest
BENDING = b"solver.coupled.pieces.fine"  # of which that index tells where the loop is compiled for laws that bend, too
PROGRAM = "wecplatform"
PACKAGES = (PROGRAM, "numpy", "scipy", "numba", "capytaine")


def prepare() -> None:
    """One thread a process, and a folder of compiled kernels that belongs to these sources."""
    for name in THREADS:
        os.environ.setdefault(name, "1")
    if "NUMBA_CACHE_DIR" not in os.environ:
        os.environ["NUMBA_CACHE_DIR"] = str(_writable_cache() / f"jit-{sources()}")


@contextlib.contextmanager
def importing() -> Iterator[None]:
    """No look for garbage among half a million objects that come to stay: it is a sixth of the time of imports."""
    enabled = gc.isenabled()
    gc.disable()
    try:
        yield
    finally:
        gc.freeze()
        if enabled:
            gc.enable()


def compiled(bends: bool) -> bool:
    """Whether there is machine code of these sources: the first run has to make it, and is silent for minutes.

    bends: for joints whose law bends or jumps, which are compiled apart.
    """
    return any(not bends or BENDING in index.read_bytes() for index in _indices(MARCH))


def statics_compiled() -> bool:
    """Whether there is machine code of what tells where floats rest: making it takes a part of that time."""
    return any(_indices(STATICS))


def _indices(of: str) -> Iterator[Path]:
    return Path(os.environ.get("NUMBA_CACHE_DIR", "")).glob(of)


def _writable_cache() -> Path:
    """Where compiled kernels are kept: code, so nobody else may have a hand in it."""
    folder = Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache") / "wecplatform"
    try:
        if os.access(private(folder), os.W_OK):
            return folder
    except OSError:
        pass
    return scratch()


def scratch() -> Path:
    """A folder for this user in the machine's temporary one."""
    return private(Path(tempfile.gettempdir()) / f"wecplatform-{os.getuid()}")


def private(folder: Path) -> Path:
    """The folder, made if need be, that this user owns and alone may write to; PermissionError if it is another's."""
    folder.mkdir(mode=0o700, parents=True, exist_ok=True)
    # Who owns a link decides where it leads, so that counts as well.
    owners, mode = {folder.lstat().st_uid, folder.stat().st_uid}, folder.stat().st_mode
    if owners != {os.getuid()} or mode & (stat.S_IWGRP | stat.S_IWOTH):
        reason = "others own it or may write to it, so no code is loaded from there; remove it, or set TMPDIR"
        raise PermissionError(errno.EPERM, reason, str(folder))
    return folder


@cache
def sources(package: str = "solver") -> str:
    """Digest of a package's sources; of the solver's, because numba does not notice an edit in another file."""
    digest = hashlib.sha256()
    for path in sorted((ROOT / package).rglob("*.py")):
        digest.update(str(path.relative_to(ROOT)).encode() + b"\0" + path.read_bytes())
    return digest.hexdigest()[:12]


@cache
def provenance() -> dict[str, str]:
    """Where and with what a task was computed."""
    facts = {
        "host": platform.node(),
        "python": platform.python_version(),
        "solver_sources": sources(),
        "commit": commit() or "unknown",
    }
    return facts | {name: release(name) for name in PACKAGES}


def release(package: str = PROGRAM) -> str:
    """Version of an installed package; that of this program stands in pyproject.toml alone."""
    from importlib.metadata import PackageNotFoundError, version  # 20 ms, and rarely asked

    try:
        return version(package)
    except PackageNotFoundError:
        return "unknown"


@cache
def commit() -> str:
    """Git commit of the sources, with '-dirty' if they differ from it; empty outside git."""
    command = [
        "git",
        "-C",
        str(ROOT),
        "describe",
        "--always",
        "--dirty",
        "--abbrev=40",
        "--exclude=*",
    ]
    try:
        # Looking must not lock the repository for those who work in it.
        quiet = {**os.environ, "GIT_OPTIONAL_LOCKS": "0"}
        done = subprocess.run(command, capture_output=True, text=True, timeout=10, check=False, env=quiet)
    except (OSError, subprocess.TimeoutExpired):
        return ""
    return done.stdout.strip() if done.returncode == 0 else ""
