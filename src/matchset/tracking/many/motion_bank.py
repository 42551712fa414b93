"""How several targets move: Kalman filters of constant velocity and of free flight, all at once (`MotionBank`)."""

import math
from collections.abc import Sequence
from typing import NamedTuple

import msgspec
import numpy as np
import numpy.typing as npt

from matchset.tracking.motion import Gate

Floats = npt.NDArray[np.float64]
Indices = npt.NDArray[np.intp]

STEADY, BALLISTIC, HALTED = range(3)  # format: models of motion; the last has no filter of its own
ORDERS = 3  # format: position, velocity and acceleration of each axis
TINY = 1e-9  # format: a probability of nearly nothing, whose logarithm is a number


class ManyMotionParameters(msgspec.Struct, frozen=True, kw_only=True):
    """How targets are expected to move; lengths in half-widths of the target.

    All chosen on rendered crowds, seeds 7 and 8 (docs/log/many.md); `python -m benchmarks.crowds` would show a change.

    Parameters
    ----------
    acceleration : float
        Standard deviation of the acceleration of a target of constant velocity, half-widths/s^2: more follows sudden
        turns, less tells crossing targets apart for longer.
    jerk : float
        The same of the change of the acceleration of a thrown one, half-widths/s^3.
    start_speed, start_acceleration : float
        Standard deviations of what is not known of a new target, half-widths/s and half-widths/s^2.
    memory : float
        Share of the log-likelihood of a model that is kept from frame to frame: less changes models sooner.
    changes : float
        Probability that a target moves otherwise than it did.
    steady_first : int
        Sightings before free flight is considered: an acceleration is not known sooner.
    center_sigma_px, center_sigma : float
        Standard deviation of a sighting's center beside its own covariance: px, and in half-widths.
    halts_within : float
        Mean time within which a target that is not seen has come to rest, or was caught, s.
    drift : float
        How far one at rest moves meanwhile, half-widths per root of s.
    size_sigma, size_rate : float
        Standard deviation of ln(half-width) of a sighting, and of its change, 1/s.
    size_gain : float
        Share of a new ln(half-width) that is taken over.
    """

    acceleration: float = 40.0
    jerk: float = 150.0
    start_speed: float = 30.0
    start_acceleration: float = 70.0
    memory: float = 0.9
    changes: float = 0.05
    steady_first: int = 6
    center_sigma_px: float = 0.5
    center_sigma: float = 0.05
    halts_within: float = 1.0
    drift: float = 3.0
    size_sigma: float = 0.06
    size_rate: float = 0.5
    size_gain: float = 0.3

    @property
    def center_sigmas(self) -> tuple[float, float]:
        """Of a sighting's center: px, and half-widths."""
        return self.center_sigma_px, self.center_sigma


class Predicted(NamedTuple):
    """Where targets are expected, slot by slot.

    Attributes
    ----------
    centers, velocities : ndarray of shape (n, models, 2), float64
        px, px/s.
    variances : ndarray of shape (n, models), float64
        Of each coordinate of a center, px^2.
    log_weights : ndarray of shape (n, models), float64
        Log-probabilities of the models.
    half_widths, size_variances : ndarray of shape (n,), float64
        px; of ln(half-width).
    """

    centers: Floats
    velocities: Floats
    variances: Floats
    log_weights: Floats
    half_widths: Floats
    size_variances: Floats

    def likeliest(self, slot: int) -> tuple[Gate, tuple[float, float]]:
        """Place and velocity of a slot by its likeliest model; px, px/s."""
        model = int(self.log_weights[slot].argmax())
        (x, y), (vx, vy) = self.centers[slot, model].tolist(), self.velocities[slot, model].tolist()
        return Gate(x, y, float(self.half_widths[slot])), (vx, vy)


class MotionBank:
    """Filters in slots, which are given out and taken back.

    Parameters
    ----------
    slots : int
        How many there are at first; there are as many as are asked for.
    limits : ManyMotionParameters
    """

    def __init__(self, slots: int, limits: ManyMotionParameters) -> None:
        self.limits = limits
        self._state = np.zeros((slots, 2, ORDERS, 2))
        self._covariance = np.tile(np.eye(ORDERS), (slots, 2, 1, 1))
        self._scores = np.zeros((slots, 2))
        self._size, self._sightings, self._time = np.zeros(slots), np.zeros(slots), np.zeros(slots)
        self._free = list(range(slots))[::-1]

    def begin(self, place: Gate, time: float) -> int:
        """Begin at a place of which nothing else is known, at a time, s; return the slot."""
        slot, limits = self._take(), self.limits
        self._state[slot] = 0.0
        self._state[slot, :, 0] = place.x, place.y
        sigmas = np.array((1.0, limits.start_speed, limits.start_acceleration)) * place.half_width
        sigmas[0] = limits.center_sigma_px + limits.center_sigma * place.half_width
        self._covariance[slot] = np.diag(sigmas**2)
        self._covariance[slot, STEADY, 2] = 0.0
        self._scores[slot], self._size[slot] = 0.0, math.log(place.half_width)
        self._sightings[slot], self._time[slot] = 1.0, time
        return slot

    def copied(self, source: int) -> int:
        """Return a slot that is as another one."""
        slot = self._take()
        for each in (self._state, self._covariance, self._scores, self._size, self._sightings, self._time):
            each[slot] = each[source]
        return slot

    def free(self, slot: int) -> None:
        """Take a slot back."""
        self._free.append(slot)

    def _take(self) -> int:
        if not self._free:
            slots = len(self._size)
            for name in ("_state", "_covariance", "_scores", "_size", "_sightings", "_time"):
                setattr(self, name, np.concatenate((getattr(self, name), getattr(self, name))))
            self._free = list(range(slots, 2 * slots))[::-1]
        return self._free.pop()

    def predict(self, time: float) -> Predicted:
        """Predict all slots at a time, s."""
        states, covariances = self._ahead(slice(None), time)
        odds = np.exp(self._scores - self._scores.max(axis=1, keepdims=True))
        shares = np.maximum(odds / odds.sum(axis=1, keepdims=True), self.limits.changes)
        shares[self._sightings < self.limits.steady_first] = 1.0, TINY
        weights = np.log(shares)
        gone, half_widths = np.maximum(time - self._time, 0.0), np.exp(self._size)
        halted = -np.expm1(-gone / self.limits.halts_within)  # how likely it has come to rest, or was caught, meanwhile
        halted = np.clip(halted, TINY, 1.0 - TINY)
        weights = np.concatenate((weights + np.log1p(-halted)[:, None], np.log(halted)[:, None]), axis=1)
        sizes = self.limits.size_sigma**2 + (self.limits.size_rate * gone) ** 2
        drift = self._covariance[:, STEADY, 0, 0] + (self.limits.drift * half_widths) ** 2 * gone
        last = self._state[:, STEADY, 0]
        return Predicted(
            np.concatenate((states[:, :, 0], last[:, None]), axis=1),
            np.concatenate((states[:, :, 1], np.zeros_like(last)[:, None]), axis=1),
            np.concatenate((covariances[:, :, 0, 0], drift[:, None]), axis=1),
            weights,
            half_widths,
            sizes,
        )

    def correct(self, slots: Sequence[int], places: Sequence[Gate], variances: Sequence[float], time: float) -> None:
        """Correct slots by sightings.

        Parameters
        ----------
        slots : sequence of int
        places : sequence of Gate
            One for each slot.
        variances : sequence of float
            Of each coordinate of a center, px^2.
        time : float
            s
        """
        if not slots:
            return
        at, seen = np.array(slots), np.array(places)
        states, covariances = self._ahead(at, time)
        total = covariances[:, :, 0, 0] + np.array(variances)[:, None]
        innovations = seen[:, None, :2] - states[:, :, 0]
        gains = covariances[:, :, :, 0] / total[:, :, None]
        squared = (innovations**2).sum(axis=2) / total
        self._scores[at] = self.limits.memory * self._scores[at] - 0.5 * squared - np.log(total)
        self._state[at] = states + gains[:, :, :, None] * innovations[:, :, None, :]
        self._covariance[at] = covariances - gains[:, :, :, None] * covariances[:, :, 0][:, :, None, :]
        self._size[at] += self.limits.size_gain * (np.log(seen[:, 2]) - self._size[at])
        self._sightings[at] += 1.0
        self._time[at] = time

    def _ahead(self, at: Indices | slice, time: float) -> tuple[Floats, Floats]:
        """States and covariances of slots at a time, s."""
        ahead = np.maximum(time - self._time[at], 0.0)
        transition = np.zeros((len(ahead), 2, ORDERS, ORDERS))
        transition[:, :, range(ORDERS), range(ORDERS)] = 1.0
        transition[:, :, 0, 1] = ahead[:, None]
        transition[:, BALLISTIC, 0, 2] = 0.5 * ahead**2
        transition[:, BALLISTIC, 1, 2] = ahead
        states = transition @ self._state[at]
        noise, sizes = np.zeros((len(ahead), 2, ORDERS)), np.exp(self._size[at])
        noise[:, STEADY, 0], noise[:, STEADY, 1] = 0.5 * ahead**2, ahead
        noise[:, STEADY] *= (self.limits.acceleration * sizes)[:, None]
        noise[:, BALLISTIC, 0], noise[:, BALLISTIC, 1], noise[:, BALLISTIC, 2] = ahead**3 / 6, ahead**2 / 2, ahead
        noise[:, BALLISTIC] *= (self.limits.jerk * sizes)[:, None]
        covariances = transition @ self._covariance[at] @ transition.swapaxes(2, 3)
        covariances += noise[:, :, :, None] * noise[:, :, None, :]
        return states, covariances


class Likelihood(NamedTuple):
    """How well a sighting is explained as the target of a slot.

    Attributes
    ----------
    log : float
        Log-likelihood of center, px, and ln(half-width), by all models of motion.
    squared : float
        Squared distance, in standard deviations, the larger one of the center by the nearest model and of the size.
    halted : bool
        Whether that it has halted explains it best.
    """

    log: float
    squared: float
    halted: bool


def likelihood(predicted: Predicted, slot: int, place: Gate, variance: float) -> Likelihood:
    """Say how well a sighting with a variance of its center, px^2, is explained as the target of a slot."""
    terms, squared = list[float](), math.inf
    centers, variances, weights = (
        each[slot].tolist() for each in (predicted.centers, predicted.variances, predicted.log_weights)
    )
    for (x, y), of_center, weight in zip(centers, variances, weights, strict=True):
        total = of_center + variance
        distance = ((place.x - x) ** 2 + (place.y - y) ** 2) / total
        squared = min(squared, distance)
        terms.append(weight - 0.5 * distance - math.log(total))
    most, of_size = max(terms), float(predicted.size_variances[slot])
    change = math.log(place.half_width / float(predicted.half_widths[slot])) ** 2 / of_size
    log = most + math.log(sum(math.exp(term - most) for term in terms)) - 0.5 * change - 0.5 * math.log(of_size)
    return Likelihood(log, max(squared, change), terms[HALTED] == most)
