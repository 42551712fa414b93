"""Targets as MOTChallenge text, for others' scorers and viewers: `MotFile`, and `noted` writes it."""

from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import Any, TypeVar

from matchset.app.disk import UnfinishedFileError, WholeFile
from matchset.app.pictures.run_pictures import DrawnFrame
from matchset.app.run_folder import output_file
from matchset.media.closing import Closing
from matchset.shapes.described import box_of
from matchset.tracking.many.target import Target
from matchset.tracking.track import Track

Answered = TypeVar("Answered", bound=DrawnFrame)
"""One frame of a run: a `TrackedFrame` of one target, or a `FollowedFrame` of several."""


class MotFile(Closing):
    """Writes what was found, a line for each target and frame: frame, id, left, top, width, height, support, -1,-1,-1.

    Frames and ids are counted from 1, as MOTChallenge has it. Boxes are in px from the center of the first pixel, as in
    all tables here.

    Parameters
    ----------
    path : Path

    Raises
    ------
    OSError
        If it cannot be written, with its name; also by `write`.
    """

    def __init__(self, path: Path) -> None:
        self._file, self._lines = WholeFile(path), 0

    def write(self, frame: int, targets: Iterable[Target[Any]]) -> None:
        """Append the targets in a frame, counted from 0; what is lost has no line."""
        lines = [_line(frame, each.identity, each.track) for each in targets if isinstance(each.track, Track)]
        try:
            self._file.append("".join(lines).encode())
        except OSError as error:
            raise UnfinishedFileError(error, self._file.path, f"{self._lines} lines") from None
        self._lines += len(lines)

    def close(self) -> None:
        """Close the file."""
        self._file.close()


def noted(frames: Iterable[Answered], path: Path | None, force: bool, source: str) -> Iterator[Answered]:
    """Pass the frames of a run on, and write what was found to a file, if one is asked for.

    Parameters
    ----------
    frames : iterable of TrackedFrame or FollowedFrame
    path : Path or None
    force : bool
        Whether it may be overwritten.
    source : str
        What is read, which is never overwritten.
    """
    if path is None:
        yield from frames
        return
    with MotFile(output_file(path, force, source)) as file:
        for each in frames:
            file.write(each.row.frame, targets_of(each.answer))
            yield each


def targets_of(answer: Any) -> tuple[Target[Any], ...]:
    """Return the targets of an answer: several, or one alone, whose identity is 0."""
    return answer if isinstance(answer, tuple) else (Target(0, "", answer, 0.0),)


def _line(frame: int, identity: int, track: Track[Any]) -> str:
    left, top, right, bottom = (float(each) for each in box_of(track.shape))
    box = f"{left:.4f},{top:.4f},{right - left:.4f},{bottom - top:.4f}"
    return f"{frame + 1},{identity + 1},{box},{float(track.support):.4f},-1,-1,-1\n"
