"""How the inner loops are compiled."""

from functools import partial

from numba import njit

# A sum of ~100 terms in another order differs in its last bits only; it lets the compiler use SIMD.
FAST = {"contract", "reassoc", "nsz", "arcp"}
# A division by zero gives inf, which the march looks for, and not a branch at every division: a tenth of its time.
kernel = partial(njit, cache=True, error_model="numpy", _nrt=True)
fast_kernel = partial(kernel, fastmath=FAST)
# Kernels that allocate nothing need not count who refers to their arrays, 25 ns at every call and view: an eighth of a
# march. numba's own, private option; what a counting kernel returns must not be handed to such a one, it would leak.
lean_kernel = partial(kernel, _nrt=False)
fast_lean_kernel = partial(fast_kernel, _nrt=False)
