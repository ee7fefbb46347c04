"""What a record says about itself: energy balance, constraint drift, estimated errors, and what was skipped."""

from collections.abc import Iterator, Mapping

import numpy as np

from solver.coupled import assembly
from solver.coupled.stages import State
from solver.coupled.system import System
from solver.hydrodynamics.bem.coefficients import DOFS, PLANAR, Hydrodynamics, coarser
from solver.hydrodynamics.radiation.fitting import USUAL
from solver.hydrodynamics.radiation.memory import RadiationMemory
from solver.multibody.bodies import new_motion
from solver.multibody.minimal import move
from solver.record.effects import together
from solver.record.probe import Probe
from solver.record.refit import SWAYED
from solver.scene import MOST_PANELS, Scene, Settings, panels_for

DOUBT = 0.05  # estimated error beyond which a record warns of it
FAR_OFF = 10  # times what was asked of a memory's fit: so far away it ends where water rings in a band that none fits
NARROW = 0.2  # of the size of the largest hull from its reference point, a tenth across: a gap in which water may ring


def audit(probe: Probe, hydrodynamics: Hydrodynamics | None, state: State) -> dict[str, float | str]:
    """Relative errors of any mean, rms or std, what was asked and not met, and what was left out.

    `estimated_error` is that of step, samples, quadrature, memory, BEM mesh, the frame's shapes, elements and stations,
    and the tables of laws together.
    """
    system = probe.system
    errors = probe.errors(hydrodynamics)
    return {
        **errors,
        "memory_error": system.fit.error if system.fit else 0.0,
        "memory_poles": system.fit.beta.size if system.fit else 0,
        "constraint_drift": constraint_drift(system, state),
        "unmet": "; ".join(unmet(system.scene, system.fit, errors, hydrodynamics)),
        "skipped": "; ".join([*skipped(system), *coarser(hydrodynamics)]),
    }


def unmet(
    scene: Scene, fit: RadiationMemory | None, errors: Mapping[str, float], h: Hydrodynamics | None = None
) -> list[str]:
    """What was asked for and not reached, with both numbers, by which of a record's `errors`.

    Of a memory that nobody asked for, what it changes: one fitted again gives up what does not.
    """
    s, notes = scene.settings, []
    if s.tolerance is not None and not errors["estimated_error"] <= s.tolerance:
        parts = ", ".join(f"{name} {errors[name]:.2g}" for name in against(s.tolerance, errors))
        note = f"tolerance = {s.tolerance:g}: the estimated error is {errors['estimated_error']:.2g}, by {parts}"
        if errors["mesh_effect"] > s.tolerance:
            note += _panels(scene, h)
        notes.append(note)
    if fit is not None and s.memory == "state-space" and not _remembers(s, fit, errors):
        asked, moved = s.memory_tolerance, f"changes what moves by {errors['memory_effect']:.2g}"
        gap = "" if not fit.error > FAR_OFF * (asked or USUAL) else _ringing(scene)
        ended = f"fit ended at {fit.error:.2g}"
        if asked:
            notes.append(f"memory_tolerance = {asked:g}: the radiation memory's {ended}, which {moved}{gap}")
        else:
            notes.append(f"the radiation memory {moved}, more than {SWAYED:g}; its {ended}{gap}")
    return notes


def _ringing(scene: Scene) -> str:
    """What may help where water rings in a gap, or a well, that no lid damps yet."""
    if scene.settings.gap_damping > 0 or not scene.has_gap(NARROW * max(f.hull.size for f in scene.floats)):
        return ""
    return "; water may ring in a narrow gap between floats, or a well: solver.gap_damping and gap_width damp it"


def _panels(scene: Scene, h: Hydrodynamics | None) -> str:
    """How fine the boundary elements are, and what decides that; of a file's coefficients nothing is known."""
    if h is None or "panels" not in h.settings:
        return ""
    panels = panels_for(scene.settings.tolerance, [f.hull for f in scene.floats])
    more = "the most of any" if panels == MOST_PANELS else f"by a smaller one up to {MOST_PANELS}"
    count = f"boundary elements have {h.settings['panels']:g} panels"
    return f"; {count}: by it {panels} a body, {more}, or what a hull's own mesh has"


def _remembers(s: Settings, fit: RadiationMemory, errors: Mapping[str, float]) -> bool:
    """Whether a memory does: where nobody asked for a misfit by what it changes, of which a tolerance has its share."""
    if s.memory_tolerance is not None:
        return fit.error <= s.memory_tolerance
    return s.tolerance is not None or errors["memory_effect"] <= SWAYED


def doubts(s: Settings, errors: Mapping[str, float]) -> Iterator[str]:
    """A sentence where a record may be further off than anyone expects, and nobody asked for an error."""
    if s.tolerance is None and not errors["estimated_error"] <= DOUBT:
        parts = ", ".join(f"{name} {errors[name]:.2g}" for name in against(DOUBT, errors))
        yield f"estimated_error is {errors['estimated_error']:.2g}, of any mean, rms or std, by {parts}"


def against(tolerance: float, errors: Mapping[str, float]) -> list[str]:
    """Names of the fewest parts of `estimated_error`, the largest first, without which it would meet the tolerance."""
    names = sorted((name for name in errors if name != "estimated_error"), key=lambda name: -errors[name])
    rests = (together(errors[name] for name in names[without:]) for without in range(len(names)))
    return names[: sum(not rest <= tolerance for rest in rests)]


def constraint_drift(system: System, state: State) -> float:
    """Largest gap [m] between the end of each arm and its hinge on the support, at the end."""
    body, nc = system.bodies, system.structure.carrier.shape[0]
    z = np.concatenate([system.structure.carrier @ state.p, state.z])
    motion = new_motion(body)
    move(body, z, np.zeros(z.size), motion)
    drift = 0.0
    for b, item in enumerate(system.scene.floats):
        if item.motion != ("hinge",):
            continue
        hinge, carrier = np.array(item.hinge, float), system.scene.carriers[b]
        if carrier >= 0:
            arm = hinge - system.scene.floats[carrier].centre
            hinge = motion.position[carrier] + motion.rotation[carrier] @ arm
        if nc:
            axes = assembly.carrier_axes(system.scene.planar)
            shift = np.zeros(6)
            shift[axes] = z[b * axes.size : (b + 1) * axes.size]
            hinge += shift[:3]
        gap = motion.position[b] - motion.rotation[b] @ item.arm - hinge
        drift = max(drift, float(np.abs(gap).max()))
    return drift


def skipped(system: System) -> list[str]:
    """What this scene did not need, each with a bound on what leaving it out can change."""
    scene, s, notes = system.scene, system.scene.settings, []
    if scene.platform is None:
        notes.append("frame: the support is fixed (exact)")
    if not scene.floats:
        notes.append("boundary elements, pressure and memory: no floats (exact)")
    elif scene.planar:
        kept = [DOFS[d] for d in system.bodies.active] or PLANAR  # none are active where none radiates
        notes.append(f"motions other than {', '.join(kept)}, half of each hull: mirror symmetry in y = 0 (exact)")
    if system.support is not None and scene.platform is not None:
        notes.append(
            f"modes: {system.structure.omega.size} shapes for {scene.platform.frame.freedoms},"
            " the rest as static load shapes (see `shapes_effect`)"
        )
    if scene.floats and s.froude_krylov == "linear":
        notes.append("pressure quadrature: linear hydrostatics and Froude-Krylov (exact for a linear scene)")
    if scene.floats and system.bodies.nonlinear.any():
        notes.append(f"terms of the local wave field beyond {s.field_tolerance:g} of the sum of amplitudes")
    if system.near != system.waves:
        rest = system.near.sea.amplitude != system.waves.sea.amplitude
        power, longest = np.abs(system.waves.sea.amplitude) ** 2, 2 * np.pi / system.waves.k[rest].min()
        notes.append(
            f"body-nonlinear pressure of waves of {longest:.3g} m and less, which floats hardly feel: it is linear"
            f" ({power[rest].sum() / power.sum():.2g} of the waves' energy)"
        )
    for switch in ("diffraction", "radiation", "interaction"):
        if scene.floats and not getattr(s, switch):
            notes.append(f"{switch}: switched off")
    if not s.keep_series:
        notes.append("time series: not asked for")
    return notes
