"""Loads on the floats of the reference path: pressure, linear wave loads, memory, and the joints' own."""

from typing import Literal

import numpy as np

from solver.errors import InputError
from solver.hydrodynamics.coefficients import DOFS, Hydrodynamics
from solver.hydrodynamics.convolution import Convolution, Kernel
from solver.hydrodynamics.froude_krylov import pressure_load, quadrature
from solver.hydrodynamics.panel_hull import PanelHull
from solver.hydrodynamics.panels import Mesh, Waves, panel_load, revolution_mesh, waves_at
from solver.hydrodynamics.surface import split
from solver.hydrodynamics.wetted_panels import WettedPanels, longest_side, panels_pressure, wetted_panels
from solver.multibody.joints import GROUND, Frames
from solver.scene import Float, Scene
from solver.sea.field import WaveField
from solver.sea.realization import ramp

TERMS = 32  # of the local wave field, for pressure by quadrature: rounding for every hull that is small for its waves
Pressure = Literal["panels", "quadrature"]


class PressureForce:
    """Hydrostatic and Froude-Krylov load on all floats, by panels, by quadrature, or linear hydrostatics."""

    def __init__(self, scene: Scene, field: WaveField, kind: Pressure, panels: tuple[int, int], coefficients):
        self.scene, self.field, self.kind = scene, field, kind
        self.linear = scene.settings.froude_krylov != "body-nonlinear"
        self.coefficients = coefficients
        s, along, around = scene.settings, *panels
        if kind == "panels":
            self.meshes = [self._mesh(f, along, around) for f in scene.floats]
        else:
            sizes = {"azimuths": s.azimuths, "arc_points": s.arc_points, "line_points": s.line_points}
            self.rules = [
                wetted_panels([f.hull], [self._side(f)], half=False, surface_terms=TERMS)
                if isinstance(f.hull, PanelHull)
                else quadrature(f.hull, **sizes, half=scene.planar)
                for f in scene.floats
            ]
            self.rows = [field.local_pressure(f.centre, TERMS) for f in scene.floats]

    def _side(self, item: Float) -> float:
        # Half the production path's: a reference is finer.
        return longest_side(item.hull, self.scene.settings.panel_size / 2, self.field)

    def _mesh(self, item: Float, along: int, around: int) -> Mesh:
        if not isinstance(item.hull, PanelHull):
            return revolution_mesh(item.hull, along=along, around=around)
        panels = split(item.hull.panels, self._side(item))
        return Mesh(panels.reshape(-1, 3), np.arange(4 * len(panels)).reshape(-1, 4))

    def at(self, t: float, factor: float):
        """Load (6,) of float b at a position and rotation, at time t under a ramp's factor."""
        scene, sea, water = self.scene, self.scene.sea, self.scene.water
        rho_g, wheeler = water.density * water.gravity, scene.settings.pressure == "wheeler"
        direction = self.field.direction[:2].copy()
        if self.kind == "panels":
            waves = waves_at(
                self.field.k, sea.omega, sea.amplitude, depth=water.depth, heading=sea.heading, t=t, factor=factor
            )
            if not sea.amplitude.any() or factor == 0:
                waves = Waves(np.zeros(0), np.zeros(0, complex), direction, water.depth)
        else:
            turn = factor * np.exp(-1j * sea.omega * t)
            local = [np.ascontiguousarray((rows * turn).sum(axis=-1).real) for rows in self.rows]

        def load(b, position, rotation):
            out = np.zeros(6)
            if self.linear:
                return self._linear(b, position, rotation)
            if self.kind == "panels":
                panel_load(position, rotation, self.meshes[b], waves, rho_g, wheeler, out)
            elif isinstance(self.rules[b], WettedPanels):
                centre, rule = scene.floats[b].centre, self.rules[b]
                panels_pressure(
                    0, position, rotation, rule, local[b], centre, direction, rho_g, wheeler, water.depth, out
                )
            else:
                centre = scene.floats[b].centre
                pressure_load(
                    position, rotation, self.rules[b], local[b], centre, direction, rho_g, wheeler, water.depth, out
                )
            return out

        return load

    def _linear(self, b, position, rotation):
        """Buoyancy less stiffness times displacement."""
        h, index = self.coefficients, _index(self.coefficients)
        own = slice(b * len(index), (b + 1) * len(index))
        shift = np.array([*(position - self.scene.floats[b].centre), rotation[2, 1], rotation[0, 2], rotation[1, 0]])
        out = np.zeros(6)
        x, y, _ = self.scene.floats[b].hull.buoyancy_point
        out[2:5] = h.displaced_mass[b] * self.scene.water.gravity * np.array([1.0, y, -x])
        out[index] -= h.hydrostatic_stiffness[own, own] @ shift[index]
        return out


def _index(h: Hydrodynamics) -> list[int]:
    return [DOFS.index(d) for d in h.dofs]


def _joint_axis(item: Float) -> tuple[bool, np.ndarray]:
    """Whether the joint turns, and its axis at rest."""
    if item.motion == ("hinge",):
        return True, np.divide(item.axis, np.linalg.norm(item.axis))
    if len(item.motion) == 1 and item.motion[0] in DOFS[:3]:
        return False, np.eye(3)[DOFS.index(item.motion[0])]
    raise InputError(f"floats.{item.name}.motion", item.motion, "the reference path has hinges and single guides")


class Floats:
    """All that loads the floats: see `augmented.Surroundings`."""

    def __init__(self, scene: Scene, h: Hydrodynamics | None, kernel: Kernel | None, force, support, *, dt, c, steps):
        self.scene, self.pressure, self.support = scene, force, support
        self.axes = [_joint_axis(f) for f in scene.floats]
        self.c, self.dt, nb = c, dt, len(scene.floats)
        self.active = np.array([6 * b + i for b in range(nb) for i in (_index(h) if h else ())], int)
        self.convolution = Convolution(kernel, dt=dt, c=c, steps=steps) if kernel else None
        self.velocity = np.zeros((len(c), self.active.size))
        self.rows = np.zeros((6 * nb, scene.sea.omega.size), complex)
        if h:
            self.rows[self.active] = _excitation(scene, h)

    def begin(self, t, dt, state):
        self.velocity[:] = state.velocity.ravel()[self.active]
        s = self.scene.settings
        times = t + self.c * dt
        factors = ramp(times, s.ramp, s.ramp_form)
        self.fields = [self.pressure.at(at, f) for at, f in zip(times, factors, strict=True)]
        turn = np.exp(-1j * np.multiply.outer(self.scene.sea.omega, times)) * factors
        self.excitation = (self.rows @ turn).real.T
        self.support.begin(times, turn)

    def iterate(self):
        self.support.iterate()

    def supports(self, stage, _t):
        return self.support.frames(stage)

    def loads(self, stage, _t, frames):
        nb = len(self.scene.floats)
        self.velocity[stage] = frames.velocity[:nb].ravel()[self.active]
        load = self.excitation[stage].copy()
        if self.convolution:
            load[self.active] -= self.convolution.load(stage, self.velocity)
        load = load.reshape(nb, 6)
        self.reaction = np.zeros((nb, 6))
        for b in range(nb):
            load[b] += self.fields[stage](b, frames.position[b], frames.rotation[b])
            self._joint_load(b, frames, load)
        return load

    def _joint_load(self, b, frames, load):
        """PTO, damping and spring along or about the joint's axis, and their reaction on the support."""
        item, (turns, axis) = self.scene.floats[b], self.axes[b]
        s = self.support.number(b)
        axis = frames.rotation[s] @ axis
        value, rate = self.coordinate(b, frames), self._rate(b, frames, axis)
        pto, damping, quadratic, spring = (
            item.per_axis(n)[0] for n in ("pto_damping", "damping", "quadratic_damping", "stiffness")
        )
        size = -(pto + damping + quadratic * abs(rate)) * rate - spring * value
        if turns:
            load[b, 3:] += size * axis
            self.reaction[b, 3:] = -size * axis
            return
        load[b, :3] += size * axis
        lever = frames.position[b] - frames.position[s]
        self.reaction[b] = -size * np.concatenate([axis, np.cross(lever, axis)])

    def _rate(self, b, frames, axis):
        own, other = frames.velocity[b], frames.velocity[self.support.number(b)]
        if self.axes[b][0]:
            return axis @ (own[3:] - other[3:])
        lever = frames.position[b] - frames.position[self.support.number(b)]
        return axis @ (own[:3] - other[:3] - np.cross(other[3:], lever))

    def coordinate(self, b: int, frames: Frames) -> float:
        """The joint's angle [rad] or way [m] from the drawn position."""
        turns, axis = self.axes[b]
        s = self.support.number(b)
        R = frames.rotation[s].T @ frames.rotation[b]
        if turns:
            skew = np.array([R[2, 1] - R[1, 2], R[0, 2] - R[2, 0], R[1, 0] - R[0, 1]])
            return float(np.arctan2(axis @ skew, np.trace(R) - 1))
        item = self.scene.floats[b]
        at_rest = np.zeros(3) if s == GROUND else np.array(item.hinge)
        way = frames.rotation[s].T @ (frames.position[b] - frames.position[s])
        return float(axis @ (way - (item.centre - at_rest)))

    def carried(self, stage, frames, load):
        self.support.carried(stage, frames, load, self.reaction)

    def finish(self):
        if self.convolution:
            self.convolution.remember(self.velocity)
        self.support.finish()


def _excitation(scene: Scene, h: Hydrodynamics) -> np.ndarray:
    """Linear wave loads (nb nr, n) [N] of all components: diffraction, and Froude-Krylov of linear floats."""
    s, total = scene.settings, np.zeros((scene.sea.omega.size, len(scene.floats) * len(h.dofs)), complex)
    if s.diffraction:
        total += h.excitation(scene.sea.omega, "diffraction")
    if s.froude_krylov == "linear":
        total += h.excitation(scene.sea.omega, "froude_krylov")
    return (total * scene.sea.amplitude[:, None]).T
