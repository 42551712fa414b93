"""Find all balls of one color in a single picture, best first: no video and no motion needed."""

import cv2
import numpy as np

import matchset as ms

picture = np.full((480, 640, 3), (150, 160, 165), np.uint8)  # BGR; cv2.imread gives the same kind of array
picture[300:, :] = (70, 100, 140)
for center, radius in (((150, 200), 60), ((420, 150), 35), ((500, 380), 80)):
    cv2.circle(picture, center, radius, (40, 160, 60), -1, cv2.LINE_AA)  # OpenCV draws it half a pixel larger
cv2.rectangle(picture, (250, 330), (350, 430), (40, 160, 60), -1)  # as green as the balls, but no ball

color = ms.ColorModel.pick(picture, 150, 200)
for track in ms.detect(ms.Frame(picture), ms.Circle, color):
    ball = track.shape
    print(f"x {ball.x:.2f}  y {ball.y:.2f}  radius {ball.radius:.2f} px, {track.support:.0%} of it confirmed")
