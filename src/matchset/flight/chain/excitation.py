"""Small known motions of the sticks, added to those of a follower that hovers: `Excitation`."""

import math

import msgspec

from matchset.control.control_output import ControlOutput
from matchset.control.follower import RelativeSetpoint
from matchset.control.safety import DesiredCommand, SafetyState
from matchset.numeric.arguments import require, require_not_negative

# theorem: of these signs the sum and the sum of the sums are zero, so that a vehicle ends where it began, at rest
SIGNS = (1.0, -1.0, -1.0, 1.0)


class ExcitationParameters(msgspec.Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """How a vehicle is shaken to see how it answers.

    Each stick goes to and fro between two values: four pulses of one length and of the signs + - - +, then four of the
    next length. The lengths are not those of another stick, so that the answers can be told apart. A follower's own
    commands go on meanwhile. Chosen on simulated flights of seeds 0 to 29 with vehicles drawn at random, by the
    standard deviations that come out, and that the ball stays in the picture: docs/log/control.md#identify.

    Parameters
    ----------
    roll, pitch, yaw : float
        Amplitudes as shares of the full stick, 0 ... 0.5. More is found sooner and exacter; less keeps the vehicle
        closer to its place, and the ball closer to the middle of the picture.
    throttle : float
        Amplitude as a share of the throttle that the follower wants, 0 ... 0.3.
    roll_holds, pitch_holds, yaw_holds, throttle_holds : tuple of float
        Lengths of the pulses, one after the other, s. Longer ones tell of gains, shorter ones of lags; the way that the
        vehicle moves grows with their square.
    begin : float
        How long it only hovers first, s: the throttle that hovers has to be found. More is calmer, less is sooner.
    reach : float
        Farther than this off its set place, m, the sticks are not shaken. More goes on in a gust, less is safer.
    bearing : float
        So is it with the ball farther than this from straight ahead, rad.
    """

    roll: float = 0.2
    pitch: float = 0.25
    yaw: float = 0.35
    throttle: float = 0.07
    roll_holds: tuple[float, ...] = (0.17, 0.27, 0.3)
    pitch_holds: tuple[float, ...] = (0.27, 0.17, 0.2)
    yaw_holds: tuple[float, ...] = (0.2, 0.13, 0.3)
    throttle_holds: tuple[float, ...] = (0.3, 0.2, 0.24)
    begin: float = 1.2
    reach: float = 0.7
    bearing: float = 0.35

    def __post_init__(self) -> None:
        require_not_negative(self, ("roll", "pitch", "yaw", "throttle", "begin", "reach", "bearing"))
        require(self, ("roll", "pitch", "yaw"), lambda value: value <= 0.5, "within 0 ... 0.5")
        require(self, ("throttle",), lambda value: value <= 0.3, "within 0 ... 0.3")
        for name in ("roll_holds", "pitch_holds", "yaw_holds", "throttle_holds"):
            holds = getattr(self, name)
            if not holds or not all(0.03 <= each <= 2.0 for each in holds):
                raise ValueError(f"{name} must be lengths within 0.03 ... 2 s, got {holds}")


class Excitation:
    """Adds the known motions to what a follower wants, while it flies near its set place with the ball in sight.

    Parameters
    ----------
    place : RelativeSetpoint
        Where it hovers.
    parameters : ExcitationParameters, optional

    Attributes
    ----------
    shaken : float
        For how long the sticks were shaken so far, s.
    """

    def __init__(self, place: RelativeSetpoint, parameters: ExcitationParameters | None = None) -> None:
        self.parameters, self._place = parameters or ExcitationParameters(), place
        self._start, self._last, self.shaken = math.inf, math.inf, 0.0

    def __call__(self, control: ControlOutput, state: SafetyState, now: float) -> DesiredCommand:
        """Return the command to send in place of the follower's.

        Parameters
        ----------
        control : ControlOutput
            What the follower wants, and where it is.
        state : SafetyState
            Of the command before: nothing is added unless it is "flying".
        now : float
            s.
        """
        if state.phase != "flying":
            self._start = math.inf
            return control.desired
        self._start = min(self._start, now)
        since, last, self._last = now - self._start - self.parameters.begin, self._last, now
        if since < 0.0 or not self._is_near(control):
            return control.desired
        self.shaken += max(now - last, 0.0)
        return self.added(control.desired, since)

    def added(self, desired: DesiredCommand, since: float) -> DesiredCommand:
        """Return a command with what is added so many s after the first pulse."""
        p = self.parameters
        return DesiredCommand(
            desired.roll + p.roll * wave(since, p.roll_holds),
            desired.pitch + p.pitch * wave(since, p.pitch_holds),
            desired.yaw + p.yaw * wave(since, p.yaw_holds),
            desired.throttle * (1.0 + p.throttle * wave(since, p.throttle_holds)),
        )

    def _is_near(self, control: ControlOutput) -> bool:
        place, parameters = self._place, self.parameters
        away = (control.side - place.side, control.height - place.height, control.heading - place.heading)
        return math.hypot(*away) <= parameters.reach and abs(control.bearing) <= parameters.bearing


def wave(time: float, holds: tuple[float, ...]) -> float:
    """Sign of the pulse at a time, s: -1 or 1; four pulses of each length, one length after the other."""
    rest = time % (len(SIGNS) * sum(holds))
    for hold in holds:
        if rest < len(SIGNS) * hold:
            return SIGNS[min(int(rest / hold), len(SIGNS) - 1)]
        rest -= len(SIGNS) * hold
    return SIGNS[0]
