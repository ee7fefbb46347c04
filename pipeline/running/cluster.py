"""Workers started here: processes that are forked from one which has imported everything."""

from __future__ import annotations

import contextlib
import os
import resource
import signal
from collections.abc import Iterator
from typing import Any

from pipeline import environment

# A block of a record takes a few arrays of half a megabyte. glibc would hand each back to the system and ask for it
# anew, page by page, once dask has set a threshold of 64 kB: a quarter of a worker's time, and more beside another.
MALLOC = {"MALLOC_MMAP_THRESHOLD_": "33554432", "MALLOC_TRIM_THRESHOLD_": "67108864"}
# What cleans up after a killed run need not tell.
QUIET = {"PYTHONWARNINGS": "ignore:resource_tracker:UserWarning"}
FILES, EACH = 24, 9  # open files: of this process while workers start, and of each of them
IMPORTED = "pipeline.running.imported"  # what workers need before their first step


def start_fork_server() -> None:
    """If it is not running. It blocks Ctrl-C, and so do the workers: that is for this process, which closes them."""
    from multiprocessing import forkserver, resource_tracker, set_forkserver_preload

    environment.prepare()
    for name, value in {**MALLOC, **QUIET}.items():
        os.environ.setdefault(name, value)
    set_forkserver_preload([IMPORTED])
    resource_tracker.ensure_running()  # or else the fork server starts it, and it ends by unblocking
    mask = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        forkserver.ensure_running()
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, mask)


@contextlib.contextmanager
def own_cluster(workers: int, memory: str) -> Iterator[Any]:
    """Workers started here: processes of one thread, on loopback alone, no dashboard.

    Whoever may connect runs code as the owner, and every user of the machine reaches loopback: all ports ask for a
    certificate made now and kept in memory. Workers import and unpickle from their scratch folder: it is private, too.
    """
    # Beyond it workers die one by one, with tracebacks of the process that they are forked from.
    limit, needed = resource.getrlimit(resource.RLIMIT_NOFILE)[0], FILES + EACH * workers
    if limit != resource.RLIM_INFINITY and limit < needed:
        told = f"{workers} take {needed} open files, and this process may have {limit} (ulimit -n)"
        raise ChildProcessError(f"workers do not start: {told}")

    import dask
    from distributed import LocalCluster, Security

    start_fork_server()
    with dask.config.set({"temporary-directory": str(environment.scratch())}):
        try:
            cluster = LocalCluster(
                n_workers=workers,
                threads_per_worker=1,
                processes=True,
                host="127.0.0.1",
                security=Security.temporary(),
                dashboard_address="127.0.0.1:0",  # dask insists on some port, where it then shows nothing
                scheduler_kwargs={"dashboard": False},
                memory_limit=memory,
                silence_logs="CRITICAL",
            )
        except RuntimeError:
            raise ChildProcessError("workers do not start: they are killed, or this machine refuses them") from None
        with cluster:
            yield cluster
