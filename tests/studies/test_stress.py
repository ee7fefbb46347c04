"""The stress matrix: its cases are what they say, and hung or dead processes are replaced."""

import os
import time

import numpy as np
import xarray as xr

from pipeline.bridge import checks
from pipeline.study.schema import StudyFile
from studies.stress import pool
from studies.stress.matrix import matrix, tables
from studies.stress.page import page
from studies.stress.picture import picture


def test_cases_are_study_files_and_differ():
    cases = matrix()
    names = [case.name for case in cases]
    assert len(set(names)) == len(names) > 300
    refused = []
    for case in few(cases):
        content = StudyFile.model_validate(tables(case))
        refused += [case.name] if any(checks.problems(content)) else []
    families = {name.split(":")[0] for name in refused}
    assert families == {"step x stiffness", "step x Hs", "Hs x Tp", "Hs x Tp, stops", "gap"}


def few(cases):
    """The first, the last and some between of each family; those of PTO are refused by their type already."""
    for family in {case.family for case in cases} - {"PTO"}:
        alike = [case for case in cases if case.family == family]
        yield from alike[:: max(1, len(alike) // 8)]
        yield alike[-1]


def job(number):
    if number == 1:
        time.sleep(60)
    if number == 2:
        os._exit(3)
    return number


def test_a_hung_or_dead_process_is_replaced_and_the_others_go_on():
    results = dict(pool.run(job, range(6), [300.0, 0.5, 300.0, 300.0, 300.0, 300.0]))
    assert results == {0: 0, 1: None, 2: None, 3: 3, 4: 4, 5: 5}


def test_every_outcome_has_its_colour(tmp_path):
    families = ["step x stiffness", "step x Hs", "Hs x Tp", "mass x stiffness", "mass x PTO", "modes x damping"]
    rows = [*families, "Hs x Tp, stops", "reference path", *["geometry"] * 6]
    outcomes = ["ok"] * 9 + ["repeated", "failed", "refused", "BROKEN", "HANG"]
    data = xr.Dataset({"outcome": ("case", outcomes), "discretization_error": ("case", np.geomspace(1e-5, 1, 14))})
    data = data.assign_coords(family=("case", rows), x=("case", ["1"] * 14), y=("case", list("abcdefghijklmn")))
    picture(data, tmp_path / "map.png")
    assert (tmp_path / "map.png").stat().st_size > 10_000
    data["message"] = ("case", ["<why>"] * 14)
    data["energy_residual"] = ("case", np.full(14, 1e-5))
    text = page(data, [("order is off by", 0.01, 0.1)], ["geometry: 1, n: HANG"])
    assert "1 as they should not be: geometry: 1, n: HANG" in text and text.count("&lt;why&gt;") == 14
