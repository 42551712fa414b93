"""A Tello that flies in numbers, by the SDK's guide; djitellopy flies it too (`test_djitellopy.py`).

It knows the commands by which a vehicle is flown, answers when it has done them, keeps the last sticks, and lands after
15 s without a command. Told by the guide, not seen in a real one: that sticks go on without a command.
"""

import errno
import socket
import threading
import time
from dataclasses import dataclass, field

from fakes import Clock

ALONE = 15.0  # s without a command, then it lands
CLIMB, TOP = 0.5, 0.8  # m/s, m: of its own take-off
STEP = 0.02  # s


@dataclass
class FakeTello:
    """The vehicle, at the other end of perfect Wi-Fi.

    Attributes
    ----------
    clock : Clock
    refusal : str
        What it answers instead of taking off.
    mute, gone, chatty : bool
        It does not speak; there is no network; it answers sticks too, as some firmware does.
    heard : list of str
        Every command.
    """

    clock: Clock = field(default_factory=Clock)
    refusal: str = ""
    mute: bool = False
    gone: bool = False
    chatty: bool = False
    closed: bool = False
    talks: bool = False
    battery: int = 87
    height: float = 0.0
    place: tuple[float, float] = (0.0, 0.0)
    yaw: float = 0.0
    sticks: tuple[int, int, int, int] = (0, 0, 0, 0)
    doing: str = ""  # "takeoff" or "land"
    motors: bool = False
    motor_time: float = 0.0
    heard: list[str] = field(default_factory=list)
    out: list[bytes] = field(default_factory=list)

    def __post_init__(self) -> None:
        self._moved_at = self._heard_at = self.clock()
        self._stated_at = self.clock() - 1.0

    def send(self, data: bytes) -> None:
        if self.gone:
            raise OSError(errno.ENETUNREACH, "Network is unreachable")
        self.move()
        words = data.decode()
        self.heard.append(words)
        self._heard_at = self.clock()
        if words == "command":
            self.talks = True
        answer = self._do(words) if self.talks else None
        if answer is not None:
            self.out.append(answer.encode())

    def answers(self) -> list[bytes]:
        if self.gone:
            raise OSError(errno.ENETUNREACH, "Network is unreachable")
        self.move()
        out, self.out = self.out, []
        return [] if self.mute else out

    def states(self) -> list[bytes]:
        self.move()
        if self.mute or not self.talks or self.clock() - self._stated_at < 0.1:
            return []
        self._stated_at = self.clock()
        return [self.state()]

    def close(self) -> None:
        self.closed = True

    def state(self) -> bytes:
        tof, height = max(10, round(100 * self.height)), 10 * round(10 * self.height)
        return (
            f"pitch:0;roll:0;yaw:{self.yaw:.0f};vgx:0;vgy:0;vgz:0;templ:60;temph:62;tof:{tof};h:{height};"
            f"bat:{self.battery};baro:170.10;time:{self.motor_time:.0f};agx:0.00;agy:0.00;agz:-999.00;\r\n"
        ).encode()

    def move(self) -> None:
        """Let the time pass until now."""
        while self.clock() - self._moved_at >= STEP:
            self._moved_at += STEP
            self._step()

    def _do(self, words: str) -> str | None:
        name, *rest = words.split()
        if name == "rc":
            if self.motors and not self.doing:
                self.sticks = tuple(int(each) for each in rest)  # type: ignore[assignment]
            return "ok" if self.chatty else None
        if name == "emergency":
            self.motors, self.height, self.doing = False, 0.0, ""
            return None
        if name == "takeoff":
            if self.refusal or self.motors:
                return self.refusal or "error"
            self.motors, self.doing, self.sticks = True, "takeoff", (0, 0, 0, 0)
            return None
        if name == "land":
            if not self.motors:
                return "error"
            self.doing = "land"
            return None
        known = {"battery?": str(self.battery), "command": "ok", "streamon": "ok", "streamoff": "ok", "port": "ok"}
        return known.get(name, f"unknown command: {words}")

    def _step(self) -> None:
        if not self.motors:
            return
        self.motor_time += STEP
        if self._moved_at - self._heard_at > ALONE:
            self.doing = "land"
        if self.doing == "takeoff":
            self.height += CLIMB * STEP
            if self.height >= TOP:
                self.doing = ""
                self.out.append(b"ok")
        elif self.doing == "land":
            self.height -= CLIMB * STEP
            if self.height <= 0.0:
                self.height, self.doing, self.motors = 0.0, "", False
                self.out.append(b"ok")
        else:
            a, b, c, d = (each / 100.0 for each in self.sticks)
            self.place = self.place[0] + a * STEP, self.place[1] + b * STEP
            self.height = max(0.3, self.height + c * STEP)
            self.yaw += 100.0 * d * STEP


class RealClock(Clock):
    def __call__(self) -> float:
        return time.monotonic()

    def sleep(self, seconds: float) -> None:
        time.sleep(seconds)


class ServedTello:
    """The same behind real UDP sockets, in real time.

    Parameters
    ----------
    states : int
        Port of this computer for the states.
    """

    def __init__(self, states: int) -> None:
        self.tello = FakeTello(RealClock())
        self._states = states
        self._socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self._socket.bind(("127.0.0.1", 0))
        self._socket.settimeout(0.01)
        self.port = int(self._socket.getsockname()[1])
        self._done = threading.Event()
        self._thread = threading.Thread(target=self._serve)
        self._thread.start()

    def close(self) -> None:
        self._done.set()
        self._thread.join()
        self._socket.close()

    def _serve(self) -> None:
        sender = None
        while not self._done.is_set():
            try:
                data, sender = self._socket.recvfrom(2000)
                self.tello.send(data)
            except OSError:  # nothing came, or nobody listens
                pass
            if sender is not None:
                for answer in self.tello.answers():
                    self._socket.sendto(answer, sender)
                for state in self.tello.states():
                    self._socket.sendto(state, ("127.0.0.1", self._states))
