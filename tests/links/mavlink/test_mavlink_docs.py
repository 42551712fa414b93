"""docs/mavlink.md: its program runs, its table is that of the code, its example of a command is read."""

import re
import runpy
import time
from pathlib import Path

import pytest
from fake_autopilot import FakeAutopilot

from matchset.app.adapters.mavlink_poses import KINDS, parse_publisher
from matchset.links import connect
from matchset.links.mavlink.address import LARGEST, parse_address
from matchset.links.mavlink.mavlink_link import MavlinkLink

ROOT = Path(__file__).resolve().parents[3]
PAGE = (ROOT / "docs" / "mavlink.md").read_text(encoding="utf-8")


def test_the_table_of_the_page_is_that_of_the_code() -> None:
    filled = runpy.run_path(str(ROOT / "docs" / "site" / "mavlink_tables.py"))["filled"]
    assert filled(PAGE) == PAGE, "python docs/site/mavlink_tables.py writes it anew"


def test_the_program_of_the_page_flies_and_lands(monkeypatch: pytest.MonkeyPatch) -> None:
    pilot = FakeAutopilot()

    def link(uri: str) -> MavlinkLink:
        return MavlinkLink(uri, pilot, clock=pilot.clock, sleep=pilot.clock.sleep)

    monkeypatch.setattr(connect, "connect", link)
    monkeypatch.setattr(time, "sleep", pilot.clock.sleep)
    (program,) = re.findall(r"```python\n(.*?)```", PAGE, re.DOTALL)
    exec(compile(program, "mavlink.md", "exec"), {})
    assert max(z for _, _, z, _ in pilot.sticks) == 328
    assert (pilot.armed, pilot.closed, pilot.sticks[-1]) == (False, True, (0, 0, 0, 0))


def test_the_addresses_of_the_page_are_read() -> None:
    uris = re.findall(r"mavlink:(?:udpin|udpout|serial):[^\s`'\"]+", PAGE)
    assert len(uris) >= 6
    for uri in uris:
        parse_address(parse_publisher(uri)[0])
    assert all(f"`{name}=" in PAGE for name in LARGEST)
    assert all(f"`{kind}`" in PAGE for kind in KINDS)
