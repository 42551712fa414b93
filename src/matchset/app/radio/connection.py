"""The radio as the commands see it: a link, and the time that goes with it."""

import time
from collections.abc import Callable

import msgspec

from matchset.links.arduino.arduino_link import ArduinoLink
from matchset.links.arduino.messages import Report

REFUSED = 1
"""Exit code: the firmware refused, or heard something else."""


class Radio(msgspec.Struct):
    """An open link with its clock, s, and a way to let time pass."""

    link: ArduinoLink
    clock: Callable[[], float] = time.monotonic
    sleep: Callable[[float], None] = time.sleep

    def wait(self, done: Callable[[Report], bool], limit: float) -> bool:
        """Listen until a report is as wanted; False after `limit`, s."""
        start = self.clock()
        while not done(self.link.report):
            if self.clock() - start > limit:
                return False
            self.sleep(0.02)
        return True


def open_radio(port: str) -> Radio:
    """Open the transmitter on a serial port, e.g. ``/dev/ttyUSB0``."""
    return Radio(ArduinoLink(port))
