"""Cameras in the network, on loopback, of three kinds; each can be killed, started again, stalled and woken."""

import functools
import itertools
import os
import signal
import socket
import subprocess
import threading
import time
from abc import ABC, abstractmethod
from pathlib import Path
from types import TracebackType
from typing import Any, Self

import cv2
import numpy as np
import numpy.typing as npt
import pytest

from mjpeg_server import MjpegServer

Image = npt.NDArray[np.uint8]

SIZE, RADIUS = (320, 240), 24
DEBIAN_PYTHON = Path("/usr/bin/python3")
RTSP_CAMERA = Path(__file__).parent / "rtsp_camera.py"


def ball(number: int) -> Image:
    """A blue ball before a gray wall, which moves a little."""
    image = np.full((SIZE[1], SIZE[0], 3), 150, np.uint8)
    cv2.circle(image, (150 + number % 40, 120), RADIUS, (190, 70, 30), cv2.FILLED, cv2.LINE_AA)
    return image


class StreamCamera(ABC):
    """A camera in the network."""

    url: str

    @abstractmethod
    def start(self) -> None:
        """Start it, again at the same address."""

    @abstractmethod
    def kill(self) -> None:
        """End it in the midst of a picture."""

    @abstractmethod
    def stall(self) -> None:
        """Let it send nothing any more, without a word."""

    @abstractmethod
    def wake(self) -> None:
        """Let it send again."""

    def __enter__(self) -> Self:
        self.start()
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.kill()


class MjpegCamera(StreamCamera):
    """MJPEG over HTTP."""

    def __init__(self) -> None:
        numbers = itertools.count()
        self._server = MjpegServer(lambda _: ball(next(numbers)))
        self._server.stop()
        self.url = self._server.url

    def start(self) -> None:
        self._server.start()

    def kill(self) -> None:
        self._server.stop()

    def stall(self) -> None:
        self._server.stalled.set()

    def wake(self) -> None:
        self._server.stalled.clear()


class UdpCamera(StreamCamera):
    """H.264 in an MPEG transport stream over UDP, a key picture every third of a second."""

    def __init__(self) -> None:
        self._av: Any = pytest.importorskip("av", reason="PyAV sends the stream: it is in the dependency group `test`")
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as free:
            free.bind(("127.0.0.1", 0))
            self.url = f"udp://127.0.0.1:{free.getsockname()[1]}"
        self._end, self._stalled, self._thread = threading.Event(), threading.Event(), threading.Thread()

    def _send(self) -> None:
        with self._av.open(f"{self.url}?pkt_size=1316", "w", format="mpegts") as container:
            stream = container.add_stream("libx264", rate=30, options={"tune": "zerolatency", "g": "10"})
            (stream.width, stream.height), stream.pix_fmt = SIZE, "yuv420p"
            begin = time.monotonic()
            for number in itertools.count():
                if self._end.wait(max(0.0, begin + number / 30.0 - time.monotonic())):
                    return
                if not self._stalled.is_set():
                    picture = self._av.VideoFrame.from_ndarray(ball(number), format="bgr24")
                    container.mux(stream.encode(picture))

    def start(self) -> None:
        self._end.clear()
        self._thread = threading.Thread(target=self._send, daemon=True)
        self._thread.start()

    def kill(self) -> None:
        self._end.set()
        self._thread.join()

    def stall(self) -> None:
        self._stalled.set()

    def wake(self) -> None:
        self._stalled.clear()


@functools.cache
def has_gstreamer() -> bool:
    """Whether Debian's Python has GStreamer's server."""
    words = "import gi; gi.require_version('GstRtspServer', '1.0'); from gi.repository import GstRtspServer"
    return DEBIAN_PYTHON.exists() and not subprocess.run([DEBIAN_PYTHON, "-c", words], capture_output=True).returncode


class RtspCamera(StreamCamera):
    """RTSP, by GStreamer's server in a process of its own; skips where that is missing, and fails in CI."""

    def __init__(self) -> None:
        if not has_gstreamer():
            missing = "GStreamer's RTSP server is missing; to install it, as root: .ci/rtsp"
            if os.environ.get("CI"):
                pytest.fail(missing)
            pytest.skip(missing)
        self._port = "0"

    @property
    def url(self) -> str:  # type: ignore[override]
        return f"rtsp://127.0.0.1:{self._port}/ball"

    def start(self) -> None:
        words = [str(DEBIAN_PYTHON), str(RTSP_CAMERA), self._port]
        self._process = subprocess.Popen(words, stdout=subprocess.PIPE, stdin=subprocess.DEVNULL, text=True)
        assert self._process.stdout is not None
        self._port = self._process.stdout.readline().split()[0]

    def kill(self) -> None:
        self._process.kill()
        self._process.communicate()

    def stall(self) -> None:
        self._process.send_signal(signal.SIGSTOP)

    def wake(self) -> None:
        self._process.send_signal(signal.SIGCONT)


KINDS = {"MJPEG over HTTP": MjpegCamera, "H.264 over UDP": UdpCamera, "RTSP": RtspCamera}
