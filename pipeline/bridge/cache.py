"""Hydrodynamic coefficients by content: results/hydrodynamics/<key>.nc, capytaine's names.

A file holds its key, and a checksum over that and all else in it: under another's name it does not count.
netCDF has no complex numbers; as capytaine does, they get a last dimension `complex` = re, im.
"""

from __future__ import annotations

import contextlib
from collections.abc import Callable, Iterable, Mapping
from functools import lru_cache
from pathlib import Path
from types import MappingProxyType
from typing import TYPE_CHECKING, Any

import numpy as np

from pipeline.results.netcdf import Variable, content, from_bytes, to_bytes
from pipeline.results.status import read_json
from pipeline.results.store import sha256, write_atomic, write_json
from pipeline.study.reading import COEFFICIENTS

if TYPE_CHECKING:
    from solver.hydrodynamics.bem.coefficients import Hydrodynamics

Naming = Mapping[str, tuple[str, tuple[str, ...], str, str]]
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
RINGS = (
    ("ringing_exponent", "ringing_pole", "Exponents of what rings between bodies"),
    ("ringing_exponent_shifted", "ringing_pole_shifted", "The same of coefficients plus their estimated errors"),
)
ERRORS = {
    field: (f"{name}_error", dims, unit, f"{meaning}: estimated error of the panels")
    for field, (name, dims, unit, meaning) in ARRAYS.items()
    if field in ("added_mass", "radiation_damping", "added_mass_inf", "diffraction")
}
MODE = "far_field_mode"
FAR = {
    "origin": ("far_field_origin", ("xy",), "m", "Point of phase zero of the far field"),
    "radiated": ("far_field_radiated", ("omega", DOF[1], MODE, "complex"), "m2", "Modes of the Kochin function"),
    "scattered": ("far_field_scattered", ("omega", MODE, "complex"), "m2 s-1", "The same of the scattered unit wave"),
}
SCALARS = ("depth", "density", "gravity", "heading", "waves_to")


def encode(hydrodynamics: Hydrodynamics, key: str = "") -> bytes:
    """The file of a set of coefficients, those of the geometry with this key."""
    variables = _variables(hydrodynamics, ARRAYS)
    memory = hydrodynamics.memory
    if memory is not None and not memory.beta.size:  # of what does not move: classic files have no arrays of nothing
        memory = None
    if hydrodynamics.error is not None:
        variables |= _variables(hydrodynamics.error, ERRORS)
    if memory is not None:
        variables |= _variables(memory, MEMORY)
    if hydrodynamics.far_field is not None:
        variables |= _variables(hydrodynamics.far_field, FAR)
    for (name, pole, long_name), beta in zip(RINGS, hydrodynamics.rings or (), strict=False):
        if beta.size:
            values, told = np.stack([beta.real, beta.imag], axis=-1), {"units": "rad s-1", "long_name": long_name}
            variables[name] = Variable((pole, "complex"), values, told)
    bodies = range(len(hydrodynamics.centres))
    labels = np.array([f"body{b}__{dof}" for b in bodies for dof in hydrodynamics.dofs])
    variables |= {dof: Variable((dof,), labels, {"long_name": "Body and degree of freedom"}) for dof in DOF}
    variables["complex"] = Variable(("complex",), np.array(["re", "im"]), {"long_name": "Part of a complex number"})
    attrs: dict[str, Any] = {
        "Conventions": "CF-1.11",
        "title": "Hydrodynamic coefficients, Re{X exp(-i omega t)}",
        "geometry": key,
        "comment": "Units are those of surge, sway and heave: with m more for each rotation of a row or column",
    }
    attrs |= {name: float(getattr(hydrodynamics, name)) for name in SCALARS}
    attrs |= {f"setting_{key}": value for key, value in hydrodynamics.settings.items()}
    attrs |= {"dofs": " ".join(hydrodynamics.dofs), "mesh_error": hydrodynamics.mesh_error}
    if hydrodynamics.rings is not None:
        attrs["ringing"] = "found"
    if memory is not None:
        attrs |= {"memory_tolerance": hydrodynamics.memory_tolerance, "memory_error": memory.error}
        if motions := hydrodynamics.memory_motions:
            attrs |= {"memory_motions": "; ".join(" ".join(names) for names in motions)}
    return to_bytes(variables, attrs | {"content": content(variables, attrs)})


def _variables(item: object, table: Naming) -> dict[str, Variable]:
    variables = {}
    for field, (name, dims, unit, long_name) in table.items():
        values = np.asarray(getattr(item, field))
        if "complex" in dims:
            values = np.stack([values.real, values.imag], axis=-1)
        variables[name] = Variable(dims, values, {"units": unit, "long_name": long_name})
    return variables


def _fields(variables: Mapping[str, Variable], table: Naming) -> dict[str, Any]:
    fields = {}
    for field, (name, dims, _, _) in table.items():
        values = variables[name].values
        fields[field] = np.ascontiguousarray(values).view(complex)[..., 0] if "complex" in dims else values
    return fields


@lru_cache(maxsize=8)
def decode(data: bytes) -> Hydrodynamics:
    """Coefficients from a file's bytes, bit for bit those that were encoded."""
    from solver.hydrodynamics.bem.coefficients import Hydrodynamics, MeshError
    from solver.hydrodynamics.bem.far_field import FarField
    from solver.hydrodynamics.radiation.memory import RadiationMemory

    variables, attrs = _whole(data)
    fields: dict[str, Any] = {name: float(attrs[name]) for name in SCALARS}
    fields |= _fields(variables, ARRAYS)
    if "added_mass_error" in variables:
        fields["error"] = MeshError(**_fields(variables, ERRORS))
    if "far_field_origin" in variables:
        fields["far_field"] = FarField(**_fields(variables, FAR))
    if "ringing" in attrs:  # which files of earlier versions leave to those who read them
        own, shifted = (variables[name].values if name in variables else np.zeros((0, 2)) for name, *_ in RINGS)
        fields["rings"] = tuple(np.ascontiguousarray(beta).view(complex)[..., 0] for beta in (own, shifted))
    if "memory_error" in attrs:
        error, fields["memory_tolerance"] = float(attrs["memory_error"]), float(attrs["memory_tolerance"])
        fields["memory"] = RadiationMemory(**_fields(variables, MEMORY), error=error)
        if "memory_motions" in attrs:
            fields["memory_motions"] = tuple(tuple(names.split()) for names in attrs["memory_motions"].split(";"))
    settings = {k.removeprefix("setting_"): v for k, v in attrs.items() if k.startswith("setting_")}
    return Hydrodynamics(**fields, dofs=tuple(attrs["dofs"].split()), settings=MappingProxyType(settings))


@lru_cache(maxsize=8)
def _whole(data: bytes) -> tuple[dict[str, Variable], dict[str, Any]]:
    """What is in a file; raises ValueError if that is not what was written."""
    variables, attrs = from_bytes(data)
    if content(variables, {k: v for k, v in attrs.items() if k != "content"}) != attrs.get("content"):
        raise ValueError("the file's content is not what was written")
    return variables, attrs


def require_whole(data: bytes, key: str) -> None:
    """Raise ValueError unless a file is whole, of the geometry with this key, and has all that is read of it."""
    variables, attrs = _whole(data)
    if attrs.get("geometry") != key:
        raise ValueError("the file is another geometry's")
    if lacking := {name for name, *_ in ARRAYS.values()}.union(SCALARS) - variables.keys() - attrs.keys():
        raise ValueError(f"the file lacks {', '.join(sorted(lacking))}")


def _checksum(path: Path) -> str:
    """Of a file that can be read; else empty."""
    try:
        return sha256(path.read_bytes())
    except OSError:
        return ""


class Cache:
    """Files of coefficients, one for each geometry, shared by all studies of a results folder."""

    def __init__(self, results: Path, require: Callable[[bytes, str], object] = require_whole):
        self.folder = results / COEFFICIENTS
        self.require = require

    def path(self, key: str) -> Path:
        """Where a geometry's file is."""
        return self.folder / f"{key}.nc"

    def damaged(self) -> set[str]:
        """Keys of the files that are not what their names say; a file read once is known again by its checksum."""
        sums = {path.stem: _checksum(path) for path in self.folder.glob("*.nc")}
        mark = self.folder / ".whole.json"
        known = read_json(mark) or {}
        whole = {k: total for k, total in sums.items() if total and (known.get(k) == total or self.get(k) is not None)}
        if whole != known:
            with contextlib.suppress(OSError):  # it saves time alone, and the folder may be for reading only
                write_json(mark, whole)
        return sums.keys() - whole.keys()

    def get(self, key: str) -> bytes | None:
        """The file's bytes, None if there is none or it is damaged."""
        try:
            data = self.path(key).read_bytes()
            self.require(data, key)
        except (OSError, ValueError):
            return None
        return data

    def put(self, key: str, data: bytes) -> None:
        """Keep a file of coefficients."""
        self.folder.mkdir(parents=True, exist_ok=True)
        write_atomic(self.path(key), data)

    def share(self, name: str) -> bytes | None:
        """A share of a long solution, kept until the whole is; None if there is none or it is damaged."""
        try:
            total, data = (content := (self.folder / f"{name}.share").read_bytes())[:64], content[64:]
        except OSError:
            return None
        return data if sha256(data).encode() == total else None

    def put_share(self, name: str, data: bytes) -> None:
        """Keep a share, with its checksum before it."""
        self.folder.mkdir(parents=True, exist_ok=True)
        write_atomic(self.folder / f"{name}.share", sha256(data).encode() + data)

    def drop_shares(self, names: Iterable[str]) -> None:
        """Of a solution that is whole."""
        for name in names:
            (self.folder / f"{name}.share").unlink(missing_ok=True)
