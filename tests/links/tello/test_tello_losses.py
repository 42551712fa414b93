"""H.264 as a Tello sends it, joined in mid-stream, with packets that are lost: no damaged picture is handed out."""

import random
import socket
import threading
from collections.abc import Iterator
from contextlib import contextmanager

import pytest

import matchset as ms
from shown_clips import access_units, ball_picture, middle_of, need_av

PIECE = 1460  # bytes of a packet
COUNT, RADIUS = 60, 40.0


@contextmanager
def sent(lost: float) -> Iterator[int]:
    """Send a clip again and again, some of its packets left out; yields the port."""
    need_av()
    units = access_units([ball_picture((320, 240), (80.0 + 2.5 * k, 120.0, RADIUS)) for k in range(COUNT)], key=15)
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
        probe.bind(("127.0.0.1", 0))
        port = int(probe.getsockname()[1])
    done, chance = threading.Event(), random.Random(2)

    def send() -> None:
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as out:
            number = 5  # not at a key picture
            while not done.wait(1 / 240):
                unit = units[number % COUNT]
                for start in range(0, len(unit), PIECE):
                    if chance.random() >= lost:
                        out.sendto(unit[start : start + PIECE], ("127.0.0.1", port))
                number += 1

    thread = threading.Thread(target=send)
    thread.start()
    try:
        yield port
    finally:
        done.set()
        thread.join()


@pytest.mark.parametrize("lost", [0.0, 0.05])
def test_damaged_pictures_are_left_out_and_counted(lost: float) -> None:
    with sent(lost) as port, ms.Video(f"udp://127.0.0.1:{port}") as video:
        for _ in range(60):
            frame = next(video)
            assert not frame.damaged
            x, y, radius = middle_of(frame.image)
            assert (y, radius) == pytest.approx((120.0, RADIUS), abs=1.5)
            assert 78.0 < x < 230.0
        while lost and not video.damaged:
            next(video)
        assert not lost or f"{video.damaged} damaged frame" in " ".join(video.warnings)


def test_they_can_be_had() -> None:
    with sent(0.1) as port, ms.Video(f"udp://127.0.0.1:{port}", damaged=True) as video:
        while not next(video).damaged:
            pass
        assert video.damaged
