"""The simulated link keeps the contract of every link; the simulated camera is one that can be pulled."""

import numpy as np
import pytest

from matchset.control.command import Command
from matchset.image.errors import LinkError
from matchset.image.frame import Frame
from matchset.links.connect import connect
from matchset.links.simulated import SimulatedChain, SimulatedLink
from matchset.links.simulation_parameters import SimulationParameters, parse_uri

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


def pictures_of(chain: SimulatedChain, count: int) -> list[Frame]:
    """Read pictures; the second camera is read too, as in a flight."""
    frames = []
    for _ in range(count):
        for who, camera in enumerate(chain.cameras):
            frame = camera.read()
            assert frame is not None
            if who == 0:
                frames.append(frame)
    chain.close()
    return frames


def sent_again(fault: str) -> list[int]:
    """Which picture of a chain without faults each of twelve is, from 1; their times must be right."""
    uri = "sim://chain?vehicles=3&width=160&height=120&pal=clean"
    honest, faulty = (pictures_of(SimulatedChain(parse_uri(uri + query)), 12) for query in ("", fault))
    assert [frame.time for frame in faulty] == [frame.time for frame in honest]
    assert [frame.index for frame in faulty] == [frame.index for frame in honest]
    return [1 + [(each.image == frame.image).all() for each in honest].index(True) for frame in faulty]


def test_a_grabber_freezes_for_a_while() -> None:
    assert sent_again("&freeze=0.12&freeze_for=0.15") == [1, 2, 3, 3, 3, 3, 3, 3, 9, 10, 11, 12]
    assert sent_again("&freeze=0.2") == [1, 2, 3, 4, 5, 5, 5, 5, 5, 5, 5, 5]
    assert sent_again("&freeze=0") == [1] * 12


def test_a_grabber_delivers_old_pictures_as_new_ones() -> None:
    assert sent_again("&stale=0.2&stale_age=0.1") == [1, 2, 3, 4, 5, 3, 4, 5, 6, 7, 8, 9]
    assert sent_again("&stale=0.2&stale_age=0.1&stale_for=0.09") == [1, 2, 3, 4, 5, 3, 4, 5, 9, 10, 11, 12]
    assert sent_again("&stale=0&stale_age=0.1") == [1, 1, 1, 1, 2, 3, 4, 5, 6, 7, 8, 9]
    assert sent_again("&stale=0.1&stale_age=0.1&freeze=0.25&freeze_for=0.05") == [1, 2, 1, 1, 2, 3, 4, 4, 6, 7, 8, 9]


@pytest.mark.parametrize("words", ["freeze=-1", "freeze_for=nan", "stale=x", "stale_age=11", "stale_for=-0.1"])
def test_a_fault_out_of_range_is_refused(words: str) -> None:
    with pytest.raises(ValueError, match=words.partition("=")[0]):
        parse_uri(f"sim://chain?{words}")


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


def test_half_frames_are_the_fields_of_the_same_pictures_as_soon_as_each_is_there() -> None:
    said = SimulationParameters(vehicles=2, width=160, height=120, latency_ms=100.0)
    whole, halves = SimulatedChain(said), SimulatedChain(parse_uri("sim://chain?vehicles=2&width=160&height=120"
                                                                  "&latency_ms=100&fields=top"))  # fmt: skip
    camera, age = halves.cameras[0], 0.1 - 4 / 480
    for index in range(1, 5):
        frame = whole.cameras[0].read()
        assert frame is not None
        for k, rows in enumerate(("top", "bottom")):
            half = camera.read()
            assert half is not None
            assert (half.index, half.rows) == (2 * index - 1 + k, rows)
            assert half.time == pytest.approx(frame.time + (2 * k - 1) / 120)
            assert halves.now() - half.time == pytest.approx(age, abs=1 / 480)
            np.testing.assert_array_equal(half.image[k::2], frame.image[k::2])
            if rows == "bottom":
                np.testing.assert_array_equal(half.image, frame.image)
    whole.close()
    halves.close()


@pytest.mark.parametrize(
    ("more", "words"), [("pal=clean", "pal=clean is not interlaced"), ("quick=true", "no pictures")]
)
def test_half_frames_need_interlaced_pictures(more: str, words: str) -> None:
    with pytest.raises(ValueError, match=words):
        parse_uri(f"sim://chain?fields=top&{more}")


def test_half_frames_freeze_and_get_lost_as_pictures_do() -> None:
    chain = SimulatedChain(
        parse_uri("sim://chain?vehicles=2&width=160&height=120&fields=top&freeze=0.1&freeze_for=0.05")
    )
    frames = [chain.cameras[0].read() for _ in range(10)]
    pictures = [frame.image for frame in frames if frame is not None]
    assert all((a == b).all() for a, b in zip(pictures[5:7], pictures[4:6], strict=True))
    assert not (pictures[8] == pictures[9]).all()
    chain.close()
