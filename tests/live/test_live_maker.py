"""What makes targets beside the loop, and how a program ends in which it does."""

import subprocess
import sys

import pytest

from matchset.live.targets.target_maker import TargetMaker

PROGRAM = """
import time
from matchset.live.targets.target_maker import TargetMaker, TargetMakerParameters
def make():
    time.sleep({seconds})
    print("made", flush=True)
TargetMaker(TargetMakerParameters(patience={patience})).order(make)
"""


@pytest.mark.parametrize(("seconds", "patience", "said"), [(0.3, 60.0, "made\n"), (60.0, 0.2, "")])
def test_a_program_that_ends_waits_for_what_is_made_but_not_for_long(
    seconds: float, patience: float, said: str
) -> None:
    program = PROGRAM.format(seconds=seconds, patience=patience)
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, timeout=50.0, check=True)
    assert done.stdout == said


def test_what_is_made_or_fails_is_told() -> None:
    maker: TargetMaker[int] = TargetMaker()
    assert maker.order(lambda: 7).result(60.0) == 7
    with pytest.raises(ZeroDivisionError):
        maker.order(lambda: 1 // 0).result(60.0)
    maker.close()
    maker._thread.join(60.0)
    assert not maker._thread.is_alive()
