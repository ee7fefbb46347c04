"""Modal against direct integration of the Buan frame under the same waves, and nothing in common but its matrices."""

from dataclasses import replace

import numpy as np
from scipy import linalg

from solver.run import simulate
from solver.scene import Scene
from solver.sea.field import WaveField
from solver.sea.realization import ramp
from solver.structure import water
from solver.structure.frame_model import FrameModel, assemble
from studies.validation import drawing
from studies.validation.cases import buan
from studies.validation.checks import Check
from studies.validation.drawing import BLUE, GREY, ORANGE


def direct(scene: Scene, step: float) -> tuple[np.ndarray, FrameModel, np.ndarray]:
    """t (nt,), the frame, and the displacement (nt, nfree) of all its degrees of freedom.

    Newmark's average acceleration on M d̈ + C ḋ + K d = f(t) + drag(ḋ), M with the water's, C of the
    platform's ratio in every mode, drag ½ρC_D D|u - v|(u - v) iterated within the step.
    """
    platform, sea, s = scene.platform, scene.sea, scene.settings
    model = assemble(platform.frame)
    free = model.free
    M = (model.M + water.added_mass(model, scene.water.density))[free][:, free].toarray()
    K = model.K[free][:, free].toarray()
    squared, shapes = linalg.eigh(K, M)
    omega = np.sqrt(squared)
    C = M @ shapes @ np.diag(2 * platform.damping.of(omega, np.ones(omega.size)) * omega) @ shapes.T @ M
    field = WaveField(sea, scene.water.depth, scene.water.gravity)
    push, speed, shape, drag = _wave_loads(model, field, scene.water.density, s.stations_per_element)
    flexibility = linalg.inv(M * 4 / step**2 + C * 2 / step + K)
    steps = round((s.discard + s.duration) / step)
    d, v = np.zeros(len(free)), np.zeros(len(free))
    a = np.zeros(len(free))  # nothing loads the frame at t = 0 of a ramp
    history = np.zeros((steps + 1, len(free)))
    for n in range(1, steps + 1):
        t = n * step
        wave = np.exp(-1j * sea.omega * t) * ramp(t, s.ramp, s.ramp_form)
        force, u = (push @ wave).real, (speed @ wave).real
        known = force + M @ (4 / step**2 * d + 4 / step * v + a) + C @ (2 / step * d + v)
        new, rate = d, v
        for _ in range(20):
            relative = u - (shape @ rate).reshape(-1, 3)
            load = drag[:, None] * np.linalg.norm(relative, axis=1)[:, None] * relative
            before, new = new, flexibility @ (known + shape.T @ load.ravel())
            rate = 2 / step * (new - d) - v
            if np.abs(new - before).max() < 1e-12:
                break
        a = 4 / step**2 * (new - d) - 4 / step * v - a
        d, v = new, rate
        history[n] = d
    return step * np.arange(steps + 1), model, history


def _wave_loads(model, field, density, points):
    """Nodal inertia load (nfree, n), normal speed (ns, 3, n), normal shapes (3 ns, nfree), ½ρC_D D w (ns,)."""
    at, fine = water.stations(model, points), water.stations(model, 4)

    def normal(s):
        return np.eye(3) - s.tangent[:, :, None] * s.tangent[:, None, :]

    size = fine.inertia * density * np.pi / 4 * fine.diameter**2 * fine.weight
    inertia = size[:, None, None] * (normal(fine) @ field.acceleration(fine.position))
    push = np.zeros((6 * len(model.xyz), inertia.shape[2]), complex)
    np.add.at(push, fine.dofs, np.einsum("ska,skn->san", fine.shape, inertia))
    whole = np.zeros((len(at.weight), 3, 6 * len(model.xyz)))
    for i, (dofs, shape, project) in enumerate(zip(at.dofs, at.shape, normal(at), strict=True)):
        whole[i][:, dofs] = project @ shape
    drag = 0.5 * density * at.drag * at.diameter * at.weight
    shapes = whole.reshape(-1, whole.shape[2])[:, model.free]
    return push[model.free], normal(at) @ field.velocity(at.position), shapes, drag


def modal_against_direct() -> list[Check]:
    """Sway of leg 1's top in the representative sea, no floats: all modes and the default six."""
    base = buan("elastic-no-floats")
    step = base.usual_step
    quiet = replace(base.settings, duration=120.0, discard=0.0, ramp=30.0, keep_series=True, time_step=step)
    scene = replace(base, settings=quiet)
    records = {
        name: simulate(replace(scene, settings=replace(quiet, modes=count)))
        for name, count in (("all modes", "all"), ("6 modes", 6))
    }
    time, model, history = direct(scene, step / 6)
    top = np.searchsorted(model.free, model.translations("top1")[0])
    checks, curves = [], {}
    for name, record in records.items():
        ours = record.series["top_displacement"][1][:, 0, 0]
        other = history[1:][2::3, top][: len(ours)]  # its step is a third of the record's samples
        curves[name] = ours
        apart = np.sqrt(np.mean((ours - other) ** 2) / np.mean(other**2))
        # Newmark's error at this step, (ω dt)²/12 with ω up to 3.4 rad/s: 6e-4.
        checks.append(
            Check(
                case="frame, modal against direct", quantity=f"top of leg 1, x: rms difference over rms, {name}",
                ours=float(apart), published=0.0, allowed=1e-3,
            )
        )  # fmt: skip
    t = records["6 modes"].series["time"][1]
    figure, (above, below) = drawing.plt.subplots(2, 1, figsize=(7.5, 4.6), sharex=True, height_ratios=[2, 1])
    above.plot(time, 1e3 * history[:, top], color=GREY, lw=2.6, alpha=0.6, label="direct, 708 degrees of freedom")
    above.plot(t, 1e3 * curves["6 modes"], color=BLUE, lw=1, label="ours, 6 modes and static shapes")
    for name, colour in (("6 modes", BLUE), ("all modes", ORANGE)):
        other = history[1:][2::3, top][: len(t)]
        below.plot(t, 1e6 * (curves[name] - other), color=colour, lw=0.9, label=name)
    above.set(ylabel="x at top of leg 1 [mm]", title="Buan platform without floats, representative sea")
    below.set(xlabel="time [s]", ylabel="difference [µm]")
    drawing.save(figure, "modal-direct")
    return checks
