"""Where tasks may run, and within which bounds; what is refused of that."""

from __future__ import annotations

import re
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from solver.errors import InputError

LEAST_MEMORY = 100e6  # less than what a worker imports [bytes]
ADDRESS = r"(tcp|tls|ws|wss)://(\[[0-9A-Fa-f:.]+\]|[^\s:/\[\]]+):[0-9]{1,5}"


@dataclass(frozen=True, kw_only=True)
class Place:
    """Where tasks run, and within which bounds."""

    workers: int = 2
    scheduler: str | None = None  # address of a dask scheduler
    timeout: float | None = None  # of one task [s]
    memory: str = "auto"  # of one embedded worker; auto: an equal share of the machine's
    tls: tuple[Path, Path, Path] | None = None  # authority, certificate and key, for a tls:// scheduler


def require_place(place: Place) -> None:
    """Refuse, with InputError, a place that cannot be: bounds, address, certificates."""
    if place.memory != "auto":
        from dask.utils import parse_bytes

        try:
            size = parse_bytes(place.memory)
        except (ValueError, OverflowError):
            size = 0
        if size < LEAST_MEMORY:
            limit = f"must be a size such as 2GB, at least {LEAST_MEMORY / 1e6:g}MB, or auto"
            raise InputError("--memory", place.memory, limit)
    for path in place.tls or ():
        if not path.is_file():
            raise InputError("--tls", str(path), "must be three PEM files: authority, certificate, key")
    if place.scheduler is None:
        if place.tls:
            raise InputError("--tls", " ".join(map(str, place.tls)), "goes with --scheduler tls://HOST:PORT")
        return
    if not re.fullmatch(ADDRESS, place.scheduler):
        raise InputError("--scheduler", place.scheduler, "must be an address such as tls://10.0.0.1:8786")
    if place.scheduler.startswith("tls:") and not _context(place.tls):
        raise InputError("--scheduler", place.scheduler, "needs --tls CA CERT KEY, or dask's own tls settings")


def _context(tls: tuple[Path, Path, Path] | None) -> Any:
    """OpenSSL's context of the certificates, None without any; raises InputError."""
    try:
        return security_of(tls).get_connection_args("client")["ssl_context"]
    except OSError as error:
        files = " ".join(map(str, tls)) if tls else "dask's own settings"
        raise InputError("--tls", files, f"must be PEM files that belong together: {error}") from None


def security_of(tls: tuple[Path, Path, Path] | None) -> Any:
    """From PEM files; without them, as dask is configured."""
    from distributed import Security

    if tls is None:
        return Security()
    authority, certificate, key = map(str, tls)
    return Security(tls_ca_file=authority, tls_client_cert=certificate, tls_client_key=key, require_encryption=True)
