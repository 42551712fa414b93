"""Viewers without a browser, and a slow link: `Watcher`, `SlowLink`."""

import asyncio
import time
from typing import Any

import msgspec
from websockets.asyncio.client import ClientConnection, connect

from matchset.live.wire.packet import unpack

CHUNK = 4096  # bytes that pass a slow link at once
BUFFER = 65536  # bytes: what a socket on the way holds


class Watcher:
    """A page without a screen: acknowledges each picture at once.

    Parameters
    ----------
    address : str
        Of the server, ``http://...``.
    acknowledges : bool
        A viewer that never does gets two pictures and no more.
    through : int, optional
        Port of a slow link to the server; the address that is told stays that of the server.

    Attributes
    ----------
    socket_address : str
    ages : list of float
        From capture to arrival, s; on one computer both have one clock.
    sizes : list of int
        Bytes of each message with a picture.
    """

    def __init__(self, address: str, acknowledges: bool = True, through: int | None = None) -> None:
        self.socket_address = address.replace("http", "ws", 1) + "ws"
        self._acknowledges, self._through = acknowledges, through
        self.ages: list[float] = []
        self.sizes: list[int] = []

    async def watch(self, seconds: float) -> None:
        """Look for a time, s."""
        end = time.monotonic() + seconds
        place: dict[str, Any] = {} if self._through is None else {"host": "127.0.0.1", "port": self._through}
        async with connect(self.socket_address, max_size=None, **place) as socket:
            while (left := end - time.monotonic()) > 0.0:
                try:
                    await self._take(socket, await asyncio.wait_for(socket.recv(), left))
                except TimeoutError:
                    return

    async def _take(self, socket: ClientConnection, data: str | bytes) -> None:
        if not isinstance(data, bytes):
            return
        packet = unpack(data)
        if not packet.picture:
            return
        self.ages.append(time.monotonic() - packet.time)
        self.sizes.append(len(data))
        if self._acknowledges:
            await socket.send(msgspec.json.encode({"type": "ack", "sequence": packet.sequence}).decode())


class SlowLink:
    """A TCP proxy that lets through so many bits a second towards the viewer.

    Parameters
    ----------
    port : int
        Of the server.
    rate : float
        bit/s
    delay : float
        Of each way, s.
    """

    def __init__(self, port: int, rate: float, delay: float = 0.005) -> None:
        self._port, self._rate, self._delay = port, rate, delay

    async def __aenter__(self) -> "SlowLink":
        self._server = await asyncio.start_server(self._join, "127.0.0.1", 0, limit=BUFFER)
        self.port: int = self._server.sockets[0].getsockname()[1]
        return self

    async def __aexit__(self, *_: object) -> None:
        self._server.close()

    async def _join(self, reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        from_server, to_server = await asyncio.open_connection("127.0.0.1", self._port, limit=BUFFER)
        up = asyncio.create_task(self._pass(reader, to_server, None))
        await self._pass(from_server, writer, self._rate)
        up.cancel()
        to_server.close()

    async def _pass(self, reader: asyncio.StreamReader, writer: asyncio.StreamWriter, rate: float | None) -> None:
        free = time.monotonic()
        try:
            while data := await reader.read(CHUNK):
                if rate is not None:
                    free = max(free, time.monotonic()) + 8.0 * len(data) / rate
                    await asyncio.sleep(max(0.0, free - time.monotonic()))
                await asyncio.sleep(self._delay if rate is None else 0.0)
                writer.write(data)
                await writer.drain()
        except ConnectionError:
            pass
        finally:
            writer.close()
