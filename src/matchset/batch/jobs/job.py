"""What a worker is told of one video, and what it answers: `Job`, `VideoOutcome`."""

from typing import Literal

import msgspec

from matchset.batch.jobs.video_options import Options

State = Literal["found", "not found", "doubtful", "failed", "stopped", "chosen"]
"""What became of a video: a ball in it was found; none was; it is doubtful what the ball is; it could not be read, or
another error; the batch was stopped meanwhile; what its stretches are to follow was chosen."""
DONE: tuple[State, ...] = "found", "not found"


class Stretch(msgspec.Struct, frozen=True):
    """A part of a long video.

    Parameters
    ----------
    number : int
        From 0.
    begin, end : float
        From when to when it is read, s since the first frame; those beside it overlap it.
    """

    number: int
    begin: float
    end: float

    def folder_in(self, folder: str) -> str:
        """Return the folder of its results, by that of the whole video's."""
        return f"{folder}.{self.number:04d}"


class Job(msgspec.Struct, frozen=True, kw_only=True):
    """What a worker does with one video; nothing but names travels.

    Parameters
    ----------
    video : str
        Its whole name.
    folder : str
        Of its results, from `out` on.
    out : str
        Folder of all results, or its URL.
    options : TrackOptions or LocateOptions
        What the command is told; without a target where `auto` is given.
    auto : bool
        Whether the worker chooses what is most likely the ball.
    choosing : bool
        Whether it does nothing else, and says how long the video is: what comes of it is for all its stretches.
    click : str
        What was chosen so, X,Y@FRAME.
    settings : str
        Check sum of what decides about the answers, see `settings_digest`.
    code : str
        Check sum of this program: a worker with another one refuses.
    mark : str
        What a file in `out` must hold: a worker that does not see it does not share the folder.
    size : int
        Of the video as the batch sees it, bytes: where a worker sees none it does not share that disk.
    stretch : Stretch or None
        Which part of a long video.
    parts : tuple of Stretch
        The stretches that are to be joined; none: it is done in one.
    whole : str
        Why its stretches are not joined, and it is followed whole; empty if they are.
    length : tuple of two floats, or None
        How long it is, s, and its frames per second, if that is known; a job that is `choosing` asks for it.
    seconds : float
        What its stretches have taken, s.
    """

    video: str
    folder: str
    out: str
    options: Options
    settings: str
    code: str = ""
    mark: str = ""
    auto: bool = False
    choosing: bool = False
    click: str = ""
    size: int = 0
    stretch: Stretch | None = None
    parts: tuple[Stretch, ...] = ()
    whole: str = ""
    length: tuple[float, float] | None = None
    seconds: float = 0.0


class VideoOutcome(msgspec.Struct, frozen=True, kw_only=True):
    """What became of one video: a line of the manifest, and `run.json` in the folder of its results.

    Parameters
    ----------
    video, folder, settings : str
        Those of the job; the name of the video by `plain_name`.
    state : str
    reason : str
        Why it failed, or is doubtful; how it was chosen.
    frames, found : int
        How many frames it has, and in how many a ball was found.
    seconds : float
        How long it took, s.
    worker : str
        Who did it.
    size, modified : int
        Of the video, bytes and ns.
    content : str
        Its check sum (CRC-32).
    table : str
        Check sum of its table (CRC-32): one that has another is not what was noted.
    click : str
        Where it was clicked by `--auto`, X,Y@FRAME.
    length : tuple of two floats
        Of one that was chosen: how long it is, s, and its frames per second; (0, 0) if that is not known.
    """

    video: str
    folder: str
    settings: str
    state: State
    reason: str = ""
    frames: int = 0
    found: int = 0
    seconds: float = 0.0
    worker: str = ""
    size: int = 0
    modified: int = 0
    content: str = ""
    table: str = ""
    click: str = ""
    length: tuple[float, float] | msgspec.UnsetType = msgspec.UNSET

    @property
    def share(self) -> float:
        """In which share of the frames a ball was found."""
        return self.found / self.frames if self.frames else 0.0
