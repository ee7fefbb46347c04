"""A current past the members, and loads that go with time: closed forms, balance, both domains."""

from dataclasses import replace

import numpy as np
import pytest
from pytest import approx

from solver.coupled import linear_drag, support, surroundings
from solver.coupled.blocks import blocks, energy_residual
from solver.coupled.energy import AT_START, WORKS, energy
from solver.coupled.preparation import prepare
from solver.errors import InputError
from solver.record.steel import Steel
from solver.run import simulate
from solver.scene import Platform, Scene, Settings, Water
from solver.sea.current import Current, CurrentSpeed
from solver.sea.realization import CALM, components, ramp
from solver.structure import water
from solver.structure.frame import Frame
from solver.structure.load_history import LoadHistory
from solver.structure.members import MarineGrowth, Material, Member, PointLoad, PointMass
from solver.structure.sections import tube
from tests.awkward import bare_legs, sea, unequal_legs

STEEL = Material(E=2.1e11, G=8e10, density=7850.0)
FLOW = Current(profile=(CurrentSpeed(depth=0.0, speed=1.1), CurrentSpeed(depth=20.0, speed=0.5)), direction=2.0)


def pile(current, waves=CALM, histories=(), **settings) -> Scene:
    """D = 0.8 m, 25 m tall, 20 m of it in water; legs 0.5 %."""
    leg = Member(
        name="pile", start="foot", end="top", elements=4, section=tube(0.8, 0.02), material=STEEL,
        drag_coefficient=1.1, inertia_coefficient=2.0,
    )  # fmt: skip
    frame = Frame(nodes={"foot": (0, 0, -20.0), "top": (0, 0, 5.0)}, members=(leg,), clamped=("foot",))
    chosen = {"duration": 20.0, "discard": 0.0, "ramp": 0.0, "outputs": ("reactions",)} | settings
    return Scene(
        water=Water(depth=20.0), sea=waves, current=current, settings=Settings(**chosen),
        platform=Platform(frame=frame, legs=("pile",), load_histories=tuple(histories), damping_ratio=0.005),
    )  # fmt: skip


def wind(node="deck", end=400.0, step=2.0, size=(3e4, -2e4, 5e3), seed=0):
    """A mean and gusts."""
    time = np.arange(0.0, end + step, step)
    gusts = 1 + 0.5 * np.random.default_rng(seed).uniform(-1, 1, time.size)
    return LoadHistory(node=node, time=time, force=gusts[:, None] * np.array(size))


def test_speeds_by_depth():
    z = np.array([0.0, -5.0, -20.0, -30.0])
    power = Current(speed=2.0, exponent=1 / 7, direction=np.pi / 2).velocity(z[:3], 20.0)
    assert power[:, 1] == approx(2.0 * np.array([1.0, 0.75, 0.0]) ** (1 / 7))
    assert power[:, 0] == approx(np.zeros(3), abs=1e-15)
    table = FLOW.velocity(z, 30.0)
    assert np.linalg.norm(table, axis=1) == approx([1.1, 0.95, 0.5, 0.5])
    assert table[:, 1] / table[:, 0] == approx(np.full(4, np.tan(2.0)))
    assert Current(speed=0.7).velocity(z, np.inf)[:, 0] == approx(np.full(4, 0.7))


@pytest.mark.parametrize(
    ("given", "message"),
    [
        ({}, r"current\.speed = nothing: is missing"),
        ({"speed": -1.0}, r"current\.speed = -1\.0: must be >= 0 m/s"),
        ({"speed": 1.0, "profile": FLOW.profile}, r"current\.speed = 1\.0: must be left out beside profile"),
        ({"profile": FLOW.profile[::-1]}, r"current\.profile\[1\]\.depth = 0\.0: must be > 20 m"),
        ({"profile": (CurrentSpeed(depth=-1.0, speed=1.0),)}, r"current\.profile\[0\]\.depth = -1\.0: must be >= 0 m"),
        ({"speed": 1.0, "direction": 90.0}, r"current\.direction = 90\.0: must be <= 6\.28319 rad"),
    ],
)
def test_bad_currents_are_refused(given, message):
    with pytest.raises(InputError, match=message):
        Current(**given)


def test_what_takes_no_current_or_load_is_refused():
    item, still = bare_legs()[0], pile(None)
    with pytest.raises(InputError, match=r"current = given: acts on the members of an elastic platform"):
        replace(item, platform=None, current=FLOW)
    with pytest.raises(InputError, match=r"current.exponent = 0.1: needs water of finite depth"):
        replace(item, water=Water(depth=np.inf), current=Current(speed=1.0, exponent=0.1))
    for current, loads in ((FLOW, ()), (None, (wind(),))):
        platform = replace(item.platform, load_histories=loads)
        with pytest.raises(InputError, match=r'= given: needs formulation = "minimal"'):
            replace(item, current=current, platform=platform, settings=Settings(formulation="augmented"))
    frequency = Settings(method="frequency", froude_krylov="linear")
    with pytest.raises(InputError, match=r'load_histories\.deck = given: needs method = "time"'):
        replace(item, platform=replace(item.platform, load_histories=(wind(),)), settings=frequency)
    with pytest.raises(InputError, match=r"deck\.time = 0 to 10 s: must last from 0 to 250 s, the end of the run"):
        replace(item, platform=replace(item.platform, load_histories=(wind(end=10.0),)))
    with pytest.raises(InputError, match=r"load_histories\[0\]\.node = keel: must be one of foot, top"):
        replace(still.platform, load_histories=(wind("keel"),))
    with pytest.raises(InputError, match=r"load_histories\.top\.time = 1: must be > 1 s, the one before"):
        LoadHistory(node="top", time=np.array([0.0, 1.0, 1.0]), force=np.zeros((3, 3)))


def test_a_pile_in_a_current_alone_rests_as_a_cantilever():
    """qa³(4L - a)/24EI at the top under q = ½ρC_D D U² over the wetted a of L; it has no reason to move."""
    record = simulate(pile(Current(speed=1.4, direction=0.6)))
    q, section = 0.5 * 1025.0 * 1.1 * 0.8 * 1.4**2, tube(0.8, 0.02)
    direction, top = np.array([np.cos(0.6), np.sin(0.6), 0.0]), q * 20.0**3 * (100 - 20) / (24 * STEEL.E * section.Iy)
    high, low, mean, *_ = record.variables["top_displacement"][1][0].T
    assert mean == approx(top * direction, rel=1e-9, abs=1e-12)
    assert high - low == approx(np.zeros(3), abs=1e-9 * top)
    shear, moment = (record.variables[name][1][:, 2] for name in ("base_shear", "overturning_moment"))
    assert shear[:2] == approx(q * 20.0 * direction[:2])
    assert np.linalg.norm(moment[:2]) == approx(q * 20.0**2 / 2)


@pytest.mark.parametrize(
    ("current", "rel"),
    [
        (
            Current(
                profile=tuple(CurrentSpeed(depth=d, speed=u) for d, u in ((0, 1.5), (2, 1.5), (2.5, 0.3), (20, 0.1)))
            ),
            1e-8,
        ),
        (Current(speed=1.5, exponent=1 / 7), 1e-3),  # no polynomial
        (Current(speed=1.5, exponent=8.0), 1e-8),
    ],
)
@pytest.mark.parametrize("elements", [1, 4])
def test_a_current_sheared_between_stations_pushes_with_all_that_it_has(current, rel, elements):
    """∫ U² dz and ∫ U² (z + d) dz, however few elements there are and wherever its table bends."""
    scene = pile(current)
    (leg,), frame = scene.platform.frame.members, scene.platform.frame
    frame = replace(frame, members=(replace(leg, elements=elements),))
    record = simulate(replace(scene, platform=replace(scene.platform, frame=frame)))
    z = np.linspace(-20.0, 0.0, 200_001)
    q = 0.5 * 1025.0 * 1.1 * 0.8 * np.linalg.norm(current.velocity(z, 20.0), axis=1) ** 2
    shear, moment = (record.variables[name][1][:, 2] for name in ("base_shear", "overturning_moment"))
    assert shear[0] == approx(np.trapezoid(q, z), rel=rel)
    assert moment[1] == approx(np.trapezoid(q * (z + 20.0), z), rel=rel)


def test_a_frame_let_go_in_waves_feels_their_drag_at_once():
    """Without a ramp, with no current: the march goes on from the start's accelerations."""
    system = prepare(pile(None, sea(Hs=2.0, Tp=6.0, band=(0.5, 2.0)), time_step=1e-4), None)
    state = system.start()
    began, drag = state.ddp.copy(), system.drag_at_rest(system.drive(system.rows.sum(axis=1).real[None]))
    _, output, _ = next(blocks(system, state, 1))
    size = np.abs(began).max()
    assert np.abs(drag).max() > 0.1 * size
    assert output.ddp[0] == approx(began, abs=0.01 * size)


def marched(item, h):
    """The system, its steel, samples, output and forces of a block in the time domain."""
    settings = replace(item.settings, outputs=("reactions", "section_forces", "fibre_stress"), time_step=0.1)
    system = prepare(replace(item, settings=settings), h)
    steel = Steel(system.support.forces, system.scene.settings)
    *_, (samples, output, times) = blocks(system, system.start(), 512)
    parts = output.dp, output.ddp, output.carried, output.drag
    return system, steel, output, steel.forces.of(samples[:, system.layout.forces], *parts), times


def test_reactions_balance_all_that_acts():
    """Forces and moments about the origin, each by sums of what acts and none by the frame's stiffness.

    Waves, a current, loads that go with time, wind along the members, weight, buoyancy, growth: on unequal legs, not
    planar, at every sample.
    """
    item, _ = bare_legs()
    frame = item.platform.frame
    members = tuple(replace(m, distributed_load=(30.0 + i, -20.0, 5.0 * i)) for i, m in enumerate(frame.members))
    growth = (
        MarineGrowth(depth=0.0, thickness=0.12, density=1325.0),
        MarineGrowth(depth=9.0, thickness=0.04, density=1250.0),
    )
    frame = replace(frame, members=members, growth=growth, loads=(PointLoad(node="deck", force=(2e4, -3e4, -1e5)),))
    platform = replace(
        item.platform, frame=frame, load_histories=(wind(), wind("hinge:float", size=(0.0, 0.0, -4e4), seed=1))
    )
    system, steel, output, y, times = marched(replace(item, current=FLOW, platform=platform), None)
    ocean = system.scene.water
    model, _, _ = support.dynamic_model(platform, ocean)
    at = water.stations(model, water.EXACT, support.INERTIA / system.waves.k.max())
    turn = np.exp(-1j * np.outer(times, system.scene.sea.omega)) * ramp(times, system.scene.settings.ramp)[:, None]
    size = surroundings.inertia_size(platform, at, ocean)
    pushed = size[:, None, None] * -1j * system.scene.sea.omega * surroundings.normal_flow(at, system.waves) @ turn.T
    total = about_origin(at.position, pushed.real.transpose(2, 0, 1))
    bends = water.Splash(bends=FLOW.bends)
    drags = water.stations(model, FLOW.points, support.DRAG * system.waves.mean_length, bends)
    total += about_origin(drags.position, output.drag.transpose(0, 2, 1))
    for history in platform.load_histories:
        total += about_origin(model.xyz[[model.node_index[history.node]]], history.at(times)[:, None])
    rigid = np.zeros((len(model.xyz), 6, 6))
    rigid[:, :3, :3] = rigid[:, 3:, 3:] = np.eye(3)
    rigid[:, :3, 3:] = np.cross(np.eye(3), model.xyz[:, None]).transpose(0, 2, 1)
    M = model.M + water.added_mass(model, ocean.density)
    total -= output.ddp @ system.support.shapes.T @ (M @ rigid.reshape(-1, 6))
    load = water.static_load(model, ocean.density, ocean.gravity).reshape(-1, 6)
    total += about_origin(model.xyz, load[None, :, :3])
    total[:, 3:] += load[:, 3:].sum(axis=0)
    reactions = (y + steel.forces.at_rest)[:, steel.places.columns.reactions]
    of_feet = about_origin(steel.places.foot, reactions[..., :3])
    total += of_feet
    total[:, 3:] += reactions[..., 3:].sum(axis=1)
    assert np.abs(total / np.abs(of_feet).max(axis=0)).max() < 1e-9
    # What the drag is: of water past the moving stations.
    u = (surroundings.normal_flow(drags, system.waves) @ turn.T).real + surroundings.normal_stream(drags, system.waves)[
        ..., None
    ]
    v = np.einsum("skm,tm->skt", system.support.station_shape, output.dp)
    drag = surroundings.drag_size(drags, ocean)[:, None, None] * np.linalg.norm(u - v, axis=1, keepdims=True) * (u - v)
    assert output.drag == approx(drag.transpose(2, 1, 0), abs=1e-3 * np.abs(drag).max())


def about_origin(position, force):
    """(m, 6) force and moment about the origin of forces (m, ns, 3) at positions (ns, 3)."""
    return np.concatenate([force.sum(axis=1), np.cross(position, force).sum(axis=1)], axis=1)


def test_energy_balances_in_a_current_and_under_loads_that_work():
    """Drag of the current and the loads' work, each of them large, are in the audit."""
    item, h = unequal_legs()
    platform = replace(item.platform, load_histories=(wind(size=(3e5, 1e5, 0.0)),), damping_ratio=0.01)
    settings = replace(item.settings, duration=40.0, discard=0.0, ramp=10.0)
    record = simulate(replace(item, current=FLOW, platform=platform, settings=settings), h)
    attrs = record.attrs
    assert attrs["energy_residual"] < 1e-3
    still = simulate(replace(item, settings=settings), h).attrs
    assert abs(attrs["work_frame_inertia"]) > 2 * abs(still["work_frame_inertia"])
    assert abs(attrs["work_frame_drag"]) > 2 * abs(still["work_frame_drag"])


def test_a_slow_load_moves_the_frame_statically():
    """Straight up and down again in a minute: displacement is the load's share of its static one, both ways."""
    time, force = np.array([0.0, 30.0, 60.0]), np.array([[2e4, 0, 0], [8e4, 0, 0], [2e4, 0, 0]])
    item = pile(
        None,
        histories=(LoadHistory(node="top", time=time, force=force),),
        duration=60.0,
        keep_series=True,
        time_step=0.05,
        modes=1,
    )
    record = simulate(item)
    times, top = record.series["time"][1], record.series["top_displacement"][1][:, 0, 0]
    static = 25.0**3 / (3 * STEEL.E * tube(0.8, 0.02).Iy)
    assert top == approx(static * np.interp(times, time, force[:, 0]), abs=0.01 * static * 8e4)
    assert top[0] == approx(static * 2e4, rel=2e-2)  # where it was let go


def test_bends_at_whole_steps_leave_the_order_of_the_integrator():
    """In steps that follow all of the modes that the bends set swinging."""
    time = np.array([0.0, 0.4, 0.8, 1.2, 20.0])
    force = np.array([0.0, 1.0, -0.5, 0.7, 0.0])[:, None] * np.array([5e4, 0, 0])
    ends = []
    for dt in (0.004, 0.002, 0.001):
        item = pile(None, histories=(LoadHistory(node="top", time=time, force=force),), time_step=dt, modes=1)
        system = prepare(item, None)
        *_, (_, output, _) = blocks(system, system.start(), round(2.0 / dt))
        ends.append(output.p[-1] @ system.support.shapes[6 * 1])
    coarse, fine = np.abs(np.diff(ends))
    assert np.log2(coarse / fine) == approx(4.0, abs=0.3)


def test_a_mean_flow_along_a_line():
    """Against ⟨|u|u⟩ and ⟨2|u|⟩ of many normal numbers' quantiles; still water is the case without a mean."""
    from scipy.stats import norm

    x = norm.ppf((np.arange(400_000) + 0.5) / 400_000)
    for mean, std in ((0.8, 0.5), (-0.2, 0.6), (2.0, 0.1)):
        mean_drag, slope = linear_drag.in_stream(np.array([mean]), np.array([[std**2]]))
        u = mean + std * x
        assert mean_drag == approx([np.mean(np.abs(u) * u)], rel=1e-4)
        assert slope == approx(np.array([[2 * np.mean(np.abs(u))]]), rel=1e-4)
    mean_drag, slope = linear_drag.in_stream(np.zeros(1), np.array([[0.36]]))
    assert mean_drag == approx([0.0]) and slope == approx(linear_drag.of_gaussian(np.array([[0.36]])))


@pytest.mark.parametrize("tangent", [(0.0, 0.0, 1.0), (0.3, -0.2, 0.93)])
@pytest.mark.parametrize(
    ("mean", "stds", "turned"), [((0.7, 0.4), (0.5, 0.2), 0.4), ((0.1, 0.0), (0.6, 0.0), 1.1), ((0.9, 0.2), (0, 0), 0)]
)
def test_a_mean_flow_in_a_plane(mean, stds, turned, tangent):
    """Against a grid of quantiles in the plane across a member; K is the slope of F by the mean (Stein's lemma)."""
    from scipy.stats import norm

    across = np.linalg.svd(np.array([tangent]))[2][1:]  # (2, 3)
    axes = np.array([[np.cos(turned), np.sin(turned)], [-np.sin(turned), np.cos(turned)]]) @ across
    S, U = axes.T @ np.diag(np.square(stds)) @ axes, np.array(mean) @ across
    mean_drag, slope = linear_drag.in_stream(U, S)
    x = norm.ppf((np.arange(600) + 0.5) / 600)
    u = U + np.stack(np.meshgrid(x, x), axis=-1).reshape(-1, 2) * np.array(stds) @ axes
    size = np.linalg.norm(u, axis=1)
    assert mean_drag == approx((size[:, None] * u).mean(axis=0), abs=2e-3 * size.mean() ** 2)
    exact = size.mean() * np.eye(3) + np.einsum("n,ni,nj->ij", 1 / size, u, u) / size.size
    assert slope @ across.T == approx(exact @ across.T, abs=3e-3 * size.mean())
    step = 1e-4
    for e in across:
        high, low = (linear_drag.in_stream(U + sign * step * e, S)[0] for sign in (1, -1))
        assert slope @ e == approx((high - low) / (2 * step), abs=2e-3 * size.mean())


def test_a_harmonic_in_a_current():
    """u = U + a cos ωt that never turns: F = U² + a²/2 and K = 2U, in one direction."""
    mean_drag, slope = linear_drag.harmonic_in_stream(np.array([1.5]), np.array([0.7 + 0.2j]))
    assert mean_drag == approx([1.5**2 + abs(0.7 + 0.2j) ** 2 / 2]) and slope == approx(np.array([[3.0]]))
    mean_drag, slope = linear_drag.harmonic_in_stream(np.zeros(1), np.array([0.8 + 0j]))
    assert mean_drag == approx([0], abs=1e-12) and slope == approx(linear_drag.of_harmonic(np.array([0.8 + 0j])))


@pytest.mark.parametrize("angle", [0.0, np.pi / 6, 0.7, 0.9])
def test_of_a_flow_in_a_plane_rounding_across_it_changes_nothing(angle):
    """Of an ellipse so narrow K is 8/3π along and half of that across (∂|u|u/∂u of what is out of phase)."""
    e, t = np.array([[np.cos(angle), np.sin(angle)], [-np.sin(angle), np.cos(angle)]])
    turned = np.column_stack([e, t])
    exact = turned @ np.diag([8, 4]) @ turned.T / (3 * np.pi)
    stream = 0.2 * e + 0.1 * t
    mean_drag, of_stream = linear_drag.harmonic_in_stream(stream, e + 1e-4j * t)
    for noise in (1e-5, 1e-7, 3e-8, 1e-9, 1e-15, 0.0):
        for phase in (1j, 1.0, 0.6 + 0.8j):
            U = np.exp(0.4j) * (e + noise * phase * t)
            assert linear_drag.of_harmonic(U) == approx(exact, abs=2e-3)  # phases: 64
            F, K = linear_drag.harmonic_in_stream(stream, U)
            assert approx(mean_drag, abs=2e-5) == F and approx(of_stream, abs=5e-5) == K


LINES = np.array([5, 6, 7, 9, 11, 14, 17]) * 0.11
PHASE = np.arange(7.0) ** 2


def both(height, current, phase=PHASE):
    """Records of the bare legs in both domains, of waves that come back after 57 s."""
    item, _ = bare_legs()
    amplitude = height * np.linspace(1.0, 0.4, LINES.size)
    waves = components(amplitude=amplitude, omega=LINES, phase=phase, heading=0.5)
    period = 2 * np.pi / 0.11
    settings = Settings(
        duration=2 * period, discard=2 * period, ramp=20.0, time_step=period / 400, outputs=("reactions",),
        froude_krylov="linear",
    )  # fmt: skip
    whole = replace(item, sea=waves, current=current, settings=settings)
    return simulate(whole), simulate(replace(whole, settings=replace(settings, method="frequency")))


def test_small_waves_in_a_current_are_linear():
    """Means and stds of both domains agree: drag goes by 2U along the current, U across it."""
    time, frequency = both(0.004, FLOW)
    for name in ("top_displacement", "base_shear", "overturning_moment", "reaction_force", "bottom_stress"):
        a, b = (record.variables[name][1] for record in (time, frequency))
        kind = a[..., 4] > 0.02 * a[..., 4].max()
        assert b[..., 2] == approx(a[..., 2], abs=1e-4 * np.abs(a[..., 2]).max())
        assert b[..., 4][kind] == approx(a[..., 4][kind], rel=3e-3)


def test_waves_in_a_current_push_by_more_than_it_alone():
    """The mean of both domains in waves that turn the flow: half as much again as the current's own.

    Seven waves are not quite Gaussian, and what is of higher order goes with their phases: std to 4 % over six of them.
    """
    current, random = Current(speed=0.4, direction=0.5), np.random.default_rng(0)
    pairs = [both(0.6, current), *(both(0.6, current, random.uniform(0, 2 * np.pi, 7)) for _ in range(5))]
    _, still = both(1e-3, current)
    a, b = (np.array([pair[i].variables["base_shear"][1][:2] for pair in pairs]) for i in (0, 1))
    assert a[0, 0, 2] > 1.5 * still.variables["base_shear"][1][0, 2]
    assert b[0, :, 2] == approx(a[0, :, 2], rel=0.03)
    assert np.linalg.norm(b[..., 4], axis=0) == approx(np.linalg.norm(a[..., 4], axis=0), rel=0.04)
    displaced = [record.variables["top_displacement"][1][0, :2, 2] for record in pairs[0]]
    assert displaced[1] == approx(displaced[0], rel=0.05)


def test_a_float_leans_with_its_platform_in_the_current():
    """The march rests where statics says: nothing moves without waves, with a float on the frame."""
    item, h = unequal_legs()
    settings = Settings(duration=20.0, discard=0.0, ramp=0.0)
    record = simulate(
        replace(item, sea=replace(sea(), amplitude=np.zeros(60, complex)), current=FLOW, settings=settings), h
    )
    high, low, mean, *_ = np.moveaxis(record.variables["top_displacement"][1], -1, 0)
    assert np.abs(mean).max() > 1e-4
    assert np.abs(high - low).max() < 1e-5 * np.abs(mean).max()


def test_strong_drag_in_a_current_is_followed_to_newton_s_tolerance():
    """On thick growth in a stream drag answers within a step what moves the frame by half: evaluated once a step,
    stresses were a quarter off, and its work by rates of before the last iteration left the balance open."""
    item, h = unequal_legs()
    frame = item.platform.frame
    rough = tuple(replace(member, drag_coefficient=12 * member.drag_coefficient) for member in frame.members)
    item = replace(
        item,
        platform=replace(item.platform, frame=replace(frame, members=rough)),
        current=Current(speed=1.5, direction=0.5),
        sea=components(
            amplitude=np.array([0.05]), omega=np.array([2 * np.pi / 3]), phase=np.zeros(1), heading=item.sea.heading
        ),
    )
    each = []
    for tolerance in (1e-5, 1e-9):
        numerics = {"time_step": 0.25, "newton_tolerance": tolerance, "froude_krylov": "linear"}
        lasting = {"duration": 30.0, "discard": 30.0, "ramp": 15.0}
        each.append(simulate(replace(item, settings=replace(item.settings, **lasting, **numerics)), h))
    usual, exact = each
    assert not usual.attrs["repeated"] and usual.attrs["energy_residual"] < 1e-5
    for name in ("bottom_stress", "top_displacement", "rotation"):
        std = usual.variables[name][1][..., -1], exact.variables[name][1][..., -1]
        assert std[0] == approx(std[1], rel=0.01, abs=0.01 * std[1].max())


@pytest.mark.parametrize("method", ["time", "frequency"])
def test_constant_loads_bend_the_frame_statically(method):
    """A cantilever's tip, FL³/3EI + qL⁴/8EI, what its weight less buoyancy shortens it by; motion is from there."""
    item = pile(None, waves=sea(Hs=0.1), method=method, froude_krylov="linear", time_step=0.05)
    frame = item.platform.frame
    leg = replace(frame.members[0], distributed_load=(300.0, 0.0, 0.0))
    loads = (PointLoad(node="top", force=(2e4, -3e4, 0.0)),)
    bent = replace(item, platform=replace(item.platform, frame=replace(frame, members=(leg,), loads=loads)))
    L, section = 25.0, tube(0.8, 0.02)
    EI, EA = STEEL.E * section.Iy, STEEL.E * section.area
    found, plain = (simulate(each).variables for each in (bent, item))
    dims, ((x, y, z),) = found["static_displacement"]
    assert dims == ("leg", "direction")
    assert x == approx(2e4 * L**3 / (3 * EI) + 300 * L**4 / (8 * EI), rel=1e-6)
    assert y == approx(-3e4 * L**3 / (3 * EI), rel=1e-6)
    heaviest = STEEL.density * section.area * 9.81 * L**2 / (2 * EA)
    assert -heaviest < z < -0.8 * heaviest
    assert plain["static_displacement"][1][0, :2] == approx([0, 0], abs=1e-12)
    assert found["top_displacement"][1] == approx(plain["top_displacement"][1], abs=1e-9)


def test_weight_on_top_bends_a_softened_frame_further():
    """FL³/3EI · 3(tan u - u)/u³, u = L(P/EI)^½, of a cantilever that bears P; steel without weight."""
    item, L, EI = pile(None), 25.0, STEEL.E * tube(0.8, 0.02).Iy
    frame, P, F = item.platform.frame, 1.5e6, 1e4
    leg = replace(frame.members[0], material=replace(STEEL, density=1.0), elements=8)
    loads = (PointLoad(node="top", force=(F, 0.0, -P)),)
    stiff = replace(item.platform, frame=replace(frame, members=(leg,), loads=loads))
    plain, soft = (support._static_tops(replace(stiff, geometric_stiffness=s), item.water)[0, 0] for s in (False, True))
    u = L * np.sqrt(P / EI)
    assert plain == approx(F * L**3 / (3 * EI), rel=1e-6)
    assert soft / plain == approx(3 * (np.tan(u) - u) / u**3, rel=1e-2)  # the water lifts the steel by 0.7 % of P


def creeping(speed=1.0):
    """Bent by a current that a slender pile is at rest in, 300 s at a step for which last bits leave it a velocity."""
    section = tube(0.6, 0.012)
    item = pile(Current(speed=speed, exponent=1 / 7), time_step=0.03, duration=300.0)
    frame = item.platform.frame
    leg = replace(frame.members[0], section=section, drag_coefficient=1.2)
    masses = (PointMass(node="top", mass=3000.0),)
    frame = replace(frame, nodes={**frame.nodes, "top": (0.0, 0.0, 2.0)}, members=(leg,), masses=masses)
    return replace(item, platform=replace(item.platform, frame=frame, damping_ratio=0.02))


@pytest.mark.parametrize("speed", [0.9, 1.0, 1.2])
def test_rest_in_a_current_is_no_failure_however_long(speed):
    """The flow works on what rounding lets creep: by less than a last bit of what is bent, each step."""
    record = simulate(creeping(speed))
    attrs, system = record.attrs, prepare(creeping(speed), None)
    bent = 0.5 * np.sum((system.structure.omega * system.equilibrium[1]) ** 2)
    assert attrs["repeated"] == "" and attrs["energy_residual"] < 1e-3
    assert np.abs(attrs["work_frame_drag"]) < np.finfo(float).eps * bent * 10_000


def test_a_small_motion_in_a_current_is_still_audited():
    """Of 1e-5 of what the current bends a pile by, a hundredth of the flow's work is found missing."""
    system = prepare(creeping(), None)
    state, steps = system.start(), 10_000
    state.p[:] *= 1 + 1e-5
    state.energy[AT_START] = energy(system.bodies, system.structure, state)
    for _ in blocks(system, state, steps):
        pass
    stored = energy(system.bodies, system.structure, state)
    assert energy_residual(state.work.copy(), stored, state.energy.copy()) < 1e-3
    missing = state.work * np.where(np.array(WORKS) == "frame_drag", 0.99, 1.0)
    assert energy_residual(missing, stored, state.energy.copy()) > 1e-3
