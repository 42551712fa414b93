"""A camera or a stream: a thread keeps its newest picture; what a camera is asked for, and what it says it does."""

import math
import queue
import re
import threading
from collections.abc import Mapping
from pathlib import Path
from time import monotonic
from typing import NamedTuple

import cv2
import msgspec

from matchset.image.capture import Capture, hushed, open_capture, unpack
from matchset.image.errors import LinkError
from matchset.image.frame import Frame
from matchset.image.upright.stated import pixel_ratio
from matchset.image.video_files.pyav_capture import open_pyav_stream, reports_damage

# format: buffers that a V4L2 driver is asked for. With one it has nowhere to write while a picture is unpacked, and
# every other frame is lost. A second one adds no age: the thread empties the queue faster than it fills.
BUFFERS = 2
Settings = dict[str, tuple[float, float | None]]
PROPERTIES = {  # in the order in which they are set: a driver needs the size first, and both of it
    "width": cv2.CAP_PROP_FRAME_WIDTH,
    "height": cv2.CAP_PROP_FRAME_HEIGHT,
    "fps": cv2.CAP_PROP_FPS,
    "exposure": cv2.CAP_PROP_EXPOSURE,
    "gain": cv2.CAP_PROP_GAIN,
    "white_balance": cv2.CAP_PROP_WB_TEMPERATURE,
}
AUTOMATIC = {"exposure": cv2.CAP_PROP_AUTO_EXPOSURE, "white_balance": cv2.CAP_PROP_AUTO_WB}
V4L2_EXPOSURE = 1.0, 3.0  # format: V4L2_EXPOSURE_MANUAL and _APERTURE_PRIORITY; the other systems say 0 and 1


class StreamParameters(msgspec.Struct, frozen=True):
    """Times of a live source.

    Chosen by hand; `tests/image/test_camera_stream.py` would show a change.

    Parameters
    ----------
    first_picture_s : float
        Time that the first picture may take, s: cameras start slowly, streams wait for a key frame.
    retry_s : float
        Time between attempts while a device delivers nothing, s.
    latest_stamp_s : float
        Age up to which a driver's time stamp is believed, s; other clocks are further off.
    """

    first_picture_s: float = 10.0
    retry_s: float = 0.01
    latest_stamp_s: float = 1.0


DEFAULT = StreamParameters()


class Control(NamedTuple):
    """A setting of a camera.

    Attributes
    ----------
    value : float
        In the driver's unit.
    automatic : bool or None
        Whether the camera chooses it itself; None if it cannot, or does not say.
    """

    value: float
    automatic: bool | None


def _hint(device: int | str) -> str:
    """Say what else there is, or what to look at, where a camera or a stream does not open."""
    if isinstance(device, str) and "://" in device:
        return ": is its address right, and does it play in another program?"
    found = sorted(str(path) for path in Path("/dev").glob("video*"))
    if not found:
        return ": this computer shows no camera (no /dev/video*); is it plugged in, and passed on to a container?"
    return f": there are {', '.join(found)}; another program may hold it, or this user may not (group video)"


class Live:
    """A live source, read by a thread of its own; the newest frame wins, the others are counted as dropped.

    The time of a frame is the moment of its capture on the clock of `time.monotonic`: V4L2's own stamp (when
    the camera began to send it) where there is one that makes sense, otherwise the moment it arrived. Its
    index counts all captured frames, so gaps in it are dropped or broken ones.

    Parameters
    ----------
    device : int or str
        Camera number, device path or URL.
    name : str
        What to call it in messages.
    timeout : float
        Longest silence, s.
    wishes : mapping of str to float
        Settings to ask for.
    damaged : bool
        Whether pictures are handed out in which the decoder reports errors, as far as it says so.

    Attributes
    ----------
    settings : dict of str to (float, float or None)
        Each setting that was asked for, with what the driver says it is.
    controls : dict of str to Control
        The settings that the camera has, as they were when it was opened, or one was changed last.
    pixel_ratio : tuple of float
        Width and height of a pixel, in any unit; 0, 0 where the stream does not say.
    stamped : bool
        Whether the last frame has the driver's time of its capture; otherwise it has that of its arrival.

    Raises
    ------
    LinkError
        If it cannot be opened or delivers no first picture.
    """

    live = True
    length: int | None = None

    def __init__(
        self, device: int | str, name: str, timeout: float, wishes: Mapping[str, float], damaged: bool = False
    ) -> None:
        self.name, self.timeout, self.dropped, self.broken, self.damaged = name, timeout, 0, 0, 0
        self.warnings: list[str] = []
        self._is_file = isinstance(device, str) and re.search(r"^https?://[^?]*\.\w{3,4}($|\?)", device) is not None
        is_stream = isinstance(device, str) and "://" in device
        self._keeps_damaged = damaged
        self._capture = open_live(device, *((max(timeout, DEFAULT.first_picture_s),) if is_stream else ()))
        if not self._capture.isOpened():
            raise LinkError(f"cannot open {name}{_hint(device)}")
        with hushed:
            self._capture.set(cv2.CAP_PROP_BUFFERSIZE, BUFFERS)
            self.settings = apply(self._capture, wishes)
            self.controls = {} if is_stream else read_controls(self._capture)
            rate, self.pixel_ratio = self._capture.get(cv2.CAP_PROP_FPS), pixel_ratio(self._capture)
        self.fps = rate if 0 < rate <= 1000 else None
        self.stamped, self._has_stamps = False, self._capture.getBackendName() == "V4L2"
        self._captured, self._last = 0, 0.0
        self._newest: Frame | None = None
        self._failure = ""
        self._orders: queue.SimpleQueue[tuple[str, float | None]] = queue.SimpleQueue()
        self._stop, self._news = threading.Event(), threading.Condition()
        self._thread = threading.Thread(target=self._run, name=f"matchset {name}", daemon=True)
        self._thread.start()
        try:
            self.shape = self._await(max(timeout, DEFAULT.first_picture_s)).image.shape
        except BaseException:
            self.close()
            raise

    def read(self) -> Frame:
        """Newest frame not yet read; waits for one."""
        with self._news:
            frame = self._await(self.timeout)
            self._newest = None
            return frame

    def newest(self, limit: float) -> Frame | None:
        """Newest frame not yet read; None if there is none within a time, s. LinkError once the camera has failed."""
        with self._news:
            frame, self._newest = self._wait(limit), None
            return frame

    def adjust(self, name: str, value: float | None) -> None:
        """Change a setting before the next picture, by the thread that reads; `settings` and `controls` follow.

        Parameters
        ----------
        name : str
            "exposure", "gain" or "white_balance".
        value : float or None
            None: what the camera chooses itself, where it can.

        Raises
        ------
        ValueError
            If there is no such setting that can be changed while pictures come.
        """
        if name not in ("exposure", "gain", "white_balance"):
            raise ValueError(f"{name!r} cannot be changed while pictures come: open the camera with it")
        self._orders.put((name, value))

    def _obey(self) -> None:
        """Do what `adjust` was asked for."""
        while not self._orders.empty():
            name, value = self._orders.get()
            others = {key: pair for key, pair in self.settings.items() if key != name}
            with hushed:
                if value is None:
                    _set_automatic(self._capture, name, True)
                else:
                    others |= apply(self._capture, {name: value})
                self.settings, self.controls = others, read_controls(self._capture)

    def _await(self, limit: float) -> Frame:
        frame = self._wait(limit)
        if frame is None:
            hint = ": if it is a file, not a stream, download it" if self._is_file else ""
            raise LinkError(f"{self.name} has delivered no picture for {limit:g} s{hint}")
        return frame

    def _wait(self, limit: float) -> Frame | None:
        with self._news:
            self._news.wait_for(lambda: self._newest is not None or self._stop.is_set(), limit)
            if self._newest is not None:
                return self._newest
        if self._failure:
            raise LinkError(f"{self.name} failed: {self._failure}")
        if self._stop.is_set():
            raise ValueError(f"{self.name} is closed")
        return None

    def _run(self) -> None:
        # From here on the thread alone touches the capture: OpenCV crashes when another one releases it.
        try:
            while not self._stop.is_set():
                self._obey()
                if self._capture.grab():
                    self._keep(self._moment())
                else:
                    self._stop.wait(DEFAULT.retry_s)
        except Exception as error:  # whatever a driver or OpenCV raises belongs to the reader
            self._failure = " ".join(str(error).split()) or type(error).__name__
        finally:
            self._stop.set()
            self._capture.release()
            with self._news:
                self._news.notify_all()

    def _moment(self) -> float:
        """When the picture just grabbed was captured, s."""
        moment = now = monotonic()
        if self._has_stamps:
            stamp = self._capture.get(cv2.CAP_PROP_POS_MSEC) / 1000.0
            self.stamped = 0.0 <= now - stamp < DEFAULT.latest_stamp_s
            moment = stamp if self.stamped else now
        self._last = max(moment, self._last + 1e-6)
        return self._last

    def _keep(self, moment: float) -> None:
        damaged = reports_damage(self._capture)
        left_out = damaged and not self._keeps_damaged
        image = None if left_out else unpack(self._capture)
        with self._news:
            index, self._captured = self._captured, self._captured + 1
            self.damaged += damaged
            if image is None:
                self.broken += not left_out
                return
            self.dropped += self._newest is not None
            self._newest = Frame(image, moment, index, damaged)
            self._news.notify_all()

    def close(self) -> None:
        """Stop the thread and wait for it; one stuck in the driver lets go of the device once it returns."""
        self._stop.set()
        with self._news:
            self._news.notify_all()
        self._thread.join(self.timeout)


def open_live(device: int | str, *limits: float) -> Capture:
    """Open a device or a stream; a coded stream with PyAV, where it is installed: OpenCV tells no decoder's errors.

    Parameters
    ----------
    device : int or str
        Camera number, device path or URL.
    *limits : float
        Of a stream: the longest that opening, and reading, may block, s; one of them counts for both.
    """
    capture = open_pyav_stream(str(device), limits[0], limits[-1]) if limits else None
    return open_capture(device, *limits) if capture is None else capture


def apply(capture: Capture, wishes: Mapping[str, float]) -> Settings:
    """Set each wish, its automatic counterpart off, and read back what became of it.

    Parameters
    ----------
    capture : Capture
        An open camera.
    wishes : mapping of str to float
        Names of `PROPERTIES`, and the values asked for.

    Returns
    -------
    dict
        Name -> (asked, got); got is None where the camera has no such setting.
    """
    accepted = {}
    ordered = [(name, wishes[name]) for name in PROPERTIES if name in wishes]
    for name, asked in ordered:
        _set_automatic(capture, name, False)
        accepted[name] = capture.set(PROPERTIES[name], asked)
    settings: Settings = {}
    for name, asked in ordered:  # when all are set: one may move another
        got = capture.get(PROPERTIES[name])
        absent = math.isnan(got) or (not accepted[name] and got in (-1.0, 0.0))
        settings[name] = asked, None if absent else got
    return settings


def read_controls(capture: Capture) -> dict[str, Control]:
    """Read the settings that a camera has.

    Parameters
    ----------
    capture : Capture
        An open camera.

    Returns
    -------
    dict of str to Control
        By the names of `PROPERTIES`; one that the camera does not have is left out.
    """
    controls = {}
    for name, number in PROPERTIES.items():
        value = capture.get(number)
        if math.isnan(value) or value == -1.0:  # -1: how OpenCV says that there is none
            continue
        controls[name] = Control(value, _is_automatic(capture, name))
    return controls


def _set_automatic(capture: Capture, name: str, on: bool) -> None:
    """Let the camera choose a setting itself, or not; nothing where it cannot."""
    if name in AUTOMATIC:
        v4l2_exposure = name == "exposure" and capture.getBackendName() == "V4L2"
        capture.set(AUTOMATIC[name], V4L2_EXPOSURE[on] if v4l2_exposure else float(on))


def _is_automatic(capture: Capture, name: str) -> bool | None:
    """Whether the camera chooses a setting itself; None if it does not say."""
    if name not in AUTOMATIC:
        return None
    mode = capture.get(AUTOMATIC[name])
    if math.isnan(mode) or mode == -1.0:
        return None
    v4l2_exposure = name == "exposure" and capture.getBackendName() == "V4L2"
    return mode != V4L2_EXPOSURE[0] if v4l2_exposure else mode != 0.0


def differences(settings: Settings) -> list[str]:
    """Say in words which wishes were not granted.

    Parameters
    ----------
    settings : dict
        Name -> (asked, got).

    Returns
    -------
    list of str
        One sentence for each difference of more than 1 %.
    """
    words = []
    for name, (asked, got) in settings.items():
        if got is None:
            words.append(f"{name}: asked for {asked:g}, but this source has no such setting")
        elif not math.isclose(asked, got, rel_tol=0.01):
            words.append(f"{name}: asked for {asked:g}, the driver says {got:g}")
    return words
