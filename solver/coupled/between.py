"""What the wave does between its samples: by the polynomial through the nearest NODES of them.

Of n nodes 0, 1, ... the weights are w_j(x) = Π_{k≠j} (x - k)/(j - k), with denominators (-1)^(n-1-j) j! (n-1-j)!.
"""

import numpy as np

from solver.kernels import inner_kernel, whole_lean_kernel

NODES = 6


@inner_kernel
def nearest(at: float, count: int, weight: np.ndarray) -> int:
    """First of the nodes about `at` among so many samples; their weights (NODES,), zero where there are not enough."""
    n = min(NODES, count)
    first = min(max(int(np.floor(at)) - (n // 2 - 1), 0), count - n)
    x, below, share = at - first, 1.0, 1.0
    for j in range(NODES):
        weight[j] = below if j < n else 0.0
        below *= x - j
    for j in range(1, n):
        share /= -j  # (-1)^(n-1)/(n-1)!
    above = 1.0
    for j in range(n):
        weight[j] *= share
        share *= -(n - 1 - j) / (j + 1)
    for j in range(n - 1, -1, -1):
        weight[j] *= above
        above *= x - j
    return first


@whole_lean_kernel
def interpolate(samples: np.ndarray, at: np.ndarray, weight: np.ndarray, values: np.ndarray) -> None:
    """Fill values (k, n) at places (k,) among samples (m, n), which need not be whole; weight (NODES,): scratch."""
    for row in range(at.size):
        first = nearest(at[row], samples.shape[0], weight)
        values[row] = 0.0
        for j in range(min(NODES, samples.shape[0])):
            for i in range(samples.shape[1]):
                values[row, i] += weight[j] * samples[first + j, i]
