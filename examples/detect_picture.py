"""Find all balls of one color in a picture, best first: python examples/detect_picture.py [PICTURE X Y] (a click)."""

import sys

import cv2
import numpy as np

import matchset as ms

if len(sys.argv) == 4:
    loaded, x, y = cv2.imread(sys.argv[1]), float(sys.argv[2]), float(sys.argv[3])
    if loaded is None:
        sys.exit(f"error: {sys.argv[1]} is not a picture")
    picture = np.asarray(loaded, np.uint8)
else:
    picture, x, y = np.full((480, 640, 3), (150, 160, 165), np.uint8), 150.0, 200.0  # BGR
    picture[300:, :] = (70, 100, 140)
    for center, radius in (((150, 200), 60), ((420, 150), 35), ((500, 380), 80)):
        cv2.circle(picture, center, radius, (40, 160, 60), -1, cv2.LINE_AA)  # OpenCV draws it half a pixel larger
    cv2.rectangle(picture, (250, 330), (350, 430), (40, 160, 60), -1)  # as green as the balls, but no ball

color = ms.ColorModel.pick(picture, x, y)
for track in ms.detect(ms.Frame(picture), ms.Circle, color):
    ball = track.shape
    print(f"x {ball.x:.2f}  y {ball.y:.2f}  radius {ball.radius:.2f} px, {track.support:.0%} of it confirmed")
