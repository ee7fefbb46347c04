"""BEMIO's HDF5, as WEC-Sim's preprocessing writes it: groups body1, body2, … with rows of all bodies' columns.

Normalised as WAMIT's numbers: A/ρ, B/(ρω), X/(ρg), C/(ρg); phases of Re{X exp(+iωt)}; moments about each c.o.g.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from pipeline.study.attachments import Attachment
    from solver.hydrodynamics.bem.given import Given


def read(file: Attachment, _density: float, _gravity: float) -> Given:
    """Bodies of six motions each; netCDF-4 is HDF5, so its library reads both."""
    import netCDF4
    from scipy.linalg import block_diag

    from solver.hydrodynamics.bem.given import Given
    from solver.scene import DOFS

    with netCDF4.Dataset(file.name, memory=file.data) as data:
        data.set_auto_mask(False)
        common = data["simulation_parameters"]
        omega = _flat(common, "w")
        rho, g = (float(_flat(common, name)[0]) for name in ("rho", "g"))
        groups = [data[name] for name in sorted((n for n in data.groups if n.startswith("body")), key=_number)]
        if any(group["hydro_coeffs/added_mass/all"].shape[0] != len(DOFS) for group in groups):
            raise ValueError(f"has bodies with other motions than {', '.join(DOFS)}")
        A, B = (_rows(groups, f"hydro_coeffs/{name}/all") for name in ("added_mass", "radiation_damping"))
        infinite, restoring = (
            _each(groups, f"hydro_coeffs/{name}") for name in ("added_mass/inf_freq", "linear_restoring_stiffness")
        )
        total, incident = (_force(groups, f"hydro_coeffs/excitation{part}") for part in ("", "/froude-krylov"))
        return Given(
            name=file.name,
            omega=omega,
            added_mass=rho * A,
            radiation_damping=rho * omega[:, None, None] * B,
            added_mass_inf=None if infinite is None else rho * infinite.reshape(6 * len(groups), -1),
            headings=np.radians(_flat(common, "wave_dir")),
            excitation=rho * g * total,
            froude_krylov=rho * g * incident if np.isfinite(incident).all() and incident.any() else None,
            columns=tuple((b, dof) for b in range(len(groups)) for dof in DOFS),
            bodies=tuple(_text(group["properties"], "name") for group in groups),
            points=np.array([_flat(group["properties"], "cg") for group in groups]),
            stiffness=None if restoring is None else rho * g * block_diag(*restoring),
            depth=_depth(common),
            density=rho,
            gravity=g,
            time_sign=1,
        )


def _number(name: str) -> int:
    return int(name.removeprefix("body"))


def _flat(group: Any, name: str) -> np.ndarray:
    return np.asarray(group[name][:], float).ravel()


def _each(groups: list[Any], name: str) -> np.ndarray | None:
    """(nb, ...) of each body; None where there is none."""
    try:
        return np.array([np.asarray(group[name][:], float) for group in groups])
    except (IndexError, KeyError):
        return None


def _rows(groups: list[Any], name: str) -> np.ndarray:
    """(nw, n, n) of rows (6, n, nw) of each body."""
    return np.moveaxis(np.concatenate([np.asarray(group[name][:], float) for group in groups]), 2, 0)


def _force(groups: list[Any], name: str) -> np.ndarray:
    """(nw, nh, n) of (6, nh, nw) of each body, conjugated to Re{X exp(-iωt)}; NaN where there is none."""
    try:
        real, imag = (np.concatenate([np.asarray(b[f"{name}/{p}"][:], float) for b in groups]) for p in ("re", "im"))
    except (IndexError, KeyError):
        return np.array([[[np.nan]]])
    return np.moveaxis(real - 1j * imag, (2, 1), (0, 1))


def _text(group: Any, name: str) -> str:
    value = np.asarray(group[name][...])
    return b"".join(value.ravel()).decode().strip("\0 ") if value.dtype.kind == "S" else str(value.ravel()[0])


def _depth(group: Any) -> float:
    """Water depth [m]; deep water is a word."""
    try:
        return float(_flat(group, "water_depth")[0])
    except ValueError:
        return float("inf")
