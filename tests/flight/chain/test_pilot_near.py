"""A ball that comes nearer than a vehicle may: the pilot goes back, and lands where it stays."""

import math

import cv2
import numpy as np
import pytest

from matchset.camera.camera_model import CameraModel
from matchset.control.follower import FollowerParameters, RelativeSetpoint
from matchset.control.motion_consistency import MotionConsistencyParameters
from matchset.control.safety import SafetyParameters
from matchset.flight.chain.pilot import Pilot, PilotParameters, PilotStep
from matchset.flight.real_time.rehearsal import RehearsalLink
from matchset.image.color import ColorModel
from matchset.image.frame import Frame
from matchset.localization.ball_target import BALLOON
from matchset.localization.markers.ball_colors import BallColors, pick_marker

MODEL, TARGET = CameraModel.from_fov(320, 240, math.radians(60.0)), BALLOON
BLUE, PURPLE, GRAY = (200, 60, 20), (160, 30, 160), (120, 125, 130)
FPS, FAR = 30.0, 1.5  # 1/s, m


class Approach:
    """A camera before which a ball comes nearer: pictures as in `PilotStep`, the distance of each is given."""

    def __init__(self, distances: list[float]) -> None:
        self.model, self._distances, self._index = MODEL, distances, 0

    def read(self) -> Frame | None:
        """Return the next picture."""
        self._index += 1
        return Frame(painted(self._distances[self._index - 1], self._index), self._index / FPS, self._index)

    def now(self) -> float:
        """Return the time on the clock of the pictures, s."""
        return (self._index + 1) / FPS


def painted(distance: float, number: int) -> np.ndarray:
    """Paint a ball straight ahead, with its marker; each picture has noise of its own."""
    picture = np.full((MODEL.height, MODEL.width, 3), GRAY, np.uint8)
    center = MODEL.width // 2, MODEL.height // 2
    away = distance - TARGET.radius  # of the marker
    ball = MODEL.fx * TARGET.radius / math.sqrt(distance**2 - TARGET.radius**2)
    cv2.circle(picture, center, round(ball), BLUE, -1, cv2.LINE_AA)
    cv2.circle(picture, center, round(0.5 * MODEL.fx * TARGET.marker_diameter / away), PURPLE, -1, cv2.LINE_AA)
    noise = np.random.default_rng(number).integers(-2, 3, picture.shape, np.int16)
    return np.asarray(np.clip(picture + noise, 0, 255), np.uint8)


def flown(distances: list[float]) -> list[PilotStep]:
    """Fly before a ball at these distances, one a picture."""
    first, (x, y) = painted(FAR, 0), (MODEL.width / 2, MODEL.height / 2)
    aside = 0.6 * MODEL.fx * TARGET.radius / FAR
    colors = BallColors(ColorModel.pick(first, x - aside, y), pick_marker(first, x, y))
    place = RelativeSetpoint(height=0.0, heading=FAR)
    deaf = FollowerParameters(motion_consistency=MotionConsistencyParameters(max_evidence=100.0))  # no picture answers
    pilot = Pilot(Approach(distances), RehearsalLink(), colors, PilotParameters(place=place, follower=deaf))
    pilot.arm()
    return [pilot.step() for _ in distances]


def test_a_ball_that_comes_nearer_is_gone_back_from_until_it_has_gone() -> None:
    come = np.linspace(FAR, 0.42, 40).tolist()
    steps = flown([FAR] * 30 + come + [0.42] * 10 + come[::-1] + [FAR] * 20)
    near = [step for step in steps if step.safety.reason == "something is nearer than 0.5 m"]
    assert len(near) >= 10
    assert all(step.safety.phase == "holding" for step in near)
    assert near[-1].command.pitch <= -SafetyParameters().back_off
    assert all(step.command.throttle > 0.0 for step in near)
    assert steps[29].safety.phase == "flying"
    assert not steps[-1].safety.reason.startswith("something")


def test_one_that_fills_the_picture_is_gone_back_from_then_it_lands() -> None:
    come = np.geomspace(FAR, 0.16, 40).tolist()
    steps = flown([FAR] * 30 + come + [0.16] * 120)
    last = max(k for k, step in enumerate(steps) if step.safety.phase in ("flying", "holding"))
    assert steps[last].safety.reason == "something is nearer than 0.5 m"
    assert steps[last].command.pitch <= -SafetyParameters().back_off
    assert steps[-1].safety.phase == "cut"


def test_a_place_that_is_too_near_is_refused() -> None:
    with pytest.raises(ValueError, match=r"goes back from less than 0\.5 m, but its place is 0\.40 m away"):
        PilotParameters(place=RelativeSetpoint(height=0.0, heading=0.4))
