"""The rendered videos of the benchmarks, kept in a folder: `short_videos`, `tiny_videos`, `long_video`."""

import shutil
from pathlib import Path

import msgspec

from matchset.app.films.clip_export import write_clip
from matchset.image.color import ColorModel
from matchset.sim.clips.clip import Clip


class Videos(msgspec.Struct, frozen=True):
    """Videos of one ball, and its color.

    Parameters
    ----------
    folder : Path
    paths : tuple of Path
    color : Path
        What was learned from a click into the first frame of the first one.
    """

    folder: Path
    paths: tuple[Path, ...]
    color: Path


SHORT = 12  # different short videos
FRAMES = (120, 400)  # of the shortest and of the longest of them
COPIES = 4
TINY, TINY_FRAMES, TINY_COPIES = 10, 90, 20  # 200 videos of 320 x 240
SMALL = {"width": 320, "height": 240, "radii": (10.0, 60.0)}
FPS = 30.0


def short_videos(cache: Path, copies: int = COPIES) -> Videos:
    """Videos of 640 x 480 px and of 4 to 13 s; each of `SHORT` different ones as often as copies are wanted."""
    clips = [Clip(frames=round(FPS * length), seed=300 + k) for k, length in enumerate(lengths())]
    return _copied(cache / "short", clips, copies)


def lengths() -> list[float]:
    """Lengths of the different short videos, s."""
    return [round(FRAMES[0] + k * (FRAMES[1] - FRAMES[0]) / (SHORT - 1)) / FPS for k in range(SHORT)]


def tiny_videos(cache: Path) -> Videos:
    """200 videos of 320 x 240 px and 3 s."""
    clips = [Clip(frames=TINY_FRAMES, seed=400 + k, **SMALL) for k in range(TINY)]  # type: ignore[arg-type]
    return _copied(cache / "tiny", clips, TINY_COPIES)


def long_video(cache: Path, minutes: float) -> Videos:
    """One video of 320 x 240 px."""
    clip = Clip(frames=round(60.0 * FPS * minutes), seed=500, **SMALL)  # type: ignore[arg-type]
    return _copied(cache / f"long-{minutes:g}", [clip], 1)


def _copied(folder: Path, clips: list[Clip], copies: int) -> Videos:
    """Render what is not there yet; copies have another name and the same bytes."""
    folder.mkdir(parents=True, exist_ok=True)
    first, paths = clips[0], list[Path]()
    color = folder / "ball.npz"
    if not color.is_file():
        x, y = first.first_click
        ColorModel.pick(first.render(0, first.background()).image, round(x), round(y)).save(color)
    for number, clip in enumerate(clips):
        original = folder / f"{number:02d}-0.mp4"
        if not original.is_file():
            unfinished = folder / "unfinished.mp4"
            write_clip(clip, unfinished)
            unfinished.replace(original)
        paths.append(original)
    for copy in range(1, copies):
        for number in range(len(clips)):
            path = folder / f"{number:02d}-{copy}.mp4"
            if not path.is_file():
                shutil.copyfile(paths[number], path)
            paths.append(path)
    return Videos(folder, tuple(paths), color)
