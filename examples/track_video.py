"""Track a ball through a video: python examples/track_video.py VIDEO X Y (a pixel on it in frame 0)."""

import sys

import matchset as ms

if len(sys.argv) != 4:
    sys.exit(__doc__)
path, x, y = sys.argv[1], float(sys.argv[2]), float(sys.argv[3])

try:
    with ms.Video(path) as video:
        tracker: ms.Tracker[ms.Circle] | None = None
        for frame in video:
            if tracker is None:
                tracker = ms.Tracker(ms.Circle, ms.ColorModel.pick(frame.image, x, y), start=(x, y))
            answer = tracker.update(frame)
            if isinstance(answer, ms.Track):
                ball = answer.shape
                print(f"{frame.time:.3f} s  x {ball.x:.1f}  y {ball.y:.1f}  radius {ball.radius:.1f} px")
            else:
                print(f"{frame.time:.3f} s  lost: {answer.reason}")
except ValueError as error:  # no such file, a pixel outside the picture, a color like the background
    sys.exit(f"error: {error}")
