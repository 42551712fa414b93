"""What a feed of the live page shows, without a camera: pictures and answers made up."""

from collections.abc import Callable, Sequence
from typing import Any

import msgspec
import numpy as np

import matchset as ms
from matchset.live.feed import Feed, Panel, StreamPicture
from matchset.live.session import Session
from matchset.live.wire.state import State, TargetState
from matchset.localization.pose import Pose
from matchset.tracking.track import Lost

SIZE = 160, 120
CAMERA = ms.CameraModel.from_fov(*SIZE, 1.0)


def seen_of(number: int, found: bool = True, fps: float = 30.0, targets: int = 1) -> StreamPicture:
    """A picture with a number in its gray level, and targets at places that follow from it."""
    image = np.full((SIZE[1], SIZE[0], 3), 40 + 4 * number % 200, np.uint8)
    time = 100.0 + number / fps
    states, poses = [], dict[int, Any]()
    for each in range(1, targets + 1):
        if not found:
            states.append(TargetState(each, f"circle {each}", False, reason="too few edge points"))
            poses[each] = Lost("too few edge points", time)
            continue
        x, y, radius = 50.0 + number % 40, 60.0, 12.5
        values: dict[str, tuple[float, float | None]] = {"x": (x, 0.1), "y": (y, 0.2), "radius": (radius, 0.05)}
        outline = [x - radius, y, x, y - radius, x + radius, y, x, y + radius]
        states.append(TargetState(each, f"circle {each}", True, values, outline, support=0.9, diameter=0.28))
        covariance = np.diag([1e-4, 1e-4, 4e-4, 3.3, 3.3, 3.3])
        poses[each] = Pose(
            position=np.array((0.1, 0.2, 1.5)),
            rotation_matrix=None,
            covariance=covariance,
            observed="position",
            time=time,
        )
    state = State(number + 1, number, time, *SIZE, states, camera_fps=fps, live=True)
    return StreamPicture(ms.Frame(image, time, number), state, poses, CAMERA)


class MadeUpStream:
    """A stream whose newest picture is set."""

    def __init__(self) -> None:
        self.seen = StreamPicture(None, State(0, 0, 0.0, 0, 0, fault="the source is being opened"))


class MadeUpFeed(Feed):
    """Shows what it is given."""

    kind, title = "camera", "made up"

    def __init__(self, streams: int = 1, panels: Sequence[Panel] = ()) -> None:
        self.made = [MadeUpStream() for _ in range(streams)]
        self.streams, self.panels = self.made, panels
        self.tell: Callable[[int], object] = lambda _: None

    def show(self, seen: StreamPicture, stream: int = 0) -> None:
        """Show a picture, as the thread of a loop does."""
        self.made[stream].seen = seen
        self.tell(stream)

    def close(self) -> None:
        """Nothing is open."""


def shown(feed: MadeUpFeed, session: Session) -> MadeUpFeed:
    """Show a feed in a session."""
    feed.tell = session.hear
    session.show(feed)
    return feed


def with_image(seen: StreamPicture, image: np.ndarray) -> StreamPicture:
    """The same with another picture."""
    return seen._replace(frame=ms.Frame(image, seen.state.time, seen.state.index))


def numbered(seen: StreamPicture, sequence: int) -> StreamPicture:
    """The same with another number."""
    return seen._replace(state=msgspec.structs.replace(seen.state, sequence=sequence))
