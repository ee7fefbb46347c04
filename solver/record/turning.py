"""How much a float's own turning changes its added inertia: added mass keeps its directions, as loads at rest do."""

from collections.abc import Iterator, Mapping

import numpy as np

from solver.coupled.linear import jacobian, linear_model
from solver.coupled.system import System
from solver.record.channels import Channels
from solver.scene import DOFS
from solver.statistics import STATISTICS, of_joints

CHANGES = 0.02  # of the inertia about an axis, at one standard deviation to either side


def turning(system: System, channels: Channels, tables: Mapping[str, np.ndarray]) -> Iterator[str]:
    """A sentence for each axis about which (Jᵀ A∞ J)ᵢᵢ, on average one standard deviation off, is another by CHANGES.

    A body's own added mass turns with it. tables: statistics of the motions.
    """
    (body, _, rest), model = system.resting.value, linear_model(system)
    if not channels.axes or not system.scene.settings.radiation or system.bodies.turning:
        return
    std, first = of_joints(tables)[..., STATISTICS.index("std")], rest.size - len(channels.names)
    for j, (b, axis) in enumerate(zip(channels.owner, channels.names, strict=True)):
        size = std[b, channels.axes.index(axis)]
        if axis in DOFS[:3] or not np.isfinite(size):
            continue
        step = size * np.eye(rest.size)[first + j]
        J = jacobian(body, rest + np.array([[0.0], [1.0], [-1.0]]) * step)[:, :, body.active]
        lever = J.reshape(3, -1, rest.size)[:, :, first + j]
        still, up, down = np.einsum("mi,ij,mj->m", lever, system.bodies.added_mass, lever)
        change = (0.5 * (up + down) - still) / model.mass[j - len(channels.names), j - len(channels.names)]
        if abs(change) > CHANGES:
            yield (
                f"floats.{system.scene.floats[b].name}: at the std of its {axis}, {size:.2g} rad, added mass that keeps"
                f" its directions changes the inertia about that axis by {change:+.1%}, which that of a body which"
                " turns does not: natural periods move, and with them what waves near those do; no part of the"
                ' estimated error, hydrodynamic_axes = "body" turns it'
            )
