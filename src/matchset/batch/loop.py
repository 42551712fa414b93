"""The loop of a batch: jobs to those who are free, answers into the manifest, clicks into jobs: `Batch`."""

from collections import deque
from collections.abc import Iterator

import msgspec

from matchset.app.exit_codes import print_note
from matchset.batch.clicking.clicker import Clicker
from matchset.batch.jobs.job import Job, VideoOutcome
from matchset.batch.jobs.videos import real_name
from matchset.batch.plan import Plan
from matchset.batch.progress import BatchCounts
from matchset.batch.results.manifest import Manifest
from matchset.batch.split.parts import Parts
from matchset.batch.workers.pool import Answer, Pool

LOOK = 0.2  # format: s between two looks at the workers and at the keyboard


class Batch:
    """Does what is planned, step by step.

    Parameters
    ----------
    plan : Plan
    manifest : Manifest
    counts : BatchCounts
    clicker : Clicker
        Who is asked where it is doubtful what the ball is.
    """

    def __init__(self, plan: Plan, manifest: Manifest, counts: BatchCounts, clicker: Clicker) -> None:
        self._plan, self._manifest, self._counts, self._clicker = plan, manifest, counts, clicker
        self._work: Iterator[Job | VideoOutcome] | None = plan.work()
        self._queue: deque[Job] = deque()
        self._parts = Parts(plan.split)

    def step(self, pool: Pool) -> bool:
        """Give jobs and take answers; returns whether there is more to do.

        Raises
        ------
        FullDiskError
            If there is no room for results.
        """
        self._queue += self._clicked()
        while pool.free > 0 and (job := self._next()) is not None:
            pool.give(job)
        for answer in pool.answers(LOOK):
            self._take(answer)
        return bool(pool.running or self._queue or self._work is not None or self._clicker.waits)

    def _next(self) -> Job | None:
        """Return the next job; what needs none is noted on the way."""
        if self._queue:
            return self._queue.popleft()
        while self._work is not None:
            found = next(self._work, None)
            self._counts.earlier = self._plan.earlier
            if found is None:
                self._work = None
            elif isinstance(found, VideoOutcome):
                self._note(found)
            else:
                jobs = self._parts.of(found)
                self._queue += jobs[1:]
                return jobs[0]
        return None

    def _take(self, answer: Answer) -> None:
        if answer.error is not None:
            raise answer.error
        if answer.outcome is None:
            return
        if answer.outcome.state == "stopped":  # by somebody who has stopped its worker alone, or all
            self._queue.append(answer.job)
            return
        if answer.outcome.state == "chosen":
            known = {"click": answer.outcome.click, "length": answer.outcome.length or (0.0, 0.0)}
            self._queue += self._parts.of(msgspec.structs.replace(answer.job, choosing=False, **known))
            return
        if answer.job.stretch is not None:
            ended = self._parts.ended(answer.job, answer.outcome)
            self._queue += [] if ended is None else [ended]
            return
        self._note(answer.outcome)

    def _note(self, outcome: VideoOutcome) -> None:
        self._manifest.append(outcome)
        self._counts.count(outcome)
        if outcome.state == "doubtful":
            self._clicker.ask(outcome)

    def _clicked(self) -> list[Job]:
        """Return the jobs of videos in which somebody has clicked since."""
        jobs, count = list[Job](), 0
        for click in self._clicker.clicks():
            video = real_name(click.video)
            self._plan.choice.add(click.folder, click.pick)
            try:
                jobs += self._parts.of(self._plan.again(video, click.folder))
                count += 1
            except ValueError as error:
                print_note(f"{click.video}: {error}")
        asked = self._counts.states.get("doubtful", 0)
        self._counts.states["doubtful"] = max(asked - count, 0)
        return jobs
