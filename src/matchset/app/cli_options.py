"""Options of the command line: those that several commands share, and how a class of options becomes a command."""

import dataclasses
import inspect
import math
import sys
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Self, TypeVar

import msgspec
import typer

from matchset.app.exit_codes import compiling_announced, errors_in_one_line, print_note

if TYPE_CHECKING:
    from matchset.media.video import Video

Source = Annotated[
    str,
    typer.Argument(help="A video file, a picture, a folder of pictures, a bag of ROS, a camera's number, or a URL."),
]
Topic = Annotated[
    str | None,
    typer.Option(metavar="NAME", help="Of a bag (.bag, .db3, .mcap, folder): which topic, if several have pictures."),
]
Force = Annotated[bool, typer.Option("--force", help="Overwrite what exists.")]
Pick = Annotated[
    str | None,
    typer.Option(
        metavar="X,Y[@FRAME]", help="A pixel on the ball, in frame 0 or FRAME; of a file it is followed both ways."
    ),
]
Picks = Annotated[
    list[str] | None,
    typer.Option(
        "--pick",
        metavar="X,Y[@FRAME]",
        help="A pixel on the ball, in frame 0 or FRAME; of a file it is followed both ways. Several: a target each.",
    ),
]
ReadingNumber = Annotated[
    int, typer.Option("--reading", metavar="N", min=1, help="What the --pick means: the N-th likeliest thing there.")
]
Candidate = Annotated[
    str | None, typer.Option(metavar="N[@FRAME]", help="The ball-like thing that 'learn' numbered N.")
]
Color = Annotated[
    list[Path] | None,
    typer.Option(metavar="FILE", help="A color of the ball that 'learn' saved; several are joined."),
]
NamedColor = Annotated[
    list[Path] | None,
    typer.Option(
        "--color",
        metavar="[NAME=]FILE",
        help="A color of the ball that 'learn' saved; several are joined, unless named.",
    ),
]
Hsv = Annotated[
    list[str] | None,
    typer.Option(
        metavar="LOW:HIGH",
        help="OpenCV's HSV range H,S,V:H,S,V; a low hue above the high one wraps at red.",
    ),
]
Gray = Annotated[
    str | None,
    typer.Option(metavar="dark|light|edges", help="Brightness in place of color; a --pick then says where."),
]
ShapeName = Annotated[
    str,
    typer.Option(
        "--shape",
        metavar="SHAPE",
        help="circle, ellipse, rectangle, quadrilateral, triangle, pentagon, hexagon, octagon, corners '0,0 4,0 0,3', "
        "or a picture of the outline; ':affine' behind it: seen from the side.",
    ),
]
AnnotatedVideo = Annotated[
    Path | None,
    typer.Option(
        "--video",
        metavar="OUT.webm",
        help="Write the annotated video, all of it at full size: .webm (VP8), .mp4 (H.264 by PyAV or ffmpeg, "
        "else MPEG-4) or .avi (Motion JPEG).",
    ),
]
NoVideo = Annotated[
    bool, typer.Option("--no-video", help="No video and no summary.png in the folder that nobody asked for: quicker.")
]
Gif = Annotated[
    Path | None,
    typer.Option("--gif", metavar="OUT.gif", help="Write an animated picture too, .gif or .webp; see --start, --end."),
]
Start = Annotated[
    str | None, typer.Option("--start", metavar="FRAME|4.5s", help="Begin here: a frame, or seconds with an s.")
]
End = Annotated[str | None, typer.Option("--end", metavar="FRAME|9s", help="End before this frame or time.")]
Folder = Annotated[Path | None, typer.Option("-o", metavar="DIR", help="Folder for the tables.")]
ToStdout = Annotated[
    bool, typer.Option("--print", help="Write one line of JSON a frame to stdout, and nothing else there.")
]
Fps = Annotated[
    float | None,
    typer.Option(metavar="RATE", help="Frames per second: of a file whose own times are wrong, or asked of a camera."),
]
Turn = Annotated[
    int,
    typer.Option("--turn", metavar="0|90|180|270", help="Turn pictures clockwise: a camera that hangs upside down."),
]
Mirror = Annotated[bool, typer.Option("--mirror", help="Swap left and right, after --turn: a camera behind a mirror.")]
StoredPixels = Annotated[
    bool, typer.Option("--stored-pixels", help="Pixels that are not square stay so; by default they are made square.")
]
StreamNumber = Annotated[
    int | None,
    typer.Option("--stream", metavar="N", help="Of a file: which video stream, from 0; else the longest."),
]
Damaged = Annotated[
    bool, typer.Option("--damaged", help="Use pictures whose decoder reports errors, of a live source too.")
]
FieldsName = Annotated[
    str,
    typer.Option(
        "--fields",
        metavar="frames|top|bottom|auto",
        help="Of interlaced video: each field as a frame of its own time, the top one first or the bottom one.",
    ),
]
Timeout = Annotated[
    float | None,
    typer.Option("--timeout", metavar="S", help="Of a camera or stream: the longest silence, s; 2 without it."),
]
Reconnect = Annotated[
    float | None,
    typer.Option(
        "--reconnect",
        metavar="S",
        help="How long one that is lost is opened again and again, s; 0: it ends. Without it 10 of a stream, 0 of a "
        "camera.",
    ),
]
Params = Annotated[
    Path | None,
    typer.Option("--params", metavar="FILE.toml", help="Parameters of the tracker, as 'matchset params' prints them."),
]
Points = Annotated[int, typer.Option(min=16, max=4096, help="Size of the match-set: more is steadier and slower.")]


class TurnOptions(msgspec.Struct, frozen=True, kw_only=True):
    """The options that say how a camera is mounted; a camera file is turned with its pictures."""

    turn: Turn = 0
    mirror: Mirror = False

    @property
    def arguments(self) -> dict[str, Any]:
        """Arguments of `matchset.media.video.Video`."""
        return {"turn": self.turn, "mirror": self.mirror}

    @property
    def undone(self) -> "TurnOptions":
        """What puts a turned picture, and its camera, back into how they were."""
        return self if self.mirror else TurnOptions(turn=-self.turn % 360)

    @property
    def words(self) -> tuple[str, ...]:
        """Those that were typed, for the next command."""
        turn = ("--turn", str(self.turn)) if self.turn else ()
        return (*turn, "--mirror") if self.mirror else turn


UPRIGHT = TurnOptions()


class ViewOptions(msgspec.Struct, frozen=True, kw_only=True):
    """The options that say how the pictures of a source are used."""

    mounted: TurnOptions = TurnOptions()
    stored_pixels: StoredPixels = False
    stream: StreamNumber = None
    damaged: Damaged = False
    fields: FieldsName = "frames"

    @property
    def arguments(self) -> dict[str, Any]:
        """Arguments of `matchset.media.video.Video`."""
        own = {"square": not self.stored_pixels, "stream": self.stream, "damaged": True if self.damaged else None}
        return self.mounted.arguments | own | {"fields": self.fields}

    @property
    def words(self) -> tuple[str, ...]:
        """Those that were typed, for the next command."""
        stream = () if self.stream is None else ("--stream", str(self.stream))
        fields = () if self.fields == "frames" else ("--fields", self.fields)
        flags = (("--stored-pixels", self.stored_pixels), ("--damaged", self.damaged))
        return (*self.mounted.words, *stream, *fields, *(name for name, given in flags if given))


AS_IT_IS = ViewOptions()


def source_words(source: str, topic: str | None, view: ViewOptions = AS_IT_IS) -> tuple[str, ...]:
    """Return how a source was named on the command line, for the next command."""
    return (source, *(() if topic is None else ("--topic", topic)), *view.words)


def shape_file(shape: str) -> Path:
    """Return the picture that `--shape` may name: a file that is read then."""
    return Path(shape.partition(":affine")[0])


def unit_note(option: str, meters: float | None, most: float) -> None:
    """Say on stderr that a length is most likely not in m.

    Parameters
    ----------
    option : str
        Its name.
    meters : float or None
        As typed.
    most : float
        Longer than this is unlikely, m.
    """
    if meters is None or not most < meters < math.inf:
        return
    unit, parts = ("cm", 100.0) if most >= LARGE_BALL and meters / 100.0 <= most else ("mm", 1000.0)
    meant = f"{meters:g} {unit} are {option} {meters / parts:g}"
    print(f"note: {option} {meters:g} is in m, and that is large: {meant}", file=sys.stderr)


class ShownOptions(msgspec.Struct, frozen=True, kw_only=True):
    """The options that say which part of a video is used, and what is drawn of it."""

    no_video: NoVideo = False
    gif: Gif = None
    start: Start = None
    end: End = None

    def check(self, video: Path | None) -> None:
        """Check the names of the pictures, and the part, before anything is opened (ValueError)."""
        from matchset.app.films.codecs import check_animation, codecs_for
        from matchset.app.pictures.part import VideoPart

        if video is not None:
            codecs_for(video)
        if self.gif is not None:
            check_animation(self.gif)
        VideoPart.parse(self.start, self.end)

    def names(self, name: str, video: Path | None, to_stdout: bool) -> tuple[str, ...]:
        """Return the files that nobody asked for in the run's folder; of a live source they are not written."""
        film = () if video is not None else (f"{name}.mp4", f"{name}.webm")
        return () if self.no_video or to_stdout else ("summary.png", *film)


class SilenceOptions(msgspec.Struct, frozen=True, kw_only=True):
    """The options that say how much silence of a camera or a stream is borne."""

    timeout: Timeout = None
    reconnect: Reconnect = None

    def open(
        self, source: str, fps: float | None = None, topic: str | None = None, view: ViewOptions = AS_IT_IS
    ) -> "Video":
        """Open a source; it says on stderr when it is lost and when it is back."""
        from matchset.media.video import Video

        more = view.arguments | ({} if self.timeout is None else {"timeout": self.timeout})
        return Video(source, fps=fps, topic=topic, reconnect=self.reconnect, note=print_note, **more)


class TargetOptions(msgspec.Struct, frozen=True, kw_only=True):
    """The options that say what to track: exactly one of them, or `pick` together with `gray` or `reading`."""

    pick: Pick = None
    picks: list[str] | None = None  # an option of some commands only, in place of `pick`: see SeveralTargetOptions
    reading: ReadingNumber = 1
    candidate: Candidate = None
    color: Color = None
    hsv: Hsv = None
    gray: str | None = None  # an option of some commands only: see GrayTargetOptions
    ball: bool = True  # no option: whether the shape that is followed is one


class SeveralTargetOptions(TargetOptions, frozen=True, kw_only=True):
    """The same with more than one `--pick`; of one alone `pick` is set by `single`."""

    pick: str | None = None
    picks: Picks = None
    color: NamedColor = None

    @property
    def single(self) -> Self:
        """The same with the first click alone."""
        return msgspec.structs.replace(self, pick=self.picks[0], picks=None) if self.picks else self


class GrayTargetOptions(SeveralTargetOptions, frozen=True, kw_only=True):
    """The same with `--gray`."""

    gray: Gray = None


Options = TypeVar("Options")
LARGE_BALL, LARGE_SQUARE = 2.0, 0.5  # format: m; larger balls and squares of boards are unlikely


def command_of(function: Callable[[Options], int]) -> Callable[..., None]:
    """Make a Typer command of a function that takes one object with all options.

    Parameters
    ----------
    function : callable
        Takes one object; its class (a dataclass or a `msgspec.Struct`) has one field for each option, annotated with
        ``Annotated[type, typer.Option(...)]`` or ``typer.Argument``. A field whose type is again such a class is a
        group of options; the command line shows its fields in this place. A field without such an annotation is no
        option and keeps its default. The function returns the exit code.

    Returns
    -------
    callable
        What `typer.Typer.command` takes: one keyword for each option. It reports a user's error in one line and ends
        with the exit code.
    """
    (options,) = inspect.signature(function, eval_str=True).parameters.values()

    def command(**values: Any) -> None:
        with errors_in_one_line(), compiling_announced():
            code = function(_built(options.annotation, values))
        raise typer.Exit(code)

    parameters = _parameters(options.annotation)
    command.__name__, command.__doc__ = function.__name__, function.__doc__
    command.__annotations__ = {parameter.name: parameter.annotation for parameter in parameters}
    command.__signature__ = inspect.Signature(parameters)  # type: ignore[attr-defined]
    return command


def _parameters(options: type[Any]) -> list[inspect.Parameter]:
    """Return the options of a class, and of its groups, in the order of its fields."""
    found = []
    for field in inspect.signature(options).parameters.values():
        if _is_group(field.annotation):
            found += _parameters(field.annotation)
        elif hasattr(field.annotation, "__metadata__"):
            if field.annotation.__origin__ is bool:  # Typer would print <bool>, as if a value were to be given
                for option in field.annotation.__metadata__:
                    option.metavar = ""
            found.append(field.replace(kind=inspect.Parameter.KEYWORD_ONLY))
    return found


def _built(options: type[Options], values: Mapping[str, Any]) -> Options:
    """Make an object of a class of options, with its groups, from the values of all options by name."""
    fields = inspect.signature(options).parameters.values()
    plain = {field.name: values[field.name] for field in fields if field.name in values}
    groups = {field.name: _built(field.annotation, values) for field in fields if _is_group(field.annotation)}
    return options(**plain | groups)


def _is_group(annotation: Any) -> bool:
    is_class = isinstance(annotation, type)
    return is_class and (dataclasses.is_dataclass(annotation) or hasattr(annotation, "__struct_fields__"))
