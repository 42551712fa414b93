"""The recipe of tutorials: a range of colors learned at the click, `cv2.inRange`, contours, `minEnclosingCircle`."""

import math
from typing import Any

import cv2

import matchset as ms
from benchmarks.crowds.peers.finders.color_range import Bytes, Range
from benchmarks.crowds.peers.peer import Detection, Find


def start(image: Bytes, circle: ms.Circle, parameters: dict[str, Any]) -> Find:
    """Learn the color; `least`: smallest radius as a share of the clicked one, `filled`: of the circle by its area."""
    colors = Range(image, circle, parameters)

    def find(picture: Bytes) -> list[Detection]:
        contours, _ = cv2.findContours(colors.mask(picture), cv2.RETR_EXTERNAL, cv2.CHAIN_APPROX_SIMPLE)
        found = []
        for contour in contours:
            (x, y), radius = cv2.minEnclosingCircle(contour)
            filled = cv2.contourArea(contour) / (math.pi * max(radius, 1.0) ** 2)
            if radius > max(parameters["least"] * circle.radius, 1.5) and filled > parameters["filled"]:
                found.append((x, y, radius, min(filled, 1.0)))
        return found

    return find
