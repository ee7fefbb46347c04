"""Axes over any key: what a path reaches, what each task becomes, and what is wrong with a path or its values."""

import re
import tomllib
from pathlib import Path
from typing import get_args

import numpy as np
import pytest
from pydantic import BaseModel

from pipeline.bridge.checks import problems
from pipeline.bridge.loading import load
from pipeline.results.variables import VARIABLES, along, meaning_of
from pipeline.study.axes import TAKEN, Axis, Samples
from pipeline.study.paths import PathError, with_value
from pipeline.study.reading import StudyError
from pipeline.study.schema import StudyFile
from pipeline.tasks.select import select
from pipeline.tasks.task import axes, dimensions, expand, first_labels, firsts, standing_for


def varied(small, *lines):
    """The small study with these lines under [axes]."""
    text = small.read_text()
    small.write_text(text.replace("[axes]\n", "[axes]\n" + "\n".join(lines) + "\n", 1))
    return load(small)


REACHED = [
    ("floats.front.mass", 2000.0, lambda p: p.floats[0].mass),
    ("floats.*.hull.radius", 0.9, lambda p: p.floats[0].hull.radius),
    ("floats.front.hinge", (-1.5, 0.0, 2.5), lambda p: p.floats[0].hinge),
    ("floats.front.hinge.0", -1.8, lambda p: p.floats[0].hinge[0]),
    ("floats.*.arm.2", -2.5, lambda p: p.floats[0].arm[2]),
    ("platform.nodes.foot.2", -49.0, lambda p: p.platform.nodes["foot"][2]),
    ("platform.damping_ratio", 0.02, lambda p: p.platform.damping_ratio),
    ("platform.sections.tube.thickness", 0.04, lambda p: p.platform.sections["tube"].thickness),
    ("platform.members.leg.elements", 6, lambda p: p.platform.members[0].elements),
    ("platform.materials.*.E", 2e11, lambda p: p.platform.materials["steel"].E),
    ("platform.nodes.foot", (-1.5, 0.0, -49.0), lambda p: p.platform.nodes["foot"]),
    ("water.depth", 60.0, lambda p: p.water.depth),
    ("waves.heading", 3.0, lambda p: p.waves.heading),
    ("sea.Hs", 0.9, lambda p: p.sea_state.Hs),
    ("sea_states.calm.Tp", 6.0, lambda p: p.sea_state.Tp),
    ("solver.froude_krylov", "linear", lambda p: p.solver.froude_krylov),
    ("solver.diffraction", False, lambda p: p.solver.diffraction),
    ("solver.interaction", False, lambda p: p.solver.interaction),
    ("record.duration", 600.0, lambda p: p.record.duration),
]


@pytest.mark.parametrize(("path", "value", "read"), REACHED, ids=[row[0] for row in REACHED])
def test_a_path_reaches_its_key_and_leaves_all_else(small, path, value, read):
    before = next(iter(expand(load(small).content))).parameters
    content = with_value(load(small).content, path, list(value) if isinstance(value, tuple) else value)
    after = next(iter(expand(content))).parameters
    assert read(after) == value != read(before)
    back = list(read(before)) if isinstance(value, tuple) else read(before)
    assert next(iter(expand(with_value(content, path, back)))).id == next(iter(expand(load(small).content))).id


def test_a_name_may_have_dots(small):
    text = small.read_text().replace('sea_state = ["calm", "rough"]', 'sea_state = ["calm.2"]')
    small.write_text(text + '"calm.2" = { Hs = 0.4, Tp = 5.0 }\n')
    content = with_value(load(small).content, "sea_states.calm.2.Hs", 0.3)
    assert (content.sea_states["calm"].Hs, content.sea_states["calm.2"].Hs) == (0.5, 0.3)


def with_more(small, *others):
    """The text of the small study without its platform, and with floats like `front` beside it, by name and place."""
    text = small.read_text()
    text = text[: text.index("[platform]")] + text[text.index("[axes]") :]
    text = text.replace('["elastic", "fixed", "elastic-no-floats"]', '["fixed"]')
    first = text[text.index("[[floats]]") : text.index("[axes]")]
    more = [first.replace('"front"', f'"{name}"').replace("[-1.5, 0.0", f"[{x}, 0.0") for name, x in others]
    return text.replace("[axes]", "".join(more) + "[axes]", 1)


def test_a_star_stands_for_the_rest_of_a_name(small):
    """front and far but not rear; a pattern that fits nobody is a slip."""
    small.write_text(with_more(small, ("far", -9.5), ("rear", 9.5)))
    content = with_value(load(small).content, "floats.f*.mass", 2000.0)
    assert [f.mass for f in content.floats] == [2000.0, 2000.0, 2147.0]
    with pytest.raises(PathError, match="leads nowhere: floats has front, far, rear"):
        with_value(content, "floats.g*.mass", 2000.0)


def test_a_float_left_out_is_as_one_never_named(small):
    """The same tasks, left out by the study or by a variant of it."""
    both = with_more(small, ("second", 9.5))
    small.write_text(with_more(small))
    alone = {task.id for task in load(small).tasks}
    small.write_text(both)
    assert alone.isdisjoint(task.id for task in load(small).tasks)
    small.write_text('left_out = ["second"]\n' + both)
    assert {task.id for task in load(small).tasks} == alone
    small.write_text(
        both.replace("[sea_states]", "[variants.both]\n[variants.alone]\nleft_out = ['second']\n[sea_states]")
    )
    tasks = list(load(small).tasks)
    assert {task.id for task in tasks if task.labels["variant"] == "alone"} == alone and len(tasks) == 2 * len(alone)


def test_keys_in_no_table_are_axes_by_their_names(small):
    """By themselves, together with others, and of a base in another folder, whose files are found beside it."""

    def above(text, folder="."):
        path = small.parent / folder / "above.toml"
        path.parent.mkdir(exist_ok=True)
        path.write_text(text)
        return list(load(path).tasks)

    small.write_text(with_more(small, ("second", 9.5)))
    base, left = f'base = "{small.name}"\n', 'left_out = [[], ["second"]]\n'
    ids = {task.id for text in ("", 'left_out = ["second"]\n') for task in above(base + text)}
    alone, together = (
        above(base + table + left)
        for table in ("[axes]\n", '[[axes.together]]\nname = "how"\n"floats.front.mass" = [2147.0, 2147.0]\n')
    )
    assert {task.id for task in alone} == ids == {task.id for task in together}
    assert {task.labels["left_out"] for task in alone} == {"[]", '["second"]'}
    assert {task.labels["how"] for task in together} == {1, 2}
    for name in ("a.nc", "b.nc"):
        small.with_name(name).write_text(name)
    files = above(f'{base}[axes]\ncoefficients = ["a.nc", "b.nc"]\n')
    assert len({task.id for task in files}) == len(ids)
    assert [t.id for t in above('base = "../above.toml"\n', "upper")] == [t.id for t in files]


def test_what_is_left_out_carries_nothing_that_stays(small):
    text = with_more(small, ("second", 9.5), ("third", 19.0))
    text = text.replace('name = "second"', 'name = "second"\non = "front"')
    left = "[variants.both]\n[variants.none]\nleft_out = ['front']\n[sea_states]"
    small.write_text(text.replace("[sea_states]", left))
    with pytest.raises(StudyError) as caught:
        load(small)
    told = "variant = none: left_out = front: must not carry a float that stays: floats.second.on = front"
    assert [text.partition("small.toml: ")[2] for text in caught.value.problems] == [told]
    small.write_text(text.replace("[sea_states]", left.replace("['front']", "['front', 'second']")))
    assert [f.name for f in list(load(small).tasks)[-1].parameters.floats] == ["third"]


def test_above_a_height_other_values_hold_and_calm_seas_keep_their_tasks(small):
    """A brake, or floats lifted out; the task is that of a study that says so of its floats in all seas."""
    plain = small.read_text()

    def ids(above, below=""):
        small.write_text(below + plain.replace("[sea_states]", f"{above}\n[sea_states]"))
        return {(t.labels["sea_state"], t.labels["platform"], t.labels["seed"]): t.id for t in load(small).tasks}

    usual, rough = ids(""), load(small).content.sea_states["rough"].Hs
    assert rough > 0.5 == load(small).content.sea_states["calm"].Hs
    braked = ids("[survival]\nHs = 0.5\n'floats.*.coulomb' = 1e9")
    everywhere = ids("[variants.a]\n'floats.*.coulomb' = 1e9")
    for where, name in usual.items():
        bare = where[1] == "elastic-no-floats"
        assert braked[where] == (name if where[0] == "calm" or bare else everywhere[where])
        assert (everywhere[where] == name) == bare
    # Below the height, and where a variant says never, nothing changes.
    assert ids(f"[survival]\nHs = {rough - 1e-6}\n[survival.floats.front]\ncoulomb = 1e9") == braked
    off = ids("[survival]\nHs = 0.5\n'floats.*.coulomb' = 1e9\n[variants.off]\n'survival.Hs' = 100.0")
    assert off == usual
    small.write_text(plain.replace("[sea_states]", "[survival]\nHs = 0.5\nleft_out = ['front']\n[sea_states]")
                     .replace('["elastic", "fixed", "elastic-no-floats"]', '["elastic"]'))  # fmt: skip
    lifted = {t.labels["sea_state"]: [f.name for f in t.parameters.floats] for t in load(small).tasks}
    assert lifted == {"calm": ["front"], "rough": []}
    more = with_more(small, ("second", 9.5), ("third", 19.0)).replace('["elastic"]', '["fixed"]')
    small.write_text('left_out = ["third"]\n' + more)  # which does not come back
    lifted = {t.labels["sea_state"]: [f.name for f in t.parameters.floats] for t in load(small).tasks}
    assert lifted == {"calm": ["front", "second"], "rough": ["second"]}


def test_damping_above_a_height_holds_along_the_axis_of_all_floats(small):
    """By either axis the same tasks; of two floats the one that survival does not name keeps the axis's damping."""
    plain = with_more(small, ("second", 9.5))
    keys = "'floats.front.pto_damping' = 7e4\n'floats.*.coulomb' = 1e3"
    above = f"[survival]\nHs = 0.5\n{keys}\n[axes]\n{{}} = [1e5, 2e5]\n"

    def tasks(axis):
        small.write_text(plain.replace("[axes]\n", above.format(axis)))
        return list(load(small).tasks)

    named = tasks("pto_damping")
    told = {
        (t.labels["sea_state"], t.labels["pto_damping"]): tuple(f.pto_damping for f in t.parameters.floats)
        for t in named
        if t.parameters.floats
    }
    assert told == {(sea, c): (7e4 if sea == "rough" else c, c) for sea in ("calm", "rough") for c in (1e5, 2e5)}
    assert {t.id for t in named} == {t.id for t in tasks("'floats.*.pto_damping'")}


def test_hinges_above_a_height_and_an_axis_over_their_distance_are_refused(small):
    above = "[survival]\nHs = 0.5\n'floats.front.hinge.0' = -3.0\n[axes]\nhinge_spacing = [18.0, 19.0]\n"
    small.write_text(with_more(small, ("second", 9.5)).replace("[axes]\n", above))
    with pytest.raises(StudyError, match=r'survival."floats.front.hinge.0" = -3.0: must be left out beside axes.hinge'):
        load(small)


TOGETHER = """[[axes.together]]
name = "tune"
"length [m]" = [5.0, 1.0, 3.0, 1.0]
"floats.front.stiffness" = [3.0, 2.0, 2.0, 1.0]
"floats.front.cog" = [[0.0, 0.0, 0.3], [0.0, 0.0, 0.1], [0.0, 0.0, 0.2], [0.0, 0.0, 0.1]]
"""
NAMELESS = "[[platform.marine_growth]]\ndepth = 0.0\nthickness = 0.05\ndensity = 1300.0\n[variants.a]\n[variants.b]\n"
WRONG = [
    (f"{NAMELESS}'platform.marine_growth' = 0.1", ("without names; go on with * for all of them, and a key: platform."
     "marine_growth.*.depth, platform.marine_growth.*.thickness")),
    (f"{NAMELESS}'platform.marine_growth.0.depth' = 0.1", "platform.marine_growth are tables without names; * stands"),
    (f"{NAMELESS}'platform.marine_growth.*.thick' = 0.1", "did you mean platform.marine_growth.*.thickness?"),
    ("[survival]\n'floats.*.coulomb' = 1e9", "survival.Hs: is missing"),
    ("[survival]\nHs = 50.0\n'floats.*.coulomb' = 1e9", "survival.Hs = 50.0: no sea of the study is above"),
    ("[survival]\nHs = 0.5", "survival = {}: needs keys that change"),
    ("[survival]\nHs = 0.5\n'floats.*.coulom' = 1e9", "leads nowhere; did you mean floats.front.coulomb?"),
    ("[survival]\nHs = 0.5\n'floats.*.coulomb' = -1.0", 'survival."floats.*.coulomb" = -1.0: must be >= 0'),
    ("[survival]\nHs = 0.5\n'sea.Hs' = 1.0", 'survival."sea.Hs" = 1.0: must be a key of floats, left_out'),
    ("[survival]\nHs = 0.5\n'floats.*.damping' = [1.0, 2.0]", "survival.Hs = 0.5: floats.front.damping = "),
    ("left_out = ['rear']", "left_out = rear: must be one of the floats: front"),
    ('"floats.*.pto_damping" = [-1.0]', 'axes."floats.*.pto_damping" = -1.0: must be >= 0 N m s/rad'),
    ('"floats.frnt.mass" = [1.0]', 'axes."floats.frnt.mass" = 1.0: leads nowhere; did you mean floats.front.mass?'),
    ('"floats.front.mas" = [1.0]', "did you mean floats.front.mass?"),
    ('"float.front.mass" = [1.0]', "did you mean floats.front.mass?"),
    ('"floats.front" = [1.0]', "leads to a table; go on with one of its keys: name, hull, "),
    ('"floats.front.hull" = [1.0]', "leads to a table; go on with one of its keys: shape, "),
    ('"platform.members" = [1.0]', "leads to tables; go on with one of their names or * for all, and a key: "),
    ('"platform.nodes" = [1.0]', "leads to several; go on with one of the names or * for all: "),
    ('"floats.front.mass.kg" = [1.0]', "leads nowhere: floats.front.mass is no table; give its whole value"),
    ('"floats.front.hinge.3" = [1.0]', "floats.front.hinge is a list of 3, the first of which is floats.front.hinge.0"),
    ('"floats.front.hinge.x" = [1.0]', "leads nowhere: floats.front.hinge is a list of 3"),
    ('"floats.front.hinge.0.0" = [1.0]', "leads nowhere: floats.front.hinge.0 is no table"),
    ('"platform.nodes.foot.-1" = [1.0]', "leads nowhere: platform.nodes.foot is a list of 3"),
    ('"floats.front.hinge.0" = ["far"]', 'axes."floats.front.hinge.0" = far: must be a number [m]'),
    ("[[axes.together]]\nname = 'a'\n'water.depth' = [50.0]\nhinge_spacing = [3.0]",
     'axes.together[0].hinge_spacing = [3.0]: is an axis by itself; here "floats.NAME.hinge.0", a float\'s x, is'),
    ("[[axes.together]]\nname = 'a'\n'water.depth' = [50.0]\n'pto_damping [N]' = [3.0]",
     'is an axis by itself; here "floats.*.pto_damping" is varied instead'),
    ("[samples]\ncount = 2\nhinge_spacing = { from = 2.0, to = 4.0 }", 'samples.hinge_spacing = '),
    ('"floats.front.hull.height" = ["tall"]', 'axes."floats.front.hull.height" = tall: must be a number [m]'),
    ('"platform.sections.pipe.diameter" = [1.0]', "leads nowhere: platform.sections has tube"),
    ('"solver.modes" = [0]', 'axes."solver.modes" = 0: must be'),
    ('"solver.froude_krylov" = ["linear", "nonlinear"]', 'axes."solver.froude_krylov" = nonlinear: must be one of'),
    ('"solver.method" = ["time", "frequency"]\n"solver.froude_krylov" = ["linear", "body-nonlinear"]',
     'axes."solver.method" = frequency: with froude_krylov = body-nonlinear: solver.froude_krylov = body-nonlinear: '),
    ('"waves.spreading" = [1.0]', "leads nowhere; waves are long-crested, and a sea has one heading"),
    ('"sea.hs" = [1.0]', "leads nowhere; did you mean sea_states.calm.Hs?"),
    ('"axes.seed" = [1]', "leads nowhere: a study has coefficients, water"),
    ('"water.depth" = [true]', 'axes."water.depth" = true: must be a number [m]'),
    ('"water.depth" = []', 'axes."water.depth" = []: needs at least one value'),
    ('"water.depth" = [60.0, 60]', 'axes."water.depth" = 60.0: given 2 times'),
    ('"water.depth" = 60.0', 'axes."water.depth" = 60.0: must be a list of values, or { from, to, count, spacing }'),
    ('"water.depth" = { from = 1.0, count = 3 }', "axes.\"water.depth\" = {'from': 1.0, 'count': 3}: to: is missing"),
    ('"water.depth" = { from = 60.0, to = 70.0, step = 3 }', "a range has from, to, count and spacing, and not step"),
    ('"water.depth" = { from = -1.0, to = 1.0, count = 3, spacing = "log" }', 'needs numbers > 0'),
    ('"water.depth" = { from = 50.0, to = 60.0, count = 1 }', 'count must be >= 2, for both ends of the range'),
    ('"solver.azimuths" = { from = 8, to = 16, count = 4 }', "must be whole numbers, and this range has 10.6666666667"),
    ("[variants.a]\naxes.seed = { from = 0, to = 1, count = 3 }", "must be whole numbers, and this range has 0.5"),
    ('"water.depth" = [50.0, 0.5]', 'axes."water.depth" = 0.5: '),
    ('"sea.Hs" = [0.2, 9.0]', 'axes."sea.Hs" = 9.0: '),
    ("damping_ratio = [0.1]", "axes.damping_ratio = [0.1]: unknown key"),
    ("[[axes.together]]\nname = 'a'\n'water.depth' = [1.0]\n'water.density' = [1.0, 2.0]", "must be of one length"),
    ("[axes.together]\nname = 'a'\n'water.depth' = [1.0]", "[1.0]}: must be a list of tables"),
    ("[[axes.together]]\n'water.depth' = [50.0]", "axes.together[0].name: is missing"),
    ("[[axes.together]]\nname = 'a'\n'water.depth' = [50.0]\n'a/b' = [1]", "[0].a/b = [1]: must be a dotted path"),
    ("[[axes.together]]\nname = 'seed'\n'water.depth' = [50.0]", "axes.together.name = seed: is the name of another"),
    ("[[axes.together]]\nname = 'motion'\n'water.depth' = [50.0]", "together.name = motion: is the name of another"),
    ("[[axes.together]]\nname = 'a'\n'water.depth' = [50.0]\n'task [s]' = [1]", '"task [s]" = [1]: is the name of '),
    ("[[axes.together]]\nname = 'a'\n'water.depth' = [50.0]\na = [1]", '"a" = [1]: is the name of another dimension'),
    ("[[axes.together]]\nname = 'a'\n'water.depth' = [50.0]\n's [m]' = [1]\ns = [2]", '"s" = [2]: is the name of an'),
    ('"floats.front.name" = ["a", "b"]', "is what others know the part by, and cannot vary"),
    ('"sea.occurrence" = [1.0, 2.0]', 'axes."sea.occurrence" = 1.0: weighs means over sea states, is no'),
    ("[[axes.together]]\nname = 'a'\n'sea_states.calm.occurrence' = [3.0]", 'calm.occurrence" = 3.0: weighs means'),
    ("[samples]\ncount = 2\n'sea.occurrence' = { from = 1.0, to = 1.0 }", 'samples."sea.occurrence" = 1.0: weighs '),
    ("[variants.a]\n[variants.b.sea_states.calm]\nHs = 0.4\noccurrence = 9.0",
     'variants.b."sea_states.calm.occurrence" = 9.0: weighs means over sea states'),
    ('"sea_states.calm" = [{ Hs = 0.4, Tp = 5.0, occurrence = 9.0 }]', "leads to a table; go on with one of its keys"),
    ('"water.depth" = [1979-05-27]', 'axes."water.depth" = 1979-05-27: must be a number [m]'),
    ("[samples]\ncount = 4\n'water.depth' = { from = 0.0, to = 2.0, spacing = 'log' }", 'needs numbers > 0'),
    ("[variants.deep]\n'water.depht' = 60.0", 'variants.deep."water.depht" = 60.0: leads nowhere; did you mean '),
    ("[variants.usual]\n[variants.shallow.water]\ndepth = 0.5", "variant = shallow: "),
    ("[variants.a]\naxes.seeds = [0]", "variants.a.axes.seeds = [0]: must be an axis of the study: sea_state, "),
    ("[variants.a]\naxes.variant = ['a']", "variants.a.axes.variant = ['a']: must be an axis of the study: sea_state"),
    ("[variants.a]\naxes.seed = [0, 7]", "variants.a.axes.seed = 7: must be on the study's own axis: 0, 1"),
    (f"{TOGETHER}[variants.a]\naxes.stiffness = [7.0, 1.0]",
     "variants.a.axes.stiffness = 7.0: must be on the study's own axis: 3.0, 2.0, 1.0"),
    (f"{TOGETHER}[variants.a]\naxes = {{ stiffness = [2.0], tune = [1, 4] }}",
     "variants.a.axes = tune: has no label with all of the values given"),
    ("[variants.a]\naxes.seed = []", "variants.a.axes.seed = []: needs at least one value"),
    ("[variants.a]\naxes.seed = 0", "variants.a.axes.seed = 0: must be a list of values"),
    ("[variants.a]\ntitle = 3", "variants.a.title = 3: must be a string"),
    ("[variants]\na = 3", "variants.a = 3: must be a table"),
    ("[variants.a]\n'water.depth' = 60.0\n[samples]\ncount = 2\n'water.depth' = { from = 50.0, to = 60.0 }",
     'axes = "water.depth": is varied along two dimensions'),
    ("[samples]\ncount = 4", "samples = {'count': 4}: needs ranges of keys by their dotted paths"),
    ("[samples]\ncount = 4\n'floats.front.mas' = { from = 1.0, to = 2.0 }", "did you mean floats.front.mass?"),
    ("[samples]\ncount = 4\n'floats.front.mass' = { mean = 1.0 }", 'samples."floats.front.mass".std: is missing'),
    ("[samples]\ncount = 4\n'floats.front.mass' = 3.0", 'samples."floats.front.mass" = 3.0: must be a table'),
    ("[samples]\ncount = 4\n'floats.front.mass' = { from = 1.0 }", 'samples."floats.front.mass".to: is missing'),
    ("[samples]\ncount = 4\n'floats.front.mass' = { from = 1.0, to = 2.0, upto = 3.0 }", ".upto = 3.0: unknown key;"),
    ("[samples]\ncount = 4\nkeys = 3", 'samples."keys" = 3: unknown key; a key is varied by its dotted'),
    ("[samples]\n'floats.front.mass' = { from = 1.0, to = 2.0 }", "samples.count: is missing"),
    ("[axes.floats.front]\nmas = [1.0]", 'axes."floats.front.mas" = 1.0: leads nowhere; did you mean '),
]  # fmt: skip


@pytest.mark.parametrize(("line", "message"), WRONG, ids=[row[0][:50] for row in WRONG])
def test_a_wrong_path_or_value_is_refused_with_its_key(small, line, message):
    text = small.read_text()
    under = "[sea_states" if line.startswith("[") else "seed = "
    under = "[water]" if line.startswith("left_out") else under
    small.write_text(text.replace(under, f"{line}\n{under}", 1))
    with pytest.raises(StudyError) as caught:
        load(small)
    assert any(message in problem for problem in caught.value.problems), caught.value.problems


def test_a_list_that_is_one_value_is_told_once(small):
    """And not that it has one of its numbers twice."""
    small.write_text(small.read_text().replace("seed = ", '"floats.front.cog" = [0.0, 0.0, -1.0]\nseed = ', 1))
    with pytest.raises(StudyError) as caught:
        load(small)
    (problem,) = caught.value.problems
    assert "must be a list" in problem


def test_more_axes_than_a_dataset_can_have_are_refused(small):
    with pytest.raises(StudyError, match="axes = 30 keys: must be <= 24"):
        varied(small, *(f'"platform.nodes.n{i}" = [[0.0, 0.0, 0.0]]' for i in range(30)))


def test_a_value_for_what_the_study_does_not_have_is_refused(small):
    content = load(small).content.model_copy(update={"platform": None})
    with pytest.raises(PathError, match=r"leads nowhere: the study has no \[platform\]"):
        with_value(content, "platform.damping_ratio", 0.1)


def test_dampings_of_no_float_are_refused_with_their_values(small):
    content = varied(small, "pto_damping = [1e4, 1e5]").content.model_copy(update={"floats": ()})
    assert "axes.pto_damping = [10000.0, 100000.0]: needs [[floats]]" in map(str, problems(content))


def test_ranges_are_written_out(small):
    lines = ('"floats.front.mass" = { from = 2000.0, to = 2200.0, count = 3 }',
             '"floats.*.pto_damping" = { from = 1e4, to = 1e6, count = 3, spacing = "log" }',
             'pto_damping = { from = 1.0, to = 2.0, count = 2 }')  # fmt: skip
    text = small.read_text()
    table = axes(varied(small, *lines[:2]).content)
    assert table["mass"] == (2000.0, 2100.0, 2200.0) and table["pto_damping"] == (1e4, 1e5, 1e6)
    small.write_text(text)
    assert axes(varied(small, lines[2]).content)["pto_damping"] == (1.0, 2.0)


def test_a_range_of_whole_numbers_is_of_whole_numbers(small):
    """Of a path, of keys that change together, of the named axes; where one is not whole, that is told once."""
    text = small.read_text().replace("seed = [0, 1]", "seed = { from = 0, to = 30, count = 31 }")
    path, group = "platform.members.*.elements", "[[axes.together]]\nname = 'a'\n"
    group += f"'{path}' = {{ from = 4, to = 16, count = 3, spacing = 'log' }}"
    lines = (
        '"solver.azimuths" = { from = 8.0, to = 16, count = 3 }',
        '"floats.front.mass" = { from = 1, to = 2, count = 2 }',
    )
    small.write_text(text.replace("[sea_states", f"{group}\n[sea_states", 1))
    study = varied(small, *lines).content
    table = axes(study)
    assert repr((table["seed"], table["azimuths"])) == repr((tuple(range(31)), (8, 12, 16)))
    assert repr(study.varied[2].keys[path]) == "(4, 8, 16)"
    assert repr(table["mass"]) == "(1.0, 2.0)"
    small.write_text(text.replace("to = 30", "to = 7"))
    with pytest.raises(StudyError) as caught:
        load(small)
    (told,) = caught.value.problems
    assert told.endswith(
        "axes.seed = {'from': 0, 'to': 7, 'count': 31}: must be whole numbers, and this range has 0.233333333333"
    )


def test_places_of_a_list_are_sampled_as_whole_lists_would_be_varied(small):
    """The same tasks; what two floats' distance is then varies, too, and is told by no single number."""
    text = with_more(small, ("second", 9.5))
    sampled = "[samples]\ncount = 3\n'floats.front.hinge.0' = { from = -3.0, to = -1.0 }\n'floats.*.hinge.1' = "
    small.write_text(text.replace("[sea_states", f"{sampled}{{ from = 0.0, to = 0.5 }}\n[sea_states", 1))
    study = load(small)
    assert "hinge_spacing" not in axes(study.content)
    (axis,) = study.content.varied
    x, y = (axis.keys[path] for path in ("floats.front.hinge.0", "floats.*.hinge.1"))
    assert [*axis.names.values()] == ["hinge.0", "hinge.1"] and len({*x, *y}) == 6
    shown = {name: (values, attrs["units"]) for name, values, attrs in along(axis, {"front": ["hinge"]})}
    assert shown == {"hinge.0": (x, "m"), "hinge.1": (y, "m")}
    places = {
        f: [[at, across, 2.6] for at, across in zip(xs, y, strict=True)]
        for f, xs in (("front", x), ("second", [9.5] * 3))
    }
    group = "[[axes.together]]\nname = 'a'\n" + "\n".join(
        f"'floats.{f}.hinge' = {values}" for f, values in places.items()
    )
    small.write_text(text.replace("[sea_states", f"{group}\n[sea_states", 1))
    assert {t.id for t in load(small).tasks} == {t.id for t in study.tasks}
    small.write_text(text)
    assert {t.id for t in study.tasks}.isdisjoint(t.id for t in load(small).tasks)


def test_what_else_of_hinges_varies_beside_their_distance_and_their_x_does_not(small):
    small.write_text(with_more(small, ("second", 9.5)))
    text = small.read_text()
    content = varied(small, "hinge_spacing = [3.0, 4.0]", '"floats.*.hinge.1" = [0.0, 0.5]').content
    assert {t.parameters.floats[1].hinge for t in expand(content)} == {
        (x, y, 2.6)
        for x in (5.5, 6.0)
        for y in (0.0, 0.5)  # about 4 m, as they are
    }
    small.write_text(text)
    with pytest.raises(StudyError, match=r'hinge\.0": is varied along two dimensions'):
        varied(small, "hinge_spacing = [3.0, 4.0]", '"floats.front.hinge.0" = [2.5, 2.6]')


UNITS = {
    "floats.front.inertia.1": "kg m2",
    "floats.front.hull.points.3.1": "m",
    "platform.nodes.foot.2": "m",
    "platform.nodes.7.0": "m",
    "floats.front.damping.1": None,  # of N m s/rad and N s/m
    "platform.foundation.foot.4": None,
    "platform.members.leg.start_spring.3": None,
    "floats.front.axis.0": "1",
    "floats.front.damping": "N m s rad-1",
}


@pytest.mark.parametrize("path", UNITS)
def test_a_place_of_a_list_has_the_unit_of_the_list_where_that_is_one(path):
    axis = Axis("a", (1, 2), {path: (1.0, 2.0)}, own=True)
    assert meaning_of(axis, {"front": ["hinge"]}).get("units") == UNITS[path]


@pytest.mark.parametrize(
    ("motions", "unit"), [(["hinge"], "N m s rad-1"), (["heave"], "N s m-1"), (["heave", "pitch"], None)]
)
def test_damping_has_the_unit_that_goes_with_the_motions(motions, unit):
    """Also where its dimension is called as the axis over all power take-offs is."""
    axis = Axis("pto_damping", (1.0, 2.0), {"floats.front.pto_damping": (1.0, 2.0)}, own=True)
    assert meaning_of(axis, {"front": motions, "rear": ["surge", "yaw"]}).get("units") == unit


def test_variants_tell_the_paths_of_their_values(small):
    """Those too that are no coordinates, by which reports know that variants make other seas."""
    text = small.read_text()
    for keys, told in (('"waves.spectrum" = "jonswap"', "Values of waves.spectrum"), ("", None)):
        small.write_text(f"{text}\n[variants.usual]\n[variants.other]\n{keys}")
        (axis,) = load(small).content.varied
        assert meaning_of(axis, {}).get("comment") == told


def test_a_dimension_has_the_last_word_or_the_whole_path_where_two_would_clash(small):
    study = varied(
        small, '"water.depth" = [50.0]', '"floats.front.mass" = [2147.0]', '"platform.sections.tube.diameter" = [1.0]',
        '"water.density" = [1025.0]', '"platform.materials.*.density" = [8012.0]', '"platform.legs" = [["leg"]]',
    )  # fmt: skip
    names = dimensions(study.content)
    assert {"depth", "mass", "diameter", "water.density", "platform.materials.*.density"} <= set(names)
    assert axes(study.content)["legs"] == ('["leg"]',)


def test_one_rule_names_all_keys_that_vary(small):
    """Of an axis, a group, samples and variants that all have a value; one that some lack is no coordinate."""
    tables = """
    [variants.a]
    platform.damping_ratio = 0.0
    [variants.b]
    platform.damping_ratio = 0.1
    floats.front.mass = 2200.0
    [[axes.together]]
    name = "coulomb"
    "heading [rad]" = [0.1]
    waves.heading = [0.1]
    floats.front.coulomb = [0.0]
    floats.front.motion = [["hinge"]]
    water.depth = [50.0]
    [samples]
    count = 2
    floats.front.damping = { from = 0.0, to = 1.0 }
    platform.materials.steel.density = { from = 8e3, to = 9e3 }
    """
    small.write_text(small.read_text().replace("[sea_states", f"{tables}\n[sea_states", 1))
    study = varied(small, '"water.density" = [1025.0]', '"floats.front.stiffness" = [0.0]').content
    kept = {"damping_ratio", "stiffness", "depth", "damping"}
    own = {"water.density", "waves.heading", "floats.front.coulomb", "floats.front.motion"}
    assert {*study.varied[0].names.values()} == kept | own | {"platform.materials.steel.density"}
    assert [axis.name for axis in study.varied] == ["variant", "water.density", "stiffness", "coulomb", "sample"]


TWICE = [
    (("'floats.front.mass' = [2147.0, 2100.0]", "'floats.*.mass' = [2000.0]"), "floats.front.mass", "floats.*.mass"),
    (("'floats.f*.mass' = [2000.0]", "'floats.front.mass' = [2147.0]"), "floats.front.mass", "floats.front.mass"),
    (("pto_damping = [1e4, 1e5]", "'floats.*.pto_damping' = [2e4]"), "floats.front.pto_damping", "pto_damping"),
    (("'sea.Hs' = [0.4, 0.6]", "'sea_states.rough.Hs' = [1.0]"), "sea_states.rough.Hs", "sea_states.rough.Hs"),
    (("'floats.*.pto_efficiency' = [{ generating = 0.9 }]", "floats.front.pto_efficiency.generating = [0.8]"),
     "floats.front.pto_efficiency.generating", "generating"),
    (("'floats.*.damping' = [1.0, 2.0]", "[[axes.together]]", "name = 'a'", "'floats.front.damping' = [0.0, 1e4]"),
     "floats.front.damping", "a"),
    (("'floats.*.mass' = [2000.0]", "[samples]", "count = 2", "'floats.f*.mass' = { from = 2000.0, to = 2100.0 }"),
     "floats.front.mass", "sample"),
]  # fmt: skip


@pytest.mark.parametrize(("lines", "key", "last"), TWICE, ids=[row[1] for row in TWICE])
def test_a_key_is_varied_along_one_dimension_whatever_stands_for_it(small, lines, key, last):
    """A pattern, one of the named axes, all sea states, a table that it is in."""
    small.write_text(small.read_text().replace("[sea_states", "\n".join(lines) + "\n[sea_states", 1))
    with pytest.raises(StudyError) as caught:
        load(small)
    (told,) = caught.value.problems
    assert f'axes = "{key}": is varied along two dimensions, ' in told
    assert f" and {last}, of which the second would decide alone" in told


def test_values_in_high_seas_are_varied_by_their_paths(small):
    """Tasks in lower seas are the same along them; values that the table lacks, too, by axes and variants."""
    small.write_text(small.read_text().replace("[sea_states]", "[survival]\nHs = 0.5\n[sea_states]"))
    study = varied(small, "'survival.floats.*.coulomb' = [1e8, 1e9]", "'survival.left_out' = [[], ['front']]")
    assert {"coulomb", "left_out"} < set(dimensions(study.content))
    floats = {"calm": set(), "rough": set()}
    for task in study.tasks:
        if task.labels["platform"] != "elastic-no-floats":
            floats[task.labels["sea_state"]].add(tuple(f.coulomb for f in task.parameters.floats))
    assert floats == {"calm": {(0.0,)}, "rough": {(1e8,), (1e9,), ()}}


@pytest.mark.parametrize(("line", "limit"), [
    ("'survival.floats.*.coulom' = [1.0]", "leads nowhere; did you mean floats.front.coulomb?"),
    ("'survival.floats.*.coulomb' = [-1.0]", "must be >= 0"),
    ("'survival.keys.left_out' = [['front']]", "must be a key of floats, left_out, platform, solver"),
])  # fmt: skip
def test_values_in_high_seas_that_cannot_be_are_refused(small, line, limit):
    small.write_text(small.read_text().replace("[sea_states]", "[survival]\nHs = 0.5\n[sea_states]"))
    with pytest.raises(StudyError, match=re.escape(limit)):
        varied(small, line)


def test_the_height_from_which_survival_holds_is_no_sea_s(small):
    """An axis beside another one, with its whole path as its name: Hs is that of the seas."""
    text = small.read_text().replace("[sea_states]", "[survival]\nHs = 0.5\n'floats.*.coulomb' = 1e9\n[sea_states]")
    small.write_text(text)
    content = varied(small, "'survival.Hs' = [0.3, 0.5]", "'floats.*.stiffness' = [0.0, 1e3]").content
    assert {"survival.Hs", "stiffness"} < set(dimensions(content))


def test_keys_with_like_names_are_varied_along_two_dimensions(small):
    """A name may have dots; and a variant may bring in what an axis then varies a part of."""
    text = small.read_text().replace("foot = [", "'foot.2' = [0.0, 0.0, -50.0]\nfoot = [")
    text = text.replace('clamped = ["foot"]', 'clamped = ["foot", "foot.2"]')
    small.write_text(text)
    lines = '"platform.nodes.foot" = [[-1.5, 0.0, -50.0]]', '"platform.nodes.foot.2" = [[0.0, 0.0, -49.0]]'
    assert len(varied(small, *lines).tasks) == len(load(small).tasks)
    variant = "[variants.a]\n'floats.front.hull' = { shape = 'sphere', radius = 1.0, draft = 1.0 }\n[sea_states"
    small.write_text(text.replace("[sea_states", variant, 1))
    assert "variant" in dimensions(varied(small, "'floats.front.hull.radius' = [1.0, 1.1]").content)


@pytest.mark.parametrize(
    ("key", "axis", "last"),
    [
        ("'floats.front.mass' = 2100.0", "'floats.*.mass' = [2000.0]", "mass"),
        ("'floats.front.pto_damping' = 1e3", "pto_damping = [1e4, 1e5]", "pto_damping"),
        ("'floats.*.pto_damping' = 1e3", "'floats.*.pto_damping' = [1e4]", "pto_damping"),
        ("'floats.*.pto_efficiency' = { generating = 0.9 }",
         "'floats.front.pto_efficiency' = [{ generating = 0.8 }, { generating = 0.7 }]", "pto_efficiency"),
    ],
)  # fmt: skip
def test_what_a_variant_says_and_an_axis_decides_is_refused(small, key, axis, last):
    """Its tasks would be those of the variants that do not say it, and tables would tell of both."""
    lines = f"{axis}\n[variants.a]\n[variants.b]\n{key}\n[sea_states"
    small.write_text(small.read_text().replace("[sea_states", lines, 1))
    with pytest.raises(StudyError) as caught:
        load(small)
    assert f"is varied along two dimensions, variant and {last}, of which the second" in str(caught.value)


def test_same_physics_is_the_same_task_however_it_is_said(small):
    """Paths, the old axis, a group, another order, and a default spelled out."""
    text = small.read_text()
    plain = {task.id for task in load(small).tasks}

    def ids(*lines):
        small.write_text(text)
        return {task.id for task in varied(small, *lines).tasks}

    assert ids('"floats.front.pto_damping" = [100e3]') == plain
    assert ids('"solver.diffraction" = [true]', '"water.density" = [1025.0]') == plain
    assert ids("pto_damping = [1e5, 2e5]") == ids('"floats.*.pto_damping" = [2e5, 1e5]')
    wider = ids('"floats.*.pto_damping" = [2e5, 1e5]', '"water.depth" = [50.0, 60.0]')
    assert ids('"floats.*.pto_damping" = [2e5, 1e5]') < wider
    small.write_text(text.replace("[sea_states", "[[axes.together]]\nname = 't'\n'water.depth' = [50.0, 60.0]\n"
                                  "'floats.front.pto_damping' = [1e5, 2e5]\n[sea_states", 1))  # fmt: skip
    paired = {task.id for task in load(small).tasks}
    assert plain < paired < wider


def test_paths_without_a_star_need_no_quotes(small):
    text = small.read_text()
    span = "{ from = 2000.0, to = 2200.0, count = 3 }"
    plain = varied(small, f'"floats.front.mass" = {span}', '"water.depth" = [50.0, 60.0]')
    small.write_text(text)
    tables = varied(small, f"floats.front.mass = {span}", "water.depth = [50.0, 60.0]")
    assert tables.content.varied == plain.content.varied and len(tables.tasks) == len(plain.tasks)
    sampled = "[samples]\ncount = 2\nfloats.front.mass = { mean = 2147.0, std = 1.0 }\n"
    small.write_text(text.replace("[sea_states", sampled + "[sea_states", 1))
    assert next(iter(load(small).content.samples.axis.keys)) == "floats.front.mass"
    paired = "[[axes.together]]\nname = 'a'\nfloats.front.mass = [2100.0, 2147.0]\nlength = [1, 2]\n"
    small.write_text(text.replace("[sea_states", paired + "[sea_states", 1))
    (axis,) = load(small).content.varied
    assert (*axis.keys, *axis.beside) == ("floats.front.mass", "length")


@pytest.fixture
def seas_of_axes(small):
    """The small study without sea states, with these lines in [axes] and below."""
    head = small.read_text().partition("[sea_states")[0]

    def made(lines, below=""):
        small.write_text(head.replace('sea_state = ["calm", "rough"]', lines) + below)
        return load(small)

    return made


@pytest.mark.parametrize("lines", [
    '"sea.Hs" = [0.3, 0.5]\n"sea.Tp" = [5.0, 6.0]',
    "sea.Hs = [0.3, 0.5]\nsea.Tp = [5.0, 6.0]",
    "sea.Hs = { from = 0.3, to = 0.5, count = 2 }\n'sea.Tp' = [5.0, 6.0]",
    "sea = { Hs = [0.3, 0.5], Tp = { from = 5.0, to = 6.0, count = 2 } }",
])  # fmt: skip
def test_a_product_of_seas_needs_none_by_name(seas_of_axes, lines):
    study = seas_of_axes(lines)
    seas = {(t.parameters.sea_state.Hs, t.parameters.sea_state.Tp) for t in study.tasks}
    assert seas == {(0.3, 5.0), (0.3, 6.0), (0.5, 5.0), (0.5, 6.0)}
    assert dimensions(study.content)[-3:] == ["Hs", "Tp", "seed"]


@pytest.mark.parametrize("keys", [
    "'sea.Hs' = [0.3, 0.5]\n'sea.Tp' = [5.0, 6.0]",
    "sea.Hs = [0.3, 0.5]\nsea.Tp = { from = 5.0, to = 6.0, count = 2 }",
    "sea = { Hs = [0.3, 0.5], Tp = [5.0, 6.0] }",
])  # fmt: skip
def test_seas_that_change_together_need_none_by_name(seas_of_axes, keys):
    study = seas_of_axes("", f"[[axes.together]]\nname = 'state'\n{keys}\n")
    assert {(t.parameters.sea_state.Hs, t.parameters.sea_state.Tp) for t in study.tasks} == {(0.3, 5.0), (0.5, 6.0)}


@pytest.mark.parametrize("Hs", ["sea.Hs", "'sea.Hs'"])
def test_a_value_in_place_of_a_list_of_seas_is_told_at_its_axis_alone(seas_of_axes, Hs):
    with pytest.raises(StudyError) as caught:
        seas_of_axes(f"{Hs} = 0.5\nsea.Tp = [5.0, 6.0]")
    (problem,) = caught.value.problems
    assert 'axes."sea.Hs" = ' in problem and "must be a list of values, or { from" in problem


def test_seas_without_tasks_are_left_alone(small):
    """As a base may bring: one that has no Hs, far outside the band."""
    ripple = 'ripple = { kind = "regular", period = 0.2, height = 0.001 }\n'
    text = small.read_text() + ripple
    small.write_text(text.replace('["calm", "rough"]', '["calm"]\n"sea.Hs" = [0.4, 0.6]'))
    assert {task.parameters.sea_state.Hs for task in expand(load(small).content)} == {0.4, 0.6}
    small.write_text(text.replace('["calm", "rough"]', '["calm", "ripple"]'))
    with pytest.raises(StudyError, match=r"sea_states\.ripple\.period = 0\.2: must put its frequency"):
        load(small)


def test_parts_are_chosen_by_name_path_or_range(small):
    study = varied(small, '"floats.*.mass" = { from = 2000.0, to = 2200.0, count = 5 }')
    each = len(select(study, "platform=fixed,mass=2000"))
    parts = {
        "mass=2000": 1, "floats.*.mass=2000": 1, "mass=2000..2100": 3, "mass=2100..": 3, "mass=..2049": 1,
        "mass=2000,mass=2200": 2, "mass=2000,floats.*.mass=2200": 2, "mass=0..9e9": 5,
    }  # fmt: skip
    for text, share in parts.items():
        assert len(select(study, f"platform=fixed,{text}")) == share * each
    with pytest.raises(StudyError, match="no such value"):
        select(study, "mass=3000..4000")


SAMPLES = """[samples]
count = 12
"floats.front.damping" = { mean = 1.0, std = 0.5 }
"floats.*.coulomb" = { from = 0.1, to = 10.0, spacing = "log" }
"""


A_SAMPLE = Samples.model_validate(tomllib.loads(SAMPLES)["samples"]).axis.keys["floats.front.damping"][4]


@pytest.fixture
def designs(small):
    """Paired values, some of them twice and all on the numbers of their dimension, and samples."""
    small.write_text(small.read_text().replace("[sea_states", f"{TOGETHER}{SAMPLES}[sea_states", 1))
    return load(small)


LENGTHS = [5.0, 1.0, 3.0, 1.0]
CHOSEN = {
    "floats.front.stiffness=2": lambda f, tune: f.stiffness == 2.0,
    "floats.front.stiffness=2.5..": lambda f, tune: f.stiffness == 3.0,
    "stiffness=1,floats.front.stiffness=3": lambda f, tune: f.stiffness != 2.0,
    "floats.front.cog=[0.0, 0.0, 0.1]": lambda f, tune: f.cog[2] == 0.1,
    "length=1": lambda f, tune: LENGTHS[tune - 1] == 1.0,
    "length=1,stiffness=2": lambda f, tune: tune == 2,
    "tune=1,tune=4": lambda f, tune: tune in (1, 4),
    "floats.front.damping=0.9..1.3": lambda f, tune: 0.9 <= f.damping <= 1.3,
    "damping=..1,coulomb=1..,stiffness=..2": lambda f, tune: f.damping <= 1.0 <= f.coulomb and f.stiffness <= 2.0,
}


@pytest.mark.parametrize("text", CHOSEN)
def test_parts_are_chosen_by_the_values_that_tasks_have(designs, text):
    """Of keys that change together and of samples: as the tasks' own tables tell."""
    tasks = select(designs, "platform=fixed,seed=0")
    right = {t.id for t in tasks if CHOSEN[text](t.parameters.floats[0], t.labels["tune"])}
    assert {t.id for t in select(designs, f"{text},platform=fixed,seed=0")} == right
    assert 0 < len(right) < len(tasks)


@pytest.mark.parametrize("word", ["21544", "21544.3", "2.15e4", "21544.34", "21544.35", "2.1544e4"])
def test_a_number_may_be_typed_to_fewer_digits(small, word):
    """Rounded, or cut; 21544.3469003 of a range."""
    study = varied(small, '"floats.*.pto_damping" = { from = 1e4, to = 1e5, count = 10, spacing = "log" }')
    assert {task.labels["pto_damping"] for task in select(study, f"pto_damping={word}")} == {21544.3469003}
    assert {task.labels["pto_damping"] for task in select(study, "pto_damping=1e5,pto_damping=35938")} == {
        35938.1366380,
        1e5,
    }


@pytest.mark.parametrize("word", ["2.2e4", "21545", "21500", "-21544", "21544.36", "inf", "0.000"])
def test_a_number_that_is_none_of_the_axis_is_told_with_those_there(small, word):
    study = varied(small, '"floats.*.pto_damping" = { from = 1e4, to = 1e5, count = 10, spacing = "log" }')
    with pytest.raises(StudyError, match=f"={word}: no such value; known: 10000.0, 12915.4966501, .*, 100000.0"):
        select(study, f"pto_damping={word}")


@pytest.mark.parametrize("word", ["2005", "2005.1"])
def test_digits_of_two_values_are_too_few(small, word):
    study = varied(small, '"floats.*.mass" = { from = 2000.05, to = 2009.95, count = 100 }')
    with pytest.raises(StudyError, match=rf"mass={word}: no such value; known about there: 2004\.[01]5, .*, 20.*[^,]$"):
        select(study, f"mass={word}")
    assert len(select(study, "mass=2005.05,seed=0,sea_state=calm,platform=fixed")) == 1


SCATTER = """regular = { kind = "regular", height = 0.4, period = 5.0 }
[variants.a]
[variants.higher]
"sea_states.calm.Hs" = 0.6
"""
IN_SEAS = {
    "Hs=0.6": lambda sea: sea.Hs == 0.6,
    "Hs=..0.6": lambda sea: sea.Hs <= 0.6,
    "Hs=0.5,Hs=0.6,Tp=5": lambda sea: sea.Hs in (0.5, 0.6) and sea.Tp == 5.0,
    "Tp=4..,variant=higher": lambda sea: sea.Tp >= 4.0,
}


@pytest.mark.parametrize("text", IN_SEAS)
def test_seas_are_chosen_by_their_height_and_period(small, text):
    """As each task has it, whatever changes it; a regular wave has no Hs."""
    lines = small.read_text().replace('["calm", "rough"]', '["calm", "rough", "regular"]')
    small.write_text(lines + SCATTER)
    study = load(small)
    tasks = [t for t in study.tasks if t.labels["platform"] == "fixed"]
    chosen = [t for t in tasks if "variant" not in text or t.labels["variant"] == "higher"]
    seas = {t.id: t.parameters.sea_state for t in chosen}
    right = {name for name, sea in seas.items() if hasattr(sea, "Hs") and IN_SEAS[text](sea)}
    assert {t.id for t in select(study, f"platform=fixed,{text}")} == right
    assert 0 < len(right) < len({t.id for t in tasks})
    with pytest.raises(StudyError, match=r"Hs=0.7: no such value; known: 0.5, 0.6, "):
        select(study, "Hs=0.7")


def test_a_sea_given_by_its_mean_period_is_chosen_by_its_peaks(small):
    small.write_text(small.read_text().replace("Tp = 7.0", 'Tp = 6.5, form = "mean"'))
    assert {task.labels["sea_state"] for task in select(load(small), "Tp=8.42")} == {"rough"}
    with pytest.raises(StudyError, match=r"Tp=7.0: no such value; known: 5.0, 8.4196"):
        select(load(small), "Tp=7.0")


def test_a_key_is_chosen_by_any_path_that_leads_to_it(small):
    small.write_text(with_more(small, ("second", 9.5)))
    study = varied(small, '"floats.front.mass" = [2147.0, 2000.0]', '"floats.*.stiffness" = [0.0, 1e4]',
                   '"floats.second.damping" = [0.0, 5.0]', '"floats.front.damping" = [0.0, 7.0]')  # fmt: skip
    for text, name, value in (
        ("floats.*.mass=2e3", "mass", 2e3),
        ("floats.f*.mass=2000", "mass", 2e3),
        ("floats.second.stiffness=1e4", "stiffness", 1e4),
    ):
        assert {task.labels[name] for task in select(study, text)} == {value}
    both = "name one: floats.front.damping or floats.second.damping"
    with pytest.raises(StudyError, match=re.escape(f"floats.*.damping: goes along several axes; {both}")):
        select(study, "floats.*.damping=7")
    with pytest.raises(
        StudyError, match=r"damping: unknown axis; did you mean floats.second.damping or floats.front.d"
    ):
        select(study, "damping=7")
    with pytest.raises(StudyError, match=r"floats.second.mass: unknown axis"):
        select(study, "floats.second.mass=2147")


def test_no_task_has_what_two_of_a_dimension_have(designs):
    with pytest.raises(StudyError, match="stiffness=1,length=5: no task has all of that"):
        select(designs, "stiffness=1,length=5")


def test_variants_are_named_sets_of_values_and_change_nothing_else(small):
    text = small.read_text()
    plain = list(load(small).tasks)
    tables = (
        "[variants.usual]\n[variants.linear.solver]\nfroude_krylov = 'linear'\n[variants.deep]\n'water.depth' = 60.0\n"
    )
    small.write_text(text.replace("[sea_states", tables + "'floats.*.mass' = 2200.0\n[sea_states", 1))
    study = load(small)
    assert axes(study.content)["variant"] == ("usual", "linear", "deep") and "variant" in dimensions(study.content)
    parameters = {t.labels["variant"]: t.parameters for t in select(study, "platform=fixed,seed=0,sea_state=calm")}
    assert parameters["linear"].solver.froude_krylov == "linear" and parameters["linear"].water.depth == 50.0
    assert (parameters["deep"].water.depth, parameters["deep"].floats[0].mass) == (60.0, 2200.0)
    assert {t.id for t in select(study, "variant=usual")} == {t.id for t in plain}


def narrowed(small):
    """Two variants along parts of the axes, beside the study as it is."""
    text = small.read_text()
    tables = "[variants.usual]\n[variants.deep]\naxes = { seed = [1], sea_state = ['rough'] }\n'water.depth' = 60.0\n"
    tables += (
        "[variants.heavy]\naxes = { platform = ['fixed'], 'floats.*.stiffness' = [1e4] }\nfloats.front.mass = 2200.0\n"
    )
    over = "[axes]\n'floats.*.stiffness' = [0.0, 1e4]\n"
    small.write_text(text.replace("[axes]\n", over, 1).replace("[sea_states", tables + "[sea_states", 1))
    return load(small)


def test_a_year_is_a_label_however_it_is_written():
    assert standing_for([2018, "2019", 2020, "18"], ("2018", "2019")) == ["2018", "2019", None, None]
    assert standing_for([100_000, 0, "2.5"], (0.0, 2.5, 1e5)) == [1e5, 0.0, 2.5]
    # Whether something is true is no number, nor is a number in a list one.
    assert standing_for([True, 1, "true", [True]], ("true", "false")) == ["true", None, "true", None]
    assert standing_for([True, 1, [1]], (1.0, 0.0)) == [None, 1.0, None]
    assert standing_for([[1.0, 2.0], {"a": 1}], ("[1.0, 2.0]", '{"a": 1}')) == ["[1.0, 2.0]", '{"a": 1}']


def test_a_variant_goes_along_what_is_no_number(small):
    """True, a list, a word beside numbers: by the values that the axis has."""
    legs = '[["leg"], []]'
    lines = f'"solver.radiation" = [true, false]\n"platform.legs" = {legs}\n"floats.*.mass" = ["balance", 2147.0]'
    part = '"solver.radiation" = [false], "platform.legs" = [[]], "floats.*.mass" = ["balance"]'
    text = small.read_text().replace("[axes]\n", f"[axes]\n{lines}\n", 1)
    small.write_text(
        text.replace("[sea_states", f"[variants.all]\n[variants.part]\naxes = {{ {part} }}\n[sea_states", 1)
    )
    content = load(small).content
    rows = [[task.labels[name] for name in ("radiation", "legs", "mass")] for task in expand(content)
            if task.labels["variant"] == "part"]  # fmt: skip
    assert len(rows) == 2 * 3 * 2 and all(row == ["false", "[]", "balance"] for row in rows)
    small.write_text(small.read_text().replace("[false]", "[true, 1]").replace("[[]]", '[["arm"]]'))
    with pytest.raises(StudyError) as caught:
        load(small)
    assert [text.partition("variants.part.axes.")[2] for text in caught.value.problems] == [
        "solver.radiation = 1: must be on the study's own axis: true, false",
        'platform.legs = ["arm"]: must be on the study\'s own axis: ["leg"], []',
    ]


PARTS = {
    '"floats.front.stiffness" = [2.0]': lambda f, tune: f.stiffness == 2.0,
    '"floats.front.stiffness" = [1.0, 3.0]': lambda f, tune: f.stiffness != 2.0,
    'stiffness = [2.0], "floats.front.cog" = [[0.0, 0.0, 0.1]]': lambda f, tune: tune == 2,
    "length = [1.0], tune = [3, 4]": lambda f, tune: tune == 4,
    '"floats.front.damping" = [A_SAMPLE]': lambda f, tune: f.damping == A_SAMPLE,
}


@pytest.mark.parametrize("part", PARTS)
def test_a_variant_goes_along_the_values_of_keys(designs, small, part):
    """That change together, and of samples, by a path or by the dataset's name."""
    given = f"[variants.all]\n[variants.part]\naxes = {{ {part.replace('A_SAMPLE', repr(A_SAMPLE))} }}\n"
    small.write_text(small.read_text().replace("[sea_states", f"{given}[sea_states", 1))
    tasks = [t for t in load(small).tasks if t.labels["platform"] == "fixed"]
    rows = {word: [t for t in tasks if t.labels["variant"] == word] for word in ("all", "part")}
    right = {t.id for t in rows["all"] if PARTS[part](t.parameters.floats[0], t.labels["tune"])}
    assert {t.id for t in rows["part"]} == right
    assert 0 < len(right) < len({t.id for t in rows["all"]})


NONLINEAR = """[variants.nonlinear]
axes = { 'solver.method' = ["time"], 'solver.radiation' = [true], sea_state = ["rough"], platform = ["fixed"] }
solver.froude_krylov = "body-nonlinear"
'sea_states.*.Hs' = 6.0
"""
LINEAR = """[variants.linear]
axes = { sea_state = ["rough", "calm"] }
solver.froude_krylov = "linear"
"""


@pytest.mark.parametrize("tables", [NONLINEAR + LINEAR, LINEAR + NONLINEAR], ids=["nonlinear", "linear"])
def test_what_no_task_has_together_is_not_judged_and_what_one_has_is(small, tables):
    """Method and pressure, sea and height, each of which would be refused along the whole axis, in either order."""
    small.write_text(small.read_text().replace("[sea_states", f"{tables}[sea_states", 1))
    lines = """'solver.method' = ["frequency", "time"]""", """'solver.radiation' = [true, false]"""
    content = varied(small, *lines).content
    labels = {name: values[0] for name, values in axes(content).items()}
    nonlinear = {"variant": "nonlinear", "method": "time", "sea_state": "rough", "platform": "fixed"}
    assert first_labels(content) == {**labels, **(nonlinear if labels["variant"] == "nonlinear" else {})}
    linear = {"variant": "linear", "radiation": "false"}
    assert firsts(content)({"radiation": "false"}) == {**labels, **linear}
    assert not firsts(content)({"variant": "nonlinear", "method": "frequency"})
    whole = small.read_text()
    refused = {
        "'solver.method' = [\"time\"], ": "solver.froude_krylov = body-nonlinear: needs",
        ', sea_state = ["rough"]': "sea_states.calm.Hs = 6.0: must be <= ",
    }
    for part, told in refused.items():
        assert whole.count(part) == 1
        small.write_text(whole.replace(part, ""))
        with pytest.raises(StudyError, match=re.escape(told)):
            load(small)


def test_a_key_called_as_a_named_axis_is_none(small):
    """A variant along a part of floats.*.pto_damping, of which a float with several axes has several."""
    text = small.read_text().replace('name = "front"', 'name = "front"\nmotion = ["heave", "pitch"]')
    text = text.replace("pto_damping = 100e3", "pto_damping = [0.0, 1e5]")
    lines = "[variants.all]\n[variants.part]\n'axes'.'floats.*.pto_damping' = [[0.0, 2e5]]\n"
    small.write_text(text.replace("[sea_states", f"{lines}[sea_states", 1))
    content = varied(small, '"floats.*.pto_damping" = [[0.0, 1e5], [0.0, 2e5]]').content
    assert [task.labels["pto_damping"] for task in expand(content)].count("[0.0, 200000.0]") == 2 * 2 * 3 * 2


def test_every_sea_of_every_variant_is_judged_with_every_value(small):
    """A value of an axis that waves of one sea break with is refused whichever variant goes along that sea."""
    lines = "[variants.rough]\naxes.sea_state = ['rough']\n[variants.calm]\naxes.sea_state = ['calm']\n"
    small.write_text(small.read_text().replace("[sea_states", f"{lines}[sea_states", 1))
    with pytest.raises(StudyError) as caught:
        varied(small, '"sea.Hs" = [0.5, 7.0]')
    assert [text.partition("small.toml: ")[2][:45] for text in caught.value.problems] == [
        'axes."sea.Hs" = 7.0: sea_states.calm.Hs = 7.0'
    ]


def test_a_variant_may_go_along_parts_of_the_axes(small):
    study = narrowed(small)
    labels = [task.labels for task in study.tasks]
    assert {name: sum(row["variant"] == name for row in labels) for name in ("usual", "deep", "heavy")} == {
        "usual": 2 * 3 * 2 * 2,
        "deep": 3 * 2,
        "heavy": 2 * 2,
    }
    assert {(r["seed"], r["sea_state"]) for r in labels if r["variant"] == "deep"} == {(1, "rough")}
    assert {(r["platform"], r["stiffness"]) for r in labels if r["variant"] == "heavy"} == {("fixed", 1e4)}
    assert [task.id for task in expand(study.content)] == [task.id for task in study.tasks]
    assert list(study.tasks.cells) == sorted(study.tasks.cells)
    assert len(select(study, "variant=deep,platform=fixed,stiffness=0")) == 1
    assert len(select(study, "seed=1,sea_state=rough,platform=fixed,stiffness=1e4")) == 3
    with pytest.raises(StudyError, match="variant=deep,seed=0: no task has all of that"):
        select(study, "variant=deep,seed=0")


@pytest.mark.parametrize("method", ["sobol", "halton", "random"])
def test_more_samples_leave_the_first_ones_where_they_are(small, method):
    text = small.read_text()

    def ids(count):
        table = (
            f"[samples]\ncount = {count}\nmethod = '{method}'\n"
            "'floats.front.pto_damping' = { from = 1e4, to = 1e6, spacing = 'log' }\n"
            "'floats.front.mass' = { mean = 2147.0, std = 20.0 }\n"
        )
        small.write_text(text.replace("[sea_states", table + "[sea_states", 1))
        return load(small)

    few, many = ids(5), ids(64)
    assert {t.id for t in few.tasks} < {t.id for t in many.tasks}
    parts = [t.parameters.floats[0] for t in select(many, "platform=fixed,seed=0,sea_state=calm")]
    damping, mass = (np.array([getattr(f, name) for f in parts]) for name in ("pto_damping", "mass"))
    assert len(parts) == 64 and damping.min() >= 1e4 and damping.max() <= 1e6
    assert abs(np.median(np.log10(damping)) - 5) < 0.3 and abs(mass.mean() - 2147) < 10 and 10 < mass.std() < 30
    assert axes(many.content)["sample"] == tuple(range(64))


def test_the_axes_of_the_readme_are_axes(tmp_path):
    root = Path(__file__).parents[3]
    lines = (root / "studies" / "README.md").read_text().splitlines()
    first = lines.index("    [axes]")
    block = [line[4:] for line in lines[first : lines.index("", first)]]
    path = tmp_path / "readme.toml"
    path.write_text("\n".join([f'base = "{root / "studies" / "buan.toml"}"', *block]))
    study = load(path).content
    mine = {"variant", "damping_ratio", "pto_damping", "froude_krylov", "Hs", "tuning", "sample"}
    assert set(dimensions(study)) == {"sea_state", "platform", *mine, "seed"}


def test_forces_left_to_default_are_linear_in_the_frequency_domain(small):
    tasks = list(expand(varied(small, '"solver.method" = ["time", "frequency"]').content))
    by_method = {task.parameters.solver.method: task for task in tasks}
    assert {m: t.parameters.solver.froude_krylov for m, t in by_method.items()} == {
        "time": "body-nonlinear",
        "frequency": "linear",
    }
    spelled = with_value(load(small).content, "solver.froude_krylov", "linear")
    assert by_method["frequency"].id in {task.id for task in expand(spelled)}
    # Back in the time domain the key is at its default again.
    back = with_value(with_value(load(small).content, "solver.method", "frequency"), "solver.method", "time")
    assert next(iter(expand(back))).parameters.solver.froude_krylov == "body-nonlinear"


STOPS = "{ lower = -0.9, upper = 0.9, stiffness = 2e7, damping = 2e5 }"


def tables_under(small, above):
    """The small study with these lines above its sea states."""
    small.write_text(small.read_text().replace("[sea_states", f"{above}\n[sea_states", 1))
    return load(small)


@pytest.mark.parametrize(
    "given",
    [
        f"[variants.a]\n[variants.b]\n'floats.front.end_stops' = {STOPS}",
        f"[variants.a]\n[variants.b]\n'floats.*.end_stops' = {STOPS}",
        f"[variants.a]\n[variants.b.floats.front]\nend_stops = {STOPS}",
        "[variants.a]\n[variants.b]\n" + "\n".join(f"floats.front.end_stops.{key}" for key in STOPS[2:-2].split(", ")),
        f"[survival]\nHs = 0.1\n'floats.*.end_stops' = {STOPS}",
        f"[axes]\n'floats.front.end_stops' = [{STOPS}]",
    ],
)
def test_a_table_that_the_study_lacks_is_brought_in_whole(small, given):
    """End stops against none: the tasks with them are those of a study that has them."""
    text = small.read_text()
    plain = {task.id for task in load(small).tasks}
    stopped = text.replace("[[floats]]\n", f"[[floats]]\nend_stops = {STOPS}\n", 1)
    small.write_text(stopped)
    with_stops = {task.id for task in load(small).tasks}
    small.write_text(text.replace("[axes]", given, 1) if given.startswith("[axes]") else text)
    study = load(small) if given.startswith("[axes]") else tables_under(small, given)
    ids = {task.id for task in study.tasks}
    assert ids == (plain | with_stops if "variants" in given else with_stops) and with_stops != plain


def test_a_current_s_profile_is_brought_in_whole(small):
    """Of a table that the study lacks the one key may be a list of tables."""
    text, profile = small.read_text(), "[{ depth = 0.0, speed = 1.0 }, { depth = 10.0, speed = 0.2 }]"
    small.write_text(f"{text}\n[current]\nprofile = {profile}\n")
    sheared = {task.id for task in load(small).tasks}
    small.write_text(text)
    assert sheared < {
        task.id for task in tables_under(small, f"[variants.a]\n[variants.b]\ncurrent.profile = {profile}").tasks
    }


def test_names_that_the_study_lacks_are_brought_in(small):
    """Springs at feet in place of clamps, each with its own; and where they are of no node, that is said."""
    text = small.read_text()
    clamped = next(line for line in text.splitlines() if line.startswith("clamped"))
    foot = re.findall(r'"(.*?)"', clamped)[0]
    springs = f"{foot} = [2e7, 3e7, 1e8, 5e7, 6e7, 4e7]"
    small.write_text(text.replace(clamped, f"clamped = []\nfoundation = {{ {springs} }}", 1))
    on_springs = {task.id for task in load(small).tasks}
    small.write_text(text)
    for given in (f"'platform.foundation' = {{ {springs} }}", f"platform.foundation.{springs}"):
        small.write_text(text)
        study = tables_under(small, f"[variants.b]\n'platform.clamped' = []\n{given}")
        assert {task.id for task in study.tasks} & on_springs
    small.write_text(text)
    with pytest.raises(StudyError, match="nowhere"):
        tables_under(small, "[variants.b]\n'platform.foundation' = { nowhere = [2e7, 3e7, 1e8, 5e7, 6e7, 4e7] }")


HULL = '{ shape = "hemisphere-cylinder", radius = 1.0, height = 0.6 }'
CYLINDER = "{ shape = 'vertical-cylinder', radius = 1.0, draft = 0.6, freeboard = 1.0 }"


@pytest.mark.parametrize(
    ("old", "table", "given"),
    [
        (HULL, CYLINDER, f"'floats.*.hull' = {CYLINDER}"),
        (HULL, CYLINDER, "\n".join(f"floats.front.hull.{key}" for key in reversed(CYLINDER[2:-2].split(", ")))),
        ('shape = "tube"\ndiameter = 1.0\nthickness = 0.05', 'shape = "solid-rectangle"\nheight = 0.5\nwidth = 0.4',
         "'platform.sections.tube' = { width = 0.4, shape = 'solid-rectangle', height = 0.5 }"),
        ("{ Hs = 0.5, Tp = 5.0 }", "{ kind = 'regular', height = 0.4, period = 5.0 }",
         "'sea_states.calm' = { kind = 'regular', height = 0.4, period = 5.0 }"),
    ],
    ids=["table", "keys", "section", "sea"],
)  # fmt: skip
def test_a_table_of_another_kind_takes_the_place_of_the_study_s(small, old, table, given):
    """Its tasks are those of a study with that table; nothing of the other is left, whichever key comes first."""
    text = small.read_text()
    plain = {task.id for task in load(small).tasks}
    assert text.count(old) == 1
    small.write_text(text.replace(old, table))
    other = {task.id for task in load(small).tasks}
    small.write_text(text)
    assert {task.id for task in tables_under(small, f"[variants.a]\n[variants.b]\n{given}").tasks} == plain | other
    assert other != plain


@pytest.mark.parametrize("folder", ["", "above/"])
def test_files_of_a_variant_lie_beside_the_study(small, folder):
    """Whoever runs it from where; and those of a base beside that."""
    (small.parent / "law.py").write_text("def load(y, dy):\n    return 1e5 * dy\n")
    law = "{ file = 'law.py', velocity = [-2.0, 2.0] }"
    study = tables_under(small, f"[variants.a]\n[variants.b.floats.front]\npto_damping = 0.0\npto_law = {law}")
    quoted = (
        small.read_text()
        .replace("pto_law = {", "'pto_law.file' = 'law.py'\npto_law = {")
        .replace("file = 'law.py', ", "")
    )
    small.write_text(quoted)
    upper = small.parent / f"{folder}upper.toml"
    upper.parent.mkdir(exist_ok=True)
    upper.write_text(f"base = '{'../' if folder else ''}small.toml'\n")
    assert {task.id for task in load(upper).tasks} == {task.id for task in study.tasks}


@pytest.mark.parametrize(
    ("table", "twice"),
    [
        ("axes", "'sea.Te' = [5.0, 8.0]\nsea.Te = [6.0, 7.0]"),
        ("variants.a", "'sea.Te' = 6.0\nsea.Te = 7.0"),
        ("survival", "Hs = 0.1\n'sea.Te' = 6.0\nsea.Te = 7.0"),
    ],
)
def test_a_path_is_given_once_whichever_way_it_is_written(small, table, twice):
    with pytest.raises(StudyError, match=f'{table}."sea.Te".*is given twice, in quotes and in a table'):
        varied(small, twice) if table == "axes" else tables_under(small, f"[{table}]\n{twice}")


def test_a_table_brought_in_may_be_the_current(small):
    study = tables_under(small, "[variants.still]\n[variants.streaming.current]\nspeed = 0.5")
    assert {t.parameters.current and t.parameters.current.speed for t in study.tasks} == {None, 0.5}


@pytest.mark.parametrize(
    ("above", "problem"),
    [
        ("[variants.b]\n'floats.front.end_stops' = { upper = 0.9, stiffness = -1.0, lower = -0.9 }",
         'variants.b."floats.front.end_stops.stiffness" = -1.0: must be >= 0 N m/rad or N/m'),
        ("[variants.b]\n'floats.*.end_stops' = { upper = 0.9 }",
         "upper\" = 0.9: leads nowhere: the study has no [floats.front.end_stops], and one brought in needs lower"),
        ("[variants.b]\n'floats.front.end_stops' = { uper = 0.9, lower = -0.9, stiffness = 1e6 }",
         'variants.b."floats.front.end_stops.uper" = 0.9: unknown key; did you mean upper?'),
        ("[variants.b]\n'floats.front.end_stops' = { lower = 0.9, upper = -0.9, stiffness = 1e6 }", "end_stops"),
        ("[variants.b]\n'floats.front.end_stops' = 3.0", '"floats.front.end_stops" = 3.0: must be a table'),
        ("[survival]\nHs = 0.5\n'floats.*.end_stops' = { lower = 'low', upper = 0.9, stiffness = 1e6 }",
         'survival."floats.*.end_stops.lower" = low: must be a number'),
        ("[variants.b.survival]\nHs = 0.5", "leads nowhere: the study has no [survival]"),
        ("[variants.b]\n'floats.*.hull' = { radius = 1.0, draft = -0.6, freeboard = 1.0, shape = 'vertical-cylinder' }",
         'variants.b."floats.*.hull.shape" = vertical-cylinder: hull.draft = -0.6: must be > 0 m'),
        ("[variants.b]\n'floats.*.hull' = { shape = 'vertical-cylinder', radius = 1.0, draft = 0.6 }",
         'variants.b."floats.*.hull.shape" = vertical-cylinder: hull.freeboard: is missing [m]'),
        ("[variants.b]\n'floats.*.hull' = { shape = 'vertical', radius = 1.0 }",
         'variants.b."floats.*.hull.shape" = vertical: must be one of '),
        ("[[axes.together]]\nname = 'a'\n'floats.front.end_stops' = [{ lower = -1.0, upper = 1.0, stiffness = -1.0 }]",
         "}: stiffness: must be >= 0"),
    ],
)  # fmt: skip
def test_a_bad_table_brought_in_is_told_by_its_key(small, above, problem):
    with pytest.raises(StudyError) as caught:
        tables_under(small, above)
    (told,) = caught.value.problems
    assert problem in told


def test_a_fault_of_the_whole_study_is_told_once_and_one_of_a_value_with_it(small):
    small.write_text("[record]\nramp = 1e4\n" + small.read_text())
    with pytest.raises(StudyError) as caught:
        varied(small, '"floats.front.mass" = [2147.0, 2000.0, 1900.0]', '"record.discard" = [100.0, 90.0]')
    told = [line for line in str(caught.value).splitlines() if "record.ramp" in line]
    assert [": axes." in line for line in told] == [False, True]
    assert "= 90.0: record.ramp = 10000.0: must be <= record.discard = 90 s" in told[1]


def _words(model, seen):
    """Last words of a table's keys, with those of tables in it."""
    if isinstance(model, type) and issubclass(model, BaseModel) and model not in seen:
        seen.add(model)
        for name, field in model.model_fields.items():
            yield field.alias or name
            yield from _words(field.annotation, seen)
    for part in get_args(model):
        yield from _words(part, seen)


def test_no_axis_takes_the_place_of_an_output():
    """What is found where `balance` and `hold` are asked for is put out beside it, with another name."""
    assert {*_words(StudyFile, set())} & VARIABLES.keys() - TAKEN == {"mass", "cog", "preload"}
