"""Locate the corners of a dark mark, given a box: python examples/printed_mark.py [PICTURE LEFT TOP RIGHT BOTTOM]."""

import sys

import cv2
import numpy as np

import matchset as ms

if len(sys.argv) == 6:
    picture = cv2.imread(sys.argv[1])
    left, top, right, bottom = map(float, sys.argv[2:])
    if picture is None:
        sys.exit(f"error: {sys.argv[1]} is not a picture")
else:
    mark = np.full((10, 10, 3), 255, np.uint8)
    mark[1:9, 1:9] = 20
    mark[2:8, 2:8] = np.random.default_rng(0).integers(0, 2, (6, 6, 1)) * 235 + 20
    large = cv2.resize(mark, (200, 200), interpolation=cv2.INTER_NEAREST)
    flat = np.array([(0, 0), (200, 0), (200, 200), (0, 200)], np.float32)
    turn = cv2.getPerspectiveTransform(flat, np.array([(110, 60), (250, 80), (240, 210), (100, 190)], np.float32))
    picture = cv2.warpPerspective(large, turn, (360, 260), borderValue=(150, 150, 150), flags=cv2.INTER_AREA)
    left, top, right, bottom = 118, 76, 232, 196

tracker = ms.Tracker(ms.Quadrilateral, ms.ColorModel.dark())
tracker.start(ms.Quadrilateral([(left, top), (right, top), (right, bottom), (left, bottom)]))
track = tracker.update(ms.Frame(np.asarray(picture, np.uint8)))
print(track.shape.corners.round(2).tolist() if isinstance(track, ms.Track) else f"lost: {track.reason}")
