"""Track a rendered balloon from one click: no camera and no file needed."""

import matchset as ms
from matchset.sim.clips.clip import Clip

clip = Clip(frames=30)
frames = [frame for frame, _ in clip]
color = ms.ColorModel.pick(frames[0].image, *clip.first_click)
tracker = ms.Tracker(ms.Circle, color, start=clip.first_click)
for frame in frames:
    track = tracker.update(frame)
    if isinstance(track, ms.Lost):
        print(frame.index, "lost:", track.reason)
        continue
    ball, sigma = track.shape, track.covariance.diagonal() ** 0.5
    print(
        f"{frame.index:3d}  x {ball.x:6.2f} ± {sigma[0]:.2f}  y {ball.y:6.2f} ± {sigma[1]:.2f}  "
        f"radius {ball.radius:6.2f} ± {sigma[2]:.2f} px"
    )
