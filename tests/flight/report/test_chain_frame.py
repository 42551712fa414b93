"""One frame for a chain, and what a camera should have seen: against the simulator's truth."""

import math

import msgspec
import numpy as np
import pytest

from chain_flight import Flown
from matchset.flight.report.chain_frame import (
    camera_positions,
    chain_frame_to_room,
    level_ball_frame,
    room_to_chain_frame,
)
from matchset.flight.report.true_circle import true_circle
from matchset.sim.clips.truth import sphere_outline
from matchset.sim.vehicle import VehiclePose
from matchset.sim.world import CAMERA_AHEAD, camera_position, relative_position
from matchset.tracking.track import Track


def sight(yaw: float, place: tuple[float, float, float] = (0.0, 0.0, 0.0)) -> VehiclePose:
    c, s = math.cos(yaw), math.sin(yaw)
    turn = np.array(((c, 0.0, s), (0.0, 1.0, 0.0), (-s, 0.0, c)))
    return VehiclePose(np.array(place), turn, np.array(place) - (0.0, 0.19, 0.0))


@pytest.mark.parametrize("yaw", [0.0, 0.4, -1.3, 3.0])
def test_the_frame_of_the_last_ball_is_that_of_side_height_and_heading(yaw: float) -> None:
    last, me = sight(yaw, (0.3, 0.1, 2.0)), sight(yaw + 0.2, (0.1, -0.1, 0.4))
    side, minus_height, heading = room_to_chain_frame(camera_position(me), last)
    np.testing.assert_allclose((side, -minus_height, heading), relative_position(me, last), atol=1e-12)
    np.testing.assert_allclose(
        chain_frame_to_room(np.array((side, minus_height, heading)), last), camera_position(me), atol=1e-12
    )
    np.testing.assert_allclose(np.linalg.det(level_ball_frame(last)), 1.0)


def test_what_the_chain_sees_is_where_it_is(flown: Flown) -> None:
    off = []
    for chain_step in flown.chain_steps:
        for number, place in enumerate(camera_positions(chain_step.steps)):
            if place is not None:
                off.append(
                    place
                    - room_to_chain_frame(
                        camera_position(chain_step.truth_at_exposure[number]), chain_step.truth_at_exposure[-1]
                    )
                )
    assert len(off) >= 20
    level = np.array(off)[:, [0, 2]]
    assert np.sqrt((level**2).mean()) < 0.06  # m, the first of them over two balls and 3 m


def test_the_truth_circle_is_the_one_that_is_tracked(flown: Flown) -> None:
    errors = []
    for chain_step in flown.chain_steps:
        for number, step in enumerate(chain_step.steps):
            truth = true_circle(
                chain_step.truth_at_exposure[number],
                chain_step.truth_at_exposure[number + 1],
                flown.setup.cameras[number],
                0.14,
            )
            if isinstance(step.ball, Track) and truth is not None:
                found = step.ball.shape
                errors.append((found.x - truth.x, found.y - truth.y, found.radius - truth.radius))
    assert np.abs(np.median(errors, axis=0)).max() < 0.5


def test_without_distortion_it_is_the_circle_of_the_outline(flown: Flown) -> None:
    pinhole = msgspec.structs.replace(flown.setup.cameras[0], distortion=(0.0,) * 5)
    me, other = sight(0.0), sight(0.0, (0.3, 0.2, 1.5))
    circle = true_circle(me, other, pinhole, 0.14)
    assert circle is not None
    exact = sphere_outline(pinhole, other.ball - (0.0, 0.0, CAMERA_AHEAD), 0.14).circle()
    assert (circle.x, circle.y, circle.radius) == pytest.approx((exact.x, exact.y, exact.radius), abs=1e-6)


def test_a_ball_behind_the_camera_has_no_circle(flown: Flown) -> None:
    assert true_circle(sight(0.0), sight(0.0, (0.0, 0.0, -1.0)), flown.setup.cameras[0], 0.14) is None
