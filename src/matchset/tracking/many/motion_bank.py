"""How several targets move: Kalman filters of constant velocity and of free flight, all at once (`MotionBank`)."""

import functools
import heapq
import math
from collections.abc import Sequence
from typing import NamedTuple

import msgspec
import numpy as np
import numpy.typing as npt

from matchset.tracking.many.sightings import Sighting
from matchset.tracking.many.table import Hit, Rolling, TableParameters, friction_of, hits
from matchset.tracking.motion import Gate

Floats = npt.NDArray[np.float64]
Indices = npt.NDArray[np.intp]

STEADY, BALLISTIC, HALTED, HIT, STRUCK = range(5)  # format: models of motion; the first two have filters of their own
ORDERS = 3  # format: position, velocity and acceleration of each axis
IDENTITY = np.eye(ORDERS)  # format: of the transition
TINY = 1e-9  # format: a probability of nearly nothing, whose logarithm is a number


class ManyMotionParameters(msgspec.Struct, frozen=True, kw_only=True):
    """How targets are expected to move; lengths in half-widths of the target.

    All chosen on rendered crowds, seeds 7 to 12 (docs/log/tracking.md#association); `python -m benchmarks.crowds` would
    show a change.

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
    size_gain, crowded_size_gain : float
        Share of a new ln(half-width) that is taken over, and next to others, where an outline may take in a part of
        another one.
    table : TableParameters or None
        How they move if they roll on a table, without free flight; None: they need not.
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
    crowded_size_gain: float = 0.1
    table: TableParameters | None = None

    @property
    def center_sigmas(self) -> tuple[float, float]:
        """Of a sighting's center: px, and half-widths."""
        return self.center_sigma_px, self.center_sigma


class Tables(NamedTuple):
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


class Predicted:
    """Where targets are expected in a frame, worked out when it is asked for first, before anything is corrected.

    Parameters
    ----------
    bank : MotionBank
    time : float
        Of the frame, s.
    """

    def __init__(self, bank: "MotionBank", time: float) -> None:
        self._bank, self._time = bank, time

    @functools.cached_property
    def _tables(self) -> Tables:
        return self._bank.tables(self._time)

    def half_width(self, slot: int) -> float:
        """Return the half-width of a slot, px."""
        return self._bank.half_width(slot)

    def likeliest(self, slot: int) -> tuple[Gate, tuple[float, float]]:
        """Place and velocity of a slot by its likeliest model; px, px/s."""
        tables = self._tables
        model = int(tables.log_weights[slot].argmax())
        (x, y), (vx, vy) = tables.centers[slot, model].tolist(), tables.velocities[slot, model].tolist()
        return Gate(x, y, float(tables.half_widths[slot])), (vx, vy)

    def places(self, slot: int) -> list[Gate]:
        """Places of a slot by each model, px."""
        half_width = float(self._tables.half_widths[slot])
        return [Gate(x, y, half_width) for x, y in self._tables.centers[slot].tolist()]

    def halted(self, slot: int) -> Gate:
        """Place of a slot if it has halted, px."""
        x, y = self._tables.centers[slot, HALTED].tolist()
        return Gate(x, y, float(self._tables.half_widths[slot]))

    def likelihood(self, slot: int, place: Gate, variance: float) -> Likelihood:
        """Say how well a sighting with a variance of its center, px^2, is explained as the target of a slot."""
        tables = self._tables
        terms, squared = list[float](), math.inf
        centers, variances, weights = (
            each[slot].tolist() for each in (tables.centers, tables.variances, tables.log_weights)
        )
        for (x, y), of_center, weight in zip(centers, variances, weights, strict=True):
            total = of_center + variance
            distance = ((place.x - x) ** 2 + (place.y - y) ** 2) / total
            squared = min(squared, distance)
            terms.append(weight - 0.5 * distance - math.log(total))
        most, of_size = max(terms), float(tables.size_variances[slot])
        change = math.log(place.half_width / float(tables.half_widths[slot])) ** 2 / of_size
        log = most + math.log(sum(math.exp(term - most) for term in terms)) - 0.5 * change - 0.5 * math.log(of_size)
        return Likelihood(log, max(squared, change), terms[HALTED] == most)


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
        self._free = list(range(slots))  # a heap: the first slots are used, and only these are predicted
        self._used = 0
        self._noted: tuple[Sequence[int], Sequence[Sighting], float] | None = None
        self._hits = dict[int, Hit]()

    def foresee(self, groups: Sequence[Sequence[int]], time: float) -> None:
        """Foresee which targets on a table hit each other until a time, s; slots of a group are of one place."""
        self._catch_up()
        self._hits.clear()
        at = np.array([group[0] for group in groups], np.intp)
        if self.limits.table is None or len(at) < 2 or not (passed := time - float(self._time[at].max())) > 0.0:
            return
        states, covariances = self._ahead(at, time - passed)
        variances = covariances[:, STEADY, 0, 0], covariances[:, STEADY, 1, 1]
        balls = Rolling(states[:, STEADY, 0], states[:, STEADY, 1], np.exp(self._size[at]), *variances)
        for k, hit in hits(balls, passed, self.limits.table).items():
            self._hits.update(dict.fromkeys(groups[k], hit))

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
        if source in self._hits:
            self._hits[slot] = self._hits[source]
        return slot

    def free(self, slot: int) -> None:
        """Take a slot back."""
        self._hits.pop(slot, None)
        heapq.heappush(self._free, slot)

    def _take(self) -> int:
        self._catch_up()
        if not self._free:
            slots = len(self._size)
            for name in ("_state", "_covariance", "_scores", "_size", "_sightings", "_time"):
                setattr(self, name, np.concatenate((getattr(self, name), getattr(self, name))))
            self._free = list(range(slots, 2 * slots))
        slot = heapq.heappop(self._free)
        self._used = max(self._used, slot + 1)
        return slot

    def half_width(self, slot: int) -> float:
        """Return the half-width of a slot, px."""
        return math.exp(self._size.item(slot))

    def tables(self, time: float) -> Tables:
        """Predict all slots that were ever used at a time, s."""
        self._catch_up()
        used = slice(self._used)
        states, covariances = self._ahead(used, time)
        odds = np.exp(self._scores[used] - self._scores[used].max(axis=1, keepdims=True))
        shares = np.maximum(odds / odds.sum(axis=1, keepdims=True), self.limits.changes)
        shares[(self._sightings[used] < self.limits.steady_first) | (self.limits.table is not None)] = 1.0, TINY
        gone, half_widths = np.maximum(time - self._time[used], 0.0), np.exp(self._size[used])
        halted = -np.expm1(-gone / self.limits.halts_within)  # how likely it has come to rest, or was caught, meanwhile
        halted = np.clip(halted, TINY, 1.0 - TINY)[:, None]
        last = self._state[used, STEADY, 0]
        drift = self._covariance[used, STEADY, 0, 0] + (self.limits.drift * half_widths) ** 2 * gone
        tables = Tables(
            np.concatenate((states[:, :, 0], last[:, None]), axis=1),
            np.concatenate((states[:, :, 1], np.zeros_like(last)[:, None]), axis=1),
            np.concatenate((covariances[:, :, 0, 0], drift[:, None]), axis=1),
            np.log(np.concatenate((shares * (1.0 - halted), halted), axis=1)),
            half_widths,
            self.limits.size_sigma**2 + (self.limits.size_rate * gone) ** 2,
        )
        return tables if self.limits.table is None else self._on_table(tables, gone, self.limits.table)

    def _on_table(self, tables: Tables, gone: Floats, table: TableParameters) -> Tables:
        """Add what may have hit a target: another one, or something that is not seen."""
        used = len(gone)
        reach, _ = friction_of(gone, table.friction)
        speed = (self._state[:used, STEADY, 1] ** 2).sum(axis=1)
        struck = 0.5 * speed + (table.struck_speed * tables.half_widths) ** 2
        centers = self._state[:used, STEADY, 0][:, None].repeat(2, axis=1)
        velocities = np.zeros((used, 2, 2))
        variances = np.ones((used, 2))
        variances[:, 1] = self._covariance[:used, STEADY, 0, 0] + struck * reach**2
        shares = np.full((used, 2), (TINY, table.struck))
        for slot, hit in self._hits.items():
            if slot < used:
                centers[slot, 0] = hit.place
                velocities[slot, 0] = hit.velocity
                variances[slot, 0] = hit.variance
                shares[slot, 0] = max(hit.share * (1.0 - table.struck), TINY)
        left = np.maximum(1.0 - shares.sum(axis=1, keepdims=True), self.limits.changes)
        return tables._replace(
            centers=np.concatenate((tables.centers, centers), axis=1),
            velocities=np.concatenate((tables.velocities, velocities), axis=1),
            variances=np.concatenate((tables.variances, variances), axis=1),
            log_weights=np.concatenate((tables.log_weights + np.log(left), np.log(shares)), axis=1),
        )

    def _bounced(
        self, at: Indices, seen: Floats, variances: Floats, time: float
    ) -> list[tuple[int, Floats, tuple[float, float, float]]]:
        """Slots that have hit something, by their sightings; with the state and the variances that they have then."""
        tables = self.tables(time)
        bounced = list[tuple[int, Floats, tuple[float, float, float]]]()
        total = tables.variances[at] + variances[:, None]
        apart = seen[:, None, :2] - tables.centers[at]
        models = (tables.log_weights[at] - 0.5 * (apart**2).sum(axis=2) / total - np.log(total)).argmax(axis=1)
        for k in np.flatnonzero(models >= HIT).tolist():
            slot = int(at[k])
            offset = apart[k, models[k]]
            hit = self._hits.get(slot) if models[k] == HIT else None
            if hit is not None:
                gain = hit.since * hit.speed_variance / total[k, HIT]
                velocity = np.add(hit.velocity, gain * offset)
                spread = hit.speed_variance * (1.0 - gain * hit.since)
            else:
                velocity = offset / max(time - self._time.item(slot), TINY)
                spread = 0.25 * float((velocity**2).sum())
            state = np.stack((seen[k, :2], velocity, np.zeros(2)))
            bounced.append((slot, state, (float(variances[k]), spread, 0.0)))
        return bounced

    def note(self, slots: Sequence[int], sightings: Sequence[Sighting], time: float) -> None:
        """Correct slots by sightings, as `correct`, once it is asked for what they tell; of several the last count."""
        self._noted = slots, sightings, time

    def _catch_up(self) -> None:
        """Correct by the sightings noted last."""
        noted, self._noted = self._noted, None
        if noted is not None:
            self.correct(*noted)

    def correct(self, slots: Sequence[int], sightings: Sequence[Sighting], time: float) -> None:
        """Correct slots by sightings, one for each, at a time, s."""
        if self._noted is not None:
            self._catch_up()
        if not slots:
            return
        places, variances = [each.place for each in sightings], [each.variance for each in sightings]
        at, seen = np.array(slots), np.array(places)
        bounced = self._bounced(at, seen, np.array(variances), time) if self.limits.table is not None else []
        states, covariances = self._ahead(at, time)
        total = covariances[:, :, 0, 0] + np.array(variances)[:, None]
        innovations = seen[:, None, :2] - states[:, :, 0]
        gains = covariances[:, :, :, 0] / total[:, :, None]
        squared = (innovations**2).sum(axis=2) / total
        self._scores[at] = self.limits.memory * self._scores[at] - 0.5 * squared - np.log(total)
        self._state[at] = states + gains[:, :, :, None] * innovations[:, :, None, :]
        self._covariance[at] = covariances - gains[:, :, :, None] * covariances[:, :, 0][:, :, None, :]
        for slot, state, variance in bounced:
            self._state[slot] = state
            self._covariance[slot] = np.diag(variance)
        crowded = np.array([each.crowded for each in sightings])
        gain = np.where(crowded, self.limits.crowded_size_gain, self.limits.size_gain)
        self._size[at] += gain * (np.log(seen[:, 2]) - self._size[at])
        self._sightings[at] += 1.0
        self._time[at] = time

    def _ahead(self, at: Indices | slice, time: float) -> tuple[Floats, Floats]:
        """States and covariances of slots at a time, s: ``F x`` and ``F P F^T + Q``, written out."""
        limits, ahead = self.limits, np.maximum(time - self._time[at], 0.0)
        size, half, sixth = np.exp(self._size[at]), 0.5 * ahead * ahead, ahead**3 / 6.0
        transition, noise = np.empty((len(ahead), 2, ORDERS, ORDERS)), np.zeros((len(ahead), 2, ORDERS))
        transition[:] = IDENTITY
        transition[:, :, 0, 1] = ahead[:, None]
        transition[:, BALLISTIC, 0, 2], transition[:, BALLISTIC, 1, 2] = half, ahead
        if limits.table is not None:
            rolled, slower = friction_of(ahead, limits.table.friction)
            transition[:, STEADY, 0, 1] = rolled
            transition[:, STEADY, 1, 1] = slower
        noise[:, STEADY, 0], noise[:, STEADY, 1] = limits.acceleration * size * half, limits.acceleration * size * ahead
        jerk = limits.jerk * size
        noise[:, BALLISTIC, 0], noise[:, BALLISTIC, 1], noise[:, BALLISTIC, 2] = jerk * sixth, jerk * half, jerk * ahead
        covariances = transition @ self._covariance[at] @ transition.swapaxes(2, 3)
        covariances += noise[:, :, :, None] * noise[:, :, None, :]
        return transition @ self._state[at], covariances
