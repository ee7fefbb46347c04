"""Constants of a chain of bodies, and what is reckoned of them at an instant."""

from typing import NamedTuple

import numpy as np

from solver.catenary import Lines
from solver.hydrodynamics.pressure.quadrature import QuadratureRoom, WettedQuadrature, quadrature_room
from solver.hydrodynamics.pressure.wetted_panels import PanelsRoom, WettedPanels, panels_room
from solver.kernels import kernel
from solver.multibody.joint_law import JointLaw


class Bodies(NamedTuple):
    """All floats as arrays; nb floats, n axes at most, nr active hydrodynamic DOF of each."""

    kind: np.ndarray  # (nb, n) axes, see chain
    direction: np.ndarray  # (nb, n, 3)
    point: np.ndarray  # (nb, n, 3)
    coordinate: np.ndarray  # (nb, n) index into z
    axes: np.ndarray  # (nb,) number of axes
    reference: np.ndarray  # (nb, 3) reference points where floats are given
    about: np.ndarray  # (nb, 3) what the series of the wave field around each is about, in still water
    mass: np.ndarray  # (nb,)
    cog: np.ndarray  # (nb, 3) from the reference point
    inertia: np.ndarray  # (nb, 3, 3) about the c.o.g., body frame
    nonlinear: np.ndarray  # (nb,) pressure by quadrature, else linear hydrostatics
    first_term: np.ndarray  # (nb + 1,) of each in the series of the wave field around all of them
    surface_terms: np.ndarray  # (nb,) of the elevation across each
    first_along: np.ndarray  # (nb + 1,) of each in the series of linear wave loads over its place along the waves
    leader: np.ndarray  # (nb,) the float whose place that is
    reach: np.ndarray  # (nb,) [m] to either side, of that series
    meshed: np.ndarray  # (nb,) hulls that are panel meshes, not of revolution
    rule: WettedQuadrature  # patch (nb, np, 7) stacked
    patches: np.ndarray  # (nb,)
    panels: WettedPanels  # of the hulls that are meshes
    buoyancy: np.ndarray  # (nb, 6) hydrostatic load at rest (linear floats)
    stiffness: np.ndarray  # (nb, 6, 6) hydrostatic stiffness about the reference point
    wave_direction: np.ndarray  # (2,)
    rho_g: float
    gravity: float
    depth: float
    wheeler: bool
    active: np.ndarray  # (nr,) which of the six DOF radiate
    added_mass: np.ndarray  # (nb nr, nb nr) at infinite frequency
    turning: bool  # it, the memory and the linear wave loads keep to the bodies' axes, not to those of space
    law: JointLaw  # of the nz axes; nothing on carriers
    mechanism: np.ndarray  # (nz,) inertia on the axes besides the floats'
    limit: np.ndarray  # (nz, 2) excursions beyond which the run stops, see solver.limits
    lines: Lines  # of moorings
    pulled: np.ndarray  # (nb, 6, 6) stiffness of the lines about the reference point, at rest


class Motion(NamedTuple):
    """Kinematics of all bodies at one instant."""

    position: np.ndarray  # (nb, 3)
    rotation: np.ndarray  # (nb, 3, 3)
    jacobian: np.ndarray  # (nb, 6, n)
    velocity: np.ndarray  # (nb, 6)
    bias: np.ndarray  # (nb, 6)
    acceleration: np.ndarray  # (2nb, 6), then along the bodies' axes, if what radiates turns: one array more is slower
    active_velocity: np.ndarray  # (nb nr,) along the axes of radiation
    scratch: np.ndarray  # (8, 6)


class Coordinates(NamedTuple):
    """All coordinates at one instant."""

    z: np.ndarray  # (nz,)
    dz: np.ndarray  # (nz,)
    ddz: np.ndarray  # (nz,)
    zone: np.ndarray  # (2, nz) of the joints' laws


class WaterLoads(NamedTuple):
    """Loads of the water on the bodies, without added mass."""

    pressure: np.ndarray  # (nb, 6) as it was at coordinates smaller by `since`
    since: np.ndarray  # (nz,) the stiffness of buoyancy and lines stands for that change
    excitation: np.ndarray  # (nb, 6) linear wave loads
    memory: np.ndarray  # (nb nr,) of the radiation, against the motion


class Loads(NamedTuple):
    """The equations of motion at one instant."""

    residual: np.ndarray  # (nz,) JᵀW
    wrench: np.ndarray  # (nb, 6) W, all loads on each body, inertia included
    external: np.ndarray  # (nb, 6) its part of excitation, pressure and lines


class PressureRoom(NamedTuple):
    """Scratch of the pressure integrals, most of it: a kernel that allocates is slower."""

    quadrature: QuadratureRoom
    panels: PanelsRoom


def pressure_room(bodies: Bodies) -> PressureRoom:
    """Scratch for the hulls of these bodies."""
    return PressureRoom(quadrature_room(bodies.rule), panels_room(bodies.panels))


@kernel
def new_motion(bodies: Bodies) -> Motion:
    """Zeros for these bodies, to be filled by `move`."""
    nb, n = bodies.kind.shape
    return Motion(
        np.zeros((nb, 3)),
        np.zeros((nb, 3, 3)),
        np.zeros((nb, 6, n)),
        np.zeros((nb, 6)),
        np.zeros((nb, 6)),
        np.zeros((2 * nb, 6)),
        np.zeros(nb * bodies.active.size),
        np.zeros((8, 6)),
    )
