"""Hydrodynamic coefficients by content: results/hydrodynamics/<key>.nc, capytaine's names.

netCDF has no complex numbers; as capytaine does, they get a last dimension `complex` = re, im.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import lru_cache
from pathlib import Path
from types import MappingProxyType
from typing import TYPE_CHECKING, Any

import numpy as np

from pipeline.netcdf import Variable, content, from_bytes, to_bytes
from pipeline.store import COEFFICIENTS, write_atomic

if TYPE_CHECKING:
    from solver.hydrodynamics.bem import Hydrodynamics

Table = Mapping[str, tuple[str, tuple[str, ...], str, str]]
DOF = ("influenced_dof", "radiating_dof")
# field of Hydrodynamics: name in the file, dimensions, unit (of translations), meaning
ARRAYS = {
    "omega": ("omega", ("omega",), "rad s-1", "Angular frequency"),
    "added_mass": ("added_mass", ("omega", *DOF), "kg", "Added mass"),
    "radiation_damping": ("radiation_damping", ("omega", *DOF), "kg s-1", "Radiation damping"),
    "added_mass_inf": ("added_mass_inf", DOF, "kg", "Added mass at infinite frequency"),
    "diffraction": (
        "diffraction_force",
        ("omega", DOF[0], "complex"),
        "N m-1",
        "Diffraction force per wave amplitude",
    ),
    "froude_krylov": (
        "Froude_Krylov_force",
        ("omega", DOF[0], "complex"),
        "N m-1",
        "Froude-Krylov force per wave amplitude",
    ),
    "hydrostatic_stiffness": (
        "hydrostatic_stiffness",
        DOF,
        "N m-1",
        "Hydrostatic stiffness of buoyancy",
    ),
    "displaced_mass": ("displaced_mass", ("body",), "kg", "Mass of the displaced water"),
    "buoyancy_centre": ("center_of_buoyancy", ("body",), "m", "Height of the centre of buoyancy"),
    "centres": (
        "rotation_center",
        ("body", "xyz"),
        "m",
        "Point that rotations and moments refer to",
    ),
}
POLES = ("memory_pole",)
MEMORY = {
    "beta": ("memory_exponent", (*POLES, "complex"), "rad s-1", "Exponents of the radiation memory"),
    "residue": ("memory_residue", (*POLES, *DOF, "complex"), "N m-1", "Residues of the radiation memory"),
    "added_mass_inf": ("memory_added_mass_inf", DOF, "kg", "Added mass at infinite frequency that goes with it"),
}
SCALARS = ("depth", "density", "gravity", "heading", "mesh_error")


def encode(hydrodynamics: Hydrodynamics) -> bytes:
    """The file of a set of coefficients."""
    variables = _variables(hydrodynamics, ARRAYS)
    memory = hydrodynamics.memory
    if memory is not None:
        variables |= _variables(memory, MEMORY)
    bodies = range(len(hydrodynamics.centres))
    labels = np.array([f"body{b}__{dof}" for b in bodies for dof in hydrodynamics.dofs])
    variables |= {dof: Variable((dof,), labels, {"long_name": "Body and degree of freedom"}) for dof in DOF}
    variables["complex"] = Variable(("complex",), np.array(["re", "im"]), {"long_name": "Part of a complex number"})
    attrs: dict[str, Any] = {
        "Conventions": "CF-1.11",
        "title": "Hydrodynamic coefficients, Re{X exp(-i omega t)}",
    }
    attrs |= {name: float(getattr(hydrodynamics, name)) for name in SCALARS}
    attrs |= {f"setting_{key}": value for key, value in hydrodynamics.settings.items()}
    attrs |= {"dofs": " ".join(hydrodynamics.dofs)}
    if memory is not None:
        attrs |= {"memory_tolerance": hydrodynamics.memory_tolerance, "memory_error": memory.error}
    return to_bytes(variables, attrs | {"content": content(variables, attrs)})


def _variables(item: object, table: Table) -> dict[str, Variable]:
    found = {}
    for field, (name, dims, unit, long_name) in table.items():
        values = np.asarray(getattr(item, field))
        if "complex" in dims:
            values = np.stack([values.real, values.imag], axis=-1)
        found[name] = Variable(dims, values, {"units": unit, "long_name": long_name})
    return found


def _fields(variables: Mapping[str, Variable], table: Table) -> dict[str, Any]:
    found = {}
    for field, (name, dims, _, _) in table.items():
        values = variables[name].values
        found[field] = np.ascontiguousarray(values).view(complex)[..., 0] if "complex" in dims else values
    return found


@lru_cache(maxsize=8)
def decode(data: bytes) -> Hydrodynamics:
    """Coefficients from a file's bytes, bit for bit those that were encoded."""
    from solver.hydrodynamics.bem import Hydrodynamics
    from solver.hydrodynamics.radiation import RadiationMemory

    variables, attrs = from_bytes(data)
    if content(variables, {k: v for k, v in attrs.items() if k != "content"}) != attrs["content"]:
        raise ValueError("the file's content is not what was written")
    fields: dict[str, Any] = {name: float(attrs[name]) for name in SCALARS}
    fields |= _fields(variables, ARRAYS)
    if "memory_error" in attrs:
        error, fields["memory_tolerance"] = float(attrs["memory_error"]), float(attrs["memory_tolerance"])
        fields["memory"] = RadiationMemory(**_fields(variables, MEMORY), error=error)
    settings = {k.removeprefix("setting_"): v for k, v in attrs.items() if k.startswith("setting_")}
    return Hydrodynamics(**fields, dofs=tuple(attrs["dofs"].split()), settings=MappingProxyType(settings))


class Cache:
    """Files of coefficients, one for each geometry, shared by all studies of a results folder."""

    def __init__(self, results: Path, readable: Callable[[bytes], object] = decode):
        self.folder = results / COEFFICIENTS
        self.readable = readable

    def get(self, key: str) -> bytes | None:
        """The file's bytes, None if there is none or it is damaged."""
        try:
            data = (self.folder / f"{key}.nc").read_bytes()
            self.readable(data)
        except (OSError, KeyError, ValueError):
            return None
        return data

    def put(self, key: str, data: bytes) -> None:
        """Keep a file of coefficients."""
        self.folder.mkdir(parents=True, exist_ok=True)
        write_atomic(self.folder / f"{key}.nc", data)
