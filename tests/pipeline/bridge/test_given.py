"""Coefficient files: each format read, the same study the same answer, and misfits refused before anything runs."""

import json
import subprocess
import sys

import netCDF4
import numpy as np
import pytest

from pipeline.bridge import cache
from pipeline.bridge.engine import Engine, compute, share
from pipeline.bridge.engine import coefficients as file_of
from pipeline.bridge.geometry import geometry_of
from pipeline.bridge.given import reading
from pipeline.bridge.loading import load
from pipeline.bridge.preflight import judge
from pipeline.study.attachments import Attachment
from pipeline.study.reading import StudyError
from pipeline.tasks.tasklist import Tasks
from solver.hydrodynamics.hull.revolution import Revolution
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
    from dataclasses import replace

    own = replace(h, **planar, dofs=("surge", "heave", "pitch"), error=None)
    return compute(only_task(path).parameters, cache.encode(own, "own"))


def capytaine_file(path, h, names=("front", "rear"), form="NETCDF4"):
    """A dataset as capytaine writes it: bodies and motions in words, complex numbers apart."""
    with netCDF4.Dataset(path, "w", format=form) as data:
        labels = [f"{name}__{dof.capitalize()}" for name in names for dof in h.dofs]
        sizes = {"omega": len(h.omega) + 1, "wave_direction": 2, "complex": 2, "body": 2, "space_coordinate": 3}
        for name, size in {**sizes, "influenced_dof": 12, "radiating_dof": 12}.items():
            data.createDimension(name, size)
        for name in ("influenced_dof", "radiating_dof"):
            data.createVariable(name, str, (name,))[:] = np.array(labels, object)
        put(data, "omega", ("omega",), np.append(h.omega, np.inf))
        put(data, "wave_direction", ("wave_direction",), [0.7, h.heading])
        put(data, "rotation_center", ("body", "space_coordinate"), h.centres)
        for name, value in {"water_depth": h.depth, "rho": h.density, "g": h.gravity}.items():
            put(data, name, (), value)
        A = np.concatenate([h.added_mass, h.added_mass_inf[None]])
        B = np.concatenate([h.radiation_damping, 0 * h.added_mass_inf[None]])
        dims = ("omega", "radiating_dof", "influenced_dof")
        put(data, "added_mass", dims, np.swapaxes(A, 1, 2))
        put(data, "radiation_damping", dims, np.swapaxes(B, 1, 2))
        for name, force in {"diffraction_force": h.diffraction, "Froude_Krylov_force": h.froude_krylov}.items():
            whole = np.full((2, len(h.omega) + 1, 2, 12), np.nan)
            whole[0, :-1, 1], whole[1, :-1, 1], whole[:, :-1, 0] = force.real, force.imag, 9.0
            put(data, name, ("complex", "omega", "wave_direction", "influenced_dof"), whole)


def put(data, name, dims, values):
    data.createVariable(name, "f8", dims)[...] = values


def bemio_file(path, h):
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
            sized(added, "inf_freq", h.added_mass_inf[six] / rho)
            sized(damping, "all", np.moveaxis(h.radiation_damping[:, six] / (rho * w[:, None, None]), 0, 2))
            for group, values in ((excitation, force), (excitation.createGroup("froude-krylov"), incident)):
                sized(group, "re", values.real.T[six, None])
                sized(group, "im", values.imag.T[six, None])


def sized(group, name, values):
    values = np.asarray(values, float)
    for i, size in enumerate(values.shape):
        group.createDimension(f"{name}_{i}", size)
    group.createVariable(name, "f8", [f"{name}_{i}" for i in range(values.ndim)])[...] = values


def wamit_rows(h, L=1.0):
    """Lines of .1 and .3: numbers without units for a length scale L."""
    turns = np.arange(12) % 6 >= 3
    unit = h.density * L ** (3.0 + turns[:, None] + turns)
    force = (h.diffraction + h.froude_krylov).conj() / (h.density * h.gravity * L ** (2.0 + turns))
    pairs = [(i, j) for i in range(12) for j in range(12)]
    first = [f" 0.0 {i + 1} {j + 1} {h.added_mass_inf[i, j] / unit[i, j]:.9e}" for i, j in pairs]
    third = []
    for w, A, B, X in zip(h.omega, h.added_mass, h.radiation_damping, force, strict=True):
        head = f" {2 * np.pi / w:.9e}"
        first += [f"{head} {i + 1} {j + 1} {A[i, j] / unit[i, j]:.9e} {B[i, j] / unit[i, j] / w:.9e}" for i, j in pairs]
        third += [
            f"{head} 0.0 {i + 1} {abs(x):.9e} {np.degrees(np.angle(x)):.9e} {x.real:.9e} {x.imag:.9e}"
            for i, x in enumerate(X)
        ]
    return first, third


def wamit_files(folder, h, L=1.0):
    first, third = wamit_rows(h, L)
    (folder / "pair.1").write_text("\n".join(first))
    (folder / "pair.3").write_text("\n".join(third))
    C = h.hydrostatic_stiffness / (h.density * h.gravity)
    (folder / "pair.hst").write_text("\n".join(f"{i + 1} {j + 1} {C[i, j]:.6e}" for i in range(12) for j in range(12)))


def wamit_out(path, h, L=2.0):
    """The printed output for a length scale L, with the bodies' places; phases have decimals here."""
    lines = [f" Gravity: {h.gravity}   Length scale: {L}", f" Water depth: {h.depth}  Water density: {h.density}"]
    lines += [f" XBODY = {x} YBODY = {y} ZBODY = {z} PHIBODY = 0.0" for x, y, z in h.centres]
    first, third = wamit_rows(h, L)
    words = [line.split() for line in first], [line.split() for line in third]
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
    path.write_text("\n".join(lines))


def attached(path):
    return Attachment.of(path.name, path.read_bytes())


def close(given, h, *, rel):
    for name, value in {
        "omega": h.omega, "added_mass": h.added_mass, "radiation_damping": h.radiation_damping,
        "added_mass_inf": h.added_mass_inf, "excitation": (h.diffraction + h.froude_krylov)[:, None],
    }.items():  # fmt: skip
        theirs, order = getattr(given, name), np.argsort(given.omega)
        theirs = theirs if name == "added_mass_inf" else theirs[order]
        theirs = theirs[:, -1:] if name == "excitation" else theirs
        assert np.abs(theirs - value).max() <= rel * np.abs(value).max(), name


def test_every_format_reads_back_what_was_written(ours, tmp_path):
    capytaine_file(tmp_path / "pair.nc", ours)
    bemio_file(tmp_path / "pair.h5", ours)
    wamit_files(tmp_path, ours)
    wamit_out(tmp_path / "pair.out", ours)
    (tmp_path / "own.nc").write_bytes(cache.encode(ours, "key"))
    for name in ("pair.nc", "pair.h5", "pair.out", "own.nc"):
        given = reading.read(attached(tmp_path / name), RHO, G)
        close(given, ours, rel=1e-6)
        assert given.points == pytest.approx(CENTRES), name
    texts = {k: (tmp_path / f"pair{k}").read_text() for k in (".1", ".3", ".hst")}
    whole = Attachment.of("pair.1", json.dumps(texts).encode())
    close(reading.read(whole, RHO, G), ours, rel=1e-6)


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


def test_floats_of_a_file_interact(ours, study, tmp_path):
    wamit_files(tmp_path, ours)
    path = study("pair.1", method="frequency")
    path.write_text(path.read_text().replace("[solver]", "[solver]\ninteraction = false"))
    with pytest.raises(StudyError, match=r"solver.interaction = false: must be true"):
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


def test_misfits_are_said_before_anything_runs(ours, study, tmp_path):
    wamit_files(tmp_path, ours)
    lines = [line.split() for line in (tmp_path / "pair.3").read_text().splitlines()]
    (tmp_path / "pair.3").write_text("\n".join(" ".join([*row[:6], str(-float(row[6]))]) for row in lines))
    message = judged(study("pair.1"))
    assert "pair.toml: coefficients = pair.1: wave force is of the other sign of time" in message
    wamit_files(tmp_path, ours, L=2.0)
    assert "other units" in judged(study("pair.1"))
    wamit_files(tmp_path, ours)
    path = study("pair.1")
    path.write_text(path.read_text().replace("band = [0.7, 3.0]", "band = [0.4, 3.0]"))
    assert "waves.band = [0.4" in judged(
        path
    ) and "must be within 0.5 to 7.5 rad/s, the frequencies of pair.1" in judged(path)
    (tmp_path / "pair.3").unlink()
    assert "needs .1 and .3 (or .2) beside each other" in judged(study("pair.1"))


@pytest.mark.parametrize(
    ("name", "content", "message"),
    [("a.nc", b"no netCDF", "is not readable as .nc"), ("a.txt", b"1 2 3", "must end in one of .nc, .h5, "),
     ("a.out", b"Gravity: 9.81", "has no line with"),
     ("a.1", b"1.0 1 1 2.0 3.0\n1.0 2 x", "line 2 is no row of numbers"),
     ("a.h5", b"\x89HDF", "is not readable as .h5")],
)  # fmt: skip
def test_what_is_no_coefficient_file_is_refused(study, tmp_path, name, content, message):
    (tmp_path / name).write_bytes(content)
    if name == "a.1":
        (tmp_path / "a.3").write_text("1.0 0 1 1 0 1 0")
    assert message in judged(study(name))


def test_a_missing_file_is_refused_with_status_2(study, tmp_path):
    path = study("nowhere.nc")
    run = subprocess.run(
        [sys.executable, "-m", "pipeline", "plan", str(path)], capture_output=True, text=True, check=False
    )
    assert run.returncode == 2 and "coefficients = 'nowhere.nc': no such file: " in run.stderr + run.stdout
    assert "Traceback" not in run.stderr


def test_a_study_finds_the_coefficients_of_its_base(ours, study, tmp_path):
    capytaine_file(tmp_path / "pair.nc", ours)
    study("pair.nc")
    (tmp_path / "sub").mkdir()
    above = tmp_path / "sub" / "above.toml"
    above.write_text('base = "../pair.toml"\ntitle = "above"\n')
    assert only_task(above).id == only_task(tmp_path / "pair.toml").id
