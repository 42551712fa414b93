"""Pictures that waited while a stream was opened: older than their arrival says, and so not of now (`Backlog`)."""

import msgspec


class BacklogParameters(msgspec.Struct, frozen=True):
    """Which pictures of a stream that was just opened have waited.

    Parameters
    ----------
    least_s : float
        Opening that takes less than this leaves nothing behind that matters, s.
    share : float
        A picture that had to be waited for, for this share of the time between two pictures, is one of now. Less takes
        one that waited for a picture of now where to unpack it takes that long; more leaves out pictures of now where
        they come faster than the stream says.
    rate : float
        Pictures a second of a stream that does not say.
    """

    least_s: float = 0.1
    share: float = 0.5
    rate: float = 30.0


class Backlog:
    """Tells pictures that waited from those of now, by whether the reader had to wait for them.

    FFmpeg reads some twenty pictures before a stream counts as opened, and hands them out afterward, all at once: the
    first one is as old as the opening took.

    Parameters
    ----------
    parameters : BacklogParameters, optional
    """

    def __init__(self, parameters: BacklogParameters | None = None) -> None:
        self._parameters, self._end, self._is_first = parameters or BacklogParameters(), 0.0, False

    def begin(self, now: float, opening: float) -> None:
        """Begin after an opening that took so long, s; at the latest after the same time again there is none left."""
        self._end, self._is_first = now + opening if opening >= self._parameters.least_s else 0.0, True

    def holds(self, now: float, waited: float, rate: float | None) -> bool:
        """Whether a picture has waited.

        Parameters
        ----------
        now : float
            When it came, s.
        waited : float
            How long the reader waited for it, s.
        rate : float or None
            Pictures a second, as far as known.
        """
        # The first one takes long in any case: the decoder begins with it.
        came_at_once = self._is_first or waited < self._parameters.share / (rate or self._parameters.rate)
        self._is_first = False
        if now < self._end and came_at_once:
            return True
        self._end = 0.0
        return False
