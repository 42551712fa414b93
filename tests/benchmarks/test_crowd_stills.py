"""Labelled stills: labels are whole, answers are judged rightly, and drawn discs are found."""

import csv

import cv2
import numpy as np
from benchmarks.crowds.stills.measure import COUNTED, LABELS, Disc, clicked_discs, judged, labelled, matched, measured

import matchset as ms


def discs(*circles: tuple[float, float, float, float]) -> list[Disc]:
    return [Disc(ms.Circle(x, y, r), "red", visible) for x, y, r, visible in circles]


def test_labels_are_whole() -> None:
    found = labelled()
    assert sum(map(len, found.values())) >= 90
    for picture in found.values():
        for disc in picture:
            assert disc.circle.radius > 5.0
            assert 0.0 < disc.visible <= 1.0
        for number, disc in enumerate(picture):
            far = [np.hypot(disc.circle.x - each.circle.x, disc.circle.y - each.circle.y) for each in picture[:number]]
            assert not far or min(far) > 5.0


def test_colloids_are_tracks_without_gaps() -> None:
    with (LABELS.parent / "labels" / "colloids.csv").open(encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    tracks = {name: [row for row in rows if row["identity"] == name] for name in {row["identity"] for row in rows}}
    assert len(tracks) == 5
    for track in tracks.values():
        assert [int(row["frame"]) for row in track] == list(range(36))
        steps = np.diff([(float(row["x"]), float(row["y"])) for row in track], axis=0)
        assert np.hypot(*steps.T).max() < 6.0


def test_answers_are_right_once_and_near_and_alike() -> None:
    there = discs((50.0, 50.0, 20.0, 1.0), (150.0, 50.0, 20.0, 1.0), (250.0, 50.0, 20.0, 0.4))
    answers = [
        ms.Circle(52.0, 50.0, 21.0),
        ms.Circle(50.0, 50.0, 20.0),  # the nearer of two on one disc
        ms.Circle(150.0, 50.0, 27.0),  # too large
        ms.Circle(250.0, 51.0, 20.0),  # on one that does not count
    ]
    assert matched(there, answers) == {1: 0, 3: 2}
    outcome = judged("picture", "red", there, there[0].circle, answers)
    assert outcome.missed == [there[1].circle]
    assert outcome.false == [answers[0], answers[2]]
    assert (outcome.recall, outcome.precision) == (0.5, 1.0 / 3.0)


def test_clicks_are_spread_over_discs_that_count() -> None:
    there = discs(*((20.0 * k, 20.0, 8.0, COUNTED if k % 2 else 0.3) for k in range(20)))
    chosen = clicked_discs(there, 6)
    assert len(chosen) == 6
    assert all(round(circle.x / 20.0) % 2 == 1 for circle in chosen)
    assert len({circle.x for circle in chosen}) == 6


def test_discs_far_apart_are_all_found() -> None:
    image = np.full((200, 320, 3), 200, np.uint8)
    there = discs(*((60.0 + 100.0 * k, 100.0, 20.0, 1.0) for k in range(3)))
    for disc in there:
        center = round(disc.circle.x), round(disc.circle.y)
        cv2.circle(image, center, 20, (30, 40, 200), -1, cv2.LINE_AA)
    outcomes = measured("drawn", image, there, most=2)
    assert [(each.recall, each.precision, each.refused) for each in outcomes] == [(1.0, 1.0, "")] * 2
