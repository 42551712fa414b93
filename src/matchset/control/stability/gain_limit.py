"""Gains by their margins, and by the swings that are seen: `GainLimit`.

Two things lower the gains of a loop. *Margins*: once a second gain and phase margin of each loop are computed from the
gains in use, and from the delay and the filter as this flight has them (`loop.py`); the largest factor up to 1 that
keeps both counts. *Swings*: a stick that goes from side to side again and again (`oscillation.py`) says that the
vehicle is not as the model of those margins; each time its loop's factor falls by a share, and slowly recovers. The
lower of both counts. P, I and D are lowered by the same factor (`lowered`).
"""

from typing import NamedTuple

import msgspec
import numpy as np
import numpy.typing as npt

from matchset.control.chain.gain_schedule import Gains
from matchset.control.pid import PidParameters
from matchset.control.safety import DesiredCommand
from matchset.control.stability.follower_loops import (
    LEVEL,
    LOOPS,
    RISE,
    YAW,
    FollowerLoops,
    LoopConditions,
    LoopParameters,
    lowered,
)
from matchset.control.stability.loop import Timing
from matchset.control.stability.margins import Margins, margins_of
from matchset.control.stability.oscillation import Oscillation, SwingLimits
from matchset.numeric.arguments import require_at_least, require_not_negative, require_positive, require_share

Floats = npt.NDArray[np.float64]

# format: in words, a swing of each stick of `DesiredCommand`, and the loop whose gains it lowers
STICKS = (("to the side", LEVEL), ("to and fro", LEVEL), ("in yaw", YAW), ("up and down", RISE))
GAP = 1.5  # format: times between two pictures, over that between two commands, from which on there was a gap
FACTORS = tuple(np.linspace(0.05, 1.0, 39).tolist())  # format: factors that are tried for the margins


class StabilityParameters(msgspec.Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """When gains are lowered, and by how much.

    Sizes of swings were chosen on flights without pictures, seeds 110 to 137: nominal and in gusts, which swing less,
    and gains 1.5 times as high, also with a tilt 25 % larger than told, which swing more (decision 133).

    Parameters
    ----------
    enabled : bool
        Whether gains are lowered, and margins computed, at all.
    gain_margin_db : float
        Least gain margin, dB. More is farther from oscillating, and follows less closely.
    phase_margin_deg : float
        Least phase margin, degrees. More is calmer, and follows less closely.
    delay_uncertainty : float
        How much later than believed a command may show in the margins, s: what nobody knows of a delay. More lowers
        gains sooner. Chosen by hand: half a picture.
    stick_swing : float
        Least swing of roll and pitch that counts, from one turning point to the next, as a multiple of the largest
        stick: 2 is from stop to stop. Less notices sooner, and takes gusts for it.
    throttle_swing : float
        The same of the throttle, 0 ... 1.
    yaw_swing : float
        The same of the yaw stick.
    lowered_swing_ratio : float
        Share of these swings that counts once the gains of a loop are lowered, 0 ... 1. Less damps what is left of an
        oscillation, and keeps gains low in gusts.
    swing_count : int
        So many in a row are an oscillation. More is surer, and half a period later each.
    max_half_period : float
        Longest swing, half a period, s. More also takes slow motion for it.
    turning_ratio : float
        Share of such a swing by which a stick must come back to have turned, 0 ... 1.
    lowering_factor : float
        Factor of the gains each time, 0 ... 1. Less damps sooner, and follows less closely.
    min_factor : float
        Least factor that swings lead to, 0 ... 1.
    recovery_time : float
        Time in which a factor would go from 0 to 1 again, s. Less swings again sooner, if they are still too high.
    settling_time : float
        Time after lift-off in which nothing is noticed and no margins count, s: taking off swings the sticks.
    period : float
        From one computation of all margins to the next, s; each loop has a picture of its own.
    averaging_time : float
        Time constant of the means of age and filter, s. More is calmer.
    """

    enabled: bool = True
    gain_margin_db: float = 6.0
    phase_margin_deg: float = 40.0
    delay_uncertainty: float = 1.0 / 60.0
    stick_swing: float = 1.8
    throttle_swing: float = 0.55
    yaw_swing: float = 0.8
    lowered_swing_ratio: float = 0.7
    swing_count: int = 3
    max_half_period: float = 0.5
    turning_ratio: float = 0.15
    lowering_factor: float = 0.7
    min_factor: float = 0.35
    recovery_time: float = 120.0
    settling_time: float = 3.0
    period: float = 1.0
    averaging_time: float = 2.0

    def __post_init__(self) -> None:
        require_not_negative(self, ("gain_margin_db", "phase_margin_deg", "delay_uncertainty", "settling_time"))
        require_positive(
            self,
            ("stick_swing", "throttle_swing", "yaw_swing", "max_half_period", "recovery_time", "lowered_swing_ratio"),
        )
        require_positive(self, ("period", "averaging_time", "lowering_factor", "min_factor"))
        require_share(self, ("lowered_swing_ratio", "turning_ratio", "lowering_factor", "min_factor"))
        require_at_least(self, 2, "swing_count")


class GainsInUse(NamedTuple):
    """What there is to say of a follower's gains.

    Attributes
    ----------
    factors : tuple of float
        Of the gains of level, height and yaw loop, 0 ... 1.
    margins : tuple of (float, float) or None
        Gain margin, dB, and phase margin, degrees, of each loop with these gains, rounded to 0.1 and to 1. None before
        they are known, inf where nothing limits them.
    words : str
        Why gains are lowered: ``swings to the side: gains lowered to 70 %``. Empty if none are.
    """

    factors: tuple[float, ...] = (1.0, 1.0, 1.0)
    margins: tuple[tuple[float, float] | None, ...] = (None, None, None)
    words: str = ""


class _LoopState:
    """Of one loop: the factor that its margins allow, the one that swings have left, which these were, its margins."""

    def __init__(self) -> None:
        self.allowed = self.left = 1.0
        self.swung = ""
        self.margins: tuple[float, float] | None = None

    @property
    def factor(self) -> float:
        return min(self.allowed, self.left)

    def words(self, name: str) -> str:
        if self.factor >= 1.0:
            return ""
        why = f"swings {self.swung}" if self.left <= self.allowed else f"too little margin of the {name} loop"
        return f"{why}: gains lowered to {100.0 * self.factor:.0f} %"


class GainLimit:
    """Lowers the gains of a follower where their margins or its swings ask for it.

    Parameters
    ----------
    loops : LoopParameters
    parameters : StabilityParameters, optional

    Attributes
    ----------
    state : GainsInUse
        Now.
    """

    def __init__(self, loops: LoopParameters, parameters: StabilityParameters | None = None) -> None:
        self.parameters = limits = parameters or StabilityParameters()
        self.loops, self.state = FollowerLoops(loops), GainsInUse()
        sizes = limits.stick_swing, limits.stick_swing, limits.yaw_swing, limits.throttle_swing
        swings = limits.swing_count, limits.max_half_period, limits.turning_ratio
        self._limits = [SwingLimits(size, *swings) for size in sizes]
        self._sticks = [Oscillation(each) for each in self._limits]
        self._states = {name: _LoopState() for name in LOOPS}
        self._filter_gains = np.zeros((3, 5))
        self._age = self._step = self._known = self._waited = 0.0
        self._turn, self._flies = 0, False

    def horizontal(self, pid: PidParameters) -> PidParameters:
        """Return the gains of the level loop as they are in use; the same object while they are not lowered."""
        return lowered(pid, self._states[LEVEL].factor)

    def vertical(self, pid: PidParameters) -> PidParameters:
        """Return the same of the height loop."""
        return lowered(pid, self._states[RISE].factor)

    def yaw(self, pid: PidParameters) -> PidParameters:
        """Return the same of the yaw loop."""
        return lowered(pid, self._states[YAW].factor)

    def note_filter(self, filter_gains: Floats, age: float, step: float) -> None:
        """Note an accepted picture.

        Parameters
        ----------
        filter_gains : ndarray of shape (3, 5)
            By which the neighbor's filter corrected x, y and z.
        age : float
            From its stamp to the sending of the command that answers it, s.
        step : float
            Since the picture before, s; after a gap the filter corrects by more, which is not how it flies.
        """
        if not step <= GAP * self._step:
            return
        self._known += step
        share = step / min(self._known, self.parameters.averaging_time)
        self._filter_gains += share * (filter_gains - self._filter_gains)
        self._age += share * (age - self._age)

    def note_sticks(self, sticks: DesiredCommand, most: float, now: float, step: float, airborne_time: float) -> None:
        """Note what the controllers want, and lower the gains of a loop that swings.

        Parameters
        ----------
        sticks : DesiredCommand
        most : float
            Largest roll and pitch stick; 0 before lift-off.
        now : float
            When it acts, s.
        step : float
            Time since the last ones, s.
        airborne_time : float
            Time since lift-off, s.
        """
        limits = self.parameters
        if not limits.enabled:
            return
        self._flies = airborne_time >= limits.settling_time
        for state in self._states.values():
            state.left = min(state.left + step / limits.recovery_time, 1.0)
        values = sticks.roll / most if most else 0.0, sticks.pitch / most if most else 0.0, sticks.yaw, sticks.throttle
        for stick, whole, value, (words, name) in zip(self._sticks, self._limits, values, STICKS, strict=True):
            state = self._states[name]
            stick.limits = whole if state.left == 1.0 else whole._replace(size=limits.lowered_swing_ratio * whole.size)
            if not self._flies:
                stick.reset()
            elif stick.update(value, now):
                state.left, state.swung = (
                    min(max(limits.lowering_factor * state.factor, limits.min_factor), state.left),
                    words,
                )
                stick.reset()
        self._say()

    def check(self, gains: Gains, delay: float, thrust_sigma: float, step: float) -> None:
        """Compute the margins of one loop in flight, if it is time: first those of level, then height, then yaw.

        Parameters
        ----------
        gains : Gains
            That the schedule has chosen.
        delay : float
            From sending a command to its first effect, as it is believed, s.
        thrust_sigma : float
            Standard deviation of the thrust per throttle, as a share.
        step : float
            Since the last call, s.
        """
        limits, self._waited = self.parameters, self._waited + step
        self._step += (step - self._step) * step / (limits.averaging_time + step) if self._step else step
        if not self._flies or self._waited < limits.period / len(LOOPS) or self._known < limits.averaging_time:
            return
        self._waited, name = 0.0, LOOPS[self._turn]
        self._turn = (self._turn + 1) % len(LOOPS)
        reach = self.loops.parameters.max_extrapolation
        timing = Timing(self._step, self._age, delay, limits.delay_uncertainty, reach)
        conditions = LoopConditions(gains, timing, self._filter_gains, 1.0 + thrust_sigma)
        state = self._states[name]
        state.allowed, margins = self._allowed(name, conditions)
        if state.factor < state.allowed:
            margins = self._margins(name, conditions, state.factor)
        state.margins = round(margins.gain_db, 1), round(margins.phase_deg, 0)
        self._say()

    def _margins(self, name: str, conditions: LoopConditions, factor: float) -> Margins:
        """Margins of a loop, by how much all of its gains may be raised."""
        loop = self.loops.loop(name, conditions, factor)
        return margins_of(loop.frequencies, loop.at_gains)

    def _allowed(self, name: str, conditions: LoopConditions) -> tuple[float, Margins]:
        """Find the largest of `FACTORS` that keeps both margins, by bisection, and the margins.

        Where none does, it is not the gains that are wrong: they stay.
        """
        limits, low, high = self.parameters, 0, len(FACTORS) - 1
        best, middle = None, high
        while high >= low:
            margins = self._margins(name, conditions, FACTORS[middle])
            if margins.gain_db >= limits.gain_margin_db and margins.phase_deg >= limits.phase_margin_deg:
                best, low = (FACTORS[middle], margins), middle + 1
            else:
                high = middle - 1
            middle = (low + high + 1) // 2
        return best or (1.0, self._margins(name, conditions, 1.0))

    def _say(self) -> None:
        """Put factors, margins and words together."""
        states = self._states.items()
        words = "; ".join(filter(None, (state.words(name) for name, state in states)))
        self.state = GainsInUse(
            tuple(state.factor for _, state in states), tuple(state.margins for _, state in states), words
        )
