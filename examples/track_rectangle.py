"""Track a rectangle that moves and turns, from one click, and compare its corners with the truth."""

import numpy as np

import matchset as ms
from matchset.sim.clips.shape_clip import ShapeClip

clip = ShapeClip(corners=((-1.5, -1.0), (1.5, -1.0), (1.5, 1.0), (-1.5, 1.0)), frames=30, seed=100)
x, y = clip.first_click
tracker: ms.Tracker[ms.Rectangle] | None = None
for frame, truth in clip:
    if tracker is None:
        tracker = ms.Tracker(ms.Rectangle, ms.ColorModel.pick(frame.image, x, y, ball=False), start=(x, y))
    track = tracker.update(frame)
    if isinstance(track, ms.Lost):
        print(frame.index, "lost:", track.reason)
        continue
    box = track.shape
    error_px = min(np.hypot(*(np.roll(box.corners, k, axis=0) - truth).T).mean() for k in range(4))
    print(
        f"{frame.index:3d}  x {box.x:.1f}  y {box.y:.1f}  {box.width:.1f} × {box.height:.1f} px  "
        f"angle {np.degrees(box.angle):+.1f}°  corners off by {error_px:.2f} px"
    )
