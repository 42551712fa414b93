"""A day's worth of pictures through the server's parts on a simulated clock, and how memory grows: `growth_mb`."""

import asyncio
from typing import Any

import numpy as np

from benchmarks.common.resident_memory import resident_mb
from benchmarks.live.server import HEIGHT, RATE, WIDTH
from benchmarks.tracking.memory import growth
from matchset.image.frame import Frame
from matchset.live.vision.kept_frames import KeptFrames
from matchset.live.wire.flow import Flow
from matchset.live.wire.packet import Packet, pack
from matchset.live.wire.pictures import PictureEncoder
from matchset.live.wire.state import State, written

SAMPLES = 100
ENCODED = 50  # of so many pictures one is encoded: the encoder keeps nothing, and takes nearly all of the time


def growth_mb(count: int) -> float:
    """Pass pictures through flow, state, packets and JPEGs as a viewer makes the server do it.

    Parameters
    ----------
    count : int
        Pictures.

    Returns
    -------
    float
        Growth of this process from the second to the last tenth, MB.
    """
    return growth(asyncio.run(_sizes(count)))


async def _sizes(count: int) -> list[float]:
    flow, kept, pictures, sizes = Flow(), KeptFrames(), PictureEncoder(), []
    shared: Any = np.full((HEIGHT, WIDTH, 3), 90, np.uint8)
    for index in range(1, count + 1):
        now = index / RATE
        kept.add(index, Frame(shared.copy(), now, index))
        flow.offer(index)
        taken = flow.take(now)
        if taken is not None:
            encode = index % ENCODED == 0
            data = await pictures.picture((0, index), shared, flow.size) if encode else b"x"
            pack(Packet(taken, now, 0.02, written(State(taken, index, now, WIDTH, HEIGHT)), data))
            flow.acknowledge(taken, now + 0.02)
        if index % max(count // SAMPLES, 1) == 0:
            sizes.append(resident_mb())
    pictures.close()
    return sizes
