"""Damping lids on water in gaps and wells: where they lie, whose energy they take, and how much."""

from dataclasses import dataclass
from functools import cache
from math import inf

import numpy as np
import pytest
from pytest import approx

from solver.hydrodynamics.bem import bem
from solver.hydrodynamics.bem.far_field import FarField, Waves, excitation, radiation_damping
from solver.hydrodynamics.bem.mean_hull import froude_krylov
from solver.hydrodynamics.hull import mesh as meshes
from solver.hydrodynamics.hull import surface
from solver.hydrodynamics.hull.gaps import gaps
from solver.hydrodynamics.hull.panel_hull import PanelHull
from solver.hydrodynamics.hull.revolution import Revolution
from solver.hydrodynamics.hull.ring import ring
from tests.awkward import prism

RHO, G = 1025.0, 9.81
SPAR = Revolution.vertical_cylinder(radius=3.0, draft=6.0, freeboard=3.0)
RING = ring(((3.5, -3.0), (6.5, -3.0), (6.5, 2.0), (3.5, 2.0)))
BOX = prism([(-2, -1.5), (2, -1.5), (2, 1), (-2, 1)], 8.0)
LEANING = prism([(-1.4, -1.5), (2, -1.5), (2, 1), (-2.3, 1)], 6.0)  # its waterline starts at x = -1.94 m
# Hulls, places, width of lidded gaps [m], area of the lid in closed form [m²] and within which share.
SCENES = {
    "ring": ((SPAR, RING), [[0, 0, 0], [0, 0, 0]], 0.6, np.pi * (3.5**2 - 3.0**2), 1e-3),
    "boxes": ((BOX, BOX), [[0, 0, 0], [4.6, 0, 0]], 0.8, 0.6 * 8.0, 1e-3),
    # Beyond the shorter one's ends the circle touches its corners and the other's side: what is left there is coarse.
    "unequal": ((BOX, LEANING), [[1.0, 5.0, 0], [5.44, 5.5, 0]], 0.8, 0.5 * 6.0 + 0.057, 0.07),
}


@pytest.mark.parametrize("name", SCENES)
@pytest.mark.parametrize("side", [0.3, 1.3])
def test_lids_cover_the_water_in_gaps(name, side):
    hulls, centres, width, area, share = SCENES[name]
    at = np.array(centres, float)
    panels = gaps(hulls, at, width, side)
    down = surface.area_vectors(surface.triangles(panels))
    assert np.all(down[:, 2] < 0) and np.all(panels[..., 2] == 0)
    assert -down[:, 2].sum() == approx(area, rel=share)
    thirds = np.linspace(0, 1, 4)
    cut = surface.area_vectors(surface.triangles(surface.divided(panels, thirds, thirds)))
    assert cut[:, 2].sum() == approx(down[:, 2].sum(), rel=1e-12) and np.all(cut[:, 2] < 0)
    assert not len(gaps(hulls, at, {"ring": 0.42, "boxes": 0.58, "unequal": 0.48}[name], side))


def test_no_lid_lies_within_bodies_that_adjoin():
    """A box as two halves without the faces between them, beside a whole one: the lid of two whole boxes."""
    halves = [PanelHull.of(*meshes.indexed(surface.below(BOX.panels, 0, sign=sign))) for sign in (1, -1)]
    assert not any(half.closed for half in halves)
    lid = gaps((*halves, BOX), np.array([[0, 0, 0], [0, 0, 0], [-4.6, 0, 0]]), 0.8, 0.5)
    assert -surface.area_vectors(surface.triangles(lid))[:, 2].sum() == approx(0.6 * 8.0, rel=1e-3)


def test_a_well_is_a_gap_as_wide_as_its_diameter():
    well = ring(((10.0, -3.0), (10.0, 2.0), (2.0, 2.0), (2.0, -3.0)))
    here = np.zeros((1, 3))
    area = -surface.area_vectors(surface.triangles(gaps((well,), here, 4.1, 0.6)))[:, 2].sum()
    assert area == approx(4 * np.pi, rel=1e-4)
    assert not len(gaps((well,), here, 3.9, 0.6))
    assert not len(gaps((SPAR,), here, 50.0, 0.6))  # a hull's outside is no gap, nor is water between bodies far apart
    assert not len(gaps((SPAR, SPAR), np.array([[0, 0, 0], [12.0, 0, 0]]), 3.0, 0.6))


@dataclass
class Solved:
    """One mesh at one frequency, waves towards HEADING."""

    damping: np.ndarray  # (n, n)
    force: np.ndarray  # (n,) of the unit wave at the far field's origin
    far: FarField
    taken: np.ndarray  # (n + 1, n + 1) power that the lid takes of unit velocities and of the unit wave, ρω εK ∫ φφ* dS
    elevation: complex  # mean on the lid, in the unit wave


HEADING = 0.3


@cache
def solved(hulls, places, width, epsilon, omega, *, refine=2, panels=200, density=RHO):
    """Coefficients and what the lid does, from one mesh."""
    problem = bem.Problem.of(
        hulls, np.array(places, float), depth=inf, density=density, gravity=G, omega=np.array([omega]), panels=panels,
        far_field=True, gap_damping=epsilon, gap_width=width, headings=(HEADING,),
    )  # fmt: skip
    build = bem.Mesh.build
    mesh = build(hulls, problem.centres, problem.dofs, problem.counts, refine, inf, lids=problem.lids, gap_width=width)
    k, loss = omega**2 / G, epsilon * omega**2 / G
    sources = np.concatenate([mesh.motions, mesh.scattered(problem.seas, omega, loss)], axis=2)
    potentials = mesh.solve(sources, k, inf, loss)
    forces = density * mesh.forces(potentials, sources.shape[2])
    far = mesh.far_field(potentials, sources, mesh.plane_waves(k, inf, problem.orders), loss)
    on_lid = sum(sign[:, None, None] * potential[mesh.gap] for sign, potential in potentials)
    on_lid[..., -1:] += mesh.incident(problem.seas, omega)
    area = mesh.part.faces_areas[mesh.gap][:, None]
    (sea,) = problem.seas
    arrival = sea.pressure(mesh.origin[None], omega)[0] / (density * G)
    whole = 1j * omega * forces[-1] + froude_krylov(hulls, problem.centres, problem.dofs, sea, np.array([omega]))[0]
    return Solved(
        damping=forces[:-1].imag * omega,
        force=whole / arrival,
        far=FarField(mesh.origin[:2], far[None, :-1], far[None, -1] / arrival),
        taken=density * omega * loss * np.einsum("gpi,gpj->ij", on_lid * area, on_lid.conj()),
        elevation=complex(
            (on_lid[..., -1:] * area).sum() / area.sum() / len(on_lid) * (1 + 1j * epsilon) * omega / (-1j * G)
        ),
    )


def of_scene(name, epsilon, omega, **how):
    hulls, centres, width, *_ = SCENES[name]
    return solved(hulls, tuple(map(tuple, centres)), width, epsilon, omega, **how)


# Scene, frequency [rad/s], least share of the bodies' heave damping that is the lid's, largest error of energy: half as
# large panels leave a quarter, and in the ring's narrow gap they are wider than it.
RINGING = [
    ("ring", 1.5, 0.25, 0.05),
    ("ring", 1.65, 0.7, 0.05),
    pytest.param("boxes", 1.9, 0.06, 0.03, marks=pytest.mark.slow),
    pytest.param("unequal", 1.9, 0.015, 0.04, marks=pytest.mark.slow),
]


@pytest.mark.parametrize(("name", "omega", "least", "error"), RINGING)
def test_what_no_wave_carries_off_the_lid_takes(name, omega, least, error):
    """B = ρω/8πN ∫ HH* dθ + ρω εK ∫ φφ* dS, entry by entry."""
    found = of_scene(name, 0.1, omega)
    sent = radiation_damping(found.far, np.array([omega]), depth=inf, density=RHO, gravity=G)[0]
    lost, own = found.taken[:-1, :-1].real, np.diag(found.damping)
    assert np.all((np.diag(lost) / own)[[1, 4]] > least)
    assert np.abs(sent + lost - found.damping).max() < error * own.max()
    assert np.all(np.abs(sent + lost - found.damping) < error * np.sqrt(np.outer(own, own)))
    assert np.linalg.eigvalsh(found.taken).min() > -1e-12 * np.abs(found.taken).max()


@pytest.mark.parametrize(("name", "omega", "least", "error"), RINGING)
def test_bodies_held_still_absorb_what_the_lid_takes(name, omega, least, error):
    """Of what they scatter; and Haskind's force is by the far field what it is by pressure."""
    found = of_scene(name, 0.1, omega)
    waves = Waves(
        omega=np.array([omega]), amplitude=np.ones(1, complex), modes=found.far.scattered, heading=HEADING, depth=inf,
        density=RHO, gravity=G,
    )  # fmt: skip
    taken, sent = found.taken[-1, -1].real / 2, waves.outgoing_power[0]
    assert taken > 0.01 * sent
    assert waves.absorbed_power[0] == approx(taken, abs=(0.02 if name == "ring" else 0.005) * sent)
    force = excitation(found.far, HEADING, density=RHO, gravity=G)[0]
    for kind in ([0, 1, 3, 4], [2, 5]):
        assert force[kind] == approx(found.force[kind], abs=error * np.abs(found.force[kind]).max())


@pytest.mark.slow
def test_the_piston_in_a_moonpool_in_closed_form():
    """Water in a narrow well: ζ (1 - K(1 + iε)Z) = (1 + iε)F, Z and F whatever ε is; where KZ = 1 as 1/(ε + K Im Z).

    Re Z is the draft and an open end: 0.6133a without flange (Levine and Schwinger 1948), 0.8217a with an endless one
    (King 1936); a = 1 m. Im Z is what it radiates, ½kA|F|² by Haskind, A = πa².
    """
    draft, omega = 2.0, 1.9
    pool = ring(((3.0, -draft), (3.0, 2.0), (1.0, 2.0), (1.0, -draft)))
    K, epsilon = omega**2 / G, np.array([0.02, 0.1, 0.3])
    zeta = np.array([solved((pool,), ((0, 0, 0),), 2.1, e, omega).elevation for e in epsilon])
    line = (1 + 1j * epsilon) / zeta  # (1 - KZ)/F - iε KZ/F
    slope = (line[2] - line[0]) / (epsilon[2] - epsilon[0])
    assert line[1] == approx(line[0] + slope * (epsilon[1] - epsilon[0]), rel=1e-3)
    F = 1 / (line[0] - slope * epsilon[0] + 1j * slope)
    Z = 1j * slope * F / K
    assert draft + 0.6133 < Z.real < draft + 0.8217
    assert Z.imag == approx(K * np.pi * abs(F) ** 2 / 2, rel=0.06)
    peak = np.abs((1 + 1j * epsilon) * F / (epsilon + K * Z.imag))
    assert np.abs(zeta) == approx(peak, rel=0.05)  # so near is 1.9 rad/s to KZ = 1
    assert np.abs(zeta[0] / zeta[2]) > 9


@pytest.mark.slow
def test_a_larger_damping_lowers_the_peak_where_it_is():
    omega = np.array([1.54, 1.62, 1.7])
    some = {"panels": 300, "refine": 1}
    curves = np.array([[of_scene("ring", e, w, **some).damping[4, 4] for w in omega] for e in (0.03, 0.06, 0.12)])
    assert np.all(np.diff(curves.max(axis=1)) < -0.3 * curves.max(axis=1)[:-1])
    assert len(set(curves.argmax(axis=1))) == 1 and 0 < curves[0].argmax() < len(omega) - 1


RUN = {"depth": inf, "density": RHO, "omega": np.array([1.7]), "panels": 108}


def solution(name, **how):
    hulls, centres, *_ = SCENES[name]
    return bem.solve(hulls, np.array(centres, float), **RUN, **how)


NAMES = ("added_mass", "radiation_damping", "diffraction")


@pytest.mark.parametrize("name", ["ring", "boxes"])
def test_symmetry_planes_change_nothing(monkeypatch, name):
    lidded, planes = solution(name, gap_damping=0.1, gap_width=SCENES[name][2]), meshes.mirror_planes
    monkeypatch.setattr(meshes, "mirror_planes", lambda *args: (planes(*args)[0], planes(*args)[1][:1]))
    whole = solution(name, gap_damping=0.1, gap_width=SCENES[name][2])
    # Lids cut by the planes have other panels: in the narrow ring, near its resonance, that is felt.
    for each in NAMES:
        a, b = getattr(whole, each), getattr(lidded, each)
        assert a == approx(b, abs=(0.05 if name == "ring" else 0.01) * np.abs(b).max()), each


def test_the_finest_mesh_stands_where_there_is_a_lid_and_nothing_changes_where_there_is_none():
    plain, lidded = solution("boxes"), solution("boxes", gap_damping=0.1, gap_width=0.8)
    none = solution("boxes", gap_damping=0.1, gap_width=0.3)
    for each in NAMES:
        assert np.array_equal(getattr(plain, each), getattr(none, each))
        assert not np.array_equal(getattr(plain, each), getattr(lidded, each))
    assert "finest of 2 meshes" in lidded.settings["method"] and "extrapolated" in none.settings["method"]
    assert (none.settings["gap_damping"], none.settings["gap_width"]) == (0.1, 0.3)
    hulls, centres, width, *_ = SCENES["boxes"]
    problem = bem.Problem.of(hulls, np.array(centres, float), **RUN, gap_damping=0.1, gap_width=width)
    ((finest, coarser),) = bem.part(problem)
    assert np.array_equal(lidded.added_mass, finest.impedance.real)
    assert np.array_equal(lidded.diffraction, finest.diffraction[:, 0])
    assert np.abs(lidded.error.diffraction) == approx(np.abs(finest.diffraction - coarser.diffraction)[:, 0] / 3)
    # Without waves at infinite frequency there is no damping either: of the finest mesh, too.
    assert lidded.added_mass_inf == approx(
        plain.added_mass_inf, rel=0.05, abs=0.05 * np.abs(plain.added_mass_inf).max()
    )
