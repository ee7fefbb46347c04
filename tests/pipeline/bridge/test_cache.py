"""Coefficients survive the file bit for bit, complex parts and signs of zero included."""

from dataclasses import fields, replace
from types import MappingProxyType, SimpleNamespace
from unittest.mock import Mock

import numpy as np
import pytest

from pipeline.bridge import cache
from pipeline.bridge import engine as run
from solver.hydrodynamics.bem.coefficients import Hydrodynamics, MeshError
from solver.hydrodynamics.bem.far_field import FarField
from solver.hydrodynamics.radiation.memory import RadiationMemory


@pytest.fixture
def coefficients():
    rng = np.random.default_rng(1)
    force = rng.normal(size=(4, 6)) + 1j * rng.normal(size=(4, 6))
    force[0, 0] = complex(-0.0, 0.0)
    return Hydrodynamics(
        omega=np.linspace(0.5, 2, 4),
        added_mass=rng.normal(size=(4, 6, 6)),
        radiation_damping=rng.normal(size=(4, 6, 6)),
        added_mass_inf=rng.normal(size=(6, 6)),
        diffraction=force,
        froude_krylov=2 * force,
        hydrostatic_stiffness=rng.normal(size=(6, 6)),
        displaced_mass=np.array([2147.0, 2147.0]),
        buoyancy_centre=np.array([-0.375, -0.375]),
        centres=np.array([[-3.86, 0, 0], [3.86, 0, 0]]),
        depth=np.inf,
        density=1025.0,
        gravity=9.81,
        heading=0.0,
        dofs=("surge", "heave", "pitch"),
        settings=MappingProxyType({"panels": 432}),
        error=MeshError(
            added_mass=1e-3 * rng.normal(size=(4, 6, 6)),
            radiation_damping=1e-3 * rng.normal(size=(4, 6, 6)),
            added_mass_inf=1e-3 * rng.normal(size=(6, 6)),
            diffraction=1e-3 * force.conj(),
        ),
        memory=RadiationMemory(
            beta=force[0, :3] - 9,
            residue=rng.normal(size=(3, 6, 6)) + 1j * rng.normal(size=(3, 6, 6)),
            added_mass_inf=rng.normal(size=(6, 6)),
            error=1e-3,
        ),
        memory_tolerance=1e-2,
    )


def test_round_trip_is_bitwise(coefficients):
    again = cache.decode(cache.encode(coefficients))
    same(coefficients.memory, again.memory)
    assert [x.tobytes() for x in again.error] == [x.tobytes() for x in coefficients.error]
    same(replace(coefficients, memory=None, error=None), replace(again, memory=None, error=None))


def test_the_far_field_is_kept(coefficients):
    rng = np.random.default_rng(2)
    radiated, scattered = (rng.normal(size=shape) + 1j * rng.normal(size=shape) for shape in ((4, 6, 9), (4, 9)))
    far = FarField(np.array([1.0, -2.0]), radiated, scattered)
    again = cache.decode(cache.encode(replace(coefficients, far_field=far))).far_field
    assert [x.tobytes() for x in again] == [x.tobytes() for x in far]


@pytest.mark.parametrize("motions", [(), (("heave",), ("surge", "heave")), ((), ("heave",)), (("heave",), ())])
def test_the_motions_that_the_memory_is_of_are_kept(coefficients, motions):
    known = replace(coefficients, memory_motions=motions)
    assert cache.decode(cache.encode(known)).memory_motions == motions


@pytest.mark.parametrize("sizes", [(2, 4), (3, 0), (0, 0)])
def test_what_rings_is_kept_and_not_sought_again(coefficients, sizes):
    """A classic file has no arrays of no poles; one of an earlier version leaves them to whoever reads it."""
    rng = np.random.default_rng(3)
    rings = tuple(-rng.random(size) + 1j * rng.random(size) for size in sizes)
    again = cache.decode(cache.encode(replace(coefficients, rings=rings)))
    assert [(x.dtype, x.tobytes()) for x in again.rings] == [(x.dtype, x.tobytes()) for x in rings]
    assert again.ringing is again.rings[0] and again.shifted.ringing is again.rings[1]
    assert again.shifted.shifted.ringing is again.rings[1]
    assert cache.decode(cache.encode(coefficients)).rings is None


def test_coefficients_without_memory_have_none(coefficients):
    assert cache.decode(cache.encode(replace(coefficients, memory=None))).memory is None


def test_the_memory_of_what_does_not_move_is_none(coefficients):
    """A classic file has no arrays of no poles."""
    nothing = replace(coefficients.memory, beta=np.zeros(0, complex), residue=coefficients.memory.residue[:0])
    assert cache.decode(cache.encode(replace(coefficients, memory=nothing))).memory is None


def same(one, other):
    """All fields, bit for bit."""
    for field in fields(one):
        mine, theirs = getattr(one, field.name), getattr(other, field.name)
        pairs = zip(mine, theirs, strict=True) if isinstance(mine, MeshError) else [(mine, theirs)]
        for a, b in pairs:
            if isinstance(a, np.ndarray):
                assert (a.dtype, a.shape, a.tobytes()) == (b.dtype, b.shape, b.tobytes()), field.name
            else:
                assert a == b or (np.isnan(a) and np.isnan(b)), field.name


def test_a_damaged_file_is_not_used(coefficients, tmp_path):
    store = cache.Cache(tmp_path)
    data = bytearray(cache.encode(coefficients, "key"))
    store.put("key", bytes(data))
    assert store.get("key") == bytes(data)
    at = bytes(data).find(np.linspace(0.5, 2, 4).astype(">f8").tobytes())
    data[at + 6] ^= 1
    store.put("key", bytes(data))
    assert store.get("key") is None
    store.put("key", bytes(data[: len(data) // 2]))
    assert store.get("key") is None
    assert store.get("other") is None


def test_a_file_counts_under_its_own_name_alone(coefficients, tmp_path):
    """Copied over another's, also with the name in it overwritten, which breaks the checksum."""
    store, data = cache.Cache(tmp_path), cache.encode(coefficients, "0123456789abcdef")
    store.put("0123456789abcdef", data)
    store.put("fedcba9876543210", data)
    assert store.damaged() == {"fedcba9876543210"}
    assert store.get("fedcba9876543210") is None
    store.put("fedcba9876543210", data.replace(b"0123456789abcdef", b"fedcba9876543210"))
    assert store.damaged() == {"fedcba9876543210"}


def test_workers_write_the_key_into_the_file(coefficients, monkeypatch):
    monkeypatch.setattr(run, "_known", lambda geometries, _: [coefficients] * len(geometries))
    geometries = [SimpleNamespace(key=16 * digit) for digit in "ab"]
    for file, geometry in zip(run.coefficients(geometries, []), geometries, strict=True):
        cache.require_whole(file, geometry.key)


def test_a_file_found_whole_is_opened_again_only_if_it_is_another(coefficients, tmp_path):
    opened = []
    store = cache.Cache(tmp_path, lambda data, key: opened.append(key) or cache.require_whole(data, key))
    data = cache.encode(coefficients, "key")
    store.put("key", data)
    assert [store.damaged(), store.damaged()] == [set(), set()]
    assert opened == ["key"]
    store.put("key", data[:-1] + bytes([data[-1] ^ 1]))
    assert [store.damaged(), store.damaged()] == [{"key"}, {"key"}]
    store.path("key").unlink()
    store.path("key").mkdir()
    assert store.damaged() == {"key"}
    store.path("key").rmdir()
    assert store.damaged() == set()


def test_files_in_a_folder_for_reading_only_are_found_whole(coefficients, tmp_path, monkeypatch):
    store = cache.Cache(tmp_path)
    store.put("key", cache.encode(coefficients, "key"))
    monkeypatch.setattr(cache, "write_json", Mock(side_effect=PermissionError))
    assert store.damaged() == set()


def test_a_whole_file_that_lacks_something_is_not_used(coefficients, tmp_path, monkeypatch):
    """As another version of the program may leave one."""
    with monkeypatch.context() as patch:
        patch.setattr(cache, "SCALARS", cache.SCALARS[:-1])
        data = cache.encode(coefficients, "key")
    store = cache.Cache(tmp_path)
    store.put("key", data)
    assert store.get("key") is None
