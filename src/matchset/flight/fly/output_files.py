"""The files that a flight or its replay leaves: `FlightFiles`, and the options of the command line that name them.

Imported by the command line, so imports that take long stand inside the functions.
"""

from collections.abc import Iterable
from pathlib import Path
from typing import Annotated

import msgspec
import typer

from matchset.app.disk import SPACE, SpaceParameters

VideoFile = Annotated[
    Path | None,
    typer.Option("--video", metavar="OUT.webm", help="Film every camera side by side, and the chain from above."),
]
ReportFile = Annotated[
    Path | None, typer.Option("--report", metavar="OUT.html", help="Write a report with pictures, one HTML file.")
]
RecordingFile = Annotated[
    Path | None,
    typer.Option(
        "--record", metavar="OUT.mcap", help="Record everything, for 'matchset replay' and tools of ROS 2; 40 MB/s."
    ),
]
RecordedJpeg = Annotated[
    int | None,
    typer.Option(
        "--record-jpeg",
        min=1,
        max=100,
        metavar="QUALITY",
        help="Record JPEG, a tenth of the size, and fly by the pictures that come out of it: the replay is exact.",
    ),
]
KeepFree = Annotated[
    float,
    typer.Option("--keep-free", min=0.0, metavar="MB", help="Stop film and recording when the disk has no more free."),
]
Quiet = Annotated[bool, typer.Option("--quiet", help="Show nothing while it flies.")]


class FlightFiles(msgspec.Struct, frozen=True, kw_only=True):
    """Which files are written.

    Parameters
    ----------
    video : Path or None
        Every camera side by side and the chain from above: .mp4, .webm or .avi.
    report : Path or None
        Plots and tables: .html.
    record : Path or None
        A recording for `matchset replay`: .mcap.
    jpeg : int or None
        Quality of JPEG for the pictures of the recording, which are then those that are flown by; None: without loss.
    keep_free : float
        MB of the disk that film and recording leave free; at most 2 % of it. See `SpaceParameters`.
    """

    video: VideoFile = None
    report: ReportFile = None
    record: RecordingFile = None
    jpeg: RecordedJpeg = None
    keep_free: KeepFree = SPACE.keep_free

    @property
    def space(self) -> SpaceParameters:
        """How much of the disk is left free."""
        return SpaceParameters(keep_free=self.keep_free)

    def check(self, force: bool = False, inputs: Iterable[Path | None] = ()) -> None:
        """Refuse files that cannot be written, before anything is opened or loaded.

        Parameters
        ----------
        force : bool
            Whether existing files may be overwritten.
        inputs : iterable of Path or None
            What is read: never overwritten.

        Raises
        ------
        ValueError
            If a name has a wrong ending, a file exists, is read, or cannot be written, a package is missing, or it is
            said how a recording is written and there is none.
        """
        from matchset.app.films.codecs import codecs_for
        from matchset.app.run_folder import check_outputs

        check_outputs(self.paths, inputs, force)
        if self.video is not None:
            codecs_for(self.video)
        if self.report is not None:
            check_report(self.report)
        if self.record is None and self.jpeg is not None:
            raise ValueError("--record-jpeg says how a recording is written: give --record FILE too")
        if self.record is not None:
            from matchset.app.viewers.mcap_writer import check_mcap

            check_mcap()

    def make_folders(self, force: bool = False) -> None:
        """Make the folders above the files, and check these once more."""
        from matchset.app.run_folder import output_file

        for path in self.paths:
            output_file(path, force)

    @property
    def paths(self) -> list[Path]:
        """The files, in the order in which they are finished."""
        return [path for path in (self.record, self.video, self.report) if path is not None]


def check_report(path: Path) -> None:
    """Refuse a name that does not end in .html.

    Raises
    ------
    ValueError
        With the name.
    """
    if path.suffix.lower() not in (".html", ".htm"):
        raise ValueError(f"a report's name must end in .html, got {str(path)!r}")
