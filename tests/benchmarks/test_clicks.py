"""The bench of clicks: what is drawn has its truth, and what a pick took is counted."""

from pathlib import Path

import numpy as np
import pytest
from benchmarks.clicks.__main__ import save, summary
from benchmarks.clicks.judging import PLACES, clicks_of, judge
from benchmarks.clicks.pictures import Shown, rendered
from benchmarks.clicks.scenes import KINDS, draw


@pytest.mark.parametrize("kind", KINDS)
def test_a_scene_is_the_same_for_a_seed_and_holds_its_ball(kind: str) -> None:
    color, gray = draw(kind, 6), draw(kind, 7)
    assert np.array_equal(color.image, draw(kind, 6).image)
    assert color.image.shape == (480, 640, 3)
    assert gray.image.shape == (480, 640)
    for drawn in (color, gray):
        x, y, radius = drawn.circle
        assert radius < x < 639.0 - radius
        assert radius < y < 479.0 - radius


def test_clicks_are_judged_and_counted(tmp_path: Path) -> None:
    shown = next(iter(rendered([2])))
    assert len(list(clicks_of(shown, 1))) == len(PLACES)
    outcomes = judge(shown, 6)
    assert len(outcomes) == 3
    assert all(each.right and each.offered and not each.refused for each in outcomes)
    flat = Shown("flat", "flat", np.full((40, 60, 3), 90, np.uint8), (30.0, 20.0, 8.0))
    outcomes += judge(flat, 6)
    assert all(each.refused for each in outcomes[3:])
    assert "| before a disc | 3 | 100.0 | 100.0 |" in summary(outcomes)
    save(tmp_path, iter([shown]))
    assert (tmp_path / "truth.csv").read_text(encoding="utf-8").startswith("picture,x,y,r\nbefore_a_disc_2.png,")
