"""Waves' loads on a frame up to their surface: closed forms, integrals, limits, and a run's balance."""

from dataclasses import replace

import numpy as np
import pytest
from pytest import approx

from solver.coupled import stretching
from solver.coupled.blocks import blocks
from solver.coupled.preparation import prepare
from solver.errors import InputError
from solver.run import simulate
from solver.scene import Settings, Water
from solver.sea.current import Current
from solver.sea.field import WaveField
from solver.sea.realization import components, regular
from solver.statistics import STATISTICS
from solver.structure import water
from solver.structure.frame_model import assemble
from solver.structure.sections import tube
from tests.awkward import bare_legs, on_piles, sea, soft_ground, unequal_legs
from tests.coupled.test_current import marched, pile

DEPTH, TOP, D, CD, CM, RHO = 20.0, 5.0, 0.8, 1.1, 2.0, 1025.0
WAVES = components(amplitude=[1.0, 0.4, 0.2], omega=[0.8, 1.3, 1.9], phase=[0.3, 2.0, 1.0])
MAX = STATISTICS.index("max")


def stretched(item, kind):
    return replace(item, platform=replace(item.platform, wave_stretching=kind))


def rigid(item):
    """A hundred times as stiff as steel."""
    frame = item.platform.frame
    stiff = replace(frame.members[0].material, E=2.1e13, G=8e12)
    members = tuple(replace(m, material=stiff) for m in frame.members)
    return replace(item, platform=replace(item.platform, frame=replace(frame, members=members)))


def integrated(field, t, level, top):
    """Morison's force and its moment about the seabed on the pile up to `top`, where z is moved as at level(z)."""
    x, w = np.polynomial.legendre.leggauss(200)
    z, w = (top - DEPTH) / 2 + (top + DEPTH) / 2 * x, (top + DEPTH) / 2 * w
    there = np.stack([0 * z, 0 * z, level(z)], axis=1)
    turn = np.exp(-1j * field.sea.omega * t)
    u, du = ((rows(there)[:, 0] @ turn).real for rows in (field.velocity, field.acceleration))
    f = 0.5 * RHO * CD * D * np.abs(u) * u + RHO * CM * np.pi / 4 * D**2 * du
    return np.array([f @ w, (f * (z + DEPTH)) @ w])


@pytest.mark.parametrize(
    "kind",
    [pytest.param("none", marks=pytest.mark.slow), "wheeler", pytest.param("extrapolated", marks=pytest.mark.slow)],
)
def test_a_piles_reactions_are_the_integral_to_the_surface(kind):
    """Wheeler's are those to still water, F (1 + η/d) and M (1 + η/d)² about the seabed, whatever the waves."""
    item = stretched(rigid(pile(None, WAVES, ramp=20.0)), kind)
    _, steel, _, y, times = marched(item, None)
    late = times > 30.0
    told = dict(steel.channels(y[late]))
    field = WaveField(WAVES, DEPTH, 9.81)
    exact = []
    for t in times[late]:
        eta = float((field.elevation(np.zeros(3)) @ np.exp(-1j * WAVES.omega * t)).real)
        still = integrated(field, t, lambda z: z, eta if kind == "extrapolated" else 0.0)
        exact.append(still * (1 + eta / DEPTH) ** np.array([1, 2]) if kind == "wheeler" else still)
    force, moment = np.array(exact).T
    # The pile's own motion is 7e-4 of it (none); the rest is that of stations that the surface passes.
    assert np.abs(told["base_shear"][:, 0] - force).max() < 1.5e-3 * np.abs(force).max()
    assert np.abs(told["overturning_moment"][:, 1] - moment).max() < 2.5e-3 * np.abs(moment).max()


def test_the_crest_bears_a_mean_force():
    """Deep water, linear theory gone on above still water: ½ρC_D D(ωa)² a 4/3π, ⟨|cos|cos²⟩ of the zone it wets."""
    a, omega = 0.25, 0.9
    item = replace(pile(None, regular(height=2 * a, period=2 * np.pi / omega)), water=Water(depth=np.inf))
    exact, means = 0.5 * RHO * CD * D * (omega * a) ** 2 * a * 4 / (3 * np.pi), []
    for kind in ("wheeler", "extrapolated"):
        system = prepare(stretched(item, kind), None)
        drive = system.drive(system.series(4 * np.pi / omega / 800).block(0, 800))
        drag = (system.support.stretched.drag * drive.wet)[:, None] * np.abs(drive.station) * drive.station
        means.append((drag + drive.push).sum(axis=2).mean())
    # Inertia has none but of the next order, (ka)²; at the pile's end Wheeler's water leaves out η exp(-2kL), 0.037.
    assert means[0] == approx(0.037 * exact, abs=0.01 * exact)
    assert means[1] == approx(exact, rel=0.03)


@pytest.mark.parametrize("kind", ["wheeler", "extrapolated"])
def test_water_about_leaning_legs_is_that_of_the_formula(kind):
    """At every station, in waves at 0.7 rad and a current: velocity at its own place and Wheeler's level, the share
    that is wet, and inertia beyond that to still water."""
    flow = Current(speed=0.6, exponent=1 / 7, direction=2.0)
    item = stretched(replace(bare_legs()[0], sea=sea(heading=0.7), current=flow), kind)
    settings = replace(item.settings, ramp=0.0)
    system = prepare(replace(item, settings=settings), None)
    s, drive, times = system.support.stretched, system.drive(system.series(0.1).block(0, 60)), 0.05 * np.arange(60)
    assert s.height.max() > 0
    depth, field = item.water.depth, system.waves
    at = water.stations(assemble(item.platform.frame), flow.points, field.mean_length, stretching.splash(field))
    normal = np.eye(3) - at.tangent[:, :, None] * at.tangent[:, None, :]
    for i in range(0, 60, 7):
        turn = np.exp(-1j * item.sea.omega * times[i])
        eta = (field.elevation(at.position) @ turn).real
        low, high = stretching.wet_bounds(at).T
        wet = np.clip((eta - low) / (high - low), 0, 1)
        z = low + wet * (at.position[:, 2] - low)
        level = z if kind == "extrapolated" else np.minimum((z - eta) / (1 + eta / depth), 0.0)
        there = np.concatenate([at.position[:, :2], level[:, None]], axis=1)
        u, du = ((rows(there) @ turn).real for rows in (field.velocity, field.acceleration))
        before = np.where(at.position[:, 2:] < 0, (field.acceleration(at.position) @ turn).real, 0.0)
        u = np.einsum("sij,sj->si", normal, u + field.stream(at.position))
        push = np.einsum("sij,sj->si", normal, wet[:, None] * du - before) * s.inertia[:, None]
        assert drive.wet[i] == approx(wet, abs=1e-9)
        shown = wet > 0
        assert drive.station[i].T[shown] == approx(u[shown], abs=1e-3 * np.abs(u).max())
        largest = np.abs(s.inertia[:, None] * du).max()
        np.testing.assert_allclose(drive.push[i].T, push, rtol=0, atol=1e-3 * largest)


def test_a_model_is_loaded_as_the_pile():
    """1:20 by Froude: forces 20³ times as small, 20^½ times as soon, whatever pieces the stations are of."""
    forces, scale = [], 1 / 20
    for size in (1.0, scale):
        frame, leg = pile(None).platform.frame, pile(None).platform.frame.members[0]
        nodes = {name: tuple(size * np.array(place)) for name, place in frame.nodes.items()}
        smaller = replace(frame, nodes=nodes, members=(replace(leg, section=tube(size * 0.8, size * 0.02)),))
        item = stretched(pile(None, WAVES), "wheeler")
        waves = replace(WAVES, omega=WAVES.omega / size**0.5, amplitude=WAVES.amplitude * size)
        item = replace(item, water=Water(depth=20 * size), platform=replace(item.platform, frame=smaller), sea=waves)
        system = prepare(item, None)
        drive = system.drive(system.series(0.2 * size**0.5).block(0, 200))
        drag = (system.support.stretched.drag * drive.wet)[:, None] * np.abs(drive.station) * drive.station
        forces.append((drag + drive.push).sum(axis=(1, 2)) / size**3)
    assert forces[1] == approx(forces[0], abs=5e-3 * np.abs(forces[0]).max())


def test_small_waves_load_as_to_still_water():
    """The difference is of second order: a tenth of the height, a hundredth of it."""
    item, apart = replace(bare_legs()[0], sea=sea(Hs=0.5, heading=0.4)), []
    for share in (1.0, 0.1):
        lower = replace(item, sea=replace(item.sea, amplitude=share * item.sea.amplitude))
        loads = []
        for kind in ("none", "wheeler"):
            system = prepare(stretched(replace(lower, settings=replace(item.settings, ramp=0.0)), kind), None)
            drive = system.drive(system.series(0.1).block(0, 200))
            loads.append(drive.modal)
            if drive.push.size:
                loads[-1] = drive.modal + np.einsum("tdn,mdn->tm", drive.push, system.structure.station)
        apart.append(np.linalg.norm(loads[1] - loads[0]))
    assert apart[0] / apart[1] == approx(100, rel=0.2)


def test_a_level_member_is_wet_by_its_thickness():
    leg = pile(None).platform.frame.members[0]
    frame = replace(pile(None).platform.frame, nodes={"foot": (0, 0, 0.6), "top": (4, 0, 0.6)}, members=(leg,))
    at = water.stations(assemble(frame), 2, 1.0, water.Splash(4.0, 1.0, 0.5))
    assert len(at.position) == 16
    assert stretching.wet_bounds(at) == approx(np.tile([0.2, 1.0], (16, 1)))
    assert not len(water.stations(assemble(frame), 2).position)


@pytest.mark.parametrize("kind", ["wheeler", "extrapolated"])
@pytest.mark.parametrize("z", [-0.6, 0.0, 0.6])
def test_a_run_begins_bent_by_the_current_on_what_is_wet(kind, z):
    """A brace of 2 m of which a part is: while waves still rise nothing moves."""
    item = pile(Current(speed=1.0, direction=np.pi / 2), WAVES, ramp=20.0, time_step=1e-3)
    leg, *_ = item.platform.frame.members
    leg = replace(leg, name="brace", start="top", end="tip", section=tube(2.0, 0.02))
    nodes = {"foot": (0, 0, -DEPTH), "top": (0, 0, z), "tip": (8.0, 0, z)}
    frame = replace(item.platform.frame, nodes=nodes, members=(*item.platform.frame.members, leg))
    system = prepare(stretched(replace(item, platform=replace(item.platform, frame=frame)), kind), None)
    _, output, _ = next(blocks(system, system.start(), 1))
    size = np.abs(system.structure.omega**2 * system.equilibrium[1]).max()
    assert np.abs(output.ddp[0]).max() < 1e-4 * size


def test_stations_stand_for_all_of_a_member_once():
    """From the seabed to the top, short where the surface passes; still water parts them."""
    model = assemble(pile(None).platform.frame)
    at = water.stations(model, 3, 4.0, water.Splash(8.0, 1.0, 0.5))
    low, high = stretching.wet_bounds(at).T
    assert np.concatenate([low, high[-1:]]) == approx(np.concatenate([[-DEPTH], high]))
    assert high[-1] == approx(TOP)
    assert np.any(np.abs(low) < 1e-12)
    assert at.weight == approx(high - low)
    near = np.abs(at.position[:, 2]) < 1.0
    assert at.weight[near].sum() == approx(2.0)
    assert at.weight[near].max() < 0.25 < at.weight[~near].max()


def test_seas_that_are_alike_share_their_stations():
    fields = [WaveField(sea(Hs=Hs, seed=seed), 20.0, 9.81) for Hs, seed in ((1.2, 1), (1.25, 2), (3.0, 1))]
    one, alike, other = map(stretching.splash, fields)
    assert one == alike
    assert one != other
    assert one.reach >= np.abs(fields[0].sea.amplitude).sum()
    assert stretching.splash(WaveField(components(amplitude=[0.0], omega=[1.0], phase=[0.0]), 20.0, 9.81)) == water.DRY


@pytest.mark.parametrize(
    ("made", "kind"),
    [
        (unequal_legs, "wheeler"),
        (on_piles, "wheeler"),
        *(
            pytest.param(*case, marks=pytest.mark.slow)
            for case in [(unequal_legs, "extrapolated"), (soft_ground, "wheeler")]
        ),
    ],
)
def test_a_run_keeps_its_energy(made, kind):
    """Legs of unequal height with a float, body-nonlinear, on springs and on piles, in waves at 30 degrees; the largest
    moment is not that of still water."""
    item, h = made()
    settings = replace(item.settings, duration=60.0, outputs=("reactions",))
    usual, other = (simulate(stretched(replace(item, settings=settings), k), h) for k in ("none", kind))
    assert other.attrs["energy_residual"] < 1e-4
    moment = [record.variables["overturning_moment"][1][1, MAX] for record in (usual, other)]
    assert abs(moment[1] / moment[0] - 1) > 1e-3


def test_the_frequency_domain_goes_to_still_water():
    item = replace(bare_legs()[0], settings=Settings(method="frequency", froude_krylov="linear"))
    records = [simulate(stretched(item, kind)) for kind in ("none", "wheeler")]
    first, second = (r.variables["top_displacement"][1] for r in records)
    assert np.array_equal(first, second)
    assert "stretching" in records[1].attrs["skipped"]
    assert "stretching" not in records[0].attrs["skipped"]


def test_the_augmented_formulation_refuses():
    item = bare_legs()[0]
    with pytest.raises(InputError, match=r'wave_stretching = wheeler: needs formulation = "minimal"'):
        stretched(replace(item, settings=Settings(formulation="augmented")), "wheeler")
