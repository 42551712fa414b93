from pathlib import Path

import numpy as np
import numpy.typing as npt
import pytest
from benchmarks.real.labelling import REMARKS, Label, fit_circle, read_starts, write_labels
from benchmarks.real.streak import fit_streak, still_background

from matchset.app.track.score import read_truth

REAL = Path(__file__).resolve().parents[2] / "benchmarks" / "real"
LABELS = sorted((REAL / "labels" / "fitted").glob("*.csv"))
LEAST_ROWS = 25


def soft_disc(circle: tuple[float, float, float], size: int = 160) -> npt.NDArray[np.uint8]:
    """A green disc on gray, its rim a ramp of 2 px."""
    rows, columns = np.mgrid[:size, :size]
    inside = np.clip((circle[2] - np.hypot(columns - circle[0], rows - circle[1])) / 2.0 + 0.5, 0.0, 1.0)
    image = inside[..., None] * np.array([60.0, 140.0, 50.0]) + (1.0 - inside[..., None]) * 170.0
    return np.asarray(np.round(image), dtype=np.uint8)


@pytest.mark.parametrize("circle", [(80.3, 77.6, 12.4), (80.3, 77.6, 30.7), (71.5, 84.25, 45.1)])
@pytest.mark.parametrize("offset", [(0.0, 0.0, 0.0), (2.0, -1.0, 2.0), (-1.0, 2.0, -2.0)])
def test_the_fit_finds_a_soft_disc(circle: tuple[float, float, float], offset: tuple[float, float, float]) -> None:
    x, y, radius = (float(value) for value in np.add(circle, offset))
    fitted = fit_circle(soft_disc(circle), (x, y, radius))
    assert fitted.circle is not None
    assert np.abs(np.subtract(fitted.circle, circle)).max() < 0.1
    assert fitted.spread < 0.2
    assert fitted.share > 0.9


def test_sectors_that_are_skipped_do_not_count() -> None:
    circle = (80.0, 80.0, 30.0)
    image = soft_disc(circle)
    image[:78, :] = (60, 140, 50)  # the upper half merges with its surroundings
    fitted = fit_circle(image, (81.0, 80.0, 30.0), skip=[(175, 5)])
    assert fitted.circle is not None
    assert np.abs(np.subtract(fitted.circle, circle)).max() < 0.1


def test_a_picture_without_a_rim_is_an_error() -> None:
    with pytest.raises(ValueError, match="no rim"):
        fit_circle(np.full((100, 100, 3), 128, np.uint8), (50.0, 50.0, 20.0))


@pytest.mark.parametrize("sweep", [(0.0, 24.0), (20.0, -8.0), (-40.0, 10.0)])
def test_the_middle_of_a_streak_is_found(sweep: tuple[float, float]) -> None:
    circle = (80.4, 77.7, 20.3)
    shifts = np.linspace(-0.5, 0.5, 61)
    discs = [soft_disc((circle[0] + a * sweep[0], circle[1] + a * sweep[1], circle[2])) for a in shifts]
    image = np.asarray(np.round(np.mean(discs, axis=0)), dtype=np.uint8)
    fitted, length = fit_streak(image, (83.0, 75.0, 22.0))
    assert np.abs(np.subtract(fitted, circle)).max() < 0.2
    assert length == pytest.approx(np.hypot(*sweep), abs=1.5)


def test_a_streak_is_found_before_a_pattern_that_stands_still() -> None:
    circle = (80.4, 77.7, 20.3)
    pattern = np.random.default_rng(1).integers(60, 200, (40, 40, 3)).repeat(4, axis=0).repeat(4, axis=1)
    places = [(circle[0] + a, circle[1]) for a in np.linspace(-10.0, 10.0, 41)]
    cover = np.mean([(170.0 - soft_disc((x, y, circle[2]))[..., :1]) / 110.0 for x, y in places], axis=0)
    image = np.asarray(np.round(pattern * (1.0 - cover) + cover * np.array([40.0, 230.0, 220.0])), dtype=np.uint8)
    background = still_background([image, *[pattern.astype(np.uint8)] * 4])
    fitted, length = fit_streak(image, (83.0, 75.0, 22.0), background)
    assert np.abs(np.subtract(fitted, circle)).max() < 0.2
    assert length == pytest.approx(20.0, abs=1.5)


def test_labels_are_read_as_they_were_written(tmp_path: Path) -> None:
    labels = [Label(3, (10.25, 20.5, 7.0), ""), Label(4, (11.0, 20.0, 7.0), "manual|lowconf"), Label(9, None, "absent")]
    write_labels(tmp_path / "clip.csv", "clip.mp4", labels)
    rows = read_truth(tmp_path / "clip.csv")
    assert [(row.frame, row.circle, row.lowconf) for row in rows] == [
        (3, (10.25, 20.5, 7.0), False),
        (4, (11.0, 20.0, 7.0), True),
        (9, None, False),
    ]


@pytest.mark.parametrize("path", LABELS, ids=lambda path: path.stem)
def test_a_clip_has_enough_labels_and_the_starts_they_came_from(path: Path) -> None:
    rows, starts = read_truth(path), read_starts(REAL / "labels" / "by_hand" / path.name)
    assert len(rows) >= LEAST_ROWS
    assert [row.frame for row in rows] == [start.frame for start in starts]
    assert [row.circle is None for row in rows] == [start.circle is None for start in starts]
    assert [row.lowconf for row in rows] == [start.remark.endswith("lowconf") for start in starts]
    assert {start.remark for start in starts} <= set(REMARKS)


def test_there_are_labels() -> None:
    assert LABELS
