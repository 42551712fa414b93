"""Workers of a scheduler of Dask, on this computer and others: `DaskCluster`."""

import contextlib
import logging
import queue
import time
import urllib.request
from http import HTTPStatus
from types import TracebackType
from typing import Any, Self

import msgspec

from matchset.batch.jobs.identity import code_digest, stat_of, worker_name
from matchset.batch.jobs.job import Job, VideoOutcome
from matchset.batch.jobs.work import UnfitWorkerError, another_program, do_job
from matchset.batch.workers.pool import RETRY, Answer, died, vanished
from matchset.batch.workers.worker import use_one_thread, warm_up
from matchset.image.errors import LinkError
from matchset.numeric.imports import advice


class DaskParameters(msgspec.Struct, frozen=True):
    """How a scheduler is asked.

    Parameters
    ----------
    connect : float
        How long it is waited for, s.
    ahead : float
        Jobs that are given for each thread of a worker. 1: a worker waits for the next one while an answer travels;
        more: more is done twice if a batch is killed.
    look : float
        How often it is looked which workers there are, s.
    first : float
        How long the first worker is waited for, s: a queue of jobs starts workers when it has room. Longer: a forgotten
        worker is said later.
    page : float
        How long Dask's own page is waited for before its address is printed, s.
    warm : float
        How long it is waited for the first worker of each computer to load or compile, s. Less: workers of a slow disk
        compile the same side by side; more: one that hangs holds all up for longer.
    """

    connect: float = 10.0
    ahead: float = 2.0
    look: float = 2.0
    first: float = 60.0
    page: float = 2.0
    warm: float = 300.0


PARAMETERS = DaskParameters()


class _Given(msgspec.Struct, frozen=True):
    """A job that was given: for which workers alone, None if for all, and how many were refused before."""

    job: Job
    workers: set[str] | None
    refused: int


def do_alone(job: Job) -> VideoOutcome:
    """Do a job in a worker of Dask; one with several threads refuses, as `redirect_stdout` is of the whole process."""
    import distributed

    here: Any = distributed.get_worker()
    if here.state.nthreads > 1:
        problem = f"it has {here.state.nthreads} threads, which mix the logs of videos: start it with --nthreads 1"
        raise UnfitWorkerError(worker_name(), problem)
    return do_job(job)


def answers(page: str) -> bool:
    """Whether there is a page: without bokeh, or with --no-dashboard, Dask has none at the address that it tells."""
    try:
        with urllib.request.urlopen(page, timeout=PARAMETERS.page) as answer:
            return bool(answer.status == HTTPStatus.OK)
    except (OSError, ValueError):  # also 404
        return False


class DaskCluster:
    """The workers of a scheduler; see `Pool`. Workers may come and go.

    Parameters
    ----------
    address : str
        Of the scheduler, tcp://HOST:PORT or tls://HOST:PORT.
    shape : str
        What they will follow: its kernels are loaded, or compiled, by one worker of each computer first.

    Attributes
    ----------
    notes : list of str
    dashboard : str
        Address of Dask's own page; empty if there is none.

    Raises
    ------
    ValueError
        If Dask is not installed.
    LinkError
        If no scheduler answers.
    """

    def __init__(self, address: str, shape: str = "circle") -> None:
        try:
            import distributed
        except ImportError:
            raise ValueError(f"--scheduler needs the extra batch: {advice('batch')}") from None
        self._shape, self.notes = shape, list[str]()
        client_of: Any = distributed.Client
        try:
            self._client: Any = client_of(address, timeout=PARAMETERS.connect, set_as_default=False)
        except (OSError, ValueError, TypeError, TimeoutError) as error:  # TypeError: tls without certificates
            raise LinkError(f"no scheduler of Dask answers at {address}: {' '.join(str(error).split())}") from None
        self.address, page = address, str(self._client.dashboard_link)
        self.dashboard = page if answers(page) else ""
        for name in ("distributed", "distributed.client"):  # what a person should know is said here
            for handler in logging.getLogger(name).handlers:
                handler.setLevel(logging.CRITICAL)
        self._lost: Any = distributed.comm.core.CommClosedError
        self._gone = f"the scheduler at {address} went away: start it, and type the same command again"
        self._ended: queue.Queue[Any] = queue.Queue()
        self._jobs: dict[Any, _Given] = {}
        self._begun: dict[str, float] = {}
        self._unfit = dict[str, str]()
        self._asked, self._waiting = set[str](), list[Job]()
        self._fit: dict[str, int] = {}
        self._looked = -PARAMETERS.look

    def __enter__(self) -> Self:
        with contextlib.suppress(TimeoutError):
            self._client.wait_for_workers(1, timeout=PARAMETERS.first)
        self._check()
        if not self._fit:
            raise LinkError(f"the scheduler at {self.address} has no worker: dask worker {self.address}")
        self._warm_up()
        return self

    def _warm_up(self) -> None:
        """Let one worker of each computer load or compile; one that leaves, or takes too long, is not waited for."""
        ended = queue.Queue[Any]()
        given, end = dict[Any, str](), time.monotonic() + PARAMETERS.warm
        for address in self._one_of_each_computer():
            future = self._client.submit(warm_up, self._shape, workers=[address], pure=False)
            given[future] = address
            future.add_done_callback(ended.put)
        waiting = set(given)
        while waiting and time.monotonic() < end:
            with contextlib.suppress(queue.Empty):
                waiting.discard(ended.get(timeout=PARAMETERS.look))
            self._check()
            waiting = {future for future in waiting if given[future] in self._fit}
        for future, address in given.items():
            if future.status == "error":
                self._refuse(UnfitWorkerError(address, f"it cannot begin: {future.exception()}"))
            elif not future.done():
                future.cancel()
        self._check()

    def _ask(self, addresses: list[str]) -> None:
        """Refuse workers with another matchset, or none: they may not even understand what a job is."""
        if not addresses:
            return
        self._asked.update(addresses)
        self._client.run(use_one_thread, workers=addresses, on_error="ignore")
        for address, found in self._client.run(code_digest, workers=addresses, on_error="return").items():
            if not isinstance(found, str):
                self._refuse(UnfitWorkerError(address, f"it has no matchset that fits: {found}"))
            elif found != code_digest():
                self._refuse(UnfitWorkerError(address, another_program(found)))

    @property
    def free(self) -> int:
        """See `Pool`."""
        self._look()
        return int(PARAMETERS.ahead * sum(self._fit.values())) - len(self._jobs) - len(self._waiting)

    @property
    def running(self) -> dict[str, float]:
        """See `Pool`; with those that wait for a worker."""
        return dict(self._begun)

    def give(self, job: Job) -> None:
        """See `Pool`."""
        self._look()
        if not self._fit:
            self._waiting.append(job)
            return
        named = list(self._fit) if self._unfit else None  # a list of thousands costs the scheduler more than the task
        try:
            future = self._client.submit(do_alone, job, workers=named, pure=False)
        except Exception:
            if self._client.status == "running":
                raise
            raise LinkError(self._gone) from None
        self._jobs[future] = _Given(job, None if named is None else set(named), len(self._unfit))
        self._begun.setdefault(job.folder, time.monotonic())
        future.add_done_callback(self._ended.put)

    def answers(self, wait: float) -> list[Answer]:
        """See `Pool`."""
        self._check()
        answers = list[Answer]()
        try:
            future = self._ended.get(timeout=wait)
            while True:
                answer = self._answer(future)
                answers += [answer] if answer is not None else []
                future = self._ended.get_nowait()
        except queue.Empty:
            pass
        except self._lost:
            raise LinkError(self._gone) from None
        waiting, self._waiting = self._waiting, []
        for job in waiting:
            self.give(job)
        return answers

    def _check(self) -> None:
        """Raise LinkError if nobody is left."""
        if self._client.status != "running":
            raise LinkError(self._gone)
        self._look()
        if self._unfit and not self._fit:
            raise LinkError("no worker is fit: " + "; ".join(f"{name}: {why}" for name, why in self._unfit.items()))

    def _answer(self, future: Any) -> Answer | None:
        """Take what a worker has answered; None if the job is given once more."""
        given = self._jobs.pop(future, None)
        if given is None:
            return None
        job = given.job
        if future.status == "cancelled":  # the scheduler is gone: `_check` says so
            self._waiting.append(job)
            return None
        error = future.exception() if future.status == "error" else None
        if isinstance(error, UnfitWorkerError):
            if stat_of(job.video) == (0, 0):
                return Answer(job, vanished(job))
            self._refuse(error)
            self._waiting.append(job)
            return None
        if isinstance(error, Exception) and self._newly_refused(given):  # one of those had it, perhaps
            self._waiting.append(job)
            return None
        self._begun.pop(job.folder, None)
        if type(error).__name__ == "KilledWorker":
            return Answer(job, died(job, RETRY.deaths))
        return Answer(job, error=error) if isinstance(error, Exception) else Answer(job, future.result())

    def _newly_refused(self, given: _Given) -> bool:
        """Whether workers were refused since a job was given; those that have come since are asked now."""
        self._looked = -PARAMETERS.look
        self._look()
        return len(self._unfit) > given.refused

    def _refuse(self, error: UnfitWorkerError) -> None:
        """Give a worker no more work, and say so once."""
        addresses = [address for address, name in self._names().items() if error.worker in (address, name)]
        for address in addresses or [error.worker]:
            if address not in self._unfit:
                self._unfit[address] = error.reason
                self.notes.append(f"the worker {error.worker} is refused: {error.reason}")
        self._looked = -PARAMETERS.look

    def _names(self) -> dict[str, str]:
        """Return the workers' names as they give them, by their addresses."""
        return dict(self._client.run(worker_name, on_error="ignore"))

    def _look(self) -> None:
        """Look which workers there are, ask new ones who they are, and take back what was for those alone that left."""
        now = time.monotonic()
        if now - self._looked < PARAMETERS.look:
            return
        self._looked = now
        try:
            workers = self._client.scheduler_info(n_workers=-1)["workers"]
            self._ask([name for name in workers if name not in self._asked])
        except (OSError, TimeoutError):  # it went away, as `_check` says
            return
        self._fit = {name: each["nthreads"] for name, each in workers.items() if name not in self._unfit}
        for future, given in list(self._jobs.items()):
            if given.workers is not None and given.workers.isdisjoint(self._fit):
                del self._jobs[future]
                future.cancel()
                self._waiting.append(given.job)

    def _one_of_each_computer(self) -> list[str]:
        workers = self._client.scheduler_info(n_workers=-1)["workers"]
        return list({each["host"]: name for name, each in workers.items() if name in self._fit}.values())

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        for future in list(self._jobs):
            future.cancel()
        self._client.close(timeout=PARAMETERS.connect)
