"""The simulated link keeps the contract of every link; the simulated camera is one that can be pulled."""

import numpy as np
import pytest

from matchset.control.command import Command
from matchset.image.errors import LinkError
from matchset.links.connect import connect
from matchset.links.simulated import SimulatedChain, SimulationParameters, parse_uri
from matchset.links.simulated_link import SimulatedLink

SMALL = SimulationParameters(vehicles=2, width=160, height=120, pal="clean")


def test_a_uri_says_what_is_simulated() -> None:
    said = parse_uri("sim://chain?vehicles=5&seed=7&pal=bad&latency_ms=133")
    assert (said.vehicles, said.seed, said.pal, said.latency_ms) == (5, 7, "bad", 133.0)
    assert parse_uri("sim://chain") == SimulationParameters()


@pytest.mark.parametrize(
    ("uri", "words"),
    [
        ("sim://ring", "sim://chain"),
        ("sim://chain?colour=red", "colour"),
        ("sim://chain?vehicles=1", "vehicles"),
        ("sim://chain?pal=awful", "pal"),
        ("sim://chain?latency_ms=nan", "latency_ms"),
        ("sim://chain?width=32", "width"),
    ],
)
def test_a_uri_that_is_wrong_is_refused_with_its_key(uri: str, words: str) -> None:
    with pytest.raises(ValueError, match=words):
        parse_uri(uri)


def test_pictures_have_their_times_and_commands_leave_as_late_as_asked() -> None:
    chain = SimulatedChain(SMALL)
    camera = chain.cameras[0]
    frames = [camera.read() for _ in range(3)]
    assert [frame.time for frame in frames if frame is not None] == pytest.approx([1 / 30, 2 / 30, 3 / 30])
    assert chain.now() == pytest.approx(0.1 + 0.067, abs=1 / 480)
    assert frames[0] is not None
    assert frames[0].image.shape == (120, 160, 3)
    chain.close()


def test_no_command_leaves_before_the_second_field_is_exposed() -> None:
    chain = SimulatedChain(SimulationParameters(vehicles=2, width=160, height=120, latency_ms=0.0))
    assert chain.cameras[0].read() is not None
    assert chain.now() == pytest.approx(1 / 30 + 4 / 480)
    chain.close()


def test_a_pulled_cable_is_no_picture_while_time_goes_on() -> None:
    chain = SimulatedChain(SimulationParameters(vehicles=2, width=160, height=120, pal="clean", cable=0.05))
    camera = chain.cameras[0]
    assert camera.read() is not None
    assert camera.read() is None
    before = chain.now()
    assert camera.read() is None
    assert chain.now() > before
    chain.close()


def test_the_same_seed_gives_the_same_pictures() -> None:
    pictures = []
    for seed in (1, 1, 2):
        chain = SimulatedChain(SimulationParameters(vehicles=2, width=160, height=120, pal="typical", seed=seed))
        frame = chain.cameras[0].read()
        assert frame is not None
        pictures.append(frame.image)
        chain.close()
    np.testing.assert_array_equal(pictures[0], pictures[1])
    assert (pictures[0] != pictures[2]).any()


def test_throttle_needs_arming_and_sticks_come_back_quantized() -> None:
    chain = SimulatedChain(SMALL)
    link = chain.links[0]
    assert link.send(Command(throttle=0.5)) == Command()
    link.arm()
    sent = link.send(Command(0.1, 0.0, 0.0, 0.5))
    assert sent.throttle == pytest.approx(0.5, abs=1 / 255)
    assert sent.throttle * 255 == pytest.approx(round(sent.throttle * 255))
    assert link.status().state == "armed"
    chain.close()


def test_leaving_the_with_block_lands_however_it_is_left() -> None:
    chain = SimulatedChain(SMALL)
    link = chain.links[0]

    def fails() -> None:
        with link:
            link.arm()
            for _ in range(10):
                chain.cameras[0].read()
                link.send(Command(throttle=0.6))
            raise RuntimeError

    with pytest.raises(RuntimeError):
        fails()
    with pytest.raises(LinkError):
        link.send(Command())
    chain.world.advance(chain.world.step + 3 * 480)
    assert chain.world._active[0] == Command()
    chain.close()


def test_connect_opens_a_chain() -> None:
    link = connect("sim://chain?vehicles=2&width=160&height=120")
    assert isinstance(link, SimulatedLink)
    with link:
        assert link.status().state == "locked"
        assert link.chain.cameras[0].model.width == 160
    link.chain.close()
