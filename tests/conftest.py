"""The Buan scene of Heo, Koo and Kim (2022), as the tests of the coupled solver vary it."""

import os
import random
import shutil
import tempfile
from itertools import islice
from types import SimpleNamespace

import numpy as np
import pytest
from hypothesis import HealthCheck, settings

from pipeline.environment import importing
from solver.hydrodynamics.hull.revolution import Revolution
from solver.scene import Float, Platform, Scene, Settings, Water
from solver.sea.realization import Realization, realize
from solver.sea.spectrum import PiersonMoskowitz
from solver.structure.frame import Frame
from solver.structure.members import Material, Member, PointLoad, PointMass
from solver.structure.sections import solid_rectangle, tube
from tests.once import FOLDER, solve

# How long an example takes is the machine's affair, and a run can be repeated; "random" goes by --hypothesis-seed.
UNTIMED = settings(deadline=None, suppress_health_check=[HealthCheck.too_slow])
settings.register_profile("same", UNTIMED, derandomize=True)
settings.register_profile("random", UNTIMED)
settings.load_profile("same")

BEGIN = (  # with which each of four workers begins
    ("tests/coupled/",),
    ("tests/frequency/",),
    ("tests/hydrodynamics/bem/", "tests/sea/", "tests/hydrodynamics/hull/"),
    ("tests/pipeline/report/", "tests/pipeline/study/", "tests/pipeline/tasks/", "tests/structure/"),
)

HULL = Revolution.hemisphere_cylinder(radius=1.0, height=0.6)
WATER = Water(depth=50.0)
DISPLACED = 1025 * 2 / 3 * np.pi  # of the hemisphere [kg]


def pytest_configure(config):
    if FOLDER not in os.environ:  # workers have it from the process that starts them
        os.environ[FOLDER] = config.coefficients = tempfile.mkdtemp()


def pytest_unconfigure(config):
    if folder := getattr(config, "coefficients", None):
        del os.environ[FOLDER]
        shutil.rmtree(folder)


@pytest.hookimpl(wrapper=True)
def pytest_collection():
    """All files are imported: a third of the time would go into looks for garbage among what stays."""
    with importing():
        return (yield)


def pytest_addoption(parser):
    parser.addoption("--shuffle", metavar="SEED", help="run files, and the tests within each, in a random order")


@pytest.hookimpl(trylast=True)  # after what is not asked for has left
def pytest_collection_modifyitems(config, items):
    """No test may lean on another one: any order is as good, and fixtures of a file are still made once.

    Four workers begin with a quarter each: two of these with what compiles a time loop, without and with laws of
    several zones, the others with what needs none, and would wait for it.
    """
    quarter = -(-len(items) // len(BEGIN))
    first = [[i for folder in folders for i in items if folder in i.path.as_posix()][:quarter] for folders in BEGIN]
    taken = {item for part in first for item in part}
    others = iter([item for item in items if item not in taken])
    items[:] = [item for part in first for item in (*part, *islice(others, quarter - len(part)))]
    if (seed := config.getoption("shuffle")) is not None:
        dice, files = random.Random(seed), {}
        for item in items:
            files.setdefault(item.path, []).append(item)
        mixed = dice.sample(list(files.values()), len(files))
        items[:] = [item for group in mixed for item in dice.sample(group, len(group))]


def frame(stiffer=1.0):
    steel = Material(E=2.1e11 * stiffer, G=8.33e10 * stiffer, density=78600 / 9.81)
    leg, deck = tube(0.45, 0.012), solid_rectangle(0.641, 0.641)
    nodes = {"hinge:front": (-1.5, 0.0, 2.6), "hinge:rear": (1.5, 0.0, 2.6)}
    members = []
    for i, (x, y) in enumerate([(-1.5, 1.2), (-1.5, -1.2), (1.5, 1.2), (1.5, -1.2)], 1):
        nodes[f"foot{i}"], nodes[f"top{i}"] = (x, y, -50.0), (x, y, 2.6)
        members.append(
            Member(
                name=f"leg{i}", start=f"foot{i}", end=f"top{i}", elements=29, section=leg, material=steel,
                drag_coefficient=1.0, inertia_coefficient=2.0,
            )
        )  # fmt: skip
    beams = ["top1 top2", "top3 top4", "top1 top3", "top2 top4", "hinge:front top1", "hinge:front top2"]
    for pair in [*beams, "hinge:rear top3", "hinge:rear top4"]:
        start, end = pair.split()
        members.append(Member(name=pair, start=start, end=end, elements=1, section=deck, material=steel))
    return Frame(
        nodes=nodes,
        members=tuple(members),
        clamped=("foot1", "foot2", "foot3", "foot4"),
        masses=tuple(PointMass(node=f"top{i}", mass=980e3 / 9.81 / 4) for i in range(1, 5)),
        loads=tuple(PointLoad(node=f"top{i}", force=(0.0, 0.0, -245e3)) for i in range(1, 5)),
    )


def platform(**changes):
    return Platform(
        frame=changes.pop("frame", frame()),
        legs=("leg1", "leg2", "leg3", "leg4"),
        hinge_nodes={"front": "hinge:front", "rear": "hinge:rear"},
        **changes,
    )


def floats(**changes):
    common = {"hull": HULL, "mass": DISPLACED, "inertia": (859.0,) * 3, "pto_damping": 1e5} | changes
    return (
        Float(name="front", hinge=(-1.5, 0, 2.6), arm=(-2.36, 0, -2.6), **common),
        Float(name="rear", hinge=(1.5, 0, 2.6), arm=(2.36, 0, -2.6), **common),
    )


def sea(seed=0, Hs=1.28, Tp=5.46, heading=0.0):
    return realize(PiersonMoskowitz(Hs=Hs, Tp=Tp), components=130, band=(0.7, 3.4), seed=seed, heading=heading)


def regular(amplitude, omega):
    return Realization(omega=np.array([omega]), amplitude=np.array([amplitude + 0j]), peak_frequency=omega)


def scene(support="elastic", **changes):
    settings = {k: changes.pop(k) for k in list(changes) if k in Settings.__slots__}
    usual = {
        "water": WATER,
        "sea": sea(),
        "floats": () if support == "elastic-no-floats" else floats(),
        "platform": None if support == "fixed" else platform(),
        "settings": Settings(**({"duration": 60.0, "discard": 20.0, "ramp": 20.0} | settings)),
    }
    return Scene(**(usual | changes))


@pytest.fixture(scope="session")
def buan():
    """Builders of the Buan scene and its parts."""
    return SimpleNamespace(
        scene=scene, frame=frame, platform=platform, floats=floats, sea=sea, regular=regular, water=WATER
    )


@pytest.fixture(scope="session")
def coefficients():
    """Coarse coefficients of the pair: enough to test the solver, too coarse to publish."""
    centres = np.array([f.centre for f in floats()])
    return solve((HULL, HULL), centres, depth=50.0, omega=np.linspace(0.3, 7.0, 36), panels=108)
