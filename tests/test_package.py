"""The package as a user meets it: cheap to import, a few names, and pages whose links and examples hold."""

import re
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

import solver
from solver import motions
from solver.coupled.boundary import coefficients, needed

ROOT = Path(__file__).parents[1]


def ball(**changes):
    hull = solver.Revolution.sphere(radius=5.0, draft=5.0)
    fields = {"mass": 261.8e3, "inertia": (2.6e6,) * 3, "hinge": (0, 0, 0), "motion": ("heave",)} | changes
    return solver.Float(name="ball", hull=hull, **fields)


def test_importing_the_package_loads_nothing_heavy():
    heavy = "{'numpy', 'scipy', 'numba', 'capytaine'}"
    program = f"import sys, solver; assert not {heavy} & set(sys.modules)"
    subprocess.run([sys.executable, "-c", program], check=True, cwd=ROOT)


@pytest.mark.parametrize(
    "before",
    [
        "import solver.run",
        *(pytest.param(text, marks=pytest.mark.slow) for text in ("pass", "from solver.run import simulate")),
    ],
)
def test_simulate_is_the_function_whatever_was_imported_before(before):
    program = f"{before}\nfrom solver import simulate\nassert simulate.__name__ == 'simulate', simulate"
    subprocess.run([sys.executable, "-c", program], check=True, cwd=ROOT)


def test_every_name_is_there_and_no_other():
    assert all(getattr(solver, name) is not None for name in solver.__all__)
    assert set(solver.__all__) <= set(dir(solver))
    with pytest.raises(AttributeError, match="no attribute Flot"):
        _ = solver.Flot


def test_a_scene_implies_the_arguments_of_its_boundary_elements(monkeypatch):
    asked = {}
    monkeypatch.setattr("solver.hydrodynamics.bem.bem.solve", lambda *a, **k: asked.update(k))
    water = solver.Water(depth=30.0, density=1000.0)
    sea = solver.regular(height=0.1, period=2 * np.pi / 5.5, heading=0.4)
    coefficients(solver.Scene(water=water, sea=sea, floats=(ball(),), settings=solver.Settings(time_step=0.1)))
    assert (asked["depth"], asked["density"], asked["heading"], asked["planar"]) == (30.0, 1000.0, 0.4, False)
    assert asked["omega"][-1] >= 5.5 and asked["waves_to"] == pytest.approx(5.5, rel=1e-12)
    coefficients(solver.Scene(water=water, floats=(ball(),)), band=(0.21, 7.0))
    assert asked["planar"] and asked["omega"][-1] >= 7.0 and asked["waves_to"] == 7.0
    assert coefficients(solver.Scene(water=water)) is None


@pytest.mark.parametrize(
    ("changes", "asked"), [({}, True), ({"memory": "convolution"}, False), ({"radiation": False}, False)]
)
def test_a_march_has_the_memory_that_a_study_has(monkeypatch, changes, asked):
    """Of the frequencies that panels resolve."""

    def remembering(h, hulls, ways):
        raise LookupError(h, hulls, ways)

    monkeypatch.setattr("solver.run.coefficients", lambda scene: "solved")
    monkeypatch.setattr("solver.run.remembering", remembering)
    scene = solver.Scene(water=solver.Water(depth=30.0), floats=(ball(),), settings=solver.Settings(**changes))
    with pytest.raises((LookupError, AttributeError)) as caught:
        solver.simulate(scene)
    assert (caught.value.args == ("solved", (ball().hull,), motions.of_scene(scene))) is asked


def test_boundary_elements_are_solved_only_where_something_depends_on_them():
    water, bare = solver.Water(depth=30.0), {"radiation": False, "diffraction": False}
    assert needed(solver.Scene(water=water, floats=(ball(),)))
    assert not needed(solver.Scene(water=water))
    assert not needed(solver.Scene(water=water, floats=(ball(),), settings=solver.Settings(**bare)))
    for pressure in ("linear", "none"):  # of which both have linear buoyancy
        settings = solver.Settings(**bare, froude_krylov=pressure)
        assert needed(solver.Scene(water=water, floats=(ball(),), settings=settings))


def anchors(page):
    """As they are made of a page's headings."""
    headings = re.findall(r"^#+ (.*)$", page.read_text(encoding="utf-8"), re.M)
    return {re.sub(r"[^\w -]", "", heading.lower()).replace(" ", "-") for heading in headings}


@pytest.mark.parametrize("folder", [".", "solver", "pipeline", "studies"])
def test_links_of_the_pages_lead_somewhere(folder):
    page = ROOT / folder / "README.md"
    links = re.findall(r"\]\(([^)#\s]*)#?([^)\s]*)\)", page.read_text(encoding="utf-8"))
    assert links
    for path, anchor in links:
        there = page.parent / path if path else page
        assert there.exists(), path
        assert not anchor or anchor in anchors(there), (path, anchor)


def test_the_readmes_example_runs():
    text = (ROOT / "README.md").read_text().split("## From Python")[1].split("\n## ")[0]
    names = {}
    exec("\n".join(re.findall(r"^    (.*)$", text, re.M)), names)
    heave = names["record"].series["motion"][1][:, 0, 0]
    assert heave[0] > 0.9  # m, let go a metre up
    assert names["record"].attrs["constraint_drift"] < 1e-9
