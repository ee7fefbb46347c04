"""Deliberate faults, one at a time, in a copy of the tree: does a test notice?   python tests/mutations.py [WORD ...]

`mutations.toml` lists them: a piece of a file, what to put in its place, and the tests that should fail. These run
first; what they do not notice meets all tests but the slow ones (unless --named). Exit status 1 if fewer than 90 % are
killed. WORD: only mutations with one of these words in their file or their new text.
"""

from __future__ import annotations

import argparse
import ast
import os
import shutil
import signal
import subprocess
import sys
import time
import tomllib
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cache, cached_property
from pathlib import Path

from pipeline.environment import sources

HERE = Path(__file__).parent
ROOT = HERE.parent
TABLE = HERE / "mutations.toml"
COPIED = ("solver", "pipeline", "studies", "tests", "README.md", "Makefile", "pyproject.toml")
EVERY = ("tests",)
NEEDED = 0.9  # share of the mutations that a test must notice
LONGEST = 3600.0  # a mutation may make a loop endless: a test that hangs has noticed it [s]


@dataclass(frozen=True, kw_only=True)
class Mutation:
    """One fault."""

    file: str
    old: str
    new: str
    tests: tuple[str, ...]
    interpreted: bool = False  # kernels without the compiler, where that is sooner done

    def __str__(self) -> str:
        return f"{self.file}: {' '.join(self.old.split())} -> {' '.join(self.new.split())}"


@cache
def mutations() -> list[Mutation]:
    """All that the table lists."""
    parts = tomllib.loads(TABLE.read_text(encoding="utf-8"))["file"]
    return [
        Mutation(
            file=part["path"], old=old, new=new, tests=tuple(part["tests"]), interpreted=part.get("interpreted", False)
        )
        for part in parts
        for old, new in part["mutations"]
    ]


class Copy:
    """A copy of the tree in which tests are run, with compiled kernels apart."""

    def __init__(self, folder: Path):
        self.tree, self.cache = folder / "tree", folder / f"kernels-{sources()}"
        self._sound: dict[tuple[tuple[str, ...], bool], bool] = {}
        shutil.rmtree(self.tree, ignore_errors=True)
        for name in COPIED:
            source, target = ROOT / name, self.tree / name
            if source.is_dir():
                shutil.copytree(source, target, ignore=shutil.ignore_patterns("__pycache__"))
            else:
                shutil.copy2(source, target)

    def sound(self, tests: tuple[str, ...], interpreted: bool) -> bool:
        """Whether tests pass where there is no fault; this also compiles the kernels."""
        if (tests, interpreted) not in self._sound:
            failure = self._failure(tests, interpreted, self.cache)
            self._sound[tests, interpreted] = not failure
            print(failure, end="")
        return self._sound[tests, interpreted]

    def notices(self, mutation: Mutation, tests: tuple[str, ...], interpreted: bool) -> bool:
        """Whether one of the tests fails on the tree with a fault in it, and passes without."""
        if not self.sound(tests, interpreted):
            return False
        file, kernels = self.tree / mutation.file, self.cache.with_name("faulty")
        right, stat = file.read_bytes(), file.stat()
        shutil.rmtree(kernels, ignore_errors=True)
        shutil.copytree(self.cache, kernels)
        self._forget(kernels, mutation.file)
        try:
            file.write_text(right.decode().replace(mutation.old, mutation.new), encoding="utf-8")
            return bool(self._failure(tests, interpreted, kernels))
        finally:
            file.write_bytes(right)
            os.utime(file, ns=(stat.st_atime_ns, stat.st_mtime_ns))  # by which numba knows its kernels

    def _failure(self, tests: tuple[str, ...], interpreted: bool, kernels: Path) -> str:
        """What is said of the first test that fails, empty if all pass; raises where they cannot even be run."""
        # A slow test runs if it is named by itself.
        chosen = tests if all("::" in test for test in tests) else ("-m", "not slow", *tests)
        command = [sys.executable, "-m", "pytest", "-xq", "-p", "no:cacheprovider", *chosen]
        kernels.mkdir(parents=True, exist_ok=True)
        compiler = {"NUMBA_CACHE_DIR": str(kernels), "NUMBA_DISABLE_JIT": str(int(interpreted))}
        threads = dict.fromkeys(("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "NUMBA_NUM_THREADS"), "1")
        env = {**os.environ, **threads, **compiler, "PYTHONPATH": str(self.tree), "PYTHONDONTWRITEBYTECODE": "1"}
        code, said = _ended(command, self.tree, env)
        if code > 1:
            raise RuntimeError(f"pytest ended with {code}:\n{said}")
        return said if code else ""

    def _forget(self, kernels: Path, file: str) -> None:
        """Compiled kernels that may have called those of a file; numba does not notice an edit in another file."""
        for module in self._users(file):
            for path in kernels.glob(f"*/{Path(module).stem}.*"):
                path.unlink()

    def _users(self, file: str) -> set[str]:
        """A file and all that import it, directly or not; it alone if nothing in it is compiled."""
        users: set[str] = {file}
        while "solver/kernels.py" in self._imports[file]:
            more = {name for name, used in self._imports.items() if used & users} - users
            if not more:
                break
            users |= more
        return users

    @cached_property
    def _imports(self) -> dict[str, set[str]]:
        """Files of the solver -> those that they import; of the rest nothing is compiled."""
        files = [path.relative_to(self.tree).as_posix() for path in (self.tree / "solver").rglob("*.py")]
        return {name: set(_imported(ast.parse((self.tree / name).read_text()))) for name in files} | {
            mutation.file: set() for mutation in mutations() if not mutation.file.startswith("solver")
        }


def _imported(tree: ast.Module) -> Iterator[str]:
    for node in ast.walk(tree):
        if isinstance(node, ast.ImportFrom) and node.module:
            for name in (node.module, *(f"{node.module}.{alias.name}" for alias in node.names)):
                yield name.replace(".", "/") + ".py"


def _ended(command: list[str], folder: Path, env: dict[str, str]) -> tuple[int, str]:
    """Exit status and output; 1 for what takes too long, and for what is killed by a signal."""
    pipes = {"stdout": subprocess.PIPE, "stderr": subprocess.STDOUT, "text": True}
    with subprocess.Popen(command, cwd=folder, env=env, start_new_session=True, **pipes) as process:
        try:
            said, _ = process.communicate(timeout=LONGEST)
        except subprocess.TimeoutExpired:
            os.killpg(process.pid, signal.SIGKILL)
            return 1, "took too long"
    return (process.returncode if process.returncode >= 0 else 1), said


def judged(copy: Copy, mutation: Mutation, named: bool) -> str:
    """What tests make of a mutation."""
    if copy.notices(mutation, mutation.tests, mutation.interpreted):
        return "killed"
    return "killed by others" if not named and copy.notices(mutation, EVERY, interpreted=False) else "SURVIVED"


def main() -> int:
    """The exit status."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("words", nargs="*", metavar="WORD")
    parser.add_argument("--named", action="store_true", help="no other tests than those named")
    parser.add_argument("--folder", type=Path, default=ROOT / ".jit" / "mutations", help="of the copy")
    options = parser.parse_args()
    chosen = [m for m in mutations() if any(word in m.file or word in m.new for word in options.words or [""])]
    copy, caught = Copy(options.folder.resolve()), 0
    for number, mutation in enumerate(chosen, 1):
        start = time.monotonic()
        word = judged(copy, mutation, options.named)
        caught += word.startswith("killed")
        print(f"{number:3}/{len(chosen)} {word:16} {time.monotonic() - start:5.0f} s  {mutation}", flush=True)
    print(f"{caught} of {len(chosen)} mutations killed ({caught / max(len(chosen), 1):.0%})")
    return 0 if caught >= NEEDED * len(chosen) else 1


if __name__ == "__main__":
    sys.exit(main())
