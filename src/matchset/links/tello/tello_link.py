"""``tello:``: a DJI or Ryze Tello in its own Wi-Fi; `TelloLink`.

It flies by itself and takes speeds, so sticks mean something else than with a toy. Roll, pitch and yaw become speeds,
``rc a b c d``; the throttle becomes a speed up or down: 0.5 holds the height. The first throttle above zero after
`arm` takes off, by the Tello's own take-off to about 1 m; zero throttle in the air lands, by its own landing.

By itself it would fly on by the last sticks, and land after 15 s without a command. A thread of the link makes the
sticks neutral after 0.3 s without one, and lands after 2 s; it cannot do so if the program or the Wi-Fi is gone.
"""

import contextlib
import threading
import time
from collections.abc import Callable
from typing import Literal

from matchset.control.command import HOLD, Command
from matchset.image.errors import LinkError
from matchset.links.link import DeviceLink, LinkStatus, State
from matchset.links.tello.tello_client import Sockets, TelloClient, TelloParameters, UdpSockets, parse_tello
from matchset.links.tello.tello_state import TelloState

FULL = 100  # format: of a speed in ``rc``

Phase = Literal["grounded", "rising", "flying", "landing"]


def speeds(command: Command) -> tuple[int, int, int, int]:
    """Return a command as a, b, c, d of ``rc``: to the right, forward, up, clockwise; -100 ... 100."""
    up = (command.throttle - HOLD) / HOLD
    return round(command.roll * FULL), round(command.pitch * FULL), round(up * FULL), round(command.yaw * FULL)


class TelloLink(DeviceLink):
    """A Tello; implements `matchset.links.link.Link`, as far as a vehicle that is told speeds allows.

    Parameters
    ----------
    uri : str
        See `parse_tello`.
    sockets : Sockets, optional
        Used instead of UDP; then no thread watches for silence.
    parameters : TelloParameters, optional
    clock, sleep : callables
        The time, s, and a function that waits; tests replace them.

    Attributes
    ----------
    client : TelloClient
        The dialog with it; `client.state` has attitude, height and battery.
    video : str
        Where its pictures come from, for `matchset.Video`, once `start_video` was called.

    Raises
    ------
    ValueError
        If the URI has another form.
    LinkError
        If a port is in use, or nobody answers.
    """

    def __init__(
        self,
        uri: str = "tello:",
        sockets: Sockets | None = None,
        parameters: TelloParameters | None = None,
        clock: Callable[[], float] = time.monotonic,
        sleep: Callable[[float], None] = time.sleep,
    ) -> None:
        self.uri, self.parameters = uri, parameters or TelloParameters()
        address = parse_tello(uri)
        self.video = f"udp://0.0.0.0:{address.video}"
        self._clock, self._sleep = clock, sleep
        self._phase: Phase = "grounded"
        self._armed, self._end, self._cuts = False, "", 0
        self._since = self._sent_at = clock()
        self._floor_at: float | None = None
        self._held, self._lock, self._closed = False, threading.RLock(), threading.Event()
        watched = sockets is None
        sockets = UdpSockets(address) if sockets is None else sockets
        self.client = TelloClient(uri, sockets, self.parameters, clock, sleep)
        try:
            self.client.find(address)
        except BaseException:
            sockets.close()
            raise
        if watched:
            threading.Thread(target=self._watch, name="matchset tello", daemon=True).start()

    def start_video(self) -> str:
        """Let it send pictures, H.264; returns where they come from, for `matchset.Video`."""
        with self._lock:
            self.client.ask("streamon")
        return self.video

    def status(self) -> LinkStatus:
        """Return the last state; never waits."""
        with self._lock:
            told = self._follow()
            state: State = "failsafe" if self._end else "armed" if self._armed else "locked"
            age = self._clock() - self._sent_at
            return LinkStatus(state, "Tello", self.client.strange, age, self._warnings(told), self._end)

    def arm(self) -> None:
        """Enable the throttle; it takes off with the first command whose throttle is above zero.

        Raises
        ------
        LinkError
            If the battery is too low, or it flies already: then somebody else flies it.
        """
        with self._lock:
            told = self.client.check()
            if told.battery < self.parameters.least_battery:
                raise LinkError(f"{self.uri}: arming refused: battery {100 * told.battery:.0f} %")
            if told.distance > self.parameters.floor and told.height > 0.0:
                raise LinkError(f"{self.uri}: it is {told.height:.1f} m up already: somebody else flies it")
            self._armed, self._phase, self._end, self._cuts, self._floor_at = True, "grounded", "", 0, None

    def send(self, command: Command) -> Command:
        """Send a command; returns what the Tello receives: hundredths of sticks in the air, all zero otherwise.

        While it takes off it takes no sticks; what is returned then holds its place. Once it has landed, by zero
        throttle or by itself, call `arm` again.
        """
        with self._lock:
            self._follow()
            self._sent_at, self._held = self._clock(), False
            if self._cuts:
                self._cuts -= 1
                self.client.send("emergency")
            if not self._armed:
                return Command()
            if self._phase == "grounded" and command.throttle > 0.0:
                self._begin("rising", "takeoff")
            elif self._phase == "flying" and command.throttle == 0.0:
                self._begin("landing", "land")
            if self._phase == "rising":
                return Command(throttle=HOLD)
            return self._send(command) if self._phase == "flying" else Command()

    def land(self, duration: float = 1.5) -> None:
        """Land by its own landing and wait until it has; a duration of 0 stops the motors at once.

        Parameters
        ----------
        duration : float
            Otherwise not used: the Tello chooses its speed.

        Raises
        ------
        LinkError
            If it does not land in time.
        """
        if duration == 0:
            self.cut()
        with self._lock:
            airborne = self._phase in ("rising", "flying") and self._armed
            if airborne:
                self.client.send("rc 0 0 0 0")
                self._begin("landing", "land")
        start = said = self._clock()
        while self._phase == "landing":
            self._sleep(self.parameters.poll_period)
            with self._lock:
                self._follow()
                if self._clock() - said > self.parameters.repeat_period and self._phase == "landing":
                    said = self._clock()
                    self.client.send("land")
            if self._clock() - start > self.parameters.landing_timeout:
                raise LinkError(f"{self.uri}: it did not land: {self.client.answer or 'no answer'}")
        self._armed = False

    def cut(self) -> None:
        """Stop the motors at once: it falls. `send` repeats it; never waits, and needs no lock."""
        self._cuts, self._armed, self._phase = self.parameters.cuts, False, "grounded"
        with contextlib.suppress(LinkError):  # the next `send` raises it
            self.client.send("emergency")

    def close(self) -> None:
        """Land and close the sockets; one that is silent is told to land, since it may still hear."""
        if not self._open:
            return
        self._open = False
        try:
            if not self.client.broken:
                self.land()
            elif self._armed:
                for _ in range(self.parameters.cuts):
                    with contextlib.suppress(LinkError):
                        self.client.send("land")
        finally:
            self._closed.set()
            self.client.close()

    def watch(self) -> None:
        """Make the sticks neutral, then land, if no command came for too long; the link's thread calls it."""
        with self._lock:
            self._follow()
            silence, p = self._clock() - self._sent_at, self.parameters
            if self._phase != "flying" or silence <= p.hold_time:
                return
            if silence > p.silence_time:
                self._end = f"no command came for {silence:.1f} s: it was landed"
                self._begin("landing", "land")
            elif not self._held:
                self._held = True
                self.client.send("rc 0 0 0 0")

    def _watch(self) -> None:
        while not self._closed.wait(self.parameters.hold_time / 3.0):
            with contextlib.suppress(LinkError):
                self.watch()

    def _begin(self, phase: Phase, words: str) -> None:
        """Send a command that takes a while; its answer ends the phase."""
        self._phase, self._since, self._floor_at = phase, self._clock(), None
        self.client.say(words)

    def _send(self, command: Command) -> Command:
        right, forward, up, clockwise = speeds(command)
        self.client.send(f"rc {right} {forward} {up} {clockwise}")
        return Command(right / FULL, forward / FULL, clockwise / FULL, HOLD + HOLD * up / FULL)

    def _follow(self) -> TelloState:
        """Receive, and go on to the next phase when its time has come."""
        told, p, now = self.client.check(), self.parameters, self._clock()
        answer = self.client.answer.lower()
        if told.distance > p.floor:
            self._floor_at = None
        elif self._floor_at is None:
            self._floor_at = now
        landed = self._floor_at is not None and now - self._floor_at > p.grounded_time
        if self._phase == "rising":
            if answer.startswith("ok"):
                self._phase, self._floor_at = "flying", None
            elif answer or now - self._since > p.takeoff_timeout:
                self._finish(f"it did not take off: {self.client.answer or 'no answer'}")
        elif self._phase == "flying" and landed:
            self._finish(f"it has landed by itself (battery {100 * told.battery:.0f} %)")
        elif self._phase == "landing" and (landed or (answer.startswith("ok") and now - self._since > p.settle_time)):
            self._finish(self._end)
        return told

    def _finish(self, why: str) -> None:
        self._phase, self._armed, self._end = "grounded", False, why

    def _warnings(self, told: TelloState) -> tuple[str, ...]:
        low = told.battery < self.parameters.low_battery
        return (f"battery {100 * told.battery:.0f} %",) if low else ()
