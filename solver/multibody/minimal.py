"""Equations of motion of the floats in minimal coordinates z = [carrier, joint].

Carrier coordinates are the motion of the support's node under each float (modal shapes times
modal amplitudes), joint coordinates those of the float's joint. The load W on each body, inertia
included (d'Alembert), is projected on the axes: JᵀW = 0 for a joint, and for a carrier JᵀW is
the load that the float puts on its support. -W is the load of all its joints on the float. A float
that hangs on another one has that one's coordinates first.
"""

import numpy as np

from solver.catenary import add_lines, line_pull
from solver.hydrodynamics.pressure.froude_krylov import Incident, pressure_load
from solver.hydrodynamics.pressure.quadrature import WettedQuadrature
from solver.hydrodynamics.pressure.wetted_panels import panels_pressure
from solver.kernels import fast_lean_kernel, inner_kernel, kernel, lean_kernel, part_kernel
from solver.multibody.bodies import Bodies, Coordinates, Loads, Motion, PressureRoom, WaterLoads
from solver.multibody.chain import Chain, cross, into, kinematics, moment, rotated, rotation_vector
from solver.multibody.joint_law import (
    PTO_ZONE,
    STOP_ZONE,
    add_coupled,
    axis_energy,
    axis_load,
    coupled_energy,
    coupled_loss,
)

SWINGS = 5  # rounds in which the place that swings are of is found: each leaves kX of the last one's error


@lean_kernel(forceinline=True)
def move(bodies: Bodies, z: np.ndarray, dz: np.ndarray, motion: Motion) -> None:
    """Positions, Jacobians and velocities of all bodies from z, dz (nz,)."""
    nr = bodies.active.size
    for b in range(bodies.axes.size):
        n = bodies.axes[b]
        chain = Chain(bodies.kind[b, :n], bodies.direction[b, :n], bodies.point[b, :n], bodies.coordinate[b, :n])
        kinematics(
            chain,
            bodies.reference[b],
            z,
            dz,
            motion.position[b],
            motion.rotation[b],
            motion.jacobian[b],
            motion.velocity[b],
            motion.bias[b],
        )
        if bodies.turning:
            v = _into_axes(motion.rotation[b], motion.velocity[b], motion.scratch[0])
            for r in range(nr):
                motion.active_velocity[b * nr + r] = v[bodies.active[r]]
        else:
            for r in range(nr):
                motion.active_velocity[b * nr + r] = motion.velocity[b, bodies.active[r]]


@lean_kernel
def _into_axes(R: np.ndarray, x: np.ndarray, out: np.ndarray) -> np.ndarray:
    """out (6,) <- Rᵀ of both halves of x (6,)."""
    out[0], out[1], out[2] = into(R, x[0], x[1], x[2])
    out[3], out[4], out[5] = into(R, x[3], x[4], x[5])
    return out


@lean_kernel
def _add_turned(R: np.ndarray, x: np.ndarray, out: np.ndarray) -> None:
    """out (6,) += R of both halves of x (6,)."""
    a, b, c = rotated(R, x[:3])
    out[0], out[1], out[2] = out[0] + a, out[1] + b, out[2] + c
    a, b, c = rotated(R, x[3:])
    out[3], out[4], out[5] = out[3] + a, out[4] + b, out[5] + c


@part_kernel
def _spatial_inertia(bodies: Bodies, b: int, rotation: np.ndarray, M: np.ndarray, lever: np.ndarray) -> None:
    """M (6, 6) about the reference point in world axes; lever (3,) and more: room for that to the c.o.g."""
    m, inertia = bodies.mass[b], bodies.inertia[b]
    for r in range(3):
        lever[r] = (
            rotation[r, 0] * bodies.cog[b, 0] + rotation[r, 1] * bodies.cog[b, 1] + rotation[r, 2] * bodies.cog[b, 2]
        )
    x, y, z = lever[0], lever[1], lever[2]
    M[:] = 0.0
    M[0, 0] = M[1, 1] = M[2, 2] = m
    M[0, 4], M[0, 5], M[1, 3], M[1, 5], M[2, 3], M[2, 4] = m * z, -m * y, -m * z, m * x, m * y, -m * x
    M[4, 0], M[5, 0], M[3, 1], M[5, 1], M[3, 2], M[4, 2] = m * z, -m * y, -m * z, m * x, m * y, -m * x
    square = x * x + y * y + z * z
    for i in range(3):
        for j in range(3):
            total = -m * lever[i] * lever[j]
            for k in range(3):
                for n in range(3):
                    total += rotation[i, k] * inertia[k, n] * rotation[j, n]
            M[3 + i, 3 + j] = total
        M[3 + i, 3 + i] += m * square


@kernel(inline="always")
def _rule_of(bodies: Bodies, b: int) -> WettedQuadrature:
    """The quadrature of one body."""
    rule = bodies.rule
    return WettedQuadrature(
        rule.patch[b, : bodies.patches[b]],
        rule.whole[b],
        rule.azimuth,
        rule.dpsi,
        rule.arc_u,
        rule.arc_w,
        rule.line_u,
        rule.line_w,
        rule.half,
    )


@kernel(inline="always")
def _linear_hydrostatics(bodies: Bodies, b: int, motion: Motion, load: np.ndarray) -> None:
    """-∂U/∂x and J⁻ᵀ(-∂U/∂θ) of U = ξᵀKξ/2 - bᵀξ, ξ = (x - x₀, θ), of buoyancy b at rest and the rotation R = exp[θ].

    J is that of rotations dφ = J dθ about the axes of space. What of the stiffness is not symmetric it makes of b.
    """
    x, x0, theta = motion.position[b], bodies.reference[b], rotation_vector(motion.rotation[b])
    shift = (x[0] - x0[0], x[1] - x0[1], x[2] - x0[2], theta[0], theta[1], theta[2])
    for i in range(3):
        load[i] += bodies.buoyancy[b, i]
        for c in range(6):
            load[i] -= bodies.stiffness[b, i, c] * shift[c]
    mx, my, mz = bodies.buoyancy[b, 3], bodies.buoyancy[b, 4], bodies.buoyancy[b, 5]
    for c in range(6):
        mx -= (bodies.stiffness[b, 3, c] + bodies.stiffness[b, c, 3]) / 2 * shift[c]
        my -= (bodies.stiffness[b, 4, c] + bodies.stiffness[b, c, 4]) / 2 * shift[c]
        mz -= (bodies.stiffness[b, 5, c] + bodies.stiffness[b, c, 5]) / 2 * shift[c]
    mx, my, mz = moment(theta, mx, my, mz)
    load[3] += mx
    load[4] += my
    load[5] += mz


@fast_lean_kernel(forceinline=True)
def pressures(bodies: Bodies, motion: Motion, field: np.ndarray, room: PressureRoom, out: np.ndarray) -> None:
    """Hydrostatic load, the incident wave's where it is body-nonlinear, and the mooring lines': out (nb, 6).

    With the linear wave loads of floats that slide. field (2 first_term[-1] + (nr + 1) first_along[-1],): of each float
    in turn the real and the imaginary parts of its series, then the terms of each in its place along the waves.
    """
    out[:] = 0.0
    for b in range(bodies.axes.size):
        add_lines(bodies.lines, b, motion.position[b], motion.rotation[b], out[b])
        if not bodies.nonlinear[b]:
            _linear_hydrostatics(bodies, b, motion, out[b])
            continue
        first, last = bodies.first_term[b], bodies.first_term[b + 1]
        waves = Incident(
            field[2 * first : first + last],
            field[first + last : 2 * last],
            bodies.surface_terms[b],
            bodies.about[b],
            bodies.wave_direction,
            bodies.rho_g,
            bodies.wheeler,
            bodies.depth,
        )
        if bodies.meshed[b]:
            panels_pressure(b, motion.position[b], motion.rotation[b], bodies.panels, waves, room.panels, out[b])
        else:
            rule = _rule_of(bodies, b)
            pressure_load(motion.position[b], motion.rotation[b], rule, waves, room.quadrature, out[b])
        if bodies.first_along[b + 1] > bodies.first_along[b]:
            _add_along(bodies, b, motion, field, out[b])


@part_kernel
def _add_along(bodies: Bodies, b: int, motion: Motion, field: np.ndarray, out: np.ndarray) -> None:
    """out += Σₙ Eₙ Tₙ(u), u = s/reach of where the float's leader is along the waves but for what they swing it by.

    That is the last row of each term, and itself of the place: see coupled.sliding.
    """
    nr = bodies.active.size
    start = 2 * bodies.first_term[-1] + (nr + 1) * bodies.first_along[b]
    count = bodies.first_along[b + 1] - bodies.first_along[b]
    terms = field[start : start + (nr + 1) * count].reshape(count, nr + 1)
    x, rest = motion.position[bodies.leader[b]], bodies.reference[bodies.leader[b]]
    dx, dy = x[0] - rest[0], x[1] - rest[1]
    s = dx * bodies.wave_direction[0] + dy * bodies.wave_direction[1]
    u = _within(s / bodies.reach[b])
    for _ in range(SWINGS):
        u = _within((s - _chebyshev(terms, nr, u)) / bodies.reach[b])
    load = motion.scratch[0] if bodies.turning else out
    if bodies.turning:
        load[:] = 0.0
    for r in range(nr):
        load[bodies.active[r]] += _chebyshev(terms, r, u)
    if bodies.turning:
        _add_turned(motion.rotation[b], load, out)


@kernel(inline="always")
def _within(u: float) -> float:
    return min(max(u, -1.0), 1.0)


@part_kernel
def _chebyshev(terms: np.ndarray, r: int, u: float) -> float:
    """Σₙ cₙ Tₙ(u), c = terms[:, r], by Clenshaw's recurrence."""
    one = two = 0.0
    for n in range(len(terms) - 1, 0, -1):
        one, two = terms[n, r] + 2 * u * one - two, one
    return terms[0, r] + u * one - two


@lean_kernel
def line_tensions(bodies: Bodies, z: np.ndarray, motion: Motion, out: np.ndarray) -> None:
    """Tensions [N] of all lines at their fairleads, out (m, n), at coordinates z (m, nz); motion: scratch."""
    for k in range(len(z)):
        move(bodies, z[k], z[k], motion)  # places do not ask for rates
        for b in range(bodies.axes.size):
            for i in range(bodies.lines.first[b], bodies.lines.first[b + 1]):
                _, _, _, fx, fy, fz = line_pull(bodies.lines, i, motion.position[b], motion.rotation[b])
                out[k, i] = np.sqrt(fx * fx + fy * fy + fz * fz)


@lean_kernel(forceinline=True)
def loads(bodies: Bodies, at: Coordinates, motion: Motion, water: WaterLoads, out: Loads) -> None:
    """Fill out (Loads) with the equations of motion at coordinates `at`, moved there as `motion`, under WaterLoads."""
    nb, nr = bodies.axes.size, bodies.active.size
    for b in range(nb):
        for r in range(6):
            a = motion.bias[b, r]
            for i in range(bodies.axes[b]):
                a += motion.jacobian[b, r, i] * at.ddz[bodies.coordinate[b, i]]
            motion.acceleration[b, r] = a
        if bodies.turning:
            _turn_acceleration(b, motion, motion.acceleration[nb + b])
    out.residual[:] = 0.0
    for b in range(nb):
        W = out.wrench[b]
        _wave_wrench(bodies, b, motion, water, W)
        for r in range(6):
            out.external[b, r] = W[r]
        radiated, first = W, 0
        if bodies.turning:
            radiated, first = motion.scratch[0], nb
            radiated[:] = 0.0
        for r in range(nr):
            i = b * nr + r
            total = water.memory[i]
            for j in range(nb):
                for s in range(nr):
                    total += bodies.added_mass[i, j * nr + s] * motion.acceleration[first + j, bodies.active[s]]
            radiated[bodies.active[r]] -= total
        if bodies.turning:
            _turn_impulse(bodies, b, motion, radiated)
            _add_turned(motion.rotation[b], radiated, W)
        _weight_and_inertia(bodies, b, motion, W)
        for i in range(bodies.axes[b]):
            for r in range(6):
                out.residual[bodies.coordinate[b, i]] += motion.jacobian[b, r, i] * W[r]
    for i in range(at.z.size):
        load = axis_load(bodies.law, i, at.zone[STOP_ZONE, i], at.zone[PTO_ZONE, i], at.z[i], at.dz[i])
        out.residual[i] -= load.pto + load.loss + load.spring + bodies.mechanism[i] * at.ddz[i]
    add_coupled(bodies.law, at.z, at.dz, -1.0, out.residual, out.residual)


@inner_kernel
def _turn_acceleration(b: int, motion: Motion, out: np.ndarray) -> None:
    """out (6,) <- V̇ along a body's axes: Rᵀ(a - ω × v) and Rᵀω̇."""
    a, v = motion.acceleration[b], motion.velocity[b]
    x, y, z = cross(v[3], v[4], v[5], v[0], v[1], v[2])
    out[0], out[1], out[2] = into(motion.rotation[b], a[0] - x, a[1] - y, a[2] - z)
    out[3], out[4], out[5] = into(motion.rotation[b], a[3], a[4], a[5])


@inner_kernel
def _turn_impulse(bodies: Bodies, b: int, motion: Motion, F: np.ndarray) -> None:
    """F (6,) -= what turns the water's impulse (P, L) = A∞ V with a body: ω × P, and ω × L + v × P (Kirchhoff)."""
    nr, impulse = bodies.active.size, motion.scratch[1]
    impulse[:] = 0.0
    for r in range(nr):
        for j in range(motion.active_velocity.size):
            impulse[bodies.active[r]] += bodies.added_mass[b * nr + r, j] * motion.active_velocity[j]
    v = _into_axes(motion.rotation[b], motion.velocity[b], motion.scratch[2])
    px, py, pz = impulse[0], impulse[1], impulse[2]
    fx, fy, fz = cross(v[3], v[4], v[5], px, py, pz)
    mx, my, mz = cross(v[3], v[4], v[5], impulse[3], impulse[4], impulse[5])
    ux, uy, uz = cross(v[0], v[1], v[2], px, py, pz)
    F[0], F[1], F[2] = F[0] - fx, F[1] - fy, F[2] - fz
    F[3], F[4], F[5] = F[3] - mx - ux, F[4] - my - uy, F[5] - mz - uz


@kernel(inline="always")
def _wave_wrench(bodies: Bodies, b: int, motion: Motion, water: WaterLoads, W: np.ndarray) -> None:
    """W <- excitation and pressure, carried on by the stiffness of buoyancy and lines."""
    if bodies.turning:
        for r in range(6):
            W[r] = water.pressure[b, r]
        _add_turned(motion.rotation[b], water.excitation[b], W)
    else:
        for r in range(6):
            W[r] = water.excitation[b, r] + water.pressure[b, r]
    for c in range(6):
        moved = 0.0
        for i in range(bodies.axes[b]):
            moved += motion.jacobian[b, c, i] * water.since[bodies.coordinate[b, i]]
        for r in range(6):
            W[r] -= (bodies.stiffness[b, r, c] + bodies.pulled[b, r, c]) * moved


@part_kernel
def powers(
    bodies: Bodies, at: Coordinates, motion: Motion, external: np.ndarray, memory: np.ndarray
) -> tuple[float, float, float, float]:
    """Powers [W] of pressure, lines and excitation; of radiation memory, PTO and joints' other losses as dissipated.

    Of the step's final velocities: with others, weight and buoyancy, far larger than what varies, would not balance.
    """
    nb, nr = bodies.axes.size, bodies.active.size
    waves = radiation = pto = loss = 0.0
    for b in range(nb):
        for r in range(6):
            waves += external[b, r] * motion.velocity[b, r]
        for r in range(nr):
            radiation += memory[b * nr + r] * motion.active_velocity[b * nr + r]
    for i in range(at.dz.size):
        load = axis_load(bodies.law, i, at.zone[STOP_ZONE, i], at.zone[PTO_ZONE, i], at.z[i], at.dz[i])
        pto += load.pto * at.dz[i]
        loss += load.loss * at.dz[i]
    return waves, radiation, pto, loss + coupled_loss(bodies.law, at.z, at.dz)


@part_kernel
def _weight_and_inertia(bodies: Bodies, b: int, motion: Motion, W: np.ndarray) -> None:
    """W += weight and d'Alembert's loads about the reference point, by Newton and Euler at the c.o.g."""
    R, inertia, a = motion.rotation[b], bodies.inertia[b], motion.acceleration[b]
    x, y, z = rotated(R, bodies.cog[b])
    wx, wy, wz = motion.velocity[b, 3], motion.velocity[b, 4], motion.velocity[b, 5]
    ux, uy, uz = cross(wx, wy, wz, x, y, z)
    cx, cy, cz = cross(wx, wy, wz, ux, uy, uz)
    tx, ty, tz = cross(a[3], a[4], a[5], x, y, z)
    m = bodies.mass[b]
    fx, fy, fz = -m * (a[0] + tx + cx), -m * (a[1] + ty + cy), -m * (a[2] + tz + cz + bodies.gravity)
    # Spin and its rate in the body's frame, where the inertia is constant.
    px, py, pz = into(R, wx, wy, wz)
    qx, qy, qz = into(R, a[3], a[4], a[5])
    hx, hy, hz = rotated(inertia, (px, py, pz))
    gx, gy, gz = cross(px, py, pz, hx, hy, hz)
    dx, dy, dz = rotated(inertia, (qx, qy, qz))
    lx, ly, lz = rotated(R, (dx + gx, dy + gy, dz + gz))
    mx, my, mz = cross(x, y, z, fx, fy, fz)
    W[0] += fx
    W[1] += fy
    W[2] += fz
    W[3] += mx - lx
    W[4] += my - ly
    W[5] += mz - lz


@lean_kernel
def mass_matrix(bodies: Bodies, motion: Motion, M: np.ndarray) -> None:
    """M (nz, nz) of the floats with the added mass at infinite frequency."""
    nb = bodies.axes.size
    M[:] = 0.0
    block, column, lever = motion.scratch[:6], motion.scratch[6], motion.scratch[7]
    for b in range(nb):
        _spatial_inertia(bodies, b, motion.rotation[b], block, lever)
        _project(bodies, motion, b, b, block, column, M)
    for b in range(nb):
        for c in range(nb):
            _added_mass(bodies, motion, b, c, block)
            _project(bodies, motion, b, c, block, column, M)
    for i in range(bodies.mechanism.size):
        M[i, i] += bodies.mechanism[i]


@lean_kernel
def take_inertia(bodies: Bodies, motion: Motion, ddz: np.ndarray, wrench: np.ndarray) -> None:
    """wrench (nb, 6) -= what d'Alembert's loads and added mass at infinite frequency are of accelerations ddz (nz,)."""
    X, a, lever = motion.scratch[:6], motion.scratch[6], motion.scratch[7]
    for c in range(bodies.axes.size):
        _spatial_inertia(bodies, c, motion.rotation[c], X, lever)
        a[:] = 0.0
        for j in range(bodies.axes[c]):
            for r in range(6):
                a[r] += motion.jacobian[c, r, j] * ddz[bodies.coordinate[c, j]]
        _take(X, a, wrench[c])
        for b in range(bodies.axes.size):
            _added_mass(bodies, motion, b, c, X)
            _take(X, a, wrench[b])


@lean_kernel
def _take(X: np.ndarray, a: np.ndarray, W: np.ndarray) -> None:
    """W (6,) -= X a."""
    for r in range(6):
        for s in range(6):
            W[r] -= X[r, s] * a[s]


@lean_kernel
def _added_mass(bodies: Bodies, motion: Motion, b: int, c: int, X: np.ndarray) -> None:
    """X (6, 6) <- that of body b with the accelerations of c, along the axes of space."""
    nr = bodies.active.size
    X[:] = 0.0
    for r in range(nr):
        for s in range(nr):
            X[bodies.active[r], bodies.active[s]] = bodies.added_mass[b * nr + r, c * nr + s]
    if bodies.turning:
        _turn_block(motion.rotation[b], motion.rotation[c], X)


@lean_kernel
def _turn_block(R: np.ndarray, Q: np.ndarray, X: np.ndarray) -> None:
    """X (6, 6) <- R X Qᵀ, R and Q (3, 3) of its halves."""
    for h in range(0, 6, 3):
        for i in range(6):
            X[i, h], X[i, h + 1], X[i, h + 2] = rotated(Q, (X[i, h], X[i, h + 1], X[i, h + 2]))
    for h in range(0, 6, 3):
        for j in range(6):
            X[h, j], X[h + 1, j], X[h + 2, j] = rotated(R, (X[h, j], X[h + 1, j], X[h + 2, j]))


@lean_kernel
def _project(bodies: Bodies, motion: Motion, b: int, c: int, X: np.ndarray, column: np.ndarray, M: np.ndarray) -> None:
    """M += J_bᵀ X J_c for X (6, 6); column (6,): scratch. In a plane half of J is zero."""
    for j in range(bodies.axes[c]):
        column[:] = 0.0
        for s in range(6):
            along = motion.jacobian[c, s, j]
            if along != 0:
                for r in range(6):
                    column[r] += X[r, s] * along
        for i in range(bodies.axes[b]):
            total = 0.0
            for r in range(6):
                total += motion.jacobian[b, r, i] * column[r]
            M[bodies.coordinate[b, i], bodies.coordinate[c, j]] += total


@kernel
def project_active(bodies: Bodies, motion: Motion, X: np.ndarray, M: np.ndarray) -> None:
    """M (nz, nz) = Jᵀ X J for X (nb nr, nb nr) over the active DOF of all bodies."""
    nr = bodies.active.size
    M[:] = 0.0
    block, column = np.zeros((6, 6)), np.empty(6)
    for b in range(bodies.axes.size):
        for c in range(bodies.axes.size):
            for r in range(nr):
                for s in range(nr):
                    block[bodies.active[r], bodies.active[s]] = X[b * nr + r, c * nr + s]
            _project(bodies, motion, b, c, block, column, M)


@part_kernel
def stored_energy(bodies: Bodies, zone: np.ndarray, z: np.ndarray, dz: np.ndarray, motion: Motion) -> float:
    """Kinetic (added mass included), gravitational and spring energy [J]; zone (2, nz) of the joints' laws."""
    energy = 0.0
    for b in range(bodies.axes.size):
        R, v, m = motion.rotation[b], motion.velocity[b], bodies.mass[b]
        x, y, up = rotated(R, bodies.cog[b])
        ux, uy, uz = cross(v[3], v[4], v[5], x, y, up)
        p = into(R, v[3], v[4], v[5])
        h = rotated(bodies.inertia[b], p)
        energy += 0.5 * m * ((v[0] + ux) ** 2 + (v[1] + uy) ** 2 + (v[2] + uz) ** 2)
        energy += 0.5 * (p[0] * h[0] + p[1] * h[1] + p[2] * h[2])
        energy += m * bodies.gravity * (motion.position[b, 2] + up)
    v = motion.active_velocity
    for i in range(v.size):
        for j in range(v.size):
            energy += 0.5 * v[i] * bodies.added_mass[i, j] * v[j]
    for i in range(z.size):
        energy += axis_energy(bodies.law, i, zone[STOP_ZONE, i], z[i]) + 0.5 * bodies.mechanism[i] * dz[i] * dz[i]
    return energy + coupled_energy(bodies.law, z)
