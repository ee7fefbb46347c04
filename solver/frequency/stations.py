"""Drag of the water on a moving frame, linearised by what moves against it."""

import numpy as np

from solver.coupled import linear_drag
from solver.coupled.modal import Structure


class Stations:
    """The frame's drag at its ns stations, in nd directions, in water of velocity (nd ns, nw) and a current (nd, ns).

    Complex lines are taken as twice as many real numbers, side by side, for products with real shapes.
    """

    def __init__(self, frame: Structure, water: np.ndarray, stream: np.ndarray | None):
        """stream: None where there is none."""
        self.frame, self.size = frame, frame.drag.size
        self.stream = stream if stream is not None and stream.any() else None
        nm, nd, ns = frame.station.shape
        self.on, self.shape = (nd, ns), frame.station.reshape(nm, nd * ns)
        self.water = np.ascontiguousarray(water).view(float)

    def flow(self, rate: np.ndarray | None) -> np.ndarray:
        """Of the water past the frame (nd, ns, 2 nl) at modal rates (nm, nl), of lines of which the first nw are waves;
        None of a frame that does not move.
        """
        flow = self.water
        if rate is not None:
            flow = (-self.shape).T @ np.ascontiguousarray(rate).view(float)
            flow[:, : self.water.shape[1]] += self.water  # in place: memory is dearer here than sums
        return flow.reshape(*self.on, flow.shape[1])

    def equivalent(self, rate: np.ndarray | None) -> np.ndarray:
        """K (ns, nd, nd) [N s/m] at modal rates (nm, nw), or of a frame that does not move."""
        flow = self.flow(rate)
        K = linear_drag.of_parts(flow) if self.stream is None else linear_drag.of_parts_in(self.stream, flow)[1]
        return K * self.frame.drag[:, None, None]

    def mean(self, rate: np.ndarray) -> np.ndarray:
        """Mean drag (nd, ns) [N] at modal rates (nm, nw): none without a current."""
        if self.stream is None:
            return np.zeros(self.frame.station.shape[1:])
        return self.frame.drag * linear_drag.of_parts_in(self.stream, self.flow(rate))[0].T

    def acting(self, K: np.ndarray, on: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """By maps (k, nd, ns) of the drag: damping of what it does against modal rates (k, nm), the water's (k, nw)."""
        carried = self._carried(K, on)
        return carried @ self.shape.T, (carried @ self.water).view(complex)

    def against(self, K: np.ndarray) -> np.ndarray:
        """Damping of the modes (nm, nm)."""
        return self._carried(K, self.frame.station) @ self.shape.T

    def _carried(self, K: np.ndarray, on: np.ndarray) -> np.ndarray:
        return linear_drag.by_station(np.swapaxes(K, 1, 2), on).reshape(len(on), self.shape.shape[1])
