"""What one turn of a follower's loop says to a person, in words."""

import math

from matchset.app.flight.pilot import PilotStep
from matchset.control.follower import ControlOutput, RelativeSetpoint
from matchset.localization.pose import Pose


def state_text(step: PilotStep) -> str:
    """Say the phase of the safety, and why it is not plain flying: ``holding: the ball is not seen``."""
    memory = step.safety
    return f"{memory.phase}: {memory.reason}" if memory.reason and memory.phase != "flying" else memory.phase


def position_text(control: ControlOutput | None) -> str:
    """Say where the follower is beside its neighbor: ``side +0.01   height -0.19   heading +1.50 m``."""
    if control is None:
        return "place not known"
    return f"side {control.side:+z.2f}   height {control.height:+z.2f}   heading {control.heading:+z.2f} m"


def distance_text(step: PilotStep) -> str:
    """Say how far the ball is: ``1.51 m``; ``-`` where it is not known."""
    return f"{step.pose.distance:.2f} m" if isinstance(step.pose, Pose) else "-"


def age_text(age: float) -> str:
    """Say how old what was acted on is: ``67 ms``; ``-`` before the first picture."""
    return f"{1000.0 * age:.0f} ms" if math.isfinite(age) else "-"


def distance_to_set_place(control: ControlOutput | None, place: RelativeSetpoint) -> float | None:
    """How far the follower believes to be from its set place, m."""
    if control is None:
        return None
    return math.hypot(control.side - place.side, control.height - place.height, control.heading - place.heading)
