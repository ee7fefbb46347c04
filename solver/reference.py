"""A scene by the paper's own method: the slow, independent twin of `simulate`.

Augmented floats, panel-wise pressure, direct convolution, every coupling iterated to
convergence. It shares with `simulate` the scene, the BEM's coefficients and the structure's modes,
and nothing of the floats' mechanics, the memory, the pressure integral or the time loop.
"""

from dataclasses import dataclass

import numpy as np
from scipy.optimize import brentq
from scipy.spatial.transform import Rotation

from solver.errors import InputError
from solver.hydrodynamics.coefficients import Hydrodynamics
from solver.hydrodynamics.convolution import CosineTransform, Kernel
from solver.multibody.augmented import NO_SUPPORTS, Body, Errors, lobatto, mechanism
from solver.multibody.elastic import ElasticSupport, FixedSupport
from solver.multibody.joints import Guide, Hinge
from solver.multibody.twoloop import march
from solver.record import leg_response
from solver.reference_loads import Floats, Pressure, PressureForce
from solver.scene import Float, Scene
from solver.sea.field import WaveField
from solver.structure import support as platform


@dataclass(frozen=True, eq=False, kw_only=True)
class Reference:
    """Histories from t = 0, samples as those of `simulate`; signs and units as in its record."""

    time: np.ndarray  # (nt,)
    rotation: np.ndarray  # (nt, nb) joint coordinates [rad or m]
    hinge_force: np.ndarray  # (nt, nb, 3) of the joint on the float [N]
    top_displacement: np.ndarray  # (nt, nl, 3) [m]
    bottom_stress: np.ndarray  # (nt, nl) [Pa]
    errors: Errors  # largest constraint errors


def simulate_reference(
    scene: Scene,
    hydrodynamics: Hydrodynamics | None = None,
    *,
    kernel: Kernel | None = None,
    pressure: Pressure = "panels",
    panels: tuple[int, int] = (71, 120),
    stages: int = 3,
    tolerance: float = 1e-10,
) -> Reference:
    """Run `scene` from t = 0 to discard + duration with its time step, by the paper's method.

    kernel: retardation function, by default the cosine transform of the BEM's damping (eq. 14); a
    RadiationMemory convolves the fitted one. panels: along the meridian and around. stages: 3 for
    the fourth-order collocation, 2 for the trapezoidal rule. tolerance: of the constraints.
    """
    if not scene.floats:
        raise InputError("floats", 0, "the reference path is that of floats: at least one is needed")
    for item in scene.floats:
        if item.per_axis("mechanism_inertia").any():
            key = f"floats.{item.name}.mechanism_inertia"
            raise InputError(key, item.mechanism_inertia, "the reference path knows only the float's own inertia")
    s, water = scene.settings, scene.water
    dt, steps = s.time_step, int(np.ceil((s.discard + s.duration) / s.time_step - 1e-9))
    c, A = lobatto(stages)
    field = WaveField(scene.sea, water.depth, water.gravity)
    if not s.radiation or hydrodynamics is None:
        kernel = None
    elif kernel is None:
        kernel = CosineTransform.of(hydrodynamics)
    force = PressureForce(scene, field, pressure, panels, hydrodynamics)
    support = _support(scene, field, c, A, dt)
    floats = Floats(scene, hydrodynamics, kernel, force, support, dt=dt, c=c, steps=steps)
    system, state = _at_rest(scene, floats, force, support, kernel)
    limits = {"tolerance": tolerance, "still": s.newton_tolerance}
    samples = list(march(system, state, floats, t_end=steps * dt, dt=dt, stages=stages, **limits))
    return _histories(scene, floats, support, samples)


def _at_rest(scene: Scene, floats: Floats, force: PressureForce, support, kernel):
    """Mechanism and state: joints in still-water equilibrium plus their offsets, modes carrying the floats."""
    still, carried, ways = force.at(0.0, 0.0), [], []
    for b, item in enumerate(scene.floats):
        way, load = _equilibrium(item, b, floats.axes[b], still, scene.water.gravity)
        carried.append(load)
        ways.append(way + item.per_axis("offset")[0])
    supports = NO_SUPPORTS
    if scene.platform is not None:
        support.start(np.array(carried)[:, support.axes].ravel())
        supports = support.frames(0)
    bodies, joints = [], []
    for b, item in enumerate(scene.floats):
        turns, axis = floats.axes[b]
        node, R = (np.array(item.hinge), np.eye(3)) if scene.platform is None else (
            supports.position[b], supports.rotation[b])  # fmt: skip
        position, rotation = _pose(item, turns, axis, ways[b])
        bodies.append(
            Body(
                mass=item.mass,
                inertia=item.inertia,
                cog=item.cog,
                position=tuple(node + R @ (position - item.hinge)),
                rotation=tuple(Rotation.from_matrix(R @ rotation).as_quat(scalar_first=True)),
            )
        )
        kind = Hinge if turns else Guide
        joints.append(kind(first=support.number(b), second=b, point=tuple(node), axis=tuple(R @ axis)))
    nb, A = len(scene.floats), None
    if kernel is not None:
        A = np.zeros((6 * nb, 6 * nb))
        A[np.ix_(floats.active, floats.active)] = kernel.added_mass_inf
    return mechanism(bodies, joints, supports, gravity=(0, 0, -scene.water.gravity), added_mass=A)


def _pose(item: Float, turns: bool, axis: np.ndarray, way: float) -> tuple[np.ndarray, np.ndarray]:
    """Position and rotation of a float whose joint has moved by `way` from where it is drawn."""
    if not turns:
        return item.centre + way * axis, np.eye(3)
    R = Rotation.from_rotvec(way * axis).as_matrix()
    return np.asarray(item.hinge) + R @ item.arm, R


def _equilibrium(item: Float, b: int, joint, still, gravity: float) -> tuple[float, np.ndarray]:
    """Joint's way at rest in still water, and the float's load (6,) on the hinge point there."""
    turns, axis = joint
    spring = item.per_axis("stiffness")[0]

    def load(way):
        position, rotation = _pose(item, turns, axis, way)
        total, lever = still(b, position, rotation), rotation @ item.cog
        weight = np.array([0, 0, -item.mass * gravity])
        total[:3] += weight
        total[3:] += np.cross(lever, weight) + np.cross(position - item.hinge, total[:3])
        return total

    part = slice(3, 6) if turns else slice(0, 3)
    way = float(brentq(lambda y: axis @ load(y)[part] - spring * y, -0.5, 0.5, xtol=1e-14))
    return way, load(way)


def _histories(scene, floats, support, samples) -> Reference:
    rotation = [[floats.coordinate(b, s.frames) for b in range(len(scene.floats))] for s in samples]
    top, stress = np.zeros((len(samples), 0, 3)), np.zeros((len(samples), 0))
    if support.history and scene.platform.legs:
        displacement, along = leg_response(support.support.legs, np.array(support.history))
        top, stress = displacement[:, :, -1], along[:, :, 0]
    return Reference(
        time=np.array([s.time for s in samples]),
        rotation=np.array(rotation),
        hinge_force=np.array([s.joint_load[:, :3] for s in samples]),
        top_displacement=top,
        bottom_stress=stress,
        errors=Errors(*np.max([s.errors for s in samples], axis=0)),
    )


def _support(scene: Scene, field: WaveField, c, A, dt) -> FixedSupport | ElasticSupport:
    if scene.platform is None:
        return FixedSupport()
    s, hinges = scene.settings, [scene.platform.hinge_nodes[f.name] for f in scene.floats]
    modes = platform.prepare(
        scene.platform,
        field,
        scene.water,
        hinges,
        planar=scene.planar,
        modes=s.modes,
        stations=s.stations_per_element,
    )
    nodes = np.array([f.hinge for f in scene.floats], float)
    return ElasticSupport(modes, scene.platform.damping_ratio, nodes, c, A, dt)
