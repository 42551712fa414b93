"""Tables and annotated videos of what was found, written in a thread: `Exports`."""

import contextlib
import functools
import threading
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any, NamedTuple

import msgspec
import numpy as np
import numpy.typing as npt

from matchset.app.drawing.annotate import TrackPainter, as_color, draw_answer
from matchset.app.films.video_writer import FilmWriter, quick_ending
from matchset.app.locate.annotate_pose import PosePainter
from matchset.app.locate.loop import LocatedFrame
from matchset.app.locate.rows import pose_columns, pose_row
from matchset.app.run_folder import output_folder
from matchset.app.several.poses import TargetPoseRow, target_pose_columns
from matchset.app.several.target_rows import TargetRow, target_columns, target_row
from matchset.app.tables import RowWriter
from matchset.app.target.shape_option import parse_shape
from matchset.app.track.loop import UNDECODED
from matchset.app.track.rows import track_columns, track_row
from matchset.image.frame import Frame
from matchset.live.files.file_target import Answer, FileTarget
from matchset.live.files.messages import Export
from matchset.localization.localizer import Localizer
from matchset.localization.pose import Pose
from matchset.media.closing import Closing
from matchset.media.exact_reader import ExactReader, InterruptedReadingError
from matchset.media.frame_list import FrameList
from matchset.tracking.many.target import Target
from matchset.tracking.track import Lost

DEFAULT_FPS = 30.0  # format: of a film whose video states no rate


class ExportInProgress(msgspec.Struct, frozen=True, omit_defaults=True):
    """What is being written.

    Parameters
    ----------
    name : str
        Of the file.
    percent : float
    rate : float
        Frames per second.
    left : float or None
        Time until it is finished, s.
    """

    name: str
    percent: float = 0.0
    rate: float = 0.0
    left: float | None = None


class ExportedFile(msgspec.Struct, frozen=True):
    """A file that is finished.

    Parameters
    ----------
    name : str
    target : int
    words : str
        What it holds.
    """

    name: str
    target: int
    words: str


class KnownPart(NamedTuple):
    """The frames in which it is known whether a target is there.

    Attributes
    ----------
    places : ndarray
        (n,), int64, of these frames.
    first, last : int
        `Frame.index` of the first and the last one.
    whole : bool
        Whether that is the whole video.
    """

    places: npt.NDArray[np.int64]
    first: int
    last: int
    whole: bool

    @property
    def suffix(self) -> str:
        """What a file's name says of it."""
        return "" if self.whole else f"-frames-{self.first}-{self.last}"

    @property
    def words(self) -> str:
        """For people; empty: the whole video."""
        if self.whole:
            return ""
        gaps = len(self.places) and self.places[-1] - self.places[0] >= len(self.places)
        return f"frames {self.first} to {self.last}{', with gaps' if gaps else ''}"


def part_of(target: FileTarget, frames: FrameList) -> KnownPart:
    """Return what is known of a target now."""
    complete = frames.complete
    places = np.flatnonzero(np.frombuffer(target.codes, np.uint8)).astype(np.int64)
    if not len(places):
        return KnownPart(places, 0, 0, False)
    first, last = (frames[int(place)].index for place in places[[0, -1]])
    return KnownPart(places, first, last, complete and len(places) == len(frames))


class Exports(Closing):
    """Writes one thing at a time, into a new folder below `runs`.

    Parameters
    ----------
    open_reader : callable
        Makes a reader for the thread.
    frames : FrameList
    note : callable
        Told what a person should know.

    Attributes
    ----------
    working : ExportInProgress or None
    written : list of ExportedFile
        Replaced, never changed.
    fps : float or None
        Of the video.
    """

    def __init__(
        self, open_reader: Callable[[], ExactReader], frames: FrameList, note: Callable[[str], None]
    ) -> None:  # fmt: skip
        self._open_reader, self._frames, self._note = open_reader, frames, note
        self.working: ExportInProgress | None = None
        self.written: list[ExportedFile] = []
        self.fps: float | None = None
        self._folder: Path | None = None
        self._stop = threading.Event()
        self._thread: threading.Thread | None = None
        self._began, self._several = 0.0, False

    def start(self, wish: Export, targets: dict[int, FileTarget]) -> None:
        """Begin to write.

        Raises
        ------
        ValueError
            If something is being written, there is no such target, or nothing is known of it yet.
        """
        target = targets.get(wish.target)
        if self.working is not None:
            raise ValueError(f"{self.working.name} is being written: wait, or stop it")
        if target is None or not target.known:
            raise ValueError(f"there is nothing to write of target {wish.target} yet")
        self._stop.clear()
        self.working, self._began = (
            ExportInProgress("tables" if wish.what == "tables" else "annotated video"),
            time.monotonic(),
        )
        others = [other for other in targets.values() if other is not target]
        self._several = bool(others)
        part = part_of(target, self._frames)
        if wish.what == "tables":
            work = functools.partial(self._tables, target, part)
        else:
            work = functools.partial(self._film, target, others, part)
        self._thread = threading.Thread(target=self._run, args=(work,), name="matchset export", daemon=True)
        self._thread.start()

    def stop(self) -> None:
        """Stop writing; does not wait."""
        self._stop.set()

    def close(self) -> None:
        """Stop writing, and wait until it has ended."""
        self.stop()
        if self._thread is not None:
            self._thread.join()

    @property
    def paths(self) -> dict[str, Path]:
        """The finished files by their names."""
        folder = self._folder
        return {} if folder is None else {each.name: folder / each.name for each in self.written}

    def _run(self, work: Callable[[], None]) -> None:
        try:
            work()
        except (ValueError, OSError) as error:
            self._note(str(error))
        finally:
            self.working = None

    def _new_path(self, name: str) -> Path:
        if self._folder is None:
            self._folder = output_folder(None, "live")
        return self._folder / name

    def _finish(self, path: Path, target: FileTarget, words: str) -> None:
        done = ExportedFile(path.name, target.number, words)
        self.written = [*(each for each in self.written if each.name != path.name), done]

    def _progress(self, name: str, done: int, count: int) -> None:
        passed = max(time.monotonic() - self._began, 1e-6)
        rate = done / passed
        left = (count - done) / rate if rate > 0.0 else None
        self.working = ExportInProgress(name, 100.0 * done / max(count, 1), rate, left)

    def _answers(self, target: FileTarget, part: KnownPart) -> Iterator[tuple[int, int, Answer]]:
        """Yield the indices of frames, their places, and what was found there; frames that did not decode are lost."""
        last = -1
        for place, answer in target.found(part.places.tolist()):
            mark = self._frames[place]
            before = self._frames[place - 1] if place else None
            if before is None or before.index == last or last < 0:
                begin = (-1, 0.0) if before is None else (before.index, before.time)
                for index in range(begin[0] + 1, mark.index):
                    share = (index - begin[0]) / (mark.index - begin[0])
                    yield index, -1, Lost(UNDECODED, round(begin[1] + share * (mark.time - begin[1]), 6))
            yield mark.index, place, answer
            last = mark.index
            if self._stop.is_set():
                return

    def _says_whose(self, target: FileTarget) -> bool:
        """Whether rows say whose they are: there are several targets, or it has a name of its own."""
        return self._several or target.name != f"{target.shape} {target.number}"

    def _tables(self, target: FileTarget, part: KnownPart) -> None:
        path = self._new_path(f"tracks-{target.number}{part.suffix}.csv")
        count, found = 0, 0
        localizer, parameters = target.new_localizer(), parse_shape(target.shape).parameters
        columns = target_columns(parameters) if self._says_whose(target) else track_columns(parameters)
        with RowWriter[TargetRow](path, columns) as table:
            for index, place, answer in self._answers(target, part):
                said = target_row(index, Target(target.number, target.name, answer, 0.0, target.alternatives(place)))
                table.write(said)
                count, found = count + 1, found + (not isinstance(answer, Lost))
                self._progress(path.name, count, len(part.places))
        words = f"{count} frames, found in {found}"
        if self._stop.is_set():
            path.unlink()
            return
        self._finish(path, target, words)
        if localizer is not None:
            self._poses(target, localizer, part)

    def _poses(self, target: FileTarget, localizer: Localizer, part: KnownPart) -> None:
        folder = self._new_path(f"target-{target.number}")
        folder.mkdir(exist_ok=True)
        count = found = 0
        columns = target_pose_columns() if self._says_whose(target) else pose_columns()
        with RowWriter[TargetPoseRow](folder / "poses.csv", columns) as table:
            for index, place, answer in self._answers(target, part):
                pose = localizer.update(answer)
                values = msgspec.structs.asdict(pose_row(index, pose))
                whose = target.number, target.name, target.alternatives(place)
                table.write(TargetPoseRow(**values, identity=whose[0], label=whose[1], alternatives=whose[2]))
                count, found = count + 1, found + isinstance(pose, Pose)
        path = self._new_path(f"poses-{target.number}{part.suffix}.csv")
        (folder / "poses.csv").replace(path)
        folder.rmdir()
        self._finish(path, target, f"{count} frames, located in {found}")

    def _film(self, target: FileTarget, others: list[FileTarget], part: KnownPart) -> None:
        path = self._new_path(f"annotated-{target.number}{part.suffix}{quick_ending()}")
        count, written = len(self._frames), 0
        with contextlib.suppress(InterruptedReadingError), self._open_reader() as reader:
            reader.interrupted = self._stop.is_set
            first = reader.frame(0)
            painter = _Painter(target, others, (first.image.shape[1], first.image.shape[0]))
            with FilmWriter(path, self.fps or DEFAULT_FPS, painter.size) as recorder:
                for place, frame in enumerate(reader.stretch(0, count)):
                    recorder.write(painter.paint(place, frame))
                    written = place + 1
                    self._progress(path.name, written, count)
                    if self._stop.is_set() or recorder.failure is not None:
                        break
        if self._stop.is_set():
            path.unlink(missing_ok=True)
            return
        known = "" if part.whole else f", known in {part.words}"
        self._finish(path, target, recorder.note or f"{written} frames{known}")


class _Painter:
    """Draws what was found into the frames of a film, the other targets without words."""

    def __init__(self, target: FileTarget, others: list[FileTarget], size: tuple[int, int]) -> None:
        self._target, self._others, self._localizer = target, others, target.new_localizer()
        self._plain = TrackPainter(size, parse_shape(target.shape).parameters)
        self._located: PosePainter | None = None
        if self._localizer is not None and target.camera is not None and target.diameter is not None:
            self._located = PosePainter(target.camera, 0.5 * target.diameter, marked=False)
        self.size = (self._located or self._plain).size

    def paint(self, place: int, frame: Frame) -> np.ndarray[Any, np.dtype[np.uint8]]:
        """Draw into a copy of a frame."""
        image = as_color(frame.image)
        for other in self._others:
            also = other.answer(place)
            if also is not None:
                draw_answer(image, also)
        drawn = Frame(image, frame.time, frame.index)
        answer = self._target.answer(place) or Lost("not tracked here", frame.time)
        if self._located is None or self._localizer is None:
            return self._plain.paint(drawn, answer, track_row(frame.index, answer))
        pose = self._localizer.update(answer)
        row = pose_row(frame.index, pose)
        return self._located.paint(drawn, LocatedFrame(drawn, answer, (), pose, row))
