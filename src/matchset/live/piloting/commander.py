"""Which page commands a flight, and what its silence does: `Commander`, a pure state machine.

A page that armed says ten times a second that it is in view, and which picture it has painted. Its silence holds
everyone, then brings them down; a page that comes back never arms again by itself. Any page may stop the motors.
"""

import math
from typing import Literal

import msgspec

from matchset.numeric.arguments import require_positive

Duty = Literal["idle", "flying", "holding", "descending", "stopped"]
"""idle: nobody armed; holding: the page is silent; descending ends in stopped only, and that by `Commander.again`."""

FLYING: tuple[Duty, ...] = ("flying", "holding")
IN_FLIGHT: tuple[Duty, ...] = (*FLYING, "descending")


class SilenceParameters(msgspec.Struct, frozen=True, kw_only=True):
    """How long a page may be silent.

    Parameters
    ----------
    hold : float
        After so long everyone holds his place, and nobody else takes off, s. A browser in view was heard every 221 ms
        at worst on a busy computer, so less holds by mistake. Chosen by: the project's safety rules.
    descend : float
        After so long the descent begins, and is final, s. More gives time to come back, and lets vehicles fly on of
        which nobody knows. Chosen by: the same.
    blind : float
        A page is silent, whatever it says, if the picture that it painted last is older than this, s: nobody sees the
        vehicles there. Less is cautious; pictures were 0.154 s old on a link of 8 Mbit/s. Chosen by: when the page
        itself says that there is no new picture.
    """

    hold: float = 0.3
    descend: float = 1.0
    blind: float = 0.5

    def __post_init__(self) -> None:
        if not 0.0 < self.hold < self.descend:
            raise ValueError(f"0 < hold < descend is needed, got {self.hold} and {self.descend}")
        require_positive(self, ("blind",))


class Commander(msgspec.Struct, frozen=True, kw_only=True):
    """Who commands, and what the vehicles are to do.

    Parameters
    ----------
    duty : Duty
    page : str
        Which page commands; empty: none.
    heard : float
        When it was heard last, s.
    reason : str
        Why they come down, or have stopped, in words.
    silence : SilenceParameters
    """

    duty: Duty = "idle"
    page: str = ""
    heard: float = -math.inf
    reason: str = ""
    silence: SilenceParameters = SilenceParameters()

    def arm(self, page: str, now: float) -> "Commander":
        """Let a page arm and command, if nobody flies and all is ready; otherwise nothing changes."""
        if self.duty != "idle" or not page or not math.isfinite(now):
            return self
        return msgspec.structs.replace(self, duty="flying", page=page, heard=now, reason="")

    def alive(self, page: str, now: float, painted: float) -> "Commander":
        """Hear a page.

        Only the one that commands counts, and only while it sees pictures of now; no descent ends by it.

        Parameters
        ----------
        page : str
        now : float
            s
        painted : float
            When the picture came that it painted last, s.
        """
        here = self.at(now)
        if page != here.page or here.duty not in FLYING or not 0.0 <= now - painted <= here.silence.blind:
            return here
        return msgspec.structs.replace(here, duty="flying", heard=now)

    def land(self, page: str) -> "Commander":
        """Let the page that commands end the flight."""
        return self.end(f"{page} ended the flight") if page and page == self.page else self

    def end(self, reason: str) -> "Commander":
        """Begin the descent."""
        return msgspec.structs.replace(self, duty="descending", reason=reason) if self.duty in FLYING else self

    def kill(self, reason: str) -> "Commander":
        """Stop the motors; any page may."""
        if self.duty == "stopped":
            return self
        return msgspec.structs.replace(self, duty="stopped", page="", reason=reason)

    def down(self, reason: str) -> "Commander":
        """Note that all motors have stopped; the reason counts if none is known."""
        return self.kill(self.reason or reason) if self.duty in IN_FLIGHT else self

    def again(self) -> "Commander":
        """Make ready for another flight, when a person has put everybody back; nobody is armed by it."""
        return msgspec.structs.replace(self, duty="idle", page="", reason="") if self.duty == "stopped" else self

    def at(self, now: float) -> "Commander":
        """Return what holds at a time, s: silence holds, then descends."""
        if self.duty not in FLYING:
            return self
        silent = now - self.heard
        if not 0.0 <= silent < self.silence.descend:  # a time that is no number, or runs backward, is silence
            return self.end(f"{self.page} was silent for {self.silence.descend:g} s")
        return msgspec.structs.replace(self, duty="holding" if silent >= self.silence.hold else "flying")
