"""Where floats do not rest in still water is said without boundary elements, and nothing where they do."""

from dataclasses import replace

import pytest

from solver.coupled.boundary import coefficients
from solver.coupled.statics import statics
from solver.errors import SimulationFailed
from solver.hydrodynamics.bem import bem
from solver.hydrodynamics.hull.box import box
from solver.run import simulate
from solver.scene import Float
from tests import awkward

HULL = box(length=12.0, width=6.0, height=6.0, draft=3.0)
HIGH, LOW = 6.0, -2.0  # centres of gravity with which it falls over, and does not [m]


@pytest.fixture(autouse=True)
def no_flow(monkeypatch):
    """Whoever has boundary elements solved fails."""
    monkeypatch.setattr(bem, "_coefficients", lambda *_, **__: pytest.fail("boundary elements were solved"))


def afloat(height, *, settings=None, **changes):
    """The box in waves."""
    given = {"mass": awkward.RHO * HULL.volume, "inertia": (1e6, 1e6, 1e6), "motion": ("heave", "roll")} | changes
    item = Float(name="box", hull=HULL, cog=(0.0, 0.0, height), hinge=(0.0, 0.0, 0.0), arm=(0.0, 0.0, 0.0), **given)
    return awkward.scene([item], **(settings or {}))


@pytest.mark.parametrize(
    "settings",
    [
        {},
        {"froude_krylov": "linear"},
        {"froude_krylov": "none", "diffraction": False},
        {"froude_krylov": "linear", "method": "frequency", "outputs": ("drift",)},
        {"accuracy": "reference"},
    ],
)
def test_what_falls_over_is_said_before_it_is_solved_for_and_what_stays_is_not(settings):
    told = statics(afloat(HIGH, settings=settings))
    assert told.startswith("the equilibrium in still water is unstable: box roll falls away with a stiffness of -1.4")
    assert statics(afloat(LOW, settings=settings)) == ""


def test_what_sinks_has_no_equilibrium_and_what_is_let_go_turned_over_is_not_upright():
    assert statics(afloat(LOW, mass=2.5 * awkward.RHO * HULL.volume)).startswith("no static equilibrium")
    over = {"offset": (0.0, 1.4), "preload": (0.0, 1e6)}  # which leans it by 0.3 rad
    assert statics(afloat(LOW, **over)).startswith("floats.box.offset")
    linear = {"froude_krylov": "linear", "method": "frequency"}
    assert statics(afloat(LOW, **over, settings=linear)) == ""  # where nothing is let go


def test_coefficients_from_elsewhere_have_hydrostatics_of_their_own():
    scene = afloat(LOW, settings={"froude_krylov": "linear"})
    known = coefficients(replace(scene, settings=replace(scene.settings, radiation=False, diffraction=False)))
    assert statics(scene, known) == ""
    tender = replace(known, hydrostatic_stiffness=-known.hydrostatic_stiffness)
    assert "unstable" in statics(scene, tender)


NAMES = "big_beside_small", "duck", "flap", "model_scale", "oblique", "soft_ground", "soft_mooring", "unequal_legs"


@pytest.mark.parametrize("froude_krylov", ["body-nonlinear", "linear", "none"])
@pytest.mark.parametrize("name", [*NAMES, "raking", "rotors"])
def test_nothing_is_said_of_scenes_that_rest(name, froude_krylov, monkeypatch):
    monkeypatch.setattr(awkward, "known", lambda *_, **__: None)
    monkeypatch.setattr(awkward, "unequal_legs", awkward.unequal_legs.__wrapped__)  # some of these stand on its frame
    make = getattr(awkward, name)
    made = getattr(make, "__wrapped__", make)()
    scene = made[0] if isinstance(made, tuple) else made
    assert statics(replace(scene, settings=replace(scene.settings, froude_krylov=froude_krylov))) == ""


def test_it_is_said_in_the_words_of_the_run():
    """Which without flow needs no boundary elements either."""
    dry = {"radiation": False, "diffraction": False}
    with pytest.raises(SimulationFailed) as failed:
        simulate(afloat(HIGH, settings=dry))
    assert statics(afloat(HIGH)) == str(failed.value)
