"""What a page is told, as msgspec structs: `State` with each picture, `SessionState` whenever it changes."""

from typing import Any

import msgspec


class TargetState(msgspec.Struct, frozen=True, omit_defaults=True):
    """What is known of a target in one picture.

    Parameters
    ----------
    id : int
    name : str
    found : bool
    values : dict of str to (float, float or None)
        The shape's parameters with their standard deviations, px and rad.
    outline : list of float
        x and y of points along the outline, px, one after the other.
    match_set : list of float
        x and y of the edge points, px.
    support : float or None
    position : dict of str to (float, float or None)
        x, y, z and distance in the camera's frame, m, with standard deviations, if diameter and camera are known.
    left_out : str
        What these standard deviations leave out, in words.
    markers : list of list of float
        x and y of points along the rim of each marker in sight, px.
    axes : list of float
        x and y of the ball's center and of the tips of its axes x, y, z, px; empty where no rotation is observed.
    predicted : list of float
        Where it is expected while it is lost: x and y of points along the outline, px; empty if nowhere.
    reason : str
        Why it is lost.
    lost_for : float
        For how long, s.
    diameter : float or None
        m
    diameter_sigma : float
        Its standard deviation, m; 0: taken as exact.
    shape : str
        Of which family it is.
    readings : list of str
        What its click may mean, the likeliest first.
    reading : int
        Which of these was taken, from 1; 0: it was not clicked.
    since : float or None
        When it was found first, s; null: not yet.
    alternatives : list of int
        Which other targets, by `id`, this may be as well, after both touched.
    finds : bool
        Whether all that looks like it is followed, too.
    pending : bool
        Whether nothing is known of it in this picture yet; it is not lost then.
    """

    id: int
    name: str
    found: bool
    values: dict[str, tuple[float, float | None]] = {}
    outline: list[float] = []
    match_set: list[float] = []
    support: float | None = None
    position: dict[str, tuple[float, float | None]] = {}
    left_out: str = ""
    markers: list[list[float]] = []
    axes: list[float] = []
    predicted: list[float] = []
    reason: str = ""
    lost_for: float = 0.0
    diameter: float | None = None
    diameter_sigma: float = 0.0
    shape: str = "circle"
    readings: list[str] = []
    reading: int = 0
    since: float | None = None
    alternatives: list[int] = []
    finds: bool = False
    pending: bool = False


class CrowdState(msgspec.Struct, frozen=True, omit_defaults=True):
    """What is known of all that looks like a target, while it is looked for.

    Parameters
    ----------
    followed : int
        How many are followed.
    most : int
        How many targets there may be.
    doubtful : list of list of float
        x and y of points along the outline of each thing that may be one as well, px; a click there follows it.
    left_out : int
        How many more were found at last.
    """

    followed: int
    most: int
    doubtful: list[list[float]] = []
    left_out: int = 0


class State(msgspec.Struct, frozen=True, omit_defaults=True):
    """What is known of one picture.

    Parameters
    ----------
    sequence : int
        Its number here.
    index : int
        Its number in the source.
    time : float
        Of its capture, s.
    width, height : int
        px; the JPEG may be smaller.
    targets : list of TargetState
    camera_fps, fps : float or None
        Frames per second of the camera, and of the loop.
    dropped : int
        Frames of the source that nobody asked for in time.
    age : float
        From the capture to the end of the computing, s.
    computing : dict of str to float
        What a picture with targets took since the source was opened, ms: median, mean, percentile_95, worst.
    live : bool
    fault : str
        What is wrong with the source, in words.
    stretch : int
        Another number where a picture does not follow the one before: somebody has gone to another frame of a video.
    crowd : CrowdState or None
        Of all that looks like a target; null: that is not looked for.
    """

    sequence: int
    index: int
    time: float
    width: int
    height: int
    targets: list[TargetState] = []
    camera_fps: float | None = None
    fps: float | None = None
    dropped: int = 0
    age: float = 0.0
    computing: dict[str, float] = {}
    live: bool = True
    fault: str = ""
    stretch: int = 0
    crowd: CrowdState | None = None


class SessionState(msgspec.Struct, frozen=True, omit_defaults=True):
    """What is shown, and the state of each panel.

    Parameters
    ----------
    kind : str
        "camera", "file", "flight"; empty: nothing is shown yet.
    title : str
    streams : int
        Number of streams of pictures.
    panels : dict of str to object
        What each panel shows, by its name.
    notes : list of str
        What a person should know, newest last.
    page : str
        Name of the page that is told; empty: no page.
    """

    kind: str = ""
    title: str = ""
    streams: int = 0
    panels: dict[str, Any] = {}
    notes: list[str] = []
    page: str = ""


def written(state: State | SessionState) -> bytes:
    """Write a state as JSON."""
    return msgspec.json.encode(state)
