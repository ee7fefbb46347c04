"""Large frames: few modes and the Euler load as LAPACK has them, of equal and nearly equal ones, too."""

from dataclasses import replace

import numpy as np
import pytest
from scipy import linalg

from solver.coupled.preparation import prepare
from solver.errors import InputError
from solver.record.audit import skipped
from solver.run import simulate
from solver.scene import Platform
from solver.structure import lanczos, modes, statics
from solver.structure.frame import Frame
from solver.structure.frame_model import assemble
from solver.structure.members import Member, PointLoad, PointMass
from solver.structure.sections import tube
from tests.awkward import bare_legs
from tests.structure.axial import pushed

W = 9.81
ROUNDING = 1e-6  # of K, whose entries are (200 elements)³ times a pile's stiffness, by one method or the other


@pytest.fixture
def by_lapack(monkeypatch):
    """What a function finds where all frames are small."""

    def found(of, *given):
        with monkeypatch.context() as patch:
            patch.setattr(lanczos, "DENSE", 10**6)
            return of(*given)

    return found


def piles(steel, section, count, elements, uneven=0.0):
    """Side by side, each by itself: 2 count modes at each bending frequency, or as near as their lengths are."""
    tall = 20 * (1 + uneven * np.random.default_rng(1).random(count))
    feet, tops = ({f"{k}{i}": (3.0 * i, 0, z) for i, z in enumerate(zs)} for k, zs in (("a", 0 * tall), ("b", tall)))
    members = tuple(
        Member(name=f"p{i}", start=f"a{i}", end=f"b{i}", elements=elements, section=section, material=steel)
        for i in range(count)
    )
    return assemble(Frame(nodes=feet | tops, members=members, clamped=tuple(feet)))


def tower(steel, section, bays, elements):
    """Square, with crossed braces that are all alike: pairs of sways, and clusters of braces that swing alone."""
    corners = [(2, 2), (-2, 2), (-2, -2), (2, -2)]
    nodes = {f"{b}{i}": (x, y, 4.0 * b) for b in range(bays + 1) for i, (x, y) in enumerate(corners)}
    thin, members = tube(0.2, 0.008), []
    for b in range(bays):
        for i, j in ((i, (i + 1) % 4) for i in range(4)):
            up, over, cross, back = (f"{b}{i}", f"{b + 1}{i}"), (f"{b + 1}{i}", f"{b + 1}{j}"), *_crossed(b, i, j)
            for (start, end), of in ((up, section), (over, thin), (cross, thin), (back, thin)):
                name = f"{start}-{end}"
                members.append(Member(name=name, start=start, end=end, elements=elements, section=of, material=steel))
    masses = tuple(PointMass(node=f"{bays}{i}", mass=2e4) for i in range(4))
    return assemble(Frame(nodes=nodes, members=tuple(members), clamped=("00", "01", "02", "03"), masses=masses))


def _crossed(b, i, j):
    return (f"{b}{i}", f"{b + 1}{j}"), (f"{b}{j}", f"{b + 1}{i}")


@pytest.mark.parametrize(
    "made",
    [
        lambda steel, pipe: piles(steel, pipe, 1, 200),
        lambda steel, pipe: piles(steel, pipe, 20, 10),
        pytest.param(lambda steel, pipe: piles(steel, pipe, 12, 20, 1e-9), marks=pytest.mark.slow),
        pytest.param(lambda steel, pipe: piles(steel, pipe, 12, 20, 1e-5), marks=pytest.mark.slow),
        lambda steel, pipe: tower(steel, pipe, 4, 4),
    ],
    ids=["a pair", "forty alike", "next to alike", "nearly alike", "tower"],
)
def test_few_modes_of_large_frames_are_the_lowest_of_all(steel, pipe, by_lapack, made):
    """Whatever is equal or next to it, in all directions and in a plane of symmetry; to the rounding of K."""
    model = made(steel, pipe)
    assert model.free.size > lanczos.DENSE
    for basis in (None, modes.symmetric_basis(model)):

        def lowest(count, basis=basis):
            whole = (model.K, model.M, count)
            return modes.modes(*whole[:2], model.free, count) if basis is None else modes.modes_in(basis, *whole)

        exact = by_lapack(lowest, 31).omega
        for count in (1, 2, 3, 6, 31):
            omega, shapes = lowest(count)
            assert omega == pytest.approx(exact[:count], rel=ROUNDING)
            assert shapes.T @ (model.M @ shapes) == pytest.approx(np.eye(count), abs=1e-9)
            strain = shapes.T @ (model.K @ shapes) / np.multiply.outer(omega, omega)
            assert strain == pytest.approx(np.eye(count), abs=1e-6)
    told = modes.frequencies(model.K, model.M, model.free)
    assert told == pytest.approx(by_lapack(modes.frequencies, model.K, model.M, model.free)[: modes.TOLD], rel=ROUNDING)


def test_they_are_the_same_to_the_bit(steel, pipe):
    model = tower(steel, pipe, 4, 4)
    (omega, shapes), again = (modes.modes(model.K, model.M, model.free, 6) for _ in range(2))
    assert np.array_equal(omega, again.omega) and np.array_equal(shapes, again.shapes)


def test_large_frames_buckle_at_the_same_load(steel, pipe, by_lapack):
    """A tower under its weight; a column that a stay pulls a thousand times as hard; pulled alone, with a lever."""
    model = tower(steel, pipe, 4, 4)
    weight = pushed(model, statics.gravity_load(model, W), statics.self_weight(model, W))
    factor = statics.buckling_factor(model, weight, W)
    assert factor == pytest.approx(by_lapack(statics.buckling_factor, model, weight, W), rel=ROUNDING)
    mast = Member(name="mast", start="foot", end="top", elements=150, section=pipe, material=steel)
    nodes = {"foot": (0, 0, 0), "top": (0, 0, 12), "low": (0, 0, -12)}
    stay = replace(mast, name="stay", start="low", end="foot", elements=60)
    held = {"low": (0, 0, 0, 1e9, 1e9, 1e9), "foot": (1e9, 1e9, 1e6, 1e9, 1e9, 1e9)}
    loads = PointLoad(node="low", force=(0, 0, -1e6)), PointLoad(node="top", force=(0, 0, -1e3))
    model = assemble(Frame(nodes=nodes, members=(mast, stay), foundation=held, loads=loads))
    load = pushed(model, statics.point_load(model))
    factor = statics.buckling_factor(model, load, W)
    assert 1e3 * factor == pytest.approx(np.pi**2 * steel.E * pipe.Iy / (4 * 12**2), rel=5e-2)  # on its springs
    assert factor == pytest.approx(by_lapack(statics.buckling_factor, model, load, W), rel=1e-5)
    lever = PointMass(node="end", mass=1.0, cog=(0, 0, -0.1))
    pulled = Frame(
        nodes={"start": (0, 0, 0), "end": (0, 0, 12)},
        members=(replace(mast, start="start", end="end", elements=200),),
        clamped=("start",),
        loads=(PointLoad(node="end", force=(0, 0, 1e3)),),
        masses=(lever,),
    )
    for frame in (pulled, replace(pulled, masses=())):
        model = assemble(frame)
        assert statics.buckling_factor(model, pushed(model, statics.point_load(model)), W) == np.inf


def test_a_large_frame_beyond_its_euler_load_is_refused(line, steel, pipe):
    euler = np.pi**2 * steel.E * pipe.Iy / (4 * 12.0**2)
    for times in (1.1, 9.5):  # and beyond the next one
        model = line(200, end=(0, 0, 12.0), loads=(PointLoad(node="end", force=(0, 0, -times * euler)),))
        load = pushed(model, statics.point_load(model))
        assert statics.buckling_factor(model, load, W) == pytest.approx(1 / times, rel=1e-4)
        softened = statics.with_geometric_stiffness(model, load, W)
        for either in (lambda *of: modes.modes(*of, 6), modes.frequencies):
            with pytest.raises(InputError, match=r"must be > 0: the frame buckles"):
                either(softened.K, softened.M, softened.free)


def with_elements(item, count, **settings):
    members = tuple(replace(m, elements=count) for m in item.platform.frame.members)
    platform = Platform(frame=replace(item.platform.frame, members=members), legs=item.platform.legs)
    given = {"method": "frequency", "froude_krylov": "linear", **settings}
    return replace(item, platform=platform, settings=replace(item.settings, **given))


def test_a_large_frame_takes_no_full_matrices(monkeypatch):
    """Three legs and their braces in irregular seas, by the same numbers as with few elements."""
    item, _ = bare_legs()
    few = simulate(with_elements(item, 16))

    def small(a, *more, **how):
        assert len(a) < 600
        return eigh(a, *more, **how)

    eigh = linalg.eigh
    monkeypatch.setattr(linalg, "eigh", small)
    many = simulate(large := with_elements(item, 250))
    assert large.platform.frame.freedoms > lanczos.DENSE
    std = [record.variables["top_displacement"][1] for record in (few, many)]
    assert std[1] == pytest.approx(std[0], rel=1e-3, abs=1e-3 * np.abs(std[0]).max())
    told = [record.variables["natural_frequency"][1] for record in (few, many)]
    assert told[1].size == modes.TOLD and told[1] == pytest.approx(told[0][: modes.TOLD], rel=1e-3)
    assert f"shapes for {large.platform.frame.freedoms}," in "; ".join(skipped(prepare(large, None)))


def test_all_modes_of_a_large_frame_are_refused(monkeypatch):
    item, _ = bare_legs()
    scene = with_elements(item, 4, modes="all")
    count = scene.platform.frame.freedoms
    assert count == assemble(scene.platform.frame).free.size
    monkeypatch.setattr(modes, "MOST", count - 1)
    with pytest.raises(InputError, match=rf"settings.modes = all: .* at most {count - 1} .* this one has {count}"):
        simulate(scene)
    simulate(replace(scene, settings=replace(scene.settings, modes=6)))


def test_twice_the_elements_of_a_frame_with_all_modes_may_be_too_many_for_them(monkeypatch):
    item, _ = bare_legs()
    scene = with_elements(item, 1, modes="all")
    told = simulate(scene).attrs["elements_effect"]
    monkeypatch.setattr(modes, "MOST", scene.platform.frame.freedoms)
    assert simulate(scene).attrs["elements_effect"] == pytest.approx(told, rel=1e-3)
