"""The live page's server under load: many viewers, one that is silent, one that goes away, a thousand clicks."""

import asyncio
import json
import time
from collections.abc import Iterator

import pytest
from benchmarks.live.clients import Watcher
from benchmarks.live.section import Server, running
from websockets.asyncio.client import connect
from websockets.exceptions import ConnectionClosed

pytest.importorskip("starlette")
VIEWERS, PLACES = 50, 16  # who look; who may look at a time
MANY = 5  # pictures: more than the two that one gets who acknowledges none
SECONDS = 1.0  # of looking, for as long as it takes until everybody has seen many
LONG = 60.0
CLICKS = 1000


@pytest.fixture(scope="module")
def server() -> Iterator[Server]:
    with running() as started:
        wait_for_pictures(started)
        yield started


def wait_for_pictures(server: Server) -> None:
    """Wait until its loop has seen some more pictures."""
    before, end = server.load().frames, time.monotonic() + LONG
    while server.load().frames < before + MANY:
        assert time.monotonic() < end
        time.sleep(0.02)


def watch(watchers: list[Watcher]) -> list[BaseException | None]:
    """Let them look; how it ended for each."""

    async def look() -> list[BaseException | None]:
        return await asyncio.gather(*(each.watch(SECONDS) for each in watchers), return_exceptions=True)

    return asyncio.run(look())


def test_fifty_viewers_all_but_the_silent_one_see_the_loop_go_on(server: Server) -> None:
    """At which rate, `python -m benchmarks --only live` says."""
    end = time.monotonic() + LONG
    seeing = 0
    while seeing < PLACES - 1:
        assert time.monotonic() < end
        watchers = [Watcher(server.address, acknowledges=bool(number)) for number in range(VIEWERS)]
        ends = watch(watchers)
        assert all(each is None or isinstance(each, ConnectionClosed) for each in ends)
        assert sum(each is not None for each in ends) == VIEWERS - PLACES
        assert len(watchers[0].sizes) <= 2
        seeing = sum(len(each.sizes) > MANY for each in watchers)
    wait_for_pictures(server)


def test_a_viewer_that_goes_in_the_middle_takes_nobody_along(server: Server) -> None:
    async def look() -> None:
        async with connect(Watcher(server.address).socket_address, max_size=None) as goes:
            await goes.recv()
            goes.transport.abort()

    stays = Watcher(server.address)

    async def both() -> None:
        watching = asyncio.create_task(stays.watch(LONG))
        await look()
        seen = len(stays.sizes)
        async with asyncio.timeout(LONG):
            while len(stays.sizes) < seen + 2 * MANY:
                await asyncio.sleep(0.01)
        watching.cancel()
        await asyncio.gather(watching, return_exceptions=True)

    asyncio.run(both())


def test_a_thousand_clicks_on_nothing_do_no_harm(server: Server) -> None:
    async def click() -> None:
        async with connect(Watcher(server.address).socket_address, max_size=None) as socket:
            for number in range(CLICKS):
                wrong = {"type": "pick", "sequence": number, "x": float(number), "y": 5.0 * number}
                await socket.send(json.dumps(wrong))
                if number % 50 == 0:
                    await asyncio.sleep(0.02)

    before = server.load()
    asyncio.run(click())
    watcher = Watcher(server.address)
    assert watch([watcher]) == [None]
    assert watcher.sizes
    wait_for_pictures(server)
    assert server.load().resident_mb - before.resident_mb < 150.0
