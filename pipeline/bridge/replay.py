"""A task marched again, to be looked at: where its bodies, its platform and the waves' surface are at given times."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from pipeline.bridge import cache, scenes
from pipeline.bridge.hulls import silhouette
from pipeline.tasks.task import Parameters
from solver.errors import InputError

if TYPE_CHECKING:
    from solver.coupled.problem import Output
    from solver.coupled.system import System

SEEN = [0, 2]  # x and z, along y
ROUNDING = 1e-9  # of times [s]
Told = Callable[[float], None]  # the share that is done


class Pose(NamedTuple):
    """A scene at one instant, seen along y: points (…, 2) of x and z [m]."""

    hulls: list[np.ndarray]  # outline (k, 2) of each float
    hinges: np.ndarray  # (nb, 2)
    centres: np.ndarray  # (nb, 2) reference points
    fairleads: list[np.ndarray]  # (nl, 2) of each float's lines
    members: list[np.ndarray]  # by how much ends of an elastic platform's elements have moved (k, 2)


@dataclass(frozen=True, eq=False, kw_only=True)
class Replay:
    """Coordinates z (n, nz) of floats and p (n, nm) of modes at times (n,) [s] of one march.

    magnify: times what the platform moves by, and with it the floats' hinges.
    """

    parameters: Parameters
    system: System
    times: np.ndarray
    z: np.ndarray
    p: np.ndarray
    magnify: float = 1.0

    def elevation(self, x: np.ndarray) -> np.ndarray:
        """η (n, nx) [m] of the incident waves at x (nx,) [m], in the middle of the floats, or of the platform, in y."""
        from solver.sea.realization import ramp

        scene = self.system.scene
        s, frame = scene.settings, scene.platform.frame.nodes.values() if scene.platform else ()
        y = [f.centre[1] for f in scene.floats] or [node[1] for node in frame] or [0.0]
        points = np.stack([x, np.full(x.shape, np.mean(y)), np.zeros(x.shape)], axis=-1)
        turn = np.exp(-1j * np.outer(self.times, scene.sea.omega)) * ramp(self.times, s.ramp, s.ramp_form)[:, None]
        return np.asarray((turn @ self.system.waves.elevation(points).T).real)

    def stations(self) -> list[int]:
        """How many ends of elements each member of an elastic platform has."""
        return [len(nodes) for nodes in self._nodes[1]]

    def poses(self) -> Iterator[Pose]:
        """At each of the times, one after another."""
        from solver.multibody.bodies import new_motion
        from solver.multibody.minimal import move

        system, floats, carriers = self.system, self.system.scene.floats, self.system.scene.carriers
        motion, rates, (carrying, members) = new_motion(system.bodies), np.zeros(self.z.shape[1]), self._nodes
        for z, p in zip(self.z, self.p, strict=True):
            if floats:
                move(system.bodies, z, rates, motion)
            moved = self._moved(p)
            at, R, hinges = motion.position.copy(), motion.rotation, np.array([f.hinge for f in floats]).reshape(-1, 3)
            if carrying:
                at += (self.magnify - 1) * moved[carrying]
                hinges += self.magnify * moved[carrying]
            for b, on in enumerate(carriers):
                if on >= 0:
                    hinges[b] = at[on] + R[on] @ (floats[b].hinge - floats[on].centre)
            shapes = [item.hull for item in self.parameters.floats]
            yield Pose(
                [place[SEEN] + silhouette(shape, turn) for place, shape, turn in zip(at, shapes, R, strict=True)],
                hinges[:, SEEN],
                at[:, SEEN],
                [
                    (place + np.reshape([line.fairlead for line in f.lines], (-1, 3)) @ turn.T)[:, SEEN]
                    for place, f, turn in zip(at, floats, R, strict=True)
                ],
                [self.magnify * moved[nodes][:, SEEN] for nodes in members],
            )

    @cached_property
    def _nodes(self) -> tuple[list[int], list[np.ndarray]]:
        """Numbers of the nodes that carry each float, and of those along each member, of an elastic platform."""
        from solver.coupled.support import dynamic_model

        scene = self.system.scene
        if scene.platform is None:
            return [], []
        model = dynamic_model(scene.platform.undamped(), scene.water)[0]
        carrying = [model.node_index[scene.platform.hinge_nodes[f.name]] for f in scene.floats]
        return carrying, [model.member_nodes[member.name] for member in model.frame.members]

    def _moved(self, p: np.ndarray) -> np.ndarray:
        """Displacement (nodes, 3) [m] of the platform's nodes, from where they are without floats and waves."""
        support = self.system.support
        return np.zeros((0, 3)) if support is None else (support.shapes @ p).reshape(-1, 6)[:, :3]


def replay(
    parameters: Parameters, coefficients: bytes | None, times: np.ndarray, told: Told, *, magnify: float = 1.0
) -> Replay:
    """March a task as its record was, with its geometry's file, and keep where all is at times (n,) that rise [s].

    InputError for a task without a history. The motion between two samples of a step is taken as a straight line.
    """
    from pipeline.bridge.engine import import_solver
    from solver.run import simulate

    require_history(parameters)
    scene = scenes.scene(parameters)
    import_solver()
    film = _Film(times, told, scene.settings.discard + scene.settings.duration)
    simulate(scene, cache.decode(coefficients) if coefficients else None, film)
    z, p = map(np.concatenate, film.parts)
    return Replay(parameters=parameters, system=film.system, times=times, z=z, p=p, magnify=magnify)


def require_history(parameters: Parameters) -> None:
    """InputError where a task's method leaves no motions in time, or none that are known here."""
    settings = scenes.settings(parameters)
    if settings.method == "frequency":
        raise InputError("solver.method", settings.method, 'has no history to be seen: must be "time"')
    if settings.paths.formulation == "augmented":
        raise InputError("solver", "the paper's method", f"is not shown: needs {settings.minimal}")


class _Film:
    """Takes the samples of a run about given times, and begins anew with a run that does."""

    system: System
    at: tuple[np.ndarray, np.ndarray]  # z and p of the last sample
    parts: tuple[list[np.ndarray], list[np.ndarray]]  # of them at the times asked for, block by block
    taken: int  # of these times

    def __init__(self, times: np.ndarray, told: Told, end: float):
        self.times, self.told, self.end = times, told, end
        self.last = np.inf  # sample's time

    def __call__(self, system: System, times: np.ndarray, output: Output) -> None:
        if times[0] <= self.last:
            start = system.start()
            carriers = system.structure.carrier @ start.p
            self.system, self.last, self.at = system, 0.0, (np.concatenate([carriers, start.z]), start.p)
            self.taken, self.parts = 0, ([], [])
        asked = self.times[self.taken : np.searchsorted(self.times, times[-1] + ROUNDING, "right")]
        known = np.append(self.last, times)
        for kept, first, values in zip(self.parts, self.at, (output.z, output.p), strict=True):
            kept.append(_between(known, np.concatenate([first[None], values]), asked))
        self.last, self.at, self.taken = times[-1], (output.z[-1].copy(), output.p[-1].copy()), self.taken + len(asked)
        self.told(times[-1] / self.end)


def _between(times: np.ndarray, values: np.ndarray, at: np.ndarray) -> np.ndarray:
    """(k, n) of samples (m, n), on straight lines."""
    i = np.clip(np.searchsorted(times, at), 1, len(times) - 1)
    share = ((at - times[i - 1]) / (times[i] - times[i - 1]))[:, None]
    return np.asarray((1 - share) * values[i - 1] + share * values[i])
