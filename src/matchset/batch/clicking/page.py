"""A page on which a person clicks where it is doubtful what the ball is: `ClickPage`."""

import contextlib
import queue
import sys
import threading
from pathlib import Path
from typing import Any

import msgspec
from starlette.applications import Starlette
from starlette.middleware import Middleware
from starlette.requests import Request
from starlette.responses import PlainTextResponse, Response
from starlette.routing import Mount, Route
from starlette.staticfiles import StaticFiles

from matchset.app.target.target_options import parse_pick
from matchset.batch.clicking.clicker import GivenClick
from matchset.batch.jobs.choice import FRAME
from matchset.batch.jobs.clicks import HEADING, click_line
from matchset.batch.jobs.job import VideoOutcome
from matchset.batch.results.store import store_at
from matchset.live.web.guarded_application import GuardedApplication
from matchset.live.web.listening import listen
from matchset.live.web.security import Guard

PAGE = Path(__file__).parent / "page"
PORT = 8090  # format: that of the page, or the next one that is free
FARTHEST = 100_000  # format: px, larger than any picture


class Question(msgspec.Struct):
    """A video in which it is doubtful what the ball is."""

    number: int
    video: str
    reason: str
    guess: tuple[float, float] | None = None
    answer: str = ""


def guess_of(outcome: VideoOutcome) -> tuple[float, float] | None:
    """Return the place of what is likeliest, px; None if nothing is."""
    x, y, _ = parse_pick(outcome.click or "0,0")
    return (x, y) if (x, y) != (0.0, 0.0) else None


class ClickPage:
    """Shows doubtful videos as thumbnails, and takes a click for each; a `Clicker`.

    Parameters
    ----------
    out : str
        Folder of all results, or its URL: it has the pictures, and takes the clicks.
    name : str
        Of the table of clicks in it.

    Attributes
    ----------
    url : str
        Of the page.
    """

    def __init__(self, out: str, name: str) -> None:
        self._store, self._name = store_at(out), name
        self._outcomes = list[VideoOutcome]()
        self._questions = list[Question]()
        self._clicked: queue.SimpleQueue[GivenClick] = queue.SimpleQueue()
        self._lock = threading.Lock()
        import uvicorn

        listener, port = listen("127.0.0.1", PORT)
        self.url = f"http://127.0.0.1:{port}/"
        config = uvicorn.Config(self._application(Guard([], port, token=False)), log_level="error", lifespan="off")
        self._server: Any = uvicorn.Server(config)
        self._thread = threading.Thread(target=self._server.run, kwargs={"sockets": [listener]}, daemon=True)
        self._thread.start()
        print(f"note: doubtful videos are asked about at {self.url}", file=sys.stderr, flush=True)

    @property
    def waits(self) -> bool:
        """See `Clicker`."""
        return not self._clicked.empty() or any(not question.answer for question in self._questions)

    def ask(self, outcome: VideoOutcome) -> None:
        """See `Clicker`."""
        with self._lock:
            number = len(self._questions)
            self._outcomes.append(outcome)
            self._questions.append(Question(number, outcome.folder, outcome.reason, guess_of(outcome)))

    def clicks(self) -> list[GivenClick]:
        """See `Clicker`."""
        found = list[GivenClick]()
        with contextlib.suppress(queue.Empty):
            while True:
                found.append(self._clicked.get_nowait())
        return found

    def close(self) -> None:
        """See `Clicker`."""
        self._server.should_exit = True
        self._thread.join()

    def answer(self, number: int, x: float, y: float) -> None:
        """Take a click in a video.

        Raises
        ------
        ValueError
            If there is no such question, or it was answered.
        """
        with self._lock:
            question, outcome = self._open(number)
            frame = outcome.click.partition("@")[2] or "0"
            pick = f"{x:g},{y:g}@{frame}"
            old = self._store.read(self._name) or HEADING.encode()
            line = click_line(outcome.folder, int(frame), x, y)
            self._store.write(self._name, old + line.encode())
            self._clicked.put(GivenClick(outcome.video, outcome.folder, pick))
            question.answer = pick

    def skip(self, number: int) -> None:
        """Leave a video as it is (ValueError as for `answer`)."""
        with self._lock:
            self._open(number)[0].answer = "skipped"

    def _open(self, number: int) -> tuple[Question, VideoOutcome]:
        if not 0 <= number < len(self._questions):
            raise ValueError(f"there is no question {number}")
        if self._questions[number].answer:
            raise ValueError(f"question {number} was answered: {self._questions[number].answer}")
        return self._questions[number], self._outcomes[number]

    def _application(self, guard: Guard) -> Starlette:
        return Starlette(
            routes=[
                Route("/questions.json", self._list),
                Route("/frame/{number:int}.png", self._frame),
                Route("/click/{number:int}", self._click, methods=["POST"]),
                Route("/skip/{number:int}", self._skip, methods=["POST"]),
                Mount("/", StaticFiles(directory=PAGE, html=True)),
            ],
            middleware=[Middleware(GuardedApplication, guard=guard)],
        )

    def _list(self, _: Request) -> Response:
        with self._lock:
            return Response(msgspec.json.encode(self._questions), media_type="application/json")

    def _frame(self, request: Request) -> Response:
        number = request.path_params["number"]
        outcome = self._outcomes[number] if number < len(self._outcomes) else None
        data = None if outcome is None else self._store.read(f"{outcome.folder}/{FRAME}")
        if data is None:
            return PlainTextResponse("there is no such picture", 404)
        return Response(data, media_type="image/png")

    def _click(self, request: Request) -> Response:
        try:
            x, y = (float(request.query_params.get(name, "nan")) for name in ("x", "y"))
            if not (0.0 <= x < FARTHEST and 0.0 <= y < FARTHEST):
                raise ValueError(f"a click is x and y in px, got {x:g}, {y:g}")
            self.answer(request.path_params["number"], x, y)
        except ValueError as error:
            return PlainTextResponse(str(error), 400)
        return PlainTextResponse("taken")

    def _skip(self, request: Request) -> Response:
        try:
            self.skip(request.path_params["number"])
        except ValueError as error:
            return PlainTextResponse(str(error), 400)
        return PlainTextResponse("skipped")
