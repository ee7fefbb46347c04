"""Tables of a study become the solver's inputs, and only there."""

import numpy as np
import pytest

from pipeline.bridge import scenes
from pipeline.bridge.geometry import bem_arguments, geometry_of
from pipeline.tasks.task import expand


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
    omega = bem_arguments(geometry)["omega"]
    assert omega[0] <= band[0]
    assert omega[-1] >= band[1]
    assert (np.diff(omega) > 0).all()
