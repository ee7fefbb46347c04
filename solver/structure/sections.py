"""Cross sections of beams."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from typing import Annotated, Any

import numpy as np

from solver.errors import InputError
from solver.quantities import Quantity, require_positive, require_ranges

ROUND = 8  # fibres of a round section, from local y towards local z


@dataclass(frozen=True, slots=True, kw_only=True)
class Section:
    """Cross section; Iy is the bending stiffness in the xz plane, Iz in the xy plane."""

    area: Annotated[float, Quantity("m2", above=0)]
    Iy: Annotated[float, Quantity("m4", above=0)]  # ∫z² dA
    Iz: Annotated[float, Quantity("m4", above=0)]  # ∫y² dA
    J: Annotated[float, Quantity("m4", above=0)]  # torsion constant
    Ip: Annotated[float, Quantity("m4", above=0)]  # polar moment Iy + Iz, for the rotary inertia
    fibre: Annotated[float, Quantity("m", above=0)]  # distance c of the extreme fibre from the axis
    diameter: Annotated[float, Quantity("m", least=0)] = 0.0  # outer, as the water sees it; 0 takes no water load
    wall: Annotated[float, Quantity("m", least=0)] = 0.0  # thickness of its plates, by which fatigue goes
    corners: tuple[tuple[float, float], ...] = ()  # (y, z) of its fibres [m]; none: eight all round at `fibre`
    # Timoshenko's κ: shear area over area. None: Euler-Bernoulli's beam, without shear or rotary inertia across it.
    shear_factor: Annotated[float | None, Quantity("-", above=0)] = None
    # Of MAKERS, and what that was called with: what tapers needs both.
    shape: str = field(default="", compare=False)
    sides: tuple[float, ...] = field(default=(), compare=False)

    def __post_init__(self) -> None:
        require_ranges(self, "section")

    @property
    def hollow(self) -> float:
        """Area inside a tube [m2]."""
        return float(max(np.pi / 4 * self.diameter**2 - self.area, 0.0))

    @property
    def fibres(self) -> np.ndarray:
        """Places (nf, 2) in local y and z [m] at which signed stress is put out: σ = N/A + My z/Iy - Mz y/Iz."""
        angle = np.arange(ROUND) * 2 * np.pi / ROUND
        return np.array(self.corners) if self.corners else self.fibre * np.column_stack([np.cos(angle), np.sin(angle)])


def tube(diameter: float, thickness: float) -> Section:
    """Circular tube of outer diameter D and wall t [m]; t = D/2 is a solid rod."""
    require_positive("section.diameter", diameter, "m")
    require_positive("section.thickness", thickness, "m")
    if thickness > diameter / 2:
        raise InputError("section.thickness", thickness, f"must be <= diameter / 2 = {diameter / 2:g} m")
    inner = diameter - 2 * thickness
    bending = np.pi / 64 * (diameter**4 - inner**4)
    return Section(
        area=np.pi / 4 * (diameter**2 - inner**2),
        Iy=bending,
        Iz=bending,
        J=2 * bending,
        Ip=2 * bending,
        fibre=diameter / 2,
        diameter=diameter,
        wall=thickness,
        shape="tube",
        sides=(diameter, thickness),
    )


def solid_rectangle(width: float, height: float) -> Section:
    """Solid rectangle, width b along local y, height h along local z [m]; takes no water load.

    The extreme fibre is the corner, half a diagonal away.
    """
    require_positive("section.width", width, "m")
    require_positive("section.height", height, "m")
    return _of_plates(
        area=width * height,
        Iy=width * height**3 / 12,
        Iz=height * width**3 / 12,
        J=_rectangle_torsion(max(width, height), min(width, height)),
        outline=(width, height),
        wall=min(width, height),
        shape="solid-rectangle",
        sides=(width, height),
    )


def box(width: float, height: float, thickness: float) -> Section:
    """Rectangular tube, width along local y, height along local z, outer, and wall [m]; takes no water load.

    Torsion by Bredt's formula for thin walls, J = 4 Aₘ²/∮ds/t, with the wall's own J besides: ∮t³ds/3.
    """
    require_positive("section.width", width, "m")
    require_positive("section.height", height, "m")
    require_positive("section.thickness", thickness, "m")
    if not thickness < min(width, height) / 2:
        limit = f"must be < half the smaller side, {min(width, height) / 2:g} m"
        raise InputError("section.thickness", thickness, limit)
    b, h = width - 2 * thickness, height - 2 * thickness
    round_wall, enclosed = 2 * (width + height - 2 * thickness), (width - thickness) * (height - thickness)
    return _of_plates(
        area=width * height - b * h,
        Iy=(width * height**3 - b * h**3) / 12,
        Iz=(height * width**3 - h * b**3) / 12,
        J=4 * enclosed**2 * thickness / round_wall + round_wall * thickness**3 / 3,
        outline=(width, height),
        wall=thickness,
        shape="box",
        sides=(width, height, thickness),
    )


def i_beam(width: float, height: float, flange: float, web: float) -> Section:
    """Two flanges of this width, along local y, and thickness, on a web along local z [m]; takes no water load.

    Torsion of open thin walls, J = Σ b t³/3; what warping restrained at the ends adds is left out.
    """
    for name, value in (("width", width), ("height", height), ("flange", flange), ("web", web)):
        require_positive(f"section.{name}", value, "m")
    if not flange < height / 2:
        raise InputError("section.flange", flange, f"must be < half the height, {height / 2:g} m")
    if not web <= width:
        raise InputError("section.web", web, f"must be <= the width, {width:g} m")
    inner = height - 2 * flange
    return _of_plates(
        area=2 * width * flange + inner * web,
        Iy=(width * height**3 - (width - web) * inner**3) / 12,
        Iz=(2 * flange * width**3 + inner * web**3) / 12,
        J=(2 * width * flange**3 + (height - flange) * web**3) / 3,
        outline=(width, height),
        wall=max(flange, web),
        shape="i-beam",
        sides=(width, height, flange, web),
    )


def general(
    area: float,
    Iy: float,
    Iz: float,
    J: float,
    fibres: Sequence[tuple[float, float]],
    wall: float,
    diameter: float = 0.0,
) -> Section:
    """Any section about its principal axes, stressed at these fibres (y, z) [m]."""
    far = float(np.hypot(*np.array(fibres, float).T).max())
    return Section(
        area=area, Iy=Iy, Iz=Iz, J=J, Ip=Iy + Iz, fibre=far, diameter=diameter, wall=wall, corners=tuple(fibres)
    )


MAKERS: dict[str, Callable[..., Section]] = {
    "tube": tube,
    "solid-rectangle": solid_rectangle,
    "box": box,
    "i-beam": i_beam,
    "general": general,
}


def between(first: Section, last: Section, share: float) -> Section:
    """The section at a share of the way from one to another of the same shape, to which its sides go straight."""
    sides = ((1 - share) * a + share * b for a, b in zip(first.sides, last.sides, strict=True))
    a, b = first.shear_factor, last.shear_factor
    factor = None if a is None or b is None else (1 - share) * a + share * b
    return replace(MAKERS[first.shape](*sides), shear_factor=factor)


def _of_plates(*, outline: tuple[float, float], Iy: float, Iz: float, **given: Any) -> Section:
    """A doubly symmetric section whose extreme fibres are the corners of its outline."""
    y, z = outline[0] / 2, outline[1] / 2
    corners = ((y, z), (-y, z), (-y, -z), (y, -z))
    return Section(Iy=Iy, Iz=Iz, Ip=Iy + Iz, fibre=np.hypot(y, z), corners=corners, **given)


def tube_shear_factor(diameter: float, thickness: float, poisson: float) -> float:
    """Cowper's κ of a tube, J. Appl. Mech. 33 (1966): with m = inner over outer diameter

    κ = 6(1+ν)(1+m²)² / [(7+6ν)(1+m²)² + (20+12ν)m²].
    """
    m2 = (1 - 2 * thickness / diameter) ** 2
    return 6 * (1 + poisson) * (1 + m2) ** 2 / ((7 + 6 * poisson) * (1 + m2) ** 2 + (20 + 12 * poisson) * m2)


def rectangle_shear_factor(poisson: float) -> float:
    """Cowper's κ of a solid rectangle, both ways: 10(1+ν)/(12+11ν)."""
    return 10 * (1 + poisson) / (12 + 11 * poisson)


def _rectangle_torsion(a: float, b: float) -> float:
    """Saint-Venant's series, sides a >= b: J = ab³/3 [1 - 192/π⁵ (b/a) Σ_odd tanh(nπa/2b)/n⁵] [m4].

    Ten terms leave 1.2e-6 of a square's, less of others'.
    """
    n = np.arange(1, 20, 2)
    series = (np.tanh(n * np.pi * a / (2 * b)) / n**5).sum()
    return a * b**3 / 3 * (1 - 192 / np.pi**5 * b / a * series)
