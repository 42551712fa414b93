"""Hands that hold a ball: a palm behind it, fingers and a thumb in front, and fingers around its rim."""

import math
from typing import NamedTuple

import msgspec
import numpy as np

from matchset.image.disc_network.patch_format import Circle3
from training.rendering.layers import (
    Counts,
    MaterialParameters,
    Random,
    Range,
    Singles,
    any_angle,
    away,
    blurred,
    count_within,
    darkened,
    happens,
    line,
    over,
    surface,
    within,
)

Colors = tuple[Range, Range, Range]


class Hand(NamedTuple):
    """A hand: its color, BGR, and the direction from the ball's center from which it comes, rad."""

    color: Singles
    angle: float


class HandParameters(msgspec.Struct, frozen=True):
    """How a hand looks, and how it holds a ball; chosen by hand.

    Parameters
    ----------
    skin : tuple of (float, float)
        Least and largest blue, green and red of skin, of 255.
    light : (float, float)
        How much light falls on it, as a share.
    material : MaterialParameters
    palm_start : (float, float)
        Where the palm begins, radii of the ball from its center along x, and drawn anew along y.
    palm_length : float
        How long palm and arm are, radii.
    palm_width : (float, float)
        Half their width, radii.
    fingers : (int, int)
        Least and largest number of fingers.
    finger_width : (float, float)
        Half the width of fingers, radii.
    tip : (float, float)
        How far from the ball's center their tips are, radii, toward the hand.
    spacing : (float, float)
        Distance of two fingers, in halves of their width.
    uneven_tips : float
        Standard deviation of a tip's distance from that of all, radii.
    joint, end : float
        Length of the parts of a finger before and after its joint, radii.
    bend, end_bend : float
        Standard deviation of their directions from the hand's, rad.
    finger_light : (float, float)
        Light on a finger as a share of that on the hand.
    shadow : (float, float)
        How dark a finger's shadow on the ball is, as a share.
    soft_shadow, least_soft : float
        Standard deviation by which that is blurred, radii, and at least px.
    thumbs : float
        Share of hands whose thumb is seen.
    thumb_turn : (float, float)
        Direction from the ball's center to the thumb, rad from the hand's.
    thumb_tip : (float, float)
        Distance of its tip, radii.
    thumb_joint, thumb_end : float
        Distances of its joint and of its end, which is in the hand, radii.
    thumb_width : (float, float)
        Its width as a share of a finger's.
    grips : float
        Share of hands with parts of fingers around the rim of the ball, and, apart from it, with such in front of it.
    grip_arc : (float, float)
        How much of the rim they are around, rad.
    grip_behind, grip_before : (float, float)
        Distance of their middles from the rim, in halves of their width, of those behind the ball and in front of it.
    grip_spacing : (float, float)
        Distance of two of them along the rim, in halves of their width.
    grip_length : (float, float)
        Their length, radii.
    grip_light : (float, float)
        Light on each as a share of that on the hand: between fingers it is dark.
    """

    skin: Colors = ((70.0, 165.0), (100.0, 185.0), (140.0, 238.0))
    light: Range = (0.4, 1.05)
    material: MaterialParameters = MaterialParameters()
    palm_start: Range = (0.2, 1.0)
    palm_length: float = 3.0
    palm_width: Range = (0.5, 1.3)
    fingers: Counts = (1, 4)
    finger_width: Range = (0.13, 0.32)
    tip: Range = (-0.2, 1.0)
    spacing: Range = (1.7, 2.6)
    uneven_tips: float = 0.15
    joint: float = 0.8
    end: float = 2.5
    bend: float = 0.2
    end_bend: float = 0.3
    finger_light: Range = (0.9, 1.1)
    shadow: Range = (0.0, 0.5)
    soft_shadow: float = 0.08
    least_soft: float = 0.5
    thumbs: float = 0.4
    thumb_turn: Range = (1.0, 5.0)
    thumb_tip: Range = (0.2, 1.0)
    thumb_joint: float = 1.6
    thumb_end: float = 2.0
    thumb_width: Range = (1.0, 1.4)
    grips: float = 0.45
    grip_arc: Range = (0.8, 4.5)
    grip_behind: Range = (-0.3, 1.3)
    grip_before: Range = (0.3, 1.6)
    grip_spacing: Range = (1.3, 2.4)
    grip_length: Range = (0.1, 0.9)
    grip_light: Range = (0.55, 1.1)


def skin_color(random: Random, skin: Colors, light: Range) -> Singles:
    """Color of skin in some light, BGR."""
    color = np.array([within(random, channel) for channel in skin], np.float32)
    return color * np.float32(within(random, light))


def any_hand(random: Random, limits: HandParameters) -> Hand:
    """Draw a hand."""
    return Hand(skin_color(random, limits.skin, limits.light), any_angle(random))


def with_palm(random: Random, picture: Singles, circle: Circle3, hand: Hand, limits: HandParameters) -> Singles:
    """Draw the palm and the arm of a hand, which a ball will be drawn over."""
    radius, (right, down) = circle[2], random.uniform(*limits.palm_start, 2)
    start = circle[0] + right * radius * math.cos(hand.angle), circle[1] + down * radius * math.sin(hand.angle)
    end = away(start, hand.angle, limits.palm_length * radius)
    mask = line(picture.shape[:2], (start, end), within(random, limits.palm_width) * radius)
    return over(picture, mask, surface(random, mask, hand.color, radius, limits.material))


def with_grip(
    random: Random, picture: Singles, circle: Circle3, hand: Hand, chosen: tuple[Range, HandParameters]
) -> Singles:
    """Draw parts of fingers around the rim of a ball, one beside the other, about where the hand comes from.

    Told how far from the rim, in halves of their width.
    """
    apart, limits = chosen
    radius, arc = circle[2], within(random, limits.grip_arc)
    angle = hand.angle + random.normal(0.0, limits.end_bend) - 0.5 * arc
    end = angle + arc
    while angle < end:
        half_width = within(random, limits.finger_width)
        middle = away(circle[:2], angle, (1.0 + within(random, apart) * half_width) * radius)
        direction, reach = any_angle(random), 0.5 * within(random, limits.grip_length) * radius
        ends = away(middle, direction, -reach), away(middle, direction, reach)
        mask = line(picture.shape[:2], ends, half_width * radius)
        color = hand.color * np.float32(within(random, limits.grip_light))
        picture = over(picture, mask, surface(random, mask, color, radius, limits.material))
        angle += within(random, limits.grip_spacing) * half_width
    return picture


def with_fingers(random: Random, picture: Singles, circle: Circle3, hand: Hand, limits: HandParameters) -> Singles:
    """Draw the fingers of a hand over a ball.

    Parameters
    ----------
    random : Generator
    picture : ndarray of shape (h, w, 3), float32
        With the ball.
    circle : (x, y, radius)
        Of the ball, px.
    hand : Hand
    limits : HandParameters

    Returns
    -------
    ndarray of shape (h, w, 3), float32
    """
    radius, count = circle[2], count_within(random, limits.fingers)
    half_width, tip = within(random, limits.finger_width) * radius, within(random, limits.tip) * radius
    for index in range(count):
        aside = (index - 0.5 * (count - 1)) * half_width * within(random, limits.spacing)
        along = tip + random.normal(0.0, limits.uneven_tips) * radius
        start = away(away(circle[:2], hand.angle, along), hand.angle + 0.5 * math.pi, aside)
        joint = away(start, hand.angle + random.normal(0.0, limits.bend), limits.joint * radius)
        bends = hand.angle + random.normal(0.0, limits.end_bend, 2)
        end = joint[0] + limits.end * radius * math.cos(bends[0]), joint[1] + limits.end * radius * math.sin(bends[1])
        mask = line(picture.shape[:2], (start, joint, end), half_width)
        shadow = blurred(mask, max(limits.soft_shadow * radius, limits.least_soft))
        picture = darkened(picture, shadow, within(random, limits.shadow))
        color = hand.color * np.float32(within(random, limits.finger_light))
        picture = over(picture, mask, surface(random, mask, color, radius, limits.material))
    if happens(random, limits.thumbs):
        picture = _with_thumb(random, picture, circle, hand, (half_width, limits))
    return picture


def _with_thumb(
    random: Random, picture: Singles, circle: Circle3, hand: Hand, finger: tuple[float, HandParameters]
) -> Singles:
    """Draw a thumb, which comes around the ball; told half the width of a finger."""
    half_width, limits = finger
    center, radius = circle[:2], circle[2]
    angle = hand.angle + within(random, limits.thumb_turn)
    tip = away(center, angle, within(random, limits.thumb_tip) * radius)
    joint = away(center, angle, limits.thumb_joint * radius)
    end = away(center, hand.angle, limits.thumb_end * radius)
    mask = line(picture.shape[:2], (tip, joint, end), half_width * within(random, limits.thumb_width))
    return over(picture, mask, surface(random, mask, hand.color, radius, limits.material))
