"""A pilot's camera that is really there: `LiveCamera`; it never makes the loop wait for longer than it was told."""

import math
import time
from collections.abc import Callable

from msgspec.structs import replace

from matchset.camera.camera_model import CameraModel
from matchset.flight.linked.parameters import LinkedParameters
from matchset.image.errors import LinkError
from matchset.image.frame import Frame
from matchset.media.video import Video

MILLI = 1e-3  # format: s of a ms


class LiveCamera:
    """Pictures of a live source for a `Pilot`, on a clock that begins at 0.

    A camera that fails or falls silent is a camera without pictures, so that the pilot's own safety brings the vehicle
    down; `fault` says what is wrong. Meanwhile the thread that reads a stream opens it again: when it is back there are
    pictures again.

    Parameters
    ----------
    name : str
        What to call it in messages.
    video : Video
        Live; belongs to the camera from here on.
    model : CameraModel
    delay_ms : float
        See `LinkedFollower.delay_ms`.
    parameters : LinkedParameters, optional
    clock : callable
        That of the video's times, s.

    Attributes
    ----------
    name : str
    model : CameraModel
    video : Video
    """

    def __init__(
        self,
        name: str,
        video: Video,
        model: CameraModel,
        delay_ms: float = 0.0,
        parameters: LinkedParameters | None = None,
        clock: Callable[[], float] = time.monotonic,
    ) -> None:
        self.name, self.video, self.model = name, video, model
        self._parameters, self._delay = parameters or LinkedParameters(), MILLI * delay_ms
        self._clock = clock
        self._failure = ""
        self.begin(clock())

    def begin(self, start: float) -> None:
        """Let the clock begin.

        Parameters
        ----------
        start : float
            Time on the clock of the video that is 0 from now on, s.
        """
        self._start, self._arrived, self._last = start, self._clock(), -math.inf

    def now(self) -> float:
        """Return the time on the clock of the pictures, s."""
        return self._clock() - self._start

    def read(self) -> Frame | None:
        """Return the newest picture; None if none came within `LinkedParameters.wait`."""
        before = self._clock()
        try:
            frame = self.video.newest(self._parameters.wait)
        except (LinkError, ValueError) as error:
            self._failure = str(error)
            time.sleep(max(self._parameters.wait - (self._clock() - before), 0.0))
            return None
        if frame is None:
            return None
        self._arrived = self._clock()
        taken = frame.time - self._start - self._delay
        if not taken > self._last:  # taken before the clock began, or by a driver whose stamps do not run forward
            return None
        self._last = taken
        return replace(frame, time=taken)

    @property
    def fault(self) -> str:
        """Why no more pictures are to be expected, in words; empty as long as they are."""
        silent = self._clock() - self._arrived
        if self._failure or silent <= self._parameters.silence:
            return self._failure
        return f"{self.name} has delivered no picture for {silent:.1f} s"

    @property
    def may_return(self) -> bool:
        """Whether a camera without pictures is still being opened again."""
        lost = self._clock() - self._arrived - self._parameters.silence
        return not self._failure and lost < self.video.reconnect

    @property
    def notes(self) -> list[str]:
        """What to know of its pictures, in words: what their times are worth, and what it does not do as asked."""
        words = [f"{self.name}: {warning}" for warning in self.video.warnings]
        if self.video.stamped:
            return words
        way = f"{self._delay / MILLI:.0f} ms are added" if self._delay else "nothing is added"
        stamps = (
            f"{self.name} gives no time of capture: the age of its pictures counts from their arrival; {way} for the "
            "way before that (--delay-ms, delay_ms)"
        )
        return [stamps, *words]

    def close(self) -> None:
        """Let go of the device."""
        self.video.close()
