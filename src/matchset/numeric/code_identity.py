"""What a function's machine code depends on, as a checksum: `identity`."""

import enum
import hashlib
import types
import zlib
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np

from matchset.numeric.kept_code import PACKAGE, source_stamp


def identity(function: Callable[..., Any]) -> str:
    """Tell whether two functions would give the same machine code, in this process or another.

    Parameters
    ----------
    function : callable
        Compiled or not.

    Returns
    -------
    str
        A checksum of its module, name and instructions, of the source it stands in (see `source_stamp`), and of the
        values that it takes from around it: functions by the same traits, everything else by its digits.
    """
    return hashlib.sha256("\n".join(_traits(function, set())).encode()).hexdigest()


def _traits(function: Callable[..., Any], known: set[Any]) -> Iterator[str]:
    """All that decides a function's machine code, line by line."""
    plain: Any = getattr(function, "py_func", function)
    yield f"{plain.__module__}.{plain.__qualname__}"
    if plain in known:
        return
    known.add(plain)
    code, file = plain.__code__, Path(plain.__code__.co_filename)
    yield f"{_digits(code)} {source_stamp(file) if file.is_file() else 0}"
    cells = (cell.cell_contents for cell in plain.__closure__ or ())
    values = dict(zip(code.co_freevars, cells, strict=True))
    if PACKAGE not in file.parents:  # the stamp of a file of the package covers what it imports
        values |= {name: plain.__globals__[name] for name in code.co_names if name in plain.__globals__}
    for name, value in sorted(values.items()):
        if isinstance(getattr(value, "py_func", value), types.FunctionType):
            yield name
            yield from _traits(value, known)
        else:
            yield f"{name} = {_digits(value)}"


def _digits(value: object) -> str:
    """Write a value out so that equal ones look the same in every process."""
    if isinstance(value, types.CodeType):
        return f"{zlib.crc32(value.co_code)} {value.co_names} {[*map(_digits, value.co_consts)]}"
    if isinstance(value, types.ModuleType):
        return value.__name__
    if isinstance(value, np.ndarray):
        return f"{value.dtype} {value.shape} {zlib.crc32(np.ascontiguousarray(value).tobytes())}"
    if isinstance(value, enum.EnumType):
        return repr(list(value))
    return repr(value)
