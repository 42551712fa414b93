"""The page on which a person clicks where it is doubtful what the ball is."""

import httpx
import pytest

pytest.importorskip("uvicorn", reason="the extra web is not installed")

from collections.abc import Iterator
from pathlib import Path

import cv2

from batched_videos import HerePool, write_ball
from blue_ball import Matchset, ball_picture
from matchset.batch import run
from matchset.batch.clicking.page import ClickPage
from matchset.batch.jobs import choice
from matchset.batch.jobs.job import VideoOutcome


def doubtful(folder: str, click: str = "20,30@5") -> VideoOutcome:
    return VideoOutcome(
        video=f"/v/{folder}", folder=folder, settings="", state="doubtful", reason="<b>two</b>", click=click
    )


@pytest.fixture
def page(tmp_path: Path) -> Iterator[ClickPage]:
    page = ClickPage(str(tmp_path), "clicks.csv")
    yield page
    page.close()


def test_click_answers_a_question(page: ClickPage, tmp_path: Path) -> None:
    (tmp_path / "a").mkdir()
    cv2.imwrite(str(tmp_path / "a" / "frame.png"), ball_picture((60.0, 60.0)))
    page.ask(doubtful("a"))
    page.ask(doubtful("b", "0,0@7"))
    assert page.waits
    assert page.clicks() == []
    questions = httpx.get(f"{page.url}questions.json").json()
    assert [(each["video"], each["guess"], each["answer"]) for each in questions] == [
        ("a", [20.0, 30.0], ""),
        ("b", None, ""),
    ]
    assert httpx.get(f"{page.url}frame/0.png").headers["content-type"] == "image/png"
    assert httpx.get(f"{page.url}frame/1.png").status_code == 404
    assert httpx.post(f"{page.url}click/0?x=61.5&y=60").text == "taken"
    (click,) = page.clicks()
    assert (click.video, click.pick) == ("/v/a", "61.5,60@5")
    assert (tmp_path / "clicks.csv").read_text() == "video,frame,x,y\na,5,61.5,60\n"
    assert httpx.post(f"{page.url}skip/1").text == "skipped"
    assert not page.waits


def test_a_click_waits_until_somebody_takes_it(page: ClickPage) -> None:
    page.ask(doubtful("a"))
    page.answer(0, 3.0, 4.0)
    assert page.waits  # nothing is asked any more, but a job comes of it
    assert len(page.clicks()) == 1
    assert not page.waits


@pytest.mark.parametrize("path", ["click/0?x=1e9&y=2", "click/0?y=2", "click/0?x=nan&y=2", "click/7?x=1&y=2", "skip/7"])
def test_wrong_answers_are_refused(page: ClickPage, path: str) -> None:
    page.ask(doubtful("a"))
    assert httpx.post(page.url + path).status_code == 400
    assert page.waits
    assert page.clicks() == []


def test_another_site_may_not_click(page: ClickPage) -> None:
    page.ask(doubtful("a"))
    answer = httpx.post(f"{page.url}skip/0", headers={"origin": "http://evil.example"})
    assert answer.status_code == 403
    assert httpx.get(f"{page.url}questions.json", headers={"host": "evil.example"}).status_code == 421


def test_page_itself(page: ClickPage) -> None:
    words = httpx.get(page.url).text
    assert "Which is the ball?" in words
    for name in ("questions.js", "style.css"):
        assert httpx.get(page.url + name).status_code == 200


def test_doubtful_videos_wait_for_a_click(
    matchset: Matchset, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    class OneClick(ClickPage):
        """A page at which somebody clicks at once."""

        def ask(self, outcome: VideoOutcome) -> None:
            super().ask(outcome)
            assert (tmp_path / "results" / outcome.folder / "frame.png").is_file()
            self.answer(0, 60.0, 60.0)

    monkeypatch.setattr(run, "Processes", HerePool)
    monkeypatch.setattr(choice.doubt_of, "__defaults__", (choice.DoubtParameters(rank=1.0),))
    video = write_ball(tmp_path / "clips" / "ball.mp4")
    assert matchset("batch", video, "--out", "results", "--auto") == 1
    assert "doubtful" in Path("results/videos.csv").read_text()
    assert "doubtful" in capsys.readouterr().out
    monkeypatch.setattr("matchset.batch.clicking.page.ClickPage", OneClick)
    assert matchset("batch", video, "--out", "results", "--auto", "--page") == 0
    assert "ball.mp4,found" in Path("results/videos.csv").read_text()
    assert matchset("batch", video, "--out", "results", "--auto") == 0  # the click is kept
