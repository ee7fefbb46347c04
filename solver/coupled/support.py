"""An elastic platform as the march sees it: few Ritz modes (eq. 17), drag stations, wave-load rows (eq. 16).

The basis is the lowest modes, and those that load histories set swinging, plus the static shapes of what loads the
frame (unit loads at the hinge nodes, the principal shapes of the wave load), made orthogonal again by Rayleigh-Ritz.
The static shapes carry what the left-out modes would have added quasi-statically. The mass
includes the added mass of the wetted members, because that is the mass that moves.
"""

from collections.abc import Callable, Iterable
from dataclasses import dataclass, replace
from functools import lru_cache, partial
from typing import Literal, NamedTuple

import numpy as np
from scipy import linalg, sparse

from solver.coupled import forces, stretching
from solver.coupled.forces import Forces, Places
from solver.coupled.stretching import Stretched
from solver.coupled.typical import typical_waves
from solver.errors import InputError
from solver.keys import shared
from solver.scene import Platform, StructuralDamping, Water
from solver.sea.field import WaveField
from solver.structure import fineness, in_water, legs, statics, water
from solver.structure import modes as natural
from solver.structure.frame_model import FrameModel, sparse_sum
from solver.structure.legs import Legs
from solver.structure.load_history import LoadHistory
from solver.structure.ringing import lines, sizes

SWUNG = 3e-3  # of all that load histories move: modes that they set swinging by more are kept
FAR_LESS = 0.1  # of the leg's top that moves most: what moves by less is not judged
PATTERN = 1e-3  # principal wave-load shapes smaller than this share of the largest are left out
# Pieces of an element in which loads are integrated: of 1/k of the shortest wave for inertia, whose EXACT points are
# then right to 2e-5 of it, and of the mean wave for drag; for shapes that bend along a member, of what of it is wet.
INERTIA, DRAG, BENT = 4.0, 1.0, 0.25
SAME = 1e-6  # distance to the plane y = 0 that counts as none [m]
KNOWN = 8  # platforms that a process keeps, by themselves and in one sea
PLANAR = np.array([0, 2, 4])
EVERY = slice(None)


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

    dry_omega: np.ndarray  # natural frequencies without added mass, all modes [rad/s]
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
    unswung: float  # of all that these move, what they set swinging of modes that are not kept
    legs: Legs | None
    within: tuple[float, float]  # what its worst elements leave out, [-] and over ω² [s²]: see _within
    nodes: tuple[str, ...]  # nn of the frame whose accelerations are asked for
    node_shapes: np.ndarray  # (nm, nn, 3) their displacement
    judged: np.ndarray  # (nm, k, 3) displacement of nodes by which a run is judged where no legs are said
    static_tops: np.ndarray  # (nl, 3) displacement of the legs' tops by weight, buoyancy and constant loads [m]
    forces: Forces | None  # None where neither legs nor outputs ask for any
    left_out: LeftOut
    buckling_factor: float  # gravity times this buckles the frame


def dynamic_model(platform: Platform, sea: Water) -> tuple[FrameModel, np.ndarray, float]:
    """Frame (softened by gravity if the platform asks for it), its static displacement, and the buckling factor."""
    return in_water.dynamic_model(platform.frame, sea.density, sea.gravity, softened=platform.geometric_stiffness)


@lru_cache(maxsize=KNOWN)
def _dry_frequencies(model: FrameModel) -> np.ndarray:
    return natural.frequencies(model.K, model.M, model.free)


@lru_cache(maxsize=KNOWN)
def _kept_modes(
    model: FrameModel, density: float, planar: bool, count: int | None
) -> tuple[sparse.csr_array, natural.Modes, sparse.csr_array | None]:
    """Mass with the water's, and the lowest modes; in a planar scene the symmetric ones and the basis of all
    symmetric displacements, else None."""
    added = water.added_mass(model, density)
    M = model.M + added
    if not planar:
        return M, natural.modes(model.K, M, model.free, count), None
    symmetric = natural.symmetric_basis(model, added, water.drag_matrix(model))
    if symmetric is None:
        limit = "a planar scene needs a symmetric frame, its coefficients of drag and inertia included"
        raise InputError("platform.frame", "not symmetric in y = 0", limit)
    return M, natural.modes_in(symmetric, model.K, M, count), symmetric


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
    symmetric.
    """
    model = dynamic_model(platform, sea)[0]
    splash = water.DRY if platform.wave_stretching == "none" else stretching.splash(field)
    at = water.stations(model, water.EXACT, INERTIA / field.k.max())
    drags = water.stations(model, stations, DRAG * field.mean_length, splash, BENT)
    return _reduced(
        platform,
        sea,
        hinge_nodes,
        at,
        drags,
        typical_waves(field, at),
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
    loaded = _loaded(model, platform.load_histories)
    M, kept, symmetric = _kept_modes(model, sea.density, planar, None if modes == "all" else modes)
    around = _surroundings(at, field.sea.heading)
    inertial = around.by_swing(_inertia_size(platform, at, sea))
    unswung = 0.0
    if modes != "all":
        if damping is not None:
            every = _kept_modes(model, sea.density, planar, None)[1]
            kept, unswung = _with_swung(every, modes, platform, every.shapes[loaded], model, damping)
        unit = _unit_loads(len(kept.shapes), np.concatenate([dof.ravel(), loaded]))
        if field.current is not None:
            unit = np.concatenate([unit, _stream_load(model, field, drags, sea)], axis=1)
        driven = _patterns(model, at, around, inertial, field, sea)
        kept = natural.Modes(*_basis(model, M, kept, symmetric, unit, driven))
    omega, shapes = kept
    tops = _tops(model, platform.legs)
    rest = _rest(model, tops, symmetric, omega, shapes)
    both = np.concatenate([shapes, rest], axis=1)
    nodal = (_onto_nodes(model, at) @ inertial).T
    water_drag = _drag(field, drags, platform, sea, both, omega.size, planar=planar, reach=reach)
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


def _with_swung(
    every: natural.Modes,
    lowest: int,
    platform: Platform,
    applied: np.ndarray,
    model: FrameModel,
    damping: StructuralDamping,
) -> tuple[natural.Modes, float]:
    """The lowest modes and those that the loads set swinging, of a frame by itself; and `unswung`.

    applied (na, nm): modal load of unit forces.
    """
    omega, shapes = every
    ratio = damping.of(omega, np.einsum("ij,ij->j", shapes, model.M @ shapes))
    end = min(history.time[-1] for history in platform.load_histories)
    told = sizes(lines(platform.load_histories, end), omega, ratio, applied)
    of_tops = np.abs(shapes[_tops(model, platform.legs)]) / omega
    share = np.concatenate([np.ones((1, omega.size)), of_tops])  # of strain energy, and of the legs' tops
    whole = np.linalg.norm(share * np.hypot(told.swings, told.pushed), axis=1)
    least = np.zeros(whole.size)
    least[1:] = FAR_LESS * whole[1:].max(initial=0.0)
    judged = whole > least
    swings = share[judged] * told.swings / whole[judged, None]
    kept = (np.arange(omega.size) < lowest) | (swings.max(axis=0, initial=0.0) > SWUNG)
    left = np.linalg.norm(swings[:, ~kept], axis=1).max(initial=0.0)
    return natural.Modes(omega[kept], shapes[:, kept]), float(left)


def _patterns(
    model: FrameModel,
    at: water.Stations,
    around: "_Surroundings",
    inertial: sparse.csr_array,
    field: WaveField,
    sea: Water,
) -> np.ndarray:
    """Nodal loads (6n, m) of waves: their inertia's, and their drag's by what else moves the water, waves or current.

    Each kind as large as the others.
    """
    swing, drag = np.concatenate(field.swing(around.places)), _drag_size(at, sea)
    sizes = [drag * around.std(swing), drag * np.linalg.norm(_stream(at, field), axis=1)]
    kinds = [inertial, *map(around.by_swing, sizes)]
    loads = [_nodal_load(model, at, kind, swing).view(float) for kind in kinds]
    return np.concatenate([load / np.linalg.norm(load) for load in loads if load.any()] or loads, axis=1)


@lru_cache(maxsize=KNOWN)
def _within(model: FrameModel, density: float) -> tuple[float, float]:
    """What the worst elements leave out by soil [-] and by inertia [s²], see `structure.fineness`."""
    soil, by_inertia, by_soil = model.frame.soil, 0.0, 0.0
    for e, (section, L) in enumerate(zip(model.sections, model.length, strict=True)):
        member = model.member_of(e)
        by_inertia = max(by_inertia, fineness.by_inertia(member, section, L, density))
        if soil is not None:
            for _, _, stiffness in soil.points(model.ends[e]):
                by_soil = max(by_soil, fineness.by_soil(member, section, L, stiffness))
    return by_soil, by_inertia


@lru_cache(maxsize=KNOWN)
def damped(support: Support, damping: StructuralDamping) -> Support:
    """With the modes' damping."""
    ratio = damping.of(support.omega, support.dry_share)
    return replace(support, damping=ratio, forces=support.forces and support.forces.damped(ratio, damping.beta))


@lru_cache(maxsize=KNOWN)
def _places(platform: Platform, sea: Water, outputs: tuple[str, ...]) -> Places:
    return forces.places(dynamic_model(platform, sea)[0], platform.legs, outputs)


@lru_cache(maxsize=KNOWN)
def _static_tops(platform: Platform, sea: Water) -> np.ndarray:
    """(nl, 3) [m], of the softened frame where gravity softens it."""
    model, bent, _ = dynamic_model(platform, sea)
    return bent[_tops(model, platform.legs)].reshape(-1, 3)


@lru_cache(maxsize=KNOWN)
def _forces_at_rest(platform: Platform, sea: Water, asked: Places) -> np.ndarray:
    """(ny,) under weight, constant loads and buoyancy."""
    model, at_rest, _ = dynamic_model(platform, sea)
    load, spread = (of(model, sea.density, sea.gravity) for of in (water.static_load, water.spread_load))
    return shared(asked.influence.at_rest(asked.wanted, at_rest, load, spread))


def _normal(at: water.Stations) -> np.ndarray:
    """Projection on the plane normal to the member at each station (ns, 3, 3)."""
    return np.eye(3) - at.tangent[:, :, None] * at.tangent[:, None, :]


def _flow(
    at: water.Stations, field: WaveField, kept: np.ndarray | slice = EVERY, directions: np.ndarray | slice = EVERY
) -> np.ndarray:
    """Particle velocity normal to the member at each station (ns, 3, n), or at some along some axes."""
    around = _surroundings(at, field.sea.heading)
    swing = [lines[around.place[kept], None] for lines in field.swing(around.places)]
    along, up = (part[kept][:, directions, None] for part in (around.along, around.up))
    velocity: np.ndarray = along * swing[0] + up * swing[1]
    return velocity


class _Surroundings(NamedTuple):
    """Where the water moves in its own way about ns stations: velocity normal to the members by that of np places."""

    places: np.ndarray  # (np, 3)
    place: np.ndarray  # (ns,) which of them is each station's
    along: np.ndarray  # (ns, 3) normal velocity for unit velocity along the waves' heading
    up: np.ndarray  # (ns, 3) and for unit velocity upward
    normal: sparse.csr_array  # (3 ns, 2 np) of all of them, by those along the heading and upward at all places

    def by_swing(self, size: np.ndarray) -> sparse.csr_array:
        """`size` (ns,) times the normal velocity, (3 ns, 2 np)."""
        scaled = self.normal.copy()
        scaled.data *= np.repeat(np.repeat(size, 3), np.diff(scaled.indptr))
        return scaled

    def std(self, swing: np.ndarray) -> np.ndarray:
        """Of the normal velocity (ns,), of lines (2 np, n) of that along the heading and upward, in quadrature."""
        along, up = np.split(np.sum(swing.real**2 + swing.imag**2, axis=1), 2)
        parts = np.sum(self.along**2, axis=1) * along[self.place], np.sum(self.up**2, axis=1) * up[self.place]
        return np.sqrt(0.5 * sum(parts))


@lru_cache(maxsize=KNOWN)
def _surroundings(at: water.Stations, heading: float) -> _Surroundings:
    """Legs side by side, and stations above each other in the same wave, share places; none is above still water."""
    direction, normal = np.array([np.cos(heading), np.sin(heading), 0.0]), _normal(at)
    seen = np.stack([at.position @ direction, np.minimum(at.position[:, 2], 0.0)], axis=1)
    _, first, place = np.unique(seen, axis=0, return_index=True, return_inverse=True)
    along, up, place = normal @ direction, normal[:, :, 2], place.ravel()
    columns = place[:, None, None] + np.array([[0], [len(first)]])
    rows, columns = np.broadcast_arrays(np.arange(along.size).reshape(-1, 1, 3), columns)
    parts = np.stack([along, up], axis=1)
    spread = sparse.csr_array((parts.ravel(), (rows.ravel(), columns.ravel())), (along.size, 2 * len(first)))
    spread.eliminate_zeros()
    return _Surroundings(np.minimum(at.position[first], [np.inf, np.inf, 0.0]), place, along, up, spread)


def _inertia_size(platform: Platform, at: water.Stations, sea: Water) -> np.ndarray:
    """Wave inertia load on each station over du/dt normal to it [kg]: C_M ρ πD²/4 w, (ns,)."""
    coefficient = at.inertia - (1 if platform.wave_inertia == "relative" else 0)
    return coefficient * sea.density * np.pi / 4 * at.diameter**2 * at.weight


def _drag_size(at: water.Stations, sea: Water) -> np.ndarray:
    """½ρ C_D D w of each station [kg/m]."""
    return 0.5 * sea.density * at.drag * at.diameter * at.weight


def _stream(at: water.Stations, field: WaveField) -> np.ndarray:
    """Velocity of the current normal to the member at each station (ns, 3)."""
    return (_normal(at) @ field.stream(at.position)[..., None])[..., 0]


def _stream_load(model: FrameModel, field: WaveField, at: water.Stations, sea: Water) -> np.ndarray:
    """Nodal loads (6n, 1) of the current's drag on the frame at rest, by stations of the drag."""
    flow = _stream(at, field)
    load = _drag_size(at, sea) * np.linalg.norm(flow, axis=1)
    return _onto_nodes(model, at) @ (load[:, None] * flow).reshape(-1, 1)


def _loaded(model: FrameModel, histories: Iterable[LoadHistory]) -> np.ndarray:
    """Degrees of freedom (na,) that load histories act on, one after another."""
    return np.concatenate([np.zeros(0, int), *(model.translations(h.node)[h.axes] for h in histories)])


def _unit_loads(size: int, dof: np.ndarray) -> np.ndarray:
    """One on each of some degrees of freedom (size, nd)."""
    unit = np.zeros((size, dof.size))
    unit[dof, np.arange(dof.size)] = 1.0
    return unit


def _nodal_load(model: FrameModel, at: water.Stations, by_swing: sparse.csr_array, swing: np.ndarray) -> np.ndarray:
    """Nodal loads (6n, n) of point loads at the stations, which are by_swing (3 ns, m) of lines swing (m, n)."""
    return real_by_complex(_onto_nodes(model, at) @ by_swing, swing)


def real_by_complex(real: np.ndarray | sparse.csr_array, lines: np.ndarray) -> np.ndarray:
    """Their product, in half the time of complex by complex."""
    product: np.ndarray = real @ np.ascontiguousarray(lines).view(float)
    return product.view(complex)


@lru_cache(maxsize=KNOWN)
def _onto_nodes(model: FrameModel, at: water.Stations) -> sparse.csr_array:
    """Nodal loads of unit point loads at the stations, sparse (6n, 3 ns)."""
    columns = np.arange(3 * len(at.dofs)).reshape(-1, 3)
    spread = sparse_sum(at.shape.transpose(0, 2, 1), at.dofs, columns, (6 * len(model.xyz), columns.size))
    spread.eliminate_zeros()
    return spread


def _basis(
    model: FrameModel,
    M: sparse.csr_array,
    kept: natural.Modes,
    symmetric: sparse.csr_array | None,
    steady: np.ndarray,
    patterns: np.ndarray,
) -> tuple[np.ndarray, np.ndarray]:
    """Ritz frequencies and shapes (6n, nm), mass-normalised with M.

    Static shapes of each of the loads `steady` (6n, ns), and the principal ones of the waves', `patterns` (6n, n).
    """
    if symmetric is None:
        principal = _principal(patterns)
    else:  # in half the rows, and those of the clamped nodes, whose loads move nothing but count in what is principal
        clamped = np.setdiff1d(np.arange(len(patterns)), model.free)
        few = _principal(np.concatenate([symmetric.T @ patterns, patterns[clamped]]))
        principal = symmetric @ few[: symmetric.shape[1]]
    load = np.concatenate([steady, principal], axis=1)
    # Only what the kept modes lack: without this the large common part would hide the rest.
    whole = statics.static(model, load)
    rest = natural.static_remainder(kept, load, whole)
    if symmetric is not None:
        rest = symmetric @ (symmetric.T @ rest)  # rounding of the difference is not, and legs would differ by it
    size = np.sqrt(np.einsum("ij,ij->j", rest, M @ rest))
    new = size > 1e-9 * np.sqrt(np.einsum("ij,ij->j", whole, M @ whole))
    rest = rest[:, new] / size[new]
    value, vector = linalg.eigh(rest.T @ (M @ rest))
    used = value > 1e-10
    basis = np.concatenate([kept.shapes, rest @ (vector[:, used] / np.sqrt(value[used]))], axis=1)
    omega, mix = natural.lowest(basis.T @ (model.K @ basis), basis.T @ (M @ basis))
    return omega, basis @ mix


def _principal(patterns: np.ndarray) -> np.ndarray:
    """Orthonormal shapes (6n, r) of loads (6n, m), without what is less than PATTERN of the largest.

    By the smaller Gram matrix, whose rounding is far below PATTERN²; most rows are of dry nodes or have no load.
    """
    loaded = patterns.any(axis=1)
    rows = patterns[loaded]
    few = len(rows) < rows.shape[1]
    squares, vectors = linalg.eigh(rows @ rows.T if few else rows.T @ rows)
    large = squares > PATTERN**2 * squares.max(initial=0.0)
    principal = np.zeros((len(patterns), np.sum(large)))
    principal[loaded] = vectors[:, large] if few else rows @ (vectors[:, large] / np.sqrt(squares[large]))
    return principal


def _tops(model: FrameModel, names: Iterable[str]) -> np.ndarray:
    """Degrees of freedom (nt,): x, y and z of each leg's upper end."""
    ends = [model.member_nodes[name][[0, -1]] for name in names]
    nodes = np.array([pair[np.argmax(model.xyz[pair, 2])] for pair in ends], int)
    return (6 * nodes[:, None] + np.arange(3)).ravel()


def _rest(
    model: FrameModel, tops: np.ndarray, symmetric: sparse.csr_array | None, omega: np.ndarray, shapes: np.ndarray
) -> np.ndarray:
    """(6n, nt): displacement of some degrees of freedom (nt,) for unit loads, less that in the shapes, φ φᵀ/ω²."""
    unit = _unit_loads(len(shapes), tops)
    if symmetric is not None:
        unit = symmetric @ (symmetric.T @ unit)
    return statics.static(model, unit) - shapes @ (shapes[tops] / omega**2).T


class _Drag(NamedTuple):
    """Of the ns stations that count: normal shapes, velocities, coefficients."""

    shape: np.ndarray  # (ns, nd, nm)
    flow: Callable[[WaveField], np.ndarray]  # rows (ns, nd, n)
    size: np.ndarray  # (ns,) ½ρ C_D D w below still water [kg/m]
    stream: np.ndarray  # (nd, ns) of the current
    stretched: Stretched | None  # where waves load them up to their surface
    borne: Callable[[Places], np.ndarray]  # what their drag does to forces asked for


def _drag(
    field: WaveField,
    at: water.Stations,
    platform: Platform,
    sea: Water,
    shapes: np.ndarray,
    modes: int,
    *,
    planar: bool,
    reach: float,
) -> _Drag:
    """Of the stations of the drag; the first `modes` of the shapes move; waves reach so high if they reach above z = 0.

    In a planar scene a station and its mirror image in y = 0 are loaded alike: one counts twice.
    """
    normal = _normal(at)
    shape = normal @ at.project(shapes)
    drag, inertia = _drag_size(at, sea), _inertia_size(platform, at, sea) * (reach > 0)
    y, under = at.position[:, 1], at.position[:, 2] < 0
    if planar:
        drag, inertia = (size * np.where(np.abs(y) < SAME, 1.0, 2.0) for size in (drag, inertia))
    wet = ((drag > 0) | (inertia > 0)) & ((y > -SAME) | (not planar))
    size = np.abs(shape[..., :modes]).max(axis=(0, 2), initial=0)
    moving = size > 1e-9 * size.max()
    borne = partial(forces.of_drag, at=at, kept=wet, directions=moving, planar=planar)
    stream = np.ascontiguousarray(_stream(at, field)[wet][:, moving].T)
    flow = partial(_flow, at, kept=wet, directions=moving)
    stretched = None
    if reach > 0:
        direction = field.direction
        place, of_place = np.unique(at.position[wet] @ direction, return_inverse=True)
        stretched = Stretched(
            place=place,
            of_place=of_place,
            height=at.position[wet, 2],
            bounds=stretching.wet_bounds(at)[wet],
            along=np.ascontiguousarray((normal @ direction)[wet][:, moving]),
            up=np.ascontiguousarray(normal[wet][:, moving, 2]),
            drag=drag[wet],
            inertia=inertia[wet],
            stream=stream,
            reach=reach,
            extrapolated=platform.wave_stretching == "extrapolated",
        )
    return _Drag(shape[wet][:, moving], flow, (drag * under)[wet], stream, stretched, borne)
