"""One peer in a process of its own: `python -m benchmarks.contest.peer_process KEY FRAMES.npz` says what it took."""

import json
import sys
import time

import cv2
import numpy as np

from benchmarks.common.resident_memory import resident_mb
from benchmarks.common.start import Start
from benchmarks.peers import load


def main(key: str, path: str) -> None:
    """Print when the first answer was there (s since 1970), and the resident size after all frames, MB."""
    cv2.setNumThreads(1)
    with np.load(path) as file:
        images, circle = file["images"], file["circle"].tolist()
    method, parameters = load(key)
    step = method.follow(Start(images[0], tuple(circle)), parameters)
    step(images[1])
    moment = time.time()
    for image in images[2:]:
        step(image)
    print(json.dumps([moment, resident_mb()]))


if __name__ == "__main__":
    main(*sys.argv[1:])
