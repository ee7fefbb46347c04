"""What a frame's elements do to its motion and its forces, by the linear response of one with twice as many.

Loads between nodes act in full on the nodes and, by `structure.influence`, on sections; what is left out is the motion
within an element against its ends, and so that motion's inertia: of fourth order in the element's length. Of tapered
members each element has the section of its middle, which errs in second order, see `structure.fineness`.
"""

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from solver.coupled.histories import driven, moved
from solver.coupled.places import REACTIONS
from solver.coupled.preparation import prepare
from solver.coupled.support import Support
from solver.coupled.system import System
from solver.hydrodynamics.bem.coefficients import Hydrodynamics
from solver.record.response import carried, in_waves
from solver.record.steel import Steel
from solver.scene import Scene, Settings
from solver.structure import modes as natural

FINE = 1e-5  # elements that leave out less of a mode's energy are not looked at again
SMALL = 0.1  # of the largest std of its kind: what is less is not judged
SUMS = "base_shear", "overturning_moment"


def elements_effect(
    scene: Scene, h: Hydrodynamics | None, support: Support | None, system: System | None = None
) -> float:
    """Relative error of any std of the legs' tops, feet and of the whole's forces, with load histories of any rms, too.

    Of what is fine at most FINE. support: of the scene; system: the scene's, where there is one that has its dampers,
    as with load histories.
    """
    waves = np.abs(scene.sea.amplitude) > 0
    pushed = system is not None and bool(system.histories)
    if scene.platform is None or support is None or not (waves.any() or pushed):
        return 0.0
    swung = moved(system).swung if system is not None and pushed else np.zeros(0)
    fastest = max([*scene.sea.omega[waves], *swung], default=0.0)
    still, moving, taper = support.within
    rough = float(still + moving * fastest**2 + taper)
    if rough < FINE:
        return rough
    system = prepare(scene, h) if system is None else system
    asked = tuple(name for name in scene.settings.outputs if name == REACTIONS)
    cut, modes = scene.platform.cut(2), scene.settings.modes
    if modes == "all" and cut.frame.freedoms > natural.MOST:
        modes = natural.MANY
    settings = replace(scene.settings, time_step=system.dt, outputs=asked, modes=modes)
    finer = prepare(replace(scene, platform=cut, settings=settings), h, system.fit)
    usual, exact = (np.array([*_of_modes(item), *_stds(item, h, settings)]) for item in (system, finer))
    used = (usual > 0) & (exact > 0)
    order = 2 if taper > 0 else 4
    return float(np.abs(usual[used] / exact[used] - 1).max(initial=0.0)) / (1 - 0.5**order)


def _of_modes(system: System) -> Iterator[float]:
    """Size of all that moves the frame, where load histories do: the root of twice its mean strain energy."""
    if system.histories:
        yield moved(system).whole


def _stds(system: System, h: Hydrodynamics | None, settings: Settings) -> Iterator[float]:
    """Of each leg's top and foot, and of the whole's forces where settings ask; 0 of what is faint beside its like.

    With load histories also their rms, under weight, constant loads and the histories' means.
    """
    support, parts = system.support, [_in_waves(system, h)]
    assert support is not None, "asked of scenes with a platform"
    if system.histories:
        parts.append(_by_histories(system))
    P, y = (np.concatenate(each) for each in zip(*parts, strict=True))
    kinds: list[np.ndarray] = []
    if support.legs is not None:
        kinds.append(np.tensordot(P, support.legs.tops, axes=1))
    if support.forces is not None:
        steel = Steel(support.forces, settings)
        if support.legs is not None:
            kinds.append(steel.every_fibre(y).reshape(len(y), -1, 1))
        kinds += [values[:, None] for name, values in steel.channels(y) if name in SUMS]
    if system.histories:  # along each axis by itself, without the means and with them
        kinds = [lines.reshape(len(y), -1, 1)[some] for lines in kinds for some in (slice(-1), slice(None))]
    for lines in kinds:
        size = np.sqrt(np.nansum(np.abs(lines) ** 2, axis=(0, 2)))
        yield from np.where(size > SMALL * size.max(), size, 0.0)


def _in_waves(system: System, h: Hydrodynamics | None) -> tuple[np.ndarray, np.ndarray]:
    """Lines of the modes (nw, nm) and of the frame's forces (nw, ny)."""
    support, omega = system.support, system.scene.sea.omega[:, None]
    assert support is not None, "asked of scenes with a platform"
    X, drag, _ = in_waves(system, h)
    P, forces = X[:, : support.omega.size], support.forces
    if forces is None:
        return P, P[:, :0]
    rate, borne = -1j * omega, carried(system, h, X)
    x = system.rows[system.layout.forces].T + forces.of_motion(rate * P, rate**2 * P, borne)
    return P, forces.whole(x + drag @ forces.drag)


def _by_histories(system: System) -> tuple[np.ndarray, np.ndarray]:
    """The same by load histories, as if no float hung on the frame: the last has means, of forces those at rest, too.

    In a line's measure, whose square is twice its variance.
    """
    support, (force, p, dp, ddp) = system.support, driven(system)
    assert support is not None, "asked of scenes with a platform"
    y, forces = p[:, :0], support.forces
    if forces is not None:
        still = np.zeros((len(p), len(support.carrier)))
        y = forces.whole(force @ forces.applied + forces.of_motion(dp, ddp, still))
        y[0] += forces.at_rest
    return np.sqrt(2) * p[::-1], np.sqrt(2) * y[::-1]
