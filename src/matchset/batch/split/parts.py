"""Which stretches of a long video are still missing: `Parts`."""

from matchset.batch.jobs.job import Job, Outcome


class Parts:
    """Cuts jobs into stretches, and says when they can be joined."""

    def of(self, job: Job) -> list[Job]:
        """Return the jobs of the stretches of a video, or its own job."""
        return [job]

    def ended(self, job: Job, outcome: Outcome) -> Job | None:
        """Note that a stretch has ended; returns the job that joins all, when none is missing."""
        raise NotImplementedError
