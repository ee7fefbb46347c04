"""When a record's samples were taken, and which of them count."""

from dataclasses import replace

import numpy as np
import pytest
from pytest import approx

from solver.record.channels import Channels
from solver.run import simulate
from solver.sea.realization import CALM, components, ramp
from solver.statistics import STATISTICS
from studies.validation.response import frequency_domain

SPRING = 4e4  # [N/m]


@pytest.mark.parametrize("formulation", ["minimal", pytest.param("augmented", marks=pytest.mark.slow)])
def test_every_sample_stands_at_its_time(buan, coefficients, formulation):
    """Floats guided in heave that feel no waves, z = z0 cos ωt, beside the elevation: both known at every instant."""
    items = buan.floats(motion=("heave",), stiffness=SPRING, offset=0.2, pto_damping=0.0)
    scene = buan.scene(
        "fixed", floats=items, sea=buan.sea(Hs=0.3), time_step=0.1, discard=2.0, duration=6.0, ramp=4.0,
        froude_krylov="none", diffraction=False, radiation=False, keep_series=True, formulation=formulation,
    )  # fmt: skip
    record = simulate(scene, coefficients)
    t, z, elevation = (record.series[name][1] for name in ("time", "motion", "wave_elevation"))
    assert t == approx(2.0 + 0.05 * np.arange(121), abs=1e-9)  # both ends count, half a step apart
    omega = np.sqrt((1025 * 9.81 * np.pi + SPRING) / items[0].mass)
    # Fourth order at 0.5 rad a step: 2e-3 in phase after 80 steps; one sample would be 0.25 rad.
    assert z[:, :, 0] == approx(np.outer(0.2 * np.cos(omega * t), [1, 1]), abs=0.02 * 0.2)
    waves = (scene.sea.amplitude * np.exp(-1j * np.outer(t, scene.sea.omega))).sum(axis=1).real
    assert elevation == approx(waves * ramp(t, 4.0), abs=1e-9)
    assert record.variables["wave_elevation"][1][2:] == approx(
        [elevation.mean(), np.sqrt(np.mean(elevation**2)), elevation.std()], rel=1e-9, abs=1e-12
    )  # fmt: skip
    longer = replace(scene, settings=replace(scene.settings, discard=0.0, duration=8.0))
    assert simulate(longer, coefficients).series["motion"][1][-121:] == approx(z, abs=1e-9)


def test_power_and_motion_per_wave_are_those_of_the_frequency_domain(buan, coefficients):
    """Unlike floats in two small waves: each with its X of a wave, in phase with it, and ½ c Σ|ωX|² of power."""
    front, rear = buan.floats(pto_damping=1e5)
    items = (front, replace(rear, pto_damping=2e4))
    sea = components(amplitude=[2e-3, 1e-3], omega=[1.0, 2.0], phase=[0.4, -1.0])
    scene = buan.scene(
        "fixed", sea=sea, floats=items, froude_krylov="linear", rao=True, memory_tolerance=1e-3,
        time_step=2 * np.pi / 60, discard=100.0, duration=32 * np.pi,
    )  # fmt: skip
    variables, exact = simulate(scene, coefficients).variables, frequency_domain(items, coefficients, sea.omega)
    motion = variables["rao"][1][:, 0] * np.exp(1j * variables["rao_phase"][1][:, 0])
    # 5e-3 of the largest: splines through 36 coarse frequencies and a memory fitted to 1e-3.
    assert motion == approx(exact.T, abs=5e-3 * np.abs(exact).max())
    rates = np.abs(sea.omega[:, None] * exact * sea.amplitude[:, None]) ** 2
    mean = variables["absorbed_power"][1][:, STATISTICS.index("mean")]
    assert mean == approx(np.array([1e5, 2e4]) * rates.sum(axis=0) / 2, rel=1e-2)


def test_a_joint_bears_what_the_water_does_not(buan, coefficients):
    """A float a tenth too heavy, guided in surge: the joint pushes it up by that tenth of its displaced weight."""
    displaced = coefficients.displaced_mass
    items = buan.floats(motion=("surge",), stiffness=1e4, pto_damping=0.0, mass=1.1 * float(displaced[0]))
    scene = buan.scene("fixed", sea=CALM, floats=items, froude_krylov="linear", duration=2.0, discard=0.0)
    force = simulate(scene, coefficients).variables["hinge_force"][1][..., STATISTICS.index("mean")]
    assert force == approx(np.outer(0.1 * displaced * 9.81, [0, 0, 1]), abs=1e-6 * displaced[0])


def test_each_axis_stands_by_its_name_in_whatever_order_floats_have_them(buan):
    item = buan.scene()
    first, other = item.floats

    def by_axis(*motions):
        floats = tuple(replace(f, motion=m, pto_damping=0.0) for f, m in zip((first, other), motions, strict=True))
        channels = Channels(replace(item, floats=floats), None)
        n = channels.owner.size
        return channels.axes, channels.by_axis(np.arange(1.0, n + 1)[None])[0].tolist()

    assert by_axis(("surge", "heave"), ("surge", "heave")) == (["surge", "heave"], [[1, 2], [3, 4]])
    assert by_axis(("surge", "heave"), ("heave", "surge")) == (["surge", "heave"], [[1, 2], [4, 3]])
    axes, some = by_axis(("heave",), ("pitch",))
    assert axes == ["heave", "pitch"] and some[0][0] == 1 and some[1][1] == 2
    assert np.isnan([some[0][1], some[1][0]]).all()
