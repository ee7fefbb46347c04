"""An error asked for: settings follow it, and the record's estimate stands beside it."""

from dataclasses import replace
from functools import partial
from types import MappingProxyType

import numpy as np
import pytest
from pytest import approx

from solver import run
from solver.balance import balanced
from solver.errors import InputError, StepTooLong
from solver.hydrodynamics.bem.coefficients import MeshError
from solver.hydrodynamics.hull.revolution import Revolution
from solver.record.accuracy import DEFAULT, MARGIN, SHARE, first_guess, refined, shortened
from solver.record.audit import DOUBT, against, unmet
from solver.record.effects import UNSURE, cancelled, together, unlike
from solver.record.probe import sharpest_bend
from solver.record.refit import prepared
from solver.record.sampling import least_force
from solver.run import simulate
from solver.scene import MOST_PANELS, PANELS, EndStops, Float, Scene, Settings, Water, panels_for, two_digits
from solver.sea.realization import CALM, Realization, components, regular
from solver.statistics import FAINT, apart
from solver.structure.load_history import LoadHistory
from tests.awkward import SCENES, known, model_scale, raking, sea, unequal_legs
from tests.awkward import scene as awkward_scene
from tests.hydrodynamics.shapes import meshed


def oblique_hull_in_head_seas():
    item = replace(SCENES["oblique"]()[0].floats[0], name="free", hinge=(0, 0, 0), arm=(0, 0, 0), axis=(0, 1, 0))
    item = replace(item, motion=("surge", "sway", "heave", "yaw"), stiffness=(5e4, 5e4, 0, 5e4), pto_damping=0.0)
    scene = awkward_scene([item])
    return scene, known(scene, 0.4, 6.0, 16)


GOOD = {
    "discretization_error": 1e-5, "sampling_error": 0.0, "quadrature_error": 1e-5, "memory_effect": 1e-5,
    "mesh_effect": 0.0, "shapes_effect": 0.0, "stations_effect": 0.0, "law_effect": 0.0,
}  # fmt: skip


def told(**errors):
    parts = {**GOOD, **errors}
    return {**parts, "estimated_error": together(parts.values())}


def test_a_step_given_beside_a_tolerance_is_told_that_it_is_not_taken():
    item, h = SCENES["duck"]()
    both = replace(item, settings=replace(item.settings, tolerance=3e-2, time_step=0.01, duration=20.0, discard=5.0))
    attrs = simulate(both, h).attrs
    assert f"time_step = 0.01: tolerance chooses it, {attrs['time_step']:g}" in attrs["unmet"]
    alone = simulate(replace(both, settings=replace(both.settings, time_step=None)), h).attrs
    assert attrs["time_step"] == alone["time_step"] and "tolerance chooses" not in alone["unmet"]


@pytest.mark.parametrize("support", ["fixed", "elastic"])
def test_tighter_tolerance_is_met_by_dearer_settings(buan, coefficients, support):
    loose, usual, tight = (
        simulate(buan.scene(support, tolerance=t, duration=120.0), coefficients).attrs for t in (3e-2, 5e-3, 1e-3)
    )
    for attrs in (loose, usual, tight):
        assert attrs["estimated_error"] <= attrs["tolerance"] and attrs["unmet"] == ""
    assert tight["time_step"] < usual["time_step"] < loose["time_step"]
    # Less than the default asks costs less than it: longer steps, fewer points.
    default = buan.scene(support)
    assert loose["time_step"] > default.usual_step and loose["azimuths"] < default.settings.azimuths


def test_run_goes_on_where_its_start_meets_the_tolerance(buan, coefficients, monkeypatch):
    """No pilot runs: one system where the guess is good, one more for each time it is not."""
    made = []
    monkeypatch.setattr(run, "prepared", lambda *args: made.append(1) or prepared(*args))
    simulate(buan.scene("fixed", tolerance=1e-2), coefficients)
    assert len(made) == 1
    monkeypatch.setattr(run, "first_guess", lambda scene: replace(first_guess(scene), time_step=scene.longest_step))
    record = simulate(buan.scene("fixed", tolerance=1e-3), coefficients)
    assert len(made) > 2 and record.attrs["unmet"] == ""


def test_what_cannot_be_met_is_said(buan, coefficients):
    """The error of coefficients from outside is not one that settings can reduce."""
    rough = replace(coefficients, error=MeshError(*(100 * x for x in coefficients.error)))
    attrs = simulate(buan.scene("fixed", tolerance=2e-3), rough).attrs
    error, mesh = attrs["estimated_error"], attrs["mesh_effect"]
    told = f"tolerance = 0.002: the estimated error is {error:.2g}, by mesh_effect {mesh:.2g}"
    panels = "; boundary elements have {:g} panels: by it {} a body, {}, or what a hull's own mesh has"
    fewer = PANELS, f"by a smaller one up to {MOST_PANELS}"
    assert attrs["unmet"] == told + panels.format(coefficients.settings["panels"], *fewer)
    meshed = replace(rough, settings=MappingProxyType({**rough.settings, "panels": 2912}))
    given = replace(rough, settings=MappingProxyType({}))
    asked = buan.scene("fixed", tolerance=2e-3)
    errors = {"estimated_error": error, "mesh_effect": mesh, "memory_effect": 0.0}
    assert unmet(asked, None, errors, meshed) == [told + panels.format(2912, *fewer)]
    assert unmet(asked, None, errors, given) == unmet(asked, None, errors) == [told]
    other = {"estimated_error": 1.5e-3, "mesh_effect": 9e-4, "memory_effect": 1.2e-3}
    assert unmet(buan.scene("fixed", tolerance=1e-3), None, other) == [
        "tolerance = 0.001: the estimated error is 0.0015, by memory_effect 0.0012"
    ]
    box = SCENES["soft_mooring"]()[0]
    asking = replace(box, settings=replace(box.settings, tolerance=1e-4))
    (note,) = unmet(asking, None, {"estimated_error": 1e-2, "mesh_effect": 1e-2}, meshed)
    assert note.endswith(panels.format(2912, MOST_PANELS, "the most of any"))


@pytest.mark.parametrize("method", ["time", "frequency"])
def test_a_record_that_may_be_far_off_warns_of_it(buan, coefficients, method):
    """Where nobody asked for an error; where somebody did, `unmet` says it."""
    rough = replace(coefficients, error=MeshError(*(3000 * x for x in coefficients.error)))
    settings = {"duration": 60.0, "method": method, "froude_krylov": "linear"}

    def calm(**more):  # in higher waves the frequency domain errs by more than DOUBT, too: arms turn
        item = buan.scene("fixed", **settings, **more)
        return replace(item, sea=replace(item.sea, amplitude=0.2 * item.sea.amplitude))

    attrs = simulate(calm(), rough).attrs
    error, mesh = attrs["estimated_error"], attrs["mesh_effect"]
    told = f"estimated_error is {error:.2g}, of any mean, rms or std, by mesh_effect {mesh:.2g}"
    assert error > DOUBT and attrs["warnings"].endswith(told)
    for sure in ({"tolerance": 1e-2}, {}):
        attrs = simulate(calm(**sure), rough if sure else coefficients).attrs
        assert "estimated_error" not in attrs.get("warnings", "")


def test_what_cannot_be_met_is_the_fewest_largest_parts():
    errors = told(mesh_effect=3e-3, discretization_error=8e-4, memory_effect=7e-4)
    assert against(1e-2, errors) == []
    assert against(2e-3, errors) == ["mesh_effect"]
    assert against(1e-3, errors) == ["mesh_effect", "discretization_error"]


def test_a_mesh_that_is_too_coarse_keeps_no_step_too_long(buan, coefficients, monkeypatch):
    """A tighter tolerance has a shorter step, and one below the default's a shorter one than that."""
    rough = replace(coefficients, error=MeshError(*(100 * x for x in coefficients.error)))
    monkeypatch.setattr(run, "first_guess", lambda scene: replace(first_guess(scene), time_step=scene.longest_step))
    asked = (4e-3, 2e-3, 1e-3)
    runs = [simulate(buan.scene("fixed", tolerance=t, duration=120.0), rough).attrs for t in asked]
    for attrs, tolerance in zip(runs, asked, strict=True):
        assert attrs["mesh_effect"] > tolerance and "by mesh_effect" in attrs["unmet"]
        assert attrs["discretization_error"] <= SHARE["discretization_error"] ** 0.5 * tolerance / MARGIN
    default = simulate(buan.scene("fixed", duration=120.0), rough).attrs["time_step"]
    steps = [attrs["time_step"] for attrs in runs]
    assert steps == sorted(steps, reverse=True) and steps[2] < min(steps[0], default)


def test_a_run_repeated_for_its_step_is_refined_as_any_other(monkeypatch):
    item = SCENES["duck"]()[0]
    settings = replace(item.settings, tolerance=1e-2, radiation=False, diffraction=False)
    whole, steps = run._run, []

    def too_long_at_first(scene, *rest):
        steps.append(scene.settings.time_step)
        if len(steps) == 1:
            raise StepTooLong("too long")
        return whole(scene, *rest)

    def halved_once(scene, _told):
        settings = replace(scene.settings, time_step=scene.settings.time_step / 2)
        return replace(scene, settings=settings) if len(steps) == 2 else None

    monkeypatch.setattr(run, "_run", too_long_at_first)
    monkeypatch.setattr(run, "improved", halved_once)
    attrs = simulate(replace(item, settings=settings)).attrs
    assert steps == [steps[0], steps[0] / 4, steps[0] / 8]
    assert (attrs["time_step"], attrs["repeated"]) == (steps[2], "too long")


def test_errors_that_cancel_are_not_taken_for_none(buan, coefficients):
    """Of forces too small by as much as the linear model takes a heavier float to move less."""
    force = np.array([[3.0, 4.0], [1.0, 1.0j]])
    assert unlike(force, force * [[1.0], [1.05]]) == approx(0.05) and unlike(0 * force, 0 * force) == 0
    unasked = partial(pytest.fail, "looked at though it can do no more")
    assert cancelled(0.01, 0.01, unasked, unasked) == 0.01
    assert cancelled(0.01, 0.05, lambda: 0.05, lambda: 0.05) == pytest.approx(UNSURE * 0.05)
    assert cancelled(0.03, 0.05, lambda: 0.05, unasked) == 0.03
    assert cancelled(0.01, 0.1, lambda: 0.1, lambda: 0.01) == pytest.approx(np.sqrt(2) * 0.01)
    still = MeshError(*(0 * part for part in coefficients.error))
    off = replace(coefficients, error=still._replace(diffraction=0.2 * coefficients.diffraction))
    for method in ("time", "frequency"):
        scene = buan.scene("fixed", method=method, froude_krylov="linear")
        assert simulate(scene, replace(coefficients, error=still)).attrs["mesh_effect"] == 0
        told = simulate(scene, off).attrs["mesh_effect"]
        against = 2 * np.abs(coefficients.added_mass).max() * np.eye(len(coefficients.added_mass_inf))
        both = off.error._replace(added_mass=off.error.added_mass + against, added_mass_inf=against)
        assert simulate(scene, replace(coefficients, error=both)).attrs["mesh_effect"] >= UNSURE * told > 0


def test_memory_that_does_not_fit_is_said(buan, coefficients):
    attrs = simulate(buan.scene("fixed", memory_tolerance=1e-5, duration=20.0, discard=0.0), coefficients).attrs
    assert attrs["unmet"].startswith("memory_tolerance = 1e-05: the radiation memory's fit ended at ")


@pytest.mark.slow
def test_a_run_that_meets_a_stop_late_is_judged_from_there():
    """Waves that grow from nothing: what a run's first 600 usual steps say knows no stop, whose hits shake the legs."""
    scene, known_to = SCENES["unequal_legs"]()
    waves = Realization(
        omega=1.1 + np.array([0.0, 2 * np.pi / 900]), amplitude=np.array([0.3, -0.3], complex), heading=np.pi / 6
    )

    def record(step, reach):
        stops = EndStops(lower=-reach, upper=reach, stiffness=2e6, damping=2e4)
        settings = replace(scene.settings, duration=350.0, discard=0.0, time_step=step)
        floats = (replace(scene.floats[0], end_stops=stops),)
        return simulate(replace(scene, sea=waves, floats=floats, settings=settings), known_to)

    calm, late = record(None, 0.6), record(None, 0.17)
    fine = record(late.attrs["time_step"] / 3, 0.17)
    assert calm.variables["end_stop_hits"][1][0] == 0
    assert late.variables["end_stop_hits"][1][0] > 10
    assert late.attrs["time_step"] < calm.attrs["time_step"] / 2
    assert late.attrs["discretization_error"] < DEFAULT
    for name in ("hinge_force", "top_displacement", "rotation"):
        std, exact = (r.variables[name][1][..., 4] for r in (late, fine))
        assert std == approx(exact, rel=3 * late.attrs["discretization_error"], abs=FAINT * np.max(exact))
    loads = [r.variables["end_stop_load"][1] for r in (late, fine)]
    assert loads[0] == approx(loads[1], rel=0.01)


@pytest.mark.parametrize(
    ("stops", "damping"),
    [
        (EndStops(lower=-0.03, upper=0.05, stiffness=2e6), 10.0),
        (EndStops(lower=-0.03, upper=0.06, stiffness=5e5, damping=10.0), 15.0),
    ],
)
def test_pieces_on_a_hard_stop_are_judged_as_steps_are(stops, damping):
    """Of a model's float that is hardly damped; with the same pieces both runs had power the same 5 % off."""
    hull = Revolution.vertical_cylinder(radius=0.3, draft=0.4, freeboard=0.4)
    item = Float(
        name="a", hull=hull, mass=1000.0 * np.pi * 0.3**2 * 0.4, inertia=(5.0,) * 3, hinge=(0.2, 0.0, 0.0),
        motion=("heave",), pto_damping=damping, end_stops=stops,
    )  # fmt: skip
    period, phase = np.array([1.8, 1.27, 2.6]), np.array([0.3, 1.1, 2.0])
    waves = components(amplitude=np.array([0.05, 0.03, 0.02]), omega=2 * np.pi / period, phase=phase)
    settings = Settings(duration=60.0, discard=0.0, ramp=0.0, froude_krylov="linear", radiation=False)
    settings = replace(settings, diffraction=False)
    scene = Scene(water=Water(depth=np.inf, density=1000.0), floats=(item,), sea=waves, settings=settings)
    usual, fine = simulate(scene), simulate(replace(scene, settings=replace(settings, time_step=1e-3)))
    names = "motion", "absorbed_power"
    true = max(apart(usual.variables[name][1], fine.variables[name][1]) for name in names)
    assert usual.variables["end_stop_hits"][1] == fine.variables["end_stop_hits"][1] > 50
    assert true < 2e-3 and true / usual.attrs["estimated_error"] < 3, (true, usual.attrs["estimated_error"])


def test_hits_after_what_is_judged_are_told_without_a_tolerance(buan, coefficients):
    def told(reach, **settings):
        item = buan.scene("fixed", duration=120.0, **settings)
        stops = EndStops(lower=-reach, upper=reach, stiffness=2e6, damping=2e4)
        record = simulate(replace(item, floats=tuple(replace(f, end_stops=stops) for f in item.floats)), coefficients)
        hits = int(record.variables["end_stop_hits"][1].sum())
        return hits, f"end stops are met {hits} times" in record.attrs.get("warnings", "")

    hits, by_the_first = told(0.1)
    assert hits > 10 and by_the_first
    assert told(0.9) == (0, False) and told(0.1, tolerance=3e-2)[1] is False


@pytest.mark.slow
def test_what_hits_do_between_samples_is_in_the_record():
    """The long steps of a big float's waves beside a small one on its stops; short ones have all in their samples.

    Samples alone would have the hinge force 5 % off.
    """
    whole, known_to = SCENES["big_beside_small"]()
    floats = []
    for item, reach in zip(whole.floats, (0.023, 0.1), strict=True):
        swing = item.mass * np.linalg.norm(item.arm) ** 2
        stops = EndStops(lower=-reach, upper=reach, stiffness=400 * swing, damping=4 * swing)
        floats.append(replace(item, end_stops=stops))
    scene = replace(whole, floats=tuple(floats))
    usual = simulate(scene, known_to)
    step = usual.attrs["time_step"]
    fine = simulate(replace(scene, settings=replace(scene.settings, time_step=step / 12)), known_to)
    true = max(
        apart(usual.variables[name][1], fine.variables[name][1], least)
        for name, least in {"rotation": 0.0, "absorbed_power": 0.0, "hinge_force": least_force(scene)}.items()
    )
    assert usual.variables["end_stop_hits"][1].min() > 10
    assert usual.attrs["sampling_error"] < 1e-3 and true < 3e-3, (true, usual.attrs["estimated_error"])
    assert true / usual.attrs["estimated_error"] < 3


def test_settings_are_refined_by_their_own_share_alone(buan):
    settings = first_guess(buan.scene("fixed", tolerance=1e-3))
    assert refined(settings, told()) is None
    finer = refined(settings, told(discretization_error=16e-3))
    assert finer.time_step < settings.time_step / 2 and finer.azimuths == settings.azimuths
    finer = refined(settings, told(sampling_error=2**1.5 * SHARE["sampling_error"] ** 0.5 * 1e-3 / MARGIN))
    assert finer.time_step == approx(two_digits(0.9 / 2 * settings.time_step))
    finer = refined(settings, told(quadrature_error=1e-2))
    assert finer.azimuths > settings.azimuths and finer.panel_size == settings.panel_size / 2
    denser = refined(settings, told(stations_effect=1e-2))
    assert denser == replace(settings, stations_per_element=2 * settings.stations_per_element)
    finer = refined(settings, told(shapes_effect=1e-2))
    assert (finer.modes, finer.time_step) == (2 * settings.modes, settings.time_step)
    assert refined(replace(settings, modes="all"), told(shapes_effect=1e-2)) is None
    parts = ("discretization_error", "sampling_error", "quadrature_error", "stations_effect", "shapes_effect")
    for name in ("mesh_effect", "memory_effect", "elements_effect"):  # not to be had by settings, and in nothing's way
        assert refined(settings, told(**{name: 1e-2})) is None
        for part in parts:
            assert refined(settings, told(**{name: 1e-2, part: 16e-3})) == refined(settings, told(**{part: 16e-3}))


def test_step_follows_the_fourth_order(buan):
    """16 times the error allowed is half the step, with a tenth to spare."""
    settings = first_guess(buan.scene("fixed", tolerance=1e-3))
    share = SHARE["discretization_error"] ** 0.5 * 1e-3 / MARGIN
    finer = refined(settings, told(discretization_error=16 * share))
    assert finer.time_step == approx(two_digits(0.9 / 2 * settings.time_step))
    assert shortened(settings, told(discretization_error=0.99 * DEFAULT)) is None
    assert shortened(settings, told(discretization_error=16 * DEFAULT)).time_step == finer.time_step


def test_mesh_follows_the_tolerance():
    assert panels_for(None) == panels_for(2e-3) == PANELS
    assert panels_for(2e-3 / 8) == 4 * PANELS == panels_for(1e-6)


def test_sharp_edges_of_meshes_below_water_ask_for_more_panels_sooner():
    """A box by h^1.09, a duck's beak, 111 degrees, by h^0.97; hulls of revolution have narrow panels at theirs."""
    box, duck = (SCENES[name]()[0].floats[0].hull for name in ("soft_mooring", "duck"))
    cylinder = Revolution.vertical_cylinder(radius=1.0, draft=1.0, freeboard=1.0)
    ball = meshed(Revolution.sphere(radius=1.0, draft=0.9), 12)
    for hull in (box, duck, ball):
        assert panels_for(None, [hull]) == panels_for(1e-2, [hull]) == panels_for(0.1, [hull]) == PANELS
    assert panels_for(5e-3, [box]) == round(PANELS * 2 ** (2 / (2 * (2 / 3) ** 1.5)))
    assert panels_for(6e-3, [box]) < panels_for(6e-3, [cylinder, duck, box]) < panels_for(3e-3, [box]) == MOST_PANELS
    assert panels_for(1e-3, [cylinder, ball]) == panels_for(1e-3) == round(PANELS * 2 ** (2 / 3))


def test_tolerance_out_of_range_is_refused(buan):
    with pytest.raises(InputError, match="tolerance"):
        replace(buan.scene().settings, tolerance=0.5)


def test_what_symmetry_keeps_at_zero_is_not_judged(buan):
    """Its joint may leave the plane and nothing makes it: sway and yaw are rounding, and no error is of them."""
    scene, h = oblique_hull_in_head_seas()
    attrs = simulate(scene, h).attrs
    assert attrs["estimated_error"] < 2e-2


@pytest.mark.parametrize(("law", "later"), [({}, 2.0), ({"coulomb": 2e3}, 4.0)])
def test_a_decay_s_statistics_lack_half_of_its_first_gap(law, later):
    """No sample is at the start, from where a duck is let go: an error of first order. Later on the first one counts
    in full, which is as much of what is left, little beside what was."""
    whole, h = SCENES["duck"]()
    calm = replace(whole.sea, amplitude=0 * whole.sea.amplitude)
    settings = replace(whole.settings, duration=60.0, discard=0.0, time_step=0.1)
    item = replace(whole, sea=calm, floats=(replace(whole.floats[0], offset=0.2, **law),), settings=settings)
    for discard, more in ((0.0, -1), (later, 1)):
        settings = replace(settings, discard=discard)
        records = [simulate(replace(item, settings=replace(settings, time_step=dt)), h) for dt in (0.1, 0.0125)]
        std, exact = (record.variables["rotation"][1][0, 4] for record in records)
        true = more * (std / exact - 1)
        assert true > 3e-3 and 1 / 3 < true / records[0].attrs["sampling_error"] < 3, discard


def held_on_a_cylinder(scale=1.0):
    """A cylinder free in its plane, and on it a ball on a hinge that a brake holds, at a scale."""
    time = np.sqrt(scale)
    hull = Revolution.vertical_cylinder(radius=4 * scale, draft=3 * scale, freeboard=2 * scale)
    ball = Revolution.hemisphere_cylinder(radius=scale, height=0.6 * scale)
    inertia = 2e6 * scale**5
    floats = [
        Float(
            name="below", hull=hull, mass=1025.0 * hull.volume, inertia=(inertia,) * 3, hinge=(0, 0, 0),
            cog=(0, 0, -scale), motion=("surge", "heave", "pitch"), stiffness=(4e4 * scale**2, 0, 0),
            damping=(2e4 * scale**2.5, 2e5 * scale**2.5, 2e6 * scale**4.5),
        ),
        Float(
            name="held", on="below", hull=ball, mass=1025.0 * ball.volume, inertia=(1e3 * scale**5,) * 3,
            hinge=(5 * scale, 0, 2 * scale), arm=(3 * scale, 0, -2 * scale), coulomb=1e9 * scale**4,
        ),
    ]  # fmt: skip
    floats = balanced(floats, Water(depth=50.0 * scale), [("mass",), ("mass",)])
    waves = sea(Hs=scale, Tp=6.0 * time, band=(0.6 / time, 2.4 / time))
    lengths = {"duration": 100.0 * time, "discard": 20.0 * time, "ramp": 20.0 * time}
    return awkward_scene(floats, depth=50.0 * scale, waves=waves, radiation=False, diffraction=False, **lengths)


@pytest.mark.parametrize("scale", [1.0, 1 / 20])
def test_what_a_brake_holds_is_not_judged_by_its_rounding(scale):
    """Nothing turns, no power is taken: the step follows what moves, on a model as at sea."""
    item = held_on_a_cylinder(scale)
    attrs = simulate(item).attrs
    assert attrs["time_step"] > 0.7 * item.usual_step
    finer = simulate(replace(item, settings=replace(item.settings, time_step=attrs["time_step"] / 2))).attrs
    for part in ("discretization_error", "sampling_error"):
        assert 0 < finer[part] < attrs[part] < 1e-3


@pytest.mark.slow
def test_what_a_brake_holds_on_legs_that_bend_is_not_judged():
    item, h = unequal_legs()
    braked = replace(item, floats=(replace(item.floats[0], coulomb=1e9),))
    for step in (0.2, 0.1):
        attrs = simulate(replace(braked, settings=replace(item.settings, time_step=step)), h).attrs
        assert 0 < attrs["discretization_error"] < 1e-3 and 0 < attrs["sampling_error"] < 1e-3


def test_floats_that_rest_have_no_quadrature_to_judge():
    """In still water; another's that is let go from an offset is the same without them."""
    item = SCENES["oblique"]()[0]
    calm = replace(item.sea, amplitude=0 * item.sea.amplitude)
    item = replace(item, sea=calm, settings=replace(item.settings, radiation=False, diffraction=False))
    moved, rests = replace(item.floats[0], offset=0.1), item.floats[1]
    for floats in ((item.floats[0], rests), (rests,)):
        assert simulate(replace(item, floats=floats)).attrs["quadrature_error"] == 0
    alone, both = (simulate(replace(item, floats=x)).attrs["quadrature_error"] for x in ((moved,), (moved, rests)))
    assert 0 < both == approx(alone, rel=1e-3)


def test_a_float_that_rests_unheld_in_still_water_has_no_quadrature_to_judge():
    """Along an axis without stiffness no load is small beside that; of a float that is let go there is one to judge."""
    item = oblique_hull_in_head_seas()[0]
    free = replace(item.floats[0], motion=("surge", "sway", "heave"), stiffness=(0.0, 0.0, 0.0), damping=0.0)
    calm = awkward_scene([free], waves=CALM, radiation=False, diffraction=False)
    assert simulate(calm).attrs["quadrature_error"] == 0
    assert 0 < simulate(replace(calm, floats=(replace(free, offset=(0.0, 0.0, 0.05)),))).attrs["quadrature_error"] < 0.1


def tiny_waves(Hs, **finer):
    """A float on an arm whose few points on arcs shift its rest, in waves about as small as that."""
    hull = Revolution.hemisphere_cylinder(radius=3.0, height=2.5)
    item = Float(
        name="b", hull=hull, mass=1025 * hull.volume, inertia=tuple(np.full(3, 4100.0 * hull.volume).tolist()),
        cog=(0, 0, -1.0), hinge=(-9.0, 2.0, 3.0), arm=(9.0, -1.0, -3.0), axis=(0.5, 0.8, 0.0),
        motion=("hinge", "heave"), damping=(3e6, 6e4),
    )  # fmt: skip
    waves = sea(Hs=Hs, Tp=7.0, band=(0.5, 2.2), heading=0.4)
    return awkward_scene([item], waves=waves, radiation=False, diffraction=False, keep_series=True, **finer)


def test_what_points_shift_counts_however_small_the_waves_are():
    for Hs in (1e-3, 1e-4):
        told = simulate(tiny_waves(Hs))
        exact = simulate(tiny_waves(Hs, azimuths=48, arc_points=24, line_points=12))
        (usual, mean), rms = (x.variables["motion"][1][0, 1, 2] for x in (told, exact)), told.variables["motion"][1]
        error, said = abs(usual - mean) / rms[0, 1, 3], told.attrs["quadrature_error"]
        assert error > 0.05 and error / 3 < said < 3 * error
        assert said <= 1.0
    calm = tiny_waves(1e-3)
    calm = replace(calm, sea=replace(calm.sea, amplitude=0 * calm.sea.amplitude))
    assert simulate(calm).attrs["quadrature_error"] == 0


def test_what_nothing_pushes_or_holds_has_no_quadrature_to_judge():
    """Sway of a ball in head seas, which is free to go and does not."""
    free = replace(oblique_hull_in_head_seas()[0].floats[0], motion=("surge", "sway", "heave"), stiffness=(5e4, 0, 0))
    assert simulate(awkward_scene([free], radiation=False, diffraction=False)).attrs["quadrature_error"] < 1e-3


def test_record_says_what_it_skipped(buan, coefficients):
    whole = simulate(buan.scene(duration=20.0, discard=0.0), coefficients).attrs["skipped"]
    fixed = simulate(buan.scene("fixed", duration=20.0, discard=0.0), coefficients).attrs["skipped"]
    assert "mirror symmetry" in whole and "708" in whole and "support is fixed" not in whole
    assert "support is fixed" in fixed and "708" not in fixed
    assert all("motions other than surge, heave, pitch, half of each hull" in told for told in (whole, fixed))


def test_record_names_the_motions_kept_where_nothing_radiates():
    """Of a float on another, at 1:20; nothing of mirror images where one stands aside."""
    item = held_on_a_cylinder(1 / 20)
    aside = replace(item, floats=(item.floats[0], replace(item.floats[1], hinge=(0.25, 0.1, 0.1))))
    told = [simulate(replace(a, settings=replace(a.settings, duration=1.0))).attrs["skipped"] for a in (item, aside)]
    assert "motions other than surge, heave, pitch, half of each hull" in told[0] and "motions" not in told[1]


@pytest.mark.parametrize("method", ["time", "frequency"])
def test_record_says_which_hulls_have_fewer_panels(buan, coefficients, method):
    note = "hull a.stl: 864 panels for 6000 (volume -1e-05)"
    coarser = replace(coefficients, settings={**coefficients.settings, "coarser": note})
    scene = buan.scene("fixed", duration=20.0, discard=0.0, method=method, froude_krylov="linear")
    assert note in simulate(scene, coarser).attrs["skipped"].split("; ")
    assert "panels for" not in simulate(scene, coefficients).attrs["skipped"]


def test_accelerations_of_linear_loads_change_no_step():
    """Nor does drag in a sea, of which no harmonic is as fast as the shapes."""
    item, h = unequal_legs()
    settings = replace(item.settings, froude_krylov="linear", duration=50.0)
    asked = [replace(item, settings=replace(settings, outputs=o)) for o in ((), ("accelerations",))]
    plain, both = (simulate(scene, h) for scene in asked)
    assert "node_acceleration" in both.variables
    for name in ("time_step", "discretization_error", "estimated_error"):
        assert both.attrs[name] == approx(plain.attrs[name])


@pytest.mark.parametrize("law", [{}, {"quadratic_damping": 1e6, "pto_damping": 0.0}])
def test_accelerations_of_a_frame_that_floats_shake_are_those_of_finer_steps(law):
    """Nine steps in the waves' period and Newton's usual tolerance made them up to 2 and 3 times as large."""
    item, h = unequal_legs()
    settings = replace(item.settings, outputs=("accelerations",), duration=30.0)
    item = replace(item, floats=tuple(replace(f, **law) for f in item.floats), settings=settings)
    finer = replace(item, settings=replace(settings, time_step=0.012, newton_tolerance=1e-9))
    told, exact = (simulate(scene, h).variables["node_acceleration"][1][..., 4] for scene in (item, finer))
    assert told == approx(exact, rel=0.03, abs=3e-3 * exact.max())


def test_accelerations_of_a_frame_that_drag_shakes_are_those_of_finer_steps():
    """Legs of some 0.4 s in one wave of 8 s, whose harmonics they follow: as it was, the step was one of the wave's."""
    bare, _ = SCENES["bare_legs"]()
    settings = replace(bare.settings, outputs=("accelerations",), duration=48.0, discard=40.0, ramp=16.0)
    item = replace(bare, sea=regular(height=3.0, period=8.0), settings=settings)
    finer = replace(item, settings=replace(settings, time_step=0.02, newton_tolerance=1e-9))
    told, exact = (simulate(scene).variables["node_acceleration"][1][..., 4] for scene in (item, finer))
    assert told == approx(exact, rel=0.03, abs=3e-3 * exact.max())


def errors_of(item, outputs, finer=8):
    """Largest error of any mean, rms and std of outputs against a step so many times shorter, and what is told."""
    usual = simulate(item)
    settings = replace(item.settings, time_step=usual.attrs["time_step"] / finer, newton_tolerance=1e-9)
    fine = simulate(replace(item, settings=settings))
    true = max(apart(usual.variables[name][1], fine.variables[name][1]) for name in outputs)
    return true, usual.attrs


def test_a_frame_without_legs_has_a_step_that_is_judged():
    """By its nodes, as it would be by the tops of its legs."""
    item = raking(outputs=("reactions",), time_step=0.25)
    bare = replace(item, platform=replace(item.platform, legs=()))
    told, without = simulate(item).attrs, simulate(bare).attrs
    assert without["discretization_error"] == approx(told["discretization_error"], rel=0.5)
    true, attrs = errors_of(bare, ["base_shear", "overturning_moment"])
    assert 1 / 3 < true / attrs["estimated_error"] < 3
    usual = replace(item.settings, time_step=None)
    steps = [simulate(replace(x, settings=usual)).attrs["time_step"] for x in (item, bare)]
    assert steps[1] == approx(steps[0], rel=0.2)


@pytest.mark.slow
def test_a_load_history_is_judged_where_it_bends_most():
    """A blow of a third of a second, long after the run's start, by which the step alone is judged otherwise."""
    blow = LoadHistory(
        node="deck",
        time=np.array([0.0, 200.03, 200.17, 200.31, 400.0]),
        force=np.outer([0, 0, 1, 0, 0], [2e5, 0.0, 0.0]),
    )
    item = raking(outputs=("reactions",), time_step=0.1, duration=300.0)
    struck = replace(item, platform=replace(item.platform, load_histories=(blow,)))
    assert sharpest_bend(item) == np.inf and sharpest_bend(struck) == approx(200.17)
    true, attrs = errors_of(struck, ["top_displacement", "base_shear"])
    assert attrs["estimated_error"] > 3 * simulate(item).attrs["estimated_error"]
    assert 1 / 3 < true / attrs["estimated_error"] < 3


@pytest.mark.parametrize(
    ("periods", "step"),
    [(2.0, 0.2), (2.0, 0.23), (2.3, None)],
    ids=["ends counted twice", "whole", "cut"],
)
def test_the_ends_of_a_record_that_is_short_beside_what_it_discards_are_told(periods, step):
    """Mean, rms and std of motion and power against those of 400 steps, at any phase: here of a model's float."""
    item, h = model_scale()
    period, worst, told = 2.3, 0.0, 0.0
    settings = replace(item.settings, duration=periods * period, discard=45.0, ramp=7.0, froude_krylov="linear")
    for phase in (0.0, 0.8, 1.6, 2.4):
        waves = regular(height=0.01, period=period, phase=phase)
        ours, fine = (
            simulate(replace(item, sea=waves, settings=replace(settings, time_step=dt)), h)
            for dt in (step, settings.duration / 400)
        )
        told = max(told, ours.attrs["sampling_error"] + ours.attrs["discretization_error"])
        for name in ("rotation", "absorbed_power"):
            x, exact = (record.variables[name][1][0] for record in (ours, fine))
            worst = max(worst, *np.abs(x[2:] - exact[2:]) / exact[[3, 3, 4]])
    assert told / 3 < worst < 3 * told
