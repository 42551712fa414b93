"""What hands out the frames of a source as whole frames or as half-frames: `FieldReader`."""

from collections import deque
from collections.abc import Callable

from matchset.image.frame import Frame
from matchset.media.fields.half_frames import HalfFrames
from matchset.media.fields.interlace import DEFAULT, FieldEvidence, Fields

WORDS: dict[Fields, str] = {
    "frames": "not interlaced",
    "top": "interlaced, the top field first",
    "bottom": "interlaced, the bottom field first",
}
FIRST: dict[Fields, str] = {"top": "the top field", "bottom": "the bottom field"}
STILL = (
    "fields: too little moves to tell whether the pictures are interlaced: whole frames are used, or say which is first"
)
OPPOSITE: dict[Fields, Fields] = {"top": "bottom", "bottom": "top", "frames": "frames"}  # geometry: upside down


class FieldReader:
    """Hands out half-frames where pictures are interlaced, and frames where they are not.

    Parameters
    ----------
    given : str or None
        "frames"; or which field is the first, "top" or "bottom"; None: what comes is looked at.
    fps : float or None
        Frames per second of the source.
    by_arrival : callable
        Whether the time of the last frame is that of its arrival: that of its later field.
    upside_down : bool
        Whether the fields change places in the pictures as they are handed out.

    Attributes
    ----------
    left_out : int
        Half-frames of a live source that were old when they were asked for.
    notes : list of str
        What is to be said.
    """

    def __init__(
        self,
        given: Fields | None,
        fps: float | None,
        by_arrival: Callable[[], bool] = lambda: False,
        upside_down: bool = False,
    ) -> None:
        self._given, self._fps, self._by_arrival, self._upside_down = given, fps, by_arrival, upside_down
        self.left_out, self.notes = 0, list[str]()
        self._waiting: deque[Frame] = deque()
        self._halves = None if given is None or given == "frames" else HalfFrames(given, fps)
        self._evidence = None if given == "frames" else FieldEvidence()
        self._seen, self._watch = 0, FieldEvidence()

    @property
    def works(self) -> bool:
        """Whether there is anything to do with frames."""
        return self._halves is not None or self._evidence is not None

    @property
    def fields(self) -> Fields:
        """What is handed out: "frames", or which field of the stored pictures comes first."""
        return "frames" if self._halves is None else swapped(self._halves.order[0], self._upside_down)

    @property
    def warnings(self) -> list[str]:
        """What is to be said so far."""
        words = [*self.notes, STILL] if self._given is None and self._evidence is not None else [*self.notes]
        if self._halves is not None and (missing := self._halves.missing):
            words.append(f"{missing} field{'s' * (missing > 1)} missing in interlaced frames, left out")
        return words

    def stop_looking(self) -> None:
        """Hand out what is handed out now."""
        self._evidence = None

    def decide(self, verdict: Fields | None, stated: Fields | None = None, begin: int = 0) -> None:
        """Hand out from now on what the pictures were found to be.

        Parameters
        ----------
        verdict : str or None
            Which field comes first, or "frames"; None: the pictures do not tell.
        stated : str or None
            What a header says.
        begin : int
            Index of the frame from which on they are taken apart.
        """
        self._evidence = None
        if verdict is None:
            self.notes.append(STILL)
            return
        seen = swapped(verdict, self._upside_down)
        other = f"; the header says {WORDS[stated]}, the pictures count" if stated not in (None, seen) else ""
        self.notes.append(f"fields: the pictures are {WORDS[seen]}{other}")
        if verdict != "frames":
            self._halves = HalfFrames(verdict, self._fps, begin)

    def take(self, read: Callable[[], Frame | None], waits: bool = False) -> Frame | None:
        """Return the next frame or half-frame.

        Parameters
        ----------
        read : callable
            Returns the next frame of the source; None if there is none.
        waits : bool
            Whether a newer frame of a live source waits already: then only the newest field of it is handed out.
        """
        if waits:
            self.left_out += len(self._waiting)
            self._waiting.clear()
        if self._waiting:
            return self._waiting.popleft()
        if (frame := read()) is None:
            return None
        if self._evidence is not None:
            self._look(self._evidence, frame)
        if self._halves is None:
            return frame
        if self._given is None:
            self._look_again(self._halves, frame)
        self._halves.later = self._by_arrival()
        found = self._halves.of(frame)
        if waits:
            self.left_out += len(found) - 1
            found = found[-1:]
        self._waiting.extend(found[1:])
        return found[0]

    def _look_again(self, halves: HalfFrames, frame: Frame) -> None:
        """Look whether the other field has become the first, as behind a recorder that has lost one."""
        self._watch.add(frame.image)
        verdict = self._watch.verdict
        if verdict is None and self._watch.pairs < DEFAULT.most_frames:
            return
        self._watch = FieldEvidence()
        if verdict not in (None, "frames", halves.order[0]):
            halves.begin_with("top" if verdict == "top" else "bottom")
            self.notes.append(f"fields: from frame {frame.index} on {FIRST[self.fields]} comes first")

    def _look(self, evidence: FieldEvidence, frame: Frame) -> None:
        """Look whether frames are as somebody has said; or what they are, if nobody has."""
        evidence.add(frame.image)
        self._seen += 1
        verdict = evidence.verdict
        if self._given is None:
            if verdict is not None:
                self.decide(verdict, None, frame.index)
        elif verdict is not None or self._seen >= DEFAULT.most_frames:
            self._evidence = None
            if verdict not in (None, self._given):
                found, given = (WORDS[swapped(each, self._upside_down)] for each in (verdict or "frames", self._given))
                self.notes.append(f"fields: the pictures are {found}; they are read as {given}, as was asked for")


def swapped(fields: Fields, upside_down: bool) -> Fields:
    """Return which field comes first in pictures that are turned upside down, or not."""
    return OPPOSITE[fields] if upside_down else fields
