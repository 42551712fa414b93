"""Times of the frames of a video file, from time stamps of which some are missing, equal or wrong: `FileClock`."""

import math
from collections import deque
from collections.abc import Sequence
from itertools import pairwise
from statistics import median

import msgspec

DEFAULT_FPS = 30.0  # format: of a file that states no usable frame rate
GIVE = "if that is wrong, give the rate with --fps (in Python: fps)"


class ClockParameters(msgspec.Struct, frozen=True):
    """When the time stamps and the frame rate of a file are believed.

    Chosen by hand; `tests/media/test_file_clock.py` and `tests/media/test_strange_files.py` show a change.

    Parameters
    ----------
    memory : int
        Rises from one stamp to the next that are remembered: their least and their median stand in for what a stamp
        does not say. More are steadier, fewer follow a rate that varies.
    max_late : float
        Share of the first frames whose stamp may be earlier than one before it. With more the stamps are not in the
        order of the frames, and none is used.
    max_rate : float
        Frames per second that no camera exceeds: a faster file does not state a rate but its time base.
    usual_rate : float
        Frames per second above which a file is believed, but said to be unusual.
    rate_ratio : float
        Ratio of the stated rate and that of the stamps, one way or the other, up to which the stated one is used.
    equal_frames : int
        Frames with equal stamps, one after the other, that share the time until the next stamp.
    restart_s : float
        How far stamps must have gone back, s, to count as begun anew.
    restart_frames : int
        Frames whose stamps must rise again until they are followed.
    far_s : float
        How far from 0 the first stamp may be, s. From farther on the first frame is at 0: OpenCV 4 makes such stamps of
        a stream without a start. MPEG-TS counts to 95 444 s.
    """

    memory: int = 16
    max_late: float = 0.25
    max_rate: float = 1000.0
    usual_rate: float = 250.0
    rate_ratio: float = 2.0
    equal_frames: int = 4
    restart_s: float = 1.0
    restart_frames: int = 3
    far_s: float = 1e6


DEFAULT = ClockParameters()


class FileClock:
    """Time of one frame after the other, always later than the one before.

    A frame whose stamp is later than the time before it gets its stamp. One whose stamp is equal to the one before, or
    hardly earlier, gets a time between that and the earliest at which the next stamp can come, so it is off by less
    than a frame period. One without a stamp comes a median frame period after the one before. Only where the stamps of
    the first frames are useless all times are index / rate.

    Parameters
    ----------
    stamps : sequence of float
        Stamps of the first frames, s; not finite where there is none.
    stated : float
        The file's frame rate, 1/s; 0 if it states none.
    given : float or None
        The rate that the user gave, 1/s: times are index / given.
    parameters : ClockParameters

    Attributes
    ----------
    rate : float
        Frames per second: the given one, the stated one if the stamps agree, or theirs.
    measured : float or None
        Frames per second by the first stamps; None if they do not say.
    agree : bool
        Whether stamps and stated rate do not contradict each other.
    last : float
        Time of the last frame, s; -inf before the first one.
    """

    def __init__(
        self, stamps: Sequence[float], stated: float, given: float | None, parameters: ClockParameters = DEFAULT
    ) -> None:
        self.parameters, self.last = parameters, -math.inf
        self._notes: list[str] = []
        known = [stamp for stamp in stamps if math.isfinite(stamp)]
        measured = stamp_rate(known)
        self.measured = measured if measured is not None and measured <= parameters.max_rate else None
        ratio = parameters.rate_ratio
        possible = 0.0 < stated <= parameters.max_rate
        self.agree = possible and (self.measured is None or stated / ratio <= self.measured <= stated * ratio)
        useless = self.measured is None or not _in_order(known, parameters.max_late)
        self._stamped = given is None and not (useless and len(stamps) > 1)
        self.rate = given or (stated if self.agree else self.measured or DEFAULT_FPS)
        if given is None:
            self._note_rate(stated)
        rises = [late - early for early, late in pairwise(sorted(known)) if late > early]
        self._rises = deque(rises or [1.0 / self.rate], parameters.memory)
        self._index, self._stamp = -1, math.nan
        self._offset = -known[0] if known and abs(known[0]) > parameters.far_s else 0.0
        self._equal = self._rising = 0
        self._interpolated, self._first_interpolated = 0, 0

    def _note_rate(self, stated: float) -> None:
        """Note the rate if it is assumed, or unusual."""
        if not self._stamped:
            wrong = "say nothing" if self.measured is None else "are out of order"
            doubt = f"its frame rate, {stated:g}, is not credible" if stated > 0.0 else "it states no frame rate"
            why = "" if self.agree else f", and {doubt}"
            self._notes.append(f"the file's time stamps {wrong}{why}: {self.rate:g} frames/s are assumed; {GIVE}")
        elif self.rate > self.parameters.usual_rate:
            self._notes.append(f"the file's time stamps say {self.rate:g} frames/s; {GIVE}")

    @property
    def warnings(self) -> list[str]:
        """What had to be assumed so far, one sentence each."""
        if not self._interpolated:
            return list(self._notes)
        count, first = self._interpolated, self._first_interpolated
        if count == 1:
            words = f"frame {first} has no usable time stamp, its time is interpolated"
        else:
            words = f"{count} frames from frame {first} on have no usable time stamp, their times are interpolated"
        return [*self._notes, words]

    @property
    def period(self) -> float:
        """Median time from one stamp to the next, s."""
        return median(self._rises)

    def time(self, index: int, stamp: float) -> float:
        """Time of the next frame that was decoded.

        Parameters
        ----------
        index : int
            Its number; larger than the one before by more than 1 if frames between did not decode.
        stamp : float
            Its time stamp, s.

        Returns
        -------
        float
            Its time, s.
        """
        shifted = stamp + self._offset if math.isfinite(stamp) else math.nan
        time = self._from_stamp(index, shifted) if self._stamped else index / self.rate
        self.last = max(time, math.nextafter(self.last, math.inf))
        self._index = index
        return self.last

    def _from_stamp(self, index: int, stamp: float) -> float:
        steps = index - self._index
        if stamp > self.last:
            if stamp > self._stamp:
                self._rises.append((stamp - self._stamp) / steps)
            self._stamp, self._equal, self._rising = stamp, 0, 0
            return stamp
        self._first_interpolated = self._first_interpolated if self._interpolated else index
        self._interpolated += 1
        if not math.isfinite(self.last):
            return index * self.period
        before, self._stamp = self._stamp, stamp
        next_stamp = stamp + min(self._rises)
        if next_stamp > self.last and self._equal < self.parameters.equal_frames:
            self._equal += 1
            return (self.last + next_stamp) / 2.0
        return self._restart(index, stamp, before) or self.last + steps * self.period

    def _restart(self, index: int, stamp: float, before: float) -> float | None:
        """Follow stamps that have gone far back and rise again; the time of this frame, or None if they do not."""
        back = self.last - stamp > self.parameters.restart_s
        self._rising = self._rising + 1 if back and stamp > before else 0
        if self._rising < self.parameters.restart_frames:
            return None
        now = self.last + (stamp - before)
        self._offset += now - stamp
        self._stamp, self._rising = now, 0
        self._notes.append(f"time stamps begin anew near frame {index}: they are taken to follow those before")
        return now


def stamp_rate(stamps: Sequence[float]) -> float | None:
    """Frames per second by the middle half of the stamps, in s; None if they do not rise.

    Equal stamps count, and a few that are far off do not matter.
    """
    ordered = sorted(stamps)
    low, high = len(ordered) // 4, 3 * len(ordered) // 4
    passed = ordered[high] - ordered[low] if high > low else 0.0
    return (high - low) / passed if passed > 0.0 else None


def _in_order(stamps: Sequence[float], max_late: float) -> bool:
    """Whether at most this share of the stamps is earlier than one before it."""
    late, latest = 0, -math.inf
    for stamp in stamps:
        late += stamp < latest
        latest = max(latest, stamp)
    return late <= max_late * len(stamps)
