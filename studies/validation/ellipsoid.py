"""An ellipsoid in heave, semi-axes 5, 5 and 2.5 m, half submerged, in a wave of 4 m and 6 s: WEC-Sim's question.

Power take-off 1.2 MN s/m, drag coefficient 1 on the waterplane of 78.54 m². Their linear run takes 244 kW; a published
body-nonlinear one 1,127 kW, more than J λ/2π, all that a heaving body of revolution can take of that wave.
"""

import numpy as np

from solver.hydrodynamics.bem import bem
from solver.hydrodynamics.hull.panel_hull import PanelHull
from solver.record.bound import power_per_wavenumber
from solver.run import simulate
from solver.scene import Float, Scene, Settings, Water
from solver.sea.realization import Realization
from studies.validation.checks import Check

RHO, PERIOD, HEIGHT = 1025.0, 6.0, 4.0
WIDE, DEEP = 5.0, 2.5  # semi-axes [m]
PTO, DRAG = 1.2e6, 0.5 * RHO * 1.0 * 78.54  # [N s/m], [N s²/m²]
THEIRS, BOUND = 244e3, 843e3  # [W]
# Two independent estimates of the body-nonlinear power, by how pressure goes on above still water [W].
BETWEEN = 150e3, 161e3


def spheroid(along: int = 16) -> PanelHull:
    """Quadrilaterals along meridians and around."""
    theta, psi = np.linspace(0, np.pi, along + 1), np.linspace(0, 2 * np.pi, 2 * along, endpoint=False)
    ring = np.stack([np.cos(psi), np.sin(psi), np.ones(psi.size)], axis=-1)
    scale = np.stack([WIDE * np.sin(theta), WIDE * np.sin(theta), DEEP * np.cos(theta)], axis=-1)
    n, (i, j) = psi.size, (x.ravel() for x in np.indices((along, psi.size)))
    faces = np.stack([i * n + j, (i + 1) * n + j, (i + 1) * n + (j + 1) % n, i * n + (j + 1) % n], axis=-1)
    return PanelHull.of((scale[:, None] * ring).reshape(-1, 3), faces)


def power() -> list[Check]:
    """Linear in both domains, body-nonlinear with both pressures, and the bound."""
    hull, omega = spheroid(), 2 * np.pi / PERIOD
    mass = RHO * hull.volume
    item = Float(
        name="ellipsoid", hull=hull, mass=mass, inertia=(5 * mass,) * 3, hinge=(0.0, 0.0, 0.0), motion=("heave",),
        pto_damping=PTO, quadratic_damping=DRAG,
    )  # fmt: skip
    sea = Realization(omega=np.array([omega]), amplitude=np.array([HEIGHT / 2 + 0j]), peak_frequency=omega)
    deep = Water(depth=np.inf, density=RHO)
    known = bem.solve((hull,), np.zeros((1, 3)), depth=np.inf, density=RHO, omega=np.linspace(0.3, 5.0, 30))

    def taken(**changes) -> float:
        settings = Settings(duration=120.0, discard=60.0, ramp=30.0, **changes)
        scene = Scene(water=deep, sea=sea, floats=(item,), settings=settings)
        return float(simulate(scene, known).variables["absorbed_power"][1][0, 2])

    at, middle = {"case": "ellipsoid, H 4 m, T 6 s"}, sum(BETWEEN) / 2
    lines, straight = taken(method="frequency", froude_krylov="linear"), taken(froude_krylov="linear")
    steep = {name: taken(pressure=name) for name in ("wheeler", "extrapolated")}
    above = "their body-nonlinear 1,127 kW is above J λ/2π"
    most = power_per_wavenumber(Scene(water=deep, sea=sea))
    return [
        Check(quantity="mean power, linear [W]", ours=straight, published=THEIRS, allowed=4e3, **at),
        Check(quantity="mean power, frequency domain [W]", ours=lines, published=THEIRS, allowed=4e3, **at),
        Check(quantity="J λ/2π [W]", ours=most, published=BOUND, allowed=1e3, **at),
        *(
            Check(quantity=f"body-nonlinear, {name} [W]", ours=ours, published=middle, allowed=8e3, note=above, **at)
            for name, ours in steep.items()
        ),
        *(
            Check(quantity=f"body-nonlinear, {name}, below J λ/2π [W]", ours=ours, published=BOUND, allowed=0.0,
                  side="below", **at)
            for name, ours in steep.items()
        ),
    ]  # fmt: skip
