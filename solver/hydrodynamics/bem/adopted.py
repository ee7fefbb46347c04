"""Coefficients that others computed, brought into this program's form and held against the hulls.

What a file says is kept; what it leaves out follows from the hull (Froude-Krylov force, hydrostatics) or from the rest
(added mass at infinite frequency). Conventions that do not fit are refused, with the one that would.
"""

from collections.abc import Sequence
from dataclasses import replace
from types import MappingProxyType
from typing import Any

import numpy as np
import scipy  # ndimage is slow to import, and few runs have coefficients from a file

from solver.errors import InputError, refuse
from solver.hydrodynamics.bem import agreement
from solver.hydrodynamics.bem.coefficients import (
    DOFS,
    LACKING,
    PLANAR,
    ROUGHLY,
    STANDS_OUT,
    Hydrodynamics,
    MeshError,
    symmetric,
)
from solver.hydrodynamics.bem.exerted import Floats
from solver.hydrodynamics.bem.given import KEY, Given, about
from solver.hydrodynamics.bem.incident import Sea
from solver.hydrodynamics.bem.mean_hull import at_rest, froude_krylov, motion_lengths
from solver.hydrodynamics.bem.passive import mended, require_passive, scales
from solver.hydrodynamics.bem.radiated import infinite, require_damping, require_energy, require_together
from solver.hydrodynamics.hull.mesh import Hull

FEWEST = 8  # frequencies from which a memory can be fitted
TOLD = 1e-3  # relative, to which water and heading must be those of the study
PUSHED = 1e-3  # of the largest wave force along a float's axes: less along another is none
CURVES = ("added_mass", "radiation_damping", "diffraction", "froude_krylov")  # the last is known exactly
SPACED = 1 / 8  # of what curves through every other frequency miss, those through all do at least
MANY = 12  # frequencies from which it is judged whether one stands out
FAINT = 0.01  # of what a body has along others: a round hull's yaw is next to nothing
HARDLY = 0.05  # of what ωA says, of damping
SPIKE = 0.05, 4.0  # of a curve's largest, and times the next, by which one frequency misses a curve without it
BESIDE = 2  # frequencies on each side by which that is told


def adopted(
    given: Given,
    hulls: tuple[Hull, ...],
    centres: np.ndarray,
    names: Sequence[str],
    *,
    points: np.ndarray | None = None,
    depth: float,
    density: float,
    gravity: float,
    heading: float,
    planar: bool,
    needed: Sequence[Sequence[str]] | None = None,
    waves: tuple[float, float] | None = None,
    memory: bool = True,
) -> Hydrodynamics:
    """The coefficients of `hulls` with `names` at `centres` (nb, 3) [m], from a file; InputError where they cannot be.

    points: (nb, 3) [m] of rotations and moments where the file does not tell; the centres by default.
    needed: motions that each float has, so that the file must. All by default. Forces of waves along others that it
    lacks are not known: the settings name them, see `lacking`.
    waves: lowest and highest [rad/s] that the file must reach.
    memory: whether one will be fitted to these, for which added mass at infinite frequency must be known.
    """
    centres = np.asarray(centres, float).reshape(-1, 3)
    sea = Sea(depth=depth, density=density, gravity=gravity, heading=heading)
    dofs = PLANAR if planar else DOFS
    each = needed or [dofs] * len(hulls)
    refuse([*_water_problems(given, depth, density, gravity), *_form_problems(given, each, heading)])
    six, told = _complete(given, names, each, heading)
    own = centres if points is None else points
    six = _about_own(six, own, centres)
    moved = np.array([6 * b + k for b, those in enumerate(each) for k, dof in enumerate(DOFS) if dof in those], int)
    floats, omega = Floats(hulls, centres, own, tuple(names), sea), six.omega
    # Of translations, which go by no point, before what shows that moments are about another one.
    require_passive(about(six, centres), floats, moved[moved % 6 < 3])
    expected = froude_krylov(hulls, centres, DOFS, sea, omega)
    six, notes = agreement.agreed(six, floats, expected)
    if waves:
        _require_covered(given, *waves)
    doubt = agreement.require_moments(six, floats, expected)
    rough, damping = require_passive(six, floats, moved), require_damping(six, moved, names)
    unlike, lacks = require_energy(six, floats, moved)
    require_together(six, floats, moved)
    added, unsure = infinite(six, scales(six, floats)["added_mass"], moved, names, memory=memory)
    A, B = symmetric(six.added_mass), mended(six, floats, moved)
    if off := "; ".join([*rough, *unlike]):
        notes |= {ROUGHLY: f"{off}; are thin parts, as a heave plate, in too few panels?"}
    index = np.array([6 * b + DOFS.index(d) for b in range(len(hulls)) for d in dofs])
    # Without any of the waves' that is scattered, where that is not told.
    curves = _curves(replace(six, added_mass=A, radiation_damping=B, added_mass_inf=added), expected, index, told)
    h = Hydrodynamics(
        omega=omega,
        **curves,
        froude_krylov=expected[:, index],
        settings=MappingProxyType({"method": f"from {given.name}"} | notes | _lacking(floats, each, expected, told)),
        **at_rest(hulls, centres, dofs, sea),
    )
    # With A and B as lopsided as they are told: half of what is between their halves.
    other = replace(six, points=centres - doubt, added_mass_inf=added + unsure, radiation_damping=damping + lacks)
    perhaps = _curves(about(other, centres), expected, index, told)
    there, second = np.isin(index, moved), _left_out(h, 2)
    if sentence := _standing_out(h, second, there, motion_lengths(hulls, dofs), names):
        h = replace(h, settings=MappingProxyType({**h.settings, STANDS_OUT: sentence}))
    pushed = there | (told & (np.arange(told.size) % 6 < 3))[index]  # joints bear forces along what they hold
    judged = {name: np.outer(there, there) for name in curves} | {"diffraction": pushed}
    error = {n: off + judged[n] * (perhaps[n] - curves[n]) for n, off in _between(h, second)._asdict().items()}
    # What the file's mesh does to the incident wave's force it does as much to the other.
    error["diffraction"] += pushed * _incident_misfit(six, floats, expected)[:, index]
    return replace(h, error=MeshError(**error))


def _incident_misfit(six: Given, floats: Floats, expected: np.ndarray) -> np.ndarray:
    """By how much a file's Froude-Krylov force is off its hulls' (nw, 6 nb), where it is told; else by its waterplanes,
    whose heave stiffness tells the size of its meshes, and nothing where neither is."""
    if six.froude_krylov is not None:
        return six.froude_krylov[:, 0] - expected
    if six.stiffness is None:
        return np.zeros_like(expected)
    told = np.diagonal(six.stiffness)[2::6]
    exact = floats.sea.density * floats.sea.gravity * np.array([hull.waterplane[0] for hull in floats.hulls])
    share = np.divide(told - exact, exact, out=np.zeros(told.size), where=(told > 0) & (exact > 0))
    return expected * np.repeat(share, 6)


def _lacking(floats: Floats, needed: Sequence[Sequence[str]], expected: np.ndarray, told: np.ndarray) -> dict[str, Any]:
    """A setting with the columns of forces, along motions that joints hold, which waves push and a file lacks.

    Across the waves the incident one pushes nothing, but what is scattered and radiated does unless all is its own
    mirror image there.
    """
    size = np.abs(expected).max(axis=0).reshape(-1, 6)
    pushed = size > PUSHED * size[:, :3].max(axis=1, keepdims=True)
    pushed[:, 0] |= not _mirrored(floats, needed, 0)
    pushed[:, 1] |= not _mirrored(floats, needed, 1)
    pushed &= np.arange(6) < 3
    lacking = np.flatnonzero(pushed.ravel() & ~told)
    return {LACKING: " ".join(map(str, lacking.tolist()))} if lacking.size else {}


def _mirrored(floats: Floats, needed: Sequence[Sequence[str]], axis: int) -> bool:
    """Whether hulls, waves and the motions that there are have the plane across x (0) or y (1) as a mirror."""
    along = (np.cos, np.sin)[axis](floats.sea.heading)
    others = {DOFS[axis], DOFS[4 - axis], "yaw"}  # the mirror turns these about
    return bool(
        abs(along) < TOLD
        and np.ptp(floats.centres[:, axis]) == 0
        and all(hull.symmetry[axis] for hull in floats.hulls)
        and not any(others & set(dofs) for dofs in needed)
    )


def _curves(six: Given, expected: np.ndarray, index: np.ndarray, told: np.ndarray) -> dict[str, Any]:
    """What a file gives of some columns (n,), of which errors are told; told (6 nb,): those it has."""
    incident, infinite = six.froude_krylov, six.added_mass_inf
    assert infinite is not None
    scattered = six.excitation[:, 0] - (expected if incident is None else incident[:, 0])
    return {
        "added_mass": six.added_mass[:, index[:, None], index],
        "radiation_damping": six.radiation_damping[:, index[:, None], index],
        "added_mass_inf": infinite[np.ix_(index, index)],
        "diffraction": np.where(told, scattered, 0.0)[:, index],
    }


def _standing_out(
    h: Hydrodynamics, missed: dict[str, np.ndarray], there: np.ndarray, lengths: np.ndarray, names: Sequence[str]
) -> str:
    """What one frequency alone says of a motion (n,), and those beside it do not; nothing where none does.

    lengths (n,): by which a body's motions compare, see motion_lengths.
    """
    worst, sentence, (least, times) = 0.0, "", SPIKE
    if len(h.omega) < MANY:
        return ""
    inertia = np.diagonal(h.added_mass, axis1=1, axis2=2)
    body = np.arange(len(there)) // len(h.dofs)
    words = {"added_mass": "added mass", "radiation_damping": "damping", "diffraction": "wave force"}
    for name, off in missed.items():
        each = off, getattr(h, name)
        error, curve = (x if x.ndim == 2 else np.diagonal(x, axis1=1, axis2=2) for x in each)
        size, largest = np.abs(curve).max(axis=0), np.zeros(len(there))
        unit = lengths ** (2 if off.ndim == 3 else 1)
        if name == "radiation_damping":  # that is little beside what is accelerated matters little
            size = np.maximum(size, HARDLY * np.abs(h.omega[:, None] * inertia).max(axis=0))
        np.maximum.at(largest, body, size / unit)
        size = np.maximum(size, FAINT * largest[body] * unit)
        share = np.abs(error) / np.maximum(size, np.finfo(float).tiny)
        for j in np.flatnonzero(there):
            w = int(share[:, j].argmax())
            others = np.delete(share[:, j], slice(max(w - 1, 0), w + 2))
            if share[w, j] > max(least, worst, times * others.max(initial=0.0)):
                b, k = divmod(int(j), len(h.dofs))
                worst = float(share[w, j])
                sentence = (
                    f"at {h.omega[w]:.4g} rad/s the {words[name]} of {names[b]} along {h.dofs[k]} is {worst:.0%} of its"
                    " largest off what the frequencies beside it say: is it a slip, an irregular frequency, or does"
                    " water ring there?"
                )
    return sentence


def _between(h: Hydrodynamics, second: dict[str, np.ndarray]) -> MeshError:
    """What the curves may be off between a file's frequencies, of which alone it tells; its mesh is not known.

    Curves through every other one miss r₂, `second`, through every fourth r₄: those through all miss as much less than
    r₂ as that is less than r₄, about each frequency. Of smooth ones it is SPACED of r₂; of a frequency that stands out,
    and of waves between bodies that turn by more than half from one to the next, all of it.
    """
    error = {"added_mass_inf": np.zeros_like(h.added_mass_inf)}
    fourth = _left_out(h, 4)
    for name, missed in second.items():
        size, before = (
            scipy.ndimage.maximum_filter1d(np.abs(x), 2 * BESIDE + 1, axis=0) for x in (missed, fourth[name])
        )
        share = np.divide(size, before, out=np.ones(size.shape), where=before > size)
        error[name] = missed * np.maximum(share, SPACED)
    return MeshError(**error)


def _left_out(h: Hydrodynamics, step: int) -> dict[str, np.ndarray]:
    """What curves through every so many frequencies miss halfway between those, of each curve; 0 at both ends."""
    whole, last = {name: getattr(h, name) for name in CURVES}, len(h.omega) - 1
    missed = {name: np.zeros_like(whole[name]) for name in CURVES[:3]}
    for first in range(step):
        some = np.unique([0, *range(first, last + 1, step), last])
        at = np.setdiff1d(np.arange((first + step // 2) % step, last + 1, step), some)
        fewer = replace(h, omega=h.omega[some], **{name: value[some] for name, value in whole.items()})
        Z, X = fewer.impedance(h.omega[at]), fewer.excitation(h.omega[at], "diffraction")
        for name, value in zip(missed, (-Z.imag / h.omega[at, None, None], Z.real, X), strict=True):
            missed[name][at] = whole[name][at] - value
    return missed


def _require_covered(given: Given, low: float, high: float) -> None:
    """Refuse waves [rad/s] that a file's coefficients do not reach."""
    first, last = given.omega.min(), given.omega.max()
    if low < first * (1 - 1e-9) or high > last * (1 + 1e-9):
        limit = f"must be within {first:.4g} to {last:.4g} rad/s, the frequencies of {given.name}"
        raise InputError("band", f"[{low:.4g}, {high:.4g}]", limit)


def _water_problems(given: Given, depth: float, density: float, gravity: float) -> list[InputError]:
    told = {"water.depth": (depth, given.depth), "water.density": (density, given.density)}
    told["water.gravity"] = (gravity, given.gravity)
    return [
        InputError(key, value, f"must be {limit:g}, that of {given.name}")
        for key, (value, limit) in told.items()
        if limit is not None and not np.isclose(value, limit, rtol=TOLD, atol=0.0)
    ]


def _form_problems(given: Given, needed: Sequence[Sequence[str]], heading: float) -> list[InputError]:
    """Bodies, frequencies, headings and numbers that cannot be used whatever they mean."""
    problems = []
    has, count = len(given.bodies) or 1 + max((b for b, _ in given.columns), default=-1), len(needed)
    fixed = not given.bodies and has < count and not any(needed[has:])  # of bodies that nothing counts the last ones
    if has != count and not fixed:
        problems.append(_problem(given, f"has {has} bodies, the study has {count} floats"))
    if len(bad := given.omega[~(np.isfinite(given.omega) & (given.omega > 0))]):
        problems.append(_problem(given, f"has a frequency of {bad[0]:g} rad/s: must be finite and > 0"))
    if len(given.omega) < FEWEST or len(np.unique(given.omega)) < len(given.omega):
        limit = f"has {len(np.unique(given.omega))} different frequencies, needs {FEWEST} at least, each once"
        problems.append(_problem(given, limit))
    for name in ("added_mass", "radiation_damping", "excitation", "added_mass_inf"):
        values = getattr(given, name)
        if values is not None and not np.all(np.isfinite(values)):
            index = np.argwhere(~np.isfinite(values))[0]
            at = f" at {given.omega[index[0]]:.4g} rad/s" if name != "added_mass_inf" else ""
            at += f", heading {given.headings[index[1]]:.4g} rad" if name == "excitation" else ""
            what = {"excitation": "wave force", "added_mass_inf": "added mass at infinite frequency"}
            limit = f"has numbers that are not finite: {what.get(name, name.replace('_', ' '))}{at}"
            problems.append(_problem(given, limit))
    if not np.any(_same_heading(given, heading)):
        known = ", ".join(f"{h:.4g}" for h in given.headings)
        limit = f"must be one of {known} rad, those of {given.name}"
        if np.any(_same_heading(replace(given, headings=np.radians(given.headings)), heading)):
            limit += "; or are the file's in degrees, which must be in rad?"
        problems.append(InputError("waves.heading", heading, limit))
    return problems


def _problem(given: Given, limit: str) -> InputError:
    return InputError(KEY, given.name, limit)


def _same_heading(given: Given, heading: float) -> np.ndarray:
    return np.abs(np.exp(1j * given.headings) - np.exp(1j * heading)) < TOLD


def _complete(
    given: Given, names: Sequence[str], needed: Sequence[Sequence[str]], heading: float
) -> tuple[Given, np.ndarray]:
    """At increasing frequencies, for one heading, six columns for each float in the floats' order, and which it has."""
    order = _order(given, names)
    place = {(order.index(b), dof): i for i, (b, dof) in enumerate(given.columns)}
    lacking = [f"{dof} of {names[b]}" for b, dofs in enumerate(needed) for dof in dofs if (b, dof) not in place]
    if lacking:
        raise _problem(given, f"lacks {', '.join(lacking)}")
    target = np.array([6 * b + DOFS.index(dof) for b, dof in place])
    source, n = np.array(list(place.values())), 6 * len(names)
    rows = np.argsort(given.omega)

    def matrix(values: np.ndarray) -> np.ndarray:
        whole = np.zeros((*values.shape[:-2], n, n))
        whole[..., target[:, None], target] = values[..., source[:, None], source]
        return whole

    def vector(values: np.ndarray) -> np.ndarray:
        whole = np.zeros((len(rows), 1, n), complex)
        whole[:, 0, target] = values[rows][:, np.flatnonzero(_same_heading(given, heading))[0], source]
        return whole

    six = replace(
        given,
        omega=given.omega[rows],
        added_mass=matrix(given.added_mass[rows]),
        radiation_damping=matrix(given.radiation_damping[rows]),
        added_mass_inf=None if given.added_mass_inf is None else matrix(given.added_mass_inf),
        excitation=vector(given.excitation),
        froude_krylov=None if given.froude_krylov is None else vector(given.froude_krylov),
        points=None if given.points is None else given.points[list(order)],
        stiffness=None if given.stiffness is None else matrix(given.stiffness),
        columns=tuple((b, dof) for b in range(len(names)) for dof in DOFS),
        bodies=tuple(names),
        headings=np.array([heading]),
    )
    return six, np.isin(np.arange(n), target)


def _order(given: Given, names: Sequence[str]) -> list[int]:
    """Number in the file of each float: by name where the file has the floats' names, else as they come."""
    theirs, ours = [b.casefold() for b in given.bodies], [n.casefold() for n in names]
    return [theirs.index(n) for n in ours] if sorted(theirs) == sorted(ours) else list(range(len(names)))


def _about_own(six: Given, own: np.ndarray, centres: np.ndarray) -> Given:
    """With the floats' own points (nb, 3) [m] for those that a file does not tell; where it tells none, rotations and
    moments about `centres`, of which the own ones are as far wherever the file's body is."""
    if six.points is None or np.isnan(six.points).all():
        return replace(about(replace(six, points=own), centres), points=None)
    return replace(six, points=np.where(np.isnan(six.points), own, six.points))
