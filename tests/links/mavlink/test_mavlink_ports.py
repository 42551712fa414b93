"""URIs, UDP sockets and a serial port that are real."""

import os
import socket
import sys
import threading
import time
from collections.abc import Iterator

import pytest

from matchset.image.errors import LinkError
from matchset.links.connect import connect
from matchset.links.mavlink.address import Address, parse_address
from matchset.links.mavlink.checksum import accumulate
from matchset.links.mavlink.mavlink_link import MavlinkLink
from matchset.links.mavlink.packet import PacketWriter
from matchset.links.mavlink.ports import UdpPort, open_port

HEART = PacketWriter(1, 1).write("HEARTBEAT", {"type": 2, "autopilot": 3, "mavlink_version": 3})


@pytest.mark.parametrize(
    ("uri", "address"),
    [
        ("mavlink:udpin:0.0.0.0:14550", Address("udpin", "0.0.0.0", 14550)),
        ("mavlink:udpout:drone.local:14540", Address("udpout", "drone.local", 14540)),
        ("mavlink:serial:/dev/ttyACM0:115200", Address("serial", "/dev/ttyACM0", 115200)),
        ("mavlink:serial:/dev/ttyACM0", Address("serial", "/dev/ttyACM0", 57600)),
        ("mavlink:serial:COM3:921600?vehicle=7&system=1", Address("serial", "COM3", 921600, 7, 1)),
        ("mavlink:udpin:0.0.0.0:14550?mode=0", Address("udpin", "0.0.0.0", 14550, mode=0)),
    ],
)
def test_a_uri_says_where(uri: str, address: Address) -> None:
    assert parse_address(uri) == address


@pytest.mark.parametrize(
    "uri",
    [
        "mavlink:",
        "mavlink:udpin",
        "mavlink:udpin:14550",
        "mavlink:udpin:0.0.0.0:0",
        "mavlink:udpin:0.0.0.0:65536",
        "mavlink:udpin:0.0.0.0:x",
        "mavlink:tcp:10.0.0.2:5760",
        "mavlink:serial:",
        "mavlink://udpin:0.0.0.0:14550",
        "udpin:0.0.0.0:14550",
        "mavlink:udpin:0.0.0.0:²",
    ],
)
def test_what_is_no_address_is_refused(uri: str) -> None:
    with pytest.raises(ValueError, match="an autopilot is named like mavlink:udpin"):
        parse_address(uri)


@pytest.mark.parametrize("question", ["vehicle=0", "vehicle=256", "system=", "system=-1", "mode=4294967296", "speed=1"])
def test_numbers_that_nobody_has_are_refused(question: str) -> None:
    with pytest.raises(ValueError, match=r"must be within|come vehicle, system, mode"):
        parse_address(f"mavlink:udpin:0.0.0.0:14550?{question}")


def free_port() -> int:
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
        probe.bind(("127.0.0.1", 0))
        return int(probe.getsockname()[1])


@pytest.fixture
def vehicle() -> Iterator[socket.socket]:
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as other:
        other.bind(("127.0.0.1", 0))
        other.settimeout(20.0)
        yield other


def read_all(port: UdpPort, count: int) -> list[tuple[str, bytes]]:
    found: list[tuple[str, bytes]] = []
    until = time.monotonic() + 20.0
    while len(found) < count and time.monotonic() < until:
        found += port.read()
    return found


def test_two_programs_on_one_port_are_an_error() -> None:
    number = free_port()
    first = UdpPort(Address("udpin", "127.0.0.1", number))
    with pytest.raises(LinkError, match=f"cannot open udpin 127.0.0.1:{number}: another program uses it"):
        connect(f"mavlink:udpin:127.0.0.1:{number}")
    first.close()


def test_a_computer_that_does_not_exist_is_an_error() -> None:
    with pytest.raises(LinkError, match=r"cannot open udpout nobody\.invalid:14550"):
        UdpPort(Address("udpout", "nobody.invalid", 14550))


def test_only_the_sender_that_was_chosen_is_heard_and_spoken_to(vehicle: socket.socket) -> None:
    number = free_port()
    port = UdpPort(Address("udpin", "127.0.0.1", number))
    port.write(HEART)  # nobody yet
    vehicle.sendto(b"a", ("127.0.0.1", number))
    ((sender, data),) = read_all(port, 1)
    assert data == b"a"
    port.write(b"all")  # who speaks is answered, before one is chosen
    assert vehicle.recvfrom(300)[0] == b"all"
    port.choose(sender)
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as stranger:
        stranger.sendto(b"b", ("127.0.0.1", number))
        vehicle.sendto(b"c", ("127.0.0.1", number))
        assert read_all(port, 1) == [(sender, b"c")]
    assert port.strangers == 1
    port.write(HEART)
    assert vehicle.recvfrom(300)[0] == HEART
    port.close()


def test_one_that_speaks_the_old_version_until_it_hears_the_new_one_is_found(vehicle: socket.socket) -> None:
    number, done = free_port(), threading.Event()
    body = bytes.fromhex("09000101000000000002035104") + b"\x03"
    old = b"\xfe" + body + accumulate(b"\x32", accumulate(body)).to_bytes(2, "little")
    vehicle.settimeout(0.1)

    def speak() -> None:
        said = old
        while not done.is_set():
            vehicle.sendto(said, ("127.0.0.1", number))
            try:
                if vehicle.recvfrom(300)[0][0] == 0xFD:
                    said = HEART
            except TimeoutError:
                pass

    thread = threading.Thread(target=speak)
    thread.start()
    try:
        link = MavlinkLink(f"mavlink:udpin:127.0.0.1:{number}")
    finally:
        done.set()
        thread.join()
    assert link.client.system == 1
    link.close()


def test_who_does_not_listen_yet_is_only_silent() -> None:
    port = UdpPort(Address("udpout", "127.0.0.1", free_port()))
    for _ in range(5):
        port.write(HEART)
        time.sleep(0.01)
        assert port.read() == []
    port.close()


def test_a_vehicle_that_is_spoken_to_first_answers(vehicle: socket.socket) -> None:
    """Over real sockets, at the speed of real time: found, then silent."""
    done = threading.Event()

    def answer() -> None:
        _, sender = vehicle.recvfrom(300)
        while not done.wait(0.2):
            vehicle.sendto(HEART, sender)

    thread = threading.Thread(target=answer)
    thread.start()
    try:
        link = MavlinkLink(f"mavlink:udpout:127.0.0.1:{vehicle.getsockname()[1]}")
    finally:
        done.set()
        thread.join()
    assert link.status().state == "locked"
    link.close()


@pytest.mark.skipif(sys.platform == "win32", reason="Windows has no pseudoterminals")
def test_a_serial_port_speaks_and_is_for_one_program() -> None:
    outer, inner = os.openpty()
    path = os.ttyname(inner)
    port = open_port(Address("serial", path, 57600))
    os.write(outer, HEART)
    until = time.monotonic() + 20.0
    found: list[tuple[str, bytes]] = []
    while not found and time.monotonic() < until:
        found = port.read()
    assert found == [(path, HEART)]
    port.choose(path)
    port.write(b"back")
    assert os.read(outer, 10) == b"back"
    with pytest.raises(LinkError, match=f"cannot open {path}"):
        open_port(Address("serial", path, 57600))
    port.close()
    os.close(outer)
    os.close(inner)


def test_a_serial_port_that_is_not_there_is_an_error() -> None:
    with pytest.raises(LinkError, match="cannot open /dev/nothing: No such file"):
        connect("mavlink:serial:/dev/nothing:57600")
