"""Find round things without color, best first: python examples/detect_coins.py [PICTURE [dark or light]]."""

import sys

import cv2
import numpy as np

import matchset as ms

words = sys.argv[1:]
color = {"dark": ms.ColorModel.dark, "light": ms.ColorModel.light}[words[1] if len(words) > 1 else "light"]()
if words:
    picture = cv2.imread(words[0], cv2.IMREAD_GRAYSCALE)
    if picture is None:
        sys.exit(f"error: {words[0]} is not a picture")
else:
    picture = np.full((240, 320), 60, np.uint8)
    for center, radius in (((70, 70), 30), ((160, 100), 40), ((238, 100), 36)):  # the last two touch
        cv2.circle(picture, center, radius, 170, -1, cv2.LINE_AA)

for track in ms.detect(ms.Frame(np.asarray(picture, np.uint8)), ms.Circle, color, limit=40):
    coin = track.shape
    print(f"x {coin.x:.1f}  y {coin.y:.1f}  radius {coin.radius:.1f} px, {track.support:.0%} of it confirmed")
