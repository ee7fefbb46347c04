"""Cycles, curves and damage: ASTM's example, closed forms of Gaussian stress, tables that meet at their knees."""

from dataclasses import replace

import numpy as np
import pytest
import rainflow
from pytest import approx
from scipy.special import gamma

from solver.errors import InputError
from solver.record import fatigue
from solver.record.sn_curves import TABLE, curve
from solver.run import simulate
from solver.scene import Fatigue, Settings
from tests.awkward import bare_legs, raking

THIN = np.array([0.02])
ENVIRONMENTS = ("air", "seawater-cp", "free-corrosion")
KNEE = {"air": 7.0, "seawater-cp": 6.0}  # n
FREE = Fatigue(environment="free-corrosion")  # one slope, m = 3


def waves_between(levels, samples=400):
    """Half a cosine from each level to the next, as a sampled stress goes."""
    rise = (1 - np.cos(np.pi * np.arange(samples) / samples)) / 2
    parts = [a + (b - a) * rise for a, b in zip(levels[:-1], levels[1:], strict=True)]
    return np.concatenate([*parts, levels[-1:]])


def test_rainflow_is_astms():
    """E1049-85, figure 6: ranges 3, 4, 6, 8, 9 in ½, 1½, ½, 1, ½ cycles."""
    size, _, count = fatigue.cycles(waves_between(np.array([-2.0, 1, -3, 5, -1, 3, -4, 4, -2])))
    found = {k: count[np.isclose(size, k, atol=1e-6)].sum() for k in (3, 4, 6, 8, 9)}
    assert found == {3: 0.5, 4: 1.5, 6: 0.5, 8: 1.0, 9: 0.5} and count.sum() == 4.0


@pytest.mark.parametrize("kind", ["noise", "walk", "steps", "walk in steps", "narrow"])
def test_cycles_taken_out_at_once_are_those_that_the_library_counts(kind):
    rng = np.random.default_rng(5)
    make = {
        "noise": lambda n: rng.normal(size=n),
        "walk": lambda n: np.cumsum(rng.normal(size=n)),
        "steps": lambda n: rng.integers(-4, 5, n).astype(float),  # many ranges are equal
        "walk in steps": lambda n: np.cumsum(rng.integers(-2, 3, n)).astype(float),
        "narrow": lambda n: np.cos(np.arange(n)) * (1 + 0.5 * np.cos(0.03 * np.arange(n))),
    }[kind]
    for n in rng.integers(10, 900, 20):
        x = make(n)
        points = fatigue.turning_points(x)
        alone = sorted(cycle[:3] for cycle in rainflow.extract_cycles(points.tolist()))
        assert sorted(zip(*fatigue.cycles(x), strict=True)) == alone


def test_a_rise_is_half_a_cycle():
    """Of two points, of which the library says nothing; and of two that are left when the cycles within are out."""
    for levels in ([0.0, 3.0], [0.0, 2.0, 1.0, 3.0]):
        size, mean, count = fatigue.cycles(waves_between(np.array(levels)))
        assert mean[np.isclose(size, 3.0, atol=1e-4)] == approx(1.5, abs=1e-4)
        assert count[np.isclose(size, 3.0, atol=1e-4)].tolist() == [0.5]


def test_extremes_lie_between_samples():
    t = np.arange(0, 60, 0.37)
    turns = fatigue.turning_points(np.sin(t))
    # Of a cosine at 17 samples a period the parabola's vertex is off by (π/17)⁴/.. < 2e-3, the samples by 2e-2.
    assert np.abs(turns[1:-1]) == approx(1.0, abs=1e-3)
    assert fatigue.turning_points(np.ones(5)).tolist() == [1.0, 1.0]
    assert fatigue.turning_points(np.array([0.0, 1, 1, 0]))[1:-1] == approx(1.0, abs=0.13)


@pytest.mark.parametrize("name", TABLE)
def test_two_slopes_meet_at_the_knee(name):
    """log a₁ = n + m₁ (log a₂ - n)/m₂; and three times shorter lives in free corrosion."""
    m1, air, protected, log_a2, free, k = TABLE[name]
    for environment, log_a1 in (("air", air), ("seawater-cp", protected)):
        n = KNEE[environment]
        assert log_a1 == approx(n + m1 * (log_a2 - n) / 5, abs=6e-4)
        line = curve(name, environment)
        above, below = line.damage(line.knee * np.array([1 + 1e-9, 1 - 1e-9]))
        assert above == approx(below, rel=1e-7)
        assert -np.log10(above) == approx(n, abs=2e-3)
    assert 0 <= k <= 0.25
    if m1 == 3:
        assert free == approx(air - np.log10(3), abs=1.5e-3)


def test_d_in_sea_water_as_the_tables_have_it():
    """100 MPa: 10^11.764/100³ cycles; 20 MPa: 10^15.606/20⁵; a plate of 50 mm as 2^0.2 times the range."""
    line = curve("D", "seawater-cp")
    assert 1 / line.damage(np.array([100e6, 20e6])) == approx([10**11.764 / 1e6, 10**15.606 / 20**5])
    assert line.thicker(np.array([0.012, 0.025, 0.05])) == approx([1, 1, 2**0.2])
    assert set(Fatigue.__annotations__) >= {"scf", "thickness", "exponent", "cycles"}
    assert all(curve(name, e).damage(np.array([50e6]))[0] > 0 for name in TABLE for e in ENVIRONMENTS)


@pytest.mark.parametrize("amplitude", [5e6, 60e6])
@pytest.mark.parametrize("how", [Fatigue(), Fatigue(curve="F3", environment="air", scf=1.7, thickness=0.04)])
def test_a_harmonic_does_damage_at_its_frequency(amplitude, how):
    """n S-N cycles of one range, either side of the knee, by samples and by its line."""
    omega, seconds = 0.9, 2 * np.pi / 0.9 * 200
    t = np.linspace(0, seconds, 200 * 100 + 1)
    line = curve(how.curve, how.environment)
    hot = 2 * how.scf * amplitude
    thick = how.thickness or THIN[0]
    exact = 3600 * omega / (2 * np.pi) * line.damage(hot * line.thicker(np.array([thick])))[0]
    by_samples = fatigue.of_samples(amplitude * np.cos(omega * t)[:, None, None], seconds, THIN, how)
    by_lines = fatigue.of_lines(np.full((1, 1, 1), amplitude * 1j), np.array([omega]), THIN, how)
    equivalent = hot * (3600 * omega / (2 * np.pi) / how.cycles) ** (1 / how.exponent)
    for damage in (by_samples, by_lines):
        assert damage.per_hour[0, 0] == approx(exact, rel=1e-3)
        assert damage.equivalent[0, 0] == approx(equivalent, rel=1e-3)


@pytest.mark.parametrize(
    ("level", "kind", "factor"),
    [
        (50e6, "base-material", 1.0),  # all of it tension
        (30e6, "base-material", 1.0),
        (0.0, "base-material", 0.8),  # from -30 to 30
        (0.0, "stress-relieved", 0.9),
        (15e6, "base-material", (45 + 0.6 * 15) / 60),
        (-15e6, "stress-relieved", (15 + 0.8 * 45) / 60),
        (-60e6, "base-material", 0.6),  # none of it tension
        (-60e6, "none", 1.0),
    ],
)
def test_ranges_in_compression_count_less_where_no_residual_stress_is(level, kind, factor):
    """f_m = (σ_t + p |σ_c|)/(σ_t + |σ_c|) of ranges of 60 MPa about a mean; by one slope, damage goes with f_m³."""
    x = level + 30e6 * np.cos(np.arange(20001) * np.pi / 50)
    how = replace(FREE, scf=1.3, mean_stress=kind)
    damage = fatigue.of_samples(x[:, None, None], 1e4, THIN, how)
    whole = fatigue.of_samples(x[:, None, None] + 1e9, 1e4, THIN, how)
    assert damage.equivalent[0, 0] == approx(factor * whole.equivalent[0, 0], rel=1e-9)
    assert damage.per_hour[0, 0] == approx(factor**3 * whole.per_hour[0, 0], rel=1e-9)


def test_a_spectrum_has_no_mean_of_a_range():
    how = Fatigue(mean_stress="base-material")
    with pytest.raises(InputError, match=r'fatigue\.mean_stress = base-material: needs method = "time"'):
        Settings(method="frequency", froude_krylov="linear", outputs=("fatigue",), fatigue=how)
    assert (
        Settings(method="frequency", froude_krylov="linear", fatigue=how).method == "frequency"
    )  # which asks for none


def gaussian(bands, seconds=20000.0, step=0.15, seed=3):
    """Samples of a Gaussian process of flat bands {(low, high) [rad/s]: std}, and its frequencies and lines."""
    n = int(seconds / step)
    omega, X = 2 * np.pi * np.fft.rfftfreq(n, step), np.zeros(n // 2 + 1, complex)
    for (low, high), std in bands.items():
        inside = (omega > low) & (omega < high)
        X[inside] = std * np.sqrt(2 / inside.sum())
    X *= np.exp(2j * np.pi * np.random.default_rng(seed).uniform(size=X.size))
    lines = X != 0
    return np.fft.irfft(X, n)[:, None, None] * n / 2, omega[lines], X[lines, None, None]


def test_narrow_band_is_rayleighs():
    """(n₀T/a)(2√2σ)ᵐ Γ(1 + m/2), m = 3, a = 10^11.687 [MPa]."""
    sigma = 20e6
    records = [gaussian({(0.97, 1.03): sigma}, 40000.0, 0.25, seed) for seed in range(8)]
    exact = 3600 / (2 * np.pi) / 10**11.687 * (2 * np.sqrt(2) * sigma / 1e6) ** 3 * gamma(2.5)
    _, omega, lines = records[0]
    assert fatigue.of_lines(lines, omega, THIN, FREE).per_hour[0, 0] == approx(exact, rel=2e-3)
    # Cycles come in 8 x 380 groups of 2π/0.06 s, and cubes of Rayleigh's ranges scatter by (6/Γ(2.5)² - 1)^½: 2.8 %.
    by_samples = [fatigue.of_samples(x, 40000.0, THIN, FREE).per_hour[0, 0] for x, _, _ in records]
    assert np.mean(by_samples) == approx(exact, rel=3 * 0.028)


@pytest.mark.parametrize("how", [FREE, Fatigue()])
@pytest.mark.parametrize(
    ("bands", "within"), [({(0.4, 2.5): 20e6}, 0.1), ({(0.3, 0.5): 15.5e6, (0.8, 2.5): 12.6e6}, 0.2)]
)
def test_wide_bands_are_dirliks(bands, within, how):
    """Against rainflow of long records: one flat band, and slow sway beside waves, which Dirlik knows less well."""
    records = [gaussian(bands, seed=seed) for seed in range(6)]
    each = [fatigue.of_samples(x, 20000.0, THIN, how) for x, _, _ in records]
    _, omega, X = records[0]
    by_lines = fatigue.of_lines(X, omega, THIN, how)
    assert by_lines.per_hour[0, 0] == approx(np.mean([d.per_hour for d in each]), rel=within)
    assert by_lines.equivalent[0, 0] == approx(np.mean([d.equivalent for d in each]), rel=within / 3)
    power = np.abs(X[:, 0, 0]) ** 2
    crossings = np.mean([fatigue.crossing_rate(x, 20000.0) for x, _, _ in records])
    assert crossings == approx(np.sqrt(power @ omega**2 / power.sum()) / (2 * np.pi), rel=0.02)


def test_ranges_of_dirlik_are_all_of_them():
    """The spread's moments: of order 0 the peaks; two parts of a range add up to the whole."""
    omega = np.linspace(0.4, 2.0, 50)
    spread = fatigue.RangeSpread.of(np.ones(50) * 1e6, omega)
    assert spread.moment(0.0, 0.0, np.inf) == approx(spread.rate)
    for m in (3.0, 5.0):
        whole = spread.moment(m, 0.0, np.inf)
        assert spread.moment(m, 0.0, 2e7) + spread.moment(m, 2e7, np.inf) == approx(whole)
        S = np.linspace(0, 40 * spread.std, 200001)
        Z, (D1, D2, D3), (Q, R) = S / (2 * spread.std), spread.share, spread.width
        p = D1 / Q * np.exp(-Z / Q) + D2 * Z / R**2 * np.exp(-((Z / R) ** 2) / 2) + D3 * Z * np.exp(-(Z**2) / 2)
        assert whole == approx(spread.rate * np.trapezoid(S**m * p, Z), rel=1e-6)


def test_ranges_of_wide_bands_are_numbers_for_any_power():
    """Dirlik's R may be below zero, of swell beside a resonance; p has its square alone."""
    omega, lines = np.array([0.35, 0.4, 0.45, 0.5, 2.8, 3.0, 3.2]), np.array([0.4, 1.0, 0.8, 0.4, 0.03, 0.05, 0.03])
    spread = fatigue.RangeSpread.of(lines * 1e6, omega)
    assert spread.width[1] < 0
    below, between, above = (spread.moment(m, 0.0, np.inf) ** (1 / m) for m in (3.0, 3.5, 4.0))
    assert below < between < above


def test_a_count_that_fails_is_not_nothing(monkeypatch):
    """NaN, and said; what has no fibre is NaN and no failure; a still stress does no damage."""
    x = np.zeros((50, 1, 4))
    x[:, 0, 0] = np.cos(np.arange(50)) * 1e7
    x[7, 0, 1] = np.inf
    x[:, 0, 3] = np.nan
    damage = fatigue.of_samples(x, 50.0, THIN, Fatigue())
    assert damage.per_hour[0, 0] > 0 == damage.per_hour[0, 2] and np.isnan(damage.per_hour[0, [1, 3]]).all()
    assert damage.failed == ((0, 1, "1 of 50 samples are not finite, in 50 s"),)
    short = fatigue.of_samples(x[:1], 0.0, THIN, Fatigue())
    assert np.isnan(short.per_hour).all() and len(short.failed) == 3
    monkeypatch.setattr(fatigue.rainflow, "extract_cycles", lambda _: 1 / 0)
    broken = fatigue.of_samples(x, 50.0, THIN, Fatigue())
    assert np.isnan(broken.per_hour).all() and len(broken.failed) == 3


def test_legs_on_both_sides_of_a_plane_of_symmetry_are_counted_once(monkeypatch):
    """Each with its own fibres' damage."""
    counted, cycles = [], fatigue.cycles
    monkeypatch.setattr(fatigue, "cycles", lambda x: counted.append(x) or cycles(x))
    item = raking(outputs=("fatigue", "fibre_stress"), keep_series=True)
    record = simulate(item)
    assert len(counted) == 2 * 8
    damage, stress = record.variables["damage"][1], record.series["fibre_stress"][1]
    each = fatigue.of_samples(stress, 60.0, np.full(3, 0.016), Fatigue()).per_hour
    assert damage == approx(each, rel=1e-5) and damage[0].tolist() != damage[1].tolist()
    assert sorted(damage[0]) == approx(sorted(damage[1]))


def test_a_record_has_the_damage_of_its_own_stress(monkeypatch):
    item, _ = bare_legs()
    outputs = ("fibre_stress", "fatigue", "leg_tops")
    settings = replace(item.settings, outputs=outputs, keep_series=True, time_step=0.15, fatigue=Fatigue(scf=3.0))
    record = simulate(replace(item, settings=settings))
    t = record.series["time"][1]
    for at in ("_top", ""):
        stress = record.series[f"fibre_stress{at}"][1]
        again = fatigue.of_samples(stress, t[-1] - t[0], np.full(3, 0.02), Fatigue(scf=3.0))
        assert record.variables[f"damage{at}"] == (("leg", "fibre"), approx(again.per_hour))
        assert record.variables[f"equivalent_range{at}"][1] == approx(again.equivalent)
    assert record.attrs["unmet"] == "" and record.attrs["fatigue"].startswith(
        "curve D, seawater-cp, DNVGL-RP-C203:2016"
    )
    rates = record.variables["fibre_stress_crossing_rate"][1]
    assert rates == approx(fatigue.crossing_rate(stress, t[-1] - t[0])) and rates.min() > 0.05
    count = fatigue.of_samples
    monkeypatch.setattr(fatigue, "of_samples", lambda x, *how: count(np.full_like(x, np.inf), *how))
    failed = simulate(replace(item, settings=replace(settings, duration=20.0)))
    assert np.isnan(failed.variables["damage"][1]).all() and np.isnan(failed.variables["damage_top"][1]).all()
    assert "leg 1, fibre 1: the count failed" in failed.attrs["unmet"] and "at the top" in failed.attrs["unmet"]


def test_lines_do_the_damage_of_a_long_march():
    """Bare legs in small waves: Dirlik beside rainflow of an hour, fibre by fibre."""
    item, _ = bare_legs()
    settings = {"outputs": ("fatigue",), "duration": 3600.0, "fatigue": Fatigue(environment="free-corrosion", scf=5.0)}
    item = replace(item, settings=replace(item.settings, froude_krylov="linear", **settings))
    march, lines = (
        simulate(replace(item, settings=replace(item.settings, method=method))).variables["damage"][1]
        for method in ("time", "frequency")
    )
    assert lines.shape == march.shape == (3, 8)
    assert lines == approx(march, rel=0.25)
