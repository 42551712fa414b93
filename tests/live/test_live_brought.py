"""What a person brings to the menu: addresses of streams, videos of one's own device; pictures of what is there."""

import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import cv2
import httpx
import numpy as np
import pytest

from asgi_client import AsgiClient
from live_server import made_desk
from live_videos import written
from matchset.live.feed import Feed
from matchset.live.sources.found_sources import Source, address_source, find_sources, is_text
from matchset.live.sources.messages import ShowAddress
from matchset.live.sources.opening import check_source
from matchset.live.sources.panel import SourcesPanel
from matchset.live.sources.source_selection import SourceSelection
from matchset.live.sources.thumbnails import ThumbnailParameters, Thumbnails
from matchset.live.sources.uploads import UploadParameters, Uploads
from matchset.live.web.application import make_application
from matchset.live.web.security import Guard

PORT = 8123
OWN = {"Origin": f"http://localhost:{PORT}", "Host": f"localhost:{PORT}"}
PROGRAM = {"Host": f"localhost:{PORT}"}
PATIENCE = 20.0  # s; only ever spent where a test fails


class Nothing(Feed):
    """A feed that shows nothing."""

    kind, title, streams, panels = "file", "nothing", (), ()

    def close(self) -> None:
        """There is nothing to close."""


class Menu:
    """A menu of a folder, the sources that it has opened, and its server."""

    def __init__(self, folder: Path, temporary: Path) -> None:
        self.opened: list[Source] = []

        def make(source: Source) -> Feed:
            self.opened.append(source)
            return Nothing()

        self.stage = SourceSelection(folder, make, lambda _: None)
        self.uploads = Uploads(UploadParameters(most_mb=1.0, spare_mb=0.0), temporary)
        self.panel = SourcesPanel(self.stage, None, self.uploads)
        desk, viewers, _ = made_desk()
        desk.session.add(self.panel)
        self.client = AsgiClient(make_application(desk, viewers, Guard([], PORT, token=False)))
        self.stage.look()
        self.wait(lambda: self.stage.sources.entries)

    def wait(self, condition: Callable[[], object]) -> None:
        end = time.monotonic() + PATIENCE
        while not condition():
            assert time.monotonic() < end
            time.sleep(0.005)


@pytest.fixture
def menu(tmp_path: Path) -> Iterator[Menu]:
    for name in ("videos", "temporary"):
        (tmp_path / name).mkdir()
    made = Menu(tmp_path / "videos", tmp_path / "temporary")
    with made.uploads, made.stage:
        yield made
    assert not list((tmp_path / "temporary").iterdir())  # all is removed at the end


@pytest.mark.parametrize(
    "text",
    ["rtsp://192.168.1.7/live", "http://me:secret@cam:8080/video", "udp://@:5000?x=1@239.0.0.1", "https://[::1]:8/a"],
)
def test_the_address_of_a_stream_is_taken(text: str) -> None:
    source = address_source(f" {text} ")
    assert (source.kind, source.origin) == ("address", text)
    assert "secret" not in source.name


@pytest.mark.parametrize(
    "text",
    ["", "ball.mp4", "/etc/passwd", "file:///etc/passwd", "sim://chain", "concat:a|b", "http://", "rtsp:// a", "0",
     "ftp://host/a", "http://host/\x01", "pipe://0", "http://[::1", "/dev/video0"],
)  # fmt: skip
def test_what_is_no_address_of_a_stream_is_refused(text: str) -> None:
    with pytest.raises(ValueError, match="is no address of a stream"):
        address_source(text)


def test_an_address_is_taken_from_a_page_alone_and_offered_afterwards(menu: Menu) -> None:
    address = ShowAddress("rtsp://me:secret@10.0.0.7/1")
    with pytest.raises(ValueError, match="from the page alone"):
        menu.panel.take(address, "")
    answer = menu.client.post("/do/show_address", json={"url": "rtsp://10.0.0.7/1"}, headers=OWN)
    assert (answer.status_code, menu.opened) == (400, [])
    for _ in range(2):
        menu.panel.take(address, "page 1")
    menu.wait(lambda: menu.opened and menu.stage.opening is None)
    assert menu.opened[0].origin == "rtsp://me:secret@10.0.0.7/1"
    brought = [each.name for each in menu.panel.state().entries if each.kind == "address"]
    assert brought == ["rtsp://10.0.0.7/1"]


def send(menu: Menu, data: bytes, name: str = "clip.avi", headers: dict[str, str] = OWN) -> httpx.Response:
    answer: httpx.Response = menu.client.post(f"/upload/video?name={name}", content=data, headers=headers)
    return answer


def test_a_video_of_ones_own_is_shown_and_removed_at_the_end(menu: Menu, tmp_path: Path) -> None:
    data = written(tmp_path).read_bytes()
    room = menu.panel.state().room
    assert send(menu, data, "../../my ball.avi").status_code == 204
    menu.wait(lambda: menu.opened)
    (source,) = menu.opened
    assert (source.kind, source.name) == ("upload", "my ball.avi")
    path = Path(source.origin)
    assert path.read_bytes() == data
    assert path.is_relative_to(tmp_path / "temporary")
    assert menu.panel.state().room == room - len(data)
    (entry,) = [each for each in menu.panel.state().entries if each.kind == "upload"]
    assert entry.pictured
    assert "until matchset ends" in entry.words


def test_a_video_that_cannot_be_taken_is_said_and_removed(menu: Menu, tmp_path: Path) -> None:
    data = written(tmp_path).read_bytes()
    for wrong, name, words in (
        (bytes(1_000_001), "clip.mp4", "room for 1 MB"),
        (data, "notes.txt", "no video by its name"),
        (data, "", "no video by its name"),
        (b"this is no video", "clip.avi", "clip.avi"),
        (b"", "clip.avi", "room"),
        (b"\0" * 5000, "clip.mp4", "clip.mp4"),
    ):
        answer = send(menu, wrong, name)
        assert answer.status_code == 400
        assert words in answer.json()["error"]
        assert str(tmp_path) not in answer.text  # a page is told no path
    assert send(menu, data, headers=PROGRAM).status_code == 403
    assert send(menu, data, headers=PROGRAM | {"Origin": "http://example.com"}).status_code == 403
    assert not menu.opened
    assert not [path for path in (tmp_path / "temporary").rglob("*") if path.is_file()]
    assert menu.panel.state().room == 1_000_000


def test_more_than_was_said_is_refused_and_what_is_not_whole(menu: Menu) -> None:
    upload = menu.uploads.begin("clip.mp4", 10)
    with pytest.raises(ValueError, match="longer than was said"):
        upload.write(b"12345678901")
    upload.drop()
    upload = menu.uploads.begin("clip.mp4", 10)
    upload.write(b"123")
    with pytest.raises(ValueError, match="did not come whole: 3 of 10"):
        upload.finish()
    upload.drop()
    announced = menu.uploads.begin("a.mp4", 900_000)
    with pytest.raises(ValueError, match="there is room for 0 MB"):
        menu.uploads.begin("b.mp4", 200_000)
    announced.drop()


def test_videos_have_their_first_picture(menu: Menu, tmp_path: Path) -> None:
    written(tmp_path / "videos")
    menu.stage.look()
    menu.wait(lambda: any(each.kind == "file" for each in menu.panel.state().entries))
    entries = {each.kind: each for each in menu.panel.state().entries}
    answer = menu.client.get(f"/thumbnail.jpg?key={entries['file'].key}", headers=PROGRAM)
    assert (answer.status_code, answer.headers["content-type"]) == (200, "image/jpeg")
    image: Any = cv2.imdecode(np.frombuffer(answer.content, np.uint8), cv2.IMREAD_COLOR)
    assert image.shape == (180, 240, 3)
    for key in (entries["demo"].key, "source-99", "", "/etc/passwd", str(tmp_path / "videos" / "ball.avi")):
        assert menu.client.get("/thumbnail.jpg", params={"key": key}, headers=PROGRAM).status_code == 404


def test_thumbnails_are_kept_within_a_number(tmp_path: Path) -> None:
    path = written(tmp_path)
    thumbnails = Thumbnails(ThumbnailParameters(width=64, kept=1))
    first = thumbnails.of(str(path))
    assert thumbnails.of(str(path)) is first
    with pytest.raises(ValueError, match="gone"):
        thumbnails.of(str(tmp_path / "gone.avi"))
    (tmp_path / "none.avi").write_bytes(b"\0" * 100)
    with pytest.raises(ValueError, match="none"):
        thumbnails.of(str(tmp_path / "none.avi"))


def test_texts_are_not_offered_whatever_their_names(tmp_path: Path) -> None:
    written(tmp_path)
    texts = {"main.ts": b"export const a = 1;\n", "b.mp4": "ü".encode() * 400, "c.mkv": "xü".encode() * 400}
    for name, data in texts.items():
        (tmp_path / name).write_bytes(data)
        assert is_text(tmp_path / name)
    (tmp_path / "d.mp4").write_bytes(b"\0\0\0\x18ftypmp42")
    (tmp_path / "e.mpg").write_bytes(b"\xff\xd8\xff\xe0 a picture")
    (tmp_path / "empty.mp4").touch()
    names = {each.name for each in find_sources(tmp_path, devices=tmp_path).entries if each.kind == "file"}
    assert names == {"ball.avi", "d.mp4", "e.mpg"}


def test_a_source_of_the_command_line_is_looked_at(tmp_path: Path) -> None:
    path = written(tmp_path)
    (tmp_path / "notes.mp4").write_text("this is no video")
    (tmp_path / "flight.toml").write_text("[flight]\n")
    (tmp_path / "folder").mkdir()
    for right in ("0", "rtsp://127.0.0.1:9/none", "sim://demo", "sim://chain?vehicles=3", str(path)):
        check_source(Source("given", right, right))
    for wrong, words in (
        ("nofile.mp4", "no such file"),
        ("notes.mp4", "notes.mp4"),
        ("folder", "folder"),
        ("flight.toml", "names no real vehicle"),
    ):
        with pytest.raises(ValueError, match=words):
            check_source(Source("given", str(tmp_path / wrong), wrong))
    for wrong in ("sim://nothing", "sim://chain?vehicles=99", "sim://chain?x=1"):
        with pytest.raises(ValueError, match=r"sim|vehicles|x"):
            check_source(Source("given", wrong, wrong))


def test_without_its_session_nothing_is_sent_nor_shown(menu: Menu, tmp_path: Path) -> None:
    desk, viewers, _ = made_desk()
    desk.session.add(menu.panel)
    stranger = AsgiClient(make_application(desk, viewers, Guard([], PORT, token=True)))
    data = written(tmp_path).read_bytes()
    assert stranger.post("/upload/video?name=clip.avi", content=data, headers=OWN).status_code == 401
    assert stranger.get("/thumbnail.jpg?key=source-1", headers=OWN).status_code == 401
    assert menu.panel.state().room == 1_000_000
