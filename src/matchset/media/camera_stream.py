"""A camera or a stream: a thread keeps its newest picture, and opens it again when it is lost."""

import queue
import re
import threading
from collections.abc import Callable, Mapping
from contextlib import nullcontext
from pathlib import Path
from time import monotonic

import cv2
import msgspec

from matchset.image.errors import LinkError, NoStreamError
from matchset.image.frame import Frame
from matchset.media.capture import Capture, hushed, open_capture, unpack
from matchset.media.streams.backlog import Backlog
from matchset.media.streams.camera_settings import Settings, apply, read_controls, set_automatic
from matchset.media.streams.silence import Pauses, ReopeningParameters, Silence
from matchset.media.upright.header_view import pixel_ratio
from matchset.media.video_files.pyav_capture import open_pyav_stream, reports_damage

# format: buffers that a V4L2 driver is asked for. With one it has nowhere to write while a picture is unpacked, and
# every other frame is lost. A second one adds no age: the thread empties the queue faster than it fills.
BUFFERS = 2


class StreamParameters(msgspec.Struct, frozen=True):
    """Times of a live source.

    Chosen by hand; `tests/media/test_camera_stream.py` would show a change.

    Parameters
    ----------
    first_picture_s : float
        Time that the first picture may take, s: cameras start slowly, streams wait for a key frame.
    retry_s : float
        Time between attempts while a device delivers nothing, s.
    latest_stamp_s : float
        Age up to which a driver's time stamp is believed, s; other clocks are further off.
    answer_s : float
        Time that an address without pictures has to say what it is, s.
    look_s : float
        Time between two looks whether the reader wants to stop, while it waits for a picture, s.
    threads : int
        How many threads unpack a stream. FFmpeg holds a picture back for each but the first, by itself as many as the
        computer has processors: with sixteen half a second of age that nobody sees (docs/log/files.md#streams). One has
        the least delay, and is too slow for large pictures.
    """

    first_picture_s: float = 10.0
    retry_s: float = 0.01
    latest_stamp_s: float = 1.0
    answer_s: float = 2.0
    look_s: float = 0.1
    threads: int = 2


DEFAULT = StreamParameters()
REOPENING = ReopeningParameters()


def _hint(device: int | str) -> str:
    """Say what else there is, or what to look at, where a camera or a stream does not open."""
    if isinstance(device, str) and "://" in device:
        return ": is its address right, and does it play in another program?"
    found = sorted(str(path) for path in Path("/dev").glob("video*"))
    if not found:
        return ": this computer shows no camera (no /dev/video*); is it plugged in, and passed on to a container?"
    return f": there are {', '.join(found)}; another program may hold it, or this user may not (group video)"


class LiveSource:
    """A live source, read by a thread of its own; the newest frame wins, the others are counted as dropped.

    The time of a frame is the moment of its capture on the clock of `time.monotonic`: V4L2's own stamp (when
    the camera began to send it) where there is one that makes sense, otherwise the moment it arrived. Its
    index counts all captured frames, so gaps in it are dropped or broken ones. A stream that breaks off or is silent
    for too long is opened again, by the same thread; times and indices go on. A recording behind an address is not: it
    would begin anew.

    Parameters
    ----------
    device : int or str
        Camera number, device path or URL.
    name : str
        What to call it in messages.
    silence : Silence
        How much of it is borne.
    wishes : mapping of str to float
        Settings to ask for.
    damaged : bool
        Whether pictures are handed out in which the decoder reports errors, as far as it says so.

    Attributes
    ----------
    reconnect : float
        How long it is opened again and again, s; 0: not at all.
    lost : str
        Why there are no pictures while it is being opened again; empty otherwise.
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
        If it cannot be opened or delivers no first picture. NoStreamError if the address answers all the same.
    """

    live = True
    length: int | None = None

    def __init__(
        self, device: int | str, name: str, silence: Silence, wishes: Mapping[str, float], damaged: bool = False
    ) -> None:
        self.name, self.timeout, self.dropped, self.broken, self.damaged = name, silence.timeout, 0, 0, 0
        self._device, self._note, self._pauses = device, silence.note or (lambda _: None), Pauses(REOPENING)
        self._is_file = isinstance(device, str) and re.search(r"^https?://[^?]*\.\w{3,4}($|\?)", device) is not None
        self._is_stream = isinstance(device, str) and "://" in device
        self._keeps_damaged, self._is_left_out = damaged, False  # the last picture that came
        own = REOPENING.stream_s if self._is_stream else REOPENING.device_s
        self.reconnect = own if silence.reconnect is None else silence.reconnect
        self.settings: Settings = {setting: (value, None) for setting, value in wishes.items()}
        first, self._backlog = max(self.timeout, DEFAULT.first_picture_s), Backlog()
        if not self._open(first):
            raise self._without_pictures(f"cannot open {name}{_hint(device)}")
        with hushed:
            rate, length = self._capture.get(cv2.CAP_PROP_FPS), self._capture.get(cv2.CAP_PROP_FRAME_COUNT)
            self.pixel_ratio = pixel_ratio(self._capture)
        self.fps = rate if 0 < rate <= 1000 else None
        self._is_live, self.lost = self._is_stream and length <= 0, ""
        self.reconnect = 0.0 if self._is_stream and not self._is_live else self.reconnect
        self.stamped, self._has_stamps = False, self._capture.getBackendName() == "V4L2"
        self._captured, self._last, self._losses = 0, 0.0, list[float]()
        self._arrived = self._back = monotonic()
        self._newest: Frame | None = None
        self._failure = ""
        self._orders: queue.SimpleQueue[tuple[str, float | None]] = queue.SimpleQueue()
        self._stop, self._news = threading.Event(), threading.Condition()
        self._thread = threading.Thread(target=self._run, name=f"matchset {name}", daemon=True)
        self._thread.start()
        try:
            if (frame := self._wait(first)) is None:
                raise self._silent(first)
        except BaseException as error:
            self.close()
            if isinstance(error, LinkError) and not self._is_left_out:
                raise self._without_pictures(str(error)) from None
            raise
        self.shape = frame.image.shape

    @property
    def warnings(self) -> list[str]:
        """How often it was lost, if it was."""
        times = len(self._losses)
        return [f"it was lost {times} time{'s' * (times > 1)}, for {sum(self._losses):.1f} s in all"] if times else []

    def _open(self, limit: float) -> bool:
        """Open the device within a time, s, and ask for the settings; whether that worked."""
        reading = self.timeout if self.reconnect else limit
        how, begin = (limit, reading, DEFAULT.threads) if self._is_stream else (), monotonic()
        self._reading, self._is_spent = reading, False
        self._capture = open_live(self._device, *how)
        self._backlog.begin(monotonic(), monotonic() - begin)
        if not self._capture.isOpened():
            return False
        with hushed:
            self._capture.set(cv2.CAP_PROP_BUFFERSIZE, BUFFERS)
            self.settings = apply(self._capture, {name: asked for name, (asked, _) in self.settings.items()})
            self.controls = {} if self._is_stream else read_controls(self._capture)
        return True

    def _without_pictures(self, words: str) -> LinkError:
        """Return why there are no pictures: what the address answers, if it does; else as it was found."""
        from matchset.media.streams.answer import answer_of  # loads what speaks HTTP

        answer = answer_of(self._device, DEFAULT.answer_s) if self._is_stream and isinstance(self._device, str) else ""
        return NoStreamError(f"{self.name} {answer}{_hint(self._device)}") if answer else LinkError(words)

    def read(self, stopped: Callable[[], bool] = lambda: False) -> Frame | None:
        """Newest frame not yet read; waits for one, or until somebody says that it is to stop: then None."""
        with self._news:
            frame = self._wait(self.timeout + self.reconnect, stopped)
            if frame is None and not stopped():
                raise self._silent(self.timeout + self.reconnect)
            self._newest = None
            return frame

    @property
    def waits(self) -> bool:
        """Whether there is a frame that was not yet read."""
        return self._newest is not None

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
                    set_automatic(self._capture, name, True)
                else:
                    others |= apply(self._capture, {name: value})
                self.settings, self.controls = others, read_controls(self._capture)

    def _silent(self, limit: float) -> LinkError:
        if self._is_left_out:
            left_out = f"{self.damaged} damaged ones were left out (--damaged, or damaged=True, uses them)"
            return LinkError(f"{self.name} has delivered no whole picture for {limit:g} s; {left_out}")
        hint = ": if it is a file, not a stream, download it" if self._is_file and not self.reconnect else ""
        return LinkError(f"{self.name} has delivered no picture for {limit:g} s{hint}")

    def _wait(self, limit: float, stopped: Callable[[], bool] = lambda: False) -> Frame | None:
        end = monotonic() + limit
        with self._news:
            while self._newest is None and not self._stop.is_set() and not stopped():
                if (left := end - monotonic()) <= 0.0:
                    break
                self._news.wait(min(left, DEFAULT.look_s))
            if self._newest is not None:
                return self._newest
        if self._failure:
            raise LinkError(self._failure)
        if self._stop.is_set():
            raise ValueError(f"{self.name} is closed")
        return None

    def _run(self) -> None:
        # From here on the thread alone touches the capture: OpenCV crashes when another one releases it.
        try:
            with hushed if self._is_stream else nullcontext():
                while not self._stop.is_set():
                    self._obey()
                    if self._take():
                        continue
                    if self._is_lost():
                        self._open_again()
                    else:
                        self._stop.wait(DEFAULT.retry_s)
        except LinkError as error:
            self._failure = str(error)
        except Exception as error:  # whatever a driver or OpenCV raises belongs to the reader
            self._failure = f"{self.name} failed: {' '.join(str(error).split()) or type(error).__name__}"
        finally:
            self._stop.set()
            self._capture.release()
            with self._news:
                self._news.notify_all()

    def _is_lost(self) -> bool:
        """Whether a source that has just given no picture is to be opened again; a camera may be slow."""
        if not self.reconnect or not self._captured:
            return False
        return self._is_stream or monotonic() - self._arrived >= self.timeout

    def _open_again(self) -> None:
        """Open it again and again until it delivers; LinkError when `reconnect` is over."""
        lost, end = self._arrived, monotonic() + self.reconnect
        silent = monotonic() - lost
        how = "broke off" if silent < self.timeout else f"has delivered no picture for {silent:.1f} s"
        self.lost = f"{self.name} {how}; it is opened again, for {self.reconnect:g} s at most"
        self._note(self.lost)
        self._pauses.begin(lost - self._back)
        self._capture.release()
        while not self._stop.wait(min(self._pauses.next(), max(end - monotonic(), 0.0))):
            left = end - monotonic()
            if left <= 0.0:
                raise LinkError(f"{self.name} has delivered no picture for {monotonic() - lost:.1f} s")
            if self._open(min(left, max(self.timeout, DEFAULT.first_picture_s))) and self._delivers(end):
                self._back = self._arrived
                self._losses.append(self._back - lost)
                self.lost = ""
                self._note(f"{self.name} is back after {self._back - lost:.1f} s")
                return
            self._capture.release()

    def _delivers(self, end: float) -> bool:
        """Whether what was opened gives a picture before a time, s; a stream that breaks off at once is left."""
        while not self._stop.is_set() and (begin := monotonic()) < end:
            if self._take():
                return True
            if self._is_stream and monotonic() - begin < 0.5 * self.timeout:
                return False
            self._stop.wait(DEFAULT.retry_s)
        return False

    def _take(self) -> bool:
        """Take the next picture; whether there was one."""
        begin = monotonic()
        if self._is_spent or not self._capture.grab():
            return False
        if self._is_live and monotonic() - begin >= self._reading:
            self._is_spent = True  # waited for in vain: this is what the decoder still held, as old as the silence
            return False
        moment = self._moment()
        if self._is_live and self._backlog.holds(self._arrived, self._arrived - begin, self.fps):
            self._captured, self.dropped = self._captured + 1, self.dropped + 1
        else:
            self._keep(moment)
        return True

    def _moment(self) -> float:
        """When the picture just grabbed was captured, s."""
        moment = now = monotonic()
        if self._has_stamps:
            stamp = self._capture.get(cv2.CAP_PROP_POS_MSEC) / 1000.0
            self.stamped = 0.0 <= now - stamp < DEFAULT.latest_stamp_s
            moment = stamp if self.stamped else now
        self._arrived, self._last = now, max(moment, self._last + 1e-6)
        return self._last

    def _keep(self, moment: float) -> None:
        damaged = reports_damage(self._capture)
        self._is_left_out = damaged and not self._keeps_damaged
        image = None if self._is_left_out else unpack(self._capture)
        with self._news:
            index, self._captured = self._captured, self._captured + 1
            self.damaged += damaged
            if image is None:
                self.broken += not self._is_left_out
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


def open_live(
    device: int | str, timeout: float | None = None, silence: float | None = None, threads: int | None = None
) -> Capture:
    """Open a device or a stream; a coded stream with PyAV, where it is installed: OpenCV tells no decoder's errors.

    Parameters
    ----------
    device : int or str
        Camera number, device path or URL.
    timeout, silence, threads : optional
        As of `open_capture`; PyAV needs no limit of threads, it holds no picture back.
    """
    capture = None if timeout is None else open_pyav_stream(str(device), timeout, silence or timeout)
    return open_capture(device, timeout, silence, threads) if capture is None else capture
