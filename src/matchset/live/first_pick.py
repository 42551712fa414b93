"""`--pick X,Y`: a click in the first picture, as soon as one can be answered (`FirstPick`)."""

import sys
import threading
from collections.abc import Callable

from matchset.live.session import Session
from matchset.live.targets.messages import Pick
from matchset.live.targets.target import check_inside
from matchset.media.closing import Closing

LOOK = 0.02  # format: s between two looks whether there is a picture


class FirstPick(Closing):
    """Waits in a thread for the first picture of the first stream and for the compiler, then clicks.

    Parameters
    ----------
    session : Session
    point : tuple of two floats
        px
    refusal : callable
        Returns why a click cannot be answered yet; empty if it can.
    """

    def __init__(self, session: Session, point: tuple[float, float], refusal: Callable[[], str]) -> None:
        self._session, self._point, self._refusal = session, point, refusal
        self._stop = threading.Event()
        self._thread = threading.Thread(target=self._run, name="matchset pick", daemon=True)
        self._thread.start()

    def close(self) -> None:
        """End the thread."""
        self._stop.set()
        self._thread.join()

    def _run(self) -> None:
        while not self._stop.wait(LOOK):
            streams = self._session.streams
            seen = streams[0].seen if streams else None
            if seen is None or seen.frame is None or self._refusal():
                continue
            try:
                self._click(seen.state.sequence, *seen.frame.image.shape[1::-1])
            except ValueError as error:
                self._session.note(f"--pick: {error}")
                print(f"note: --pick: {error}", file=sys.stderr)
            return

    def _click(self, sequence: int, width: int, height: int) -> None:
        check_inside(*self._point, width, height)
        self._session.take(Pick(sequence, *self._point), "")
