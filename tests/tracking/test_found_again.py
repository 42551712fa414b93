"""A ball without a clear outline is followed or found again, and nothing else is taken for it: whole films."""

import cv2
import numpy as np
import numpy.typing as npt
import pytest

import matchset as ms

Picture = npt.NDArray[np.uint8]
Places = tuple[tuple[float, float], ...]
Answer = ms.Track[ms.Circle] | ms.Lost[ms.Circle]
GREEN, YELLOW = (70.0, 150.0, 60.0), (40.0, 190.0, 220.0)
BEGIN, RADIUS = (60.0, 90.0), 12.0
FIRST, AGAIN = (80.0, 90.0), (240.0, 100.0)


def coded(image: npt.NDArray[np.float64], quality: int) -> Picture:
    jpeg = cv2.imencode(".jpg", np.clip(image, 0, 255).astype(np.uint8), (cv2.IMWRITE_JPEG_QUALITY, quality))[1]
    return np.asarray(cv2.imdecode(jpeg, cv2.IMREAD_COLOR), np.uint8)


def balls_in_a_room(balls: Places, blur: float = 1.0, seed: int = 0, other: bool = False) -> Picture:
    """Green balls before a gray wall, or in another room, blurred and coded as JPEG."""
    rows, columns = np.indices((180, 320))
    image = np.full((180, 320, 3), (140.0, 140.0, 150.0)) + (columns if other else rows)[:, :, np.newaxis] * 0.3
    for x, y in balls:
        image[np.hypot(columns - x, rows - y) < RADIUS] = GREEN
    noise = np.random.default_rng(seed).normal(0.0, 3.0, image.shape)
    return coded(np.asarray(cv2.GaussianBlur(image, (0, 0), blur) + noise, np.float64), 12)


def dim_ball(ball: tuple[float, float] | None, blur: float = 1.0, seed: int = 0) -> Picture:
    """A dim ball of 9 px before a gray wall, blurred, with noise."""
    rows, columns = np.indices((180, 320))
    image = np.full((180, 320, 3), (150.0, 150.0, 155.0)) + rows[:, :, np.newaxis] * 0.1
    if ball is not None:
        image[np.hypot(columns - ball[0], rows - ball[1]) < 9.0] = (95.0, 110.0, 95.0)
    soft = cv2.GaussianBlur(image, (0, 0), blur) + np.random.default_rng(seed).normal(0.0, 2.0, image.shape)
    return np.asarray(np.clip(soft, 0, 255), np.uint8)


def half_hidden(ball: tuple[float, float] | None, radius: float = 16.0, decoys: Places = ()) -> Picture:
    """A ball whose lower part is hidden in front of leaves, and decoys as large as it; all coded as JPEG."""
    rows, columns = np.indices((180, 320))
    image = np.random.default_rng(5).normal((60.0, 80.0, 50.0), 14.0, (180, 320, 3))
    for x, y in (*decoys, *([ball] if ball else [])):
        image[(np.hypot(columns - x, rows - y) < radius) & (rows < y + 0.4 * radius)] = YELLOW
    return coded(np.asarray(cv2.GaussianBlur(image, (0, 0), 1.6), np.float64), 15)


def place(frame: int) -> tuple[float, float]:
    return BEGIN[0] + 5.0 * frame, BEGIN[1] + 12.0 * float(np.sin(0.3 * frame))


def follow(pictures: list[Picture], begin: tuple[float, float] = BEGIN) -> list[Answer]:
    tracker = ms.Tracker(ms.Circle, ms.ColorModel.pick(pictures[0], *begin), start=begin, fps=30.0)
    return [tracker.update(image) for image in pictures]


def off(answer: Answer, at: tuple[float, float]) -> float:
    return 99.0 if isinstance(answer, ms.Lost) else float(np.hypot(answer.shape.x - at[0], answer.shape.y - at[1]))


def test_a_ball_that_is_all_blur_is_followed() -> None:
    answers = follow([balls_in_a_room((place(k),), 1.0 if k < 4 else 6.0, k) for k in range(24)])
    errors = [off(answer, place(k)) for k, answer in enumerate(answers)]
    assert max(error for error in errors if error < 99.0) < 5.0
    assert errors.count(99.0) <= 6
    assert errors[-1] < 5.0
    covariances = [answer.covariance for answer in answers if isinstance(answer, ms.Track)]
    assert all(np.all(np.linalg.eigvalsh(covariance) > 0.0) for covariance in covariances)


def test_a_dim_ball_that_is_all_blur_is_followed() -> None:
    answers = follow([dim_ball(place(k), 1.0 if k < 4 else min(float(k), 7.0), k) for k in range(24)])
    assert [off(answer, place(k)) for k, answer in enumerate(answers)] == pytest.approx([0.0] * 24, abs=5.0)


def test_a_click_on_a_ball_that_no_edge_confirms_begins() -> None:
    answers = follow([dim_ball(place(k), 7.0, k) for k in range(8)])
    assert [off(answer, place(k)) for k, answer in enumerate(answers)] == pytest.approx([0.0] * 8, abs=2.7)


def test_nothing_is_taken_where_the_ball_has_left() -> None:
    here = [balls_in_a_room((BEGIN,), 1.0, k) for k in range(3)]
    assert not any(follow([*here, *(balls_in_a_room((), 1.0, k) for k in range(10))])[3:])
    dim = [dim_ball(BEGIN, 1.0, k) for k in range(3)]
    assert not any(follow([*dim, *(dim_ball(None, 1.0, k) for k in range(10))])[3:])


def test_a_ball_beside_it_that_has_moved_is_not_taken() -> None:
    rival = (250.0, 40.0)
    here = [balls_in_a_room((BEGIN, rival), 1.0, k) for k in range(3)]
    gone = [balls_in_a_room((rival,), 1.0, k) for k in range(15)]
    moved = [balls_in_a_room(((200.0, 140.0),), 3.5, k) for k in range(3)]
    assert not any(follow([*here, *gone, *moved])[3:])


def films(decoys: Places = (), radius: float = 16.0, away: int = 20) -> list[Answer]:
    """Answers for three frames of a half hidden ball, some without it, and three where it is far from there."""
    first, gone = half_hidden(FIRST, decoys=decoys), half_hidden(None, decoys=decoys)
    return follow([*[first] * 3, *[gone] * away, *[half_hidden(AGAIN, radius, decoys)] * 3], FIRST)


def test_what_was_beside_the_ball_when_it_was_seen_is_not_taken_for_it() -> None:
    assert not any(films(decoys=((250.0, 60.0),))[3:23])


def test_another_size_at_once_is_another_thing() -> None:
    """A ball that was away for longer may come back as large."""
    assert not any(films(radius=28.0, away=2)[3:])
