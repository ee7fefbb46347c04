"""The radiation memory: recovery of known kernels, passivity, causality, and the memory of a hemisphere."""

from pathlib import Path

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st
from scipy.integrate import quad_vec

from solver.errors import InputError, SimulationFailed
from solver.hydrodynamics.radiation import passivity, rational
from solver.hydrodynamics.radiation.fitting import fit, samples
from solver.hydrodynamics.radiation.memory import RadiationMemory, retardation, transfer
from solver.hydrodynamics.radiation.passivity import Constraint, enforce
from solver.hydrodynamics.radiation.rational import (
    basis,
    complex_residues,
    ever_more_poles,
    mixed,
    relocated,
    starting_poles,
)

REFERENCE = Path(__file__).parents[2] / "published"
OMEGA = np.linspace(0.2, 8.0, 50)
EVERYWHERE = np.concatenate([[0.0], np.geomspace(1e-4, 1e4, 4001)])


def known():
    """K = S1 e^{-t} (cos 2t - sin 2t / 2) + S2 ...: H(0) = 0, Re H = positive x ω² for each pair a.

    s/((s - a)(s - a*)) has the real part 2|Re a| ω² / |..|² >= 0 and the residue a/(a - a*) at a.
    """
    beta = np.array([-1.0 + 2.0j, -0.4 + 3.5j])
    weights = np.array([[[2.0, 0.5], [0.5, 1.0]], [[1.0, -0.7], [-0.7, 0.8]]])
    residue = (2 * beta / (beta - beta.conj()))[:, None, None] * weights
    return RadiationMemory(beta=beta, residue=residue, added_mass_inf=np.diag([3.0, 2.0]), error=0.0)


def coefficients(memory, omega):
    """A and B that a memory stands for: Y = B - iω(A - A∞)."""
    y = memory.frequency(omega)
    return memory.added_mass_inf - y.imag / omega[:, None, None], y.real


def least_damping(memory):
    """The least eigenvalue of B at any frequency, as a share of the largest."""
    values = np.linalg.eigvalsh(memory.frequency(EVERYWHERE).real)
    return values.min() / values.max()


def rounding(memory, omega):
    """What is left of Y where its terms cancel (nw,): some bits of |r| |1/(s - β)|, each a norm over all poles.

    Not of the terms' sum: residues with Y(0) = 0 are right to the last bit of the largest among them.
    """
    s = -1j * omega[:, None]
    poles = np.concatenate([1 / (s - memory.beta), 1 / (s - memory.beta.conj())], axis=1)
    return 16 * np.finfo(float).eps * np.linalg.norm(memory.residue) * np.linalg.norm(poles, axis=1)


def is_passive(memory):
    """No eigenvalue of B below zero at any frequency, but for rounding."""
    return np.all(np.linalg.eigvalsh(memory.frequency(EVERYWHERE).real)[:, 0] > -rounding(memory, EVERYWHERE))


def hulme():
    path = REFERENCE / "hulme-1982-hemisphere.csv"
    Ka, A, B, *_ = np.loadtxt(path, delimiter=",", skiprows=4).T
    omega = np.sqrt(9.81 * Ka)  # a = 1 m, mass in units of the displaced
    return omega, A[:, None, None], (B * omega)[:, None, None], np.array([[0.5]])


def test_frequency_is_the_transform_of_the_impulse():
    memory = known()
    omega = np.array([0.0, 1.3, 4.0])

    def integrand(t):
        return memory.impulse(np.array([t])) * np.exp(1j * omega * t)[:, None, None]

    value, _ = quad_vec(integrand, 0, 60)  # the slowest pole has decayed to e^-24
    assert memory.frequency(omega) == pytest.approx(value, abs=1e-7)


def test_a_known_kernel_is_recovered_exactly():
    memory = known()
    fitted = fit(OMEGA, *coefficients(memory, OMEGA), memory.added_mass_inf, 1e-6)
    assert len(fitted.beta) == 2
    # A margin of 1e-7 keeps the damping from being negative where that of the kernel is just zero.
    assert np.sort_complex(fitted.beta) == pytest.approx(np.sort_complex(memory.beta), rel=1e-6)
    t = np.linspace(0, 10, 50)
    assert fitted.impulse(t) == pytest.approx(memory.impulse(t), abs=1e-5)
    assert fitted.added_mass_inf == pytest.approx(memory.added_mass_inf, abs=1e-5)


def test_a_small_body_beside_a_large_one_is_remembered():
    """Of a hundredth of its length: it radiates a millionth, and what reaches it a thousandth, of the large one's."""
    memory, small = known(), np.diag([1.0, 1e-3])
    A, B = (small @ part @ small for part in coefficients(memory, OMEGA))
    fitted = fit(OMEGA, A, B, small @ memory.added_mass_inf @ small, 1e-6, body=np.arange(2))
    t = np.linspace(0, 10, 50)
    back = np.linalg.inv(small)
    assert back @ fitted.impulse(t) @ back == pytest.approx(memory.impulse(t), abs=1e-5)


@pytest.mark.parametrize("moved", [[True, True], [False, True], [True, False]])
def test_what_radiates_little_for_certain_is_remembered(moved):
    """Of one body: a motion with a millionth of the other's is fitted as closely, or what it gets of that."""
    memory, small, t = known(), np.diag([1.0, 1e-3]), np.linspace(0, 10, 50)
    A, B = (small @ part @ small for part in coefficients(memory, OMEGA))
    given = OMEGA, A, B, small @ memory.added_mass_inf @ small, 1e-6
    fitted = fit(*given, moved=moved, certain=np.array([False, True])).impulse(t) / np.outer([1, 1e-3], [1, 1e-3])
    unsure = fit(*given, moved=moved).impulse(t)
    exact = memory.impulse(t)
    together = np.ix_(range(len(t)), *2 * [np.flatnonzero(moved)])
    assert fitted[together] == pytest.approx(exact[together], abs=1e-5)
    assert not unsure[:, 1].any() and not unsure[:, :, 1].any()


def test_what_radiates_is_told_beside_its_own_body_or_all_that_move():
    """Heave of a slender spar is next to nothing beside its surge, of which there is none, but not beside a float's."""
    size, lengths, body = np.array([1.0, 900.0, 0.5, 1e-4]), np.ones(4), np.array([0, 1, 1, 0])
    assert passivity.radiates(size, lengths, body).tolist() == [True, True, False, False]
    moved = np.array([True, False, True, True])
    assert passivity.radiates(size, lengths, body, moved).tolist() == [True, True, True, False]
    assert passivity.radiates(size, np.array([1.0, 1.0, 1.0, 0.1]), body, moved).all()


def test_a_frequency_at_which_the_data_are_nonsense_is_left_out():
    memory = known()
    A, B = coefficients(memory, OMEGA)
    A[7], B[7] = A[7] + 30 * np.eye(2), B[7] - 90 * OMEGA[7] * np.eye(2)
    fitted = fit(OMEGA, A, B, memory.added_mass_inf, 1e-6)
    t = np.linspace(0, 10, 50)
    assert fitted.impulse(t) == pytest.approx(memory.impulse(t), abs=1e-5)


def test_data_that_no_passive_body_has_are_refused(monkeypatch):
    memory = known()
    A, B = coefficients(memory, OMEGA)
    with pytest.raises(SimulationFailed, match=rf"takes power .* at {OMEGA.size} of {OMEGA.size} frequencies"):
        fit(OMEGA, A, B - 9 * OMEGA[:, None, None] * np.eye(2), memory.added_mass_inf, 1e-3)
    monkeypatch.setattr("solver.hydrodynamics.radiation.fitting.LOST", 1e-12)
    with pytest.raises(
        SimulationFailed, match=r"no passive fit .* in a gap .* solver\.gap_damping and gap_width damp it"
    ):
        fit(*hulme(), 1e-13)


@pytest.mark.slow
def test_to_ask_for_more_than_the_data_hold_gives_no_less():
    """Of poles that follow the noise no residues are passive; then those of a looser fit are taken."""
    memory, dice = known(), np.random.default_rng(0)
    added_mass, damping = coefficients(memory, OMEGA)
    noise = dice.normal(size=damping.shape)
    noisy = damping + 0.015 * np.abs(damping).max() * (noise + np.swapaxes(noise, 1, 2))
    errors = [fit(OMEGA, added_mass, noisy, memory.added_mass_inf, tolerance).error for tolerance in (1e-2, 1e-3)]
    assert 1e-3 < errors[1] < 1.2 * errors[0]


def test_a_motion_that_hardly_radiates_is_not_judged():
    """Mesh error of the second, by itself, would look as much against passivity as the first for it."""
    impedance = 1j * np.array([np.diag([1.0, -1e-9]), np.diag([0.5, 1e-9])])
    assert passivity.least_damping(impedance, np.ones(2), np.zeros(2, int)) == pytest.approx([1.0, 0.5])
    assert passivity.least_damping(impedance, np.array([1.0, 1e-4]), np.zeros(2, int)) == pytest.approx([-1.0, 0.5])
    assert passivity.least_damping(impedance, np.ones(2), np.arange(2)) == pytest.approx([-1.0, 0.5])
    assert passivity.least_damping(impedance[:, :1, :1] + 3, np.ones(1), np.zeros(1, int)) == pytest.approx(
        [1 / 10**0.5, 0.5 / 10**0.5]
    )


def test_units_do_not_matter():
    memory = known()
    A, B = coefficients(memory, OMEGA)
    big = fit(10 * OMEGA, 1e6 * A, 1e7 * B, 1e6 * memory.added_mass_inf, 1e-3)
    small = fit(OMEGA, A, B, memory.added_mass_inf, 1e-3)
    t = np.linspace(0, 5, 20)
    assert big.impulse(t / 10) == pytest.approx(1e8 * small.impulse(t), abs=1e-6 * 1e8 * np.abs(small.impulse(t)).max())


@settings(max_examples=2)
@given(st.integers(0, 10_000), st.just(1), st.floats(0.0, 0.05))
@example(0, 1, 1 / 64)  # terms that cancel at ω = 0 are far larger than B
@example(3723, 2, 0.015407671804895032)  # with some roundings both eigenvalues agree at two neighbours of the grid
@example(571, 1, 0.04549123253190537)  # no lift does, which the dual finds without any residual
def test_the_fit_is_passive_even_if_the_data_are_not_quite(seed, n, spoil):
    passive_though_spoilt(seed, n, spoil)


@pytest.mark.slow
@settings(max_examples=20)
@given(st.integers(0, 10_000), st.integers(1, 3), st.floats(0.0, 0.05))
@example(7977, 3, 0.05)
def test_fits_of_several_motions_are_passive(seed, n, spoil):
    passive_though_spoilt(seed, n, spoil)


def passive_though_spoilt(seed, n, spoil):
    # Sums of passive pairs, spoilt by a share that makes the damping negative somewhere, also near ω = 0.
    random = np.random.default_rng(seed)
    beta = -random.uniform(0.1, 1.5, 3) + 1j * random.uniform(0.5, 6.0, 3)
    root = random.normal(size=(3, n, n))
    weights = root @ np.swapaxes(root, 1, 2) + spoil * (root + np.swapaxes(root, 1, 2))
    turned = np.exp(1j * spoil * random.normal(size=3))
    residue = (2 * beta / (beta - beta.conj()) * turned)[:, None, None] * weights
    data = RadiationMemory(beta=beta, residue=residue, added_mass_inf=np.eye(n), error=0.0)
    fitted = fit(OMEGA, *coefficients(data, OMEGA), data.added_mass_inf, 1e-2)
    assert is_passive(fitted)
    assert np.all(fitted.beta.real < 0)
    assert fitted.residue == pytest.approx(np.swapaxes(fitted.residue, 1, 2))
    zero = np.zeros(1)
    assert np.abs(fitted.frequency(zero)).max() < rounding(fitted, zero)[0]


def test_enforcement_repairs_what_least_squares_leaves():
    # One pair of poles, a target with negative damping on both sides of the resonance.
    poles = np.array([-0.3 + 2.0j, -1.0 + 1.0j])
    span = np.linalg.svd(basis(poles, np.zeros(1)).real)[2][1:].T
    columns = basis(poles, OMEGA) @ span
    target = (1 / (1j * OMEGA - poles[0]) + 1 / (1j * OMEGA - poles[0].conj()))[:, None] * 1j
    stacked = np.vstack([columns.real, columns.imag]), np.vstack([target.real, target.imag])
    free = np.linalg.lstsq(*stacked, rcond=None)[0]
    constraint = Constraint(poles=poles, span=span, n=1)
    bound = enforce(*stacked, constraint, lambda x: float(np.linalg.norm(stacked[0] @ x - stacked[1])))

    def memory(x):
        r = complex_residues(poles, span @ x)[:, :, None]
        return RadiationMemory(beta=poles, residue=r, added_mass_inf=np.eye(1), error=0.0)

    assert least_damping(memory(free)) < -0.1
    assert is_passive(memory(bound))
    # Nothing nearer on the way back to the free solution is passive: the constraint is active.
    assert not is_passive(memory(bound + 0.01 * (free - bound)))


def test_passive_data_are_left_alone():
    memory = known()
    fitted = fit(OMEGA, *coefficients(memory, OMEGA), memory.added_mass_inf, 1e-4)
    assert fitted.error < 1e-6


def test_added_mass_follows_from_the_impulse():
    # Kramers-Kronig, Ogilvie: A(ω) = A∞ - 1/ω ∫ K sin ωt dt, with the kernel of the damping alone.
    omega, A, B, infinite = hulme()
    t = np.linspace(0, 40, 8001)
    kernel = retardation(omega, B, t)[:, 0, 0]
    for w, a in zip(omega[5:20], A[5:20, 0, 0], strict=True):
        ogilvie = infinite[0, 0] - np.trapezoid(kernel * np.sin(w * t), t) / w
        # Data in four digits at 26 frequencies, and a tail that is extrapolated: 0.5 % of A'(0).
        assert ogilvie == pytest.approx(a, abs=0.005 * 0.831)


def test_hemisphere_heave_kernel():
    omega, A, B, infinite = hulme()
    memory = fit(omega, A, B, infinite, 1e-3)
    assert memory.error <= 1e-3 and len(memory.beta) <= 7
    assert is_passive(memory)
    # Seen through -iωA alone, next to fast poles: 1e-3 of Y at its peak.
    assert memory.added_mass_inf == pytest.approx(infinite, abs=1e-3)
    t = np.linspace(0, 10, 200)
    direct = retardation(omega, B, t)[:, 0, 0]
    # The first half second is what lies beyond the peak: there misfits count less, and four digits
    # of B do not say how much of K(0) = 2/π ∫ B lies beyond Ka = 9 (2 %).
    share = np.abs(memory.impulse(t)[:, 0, 0] - direct) / direct[0]
    assert share.max() < 0.025 and share[t > 0.6].max() < 0.008


def test_two_floats_to_a_thousandth(coefficients):
    """Reflections between the Buan floats: one part in 200 with 10 pairs of poles, in 1,000 with 15."""
    h = coefficients
    for tolerance, poles in ((5e-3, 10), (1e-3, 15)):
        memory = fit(h.omega, h.added_mass, h.radiation_damping, h.added_mass_inf, tolerance)
        assert memory.error <= tolerance and len(memory.beta) <= poles
        assert is_passive(memory)
        share = 1 / (1 + (h.omega / 3.4) ** 6)  # of a misfit that counts; the diagonal peaks near 3.4 rad/s
        y = h.radiation_damping - 1j * h.omega[:, None, None] * (h.added_mass - memory.added_mass_inf)
        misfit = share[:, None, None] * np.abs(memory.frequency(h.omega) - y)
        # Against the largest of all entries, which is not less than that of the two motions of the entry.
        assert misfit.max() < 1.2 * tolerance * np.abs(y).max()


def test_retardation_of_a_closed_form():
    # B = ω² e^{-ω²}: K = 2/π · √π/8 (2 - t²) e^{-t²/4}; nothing is left at the grid's end.
    omega, t = np.linspace(0.05, 7, 140), np.linspace(0, 8, 33)
    exact = 2 / np.pi * np.sqrt(np.pi) / 8 * (2 - t**2) * np.exp(-(t**2) / 4)
    # Splines of a grid of 0.05 rad/s, and 4,000 linear pieces: 1e-6 of the largest.
    assert retardation(omega, omega**2 * np.exp(-(omega**2)), t) == pytest.approx(exact, abs=2e-6 * exact[0])


@pytest.mark.parametrize(
    ("power", "end", "kernel"),
    [(2, 20.0, lambda t: (1 - t) * np.exp(-t) / 2), (3, 8.0, lambda t: (1 + t - t**2) * np.exp(-t) / 8)],
)
def test_retardation_carries_the_tail(power, end, kernel):
    """B = ω² / (1 + ω²)ⁿ: tails as ω^-2 and ω^-4, of which 3 % and 0.3 % of K(0) lie beyond the grid."""
    omega, t = np.linspace(0.1, end, 200), np.linspace(0, 6, 13)
    numeric, exact = retardation(omega, omega**2 / (1 + omega**2) ** power, t), kernel(t)
    # What is left is how far the last quarter of the grid is from a pure power: a thirtieth of the tail, a tenth.
    assert numeric == pytest.approx(exact, abs={2: 1e-3, 3: 3e-4}[power] * exact[0])


def test_retardation_of_a_few_frequencies():
    """With the tail of the last two; one has none."""
    for n in (2, 3, 4):
        omega = np.linspace(0.5, 2.0, n)
        assert np.all(np.isfinite(retardation(omega, omega**2, np.linspace(0, 6, 13))))
    with pytest.raises(InputError, match=r"omega .* two frequencies at least"):
        retardation(np.ones(1), np.ones(1), np.zeros(1))


def test_the_transfer_of_a_kernel_by_damping_alone():
    """K = (1 - t) exp(-t)/2 of B = ω²/(1 + ω²)²: Y = -½iω/(1 - iω)²; between, at and below the close points."""
    omega = np.linspace(0.1, 60, 600)
    at = np.array([1e-3, 0.3, 1.0, 60 * 40 / 4000, 2.7, 8.0])
    exact = -0.5j * at / (1 - 1j * at) ** 2
    assert transfer(omega, omega**2 / (1 + omega**2) ** 2, at) == pytest.approx(exact, abs=1e-3 * np.abs(exact).max())


def test_a_motion_that_radiates_nothing_has_no_memory():
    memory = known()
    A, B = coefficients(memory, OMEGA)
    noise = 1e-4 * np.random.default_rng(1).normal(size=OMEGA.size)
    A3, B3, infinite = np.zeros((50, 3, 3)), np.zeros((50, 3, 3)), np.zeros((3, 3))
    A3[:, :2, :2], B3[:, :2, :2], infinite[:2, :2] = A, B, memory.added_mass_inf
    A3[:, 2, 2] = B3[:, 2, 2] = noise
    fitted = fit(OMEGA, A3, B3, infinite, 1e-4)
    assert len(fitted.beta) == 2
    assert np.abs(fitted.residue[:, 2]).max() < 1e-4 * np.abs(fitted.residue).max()


def test_motions_that_no_body_has_are_not_fitted():
    """The third takes power from the waves that it radiates."""
    memory = known()
    A, B = np.zeros((50, 3, 3)), np.zeros((50, 3, 3))
    A[:, :2, :2], B[:, :2, :2] = coefficients(memory, OMEGA)
    A[:, 2, 2], B[:, 2, 2] = 1.0, -9 * OMEGA
    infinite = np.diag([3.0, 2.0, 7.0])
    fitted = fit(OMEGA, A, B, infinite, 1e-6, moved=np.array([True, True, False]))
    alone = fit(OMEGA, A[:, :2, :2], B[:, :2, :2], infinite[:2, :2], 1e-6)
    assert fitted.beta == pytest.approx(alone.beta, rel=1e-9) and len(alone.beta) == 2
    assert fitted.residue[:, :2, :2] == pytest.approx(alone.residue, rel=1e-6, abs=1e-9)
    assert not np.abs(fitted.residue[:, 2, 2]).any() and fitted.added_mass_inf[2, 2] == 7.0
    with pytest.raises(SimulationFailed, match="takes power"):
        fit(OMEGA, A, B, infinite, 1e-6)


def test_what_a_motion_does_to_those_that_there_are_not_is_fitted_beside():
    """The load on a guide: its row is that of the whole memory, and its own motion has none."""
    memory = known()
    A, B = coefficients(memory, OMEGA)
    fitted = fit(OMEGA, A, B, memory.added_mass_inf, 1e-6, moved=np.array([True, False]))
    t = np.linspace(0, 10, 50)
    assert fitted.impulse(t)[:, :, 0] == pytest.approx(memory.impulse(t)[:, :, 0], abs=1e-5)
    assert fitted.residue == pytest.approx(np.swapaxes(fitted.residue, 1, 2))
    assert not fitted.residue[:, 1, 1].any()
    assert fitted.added_mass_inf == pytest.approx(memory.added_mass_inf, abs=1e-5)


def test_bodies_at_rest_have_no_memory():
    A, B = coefficients(known(), OMEGA)
    still = fit(OMEGA, A, B, np.eye(2), 1e-3, moved=np.zeros(2, bool))
    assert still.beta.size == 0 and still.error == 0 and not still.frequency(OMEGA).any()
    assert still.added_mass_inf == pytest.approx(np.eye(2))


@pytest.mark.parametrize("tolerance", [0, 1, np.nan])
def test_a_tolerance_must_be_between_0_and_1(tolerance):
    memory = known()
    with pytest.raises(InputError, match=f"memory_tolerance = {tolerance}: must be between 0 and 1"):
        fit(OMEGA, *coefficients(memory, OMEGA), memory.added_mass_inf, tolerance)


def test_too_few_frequencies_for_a_memory_are_told_so():
    memory = known()
    with pytest.raises(SimulationFailed, match="3 frequencies that tell anything are too few"):
        fit(OMEGA[:3], *coefficients(memory, OMEGA[:3]), memory.added_mass_inf)


def many(n, pairs, rank, noise):
    """A memory of n motions with weights of low rank, as few waves radiate, and its coefficients with mesh error."""
    random = np.random.default_rng(n)
    beta = -random.uniform(0.1, 0.8, pairs) + 1j * np.linspace(0.8, 6.0, pairs)
    root = random.normal(size=(pairs, n, rank))
    residue = (2 * beta / (beta - beta.conj()))[:, None, None] * (root @ np.swapaxes(root, 1, 2))
    memory = RadiationMemory(beta=beta, residue=residue, added_mass_inf=np.eye(n), error=0.0)
    A, B = coefficients(memory, OMEGA)
    size = np.sqrt(np.einsum("wii->wi", B).max(axis=0))
    error = noise * np.multiply.outer(size, size) * random.normal(size=B.shape)
    return memory, A, B + (error + np.swapaxes(error, 1, 2)) / 2


def test_many_motions_have_the_poles_that_there_are():
    """Of 16 motions 13 lead to nothing at each pole: without a constraint mesh error has them take power."""
    memory, A, B = many(16, 5, 3, 1e-3)
    assert np.linalg.eigvalsh(B)[:, 0].min() < 0
    fitted = fit(OMEGA, A, B, memory.added_mass_inf, 1e-2)
    assert len(fitted.beta) == 5 and fitted.error < 1e-2
    assert np.sort_complex(fitted.beta) == pytest.approx(np.sort_complex(memory.beta), rel=2e-2)
    assert is_passive(fitted)
    y, moved = memory.frequency(OMEGA), OMEGA[:, None, None] * (fitted.added_mass_inf - memory.added_mass_inf)
    own = np.abs(np.einsum("wii->wi", y))
    share = 1 / (1 + (OMEGA / OMEGA[own.sum(axis=1).argmax()]) ** 6)  # of a misfit that counts
    size = np.sqrt(own.max(axis=0))
    apart = np.abs(fitted.frequency(OMEGA) - 1j * moved - y) / np.multiply.outer(size, size)
    assert (share[:, None, None] * apart).max() < 1e-2


def test_a_lift_ends_what_cuts_have_not(monkeypatch):
    """With one round of cuts the fit is passive as well, and not much farther off."""
    memory, A, B = many(12, 3, 2, 3e-3)
    whole = fit(OMEGA, A, B, memory.added_mass_inf, 2e-2)
    monkeypatch.setattr(passivity, "ROUNDS", 1)
    lifted = fit(OMEGA, A, B, memory.added_mass_inf, 2e-2)
    assert is_passive(whole) and is_passive(lifted)
    assert whole.error < lifted.error < 2e-2


def test_what_radiates_next_to_nothing_has_no_memory():
    """As a cylinder that only turns about itself: its coefficients are the mesh's noise, which no memory fits."""
    exact, noise = known(), np.random.default_rng(3).normal(size=OMEGA.size)
    y = exact.frequency(OMEGA)
    A, B = exact.added_mass_inf - y.imag / OMEGA[:, None, None], y.real
    for quiet, poles in ((1e-4 * noise, False), (B[:, 1, 1], True)):
        A_, B_ = A.copy(), B.copy()
        B_[:, 1, 1] = np.abs(quiet)
        if not poles:
            A_[:, 1, 1] = exact.added_mass_inf[1, 1]
            A_[:, 0, 1] = A_[:, 1, 0] = B_[:, 0, 1] = B_[:, 1, 0] = 0.0
        memory = fit(OMEGA, A_, B_, exact.added_mass_inf, moved=np.array([False, True]))
        assert bool(memory.beta.size) == poles


def test_mixed_entries_give_the_same_poles():
    """Vector fitting cannot tell 200 entries at 50 frequencies from as many sums of them as there are numbers; nor to a
    misfit from those of them that can make one."""
    _, A, B = many(20, 4, 3, 1e-3)
    i, j = np.triu_indices(20)
    samples = (B + 1j * OMEGA[:, None, None] * (A - np.eye(20)))[:, i, j]
    few, fewer, start = mixed(samples, 0.0), mixed(samples, 1e-3), starting_poles(OMEGA, 6)
    rank = np.linalg.matrix_rank(np.vstack([samples.real, samples.imag]))
    assert few.shape == (50, rank) and rank < 60 and mixed(few[:, 1:], 1.0).shape == (50, rank - 1)
    twice = mixed(np.hstack([few[:, :20], 0 * few[:, :2], few[:, :20] @ np.ones((20, 3))]), 1.0)
    assert twice.shape == (50, 20)
    assert 2 < fewer.shape[1] < 60
    weight = 1 / (1 + OMEGA)
    one, other, near = (np.sort_complex(relocated(start, OMEGA, x, weight)) for x in (samples, few, fewer))
    assert other == pytest.approx(one, rel=1e-9)
    assert near == pytest.approx(one, rel=1e-2)


@pytest.mark.parametrize("alike", [False, True])
def test_cuts_that_push_and_those_that_do_not(alike):
    """Against non-negative least squares of the same problem; with each cut there twice as well."""
    random = np.random.default_rng(5)
    c, lack = random.normal(size=(30, 40)), random.normal(size=30)
    shortest = passivity._least_distance(c, lack)
    if alike:
        c, lack = np.vstack([c, c]), np.concatenate([lack, lack])
    push = passivity._complementary(c @ c.T, lack, np.ones(lack.size, bool))
    assert np.all(push >= 0) and np.any(push == 0)
    assert c.T @ push == pytest.approx(shortest, abs=1e-7)


def test_misfits_count_by_their_importance():
    """Far below the peak a share of the largest damping is much of the little there is; unless that is asked for."""
    omega, A, B, infinite = hulme()
    low = (omega < 0.5 * omega[B[:, 0, 0].argmax()])[:, None, None]

    def relative(memory):
        fitted = memory.frequency(omega) - 1j * omega[:, None, None] * memory.added_mass_inf
        return np.max(np.abs(fitted - B + 1j * omega[:, None, None] * A) / B, where=low, initial=0.0)

    plain = fit(omega, A, B, infinite, 0.02)
    counting = samples(omega, A, B, infinite).counting(np.where(low, 10 / B, 0.0))
    asked = counting.with_poles(plain.beta)
    assert is_passive(asked) and asked.beta is plain.beta
    assert relative(plain) > 0.04 and relative(asked) < 0.5 * relative(plain)
    off = asked.frequency(omega) - 1j * omega[:, None, None] * asked.added_mass_inf - B + 1j * omega[:, None, None] * A
    size = np.abs(B - 1j * omega[:, None, None] * (A - infinite))
    falls = 1 / (1 + (omega / omega[size[:, 0, 0].argmax()]) ** 6)
    assert asked.error == pytest.approx((falls * np.abs(off)[:, 0, 0]).max() / size.max())  # its share, as before
    assert 10 * np.abs(off / B).max(where=low, initial=0.0) > 1.2 * asked.error


def test_where_misfits_count_the_same_as_ever_so_do_fits():
    omega, A, B, infinite = hulme()
    plain, known = fit(omega, A, B, infinite, 0.02), samples(omega, A, B, infinite)
    again, little = known.with_poles(plain.beta), known.counting(np.full(A.shape, 1e-12)).with_poles(plain.beta)
    assert again.error <= plain.error * (1 + 1e-9)
    assert np.array_equal(little.residue, again.residue)
    assert samples(omega, A, 0 * B, 0 * infinite, moved=np.zeros(1, bool)) is None


def test_added_mass_is_held_as_hard_as_is_asked():
    """Of coefficients whose A∞ is a tenth too large: fitted along it comes back, held it stays, and the rest misses."""
    memory = known()
    A, B = coefficients(memory, OMEGA)
    given = 1.1 * memory.added_mass_inf
    loose, *harder = (samples(OMEGA, A, B, given, hold=hold).with_poles(memory.beta) for hold in (0.5, 50.0, 5e3))
    off = [np.abs(one.added_mass_inf - given).max() / np.abs(given).max() for one in (loose, *harder)]
    assert off[0] > 0.05 and off[0] > 10 * off[1] > 100 * off[2]
    assert all(is_passive(one) for one in (loose, *harder))


def test_no_poles_are_sought_where_frequencies_are_too_far_apart():
    """What ripples there, aliased, does not spoil the rest."""
    exact, resolved = known(), OMEGA < 5.0
    ripple = np.where(resolved, 0.0, 0.3 * np.cos(7.0 * np.arange(OMEGA.size)))[:, None, None]
    y = exact.frequency(OMEGA) * (1 + ripple)
    A, B = exact.added_mass_inf - y.imag / OMEGA[:, None, None], y.real
    told, untold = (fit(OMEGA, A, B, exact.added_mass_inf, 1e-3, resolved=mask) for mask in (resolved, None))
    inside = np.linspace(0.2, 5.0, 97)
    true = exact.frequency(inside)

    def off(memory):
        Y = memory.frequency(inside) - 1j * inside[:, None, None] * (memory.added_mass_inf - exact.added_mass_inf)
        return np.abs(Y - true).max() / np.abs(true).max()

    assert is_passive(told)
    assert np.sort_complex(told.beta) == pytest.approx(np.sort_complex(exact.beta), rel=1e-4)
    assert untold.beta.size > told.beta.size
    assert off(told) < 0.4 * off(untold)


def test_as_few_poles_are_found_as_there_are():
    rng, beta = np.random.default_rng(1), np.array([-0.05 + 1.1j, -0.4 + 2.0j, -0.2 + 5.0j])
    shares = rng.normal(size=(6, 9))
    samples = basis(beta, OMEGA) @ shares + 1j * OMEGA[:, None] * rng.normal(size=9)
    spoiled = samples + 1e-6 * rng.normal(size=samples.shape)
    none, *_, found = ever_more_poles(OMEGA, spoiled, 1e-3, 20)
    assert none.size == 0
    assert np.sort_complex(found) == pytest.approx(np.sort_complex(beta), rel=1e-4)
    assert [poles.size <= 4 for poles in ever_more_poles(OMEGA, spoiled, 1e-3, 2)] == [True, True]
    assert [poles.size for poles in ever_more_poles(OMEGA, spoiled, 1e-3, 0)] == [0]
    assert [poles.size for poles in ever_more_poles(OMEGA, samples[:, :0], 1e-3, 0)] == [0]


def test_what_turns_often_is_not_tried_with_fewer_poles_than_turns(monkeypatch):
    """A wave that comes back late, of a share that counts; or of one that does not."""
    tried, start = [], rational.starting_poles
    monkeypatch.setattr(rational, "starting_poles", lambda omega, pairs: tried.append(pairs) or start(omega, pairs))
    omega, turns = np.linspace(0.5, 2.0, 120), 18.0
    late = turns * 2 * np.pi / 1.5
    for share, most in ((0.1, 80), (1e-9, 10)):
        tried.clear()
        samples = (1 + share * np.exp(-1j * omega * late))[:, None] / (1j * omega + 0.5)[:, None]
        *_, found = ever_more_poles(omega, samples, 1e-3, most, turns)
        columns = np.column_stack([basis(found, omega), 1j * omega])
        both = np.vstack([columns.real, columns.imag])
        target = np.vstack([samples.real, samples.imag])
        assert np.abs(both @ np.linalg.lstsq(both, target)[0] - target).max() <= 1e-3
        assert tried[0] == rational.FEWEST and not any(rational.SMOOTH < pairs < turns for pairs in tried)
        assert (found.size >= turns) == (share > 1e-3)
