"""Ctrl-C: one line about what is kept, then leave; a second one leaves at once."""

from __future__ import annotations

import contextlib
import os
import signal
from types import FrameType

STATUS = 130
KEPT = "finished tasks are kept, and the same command goes on from here"


class Interrupted(BaseException):
    """Not KeyboardInterrupt, which libraries on the way take for theirs."""


def heed() -> None:
    """Handle Ctrl-C in this way from now on."""
    signal.signal(signal.SIGINT, _first)


def _first(_number: int, _frame: FrameType | None) -> None:
    """The line comes before files and workers are closed, which takes a while."""
    signal.signal(signal.SIGINT, lambda *_: os._exit(STATUS))
    line = f"interrupted; {KEPT}\n"
    with contextlib.suppress(OSError):
        # Not print, which may be what is interrupted; a bar on a terminal has its own line.
        os.write(2, (f"\n{line}" if os.isatty(2) else line).encode())
    raise Interrupted
