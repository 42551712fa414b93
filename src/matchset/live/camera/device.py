"""A camera whose settings are kept, and asked for again whenever it is opened: `CameraDevice`."""

import math
from collections.abc import Callable, Mapping

from matchset.image.errors import LinkError
from matchset.live.sources.cameras import FoundCamera, find_cameras
from matchset.media.camera_stream import LiveSource
from matchset.media.streams.camera_settings import Control, Settings
from matchset.media.streams.silence import Silence
from matchset.media.upright.view import ANY, Wish
from matchset.media.video import Video

AT_ONCE = ("exposure", "gain", "white_balance")  # the others need the camera to be opened again


class SetCamera(Video):
    """A camera, opened with any of its settings.

    Parameters
    ----------
    device : str
        Number or path.
    wishes : mapping of str to float
        Names of `matchset.media.streams.camera_settings.PROPERTIES`, and the values asked for.
    timeout : float
        Longest silence, s.
    wish : Wish, optional
        How its pictures are turned.

    Raises
    ------
    LinkError
        If it cannot be opened.
    """

    def __init__(self, device: str, wishes: Mapping[str, float], timeout: float = 2.0, wish: Wish = ANY) -> None:
        self._start(device, dict(wishes), Silence(timeout, reconnect=0.0), None, wish)

    @property
    def current(self) -> Settings:
        """What was asked for, with what the camera says."""
        return self._source.settings if isinstance(self._source, LiveSource) else {}

    @property
    def controls(self) -> dict[str, Control]:
        """The settings that the camera has."""
        return self._source.controls if isinstance(self._source, LiveSource) else {}

    def adjust(self, name: str, value: float | None) -> None:
        """Change a setting before the next picture; see `LiveSource.adjust`."""
        if isinstance(self._source, LiveSource):
            self._source.adjust(name, value)


class CameraDevice:
    """Opens a camera with what a person wants, as often as it is asked to.

    Parameters
    ----------
    device : str
        Number or path.
    open_camera : callable, optional
        Opens it, given device and wishes.
    look : callable, optional
        Finds the cameras that are there: one that was plugged in again may have another number.

    Attributes
    ----------
    wishes : dict of str to float
        What was asked for.
    """

    def __init__(
        self,
        device: str,
        open_camera: Callable[[str, Mapping[str, float]], SetCamera] = SetCamera,
        look: Callable[[], list[FoundCamera]] = find_cameras,
    ) -> None:
        self._device, self._open, self._look, self._name = device, open_camera, look, ""
        self.wishes: dict[str, float] = {}
        self._video: SetCamera | None = None

    def __call__(self) -> SetCamera:
        """Open it.

        Raises
        ------
        LinkError
            If it is not there, or another program has it.
        """
        try:
            self._video = self._open(self._device, self.wishes)
        except LinkError:
            if not (moved := self._moved()):
                raise
            self._video = self._open(moved, self.wishes)
            self._device = moved
        self._name = next((each.name for each in self._look() if each.device == self._device), "")
        return self._video

    def _moved(self) -> str:
        """Return the number under which the only other camera of the same name is now; empty if there is none."""
        found = self._look()
        if not self._name or any(each.device == self._device for each in found):
            return ""
        same = [each.device for each in found if each.name == self._name]
        return same[0] if len(same) == 1 else ""

    @property
    def controls(self) -> dict[str, Control]:
        """The settings that the camera has; none as long as it was not opened."""
        return {} if self._video is None else self._video.controls

    @property
    def settings(self) -> Settings:
        """What was asked for, with what the camera says."""
        return {} if self._video is None else self._video.current

    def ask(self, wishes: Mapping[str, float | None]) -> bool:
        """Ask for settings; None: what the camera chooses.

        Returns
        -------
        bool
            Whether it must be opened again for that.

        Raises
        ------
        ValueError
            If a value is not finite, or the camera has no such setting.
        """
        for name, value in wishes.items():
            if name not in self.controls:
                raise ValueError(f"{name.replace('_', ' ')}: this camera has no such setting")
            if value is not None and not math.isfinite(value):
                raise ValueError(f"{name} must be finite, got {value}")
        kept = {name: value for name, value in self.wishes.items() if name not in wishes}
        self.wishes = kept | {name: value for name, value in wishes.items() if value is not None}
        for name, value in wishes.items():
            if name in AT_ONCE and self._video is not None:
                self._video.adjust(name, value)
        return any(name not in AT_ONCE for name in wishes)
