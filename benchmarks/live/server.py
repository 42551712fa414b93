"""The page's server with a drawn camera of 640 x 480 and 30 frames/s: `python -m benchmarks.live.server`.

Each picture carries the time of its capture. Each line on the input is answered by a line of JSON (`Load`).
"""

import itertools
import os
import sys
import threading
import time
from collections.abc import Callable, Iterator
from typing import Any

import cv2
import msgspec
import numpy as np
import uvicorn

from benchmarks.common.resident_memory import resident_mb
from benchmarks.live.bar_code import SIDE, stamp
from matchset.image.frame import Frame
from matchset.live.known_messages import READER
from matchset.live.session import Session
from matchset.live.vision.camera_feed import CameraFeed
from matchset.live.web.application import make_application
from matchset.live.web.listening import listen
from matchset.live.web.security import Guard
from matchset.live.web.session_report import SessionReport
from matchset.live.web.viewer import ViewerContext, Viewers
from matchset.live.wire.pictures import PictureEncoder

WIDTH, HEIGHT, RATE = 640, 480, 30.0
BALL = (320, 260, 40)  # geometry: x, y and radius of the ball, px
NOISE = 6.0  # gray levels: a JPEG of quality 75 has about 50 KB
POOL = 16  # pictures that differ in their noise


class Load(msgspec.Struct):
    """What the server has used so far.

    Parameters
    ----------
    time, processor : float
        s
    frames : int
        Pictures through the loop.
    dropped : int
    resident_mb : float
    """

    time: float
    processor: float
    frames: int
    dropped: int
    resident_mb: float


class DrawnCamera:
    """A camera that draws; late readers lose pictures, as with a real one."""

    width, height, channels, fps, live = WIDTH, HEIGHT, 3, RATE, True
    warnings: tuple[str, ...] = ()
    lost = ""

    def __init__(self) -> None:
        noise = np.random.default_rng(0)
        plain = np.full((HEIGHT, WIDTH, 3), 90, np.uint8)
        cv2.circle(plain, BALL[:2], BALL[2], (200, 60, 60), -1, cv2.LINE_AA)
        drawn = [plain + noise.normal(0.0, NOISE, plain.shape) for _ in range(POOL)]
        self._pool = [np.clip(each, 0.0, 255.0).astype(np.uint8) for each in drawn]
        self._begin, self._index, self.dropped = time.monotonic(), -1, 0

    def __enter__(self) -> "DrawnCamera":
        return self

    def __exit__(self, *_: object) -> None:
        pass

    def __iter__(self) -> "DrawnCamera":
        return self

    def until(self, stopped: Callable[[], bool]) -> Iterator[Frame]:
        """Frames until somebody asks to stop."""
        return itertools.takewhile(lambda _: not stopped(), self)

    def __next__(self) -> Frame:
        due = int((time.monotonic() - self._begin) * RATE)
        late = max(due - self._index - 1, 0)
        self.dropped += late
        self._index += late + 1
        time.sleep(max(0.0, self._begin + self._index / RATE - time.monotonic()))
        image = self._pool[self._index % POOL].copy()
        captured = time.monotonic()
        stamp(image, int(time.time() * 1000.0))
        return Frame(image, captured, self._index)


def main() -> None:
    """Serve until the input ends."""
    listener, port = listen("127.0.0.1", 0)
    session, viewers = Session(), Viewers()
    desk = ViewerContext(session, PictureEncoder(), READER, SessionReport(session))

    def news(number: int) -> None:
        seen = desk.session.hear(number)
        if seen is not None:
            viewers.tell(number, seen)

    camera: Any = DrawnCamera()
    feed = CameraFeed("drawn camera", lambda: camera, news, desk.session.note)
    desk.session.show(feed)
    server = uvicorn.Server(
        uvicorn.Config(make_application(desk, viewers, Guard([], port, token=False)), log_level="error")
    )
    threading.Thread(target=server.run, args=([listener],), daemon=True).start()
    print(f"http://127.0.0.1:{port}/", flush=True)
    for _ in sys.stdin:
        used = os.times()
        state = feed.vision.seen.state
        load = Load(time.monotonic(), used.user + used.system, state.sequence, camera.dropped, resident_mb())
        print(msgspec.json.encode(load).decode(), flush=True)
    os._exit(0)


if __name__ == "__main__":
    assert SIDE * 32 <= WIDTH
    main()
