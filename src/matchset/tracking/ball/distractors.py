"""What was seen beside the target while that was seen, and is not the target when it is hidden: `Distractors`.

A mark of the target's color, a second ball or a lamp may look just as the target does. That it was there while the
target was elsewhere tells them apart. They are found by the network of discs like a lost target, in part after part of
the picture, and followed by it wherever it is led to one of them, so that a camera that moves takes them along.
"""

import msgspec

from matchset.tracking.motion import Gate


class OthersParameters(msgspec.Struct, frozen=True):
    """How others are noticed and told from the target; chosen by hand.

    Parameters
    ----------
    period : int
        Frames after which a part of the picture is looked at for others while the target is seen.
    looks : int
        Looks of the network that this may cost: more finds others sooner and takes longer.
    least : float
        Log-odds of a ball of the target's color from which something is another: less than a lost target needs, since
        in another picture it may look better.
    same : float
        Distance of two discs, in the larger's half-widths, within which they are the same.
    growth : float
        Factor of size by which the same disc may differ.
    clear : float
        Distance from the target, in the larger's half-widths, from which a disc is another, and not the target or a
        part of it.
    kept_s : float
        For how long another is remembered that was not seen again, s.
    most : int
        How many are remembered.
    """

    period: int = 10
    looks: int = 4
    least: float = 0.5
    same: float = 0.8
    growth: float = 1.6
    clear: float = 1.5
    kept_s: float = 10.0
    most: int = 16


class Distractors:
    """Remembers what is not the target.

    Parameters
    ----------
    limits : OthersParameters
    """

    def __init__(self, limits: OthersParameters) -> None:
        self.limits = limits
        self.forget()

    def forget(self) -> None:
        """Know none."""
        self._known: list[tuple[float, Gate]] = []

    def places(self, target: Gate) -> list[Gate]:
        """Places of the others that are clear of the target, those not seen for longest first."""
        return [each for _, each in sorted(self._known, key=lambda known: known[0]) if self.is_clear(each, target)]

    def notice(self, disc: Gate, target: Gate, time: float) -> None:
        """Remember a disc of the target's look that is clear of the target.

        Parameters
        ----------
        disc : Gate
        target : Gate
            Where the target is in the same picture.
        time : float
            Of the picture, s.
        """
        if self.is_clear(disc, target):
            self._known = [known for known in self._known if not self._is_same(known[1], disc)]
            self._known = [*self._known, (time, disc)][-self.limits.most :]

    def is_one(self, disc: Gate, time: float) -> bool:
        """Say whether a disc is one of the others, and follow that one there.

        Parameters
        ----------
        disc : Gate
        time : float
            Of the picture, s.
        """
        self._known = [known for known in self._known if time - known[0] <= self.limits.kept_s]
        for index, (_, known) in enumerate(self._known):
            if self._is_same(known, disc):
                self._known[index] = time, disc
                return True
        return False

    def _is_same(self, first: Gate, second: Gate) -> bool:
        larger, smaller = max(first.half_width, second.half_width), min(first.half_width, second.half_width)
        return first.distance(second) < self.limits.same * larger and larger < self.limits.growth * smaller

    def is_clear(self, disc: Gate, target: Gate) -> bool:
        """Say whether a disc is clear of the target."""
        return disc.distance(target) > self.limits.clear * max(disc.half_width, target.half_width)
