"""Drag of the water on a moving frame, linearised by what moves against it."""

from functools import cached_property, reduce

import numpy as np

from solver.coupled.linear_drag import covariance, in_stream, of_gaussian, of_parts, of_parts_in
from solver.coupled.modal import Structure
from solver.kernels import whole_lean_kernel
from solver.lines import real_parts


class Stations:
    """The frame's drag at its ns stations, in nd directions, in water of velocity (nd ns, nw) and a current (nd, ns).

    Few patterns of that velocity and their lines take its place in products, where they are known. Complex lines are
    taken as twice as many real numbers, side by side, for products with real shapes.
    """

    def __init__(
        self, frame: Structure, water: np.ndarray, stream: np.ndarray | None, patterns: np.ndarray | None = None
    ):
        """stream: None where there is none; patterns (nd ns, r) that the water is made of, orthonormal, if known."""
        self.frame, self.size = frame, frame.drag.size
        self.stream = stream if stream is not None and stream.any() else None
        nm, nd, ns = frame.station.shape
        self.on, self.shape = (nd, ns), frame.station.reshape(nm, nd * ns)
        self.water = real_parts(water)
        self.factors = [self.water] if patterns is None else [patterns, patterns.T @ self.water]
        self._of = np.concatenate([self.shape.T, self.factors[0]], axis=1)  # of frame and water, in one product

    def flow(self, rate: np.ndarray | None) -> np.ndarray:
        """Of the water past the frame (nd, ns, 2 nl) at modal rates (nm, nl), of lines of which the first nw are waves;
        None of a frame that does not move.
        """
        flow = self.water
        if rate is not None:
            flow = (-self.shape).T @ real_parts(rate)
            flow[:, : self.water.shape[1]] += self.water
        return flow.reshape(*self.on, flow.shape[1])

    def covariance(self, rate: np.ndarray | None) -> np.ndarray:
        """Of that flow (ns, nd, nd): ⟨ww⟩ + φe + eφ, e = ½⟨vv⟩φ - ⟨vw⟩, of the water's velocity w less φv."""
        if rate is None:
            return self._at_rest
        v = real_parts(rate)
        along = reduce(np.matmul, [part.T for part in self.factors[:0:-1]], v[:, : self.water.shape[1]])
        e = np.concatenate([0.25 * v @ v.T, -0.5 * along], axis=1) @ self._of.T
        S = self._at_rest.copy()
        _add_both_ways(self.frame.station, e.reshape(self.frame.station.shape), S)
        return S

    @cached_property
    def _at_rest(self) -> np.ndarray:
        return covariance(self.flow(None))

    def equivalent(self, rate: np.ndarray | None) -> np.ndarray:
        """K (ns, nd, nd) [N s/m] at modal rates (nm, nw), or of a frame that does not move."""
        return self._drag(rate)[1] * self.frame.drag[:, None, None]

    def mean(self, rate: np.ndarray) -> np.ndarray:
        """Mean drag (nd, ns) [N] at modal rates (nm, nw): none without a current."""
        return self.frame.drag * self._drag(rate)[0].T

    def _drag(self, rate: np.ndarray | None) -> tuple[np.ndarray, np.ndarray]:
        """Mean (ns, nd) and K of the flow: of one harmonic, or of a Gaussian process."""
        if self.water.shape[1] == 2:
            flow = self.flow(rate)
            return (self._none, of_parts(flow)) if self.stream is None else of_parts_in(self.stream, flow)
        S = self.covariance(rate)
        return (self._none, of_gaussian(S)) if self.stream is None else in_stream(self.stream.T, S)

    @property
    def _none(self) -> np.ndarray:
        return np.zeros((self.size, self.on[0]))

    def acting(self, K: np.ndarray, on: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """By maps (k, nd, ns) of the drag: damping of what it does against modal rates (k, nm), the water's (k, nw)."""
        both, nm = self._carried(K, on) @ self._of, len(self.shape)
        return both[:, :nm], reduce(np.matmul, self.factors[1:], np.ascontiguousarray(both[:, nm:])).view(complex)

    def against(self, K: np.ndarray) -> np.ndarray:
        """Damping of the modes (nm, nm)."""
        return self._carried(K, self.frame.station) @ self.shape.T

    def _carried(self, K: np.ndarray, on: np.ndarray) -> np.ndarray:
        carried = np.empty((len(on), self.shape.shape[1]))
        _carry(K, on, carried.reshape(on.shape))
        return carried


@whole_lean_kernel
def _carry(K: np.ndarray, on: np.ndarray, carried: np.ndarray) -> None:
    """linear_drag.by_station of real maps (k, nd, ns), K (ns, nd, nd) transposed; in a third of its time."""
    k, nd, ns = on.shape
    carried[:] = 0.0
    for m in range(k):
        for i in range(nd):
            for j in range(nd):
                for s in range(ns):
                    carried[m, j, s] += on[m, i, s] * K[s, i, j]


@whole_lean_kernel
def _add_both_ways(shape: np.ndarray, e: np.ndarray, S: np.ndarray) -> None:
    """Σ φe + eφ of φ and e (k, nd, ns), to S (ns, nd, nd)."""
    k, nd, ns = shape.shape
    for m in range(k):
        for i in range(nd):
            for j in range(nd):
                for s in range(ns):
                    S[s, i, j] += shape[m, i, s] * e[m, j, s] + e[m, i, s] * shape[m, j, s]
