"""netCDF files made and read in memory, so that the disk only ever sees whole ones."""

from __future__ import annotations

import hashlib
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any, NamedTuple

import netCDF4
import numpy as np

SLAB = 2**24  # bytes written at a time


class Variable(NamedTuple):
    """Named dimensions, values, attributes."""

    dims: tuple[str, ...]
    values: np.ndarray
    attrs: Mapping[str, Any]


def to_bytes(variables: Mapping[str, Variable], attrs: Mapping[str, Any]) -> bytes:
    """A netCDF-4 file as bytes."""
    file = netCDF4.Dataset("memory.nc", "w", memory=65536)
    _write(file, variables, attrs)
    return bytes(file.close())


def to_file(path: Path, variables: Mapping[str, Variable], attrs: Mapping[str, Any]) -> None:
    """A netCDF-4 file on the disk, for what need not fit in memory."""
    with netCDF4.Dataset(path, "w") as file:
        _write(file, variables, attrs)


def _write(file: netCDF4.Dataset, variables: Mapping[str, Variable], attrs: Mapping[str, Any]) -> None:
    """A dimension is as long as the first variable that has it."""
    for name, (dims, values, own) in variables.items():
        array = np.asarray(values)
        for dim, size in zip(dims, array.shape, strict=True):
            if dim not in file.dimensions:
                file.createDimension(dim, size)
        text = array.dtype.kind in "UO"
        fill = None if text else own.get("_FillValue")  # netCDF takes it at birth or never
        variable = file.createVariable(name, str if text else array.dtype, dims, fill_value=fill)
        if dims:
            for slab in _slabs(array):
                variable[slab] = array[slab].astype(object) if text else array[slab]
        else:
            variable[...] = str(array) if text else array
        variable.setncatts({key: value for key, value in own.items() if key != "_FillValue"})
    file.setncatts(attrs)


def _slabs(array: np.ndarray) -> Iterator[slice]:
    step = max(1, SLAB * len(array) // max(1, array.nbytes))
    return (slice(i, i + step) for i in range(0, len(array), step))


def from_bytes(data: bytes) -> tuple[dict[str, Variable], dict[str, Any]]:
    """Variables and global attributes of a netCDF file held in memory."""
    with netCDF4.Dataset("memory.nc", "r", memory=data) as file:
        file.set_auto_mask(False)
        variables = {
            name: Variable(v.dimensions, np.asarray(v[...]), {k: v.getncattr(k) for k in v.ncattrs()})
            for name, v in file.variables.items()
        }
        return variables, {name: file.getncattr(name) for name in file.ncattrs()}


def values(data: bytes) -> dict[str, Variable]:
    """Variables without their attributes, which take longer to read than the numbers."""
    with netCDF4.Dataset("memory.nc", "r", memory=data) as file:
        file.set_auto_mask(False)
        return {name: Variable(v.dimensions, np.asarray(v[...]), {}) for name, v in file.variables.items()}


def content(variables: Mapping[str, Variable]) -> str:
    """SHA-256 over names, dimensions, types and every bit of every value."""
    digest = hashlib.sha256()
    for name, (dims, values, _) in sorted(variables.items()):
        text = values.dtype.kind in "UO"
        body = "\0".join(map(str, values.ravel())).encode() if text else np.ascontiguousarray(values).tobytes()
        head = f"{name}{dims}{values.shape}{'text' if text else values.dtype.str}"
        digest.update(head.encode() + body)
    return digest.hexdigest()
