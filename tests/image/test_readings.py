"""What a click may mean, on pictures that mislead: a ball before a larger disc, a pupil, a spot on a ball."""

import math
from pathlib import Path

import pytest
from benchmarks.clicks.judging import FAR, is_same
from benchmarks.clicks.scenes import draw

import matchset as ms
from matchset.image.clicks.reading import Reading, readings_of
from matchset.image.disc_network.click_discs import BallAtClickParameters, WeighedDisc

LIMITS = BallAtClickParameters()


@pytest.mark.parametrize("place", [(-0.5, 0.0), (FAR, -FAR)])
@pytest.mark.parametrize(("kind", "seed"), [("before a disc", 4), ("before a disc", 1), ("pupil", 2), ("pupil", 3)])
def test_the_ball_that_was_clicked_is_taken_and_the_disc_around_it_offered(
    kind: str, seed: int, place: tuple[float, float]
) -> None:
    image, (x, y, radius), _ = draw(kind, seed)
    color = ms.ColorModel.pick(image, x + place[0] * radius, y + place[1] * radius)
    taken, *others = color.alternatives
    assert taken.name == "ball"
    assert color.circle == taken.circle
    assert is_same(taken.circle, (x, y, radius))
    assert taken.log_odds > 0.0
    assert taken.probability > 0.5
    assert [each.log_odds for each in others] == sorted((each.log_odds for each in others), reverse=True)
    around = next(each for each in others if each.name == "ball around it")
    assert around.circle[2] > 1.5 * radius


def test_another_reading_of_a_click_is_learned_on_request(tmp_path: Path) -> None:
    image, ball, spot = draw("spotted", 4)
    assert spot is not None
    color = ms.ColorModel.pick(image, *spot[:2])
    assert is_same(color.alternatives[0].circle, spot)
    number = 1 + [each.name for each in color.alternatives].index("ball around it")
    whole = ms.ColorModel.pick(image, *spot[:2], reading=number)
    assert whole.alternatives == color.alternatives == color.copy().alternatives
    assert whole.circle is not None
    assert is_same(whole.circle, ball)
    with pytest.raises(ValueError, match=r"reading 9 of the click .*: there are \d"):
        ms.ColorModel.pick(image, *spot[:2], reading=9)
    whole.save(tmp_path / "ball.npz")
    assert ms.ColorModel.load(tmp_path / "ball.npz").alternatives == ()


def test_of_another_shape_what_grew_in_color_is_meant() -> None:
    image, (x, y, _), _ = draw("spotted", 4)
    assert [each.name for each in ms.ColorModel.pick(image, x, y, ball=False).alternatives] == ["region"]
    assert ms.ColorModel.pick(image, x, y).alternatives[0].name == "ball"


def test_readings_are_named_by_where_they_are() -> None:
    circles = [(50.0, 50.0, 20.0), (52.0, 50.0, 6.0), (60.0, 50.0, 45.0), (72.0, 50.0, 19.0)]
    discs = [WeighedDisc(circle, 20.0 - k) for k, circle in enumerate(circles)]
    found = readings_of(discs, [0.0] * 4, (50.0, 50.0, 90.0), LIMITS)
    assert [each.name for each in found] == ["ball", "spot on it", "ball around it", "another ball", "region"]
    assert math.isclose(sum(each.probability for each in found), 1.0, abs_tol=1e-6)
    assert str(found[0]) == "ball at (50, 50), r = 20 px, 64 %"
    same = readings_of(discs[:1], [0.9], (51.0, 50.0, 22.0), LIMITS)  # the region is that ball
    assert [each.name for each in same] == ["ball"]
    assert str(same[0]).endswith("99 %")
    assert readings_of([], [], (1.0, 2.0, 3.0), LIMITS)[0] == Reading("region", (1.0, 2.0, 3.0), same[0].log_odds)
