"""Addresses behind which there is no stream: a page, a redirection in a circle, bytes that drip, nothing at all."""

import socket
import socketserver
import threading
from collections.abc import Callable
from types import TracebackType
from typing import Self

Answer = Callable[[socket.socket, threading.Event], None]

PAGE = b"<!DOCTYPE html><html><head><title>Camera</title></head><body>Please log in.</body></html>"
BEGINNING = b"HTTP/1.1 200 OK\r\nContent-Type: multipart/x-mixed-replace; boundary=frame\r\n\r\n--frame\r\n"


def page(connection: socket.socket, _: threading.Event) -> None:
    """Answer with a page."""
    head = f"HTTP/1.1 200 OK\r\nContent-Type: text/html; charset=utf-8\r\nContent-Length: {len(PAGE)}\r\n\r\n"
    connection.sendall(head.encode() + PAGE)


def circle(connection: socket.socket, _: threading.Event) -> None:
    """Redirect to where one came from."""
    connection.sendall(b"HTTP/1.1 302 Found\r\nLocation: /stream\r\nContent-Length: 0\r\n\r\n")


def missing(connection: socket.socket, _: threading.Event) -> None:
    """Answer that there is nothing."""
    connection.sendall(b"HTTP/1.1 404 Not Found\r\nContent-Length: 0\r\n\r\n")


def drips(connection: socket.socket, stop: threading.Event) -> None:
    """Begin as a stream does, then go on byte by byte."""
    connection.sendall(BEGINNING)
    while not stop.wait(0.05):
        connection.sendall(b"x")


def drips_at_once(connection: socket.socket, stop: threading.Event) -> None:
    """Send even the head byte by byte."""
    for byte in BEGINNING:
        if stop.wait(0.1):
            return
        connection.sendall(bytes([byte]))


def silent(_: socket.socket, stop: threading.Event) -> None:
    """Take the connection, and say nothing."""
    stop.wait()


class BadServer:
    """Answers each connection in one way, until its `with` block ends."""

    def __init__(self, answer: Answer) -> None:
        stop = self._stop = threading.Event()

        class Handler(socketserver.BaseRequestHandler):
            def handle(self) -> None:
                try:
                    if answer is not silent:
                        self.request.recv(4096)
                    answer(self.request, stop)
                except OSError:
                    pass

        class Server(socketserver.ThreadingTCPServer):
            daemon_threads = True
            allow_reuse_address = True

        self._server = Server(("127.0.0.1", 0), Handler)
        self.port: int = self._server.server_address[1]
        threading.Thread(target=self._server.serve_forever, args=(0.05,), daemon=True).start()

    @property
    def url(self) -> str:
        return f"http://127.0.0.1:{self.port}/stream"

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._stop.set()
        self._server.shutdown()
        self._server.server_close()
