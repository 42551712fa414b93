"""A flight tells what its followers see, as a program of its own; no pilot reads what others tell."""

import ast
import subprocess
import sys
from pathlib import Path
from types import SimpleNamespace

import pytest

import matchset as ms
from matchset.app.sharing_options import SharingOptions
from matchset.flight.fly.shared_flight import SharedFlight
from sharing_processes import Heard, until

PACKAGE = Path(ms.__file__).parent
MAY_SHARE = {"flight/fly/shared_flight.py", "live/sharing/shared_page.py", "app/sharing_options.py"}
"""Who may tell and hear others; ROS's types and bytes are for recordings, too."""
SMALL = "sim://chain?vehicles=3&seed=5&width=320&height=240"


def test_nobody_flies_by_what_others_tell() -> None:
    """The rule of docs/safety.md: what decides on commands does not even import what hears others."""
    users = set()
    for path in PACKAGE.rglob("*.py"):
        name = path.relative_to(PACKAGE).as_posix()
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            module = node.module or "" if isinstance(node, ast.ImportFrom) else ""
            if module.startswith("matchset.sharing.") and not module.startswith("matchset.sharing.ros2."):
                users.add(name)
    users = {name for name in users if not name.startswith("sharing/")}
    assert users - {"__init__.py", "live/sharing/state.py"} == MAY_SHARE


def test_a_flight_is_seen_by_another_program(tmp_path: Path) -> None:
    pytest.importorskip("zenoh", reason="eclipse-zenoh, the extra `net`, is not installed")
    key = f"test/{tmp_path.parent.name}/{tmp_path.name}"
    with ms.Share("watcher", key=key) as share:
        heard = Heard(share)
        words = ["fly", SMALL, "--duration", "4", "--real-time", "--share", "chain", "--share-key", key]
        flying = subprocess.Popen(
            [sys.executable, "-m", "matchset", *words], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
        )
        found: list[ms.SharedTarget] = []

        def seen() -> bool:
            found.extend(share.others())
            return len({each.name for each in found if each}) == 2

        until(seen, flying)
        out, err = flying.communicate()
        until(lambda: heard.has("chain: gone"))
    assert {each.name for each in found} == {"ball 1", "ball 2"}
    poses = [each.pose for each in found if isinstance(each.pose, ms.Pose)]
    assert all(1.0 < pose.distance < 2.5 for pose in poses)
    assert flying.returncode in (0, 1)
    assert "nobody crashed" in out
    assert "shared with watcher: here\n" in err
    assert "shared with watcher: here, 0 messages, 0 missed, its clock is known to ±" in err


def test_options_of_sharing_need_a_name() -> None:
    assert SharingOptions().opened() is None
    with pytest.raises(ValueError, match="--share-network is for what is shared: add --share NAME"):
        SharingOptions(share_network=True).opened()
    with pytest.raises(ValueError, match="--ros2 is for what is shared"):
        SharingOptions(ros2=3).opened()
    with pytest.raises(ValueError, match="got 'a/b'"):
        SharingOptions(share="a/b").opened()


class RefusingShare:
    """Refuses every number, and has something to tell of its partners."""

    def publish(self, *_: object) -> None:
        raise ValueError("this cannot be shared: it sends a damaged message")

    def news(self) -> list[str]:
        return ["left: began anew"]

    def partners(self) -> list[object]:
        return []

    def close(self) -> None:
        pass


def test_what_cannot_be_shared_never_ends_a_flight() -> None:
    said = list[str]()
    shared = SharedFlight(RefusingShare(), said.append)  # type: ignore[arg-type]
    for _ in range(3):
        shared.add(SimpleNamespace(steps=[SimpleNamespace(frame=None, now=1.0)]))  # type: ignore[arg-type]
    shared.close()
    assert [line for line in said if line.startswith("not shared")] == [
        "not shared: this cannot be shared: it sends a damaged message"
    ]
    assert said.count("shared with left: began anew") == 4
    assert len(said) == 5


class TalkingShare(RefusingShare):
    """Has much to tell at once."""

    def __init__(self) -> None:
        self.lines = [f"left: {number}" for number in range(5)]

    def publish(self, *_: object) -> None:
        pass

    def news(self) -> list[str]:
        lines, self.lines = self.lines, []
        return lines


def test_a_step_says_few_lines_and_the_end_says_the_rest() -> None:
    said, share = list[str](), TalkingShare()
    shared = SharedFlight(share, said.append, 2)  # type: ignore[arg-type]
    for expected in (2, 4):
        shared.add(SimpleNamespace(steps=[SimpleNamespace(frame=None, now=1.0)]))  # type: ignore[arg-type]
        assert len(said) == expected
    share.lines = ["left: gone"]
    shared.close()
    assert said == [*(f"shared with left: {number}" for number in range(5)), "shared with left: gone"]
