"""Coefficients brought along: what our own boundary elements give comes back, and each wrong convention is named."""

from dataclasses import replace
from functools import cache
from types import SimpleNamespace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from solver.errors import InputError
from solver.hydrodynamics.bem import agreement, bem, radiated
from solver.hydrodynamics.bem.adopted import _between, _lacking, _left_out, adopted
from solver.hydrodynamics.bem.coefficients import DOFS, PLANAR, cautions
from solver.hydrodynamics.bem.exerted import Floats, in_long_waves
from solver.hydrodynamics.bem.given import Given, turned
from solver.hydrodynamics.bem.incident import Sea
from solver.hydrodynamics.bem.mean_hull import froude_krylov
from solver.hydrodynamics.hull import mesh as meshes
from solver.hydrodynamics.hull.box import box
from solver.hydrodynamics.hull.revolution import Revolution
from solver.hydrodynamics.hull.ring import ring
from solver.hydrodynamics.radiation.infinite import damping_share, infinite_added_mass
from solver.run import simulate
from solver.scene import Float, Scene, Settings, Water
from solver.sea.dispersion import group_velocity
from solver.sea.realization import realize
from solver.sea.spectrum import PiersonMoskowitz
from tests.once import solve

HULLS = (
    Revolution.hemisphere_cylinder(radius=1.0, height=0.6),
    Revolution.vertical_cylinder(radius=1.5, draft=1.2, freeboard=1.0),
)
CENTRES = np.array([[-3.86, 0.0, 0.0], [4.5, 1.0, 0.0]])
NAMES = ("front", "rear")
# The longest waves feel the seabed, kh = 1.6; the shorter ones are solved without it, in a fourth of the time.
WATER = {"depth": 40.0, "density": 1025.0, "gravity": 9.81, "heading": 0.3}


@cache
def ours():
    """Of two unlike floats, in all motions."""
    omega = np.linspace(0.6, 6.6, 17)
    return solve(HULLS, CENTRES, **WATER, omega=omega, planar=False, panels=108)


def told(h=None, **changes):
    """The same as a file would have it."""
    h = h or ours()
    nb = len(h.centres)
    given = Given(
        name="theirs.nc",
        omega=h.omega,
        added_mass=h.added_mass,
        radiation_damping=h.radiation_damping,
        added_mass_inf=h.added_mass_inf,
        headings=np.array([h.heading]),
        excitation=(h.diffraction + h.froude_krylov)[:, None],
        froude_krylov=None,
        columns=tuple((b, dof) for b in range(nb) for dof in h.dofs),
        bodies=NAMES[:nb],
        depth=h.depth,
        density=h.density,
        gravity=h.gravity,
    )
    return replace(given, **changes)


def taken(given, hulls=HULLS, centres=CENTRES, names=NAMES, planar=False, **water):
    return adopted(given, hulls, centres, names, **{**WATER, **water}, planar=planar)


def same(a, b, rel=1e-9):
    for name in ("added_mass", "radiation_damping", "added_mass_inf", "diffraction", "froude_krylov"):
        one, other = getattr(a, name), getattr(b, name)
        assert np.abs(one - other).max() <= rel * np.abs(other).max(), name
    assert a.hydrostatic_stiffness == pytest.approx(b.hydrostatic_stiffness)


def test_what_goes_out_comes_back():
    same(taken(told()), ours())


def test_moments_may_be_about_points_that_only_the_floats_know():
    """As those of a file without points about the origins of their meshes, from which the hulls have been moved."""
    points = CENTRES + np.array([0.4, -0.2, 0.0])
    given = replace(about(ours(), points), points=None)
    same(adopted(given, HULLS, CENTRES, NAMES, **WATER, planar=False, points=points), ours())


def test_of_short_waves_alone_no_phase_is_judged_though_a_froude_krylov_force_is_told():
    h = ours()
    short = h.omega > 3.5
    names = ("added_mass", "radiation_damping", "diffraction", "froude_krylov")
    h = replace(h, omega=h.omega[short], error=None, memory=None, **{n: getattr(h, n)[short] for n in names})
    found = taken(told(h, froude_krylov=h.froude_krylov[:, None]))
    assert cautions(found) == [f"coefficients: {found.settings['unjudged']}"]
    same(found, h)


def test_what_lies_between_a_files_frequencies_is_in_its_error():
    """Of every other frequency; the others tell what its curves miss there."""
    h, rows = alone(), np.arange(0, 21, 2)
    names = ("added_mass", "radiation_damping")
    thin = {name: getattr(h, name)[rows] for name in names}
    half = taken(told(h, omega=h.omega[rows], excitation=told(h).excitation[rows], **thin), **ALONE, **SEA)
    at = h.omega[1::2]
    Z, X = half.impedance(at), half.excitation(at, "diffraction")
    for missed, told_of in (
        (Z.real - h.radiation_damping[1::2], half.error.radiation_damping),
        (-Z.imag / at[:, None, None] - h.added_mass[1::2], half.error.added_mass),
        (X - h.diffraction[1::2], half.error.diffraction),
    ):
        assert 1 / 10 < np.abs(missed[..., 2]).max() / np.abs(told_of[..., 2]).max() < 3  # causality's doubt is in it
    assert not np.any(half.error.added_mass_inf)


def test_waves_between_bodies_that_frequencies_do_not_follow_are_in_the_error():
    """They turn by more than half between two of them: what every other frequency misses is as much as all do."""
    far = {**WATER, "depth": np.inf, "heading": 0.0}
    apart = np.array([[0.0, 0.0, 0.0], [15.0, 0.0, 0.0]])
    fine = bem.solve(HULLS, apart, **far, omega=np.arange(1.0, 4.5, 0.1), planar=True, panels=108)
    curves = ("added_mass", "radiation_damping", "diffraction", "froude_krylov")
    for step in (3, 4):
        some = np.arange(0, 35, step)
        coarse = replace(fine, omega=fine.omega[some], **{name: getattr(fine, name)[some] for name in curves})
        between = np.setdiff1d(np.arange(some[-1]), some)
        missed = coarse.excitation(fine.omega[between], "diffraction") - fine.diffraction[between]
        error = _between(coarse, _left_out(coarse, 2)).diffraction
        assert 1 / 3 < np.linalg.norm(missed) / np.linalg.norm(error) / np.sqrt(len(missed) / len(error)) < 3


def test_a_frequency_that_stands_out_is_in_the_error():
    h = alone()
    wrong = h.diffraction.copy()
    wrong[9, 2] *= 3.0
    off = replace(h, diffraction=wrong)
    error = _between(off, _left_out(off, 2)).diffraction[9, 2]
    assert abs(error) == pytest.approx(abs(wrong[9, 2] - h.diffraction[9, 2]), rel=0.2)


@pytest.mark.parametrize(("factor", "said"), [(1.0, False), (1.03, False), (1.2, True)])
def test_a_frequency_that_stands_out_is_named(factor, said):
    h = alone()
    spiked = h.added_mass.copy()
    spiked[9, 2, 2] *= factor
    notes = cautions(taken(told(h, added_mass=spiked), **ALONE, **SEA))
    where = f"at {h.omega[9]:.4g} rad/s the added mass of {NAMES[0]} along heave"
    assert any(where in note for note in notes) is said and len(notes) == said


@pytest.mark.parametrize(("motion", "share", "said"), [(3, 1e-4, False), (2, 0.2, True)])
def test_a_spike_of_next_to_nothing_is_none(motion, share, said):
    """Of a ball's roll, which radiates nothing, beside what its heave does."""
    h = alone()
    spiked = h.radiation_damping.copy()
    spiked[9, motion, motion] += share * h.radiation_damping[:, 2, 2].max()
    notes = cautions(taken(told(h, radiation_damping=spiked), **ALONE, **SEA))
    assert any("is it a slip" in note for note in notes) is said


def test_the_order_of_frequencies_and_named_bodies_does_not_matter():
    h, turned = ours(), np.r_[6:12, 0:6]
    rows = np.argsort(np.cos(np.arange(len(h.omega))))
    given = told(
        omega=h.omega[rows],
        added_mass=h.added_mass[rows][:, turned[:, None], turned],
        radiation_damping=h.radiation_damping[rows][:, turned[:, None], turned],
        added_mass_inf=h.added_mass_inf[np.ix_(turned, turned)],
        excitation=told().excitation[rows][..., turned],
        bodies=NAMES[::-1],
    )
    same(taken(given), h)


def carried(centres, points):
    """T of velocities of points to those of centres, v + ω × (c - p)."""
    T = np.eye(6 * len(points))
    for b, point in enumerate(points):
        for j, spin in enumerate(np.eye(3)):
            T[6 * b : 6 * b + 3, 6 * b + 3 + j] = np.cross(spin, centres[b] - point)
    return T


def about(h, points):
    """Coefficients with moments and rotations about other points."""
    T = carried(h.centres, points)
    matrices = {n: T.T @ getattr(h, n) @ T for n in ("added_mass", "radiation_damping", "added_mass_inf")}
    return told(h, **matrices, excitation=told(h).excitation @ T, points=np.array(points))


def test_moments_about_a_point_that_the_file_tells_are_carried_over():
    same(taken(about(ours(), [[-3.86, 0.0, -0.7], [4.2, 0.8, 0.5]])), ours())


def test_added_mass_at_infinite_frequency_follows_from_the_rest():
    follows, *off = infinite_added_mass(ours().omega, ours().added_mass, ours().radiation_damping)
    size = np.sqrt(np.maximum(np.diag(ours().added_mass_inf), 1.0))
    size[[5, 11]] = 1e3  # a float that turns about its axis moves no water
    gap = np.abs(follows - ours().added_mass_inf) / np.multiply.outer(size, size)
    mesh = np.where(np.eye(12), 0.01, 0.005)  # that of infinite frequency is another one
    assert gap.max() < 0.02 and np.all(gap < mesh + sum(off) / np.multiply.outer(size, size))
    taken_without = taken(told(added_mass_inf=None))
    assert taken_without.added_mass_inf == pytest.approx(follows)
    # The highest frequency's in its place is what some programs write.
    assert taken(told(added_mass_inf=ours().added_mass[-1])).added_mass_inf == pytest.approx(follows)


def test_causality_of_an_exponential_is_exact():
    # K = exp(-at): B = a/(a² + ω²), A - A∞ = -1/(a² + ω²).
    a, omega = 0.8, np.linspace(0.02, 40, 800)
    B, A = a / (a**2 + omega**2), 3.0 - 1 / (a**2 + omega**2)
    # B(0) is not 0 here, which the spline starts from: the first piece is wrong, by 2/π of its area over ω².
    value, scatter, beyond = infinite_added_mass(omega, A[:, None, None], B[:, None, None])
    assert value[0, 0] == pytest.approx(3.0, abs=2e-4) and scatter[0, 0] < 2e-4 and beyond[0, 0] < 4e-4


def oscillator(omega):
    """A and B of radiation by one damped oscillator, K̂ = iω/(ω₀² - ω² + 2iζω₀ω), and A∞ = 3."""
    Z = 1j * omega / (4.0 - omega**2 + 1.6j * omega)
    return 3.0 + Z.imag / omega, Z.real


@pytest.mark.parametrize("top", [20.0, 5.0, 3.0])
def test_causality_tells_how_many_times_damping_is_told(top):
    """And what of that is not known, and of added mass at infinite frequency; the damping's peak is at 2 rad/s."""
    omega = np.linspace(0.1, top, 40)
    A, B = oscillator(omega)
    (share,), (doubt,), left = damping_share(omega, A[:, None], 1.3 * B[:, None])
    assert abs(1.3 * share - 1) < 1.3 * doubt < 0.15 and left.max() < 0.04 * B.max()
    value, scatter, beyond = infinite_added_mass(omega, A[:, None, None], B[:, None, None])
    assert abs(value[0, 0] - 3) < scatter[0, 0] + beyond[0, 0] + 1e-4 < 0.2


@pytest.mark.parametrize(("last", "known"), [(21, 0.005), (17, 0.05), (13, 0.25)])
def test_added_mass_at_infinite_frequency_is_doubted_as_far_as_it_is_off(last, known):
    """Damping of surge has its peak at the 19th frequency, of heave at the 13th."""
    h = alone()
    value, scatter, beyond = infinite_added_mass(h.omega[:last], h.added_mass[:last], h.radiation_damping[:last])
    for i in (0, 2):
        off, doubt = (x[i, i] / h.added_mass_inf[i, i] for x in (abs(value - h.added_mass_inf), scatter + beyond))
        assert off < doubt + 0.01 and off < 0.01 + known and doubt < 5 * (0.01 + known)


def refused(given, *, match, **others):
    with pytest.raises(InputError, match=match) as caught:
        taken(given, **others)
    return caught.value


def shuffled(h):
    """Columns of the other body, under each float's name."""
    turned = np.r_[6:12, 0:6]
    return told(
        added_mass=h.added_mass[:, turned[:, None], turned],
        radiation_damping=h.radiation_damping[:, turned[:, None], turned],
        added_mass_inf=h.added_mass_inf[np.ix_(turned, turned)],
        excitation=told().excitation[..., turned],
    )


PLATE = Revolution.profile([[3.0, -6.0], [3.0, -5.4], [0.6, -5.4], [0.6, 1.0]])
SEA = WATER | {"depth": np.inf}  # no seabed to solve with


SPAR = {"hulls": (PLATE,), "centres": np.zeros((1, 3)), "names": ("spar",)}


@cache
def plate():
    return solve((PLATE,), SPAR["centres"], **SEA, omega=np.linspace(0.4, 4.4, 11), planar=False, panels=108)


def heavy(h, column):
    """ω(M + A) of a motion."""
    return h.omega * (h.displaced_mass[column // 6] + h.added_mass[:, column, column])


def test_a_heave_plate_is_known_by_the_water_that_it_accelerates():
    h = plate()
    whole = h.diffraction + h.froude_krylov
    assert np.sum(whole[:2, 2] * h.froude_krylov[:2, 2].conj()).real < 0  # against its Froude-Krylov force
    same(taken(told(h), **SPAR, **SEA), h)
    backwards = told(h, excitation=whole[:, None].conj())
    refused(backwards, match="other sign of time", **SPAR, **SEA)


def test_a_force_whose_parts_cancel_is_judged_by_these():
    """The heave of waves of 0.88 rad/s on this plate and its column."""
    stout = Revolution.profile([[3.0, -6.0], [3.0, -5.0], [1.5, -5.0], [1.5, 2.0]])
    one = SPAR | {"hulls": (stout,)}
    h = solve(one["hulls"], one["centres"], **SEA, omega=np.linspace(0.4, 3.2, 57), planar=False, panels=108)
    heave = (h.diffraction + h.froude_krylov)[:, 2]
    least = np.argmin(np.abs(heave[:20]))
    assert abs(heave[least]) < 0.1 * abs(h.froude_krylov[least, 2])
    same(taken(told(h), **one, **SEA), h)
    refused(
        told(h, excitation=h.froude_krylov[:, None]), match="force", **one, **SEA
    )  # that of the incident wave alone
    lighter = told(h, added_mass=0.8 * h.added_mass, added_mass_inf=0.8 * h.added_mass_inf)
    refused(lighter, match="added mass", **one, **SEA)


def test_negative_damping_that_changes_no_answer_is_taken_as_none_and_told():
    """As panels of a heave plate too coarse have it; not of what matters, nor what is of the other sign."""
    h, heave = plate(), (slice(None), 2, 2)
    off = 0.004 * heavy(h, 2)

    def less(times):
        B = h.radiation_damping.copy()
        B[heave] -= times * off
        return told(h, radiation_damping=B)

    found, B = taken(less(1.0), **SPAR, **SEA), less(1.0).radiation_damping[heave]
    (caution,) = cautions(found)
    assert "damping, mostly of spar heave, is negative by 0.004 of its ω(M + A) at" in caution
    assert caution.endswith("are thin parts, as a heave plate, in too few panels?")
    assert found.radiation_damping[heave] == pytest.approx(np.maximum(B, 0.0), abs=1e-6 * B.max())
    assert found.error.radiation_damping[heave][B < 0] == pytest.approx(B[B < 0], abs=0.5 * off.max())
    refused(less(3.0), match="damping is negative at", **SPAR, **SEA)
    refused(told(h, radiation_damping=-0.1 * h.radiation_damping), match="is the sign the other one", **SPAR, **SEA)


def test_damping_of_what_hardly_radiates_may_be_other_than_its_force_tells_and_is_told():
    h, heave = plate(), (slice(None), 2, 2)
    sea, origin = Sea(**SEA), np.zeros((1, 3))
    floats, B = Floats(SPAR["hulls"], origin, origin, SPAR["names"], sea), np.zeros(h.radiation_damping.shape)
    B[heave] = 0.1 * h.radiation_damping[heave]  # 0.3 % of ω(M + A) at most
    given = told(h, radiation_damping=B, excitation=np.sqrt(0.1) * told(h).excitation)
    notes, lacks = radiated.require_energy(given, floats, np.array([2]))
    assert not notes and not lacks.any()
    (note,), lacks = radiated.require_energy(replace(given, radiation_damping=0.5 * B), floats, np.array([2]))
    assert "damping in heave of spar is 0.496 times what the wave force tells of the power radiated" in note
    assert note.endswith(", by 0.002 of its ω(M + A) at 1.6 rad/s")
    assert lacks[heave] == pytest.approx(0.5 * B[heave], abs=0.03 * B.max()) and not lacks[:, :2].any()
    with pytest.raises(InputError, match=r"damping in heave of spar is 1\d\.\d times what"):
        radiated.require_energy(replace(given, radiation_damping=15 * B), floats, np.array([2]))


def test_lopsided_damping_between_bodies_that_changes_no_answer_is_told():
    hulls, omega = (PLATE, HULLS[0]), np.linspace(0.4, 4.4, 8)
    h = solve(hulls, CENTRES, **SEA, omega=omega, planar=False, panels=108)
    at = {**SEA, "planar": False, "needed": [("heave",)] * 2}

    def lopsided(share):
        B = h.radiation_damping.copy()
        B[3, 2, 8] = B[3, 8, 2] + share * np.sqrt(heavy(h, 2)[3] * heavy(h, 8)[3])
        return told(h, bodies=("", ""), radiation_damping=B)

    given = lopsided(0.03)
    B, found = given.radiation_damping, adopted(given, hulls, CENTRES, ("spar", "ball"), **at)
    (caution,) = cautions(found)
    told_of = "damping of spar heave on ball heave and the other way differ by 0.03 of their ω(M + A) at 2.114 rad/s"
    assert told_of in caution.replace("ball heave on spar heave", "spar heave on ball heave")
    off = found.error.radiation_damping[3, 2, 8] - found.error.radiation_damping[3, 8, 2]
    assert off == pytest.approx(B[3, 2, 8] - B[3, 8, 2], rel=1e-6)
    with pytest.raises(InputError, match=r"damping is not symmetric: .* in another order or unit"):
        adopted(lopsided(0.3), hulls, CENTRES, ("spar", "ball"), **at)


def test_passivity_goes_by_no_point_of_moments():
    """What of damping is a little negative in short waves, where turns of bodies far off radiate as little."""
    B = ours().radiation_damping.copy()
    B[-1, 2, 2] = -0.045 * B[:, 2, 2].max()
    h = replace(ours(), radiation_damping=B)
    here, far = taken(told(h)), about(h, np.zeros((2, 3)))
    same(taken(far), here)
    refused(replace(far, points=None), match="wave moments on .* are as about a point .* from the one told")


def test_a_heave_plate_in_another_order_is_named():
    hulls, omega = (PLATE, HULLS[0]), np.linspace(0.4, 4.4, 8)
    h = solve(hulls, CENTRES, **SEA, omega=omega, planar=False, panels=108, interaction=False)
    given, turned = told(h, bodies=("", "")), np.r_[6:12, 0:6]
    both = (slice(None), turned[:, None], turned)
    given = replace(
        given,
        added_mass=h.added_mass[both],
        radiation_damping=h.radiation_damping[both],
        added_mass_inf=h.added_mass_inf[both[1:]],
        excitation=given.excitation[..., turned],
    )
    refused(given, match="another order: ball, spar", hulls=hulls, names=("spar", "ball"), **SEA)


def test_every_other_convention_is_named():
    h, force = ours(), told().excitation
    refused(told(excitation=force.conj()), match=r"other sign of time, Re\{X exp\(\+iωt\)\}")
    own = r"Re\{X exp\(-iωt\)\}, or of waves from the other side; Re\{X exp\(\+iωt\)\} is needed"
    refused(told(excitation=force.conj(), time_sign=1), match=own)  # as the file has it, of which these are conjugates
    refused(told(excitation=-force), match="opposite sign")
    refused(told(excitation=1j * force), match="quarter of a period")
    apart = 1j * np.multiply.outer(Sea(**WATER).wavenumbers(h.omega), CENTRES[:, :2] @ (np.cos(0.3), np.sin(0.3)))
    own = force * np.exp(-apart).repeat(6, axis=1)[:, None]
    refused(told(excitation=own), match="phases that refer to a crest at each float's own place")
    refused(shuffled(h), match="bodies in another order: rear, front")
    refused(told(excitation=force * 8), match="force on .* is 8 times")
    refused(told(radiation_damping=-h.radiation_damping), match="damping is negative at")
    refused(
        told(radiation_damping=2 * np.pi * h.radiation_damping), match="other units of force, added mass or damping"
    )
    turning = h.radiation_damping.copy()
    turning[:, 10, 10] *= 2 * np.pi  # which no force of long waves tells
    refused(
        told(radiation_damping=turning),
        match="damping of rear pitch is 6.* times what its added mass tells by causality",
    )
    lopsided = h.added_mass.copy()
    lopsided[:, 0, 2] += 1.0 * np.sqrt(h.added_mass_inf[0, 0] * h.added_mass_inf[2, 2])
    refused(told(added_mass=lopsided), match="not symmetric: front (surge|heave) on front (surge|heave)")
    stiffness = 2.0 * h.hydrostatic_stiffness
    refused(told(stiffness=stiffness), match="heave stiffness of front is")


def test_other_units_are_named():
    h, rho = ours(), WATER["density"]
    heavy = {n: rho * getattr(h, n) for n in ("added_mass", "radiation_damping", "added_mass_inf")}
    refused(told(**heavy), match="wave force is as of added mass and damping that were to be divided by density")
    refused(told(omega=h.omega / (2 * np.pi)), match="wave force is as of frequencies in Hz: rad/s are needed")


def crossed(h, columns):
    """With columns of each float in another order."""
    both = (slice(None), columns[:, None], columns)
    return told(
        h,
        added_mass=h.added_mass[both],
        radiation_damping=h.radiation_damping[both],
        added_mass_inf=h.added_mass_inf[both[1:]],
        excitation=told(h).excitation[..., columns],
    )


def test_simple_slips_are_named_before_a_turn():
    h, sea = boxy(), SEA | {"heading": -SEA["heading"]}
    refused(told(h, headings=-told(h).headings), match="of waves towards 17.19 degrees: headings", **BOX, **sea)
    swapped = crossed(h, np.array([1, 0, 2, 4, 3, 5]))
    refused(swapped, match="surge and sway, one in the other's column: are roll and pitch", **BOX, **SEA)
    swift = 2 * np.pi / h.omega
    over = (swift / h.omega)[:, None, None]
    frequencies = told(h, omega=swift, radiation_damping=over * h.radiation_damping)
    refused(frequencies, match="as of frequencies where periods are needed", **BOX, **SEA)
    heavy = told(h, added_mass=1.3 * h.added_mass, added_mass_inf=1.3 * h.added_mass_inf)
    refused(heavy, match="wave force goes with 0.[78].* times the added mass that is told", **BOX, **SEA)


def test_bodies_in_another_order_are_named_by_their_sizes():
    """Where the phases of long waves do not tell."""
    near = CENTRES * [0.6, 1.0, 1.0]
    h = solve(HULLS, near, **SEA, omega=np.linspace(0.5, 4.0, 9), planar=False, panels=108)
    other = crossed(h, np.r_[6:12, 0:6])
    refused(replace(other, bodies=("", "")), match="bodies in another order: rear, front", centres=near, **SEA)


ALONE = {"hulls": HULLS[:1], "centres": np.array([[2.0, 0.0, 0.0]]), "names": ("front",)}


@cache
def alone():
    omega = np.linspace(0.4, 4.4, 21)
    return solve(*list(ALONE.values())[:2], **SEA, omega=omega, planar=False, panels=108)


def first(h, count):
    """Of the lowest frequencies alone."""
    names = ("omega", "added_mass", "radiation_damping", "diffraction", "froude_krylov")
    return replace(h, **{n: getattr(h, n)[:count] for n in names})


@pytest.mark.parametrize(
    ("force", "radiation", "match"),
    [
        (0.5, 1.0, "force on front at .* is 0.5.* times"),
        (2.0, 1.0, "force on front at .* is 2.* times"),
        (1.0, 2.0, "wave force goes with 0.5.* times the added mass that is told: have both the same units"),
        (1.25**2, 1.25**3, "force on front at .* is 1.[56].* times"),
        (
            np.r_[[1.0] * 10, [1.4] * 11][:, None, None],
            1.0,
            "damping (in|along) .* of .* is 0.5.* times what the wave force tells",
        ),
    ],
)
def test_sizes_that_do_not_go_together_are_refused(force, radiation, match):
    h = alone()
    scaled = {n: radiation * getattr(h, n) for n in ("added_mass", "radiation_damping", "added_mass_inf")}
    refused(told(h, excitation=force * told(h).excitation, **scaled), match=match, **ALONE, **SEA)


BOX = {"hulls": (box(length=6.0, width=4.0, height=3.0, draft=1.5),), "centres": np.zeros((1, 3)), "names": ("boxy",)}
EVERY = np.ones(6)
HEAVE = np.array([1.0, 1.0, 2.0, 1.0, 1.0, 1.0])
TURNS = np.array([1.0, 1.0, 1.0, 2.0, 2.0, 1.0])


@cache
def boxy():
    omega = np.linspace(0.3, 4.2, 20)
    return solve(*list(BOX.values())[:2], **SEA, omega=omega, planar=False, panels=216)


@pytest.mark.parametrize(
    ("factor", "power", "match"),
    [
        (0.5 * EVERY, 0, "damping of boxy .* is 0.5 times what its added mass tells by causality, as that of 5 other"),
        (1.5 * EVERY, 0, "is 1.5 times what its added mass .* of 5 other motions"),
        (EVERY, 1, "damping of boxy .* goes with its added mass, by causality, as B multiplied by ω; needed is B"),
        (EVERY, -1, "as B divided by ω; needed is B"),
        (2 * EVERY, 1, "as B multiplied by ω and 2.* times that; needed is B"),
        (HEAVE, 0, "damping of boxy heave is 2.* times what its added mass tells by causality: have"),
        (TURNS, 0, "damping of boxy .* is 2 times .*, as that of 1 other motion: have"),
        (1.12 * EVERY, 0, "is 1.12 times what its added mass"),
    ],
)
def test_damping_that_its_added_mass_does_not_go_with_is_refused(factor, power, match):
    """Of a hull that is not of revolution; a force of long waves has hardly any of the damping."""
    h = boxy()
    wrong = np.sqrt(np.multiply.outer(factor, factor)) * h.radiation_damping * h.omega[:, None, None] ** power
    for infinite in (h.added_mass_inf, None):
        refused(told(h, radiation_damping=wrong, added_mass_inf=infinite), match=match, **BOX, **SEA)


@pytest.mark.parametrize("count", [8, 10, 13, 16])
def test_damping_of_a_short_range_is_not_taken_for_wrong(count):
    """That of surge and of yaw has its peak at the 14th frequency and the 17th."""
    h = first(boxy(), count)
    due = radiated.require_damping(told(h), np.arange(6), BOX["names"])
    for dof in range(5):
        B = h.radiation_damping[:, dof, dof]
        assert due[:, dof, dof] == pytest.approx(B, abs=0.03 * B.max())


def test_damping_a_little_off_is_in_the_error():
    h = boxy()
    right, off = (taken(told(h, radiation_damping=f * h.radiation_damping), **BOX, **SEA) for f in (1.0, 1.06))
    for dof in range(5):
        B = off.radiation_damping[:, dof, dof]
        told_of = (off.error.radiation_damping - 1.06 * right.error.radiation_damping)[:, dof, dof]
        assert told_of == pytest.approx(-0.06 / 1.06 * B, abs=0.006 * B.max())
        assert np.abs(right.error.radiation_damping[:, dof, dof]).max() < 0.01 * B.max()


@pytest.mark.parametrize(("dofs", "way"), [([0, 1], "along the waves"), ([2], "in heave")])
@pytest.mark.parametrize("angle", [0.0, 0.7])
def test_the_force_of_long_waves_tells_of_damping(dofs, way, angle):
    """As few frequencies as they are, of any hull, turned in plan."""
    h = first(boxy(), 8)
    sea = Sea(**SEA | {"heading": SEA["heading"] + angle})
    floats = Floats(BOX["hulls"], BOX["centres"], BOX["centres"], BOX["names"], sea)
    given = turned(told(h), np.array([angle]))
    radiated.require_energy(given, floats, np.array(dofs))
    for factor in (0.7, 1.4):
        wrong = given.radiation_damping.copy()
        wrong[:, dofs, dofs] *= factor
        wrong[:, dofs, dofs[::-1]] *= factor if len(dofs) > 1 else 1.0
        with pytest.raises(InputError, match=f"damping {way} of .* is {factor}.* times what the wave force tells"):
            radiated.require_energy(replace(given, radiation_damping=wrong), floats, np.array(dofs))
        radiated.require_energy(replace(given, radiation_damping=wrong), floats, np.array([3]))


def test_a_long_hull_turned_in_plan_keeps_its_damping():
    """Three times a dipole along one of its axes as along the other: waves along x push it across them, too."""
    sea, omega, turn = Sea(**SEA | {"heading": 0.0}), np.linspace(0.3, 1.2, 8), Rotation.from_euler("z", 0.4)
    R = turn.as_matrix()[:2, :2]
    D, k = R @ np.diag([1.0, 3.0]) @ R.T, sea.wavenumbers(omega)
    each = k / (sea.density * sea.gravity * group_velocity(omega, sea.depth, sea.gravity))
    X, B = np.zeros((8, 1, 6), complex), np.zeros((8, 6, 6))
    X[:, 0, :2], B[:, :2, :2] = 1e5 * D[0], 1e10 / 8 * each[:, None, None] * (D @ D)
    columns = tuple((0, dof) for dof in DOFS)
    given = told(first(boxy(), 8), omega=omega, radiation_damping=B, excitation=X, columns=columns)
    floats = Floats(BOX["hulls"], BOX["centres"], BOX["centres"], BOX["names"], sea)
    radiated.require_energy(given, floats, np.arange(6))
    with pytest.raises(InputError, match=r"along the waves of boxy is 1\.5 times"):
        radiated.require_energy(replace(given, radiation_damping=1.5 * B), floats, np.arange(6))


def test_damping_between_bodies_is_that_of_the_waves_of_both():
    """In heave, in long waves; with the sign that forces have, of blocks that are told alike wrong in A and B."""
    given = told()
    floats, heaves = Floats(HULLS, CENTRES, CENTRES, NAMES, Sea(**WATER)), np.array([2, 8])
    radiated.require_together(given, floats, heaves)
    turned_round = np.outer(*[np.repeat([1.0, -1.0], 6)] * 2)
    parts = ("added_mass", "radiation_damping", "added_mass_inf")
    wrong = replace(given, **{name: getattr(given, name) * turned_round for name in parts})
    with pytest.raises(InputError, match=r"between front heave and rear heave is -(0\.9|1\.).* times what waves"):
        taken(wrong)
    radiated.require_together(wrong, floats, heaves[:1])
    pulled = replace(wrong, excitation=given.excitation * np.repeat([1.0, -1.0], 6))  # as of a body deep under water
    radiated.require_together(pulled, floats, heaves)


def test_damping_of_another_shape_is_in_the_error():
    """Where it is wrong, as much as it is; of right damping hardly any."""
    h = boxy()
    wrong = (1 + 0.3 * np.sin(3 * h.omega)[:, None, None]) * h.radiation_damping
    right, off = (taken(told(h, radiation_damping=B), **BOX, **SEA) for B in (h.radiation_damping, wrong))
    for dof in (0, 1, 2):
        largest = h.radiation_damping[:, dof, dof].max()
        in_error = [np.abs(each.error.radiation_damping[:, dof, dof]).max() for each in (right, off)]
        assert in_error[0] < 0.01 * largest and 0.05 * largest < in_error[1] < 0.5 * largest


def test_half_of_what_is_between_lopsided_halves_is_in_the_error():
    """Of added mass, also at infinite frequency, and damping, of motions that the float has; of even ones none."""
    h = boxy()
    names, apart = ("added_mass", "radiation_damping", "added_mass_inf"), np.zeros((6, 6))
    apart[0, 4], apart[4, 0], apart[1, 2] = 0.1, -0.06, 0.03
    size = {name: np.sqrt(np.abs(np.einsum("...ii->...i", getattr(h, name)))) for name in names}
    off = {name: apart * x[..., :, None] * x[..., None, :] for name, x in size.items()}
    swapped = {name: np.swapaxes(x, -1, -2) for name, x in off.items()}
    sure = told(h, froude_krylov=h.froude_krylov[:, None])  # what moments are about
    lopsided = replace(sure, **{name: getattr(h, name) + off[name] for name in names})
    even = replace(sure, **{name: getattr(h, name) + (off[name] + swapped[name]) / 2 for name in names})
    moving = [tuple(dof for dof in DOFS if dof != "sway")]
    one, other = (adopted(each, *BOX.values(), **SEA, planar=False, needed=moving) for each in (lopsided, even))
    same(one, other)
    there = np.outer(*[np.arange(6) != 1] * 2)
    for name in names:
        half, kept = there * (off[name] - swapped[name]) / 2, getattr(other.error, name)
        more = getattr(one.error, name) - kept
        assert more == pytest.approx(half, rel=1e-6, abs=1e-9 * np.abs(half).max()), name
        assert kept == pytest.approx(np.swapaxes(kept, -1, -2), rel=0, abs=1e-12 * np.abs(half).max()), name


def test_what_moments_about_a_doubtful_point_may_be_off_is_of_motions_that_there_are():
    """By long waves, of added mass that is a little off; a Froude-Krylov force tells that the point is right."""
    h, moving = boxy(), [tuple(dof for dof in DOFS if dof != "roll")]
    heavier = h.added_mass.copy()
    heavier[:, [0, 4], [4, 0]] += 0.06 * np.sqrt(heavier[:, 0, 0] * heavier[:, 4, 4])[:, None]
    unsure = told(h, added_mass=heavier)
    sure = replace(unsure, froude_krylov=h.froude_krylov[:, None])
    one, other = (adopted(each, *BOX.values(), **SEA, planar=False, needed=moving).error for each in (unsure, sure))
    assert one.diffraction[:, 3] == pytest.approx(other.diffraction[:, 3], rel=1e-9)
    assert np.abs(one.diffraction[:, 4] - other.diffraction[:, 4]).max() > 1.0


def test_damping_that_is_none_is_refused():
    h = boxy()
    refused(
        told(h, radiation_damping=0 * h.radiation_damping), match="no damping of boxy surge, .* column", **BOX, **SEA
    )


def test_motions_that_a_float_does_not_have_are_not_judged():
    """The yaw of a box is hardly known up to 2 rad/s, its heave is; wrong numbers of others do not matter either."""
    h = first(boxy(), 10)
    lopsided = h.radiation_damping.copy()
    lopsided[:, 0, 1] += lopsided[:, 0, 0]
    refused(told(h, added_mass_inf=None), match="no added mass at infinite frequency", **BOX, **SEA)
    given = told(h, added_mass_inf=None, radiation_damping=lopsided)
    heaving = adopted(given, *BOX.values(), **SEA, planar=False, needed=[("heave",)])
    off, doubt = (heaving.added_mass_inf - h.added_mass_inf)[2, 2], heaving.error.added_mass_inf
    assert abs(off) < doubt[2, 2] + 0.01 * h.added_mass_inf[2, 2]
    assert 1e-3 < doubt[2, 2] / h.added_mass_inf[2, 2] < 0.1
    assert not np.delete(np.delete(doubt, 2, axis=0), 2, axis=1).any()


def test_without_a_memory_added_mass_at_infinite_frequency_need_not_be_known():
    """Neither curves between the frequencies nor their errors go with it."""
    h = first(boxy(), 10)
    without = told(h, added_mass_inf=None)
    refused(
        without, match="at infinite frequency, and what .* off for .*; the frequency domain does without", **BOX, **SEA
    )
    wave = {"memory": False, "planar": False, **SEA}
    known, unknown = (adopted(given, *BOX.values(), **wave) for given in (told(h), without))
    assert not unknown.error.added_mass_inf.any()
    between = np.linspace(h.omega[0], h.omega[-1], 40)
    for one, other in ((known, unknown), (known.shifted, unknown.shifted)):
        Z = one.impedance(between)
        size = np.sqrt(np.abs(np.einsum("wii->wi", Z)).max(axis=0))
        assert np.abs((other.impedance(between) - Z) / np.outer(size, size)).max() < 1e-2
    told_wrong = told(h, added_mass_inf=1.5 * h.added_mass_inf)
    with pytest.raises(InputError, match=r"at infinite frequency is .* implies"):
        adopted(told_wrong, *BOX.values(), **wave)


def test_a_body_that_is_elsewhere_is_refused_or_brought_there():
    h = alone()
    same(taken(told(h), **ALONE, **SEA), h)
    later = 2.0 * h.omega**2 / SEA["gravity"] * np.cos(SEA["heading"])
    brought = taken(told(h, excitation=told(h).excitation * np.exp(-1j * later)[:, None, None]), **ALONE, **SEA)
    assert brought.settings["note"] == "computed at x = y = 0, moved to (2, 0) m"
    same(brought, h)
    away = {"centres": CENTRES - [[2.0, 0.0, 0.0], [0.0, 0.0, 0.0]]}
    refused(told(), match="degrees of phase from it: .* another place", **away)


SQUARE = box(length=2.0, width=2.0, height=3.0, draft=2.0)
TWO = {"hulls": (SQUARE, SQUARE), "centres": np.array([[0.0, 0.0, 0.0], [7.0, 0.0, 0.0]]), "names": NAMES}
LEVEL = SEA | {"heading": 0.0}


@cache
def squares():
    hulls, centres, _ = TWO.values()
    return solve(hulls, centres, **LEVEL, omega=np.linspace(0.6, 2.0, 8), planar=False, panels=216)


@pytest.mark.parametrize(
    "angles", [(23, 0), *(pytest.param(angles, marks=pytest.mark.slow) for angles in ((0, -40), (130, 0), (65, -110)))]
)
def test_axes_turned_in_plan_are_named(angles):
    """Of two square boxes in waves along x, where a turn of either makes a force across of none."""
    given = told(squares())
    taken(given, **TWO, **LEVEL)
    named = rf"axes turned in plan, by degrees {angles[0]} of front, {angles[1]} of rear"
    refused(turned(given, -np.radians(angles)), match=named, **TWO, **LEVEL)
    across = given.excitation.copy()
    across[..., 1] = 0.4 * across[..., 0]
    refused(
        replace(given, excitation=across), match="sway force on front at .* of long waves on its hull", **TWO, **LEVEL
    )


def test_negative_damping_at_few_or_high_frequencies_may_be_an_irregular_one():
    """Beyond the waves' own there is little left to radiate, and a mesh without a lid sloshes inside."""
    heave = 2
    damping = ours().radiation_damping
    one, low, high = damping.copy(), damping.copy(), damping.copy()
    peak = damping[:, heave, heave].argmax()
    one[10, heave, heave] = high[max(peak + 1, 9) :, heave, heave] = -0.5 * damping[peak, heave, heave]
    low[3, heave, heave] *= -1.0
    assert damping[3, heave, heave] > 0.1 * damping[peak, heave, heave]
    at, long = ours().omega[[10, 3]]
    refused(told(radiation_damping=one), match=rf"the other one, or are there irregular frequencies \({at:.4g} rad/s\)")
    thin = rf"or are thin parts, as a heave plate, in too few panels \({long:.4g} rad/s\)"
    refused(told(radiation_damping=low), match=f"is the sign the other one, {thin}")  # too long to slosh inside
    refused(told(radiation_damping=high), match=r"irregular frequencies \(\d of them, .* to 6\.6 rad/s\), which a lid")
    refused(told(radiation_damping=-damping), match=r"is the sign the other one\?")
    lopsided = damping.copy()
    lopsided[10, 0, 2] += np.sqrt(damping[:, 0, 0].max() * damping[:, 2, 2].max())
    refused(
        told(radiation_damping=lopsided),
        match=rf"not symmetric: .* in another order or unit, or are there irregular frequencies \({at:.4g} rad/s\)",
    )


def test_moments_about_another_point_than_told_show_in_the_froude_krylov_moment():
    points = CENTRES - [0.0, 0.0, 2.0]
    low = about(ours(), points)
    fk = (ours().froude_krylov @ carried(CENTRES, points))[:, None]
    same(taken(replace(low, froude_krylov=fk)), ours())
    refused(replace(low, froude_krylov=fk, points=None), match="Froude-Krylov moment on .* another point")


def test_one_float_alone_is_moved_to_its_place():
    """A file of one body is computed anywhere; the wave then reaches it at another time, and nothing else changes."""
    hull, omega, at = HULLS[1], ours().omega[::2], CENTRES[1:]
    here, there = (bem.solve((hull,), c, **WATER, omega=omega, planar=False, panels=108) for c in ([[0, 0, 0]], at))
    given = told(here, points=np.array([[0.0, 0.0, 0.0]]), bodies=("",))
    moved = taken(given, (hull,), at, ("rear",))
    same(moved, there)
    assert "moved to (4.5, 1)" in moved.settings["note"]
    off = np.array([[0.3, 0.0, 0.0]])
    given = replace(about(here, off), points=None, bodies=("",))
    same(adopted(given, (hull,), at, ("rear",), **WATER, planar=False, points=at + off), there)


def test_moments_are_held_against_what_long_waves_exert_though_a_froude_krylov_force_is_told():
    """Pitch of the other sign in added mass and damping: the incident wave's moment does not tell."""
    h, away = ours(), about(ours(), CENTRES - [0.0, 0.0, 3.0])
    signs = np.where(np.arange(12) % 6 == 4, -1.0, 1.0)
    fk = (h.froude_krylov @ carried(CENTRES, CENTRES - [0.0, 0.0, 3.0]))[:, None]
    same(taken(replace(away, froude_krylov=fk)), h)
    wrong = {
        n: np.outer(signs, signs) * getattr(away, n) for n in ("added_mass", "radiation_damping", "added_mass_inf")
    }
    refused(
        replace(away, **wrong, froude_krylov=fk), match="wave moments on .* are as about a point .* from the one told"
    )


def test_one_float_alone_is_moved_by_its_own_point_near_places_too():
    """That the file's x = y = 0 is, not where its buoyancy is; whatever point moments are about."""
    own = np.array([[0.0, 0.0, 0.0]])
    away = np.array([[0.4, 0.0, 0.0]])
    here = bem.solve((HULLS[1],), away, **WATER, omega=ours().omega[::2], planar=False, panels=108)
    for step in ([0.3, 0.1, 0.0], [20.0, -7.0, 0.0]):
        there = bem.solve((HULLS[1],), away + step, **WATER, omega=here.omega, planar=False, panels=108)
        for points in (None, own):
            given = replace(about(here, own), points=points, bodies=("",))
            found = adopted(given, (HULLS[1],), away + step, ("rear",), **WATER, planar=False, points=own + step)
            assert found.settings["note"] == f"computed at x = y = 0, moved to ({step[0]:g}, {step[1]:g}) m"
            same(found, there)


@cache
def pair_apart():
    apart = np.array([[-20.0, 0.0, 0.0], [20.0, 0.0, 0.0]])
    return apart, bem.solve(HULLS, apart, **SEA, omega=np.linspace(0.4, 3.0, 27), planar=False, panels=108)


def test_moments_may_be_about_a_point_that_is_told_far_off():
    """As the origin of all, capytaine's own, is."""
    apart, h = pair_apart()
    far = about(h, np.zeros((2, 3)))
    same(adopted(far, HULLS, apart, NAMES, **SEA, planar=False), h, rel=1e-8)


def test_heave_of_a_ring_in_whose_well_water_swings_is_not_judged():
    """Waves are long there, and yet what they exert is far from what a body without a well feels."""
    well = ring(((3.0, -12.0), (5.0, -12.0), (5.0, 3.0), (3.0, 3.0)))
    omega = np.append(np.arange(0.5, 1.5, 0.11), 2.4)
    h = bem.solve((well,), [[0, 0, 0]], **SEA, omega=omega, planar=True, panels=400)
    given = told(h, bodies=("",), columns=tuple((0, dof) for dof in PLANAR))
    seen = adopted(given, (well,), np.zeros((1, 3)), ("ring",), **SEA, planar=True, memory=False)
    spikes = given.radiation_damping.copy()
    spikes[-1, 0, 0] *= -1
    with pytest.raises(InputError, match="does water slosh in the well of ring"):
        adopted(
            replace(given, radiation_damping=spikes), (well,), np.zeros((1, 3)), ("ring",), **SEA, planar=True,
            memory=False,
        )  # fmt: skip
    assert np.abs(seen.diffraction - h.diffraction).max() < 1e-9 * np.abs(h.diffraction).max()


def test_what_a_file_leaves_out_or_takes_for_another_water_is_named():
    h = ours()
    refused(told(excitation=h.froude_krylov[:, None]), match="is the Froude-Krylov force alone")
    si = {"added_mass": 1025.0 * h.added_mass, "added_mass_inf": 1025.0 * h.added_mass_inf}
    si["radiation_damping"] = 1025.0 * h.omega[:, None, None] * h.radiation_damping
    refused(
        told(**si, excitation=1025.0 * 9.81 * told().excitation), match="numbers in SI units where a file's are over"
    )
    shallow = {**WATER, "depth": 6.0}
    low = bem.solve(HULLS, CENTRES, **shallow, omega=h.omega, planar=False, panels=108)
    refused(told(low, depth=None), match="is as of water some 6.* m deep")


def test_damping_of_each_of_several_bodies_goes_with_its_wave_force():
    """Ten per cent is an error of meshes, 40 are not; added mass along with it, so that causality has no objection."""
    h, heave = ours(), np.ones(12)
    heave[8] = np.sqrt(1.4)
    both = np.outer(heave, heave)
    scaled = {n: both * getattr(h, n) for n in ("added_mass", "radiation_damping", "added_mass_inf")}
    refused(told(**scaled), match="damping in heave of rear is 1.4.* times what the wave force tells")


def test_what_cannot_be_used_is_refused():
    refused(told(bodies=("one",)), match="has 1 bodies, the study has 2 floats")
    assert refused(told(density=1000.0), match="that of theirs.nc").key == "water.density"
    assert refused(told(depth=np.inf), match="must be inf, that of theirs.nc").key == "water.depth"
    assert refused(told(headings=np.array([0.0])), match="must be one of 0 rad").key == "waves.heading"
    refused(told(headings=np.degrees([0.3])), match="must be one of 17.19 rad, .* in degrees")
    few = {n: getattr(told(), n)[:4] for n in ("omega", "added_mass", "radiation_damping", "excitation")}
    refused(told(**few), match="has 4 different frequencies, needs 8")
    wrong = told().excitation.copy()
    wrong[0, 0, 0] = np.nan
    for omega in (0.0, np.nan):
        odd = np.append(told().omega[:-1], omega)
        refused(told(omega=odd), match=f"has a frequency of {omega:g} rad/s: must be finite and > 0")
    refused(told(excitation=wrong), match="not finite: wave force at 0.6 rad/s, heading 0.3 rad")
    refused(told(first(alone(), 8), added_mass_inf=None), match="no added mass at infinite frequency", **ALONE, **SEA)
    assert refused(told(), match=r"must be within 0.6 to 6.6 rad/s", waves=(0.5, 2.0)).key == "band"


def test_too_short_a_range_is_not_taken_for_wrong_numbers():
    """What does not reach the waves is said first; and where damping still grows, that the rest tells little."""
    h, surge = alone(), 1.0 + 9.0 * np.diag(np.arange(6) == 0)
    wrong = {"added_mass_inf": h.added_mass_inf * surge}
    said = refused(told(h, **wrong), match="at infinite frequency is .* rest up to 4.4 rad/s implies", **ALONE, **SEA)
    assert "grows" not in said.limit
    cut = {n: getattr(told(h), n)[:9] for n in ("omega", "added_mass", "radiation_damping", "excitation")}
    short = told(h, **wrong, **cut)
    refused(short, match="must be within 0.4 to 2 rad/s, the frequencies of", waves=(0.7, 2.3), **ALONE, **SEA)
    refused(short, match="rest up to 2 rad/s implies .*; damping still grows there", waves=(0.7, 1.9), **ALONE, **SEA)


def test_motions_that_a_float_cannot_have_may_be_left_out():
    h, kept = ours(), np.array([2, 8])
    given = told(
        added_mass=h.added_mass[:, kept[:, None], kept],
        radiation_damping=h.radiation_damping[:, kept[:, None], kept],
        added_mass_inf=h.added_mass_inf[np.ix_(kept, kept)],
        excitation=told().excitation[..., kept],
        columns=((0, "heave"), (1, "heave")),
    )
    refused(given, match="lacks surge of front, ")
    heaving = adopted(given, HULLS, CENTRES, NAMES, **WATER, planar=False, needed=[("heave",), ("heave",)])
    assert heaving.added_mass[:, kept[:, None], kept] == pytest.approx(h.added_mass[:, kept[:, None], kept])
    assert np.abs(heaving.added_mass[:, 0]).max() == 0


def without(given, *dofs):
    """Of motions that a file leaves out."""
    return of_columns(given, [i for i, (_, dof) in enumerate(given.columns) if dof not in dofs])


def of_columns(given, kept):
    """With these alone."""
    fewer = {n: getattr(given, n)[:, kept][..., kept] for n in ("added_mass", "radiation_damping")}
    forces = {n: f if (f := getattr(given, n)) is None else f[..., kept] for n in ("excitation", "froude_krylov")}
    infinite = given.added_mass_inf[np.ix_(kept, kept)]
    return replace(given, **fewer, **forces, added_mass_inf=infinite, columns=tuple(given.columns[i] for i in kept))


@pytest.mark.parametrize("incident", [True, False])
def test_a_force_on_a_joint_that_a_file_lacks_is_no_number(incident):
    """Of a heaving ball pushed along x; with or without a Froude-Krylov force in the file, its own heave is known."""
    h = alone()
    whole = told(h, froude_krylov=h.froude_krylov[:, None] if incident else None)
    ball = Float(
        name="front", hull=ALONE["hulls"][0], mass=float(h.displaced_mass[0]), inertia=(1e3,) * 3, motion=("heave",),
        hinge=(2.0, 0.0, 0.0), pto_damping=1e3,
    )  # fmt: skip
    sea = realize(PiersonMoskowitz(Hs=0.2, Tp=4.0), components=20, band=(0.8, 4.0), seed=0, heading=SEA["heading"])
    water = Water(**{key: SEA[key] for key in ("depth", "density", "gravity")})
    scene = Scene(water=water, sea=sea, floats=(ball,), settings=Settings(method="frequency", froude_krylov="linear"))
    records = []
    for given in (whole, without(whole, "surge", "pitch"), without(whole, "yaw")):
        known = adopted(given, **ALONE, **SEA, planar=False, needed=[("heave",)])
        records.append(simulate(scene, known))
    force, lacking, unmoved = (record.variables["hinge_force"][1][0] for record in records)
    assert (
        np.isfinite(force).all()
        and unmoved == pytest.approx(force)
        and "lacks" not in records[2].attrs.get("warnings", "")
    )
    assert np.isnan(lacking[0]).all() and lacking[1:] == pytest.approx(force[1:])
    told_of = "coefficients: the file lacks surge of front, so its hinge_force along x is not known"
    assert told_of in records[1].attrs["warnings"]
    assert records[1].variables["motion"][1] == pytest.approx(records[0].variables["motion"][1])


WALLED = {
    "hulls": (
        Revolution.vertical_cylinder(radius=1.5, draft=3.0, freeboard=1.0),
        box(length=2.0, width=10.0, height=7.0, draft=6.0),
    ),
    "centres": np.array([[0.0, 0.0, 0.0], [3.2, 0.0, 0.0]]),
    "names": NAMES,
}


@cache
def by_a_wall():
    """Of a cylinder before a fixed wall, which halves the push along and adds to that up; with the incident wave's."""
    along = SEA | {"heading": 0.0}
    h = solve(WALLED["hulls"], WALLED["centres"], **along, omega=np.linspace(0.5, 4.0, 12), planar=True, panels=108)
    return h, told(h, froude_krylov=h.froude_krylov[:, None])


def held(given, moving=("surge", "heave", "pitch")):
    """With a second body that is fixed."""
    return adopted(given, **WALLED, **SEA | {"heading": 0.0}, planar=True, needed=[moving, ()])


@pytest.mark.parametrize("incident", [True, False])
@pytest.mark.parametrize(
    ("kept", "moving"),
    [((0, 1, 2), ("surge", "heave", "pitch")), ((0, 1, 2, 4), ("surge", "heave", "pitch")), ((2,), ("pitch",))],
)
def test_a_fixed_neighbour_may_lack_motions(kept, moving, incident):
    """What it scatters is most of the force along on the other, and only its own motions would tell of that."""
    h, given = by_a_wall()
    part = of_columns(given if incident else replace(given, froude_krylov=None), list(kept))
    found, there = held(part, moving), [i for i in kept if i < 3]
    assert cautions(found)[0].startswith("coefficients: the file lacks motions of rear, and with them what waves")
    assert found.added_mass[:, there] == pytest.approx(h.added_mass[:, there] * np.isin(np.arange(6), kept))
    assert found.diffraction[:, there] == pytest.approx(h.diffraction[:, there])


def test_beside_a_fixed_neighbour_that_lacks_motions_the_incident_wave_tells_what_is_wrong():
    _, given = by_a_wall()
    bare = of_columns(given, [0, 1, 2])
    wrong = {n: getattr(bare, n).conj() for n in ("excitation", "froude_krylov")}
    with pytest.raises(InputError, match=r"Froude-Krylov \w+ on front in"):
        held(replace(bare, **wrong))
    off = replace(bare, points=np.array([[0.0, 0.0, 0.4], [3.2, 0.0, 0.0]]))
    with pytest.raises(InputError, match=r"wave moments on front are as about a point .* m or more from the one told"):
        held(off)


def test_what_all_of_a_file_lacks_leaves_its_forces_judged():
    """Of all motions of both bodies, and of heave alone of both, whose force another sign of time turns round."""
    _, given = by_a_wall()
    for kept, moving in ((range(6), ("surge", "heave", "pitch")), ((1, 4), ("heave",))):
        right = replace(of_columns(given, list(kept)), froude_krylov=None)
        assert not cautions(held(right, moving))
        with pytest.raises(InputError, match="wave force"):
            held(replace(right, excitation=-right.excitation), moving)


def test_a_moment_is_not_judged_without_the_translations_of_its_body():
    """Along which the water passing exerts part of it: of a deep cylinder's pitch alone, about its waterplane."""
    hulls, at = WALLED["hulls"][:1], np.zeros((1, 3))
    along = SEA | {"heading": 0.0}
    h = solve(hulls, at, **along, omega=np.linspace(0.5, 4.0, 12), planar=True, panels=108)
    found = adopted(of_columns(told(h), [2]), hulls, at, NAMES[:1], **along, planar=True, needed=[("pitch",)])
    assert found.diffraction[:, 2] == pytest.approx(h.diffraction[:, 2])
    with pytest.raises(InputError, match="wave moments on front"):
        adopted(told(h, points=np.array([[0, 0, 0.6]])), hulls, at, NAMES[:1], **along, planar=True)


def test_what_pushes_across_the_waves_where_no_mirror_is_is_lacking():
    """No incident wave does; a body that is its own image, in waves along the plane, is pushed by nothing."""

    def lacking(heading, needed, symmetry=(True, True), places=((0.0, 0.0), (9.0, 0.0))):
        centres = np.array([(*at, 0.0) for at in places])
        hull = SimpleNamespace(symmetry=symmetry)
        sea = SimpleNamespace(heading=heading)
        expected = np.ones((3, 12)) * np.tile([np.cos(heading), np.sin(heading), 1, 0, 0, 0], 2)
        expected[np.abs(expected) < 1e-12] = 0.0
        floats = Floats((hull, hull), centres, centres, ("a", "b"), sea)
        told = np.tile(np.arange(6) == 2, 2)
        return _lacking(floats, needed, expected, told).get("lacking", "")

    heave = [("heave",)] * 2
    assert lacking(0.0, heave) == "0 6"
    assert lacking(np.pi / 2, heave) == "0 1 6 7"  # the bodies stand along x: one is not the other's image
    assert lacking(np.pi / 2, heave, places=((0.0, 0.0), (0.0, 9.0))) == "1 7"
    assert lacking(0.0, heave, symmetry=(True, False)) == "0 1 6 7"
    assert lacking(0.0, heave, places=((0.0, 0.0), (9.0, 2.0))) == "0 1 6 7"
    assert lacking(0.0, [("heave",), ("roll",)]) == "0 1 6 7"
    assert lacking(0.0, [("surge", "heave", "pitch")] * 2) == "0 6"


def test_what_a_files_mesh_does_to_a_force_that_a_joint_bears_is_in_the_error():
    """Of a motion that it holds; what a file lacks of such has none, nor any of a wave's force that is scattered."""
    h = alone()
    coarse = h.froude_krylov * np.where(np.arange(6) == 0, 1.08, 1.0)
    seen = told(h, excitation=(h.diffraction + coarse)[:, None], froude_krylov=coarse[:, None])
    held, lacking = (
        adopted(each, **ALONE, **SEA, planar=False, needed=[("heave",)]) for each in (seen, without(seen, "surge"))
    )
    off = held.error.diffraction[:, 0] - taken(told(h), **ALONE, **SEA).error.diffraction[:, 0]
    assert off == pytest.approx(0.08 * h.froude_krylov[:, 0], rel=1e-6)
    assert not lacking.error.diffraction[:, 0].any() and not lacking.diffraction[:, 0].any()


def test_floats_that_cannot_move_may_have_coefficients_from_a_file():
    h = alone()
    fixed = adopted(told(h), **ALONE, **SEA, planar=False, needed=[()])
    assert fixed.diffraction == pytest.approx(h.diffraction)


def test_moments_about_another_point_than_told_are_seen_by_long_waves_alone():
    """Without a Froude-Krylov force in the file."""
    right = told(points=CENTRES)
    same(taken(right), ours())
    for shift in ((0.0, 0.0, 0.4), (0.4, 0.0, 0.0)):
        refused(
            told(points=CENTRES + shift), match="wave moments on .* as about a point .* m or more from the one told"
        )


def test_where_moments_are_about_is_told_by_long_waves_or_is_in_the_error():
    """A box's, about its centre of gravity; what is seen of another point is as far as it is."""
    one = {"hulls": (box(length=4.0, width=2.0, height=1.6, draft=1.0),), "centres": np.zeros((1, 3)), "names": "a"}
    h = solve(*list(one.values())[:2], **SEA, omega=np.linspace(0.4, 3.0, 14), planar=False, panels=216)

    def untold(z):
        return replace(about(h, [[0.0, 0.0, z]]), points=None)

    right = taken(untold(0.0), **one, **SEA)
    sure = taken(told(h, froude_krylov=h.froude_krylov[:, None]), **one, **SEA)
    assert right.error.diffraction == pytest.approx(sure.error.diffraction)
    for z in (-0.2, 0.4):
        refused(untold(z), match=f"a point {abs(z)} m or more", **one, **SEA)
    near = taken(untold(-0.06), **one, **SEA)
    for dof in (3, 4):
        off = near.diffraction[:3, dof] - right.diffraction[:3, dof]
        told_of = (near.error.diffraction - right.error.diffraction)[:3, dof]
        assert np.all((-told_of / off).real > 0.5) and np.all((-told_of / off).real < 1.0)


def test_a_waterplane_that_is_off_is_in_the_error_of_forces():
    """As much as the same share of Froude-Krylov's force, told by itself, would be."""
    h, share = ours(), np.repeat([0.97, 1.02], 6)
    heave = np.diag(np.diag(h.hydrostatic_stiffness) * share * np.tile([0, 0, 1, 0, 0, 0], 2))
    incident = h.froude_krylov * share
    plain, by_plane = (taken(told(stiffness=C)).error.diffraction for C in (None, heave))
    whole = h.diffraction + incident
    by_force = taken(told(excitation=whole[:, None], froude_krylov=incident[:, None])).error.diffraction
    assert by_plane - plain == pytest.approx(h.froude_krylov * (share - 1), abs=1e-9 * np.abs(h.froude_krylov).max())
    assert by_force == pytest.approx(by_plane, abs=2e-3 * np.abs(h.froude_krylov).max())


@pytest.mark.slow
def test_what_a_files_mesh_does_to_the_froude_krylov_force_is_in_the_error():
    """The whole force is as told; the diffraction's is what remains of it, and has the incident wave's error or not."""
    h, there = boxy(), np.arange(6) != 1
    coarse = 1.03 * h.froude_krylov
    seen = told(h, excitation=(h.diffraction + coarse)[:, None], froude_krylov=coarse[:, None])
    moving = [tuple(np.array(DOFS)[there])]
    part, right = (
        adopted(each, *BOX.values(), **SEA, planar=False, needed=moving)
        for each in (without(seen, "sway"), without(told(h), "sway"))
    )
    assert part.diffraction == pytest.approx(h.diffraction * there)
    off = part.error.diffraction - right.error.diffraction
    assert off[:, 2] == pytest.approx(0.03 * h.froude_krylov[:, 2], abs=1e-3 * np.abs(h.froude_krylov[:, 2]).max())
    assert (
        not part.error.diffraction[:, 1].any() and np.abs(off[:, 0]).max() > 0.02 * np.abs(h.froude_krylov[:, 0]).max()
    )


DEEP = Sea(density=1025.0, gravity=9.81, depth=np.inf, heading=0.5)


def incident(hull, count, z):
    """Froude-Krylov force of so many flat panels as a file has it, moments about a height z, and that on the hull."""
    omega = np.sqrt(DEEP.gravity * np.array([0.01, 0.1, 0.3, 0.8]) / hull.largest_radius)
    vertices, faces = meshes.panels(hull, count, narrow=False)
    corners, none = vertices[faces], np.zeros((len(omega), 6, 6))
    areas = np.cross(corners[:, 2] - corners[:, 0], corners[:, 3] - corners[:, 1]) / 2
    lever = np.cross(corners.mean(axis=1) - [0.0, 0.0, z], areas)
    force = [-DEEP.pressure(corners.mean(axis=1), w) @ np.hstack([areas, lever]) for w in omega]
    given = Given(
        name="theirs.nc", omega=omega, added_mass=none, radiation_damping=none, added_mass_inf=None, bodies=("a",),
        headings=np.array([DEEP.heading]), excitation=np.array(force)[:, None], froude_krylov=np.array(force)[:, None],
        columns=tuple((0, dof) for dof in DOFS),
    )  # fmt: skip
    at = np.zeros((1, 3))
    return given, Floats((hull,), at, at, ("a",), DEEP), froude_krylov((hull,), at, DOFS, DEEP, omega)


UNLIKE = {
    "sphere": Revolution.sphere(radius=1.0, draft=1.0),
    "cylinder": Revolution.vertical_cylinder(radius=2.0, draft=2.0, freeboard=2.0),
    "disc": Revolution.vertical_cylinder(radius=5.0, draft=0.5, freeboard=1.0),
    "deep": Revolution.sphere(radius=1.0, draft=1.8),
    "box": box(length=3.0, width=2.0, height=2.0, draft=1.0),
    "barge": box(length=20.0, width=4.0, height=2.0, draft=1.0),
}


@pytest.mark.parametrize("name", UNLIKE)
def test_froude_krylov_moments_tell_where_they_are_about(name):
    """Another point than told is refused as soon as no coarse panels are like it; what is nearer is in the error."""
    hull = UNLIKE[name]
    _, _, _, Sxx, _, Syy = hull.waterplane
    may = 0.025 * hull.size + 0.05 * max(Sxx, Syy) / hull.volume
    (fine,) = agreement.require_moments(*incident(hull, 3000, 0.0))
    assert np.linalg.norm(fine) < 0.02 * may
    agreement.require_moments(*incident(hull, 108, 0.0))
    for side in (-1.0, 1.0):
        with pytest.raises(InputError, match="wave moments on a are as about a point"):
            agreement.require_moments(*incident(hull, 432, 1.5 * side * may))
        (doubt,) = agreement.require_moments(*incident(hull, 3000, 0.8 * side * may))
        assert doubt[:2] == pytest.approx([0.0, 0.0], abs=0.01 * may) and 0.6 < -side * doubt[2] / (0.8 * may) < 1.0


@pytest.mark.slow
@pytest.mark.parametrize("count", [5, 12])
def test_a_float_about_a_spar_with_a_plate_is_known(count):
    """Near each other each takes of the other's force along."""
    spar = Revolution.profile([(0, -35.0), (15.0, -35.0), (15.0, -34.0), (3.0, -34.0), (3.0, 5.0), (0, 5.0)])
    hulls, at = (ring(((3.4, -3.0), (10.0, -2.0), (10.0, 2.0), (3.4, 2.0))), spar), np.zeros((2, 3))
    omega, water = np.linspace(0.2, 0.7, count), {"depth": np.inf, "heading": 0.3}
    right = solve(hulls, at, **water, omega=omega, planar=False, panels=216)
    floats = Floats(hulls, at, at, ("float", "spar"), Sea(density=1025.0, gravity=9.81, **water))
    given = told(right, points=at)
    agreement.agreed(given, floats, right.froude_krylov)
    assert not agreement.require_moments(given, floats, right.froude_krylov).any()
    for factor in (0.5, 1.7):
        with pytest.raises(InputError, match="times what long waves"):
            agreement.agreed(replace(given, excitation=factor * given.excitation), floats, right.froude_krylov)


@pytest.mark.parametrize(("heading", "dof"), [(0.0, 1), pytest.param(np.pi / 2, 0, marks=pytest.mark.slow)])
def test_a_force_that_is_what_another_body_scatters_is_known(heading, dof):
    """Of a small float beside a large one, across the waves; of other sizes or signs it is none of right ones."""
    hulls = tuple(Revolution.vertical_cylinder(radius=r, draft=0.75 * r, freeboard=1.0) for r in (4.0, 1.2))
    at = 6.5 * np.array([[0.0, 0.0, 0.0], [np.sin(heading), np.cos(heading), 0.0]])
    water = {"depth": np.inf, "heading": heading}
    omega = np.sqrt(WATER["gravity"] * np.linspace(0.06, 0.9, 6) / 4.0)
    right = solve(hulls, at, **water, omega=omega, planar=False, panels=108)
    floats = Floats(hulls, at, at, NAMES, Sea(density=1025.0, gravity=9.81, **water))
    given = told(right, points=at)
    agreement.agreed(given, floats, right.froude_krylov)
    assert in_long_waves(given, floats, right.froude_krylov).off < 0.3
    for factor in (-1.0, 3.0):
        wrong = given.excitation.copy()
        wrong[..., 6 + dof] *= factor
        with pytest.raises(InputError, match=f"{DOFS[dof]} force on rear at .* heading {heading:.4g} rad, is"):
            agreement.agreed(replace(given, excitation=wrong), floats, right.froude_krylov)
