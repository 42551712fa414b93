"""Which videos a batch has."""

import os
from pathlib import Path

import msgspec
import pytest

from matchset.batch.jobs.job import VideoOutcome
from matchset.batch.jobs.videos import VideoList, folder_of, plain_name, plain_words, real_name
from matchset.batch.results.manifest import Manifest
from matchset.batch.results.store import FolderStore


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    for name in ("b/two.mp4", "a/one.MP4", "a/notes.txt", "three.webm"):
        path = tmp_path / "videos" / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.touch()
    return tmp_path / "videos"


def names(videos: VideoList) -> list[str]:
    return [Path(video).name for video in videos]


def test_folder_with_all_that_is_in_it(folder: Path) -> None:
    videos = VideoList([str(folder)])
    assert names(videos) == ["three.webm", "one.MP4", "two.mp4"]
    assert (videos.count, videos.common) == (3, folder)


def test_results_are_not_searched(folder: Path) -> None:
    assert names(VideoList([str(folder)], str(folder / "a"))) == ["three.webm", "two.mp4"]


def test_wildcards_and_names(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    assert names(VideoList([str(folder / "*" / "*.mp4")])) == ["two.mp4"]
    monkeypatch.chdir(folder)
    assert names(VideoList(["*.webm", "b"])) == ["three.webm", "two.mp4"]


def test_list_has_a_video_twice(folder: Path) -> None:
    listed = folder / "list.txt"
    listed.write_text("# a comment\na/one.MP4\n\nb/two.mp4\nb/../a/one.MP4\nmissing.mp4\n")
    videos = VideoList([str(listed)])
    assert names(videos) == ["one.MP4", "two.mp4", "missing.mp4"]
    assert videos.twice == 1


@pytest.mark.parametrize("name", ["rtsp://10.0.0.7/live", "0", "http://a/b.mjpg"])
def test_what_does_not_end_is_refused(folder: Path, name: str) -> None:
    listed = folder / "list.txt"
    listed.write_text(f"a/one.MP4\n{name}\n")
    with pytest.raises(ValueError, match=r"line 2: .* does not end"):
        VideoList([str(listed)])
    with pytest.raises(ValueError, match="does not end"):
        VideoList([name])


def test_a_list_that_is_no_utf_8(folder: Path) -> None:
    listed = folder / "list.txt"
    listed.write_text("a/one.MP4\n", encoding="utf-16")
    with pytest.raises(ValueError, match=r"list\.txt, line 1: a list is text in UTF-8"):
        VideoList([str(listed)])


def test_nothing_there(tmp_path: Path) -> None:
    with pytest.raises(ValueError, match="no such file"):
        VideoList([str(tmp_path / "*.mp4")])
    with pytest.raises(ValueError, match="there is no video in"):
        VideoList([str(tmp_path)])


def test_folders_of_results() -> None:
    root = Path("/data/clips")
    assert folder_of("/data/clips/a/x.mp4", root) == "a/x.mp4"
    assert folder_of("/data/clips/a\n/100%.mp4", root) == "a%0A/100%25.mp4"
    assert folder_of("/other/x.mp4", root) == "elsewhere/other/x.mp4"
    assert folder_of("/data/clips/..x.mp4", root) == "..x.mp4"


def test_long_names_are_shortened_and_stay_apart() -> None:
    names = [folder_of(f"/data/{os.fsdecode(bytes([0xE4]) * 120)}{end}.mp4", Path("/data")) for end in "ab"]
    assert names[0] != names[1]
    assert all(len(name.encode()) <= 200 for name in names)
    assert plain_words(os.fsdecode(b"a\xff")).isascii()
    assert real_name(plain_name("/a\n/100%.mp4")) == "/a\n/100%.mp4"


def test_hundred_thousand_videos_take_little_memory(tmp_path: Path) -> None:
    import tracemalloc

    listed = tmp_path / "list.txt"
    listed.write_text("".join(f"/data/some/folder/of/clips/day{k % 100}/video-{k:06d}.mp4\n" for k in range(100_000)))
    tracemalloc.start()
    try:
        videos = VideoList([str(listed)])
        _, most = tracemalloc.get_traced_memory()
    finally:
        tracemalloc.stop()
    assert videos.count == 100_000
    assert most < 40e6


def test_hundred_thousand_videos_that_are_done_take_little_memory(tmp_path: Path) -> None:
    import tracemalloc

    done = VideoOutcome(video="", folder="", settings="0" * 32, state="found", frames=1, found=1, worker="lab1:7")
    with Manifest(FolderStore(tmp_path), Path("/data")) as manifest:
        for k in range(100_000):
            name = f"day{k % 100}/video-{k:06d}.mp4"
            manifest.append(msgspec.structs.replace(done, video=f"/data/{name}", folder=name, size=k, modified=k))
    tracemalloc.start()
    try:
        with Manifest(FolderStore(tmp_path), Path("/data")) as manifest, manifest.by_folder() as outcomes:
            last = outcomes.last("day99/video-099999.mp4")
        _, most = tracemalloc.get_traced_memory()
    finally:
        tracemalloc.stop()
    assert last is not None
    assert manifest.is_done(last, failed_too=False)
    assert most < 60e6
