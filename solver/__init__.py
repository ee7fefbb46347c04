"""Coupled dynamics of wave energy converters and of the platforms that carry them.

Build a Scene, `simulate` it, read the Record. A name is loaded when it is first asked for, so
importing the package costs nothing.
"""

from importlib import import_module
from typing import Any

_HOMES = {
    "errors": ("InputError", "SimulationFailed"),
    "mooring": ("Line", "Mooring"),
    "power_takeoff": ("PtoEfficiency", "PtoTable"),
    "scene": ("Float", "Platform", "Scene", "Settings", "Water"),
    "hydrodynamics.hull.revolution": ("Revolution",),
    "hydrodynamics.hull.panel_hull": ("PanelHull",),
    "sea.realization": ("CALM", "Realization", "components", "measured", "realize", "regular"),
    "sea.spectrum": ("Jonswap", "PiersonMoskowitz", "Tabulated", "WhiteNoise"),
    "structure.frame": ("Frame",),
    "structure.members": ("Material", "Member", "PointLoad", "PointMass"),
    "structure.sections": ("solid_rectangle", "tube"),
    "coupled.boundary": ("coefficients",),
    "run": ("simulate",),
    "record.spectra": ("transfer",),
}
_HOME = {name: home for home, names in _HOMES.items() for name in names}

__all__ = sorted(_HOME)  # noqa: PLE0605


def __getattr__(name: str) -> Any:
    if name not in _HOME:
        raise AttributeError(f"module {__name__} has no attribute {name}")
    return getattr(import_module(f"{__name__}.{_HOME[name]}"), name)


def __dir__() -> list[str]:
    return [*globals(), *__all__]
