"""The panel of a recorded video: its buttons, its time line, its downloads (`FilePanel`)."""

import itertools
from pathlib import Path

import msgspec
import numpy as np

from matchset.live.feed import Panel
from matchset.live.files.exports import ExportedFile, ExportInProgress, Exports, part_of
from matchset.live.files.file_target import FileTarget
from matchset.live.files.messages import MESSAGES, Correct, Export, Pause, Play, Seek, Speed, Step, StopExport
from matchset.live.files.player import Player
from matchset.live.files.tracking import FileTracking
from matchset.live.targets.alike import on_one
from matchset.live.wire.messages import PageMessage
from matchset.media.frame_list import FrameList
from matchset.tracking.track import Track


class TimeLineParameters(msgspec.Struct, frozen=True, kw_only=True):
    """How exact the time line is.

    Parameters
    ----------
    columns : int
        At most; a column of several frames shows a loss if there is one. More: finer, and more to send. Chosen by hand:
        a wide screen.
    """

    columns: int = 1500


class TargetLine(msgspec.Struct, frozen=True, omit_defaults=True):
    """Where a target was found.

    Parameters
    ----------
    id : int
    name : str
    line : list of int
        A code and for how many columns it holds, and so on: 0 not known yet, 1 found, 2 lost.
    percent : float
        Of the frames, how many are done.
    found, lost : int
        Frames.
    part : str
        Which frames are known, in words, as long as that is not the whole video.
    first, last : int or None
        Index of the first frame and of the last one in which it was found; null: in none yet.
    known : int
        Index of the last frame of which it is known whether it is there.
    version : int
        Another one whenever more is known: then its course (`/course.json`) is another one, too.
    """

    id: int
    name: str
    line: list[int] = []
    percent: float = 0.0
    found: int = 0
    lost: int = 0
    part: str = ""
    first: int | None = None
    last: int | None = None
    known: int = 0
    version: int = 0


class FileState(msgspec.Struct, frozen=True, omit_defaults=True):
    """What the page shows of a recorded video.

    Parameters
    ----------
    index : int
        Of the frame that is shown.
    last : int
        Index of the last frame that was read; those after it are not known yet.
    end : int
        Index of the last frame there will be, as far as known.
    time, duration : float
        Of the frame that is shown, and of the last one, s.
    complete : bool
        Whether the file was read to its end.
    playing : bool
    waiting : bool
        Whether it would play on, but what comes next is not tracked yet.
    speed : float
    targets : list of TargetLine
    rate : float or None
        Frames per second that are tracked now.
    computing : dict of str to float
        What a frame took so far, ms: median, mean, percentile_95, worst.
    left : float or None
        Time until all is tracked, s.
    working : ExportInProgress or None
        What is being written.
    written : list of ExportedFile
        What can be downloaded.
    same : str
        Which targets were found on one ball, and where, in words.
    """

    index: int
    last: int
    end: int
    time: float
    duration: float
    complete: bool = False
    playing: bool = False
    waiting: bool = False
    speed: float = 1.0
    targets: list[TargetLine] = []
    rate: float | None = None
    computing: dict[str, float] = {}
    left: float | None = None
    working: ExportInProgress | None = None
    written: list[ExportedFile] = []
    same: str = ""


class FilePanel(Panel):
    """Takes what the buttons say.

    Parameters
    ----------
    frames : FrameList
    player : Player
    tracking : FileTracking
    exports : Exports
    length : int or None
        Frames that the file announces.
    parameters : TimeLineParameters, optional
    """

    name = "file"
    messages = MESSAGES

    def __init__(
        self,
        frames: FrameList,
        player: Player,
        tracking: FileTracking,
        exports: Exports,
        length: int | None,
        parameters: TimeLineParameters | None = None,
    ) -> None:
        self._frames, self._player, self._tracking, self._exports = frames, player, tracking, exports
        self._length, self._columns = length, (parameters or TimeLineParameters()).columns
        self._lines: dict[int, tuple[tuple[int, int, bool, bool], TargetLine]] = {}
        self._same: tuple[list[tuple[int, int]], str] = [], ""

    def take(self, message: PageMessage, page: str) -> None:  # noqa: ARG002
        """Do what a button says."""
        player = self._player
        match message:
            case Play():
                player.play()
            case Pause():
                player.pause()
            case Step():
                player.step(message.frames)
            case Seek():
                player.seek(message.index)
            case Speed():
                player.set_speed(message.factor)
            case Correct():
                self._tracking.ask(message)
            case Export():
                self._exports.start(message, self._tracking.targets)
            case StopExport():
                self._exports.stop()

    def state(self) -> FileState | None:
        """Return where the player is, and what was found so far."""
        frames, player, tracking = self._frames, self._player, self._tracking
        if not len(frames):
            return None
        shown, last = frames[player.place], frames[len(frames) - 1]
        end = last.index if frames.complete else max(last.index, (self._length or 0) - 1)
        targets, rate = list(tracking.targets.values()), tracking.rate
        open_frames = sum(max(end + 1 - target.known, 0) for target in targets) if tracking.busy else 0
        return FileState(
            index=shown.index,
            last=last.index,
            end=end,
            time=round(shown.time, 6),
            duration=round(last.time, 6),
            complete=frames.complete,
            playing=player.playing,
            waiting=player.playing and player.waiting,
            speed=player.speed,
            targets=[self._line(target, end) for target in targets],
            rate=rate,
            computing=tracking.computing,
            left=open_frames / rate if rate and open_frames else None,
            working=self._exports.working,
            written=self._exports.written,
            same="" if tracking.busy else self._on_one_ball(targets),
        )

    def downloads(self) -> dict[str, Path]:
        """Return what was written."""
        return self._exports.paths

    def _on_one_ball(self, targets: list[FileTarget]) -> str:
        """Say which targets were found on one ball; looked at again when something else is known."""
        key = [(target.number, target.version) for target in targets]
        if self._same[0] != key:
            said = []
            for one, other in itertools.combinations(targets, 2):
                places = same_places(one, other)
                if places:
                    first, count = self._frames[places[0]].index, len(places)
                    frames = f"{count} {'frame' if count == 1 else 'frames'}, first in frame {first}"
                    said.append(f"{one.name} and {other.name} are on one ball in {frames}: correct one of them there")
            self._same = key, "; ".join(said)
        return self._same[1]

    def _line(self, target: FileTarget, end: int) -> TargetLine:
        begins_later = not (target.clicked or self._tracking.busy)  # before it was found it is not there, or not known
        key = target.version, end, self._frames.complete, begins_later
        kept = self._lines.get(target.number)
        if kept is None or kept[0] != key:
            codes = by_index(target.codes, self._frames, end)
            line = run_lengths(columns(codes, self._columns))
            counts = np.bincount(codes, minlength=3).tolist()
            percent = 100.0 * target.known / max(len(self._frames), 1) if end else 100.0
            if not self._frames.complete:
                percent = 100.0 * target.known / (end + 1)
            part = part_of(target, self._frames).words if target.known else ""
            first, last = target.first_found(), target.last_found(len(target.codes))
            done = TargetLine(
                id=target.number,
                name=target.name,
                line=line,
                percent=100.0 if begins_later else round(percent, 1),
                found=counts[1],
                lost=counts[2],
                part=part,
                first=None if first is None else self._frames[first].index,
                last=None if last is None else self._frames[last].index,
                known=int(np.flatnonzero(codes)[-1]) if target.known else 0,
                version=target.version,
            )
            kept = key, done
            self._lines = {number: each for number, each in self._lines.items() if number in self._tracking.targets}
            self._lines[target.number] = kept
        return kept[1]


def same_places(one: FileTarget, other: FileTarget) -> list[int]:
    """Return the places of the frames in which two targets were found on one outline."""
    places = []
    for place, answer in one.found(range(min(len(one.codes), len(other.codes)))):
        twin = other.answer(place)
        if isinstance(answer, Track) and isinstance(twin, Track) and on_one(answer, twin):
            places.append(place)
    return places


def by_index(codes: bytes, frames: FrameList, end: int) -> np.ndarray[tuple[int], np.dtype[np.uint8]]:
    """Return the codes of a target by `Frame.index`, 0 ... end, from those by place."""
    found = np.zeros(end + 1, np.uint8)
    found[frames.indices(len(codes))] = np.frombuffer(codes, np.uint8)
    return found


def columns(
    codes: np.ndarray[tuple[int], np.dtype[np.uint8]], most: int
) -> np.ndarray[tuple[int], np.dtype[np.uint8]]:  # fmt: skip
    """Reduce codes to a number of columns; the largest code of each counts."""
    if len(codes) <= most:
        return codes
    begins = np.arange(most) * len(codes) // most
    return np.maximum.reduceat(codes, begins)


def run_lengths(codes: np.ndarray[tuple[int], np.dtype[np.uint8]]) -> list[int]:
    """Write codes as a code, how often it comes, the next code ..."""
    changes = np.flatnonzero(np.diff(codes)) + 1
    begins = np.concatenate(([0], changes, [len(codes)]))
    pairs = np.stack((codes[begins[:-1]].astype(int), np.diff(begins)), axis=1)
    return pairs.ravel().tolist()
