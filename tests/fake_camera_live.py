"""`matchset live` on a computer with a camera: OpenCV's capture is one that makes its pictures and has settings.

Run as a program with the arguments of `matchset`. It lives while the file named by MATCHSET_FAKE_CAMERA exists.
"""

import os
import time
from pathlib import Path

import cv2
import numpy as np
import numpy.typing as npt

SIZES = ((320, 240), (640, 480))
EXPOSURES = 1.0, 2047.0


class SettableCamera:
    """Delivers 30 pictures a second of a ball; brighter with a longer exposure; gain cannot be set, nor a rate."""

    def __init__(self, plug: Path | None = None) -> None:
        self._plug, self._number, self._last = plug, 0, 0.0
        self.values: dict[int, float] = {
            cv2.CAP_PROP_FRAME_WIDTH: 320.0,
            cv2.CAP_PROP_FRAME_HEIGHT: 240.0,
            cv2.CAP_PROP_FPS: 30.0,
            cv2.CAP_PROP_EXPOSURE: 156.0,
            cv2.CAP_PROP_AUTO_EXPOSURE: 3.0,
            cv2.CAP_PROP_WB_TEMPERATURE: 4600.0,
            cv2.CAP_PROP_AUTO_WB: 1.0,
        }
        self._wanted = [320.0, 240.0]

    def isOpened(self) -> bool:  # noqa: N802 - OpenCV's name
        return self._plug is None or self._plug.exists()

    def getBackendName(self) -> str:  # noqa: N802 - OpenCV's name
        return "V4L2"

    def grab(self) -> bool:
        if not self.isOpened():
            return False
        time.sleep(max(0.0, self._last + 1.0 / 30.0 - time.monotonic()))
        self._last, self._number = time.monotonic(), self._number + 1
        return True

    def retrieve(self) -> tuple[bool, npt.NDArray[np.uint8]]:
        width, height = (int(self.values[name]) for name in (cv2.CAP_PROP_FRAME_WIDTH, cv2.CAP_PROP_FRAME_HEIGHT))
        image = np.full((height, width, 3), min(40 + int(self.values[cv2.CAP_PROP_EXPOSURE] / 10), 220), np.uint8)
        center = width // 2 + self._number % 20, height // 2
        cv2.circle(image, center, height // 6, (200, 80, 30), cv2.FILLED, cv2.LINE_AA)
        return True, image

    def get(self, name: int) -> float:
        return self.values.get(name, 0.0 if name == cv2.CAP_PROP_POS_MSEC else -1.0)

    def set(self, name: int, value: float) -> bool:
        if name in (cv2.CAP_PROP_FRAME_WIDTH, cv2.CAP_PROP_FRAME_HEIGHT):
            self._wanted[name == cv2.CAP_PROP_FRAME_HEIGHT] = value
            nearest = min(SIZES, key=lambda size: abs(size[0] - self._wanted[0]) + abs(size[1] - self._wanted[1]))
            self.values[cv2.CAP_PROP_FRAME_WIDTH], self.values[cv2.CAP_PROP_FRAME_HEIGHT] = map(float, nearest)
            return True
        if name not in self.values or name == cv2.CAP_PROP_FPS:
            return False
        self.values[name] = min(max(value, EXPOSURES[0]), EXPOSURES[1]) if name == cv2.CAP_PROP_EXPOSURE else value
        return True

    def release(self) -> None:
        pass


def main() -> None:
    from matchset import cli
    from matchset.media import camera_stream

    plug = Path(os.environ["MATCHSET_FAKE_CAMERA"])

    setattr(camera_stream, "open_capture", lambda *_: SettableCamera(plug))  # noqa: B010 - in OpenCV's place
    cli.main()


if __name__ == "__main__":
    main()
