"""Who may use the page: host, origin, token, session."""

import pytest

from matchset.live.web.security import Guard

LAN = Guard(["192.168.1.7"], 8123, token=True)
LOCAL = Guard([], 8123, token=False)


@pytest.mark.parametrize("host", ["127.0.0.1:8123", "localhost:8123", "LOCALHOST:8123", "[::1]:8123"])
def test_own_names_are_known(host: str) -> None:
    assert LOCAL.host_is_known(host)


@pytest.mark.parametrize(
    "host", [None, "", "evil.example:8123", "127.0.0.1", "127.0.0.1:80", "127.0.0.1.evil.example:8123"]
)
def test_other_names_are_dns_rebinding(host: str | None) -> None:
    assert not LOCAL.host_is_known(host)


def test_another_site_s_page_is_told_by_its_origin() -> None:
    host = "127.0.0.1:8123"
    assert LOCAL.origin_is_own(None, host)
    assert LOCAL.origin_is_own("http://127.0.0.1:8123", host)
    for origin in ("http://evil.example", "null", "https://127.0.0.1:8123", "http://127.0.0.1:9000", ""):
        assert not LOCAL.origin_is_own(origin, host)


def test_a_token_becomes_a_session() -> None:
    assert LOCAL.session_is_known(None)
    assert not LAN.session_is_known(None)
    assert LAN.session_for("wrong") is None
    assert LAN.session_for("") is None
    session = LAN.session_for(LAN.token)
    assert session != LAN.token
    assert LAN.session_is_known(session)
    assert not LAN.session_is_known("ä")
    assert len(LAN.token) >= 22  # 128 bits in base 64
    assert Guard([], 1, token=True).token != LAN.token
