"""Pictures as a Tello sends them, H.264 in UDP packets, are read by matchset's own video source."""

import socket
import threading
import time
from collections.abc import Iterator
from fractions import Fraction

import av
import numpy as np
import pytest

import matchset as ms

SIZE, PIECE = (320, 240), 1460  # px; bytes of a UDP packet


def picture(number: int) -> np.ndarray:
    image = np.full((SIZE[1], SIZE[0], 3), 90, np.uint8)
    left = 20 + 5 * (number % 40)
    image[100:140, left : left + 40] = (200, 60, 30)
    return image


def packets() -> Iterator[bytes]:
    """A stream without end, with a picture on its own ten times."""
    coder = av.CodecContext.create("libx264", "w")
    coder.width, coder.height, coder.pix_fmt = *SIZE, "yuv420p"
    coder.time_base, coder.framerate = Fraction(1, 30), Fraction(30)
    coder.gop_size = 10
    coder.options = {"tune": "zerolatency", "preset": "ultrafast", "x264-params": "repeat-headers=1"}
    number = 0
    while True:
        frame = av.VideoFrame.from_ndarray(picture(number), format="bgr24")
        frame.pts = number
        yield from (bytes(packet) for packet in coder.encode(frame))
        number += 1


@pytest.fixture
def port() -> Iterator[int]:
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
        probe.bind(("127.0.0.1", 0))
        number = int(probe.getsockname()[1])
    done = threading.Event()

    def send() -> None:
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as out:
            for packet in packets():
                if done.wait(1 / 240):
                    return
                for start in range(0, len(packet), PIECE):
                    out.sendto(packet[start : start + PIECE], ("127.0.0.1", number))

    thread = threading.Thread(target=send)
    thread.start()
    try:
        yield number
    finally:
        done.set()
        thread.join()


def test_its_pictures_are_read_as_they_come(port: int) -> None:
    with ms.Video(f"udp://127.0.0.1:{port}") as video:
        frames = []
        for frame in video:
            frames.append(frame)
            if len(frames) == 20:
                break
    assert video.live
    assert all(frame.image.shape == (SIZE[1], SIZE[0], 3) for frame in frames)
    last = frames[-1].image.astype(int)
    blue = (last[:, :, 0] - last[:, :, 2]) > 80
    assert 800 < blue.sum() < 2400
    assert [frame.time for frame in frames] == sorted({frame.time for frame in frames})
    assert frames[-1].time <= time.monotonic()
