"""Accelerations, static parts, crossings and spectral moments of a record, on scenes unlike Buan."""

from dataclasses import replace

import numpy as np
import pytest
from pytest import approx

from solver.coupled import forces as forces_module
from solver.coupled import support
from solver.coupled.preparation import prepare
from solver.errors import InputError
from solver.record import steel as steel_module
from solver.record.corners import ends_of
from solver.record.recorder import Recorder
from solver.record.sampling import Cuts
from solver.record.spectra import MOMENTS, all_lines, crossings, moments
from solver.record.steel import Spread, Steel
from solver.run import simulate
from solver.sea.realization import components
from solver.statistics import STATISTICS
from solver.structure import water
from solver.structure.frame_model import assemble
from solver.structure.legs import compressive
from tests.awkward import bare_legs, duck, on_piles, raking, soft_ground, unequal_legs
from tests.structure.test_in_water import scene as pile

STD, MEAN = STATISTICS.index("std"), STATISTICS.index("mean")


def ran(made, **settings):
    item, h = made()
    return simulate(replace(item, settings=replace(item.settings, **settings)), h)


@pytest.mark.parametrize("made", [unequal_legs, soft_ground])
def test_nodes_accelerate_as_the_legs_tops_move(made):
    """Second differences of the deck's displacement, of second order in the time between samples."""
    record = ran(made, outputs=("accelerations",), keep_series=True, time_step=0.05, duration=60.0)
    clamped = made()[0].platform.frame.clamped
    assert record.coords["node"].tolist() == [n for n in made()[0].platform.frame.nodes if n not in clamped]
    t, moved = record.series["time"][1], record.series["top_displacement"][1][:, 2]
    dims, acceleration = record.series["node_acceleration"]
    assert dims == ("time", "node", "direction")
    deck = acceleration[:, record.coords["node"].tolist().index("deck")]
    second = np.diff(moved, 2, axis=0) / (t[1] - t[0]) ** 2
    assert np.abs(second - deck[1:-1]).max() < 0.02 * np.abs(deck).max()


def test_accelerations_and_moments_of_lines_are_one_anothers():
    """Without a march: the variance of an acceleration is the displacement's fourth moment; m0 is its own variance."""
    outputs = ("accelerations", "moments")
    record = ran(unequal_legs, outputs=outputs, froude_krylov="linear", method="frequency")
    of = {name: values for name, (_, values) in record.variables.items()}
    node = record.coords["node"].tolist().index("deck")
    assert of["node_acceleration"][node, :, STD] ** 2 == approx(of["top_displacement_m4"][2], rel=1e-9)
    for name in ("rotation", "hinge_force", "top_displacement", "node_acceleration", "wave_elevation"):
        assert of[f"{name}_m0"] == approx(of[name][..., STD] ** 2, rel=1e-9)
        rate = np.sqrt(of[f"{name}_m2"] / of[f"{name}_m0"]) / (2 * np.pi)
        assert of[f"{name}_crossing_rate"] == approx(rate)


def test_moments_of_a_record_are_those_of_its_spectrum():
    """Of a march: variance, and crossings as many as a Gaussian of these moments has."""
    record = ran(bare_legs, outputs=("moments", "reactions"), duration=1800.0, time_step=0.15)
    for name in ("wave_elevation", "base_shear"):
        values = {key: record.variables[f"{name}_{key}"][1] for key in ("m0", "m2", "crossing_rate")}
        assert values["m0"] == approx(record.variables[name][1][..., STD] ** 2, rel=1e-9)
        expected = np.sqrt(values["m2"] / values["m0"]) / (2 * np.pi)
        assert values["crossing_rate"] == approx(expected, rel=0.06)
    assert not any(name.endswith("_m0") for name in ran(bare_legs, duration=20.0).variables)


def test_waves_of_known_phases_cross_as_often_as_their_sum_does():
    """As a march counts, not as a Gaussian of their moments would; and of steel with moments as without."""
    waves = components(amplitude=[0.01, 0.004, 0.006], omega=[1.0, 1.33, 2.2], phase=[0.0, 1.0, 2.0], heading=0.5)
    item = replace(bare_legs()[0], sea=waves)
    fields = {"method": "frequency", "froude_krylov": "linear", "duration": 1200.0}
    told = [
        simulate(replace(item, settings=replace(item.settings, outputs=outputs, **fields))).variables
        for outputs in (("fibre_stress",), ("fibre_stress", "moments"))
    ]
    steel = [of["fibre_stress_crossing_rate"][1] for of in told]
    assert steel[1] == approx(steel[0], abs=2 / 1200)
    t = np.arange(0.0, 1200.0, 0.02)
    eta = sum(a * np.cos(w * t - e) for a, w, e in zip((0.01, 0.004, 0.006), (1.0, 1.33, 2.2), (0, 1, 2), strict=True))
    count = np.count_nonzero((eta[1:] >= 0) & (eta[:-1] < 0)) / 1200
    assert told[1]["wave_elevation_crossing_rate"][1] == approx(count, abs=3 / 1200)


def test_moments_of_a_harmonic_are_its_own():
    """m_k = ½ a² ω^k, and a crossing each period; a constant has neither."""
    t = 0.1 * np.arange(4096)
    w = 2 * np.pi * 64 / 409.6
    record = np.stack([3.0 * np.cos(w * t), np.full(t.size, 2.0)], axis=1)
    of_order = moments(*all_lines(record, 0.1))
    assert of_order[:, 0] == approx(4.5 * w ** np.array(MOMENTS), rel=2e-3)
    assert crossings(of_order)[0] == approx(w / (2 * np.pi), rel=1e-3)
    assert np.isnan(crossings(0 * of_order)).all()


@pytest.mark.parametrize("made", [soft_ground, on_piles])
def test_static_parts_are_those_of_the_frame_alone(made):
    """What the ground bears at rest is all that weighs, less what floats; a mean is near its static part in waves."""
    item, _ = made()
    record = ran(made, outputs=("reactions", "section_forces", "static_part"), duration=20.0)
    force = record.variables["reaction_force_static"]
    model = assemble(item.platform.frame)
    load = water.static_load(model, item.water.density, item.water.gravity).reshape(-1, 6)[:, :3].sum(axis=0)
    assert force[0] == ("foot", "direction")
    assert force[1].sum(axis=0) == approx(-load, abs=1e-6 * np.abs(load).max())
    assert record.variables["base_shear_static"][1] == approx(load, abs=1e-6 * np.abs(load).max())
    for name in ("pile_force", "bottom_stress"):
        static = record.variables[f"{name}_static"][1]
        assert record.variables[name][1][..., MEAN] == approx(static, rel=0.5)
    assert "section_moment_static" in record.variables


def test_what_has_nothing_to_say_is_refused():
    item = bare_legs()[0]
    changes = {
        "platform": replace(item.platform, legs=()),
        "settings": replace(item.settings, outputs=("static_part",)),
    }
    with pytest.raises(InputError, match="outputs = static_part: is of legs, reactions, section_forces or"):
        replace(item, **changes)
    assert "node" not in ran(duck, outputs=("moments",), duration=20.0).coords


@pytest.mark.slow
def test_what_is_another_or_its_negative_is_looked_at_once(monkeypatch):
    """The answer is that of one by one: signs, fibres in their order, extremes, series, damage; not of unequal legs."""
    outputs = ("reactions", "section_forces", "member_stress", "fibre_stress", "fatigue", "leg_tops", "utilisation")
    item = raking(outputs=outputs, keep_series=True)
    forces = prepare(item, None).support.forces
    places, spread = forces.places.columns, Steel(forces, item.settings).spread
    assert places.sections[0, 0, 0] == places.feet[0, 0] == places.feet[1, 0]  # the one leg's N is the other's
    assert spread["section_moment"].sign.min() == -1 and spread["fibre_stress"].place.max() < 2 * 8 == 16
    assert spread["fibre_stress"].place[1].tolist() != spread["fibre_stress"].place[0].tolist()
    once, few = simulate(item), Steel(forces, item.settings)
    fibres = replace(item.settings, outputs=("fibre_stress",))
    unequal = prepare(replace(bare_legs()[0], settings=fibres), None).support.forces
    assert np.unique(Steel(unequal, fibres).spread["fibre_stress"].place).size == 3 * 8
    monkeypatch.setattr(forces_module, "_alike", lambda maps, _: (np.arange(maps.shape[1]), np.ones(maps.shape[1])))
    monkeypatch.setattr(steel_module, "SAME", -1.0)
    y = forces.whole(np.random.default_rng(2).normal(size=(4, len(forces.moments))))
    some, all_ = (steel.every_fibre(y) for steel in (few, Steel(forces, item.settings)))
    assert some.shape == (4, 3, 8) and some == approx(all_, rel=1e-6, abs=1e-9 * np.abs(all_).max())
    support._reduced.cache_clear()
    each = simulate(item)
    support._reduced.cache_clear()
    assert once.variables.keys() == each.variables.keys() and once.series.keys() == each.series.keys()
    for found, expected in ((once.variables, each.variables), (once.series, each.series)):
        for name, (dims, values) in expected.items():
            assert found[name][0] == dims
            least = 1e-7 * np.nanmax(np.abs(values), initial=0.0)
            assert found[name][1] == approx(values, rel=1e-6, abs=least, nan_ok=True), name


def test_what_pieces_change_is_told_of_all_that_are_another():
    item = raking(outputs=("fibre_stress",))
    system = prepare(item, None)
    recorder = Recorder(item, system.support, layout=system.layout)
    recorder.spread = {"x": Spread(np.array([[1, 0], [0, 0]]), np.array([[1.0, 1.0], [-1.0, 1.0]]))}
    recorder.cuts = {name: [Cuts(np.array([3]), np.array([[2.0, 5.0]]), np.array([[7.0, 11.0]]))] for name in "xy"}
    found = recorder.amended()
    assert found["x"].value.tolist() == [[5.0, 2.0, -2.0, 2.0]] and found["x"].square.tolist() == [
        [11.0, 7.0, 7.0, 7.0]
    ]
    assert found["y"].value.tolist() == [[2.0, 5.0]] and found["x"].row.tolist() == [3]


@pytest.mark.parametrize(("degree", "cut"), [(3, [1, 8, 11, 12, 13, 20]), (1, [1, 8, 11, 13, 20])])
def test_what_is_left_uncut_is_integrated_to_its_ends(degree, cut):
    """Cubics exactly over runs of three samples or more, lines over single steps, too."""
    polynomial, t = np.polynomial.Polynomial(np.random.default_rng(3).normal(size=degree + 1)), np.arange(21.0)
    f, integral = polynomial(t), polynomial.integ()
    samples, weights = ends_of(np.array(cut), t.size)
    whole = [k for k in range(1, t.size) if k not in cut]  # steps, up to their second sample
    trapezoids, exact = (
        sum(of(k) for k in whole) for of in (lambda k: f[k - 1 : k + 1].mean(), lambda k: integral(k) - integral(k - 1))
    )
    assert trapezoids + weights @ f[samples] == approx(exact, rel=1e-12) and weights.sum() == approx(0.0, abs=1e-15)


@pytest.mark.parametrize("method", ["time", "frequency"])
def test_a_column_is_relieved_of_its_axial_force_at_most(method):
    """Which nothing changes but weight: where the moment passes zero N/A - |M|c/I is that, and not more."""
    item = pile(method=method)
    settings = replace(item.settings, outputs=("static_part",), duration=300.0)
    record = simulate(replace(item, settings=settings))
    still, (high, *_) = record.variables["bottom_stress_static"][1][0], record.variables["bottom_stress"][1][0]
    std = record.variables["bottom_stress"][1][0, -1]
    assert still - {"time": 1e-6, "frequency": 0.02}[method] * std < high <= still + 1e-9 * abs(still)


def test_pieces_count_among_what_relieves_a_leg():
    """Each by itself: nothing is told of what lies between."""
    item = pile()
    system = prepare(item, None)
    recorder = Recorder(item, system.support, layout=system.layout)
    p = np.zeros((3, system.support.omega.size))
    forces = np.random.default_rng(0).normal(size=(3, system.support.forces.at_rest.size)) * 1e6
    recorder._enlarge(p, forces)
    assert recorder.largest.relieved == approx(compressive(recorder.channels.steel.compression(forces)).max(axis=0))
