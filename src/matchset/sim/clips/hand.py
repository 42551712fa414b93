"""A hand that holds the ball: `Hand`, its forearm behind the ball, and four fingers over the rim."""

import math

import msgspec

from matchset.sim.clips.truth import SphereOutline
from matchset.sim.rendering.capsules import Capsule

Point = tuple[float, float]


class HoldParameters(msgspec.Struct, frozen=True, kw_only=True):
    """How a hand holds a ball; lengths in radii of the ball. Chosen by hand, after photographs of thrown balls.

    Parameters
    ----------
    color : tuple of 3 floats
        Of the skin, BGR.
    direction : tuple of 2 floats
        Direction in which the forearm leaves the ball, from +x toward +y, rad, and by how much it differs between
        seeds. It is to the lower right: a click at (x - r/2, y) hits the ball.
    fingers : tuple of floats
        Where each finger crosses the rim, rad from that direction; the first one is the thumb.
    finger : float
        Share of the rim behind one finger: what is more takes another finger, as far as there are any.
    tip : float
        Distance of a fingertip from the center of the ball.
    rim : float
        Distance of the joint before it, just outside the rim.
    swing : float
        By how much the hand turns about the ball to either side, rad.
    """

    color: tuple[float, float, float] = (118.0, 152.0, 205.0)
    direction: tuple[float, float] = (1.0, 0.3)
    fingers: tuple[float, ...] = (1.0, -0.75, -0.1, -1.4)
    finger: float = 0.075
    tip: float = 0.72
    rim: float = 1.12
    swing: float = 0.15


HOLD = HoldParameters()


class Hand(msgspec.Struct, frozen=True, kw_only=True):
    """A hand that moves with the ball.

    Parameters
    ----------
    behind : list of Capsule
        Forearm, palm and the first joints of the fingers: drawn before the ball.
    fingers : list of Capsule
        The last joints: drawn over the ball.
    """

    behind: list[Capsule]
    fingers: list[Capsule]


def hand_at(outline: SphereOutline, share: float, time: float, seed: int) -> Hand:
    """Build the hand that covers a share of the ball's rim.

    A finger of half-width w that crosses the rim of a disc of radius r covers 2 asin(w / r) of its 2 pi.

    Parameters
    ----------
    outline : SphereOutline
        The ball.
    share : float
        Share of the rim behind the fingers, more than 0, at most 0.4: then the fingers touch.
    time : float
        Frames: the hand turns a little to and fro.
    seed : int
        Decides from where it comes.

    Returns
    -------
    Hand
    """
    radius = math.sqrt(outline.a * outline.b)
    count = min(math.ceil(share / HOLD.finger), len(HOLD.fingers))
    width = math.sin(math.pi * share / count)
    middle, spread = HOLD.direction
    base = middle + spread * math.sin(2.4 * seed + 1.0) + HOLD.swing * math.sin(0.05 * time + seed)

    def at(distance: float, angle: float) -> Point:
        return outline.x + radius * distance * math.cos(angle), outline.y + radius * distance * math.sin(angle)

    def limb(begin: Point, end: Point, radii: tuple[float, float]) -> Capsule:
        return Capsule(*begin, radius * radii[0], *end, radius * radii[1])

    behind = [
        limb(at(1.5, base), at(30.0, base + 0.02), (0.48, 1.2)),
        limb(at(0.55, base), at(1.35, base), (0.75, 0.6)),
    ]
    fingers = []
    for off in HOLD.fingers[:count]:
        joint = at(HOLD.rim, base + off)
        behind.append(limb(at(1.05, base + 0.35 * off), joint, (1.25 * width, 1.05 * width)))
        fingers.append(limb(joint, at(HOLD.tip, base + 0.94 * off), (1.05 * width, 0.9 * width)))
    return Hand(behind=behind, fingers=fingers)


def shifted(hand: Hand, top: int) -> Hand:
    """Move a hand up by some rows: for a part of the picture that begins there."""
    behind, fingers = (
        [each._replace(y0=each.y0 - top, y1=each.y1 - top) for each in group] for group in (hand.behind, hand.fingers)
    )
    return Hand(behind=behind, fingers=fingers)
