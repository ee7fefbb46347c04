"""How the inner loops are compiled."""

from collections.abc import Callable
from functools import partial
from typing import Any, Protocol, TypeVar, overload

from numba import njit

Function = TypeVar("Function", bound=Callable[..., Any])


class Compiler(Protocol):
    """numba's decorator, bare or with options; the compiled function keeps its signature."""

    @overload
    def __call__(self, function: Function) -> Function: ...
    @overload
    def __call__(self, **options: Any) -> Callable[[Function], Function]: ...


# A sum of ~100 terms in another order differs in its last bits only; it lets the compiler use SIMD.
FAST = {"contract", "reassoc", "nsz", "arcp"}
# A division by zero gives inf, which the march looks for, and not a branch at every division: a tenth of its time.
COMMON: dict[str, Any] = {"cache": True, "error_model": "numpy", "no_cfunc_wrapper": True}
kernel: Compiler = partial(njit, **COMMON, _nrt=True)
fast_kernel: Compiler = partial(njit, **COMMON, _nrt=True, fastmath=FAST)
# Kernels that allocate nothing need not count who refers to their arrays, 25 ns at every call and view: an eighth of a
# march. numba's private option; what a counting kernel returns must not be handed to such a one, it would leak.
lean_kernel: Compiler = partial(njit, **COMMON, _nrt=False)
fast_lean_kernel: Compiler = partial(njit, **COMMON, _nrt=False, fastmath=FAST)
# Of those that only other kernels call, no door from Python is made (so a call from there crashes): with a march's
# hundred arrays it would take five seconds of the compiler, ten times what the rest of a short kernel takes.
inner_kernel: Compiler = partial(njit, **COMMON, _nrt=False, no_cpython_wrapper=True)
