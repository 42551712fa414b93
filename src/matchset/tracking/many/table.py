"""Balls that roll on a table between two pictures: friction, and how they bounce off each other (`hits`)."""

import math
from typing import NamedTuple

import msgspec
import numpy as np
import numpy.typing as npt

Floats = npt.NDArray[np.float64]

TINY = 1e-9  # format: px, what is divided by at least
LEAST = 0.2  # format: cosine of the angle of a graze, up to which its uncertainty grows


class TableParameters(msgspec.Struct, frozen=True, kw_only=True):
    """How balls of one mass move on a table; speeds in half-widths of the ball.

    All chosen by hand; `struck`, `unexplained` and `rival` were compared with others on composed tables of 12 to 16
    balls, seeds 604 and 605 (docs/log/tracking.md#on-table).

    Parameters
    ----------
    friction : float
        Share of its speed that a rolling ball loses, 1/s: more expects those that are hidden to have come less far.
    restitution : float
        Share of the closing speed with which two balls part: 1 of ideal ones, less leaves more to the one that hits.
    unexplained : float
        Standard deviation of the speed after an impact, as a share of the closing speed: of spin, of other masses, of
        an oblique view. More trusts impacts less.
    struck : float
        Probability that something unseen, a cushion, a cue, a hand, turns a ball between two pictures. More keeps names
        of struck balls, less tells balls apart that are near each other.
    struck_speed : float
        Standard deviation of its velocity then, half-widths/s, beside its speed before.
    rival : float
        Log-odds of another target against the own one, from which it is in doubt whose a sighting is. Less asks more
        often.
    """

    friction: float = 0.3
    restitution: float = 0.95
    unexplained: float = 0.15
    struck: float = 0.02
    struck_speed: float = 40.0
    rival: float = -3.0


class Hit(NamedTuple):
    """Where a ball is that has hit another one.

    Attributes
    ----------
    place, velocity : tuple of float
        px, px/s.
    variance, speed_variance : float
        Of each coordinate of both, px^2 and px^2/s^2.
    since : float
        How long ago the impact was, s.
    share : float
        Probability that they have touched.
    """

    place: tuple[float, float]
    velocity: tuple[float, float]
    variance: float
    speed_variance: float
    since: float
    share: float


class Rolling(NamedTuple):
    """Balls at a time.

    Attributes
    ----------
    places, velocities : ndarray of shape (n, 2), float64
        px, px/s.
    half_widths, variances, speed_variances : ndarray of shape (n,), float64
        px; of each coordinate, px^2 and px^2/s^2.
    """

    places: Floats
    velocities: Floats
    half_widths: Floats
    variances: Floats
    speed_variances: Floats


def friction_of(passed: Floats, friction: float) -> tuple[Floats, Floats]:
    """Return for how long a ball would roll as far without friction, s, and the share of its speed that is left.

    ``v' = -k v``, so that it comes ``v (1 - exp(-k t)) / k`` far. What moves by this law alone takes the same paths as
    without friction, and touches the same others.
    """
    return -np.expm1(-friction * passed) / friction if friction else passed, np.exp(-friction * passed)


def after_impact(velocities: Floats, normal: Floats, restitution: float) -> Floats:
    """Return the velocities of two balls of one mass after they have touched.

    ``v1 - c n`` and ``v2 + c n`` with ``c = (1 + e) / 2 ((v1 - v2) . n)``: Newton's law of restitution, smooth balls.

    Parameters
    ----------
    velocities : ndarray of shape (2, 2), float64
        Of the first and of the second one.
    normal : ndarray of shape (2,), float64
        Unit vector from the first center to the second one.
    restitution : float
        e, 0 to 1.
    """
    closing = float((velocities[0] - velocities[1]) @ normal)
    change = 0.5 * (1.0 + restitution) * max(closing, 0.0) * normal
    return np.stack((velocities[0] - change, velocities[1] + change))


def hits(balls: Rolling, passed: float, limits: TableParameters) -> dict[int, Hit]:
    """Say which balls hit others within a time, s, and where they are then; one impact after the other.

    Parameters
    ----------
    balls : Rolling
    passed : float
    limits : TableParameters
    """
    rolled, slower = (float(each) for each in friction_of(np.array(passed), limits.friction))
    places = balls.places.copy()
    velocities = balls.velocities.copy()
    variances = balls.variances.copy()
    widths = balls.speed_variances.copy()
    shares = np.ones(len(places))
    last = np.zeros(len(places))
    now = 0.0
    touched = set[int]()
    for _ in range(2 * len(places)):
        after, *pair = _first_contact(places, velocities, balls.half_widths)
        if now + after > rolled:
            break
        now += after
        places = places + after * velocities
        variances[pair] += widths[pair] * (now - last[pair]) ** 2
        last[pair] = now
        touched.update(pair)
        shares[pair] *= _collide(pair, balls._replace(places=places, variances=variances), velocities, widths, limits)
    since = rolled - last
    places = places + (rolled - now) * velocities
    variances = variances + since**2 * widths
    velocities = slower * velocities
    widths = slower**2 * widths
    return {
        k: Hit(
            (places.item(k, 0), places.item(k, 1)),
            (velocities.item(k, 0), velocities.item(k, 1)),
            variances.item(k),
            widths.item(k),
            since.item(k),
            shares.item(k),
        )
        for k in sorted(touched)
    }


def _collide(
    pair: list[int], balls: Rolling, velocities: Floats, speed_variances: Floats, limits: TableParameters
) -> float:
    """Change the velocities of two balls that touch, and how uncertain they are; return how likely they touch at all.

    The line of centers is as uncertain as the places are, and turns the change of velocity with it.
    """
    normal = balls.places[pair[1]] - balls.places[pair[0]]
    normal /= max(math.hypot(*normal), TINY)
    relative = velocities[pair[0]] - velocities[pair[1]]
    closing = float(relative @ normal)
    touching = float(balls.half_widths[pair].sum())
    straight = min(closing / math.hypot(*relative), 1.0)
    sigma = math.sqrt(float(balls.variances[pair].sum()))
    missed = 1.0 - math.sqrt(1.0 - straight**2)  # how far from a miss, of the distance at which they touch
    turn = min(sigma / (touching * max(straight, LEAST)), 1.0)
    velocities[pair] = after_impact(velocities[pair], normal, limits.restitution)
    speed_variances[pair] = speed_variances[pair].mean() + closing**2 * (turn**2 + limits.unexplained**2)
    return 0.5 + 0.5 * math.erf(missed * touching / (math.sqrt(2.0) * sigma))


def _first_contact(places: Floats, velocities: Floats, half_widths: Floats) -> tuple[float, int, int]:
    """After which time, s, which two balls touch first; those that overlap and approach do at once."""
    one, other = np.triu_indices(len(places), 1)
    if not len(one):
        return math.inf, 0, 0
    between = places[other] - places[one]
    relative = velocities[other] - velocities[one]
    closing = -(between * relative).sum(axis=1)
    squared = (relative**2).sum(axis=1)
    beyond = (between**2).sum(axis=1) - (half_widths[one] + half_widths[other]) ** 2
    inside = closing**2 - squared * beyond
    after = np.full(len(one), math.inf)
    meet = (closing > TINY) & (inside > 0.0)
    after[meet] = np.maximum((closing[meet] - np.sqrt(inside[meet])) / squared[meet], 0.0)
    first = int(after.argmin())
    return float(after[first]), int(one[first]), int(other[first])
