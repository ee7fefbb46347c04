"""Sentences on a frame whose numbers look as of other units: its materials, what grows on it, what loads its feet."""

from collections.abc import Iterable, Iterator

import numpy as np

from solver.structure.frame import Frame
from solver.structure.load_history import LoadHistory
from solver.structure.members import Material, Member

TONNES = 0.3, 25.0  # [t/m3] that frames are of, timber to heavy metal; some are of nothing, or next to it
MODULI = 1e8, 1e13  # [Pa]: soft plastics have more, and what is made next to rigid less
POISSON = -0.1, 0.5  # of what is isotropic; cork has 0
YIELDS = 1e6, 3e9  # [Pa]: foam has more, and no wire is as strong


def of_materials(members: Iterable[Member]) -> Iterator[str]:
    """Sentences for densities in t/m³, and for moduli and strengths that no material has."""
    materials = dict.fromkeys(m.material for m in members)
    low, high = TONNES
    for density in sorted({m.density for m in materials if low < m.density < high}):
        yield f"platform.materials: density {density:g} kg/m3 is of no frame: is it in t/m3?"
    for material in materials:
        yield from _of_stiffness(material)


def _of_stiffness(material: Material) -> Iterator[str]:
    E, G, strength, (low, high) = material.E, material.G, material.yield_strength, MODULI
    if not low <= E <= high:
        yield f"platform.materials: E = {E:g} Pa is of no material, {low:g} to {high:g} Pa: is it in MPa or GPa?"
    elif not POISSON[0] <= material.poisson <= POISSON[1]:
        yield (
            f"platform.materials: E = {E:g} Pa and G = {G:g} Pa make Poisson's ratio E/2G - 1 = {material.poisson:.3g},"
            f" and materials have {POISSON[0]:g} to {POISSON[1]:g}: is one of them in other units?"
        )
    low, high = YIELDS
    if strength is not None and not low <= strength <= high:
        yield (
            f"platform.materials: yield_strength = {strength:g} Pa is of no material, {low:g} to {high:g} Pa: is it in"
            " MPa?"
        )


def of_growth(frame: Frame) -> Iterator[str]:
    """A sentence for the member on which most grows, where that is more than its radius."""
    grown = {m.name: _growth(frame, m) for m in frame.members if frame.growth and m.section.diameter > 0}
    thick = [(layer, radius, name) for name, (layer, radius) in grown.items() if layer > radius]
    if thick:
        (layer, radius, name), more = max(thick), f" and {len(thick) - 1} more" if len(thick) > 1 else ""
        yield (
            f"platform.marine_growth: {layer:g} m all round {name}{more}, whose radius is {radius:g} m: is the"
            " thickness in mm?"
        )


def _growth(frame: Frame, member: Member) -> tuple[float, float]:
    """The thickest layer in water, and the member's largest radius [m]."""
    foot, top = np.clip(np.sort(frame.ends(member)[:, 2]), frame.seabed, np.inf)
    levels = np.clip([foot, top, *(-line.depth for line in frame.growth)], foot, top)
    layer = frame.grown(levels)[0].max() if foot < 0 else 0.0
    return float(layer), max(section.diameter for section in member.sections) / 2


def on_feet(frame: Frame, histories: Iterable[LoadHistory]) -> Iterator[str]:
    """A sentence for loads on nodes that are clamped."""
    for key, loads in (("loads", frame.loads), ("load_histories", histories)):
        for node in dict.fromkeys(load.node for load in loads if load.node in frame.clamped):
            yield f"platform.{key}: {node} is clamped, where a load moves nothing: is the node another?"


def of_twins(members: Iterable[Member]) -> Iterator[str]:
    """A sentence for members that lie in each other, between the same two ends."""
    first: dict[frozenset[tuple[str, tuple[float, ...]]], str] = {}
    for m in members:
        ends = frozenset([(m.start, m.start_offset), (m.end, m.end_offset)])
        if (other := first.setdefault(ends, m.name)) != m.name:
            where = f"platform.members.{m.name}: lies in {other}, between the same nodes"
            yield f"{where}, and adds its stiffness to that: is it given twice?"
