"""A camera in the network: pictures as MJPEG over HTTP on loopback, which can be stopped and started again."""

import contextlib
import random
import threading
import time
from collections.abc import Callable
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from typing import Any

import cv2
import numpy as np
import numpy.typing as npt

Image = npt.NDArray[np.uint8]

BELOW_EPHEMERAL = range(20_000, 32_000)
"""Ports that no system gives to connections: one could take the port while the server is stopped, and a client that
tries again and again to connect to a port of theirs connects to itself at last."""


class MjpegServer:
    """Serves `picture(number)` at a rate; `stop` cuts all connections, `start` listens on the same port again.

    While `stalled` is set it takes connections and sends nothing. With `each` it cuts one after as many pictures.
    """

    def __init__(self, picture: Callable[[int], Image], rate: float = 30.0, each: int | None = None) -> None:
        self._picture, self._rate, self._each, self.port = picture, rate, each, 0
        self.shown = self.connections = 0
        self.stalled = threading.Event()
        self._stop = threading.Event()
        self._server: Any = None
        self.start()

    @property
    def url(self) -> str:
        """Its address."""
        return f"http://127.0.0.1:{self.port}/stream.mjpg"

    def start(self) -> None:
        """Listen."""
        outer, self._stop = self, threading.Event()
        stop = self._stop

        class Handler(BaseHTTPRequestHandler):
            def do_GET(self) -> None:
                self.send_response(200)
                self.send_header("Content-Type", "multipart/x-mixed-replace; boundary=frame")
                self.end_headers()
                begin, number = time.monotonic(), 0
                outer.connections += 1
                try:
                    while not stop.is_set() and (outer._each is None or number < outer._each):
                        if outer.stalled.is_set():
                            stop.wait(0.01)
                            continue
                        outer.shown = max(outer.shown, number)
                        _, data = cv2.imencode(".jpg", outer._picture(number), [cv2.IMWRITE_JPEG_QUALITY, 92])
                        head = f"--frame\r\nContent-Type: image/jpeg\r\nContent-Length: {len(data)}\r\n\r\n"
                        self.wfile.write(head.encode() + data.tobytes() + b"\r\n")
                        number += 1
                        stop.wait(max(0.0, begin + number / outer._rate - time.monotonic()))
                except OSError:
                    pass

            def log_message(self, *_: Any) -> None:
                pass

        class Server(ThreadingHTTPServer):
            daemon_threads = True
            allow_reuse_address = True

        self._server = Server(("127.0.0.1", self.port), Handler) if self.port else self._on_free_port(Server, Handler)
        self.port = self._server.server_address[1]
        threading.Thread(target=self._server.serve_forever, args=(0.05,), daemon=True).start()

    def _on_free_port(self, server: Any, handler: Any) -> Any:
        for port in random.sample(BELOW_EPHEMERAL, 100):
            with contextlib.suppress(OSError):
                return server(("127.0.0.1", port), handler)
        raise OSError("no free port of a hundred")

    def stop(self) -> None:
        """Cut all connections; nothing listens any more."""
        self._stop.set()
        self._server.shutdown()
        self._server.server_close()

    def __enter__(self) -> "MjpegServer":
        return self

    def __exit__(self, *_: object) -> None:
        self.stop()
