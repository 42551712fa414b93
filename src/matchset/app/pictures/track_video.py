"""A video with what was found drawn into its frames, for programs and notebooks: `write_video`."""

import itertools
import os
import warnings
from collections import deque
from collections.abc import Iterable, Iterator, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from matchset.app.drawing.annotate import Color
from matchset.app.drawing.draw import Found, answers_of, draw
from matchset.app.drawing.trail import TrailParameters
from matchset.app.films.codecs import codecs_for
from matchset.app.films.video_writer import FilmWriter
from matchset.app.pictures.run_pictures import DEFAULT_FPS
from matchset.image.frame import Frame, Picture
from matchset.numeric.arguments import check_number

FIRST = 9  # format: frames from whose times the rate is taken: a median of eight intervals


def write_video(
    path: str | os.PathLike[str],
    frames: Iterable[Picture],
    tracks: Iterable[Found | Sequence[Found]],
    *,
    fps: float | None = None,
    trail: bool = True,
    colors: Sequence[Color] | None = None,
) -> Path:
    """Write a video with what was found drawn into its frames; one frame is in memory at a time.

    Parameters
    ----------
    path : str or Path
        Ends in .mp4 (H.264 with the package av or a program `ffmpeg`), .webm (VP8) or .avi (Motion JPEG). Overwritten.
    frames : iterable of Frame, or of ndarray of shape (h, w, 3) or (h, w), uint8
        Such as a `Video` that is read once more.
    tracks : iterable of Track or Lost, or of sequences of them
        For each frame, what `Tracker.update` returned for it; for several targets a sequence with one for each, always
        in the same order.
    fps : float, optional
        Frames per second. By default that of the video, or of the times of the first frames; 30 for arrays.
    trail : bool
        Whether the way of the last 40 frames is drawn as a fading line.
    colors : sequence of (blue, green, red), optional
        One for each target, as in `draw`.

    Returns
    -------
    Path
        That of the video.

    Raises
    ------
    ValueError
        If the name has another ending, the file cannot be written, there is no frame, there are not as many frames as
        tracks, or the pictures have several sizes; then the video has the frames up to there.
    TypeError
        If there is something else among the frames or the tracks.

    Examples
    --------
    >>> tracks = [tracker.update(frame) for frame in ms.Video("ball.mp4")]  # doctest: +SKIP
    >>> ms.write_video("found.mp4", ms.Video("ball.mp4"), tracks)  # doctest: +SKIP
    """
    target = Path(path)
    codecs_for(target)
    rate = fps if fps is not None else getattr(frames, "fps", None)
    pictures: Iterator[Picture] = iter(frames)
    beginning = list(itertools.islice(pictures, FIRST if rate is None else 1))
    if not beginning:
        raise ValueError("there is no frame to write")
    rate = _rate(beginning) if rate is None else rate
    check_number("fps", rate)
    if not 0.0 < rate < float("inf"):
        raise ValueError(f"fps must be positive, got {rate}")
    drawn = _drawn(itertools.chain(beginning, pictures), tracks, trail, colors)
    first = next(drawn)
    with FilmWriter(target, float(rate), (first.shape[1], first.shape[0])) as recorder:
        if recorder.note:
            warnings.warn(recorder.note, stacklevel=2)
        for picture in itertools.chain([first], drawn):
            recorder.write(picture)
    return target


def _drawn(
    frames: Iterable[Picture], tracks: Iterable[Found | Sequence[Found]], trail: bool, colors: Sequence[Color] | None
) -> Iterator[Any]:
    """Yield the frames with what was found."""
    ways: list[deque[Found]] = []
    missing: Any = object()
    for number, (frame, answers) in enumerate(itertools.zip_longest(frames, tracks, fillvalue=missing)):
        if frame is missing or answers is missing:
            more = "tracks" if frame is missing else "frames"
            raise ValueError(
                f"there must be a track for each frame: there are more {more} than the {number} of the others"
            )
        given = answers_of(answers)
        ways = ways or [deque(maxlen=TrailParameters().frames) for _ in given]
        if len(ways) != len(given):
            raise ValueError(
                f"each frame must have as many tracks as the first, {len(ways)}, frame {number} has {len(given)}"
            )
        yield np.asarray(draw(frame, given, trail=[list(way) for way in ways] if trail else None, colors=colors))
        for way, answer in zip(ways, given, strict=True):
            way.append(answer)


def _rate(frames: Sequence[Picture]) -> float:
    """Frames per second by the times of some frames."""
    times = [each.time for each in frames if isinstance(each, Frame)]
    if len(times) < max(len(frames), 2):
        return DEFAULT_FPS
    period = float(np.median(np.diff(times)))
    return 1.0 / period if period > 0.0 else DEFAULT_FPS
