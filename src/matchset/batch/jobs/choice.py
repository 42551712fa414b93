"""What is followed in one video: what the batch says, or what is most likely the ball (`chosen_for`)."""

from pathlib import Path

import msgspec

from matchset.app.drawing.picture_file import write_picture
from matchset.app.guidance.choice import BallChoice, choose
from matchset.batch.jobs.job import Job
from matchset.batch.jobs.video_options import Options
from matchset.image.circle_score import SCORE
from matchset.media.video import Video

FRAME = "frame.png"  # format: in the results of a doubtful video, the frame to click in


class DoubtParameters(msgspec.Struct, frozen=True):
    """When it is doubtful what the ball is.

    Parameters
    ----------
    score : float
        Score of the likeliest circle from which it is taken. Higher asks more often, lower follows other things.
    other : float
        Share of its score that another circle of the same frame may have. Lower asks more often.
    """

    score: float = SCORE.convincing
    other: float = 0.9


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
    with Video(job.video, fps=job.options.fps, **job.options.view.arguments) as video:
        choice = choose(video)
    doubt = doubt_of(choice)
    if doubt:
        write_picture(folder / FRAME, choice.frame.image)
    if not choice.candidates:
        return Chosen(job.options, f"0,0@{choice.frame.index}", doubt)
    x, y = choice.candidates[0].pick
    click = f"{x},{y}@{choice.frame.index}"
    target = msgspec.structs.replace(job.options.target, picks=[click])
    options: Options = msgspec.structs.replace(job.options, target=target)
    return Chosen(options, click, doubt, f"clicked at {click}: the likeliest ball")


def doubt_of(choice: BallChoice, parameters: DoubtParameters = DOUBT) -> str:
    """Say why it is doubtful what the ball is; empty where it is not."""
    scores = [each.score for each in choice.candidates]
    if not scores:
        return "nothing looks like a ball in the frames that were searched"
    if scores[0] < parameters.score:
        return f"the likeliest ball is not like one: {scores[0]:.2f}, sure from {parameters.score:.2f} on"
    if len(scores) > 1 and max(scores[1:]) > parameters.other * scores[0]:
        return "several things look like the ball"
    return ""
