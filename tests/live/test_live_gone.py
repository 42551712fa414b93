"""A source that is gone is tried again until it is there; what was followed is found again."""

import threading
import time
from collections.abc import Callable, Iterator
from typing import Any

import cv2
import numpy as np
import numpy.typing as npt
import pytest

import bad_servers
from bad_servers import BadServer
from matchset.camera.camera_model import CameraModel
from matchset.image.errors import LinkError
from matchset.image.frame import Frame
from matchset.live.targets.messages import Diameter, FieldOfView, Pick
from matchset.live.vision.vision import Vision, VisionParameters
from matchset.media.camera_stream import StreamParameters
from matchset.media.video import Video
from mjpeg_server import MjpegServer

SOON = VisionParameters(retry=0.02)
PATIENCE = 20.0  # s; only ever spent where a test fails


def picture(number: int, size: tuple[int, int] = (160, 120)) -> npt.NDArray[np.uint8]:
    """A blue ball that moves a little."""
    image = np.full((size[1], size[0], 3), 70, np.uint8)
    cv2.circle(image, (size[0] // 2 + number % 5, size[1] // 2), 20, (200, 80, 30), cv2.FILLED, cv2.LINE_AA)
    return image


def wait_for(condition: Callable[[], object]) -> None:
    """Wait until something holds."""
    end = time.monotonic() + PATIENCE
    while not condition():
        assert time.monotonic() < end
        time.sleep(0.005)


class FakeCamera:
    """Delivers pictures until it is unplugged; opened again by each call."""

    def __init__(self) -> None:
        self.there, self.size, self.opened, self.closed = True, (160, 120), 0, 0
        self.live, self.fps, self.dropped, self.channels, self.lost = True, 30.0, 0, 3, ""

    def __call__(self) -> Any:
        if not self.there:
            raise LinkError("cannot open camera 0: another program may hold it")
        self.opened += 1
        self.width, self.height = self.size
        return self

    def __enter__(self) -> Any:
        return self

    def __exit__(self, *_: object) -> None:
        self.closed += 1

    def __iter__(self) -> Iterator[Frame]:
        number = 0
        while self.there:
            yield Frame(picture(number, self.size), time.monotonic(), number)
            number += 1
            time.sleep(0.005)
        raise LinkError("camera 0 has delivered no picture for 2 s")

    def until(self, stopped: Callable[[], bool]) -> Iterator[Frame]:
        for frame in self:
            if stopped():
                return
            yield frame


@pytest.fixture
def camera() -> FakeCamera:
    return FakeCamera()


@pytest.fixture
def watched(camera: FakeCamera) -> Iterator[tuple[Vision, list[str]]]:
    notes: list[str] = []
    vision = Vision(camera, note=notes.append, parameters=SOON)
    yield vision, notes
    vision.close()
    assert camera.closed == camera.opened


def follow(vision: Vision) -> None:
    """Click the ball, and tell what is known of it."""
    wait_for(lambda: vision.seen.state.sequence > 2)
    vision.ask(FieldOfView(1.0))
    vision.ask(Pick(vision.seen.state.sequence, 80.0, 60.0))
    vision.ask(Diameter(1, 0.28))
    wait_for(lambda: vision.seen.state.targets and vision.seen.state.targets[0].position)


def test_a_camera_that_goes_and_comes_is_picked_up_and_the_ball_is_found_again(
    camera: FakeCamera, watched: tuple[Vision, list[str]]
) -> None:
    vision, notes = watched
    follow(vision)
    for _ in range(2):
        camera.there = False
        wait_for(lambda: "another program" in vision.seen.state.fault)
        state = vision.seen.state
        assert "tried again" in state.fault
        assert vision.seen.frame is not None
        (target,) = state.targets
        assert not target.found
        assert target.diameter == 0.28
        assert not vision.seen.poses
        camera.there = True
        wait_for(lambda: not vision.seen.state.fault and vision.seen.state.targets[0].position)
    assert not [words for words in notes if "forgotten" in words]
    assert camera.opened == 3


def test_a_camera_that_is_not_there_at_first_is_picked_up(camera: FakeCamera) -> None:
    camera.there = False
    with Vision(camera, parameters=SOON) as vision:
        wait_for(lambda: "another program" in vision.seen.state.fault)
        assert vision.seen.frame is None
        camera.there = True
        wait_for(lambda: vision.seen.frame is not None and not vision.seen.state.fault)
        assert vision.seen.state.computing == {}  # nothing is followed


def test_the_page_is_told_what_a_picture_took(watched: tuple[Vision, list[str]]) -> None:
    vision, _ = watched
    follow(vision)
    wait_for(lambda: vision.seen.state.computing)
    computing = vision.seen.state.computing
    assert list(computing) == ["median", "mean", "percentile_95", "worst"]
    assert 0.0 <= computing["median"] <= computing["percentile_95"] <= computing["worst"]
    assert 0.0 < computing["mean"] <= computing["worst"]


def test_one_of_another_size_begins_anew(camera: FakeCamera, watched: tuple[Vision, list[str]]) -> None:
    vision, notes = watched
    follow(vision)
    camera.there = False
    wait_for(lambda: vision.seen.state.fault)
    camera.size, camera.there = (320, 240), True
    wait_for(lambda: vision.seen.state.width == 320)
    assert not vision.seen.state.targets
    assert vision.camera is None
    assert [word for word in notes if "320 x 240" in word]
    assert [word for word in notes if "click again" in word]


def test_a_camera_model_of_another_size_is_refused_and_the_one_before_stays(
    watched: tuple[Vision, list[str]],
) -> None:
    vision, notes = watched
    follow(vision)
    before = vision.camera
    vision.use(CameraModel.from_fov(640, 480, 1.0))
    wait_for(lambda: notes)
    assert "calibrate at the size" in notes[-1]
    assert vision.camera == before


def test_closing_does_not_wait_for_a_source_that_is_stuck() -> None:
    goes_on = threading.Event()

    def stuck() -> Video:
        goes_on.wait()
        raise LinkError("too late")

    vision = Vision(stuck, parameters=VisionParameters(closing=0.1))
    vision.close()
    assert vision._thread.is_alive()
    goes_on.set()
    vision._thread.join()


@pytest.mark.parametrize("reconnect", [0.0, 60.0], ids=["by the page", "by the stream"])
def test_a_stream_that_is_killed_and_started_again(reconnect: float) -> None:
    notes: list[str] = []
    with MjpegServer(picture) as server:
        vision = Vision(
            lambda: Video(server.url, timeout=0.5, reconnect=reconnect),
            note=notes.append,
            parameters=VisionParameters(retry=0.1),
        )
        with vision:
            follow(vision)
            server.stop()
            wait_for(lambda: vision.seen.state.fault)
            assert ("opened again" in vision.seen.state.fault) == (reconnect > 0.0)
            assert not vision.seen.state.targets[0].found
            vision.ask(Pick(10**6, 1.0, 1.0))  # answered, although no picture comes
            wait_for(lambda: notes)
            server.start()
            wait_for(lambda: not vision.seen.state.fault and vision.seen.state.targets[0].position)
            sequence = vision.seen.state.sequence
            wait_for(lambda: vision.seen.state.sequence > sequence + 5)


def test_closing_does_not_wait_for_a_stream_that_is_away() -> None:
    with MjpegServer(picture) as server:
        vision = Vision(lambda: Video(server.url, timeout=2.0, reconnect=600.0))
        wait_for(lambda: vision.seen.state.sequence > 2)
        server.stop()
        wait_for(lambda: vision.seen.state.fault)
        vision.close()
        assert not vision._thread.is_alive()


@pytest.mark.parametrize(
    ("answer", "words"),
    [
        (bad_servers.page, "answers with a page (text/html)"),
        (bad_servers.circle, "redirects in a circle"),
        (bad_servers.drips, "but no picture comes"),
    ],
)
def test_an_address_that_is_no_stream_is_said_on_the_page_and_tried_again(
    monkeypatch: pytest.MonkeyPatch, answer: bad_servers.Answer, words: str
) -> None:
    monkeypatch.setattr("matchset.media.camera_stream.DEFAULT", StreamParameters(first_picture_s=0.3, answer_s=2.0))
    with BadServer(answer) as server, Vision(lambda: Video(server.url, timeout=0.3), parameters=SOON) as vision:
        wait_for(lambda: words in vision.seen.state.fault)
        before = vision.seen.state.sequence
        wait_for(lambda: vision.seen.state.sequence > before)
        assert vision.seen.state.fault.endswith("? It is tried again every 0.02 s")
