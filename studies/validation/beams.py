"""Natural frequencies and deflections of beams in closed form, and of the Buan platform (Table 3)."""

import numpy as np

from solver.structure import recovery, statics
from solver.structure.frame import Frame
from solver.structure.frame_model import FrameModel, assemble
from solver.structure.members import Material, Member, PointLoad, PointMass
from solver.structure.modes import modes
from solver.structure.sections import tube
from solver.structure.soil import Soil, SoilSpring
from studies.validation import drawing
from studies.validation.cases import buan
from studies.validation.checks import Check
from studies.validation.drawing import BLUE, MARK, ORANGE

STEEL = Material(E=2.1e11, G=8.33e10, density=7850.0)
PIPE = tube(0.1, 0.005)
LENGTH, ELEMENTS = 10.0, 20  # slender, as the theory wants it [m]
# Tip mass over the beam's: b1, b2 of ω = b² √(EI/mL⁴).
TIP_MASS = {
    0.0: (1.87510407, 4.69409113),
    0.5: (1.41996443, 4.11113339),
    1.0: (1.24791741, 4.03113944),
    5.0: (0.87002146, 3.94998049),
}
CLAMPED = (4.73004074, 7.85320462, 10.9956078)  # roots of cos b cosh b = 1
SLIDING = (2.36502037, 5.49780392)  # clamped at one end, free to move but not to turn at the other: tan b + tanh b = 0
TABLE_3 = (0.4026, 0.4059, 3.1132, 6.3066, 6.3739)  # Heo, Koo and Kim (2022) [rad/s]
UNIT = np.sqrt(STEEL.E * PIPE.Iy / (STEEL.density * PIPE.area)) / LENGTH**2


def beam(
    tip: float = 0.0, elements: int = ELEMENTS, clamped=("start",), section=PIPE, end_section=None, **more
) -> FrameModel:
    """A level pipe along x; tip: mass at its end over that of the pipe."""
    member = Member(
        name="pipe", start="start", end="end", elements=elements, section=section, end_section=end_section,
        material=STEEL,
    )  # fmt: skip
    pipe_mass = STEEL.density * PIPE.area * LENGTH
    masses = (PointMass(node="end", mass=tip * pipe_mass),) if tip else ()
    nodes = {"start": (0.0, 0.0, 0.0), "end": (LENGTH, 0.0, 0.0)}
    return assemble(Frame(nodes=nodes, members=(member,), clamped=clamped, masses=masses, **more))


def along(model: FrameModel, axes: tuple[int, ...], count: int, held: tuple[int, ...] = ()) -> np.ndarray:
    """Lowest frequencies [rad/s] of the motions `axes` of 0 … 5 at every node: a straight beam's do not mix.

    held: axes that the beam's end may not follow.
    """
    free = model.free[np.isin(model.free % 6, axes)]
    free = np.setdiff1d(free, 6 * model.node_index["end"] + np.array(held, int))
    return modes(model.K, model.M, free, count).omega


def closed_forms() -> list[Check]:
    """Bending with tip mass, clamped at both ends, axial, torsion; and a static load on any mesh."""
    # Hermite elements: (b/n)⁴/1440 of ω, 2e-6 at b = 4.7 and n = 20; 1e-5 for b.
    checks = []
    for tip, published in TIP_MASS.items():
        roots = np.sqrt(along(beam(tip), (2, 4), 2) / UNIT)
        checks += [
            Check(
                case="cantilever with tip mass", quantity=f"b{i}, tip mass / beam mass {tip:g}", ours=b,
                published=other, allowed=1e-5 * other,
            )
            for i, (b, other) in enumerate(zip(roots, published, strict=True), 1)
        ]  # fmt: skip
    fine = {"elements": 2 * ELEMENTS}  # higher modes
    both = along(beam(clamped=("start", "end"), **fine), (2, 4), 3)
    sliding = along(beam(**fine), (2, 4), 2, held=(4,))
    checks += [
        Check(case=case, quantity=f"b{i}", ours=b, published=other, allowed=1e-5 * other)
        for case, omega, exact_b in (("clamped at both ends", both, CLAMPED), ("clamped and sliding", sliding, SLIDING))
        for i, (b, other) in enumerate(zip(np.sqrt(omega / UNIT), exact_b, strict=True), 1)
    ]
    rod = np.sqrt(STEEL.E / STEEL.density) * np.pi / 2 / LENGTH
    shaft = np.sqrt(STEEL.G * PIPE.J / (STEEL.density * PIPE.Ip)) * np.pi / 2 / LENGTH
    for name, axis, exact in (("axial", 0, rod), ("torsion", 3, shaft)):
        # Linear elements: (π/2n)²/24 of ω, 2.6e-4 at n = 20.
        ours = along(beam(), (axis,), 1)[0]
        checks.append(
            Check(
                case="clamped and free", quantity=f"{name}, lowest [rad/s]", ours=ours, published=exact,
                allowed=3e-4 * exact, note="Linear shapes and their mass: (π/2n)²/24 = 2.6e-4 for n = 20 elements.",
            )
        )  # fmt: skip
    load = 1000.0
    for elements in (1, 7):
        model = beam(elements=elements, loads=(PointLoad(node="end", force=(0.0, 0.0, load)),))
        bent = statics.static(model, statics.point_load(model))[model.translations("end")[2]]
        exact = load * LENGTH**3 / (3 * STEEL.E * PIPE.Iy)
        quantity = f"tip deflection, {elements} element{'s' * (elements > 1)} [m]"
        checks.append(
            Check(case="cantilever, static", quantity=quantity, ours=bent, published=exact, allowed=1e-9 * exact)
        )
    return checks


def cones() -> list[Check]:
    """Solid cones: a tip's deflection FL³/3EI of the thick end times thick over thin; a pointed one on its base."""
    thick, thin, load = tube(0.4, 0.2), tube(0.2, 0.1), PointLoad(node="end", force=(0.0, 0.0, 1000.0))
    exact, checks = 2 * 1000.0 * LENGTH**3 / (3 * STEEL.E * thick.Iy), []
    for elements, allowed in ((10, 7e-3), (20, 2e-3)):
        model = beam(elements=elements, section=thick, end_section=thin, loads=(load,))
        bent = statics.static(model, statics.point_load(model))[model.translations("end")[2]]
        note = "Each element has the section of its middle: second order."
        quantity = f"tip deflection, {elements} elements [m]"
        checks.append(
            Check(
                case="cone to half its width", quantity=quantity, ours=bent, published=exact,
                allowed=allowed * exact, note=note,
            )
        )  # fmt: skip
    pointed = along(beam(elements=80, section=thick, end_section=tube(4e-5, 2e-5)), (2, 4), 2)
    unit = np.sqrt(STEEL.E * thick.Iy / (STEEL.density * thick.area)) / LENGTH**2
    for i, (ours, published) in enumerate(zip(pointed / unit, (8.719, 21.15), strict=True), 1):
        checks.append(
            Check(
                case="pointed cone (Cranch and Adler 1956)", quantity=f"ω{i} L²(ρA/EI)^½ of its base", ours=ours,
                published=published, allowed=2e-3 * published,
            )
        )  # fmt: skip
    return checks + tower()


def tower() -> list[Check]:
    """The land-based tower of NREL's 5-MW turbine (NREL/TP-500-38060, 2009): its tube tapers, and so does its wall."""
    steel = Material(E=2.1e11, G=8.08e10, density=8500.0)
    foot, top = tube(6.0, 1.3 * 0.027), tube(3.87, 1.3 * 0.019)
    member = Member(name="tower", start="foot", end="top", elements=20, section=foot, end_section=top, material=steel)
    model = assemble(
        Frame(nodes={"foot": (0.0, 0.0, 0.0), "top": (0.0, 0.0, 87.6)}, members=(member,), clamped=("foot",))
    )
    mass = -statics.gravity_load(model, 1.0)[2::6].sum()
    end = member.section_at(1.0)
    numbers = (
        ("mass [kg]", mass, 347460.0), ("mass per length of its top [kg/m]", steel.density * end.area, 2536.3),
        ("EI of its top [N m2]", steel.E * end.Iy, 1.158e11),
    )  # fmt: skip
    return [
        Check(case="NREL's 5-MW tower", quantity=quantity, ours=ours, published=published, allowed=1e-3 * published)
        for quantity, ours, published in numbers
    ]


def piles() -> list[Check]:
    """A long pile pushed at its head, in even soil (Hetényi 1946) and in one that stiffens (Matlock and Reese 1960)."""
    section, depth, elements, push = tube(1.0, 0.03), 60.0, 120, 3e5
    EI, k, slope = STEEL.E * section.Iy, 2e7, 5e6
    beta, T = (k / (4 * EI)) ** 0.25, (EI / slope) ** 0.2
    rest = {"axial": 1e5, "torsional": 1e5}
    even = (SoilSpring(depth=0.0, lateral=k, **rest),)
    stiffening = (SoilSpring(depth=0.0, lateral=0.0, **rest), SoilSpring(depth=depth, lateral=depth * slope, **rest))
    # Matlock and Reese's coefficients are of finite differences: exact ones are 2.429 and 0.772.
    published = (
        ("even soil, 2Hβ/k", even, k / (2 * push * beta), 1.0, 1e-4, beta / push, 0.3224),
        ("soil k = nz, HT³/EI", stiffening, EI / (push * T**3), 2.435, 3e-3, 1 / (push * T), 0.772),
    )
    checks = []
    for case, springs, per_shift, shift, allowed, per_moment, moment in published:
        member = Member(name="pile", start="tip", end="head", elements=elements, section=section, material=STEEL)
        nodes = {"tip": (0.0, 0.0, -depth), "head": (0.0, 0.0, 0.0)}
        loads = (PointLoad(node="head", force=(push, 0.0, 0.0)),)
        model = assemble(Frame(nodes=nodes, members=(member,), loads=loads, soil=Soil(seabed=0.0, springs=springs)))
        bent = statics.static(model, statics.point_load(model))
        forces = recovery.section_forces(model, bent, np.zeros((elements, 12)))
        head, most = bent[model.translations("head")[0]] * per_shift, np.abs(forces[:, 4]).max() * per_moment
        checks += [
            Check(
                case=f"pile in {case}",
                quantity="shift of its head",
                ours=head,
                published=shift,
                allowed=allowed * shift,
            ),
            Check(case=f"pile in {case}", quantity="most moment", ours=most, published=moment, allowed=2e-3 * moment),
        ]
    return checks


def table_3() -> list[Check]:
    """The five lowest modes of the platform in air."""
    model = assemble(buan("elastic-no-floats").platform.frame)
    omega = modes(model.K, model.M, model.free, 5).omega
    checks = []
    for i, (ours, published) in enumerate(zip(omega, TABLE_3, strict=True), 1):
        twist = i == 3
        # The paper gives neither the deck's sections nor where its mass sits, on which the twist hangs.
        checks.append(
            Check(
                case="Buan platform, Table 3", quantity=f"natural frequency {i} [rad/s]", ours=ours,
                published=published, allowed=(2e-2 if twist else 5e-3) * published,
                note="The twist hangs on where the deck's mass sits, which the paper does not give." * twist,
            )
        )  # fmt: skip
    figure, (left, right) = drawing.axes(2)
    ratio = 6 * np.linspace(0, 1, 41) ** 2
    curves = np.array([np.sqrt(along(beam(r), (2, 4), 2) / UNIT) for r in ratio]).T
    for i, (curve, colour) in enumerate(zip(curves, (BLUE, ORANGE), strict=True)):
        left.plot(ratio, curve, color=colour, lw=1.3, label=f"ours, b{i + 1}")
        left.plot(list(TIP_MASS), [b[i] for b in TIP_MASS.values()], "o", color=colour, label="closed form", **MARK)
    left.set(xlabel="tip mass over beam mass [-]", ylabel="b of ω = b²√(EI/mL⁴) [-]", title="Cantilever with tip mass")
    number = np.arange(1, 6)
    right.vlines(number, 0, omega, color=BLUE, lw=6, alpha=0.6, label="ours")
    right.plot(number, TABLE_3, "o", color=ORANGE, label="Heo et al. 2022, Table 3", **MARK)
    right.set(xlabel="mode", ylabel="natural frequency [rad/s]", title="Buan platform", ylim=(0, None), xticks=number)
    drawing.save(figure, "beams")
    return checks
