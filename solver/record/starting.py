"""How much a record in a random sea lacks of a lasting sea's motions, for it began at rest.

A shape of unit inertia whose resonance is among the waves and that is damped by B has, a time t after waves have set
in, 1 - exp(-Bt) of the variance that it will have. A record from t₁ on, of duration T, so lacks on average

    exp(-Bt₁) (1 - exp(-BT))/(BT)

of what resonates; less where damping is quadratic, and so less at first. In one wave the record tells by itself: see
settling.
"""

from collections.abc import Iterator

import numpy as np

from solver.coupled.linear import linear_model
from solver.coupled.natural import system_modes
from solver.coupled.system import System
from solver.hydrodynamics.bem.coefficients import Hydrodynamics
from solver.record.response import in_waves
from solver.record.sampling import least_motion
from solver.record.slow import radiating, unradiated
from solver.statistics import FAINT

LACKS = 0.05  # of a std: what is said
WELL = 0.01  # of it: what the discard leaves that is told
WIDTHS = 2.0  # of a resonance, B, to either side, which have 84 % of it


def from_rest(system: System, h: Hydrodynamics | None) -> Iterator[str]:
    """A sentence for the shape by which any coordinate's std lacks most, if that is more than LACKS."""
    s, sea = system.scene.settings, system.scene.sea
    met = sea.amplitude != 0
    modes = system_modes(system, h)
    inside = (modes.omega > sea.omega[met].min(initial=np.inf)) & (modes.omega < sea.omega[met].max(initial=0.0))
    if not inside.any():
        return
    own, shapes = modes.omega[inside], modes.shapes[:, inside].T
    B = unradiated(system, h, shapes) + radiating(system, h, own, shapes)[1]
    lasts, since = np.maximum(B * s.duration, 1e-9), max(s.discard - s.ramp, 0.0)
    lacking = np.exp(-B * since) * -np.expm1(-lasts) / lasts
    if not np.any(lacking > LACKS):
        return
    size = np.abs(in_waves(system, h).X) ** 2
    total = size.sum(axis=0)
    moves = linear_model(system).length * np.sqrt(total)
    used = moves > max(FAINT * moves.max(), least_motion(system.scene))
    near = np.abs(sea.omega - own[:, None]) <= WIDTHS * B[:, None]
    lost = lacking * np.max((near @ size)[:, used] / total[used], axis=1, initial=0.0)
    k = int(lost.argmax())
    std = 1 - np.sqrt(1 - lost[k])
    if std > LACKS:
        enough = s.ramp + since + np.log(lost[k] / (2 * WELL)) / B[k]
        name = [name for name, here in zip(modes.names, inside, strict=True) if here][k]
        yield (
            f"{name}, {2 * np.pi / own[k]:.3g} s, begins at rest and takes {1 / B[k]:.2g} s to swing as it will in"
            f" these waves: a std is some {std:.0%} below a lasting sea's; discard = {enough:.2g} leaves {WELL:.0%}"
        )
