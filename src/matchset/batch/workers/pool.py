"""What a batch needs of those who do its work: `Pool`, `Answer`."""

from types import TracebackType
from typing import Protocol, Self

import msgspec

from matchset.batch.jobs.identity import stat_of
from matchset.batch.jobs.job import Job, VideoOutcome
from matchset.batch.jobs.videos import plain_name


class RetryParameters(msgspec.Struct, frozen=True):
    """What is done about workers that die.

    Parameters
    ----------
    deaths : int
        Workers that may die over one video before it counts as failed. More: a machine that is killed by something else
        costs no video; and a video that kills its decoder kills more workers.
    """

    deaths: int = 3


RETRY = RetryParameters()


class Answer(msgspec.Struct, frozen=True):
    """What came of a job: an outcome, or the error that ends the batch.

    Parameters
    ----------
    job : Job
    outcome : VideoOutcome or None
    error : Exception or None
    """

    job: Job
    outcome: VideoOutcome | None = None
    error: Exception | None = None


class Pool(Protocol):
    """Does jobs, several at once.

    Attributes
    ----------
    notes : list of str
        What a person should know, since they were taken last.
    """

    notes: list[str]

    @property
    def free(self) -> int:
        """How many jobs may be given now."""
        ...

    @property
    def running(self) -> dict[str, float]:
        """Folders of the videos that are being worked on, and since when, s on the clock of `time.monotonic`."""
        ...

    def give(self, job: Job) -> None:
        """Give a job."""
        ...

    def answers(self, wait: float) -> list[Answer]:
        """Return what has ended, after so many seconds at most.

        Raises
        ------
        LinkError
            If nobody is left to work.
        """
        ...

    def __enter__(self) -> Self: ...

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None: ...


def vanished(job: Job) -> VideoOutcome:
    """Return what is said of a video that is not there any more."""
    return _failed(job, "no such file any more")


def died(job: Job, deaths: int) -> VideoOutcome:
    """Return what is said of a video over which workers have died."""
    return _failed(job, f"{deaths} workers died over it")


def _failed(job: Job, reason: str) -> VideoOutcome:
    size, modified = stat_of(job.video)
    return VideoOutcome(
        video=plain_name(job.video),
        folder=job.folder,
        settings=job.settings,
        state="failed",
        reason=reason,
        size=size,
        modified=modified,
    )
