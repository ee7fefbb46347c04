"""A scene as a system: its arrays, coefficients that are its own, and the memory that it needs."""

from collections.abc import Iterator
from dataclasses import replace
from functools import lru_cache

import numpy as np

from solver import limits, motions
from solver.coupled import assembly, sliding
from solver.coupled import support as supports
from solver.coupled.moving import along_waves
from solver.coupled.sliding import Places
from solver.coupled.support import Support
from solver.coupled.system import FELT, KNOWN, System
from solver.errors import InputError, SimulationFailed
from solver.hydrodynamics.bem.coefficients import DOFS, Hydrodynamics
from solver.hydrodynamics.bem.mean_hull import motion_lengths
from solver.hydrodynamics.hull.mesh import Hull
from solver.hydrodynamics.radiation import fitting
from solver.hydrodynamics.radiation.memory import RadiationMemory
from solver.keys import Bits, shared
from solver.multibody.bodies import Bodies
from solver.scene import Float, Platform, Scene, Settings, Water
from solver.sea.current import Current
from solver.sea.field import WaveField, wave_field
from solver.sea.realization import CALM

SAME = 1e-6  # of what a hull displaces
SWING = 0.8  # by which a float is reckoned to turn to either side of its rest [rad]


def prepare(scene: Scene, hydrodynamics: Hydrodynamics | None, fit: RadiationMemory | None = None) -> System:
    """The scene as arrays, with another radiation memory if given; InputError for coefficients of another scene."""
    settings, water = scene.settings, scene.water
    dt = scene.usual_step if settings.time_step is None else settings.time_step
    waves = wave_field(scene.sea, water.depth, water.gravity, scene.current)
    near, reach, terms = around(scene, waves)
    if hydrodynamics is not None and scene.floats:
        _check_same(scene, hydrodynamics, near != waves)
    support = None
    if scene.platform is not None:
        platform = scene.platform.undamped()
        if settings.method == "frequency" and platform.wave_stretching != "none":  # which is of second order
            platform = replace(platform, wave_stretching="none")
        reduced = supports.reduce_platform(
            platform,
            waves,
            water,
            tuple(scene.platform.hinge_nodes[f.name] for f in scene.floats),
            planar=scene.planar,
            modes=settings.modes,
            stations=settings.stations_per_element,
            outputs=settings.outputs,
            damping=scene.platform.damping,
        )
        support = supports.damped(reduced, scene.platform.damping)
    if fit is None and scene.floats and settings.radiation and settings.method == "time":
        hulls, ways = tuple(f.hull for f in scene.floats), motions.of_scene(scene)
        fit = remembered(hydrodynamics, hulls, settings.memory_tolerance or fitting.USUAL, ways)
    na = len(scene.floats) * len(hydrodynamics.dofs) if hydrodynamics else 0
    added_mass = np.zeros((na, na))
    if hydrodynamics is not None and settings.radiation:
        added_mass = fit.added_mass_inf if fit else hydrodynamics.added_mass_inf
    if near != waves:
        _require_hardly_felt(scene, hydrodynamics, waves, near, reach)
    felt = near if any(scene.nonlinear) else None
    still = scene.water, scene.current, scene.sea.heading, scene.floats, scene.platform, scene.settings

    def about(rest: limits.Rest) -> tuple[System, Places]:
        rows, layout, places = assembly.wave_rows(scene, waves, near, support, hydrodynamics, terms, reach, rest)
        system = System(
            scene=scene,
            bodies=_bodies(*still, felt, support, hydrodynamics, Bits(added_mass), terms, places, rest),
            support=support,
            structure=assembly.structure(support),
            fit=fit,
            memory=assembly.memory(fit, dt, na),
            rows=rows.copy() if any(places.terms) else rows,
            layout=layout,
            waves=waves,
            near=near,
            dt=dt,
        )
        return system, places

    system, places = about(given := limits.given(scene))
    if scene.sea.amplitude.any() and (rest := _rest(system, given)) != given:
        system, places = about(rest)
    body, layout = system.bodies, system.layout
    if any(places.terms):
        assert hydrodynamics is not None, "no wave loads follow a float without any"
        swing = along_waves(system, hydrodynamics)[list(places.leader), None]
        swing = sliding.rows(swing, waves.k, places)
        told = system.rows[layout.field][2 * body.first_term[-1] :]
        told.reshape(len(swing), -1, swing.shape[-1])[:, -1:] = swing
        shared(system.rows)
    return system


def around(scene: Scene, waves: WaveField) -> tuple[WaveField, float, tuple[int, ...]]:
    """The waves whose pressure is integrated where the floats are, how far from rest [m], and terms of each float's."""
    tolerance = scene.settings.field_tolerance
    if not any(scene.nonlinear):
        return waves, 0.0, assembly.terms_of(scene, waves, [0.0] * len(scene.floats))
    most = np.pi * waves.mean_length  # half a wave, unless the series ends before: what is pushed further ends its run
    pushed = np.array([min(most, far) for far in limits.pushed_along(scene, waves)])
    for share in (1.0, 0.5, 0.25, 0.0):
        reaches = _reaches(scene, 2 * scene.sea.parameters()["Hm0"] + share * pushed)
        reach = max(r for r, nonlinear in zip(reaches, scene.nonlinear, strict=True) if nonlinear)
        near = waves.near(reach, tolerance)
        if near == waves:
            break
    return near, reach, assembly.terms_of(scene, near, reaches)


def _rest(system: System, given: limits.Rest) -> limits.Rest:
    """What the waves' series are about; where floats are given if they rest nowhere, which is said elsewhere."""
    if not any(system.scene.nonlinear):
        return given
    try:
        return limits.rest(system.scene, system.joints_at_rest)
    except SimulationFailed:
        return given


@lru_cache(maxsize=KNOWN)
def _bodies(
    water: Water,
    current: Current | None,
    heading: float,
    floats: tuple[Float, ...],
    platform: Platform | None,
    settings: Settings,
    field: WaveField | None,
    support: Support | None,
    hydrodynamics: Hydrodynamics | None,
    added_mass: Bits[np.ndarray],
    terms: tuple[int, ...],
    places: Places,
    rest: limits.Rest,
) -> Bodies:
    """Scenes that differ in their seas alone share them, unless they are pushed where they are."""
    sea = replace(CALM, heading=heading) if field is None else field.sea
    scene = Scene(water=water, sea=sea, current=current, floats=floats, platform=platform, settings=settings)
    field = wave_field(sea, water.depth, water.gravity, current) if field is None else field
    return assembly.bodies(scene, field, support, hydrodynamics, added_mass.value, terms, places, rest)


def _require_hardly_felt(
    scene: Scene, h: Hydrodynamics | None, waves: WaveField, near: WaveField, reach: float
) -> None:
    """Refuse waves that no series around the floats carries, unless they push them little: see FELT."""
    felt = 1.0
    if h is not None:
        nb, lengths = len(scene.floats), motion_lengths(tuple(f.hull for f in scene.floats), h.dofs)
        short = waves.sea.omega[near.sea.amplitude != waves.sea.amplitude]
        pushed, most = (
            (np.abs(h.excitation(omega)) / lengths).reshape(omega.size, nb, -1).max(axis=(0, 2))
            for omega in (short, h.omega)
        )
        felt = float(np.max((pushed / most)[np.array(scene.nonlinear)]))
    if not felt <= FELT:
        said = f"too short for a series {reach:.3g} m around a float that feels them by {felt:.3g} of the largest wave"
        said += f" force per amplitude, > {FELT:g}"
        for key, value in _stretching(scene, waves.direction, reach):
            raise InputError(key, value, f"{waves.shortest} are {said}: bring it down, or end the band lower")
        raise InputError("sea", waves.shortest, f"{said}: end the band lower")


def _stretching(scene: Scene, heading: np.ndarray, reach: float) -> Iterator[tuple[str, object]]:
    """Keys of floats, and their values, of which more than half of a reach [m] comes; heading: of the waves (3,)."""
    for item, nonlinear, flat in zip(scene.floats, scene.nonlinear, motions.in_plane(scene), strict=True):
        start, rises = np.abs(item.per_axis("offset")), np.array([axis == "heave" for axis in item.motion])
        let_go = max(limits.ahead(item, heading) @ start, rises @ start) if item.motion else 0.0
        turned = 2 * np.sin(SWING / 2) * np.linalg.norm(limits.sight(flat) * item.arm) * item.turns.any()
        for key, far in (("offset", let_go), ("arm", turned)):
            if nonlinear and far > reach / 2:
                yield f"floats.{item.name}.{key}", getattr(item, key)


def _check_same(scene: Scene, h: Hydrodynamics, far: bool) -> None:
    """Refuse coefficients of other floats, other water or other waves than the scene's; far: whether they have pressure
    of waves that no series around the floats carries."""
    water, places = scene.water, np.array([f.centre for f in scene.floats])
    pairs = {
        "floats": (len(places), len(h.centres)),
        "water.depth": (water.depth, h.depth),
        "water.density": (water.density, h.density),
        "water.gravity": (water.gravity, h.gravity),
        "settings.gap_damping": (scene.settings.gap_damping, h.settings.get("gap_damping", 0.0)),
        "settings.gap_width": (scene.settings.gap_width, h.settings.get("gap_width", 0.0)),
    }
    for key, (value, limit) in pairs.items():
        if value != limit:
            raise InputError(key, value, f"must be {limit:g}, that of the coefficients")
    if not np.abs(places - h.centres).max(initial=0.0) <= 1e-6:
        raise InputError("floats", places.tolist(), f"must be where the coefficients' floats are, {h.centres.tolist()}")
    for item, known in zip(scene.floats, h.displaced_mass, strict=True):
        displaced = water.density * item.hull.volume
        if known and not abs(displaced - known) <= SAME * displaced:  # 0: of no buoyancy
            limit = f"must displace {known:.6g} kg, as of the coefficients"
            raise InputError(f"floats.{item.name}.hull", f"{displaced:.6g} kg displaced", limit)
    if len(places) > 1 and scene.settings.interaction != h.interacting:
        said = f"must be {str(h.interacting).lower()}, as of the coefficients"
        raise InputError("settings.interaction", scene.settings.interaction, said)
    linear = scene.settings.froude_krylov != "none" and not all(scene.nonlinear)
    pushed = scene.sea.amplitude.any() and (scene.settings.diffraction or linear or far)
    if pushed and abs(np.exp(1j * scene.sea.heading) - np.exp(1j * h.heading)) > 1e-6:
        raise InputError("sea.heading", scene.sea.heading, f"must be {h.heading:g} rad, that of the coefficients")
    if not scene.planar and len(h.dofs) < len(DOFS):
        raise InputError("coefficients", " ".join(h.dofs), f"must have {', '.join(DOFS)}: the scene is not planar")


@lru_cache(maxsize=8)
def remembered(
    h: Hydrodynamics,
    hulls: tuple[Hull, ...],
    tolerance: float,
    ways: tuple[tuple[str, ...], ...],
    hold: float = fitting.LOOSE,
) -> RadiationMemory:
    """The memory of a set of coefficients, of bodies with these motions: tasks that differ in sea, damping or support
    share its fit. hold: how hard A∞ is held, see `fit`.
    """
    moved = h.moved(ways)
    usual = h.memory_tolerance == tolerance
    if h.memory is not None and usual and hold == fitting.LOOSE and np.all(h.moved(h.memory_motions) == moved):
        return h.memory
    known = h.omega, h.added_mass, h.radiation_damping, h.added_mass_inf
    return fitting.fit(*known, tolerance, motion_lengths(hulls, h.dofs), h.body, moved, h.resolved, hold, h.certain)


def remembering(h: Hydrodynamics, hulls: tuple[Hull, ...], ways: tuple[tuple[str, ...], ...]) -> Hydrodynamics:
    """Coefficients with their memory as scenes have it that ask for nothing else, of bodies with these motions.

    Where that misses what it should, at the frequencies that panels resolve alone if it misses less of them.
    """
    usual = remembered(h, hulls, fitting.USUAL, ways)
    if usual.error > fitting.USUAL and (told := h.told(ways)) is not h:
        try:
            fewer = remembered(told, hulls, fitting.USUAL, ways)
        except SimulationFailed:  # of what is left nothing passive comes near
            fewer = usual
        h, usual = (told, fewer) if fewer.error < usual.error else (h, usual)
    return replace(h, memory=usual, memory_tolerance=fitting.USUAL, memory_motions=ways)


def _reaches(scene: Scene, slid: np.ndarray) -> list[float]:
    """How far from rest each hull's wetted surface gets [m]: at ±SWING of its arm and ±0.2 rad of what carries it,
    and slid (nb,) from where it is let go.
    """
    reaches, flat = limits.radii(scene), motions.in_plane(scene)
    for b, item in enumerate(scene.floats):
        seen, carrier, hinge = limits.sight(flat[b]), scene.carriers[b], np.array(item.hinge, float)
        reaches[b] += _way(item, seen * (item.centre - hinge), SWING, slid[b], scene.sea.heading)
        while carrier >= 0:
            by, point, far = scene.floats[carrier], hinge, slid[carrier]
            hinge, carrier = np.array(by.hinge, float), scene.carriers[carrier]
            reaches[b] += _way(by, seen * (point - hinge), 0.2, far, scene.sea.heading)
    return reaches


def _way(item: Float, lever: np.ndarray, angle: float, slid: float, heading: float) -> float:
    """How far the end of a lever gets [m] from its rest: turned by an angle, or slid so far from where it is let go;
    across the waves is no way."""
    turned = 2 * np.sin(angle / 2) * float(np.linalg.norm(lever))
    ahead = limits.ahead(item, np.array([np.cos(heading), np.sin(heading), 0.0]))
    start = np.abs(item.per_axis("offset"))
    rising = [x + slid for x, name in zip(start, item.motion, strict=True) if name == "heave"]
    turning = [turned] * any(not limits.slides(name) for name in item.motion)
    return float(max(ahead @ start + slid * ahead.any(), *rising, *turning, 0.0))
