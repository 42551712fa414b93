"""Compare the gray modes on a round thing: python examples/begin_roughly.py [PICTURE X Y RADIUS] (a rough circle)."""

import sys

import cv2
import numpy as np

import matchset as ms

if len(sys.argv) == 5:
    picture, rough = cv2.imread(sys.argv[1]), ms.Circle(*map(float, sys.argv[2:]))
    if picture is None:
        sys.exit(f"error: {sys.argv[1]} is not a picture")
else:  # a gray ball, half before something dark and half before something light
    picture, rough = np.full((240, 320, 3), 70, np.uint8), ms.Circle(153, 125, 38)
    picture[:, 160:] = 200
    cv2.circle(picture, (160, 120), 40, (130, 130, 130), -1, cv2.LINE_AA)

for mode in ("dark", "light", "edges"):
    tracker = ms.Tracker(ms.Circle, getattr(ms.ColorModel, mode)())
    tracker.start(rough)
    answer = tracker.update(ms.Frame(np.asarray(picture, np.uint8)))
    if isinstance(answer, ms.Track):
        ball = answer.shape
        found = f"x {ball.x:.1f}  y {ball.y:.1f}  radius {ball.radius:.1f} px, {answer.support:.0%} of it confirmed"
    else:
        found = f"lost: {answer.reason}"
    print(f"{mode:5s}  {found}")
