"""The studies that come with the project: all can be planned, and one is run and held against the exact RAO."""

from pathlib import Path

import numpy as np
import pytest
import xarray as xr
from typer.testing import CliRunner

from pipeline.cli.cli import app

STUDIES = Path(__file__).parents[3] / "studies"
# Whose platform buckles, as the published one would: with its deck's weight once more as a static load.
BUAN = {"buan", "buan-dampings", "buan-fatigue", "buan-series", "paper", "storm"}


EVERY = [
    pytest.param(path, id=path.stem, marks=[pytest.mark.slow] * (path.stem == "buan-dampings"))
    for path in sorted(STUDIES.glob("*.toml"))
]


@pytest.mark.parametrize("path", EVERY)
def test_every_study_can_be_planned_without_a_warning(path, tmp_path):
    result = CliRunner().invoke(app, ["plan", str(path), "--results", str(tmp_path)])
    assert result.exit_code == 0, result.output
    assert "missing" in result.output
    told = result.output.split("warning: ")[1:]
    assert all("platform: its buckling_factor is 0.4" in text for text in told)
    assert bool(told) == (path.stem in BUAN)


@pytest.mark.usefixtures("undrawn")
def test_sphere_has_the_exact_heave_rao_in_one_run_of_white_noise(tmp_path):
    """Waves of 0.2 m leave little of the body-nonlinear pressure to be seen; 0.5 % also bears the lines' spacing."""
    study = tmp_path / "sphere-waves.toml"
    study.write_text((STUDIES / "sphere-waves.toml").read_text())
    words = ["run", str(study), "--results", str(tmp_path / "r"), "--workers", "1", "--select", "sea_state=noise"]
    assert CliRunner().invoke(app, words).exit_code == 0
    with xr.open_dataset(tmp_path / "r" / "sphere-waves" / "statistics.nc") as data:
        one = data.sel(sea_state="noise", axis="heave", float="sphere")
        omega, ratio = one.wave_frequency.values, one.rao.values * np.exp(1j * one.rao_phase.values)
    lines = (STUDIES.parent / "tests" / "published" / "oes-task10-sphere-rao.csv").read_text().splitlines()
    rows = [line.split(",") for line in lines if not line.startswith("#")]
    T, exact = np.array([[float(row[rows[0].index(name)]) for row in rows[1:]] for name in ("T", "exact_linear")])
    mine = np.abs(np.interp(2 * np.pi / T, omega, ratio.real) + 1j * np.interp(2 * np.pi / T, omega, ratio.imag))
    # At 4.4 s, on the peak, a straight line between waves 0.02 rad/s apart cuts off 0.7 %.
    away = T >= 5
    assert mine[away] == pytest.approx(exact[away], rel=5e-3)
