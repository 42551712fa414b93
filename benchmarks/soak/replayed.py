"""Does a recording's replay give the same answers? `replay_difference`."""

from pathlib import Path
from typing import NamedTuple

from matchset.flight.recording.reader import RecordingReader
from matchset.flight.recording.replay import Replay


class Replayed(NamedTuple):
    """What a replay has shown.

    Attributes
    ----------
    chain_steps : int
        How many the recording holds.
    step : int
        Number of the first that is wrong.
    wrong : str
        What; empty if every step came out bit for bit.
    """

    chain_steps: int
    step: int = 0
    wrong: str = ""


def replay(path: Path, flown: int, whole: bool) -> Replayed:
    """Replay a recording to its end or to the first difference.

    Parameters
    ----------
    path : Path
    flown : int
        Number of steps of the flight.
    whole : bool
        Whether the recording must hold all of them; otherwise its disk was full, and it may end in the middle.
    """
    recorded = RecordingReader(path)
    replayed, count = Replay(recorded), 0
    for chain_step in replayed:
        count += 1
        if chain_step.index != count:
            return Replayed(count, count, f"recording: step {chain_step.index} after step {count - 1}")
        if replayed.differences:
            first = replayed.differences[0]
            return Replayed(count, first.tick, f"replay: follower {first.follower}: {first.text}")
    if recorded.cut_off and whole:
        return Replayed(count, count, "recording: it ends in the middle")
    if count > flown or (whole and count < flown):
        return Replayed(count, count, f"recording: {count} of {flown} steps")
    return Replayed(count)
