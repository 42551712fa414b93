"""10 to 16 bits brought to eight, all pictures by the first one."""

import numpy as np
import pytest

from matchset.media.upright.depth import DepthScaling, to_bytes, used_bits


@pytest.mark.parametrize(
    ("deepest", "bits"),
    [(0, 10), (255, 10), (1023, 10), (1024, 12), (4095, 12), (4096, 14), (16383, 14), (16384, 16), (65535, 16)],
)
def test_bits_by_the_deepest_value(deepest: int, bits: int) -> None:
    assert used_bits(np.array([[0, deepest]], np.uint16)) == bits


@pytest.mark.parametrize("bits", [10, 12, 14, 16])
def test_the_whole_range_is_used(bits: int) -> None:
    top = (1 << bits) - 1
    values = np.arange(0, top + 1, 7, dtype=np.uint16)[None]
    expected = np.round(values * (255.0 / top))
    assert np.abs(to_bytes(values, bits).astype(float) - expected).max() <= 1.0
    assert to_bytes(np.array([[0, top, 65535]], np.uint16), bits).tolist() == [[0, 255, 255]]


def test_all_pictures_are_scaled_as_the_first_one() -> None:
    depth = DepthScaling()
    first = depth.to_bytes(np.array([[4095, 2048]], np.uint16))
    assert first.tolist() == [[255, 128]]
    assert depth.to_bytes(np.array([[1000, 2048]], np.uint16)).tolist() == [[62, 128]]
    assert depth.notes == ["pictures use 12 of 16 bits, by the first one: they are scaled by 16"]
    assert depth.to_bytes(np.array([[9000, 2048]], np.uint16)).tolist() == [[255, 128]]
    assert depth.notes == [
        "pictures use 12 of 16 bits, by the first one: they are scaled by 16; 1 brighter picture is cut off there"
    ]


def test_pictures_of_eight_bits_stay() -> None:
    depth, plain = DepthScaling(), np.array([[1, 255]], np.uint8)
    assert depth.to_bytes(plain) is plain
    assert depth.notes == []


def test_pictures_of_sixteen_bits_need_no_note() -> None:
    depth = DepthScaling()
    depth.to_bytes(np.array([[65535]], np.uint16))
    assert depth.notes == []
