"""Two computers on a wire, as two network namespaces of Linux: who finds whom, and that nobody does by default."""

import os
import shutil
import subprocess
import sys
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest

from sharing_processes import LONGEST

pytest.importorskip("zenoh", reason="eclipse-zenoh, the extra `net`, is not installed")

PROGRAM = """
import time, sys
import matchset as ms
from sharing_poses import LEVEL
with ms.Share({name!r}, key="wire", **{network!r}) as share:
    print("ready", flush=True)
    while {name!r} != "right" or not any(share.others()):
        share.publish(LEVEL, time.monotonic())
        share.wait(0.05)
    print([each.partner for each in share.others() if each], flush=True)
"""
FIRST, SECOND = 0, 1
Partner = tuple[str, int, dict[str, Any]]
"""Name, on which of the two computers, and how it shares."""
Run = Callable[..., str]


@pytest.fixture
def wire() -> Iterator[Run]:
    """Begins partners, the last of which is "right"; returns whom that one sees once it sees somebody."""
    program = shutil.which("ip")
    if program is None or os.geteuid() != 0:
        pytest.skip("network namespaces need root and iproute2")
    names = [f"ms{os.getpid()}{end}" for end in "ab"]

    def ip(*words: str, check: bool = True) -> None:
        done = subprocess.run([program, *words], capture_output=True, text=True)
        if check and done.returncode:
            pytest.skip(f"no network namespaces here: {done.stderr.strip()}")

    def run(*partners: Partner) -> str:
        made = []
        for name, computer, network in partners:
            code = PROGRAM.format(name=name, network=network)
            words = [program, "netns", "exec", names[computer], sys.executable, "-c", code]
            made.append(subprocess.Popen(words, cwd=Path(__file__).parents[1], stdout=subprocess.PIPE, text=True))
            assert made[-1].stdout is not None
            assert made[-1].stdout.readline() == "ready\n"
        out, _ = made[-1].communicate(timeout=LONGEST)
        for each in made[:-1]:
            each.kill()
            each.communicate()
        return out.strip()

    try:
        for name in names:
            ip("netns", "add", name)
        ip("link", "add", names[0], "type", "veth", "peer", "name", names[1])
        for number, name in enumerate(names, 1):
            ip("link", "set", name, "netns", name)
            ip("-n", name, "addr", "add", f"10.99.0.{number}/24", "dev", name)
            for device in (name, "lo"):
                ip("-n", name, "link", "set", device, "up")
        yield run
    finally:
        for name in names:
            ip("netns", "del", name, check=False)


def test_by_default_only_those_on_the_same_computer_are_found(wire: Run) -> None:
    assert wire(("left", FIRST, {}), ("beside", SECOND, {}), ("right", SECOND, {})) == "['beside']"


def test_on_a_network_partners_find_each_other_without_configuration(wire: Run) -> None:
    network = {"discovery": "network"}
    assert wire(("left", FIRST, network), ("right", SECOND, network)) == "['left']"


def test_an_endpoint_that_is_named_is_enough(wire: Run) -> None:
    where = ["tcp/10.99.0.1:7447"]
    assert wire(("left", FIRST, {"listen": where}), ("right", SECOND, {"connect": where})) == "['left']"
