"""A pilot's phases in every state that it can reach: pictures, commands by hand, a link that refuses, and time.

What the pictures show is given here, so that nothing is tracked; all that decides whether a motor may turn is the
pilot's own. Times are on a grid of a tenth of a second, relative to the last command; see
tests/control/test_safety_walk.py.
"""

import functools
import itertools
import math
from typing import Any, NamedTuple, cast

import msgspec

from matchset.control.command import Command
from matchset.control.follower import Follower
from matchset.control.repeated_picture import PicturesSeen, RepeatedPictureParameters
from matchset.control.safety import DesiredCommand, SafetyParameters, SafetyState
from matchset.control.sticks.angle_sticks import AngleSticks
from matchset.control.sticks.ego_parameters import EgoMotionParameters
from matchset.flight.chain.pilot import Pilot, PilotParameters
from matchset.links.link import Link, LinkStatus, State
from matchset.tracking.track import Lost
from walks import walk_all

STEP, OLD = 0.1, 0.3
NOTHING = Command()
PARAMETERS = PilotParameters(
    safety=SafetyParameters(
        max_frame_age=0.15,
        hold_time=0.25,
        reacquisition_time=0.15,
        descent_duration=0.25,
        min_throttle=0.4,
        max_throttle=0.8,
        max_throttle_rate=4.0,
        max_near_time=0.25,
    ),
    repeated=RepeatedPictureParameters(max_repeats=2, final_repeats=4),
)
SAFETY = PARAMETERS.safety


class Situation(NamedTuple):
    """Everything that decides what happens next; times relative to the last command, s."""

    safety: SafetyState = SafetyState()
    frame_time: float = -math.inf
    seen_time: float = -math.inf
    pictures: PicturesSeen = PicturesSeen()
    fault: str = ""
    armed: bool = False
    killed: str = ""
    landing: str = ""


class Happening(NamedTuple):
    """What one step brings."""

    hand: str
    picture: str
    answers: bool
    link: State


class Taken(NamedTuple):
    """One step of the walk."""

    before: Situation
    happening: Happening
    command: Command
    after: Situation


class Stick(Link):
    """A link that says a state and flies what it is told."""

    uri = "stick://"
    state: State = "armed"

    def arm(self) -> None:
        """Do nothing."""

    def cut(self) -> None:
        """Do nothing."""

    def send(self, command: Command) -> Command:
        """Return the command."""
        return command

    def status(self) -> LinkStatus:
        """Return the state."""
        return LinkStatus(self.state, "", 0, 0.0)

    def land(self, duration: float = 1.5) -> None:
        """Do nothing."""

    def close(self) -> None:
        """Do nothing."""


class Watch:
    """A camera that has the time, and a follower that always answers."""

    desired = DesiredCommand(0.0, 0.0, 0.0, 0.9)
    is_current = True
    hover_throttle = 0.8
    sticks = AngleSticks(EgoMotionParameters(), 0.5)

    @property
    def consistency(self) -> "Watch":
        """Whether the motion in the pictures answers to the commands: `holds`."""
        return self

    def read(self) -> None:
        """Return no picture: `Walked._locate` has what it shows."""

    def now(self) -> float:
        """Return the time of the step."""
        return STEP

    def update(self, pose: object, now: float) -> "Watch":  # noqa: ARG002
        """Answer."""
        return self

    def sent(self, command: Command, now: float) -> None:
        """Do nothing."""


class Walked(Pilot):
    """A pilot in a situation, to whom one thing happens."""

    def __init__(self, at: Situation, happening: Happening) -> None:
        self.parameters, self.link, self._happening = PARAMETERS, Stick(), happening
        self.link.state = happening.link
        watch = Watch()
        watch.is_current = happening.answers
        self.camera, self._follower = cast("Any", watch), cast(Follower, watch)
        self._safety, self._frame_time, self._seen_time = at.safety, at.frame_time, at.seen_time
        self._pictures, self._fault, self.armed = at.pictures, at.fault, at.armed
        self.killed, self.landing, self._link_is_armed = at.killed, at.landing, False
        self._excitation, self._distances = None, (math.inf, math.inf)

    def _locate(self, frame: object, now: float, stamps: list[float]) -> Any:  # noqa: ARG002
        picture = self._happening.picture
        if picture in ("ball", "near", "nothing"):
            self._frame_time, self._pictures = now, PicturesSeen()
            self._seen_time = self._seen_time if picture == "nothing" else now
            self._distances = (0.4, 0.4) if picture == "near" else self._distances
        elif picture in ("again", "old"):
            repeats = min(self._pictures.repeats + 1, self.parameters.repeated.final_repeats)
            self._pictures = PicturesSeen((), repeats, self._pictures.went_back or picture == "old")
        stamps.extend([stamps[-1]] * 3)
        return Lost("", now), (), Lost("", now)


HAPPENINGS = [
    Happening(*cast("Any", each))
    for each in itertools.product(
        ("", "arm", "cut", "land"),
        ("ball", "near", "nothing", "none", "again", "old"),
        (True, False),
        ("armed", "failsafe"),
    )
    if (not each[0] or (each[1] in ("ball", "none") and each[2])) and (each[1] != "near" or each[2:] == (True, "armed"))
]


def shifted(time: float) -> float:
    """Return a time relative to the end of the step; what is very old is `OLD`."""
    return time if math.isinf(time) else max(round(time - STEP, 6), -OLD)


def step(before: Situation, happening: Happening) -> Taken:
    """Take one step."""
    pilot = Walked(before, happening)
    if happening.hand == "arm":
        pilot.arm()
    if happening.hand == "cut":
        pilot.cut("by hand")
    if happening.hand == "land":
        pilot.land("by hand")
    done = pilot.step()
    safety = done.safety
    names = ("time", "descent_start", "seen_time", "seen_since", "near_since")
    times: dict[str, Any] = {name: shifted(getattr(safety, name)) for name in names}
    safety = safety._replace(**times)
    command = msgspec.structs.replace(safety.command, throttle=round(safety.command.throttle, 1))
    safety = safety._replace(command=command, initial_throttle=round(safety.initial_throttle, 1))
    after = Situation(
        safety,
        shifted(pilot._frame_time),
        shifted(pilot._seen_time),
        pilot._pictures,
        pilot._fault,
        pilot.armed,
        pilot.killed,
        pilot.landing,
    )
    return Taken(before, happening, done.command, after)


@functools.cache
def walk() -> list[Taken]:
    """Every step from every situation that can be reached."""
    return walk_all(Situation(), HAPPENINGS, step)


@functools.cache
def steps() -> dict[tuple[Situation, Happening], Taken]:
    """The same, by where one begins and what happens."""
    return {(each.before, each.happening): each for each in walk()}


def test_the_walk_is_long_and_sees_every_phase() -> None:
    assert {each.after.safety.phase for each in walk()} == {"locked", "flying", "holding", "descending", "cut"}
    assert len({each.before for each in walk()}) > 300


def test_throttle_needs_arming_a_link_that_flies_and_pictures_of_now() -> None:
    for each in walk():
        if each.command.throttle > 0.0:
            assert each.after.armed
            assert not each.after.killed
            assert each.happening.link == "armed"
            assert each.after.safety.phase in ("flying", "holding", "descending")
            assert not (each.after.fault or each.after.landing) or each.after.safety.phase == "descending"


def test_after_a_cut_only_arming_helps() -> None:
    for each in walk():
        if each.happening.hand == "cut" or (each.before.killed and each.happening.hand != "arm"):
            assert each.command == NOTHING
            assert each.after.killed


def test_a_landing_only_descends_and_only_arming_ends_it() -> None:
    for each in walk():
        if each.happening.hand == "land" or (each.before.landing and each.happening.hand != "arm"):
            assert each.after.landing
            assert each.after.safety.phase in ("locked", "descending", "cut")
            assert each.command.throttle <= each.before.safety.command.throttle
    assert any(each.before.landing and each.after.safety.phase == "descending" for each in walk())


def test_from_everywhere_a_landing_ends_in_motors_off_in_time() -> None:
    most = round(SAFETY.descent_duration / STEP + 2.0)
    for situation in {each.before for each in walk()}:
        at = situation
        for number in range(most):
            taken = steps()[at, Happening("" if number else "land", "ball", True, "armed")]
            at = taken.after
        assert taken.command == NOTHING
        assert at.safety.phase in ("cut", "locked")


def test_whatever_is_too_near_is_backed_off_from_whoever_holds_the_phase() -> None:
    flown = [each for each in walk() if each.happening.picture == "near" and each.after.safety.phase == "holding"]
    assert flown
    change = SAFETY.max_stick_rate * STEP
    for each in flown:
        assert each.command.pitch <= max(-SAFETY.back_off, each.before.safety.command.pitch - change)
    assert not any(each.after.safety.phase == "flying" for each in walk() if each.happening.picture == "near")


def test_a_refusal_is_noticed_at_once_and_lasts_until_it_is_armed() -> None:
    for each in walk():
        if each.after.armed and each.happening.link == "failsafe":
            assert each.command == NOTHING
            assert each.after.safety.phase == "cut"
        if each.before.safety.phase == "cut" and each.happening.hand != "arm" and each.before.armed:
            assert each.command == NOTHING
            assert each.after.safety.phase == "cut"


def test_pictures_that_are_not_of_now_end_the_flight_for_good() -> None:
    for each in walk():
        if each.before.fault and each.happening.hand != "arm":
            assert each.after.fault
            assert each.after.safety.phase not in ("flying", "holding")
        if not each.happening.answers and each.after.armed:
            assert each.after.fault
        if each.after.safety.phase == "descending":
            assert each.command.throttle <= each.before.safety.command.throttle


def test_from_everywhere_bad_pictures_end_in_motors_off_in_time() -> None:
    limits = {"none": SAFETY.max_frame_age, "nothing": SAFETY.hold_time, "again": SAFETY.max_frame_age, "old": 0.15}
    limits["near"] = SAFETY.max_near_time
    for picture, limit in limits.items():
        most = round((limit + SAFETY.descent_duration) / STEP + 2.0)
        for situation in {each.before for each in walk()}:
            at, happening = situation, Happening("", picture, True, "armed")
            for _ in range(most):
                taken = steps()[at, happening]
                at = taken.after
            assert taken.command == NOTHING
            assert at.safety.phase in ("cut", "locked")
