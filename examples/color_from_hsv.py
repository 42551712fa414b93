"""Define a color by OpenCV's HSV ranges, save it, load it. For red the low hue is larger than the high one."""

import tempfile
from pathlib import Path

import cv2
import numpy as np

import matchset as ms

red = ms.ColorModel.hsv((170, 120, 80), (10, 255, 255))  # hue 170 ... 179 and 0 ... 10
blue = ms.ColorModel.hsv((100, 120, 80), (130, 255, 255))
either = red | blue

picture = np.full((240, 320, 3), 128, np.uint8)
cv2.circle(picture, (100, 120), 40, (30, 20, 200), -1, cv2.LINE_AA)  # BGR
cv2.circle(picture, (230, 120), 30, (200, 60, 20), -1, cv2.LINE_AA)

with tempfile.TemporaryDirectory() as folder:
    path = Path(folder) / "either.npz"
    either.save(path)
    loaded = ms.ColorModel.load(path)

for name, color in (("red", red), ("blue", blue), ("either", loaded)):
    found = ms.detect(ms.Frame(picture), ms.Circle, color)
    places = ", ".join(f"({track.shape.x:.1f}, {track.shape.y:.1f})" for track in found)
    print(f"{name}: {np.count_nonzero(color.mask(picture))} px in the mask, found at {places}")
