"""The seam between objects and kernels: a scene becomes the arrays that the march reads."""

from collections.abc import Iterable
from functools import lru_cache, partial
from typing import Any, NamedTuple

import numpy as np
from scipy.linalg import block_diag

from solver import limits, motions
from solver.coupled import sliding, stretching
from solver.coupled.driving import driven
from solver.coupled.memory import Memory, gauss
from solver.coupled.modal import Structure
from solver.coupled.sliding import Places
from solver.coupled.support import PLANAR, Support
from solver.hydrodynamics.bem.coefficients import Hydrodynamics
from solver.hydrodynamics.hull.panel_hull import PanelHull
from solver.hydrodynamics.pressure.quadrature import WettedQuadrature, azimuths_for, quadrature
from solver.hydrodynamics.pressure.wetted_panels import WettedPanels, longest_side, wetted_panels
from solver.hydrodynamics.radiation.memory import RadiationMemory
from solver.keys import shared
from solver.mooring import SIX, line_stiffness, lines_of, none
from solver.multibody.bodies import Bodies
from solver.multibody.chain import PRISMATIC, REVOLUTE, Chain
from solver.multibody.joint_law import Couplings, EndStops, JointLaw, end_stops
from solver.multibody.load_table import NO_POINTS, Points, tables
from solver.multibody.moored import MooringRoom, Moorings
from solver.scene import DOFS, PER_AXIS, Float, Scene
from solver.sea.field import WaveField

Axis = tuple[bool, np.ndarray, tuple[float, float, float], int]  # see _chains
KNOWN = 8  # sets of rows, joint laws and structures that a process keeps, of each
SPIN = 3  # number of the first rotation among the six DOF
GAUSS = gauss(48)


class Layout(NamedTuple):
    """Where each driven quantity stands among the columns of the wave series."""

    field: slice
    excitation: slice
    modal: slice
    station: slice
    elevation: slice
    forces: slice  # what the wave's inertia load does to the frame's forces that are asked for
    water: slice  # of which loads up to the surface are reckoned, see stretching.rows


def carrier_axes(planar: bool) -> np.ndarray:
    """Axes of a node's motion as 6-DOF numbers: surge, heave, pitch, or all six."""
    return PLANAR if planar else np.arange(6)


def bodies(
    scene: Scene,
    field: WaveField,
    support: Support | None,
    hydrodynamics: Hydrodynamics | None,
    added_mass: np.ndarray,
    terms: tuple[int, ...],
    places: Places,
    rest: limits.Rest,
) -> Bodies:
    """Arrays of all floats; carrier coordinates only with an elastic support; terms of the wave field around each."""
    floats, water = scene.floats, scene.water
    nb = len(floats)
    carrier = carrier_axes(scene.planar) if support is not None else np.zeros(0, int)
    nc = nb * carrier.size
    chains = _chains(scene, carrier)
    n = max(map(len, chains), default=0)
    kind, coordinate = np.zeros((nb, n), np.int64), np.zeros((nb, n), np.int64)
    direction, point = np.zeros((nb, n, 3)), np.zeros((nb, n, 3))
    for b, chain in enumerate(chains):
        for i, (turns, along, through, number) in enumerate(chain):
            kind[b, i] = REVOLUTE if turns else PRISMATIC
            direction[b, i], point[b, i], coordinate[b, i] = along, through, number
    dofs = hydrodynamics.dofs if hydrodynamics else ()
    stiffness, buoyancy = _hydrostatics(scene, hydrodynamics)
    return Bodies(
        kind=kind,
        direction=direction,
        point=point,
        coordinate=coordinate,
        axes=np.array([len(chain) for chain in chains], np.int64),
        # Always floats: with an integer among the inputs all kernels would be compiled once more.
        reference=np.array([f.centre for f in floats], float).reshape(nb, 3),
        about=np.array(rest.places, float).reshape(nb, 3),
        mass=np.array([f.mass for f in floats], float),
        cog=np.array([f.cog for f in floats], float).reshape(nb, 3),
        inertia=np.array([f.inertia_tensor for f in floats], float).reshape(nb, 3, 3),
        nonlinear=np.array(scene.nonlinear, bool),
        first_term=np.cumsum([0, *terms]),
        surface_terms=np.array(terms_of(scene, field, limits.radii(scene)), np.int64),
        first_along=np.cumsum([0, *places.terms]),
        leader=np.array(places.leader, np.int64),
        reach=np.array(places.reach, float),
        **rules(scene, field),
        buoyancy=buoyancy,
        stiffness=stiffness,
        wave_direction=np.array([np.cos(scene.sea.heading), np.sin(scene.sea.heading)]),
        rho_g=float(water.density * water.gravity),
        gravity=float(water.gravity),
        depth=float(water.depth),
        wheeler=scene.settings.pressure == "wheeler",
        active=np.array([DOFS.index(d) for d in dofs], np.int64),
        added_mass=added_mass,
        turning=scene.settings.hydrodynamic_axes == "body",
        law=joint_law(floats, nc),
        mechanism=_per_axis(floats, "mechanism_inertia", nc),
        limit=limits.excursions(scene, field, terms, carrier, rest),
        lines=lines_of([f.lines for f in floats]),
        pulled=np.array([line_stiffness(f.lines, f.centre) for f in floats]).reshape(nb, 6, 6),
    )


def _chains(scene: Scene, freedoms: np.ndarray) -> list[list[Axis]]:
    """Of each float its axes from the support on: whether one turns, direction, point, coordinate.

    First the axes `freedoms` of the support's node, or all those of the float that carries it: both share coordinates.
    """
    chains: list[list[Axis]] = []
    first = len(scene.floats) * freedoms.size
    for b, (item, carrier) in enumerate(zip(scene.floats, scene.carriers, strict=True)):
        node = [(d >= SPIN, np.eye(3)[d % 3], item.hinge, b * freedoms.size + i) for i, d in enumerate(freedoms)]
        joint = [(*_axis(item, name), item.hinge, first + i) for i, name in enumerate(item.motion)]
        chains.append((node if carrier < 0 else chains[carrier]) + joint)
        first += len(item.motion)
    return chains


def _axis(item: Float, name: str) -> tuple[bool, np.ndarray]:
    """Whether a joint's axis turns, and its direction (3,)."""
    return not limits.slides(name), item.direction(name)


@lru_cache(maxsize=KNOWN)
def joint_law(items: tuple[Float, ...], carriers: int = 0) -> JointLaw:
    """The law of all joints' axes, its fields those of the floats; on the `carriers` coordinates before it is zero."""
    law = {name: _per_axis(items, name, carriers) for name in JointLaw._fields if name in PER_AXIS}
    stops = end_stops(*(_per_axis(items, f"end_stops.{name}", carriers) for name in EndStops._fields))
    lines = [none(len(f.motion)) if f.moored_at_a_point else f.moored for f in items]
    K, C = (block_diag(np.zeros((carriers, carriers)), *(each[i] for each in lines)) for i in range(2))
    law["stiffness"] += law["pto_stiffness"] + np.diag(K)
    law["damping"] += np.diag(C)
    law["preload"] += np.concatenate([np.zeros(carriers), *(each.pretension for each in lines)])
    # Side by side in memory as all other arrays are: kernels are compiled once more for any that are not.
    row, column = np.array(np.nonzero(((K != 0) | (C != 0)) & ~np.eye(len(K), dtype=bool)))
    couplings = Couplings(row, column, K[row, column], C[row, column])
    given = [NO_POINTS if axis is None else Points(*axis) for f in items for axis in f.pto_points]
    every = tables([NO_POINTS] * carriers + given)
    return JointLaw(**law, end_stops=stops, couplings=couplings, moorings=_moorings(items, carriers), tables=every)


def _moorings(items: tuple[Float, ...], carriers: int) -> Moorings:
    """Of the floats that are held at a point of theirs."""
    first = carriers + np.cumsum([0, *(len(f.motion) for f in items)])
    held = [(f, f.mooring, i) for f, i in zip(items, first, strict=False) if f.mooring and f.moored_at_a_point]
    m, n = len(held), max((len(f.motion) for f, _, _ in held), default=0)
    axes, kind, coordinate = (np.zeros(shape, np.int64) for shape in (m, (m, n), (m, n)))
    direction, hinge, point, at_rest = (np.zeros(shape) for shape in ((m, n, 3), (m, n, 3), (m, 3), (m, n, n)))
    K, C, pull = np.zeros((m, SIX, SIX)), np.zeros((m, SIX, SIX)), np.zeros((m, SIX))
    for k, (f, mooring, start) in enumerate(held):
        some = axes[k] = len(f.motion)
        kind[k, :some], coordinate[k, :some] = f.turns, start + np.arange(some)
        direction[k, :some], hinge[k, :some] = f.directions, f.hinge
        point[k], at_rest[k, :some, :some] = np.add(f.centre, mooring.point), f.moored.damping
        K[k], C[k], pull[k] = mooring.matrices
    room = MooringRoom(np.zeros(3), np.zeros((3, 3)), np.zeros((SIX, n)), *np.zeros((4, SIX)))
    return Moorings(axes, Chain(kind, direction, hinge, coordinate), point, K, C, pull, at_rest, room)


def _per_axis(floats: Iterable[Float], name: str, carriers: int) -> np.ndarray:
    """A quantity of all joints' axes among the coordinates (nz,); zero on carriers."""
    return np.concatenate([np.zeros(carriers), *(f.per_axis(name) for f in floats)])


def terms_of(scene: Scene, field: WaveField, radii: Iterable[float]) -> tuple[int, ...]:
    """Of the wave field's series about each float to within a radius [m]; none where the pressure is linear."""
    tolerance = scene.settings.field_tolerance
    return tuple(
        field.terms_for(radius, tolerance) if nonlinear else 0
        for radius, nonlinear in zip(radii, scene.nonlinear, strict=True)
    )


def rules(scene: Scene, field: WaveField) -> dict[str, Any]:
    """Fields of Bodies by which the pressure on each float is integrated; nothing where it is linear."""
    s, flat = scene.settings, motions.in_plane(scene)
    hulls = [None if isinstance(f.hull, PanelHull) else f.hull for f in scene.floats]
    summed = [hull if nonlinear else None for hull, nonlinear in zip(hulls, scene.nonlinear, strict=True)]
    rule = partial(
        quadrature,
        azimuths=azimuths_for(filter(None, summed), s.azimuths, field.mean_length),
        arc_points=s.arc_points,
        line_points=s.line_points,
        half=all(flat),
        mean_length=field.mean_length,
    )
    quadratures = [rule(hull) if hull else None for hull in summed]
    return {
        "meshed": np.array([hull is None for hull in hulls], bool),
        "rule": _stacked(quadratures),
        "patches": np.array([len(r.patch) if r else 0 for r in quadratures], np.int64),
        "panels": _panels(scene, field, flat),
    }


def _panels(scene: Scene, field: WaveField, flat: tuple[bool, ...]) -> WettedPanels:
    """Triangles of the floats that are meshes; none where the pressure is linear."""
    hulls = [
        f.hull if nonlinear and isinstance(f.hull, PanelHull) else None
        for f, nonlinear in zip(scene.floats, scene.nonlinear, strict=True)
    ]
    return wetted_panels(
        hulls,
        [longest_side(f.hull, scene.settings.panel_size, field) for f in scene.floats],
        [bool(hull and stays and hull.symmetry[1]) for hull, stays in zip(hulls, flat, strict=True)],
    )


def _stacked(quadratures: list[WettedQuadrature | None]) -> WettedQuadrature:
    """One rule for all floats, patches padded to the longest meridian; meshes have none."""
    present = [r for r in quadratures if r]
    if not present:
        none = np.zeros(0)
        patch, whole, azimuth = np.zeros((0, 0, 7)), np.zeros((0, 0, 0, 5)), np.zeros((0, 2))
        return WettedQuadrature(patch, whole, azimuth, 0.0, none, none, none, none, False)
    most = max(len(r.patch) for r in present)
    return present[0]._replace(
        patch=np.stack([_padded(r.patch if r else present[0].patch[:0], most) for r in quadratures]),
        whole=np.stack([_padded(r.whole if r else present[0].whole[:0], most) for r in quadratures]),
    )


def _padded(rows: np.ndarray, count: int) -> np.ndarray:
    return np.concatenate([rows, np.zeros((count - len(rows), *rows.shape[1:]))])


def _hydrostatics(scene: Scene, hydrodynamics: Hydrodynamics | None) -> tuple[np.ndarray, np.ndarray]:
    """Stiffness (nb, 6, 6) of buoyancy and buoyancy at rest (nb, 6), for linear floats."""
    nb = len(scene.floats)
    stiffness, buoyancy = np.zeros((nb, 6, 6)), np.zeros((nb, 6))
    if hydrodynamics is None:
        return stiffness, buoyancy
    nr = len(hydrodynamics.dofs)
    index = [DOFS.index(d) for d in hydrodynamics.dofs]
    for b in range(nb):
        block = slice(b * nr, (b + 1) * nr)
        stiffness[b][np.ix_(index, index)] = hydrodynamics.hydrostatic_stiffness[block, block]
        x, y, _ = scene.floats[b].hull.buoyancy_point
        buoyancy[b, 2:5] = hydrodynamics.displaced_mass[b] * scene.water.gravity * np.array([1.0, y, -x])
    return stiffness, buoyancy


@lru_cache(maxsize=KNOWN)
def structure(support: Support | None) -> Structure:
    """Modal arrays; empty without an elastic support."""
    if support is None:
        return Structure(np.zeros(0), np.zeros(0), np.zeros((0, 0)), np.zeros((0, 1, 0)), np.zeros(0), np.zeros(0))
    return Structure(
        omega=support.omega,
        damping=support.damping,
        carrier=np.ascontiguousarray(support.carrier),
        station=np.ascontiguousarray(support.station_shape.transpose(2, 1, 0)),
        drag=support.drag,
        scale=np.abs(support.shapes.reshape(-1, 6, support.omega.size)[:, :3]).max(axis=(0, 1)),
    )


def memory(fit: RadiationMemory | None, dt: float, directions: int) -> Memory:
    """Exact propagation of ṙ = βr + v over half and whole steps for v quadratic in time.

    Without a fit the memory of all `directions` is zero.
    """
    if fit is None:
        none, still = np.zeros((0, directions, directions), complex), np.zeros((2, 2, directions, directions))
        return Memory(none, np.zeros((2, 0), complex), np.zeros((2, 3, 0), complex), still)
    beta = np.asarray(fit.beta, complex)
    x, shares = GAUSS
    half = np.exp(np.outer(1 - x, beta * dt / 2))
    decay = np.exp(np.outer([0.5, 1.0], beta * dt))
    weight = dt * np.stack([shares[:, 0].T @ half, shares[:, 1].T @ half**2])
    residue = np.ascontiguousarray(fit.residue, dtype=complex)
    direct = np.einsum("pik,sjp->sjik", residue, weight[:, 1:]).real
    return Memory(residue, decay, weight, np.ascontiguousarray(direct))


def wave_rows(
    scene: Scene,
    field: WaveField,
    near: WaveField,
    support: Support | None,
    hydrodynamics: Hydrodynamics | None,
    terms: tuple[int, ...],
    reach: float,
    rest: limits.Rest,
) -> tuple[np.ndarray, Layout, Places]:
    """All rows (m, n) that the wave drives, where each quantity is, and how the loads of floats that slide are told.

    near: of the waves around the floats, within a reach [m] of their rest, terms: of the series around each. The
    pressure of other waves is linear.
    """
    every, kind = (True,) * len(scene.floats), scene.settings.froude_krylov
    wanted = (("diffraction", every, False),) * scene.settings.diffraction
    wanted += (("froude_krylov", every if kind == "linear" else scene.standing, False),) * (kind != "none")
    wanted += (("froude_krylov", scene.nonlinear, True),) * (near != field)
    # Still water has a frequency for form's sake, which the coefficients need not cover.
    known = hydrodynamics if scene.sea.amplitude.any() else None
    leaders, tolerance = sliding.leaders(scene, field), scene.settings.field_tolerance
    reaches = sliding.reaches(scene, leaders, near, terms, reach, rest)
    return _rows(field, near, rest.places, support, known, terms, wanted, leaders, reaches, tolerance)


Wanted = tuple[tuple[str, tuple[bool, ...], bool], ...]  # kind of force, floats, whether only of waves not near


@lru_cache(maxsize=KNOWN)
def _rows(
    field: WaveField,
    near: WaveField,
    centres: tuple[tuple[float, ...], ...],
    support: Support | None,
    hydrodynamics: Hydrodynamics | None,
    terms: tuple[int, ...],
    wanted: Wanted,
    leaders: tuple[int, ...],
    reaches: tuple[float, ...],
    tolerance: float,
) -> tuple[np.ndarray, Layout, Places]:
    """Tasks that differ in their joints alone share them."""
    n, nb = field.sea.omega.size, len(centres)
    frame = driven(support, field) if support else None
    around = (near.local_pressure(np.array(c), m).reshape(-1, n) for c, m in zip(centres, terms, strict=True) if m)
    excitation, active = np.zeros((nb, 6, n), complex), np.zeros(0, int)
    if hydrodynamics is not None:
        active = np.array([DOFS.index(d) for d in hydrodynamics.dofs])
        excitation[:, active] = _excitation(field, near, nb, hydrodynamics, wanted)
    places = sliding.places(excitation[:, active], field.k, leaders, reaches, tolerance)
    swing = np.zeros((nb, 1, n))  # which asks for the system, see preparation
    moved = sliding.rows(np.concatenate([excitation[:, active], swing], axis=1), field.k, places)
    excitation[np.array(places.terms, int) > 0] = 0.0
    parts = [
        np.concatenate([np.zeros((0, n)), *around, moved.reshape(-1, n)]),
        excitation.reshape(-1, n),
        frame.modes if frame else np.zeros((0, n)),
        frame.stations.transpose(1, 0, 2).reshape(-1, n) if frame else np.zeros((0, n)),
        field.elevation(np.zeros((1, 3))),
        frame.forces if frame else np.zeros((0, n)),
        stretching.rows(support.stretched, field) if support and support.stretched else np.zeros((0, n)),
    ]
    ends = np.cumsum([0] + [len(p) for p in parts])
    columns = [slice(int(a), int(b)) for a, b in zip(ends[:-1], ends[1:], strict=True)]
    return shared(np.concatenate(parts, dtype=complex)), Layout(*columns), places


def _excitation(field: WaveField, near: WaveField, nb: int, hydrodynamics: Hydrodynamics, wanted: Wanted) -> np.ndarray:
    """Rows (nb, nr, n) of the kinds of force that are wanted."""
    sea, nr = field.sea, len(hydrodynamics.dofs)
    force = np.zeros((sea.omega.size, nb * nr), complex)
    for kind, floats, rest in wanted:
        if any(floats):
            part = hydrodynamics.excitation(sea.omega, kind) * np.repeat(floats, nr)
            force += part * (near.sea.amplitude == 0)[:, None] if rest else part
    return (force * sea.amplitude[:, None]).T.reshape(nb, nr, -1)
