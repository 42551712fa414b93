"""Makes the feed of a source: `open_feed`."""

import functools
import re
from collections.abc import Callable
from pathlib import Path
from typing import NamedTuple

from matchset.app.cli_options import ViewOptions
from matchset.camera.camera_model import CameraModel
from matchset.live.camera.device import CameraDevice, SetCamera
from matchset.live.feed import Feed, News
from matchset.live.files.file_feed import FileFeed
from matchset.live.piloting.flight_feed import linked_flight, simulated_flight
from matchset.live.sources.demo_clip import demo_clip
from matchset.live.sources.found_sources import CHAIN, DEMO, Source
from matchset.live.vision.camera_feed import CameraFeed
from matchset.media.frame_list import StampedVideo
from matchset.media.upright.view import Wish, checked_fields
from matchset.media.video import Video


class Opening(NamedTuple):
    """What a feed needs of those who look.

    Attributes
    ----------
    news : callable
        Told of each picture.
    note : callable
        Told what a person should know.
    stopped : callable
        Whether the server ends.
    view : ViewOptions
        How the pictures of what the command line names are used.
    """

    news: News
    note: Callable[[str], None]
    stopped: Callable[[], bool] = lambda: False
    view: ViewOptions = ViewOptions()


def open_feed(source: Source, opening: Opening) -> Feed:
    """Make the feed of a source; may take seconds, but does not wait for a camera.

    Parameters
    ----------
    source : Source
    opening : Opening

    Raises
    ------
    ValueError
        If it cannot be shown; says why.
    """
    if source.origin.partition("?")[0] == CHAIN:
        return simulated_flight(source.origin, opening.news)
    if source.kind == "given" and Path(source.origin).suffix.lower() == ".toml":
        return linked_flight(Path(source.origin), opening.news, opening.note)
    if source.kind != "given":
        opening = opening._replace(view=ViewOptions())
    mounted = opening.view.mounted
    if source.origin == DEMO:
        return _video(source.name, str(demo_clip(stopped=opening.stopped)), opening)
    if re.fullmatch(r"[0-9]+", source.origin) or Path(source.origin).is_char_device():
        wish = Wish(**mounted.arguments, fields=checked_fields(opening.view.fields))
        device = CameraDevice(source.origin, functools.partial(SetCamera, wish=wish))
        return CameraFeed(source.name, device, opening.news, opening.note, mounted)
    return _video(source.name, source.origin, opening)


def check_source(source: Source) -> None:
    """Look whether a source can be shown at all: a camera or a stream may come later, a file is a video now.

    Raises
    ------
    ValueError
        If it never can be; says why.
    """
    origin = source.origin
    if origin == DEMO:
        return
    if origin.startswith("sim://"):
        from matchset.flight.chain.config import with_uri
        from matchset.flight.chain.flight_parameters import FlightParameters

        if origin.partition("?")[0] != CHAIN:
            raise ValueError(f"{origin} is nothing simulated: {DEMO} and {CHAIN} are")
        with_uri(origin, FlightParameters())
    elif Path(origin).suffix.lower() == ".toml":
        from matchset.flight.chain.config import read_followers

        if not read_followers(Path(origin)):
            raise ValueError(f"{origin} names no real vehicle: it has no [[follower]] (docs/flight.md)")
    elif not _is_live(origin):
        StampedVideo(origin).close()


def _is_live(origin: str) -> bool:
    """Whether a source is a camera or a stream rather than a file."""
    return bool(re.fullmatch(r"\d+|(?!file:)[A-Za-z][\w+.-]*://.*", origin)) or Path(origin).is_char_device()


def _video(title: str, origin: str, opening: Opening) -> Feed:
    path, mounted, view = Path(origin), opening.view.mounted, opening.view.arguments
    if _is_live(origin):
        return CameraFeed(title, lambda: Video(origin, **view), opening.news, opening.note, mounted)
    feed = FileFeed(title, lambda: StampedVideo(origin, **view), opening.news, opening.note, mounted)
    beside = path.with_suffix(".toml")
    if beside.is_file():
        try:
            feed.use(CameraModel.load(beside).turned(**mounted.arguments))
        except ValueError as error:  # some other file of this name
            opening.note(f"the camera is not known: {error}")
        else:
            opening.note(f"the camera is that of {beside.name}, beside the video")
    return feed
