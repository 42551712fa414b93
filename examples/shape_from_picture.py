"""Detect a shape that is given by a picture of its outline: here an egg, drawn in place of a photo."""

import cv2
import numpy as np

import matchset as ms

rows, columns = np.indices((120, 100))
drawn = (columns - 50) ** 2 / (30 + 0.12 * (rows - 60)) ** 2 + (rows - 60) ** 2 / 45**2 < 1  # cv2.imread(...) > 127
Egg = ms.Convex.of(drawn)

picture = np.full((480, 640, 3), (120, 150, 150), np.uint8)
for x, y, scale, angle in ((150.0, 140.0, 1.4, 0.4), (430.0, 270.0, 2.0, -1.1)):
    outline = Egg(x, y, scale * Egg.from_coarse(0, 0, 37.0).scale, angle).corners
    cv2.fillConvexPoly(picture, np.rint(16 * outline).astype(np.int32), (60, 90, 210), cv2.LINE_AA, 4)

color = ms.ColorModel.pick(picture, 150, 140, ball=False)
for track in ms.detect(ms.Frame(picture), Egg, color):
    egg = track.shape
    print(f"x {egg.x:.1f}  y {egg.y:.1f}  turned by {np.degrees(egg.angle):+.1f}°, {track.support:.0%} confirmed")
