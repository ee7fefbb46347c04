"""What lies below z = 0: exact for elements that the surface cuts, whatever the mesh."""

import numpy as np
import pytest

from solver.errors import InputError
from solver.structure import sections, statics, water

RHO, W = 1025.0, 9.81
COEFFICIENTS = {"drag_coefficient": 1.0, "inertia_coefficient": 1.8}


@pytest.fixture
def pile(line):
    """From 7.3 m under water to 4.7 m above: no mesh below has a node at the surface."""

    def build(n, start=(0.0, 0.0, -7.3), end=(0.0, 0.0, 4.7), **fields):
        return line(n, start=start, end=end, **COEFFICIENTS | fields)

    return build


def shift(model, axis):
    return np.tile(np.eye(6)[axis], len(model.xyz))


def rigid_turn(model, axis):
    """Rigid rotation by 1 rad (linearised) about an axis through the origin."""
    turns = np.tile(np.eye(3)[axis], (len(model.xyz), 1))
    return np.hstack([np.cross(np.eye(3)[axis], model.xyz), turns]).ravel()


@pytest.mark.parametrize("n", [1, 2, 5])
def test_added_mass_of_a_pile_is_that_of_its_wetted_length(pile, n):
    model = pile(n)
    Ma = water.added_mass(model, RHO)
    line = 0.8 * RHO * np.pi * 0.45**2 / 4
    for axis in (0, 1):
        assert shift(model, axis) @ Ma @ shift(model, axis) == pytest.approx(line * 7.3)
    assert shift(model, 2) @ Ma @ shift(model, 2) == pytest.approx(0, abs=1e-9)
    turn = rigid_turn(model, 1)
    assert turn @ Ma @ turn == pytest.approx(line * 7.3**3 / 3)  # ∫ z² dz
    assert shift(model, 0) @ Ma @ turn == pytest.approx(-line * 7.3**2 / 2)  # ∫ z dz


def cubic(model):
    """Sway x = (z + 7.3)³ with its slope: in the span of every mesh."""
    z = model.xyz[:, 2] + 7.3
    displacement = np.zeros((len(z), 6))
    displacement[:, 0], displacement[:, 4] = z**3, 3 * z**2
    return displacement.ravel()


@pytest.mark.parametrize("n", [1, 2, 5])
def test_added_mass_of_a_bent_pile_is_exact_in_any_mesh(pile, n):
    model = pile(n)
    line = 0.8 * RHO * np.pi * 0.45**2 / 4
    assert cubic(model) @ water.added_mass(model, RHO) @ cubic(model) == pytest.approx(line * 7.3**7 / 7)


def test_added_mass_of_an_inclined_pile_is_normal_to_it(pile):
    model = pile(3, start=(-3, 0, -4), end=(3, 0, 4))
    line = 0.8 * RHO * np.pi * 0.45**2 / 4
    normal = np.array([[0.64, 0, -0.48], [0, 1, 0], [-0.48, 0, 0.36]])
    Ma = water.added_mass(model, RHO)
    total = [[shift(model, i) @ Ma @ shift(model, j) for j in range(3)] for i in range(3)]
    assert np.array(total) == pytest.approx(line * 5 * normal, abs=1e-8)


@pytest.mark.parametrize("n", [1, 2, 5])
def test_buoyancy_of_a_pile_is_the_water_its_steel_displaces(pile, pipe, n):
    model = pile(n, start=(-3, 0, -4), end=(3, 0, 4))
    load = water.buoyancy_load(model, RHO, W)
    force = RHO * W * pipe.area * 5
    assert load @ shift(model, 2) == pytest.approx(force)
    assert load @ shift(model, 0) == pytest.approx(0, abs=1e-9)
    assert load @ rigid_turn(model, 1) == pytest.approx(1.5 * force)  # acts at x = -1.5, the middle of the wet part


def test_buoyancy_and_weight_cancel_when_steel_is_water(pile, steel):
    model = pile(4, end=(1, 2, -0.5))
    wet = water.buoyancy_load(model, steel.density, W)
    assert wet + statics.gravity_load(model, W) == pytest.approx(0, abs=1e-9)


def test_stations_stand_for_the_wetted_length_only(pile):
    at = water.stations(pile(5), 3)
    assert at.weight.sum() == pytest.approx(7.3)
    assert at.weight @ at.position[:, 2] ** 5 == pytest.approx(-(7.3**6) / 6)  # three points: order 5
    assert at.position[:, 2].max() < 0
    assert at.tangent == pytest.approx(np.tile([0, 0, 1], (len(at.weight), 1)))
    assert set(at.diameter) == {0.45}
    assert set(at.drag) == {1.0}
    assert set(at.inertia) == {1.8}
    assert np.unique(at.element).tolist() == [0, 1, 2, 3]  # the surface cuts element 3


@pytest.mark.parametrize("n", [1, 2, 5])
def test_stations_move_with_the_cubic_shape(pile, n):
    model = pile(n)
    at = water.stations(model, 4)
    fields = np.column_stack([cubic(model), rigid_turn(model, 1), shift(model, 1)])
    moved = at.project(fields)
    z = at.position[:, 2]
    assert moved[:, 0, 0] == pytest.approx((z + 7.3) ** 3)
    assert moved[:, :, 1] == pytest.approx(np.cross([0, 1, 0], at.position), abs=1e-12)
    assert moved[:, :, 2] == pytest.approx(np.tile([0, 1, 0], (len(z), 1)), abs=1e-12)


def nodal_load(at, load, size):
    """Σ w Nᵀ f (size, ...) [N, N m] of loads per length f (ns, 3, ...) [N/m]."""
    vector = np.zeros((size, *load.shape[2:]), load.dtype)
    np.add.at(vector, at.dofs, np.einsum("s,ska,sk...->sa...", at.weight, at.shape, load))
    return vector


def test_load_on_stations_does_the_work_of_the_stations(pile):
    model = pile(5)
    at = water.stations(model, 4)
    real, imaginary = np.random.default_rng(1).normal(size=(2, len(at.weight), 3, 5))
    load = real + 1j * imaginary  # five harmonics at once
    nodal = nodal_load(at, load, 6 * len(model.xyz))
    fields = np.column_stack([cubic(model), rigid_turn(model, 0)])
    work = np.einsum("s,skn,skm->mn", at.weight, load, at.project(fields))
    assert fields.T @ nodal == pytest.approx(work)


def test_a_member_at_the_surface_or_above_is_dry(line):
    for z in (0.0, 2.0):
        model = line(3, start=(0, 0, z), end=(12, 0, z), **COEFFICIENTS)
        assert len(water.stations(model, 2).weight) == 0
        assert abs(water.added_mass(model, RHO)).max() == 0
        assert not water.buoyancy_load(model, RHO, W).any()
    drowned = line(3, start=(0, 0, -1), end=(12, 0, -1), **COEFFICIENTS)
    assert water.stations(drowned, 2).weight.sum() == pytest.approx(12)


def test_direction_of_a_member_does_not_matter(pile):
    up, down = pile(4), pile(4, start=(0, 0, 4.7), end=(0, 0, -7.3), clamped=("end",))
    for model in (up, down):
        assert water.stations(model, 2).weight.sum() == pytest.approx(7.3)


def test_no_coefficients_no_stations_yet_buoyancy(line, pipe):
    model = line(4, start=(0, 0, -7.3), end=(0, 0, 4.7))
    assert len(water.stations(model, 2).weight) == 0
    assert water.buoyancy_load(model, RHO, W) @ shift(model, 2) == pytest.approx(RHO * W * pipe.area * 7.3)


def test_no_points_are_refused(pile):
    with pytest.raises(InputError, match=r"stations.points = 0: must be >= 1"):
        water.stations(pile(2), 0)


def test_nearly_the_same_pieces_are_the_same_stations(pile):
    model = pile(1)
    assert water.stations(model, 3, 3.0) is water.stations(model, 3, 3.001)
    assert water.stations(model, 3, 3.0) is not water.stations(model, 3, 1.0)


@pytest.mark.parametrize("longest", [np.inf, 3.0, 0.4])
def test_pieces_of_an_element_share_its_length_and_integrate_what_varies_within_them(pile, longest):
    model = pile(1)
    at = water.stations(model, 3, longest)
    depth = -at.position[:, 2]
    wet = at.weight.sum()
    assert wet == pytest.approx(water.stations(model, 3).weight.sum(), rel=1e-12)
    k = 1.5
    exact = (1 - np.exp(-k * wet)) / k
    missed = abs(at.weight @ np.exp(-k * depth) / exact - 1)
    assert missed < 1e-7 if longest < 1 else missed < 0.03 if longest < 4 else missed > 0.03


@pytest.mark.parametrize("n", [1, 3])
def test_flooded_piles_carry_their_water_across(pile, n):
    """ρ π d²/4 of the inner diameter over the wetted length, none of it along the pile; weight is as before."""
    plain, flooded = pile(n), pile(n, flooded=True)
    inner = RHO * np.pi / 4 * (0.45 - 2 * 0.012) ** 2
    M = water.inner_mass(flooded, RHO)
    for axis in (0, 1):
        assert shift(flooded, axis) @ M @ shift(flooded, axis) == pytest.approx(inner * 7.3)
    assert shift(flooded, 2) @ M @ shift(flooded, 2) == pytest.approx(0, abs=1e-9)
    assert rigid_turn(flooded, 1) @ M @ rigid_turn(flooded, 1) == pytest.approx(inner * 7.3**3 / 3)
    assert water.inner_mass(plain, RHO).nnz == 0
    assert water.buoyancy_load(flooded, RHO, W) == pytest.approx(water.buoyancy_load(plain, RHO, W))
    each = water.element_masses(flooded, RHO, np.arange(n)).sum(axis=0)
    assert np.tile([1, 0, 0, 0, 0, 0], 2) @ each @ np.tile([1, 0, 0, 0, 0, 0], 2) == pytest.approx(
        (inner + 0.8 * RHO * np.pi / 4 * 0.45**2) * 7.3
    )


def test_sealed_piles_displace_their_outer_volume(pile):
    sealed = pile(3, flooded=False)
    lift = water.buoyancy_load(sealed, RHO, W).reshape(-1, 6).sum(axis=0)
    assert lift[2] == pytest.approx(RHO * W * np.pi / 4 * 0.45**2 * 7.3)
    assert water.inner_mass(sealed, RHO).nnz == 0


def test_only_tubes_are_flooded(line):
    with pytest.raises(InputError, match=r"members\.pile\.flooded = True: is of tubes"):
        line(1, section=sections.solid_rectangle(0.2, 0.3), flooded=True)
