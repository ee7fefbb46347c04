"""Studies that stand on others."""

from pathlib import Path

import pytest

from pipeline.bridge.loading import load
from pipeline.study.inherit import merged, rooted
from pipeline.study.reading import StudyError

STUDIES = Path(__file__).parents[3] / "studies"


def test_tables_merge_by_key_and_named_lists_by_name():
    base = {"a": {"x": 1, "y": 2}, "floats": [{"name": "f", "mass": 1.0}, {"name": "r", "mass": 1.0}], "v": [1, 2]}
    upper = {"a": {"y": 3}, "floats": [{"name": "r", "mass": 2.0}, {"name": "new"}], "v": [4]}
    assert merged(base, upper) == {
        "a": {"x": 1, "y": 3},
        "floats": [{"name": "f", "mass": 1.0}, {"name": "r", "mass": 2.0}, {"name": "new"}],
        "v": [4],
    }


def test_a_table_of_another_kind_takes_nothing_over():
    base = {"hull": {"shape": "sphere", "radius": 5.0, "draft": 5.0}}
    assert merged(base, {"hull": {"shape": "sphere", "draft": 4.0}})["hull"]["radius"] == 5.0
    assert merged(base, {"hull": {"draft": 4.0}})["hull"] == base["hull"] | {"draft": 4.0}
    other = {"hull": {"shape": "profile", "points": [[1.0, -1.0], [1.0, 1.0]]}}
    assert merged(base, other) == other


@pytest.mark.parametrize(
    ("base", "upper", "left"),
    [
        ('{ Hs = 0.7, Tp = 5.0 }', '{ kind = "regular", height = 0.5, period = 6.0 }', {"height": 0.5, "period": 6.0}),
        ('{ Hs = 0.7, Tp = 5.0 }', '{ kind = "irregular", Tp = 6.0 }', {"Hs": 0.7, "Tp": 6.0}),
        ('{ kind = "white-noise", Hs = 0.7 }', '{ kind = "irregular", Hs = 0.5, Tp = 6.0 }', {"Hs": 0.5, "Tp": 6.0}),
        ('{ kind = "regular", height = 0.5, period = 6.0 }', "{ height = 0.4 }", {"height": 0.4, "period": 6.0}),
    ],
)  # fmt: skip
def test_a_sea_that_leaves_its_kind_out_is_irregular(small, tmp_path, base, upper, left):
    (tmp_path / "sea.toml").write_text(f'base = "small.toml"\n[sea_states]\nnew = {base}\n')
    (tmp_path / "above.toml").write_text(f'base = "sea.toml"\n[sea_states]\nnew = {upper}\n')
    sea = load(tmp_path / "above.toml").content.sea_states["new"]
    assert {key: getattr(sea, key) for key in sea.model_fields_set - {"kind"}} == left


def test_seas_may_have_any_label():
    base = {"sea_states": {"calm": {"Hs": 1.0, "Tp": 5.0}, "kind": {"Hs": 1.0, "Tp": 6.0}}}
    both = merged(base, {"sea_states": {"kind": {"Hs": 2.0}, "shape": {"Hs": 3.0}}})["sea_states"]
    assert both == {"calm": base["sea_states"]["calm"], "kind": {"Hs": 2.0, "Tp": 6.0}, "shape": {"Hs": 3.0}}


def test_a_sample_of_another_form_takes_nothing_over():
    span, normal = {"from": 1.0, "to": 3.0, "spacing": "log"}, {"mean": 2.0, "std": 0.1}
    assert merged(span, normal) == normal and merged(normal, {"from": 1.0, "to": 2.0}) == {"from": 1.0, "to": 2.0}
    assert merged(span, {"to": 2.0}) == span | {"to": 2.0} and merged(normal, {"std": 0.2}) == normal | {"std": 0.2}


def test_only_what_differs_is_different(small, tmp_path):
    (tmp_path / "heavy.toml").write_text('base = "small.toml"\n[[floats]]\nname = "front"\npto_damping = 2e5\n')
    base, heavy = load(small), load(tmp_path / "heavy.toml")
    assert heavy.bases == (small,)
    assert heavy.content.floats[0].pto_damping == 2e5
    same = {"pto_damping": base.content.floats[0].pto_damping}
    floats = (heavy.content.floats[0].model_copy(update=same),)
    assert heavy.content.model_copy(update={"floats": floats}) == base.content


def test_a_base_that_changes_nothing_has_the_same_tasks(small, tmp_path):
    (tmp_path / "twin.toml").write_text('base = "small.toml"\n')
    assert list(load(small).tasks.ids) == list(load(tmp_path / "twin.toml").tasks.ids)


def test_published_numbers_come_with_the_nearest_base(small, tmp_path):
    (tmp_path / "twin.toml").write_text('base = "small.toml"\n')
    assert load(tmp_path / "twin.toml").published is None
    (tmp_path / "small-published.csv").write_text("")
    assert load(tmp_path / "twin.toml").published == tmp_path / "small-published.csv"
    (tmp_path / "twin-published.csv").write_text("")
    assert load(tmp_path / "twin.toml").published == tmp_path / "twin-published.csv"


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ('base = "none.toml"', "base = 'none.toml': no such file; .* has "),
        ("base = 7", "base = 7: "),
        ('base = "own.toml"', "base = 'own.toml': must be another study file"),
        ('base = "back.toml"', "back.toml: base = 'own.toml': must be another study file"),
        (
            'base = "small.toml"\n[[floats]]\nname = "front"\nmass = -1.0',
            r"own.toml: floats\[0\].mass = -1.0: must be > 0",
        ),
    ],
)
def test_bad_bases_are_named(small, tmp_path, text, words):
    (tmp_path / "back.toml").write_text('base = "own.toml"')
    (tmp_path / "own.toml").write_text(text)
    with pytest.raises(StudyError, match=words):
        load(tmp_path / "own.toml")


def test_files_are_found_beside_the_base():
    tables = {"floats": [{"hull": {"shape": "mesh", "file": "barge.gdf"}}], "file": 3}
    absolute = rooted(tables, STUDIES)
    assert absolute["floats"][0]["hull"]["file"] == str(STUDIES / "barge.gdf")
    assert absolute["file"] == 3
