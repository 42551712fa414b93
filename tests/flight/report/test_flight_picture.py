"""The video's pictures: is what was found drawn where it is, in the camera's cell and on the map?"""

import msgspec
import numpy as np
import numpy.typing as npt
import pytest

from chain_flight import Flown, descending, lost, with_step, without_truth
from matchset.app.drawing.annotate import OUTLINE
from matchset.flight.report.colors import as_hex, bgr, vehicle_rgb
from matchset.flight.report.picture import FlightPicture, annotate_step
from matchset.flight.report.top_view import TopView
from matchset.tracking.track import Track


def near(image: npt.NDArray[np.uint8], color: tuple[int, int, int], most: int = 40) -> npt.NDArray[np.intp]:
    """Pixels (x, y) that have about this color."""
    rows, columns = np.nonzero(np.abs(image.astype(int) - color).max(axis=2) < most)
    return np.column_stack((columns, rows))


def test_the_outline_is_drawn_where_it_was_found(flown: Flown) -> None:
    step = flown.chain_steps[5].steps[0]
    assert isinstance(step.ball, Track)
    image = annotate_step(step, 1, flown.setup.cameras[0], 0.14)
    pink = near(image[:400], OUTLINE)
    circle = step.ball.shape
    off = np.hypot(pink[:, 0] - circle.x, pink[:, 1] - circle.y) - circle.radius
    assert len(pink) > 60
    assert np.abs(off).max() < 3.0
    assert step.frame is not None
    assert image is not step.frame.image


def test_a_picture_that_did_not_come_is_dark(flown: Flown) -> None:
    step = flown.chain_steps[-1].steps[0]
    assert step.frame is None
    image = annotate_step(step, 1, flown.setup.cameras[0], 0.14)
    assert image.shape == (480, 640, 3)
    assert np.median(image) == 30.0
    assert image.max() == 255  # the words


def test_doubt_changes_the_color_of_the_bar(flown: Flown) -> None:
    step = flown.chain_steps[5].steps[0]
    bars = [annotate_step(each, 1, flown.setup.cameras[0], 0.14)[470, 1].tolist() for each in (step, lost(step))]
    assert bars[0] == list(OUTLINE)
    assert bars[1] != bars[0]


def test_the_cells_stand_side_by_side(flown: Flown) -> None:
    picture = FlightPicture(flown.setup)
    assert picture.size == (1440, 360)
    whole = picture.draw(flown.chain_steps[0])
    assert whole.shape == (360, 1440, 3)
    assert np.median(whole[:, 960:]) > 240  # the map is paper
    assert np.abs(whole[:300, :480].astype(int) - whole[:300, 480:960]).mean() > 5.0
    assert FlightPicture(flown.setup, widest=1920).size == (1920, 480)


@pytest.mark.parametrize(("vehicles", "size"), [(2, (1280, 480)), (5, (1440, 720)), (10, (1440, 810))])
def test_chains_of_any_length_have_room(flown: Flown, vehicles: int, size: tuple[int, int]) -> None:
    setup, chain_step = flown.setup, flown.chain_steps[0]
    world = msgspec.structs.replace(setup.parameters.world, vehicles=vehicles)
    parameters = msgspec.structs.replace(setup.parameters, world=world)
    cameras, samples = (setup.cameras[0],) * (vehicles - 1), (setup.samples[0],) * (vehicles - 1)
    longer = msgspec.structs.replace(
        chain_step,
        steps=(chain_step.steps[0],) * (vehicles - 1),
        truth_at_exposure=(chain_step.truth_at_exposure * vehicles)[:vehicles],
    )
    picture = FlightPicture(type(setup)(parameters, cameras, samples), widest=1440)
    assert (picture.draw(longer).shape[1], picture.draw(longer).shape[0]) == picture.size == size


def test_the_map_shows_everyone_from_left_to_right(flown: Flown) -> None:
    image = TopView(flown.setup, (640, 480)).draw(flown.chain_steps[0])
    middles = [np.median(near(image, bgr(vehicle_rgb(number)), 20), axis=0) for number in range(3)]
    x = [float(middle[0]) for middle in middles]
    assert x[0] < x[1] < x[2]
    assert x[1] - x[0] == pytest.approx(x[2] - x[1], rel=0.1)  # 1.5 m each
    assert [float(middle[1]) for middle in middles] == pytest.approx([240.0] * 3, abs=90.0)


def test_a_gap_in_the_chain_takes_the_rings_of_those_before_it(flown: Flown) -> None:
    chain_step = flown.chain_steps[5]
    whole = TopView(flown.setup, (640, 480)).draw(chain_step)
    gap = TopView(flown.setup, (640, 480)).draw(with_step(chain_step, 1, descending(lost(chain_step.steps[1]))))
    assert np.abs(whole.astype(int) - gap).sum() > 0
    same = TopView(flown.setup, (640, 480)).draw(with_step(chain_step, 1, descending(chain_step.steps[1])))
    np.testing.assert_array_equal(whole, same)  # the pose is what counts


def test_colors_are_written_as_the_web_does() -> None:
    assert as_hex((213, 94, 0)) == "#d55e00"
    assert vehicle_rgb(0) == vehicle_rgb(6)


def test_the_map_of_a_real_flight_is_that_of_the_poses(flown: Flown) -> None:
    """The last ball stands to the right; each camera is where the chain sees it, about its set place."""
    setup, steps = without_truth(flown)
    picture = FlightPicture(setup)
    for chain_step in steps[:10]:
        whole = picture.draw(chain_step)
    width = setup.cameras[0].width * picture.size[0] // (2 * setup.cameras[0].width) if picture.size[0] < 1000 else 480
    plan = whole[:, 2 * width : 3 * width]
    middle = {number: near(plan, bgr(vehicle_rgb(number)))[:, 0] for number in range(3)}
    assert np.median(middle[0]) < np.median(middle[1]) < np.median(middle[2])
