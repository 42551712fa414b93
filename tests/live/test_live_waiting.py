"""Of more wishes than can wait the oldest click is given up: the newest one is what somebody means now."""

from hypothesis import given
from hypothesis import strategies as st

from matchset.live.targets.messages import Drop, Outline, Pick, Wish
from matchset.live.targets.waiting import WaitingWishes

CLICKS = st.builds(Pick, st.integers(0, 99), st.just(1.0), st.just(2.0))
LINES = st.builds(Outline, st.integers(0, 99), st.just([1.0, 2.0, 3.0, 4.0, 5.0, 6.0]))
DROPS = st.builds(Drop, st.integers(0, 99))


def is_click(wish: Wish) -> bool:
    return isinstance(wish, Pick | Outline)


@given(st.lists(CLICKS | LINES | DROPS, max_size=40), st.integers(1, 8))
def test_the_newest_clicks_wait_and_all_else_that_was_kept(wishes: list[Wish], most: int) -> None:
    waiting: WaitingWishes[Wish] = WaitingWishes(most)
    expected: list[Wish] = []  # the obvious way
    for wish in wishes:
        given_up = waiting.put(wish)
        expected.append(wish)
        if len(expected) > most:
            clicks = [at for at, each in enumerate(expected[:-1]) if is_click(each)]
            assert given_up is expected.pop(clicks[0] if clicks else -1)
        else:
            assert given_up is None
    assert len(waiting) == len(expected) <= most
    for each in expected:
        assert waiting.take() is each
    assert waiting.take() is None


def test_who_clicks_last_is_never_left_out() -> None:
    waiting: WaitingWishes[Wish] = WaitingWishes(3)
    for number in range(1000):
        assert waiting.put(Pick(number, 1.0, 2.0)) != Pick(number, 1.0, 2.0)
    assert [waiting.take() for _ in range(3)] == [Pick(number, 1.0, 2.0) for number in (997, 998, 999)]
