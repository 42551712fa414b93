"""A file that is not there is a FileNotFoundError for Python, also a ValueError, and one line of the command line."""

import math
import re
from collections.abc import Callable
from typing import Any

import pytest

import matchset as ms
from matchset import cli

READERS: dict[str, tuple[Callable[[str], Any], str]] = {
    "video": (ms.Video, "nope.mp4"),
    "bag": (ms.Video, "nope.bag"),
    "color": (ms.ColorModel.load, "nope.npz"),
    "camera": (ms.CameraModel.load, "nope.toml"),
}


@pytest.mark.parametrize("error", [FileNotFoundError, ValueError])
@pytest.mark.parametrize("reader", READERS)
def test_a_missing_file_is_both(reader: str, error: type[Exception]) -> None:
    read, name = READERS[reader]
    with pytest.raises(error, match=f"^no such .*file: {re.escape(name)}$"):
        read(name)


def test_the_command_line_says_so_in_one_line(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr("sys.argv", ["matchset", "track", "nope.mp4", "--pick", "1,1"])
    with pytest.raises(SystemExit) as ended:
        cli.main()
    assert ended.value.code == 2
    assert capsys.readouterr().err.splitlines()[-1] == "error: no such file: nope.mp4"


@pytest.mark.parametrize(("fov", "hint"), [(61.3, True), (179.0, True), (200.0, False), (-1.0, False)])
def test_a_field_of_view_in_degrees_is_told_what_to_write(fov: float, hint: bool) -> None:
    with pytest.raises(ValueError, match="between 0 and pi rad") as caught:
        ms.CameraModel.from_fov(640, 480, fov)
    assert (f"({fov:g} degrees are math.radians({fov:g}))" in str(caught.value)) == hint
    assert ms.CameraModel.from_fov(640, 480, math.radians(61.3)).fx == pytest.approx(540.0, abs=0.1)
