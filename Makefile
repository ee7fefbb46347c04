# A bare machine needs Python, 3.11 or newer, make and gcc; the rest is set up in .venv, once. Tests pass with 3.11 to 3.13.
PYTHON ?= $(or $(shell for python in python3.11 python3.12 python3.13 python3; do \
	$$python -c 'import sys; sys.exit(sys.version_info < (3, 11))' 2> /dev/null && echo $$python && break; done),python3.11)
VENV := .venv
READY := $(VENV)/.ready

# Parallel work is processes; a thread pool beneath them only gets in the way.
export OMP_NUM_THREADS := 1
export OPENBLAS_NUM_THREADS := 1
export NUMBA_NUM_THREADS := 1
# numba's cache misses an edit in another file: a new folder for each state of the sources.
export NUMBA_CACHE_DIR := $(CURDIR)/.jit/$(shell find solver -name '*.py' | LC_ALL=C sort | xargs cat | cksum | tr -d ' ')

# Whatever the shell says: every process would compile all sources again that it imports, and tests start a hundred.
unexport PYTHONDONTWRITEBYTECODE

.PHONY: study-buan paper jeju life test nightly validate bench bench-pipeline stress test-python kills faults fuzz figure lint types setup clean

study-buan: $(READY)
	$(VENV)/bin/study run studies/buan.toml

# The paper's tables beside many realizations of ours, what each of our choices changes, and figures of one realization.
# Some variants have tasks that fail (status 1: a float swings through): the table says so.
paper: $(READY)
	set -e; for study in studies/paper.toml studies/buan-series.toml; do \
		echo $$study; $(VENV)/bin/study run $$study > /dev/null || test $$? -eq 1; done
	$(VENV)/bin/python -m studies.paper

# Six rotors on a moored platform, held, and on fixed axes; a table and studies/jeju.png.
jeju: $(READY)
	$(VENV)/bin/study run studies/jeju-rotors.toml
	$(VENV)/bin/python -m studies.jeju

# Fatigue damage and life of Buan's legs over five years, and why it goes by signed stress.
life: $(READY)
	$(VENV)/bin/study run studies/buan-fatigue.toml
	$(VENV)/bin/python -m studies.life

# On two cores; further processes fill them while some wait for others or for the compiler. As on other machines:
# make test ORDER=7 OPENBLAS_NUM_THREADS=2 OPENBLAS_CORETYPE=Haswell, with a random order and random examples of that seed.
test: $(READY)
	$(VENV)/bin/python -m pytest -q -n 4 --dist worksteal -m "not slow" $(if $(ORDER),\
		--shuffle $(ORDER) --hypothesis-profile random --hypothesis-seed $(ORDER))

# All that is too slow for `test`, and whether the tests notice deliberate faults (tests/mutations.toml): many hours.
nightly: $(READY)
	$(VENV)/bin/python tests/nightly.py

validate: $(READY)
	$(VENV)/bin/python -m studies.validate

bench: $(READY)
	$(VENV)/bin/python -m studies.bench

# Where the solver is stable and accurate and where it stops: some 480 scenes, then more random ones of each invariant.
stress: $(READY)
	$(VENV)/bin/python -m studies.stress
	EXAMPLES=40 $(VENV)/bin/python -m pytest -q tests/test_invariants.py --hypothesis-profile=random

# The kernels without the compiler: unit tests, then short runs against compiled ones.
test-python: $(READY)
	NUMBA_DISABLE_JIT=1 $(VENV)/bin/python -m pytest -q tests/multibody/test_chain.py tests/coupled/test_support.py \
		tests/hydrodynamics/pressure/test_froude_krylov.py
	$(VENV)/bin/python -m pytest -q tests/test_stability.py -k interpreted

# What the pipeline itself costs, on empty tasks, beside others; time before the first step, and a second worker's gain.
bench-pipeline: $(READY)
	$(VENV)/bin/python -m pip install --quiet --disable-pip-version-check -c constraints.txt -e '.[bench]'
	PYTHONPATH=. $(VENV)/bin/python tests/pipeline/bench.py
	PYTHONPATH=. $(VENV)/bin/python tests/pipeline/startup.py

# 200 kills of running studies; broken disks, hanging and greedy tasks; 2,000 random study files.
kills: $(READY)
	PYTHONPATH=. $(VENV)/bin/python tests/pipeline/kills.py 200

faults: $(READY)
	$(VENV)/bin/python -m pytest -q tests/pipeline/running/test_robust.py

fuzz: $(READY)
	PYTHONPATH=. $(VENV)/bin/python -W ignore tests/pipeline/fuzz.py 2000

figure: study-buan
	$(VENV)/bin/study report studies/buan.toml --figure studies/buan.png

lint: $(READY)
	$(VENV)/bin/ruff check .
	$(VENV)/bin/ruff format --check .
	$(VENV)/bin/lint-imports

# Of a fresh clone some two minutes, nearly all in overloads of numpy's operators.
types: $(READY)
	$(VENV)/bin/mypy

setup: $(READY)

$(READY): pyproject.toml constraints.txt
	test -x $(VENV)/bin/python || $(PYTHON) -m venv $(VENV)
	$(VENV)/bin/python -m pip install --quiet --disable-pip-version-check --no-compile -c constraints.txt -e '.[test]'
	-$(VENV)/bin/python -m compileall -qq -j 0 $(VENV)/lib  # as pip does, on all cores
	touch $@

# Results stay: they are the user's.
clean:
	rm -rf $(VENV) .jit .mypy_cache .ruff_cache .pytest_cache .import_linter_cache *.egg-info
