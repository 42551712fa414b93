"""Makes the feed of a source: `open_feed`."""

import re
from collections.abc import Callable
from pathlib import Path
from typing import NamedTuple

from matchset.app.live.feed import Feed, News
from matchset.app.live.piloting.flight_feed import simulated_flight
from matchset.app.live.sources.demo_clip import demo_clip
from matchset.app.live.sources.found_sources import CHAIN, DEMO, Source
from matchset.app.live.vision.camera_feed import CameraFeed
from matchset.app.live.vision.paced_video import PacedVideo
from matchset.camera.camera_model import CameraModel


class Opening(NamedTuple):
    """What a feed needs of those who look.

    Attributes
    ----------
    news : callable
        Told of each picture.
    note : callable
        Told what a person should know.
    """

    news: News
    note: Callable[[str], None]


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
    if source.origin == DEMO:
        opening.note("the demo clip is made once, which takes some seconds")
        return _video(source.name, str(demo_clip()), opening)
    return _video(source.name, source.origin, opening)


def _video(title: str, origin: str, opening: Opening) -> Feed:
    feed = CameraFeed(title, lambda: PacedVideo(origin), opening.news, opening.note)
    beside = Path(origin).with_suffix(".toml")
    if not re.fullmatch(r"\d+|[A-Za-z][\w+.-]*://.*", origin) and beside.is_file():
        feed.vision.camera = CameraModel.load(beside)
        opening.note(f"the camera is that of {beside.name}, beside the video")
    return feed
