"""Which kind of source a name means, and how it is opened."""

import math
import os
import re
from pathlib import Path

from matchset.media.bags.bag import Bag, is_bag
from matchset.media.camera_stream import LiveSource
from matchset.media.streams.silence import Silence
from matchset.media.upright.orientation import AS_STORED
from matchset.media.upright.view import View, Wish, view_of
from matchset.media.video_files.image_folder import ImageFolder, is_picture
from matchset.media.video_files.video_file import VideoFile
from matchset.numeric.arguments import check_number

MediaSource = LiveSource | ImageFolder | VideoFile | Bag


def finite(name: str, value: float) -> float:
    """Return a finite number as a float (ValueError)."""
    check_number(name, value)
    if not math.isfinite(value):
        raise ValueError(f"{name} must be finite, got {value}")
    return float(value)


def name_of(source: int | str | Path) -> str:
    """Name the source in messages, without the password a URL may hold."""
    if isinstance(source, bool) or not isinstance(source, int | str | os.PathLike) or source == "":
        raise ValueError(f"a video is a path, a camera number or a URL, got {source!r}")
    text = str(source)
    if isinstance(source, int) or _is_number(text):
        return f"camera {int(text)}"
    return re.sub(r"://[^/]*@", "://", text)


def _is_number(text: str) -> bool:
    return re.fullmatch(r"[0-9]+", text) is not None


def open_source(
    source: int | str | Path, name: str, silence: Silence, asked: dict[str, float], topic: str | None, wish: Wish
) -> MediaSource:
    """Choose the kind of source."""
    text = str(source)
    path = None if isinstance(source, int) or _is_stream(source) else Path(source)
    if path is not None and is_bag(path):
        _check_no_stream(wish, name)
        return Bag(path, topic, asked.get("fps"), wish.damaged is not False)
    if topic is not None:
        raise ValueError(f"a topic belongs to a bag (.bag, .db3, .mcap, or a folder of a ROS 2 bag), not to {name}")
    if isinstance(source, int) and source < 0:
        raise ValueError(f"a camera number must not be negative, got {source}")
    if path is None or path.is_char_device():
        _check_no_stream(wish, name)
        return LiveSource(int(text) if _is_number(text) else text, name, silence, asked, wish.damaged is True)
    if path.is_dir() or (path.is_file() and is_picture(path)):
        _check_no_stream(wish, name)
        return ImageFolder(path, asked.get("fps"))
    return VideoFile(path, asked.get("fps"), wish)


def _check_no_stream(wish: Wish, name: str) -> None:
    """Refuse a number of a stream for what has none (ValueError)."""
    if wish.stream is not None:
        raise ValueError(f"a stream is one of those of a video file, not of {name}: got {wish.stream}")


def view_of_source(source: MediaSource, wish: Wish) -> tuple[View, float]:
    """Return what is still to be done to the pictures of a source, and the width of their pixels, in heights."""
    if isinstance(source, VideoFile):  # puts them into its view itself
        return View(), source.view.pixel_aspect
    height, width = source.shape[:2]
    ratio = source.pixel_ratio if isinstance(source, LiveSource) else (0.0, 0.0)
    view = view_of(ratio, AS_STORED, (width, height), wish)
    return view, view.pixel_aspect


def _is_stream(source: str | Path) -> bool:
    """Whether a source is a camera's number or a URL; a `Path` never is."""
    if not isinstance(source, str):
        return False
    return _is_number(source) or re.match(r"(?!file:)[A-Za-z][A-Za-z0-9+.-]*://", source) is not None
