"""An annotated class is the layout of a record, in Python and in kernels."""

from typing import Annotated

import msgspec
import numpy as np
import numpy.typing as npt
import pytest

from matchset.numeric.jit import kernel
from matchset.numeric.record import Block, fields, new_block, record_dtype, store

Floats = npt.NDArray[np.float64]


class Limits(msgspec.Struct, frozen=True):
    most: float = 2.5
    count: int = 3
    strict: bool = True


class Work:
    length: float
    limits: Limits
    table: Annotated[Floats, (4, 2), "f8"]
    pixels: Annotated[npt.NDArray[np.uint8], (16,), "u1"]
    found: int


WORK = record_dtype(Work)


@kernel(refcount=False)
def fill(block: Block) -> float:
    work = block.view(WORK)[0]
    work.length = work.limits.most * work.limits.count
    work.found += 2
    work.table[3, 1] = 7.0
    work.pixels[5] = 9
    return float(work.table[3, 1])


def test_a_kernel_and_python_see_the_same_fields() -> None:
    block = new_block(WORK)
    work = fields(block, WORK)
    store(work.limits, Limits())
    work.found = 40
    assert fill(block) == 7.0
    assert (work.length, work.found, work.table[3, 1], work.pixels[5]) == (7.5, 42, 7.0, 9)
    assert (work.limits.most, work.limits.count, work.limits.strict) == (2.5, 3, 1)


def test_what_no_record_can_hold_is_refused() -> None:
    class Words:
        name: str

    class Odd:
        pixels: Annotated[npt.NDArray[np.uint8], (3,), "u1"]

    class Taken:
        size: float

    with pytest.raises(ValueError, match=r"Taken\.size has the name"):
        record_dtype(Taken)
    with pytest.raises(ValueError, match=r"Words\.name is a"):
        record_dtype(Words)
    with pytest.raises(ValueError, match=r"Odd\.pixels has 3 bytes"):
        record_dtype(Odd)
