"""Added mass, radiation damping and excitation: Hulme's hemisphere, a truncated cylinder, a box, Haskind's relation."""

from functools import partial
from unittest.mock import patch

import numpy as np

from solver.hydrodynamics.bem import bem, problem
from solver.hydrodynamics.hull.panel_hull import PanelHull
from solver.hydrodynamics.hull.revolution import Revolution
from studies.validation import drawing
from studies.validation.checks import Check, columns
from studies.validation.drawing import BLUE, GREEN, GREY, MARK, ORANGE, RED
from tests.hydrodynamics import shapes

G, RHO = 9.81, 1000.0
MESHES = (108, 432, 972, 1728)  # panels; 432 is the default
DEFAULT = 432
CURVES = ("surge_A", "surge_B", "heave_A", "heave_B")


def hemisphere(Ka: np.ndarray, panels: int) -> bem.Hydrodynamics:
    """A hemisphere of radius 1 m in deep water."""
    hull = Revolution.sphere(radius=1.0, draft=1.0)
    omega = np.sqrt(Ka * G)
    return bem.solve((hull,), np.zeros((1, 3)), depth=np.inf, density=RHO, omega=omega, panels=panels)


def normalised(h: bem.Hydrodynamics) -> dict[str, np.ndarray]:
    """Hulme's A' = A/(2/3 πρa³) and B' = B/(2/3 πρa³ ω)."""
    unit = 2 / 3 * np.pi * RHO
    A, B = h.added_mass / unit, h.radiation_damping / unit / h.omega[:, None, None]
    return {"surge_A": A[:, 0, 0], "surge_B": B[:, 0, 0], "heave_A": A[:, 1, 1], "heave_B": B[:, 1, 1]}


def hulme() -> list[Check]:
    """Surge and heave at the default mesh and Ka up to 3: within 0.5 % of each curve's largest value."""
    published = columns("hulme-1982-hemisphere.csv")
    used = published["Ka"] <= 3
    Ka = published["Ka"][used]
    solutions = {n: hemisphere(Ka, n) for n in MESHES}
    mine = normalised(solutions[DEFAULT])
    checks = []
    for name in CURVES:
        exact = published[name][used]
        worst = np.argmax(np.abs(mine[name] - exact))
        quantity = f"{name.replace('_', ' ')}' at Ka = {Ka[worst]:g} (worst of {used.sum()})"
        checks.append(
            Check(
                case="hemisphere, Hulme 1982", quantity=quantity, ours=mine[name][worst], published=exact[worst],
                allowed=5e-3 * exact.max(),
            )
        )  # fmt: skip
    errors = {n: _errors(normalised(h), published, used) for n, h in solutions.items()}
    for n, h in solutions.items():
        checks.append(
            Check(
                case="hemisphere, convergence", quantity=f"worst error [% of largest], {h.settings['panels']} panels",
                ours=100 * max(errors[n].values()), published=0.0, allowed=0.5 if n >= DEFAULT else np.inf,
                note="Each is extrapolated from that mesh and one of 4/9 the panels; Hulme's four digits are 0.01 %.",
            )
        )  # fmt: skip
    _figure(solutions, errors, published, used)
    return checks + haskind(solutions[DEFAULT])


def _errors(mine, published, used) -> dict[str, float]:
    """Largest error of each curve as a share of its largest value."""
    return {
        name: float(np.abs(mine[name] - published[name][used]).max() / published[name][used].max()) for name in CURVES
    }


def _figure(solutions, errors, published, used) -> None:
    figure, (left, right) = drawing.axes(2)
    Ka, fine = published["Ka"][used], normalised(solutions[DEFAULT])
    colours = dict(zip(CURVES, (BLUE, GREEN, ORANGE, RED), strict=True))
    for name in CURVES:
        left.plot(Ka, fine[name], lw=1.3, color=colours[name], label=f"{name.replace('_', ' ')}′")
        left.plot(Ka, published[name][used], "o", color=colours[name], **MARK)
        panels = [h.settings["panels"] for h in solutions.values()]
        right.plot(panels, [100 * e[name] for e in errors.values()], "-", lw=1.2, color=colours[name])
    left.set(xlabel="Ka = ω²a/g [-]", ylabel="A′, B′ [-]", title="Hemisphere: ours (lines), Hulme 1982 (circles)")
    right.axhline(0.5, color=GREY, lw=0.8, ls="--")
    right.axvline(solutions[DEFAULT].settings["panels"], color=GREY, lw=0.8, ls=":")
    right.set(
        xscale="log", yscale="log", xlabel="panels on the hemisphere", ylabel="worst error [% of curve's largest]",
        title="Mesh convergence (dotted: default; dashed: allowed)",
    )  # fmt: skip
    right.set(xticks=panels, xticklabels=panels, yticks=[0.03, 0.1, 0.3], yticklabels=["0.03", "0.1", "0.3"])
    right.minorticks_off()
    drawing.save(figure, "hemisphere")


def haskind(h: bem.Hydrodynamics) -> list[Check]:
    """|X₃| = √(2ρg³B₃₃/ω³): excitation from the diffraction solution against the radiation solution's damping."""
    X = np.abs(h.diffraction + h.froude_krylov)[:, 1]
    exact = np.sqrt(2 * RHO * G**3 * h.radiation_damping[:, 1, 1] / h.omega**3)
    worst = np.argmax(np.abs(X / exact - 1))
    return [
        Check(
            case="hemisphere, Haskind", quantity=f"|X3| at Ka = {h.omega[worst] ** 2 / G:g} (worst) [N/m]",
            ours=X[worst], published=exact[worst], allowed=5e-3 * exact[worst],
        )
    ]  # fmt: skip


def box() -> list[Check]:
    """A box of 6 x 3 m, draft 1.2 m, at the default, beside eight times as many panels, narrow at its edges."""
    run = partial(bem.solve, centres=np.zeros((1, 3)), depth=np.inf, density=RHO, omega=np.array([1.4]), planar=False)
    fine = shapes.graded_box((6.0, 3.0, 2.4), 0.2)
    with patch.object(problem, "AFFORDABLE", np.inf):
        exact = run((fine,), panels=len(fine.wetted))
    h = run((PanelHull.of(*shapes.box((6.0, 3.0, 2.4))),), panels=DEFAULT)
    checks, panels, count = [], f", {h.settings['panels']} panels", exact.settings["panels"]
    for i, motion in ((0, "surge"), (2, "heave"), (3, "roll")):
        true, told = (exact.added_mass - h.added_mass)[0, i, i], h.error.added_mass[0, i, i]
        checks += [
            Check(
                case="box, draft 1.2 m", quantity=f"added mass in {motion}, over that of {count}{panels}",
                ours=h.added_mass[0, i, i] / exact.added_mass[0, i, i], published=1.0, allowed=np.inf,
            ),
            Check(
                case="box, draft 1.2 m", quantity=f"|ln| of the true error in {motion} over that said{panels}",
                ours=abs(np.log(true / told)), published=0.0, allowed=np.log(3),
            ),
        ]  # fmt: skip
    return checks


def cylinder() -> list[Check]:
    """Truncated cylinder in water of ten radii, heave, at the default mesh and a finer one."""
    published = columns("finite-depth-cylinder-heave.csv")
    K = published["K"]
    hull = Revolution.vertical_cylinder(radius=1.0, draft=0.5, freeboard=0.5)
    figure, (axes,) = drawing.axes(1)
    checks = []
    # A panel code of 2,160 panels is within 0.5 % of the matched eigenfunctions; the default mesh is four times
    # as coarse, and at the sharp edge an error of the order of a panel's area remains after extrapolation.
    for panels, share in ((DEFAULT, 1e-2), (MESHES[2], 5e-3)):
        h = bem.solve((hull,), np.zeros((1, 3)), depth=10.0, density=RHO, omega=np.sqrt(K * G), panels=panels)
        unit = RHO * np.pi * 0.5
        mine = {"A33": h.added_mass[:, 1, 1] / unit, "B33": h.radiation_damping[:, 1, 1] / unit / h.omega}
        for (name, values), colour in zip(mine.items(), (BLUE, ORANGE), strict=True):
            worst = np.argmax(np.abs(values - published[name]))
            quantity = f"{name}' at K = {K[worst]:g}/m (worst of {len(K)}), {h.settings['panels']} panels"
            checks.append(
                Check(
                    case="cylinder, depth 10 m", quantity=quantity, ours=values[worst],
                    published=published[name][worst], allowed=share * published[name].max(),
                    note="The flow is singular at the sharp edge; twice the panels halve the error.",
                )
            )  # fmt: skip
            if panels == DEFAULT:
                axes.plot(K, values, lw=1.3, color=colour, label=f"{name}′, ours")
                axes.plot(K, published[name], "o", color=colour, label=f"{name}′, matched eigenfunctions", **MARK)
    axes.set(
        xlabel="K = ω²/g [1/m]", ylabel="A₃₃/ρV, B₃₃/ρVω [-]", title="Cylinder, radius 1 m, draft 0.5 m, depth 10 m"
    )
    drawing.save(figure, "cylinder")
    return checks
