"""Two computers, as two processes: poses come, and whatever a partner does, the other goes on and says so in a line."""

import re
import shutil
import signal
import socket
import subprocess
import sys
import tempfile
import threading
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest

import matchset as ms
from matchset.sharing.messages import MOST_TARGETS
from sharing_poses import LEVEL
from sharing_processes import HOUR_OFF, NEWER, Heard, begun, until

Begin = Callable[..., "subprocess.Popen[str]"]

pytest.importorskip("zenoh", reason="eclipse-zenoh, the extra `net`, is not installed")


@pytest.fixture
def partner() -> Iterator[Begin]:
    """Begins partners, which end with the test."""
    made: list[subprocess.Popen[str]] = []

    def begin(*words: str, **network: Any) -> "subprocess.Popen[str]":
        made.append(begun(*words, **network))
        return made[-1]

    yield begin
    for each in made:
        each.kill()
        each.communicate()


def test_poses_come_with_age_and_uncertainty(share: ms.Share, key: str, partner: Begin) -> None:
    partner("left", key, taken="time.monotonic() - 0.1")
    until(lambda: any(share.others()))
    (found,) = share.others()
    until(lambda: (state := share.partners()[0]).received > 20 and state.offset is not None)
    assert (found.partner, found.name) == ("left", "ball")
    assert isinstance(found.pose, ms.Pose)
    assert found.pose.position.tolist() == LEVEL.position.tolist()
    assert found.age is not None
    assert found.age.seconds >= 0.1 - found.age.uncertainty
    assert found.age.uncertainty < 0.05
    assert abs(found.pose.time + found.age.seconds - time.monotonic()) < 60.0
    assert share.news() == ["left: here"]
    assert repr(share) == f"Share('me', key {key!r}, with left)"


def test_pictures_of_several_cameras_have_times_of_their_own(share: ms.Share, key: str) -> None:
    with ms.Share("other", key=key) as other:

        def seen() -> bool:
            now = time.monotonic()
            share.publish({"first": LEVEL, "second": LEVEL}, {"first": now - 0.1, "second": now - 0.2})
            return any(other.others()) and other.wait(1.0)

        until(seen)
        first, second = other.others()
        assert first.age is not None
        assert second.age is not None
        assert second.age.seconds - first.age.seconds == pytest.approx(0.1)
    with pytest.raises(ValueError, match="times must be finite, got None of 'ball'"):
        share.publish(LEVEL, {"first": 1.0})


@pytest.mark.usefixtures("signals_end_programs")
def test_both_see_each_other_and_each_is_told_when_one_ends(share: ms.Share, key: str, partner: Begin) -> None:
    heard, other = Heard(share), partner("left", key)
    share.publish(LEVEL, time.monotonic())
    until(lambda: any(share.others()))
    other.send_signal(signal.SIGINT)
    until(lambda: heard.has("left: gone"))
    assert not any(share.others())


def test_one_that_is_killed_is_told_and_never_used_again(share: ms.Share, key: str, partner: Begin) -> None:
    heard, other = Heard(share), partner("left", key)
    until(lambda: any(share.others()))
    other.kill()
    until(lambda: heard.has("left: gone"))
    assert share.others()[0].reason == "not seen: its program is gone"
    partner("left", key)
    until(lambda: any(share.others()))
    assert heard.count("left: gone") == heard.count("left: began anew") == 1


def test_one_that_hangs_is_told_and_nobody_waits_for_it(share: ms.Share, key: str, partner: Begin) -> None:
    heard, other = Heard(share), partner("left", key)
    until(lambda: any(share.others()))
    other.send_signal(signal.SIGSTOP)
    until(lambda: heard.has("left: silent for"))
    assert not any(share.others())
    share.publish(LEVEL, time.monotonic())
    other.send_signal(signal.SIGCONT)
    until(lambda: any(share.others()))
    assert heard.count("silent") == 1


def test_a_clock_that_is_an_hour_off_changes_nothing(share: ms.Share, key: str, partner: Begin) -> None:
    heard = Heard(share)
    partner("left", key, HOUR_OFF)
    until(lambda: any(share.others()))
    (state,) = share.partners()
    assert state.offset is not None
    assert abs(state.offset.seconds + 3600.0) <= state.offset.uncertainty
    until(lambda: heard.has("left: its time of day is 3600 s ahead of this one"))
    until(lambda: share.partners()[0].received > 60)
    assert heard.count("3600 s") == 1


def test_one_of_another_version_is_refused_once_and_the_others_go_on(share: ms.Share, key: str, partner: Begin) -> None:
    heard, newer = Heard(share), partner("newer", key, NEWER)
    partner("left", key)
    until(lambda: heard.has("newer: sends messages of version 2, this is 1"))
    until(lambda: any(share.others()) and {each.name: each for each in share.partners()}["left"].received > 30)
    assert {each.partner for each in share.others()} == {"left"}
    assert heard.count("version 2") == 1
    assert newer.poll() is None


def test_foreign_bytes_under_the_key_are_refused_once(share: ms.Share, key: str, partner: Begin) -> None:
    from matchset.sharing.connection import Connection, zenoh_settings

    heard = Heard(share)
    with Connection(zenoh_settings("loopback", (), ())) as connection:
        send = connection.publisher(f"{key}/targets/printer", "text/plain")
        until(lambda: [send(b"paper jam", None), heard.has("printer: sends what is no message of matchset")][1])
        for _ in range(50):
            send(b"paper jam", None)
        partner("left", key)
        until(lambda: any(share.others()))
    assert heard.count("printer") == 1


def test_another_computer_of_the_same_name_is_told_once(share: ms.Share, key: str, partner: Begin) -> None:
    heard = Heard(share)
    partner("me", key)
    until(lambda: heard.has("me: another computer shares under this name, too"))
    partner("left", key)
    until(lambda: any(share.others()))
    assert heard.count("another computer") == 1


def test_of_too_many_partners_the_rest_is_left_out_and_told_once(share: ms.Share, key: str) -> None:
    from matchset.sharing.connection import Connection, zenoh_settings

    heard = Heard(share)
    with Connection(zenoh_settings("loopback", (), ())) as connection:
        for number in range(MOST_TARGETS + 8):
            connection.appear(f"{key}/alive/partner{number}")
        until(lambda: heard.has("left out, 64 partners are heard at most"))
        assert len(share.partners()) == MOST_TARGETS
    until(lambda: not any(each.here for each in share.partners()))
    assert heard.count("left out") == 1


def test_those_with_another_key_are_not_seen(share: ms.Share, key: str, partner: Begin) -> None:
    partner("foreign", f"{key}x")
    partner("left", key)
    until(lambda: any(share.others()))
    assert [each.name for each in share.partners()] == ["left"]


LISTENING = re.compile(
    r"^\s*\d+: ([0-9A-F]+):([0-9A-F]{4}) [0-9A-F]+:[0-9A-F]{4} ([0-9A-F]{2}) .* (\d+) ", re.MULTILINE
)


def own_sockets() -> set[str]:
    """Inodes of the sockets of this process."""
    links = [str(each.readlink()) for each in Path("/proc/self/fd").iterdir() if each.is_symlink()]
    return {link[8:-1] for link in links if link.startswith("socket:[")}


def reachable() -> list[str]:
    """Sockets of this process at which something could arrive from another computer, as /proc has them."""
    found, own = [], own_sockets()
    for table in ("tcp", "tcp6", "udp", "udp6"):
        for line in Path(f"/proc/net/{table}").read_text().splitlines()[1:]:
            fields = line.split()
            address, there, state, inode = fields[1], fields[2], fields[3], fields[9]
            listens = state == "0A" if table.startswith("tcp") else True
            local = address.startswith(("0100007F", "00000000000000000000000001000000"))
            if inode in own and listens and not local:
                found.append(f"{table} {address} from {there}")
    return found


@pytest.mark.skipif(not sys.platform.startswith("linux"), reason="/proc is Linux's")
def test_by_default_nothing_can_arrive_from_another_computer(key: str) -> None:
    before = reachable()
    with ms.Share("me", key=key) as share, ms.Share("other", key=key) as other:
        until(lambda: share.partners() and other.partners())
        assert reachable() == before
    with ms.Share("me", key=key, discovery="off"):
        assert reachable() == before
    with ms.Share("me", key=key, discovery="network"):
        assert reachable() != before


def free_port() -> int:
    with socket.socket() as there:
        there.bind(("127.0.0.1", 0))
        return int(there.getsockname()[1])


def test_endpoints_are_enough(key: str, partner: Begin) -> None:
    where = f"tcp/127.0.0.1:{free_port()}"
    with ms.Share("me", key=key, discovery="off", listen=[where]) as share:
        partner("left", key, discovery="off", connect=[where])
        until(lambda: any(share.others()))


def test_only_who_knows_the_password_is_let_in(key: str, tmp_path: Path, partner: Begin) -> None:
    where, users = f"tcp/127.0.0.1:{free_port()}", tmp_path / "users"
    users.write_text("anna:secret\n")
    own = {"transport/auth/usrpwd/dictionary_file": str(users)}
    theirs = {"transport/auth/usrpwd/user": "anna", "transport/auth/usrpwd/password": "secret"}
    network: dict[str, Any] = {"discovery": "off", "connect": [where]}
    with ms.Share("me", key=key, discovery="off", listen=[where], config=own | theirs) as share:
        partner("stranger", key, **network)
        partner("wrong", key, config=theirs | {"transport/auth/usrpwd/password": "guess"}, **network)
        partner("friend", key, config=theirs, **network)
        until(lambda: any(share.others()))
        assert [each.name for each in share.partners()] == ["friend"]


def certificates(folder: Path) -> tuple[str, str]:
    """A certificate for localhost, signed by itself, and its key, made by openssl."""
    program = shutil.which("openssl")
    if program is None:
        pytest.skip("there is no openssl to make a certificate")
    certificate, private = str(folder / "certificate.pem"), str(folder / "key.pem")
    words = ["req", "-x509", "-newkey", "ec", "-pkeyopt", "ec_paramgen_curve:prime256v1", "-nodes", "-days", "2"]
    words += [
        "-subj",
        "/CN=localhost",
        "-addext",
        "subjectAltName=DNS:localhost",
        "-addext",
        "basicConstraints=CA:FALSE",
    ]
    subprocess.run([program, *words, "-keyout", private, "-out", certificate], check=True, capture_output=True)
    return certificate, private


def test_over_tls_only_who_is_trusted_is_talked_to(key: str, partner: Begin, tmp_path: Path) -> None:
    where = f"tls/localhost:{free_port()}"
    (certificate, private), (foreign, _) = certificates(tmp_path), certificates(Path(tempfile.mkdtemp(dir=tmp_path)))
    own = {"transport/link/tls/listen_certificate": certificate, "transport/link/tls/listen_private_key": private}
    network: dict[str, Any] = {"discovery": "off", "connect": [where]}
    with ms.Share("me", key=key, discovery="off", listen=[where], config=own) as share:
        partner("suspicious", key, config={"transport/link/tls/root_ca_certificate": foreign}, **network)
        partner("friend", key, config={"transport/link/tls/root_ca_certificate": certificate}, **network)
        until(lambda: any(share.others()))
        assert [each.name for each in share.partners()] == ["friend"]


def test_a_configuration_file_of_zenoh_is_taken(key: str, tmp_path: Path, partner: Begin) -> None:
    where, file = f"tcp/127.0.0.1:{free_port()}", tmp_path / "zenoh.json5"
    file.write_text(
        f'{{mode: "peer", listen: {{endpoints: ["{where}"]}}, scouting: {{multicast: {{enabled: false}}}}}}'
    )
    with ms.Share("me", key=key, config=file) as share:
        partner("left", key, discovery="off", connect=[where])
        until(lambda: any(share.others()))
    with pytest.raises(ValueError, match="is no configuration of Zenoh"):
        ms.Share("me", config=tmp_path / "missing.json5")


@pytest.mark.parametrize(
    ("wrong", "words"),
    [
        ({"name": ""}, "1 to 64 characters"),
        ({"name": "a/b"}, "got 'a/b'"),
        ({"name": "a b"}, "got 'a b'"),
        ({"name": "@left"}, "does not begin with @, got '@left'"),
        ({"key": "a//b"}, "got 'a//b'"),
        ({"key": "all/*"}, "got 'all/\\*'"),
        ({"discovery": "everywhere"}, "loopback, network, off, got 'everywhere'"),
        ({"config": {"no/such": 1}}, "Zenoh knows no setting no/such = 1"),
    ],
)
def test_misuse_is_refused(wrong: dict[str, Any], words: str) -> None:
    with pytest.raises(ValueError, match=words):
        ms.Share(**({"name": "me"} | wrong))


def test_an_endpoint_that_cannot_be_used_is_a_broken_device() -> None:
    with pytest.raises(ms.LinkError, match="sharing cannot begin: "):
        ms.Share("me", discovery="off", listen=["tcp/203.0.113.1:1"])


@pytest.mark.parametrize("taken", [float("nan"), float("inf")])
def test_a_time_that_is_not_finite_is_refused(share: ms.Share, taken: float) -> None:
    with pytest.raises(ValueError, match=r"times must be finite, got (nan|inf) of 'ball'"):
        share.publish(LEVEL, taken)


def test_what_others_could_not_read_is_not_sent(share: ms.Share) -> None:
    import msgspec
    import numpy as np

    damaged = msgspec.structs.replace(LEVEL, covariance=np.full((6, 6), np.nan))
    with pytest.raises(ValueError, match="this cannot be shared: it sends a damaged message"):
        share.publish(damaged, 0.0)


def test_after_its_end_nothing_is_shared_and_nothing_raised(key: str) -> None:
    share = ms.Share("me", key=key)
    share.close()
    share.close()
    share.publish(LEVEL, time.monotonic())
    share.publish(LEVEL, time.monotonic())
    (line,) = share.news()
    assert line.startswith("me: nothing is shared any more: ")
    assert not [each for each in threading.enumerate() if each.name == "matchset share"]


def test_without_zenoh_it_says_what_to_install(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "zenoh", None)
    with pytest.raises(ms.LinkError, match="sharing needs eclipse-zenoh: pip install 'eclipse-zenoh"):
        ms.Share("me")
