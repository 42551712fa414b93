"""`matchset calibrate --ball-diameter`: from tracks of a ball at known distances to a focal length."""

import itertools
import math
import shlex
import sys
from collections.abc import Iterable
from typing import Any

import msgspec

from matchset.app.calibrate.board_command import calibrated_file
from matchset.app.calibrate.options import CalibrateOptions
from matchset.app.calibrate.still_ball import PARAMETERS as STILL
from matchset.app.calibrate.still_ball import StillInterval, still_intervals
from matchset.app.exit_codes import FOUND, NOT_FOUND, StopRequest, print_error, print_note, print_warnings
from matchset.app.progress import InstructionLine, progress_bar
from matchset.app.target.target_options import LearnedTarget, check_target_options, target_for, target_without_picture
from matchset.camera.ball_focal_length import BallFocal, HeldBall, focal_from_ball
from matchset.image.frame import Frame
from matchset.media.video import Video
from matchset.shapes.circle import Circle
from matchset.tracking.track import Track
from matchset.tracking.tracker import Tracker


class BallCalibrationParameters(msgspec.Struct, frozen=True):
    """How a calibration with a ball reads its sources and grades its result.

    Parameters
    ----------
    max_pictures : int
        A source of at most this many frames is a set of pictures, not a video: fewer than `StillParameters.min_frames`.
    good, usable : float
        Standard deviation of the focal length up to which the result is "good" or "usable", percent. Chosen by hand
        from the accuracy in docs/camera.md (1 to 2 %).
    """

    max_pictures: int = 14
    good: float = 1.0
    usable: float = 3.0


PARAMETERS = BallCalibrationParameters()


class _BallTracks(msgspec.Struct):
    """The ball in one source: the size of its pictures, px, and the frames in which it was found, with their index."""

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


def calibrate_ball(options: CalibrateOptions) -> int:
    """Calibrate with a ball.

    Returns
    -------
    int
        The exit code.
    """
    sources, diameter = options.sources or [], options.ball_diameter or 0.0
    distances, radius = parse_distances(options.at or ""), diameter / 2.0
    if not 0.0 < radius < math.inf:
        raise ValueError(f"--ball-diameter must be positive, in m, got {options.ball_diameter}")
    if len(sources) not in (1, len(distances)):
        raise ValueError(
            f"give one video in which the ball is held at all {len(distances)} distances in turn, or one for each; "
            f"got {len(sources)}"
        )
    check_target_options(options.target, shlex.quote(sources[0]))
    path = calibrated_file(options)
    with StopRequest() as stop:
        tracks = _track_sources(sources, options, distances, stop)
        if stop and len(tracks) < len(sources):
            print("note: stopped; nothing was calibrated", file=sys.stderr)
            return stop.code
    try:
        held, size = _held_balls(tracks, distances, radius)
        focal = focal_from_ball(held, radius, *size)
    except ValueError as error:
        print_error(f"not calibrated: {error}")
        return NOT_FOUND
    focal.camera.turned(**options.mounted.undone.arguments).save(path)
    _print_report(focal, distances)
    print(f"  {path}")
    return FOUND


def _track_sources(
    sources: list[str], options: CalibrateOptions, distances: list[float], stop: StopRequest
) -> list[_BallTracks]:
    """Track the ball through every source."""
    tracks: list[_BallTracks] = []
    target = target_without_picture(options.target)
    for source in sources:
        with Video(source, topic=options.topic, note=print_note, **options.mounted.arguments) as video:
            taken: tuple[Frame, ...] = ()
            if target is None:
                target, taken = target_for(video, options.target)
                target.say_notes()
            elif tracks:  # the click was in the first source
                target = msgspec.structs.replace(target, start=None)
            tracks.append(_track(video, itertools.chain(taken, video), target, distances, stop))
            print_warnings(video.warnings)
        if stop and not video.live:
            return tracks[:-1]
    return tracks


def _track(
    video: Video, frames: Iterable[Frame], target: LearnedTarget, distances: list[float], stop: StopRequest
) -> _BallTracks:
    """Track the ball through one source; a camera's is over when the ball was held still at every distance."""
    tracker = Tracker(Circle, target.color, start=target.start)
    tracks = _BallTracks((video.width, video.height), [])
    pictures = 0 < (video.length or 0) <= PARAMETERS.max_pictures
    display = InstructionLine() if video.live else progress_bar("following the ball", video.length)
    with display:
        for frame in frames:
            if pictures:  # they are not consecutive: search each
                tracker = Tracker(Circle, target.color)
            answer = tracker.update(frame)
            if isinstance(answer, Track):
                tracks.found.append((frame.index, answer))
            if not isinstance(display, InstructionLine):
                display.advance()
            elif len(tracks.found) % STILL.min_frames == 0 and _instruct(display, tracks, distances):
                break
            if stop:
                break
    return tracks


def _instruct(display: InstructionLine, tracks: _BallTracks, distances: list[float]) -> bool:
    """Show at which distance to hold the ball next; return whether it was held at all of them."""
    done = len(still_intervals(tracks.found))
    if done >= len(distances):
        return True
    display.show(f"hold the ball still, {distances[done]:.2f} m from the lens   ({done} done)")
    return False


def _held_balls(
    tracks: list[_BallTracks], distances: list[float], radius: float
) -> tuple[list[HeldBall], tuple[int, int]]:
    """Assign the intervals in which the ball was held still to the distances."""
    size = tracks[0].size
    for other in tracks[1:]:
        if other.size != size:
            raise ValueError(f"the sources differ in size: {size[0]} x {size[1]} and {other.size[0]} x {other.size[1]}")
    several = len(tracks) == len(distances)
    intervals = _in_sources(tracks, distances) if several else _in_source(tracks[0], len(distances))
    by_size = sorted(range(len(intervals)), key=lambda i: -intervals[i].radius)
    by_distance = sorted(range(len(intervals)), key=lambda i: distances[i])
    if by_size != by_distance:
        radii = ", ".join(f"{interval.radius:.0f}" for interval in intervals)
        raise ValueError(f"the ball's radii, {radii} px, do not fall with the distances: are these in the same order?")
    return [HeldBall(d + radius, interval.outlines) for d, interval in zip(distances, intervals, strict=True)], size


def _in_sources(tracks: list[_BallTracks], distances: list[float]) -> list[StillInterval]:
    intervals = []
    for source, distance in zip(tracks, distances, strict=True):
        if not source.found:
            raise ValueError(f"the ball was not found at {distance} m")
        still = still_intervals(source.found) or (
            _one_per_picture(source) if len(source.found) <= PARAMETERS.max_pictures else []
        )
        if not still:
            raise ValueError(f"the ball was not held still at {distance} m")
        intervals.append(max(still, key=lambda interval: len(interval.outlines)))
    return intervals


def _in_source(source: _BallTracks, count: int) -> list[StillInterval]:
    if len(source.found) == count:  # a picture for each distance
        return _one_per_picture(source)
    intervals = sorted(still_intervals(source.found), key=lambda interval: -len(interval.outlines))
    if len(intervals) < count:
        raise ValueError(
            f"the ball was held still at {len(intervals)} distance{'s' * (len(intervals) != 1)}, {count} were given. "
            "Hold it for a second or two at each"
        )
    return sorted(intervals[:count], key=lambda interval: interval.first)


def _one_per_picture(source: _BallTracks) -> list[StillInterval]:
    return [StillInterval(index, index, track.shape.radius, [track.match_set]) for index, track in source.found]


def _print_report(focal: BallFocal, distances: list[float]) -> None:
    camera = focal.camera
    std = 0.0 if camera.covariance is None else math.sqrt(camera.covariance[0, 0])
    share = 100.0 * std / camera.fx
    fov = 2.0 * math.degrees(math.atan(camera.width / (2.0 * camera.fx)))
    grade = "good" if share <= PARAMETERS.good else "usable" if share <= PARAMETERS.usable else "poor"
    print(f"The calibration is {grade}, for pictures of {camera.width} x {camera.height} px.")
    print(f"  focal length {camera.fx:.1f} ± {std:.1f} px ({share:.1f} %), field of view {fov:.1f}°")
    print(f"  the camera's center lies {1000.0 * focal.pupil:+.0f} mm behind where the tape began")
    for distance, misfit in zip(distances, focal.misfits, strict=True):
        print(f"  at {distance:.2f} m the ball looks {100.0 * misfit:+.1f} % too large")
    print("Lens distortion and the principal point are not seen this way: a board tells them.")
