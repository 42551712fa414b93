"""The one Numba policy: every kernel of the library is compiled by the decorators here, nothing else imports Numba.

`nogil=True` lets trackers run in threads. `error_model="numpy"` drops the zero-division checks, so kernels guard their
divisions themselves. `fastmath` is off; with `reassociate` the order of a sum's terms is free, so that they are added
several at a time, with `fused` a product is added without being rounded. On one machine results are the same, bit for
bit, from run to run.

The machine code is kept on disk, so only the first run on a machine compiles. This file alone touches what Numba does
not promise to keep. tests/numeric/test_private_hooks.py says of each what breaks without it, and of which versions,
docs/decisions/141-what-the-private-hooks-of-numba-save.md what it saves:

- ``Dispatcher._cache``, ``caching._Cache``, ``CompileResult._reduce``, ``_rebuild``: where a kernel's code is kept.
  Numba keeps it beside the source, or for one path of it, looks at a kernel's own file alone to see whether it is
  still good, trusts what it reads, and is ended by a full disk; it files the code of a closure under all that it
  holds, pickled, which changes under a profiler and takes 50 ms. Here it is kept for what the files say
  (`source_stamp`: the kernel's own and those that it imports), wherever they are, and filed under the identity of what
  it holds (`identity`); `KeptCode` looks whether it is whole.
- ``serialize.dumps``: what Numba keeps, as bytes.
- ``linalg.ensure_blas``: Numba imports SciPy's linear algebra, 0.1 s, in case a kernel needs it; here when one does.
- option ``_nrt=False``: no references are counted.
- ``codegen.JITCodeLibrary``: Numba optimizes every function and makes machine code of it, and both again with each
  that calls it; what only kernels call is left as it was written, and optimized with those, once (decision 081).
- ``compiler.Compiler``, passes: only those run that code without arrays of its own needs (`PASSES`).
- ``BaseFunction.get_call_type``: Numba looks the type of every ``a + b`` up anew, several times; here once.
"""

import contextlib
import functools
import gc
import importlib
import re
import sys
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any, TypeVar, cast, overload

import numba
from numba.core import (
    caching,
    codegen,
    compiler,
    compiler_machinery,
    serialize,
    targetconfig,
    typed_passes,
    untyped_passes,
)
from numba.core.types.functions import BaseFunction

from matchset.numeric.code_identity import identity
from matchset.numeric.compiling import compiling
from matchset.numeric.kept_code import KeptCode, kept_folder, make_kept_folder, say_once, source_stamp

F = TypeVar("F", bound=Callable[..., Any])
_LIBRARY: Any = codegen.JITCodeLibrary  # Numba's types are not complete
_COMPILER: Any = compiler.Compiler
_FUNCTION: Any = BaseFunction
_CACHE: Any = cast(Any, caching)._Cache
_RESULT: Any = compiler.CompileResult


def _put_off_scipy() -> None:
    """Import Numba's array functions without SciPy; what multiplies matrices imports it when it is compiled."""
    linalg: Any = importlib.import_module("numba.np.linalg")
    if "numba.np.arraymath" in sys.modules or not hasattr(linalg, "ensure_blas"):
        return
    ensure_blas, linalg.ensure_blas = linalg.ensure_blas, lambda: None
    try:
        importlib.import_module("numba.np.arraymath")
    finally:
        linalg.ensure_blas = ensure_blas


_put_off_scipy()


_EVENT: Any = importlib.import_module("numba.core.event")


class _CompileListener(_EVENT.Listener):  # type: ignore[misc]
    """Hears of what Numba compiles, not of what it finds kept."""

    def on_start(self, event: Any) -> None:  # noqa: ARG002 - which kernel it is does not matter
        compiling()

    def on_end(self, event: Any) -> None:
        pass


_EVENT.register("numba:compile", _CompileListener())


@overload
def kernel(function: F) -> F: ...
@overload
def kernel(
    *, refcount: bool = True, reassociate: bool = False, fused: bool = False, entry: bool = True
) -> Callable[[F], F]: ...


def kernel(
    function: Any = None,
    *,
    refcount: bool = True,
    reassociate: bool = False,
    fused: bool = False,
    entry: bool = True,
) -> Any:
    """Compile a function of arrays and scalars that neither raises nor prints.

    Parameters
    ----------
    function : callable
        It keeps its signature.
    refcount : bool
        Whether references to the arrays are counted: an atomic instruction for each view. A kernel that makes neither
        arrays nor functions may leave it out, and compiles faster then.
    reassociate : bool
        Whether the terms of a sum may be added in any order, several at a time: for long sums.
    fused : bool
        Whether a product and a sum may be rounded once, together, as one instruction: for long sums of products.
    entry : bool
        Whether Python may call it. What only other kernels call compiles faster without that entry.

    Returns
    -------
    callable
        The compiled function, or the decorator with these options.
    """
    options: dict[str, Any] = {} if refcount else {"_nrt": False, "pipeline_class": _KernelCompiler}
    freedom = {"reassoc": reassociate, "nsz": reassociate, "contract": fused}
    if any(freedom.values()):  # no set, whose order differs from run to run: it is in the key of kept code
        options["fastmath"] = {name: True for name, given in freedom.items() if given}
    make: Any = functools.partial(_kept if entry else _piece, **options)
    return make if function is None else make(function)


def helper(function: F) -> F:
    """Compile a piece of a kernel that Python must not call: it is laid into its caller, and counts no references.

    Without the way in from Python it compiles faster; laid in, its arrays' shapes and strides are not handed over anew
    for each line.
    """
    return _piece(function, _nrt=False, forceinline=True)


class _Codegen:
    """Numba's code generator for a piece: there is no machine code whose environment could be set."""

    def __init__(self, codegen: Any) -> None:
        self._codegen = codegen

    def __getattr__(self, name: str) -> Any:
        return getattr(self._codegen, name)

    def set_env(self, name: str, environment: Any) -> None:
        """Do nothing: kernels neither raise nor touch Python's objects."""


class _KernelLibrary(_LIBRARY):  # type: ignore[misc]
    """Code of a kernel and of what it calls, optimized together and once: no counts of references are to be removed."""

    def _optimize_functions(self, module: Any) -> None:
        module.data_layout = self._codegen._data_layout

    def _optimize_final_module(self) -> None:
        super()._optimize_functions(self._final_module)
        passes, builder = self._codegen._module_pass_manager()
        passes.run(self._final_module, builder)


class _PieceLibrary(_KernelLibrary):
    """Code of a piece as the compiler wrote it: whoever takes it in optimizes it and makes machine code of it."""

    @property
    def codegen(self) -> Any:
        """Code generator that sets no environment."""
        return _Codegen(self._codegen)

    def _optimize_final_module(self) -> None:
        pass

    def _finalize_final_module(self) -> None:
        self._finalize_dynamic_globals()
        self._finalized = True


PASSES: tuple[Any, ...] = (
    untyped_passes.TranslateByteCode,
    untyped_passes.FixupArgs,
    untyped_passes.IRProcessing,
    untyped_passes.GenericRewrites,
    untyped_passes.ReconstructSSA,
    typed_passes.NopythonTypeInference,
    typed_passes.PreLowerStripPhis,
    typed_passes.IRLegalization,
    typed_passes.AnnotateTypes,
    typed_passes.NativeLowering,
    typed_passes.NoPythonBackend,
)


class _KernelCompiler(_COMPILER):  # type: ignore[misc]
    """Numba's compiler for code that makes no arrays and no functions: without the passes for those."""

    def define_pipelines(self) -> list[Any]:
        """Name the passes."""
        manager: Any = cast(Any, compiler_machinery).PassManager("kernel")
        for each in PASSES:
            manager.add_pass(each, each.__name__)
        manager.finalize()
        return [manager]

    def library(self, name: str) -> Any:
        """Make the library of a function; it is kept on disk."""
        library = _KernelLibrary(self.state.targetctx.codegen(), name)
        library.enable_object_caching()
        return library

    def compile_extra(self, function: Any) -> Any:
        """Compile a function."""
        self.state.library = self.library(function.__qualname__)
        with _types_remembered():
            return super().compile_extra(function)


class _PieceCompiler(_KernelCompiler):
    """The same, for a `_PieceLibrary`."""

    def library(self, name: str) -> Any:
        """Make the library of a function."""
        return _PieceLibrary(self.state.targetctx.codegen(), name)


@contextlib.contextmanager
def _types_remembered() -> Iterator[None]:
    """Let Numba remember, while a kernel compiles, what type a function of its own returns for given types.

    What it found before holds for the same flags only: functions that Numba compiles take those of their caller.
    Numba's lock is held, so that no other thread compiles.
    """
    before = _FUNCTION.get_call_type
    _FUNCTION.get_call_type = _call_type
    try:
        yield
    finally:
        _FUNCTION.get_call_type = before


_FOUND: dict[Any, Any] = {}
_FLAGS: dict[int, tuple[Any, str]] = {}
_find_call_type = _FUNCTION.get_call_type


def _call_type(function: Any, context: Any, arguments: Any, named: Any) -> Any:
    """Signature of a call, found once."""
    if named:
        return _find_call_type(function, context, arguments, named)
    key = function, arguments, _flags()
    if key not in _FOUND:
        signature = _find_call_type(function, context, arguments, named)
        _FOUND[key] = signature, function._impl_keys[signature.args]
    signature, function._impl_keys[signature.args] = _FOUND[key]
    return signature


def _flags() -> str:
    """Name the flags of the function that is being compiled in words: hashing them is what takes Numba long."""
    flags = cast(Any, targetconfig).ConfigStack.top_or_none()
    known = _FLAGS.get(id(flags))
    if known is None or known[0] is not flags:
        known = _FLAGS[id(flags)] = flags, flags.summary() if flags is not None else ""
    return known[1]


def _piece(function: F, **options: Any) -> F:
    """Compile what only kernels call: without entries, optimized with each kernel that takes it in."""
    options |= {"no_cpython_wrapper": True, "no_cfunc_wrapper": True, "pipeline_class": _PieceCompiler}
    made: Any = numba.njit(nogil=True, error_model="numpy", **options)
    return cast(F, made(function))


def _kept(function: F, **options: Any) -> F:
    """Compile a kernel whose machine code is kept on disk, if it stands in a file."""
    made: Any = numba.njit(nogil=True, error_model="numpy", **options)(function)
    if Path(function.__code__.co_filename).is_file():
        made._cache = _KernelCache(function)
    return cast(F, made)


class _KernelCache(_CACHE):  # type: ignore[misc]
    """Where Numba finds the machine code of one kernel, and leaves it."""

    def __init__(self, function: Callable[..., Any]) -> None:
        self._function, file = function, Path(function.__code__.co_filename)
        stamp = source_stamp(file)
        name = f"{function.__qualname__}-{function.__code__.co_firstlineno}.{sys.implementation.cache_tag}"
        folder = kept_folder(file, stamp)
        self.kept = KeptCode(folder, re.sub("[<>]", "", name), (numba.__version__, stamp), serialize.dumps)

    @property
    def cache_path(self) -> str:
        """The folder."""
        return str(self.kept.folder)

    def load_overload(self, signature: Any, context: Any) -> Any:
        """Take code that was kept, None where there is none of use."""
        context.refresh()
        key = self.key(signature, context.codegen())
        try:
            code = self.kept.load(key)
            return None if code is None else _RESULT._rebuild(context, *code)
        except Exception as error:  # whatever a library of another version may raise
            self.kept.discard(key, error)
            return None

    def save_overload(self, signature: Any, compiled: Any) -> None:
        """Keep code; where the disk is full or read-only the kernel runs all the same."""
        if compiled.library.has_dynamic_globals:  # addresses of this process are in it
            return
        try:
            make_kept_folder(self.kept.folder)
            self.kept.save(self.key(signature, compiled.codegen), compiled._reduce())
        except OSError as error:
            where = f"in {self.kept.folder.parent}, each start compiles it anew: {error}"
            say_once("write", f"machine code cannot be kept {where}; name another folder in NUMBA_CACHE_DIR")

    def key(self, signature: Any, codegen: Any) -> tuple[Any, ...]:
        """Tell what kept code is filed under: types of the arguments, processor, what the function is and holds."""
        return signature, codegen.magic_tuple(), identity(self._function)

    def enable(self) -> None:
        """Do nothing: it is always on."""

    def disable(self) -> None:
        """Do nothing: Numba turns off only what it made itself."""

    def flush(self) -> None:
        """Forget all that was kept of this kernel."""
        self.kept.flush()


def compile_user_function(function: F) -> F:
    """Compile a function that a user wrote, or leave it as it is if it is compiled; asked again, the same."""
    if hasattr(function, "py_func"):
        return function
    if function not in _COMPILED:
        _COMPILED[function] = _compiled_for_user(function)
    found: F = _COMPILED[function]
    return found


_COMPILED: dict[Any, Any] = {}


def _compiled_for_user(function: F) -> F:
    """Compile a function; its code, and that of kernels that hold it, is kept only if another process finds it."""
    alone: Any = numba.njit(nogil=True, error_model="numpy")
    if function.__module__ not in sys.modules:  # made by exec
        return cast(F, alone(function))
    if getattr(sys.modules[function.__module__], "__file__", None) is None:  # typed into a shell
        return cast(F, alone(function))
    return kernel(function)


@contextlib.contextmanager
def collection_paused() -> Iterator[None]:
    """Pause Python's garbage collection while kernels compile: it finds nothing, and takes a twentieth of the time."""
    enabled = gc.isenabled()
    gc.disable()
    try:
        yield
    finally:
        if enabled:
            gc.enable()


def interpreted(function: F) -> F:
    """Return the Python function that was compiled, for calls too seldom to be worth compiling."""
    result: F = getattr(function, "py_func", function)
    return result
