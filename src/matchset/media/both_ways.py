"""The frames of a file, or pictures, forward, and then the same ones backward: `BothWays`, `PicturesBothWays`."""

from collections.abc import Callable, Iterable, Iterator, Sequence

from matchset.image.frame import ArrayFrames, Frame, Picture
from matchset.media.exact_reader import ExactReader
from matchset.media.frame_list import FrameList, StampedVideo
from matchset.media.video import Video


class BothWays:
    """Reads a file forward, notes which frames it has, and reads these backward, by jumps where they lead there.

    What is in memory at once is limited by `ReaderParameters.ahead_mb`.

    Parameters
    ----------
    video : Video
        It is opened anew for each way.
    used : callable, optional
        From all frames to those that are handed out, which are consecutive; all without it.

    Raises
    ------
    ValueError
        If it is a live source, which has no way back.
    """

    def __init__(self, video: Video, used: Callable[[Iterable[Frame]], Iterable[Frame]] = iter) -> None:
        if video.live:
            raise ValueError("a live source has no way back: give a file, or what was recorded of it")
        self._video, self._used = video, used
        self._frames, self._count, self._last = FrameList(), 0, 0

    def __len__(self) -> int:
        """Return how many frames `forward` has handed out."""
        return self._count

    def forward(self) -> Iterator[Frame]:
        """Yield the frames in order; to be read to the end, or as far as `backward` shall begin."""
        for frame in self._used(self._noted()):
            self._count, self._last = self._count + 1, len(self._frames) - 1
            yield frame

    def backward(self) -> Iterator[Frame]:
        """Yield those that `forward` has handed out, the last one first.

        Raises
        ------
        ValueError
            If the file was changed meanwhile.
        """
        self._frames.complete = True
        with ExactReader(lambda: StampedVideo.of(self._video), self._frames) as reader:
            frames = reader.backward(self._last)
            for _ in range(self._count):
                yield next(frames)

    def _noted(self) -> Iterator[Frame]:
        with StampedVideo.of(self._video) as video:
            for frame in video:
                self._frames.append(frame, video.stamp)
                yield frame


class PicturesBothWays:
    """Pictures forward and backward.

    Parameters
    ----------
    pictures : sequence of Frame or ndarray
    fps : float or None
        Of arrays, see `ArrayFrames`.

    Raises
    ------
    ValueError, TypeError
        If one is no picture, or there are frames among arrays.
    """

    def __init__(self, pictures: Sequence[Picture], fps: float | None) -> None:
        arrays = ArrayFrames(fps)
        self._frames = [arrays.next(each, k) for k, each in enumerate(pictures)]

    def forward(self) -> Iterator[Frame]:
        """Yield them in order."""
        return iter(self._frames)

    def backward(self) -> Iterator[Frame]:
        """Yield them, the last one first."""
        return reversed(self._frames)
