"""Resistance of tubes by NORSOK N-004 (Rev. 3, 2013), 6.3: to axial force, buckling, bending, shear and torsion.

Eqs. 6.1 to 6.14, for D/t < 120, and in full size for t >= 6 mm. γ_M of 6.3.7 is 1.15 but for slender walls, whose
largest is 1.45. Hydrostatic pressure (6.3.6, 6.3.9) is not here.
"""

from collections.abc import Iterable, Iterator
from typing import NamedTuple

import numpy as np

from solver.errors import InputError
from solver.structure.members import Member

LOCAL = 0.3  # C_e of elastic local buckling
SLENDER = 0.25  # f_y/f_cle, whose root is λ_s = 0.5: beyond it γ_M may be larger than 1.15
LARGEST_FACTOR = 1.45
STRONGEST = 0.05  # f_y/E: no metal has as much, and high-strength steel a tenth of it
THINNEST, MOST_SLENDER = 6e-3, 120.0  # t [m] and D/t


class Resistance(NamedTuple):
    """Design resistances of tubes (…,) [N, N m]; N_E is Euler's load."""

    tension: np.ndarray  # N_t,Rd
    column: np.ndarray  # N_c,Rd
    local: np.ndarray  # N_cl,Rd
    bending: np.ndarray  # M_Rd
    shear: np.ndarray  # V_Rd
    torsion: np.ndarray  # M_T,Rd
    euler: np.ndarray  # N_E
    moment_factor: np.ndarray  # C_m, of both axes


def may_be_utilised(member: Member) -> bool:
    """Whether its section is a circular tube, and its yield strength is known."""
    tube = member.section.diameter > 0 and not member.section.corners
    return tube and member.material.yield_strength is not None


def resistance(member: Member, length: float, material_factor: float) -> Resistance:
    """Of a tube that buckles over an effective length kl [m]; InputError where 6.3 is not for it."""
    D, t, fy, E = member.section.diameter, member.section.wall, member.material.yield_strength, member.material.E
    assert fy is not None, "asked of a member with a yield strength"
    _require_in_range(member, fy, material_factor)
    A, inertia = member.section.area, member.section.Iy
    fcl, fE = local_strength(fy, E, D, t), np.pi**2 * E * inertia / (A * length**2)
    return Resistance(
        tension=np.array(A * fy / material_factor),
        column=np.array(A * column_strength(fcl, fE) / material_factor),
        local=np.array(A * fcl / material_factor),
        bending=np.array(bending_strength(fy, E, D, t) * inertia / (D / 2) / material_factor),
        shear=np.array(A / 2 * fy / np.sqrt(3) / material_factor),
        torsion=np.array(2 * member.section.Ip / D * fy / np.sqrt(3) / material_factor),
        euler=np.array(A * fE),
        moment_factor=np.array(member.moment_factor),
    )


def too_thin(members: Iterable[Member]) -> Iterator[str]:
    """A sentence for the thinnest of the tubes that are utilised, where 6.3 is for thicker ones."""
    tubes = sorted(filter(may_be_utilised, members), key=lambda member: member.section.wall)
    thin = [member for member in tubes if member.section.wall < THINNEST]
    if thin:
        more = f" and {len(thin) - 1} more" if len(thin) > 1 else ""
        yield (
            f"platform.members.{thin[0].name}.section.thickness = {thin[0].section.wall:g}{more}: N-004, 6.3, is for"
            f" tubes of {THINNEST:g} m or more; its formulas are the same at any scale, so `utilisation` is told of a"
            " model's thinner ones, too"
        )


def of_no_metal(members: Iterable[Member]) -> Iterator[InputError]:
    """An error for each material of tubes whose yield strength is too large beside its E, at the first that has it."""
    for material, name in {m.material: m.name for m in reversed([*members])}.items():
        fy, E = material.yield_strength, material.E
        if fy is not None and fy > STRONGEST * E:
            given = f"E = {E:g} Pa, yield_strength = {fy:g} Pa"
            limit = f"must yield at <= {STRONGEST:g} E, for utilisation by N-004, 6.3: are both in Pa?"
            yield InputError(f"platform.members.{name}.material", given, limit)


def _require_in_range(member: Member, fy: float, material_factor: float) -> None:
    key, D, t = f"platform.members.{member.name}", member.section.diameter, member.section.wall
    if D / t >= MOST_SLENDER:
        limit = f"must be > {D / MOST_SLENDER:.4g} m, D/120, for utilisation by N-004, 6.3"
        raise InputError(f"{key}.section.thickness", t, limit)
    if fy / elastic_strength(member.material.E, D, t) > SLENDER and material_factor < LARGEST_FACTOR:
        limit = f"must be >= {LARGEST_FACTOR:g}, N-004's largest (6.3.7), with the slender wall of {key}"
        raise InputError("settings.utilisation.material_factor", material_factor, limit)


def elastic_strength(E: float, D: float, t: float) -> float:
    """f_cle = 2 C_e E t/D of local buckling [Pa]."""
    return 2 * LOCAL * E * t / D


def local_strength(fy: float, E: float, D: float, t: float) -> float:
    """f_cl [Pa], eqs. 6.6 to 6.8."""
    ratio = fy / elastic_strength(E, D, t)
    if ratio <= 0.170:
        return fy
    return (1.047 - 0.274 * ratio) * fy if ratio <= 1.911 else fy / ratio


def column_strength(fcl: float, fE: float) -> float:
    """f_c [Pa] by the slenderness λ = √(f_cl/f_E), eqs. 6.3 to 6.5."""
    square = fcl / fE
    return (1.0 - 0.28 * square) * fcl if square <= 1.34**2 else 0.9 / square * fcl


def bending_strength(fy: float, E: float, D: float, t: float) -> float:
    """f_m [Pa], eqs. 6.10 to 6.12, with the plastic modulus Z over the elastic one W."""
    d, slenderness = D - 2 * t, fy * D / (E * t)
    shape = (D**3 - d**3) / 6 / (np.pi / 32 * (D**4 - d**4) / D)
    if slenderness <= 0.0517:
        return shape * fy
    if slenderness <= 0.1034:
        return (1.13 - 2.58 * slenderness) * shape * fy
    return (0.94 - 0.76 * slenderness) * shape * fy
