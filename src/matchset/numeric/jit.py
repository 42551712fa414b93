"""The one Numba policy: every kernel of the library is compiled by the decorators here, nothing else imports Numba.

The machine code is kept on disk, so only the first run on a machine compiles. Numba looks at a kernel's own file alone
to see whether that code is still good; here the files that it imports must be the same too (`source_stamp`), so that
kernels may call kernels of other files. `nogil=True` lets trackers run in threads. `error_model="numpy"` drops the
zero-division checks, so kernels guard their divisions themselves. `fastmath` is off; with `reassociate` alone the
order of a sum's terms is free, so that they are added several at a time. On one machine results are the same, bit for
bit, from run to run.
"""

import functools
import math
import re
import sys
import zlib
from collections.abc import Callable
from pathlib import Path
from typing import Any, TypeVar, cast, overload

import numba
import numpy.typing as npt
from numba import types
from numba.core.cgutils import unpack_tuple
from numba.core.imputils import impl_ret_borrowed
from numba.extending import lower_builtin, type_callable
from numba.np.arrayobj import populate_array

_LOWER: Any = lower_builtin  # Numba tells no types
_UNPACK: Any = unpack_tuple
_POPULATE: Any = populate_array
_BORROW: Any = impl_ret_borrowed

Array = npt.NDArray[Any]
F = TypeVar("F", bound=Callable[..., Any])


PACKAGE = Path(__file__).parent.parent
_IMPORT = re.compile(r"^\s*from (matchset[\w.]*) import (\([^)]*\)|[^\n]*)|^\s*import (matchset[\w.]+)", re.MULTILINE)


def source_stamp(file: Path) -> int:
    """Checksum of a source file and of all files of the package that it imports, directly or not.

    Parameters
    ----------
    file : Path
        The file that a kernel stands in; it need not be of the package.

    Returns
    -------
    int
        Changes with any source that can change the kernel's machine code.
    """
    seen: dict[Path, int] = {}
    waiting = [file.resolve()]
    while waiting:
        path = waiting.pop()
        if path not in seen:
            seen[path], imported = _read_source(path)
            waiting.extend(imported)
    return zlib.crc32(repr([(path.name, seen[path]) for path in sorted(seen)]).encode())


@functools.cache
def _read_source(path: Path) -> tuple[int, tuple[Path, ...]]:
    """Checksum of one file, and the files of the package that it imports."""
    text = path.read_bytes()
    imported = []
    for package, names, module in _IMPORT.findall(text.decode()):
        folder = PACKAGE.joinpath(*(package or module).split(".")[1:])
        candidates = [folder, *(folder / name for name in re.findall(r"\w+", names))]
        imported += [found for each in candidates if (found := each.with_suffix(".py")).is_file()]
    return zlib.crc32(text), tuple(imported)


@overload
def kernel(function: F) -> F: ...
@overload
def kernel(*, refcount: bool = True, reassociate: bool = False) -> Callable[[F], F]: ...


def kernel(function: Any = None, *, refcount: bool = True, reassociate: bool = False) -> Any:
    """Compile a function of arrays and scalars that neither raises nor prints.

    Parameters
    ----------
    function : callable
        It keeps its signature.
    refcount : bool
        Whether references to the arrays are counted: an atomic instruction for each view. A kernel that makes no arrays
        may leave it out.
    reassociate : bool
        Whether the terms of a sum may be added in any order, several at a time: for long sums.

    Returns
    -------
    callable
        The compiled function, or the decorator with these options.
    """
    options: dict[str, Any] = {} if refcount else {"_nrt": False}
    if reassociate:  # no set, whose order differs from run to run: it is in the key of kept code
        options["fastmath"] = {"reassoc": True, "nsz": True}
    if function is None:
        return lambda made: _kept(made, **options)
    return _kept(function, **options)


def helper(function: F) -> F:
    """Compile a piece of a kernel that Python must not call: it is laid into its caller, and counts no references.

    Without the way in from Python it compiles faster; laid in, its arrays' shapes and strides are not handed over anew
    for each line.
    """
    return _kept(function, _nrt=False, forceinline=True, no_cpython_wrapper=True, no_cfunc_wrapper=True)


def _kept(function: F, **options: Any) -> F:
    """Compile a kernel whose machine code is kept on disk."""
    made: Any = numba.njit(cache=True, nogil=True, error_model="numpy", **options)(function)
    file = getattr(getattr(made, "_cache", None), "_cache_file", None)
    if file is not None:
        file._source_stamp = (file._source_stamp, source_stamp(Path(function.__code__.co_filename)))
    result: F = _identified(made)
    return result


def _identified(made: Any) -> Any:
    """Give a kernel a fixed identity: other kernels' compiled code is filed under that of the kernels they hold."""
    function = made.py_func
    if hasattr(made, "_set_uuid"):
        made._set_uuid(f"{function.__module__}.{function.__qualname__}.{zlib.crc32(function.__code__.co_code)}")
    return made


def inlined(function: F) -> F:
    """Like `kernel`, for a function that other kernels take in: it is compiled with each of them, not once more."""
    result: F = _identified(numba.njit(inline="always", nogil=True, error_model="numpy")(function))
    return result


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
        return cast(F, _identified(alone(function)))
    return kernel(function)


def cut(block: Array, start: int, shape: tuple[int, ...]) -> Array:
    """View a part of an array in one piece, from a place on, as an array of that shape.

    In compiled code that costs neither a call nor a check, as `reshape` does: the part must lie in the block.
    """
    return block.reshape(-1)[start : start + math.prod(shape)].reshape(shape)


@type_callable(cut)
def _type_of_cut(_: Any) -> Any:
    def found(block: Any, start: Any, shape: Any) -> Any:  # noqa: ARG001
        return types.Array(block.dtype, len(shape), "C") if block.layout == "C" else None

    return found


def _compiled_cut(context: Any, builder: Any, signature: Any, values: Any) -> Any:
    source = context.make_array(signature.args[0])(context, builder, values[0])
    made = context.make_array(signature.return_type)(context, builder)
    sizes = _UNPACK(builder, values[2])
    strides = [source.itemsize]
    for size in reversed(sizes[1:]):
        strides.insert(0, builder.mul(strides[0], size))
    data = builder.gep(source.data, [values[1]])
    _POPULATE(made, data, tuple(sizes), tuple(strides), source.itemsize, source.meminfo, source.parent)
    return _BORROW(context, builder, signature.return_type, made._getvalue())


_LOWER(cut, types.Array, types.Integer, types.UniTuple)(_compiled_cut)


def plain(function: F) -> F:
    """Give the Python function that was compiled, for calls too seldom to be worth compiling."""
    result: F = getattr(function, "py_func", function)
    return result
