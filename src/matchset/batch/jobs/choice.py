"""What is followed in one video: what the batch says, or what is most likely the ball (`chosen_for`)."""

from pathlib import Path

import msgspec

from matchset.app.drawing.picture_file import write_picture
from matchset.app.guidance.choice import BallChoice, choose
from matchset.app.target.frame_picker import frame_at
from matchset.app.target.target_options import parse_pick
from matchset.batch.jobs.job import Job
from matchset.batch.jobs.video_options import Options
from matchset.media.video import Video

FRAME = "frame.png"  # format: in the results of a doubtful video, the frame to click in


class DoubtParameters(msgspec.Struct, frozen=True):
    """When it is doubtful what the ball is.

    Parameters
    ----------
    rank : float
        `BallChoice.rank` from which the likeliest circle is followed. Higher asks more often, lower follows other
        things. Chosen on nine real clips with a ball and one without: five are sure and right, four are asked about, of
        which one is wrong, and so is the one without.
    found : float
        Share of the frames in which what was followed must be found; below it that was likely something else.
    """

    rank: float = 0.07
    found: float = 0.3


DOUBT = DoubtParameters()


class Chosen(msgspec.Struct, frozen=True):
    """What is followed.

    Parameters
    ----------
    options : TrackOptions or LocateOptions
        With a target.
    click : str
        Where it was clicked, X,Y@FRAME; empty if it was not chosen here.
    doubt : str
        Why it is doubtful; empty if it is not.
    words : str
        How it was chosen.
    """

    options: Options
    click: str = ""
    doubt: str = ""
    words: str = ""


def chosen_for(job: Job, folder: Path) -> Chosen:
    """Say what is followed; where that is doubtful, write the frame to click in."""
    if not job.auto:
        return Chosen(job.options)
    if job.click:
        return _clicked(job, job.click)
    with Video(job.video, fps=job.options.fps, **job.options.view.arguments) as video:
        choice = choose(video)
    doubt = doubt_of(choice)
    if doubt:
        write_picture(folder / FRAME, choice.frame.image)
    if not choice.candidates:
        return Chosen(job.options, f"0,0@{choice.frame.index}", doubt)
    x, y = choice.candidates[0].pick
    return _clicked(job, f"{x},{y}@{choice.frame.index}", doubt)


def _clicked(job: Job, click: str, doubt: str = "") -> Chosen:
    target = msgspec.structs.replace(job.options.target, picks=[click])
    options: Options = msgspec.structs.replace(job.options, target=target)
    return Chosen(options, click, doubt, f"clicked at {click}: the likeliest ball")


def doubt_of(choice: BallChoice, parameters: DoubtParameters = DOUBT) -> str:
    """Say why it is doubtful what the ball is; empty where it is not."""
    if not choice.candidates:
        return "nothing looks like a ball in the frames that were searched"
    if choice.rank < parameters.rank:
        return f"the likeliest of several things has a rank of {choice.rank:.3f}, sure from {parameters.rank} on"
    return ""


def write_frame(job: Job, click: str, folder: Path) -> None:
    """Write the frame of a click, X,Y@FRAME, for a person to click in."""
    index = parse_pick(click)[2] or 0
    with Video(job.video, fps=job.options.fps, **job.options.view.arguments) as video:
        frame = frame_at(video, index)
    if frame is not None:
        write_picture(folder / FRAME, frame.image)


def doubt_afterwards(frames: int, found: int, parameters: DoubtParameters = DOUBT) -> str:
    """Say why it is doubtful that what was chosen and followed is the ball; empty where it is not."""
    if found < parameters.found * frames:
        return f"what looked like the ball is found in {found} of {frames} frames"
    return ""
