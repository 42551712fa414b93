"""trackpy's `locate`: bright spots in a gray picture, or in one of how near each color is to the clicked one."""

import math
import warnings
from collections.abc import Callable
from typing import Any

import cv2
import numpy as np

import matchset as ms
from benchmarks.crowds.peers.finders.color_range import WHITE, Bytes
from benchmarks.crowds.peers.peer import Detection, Find

LARGEST = 8.0  # px, radius of a spot


def start(image: Bytes, circle: ms.Circle, parameters: dict[str, Any]) -> Find:
    """Learn the color and the mass of the clicked spot.

    `wide`: diameter of a spot in clicked ones; `mass`: least of a spot, in clicked ones; `far`: distance in CIELAB at
    which a picture in color is black; `separation`: least between spots, in clicked diameters; `sized`: radius by its
    spread. Where the clicked one is larger than `LARGEST`, pictures are shrunk: `locate` takes seconds for large spots.
    """
    import trackpy

    trackpy.quiet()
    likeness = _likeness(image, circle, parameters["far"])
    scale = min(LARGEST / circle.radius, 1.0)
    diameter = max(2 * round(parameters["wide"] * scale * circle.radius) + 1, 3)
    apart = max(parameters["separation"] * 2.0 * scale * circle.radius, 2.0)

    def located(picture: Bytes, least: float) -> Any:
        near = likeness(picture)
        if scale < 1.0:
            near = np.asarray(cv2.resize(near, None, fx=scale, fy=scale, interpolation=cv2.INTER_AREA), np.uint8)
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            spots = trackpy.locate(near, diameter, minmass=least, separation=apart, characterize=True)
        spots[["x", "y"]] = (spots[["x", "y"]] + 0.5) / scale - 0.5
        return spots

    def find(picture: Bytes) -> list[Detection]:
        spots = located(picture, parameters["mass"] * mass)
        found = []
        for spot in spots.itertuples():
            radius = math.sqrt(2.0) * float(spot.size) / scale if parameters["sized"] else circle.radius
            found.append((float(spot.x), float(spot.y), max(radius, 1.0), min(float(spot.mass) / (2.0 * mass), 1.0)))
        return found

    first = located(image, 0.0)
    distance = np.hypot(first.x - circle.x, first.y - circle.y)
    mass = float(first.mass[distance.idxmin()]) if len(first) else 1.0
    return find


def _likeness(image: Bytes, circle: ms.Circle, far: float) -> Callable[[Bytes], Bytes]:
    """Learn at a click how a picture is made one of bright spots; a gray one is that, dark spots made bright."""
    half = max(2, round(0.3 * circle.radius))
    x, y = round(circle.x), round(circle.y)
    part = (slice(max(y - half, 0), y + half + 1), slice(max(x - half, 0), x + half + 1))
    if image.ndim == 2:
        dark = np.median(image[part]) < np.median(image)
        return lambda picture: WHITE - picture if dark else picture
    middle = np.median(_lab(image)[part].reshape(-1, 3), axis=0)

    def near(picture: Bytes) -> Bytes:
        distance = np.linalg.norm(_lab(picture) - middle, axis=-1) / far
        return np.asarray(WHITE * np.clip(1.0 - distance, 0.0, 1.0), np.uint8)

    return near


def _lab(image: Bytes) -> np.ndarray:
    return np.asarray(cv2.cvtColor(image.astype(np.float32) / WHITE, cv2.COLOR_BGR2LAB))
