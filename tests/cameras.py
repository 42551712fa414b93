"""A capture in the place of OpenCV's, which delivers pictures when the test says so."""

import threading
from collections.abc import Callable

import cv2
import numpy as np
import numpy.typing as npt

PATIENCE = 20.0  # s; only ever spent where a test fails


class Camera:
    """A capture that delivers pictures when the test calls `show`, which waits until they are taken."""

    def __init__(self, backend: str = "V4L2") -> None:
        self.backend, self.opened, self.released = backend, True, threading.Event()
        self.values: dict[int, float] = {cv2.CAP_PROP_FPS: 30.0}
        self.fixed: dict[int, float] = {}
        self.set_to: dict[int, float] = {}
        self.stamp: Callable[[], float] = lambda: 0.0
        self._pictures: list[npt.NDArray[np.uint8] | None] = []
        self._change = threading.Condition()
        self._waiting, self._unplugged = False, False
        self.error: Exception | None = None

    def show(self, *values: int | None, size: tuple[int, ...] = (6, 8, 3)) -> None:
        """Deliver pictures of these gray values (None: broken); return when the thread has taken them all."""
        with self._change:
            self._pictures += [None if value is None else np.full(size, value, np.uint8) for value in values]
            self._waiting = False
            self._change.notify_all()
            assert self._change.wait_for(lambda: self._waiting and not self._pictures, PATIENCE)

    def unplug(self) -> None:
        with self._change:
            self._unplugged = True
            self._change.notify_all()

    def fail(self, error: Exception) -> None:
        with self._change:
            self.error = error
            self._change.notify_all()

    def isOpened(self) -> bool:  # noqa: N802 - OpenCV's name
        return self.opened

    def getBackendName(self) -> str:  # noqa: N802 - OpenCV's name
        return self.backend

    def grab(self) -> bool:
        with self._change:
            self._waiting = not self._pictures
            self._change.notify_all()
            self._change.wait_for(lambda: self._pictures or self._unplugged or self.error, PATIENCE)
            if self.error:
                raise self.error
            return bool(self._pictures)

    def retrieve(self) -> tuple[bool, npt.NDArray[np.uint8] | None]:
        with self._change:
            image = self._pictures.pop(0)
            return image is not None, image

    def get(self, name: int) -> float:
        if name == cv2.CAP_PROP_POS_MSEC:
            return self.stamp()
        return self.fixed.get(name, self.set_to.get(name, self.values.get(name, -1.0)))

    def set(self, name: int, value: float) -> bool:
        self.set_to[name] = value
        return True

    def release(self) -> None:
        self.released.set()
