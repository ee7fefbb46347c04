"""Loads on the floats of the reference path: pressure, linear wave loads, memory, and the joints' loads."""

from collections.abc import Callable
from functools import lru_cache
from typing import Literal

import numpy as np
from scipy.linalg import block_diag
from scipy.spatial.transform import Rotation

from solver.coupled.assembly import joint_law
from solver.coupled.energy import JOINT_DAMPING, PTO, RADIATION, WAVE, WORKS
from solver.coupled.preparation import around
from solver.coupled.sliding import leaders
from solver.errors import InputError
from solver.hydrodynamics.bem.coefficients import DOFS, Hydrodynamics
from solver.hydrodynamics.hull.mesh import Hull
from solver.hydrodynamics.hull.panel_hull import PanelHull
from solver.hydrodynamics.hull.revolution import Revolution
from solver.hydrodynamics.hull.surface import split
from solver.hydrodynamics.pressure.froude_krylov import Incident, pressure_load
from solver.hydrodynamics.pressure.quadrature import azimuths_for, quadrature, quadrature_room
from solver.hydrodynamics.pressure.wetted_panels import longest_side, panels_pressure, panels_room, wetted_panels
from solver.multibody.of_axes import joint_loads
from solver.reference import axes as joint_axes
from solver.reference.augmented import MechanismState, rotation_of
from solver.reference.axes import Axes, Node
from solver.reference.convolution import Convolution, Kernel
from solver.reference.elastic import ElasticSupport, FixedSupport
from solver.reference.joints import GROUND, Frames
from solver.reference.panels import Mesh, calm, half, panel_load, revolution_mesh, waves_at
from solver.scene import Float, Scene
from solver.sea.field import WaveField
from solver.sea.realization import ramp

# Load (6,) of float b with its reference point at a position (3,) and in a rotation (3, 3).
PressureOf = Callable[[int, np.ndarray, np.ndarray], np.ndarray]
# Adds the pressure load of a hull with its reference point at a position (3,), in a rotation (3, 3), to (6,).
Quadrature = Callable[[np.ndarray, np.ndarray, Incident, np.ndarray], None]
ROUNDING = 1e-6  # of an angle [rad]: below it its square is none beside 1
SWINGS = 20  # rounds in which the place that swings are of is found
TERMS = 32  # of the local wave field, for pressure by quadrature: rounding for every hull that is small for its waves,
LARGE = 2.0, 1e-9  # more for others, by so many sizes of the hull about where it rests, and so much of Σ|a|
Surface = Literal["panels", "quadrature"]
IN_PLANE = np.array([2.0, 0.0, 2.0, 0.0, 2.0, 0.0])  # load of a hull from that of its half


class PressureForce:
    """Hydrostatic and Froude-Krylov load on all floats, by panels, by quadrature, or linear hydrostatics."""

    def __init__(
        self,
        scene: Scene,
        field: WaveField,
        kind: Surface,
        panels: tuple[int, int],
        coefficients: Hydrodynamics | None,
        about: np.ndarray | None = None,
    ) -> None:
        """about (nb, 3): places of the waves' series, where floats are given unless otherwise said."""
        self.about = np.array([f.centre for f in scene.floats]) if about is None else about
        self.scene, self.field, self.kind = scene, field, kind
        self.linear = scene.settings.froude_krylov != "body-nonlinear"
        self.coefficients = coefficients
        if kind == "panels" and not self.linear:
            self.meshes = [self._mesh(f.hull, panels) for f in scene.floats]
        elif not self.linear:
            self.quadratures = [self._quadrature(f.hull) for f in scene.floats]
            self.terms = [max(TERMS, field.terms_for(self._reach(f.hull), LARGE[1])) for f in scene.floats]
            self.rows = [field.local_pressure(x, n) for x, n in zip(self.about, self.terms, strict=True)]

    def _reach(self, hull: Hull) -> float:
        """How far about rest a series is to hold [m]: where the waves are too short for that, as far as floats get."""
        reach, left = LARGE[0] * hull.size, LARGE[1]
        return reach if self.field.near(reach, left) == self.field else around(self.scene, self.field)[1]

    def _quadrature(self, hull: Hull) -> Quadrature:
        s = self.scene.settings
        if isinstance(hull, PanelHull):
            panels = wetted_panels([hull], [self._side(hull)], [False])
            pieces = panels_room(panels)
            return lambda x, R, waves, load: panels_pressure(0, x, R, panels, waves, pieces, load)
        length = self.field.mean_length
        azimuths = azimuths_for([hull], s.azimuths, length)
        points = {"azimuths": azimuths, "arc_points": s.arc_points, "line_points": s.line_points}
        rule = quadrature(hull, **points, half=self.scene.planar, mean_length=length)
        room = quadrature_room(rule)
        return lambda x, R, waves, load: pressure_load(x, R, rule, waves, room, load)

    def _side(self, hull: PanelHull) -> float:
        # Half the production path's: a reference is finer.
        return longest_side(hull, self.scene.settings.panel_size / 2, self.field)

    def _mesh(self, hull: Hull, panels: tuple[int, int]) -> tuple[Mesh, np.ndarray]:
        """Panels of a hull, and the factors (6,) of their load."""
        if not isinstance(hull, PanelHull):
            return _revolved(hull, panels, self.scene.planar)
        pieces = split(hull.panels, self._side(hull))
        return Mesh(pieces.reshape(-1, 3), np.arange(4 * len(pieces)).reshape(-1, 4)), np.ones(6)

    def at(self, t: float, factor: float) -> PressureOf:
        """Load (6,) of float b at a position and rotation, at time t under a ramp's factor."""
        if self.linear:
            return self._linear
        return self._by_panels(t, factor) if self.kind == "panels" else self._by_quadrature(t, factor)

    def _by_panels(self, t: float, factor: float) -> PressureOf:
        scene, sea, water = self.scene, self.scene.sea, self.scene.water
        rho_g, wheeler = water.density * water.gravity, scene.settings.pressure == "wheeler"
        waves = calm(self.field.direction[:2], water.depth)
        if sea.amplitude.any() and factor != 0:
            waves = waves_at(
                self.field.k, sea.omega, sea.amplitude, depth=water.depth, heading=sea.heading, t=t, factor=factor
            )

        def load(b: int, position: np.ndarray, rotation: np.ndarray) -> np.ndarray:
            mesh, share = self.meshes[b]
            out = np.zeros(6)
            panel_load(position, rotation, mesh, waves, rho_g, wheeler, out)
            return out * share

        return load

    def _by_quadrature(self, t: float, factor: float) -> PressureOf:
        scene, sea, water = self.scene, self.scene.sea, self.scene.water
        rho_g, wheeler = water.density * water.gravity, scene.settings.pressure == "wheeler"
        turn, direction = factor * np.exp(-1j * sea.omega * t), self.field.direction[:2].copy()
        local = [np.ascontiguousarray((rows * turn).sum(axis=-1).real) for rows in self.rows]

        def load(b: int, position: np.ndarray, rotation: np.ndarray) -> np.ndarray:
            out = np.zeros(6)
            real, imag = local[b]
            waves = Incident(real, imag, self.terms[b], self.about[b], direction, rho_g, wheeler, water.depth)
            self.quadratures[b](position, rotation, waves, out)
            return out

        return load

    def _linear(self, b: int, position: np.ndarray, rotation: np.ndarray) -> np.ndarray:
        """-∂U/∂x and J⁻ᵀ(-∂U/∂θ), U = ξᵀKξ/2 - bᵀξ of x - x₀ and the rotation vector θ, dφ = J dθ about space's axes.

        b: buoyancy ρgV at (x_b, y_b) at rest; what of the stiffness is not symmetric it makes, by J.
        """
        assert self.coefficients is not None  # linear hydrostatics are among them
        h, index = self.coefficients, _index(self.coefficients)
        block = slice(b * len(index), (b + 1) * len(index))
        turned = Rotation.from_matrix(rotation).as_rotvec()
        shift = np.concatenate([position - self.scene.floats[b].centre, turned])
        out = np.zeros(6)
        x, y, _ = self.scene.floats[b].hull.buoyancy_point
        out[2:5] = h.displaced_mass[b] * self.scene.water.gravity * np.array([1.0, y, -x])
        K = h.hydrostatic_stiffness[block, block]
        out[index] -= (K + K.T) / 2 @ shift[index]
        angle, S = max(float(np.linalg.norm(turned)), ROUNDING), np.cross(np.eye(3), turned)
        J = np.eye(3) + (1 - np.cos(angle)) / angle**2 * S + (1 - np.sin(angle) / angle) / angle**2 * S @ S
        out[3:] = np.linalg.solve(J.T, out[3:])
        return out


@lru_cache(maxsize=8)
def _revolved(hull: Revolution, panels: tuple[int, int], planar: bool) -> tuple[Mesh, np.ndarray]:
    """A hull's panels and the factors (6,) of their load; in a planar scene one half, if no panel crosses y = 0."""
    whole = revolution_mesh(hull, along=panels[0], around=panels[1])
    part = half(whole) if planar else None
    return (whole, np.ones(6)) if part is None else (part, IN_PLANE)


def _index(h: Hydrodynamics) -> list[int]:
    return [DOFS.index(d) for d in h.dofs]


def axes_of(item: Float) -> Axes:
    """The joint's axes in order from the support."""
    turns, direction = [], []
    for name in item.motion:
        number = 3 if name == "hinge" else DOFS.index(name)
        turns.append(number >= 3)
        direction.append(np.divide(item.axis, np.linalg.norm(item.axis)) if name == "hinge" else np.eye(3)[number % 3])
    return Axes(np.array(turns), np.array(direction, float), np.array(item.arm, float))


def held(item: Float) -> tuple[list[np.ndarray], list[np.ndarray], bool]:
    """Slides, turns, and whether the slides move with the body: what the constraints need to know of the axes.

    The order of axes counts where a turn comes before a slide and does not leave the slides' space as it is.
    """
    a = axes_of(item)
    slides, turns = a.direction[~a.turns], a.direction[a.turns]
    moved = [
        i for i, turn in enumerate(a.turns) if turn and not a.turns[i:].all() and not _keeps(a.direction[i], slides)
    ]
    if not moved:
        return list(slides), list(turns), False
    if a.turns[: a.turns.sum()].all():
        return list(slides), list(turns), True
    raise InputError(
        f"floats.{item.name}.motion", item.motion, "the reference path wants the slides before or after all turns"
    )


def _keeps(turn: np.ndarray, slides: np.ndarray) -> bool:
    """Whether a rotation about `turn` maps the space of the slides on itself."""
    along = np.abs(slides @ turn)
    return len(slides) == 3 or bool(np.all(along < 1e-9) if len(slides) == 2 else np.all(along > 1 - 1e-9))


class Floats:
    """Surroundings of the floats: water, joints and support, and the samples that the record needs."""

    def __init__(
        self,
        scene: Scene,
        h: Hydrodynamics | None,
        kernel: Kernel | None,
        force: PressureForce,
        support: FixedSupport | ElasticSupport,
        *,
        dt: float,
        A: np.ndarray,
        steps: int,
        swing: np.ndarray | None,
    ) -> None:
        """swing (nb, nw) [m]: what each wave swings floats that slide by, along the waves."""
        self.scene, self.pressure, self.support = scene, force, support
        self.axes, self.carriers = [axes_of(f) for f in scene.floats], scene.carriers
        for f in scene.floats:
            if f.on and f.per_axis("mechanism_inertia").any():
                limit = "must be 0 on another float in the reference path"
                raise InputError(f"floats.{f.name}.mechanism_inertia", f.mechanism_inertia, limit)
        self.c, self.weight, self.dt = A.sum(axis=1), A[-1], dt
        nb, stages = len(scene.floats), len(A)
        self.law = [joint_law((f,)) for f in scene.floats]
        self.inertia = [f.per_axis("mechanism_inertia") for f in scene.floats]
        self.active = np.array([6 * b + i for b in range(nb) for i in (_index(h) if h else ())], int)
        self.convolution = Convolution(kernel, dt=dt, c=self.c, steps=steps) if kernel else None
        self.turning = scene.settings.hydrodynamic_axes == "body"
        self.along = np.eye(6 * nb)[:, self.active]
        self.infinite = kernel.added_mass_inf if kernel else np.zeros((self.active.size,) * 2)
        self.velocity = np.zeros((stages, self.active.size))
        self.leaders, self.swing = leaders(scene, force.field), swing
        self.rows = np.zeros((6 * nb, scene.sea.omega.size), complex)
        if h:
            self.rows[self.active] = _excitation(scene, h)
        # Of each stage, [0] the step's start: ways and rates of the joints, forces on the floats, powers.
        self.way = [[np.zeros(len(a.turns)) for a in self.axes] for _ in range(stages)]
        self.rate = [[np.zeros(len(a.turns)) for a in self.axes] for _ in range(stages)]
        # P (n, 6), mechanism's inertia (6, 6) and c (6,), see axes.joint_motion
        self.joint = [[(np.zeros((0, 6)), np.zeros((6, 6)), np.zeros(6))] * nb for _ in range(stages)]
        self.force = np.zeros((stages, nb, 6))
        self.power, self.work = np.zeros((stages, len(WORKS))), np.zeros(len(WORKS))

    def begin(self, t: float, dt: float, state: MechanismState) -> None:
        """Fields and excitation at the step's stages, and the support's share of them; see `Surroundings.begin`."""
        self.velocity[:] = self._axes(rotation_of(state.quaternion)).T @ state.velocity.ravel()
        s = self.scene.settings
        times = t + self.c * dt
        factors = ramp(times, s.ramp, s.ramp_form)
        self.fields = [self.pressure.at(at, f) for at, f in zip(times, factors, strict=True)]
        turn = np.exp(-1j * np.multiply.outer(self.scene.sea.omega, times)) * factors
        self.turn, self.excitation = turn, (self.rows @ turn).real.T
        self.support.begin(times, turn)

    def iterate(self) -> float:
        """The support's iteration; see `Surroundings.iterate`."""
        return self.support.iterate()

    def supports(self, stage: int, _t: float) -> Frames:
        """Frames of the nodes that carry hinges."""
        return self.support.frames(stage)

    def node(self, b: int, frames: Frames) -> Node:
        """The frame that carries float b, at the hinge."""
        hinge, s = np.array(self.scene.floats[b].hinge, float), self.carriers[b]
        if s >= 0:
            return joint_axes.on_body(hinge - self.scene.floats[s].centre, *(x[s] for x in frames))
        s = self.support.frame_number(b)
        position = hinge if s == GROUND else frames.position[s]
        return Node(position, frames.rotation[s], frames.velocity[s], frames.acceleration[s])

    def mechanism_inertia(self, stage: int, frames: Frames) -> np.ndarray | None:
        """Ways and rates of all joints, and the inertia (6 nb, 6 nb) of their mechanisms; None without any."""
        extra = self.added_mass(frames) if self.turning else None
        for b, axes in enumerate(self.axes):
            position, rotation, velocity = frames.position[b], frames.rotation[b], frames.velocity[b]
            start = self.way[stage][b]
            y, dy, P, c = joint_axes.joint_motion(axes, self.node(b, frames), position, rotation, velocity, start)
            self.way[stage][b], self.rate[stage][b] = y, dy
            inertia = self.inertia[b]
            M = (P.T * inertia) @ P
            self.joint[stage][b] = P, M, c
            if inertia.any():
                extra = np.zeros((6 * len(self.axes),) * 2) if extra is None else extra
                extra[6 * b : 6 * b + 6, 6 * b : 6 * b + 6] += M
        return extra

    def added_mass(self, frames: Frames) -> np.ndarray:
        """A∞ (6 nb, 6 nb) along the axes of space."""
        P = self._axes(frames.rotation)
        return np.asarray(P @ self.infinite @ P.T)

    def _axes(self, rotation: np.ndarray) -> np.ndarray:
        """(6 nb, na) unit motions that radiate, along the axes of space."""
        if not self.turning:
            return self.along
        return np.asarray(block_diag(*(R for R in rotation[: len(self.axes)] for _ in range(2))) @ self.along)

    def loads(self, stage: int, _t: float, frames: Frames) -> np.ndarray:
        """Loads (nb, 6) [N, N m] of water and joints, powers on the way; see `Surroundings.loads`."""
        nb = len(self.axes)
        v, P = frames.velocity[:nb], self._axes(frames.rotation)
        self.velocity[stage] = P.T @ v.ravel()
        load = self.excitation[stage].reshape(nb, 6).copy()
        for b in range(nb):
            if self.leaders[b] >= 0 and self.swing is not None:
                load[b] = self._displaced(b, self.leaders[b], stage, frames.position[self.leaders[b]], self.swing)
        load = (P @ load.ravel()[self.active]).reshape(nb, 6)
        for b in range(nb):
            load[b] += self.fields[stage](b, frames.position[b], frames.rotation[b])
        power = self.power[stage]
        power[:] = 0.0
        power[WAVE] = np.sum(load * v)
        if self.convolution:
            memory = self.convolution.load(stage, self.velocity)
            power[RADIATION] = memory @ self.velocity[stage]
            load -= (P @ memory).reshape(nb, 6)
            if self.turning:
                load += self._carried_along(frames)
        for b in range(nb):
            self.force[stage, b] = self._joint_load(b, stage, power)
            _, M, c = self.joint[stage][b]
            load[b] += self.force[stage, b] + M @ c
            if (carrier := self.carriers[b]) >= 0:
                back = _reaction(self.force[stage, b], frames.position[b] - frames.position[carrier])
                load[carrier] += back
                self.force[stage, carrier] += back
        return load

    def _carried_along(self, frames: Frames) -> np.ndarray:
        """-(A∞ V̇ + V ×* A∞ V) (nb, 6) of bodies without acceleration, V along their axes (Kirchhoff's equations).

        v̇ = -ω × v there; V ×* (P, L) = (ω × P, ω × L + v × P).
        """
        nb, R = len(self.axes), frames.rotation[: len(self.axes)]
        v, w = np.einsum("bij,bhi->hbj", R, frames.velocity[:nb].reshape(nb, 2, 3))
        A = self.along @ self.infinite @ self.along.T
        impulse, turned = (A @ np.concatenate(x, axis=1).ravel() for x in ((v, w), (-np.cross(w, v), 0 * w)))
        p, h = impulse.reshape(nb, 2, 3).swapaxes(0, 1)
        load = turned.reshape(nb, 2, 3) + np.stack([np.cross(w, p), np.cross(w, h) + np.cross(v, p)], axis=1)
        return -np.einsum("bij,bhj->bhi", R, load).reshape(nb, 6)

    def _displaced(self, b: int, leader: int, stage: int, position: np.ndarray, swing: np.ndarray) -> np.ndarray:
        """Excitation (6,) of float b with the waves' phases where its leader is, but for what they swing that by."""
        field, turn = self.pressure.field, self.turn[:, stage]
        s = way = (position - self.scene.floats[leader].centre) @ field.direction
        for _ in range(SWINGS):
            s = way - (swing[leader] * np.exp(1j * field.k * s) @ turn).real
        excitation: np.ndarray = (self.rows[6 * b : 6 * b + 6] * np.exp(1j * field.k * s) @ turn).real
        return excitation

    def _joint_load(self, b: int, stage: int, power: np.ndarray) -> np.ndarray:
        """PTO, damping and springs of the axes as a load (6,) on the float."""
        dy = self.rate[stage][b]
        pto, loss, spring = (load[0] for load in joint_loads(self.law[b], self.way[stage][b][None], dy[None]))
        power[PTO] += pto @ dy
        power[JOINT_DAMPING] += loss @ dy
        return -self.joint[stage][b][0].T @ (pto + loss + spring)

    def carried(self, stage: int, frames: Frames, held: np.ndarray, load: np.ndarray) -> None:
        """All that the joints carry, from the constraints' loads on floats, `held` (nb, 6), and on nodes, `load`."""
        reaction = np.zeros_like(held)
        for b in range(len(self.axes)):
            _, M, c = self.joint[stage][b]
            force = self.force[stage, b] - M @ (frames.acceleration[b] - c)
            reaction[b] = _reaction(force, frames.position[b] - self.node(b, frames).position)
            self.force[stage, b] = held[b] + force
        self.support.carried(stage, load, reaction)

    def finish(self) -> None:
        """Work by the collocation's weights; the step's end becomes the next one's start."""
        self.work += self.dt * self.weight @ self.power
        if self.convolution:
            self.convolution.remember(self.velocity)
        self.support.finish()
        self.way[0], self.rate[0], self.joint[0] = list(self.way[-1]), list(self.rate[-1]), list(self.joint[-1])
        for rows in (self.force, self.power):
            rows[0] = rows[-1]


def _reaction(force: np.ndarray, lever: np.ndarray) -> np.ndarray:
    """Minus a load (6,) about a point that lies off its origin by `lever` (3,), about that origin."""
    return -np.concatenate([force[:3], force[3:] + np.cross(lever, force[:3])])


def _excitation(scene: Scene, h: Hydrodynamics) -> np.ndarray:
    """Linear wave loads (nb nr, n) [N] of all components: diffraction, and Froude-Krylov of linear floats.

    Waves of zero height may lie beyond the frequencies solved for.
    """
    s, sea = scene.settings, scene.sea
    total = np.zeros((sea.omega.size, len(scene.floats) * len(h.dofs)), complex)
    if not (met := np.abs(sea.amplitude) > 0).any():
        return total.T
    if s.diffraction:
        total[met] += h.excitation(sea.omega[met], "diffraction")
    if s.froude_krylov == "linear":
        total[met] += h.excitation(sea.omega[met], "froude_krylov")
    return (total * sea.amplitude[:, None]).T
