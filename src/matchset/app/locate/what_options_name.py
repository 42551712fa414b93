"""The options of `matchset locate`: from text and files to ball (`ball_target`), colors (`targets_for`) and camera."""

import functools
import math
import shlex
from collections.abc import Callable
from pathlib import Path

import msgspec

from matchset.app.cli_options import TargetOptions, source_words
from matchset.app.locate.loop import Locator
from matchset.app.locate.options import LocateOptions, MarkerOptions
from matchset.app.parameters_file import tracker_parameters
from matchset.app.target.frame_picker import lit_frame_at
from matchset.app.target.target_options import LearnedTarget, check_target_options, load_color, parse_pick, target_for
from matchset.app.track.loop import FrameTracker, trackers_for
from matchset.camera.camera_model import CameraModel
from matchset.image.color import ColorModel
from matchset.image.files.limits import LIMITS
from matchset.image.files.reading import read_text
from matchset.image.frame import Frame
from matchset.localization.ball_target import BALLOON, BallTarget
from matchset.localization.localizer import Localizer
from matchset.localization.markers.ball_colors import pick_marker
from matchset.localization.markers.marker_tracker import MarkerTracker
from matchset.media.upright.square_pixels import check_square
from matchset.media.video import Video
from matchset.shapes.circle import Circle
from matchset.tracking.tracker import Tracker

_KEYS = "diameter, diameter_sigma, marker_diameter (m) and markers = [[x, y, z], ...]"


class BallFile(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """The ball as TOML describes it.

    Parameters
    ----------
    markers : tuple of (float, float, float)
        Directions from the ball's center to its markers, of any length, in the ball frame: z out of the ball through
        marker 0, y down, x = y cross z.
    diameter, marker_diameter, diameter_sigma : float or None
        m.
    """

    markers: tuple[tuple[float, float, float], ...]
    diameter: float | None = None
    marker_diameter: float | None = None
    diameter_sigma: float | None = None


def read_ball(path: Path) -> BallFile:
    """Read a ball from a TOML file.

    Parameters
    ----------
    path : Path

    Returns
    -------
    BallFile
        With unit vectors as markers.

    Raises
    ------
    ValueError
        If there is no such file, or it holds something else; the message names file and key.
    """
    try:
        ball = msgspec.toml.decode(read_text(path, LIMITS.text), type=BallFile)
    except FileNotFoundError:
        raise ValueError(f"no such file: {path}") from None
    except OSError as error:
        raise ValueError(f"cannot read {path}: {error.strerror}") from error
    except (msgspec.DecodeError, UnicodeDecodeError, RecursionError) as error:
        raise ValueError(f"{path}: a ball is {_KEYS} in TOML: {error}") from None
    if not ball.markers:
        raise ValueError(f"{path}: markers is empty; without markers leave the file out")
    return msgspec.structs.replace(ball, markers=tuple(_unit_vector(path, marker) for marker in ball.markers))


def ball_target(
    diameter: float | None,
    marker_diameter: float | None,
    markers: Path | None,
    marked: bool,
    diameter_sigma: float | None = None,
) -> BallTarget:
    """Combine the options and the file that describe the ball; an option overrides the file.

    Parameters
    ----------
    diameter, marker_diameter : float or None
        As typed, m.
    markers : Path or None
        The file with the directions of the markers; without it there is one marker.
    marked : bool
        Whether markers are looked for.
    diameter_sigma : float, optional
        Standard deviation of the diameter, as typed, m.

    Raises
    ------
    ValueError
        If the diameter is missing, a number is out of range, or markers are described without their color.
    """
    if not marked and (markers is not None or marker_diameter is not None):
        option = "--marker-diameter" if markers is None else "--markers"
        raise ValueError(f"{option} needs the markers' color: give --marker-pick X,Y[@FRAME] or --marker-color FILE")
    file = BallFile(markers=BALLOON.markers) if markers is None else read_ball(markers)
    known = file.diameter if diameter is None else diameter
    if known is None:
        raise ValueError("say how large the ball is: --diameter 0.28, in m")
    sigma = (file.diameter_sigma if diameter_sigma is None else diameter_sigma) or 0.0
    if not marked:
        return BallTarget(known, diameter_sigma=sigma)
    across = file.marker_diameter if marker_diameter is None else marker_diameter
    if across == 0.0:
        raise ValueError("a marker's diameter must be positive, got 0 m")
    return BallTarget(known, file.markers, across or 0.0, sigma)


def _unit_vector(path: Path, marker: tuple[float, float, float]) -> tuple[float, float, float]:
    length = math.hypot(*marker)
    if not 1e-6 < length < 1e6:
        raise ValueError(f"{path}: markers must be directions of three numbers, not all zero, got {list(marker)}")
    x, y, z = (value / length for value in marker)
    return x, y, z


def check_options(options: LocateOptions) -> None:
    """Check the options that belong together.

    Raises
    ------
    ValueError
        If none or several of them say what to track or what the camera is like, both say what color the markers have,
        or one cannot be read.
    """
    check_target_options(options.target, shlex.join(source_words(options.source, options.topic, options.view)))
    marker = options.marker
    if marker.marker_pick is not None and marker.marker_color:
        raise ValueError("give one of --marker-pick and --marker-color, not both")
    if marker.marker_pick is not None:
        parse_pick(marker.marker_pick, "--marker-pick")
    if (options.camera is None) == (options.fov is None):
        raise ValueError(
            "say what the camera is like: --camera FILE from 'matchset calibrate', or --fov DEG, its horizontal "
            "field of view; one of the two"
        )
    if options.fov is not None and not 0.0 < options.fov < 180.0:
        raise ValueError(f"--fov must lie between 0 and 180 degrees, got {options.fov:g}")
    if options.focal_sigma is not None and not 0.0 <= options.focal_sigma < 1.0:
        raise ValueError(
            f"--focal-sigma is a share of the focal length, from 0 to 1: 0.05 is 5 %, got {options.focal_sigma:g}"
        )


def targets_for(
    video: Video, options: TargetOptions, marker: MarkerOptions
) -> tuple[LearnedTarget, ColorModel | None, tuple[Frame, ...]]:
    """Learn what to track, and the color of its markers, in a video that is about to be read.

    Parameters
    ----------
    video : Video
        Not yet read; a file is opened a second time to learn from it.
    options, marker : TargetOptions, MarkerOptions
        As typed.

    Returns
    -------
    target : LearnedTarget
        The ball, in its own color and the markers' (the paper's filter a).
    color : ColorModel or None
        Of the markers alone (the paper's filter b).
    frames : tuple of Frame
        Frames that were taken from a live source to learn from; they are to be tracked too.
    """
    target, taken = target_for(video, options)
    color, taken = marker_color_of(video, marker, target.frame, taken)
    if color is None:
        return target, None, taken
    return msgspec.structs.replace(target, color=target.color | color), color, taken


def marker_color_of(
    video: Video, marker: MarkerOptions, clicked: int, taken: tuple[Frame, ...]
) -> tuple[ColorModel | None, tuple[Frame, ...]]:
    """Learn the color of the markers alone, as `targets_for`; `clicked`: the frame in which a ball was clicked."""
    if not marker.given:
        return None, taken
    if marker.marker_pick is None:
        return load_color(marker.marker_color or ()), taken
    x, y, index = parse_pick(marker.marker_pick, "--marker-pick")
    frame, taken = _frame_of(video, clicked if index is None else index, taken)
    return pick_marker(frame.image, x, y), taken


def _frame_of(video: Video, index: int, taken: tuple[Frame, ...]) -> tuple[Frame, tuple[Frame, ...]]:
    """Return the frame in which a marker was clicked; of a live source, the ball's frame if it is late enough."""
    if not video.live:
        with video.again() as second:
            return lit_frame_at(second, index), taken
    if taken and taken[-1].index >= index:
        return taken[-1], taken
    frame = lit_frame_at(video, index)
    return frame, (*taken, frame)


def load_camera(options: LocateOptions) -> CameraModel | None:
    """Load the camera of `--camera`, if it is given."""
    return None if options.camera is None else CameraModel.load(options.camera)


def camera_for(video: Video, options: LocateOptions, loaded: CameraModel | None) -> CameraModel:
    """Return the loaded camera, turned as the pictures are, or that of `--fov`.

    Raises
    ------
    ValueError
        If it is for pictures of another size, or their pixels are not square.
    """
    check_square(video.pixel_aspect, "--stored-pixels")
    if loaded is None:
        camera = CameraModel.from_fov(video.width, video.height, math.radians(options.fov or 0.0))
    else:
        camera = loaded.turned(**options.view.mounted.arguments)
    camera.check((video.width, video.height))
    return camera if options.focal_sigma is None else camera.with_focal_sigma(options.focal_sigma)


def ball_tracker(options: LocateOptions) -> Callable[..., Tracker[Circle]]:
    """Return what makes the tracker of the ball, of its color."""
    parameters = tracker_parameters(options.params)
    return functools.partial(Tracker, Circle, points=options.points, parameters=parameters)


def locator_of(
    options: LocateOptions,
    target: LearnedTarget,
    marker_color: ColorModel | None,
    camera: CameraModel,
    ball: BallTarget,
    before: FrameTracker | None = None,
) -> Locator:
    """Make what tracks and locates the ball, and markers of a color, if there are any; `before`: see `trackers_for`."""
    marker_tracker = None if marker_color is None else MarkerTracker(marker_color, ball)
    return Locator(trackers_for(target, ball_tracker(options), before), marker_tracker, Localizer(camera, ball))
