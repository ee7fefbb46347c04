"""`make stress`: every scene of the matrix in two processes; table, results/stress/stress.nc and the map.

Exit status 1 if a scene ends with NaN, a traceback or a hang, if a record's energy balance is open by
more than 1e-3, or if one of the comparisons between scenes fails.
"""

import sys
import time
from pathlib import Path

import numpy as np
import xarray as xr

from studies.stress import pool
from studies.stress.matrix import Case, geometries, matrix
from studies.stress.page import page
from studies.stress.picture import picture
from studies.stress.run import attempt, warm

OUT = Path("results/stress")
UNITS = {
    "energy_residual": ("1", "Energy that the balance does not account for, of its largest term"),
    "discretization_error": ("1", "Estimated relative error of the time step"),
    "estimated_error": ("1", "Estimated relative error of step, quadrature, memory and mesh"),
    "constraint_drift": ("m", "Largest distance of a hinge from its place"),
    "work_wave": ("J", "Work of the waves on the floats"),
    "time_step": ("s", "Time step, a quarter of the asked one where the run was repeated"),
    "largest_rotation": ("rad", "Largest rotation of a float"),
    "moved": ("rad", "Largest less smallest rotation of any float"),
    "rms_of_rotation": ("rad", "RMS rotation of the front float"),
    "wall_time": ("s", "Wall time of the scene"),
}
COMPILED = ("Hs x Tp", "Hs x Tp, stops")  # whose scenes call all that others do: a limit is not for the compiler
COMPILING = 600.0  # s
BALANCE = 1e-3
BAD, GOOD = ("BROKEN", "HANG"), ("ok", "repeated")
NOTHING = dict.fromkeys((*UNITS, "digest"), np.nan)  # to compare with, of a scene without a record: then none agrees


def line(number: int) -> dict[str, object]:
    """What a worker does: one case by its number."""
    return attempt(matrix()[number])


def rows(cases: list[Case]) -> list[dict[str, object]]:
    """All results in the order of the cases; a lost process is a hang."""
    results: list[dict[str, object]] = [{}] * len(cases)
    for number, result in pool.run(line, range(len(cases)), [c.limit for c in cases]):
        case = cases[number]
        lost = {"outcome": "HANG", "message": f"no answer in {case.limit:g} s", "wall_time": case.limit}
        row = result or {"family": case.family, "x": case.x, "y": case.y, **lost}
        results[number] = row if row["outcome"] in GOOD else {**NOTHING, **row}
        show(case, results[number])
    return results


def show(case: Case, row: dict[str, object]) -> None:
    """One line of the table."""
    figures = [row.get(k, np.nan) for k in ("energy_residual", "discretization_error", "wall_time")]
    message = str(row["message"]).replace("\n", " ")[:110]
    energy, step, wall = figures
    print(f"{case.name:42s}{row['outcome']:10s}{energy:9.1e}{step:9.1e}{wall:8.2f} s  {message}", flush=True)


def dataset(results: list[dict[str, object]]) -> xr.Dataset:
    """One variable for each figure, along `case`."""
    data = xr.Dataset(coords={k: ("case", [str(r[k]) for r in results]) for k in ("family", "x", "y")})
    for name in ("outcome", "message"):
        data[name] = ("case", [str(r[name]) for r in results])
    for name, (units, meaning) in UNITS.items():
        data[name] = ("case", [float(r.get(name, np.nan)) for r in results], {"units": units, "long_name": meaning})
    return data.assign_attrs(title="Stability of the coupled solver: outcome of each scene of `make stress`")


def failures(results: list[dict[str, object]], compared: list[tuple[str, float, float]]) -> list[str]:
    """What makes the exit status 1."""
    bad = [f"{_name(r)}: {r['outcome']}: {r['message']}" for r in results if r["outcome"] in BAD]
    bad += [
        f"{_name(r)}: energy balance open by {r['energy_residual']:.1e}"
        for r in results
        if r["outcome"] in GOOD and not r.get("energy_residual", 0.0) <= BALANCE
    ]
    for name, value, bound in compared:
        verdict = "ok" if value <= bound else "TOO LARGE"
        print(f"{name:70s}{value:9.1e} <= {bound:.0e}  {verdict}")
        bad += [f"{name}: {value:.1e} > {bound:.0e}"] * (not value <= bound)
    return bad


def _name(row: dict[str, object]) -> str:
    return f"{row['family']}: {row['x']}, {row['y']}"


def comparisons(table) -> list[tuple[str, float, float]]:
    """(what, value, bound) of what one scene alone does not show."""
    rms = {name: table["mass x stiffness", name, "1"]["rms_of_rotation"] for name in ("100", "10000", "1e+06")}
    fixed = table["record", "80 s", "fixed"]["rms_of_rotation"]
    # The gap to the fixed platform falls with the stiffness until Newton's tolerance (1e-5 rad a step) hides it.
    limit = [(f"platform {k} times stiffer: rms rotation against fixed", abs(v / fixed - 1), b)
             for (k, v), b in zip(rms.items(), (1e-2, 1e-4, 1e-4), strict=True)]  # fmt: skip
    still = [(f"no wave, {p}: rotation moves by [rad]", table["no wave", p, ""]["moved"], 1e-9)
             for p in ("elastic", "fixed")]  # fmt: skip
    same = [(f"80 s twice, {p}: records differ", float(table["record", "80 s", p]["digest"]
             != table["record", "80 s, again", p]["digest"]), 0.0) for p in ("elastic", "fixed")]  # fmt: skip
    digests = {(n, p): table["restart", f"{n} times in 3 h", p]["digest"]
               for n in (0, 1, 2) for p in ("elastic", "fixed")}  # fmt: skip
    same += [(f"3 h stopped and gone on {n} times, {p}: histories differ", float(d != digests[0, p]), 0.0)
             for (n, p), d in digests.items() if n]  # fmt: skip
    orders = [(f"reference path, {x}: order {p} is off by", abs(order(table, x) - p), b)
              for x, p, b in (("trapezoidal", 2, 0.1), ("Lobatto IIIA", 4, 0.1))]  # fmt: skip
    drift = max(r.get("constraint_drift", 0.0) for k, r in table.items() if k[0] in ("record", "reference path"))
    return [*limit, *still, *same, *orders, ("constraint drift, 24 h and reference path [m]", drift, 1e-9)]


def order(table, scheme: str) -> float:
    """Order of accuracy of the reference path on the coupled scene."""
    steps = (24, 12, 6)
    error = [table["reference path", scheme, f"1/{n}"]["discretization_error"] for n in steps]
    return float(-np.polyfit(np.log(steps), np.log(error), 1)[0])


def _longest(cases: list[Case], family: str) -> int:
    """Number of the family's case with the longest and lowest waves: one that is never refused."""
    return max((float(c.x), -float(c.y), n) for n, c in enumerate(cases) if c.family == family)[2]


def main() -> int:
    """Table, dataset, map, verdict."""
    start = time.perf_counter()
    OUT.mkdir(parents=True, exist_ok=True)
    sites = geometries()
    if any(done is None for _, done in pool.run(warm, sites, [300.0] * len(sites))):
        print("boundary elements did not finish")
        return 1
    cases = matrix()
    firsts = [_longest(cases, family) for family in COMPILED]
    list(pool.run(line, firsts, [COMPILING] * len(firsts)))
    results = rows(cases)
    data = dataset(results)
    data.to_netcdf(OUT / "stress.nc", engine="netcdf4")
    picture(data, OUT / "stress.png")
    compared = comparisons({(r["family"], r["x"], r["y"]): r for r in results})
    bad = failures(results, compared)
    (OUT / "report.html").write_text(page(data, compared, bad))
    outcomes = {o: int((data.outcome == o).sum()) for o in np.unique(data.outcome.values)}
    counts = ", ".join(f"{n} {o}" for o, n in outcomes.items())
    print(f"{len(results)} scenes in {time.perf_counter() - start:.0f} s: {counts}")
    print("\n".join(bad) if bad else f"all as it should be; {OUT}/stress.nc, {OUT}/report.html")
    return 1 if bad else 0


if __name__ == "__main__":
    sys.exit(main())
