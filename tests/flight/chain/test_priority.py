"""The priority of a loop: raised in the block where the system allows it, the thread's alone, and given back."""

import os
import threading
from collections.abc import Iterator
from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context

import pytest

from matchset.flight.real_time.priority import PriorityParameters, raised_priority

pytestmark = pytest.mark.skipif(not hasattr(os, "sched_setscheduler"), reason="only Linux has these priorities")


def scheduling() -> tuple[int, int]:
    return os.sched_getscheduler(0) & ~os.SCHED_RESET_ON_FORK, os.sched_getparam(0).sched_priority


def make_ordinary() -> None:
    os.sched_setscheduler(0, os.SCHED_OTHER, os.sched_param(0))


@pytest.fixture(autouse=True)
def ordinary() -> Iterator[None]:
    """The tests themselves may run with real-time priority, which the thread has again afterwards."""
    policy, parameters = os.sched_getscheduler(0), os.sched_getparam(0)
    make_ordinary()
    yield
    os.sched_setscheduler(0, policy, parameters)


@pytest.fixture
def allowed() -> None:
    with raised_priority() as raised:
        if not raised:
            pytest.skip("this user may not raise priorities")


@pytest.mark.usefixtures("allowed")
def test_the_thread_alone_is_raised_and_falls_back() -> None:
    before, others = scheduling(), list[tuple[int, int]]()
    with raised_priority(PriorityParameters(level=7)) as raised:
        assert raised
        assert scheduling() == (os.SCHED_RR, 7)
        other = threading.Thread(target=lambda: others.append(scheduling()))
        other.start()
        other.join()
    assert others == [(os.SCHED_OTHER, 0)]
    assert scheduling() == before


def seen_by_another_thread(cores: set[int]) -> list[tuple[int, int]]:
    """Scheduling of a thread that was there before: before, in and after a block; then of one that it begins in it."""
    make_ordinary()
    os.sched_setaffinity(0, cores)
    ready, go, seen, begun = threading.Event(), threading.Event(), list[tuple[int, int]](), list[tuple[int, int]]()

    def look() -> None:
        for _ in range(3):
            seen.append(scheduling())
            younger = threading.Thread(target=lambda: begun.append(scheduling()))
            younger.start()
            younger.join()
            ready.set()
            assert go.wait(10.0)
            go.clear()

    def again() -> None:
        ready.clear()
        go.set()
        assert ready.wait(10.0)

    other = threading.Thread(target=look)
    other.start()
    assert ready.wait(10.0)
    with raised_priority(PriorityParameters(level=7, behind=2)):
        again()
    again()
    go.set()
    other.join()
    return [*seen, begun[1]]


def seen_in_a_process_of_its_own(cores: set[int]) -> list[tuple[int, int]]:
    """The same in a new process, whose threads no other test and no library has touched."""
    with ProcessPoolExecutor(1, get_context("spawn")) as pool:
        return pool.submit(seen_by_another_thread, cores).result()


ORDINARY = (0, 0)  # SCHED_OTHER, which other systems lack


@pytest.mark.usefixtures("allowed")
def test_threads_of_before_come_right_behind() -> None:
    """The one that holds the interpreter's lock must not wait for other programs; what it begins itself may."""
    cores = os.sched_getaffinity(0)
    if len(cores) == 1:
        pytest.skip("this machine has one core")
    assert seen_in_a_process_of_its_own(cores) == [ORDINARY, (os.SCHED_RR, 2), ORDINARY, ORDINARY]


@pytest.mark.usefixtures("allowed")
def test_on_one_core_the_others_stay_ordinary() -> None:
    """Otherwise they could keep it from the kernel's own threads, which carry the bytes of a serial port."""
    core = {min(os.sched_getaffinity(0))}
    assert seen_in_a_process_of_its_own(core) == [ORDINARY] * 4


@pytest.mark.usefixtures("allowed")
def test_a_user_who_may_not_take_a_flag_away_falls_back_too(monkeypatch: pytest.MonkeyPatch) -> None:
    """Without CAP_SYS_NICE, SCHED_RESET_ON_FORK stays set once it is."""
    really = os.sched_setscheduler

    def unless_flag_goes(thread: int, policy: int, parameters: os.sched_param) -> None:
        if os.sched_getscheduler(thread) & ~policy & os.SCHED_RESET_ON_FORK:
            raise PermissionError(1, "Operation not permitted")
        really(thread, policy, parameters)

    with monkeypatch.context() as patched:
        patched.setattr(os, "sched_setscheduler", unless_flag_goes)
        with raised_priority():
            assert scheduling() == (os.SCHED_RR, PriorityParameters().level)
        assert scheduling() == ORDINARY


@pytest.mark.usefixtures("allowed")
def test_blocks_may_be_nested() -> None:
    before = scheduling()
    with raised_priority(PriorityParameters(level=7)):
        with raised_priority(PriorityParameters(level=9)):
            assert scheduling() == (os.SCHED_RR, 9)
        assert scheduling() == (os.SCHED_RR, 7)
    assert scheduling() == before


@pytest.mark.usefixtures("allowed")
def test_a_higher_priority_is_left_as_it_is() -> None:
    os.sched_setscheduler(0, os.SCHED_FIFO, os.sched_param(60))
    with raised_priority() as raised:
        assert raised
        assert scheduling() == (os.SCHED_FIFO, 60)
    assert scheduling() == (os.SCHED_FIFO, 60)


def test_where_it_is_not_allowed_nothing_changes(monkeypatch: pytest.MonkeyPatch) -> None:
    def refuse(*_: object) -> None:
        raise PermissionError(1, "Operation not permitted")

    before = scheduling()
    monkeypatch.setattr(os, "sched_setscheduler", refuse)
    with raised_priority() as raised:
        assert not raised
    assert scheduling() == before


@pytest.mark.parametrize("level", [0, 100])
def test_a_level_is_one_of_linux(level: int) -> None:
    with pytest.raises(ValueError, match=f"level must be 1 ... 99, got {level}"):
        PriorityParameters(level=level)
