"""The link on a pseudo-terminal, in real time, with its thread: the module at the other end answers."""

import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable

import pytest

from matchset.control.command import Command
from matchset.image.errors import LinkError
from matchset.links.connect import connect
from matchset.links.crsf.crsf_link import CrsfLink
from radio_modules import Module, PtyModule

HOVER = Command(throttle=0.5)


def fly_until(link: CrsfLink, done: Callable[[], bool]) -> None:
    """Send one command, at the rate of pictures, until something is so, or the link is broken."""
    end = time.monotonic() + 30.0
    while not done():
        assert time.monotonic() < end
        link.send(HOVER)
        time.sleep(0.02)


def test_it_arms_flies_and_lands() -> None:
    with PtyModule() as wire:
        with connect(wire.uri) as link:
            link.arm()
            assert isinstance(link, CrsfLink)
            fly_until(link, lambda: link.news.battery is not None and wire.module.throttle == 992)
            assert wire.module.armed
            link.land(0.2)
        assert not wire.module.armed


def test_the_port_is_opened_at_another_rate() -> None:
    with PtyModule() as wire, connect(f"{wire.uri}?baud=400000") as link:
        assert isinstance(link, CrsfLink)
        fly_until(link, lambda: len(wire.module.heard) > 5)
        assert wire.module.throttle == 0


def test_frames_go_on_while_the_caller_does_nothing() -> None:
    with PtyModule() as wire, CrsfLink(wire.uri):
        before = len(wire.module.heard)
        end = time.monotonic() + 30.0
        while len(wire.module.heard) < before + 60:
            assert time.monotonic() < end
            time.sleep(0.01)


def test_two_programs_on_one_port_are_refused() -> None:
    with PtyModule() as wire, CrsfLink(wire.uri):
        with pytest.raises(LinkError, match=f"cannot open {wire.path}: another program uses it"):
            CrsfLink(wire.uri)
        code = f"from matchset.links.connect import connect; connect('{wire.uri}')"
        other = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, timeout=60, check=False)
        assert "another program uses it" in other.stderr


def test_an_unplugged_module_is_said() -> None:
    wire = PtyModule()
    with wire:
        link = CrsfLink(wire.uri)
        link.arm()
        fly_until(link, lambda: wire.module.throttle == 992)
        wire.unplug()
        with pytest.raises(LinkError, match="has gone"):
            fly_until(link, lambda: False)
        link.close()


def test_a_port_that_takes_no_more_is_said() -> None:
    wire = PtyModule(Module())
    with wire:
        link = CrsfLink(wire.uri)
        wire._stop.set()  # nobody reads any more
        wire._thread.join()
        with pytest.raises(LinkError, match=r"has gone|silent"):
            fly_until(link, lambda: False)
        link.close()
        wire._stop.clear()
        wire._thread = type(wire._thread)(target=wire._run, daemon=True)
        wire._thread.start()


# It is patient with the module, a thread of this test: on a busy computer that waits for its turn.
PROGRAM = """
import sys, time
from matchset.control.command import Command
from matchset.links.connect import connect
with connect(sys.argv[1] + "?timeout=20&vehicle_timeout=20") as link:
    link.arm()
    while True:
        link.send(Command(throttle=0.5))
        time.sleep(0.02)
"""


@pytest.mark.parametrize(
    ("number", "landed"), [(signal.SIGTERM, True), (signal.SIGKILL, False), (signal.SIGSTOP, False)]
)
def test_a_program_that_ends_lands_and_one_that_is_killed_is_silent(number: int, landed: bool) -> None:
    with PtyModule() as wire:
        program = subprocess.Popen([sys.executable, "-c", PROGRAM, wire.uri])
        try:
            wire.wait(armed=True)
            wire.wait_for_throttle(992)
            os.kill(program.pid, number)
            wire.wait(armed=False)
            assert (wire.module.heard[-1][1][4] < 500) == landed
        finally:
            program.kill()
            program.wait()
