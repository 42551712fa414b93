"""`matchset calibrate --mount`: from a ball at measured places to how camera and marker are turned."""

import datetime
import math
import shlex
import sys
from collections.abc import Sequence
from typing import NamedTuple

import msgspec
import numpy as np
import numpy.typing as npt

from matchset.app.calibrate.board_command import calibrated_file
from matchset.app.calibrate.options import CalibrateOptions
from matchset.app.calibrate.still_ball import PARAMETERS as STILL
from matchset.app.calibrate.still_ball import still_intervals
from matchset.app.cli_options import TurnOptions
from matchset.app.exit_codes import FOUND, NOT_FOUND, StopRequest, print_error, print_note
from matchset.app.progress import InstructionLine
from matchset.app.target.target_options import load_color
from matchset.camera.camera_model import CameraModel
from matchset.control.mount.mount_fit import (
    FittedMount,
    MarkerPlace,
    MountFitParameters,
    PlacedBall,
    PlaceError,
    fit_mount,
)
from matchset.control.mount.mount_fit import marker_place as place_of_marker
from matchset.image.color import ColorModel
from matchset.image.files.whole_file import write_whole
from matchset.localization.ball_target import BALLOON, BallTarget
from matchset.localization.localizer import Localizer
from matchset.localization.markers.marker_tracker import MarkerTracker
from matchset.localization.pose import Pose
from matchset.media.video import Video
from matchset.shapes.circle import Circle
from matchset.tracking.track import Track
from matchset.tracking.tracker import Tracker

Floats = npt.NDArray[np.float64]


class MountCalibrationParameters(msgspec.Struct, frozen=True):
    """How a calibration of a mount reads its sources.

    Parameters
    ----------
    max_pictures : int
        A source of at most this many frames is a set of pictures of one place, each searched by itself.
    patience : int
        Frames of a live camera in which the ball must be held still, or of a video. Chosen by hand: a minute.
    moved : float
        By how much the ball must have moved before a live camera's next place counts, as a share of its radius: or the
        same place would count twice.
    range_off : float
        Share by which seen and measured distance may differ before a note says so. More than ball and tape are off.
    """

    max_pictures: int = 14
    patience: int = 1800
    moved: float = 0.5
    range_off: float = 0.06


PARAMETERS = MountCalibrationParameters()


class Equipment(NamedTuple):
    """What finds the ball and its marker.

    Attributes
    ----------
    localizer : Localizer
    color : ColorModel
        Of the ball, with its marker.
    marker : ColorModel or None
    mounted : TurnOptions
        How the pictures are turned.
    """

    localizer: Localizer
    color: ColorModel
    marker: ColorModel | None
    mounted: TurnOptions


class HeldAt(NamedTuple):
    """A ball that is held still.

    Attributes
    ----------
    circle : tuple of 3 float
        Center and radius, px.
    position : (3,)
        m, camera frame.
    marker : (3,) or None
        Direction of its marker, camera frame.
    """

    circle: tuple[float, float, float]
    position: Floats
    marker: Floats | None


def parse_place(text: str) -> Floats:
    """Read RIGHT,UP,AHEAD in m; returns right, down, forward."""
    try:
        right, up, ahead = (float(part) for part in text.split(","))
    except ValueError:
        right = up = ahead = math.nan
    if not (math.isfinite(right) and math.isfinite(up) and 0.0 < ahead < math.inf):
        raise ValueError(
            f"--place is how far the ball's center is right of the lens, above it and ahead, m, as in 0,0.19,1.5, "
            f"got {text!r}"
        )
    return np.array((right, -up, ahead))


def calibrate_mount(options: CalibrateOptions) -> int:
    """Measure how a camera is turned on its vehicle, and where the neighbor's marker is on its ball.

    Returns
    -------
    int
        The exit code.
    """
    places = [parse_place(text) for text in options.mount.place or ()]
    sources = options.sources or []
    equipment = _equipment(options)
    path = calibrated_file(options, "mount.toml")
    try:
        with StopRequest() as stop:
            held = _held_balls(sources, len(places), equipment, stop)
        if held is None:
            print("note: stopped; nothing was calibrated", file=sys.stderr)
            return stop.code
        mount = fit_mount([PlacedBall(ball.position, told) for ball, told in zip(held, places, strict=True)])
    except PlaceError as error:
        print_error(f"not calibrated: {error}")
        return NOT_FOUND
    markers = [place_of_marker(ball.marker, mount) for ball in held if ball.marker is not None]
    marker = MarkerPlace(*np.mean(markers, axis=0).tolist()) if markers else None
    write_whole(path, mount_toml(mount, marker).encode())
    _print_report(mount, marker, held, places)
    print(
        f"  {path}\nUse it: matchset fly --config {shlex.quote(str(path))} ..., or copy its table into your flight.toml"
    )
    return FOUND


def _equipment(options: CalibrateOptions) -> Equipment:
    """Read camera and colors, and make what finds the ball."""
    camera = CameraModel.load(options.mount.camera_file or "").turned(**options.mounted.arguments)
    color, markers = load_color(options.target.color or ()), options.mount.marker_color
    diameter = BALLOON.diameter if options.ball_diameter is None else options.ball_diameter
    marker = load_color(markers) if markers else None
    target = BallTarget(diameter, BALLOON.markers) if marker is not None else BallTarget(diameter)
    return Equipment(Localizer(camera, target), color if marker is None else color | marker, marker, options.mounted)


def _held_balls(sources: Sequence[str], count: int, equipment: Equipment, stop: StopRequest) -> list[HeldAt] | None:
    """Find the ball at every place; None if Ctrl-C came first."""
    held: list[HeldAt] = []
    for source in sources:
        with Video(source, note=print_note, **equipment.mounted.arguments) as video:
            for turn in range(count if len(sources) == 1 else 1):
                found = _held_ball(video, equipment, held[-1] if turn else None, len(held) + 1, stop)
                if found is None:
                    return None
                held.append(found)
    return held


def _held_ball(
    video: Video, equipment: Equipment, before: HeldAt | None, number: int, stop: StopRequest
) -> HeldAt | None:
    """Follow the ball until it is held still, elsewhere than before."""
    tracker, pictures = Tracker(Circle, equipment.color), 0 < (video.length or 0) <= PARAMETERS.max_pictures
    target = equipment.localizer.target
    markers = None if equipment.marker is None else MarkerTracker(equipment.marker, target)
    found: list[tuple[int, Track[Circle]]] = []
    poses: list[Pose] = []
    with InstructionLine() as line:
        for count, frame in enumerate(video):
            if stop:
                return None
            if count > PARAMETERS.patience:
                break
            if pictures:
                tracker = Tracker(Circle, equipment.color)
            ball = tracker.update(frame)
            pose = equipment.localizer.update(ball, () if markers is None else markers.update(frame, ball))
            if isinstance(ball, Track) and isinstance(pose, Pose) and _elsewhere(ball.shape, before):
                found.append((frame.index, ball))
                poses.append(pose)
            if video.live and count % 10 == 0:
                line.show(f"hold the ball still at place {number}   (Ctrl-C stops)")
            if not pictures and (still := still_intervals(found[-STILL.min_frames :])):
                return _mean(found, poses, still[-1].first)
    if pictures and found:
        return _mean(found, poses, found[0][0])
    raise PlaceError(f"the ball was not {'held still' if found else 'found'} at place {number}")


def _elsewhere(circle: Circle, before: HeldAt | None) -> bool:
    """Whether a ball is no longer where it was."""
    if before is None:
        return True
    x, y, radius = before.circle
    apart = math.hypot(circle.x - x, circle.y - y) + abs(circle.radius - radius)
    return apart > PARAMETERS.moved * radius


def _mean(found: Sequence[tuple[int, Track[Circle]]], poses: Sequence[Pose], first: int) -> HeldAt:
    """Take the median of a ball's places from a frame on, and the mean direction of its marker."""
    used = [(track.shape, pose) for (index, track), pose in zip(found, poses, strict=True) if index >= first]
    x, y, radius = np.median([(circle.x, circle.y, circle.radius) for circle, _ in used], axis=0).tolist()
    position: Floats = np.median([pose.position for _, pose in used], axis=0)
    turned = [pose.rotation_matrix[:, 2] for _, pose in used if pose.rotation_matrix is not None]
    return HeldAt((x, y, radius), position, np.mean(turned, axis=0) if turned else None)


def mount_toml(mount: FittedMount, marker: MarkerPlace | None) -> str:
    """Write what was measured as settings of a flight."""
    yaw, pitch, roll = mount.sigmas
    level = MountFitParameters().level_sigma
    rows = [
        ("yaw", mount.yaw, yaw, "the camera is turned to the right on its vehicle"),
        ("pitch", mount.pitch, pitch, "it looks up"),
        ("roll", mount.roll, roll, "it is turned clockwise"),
    ]
    if marker is not None:
        rows.append(("marker_yaw", marker.yaw, level, "the neighbor's marker is to the right of its back"))
        rows.append(("marker_elevation", marker.elevation, level, "it is above the ball's equator"))
    lines = [
        f"# How camera and marker are mounted: matchset calibrate --mount, {datetime.date.today().isoformat()}",
        "[flight.pilot.follower.mount]",
        *(f"{key} = {value:.5f}  # rad, {_degrees(value, sigma)}: {words}" for key, value, sigma, words in rows),
        f"pitch_sigma = {pitch:.5f}  # rad, standard deviation of pitch",
    ]
    if marker is not None:
        lines.append(f"marker_sigma = {level:.5f}  # rad, standard deviation of the marker's elevation")
    return "\n".join(lines) + "\n"


def _degrees(value: float, sigma: float) -> str:
    return f"{math.degrees(value):+.1f} ± {math.degrees(sigma):.1f} degrees"


def _print_report(
    mount: FittedMount, marker: MarkerPlace | None, held: Sequence[HeldAt], places: Sequence[Floats]
) -> None:
    for number, (ball, told, misfit) in enumerate(zip(held, places, mount.misfits, strict=True), 1):
        seen, measured = math.hypot(*ball.position), math.hypot(*told)
        print(f"  place {number}: {seen:.2f} m away, measured {measured:.2f} m; {math.degrees(misfit):.1f}° beside it")
        if abs(seen / measured - 1.0) > PARAMETERS.range_off:
            print(f"note: at place {number} the ball's size does not fit its distance", file=sys.stderr)
    for name, value, sigma in zip(
        ("yaw", "pitch", "roll"), (mount.yaw, mount.pitch, mount.roll), mount.sigmas, strict=True
    ):
        print(f"  camera {name:5} {_degrees(value, sigma)}")
    if mount.sigmas[2] > 0.5 * MountFitParameters().roll_sigma:
        print("  roll is hardly seen: add a place to the side")
    level = MountFitParameters().level_sigma
    if marker is None:
        print(
            "  no marker: give --marker-color and put the ball on its vehicle, level, its back straight to the camera"
        )
    else:
        print(f"  marker {_degrees(marker.yaw, level)} to the right, {_degrees(marker.elevation, level)} up")
