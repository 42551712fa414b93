"""`matchset calibrate` with a ball: its tracks at known distances to a focal length."""

import math
import shlex
import sys
from collections.abc import Iterable
from pathlib import Path
from typing import Any

import msgspec

from matchset.app import exit_codes as ending
from matchset.app.calibrate.command import camera_file
from matchset.app.calibrate.still_ball import Still, still_moments
from matchset.app.exit_codes import StopRequest, say_error
from matchset.app.patience import if_slow
from matchset.app.progress import Hint, counting
from matchset.app.track.target_options import Target, Wish, check_wish, known_target, target_in
from matchset.app.track.trackers import COMPILING
from matchset.camera.ball_focal_length import BallFocal, HeldBall, focal_from_ball
from matchset.image.frame import Frame
from matchset.image.video import Video
from matchset.shapes.circle import Circle
from matchset.tracking.track import Track
from matchset.tracking.tracker import Tracker

_PICTURES = 14  # a source of this many frames and less is pictures, not a video of a ball held still


class BallOptions(msgspec.Struct, frozen=True):
    """The options of `matchset calibrate` with a ball, as typed."""

    sources: tuple[str, ...]
    diameter: float
    at: str
    wish: Wish
    out: Path | None = None
    force: bool = False


class _Seen(msgspec.Struct):
    """What was seen of the ball in one source."""

    size: tuple[int, int]
    found: list[tuple[int, Track[Any]]]


def parse_distances(text: str) -> list[float]:
    """Read distances in m: ``0.5,1.0,1.5``."""
    try:
        distances = [float(part) for part in text.split(",")]
    except ValueError:
        distances = []
    if not distances or not all(0.0 < distance < math.inf for distance in distances):
        raise ValueError(f"--at is a list of distances in m, as in 0.5,1.0,1.5, got {text!r}")
    return distances


def calibrate_ball(options: BallOptions) -> int:
    """Run the command with a ball.

    Returns
    -------
    int
        The exit code.
    """
    distances, radius = parse_distances(options.at), options.diameter / 2.0
    if not 0.0 < radius < math.inf:
        raise ValueError(f"--ball-diameter must be positive, in m, got {options.diameter}")
    if len(options.sources) not in (1, len(distances)):
        raise ValueError(
            f"give one video in which the ball is held at all {len(distances)} distances in turn, or one for each; "
            f"got {len(options.sources)}"
        )
    check_wish(options.wish, shlex.quote(options.sources[0]))
    path = camera_file(options.out, options.force)
    with StopRequest() as stop:
        seen = _look(options, distances, stop)
        if stop and len(seen) < len(options.sources):
            print("note: stopped; nothing was calibrated", file=sys.stderr)
            return stop.code
    try:
        held, size = _held(seen, distances, radius)
        focal = focal_from_ball(held, radius, *size)
    except ValueError as error:
        say_error(f"not calibrated: {error}")
        return ending.NOT_FOUND
    focal.camera.save(path)
    _say(focal, distances)
    print(f"  {path}")
    return ending.FOUND


def _look(options: BallOptions, distances: list[float], stop: StopRequest) -> list[_Seen]:
    """Track the ball through every source."""
    seen: list[_Seen] = []
    target = known_target(options.wish)
    for source in options.sources:
        with Video(source) as video:
            ahead: Iterable[Frame] = ()
            if target is None and video.live:
                target, frame = target_in(video, options.wish)
                ahead = (frame,)
            elif target is None:
                with Video(source) as look:
                    target, _ = target_in(look, options.wish)
            start = target.start if source == options.sources[0] else None
            seen.append(_track(video, ahead, target, start, distances, stop))
        if stop and not video.live:
            return seen[:-1]
    return seen


def _track(
    video: Video,
    ahead: Iterable[Frame],
    target: Target,
    start: tuple[float, float] | None,
    distances: list[float],
    stop: StopRequest,
) -> _Seen:
    with if_slow(COMPILING):
        tracker = Tracker(Circle, target.color, start=start)
    seen = _Seen((video.width, video.height), [])
    frames = list(ahead)
    screen = Hint() if video.live else counting("following the ball", video.length)
    with screen:
        for frame in _chained(frames, video):
            if 0 < (video.length or 0) <= _PICTURES:  # pictures of different distances do not follow each other
                tracker = Tracker(Circle, target.color)
            answer = tracker.update(frame)
            if isinstance(answer, Track):
                seen.found.append((frame.index, answer))
            if isinstance(screen, Hint):
                done = len(still_moments(seen.found)) if len(seen.found) % 15 == 0 else None
                if done is not None and done < len(distances):
                    screen.say(f"hold the ball still, {distances[done]:.2f} m from the lens   ({done} done)")
                elif done is not None:
                    break
            else:
                screen.advance()
            if stop:
                break
    return seen


def _chained(first: list[Frame], rest: Iterable[Frame]) -> Iterable[Frame]:
    yield from first
    yield from rest


def _held(seen: list[_Seen], distances: list[float], radius: float) -> tuple[list[HeldBall], tuple[int, int]]:
    """Bring still moments and distances together."""
    size = seen[0].size
    for other in seen[1:]:
        if other.size != size:
            raise ValueError(f"the sources differ in size: {size[0]} x {size[1]} and {other.size[0]} x {other.size[1]}")
    moments = _one_source(seen[0], len(distances)) if len(seen) < len(distances) else _many_sources(seen, distances)
    by_size = sorted(range(len(moments)), key=lambda i: -moments[i].radius)
    by_distance = sorted(range(len(moments)), key=lambda i: distances[i])
    if by_size != by_distance:
        radii = ", ".join(f"{moment.radius:.0f}" for moment in moments)
        raise ValueError(f"the ball's radii, {radii} px, do not fall with the distances: are these in the same order?")
    return [HeldBall(d + radius, moment.outlines) for d, moment in zip(distances, moments, strict=True)], size


def _many_sources(seen: list[_Seen], distances: list[float]) -> list[Still]:
    moments = []
    for source, distance in zip(seen, distances, strict=True):
        if not source.found:
            raise ValueError(f"the ball was not found at {distance} m")
        still = still_moments(source.found) or (_single(source) if len(source.found) <= _PICTURES else [])
        if not still:
            raise ValueError(f"the ball was not held still at {distance} m")
        moments.append(max(still, key=lambda moment: len(moment.outlines)))
    return moments


def _one_source(source: _Seen, count: int) -> list[Still]:
    if len(source.found) == count:  # a picture for each distance
        return _single(source)
    moments = sorted(still_moments(source.found), key=lambda moment: -len(moment.outlines))
    if len(moments) < count:
        raise ValueError(
            f"the ball was held still at {len(moments)} distance{'s' * (len(moments) != 1)}, {count} were given. "
            "Hold it for a second or two at each"
        )
    return sorted(moments[:count], key=lambda moment: moment.first)


def _single(source: _Seen) -> list[Still]:
    return [Still(index, index, track.shape.radius, [track.match_set]) for index, track in source.found]


def _say(focal: BallFocal, distances: list[float]) -> None:
    camera = focal.camera
    spread = 0.0 if camera.covariance is None else math.sqrt(camera.covariance[0, 0])
    share = 100.0 * spread / camera.fx
    fov = 2.0 * math.degrees(math.atan(camera.width / (2.0 * camera.fx)))
    grade = "good" if share <= 1.0 else "usable" if share <= 3.0 else "poor"
    print(f"The calibration is {grade}, for pictures of {camera.width} x {camera.height} px.")
    print(f"  focal length {camera.fx:.1f} ± {spread:.1f} px ({share:.1f} %), field of view {fov:.1f}°")
    print(f"  the camera's center lies {1000.0 * focal.pupil:+.0f} mm behind where the tape began")
    for distance, misfit in zip(distances, focal.misfits, strict=True):
        print(f"  at {distance:.2f} m the ball looks {100.0 * misfit:+.1f} % too large")
    print("Lens distortion and the principal point are not seen this way: a board tells them.")
