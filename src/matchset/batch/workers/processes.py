"""Processes of this computer that do the work of a batch: `Processes`."""

import multiprocessing
import os
import time
from collections import deque
from concurrent.futures import FIRST_COMPLETED, Future, ProcessPoolExecutor, wait
from concurrent.futures.process import BrokenProcessPool
from types import TracebackType
from typing import Any, Self

from matchset.batch.jobs.identity import stat_of
from matchset.batch.jobs.job import Job, VideoOutcome
from matchset.batch.jobs.work import UnfitWorkerError, do_job
from matchset.batch.workers.pool import RETRY, Answer, died, vanished
from matchset.batch.workers.worker import THREADS, begin_worker, warm_up


class _Slot:
    """One process, made anew when it dies: so it is known which video it died over."""

    def __init__(self) -> None:
        self.pool = _process()
        self.job: Job | None = None
        self.begun = 0.0

    def give(self, job: Job) -> Future[VideoOutcome]:
        """Begin a job."""
        self.job, self.begun = job, time.monotonic()
        try:
            return self.pool.submit(do_job, job)
        except BrokenProcessPool:  # it died between two videos
            self.renew()
            return self.pool.submit(do_job, job)

    def renew(self) -> None:
        """Make a new process."""
        self.pool.shutdown(wait=False)
        self.pool = _process()

    def end(self) -> None:
        """End the process; what it is at is stopped after its frame."""
        for process in multiprocessing.active_children():
            if self.job is not None and process.pid in self._numbers():
                process.terminate()
        self.pool.shutdown(wait=True, cancel_futures=True)

    def _numbers(self) -> set[int]:
        return set(self.pool._processes or ())  # as `terminate_workers` of Python 3.14 does


class Processes:
    """A pool of processes; see `Pool`.

    Parameters
    ----------
    count : int
        How many.
    shape : str
        What they will follow: its kernels are loaded, or compiled by the first process alone.

    Attributes
    ----------
    notes : list of str
    """

    def __init__(self, count: int, shape: str = "circle") -> None:
        self._shape, self._count, self.notes = shape, count, list[str]()
        self._slots = list[_Slot]()
        self._futures: dict[Future[Any], _Slot] = {}
        self._deaths: dict[str, int] = {}
        self._again: deque[Job] = deque()

    def __enter__(self) -> Self:
        first = _Slot()
        self._slots = [first]
        try:
            first.pool.submit(warm_up, self._shape).result()
        except BrokenProcessPool:
            first.renew()
        self._slots += [_Slot() for _ in range(self._count - 1)]
        return self

    @property
    def free(self) -> int:
        """See `Pool`."""
        return sum(slot.job is None for slot in self._slots) - len(self._again)

    @property
    def running(self) -> dict[str, float]:
        """See `Pool`."""
        return {slot.job.folder: slot.begun for slot in self._slots if slot.job is not None}

    def give(self, job: Job) -> None:
        """See `Pool`."""
        slot = next(slot for slot in self._slots if slot.job is None)
        self._futures[slot.give(job)] = slot

    def answers(self, wait_s: float) -> list[Answer]:
        """See `Pool`."""
        if not self._futures:
            time.sleep(wait_s)
        done, _ = wait(self._futures, wait_s, FIRST_COMPLETED)
        answers = [each for future in done if (each := self._answer(future)) is not None]
        while self._again and any(slot.job is None for slot in self._slots):
            self.give(self._again.popleft())
        return answers

    def _answer(self, future: Future[Any]) -> Answer | None:
        """Take what a process has answered; None if it died, and the job is given once more."""
        slot = self._futures.pop(future)
        job, slot.job = slot.job, None
        assert job is not None
        error = future.exception()
        if isinstance(error, BrokenProcessPool):
            slot.renew()
            self._deaths[job.video] = deaths = self._deaths.get(job.video, 0) + 1
            if deaths >= RETRY.deaths:
                return Answer(job, died(job, deaths))
            self.notes.append(f"a worker died over {job.video}: once more")
            self._again.append(job)
            return None
        self._deaths.pop(job.video, None)
        if isinstance(error, UnfitWorkerError) and stat_of(job.video) == (0, 0):
            return Answer(job, vanished(job))
        return Answer(job, error=error) if isinstance(error, Exception) else Answer(job, future.result())

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        for slot in self._slots:
            slot.end()


def _process() -> ProcessPoolExecutor:
    os.environ.update({name: os.environ.get(name, "1") for name in THREADS})  # for its children
    context = multiprocessing.get_context("spawn")
    return ProcessPoolExecutor(1, mp_context=context, initializer=begin_worker, initargs=(os.getpid(),))
