"""Many flights, each in a process of its own, and how long they will take: `fly_each`.

Imports that take long stand inside the functions, so that `matchset --help` answers at once.
"""

from collections.abc import Callable, Iterable, Iterator, Sequence
from typing import TYPE_CHECKING, TypeVar

import msgspec

if TYPE_CHECKING:
    from matchset.flight.chain.chain_step import ChainStep
    from matchset.flight.chain.flight import ChainFlight
    from matchset.flight.chain.flight_parameters import FlightParameters
    from matchset.flight.chain.score import FlightScore, FlightScorer

Item = TypeVar("Item")
Result = TypeVar("Result")


class WorkParameters(msgspec.Struct, frozen=True, kw_only=True):
    """What a simulated flight costs, to say beforehand how long many will take.

    Parameters
    ----------
    seconds : float
        Processor time for one follower and one second of a flight, s. Chosen by: an hour for 100 flights of 60 s with
        two followers each.
    quick : float
        The same without pictures, s. Chosen by: a minute for 20 flights of 60 s with two followers each.
    """

    seconds: float = 0.3
    quick: float = 0.025


def work_text(flights: "Sequence[FlightParameters]", jobs: int) -> str:
    """Say how long flights will take, so many at once: they are told apart by their vehicles only."""
    from matchset.app.progress import duration_text

    of_one = WorkParameters().quick if flights[0].world.quick else WorkParameters().seconds
    work = sum(each.duration * (each.world.vehicles - 1) for each in flights) * of_one
    at_once = min(jobs, len(flights))
    total = duration_text(work / at_once)
    return f"{len(flights)} flights of {flights[0].duration:g} s, {at_once} at once: about {total} of computing"


def compile_ahead(parameters: "FlightParameters") -> None:
    """Compile what a flight calls, once, before several processes would each compile it, and nobody see it."""
    from matchset.flight.chain.flight import Flight

    Flight(parameters).close()


def fly_once(parameters: "FlightParameters", stopped: Callable[[], bool] | None = None) -> "FlightScore":
    """Fly to the end, or to the first crash, and score the flight.

    Parameters
    ----------
    parameters : FlightParameters
    stopped : callable, optional
        Asked at every step; if it answers True the flight ends there.
    """
    from matchset.flight.chain.flight import Flight

    return fly_scored(Flight(parameters), stopped).score()


def fly_scored(
    flight: "ChainFlight",
    stopped: Callable[[], bool] | None = None,
    watch: "Callable[[ChainStep], object] | None" = None,
) -> "FlightScorer":
    """Fly one that is there already, as `fly_once`, and close it; returns what counted.

    Parameters
    ----------
    flight : ChainFlight
    stopped : callable, optional
        Asked at every step.
    watch : callable, optional
        Told every step.
    """
    from matchset.flight.chain.score import FlightScorer

    scorer = FlightScorer(flight.parameters)
    with flight:
        for chain_step in flight:
            scorer.add(chain_step)
            if watch is not None:
                watch(chain_step)
            if scorer.crashed or (stopped is not None and stopped()):
                break
    return scorer


def fly_each(
    fly: Callable[..., Result], flights: "Sequence[FlightParameters]", jobs: int, stop: Callable[[], bool]
) -> Iterator[tuple[int, Result]]:
    """Fly many flights.

    Parameters
    ----------
    fly : callable
        Flies one; its second argument, which may be left out, is asked at every step whether to end there. Defined at
        the top of a file, so that another process finds it.
    flights : sequence of FlightParameters
    jobs : int
        How many at once, each in a process of its own; 1: in this process, one after the other.
    stop : callable
        Asked now and then; after True no further flight begins and unfinished ones are dropped.

    Yields
    ------
    (int, object)
        Index into `flights` and what `fly` returns, in the order in which they end.
    """
    if jobs > 1:
        yield from in_processes(fly, flights, jobs, stop)
        return
    for number, parameters in enumerate(flights):
        if stop():
            return
        flown = fly(parameters, stop)
        if stop():
            return
        yield number, flown


def in_processes(
    function: Callable[[Item], Result], items: Iterable[Item], jobs: int, asked: Callable[[], bool]
) -> Iterator[tuple[int, Result]]:
    """Apply a function to every item, in several processes, which end when this one does, however it ends.

    Parameters
    ----------
    function : callable
        Defined at the top of a file, so that another process finds it.
    items : iterable
        Its arguments.
    jobs : int
        How many processes.
    asked : callable
        Asked now and then; after True nothing more begins, and what is unfinished is dropped.

    Yields
    ------
    (int, object)
        Index of the item and result, in the order in which they end.
    """
    import multiprocessing
    from concurrent.futures import FIRST_COMPLETED, ProcessPoolExecutor, wait

    poll_time = 0.3  # s, between two looks at `asked`
    context = multiprocessing.get_context("spawn")
    with ProcessPoolExecutor(jobs, mp_context=context, initializer=_begin_process) as pool:
        waiting = {pool.submit(function, item): number for number, item in enumerate(items)}
        try:
            while waiting and not asked():
                done, _ = wait(waiting, timeout=poll_time, return_when=FIRST_COMPLETED)
                for future in done:
                    yield waiting.pop(future), future.result()
        finally:
            for future in waiting:
                future.cancel()
            if waiting:
                for process in list((pool._processes or {}).values()):
                    process.terminate()


def _begin_process() -> None:
    """Work on one thread, leave Ctrl-C to the process that started this one, and end when that one is killed."""
    import multiprocessing
    import os
    import signal
    import threading
    from multiprocessing.connection import wait as wait_for_end

    import cv2

    cv2.setNumThreads(1)
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    parent = multiprocessing.parent_process()
    if parent is not None:
        sentinel = parent.sentinel

        def end_with_parent() -> None:
            wait_for_end([sentinel])
            os._exit(1)

        threading.Thread(target=end_with_parent, daemon=True).start()
