"""Something that was clicked and is followed since: `ClickedTarget`."""

import copy
import math
from typing import Any

import cv2
import msgspec
import numpy as np
import numpy.typing as npt

from matchset.app.target.shape_option import NAMES, parse_shape
from matchset.camera.camera_model import CameraModel
from matchset.image.color import ColorModel
from matchset.image.frame import Frame
from matchset.live.targets.drawn_outline import drawn_shape
from matchset.live.targets.messages import Begin, Outline, Pick
from matchset.live.targets.target_facts import TargetFacts, found_state, lost_state
from matchset.live.targets.target_localizer import TargetLocalizer, TargetPlace
from matchset.live.wire.state import TargetState
from matchset.localization.ball_target import BallTarget
from matchset.localization.markers.ball_colors import pick_marker
from matchset.localization.pose import Pose
from matchset.shapes.circle import Circle
from matchset.shapes.shape import Shape, center_of, outline
from matchset.tracking.track import Lost, Track
from matchset.tracking.tracker import Tracker

INNER = 0.5  # geometry: half-side of the square inside an outline from which its color is learned, half-widths
Floats = npt.NDArray[np.float64]


class ClickedTarget:
    """Follows one shape, and places it where its diameter and the camera are known.

    Parameters
    ----------
    number : int
        Its number on the page.
    begin : Pick or Outline
        What a person did.
    frame : Frame
        In which picture.

    Attributes
    ----------
    ball : BallTarget or None
        Its size; None: not known.
    parameters : tuple of str
        Names of the shape's parameters.
    begun : (float, float)
        Where it was clicked, or the middle of what was drawn, px.
    clicked : (Pick, Frame) or None
        The click and its picture, to read it anew.
    readings : list of str
        What the click may mean, the likeliest first.
    color : ColorModel
        What it looks like, with its marker.
    family : type
        Of its shape.
    answer : Track or Lost or None
        The last one of its tracker.
    last, before : Track or None
        Where it was found last, and before that.
    alternatives : tuple of int
        Numbers of the targets that it may be as well.
    is_kept : bool
        Whether a person clicked or named it; otherwise it was found since it looks like another one.
    since, seen : float or None
        When it was found first and last, s.
    pose : Pose, Lost or None
        In the last frame; None if diameter or camera are not known.

    Raises
    ------
    ValueError
        If the click is outside of the picture, no color can be learned there, or there is no such shape.
    """

    def __init__(self, number: int, begin: Begin, frame: Frame) -> None:
        if begin.shape not in NAMES.split(", "):  # a name alone: a page must not name files of this computer
            raise ValueError(f"a shape is {NAMES}; got {begin.shape!r}")
        family: Any = parse_shape(begin.shape)
        given = None
        self.clicked = (begin, frame) if isinstance(begin, Pick) else None
        if isinstance(begin, Outline):
            given = drawn_shape(begin, family)
            self.begun = center_of(outline(given))[:2]
            check_inside(*self.begun, *frame.image.shape[1::-1])
            color = color_within(given, frame)
        else:
            self.begun = begin.x, begin.y
            check_inside(*self.begun, *frame.image.shape[1::-1])
            color = ColorModel.pick(frame.image, *self.begun, reading=begin.reading, ball=family is Circle)
        self.readings = [str(each) for each in color.alternatives]
        self.number, self.name, self.note = number, f"{begin.shape} {number}", color.note
        self.shape, self.parameters = begin.shape, tuple(family.parameters)
        self.ball: BallTarget | None = None
        self.answer: Track[Any] | Lost[Any] | None = None
        self.tracker: Tracker[Any] = Tracker(family, color, start=self.begun)
        if given is not None:
            self.tracker.start(given)
        self.family, self.color = family, color
        self.is_kept = True
        self._camera, self._placing = None, None
        self._marker: tuple[ColorModel, float] | None = None
        self._begin()

    def _begin(self) -> None:
        """Have it found nowhere so far."""
        self.last: Track[Any] | None = None
        self.before: Track[Any] | None = None
        self.alternatives: tuple[int, ...] = ()
        self.since: float | None = None
        self.seen: float | None = None
        self.pose: Pose | Lost[Pose] | None = None
        self.answer = None

    def alike(self, number: int) -> "ClickedTarget":
        """Make one that looks like it, and was found without a click."""
        other = copy.copy(self)
        other.number, other.name = number, f"{self.shape} {number}"
        other.clicked, other.readings, other.is_kept = None, [], False
        other.tracker = Tracker(self.family, self.color)
        other._begin()
        other.locate(self._camera, self.ball)
        return other

    _camera: CameraModel | None
    _placing: TargetLocalizer | None

    def locate(self, camera: CameraModel | None, ball: BallTarget | None) -> None:
        """Set what is known of camera and target; None: not known.

        Parameters
        ----------
        camera : CameraModel or None
        ball : BallTarget or None

        Raises
        ------
        ValueError
            If its marker is not smaller than it.
        """
        placing = None
        if camera is not None and ball is not None:
            placing = TargetLocalizer(camera, ball, self._marker)
        self._camera, self.ball, self._placing = camera, ball, placing

    def mark(self, frame: Frame, x: float, y: float, width: float) -> None:
        """Learn the color of its marker, at a point of a picture.

        Parameters
        ----------
        frame : Frame
        x, y : float
            px
        width : float
            m

        Raises
        ------
        ValueError
            If it is no ball, or no color can be learned there.
        """
        if self.family is not Circle:
            raise ValueError(f"{self.name} is no ball: only balls have markers")
        color, before = pick_marker(frame.image, x, y), self._marker
        joint = self.color | color
        self._marker = color, width
        try:
            self.locate(self._camera, self.ball)
        except ValueError:
            self._marker = before
            raise
        self.color, self.tracker = joint, Tracker(self.family, joint, start=self.begun)
        if isinstance(self.answer, Track):
            self.tracker.start(self.answer.shape)

    def update(self, frame: Frame) -> TargetState:
        """Follow it into a frame."""
        try:
            answer = self.tracker.update(frame)
        except ValueError:  # another size of the pictures, or a time that runs anew: begin anew
            self.tracker.restart()
            answer = self.tracker.update(frame)
        return self.take(frame, answer)

    def take(self, frame: Frame, answer: Track[Any] | Lost[Any], alternatives: tuple[int, ...] = ()) -> TargetState:
        """Take what was found of it in a frame, by its own tracker or together with others that look like it."""
        self.answer, self.alternatives = answer, alternatives
        if isinstance(answer, Track):
            self.before, self.last = self.last, answer
            self.seen = answer.time
            self.since = answer.time if self.since is None else self.since
        return self.told(frame)

    def follow_alone(self) -> None:
        """Follow it by its own tracker again, from where it was seen."""
        self.tracker.restart(self.answer.shape if isinstance(self.answer, Track) else None)
        self.alternatives = ()

    def told(self, frame: Frame) -> TargetState:
        """Place what was found in a frame, and say it."""
        answer = self.answer
        if answer is None:
            return lost_state(self._about, "not looked for yet")
        place = TargetPlace() if self._placing is None else self._placing.place(frame, answer)
        self.pose = place.pose
        if isinstance(answer, Lost):
            return self._lost(answer)
        return found_state(self._about, answer, place)

    def without_picture(self, reason: str) -> TargetState:
        """Say that it is lost because there is no picture."""
        self.pose = None
        return lost_state(self._about, reason)

    @property
    def _about(self) -> TargetFacts:
        reading = 0 if self.clicked is None else self.clicked[0].reading
        return TargetFacts(
            self.number, self.name, self.shape, self.ball, self.readings, reading, self.since, self.alternatives
        )

    def _lost(self, answer: Lost[Any]) -> TargetState:
        since = 0.0 if self.seen is None else max(answer.time - self.seen, 0.0)
        return lost_state(self._about, answer.reason, since, answer.predicted)


def catch_up(target: ClickedTarget, frames: list[Frame]) -> None:
    """Follow a target through the frames since the click, so that it is where the newest one is."""
    for frame in frames:
        target.update(frame)


def color_within(given: Shape, frame: Frame) -> ColorModel:
    """Learn the color inside a drawn outline; where nothing tells it from the rest, only edges count."""
    x, y, _ = center_of(outline(given))
    half = max(INNER * float(type(given).half_width(given.state)), 1.0)
    try:
        return ColorModel.learn(frame.image, (round(x - half), round(y - half), round(2 * half), round(2 * half)))
    except ValueError:
        color = ColorModel.edges()
        color.note = "no color tells what was drawn from the rest: only its edges are followed, which is less sure"
        return color


class BesideParameters(msgspec.Struct, frozen=True, kw_only=True):
    """How far what is found first may be from the click that it is to answer. Both chosen by hand.

    Parameters
    ----------
    rim : float
        From its middle in the picture of the click, half-widths: the rim, with the room that a finger needs.
    speed : float
        How much farther for each second that has passed since, half-widths per second: a ball that is thrown.
    """

    rim: float = 2.0
    speed: float = 60.0


def is_beside(begin: Begin, answer: Track[Any], passed: float, parameters: BesideParameters | None = None) -> bool:
    """Whether a click was too far from what was found so long after it, s: it meant something else."""
    if isinstance(begin, Outline):
        return False
    limits = parameters or BesideParameters()
    x, y = center_of(outline(answer.shape))[:2]
    half = float(type(answer.shape).half_width(answer.shape.state))
    return math.hypot(begin.x - x, begin.y - y) > (limits.rim + limits.speed * max(passed, 0.0)) * half


def same_place(one: TargetState, other: TargetState) -> bool:
    """Whether two targets are found at one place: each has its middle inside of the other."""
    if not (one.found and other.found):
        return False
    pairs = ((one, other), (other, one))
    return all(
        cv2.pointPolygonTest(np.reshape(a.outline, (-1, 1, 2)).astype(np.float32), _middle(b), False) >= 0
        for a, b in pairs
    )


def _middle(state: TargetState) -> tuple[float, float]:
    x, y = np.reshape(state.outline, (-1, 2)).mean(axis=0).tolist()
    return x, y


def check_inside(x: float, y: float, width: int, height: int) -> None:
    """Raise a ValueError if a point, px, is in no pixel of a picture of this size; the first one's middle is (0, 0)."""
    if not (-0.5 <= x < width - 0.5 and -0.5 <= y < height - 0.5):
        raise ValueError(f"({x:g}, {y:g}) is outside of the picture of {width} x {height} px")
