"""Parameters of a follower whose vehicle is told speeds: `SpeedParameters`."""

from typing import Any

import msgspec

from matchset.control.command import HOLD
from matchset.control.feedforward import FeedforwardParameters
from matchset.control.pid import PidParameters
from matchset.numeric.arguments import require_not_negative, require_share


class SpeedParameters(msgspec.Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """What takes the place of the parameters of the same names of a follower.

    Chosen on flights without pictures of seeds 0 to 4, then lowered until vehicles that take 0.25 to 0.7 s to
    another speed, told 0.4, stay in the air, since nobody has measured one: docs/log/control.md#told-speeds.

    Parameters
    ----------
    horizontal, vertical : PidParameters
        From m to m/s, for both level axes, and upward. The neighbor's speed is flown besides, so the proportional gain
        alone comes to rest at the set place; the derivative, of the difference of the speeds, has no unit and makes up
        for the vehicle's own lag. More of both holds tighter, until the delay makes it swing. There is no integral: a
        speed that the vehicle flies with sticks in the middle looks like the neighbor's, backward, and is flown against
        at once.
    horizontal_lead, vertical_lead : float
        Time from the first to the full effect of a command, s, for which places and speeds are predicted. More is
        calmer, until the prediction fails.
    oscillation_feedforward, drift_feedforward : float
        Shares of the setpoint's accelerations whose speed at the end of the lag is told at once, 0 ... 1. More follows
        closer, and passes it on to the next of the chain.
    horizontal_feedforward, vertical_feedforward : FeedforwardParameters
        Feedforward of the neighbor's speed.
    max_stick : float
        Largest roll and pitch stick, 0 ... 1. Less is a slower vehicle, which a neighbor may leave behind.
    takeoff_duration : float
        How long the vehicle takes off by itself, s: sticks do not count before. More waits longer; less begins to learn
        trims while it still climbs. A Tello takes about 5 s; the simulated one begins in a hand and takes none.
    """

    horizontal: PidParameters = PidParameters(
        proportional=1.6, derivative=0.4, derivative_filter_time=0.033, max_error=0.5, output_limit=0.9
    )
    vertical: PidParameters = PidParameters(
        proportional=1.2, derivative=0.4, derivative_filter_time=0.033, output_limit=0.8
    )
    horizontal_lead: float = 0.2
    vertical_lead: float = 0.1
    oscillation_feedforward: float = 0.85
    drift_feedforward: float = 0.45
    horizontal_feedforward: FeedforwardParameters = FeedforwardParameters(high_frequency_gain=0.5, crossover_time=0.6)
    vertical_feedforward: FeedforwardParameters = FeedforwardParameters(high_frequency_gain=0.2, crossover_time=1.0)
    max_stick: float = 1.0
    takeoff_duration: float = 0.0

    def __post_init__(self) -> None:
        require_share(self, ("max_stick", "oscillation_feedforward", "drift_feedforward"))
        require_not_negative(self, ("horizontal_lead", "vertical_lead", "takeoff_duration"))

    def changes(self, follower: Any) -> dict[str, Any]:
        """Return what is otherwise in the parameters of a follower whose vehicle is told speeds.

        Parameters
        ----------
        follower : FollowerParameters
        """
        changed: dict[str, Any] = {
            name: getattr(self, name) for name in self.__struct_fields__ if name in follower.__struct_fields__
        }
        return changed | {
            "hover_throttle": HOLD,
            "gain_schedule": msgspec.structs.replace(follower.gain_schedule, weight=0.0),
            "ego_motion": msgspec.structs.replace(follower.ego_motion, speed_commands=True),
        }
