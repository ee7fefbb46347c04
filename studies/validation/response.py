"""Response of floats on fixed hinges or guides: exact in the frequency domain, and read from records.

RAOs are complex, per unit wave amplitude at the origin, of each joint's axis.
"""

from dataclasses import replace

import numpy as np
from scipy.interpolate import CubicSpline

from solver.hydrodynamics.bem.coefficients import DOFS, Hydrodynamics
from solver.record.channels import Record
from solver.record.spectra import transfer
from solver.run import simulate
from solver.scene import Float, Scene, Settings
from solver.sea.realization import Realization, realize, regular
from solver.sea.spectrum import WhiteNoise

EVERY = 4  # samples of a record that count: 0.3 s at the default step, 10 rad/s


def frequency_domain(floats: tuple[Float, ...], h: Hydrodynamics, omega: np.ndarray) -> np.ndarray:
    """θ (nw, nj) of Jᵀ[-ω²(m + A) - iωB + C]J θ - iωB_PTO θ = Jᵀ X, all about each float's reference point.

    C is that of buoyancy and of the weight's lever; weight equals buoyancy, so that an arm adds nothing.
    """
    index = [DOFS.index(d) for d in h.dofs]
    nr, nj = len(h.dofs), sum(len(f.motion) for f in floats)
    J, rigid, C = np.zeros((nr * len(floats), nj)), np.zeros_like(h.added_mass_inf), h.hydrostatic_stiffness.copy()
    first = 0
    for b, item in enumerate(floats):
        block = slice(nr * b, nr * (b + 1))
        J[block, first : first + len(item.motion)] = np.array([_unit(item, name) for name in item.motion]).T[index]
        rigid[block, block] = _rigid(item)[np.ix_(index, index)]
        C[block, block] -= item.mass * h.gravity * item.cog[2] * np.diag([d in ("roll", "pitch") for d in h.dofs])
        first += len(item.motion)
    pto = np.diag(np.concatenate([f.per_axis("pto_damping") + f.per_axis("damping") for f in floats]))
    A, B = (CubicSpline(h.omega, x)(omega) for x in (h.added_mass, h.radiation_damping))
    w = omega[:, None, None]
    impedance = J.T @ (-(w**2) * (rigid + A) - 1j * w * B + C) @ J - 1j * w * pto
    return np.linalg.solve(impedance, (h.excitation(omega) @ J)[..., None])[..., 0]


def _unit(item: Float, name: str) -> np.ndarray:
    """Motion (6,) of the reference point for a unit motion of a joint's axis."""
    number = DOFS.index(name) if name != "hinge" else None
    if number is not None and number < 3:
        return np.eye(6)[number]
    axis = np.divide(item.axis, np.linalg.norm(item.axis)) if number is None else np.eye(3)[number - 3]
    return np.concatenate([np.cross(axis, item.arm), axis])


def _rigid(item: Float) -> np.ndarray:
    """Mass matrix (6, 6) about the reference point."""
    x, y, z = item.cog
    s = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    m = item.mass
    return np.block([[m * np.eye(3), -m * s], [m * s, np.diag(item.inertia) - m * s @ s]])


def white_noise(*, height: float, band: tuple[float, float], components: int, seed: int = 1) -> Realization:
    """A sea of constant density in `band` [rad/s], at random intervals."""
    return realize(WhiteNoise(Hs=height, band=band), components=components, band=band, seed=seed)


def from_record(record: Record, omega: np.ndarray) -> np.ndarray:
    """S_xy/S_xx (nw, nj) of all joints, of Heo, Koo and Kim (2022), eq. 22, line by line of the sea."""
    series = {name: values[::EVERY] for name, (_, values) in record.series.items()}
    motion = series.get("motion", series.get("rotation")).reshape(len(series["time"]), -1)
    there = np.isfinite(motion[0])  # axes that a float has and others do not
    return transfer(series["time"], series["wave_elevation"], motion[:, there], omega)


def irregular(scene: Scene, h: Hydrodynamics) -> np.ndarray:
    """RAO (nw, nj) at the frequencies of the scene's sea, from one run."""
    return from_record(simulate(scene, h), scene.sea.omega)


def regular_waves(scene: Scene, h: Hydrodynamics, waves: list[tuple[float, float]], *, cycles: int = 20) -> np.ndarray:
    """RAO (n, nj) of the first harmonic in each regular wave (height [m], period [s]), after `cycles` periods."""
    rows = []
    for height, period in waves:
        sea = regular(height=height, period=period)
        settings = replace(
            scene.settings, duration=20 * period, discard=cycles * period, ramp=5 * period,
            time_step=min(0.15, period / 40),
        )  # fmt: skip
        rows.append(irregular(replace(scene, sea=sea, settings=settings), h)[0])
    return np.array(rows)


def settings(**changes) -> Settings:
    """3,600 s after 100 s, as the paper; series kept."""
    return Settings(**{"memory_tolerance": 1e-3, "keep_series": True} | changes)


def smooth(omega: np.ndarray, values: np.ndarray, width: float = 0.1) -> np.ndarray:
    """Mean of |values| (nw, ...) over neighbours within ± width/2 [rad/s]: nonlinear waves scatter the lines."""
    near = np.abs(omega[:, None] - omega) <= width / 2
    return np.tensordot(near / near.sum(axis=1, keepdims=True), np.abs(values), 1)
