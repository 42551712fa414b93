"""The commands whose files are looked at (`RUNS`), the clip that they read, and how they are started."""

import os
import subprocess
import sys
from pathlib import Path
from typing import NamedTuple

import cv2
import numpy as np

from matchset.app.films.video_writer import quick_ending

SIZE = 160, 120
FRAMES = 400
FPS = 30.0
BALL = "--pick", "50,60"


class Run(NamedTuple):
    """A command.

    Attributes
    ----------
    words : tuple of str
        What is typed behind `matchset`; CLIP is the clip, DISK the folder of the disk, ELSE one on another disk.
    files : tuple of str
        What it leaves on the disk.
    """

    words: tuple[str, ...]
    files: tuple[str, ...]


BESIDE_TRACKS = "out/tracks.csv", "out/latency.csv", "out/summary.png"
BESIDE_POSES = "out/poses.csv", "out/poses.jsonl", "out/poses.png", "out/latency.csv", "out/summary.png"


def _film(ending: str, folder: str = "ELSE") -> Run:
    words = "track", "CLIP", *BALL, "-o", f"{folder}/out", "--video", f"DISK/film{ending}"
    return Run(words, (f"film{ending}", *(BESIDE_TRACKS if folder == "DISK" else ())))


FLIGHT = "fly", "sim://chain?seed=3", "--quiet"
RUNS = {
    "table": Run(
        ("track", "CLIP", *BALL, "-o", "DISK/out", "--jsonl"),
        (*BESIDE_TRACKS, "out/tracks.jsonl", f"out/track{quick_ending()}"),
    ),
    "poses": Run(
        ("locate", "CLIP", *BALL, "-o", "DISK/out", "--fov", "60", "--diameter", "0.28", "--jsonl"),
        (*BESIDE_POSES, f"out/locate{quick_ending()}"),
    ),
    "webm": _film(".webm"),
    "mp4": _film(".mp4"),
    "avi": _film(".avi"),
    "table and webm": _film(".webm", "DISK"),
    "table and mp4": _film(".mp4", "DISK"),
    "color": Run(("learn", "CLIP", *BALL, "-o", "DISK/ball.npz"), ("ball.npz", "ball-mask.png")),
    "recording": Run((*FLIGHT, "--duration", "1.5", "--record", "DISK/flight.mcap"), ("flight.mcap",)),
    "film of a flight": Run((*FLIGHT, "--duration", "1.5", "--video", "DISK/film.webm"), ("film.webm",)),
    "report": Run((*FLIGHT, "--duration", "0.5", "--report", "DISK/flight.html"), ("flight.html",)),
}


def write_clip(path: Path, frames: int = FRAMES) -> None:
    """Write a noisy clip of a blue ball that moves to and fro."""
    rng = np.random.default_rng(1)
    writer = cv2.VideoWriter(str(path), cv2.VideoWriter.fourcc(*"MJPG"), FPS, SIZE)
    for index in range(frames):
        image = np.full((SIZE[1], SIZE[0], 3), 150, np.uint8)
        x = 50.0 + 40.0 * (1.0 - np.cos(index / 30.0)) / 2.0
        cv2.circle(image, (round(16.0 * x), 60 * 16), 22 * 16, (190, 70, 30), cv2.FILLED, cv2.LINE_AA, 4)
        writer.write(np.clip(image + rng.normal(0.0, 3.0, image.shape), 0, 255).astype(np.uint8))
    writer.release()


def typed(run: Run, clip: Path, disk: Path, other: Path) -> list[str]:
    """Return what is typed; `disk` and `other` are folders."""
    names = {"CLIP": str(clip), "DISK": str(disk), "ELSE": str(other)}
    words = []
    for word in run.words:
        head, slash, tail = word.partition("/")
        words.append(names.get(head, head) + slash + tail)
    return [*words, "--force"]


def start(run: Run, clip: Path, disk: Path, other: Path) -> "subprocess.Popen[str]":
    """Start a command; `disk` and `other` are folders."""
    return subprocess.Popen(
        [sys.executable, "-m", "matchset.cli", *typed(run, clip, disk, other)],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        cwd=other,
        env=os.environ | {"OMP_NUM_THREADS": "1"},
    )
