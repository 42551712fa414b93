"""What to follow, as the command line says it: `--pick`, `--candidate`, `--color`, `--hsv` or `--gray`."""

import functools
import operator
import re
from pathlib import Path
from typing import Any

import msgspec

from matchset.app.track.frame_picker import ball_like_frame, frame_at, pick_in
from matchset.image.color import ColorModel
from matchset.image.frame import Frame
from matchset.image.video import Video

_PICK = re.compile(r"\s*(-?\d+(?:\.\d+)?)\s*,\s*(-?\d+(?:\.\d+)?)\s*(?:@\s*(\d{1,9})\s*)?")
_CANDIDATE = re.compile(r"\s*(\d{1,9})\s*(?:@\s*(\d{1,9})\s*)?")
_HSV = re.compile(r"\s*(\d+),(\d+),(\d+)\s*:\s*(\d+),(\d+),(\d+)\s*")


class Target(msgspec.Struct, frozen=True):
    """What to follow.

    Parameters
    ----------
    color : ColorModel
        Its color.
    start : tuple of two floats, or None
        A point on it, px, if one was clicked.
    frame : int
        The frame in which it was clicked.
    """

    color: Any
    start: tuple[float, float] | None = None
    frame: int = 0


class Wish(msgspec.Struct, frozen=True):
    """The options that say what to follow, as typed; exactly one of the five is given, or `pick` with `gray`."""

    pick: str | None = None
    candidate: str | None = None
    colors: tuple[Path, ...] = ()
    hsv: tuple[str, ...] = ()
    gray: str | None = None


def check_wish(wish: Wish, source: str) -> None:
    """Refuse a wish that is none or several, or does not read (ValueError)."""
    given = sum(map(bool, (wish.pick is not None, wish.candidate is not None, wish.colors, wish.hsv)))
    if given + (wish.gray is not None and wish.pick is None) > 1:
        raise ValueError("give one of --pick, --candidate, --color, --hsv and --gray, not several")
    if wish.gray is not None:
        parse_gray(wish.gray)
        return
    if given == 0:
        raise ValueError(
            "say what to follow: --pick X,Y[@FRAME], --candidate N, --color FILE, --hsv LOW:HIGH or --gray dark; "
            f"'matchset learn {source}' shows where the ball is"
        )
    if wish.pick is not None:
        parse_pick(wish.pick)
    if wish.candidate is not None:
        parse_candidate(wish.candidate)


def known_target(wish: Wish) -> Target | None:
    """Return the target if no picture is needed to tell it: a color file, HSV ranges, or brightness."""
    if wish.gray is not None:
        x, y, index = parse_pick(wish.pick) if wish.pick is not None else (0.0, 0.0, None)
        return Target(parse_gray(wish.gray), None if wish.pick is None else (x, y), index or 0)
    models = [ColorModel.load(path) for path in wish.colors] + [parse_hsv(text) for text in wish.hsv]
    return Target(functools.reduce(operator.or_, models)) if models else None


def target_in(video: Video, wish: Wish) -> tuple[Target, Frame]:
    """Learn the target from a picture of the video.

    Parameters
    ----------
    video : Video
        Not yet read; it is read as far as the picture.
    wish : Wish
        With `pick` or `candidate`.

    Returns
    -------
    tuple of Target and Frame
        What to follow, and the picture it was learnt from.
    """
    if wish.pick is not None:
        x, y, index = parse_pick(wish.pick)
        frame = frame_at(video, index or 0)
    else:
        number, index = parse_candidate(wish.candidate or "")
        if index is None:
            frame, found = ball_like_frame(video)
            x, y = pick_in(frame, number, found)
        else:
            frame = frame_at(video, index)
            x, y = pick_in(frame, number)
    return Target(ColorModel.pick(frame.image, x, y), (x, y), frame.index), frame


def target_for(source: str, video: Video, wish: Wish) -> tuple[Target, tuple[Frame, ...]]:
    """Find out what to follow in a video that is about to be read.

    Parameters
    ----------
    source : str
        What was opened: a file is opened once more to look at it.
    video : Video
        Not yet read.
    wish : Wish
        What to follow, as typed.

    Returns
    -------
    tuple of Target and tuple of Frame
        And the frames that a live source gave away for it, which are to be followed all the same.
    """
    known = known_target(wish)
    if known is not None:
        return known, ()
    if video.live:
        target, frame = target_in(video, wish)
        return msgspec.structs.replace(target, frame=frame.index), (frame,)
    with Video(source) as look:
        target, _ = target_in(look, wish)
    return target, ()


def parse_pick(text: str, option: str = "--pick") -> tuple[float, float, int | None]:
    """Read ``X,Y`` or ``X,Y@FRAME``."""
    found = _PICK.fullmatch(text)
    if found is None:
        raise ValueError(f"{option} is X,Y or X,Y@FRAME, as in 427,146@60, got {text!r}")
    return float(found[1]), float(found[2]), None if found[3] is None else int(found[3])


def parse_candidate(text: str) -> tuple[int, int | None]:
    """Read ``N`` or ``N@FRAME``."""
    found = _CANDIDATE.fullmatch(text)
    if found is None:
        raise ValueError(f"--candidate is N or N@FRAME, as in 1@60, got {text!r}")
    return int(found[1]), None if found[2] is None else int(found[2])


def parse_gray(text: str) -> ColorModel:
    """Read ``dark``, ``light`` or ``edges``."""
    models = {"dark": ColorModel.dark, "light": ColorModel.light, "edges": ColorModel.edges}
    if text not in models:
        raise ValueError(f"--gray is dark, light or edges, got {text!r}")
    return models[text]()


def parse_hsv(text: str) -> ColorModel:
    """Read ``H,S,V:H,S,V``, OpenCV's HSV: hue 0 ... 179, the others 0 ... 255."""
    found = _HSV.fullmatch(text)
    if found is None:
        raise ValueError(f"--hsv is LOW:HIGH, as in 35,60,40:85,255,255, got {text!r}")
    numbers = [int(number) for number in found.groups()]
    return ColorModel.hsv((numbers[0], numbers[1], numbers[2]), (numbers[3], numbers[4], numbers[5]))
