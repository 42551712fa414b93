"""From pixels to packets and back: the follower's loop flies a simulated toy through the emulated firmware."""

import os

import numpy as np
import numpy.typing as npt
import pytest
from emulator import HZ
from hover import Hover

from flight import throttles
from matchset.flight.chain.pilot import PilotStep
from matchset.image.errors import LinkError
from matchset.localization.pose import Pose
from matchset.sim.world import relative_position

SECONDS = float(os.environ.get("MATCHSET_HOVER_SECONDS", "12"))  # 30: make bench-radio
SETTLED = 5.0  # s from which it must hold its place
SEED = 140


def beside(hover: Hover) -> npt.NDArray[np.float64]:
    me, other = hover.chain.truth()
    return relative_position(me, other)


def stops(hover: Hover, after: int, within: float) -> None:
    """No throttle is on the air later than `within` s after a cycle, and the motors stop."""
    late = [packet for packet in hover.board.packets if packet.cycle > after + within * HZ]
    assert late
    assert set(throttles(late)) == {0}
    assert hover.thrust < 0.01
    assert hover.chain.world.crashes or hover.falling > 0.5


def test_it_hovers_until_the_cable_is_pulled() -> None:
    with Hover(SEED) as hover:
        steps: list[PilotStep] = []
        errors = []
        for _ in range(round(SECONDS * 30)):
            steps += hover.fly(1 / 30)
            errors.append(beside(hover))
        place = hover.pilot.parameters.place
        off = np.array(errors)[round(SETTLED * 30) :] - (place.side, place.height, place.heading)
        rms = np.sqrt(np.mean(off**2, axis=0))
        seen = np.mean([isinstance(step.pose, Pose) for step in steps])
        print(
            f"rms of side, height, heading: {np.round(100 * rms, 1)} cm; ball located in {100 * seen:.1f} % of frames"
        )
        print(f"packets {len(hover.board.packets)}, heard {hover.quadcopter.heard}, missed {hover.quadcopter.missed}")
        assert hover.chain.world.crashes == []
        assert (rms < 0.1).all()
        assert seen >= 0.99
        assert hover.link.status().state == "armed"
        assert hover.link.report.bad == 0
        assert hover.board.radio.refusals == []
        assert hover.quadcopter.missed == 0

        hover.cable.pull()
        last = hover.board.last_byte
        with pytest.raises(LinkError, match="unplugged"):
            hover.link.send(steps[-1].command)
        hover.coast(0.7)
        stops(hover, last, 0.25)


def test_a_hung_firmware_stops_the_motors() -> None:
    with Hover(SEED + 1) as hover:
        hover.fly(3.0)
        assert hover.chain.world.crashes == []
        assert hover.thrust > 0.5
        hung = hover.board.cycle
        hover.board.hang("transmitter_work")
        hover.coast(1.0)  # a receiver that has lost the step of the hops needs up to half a second to find it again
        stops(hover, hung, 0.08)
