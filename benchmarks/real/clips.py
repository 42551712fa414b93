"""Which real clips there are, and where the ball is in them: `find_clips`."""

from pathlib import Path

import msgspec

import matchset as ms
from matchset.app.track.score import TruthRow, read_truth

LABELS = Path(__file__).resolve().parent / "labels"
KNOWN = ("green_ball_hand", "yellow_occlusion")
"""Folders with a truth of their own that are expected in `--data DIR`."""


class Clip(msgspec.Struct, frozen=True):
    """A video and where the ball is in some of its frames.

    Parameters
    ----------
    name : str
        Of its folder or its file.
    video : Path
    truths : list of TruthRow
        At least one of them is tight.
    width, height : int
        Size of the pictures, px.
    """

    name: str
    video: Path
    truths: list[TruthRow]
    width: int
    height: int

    @property
    def tight(self) -> list[TruthRow]:
        """Rows with the ball well known."""
        return [truth for truth in self.truths if truth.tight]


def find_clips(data: Path | None, labels: Path = LABELS) -> tuple[list[Clip], list[str]]:
    """Find the clips below a folder.

    They are the folders that hold a `truth.csv` beside a `video.*`, anybody's own among them, and the files
    ``unlabelled/NAME.mp4`` for which there is a ``NAME.csv`` among the labels.

    Parameters
    ----------
    data : Path or None
        The folder; None: there is none.
    labels : Path
        Folder with truth files for what is in `unlabelled`.

    Returns
    -------
    list of Clip
    list of str
        What was skipped, and why, one sentence each.

    Raises
    ------
    ValueError
        If a truth file or a video cannot be read.
    """
    if data is None:
        return [], ["all real clips: skipped, no folder with them (`--data DIR`)"]
    found: list[tuple[str, Path, Path]] = []
    skipped = [f"`{name}`: skipped, not found" for name in KNOWN if not (data / name / "truth.csv").exists()]
    for truth in sorted(data.glob("*/truth.csv")):
        videos = sorted(truth.parent.glob("video.*"))
        if videos:
            found.append((truth.parent.name, videos[0], truth))
        else:
            skipped.append(f"`{truth.parent.name}`: skipped, there is no video beside its truth")
    names = {path.stem for path in [*labels.glob("*.csv"), *data.glob("unlabelled/*.mp4")]}
    for name in sorted(names):
        video, truth = data / "unlabelled" / f"{name}.mp4", labels / f"{name}.csv"
        if video.exists() and truth.exists():
            found.append((name, video, truth))
        else:
            skipped.append(f"`{name}`: skipped, " + ("it has no labels" if video.exists() else "not found"))
    clips = [_read(*each) for each in found]
    skipped += [f"`{clip.name}`: skipped, no row of its truth is tight" for clip in clips if not clip.tight]
    return [clip for clip in clips if clip.tight], skipped


def _read(name: str, video: Path, truth: Path) -> Clip:
    with ms.Video(video) as frames:
        return Clip(name, video, read_truth(truth), frames.width, frames.height)
