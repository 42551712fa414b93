from collections.abc import Callable

import numpy as np
import pytest
from benchmarks.options import UNSEEN
from benchmarks.tracking.stopwatch import WARM_UP, Contender, time_by_turns
from benchmarks.tracking.trial import sequence

import matchset as ms


def frames(count: int) -> list[ms.Frame]:
    return [ms.Frame(np.zeros((8, 8, 3), np.uint8), float(k), k) for k in range(count)]


def test_contenders_take_turns_and_see_every_frame_in_order() -> None:
    calls: list[tuple[str, int]] = []

    def contender(name: str, offset: int) -> Contender:
        def begin() -> Callable[[ms.Frame], None]:
            return lambda frame: calls.append((name, frame.index))

        return Contender(name=name, frames=frames(10), begin=begin, offset=offset)

    result = time_by_turns([contender("a", 0), contender("b", 5)], 30)
    for name, offset in (("a", 0), ("b", 5)):
        seen = [index for who, index in calls if who == name]
        assert seen == [(k + offset) % 10 for k in range(WARM_UP + 30)]
        assert result[name].places.tolist() == seen[WARM_UP:]
    firsts = [who for who, _ in calls[::2]]
    assert firsts == ["a", "b"] * ((WARM_UP + 30) // 2)


def test_a_contender_begins_anew_with_each_turn_through_its_pool() -> None:
    begun: list[int] = []

    def begin() -> Callable[[ms.Frame], None]:
        begun.append(1)
        return lambda _: None

    time_by_turns([Contender(name="a", frames=frames(10), begin=begin)], 20)
    assert len(begun) == 1 + (WARM_UP + 20) // 10


def test_what_is_not_answered_is_a_miss() -> None:
    def call(frame: ms.Frame) -> object:
        return ms.Lost("gone", frame.time) if frame.index % 2 else []

    result = time_by_turns([Contender(name="a", frames=frames(10), begin=lambda: call)], 10)
    assert result["a"].misses == 10


@pytest.mark.parametrize("seed", UNSEEN)
def test_the_first_click_hits_what_can_be_seen_of_the_ball(seed: int) -> None:
    clip = sequence("hard", seed, 1)
    frame, _ = next(iter(clip))
    x, y = (round(value) for value in clip.first_click)
    blue, _, red = frame.image[y - 1 : y + 2, x - 1 : x + 2].reshape(-1, 3).mean(axis=0)
    assert blue > red + 25
