"""Other computers on the page: a person sees who is there, what each sees, and how old that is."""

import re
import time
from typing import Any

import pytest

import matchset as ms
from live_pages import WAIT
from matchset.sharing.sent_targets import Shareable
from sharing_poses import LEVEL
from sharing_processes import until

pytest.importorskip("zenoh", reason="eclipse-zenoh, the extra `net`, is not installed")


def test_partners_are_a_table(serve: Any, page: Any, clip: Any, tmp_path: Any) -> None:
    key = f"test/{tmp_path.parent.name}/{tmp_path.name}"
    page.goto(serve(str(clip[0]), "--share", "page", "--share-key", key))
    panel = page.locator("#sharing")
    panel.get_by_text("nobody else is here yet").wait_for(timeout=WAIT)
    assert panel.locator("h2").inner_text() == f"Shared as page ({key})"
    with ms.Share("left", key=key) as share:
        found: dict[str, Shareable] = {"ball": LEVEL, "net": ms.Lost("hidden", 0.0)}

        def seen() -> bool:
            share.publish(found, time.monotonic() - 0.05)
            page.wait_for_timeout(20)
            return panel.locator("tr").count() == 2 and "1.900" in panel.inner_text()

        until(seen)
        line = panel.locator(".partner p").inner_text()
        assert re.fullmatch(r"left \d+ ms old · clock [+-]\d+\.\d ms ±\d+\.\d\d ms", line)
        ball, net = (row.inner_text().split("\t") for row in panel.locator("tr").all())
        assert ball == ["ball", "x 0.100", "y -0.200", "z 1.900", "±0.010 m"]
        assert net == ["net", "not seen: hidden"]
        page.get_by_text("shared with left: here").wait_for(timeout=WAIT)
    panel.get_by_text("gone").first.wait_for(timeout=WAIT)
