"""Opens what a real flight needs: files first, then cameras, then pilots, then links: `open_flight`."""

import contextlib
import math
from collections.abc import Callable, Iterator, Sequence
from contextlib import ExitStack
from pathlib import Path
from typing import NamedTuple

import msgspec

from matchset.app.exit_codes import print_note
from matchset.app.target.target_options import load_color
from matchset.camera.camera_model import CameraModel
from matchset.flight.chain.chain_step import FlightKind, FlightSetup
from matchset.flight.chain.config import with_world
from matchset.flight.chain.flight_parameters import FlightParameters
from matchset.flight.chain.pilot import Pilot
from matchset.flight.linked.dry_link import DryLink
from matchset.flight.linked.followers import LinkedFollowers
from matchset.flight.linked.linked_flight import LinkedFlight
from matchset.flight.linked.live_camera import LiveCamera
from matchset.flight.linked.parameters import LinkedFollower
from matchset.flight.linked.vehicle_kind import for_links, start_video
from matchset.flight.real_time.rehearsal import RehearsalLink
from matchset.image.errors import LinkError
from matchset.image.frame import Frame
from matchset.links.connect import connect
from matchset.links.link import Link
from matchset.links.simulation_parameters import FPS
from matchset.localization.markers.ball_colors import BallColors
from matchset.media.video import Video

MOST_FOLLOWERS = 19  # format: the last vehicle of a chain of 20 follows nobody


class LinkedFiles(NamedTuple):
    """What the files of a follower hold.

    Attributes
    ----------
    camera : CameraModel or None
        None where the field of view counts.
    colors : BallColors
    """

    camera: CameraModel | None
    colors: BallColors


def read_files(follower: LinkedFollower) -> LinkedFiles:
    """Read camera file and colors.

    Raises
    ------
    ValueError
        If one is not named, is missing or no such file: says what to run.
    """
    follower.check()
    ball, marker = load_color(follower.color), load_color(follower.marker_color)
    camera = CameraModel.load(follower.camera_file) if follower.camera_file else None
    if camera is not None:
        camera = camera.turned(follower.turn, follower.mirror)
    return LinkedFiles(camera, BallColors(ball | marker, marker))


def open_camera(follower: LinkedFollower, model: CameraModel | None, flight: FlightParameters) -> LiveCamera:
    """Open a follower's camera.

    Raises
    ------
    ValueError
        If it is not live, or the camera file is for pictures of another size.
    LinkError
        If it cannot be opened.
    """
    name = follower.words.partition(",")[0]
    source = str(follower.camera)
    if Path(source).exists() and not Path(source).is_char_device():
        raise ValueError(f"--camera must be a camera or a stream, and {source} is a file: nobody can fly by the past")
    start_video(follower)
    silence = follower.silence
    video = Video(
        source,
        exposure=follower.exposure,
        white_balance=follower.white_balance,
        fps=follower.fps,
        turn=follower.turn,
        mirror=follower.mirror,
        fields=follower.fields,
        timeout=silence.timeout,
        reconnect=silence.reconnect,
        note=print_note,
    )
    try:
        size = video.width, video.height
        model = model or CameraModel.from_fov(*size, math.radians(follower.fov_deg or 0.0))
        model.check(size)
        model = model if follower.focal_sigma is None else model.with_focal_sigma(follower.focal_sigma)
    except ValueError:
        video.close()
        raise
    return LiveCamera(name, video, model, follower.delay_ms, flight.linked)


def open_link(uri: str, dry: bool) -> Link:
    """Open a link; in a dry run one that hands on no throttle.

    Raises
    ------
    ValueError
        If no link has this scheme, or it is a simulated one.
    LinkError
        If the device cannot be opened, or does not answer.
    """
    if uri.startswith("sim:"):
        raise ValueError(f"--link {uri}: a simulated chain has cameras of its own; type: matchset fly {uri}")
    link = connect(uri)
    return DryLink(link) if dry else link


@contextlib.contextmanager
def _naming(uri: str) -> Iterator[None]:
    """Say whose link failed."""
    try:
        yield
    except LinkError as error:
        words, device = str(error), uri.partition("://")[2] or uri
        raise LinkError(words if device in words else f"{uri}: {words}") from error


def open_followers(
    parameters: FlightParameters, followers: Sequence[LinkedFollower], dry: bool
) -> tuple[LinkedFollowers, FlightSetup]:
    """Read the files of all followers, open their cameras, make their pilots, and open their links.

    The links come last, and wait for no compiler.

    Parameters
    ----------
    parameters : FlightParameters
        Its world does not count, but for the number of vehicles, which is set.
    followers : sequence of LinkedFollower
        In the order of the chain.
    dry : bool
        Whether no throttle is sent.

    Raises
    ------
    ValueError, LinkError
        If a file, a camera or a link is not what it should be; all that was opened is closed.
    """
    check_followers(followers)
    files = [read_files(follower) for follower in followers]
    parameters = for_links(parameters, [follower.link for follower in followers])
    parameters = with_world(parameters, vehicles=len(followers) + 1)
    with ExitStack() as stack:
        cameras = []
        for follower, each in zip(followers, files, strict=True):
            cameras.append(open_camera(follower, each.camera, parameters))
            stack.callback(cameras[-1].close)
        samples = tuple(_sample(camera) for camera in cameras)
        pilots = [
            Pilot(camera, RehearsalLink(), each.colors, parameters.loop)
            for camera, each in zip(cameras, files, strict=True)
        ]
        for pilot, follower in zip(pilots, followers, strict=True):
            with _naming(follower.link):
                pilot.link = open_link(follower.link, dry)
            stack.callback(pilot.link.close)
        kind: FlightKind = "dry run" if dry else "flight"
        setup = FlightSetup(
            parameters,
            tuple(camera.model for camera in cameras),
            samples,
            kind=kind,
            colors=tuple(each.colors for each in files),
            countdown=0.0 if dry else parameters.linked.countdown,
            fps=min(camera.video.fps or FPS for camera in cameras),
            devices=tuple(follower.words for follower in followers),
        )
        opened = LinkedFollowers(pilots)
        stack.pop_all()
    return opened, setup


def check_followers(followers: Sequence[LinkedFollower]) -> None:
    """Refuse too many followers, and two with one camera or one link (ValueError)."""
    if not 1 <= len(followers) <= MOST_FOLLOWERS:
        raise ValueError(f"a chain has 1 to {MOST_FOLLOWERS} followers, got {len(followers)}")
    key: Callable[[LinkedFollower], str]
    for name, key in (("camera", lambda each: str(each.camera)), ("link", lambda each: each.link)):
        named = [key(each) for each in followers]
        twice = next((each for each in named if named.count(each) > 1), None)
        if twice is not None:
            raise ValueError(f"two followers have the {name} {twice}: each needs its own")


def _sample(camera: LiveCamera) -> Frame:
    """Return a first picture, at time 0."""
    return msgspec.structs.replace(next(camera.video), time=0.0)


def open_flight(parameters: FlightParameters, followers: Sequence[LinkedFollower], dry: bool) -> LinkedFlight:
    """Open a real flight; see `open_followers`."""
    return LinkedFlight(*open_followers(parameters, followers, dry))
