"""Published cases beside ours: `make validate` prints one table and fails if a number falls outside.

    python -m studies.validate [SUBJECT ...]

Two processes share the subjects. Figures, one for most, and the table go to results/validate/.
"""

import importlib
import sys
import time
from concurrent.futures import ProcessPoolExecutor, as_completed
from multiprocessing import get_context

from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeElapsedColumn

from studies.validation import checks
from studies.validation.checks import OUT, Check

PROCESSES = 2
# In the order of the table; a subject is a function of a module of studies.validation.
SUBJECTS = {
    "hemisphere": "coefficients.hulme",
    "cylinder": "coefficients.cylinder",
    "box": "coefficients.box",
    "decay": "decay.decays",
    "oes-linear": "sphere.linear",
    "oes-nonlinear": "sphere.nonlinear",
    "oes-pto": "sphere.with_pto",
    "ellipsoid": "ellipsoid.power",
    "hinged-sphere": "hinged.pitch",
    "hinged-floats": "pairs.pitch",
    "mechanisms": "mechanisms.benchmarks",
    "beams": "beams.closed_forms",
    "cones": "beams.cones",
    "piles-in-soil": "beams.piles",
    "buan-modes": "beams.table_3",
    "pile": "pile.morison",
    "stretching": "stretching.loads",
    "modal-direct": "direct.modal_against_direct",
    "frequency-domain": "lines.frequency_domain",
    "spectrum": "spectra.spectrum",
    "f3of": "f3of.decays",
    "rotors": "rotors.arrays",
    "gaps": "gaps.lids",
}
# Longest first, so that neither process ends long before the other.
DEAREST = "rotors", "f3of", "frequency-domain", "gaps", "hinged-floats", "mechanisms", "hemisphere"


def compare(subject: str) -> tuple[list[Check], float]:
    """A subject's checks, and the time they took [s]."""
    module, function = SUBJECTS[subject].split(".")
    start = time.perf_counter()
    checked = getattr(importlib.import_module(f"studies.validation.{module}"), function)()
    return checked, time.perf_counter() - start


def run(subjects: list[str]) -> tuple[list[Check], dict[str, BaseException]]:
    """Checks of all subjects in the order of the table, and what went wrong with the others."""
    order = sorted(subjects, key=lambda s: DEAREST.index(s) if s in DEAREST else len(DEAREST))
    checks_of, failed = {}, {}
    columns = (TextColumn("{task.description}"), BarColumn(), MofNCompleteColumn(), TimeElapsedColumn())
    console = Console(stderr=True)
    # Fresh processes: a fork would copy what libraries keep of this one.
    pool = ProcessPoolExecutor(PROCESSES, mp_context=get_context("spawn"))
    with pool, Progress(*columns, console=console, transient=True) as bar:
        total = bar.add_task("validate", total=len(order))
        jobs = {pool.submit(compare, subject): subject for subject in order}
        for job in as_completed(jobs):
            subject = jobs[job]
            if error := job.exception():
                failed[subject] = error
            else:
                checks_of[subject], seconds = job.result()
                console.print(f"{subject}: {len(checks_of[subject])} numbers in {seconds:.0f} s", highlight=False)
            bar.advance(total)
    return [c for s in subjects if s in checks_of for c in checks_of[s]], failed


def report(numbers: list[Check], failed: dict[str, BaseException]) -> int:
    """Print the table, write it; 1 if a number is outside or a subject failed."""
    OUT.mkdir(parents=True, exist_ok=True)
    if numbers:
        print(checks.text(numbers))
        checks.write(numbers, OUT / "validate.csv")
    for subject, error in failed.items():
        print(f"{subject} FAILED: {type(error).__name__}: {error}")
    outside = sum(not c.passed for c in numbers)
    print(f"{len(numbers)} numbers, {outside} outside, {len(failed)} subjects failed; figures in {OUT}/")
    return int(outside > 0 or bool(failed))


def main(arguments: list[str]) -> int:
    """All subjects, or those named; exit status 0, 1 (outside), 2 (no such subject)."""
    for name in arguments:
        if name not in SUBJECTS:
            print(f"{name}: no such subject; there are {', '.join(SUBJECTS)}", file=sys.stderr)
            return 2
    return report(*run(arguments or list(SUBJECTS)))


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
