"""Why fatigue goes by the signed stress of a fixed fibre: `make life`, after the table of studies/buan-fatigue.toml.

    python -m studies.life

One realization of Buan's roughest year: upcrossings, equivalent range and damage of the worst leg's foot by its
signed fibres and by `bottom_stress`, the most compressive fibre's, |M|c/I for either sense of bending. A leg that bends
to and fro by ±A goes through 2A once a period at a fixed fibre, and through A twice in the rectified stress: with S-N
curves of slope m that does 2/2ᵐ of the damage, 1/4 to 1/16 for m of 3 to 5.
"""

from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import NamedTuple

import numpy as np

from pipeline.bridge import scenes
from pipeline.bridge.loading import load
from pipeline.tasks.task import expand
from solver.record import fatigue
from solver.run import simulate
from solver.scene import Fatigue
from studies.benchmark.case import coefficients

STUDY = Path("studies/buan-fatigue.toml")
YEAR = 365.25 * 24.0  # [h]
SEA = "2021"


class Count(NamedTuple):
    """Of one stress at the foot of the worst leg."""

    crossings: float  # [Hz]
    equivalent: float  # range [Pa]
    damage: float  # an hour


def counts(platform: str) -> tuple[Count, Count]:
    """Signed, of the worst fibre, and rectified, of the same leg."""
    wanted = {"sea_state": SEA, "platform": platform, "seed": 0}
    task = next(t for t in expand(load(STUDY).content) if all(t.labels[k] == v for k, v in wanted.items()))
    scene = scenes.scene(task.parameters)
    settings = replace(scene.settings, outputs=("fibre_stress", "fatigue"), keep_series=True)
    record = simulate(replace(scene, settings=settings), coefficients()[0] if scene.floats else None)
    time = record.series["time"][1]
    signed, rectified = record.series["fibre_stress"][1], record.series["bottom_stress"][1]
    damage = record.variables["damage"][1]
    leg, fibre = np.unravel_index(np.argmax(damage), damage.shape)
    seconds = time[-1] - time[0]
    return _count(signed[:, leg, fibre], seconds, settings.fatigue), _count(
        rectified[:, leg], seconds, settings.fatigue
    )


def _count(x: np.ndarray, seconds: float, how: Fatigue) -> Count:
    stress = x[:, None, None]
    found = fatigue.of_samples(stress, seconds, np.zeros(1), how)  # walls below 25 mm count alike
    rate = fatigue.crossing_rate(stress, seconds)
    return Count(*(float(v[0, 0]) for v in (rate, found.equivalent, found.per_hour)))


def lines() -> Iterator[str]:
    """The table."""
    yield f"signed and rectified stress at a foot, {SEA}, one hour:"
    yield f"{'':20}{'':12}{'upcrossings/s':>15}{'eq. range [MPa]':>17}{'damage a year':>15}{'share':>8}"
    for platform in ("elastic", "elastic-no-floats"):
        signed, rectified = counts(platform)
        for name, found in (("signed", signed), ("rectified", rectified)):
            share = found.damage / signed.damage
            numbers = f"{found.crossings:15.3f}{found.equivalent / 1e6:17.3f}{found.damage * YEAR:15.3g}{share:8.3f}"
            yield f"{platform:20}{name:12}{numbers}"


if __name__ == "__main__":
    for line in lines():
        print(line)
