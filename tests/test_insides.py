"""Where the solver reaches into other packages: what broke if a new version of one of them takes that away."""

import errno
import os
import pickle
import re
import subprocess
import sys
from contextlib import nullcontext
from dataclasses import replace
from functools import partial

import numba
import numpy as np
import pytest
from numba import __version__ as numba_version
from numba import float64
from numba.core.codegen import ll

from solver import kernels
from solver.hydrodynamics import library
from solver.hydrodynamics.bem import bem, green
from solver.hydrodynamics.hull.revolution import Revolution
from solver.kernels import (
    fast_kernel,
    fast_lean_kernel,
    inner_kernel,
    kernel,
    lean_kernel,
    part_kernel,
    whole_lean_kernel,
)
from solver.scene import EndStops
from solver.statistics import Statistics
from tests.awkward import unequal_legs

FLOAT = Revolution.hemisphere_cylinder(radius=1.0, height=0.6)


def first_row_sum(rows):
    row = rows[0]
    return row[0] + row[1]


COUNTS = [(kernel, True), (fast_kernel, True), (lean_kernel, False), (fast_lean_kernel, False)]


@pytest.mark.parametrize(("compiled", "counts"), COUNTS)
def test_numba_leaves_the_counting_of_references_out_where_kernels_ask_for_it(compiled, counts):
    """Without: take `_nrt` out of solver/kernels.py; a march then takes an eighth longer."""
    told = f"numba {numba_version} no longer heeds `_nrt`, its private option that solver/kernels.py uses"
    try:
        function = compiled(cache=False)(first_row_sum)
        function.compile((float64[:, ::1],))
    except KeyError as error:
        pytest.fail(f"{told}: {error}")
    code = function.inspect_llvm(function.signatures[0])
    assert ("NRT_decref" in code) == counts, told


@pytest.mark.parametrize(("compiled", "doors"), [(lean_kernel, ["cpython"]), (part_kernel, []), (inner_kernel, [])])
def test_numba_makes_no_doors_that_nobody_uses(compiled, doors):
    """Without: take both options out of solver/kernels.py; a march compiles three times as long."""
    function = compiled(cache=False)(first_row_sum)
    function.compile((float64[:, ::1],))
    code = function.inspect_llvm(function.signatures[0])
    made = [door for door in ("cpython", "cfunc") if re.search(rf"^define .*@_ZN\d+{door}", code, re.M)]
    assert made == doors, f"numba {numba_version} no longer heeds `no_cfunc_wrapper` or `no_cpython_wrapper`"


FORCED = partial(fast_lean_kernel, forceinline=True)
TAKEN_IN = [(kernel, False), (lean_kernel, False), (inner_kernel, False), (part_kernel, True), (FORCED, True)]


@pytest.mark.parametrize(("compiled", "taken_in"), TAKEN_IN)
def test_numba_takes_kernels_into_those_that_call_them_where_they_ask_for_it(compiled, taken_in):
    """Without: a march takes a third longer."""
    function = compiled(cache=False)(first_row_sum)
    function.compile((float64[:, ::1],))
    assert ("alwaysinline" in function.inspect_llvm(function.signatures[0])) == taken_in


def test_numba_makes_machine_code_of_what_only_kernels_call_in_these_alone():
    """Without: take `pipeline_class` out of solver/kernels.py; a march compiles a third longer."""
    part = inner_kernel(cache=False)(first_row_sum)
    whole = kernel(cache=False)(lambda rows: part(rows) + 1.0)
    assert whole(np.eye(2)) == 2.0
    made, inside = (one.overloads[one.signatures[0]].library._get_compiled_object() for one in (whole, part))
    functions = re.compile(rb"_ZN(?!08NumbaEnv)")
    told = f"numba {numba_version} no longer makes libraries as solver/kernels.py overrides it"
    assert functions.search(made) and not functions.search(inside), told


def test_numba_keeps_of_what_no_kernel_calls_its_machine_code_alone():
    """Without: take `whole_lean_kernel` out of solver/coupled/march.py; its first call reads 3 MB more, 0.1 s."""
    kept = []
    for compiled in (whole_lean_kernel, lean_kernel):
        function = compiled(cache=False)(first_row_sum)
        function.compile((float64[:, ::1],))
        library = function.overloads[function.signatures[0]].library
        code, module = library.serialize_using_object_code()[2]
        assert code == library._get_compiled_object()
        kept.append([f.name for f in ll.parse_bitcode(module).functions if not f.is_declaration])
    (door,), others = kept
    assert door.startswith("_ZN7cpython"), f"numba {numba_version}: see solver/kernels.py"
    assert any(name.startswith("_ZN5tests") for name in others)


def test_numba_loads_what_is_compiled_without_what_it_compiles_with():
    """Without: take `_load` out of solver/kernels.py; the first call of a kernel then takes 0.15 s more."""
    Statistics().add(np.eye(3))  # its kernel is compiled and cached by now
    program = (
        "import sys; import numpy as np; from solver.statistics import Statistics\n"
        "told = Statistics(); told.add(np.eye(3)); print(told.high, 'numba.np.linalg' in sys.modules)"
    )
    done = subprocess.run([sys.executable, "-c", program], check=True, capture_output=True, text=True)
    told = f"numba {numba_version} no longer loads kernels by FunctionCache.load_overload"
    assert done.stdout == "[1. 1. 1.] False\n", told


def test_numba_compiles_once_what_several_processes_need(tmp_path):
    """Without: take `_compile_once` out of solver/kernels.py; workers that begin together then all compile the same."""
    program = (
        "import time; import numpy as np; from numba.core import event\n"
        "from solver.statistics import Statistics, _take_in\n"
        "class Slow(event.Listener):\n"
        "    def on_start(self, _): time.sleep(1.0)\n"
        "    def on_end(self, _): pass\n"
        "event.register('numba:compile', Slow()); told = Statistics(); told.add(np.eye(3))\n"
        "print(sum(_take_in.stats.cache_misses.values()), told.high)"
    )
    env = {**os.environ, "NUMBA_CACHE_DIR": str(tmp_path)}
    both = [subprocess.Popen([sys.executable, "-c", program], env=env, stdout=subprocess.PIPE, text=True) for _ in "ab"]
    said = sorted(process.communicate()[0] for process in both)
    assert said == ["0 [1. 1. 1.]\n", "1 [1. 1. 1.]\n"], f"numba {numba_version}: see solver/kernels.py"


def test_a_process_compiles_nothing_that_another_has_compiled(tmp_path):
    """A kernel with an array, or a tuple of some, as an argument's default is never found again in numba's cache."""
    whole, h = unequal_legs()
    short = replace(whole, settings=replace(whole.settings, duration=20.0, discard=5.0, ramp=5.0))
    stops = EndStops(lower=-0.01, upper=0.01, stiffness=1e7, damping=1e5)
    hits = replace(short, floats=tuple(replace(f, end_stops=stops) for f in short.floats))
    lines = replace(short, settings=replace(short.settings, method="frequency", froude_krylov="linear"))
    (tmp_path / "scenes").write_bytes(pickle.dumps(([short, hits, lines], h)))
    program = (
        "import gc, pickle, sys; from numba.core.dispatcher import Dispatcher; from solver.run import simulate\n"
        "scenes, h = pickle.load(open(sys.argv[1], 'rb'))\n"
        "for scene in scenes: simulate(scene, h)\n"
        "kernels = [d for d in gc.get_objects() if isinstance(d, Dispatcher)]\n"
        "print([d.__name__ for d in kernels if sum(d.stats.cache_misses.values())])"
    )
    command = [sys.executable, "-c", program, str(tmp_path / "scenes")]
    said = [subprocess.run(command, check=True, capture_output=True, text=True).stdout for _ in "ab"]
    assert said[1] == "[]\n", said


def test_a_kernel_is_compiled_where_nothing_can_be_locked(monkeypatch):
    asked = []

    def full(file, **_):
        asked.append(file)
        raise OSError(errno.ENOSPC, "no space left")

    monkeypatch.setattr(kernels, "FileLock", full)
    assert kernel(first_row_sum)(np.eye(2)) == 1.0
    assert asked


def test_a_kernel_for_other_types_waits_for_no_other_but_in_its_index(monkeypatch, tmp_path):
    asked = []

    def noted(file, **_):
        asked.append(os.path.basename(file))
        return nullcontext()

    monkeypatch.setattr(kernels, "FileLock", noted)
    monkeypatch.setattr(numba.config, "CACHE_DIR", str(tmp_path))
    function = kernel(first_row_sum)
    assert [function(np.eye(2, dtype=kind)) for kind in ("f8", "f4")] == [1.0, 1.0]
    one, index, other, same = asked
    assert one != other and index == same


@pytest.fixture
def afresh():
    """A Green function without what others have fitted, before and after; capytaine itself imported before."""
    library.capytaine()
    green.green_function.cache_clear()
    yield
    green.green_function.cache_clear()


def test_capytaine_has_our_fit_of_the_finite_depth_function(monkeypatch, afresh):
    """Without: coefficients are 1 % off in long waves, and differ from process to process by what its fit leaves."""
    fits, fit = [], green._exponentials
    monkeypatch.setattr(green, "_exponentials", lambda *a, **k: fits.append(1) or fit(*a, **k))
    shallow()
    assert fits, "capytaine no longer fits by green_functions.delhommeau.find_best_exponential_decomposition (green.py)"


def shallow():
    bem.solve((FLOAT,), [[0, 0, 0]], depth=1.5, omega=np.array([1.2]), panels=108)
