"""`learn`, `track` and `locate` before a stream that breaks off, stays away, changes, or is none."""

import csv
import itertools
import signal
from pathlib import Path

import numpy as np
import pytest

import bad_servers
from bad_servers import BadServer
from blue_ball import CENTERS, Matchset, ball_picture
from flight_process import FlightProcess
from matchset.media.camera_stream import StreamParameters
from mjpeg_server import Image, MjpegServer

RATE = 120.0  # pictures per second, so that a few dozen do not take a second
BLUE = ("--hsv", "100,100,60:130,255,255")


def picture(number: int) -> Image:
    return ball_picture(CENTERS[number % len(CENTERS)])


def lines(err: str) -> list[str]:
    return [line for line in err.splitlines() if "http://" in line]


def table(path: Path) -> list[dict[str, str]]:
    with path.open(newline="") as file:
        return list(csv.DictReader(file))


@pytest.mark.usefixtures("no_path_picture")
@pytest.mark.parametrize(
    ("words", "name"),
    [(("track", *BLUE), "tracks.csv"), (("locate", *BLUE, "--fov", "60", "--diameter", "0.3"), "poses.csv")],
    ids=["track", "locate"],
)
def test_the_ball_is_followed_on_where_a_stream_breaks_off_again_and_again(
    matchset: Matchset,
    ball_video: Path,
    tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
    words: tuple[str, ...],
    name: str,
) -> None:
    assert matchset(words[0], ball_video, *words[1:], "-o", "file") == 0  # compiles what would take a while
    capsys.readouterr()
    with MjpegServer(picture, RATE, each=40) as server:
        assert matchset(words[0], server.url, *words[1:], "--end", 90, "--reconnect", 60, "-o", "out") == 0
        connections = server.connections
    assert connections >= 3
    said = lines(capsys.readouterr().err)
    assert all(line.startswith(f"note: {server.url} ") for line in said)
    broken = [line for line in said if "broke off; it is opened again, for 60 s at most" in line]
    back = [line for line in said if "is back after" in line]
    assert len(back) >= 2
    assert len(broken) + len(back) == len(said)
    rows = table(tmp_path / "out" / name)
    times, numbers = ([float(row[column]) for row in rows] for column in ("time", "frame"))
    assert times == sorted(set(times))
    assert numbers == sorted(set(numbers))
    assert rows[-1]["found"] == "1"


def test_a_color_is_learned_of_a_stream_that_breaks_off_meanwhile(
    matchset: Matchset, capsys: pytest.CaptureFixture[str]
) -> None:
    with MjpegServer(picture, RATE, each=10) as server:  # fewer than are skipped until an exposure has settled
        assert matchset("learn", server.url, "--reconnect", 60) == 0
    out, err = capsys.readouterr()
    assert "is back after" in err
    assert "ball-like:" in out


def test_without_reconnect_it_ends_as_a_device_that_broke(
    matchset: Matchset, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    with MjpegServer(picture, RATE, each=20) as server:
        assert matchset("track", server.url, *BLUE, "--timeout", 0.5, "--reconnect", 0, "-o", "out") == 3
        assert server.connections == 1
    (error,) = lines(capsys.readouterr().err)
    assert error.startswith(f"error: {server.url} has delivered no picture for 0.5 s")
    assert table(tmp_path / "out" / "tracks.csv")


def test_one_that_stays_away_ends_it_and_the_table_is_whole(
    matchset: Matchset, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    server = MjpegServer(picture, RATE)

    def last(number: int) -> Image:
        if number == 30:
            server.stop()  # no picture any more, and none who listens
        return picture(number)

    server._picture = last
    assert matchset("track", server.url, *BLUE, "--reconnect", 0.5, "-o", "out") == 3
    note, error = lines(capsys.readouterr().err)
    assert "it is opened again, for 0.5 s at most" in note
    assert error.startswith(f"error: {server.url} has delivered no picture for")
    assert len(table(tmp_path / "out" / "tracks.csv")) > 1


def test_one_that_comes_back_with_pictures_of_another_size_is_one_error(
    matchset: Matchset, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    numbers = itertools.count()

    def growing(_: int) -> Image:
        number = next(numbers)
        return picture(number) if number < 40 else np.repeat(np.repeat(picture(number), 2, 0), 2, 1)

    with MjpegServer(growing, RATE, each=40) as server:
        assert matchset("track", server.url, *BLUE, "--reconnect", 60, "-o", "out") == 2
    errors = [line for line in capsys.readouterr().err.splitlines() if line.startswith("error: ")]
    assert len(errors) == 1
    assert "is 320 x 240 in color, those before it are 160 x 120 in color" in errors[0]
    assert table(tmp_path / "out" / "tracks.csv")


@pytest.mark.parametrize(
    ("command", "answer"),
    [
        ("track", bad_servers.page),
        ("track", bad_servers.drips_at_once),
        ("learn", bad_servers.circle),
        ("learn", bad_servers.missing),
        ("locate", bad_servers.drips),
        ("fly", bad_servers.silent),
        ("fly", bad_servers.page),
    ],
)
def test_an_address_that_is_no_stream_is_one_line(
    matchset: Matchset,
    monkeypatch: pytest.MonkeyPatch,
    tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
    command: str,
    answer: bad_servers.Answer,
) -> None:
    hasty = StreamParameters(first_picture_s=0.3, answer_s=1.0)
    monkeypatch.setattr("matchset.media.camera_stream.DEFAULT", hasty)
    options = {
        "track": BLUE,
        "learn": (),
        "locate": (*BLUE, "--fov", "60", "--diameter", "0.3"),
        "fly": ("--link", "serial:///dev/null", "--fov", "60"),
    }
    with BadServer(answer) as server:
        words = (server.url, *options[command], "--timeout", 0.3, "--reconnect", 60)
        if command == "fly":
            from matchset.image.color import ColorModel

            color = tmp_path / "ball.npz"
            ColorModel.hsv((100, 100, 60), (130, 255, 255)).save(color)
            words = ("--camera", *words, "--color", color, "--marker-color", color)
        assert matchset(command, *words) == 2
    out, err = capsys.readouterr()
    assert out == ""
    (error,) = [line for line in err.splitlines() if "getting ready" not in line]
    assert error.startswith(f"error: {server.url} ")
    assert not (tmp_path / "runs").exists()


def test_ctrl_c_ends_it_while_a_stream_is_away(tmp_path: Path) -> None:
    with MjpegServer(picture) as server:
        run = FlightProcess(tmp_path, "track", server.url, *BLUE, "--timeout", "0.5", "--reconnect", "600", "-o", "out")
        folder = tmp_path / "out" / "tracks.csv"
        run.waits_for(lambda: folder.exists() and len(folder.read_text().splitlines()) > 5)
        before = server.connections
        server.stalled.set()
        run.waits_for(lambda: server.connections > before)
        run.process.send_signal(signal.SIGINT)
        code, _, err = run.ended()
    assert code == 130, err
    assert "it is opened again, for 600 s at most" in err
    assert "note: stopped; the files hold what was done so far" in err
    assert len(table(folder)) >= 4
