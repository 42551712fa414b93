"""One step of a follower's loop as text, for the view on the terminal and for the video."""

import math

from matchset.control.control_output import ControlOutput
from matchset.control.follower import RelativeSetpoint
from matchset.flight.chain.pilot import PilotStep
from matchset.localization.pose import Pose


def state_text(step: PilotStep) -> str:
    """Phase of the safety filter, with what there is to say: ``holding: the ball is not seen``, `reason_text`."""
    phase, reason = step.safety.phase, reason_text(step)
    return f"{phase}: {reason}" if reason else phase


def reason_text(step: PilotStep) -> str:
    """Why it is not ``flying``, or, if it is, why its gains are lowered; empty if they are not."""
    if step.safety.phase != "flying":
        return step.safety.reason
    return step.control.words if step.control is not None else ""


def position_text(control: ControlOutput | None) -> str:
    """Estimated position of the follower beside its neighbor: ``side +0.01   height -0.19   heading +1.50 m``."""
    if control is None:
        return "place not known"
    return f"side {control.side:+z.2f}   height {control.height:+z.2f}   heading {control.heading:+z.2f} m"


def distance_text(step: PilotStep) -> str:
    """Distance of the ball: ``1.51 m``; ``-`` where it is not known."""
    return f"{step.pose.distance:.2f} m" if isinstance(step.pose, Pose) else "-"


def age_text(age: float) -> str:
    """Age of the picture when its command was sent: ``67 ms``; ``-`` before the first picture."""
    return f"{1000.0 * age:.0f} ms" if math.isfinite(age) else "-"


def unsent_text(step: PilotStep) -> str:
    """Say what a dry run would have sent: ``would send roll +0.02 pitch -0.10 yaw +0.00 throttle 0.59``."""
    sticks = step.safety.command
    return f"would send roll {sticks.roll:+z.2f} pitch {sticks.pitch:+z.2f} yaw {sticks.yaw:+z.2f} " + (
        f"throttle {sticks.throttle:.2f}"
    )


def distance_to_set_place(control: ControlOutput | None, place: RelativeSetpoint) -> float | None:
    """Estimated distance of the follower from its set place, m; None where it is not known."""
    if control is None:
        return None
    return math.hypot(control.side - place.side, control.height - place.height, control.heading - place.heading)
