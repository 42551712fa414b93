"""All like one before a camera: what is doubtful and left out is told, and a click or a line follows a doubtful one."""

import math
from typing import Any

import numpy as np
import pytest

import matchset as ms
from doubtful_ball import BALLS, FLAT, picture
from followed_pictures import Loop
from matchset.live.targets.followed_targets import FollowedTargets, FollowedTargetsParameters
from matchset.live.targets.messages import Drop, FindAll, Outline, Pick
from matchset.live.wire.state import CrowdState


class Crowd(Loop):
    """The scene, with all like the ball in the middle looked for."""

    def __init__(self, targets: int = 20) -> None:
        self.flat = True
        super().__init__(lambda: picture(self.number, self.flat))
        parameters = FollowedTargetsParameters(trial=0.3, targets=targets)
        self.followed = FollowedTargets(self.kept, self.notes.append, parameters)
        self.followed.do(Pick(self.number, *BALLS[1]))
        self.until(lambda: self.states and self.states[0].found and not self.states[0].pending)
        assert self.followed.crowd is None
        self.followed.do(FindAll(1))
        self.step()

    @property
    def crowd(self) -> CrowdState:
        crowd = self.followed.crowd
        assert crowd is not None
        return crowd

    def answer(self, click: int) -> str | None:
        """What became of a click; None: not known yet."""
        return next((each.words for each in self.followed.clicks.state.answered if each.click == click), None)


def circle(x: float, y: float) -> list[float]:
    """A line around a place."""
    turns = np.linspace(0.0, 2.0 * math.pi, 20)
    return np.column_stack((x + 11.0 * np.cos(turns), y + 9.0 * np.sin(turns))).ravel().tolist()


def test_what_is_doubtful_is_told_from_the_first_picture_on_and_stays() -> None:
    loop = Crowd()
    assert (loop.crowd.followed, loop.crowd.left_out, loop.crowd.most) == (3, 0, 20)
    for _ in range(80):
        loop.step()
        (outline,) = loop.crowd.doubtful
        assert np.reshape(outline, (-1, 2)).mean(axis=0) == pytest.approx(FLAT, abs=2.0)
    loop.flat = False
    loop.step()
    assert loop.crowd.doubtful == []
    loop.followed.do(FindAll(1, on=False))
    loop.step()
    assert loop.followed.crowd is None
    loop.followed.close()


@pytest.mark.parametrize("drawn", [False, True])
def test_a_click_or_a_line_follows_what_is_doubtful(drawn: bool) -> None:
    loop = Crowd()
    wish = Outline(loop.number, circle(*FLAT), click=7) if drawn else Pick(loop.number, FLAT[0] + 3, FLAT[1], click=7)
    loop.followed.do(wish)
    loop.until(lambda: loop.answer(7) is not None)
    assert loop.answer(7) == ""
    loop.until(lambda: loop.states[-1].found)
    assert (loop.crowd.followed, loop.crowd.doubtful) == (4, [])
    born = loop.states[-1]
    assert born.finds
    assert (born.values["x"][0], born.values["y"][0]) == pytest.approx(FLAT, abs=2.0)
    assert loop.followed.target(born.id).is_kept
    loop.followed.do(Drop(born.id))
    loop.step()
    assert loop.followed.crowd is None  # no more like it are looked for
    loop.followed.close()


def test_what_is_not_found_again_is_clicked_as_anything_else_is(monkeypatch: pytest.MonkeyPatch) -> None:
    loop, nowhere = Crowd(), ms.Circle(60.0, 190.0, 12.0)
    seen = ms.Track(nowhere, np.eye(3), 1.0, np.empty((0, 2)), loop.number / 30.0)
    monkeypatch.setattr(ms.MultiTracker, "doubtful", property(lambda _: [seen]))
    monkeypatch.setattr("matchset.app.several.crowd.covered", lambda *_: 1.0)
    loop.step()
    loop.followed.do(Pick(loop.number, nowhere.x, nowhere.y, click=3))
    loop.until(lambda: loop.answer(3) is not None)
    assert loop.answer(3)
    assert len(loop.states) == 3
    loop.followed.do(Pick(loop.number, nowhere.x, nowhere.y, click=4))
    loop.followed.clear()
    assert loop.answer(4) == "the pictures are others now: click again"
    loop.followed.close()


def test_another_shape_and_an_empty_place_are_not_doubtful() -> None:
    loop = Crowd()
    for wish in (Pick(loop.number, *FLAT, shape="rectangle"), Pick(loop.number, 60.0, 190.0)):
        assert not loop.followed._groups.follow_doubtful(wish)
    loop.followed.close()


def test_how_many_are_left_out_is_told() -> None:
    loop = Crowd(targets=2)
    assert (loop.crowd.followed, loop.crowd.left_out, loop.crowd.most) == (2, 1, 2)
    told: list[Any] = []
    for _ in range(5):
        loop.step()
        told.append(loop.crowd.left_out)
    assert told == [1] * 5
    with pytest.raises(ValueError, match="2 targets are enough: drop one first"):
        loop.followed.do(Pick(loop.number, *FLAT))
    loop.followed.close()
