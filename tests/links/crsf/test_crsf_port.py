"""The link on a pseudo-terminal, in real time, with its thread: the module at the other end answers."""

import os
import signal
import subprocess
import sys
import time

import pytest

from matchset.control.command import Command
from matchset.image.errors import LinkError
from matchset.links.connect import connect
from matchset.links.crsf.crsf_link import CrsfLink
from radio_modules import Module, PtyModule

HOVER = Command(throttle=0.5)


def fly(link: CrsfLink, seconds: float) -> None:
    end = time.monotonic() + seconds
    while time.monotonic() < end:
        link.send(HOVER)
        time.sleep(0.02)


@pytest.mark.parametrize("baud", [921_600, 400_000, 115_200])
def test_it_arms_flies_and_lands(baud: int) -> None:
    with PtyModule() as wire:
        with connect(f"{wire.uri}?baud={baud}") as link:
            link.arm()
            assert isinstance(link, CrsfLink)
            fly(link, 0.5)
            assert wire.module.armed
            assert wire.module.throttle == 992
            assert link.news.battery is not None
        assert not wire.module.armed


def test_frames_keep_their_rate_while_the_caller_does_nothing() -> None:
    with PtyModule() as wire, CrsfLink(wire.uri):
        time.sleep(0.5)
        before = len(wire.module.heard)
        time.sleep(2.0)
        assert 30 < len(wire.module.heard) - before <= 510  # 500 on a computer that does nothing else


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
        fly(link, 0.2)
        wire.unplug()
        with pytest.raises(LinkError, match="has gone"):
            fly(link, 2.0)
        link.close()


def test_a_port_that_takes_no_more_is_said() -> None:
    wire = PtyModule(Module())
    with wire:
        link = CrsfLink(wire.uri)
        wire._stop.set()  # nobody reads any more
        wire._thread.join()
        with pytest.raises(LinkError, match=r"has gone|silent"):
            fly(link, 30.0)
        link.close()
        wire._stop.clear()
        wire._thread = type(wire._thread)(target=wire._run, daemon=True)
        wire._thread.start()


PROGRAM = """
import sys, time
from matchset.control.command import Command
from matchset.links.connect import connect
with connect(sys.argv[1]) as link:
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
            time.sleep(0.3)
            os.kill(program.pid, number)
            wire.wait(armed=False)
            assert (wire.module.heard[-1][1][4] < 500) == landed
        finally:
            program.kill()
            program.wait()
