"""The part of a frame below still water (z = 0): stations for wave loads, added mass, buoyancy.

Morison's load per length normal to a member, eq. 16, fluid u, member v:

    f = ½ρ C_D D|u - v|(u - v) + ρπD²/4 [C_M ∂u/∂t - (C_M - 1) ∂v/∂t]

Its last term is the added mass here; `solver.coupled.modal` and `surroundings` have the others. D and the area are
those of member and marine growth together, D = D₀ + 2t (NORSOK N-003, DNV-RP-C205): the growth weighs and moves as a
mass all round the member, displaces water, and does nothing to stiffness and stress.
"""

from dataclasses import dataclass
from functools import lru_cache
from itertools import pairwise
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike
from scipy import sparse

from solver.errors import InputError
from solver.structure import beam, statics
from solver.structure.frame_model import FrameModel, sparse_sum

EXACT = 4  # stations for the product of two cubics (order 6), however deep the water reaches into an element
GROWN = 5  # the same times an area and a density that change with depth (order 9)


class Splash(NamedTuple):
    """What waves wet now and then, about still water, and where what flows there bends."""

    reach: float = 0.0  # height of a crest that no wave exceeds [m]
    height: float = 0.0  # that many do: so far above and below still water pieces are short [m]
    longest: float = np.inf  # of these [m]
    bends: tuple[float, ...] = ()  # heights [m], as those of the lines of a current's table


DRY = Splash()


def wetted_span(model: FrameModel, seabed: float = -np.inf, surface: float = 0.0) -> np.ndarray:
    """Part (s0, s1) of each element below a surface [m] and above the seabed, (ne, 2); s0 = s1 for one without."""
    z = model.ends[:, :, 2]
    rise = (z[:, 1] - z[:, 0])[:, None]
    in_water = np.clip(z, seabed, surface)
    span = np.where(rise == 0, [0.0, 1.0], (in_water - z[:, :1]) / np.where(rise == 0, 1, rise))
    dry = (z.min(axis=1) >= surface) | (z.max(axis=1) <= seabed)
    return np.where(dry[:, None], 0, span)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Stations:
    """Gauss points on the wetted part of the members with water coefficients, ns of them."""

    position: np.ndarray  # (ns, 3) [m]
    weight: np.ndarray  # (ns,) length that the point stands for [m]
    reach: np.ndarray  # (ns, 2) along the member from the point to where that begins and ends [m]
    tangent: np.ndarray  # (ns, 3) unit vector along the member
    diameter: np.ndarray  # (ns,) outer, of the growth if there is any [m]
    layer: np.ndarray  # (ns,) area of the growth [m2]
    layer_density: np.ndarray  # (ns,) [kg/m3]
    drag: np.ndarray  # (ns,) C_D [-]
    inertia: np.ndarray  # (ns,) C_M [-]
    element: np.ndarray  # (ns,) element number
    along: np.ndarray  # (ns,) where in it, from 0 to 1
    dofs: np.ndarray  # (ns, 12) degrees of freedom of that element
    shape: np.ndarray  # (ns, 3, 12) displacement there = shape @ displacement[dofs], global axes

    def project(self, shapes: np.ndarray) -> np.ndarray:
        """Displacement of the stations in each column of a modal matrix (6n, nm): (ns, 3, nm)."""
        return self.shape @ shapes[self.dofs]


def stations(
    model: FrameModel, points: int, longest: float = np.inf, splash: Splash = DRY, share: float = np.inf
) -> Stations:
    """Gauss points, `points` on each piece of an element that is or gets wet: exact to order 2 points - 1.

    longest: of the equal pieces [m], for loads that vary along an element by more than its shape functions; share: at
    most, of what of the member gets wet.
    """
    if points < 1:
        raise InputError("stations.points", points, "must be >= 1")
    length, height, whole = _wet_parts(model, splash)
    most = np.where(height < splash.height, min(longest, splash.longest), longest)
    most = np.minimum(most, share * whole)
    pieces = np.ceil(length / most).astype(int).clip(min=1)
    return _pieces(model, points, tuple(pieces.tolist()), splash)


@lru_cache(maxsize=8)
def _wet_parts(model: FrameModel, splash: Splash) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Length of each part of an element with water coefficients, its middle's distance to still water, and the length
    of all parts of its member (n,) [m]."""
    wet, span = _wet(model, np.array([member.in_water for member in model.frame.members]), splash)
    start, end = model.ends[wet, :, 2].T
    length = np.diff(span)[:, 0] * model.length[wet]
    return length, np.abs(start + span.mean(axis=1) * (end - start)), of_members(model, wet, length)


def of_members(model: FrameModel, element: np.ndarray, length: np.ndarray) -> np.ndarray:
    """Of lengths (n,) along some elements: the sum of all along the same member (n,) [m]."""
    member = model.member[element]
    return np.asarray(np.bincount(member, length)[member])


@lru_cache(maxsize=8)
def _pieces(model: FrameModel, points: int, pieces: tuple[int, ...], splash: Splash) -> Stations:
    """In so many pieces of each wetted element; seas whose shortest waves are nearly the same share them."""
    return _stations(model, points, pieces, np.array([member.in_water for member in model.frame.members]), splash)


def _wet(model: FrameModel, members: np.ndarray, splash: Splash = DRY) -> tuple[np.ndarray, np.ndarray]:
    """The elements (n,) of some of the members (mask) that get wet, and which part of each (n, 2).

    At still water, where pieces become short, and where the growth's table or the flow has a line, it is taken in
    several.
    """
    span = wetted_span(model, model.frame.seabed, splash.reach)
    wet = np.flatnonzero(members[model.member] & (span[:, 1] > span[:, 0]))
    levels = [*(-line.depth for line in model.frame.growth), *splash.bends]
    if splash.reach > 0:
        levels += [-splash.height, 0.0, splash.height]
    if not levels:
        return wet, span[wet]
    parts = [(e, pair) for e in wet.tolist() for pair in pairwise(_cuts(model, e, span[e], levels))]
    return np.array([e for e, _ in parts], int), np.array([pair for _, pair in parts]).reshape(-1, 2)


def _cuts(model: FrameModel, e: int, span: np.ndarray, levels: list[float]) -> np.ndarray:
    """Where an element's span begins, passes one of some levels [m], and ends (n,), in order."""
    z0, z1 = model.ends[e, :, 2]
    if z0 == z1:
        return span
    s = (np.array(levels) - z0) / (z1 - z0)
    return np.unique(np.concatenate([span, s[(s > span[0]) & (s < span[1])]]))


def _stations(model: FrameModel, points: int, pieces: ArrayLike, members: np.ndarray, splash: Splash = DRY) -> Stations:
    """On those of the members (mask), in so many pieces of each part that gets wet; nothing grows above z = 0."""
    node, gauss = np.polynomial.legendre.leggauss(points)
    wet, span = _wet(model, members, splash)
    pieces = np.broadcast_to(np.asarray(pieces, int), wet.shape)
    part = np.concatenate([np.zeros(0), *(np.arange(n) for n in pieces)])
    start, size = span[:, :1].repeat(pieces, axis=0), np.repeat(np.diff(span) / pieces[:, None], pieces, axis=0)
    wet = np.repeat(wet, pieces)
    bounds = np.cumsum([0.0, *gauss]) - 1  # of what each point stands for in a piece from -1 to 1
    reach = np.stack([bounds[:-1] - node, bounds[1:] - node], axis=1)
    element = np.repeat(wet, points)
    s = (start + size * (part[:, None] + (node + 1) / 2)).ravel()
    start, end = model.ends[element].transpose(1, 0, 2)
    owner = [model.member_of(e) for e in element.tolist()]
    position = start + s[:, None] * (end - start)
    thickness, layer_density = model.frame.grown(position[:, 2])
    thickness = np.where(position[:, 2] > 0, 0.0, thickness)
    bare = np.array([model.sections[e].diameter for e in element.tolist()])
    diameter = bare + 2 * thickness
    return Stations(
        position=position,
        weight=(size * gauss / 2 * model.length[wet, None]).ravel(),
        reach=((size * model.length[wet, None] / 2)[..., None] * reach).reshape(-1, 2),
        tangent=model.rotation[element, 0],
        diameter=diameter,
        layer=np.pi / 4 * (diameter**2 - bare**2),
        layer_density=layer_density,
        drag=np.array([member.drag_coefficient for member in owner]),
        inertia=np.array([member.inertia_coefficient for member in owner]),
        element=element,
        along=s,
        dofs=model.dofs[element],
        shape=_shapes(model, element, s),
    )


def _shapes(model: FrameModel, element: np.ndarray, s: np.ndarray) -> np.ndarray:
    shape = np.zeros((len(s), 3, 12))
    for i, (e, station) in enumerate(zip(element, s, strict=True)):
        local = model.released(e, beam.displacement_shape(station, model.length[e], model.shear[e]))
        shape[i] = beam.in_global(local, model.transform[e])
    return shape


@lru_cache(maxsize=8)
def added_mass(model: FrameModel, density: float) -> sparse.csr_array:
    """Consistent added mass, sparse (6n, 6n): ∫ (C_M - 1) ρπD²/4 Nᵀ(I - ttᵀ)N dx, wetted part."""
    return _sum(model, *_added(model, density))


@lru_cache(maxsize=8)
def inner_mass(model: FrameModel, density: float) -> sparse.csr_array:
    """Of the water in flooded members, which moves with them across their axes, sparse (6n, 6n)."""
    return _sum(model, *_inner(model, density))


def element_masses(model: FrameModel, density: float, elements: np.ndarray) -> np.ndarray:
    """Added mass, inner water and growth of some elements (k, 12, 12), global axes [kg, kg m, kg m2]."""
    parts = (_added(model, density), _inner(model, density), _grown(model))
    each = [[matrices[at.element == e].sum(axis=0) for e in elements] for at, matrices in parts]
    return np.sum(each, axis=0).reshape(-1, 12, 12)


def _inner(model: FrameModel, density: float) -> tuple[Stations, np.ndarray]:
    at = _stations(model, EXACT, 1, np.array([bool(member.flooded) for member in model.frame.members]))
    hollow = np.array([model.sections[e].hollow for e in at.element.tolist()])
    return at, _normal_matrices(at, density * hollow)


@lru_cache(maxsize=8)
def growth_mass(model: FrameModel) -> sparse.csr_array:
    """Of the growth, in all directions, sparse (6n, 6n); without its inertia about the member's axis."""
    return _sum(model, *_grown(model))


def _layers(model: FrameModel) -> Stations:
    """Stations on all members that something may grow on; none where nothing does."""
    grows = bool(model.frame.growth)
    return _stations(model, GROWN, 1, np.array([grows and m.section.diameter > 0 for m in model.frame.members]))


def _grown(model: FrameModel) -> tuple[Stations, np.ndarray]:
    at = _layers(model)
    mass = at.layer_density * at.layer * at.weight
    return at, mass[:, None, None] * (at.shape.transpose(0, 2, 1) @ at.shape)


def _added(model: FrameModel, density: float) -> tuple[Stations, np.ndarray]:
    at = stations(model, EXACT)
    return at, _normal_matrices(at, (at.inertia - 1) * density * np.pi * at.diameter**2 / 4)


@lru_cache(maxsize=8)
def drag_matrix(model: FrameModel) -> sparse.csr_array:
    """∫ C_D D Nᵀ(I - ttᵀ)N dx over the wetted part, sparse (6n, 6n): how drag is spread over the frame."""
    at = stations(model, EXACT)
    return _sum(model, at, _normal_matrices(at, at.drag * at.diameter))


def normal_planes(at: Stations) -> np.ndarray:
    """Projection on the plane normal to the member at each station (ns, 3, 3)."""
    return np.eye(3) - at.tangent[:, :, None] * at.tangent[:, None, :]


def _normal_matrices(at: Stations, per_length: np.ndarray) -> np.ndarray:
    """Each station's share (ns, 12, 12) of ∫ c Nᵀ(I - ttᵀ)N dx, of c (ns,): normal to the member only."""
    return (per_length * at.weight)[:, None, None] * (at.shape.transpose(0, 2, 1) @ normal_planes(at) @ at.shape)


def _sum(model: FrameModel, at: Stations, matrices: np.ndarray) -> sparse.csr_array:
    """Of all stations, sparse (6n, 6n)."""
    return sparse_sum(matrices, at.dofs, at.dofs, model.K.shape)


@lru_cache(maxsize=8)
def buoyancy(model: FrameModel, density: float, g: float) -> np.ndarray:
    """Buoyancy ρgA of each element below z = 0, local axes [N, N m], (ne, 12).

    Every member below still water displaces water, with or without water coefficients: its material, and what is
    inside of it if it is sealed. With it N is the effective axial force, the wall's own and the pressures' on it.
    """
    sealed = np.array([m.flooded is False for m in model.frame.members])[model.member]
    area = np.array([s.area + s.hollow * inside for s, inside in zip(model.sections, sealed, strict=True)])
    up = density * g * area[:, None] * (model.rotation @ [0.0, 0.0, 1.0])
    parts = zip(up, model.length, wetted_span(model), model.shear, strict=True)
    return np.array([model.released(e, beam.distributed_load(*part)) for e, part in enumerate(parts)])


@lru_cache(maxsize=8)
def growth_load(model: FrameModel, density: float, g: float) -> np.ndarray:
    """Buoyancy less weight of the growth on each element, (ρ - ρ_g) g A, local axes [N, N m], (ne, 12)."""
    at, loads = _layers(model), np.zeros((len(model.length), 12))
    lift = (density - at.layer_density) * g * at.layer * at.weight
    for e, s, force in zip(at.element.tolist(), at.along.tolist(), lift.tolist(), strict=True):
        shape = model.released(e, beam.displacement_shape(s, model.length[e], model.shear[e]))
        loads[e] += force * model.rotation[e, :, 2] @ shape
    return loads


def spread_load(model: FrameModel, density: float, g: float) -> np.ndarray:
    """All that loads each element along its length at rest, local axes [N, N m], (ne, 12)."""
    further = growth_load(model, density, g) + statics.distributed_load(model)
    return statics.self_weight(model, g) + buoyancy(model, density, g) + further


def static_load(model: FrameModel, density: float, g: float) -> np.ndarray:
    """Weight, point loads, distributed loads, and buoyancy of the steel and of what grows on it (6n,) [N, N m]."""
    further = model.total(growth_load(model, density, g) + statics.distributed_load(model))
    return statics.gravity_load(model, g) + statics.point_load(model) + buoyancy_load(model, density, g) + further


def buoyancy_load(model: FrameModel, density: float, g: float) -> np.ndarray:
    """Buoyancy of the members below still water [N, N m], (6n,)."""
    return model.total(buoyancy(model, density, g))
