"""Many flights, one after the other or in several processes, each scored: `fly_all`."""

import multiprocessing
import signal
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import FIRST_COMPLETED, ProcessPoolExecutor, wait

from matchset.app.flight.flight import Flight, FlightParameters
from matchset.app.flight.score import FlightScore, FlightScorer


def fly_once(parameters: FlightParameters, tell: Callable[[], object] | None = None) -> FlightScore:
    """Fly to the end, or to the first crash.

    Parameters
    ----------
    parameters : FlightParameters
    tell : callable, optional
        Called at every tick; if it answers True the flight ends there.
    """
    scorer = FlightScorer(parameters)
    with Flight(parameters) as flight:
        for chain_step in flight:
            scorer.add(chain_step)
            if scorer.crashed or (tell is not None and tell() is True):
                break
    return scorer.score()


def fly_all(
    flights: Sequence[FlightParameters], jobs: int, stop: Callable[[], bool] | None = None
) -> Iterator[tuple[int, FlightScore]]:
    """Fly many flights.

    Parameters
    ----------
    flights : sequence of FlightParameters
    jobs : int
        How many at once, each in a process of its own; 1: here, one after the other.
    stop : callable, optional
        Asked now and then; after True no further flight begins and unfinished ones are dropped.

    Yields
    ------
    (int, FlightScore)
        Which, and its score, as they end.
    """
    asked = stop or (lambda: False)
    if jobs <= 1:
        for number, parameters in enumerate(flights):
            if asked():
                return
            score = fly_once(parameters, asked)
            if asked():
                return
            yield number, score
        return
    context = multiprocessing.get_context("spawn")
    with ProcessPoolExecutor(jobs, mp_context=context, initializer=_leave_signals) as pool:
        waiting = {pool.submit(fly_once, parameters): number for number, parameters in enumerate(flights)}
        try:
            while waiting and not asked():
                done, _ = wait(waiting, timeout=0.3, return_when=FIRST_COMPLETED)
                for future in done:
                    yield waiting.pop(future), future.result()
        finally:
            for future in waiting:
                future.cancel()
            if waiting:
                for process in list((pool._processes or {}).values()):
                    process.terminate()


def _leave_signals() -> None:
    """Leave Ctrl-C to the process that started this one."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
