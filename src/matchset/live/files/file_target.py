"""A target of a recorded video with what was found of it in each frame: `FileTarget`."""

from collections.abc import Iterable, Iterator
from typing import Any

import msgspec

from matchset.camera.camera_model import CameraModel
from matchset.image.color import ColorModel
from matchset.live.files.messages import Correct
from matchset.live.targets.messages import Outline, Pick
from matchset.live.targets.target_facts import TargetFacts, found_state, lost_state
from matchset.live.targets.target_localizer import TargetPlace, position_of
from matchset.live.wire.state import TargetState
from matchset.localization.ball_target import BallTarget
from matchset.localization.localizer import Localizer, left_out
from matchset.localization.pose import Pose
from matchset.tracking.track import Lost, Track

Answer = Track[Any] | Lost[Any]
UNKNOWN, FOUND, LOST = range(3)  # format: what is known of a frame; the larger one wins where a column holds several


class FileTarget:
    """What was found of a target, by the places of the frames.

    A person says where the target is in some frames, by clicks. From each click it is followed forward up to the next
    one, and from the first one backward as well.

    Parameters
    ----------
    number : int
    begin : Pick or Outline
        The first click.
    place : int
        Of the frame in which it was.

    Attributes
    ----------
    clicks : dict of int to Pick or Outline
        By the place of their frames.
    version : int
        Changes whenever something else is known.
    ball : BallTarget or None
        Its size; None: not known.
    localizer : Localizer or None
    color : ColorModel or None
        Learned by the first click.
    readings : list of str
        What that may mean, the likeliest first.
    clicked : bool
        Whether a person clicked it; otherwise it was found since it looks like another one.
    finds : bool
        Whether all that looks like it is followed, too.
    """

    def __init__(self, number: int, begin: Pick | Outline, place: int) -> None:
        self.number, self.shape, self.name = number, begin.shape, f"{begin.shape} {number}"
        self.clicks: dict[int, Pick | Outline] = {place: begin}
        self.clicked, self.finds = True, False
        self._answers: dict[int, Answer] = {}
        self._alternatives: dict[int, tuple[int, ...]] = {}
        self._codes = bytearray()
        self.version = 0
        self.camera: CameraModel | None = None
        self.ball: BallTarget | None = None
        self.localizer: Localizer | None = None
        self.color: ColorModel | None = None
        self.readings: list[str] = []

    def correct(self, correction: Correct, place: int) -> None:
        """Take another click; what was found in the frames that it decides is forgotten."""
        click = Pick(correction.sequence, correction.x, correction.y, self.shape)
        first = place < min(self.clicks)
        self.clicks = {**self.clicks, place: click}
        after = [other for other in self.clicks if other > place]
        self._forget(0 if first else place, min(after, default=len(self._codes)))

    def decides(self, click: int, place: int) -> bool:
        """Whether the click in one frame decides what is found in another one."""
        before = [other for other in self.clicks if other <= place]
        return click == max(before, default=min(self.clicks))

    def put(self, place: int, answer: Answer, alternatives: tuple[int, ...] = ()) -> None:
        """Keep what was found in a frame, and the numbers of the targets that it may be as well."""
        if place >= len(self._codes):
            self._codes.extend(bytes(place + 1 - len(self._codes)))
        self._answers[place] = answer
        self._alternatives.pop(place, None)
        if alternatives:
            self._alternatives[place] = alternatives
        self._codes[place] = LOST if isinstance(answer, Lost) else FOUND
        self.version += 1

    def _forget(self, begin: int, end: int) -> None:
        for place in range(begin, min(end, len(self._codes))):
            self._answers.pop(place, None)
            self._alternatives.pop(place, None)
            self._codes[place] = UNKNOWN
        self.version += 1

    def answer(self, place: int) -> Answer | None:
        """Return what was found in a frame; None if that is not known yet."""
        return self._answers.get(place)

    def alternatives(self, place: int) -> tuple[int, ...]:
        """Return the numbers of the targets that it may be as well in a frame."""
        return self._alternatives.get(place, ())

    @property
    def codes(self) -> bytes:
        """UNKNOWN, FOUND or LOST by place; may end early."""
        return bytes(self._codes)

    @property
    def known(self) -> int:
        """In how many frames it is known."""
        return len(self._answers)

    @property
    def diameter(self) -> float | None:
        """Return its diameter, m; None: not known."""
        return None if self.ball is None else self.ball.diameter

    def locate(self, camera: CameraModel | None, ball: BallTarget | None) -> None:
        """Set what is known of camera and target; None: not known. What was found before is located as well."""
        self.camera, self.ball = camera, ball
        self.localizer = self.new_localizer()
        self.version += 1

    def new_localizer(self) -> Localizer | None:
        """Make a localizer for another thread; None if diameter or camera are not known."""
        if self.camera is None or self.ball is None or self.shape != "circle":
            return None
        return Localizer(self.camera, self.ball)

    def last_found(self, place: int) -> int | None:
        """Return the place of the last frame up to this one in which it was found."""
        found = self._codes.rfind(FOUND, 0, place + 1)
        return None if found < 0 else found

    def first_found(self) -> int | None:
        """Return the place of the first frame in which it was found."""
        found = self._codes.find(FOUND)
        return None if found < 0 else found

    def nearest(self, place: int, before: bool) -> Track[Any] | None:
        """Return where it was found nearest to a frame, before it or after it."""
        at = self._codes.rfind(FOUND, 0, place) if before else self._codes.find(FOUND, place + 1)
        answer = self.answer(at)
        return answer if isinstance(answer, Track) else None

    def alike(self, number: int, place: int) -> "FileTarget":
        """Make one that looks like it and was found in a frame without a click."""
        other = FileTarget(number, Pick(0, 0.0, 0.0, self.shape), place)
        other.clicked, other.color, other.finds = False, self.color, self.finds
        other.locate(self.camera, self.ball)
        return other

    def rename(self, name: str) -> None:
        """Give it another name."""
        self.name = name
        self.version += 1

    def state(self, place: int) -> TargetState:
        """Return what the page shows of it in a frame, for the thread of the player."""
        return msgspec.structs.replace(self._state(place), finds=self.finds)

    def _state(self, place: int) -> TargetState:
        answer, pose = self.answer(place), self.pose(place)
        first = self.clicks[min(self.clicks)]
        reading = first.reading if isinstance(first, Pick) and self.readings else 0
        begun = self.first_found()
        born = None if begun is None else self.answer(begun)
        since = None if born is None else born.time
        others = self.alternatives(place)
        about = TargetFacts(self.number, self.name, self.shape, self.ball, self.readings, reading, since, others)
        if answer is None:
            return msgspec.structs.replace(lost_state(about, "not tracked here yet"), pending=True)
        if isinstance(answer, Lost):
            return lost_state(about, answer.reason, self._lost_for(place, answer), answer.predicted)
        localizer = self.localizer
        if localizer is None or not isinstance(pose, Pose):
            return found_state(about, answer, TargetPlace())
        without = left_out(localizer.camera, localizer.target)
        return found_state(about, answer, TargetPlace(pose, position_of(pose), left_out=without))

    def _lost_for(self, place: int, answer: Lost[Any]) -> float:
        last = self.last_found(place)
        seen = None if last is None else self.answer(last)
        return 0.0 if seen is None else max(answer.time - seen.time, 0.0)

    def pose(self, place: int) -> "Pose | Lost[Pose] | None":
        """Return where it is in a frame, for the thread of the player; None: not known, or nothing to know it from."""
        localizer, answer = self.localizer, self.answer(place)
        return None if localizer is None or answer is None else localizer.update(answer)

    def found(self, places: Iterable[int]) -> Iterator[tuple[int, Answer]]:
        """Yield those of the places at which it is known whether it was found, with the answers."""
        for place in places:
            answer = self.answer(place)
            if answer is not None:
                yield place, answer
