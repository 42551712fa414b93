"""What files, folders of pictures and bags have in common: `Recorded`."""

import abc

from matchset.image.frame import Frame


class Recorded(abc.ABC):
    """A recording whose first frame is decoded when it is opened."""

    live = False
    dropped = 0
    _first: Frame | None

    @abc.abstractmethod
    def _decode(self) -> Frame | None:
        """Decode the next frame; None at the end."""

    def read(self) -> Frame | None:
        """Next frame that decodes, or None at the end."""
        if self._first is not None:
            frame, self._first = self._first, None
            return frame
        return self._decode()
