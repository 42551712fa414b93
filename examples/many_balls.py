"""Follow three equal balls that cross, each under an identity of its own: no camera and no file needed."""

import math

import matchset as ms
from matchset.sim.clips.multi_ball_clip import MultiBallClip, PositionFunction


def swing(phase: float, depth: float) -> PositionFunction:
    """From side to side before the camera, m."""
    return lambda time: (0.6 * math.cos(2.0 * time + phase), 0.12 * math.sin(1.4 * time + phase), depth)


camera = ms.CameraModel.from_fov(640, 480, 1.25)
paths = [swing(0.0, 2.0), swing(2.1, 2.4), swing(4.2, 2.8)]
frames = list(MultiBallClip(camera=camera, paths=paths, marked=[False] * 3, frames=60))
x, y = (float(each) for each in camera.project([(0.6, 0.0, 2.0)])[0])

tracker = ms.MultiTracker(ms.Circle, ms.ColorModel.pick(frames[0].image, x, y), most=5)
for frame in frames:
    words = []
    for target in tracker.update(frame):
        track = target.track
        if isinstance(track, ms.Lost):
            words.append(f"{target.identity}: {track.reason}")
        else:
            words.append(f"{target.identity}: ({track.shape.x:.1f}, {track.shape.y:.1f})")
    print(f"{frame.index:3d}  " + "   ".join(words))
