"""Which stretches a long video is cut into, and which are still missing: `Parts`."""

import msgspec

from matchset.batch.jobs.job import DONE, Job, Stretch, VideoOutcome
from matchset.batch.options import BatchOptions
from matchset.media.frame_list import StampedVideo


class SplitParameters(msgspec.Struct, frozen=True):
    """How stretches overlap.

    Parameters
    ----------
    overlap : float
        Time that a stretch has in common with the one before, s. More: rows are the same at its end more often, and
        more is done twice. A color forgets within 20 s while the ball is seen, and then the rows must be the same for
        some seconds.
    shortest : float
        A video is cut if it is longer than this share of two stretches. Less: short stretches at the end.
    """

    overlap: float = 30.0
    shortest: float = 0.75


PARAMETERS = SplitParameters()


def check_split(options: BatchOptions) -> None:
    """Refuse what is not there in stretches (ValueError)."""
    if options.worker.split is None:
        return
    if options.worker.split < 2.0 * PARAMETERS.overlap:
        raise ValueError(f"--split must be {2.0 * PARAMETERS.overlap:g} s at least, got {options.worker.split:g}")
    whole = {
        "--smooth": options.several.smooth,
        "--films": options.films,
        "--start": options.start is not None,
        "--end": options.end is not None,
    }
    for option, given in whole.items():
        if given:
            raise ValueError(f"{option} is of whole videos: leave it out with --split")


class _Waiting(msgspec.Struct):
    """A video whose stretches are being worked on."""

    job: Job
    missing: int
    seconds: float = 0.0
    wrong: VideoOutcome | None = None


class Parts:
    """Cuts jobs into stretches, and says when they can be joined.

    Parameters
    ----------
    length : float or None
        Of a stretch, s; None: nothing is cut.
    """

    def __init__(self, length: float | None = None, parameters: SplitParameters = PARAMETERS) -> None:
        self._length, self._parameters = length, parameters
        self._waiting: dict[str, _Waiting] = {}

    def of(self, job: Job) -> list[Job]:
        """Return the jobs of the stretches of a video, or that which chooses what they follow, or its own job."""
        clicked = len(job.options.target.picks or ()) > 1 and not job.options.several.every  # each is one of its own
        duration = 0.0 if self._length is None or clicked else duration_of(job)
        if self._length is None or duration < 2.0 * self._parameters.shortest * self._length:
            return [job]
        if job.auto and not job.click:  # once, the same for all stretches
            return [msgspec.structs.replace(job, choosing=True)]
        count = max(round(duration / self._length), 2)
        stretches = tuple(self._stretch(k, count, duration) for k in range(count))
        self._waiting[job.video] = _Waiting(msgspec.structs.replace(job, parts=stretches), count)
        return [msgspec.structs.replace(job, folder=each.folder_in(job.folder), stretch=each) for each in stretches]

    def _stretch(self, number: int, count: int, duration: float) -> Stretch:
        begin = max(duration * number / count - self._parameters.overlap, 0.0) if number else 0.0
        end = duration * (number + 1) / count if number < count - 1 else float("inf")
        return Stretch(number, begin, end)

    def ended(self, job: Job, outcome: VideoOutcome) -> Job | VideoOutcome | None:
        """Note that a stretch has ended; when none is missing, return the job that joins all, or what went wrong."""
        waiting = self._waiting[job.video]
        waiting.missing -= 1
        waiting.seconds += outcome.seconds
        if outcome.state not in DONE:
            waiting.wrong = outcome
        if waiting.missing:
            return None
        del self._waiting[job.video]
        if waiting.wrong is not None:
            return msgspec.structs.replace(waiting.wrong, folder=waiting.job.folder)
        return msgspec.structs.replace(waiting.job, seconds=round(waiting.seconds, 3))


def duration_of(job: Job) -> float:
    """Return how long a video is by what its file says, s; 0 if that is not known, or it cannot be cut."""
    try:
        with StampedVideo(job.video, fps=job.options.fps, **job.options.view.arguments) as video:
            if video.recording is None or video.length is None or not video.fps:
                return 0.0
            return video.length / video.fps
    except (ValueError, OSError):  # its own job says why
        return 0.0
