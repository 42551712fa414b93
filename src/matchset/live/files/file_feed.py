"""A recorded video as a feed: `FileFeed`."""

import contextlib
import threading
from collections.abc import Callable

import numpy as np
import numpy.typing as npt

from matchset.app.cli_options import UPRIGHT, TurnOptions
from matchset.camera.camera_model import CameraModel
from matchset.image.frame import Frame
from matchset.live.camera.camera_panel import CameraPanel
from matchset.live.feed import Feed, News, StreamPicture
from matchset.live.files.exports import Exports
from matchset.live.files.panel import FilePanel
from matchset.live.files.player import Player
from matchset.live.files.series import PlottedCourse, Series
from matchset.live.files.tracking import FileTracking
from matchset.live.targets.messages import Outline, Pick, Wish
from matchset.live.targets.panel import TargetsPanel
from matchset.live.wire.state import State
from matchset.media.closing import close_all
from matchset.media.exact_reader import DEFAULT, ExactReader, KeptPictures, ReaderParameters
from matchset.media.frame_list import FrameList, StampedVideo

PATIENCE = 1.0  # format: s for which reading ahead waits for the answer to a click, a frame


class FileFeed(Feed):
    """Shows a file, and tracks in it what is clicked.

    It is read once from begin to end in the background, to know every frame. The player, the tracker and what writes
    films each read it anew, with bounded memory (`ReaderParameters`), however long it is.

    Parameters
    ----------
    title : str
    open_source : callable
        Opens the file; called several times, in several threads.
    news : callable
        Told of each picture.
    note : callable
        Told what a person should know.
    mounted : TurnOptions, optional
        How its pictures are turned: camera files are turned, too.
    parameters : ReaderParameters, optional

    Attributes
    ----------
    seen : StreamPicture
    length : int or None
        Frames that the file announces.
    frames : FrameList
    player : Player
    tracking : FileTracking
    exports : Exports
    panel : FilePanel

    Raises
    ------
    ValueError
        If it is no video, or cannot be read.
    """

    kind = "file"

    def __init__(
        self,
        title: str,
        open_source: Callable[[], StampedVideo],
        news: News,
        note: Callable[[str], None],
        mounted: TurnOptions = UPRIGHT,
        parameters: ReaderParameters = DEFAULT,
    ) -> None:
        self.title, self._open, self._news, self._note = title, open_source, news, note
        with open_source() as video:
            self.length, self._fps, self._size = video.length, video.fps, (video.width, video.height)
        self.seen = StreamPicture(None, State(0, 0, 0.0, 0, 0, live=False))
        self.frames = FrameList()

        def reader() -> ExactReader:
            return ExactReader(open_source, self.frames, parameters)

        self._reader = reader()
        self.player = Player(KeptPictures(self._reader, parameters), self.frames, self)
        self.tracking = FileTracking(reader(), self.frames, self.player, note)
        self.tracking.answered = self.player.go_on
        self.tracking.size = self._size
        self.exports = Exports(reader, self.frames, note)
        self.exports.fps = self._fps
        self._described, self._stop = -1, threading.Event()
        self._reader.interrupted = self._stop.is_set
        self._series, self._lock = dict[int, Series](), threading.Lock()
        self.streams = (self,)
        self._camera = CameraPanel(self, note, mounted=mounted)
        self.panel = FilePanel(self.frames, self.player, self.tracking, self.exports, self.length)
        self.panels = (TargetsPanel(self.ask, self.tracking.clicks), self._camera, self.panel)
        self._thread = threading.Thread(target=self._read_all, name="matchset frames", daemon=True)
        self._thread.start()
        self.player.start()

    def ask(self, wish: Wish) -> None:
        """Ask for something; where somebody clicked the video stands until that is found, then it plays on.

        The first click on a video that nobody has moved yet begins to play it, if something is found.
        """
        if isinstance(wish, Pick | Outline):
            with contextlib.suppress(ValueError):  # a picture of long ago: the tracking says so
                self.player.halt(wish.sequence)
        self.tracking.ask(wish)

    @property
    def camera(self) -> CameraModel | None:
        """What is known of the camera that filmed it."""
        return self.tracking.camera

    def use(self, camera: CameraModel | None) -> None:
        """Use another camera model, for what was found and what will be; None: it is not known.

        Raises
        ------
        ValueError
            If it is that of pictures of another size.
        """
        if camera is not None:
            camera.check(self._size)
        self.tracking.use(camera)

    def mask(self, target: int, sequence: int) -> npt.NDArray[np.uint8]:
        """Return what the color model of a target takes for it in a picture that was shown last: (h, w), 255 there.

        Raises
        ------
        ValueError
            If there is no such target, or the picture was shown too long ago.
        """
        frame, followed = self.player.frame_of(sequence), self.tracking.targets.get(target)
        if followed is None or followed.color is None:
            raise ValueError(f"there is no target {target}")
        if frame is None:
            raise ValueError(f"picture {sequence} is not shown any more")
        return followed.color.for_image(frame.image).mask(frame.image)

    def course(self, target: int) -> PlottedCourse:
        """Return the course of a target over the whole video; ValueError if there is no such target."""
        followed = self.tracking.targets.get(target)
        if followed is None:
            raise ValueError(f"there is no target {target}")
        with self._lock:
            self._series = {number: each for number, each in self._series.items() if number in self.tracking.targets}
            series = self._series.setdefault(target, Series(followed, self.frames))
        return series.course()

    def show(self, frame: Frame, place: int, sequence: int) -> None:
        """Show a frame, with what is known of it; called by the player."""
        self._described = self.tracking.version
        height, width = frame.image.shape[:2]
        targets = [target.state(place) for target in self.tracking.targets.values()]
        state = State(
            sequence,
            frame.index,
            frame.time,
            width,
            height,
            targets=targets,
            camera_fps=self._fps,
            fps=self.tracking.rate,
            live=False,
            stretch=self.player.stretch,
        )
        poses = {target.number: target.pose(place) for target in self.tracking.targets.values()}
        known = {number: pose for number, pose in poses.items() if pose is not None}
        self.seen = StreamPicture(frame, state, known, self.tracking.camera)
        self._news(0)

    def is_old(self, place: int) -> bool:
        """Whether something else is known of the frame that is shown; called by the player."""
        version, ended = self.tracking.version, self.seen.state.fps is not None and not self.tracking.busy
        if version == self._described and not ended:
            return False
        self._described = version
        if ended or self.seen.camera is not self.tracking.camera:
            return True
        return [target.state(place) for target in self.tracking.targets.values()] != self.seen.state.targets

    def fail(self, words: str) -> None:
        """Say what is wrong; called by the player."""
        self._note(words)

    def reach(self, place: int) -> int | None:
        """Return up to which frame the video plays on from a place: as far as it is tracked; called by the player."""
        return self.tracking.reach(place)

    @property
    def busy_tracking(self) -> bool:
        """Whether something is being tracked."""
        return self.tracking.busy

    def close(self) -> None:
        """End all threads, and close the file."""
        self._stop.set()
        close_all(
            self._camera.close,
            self._thread.join,
            self.player.close,
            self.tracking.close,
            self.exports.close,
            self._reader.close,
        )

    def _read_all(self) -> None:
        """Read the file once, to know every frame."""
        try:
            with self._open() as video:
                for frame in video:
                    self.frames.append(frame, video.stamp)
                    self.tracking.calm.wait(PATIENCE)
                    if self._stop.is_set():
                        return
                for words in video.warnings:
                    self._note(words)
        except (ValueError, OSError) as error:
            self._note(f"{error}: the video ends there")
        finally:
            self.frames.complete = True
