"""Addresses without a stream: what is there instead is said, soon, and is no broken device."""

import pytest

import bad_servers
from bad_servers import BadServer
from matchset.image.errors import LinkError, NoStreamError
from matchset.media.camera_stream import StreamParameters
from matchset.media.streams.answer import _request, answer_of
from matchset.media.video import Video

HASTY = StreamParameters(first_picture_s=0.5, answer_s=2.0)
HASTIER = StreamParameters(first_picture_s=0.5, answer_s=0.2)  # for what never answers


@pytest.mark.parametrize(
    ("answer", "hasty", "words"),
    [
        (bad_servers.page, HASTY, r"answers with a page \(text/html\), not with pictures"),
        (bad_servers.circle, HASTY, "redirects in a circle"),
        (bad_servers.missing, HASTY, "answers 404 Not Found"),
        (bad_servers.drips, HASTY, "answers with multipart/x-mixed-replace, but no picture comes"),
        (bad_servers.drips_at_once, HASTIER, "takes connections, but does not answer"),
        (bad_servers.silent, HASTIER, "takes connections, but does not answer"),
    ],
)
def test_what_is_there_in_place_of_a_stream_is_said(
    monkeypatch: pytest.MonkeyPatch, answer: bad_servers.Answer, hasty: StreamParameters, words: str
) -> None:
    monkeypatch.setattr("matchset.media.camera_stream.DEFAULT", hasty)
    with BadServer(answer) as server:
        with pytest.raises(NoStreamError, match=f"^{server.url} {words}") as caught:
            Video(server.url, timeout=0.5)
        assert isinstance(caught.value, ValueError)
        assert isinstance(caught.value, LinkError)
        assert "is its address right" in str(caught.value)


def test_one_that_takes_connections_and_is_no_rtsp_server(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("matchset.media.camera_stream.DEFAULT", HASTY)
    with BadServer(bad_servers.silent) as server:
        url = f"rtsp://me:secret@127.0.0.1:{server.port}/live"
        with pytest.raises(NoStreamError, match="takes connections, but no picture comes") as caught:
            Video(url, timeout=0.5)
    assert "secret" not in str(caught.value)


@pytest.mark.parametrize("scheme", ["http", "rtsp", "tcp"])
def test_where_nothing_is_the_device_is_missing(scheme: str) -> None:
    with BadServer(bad_servers.page) as server:
        port = server.port
    with pytest.raises(LinkError, match="cannot open") as caught:
        Video(f"{scheme}://127.0.0.1:{port}/live", timeout=0.5)
    assert not isinstance(caught.value, NoStreamError)


def test_what_nobody_connects_to_is_not_asked() -> None:
    assert answer_of("udp://127.0.0.1:9", 0.5) == ""
    assert answer_of("http://127.0.0.1:port/x", 0.5) == ""


def test_a_password_is_sent_as_one_and_not_in_the_address() -> None:
    request = _request("http://me:se%20cret@drone:81/live?a=1")
    assert request.full_url == "http://drone:81/live?a=1"
    assert request.get_header("Authorization") == "Basic bWU6c2UgY3JldA=="
    assert _request("http://drone/live").get_header("Authorization") is None
