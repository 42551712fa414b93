"""Workers of Dask that do not fit, and its page."""

import http.server
import threading
from pathlib import Path

import pytest

from batched_videos import write_balls, write_color
from blue_ball import Matchset
from dask_programs import free_port, started
from matchset.batch.workers.dask_cluster import answers

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
