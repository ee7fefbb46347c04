"""What is put out along the legs, against displacements and section forces of the frame itself."""

from dataclasses import replace

import numpy as np
import pytest
from pytest import approx

from solver.coupled import support
from solver.errors import InputError
from solver.sea.field import WaveField
from solver.statistics import Statistics
from solver.structure import recovery, statics, water
from solver.structure.legs import BENDING, _relieve, at_nodes, compressive

LEGS = ["leg1", "leg2", "leg3", "leg4"]


def prepared(buan, planar=True, **changes):
    return support.reduce_platform(
        replace(buan.platform(), **changes), WaveField(buan.sea(), 50.0, 9.81), buan.water,
        ("hinge:front", "hinge:rear"), planar=planar, modes=6, stations=2,
    )  # fmt: skip


def test_planar_scenes_compute_two_of_four_legs(buan):
    legs = prepared(buan).legs
    assert legs.twin.tolist() == [0, 0, 1, 1] and legs.mirrored.tolist() == [False, True, False, True]
    assert prepared(buan, planar=False).legs.twin.tolist() == [0, 1, 2, 3]


def even(frame):
    return frame


def uneven(frame):
    """The rear legs stand 20 m higher."""
    return replace(frame, nodes={**frame.nodes, "foot3": (1.5, 1.2, -30.0), "foot4": (1.5, -1.2, -30.0)})


def downward(frame):
    """They also have fewer elements, and run from the top down."""
    rear = {m.name: replace(m, start=m.end, end=m.start, elements=2) for m in frame.members if m.name in LEGS[2:]}
    return replace(uneven(frame), members=tuple(rear.get(m.name, m) for m in frame.members))


def finned(frame):
    """Legs stiffer in one plane than in the other."""
    legs = [m for m in frame.members if m.name in LEGS]
    finned = {m.name: replace(m, section=replace(m.section, Iz=2 * m.section.Iz)) for m in legs}
    return replace(frame, members=tuple(finned.get(m.name, m) for m in frame.members))


def laden(frame):
    """A static load over one leg only, which moves nothing."""
    first, *others = frame.loads
    return replace(frame, loads=(replace(first, force=(0.0, 0.0, -1e6)), *others))


@pytest.mark.parametrize("make", [even, uneven, downward, finned, laden])
def test_tops_feet_and_envelopes_are_those_of_the_whole_frame(buan, make):
    """Fibre stress N/A ± c ((My/Iy)² + (Mz/Iz)²)^½ of static and moving section forces, of each sample at each node."""
    frame = make(buan.frame())
    s, platform = prepared(buan, frame=frame), buan.platform(frame=frame)
    model, at_rest, _ = support.dynamic_model(platform, buan.water)
    p = np.random.default_rng(0).normal(size=(7, s.omega.size)) * 100.0
    moved = p @ s.shapes.T
    gravity, density = buan.water.gravity, buan.water.density
    loads = statics.self_weight(model, gravity) + water.buoyancy(model, density, gravity)
    still = recovery.section_forces(model, at_rest, loads).reshape(-1, 2, 6)
    moving = (moved @ recovery.section_force_matrix(model).T).reshape(len(p), -1, 2, 6)
    force = (still + moving)[..., BENDING]
    A, Iy, Iz, c = np.moveaxis(recovery.section_properties(model).reshape(-1, 2, 4), -1, 0)
    # What the feet bear besides, as loads within their elements do: a tenth more.
    foot = s.forces.places.wanted.end[::3]
    at_feet = 1.1 * (force * np.stack([1 / A, c / Iy, c / Iz], axis=-1)).reshape(len(p), -1, 3)[:, foot]
    largest = s.legs.nothing()
    for at in (slice(3), slice(3, None)):
        s.legs.enlarge(largest, p[at], at_feet[at], np.ones(len(p[at]), bool))
    tops, feet = s.legs.top_displacement(p), compressive(at_feet)
    displacement, stress = s.legs.envelopes(largest)
    bending = c * np.hypot(force[..., 1] / Iy, force[..., 2] / Iz)
    least, size = force[..., 0] / A - bending, np.abs(force[..., 0] / A) + bending
    for sigma in (least, size):
        sigma.reshape(len(p), -1)[:, foot] *= 1.1
    for leg, name in enumerate(platform.legs):
        nodes, fibres = model.member_nodes[name], np.stack([least, size])[:, :, model.member_elements[name]]
        if model.xyz[nodes[0], 2] > model.xyz[nodes[-1], 2]:
            nodes, fibres = nodes[::-1], fibres[..., ::-1, ::-1]
        u = moved.reshape(len(p), -1, 6)[:, nodes, :3]
        assert tops[:, leg] == approx(u[:, -1], rel=1e-9, abs=1e-9 * np.abs(u).max())
        assert feet[:, leg] == approx(fibres[0, :, 0, 0], rel=1e-9)
        here = ~np.isnan(displacement[leg])
        assert s.legs.height[here] == approx(model.xyz[nodes, 2] - model.xyz[nodes[0], 2], abs=1e-9)
        assert displacement[leg, here] ** 2 == approx(highest(np.sum(u**2, axis=2)), rel=1e-9)
        assert displacement[leg, 0] == 0 < displacement[leg, here][-1]  # clamped at the foot
        most = at_nodes(highest(fibres[1].reshape(len(p), -1)).reshape(fibres.shape[2:]))
        assert stress[leg, here] == approx(most, rel=1e-9) and np.isnan(stress[leg, ~here]).all()


def test_a_leg_that_does_not_rise_is_refused(buan):
    with pytest.raises(InputError, match=r"platform\.legs = top1 top3: must rise"):
        prepared(buan, legs=("leg1", "top1 top3"))


def relieved(parts, smooth=True, cut=None):
    """Largest stress of most compressive fibres by samples (m, n, 3), taken in at once, or in two blocks."""
    most, last = np.full(parts.shape[1], -np.inf), np.full((2, *parts.shape[1:]), np.nan)
    for block in np.split(parts, [] if cut is None else [cut]):
        room = np.concatenate([last, block])
        _relieve(room, np.full(len(block), smooth), most)
        last = room[-2:]
    return most


def swaying(t, phase, across):
    """N/A, and a moment that goes to and fro, or round, in an ellipse that is `across` wide, both with the waves."""
    return np.stack([-5 + 0.3 * np.cos(t + 1), np.cos(t + phase), across * np.sin(t + phase)], axis=-1)


@pytest.mark.parametrize("across", [0.0, 0.05, 0.5, 1.0])
def test_fibres_are_relieved_as_much_between_samples(across):
    """Thirty-two samples a period, wherever they lie: the least of those misses the corner by up to 0.08."""
    step, phases = 2 * np.pi / 32, np.linspace(0, 2 * np.pi, 97)
    dense = np.linspace(0, 2 * np.pi, 20_001)
    exact = np.array([compressive(swaying(dense, phase, across)).max() for phase in phases])
    parts = np.stack([swaying(step * np.arange(67), phase, across) for phase in phases], axis=1)
    assert relieved(parts) == approx(exact, abs=3e-4)
    assert np.array_equal(relieved(parts, cut=23), relieved(parts))
    assert relieved(parts[:1]) == approx(compressive(parts[0]), rel=1e-14)
    assert relieved(parts, smooth=False) == approx(compressive(parts).max(axis=0), rel=1e-14)
    misses = (compressive(parts).max(axis=0), highest(compressive(parts))) - exact
    if across == 0.0:
        assert misses.min() < -0.08 and misses.max() > 4e-3


def test_no_fibre_is_relieved_of_more_than_the_axial_force():
    """That is constant where a column stands by itself; parabolas through its stress go beyond."""
    t = 0.5 * np.arange(400)[:, None] + np.linspace(0, 0.5, 20)
    parts = np.stack([np.full(t.shape, -1.0), np.cos(t) + 0.5 * np.cos(2.7 * t), np.zeros(t.shape)], axis=-1)
    assert np.all(relieved(parts) <= -1.0) and relieved(parts) == approx(-1.0, abs=1e-5)
    assert highest(compressive(parts)).max() > -0.99


def test_a_leg_in_tension_has_its_largest_stress_where_bending_adds_to_that(buan):
    """And its most compressive fibre is none of less than the axial force. Both may be between blocks."""
    s = prepared(buan)
    t = 0.5 * np.arange(10) + 0.2
    feet = np.zeros((t.size, 4, 3))
    feet[..., 0], feet[..., 1] = 1e9, 9e8 * np.cos(t)[:, None]
    for cut in range(1, t.size):
        largest = s.legs.nothing()
        for at in (slice(cut), slice(cut, None)):
            s.legs.enlarge(largest, np.zeros((t[at].size, s.omega.size)), feet[at], np.ones(t[at].size, bool))
        _, stress = s.legs.envelopes(largest)
        assert stress[:, 0] == approx(highest(feet[..., 0] + np.abs(feet[..., 1])), rel=1e-12)
        assert largest.relieved == approx(relieved(feet)[s.legs.first], rel=1e-12)
    assert largest.relieved.min() > compressive(feet).max() + 1e7


def highest(samples):
    """Largest value of each channel, as statistics have it."""
    statistics = Statistics()
    statistics.add(samples)
    return statistics.table()[:, 0]
