"""Programs: every state as long as they keep up, the newest one else; nonsense ends one session and nothing else."""

import asyncio
import contextlib
import json
import socket
import time
import urllib.request
from collections.abc import Iterator
from typing import Any, BinaryIO
from urllib.parse import quote, urlencode

import cv2
import httpx
import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from websockets.exceptions import ConnectionClosed, InvalidStatus
from websockets.sync.client import ClientConnection, connect

from live_feeds import seen_of
from live_server import Served, served
from matchset.live.feed import Panel
from matchset.live.targets.messages import Drop, Pick
from matchset.live.web.programs import Program, ProgramParameters
from matchset.live.web.viewer import ViewersParameters
from matchset.live.wire.messages import LONGEST, PageMessage

AHEAD = 50  # states that a program which keeps up has not read yet
BAD_STREAMS = ["abc", "-1", "1.5", "", "99999", "٣", "1 ", "9" * 5000]


class Asked(Panel):
    """Notes what it is asked for."""

    name = "asked"
    messages = (Drop, Pick)

    def __init__(self) -> None:
        self.asked = list[PageMessage]()

    def take(self, message: Any, page: str) -> None:  # noqa: ARG002
        if message == Drop(13):
            raise ValueError("there is no target 13 any more")
        self.asked.append(message)


@pytest.fixture
def client(server: Served) -> Iterator[httpx.Client]:
    server.feed.panels = (Asked(),)
    server.feed.show(seen_of(3))
    with httpx.Client(base_url=f"http://{server.host}", timeout=5.0) as made:
        yield made


@pytest.fixture(scope="module")
def server() -> Iterator[Served]:
    with served() as made:
        yield made


@contextlib.contextmanager
def slow_program(server: Served) -> Iterator[BinaryIO]:
    """A session at /states of which nothing is read ahead: libraries do, and keep megabytes."""
    address, port = server.host.split(":")
    asks = f"GET /states HTTP/1.1\r\nHost: {server.host}\r\nConnection: Upgrade\r\nUpgrade: websocket\r\n"
    key = "Sec-WebSocket-Version: 13\r\nSec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\n\r\n"
    with socket.create_connection((address, int(port)), 5.0) as connection, connection.makefile("rb") as file:
        connection.sendall((asks + key).encode())
        while file.readline() != b"\r\n":
            pass
        yield file


def next_line(file: BinaryIO) -> Any:
    """Read a frame of text, as RFC 6455 has it."""
    first, length = file.read(2)
    assert first == 0x81
    if length == 126:
        length = int.from_bytes(file.read(2), "big")
    return json.loads(file.read(length))


def test_a_program_that_keeps_up_gets_every_state(server: Served) -> None:
    server.feed.show(seen_of(0))
    with connect(f"ws://{server.host}/states") as program:
        assert json.loads(program.recv(5.0))["index"] == 0
        lines = list[Any]()
        for number in range(0, 1500, AHEAD):  # it keeps up by reading, not by the clock of a busy computer
            for each in range(number, number + AHEAD):
                server.feed.show(seen_of(each))
            lines += [json.loads(program.recv(60.0)) for _ in range(AHEAD)]
    assert [line["index"] for line in lines] == list(range(1500))
    assert not any("skipped" in line for line in lines)
    assert lines[7]["targets"][0]["values"]["x"] == [57.0, 0.1]


def test_a_slow_program_gets_the_newest_and_the_loop_does_not_wait(server: Served) -> None:
    server.feed.show(seen_of(0))
    with slow_program(server) as file:
        assert next_line(file)["index"] == 0
        for number in range(8000):  # it goes on to the end, although nobody reads
            server.feed.show(seen_of(number))
        lines = [next_line(file)]
        while lines[-1]["index"] != 7999:
            lines.append(next_line(file))
    indices = [line["index"] for line in lines]
    assert indices == sorted(set(indices))
    assert lines[-1]["skipped"] > 1000
    assert len(lines) + lines[-1]["skipped"] == 8000


def test_events_are_the_same_lines(server: Served) -> None:
    server.feed.show(seen_of(4))
    with urllib.request.urlopen(f"http://{server.host}/events", timeout=5.0) as answer:
        assert answer.headers["Content-Type"].startswith("text/event-stream")
        assert (answer.readline(), answer.readline()) == (b"retry: 1000\n", b"\n")
        assert answer.readline() == b"id: 5\n"
        assert json.loads(answer.readline().removeprefix(b"data: "))["index"] == 4
        answer.readline()
        server.feed.show(seen_of(5))
        assert answer.readline() == b"id: 6\n"


def test_events_have_a_heartbeat_and_end() -> None:
    async def lines() -> list[tuple[int, bytes]]:
        program = Program(0, ProgramParameters(heartbeat=0.01))
        found = list[tuple[int, bytes]]()
        async for line in program.lines():
            found.append(line)
            if len(found) == 2:
                program.offer(0, seen_of(8))
                program.offer(1, seen_of(9))
            if len(found) == 3:
                program.end()
        return found

    quiet, again, (sequence, line) = asyncio.run(lines())
    assert quiet == again == (0, b"")
    assert (sequence, json.loads(line)["index"]) == (9, 8)


def test_who_is_behind_gets_the_newest_until_it_has_caught_up() -> None:
    async def follow() -> list[dict[str, Any]]:
        program = Program(0, ProgramParameters(waiting=3))
        found = list[dict[str, Any]]()
        for number in range(10):
            program.offer(0, seen_of(number))
        async for _, line in program.lines():
            found.append(json.loads(line))
            if len(found) == 1:
                program.offer(0, seen_of(10))
                program.offer(0, seen_of(11))
            elif len(found) == 2:
                loop = asyncio.get_running_loop()
                loop.call_soon(program.offer, 0, seen_of(12))
                loop.call_soon(program.offer, 0, seen_of(13))
            elif len(found) == 4:
                program.end()
        return found

    lines = asyncio.run(follow())
    assert [line["index"] for line in lines] == [9, 11, 12, 13]
    assert [line["skipped"] for line in lines] == [9, 10, 10, 10]


@pytest.mark.parametrize("stream", BAD_STREAMS)
def test_a_stream_that_is_no_number_is_400(client: httpx.Client, stream: str) -> None:
    for address in ("/frame.jpg", "/events"):
        answer = client.get(address, params={"stream": stream})
        assert answer.status_code == 400
        assert "stream must be a number" in answer.text
    address = f"ws://{client.base_url.netloc.decode()}/states?{urlencode({'stream': stream})}"
    with pytest.raises(InvalidStatus) as refused, connect(address):
        pass
    assert refused.value.response.status_code == 400


def test_what_is_not_there_is_404(client: httpx.Client) -> None:
    for address in ("/frame.jpg?stream=1", "/events?stream=7", "/download/nothing", "/download/../serve.py", "/no"):
        assert client.get(address).status_code == 404
    assert client.get("/do/pick").status_code == 405


def test_head_has_no_body_and_ends(client: httpx.Client) -> None:
    for address in ("/", "/frame.jpg", "/state.json", "/events", "/main.js"):
        answer = client.head(address)
        assert (answer.status_code, answer.content) == (200, b"")


def test_a_picture_and_its_state(client: httpx.Client) -> None:
    answer = client.get("/frame.jpg")
    image = cv2.imdecode(np.frombuffer(answer.content, np.uint8), cv2.IMREAD_COLOR)
    assert image is not None
    assert image.shape == (120, 160, 3)
    assert float(answer.headers["X-Age"]) == pytest.approx(time.monotonic() - 100.1, abs=5.0)
    state = client.get("/state.json").json()
    assert state["streams"][0]["targets"][0]["name"] == "circle 1"
    assert state["session"]["title"] == "made up"


def test_before_the_first_picture_it_says_so() -> None:
    with served() as server:
        answer = httpx.get(f"http://{server.host}/frame.jpg")
        assert (answer.status_code, answer.text) == (503, "the source is being opened")
        server.session.show(None)
        answer = httpx.get(f"http://{server.host}/frame.jpg")
        assert (answer.status_code, answer.text) == (503, "nothing is shown now")


def test_every_button_has_an_address(client: httpx.Client) -> None:
    assert client.post("/do/drop", json={"target": 2}).status_code == 204
    assert client.post("/do/drop", json={"target": 13}).json() == {"error": "there is no target 13 any more"}
    for address, body in {
        "/do/drop": b"{}",
        "/do/fly": b"{}",
        "/do/ack": b'{"sequence": 1}',
        "/do/pick": b"[1]",
        "/do/outline": b"\xff\xfe",
        "/do/record": b'{"on": true}',
        "/do/diameter": b'{"target": 1, "meters": NaN}',
        "/do/%00": b"{" * 2000,
    }.items():
        answer = client.post(address, content=body)
        assert answer.status_code == 400, (address, answer.text)
        assert answer.json()["error"]
    assert client.post("/do/drop", content=b" " * (LONGEST + 1)).status_code == 413


def test_only_so_many_programs_may_look(server: Served) -> None:
    with contextlib.ExitStack() as stack:
        for _ in range(ViewersParameters().programs):
            stack.enter_context(connect(f"ws://{server.host}/states"))
        with pytest.raises(InvalidStatus) as refused, connect(f"ws://{server.host}/states"):
            pass
        assert refused.value.response.status_code == 503
        assert httpx.get(f"http://{server.host}/events").status_code == 503
    wait_until_nobody_looks(server)
    with connect(f"ws://{server.host}/states") as program:
        assert "index" in json.loads(program.recv(5.0))


def test_only_so_many_pages_may_look(server: Served) -> None:
    with contextlib.ExitStack() as stack:
        for _ in range(ViewersParameters().pages):
            stack.enter_context(connect(f"ws://{server.host}/ws"))
        with connect(f"ws://{server.host}/ws") as more:
            assert end_of(more) == 4429
    wait_until_nobody_looks(server)


def wait_until_nobody_looks(server: Served) -> None:
    """Wait until the server knows that all sessions are closed."""
    until = time.monotonic() + 5.0
    while len(server.viewers):
        assert time.monotonic() < until
        time.sleep(0.01)


def end_of(program: ClientConnection, *said: str | bytes) -> int:
    """Say something, and return the code with which the session is closed."""
    try:
        for words in said:
            program.send(words)
        while True:
            program.recv(5.0)
    except ConnectionClosed as closed:
        return 0 if closed.rcvd is None else closed.rcvd.code


WORDS = st.text(max_size=300) | st.binary(max_size=300)
NEARLY = st.builds(
    lambda kind, fields: json.dumps({"type": kind, **fields}),
    st.sampled_from(["pick", "drop", "outline", "ack", "diameter", "record", "field_of_view", "no"]),
    st.dictionaries(st.sampled_from(["x", "y", "target", "sequence", "meters"]), st.none() | st.text() | st.floats()),
)


@settings(max_examples=25)
@given(st.sampled_from(["/ws", "/states"]), st.lists(WORDS | NEARLY, min_size=1, max_size=4))
def test_nonsense_ends_one_session_and_nothing_else(server: Served, address: str, said: list[str | bytes]) -> None:
    with connect(f"ws://{server.host}/states") as watching:
        with connect(f"ws://{server.host}{address}") as program:
            assert end_of(program, *said, b"\x00 no message at all") in (4400, 1009)
        server.feed.show(seen_of(77))
        while json.loads(watching.recv(5.0))["index"] != 77:
            pass


@settings(max_examples=25, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(st.text(max_size=40), st.binary(max_size=200) | NEARLY.map(str.encode))
def test_any_body_is_answered(client: httpx.Client, kind: str, body: bytes) -> None:
    answer = client.post(f"/do/{quote(kind, safe='')}", content=body)
    assert answer.status_code in (204, 400, 404, 405)
    assert client.get("/state.json").status_code == 200


def test_a_message_that_is_too_long_ends_its_session(server: Served) -> None:
    with connect(f"ws://{server.host}/ws") as program:
        assert end_of(program, "x" * (LONGEST + 1)) == 1009


def test_sessions_end_at_once_with_the_server(caplog: pytest.LogCaptureFixture) -> None:
    with contextlib.ExitStack() as stack:
        with served() as server:
            programs = [stack.enter_context(connect(f"ws://{server.host}{address}")) for address in ("/ws", "/states")]
            events = stack.enter_context(urllib.request.urlopen(f"http://{server.host}/events", timeout=5.0))
        assert "exceeded" not in caplog.text  # nothing had to be cut
        assert [end_of(program) for program in programs] == [1012, 1012]
        events.read()
