"""What a record says about itself: energy balance, constraint drift, estimated errors, and what was skipped."""

from dataclasses import dataclass, field, replace

import numpy as np
from scipy.interpolate import CubicSpline

from solver.coupled import assembly
from solver.coupled.march import Output, State
from solver.coupled.system import System, blocks
from solver.hydrodynamics.bem.coefficients import DOFS, Hydrodynamics
from solver.multibody.minimal import mass_matrix, move, new_motion, pressures

PROBE = 120.0  # length of the run with half the step [s]
STATES = 48  # at which the pressure's quadrature is compared with a finer one
# Error of coefficients extrapolated from two meshes, as a share of the extrapolation itself (`mesh_error`):
# measured on Hulme's hemisphere, see the convergence table of `make validate`.
EXTRAPOLATED = 0.2
MARGIN = 1.25  # what the sum of the estimates is multiplied by: each is a sample


@dataclass(eq=False)
class Probe:
    """Keeps the first PROBE seconds of a run: the joints' axes, the lowest mode, and some states."""

    system: System
    motion: list[np.ndarray] = field(default_factory=list)
    states: list[tuple[np.ndarray, np.ndarray]] = field(default_factory=list)
    samples: int = 0

    def add(self, samples: np.ndarray, output: Output) -> None:
        """Take in a block."""
        wanted = 2 * int(PROBE / self.system.dt)
        taken = min(len(samples), wanted - self.samples)
        if taken <= 0:
            return
        self.samples += taken
        self.motion.append(_compared(self.system, output)[:taken])
        pressure = self.system.drive(samples).field
        every = max(1, wanted // STATES)
        self.states += [(output.z[i].copy(), pressure[i].copy()) for i in range(0, taken, every)]


def _compared(system: System, output: Output) -> np.ndarray:
    joints = output.z.shape[1] - system.structure.carrier.shape[0]
    largest = output.p[:, :1] * system.structure.scale[:1]  # [m], as are the joints' or their radians
    return np.concatenate([output.z[:, output.z.shape[1] - joints :], largest], axis=1)


def audit(system: System, hydrodynamics: Hydrodynamics | None, probe: Probe, state: State) -> dict[str, float | str]:
    """Relative errors, each of the rms of what it is an error of, and what was left out.

    `estimated_error` is MARGIN times the sum of those of step, quadrature, memory, wave field and BEM mesh.
    """
    memory_effect, mesh_effect = coefficient_effects(system, hydrodynamics)
    parts = {
        "discretization_error": step_error(system, probe),
        "quadrature_error": quadrature_error(system, probe),
        "memory_effect": memory_effect,
        "mesh_effect": mesh_effect,
    }
    field_error = system.scene.settings.field_tolerance if system.scene.floats else 0.0
    return {
        **parts,
        "estimated_error": MARGIN * (sum(parts.values()) + field_error),
        "memory_error": system.fit.error if system.fit else 0.0,
        "memory_poles": system.fit.beta.size if system.fit else 0,
        "constraint_drift": constraint_drift(system, state),
        "skipped": "; ".join(skipped(system)),
    }


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


def step_error(system: System, probe: Probe) -> float:
    """Error of the step length over the first PROBE seconds, relative to the rms of each joint and mode.

    The scheme is of fourth order, so the run with half the step differs by 15/16 of the error.
    """
    dt = system.dt / 2
    half = replace(system, dt=dt, memory=assembly.memory(system.fit, dt, system.bodies.added_mass.shape[0]))
    fine = np.concatenate([_compared(half, output) for _, output, _ in blocks(half, half.start(), probe.samples)])
    coarse = np.concatenate(probe.motion)
    return relative(coarse - fine[1::2], coarse, system.newton_tolerance) * 16 / 15


def relative(difference: np.ndarray, whole: np.ndarray, least: float | np.ndarray = 0.0) -> float:
    """Largest ratio of root mean squares (m, …), of what is smaller than `least` to that; what is zero has no error."""
    error, scale = (np.sqrt(np.mean(x**2, axis=0)) for x in (difference, whole))
    scale = np.maximum(scale, least)
    return float(np.max(error[scale > 0] / scale[scale > 0], initial=0.0))


def quadrature_error(system: System, probe: Probe) -> float:
    """Of the pressure's load on the joints, against twice the points, relative to its varying part."""
    if not system.bodies.nonlinear.any():
        return 0.0
    s = system.scene.settings
    finer = {name: 2 * getattr(s, name) for name in ("azimuths", "arc_points", "line_points")}
    scene = replace(system.scene, settings=replace(s, panel_size=s.panel_size / 2, **finer))
    fine = system.bodies._replace(**assembly.rules(scene, system.waves))
    usual, exact = (_joint_loads(body, probe.states) for body in (system.bodies, fine))
    joints = slice(system.structure.carrier.shape[0], None)
    least = system.newton_tolerance * np.abs(np.diag(system.stiffness))[joints]
    return relative((usual - exact)[:, joints], (exact - exact.mean(axis=0))[:, joints], least)


def _joint_loads(body, states) -> np.ndarray:
    """Jᵀ F of the pressure's load F at some states, (m, nz)."""
    motion, load = new_motion(body), np.empty((body.axes.size, 6))
    loads = np.zeros((len(states), body.damping.size))
    for row, (z, pressure) in zip(loads, states, strict=True):
        move(body, z, np.zeros(z.size), motion)
        pressures(body, motion, pressure, load)
        for b in range(body.axes.size):
            n = body.axes[b]
            row[body.coordinate[b, :n]] += motion.jacobian[b, :, :n].T @ load[b]
    return loads


def coefficient_effects(system: System, h: Hydrodynamics | None) -> tuple[float, float]:
    """What the memory's misfit and the boundary elements' mesh do to the linear response, of its rms in this sea.

    Z z = Jᵀ X a with Z = -ω²(M + A) - iω(B + D) + K on the joints, the support held: with the fit's
    B - iω(A - A∞) in place of the coefficients', and with all coefficients off by their own error.
    """
    sea = system.scene.sea
    if system.fit is None or not sea.amplitude.any():
        return 0.0, 0.0
    w = h.omega[:, None, None]
    table = CubicSpline(h.omega, h.radiation_damping - 1j * w * (h.added_mass - system.fit.added_mass_inf))(sea.omega)
    extrapolated = h.settings.get("panels") != h.settings.get("panels_coarse")
    shift = (EXTRAPOLATED if extrapolated else 1.0) * h.mesh_error
    diffraction = shift * h.excitation(sea.omega, "diffraction")
    exact = _linear_response(system, table, h.excitation(sea.omega))
    fitted = _linear_response(system, system.fit.frequency(sea.omega), h.excitation(sea.omega))
    shifted = _linear_response(system, (1 + shift) * table, h.excitation(sea.omega) + diffraction)
    return relative(np.abs(fitted - exact), np.abs(exact)), relative(np.abs(shifted - exact), np.abs(exact))


def _linear_response(system: System, Y: np.ndarray, excitation: np.ndarray) -> np.ndarray:
    """z (n, nj) of the joints for radiation impedance Y (n, na, na) less A∞'s, and excitation (n, na)."""
    body, sea, first = system.bodies, system.scene.sea, system.structure.carrier.shape[0]
    nr, nz = body.active.size, body.damping.size
    motion, M = new_motion(body), np.empty((nz, nz))
    move(body, np.zeros(nz), np.zeros(nz), motion)
    mass_matrix(body, motion, M)
    J = np.zeros((body.axes.size * nr, nz))
    for b in range(body.axes.size):
        n = body.axes[b]
        J[b * nr : (b + 1) * nr, body.coordinate[b, :n]] = motion.jacobian[b, body.active, :n]
    J, M, K = J[:, first:], M[first:, first:], system.stiffness[first:, first:]
    w = sea.omega[:, None, None]
    Z = -(w**2) * M - 1j * w * (J.T @ Y @ J + np.diag((body.pto + body.damping)[first:])) + K
    return np.linalg.solve(Z, (excitation * sea.amplitude[:, None] @ J)[..., None])[..., 0]


def skipped(system: System) -> list[str]:
    """What this scene did not need, each with a bound on what leaving it out can change."""
    scene, s, notes = system.scene, system.scene.settings, []
    if scene.platform is None:
        notes.append("frame: the support is fixed (exact)")
    if not scene.floats:
        notes.append("boundary elements, pressure and memory: no floats (exact)")
    elif scene.planar:
        kept = ", ".join(DOFS[d] for d in system.bodies.active)
        notes.append(f"motions other than {kept}, half of each hull: mirror symmetry in y = 0 (exact)")
    if system.support is not None:
        notes.append(
            f"modes: {system.structure.omega.size} shapes for {system.support.dry_omega.size},"
            " the rest as static load shapes (discretization of the frame, see the benchmark's knob `modes`)"
        )
    if scene.floats and s.froude_krylov == "linear":
        notes.append("pressure quadrature: linear hydrostatics and Froude-Krylov (exact for a linear scene)")
    if scene.floats and system.bodies.nonlinear.any():
        notes.append(f"terms of the local wave field beyond {s.field_tolerance:g} of the sum of amplitudes")
    for switch in ("diffraction", "radiation"):
        if scene.floats and not getattr(s, switch):
            notes.append(f"{switch}: switched off")
    if not s.keep_series:
        notes.append("time series: not asked for")
    return notes
