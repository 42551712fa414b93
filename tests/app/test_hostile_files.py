"""Files that want all memory: each is refused in one line with code 2, in a process that has little memory left."""

import io
import json
import os
import struct
import subprocess
import sys
import threading
import zipfile
import zlib
from pathlib import Path

import cv2
import numpy as np
import pytest

from matchset.app.exit_codes import errors_in_one_line
from matchset.camera.camera_model import CameraModel
from matchset.image.color import ColorModel
from matchset.image.files.limits import LIMITS, InputLimits
from matchset.image.files.reading import read_limited
from matchset.media.picture import decode_picture, picture_size

ROOM = 700_000_000  # bytes, beside what the program has when it is ready

CHILD = """
import contextlib, io, json, resource, sys
import cv2, numpy
from matchset import cli
from matchset.app.locate import what_options_name
from matchset.app.target import shape_option, target_options
from matchset.app.track import command, loop, outputs, score
from matchset.media.video import Video
cv2.imdecode(cv2.imencode(".png", numpy.zeros((9, 9), numpy.uint8))[1], 0)
with open("/proc/self/statm") as file:
    now = int(file.read().split()[0]) * resource.getpagesize()
resource.setrlimit(resource.RLIMIT_AS, (now + int(sys.argv[1]),) * 2)
ended = []
for words in json.loads(sys.stdin.read()):
    sys.argv, err = ["matchset", *words], io.StringIO()
    with contextlib.redirect_stderr(err), contextlib.redirect_stdout(io.StringIO()):
        try:
            cli.main()
        except SystemExit as error:
            code = error.code
        except BaseException as error:
            code = repr(error)
    ended.append((code, err.getvalue()))
print(json.dumps(ended))
"""


def png(width: int, height: int) -> bytes:
    """A PNG that is well-formed but for its few pixels."""

    def chunk(kind: bytes, data: bytes) -> bytes:
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))

    head = struct.pack(">IIBBBBB", width, height, 8, 0, 0, 0, 0)
    return b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", head) + chunk(b"IDAT", zlib.compress(bytes(99))) + chunk(b"IEND", b"")


def bomb(path: Path, size: int) -> Path:
    """A color file that unpacks to so many bytes of zeros."""
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED, compresslevel=1) as archive:
        for name in ("matchset_color", "gray"):
            scalar = io.BytesIO()
            np.save(scalar, np.int64(1))
            archive.writestr(f"{name}.npy", scalar.getvalue())
        header = io.BytesIO()
        np.lib.format.write_array_header_1_0(header, {"descr": "<f4", "fortran_order": False, "shape": (size // 4,)})
        with archive.open("log_odds.npy", "w", force_zip64=True) as file:
            file.write(header.getvalue())
            for _ in range(size // 1_000_000):
                file.write(bytes(1_000_000))
    return path


ALIASES = "a0: &a0 [1,1,1,1,1,1,1,1,1]\n" + "".join(
    f"a{k}: &a{k} [{','.join(9 * [f'*a{k - 1}'])}]\n" for k in range(1, 9)
)
CAMERA = "image_width: 640\nimage_height: 480\ndistortion_coefficients: [0,0,0,0,0]\ncamera_matrix: *a8\n"


@pytest.mark.skipif(not Path("/proc/self/statm").exists(), reason="the memory of a process is not told here")
def test_every_hostile_file_is_refused_in_one_line(tmp_path: Path) -> None:
    clip, folder = tmp_path / "ball.png", tmp_path / "pictures"
    folder.mkdir()
    cv2.imwrite(str(clip), np.full((120, 160, 3), 150, np.uint8))
    (tmp_path / "vast.png").write_bytes(png(60_000, 60_000))
    (folder / "vast.png").write_bytes(png(30_000, 30_000))
    (tmp_path / "large.png").write_bytes(png(30_000, 30_000))
    (tmp_path / "camera.yaml").write_text(ALIASES + CAMERA)
    (tmp_path / "itself.yaml").write_text("a: &a [*a]\n" + CAMERA.replace("*a8", "*a"))
    bomb(tmp_path / "bomb.npz", 1_000_000_000)
    os.mkfifo(tmp_path / "pipe")
    pick, color, zero = ("--pick", "80,60"), str(tmp_path / "bomb.npz"), "/dev/zero"
    fov = "--fov", "60", "--diameter", "0.3"
    commands = [
        ["track", str(clip), *pick, "--shape", str(tmp_path / "vast.png")],
        ["track", str(clip), *pick, "--shape", str(tmp_path / "large.png")],
        ["track", str(clip), *pick, "--shape", zero],
        ["track", str(tmp_path / "vast.png"), *pick],
        ["learn", str(folder)],
        ["track", str(clip), "--color", color],
        ["track", str(clip), "--color", zero],
        ["track", str(clip), *pick, "--params", zero],
        ["locate", str(clip), *pick, "--camera", str(tmp_path / "camera.yaml"), "--diameter", "0.3"],
        ["locate", str(clip), *pick, "--camera", str(tmp_path / "itself.yaml"), "--diameter", "0.3"],
        ["locate", str(clip), "--color", color, *fov],
        ["locate", str(clip), *pick, "--fov", "60", "--markers", zero, "--marker-color", color],
        ["score", zero, zero],
        ["score", str(tmp_path / "pipe"), zero],
        ["fly", "--config", zero],
    ]
    feeder = threading.Thread(target=_feed, args=(tmp_path / "pipe",), daemon=True)
    feeder.start()
    ended = subprocess.run(
        [sys.executable, "-c", CHILD, str(ROOM)],
        input=json.dumps(commands),
        capture_output=True,
        text=True,
        cwd=tmp_path,
        timeout=300,
    )
    assert ended.returncode == 0, ended.stderr
    for words, (code, err) in zip(commands, json.loads(ended.stdout), strict=True):
        assert code == 2, (words, code, err)
        assert err.startswith("error: "), (words, err)
        assert err.count("\n") == 1, (words, err)


def _feed(path: Path) -> None:
    """An endless table, until nobody reads it any more."""
    try:
        with path.open("wb", buffering=0) as pipe:
            for _ in range(400):
                pipe.write(1_000_000 * b"1")
    except BrokenPipeError:
        pass


@pytest.mark.parametrize("error", [MemoryError(), MemoryError("640 MB"), cv2.error("out of range")])
def test_what_is_left_to_memory_and_opencv_is_one_line_too(
    error: Exception, capsys: pytest.CaptureFixture[str]
) -> None:
    with pytest.raises(SystemExit) as ended, errors_in_one_line():
        raise error
    assert ended.value.code == 2
    err = capsys.readouterr().err
    assert err.startswith("error: ")
    assert err.count("\n") == 1


@pytest.mark.parametrize("suffix", [".png", ".jpg", ".bmp", ".tiff", ".webp", ".ppm", ".pgm", ".gif"])
@pytest.mark.parametrize("size", [(1, 1), (37, 23), (640, 480)])
def test_the_size_is_read_before_the_picture(suffix: str, size: tuple[int, int]) -> None:
    image = np.full((size[1], size[0]) if suffix == ".pgm" else (size[1], size[0], 3), 99, np.uint8)
    try:
        good, packed = cv2.imencode(suffix, image)
    except cv2.error:
        pytest.skip(f"this OpenCV writes no {suffix}")
    if not good:
        pytest.skip(f"this OpenCV writes no {suffix}")
    data = packed.tobytes()
    assert picture_size(data) == size
    assert decode_picture(data, cv2.IMREAD_COLOR).shape[:2] == size[::-1]
    with pytest.raises(ValueError, match="larger than"):
        decode_picture(data, cv2.IMREAD_COLOR, InputLimits(picture=size[0] * size[1] - 1))


def test_damaged_heads_are_no_pictures_and_never_errors() -> None:
    rng = np.random.default_rng(5)
    for suffix in (".png", ".jpg", ".bmp", ".tiff", ".webp", ".ppm"):
        data = cv2.imencode(suffix, np.full((20, 30, 3), 7, np.uint8))[1].tobytes()
        for _ in range(200):
            broken = bytearray(data[: rng.integers(0, len(data))])
            for _ in range(3 if broken else 0):
                broken[rng.integers(0, len(broken))] = rng.integers(0, 256)
            size = picture_size(bytes(broken))
            assert size is None or min(size) >= 0
    assert decode_picture(b"", cv2.IMREAD_COLOR) is None
    assert decode_picture(png(0, 5), cv2.IMREAD_COLOR) is None


def test_limits_are_for_giants_only(tmp_path: Path) -> None:
    (tmp_path / "a").write_bytes(bytes(1000))
    assert read_limited(tmp_path / "a", 1000) == bytes(1000)
    with pytest.raises(ValueError, match="longer than"):
        read_limited(tmp_path / "a", 999)
    with pytest.raises(ValueError, match="zero bytes"):
        read_limited(tmp_path / "a", 1000, text=True)
    assert LIMITS.picture > 33_177_600  # 8K
    image = np.full((80, 80, 3), 150, np.uint8)
    cv2.circle(image, (40, 40), 15, (190, 70, 30), cv2.FILLED)
    ColorModel.pick(image, 40, 40).save(tmp_path / "a.npz")
    ColorModel.load(tmp_path / "a.npz")
    (tmp_path / "camera.yaml").write_text(
        "k: &k [100, 0, 320, 0, 100, 240, 0, 0, 1]\nimage_width: 640\nimage_height: 480\n"
        "camera_matrix: {rows: 3, cols: 3, data: *k}\ndistortion_coefficients: {data: [0, 0, 0, 0, 0]}\n---\nnext: [\n"
    )
    assert CameraModel.load(tmp_path / "camera.yaml").cx == 320.0
