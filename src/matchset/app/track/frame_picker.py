"""One frame of a video to look at: a given one, or the first that shows something like a ball."""

from typing import Any

from matchset.app.track.candidates import CONVINCING, Candidate, find_candidates
from matchset.image.frame import Frame
from matchset.image.video import Video

_SAMPLES = 24
_WARM_UP_FRAMES = 15


def frame_at(video: Video, index: int) -> Frame:
    """Read on to a frame.

    Parameters
    ----------
    video : Video
        Not yet read beyond the frame.
    index : int
        Which; of a live source, the first that comes at or after it.

    Raises
    ------
    ValueError
        If the video has no such frame, or it does not decode.
    """
    last = -1
    for frame in video:
        last = frame.index
        if frame.index == index or (video.live and frame.index > index):
            return frame
        if frame.index > index:
            raise ValueError(f"frame {index} could not be decoded")
    raise ValueError(f"there is no frame {index}: the video has frames 0 ... {last}")


def ball_like_frame(video: Video) -> tuple[Frame, list[Candidate]]:
    """Choose a frame to show: the first with a convincing candidate among some spread over the video.

    Parameters
    ----------
    video : Video
        Not yet read. Of a live source, a frame is taken once exposure has settled.

    Returns
    -------
    tuple of Frame and list of Candidate
        The frame and its candidates; if none is convincing, those of the best frame.
    """
    if video.live:
        frame = frame_at(video, _WARM_UP_FRAMES)
        return frame, find_candidates(frame.image)
    step = max(1, (video.length or 10 * _SAMPLES) // _SAMPLES)
    best: tuple[float, Frame, list[Candidate]] | None = None
    for frame in video:
        if frame.index % step and best is not None:
            continue
        found = find_candidates(frame.image)
        score = found[0].score if found else 0.0
        if best is None or score > best[0]:
            best = score, frame, found
        if score >= CONVINCING or frame.index > 2 * _SAMPLES * step:
            break
    if best is None:
        raise ValueError("the video holds no frames")
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
