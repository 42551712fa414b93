"""What a run says at its end."""

import sys
from collections.abc import Iterable
from pathlib import Path
from typing import TextIO

from matchset.app.track.loop import Tally
from matchset.image.video import Video


def sum_up(video: Video, tally: Tally, words: str, written: Iterable[Path], out: TextIO) -> None:
    """Say what was done.

    Parameters
    ----------
    video : Video
        The source; what is not as it should be with it goes to stderr.
    tally : Tally
        The figures of the run.
    words : str
        What took the time, "tracking".
    written : iterable of Path
        The files.
    out : file
        stdout, or stderr if stdout is a pipe's.
    """
    for warning in video.warnings:
        print("note: " + warning, file=sys.stderr)
    if not tally.frames:
        return
    share = 100.0 * tally.found / tally.frames
    print(f"found in {tally.found} of {tally.frames} frames ({share:.1f} %)", file=out)
    for reason, count in tally.reasons.most_common(5):
        print(f"  {count:6d}  {reason}", file=out)
    if tally.seconds:
        print(f"{words} took {tally.median_ms:.2f} ms of computing a frame (median)", file=out)
    for path in written:
        print(f"  {path}", file=out)
