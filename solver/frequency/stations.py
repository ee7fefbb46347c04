"""Drag of the water on a moving frame, linearised by what moves against it."""

import numpy as np

from solver.coupled import linear_drag
from solver.coupled.modal import Structure


class Stations:
    """The frame's drag at its ns stations, in nd directions, in water of velocity (nw, nd ns) and a current (nd, ns).

    Lines are taken as twice as many real ones, for products with real shapes.
    """

    def __init__(self, frame: Structure, water: np.ndarray, stream: np.ndarray | None):
        """stream: None where there is none."""
        self.frame, self.size = frame, frame.drag.size
        self.stream = stream if stream is not None and stream.any() else None
        nm, nd, ns = frame.station.shape
        self.shape = frame.station.reshape(nm, nd * ns)
        self.water = np.concatenate([water.real, water.imag])

    def _flow(self, rate: np.ndarray) -> np.ndarray:
        """Of the water past the frame (2 nw, nd, ns) at modal rates (nw, nm)."""
        flow = self.water - np.concatenate([rate.real, rate.imag]) @ self.shape
        return flow.reshape(len(flow), *self.frame.station.shape[1:])

    def equivalent(self, rate: np.ndarray) -> np.ndarray:
        """K (ns, nd, nd) [N s/m] at modal rates (nw, nm)."""
        flow = self._flow(rate)
        K = linear_drag.of_parts(flow) if self.stream is None else linear_drag.of_parts_in(self.stream, flow)[1]
        return K * self.frame.drag[:, None, None]

    def mean(self, rate: np.ndarray) -> np.ndarray:
        """Mean drag (nd, ns) [N] at modal rates (nw, nm): none without a current."""
        if self.stream is None:
            return np.zeros(self.frame.station.shape[1:])
        return self.frame.drag * linear_drag.of_parts_in(self.stream, self._flow(rate))[0].T

    def acting(self, K: np.ndarray, on: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """By maps (k, nd, ns) of the drag: damping of what it does against modal rates (k, nm), the water's (nw, k)."""
        carried = linear_drag.by_station(np.swapaxes(K, 1, 2), on).reshape(len(on), self.shape.shape[1])
        return carried @ self.shape.T, _lines(self.water @ carried.T)


def _lines(parts: np.ndarray) -> np.ndarray:
    """Complex lines (nw, k) of their real parts above their imaginary ones (2 nw, k)."""
    half = len(parts) // 2
    return parts[:half] + 1j * parts[half:]
