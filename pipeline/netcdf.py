"""netCDF files made and read in memory, so that the disk only ever sees whole ones."""

from __future__ import annotations

import hashlib
from collections.abc import Mapping
from typing import Any, NamedTuple

import netCDF4
import numpy as np


class Variable(NamedTuple):
    """Named dimensions, values, attributes."""

    dims: tuple[str, ...]
    values: np.ndarray
    attrs: Mapping[str, Any]


def to_bytes(variables: Mapping[str, Variable], attrs: Mapping[str, Any]) -> bytes:
    """A netCDF-4 file as bytes; a dimension is as long as the first variable that has it."""
    file = netCDF4.Dataset("memory.nc", "w", memory=65536)
    for name, (dims, values, own) in variables.items():
        array = np.asarray(values)
        for dim, size in zip(dims, array.shape, strict=True):
            if dim not in file.dimensions:
                file.createDimension(dim, size)
        text = array.dtype.kind in "UO"
        fill = None if text else own.get("_FillValue")  # netCDF takes it at birth or never
        variable = file.createVariable(name, str if text else array.dtype, dims, fill_value=fill)
        if text:
            variable[...] = np.asarray(array, dtype=object) if dims else str(array)
        else:
            variable[...] = array
        variable.setncatts({key: value for key, value in own.items() if key != "_FillValue"})
    file.setncatts(attrs)
    return bytes(file.close())


def from_bytes(data: bytes) -> tuple[dict[str, Variable], dict[str, Any]]:
    """Variables and global attributes of a netCDF file held in memory."""
    with netCDF4.Dataset("memory.nc", "r", memory=data) as file:
        file.set_auto_mask(False)
        variables = {
            name: Variable(v.dimensions, np.asarray(v[...]), {k: v.getncattr(k) for k in v.ncattrs()})
            for name, v in file.variables.items()
        }
        return variables, {name: file.getncattr(name) for name in file.ncattrs()}


def content(variables: Mapping[str, Variable]) -> str:
    """SHA-256 over names, dimensions, types and every bit of every value."""
    digest = hashlib.sha256()
    for name, (dims, values, _) in sorted(variables.items()):
        text = values.dtype.kind in "UO"
        body = "\0".join(map(str, values.ravel())).encode() if text else np.ascontiguousarray(values).tobytes()
        head = f"{name}{dims}{values.shape}{'text' if text else values.dtype.str}"
        digest.update(head.encode() + body)
    return digest.hexdigest()
