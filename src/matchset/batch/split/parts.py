"""Which stretches a long video is cut into, and which are still missing: `Parts`."""

import msgspec

from matchset.app.target.target_options import parse_candidate, parse_pick
from matchset.batch.jobs.job import DONE, Job, Stretch, VideoOutcome
from matchset.batch.options import BatchOptions
from matchset.batch.split.joining import frames_needed
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
        """Return the jobs of the stretches of a video, or that which asks what they follow, or its own job."""
        clicked = len(job.options.target.picks or ()) > 1 and not job.options.several.every  # each is one of its own
        if self._length is None or clicked:
            return [job]
        if job.length is None:  # a worker opens it: whatever a file does to a decoder
            return [msgspec.structs.replace(job, choosing=True)]
        (duration, rate), overlap = job.length, self._parameters.overlap
        count = max(round(duration / self._length), 2)
        too_short = duration < 2.0 * self._parameters.shortest * self._length or rate * overlap < frames_needed()
        if too_short or frame_of_click(job) > rate * (duration / count - overlap):
            return [job]
        stretches = tuple(self._stretch(k, count, duration) for k in range(count))
        self._waiting[job.video] = _Waiting(msgspec.structs.replace(job, parts=stretches), count)
        return [msgspec.structs.replace(job, folder=each.folder_in(job.folder), stretch=each) for each in stretches]

    def _stretch(self, number: int, count: int, duration: float) -> Stretch:
        begin = max(duration * number / count - self._parameters.overlap, 0.0) if number else 0.0
        end = duration * (number + 1) / count if number < count - 1 else float("inf")
        return Stretch(number, begin, end)

    def ended(self, job: Job, outcome: VideoOutcome) -> Job | None:
        """Note that a stretch has ended; when none is missing, return the job that joins all."""
        waiting = self._waiting[job.video]
        waiting.missing -= 1
        waiting.seconds += outcome.seconds
        if outcome.state not in DONE:
            waiting.wrong = outcome
        if waiting.missing:
            return None
        del self._waiting[job.video]
        whole = "" if waiting.wrong is None else f"a stretch failed: {waiting.wrong.reason}"
        return msgspec.structs.replace(waiting.job, seconds=round(waiting.seconds, 3), whole=whole)


def frame_of_click(job: Job) -> int:
    """Return the last frame in which somebody has clicked, or a candidate was counted; 0 if none is named."""
    target = job.options.target
    clicks = [job.click] if job.click else target.picks or ()
    frames = [parse_pick(click)[2] for click in clicks]
    if target.candidate is not None:
        frames.append(parse_candidate(target.candidate)[1])
    return max((frame or 0 for frame in frames), default=0)


def length_of(job: Job) -> tuple[float, float]:
    """Return how long a video is by what its file says, s, and its rate; zeros if it is not known, or cannot be cut."""
    try:
        with StampedVideo(job.video, fps=job.options.fps, **job.options.view.arguments) as video:
            if video.recording is None or video.length is None or not video.fps:
                return 0.0, 0.0
            return video.length / video.fps, video.fps
    except (ValueError, OSError):  # its own job says why
        return 0.0, 0.0
