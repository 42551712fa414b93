"""What to track: from `--pick`, `--candidate`, `--color`, `--hsv` or `--gray` to a color and a start (`target_for`)."""

import functools
import operator
import re
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import msgspec

from matchset.app.cli_options import TargetOptions
from matchset.app.guidance.choice import choose
from matchset.app.target.frame_picker import frame_at, lit_frame_at
from matchset.image.color import ColorModel
from matchset.image.frame import Frame
from matchset.localization.markers.ball_colors import pick_marker
from matchset.media.video import Video

_PICK = re.compile(r"\s*(-?\d+(?:\.\d+)?)\s*,\s*(-?\d+(?:\.\d+)?)\s*(?:@\s*(\d{1,9})\s*)?")
_CANDIDATE = re.compile(r"\s*(\d{1,9})\s*(?:@\s*(\d{1,9})\s*)?")
_HSV = re.compile(r"\s*(\d+),(\d+),(\d+)\s*:\s*(\d+),(\d+),(\d+)\s*")


class RefusedClickError(ValueError):
    """A click in the picture from which no color could be learned.

    Parameters
    ----------
    words : str
        Why.
    frame : Frame
        Where it was.
    click : tuple of two floats
        px.
    """

    def __init__(self, words: str, frame: Frame, click: tuple[float, float]) -> None:
        super().__init__(words)
        self.frame, self.click = frame, click


class LearnedTarget(msgspec.Struct, frozen=True):
    """What to track.

    Parameters
    ----------
    color : ColorModel
        Its color.
    start : tuple of two floats, or None
        A point on it, px, if one was clicked.
    frame : int
        The frame in which it was clicked.
    notes : tuple of str
        What is to be said of how the click was understood.
    """

    color: Any
    start: tuple[float, float] | None = None
    frame: int = 0
    notes: tuple[str, ...] = ()

    def say_notes(self) -> None:
        """Print the notes, once all else that was typed has been understood."""
        for note in self.notes:
            print(f"note: {note}", file=sys.stderr)


def check_target_options(options: TargetOptions, source: str) -> None:
    """Check that exactly one way is given to say what to track, and that it can be read.

    Parameters
    ----------
    options : TargetOptions
        As typed.
    source : str
        The video, quoted for a shell, for the error message.

    Raises
    ------
    ValueError
        If none or several are given, or one cannot be read.
    """
    choices = (options.pick is not None, options.candidate is not None, options.color, options.hsv)
    given = sum(map(bool, choices))
    if given + (options.gray is not None and options.pick is None) > 1:
        raise ValueError("give one of --pick, --candidate, --color, --hsv and --gray, not several")
    if options.reading != 1 and (options.pick is None or options.gray is not None):
        raise ValueError("--reading says what a --pick means: give one, without --gray")
    if options.gray is not None:
        parse_gray(options.gray)
        return
    if given == 0:
        raise ValueError(
            "say what to follow: --pick X,Y[@FRAME], --candidate N, --color FILE, --hsv LOW:HIGH or --gray dark; "
            f"'matchset learn {source}' shows where the ball is"
        )
    if options.pick is not None:
        parse_pick(options.pick)
    if options.candidate is not None:
        parse_candidate(options.candidate)


def target_without_picture(options: TargetOptions) -> LearnedTarget | None:
    """Return the target if no picture is needed for it: of a color file, HSV ranges, or brightness; else None."""
    if options.gray is not None:
        x, y, index = parse_pick(options.pick) if options.pick is not None else (0.0, 0.0, None)
        return LearnedTarget(parse_gray(options.gray), None if options.pick is None else (x, y), index or 0)
    models = [ColorModel.load(path) for path in options.color or ()] + [parse_hsv(text) for text in options.hsv or ()]
    return LearnedTarget(functools.reduce(operator.or_, models)) if models else None


def load_color(paths: Sequence[str | Path]) -> ColorModel:
    """Read the files of a color, one or more, and join them."""
    return functools.reduce(operator.or_, map(ColorModel.load, paths))


def target_in(video: Video, options: TargetOptions) -> tuple[LearnedTarget, Frame]:
    """Learn the target from a picture of the video.

    Parameters
    ----------
    video : Video
        Not yet read; it is read up to the picture, and a file may be opened once more.
    options : TargetOptions
        With `pick` or `candidate`.

    Returns
    -------
    tuple of LearnedTarget and Frame
        What to track, and the picture it was learned from.
    """
    if options.pick is not None:
        x, y, index = parse_pick(options.pick)
        frame = lit_frame_at(video, index or 0)
    else:
        frame, (x, y) = _candidate_in(video, options.candidate or "")
    color = color_at(frame, x, y, options.reading, options.ball)
    notes = (taken_words(color, options.reading), *([color.note] if color.note else []))
    return LearnedTarget(color, (x, y), frame.index, notes), frame


def _candidate_in(video: Video, text: str) -> tuple[Frame, tuple[int, int]]:
    """Find the frame and the pixel of a candidate, numbered as `learn` numbers them."""
    number, index = parse_candidate(text)
    given = None if index is None else frame_at(video, index)
    if given is None or video.live:
        choice = choose(video, given)
    else:
        with video.again() as again:
            choice = choose(again, given)
    count = len(choice.candidates)
    if not 1 <= number <= count:
        have = f"candidates 1 ... {count}" if count else "no ball-like candidates"
        raise ValueError(f"there is no candidate {number} in frame {choice.frame.index}: it has {have}")
    return choice.frame, choice.candidates[number - 1].pick


def taken_words(color: ColorModel, reading: int = 1) -> str:
    """Say what a click was taken for, how sure that is, and what else it may mean."""
    taken, others = color.alternatives[reading - 1], list(enumerate(color.alternatives, 1))
    words = f"the click is taken for: {taken}"
    rest = [f"{each} (--reading {number})" for number, each in others if number != reading]
    return "; ".join((words, *(f"or {each}" for each in rest[:1])))


def color_at(frame: Frame, x: float, y: float, reading: int = 1, ball: bool = True, marker: bool = False) -> ColorModel:
    """Learn the color at a click; `RefusedClickError` where none can be learned, ValueError outside of the picture."""
    try:
        if marker:
            return pick_marker(frame.image, x, y)
        return ColorModel.pick(frame.image, x, y, reading=reading, ball=ball)
    except ValueError as error:
        rows, columns = frame.image.shape[:2]
        outside = not (-0.5 <= x < columns - 0.5 and -0.5 <= y < rows - 0.5)
        if outside or reading != 1:
            raise
        raise RefusedClickError(str(error), frame, (x, y)) from error


def target_for(video: Video, options: TargetOptions) -> tuple[LearnedTarget, tuple[Frame, ...]]:
    """Learn what to track in a video that is about to be read.

    Parameters
    ----------
    video : Video
        Not yet read; a file is opened a second time to learn from it.
    options : TargetOptions
        What to track, as typed.

    Returns
    -------
    target : LearnedTarget
    frames : tuple of Frame
        Frames that were taken from a live source to learn from; they are to be tracked too.
    """
    known = target_without_picture(options)
    if known is not None:
        if known.start is not None and not video.live:
            with video.again() as second:
                lit_frame_at(second, known.frame)
        return known, ()
    if video.live:
        target, frame = target_in(video, options)
        return msgspec.structs.replace(target, frame=frame.index), (frame,)
    with video.again() as second:
        target, _ = target_in(second, options)
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
