"""A camera or a stream as a feed: `CameraFeed`."""

from collections.abc import Callable

from matchset.app.cli_options import UPRIGHT, TurnOptions
from matchset.live.camera.camera_panel import CameraPanel
from matchset.live.camera.device import CameraDevice
from matchset.live.camera.settings_panel import SettingsPanel
from matchset.live.feed import Feed, News, Panel
from matchset.live.targets.panel import TargetsPanel
from matchset.live.vision.vision import Vision
from matchset.media.closing import close_all
from matchset.media.video import Video


class CameraFeed(Feed):
    """Shows a live source, opened again where it is gone.

    Parameters
    ----------
    title : str
    open_source : callable
        A `CameraDevice` has settings.
    news : callable
        Told of each picture.
    note : callable
        Told what a person should know.
    mounted : TurnOptions, optional
        How its pictures are turned: camera files are turned, too.
    """

    kind = "camera"

    def __init__(
        self,
        title: str,
        open_source: Callable[[], Video],
        news: News,
        note: Callable[[str], None],
        mounted: TurnOptions = UPRIGHT,
    ) -> None:
        self.title = title
        self.vision = Vision(open_source, news=news, note=note)
        self.streams = (self.vision,)
        self._camera = CameraPanel(self.vision, note, mounted=mounted)
        self.panels: tuple[Panel, ...] = (TargetsPanel(self.vision.ask, self.vision.followed.clicks), self._camera)
        if isinstance(open_source, CameraDevice):
            self.panels += (SettingsPanel(open_source, self.vision.reopen),)

    def close(self) -> None:
        """End the loop and let go of the device."""
        close_all(self._camera.close, self.vision.close)
