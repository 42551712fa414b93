"""Poses sent to an autopilot's own estimator by MAVLink, without any sticks: `PosePublisher`.

The conversions are in `matchset.links.mavlink.estimates`.
"""

import contextlib
import math
import time
from collections.abc import Callable, Iterable, Iterator
from typing import Any, Literal, TypeVar, get_args
from urllib.parse import parse_qsl, urlencode

import msgspec

from matchset.app.locate.loop import LocatedFrame
from matchset.links.mavlink import estimates
from matchset.links.mavlink.address import parse_address
from matchset.links.mavlink.axes import CameraAxes
from matchset.links.mavlink.client import AutopilotClient, MavlinkParameters
from matchset.links.mavlink.message import Values
from matchset.links.mavlink.ports import MavlinkPort, open_port
from matchset.localization.pose import Pose
from matchset.media.closing import Closing
from matchset.tracking.track import Lost

Kind = Literal["odometry-ball", "odometry-camera", "landing-target", "target-relative"]
KINDS: tuple[str, ...] = get_args(Kind)
ANGLES = ("roll", "pitch", "yaw", "marker")
OWN = ("as", *ANGLES, "forward", "right", "down")
NO_TURN = (1.0, 0.0, 0.0, 0.0)  # format: quaternion of no rotation
ARDUPILOT = "ArduPilot"

Located = TypeVar("Located", bound=LocatedFrame)


class PublishParameters(msgspec.Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """What is sent of a pose.

    Parameters
    ----------
    kind : str
        ``odometry-ball``: the ball is on the vehicle, the camera stands on the ground. ``odometry-camera``: the camera
        is on the vehicle, the ball stands on the ground. ``landing-target`` (ArduPilot), ``target-relative`` (PX4): the
        camera is on the vehicle, the ball anywhere.
    mount : CameraAxes
        How the camera sits or stands.
    marker_heading : float
        Where marker 0 faces on a vehicle that carries the ball, rad, clockwise from its front: half a turn, to its
        back, as in the paper.
    diameter : float
        Of the ball, m.
    """

    kind: Kind = "odometry-ball"
    mount: CameraAxes = CameraAxes()
    marker_heading: float = math.pi
    diameter: float = 0.28

    def __post_init__(self) -> None:
        if self.kind not in KINDS:
            raise ValueError(f"a pose is sent as {', '.join(KINDS)}, got {self.kind!r}")
        if not (math.isfinite(self.marker_heading) and 0.0 < self.diameter < math.inf):
            raise ValueError(f"a marker's heading and a diameter must be finite, got {self}")


def parse_publisher(text: str, diameter: float = PublishParameters().diameter) -> tuple[str, PublishParameters]:
    """Read where and how poses are sent: ``mavlink:udpout:127.0.0.1:14550?as=landing-target&pitch=-90&forward=0.1``.

    Parameters
    ----------
    text : str
        The URI of a link. After the question mark `as` is the kind, `roll`, `pitch`, `yaw` are the camera's, degrees,
        `forward`, `right`, `down` its place, m, `marker` is the heading of marker 0, degrees.
    diameter : float
        Of the ball, m.

    Returns
    -------
    tuple
        The URI without them, and the parameters.

    Raises
    ------
    ValueError
        If one of them is no number, or the URI has another form.
    """
    where, _, question = text.partition("?")
    given = dict(parse_qsl(question, keep_blank_values=True))
    kind = given.pop("as", PublishParameters().kind)
    numbers = {}
    for name in [name for name in given if name in OWN]:
        try:
            numbers[name] = math.radians(float(given[name])) if name in ANGLES else float(given[name])
        except ValueError:
            raise ValueError(f"{name} must be a number, got {given[name]!r} in {text!r}") from None
        del given[name]
    uri = where + (f"?{urlencode(given)}" if given else "")
    parse_address(uri)
    heading = numbers.pop("marker", PublishParameters().marker_heading)
    mount = CameraAxes(**numbers)
    as_asked: Any = kind  # checked by the struct
    return uri, PublishParameters(kind=as_asked, mount=mount, marker_heading=heading, diameter=diameter)


@contextlib.contextmanager
def published(text: str | None, diameter: float) -> Iterator[Callable[[Iterable[LocatedFrame], bool], Any]]:
    """Give what passes frames on, and sends their poses meanwhile if somebody asked for that.

    Parameters
    ----------
    text : str or None
        As for `parse_publisher`; None: nobody asked.
    diameter : float
        Of the ball, m.
    """
    if text is None:
        yield lambda frames, _: iter(frames)
        return
    with PosePublisher(*parse_publisher(text, diameter)) as publisher:
        yield publisher.pass_on


class PosePublisher(Closing):
    """Sends poses to an autopilot, as a computer on board of it; no sticks and no commands but for telemetry.

    Parameters
    ----------
    uri : str
        See `matchset.links.mavlink.address`.
    parameters : PublishParameters, optional
    port : MavlinkPort, optional
        Used instead of the port that the URI names.
    clock, sleep : callables
        The time, s, and a function that waits; tests replace them.

    Attributes
    ----------
    sent, skipped : int
        Poses that were sent; frames in which there was none, or none with the rotation that the kind needs.

    Raises
    ------
    LinkError
        If the port cannot be opened, or no autopilot is heard.
    """

    def __init__(
        self,
        uri: str,
        parameters: PublishParameters | None = None,
        port: MavlinkPort | None = None,
        clock: Callable[[], float] = time.monotonic,
        sleep: Callable[[float], None] = time.sleep,
    ) -> None:
        self.parameters = parameters or PublishParameters()
        self.sent = self.skipped = 0
        self._clock = clock
        address = parse_address(uri)
        port = open_port(address) if port is None else port
        self.client = AutopilotClient(uri, address, port, MavlinkParameters(), clock, sleep)
        try:
            self.client.find(on_board=True)
        except BaseException:
            port.close()
            raise

    def send(self, pose: Pose | Lost[Pose], time: float | None = None) -> bool:
        """Send a pose, and keep the dialog with the autopilot going; call it for every frame.

        Parameters
        ----------
        pose : Pose or Lost
        time : float, optional
            When the picture was taken, s, on the clock of `time.monotonic`, as frames of a live camera have it; now if
            it is not given.

        Returns
        -------
        bool
            Whether it was sent.

        Raises
        ------
        LinkError
            If the port is gone or the autopilot silent.
        """
        self.client.check()
        message = None if isinstance(pose, Lost) else self._message(pose, self._clock() if time is None else time)
        if message is None:
            self.skipped += 1
            return False
        self.client.write(*message)
        self.sent += 1
        return True

    def pass_on(self, frames: Iterable[Located], live: bool) -> Iterator[Located]:
        """Send the pose of every frame that passes.

        Parameters
        ----------
        frames : iterable of LocatedFrame
        live : bool
            Whether their times are those of `time.monotonic`.
        """
        for located in frames:
            pose = located.pose
            self.send(pose, pose.time if live and isinstance(pose, Pose) else None)
            yield located

    def close(self) -> None:
        """Close the port."""
        self.client.close()

    def _message(self, pose: Pose, when: float) -> tuple[str, Values] | None:
        """Return the message of a pose; None where it needs a rotation that was not observed."""
        p = self.parameters
        if p.kind == "landing-target":
            return "LANDING_TARGET", estimates.landing_target(pose, p.mount, p.diameter, when)
        if p.kind == "target-relative":
            attitude = self.client.telemetry.attitude
            return "TARGET_RELATIVE", estimates.target_relative(pose, p.mount, attitude, when)
        if p.kind == "odometry-camera":
            values = estimates.odometry_of_camera(pose, p.mount, when)
        else:
            values = estimates.odometry_of_ball(pose, p.mount, p.marker_heading, when)
        if values is not None and pose.rotation_matrix is None and self.client.autopilot.name == ARDUPILOT:
            values["q"] = NO_TURN  # it takes no NaN; its variance says that it is not known
        return None if values is None else ("ODOMETRY", values)
