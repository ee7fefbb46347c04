"""Hydrodynamic coefficients as arrays, and the excitation between the frequencies solved for.

Harmonics are Re{X exp(-iωt)}; the incident wave of unit amplitude is
η = Re exp(i(k(x cosβ + y sinβ) - ωt)), phase zero at x = y = 0.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property, lru_cache
from types import MappingProxyType
from typing import Any, NamedTuple

import numpy as np
from scipy.interpolate import CubicSpline

from solver.errors import InputError
from solver.hydrodynamics.bem import incident
from solver.hydrodynamics.bem.far_field import FarField, Waves
from solver.hydrodynamics.radiation.memory import RadiationMemory
from solver.hydrodynamics.radiation.passivity import own_transfers, radiates
from solver.hydrodynamics.radiation.rational import ever_more_poles, fitted, mixed
from solver.keys import Bits, shared
from solver.sea.dispersion import over_depth, wavenumbers

DOFS = ("surge", "sway", "heave", "roll", "pitch", "yaw")
PLANAR = ("surge", "heave", "pitch")
LACKING = "lacking"  # the setting that has the columns, of six a body, that a file does not tell
UNJUDGED = "unjudged"  # setting with what of a file was not
ROUGHLY = "roughly"  # setting with what of a file goes with the rest as far as its mesh does
STANDS_OUT = "stands out"  # setting with what of a file is unlike frequencies beside it
EACH_ALONE = "each alone"  # what the settings say of bodies that do not interact
ROUGH = 3  # order of the divided differences by which a curve is rough
RESOLVED = 1e-3  # of the largest singular value: poles too broad to be told from a smooth rest are left to that
CLOSE = 1e-3  # of each motion's largest impedance: what the poles of what rings need not meet better
UNTOLD = 0.1  # of A + iB/ω: where panels leave more of it they do not resolve the waves that a motion makes
NEARBY = 3  # frequencies to either side
CERTAIN = 4.0  # times its estimated error, and FAINTEST of its body's largest over squared lengths: a motion radiates
FAINTEST = 1e-9
HELD = 3  # of so many frequencies one is left out, and judges the poles
HOPELESS = 10.0  # logarithms of squares above the least that is missed: more poles are not sought
CURVES = 16  # sets of coefficients whose curves a process keeps
SEAS = 32  # seas and coefficients at whose frequencies it keeps them


Curve = Callable[[np.ndarray], np.ndarray]  # of frequencies (nw',) [rad/s], values (nw', ...)


class MeshError(NamedTuple):
    """Estimated errors, with their signs, of the coefficients of the same names."""

    added_mass: np.ndarray
    radiation_damping: np.ndarray
    added_mass_inf: np.ndarray
    diffraction: np.ndarray


@dataclass(frozen=True, eq=False, kw_only=True)
class Hydrodynamics:
    """Coefficients of nb bodies, n = nb len(dofs) degrees of freedom ordered body by body.

    Rotations and moments are about each body's centre (x, y, 0), at rest in the still-water plane.
    """

    omega: np.ndarray  # (nw,) [rad/s], increasing
    added_mass: np.ndarray  # (nw, n, n) [kg, kg m, kg m²]
    radiation_damping: np.ndarray  # (nw, n, n) [N s/m, ...]
    added_mass_inf: np.ndarray  # (n, n), at infinite frequency
    diffraction: np.ndarray  # (nw, n) complex force of the scattered wave per wave amplitude [N/m]
    froude_krylov: np.ndarray  # (nw, n) complex force of the incident wave at the mean position [N/m]
    hydrostatic_stiffness: np.ndarray  # (n, n) of buoyancy alone: ρgS, ρg(I + V z_b); weight is the scene's
    displaced_mass: np.ndarray  # (nb,) [kg], exact hull
    buoyancy_centre: np.ndarray  # (nb,) z of the displaced volume's centroid [m]
    centres: np.ndarray  # (nb, 3) [m]
    depth: float  # [m], may be inf
    density: float  # [kg/m³]
    gravity: float  # [m/s²]
    heading: float  # direction the waves travel to, from +x towards +y [rad]
    dofs: tuple[str, ...]  # of one body
    settings: MappingProxyType[str, Any] = field(default_factory=lambda: MappingProxyType({}))
    error: MeshError | None = None  # what the panels leave, as far as is known
    far_field: FarField | None = None  # the waves far off, where asked for
    waves_to: float = np.inf  # [rad/s] the highest frequency of waves that these are for, see `resolved`
    memory: RadiationMemory | None = None  # fitted to these, for scenes that ask for
    memory_tolerance: float = np.nan  # this tolerance, and
    memory_motions: tuple[tuple[str, ...], ...] = ()  # floats that have these motions; all of them where empty
    rings: tuple[np.ndarray, np.ndarray] | None = None  # `ringing` of these and of `shifted`, where found before

    def moved(self, motions: Sequence[Sequence[str]]) -> np.ndarray:
        """Which degrees of freedom bodies with these motions have (n,); all where none are said."""
        each = motions or [self.dofs] * len(self.centres)
        return np.array([dof in names for names in each for dof in self.dofs], bool)

    @property
    def body(self) -> np.ndarray:
        """Whose each motion is (n,), from 0."""
        return np.repeat(np.arange(len(self.centres)), len(self.dofs))

    @cached_property
    def certain(self) -> np.ndarray:
        """Which motions (n,) radiate more than mesh error, however little beside others; of a file's, nobody knows."""
        if self.error is None or "panels" not in self.settings:
            return np.zeros(len(self.body), bool)
        size, off = (
            own_transfers(self.omega, of.added_mass, of.radiation_damping, of.added_mass_inf).max(axis=0)
            for of in (self, self.error)
        )
        return (size > CERTAIN * off) & radiates(size, self._lengths, self.body, least=FAINTEST)

    @cached_property
    def shifted(self) -> "Hydrodynamics":
        """The same coefficients plus their estimated errors."""
        if self.error is None:
            return self
        moved = {name: getattr(self, name) + off for name, off in self.error._asdict().items()}
        if self.rings is not None:
            return replace(self, rings=(self.rings[1], self.rings[1]), **moved)
        # With as many poles: rough errors would be met by ever more of them, and rounding choose how many.
        shifted, pairs = replace(self, **moved), int(np.where(self._poles.imag > 0, 2, 1).sum()) // 2
        omega, samples, _ = shifted._heard
        beta = fitted(omega, mixed(samples, CLOSE), pairs) if pairs else self._poles
        return replace(shifted, rings=(beta[beta.imag > 0],) * 2)

    @cached_property
    def forced(self) -> "Hydrodynamics":
        """The same coefficients plus the errors of forces that do not go with those of radiation.

        Waves long beside a body push it by (m + A)u̇ of their water, as if it moved through still water at -u (G. I.
        Taylor, 1928): one mesh gives both errors, δX = (δB - iωδA)u, and what moves with the water feels neither.
        """
        if self.error is None:
            return self
        radiated = self.error.radiation_damping - 1j * self.omega[:, None, None] * self.error.added_mass
        apart = self.error.diffraction - (radiated @ self._water[..., None])[..., 0]
        return replace(self, diffraction=self.diffraction + apart)

    @property
    def _water(self) -> np.ndarray:
        """u (nw, n) [1/s] of the incident wave per amplitude at the bodies' centres of buoyancy; it does not turn."""
        k = wavenumbers(self.omega, self.depth, self.gravity)[:, None]
        level, rise = over_depth(k, self.buoyancy_centre, self.depth)
        along = {"surge": np.cos(self.heading) * level, "sway": np.sin(self.heading) * level, "heave": -1j * rise}
        u = np.stack([along.get(dof, 0 * level) for dof in self.dofs], axis=-1).reshape(len(k), -1)
        return np.asarray(self.gravity * k / self.omega[:, None] * u * self.arrival(self.omega))

    def told(self, motions: Sequence[Sequence[str]]) -> "Hydrodynamics":
        """At the frequencies that panels resolve, for bodies with these motions: all up to the first that is not below
        `waves_to`, and beyond until they leave more than UNTOLD of a motion's own A + iB/ω at most of those NEARBY.
        """
        if self.error is None:
            return self
        own, off = (
            np.abs(np.einsum("wii->wi", of.added_mass + 1j * of.radiation_damping / self.omega[:, None, None]))
            for of in (self, self.error)
        )
        heard = self.moved(motions) & radiates(own.max(axis=0), self._lengths, self.body)
        lost = np.any(off > UNTOLD * own, axis=1, where=heard)
        most = np.convolve(lost, np.ones(2 * NEARBY + 1))[NEARBY:-NEARBY] > NEARBY
        among = np.append(0.0, self.omega[:-1]) < self.waves_to
        return self.first(int(np.logical_and.accumulate(among | ~most).sum()))

    def first(self, count: int) -> "Hydrodynamics":
        """At the first frequencies, so many."""
        if count == self.omega.size:
            return self
        curves = ("added_mass", "radiation_damping", "diffraction")
        cut = {name: getattr(self, name)[:count] for name in ("omega", *curves, "froude_krylov")}
        error = self.error and self.error._replace(**{name: getattr(self.error, name)[:count] for name in curves})
        far = self.far_field and FarField(self.far_field[0], *(modes[:count] for modes in self.far_field[1:]))
        return replace(self, **cut, error=error, far_field=far)

    @cached_property
    def mesh_error(self) -> float:
        """Largest estimated error of a curve, as a share of the largest value of its kind.

        Moments and rotations count by the cube root of a body's volume, as forces and displacements there.
        """
        if self.error is None:
            return 0.0
        force = 1 / self._lengths
        sizes = {"added_mass_inf": (both := force[:, None] * force), "added_mass": both, "radiation_damping": both}
        known = {n: (e, getattr(self, n), sizes.get(n, force)) for n, e in self.error._asdict().items()}
        shares = ((np.abs(e * size).max(), np.abs(x * size).max()) for e, x, size in known.values())
        return max(float(error / largest) if largest > 0 else 0.0 for error, largest in shares)

    @cached_property
    def resolved(self) -> np.ndarray:
        """Whether frequencies are close enough to each other to tell what goes on between them, (nw,).

        All up to `waves_to`; beyond, as long as a wave to the farthest body and back turns by π at most from one to
        the next. Then what bodies reflect to each other is aliased.
        """
        turned = np.diff(self.turned, prepend=self.turned[0])
        return np.logical_and.accumulate((self.omega <= self.waves_to) | (turned <= np.pi))

    @cached_property
    def turned(self) -> np.ndarray:
        """Phase by which a wave to the farthest body and back is late, (nw,) [rad]; 0 without others that feel it."""
        apart = np.linalg.norm(self.centres[:, None] - self.centres, axis=-1).max() if self.interacting else 0.0
        return np.asarray(2 * apart * wavenumbers(self.omega, self.depth, self.gravity))

    @cached_property
    def ringing(self) -> np.ndarray:
        """Exponents β (p,) [rad/s], Im β > 0, of water that rings, by vector fitting of the impedance."""
        if self.rings is not None:
            return self.rings[0]
        return self._poles[self._poles.imag > 0]

    @cached_property
    def _poles(self) -> np.ndarray:
        """Those, and real ones beside them: so many that curves with them miss what they do not know by least.

        Fitted to noise, or to too few frequencies, poles are made up, and damp next to nothing: the closer they meet
        what is known, the farther off is what lies between. What rings is there with one frequency less, and in forces,
        which poles are not fitted to.
        """
        omega, impedance, force = self._heard
        best, least = np.zeros(0, complex), np.inf
        if not impedance.size or omega.size <= ROUGH:
            return best
        judges = [kind for kind in (mixed(impedance.conj(), CLOSE), force) if kind.any()]
        values, firsts = np.hstack(judges), np.cumsum([0, *(kind.shape[1] for kind in judges[:-1])])
        # Fewer than there are differences to tell how much of each a curve has.
        most, turns = 2 * (omega.size - ROUGH) // 3, np.ptp(self.turned[self.resolved]) / (2 * np.pi)
        for beta in ever_more_poles(omega, impedance, CLOSE, most, turns):
            squares = np.add.reduceat(_missed(omega, values, beta[beta.imag > 0]), firsts, axis=1)
            # Of each kind beside its own with others, whatever their units; what is missed by most, next to a narrow
            # resonance, and what is as a rule.
            missed = float(np.sum(np.log(squares.sum(axis=0)) + np.log(squares).mean(axis=0)))
            if missed < least:
                best, least = beta, missed
            elif missed > least + HOPELESS:
                break
        return best

    @property
    def _heard(self) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """ω (nw',) that are resolved, and the impedance (nw', m) of what radiates there, 1 on the diagonal at most.

        Diffraction (nw', n') as well, without the phase of the wave's arrival, 1 at most; of motions that radiate as
        much, so much is their forces' share in it.
        """
        transfer = self.radiation_damping + 1j * self.omega[:, None, None] * (self.added_mass - self.added_mass_inf)
        size = np.sqrt(np.abs(np.einsum("wii->wi", transfer)).max(axis=0))
        heard = np.flatnonzero(radiates(size**2, self._lengths, self.body))
        scaled = transfer[self.resolved][:, heard[:, None], heard] / np.outer(size[heard], size[heard])
        force = (self.diffraction * self.arrival(self.omega).conj())[self.resolved][:, heard] / size[heard]
        force /= max(np.abs(force).max(initial=0.0), np.finfo(float).tiny)
        return self.omega[self.resolved], scaled.reshape(len(scaled), -1), force

    @property
    def _lengths(self) -> np.ndarray:
        """By which motions compare (n,): 1 of translations, of rotations the size of the body [m]."""
        sizes = np.cbrt(self.displaced_mass / self.density)[:, None]
        return np.asarray(sizes ** [dof in DOFS[3:] for dof in self.dofs]).ravel()

    @property
    def interacting(self) -> bool:
        """Whether each body feels the waves that the others diffract and radiate."""
        return len(self.centres) == 1 or self.settings.get("bodies") != EACH_ALONE

    def excitation(self, omega: np.ndarray, kind: str = "total") -> np.ndarray:
        """Force per wave amplitude (nw', n) [N/m] at any ω in the solved range.

        kind: "total", "diffraction" or "froude_krylov". Curves of X exp(-ik·x_b): without the phase of the wave's
        arrival at the body they are smooth, but for the water's resonances.
        """
        values = _values(self, Bits(np.atleast_1d(np.asarray(omega, float))))
        return values.diffraction + values.froude_krylov if kind == "total" else getattr(values, kind)

    def impedance(self, omega: np.ndarray) -> np.ndarray:
        """B - iωA (nw', n, n) at any ω in the solved range."""
        return _values(self, Bits(omega)).impedance

    def waves(self, omega: np.ndarray, amplitude: np.ndarray, velocity: np.ndarray) -> Waves:
        """Far off, with incident waves of amplitude (nw',) at x = y = 0 and velocities (nw', n) of the motions.

        By curves of H about the bodies' middle, at any ω in the solved range.
        """
        if self.far_field is None:
            raise InputError("coefficients", "no far field", "must be boundary elements that were asked for one")
        _require_solved(self, omega)
        origin, radiated, scattered = self.far_field
        k = wavenumbers(omega, self.depth, self.gravity)
        there = amplitude * np.exp(1j * k * (origin @ [np.cos(self.heading), np.sin(self.heading)]))
        sent = self.curve(np.concatenate([radiated, scattered[:, None]], axis=1))(omega)
        return Waves(
            omega=omega,
            amplitude=there,
            modes=np.einsum("wn,wnm->wm", np.concatenate([velocity, there[:, None]], axis=1), sent),
            heading=self.heading,
            depth=self.depth,
            density=self.density,
            gravity=self.gravity,
        )

    def curve(self, values: np.ndarray) -> Curve:
        """Through values (nw, ...) at the frequencies solved for: cubic splines of what the water's resonances leave.

        Water between bodies rings in bands narrower than frequencies are apart. Of each of its poles β a curve has as
        much, Re β/(-iω - β*), as leaves the smoothest rest, by third divided differences where they are resolved.
        """
        through = _smoothest(self.omega, values.reshape(len(values), -1), self.ringing, self.resolved)
        return lambda omega: through(omega).reshape(-1, *values.shape[1:])

    def arrival(self, omega: np.ndarray) -> np.ndarray:
        """exp(ik(x_b cosβ + y_b sinβ)) for each degree of freedom, (nw, n)."""
        k = wavenumbers(omega, self.depth, self.gravity)
        return incident.arrival(k, self.heading, self.centres, len(self.dofs))


def _smoothest(omega: np.ndarray, values: np.ndarray, beta: np.ndarray, resolved: np.ndarray | slice) -> Curve:
    """Through values (nw, m) at ω (nw,) with poles β (p,), as Hydrodynamics.curve has it."""
    known = omega[resolved]

    def ringing(omega: np.ndarray) -> np.ndarray:
        return beta.real / (-1j * np.asarray(omega)[:, None] - beta.conj())

    def rough(values: np.ndarray) -> np.ndarray:
        rest = values[resolved]
        for n in range(1, ROUGH + 1):
            rest = np.diff(rest, axis=0) / (known[n:] - known[:-n])[:, None]
        return rest

    at = ringing(omega)
    share = np.linalg.lstsq(rough(at), rough(values), rcond=RESOLVED)[0]
    rest = CubicSpline(omega, values - at @ share)
    return lambda omega: rest(omega) + ringing(omega) @ share


def _missed(omega: np.ndarray, values: np.ndarray, beta: np.ndarray) -> np.ndarray:
    """Squares (nw - 2, m) of what curves with poles β miss of values (nw, m), each through all but every HELD-th."""
    missed = np.full(values[1:-1].shape, np.finfo(float).tiny)
    for first in range(1, HELD + 1):
        out = np.arange(first, len(omega) - 1, HELD)  # both ends bear curves
        rest = np.setdiff1d(np.arange(len(omega)), out)
        if out.size:
            curve = _smoothest(omega[rest], values[rest], beta, slice(None))
            missed[out - 1] += np.abs(curve(omega[out]) - values[out]) ** 2
    return missed


class _Values(NamedTuple):
    """Of a set of coefficients at some frequencies."""

    impedance: np.ndarray  # (nw', n, n) B - iωA
    diffraction: np.ndarray  # (nw', n)
    froude_krylov: np.ndarray


@lru_cache(maxsize=CURVES)
def _curves(h: Hydrodynamics) -> Curve:
    """Of all of them side by side, (nw', n² + 2n); of forces without the phase of the wave's arrival."""
    Z = h.radiation_damping - 1j * h.omega[:, None, None] * h.added_mass
    without = h.arrival(h.omega).conj()
    return h.curve(np.concatenate([Z.reshape(len(Z), -1), h.diffraction * without, h.froude_krylov * without], axis=1))


def _require_solved(h: Hydrodynamics, omega: np.ndarray) -> None:
    """Refuse frequencies (nw',) beyond those solved for."""
    low, high = h.omega[[0, -1]]
    # A band that ends on the grid may miss it by rounding.
    if not np.all((omega >= low * (1 - 1e-9)) & (omega <= high * (1 + 1e-9))):
        raise InputError(
            "omega", (float(omega.min()), float(omega.max())), f"must be within {low:.6g} to {high:.6g} rad/s"
        )


@lru_cache(maxsize=SEAS)
def _values(h: Hydrodynamics, omega: Bits[np.ndarray]) -> _Values:
    _require_solved(h, omega.value)
    n = len(h.added_mass_inf)
    Z, *forces = np.split(shared(_curves(h)(omega.value)), [n * n, n * n + n], axis=1)
    arrival = h.arrival(omega.value)
    return _Values(Z.reshape(-1, n, n), *(shared(force * arrival) for force in forces))


def symmetric(matrix: np.ndarray) -> np.ndarray:
    """The symmetric part of matrices (…, n, n), as reciprocity has the exact potential's; collocation misses it by a
    part of its error."""
    part: np.ndarray = (matrix + np.swapaxes(matrix, -1, -2)) / 2
    return part


def coarser(h: Hydrodynamics | None) -> list[str]:
    """Which hulls the boundary elements saw in fewer panels than their meshes have."""
    return [note for note in [h.settings.get("coarser", "")] if note] if h is not None else []


def cautions(h: Hydrodynamics | None) -> list[str]:
    """What could not be held against the hulls of a file's numbers, and what its mesh has of errors."""
    notes = [h.settings.get(key, "") for key in (UNJUDGED, ROUGHLY, STANDS_OUT)] if h is not None else []
    return [f"coefficients: {note}" for note in notes if note]


def lacking(h: Hydrodynamics) -> list[tuple[int, int]]:
    """Body and direction, from 0, of forces of waves that a file does not tell."""
    return [(column // 6, column % 6) for column in map(int, h.settings.get(LACKING, "").split())]


def coefficient_errors(h: Hydrodynamics | None) -> dict[str, float]:
    """By name: the largest share of a coefficient that the seabed has where it was left out, and that of the mesh."""
    if h is None:
        return {"seabed_error": 0.0, "mesh_error": 0.0}
    return {"seabed_error": float(h.settings.get("seabed_error", 0.0)), "mesh_error": h.mesh_error}
