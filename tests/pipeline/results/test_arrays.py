"""Variables over the cells of a study: each number where its labels are, in whatever order records have them."""

import numpy as np

from pipeline.results.arrays import INNER, Arrays
from pipeline.results.netcdf import Variable, content
from pipeline.study.axes import TAKEN
from solver.record.channels import DIMS


def record(floats, values):
    """Two motions of each float, the float's dimension last."""
    return {
        "float": Variable(("float",), np.array(floats, object), {}),
        "axis": Variable(("axis",), np.array(["heave", "surge"], object), {}),
        "motion": Variable(("axis", "float"), np.array(values, float), {}),
    }


def test_numbers_stand_where_their_labels_are_whatever_the_order(tmp_path):
    arrays = Arrays((2,), tmp_path)
    arrays.add([(0,)], record(["rear", "front"], [[1, 2], [3, 4]]))
    arrays.add([(1,)], record(["front", "aft", "rear"], [[5, 6, 7], [8, 9, 10]]))
    arrays.sort("float")
    assert list(arrays.labels["float"]) == ["aft", "front", "rear"] and list(arrays.labels["axis"]) == [
        "heave",
        "surge",
    ]
    assert arrays.dims["motion"] == ("float", "axis")
    expected = [[[np.nan] * 2, [2, 4], [1, 3]], [[6, 9], [5, 8], [7, 10]]]
    np.testing.assert_array_equal(arrays.whole("motion"), expected)


def test_a_dataset_has_a_place_for_all_that_records_hold():
    """What has a dimension unknown to the dataset is left out of it, and no axis of a study may be called so."""
    dims = {dim for inner in DIMS.values() for dim in inner}
    assert dims <= set(INNER) and dims <= TAKEN


def test_records_of_one_form_stand_in_their_own_cells(tmp_path):
    """Two at once: what both have, and what each has of its own, with the dimension `task` first or not at all."""
    one, other = record(["rear", "front"], [[1, 2], [3, 4]]), record(["rear", "front"], [[5, 6], [7, 8]])
    both = {
        **one,
        "motion": Variable(("task", "axis", "float"), np.stack([r["motion"].values for r in (one, other)]), {}),
        "speed": Variable(("task",), np.array([0.5, 0.7]), {}),
        "depth": Variable((), np.array(9.0), {}),
    }
    alone, arrays = Arrays((2, 3), tmp_path), Arrays((2, 3), tmp_path)
    arrays.add([(1, 2), (0, 1)], both)
    arrays.put([(1, 2), (0, 1)], "wall_time", [1.5, 2.5])
    for cell, part, height, seconds in (((1, 2), one, 0.5, 1.5), ((0, 1), other, 0.7, 2.5)):
        alone.add([cell], part | {"speed": Variable((), np.array(height), {}), "depth": both["depth"]})
        alone.put([cell], "wall_time", [seconds])
    assert arrays.dims == alone.dims
    for name in ("motion", "speed", "depth", "wall_time"):
        np.testing.assert_array_equal(arrays.whole(name), alone.whole(name))
    assert arrays.whole("speed")[1, 2] == 0.5 and np.isnan(arrays.whole("speed")[0, 0])


def test_content_knows_values_of_the_same_bits_by_their_type():
    whole, real, other = (Variable(("x",), np.zeros(3, kind), {}) for kind in ("i8", "f8", "f8"))
    assert content({"a": real}) == content({"a": other}) != content({"a": whole})
    assert content({"a": real}) != content({"a": real._replace(attrs={"units": "m"})})
    assert content({"a": real}) != content({"a": real._replace(dims=("y",))})
