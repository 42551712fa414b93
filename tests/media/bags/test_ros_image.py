"""Messages with pictures: every encoding, both byte orders, filled up rows, and bytes at random."""

import struct

import cv2
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import bags
from matchset.media.bags.ros_image import COMPRESSED_IMAGE, ENCODINGS, IMAGE, RosPicture, read_picture

HEIGHT, WIDTH = 12, 16
COLOR = np.array([40, 120, 230], np.uint8)  # blue, green, red


def flat() -> bags.Picture:
    return np.tile(COLOR, (HEIGHT, WIDTH, 1))


def mosaic(pattern: str) -> bags.Picture:
    """Raw pixels of a sensor with a pattern as in bayer_rggb8, before a plain color."""
    levels = {name: COLOR["bgr".index(name)] for name in "bgr"}
    cell = np.array([[levels[pattern[0]], levels[pattern[1]]], [levels[pattern[2]], levels[pattern[3]]]])
    return np.tile(cell, (HEIGHT // 2, WIDTH // 2)).astype(np.uint8)


def stored(encoding: str) -> np.ndarray:
    """Pixels of the plain color as an encoding stores them."""
    if encoding.startswith("bayer"):
        raw = mosaic(encoding[6:10])
        return raw if encoding.endswith("8") else raw.astype(np.uint16) * 257
    if encoding.startswith(("yuv", "uyvy", "yuyv")):
        code = cv2.COLOR_BGR2YUV_YUY2 if encoding in ("yuyv", "yuv422_yuy2") else cv2.COLOR_BGR2YUV_UYVY
        return np.asarray(cv2.cvtColor(flat(), code))
    if encoding in ("mono8", "8UC1", "mono16", "16UC1"):
        gray = np.full((HEIGHT, WIDTH), 77, np.uint8)
        return gray if "8" in encoding else gray.astype(np.uint16) * 257
    name = {"8UC3": "bgr8", "8UC4": "bgra8"}.get(encoding, encoding)
    channels = [flat()[..., "bgr".index(c)] if c in "bgr" else np.full((HEIGHT, WIDTH), 9) for c in name.rstrip("0168")]
    pixels = np.stack(channels, axis=2)
    return pixels.astype(np.uint8) if name.endswith("8") else pixels.astype(np.uint16) * 257


def packed(encoding: str, pixels: np.ndarray, step: int, big: int = 0, ros1: bool = False, order: str = "<") -> bytes:
    """Serialize a sensor_msgs/Image by hand."""
    data = bytearray(b"" if ros1 else b"\0\1\0\0" if order == "<" else b"\0\0\0\0")
    start = len(data)

    def number(value: int) -> None:
        data.extend(b"" if ros1 else bytes((start - len(data)) % 4))
        data.extend(struct.pack(f"{order}I", value))

    def text(value: str) -> None:
        coded = value.encode() + (b"" if ros1 else b"\0")
        number(len(coded))
        data.extend(coded)

    for value in ([1] if ros1 else []) + [3, 500]:
        number(value)
    text("cam")
    number(HEIGHT)
    number(WIDTH)
    text(encoding)
    data.append(big)
    number(step)
    number(pixels.nbytes)
    return bytes(data) + pixels.tobytes()


@pytest.mark.parametrize("encoding", ENCODINGS)
def test_every_encoding_gives_the_same_picture(encoding: str) -> None:
    pixels = stored(encoding)
    found = read_picture(packed(encoding, pixels, pixels.nbytes // HEIGHT), IMAGE, ros1=False)
    assert (found.stamp, found.encoding, found.known) == (3_000_000_500, encoding, True)
    assert found.image is not None
    if encoding in ("mono8", "8UC1", "mono16", "16UC1"):
        assert np.array_equal(found.image, np.full((HEIGHT, WIDTH), 77))
    else:
        inner = found.image[2:-2, 2:-2].astype(int)  # at the border OpenCV repeats the inner pixels
        assert np.abs(inner - COLOR).max() <= (4 if {"y", "u"} <= set(encoding) else 0)


@pytest.mark.parametrize("ros1", [False, True])
@pytest.mark.parametrize("big", [False, True])
def test_sixteen_bits_of_either_order_in_filled_up_rows(big: bool, ros1: bool) -> None:
    values = np.arange(HEIGHT * WIDTH).reshape(HEIGHT, WIDTH) * 300
    filled = np.zeros((HEIGHT, WIDTH + 5), ">u2" if big else "<u2")
    filled[:, :WIDTH] = values
    found = read_picture(packed("mono16", filled, 2 * (WIDTH + 5), int(big), ros1), IMAGE, ros1)
    assert found.image is not None
    assert np.abs(found.image - values / 257.0).max() <= 0.5


def test_a_message_of_a_big_endian_computer() -> None:
    found = read_picture(packed("bgr8", flat(), 3 * WIDTH, order=">"), IMAGE, ros1=False)
    assert found.image is not None
    assert np.array_equal(found.image, flat())


@pytest.mark.parametrize(("step", "rows"), [(3 * WIDTH - 1, HEIGHT), (3 * WIDTH, HEIGHT - 1), (2**32 - 1, HEIGHT)])
def test_pixels_that_are_missing_are_a_broken_picture(step: int, rows: int) -> None:
    assert read_picture(packed("bgr8", flat()[:rows], step), IMAGE, ros1=False).image is None


def test_another_encoding_is_named() -> None:
    assert read_picture(packed("32FC1", flat(), 48), IMAGE, ros1=False) == RosPicture(
        3_000_000_500, "32FC1", None, False
    )


@pytest.mark.parametrize("data", [b"", b"\0\1\0", b"\0\2\0\0" + bytes(60), b"\1\1\0\0" + bytes(60)])
def test_what_is_no_plain_cdr_is_refused(data: bytes) -> None:
    with pytest.raises(ValueError, match="a message"):
        read_picture(data, IMAGE, ros1=False)


@given(data=st.binary(max_size=200), ros1=st.booleans(), kind=st.sampled_from([IMAGE, COMPRESSED_IMAGE]))
def test_random_bytes_are_a_value_error_or_a_picture(data: bytes, ros1: bool, kind: str) -> None:
    for message in (data, b"\0\1\0\0" + data):
        try:
            found = read_picture(message, kind, ros1)
        except ValueError:
            continue
        assert found.image is None or found.image.dtype == np.uint8
