"""Catenary lines: closed forms, published stiffness, and floats that swing on them, by another integrator too."""

from dataclasses import replace
from math import inf
from types import SimpleNamespace

import numpy as np
import pytest
from pytest import approx
from scipy.integrate import quad, solve_ivp

from solver.catenary import ends, tensions
from solver.coupled.boundary import coefficients
from solver.coupled.equilibrium import balance
from solver.coupled.linear import linear_model
from solver.coupled.preparation import prepare
from solver.errors import InputError, SimulationFailed
from solver.mooring import Line, line_loads, line_stiffness
from solver.run import simulate
from solver.scene import DOFS, Float, Platform, Scene, Water
from solver.scene.arrangement import lines_mirrored
from solver.structure.frame import Frame
from solver.structure.members import Member
from solver.structure.sections import tube
from tests import awkward
from tests.coupled.test_mooring import LEVEL, TURNING, M, dry, floating


def fan(count=3, turn=0.0, **line):
    """Lines of the OC3-Hywind spar (Jonkman 2010), or others, evenly round a float."""
    given = {"length": 902.2, "weight": 698.094, "EA": 384.243e6} | line
    for angle in turn + 2 * np.pi * np.arange(count) / count:
        c, s = np.cos(angle), np.sin(angle)
        yield Line(anchor=(853.87 * c, 853.87 * s, -320.0), fairlead=(5.2 * c, 5.2 * s, -70.0), **given)


# Three lines that differ, none opposite another.
UNLIKE = (
    Line(anchor=(60.0, 8.0, -20.0), fairlead=(0.8, 0.2, -0.5), length=66.0, weight=90.0, EA=5e5),
    Line(anchor=(-30.0, 45.0, -20.0), fairlead=(-0.5, 0.6, -0.3), length=58.5, weight=60.0, EA=2e5),
    Line(anchor=(-25.0, -50.0, -20.0), fairlead=(-0.4, -0.7, -0.6), length=62.0, weight=120.0, EA=8e5),
)


@pytest.mark.parametrize("scope", [0.3, 1.7])  # of the line's weight that the fairlead carries
def test_a_line_is_the_elastic_catenary(scope):
    """dx/ds = H/T + H/EA, dz/ds = T_v/T + T_v/EA, T² = H² + T_v², T_v = V - w (L - s) and not below 0: integrated."""
    L, w, EA, H = 120.0, 80.0, 4e5, 6e3
    V = scope * w * L

    def along(part):
        return quad(part, 0, L, points=[max(0.0, L - V / w)], epsabs=1e-10)[0]

    def up(s):
        return max(0.0, V - w * (L - s))

    span = along(lambda s: H / np.hypot(H, up(s)) + H / EA)
    height = along(lambda s: up(s) / np.hypot(H, up(s)) + up(s) / EA)
    assert ends(H, V, L, w, EA)[:2] == approx((span, height), rel=1e-9)
    assert tensions(span, height, L, w, EA) == approx((H, V), rel=1e-9)


def test_limits_of_a_line():
    """Without weight a spring; hardly elastic, the catenary of which √(z² + 2zH/w) is lifted; slack, it hangs."""
    assert np.hypot(*tensions(30.0, 40.0, 49.0, 1e-6, 1e5)) == approx(1e5 * (50 / 49 - 1), rel=1e-6)
    H, w, z = 2e3, 50.0, 30.0
    lifted = np.sqrt(z**2 + 2 * z * H / w)
    span = 100.0 - lifted + H / w * np.arccosh(1 + z * w / H)
    assert tensions(span, z, 100.0, w, 1e13) == approx((H, w * lifted), rel=1e-5)
    assert tensions(60.0, z, 100.0, w, 1e13) == approx((0.0, w * z), rel=1e-6)
    assert tensions(60.0, z, 100.0, w, 1e22) == approx((0.0, w * z), rel=1e-12)
    assert tensions(100.0 - lifted + H / w * np.arccosh(1 + z * w / H), z, 100.0, w, 1e20) == approx((H, w * lifted))


def test_every_span_and_height_has_its_tensions():
    rng, worst = np.random.default_rng(0), 0.0
    for _ in range(3000):
        L, w = 10 ** rng.uniform(0.5, 3.3), 10 ** rng.uniform(0, 4)
        EA, height = w * L * 10 ** rng.uniform(0.5, 6), L * 10 ** rng.uniform(-3, -0.01)
        span = np.sqrt(L**2 - height**2) * rng.uniform(0.01, 1.1)
        H, V = tensions(span, height, L, w, EA)
        if H:
            worst = max(worst, *np.abs(np.subtract(ends(H, V, L, w, EA)[:2], (span, height))) / L)
    assert worst < 1e-10


def test_the_spars_lines_are_as_published():
    """Jonkman (2010), NREL/TP-500-47535, equation 5-3: load and stiffness of OC3-Hywind's lines at rest."""
    lines = tuple(fan())
    assert line_loads(lines, np.zeros(3)) == approx([0, 0, -1.607e6, 0, 0, 0], rel=5e-4, abs=1e-3)
    K = np.diag([41180.0, 41180.0, 11940.0, 3.111e8, 3.111e8, 1.156e7])
    K[0, 4] = K[4, 0] = -2.816e6
    K[1, 3] = K[3, 1] = 2.816e6
    ours = line_stiffness(lines, np.zeros(3))
    size = np.sqrt(np.outer(np.diag(K), np.diag(K)))
    assert np.abs((ours - K) / size).max() < 1.1e-3
    turned = line_stiffness(tuple(fan(turn=0.4)), np.zeros(3))  # three even lines are alike in all directions
    assert np.abs((turned - ours) / size).max() < 1e-6


def test_the_stiffness_of_lines_is_the_sum_of_each_ones():
    """Whose differences are by its own length: of a short line beside one of two kilometres, too."""
    short = Line(anchor=(8.0, 1.0, -6.0), fairlead=(0.5, 0.2, -0.5), length=9.35, weight=90.0, EA=5e5)
    long = Line(anchor=(-1700.0, 100.0, -600.0), fairlead=(-0.5, 0.0, -0.5), length=1805.0, weight=60.0, EA=5e8)
    each = [line_stiffness((line,), np.zeros(3)) for line in (short, long)]
    assert line_stiffness((short, long), np.zeros(3)) == approx(each[0] + each[1], rel=1e-12)
    assert each[0][:3, :3] == approx(each[0][:3, :3].T, rel=1e-5, abs=1e-6 * each[0][0, 0])


def test_the_march_feels_the_same_lines_as_statics():
    """Force and moment of lines that differ, all six, of what the assembled scene has more with them than without."""
    with_, without = (prepare(dry(floating(motion=DOFS, lines=lines)), None) for lines in (UNLIKE, ()))
    still = np.zeros(6)
    wrench = np.subtract(*(balance(system.bodies, still)[1][0] for system in (with_, without)))
    ours = line_loads(UNLIKE, still[:3])
    assert wrench == approx(ours, rel=1e-9) and np.abs(ours).min() > 1.0
    assert with_.scene.floats[0].pulls == approx(ours, rel=1e-12)


def test_a_float_swings_as_far_as_its_lines_let_it():
    """Let go by metres, so that lines go slack and taut, against another integrator of the same loads."""
    item = replace(floating(lines=UNLIKE), offset=(3.0, -2.0, 0.1))
    scene = replace(dry(item, seconds=6.0), water=Water(depth=20.0))
    record = simulate(scene)
    times, motion = record.series["time"][1], record.series["motion"][1][:, 0]
    system = prepare(scene, None)
    z0 = system.equilibrium[0]

    def rate(_, y):
        (x, v, a), R = y[:3], np.eye(3)
        R[:2, :2] = [[np.cos(a), -np.sin(a)], [np.sin(a), np.cos(a)]]
        turned = tuple(replace(line, fairlead=tuple((R @ line.fairlead).tolist())) for line in UNLIKE)
        load = line_loads(turned, np.array([x, v, 0.0]))
        return [*y[3:], load[0] / M, load[1] / M, load[5] / TURNING]

    start = [*(z0 + np.array([3.0, -2.0, 0.1])), 0.0, 0.0, 0.0]
    exact = solve_ivp(rate, (0, 6.0), start, t_eval=times, rtol=1e-6, atol=1e-7).y[:3].T
    assert np.abs(exact).max() > 2.5 and np.abs(motion - exact).max() < 1e-3 * np.abs(exact).max()
    assert record.attrs["energy_residual"] < 1e-4
    tension = record.series["line_tension"][1]
    assert list(record.coords["line"]) == ["ball 1", "ball 2", "ball 3"] and tension.min() > 0
    K = line_stiffness(UNLIKE, np.array([*z0[:2], 0.0]))[np.ix_([0, 1, 5], [0, 1, 5])]
    # Turned by the lines' own moment, as K is not.
    assert linear_model(system).stiffness[:2, :2] == approx(K[:2, :2], abs=1e-3 * K[0, 0])


def test_both_methods_tell_the_tensions_of_a_moored_barge():
    """The awkward barge on two lines, in small waves: off the middle, one line taut and one slack."""
    whole, h = awkward.soft_mooring()
    barge = replace(
        whole.floats[0], stiffness=0.0,
        lines=(
            Line(anchor=(-90.0, 0.0, -50.0), fairlead=(-5.0, 0.0, -0.5), length=105.0, weight=300.0, EA=2e7),
            Line(anchor=(110.0, 0.0, -50.0), fairlead=(5.0, 0.0, -0.5), length=122.0, weight=250.0, EA=2e7),
        ),
    )  # fmt: skip
    small = replace(whole.sea, amplitude=whole.sea.amplitude * 0.1)
    scene = replace(whole, floats=(barge,), sea=small)
    one, other = (
        simulate(replace(scene, settings=replace(scene.settings, method=method)), h).variables
        for method in ("time", "frequency")
    )
    mean, std = 2, 4
    assert one["line_tension"][1][:, mean] == approx(other["line_tension"][1][:, mean], rel=2e-3)
    assert one["line_tension"][1][:, std] == approx(other["line_tension"][1][:, std], rel=0.3)  # of 150 s


@pytest.mark.parametrize(
    ("change", "told"),
    [
        ({"weight": 0.0}, "lines.weight = 0.0: must be > 0"),
        ({"anchor": (60.0, 0.0, -21.0)}, "floats.ball.lines.anchor = .*: must not lie below the seabed"),
        ({"anchor": (60.0, 0.0, 0.0)}, "floats.ball.lines.anchor = .*: must be below the fairlead, at z = -0.5 m"),
    ],
)
def test_what_is_no_line_is_refused(change, told):
    with pytest.raises(InputError, match=told):
        Scene(water=Water(depth=20.0), floats=(floating(lines=(replace(UNLIKE[0], **change),)),))


def test_what_has_no_lines_is_refused():
    with pytest.raises(InputError, match="lines = 3 lines: must be left out: a fixed body"):
        floating(lines=UNLIKE, motion=())
    for name, value, usual in (("accuracy", "reference", "standard"), ("memory", "convolution", "state-space")):
        with pytest.raises(InputError, match=f'lines = 3 lines: catenaries need {name} = "{usual}"$'):
            dry(floating(lines=UNLIKE, motion=LEVEL), **{name: value})
    assert Water(depth=inf)  # in which anchors may be anywhere


def test_a_line_too_taut_for_its_platform_is_told():
    """A float's rest and the platform's, each for the other's, go further apart from round to round."""
    item, h = awkward.unequal_legs()
    taut = Line(anchor=(40.0, 0.0, -25.0), fairlead=(0.0, 0.0, 0.0), length=10.0, weight=100.0, EA=1e7)
    pulled = replace(item, floats=(replace(item.floats[0], lines=(taut,)),))
    with pytest.raises(SimulationFailed, match=r"still move by .* m or rad after 100 rounds; .* too taut a line"):
        prepare(pulled, h).start()


def test_a_line_that_is_not_mirrored_takes_its_platform_out_of_the_plane():
    """As in waves that are a hair off; two that are each other's image pull it nowhere."""
    leg = Member(
        name="leg", start="foot", end="top", elements=2, section=tube(0.6, 0.02), material=awkward.STEEL,
        drag_coefficient=1.0, inertia_coefficient=2.0,
    )  # fmt: skip
    frame = Frame(nodes={"foot": (0, 0, -25.0), "top": (0, 0, 3.0)}, members=(leg,), clamped=("foot",))
    platform = Platform(frame=frame, legs=("leg",), hinge_nodes={"float": "top"})
    pair = [
        Line(anchor=(-2.36, 40.0 * side, -25.0), fairlead=(0, 0.5 * side, -0.3), length=48.0, weight=30.0, EA=1e8)
        for side in (1, -1)
    ]

    def aside(lines, heading=0.0):
        item = Float(
            name="float", hull=awkward.BALL, mass=awkward.BUOYED, inertia=(859.0,) * 3, hinge=(0, 0, 3.0),
            arm=(-2.36, 0, -3.0), lines=lines,
        )  # fmt: skip
        given = {"radiation": False, "diffraction": False, "froude_krylov": "linear"}
        whole = awkward.scene([item], depth=25.0, waves=awkward.sea(heading=heading), platform=platform, **given)
        system = prepare(whole, coefficients(whole))
        return whole.planar, system.support.legs.top_displacement(system.equilibrium[1][None])[0, 0, 1]

    (planar, one), (_, off) = aside((pair[0],)), aside((pair[0],), 1e-9)
    assert not planar and one == approx(off, rel=1e-6) and one > 0.01
    assert aside(tuple(pair)) == (True, 0.0)
    for side in (1, -1):  # at 0, 120 and 240 degrees, mirrored but for rounding; or the last at 200
        turned = [np.array([np.cos(a), np.sin(a)]) for a in np.radians([0.0, 120.0, 220.0 + 20 * side])]
        three = [replace(pair[0], anchor=(*(40 * at), -25.0), fairlead=(*(0.5 * at), -0.3)) for at in turned]
        assert lines_mirrored([SimpleNamespace(lines=three)]) == (side == 1)
