"""Workers of Dask that do not fit, and its page."""

import http.server
import threading
from collections.abc import Callable
from pathlib import Path

import pytest

from batched_videos import write_balls, write_color
from blue_ball import Matchset
from dask_programs import free_port, started
from matchset.batch.jobs.identity import code_digest
from matchset.batch.jobs.job import Job
from matchset.batch.jobs.video_options import track_options
from matchset.batch.options import BatchOptions
from matchset.batch.workers import dask_cluster
from matchset.batch.workers.dask_cluster import DaskCluster, DaskParameters, answers
from matchset.batch.workers.worker import warm_up

distributed = pytest.importorskip("distributed", reason="Dask is not installed (extra batch)")

ALONE = "--nthreads", "1"


@pytest.fixture
def words(tmp_path: Path) -> tuple[object, ...]:
    """What is typed."""
    clips, color = write_balls(tmp_path / "clips", 2), write_color(tmp_path / "ball.npz")
    return "batch", clips, "--out", tmp_path / "out", "--color", color


def unfit(folder: Path, name: str, code: str) -> tuple[str, ...]:
    """Words for a worker that runs some code first."""
    path = folder / f"{name}.py"
    path.write_text(code)
    return *ALONE, "--preload", str(path)


@pytest.mark.timeout(300)
@pytest.mark.parametrize(
    ("name", "problem"),
    [
        ("threads", "it has 2 threads, which mix the logs of videos: start it with --nthreads 1"),
        ("version", "its matchset is another one: 0.0.1 0123, here "),
        ("none", "it has no matchset that fits"),
    ],
)
def test_a_worker_that_does_not_fit_is_refused_by_name(
    matchset: Matchset,
    tmp_path: Path,
    words: tuple[object, ...],
    name: str,
    problem: str,
    capfd: pytest.CaptureFixture[str],
) -> None:
    port = str(free_port())
    address = f"tcp://127.0.0.1:{port}"
    other = "from matchset.batch.jobs import identity\nidentity.code_digest = lambda: '0.0.1 0123'\n"
    told = {
        "threads": ("--nthreads", "2"),
        "version": unfit(tmp_path, "version", other),
        "none": unfit(tmp_path, "none", "import sys\nsys.modules['matchset.batch.jobs'] = None\n"),
    }[name]
    common = address, "--no-nanny", "--no-dashboard"
    with (
        started("dask_scheduler", "--host", "127.0.0.1", "--port", port, "--no-dashboard"),
        started("dask_worker", *common, *told),
    ):
        assert matchset(*words, "--scheduler", address) == 3
        said = capfd.readouterr().err
        assert "no worker is fit: " in said
        assert problem in said
        assert "Dask shows" not in said  # it has no page
        with started("dask_worker", *common, *ALONE), distributed.Client(address, set_as_default=False) as client:
            client.wait_for_workers(2)
            assert matchset(*words, "--scheduler", address) == 0
        assert problem in capfd.readouterr().err
    assert len(list((tmp_path / "out").rglob("tracks.csv"))) == 2


class Future:
    """What was submitted; it ends when the test says so."""

    def __init__(self, function: object, workers: list[str] | None) -> None:
        self.function, self.workers, self.status = function, workers, "pending"
        self.error: Exception | None = None
        self._callbacks = list[Callable[[Future], None]]()

    def add_done_callback(self, call: "Callable[[Future], None]") -> None:
        if self.done():
            call(self)
        self._callbacks.append(call)

    def done(self) -> bool:
        return self.status != "pending"

    def cancel(self) -> None:
        self._end("cancelled")

    def fail(self, error: Exception) -> None:
        self.error = error
        self._end("error")

    def exception(self) -> Exception | None:
        return self.error

    def _end(self, status: str) -> None:
        self.status = status
        for call in self._callbacks:
            call(self)


class Client:
    """A client of a scheduler whose workers come and go as the test says."""

    def __init__(self, workers: dict[str, str]) -> None:
        self.workers, self.status, self.dashboard_link = workers, "running", ""
        self.given = list[Future]()
        self.warms = False

    def wait_for_workers(self, *_: object, **__: object) -> None:
        pass

    def scheduler_info(self, **_: object) -> dict[str, object]:
        return {"workers": {name: {"nthreads": 1, "host": name} for name in self.workers}}

    def run(self, function: object, workers: list[str] | None = None, **_: object) -> dict[str, object]:
        asked = self.workers if workers is None else [name for name in workers if name in self.workers]
        return {name: self.workers[name] if function is code_digest else name for name in asked}

    def submit(self, function: object, *_: object, workers: list[str] | None = None, **__: object) -> Future:
        future = Future(function, workers)
        if function is warm_up and self.warms:
            future._end("finished")
        self.given.append(future)
        return future

    def close(self, **_: object) -> None:
        pass


@pytest.fixture
def client(monkeypatch: pytest.MonkeyPatch) -> Client:
    client = Client({"a": code_digest()})
    monkeypatch.setattr(distributed, "Client", lambda *_, **__: client)
    monkeypatch.setattr(dask_cluster, "PARAMETERS", DaskParameters(look=0.0, warm=60.0))
    return client


def a_job() -> Job:
    return Job(
        video="v", folder="f", out="o", options=track_options(BatchOptions(videos=[], out="o"), "v"), settings="s"
    )


def test_a_job_for_workers_that_have_left_is_given_to_others(client: Client) -> None:
    client.warms, client.workers["wrong"] = True, "another"
    with DaskCluster("tcp://x:1") as cluster:
        cluster.give(a_job())
        first = client.given[-1]
        assert first.workers == ["a"]
        del client.workers["a"]
        client.workers["b"] = code_digest()
        cluster.answers(0.0)
        assert first.status == "cancelled"
        assert client.given[-1].workers == ["b"]
        cluster.answers(0.0)
        assert len(client.given) == 3  # the first one was to warm up
        assert list(cluster.running) == ["f"]


def test_a_worker_that_leaves_while_it_compiles_is_not_waited_for(
    client: Client, monkeypatch: pytest.MonkeyPatch
) -> None:
    look = client.scheduler_info

    def leaves(**more: object) -> dict[str, object]:
        if client.given:
            client.workers.pop("a", None)
        return look(**more)

    monkeypatch.setattr(client, "scheduler_info", leaves)
    with DaskCluster("tcp://x:1"):
        assert [future.status for future in client.given] == ["cancelled"]


def test_a_worker_that_compiles_for_ever_is_not_waited_for(client: Client, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(dask_cluster, "PARAMETERS", DaskParameters(look=0.0, warm=0.0))
    with DaskCluster("tcp://x:1"):
        assert [future.status for future in client.given] == ["cancelled"]


def test_a_wrong_worker_that_comes_late_costs_no_batch(client: Client) -> None:
    client.warms = True
    with DaskCluster("tcp://x:1") as cluster:
        cluster.give(a_job())
        client.workers["late"] = "another"
        client.given[-1].fail(ModuleNotFoundError("No module named 'matchset'"))
        assert cluster.answers(0.0) == []
        assert client.given[-1].workers == ["a"]
        assert any("the worker late is refused: its matchset is another one" in note for note in cluster.notes)
        error = OSError("an error of its own")
        client.given[-1].fail(error)
        assert [answer.error for answer in cluster.answers(0.0)] == [error]


@pytest.mark.parametrize(("path", "there"), [("/status", True), ("/nothing", False)])
def test_the_page_of_dask_is_named_where_it_answers(path: str, there: bool) -> None:
    class Page(http.server.BaseHTTPRequestHandler):
        """Answers at one place."""

        def do_GET(self) -> None:
            self.send_response(200 if self.path == "/status" else 404)
            self.end_headers()

        def log_message(self, *_: object) -> None:
            pass

    with http.server.HTTPServer(("127.0.0.1", 0), Page) as server:
        thread = threading.Thread(target=server.handle_request)
        thread.start()
        assert answers(f"http://127.0.0.1:{server.server_port}{path}") is there
        thread.join()
    assert not answers(f"http://127.0.0.1:{free_port()}/status")
    assert not answers("127.0.0.1/status")
