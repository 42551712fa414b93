"""However many pages look, the state of the session is made once in a tenth of a second."""

import asyncio
import time

import msgspec
from websockets.asyncio.client import connect

from live_server import served
from matchset.live.session import Session
from matchset.live.web.session_report import SESSION_PERIOD, SessionReport
from matchset.live.wire.packet import unpack
from matchset.live.wire.state import SessionState

PAGES, SECONDS = 8, 0.5


def test_one_look_a_period_and_a_version_for_each_change() -> None:
    session, looks, now = Session(), list[float](), [10.01]
    look = session.state

    def counted() -> SessionState:
        looks.append(now[0])
        return look()

    session.state = counted  # type: ignore[method-assign]
    report = SessionReport(session, lambda: now[0])
    first = report.state()
    assert report.state() is first
    assert (len(looks), report.version) == (1, 1)
    assert 0.0 < report.wait() <= SESSION_PERIOD
    now[0] += report.wait() + 0.001
    assert report.state() == first
    assert (len(looks), report.version) == (2, 1)
    session.note("something")
    now[0] += SESSION_PERIOD
    assert report.state().notes == ["something"]
    assert (len(looks), report.version) == (3, 2)


def test_eight_pages_cost_no_more_looks_than_one() -> None:
    async def watch(host: str) -> list[str]:
        async with connect(f"ws://{host}/ws") as socket:
            names = set[str]()
            end = asyncio.get_running_loop().time() + SECONDS
            while not names or asyncio.get_running_loop().time() < end:
                packet = unpack(await socket.recv(decode=False))
                if packet.session:
                    names.add(msgspec.json.decode(packet.state, type=SessionState).page)
            return sorted(names)

    async def watch_all(host: str) -> list[list[str]]:
        return await asyncio.gather(*(watch(host) for _ in range(PAGES)))

    with served() as server:
        looks, look = list[float](), server.session.state

        def counted() -> SessionState:
            looks.append(time.monotonic())
            return look()

        server.session.state = counted  # type: ignore[method-assign]
        names = asyncio.run(watch_all(server.host))
    assert all(len(each) == 1 for each in names)  # each is told its own name
    assert len({name for each in names for name in each}) == PAGES
    assert len(looks) <= 3 + (looks[-1] - looks[0]) / SESSION_PERIOD  # by each page: eight times as many
