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
from solver.structure.legs import BENDING, at_nodes, compressive

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
    """Fibre stress N/A - c ((My/Iy)² + (Mz/Iz)²)^½ of static and moving section forces, of each sample at each node."""
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
    sigma = force[..., 0] / A - c * np.hypot(force[..., 1] / Iy, force[..., 2] / Iz)
    sigma.reshape(len(p), -1)[:, foot] *= 1.1
    for leg, name in enumerate(platform.legs):
        nodes, fibres = model.member_nodes[name], sigma[:, model.member_elements[name]]
        if model.xyz[nodes[0], 2] > model.xyz[nodes[-1], 2]:
            nodes, fibres = nodes[::-1], fibres[:, ::-1, ::-1]
        u = moved.reshape(len(p), -1, 6)[:, nodes, :3]
        assert tops[:, leg] == approx(u[:, -1], rel=1e-9, abs=1e-9 * np.abs(u).max())
        assert feet[:, leg] == approx(fibres[:, 0, 0], rel=1e-9)
        here = ~np.isnan(displacement[leg])
        assert s.legs.height[here] == approx(model.xyz[nodes, 2] - model.xyz[nodes[0], 2], abs=1e-9)
        assert displacement[leg, here] ** 2 == approx(highest(np.sum(u**2, axis=2)), rel=1e-9)
        assert displacement[leg, 0] == 0 < displacement[leg, here][-1]  # clamped at the foot
        most = at_nodes(highest(np.abs(fibres).reshape(len(p), -1)).reshape(fibres.shape[1:]))
        assert stress[leg, here] == approx(most, rel=1e-9) and np.isnan(stress[leg, ~here]).all()


def test_a_leg_that_does_not_rise_is_refused(buan):
    with pytest.raises(InputError, match=r"platform\.legs = top1 top3: must rise"):
        prepared(buan, legs=("leg1", "top1 top3"))


def highest(samples):
    """Largest value of each channel, as statistics have it."""
    statistics = Statistics()
    statistics.add(samples)
    return statistics.table()[:, 0]
