"""What may be sent: `safety_filter`, a pure function of the desired command, the situation and its last state.

Phases: ``locked -> flying <-> descending -> cut``. A ball that is not seen is tolerated for `hold_time`, while the
controller flies on its prediction; so is a controller without an answer. Then, or as soon as no frames come, the
throttle is lowered, and then the motors are stopped. Frames with a fault, which are no new ones or not those of now,
end a flight at once; so does a vehicle that soon cannot carry itself any more.
"""

import math
from typing import Literal, NamedTuple

import msgspec

from matchset.control.command import Command, clip
from matchset.numeric.arguments import require, require_positive

Phase = Literal["locked", "flying", "holding", "descending", "cut"]
"""``holding``: flying on the prediction, the ball is not seen. ``cut``: motors off until armed again."""
AIRBORNE: tuple[Phase, ...] = ("flying", "holding", "descending")
"""Phases in which motors turn."""


class SafetyParameters(msgspec.Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """Limits of what is sent.

    Parameters
    ----------
    max_tilt : float
        Largest roll and pitch stick, 0 ... 1. More follows faster, and falls farther when it goes wrong. Chosen by
        hand: leaves the flight controller a margin.
    max_yaw : float
        Largest yaw stick, 0 ... 1. Chosen by hand: all.
    min_throttle, max_throttle : float
        Range of the throttle in flight, 0 ... 1. Chosen by hand: it neither falls like a stone nor hits the ceiling.
    throttle_reserve : float
        Largest throttle as a multiple of what hovers, for a vehicle so weak that this is above `max_throttle`; never
        above 1. Less lets it sink, more gives it all it has sooner. Chosen by: a battery that loses 40 % in 60 s,
        docs/log/control.md#battery.
    max_hover, max_hover_time : float
        Largest throttle that hovers, and how long it may be more, or all of it be desired, s: the battery is nearly
        empty, and the vehicle lands while it still can. Less lands sooner. Chosen by: the same; one whose thrust sinks
        to 1.05 weights and stays there is to fly.
    max_stick_rate : float
        Largest change of roll, pitch and yaw, full sticks/s. Chosen by hand: full stick within 1/8 s.
    max_throttle_rate : float
        Largest change of the throttle, 1/s, up or down; stopping the motors is not limited. Chosen by hand: all of it
        within 1/3 s.
    max_frame_age : float
        Largest age of the newest frame, s; an older one means that no frames come. Chosen by: the project's safety
        rules.
    hold_time : float
        How long the ball may be unseen, or the controller without an answer, while frames come, s. Chosen by: the
        project's safety rules.
    reacquisition_time : float
        How long the ball must be seen again without a gap until a descent is called off, s. Chosen by hand: three
        frames.
    min_distance : float
        Distance below which whatever is seen is too near, m: the vehicle goes back. Less lets others come nearer, more
        goes back from a neighbor that only swings. Chosen by hand: two vehicles of 20 cm, and what one goes on while it
        turns back.
    back_off : float
        Pitch stick by which it goes back at least, 0 ... 1. More goes back faster, and nearer to whoever is behind.
        Chosen by hand: 1.5 m/s^2 of a vehicle whose largest tilt is 30 degrees.
    max_near_time : float
        How long something may be too near until the vehicle lands, s: it may have been held or caught. Chosen by hand:
        half a meter is gone back in less.
    descent_duration : float
        Time from the first command of a descent to the cut, s. Chosen by hand: down from 1 to 2 m.
    initial_throttle_ratio, final_throttle_ratio : float
        Throttle at the beginning and the end of a descent as a share of that before it, or of what hovers if that is
        less; in between a straight line. The first is below 1, so that the first command lowers it. Chosen by hand:
        sinks at about 1 m/s.
    min_step, max_step : float
        Limits of the time between commands that the rates are computed with, s. Chosen by hand: a clock that jumps must
        not allow a jump of the sticks.
    """

    max_tilt: float = 1.0
    max_yaw: float = 1.0
    min_throttle: float = 0.2
    max_throttle: float = 0.9
    throttle_reserve: float = 1.25
    max_hover: float = 0.98
    max_hover_time: float = 1.0
    max_stick_rate: float = 8.0
    max_throttle_rate: float = 3.0
    max_frame_age: float = 0.3
    hold_time: float = 1.0
    reacquisition_time: float = 0.1
    min_distance: float = 0.5
    back_off: float = 0.3
    max_near_time: float = 2.0
    descent_duration: float = 2.0
    initial_throttle_ratio: float = 0.98
    final_throttle_ratio: float = 0.75
    min_step: float = 1e-3
    max_step: float = 0.1

    def __post_init__(self) -> None:
        require_positive(self, self.__struct_fields__)
        shares = (
            "max_tilt",
            "max_yaw",
            "min_throttle",
            "max_throttle",
            "max_hover",
            "back_off",
            "initial_throttle_ratio",
            "final_throttle_ratio",
        )
        require(self, shares, lambda value: value <= 1.0, "within 0 ... 1")
        require(self, ("throttle_reserve",), lambda value: value >= 1.0, "at least 1")
        require(self, ("min_throttle",), lambda value: value < self.max_throttle, "below max_throttle")


class DesiredCommand(NamedTuple):
    """What the controller would like to send; unchecked, so it may be anything."""

    roll: float
    pitch: float
    yaw: float
    throttle: float


class SafetyInputs(NamedTuple):
    """The situation at the time of a command; times in s on one clock, -inf for never.

    Attributes
    ----------
    now : float
        When the command is made.
    frame_time : float
        When the newest frame was taken.
    seen_time : float
        When the newest frame in which the ball was confirmed was taken.
    armed : bool
        Whether the pilot wants to fly.
    fault : str
        Why the newest frames must not be flown by, in words; empty if they may. While it is not, no ball is seen.
    doubt : str
        Why a ball that is in the newest frame does not count as confirmed, in words; empty if none is in it, or if it
        counts.
    hover : float
        Throttle that hovers, as far as it is known, or NaN: a descent begins with no more, also out of a climb.
    distance : float
        Of the nearest thing in the newest frame, as far as it is known, m; 0 for what fills the picture; NaN if none is
        known.
    hold_throttle : float
        Throttle that stands still where the throttle is a speed up or down; NaN where it is thrust. Without an answer
        that is sent, in place of the last one, which may climb; a descent begins there.
    """

    now: float
    frame_time: float
    seen_time: float
    armed: bool
    fault: str = ""
    doubt: str = ""
    hover: float = math.nan
    distance: float = math.nan
    hold_throttle: float = math.nan


class SafetyState(NamedTuple):
    """What the next call needs; the first one gets `SafetyState()`.

    Attributes
    ----------
    phase : Phase
    reason : str
        Why the phase is not "flying", in words.
    time : float
        When the last command was made, s.
    descent_start : float
        When the descent began, s.
    seen_time : float
        When the newest frame was taken in which the ball was confirmed and for which the controller had an answer, s.
    seen_since : float
        Since when the ball is seen without a gap, s.
    initial_throttle : float
        Throttle before the descent, or what hovers, if that is less; `SafetyInputs.hold_throttle` where that is known.
    command : Command
        The last command.
    weak_since : float
        Since when more throttle hovers than may, or all of it is desired, s; stays in a descent.
    near_since : float
        Since when something is too near without a gap, s; stays in a descent.
    """

    phase: Phase = "locked"
    reason: str = "not armed"
    time: float = -math.inf
    descent_start: float = math.inf
    seen_time: float = -math.inf
    seen_since: float = math.inf
    initial_throttle: float = 0.0
    command: Command = Command()
    weak_since: float = math.inf
    near_since: float = math.inf


def safety_filter(
    desired: DesiredCommand | None, inputs: SafetyInputs, state: SafetyState, limits: SafetyParameters | None = None
) -> tuple[Command, SafetyState]:
    """Decide what is sent.

    Parameters
    ----------
    desired : DesiredCommand or None
        What the controller wants; None, or anything not finite, counts as no answer: neutral sticks, same throttle (or
        `SafetyInputs.hold_throttle`), and the ball counts as not seen.
    inputs : SafetyInputs
        The situation. A time that is not finite or in the future counts as too old.
    state : SafetyState
        From the last call.
    limits : SafetyParameters, optional

    Returns
    -------
    command : Command
        Always finite and in range. Zero when not armed and after the cut.
    state : SafetyState
        For the next call.
    """
    limits = limits or SafetyParameters()
    if not inputs.armed:
        return Command(), SafetyState(reason="not armed", time=inputs.now)
    usable = desired is not None and all(map(math.isfinite, desired))
    seen_since = _seen_since(inputs, state, usable, limits)
    answered = usable or state.phase == "locked"
    seen_time = inputs.seen_time if answered else min(inputs.seen_time, state.seen_time)
    state = state._replace(
        weak_since=_weak_since(desired, inputs, state, limits), near_since=_near_since(inputs, state, limits)
    )
    reason = _reason_to_descend(inputs, seen_time, state, limits)
    if state.phase == "cut":
        return Command(), state._replace(time=inputs.now, seen_time=seen_time)
    is_near, why_held = inputs.distance < limits.min_distance, _reason_to_hold(inputs, usable, limits)
    if state.phase == "locked" and (reason or why_held):
        return Command(), state._replace(seen_time=seen_time, reason=reason or why_held, time=inputs.now)
    if state.phase == "descending" and (is_near or not inputs.now - seen_since >= limits.reacquisition_time):
        reason = reason or state.reason
    if reason:
        state = state._replace(reason=reason, seen_since=seen_since, seen_time=seen_time)
        return _descend(inputs, state, limits)
    since = inputs.now - state.time if math.isfinite(state.time) else limits.min_step  # nothing was sent before
    step = min(max(since, 0.0), limits.max_step)
    same = state.command.throttle if math.isnan(inputs.hold_throttle) else inputs.hold_throttle
    goal = desired if usable and desired is not None else DesiredCommand(0.0, 0.0, 0.0, same)
    if is_near:
        goal = goal._replace(pitch=min(goal.pitch, -limits.back_off))
    command = _limited(goal, state.command, inputs.hover, step, limits)
    phase: Phase = "holding" if why_held else "flying"
    return command, SafetyState(
        phase,
        why_held,
        inputs.now,
        seen_time=seen_time,
        seen_since=seen_since,
        command=command,
        weak_since=state.weak_since,
        near_since=state.near_since,
    )


def _reason_to_hold(inputs: SafetyInputs, usable: bool, limits: SafetyParameters) -> str:
    """Say why it does not fly by the controller alone; empty if it does."""
    if inputs.distance < limits.min_distance:
        return f"something is nearer than {limits.min_distance:g} m"
    if not usable:
        return "the controller has no answer"
    return "" if inputs.seen_time == inputs.frame_time else inputs.doubt or "the ball is not seen"


def _seen_since(inputs: SafetyInputs, state: SafetyState, usable: bool, limits: SafetyParameters) -> float:
    """Since when the ball is seen without a gap, s; inf while it is not."""
    fresh = 0.0 <= inputs.now - inputs.frame_time <= limits.max_frame_age
    seen = usable and fresh and not inputs.fault and inputs.seen_time == inputs.frame_time
    return min(state.seen_since, inputs.now) if seen else math.inf


def _weak_since(
    desired: DesiredCommand | None, inputs: SafetyInputs, state: SafetyState, limits: SafetyParameters
) -> float:
    """Since when more throttle hovers than may, or all of it is desired, s; inf if neither is so or nothing flies.

    A descent does not end it.
    """
    if state.phase == "descending":
        return state.weak_since
    weak = inputs.hover > limits.max_hover or (desired is not None and desired.throttle >= 1.0)
    return min(state.weak_since, inputs.now) if weak and state.phase in AIRBORNE else math.inf


def _near_since(inputs: SafetyInputs, state: SafetyState, limits: SafetyParameters) -> float:
    """Since when something is too near without a gap, s; inf if nothing is or nothing flies; a descent keeps it."""
    if state.phase == "descending":
        return state.near_since
    near = inputs.distance < limits.min_distance and state.phase in AIRBORNE
    return min(state.near_since, inputs.now) if near else math.inf


def _reason_to_descend(inputs: SafetyInputs, seen_time: float, state: SafetyState, limits: SafetyParameters) -> str:
    """Say why the flight must end; empty if there is no reason."""
    if inputs.fault:
        return inputs.fault
    if not 0.0 <= inputs.now - inputs.frame_time <= limits.max_frame_age:
        return f"no new frame for {limits.max_frame_age:g} s"
    if not 0.0 <= inputs.now - inputs.seen_time <= limits.hold_time:
        return f"{inputs.doubt or 'the ball has not been seen'} for {limits.hold_time:g} s"
    if not inputs.now - seen_time <= limits.hold_time:
        return f"the controller has not answered for {limits.hold_time:g} s"
    if inputs.now - state.near_since >= limits.max_near_time:
        return f"something was nearer than {limits.min_distance:g} m for {limits.max_near_time:g} s"
    if inputs.now - state.weak_since >= limits.max_hover_time:
        return "hovering takes nearly all of the throttle: the battery is nearly empty, or it is too heavy"
    return ""


def _descend(inputs: SafetyInputs, state: SafetyState, limits: SafetyParameters) -> tuple[Command, SafetyState]:
    """Neutral sticks and less throttle, then the cut; the state has the reason already."""
    hold = inputs.hold_throttle
    if state.phase != "descending":
        throttle = min(state.command.throttle, inputs.hover) if math.isnan(hold) else hold
        state = state._replace(descent_start=inputs.now, initial_throttle=throttle)
    share = (inputs.now - state.descent_start) / limits.descent_duration
    if not 0.0 <= share < 1.0:
        return Command(), SafetyState("cut", state.reason, inputs.now)
    step = min(max(inputs.now - state.time, limits.min_step), limits.max_step)
    first = limits.initial_throttle_ratio
    throttle = state.initial_throttle * (first + (limits.final_throttle_ratio - first) * share)
    last, change = state.command, limits.max_stick_rate * step
    command = Command(
        _toward(last.roll, 0.0, change),
        _toward(last.pitch, 0.0, change),
        _toward(last.yaw, 0.0, change),
        min(max(throttle, 0.0), last.throttle),
    )
    return command, state._replace(phase="descending", time=inputs.now, command=command)


def _limited(desired: DesiredCommand, last: Command, hover: float, step: float, limits: SafetyParameters) -> Command:
    """Clip to the limits, which depend on the throttle that hovers, then to the largest change of one step."""
    tilt, yaw, change = limits.max_tilt, limits.max_yaw, limits.max_stick_rate * step
    highest = min(max(limits.max_throttle, limits.throttle_reserve * hover), 1.0)
    throttle = min(max(desired.throttle, limits.min_throttle), highest)
    return Command(
        _toward(last.roll, clip(desired.roll, -tilt, tilt), change),
        _toward(last.pitch, clip(desired.pitch, -tilt, tilt), change),
        _toward(last.yaw, clip(desired.yaw, -yaw, yaw), change),
        _toward(last.throttle, throttle, limits.max_throttle_rate * step),
    )


def _toward(value: float, goal: float, change: float) -> float:
    """Change a value toward a goal, by at most so much."""
    return clip(goal, value - change, value + change)
