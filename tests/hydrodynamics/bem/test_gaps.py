"""Damping lids on water in gaps and wells: where they lie, whose energy they take, and how much."""

from dataclasses import dataclass
from functools import cache
from math import inf

import numpy as np
import pytest
from pytest import approx

from solver.hydrodynamics.bem import bem
from solver.hydrodynamics.bem.far_field import FarField, Waves, excitation, radiation_damping
from solver.hydrodynamics.bem.green import green_function, joined, own_influence
from solver.hydrodynamics.bem.mean_hull import froude_krylov
from solver.hydrodynamics.hull import mesh as meshes
from solver.hydrodynamics.hull import surface
from solver.hydrodynamics.hull.gaps import gaps
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
    cut = surface.area_vectors(surface.triangles(surface.divided(panels, 3)))
    assert cut[:, 2].sum() == approx(down[:, 2].sum(), rel=1e-12) and np.all(cut[:, 2] < 0)
    assert not len(gaps(hulls, at, {"ring": 0.42, "boxes": 0.58, "unequal": 0.48}[name], side))


def test_a_well_is_a_gap_as_wide_as_its_diameter():
    well = ring(((10.0, -3.0), (10.0, 2.0), (2.0, 2.0), (2.0, -3.0)))
    here = np.zeros((1, 3))
    area = -surface.area_vectors(surface.triangles(gaps((well,), here, 4.1, 0.6)))[:, 2].sum()
    assert area == approx(4 * np.pi, rel=1e-4)
    assert not len(gaps((well,), here, 3.9, 0.6))
    assert not len(gaps((SPAR,), here, 50.0, 0.6))  # a hull's outside is no gap, nor is water between bodies far apart
    assert not len(gaps((SPAR, SPAR), np.array([[0, 0, 0], [12.0, 0, 0]]), 3.0, 0.6))


@pytest.mark.parametrize("k", [0.24, 4.0])
@pytest.mark.parametrize("depth", [inf, 8.0])
def test_a_panel_in_still_water_on_itself(k, depth):
    """As 81 smaller panels on the middle one's middle, whose own part is a hundredth."""

    def square(n):
        x = np.linspace(-0.25, 0.25, n + 1)
        corners = [[(a, c), (a, d), (b, d), (b, c)] for a, b in zip(x, x[1:]) for c, d in zip(x, x[1:])]
        vertices = np.pad(np.array(corners).reshape(-1, 2), ((0, 0), (0, 1)))
        return joined([(vertices, np.arange(4 * n * n).reshape(-1, 4))])

    whole, fine = square(1), square(9)
    how = {"water_depth": depth, "wavenumber": k, "adjoint_double_layer": False}
    row = green_function().evaluate(fine, fine, **how)[0][40]
    row[40] = own_influence(fine, k, depth)[40]
    assert own_influence(whole, k, depth)[0] == approx(row.sum(), rel=0.06 if k > 1 else 2e-3)


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
    build = bem._Mesh.build
    mesh = build(hulls, problem.centres, problem.dofs, problem.counts, refine, inf, lids=True, gap_width=width)
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
        elevation=complex((on_lid[..., -1:] * area).sum() / area.sum() / len(on_lid) * (1 + 1j * epsilon) * omega / (-1j * G)),
    )


RINGING = [("ring", 1.5, 0.3), ("ring", 1.65, 0.7), ("boxes", 1.9, 0.06), ("unequal", 1.9, 0.015)]


@pytest.mark.parametrize(("name", "omega", "least"), RINGING)
def test_what_no_wave_carries_off_the_lid_takes(name, omega, least):
    """B = ρω/8πN ∫ HH* dθ + ρω εK ∫ φφ* dS, least: the lid's share of a body's in heave, at least."""
    hulls, centres, width, *_ = SCENES[name]
    found = solved(hulls, tuple(map(tuple, centres)), width, 0.1, omega)
    sent = radiation_damping(found.far, np.array([omega]), depth=inf, density=RHO, gravity=G)[0]
    lost = found.taken[:-1, :-1].real
    heave = [1, 4]
    assert np.all(np.diag(lost)[heave] > least * np.diag(found.damping)[heave])
    size = np.sqrt(np.outer(*2 * [np.diag(found.damping)]))
    # Half as large panels: a quarter. In the ring's narrow gap they are wider than it.
    error = np.abs(sent + lost - found.damping) / size
    assert error.max() < (0.05 if name == "ring" else 0.008)
    assert np.linalg.eigvalsh(found.taken).min() > -1e-9 * np.abs(found.taken).max()


@pytest.mark.parametrize(("name", "omega", "least"), RINGING)
def test_bodies_held_still_absorb_what_the_lid_takes(name, omega, least):
    hulls, centres, width, *_ = SCENES[name]
    found = solved(hulls, tuple(map(tuple, centres)), width, 0.1, omega)
    waves = Waves(
        omega=np.array([omega]), amplitude=np.ones(1, complex), modes=found.far.scattered, heading=HEADING, depth=inf,
        density=RHO, gravity=G,
    )  # fmt: skip
    taken = found.taken[-1, -1].real / 2
    print(name, omega, waves.absorbed_power / taken, taken / waves.outgoing_power)
    force = excitation(found.far, HEADING, density=RHO, gravity=G)[0]
    print(np.abs(force - found.force) / np.abs(found.force), np.abs(found.force).round())


def test_pis():
    pool = ring(((3.0, -6.0), (3.0, 2.0), (1.0, 2.0), (1.0, -6.0)))
    for omega in (1.05, 1.15, 1.2, 1.3):
        w = {e: solved((pool,), ((0, 0, 0),), 2.1, e, omega, panels=300).elevation for e in (0.02, 0.1, 0.3)}
        K = omega**2 / G
        print(omega, w)
        # w = F (1+ie)/(1-K(1+ie)Z): two unknowns of two
        (a, b, c) = w
        q = {e: (1 + 1j * e) / w[e] for e in w}  # = (1 - K(1+ie)Z)/F: linear in ie
        slope = (q[c] - q[a]) / (1j * (c - a))  # -KZ/F
        one = q[a] - 1j * a * slope  # (1-KZ)/F
        F = 1 / (one - slope)
        Z = -slope * F / K
        print("predicted", (q[a] + (q[c] - q[a]) * (b - a) / (c - a)) / q[b], "Z", Z, "closed", 6 + 0.8217, "F", F, np.exp(-6 * K))
