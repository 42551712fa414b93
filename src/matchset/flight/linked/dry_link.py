"""A link that sends no throttle, whatever it is told: `DryLink`, for a dry run."""

import msgspec

from matchset.control.command import Command
from matchset.links.link import Link, LinkStatus


class DryLink(Link):
    """A link of a dry run; implements `matchset.links.link.Link`.

    It hands on zero commands alone, and the link behind it is never armed. To the pilot it looks armed, which thus goes
    through all that it would do; `SafetyState.command` of a step is what would have been sent.

    Parameters
    ----------
    link : Link
        The real one; belongs to it from here on.

    Attributes
    ----------
    uri : str
    """

    def __init__(self, link: Link) -> None:
        self.uri, self._link = link.uri, link

    def arm(self) -> None:
        """Do nothing."""

    def send(self, command: Command) -> Command:  # noqa: ARG002 - that is what a dry run is
        """Send zero; returns what the vehicle receives, which is zero."""
        return self._link.send(Command())

    def status(self) -> LinkStatus:
        """Return the status of the real link, as if it were armed."""
        return msgspec.structs.replace(self._link.status(), state="armed", reason="")

    def land(self, duration: float = 1.5) -> None:
        """Do nothing."""

    def cut(self) -> None:
        """Stop the motors of the real link, which never turned."""
        self._link.cut()

    def close(self) -> None:
        """Close the real link."""
        self._link.close()
