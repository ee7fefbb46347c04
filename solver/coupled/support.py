"""An elastic platform as the march sees it: few Ritz modes (eq. 17), drag stations, wave-load rows (eq. 16).

The basis is the lowest modes, and those that load histories set swinging, plus the static shapes of what loads the
frame (unit loads at the hinge nodes, the principal shapes of the wave load), made orthogonal again by Rayleigh-Ritz.
The static shapes carry what the left-out modes would have added quasi-statically. The mass
includes the added mass of the wetted members, because that is the mass that moves.
"""

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import lru_cache
from typing import Literal, NamedTuple

import numpy as np
from scipy import sparse

from solver.coupled import forces, stretching
from solver.coupled.drag import station_drag
from solver.coupled.forces import Forces
from solver.coupled.places import Places, places_of
from solver.coupled.ritz import kept_modes, loaded_by, rest_of, ritz_basis, thrust, tops_of, unit_loads, with_swung
from solver.coupled.stretching import Stretched
from solver.coupled.surroundings import (
    Surroundings,
    drag_size,
    inertia_size,
    load_of_stream,
    nodal_loads,
    normal_stream,
    onto_nodes,
    surroundings,
)
from solver.coupled.typical import typical_waves
from solver.errors import InputError
from solver.keys import shared
from solver.lines import real_parts
from solver.scene import Platform, StructuralDamping, Water
from solver.sea.field import WaveField
from solver.structure import fineness, in_water, legs, water
from solver.structure import modes as natural
from solver.structure.frame_model import FrameModel
from solver.structure.legs import Legs

# Pieces of an element in which loads are integrated: of 1/k of the shortest wave for inertia, whose EXACT points are
# then right to 2e-5 of it, and of the mean wave for drag; for shapes that bend along a member, of what of it is wet.
INERTIA, DRAG, BENT = 4.0, 1.0, 0.25
KNOWN = 8  # platforms that a process keeps, by themselves and in one sea
PLANAR = np.array([0, 2, 4])


class LeftOut(NamedTuple):
    """What the kept shapes lack of the legs' tops' displacement, all directions of one top after another (nt,) [m].

    For loads f and amplitudes p, K⁻¹(f - Mφp̈) less the part of it in the shapes: the static answer to what they do not
    balance.
    """

    waves: np.ndarray  # (2 np, nt) to the wave inertia load, see Support.waves
    drag: np.ndarray  # (nd ns, nt) to unit drag at the stations
    inertia: np.ndarray  # (nm, nt) to unit p̈, with its sign changed
    tops: np.ndarray  # (nt,) degrees of freedom


@dataclass(frozen=True, eq=False, kw_only=True)
class Support:
    """Arrays of a platform in seas that are alike; nm modes, nc carrier coordinates, ns drag stations."""

    dry_omega: np.ndarray  # natural frequencies without added mass, of all modes or a large frame's lowest [rad/s]
    omega: np.ndarray  # (nm,) of the basis, with added mass [rad/s]
    dry_share: np.ndarray  # (nm,) of their mass that is not added mass
    damping: np.ndarray  # (nm,) ratios; 0 until they are known: see damped
    shapes: np.ndarray  # (6n, nm)
    carrier: np.ndarray  # (nc, nm)
    typical: WaveField  # waves of such seas
    places: np.ndarray  # (np, 3) where the water moves in its own way
    waves: np.ndarray  # (2 np, nm) modal load for unit du/dt there, first along the heading, then upward
    station_shape: np.ndarray  # (ns, nd, nm)
    flow: Callable[[WaveField], np.ndarray]  # rows (ns, nd, n) of the normal particle velocity there
    drag: np.ndarray  # (ns,) ½ρ C_D D w below still water [kg/m]
    drag_length: float  # the most of a member's length that a station stands for [m],
    drag_share: float  # and of what of the member is wet
    stream: np.ndarray  # (nd, ns) velocity of the current there, normal to the member [m/s]
    stretched: Stretched | None  # where waves load them up to their surface
    applied: np.ndarray  # (na, nm) modal load of unit forces along the axes of each load history
    thrust: np.ndarray  # (3, nm) force on the ground along x, y, z for unit -q̈ [kg^½]
    unswung: float  # of all that these move, what they set swinging of modes that are not kept
    legs: Legs | None
    within: tuple[float, float, float]  # what its worst elements leave out, [-], over ω² [s²], [-]: see _within
    nodes: tuple[str, ...]  # nn of the frame whose accelerations are asked for
    node_shapes: np.ndarray  # (nm, nn, 3) their displacement
    judged: np.ndarray  # (nm, k, 3) displacement of nodes by which a run is judged where no legs are said
    static_tops: np.ndarray  # (nl, 3) displacement of the legs' tops by weight, buoyancy and constant loads [m]
    forces: Forces | None  # None where neither legs nor outputs ask for any
    left_out: LeftOut
    buckling_factor: float  # weight and constant loads times this buckle the frame


def dynamic_model(platform: Platform, sea: Water) -> tuple[FrameModel, np.ndarray, float]:
    """Frame (softened by gravity if the platform asks for it), its static displacement, and the buckling factor."""
    return in_water.dynamic_model(platform.frame, sea.density, sea.gravity, softened=platform.geometric_stiffness)


@lru_cache(maxsize=KNOWN)
def _dry_frequencies(model: FrameModel) -> np.ndarray:
    return natural.frequencies(model.K, model.M, model.free)


def reduce_platform(
    platform: Platform,
    field: WaveField,
    sea: Water,
    hinge_nodes: tuple[str, ...],
    *,
    planar: bool,
    modes: int | Literal["all"],
    stations: int,
    outputs: tuple[str, ...] = (),
    damping: StructuralDamping | None = None,
) -> Support:
    """Reduce a platform for seas like one; tasks in any of those share what comes of it.

    hinge_nodes: names of nodes in the order of the floats; modes: lowest ones kept, or "all"; stations: Gauss points
    of the drag on each wetted element; outputs: what is asked for besides the legs; damping: of modes that load
    histories may set swinging, to be known where there are some. InputError for a planar scene on a frame that is not
    symmetric, or one too large for all its modes.
    """
    if modes == "all" and (count := platform.frame.freedoms) > natural.MOST:
        limit = f"needs a frame of at most {natural.MOST} degrees of freedom: this one has {count}"
        raise InputError("settings.modes", modes, f"{limit}, by the elements of its members")
    model = dynamic_model(platform, sea)[0]
    splash = water.DRY if platform.wave_stretching == "none" else stretching.splash(field)
    at = water.stations(model, water.EXACT, INERTIA / field.k.max())
    if field.current is not None:
        splash, stations = splash._replace(bends=field.current.bends), max(stations, field.current.points)
    drags = water.stations(model, stations, DRAG * field.mean_length, splash, BENT)
    return _reduced(
        platform,
        sea,
        hinge_nodes,
        at,
        drags,
        typical_waves(field, at, model.size),
        planar=planar,
        modes=modes,
        outputs=outputs,
        reach=splash.reach,
        damping=damping if platform.load_histories else None,  # or platforms that differ in it alone would not share
        strained=damping is not None and damping.beta > 0,
    )


@lru_cache(maxsize=KNOWN)
def _reduced(
    platform: Platform,
    sea: Water,
    hinge_nodes: tuple[str, ...],
    at: water.Stations,
    drags: water.Stations,
    field: WaveField,
    *,
    planar: bool,
    modes: int | Literal["all"],
    outputs: tuple[str, ...],
    reach: float,
    damping: StructuralDamping | None,
    strained: bool,
) -> Support:
    """By stations of inertia and of drag, in typical waves; reach: of crests that wet those above still water [m];
    strained: whether damping goes by the stiffness, too."""
    model, at_rest, factor = dynamic_model(platform, sea)
    dof = np.array([6 * model.node_index[n] for n in hinge_nodes], int)[:, None] + (PLANAR if planar else np.arange(6))
    loaded = loaded_by(model, platform.load_histories)
    M, kept, symmetric = kept_modes(model, sea.density, planar, None if modes == "all" else modes)
    around = surroundings(at, field.sea.heading)
    inertial = around.by_swing(inertia_size(platform, at, sea))
    unswung = 0.0
    if modes != "all":
        if damping is not None:
            large = platform.frame.freedoms > natural.LARGE
            every = kept_modes(model, sea.density, planar, natural.MANY if large else None)[1]
            kept, unswung = with_swung(every, modes, platform, every.shapes[loaded], model, M, damping)
        unit = unit_loads(len(kept.shapes), np.concatenate([dof.ravel(), loaded]))
        if field.current is not None:
            unit = np.concatenate([unit, load_of_stream(model, field, drags, sea)], axis=1)
        driven = _patterns(model, at, around, inertial, field, sea)
        kept = natural.Modes(*ritz_basis(model, M, kept, symmetric, unit, driven))
    omega, shapes = kept
    tops = tops_of(model, platform.legs)
    rest = rest_of(model, tops, symmetric, omega, shapes)
    both = np.concatenate([shapes, rest], axis=1)
    nodal = (onto_nodes(model, at) @ inertial).T
    water_drag = station_drag(field, drags, platform, sea, both, omega.size, planar=planar, reach=reach)
    station_shape, station_rest = np.split(water_drag.shape, [omega.size], axis=2)
    asked = _places(platform, sea, tuple(sorted(outputs)))
    borne = None
    if not asked.wanted.empty:
        of_points = asked.influence.of_points(at)
        inertia = asked.influence.of_inertia(M, sea.density, shapes)
        elastic = np.arange(len(asked.influence.element)) < asked.wanted.end.size  # the ground bears damping, too
        more = {}
        if strained:
            more["straining"] = asked.influence.of_straining(asked.wanted, omega, shapes, inertia) * elastic
        borne = forces.reduced(
            asked,
            _forces_at_rest(platform, sea, asked),
            waves=inertial.T @ of_points.reshape(inertial.shape[0], of_points.shape[2]),
            inertia=inertia,
            damping=2 * omega[:, None] * inertia * elastic,
            **more,
            carried=asked.influence.nodal[dof.ravel()],
            drag=water_drag.borne(asked),
            applied=asked.influence.nodal[loaded],
        )
    accelerated = [
        name for name in platform.frame.nodes if "accelerations" in outputs and name not in model.frame.clamped
    ]
    numbers = [model.node_index[name] for name in accelerated]
    free = [] if platform.legs else [model.node_index[n] for n in platform.frame.nodes if n not in model.frame.clamped]
    moved = shapes.reshape(-1, 6, omega.size)[:, :3]
    along = water.of_members(model, drags.element, drags.weight)
    return Support(
        dry_omega=_dry_frequencies(model),
        omega=omega,
        dry_share=np.einsum("ij,ij->j", shapes, model.M @ shapes),
        damping=np.zeros(omega.size),
        shapes=shapes,
        carrier=shapes[dof.ravel()],
        typical=field,
        places=around.places,
        waves=nodal @ shapes,
        station_shape=station_shape,
        flow=water_drag.flow,
        drag=water_drag.size,
        drag_length=float(drags.weight[drags.drag > 0].max(initial=0.0)),
        drag_share=float((drags.weight / along)[drags.drag > 0].max(initial=0.0)),
        stream=water_drag.stream,
        stretched=water_drag.stretched,
        applied=shapes[loaded],
        thrust=thrust(M, shapes),
        unswung=unswung,
        left_out=LeftOut(
            waves=nodal @ rest,
            drag=station_rest.transpose(1, 0, 2).reshape(station_rest.shape[0] * station_rest.shape[1], tops.size),
            inertia=shapes.T @ (M @ rest),
            tops=tops,
        ),
        legs=legs.outputs(platform.legs, model, sea.density, sea.gravity, at_rest, shapes) if platform.legs else None,
        within=_within(model, sea.density),
        nodes=tuple(accelerated),
        node_shapes=moved[numbers].transpose(2, 0, 1),
        judged=moved[free].transpose(2, 0, 1),
        static_tops=_static_tops(platform, sea),
        forces=borne,
        buckling_factor=factor,
    )


def _patterns(
    model: FrameModel,
    at: water.Stations,
    around: Surroundings,
    inertial: sparse.csr_array,
    field: WaveField,
    sea: Water,
) -> np.ndarray:
    """Nodal loads (6n, m) of waves: their inertia's, and their drag's by what else moves the water, waves or current.

    Each kind as large as the others, moments over the frame's size.
    """
    swing, drag = np.concatenate(field.swing(around.places)), drag_size(at, sea)
    sizes = [drag * around.std(swing), drag * np.linalg.norm(normal_stream(at, field), axis=1)]
    kinds = [inertial, *map(around.by_swing, sizes)]
    loads = [real_parts(nodal_loads(model, at, kind, swing)) / model.arms[:, None] for kind in kinds]
    return np.concatenate([load / np.linalg.norm(load) for load in loads if load.any()] or loads, axis=1)


@lru_cache(maxsize=KNOWN)
def _within(model: FrameModel, density: float) -> tuple[float, float, float]:
    """What the worst elements leave out by soil [-], inertia [s²] and taper [-], see `structure.fineness`."""
    soil, by_inertia, by_soil = model.frame.soil, 0.0, 0.0
    for e, (section, L) in enumerate(zip(model.sections, model.length, strict=True)):
        member, growth = model.member_of(e), fineness.thickest(model.frame, model.ends[e])
        by_inertia = max(by_inertia, fineness.by_inertia(member, section, L, density, growth))
        if soil is not None:
            for _, _, stiffness in soil.points(model.ends[e]):
                by_soil = max(by_soil, fineness.by_soil(member, section, L, stiffness))
    return by_soil, by_inertia, max(map(fineness.by_taper, model.frame.members), default=0.0)


@lru_cache(maxsize=KNOWN)
def damped(support: Support, damping: StructuralDamping) -> Support:
    """With the modes' damping."""
    ratio = damping.of(support.omega, support.dry_share)
    return replace(support, damping=ratio, forces=support.forces and support.forces.damped(ratio, damping.beta))


@lru_cache(maxsize=KNOWN)
def _places(platform: Platform, sea: Water, outputs: tuple[str, ...]) -> Places:
    return places_of(dynamic_model(platform, sea)[0], platform.legs, outputs)


@lru_cache(maxsize=KNOWN)
def _static_tops(platform: Platform, sea: Water) -> np.ndarray:
    """(nl, 3) [m], of the softened frame where gravity softens it."""
    model, bent, _ = dynamic_model(platform, sea)
    return bent[tops_of(model, platform.legs)].reshape(-1, 3)


@lru_cache(maxsize=KNOWN)
def _forces_at_rest(platform: Platform, sea: Water, asked: Places) -> np.ndarray:
    """(ny,) under weight, constant loads and buoyancy."""
    model, at_rest, _ = dynamic_model(platform, sea)
    load, spread = (of(model, sea.density, sea.gravity) for of in (water.static_load, water.spread_load))
    return shared(asked.influence.at_rest(asked.wanted, at_rest, load, spread))
