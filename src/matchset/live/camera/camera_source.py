"""What the calibrations need of a source that is shown: `CameraSource`, `newest_pictures`."""

import threading
from collections.abc import Iterator
from typing import Protocol

from matchset.camera.camera_model import CameraModel
from matchset.live.feed import StreamPicture

POLL = 0.01  # format: s between two looks for a new picture


class CameraSource(Protocol):
    """A source whose camera can be told."""

    @property
    def seen(self) -> StreamPicture:
        """The newest picture."""
        ...

    def use(self, camera: CameraModel | None) -> None:
        """Use another camera model from the next picture on; None: it is not known."""
        ...


def newest_pictures(shown: CameraSource, stop: threading.Event) -> Iterator[StreamPicture]:
    """Yield each new picture, the newest if some came meanwhile, until `stop` is set."""
    last = None
    while not stop.is_set():
        seen = shown.seen
        if seen.frame is None or seen.frame is last or seen.state.fault:
            stop.wait(POLL)
            continue
        last = seen.frame
        yield seen
