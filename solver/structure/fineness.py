"""How many elements a member needs, by what their shapes leave out between nodes; `record.elements` says what it does.

An element clamped at both ends would move within by its own inertia, bending by mL⁴(1 + 5φ)/720EI of its ends'
amplitude times ω² and stretching by mL²/12EA: the energy of that is the share of a motion's by which its ω² comes out
too large. Soil holds it as -mω² does. Of a tapered member each element has the section of its middle: where stiffness
changes by the factor exp(d) along one, its mean flexibility is sinh(½d)/½d = 1 + d²/24 of that. The number goes by the
member alone, not by the sea: tasks of a study then share heights.
"""

from dataclasses import replace

import numpy as np

from solver.errors import InputError
from solver.structure import beam
from solver.structure.frame import Frame
from solver.structure.members import Member
from solver.structure.sections import Section

LEFT_OUT = 1e-4  # of a motion's energy at most
SHORTEST = 5.0  # diameters of the shortest wave for which Morison's equation stands (DNV-RP-C205, 6.1)
FEWEST, MOST = 4, 64  # with four a pinned column's Euler load is right to 5e-4, and a leg has five heights
MOST_OF_ALL = 10_000


def by_inertia(member: Member, section: Section, L: float, density: float, growth: np.ndarray) -> float:
    """Of an element of length L, over ω² [s²]; it carries the water's mass, too, and, if it is round, growth of a
    thickness [m] and a density [kg/m3] (2,)."""
    material, (thickness, of_growth) = member.material, growth
    layers = 0.0, 2 * thickness * (section.diameter > 0)
    bare, whole = (np.pi / 4 * (section.diameter + layer) ** 2 for layer in layers)
    displaced = (member.inertia_coefficient - 1) * whole
    mass = material.density * section.area + density * (displaced + section.hollow * bool(member.flooded))
    mass += of_growth * (whole - bare)
    return mass * max(_bending(member, section, L), L**2 / (12 * material.E * section.area))


def by_soil(member: Member, section: Section, L: float, stiffness: np.ndarray) -> float:
    """Of an element of length L in soil of a stiffness along, across and about it (3,)."""
    along, across, about = stiffness
    stretched = np.array([along / (member.material.E * section.area), about / (member.material.G * section.J)])
    return max(across * _bending(member, section, L), float(stretched.max()) * L**2 / 12)


def by_taper(member: Member) -> float:
    """Of the worst quantity of its section, of each of its elements."""
    sections = [member.section_at(share) for share in (0.0, 1.0)]
    change = np.ptp(np.log([[s.area, s.Iy, s.Iz] for s in sections]), axis=0).max()
    return float((change / member.elements) ** 2 / 24)


def _bending(member: Member, section: Section, L: float) -> float:
    """L⁴(1 + 5φ)/720EI in the softer plane [m2/N]."""
    E = member.material.E
    shear = beam.shear_parameters(E, member.material.G, section, L)
    return max(L**4 * (1 + 5 * phi) / (720 * E * I) for phi, I in zip(shear, (section.Iz, section.Iy), strict=True))


def divided(frame: Frame, undivided: set[str], *, density: float, gravity: float) -> Frame:
    """With as many elements as the members named in `undivided` need, in powers of two; InputError for too many."""
    members = tuple(
        replace(m, elements=_enough(frame, m, density, gravity)) if m.name in undivided else m for m in frame.members
    )
    if (count := sum(m.elements for m in members)) > MOST_OF_ALL:
        raise InputError("members", f"{count} elements", f"must be <= {MOST_OF_ALL}")
    return replace(frame, members=members)


def thickest(frame: Frame, ends: np.ndarray) -> np.ndarray:
    """Thickness and density (2,) of the most growth on what lies between ends (2, 3), wet or not."""
    low, high = np.sort(ends[:, 2])
    between = [(line.thickness, line.density) for line in frame.growth if low < -line.depth < high]
    return np.max([*np.transpose(frame.grown(np.array([low, high]))), *between], axis=0)


def _enough(frame: Frame, member: Member, density: float, gravity: float) -> int:
    ends = frame.ends(member)
    L = float(np.linalg.norm(ends[1] - ends[0]))
    soil = frame.soil.points(ends) if frame.soil is not None else ()
    stiffness = np.max([np.zeros(3), *(there for _, _, there in soil)], axis=0)
    sections = [member.section_at(share) for share in (0.0, 1.0)]
    growth = thickest(frame, ends)
    elements = FEWEST
    while (
        elements < MOST
        and max(
            by_taper(replace(member, elements=elements)),
            *(_left_out(member, section, L / elements, density, gravity, stiffness, growth) for section in sections),
        )
        > LEFT_OUT
    ):
        elements *= 2
    return elements


def _left_out(
    member: Member,
    section: Section,
    L: float,
    density: float,
    gravity: float,
    stiffness: np.ndarray,
    growth: np.ndarray,
) -> float:
    diameter = np.sqrt(8 * min(section.Iy, section.Iz) / section.area)  # of a thin tube
    omega2 = 2 * np.pi * gravity / (SHORTEST * diameter)
    return omega2 * by_inertia(member, section, L, density, growth) + by_soil(member, section, L, stiffness)
