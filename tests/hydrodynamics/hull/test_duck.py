"""Rotors with a round stern and a flat-sided beak, against integrals of the outline: an arc and two tangents."""

import numpy as np
import pytest
from pytest import approx

from solver.errors import InputError
from solver.hydrodynamics.hull.duck import duck, profile
from solver.hydrodynamics.hull.panel_hull import PanelHull

ROTOR = {"radius": 3.0, "beak": 6.0, "elevation": 0.6, "submergence": 1.5}
SUNK_BEAK = ROTOR | {"elevation": -0.2}
ON_AXIS = ROTOR | {"submergence": 0.0, "elevation": 0.1}
STEEP = {"radius": 1.0, "beak": 1.3, "elevation": 0.7, "submergence": 0.2}
SHAPES = [ROTOR, SUNK_BEAK, ON_AXIS, STEEP]


def exact(radius, beak, elevation, submergence):
    """∫ 1, x, z and the waterplane's chord (left, right) of the wet part of the outline, round an exact circle.

    Slices of constant z between the heights at which a piece of the outline ends, Gauss points in each after
    z = middle + half sin(πs/2), which takes the root of the circle's ends away: exact to rounding.
    """
    half = np.arccos(radius / beak)
    tip = np.array([-np.cos(elevation), np.sin(elevation)]) * beak
    feet = [radius * np.array([-np.cos(elevation + a), np.sin(elevation + a)]) for a in (half, -half)]

    def chord(z):
        """Least and largest x of the convex outline at a height over the axis."""
        xs = []
        if abs(z) < radius:
            xs += [-np.sqrt(radius**2 - z**2), np.sqrt(radius**2 - z**2)]
        for foot in feet:
            (x0, z0), (x1, z1) = tip, foot
            if min(z0, z1) <= z <= max(z0, z1):
                xs.append(x0 + (x1 - x0) * (z - z0) / (z1 - z0))
        return min(xs), max(xs)

    breaks = sorted({min(-radius, tip[1]), submergence, -radius, radius, tip[1], feet[0][1], feet[1][1]})
    breaks = [b for b in breaks if b <= submergence]
    s, w = np.polynomial.legendre.leggauss(60)
    total = np.zeros(3)
    for low, high in zip(breaks[:-1], breaks[1:], strict=True):
        z = (low + high) / 2 + (high - low) / 2 * np.sin(np.pi / 2 * s)
        weight = w * (high - low) / 2 * np.pi / 2 * np.cos(np.pi / 2 * s)
        left, right = np.array([chord(each) for each in z]).T
        total += [
            weight @ (right - left),
            weight @ (right**2 - left**2) / 2,
            weight @ ((right - left) * (z - submergence)),
        ]
    return total, chord(submergence)


def hydrostatics(hull, width):
    """Of a slice of the hull: area, first moments, and area, first and second moment of the waterplane."""
    V = hull.volume
    return np.array([V, *(V * hull.buoyancy_point[[0, 2]]), *hull.waterplane[[0, 1, 3]]]) / width


@pytest.mark.parametrize("shape", SHAPES)
def test_hydrostatics_are_those_of_arc_and_tangents_and_err_as_the_square_of_the_sides(shape):
    (area, x, z), (left, right) = exact(**shape)
    known = np.array([area, x, z, right - left, (right**2 - left**2) / 2, (right**3 - left**3) / 3])
    size = shape["beak"] ** np.array([2, 3, 3, 1, 2, 3])
    errors = [hydrostatics(duck(**shape, width=2.0, sides=n), 2.0) - known for n in (32, 512)]
    assert np.all(np.abs(errors[0]) < 2e-3 * size)
    # 1/16² where waterline and corners lie alike: up to four times as much where they do not.
    assert np.all(np.abs(errors[1]) < 4 * 2e-3 / 16**2 * size)


@pytest.mark.parametrize("shape", SHAPES)
@pytest.mark.parametrize("sides", [8, 32])
def test_the_polygon_encloses_as_much_as_the_outline(shape, sides):
    x, z = profile(**shape, sides=sides).T
    half = np.arccos(shape["radius"] / shape["beak"])
    outline = (np.pi - half + np.tan(half)) * shape["radius"] ** 2
    assert np.sum(np.roll(x, -1) * z - x * np.roll(z, -1)) / 2 == approx(outline, rel=1e-12)


@pytest.mark.parametrize("shape", SHAPES)
def test_the_mesh_is_closed_and_wound_outwards_and_nothing_had_to_be_mended(shape):
    hull = duck(**shape, width=4.0)
    assert hull.closed and not len(hull.holes) and hull.notes == ()
    assert hull.symmetry == (False, True)
    # Of the whole body ∫ n dS = 0 and ∫ r n dS = 3 V.
    first, second = (hull.panels[:, [0, 1, 2]], hull.panels[:, [0, 2, 3]])
    areas = [np.cross(c[:, 1] - c[:, 0], c[:, 2] - c[:, 0]) / 2 for c in (first, second)]
    whole = sum(np.sum(c.mean(axis=1) * a) for c, a in zip((first, second), areas, strict=True)) / 3
    half = np.arccos(shape["radius"] / shape["beak"])
    assert np.abs(sum(a.sum(axis=0) for a in areas)).max() < 1e-12
    assert whole == approx(4.0 * (np.pi - half + np.tan(half)) * shape["radius"] ** 2, rel=1e-12)


@pytest.mark.parametrize("shape", SHAPES)
def test_a_beak_the_other_way_is_the_mirror_image(shape):
    hull, other = (duck(**s, width=4.0) for s in (shape, shape | {"elevation": np.pi - shape["elevation"]}))
    assert other.volume == approx(hull.volume, rel=1e-12)
    assert other.buoyancy_point == approx(hull.buoyancy_point * [-1, 1, 1], abs=1e-12)
    assert other.waterplane == approx(hull.waterplane * [1, -1, 1, 1, -1, 1], abs=1e-10)
    image = PanelHull.of(hull.vertices * [-1, 1, 1], hull.faces[:, ::-1])
    assert np.sort(image.vertices, axis=0) == approx(np.sort(other.vertices, axis=0), abs=1e-12)


@pytest.mark.parametrize(
    ("changed", "key", "words"),
    [
        ({"beak": 2.9}, "hull.beak", "must be > radius, 3 m"),
        ({"beak": 3.0}, "hull.beak", "must be > radius, 3 m"),
        ({"width": 0.0}, "hull.width", "must be > 0 m"),
        ({"elevation": 35.0}, "hull.elevation", "between -6.28319 and 6.28319 rad"),
        ({"submergence": 3.4}, "hull.submergence", "between -3 and 3.38785 m, or the hull does not pierce still water"),
        ({"submergence": -3.0}, "hull.submergence", "between -3 and 3.38785 m"),
        ({"elevation": 1.3, "submergence": -1.0}, "hull.elevation", "it reaches from z = 1.75 to 6.781 m"),
    ],
)
def test_impossible_shapes_are_refused_with_numbers(changed, key, words):
    with pytest.raises(InputError, match=words.replace(".", r"\.")) as caught:
        duck(**{**ROTOR, "width": 4.0, **changed})
    assert caught.value.key == key
