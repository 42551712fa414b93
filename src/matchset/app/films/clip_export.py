"""A rendered clip on disk: `write_clip`, and the table of its truth."""

import csv
from collections.abc import Iterable
from pathlib import Path

import cv2

from matchset.media.capture import opencv_name
from matchset.sim.clips.clip import Clip
from matchset.sim.clips.truth import ClipTruth

_CODECS = {".avi": "FFV1", ".mkv": "FFV1", ".mp4": "mp4v"}


def write_clip(clip: Clip, target: Path, truth: Path | None = None) -> None:
    """Render a clip to a file or a folder, and its truth to a table.

    Parameters
    ----------
    clip : Clip
        What to render.
    target : Path
        A name that ends in .avi or .mkv: FFV1, lossless. In .mp4: MPEG-4, which adds its own artifacts.
        Without an extension: a new folder of PNG pictures, 000000.png, ...
    truth : Path, optional
        Where the table is written. Default: beside the target, with the extension .csv.

    Raises
    ------
    ValueError
        If the extension is unknown, the name is not UTF-8, the folder exists or the video cannot be written.
    """
    opencv_name(str(target))
    table = truth if truth is not None else target.with_suffix(".csv")
    if target.suffix == "":
        rows = _write_pictures(clip, target)
    elif target.suffix in _CODECS:
        rows = _write_video(clip, target)
    else:
        raise ValueError(f"a clip is written as {', '.join(_CODECS)} or as a folder, got {target}")
    write_truth(rows, table, target.name)


def write_truth(rows: Iterable[ClipTruth], path: Path, video: str) -> None:
    """Write a truth table: video,frame,x,y,r,visible,method.

    x, y, r are empty where the ball is not visible. The method is "rendered"; where less than half of the disc is
    visible it is "rendered|lowconf": no error is measured against such a row.

    Parameters
    ----------
    rows : iterable of ClipTruth
        One for each frame.
    path : Path
        The file, overwritten.
    video : str
        What the column `video` says.
    """
    with path.open("w", newline="") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(("video", "frame", "x", "y", "r", "visible", "method"))
        for row in rows:
            c = row.circle
            numbers = ("", "", "") if c is None else (f"{c.x:.4f}", f"{c.y:.4f}", f"{c.radius:.4f}")
            method = "rendered|lowconf" if 0.0 < row.share < 0.5 else "rendered"
            writer.writerow((video, row.index, *numbers, int(row.visible), method))


def _write_pictures(clip: Clip, folder: Path) -> list[ClipTruth]:
    if folder.exists():
        raise ValueError(f"{folder} exists already: a clip needs a new folder")
    folder.mkdir(parents=True)
    rows = []
    for frame, truth in clip:
        path = folder / f"{frame.index:06d}.png"
        if not cv2.imwrite(str(path), frame.image):
            raise ValueError(f"{path} cannot be written")
        rows.append(truth)
    return rows


def _write_video(clip: Clip, path: Path) -> list[ClipTruth]:
    codec = cv2.VideoWriter.fourcc(*_CODECS[path.suffix])
    writer = cv2.VideoWriter(str(path), codec, clip.fps, (clip.width, clip.height))
    if not writer.isOpened():
        raise ValueError(f"{path} cannot be written")
    rows = []
    try:
        for frame, truth in clip:
            writer.write(frame.image)
            rows.append(truth)
    finally:
        writer.release()
    return rows
