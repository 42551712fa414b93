"""An open file whose pictures come as they are to be looked at: `UprightCapture`."""

from typing import Any

from matchset.media.capture import Capture
from matchset.media.upright.header_view import take_as_stored
from matchset.media.upright.view import View
from matchset.media.video_files.pyav_capture import reports_damage


class UprightCapture:
    """Does what another capture does, and puts every picture that is retrieved into a view.

    Parameters
    ----------
    capture : Capture
        Hands out pictures as they are stored.
    view : View
    """

    def __init__(self, capture: Capture, view: View) -> None:
        self._capture, self._view = capture, view
        take_as_stored(capture)

    @property
    def damaged(self) -> bool:
        """Whether the decoder reported errors in the frame that was grabbed last, as far as it says so."""
        return reports_damage(self._capture)

    def isOpened(self) -> bool:  # noqa: N802 - OpenCV's name
        """Whether the file was opened."""
        return self._capture.isOpened()

    def getBackendName(self) -> str:  # noqa: N802 - OpenCV's name
        """Name of what decodes."""
        return self._capture.getBackendName()

    def grab(self) -> bool:
        """Decode the next frame; False if it is broken, and at the end."""
        return self._capture.grab()

    def retrieve(self) -> tuple[bool, Any]:
        """Picture that was grabbed last, in its view."""
        decoded, image = self._capture.retrieve()
        if not decoded or image is None or image.size == 0:
            return False, None
        return True, self._view.apply(image[..., 0] if image.ndim == 3 and image.shape[2] == 1 else image)

    def get(self, propId: int, /) -> float:  # noqa: N803 - OpenCV's name
        """Value of one of OpenCV's properties."""
        return self._capture.get(propId)

    def set(self, propId: int, value: float, /) -> bool:  # noqa: N803 - OpenCV's name
        """Set one of OpenCV's properties."""
        return self._capture.set(propId, value)

    def release(self) -> None:
        """Close the file."""
        self._capture.release()
