"""What to type next where nothing was found: `next_command`, tried before it is printed."""

import shlex
from collections.abc import Mapping
from typing import Any

import msgspec

from matchset.app.cli_options import AS_IT_IS, ViewOptions, source_words
from matchset.app.guidance.as_typed import program
from matchset.app.guidance.choice import choose
from matchset.image.color import ColorModel
from matchset.image.frame import Frame
from matchset.media.video import Video
from matchset.shapes.circle import Circle
from matchset.tracking.tracker import Tracker


class FailedRun(msgspec.Struct, frozen=True):
    """The command that has found nothing.

    Parameters
    ----------
    command : str
        "track", "locate", or "learn".
    source : str
    topic : str or None
        Of a bag.
    family : type
        The family of shapes that was looked for.
    clicked : str
        Its click, "X,Y@FRAME"; empty without one.
    kept : tuple of str
        Its other options that the next command is to have, too: ``--fov 61``.
    live : bool
        Whether the source is a camera or a stream.
    view : ViewOptions
        How its pictures are used.
    """

    command: str
    source: str
    topic: str | None = None
    family: type[Any] = Circle
    clicked: str = ""
    kept: tuple[str, ...] = ()
    live: bool = False
    view: ViewOptions = AS_IT_IS

    @property
    def words(self) -> tuple[str, ...]:
        """How the source was named."""
        return source_words(self.source, self.topic, self.view)


def kept_options(options: Any, names: Mapping[str, str]) -> tuple[str, ...]:
    """Return the words of options that are not at their defaults.

    Parameters
    ----------
    options : msgspec.Struct
        As typed.
    names : mapping of str to str
        From the field of an option to its name: ``{"fov": "--fov"}``. A flag has True as its value, an option that may
        be given several times a list.
    """
    words: list[str] = []
    defaults = {field.name: field.default for field in msgspec.structs.fields(options)}
    for field, name in names.items():
        value = getattr(options, field)
        if value is None or value == defaults[field]:
            continue
        if value is True:
            words.append(name)
            continue
        for each in value if isinstance(value, list) else [value]:
            words += [name, str(each)]
    return tuple(words)


def shell_command(*words: str) -> str:
    """Return a command of matchset, quoted for a shell."""
    return f"{program()} {shlex.join(words)}"


def next_command(run: FailedRun, lost: Frame | None) -> tuple[str, str]:
    """Choose what to type after a run that has found nothing.

    A click that is followed in its own frame is proposed where there is one; otherwise the grid of `learn`.

    Parameters
    ----------
    run : FailedRun
        The run.
    lost : Frame or None
        A frame in which nothing was found.

    Returns
    -------
    str
        What it will do, in words.
    str
        The command, quoted for a shell.
    """
    if run.live:
        return "Show the camera the ball and learn its color", shell_command("learn", *run.words)
    where = () if lost is None else ("--frame", str(lost.index))
    if run.family is not Circle:
        return "Read a pixel on it from a grid", shell_command("learn", *run.words, *where)
    with Video(run.source, topic=run.topic, **run.view.arguments) as video:
        choice = choose(video)
    index = choice.frame.index
    if choice.candidates and _is_followed(choice.frame, choice.candidates[0].pick):
        x, y = choice.candidates[0].pick
        words = f"What looks most like a ball is at ({x}, {y}) in frame {index}, and a click there is followed"
        command = "track" if run.command == "learn" else run.command
        again = shell_command(command, *run.words, "--pick", f"{x},{y}@{index}", *run.kept)
        if f"{x},{y}@{index}" != run.clicked:
            return words, again
    return "Look where the ball is, and read a pixel on it from the grid", shell_command("learn", *run.words, *where)


def _is_followed(frame: Frame, pick: tuple[int, int]) -> bool:
    """Whether a click is confirmed in its own frame."""
    try:
        color = ColorModel.pick(frame.image, *pick)
    except ValueError:
        return False
    return bool(Tracker(Circle, color, start=pick).update(Frame(frame.image, 0.0, 0)))
