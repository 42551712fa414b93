"""The sticks that a follower would send if it were in the air: `would_be`.

In a dry run nothing lifts, so a follower keeps its sticks in the middle: in a hand its integrals would wind up. What
its controllers want is known all the same, and that is what a person has to see before the first flight.
"""

from collections.abc import Sequence
from typing import NamedTuple

from matchset.control.command import clip
from matchset.control.control_output import ControlOutput
from matchset.control.follower import FollowerParameters
from matchset.control.sticks.kinds import sticks_for
from matchset.flight.chain.pilot import PilotStep


class WouldBe(NamedTuple):
    """Sticks, -1 ... 1, and the throttle as what is added to that of hovering, as a share of it.

    Attributes
    ----------
    roll, pitch, yaw, throttle : float
    """

    roll: float
    pitch: float
    yaw: float
    throttle: float

    @property
    def words(self) -> str:
        """For people: ``roll +0.05 pitch -0.02 yaw +0.00, throttle +1 % of hovering``."""
        sticks = " ".join(f"{name} {getattr(self, name):+.2f}" for name in ("roll", "pitch", "yaw"))
        return f"{sticks}, throttle {self.throttle:+.0%} of hovering"


def would_be(control: ControlOutput, parameters: FollowerParameters) -> WouldBe:
    """Turn what the controllers want into sticks.

    Parameters
    ----------
    control : ControlOutput
    parameters : FollowerParameters
        What full sticks do; as in use.
    """
    sticks = sticks_for(parameters.ego_motion, parameters.min_tilt_cosine)
    roll, pitch = (clip(sticks.horizontal(terms.output), -1.0, 1.0) for terms in (control.right, control.forward))
    yaw = clip(control.yaw.output / parameters.ego_motion.full_yaw_rate, -1.0, 1.0)
    return WouldBe(roll, pitch, yaw, sticks.vertical(control.up.output))


def sticks_of(steps: Sequence[PilotStep], parameters: FollowerParameters) -> list[WouldBe]:
    """Return the sticks of all steps in which the neighbor was known.

    Parameters
    ----------
    steps : sequence of PilotStep
    parameters : FollowerParameters
    """
    return [would_be(step.control, parameters) for step in steps if step.control is not None]
