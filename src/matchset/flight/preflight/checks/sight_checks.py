"""Does a follower at rest see its neighbor well enough, and soon enough? Pure checks of the steps of a dry run."""

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from matchset.flight.chain.pilot import PilotParameters, PilotStep
from matchset.flight.preflight.outcome import CheckOutcome, judged
from matchset.flight.preflight.parameters import PreflightParameters
from matchset.flight.preflight.would_be import would_be
from matchset.flight.report.step_text import distance_to_set_place
from matchset.localization.pose import Pose
from matchset.tracking.track import Track

Floats = npt.NDArray[np.float64]
MILLI, CENTI = 1e-3, 1e-2  # format: s of a ms, m of a cm
MOST = 99.0  # format: percentile that is meant by "99 of 100"
SECOND_DIFFERENCE = math.sqrt(6.0)  # theorem: standard deviation of a - 2 b + c, in that of each


class CheckContext(NamedTuple):
    """What the checks must know besides the steps.

    Attributes
    ----------
    pilot : PilotParameters
        What the follower was told.
    rate : float
        Pictures a second, as they were counted.
    stamped : bool
        Whether times of the pictures are those of the capture, or the way of a picture was told.
    """

    pilot: PilotParameters
    rate: float
    stamped: bool


def sight_checks(steps: Sequence[PilotStep], told: CheckContext, parameters: PreflightParameters) -> list[CheckOutcome]:
    """Check what a follower saw while it was held at its set place.

    Parameters
    ----------
    steps : sequence of PilotStep
    told : CheckContext
    parameters : PreflightParameters

    Returns
    -------
    list of CheckOutcome
        In order; those after one that failed may make no sense.
    """
    seen = [step for step in steps if step.frame is not None]
    poses = [step.pose for step in seen if isinstance(step.pose, Pose)]
    found = [_ball(seen, parameters)]
    if found[0].is_failed or not poses:
        return found
    found += [_distance(poses, told.pilot, parameters), _marker(seen, parameters)]
    turned = [pose for pose in poses if pose.rotation_matrix is not None]
    return [*found, _noise(poses, parameters), *([_yaw_noise(turned, parameters)] if turned else [])]


def time_checks(steps: Sequence[PilotStep], told: CheckContext, parameters: PreflightParameters) -> list[CheckOutcome]:
    """Check how old pictures are when their commands leave, and how long computing takes.

    Parameters
    ----------
    steps : sequence of PilotStep
    told : CheckContext
    parameters : PreflightParameters
    """
    return [_age(steps, told), _processing(steps, told, parameters)]


def dry_run_check(steps: Sequence[PilotStep], told: CheckContext, parameters: PreflightParameters) -> CheckOutcome:
    """Check that it would have flown, and how far off its place it would have begun.

    Parameters
    ----------
    steps : sequence of PilotStep
    told : CheckContext
    parameters : PreflightParameters
    """
    armed = steps[1:]  # a pilot is armed after its first step
    flying = sum(step.safety.phase == "flying" for step in armed) / max(len(armed), 1)
    offs = [off for step in steps if (off := distance_to_set_place(step.control, told.pilot.place)) is not None]
    off = float(np.median(offs)) if offs else math.inf
    last = next((step.control for step in reversed(steps) if step.control is not None), None)
    sticks = "nothing" if last is None else would_be(last, told.pilot.follower).words
    reason = next((step.safety.reason for step in reversed(steps) if step.safety.phase != "flying"), "")
    return judged(
        "dry run: would fly",
        f"flying in {parameters.least_seen:.0%} of the steps, at most {parameters.most_off / CENTI:.0f} cm off",
        f"flying in {flying:.0%}, {off / CENTI:.0f} cm off; in the air it would send {sticks}",
        flying >= parameters.least_seen and off <= parameters.most_off,
        f"hold it at its set place: ahead of the marker, as [flight.pilot.place] says{'; ' * bool(reason)}{reason}",
    )


def _ball(seen: Sequence[PilotStep], parameters: PreflightParameters) -> CheckOutcome:
    tracked = sum(isinstance(step.ball, Track) for step in seen)
    share = tracked / len(seen) if seen else 0.0
    lost = next((step.ball.reason for step in reversed(seen) if not isinstance(step.ball, Track)), "no picture came")
    return judged(
        "ball: tracked",
        f"in at least {parameters.least_seen:.0%} of the pictures",
        f"{share:.1%} of {len(seen)} pictures",
        share >= parameters.least_seen,
        f"{lost}. Hang it up before the vehicle at its set place; learn its color in this light: 'matchset learn'",
    )


def _distance(poses: Sequence[Pose], pilot: PilotParameters, parameters: PreflightParameters) -> CheckOutcome:
    place = pilot.place
    wanted = math.hypot(place.side, place.height, place.heading)
    distance = float(np.median([pose.distance for pose in poses]))
    error = distance / wanted - 1.0
    return judged(
        "ball: distance",
        f"{wanted:.2f} m, within {parameters.distance_error:.0%}",
        f"{distance:.2f} m, {error:+.1%}",
        abs(error) <= parameters.distance_error,
        "hold it at its set place, by a tape; if it is there: the diameter ([flight.pilot.target], --diameter) or the "
        "camera file is wrong",
    )


def _marker(seen: Sequence[PilotStep], parameters: PreflightParameters) -> CheckOutcome:
    known = sum(isinstance(step.pose, Pose) and step.pose.rotation_matrix is not None for step in seen) / len(seen)
    return judged(
        "marker: seen, yaw known",
        f"in at least {parameters.least_marker:.0%} of the pictures",
        f"{known:.1%}",
        known >= parameters.least_marker,
        "turn the ball so that its marker faces the camera; learn its color: 'matchset learn ... --marker'",
    )


def _noise(poses: Sequence[Pose], parameters: PreflightParameters) -> CheckOutcome:
    noise = noise_of(np.array([pose.position for pose in poses]))
    return judged(
        "pose: noise",
        f"at most {parameters.most_noise / MILLI:.0f} mm from picture to picture",
        f"{noise / MILLI:.1f} mm",
        noise <= parameters.most_noise,
        "hold it still; more light, a cleaner picture, a larger ball or a nearer place",
    )


def _yaw_noise(poses: Sequence[Pose], parameters: PreflightParameters) -> CheckOutcome:
    facing = np.array([np.asarray(pose.rotation_matrix)[:, 2] for pose in poses])
    noise = noise_of(np.unwrap(np.arctan2(facing[:, 0], -facing[:, 2]))[:, np.newaxis])
    return judged(
        "marker: noise",
        f"at most {math.degrees(parameters.most_yaw_noise):.1f} degrees from picture to picture",
        f"{math.degrees(noise):.2f} degrees",
        noise <= parameters.most_yaw_noise,
        "hold it still; more light, a larger marker, one of another color",
    )


def noise_of(values: Floats) -> float:
    """Return the noise from one value to the next, standard deviation of the worst column; slow motion does not count.

    Parameters
    ----------
    values : ndarray of shape (n, k)
        In order.
    """
    if len(values) < 3:
        return 0.0
    bends = values[:-2] - 2.0 * values[1:-1] + values[2:]
    return float(np.sqrt(np.mean(bends * bends, axis=0)).max()) / SECOND_DIFFERENCE


def _age(steps: Sequence[PilotStep], told: CheckContext) -> CheckOutcome:
    follower = told.pilot.follower
    radio, most = follower.ego_motion.delay, follower.gain_schedule.longest_delay
    ages = [step.age for step in steps if math.isfinite(step.age)]
    age = float(np.percentile(ages, MOST)) if ages else math.inf
    name = "age: picture to effect"
    wanted = f"at most {most / MILLI:.0f} ms in 99 of 100, {radio / MILLI:.0f} ms of them told for the radio"
    if not told.stamped:
        advice = (
            "nothing stamps these pictures: photograph a clock beside its picture on the screen, and tell the "
            "difference (--delay-ms, delay_ms)"
        )
        return judged(name, wanted, f"{(age + radio) / MILLI:.0f} ms since its arrival", False, advice)
    advice = "a faster camera or grabber, fewer buffers; 'matchset identify' finds the delay of the radio"
    return judged(name, wanted, f"{(age + radio) / MILLI:.0f} ms", age + radio <= most, advice)


def _processing(steps: Sequence[PilotStep], told: CheckContext, parameters: PreflightParameters) -> CheckOutcome:
    times = [step.processing for step in steps if step.frame is not None]
    most = parameters.busy / told.rate if told.rate else 0.0
    took = float(np.percentile(times, MOST)) if times else math.inf
    return judged(
        "computing: in time",
        f"at most {most / MILLI:.1f} ms in 99 of 100 pictures",
        f"{took / MILLI:.1f} ms",
        took <= most,
        "end other programs, plug the computer in, take smaller pictures",
    )
