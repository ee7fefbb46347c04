"""Where a scene does not rest in still water, for that to be told before boundary elements are solved."""

from dataclasses import replace

from solver.coupled.boundary import coefficients, needed
from solver.coupled.natural import require_stable, require_upright
from solver.coupled.preparation import prepare
from solver.errors import InputError, SimulationFailed
from solver.hydrodynamics.bem.coefficients import Hydrodynamics
from solver.scene import Scene
from solver.sea.realization import CALM


def statics(scene: Scene, known: Hydrodynamics | None = None) -> str:
    """Why a run of the scene will end where it begins, in that run's words; empty where it does not.

    Without waves and flow nothing is solved for. known: coefficients from elsewhere, whose hydrostatics may be others.
    """
    s = scene.settings
    outputs = tuple(name for name in s.outputs if name != "drift")  # which asks for flow
    still = replace(s, radiation=False, diffraction=False, outputs=outputs)
    calm = replace(scene, sea=replace(CALM, heading=scene.sea.heading), settings=still)
    try:
        system = prepare(calm, coefficients(calm) if known is None and needed(calm) else known)
        require_stable(system)
        if s.method == "time":  # else nothing is let go
            require_upright(system)
    except (InputError, SimulationFailed) as error:
        return str(error)
    return ""
