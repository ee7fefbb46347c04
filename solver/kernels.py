"""How the inner loops are compiled."""

import gc
import os
from collections import Counter, defaultdict
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager, suppress
from functools import partial
from hashlib import sha256
from typing import Any, Protocol, TypeVar, overload

# What LLVM does beyond its first level takes a sixth of the compiler's time and makes no march faster.
os.environ.setdefault("NUMBA_OPT", "1")
from filelock import FileLock
from numba import njit
from numba.core import event, ir
from numba.core.analysis import compute_cfg_from_blocks, compute_use_defs, must_use_alloca
from numba.core.caching import FunctionCache
from numba.core.codegen import JITCodeLibrary, ll
from numba.core.compiler import Compiler as NumbaCompiler
from numba.core.dispatcher import Dispatcher
from numba.core.lowering import Lower
from numba.core.runtime import rtsys

Function = TypeVar("Function", bound=Callable[..., Any])


class Compiler(Protocol):
    """numba's decorator, bare or with options; the compiled function keeps its signature."""

    @overload
    def __call__(self, function: Function) -> Function: ...
    @overload
    def __call__(self, **options: Any) -> Callable[[Function], Function]: ...


class _Uncollected(event.Listener):  # type: ignore[misc]  # numba has no types
    """No garbage is looked for while the compiler runs, which makes millions of objects: a sixth of its time."""

    def __init__(self) -> None:
        self.depth = 0  # of functions that ask for others to be compiled
        self.enabled = True

    def on_start(self, _event: event.Event) -> None:
        if self.depth == 0:
            self.enabled = gc.isenabled()
            gc.disable()
        self.depth += 1

    def on_end(self, _event: event.Event) -> None:
        self.depth -= 1
        if self.depth == 0 and self.enabled:
            gc.enable()


event.register("numba:compile", _Uncollected())


def _load(cache: Any, signature: Any, target: Any) -> Any:
    """What is in the cache, without all that numba first learns of compiling: that takes longer than most loading.

    Of what it learns machine code needs numba's runtime alone; the compiler, where something is not there, learns it.
    """
    rtsys.initialize(target)
    with cache._guard_against_spurious_io_errors():
        return cache._load_overload(signature, target)


FunctionCache.load_overload = _load


@contextmanager
def one_at_a_time(folder: str, name: str) -> Iterator[None]:
    """Other processes wait that make what has this name in a folder."""
    with ExitStack() as held:
        with suppress(OSError, NotImplementedError):  # a disk that is full, or has no locks: each for itself
            os.makedirs(folder, exist_ok=True)
            held.enter_context(FileLock(os.path.join(folder, f"{name}.lock"), is_singleton=True))
        yield


def _compile_once(dispatcher: Any, signature: Any, compiled: Any = Dispatcher.compile) -> Any:
    """Of processes that need the same kernel, for the same types, one compiles it, and the others wait to load it.

    They wait for each other in no circle, as kernels do not call each other in one.
    """
    cache = dispatcher._cache
    if cache.cache_path is None or signature in dispatcher.overloads:
        return compiled(dispatcher, signature)
    types = sha256(str(signature).encode()).hexdigest()[:16]
    with one_at_a_time(cache.cache_path, f"{cache._impl.filename_base}.{types}"):
        return compiled(dispatcher, signature)


Dispatcher.compile = _compile_once  # type: ignore[assignment, method-assign]


def _save(cache: Any, signature: Any, data: Any, saved: Any = FunctionCache.save_overload) -> None:
    """One at a time: numba reads a kernel's index, adds to it and writes it."""
    with one_at_a_time(cache.cache_path, cache._impl.filename_base):
        saved(cache, signature, data)


FunctionCache.save_overload = _save


def _find_values(lower: Any, found: Any = Lower._find_singly_assigned_variable) -> None:
    """What a kernel is handed, and what it sets once and on every way to where it is used, are values without a place.

    numba knows that of what one block alone uses. Else a scene's hundred arrays are copied to memory and back number by
    number at every use, for the compiler to find out that they never change: half of its time.
    """
    found(lower)
    if lower.context.enable_nrt:  # who refers to an array counts by where it lies
        return
    blocks = lower.blocks
    before, used = compute_cfg_from_blocks(blocks).dominators(), defaultdict(set)
    for label, names in compute_use_defs(blocks).usemap.items():
        for name in names:
            used[name].add(label)
    sets = [(each.target.name, label) for label, block in blocks.items() for each in block.find_insts(ir.Assign)]
    often = Counter(name for name, _ in sets)
    lower._singly_assigned_vars |= {
        name
        for name, label in sets
        if often[name] == 1 and all(label < use and label in before[use] for use in used[name] - {label})
    } - must_use_alloca(blocks)


Lower._find_singly_assigned_variable = _find_values


class _Plain(JITCodeLibrary):  # type: ignore[misc]
    """Optimized as a whole alone: what numba does to each function before that is done again, an eighth of its time."""

    def _optimize_functions(self, module: Any) -> None:
        module.data_layout = self._codegen._data_layout


class _Part(_Plain):
    """A kernel that only others call: optimized and made machine code of in these alone.

    numba does both for each kernel with all that it calls, so as often as there are levels above: a quarter of its
    time.
    """

    _final_module: Any

    def _optimize_final_module(self) -> None:
        pass

    def _finalize_final_module(self) -> None:
        """Make machine code of the pointers to environments alone: numba sets them for every kernel."""
        whole = self._final_module
        code = str(self._codegen._create_empty_module(self.name))
        for variable in whole.global_variables:
            if variable.name.startswith("_ZN08NumbaEnv"):
                code += f'@"{variable.name}" = common global ptr null\n'
        self._final_module = ll.parse_assembly(code)
        super()._finalize_final_module()
        self._final_module = whole


class _Whole(_Plain):
    """A kernel that no other calls: its cache needs no code that others might take in, which takes 0.1 s to read."""

    def serialize_using_object_code(self) -> tuple[str, str, tuple[bytes, bytes]]:
        """Name, kind and machine code, with its door from Python alone for a module."""
        code = str(self._codegen._create_empty_module(self.name))
        for function in self.get_defined_functions():
            if function.name.startswith("_ZN7cpython"):
                code += f'define void @"{function.name}"() {{ ret void }}\n'
        return self.name, "object", (self._get_compiled_object(), ll.parse_assembly(code).as_bitcode())


class _Compiler(NumbaCompiler):  # type: ignore[misc]
    kind: type[JITCodeLibrary]

    def __init__(self, typing: Any, target: Any, _library: Any, *others: Any) -> None:
        library = self.kind(target.codegen(), self.kind.__name__)
        library.enable_object_caching()
        super().__init__(typing, target, library, *others)


class _PartCompiler(_Compiler):
    kind = _Part


class _WholeCompiler(_Compiler):
    kind = _Whole


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
# One that no other kernel calls: such a call would end in numba's error of a symbol that is not there.
whole_kernel: Compiler = partial(kernel, pipeline_class=_WholeCompiler)
whole_lean_kernel: Compiler = partial(lean_kernel, pipeline_class=_WholeCompiler)
# Of those that only other kernels call, no door from Python is made (so a call from there crashes): with a march's
# hundred arrays it would take five seconds of the compiler, ten times what the rest of a short kernel takes.
inner_kernel: Compiler = partial(njit, **COMMON, _nrt=False, no_cpython_wrapper=True, pipeline_class=_PartCompiler)
# With `forceinline` a part of every step is taken into what calls it: handing it a scene's hundred arrays, eight
# numbers each, took a third of a march. What few steps need, or several places, is not: it would be compiled each time.
part_kernel: Compiler = partial(inner_kernel, forceinline=True)
