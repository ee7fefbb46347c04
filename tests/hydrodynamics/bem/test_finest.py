"""The finest mesh between the frequencies that it is solved at."""

from dataclasses import replace

import numpy as np
import pytest

from solver.hydrodynamics.bem import bem, finest
from solver.hydrodynamics.bem.finest import Solution, Turns, completed, left_out
from tests import awkward

OMEGA = np.linspace(0.5, 4.0, 36)
DIVISIONS = 3, 2, 1


def made(ring=0.0, width=0.02, distance=10.0):
    """Three meshes of two bodies, whose error is h² and a hundredth of h⁴, and that rings at 2.05 rad/s where asked."""
    k = OMEGA**2 / 9.81
    turn = np.exp(1j * k * distance)
    solutions = []
    for n in DIVISIONS:
        own = 1 + 0.3 * np.exp(-k) + 0.2j * k * np.exp(-k) + (0.1 + 0.02j) * k / n**2 + 0.02 * np.sin(OMEGA) / n**4
        own = own + ring / n**4 / (1 + 1j * (OMEGA - 2.05) / width)
        other = (0.05 + 0.02 / n**2 + 0.01 / n**4) * turn
        impedance = np.stack([np.stack([own, other], -1), np.stack([other, 2 * own], -1)], -2)
        force = np.stack([own, turn * own], axis=-1)[:, None]
        solutions.append(Solution(impedance, np.eye(2), force, np.empty((36, 0, 1)), 0.0, 100 * n**2))
    turns = Turns(np.stack([np.stack([0 * turn + 1, turn], -1)] * 2, -2), np.stack([0 * turn + 1, turn], -1)[:, None])
    turns.impedance[:, 1] = turns.impedance[:, 1, ::-1]
    return solutions, turns


def at(solution, index):
    impedance, diffraction, far = (x[index] for x in (solution.impedance, solution.diffraction, solution.far))
    return solution._replace(impedance=impedance, diffraction=diffraction, far=far)


def complete(solutions, turns):
    """The finest completed, its doubts, and the frequencies asked for."""
    known, asked = left_out(36), []

    def solve(some):
        asked.append(some)
        return at(solutions[0], some)

    first = [at(solutions[0], known), *solutions[1:]]
    return *completed(first, DIVISIONS, known, OMEGA, turns, np.ones(2), solve), asked


def test_smooth_differences_need_no_more_frequencies():
    solutions, turns = made()
    found, doubts, asked = complete(solutions, turns)
    assert not asked
    for name, doubt in zip(("impedance", "diffraction"), doubts, strict=True):
        off = np.abs(getattr(found, name) - getattr(solutions[0], name))
        assert off.max() < 1e-5 and np.all(off <= doubt + 1e-12), name
        assert np.all(off[left_out(36)] == 0)
    bare = Turns(np.ones_like(turns.impedance), np.ones_like(turns.diffraction))
    worse = np.abs(complete(solutions, bare)[0].impedance - solutions[0].impedance)
    assert worse.max() > 3e-5  # a wave on its way turns by 1 rad from one frequency to the next


def test_where_water_rings_the_finest_mesh_is_solved():
    solutions, turns = made(ring=10.0)
    found, _, asked = complete(solutions, turns)
    assert 0 < len(np.concatenate(asked)) < 18
    off = np.abs(found.impedance - solutions[0].impedance).max(axis=(1, 2))
    near = np.abs(OMEGA - 2.05) < 0.12
    assert off[near].max() == 0.0 and off.max() < 1e-2
    numbers = np.flatnonzero(near)
    assert set(numbers) <= {*left_out(36), *np.concatenate(asked)}


def test_few_frequencies_and_the_last_are_all_solved():
    np.testing.assert_array_equal(left_out(finest.FEWEST - 1), np.arange(finest.FEWEST - 1))
    assert list(left_out(36)[-2:]) == [34, 35] and len(left_out(36)) == 19


def problem(**changes):
    """The awkward pair's on the coarsest meshes, at as many frequencies as a study has."""
    scene, _ = awkward.big_beside_small()
    whole = bem.Problem.of(
        tuple(f.hull for f in scene.floats), np.array([f.centre for f in scene.floats]), depth=scene.water.depth,
        omega=np.linspace(0.3, 3.0, 40), panels=awkward.SMALL, headings=(0.0, 0.6), waves_to=2.2,
    )  # fmt: skip
    return replace(whole, **changes)


def test_a_big_hull_beside_a_small_one_is_as_if_all_were_solved(monkeypatch):
    """Within half of what the mesh is said to err by, in waves a fifth; whoever solves what, to the bit."""
    monkeypatch.setattr(bem, "left_out", np.arange)
    each = dict(zip(DIVISIONS, bem.part(problem())[0], strict=True))
    whole = bem.united(problem(), [[list(each.values())]])
    monkeypatch.undo()
    solved = []

    def again(asked, omega, n, *, infinite):
        solved.append((n, len(omega)))
        return at(each[n], np.searchsorted(asked.omega, omega))

    monkeypatch.setattr(bem, "_coefficients", again)
    less = bem.united(problem(), [bem.part(problem())])
    assert sum(count for n, count in solved if n == 3) <= 26
    assert sum(count for n, count in solved if n == 2) == 40
    thirds = bem.united(problem(), [bem.part(problem(), n, 3) for n in range(3)])
    for a, b, c in zip(less, thirds, whole, strict=True):
        assert a.mesh_error == pytest.approx(c.mesh_error, rel=0.05)
        for name in ("added_mass", "radiation_damping", "diffraction"):
            np.testing.assert_array_equal(getattr(a, name), getattr(b, name))
            off, error = np.abs(getattr(a, name) - getattr(c, name)), np.abs(getattr(c.error, name))
            assert 0 < off.max() < 0.5 * error.max(), name
            assert off[a.omega <= 2.2].max() < 0.2 * error.max(), name


def test_an_error_is_larger_by_a_doubt_in_its_own_sense():
    error = np.array([3 - 4j, -2.0, 0.0])
    np.testing.assert_allclose(bem._with(error, np.array([5.0, 1.0, 1.0])), [6 - 8j, -3.0, 0.0])


def test_all_frequencies_are_solved_where_the_finest_mesh_stands_for_itself():
    assert [len(each) for each in problem().solved] == [21, 40, 40]
    for changes in ({"far_field": True}, {"gap_damping": 0.05, "gap_width": 0.5}):
        assert [len(each) for each in problem(**changes).solved] == [40, 40, 40]
