"""JPEGs of the newest picture, each made once for all viewers and only if one wants it: `PictureEncoder`."""

import asyncio
from collections import OrderedDict
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from typing import Any

import cv2
import numpy as np
import numpy.typing as npt

from matchset.live.wire.flow import Size

Image = npt.NDArray[np.uint8]
KEPT = 16  # format: JPEGs at hand, a few sizes of a few pictures


def encoded(image: Image, size: Size) -> bytes:
    """Encode a picture as JPEG."""
    if size.scale != 1.0:
        image = cv2.resize(image, None, fx=size.scale, fy=size.scale, interpolation=cv2.INTER_AREA)  # type: ignore[assignment]
    done, data = cv2.imencode(".jpg", image, [cv2.IMWRITE_JPEG_QUALITY, size.quality])
    if not done:
        raise ValueError(f"a picture of {image.shape} cannot be encoded as JPEG")
    return data.tobytes()


def _png(make: Callable[[], Image]) -> bytes:
    data: Image = cv2.imencode(".png", make(), [cv2.IMWRITE_PNG_BILEVEL, 1])[1]
    return data.tobytes()


class PictureEncoder:
    """Encodes in a thread; OpenCV lets others run meanwhile."""

    def __init__(self) -> None:
        self._thread = ThreadPoolExecutor(1, "matchset jpeg")
        self._made: OrderedDict[tuple[tuple[int, int], int, float], asyncio.Future[bytes]] = OrderedDict()

    async def picture(self, number: tuple[int, int], image: Image, size: Size) -> bytes:
        """Return the JPEG of a picture, given its stream and its number there."""
        key = number, size.quality, size.scale
        future: Any = self._made.get(key)
        if future is None:
            future = asyncio.get_running_loop().run_in_executor(self._thread, encoded, image, size)
            self._made[key] = future
            while len(self._made) > KEPT:
                self._made.popitem(last=False)
        data: bytes = await asyncio.shield(future)
        return data

    async def mask(self, make: Callable[[], Image]) -> bytes:
        """Return a mask as PNG, made in the same thread; what `make` raises is raised here."""
        data: bytes = await asyncio.get_running_loop().run_in_executor(self._thread, _png, make)
        return data

    def forget(self) -> None:
        """Forget what was made: other streams have the same numbers."""
        self._made.clear()

    def close(self) -> None:
        """End the thread."""
        self._thread.shutdown(cancel_futures=True)
