"""The menu of sources (`SourcesPanel`): a page names a key that it was told or the address of a stream, no path."""

from pathlib import Path

import msgspec

from matchset.live.feed import Panel, Receiver
from matchset.live.sources.found_sources import Source, address_source
from matchset.live.sources.messages import MESSAGES, LookAgain, Show, ShowAddress
from matchset.live.sources.opening import check_source
from matchset.live.sources.source_selection import SourceSelection
from matchset.live.sources.thumbnails import Thumbnails
from matchset.live.sources.uploads import Upload, Uploads

OWN = 20  # format: addresses and files of pages that the menu still offers


class Entry(msgspec.Struct, frozen=True, omit_defaults=True):
    """A line of the menu: its key, kind and name, what else there is to say, and whether `/thumbnail.jpg` shows it."""

    key: str
    kind: str
    name: str
    words: str
    pictured: bool = False


class _Receiving:
    """A video that a page sends; it is shown when it is whole."""

    def __init__(self, upload: Upload, panel: "SourcesPanel") -> None:
        self._upload, self._panel = upload, panel

    def write(self, data: bytes) -> None:
        self._upload.write(data)

    def finish(self) -> None:
        source = self._upload.finish()
        try:
            check_source(source)
        except ValueError as error:
            raise ValueError(str(error).replace(source.origin, source.name)) from None
        self._panel.show_own(source)

    def drop(self) -> None:
        self._upload.drop()


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
    room : int
        Bytes of videos that a page may still send; 0: none are taken.
    """

    entries: list[Entry]
    shown: str = ""
    opening: str = ""
    words: str = ""
    fault: str = ""
    room: int = 0


class SourcesPanel(Panel):
    """Offers what can be shown.

    Parameters
    ----------
    stage : SourceSelection
    given : Source, optional
        What the command line names.
    uploads : Uploads, optional
        Where videos go that a page sends; None: none are taken.
    """

    name = "sources"
    messages = MESSAGES

    def __init__(self, stage: SourceSelection, given: Source | None = None, uploads: Uploads | None = None) -> None:
        self._stage, self._uploads = stage, uploads
        self._own = [] if given is None else [given]
        self._keys: dict[str, str] = {}
        self._thumbnails = Thumbnails()

    def take(self, message: Show | ShowAddress | LookAgain, page: str) -> None:
        """Show an entry or an address, or look again.

        Raises
        ------
        ValueError
            If there is no such entry any more, it is no address, or no page says it.
        """
        if isinstance(message, LookAgain):
            self._stage.look()
            return
        if isinstance(message, ShowAddress):
            if not page:
                raise ValueError("show_address: an address is taken from the page alone")
            self.show_own(address_source(message.url))
            return
        for source in self._offered():
            if self._key(source) == message.key:
                self._stage.show(source)
                return
        raise ValueError("this source is not there any more: look again")

    def show_own(self, source: Source) -> None:
        """Show what a page has brought, and offer it from now on; any thread."""
        self._stage.show(source)
        given = [each for each in self._own if each.kind == "given"]
        brought = [each for each in self._own if each.kind != "given" and each.origin != source.origin]
        self._own = [*given, source, *brought[: OWN - 1]]

    def receive(self, upload: str, name: str, length: int) -> Receiver | None:
        """Take a video that a page sends."""
        if upload != "video" or self._uploads is None:
            return None
        if words := self._stage.busy:
            raise ValueError(words)
        return _Receiving(self._uploads.begin(name, length), self)

    def thumbnail(self, key: str) -> bytes:
        """Return the first picture of an entry, a JPEG; ValueError if it has none."""
        for source in self._offered():
            if self._key(source) == key and _is_pictured(source):
                return self._thumbnails.of(source.origin)
        raise ValueError("there is no picture of it")

    def state(self) -> SourcesState:
        """Return the menu."""
        stage = self._stage
        return SourcesState(
            [Entry(self._key(each), each.kind, each.name, each.words, _is_pictured(each)) for each in self._offered()],
            "" if stage.shown is None else self._key(stage.shown),
            "" if stage.opening is None else stage.opening.name,
            stage.sources.words,
            stage.fault,
            0 if self._uploads is None else self._uploads.room,
        )

    def _offered(self) -> list[Source]:
        found = self._stage.sources.entries
        there = {each.origin for each in found}
        return [*(each for each in self._own if each.origin not in there), *found]

    def _key(self, source: Source) -> str:
        """Return the key of a source; it is never that of another one."""
        return self._keys.setdefault(source.origin, f"source-{len(self._keys) + 1}")


def _is_pictured(source: Source) -> bool:
    """Whether a source is a file, whose first picture can be read at any time."""
    return source.kind in ("file", "upload") or (source.kind == "given" and Path(source.origin).is_file())
