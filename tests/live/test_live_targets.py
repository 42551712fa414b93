"""Drawn outlines become shapes; what is clicked is followed, what is nothing ends in words."""

import math
import threading
import time
from types import SimpleNamespace
from typing import Any

import cv2
import msgspec
import numpy as np
import numpy.typing as npt
import pytest
from benchmarks.clicks.scenes import draw
from hypothesis import given
from hypothesis import strategies as st

from followed_pictures import Loop
from matchset.camera.camera_model import CameraModel
from matchset.image.frame import Frame
from matchset.live.targets.drawn_outline import circle_along, shape_along
from matchset.live.targets.followed_targets import _Trial
from matchset.live.targets.messages import (
    Diameter,
    Drop,
    FieldOfView,
    FindAll,
    Hold,
    Marker,
    Outline,
    Pick,
    Rename,
    Reread,
)
from matchset.live.targets.target import ClickedTarget, is_beside
from matchset.live.vision.kept_frames import KeepingParameters, KeptFrames
from matchset.live.wire.state import TargetState
from matchset.shapes.circle import Circle
from matchset.shapes.rectangle import Rectangle
from matchset.sim.clips.ball_flight_clip import BallFlightClip
from matchset.sim.clips.balloon import Balloon

BLUE, RED = (60, 60, 20), (200, 60, 16)
Image = npt.NDArray[np.uint8]


def arc(x: float, y: float, radius: float, first: float, length: float) -> npt.NDArray[np.float64]:
    angles = first + np.linspace(0.0, length, 24)
    return np.column_stack((x + radius * np.cos(angles), y + radius * np.sin(angles)))


@given(st.floats(0, 300), st.floats(0, 300), st.floats(5, 100), st.floats(0, 6.2), st.floats(1.5, 6.2))
def test_an_arc_gives_its_circle(x: float, y: float, radius: float, first: float, length: float) -> None:
    circle = circle_along(arc(x, y, radius, first, length))
    assert (circle.x, circle.y, circle.radius) == pytest.approx((x, y, radius), abs=1e-5)


@pytest.mark.parametrize(
    ("points", "words"),
    [
        (np.column_stack((np.arange(20.0), np.full(20, 5.0))), "straight"),
        (np.full((8, 2), 7.0), "straight|small"),
        (arc(50, 50, 0.5, 0, 6), "too small"),
    ],
)
def test_what_is_no_arc_is_said(points: npt.NDArray[np.float64], words: str) -> None:
    with pytest.raises(ValueError, match=words):
        circle_along(points)


def test_a_drawn_box_is_a_rectangle_and_a_line_is_nothing() -> None:
    box = np.array([(10, 10), (70, 11), (70, 40), (11, 41), (10, 12)], float)
    shape = shape_along(Rectangle, box)
    assert isinstance(shape, Rectangle)
    assert (shape.x, shape.y) == pytest.approx((40, 25), abs=1.5)
    with pytest.raises(ValueError, match="encloses nothing"):
        shape_along(Rectangle, box * (1.0, 0.0))


def test_a_page_names_no_file_as_a_shape() -> None:
    frame = Frame(scene(), 0.0, 0)
    for shape in ("/etc/passwd", "0,0 4,0 0,3", "circle:affine", "Circle "):
        with pytest.raises(ValueError, match="a shape is circle"):
            ClickedTarget(1, Pick(1, 60, 60, shape), frame)


def scene() -> Image:
    """A blue ball with a red mark, and a red ball."""
    image = np.random.default_rng(0).normal(90.0, 2.0, (120, 260, 3))
    for (x, y, radius), color in ((BLUE, (210, 90, 30)), (RED, (40, 40, 210))):
        cv2.circle(image, (x, y), radius, color, cv2.FILLED, cv2.LINE_AA)
    return cv2.GaussianBlur(np.clip(image, 0, 255).astype(np.uint8), (0, 0), 0.7).astype(np.uint8)


def test_two_balls_a_click_on_one_again_and_a_drop() -> None:
    loop = Loop(scene)
    loop.followed.do(Pick(1, *BLUE[:2]))
    loop.followed.do(Pick(1, *RED[:2]))
    loop.until(lambda: [state.found for state in loop.states] == [True, True])
    loop.followed.do(Pick(loop.number, BLUE[0] + 3, BLUE[1]))
    loop.until(lambda: loop.notes)
    assert loop.notes == ["that is circle 1, which is followed already"]
    loop.followed.do(Drop(1))
    loop.step()
    assert [state.name for state in loop.states] == ["circle 2"]
    with pytest.raises(ValueError, match="no target 1"):
        loop.followed.do(Drop(1))
    loop.followed.close()


def test_a_click_can_be_read_anew() -> None:
    image, (x, y, radius), _ = draw("before a disc", 4)
    loop = Loop(lambda: image)
    loop.followed.do(Pick(1, x + 0.5 * radius, y))
    loop.until(lambda: [state.found for state in loop.states] == [True])
    (state,) = loop.states
    assert [words.split(" at ")[0] for words in state.readings[:2]] == ["ball", "ball around it"]
    assert state.reading == 1
    loop.followed.do(Diameter(state.id, 0.3))
    loop.followed.do(Reread(state.id, 2))
    loop.until(lambda: [(each.found, each.reading) for each in loop.states] == [(True, 2)])
    (again,) = loop.states
    assert (again.id, again.diameter, again.readings) == (state.id, 0.3, state.readings)
    assert again.values["radius"][0] > 2.0 * radius
    loop.followed.close()


def test_what_waits_for_a_target_that_cannot_be_read_anew_is_done_with_what_it_was() -> None:
    loop = Loop(scene)
    loop.followed.do(Pick(1, *BLUE[:2]))
    loop.until(lambda: [state.found for state in loop.states] == [True])
    for wish in (Reread(1, 99), Rename(1, "mine"), Diameter(1, 0.3), FindAll(1), Rename(1, " ")):
        loop.followed.do(wish)
    loop.until(lambda: len(loop.notes) == 2)
    assert "99" in loop.notes[0]
    assert loop.notes[1] == "a target's name must not be empty"
    (state,) = loop.states
    assert (state.found, state.name, state.diameter, state.finds) == (True, "mine", 0.3, True)
    for last in (Reread(1, 99), Drop(1), Rename(1, "late")):
        loop.followed.do(last)
    loop.until(lambda: len(loop.notes) == 4)
    assert loop.notes[3] == "there is no target 1 any more"
    loop.step()
    assert not loop.states
    loop.followed.close()


def test_what_waits_for_a_reading_that_gives_way_to_clicks_is_done() -> None:
    loop, busy = Loop(scene), threading.Event()
    loop.followed.do(Pick(1, *BLUE[:2]))
    loop.until(lambda: [state.found for state in loop.states] == [True])
    loop.followed._maker.order(busy.wait)  # type: ignore[arg-type]
    for wish in (Reread(1, 1), Rename(1, "mine"), Pick(loop.number, *RED[:2]), Pick(loop.number, *RED[:2])):
        loop.followed.do(wish)
    busy.set()
    loop.until(lambda: len(loop.states) == 2 and loop.states[1].found and not loop.states[1].pending)
    assert [state.name for state in loop.states] == ["mine", "circle 3"]
    loop.followed.close()


def test_pages_hear_what_became_of_each_click() -> None:
    loop = Loop(scene)
    for count, place in enumerate(((120.0, 20.0), BLUE[:2], (-1.0, 5.0)), start=1):
        loop.followed.do(Pick(loop.number, *place))
        loop.until(lambda: len(loop.followed.clicks.state.answered) == count)  # noqa: B023
    answered = {each.x: each.words for each in loop.followed.clicks.state.answered}
    assert answered[BLUE[0]] == ""
    assert answered[120.0]
    assert "outside" in answered[-1.0]
    assert loop.notes.count(answered[120.0]) <= 1
    with pytest.raises(ValueError, match="not kept"):
        loop.followed.do(Pick(10_000, 33.0, 44.0))
    assert "not kept" in loop.followed.clicks.state.answered[-1].words
    loop.followed.close()


def test_what_is_on_trial_is_not_lost_but_still_looked_for() -> None:
    loop = Loop(scene)
    loop.followed.do(Pick(1, 120.0, 20.0))
    seen: list[TargetState] = []
    while not loop.followed.clicks.state.answered:
        loop.step()
        seen += loop.states
        time.sleep(0.002)
    assert all(state.pending and not state.found for state in seen)
    loop.followed.close()


def test_clicks_on_nothing_end_and_the_next_one_counts() -> None:
    loop = Loop(scene)
    for k in range(200):
        loop.followed.do(Pick(loop.number, 120.0 + k % 9, 20.0))
        if k % 20 == 0:
            loop.step()
    loop.until(lambda: loop.notes)
    loop.followed.do(Pick(loop.number, *BLUE[:2]))
    loop.until(lambda: loop.states and loop.states[-1].found and len(loop.states) == 1)
    with pytest.raises(ValueError, match="not kept"):
        loop.followed.do(Pick(10_000, *BLUE[:2]))
    loop.followed.close()


def test_a_diameter_a_view_and_an_outline_give_meters() -> None:
    loop = Loop(scene)
    x, y, radius = BLUE
    loop.followed.do(Outline(1, arc(x, y, radius, 0, 5).ravel().tolist()))
    loop.followed.do(Diameter(1, 0.28))
    loop.followed.do(FieldOfView(1.0))
    loop.until(lambda: loop.states and loop.states[0].position)
    focal = 130.0 / math.tan(0.5)
    assert loop.states[0].position["z"][0] == pytest.approx(0.14 * focal / radius, rel=0.03)
    assert set(loop.states[0].position) == {"x", "y", "z", "distance"}
    assert loop.states[0].left_out == "± leaves out errors of the camera and of the diameter"
    with pytest.raises(ValueError, match="marker"):
        loop.followed.do(Marker(1, loop.number, x, y, 0.5))
    plain = loop.states[0].position["z"]
    loop.followed.do(Diameter(1, 0.28, 0.004))
    loop.followed.do(FieldOfView(1.0, 0.02))
    loop.until(lambda: loop.states[0].position and not loop.states[0].left_out)
    assert (loop.states[0].diameter, loop.states[0].diameter_sigma) == (0.28, 0.004)
    share = math.hypot(0.02 / math.sin(1.0), 0.004 / 0.28)
    assert loop.states[0].position["z"][0] == pytest.approx(plain[0], rel=0.01)
    assert loop.states[0].position["z"][1] == pytest.approx(math.hypot(plain[1] or 0.0, share * plain[0]), rel=0.05)
    for wish, words in ((Diameter(1, 0.28, 0.3), "less than the diameter"), (FieldOfView(3.0, 2.0), "focal_sigma")):
        with pytest.raises(ValueError, match=words):
            loop.followed.do(wish)
    loop.step()
    assert loop.states[0].found
    loop.followed.close()


def test_pictures_are_kept_within_a_memory() -> None:
    kept = KeptFrames(KeepingParameters(frames=50, memory=10 * 300))
    for number in range(40):
        kept.add(number, Frame(np.zeros((10, 10, 3), np.uint8), number / 30.0, number))
    assert [frame.index for frame in kept.since(30)] == list(range(30, 40))
    with pytest.raises(ValueError, match="not kept"):
        kept.since(29)


def test_a_picture_in_which_somebody_draws_is_kept_for_longer() -> None:
    kept, frame = KeptFrames(KeepingParameters(frames=5, held=2)), Frame(np.zeros((10, 10, 3), np.uint8), 0.0, 0)
    for number in range(30):
        kept.add(number, msgspec.structs.replace(frame, index=number))
        if number in (2, 4, 10):
            kept.hold(number)
            kept.hold(number)  # once more is no other picture
    assert [each.index for each in kept.since(10)] == [10, 25, 26, 27, 28, 29]
    assert [each.index for each in kept.since(27)] == [27, 28, 29]
    assert kept.since(4)[0].index == 4
    for gone in (2, 20):
        with pytest.raises(ValueError, match="not kept"):
            kept.since(gone)
    with pytest.raises(ValueError, match="not kept"):
        kept.hold(20)


def marked(seed: int, marker: float) -> tuple[Frame, tuple[float, float], float]:
    """A balloon somewhere with a marker of some radius, m, where its middle is, px, and its radius, px."""
    camera, draw = CameraModel.from_fov(320, 240, math.radians(60.0)), np.random.default_rng(seed)
    place = draw.uniform((-0.2, -0.2, 0.6), (0.2, 0.2, 1.4))
    clip = BallFlightClip(
        camera=camera, place=lambda _: place, balloon=Balloon(marker_radius=marker), frames=1, seed=seed
    )
    x, y = camera.project(place[None])[0].tolist()
    return next(iter(clip)), (x, y), camera.fx * 0.14 / float(place[2])


@pytest.mark.parametrize("marker", [0.0, 0.03, 0.045])
@pytest.mark.parametrize("seed", range(3))
def test_a_click_on_the_marker_of_a_ball_offers_the_ball(seed: int, marker: float) -> None:
    frame, (x, y), radius = marked(seed, marker)
    target = ClickedTarget(1, Pick(1, x, y), frame)
    radii = [each.circle[2] for each in target.tracker.color.alternatives]
    if marker:
        target = ClickedTarget(1, Pick(1, x, y, reading=1 + radii.index(max(radii))), frame)
    assert target.update(frame).values["radius"][0] == pytest.approx(radius, rel=0.05)


def test_each_of_many_that_look_alike_can_be_clicked() -> None:
    balls = [(60.0 + 130.0 * (number % 5), 60.0 + 115.0 * (number // 5)) for number in range(20)]
    image = np.random.default_rng(0).normal(90.0, 2.0, (480, 640, 3))
    for x, y in balls:
        cv2.circle(image, (round(x), round(y)), 20, (210, 90, 30), cv2.FILLED, cv2.LINE_AA)
    blurred = cv2.GaussianBlur(np.clip(image, 0, 255).astype(np.uint8), (0, 0), 0.7).astype(np.uint8)
    for number in (0, 4, 7, 12, 15, 19):
        x, y = balls[number]
        state = ClickedTarget(1, Pick(1, x + 4.0, y), Frame(blurred, 0.0, 0)).update(Frame(blurred, 0.0, 0))
        assert (state.values["x"][0], state.values["y"][0]) == pytest.approx((x, y), abs=1.0)


def test_a_click_outside_of_the_picture_is_said_and_nothing_is_followed() -> None:
    loop = Loop(scene)
    for x, y in ((-1.0, 20.0), (260.0, 20.0), (20.0, -0.6), (20.0, 119.6)):
        loop.followed.do(Pick(loop.number, x, y))
        loop.until(lambda: loop.notes)
        assert loop.notes.pop() == f"({x:g}, {y:g}) is outside of the picture of 260 x 120 px"
        assert not loop.states
    loop.followed.close()


def test_a_rim_drawn_for_longer_than_pictures_are_kept_is_followed() -> None:
    loop = Loop(scene)
    x, y, radius = BLUE
    loop.followed.do(Hold(1))
    for _ in range(KeepingParameters().frames + 10):
        loop.step()
    loop.followed.do(Outline(1, arc(x, y, radius, 0, 5).ravel().tolist()))
    loop.until(lambda: loop.states and loop.states[0].found)
    assert loop.states[0].values["radius"][0] == pytest.approx(radius, abs=1.0)
    loop.followed.close()


def test_a_click_that_was_held_for_longer_than_pictures_are_kept_is_followed() -> None:
    loop = Loop(scene)
    loop.followed.do(Hold(1))
    for _ in range(KeepingParameters().frames + 10):
        loop.step()
    loop.followed.do(Pick(1, *BLUE[:2]))
    loop.until(lambda: loop.states and loop.states[0].found)
    assert loop.states[0].values["radius"][0] == pytest.approx(BLUE[2], abs=1.0)
    loop.followed.close()


@pytest.mark.parametrize(
    ("x", "passed", "beside"),
    [(100.0, 0.0, False), (119.0, 0.0, False), (121.0, 0.0, True), (160.0, 0.1, False), (190.0, 0.1, True)],
)
def test_what_is_found_far_from_a_click_is_no_answer_to_it(x: float, passed: float, beside: bool) -> None:
    found: Any = SimpleNamespace(shape=Circle(x, 60.0, 10.0))
    assert is_beside(Pick(1, 100.0, 60.0), found, passed) is beside
    assert not is_beside(Outline(1, [0.0, 0.0, 5.0, 0.0, 5.0, 5.0]), found, passed)


def test_a_click_whose_color_is_found_elsewhere_is_refused() -> None:
    loop = Loop(scene)
    x, y, _ = RED
    loop.followed.do(Pick(1, *BLUE[:2]))
    loop.until(lambda: loop.states and loop.states[0].found)
    now = loop.number / 30.0
    loop.followed._trials[1] = _Trial(Pick(1, float(x), float(y)), now, now)  # as if the other ball had been clicked
    loop.step()
    assert "not where you clicked" in loop.notes[-1]
    assert not loop.states
    loop.followed.close()
