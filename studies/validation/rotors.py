"""Six rotors on a floating platform: energy by the waves far off, and limits where the answer is a simpler scene's."""

from dataclasses import replace
from functools import cache, partial
from pathlib import Path

import numpy as np
from scipy.special import jvp, yvp

from pipeline.bridge import scenes
from pipeline.bridge.loading import load
from pipeline.tasks.task import expand
from solver.coupled.linear import linear_model
from solver.coupled.natural import with_critical_damping
from solver.coupled.preparation import prepare, remembered
from solver.frequency.case import case_of
from solver.frequency.drift import waves_of
from solver.frequency.response import respond
from solver.hydrodynamics.bem import bem, far_field
from solver.hydrodynamics.bem.coefficients import DOFS, Hydrodynamics
from solver.hydrodynamics.hull.duck import duck
from solver.hydrodynamics.hull.revolution import Revolution
from solver.hydrodynamics.radiation.fitting import USUAL
from solver.motions import of_scene
from solver.scene import Float, Scene, Settings, Water
from solver.sea.dispersion import wavenumber
from solver.sea.realization import components
from studies.validation import drawing, response
from studies.validation.checks import Check
from studies.validation.drawing import BLUE, GREY, ORANGE, RED

OMEGA = np.array([0.6, 0.75, 0.9, 1.05, 1.2])  # [rad/s], of waves and of coefficients: nothing is interpolated
SMALL = 1e-3  # their amplitude [m]
SLANT = 0.5  # heading of oblique waves [rad]
ROUND = 48  # headings of waves from all round
HELD = {"motion": (), "stiffness": 0.0, "damping": 0.0, "critical_damping": 0.0}
STIFF = 1e14  # N/m of a mooring that lets nothing move
CASE, WATER = "rotors", Water(depth=np.inf)
BAND = (0.4, 2.0)  # [rad/s], in which time and frequency domain are compared
RINGS = np.array([1.295, 1.38, 1.82, 1.87])  # [rad/s], between frequencies solved for, where water rings between bodies
FREQUENCY = Settings(froude_krylov="linear", method="frequency")
AWAY = (40.0, 160.0)  # m, from one small rotor to another
ONE_MESH = (
    "Six bodies and more are solved on one mesh, as it is given, and nothing is extrapolated: what is left is the"
    " mesh's error, up to half as large with 640 panels a body in place of 432."
)


@cache
def jeju(variant: str, heading: float = 0.0) -> Scene:
    """A variant of studies/jeju-rotors.toml in small waves, in the frequency domain."""
    study = load(Path(__file__).parents[1] / "jeju-rotors.toml").content
    task = next(t for t in expand(study) if t.labels["variant"] == variant)
    amplitude = np.full(OMEGA.size, SMALL)
    sea = components(amplitude=amplitude, omega=OMEGA, phase=np.arange(OMEGA.size), heading=heading)
    return replace(scenes.scene(task.parameters), sea=sea)


@cache
def solved(variant: str, headings: tuple[float, ...] = (0.0,)) -> tuple[Hydrodynamics, ...]:
    """Coefficients of its bodies in all their motions, with their far field, for each heading."""
    return _coefficients(jeju(variant), headings)


def _coefficients(item: Scene, headings: tuple[float, ...]) -> tuple[Hydrodynamics, ...]:
    problem = bem.Problem.of(
        tuple(f.hull for f in item.floats), np.array([f.centre for f in item.floats]), depth=item.water.depth,
        density=item.water.density, gravity=item.water.gravity, omega=OMEGA, headings=headings, planar=False,
        far_field=True,
    )  # fmt: skip
    return tuple(bem.united(problem, [bem.part(problem)]))


def arrays() -> list[Check]:
    """All checks, and the figure of power and q over headings."""
    checks = [*_energy("single", "one rotor"), *_energy("floating", "six rotors afloat"), *_drift()]
    return [*checks, *_in_time(), *_hardly_moving(), *_locked(), *_far_apart(), *_all_round()]


def _check(quantity: str, ours: float, published: float, allowed: float, note: str = "") -> Check:
    return Check(case=CASE, quantity=quantity, ours=float(ours), published=float(published), allowed=allowed, note=note)


def _energy(variant: str, words: str) -> list[Check]:
    """Power that is missing far off beside what power take-offs and dampers take; Haskind's force and B from there."""
    checks, note = [], ONE_MESH if len(jeju(variant).floats) > 1 else ""
    most = 0.05 if note else 0.02
    for h in solved(variant, (0.0, SLANT)):
        item = jeju(variant, h.heading)
        response, damping = respond(item, h), linear_model(prepare(item, h)).damping
        rate = response.omega[:, None] * response.X
        taken = 0.5 * np.einsum("wi,ij,wj->w", rate.conj(), damping, rate).real
        far = waves_of(case_of(item, h), response).absorbed_power
        told = f"{words}, {h.heading:g} rad"
        for w, ours, exact in zip(OMEGA, far / SMALL**2, taken / SMALL**2, strict=True):
            quantity = f"{told}: absorbed by the far field, {w:g} rad/s [W/m2]"
            checks.append(_check(quantity, ours, exact, (0.02 if note else 0.01) * exact, note))
        whole = float(taken.sum())
        checks.append(_check(f"{told}: all waves together, over damping's", far.sum() / whole, 1.0, 0.01, note))
        k = wavenumber(OMEGA, h.depth, h.gravity)
        arrival = np.exp(1j * k * (h.far_field.origin @ [np.cos(h.heading), np.sin(h.heading)]))
        haskind = far_field.excitation(h.far_field, h.heading, density=h.density, gravity=h.gravity) * arrival[:, None]
        exact = h.excitation(OMEGA)
        apart = _worst(haskind - exact, np.abs(exact).max(axis=0), h.dofs)
        checks.append(_check(f"{told}: Haskind's force, worst difference over largest", apart, 0.0, most, note))
    water = {"depth": h.depth, "density": h.density, "gravity": h.gravity}
    size = np.sqrt(np.einsum("wii->wi", h.radiation_damping).max(axis=0))
    difference = far_field.radiation_damping(h.far_field, OMEGA, **water) - h.radiation_damping
    apart = float(np.abs(difference / np.outer(size, size)).max())
    quantity = f"{words}: damping by the far field, worst difference over largest"
    return [*checks, _check(quantity, apart, 0.0, most, note)]


def _worst(difference: np.ndarray, size: np.ndarray, dofs: tuple[str, ...]) -> float:
    """Forces over the largest on any body, moments over the largest moment."""
    turning = np.tile([DOFS.index(d) >= 3 for d in dofs], size.size // len(dofs))
    return max(float(np.abs(difference[:, some]).max() / size[some].max()) for some in (turning, ~turning))


def _drift() -> list[Check]:
    """Of a vertical cylinder so deep that waves do not see its end, F/(ρg a² R), by Havelock's series."""
    ka = np.array([1.0, 1.5, 2.0])
    hull = Revolution.vertical_cylinder(radius=1.0, draft=4.0, freeboard=1.0)
    problem = bem.Problem.of((hull,), np.zeros((1, 3)), depth=np.inf, omega=np.sqrt(9.81 * ka), far_field=True)
    (h,) = bem.united(problem, [bem.part(problem)])
    force = h.waves(h.omega, np.ones(ka.size), np.zeros((ka.size, len(h.dofs)))).drift_force[:, 0]
    return [
        _check(f"cylinder, kR = {x:g}: mean drift over rho g a2 R (Havelock 1940)", F, exact, 0.005 * exact)
        for x, F, exact in zip(ka, force / (h.density * h.gravity), map(havelock, ka), strict=True)
    ]


def havelock(ka: float) -> float:
    """4/(π²(ka)³) Σ (1 - m(m+1)/(ka)²)²/((J'²+Y'²)ₘ (J'²+Y'²)ₘ₊₁)."""
    m, size = np.arange(15), jvp(np.arange(16), ka) ** 2 + yvp(np.arange(16), ka) ** 2
    return float(4 / (np.pi**2 * ka**3) * np.sum((1 - m * (m + 1) / ka**2) ** 2 / (size[:-1] * size[1:])))


def _response(item: Scene, h: Hydrodynamics) -> np.ndarray:
    """Of the joints' axes per wave amplitude (nw, nj)."""
    return respond(item, h).Z / item.sea.amplitude[:, None]


def _in_time() -> list[Check]:
    """Afloat, in the time domain against the frequency domain, and that against coefficients at its own frequencies."""
    item, ways = jeju("floating"), of_scene(jeju("floating"))
    hulls, centres = tuple(f.hull for f in item.floats), np.array([f.centre for f in item.floats])
    solve = partial(
        bem.solve, hulls, centres, depth=item.water.depth, density=item.water.density, gravity=item.water.gravity,
        planar=False,
    )  # fmt: skip
    found = solve(omega=bem.frequency_grid(hulls, centres, depth=item.water.depth, band=BAND), waves_to=BAND[1])
    memory = remembered(found, hulls, USUAL, ways)
    known = replace(found, memory=memory, memory_tolerance=USUAL, memory_motions=ways)
    sea = response.white_noise(height=0.01, band=BAND, components=80)
    linear = with_critical_damping(replace(item, sea=sea, settings=FREQUENCY), known)
    marched = replace(linear, settings=response.settings(froude_krylov="linear", memory_tolerance=None))
    checks = _apart("time domain", response.irregular(marched, known), _response(linear, known), 0.005)
    waves = components(amplitude=np.full(RINGS.size, SMALL), omega=RINGS, phase=np.zeros(RINGS.size))
    between = replace(linear, sea=waves)
    exact = _response(between, solve(omega=RINGS))
    return [*checks, *_apart("between the frequencies solved for", _response(between, known), exact, 0.005)]


def _apart(words: str, ours: np.ndarray, exact: np.ndarray, allowed: float) -> list[Check]:
    """Worst difference of complex RAOs (nw, nj) over the largest of each, of the platform and of the rotors."""
    apart = (np.abs(ours - exact) / np.abs(exact).max(axis=0)).max(axis=0)
    return [
        _check(f"six rotors afloat, {words}: RAO of {name}, worst difference over largest", worst, 0.0, allowed)
        for name, worst in (("platform", apart[:3].max()), ("rotors", apart[3:].max()))
    ]


def _hardly_moving() -> list[Check]:
    """The platform moored stiffly, and the platform held."""
    (h,), item = solved("floating")[:1], jeju("floating")
    platform, *others = item.floats
    stiff = replace(platform, stiffness=(STIFF, STIFF, 1e3 * STIFF), critical_damping=0.0)
    free = _response(replace(item, floats=(stiff, *others)), h)
    fixed = _response(replace(item, floats=(replace(platform, **HELD), *others)), h)
    apart = np.abs(free[:, 3:] - fixed).max() / np.abs(fixed).max()
    return [_check("stiffly moored against held: rotations, worst difference over largest", apart, 0.0, 1e-3)]


def _locked() -> list[Check]:
    """(K - ω²M - iω(D + B - iωA)) X = F of all seven bodies as one, its terms summed about the platform's joint."""
    (h,), item = solved("floating")[:1], jeju("floating")
    platform, *others = item.floats
    free = replace(platform, critical_damping=0.0, damping=(1e4, 2e4, 3e6))
    floats = (free, *(replace(f, **HELD, pto_damping=0.0) for f in others))
    J, M = np.zeros((6 * len(floats), 3)), np.zeros((3, 3))
    C = np.diag([platform.per_axis("stiffness")[0], 0, 0])
    for b, f in enumerate(floats):
        x, (gx, _, gz) = f.centre[0], np.add(f.centre, f.cog)
        J[6 * b : 6 * b + 6][[DOFS.index("surge"), DOFS.index("heave"), DOFS.index("pitch")]] = np.eye(3)
        J[6 * b + DOFS.index("heave"), 2] = -x
        inertia = f.inertia[1] + f.mass * (gx**2 + gz**2)
        M += [[f.mass, 0, f.mass * gz], [0, f.mass, -f.mass * gx], [f.mass * gz, -f.mass * gx, inertia]]
        C[2, 2] -= h.gravity * f.mass * gz
    C = C + J.T @ h.hydrostatic_stiffness @ J
    Y, force = J.T @ h.impedance(OMEGA) @ J, h.excitation(OMEGA) @ J
    D = np.diag([1e4, 2e4, 3e6])
    whole = [np.linalg.solve(C - w**2 * M - 1j * w * (D + y), f) for w, y, f in zip(OMEGA, Y, force, strict=True)]
    ours = _response(replace(item, floats=floats), h)
    return [
        _check(f"rotors locked against one rigid body: {name}, worst difference over largest", apart, 0.0, 1e-5)
        for name, apart in zip(
            ("surge", "heave", "pitch"), (np.abs(ours - whole).max(axis=0) / np.abs(whole).max(axis=0)), strict=True
        )
    ]


def _far_apart() -> list[Check]:
    """Two small rotors: what one sends to the other spreads over a circle, and falls as the root of the distance."""
    (alone,) = _small(0.0)
    gaps = [np.sqrt(np.mean(np.abs(_small(y)[0] / alone - 1) ** 2)) for y in AWAY]
    expected = float(np.sqrt(AWAY[0] / AWAY[1]))
    words = f"two rotors {AWAY[1]:g} m apart: change of rotation by the other"
    return [
        _check(f"{words}, over that at {AWAY[0]:g} m", gaps[1] / gaps[0], expected, 0.1 * expected),
        _check(f"{words}, rms", gaps[1], 0.0, 0.02),
    ]


def _small(distance: float) -> np.ndarray:
    """Rotation per wave amplitude (1 or 2, nw) of a rotor and, at a distance across the waves, of another."""
    hull = duck(radius=0.6, beak=1.4, elevation=0.3, submergence=0.3, width=1.5)
    mass = WATER.density * hull.volume
    floats = tuple(
        Float(
            name=f"r{y:g}", hull=hull, mass=mass, inertia=(0.5 * mass, 0.4 * mass, 0.5 * mass), hinge=(0, y, -0.3),
            arm=(0, 0, 0.3), cog=(hull.buoyancy_point[0], 0, -0.35), pto_damping=2e3,
        )
        for y in {0.0, distance}
    )  # fmt: skip
    omega = np.linspace(1.5, 2.7, OMEGA.size)
    sea = components(amplitude=np.full(omega.size, SMALL), omega=omega, phase=np.zeros(omega.size))
    item = Scene(water=WATER, sea=sea, floats=floats, settings=FREQUENCY)
    h = bem.solve(
        tuple(f.hull for f in floats), np.array([f.centre for f in floats]), depth=np.inf, omega=omega,
        planar=item.planar,
    )  # fmt: skip
    return _response(item, h).T


def _all_round() -> list[Check]:
    """Most power ⅛ X* B⁻¹ X that six rotors on fixed axes can take, mean over all headings: that of six alone, 6 J/k.

    For B = k/(8πJ) ∫ X X* dβ of any hulls and places, X per unit amplitude (Wolgamot, Taylor and Eatock Taylor 2012).
    """
    headings = tuple(2 * np.pi * np.arange(ROUND) / ROUND)
    each = solved("fixed-axis", headings)
    item, h = jeju("fixed-axis"), each[0]
    J = np.zeros((6 * len(item.floats), len(item.floats)))
    for b, f in enumerate(item.floats):
        J[6 * b : 6 * b + 6, b] = [*np.cross(f.axis, f.arm), *f.axis]
    B = J.T @ h.radiation_damping @ J
    X = np.array([at.excitation(OMEGA) @ J for at in each])  # (headings, nw, rotors)
    power = np.einsum("hwi,wij,hwj->hw", X.conj(), np.linalg.inv(B), X).real / 8
    k = wavenumber(OMEGA, h.depth, h.gravity)
    most = len(item.floats) * 0.5 * h.density * h.gravity * OMEGA / (2 * k**2)
    _draw(np.array(headings), power / most)
    return [
        _check(f"most power of six rotors, mean over headings, over 6 J/k, {w:g} rad/s", q, 1.0, 0.02, ONE_MESH)
        for w, q in zip(OMEGA, (power / most).mean(axis=0), strict=True)
    ]


def _draw(heading: np.ndarray, q: np.ndarray) -> None:
    figure, (axis,) = drawing.axes(1, width=6.5)
    shown = (0, 2, 4)
    for i, colour in zip(shown, (BLUE, ORANGE, RED), strict=True):
        axis.plot(np.degrees(heading), q[:, i], color=colour, label=f"{OMEGA[i]:g} rad/s")
    axis.axhline(1.0, color=GREY, lw=0.8)
    axis.set(xlabel="heading [°]", ylabel="q", title="Most power of six rotors on fixed axes, over that of six alone")
    axis.legend()
    drawing.save(figure, "rotors")
