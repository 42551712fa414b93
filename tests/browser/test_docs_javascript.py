"""The JavaScript of docs/live.md runs in the page."""

from typing import Any

from live_docs import HOST, block, showing
from matchset.live.record.messages import Record


def test_its_javascript_prints_and_records(browser: Any, monkeypatch: Any) -> None:
    asked = list[object]()
    with showing() as server:
        monkeypatch.setattr(server.session, "take", lambda message, page: asked.append((message, page)))
        context = browser.new_context()
        page, said = context.new_page(), list[str]()
        page.on("console", lambda message: said.append(message.text))
        page.goto(f"http://{server.host}/")
        page.evaluate(f"(async () => {{ {block('javascript').replace(HOST, server.host)} }})()")
        for _ in range(100):
            if any("circle 1" in line for line in said):
                break
            page.wait_for_timeout(50)
        context.close()
    assert any("circle 1" in line for line in said), said
    assert (Record(True), "") in asked
