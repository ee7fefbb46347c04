"""Ctrl-C: one line about what is kept, then leave; a second one leaves at once."""

from __future__ import annotations

import contextlib
import os
import signal
import sys
from types import FrameType

STATUS = 130
KEPT = "finished tasks are kept, and the same command goes on from here"


class Interrupted(BaseException):
    """Not KeyboardInterrupt, which libraries on the way take for theirs."""


def heed() -> None:
    """Handle Ctrl-C from now on: while this process imports there is nothing to close, and it leaves at once."""
    signal.signal(signal.SIGINT, _while_importing)


def unwind() -> None:
    """From now on files and workers are closed first."""
    signal.signal(signal.SIGINT, _first)


def asked() -> bool:
    """Whether it has come, which what it interrupts may discard, as weak references do, or take for an error."""
    return signal.getsignal(signal.SIGINT) is _second


def check() -> None:
    """Interrupt what would go on all the same."""
    if asked():
        raise Interrupted


def _while_importing(number: int, frame: FrameType | None) -> None:
    _tell()
    _second(number, frame)


def _first(_number: int, _frame: FrameType | None) -> None:
    """The line comes before files and workers are closed, which takes a while."""
    signal.signal(signal.SIGINT, _second)
    sys.unraisablehook = lambda _: None  # it would tell of this one, discarded, in a traceback
    _tell()
    raise Interrupted


def _second(_number: int, _frame: FrameType | None) -> None:
    os._exit(STATUS)


def _tell() -> None:
    line = f"interrupted; {KEPT}\n"
    with contextlib.suppress(OSError):
        # Not print, which may be what is interrupted; a bar on a terminal has its own line.
        os.write(2, (f"\n{line}" if os.isatty(2) else line).encode())
