"""The transmitter as the commands use it: its link with a clock: `Radio`, `open_radio`."""

import time
from collections.abc import Callable

import msgspec

from matchset.links.arduino.arduino_link import ArduinoLink
from matchset.links.arduino.messages import StatusReport
from matchset.links.link import wait_until

REFUSED = 1  # format: exit code if the firmware refused, or heard something else


class Radio(msgspec.Struct):
    """An open link with a clock, s, and a function that waits, s; tests give others."""

    link: ArduinoLink
    clock: Callable[[], float] = time.monotonic
    sleep: Callable[[float], None] = time.sleep

    def wait(self, done: Callable[[StatusReport], bool], timeout: float) -> bool:
        """Listen until a report fulfills `done`; False after `timeout`, s."""
        return wait_until(lambda: done(self.link.report), timeout, self.clock, lambda: self.sleep(0.02))


def open_radio(port: str) -> Radio:
    """Open the transmitter on a serial port, e.g. ``/dev/ttyUSB0``."""
    return Radio(ArduinoLink(port))
