"""A shape whose sides move alone: one that went astray comes back, one that is hidden stays where it was."""

import numpy as np
import numpy.typing as npt
import pytest
from benchmarks.shapes.cases import THIRD, corner_error
from benchmarks.shapes.trial import ShapeTask, follow_shape

import matchset as ms
from kernels import workspace
from matchset.numeric.jit import interpreted
from matchset.sim.rendering.coverage import draw_polygon
from matchset.tracking.motion import correct_motion

Floats = npt.NDArray[np.float64]
Image = npt.NDArray[np.uint8]
BLUE, ROOM, SHELF = (200, 70, 30), (150, 160, 165), (60, 70, 75)
CARD = np.array([(110.0, 90.0), (210.0, 100.0), (205.0, 170.0), (112.0, 165.0)])
RIGHT = [1, 2]


def picture(card: Floats = CARD) -> Image:
    """Draw a blue card before a pale wall that ends in a dark shelf to the right of it."""
    image = np.full((240, 320, 3), ROOM, np.float32)
    image[:, 222:] = SHELF
    draw_polygon(image, [card], BLUE)
    return np.rint(image).astype(np.uint8)


def follower() -> ms.Tracker[ms.Quadrilateral]:
    return ms.Tracker(ms.Quadrilateral, ms.ColorModel.pick(picture(), 150, 130))


@pytest.mark.parametrize("ends", [(12.0, 12.0), (12.0, 0.0), (0.0, 16.0), (-12.0, -12.0), (-14.0, 0.0)])
def test_a_side_on_an_edge_of_the_background_is_moved_back(ends: tuple[float, float]) -> None:
    astray = CARD.copy()
    astray[RIGHT, 0] += ends
    tracker = follower()
    tracker.start(ms.Quadrilateral(astray))
    answers = [tracker.update(ms.Frame(picture(), k / 30.0, k)) for k in range(9)]
    last = answers[-1]
    assert isinstance(last, ms.Track)
    assert corner_error(last.shape.corners, CARD) < 0.5


@pytest.mark.parametrize(("known", "kept"), [(0.01, 1.0), (0.4, 1.0), (0.75, 0.5), (1.0, 0.0), (1.2, 0.0)])
def test_the_velocity_of_what_is_not_seen_stops(known: float, kept: float) -> None:
    work = workspace(32, 5, 5)
    motion = work.motion
    motion.prior_sigma[:5], motion.velocity[:5], motion.time = 0.5, 3.0, 0.0
    work.covariance[:5, :5] = np.eye(5) * known * 0.5**2
    work.state[:5] = motion.last_state[:5] + 3.0 * 0.1  # as predicted
    interpreted(correct_motion)(work, 0.1)
    np.testing.assert_allclose(motion.velocity[:5], [3.0, 3.0, *[3.0 * kept] * 3], atol=1e-12)


def test_a_quadrilateral_with_a_third_hidden_is_not_lost() -> None:
    trial = follow_shape(ShapeTask("quadrilateral", "typical", 210, 30, THIRD))
    assert None not in trial.ours
    assert np.median([each["corners"] for each in trial.ours if each is not None]) <= 1.4


def test_a_dark_thing_beside_a_hidden_side_is_not_more_of_the_target() -> None:
    """A black screen beside a blue card, whose noise has any hue: the side went to the far edge of the screen."""
    trial = follow_shape(ShapeTask("rectangle", "typical", 102, 85, THIRD))
    assert max(each["corners"] for each in trial.ours if each is not None) < 2.0
    assert None not in trial.ours
