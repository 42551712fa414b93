"""What is followed in each video of a batch: one color for all, one of its folder, clicks, or what is likeliest."""

import functools
import shlex
from collections.abc import Iterable
from pathlib import Path

import msgspec

from matchset.app.exit_codes import print_note
from matchset.app.target.target_options import check_target_options, parse_pick
from matchset.batch.jobs.clicks import ClickTable
from matchset.batch.jobs.video_options import Options, absolute, options_for
from matchset.batch.options import BatchOptions
from matchset.image.color import ColorModel


class TargetChoice:
    """Tells what is followed in a video: its clicks, if there are any, else what the options say for all.

    Parameters
    ----------
    options : BatchOptions
    more : Path or None
        A table of further clicks, those of the page.

    Raises
    ------
    ValueError
        If nothing, or more than one way, says what to follow.
    """

    def __init__(self, options: BatchOptions, more: Path | None = None) -> None:
        self._options, choice = options, options.choice
        target = options.target
        given = bool(target.picks or target.candidate or target.color or target.hsv or target.gray)
        ways = given + (choice.color_name is not None) + choice.auto
        if ways > 1:
            raise ValueError("give one of --color, --color-name, --auto and the other ways to say what to follow")
        if not ways and choice.clicks is None:
            raise ValueError("say what to follow: --color FILE, --color-name NAME, --clicks FILE.csv or --auto")
        if given:
            words = shlex.join(options.videos[:1])
            check_target_options(target.single, words)
            for text in target.picks or ():
                parse_pick(text)
            for path in [] if any("=" in str(path) for path in target.color or ()) else target.color or ():
                ColorModel.load(path)  # a wrong file is said before thousands of videos fail by it
        self._given, self._base = given, absolute(options_for(options, ""))
        self._page = ClickTable(more, of_page=True)
        self._clicks = ClickTable(choice.clicks if choice.clicks is not None and choice.clicks.is_file() else None)
        if choice.clicks is not None and not choice.clicks.is_file():
            raise ValueError(f"no such file: {choice.clicks}")

    def match(self, videos: Iterable[tuple[str, str]]) -> None:
        """Find which video each row of the table of clicks means; see `ClickTable.match`."""
        lines = self._clicks.match(videos)
        if lines:
            names = f"{len(lines)} names" if len(lines) > 1 else "a name"
            print_note(f"{lines[0].path}, line {lines[0].line}: {names} of no video here, {lines[0].text('video')!r}")

    def options(self, video: str, folder: str) -> tuple[Options, bool]:
        """Return what the command is told for a video, and whether what is likeliest is to be chosen.

        Raises
        ------
        ValueError
            If nothing says what to follow in it; in words.
        """
        picks = self._page.of(video, folder) or self._clicks.of(video, folder)
        if picks:
            return self._with(picks=picks, color=None, candidate=None, hsv=None), False
        choice = self._options.choice
        if choice.color_name is not None:
            return self._with(color=[color_near(Path(video).parent, choice.color_name)]), False
        if not self._given and not choice.auto:
            raise ValueError("no click says what to follow in it")
        return self._base, choice.auto

    def add(self, folder: str, pick: str) -> None:
        """Take one more click of the page, in a video by its name in the results."""
        self._page.add(folder, pick)

    def _with(self, **target: object) -> Options:
        changed = msgspec.structs.replace(self._base.target, **target)
        options: Options = msgspec.structs.replace(self._base, target=changed)
        return options


@functools.lru_cache(maxsize=1024)
def color_near(folder: Path, name: str) -> Path:
    """Return the color file of this name in a folder, or in the next one above it that has one.

    Raises
    ------
    ValueError
        If there is none.
    """
    for each in (folder, *folder.parents):
        if (each / name).is_file():
            return each / name
    raise ValueError(f"there is no {name} in {folder}, nor in a folder above it")
