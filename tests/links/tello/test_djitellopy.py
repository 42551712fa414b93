"""The fake Tello is flown by djitellopy, so that the link is proven by something that others' programs can fly."""

import json
import socket
import subprocess
from pathlib import Path

import pytest
from fake_tello import ServedTello

ROOT = Path(__file__).resolve().parents[3]
PEERS = ROOT / ".tello"

pytestmark = pytest.mark.skipif(not (PEERS / "ready").exists(), reason="djitellopy is missing: run .ci/setup-tello")


def test_djitellopy_flies_the_fake() -> None:
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
        probe.bind(("", 0))
        states = int(probe.getsockname()[1])
    there = ServedTello(states)
    try:
        program = Path(__file__).with_name("peer_djitellopy.py")
        command = [str(PEERS / "bin" / "python"), str(program), str(there.port), str(states)]
        done = subprocess.run(command, capture_output=True, text=True, timeout=120, check=False)
    finally:
        there.close()
    assert done.returncode == 0, done.stderr[-2000:]
    seen = json.loads(done.stdout.splitlines()[-1])
    assert (seen["battery"], seen["state battery"], seen["on the floor"]) == (87, 87, 0)
    assert seen["in the air"] == 80
    assert 90 <= seen["higher"] <= 140
    assert -40 <= seen["turned"] <= -10
    assert seen["landed"] <= 10
    assert there.tello.place[1] > 0.2
    assert not there.tello.motors
    assert "rc 0 40 30 -20" in there.tello.heard
