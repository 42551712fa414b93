"""Photographs that balls are rendered before: wallpapers of Debian, or any folder of pictures.

    python -m training.rendering.photographs FOLDER

fetches the wallpapers and unpacks them below FOLDER, which must not be in the repository; nothing is installed.
"""

import fnmatch
import subprocess
import tempfile
from collections.abc import Sequence
from pathlib import Path
from typing import Annotated

import cv2
import msgspec
import numpy as np
import typer

from matchset.image.disc_network.patch_format import Image
from training.rendering.layers import Random, Range, Singles, Size, happens, log_within, within

REPOSITORY = Path(__file__).resolve().parents[2]
PACKAGES = (
    "mate-backgrounds",
    "gnome-backgrounds",
    "plasma-workspace-wallpapers",
    "ukui-wallpapers",
    "lomiri-wallpapers-16.04",
    "lomiri-wallpapers-20.04",
)
"""Of Debian 12; a later one may have lost some, which is said and passed over."""

SUFFIXES = (".jpg", ".jpeg", ".png", ".webp")
DRAWINGS = ("*truchet*", "*grid-*", "*symbolic*", "*Stripes*", "*/wallpapers/*.png")
"""Files below a folder that are drawn, not taken; of Plasma's wallpapers those in PNG are, most of them."""


class PhotographParameters(msgspec.Struct, frozen=True):
    """How photographs become backgrounds; chosen by hand.

    Parameters
    ----------
    longest : int
        Longer side to which photographs are reduced, px.
    zoom : (float, float)
        Scale of a part of one.
    variety : tuple of float
        Least standard deviations of its colors, of 255, each as likely: without, most parts are of a clear sky.
    every : int
        Each how manieth pixel is looked at for that.
    mirrored, upside_down : float
        Shares of parts that are.
    tries : int
        How many parts are tried for one that is large enough and has that variety; then it is a plain gray.
    gray : (float, float)
        How light that is, of 255.
    """

    longest: int = 1200
    zoom: Range = (0.5, 3.0)
    variety: tuple[float, ...] = (0.0, 12.0, 25.0, 40.0)
    every: int = 4
    mirrored: float = 0.5
    upside_down: float = 0.3
    tries: int = 30
    gray: Range = (20.0, 230.0)


class Photographs:
    """Photographs in memory, of which random parts are given.

    Parameters
    ----------
    pictures : sequence of ndarray of shape (h, w, 3), uint8
        BGR.
    limits : PhotographParameters, optional
    """

    def __init__(self, pictures: Sequence[Image], limits: PhotographParameters | None = None) -> None:
        self._limits = limits or PhotographParameters()
        self._pictures = [_reduced(picture, self._limits.longest) for picture in pictures]
        if not self._pictures:
            raise ValueError("no pictures to be backgrounds")

    @classmethod
    def read(cls, folders: Sequence[Path], limits: PhotographParameters | None = None) -> "Photographs":
        """Read all pictures in and below folders, but for drawings and what cannot be read."""
        limits = limits or PhotographParameters()
        read = (cv2.imread(str(path)) for path in find_photographs(folders))
        pictures = [_reduced(np.asarray(picture, np.uint8), limits.longest) for picture in read if picture is not None]
        if not pictures:
            raise ValueError(f"no pictures in {', '.join(map(str, folders))}")
        return cls(pictures, limits)

    def __len__(self) -> int:
        return len(self._pictures)

    def crop(self, random: Random, size: Size) -> Singles:
        """Give a random part of a random photograph, scaled to a size.

        Parameters
        ----------
        random : Generator
        size : (int, int)
            Height and width, px.

        Returns
        -------
        ndarray of shape (h, w, 3), float32
        """
        limits, (height, width) = self._limits, size
        least = random.choice(limits.variety)
        for _ in range(limits.tries):
            picture = self._pictures[random.integers(len(self._pictures))]
            zoom = log_within(random, limits.zoom)
            rows, columns = int(height / zoom) + 2, int(width / zoom) + 2
            if picture.shape[0] <= rows or picture.shape[1] <= columns:
                continue
            top, left = random.integers(picture.shape[0] - rows), random.integers(picture.shape[1] - columns)
            part = picture[top : top + rows, left : left + columns]
            if part[:: limits.every, :: limits.every].std(axis=(0, 1)).mean() < least:
                continue
            part = part[:, ::-1] if happens(random, limits.mirrored) else part
            part = part[::-1] if happens(random, limits.upside_down) else part
            way = cv2.INTER_LINEAR if zoom > 1.0 else cv2.INTER_AREA
            scaled = cv2.resize(np.ascontiguousarray(part), (width, height), interpolation=way)
            return np.asarray(scaled, np.float32)
        return np.full((height, width, 3), within(random, limits.gray), np.float32)


def _reduced(picture: Image, longest: int) -> Image:
    """Reduce a picture whose longer side is longer than that, px."""
    scale = longest / max(picture.shape[:2])
    if scale >= 1.0:
        return picture
    return np.asarray(cv2.resize(picture, None, fx=scale, fy=scale, interpolation=cv2.INTER_AREA), np.uint8)


def find_photographs(folders: Sequence[Path]) -> list[Path]:
    """List the pictures in and below folders that are no drawings, by name, no file twice."""
    return sorted({path for folder in folders for path in folder.rglob("*") if _is_taken(path, folder)})


def _is_taken(path: Path, folder: Path) -> bool:
    """Whether a file in a folder is a picture that is not drawn, by its name."""
    name = path.relative_to(folder).as_posix()
    is_picture = path.suffix.lower() in SUFFIXES and path.is_file()
    return is_picture and not any(fnmatch.fnmatchcase(name, drawn) for drawn in DRAWINGS)


def fetch(folder: Path, packages: Sequence[str] = PACKAGES) -> list[str]:
    """Fetch packages of wallpapers and unpack them below a folder.

    Returns
    -------
    list of str
        Packages that were not to be had.
    """
    if folder.resolve().is_relative_to(REPOSITORY):
        raise ValueError(f"photographs do not belong into the repository, got {folder}")
    folder.mkdir(parents=True, exist_ok=True)
    missing = []
    for package in packages:
        with tempfile.TemporaryDirectory() as place:
            subprocess.run(["apt-get", "download", package], cwd=place, check=False)
            files = sorted(Path(place).glob("*.deb"))
            for file in files:
                subprocess.run(["dpkg-deb", "-x", str(file), str(folder)], check=True)
        if not files:
            missing.append(package)
    return missing


def read_photographs(folders: Sequence[Path]) -> Photographs:
    """Read the pictures in folders; wallpapers are fetched into the first one if there are none."""
    if not find_photographs(folders):
        for package in fetch(folders[0]):
            typer.echo(f"not to be had: {package}")
    return Photographs.read(folders)


def main(folder: Annotated[Path, typer.Argument(help="Where the photographs go; not in the repository.")]) -> None:
    """Fetch photographs to render balls before."""
    try:
        missing = fetch(folder)
    except ValueError as error:
        raise typer.BadParameter(str(error)) from None
    for package in missing:
        typer.echo(f"not to be had: {package}")
    typer.echo(f"{len(find_photographs([folder]))} pictures in {folder}")


if __name__ == "__main__":
    typer.run(main)
