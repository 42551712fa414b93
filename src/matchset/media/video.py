"""Where frames come from: `Video`, a file, a folder of pictures, a bag of ROS, a camera or a stream."""

import functools
import weakref
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any, Literal, Self

from msgspec.structs import replace

from matchset.image.frame import Frame
from matchset.media.bags.bag import Bag
from matchset.media.camera_stream import LiveSource
from matchset.media.closing import Closing
from matchset.media.fields.field_choice import FieldChoice
from matchset.media.fields.field_reader import FieldReader
from matchset.media.fields.interlace import Fields
from matchset.media.opening import finite, name_of, open_source, view_of_source
from matchset.media.streams.camera_settings import Settings, differences
from matchset.media.streams.silence import Silence
from matchset.media.upright.view import ANY, WantedFields, Wish
from matchset.media.video_files.video_file import VideoFile
from matchset.numeric.copies import NotCopied
from matchset.numeric.words import one_line


class Video(NotCopied, Closing):
    """Frames of a file, a folder of pictures, a bag, a camera or a stream, one after the other.

    A file, folder or bag delivers every frame, in decode order. A live source delivers the newest frame and drops
    those that came while the caller was busy. Like an open file, a video is read once, `next(video)` takes
    one frame, and leaving its `with` block lets go of the device.

    Parameters
    ----------
    source : int, str or Path
        Path of a video file, a picture or a folder of pictures (in natural order, 2 before 10); of a ROS 1 bag
        (.bag), a ROS 2 bag (folder, .db3) or an MCAP file with ROS messages; number of a camera, also as a
        string; URL of a stream (``rtsp://``, ``http://``, ``udp://``, ...).
    exposure : float, optional
        Exposure to hold a camera at, in its driver's unit (V4L2: 0.1 ms). Left alone by default.
    white_balance : float, optional
        White balance to hold a camera at, K. Left alone by default.
    fps : float, optional
        Frames per second. Asked of a camera; for files and folders it fixes the times, index / fps. By
        default a file's own time stamps count, with times between their neighbors for frames whose stamps are
        equal or missing, and a folder has 30.
    timeout : float, default 2.0
        Longest silence of a live source, s: then it counts as lost.
    reconnect : float, optional
        How long a live source that is lost is opened again and again, s; 0: not at all. By default 10 for a stream
        from the network and 0 for a camera of this computer, which may come back under another number. Times and
        indices go on; only when this time is over is it a LinkError. A recording behind an address is not opened again.
    note : callable, optional
        Called with one line when a live source is lost and when it is back, by the thread that reads it.
    topic : str, optional
        Which topic of a bag to read, if several have pictures.
    square : bool, default True
        Whether pictures whose pixels are not square, by the header of their file, are resampled so that they are.
        Otherwise they come as they are stored: `Localizer` refuses what is tracked in them.
    turn : int, default 0
        Degrees by which all pictures are turned, clockwise: 0, 90, 180 or 270, for a camera that hangs upside down.
        A camera model goes with it: `CameraModel.turned`.
    mirror : bool, default False
        Whether left and right are swapped after that, for a camera behind a mirror.
    stream : int, optional
        Which video stream of a file to read, from 0; by default the one that plays longest.
    damaged : bool, optional
        Whether pictures are handed out whose decoder reports errors: those of a video that was joined in the middle, or
        whose packets were lost; such a frame has `Frame.damaged`. By default those of files are, those of live
        sources are left out. It is known where PyAV decodes (the extra ``av``); a file is decoded by it if this is
        given.
    fields : str, default "frames"
        Of interlaced video, whose frames have two fields taken half a frame apart: "top" (the even rows are the first)
        or "bottom" hand out each field as a frame of its own time, `Frame.rows`: half the age, twice the rate. Its
        picture is as large as before; the rows of the other field are those from before, nothing is interpolated.
        "auto" finds out from the pictures, as `warnings` say: those that are not interlaced, or do not move enough to
        tell, come as whole frames; of a live source until they do.

    Attributes
    ----------
    width, height : int
        Size of the pictures, px, as they are handed out: with square pixels, those of a phone held upright upright.
    pixel_aspect : float
        Width of a pixel in its heights: 1, unless pictures are handed out as they are stored.
    channels : int
        3 for color, 1 for gray.
    fps : float or None
        Frames per second as far as known; half-frames count as frames here and everywhere.
    fields : str
        "frames", or which field is the first of those that are handed out one by one: "top" or "bottom".
    length : int or None
        Number of frames that a file announces or a folder holds; None when live or unknown. Only MP4, MOV and AVI
        files count their frames; of others it is estimated from duration and rate.
    live : bool
        Whether frames come from a camera or a stream. Then the time of a frame is the moment of its capture
        on the clock of `time.monotonic`, so its age is ``time.monotonic() - frame.time``, and its index
        counts the captured frames. The time of a bag's frame is the stamp in its message's header, s, on most
        robots since 1970, or that of the recording if there is none. Otherwise time starts near 0. It always runs
        forward.
    topic : str or None
        The topic that is read; None if the source is no bag.
    reconnect : float
        How long it is opened again when it is lost, s.
    dropped : int
        Frames of a live source that were replaced by a newer one before they were asked for.
    broken : int
        Frames that did not decode and were skipped; they keep their place in the numbering.
    damaged : int
        Frames whose decoder reported errors, handed out or not.
    settings : dict of str to (float, float or None)
        Each setting that was asked for, with what the driver says it is: None where there is no such setting.
    warnings : list of str
        What is not as it should be, so far, one sentence each.

    Raises
    ------
    ValueError
        If the source is missing (then also a FileNotFoundError), cannot be read or holds no frame that decodes; later,
        if the pictures change in size or in channels, as those of a stream that is back, or the video is read after it
        was closed.
    LinkError
        If a camera or stream cannot be opened or stops delivering. It is a ValueError too if the address answers, but
        with something else: a page, an error, a redirection in a circle.

    Examples
    --------
    >>> with Video("flight.mp4") as video:  # doctest: +SKIP
    ...     for frame in video:
    ...         print(frame.index, frame.time)
    """

    instead = "make another Video of the same source where one is needed, or pass its frames on"

    def __init__(
        self,
        source: int | str | Path,
        *,
        exposure: float | None = None,
        white_balance: float | None = None,
        fps: float | None = None,
        timeout: float = 2.0,
        reconnect: float | None = None,
        note: Callable[[str], None] | None = None,
        topic: str | None = None,
        square: bool = True,
        turn: int = 0,
        mirror: bool = False,
        stream: int | None = None,
        damaged: bool | None = None,
        fields: WantedFields = "frames",
    ) -> None:
        """Open it; the thirteen parameters are those of all kinds of sources."""
        wish = Wish(square=square, turn=turn, mirror=mirror, stream=stream, damaged=damaged, fields=fields)
        silence = Silence(timeout, reconnect, note).checked()
        wishes = {"exposure": exposure, "white_balance": white_balance, "fps": fps}
        asked = {name: finite(name, value) for name, value in wishes.items() if value is not None}
        if fps is not None and not fps > 0.0:
            raise ValueError(f"fps must be positive, got {fps}")
        self._start(source, asked, silence, topic, wish)

    def _start(
        self, source: int | str | Path, asked: dict[str, float], silence: Silence, topic: str | None, wish: Wish = ANY
    ) -> None:
        """Open the source with settings of `streams.camera_settings.PROPERTIES`."""
        self._name, self._closed, self._ended = name_of(source), False, False
        self._given, self._asked, self._wish = source, asked, wish
        self._source = open_source(source, self._name, silence, asked, topic, wish)
        self.topic = self._source.topic if isinstance(self._source, Bag) else None
        self.settings: Settings
        self.reconnect = self._source.reconnect if isinstance(self._source, LiveSource) else 0.0
        if isinstance(self._source, LiveSource):
            self.settings = self._source.settings
        else:  # reported, not refused: what ran live can be replayed from a file as it stands
            self.settings = {name: (value, None) for name, value in asked.items() if name != "fps"}
        self._keeps_damaged = not self._source.live if wish.damaged is None else wish.damaged
        self._view, self.pixel_aspect = view_of_source(self._source, wish)
        self._shape = self._view.shape(self._source.shape)
        self.height, self.width = self._shape[:2]
        self.channels = 3 if len(self._shape) == 3 else 1
        self.fps, self.length, self.live = self._source.fps, self._source.length, self._source.live
        self.fields: Fields = "frames"
        self._reader = FieldReader("frames", None)
        self._finalizer = weakref.finalize(self, self._source.close)
        if wish.fields != "frames":
            self._take_apart(wish.fields)

    def _take_apart(self, wanted: Literal["top", "bottom", "auto"]) -> None:
        """Hand out half-frames if that is wanted and the pictures are interlaced."""
        source, file = self._source, self._source if isinstance(self._source, VideoFile) else None
        choice = FieldChoice(wanted, self._view if file is None else file.view, self.height)
        if choice.looks and not self.live:
            with Video(self._given, **self._opening()) as frames:
                choice.look(frames)
        stated = None if file is None else file.stated
        self._reader = choice.reader(source.fps, stated, lambda: self.live and not self.stamped)
        self._count_fields()

    def _count_fields(self) -> None:
        """Count half-frames from now on, if those are handed out."""
        self.fields = self._reader.fields
        if self.fields != "frames":
            self.fps = None if self.fps is None else 2.0 * self.fps
            self.length = None if self.length is None else 2 * self.length

    @property
    def dropped(self) -> int:
        """Frames of a live source that nobody asked for in time."""
        return self._source.dropped + self._reader.left_out

    @property
    def broken(self) -> int:
        """Frames that did not decode."""
        return self._source.broken

    @property
    def damaged(self) -> int:
        """Frames whose decoder reported errors."""
        return self._source.damaged

    @property
    def lost(self) -> str:
        """Why there are no pictures while a live source is being opened again, in words; empty otherwise."""
        return self._source.lost if isinstance(self._source, LiveSource) else ""

    @property
    def stamped(self) -> bool:
        """Whether the last frame of a live source has its driver's time of capture; otherwise that of its arrival."""
        return not isinstance(self._source, LiveSource) or self._source.stamped

    @property
    def warnings(self) -> list[str]:
        """What is not as it should be, so far."""
        words = [*differences(self.settings), *self._view.notes, *self._source.warnings, *self._reader.warnings]
        if self.broken:
            words.append(f"{self.broken} broken frame{'s' * (self.broken > 1)} skipped")
        if self.damaged:
            how = "handed out" if self._keeps_damaged else "left out"
            words.append(f"{self.damaged} damaged frame{'s' * (self.damaged > 1)} {how}")
        return words

    def __iter__(self) -> Self:
        if self._closed:
            raise ValueError(f"{self._name} is closed")
        return self

    def __next__(self) -> Frame:
        if self._closed:
            raise ValueError(f"{self._name} is closed")
        frame = None if self._ended else self._take(self._source.read)
        if frame is None:
            self._ended = True
            self._source.close()
            raise StopIteration
        return frame

    def until(self, stopped: Callable[[], bool]) -> Iterator[Frame]:
        """Yield the frames, as iterating does, until they end or somebody wants to stop.

        Parameters
        ----------
        stopped : callable
            Whether to stop; asked after every frame, and all the time while a live source is silent.

        Raises
        ------
        ValueError, LinkError
            As iterating does.
        """
        while not stopped():
            source = self._source
            if self._closed or not isinstance(source, LiveSource):
                frame = next(self, None)
            else:
                frame = self._take(functools.partial(source.read, stopped))
            if frame is None:
                return
            yield frame

    def newest(self, wait: float) -> Frame | None:
        """Return the newest frame of a live source that was not yet read; for loops that must not stand still.

        Parameters
        ----------
        wait : float
            How long to wait for one, s.

        Returns
        -------
        Frame or None
            None if none came in that time, also where `next` would give up after `timeout`.

        Raises
        ------
        ValueError
            If the source is not live or was closed, or the pictures have changed in size or in channels.
        LinkError
            If its driver has failed, or a stream stayed away for longer than `reconnect`.
        """
        if self._closed:
            raise ValueError(f"{self._name} is closed")
        if not isinstance(self._source, LiveSource):
            raise ValueError(f"{self._name} is not live: its frames come one after the other, by next()")
        return self._take(functools.partial(self._source.newest, wait))

    def _take(self, read: Callable[[], Frame | None]) -> Frame | None:
        """Return the next frame, or half-frame, of what reads the source; None if there is none."""
        if not self._reader.works:
            return None if (frame := read()) is None else self._checked(frame)
        waits = isinstance(self._source, LiveSource) and self._source.waits
        frame = self._reader.take(lambda: None if (whole := read()) is None else self._checked(whole), waits)
        if self._reader.fields != self.fields:
            self._count_fields()
        return frame

    def _checked(self, frame: Frame) -> Frame:
        """Return a frame in the view of this video; one of another shape than those before is refused (ValueError)."""
        if self._view.changes or self.pixel_aspect != 1.0:
            frame = replace(frame, image=self._view.apply(frame.image), pixel_aspect=self.pixel_aspect)
        if frame.image.shape != self._shape:
            found, before = _described(frame.image.shape), _described(self._shape)
            raise ValueError(f"{self._name}: frame {frame.index} is {found}, those before it are {before}")
        return frame

    def again(self) -> "Video":
        """Open the same file, folder or bag once more, from its beginning, its pictures in the same view.

        Raises
        ------
        ValueError
            If the source is live.
        """
        if self.live:
            raise ValueError(f"{self._name} is live: it cannot be read from its beginning")
        return Video(self._given, **self._opening())

    def _opening(self) -> dict[str, Any]:
        """Return the parameters with which the same pictures are opened again."""
        view = {name: getattr(self._wish, name) for name in self._wish.__struct_fields__}
        return {"fps": self._asked.get("fps"), "topic": self.topic, **view, "fields": self.fields}

    def __len__(self) -> int:
        """Return `length`; TypeError where it is not known."""
        if self.length is None:
            raise TypeError(f"{self._name} has no known length: it is live, or its file does not say")
        return self.length

    def __bool__(self) -> bool:
        return True

    @one_line
    def __repr__(self) -> str:
        rate = "" if self.fps is None else f", {self.fps:.4g} fps"
        count = "live" if self.live else "length not known" if self.length is None else f"{self.length} frames"
        kind = "BGR" if self.channels == 3 else "gray"
        closed = ", closed" if self._closed else ""
        return f"Video({self._name!r}, {self.width} x {self.height} {kind}{rate}, {count}{closed})"

    def close(self) -> None:
        """Let go of the file or device; its thread has ended afterwards. More than once does no harm."""
        self._closed = True
        self._finalizer()


def _described(shape: tuple[int, ...]) -> str:
    return f"{shape[1]} x {shape[0]} in {'color' if len(shape) == 3 else 'gray'}"
