"""`matchset live` as a process: what it prints, how it ends, and what is left after kill -9."""

import contextlib
import json
import signal
import socket
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import cv2
import httpx
import numpy as np
import pytest
from benchmarks.lost.content import content_of
from benchmarks.lost.runs import FPS, write_clip
from websockets.sync.client import connect
from websockets.typing import Origin

from blue_ball import Matchset
from live_server import served
from matchset.app.exit_codes import errors_in_one_line
from matchset.flight.recording.mcap_file import McapReader
from matchset.live.command import live
from matchset.live.options import LiveOptions
from matchset.live.web.listening import LAST_PORT, PLAIN, WHITE_ON_BLACK, listen, qr_code

PICK = "50,60"
MOST_LOST = 0.5  # s
PATIENCE = 180.0  # s, for kernels that may be compiled, on a machine that others use as well


class Running:
    """A process of `matchset live`."""

    def __init__(self, folder: Path, *arguments: str) -> None:
        words = [sys.executable, "-m", "matchset.cli", "live", *arguments, "--no-browser"]
        self.process = subprocess.Popen(words, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, cwd=folder)
        assert self.process.stdout is not None
        self.url = self.process.stdout.readline().strip()

    def state(self) -> Any:
        """What is shown."""
        return httpx.get(f"{self.url}state.json", timeout=10.0).json()

    def do(self, kind: str, **fields: object) -> None:
        """Do what a button does."""
        answer = httpx.post(f"{self.url}do/{kind}", json=fields, timeout=10.0)
        assert answer.status_code == 204, answer.text

    def wait_for(self, done: Any) -> Any:
        """Wait until something is true of the state."""
        until = time.monotonic() + PATIENCE
        while not (found := done(self.state())):
            assert time.monotonic() < until
            time.sleep(0.02)
        return found

    def end(self, number: signal.Signals) -> int:
        """Send a signal; returns the exit code."""
        self.process.send_signal(number)
        return self.process.wait(60.0)


@pytest.fixture(scope="module")
def clip(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("clip") / "clip.avi"
    write_clip(path, 900)
    return path


@pytest.fixture
def start(tmp_path: Path) -> Iterator[Callable[..., Running]]:
    """Start a process, in an empty folder."""
    started: list[Running] = []

    def start(*arguments: str) -> Running:
        started.append(Running(tmp_path, *arguments))
        return started[-1]

    yield start
    for each in started:
        each.process.kill()
        each.process.communicate()


@pytest.fixture
def running(clip: Path, start: Callable[..., Running]) -> Running:
    return start(str(clip), "--port", "0", "--pick", PICK)


def found(state: Any) -> Any:
    return any(target["found"] for stream in state["streams"] for target in stream.get("targets", []))


def frames(state: Any) -> int:
    return int(state["session"]["panels"]["record"].get("frames", 0))


@pytest.mark.parametrize("name", ["nofile.mp4", "notes.txt", ".", "sim://nothing"])
def test_a_source_that_is_none_ends_with_one_line(
    name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "notes.txt").write_text("what to buy")
    with pytest.raises(SystemExit) as ended, errors_in_one_line():
        live(LiveOptions(source=name, port=0, browser=False))
    out, err = capsys.readouterr()
    assert (ended.value.code, out) == (2, "")
    assert err.startswith("error: ")
    assert err.count("\n") == 1


def test_a_pick_is_followed_and_ctrl_c_ends_it_with_all_files(running: Running, tmp_path: Path) -> None:
    running.wait_for(found)
    running.do("record", on=True)
    host = running.url.removeprefix("http://").rstrip("/")
    with contextlib.ExitStack() as stack:
        for address in ("/ws", "/states"):
            stack.enter_context(connect(f"ws://{host}{address}", close_timeout=0.1))
        stack.enter_context(httpx.stream("GET", f"{running.url}events"))
        running.wait_for(lambda state: frames(state) > 20)
        assert running.end(signal.SIGINT) == 0  # while pages and programs look
    folder = tmp_path / "runs" / "0001-live"
    facts = json.loads((folder / "recording.json").read_text())
    assert facts["problem"] == ""
    for path in (folder / "tracks.csv", *folder.glob("raw.*")):
        assert content_of(path).number == facts["frames"][0] >= 20


def test_kill_9_loses_half_a_second_at_most(running: Running, tmp_path: Path) -> None:
    pytest.importorskip("mcap")
    pytest.importorskip("av")
    running.wait_for(found)
    running.do("record", on=True)
    given = running.wait_for(lambda state: frames(state) > 40 and frames(state))
    running.end(signal.SIGKILL)
    folder = tmp_path / "runs" / "0001-live"
    bag = folder / "recording.mcap"
    kept = {path.name: content_of(path).number for path in (folder / "tracks.csv", *folder.glob("raw.*"))}
    kept[bag.name] = [message.topic for message in McapReader(bag)].count("/camera_1/image/compressed")
    assert set(kept) == {"tracks.csv", "raw.mp4", "recording.mcap"}
    assert all((given - number) / FPS <= MOST_LOST for number in kept.values()), (given, kept)
    assert json.loads((folder / "recording.json").read_text())["streams"][0]["targets"][0]["tracks"] == "tracks.csv"


def test_a_port_in_use_a_pick_outside_and_a_folder_that_is_none_are_said(
    clip: Path, tmp_path: Path, start: Callable[..., Running]
) -> None:
    (tmp_path / "runs").write_text("a file in place of the folder")
    with socket.socket() as taken:
        taken.bind(("127.0.0.1", 0))
        taken.listen()
        port = taken.getsockname()[1]
        made = start(str(clip), "--port", str(port), "--pick", "9000,9000")
        other = int(made.url.rstrip("/").rpartition(":")[2])
        assert port < other < port + 20
    made.wait_for(lambda state: any("outside of the picture" in note for note in state["session"].get("notes", [])))
    answer = httpx.post(f"{made.url}do/record", json={"on": True}, timeout=10.0)
    assert answer.status_code == 400
    assert "runs" in answer.json()["error"]
    assert made.end(signal.SIGINT) == 0
    errors = made.process.communicate()[1]
    assert f"note: port {port} is in use; this is {other}" in errors
    assert "note: --pick: (9000, 9000) is outside of the picture of 160 x 120 px" in errors


def test_the_last_port_has_no_next_one() -> None:
    with socket.socket() as taken:
        taken.bind(("127.0.0.1", LAST_PORT))
        taken.listen()
        with pytest.raises(ValueError, match="ports 65535 to 65535 are all in use"):
            listen("127.0.0.1", LAST_PORT)


@pytest.mark.parametrize("pick", ["abc", "1", "1,2@3", "1,2,3"])
def test_a_pick_that_is_no_point_ends_in_two(pick: str, matchset: Matchset, capsys: pytest.CaptureFixture[str]) -> None:
    assert matchset("live", "--no-browser", "--port", 0, "--pick", pick) == 2
    (line,) = capsys.readouterr().err.splitlines()
    assert line.startswith("error: --pick is X,Y")


@pytest.mark.parametrize("package", ["starlette", "uvicorn", "websockets"])
def test_without_the_packages_it_says_what_to_install(monkeypatch: pytest.MonkeyPatch, package: str) -> None:
    monkeypatch.setitem(sys.modules, package, None)
    words = f"^the live page needs the extra web \\({package} is missing\\): pip install 'starlette"
    with pytest.raises(ValueError, match=words):
        live(LiveOptions())


def test_a_token_is_swapped_for_a_cookie_and_nothing_else_is_let_in() -> None:
    with served(token=True) as server, httpx.Client(base_url=f"http://{server.host}", timeout=5.0) as client:
        for address in ("/", "/state.json", "/frame.jpg", "/events", "/download/x", "/main.js"):
            assert client.get(address).status_code == 401
        assert client.post("/do/drop", json={"target": 1}).status_code == 401
        assert client.get("/", params={"token": "wrong"}).status_code == 401
        with pytest.raises(Exception, match="403"), connect(f"ws://{server.host}/states"):
            pass
        swapped = client.get("/", params={"token": server.guard.token})
        assert swapped.status_code == 303
        assert swapped.headers["Location"] == "/"
        cookie = swapped.headers["Set-Cookie"]
        assert "HttpOnly" in cookie
        assert "SameSite=strict" in cookie
        assert server.guard.token not in cookie
        assert client.get("/").status_code == 200
        assert client.get("/state.json").status_code == 200
        header = {"Cookie": cookie.partition(";")[0]}
        with connect(f"ws://{server.host}/states", additional_headers=header) as program:
            assert "sequence" in program.recv(5.0)


def test_a_foreign_page_can_neither_watch_nor_command() -> None:
    with served() as server:
        address = f"http://{server.host}/do/drop"
        assert httpx.post(address, json={"target": 1}, headers={"Origin": "http://evil.example"}).status_code == 403
        assert httpx.post(address, json={"target": 1}, headers={"Origin": "http://[::1"}).status_code == 403
        assert httpx.get(f"http://{server.host}/", headers={"Host": "evil.example:80"}).status_code == 421
        for path in ("/ws", "/states"):
            with (
                pytest.raises(Exception, match="403"),
                connect(f"ws://{server.host}{path}", origin=Origin("http://a.b")),
            ):
                pass


def test_the_qr_code_is_the_address() -> None:
    url = "http://192.168.1.17:8123/?token=abcdefghijklmnopqrstuv"
    rows = list[list[int]]()
    for line in qr_code(url).splitlines():
        blocks = line.removeprefix(WHITE_ON_BLACK).removesuffix(PLAIN)
        rows += [[255 * (block in "█▀") for block in blocks], [255 * (block in "█▄") for block in blocks]]
    picture = np.array(rows, np.uint8).repeat(8, 0).repeat(8, 1)
    assert cv2.QRCodeDetectorAruco().detectAndDecode(picture)[0] == url


def test_without_segno_there_is_no_code(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "segno", None)
    with pytest.raises(ValueError, match="segno"):
        qr_code("http://127.0.0.1/")


def test_lan_prints_an_address_with_a_token(start: Callable[..., Running]) -> None:
    made = start("--port", "0", "--lan")
    assert httpx.get(made.url, follow_redirects=True, timeout=10.0).status_code == 200
    assert httpx.get(made.url.partition("?")[0], timeout=10.0).status_code == 401
    assert made.end(signal.SIGTERM) == 0
    out, errors = made.process.communicate()
    assert "plain HTTP" in errors
    assert "█" not in out + errors  # no terminal
