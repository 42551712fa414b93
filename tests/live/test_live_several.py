"""Several targets before a camera that look alike: each keeps its name; all like one are found; names change."""

import itertools
import math
from collections.abc import Callable

import cv2
import numpy as np
import numpy.typing as npt
import pytest

from followed_pictures import Loop
from matchset.live.targets.followed_targets import FollowedTargets, FollowedTargetsParameters
from matchset.live.targets.messages import Drop, FindAll, Pick, Rename
from matchset.shapes.circle import Circle


class Alike(Loop):
    """Equal balls at places that a function says by the number of moves; the last in front."""

    def __init__(self, places: Callable[[int], list[tuple[float, float]]]) -> None:
        self.places, self.moves = places, 0
        super().__init__(self.draw)

    def draw(self) -> npt.NDArray[np.uint8]:
        image = np.random.default_rng(self.number).normal(90.0, 2.0, (120, 260, 3))
        for x, y in self.places(self.moves):
            center = round(16 * x), round(16 * y)
            cv2.circle(image, center, 14 * 16, (210, 90, 30), cv2.FILLED, cv2.LINE_AA, 4)
        return cv2.GaussianBlur(np.clip(image, 0, 255).astype(np.uint8), (0, 0), 0.7).astype(np.uint8)

    def move(self) -> None:
        self.moves += 1
        self.step()

    def click(self, *balls: int) -> None:
        for ball in balls:
            count = len(self.states)
            self.followed.do(Pick(self.number, *self.places(self.moves)[ball]))
            self.until(lambda: len(self.states) > count and self.states[-1].found and not self.states[-1].pending)  # noqa: B023

    def found(self) -> dict[str, tuple[float, float]]:
        """Where targets are found, by name; never two on one ball."""
        found = {each.name: (each.values["x"][0], each.values["y"][0]) for each in self.states if each.found}
        assert all(math.dist(*pair) > 4.0 for pair in itertools.combinations(found.values(), 2)), found
        return found


def passing(number: int) -> list[tuple[float, float]]:
    """One passes before another one, slowly, in a second; a third lies apart."""
    way = min(number / 60.0, 1.0)
    return [(130.0, 60.0), (40.0 + 180.0 * way, 64.0), (40.0, 100.0)]


@pytest.mark.parametrize("order", [(0, 1), (1, 0)])
def test_one_that_is_hidden_behind_another_says_so_and_comes_out_as_itself(order: tuple[int, int]) -> None:
    loop, reasons, doubts = Alike(lambda number: passing(number)[:2]), set[str](), set[int]()
    loop.click(*order)
    for _ in range(70):
        loop.move()
        loop.found()
        reasons |= {each.reason for each in loop.states if not each.found}
        doubts |= {other for each in loop.states for other in each.alternatives}
    for number, ball in enumerate(order):
        assert loop.found()[f"circle {number + 1}"] == pytest.approx(passing(100)[ball], abs=1.0)
    hidden = {f"hidden behind circle {number}, which looks the same" for number in (1, 2)}
    assert reasons & hidden
    assert doubts
    assert doubts <= {1, 2}
    assert not any(each.alternatives for each in loop.states)
    loop.followed.close()


def test_two_balls_of_one_color_that_cross_again_and_again_keep_their_names() -> None:
    def places(number: int) -> list[tuple[float, float]]:
        way = 80.0 * math.cos(number / 12.0)
        return [(130.0 - way, 52.0), (130.0 + way, 68.0)]

    loop = Alike(places)
    loop.click(0, 1)
    for _ in range(220):
        loop.move()
        found, both = loop.found(), places(loop.moves)
        if math.dist(*both) > 31.0:  # apart from each other
            assert found == {"circle 1": pytest.approx(both[0], abs=1.5), "circle 2": pytest.approx(both[1], abs=1.5)}
    loop.followed.close()


def test_one_alone_has_a_tracker_of_its_own_until_another_one_like_it_is_clicked() -> None:
    loop = Alike(passing)
    loop.click(0)
    assert loop.followed._groups.of(1) is None
    loop.click(2)
    assert loop.followed._groups.of(1) is loop.followed._groups.of(2) is not None
    loop.followed.do(Drop(2))
    assert loop.followed._groups.of(1) is None
    for _ in range(5):
        loop.step()
        assert loop.found() == {"circle 1": pytest.approx(passing(0)[0], abs=1.0)}
    loop.followed.close()


def test_all_like_one_are_found_up_to_the_limit_and_end_when_they_are_gone() -> None:
    def places(number: int) -> list[tuple[float, float]]:
        some = [(30.0 + 40.0 * k, 30.0) for k in range(6)]
        return some if number == 0 else some[:4]

    loop = Alike(places)
    loop.followed = FollowedTargets(loop.kept, loop.notes.append, FollowedTargetsParameters(targets=5))
    loop.click(2)
    with pytest.raises(ValueError, match="no target 7"):
        loop.followed.do(FindAll(7))
    loop.followed.do(FindAll(1))
    loop.until(lambda: len(loop.states) == 5 and all(state.found for state in loop.states))
    assert [state.finds for state in loop.states] == [True] * 5
    assert loop.notes == ["5 targets are enough: no more are looked for until one is gone"]
    for wish in (FindAll(1), Pick(loop.number, *places(0)[5])):
        with pytest.raises(ValueError, match="5 targets are enough: drop one first"):
            loop.followed.do(wish)
    loop.followed.do(Rename(5, "mine"))
    loop.moves = 1
    for _ in range(int(7.0 * 30)):
        loop.step()
    assert {round(x) for x, _ in loop.found().values()} == {30, 70, 110, 150}  # what was left out has room now
    assert "mine" in [state.name for state in loop.states]  # what a person has named stays
    assert len(loop.states) == 4 + ("mine" not in loop.found())
    loop.followed.do(FindAll(1, on=False))
    loop.step()
    assert not any(state.finds for state in loop.states)
    loop.followed.close()


def test_one_that_is_dropped_while_all_like_it_are_looked_for_stays_dropped() -> None:
    loop = Alike(passing)
    loop.click(0)
    loop.followed.do(FindAll(1))
    loop.until(lambda: len(loop.found()) == 3)
    loop.followed.do(Drop(3))
    assert loop.notes == ["no more like circle 3 are looked for, or it would be found again"]
    for _ in range(20):
        loop.step()
    assert [(state.name, state.finds) for state in loop.states] == [("circle 1", False), ("circle 2", False)]
    loop.followed.do(FindAll(1))
    loop.until(lambda: len(loop.found()) == 3)
    loop.followed.close()


def test_what_was_followed_is_found_again_after_a_source_begins_anew() -> None:
    loop = Alike(lambda number: passing(number)[:1] + passing(number)[2:])
    loop.click(0, 1)
    loop.followed.restart()
    loop.number = 0  # its clock, too
    loop.until(lambda: len(loop.found()) == 2)
    loop.until(lambda: not any(state.alternatives for state in loop.states))
    assert loop.followed._groups.of(1) is loop.followed._groups.of(2) is not None
    loop.followed.close()


def test_two_whose_colors_are_said_to_differ_are_never_on_one_ball() -> None:
    loop = Alike(passing)
    loop.click(0, 2)
    loop.followed._groups.clear()  # as if their colors had not been taken for one
    lured = loop.followed.target(2)
    lured.tracker.start(Circle(*passing(0)[0], 14.0))  # it goes over to the other one's ball
    loop.followed.target(1).tracker.start(Circle(*passing(0)[0], 14.0))
    for _ in range(40):
        loop.step()
        found = loop.found()
    balls = passing(0)
    assert found == {"circle 1": pytest.approx(balls[0], abs=1.0), "circle 2": pytest.approx(balls[2], abs=1.0)}
    loop.followed.close()


@pytest.mark.parametrize(
    ("name", "words"),
    [(" ", "empty"), ("a\nb", "in one line"), ("\u202eb", "seen"), ("CIRCLE 2", "'CIRCLE 2' already")],
)
def test_a_name_that_is_none_is_refused(name: str, words: str) -> None:
    loop = Alike(passing)
    loop.click(0, 2)
    with pytest.raises(ValueError, match=words):
        loop.followed.do(Rename(1, name))
    with pytest.raises(ValueError, match="there is no target 9 any more"):
        loop.followed.do(Rename(9, "gone"))
    loop.followed.do(Rename(1, " <b>left</b> & hand "))
    loop.step()
    assert [state.name for state in loop.states] == ["<b>left</b> & hand", "circle 2"]
    loop.followed.do(Rename(1, "circle 3"))
    loop.click(1)
    assert [state.name for state in loop.states] == ["circle 3", "circle 2", "circle 3 (2)"]
    loop.followed.close()
