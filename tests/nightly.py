"""The slow checks, one after another whatever becomes of each, and one table at the end.   python tests/nightly.py

Exit status 1 if one fails. Each leaves its output in results/nightly/.
"""

from __future__ import annotations

import subprocess
import sys
import time
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

ROOT = Path(__file__).parents[1]
LOGS = ROOT / "results" / "nightly"
TARGETS = ("types", "test-python", "faults", "fuzz", "kills", "validate", "stress", "paper")
CHECKS = {name: ("make", "--no-print-directory", name) for name in TARGETS} | {
    "slow": (sys.executable, "-m", "pytest", "-q", "-m", "slow"),
    "mutations": (sys.executable, "tests/mutations.py"),
}


@dataclass(frozen=True, kw_only=True)
class Outcome:
    """How a check ended."""

    name: str
    status: int
    seconds: float
    log: Path

    def __str__(self) -> str:
        end = "passed" if self.status == 0 else f"FAILED ({self.status})"
        return f"{self.name:12} {end:13} {self.seconds / 60:6.1f} min  {self.log}"


def check(name: str, command: Sequence[str], logs: Path) -> Outcome:
    """Run a check to its end."""
    log, start = logs / f"{name}.log", time.monotonic()
    with log.open("w", encoding="utf-8") as file:
        try:
            status = subprocess.run(command, cwd=ROOT, stdout=file, stderr=subprocess.STDOUT, check=False).returncode
        except OSError as error:
            file.write(f"{error}\n")
            status = 127  # as a shell has it
    return Outcome(name=name, status=status, seconds=time.monotonic() - start, log=log)


def run(checks: Mapping[str, Sequence[str]], logs: Path) -> Iterable[Outcome]:
    """All checks, each said when it begins."""
    logs.mkdir(parents=True, exist_ok=True)
    for name, command in checks.items():
        print(f"{name} ...", flush=True)
        yield check(name, command, logs)


def main(checks: Mapping[str, Sequence[str]] = CHECKS, logs: Path = LOGS) -> int:
    """The exit status."""
    outcomes = list(run(checks, logs))
    print(*outcomes, sep="\n")
    return int(any(outcome.status for outcome in outcomes))


if __name__ == "__main__":
    sys.exit(main())
