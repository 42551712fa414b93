"""How likely a disc is the ball: `Features` of a disc, and their `log_odds`, one weighted sum.

Network, color, place, motion and edge points all see the same pixels, so they are weighed together, not added one by
one with thresholds of their own.
"""

import math
from typing import NamedTuple

import msgspec


class Features(NamedTuple):
    """What speaks for and against a disc.

    Attributes
    ----------
    network : float
        Log-odds of a ball, by the network of discs.
    color : float
        Log-likelihood of the chroma of its middle, as of a normal distribution, 0 at most.
    foreign : float
        1 where the color table knows hardly any of its middle and the median color is another one, else 0.
    place : float
        Log prior of its place, see `log_prior_of_place`.
    size : float
        Log prior of its size, see `log_prior_of_size`.
    arrived : float
        1 where something of the ball's color and mass has arrived, and next to nothing else has moved; down to 0.
    before : float
        1 where a look-alike was there before, else 0.
    edges : float
        1 where edge points around it confirm it, else 0.
    """

    network: float
    color: float = 0.0
    foreign: float = 0.0
    place: float = 0.0
    size: float = 0.0
    arrived: float = 0.0
    before: float = 0.0
    edges: float = 0.0


class FeatureWeights(msgspec.Struct, frozen=True):
    """Weight of each of the `Features` in the log-odds, and the sum of them all where nothing is seen.

    Chosen by hand on real clips and rendered small balls (docs/log/tracking.md#one-belief).

    Parameters
    ----------
    bias : float
    most_network : float
        Log-odds of the network that count at most: it says that there is a ball, not which.
    network, color, foreign, place, size, arrived, before, edges : float
    """

    bias: float = -1.0
    most_network: float = 3.5
    network: float = 1.0
    color: float = 1.0
    foreign: float = -1.5
    place: float = 1.0
    size: float = 1.0
    arrived: float = 4.0
    before: float = -5.0
    edges: float = 1.0


def log_odds(features: Features, weights: FeatureWeights) -> float:
    """Log-odds that a disc is the ball.

    Parameters
    ----------
    features : Features
    weights : FeatureWeights
    """
    return (
        weights.bias
        + weights.network * min(features.network, weights.most_network)
        + weights.color * features.color
        + weights.foreign * features.foreign
        + weights.place * features.place
        + weights.size * features.size
        + weights.arrived * features.arrived
        + weights.before * features.before
        + weights.edges * features.edges
    )


def probability_of(log_odds: float) -> float:
    """Return the probability that has these log-odds."""
    return 1.0 / (1.0 + math.exp(-log_odds))


class PlaceParameters(msgspec.Struct, frozen=True):
    """Where a ball may be that was not seen for some pictures; chosen by hand.

    Parameters
    ----------
    radii, speeds, innovations : float
        Scale of the distance from where it is expected, a picture after it was seen: so many radii, ways from picture
        to picture, and innovations.
    most_innovation : float
        Innovation that counts at most, radii.
    unknown_speed : float
        Speed of a ball that was seen once only, radii a picture: more follows faster balls from the first picture on,
        less keeps to the one of equal ones that is nearer.
    spread : float
        Power of the missed pictures with which that scale grows.
    new, known : float
        Probability that it is anywhere else in the next picture, of a ball that was hardly seen before, and of one
        whose motion is known: a ball does not jump.
    sightings : int
        Sightings from which its motion is known.
    forgotten : float
        Pictures after which most of what was known of its place is forgotten.
    rivals : float
        How many other things of its look a picture shows: more needs more proof far off.
    moving : float
        For how many missed pictures its speed counts.
    """

    radii: float = 0.5
    speeds: float = 0.5
    innovations: float = 2.0
    most_innovation: float = 2.0
    unknown_speed: float = 4.0
    spread: float = 0.5
    new: float = 0.5
    known: float = 0.03
    sightings: int = 5
    forgotten: float = 8.0
    rivals: float = 8.0
    moving: float = 12.0


class ExpectedPlace(NamedTuple):
    """Where a ball is expected.

    Attributes
    ----------
    x, y, radius : float
        px.
    missed : float
        How many pictures ago it was seen last, at least 1.
    unsized : float
        How many pictures ago its outline was seen last, and with that its size, at least 1.
    speed, innovation : float
        Way from picture to picture, and how far it was from its prediction lately, px.
    sightings : int
        How often it was seen.
    way : float
        Length of the streak that was clicked, px; 0 of a disc.
    """

    x: float
    y: float
    radius: float
    missed: float
    unsized: float
    speed: float
    innovation: float
    sightings: int
    way: float = 0.0

    def mass_radius(self) -> float:
        """Radius of a disc of as much mass, px, in the color that is known: that of a streak is mixed."""
        return max(math.sqrt(2.0 * self.radius * self.way / math.pi), self.radius)


class SizeParameters(msgspec.Struct, frozen=True):
    """How large a ball may be whose outline was not seen for some pictures; chosen by hand.

    Parameters
    ----------
    sigma : float
        Standard deviation of ln(radius), a picture after its outline was seen; it grows with the root of the pictures.
    sigma_px : float
        Of the radius that the network sees, px.
    """

    sigma: float = 0.12
    sigma_px: float = 0.5


def log_prior_of_size(radius: float, expected: ExpectedPlace, limits: SizeParameters) -> float:
    """Log prior of a radius, 0 where it is as it is believed; with the heavy tail of Cauchy's distribution.

    Parameters
    ----------
    radius : float
        px.
    expected : ExpectedPlace
    limits : SizeParameters
    """
    away = math.log(radius / expected.radius) ** 2
    return -math.log1p(away / (limits.sigma**2 * expected.unsized + (limits.sigma_px / expected.radius) ** 2))


def log_prior_of_place(place: tuple[float, float], expected: ExpectedPlace, limits: PlaceParameters) -> float:
    """Log prior of a place, 0 where the ball is expected.

    It is a mixture: an innovation with the heavy tail of Cauchy's distribution, or anywhere among all that looks alike.

    Parameters
    ----------
    place : (x, y)
        px.
    expected : ExpectedPlace
    limits : PlaceParameters
    """
    speed = expected.speed if expected.missed <= limits.moving else 0.0
    innovation = min(expected.innovation, limits.most_innovation * expected.radius)
    scale = limits.radii * expected.radius + limits.speeds * speed + limits.innovations * innovation
    unknown = limits.unknown_speed * expected.radius if expected.sightings <= 1 else 0.0
    scale += max(unknown, expected.way)
    scale *= expected.missed**limits.spread
    first = limits.known if expected.sightings >= limits.sightings else limits.new
    elsewhere = first + (1.0 - first) * (1.0 - math.exp(-(expected.missed - 1.0) / limits.forgotten))
    away = ((place[0] - expected.x) ** 2 + (place[1] - expected.y) ** 2) / scale**2
    return math.log(1.0 / (1.0 + away) + elsewhere / limits.rivals)
