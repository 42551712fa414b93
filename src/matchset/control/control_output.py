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
    doubt : str
        Why the place is held by the ball alone, at its distance and height but in no set direction from it, since where
        its marker points is not known; empty if it is.
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
    doubt: str = ""

    @property
    def words(self) -> str:
        """What there is to say of it; empty while all is well."""
        return "; ".join(filter(None, (self.doubt, self.gains.words)))
