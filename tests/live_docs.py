"""docs/live.md and a server for its examples."""

import contextlib
import re
import threading
from collections.abc import Iterator
from pathlib import Path

from live_feeds import seen_of
from live_server import Served, served

DOCUMENTED = Path(__file__).resolve().parents[1] / "docs" / "live.md"
TEXT = DOCUMENTED.read_text(encoding="utf-8")
HOST = "127.0.0.1:8123"


def block(language: str) -> str:
    """The code of the page in a language."""
    (code,) = re.findall(rf"```{language}\n(.*?)```", TEXT, re.DOTALL)
    assert HOST in code
    return str(code)


@contextlib.contextmanager
def showing() -> Iterator[Served]:
    """A server that shows pictures all the time; in every other one the ball is lost."""
    ended = threading.Event()
    with served() as made:

        def show() -> None:
            number = 1
            while not ended.wait(0.003):
                made.feed.show(seen_of(number, found=number % 2 == 0))
                number += 1

        made.feed.show(seen_of(0))  # whoever joins sees a target
        thread = threading.Thread(target=show)
        thread.start()
        try:
            yield made
        finally:
            ended.set()
            thread.join()
