"""Whether a file's added mass and damping are those of bodies in water: the same both ways, and giving no energy.

A mesh misses both by a part of ω(M + A), as that of a heave plate in few panels does, which may be more than all the
damping of a motion that hardly radiates: what is off is held against both.
"""

import numpy as np

from solver.errors import InputError, refuse
from solver.hydrodynamics.bem.coefficients import DOFS, symmetric
from solver.hydrodynamics.bem.exerted import Floats
from solver.hydrodynamics.bem.given import KEY, Given
from solver.hydrodynamics.bem.mean_hull import motion_lengths
from solver.hydrodynamics.bem.radiated import COUNTED, resistance, word

LOPSIDED = 0.2  # of the largest entry's scale: more asymmetry is no error of a mesh
ACTIVE = 0.05  # of the largest damping: more below zero is no error of a mesh
FEW = 0.25  # of the frequencies: what a mesh does is at no more of them, or lies above the largest damping's
SLOSHING = 2.0  # ω²a/g from which water inside a hull may: 2.4 in a circle's waterplane, no other's is lower


def scales(six: Given, floats: Floats) -> dict[str, np.ndarray]:
    """Size (n,) of a column's share of A and of B, so that entries of translations and rotations compare.

    Columns that hardly radiate, such as a sphere's turning, are as large as a tenth of the largest.
    """
    found, lengths = {}, motion_lengths(floats.hulls, DOFS)
    for name in ("added_mass", "radiation_damping"):
        largest = np.abs(np.einsum("wii->wi", getattr(six, name))).max(axis=0) / lengths**2
        found[name] = lengths * np.sqrt(np.maximum(largest, 1e-2 * largest.max()))
    return found


def require_passive(six: Given, floats: Floats, moved: np.ndarray) -> list[str]:
    """Refuse matrices that no body in water has: lopsided, giving energy away or keeping it; of motions `moved`.

    In words what is so of damping, but by little beside ω(M + A).
    """
    if not moved.size:
        return []
    still = moved[(moved % 6 < 3) & ~six.radiation_damping[:, moved, moved].any(axis=0)]
    if still.size:
        words = ", ".join(word(floats.names, column) for column in still)
        raise InputError(KEY, six.name, f"has no damping of {words} at any frequency: does it lack a column?")
    own = {name: size[moved] for name, size in scales(six, floats).items()}
    size, heavy = own["radiation_damping"], resistance(six, floats)[:, moved]
    beside, value = np.maximum(size, np.sqrt(COUNTED * heavy)), _values(_damping(six, moved), size)
    turned = -value.min() > value.max()  # of the other sign, however little that is
    texts = _lopsided(six, floats, moved, "added_mass", own["added_mass"])
    texts += _lopsided(six, floats, moved, "radiation_damping", beside)
    texts += _active(six, floats, moved, size if turned else beside)
    refuse([InputError(KEY, six.name, text) for text in texts])
    return _rough(six, floats, moved)


def mended(six: Given, floats: Floats, moved: np.ndarray) -> np.ndarray:
    """Damping (nw, n, n) as much one way as the other, without what of it is negative, where that is told of."""
    B, damping = symmetric(six.radiation_damping), _damping(six, moved)
    if moved.size and _values(damping, scales(six, floats)["radiation_damping"][moved]).min() < -ACTIVE:
        root = np.sqrt(resistance(six, floats)[:, moved])
        value, V = np.linalg.eigh(_over(symmetric(damping), root))
        passive = V * np.maximum(value, 0.0)[:, None] @ np.swapaxes(V, 1, 2)
        B[:, moved[:, None], moved] = passive * root[:, :, None] * root[:, None]
    return B


def _rough(six: Given, floats: Floats, moved: np.ndarray) -> list[str]:
    """In words what is more off than a mesh does of the damping, and was not refused, over ω(M + A)."""
    size, root = scales(six, floats)["radiation_damping"][moved], np.sqrt(resistance(six, floats)[:, moved])
    B, words, notes = _damping(six, moved), [word(floats.names, column) for column in moved], []
    if np.abs(_over(B - np.swapaxes(B, 1, 2), size)).max() > LOPSIDED:
        gap = np.abs(_over(B - np.swapaxes(B, 1, 2), root))
        w, i, j = np.unravel_index(gap.argmax(), gap.shape)
        text = f"damping of {words[i]} on {words[j]} and the other way differ by {gap[w, i, j]:.2g} of their ω(M + A)"
        notes.append(f"{text} at {six.omega[w]:.4g} rad/s{_sloshing(six, floats, w)}")
    if (_values(B, size).min(axis=1) < -ACTIVE).any():
        value, vector = np.linalg.eigh(_over(symmetric(B), root))
        w = int(value[:, 0].argmin())
        most, at = words[int(np.abs(vector[w, :, 0]).argmax())], f"at {six.omega[w]:.4g} rad/s"
        text = f"damping, mostly of {most}, is negative by {-value[w, 0]:.2g} of its ω(M + A) {at}"
        notes.append(f"{text}{_sloshing(six, floats, w)}, and taken as none")
    return notes


def _sloshing(six: Given, floats: Floats, w: int) -> str:
    return ", maybe an irregular frequency" if _sloshes(six.omega[w], floats) else ""


def _sloshes(omega: float, floats: Floats) -> bool:
    """Whether water inside a hull may, at irregular frequencies."""
    return omega**2 * max(hull.largest_radius for hull in floats.hulls) >= SLOSHING * floats.sea.gravity


def _damping(six: Given, moved: np.ndarray) -> np.ndarray:
    return six.radiation_damping[:, moved[:, None], moved]


def _over(values: np.ndarray, size: np.ndarray) -> np.ndarray:
    """Matrices (nw, n, n) over sizes of their columns, (n,) or (nw, n)."""
    return np.asarray(values / (size[..., :, None] * size[..., None, :]))


def _values(damping: np.ndarray, size: np.ndarray) -> np.ndarray:
    """Eigenvalues (nw, n), ascending, of the damping over sizes."""
    return np.asarray(np.linalg.eigvalsh(_over(symmetric(damping), size)))


def _lopsided(six: Given, floats: Floats, moved: np.ndarray, name: str, size: np.ndarray) -> list[str]:
    """What is wrong of a matrix that is not the same both ways, over sizes of its columns."""
    values = getattr(six, name)[:, moved[:, None], moved]
    gap = np.abs(_over(values - np.swapaxes(values, 1, 2), size))
    w, i, j = np.unravel_index(gap.argmax(), gap.shape)
    if gap[w, i, j] <= LOPSIDED:
        return []
    one, other = (word(floats.names, moved[at]) for at in (i, j))
    text = f"{name.replace('_', ' ')} is not symmetric: {one} on {other} {values[w, i, j]:.4g}, the other"
    text += f" way {values[w, j, i]:.4g} at {six.omega[w]:.4g} rad/s; are columns in another order or unit"
    return [f"{text}{_irregular(six, floats, moved, gap.max(axis=(1, 2)) > LOPSIDED)}?"]


def _active(six: Given, floats: Floats, moved: np.ndarray, size: np.ndarray) -> list[str]:
    """What is wrong of damping that gives energy, over sizes of its columns."""
    value, vector = np.linalg.eigh(_over(symmetric(_damping(six, moved)), size))
    w = int(value[:, 0].argmin())
    if value[w, 0] >= -ACTIVE:
        return []
    most = word(floats.names, moved[int(np.abs(vector[w, :, 0]).argmax())])
    text = f"damping is negative at {six.omega[w]:.4g} rad/s, mostly of {most}, by {-value[w, 0]:.0%} of its"
    text += f" largest or, where that is more, of {COUNTED:g} ω(M + A); is the sign the other one"
    return [f"{text}{_irregular(six, floats, moved, value[:, 0] < -ACTIVE)}?"]


def _irregular(six: Given, floats: Floats, moved: np.ndarray, wrong: np.ndarray) -> str:
    """A question more, where what is wrong (nw,) is so at few frequencies, or above that of the largest damping."""
    at, damping = six.omega[wrong], _values(_damping(six, moved), scales(six, floats)["radiation_damping"][moved])
    if len(at) > FEW * len(six.omega) and not at[0] > six.omega[np.abs(damping).max(axis=1).argmax()]:
        return ""
    span = f"{at[0]:.4g}" if len(at) == 1 else f"{len(at)} of them, {at[0]:.4g} to {at[-1]:.4g}"
    if not _sloshes(at[-1], floats):
        return f", or are thin parts, as a heave plate, in too few panels ({span} rad/s)"
    wells = " and ".join(
        name for name, hull in zip(floats.names, floats.hulls, strict=True) if hull.waterplane_width < np.inf
    )
    if wells:
        return f", or does water slosh in the well of {wells} ({span} rad/s), without which a file is taken"
    return f", or are there irregular frequencies ({span} rad/s), which a lid inside the hull takes away"
