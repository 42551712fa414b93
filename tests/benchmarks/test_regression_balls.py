"""Small, equal and far balls of the guard: they are where the truth says, and answers are judged by it."""

import math
from pathlib import Path

import cv2
import numpy as np
import pytest
from benchmarks.regression.balls import equal, flights, small, stills
from benchmarks.regression.balls.pictures import Ball, Camera, background, coded

import matchset as ms
from matchset.flight.chain.flight_parameters import FlightParameters
from matchset.flight.chain.score import FlightScore

GREEN, YELLOW = (40, 130, 40), (40, 220, 230)


def flat(value: int = 60) -> np.ndarray:
    return np.full((120, 160, 3), value, np.uint8)


@pytest.mark.parametrize("exposure", [0.0, 0.5])
def test_a_ball_is_where_the_truth_says(exposure: float) -> None:
    camera = Camera(flat(), np.random.default_rng(0), noise=0.0, exposure=exposure, quality=100)
    image = camera.take(3.0, [Ball(lambda time: (50.3 + 20.0 * (time - 3.0), 40.6), 5.0, (250.0, 250.0, 250.0))])
    weight = image.astype(float).sum(axis=2) - 180.0
    weight[weight < 12.0] = 0.0
    rows, columns = np.mgrid[:120, :160]
    assert (weight * columns).sum() / weight.sum() == pytest.approx(50.3, abs=0.1)
    assert (weight * rows).sum() / weight.sum() == pytest.approx(40.6, abs=0.1)
    assert weight.sum() / (3 * 190.0) == pytest.approx(math.pi * 25.0, rel=0.06)
    wide = (weight.sum(axis=0) > 0.0).sum()
    assert wide == pytest.approx(11.0 + 20.0 * exposure, abs=2.0)


def test_a_ball_outside_changes_nothing_and_one_at_the_border_is_cut() -> None:
    camera = Camera(flat(), np.random.default_rng(0), noise=0.0, quality=100)
    away = camera.take(0.0, [Ball(lambda _: (-30.0, 20.0), 5.0, (250.0, 250.0, 250.0))])
    np.testing.assert_array_equal(away, coded(flat(), 100))
    cut = camera.take(0.0, [Ball(lambda _: (0.0, 20.0), 5.0, (250.0, 250.0, 250.0))])
    assert cut[20, 0].min() > 230


def test_noise_is_as_large_as_it_is_said_and_differs_from_picture_to_picture() -> None:
    camera = Camera(flat(), np.random.default_rng(0), noise=3.0, quality=100)
    first, second = camera.take(0.0, []), camera.take(1.0, [])
    gray = 3.0 * math.hypot(0.114, 0.587, 0.299)  # the coding blurs colors, not what is gray
    assert cv2.cvtColor(first, cv2.COLOR_BGR2GRAY).std() == pytest.approx(gray, rel=0.15)
    assert (first != second).mean() > 0.5


def test_a_background_is_the_same_for_a_seed() -> None:
    one, again = (background(np.random.default_rng(5), 160, 120, (0.5, 0.6, 0.7)) for _ in range(2))
    np.testing.assert_array_equal(one, again)
    assert one.std() > 5.0


def test_scenes_have_each_radius_with_each_speed_and_both_groups_differ() -> None:
    tuned, reported = small.scenes(small.TUNED), small.scenes(small.REPORTED)
    assert len({(each.radius, each.speed) for each in reported}) == len(reported) == 16
    assert not {each.seed for each in tuned} & {each.seed for each in reported}
    assert len({each.name for each in reported}) == 16
    for name in ("size", "motion", "shutter", "beside"):
        values = [getattr(each, name) for each in reported]
        assert len({values.count(value) for value in values}) == 1, name
    quick = [reported[number] for number in small.QUICK]
    assert len({each.beside for each in quick}) == len({each.radius for each in quick}) == 4
    assert len({each.speed for each in quick}) == 4
    assert all(len({getattr(each, name) for each in quick}) == 2 for name in ("motion", "shutter"))


@pytest.mark.parametrize("scene", small.scenes(small.TUNED), ids=lambda scene: scene.name)
def test_a_ball_is_as_fast_as_it_is_said_and_stays_in_the_picture(scene: small.Scene) -> None:
    path = small.path_of(scene, np.random.default_rng(scene.seed))
    places = np.array([path(0.02 * step) for step in range(50 * small.PICTURES)])
    width, height = scene.size
    assert np.all((places > scene.radius) & (places < (width - scene.radius, height - scene.radius)))
    speeds = np.hypot(*np.diff(places, axis=0).T) / (0.02 * scene.radius)
    assert np.quantile(speeds, 0.99) == pytest.approx(scene.speed, rel=0.35)


def test_two_balls_touch_once_and_never_lie_over_each_other() -> None:
    def level(time: float) -> tuple[float, float]:
        return 10.0 + 6.0 * time, 50.0

    second = small.touching(level, 4.0, 30.0)
    distances = [math.dist(level(0.1 * step), second(0.1 * step)) for step in range(600)]
    assert min(distances) == pytest.approx(8.0, abs=0.01)
    assert distances[0] > 200.0


@pytest.mark.parametrize(
    ("away", "radius", "state"),
    [(3.9, 3.0, "1"), (4.1, 3.0, "o"), (15.1, 3.0, "x"), (5.9, 12.0, "1"), (35.0, 12.0, "o"), (36.1, 12.0, "x")],
)
def test_an_answer_on_a_small_ball_is_judged_by_its_center(away: float, radius: float, state: str) -> None:
    assert small.state_of((100.0 + away, 50.0, radius), (100.0, 50.0), radius) == state


def test_a_slow_small_ball_is_followed(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(small, "PICTURES", 6)
    scene = small.scenes(small.TUNED)[0]
    outcome = small.follow(scene)
    assert outcome.states == "111111"
    assert len(outcome.times) == 6
    monkeypatch.setattr(small, "scenes", lambda _: [scene])
    monkeypatch.setattr(small, "QUICK", (0,))
    quick, whole = ({figure.key: figure.value for figure in small.measure(each)} for each in (True, False))
    assert quick[small.SECTION, scene.name, "right, %"] == 100.0
    assert whole[small.SECTION, "all", "wrong"] == 0.0
    assert set(quick) < set(whole)


def test_a_refused_click_has_no_answers(monkeypatch: pytest.MonkeyPatch) -> None:
    def refuse(*_: object) -> ms.ColorModel:
        raise ValueError("click elsewhere")

    monkeypatch.setattr(ms.ColorModel, "pick", refuse)
    monkeypatch.setattr(small, "PICTURES", 3)
    assert small.follow(small.scenes(small.TUNED)[0]) == small.Outcome("...", [])
    assert equal.follow(equal.pictures(2), 1) == "."


def test_labels_are_read_in_pixels_whose_centers_are_whole_numbers() -> None:
    (box,) = stills.boxes_of("0 0.5 0.25 0.1 0.2\n\n", (100, 200, 3))
    assert (box.x, box.y, box.width, box.height) == (99.5, 24.5, 20.0, 20.0)


@pytest.mark.parametrize(
    ("answer", "right"),
    [
        ((50.0, 40.0, 10.0), True),
        ((59.9, 40.0, 10.0), True),
        ((60.1, 40.0, 10.0), False),
        ((50.0, 40.0, 15.9), True),
        ((50.0, 40.0, 16.1), False),
        ((50.0, 40.0, 6.2), False),
    ],
)
def test_an_answer_is_a_labelled_ball_by_place_and_size(answer: tuple[float, float, float], right: bool) -> None:
    assert stills.Box(50.0, 40.0, 20.0, 20.0).holds(answer) is right


def test_the_place_of_a_tiny_ball_is_good_to_a_few_pixels() -> None:
    assert stills.Box(50.0, 40.0, 4.0, 4.0).holds((53.9, 40.0, 2.0))


def test_balls_pictures_and_false_answers_are_counted() -> None:
    two = stills.Still(flat(), [stills.Box(50.0, 40.0, 20.0, 20.0), stills.Box(120.0, 40.0, 20.0, 20.0)])
    one = stills.Still(flat(), [stills.Box(50.0, 40.0, 20.0, 20.0)])
    found = stills.judged([two, one], [[(50.0, 40.0, 10.0), (90.0, 90.0, 10.0)], []])
    assert found == stills.Found(balls=3, found=1, stills=2, seen=1, false=1)
    assert stills.total([found, found]) == stills.Found(6, 2, 4, 2, 2)


def test_a_folder_is_searched_with_the_color_of_its_widest_ball(tmp_path: Path) -> None:
    folder = tmp_path / stills.FOLDER / "a"
    folder.mkdir(parents=True)
    for name, radius, x in (("one", 20, 60), ("two", 30, 200), ("three", 25, 150)):
        image = np.full((240, 320, 3), GREEN, np.uint8)
        cv2.circle(image, (x, 120), radius, YELLOW, -1, cv2.LINE_AA)
        cv2.imwrite(str(folder / f"{name}.jpg"), cv2.GaussianBlur(image, (0, 0), 1.0))
        share = (x + 0.5) / 320, 120.5 / 240, 2 * radius / 320, 2 * radius / 240
        (folder / f"{name}.txt").write_text(f"0 {' '.join(map(str, share))}\n", encoding="utf-8")
    figures = {figure.key[1:]: figure.value for figure in stills.measure(tmp_path)}
    assert figures["a", "balls"] == figures["a", "found"] == figures["all", "pictures with one found"] == 2.0
    assert figures["all", "false"] == 0.0
    assert stills.measure(tmp_path / "none") == []


def test_equal_balls_stay_apart_and_the_blue_one_passes_before_the_clicked_one() -> None:
    times = [number / equal.FPS for number in range(equal.PICTURES)]
    apart = [math.dist(equal.clicked(time)[:2], equal.other(time)[:2]) for time in times]
    before = [math.dist(equal.clicked(time)[:2], equal.passing(time)[:2]) for time in times]
    assert min(apart) > equal.clicked(0.0)[2] + equal.other(0.0)[2]
    assert min(before) < 20.0
    assert min(before[: start + 1][-1] for start in equal.STARTS) > 90.0  # nothing hides it at a click


def test_the_clicked_one_of_equal_balls_is_followed_and_its_twin_is_wrong() -> None:
    seen = equal.pictures(4)
    assert equal.follow(seen, 1) == "111"
    assert equal.state_of(equal.other(0.0), equal.clicked(0.0)) == "x"
    figures = {figure.name: figure.value for figure in equal.figures_of("all", "11x.")}
    assert figures == {"right, %": 50.0, "wrong": 1.0, "lost": 1.0}


def test_the_worst_seed_of_flights_counts_and_those_that_end(monkeypatch: pytest.MonkeyPatch) -> None:
    def score(parameters: FlightParameters) -> FlightScore:
        seed = parameters.world.seed
        spread = ((0.01, 0.02, 0.001 * seed),) if seed < 903 else ()
        return FlightScore(
            seed=seed,
            duration=parameters.duration,
            end=20.0,
            crash="" if spread else "fell",
            landing_reason="",
            in_view=(1.0,),
            found=(1.0,),
            losses=(0,),
            spread=spread,
            settling_time=1.0,
            descent_time=math.inf,
            processing=0.001,
            age=0.05,
        )

    assert len(set(flights.SEEDS)) == 20
    assert {901, 907} < set(flights.SEEDS)
    assert flights.flight(907).duration == 20.0
    assert flights.flight(907).world.seed == 907
    monkeypatch.setattr(flights, "fly_once", score)
    figures = {figure.key[1:]: figure.value for figure in flights.measure((901, 902))}
    assert figures["seed 901", "worst axis, cm"] == pytest.approx(90.1)
    assert figures["all", "worst axis, cm"] == pytest.approx(90.2)
    ended = {figure.key[1:]: figure.value for figure in flights.measure((901, 903))}
    assert math.isnan(ended["all", "worst axis, cm"])
    assert ended["all", "ended early"] == 1.0
