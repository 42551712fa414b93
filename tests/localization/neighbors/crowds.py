"""Several balloons, and who watches them."""

import matchset as ms
from matchset.localization.markers.ball_colors import pick_marker
from matchset.sim.clips.multi_ball_clip import MultiBallClip

CAMERA = ms.CameraModel.from_fov(640, 480, 1.25)
TARGET = ms.BallTarget(diameter=0.28, markers=((0, 0, 1),))


def neighbors(seed: int, preset: str) -> ms.Neighbors:
    """Make a watcher whose colors were learnt from one click each, on another picture of the same room."""
    frame = next(
        iter(MultiBallClip(camera=CAMERA, paths=[lambda _: (0.0, 0.0, 1.0)], frames=1, seed=seed, preset=preset))
    )
    purple = pick_marker(frame.image, CAMERA.cx, CAMERA.cy)
    blue = ms.ColorModel.pick(frame.image, CAMERA.cx - 40.0, CAMERA.cy)
    return ms.Neighbors(CAMERA, TARGET, blue | purple, purple)
