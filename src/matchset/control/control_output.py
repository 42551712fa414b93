"""What a follower computes at a moment: `ControlOutput`."""

from typing import NamedTuple

from matchset.control.pid import PidTerms
from matchset.control.safety import DesiredCommand
from matchset.control.stability.gain_limit import GainsInUse


class ControlOutput(NamedTuple):
    """What a follower computes at a moment.

    Attributes
    ----------
    desired : DesiredCommand
    side, height, heading : float
        Its position in the level frame of the neighbor's ball when the command acts, m.
    bearing : float
        Angle of the ball to the right of straight ahead, rad.
    right, forward, up, yaw : PidTerms
        Of the controllers.
    gains : GainsInUse
        By how much their gains are lowered, why, and their margins.
    """

    desired: DesiredCommand
    side: float
    height: float
    heading: float
    bearing: float
    right: PidTerms
    forward: PidTerms
    up: PidTerms
    yaw: PidTerms
    gains: GainsInUse = GainsInUse()
