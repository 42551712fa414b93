"""Shows the frames of a file: plays, stops, steps, goes to any frame (`Player`)."""

import threading
import time
from collections import OrderedDict
from typing import Protocol

import msgspec

from matchset.image.frame import Frame
from matchset.media.closing import Closing
from matchset.media.exact_reader import InterruptedReadingError, KeptPictures
from matchset.media.frame_list import FrameList


class Screen(Protocol):
    """Where pictures are shown; called in the player's thread."""

    def show(self, frame: Frame, place: int, sequence: int) -> None:
        """Show a frame at this place, under a number of its own."""
        ...

    def is_old(self, place: int) -> bool:
        """Whether something else is known of the frame that is shown."""
        ...

    def fail(self, words: str) -> None:
        """Show in words what is wrong."""
        ...

    def reach(self, place: int) -> int | None:
        """Return the last place up to which it may play on from this one; None: to the end."""
        ...

    @property
    def busy_tracking(self) -> bool:
        """Whether the computer has other work that must not wait for pictures."""
        ...


class ClickedPictures(Protocol):
    """Where the pictures are seen in which somebody clicks."""

    def place_of(self, sequence: int) -> int:
        """Return the place of the frame that a picture with this number showed; ValueError if there was none."""
        ...

    def frame_of(self, sequence: int) -> Frame | None:
        """Return that frame, where it is there without reading."""
        ...


class PlayerParameters(msgspec.Struct, frozen=True, kw_only=True):
    """How a file is played.

    Parameters
    ----------
    most_shown : float
        Pictures per second at most; above, every second or third frame is shown. Chosen by hand: what screens show.
    late : float
        How late a picture may be before the player goes on from there, slower than real time, s. Chosen by hand.
    look : float
        How often a picture that stands is looked at whether more is known of it, s. Chosen by hand.
    remembered : int
        Pictures whose numbers are remembered, so that a click means the one that was seen. Chosen by hand: 10 s.
    kept : int
        Of these the last ones that are there at once: a click in one is answered without reading the file. Chosen by
        hand: a quarter of a second.
    most_shared : float
        Pictures per second at most while something is tracked. More: smoother, and the tracking takes longer. Chosen
        by hand: a ball is still followed by eye.
    first_look : float
        How long the picture that was clicked stays with what was found in it before the video plays on, s. Chosen by
        hand: what a person needs to see it.
    """

    most_shown: float = 60.0
    late: float = 0.25
    look: float = 0.1
    remembered: int = 600
    kept: int = 16
    most_shared: float = 15.0
    first_look: float = 0.5


class Player(Closing):
    """Shows one frame at a time, in a thread of its own. Its methods are for any thread and do not wait.

    Parameters
    ----------
    pictures : KeptPictures
        For the thread of the player alone.
    frames : FrameList
        May grow meanwhile.
    screen : Screen
    parameters : PlayerParameters, optional

    Attributes
    ----------
    place : int
        Of the frame that is shown.
    playing : bool
    speed : float
        Multiple of the real rate.
    touched : bool
        Whether somebody has played, stepped or gone to a frame.
    waiting : bool
        Whether it would play on, but what comes next is not tracked yet.
    stretch : int
        Another number whenever a frame is shown that does not follow the one before: somebody has gone there.
    """

    def __init__(
        self,
        pictures: KeptPictures,
        frames: FrameList,
        screen: Screen,
        parameters: PlayerParameters | None = None,
    ) -> None:
        self._pictures, self._frames, self._screen = pictures, frames, screen
        self._parameters = parameters or PlayerParameters()
        self.place, self.playing, self.speed, self.touched = 0, False, 1.0, False
        self.waiting, self.stretch = False, 0
        self._halted: bool | None = None
        self._wanted: int | None = 0
        self._begun = (0.0, 0.0)
        self._sequence = 0
        self._places: OrderedDict[int, int] = OrderedDict()
        self._kept: OrderedDict[int, Frame] = OrderedDict()
        self._changed, self._stop = threading.Condition(), False
        self._thread = threading.Thread(target=self._run, name="matchset player", daemon=True)

    def start(self) -> None:
        """Begin to show."""
        self._thread.start()

    def play(self) -> None:
        """Play on; at the end, from the beginning."""
        with self._changed:
            if self._frames.complete and self._next_place() >= len(self._frames) - 1:
                self._wanted = 0
            self._set_playing(True)

    def pause(self) -> None:
        """Stop at the picture that is shown."""
        with self._changed:
            self._set_playing(False)

    def step(self, frames: int) -> None:
        """Stop, and go on by a number of frames, back if it is negative; not beyond the ends."""
        with self._changed:
            last = max(len(self._frames) - 1, 0)
            self._wanted = min(max(self._next_place() + frames, 0), last)
            self._set_playing(False)

    def seek(self, index: int) -> None:
        """Show the frame with this index, or the next one that decodes; playing goes on from there."""
        with self._changed:
            self._wanted = self._frames.with_index(index)
            self._set_playing(self.playing)

    def set_speed(self, factor: float) -> None:
        """Play faster or slower from here on."""
        with self._changed:
            self.speed = factor
            self._set_playing(self.playing)

    def place_of(self, sequence: int) -> int:
        """Return the place of the frame that a picture with this number showed.

        Raises
        ------
        ValueError
            If there was none, or it is too long ago.
        """
        place = self._places.get(sequence)
        if place is None:
            raise ValueError(f"picture {sequence} is not remembered any more: click again")
        return place

    def frame_of(self, sequence: int) -> Frame | None:
        """Return the frame that a picture with this number showed, if it is one of the last; else None."""
        return self._kept.get(sequence)

    def halt(self, sequence: int) -> None:
        """Stand at the picture of this number until `go_on`: somebody has clicked in it.

        Raises
        ------
        ValueError
            If there was none, or it is too long ago.
        """
        place = self.place_of(sequence)
        with self._changed:
            if self.playing:
                self._wanted = place
            if self._halted is None and (self.playing or not self.touched):
                self._halted = self.playing
            self.playing = self.waiting = False
            self._changed.notify()

    def go_on(self, found: bool) -> None:
        """Play on where it stood for a click; a video that nobody has moved yet plays if something was found.

        What was found in the picture of the click is shown there first.
        """
        with self._changed:
            halted, self._halted = self._halted, None
            if halted is None or not (halted or found):
                return
            self._wanted = self._next_place()
            self._set_playing(True)
            now, begin = self._begun
            self._begun = now + self._parameters.first_look, begin

    def close(self) -> None:
        """End the thread."""
        with self._changed:
            self._stop = True
            self._changed.notify()
        if self._thread.is_alive():
            self._thread.join()

    def _next_place(self) -> int:
        return self.place if self._wanted is None else self._wanted

    def _set_playing(self, playing: bool) -> None:
        self.playing, self.touched, self._halted, self.waiting = playing, True, None, False
        self._begin_here()
        self._changed.notify()

    def _begin_here(self) -> None:
        """Note that the frame that is shown next is due now."""
        place = self._next_place()
        if place < len(self._frames):
            self._begun = time.monotonic(), self._frames[place].time

    def _run(self) -> None:
        while True:
            with self._changed:
                place = self._due()
                while place is None and not self._stop:
                    self._changed.wait(self._wait())
                    place = self._due()
                if self._stop:
                    return
                assert place is not None
                self.stretch += self._wanted is not None and not 0 <= place - self.place <= 1
                self._wanted = None
                self.place = place
            self._show(place)

    def _show(self, place: int) -> None:
        try:
            frame = self._pictures.frame(place)
        except InterruptedReadingError:  # the program ends
            return
        except (ValueError, OSError) as error:
            self.playing = False
            self._screen.fail(str(error))
            return
        self._sequence += 1
        self._places[self._sequence] = place
        self._kept[self._sequence] = frame
        while len(self._places) > self._parameters.remembered:
            self._places.popitem(last=False)
        while len(self._kept) > self._parameters.kept:
            self._kept.popitem(last=False)
        self._screen.show(frame, place, self._sequence)

    def _due(self) -> int | None:
        """Place of the frame to be shown now; None if that of the last one is to stay."""
        if not len(self._frames):
            return None
        if self._wanted is not None:
            return self._wanted
        if self.playing and self._due_in() <= 0.0:
            return self._following()
        if self.playing and not self.waiting:
            return None
        return self.place if self._screen.is_old(self.place) else None

    def _following(self) -> int:
        """Place of the frame after this one, at the present speed, as far as it may play."""
        end, reach = len(self._frames) - 1, self._screen.reach(self.place)
        most = self._parameters.most_shared if self._screen.busy_tracking else self._parameters.most_shown
        second = self._frames.at_time(self._frames[self.place].time + self.speed / most)
        following = min(max(self.place + 1, second), end)
        return following if reach is None else max(min(following, reach), self.place)

    def _due_in(self) -> float:
        """Time until the next frame is due, s; at the end of the file the player stops."""
        following = self._following()
        self.waiting = following == self.place and following < len(self._frames) - 1
        if following == self.place:
            if self._frames.complete and not self.waiting:
                self.playing = False
            else:  # the reading, or the tracking, has not come farther yet
                self._begin_here()
            return self._parameters.look
        wall, begin = self._begun
        left = wall + (self._frames[following].time - begin) / self.speed - time.monotonic()
        if left < -self._parameters.late:
            self._begun = time.monotonic(), self._frames[following].time
        return left

    def _wait(self) -> float:
        look = self._parameters.look
        return max(min(self._due_in(), look), 0.001) if self.playing and len(self._frames) else look
