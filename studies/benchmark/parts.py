"""What a step is made of; one float's pressure load both ways; a task in the frequency domain; a memory's fit."""

import itertools
from collections.abc import Callable
from dataclasses import replace

import numpy as np
from numba import njit

from solver.coupled.blocks import blocks
from solver.coupled.memory import memory_history
from solver.coupled.modal import WaterAbout, drag, flexibility
from solver.coupled.newton import Zones, new_newton, newton_matrix
from solver.coupled.preparation import prepare
from solver.coupled.scheme import LOBATTO
from solver.coupled.system import BLOCK_STEPS
from solver.hydrodynamics.pressure.froude_krylov import Incident, pressure_load
from solver.hydrodynamics.pressure.quadrature import quadrature_room
from solver.hydrodynamics.radiation import fitting
from solver.kernels import fast_lean_kernel
from solver.multibody.bodies import Coordinates, Loads, WaterLoads, new_motion, pressure_room
from solver.multibody.minimal import loads, move, pressures
from solver.reference.panels import panel_load, revolution_mesh, waves_at
from solver.run import simulate
from solver.sea.field import WaveField
from studies.benchmark.case import coefficients, median, scene, with_settings

CALLS = 2000


def each(function: Callable, *arguments) -> float:
    """Median time of one call [µs] of a compiled function, called CALLS times in compiled code."""

    @njit
    def many(count, *arguments):
        for _ in range(count):
            function(*arguments)

    many(1, *arguments)
    return median(lambda: many(CALLS, *arguments), 7) / CALLS * 1e6


def of_a_step(platform: str) -> list[tuple[str, float, float]]:
    """(part, time of one call [µs], calls a step) in the representative sea."""
    known, _ = coefficients()
    system = prepare(scene(platform), known)
    state = system.start()
    for samples, _, _ in blocks(system, state, 6 * BLOCK_STEPS):
        drive = system.drive(samples)
    body, frame, (nb, na) = system.bodies, system.structure, (2, system.bodies.added_mass.shape[0])
    z, dz = (np.concatenate([frame.carrier @ p, q]) for p, q in ((state.p, state.z), (state.dp, state.dz)))
    nz, motion, load = z.size, new_motion(body), np.zeros((nb, 6))
    move(body, z, dz, motion)
    H, constant = flexibility(frame, system.dt)[1], np.zeros((2 * nz, 2 * nz))
    loads_of_water = WaterLoads(load, np.zeros(nz), drive.excitation[5], np.zeros(na))
    out = Loads(np.zeros(nz), load.copy(), load.copy())
    series, zones = system.series(system.dt), Zones(np.zeros((2, nz), int), system.bent)
    field = drive.field[5]
    parts = [
        ("wave field", median(lambda: system.drive(series.block(999, 2 * BLOCK_STEPS + 1)), 9) / BLOCK_STEPS * 1e6, 1),
        ("Froude-Krylov and hydrostatics", each(pressures, body, motion, field, pressure_room(body), load), 2),
        ("kinematics", each(move, body, z, dz, motion), 6),
        (
            "other loads",
            each(loads, body, Coordinates(z, dz, z, np.zeros((2, nz), int)), motion, loads_of_water, out),
            4,
        ),
        (
            "radiation memory",
            each(memory_history, system.memory, state.memory, motion.active_velocity, np.zeros((2, na))),
            1,
        ),
        (
            "Newton's matrix",
            each(newton_matrix, body, motion, zones, H, constant, system.dt, LOBATTO, new_newton(nz)),
            1 / 8,
        ),
    ]
    if frame.omega.size:
        water = WaterAbout(drive.station[4:6], drive.wet[4:6], drive.push[4:6])
        dp, force = np.stack([state.dp] * 2), np.zeros((2, frame.omega.size))
        parts.append(
            ("Morison drag", each(drag, frame, water, dp, 0, force, np.zeros_like(water.flow), np.zeros(2)), 1)
        )
    return parts


def whole_step(platform: str) -> float:
    """Time of one step [µs], march and record."""
    known, _ = coefficients()
    attrs = simulate(scene(platform), known).attrs
    return attrs["march_time"] / (3700 / attrs["time_step"]) * 1e6


def pressure_pair() -> tuple[float, float, float]:
    """Median time [µs] of one float's load by quadrature and by 8,520 panels, and their difference."""
    item, (known, _) = scene("fixed"), coefficients()
    system = prepare(item, known)
    body, sea = system.bodies, item.sea
    sample = 1000  # well after the ramp
    field = system.drive(system.series(system.dt).block(sample, 1)).field[0]
    real, imag = field[: 2 * system.terms[0]].reshape(2, -1)
    rule = body.rule._replace(patch=body.rule.patch[0], whole=body.rule.whole[0])
    mesh = revolution_mesh(item.floats[0].hull, along=71, around=120)
    k, t = WaveField(sea, item.water.depth, item.water.gravity).k, sample * system.dt / 2
    waves = waves_at(k, sea.omega, sea.amplitude, depth=item.water.depth, heading=sea.heading, t=t)
    position, turned = body.reference[0] + np.array([0.05, 0.0, 0.1]), np.eye(3)
    about = body.reference[0], body.wave_direction, body.rho_g, False, body.depth
    incident = Incident(real, imag, body.surface_terms[0], *about)
    at = (position, turned, rule, incident, quadrature_room(rule))
    fast, slow = np.zeros(6), np.zeros(6)
    pressure_load(*at, fast)
    panel_load(position, turned, mesh, waves, body.rho_g, False, slow)
    quick, load = each(_one_load, *at, np.zeros(6)), np.zeros(6)
    paper = median(lambda: panel_load(position, turned, mesh, waves, body.rho_g, False, load), 7) * 1e6
    return quick, paper, float(np.abs(fast - slow).max() / np.abs(fast).max())


@fast_lean_kernel
def _one_load(position, rotation, rule, waves, room, load):
    """`pressure_load` is inlined where it is called, and `each` can only call what is not."""
    pressure_load(position, rotation, rule, waves, room, load)


def frequency_task() -> tuple[float, float]:
    """Median times [s] of a task in the frequency domain, elastic: each with another damping, and in another sea."""
    item, (known, _) = with_settings(scene("elastic"), method="frequency", froude_krylov="linear"), coefficients()
    number = itertools.count(1)

    def with_another_damping() -> None:
        floats = tuple(replace(f, pto_damping=1e4 * next(number)) for f in item.floats)
        simulate(replace(item, floats=floats), known)

    seas = iter([scene("elastic", seed).sea for seed in range(100, 116)])
    with_another_damping()

    def with_another_sea() -> None:
        simulate(replace(item, sea=next(seas)), known)

    with_another_sea()
    return median(with_another_damping, 30), median(with_another_sea, 15)


def memory_fit() -> float:
    """Time [s] to fit the pair's radiation memory at the default tolerance."""
    h, _ = coefficients()
    return median(lambda: fitting.fit(h.omega, h.added_mass, h.radiation_damping, h.added_mass_inf))
