"""The Green function's table: where it is kept, and frequencies at which faces of plates lie in the same cells."""

import os
import subprocess
import sys
import threading
from math import inf
from pathlib import Path

import numpy as np
import pytest
from filelock import FileLock

from solver.hydrodynamics.bem import bem
from solver.hydrodynamics.bem.green import green_function
from solver.hydrodynamics.bem.table import FIRST, RATIO, clear, level_plates
from solver.hydrodynamics.hull.revolution import Revolution
from solver.hydrodynamics.hull.ring import ring
from solver.hydrodynamics.library import capytaine

SPAR = Revolution.profile([[15.0, -29.0], [15.0, -28.9], [3.0, -28.9], [3.0, 8.0]])
AT = np.zeros((1, 3))


def test_cells_are_those_of_the_table():
    z = -green_function().tabulated_z_range
    assert z == pytest.approx(FIRST * RATIO ** np.arange(1, len(z) + 1), rel=1e-9)


def test_who_comes_while_it_is_made_waits_for_it(monkeypatch):
    module, made = capytaine().green_functions.delhommeau, []
    monkeypatch.setattr(module, "Delhommeau", lambda: made.append(True))
    waiting = threading.Thread(target=green_function.__wrapped__)
    with FileLock(Path(module.cache_directory(), "table.lock")):
        waiting.start()
        waiting.join(timeout=0.2)
        assert not made
    waiting.join()
    assert made


@pytest.mark.parametrize("home", [{"HOME": os.devnull}, {"XDG_CACHE_HOME": os.devnull}])
def test_it_is_kept_with_what_is_temporary_where_the_user_has_no_room_for_it(home, tmp_path):
    """As in a container whose user has no home: capytaine makes its folder as it is imported."""
    code = "from solver.hydrodynamics.library import capytaine; capytaine()"
    given = "CAPYTAINE_CACHE_DIR", "XDG_CACHE_HOME"
    elsewhere = {name: value for name, value in os.environ.items() if name not in given}
    subprocess.run([sys.executable, "-c", code], env=elsewhere | home | {"TMPDIR": str(tmp_path)}, check=True)
    assert (tmp_path / f"capytaine-{os.getuid()}").is_dir()


def test_plates_are_found_whatever_the_hull():
    skirt = ring(((9.0, -3.0), (11.0, -3.0), (11.0, 2.0), (10.0, 2.0), (10.0, -2.9), (9.0, -2.9)))
    assert level_plates(SPAR) == [(28.9, 29.0)] and level_plates(skirt) == [(2.9, 3.0)]
    assert not level_plates(Revolution.vertical_cylinder(radius=3.0, draft=2.0, freeboard=1.0))


@pytest.mark.parametrize(("depth", "omega"), [(inf, 0.64), (60.0, 0.64)])
def test_damping_of_a_heave_plate_is_smooth(depth, omega):
    """Between its neighbours; where the faces lie in two cells it is a quarter of it off and more, on any mesh."""
    low, moved, high = clear(np.array([0.62, omega, 0.66]), (SPAR,), depth, 9.81)
    grid = np.array([low, omega, moved, high])
    problem = bem.Problem.of((SPAR,), AT, depth=depth, density=1000.0, omega=grid[[0, 3]], panels=108)
    B = bem._coefficients(problem, grid, 2, infinite=False).impedance.imag[:, 1, 1] * grid
    as_asked, cleared = B[1:3] / np.interp(grid[1:3], grid[[0, 3]], B[[0, 3]]) - 1
    assert abs(as_asked) > 0.25 and abs(cleared) < 0.01


def test_a_grid_is_moved_a_little_and_only_where_it_must_be():
    ball, water = Revolution.sphere(radius=5.0, draft=5.0), {"depth": inf, "gravity": 9.81}
    plain = np.linspace(0.5, 1.5, 200)
    assert clear(plain, (ball,), **water) is plain
    moved = clear(plain, (SPAR,), **water)
    assert 0 < np.abs(moved / plain - 1).max() <= 3e-3 and np.all(np.diff(moved) > 0)
    assert clear(moved, (SPAR,), **water) == pytest.approx(moved, rel=1e-12) and np.mean(moved != plain) < 0.2
    grid = bem.frequency_grid((SPAR,), AT, **water)
    assert clear(grid, (SPAR,), **water) == pytest.approx(grid, rel=1e-12)
