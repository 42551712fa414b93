"""A camera or a stream: a thread keeps its newest picture; what a camera is asked for, and what it says it does."""

import math
import re
import threading
from collections.abc import Mapping
from pathlib import Path
from time import monotonic

import cv2
import msgspec

from matchset.image.capture import Capture, hushed, open_capture, unpack
from matchset.image.errors import LinkError
from matchset.image.frame import Frame

# format: buffers that a V4L2 driver is asked for. With one it has nowhere to write while a picture is unpacked, and
# every other frame is lost. A second one adds no age: the thread empties the queue faster than it fills.
BUFFERS = 2
Settings = dict[str, tuple[float, float | None]]
PROPERTIES = {
    "exposure": cv2.CAP_PROP_EXPOSURE,
    "white_balance": cv2.CAP_PROP_WB_TEMPERATURE,
    "fps": cv2.CAP_PROP_FPS,
}
V4L2_MANUAL_EXPOSURE = 1.0  # format: V4L2_EXPOSURE_MANUAL; the other systems say 0 for "not automatic"


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

    Raises
    ------
    LinkError
        If it cannot be opened or delivers no first picture.
    """

    live = True
    length: int | None = None

    def __init__(self, device: int | str, name: str, timeout: float, wishes: Mapping[str, float]) -> None:
        self.name, self.timeout, self.dropped, self.broken = name, timeout, 0, 0
        self.warnings: list[str] = []
        self._is_file = isinstance(device, str) and re.search(r"^https?://[^?]*\.\w{3,4}($|\?)", device) is not None
        is_stream = isinstance(device, str) and "://" in device
        self._capture = open_capture(device, max(timeout, DEFAULT.first_picture_s) if is_stream else None)
        if not self._capture.isOpened():
            raise LinkError(f"cannot open {name}{_hint(device)}")
        with hushed:
            self._capture.set(cv2.CAP_PROP_BUFFERSIZE, BUFFERS)
            self.settings = apply(self._capture, wishes)
            rate = self._capture.get(cv2.CAP_PROP_FPS)
        self.fps = rate if 0 < rate <= 1000 else None
        self._stamped = self._capture.getBackendName() == "V4L2"
        self._captured, self._last = 0, 0.0
        self._newest: Frame | None = None
        self._failure = ""
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

    def _await(self, limit: float) -> Frame:
        with self._news:
            self._news.wait_for(lambda: self._newest is not None or self._stop.is_set(), limit)
            if self._newest is not None:
                return self._newest
        if self._failure:
            raise LinkError(f"{self.name} failed: {self._failure}")
        if self._stop.is_set():
            raise ValueError(f"{self.name} is closed")
        hint = ": if it is a file, not a stream, download it" if self._is_file else ""
        raise LinkError(f"{self.name} has delivered no picture for {limit:g} s{hint}")

    def _run(self) -> None:
        # From here on the thread alone touches the capture: OpenCV crashes when another one releases it.
        try:
            while not self._stop.is_set():
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
        if self._stamped:
            stamp = self._capture.get(cv2.CAP_PROP_POS_MSEC) / 1000.0
            if 0.0 <= now - stamp < DEFAULT.latest_stamp_s:
                moment = stamp
        self._last = max(moment, self._last + 1e-6)
        return self._last

    def _keep(self, moment: float) -> None:
        image = unpack(self._capture)
        with self._news:
            index, self._captured = self._captured, self._captured + 1
            if image is None:
                self.broken += 1
                return
            self.dropped += self._newest is not None
            self._newest = Frame(image, moment, index)
            self._news.notify_all()

    def close(self) -> None:
        """Stop the thread and wait for it; one stuck in the driver lets go of the device once it returns."""
        self._stop.set()
        with self._news:
            self._news.notify_all()
        self._thread.join(self.timeout)


def apply(capture: Capture, wishes: Mapping[str, float]) -> Settings:
    """Set each wish, its automatic counterpart off, and read back what became of it.

    Parameters
    ----------
    capture : Capture
        An open camera.
    wishes : mapping of str to float
        "exposure", "white_balance" or "fps" and the value asked for.

    Returns
    -------
    dict
        Name -> (asked, got); got is None where the camera has no such setting.
    """
    settings: Settings = {}
    for name, asked in wishes.items():
        if name == "exposure":
            manual = V4L2_MANUAL_EXPOSURE if capture.getBackendName() == "V4L2" else 0.0
            capture.set(cv2.CAP_PROP_AUTO_EXPOSURE, manual)
        elif name == "white_balance":
            capture.set(cv2.CAP_PROP_AUTO_WB, 0.0)
        accepted = capture.set(PROPERTIES[name], asked)
        got = capture.get(PROPERTIES[name])
        absent = math.isnan(got) or (not accepted and got in (-1.0, 0.0))
        settings[name] = asked, None if absent else got
    return settings


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
