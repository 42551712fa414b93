"""Pictures that waited while a stream was opened are left out: the first one is of now."""

import itertools

import numpy as np

from matchset.image.streams.backlog import Backlog
from matchset.image.video import Video
from mjpeg_server import Image, MjpegServer

CODES, STEP = 32, 8  # gray values, which a JPEG keeps apart


def test_the_first_picture_is_one_of_now() -> None:
    sent: list[int] = []
    numbers = itertools.count()

    def coded(_: int) -> Image:
        sent.append(next(numbers))
        return np.full((48, 64, 3), STEP * (sent[-1] % CODES), np.uint8)

    with MjpegServer(coded, rate=10.0) as server, Video(server.url) as video:
        frame = next(video)
        behind = (sent[-1] - round(float(frame.image.mean()) / STEP)) % CODES
        assert len(sent) > 10  # so many were read while it was opened
        assert behind <= 4
        assert frame.index >= len(sent) - 5
        assert video.dropped >= frame.index - 4


def test_what_had_to_be_waited_for_is_of_now_and_so_is_what_follows() -> None:
    backlog = Backlog()
    backlog.begin(10.0, 0.7)
    assert backlog.holds(10.001, 0.001, 30.0)
    assert backlog.holds(10.002, 0.001, 30.0)
    assert not backlog.holds(10.030, 0.028, 30.0)
    assert not backlog.holds(10.031, 0.001, 30.0)


def test_a_stream_that_is_never_waited_for_is_read_all_the_same() -> None:
    backlog = Backlog()
    backlog.begin(10.0, 0.7)
    assert backlog.holds(10.69, 0.001, None)
    assert not backlog.holds(10.71, 0.001, None)


def test_nothing_waits_where_the_opening_took_no_time() -> None:
    backlog = Backlog()
    backlog.begin(10.0, 0.01)
    assert not backlog.holds(10.0, 0.0, 30.0)
