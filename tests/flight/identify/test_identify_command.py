"""`matchset identify`: a simulated vehicle, a real one behind a pseudo-terminal, and what is refused."""

import signal
from collections.abc import Callable, Iterator
from contextlib import nullcontext
from pathlib import Path

import pytest
from pty_transmitter import PtyTransmitter

from blue_ball import Matchset
from flight_process import FlightProcess, errors
from linked_world import WORLD as LINKED_WORLD
from linked_world import HeldLink, made
from matchset.control.command import Command
from matchset.flight.chain.config import read_flight
from matchset.flight.chain.flight_parameters import FlightParameters
from matchset.flight.linked.linked_flight import LinkedFlight
from matchset.links.link import Link
from matchset.links.simulated import SimulatedChain
from mjpeg_server import MjpegServer

WORLD = "sim://chain?thrust=0.85&radio_delay_ms=90&full_yaw_rate=1.15&yaw_trim_deg_s=4"
SMALL = f"{WORLD}&width=320&height=240"
KILLED = 60  # commands
SHORT = """
[flight.linked]
countdown = 0.5
[flight.pilot.safety]
max_frame_age = 1.0
"""


def test_a_simulated_vehicle_is_identified_and_flown_by_its_file(
    matchset: Matchset, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert matchset("identify", WORLD, "--quick", "--duration", 6) == 0
    out = capsys.readouterr().out
    assert "hover_throttle" in out
    assert "67 of them its age" in out
    own = read_flight(tmp_path / "vehicle.toml").pilot.follower
    assert own.hover_throttle == pytest.approx(0.70, abs=0.03)
    assert own.ego_motion.delay == pytest.approx(0.088, abs=0.008)
    assert own.ego_motion.full_yaw_rate == pytest.approx(1.15 * 2.007, rel=0.05)
    assert read_flight(tmp_path / "vehicle.toml").world == FlightParameters().world
    text = (tmp_path / "vehicle.toml").read_text()
    assert matchset("identify", WORLD, "--quick") == 2
    assert "vehicle.toml" in capsys.readouterr().err
    assert (tmp_path / "vehicle.toml").read_text() == text


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (("sim://chain?vehicles=3",), "one vehicle is identified at a time"),
        (("sim://room",), "sim://chain"),
        ((), "say whom to identify"),
        (("--seed", "3"), "say whom to identify"),
        (("serial:///dev/ttyUSB0",), "needs a camera and a link: --camera 0 is missing"),
        (("serial:///dev/ttyUSB0", "--link", "serial:///dev/ttyUSB1"), "named twice"),
        (("tello:", "--camera", "0"), "this one is told speeds"),
        (("crsf:///dev/x", "--camera", "0"), "say what camera 0 is like"),
        (("sim://chain", "--arm"), "is a simulated chain"),
        (("sim://chain", "--duration", "0"), "duration"),
        (("sim://chain", "--from", "flight.mcap"), "--from flies nothing"),
        (("--from", "flight.mcap"), "flight.mcap"),
    ],
)
def test_what_does_not_fit_is_one_line(
    matchset: Matchset, capsys: pytest.CaptureFixture[str], words: tuple[str, ...], said: str
) -> None:
    assert matchset("identify", *words) == 2
    err = capsys.readouterr().err
    assert said in err
    assert len([line for line in err.splitlines() if line.startswith("error: ")]) == 1
    assert not Path("vehicle.toml").exists()


def test_a_recorded_flight_tells_the_same_again(
    matchset: Matchset, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    pytest.importorskip("mcap")
    assert matchset("identify", SMALL, "--duration", 5, "--record", "flight.mcap", "--quiet") == 0
    first = capsys.readouterr().out
    assert matchset("replay", "flight.mcap", "--quiet") == 0, "bit for bit, its sticks shaken"
    capsys.readouterr()
    assert matchset("identify", "--from", "flight.mcap", "-o", "again.toml") == 0
    again = capsys.readouterr().out
    assert [line for line in again.splitlines() if "+-" in line] == [
        line for line in first.splitlines() if "+-" in line
    ]
    texts = [(tmp_path / name).read_text().partition("\n")[2] for name in ("vehicle.toml", "again.toml")]
    assert texts[0] == texts[1]


def test_a_flight_that_is_too_short_says_so_and_writes_nothing(
    matchset: Matchset, capsys: pytest.CaptureFixture[str]
) -> None:
    assert matchset("identify", "sim://chain", "--quick", "--duration", 2) == 1
    assert "pictures of a flight are too few" in capsys.readouterr().err
    assert not Path("vehicle.toml").exists()


@pytest.fixture
def line(tmp_path: Path, camera: MjpegServer, transmitter: PtyTransmitter, files: list[str]) -> list[str]:
    """The command with all that a flight needs."""
    (tmp_path / "short.toml").write_text(SHORT)
    words = ["identify", f"serial://{transmitter.path}", "--camera", camera.url, "--config", "short.toml"]
    return [*words, *files]


@pytest.mark.usefixtures("signals_end_programs")
def test_a_port_that_vanishes_is_one_line_and_leaves_no_file(
    tmp_path: Path, line: list[str], transmitter: PtyTransmitter
) -> None:
    flown = FlightProcess(tmp_path, *line, "--arm")
    flown.flies(transmitter)
    transmitter.unplug()
    code, out, err = flown.ended()
    assert code == 3, out + err
    assert len(errors(err)) == 1
    assert "has gone (unplugged?)" in errors(err)[0]
    assert not (tmp_path / "vehicle.toml").exists()


Real = Callable[..., int]


@pytest.fixture
def real(matchset: Matchset, monkeypatch: pytest.MonkeyPatch) -> Iterator[Real]:
    """Run the command for a real vehicle, with this link, on the clock of a simulated world; returns the exit code."""
    chain = SimulatedChain(LINKED_WORLD)

    def run(link: Link, *words: object) -> int:
        def opened(flight: FlightParameters, _followers: object, dry: bool) -> LinkedFlight:
            return made(chain, link, dry, flight)

        monkeypatch.setattr("matchset.flight.identify.run.open_flight", opened)
        return matchset("identify", "serial:///dev/ttyUSB0", "--camera", "0", *words)

    monkeypatch.setattr("matchset.flight.real_time.priority.raised_priority", nullcontext)  # it never waits
    yield run
    chain.close()


def test_a_dry_run_sends_no_throttle_and_identifies_nothing(real: Real, capsys: pytest.CaptureFixture[str]) -> None:
    link = HeldLink()
    assert real(link, "--duration", 3) == 0
    assert len(link.commands) > 80
    assert set(link.commands) == {Command()}
    assert "without throttle nothing can be identified; --arm flies" in capsys.readouterr().out
    assert not Path("vehicle.toml").exists()


def test_a_ball_that_does_not_answer_to_the_sticks_is_not_believed(real: Real) -> None:
    link = HeldLink()
    assert real(link, "--arm", "--duration", 6) == 1
    assert max(command.throttle for command in link.commands) > 0.3
    assert link.commands[-1] == Command()
    file = Path("vehicle.toml")
    assert not file.exists() or read_flight(file) == FlightParameters(), "nothing of it is flown by"


def test_a_kill_stops_the_motors_at_once(real: Real, capsys: pytest.CaptureFixture[str]) -> None:
    def kill(count: int) -> None:
        if count == KILLED:
            signal.raise_signal(signal.SIGUSR1)
            assert link.was_cut.wait(20.0)

    link = HeldLink(kill)
    assert real(link, "--arm") == 1
    assert link.commands[KILLED - 1].throttle > 0.3
    assert set(link.commands[KILLED:]) == {Command()}
    assert "vehicle 1 was cut: SIGUSR1 came" in capsys.readouterr().out
