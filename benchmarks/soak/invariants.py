"""What must hold at every step of a flight: functions that say what is wrong, and return "" where nothing is.

None of them looks at how a decision was made: they compare what came in with what went out.
"""

import math
from collections.abc import Callable
from typing import Any, NamedTuple

import msgspec
import numpy as np
import numpy.typing as npt

from matchset.control.command import Command
from matchset.control.safety import SafetyParameters
from matchset.flight.chain.pilot import PilotStep
from matchset.flight.recording.encoding import outcome_of
from matchset.image.frame import Frame
from matchset.localization.pose import Pose
from matchset.shapes.circle import Circle
from matchset.tracking.track import Lost, Track


class InvariantParameters(msgspec.Struct, frozen=True, kw_only=True):
    """How much a step may deviate; all chosen by hand.

    Parameters
    ----------
    slack : float
        Time beyond that of the rules in which motors must be off, s: three periods of pictures, and rounding.
    quantum : float
        Step of a stick in the radio; what is sent is rounded to it.
    radio_delay : float
        From sending a command to its effect, s.
    failsafe : float
        Time without a command after which a vehicle stops its motors, s.
    repeated : float
        How long pictures may come again until a descent begins, s, on the clock of the pictures; the bar is 0.3.
    still : float
        Thrust of motors that were stopped `spin_down` ago, N.
    spin_down : float
        s.
    beyond_border : float
        Largest distance of an edge point from the picture, px: points are brought from their field to the mean of
        both, by half the field offset, and 5.2 px were seen at a border in a gust.
    off_outline : float
        Largest distance of the median point of a match-set from the outline, px.
    ellipticity : float
        Up to how many radii the outline may differ from its circle as an ellipse does: 30 degrees off the axis of the
        camera, at the side of the picture, a ball's outline is longer than wide by 1 / cos 30 degrees, 15 %.
    """

    slack: float = 0.15
    quantum: float = 2.0 / 250.0
    radio_delay: float = 0.03
    failsafe: float = 0.244
    repeated: float = 0.3
    still: float = 0.02
    spin_down: float = 0.6
    beyond_border: float = 16.0
    off_outline: float = 3.0
    ellipticity: float = 0.08


class Seen(NamedTuple):
    """A step of a pilot, and what somebody beside it sees.

    Attributes
    ----------
    step : PilotStep
    armed : bool
        Whether the pilot was told to fly.
    armed_again : bool
        Whether somebody has armed it since the step before.
    refused : float
        Since when the link refuses, s on the clock of the pictures; inf while it does not.
    picture : float
        When the newest picture came, s; -inf before the first.
    confirmed : float
        When the ball was last confirmed, s; -inf before.
    stopped : float
        Since when the throttle that is sent is 0, s; inf while it is not.
    throttle : float
        What the vehicle heard last.
    silent : float
        How long ago that was, s.
    thrust : float
        Of its motors, N.
    fault : str
        What the camera did to the picture.
    frozen : float
        Since when the camera repeats its last picture, s on the clock of the pictures; inf while it does not.
    hover : float
        Throttle that hovers, as far as the pilot knows.
    """

    step: PilotStep
    armed: bool
    armed_again: bool = False
    refused: float = math.inf
    picture: float = -math.inf
    confirmed: float = -math.inf
    stopped: float = math.inf
    throttle: float = 0.0
    silent: float = 0.0
    thrust: float = 0.0
    fault: str = ""
    frozen: float = math.inf
    hover: float = 0.0


class Rules(NamedTuple):
    """What the invariants compare with.

    Attributes
    ----------
    safety : SafetyParameters
        Limits of what may be sent.
    limits : InvariantParameters
    """

    safety: SafetyParameters = SafetyParameters()
    limits: InvariantParameters = InvariantParameters()


Alone = Callable[[Seen, Rules], str]
Pair = Callable[[Seen, Seen, Rules], str]


def not_a_number(seen: Seen, _rules: Rules) -> str:
    """Find NaN anywhere in what a step answers, and infinity in a track, a pose or a command."""
    outcome = msgspec.msgpack.decode(outcome_of(seen.step))
    for name, value in outcome.items():
        place = _strange(value, name, infinite=name in ("safety", "age", "control"))
        if place:
            return f"{place} is no number"
    return ""


def _strange(value: Any, path: str, infinite: bool) -> str:
    """Name the first NaN; of infinities too, unless they are allowed."""
    if isinstance(value, float):
        return path if math.isnan(value) or (math.isinf(value) and not infinite) else ""
    if isinstance(value, dict):
        pairs = [(str(key), each) for key, each in value.items()]
    elif isinstance(value, list | tuple):
        pairs = [(str(k), each) for k, each in enumerate(value)]
    else:
        return ""
    return next((found for name, each in pairs if (found := _strange(each, f"{path}.{name}", infinite))), "")


def throttle_while_disarmed(seen: Seen, _rules: Rules) -> str:
    """Demand that no throttle is sent to a vehicle that was not armed, or whose motors were stopped."""
    phase, throttle = seen.step.safety.phase, seen.step.command.throttle
    if throttle > 0.0 and (not seen.armed or phase in ("locked", "cut")):
        return f"throttle {throttle:g} while {phase}, armed {seen.armed}"
    return ""


def refusal_unnoticed(seen: Seen, _rules: Rules) -> str:
    """Demand that a refusal is noticed in the same step: phase ``cut``, with a reason, all sticks zero."""
    if not math.isfinite(seen.refused) or not seen.armed:
        return ""
    step = seen.step
    if step.safety.phase != "cut" or not step.safety.reason or step.command != Command():
        return f"the link refuses, but the phase is {step.safety.phase} and {step.command} was sent"
    return ""


def motors_on_for_too_long(seen: Seen, rules: Rules) -> str:
    """Demand that no picture, or no ball in it, ends in motors off within the times of the safety rules."""
    safety, now, throttle = rules.safety, seen.step.now, seen.step.command.throttle
    slack = safety.descent_duration + rules.limits.slack
    blind, unseen = now - seen.picture, now - seen.confirmed
    if throttle > 0.0 and blind > safety.max_frame_age + slack:
        return f"throttle {throttle:g} after {blind:.2f} s without a picture"
    if throttle > 0.0 and unseen > safety.hold_time + slack:
        return f"throttle {throttle:g} after {unseen:.2f} s without the ball"
    return ""


def frozen_picture_flown(seen: Seen, rules: Rules) -> str:
    """Demand that a descent begins soon where the same picture comes again and again."""
    since, phase = seen.picture - seen.frozen, seen.step.safety.phase
    if since > rules.limits.repeated and phase in ("flying", "holding"):
        return f"{phase} with a picture that came {since:.2f} s ago"
    return ""


def motors_turn_after_the_end(seen: Seen, rules: Rules) -> str:
    """Ask the vehicle itself: no throttle soon after a refusal or a stop, and motors at rest a while later."""
    limits, now = rules.limits, seen.step.now
    since = now - min(seen.refused, seen.stopped)
    heard = seen.silent <= limits.failsafe
    if since > limits.failsafe + limits.radio_delay + limits.slack and heard and seen.throttle > 0.0:
        return f"the vehicle hears throttle {seen.throttle:g} {since:.2f} s after its motors were stopped"
    if since > limits.failsafe + limits.spin_down and seen.thrust > limits.still:
        return f"thrust {seen.thrust:.3g} N {since:.2f} s after the motors were stopped"
    return ""


def ball_not_confirmed(seen: Seen, rules: Rules) -> str:
    """Demand that each track is confirmed by its own picture, and that a picture of noise confirms none."""
    step = seen.step
    tracks = ([step.ball] if isinstance(step.ball, Track) else []) + list(step.markers)
    if tracks and step.frame is None:
        return "a track without a picture"
    if tracks and seen.fault == "noise":
        return "a track in a picture of noise"
    for track in tracks:
        assert step.frame is not None
        wrong = track_not_confirmed(track, step.frame, rules.limits)
        if wrong:
            return wrong
    return pose_wrong(step.pose)


def track_not_confirmed(track: Track[Circle], frame: Frame, limits: InvariantParameters) -> str:
    """Demand the time of its frame, support, edge points on its outline, and a covariance of a track."""
    circle, height, width = track.shape, *frame.image.shape[:2]
    if track.time != frame.time:
        return f"a track of time {track.time} in a picture of time {frame.time}"
    if not 0.0 < track.support <= 1.0:
        return f"support {track.support}"
    if not len(track.match_set):
        return "a track without edge points"
    x, y = track.match_set.T
    left, top, right, bottom = x.min(), y.min(), width - 1 - x.max(), height - 1 - y.max()
    if not min(left, top, right, bottom) >= -limits.beyond_border:
        return f"edge points {-min(left, top, right, bottom):.2f} px outside the picture"
    off = _off_outline(circle, track.match_set, limits.ellipticity)
    if not off <= limits.off_outline:
        return f"edge points {off:.1f} px off the outline"
    wrong = covariance_wrong(track.covariance)
    return f"of a track: {wrong}" if wrong else ""


def _off_outline(circle: Circle, points: npt.NDArray[np.float64], ellipticity: float) -> float:
    """Distance of the median point from the outline, which may be an ellipse, px."""
    x, y = (points - (circle.x, circle.y)).T
    residuals, angles = np.hypot(x, y) - circle.radius, np.arctan2(y, x)
    modes = np.stack((np.cos(2.0 * angles), np.sin(2.0 * angles)), axis=1)
    bent = np.linalg.lstsq(modes, residuals, rcond=None)[0]
    bent *= min(1.0, ellipticity * circle.radius / max(float(np.hypot(*bent)), np.finfo(np.float64).tiny))
    return float(np.median(np.abs(residuals - modes @ bent)))


def covariance_wrong(covariance: npt.NDArray[np.float64]) -> str:
    """Demand of a covariance that it is finite, symmetric and positive definite."""
    if not np.isfinite(covariance).all():
        return "a covariance that is not finite"
    if not np.allclose(covariance, covariance.T, rtol=1e-9, atol=0.0):
        return "a covariance that is not symmetric"
    scale = np.sqrt(np.abs(np.diag(covariance)))
    if not scale.min() > 0.0:
        return f"a covariance with the diagonal {np.diag(covariance)}"
    least = float(np.linalg.eigvalsh(covariance / np.outer(scale, scale)).min())
    return "" if least > 0.0 else f"a covariance with the eigenvalue {least:g} of its correlations"


def pose_wrong(pose: Pose | Lost[Pose]) -> str:
    """Demand of a pose that it is finite, in front of the camera, and that rotation and covariance are such."""
    if not isinstance(pose, Pose):
        return ""
    if not np.isfinite(pose.position).all() or not pose.position[2] > 0.0:
        return f"a ball at {pose.position} m"
    turn = pose.rotation_matrix
    if turn is not None and not (np.allclose(turn @ turn.T, np.eye(3), atol=1e-6) and np.linalg.det(turn) > 0.0):
        return f"a rotation that is none: {turn}"
    wrong = covariance_wrong(pose.covariance)
    return f"of a pose: {wrong}" if wrong else ""


def rising_descent(before: Seen, seen: Seen, _rules: Rules) -> str:
    """Demand that a descent never raises the throttle."""
    was, is_now = before.step.command.throttle, seen.step.command.throttle
    if seen.step.safety.phase == "descending" and is_now > was:
        return f"a descent raises the throttle from {was:g} to {is_now:g}"
    return ""


def sticks_over_cap(before: Seen, seen: Seen, rules: Rules) -> str:
    """Demand that sticks are within their limits, and change no faster than they may."""
    safety, was, sent = rules.safety, before.step.command, seen.step.command
    quantum = rules.limits.quantum
    caps = (("roll", safety.max_tilt), ("pitch", safety.max_tilt), ("yaw", safety.max_yaw))
    passed = min(max(seen.step.now - before.step.now, safety.min_step), safety.max_step)
    change = safety.max_stick_rate * passed + quantum
    for name, cap in caps:
        value, last = getattr(sent, name), getattr(was, name)
        if abs(value) > cap + quantum:
            return f"{name} {value:g}, at most {cap:g}"
        if abs(value - last) > change and seen.step.safety.phase != "cut":
            return f"{name} from {last:g} to {value:g} in {passed:.3f} s"
    most = max(safety.max_throttle, min(safety.throttle_reserve * seen.hover, 1.0))
    if sent.throttle > most + quantum:
        return f"throttle {sent.throttle:g}, at most {most:g}"
    rise = safety.max_throttle_rate * passed + quantum
    if sent.throttle - was.throttle > rise:
        return f"throttle from {was.throttle:g} to {sent.throttle:g} in {passed:.3f} s"
    return ""


def armed_by_itself(before: Seen, seen: Seen, _rules: Rules) -> str:
    """Demand that motors that were stopped stay so until somebody arms."""
    if before.step.safety.phase == "cut" and seen.step.safety.phase != "cut" and not seen.armed_again:
        return f"from cut to {seen.step.safety.phase}, and nobody has armed"
    return ""


def time_backward(before: Seen, seen: Seen, _rules: Rules) -> str:
    """Demand that time runs forward: that of the commands, and that of the pictures."""
    if not seen.step.now > before.step.now:
        return f"a command at {seen.step.now} s after one at {before.step.now} s"
    frame = seen.step.frame
    if frame is not None and not before.picture < frame.time <= seen.step.now:
        return f"a picture of {frame.time} s at {seen.step.now} s, the one before of {before.picture} s"
    return ""


ALONE: tuple[Alone, ...] = (
    not_a_number,
    throttle_while_disarmed,
    refusal_unnoticed,
    motors_on_for_too_long,
    frozen_picture_flown,
    motors_turn_after_the_end,
    ball_not_confirmed,
)
PAIRS: tuple[Pair, ...] = (rising_descent, sticks_over_cap, armed_by_itself, time_backward)


def violation(before: Seen | None, seen: Seen, rules: Rules) -> str:
    """Say what is wrong with a step after the one before; empty if nothing is."""
    found = next((f"{rule.__name__}: {text}" for rule in ALONE if (text := rule(seen, rules))), "")
    if found or before is None:
        return found
    return next((f"{rule.__name__}: {text}" for rule in PAIRS if (text := rule(before, seen, rules))), "")
