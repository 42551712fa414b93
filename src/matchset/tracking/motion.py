"""Where the shape will be in the next frame: constant velocity, and how far that has been wrong lately."""

import math

import numpy as np
import numpy.typing as npt

from matchset.numeric.jit import inlined
from matchset.tracking.fit import PARTED
from matchset.tracking.memory import (
    APART,
    BLIND,
    EXPECTED,
    FIELDS,
    MOVED,
    RATE,
    SHEARED,
    SPEED,
    STEADY,
    SURPRISE,
    TIME,
    Views,
)

Floats = npt.NDArray[np.float64]

TRUST = 0.7  # share of the latest change that the velocity follows: 1 is quick and noisy, 0 never learns
MEMORY = 0.8  # share of the spread that a frame as predicted leaves
FADE = 0.25  # s after which a velocity without a sighting has faded to 1/e
LEAST = 0.3  # px: no prediction is trusted to be better
PROMPT = 0.05  # s without a sighting from which it fades
FIELD_MEMORY = 0.9  # share of what is known about the fields that one frame leaves
STILL = 120.0  # px/s: below so much in the frames remembered little is known about them
HALF = 0.5  # of the time between two frames: when the second field of an interlaced picture is taken
NEARLY = 0.15  # how near to that what was learned must be to be taken for it
ANYWHERE = 0.5  # standard deviation of the fields' distance while that is not known, as a share of the way
SURELY = 0.08  # and once it is
CALM = 0.1  # px: what is added to that


@inlined
def correct(parts: Views, time: float) -> None:
    """Take in the state that was fitted at a time, s."""
    state, velocity, spread, fitted = parts.seen, parts.velocity, parts.spread, parts.state
    passed = time - parts.clock[TIME]
    _note_fields(parts)
    for k in range(state.shape[0]):
        if passed > 0.0:
            missed = fitted[k] - state[k] - velocity[k] * passed
            if k < spread.shape[0]:
                velocity[k] = (velocity[k] + TRUST / passed * missed) * _known(parts, k)
                spread[k] = max(abs(missed), MEMORY * spread[k] + (1.0 - MEMORY) * abs(missed))
        state[k] = fitted[k]
    spread[0] = spread[1] = max(spread[0], spread[1])
    parts.clock[TIME] = time


@inlined
def _known(parts: Views, k: int) -> float:
    """Share that the velocity of a parameter keeps: none where the edge points told nothing of it."""
    room = parts.room[k] * parts.room[k]
    return min(max(2.0 * (1.0 - parts.covariance[k, k] / room), 0.0), 1.0) if room > 0.0 and k > 1 else 1.0


@inlined
def _note_fields(parts: Views) -> None:
    """Note how far apart the fields were that were fitted, for the speed that the shape was expected to have."""
    x, y, clock = parts.velocity[0], parts.velocity[1], parts.clock
    if parts.look[RATE] > PARTED:
        clock[SHEARED] = FIELD_MEMORY * clock[SHEARED] + parts.fit[FIELDS] * x + parts.fit[FIELDS + 1] * y
        clock[MOVED] = FIELD_MEMORY * clock[MOVED] + x * x + y * y


@inlined
def part_fields(parts: Views) -> None:
    """Expect the fields as far apart as the speed, and the time that lately lay between them, say.

    An interlaced picture's fields are half a frame apart, unless frames were left out; those of any other picture are
    one. While they are not known to be, their distance has a standard deviation of half the way.

    Parameters
    ----------
    parts : Views
        Written: where the fit of the fields' distance begins, what is expected of it, and how surely.
    """
    x, y, fit, clock, way = parts.velocity[0], parts.velocity[1], parts.fit, parts.clock, parts.look[RATE]
    speed, between, known = math.hypot(x, y), 0.0, 0.0
    if speed > 0.0 and way > 0.0 and parts.look[BLIND] == 0.0:
        frame, noted = way / speed, clock[MOVED] + STILL * STILL
        between = min(max(clock[SHEARED] / noted, -frame), frame)
        if abs(abs(between) - HALF * frame) < NEARLY * frame:
            between, known = HALF * frame if between > 0.0 else -HALF * frame, clock[MOVED] / noted
    fit[FIELDS] = fit[EXPECTED] = between * x
    fit[FIELDS + 1] = fit[EXPECTED + 1] = between * y
    fit[APART] = CALM + (ANYWHERE + known * (SURELY - ANYWHERE)) * way


@inlined
def predict(parts: Views, time: float, missed: float, trust: float) -> None:
    """Extrapolate to a time; the velocity fades while nothing is seen.

    Writes `expected`, `room`, and in `clock` the speed, px/s, and by how much predictions have lately missed, px.

    Parameters
    ----------
    parts : Views
    time : float
        s, not before the last sighting.
    missed : float
        Frames since then.
    trust : float
        How many recent surprises each parameter may be off.
    """
    ahead = time - parts.clock[TIME]
    if ahead > PROMPT:
        ahead = FADE * (1.0 - math.exp(-ahead / FADE))
    velocity, spread = parts.velocity, parts.spread
    for k in range(velocity.shape[0]):
        parts.expected[k] = parts.seen[k] + ahead * velocity[k]
    for k in range(spread.shape[0]):
        parts.room[k] = missed * (LEAST if k >= parts.track[STEADY] else trust * spread[k] + LEAST)
    parts.clock[SPEED], parts.clock[SURPRISE] = math.hypot(velocity[0], velocity[1]), spread[0]


def begin(parts: Views, state: Floats, time: float, spread: float) -> None:
    """Begin at a state, at rest.

    Parameters
    ----------
    parts : Views
    state : ndarray of shape (s,), float64
        State at the first sighting.
    time : float
        When that was, s; -inf for one frame before the next.
    spread : float
        How far from it the next sighting may be, px.
    """
    parts.seen[:] = parts.expected[:] = state
    parts.velocity[:], parts.spread[:], parts.room[:] = 0.0, spread, 0.0
    parts.clock[TIME], parts.clock[SPEED], parts.clock[SURPRISE] = time, 0.0, spread
