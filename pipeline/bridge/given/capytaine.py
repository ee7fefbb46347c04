"""Capytaine's datasets in netCDF, and the files of this program, which have its names."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from pipeline.study.attachments import Attachment
    from solver.hydrodynamics.bem.given import Given

FREQUENCIES = ("omega", "period", "freq", "wavenumber", "wavelength")  # what capytaine may count frequencies by
DIRECTION = "wave_direction"


def read(file: Attachment, _density: float, _gravity: float) -> Given:
    """A dataset of capytaine's `assemble_dataset`, complex numbers separated or not."""
    import netCDF4

    from solver.hydrodynamics.bem.given import Given

    with netCDF4.Dataset(file.name, memory=file.data) as data:
        data.set_auto_mask(False)
        if "forward_speed" in data.variables and np.any(np.asarray(data["forward_speed"][:]) != 0):
            raise ValueError("has coefficients of bodies that sail, forward_speed is not 0: floats are at rest here")
        counted = next((d for d in FREQUENCIES if d in data.dimensions), "omega")
        omega = np.atleast_1d(np.asarray(data["omega"][:], float))
        felt, radiating = _labels(data, "influenced_dof"), _labels(data, "radiating_dof")
        labels = [label for label in felt if label in radiating]  # it may have been asked for some motions' waves alone
        if not labels:
            raise ValueError(f"radiates {', '.join(radiating)} and has loads along {', '.join(felt)} alone")
        rows, rank = (np.array([of.index(label) for label in labels]) for of in (felt, radiating))
        A, B = (
            _ordered(data, name, (counted, "influenced_dof", "radiating_dof"))[:, rows[:, None], rank]
            for name in ("added_mass", "radiation_damping")
        )
        scattered, incident = (
            _ordered(data, name, (counted, DIRECTION, "influenced_dof"))[..., rows]
            for name in ("diffraction_force", "Froude_Krylov_force")
        )
        columns, bodies = _columns(labels, _labels(data, "body") if "body" in data.variables else [])
        infinite = A[np.isinf(omega)][0] if np.isinf(omega).any() else _plain(data, "added_mass_inf")
        finite = np.isfinite(omega) & (omega > 0)
        headings = _plain(data, DIRECTION)
        return Given(
            name=file.name,
            omega=omega[finite],
            added_mass=A[finite],
            radiation_damping=B[finite],
            added_mass_inf=infinite,
            headings=np.atleast_1d(data.getncattr("heading") if headings is None else headings).astype(float),
            excitation=(scattered + incident)[finite],
            froude_krylov=incident[finite],
            columns=columns,
            bodies=bodies,
            points=_points(data, bodies),
            depth=_number(data, "water_depth", "depth"),
            density=_number(data, "rho", "density"),
            gravity=_number(data, "g", "gravity"),
        )


def _labels(data: Any, name: str) -> list[str]:
    """Words along a dimension, however they are stored."""
    stored = np.atleast_1d(data[name][:])  # one body's has no dimension
    if stored.ndim == 2:
        stored = np.array([b"".join(row).rstrip(b"\0 ").decode() for row in stored])
    return [str(word).strip() for word in stored]


def _columns(labels: list[str], named: list[str]) -> tuple[tuple[tuple[int, str], ...], tuple[str, ...]]:
    """Body and motion of "front__Surge", or of "Surge" where there is one body, and the bodies, all that the file has
    `named`, of which some may be fixed; what is no rigid motion is refused.
    """
    from solver.scene import DOFS

    split = [label.rpartition("__") for label in labels]
    moving = dict.fromkeys(body for body, _, _ in split)
    bodies = tuple(named if moving.keys() <= set(named) else moving)
    for label, (_, _, dof) in zip(labels, split, strict=True):
        if dof.lower() not in DOFS:
            raise ValueError(f"{label} is none of the motions of rigid bodies, {', '.join(DOFS)}")
    return tuple((bodies.index(body), dof.lower()) for body, _, dof in split), bodies


def _ordered(data: Any, name: str, dims: tuple[str, ...]) -> np.ndarray:
    """A variable with these dimensions; others have one value, `complex` holds the real and the imaginary part."""
    variable = data[name]
    values, have = np.asarray(variable[:]), list(variable.dimensions)
    if "complex" in have:
        values = np.moveaxis(values, have.index("complex"), 0)
        have.remove("complex")
        values = values[0] + 1j * values[1]
    for extra in [d for d in have if d not in dims]:
        if values.shape[have.index(extra)] != 1:
            raise ValueError(f"{name} has several values along {extra}: keep one")
        values = np.squeeze(values, axis=have.index(extra))
        have.remove(extra)
    for lacking in [d for d in dims if d not in have]:  # a single frequency or direction may have no dimension
        values, have = values[None], [lacking, *have]
    return np.transpose(values, [have.index(d) for d in dims])


def _plain(data: Any, name: str) -> np.ndarray | None:
    return np.asarray(data[name][:], float) if name in data.variables else None


def _number(data: Any, name: str, attribute: str) -> float | None:
    """A number that capytaine has as a variable and this program as an attribute."""
    if name in data.variables:
        return float(np.ravel(data[name][:])[0])
    return float(data.getncattr(attribute)) if attribute in data.ncattrs() else None


def _points(data: Any, bodies: tuple[str, ...]) -> np.ndarray | None:
    """Of the bodies; NaN of fixed ones."""
    points = _plain(data, "rotation_center")
    return None if points is None or points.size != 3 * len(bodies) else points.reshape(-1, 3)
