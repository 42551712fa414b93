"""Track a flat printed thing without color: python examples/track_print.py [VIDEO X,Y X,Y X,Y X,Y] (rough corners)."""

import sys
from collections.abc import Iterable

import matchset as ms
from matchset.sim.clips.shape_clip import ShapeClip

words = sys.argv[1:]
if words and len(words) != 5:
    sys.exit(__doc__)
try:
    frames: Iterable[ms.Frame]
    if words:
        frames = ms.Video(words[0])
        corners = [tuple(map(float, word.split(","))) for word in words[1:]]
    else:  # a dark card that turns before a room
        card = ((-1.5, -1.0), (1.5, -1.0), (1.5, 1.0), (-1.5, 1.0))
        clip = ShapeClip(corners=card, color=(40.0, 40.0, 40.0), tilt=0.4, frames=30, seed=101)
        frames, corners = (frame for frame, _ in clip), clip.outline(0.0).round(-1).tolist()
    tracker = ms.Tracker(ms.Quadrilateral, ms.ColorModel.edges())
    tracker.start(ms.Quadrilateral(corners))
    for frame in frames:
        track = tracker.update(frame)
        if isinstance(track, ms.Track):
            places = "  ".join(f"({x:.1f}, {y:.1f})" for x, y in track.shape.corners)
            print(f"{frame.index:4d}  {places}  {track.support:.0%} of it confirmed")
        else:
            print(f"{frame.index:4d}  lost: {track.reason}")
except ValueError as error:  # no such file, corners that are no quadrilateral
    sys.exit(f"error: {error}")
