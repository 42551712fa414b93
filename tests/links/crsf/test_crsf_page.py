"""The page for people with a transmitter module tells the truth: its program flies, its messages are the link's."""

import re
import time
from pathlib import Path

import pytest

from matchset.links import connect
from matchset.links.crsf.crsf_link import CrsfLink
from matchset.links.crsf.parameters import CrsfParameters
from radio_modules import Module

ROOT = Path(__file__).resolve().parents[3]
PAGE = (ROOT / "docs" / "crsf.md").read_text(encoding="utf-8")
SOURCE = "".join(path.read_text(encoding="utf-8") for path in sorted((ROOT / "src/matchset/links").rglob("*.py")))


def test_the_program_of_the_page_arms_turns_the_motors_and_lands(monkeypatch: pytest.MonkeyPatch) -> None:
    module, throttles = Module(), []

    def sleep(seconds: float) -> None:
        for _ in range(round(seconds / 0.001)):
            module.now += 0.001
            for link in links:
                link.module.turn()
        throttles.append(module.throttle)

    def link(uri: str) -> CrsfLink:
        links.append(CrsfLink(uri, module, module, sleep, threaded=False))
        return links[-1]

    links: list[CrsfLink] = []
    monkeypatch.setattr(connect, "connect", link)
    monkeypatch.setattr(time, "sleep", sleep)
    (program,) = re.findall(r"```python\n(.*?)```", PAGE, re.DOTALL)
    exec(compile(program, "crsf.md", "exec"), {})
    assert max(throttles) == pytest.approx(172 + 1639 * 0.2, rel=0.02)
    assert not module.armed
    assert module.closed


@pytest.mark.parametrize(
    "words",
    [
        "no module answers",
        "own frames come back",
        "another program uses it",
        "no vehicle answers",
        "the flight controller refuses, its mode is",
        "sticks command rates in mode",
        "by another transmitter, or another arm channel?",
        "it did not arm",
    ],
)
def test_the_messages_of_the_page_are_the_link_s(words: str) -> None:
    assert words in PAGE
    assert words in SOURCE


def test_the_times_of_the_page_are_the_defaults() -> None:
    parameters = CrsfParameters()
    assert (parameters.hold_after, parameters.cut_after, parameters.disarm_time) == (0.1, 0.24, 0.5)
    assert (parameters.vehicle_timeout, parameters.timeout, parameters.rate) == (2.0, 1.0, 250.0)
    for words in ("for 100 ms", "for 240 ms", "for 0.5 s", "vehicle for 2 s", "module for 1 s", "250 a second"):
        assert words in PAGE, words
