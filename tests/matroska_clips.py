"""Matroska files of JPEG pictures with a pose in their header, written element by element (RFC 9559)."""

import struct
from collections.abc import Sequence
from pathlib import Path

import cv2
import numpy as np
import numpy.typing as npt


def element(name: int, content: bytes | int | float | str) -> bytes:
    if isinstance(content, int):
        content = content.to_bytes(4)
    elif isinstance(content, float):
        content = struct.pack(">d", content)
    elif isinstance(content, str):
        content = content.encode()
    return name.to_bytes((name.bit_length() + 7) // 8) + (1 << 56 | len(content)).to_bytes(8) + content


def write_posed(path: Path, pictures: Sequence[npt.NDArray[np.uint8]], yaw: float, roll: float) -> Path:
    """Write pictures that are to be shown with a yaw and a roll, degrees."""
    height, width = pictures[0].shape[:2]
    pose = element(0x7671, 0) + element(0x7673, yaw) + element(0x7674, 0.0) + element(0x7675, roll)
    shape = element(0xB0, width) + element(0xBA, height) + element(0x7670, pose)
    track = element(0xD7, 1) + element(0x73C5, 1) + element(0x83, 1) + element(0x86, "V_MJPEG") + element(0xE0, shape)
    coded = [cv2.imencode(".jpg", picture)[1].tobytes() for picture in pictures]
    blocks = [element(0xA3, b"\x81" + struct.pack(">h", 40 * k) + b"\x80" + data) for k, data in enumerate(coded)]
    cluster = element(0xE7, 0) + b"".join(blocks)
    info = element(0x2AD7B1, 1_000_000) + element(0x4489, 40.0 * len(pictures))
    segment = element(0x1549A966, info) + element(0x1654AE6B, element(0xAE, track)) + element(0x1F43B675, cluster)
    head = element(0x4282, "matroska") + element(0x4287, 4) + element(0x4285, 2)
    path.write_bytes(element(0x1A45DFA3, head) + element(0x18538067, segment))
    return path
