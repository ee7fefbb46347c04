"""Utilisation of tubes by NORSOK N-004, 6.3: its formulas at their ends, by hand, and as an output."""

from dataclasses import replace

import numpy as np
import pytest
from pytest import approx

from solver.coupled import support
from solver.coupled.blocks import blocks
from solver.coupled.places import Places
from solver.coupled.preparation import prepare
from solver.errors import InputError
from solver.oddities import warnings
from solver.record.steel import Steel
from solver.record.utilisation import bending_utilisation, shear_utilisation
from solver.run import simulate
from solver.scene import Platform, Scene, Settings, Utilisation, Water
from solver.structure import tubular
from solver.structure.frame import Frame
from solver.structure.members import Material, Member, PointLoad
from solver.structure.sections import solid_rectangle, tube
from tests.awkward import bare_legs, raking, scene, sea

FY, E = 355e6, 2.1e11
STEEL = Material(E=E, G=8.08e10, density=7850.0, yield_strength=FY)


def member(D=0.508, t=0.016, **changes):
    fields = {"name": "brace", "start": "a", "end": "b", "elements": 1, "section": tube(D, t), "material": STEEL}
    return Member(**{**fields, **changes})


def used(N, My=0.0, Mz=0.0, length=6.0, factor=1.15, **changes):
    return use_of(tubular.resistance(member(**changes), length, factor), N, My, Mz)


def use_of(resistance, *along):
    of = tubular.Resistance(*map(np.atleast_1d, resistance))
    return float(bending_utilisation(np.array([along], float), np.arange(3)[None], np.array([1]), of)[0, 0])


def test_a_brace_by_hand():
    """508 x 16 mm, 355 MPa, 6 m: A = 24730.1 mm2, W = 2.94966e6 mm3, Z = 3.87430e6 mm3, i = 174.04 mm.

    f_cle = 3968.5 MPa and f_y/f_cle = 0.0895, so that f_cl = f_y; λ = 6000/(174.04 π) √(355/2.1e5) = 0.45119 and
    f_c = 334.77 MPa; f_y D/Et = 0.053673 and f_m = 0.991524 Z/W f_y.
    """
    A, Z = 24730.1e-6, 3.87430e-3
    M_Rd, M = 0.991524 * Z * FY / 1.15, np.hypot(80e3, 20e3)
    assert used(1.2e6, 80e3, 20e3) == approx((1.2e6 / (A * FY / 1.15)) ** 1.75 + M / M_Rd, rel=1e-4)
    N_c, N_E = A * 334.765e6 / 1.15, np.pi**2 * E * A / (6000 / 174.04) ** 2
    column = 1.2e6 / N_c + 0.85 * M / (1 - 1.2e6 / N_E) / M_Rd
    local = 1.2e6 / (A * FY / 1.15) + M / M_Rd
    assert used(-1.2e6, 80e3, 20e3, moment_factor=0.85) == approx(max(column, local), rel=1e-4)
    assert used(-1.2e6, 80e3, 20e3, moment_factor=0.1) == approx(local, rel=1e-4)  # eq. 6.28 where 6.27 is less


def test_the_largest_of_all_points_of_each_tube():
    """Two tubes of two and three points, their forces anywhere among others."""
    rng = np.random.default_rng(3)
    tubes = [tubular.resistance(member(), 6.0, 1.15), tubular.resistance(member(D=0.3, t=0.02), 9.0, 1.15)]
    along = rng.permutation(18)[:15].reshape(5, 3)
    y = rng.normal(size=(40, 18)) * 2e5
    of = tubular.Resistance(*map(np.array, zip(*tubes, strict=True)))
    found = bending_utilisation(y, along, np.array([2, 3]), of)
    for k, points in enumerate((along[:2], along[2:])):
        each = [[use_of(tubes[k], *row[point]) for point in points] for row in y]
        assert found[:, k] == approx(np.max(each, axis=1))
        assert len(set(np.argmax(each, axis=1))) == len(points)


def test_the_ends_of_its_formulas():
    """Squash load, Euler's with 0.9, the plastic moment; tension counts by its power 1.75."""
    A = tube(0.508, 0.016).area
    assert used(-A * FY / 1.15, length=1e-3) == approx(1.0, rel=1e-6)
    far = tubular.resistance(member(), 40.0, 1.15)
    assert far.column == approx(0.9 * far.euler / 1.15)
    stout = member(D=0.3, t=0.02)
    plastic = (0.3**3 - 0.26**3) / 6 * FY
    assert tubular.resistance(stout, 5.0, 1.15).bending == approx(plastic / 1.15)
    assert used(0.5 * A * FY / 1.15) == approx(0.5**1.75)
    assert used(1.0, 3e5, 4e5) == approx(used(1.0, 0.0, 5e5)) == approx(used(1.0, -5e5, 0.0))
    assert 1 < used(-float(far.euler), length=40.0) < 2
    assert np.isfinite(used(-2 * float(far.euler), 1e4, length=40.0))


def test_a_published_worked_example():
    """Two tubes of a joint, S355, γ_M 1.15: `BENCHMARK.md` of IDEA StatiCa's public Norsok checker, second example."""
    jacket = tubular.resistance(member(D=0.1683, t=0.008), 6.0, 1.15)
    brace = tubular.resistance(member(D=0.1397, t=0.008, moment_factor=0.85), 0.7 * 5.0, 1.15)
    N_t, M_Rd, V = (float(x) / 1e3 for x in (jacket.tension, jacket.bending, jacket.shear))
    assert (N_t, M_Rd, V) == approx((1243.67, 63.51, 359.02), rel=2e-4)
    N_c, M_Rd, V = (float(x) / 1e3 for x in (brace.column, brace.bending, brace.shear))
    assert (N_c, M_Rd, V) == approx((745.92, 42.89, 294.96), rel=2e-4)
    assert use_of(jacket, 250e3, 25e3, 0.0) == approx(0.454, abs=5e-4)
    assert use_of(brace, -150e3, 25e3, 0.0) == approx(0.766, abs=5e-4)
    assert float(shear_utilisation(*map(np.array, (0.0, -60e3, 0.0)), jacket)) == approx(0.167, abs=5e-4)


def sheared(Vy, Vz, T, **changes):
    return float(shear_utilisation(*map(np.array, (Vy, Vz, T)), tubular.resistance(member(**changes), 6, 1.15)))


def test_shear_and_torsion_yield_the_wall():
    """V/(A/2) and T D/2Ip reach f_y/√3 γ_M; of thin walls these are the largest stresses of shear V/πRt, T/2πR²t."""
    D, t, limit = 0.508, 0.016, FY / np.sqrt(3) / 1.15
    assert sheared(3e5, -4e5, 0.0) == approx(2 * 5e5 / tube(D, t).area / limit)
    assert sheared(0.0, 0.0, -1e6) == approx(1e6 * (D / 2) / (np.pi / 32 * (D**4 - (D - 2 * t) ** 4)) / limit)
    assert sheared(5e5, 0.0, 1e6) == max(sheared(5e5, 0.0, 0.0), sheared(0.0, 0.0, 1e6))
    R = (1.0 - 0.01) / 2
    thin = {"D": 1.0, "t": 0.01, "material": replace(STEEL, yield_strength=1e8)}
    limit = 1e8 / np.sqrt(3) / 1.15
    assert sheared(1e5, 0.0, 0.0, **thin) == approx(1e5 / (np.pi * R * 0.01) / limit, rel=1e-9)
    assert sheared(0.0, 0.0, 1e5, **thin) == approx(1e5 / (2 * np.pi * R**2 * 0.01) / limit, rel=0.02)


def test_likenesses_are_utilised_alike():
    """Twice as large, of the same steel: stresses are the same under four times the force, eight times the moment."""
    for N in (1.2e6, -1.2e6):
        small, large = used(N, 8e4, 2e4, length=6.0), used(4 * N, 64e4, 16e4, length=12.0, D=1.016, t=0.032)
        assert large == approx(small)
    assert sheared(4e5, 8e5, 16e5, D=1.016, t=0.032) == approx(sheared(1e5, 2e5, 2e5))


@pytest.mark.parametrize(
    ("of", "where", "jump"),
    [
        (lambda r: tubular.local_strength(FY, FY / (0.6 * r), 1.0, 1.0), 0.170, 1e-3),
        (lambda r: tubular.local_strength(FY, FY / (0.6 * r), 1.0, 1.0), 1.911, 1e-3),
        (lambda r: tubular.column_strength(FY, FY / r**2), 1.34, 1e-2),
        (lambda r: tubular.bending_strength(FY, FY * 60 / r, 60.0, 1.0), 0.0517, 4e-3),
        (lambda r: tubular.bending_strength(FY, FY * 60 / r, 60.0, 1.0), 0.1034, 4e-3),
    ],
)
def test_formulas_meet_where_they_change(of, where, jump):
    below, above = (of(where * (1 + e)) for e in (-1e-9, 1e-9))
    assert below == approx(above, rel=jump)
    assert of(where * 1.3) < 0.99 * of(where * 0.999)


@pytest.mark.parametrize(
    ("changes", "factor", "message"),
    [
        ({"D": 1.2, "t": 0.01}, 1.15, r"brace\.section\.thickness = 0.01: must be > 0.01 m, D/120"),
        ({"D": 0.048, "t": 0.0004}, 1.15, r"thickness = 0.0004: must be > 0.0004 m, D/120"),
        ({"D": 1.0, "t": 0.01}, 1.15, r"material_factor = 1.15: must be >= 1.45, N-004's largest"),
    ],
)
def test_what_n_004_is_not_for_is_refused(changes, factor, message):
    with pytest.raises(InputError, match=message):
        used(-1.0, factor=factor, **changes)
    assert used(-1.0, D=1.0, t=0.01, factor=1.45) > 0


def test_a_model_is_utilised_as_what_it_is_of():
    """At 1:50, of the same steel, by the squared scale in force and the cubed in moment, with a wall of 0.32 mm."""
    r = 1 / 50
    for N in (1.2e6, -1.2e6):
        full = used(N, 8e4, 2e4, length=6.0)
        small = used(N * r**2, 8e4 * r**3, 2e4 * r**3, length=6.0 * r, D=0.508 * r, t=0.016 * r)
        assert small == approx(full, rel=1e-12)
    assert sheared(4e5 * r**2, 8e5 * r**2, 16e5 * r**3, D=0.508 * r, t=0.016 * r) == approx(sheared(4e5, 8e5, 16e5))


def test_walls_thinner_than_n_004_has_them_are_told_once():
    """The thinnest that is utilised: not one whose yield strength nobody knows, nor where none is asked for."""
    frame = standing(D=0.1, t=0.005).platform.frame
    others = (
        member(name="strut", start="foot", end="top", section=tube(0.1, 0.004)),
        member(
            name="soft", start="foot", end="top", section=tube(0.1, 0.003), material=replace(STEEL, yield_strength=None)
        ),
        member(name="thick", start="foot", end="top"),
    )
    scenes = [
        replace(item, platform=replace(item.platform, frame=replace(frame, members=(*frame.members, *others))))
        for item in (standing(), standing(outputs=("section_forces",)))
    ]
    told, untold = ([text for text in warnings(item) if "N-004" in text] for item in scenes)
    assert len(told) == 1 and told[0].startswith("platform.members.strut.section.thickness = 0.004 and 1 more: N-004")
    assert not untold and not [text for text in warnings(standing(t=0.006)) if "N-004" in text]
    assert told[0] in simulate(scenes[0]).attrs["warnings"]


def standing(outputs=("utilisation",), material=STEEL, **changes):
    """A pile of two elements in air with a deck load that pushes and shoves."""
    pile = member(name="pile", start="foot", end="top", elements=2, material=material, **changes)
    frame = Frame(
        nodes={"foot": (0, 0, 1.0), "top": (0, 0, 9.0)}, members=(pile,), clamped=("foot",),
        loads=(PointLoad(node="top", force=(3e4, 4e4, -6e5)),),
    )  # fmt: skip
    settings = Settings(duration=5.0, discard=0.0, ramp=0.0, time_step=0.1, outputs=outputs)
    return Scene(water=Water(depth=50.0), platform=Platform(frame=frame, legs=("pile",)), settings=settings)


def test_a_pile_at_rest_is_utilised_at_its_foot():
    record = simulate(standing(buckling_length=16.0))
    dims, values = record.variables["utilisation"]
    assert dims == ("tube", "statistic") and record.coords["tube"].tolist() == ["pile"]
    weight = tube(0.508, 0.016).area * 7850 * 9.81 * 8
    expected = used(-6e5 - weight, 4e4 * 8, -3e4 * 8, length=16.0)
    assert values[0, [0, 1, 2]] == approx(np.full(3, expected), rel=1e-6)


def test_the_least_utilisation_is_that_of_a_sample():
    """A moment that passes zero has a corner there, below which parabolas would go."""
    item, _ = bare_legs()
    members = tuple(replace(m, material=replace(STEEL, G=8.33e10)) for m in item.platform.frame.members)
    frame = replace(item.platform.frame, members=members)
    settings = replace(item.settings, outputs=("utilisation",), keep_series=True, duration=100.0, discard=20.0)
    record = simulate(replace(item, platform=replace(item.platform, frame=frame), settings=settings))
    for name in ("utilisation", "shear_utilisation"):
        table, samples = record.variables[name][1], record.series[name][1]
        assert np.array_equal(table[:, 1], samples.min(axis=0))
        assert np.all(table[:, 0] >= samples.max(axis=0)) and np.any(table[:, 0] > samples.max(axis=0))


def test_tubes_are_utilised_by_their_section_forces():
    """Of legs with one element each, at every sample: the largest at both ends, of bending, of shear, of torsion."""
    item, _ = bare_legs()
    frame = item.platform.frame
    some = replace(STEEL, E=2.1e11, G=8.33e10)
    members = [replace(m, material=some, elements=1, moment_factor=0.85) for m in frame.members]
    members[1] = replace(members[1], material=replace(some, yield_strength=None))
    frame = replace(frame, members=tuple(members))
    settings = replace(item.settings, outputs=("section_forces", "utilisation"), time_step=0.1)
    system = prepare(replace(item, platform=replace(item.platform, frame=frame), settings=settings), None)
    steel = Steel(system.support.forces, settings)
    *_, (samples, output, _) = blocks(system, system.start(), 256)
    parts = output.dp, output.ddp, output.carried, output.drag
    y = steel.forces.of(samples[:, system.layout.forces], *parts) + steel.forces.at_rest
    names = dict(steel.channels(y))
    assert steel.places.checked == ("a", "c")
    for row, name in enumerate(("a", "c")):
        at = steel.places.members.index(name)
        (N, Vy, Vz), (T, My, Mz) = (
            np.moveaxis(names[name][:, at], -1, 0) for name in ("section_force", "section_moment")
        )
        leg = members[at]
        of = tubular.resistance(leg, frame.buckling_length(leg), 1.15)
        bent = [max(use_of(of, *end) for end in zip(*ends, strict=True)) for ends in zip(N, My, Mz, strict=True)]
        sheared = shear_utilisation(Vy, Vz, T, of)
        expected = np.maximum(bent, sheared.max(axis=1))
        assert names["utilisation"][:, row] == approx(expected)
        assert names["shear_utilisation"][:, row] == approx(sheared.max(axis=1))
        assert np.ptp(expected) > 0
        along = y[:, steel.places.columns.along]
        assert along[:, 2 * row : 2 * row + 2] == approx(np.stack([N, My, Mz], axis=-1), rel=1e-9, abs=1e-6)


def crossed():
    """Legs that are not planar and not alike, under a deck, in waves at an angle."""
    item = bare_legs()[0]
    steel = replace(STEEL, G=8.33e10)
    frame = replace(item.platform.frame, members=tuple(replace(m, material=steel) for m in item.platform.frame.members))
    settings = Settings(outputs=("utilisation",), time_step=0.1, duration=60.0)
    return replace(item, platform=replace(item.platform, frame=frame), settings=settings)


def test_mirrored_tubes_are_looked_at_once(monkeypatch):
    """Where all is symmetric, with the same answer as one by one; not those checked in other ways, nor unequal ones."""
    item, names = raking(), ("utilisation", "shear_utilisation")
    assert item.planar
    places = prepare(item, None).support.forces.places
    assert places.twin.tolist() == [0, 0, 1] and places.points.tolist() == [3, 3]
    once = simulate(item).variables
    assert prepare(raking(0.7), None).support.forces.places.twin.tolist() == [0, 1, 2]
    assert prepare(crossed(), None).support.forces.places.twin.tolist() == [0, 1, 2]
    support._reduced.cache_clear()
    monkeypatch.setattr(Places, "without_twins", lambda self, maps: (self, np.ones(maps.shape[1], bool)))
    each = simulate(item).variables
    support._reduced.cache_clear()
    for name in names:
        assert once[name][1] == approx(each[name][1], rel=1e-7) and np.ptp(each[name][1][0]) > 1e-3
        assert each[name][1][2] != approx(each[name][1][0], rel=1e-3)


def test_a_tube_that_is_pulled_is_no_twin_of_one_that_is_pressed():
    """By as much under whatever pushes, as two-force members across from each other are."""
    alone, pinned = standing(), ("My", "Mz")
    frame, struts = alone.platform.frame, {"left": (-8.0, 0.0, 9.0), "right": (8.0, 0.0, 9.0)}
    members = [
        member(D=0.1, t=0.004, name=name, start=name, end="top", start_release=pinned, end_release=pinned)
        for name in struts
    ]
    held = replace(
        frame, nodes=frame.nodes | struts, members=(*frame.members, *members), clamped=("foot", *struts),
        loads=(PointLoad(node="top", force=(2e5, 0.0, 0.0)),),
    )  # fmt: skip
    settings = replace(alone.settings, outputs=("utilisation", "section_forces"))
    record = simulate(replace(alone, platform=replace(alone.platform, frame=held), settings=settings))
    N = record.variables["section_force"][1][1:, 0, 0, 2]
    told = record.variables["utilisation"][1][1:, 2]
    assert N[0] == approx(-N[1], rel=1e-6) and N[0] > 5e4
    weight = [used(n, length=8.0, D=0.1, t=0.004) for n in N]
    assert told == approx(weight, rel=0.05) and told[1] > 2 * told[0]


@pytest.mark.parametrize("made", [raking, crossed])
def test_along_a_tube_goes_what_acts_on_it_alone(made):
    """Besides the forces at its start: no station's drag counts for two tubes, nor what the floats' hinges bear."""
    forces = prepare(made(), None).support.forces
    whole, *tubes = forces.parts
    assert len(tubes) == 3 * len(forces.places.points) > 3
    every = np.arange(len(forces.drag))
    each = [
        np.unique(np.concatenate([every[part.stations] for part in tubes[i : i + 3]])) for i in range(0, len(tubes), 3)
    ]
    assert all(some.size for some in each) and np.unique(np.concatenate(each)).size == sum(some.size for some in each)
    assert not any(forces.carried[:, part.kept].any() for part in tubes)
    assert set(np.concatenate(each)) <= set(np.flatnonzero(forces.drag[:, whole.kept].any(axis=1)))


def test_drag_across_an_upright_tube_bends_it_in_its_own_plane_alone():
    """And none stretches it; each plane's stations are neighbours, of which nothing is copied."""
    pile = standing(drag_coefficient=1.0, inertia_coefficient=2.0).platform
    frame = replace(pile.frame, nodes={"foot": (0, 0, -20.0), "top": (0, 0, 3.0)})
    item = scene([], depth=20.0, waves=sea(heading=0.5), platform=replace(pile, frame=frame), outputs=("utilisation",))
    forces = prepare(item, None).support.forces
    _, axial, *planes = forces.parts
    assert np.size(axial.stations) == 0
    one, other = sorted((part.stations for part in planes), key=lambda part: part.start)
    assert (one.start, one.stop, other.stop) == (0, other.start, len(forces.drag)) and other.start > 1


def test_a_stub_is_utilised_by_its_shear_and_a_crank_by_its_torsion():
    """A load beside a short tube: more than bending; the same at the end of an arm across it turns it."""
    item = standing()
    load = PointLoad(node="top", force=(4e6, 0.0, 0.0))
    stub = replace(item.platform.frame, nodes={"foot": (0, 0, 1.0), "top": (0, 0, 1.3)}, loads=(load,))
    table = {key: values[0, 2] for key, values in at_rest(item, stub)}
    assert table["utilisation"] == table["shear_utilisation"] == approx(sheared(4e6, 0.0, 0.0), rel=1e-6)
    arm = member(name="arm", start="top", end="tip", elements=1, section=solid_rectangle(0.6, 0.6))
    nodes = {"foot": (0, 0, 1.0), "top": (0, 0, 1.3), "tip": (2.0, 0, 1.3)}
    turned = replace(
        stub, nodes=nodes, members=(*stub.members, arm), loads=(replace(load, node="tip", force=(0, 1e6, 0)),)
    )
    table = {key: values[0, 2] for key, values in at_rest(item, turned)}
    assert table["shear_utilisation"] == approx(sheared(0.0, 0.0, 2e6), rel=1e-6)
    assert sheared(0.0, 0.0, 2e6) > sheared(1e6, 0.0, 0.0)


def at_rest(item, frame):
    """The utilisations of a frame in place of the scene's."""
    variables = simulate(replace(item, platform=replace(item.platform, frame=frame))).variables
    return [(key, variables[key][1]) for key in ("utilisation", "shear_utilisation")]


def test_scenes_without_what_it_needs_are_refused():
    with pytest.raises(InputError, match=r"outputs = utilisation: is of tubes whose material has a yield_strength"):
        standing(material=replace(STEEL, yield_strength=None))
    with pytest.raises(InputError, match="is of tubes whose material has a yield_strength"):
        standing(section=solid_rectangle(0.3, 0.3))
    with pytest.raises(
        InputError, match=r"pile\.material = E = 210 Pa, yield_strength = 3.55e\+08 Pa: must"
    ) as refused:
        standing(material=replace(STEEL, E=210.0))
    assert not refused.value.others
    with pytest.raises(InputError, match=r"thickness = 0.0008"):
        standing(section=tube(0.1, 0.0008))
    with pytest.raises(InputError, match=r"pile\.end_section = tube: must be left out for utilisation: 6\.5"):
        standing(end_section=tube(0.3, 0.02))
    item = standing(flooded=False)
    wet = {"foot": (0.0, 0.0, -1.0), "top": (0.0, 0.0, 9.0)}
    with pytest.raises(InputError, match=r"pile\.flooded = False: must be left out below still water"):
        replace(item, platform=replace(item.platform, frame=replace(item.platform.frame, nodes=wet)))
    with pytest.raises(InputError, match=r'outputs = utilisation: needs method = "time"'):
        Settings(method="frequency", froude_krylov="linear", outputs=("utilisation",))
    with pytest.raises(InputError, match=r"settings\.utilisation\.material_factor = 0.5: must be >= 1"):
        Utilisation(material_factor=0.5)
