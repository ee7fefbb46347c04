"""Tables of a study become the solver's inputs, and only there."""

import tomllib
from dataclasses import replace

import numpy as np
import pytest
from pytest import approx

from pipeline.bridge import scenes
from pipeline.bridge.checks import problems
from pipeline.bridge.geometry import bem_arguments, geometry_of
from pipeline.bridge.objections import objections
from pipeline.report import sketch
from pipeline.tasks.task import expand
from solver.errors import InputError, refuse
from solver.scene import panels_for
from solver.structure.sections import box, general, i_beam, solid_rectangle, tube, tube_shear_factor
from tests.pipeline.conftest import SMALL


def task(study, **labels):
    return next(t for t in expand(study.content) if all(t.labels[k] == v for k, v in labels.items()))


def test_buan_scene_is_the_papers(buan_tables, study_of):
    scene = scenes.scene(task(study_of(buan_tables), sea_state="representative", platform="elastic").parameters)
    frame = scene.platform.frame
    assert sum(member.elements for member in frame.members) == 124
    assert scene.platform.hinge_nodes == {"front": "hinge:front", "rear": "hinge:rear"}
    assert [f.centre.tolist() for f in scene.floats] == [[-3.86, 0.0, 0.0], [3.86, 0.0, 0.0]]
    assert scene.settings.duration == 3600.0
    assert scene.sea.omega.size == 130
    assert scene.planar


def test_all_of_a_platforms_table_reaches_the_solver(buan_tables, study_of):
    table = buan_tables["platform"]
    table |= {"legs": ["leg3", "leg1"], "damping_ratio": 0.03, "rayleigh_mass": 0.1, "rayleigh_stiffness": 0.2}
    table |= {"wave_inertia": "relative", "geometric_stiffness": True, "damping_of": "dry"}
    table["sections"]["deck"] |= {"width": 0.9, "height": 0.4}
    platform = scenes.scene(task(study_of(buan_tables), platform="elastic").parameters).platform
    assert (platform.legs, platform.damping_ratio) == (("leg3", "leg1"), 0.03)
    assert (platform.rayleigh_mass, platform.rayleigh_stiffness, platform.damping_of) == (0.1, 0.2, "dry")
    assert (platform.wave_inertia, platform.geometric_stiffness) == ("relative", True)
    assert {m.section for m in platform.frame.members} == {tube(0.45, 0.012), solid_rectangle(0.9, 0.4)}
    leg, row = platform.frame.members[0], table["members"][0]
    assert (leg.name, leg.start, leg.end) == (row["name"], row["start"], row["end"])
    assert (leg.drag_coefficient, leg.inertia_coefficient) == (1.0, 2.0)
    assert (leg.material.E, leg.material.G, leg.material.density) == (2.1e11, 8.33e10, 8012.23)


GENERAL = {"area": 0.1, "Iy": 2e-3, "Iz": 1e-3, "J": 1e-3, "fibres": [[0.1, 0.2], [0.0, -0.3]], "wall": 0.02}
SECTIONS = {
    "box": ({"width": 0.6, "height": 0.5, "thickness": 0.02}, box(0.6, 0.5, 0.02)),
    "i-beam": ({"width": 0.6, "height": 0.5, "flange": 0.03, "web": 0.02}, i_beam(0.6, 0.5, 0.03, 0.02)),
    "general": (GENERAL, general(0.1, 2e-3, 1e-3, 1e-3, ((0.1, 0.2), (0.0, -0.3)), 0.02)),
}


@pytest.mark.parametrize("shape", SECTIONS)
def test_sections_of_every_shape_reach_the_solver(buan_tables, study_of, shape):
    numbers, section = SECTIONS[shape]
    buan_tables["platform"]["sections"]["deck"] = {"shape": shape, "shear_factor": 0.5, **numbers}
    study = study_of(buan_tables)
    members = scenes.scene(task(study, platform="elastic").parameters).platform.frame.members
    assert {m.section for m in members} == {tube(0.45, 0.012), replace(section, shear_factor=0.5)}
    assert len(list(sketch.members(sketch.first_scene(study.content)))) == len(members)


def test_shear_factors_are_of_the_section_and_cowpers_of_the_material(buan_tables, study_of):
    sections = buan_tables["platform"]["sections"]
    sections["leg"]["shear_factor"], sections["deck"]["shear_factor"] = 0.6, "cowper"
    members = scenes.scene(task(study_of(buan_tables), platform="elastic").parameters).platform.frame.members
    poisson = 2.1e11 / (2 * 8.33e10) - 1
    assert members[0].section.shear_factor == 0.6
    assert members[-1].section.shear_factor == approx(10 * (1 + poisson) / (12 + 11 * poisson))
    sections["leg"]["shear_factor"] = "cowper"
    leg = scenes.scene(task(study_of(buan_tables), platform="elastic").parameters).platform.frame.members[0]
    assert leg.section.shear_factor == tube_shear_factor(0.45, 0.012, poisson)


def test_feet_on_springs_and_masses_with_a_body_reach_the_solver(buan_tables, study_of):
    table = buan_tables["platform"]
    rows = (np.eye(6) * 1e8).tolist()
    table["clamped"], six = ["foot1", "foot2"], [1e8, 1e8, 1e9, 2e9, 2e9, 1e9]
    table["foundation"] = {"foot3": six, "foot4": rows}
    table["masses"][0] |= {"cog": [0.0, 0.1, 2.0], "inertia": [3e3, 4e3, 5e3], "products_of_inertia": [1.0, 2.0, 3.0]}
    platform = scenes.scene(task(study_of(buan_tables), platform="elastic-no-floats").parameters).platform
    assert platform.frame.grounded == ("foot1", "foot2", "foot3", "foot4")
    assert platform.frame.foundation_matrix("foot3").tolist() == np.diag(six).tolist()
    assert platform.frame.foundation_matrix("foot4").tolist() == rows
    body = platform.frame.masses[0]
    assert (body.cog, body.inertia) == ((0.0, 0.1, 2.0), (3e3, 4e3, 5e3))
    assert body.products_of_inertia == (1.0, 2.0, 3.0)


def test_soil_reaches_the_solver_below_the_waters_depth(buan_tables, study_of):
    table = buan_tables["platform"]
    table["soil"] = [
        {"depth": 0, "lateral": 1e6, "axial": 2e6, "torsional": 3e6},
        {"depth": 5, "lateral": 4e6},
    ]
    table["nodes"]["tip"] = [-1.5, 1.2, -60.0]
    pile = {"name": "pile", "start": "tip", "end": "foot1", "section": "leg", "material": "steel"}
    table["members"].append(pile)
    table["clamped"] = ["foot2", "foot3", "foot4"]
    frame = scenes.scene(task(study_of(buan_tables), platform="elastic").parameters).platform.frame
    assert frame.seabed == -50.0
    assert frame.soil.stiffness(np.array([-50.0, -52.5, -55.0, -70.0])).tolist() == [
        [2e6, 1e6, 3e6], [1e6, 2.5e6, 1.5e6], [0, 4e6, 0], [0, 4e6, 0]
    ]  # fmt: skip
    assert sketch.whole(sketch.first_scene(study_of(buan_tables).content)).low < -60.0
    assert [m.name for m in frame.buried] == ["pile"]


def test_a_taper_reaches_the_solver(buan_tables, study_of):
    table = buan_tables["platform"]
    table["sections"]["top"] = {"shape": "tube", "diameter": 0.3, "thickness": 0.01, "shear_factor": "cowper"}
    table["sections"]["leg"]["shear_factor"] = "cowper"
    table["members"][0]["end_section"] = "top"
    frame = scenes.scene(task(study_of(buan_tables), platform="elastic").parameters).platform.frame
    poisson = frame.members[0].material.poisson
    assert frame.members[0].end_section == replace(tube(0.3, 0.01), shear_factor=tube_shear_factor(0.3, 0.01, poisson))
    table["members"][0]["end_section"] = "pot"
    study = study_of(buan_tables)
    with pytest.raises(InputError, match=r"platform\.members\.leg1\.end_section = pot: must be one of leg, deck, top"):
        scenes.scene(task(study, platform="elastic").parameters)


def test_releases_reach_the_solver_in_one_order(buan_tables, study_of):
    ring = buan_tables["platform"]["members"][-1]
    ring["start_release"], ring["end_release"] = ["Mz", "My"], ["My"]
    ring["end_spring"] = [0, 0, 0, 0, 5e6, 0]
    study = study_of(buan_tables)
    member = scenes.scene(task(study, platform="elastic").parameters).platform.frame.members[-1]
    assert (member.start_release, member.end_release) == (("My", "Mz"), ("My",))
    assert (member.start_spring, member.end_spring) == ((0,) * 6, (0, 0, 0, 0, 5e6, 0))
    ring["start_release"] = ["My", "Mz"]
    assert task(study_of(buan_tables), platform="elastic").id == task(study, platform="elastic").id
    ring["start_release"] = ["My", "Mz", "My"]
    with pytest.raises(InputError, match=r"start_release = My: given 2 times, must be unique"):
        scenes.scene(task(study_of(buan_tables), platform="elastic").parameters)


def test_a_foundation_is_an_axis_that_is_not_called_as_a_dimension_of_records_is(study_of):
    tables = tomllib.loads(SMALL)
    soft, stiff = [[k] * 6 for k in (1e8, 1e10)]
    tables["platform"] |= {"clamped": [], "foundation": {"foot": soft}}
    tables["axes"] = {"sea_state": ["calm"], "platform.foundation.foot": [soft, stiff]}
    study = study_of(tables)
    found = {t.parameters.platform.foundation["foot"] for t in expand(study.content)}
    assert found == {tuple(soft), tuple(stiff)}
    assert [axis.name for axis in study.content.varied] == ["platform.foundation.foot"]  # `foot` is that of reactions


def test_fixed_has_no_frame_and_no_floats_has_none(buan_tables, study_of):
    study = study_of(buan_tables)
    assert scenes.scene(task(study, platform="fixed").parameters).platform is None
    assert scenes.scene(task(study, platform="elastic-no-floats").parameters).floats == ()


def test_elastic_and_fixed_see_the_same_elevation(buan_tables, study_of):
    study = study_of(buan_tables)
    a, b = (scenes.sea(task(study, platform=p, seed=1).parameters) for p in ("elastic", "fixed"))
    np.testing.assert_array_equal(a.amplitude, b.amplitude)
    np.testing.assert_array_equal(a.omega, b.omega)


@pytest.mark.parametrize("band", [(0.1, 3.4), (0.7, 15.0), (0.7, 3.4)])
def test_coefficients_cover_the_waves(buan_tables, study_of, band):
    study = study_of(buan_tables)
    geometry = geometry_of(task(study, platform="fixed").parameters).model_copy(update={"band": band})
    arguments = bem_arguments(geometry)
    omega = arguments["omega"]
    assert arguments["waves_to"] == band[1]
    assert omega[0] <= band[0]
    assert omega[-1] >= band[1]
    assert (np.diff(omega) > 0).all()


def test_coefficients_are_those_of_the_tasks_water_direction_and_accuracy(buan_tables, study_of):
    buan_tables["water"] = {"depth": 40.0, "density": 1000.0, "gravity": 9.8}
    buan_tables["waves"]["heading"] = 0.5
    buan_tables["solver"]["tolerance"] = 1e-4
    arguments = bem_arguments(geometry_of(task(study_of(buan_tables), platform="fixed").parameters))
    assert [arguments[name] for name in ("depth", "density", "gravity", "heading")] == [40.0, 1000.0, 9.8, 0.5]
    assert arguments["panels"] == panels_for(1e-4) != panels_for(None) and not arguments["planar"]
    assert arguments["centres"].tolist() == [[-3.86, 0.0, 0.0], [3.86, 0.0, 0.0]]


def test_floats_without_interaction_have_coefficients_of_their_own(buan_tables, study_of):
    both = geometry_of(task(study_of(buan_tables), platform="fixed").parameters)
    buan_tables["solver"]["interaction"] = False
    alone = geometry_of(task(study_of(buan_tables), platform="fixed").parameters)
    assert alone.key != both.key and bem_arguments(alone)["interaction"] is False
    assert len(bem_arguments(alone)["omega"]) < len(bem_arguments(both)["omega"])  # nothing is reflected to and fro
    del buan_tables["floats"][1]
    one = geometry_of(task(study_of(buan_tables), platform="fixed").parameters)
    buan_tables["solver"]["interaction"] = True
    assert one.key == geometry_of(task(study_of(buan_tables), platform="fixed").parameters).key


def test_damping_lids_have_coefficients_of_their_own(buan_tables, study_of):
    usual = geometry_of(task(study_of(buan_tables), platform="fixed").parameters)
    assert not {"gap_damping", "gap_width"} & usual.model_dump(exclude_defaults=True).keys()
    buan_tables["solver"] |= {"gap_damping": 0.05, "gap_width": 0.5}
    lidded = geometry_of(task(study_of(buan_tables), platform="fixed").parameters)
    buan_tables["solver"] |= {"gap_damping": 0.1}
    assert len({usual.key, lidded.key, geometry_of(task(study_of(buan_tables), platform="fixed").parameters).key}) == 3
    arguments = bem_arguments(lidded)
    assert (arguments["gap_damping"], arguments["gap_width"]) == (0.05, 0.5)


def test_scenes_that_ask_nothing_of_coefficients_have_none(buan_tables, study_of):
    """As from Python; but linear pressure does, and so does that on a hull that stands on the seabed."""
    buan_tables["solver"] |= {"radiation": False, "diffraction": False}
    assert geometry_of(task(study_of(buan_tables), platform="fixed").parameters) is None
    buan_tables["solver"]["froude_krylov"] = "linear"
    assert geometry_of(task(study_of(buan_tables), platform="fixed").parameters) is not None
    del buan_tables["solver"]["froude_krylov"]
    foot = {"shape": "vertical-cylinder", "radius": 1.0, "draft": buan_tables["water"]["depth"], "freeboard": 0.6}
    standing = buan_tables["floats"][0] | {"hull": foot, "motion": []}
    buan_tables["floats"] = [standing]
    assert geometry_of(task(study_of(buan_tables), platform="fixed").parameters) is not None


def test_scenes_whose_drift_is_asked_for_have_coefficients_with_a_far_field(buan_tables, study_of):
    usual = geometry_of(task(study_of(buan_tables), platform="fixed").parameters)
    buan_tables["solver"] |= {"method": "frequency", "froude_krylov": "linear"}
    lines = geometry_of(task(study_of(buan_tables), platform="fixed").parameters)
    buan_tables["record"]["outputs"] = ["drift"]
    drift = geometry_of(task(study_of(buan_tables), platform="fixed").parameters)
    assert lines.key == usual.key != drift.key
    assert bem_arguments(drift)["far_field"] and not bem_arguments(usual)["far_field"]


def test_all_that_the_solver_has_against_a_part_is_told():
    keys = [f"floats.buoy.{name}" for name in ("mass", "inertia", "cog")]
    told = objections(lambda: refuse(InputError(key, -1.0, "must be > 0") for key in keys))
    assert [error.key for error in told] == keys


@pytest.mark.parametrize("joined", [True, False])
def test_a_float_on_another_beside_a_platform_is_refused_for_that(buan_tables, study_of, joined):
    """Whether members join the node that comes with it or not; on the fixed platform it may be."""
    buan_tables["floats"][1]["on"] = "front"
    platform = buan_tables["platform"]
    if not joined:
        platform["members"] = [m for m in platform["members"] if "hinge:rear" not in (m["start"], m["end"])]
    told = "floats.rear.on = front: must be empty: the platform carries every float"
    assert [str(problem) for problem in problems(study_of(buan_tables).content)] == [told]
    buan_tables["axes"]["platform"] = ["fixed"]
    assert not any(told in str(problem) for problem in problems(study_of(buan_tables).content))
