"""Which page commands a vehicle, and what its silence does: `Commander`, a pure state machine.

A page that armed says that it is in view, ten times a second. Its silence holds the vehicle, then brings it down; a
page that comes back never arms again by itself. Any page may stop the motors.
"""

import math
from typing import Literal

import msgspec

Duty = Literal["idle", "flying", "holding", "descending", "stopped"]
"""idle: nobody armed; holding: the page is silent; descending and stopped are final."""


class SilenceParameters(msgspec.Struct, frozen=True, kw_only=True):
    """How long a page may be silent.

    Parameters
    ----------
    hold : float
        After so long the vehicle holds its place, s. A browser in view was heard every 221 ms at worst on a busy
        computer, so less holds by mistake. Chosen by: the project's safety rules.
    descend : float
        After so long the descent begins, and is final, s. More gives time to come back, and lets a vehicle fly on of
        which nobody knows. Chosen by: the same.
    """

    hold: float = 0.3
    descend: float = 1.0

    def __post_init__(self) -> None:
        if not 0.0 < self.hold < self.descend:
            raise ValueError(f"0 < hold < descend is needed, got {self.hold} and {self.descend}")


class Commander(msgspec.Struct, frozen=True, kw_only=True):
    """Who commands, and what the vehicle is to do.

    Parameters
    ----------
    duty : Duty
    page : str
        The session that commands; empty: none.
    heard : float
        When it was heard last, s.
    silence : SilenceParameters
    """

    duty: Duty = "idle"
    page: str = ""
    heard: float = -math.inf
    silence: SilenceParameters = SilenceParameters()

    def arm(self, page: str, now: float) -> "Commander":
        """Let a page arm and command, if nobody flies; otherwise nothing changes."""
        if self.duty in ("flying", "holding", "descending") or not page or not math.isfinite(now):
            return self
        return msgspec.structs.replace(self, duty="flying", page=page, heard=now)

    def alive(self, page: str, now: float) -> "Commander":
        """Hear a page; only that of the one that commands counts, and no descent ends by it."""
        here = self.at(now)
        if page != here.page or here.duty not in ("flying", "holding"):
            return here
        return msgspec.structs.replace(here, duty="flying", heard=now)

    def land(self, page: str) -> "Commander":
        """Let the page that commands end the flight."""
        if page != self.page or self.duty not in ("flying", "holding"):
            return self
        return msgspec.structs.replace(self, duty="descending")

    def kill(self) -> "Commander":
        """Stop the motors; any page may."""
        return msgspec.structs.replace(self, duty="stopped", page="")

    def at(self, now: float) -> "Commander":
        """Return what holds at a time, s: silence holds, then descends."""
        if self.duty not in ("flying", "holding"):
            return self
        silent = now - self.heard
        if not 0.0 <= silent < self.silence.descend:  # a time that is no number, or runs backward, is silence
            return msgspec.structs.replace(self, duty="descending")
        return msgspec.structs.replace(self, duty="holding" if silent >= self.silence.hold else "flying")
