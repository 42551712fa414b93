"""Compute a steering signal toward a ball, in a loop of your own: python examples/own_loop_camera.py [CAMERA]."""

import sys
import time

import matchset as ms

number = int(sys.argv[1]) if len(sys.argv) > 1 else 0
tracker: ms.Tracker[ms.Circle] | None = None
print("Hold the ball in the middle of the picture. Ctrl-C ends it.")

try:
    with ms.Video(number) as camera:
        for frame in camera:  # always the newest frame; older ones are dropped
            middle = frame.image.shape[1] / 2, frame.image.shape[0] / 2
            if frame.index < 15:  # the exposure settles
                continue
            if tracker is None:
                tracker = ms.Tracker(ms.Circle, ms.ColorModel.pick(frame.image, *middle), start=middle)
            answer = tracker.update(frame)
            if isinstance(answer, ms.Lost):
                print(f"stop: {answer.reason}")
                continue
            turn = answer.shape.x / middle[0] - 1.0  # -1 ... 1, right is positive
            age_ms = 1000.0 * (time.monotonic() - frame.time)
            print(f"turn {turn:+.2f}  radius {answer.shape.radius:.0f} px  age {age_ms:.0f} ms")
except ms.LinkError as error:
    sys.exit(f"{error}: is a camera plugged in? Another one: python {sys.argv[0]} 1")
except ValueError as error:
    sys.exit(f"error: {error}")
except KeyboardInterrupt:
    print("stopped")
