"""What is known of one partner: `Partner` takes its messages, of which the newest counts, and says once what is odd."""

import math

import msgspec

from matchset.sharing.clock_offset import ClockOffset, Exchange, ExchangeParameters, Offset
from matchset.sharing.messages import ClockMessage, TargetsMessage
from matchset.sharing.shared_target import Age, AgeParameters, SharedTarget, shared_target

MOST_RUNS = 32  # format: runs of one partner that are remembered


class PartnerParameters(msgspec.Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """When a partner is told as silent, and its clock as wrong.

    Parameters
    ----------
    silence : float
        Time without a message until it is told, s. Less tells of every gap of a bad network. Chosen by hand.
    wrong_clock : float
        Difference of the times of day from which on it is told, s. It changes no result: ages are measured. Chosen by
        hand: what files of two computers are put together with.
    """

    silence: float = 1.0
    wrong_clock: float = 1.0


class PartnerState(msgspec.Struct, frozen=True, kw_only=True):
    """How it stands with one partner.

    Parameters
    ----------
    name : str
    here : bool
        Whether its program runs and can be reached.
    silent : bool
        Whether nothing came from it for `PartnerParameters.silence`.
    age : Age or None
        Of its newest picture; None if there is none, or its clock is not known.
    offset : Offset or None
        This computer's clock minus its clock.
    received, missed : int
        Messages of its present run that came, and that did not.
    """

    name: str
    here: bool
    silent: bool
    age: Age | None
    offset: Offset | None
    received: int
    missed: int

    @property
    def summary(self) -> str:
        """All of it, in a line."""
        there = "gone" if not self.here else "silent" if self.silent else "here"
        clock = "its clock is not known"
        if self.offset is not None:
            clock = f"its clock is known to ±{1e3 * self.offset.uncertainty:.2g} ms"
        return f"{self.name}: {there}, {self.received} messages, {self.missed} missed, {clock}"


class Partner:
    """Keeps what one partner has sent. Nothing here waits, reads a clock or knows of the network.

    Parameters
    ----------
    name : str
    own : tuple of (str, int)
        Name and run of this computer: whose clock partners tell.
    clock : ExchangeParameters
    parameters : PartnerParameters
    """

    def __init__(
        self, name: str, own: tuple[str, int], clock: ExchangeParameters, parameters: PartnerParameters
    ) -> None:
        self.name, self.here = name, False
        self._own, self._clock_parameters, self._parameters = own, clock, parameters
        self.run: int | None = None
        self.offset, self._measured = ClockOffset(clock), False
        self._message: TargetsMessage | None = None
        self._last, self._silent, self._left = -math.inf, False, False
        self._received = self._missed = 0
        self._ended: list[int] = []
        self._said: set[str] = set()

    def once(self, kind: str, line: str) -> list[str]:
        """Return a line that begins with the partner's name; nothing if one of this kind was said before."""
        if kind in self._said:
            return []
        self._said.add(kind)
        return [f"{self.name}: {line}"]

    @property
    def count(self) -> int:
        """How many targets are kept."""
        return 0 if self._message is None else len(self._message.targets)

    def take(self, message: TargetsMessage, now: float, count: int = 1) -> list[str]:
        """Take a message that came now, s, the newest of so many since the last one; returns what is to be said.

        One that was overtaken by a newer one is left out, and one of a run that has ended.
        """
        if message.name != self.name:
            return self.once("name", f"sends messages that say they are of {message.name!r}: refused")
        if message.run in self._ended:
            return self.once("two", "two computers share under this name: the one that began last counts")
        lines = self._begin(message.run)
        if self._message is not None and message.number <= self._message.number:
            return lines
        last = -1 if self._message is None else self._message.number
        self._missed += max(message.number - last - count, 0)
        if self._message is None:
            self._missed = 0  # what was sent before this computer was here
        self._received, self._message = self._received + count, message
        if self._silent:
            lines.append(f"{self.name}: back after {now - self._last:.1f} s")
        self._last, self._silent, self._left = now, False, False
        for each in message.offsets:
            known = self.offset.at(now)
            if (each.partner, each.run) == self._own and (known is None or each.uncertainty < known.uncertainty):
                told = Offset(-each.offset, each.uncertainty)
                if not (self._measured and self.offset.contradicts(told, now)):  # what was measured here counts
                    self.offset.add_offset(told, now)
        return lines

    def compare(self, asked: float, message: ClockMessage, returned: float, wall: float) -> list[str]:
        """Take an answer to who asks for the time, which is `wall` here; returns what is to be said."""
        if message.name != self.name or message.run in self._ended:
            return []
        lines = self._begin(message.run)
        if self.offset.add(Exchange(asked, message.received, message.answered, returned)):
            lines.append(f"{self.name}: its clock has jumped: it is measured anew")
            if self._message is not None:  # its times are of the clock before; older ones are still overtaken
                self._message = msgspec.structs.replace(self._message, targets=[])
        self._measured = True
        ahead = message.wall - wall
        if abs(ahead) > self._parameters.wrong_clock:
            words = f"{abs(ahead):.0f} s {'ahead of' if ahead > 0.0 else 'behind'} this one"
            lines += self.once("clock", f"its time of day is {words}: ages are measured, they are right")
        return lines

    def look(self, now: float) -> list[str]:
        """Say if it has become silent, once each time."""
        silent = self._message is not None and self.here and now - self._last > self._parameters.silence
        if not silent or self._silent:
            return []
        self._silent = True
        return [f"{self.name}: silent for {now - self._last:.1f} s"]

    def come(self) -> list[str]:
        """Its program has appeared."""
        was, self.here = self.here, True
        return [] if was else [f"{self.name}: here"]

    def leave(self) -> list[str]:
        """Its program has ended, or cannot be reached any more."""
        was, self.here, self._silent, self._left = self.here, False, False, True
        return [f"{self.name}: gone"] if was else []

    def forget(self) -> None:
        """Forget its targets."""
        self._message = None

    def woken(self, run: int) -> None:
        """Forget how the clocks stand: this computer has slept, and is another run now."""
        self._own = self._own[0], run
        self.offset, self._measured = ClockOffset(self._clock_parameters), False

    def targets(self, now: float, parameters: AgeParameters, ahead: float = 0.0) -> list[SharedTarget]:
        """Return its targets as they are known now, s, when this clock is so far ahead of that of pictures, s."""
        message = self._message
        if message is None:
            return []
        offset = self.offset.at(now)
        targets = message.targets
        if not self.here or self._left:  # it may be back, what it sent before is not
            targets = [msgspec.structs.replace(each, lost=each.lost or "its program is gone") for each in targets]
        return [shared_target(self.name, each, offset, now, parameters, ahead) for each in targets]

    def state(self, now: float) -> PartnerState:
        """Return how it stands now, s."""
        offset, age = self.offset.at(now), None
        if offset is not None and self._message is not None:
            newest = max((each.captured for each in self._message.targets), default=self._message.sent)
            age = Age(now - (newest + offset.seconds), offset.uncertainty)
        return PartnerState(
            name=self.name,
            here=self.here,
            silent=self._silent,
            age=age,
            offset=offset,
            received=self._received,
            missed=self._missed,
        )

    def _begin(self, run: int) -> list[str]:
        """Begin anew if this is another run."""
        if run == self.run:
            return []
        again = self.run is not None
        if self.run is not None:
            self._ended = [*self._ended[-MOST_RUNS + 1 :], self.run]
        self.run, self._message, self._received, self._missed = run, None, 0, 0
        self.offset, self._measured = ClockOffset(self._clock_parameters), False
        return [f"{self.name}: began anew"] if again else []
