import contextlib

import pytest
from hypothesis import given
from hypothesis import strategies as st

from matchset.image.errors import LinkError
from matchset.links.arduino import messages as transmitter
from matchset.links.arduino.messages import AXES, Config, StatusReport

CONFIGS = st.builds(
    Config,
    id=st.binary(min_size=5, max_size=5),
    bind_channels=st.tuples(st.integers(0, 83), st.integers(0, 83)),
    reversed=st.sets(st.sampled_from(AXES)).map(lambda axes: tuple(axis for axis in AXES if axis in axes)),
    bind_at_power_on=st.booleans(),
    trim_follows_stick=st.booleans(),
    trims=st.tuples(*[st.integers(-31, 31)] * 3),
    tail=st.integers(0, 255),
)
STATUS = bytes.fromhex("01 01 02 02 29 0102 0003 04 0010 00ad 80 81 ff 02 81")


@given(CONFIGS)
def test_a_configuration_comes_back(config: Config) -> None:
    assert Config.decode(config.encode()) == config
    assert transmitter.decode_config(b"\0" + config.encode()) == ("stored", config)


@pytest.mark.parametrize(
    ("field", "value", "words"),
    [
        ("id", b"1234", "five bytes"),
        ("bind_channels", (0, 84), "0 ... 83"),
        ("reversed", ("rol",), "rol"),
        ("trims", (0, 32, 0), "-31 ... 31"),
        ("tail", 256, "256"),
    ],
)
def test_a_value_out_of_range_is_refused(field: str, value: object, words: str) -> None:
    with pytest.raises(ValueError, match=words.replace(".", r"\.")):
        Config(**{field: value})  # type: ignore[arg-type]


def test_a_status_is_taken_apart() -> None:
    report = StatusReport.decode(STATUS)
    assert (report.version, report.state) == ("1.2", "armed")
    assert report.warnings == ("the radio chip does not answer: look at its wires and its supply",)
    assert (report.default_config, report.storing, report.may_arm) == (True, False, True)
    assert (report.good, report.bad, report.lost_bytes, report.age_ms, report.echo) == (258, 3, 4, 16, 173)
    assert (report.throttle_on_air, report.heard) == (128, (129, -1, 2, -127))


@pytest.mark.parametrize(
    "payload",
    [b"", STATUS[:-1], b"\x02" + STATUS[1:], STATUS[:3] + b"\x05" + STATUS[4:], STATUS[:3] + b"\x09" + STATUS[4:]],
    ids=["none", "short", "new", "first unknown state", "state"],
)
def test_another_protocol_is_a_link_error(payload: bytes) -> None:
    with pytest.raises(LinkError, match="firmware"):
        StatusReport.decode(payload)


@pytest.mark.parametrize("payload", [b"", b"\x09" + Config().encode(), b"\0" + bytes(14), b"\0\1"])
def test_another_layout_is_a_link_error(payload: bytes) -> None:
    with pytest.raises(LinkError, match="firmware"):
        transmitter.decode_config(payload)


@given(st.binary(max_size=40) | st.binary(min_size=13, max_size=13).map(lambda data: b"\0\1" + data))
def test_no_payload_upsets_the_decoders(payload: bytes) -> None:
    for decode in (StatusReport.decode, transmitter.decode_config):
        with contextlib.suppress(LinkError):
            decode(payload)
