"""A pilot's camera whose pictures are coded as JPEG before anybody sees them: `CodedCamera`, `CodedFrame`.

What is flown by is then what is recorded, to the last bit, in a tenth of the bytes of a lossless picture.
"""

import cv2
import numpy as np
import numpy.typing as npt

from matchset.image.frame import Frame
from matchset.links.camera import Camera
from matchset.media.picture import decode_deep


class CodedFrame(Frame, frozen=True):
    """A frame that was decoded from a JPEG.

    Parameters
    ----------
    jpeg : bytes
        The picture as it was coded.
    """

    jpeg: bytes = b""


class CodedCamera:
    """Gives a pilot the pictures of a camera as they come out of a JPEG.

    Parameters
    ----------
    camera : Camera
    quality : int
        Of the JPEG, 1 ... 100.

    Attributes
    ----------
    model : CameraModel
    """

    def __init__(self, camera: Camera, quality: int) -> None:
        self.model, self._camera, self._quality = camera.model, camera, quality

    def read(self) -> Frame | None:
        """Return the next picture; None if none came."""
        frame = self._camera.read()
        return None if frame is None else coded_frame(frame, self._quality)

    def now(self) -> float:
        """Return the time on the clock of the pictures, s."""
        return self._camera.now()


def coded_frame(frame: Frame, quality: int) -> CodedFrame:
    """Code a picture as JPEG and decode it, as a replay will."""
    jpeg = to_jpeg(frame.image, quality)
    image = np.asarray(decode_deep(jpeg), np.uint8)
    return CodedFrame(image, frame.time, frame.index, rows=frame.rows, jpeg=jpeg)


def to_jpeg(image: npt.NDArray[np.uint8], quality: int) -> bytes:
    """Code a picture as JPEG."""
    return cv2.imencode(".jpg", image, [cv2.IMWRITE_JPEG_QUALITY, quality])[1].tobytes()
