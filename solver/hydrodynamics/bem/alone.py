"""Bodies that are each alone in the water: their coefficients put together, without terms between them."""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from types import MappingProxyType
from typing import Any

import numpy as np

from solver.hydrodynamics.bem.coefficients import EACH_ALONE, Hydrodynamics, MeshError


def assembled(alone: Sequence[Hydrodynamics], centres: np.ndarray) -> Hydrodynamics:
    """Coefficients of bodies at `centres` (nb, 3) [m] from those of each alone at the origin, at the same frequencies.

    Added mass and damping are block-diagonal; the wave comes to a body with the phase k (x cosβ + y sinβ).
    """
    first = replace(alone[0], centres=centres)
    arrival = first.arrival(first.omega)

    def waves(forces: Sequence[np.ndarray]) -> np.ndarray:
        return np.concatenate(forces, axis=-1) * arrival

    errors = [h.error for h in alone if h.error is not None]  # of all that the boundary elements solve for, or of none
    error = None
    if errors:
        error = MeshError(
            added_mass=_blocks([e.added_mass for e in errors]),
            radiation_damping=_blocks([e.radiation_damping for e in errors]),
            added_mass_inf=_blocks([e.added_mass_inf for e in errors]),
            diffraction=waves([e.diffraction for e in errors]),
        )
    return replace(
        first,
        added_mass=_blocks([h.added_mass for h in alone]),
        radiation_damping=_blocks([h.radiation_damping for h in alone]),
        added_mass_inf=_blocks([h.added_mass_inf for h in alone]),
        diffraction=waves([h.diffraction for h in alone]),
        froude_krylov=waves([h.froude_krylov for h in alone]),
        hydrostatic_stiffness=_blocks([h.hydrostatic_stiffness for h in alone]),
        displaced_mass=np.concatenate([h.displaced_mass for h in alone]),
        buoyancy_centre=np.concatenate([h.buoyancy_centre for h in alone]),
        settings=MappingProxyType(_settings([h.settings for h in alone])),
        error=error,
        far_field=None,  # each has its own, of which none is the whole's
    )


def _blocks(parts: Sequence[np.ndarray]) -> np.ndarray:
    """Parts (…, m, m) on the diagonal of zeros (…, nb m, nb m)."""
    m = parts[0].shape[-1]
    whole = np.zeros((*parts[0].shape[:-2], m * len(parts), m * len(parts)))
    for b, part in enumerate(parts):
        whole[..., b * m : (b + 1) * m, b * m : (b + 1) * m] = part
    return whole


def _settings(each: Sequence[Mapping[str, Any]]) -> dict[str, Any]:
    coarser = dict.fromkeys(s["coarser"] for s in each if "coarser" in s)
    return {
        **each[0],
        "panels": sum(s["panels"] for s in each),
        "panels_coarse": sum(s["panels_coarse"] for s in each),
        "method": "; ".join(dict.fromkeys(s["method"] for s in each)),
        "seabed_error": max(s.get("seabed_error", 0.0) for s in each),
        "bodies": EACH_ALONE,
        **({"coarser": "; ".join(coarser)} if coarser else {}),
    }
