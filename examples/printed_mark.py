"""Find the corners of a dark printed mark to a fraction of a pixel, begun at a rough box; no color is needed."""

from pathlib import Path

import cv2
import numpy as np

import matchset as ms

photo = Path(__file__).resolve().parents[2] / "shared/data/stills/apriltag_33369213973_9d9bb4cc96_c.jpg"
if photo.exists():
    picture = cv2.imread(str(photo))
    rough = [(250, 327), (278, 327), (278, 357), (250, 357)]
else:
    mark = np.full((10, 10, 3), 255, np.uint8)
    mark[1:9, 1:9] = 20
    mark[2:8, 2:8] = np.random.default_rng(0).integers(0, 2, (6, 6, 1)) * 235 + 20
    large = cv2.resize(mark, (200, 200), interpolation=cv2.INTER_NEAREST)
    flat = np.array([(0, 0), (200, 0), (200, 200), (0, 200)], np.float32)
    turn = cv2.getPerspectiveTransform(flat, np.array([(110, 60), (250, 80), (240, 210), (100, 190)], np.float32))
    picture = cv2.warpPerspective(large, turn, (360, 260), borderValue=(150, 150, 150), flags=cv2.INTER_AREA)
    rough = [(118, 76), (232, 76), (232, 196), (118, 196)]

assert picture is not None
tracker = ms.Tracker(ms.Quadrilateral, ms.ColorModel.dark())
tracker.start(ms.Quadrilateral(rough))
track = tracker.update(ms.Frame(np.asarray(picture, np.uint8)))
print(track.shape.corners.round(2).tolist() if isinstance(track, ms.Track) else f"lost: {track.reason}")
