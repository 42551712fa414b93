"""What docs/sharing.md shows runs, and the figures of its tables are those of the code."""

import re
import secrets
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

import matchset as ms
from matchset.sharing.clock_offset import ExchangeParameters
from matchset.sharing.inbox import InboxParameters
from matchset.sharing.lines import LineParameters
from matchset.sharing.messages import MOST_BYTES, MOST_TARGETS
from matchset.sharing.partner import PartnerParameters
from matchset.sharing.ros2.ros_keys import ros_name
from matchset.sharing.share import ShareParameters
from matchset.sharing.shared_target import AgeParameters
from matchset.sim.clips.clip import Clip
from sharing_poses import LEVEL
from sharing_processes import LONGEST

PAGE = (Path(__file__).resolve().parents[2] / "docs" / "sharing.md").read_text(encoding="utf-8")


def test_the_program_of_the_page_runs(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    pytest.importorskip("zenoh", reason="eclipse-zenoh, the extra `net`, is not installed")
    monkeypatch.chdir(tmp_path)
    clip, key = Clip(frames=1), f"test/{secrets.token_hex(8)}"
    image = clip.render(0, clip.background()).image
    circle = clip.truth(0).circle
    assert circle is not None
    ms.ColorModel.pick(image, circle.x, circle.y).save("ball.npz")
    (code,) = re.findall(r"```python\n(.*?)```", PAGE, re.DOTALL)
    names: dict[str, Any] = {}
    with ms.Share("right", key=key) as right:

        def video(source: int) -> Iterator[ms.Frame]:
            """A camera that ends when both have seen each other."""
            assert source == 0
            end = time.monotonic() + LONGEST
            while not (names["seen"] and any(right.others())):
                assert time.monotonic() < end
                right.publish(LEVEL, time.monotonic())
                yield ms.Frame(image, time.monotonic())

        monkeypatch.setattr(ms, "Video", video)
        share = ms.Share
        monkeypatch.setattr(ms, "Share", lambda name: share(name, key=key))
        exec(compile(code, "sharing.md", "exec"), names)
        (other,) = right.others()
    partner, name, position, age = names["seen"][-1]
    assert (partner, name, position.tolist()) == ("right", "ball", LEVEL.position.tolist())
    assert -0.1 < age.seconds < 0.5
    assert (other.partner, other.shape) == ("left", "Circle")


def test_its_figures_are_those_of_the_code() -> None:
    ages, clock, partner = AgeParameters(), ExchangeParameters(), PartnerParameters()
    assert f"at most {ages.max_age:g} s is used" in PAGE
    assert f"more than ±{1e3 * ages.max_uncertainty:g} ms" in PAGE
    assert (clock.interval, clock.exchanges) == (2.0, 4)
    assert "Every two seconds each computer asks each other one four times" in PAGE
    assert f"grows by {1e3 * clock.drift:g} ms a second" in PAGE
    assert f"silent for {partner.silence:.1f} s" in PAGE
    inbox, lines, share = InboxParameters(), LineParameters(), ShareParameters()
    assert f"of each of {inbox.partners} partners the newest message waits, and of {inbox.strangers} strangers" in PAGE
    assert f"decodes {inbox.decoded // 1024} KB at most, and {inbox.targets} targets of all are kept" in PAGE
    assert f"{lines.partner} lines of one partner in {lines.period:g} s, {lines.together} of all" in PAGE
    assert f"every {share.look:g} s" in PAGE
    assert f"`ball_1` is `{ros_name('ball_1')}`, `мяч` is `{ros_name('мяч')}`" in PAGE
    assert f"{MOST_TARGETS} targets have topics at a time" in PAGE
    assert f"{MOST_TARGETS} targets and {MOST_BYTES // 1024} KB at most" in PAGE
