"""One frame of a video: a given one (`frame_at`), or one that shows something ball-like (`ball_like_frame`)."""

from itertools import islice
from typing import Any

import cv2
import msgspec
import numpy as np
import numpy.typing as npt

from matchset.image.candidates import Candidate, find_candidates
from matchset.image.circle_score import SCORE
from matchset.image.frame import Frame
from matchset.image.video import Video


class PickerParameters(msgspec.Struct, frozen=True):
    """Which frames of a video are looked at for something ball-like.

    Parameters
    ----------
    samples : int
        Frames spread over the video: more find a ball that is visible for a short time, and take longer. Chosen by
        hand; `tests/app/track/test_learn_command.py` shows a change.
    warm_up : int
        Frames of a camera that are skipped until its automatic exposure has settled. Chosen by hand; no benchmark has
        a camera.
    dark : int
        Gray level that no part of a black picture reaches. Higher takes night scenes for black ones. Chosen by hand:
        black of a limited-range video that was read as full range is 16.
    dark_part : int
        Side of such a part, px: larger overlooks small lights, smaller sees noise. Chosen by hand; the ball must be
        larger (docs/limits.md).
    dark_frames : int
        Frames that are read behind a black one in search of another.
    """

    samples: int = 24
    warm_up: int = 15
    dark: int = 24
    dark_part: int = 4
    dark_frames: int = 3000


PARAMETERS = PickerParameters()


def frame_at(video: Video, index: int) -> Frame:
    """Read a video up to a frame.

    Parameters
    ----------
    video : Video
        Not yet read beyond the frame.
    index : int
        Its index; of a live source, the first frame at or after it.

    Raises
    ------
    ValueError
        If the video has no such frame, or it cannot be decoded.
    """
    last = -1
    for frame in video:
        last = frame.index
        if frame.index == index or (video.live and frame.index > index):
            return frame
        if frame.index > index:
            raise ValueError(f"frame {index} could not be decoded")
    raise ValueError(f"there is no frame {index}: the video has frames 0 ... {last}")


def lit_frame_at(video: Video, index: int) -> Frame:
    """Read a video up to a frame that somebody clicked on, or is to click on, and that is not black.

    Parameters
    ----------
    video : Video
        Not yet read beyond the frame.
    index : int
        Its index; of a live source, the first frame at or after it that is not black.

    Raises
    ------
    ValueError
        If the video has no such frame, it cannot be decoded, or it is black; then with the next one that is not.
    """
    frame = frame_at(video, index)
    if not is_black(frame.image):
        return frame
    for later in islice(video, PARAMETERS.dark_frames):
        if is_black(later.image):
            continue
        if video.live:
            return later
        raise ValueError(
            f"frame {index} is black; the first after it that is not is frame {later.index}: "
            f"choose that one, --pick X,Y@{later.index} or 'matchset learn' with --frame {later.index}"
        )
    raise ValueError(f"frame {index} is black, and so is what follows")


def is_black(image: npt.NDArray[np.uint8]) -> bool:
    """Whether a picture is black all over, noise aside."""
    size = [max(1, side // PARAMETERS.dark_part) for side in image.shape[1::-1]]
    return int(cv2.resize(image, size, interpolation=cv2.INTER_AREA).max()) < PARAMETERS.dark


def ball_like_frame(video: Video) -> tuple[Frame, list[Candidate]]:
    """Choose a frame: the first with a convincing candidate among some spread over the video.

    Parameters
    ----------
    video : Video
        Not yet read. Of a live source, a frame is taken once the exposure has settled.

    Returns
    -------
    tuple of Frame and list of Candidate
        The frame and its candidates; if none is convincing, those of the best frame. It is never a black one.

    Raises
    ------
    ValueError
        If the video holds no frames but black ones.
    """
    if video.live:
        frame = lit_frame_at(video, PARAMETERS.warm_up)
        return frame, find_candidates(frame.image)
    step = max(1, (video.length or 10 * PARAMETERS.samples) // PARAMETERS.samples)
    best: tuple[float, Frame, list[Candidate]] | None = None
    for frame in video:
        if frame.index % step and best is not None:
            continue
        if is_black(frame.image):
            continue
        found = find_candidates(frame.image)
        score = found[0].score if found else 0.0
        if best is None or score > best[0]:
            best = score, frame, found
        if score >= SCORE.convincing or frame.index > 2 * PARAMETERS.samples * step:
            break
    if best is None:
        raise ValueError("the video holds no frames but black ones")
    return best[1], best[2]


def pick_in(frame: Frame, number: int, found: list[Candidate] | None = None) -> tuple[float, float]:
    """Return the point at which to click for a candidate of a frame, by its number from 1.

    Raises
    ------
    ValueError
        If there is no such candidate.
    """
    candidates: list[Any] = find_candidates(frame.image) if found is None else found
    if not 1 <= number <= len(candidates):
        have = f"candidates 1 ... {len(candidates)}" if candidates else "no ball-like candidates"
        raise ValueError(f"there is no candidate {number} in frame {frame.index}: it has {have}")
    x, y = candidates[number - 1].pick
    return float(x), float(y)
