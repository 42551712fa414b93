"""Links other than the Arduino's under `matchset fly`: an autopilot in a dry run."""

import socket
import threading
import time
from collections.abc import Iterator

import pytest

from matchset.app.flight.linked.opening import open_link
from matchset.control.command import Command
from matchset.links.mavlink.packet import Packet, Parser, Writer


@pytest.fixture
def autopilot() -> Iterator[tuple[int, list[Packet]]]:
    """An autopilot at a UDP port, which says that it is there and keeps what it hears."""
    done, heard, parser, heart = threading.Event(), list[Packet](), Parser(), Writer(1, 1)
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as there:
        there.bind(("127.0.0.1", 0))
        there.settimeout(0.2)

        def live() -> None:
            sender, said = None, 0.0
            while not done.is_set():
                try:
                    data, sender = there.recvfrom(1000)
                    heard.extend(parser.feed(data))
                except TimeoutError:
                    pass
                if sender is not None and time.monotonic() - said > 0.5:
                    said = time.monotonic()
                    there.sendto(heart.write("HEARTBEAT", {"type": 2, "autopilot": 3}), sender)

        thread = threading.Thread(target=live)
        thread.start()
        try:
            yield there.getsockname()[1], heard
        finally:
            done.set()
            thread.join()


def test_in_a_dry_run_an_autopilot_is_sent_neither_sticks_nor_a_mode(autopilot: tuple[int, list[Packet]]) -> None:
    number, heard = autopilot
    with open_link(f"mavlink:udpout:127.0.0.1:{number}", dry=True) as link:
        link.arm()
        for _ in range(60):
            assert link.send(Command(throttle=0.5)) == Command()
            assert link.status().state == "armed"
            assert link.status().refusal == ""
            time.sleep(0.02)
        link.cut()
    names = {packet.message.name for packet in heard}
    assert "HEARTBEAT" in names
    assert "MANUAL_CONTROL" not in names
    assert {packet.values["command"] for packet in heard if packet.message.name == "COMMAND_LONG"} == {511}
