"""The coupled time loop: order, limits, invariances and the frequency-domain solution."""

from dataclasses import replace

import numpy as np
import pytest
from numba import typeof
from pytest import approx

from solver.coupled.blocks import blocks
from solver.coupled.preparation import prepare
from solver.coupled.stages import State
from solver.coupled.support import dynamic_model
from solver.coupled.system import BLOCK_STEPS
from solver.errors import InputError, SimulationFailed
from solver.keys import shared
from solver.run import simulate
from solver.scene import Scene
from solver.structure.modes import modes_in, symmetric_basis
from solver.structure.water import added_mass
from studies.validation.response import frequency_domain
from tests.awkward import SCENES

SMOOTH = {"ramp": 15.0, "ramp_form": "cosine", "newton_tolerance": 1e-13}


def history(scene, coefficients, seconds):
    """z, p and hinge wrench (m, …) of the first seconds, samples half a step apart."""
    system = prepare(scene, coefficients)
    parts = [out for _, out, _ in blocks(system, system.start(), round(seconds / system.dt))]
    return [np.concatenate([getattr(out, name) for out in parts]) for name in ("z", "p", "wrench")]


def test_shared_poles_are_no_other_type_to_compile():
    """Half of what tests compiled was the time loop for read-only ones."""
    usual = prepare(*SCENES["duck"]())
    other = replace(usual, fit=replace(usual.fit, beta=shared(usual.fit.beta.copy())))
    assert typeof(other.fit.beta) != typeof(usual.fit.beta)
    assert typeof(other.problem()) == typeof(usual.problem())


@pytest.mark.parametrize("support", ["fixed", "elastic"])
def test_march_is_of_fourth_order(buan, coefficients, support):
    """Hs 0.3 m keeps the waterline off the hull's edges: smooth loads, on which an order can be seen."""
    steps = np.array([0.3, 0.15, 0.075])
    finest = 0.01875
    runs = [
        history(buan.scene(support, sea=buan.sea(Hs=0.3), time_step=dt, **SMOOTH), coefficients, 30.0)[0][-1]
        for dt in [*steps, finest]
    ]
    for coordinate in (-2, -1):
        error = [abs(run[coordinate] - runs[-1][coordinate]) for run in runs[:-1]]
        order = np.polyfit(np.log(steps), np.log(error), 1)[0]
        assert order == approx(4, abs=0.35)


def test_energy_balance_closes_at_the_order_of_the_scheme(buan, coefficients):
    steps = np.array([0.3, 0.15])
    residual = [
        simulate(buan.scene(sea=buan.sea(Hs=0.3), time_step=dt, **SMOOTH), coefficients).attrs["energy_residual"]
        for dt in steps
    ]
    assert residual[0] < 1e-4 and np.log2(residual[0] / residual[1]) > 3.5


def test_without_waves_nothing_moves(buan, coefficients):
    """Mass equals displacement, so still water is the equilibrium; what is left is the quadrature's rounding."""
    calm = replace(buan.sea(), amplitude=np.zeros(130, complex))
    z, p, _ = history(buan.scene(sea=calm, arc_points=16), coefficients, 30.0)
    assert np.abs(z).max() < 1e-9 and np.abs(p).max() < 1e-7


def test_rigid_platform_is_the_fixed_one(buan, coefficients):
    """Differences fall with the stiffness: 1e6 times stiffer leaves 1e-6 of the elastic motion."""
    exact = {"newton_tolerance": 1e-9}
    stiff = buan.scene(platform=buan.platform(frame=buan.frame(stiffer=1e6)), **exact)
    elastic, fixed = (history(s, coefficients, 60.0)[0][:, -2:] for s in (stiff, buan.scene("fixed", **exact)))
    assert np.abs(elastic - fixed).max() < 1e-5 * np.abs(fixed).max()


def test_few_modes_and_static_shapes_do_for_all(buan, coefficients):
    few, every = (simulate(buan.scene(modes=m), coefficients).variables for m in (6, "all"))
    for name in ("rotation", "top_displacement", "bottom_stress", "displacement_envelope"):
        # 1e-3 of the largest value: what the defaults promise.
        assert few[name][1] == approx(every[name][1], abs=1e-3 * np.abs(every[name][1]).max())


@pytest.mark.parametrize("where", ["water", "dry"])
@pytest.mark.parametrize("alpha, beta", [(0.0, 0.0), (0.2, 0.0), (0.0, 0.03), (0.1, 0.02)])
def test_damping_is_that_of_the_modes_in_water_or_dry(buan, alpha, beta, where):
    """Let go in a mode in still water, without drag: p = e^(-ζωt) (cos ω't + ζω/ω' sin ω't), ω with added mass.

    ζ as given, or of p̈ + (α + βω²) ṗ + ω²p = 0; what is given dry damps by the same force, but more mass.
    """
    still = [replace(m, drag_coefficient=0.0) for m in buan.frame().members]
    platform = buan.platform(frame=replace(buan.frame(), members=tuple(still)), damping_ratio=0.05)
    platform = replace(platform, rayleigh_mass=alpha, rayleigh_stiffness=beta, damping_of=where)
    calm = replace(buan.sea(), amplitude=np.zeros(130, complex))
    system = prepare(buan.scene("elastic-no-floats", platform=platform, sea=calm), None)
    model = dynamic_model(platform, buan.water)[0]
    masses = model.M, model.M + added_mass(model, buan.water.density)
    dry, omega = (modes_in(symmetric_basis(model), model.K, M, 1).omega[0] for M in masses)
    state = system.start()
    state.p[0], state.ddp[0] = 1.0, -(omega**2)
    p = np.concatenate([out.p[:, 0] for _, out, _ in blocks(system, state, 300)])
    mass = (omega / dry) ** 2 if where == "dry" else 1.0
    ratio = (alpha * mass + beta * omega**2) / (2 * omega) if alpha or beta else 0.05 * np.sqrt(mass)
    t, swift = 0.1 * (1 + np.arange(len(p))), omega * np.sqrt(1 - ratio**2)
    exact = np.exp(-ratio * omega * t) * (np.cos(swift * t) + ratio * omega / swift * np.sin(swift * t))
    assert p == approx(exact, abs=1e-4) and dry > 1.03 * omega
    assert str(platform.damping).endswith("of the stiffness") == bool(alpha or beta)


def test_half_a_platform_moves_as_the_whole(buan, monkeypatch):
    """Drag alone: legs off the plane of symmetry count twice, or each of the two by itself; a leg in it counts once."""
    frame = buan.frame()
    legs = [replace(m, inertia_coefficient=1.0, drag_coefficient=5.0 * m.in_water) for m in frame.members]
    legs.append(replace(legs[0], name="middle", start="foot", end="hinge:front"))
    nodes, clamped = {**frame.nodes, "foot": (-1.5, 0.0, -50.0)}, (*frame.clamped, "foot")
    whole = replace(frame, nodes=nodes, members=tuple(legs), clamped=clamped)
    platform = buan.platform(frame=whole, wave_inertia="relative")  # none of it with C_M = 1
    scene = buan.scene("elastic-no-floats", platform=platform, modes="all", newton_tolerance=1e-10)
    reduced, moved = prepare(scene, None).support, history(scene, None, 40.0)[1]
    monkeypatch.setattr(Scene, "planar", False)
    whole, free = prepare(scene, None).support, history(scene, None, 40.0)[1]
    assert 3 * whole.drag.size == 5 * reduced.drag.size
    half, both = (np.tensordot(p, s.legs.tops, axes=1) for s, p in ((reduced, moved), (whole, free)))
    assert np.ptp(half[..., 0]) > 0.03  # [m]
    assert both == approx(half, abs=1e-7)  # where drag was last evaluated differs by Newton's tolerance


def test_mirrored_sea_gives_the_mirrored_answer(buan, coefficients):
    """Waves from the other side: front and rear change places, rotations change sign."""
    there = replace(coefficients, heading=np.pi, diffraction=_swapped(coefficients.diffraction))
    along, against = (
        history(buan.scene(sea=buan.sea(heading=h), newton_tolerance=1e-11), c, 60.0)[0][:, -2:]
        for h, c in ((0.0, coefficients), (np.pi, there))
    )
    assert against == approx(-along[:, ::-1], abs=1e-8)


def _swapped(force):
    """Forces of the mirrored wave: bodies exchanged, surge and pitch reversed."""
    mirrored = force.reshape(len(force), 2, 3)[:, ::-1] * np.array([-1, 1, -1])
    return mirrored.reshape(len(force), 6)


def test_twice_the_density_doubles_the_forces(buan, coefficients):
    heavy = replace(
        coefficients,
        added_mass=2 * coefficients.added_mass,
        radiation_damping=2 * coefficients.radiation_damping,
        added_mass_inf=2 * coefficients.added_mass_inf,
        diffraction=2 * coefficients.diffraction,
        displaced_mass=2 * coefficients.displaced_mass,
        density=2 * coefficients.density,
    )
    scene = buan.scene("fixed", newton_tolerance=1e-10)
    item = scene.floats[0]
    doubled = replace(
        scene,
        water=replace(scene.water, density=2050.0),
        floats=buan.floats(mass=2 * item.mass, inertia=(1718.0,) * 3, pto_damping=2e5),
    )
    (z1, _, w1), (z2, _, w2) = history(scene, coefficients, 40.0), history(doubled, heavy, 40.0)
    # The fit of the memory may pick another rounding; both runs converge to the same motion.
    assert z2 == approx(z1, abs=1e-6) and w2 == approx(2 * w1, abs=1e-6 * np.abs(w1).max())


@pytest.mark.parametrize("omega", [0.8, 1.15, 2.0])
def test_small_regular_wave_gives_the_frequency_domain_answer(buan, coefficients, omega):
    """(-ω²M - iω(B + B_pto) + C) θ = X a, projected on the hinges of a fixed platform."""
    amplitude = 1e-3
    scene = buan.scene(
        "fixed", sea=buan.regular(amplitude, omega), froude_krylov="linear", duration=200.0, time_step=0.1,
        memory_tolerance=1e-3,
    )  # fmt: skip
    z = history(scene, coefficients, 200.0)[0]
    t = 0.05 * (1 + np.arange(len(z)))
    last = t > 200 - 4 * 2 * np.pi / omega
    first_harmonic = 2 * np.mean(z[last] * np.exp(1j * omega * t[last])[:, None], axis=0)
    exact = amplitude * frequency_domain(scene.floats, coefficients, np.array([omega]))[0]
    # 5e-3: splines through 36 coarse frequencies and a memory fitted to 1e-3.
    assert np.abs(first_harmonic - exact).max() < 5e-3 * np.abs(exact).max()


def test_twice_the_same_run_is_the_same_run(buan, coefficients):
    a, b = (simulate(buan.scene(), coefficients).variables for _ in range(2))
    assert all(np.array_equal(a[name][1], b[name][1]) for name in a)


@pytest.mark.parametrize(
    ("stops", "apart"), [((BLOCK_STEPS,), 0.0), ((BLOCK_STEPS, 2 * BLOCK_STEPS), 0.0), ((100, 333), 1e-9)]
)
def test_a_run_goes_on_from_a_saved_state(buan, coefficients, tmp_path, stops, apart):
    """Once or twice through a file; within a block Newton's matrix is another, so its tolerance shows."""
    system = prepare(buan.scene(newton_tolerance=1e-11), coefficients)
    whole = np.concatenate([out.z for _, out, _ in blocks(system, system.start(), 600)])
    state, parts = system.start(), []
    for done, until in zip((0, *stops), (*stops, 600), strict=True):
        parts += [out.z for _, out, _ in blocks(system, state, until, done)]
        np.savez(tmp_path / "state.npz", **state._asdict())
        with np.load(tmp_path / "state.npz") as saved:
            state = State(**saved)
    assert np.abs(np.concatenate(parts) - whole).max() <= apart


def test_a_float_thrown_over_is_an_outcome(buan, coefficients):
    wild = buan.scene("fixed", sea=buan.sea(Hs=8.0, Tp=6.0), floats=buan.floats(pto_damping=0.0))
    with pytest.raises(SimulationFailed, match=r"t = \d+.*its damping"):
        simulate(wild, coefficients)


def test_record_audits_itself(buan, coefficients):
    attrs = simulate(buan.scene(), coefficients).attrs
    assert attrs["energy_residual"] < 1e-3
    assert attrs["constraint_drift"] < 1e-12
    assert 0 < attrs["discretization_error"] < 1e-3


@pytest.mark.parametrize(
    ("changed", "key"),
    [
        ({"depth": 30.0}, r"water\.depth = 50"),
        ({"density": 1000.0}, r"water\.density"),
        ({"heading": np.pi}, r"sea\.heading"),
        ({"centres": np.zeros((1, 3))}, "floats = 2"),
        ({"centres": np.zeros((2, 3))}, "must be where"),
    ],
)
def test_coefficients_of_another_scene_are_refused(buan, coefficients, changed, key):
    with pytest.raises(InputError, match=key):
        prepare(buan.scene(), replace(coefficients, **changed))


@pytest.mark.parametrize("name", ["soft_mooring", "flap"])
def test_forces_of_a_joint_are_those_of_the_last_update(name):
    """A large body's inertia times Newton's last update is no force: it was 23 % of a soft mooring's std."""
    scene, known = SCENES[name]()
    tight = replace(scene, settings=replace(scene.settings, newton_tolerance=1e-11))
    usual, exact = (simulate(item, known).variables["hinge_force"][1] for item in (scene, tight))
    assert usual == approx(exact, abs=5e-3 * np.abs(exact).max())
