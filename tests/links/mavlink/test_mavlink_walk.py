"""The link with an autopilot, walked at random through what may happen, against rules that stand beside it.

Others arm the vehicle and fly it, it disarms, changes its mode, refuses; the program arms, flies, cuts, lands. Whatever
the order: throttle only to a vehicle that this link armed, in the mode in which it counts; nothing to one that others
armed.
"""

import random

from fake_autopilot import LOITER, RTL, STABILIZE, FakeAutopilot

from matchset.control.command import Command
from matchset.image.errors import LinkError
from matchset.links.mavlink.client import MavlinkParameters
from matchset.links.mavlink.mavlink_link import MavlinkLink

WALKS, STEPS = 150, 60
COARSE = MavlinkParameters(poll_period=0.1, frame_period=0.1, reason_time=0.2, arm_timeout=2.2)
EVENTS = (
    *("fly", "fly", "fly", "wait", "arm", "arm", "cut", "land", "lost cut"),
    *("disarms", "leaves", "returns", "returns", "refuses", "others arm"),
)


class Walk:
    """The link, the vehicle, and what the rules say of who may fly it."""

    def __init__(self, seed: int) -> None:
        self.chance = random.Random(seed)
        self.pilot = FakeAutopilot()
        clock = self.pilot.clock
        self.link = MavlinkLink("mavlink:udpin:0.0.0.0:14550", self.pilot, COARSE, clock, clock.sleep)
        self.ours = self.foreign = self.taken = False
        self.count = self.commands = self.flown = 0

    def step(self, event: str) -> None:
        pilot, before = self.pilot, self.ours
        self.count, self.commands = len(pilot.sticks), len(pilot.asked)
        if event == "fly":
            self.link.send(Command(throttle=0.5))
        elif event == "wait":
            pilot.clock.sleep(1.1)
            self.link.status()
        elif event == "arm":
            self.arm()
        elif event == "cut":
            self.link.cut()
            assert not (self.ours and pilot.armed)
            self.ours = False
        elif event == "lost cut":
            pilot.deaf = True
            self.link.cut()
            pilot.deaf = self.ours = before = False
        elif event == "land":
            self.link.land(0.2)
            assert not (self.ours and pilot.armed) or self.taken
        elif event == "disarms":
            pilot.armed = self.ours = self.foreign = False
        elif event == "leaves":
            pilot.mode, self.taken = self.chance.choice((RTL, LOITER)), True
        elif event == "returns":
            pilot.mode = STABILIZE
        elif event == "refuses":
            pilot.refusal = "" if pilot.refusal else "PreArm: no"
        elif not pilot.armed:  # others arm
            self.tell()
            pilot.armed = self.foreign = True
        self.tell()
        self.check(before)

    def arm(self) -> None:
        try:
            self.link.arm()
        except LinkError as error:
            if not (self.foreign or self.pilot.refusal or self.pilot.armed):
                raise AssertionError(f"it did not arm: {error}") from error
            return
        assert not self.foreign
        assert not self.pilot.refusal
        self.ours, self.taken = True, False

    def tell(self) -> None:
        """Let the link hear of it before anything else happens: heartbeats are late by a second at most."""
        self.pilot.beat()
        self.link.status()
        self.ours = self.ours and self.pilot.armed

    def check(self, before: bool) -> None:
        pilot = self.pilot
        throttles = [z for _, _, z, _ in pilot.sticks[self.count :]]
        if self.foreign:
            assert throttles == []
            assert all(command == 511 for command, _ in pilot.asked[self.commands :])
            assert pilot.armed
        if any(throttles):
            self.flown += 1
            assert not self.taken
            assert self.ours or before
            assert pilot.mode == STABILIZE


def walked(seed: int) -> int:
    """How often it flew."""
    walk, events = Walk(seed), []
    for _ in range(STEPS):
        events.append(walk.chance.choice(EVENTS))
        try:
            walk.step(events[-1])
        except AssertionError as error:
            raise AssertionError(f"{events}: {error}") from error
    walk.link.close()
    assert not walk.pilot.armed or walk.foreign or walk.taken
    return walk.flown


def test_walks() -> None:
    assert sum(walked(seed) for seed in range(WALKS)) > WALKS
