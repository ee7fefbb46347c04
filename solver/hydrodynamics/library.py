"""Capytaine, imported when first used, being slow to."""

import os
import tempfile
from functools import cache
from pathlib import Path
from typing import Any


@cache
def capytaine() -> Any:
    """The module."""
    _find_room()
    import capytaine

    capytaine.set_logging("ERROR")  # panels of a sphere are not plane: nothing to warn of
    return capytaine


def _find_room() -> None:
    """For its table: it cannot be imported where its folder for that, usually in the user's cache, cannot be made."""
    usual = Path(os.path.expanduser(os.environ.get("XDG_CACHE_HOME", "").strip() or "~/.cache"), "capytaine")
    try:
        usual.mkdir(parents=True, exist_ok=True)
        writable = os.access(usual, os.W_OK)
    except OSError:
        writable = False
    if not writable:
        os.environ.setdefault("CAPYTAINE_CACHE_DIR", os.path.join(tempfile.gettempdir(), f"capytaine-{os.getuid()}"))
