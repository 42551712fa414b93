"""Sessions of the whole firmware on this computer: bytes in; packets, and what the status frames say, out."""

from nrf24 import Nrf24
from sessions import Session, on_host, slot
from syma import BIND_ADDRESS
from vectors import VECTORS

from flight import frame
from matchset.control.command import Command
from matchset.links import crsf_frame as crsf
from matchset.links.arduino.messages import STATUS, Config, StatusReport

BIND_PACKETS = 345
BOUND = 360  # slots after power on
IDLE, FLYING = Command(), Command(throttle=0.1)


def play(session: Session, slots: int) -> tuple[Nrf24, list[StatusReport]]:
    """The radio at the end, and every status on the way."""
    radio, said = on_host(session, slot(slots, 1500))
    return radio, [StatusReport.decode(payload) for kind, payload in crsf.CrsfParser().feed(said) if kind == STATUS]


def test_binding_at_power_on_ends_by_itself_after_its_packets() -> None:
    radio, reports = play([], 420)
    addresses = [packet.address for packet in radio.packets]
    assert addresses[: BIND_PACKETS + 2] == [BIND_ADDRESS] * BIND_PACKETS + [Config().id] * 2
    assert set(addresses[BIND_PACKETS:]) == {Config().id}
    states = [report.state for report in reports]
    assert states == sorted(states)  # binding, then locked
    assert set(states) == {"binding", "locked"}


def test_bind_packets_hop_as_a_handset_s_and_the_fourth_channel_alternates() -> None:
    radio, _ = play([], 40)
    agreed = [channel for channel in VECTORS["radio"]["bind_channels"] for _ in range(2)]
    one, other = ([channel] * 2 for channel in Config().bind_channels)
    assert [packet.channel for packet in radio.packets[:32]] == 2 * [*agreed, *one, *agreed, *other]


def test_the_answer_to_a_frame_says_what_it_led_to_and_how_many_were_heard() -> None:
    flights = [(IDLE, False)] * 4 + [(IDLE, True), (FLYING, True), (FLYING, True), (IDLE, False)]
    session = [
        (slot(BOUND + 8 * number), frame(command, armed, ch16=crsf.CHANNEL_LOW + number))
        for number, (command, armed) in enumerate(flights)
    ]
    _, reports = play(session, BOUND + 8 * len(flights))
    answers = {report.echo - crsf.CHANNEL_LOW: report for report in reversed(reports) if report.echo}  # the first ones
    assert [answers[number].state for number in range(8)] == ["locked"] * 4 + ["armed"] * 3 + ["locked"]
    assert [answers[number].good for number in range(8)] == list(range(1, 9))
    assert [answers[number].may_arm for number in range(8)] == [False] * 2 + [True] * 2 + [False] * 4
