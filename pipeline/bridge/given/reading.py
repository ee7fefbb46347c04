"""Coefficients from a file, by its name: capytaine's netCDF, BEMIO's HDF5, WAMIT's .1 with .3 and .hst or its .out, and
Nemoh's .tec.
"""

from __future__ import annotations

import struct
from collections.abc import Callable
from functools import lru_cache
from typing import TYPE_CHECKING

import numpy as np

from pipeline.bridge.given import bemio, capytaine, nemoh, wamit
from pipeline.study.attachments import WAMIT, Attachment
from solver.errors import InputError

if TYPE_CHECKING:
    from solver.hydrodynamics.bem.given import Given

Reader = Callable[[Attachment, float, float], "Given"]
READERS: dict[str, Reader] = {".nc": capytaine.read, ".h5": bemio.read, ".hdf5": bemio.read, ".out": wamit.read_out}
READERS |= dict.fromkeys(WAMIT, wamit.read) | {".tec": nemoh.read}


@lru_cache(maxsize=4)
def read(file: Attachment, density: float, gravity: float) -> Given:
    """What a file says, in SI; density [kg/m3] and gravity [m/s2] where it has numbers without units."""
    kind = "." + file.name.rpartition(".")[2].lower()
    if kind not in READERS:
        raise InputError("coefficients", file.name, f"must end in one of {', '.join(READERS)}")
    try:
        with np.errstate(over="ignore", invalid="ignore"):  # what is not finite is refused afterwards, in words
            return READERS[kind](file, density, gravity)
    except OSError:  # from netCDF's library alone, in its own words
        text = f"is not readable as {kind}: is neither netCDF nor HDF5, or not the whole of it"
        raise InputError("coefficients", file.name, text) from None
    except (ValueError, KeyError, IndexError, RuntimeError, TypeError, struct.error) as error:
        raise InputError("coefficients", file.name, f"is not readable as {kind}: {error}") from None
