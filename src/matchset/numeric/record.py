"""Named fields in compiled code: an annotated class becomes the layout of a record in a block of floats.

A kernel is handed the block, one array of float64, and names its fields in its first line::

    work = block.view(WORK)[0]

That costs no time in a compiled call (decision 080), where an argument that is a record array itself costs several
microseconds in a cold one. Python reads and writes the same names through `fields`.
"""

import threading
from collections.abc import Sequence
from typing import Annotated, Any, get_args, get_origin, get_type_hints

import numpy as np
import numpy.typing as npt

Block = npt.NDArray[np.float64]
Record = Any  # one record, or a record within it: the layout says which fields it has

_SCALARS: dict[Any, str] = {float: "f8", int: "i8", bool: "i8"}


def record_dtype(layout: type, more: Sequence[tuple[str, np.dtype[Any]]] = ()) -> np.dtype[np.void]:
    """Layout in memory of a class with annotated fields, in the order in which they stand.

    Parameters
    ----------
    layout : type
        A class whose fields are ``float``, ``int``, ``bool`` (8 bytes each), another such class, or
        ``Annotated[npt.NDArray[...], shape, dtype]`` with a tuple and the name of a NumPy type: an array of fixed
        shape that lies in the record itself. Its bytes must be a multiple of 8.
    more : sequence of (str, dtype)
        Fields after these: arrays whose shape is not known before.

    Returns
    -------
    dtype
        A structured one, without gaps.

    Raises
    ------
    ValueError
        If a field is of none of these types, has the name of an attribute of NumPy's own, such as ``size``, or an array
        ends in the middle of 8 bytes.
    """
    named = [(name, _field_dtype(f"{layout.__name__}.{name}", kind)) for name, kind in _annotations(layout).items()]
    fields = [*named, *more]
    for name, kind in fields:
        if hasattr(np.record, name):
            raise ValueError(f"{layout.__name__}.{name} has the name of an attribute of NumPy's records")
        if kind.itemsize % 8:
            raise ValueError(f"{layout.__name__}.{name} has {kind.itemsize} bytes, no multiple of 8")
    return np.dtype(fields)


def _annotations(layout: type) -> dict[str, Any]:
    return get_type_hints(layout, include_extras=True)


def _field_dtype(name: str, kind: Any) -> np.dtype[Any]:
    """Type of an annotated field."""
    if kind in _SCALARS:
        return np.dtype(_SCALARS[kind])
    if get_origin(kind) is Annotated:
        _, shape, dtype = get_args(kind)
        return np.dtype((dtype, shape))
    if isinstance(kind, type) and _annotations(kind):
        return record_dtype(kind)
    raise ValueError(f"{name} is a {kind}: a record holds float, int, bool, arrays, classes")


def new_block(layout: np.dtype[np.void]) -> Block:
    """Zeros for one record of this layout."""
    return np.zeros(layout.itemsize // 8)


class ThreadBlock(threading.local):
    """Working memory of kernels for one record of a layout: a block for each thread.

    Parameters
    ----------
    layout : dtype
    """

    def __init__(self, layout: np.dtype[np.void]) -> None:
        self.numbers = new_block(layout)


def fields(block: Block, layout: np.dtype[np.void]) -> Any:
    """View a block by the names of its fields, for Python: what is written there is in the block."""
    return block.view(layout).view(np.recarray)[0]


def store(record: Any, values: Any) -> None:
    """Write the fields of an object, a parameters struct for one, to the fields of the same names of a record.

    An object within the object goes into the record within the record.
    """
    for name in record.dtype.names:
        value = getattr(values, name)
        if record.dtype[name].names:
            store(getattr(record, name), value)
        else:
            setattr(record, name, value)
