"""What may be sent: `safety_filter`, a pure function from a wish and the facts to a `Command` and what to remember.

``locked -> flying <-> descending -> cut``. While flying, a lost ball is tolerated for `hold` seconds, in which the wish
rests on the prediction; then, or as soon as frames stop coming, the throttle goes down, and then the motors are cut.
"""

import math
from typing import Literal, NamedTuple

import msgspec

from matchset.control.command import Command

FIRST = 0.98  # share of the throttle with which a descent begins: it goes down from the first command on

Phase = Literal["locked", "flying", "holding", "descending", "cut"]
"""``holding``: flying on the prediction, the ball is not seen. ``cut``: motors off until armed anew."""


class SafetyParameters(msgspec.Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """Limits of what is sent.

    Parameters
    ----------
    tilt : float
        Largest roll and pitch stick, 0 ... 1. More follows faster, and falls farther when it goes wrong.
    yaw : float
        Largest yaw stick, 0 ... 1.
    least_throttle, most_throttle : float
        Range of the throttle while flying, 0 ... 1: neither fall like a stone nor shoot to the ceiling.
    slew : float
        Largest change of roll, pitch and yaw, full sticks/s.
    throttle_slew : float
        Largest change of the throttle, 1/s, up or down; the cut is not slewed.
    fresh : float
        Largest age of the newest frame, s: older means that no frames come.
    hold : float
        How long the ball may be unseen while frames come, s.
    seen_again : float
        How long the ball must have been seen again without a break before a descent is called off, s.
    descent : float
        Length of the descent, s, from its first command to the cut.
    descent_throttle : float
        Throttle at the end of the descent, as a share of that before it; it goes there along a straight line.
    """

    tilt: float = 0.8
    yaw: float = 1.0
    least_throttle: float = 0.2
    most_throttle: float = 0.9
    slew: float = 8.0
    throttle_slew: float = 3.0
    fresh: float = 0.3
    hold: float = 1.0
    seen_again: float = 0.1
    descent: float = 2.0
    descent_throttle: float = 0.75

    def __post_init__(self) -> None:
        for name in self.__struct_fields__:
            if not 0.0 < getattr(self, name) < math.inf:
                raise ValueError(f"{name} must be positive, got {getattr(self, name)}")
        for name in ("tilt", "yaw", "least_throttle", "most_throttle", "descent_throttle"):
            if getattr(self, name) > 1.0:
                raise ValueError(f"{name} must be within 0 ... 1, got {getattr(self, name)}")
        if self.least_throttle >= self.most_throttle:
            raise ValueError(f"least_throttle must be below most_throttle, got {self.least_throttle}")


class DesiredCommand(NamedTuple):
    """What the controller would like to send; unchecked, so it may be anything."""

    roll: float
    pitch: float
    yaw: float
    throttle: float


class SafetyInputs(NamedTuple):
    """What is known at the time of a command; times in s on one clock, -inf for never.

    Attributes
    ----------
    now : float
        When the command is made.
    frame : float
        When the newest frame was taken.
    seen : float
        When the newest frame in which the ball was confirmed was taken.
    armed : bool
        Whether the pilot wants to fly.
    """

    now: float
    frame: float
    seen: float
    armed: bool


class SafetyState(NamedTuple):
    """What the next call needs; start with `SafetyState()`, or with the command that flies already.

    Attributes
    ----------
    phase : Phase
    reason : str
        Why it is not plain flying, in words.
    time : float
        When the last command was made, s.
    since : float
        When the descent began, s.
    again : float
        Since when the ball is seen without a break, s.
    start : float
        Throttle at the beginning of the descent.
    command : Command
        The last command.
    """

    phase: Phase = "locked"
    reason: str = "not armed"
    time: float = -math.inf
    since: float = math.inf
    again: float = math.inf
    start: float = 0.0
    command: Command = Command()


def safety_filter(
    wish: DesiredCommand | None, facts: SafetyInputs, memory: SafetyState, limits: SafetyParameters | None = None
) -> tuple[Command, SafetyState]:
    """Decide what is sent.

    Parameters
    ----------
    wish : DesiredCommand or None
        What the controller wants; None, or anything not finite, is no answer: sticks neutral, throttle as it was.
    facts : SafetyInputs
        The situation. A time that is not finite or lies ahead counts as bad news.
    memory : SafetyState
        From the last call.
    limits : SafetyParameters, optional

    Returns
    -------
    command : Command
        Always finite and in range. Zero when not armed and after the cut.
    memory : SafetyState
        For the next call.
    """
    limits = limits or SafetyParameters()
    if not facts.armed:
        return Command(), SafetyState(reason="not armed", time=facts.now)
    blind = not 0.0 <= facts.now - facts.frame <= limits.fresh
    unseen = not 0.0 <= facts.now - facts.seen <= limits.hold
    usable = wish is not None and all(map(math.isfinite, wish))
    again = _seen_since(facts, memory, usable, limits)
    reason = _doubt(limits, blind, unseen)
    if memory.phase == "cut":
        return Command(), memory._replace(time=facts.now)
    if memory.phase == "locked" and (reason or not usable):
        return Command(), memory._replace(reason=reason or "the controller has no answer", time=facts.now)
    if memory.phase == "descending" and not facts.now - again >= limits.seen_again:
        reason = reason or memory.reason
    if reason:
        return _descend(facts, memory, reason, again, limits)
    step = min(max(facts.now - memory.time, 0.0), 0.1)
    goal = wish if usable and wish is not None else DesiredCommand(0.0, 0.0, 0.0, memory.command.throttle)
    command = _limited(goal, memory.command, step, limits)
    direct = usable and facts.seen == facts.frame
    phase: Phase = "flying" if direct else "holding"
    words = "" if direct else "the ball is not seen" if usable else "the controller has no answer"
    return command, SafetyState(phase, words, facts.now, again=again, command=command)


def _seen_since(facts: SafetyInputs, memory: SafetyState, usable: bool, limits: SafetyParameters) -> float:
    """Since when the ball is seen without a break, s; inf while it is not."""
    seen = usable and facts.seen == facts.frame and 0.0 <= facts.now - facts.frame <= limits.fresh
    return min(memory.again, facts.now) if seen else math.inf


def _doubt(limits: SafetyParameters, blind: bool, unseen: bool) -> str:
    """Why not to fly on; empty if there is no reason."""
    if blind:
        return f"no new frame for {limits.fresh:g} s"
    return f"the ball has not been seen for {limits.hold:g} s" if unseen else ""


def _descend(
    facts: SafetyInputs, memory: SafetyState, reason: str, again: float, limits: SafetyParameters
) -> tuple[Command, SafetyState]:
    """Neutral sticks and less throttle, then the cut."""
    begun = memory.phase == "descending"
    since = memory.since if begun else facts.now
    start = memory.start if begun else memory.command.throttle
    share = (facts.now - since) / limits.descent
    if not 0.0 <= share < 1.0:
        return Command(), SafetyState("cut", reason, facts.now)
    step = min(max(facts.now - memory.time, 1e-3), 0.1)
    throttle = start * (FIRST + (limits.descent_throttle - FIRST) * share)
    last = memory.command
    command = Command(
        _toward(last.roll, 0.0, limits.slew * step),
        _toward(last.pitch, 0.0, limits.slew * step),
        _toward(last.yaw, 0.0, limits.slew * step),
        min(max(throttle, 0.0), last.throttle),
    )
    return command, SafetyState("descending", reason, facts.now, since, again, start, command)


def _limited(wish: DesiredCommand, last: Command, step: float, limits: SafetyParameters) -> Command:
    """Clip to the limits, then to what may change in one step."""
    tilt, yaw, most, rise = limits.tilt, limits.yaw, limits.slew * step, limits.throttle_slew * step
    throttle = min(max(wish.throttle, limits.least_throttle), limits.most_throttle)
    return Command(
        _toward(last.roll, min(max(wish.roll, -tilt), tilt), most),
        _toward(last.pitch, min(max(wish.pitch, -tilt), tilt), most),
        _toward(last.yaw, min(max(wish.yaw, -yaw), yaw), most),
        _toward(last.throttle, throttle, rise),
    )


def _toward(value: float, goal: float, most: float) -> float:
    """Go from a value toward a goal, at most so far."""
    return min(max(goal, value - most), value + most)
