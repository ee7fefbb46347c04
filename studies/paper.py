"""Tables 3-7 of Heo, Koo and Kim (2022) beside ours, variants of the case, and the paper's findings: `make paper`.

    python -m studies.paper [RESULTS] [--write]

Reads the collected studies paper and buan-series, and prints Markdown; --write puts the tables into paper.md, too.
"""

import sys
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import xarray as xr

from pipeline.bridge.engine import Engine
from pipeline.bridge.loading import load
from pipeline.bridge.preflight import judge
from pipeline.report import report
from pipeline.report.published import Published, read_published
from pipeline.results import dataset
from pipeline.results.records import decode
from pipeline.study.paths import with_value
from pipeline.study.reading import StudyError
from pipeline.tasks.study import Study
from solver.errors import InputError

HERE = Path(__file__).parent
STUDY = HERE / "paper.toml"
PUBLISHED = HERE / "buan-published.csv"
PAGE = HERE / "paper.md"
STEADY = ("mean", "rms", "std")  # what few realizations settle; extremes they do not
SLOW = 0.6  # rad/s: between the sway's 0.40 and the waves' 0.70


def opened(results: Path, name: str) -> xr.Dataset:
    """The collected dataset of a study."""
    path = results / name / "statistics.nc"
    if not path.exists():
        sys.exit(f"{path}: not there yet; `make paper` makes it")
    with xr.open_dataset(path) as data:
        return data.load()


def markdown(head: list[str], rows: list[list[str]]) -> str:
    """A table: words on the left, numbers on the right."""
    rule = ["---"] + ["---:"] * (len(head) - 1)
    return "\n".join("| " + " | ".join(cells) + " |" for cells in (head, rule, *rows)) + "\n"


def tables(data: xr.Dataset, rows: list[Published]) -> Iterator[str]:
    """Each published table beside ours, with the verdict on each number."""
    for title in dict.fromkeys(row.table for row in rows):
        mine = [(row, report.ours(data, row)) for row in rows if row.table == title]
        body = []
        for row, number in mine:
            ours, spread, ratio, verdict = report.cells(row, number)
            name = f"{row.label} {row.statistic}".strip()
            body.append([f"{name} [{row.unit}]", row.text, ours, spread, ratio.rstrip(" *"), verdict])
        yield f"**{title}**\n"
        yield markdown(["", "paper", "ours", "least, largest", "ours / paper", "verdict"], body)
    yield report.verdicts(data, rows) + "\n"


def change(base: xr.Dataset, other: xr.Dataset, row: Published) -> tuple[float, float] | None:
    """Relative change of the mean over the variant's realizations, and its standard error.

    Paired by realization where both have the same sea, so that only the change scatters.
    """
    new, old = report.realizations(other, row), report.realizations(base, row)
    if new is None or old is None or not (kept := np.isfinite(new).squeeze()).any():
        return None
    new = new.squeeze().isel(seed=kept.values)
    old = old.squeeze().sel(seed=new.seed)
    first, second = (data.Hm0.min("platform").squeeze().sel(seed=new.seed).values for data in (base, other))
    same = np.allclose(first, second, rtol=1e-12)
    scatter = (new - old).std(ddof=1) if same else np.hypot(new.std(ddof=1), old.std(ddof=1))
    size = abs(float(old.mean()))
    return float((new.mean() - old.mean()) / size), float(scatter) / size / new.size**0.5


def cell(base: xr.Dataset, other: xr.Dataset, row: Published) -> str:
    """The change in percent; bold if our range, changed so, holds the published number."""
    shift = change(base, other, row)
    if shift is None:
        return ""
    share, error = shift
    text = f"{100 * share:+.1f}" + (f" ± {100 * error:.1f}" if error > 1e-3 else "")
    ours = report.ours(base, row)
    assert ours is not None
    moved = share * abs(ours.mean)
    known = Published(**{**vars(row), "value": row.value - moved})
    return f"**{text}**" if ours.verdict(known) == "inside" else text


def variants(data: xr.Dataset, rows: list[Published]) -> Iterator[str]:
    """Change of every steady number in percent by each variant: those of the floats, those of the platform."""
    base, *others = (data.isel(variant=i) for i in range(data.sizes["variant"]))
    datasets = {str(each["variant"].values): each for each in others}
    steady = [row for row in rows if row.statistic in STEADY and row.table[:7] not in ("Table 3",)]
    steady = [row for row in steady if row.statistic != "rms" or row.variable == "rotation"]
    # The rms of what has a mean of zero is its std, and that of the power follows from its mean and std.
    groups = {
        "floats": [n for n, d in datasets.items() if "elastic-no-floats" not in labels(d)],
        "platform and sea": [n for n, d in datasets.items() if "elastic-no-floats" in labels(d)],
    }
    for words, names in groups.items():
        body = []
        for row in steady:
            cells = [cell(base, datasets[name], row) for name in names]
            ours = report.ours(base, row)
            if ours is not None and any(cells):
                wanted = 100 * (row.value - ours.mean) / abs(ours.mean)
                body.append([f"{kind(row)}, {row.label} {row.statistic}", f"{wanted:+.1f}", *cells])
        yield f"**Variants of the {words}: change of our number in percent**\n"
        yield markdown(["", "to the paper", *names], body)
    for name, each in datasets.items():
        states = zip(*np.unique(each.status.values[asked(each)].astype(str), return_counts=True), strict=True)
        yield f"- `{name}`: {each.variant_title.values} ({', '.join(f'{n} {state}' for state, n in states)})"


def dry_tops(data: xr.Dataset, rows: list[Published]) -> str:
    """Every number that the floats' tops change by more than 2 %, wet and dry."""
    base, dry, body = data.isel(variant=0), data.sel(variant="dry-tops"), []
    for row in rows:
        dried, ours = report.ours(dry, row), report.ours(base, row)
        if dried is None or ours is None or abs(dried.mean / ours.mean - 1) < 0.02:
            continue
        spread = f"[{dried.low:.4g}, {dried.high:.4g}]"
        wet = f"{ours.mean:.4g} ({ours.verdict(row)})"
        body.append([f"{kind(row)}, {row.label} {row.statistic}", row.text, wet, f"{dried.mean:.4g}", spread,
                     dried.verdict(row)])  # fmt: skip
    return markdown(["", "paper", "ours, wet tops", "dry tops", "least, largest", "verdict"], body)


def kind(row: Published) -> str:
    """What the number is of, in a word or two."""
    words = {"top_displacement": "sway", "bottom_stress": "stress", "hinge_force": "force", "absorbed_power": "power"}
    return words.get(row.variable, row.variable)


def labels(data: xr.Dataset) -> list[str]:
    """Platforms of a variant."""
    mine = asked(data).any([dim for dim in data.status.dims if dim != "platform"])
    return data.platform.values[mine].astype(str).tolist()


def asked(data: xr.Dataset) -> xr.DataArray:
    """Where a variant has tasks."""
    return data.status != dataset.NO_TASK


# What the paper finds: words; then two of its numbers, the first over the second, as variable, label, statistic.
FINDINGS = (
    ("largest sway, floats / none", "top_displacement", ("two floats", "max"), ("no floats", "max")),
    ("RMS sway, floats / none", "top_displacement", ("two floats", "rms"), ("no floats", "rms")),
    ("sway, max / min", "top_displacement", ("two floats", "max"), ("two floats", "min")),
    ("peak stress, front legs, floats / none", "bottom_stress",
     ("two floats, front legs", "min"), ("no floats, front legs", "min")),
    ("RMS stress, front legs, floats / none", "bottom_stress",
     ("two floats, front legs", "rms"), ("no floats, front legs", "rms")),
    ("peak stress, rear / front legs", "bottom_stress",
     ("two floats, rear legs", "min"), ("two floats, front legs", "min")),
    *((f"{words}, {name}, elastic / fixed", variable, (f"elastic, {name}", statistic), (f"fixed, {name}", statistic))
      for words, variable, statistic in (("std rotation", "rotation", "std"), ("mean power", "absorbed_power", "mean"),
                                         ("std power", "absorbed_power", "std"))
      for name in ("front", "rear")),
    *((f"{words}, {support}, rear / front", variable, (f"{support}, rear", statistic), (f"{support}, front", statistic))
      for words, variable, statistic in (("std rotation", "rotation", "std"), ("mean power", "absorbed_power", "mean"))
      for support in ("elastic", "fixed")),
    ("std x force, rear / front", "hinge_force", ("x, rear", "std"), ("x, front", "std")),
    ("std force, front, z / x", "hinge_force", ("z, front", "std"), ("x, front", "std")),
)  # fmt: skip
# How far extremes stand out of a record: over its std.
PEAKS = (
    ("largest x force, front, over its std", "hinge_force", ("x, front", "max"), ("x, front", "std")),
    ("least x force, rear, over its std", "hinge_force", ("x, rear", "min"), ("x, rear", "std")),
    ("least z force, front, over its std", "hinge_force", ("z, front", "min"), ("z, front", "std")),
    *((f"largest over mean power, {case}", "absorbed_power", (case, "max"), (case, "mean"))
      for case in ("elastic, front", "elastic, rear", "fixed, front", "fixed, rear")),
)  # fmt: skip


def ratios(data: xr.Dataset, rows: list[Published], wanted: tuple) -> str:
    """Ratios of the paper's numbers beside ours: mean, least and largest over the realizations."""
    known = {(row.variable, row.label, row.statistic): row for row in rows}
    body = []
    for words, variable, top, bottom in wanted:
        above, below = known[variable, *top], known[variable, *bottom]
        theirs = abs(above.value / below.value)
        ours = np.abs((report.realizations(data, above) / report.realizations(data, below)).values)
        slack = theirs * sum(row.rounding / abs(row.value) for row in (above, below))
        inside = "inside" if ours.min() - slack <= theirs <= ours.max() + slack else "outside"
        body.append([words, f"{theirs:.3g}", f"{ours.mean():.4g}", f"[{ours.min():.3g}, {ours.max():.3g}]", inside])
    return markdown(["", "paper", "ours", "least, largest", "verdict"], body)


def slow_rotation(results: Path, rows: list[Published]) -> str:
    """Rotation slower than the waves: what the paper's rise with coupling needs, and what ours has."""
    data = opened(results, "buan-series")
    theirs = {row.label: row.value for row in rows if (row.variable, row.statistic) == ("rotation", "std")}
    sway = next(row.value for row in rows if row.label == "mode 1")
    body = []
    for name in ("front", "rear"):
        needed = (theirs[f"elastic, {name}"] ** 2 - theirs[f"fixed, {name}"] ** 2) ** 0.5
        ours = [below(results, data, support, name) for support in ("elastic", "fixed")]
        body.append([name, f"{needed:.3f}", f"{100e3 * (sway * needed) ** 2:.0f}", *(f"{v:.4f}" for v in ours)])
    head = ["", "paper: sqrt(elastic² - fixed²) [rad]", f"its power at {sway} rad/s [W]",
            f"ours slower than {SLOW} rad/s, elastic [rad]", "ours, fixed [rad]"]  # fmt: skip
    return markdown(head, body)


def below(results: Path, data: xr.Dataset, support: str, name: str) -> float:
    """RMS of a float's rotation as far as it is slower than the waves, without the mean [rad]."""
    task = str(data.task.sel(platform=support).squeeze().values)
    record = decode((results / "buan-series" / "tasks" / task / "record.nc").read_bytes())
    values = record["rotation_series"].values[:, record["float"].values.tolist().index(name)]
    step = np.diff(record["elapsed_time"].values[:2])[0]
    lines = np.fft.rfft(values - values.mean())
    slow = 2 * np.pi * np.fft.rfftfreq(len(values), step) < SLOW
    return float(np.sqrt(2 * np.sum(np.abs(lines[slow]) ** 2)) / len(values))


def refusal() -> str:
    """Geometric stiffness, which one study cannot hold beside the others: what the program says."""
    content = with_value(load(HERE / "buan.toml").content, "platform.geometric_stiffness", True)
    study = Study(path=STUDY, content=content)
    try:
        judge(study, study.tasks, Engine())
    except (InputError, StudyError) as error:
        reason = str(error).removeprefix(f"{study.path}: ")
        return f"- `geometric`, Legs that their weight bends further (geometric stiffness): refused; {reason}"
    sys.exit("geometric stiffness is no longer refused: make it one of the variants")


def sections(results: Path) -> dict[str, str]:
    """What studies/paper.md quotes, by the names of its marks."""
    data, rows = opened(results, STUDY.stem), read_published(PUBLISHED)
    base = data.isel(variant=0)
    return {
        "tables": "\n".join(tables(base, rows)),
        "variants": "\n".join([*variants(data, rows), refusal()]),
        "dry tops": "**Floats whose tops stay dry**\n\n" + dry_tops(data, rows),
        "findings": "**What the paper finds, as ratios**\n\n" + ratios(base, rows, FINDINGS),
        "peaks": "**How far extremes stand out**\n\n" + ratios(base, rows, PEAKS),
        "slow rotation": "**Slow rotation**\n\n" + slow_rotation(results, rows),
    }


def renewed(page: str, text_of: dict[str, str]) -> str:
    """A page with other text between its marks <!-- name --> and <!-- /name -->."""
    for name, text in text_of.items():
        before, rest = page.split(f"<!-- {name} -->\n", 1)
        _, after = rest.split(f"<!-- /{name} -->", 1)
        page = f"{before}<!-- {name} -->\n{text.strip()}\n<!-- /{name} -->{after}"
    return page


def main(arguments: list[str]) -> None:
    """Print everything that studies/paper.md quotes; with --write renew its tables, and the prose is for a reader."""
    words = [word for word in arguments if word != "--write"]
    text_of = sections(Path(words[0] if words else "results"))
    print(*text_of.values(), sep="\n\n")
    if "--write" in arguments:
        PAGE.write_text(renewed(PAGE.read_text(), text_of))


if __name__ == "__main__":
    main(sys.argv[1:])
