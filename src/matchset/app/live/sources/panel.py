"""The menu of sources (`SourcesPanel`): a page names a key that it was told, never a path."""

import msgspec

from matchset.app.live.feed import Panel
from matchset.app.live.sources.found_sources import Source
from matchset.app.live.sources.messages import MESSAGES, LookAgain, Show
from matchset.app.live.sources.stage import Stage


class Entry(msgspec.Struct, frozen=True):
    """A line of the menu: its key, its kind, its name, and what else there is to say."""

    key: str
    kind: str
    name: str
    words: str


class SourcesState(msgspec.Struct, frozen=True, omit_defaults=True):
    """The menu.

    Parameters
    ----------
    entries : list of Entry
    shown : str
        Key of what is shown; empty: nothing.
    opening : str
        Name of what is being opened.
    words : str
        What was not found.
    fault : str
        Why what was chosen cannot be shown.
    """

    entries: list[Entry]
    shown: str = ""
    opening: str = ""
    words: str = ""
    fault: str = ""


class SourcesPanel(Panel):
    """Offers what can be shown.

    Parameters
    ----------
    stage : Stage
    given : Source, optional
        What the command line names.
    """

    name = "sources"
    messages = MESSAGES

    def __init__(self, stage: Stage, given: Source | None = None) -> None:
        self._stage, self._given = stage, given
        self._keys: dict[str, str] = {}

    def take(self, message: Show | LookAgain, page: str) -> None:  # noqa: ARG002
        """Show an entry, or look again.

        Raises
        ------
        ValueError
            If there is no such entry any more.
        """
        if isinstance(message, LookAgain):
            self._stage.look()
            return
        for source in self._offered():
            if self._key(source) == message.key:
                self._stage.show(source)
                return
        raise ValueError("this source is not there any more: look again")

    def state(self) -> SourcesState:
        """Return the menu."""
        stage = self._stage
        return SourcesState(
            [Entry(self._key(each), each.kind, each.name, each.words) for each in self._offered()],
            "" if stage.shown is None else self._key(stage.shown),
            "" if stage.opening is None else stage.opening.name,
            stage.sources.words,
            stage.fault,
        )

    def _offered(self) -> list[Source]:
        found = self._stage.sources.entries
        if self._given is None or any(each.origin == self._given.origin for each in found):
            return found
        return [self._given, *found]

    def _key(self, source: Source) -> str:
        """Return the key of a source; it is never that of another one."""
        return self._keys.setdefault(source.origin, f"source-{len(self._keys) + 1}")
