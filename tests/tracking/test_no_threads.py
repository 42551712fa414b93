"""No call of the package starts a thread or works in another one: a frame costs one core, whatever the machine.

A library that starts a thread for each core makes the times of a frame hang on what else runs there: beside other
programs, a call waits for the slowest of its threads. Measured in a process without any variable that limits threads.
"""

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

PROGRAM = Path(__file__).with_name("no_threads_program.py")
CALLS = ("pick", "update", "detect")
SHARE, MORE = 1.2, 0.05  # processor time of all threads: at most so many times the own, and so many seconds more


@pytest.fixture(scope="module")
def found() -> dict[str, dict[str, float]]:
    """What the program printed."""
    if not Path("/proc/self/status").exists():
        pytest.skip("threads are counted in /proc, which is not here")
    free = {name: value for name, value in os.environ.items() if not name.endswith(("_NUM_THREADS", "_THREADS_NUM"))}
    done = subprocess.run([sys.executable, PROGRAM], capture_output=True, text=True, env=free, check=False)
    assert done.returncode == 0, done.stderr
    counts: dict[str, dict[str, float]] = json.loads(done.stdout)
    return counts


def test_frames_are_lost_and_found_again(found: dict[str, dict[str, float]]) -> None:
    """Otherwise only the easy half of the code was looked at."""
    assert 5 <= found["update"]["lost"] <= 30


@pytest.mark.parametrize("call", CALLS)
def test_no_thread_is_started(found: dict[str, dict[str, float]], call: str) -> None:
    assert found[call]["started"] == 0, found


@pytest.mark.parametrize("call", CALLS)
def test_no_other_thread_works(found: dict[str, dict[str, float]], call: str) -> None:
    assert found[call]["all"] <= SHARE * found[call]["own"] + MORE, found
