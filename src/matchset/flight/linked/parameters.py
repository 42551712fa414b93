"""What a real follower is made of, as a TOML file names it: `LinkedFollower`; and the times of a real flight."""

import math

import msgspec

from matchset.media.streams.silence import Silence
from matchset.media.upright.orientation import check_turn
from matchset.media.upright.view import WantedFields
from matchset.numeric.arguments import require_within

MOST_COUNTDOWN, MOST_WAIT, MOST_SILENCE = 60.0, 0.09, 10.0  # format: s; the transmitter holds the sticks after 0.1 s


class LinkedParameters(msgspec.Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """Times of a real flight; a simulated one has no use for them.

    Parameters
    ----------
    countdown : float
        Time from the first picture until the followers are armed, s. More is time to take hands away, and to see
        whether each of them sees its ball; less is a shorter start. Chosen by hand.
    wait : float
        Longest wait for a picture, s: then a command leaves without one. More leaves the transmitter alone, which holds
        the sticks after 0.1 s; less sends commands that rest on no new picture. Chosen by hand: more than a period of a
        camera with 15 pictures a second.
    silence : float
        Time without a picture after which a camera is gone, s; a flight ends when its vehicles are down. One that has
        not begun waits `reconnect` longer. More waits longer for a camera that comes back, less gives up at a hiccup.
        Chosen by hand: longer than the safety filter needs to begin a descent.
    """

    countdown: float = 5.0
    wait: float = 0.08
    silence: float = 2.0

    def __post_init__(self) -> None:
        require_within(self, {"countdown": (0.0, MOST_COUNTDOWN)})
        if not 0.0 < self.wait <= MOST_WAIT:
            raise ValueError(f"wait must be above 0 and at most {MOST_WAIT:g}, got {self.wait}")
        if not self.wait <= self.silence <= MOST_SILENCE:
            raise ValueError(f"silence must be within wait ... {MOST_SILENCE:g}, got {self.silence}")


class LinkedFollower(msgspec.Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """One real follower: where its pictures come from and its commands go, and what its ball looks like.

    Parameters
    ----------
    camera : int or str
        Number or path of a camera, or URL of a stream.
    link : str
        URI of its link, as `matchset.links.connect.connect` opens it.
    camera_file : str
        A camera file, as `matchset calibrate` writes it; empty: `fov_deg` counts.
    fov_deg : float or None
        Horizontal field of view, degree, of a lens without distortion.
    focal_sigma : float or None
        Standard deviation of the focal length, as a share of it: it counts in the covariance of every pose, and moves
        no stick. None: as the camera file says; of `fov_deg`, taken as exact.
    color, marker_color : tuple of str
        Files of colors, as `matchset learn` writes them; several are joined: of the ball, and of its marker.
    delay_ms : float
        Time that a picture takes from its exposure to the time stamp that it gets here, ms: of a stream without stamps
        that is the way of the picture. It counts as part of the picture's age.
    exposure, white_balance, fps : float or None
        What to ask of the camera, as of `matchset.media.video.Video`. An exposure held short keeps the ball's outline
        sharp in flight; None: what the camera does.
    turn : int
        Degrees by which its pictures, and the camera file, are turned, clockwise: 0, 90, 180 or 270, for a camera that
        hangs upside down.
    mirror : bool
        Whether left and right are swapped after that, for a camera behind a mirror.
    fields : str
        As of `matchset.media.video.Video`: each field of an analog camera as a picture of its own, "top" or "bottom"
        by which comes first, or "auto".
    timeout, reconnect : float or None
        As of `matchset.media.video.Video`, s: after which silence the camera is opened again, and for how long that is
        tried. It happens beside the loop, which flies on without pictures and lands as its safety says. None: as there.
    """

    camera: int | str
    link: str
    camera_file: str = ""
    fov_deg: float | None = None
    focal_sigma: float | None = None
    color: tuple[str, ...] = ()
    marker_color: tuple[str, ...] = ()
    delay_ms: float = 0.0
    exposure: float | None = None
    white_balance: float | None = None
    fps: float | None = None
    turn: int = 0
    mirror: bool = False
    fields: WantedFields = "frames"
    timeout: float | None = None
    reconnect: float | None = None

    def __post_init__(self) -> None:
        check_turn(self.turn)
        if self.fov_deg is not None and not 0.0 < self.fov_deg < 180.0:
            raise ValueError(f"fov_deg must lie between 0 and 180, got {self.fov_deg:g}")
        if self.focal_sigma is not None and not 0.0 <= self.focal_sigma < 1.0:
            raise ValueError(f"focal_sigma is a share of the focal length, from 0 to 1, got {self.focal_sigma:g}")
        if not (math.isfinite(self.delay_ms) and 0.0 <= self.delay_ms <= 1000.0):
            raise ValueError(f"delay_ms must be within 0 ... 1000, got {self.delay_ms:g}")
        self.silence.checked()

    def check(self) -> None:
        """Refuse what lacks a camera's model or a color, with what to run (ValueError)."""
        source = self.camera
        if bool(self.camera_file) == (self.fov_deg is not None):
            raise ValueError(
                f"say what camera {source} is like: --camera-file FILE (camera_file), made by 'matchset calibrate "
                f"{source} --board 9x6 --square 0.025 -o camera.toml', or --fov DEG (fov_deg), its horizontal field of "
                "view; one of the two"
            )
        for files, option, what, click in (
            (self.color, "--color ball.npz (color)", "ball", "--pick X,Y"),
            (self.marker_color, "--marker-color marker.npz (marker_color)", "marker", "--pick X,Y --marker"),
        ):
            if not files:
                raise ValueError(
                    f"say what color the {what} has: {option}, made by 'matchset learn {source} {click} -o "
                    f"{what}.npz'; 'matchset learn {source}' shows a picture with its pixels"
                )

    @property
    def silence(self) -> Silence:
        """How much silence of its camera is borne."""
        return Silence(reconnect=self.reconnect) if self.timeout is None else Silence(self.timeout, self.reconnect)

    @property
    def words(self) -> str:
        """For people: camera and link, a password in an address left out."""
        camera = f"camera {self.camera}" if str(self.camera).isdigit() else without_password(str(self.camera))
        return f"{camera}, {self.link}"


def without_password(address: str) -> str:
    """Write an address without its user and password."""
    scheme, mark, rest = address.partition("://")
    host, slash, path = rest.partition("/")
    return scheme + mark + host.rpartition("@")[2] + slash + path if mark else address
