"""Coefficient files: each format read, the same study the same answer, and misfits refused before anything runs."""

import importlib
import json
import subprocess
import sys
from dataclasses import replace

import netCDF4
import numpy as np
import pytest
import xarray as xr
from pydantic import TypeAdapter
from typer.testing import CliRunner

from pipeline.bridge import cache
from pipeline.bridge.engine import Engine, compute, share
from pipeline.bridge.engine import coefficients as file_of
from pipeline.bridge.geometry import geometry_of
from pipeline.bridge.given import capytaine, reading
from pipeline.bridge.hulls import hull
from pipeline.bridge.loading import load
from pipeline.bridge.preflight import judge
from pipeline.cli.cli import app
from pipeline.study.attachments import Attachment, CoefficientFile
from pipeline.study.reading import StudyError
from pipeline.tasks.tasklist import Tasks
from solver.errors import InputError
from solver.hydrodynamics import library
from solver.hydrodynamics.bem import radiated
from solver.hydrodynamics.bem.adopted import adopted
from solver.hydrodynamics.hull.revolution import Revolution
from solver.hydrodynamics.radiation.fitting import USUAL
from tests.once import solve

RHO, G, DEPTH = 1025.0, 9.81, 30.0
BALL = Revolution.hemisphere_cylinder(radius=1.0, height=0.6)
CENTRES = np.array([[-3.86, 0.0, 0.0], [3.86, 0.0, 0.0]])
SOLVER = {"time": "", "frequency": '[solver]\nmethod = "frequency"\nfroude_krylov = "linear"\n'}
STUDY = """
{coefficients}
{solver}
[water]
depth = 30.0
[waves]
band = [0.7, 3.0]
components = 40
[record]
duration = 60.0
discard = 20.0
ramp = 10.0
{floats}
[sea_states]
one = {{ Hs = 0.5, Tp = 5.0 }}
"""
FLOAT = """
[[floats]]
name = "{name}"
hull = {{ shape = "hemisphere-cylinder", radius = 1.0, height = 0.6 }}
mass = 2147.0
inertia = [859.0, 859.0, 859.0]
hinge = [{hinge}, 0.0, 2.6]
arm = [{arm}, 0.0, -2.6]
pto_damping = 100e3
"""
FLOATS = FLOAT.format(name="front", hinge=-1.5, arm=-2.36) + FLOAT.format(name="rear", hinge=1.5, arm=2.36)


@pytest.fixture(scope="module")
def ours():
    """Of the study's pair, in all motions."""
    omega = np.linspace(0.5, 7.5, 24)
    return solve((BALL, BALL), CENTRES, depth=DEPTH, density=RHO, gravity=G, omega=omega, planar=False, panels=108)


@pytest.fixture
def study(tmp_path):
    """A study beside a file of coefficients, as text."""

    def written(coefficients="", method="time", floats=FLOATS):
        line = f'coefficients = "{coefficients}"' if coefficients else ""
        path = tmp_path / "pair.toml"
        path.write_text(STUDY.format(coefficients=line, solver=SOLVER[method], floats=floats))
        return path

    return written


def only_task(path):
    (task,) = Tasks.of(load(path).content)
    return task


def answer(path):
    parameters = only_task(path).parameters
    geometry = [geometry_of(parameters)]
    (file,) = file_of(geometry, [share(geometry)])
    return compute(parameters, file)


def with_our_own(path, h):
    """The answer where the boundary elements give `h`, planar as the study is."""
    index = np.array([0, 2, 4, 6, 8, 10])
    both = (slice(None), index[:, None], index)
    planar = {n: getattr(h, n)[both] for n in ("added_mass", "radiation_damping")}
    planar |= {n: getattr(h, n)[:, index] for n in ("diffraction", "froude_krylov")}
    planar |= {n: getattr(h, n)[np.ix_(index, index)] for n in ("added_mass_inf", "hydrostatic_stiffness")}
    from solver.coupled.preparation import remembered

    parameters = only_task(path).parameters
    geometry = geometry_of(parameters)
    own = replace(h, **planar, dofs=("surge", "heave", "pitch"), error=None)
    memory = remembered(own, tuple(hull(body.hull) for body in geometry.bodies), USUAL, geometry.needed)
    known = replace(own, memory=memory, memory_tolerance=USUAL, memory_motions=geometry.needed)
    return compute(parameters, cache.encode(known, "own"))


def capytaine_file(path, h, names=("front", "rear"), form="NETCDF4", kept=range(12)):
    """A dataset as capytaine writes it: words for bodies, motions, complex numbers; a fixed body has no point."""
    kept = np.array(kept)
    with netCDF4.Dataset(path, "w", format=form) as data:
        labels = [f"{names[k // 6]}__{h.dofs[k % 6].capitalize()}" for k in kept]
        sizes = {"omega": len(h.omega) + 1, "wave_direction": 2, "complex": 2, "body": 2, "space_coordinate": 3}
        for name, size in {**sizes, "influenced_dof": len(kept), "radiating_dof": len(kept)}.items():
            data.createDimension(name, size)
        for name in ("influenced_dof", "radiating_dof"):
            data.createVariable(name, str, (name,))[:] = np.array(labels, object)
        put(data, "omega", ("omega",), np.append(h.omega, np.inf))
        put(data, "wave_direction", ("wave_direction",), [0.7, h.heading])
        moves = np.isin([0, 1], kept // 6)[:, None]
        put(data, "rotation_center", ("body", "space_coordinate"), np.where(moves, h.centres, np.nan))
        data.createVariable("body", str, ("body",))[:] = np.array(names, object)
        for name, value in {"water_depth": h.depth, "rho": h.density, "g": h.gravity}.items():
            put(data, name, (), value)
        A = np.concatenate([h.added_mass, h.added_mass_inf[None]])
        B = np.concatenate([h.radiation_damping, 0 * h.added_mass_inf[None]])
        dims = ("omega", "radiating_dof", "influenced_dof")
        put(data, "added_mass", dims, np.swapaxes(A, 1, 2)[:, kept[:, None], kept])
        put(data, "radiation_damping", dims, np.swapaxes(B, 1, 2)[:, kept[:, None], kept])
        for name, force in {"diffraction_force": h.diffraction, "Froude_Krylov_force": h.froude_krylov}.items():
            whole = np.full((2, len(h.omega) + 1, 2, 12), np.nan)
            whole[0, :-1, 1], whole[1, :-1, 1], whole[:, :-1, 0] = force.real, force.imag, 9.0
            put(data, name, ("complex", "omega", "wave_direction", "influenced_dof"), whole[..., kept])


def put(data, name, dims, values):
    data.createVariable(name, "f8", dims)[...] = values


def bemio_file(path, h, bare=False):
    """BEMIO's groups: rows (6, 12, nw) of each body without units, phases of Re{X exp(+iωt)}."""
    rho, g, w = h.density, h.gravity, h.omega
    force = (h.diffraction + h.froude_krylov).conj() / (rho * g)
    incident = h.froude_krylov.conj() / (rho * g)
    with netCDF4.Dataset(path, "w") as data:
        common = data.createGroup("simulation_parameters")
        for group, name, values in [
            (common, "w", w), (common, "rho", [rho]), (common, "g", [g]), (common, "water_depth", [h.depth]),
            (common, "wave_dir", [np.degrees(h.heading)]),
        ]:  # fmt: skip
            sized(group, name, values)
        for b in (0, 1):
            six = slice(6 * b, 6 * b + 6)
            body = data.createGroup(f"body{b + 1}")
            sized(body.createGroup("properties"), "cg", h.centres[b][None])
            body["properties"].createVariable("name", str, ())[...] = ("front", "rear")[b]
            coefficients = body.createGroup("hydro_coeffs")
            added, damping, excitation = (
                coefficients.createGroup(n) for n in ("added_mass", "radiation_damping", "excitation")
            )
            sized(added, "all", np.moveaxis(h.added_mass[:, six] / rho, 0, 2))
            if not bare:
                sized(added, "inf_freq", h.added_mass_inf[six] / rho)
                sized(coefficients, "linear_restoring_stiffness", h.hydrostatic_stiffness[six, six] / (rho * g))
            sized(damping, "all", np.moveaxis(h.radiation_damping[:, six] / (rho * w[:, None, None]), 0, 2))
            for group, values in ((excitation, force), (excitation.createGroup("froude-krylov"), incident)):
                sized(group, "re", values.real.T[six, None])
                sized(group, "im", values.imag.T[six, None])


def sized(group, name, values):
    values = np.asarray(values, float)
    for i, size in enumerate(values.shape):
        group.createDimension(f"{name}_{i}", size)
    group.createVariable(name, "f8", [f"{name}_{i}" for i in range(values.ndim)])[...] = values


def wamit_rows(h, L=1.0, kept=range(12)):
    """Lines of .1 and .3: numbers without units for a length scale L."""
    turns = np.arange(12) % 6 >= 3
    unit = h.density * L ** (3.0 + turns[:, None] + turns)
    force = (h.diffraction + h.froude_krylov).conj() / (h.density * h.gravity * L ** (2.0 + turns))
    pairs = [(i, j) for i in kept for j in kept]
    first = [f" 0.0 {i + 1} {j + 1} {h.added_mass_inf[i, j] / unit[i, j]:.9e}" for i, j in pairs]
    third = []
    for w, A, B, X in zip(h.omega, h.added_mass, h.radiation_damping, force, strict=True):
        head = f" {2 * np.pi / w:.9e}"
        first += [f"{head} {i + 1} {j + 1} {A[i, j] / unit[i, j]:.9e} {B[i, j] / unit[i, j] / w:.9e}" for i, j in pairs]
        third += [
            f"{head} 0.0 {i + 1} {abs(x):.9e} {np.degrees(np.angle(x)):.9e} {x.real:.9e} {x.imag:.9e}"
            for i, x in zip(kept, X[list(kept)], strict=True)
        ]
    return first, third


def wamit_files(folder, h, L=1.0, kept=range(12)):
    first, third = wamit_rows(h, L, kept)
    (folder / "pair.1").write_text("\n".join(first))
    (folder / "pair.3").write_text("\n".join(third))
    C = h.hydrostatic_stiffness / (h.density * h.gravity)
    (folder / "pair.hst").write_text("\n".join(f"{i + 1} {j + 1} {C[i, j]:.6e}" for i in range(12) for j in range(12)))


def on_own_axes(h, angles):
    """The same on axes of each body, turned in plan by its angle [deg]."""
    turn = np.eye(12)
    for at, angle in zip((0, 3, 6, 9), np.radians(angles).repeat(2), strict=True):
        turn[at : at + 2, at : at + 2] = [[np.cos(angle), np.sin(angle)], [-np.sin(angle), np.cos(angle)]]
    matrices = {n: turn @ getattr(h, n) @ turn.T for n in ("added_mass", "radiation_damping", "added_mass_inf")}
    return replace(h, **matrices, **{n: getattr(h, n) @ turn.T for n in ("diffraction", "froude_krylov")})


def wamit_out(path, h, L=2.0, water="", angles=(0.0, 0.0), kept=range(12), restoring=True, more=()):
    """The printed output for a length scale L, with the bodies' places and angles [deg]; phases have decimals here.

    more: lines after each period's exciting forces.
    """
    lines = [f" Gravity: {h.gravity}   Length scale: {L}", f" Water depth: {h.depth}   {water}"]
    for (x, y, z), angle in zip(h.centres, angles, strict=True):
        lines.append(f" XBODY = {x} YBODY = {y} ZBODY = {z} PHIBODY = {angle}")
    for C in np.diag(h.hydrostatic_stiffness)[2::6] / (h.density * h.gravity * L**2) if restoring else ():
        lines.append(f"    C(3,3),C(3,4),C(3,5): {C:12.5f}     0.00000     0.00000")
    words = [[line.split() for line in rows] for rows in wamit_rows(on_own_axes(h, angles), L, kept)]
    for period in dict.fromkeys(row[0] for row in words[0]):
        lines += [
            "",
            f" Wave period {'= zero' if period == '0.0' else f'(sec) = {period}'}   Wavenumber (kL) = 1",
            " ---",
        ]
        lines += ["", "    ADDED-MASS AND DAMPING COEFFICIENTS", "   I J A(I,J) B(I,J)", ""]
        lines += ["  ".join(row[1:]) for row in words[0] if row[0] == period]
        lines += ["", "", "", "    DIFFRACTION EXCITING FORCES AND MOMENTS", "", "  Wave Heading (deg) :  0", ""]
        lines += ["   I   Mod[Xh(I)]   Pha[Xh(I)]", ""]
        lines += ["  ".join(row[2:5]) for row in words[1] if row[0] == period]
        lines += more
    path.write_text("\n".join(lines))


def attached(path):
    return Attachment.of(path.name, path.read_bytes())


def close(given, h, *, rel):
    for name, value in {
        "omega": h.omega, "added_mass": h.added_mass, "radiation_damping": h.radiation_damping,
        "added_mass_inf": h.added_mass_inf, "excitation": (h.diffraction + h.froude_krylov)[:, None],
    }.items():  # fmt: skip
        theirs, order = getattr(given, name), np.argsort(given.omega)
        if theirs is None and name == "added_mass_inf":  # Nemoh's files have none
            continue
        theirs = theirs if name == "added_mass_inf" else theirs[order]
        theirs = theirs[:, -1:] if name == "excitation" else theirs
        assert np.abs(theirs - value).max() <= rel * np.abs(value).max(), name


def block(title, columns):
    """As WAMIT prints what it tells besides: by heading, in rows of the form that exciting forces have."""
    heading = ["", "  Wave Heading (deg) :  0", "", f"   I   Mod[{columns}]   Pha[{columns}]", ""]
    return ["", "", "", f"    {title}", *heading, *(f"  {i}  7.77E-01  {20 * i}" for i in range(1, 7))]


@pytest.mark.parametrize(
    "more",
    [
        block("RESPONSE AMPLITUDE OPERATORS", "RAO(I)"),
        block("SURGE, SWAY & YAW DRIFT FORCES (Momentum Conservation)", "F(I)"),
        block("HASKIND EXCITING FORCES AND MOMENTS", "Xh(I)"),
    ],
)
def test_what_wamit_prints_after_the_exciting_forces_is_none_of_them(ours, tmp_path, more):
    wamit_out(tmp_path / "pair.out", ours, more=more)
    close(reading.read(attached(tmp_path / "pair.out"), RHO, G), ours, rel=1e-6)


def test_coefficients_of_bodies_that_sail_are_refused(ours, tmp_path):
    capytaine_file(tmp_path / "pair.nc", ours)
    for speed in (0.0, 1.0):
        with netCDF4.Dataset(tmp_path / "pair.nc", "a") as data:
            variable = data["forward_speed"] if speed else data.createVariable("forward_speed", "f8", ())
            variable[...] = speed
        if speed == 0:
            close(reading.read(attached(tmp_path / "pair.nc"), RHO, G), ours, rel=1e-6)
    with pytest.raises(ValueError, match="forward_speed is not 0"):
        reading.read(attached(tmp_path / "pair.nc"), RHO, G)


def test_every_format_reads_back_what_was_written(ours, tmp_path):
    capytaine_file(tmp_path / "pair.nc", ours)
    bemio_file(tmp_path / "pair.h5", ours)
    wamit_files(tmp_path, ours)
    wamit_out(tmp_path / "pair.out", ours)
    wamit_out(tmp_path / "told.out", ours, water=f"Water density: {RHO}")
    (tmp_path / "own.nc").write_bytes(cache.encode(ours, "key"))
    for name in ("pair.nc", "pair.h5", "pair.out", "own.nc"):
        given = reading.read(run_of(tmp_path / name), RHO, G)
        close(given, ours, rel=1e-6)
        assert given.points == pytest.approx(CENTRES), name
        if name in ("pair.h5", "pair.out"):
            heave = np.diag(ours.hydrostatic_stiffness)[2::6]
            assert np.diagonal(given.stiffness)[2::6] == pytest.approx(heave, rel=1e-4), name
    bemio_file(tmp_path / "bare.h5", ours, bare=True)
    bare = reading.read(attached(tmp_path / "bare.h5"), RHO, G)
    assert bare.added_mass_inf is None and bare.stiffness is None
    texts = {k: (tmp_path / f"pair{k}").read_text() for k in (".1", ".3", ".hst")}
    whole = Attachment.of("pair.1", json.dumps(texts).encode())
    close(reading.read(whole, RHO, G), ours, rel=1e-6)
    close(reading.read(attached(tmp_path / "told.out"), 1000.0, G), ours, rel=1e-6)


@pytest.mark.parametrize("angles", [(22.9, 0.0), (0.0, 22.9), (-70.0, 149.0), (90.0, 180.0)])
def test_wamits_bodies_may_have_axes_turned_in_plan(ours, tmp_path, angles):
    rows = np.arange(0, 24, 6)
    names = ("omega", "added_mass", "radiation_damping", "diffraction", "froude_krylov")
    few = replace(ours, **{n: getattr(ours, n)[rows] for n in names})
    path = tmp_path / "pair.out"
    wamit_out(path, few, angles=angles)
    close(reading.read(attached(path), RHO, G), few, rel=1e-6)
    wamit_out(path, few, angles=angles, kept=(0, 1, 2, 6, 7, 8))
    force = (few.diffraction + few.froude_krylov)[::-1, [0, 1, 2, 6, 7, 8]]
    forces = reading.read(attached(path), RHO, G).excitation[:, 0]
    assert forces == pytest.approx(force, rel=0, abs=1e-6 * np.abs(force).max())
    wamit_out(path, few, angles=angles, kept=(0, 2, 4, 6, 8, 10))
    with pytest.raises(InputError, match="turned in plan need both of surge and sway, and of roll and pitch"):
        reading.read(attached(path), RHO, G)


def test_points_of_a_capytaine_file_go_by_the_bodies_names(ours, tmp_path):
    """Which need not be in the order in which its labels name them."""
    capytaine_file(tmp_path / "pair.nc", ours)
    with netCDF4.Dataset(tmp_path / "pair.nc", "a") as data:
        data["body"][:] = np.array(["rear", "front"], object)
        data["rotation_center"][:] = CENTRES[::-1]
    given = reading.read(attached(tmp_path / "pair.nc"), RHO, G)
    assert given.points == pytest.approx(CENTRES[::-1]) and given.bodies == ("rear", "front")
    assert given.columns[0] == (1, "surge")
    with netCDF4.Dataset(tmp_path / "one.nc", "w") as data:
        data.createVariable("body", str, ())[...] = "front"
        data.createDimension("space_coordinate", 3)
        put(data, "rotation_center", ("space_coordinate",), CENTRES[0])
        assert capytaine._points(data, ("",)) == pytest.approx(CENTRES[:1])


def nemoh_files(folder, h, about=-2.0, wrapped=False, kept=range(12)):
    """Nemoh's tables in `folder`/Results and Nemoh.cal above them; moments about a point `about` z."""
    kept = np.array(kept)
    low = np.eye(12)
    for b in (0, 1):  # a rotation about a point below moves the reference point
        low[6 * b : 6 * b + 2, 6 * b + 3 : 6 * b + 5] = [[0, -about], [about, 0]]
    A, B = (low.T @ x @ low for x in (h.added_mass, h.radiation_damping))
    (folder / "Results").mkdir(exist_ok=True)
    motion = "Motion of body {} in DoF {}"
    columns = {motion.format(j // 6 + 1, j % 6 + 1): np.stack([A[:, kept, j], B[:, kept, j]], -1) for j in kept}
    whole, incident = (polar(force @ low)[:, kept] for force in (h.diffraction + h.froude_krylov, h.froude_krylov))
    for name, zones in {
        "RadiationCoefficients.tec": columns.items(),
        "ExcitationForce.tec": [("Excitation force - beta = 0.000 deg", whole)],
        "FKForce.tec": [("FKforce - beta = 0.000 deg", incident)],
    }.items():
        lines = ['VARIABLES="w (rad/s)"', *(f'"a {j // 6 + 1} {j % 6 + 1}" "b"' for j in kept)]
        for title, values in zones:
            lines.append(f'Zone t="{title}",I= {len(h.omega)},F=POINT')
            for w, row in zip(h.omega, values, strict=True):
                words = [f"{x:.12e}" for x in (w, *row.ravel())]
                lines += [" ".join(words[:9]), " ".join(words[9:])] if wrapped else [" ".join(words)]
        (folder / "Results" / name).write_text("\n".join(lines) + "\n")
    case = ["--- Environment", f"{h.density} ! RHO", f"{h.gravity} ! G", f"{h.depth} ! DEPTH", "0. 0. ! XEFF YEFF"]
    case += ["--- Bodies", "2 ! Number of bodies"]
    for b, (x, y, _) in enumerate(h.centres):
        six = [f"1 {a} 0. 0. 0." for a in ("1. 0. 0.", "0. 1. 0.", "0. 0. 1.")]
        six += [f"2 {a} {x} {y} {about}" for a in ("1. 0. 0.", "0. 1. 0.", "0. 0. 1.")]
        told = [six[k % 6] for k in kept if k // 6 == b]
        case += ["--- Body", "a.dat", "4 1", *2 * [str(len(told)), *told], "1", "more"]
    (folder / "Nemoh.cal").write_text("\n".join([*case, "--- Load cases", "24 0.5 7.5"]))


FIXED = {  # of each format a file whose front or rear has no motions
    "pair.nc": lambda folder, h, kept: capytaine_file(folder / "pair.nc", h, kept=kept),
    "other.nc": lambda folder, h, kept: capytaine_file(folder / "other.nc", h, names=("a", "b"), kept=kept),
    "pair.1": lambda folder, h, kept: (wamit_files(folder, h, kept=kept), (folder / "pair.hst").unlink()),
    "pair.hst": lambda folder, h, kept: wamit_files(folder, h, kept=kept),
    "pair.out": lambda folder, h, kept: wamit_out(folder / "pair.out", h, kept=kept),
    "bare.out": lambda folder, h, kept: wamit_out(folder / "bare.out", h, kept=kept, restoring=False),
    "Results/RadiationCoefficients.tec": lambda folder, h, kept: nemoh_files(folder, h, kept=kept),
}


@pytest.mark.parametrize("name", FIXED)
@pytest.mark.parametrize("moves", [0, 1])
def test_a_fixed_body_needs_no_motions_in_a_file_wherever_it_comes(ours, tmp_path, name, moves):
    """Its forces alone are not known; the moments of the other one are about the point that its file tells."""
    kept = range(6 * moves, 6 * moves + 6)
    FIXED[name](tmp_path, ours, kept)
    given = reading.read(run_of(tmp_path / name), RHO, G)
    water = {"depth": DEPTH, "density": RHO, "gravity": G, "heading": 0.0, "planar": False}
    names, needed = ("front", "rear"), [ours.dofs if b == moves else () for b in (0, 1)]
    whole = adopted(given, (BALL, BALL), CENTRES, names, **water, needed=needed)
    both = (slice(None), np.array(kept)[:, None], np.array(kept))
    for one, other in (
        (whole.added_mass[both], ours.added_mass[both]),
        (whole.radiation_damping[both], ours.radiation_damping[both]),
        (whole.diffraction[:, kept], ours.diffraction[:, kept]),
    ):
        assert np.abs(one - other).max() <= 1e-6 * np.abs(other).max()
    assert not np.delete(whole.diffraction, kept, axis=1).any()
    uncounted = name in ("pair.1", "pair.hst") and not moves
    with pytest.raises(InputError, match="has 1 bodies, the" if uncounted else f"lacks surge of {names[1 - moves]}, "):
        adopted(given, (BALL, BALL), CENTRES, names, **water)


def test_a_file_that_counts_its_bodies_has_all_floats(ours, tmp_path):
    """A fixed float may not come on top of them: its boundary elements had no such body in the water."""
    for name in ("pair.out", "Results/RadiationCoefficients.tec"):
        FIXED[name](tmp_path, ours, range(12))
        given = reading.read(run_of(tmp_path / name), RHO, G)
        three, water = (BALL, BALL, BALL), {"depth": DEPTH, "density": RHO, "gravity": G, "heading": 0.0}
        needed = [ours.dofs, ours.dofs, ()]
        with pytest.raises(InputError, match="has 2 bodies, the study has 3 floats"):
            adopted(given, three, np.zeros((3, 3)), ("a", "b", "c"), **water, planar=False, needed=needed)


def polar(force):
    return np.stack([np.abs(force), np.angle(force)], -1)


def run_of(path):
    return TypeAdapter(CoefficientFile).validate_python(path.name, context={"folder": path.parent})


def test_nemohs_files_are_read_with_the_point_that_bodies_turn_about(ours, tmp_path):
    for wrapped in (False, True):
        nemoh_files(tmp_path, ours, wrapped=wrapped)
        given = reading.read(run_of(tmp_path / "Results" / "ExcitationForce.tec"), 1.0, 1.0)
        assert given.points == pytest.approx(CENTRES + np.array([0, 0, -2.0]))
        assert (given.depth, given.density, given.gravity) == (DEPTH, RHO, G)
        water = {"depth": DEPTH, "density": RHO, "gravity": G, "heading": 0.0, "planar": False}
        whole = adopted(given, (BALL, BALL), CENTRES, ("front", "rear"), **water)
        for name in ("added_mass", "radiation_damping", "diffraction"):
            value, expected = getattr(whole, name), getattr(ours, name)
            assert np.abs(value - expected).max() <= 1e-6 * np.abs(expected).max(), name


def test_capytaine_may_be_asked_for_the_waves_of_some_motions_alone(ours, tmp_path):
    """Loads along the others it gives all the same."""
    kept = np.array([0, 2, 4, 6, 8, 10])
    capytaine_file(tmp_path / "kept.nc", ours, kept=kept)
    capytaine_file(tmp_path / "whole.nc", ours)
    some = xr.load_dataset(tmp_path / "whole.nc", decode_cf=False).isel(radiating_dof=kept[::-1])
    some.to_netcdf(tmp_path / "some.nc")
    one, other = (reading.read(run_of(tmp_path / name), RHO, G) for name in ("kept.nc", "some.nc"))
    assert one.columns == other.columns and len(one.columns) == 6
    for name in ("added_mass", "radiation_damping", "excitation", "froude_krylov", "added_mass_inf"):
        assert np.array_equal(getattr(one, name), getattr(other, name)), name
    some.isel(radiating_dof=[0], influenced_dof=[1]).to_netcdf(tmp_path / "none.nc")
    with pytest.raises(InputError, match="radiates rear__Pitch and has loads along front__Sway alone"):
        reading.read(run_of(tmp_path / "none.nc"), RHO, G)


def test_what_capytaine_exports_in_nemohs_form_is_read(ours, tmp_path):
    """At four frequencies: it writes number by number."""
    kinds = ("omega", "added_mass", "radiation_damping", "diffraction", "froude_krylov")
    ours = replace(ours, **{name: getattr(ours, name)[::6] for name in kinds})
    motions = [f"{name}__{dof}" for name in ("front", "rear") for dof in ours.dofs]
    both = ("omega", "radiating_dof", "influenced_dof")
    data = xr.Dataset(
        {
            "added_mass": (both, np.swapaxes(ours.added_mass, 1, 2)),
            "radiation_damping": (both, np.swapaxes(ours.radiation_damping, 1, 2)),
            "diffraction_force": (("omega", "wave_direction", "influenced_dof"), ours.diffraction[:, None]),
            "Froude_Krylov_force": (("omega", "wave_direction", "influenced_dof"), ours.froude_krylov[:, None]),
        },
        coords={"omega": ours.omega, "wave_direction": [0.0], "radiating_dof": motions, "influenced_dof": motions},
    )
    library.capytaine()  # finds room for it first
    importlib.import_module("capytaine.io.legacy").write_dataset_as_tecplot_files(tmp_path, data)
    close(reading.read(run_of(tmp_path / "RadiationCoefficients.tec"), RHO, G), ours, rel=1e-5)


@pytest.mark.parametrize(
    ("file", "old", "new", "message"),
    [
        ("Nemoh.cal", "0. 0. ! XEFF", "5. 0. ! XEFF", "waves must be measured at the origin"),
        ("Nemoh.cal", "1 1. 0. 0.", "1 0.7 0.7 0.", "must be along or about x, y or z"),
        ("Nemoh.cal", "2 ! Number", "1 ! Number", "has 12 motions, Nemoh.cal has 6"),
        ("Results/ExcitationForce.tec", "w (rad/s)", "T (s)", r"must be over w \(rad/s\)"),
        ("Results/FKForce.tec", "beta = 0.000", "beta = 9.000", "has other directions"),
        ("Nemoh.cal", "9.81 !", "!", r"Nemoh\.cal line 3 must begin with 1 number, is ''"),
        ("Nemoh.cal", "1 1. 0. 0.", "1 x 0. 0.", r"Nemoh\.cal line 12 must begin with 7 numbers, is '1 x 0\. "),
        ("Nemoh.cal", "30.0 ! DEPTH", "nan ! DEPTH", r"Nemoh\.cal line 4 must begin with 1 number, is 'nan'"),
        ("Results/FKForce.tec", "beta = 0.000", "\n1.0", r"FKForce\.tec: below .* are no whole rows of 25 numbers"),
    ],
)
def test_nemohs_files_that_say_something_else_are_refused(ours, tmp_path, file, old, new, message):
    nemoh_files(tmp_path, ours)
    path = tmp_path / file
    path.write_text(path.read_text().replace(old, new, 1 if file != "Nemoh.cal" or "Number" in old else -1))
    with pytest.raises(InputError, match=message):
        reading.read(run_of(tmp_path / "Results" / "RadiationCoefficients.tec"), RHO, G)


@pytest.mark.parametrize(
    ("file", "lines", "message"),
    [
        ("Nemoh.cal", 12, r"Nemoh\.cal ends before all bodies, motions and forces"),
        ("Nemoh.cal", 0, r"Nemoh\.cal ends before"),
        ("Results/RadiationCoefficients.tec", 0, r"RadiationCoefficients\.tec has no blocks of numbers"),
        ("Results/ExcitationForce.tec", 13, r"ExcitationForce\.tec has no blocks of numbers"),
        ("Results/FKForce.tec", 14, r"FKForce\.tec must have the frequencies and 12 motions of Radiation"),
        ("Results/FKForce.tec", 15, r"FKForce\.tec: below 'Zone .* are no whole rows of 25 numbers"),
    ],
)
def test_nemohs_files_that_are_cut_off_are_named(ours, tmp_path, file, lines, message):
    nemoh_files(tmp_path, ours, wrapped=True)
    path = tmp_path / file
    path.write_text("\n".join(path.read_text().splitlines()[:lines]))
    with pytest.raises(InputError, match=message):
        reading.read(run_of(tmp_path / "Results" / "RadiationCoefficients.tec"), RHO, G)


@pytest.mark.parametrize("method", ["time", "frequency"])
def test_coefficients_of_our_own_give_the_same_answers(ours, study, tmp_path, method):
    capytaine_file(tmp_path / "pair.nc", ours)
    wamit_files(tmp_path, ours)
    expected = with_our_own(study(method=method), ours)
    for name in ("pair.nc", "pair.1"):
        record = answer(study(name, method))
        for variable in ("rotation", "absorbed_power", "hinge_force"):
            theirs, value = record.variables[variable][1], expected.variables[variable][1]
            assert np.abs(theirs - value).max() <= 2e-5 * np.abs(value).max(), (name, variable)


@pytest.mark.parametrize(
    ("settings", "refused"),
    [
        ("interaction = false", r"solver.interaction = false: must be true"),
        (
            "gap_damping = 0.1\ngap_width = 0.5",
            r"solver.gap_damping = 0.1: must be 0: `coefficients` from a file",
        ),
    ],
)
def test_settings_that_a_files_coefficients_cannot_follow_are_refused(ours, study, tmp_path, settings, refused):
    wamit_files(tmp_path, ours)
    path = study("pair.1", method="frequency")
    path.write_text(path.read_text().replace("[solver]", f"[solver]\n{settings}"))
    with pytest.raises(StudyError, match=refused):
        load(path)


def test_a_task_is_known_by_the_content_of_its_files(ours, study, tmp_path):
    before = only_task(study()).id
    wamit_files(tmp_path, ours)
    first = only_task(study("pair.1")).id
    assert first != before
    for kind in (".1", ".3", ".hst"):
        (tmp_path / f"pair{kind}").rename(tmp_path / f"other{kind}")
    assert only_task(study("other.1")).id == first == only_task(study("other.3")).id
    force = tmp_path / "other.3"
    force.write_text(force.read_text().replace("e-01", "e-02", 1))
    assert only_task(study("other.1")).id != first


def judged(path):
    read = load(path)
    with pytest.raises(StudyError) as caught:
        judge(read, Tasks.of(read.content), Engine())
    return str(caught.value)


def test_the_sign_of_time_is_told_as_each_format_has_it(ours, study, tmp_path):
    """Of the conjugate force; WAMIT and BEMIO need the sign that capytaine and Nemoh do not."""
    back = replace(ours, **{n: getattr(ours, n).conj() for n in ("diffraction", "froude_krylov")})
    wamit_files(tmp_path, back)
    wamit_out(tmp_path / "pair.out", back)
    bemio_file(tmp_path / "pair.h5", back)
    capytaine_file(tmp_path / "pair.nc", back)
    nemoh_files(tmp_path, back)
    for name in ("pair.1", "pair.out", "pair.h5", "pair.nc", "Results/RadiationCoefficients.tec"):
        other, needed = ("-", "+") if name in ("pair.1", "pair.out", "pair.h5") else ("+", "-")
        said = judged(study(name))
        assert f"other sign of time, Re{{X exp({other}iωt)}}, or of waves from the other side; " in said, name
        assert f"; Re{{X exp({needed}iωt)}} is needed" in said, name


def test_misfits_are_said_before_anything_runs(ours, study, tmp_path):
    wamit_files(tmp_path, ours)

    def turned(word):
        return str(-float(word))

    lines = [line.split() for line in (tmp_path / "pair.3").read_text().splitlines()]
    (tmp_path / "pair.3").write_text(
        "\n".join(" ".join([*row[:4], turned(row[4]), row[5], turned(row[6])]) for row in lines)
    )
    message = judged(study("pair.1"))
    assert "pair.toml: coefficients = pair.1: wave force is of the other sign of time" in message
    wamit_files(tmp_path, ours, L=2.0)
    assert "other units" in judged(study("pair.1"))
    wamit_files(tmp_path, ours)
    for low in (0.4, 0.05):  # of the second our own boundary elements could not be had
        path = study("pair.1")
        path.write_text(path.read_text().replace("band = [0.7, 3.0]", f"band = [{low}, 3.0]"))
        told = judged(path)
        assert "waves.band = [" in told and "must be within 0.5 to 7.5 rad/s, the frequencies of pair.1" in told
    sea = 'one = { kind = "regular", height = 0.1, period = 16.0 }'
    for band in ("", "band = [0.3, 3.0]"):
        path = study("pair.1")
        text = path.read_text().replace("one = { Hs = 0.5, Tp = 5.0 }", sea).replace("band = [0.7, 3.0]", band)
        path.write_text(text)
        told = "sea_states.one.period = 16.0: needs coefficients at [0.3927, 0.3927] rad/s, which must be within 0.5 to"
        assert told in judged(path)
    path.write_text(text.replace(sea, "one = { Hs = 0.5, Tp = 16.0 }").replace(band, ""))
    assert "sea_states.one.Tp = 16.0: needs coefficients at [0.2" in judged(path)
    path = study("pair.1", method="frequency")
    path.write_text(path.read_text().replace("[record]", "[record]\noutputs = ['drift']"))
    assert "record.outputs = drift: needs boundary elements" in judged(path)
    (tmp_path / "pair.3").unlink()
    assert "needs .1 and .3 (or .2) beside each other" in judged(study("pair.1"))


@pytest.mark.parametrize(
    ("row", "message"),
    [
        (lambda row: [], "lacks pitch of front"),
        (lambda row: [*row[:5], "nan", "nan"], ".3 line 5 has a number that is not finite"),
    ],
)
def test_a_force_that_a_file_lacks_is_not_taken_for_none(ours, study, tmp_path, row, message):
    """Of the front float's pitch in all periods, which added mass has."""
    wamit_files(tmp_path, ours)
    rows = [line.split() for line in (tmp_path / "pair.3").read_text().splitlines()]
    (tmp_path / "pair.3").write_text("\n".join(" ".join(row(words) if words[2] == "5" else words) for words in rows))
    assert message in judged(study("pair.1"))


@pytest.mark.parametrize(
    ("rows", "message"),
    [
        (
            lambda rows: [row[:4] for row in rows],
            ".1 line 145 has no damping that is finite, the fifth number at finite periods, nor",
        ),
        (
            lambda rows: [*rows[:147], rows[147][:4], *rows[148:]],
            ".1 line 148 has no damping that is finite, the fifth",
        ),
        (lambda rows: [*rows[:147], rows[147][:3], *rows[148:]], ".1 line 148 has 3 numbers, 5 are needed"),
        (lambda rows: [*rows, [*rows[144][:3], "0.3", "0.1"]], ".1 line 3601 tells of the same as line 145 with other"),
        (lambda rows: [*rows, [*rows[0][:3], "0.3"]], ".1 line 3601 tells of the same as line 1 with other numbers"),
        (lambda rows: [[*row[:4], *("0.0" for _ in row[4:])] for row in rows], "has no damping of front surge, "),
    ],
)
def test_damping_that_a_file_lacks_or_tells_twice_is_not_taken_for_any(ours, study, tmp_path, rows, message):
    wamit_files(tmp_path, ours)
    right = [line.split() for line in (tmp_path / "pair.1").read_text().splitlines()]
    (tmp_path / "pair.1").write_text("\n".join(map(" ".join, rows(right))))
    assert message in judged(study("pair.1"))


@pytest.mark.parametrize("number", ["nan", "inf", "-Infinity"])
@pytest.mark.parametrize(
    ("kind", "row", "column", "message"),
    [
        (".1", 146, 3, ".1 line 147 has a number that is not finite"),
        (".1", 146, 4, ".1 line 147 has no damping that is finite, the fifth number at finite periods"),
        (".1", 146, 0, ".1 line 147 has a number that is not finite"),
        (".1", 14, 3, ".1 line 15 has a number that is not finite"),
        (".3", 2, 3, ".3 line 3 has a number that is not finite"),
        (".3fk", 2, 6, ".3fk line 3 has a number that is not finite"),
        (".hst", 26, 2, ".hst line 27 has a number that is not finite"),
    ],
)
def test_numbers_that_are_not_finite_are_refused_by_their_line(
    ours, study, tmp_path, number, kind, row, column, message
):
    wamit_files(tmp_path, ours)
    (tmp_path / "pair.3fk").write_text((tmp_path / "pair.3").read_text())
    path = tmp_path / f"pair{kind}"
    rows = [line.split() for line in path.read_text().splitlines()]
    rows[row][column] = number
    path.write_text("\n".join(map(" ".join, rows)))
    assert message in judged(study("pair.1"))


def test_limits_alone_may_have_a_damping_that_is_no_number(ours, tmp_path):
    wamit_files(tmp_path, ours)
    path = tmp_path / "pair.1"
    rows = [line.split() for line in path.read_text().splitlines()]
    path.write_text("\n".join(" ".join(row if len(row) > 4 else [*row, "NaN"]) for row in rows))
    close(reading.read(run_of(path), RHO, G), ours, rel=1e-6)


@pytest.mark.parametrize("number", ["nan", "inf"])
@pytest.mark.parametrize(
    ("start", "column", "message"),
    [
        ("3  3", 2, r"period \S+ s, line 28 has a number that is not finite"),
        ("3  3", 3, r"period \S+ s, line 28 has a number that is not finite"),
        ("3", 1, r"period \S+ s, force of motion 3 is not finite"),
    ],
)
def test_numbers_of_an_out_that_are_not_finite_are_refused(ours, tmp_path, number, start, column, message):
    path = tmp_path / "pair.out"
    wamit_out(path, ours)
    rows = [line.split() for line in path.read_text().splitlines()]
    at = [i for i, row in enumerate(rows) if row[:-2] == start.split() and len(row) == len(start.split()) + 2][-1]
    rows[at][column] = number
    path.write_text("\n".join(map(" ".join, rows)))
    with pytest.raises(InputError, match=message):
        reading.read(attached(path), RHO, G)


def test_numbers_too_large_for_their_unit_are_refused_without_a_word_of_numpy(ours, study, tmp_path):
    wamit_files(tmp_path, ours)
    path = tmp_path / "pair.1"
    rows = [line.split() for line in path.read_text().splitlines()]
    rows[146][3] = "1e308"
    path.write_text("\n".join(map(" ".join, rows)))
    assert "has numbers that are not finite" in judged(study("pair.1"))


@pytest.mark.parametrize(
    ("column", "value", "message"),
    [
        (4, lambda x: -x, ".3 line 1 has a modulus and phase that are not those of its real and imaginary part, as"),
        (5, lambda x: 1.05 * x, "of its real and imaginary part, as"),
        (4, np.radians, ""),  # which some print
        (4, np.round, ""),
        (3, lambda x: 0.0, ""),  # left out
    ],
)
def test_forces_that_contradict_themselves_are_refused(ours, study, tmp_path, column, value, message):
    wamit_files(tmp_path, ours)
    rows = [line.split() for line in (tmp_path / "pair.3").read_text().splitlines()]
    for row in rows:
        row[column] = str(float(value(float(row[column]))))
    (tmp_path / "pair.3").write_text("\n".join(map(" ".join, rows)))
    if message:
        assert message in judged(study("pair.1"))
    else:
        reading.read(run_of(tmp_path / "pair.1"), RHO, G)


def test_a_row_may_be_told_twice_but_not_otherwise(ours, study, tmp_path):
    wamit_files(tmp_path, ours)
    third = tmp_path / "pair.3"
    rows = [line.split() for line in third.read_text().splitlines()]
    again = [[*row[:3], *(f"{float(x):.5e}" for x in row[3:])] for row in rows]
    third.write_text("\n".join(map(" ".join, rows + again)))
    read = load(study("pair.1"))
    judge(read, Tasks.of(read.content), Engine())
    other = [[*row[:3], *(f"{1.01 * float(x):.5e}" for x in row[3:])] for row in rows]
    third.write_text("\n".join(map(" ".join, rows + other)))
    assert ".3 line 289 tells of the same as line 1 with other numbers" in judged(study("pair.1"))


@pytest.mark.parametrize(
    ("left_out", "message"),
    [
        (lambda p, i, j: p == 3 and (i, j) == (1, 5), "lacks added mass of motions 1 and 5 at period"),
        (lambda p, i, j: p == 0 and (i, j) == (3, 3), "lacks added mass of motions 3 and 3 at infinite frequency"),
        (lambda p, i, j: abs(i - j) == 6 and i % 6 == 3, "lacks added mass of motions 3 and 9 at"),
        (lambda p, i, j: (i - 1) // 6 != (j - 1) // 6, "lacks added mass of motions 1 and 7 at"),
    ],
)
def test_rows_that_added_mass_lacks_are_not_taken_for_none(ours, study, tmp_path, left_out, message):
    """p: 0 at infinite frequency, else which period. What symmetry makes zero may be left out."""
    wamit_files(tmp_path, ours)
    rows = [line.split() for line in (tmp_path / "pair.1").read_text().splitlines()]
    periods = sorted({float(row[0]) for row in rows})

    def written(out):
        kept = [row for row in rows if not out(periods.index(float(row[0])), int(row[1]), int(row[2]))]
        assert len(kept) < len(rows)
        (tmp_path / "pair.1").write_text("\n".join(map(" ".join, kept)))

    written(left_out)
    assert message in judged(study("pair.1"))
    wamit_files(tmp_path, ours)
    rows = [line.split() for line in (tmp_path / "pair.1").read_text().splitlines()]
    written(lambda p, i, j: (i + j) % 2)
    read = load(study("pair.1"))
    judge(read, Tasks.of(read.content), Engine())


@pytest.mark.parametrize(
    ("name", "content", "message"),
    [("a.nc", b"no netCDF", "is not readable as .nc: is neither netCDF nor HDF5, or not the whole of it"),
     ("a.1", b"PER I J A B\n", "is not readable as .1: .1 has no rows of numbers"),
     ("a.1", b"0.0 1 1 2.0", "has 0 different frequencies, needs 8 at least"),
     ("a.3", b"", "is not readable as .3: .3 has no rows of numbers"),
     ("a.txt", b"1 2 3", "must end in one of .nc, .h5, "),
     ("a.out", b"Gravity: 9.81", "has no line with"),
     ("a.out", b"Gravity: 9.81 Length scale: 1 Water depth: 9\n Wave period (sec", "has no number: is the file cut"),
     ("a.1", b"1.0 1 1 2.0 3.0\n1.0 2 x", "line 2 is no row of numbers"),
     ("a.h5", b"\x89HDF", "is not readable as .h5: is neither netCDF nor HDF5, or not the whole of it")],
)  # fmt: skip
def test_what_is_no_coefficient_file_is_refused(study, tmp_path, name, content, message):
    (tmp_path / name).write_bytes(content)
    others = {"a.1": ("a.3", "1.0 0 1 1 0 1 0"), "a.3": ("a.1", "1.0 1 1 2.0 3.0")}
    if name in others:
        other, rows = others[name]
        (tmp_path / other).write_text(rows)
    assert message in judged(study(name))


def test_a_missing_file_is_refused_with_status_2(study, tmp_path):
    path = study("nowhere.nc")
    run = subprocess.run(
        [sys.executable, "-m", "pipeline", "plan", str(path)], capture_output=True, text=True, check=False
    )
    assert run.returncode == 2 and "coefficients = 'nowhere.nc': no such file: " in run.stderr + run.stdout
    assert "Traceback" not in run.stderr


def test_the_frequency_domain_does_without_added_mass_at_infinite_frequency(ours, study, tmp_path, monkeypatch):
    """The time domain's memory needs it, here as if it bore no doubt."""
    wamit_files(tmp_path, ours)
    expected, first = answer(study("pair.1", "frequency")), tmp_path / "pair.1"
    first.write_text("\n".join(line for line in first.read_text().splitlines() if not line.startswith(" 0.0 ")))
    monkeypatch.setattr(radiated, "UNKNOWN", 0.0)
    assert "has no added mass at infinite frequency" in judged(study("pair.1"))
    read = load(study("pair.1", "frequency"))
    judge(read, Tasks.of(read.content), Engine())
    record = answer(study("pair.1", "frequency"))
    for variable in ("rotation", "absorbed_power", "hinge_force"):
        theirs, value = record.variables[variable][1], expected.variables[variable][1]
        assert np.abs(theirs - value).max() <= 1e-3 * np.abs(value).max(), variable


def test_a_plan_counts_no_boundary_elements_where_a_file_has_the_coefficients(ours, study, tmp_path):
    capytaine_file(tmp_path / "pair.nc", ours)
    plan = CliRunner().invoke(app, ["plan", str(study("pair.nc")), "--results", str(tmp_path / "results")])
    assert plan.exit_code == 0 and "to run: 1 tasks; about" in plan.output


def test_a_study_finds_the_coefficients_of_its_base(ours, study, tmp_path):
    capytaine_file(tmp_path / "pair.nc", ours)
    study("pair.nc")
    (tmp_path / "sub").mkdir()
    above = tmp_path / "sub" / "above.toml"
    above.write_text('base = "../pair.toml"\ntitle = "above"\n')
    assert only_task(above).id == only_task(tmp_path / "pair.toml").id
