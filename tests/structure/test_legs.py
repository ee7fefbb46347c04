"""What is put out along the legs, against displacements and section forces of the frame itself."""

import numpy as np
from pytest import approx

from solver.coupled import support
from solver.sea.field import WaveField
from solver.statistics import Statistics
from solver.structure import recovery, statics, water
from solver.structure.legs import BENDING, at_nodes


def prepared(buan, planar=True):
    return support.prepare(
        buan.platform(), WaveField(buan.sea(), 50.0, 9.81), buan.water, ["hinge:front", "hinge:rear"],
        planar=planar, modes=6, stations=2,
    )  # fmt: skip


def test_planar_scenes_compute_two_of_four_legs(buan):
    legs = prepared(buan).legs
    assert legs.twin.tolist() == [0, 0, 1, 1] and legs.mirrored.tolist() == [False, True, False, True]
    assert prepared(buan, planar=False).legs.twin.tolist() == [0, 1, 2, 3]


def test_tops_feet_and_envelopes_are_those_of_the_whole_frame(buan):
    """Fibre stress N/A - c/I (My² + Mz²)^½ of static and moving section forces, sample by sample."""
    s, platform = prepared(buan), buan.platform()
    model, at_rest, _ = support.dynamic_model(platform, buan.water)
    p = np.random.default_rng(0).normal(size=(7, s.omega.size)) * 100.0
    largest = s.legs.nothing()
    parts = [s.legs.response(block, largest) for block in (p[:3], p[3:])]
    tops, feet = (np.concatenate(x) for x in zip(*parts, strict=True))
    displacement, stress = s.legs.envelopes(largest)
    moved = p @ s.shapes.T
    gravity, density = buan.water.gravity, buan.water.density
    loads = statics.self_weight(model, gravity) + water.buoyancy(model, density, gravity)
    still = recovery.section_forces(model, at_rest, loads).reshape(-1, 2, 6)
    moving = (moved @ recovery.section_force_matrix(model).T).reshape(len(p), -1, 2, 6)
    force = (still + moving)[..., BENDING]
    A, Iy, _, c = np.moveaxis(recovery.section_properties(model).reshape(-1, 2, 4), -1, 0)
    sigma = force[..., 0] / A - c / Iy * np.hypot(force[..., 1], force[..., 2])  # tubes: Iy = Iz
    for leg, name in enumerate(platform.legs):
        nodes, elements = model.member_nodes[name], model.member_elements[name]
        u = moved.reshape(len(p), -1, 6)[:, nodes, :3]
        assert tops[:, leg] == approx(u[:, -1], rel=1e-9, abs=1e-9 * np.abs(u).max())
        assert feet[:, leg] == approx(sigma[:, elements[0], 0], rel=1e-9)
        assert displacement[leg] ** 2 == approx(highest(np.sum(u**2, axis=2)), rel=1e-9)
        ends = np.abs(sigma[:, elements])
        assert stress[leg] == approx(at_nodes(highest(ends.reshape(len(p), -1)).reshape(ends.shape[1:])), rel=1e-9)


def highest(samples):
    """Largest value of each channel, as statistics have it."""
    statistics = Statistics()
    statistics.add(samples)
    return statistics.table()[:, 0]
