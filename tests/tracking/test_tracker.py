"""What `Tracker.update` promises, on small pictures: its answers, its color, its independence."""

import subprocess
import sys
from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest
from scenes import BLUE, FPS, HEIGHT, WIDTH, Answer, Picture, at, blue, off, run, scene, wall, with_ball

import matchset as ms
from matchset.image.light.color_adaptation import AdaptationParameters
from matchset.sim.clips.clip import Clip
from matchset.tracking.ball.judge import NetworkParameters
from matchset.tracking.constants import TrackerConstants
from matchset.tracking.parameters import TrackerParameters

MOVING = [(60.0 + 4.0 * k, 80.0 + 1.5 * k, 25.0) for k in range(12)]


@pytest.fixture
def tracker() -> ms.Tracker[ms.Circle]:
    return ms.Tracker(ms.Circle, blue())


UNUSED = NetworkParameters(used=False)


def test_a_track_is_what_the_design_says(tracker: ms.Tracker[ms.Circle]) -> None:
    ball = (101.3, 119.6, 30.2)
    track = tracker.update(ms.Frame(scene(ball), 7.25, 3))
    assert isinstance(track, ms.Track)
    assert track
    assert isinstance(track.shape, ms.Circle)
    assert off(track, ball) < 0.3
    assert track.time == 7.25
    assert 0.9 < track.support <= 1.0
    assert track.covariance.shape == (3, 3)
    np.testing.assert_array_equal(track.covariance, track.covariance.T)
    assert (np.linalg.eigvalsh(track.covariance) > 0.0).all()
    assert track.match_set.dtype == np.float64
    assert track.match_set.shape[1:] == (2,)
    assert 50 <= len(track.match_set) <= 64
    away = np.hypot(track.match_set[:, 0] - ball[0], track.match_set[:, 1] - ball[1])
    np.testing.assert_allclose(away, ball[2], atol=1.5)


def test_a_lost_is_false_and_says_why(tracker: ms.Tracker[ms.Circle]) -> None:
    lost = tracker.update(ms.Frame(wall(), 7.25, 3))
    assert isinstance(lost, ms.Lost)
    assert not lost
    assert lost.reason == "nothing of this color and shape is in the picture"
    assert lost.time == 7.25
    assert lost.predicted is None


def test_it_coasts_and_then_gives_up(tracker: ms.Tracker[ms.Circle]) -> None:
    assert all(run(tracker, [scene(ball) for ball in MOVING]))
    answers = run(tracker, [wall(k) for k in range(20)], begin=len(MOVING))
    for answer in answers:
        assert isinstance(answer, ms.Lost)
        assert len(answer.reason.split()) > 3
    predicted = [answer.predicted for answer in answers if isinstance(answer, ms.Lost)]
    first = predicted[0]
    assert first is not None
    x, y, radius = MOVING[-1]
    assert abs(first.x - x - 4.0) + abs(first.y - y - 1.5) + abs(first.radius - radius) < 1.0
    coasting = [circle is not None for circle in predicted]
    assert coasting == sorted(coasting, reverse=True)  # once given up, nothing is predicted any more
    assert 5 <= sum(coasting) <= 15
    xs = [circle.x for circle in predicted if circle is not None]
    assert xs == sorted(xs)
    assert xs[-1] < x + 4.0 * len(xs)  # the velocity fades


def test_it_answers_again_when_the_ball_is_back(tracker: ms.Tracker[ms.Circle]) -> None:
    hidden = [scene(ball) for ball in MOVING] + [wall(k) for k in range(30)]
    back = (250.0, 60.0, 20.0)
    answers = run(tracker, [*hidden, scene(back), scene(back)])
    assert [bool(answer) for answer in answers] == [True] * 12 + [False] * 30 + [True] * 2
    assert off(answers[-1], back) < 0.5


TWO = (70.0, 120.0, 30.0), (240.0, 120.0, 30.0)


@pytest.mark.parametrize("ball", TWO)
def test_a_start_point_prefers_its_ball(ball: tuple[float, float, float]) -> None:
    tracker = ms.Tracker(ms.Circle, blue(), start=(ball[0] + 12.0, ball[1] - 9.0))
    assert all(off(answer, ball) < 0.5 for answer in run(tracker, [scene(*TWO)] * 3))


@pytest.mark.parametrize("ball", TWO)
def test_it_begins_at_a_given_shape(tracker: ms.Tracker[ms.Circle], ball: tuple[float, float, float]) -> None:
    tracker.start(ms.Circle(ball[0] + 3.0, ball[1] - 2.0, ball[2] + 2.0))
    assert all(off(answer, ball) < 0.5 for answer in run(tracker, [scene(*TWO)] * 3))


def test_it_can_be_sent_to_another_shape_on_the_way(tracker: ms.Tracker[ms.Circle]) -> None:
    for begin, ball in enumerate(TWO):
        tracker.start(ms.Circle(*ball))
        assert all(off(answer, ball) < 0.5 for answer in run(tracker, [scene(*TWO)] * 3, 3 * begin))


@pytest.mark.parametrize(
    "border", [(-3.0, 110.0), (WIDTH + 2.0, 130.0), (150.0, -2.0), (170.0, HEIGHT + 3.0), (8.0, 10.0)]
)
def test_a_ball_is_followed_half_out_of_the_picture(
    tracker: ms.Tracker[ms.Circle], border: tuple[float, float]
) -> None:
    way = np.linspace(0.0, 1.0, 25)[:, np.newaxis]
    centers = (1.0 - way) * (160.0, 120.0) + way * border
    balls = [(float(x), float(y), 40.0) for x, y in centers]
    answers = run(tracker, [scene(ball, seed=k) for k, ball in enumerate(balls)])
    assert max(off(answer, ball) for answer, ball in zip(answers, balls, strict=True)) < 1.0


def test_gray_pictures() -> None:
    def gray(ball: tuple[float, float, float], seed: int) -> Picture:
        return with_ball(wall(seed, (HEIGHT, WIDTH)), *ball, color=60)

    color = ms.ColorModel.learn(gray(MOVING[0], 99), (45, 65, 30, 30))
    tracker = ms.Tracker(ms.Circle, color)
    answers = run(tracker, [gray(ball, k) for k, ball in enumerate(MOVING)])
    assert max(off(answer, ball) for answer, ball in zip(answers, MOVING, strict=True)) < 0.5
    (found,) = ms.detect(at(gray(MOVING[3], 3), 0), ms.Circle, color)
    assert off(found, MOVING[3]) < 0.5


def test_more_points_are_more_exact() -> None:
    errors = []
    for points in (16, 256):
        tracker = ms.Tracker(ms.Circle, blue(), points=points)
        answers = run(tracker, [scene(ball, seed=k) for k, ball in enumerate(MOVING)])
        errors.append(np.mean([off(answer, ball) for answer, ball in zip(answers, MOVING, strict=True)]))
    assert errors[1] < errors[0] < 1.0


VIEWS: dict[str, Callable[[Picture], Picture]] = {
    "upside down": lambda image: image[::-1],
    "every other": lambda image: np.repeat(image, 2, axis=1)[:, ::2],
    "columns first": lambda image: np.asfortranarray(image),
    "swapped channels": lambda image: np.ascontiguousarray(image[:, :, ::-1])[:, :, ::-1],
    "part of a larger one": lambda image: np.pad(image, ((3, 5), (7, 2), (0, 0)))[3:-5, 7:-2],
}


@pytest.mark.parametrize("name", list(VIEWS))
def test_views_of_a_picture_are_as_good_as_copies(name: str) -> None:
    views = [VIEWS[name](scene(ball)) for ball in MOVING]
    assert not views[0].flags.c_contiguous
    copies = [np.ascontiguousarray(view) for view in views]
    answers = [numbers(run(ms.Tracker(ms.Circle, blue()), images)) for images in (views, copies)]
    assert answers[0] == answers[1]


def test_the_frame_is_never_written_to(tracker: ms.Tracker[ms.Circle]) -> None:
    for index, image in enumerate([wall(), *(scene(ball) for ball in MOVING), wall()]):
        before = image.copy()
        tracker.update(at(image, index))
        ms.detect(at(image, index), ms.Circle, tracker.color)
        np.testing.assert_array_equal(image, before)


def test_a_frame_may_be_read_only(tracker: ms.Tracker[ms.Circle]) -> None:
    images = [scene(ball) for ball in MOVING]
    for image in images:
        image.flags.writeable = False
    assert all(run(tracker, images))


def fading_images() -> Iterator[Picture]:
    """A ball that changes from blue to gray-blue."""
    for k, share in enumerate(np.linspace(0.0, 1.0, 60)):
        color = tuple((1.0 - share) * np.array(BLUE) + share * np.array((150, 90, 60)))
        image = with_ball(np.full((HEIGHT, WIDTH, 3), 140, np.uint8), 160.0, 120.0, 40.0, color)
        noise = np.random.default_rng(k).normal(0.0, 5.0, image.shape)
        yield np.rint(image + noise).clip(0, 255).astype(np.uint8)


def test_the_color_adapts_in_a_copy_of_its_own() -> None:
    color = blue()
    log_odds, table = color.log_odds.copy(), color.table.copy()
    tracker = ms.Tracker(ms.Circle, color)
    assert all(run(tracker, fading_images()))
    np.testing.assert_array_equal(color.log_odds, log_odds)
    np.testing.assert_array_equal(color.table, table)
    assert (tracker.color.log_odds != log_odds).any()
    for limits in (AdaptationParameters(rate=0.0), AdaptationParameters(max_drift=0.0)):
        fixed = ms.Tracker(
            ms.Circle,
            color,
            parameters=TrackerParameters(constants=TrackerConstants(adaptation=limits, network=UNUSED)),
        )
        assert not all(run(fixed, fading_images()))
        np.testing.assert_array_equal(fixed.color.log_odds, log_odds)


@pytest.mark.parametrize("stick", [(110, 140, 200), (20, 20, 20)], ids=["skin", "black"])
def test_what_is_in_front_never_becomes_target(tracker: ms.Tracker[ms.Circle], stick: tuple[int, ...]) -> None:
    """A stick of a color that the first picture did not show, across an eighth of the rim."""

    def crossed(seed: int) -> Picture:
        image = scene((150.0, 110.0, 40.0), seed=seed)
        image[:, 143:158] = np.rint(stick + np.random.default_rng(seed).normal(0.0, 4.0, (HEIGHT, 15, 3))).clip(0, 255)
        return image

    assert all(run(tracker, [crossed(k) for k in range(200)]))
    looks = tracker.color.mask(crossed(200)[:60, 143:158]) == 255
    assert looks.mean() < 0.05


def numbers(answers: list[Answer]) -> list[object]:
    """All that the answers hold, to be compared bit for bit."""
    found: list[object] = []
    for answer in answers:
        if isinstance(answer, ms.Track):
            c = answer.shape
            found += [c.x, c.y, c.radius, answer.support, answer.time]
            found += [answer.covariance.tobytes(), answer.match_set.tobytes()]
        else:
            found += [answer.reason, answer.time, answer.predicted]
    return found


def test_two_threads_give_what_one_gives() -> None:
    clips = [
        Clip(seed=seed, frames=40, width=320, height=240, radii=(12.0, 60.0), hidden=((15, 22),), preset="bad")
        for seed in (260, 261)
    ]
    shots = [[frame for frame, _ in clip] for clip in clips]
    clicks = [clip.first_click for clip in clips]

    def follow(k: int) -> list[object]:
        tracker = ms.Tracker(ms.Circle, ms.ColorModel.pick(shots[k][0].image, *clicks[k]), start=clicks[k])
        answers = [tracker.update(frame) for frame in shots[k]]
        return [*numbers(answers), tracker.color.log_odds.tobytes(), tracker.color.table.tobytes()]

    alone = [follow(k) for k in range(2)]
    with ThreadPoolExecutor(max_workers=2) as pool:
        for _ in range(3):
            assert list(pool.map(follow, range(2))) == alone


COMPILED = """
import gc
import sys
import numpy as np
import matchset as ms
kernels = lambda: {f"{each.py_func.__qualname__} {id(each)}": len(each.signatures) for each in gc.get_objects()
                   if type(each).__name__ == "CPUDispatcher" and each.py_func.__module__.startswith("matchset")}
for shape in ((120, 160, 3), (120, 160)):
    rows, columns = np.indices(shape[:2])
    image = np.full(shape, 90, np.uint8)
    empty = image.copy()
    image[np.hypot(columns - 70, rows - 50) < 25] = 160 if len(shape) == 2 else (200, 60, 30)
    tracker = ms.Tracker(ms.Circle, ms.ColorModel.pick(image, 70, 50))
    before = kernels()
    fixed = image.copy()
    fixed.flags.writeable = sys.argv[1] == "writable"
    pictures = (empty, fixed, fixed, empty, fixed, fixed[:, ::-1], empty, fixed)
    answers = [bool(tracker.update(ms.Frame(picture, k / 30, k))) for k, picture in enumerate(pictures)]
    assert answers == [False, True, True, False, True, True, False, True], answers
    assert len(before) > 20
    assert kernels() == before, (shape, set(kernels().items()) - set(before.items()))
"""


@pytest.mark.parametrize("kind", ["writable", "read-only"])
def test_the_constructor_compiles_and_the_loop_never_does(kind: str) -> None:
    command = [sys.executable, "-c", COMPILED, kind]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr


def balls_of_falling_merit() -> Iterator[tuple[float, float, float]]:
    yield 60.0, 60.0, 32.0
    yield 230.0, 70.0, 32.0
    yield 150.0, 185.0, 28.0


def test_detect_finds_all_best_first() -> None:
    whole, striped, bitten = balls_of_falling_merit()
    image = scene(whole, striped, bitten)
    image[62:78, 200:260] = wall()[62:78, 200:260]  # a stripe through the middle
    image[150:185, 150:190] = wall()[150:185, 150:190]  # a bite out of a quarter
    found = ms.detect(at(image, 0), ms.Circle, blue())
    assert [off(track, whole) < 1.0 for track in found] == [True, False, False]
    assert {off(track, striped) < 2.0 for track in found} == {True, False}
    assert {off(track, bitten) < 2.0 for track in found} == {True, False}
    assert all(track.time == 0.0 for track in found)
    (best,) = ms.detect(at(image, 0), ms.Circle, blue(), limit=1)
    assert best.shape == found[0].shape
    assert ms.detect(at(wall(), 0), ms.Circle, blue()) == []


def test_a_ball_of_another_color_is_left_alone() -> None:
    image = with_ball(scene((90.0, 120.0, 30.0)), 230.0, 120.0, 30.0, color=BLUE[::-1])
    assert len(ms.detect(at(image, 0), ms.Circle, blue())) == 1


def test_it_keeps_hold_when_frames_are_dropped(tracker: ms.Tracker[ms.Circle]) -> None:
    kept = [k for k in range(12) if k not in (4, 5, 8)]
    answers = [tracker.update(ms.Frame(scene(MOVING[k]), k / FPS, k)) for k in kept]
    assert max(off(answer, MOVING[k]) for answer, k in zip(answers, kept, strict=True)) < 0.5
