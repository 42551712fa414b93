"""What `track` of one ball does without: it would take half a second of every start."""

import subprocess
import sys

PROGRAM = """
import sys
import matchset.app.track.run
print([name for name in ("scipy.optimize", "scipy.sparse", "matplotlib") if name in sys.modules])
"""


def test_track_of_one_ball_loads_neither_solvers_nor_plots() -> None:
    done = subprocess.run([sys.executable, "-c", PROGRAM], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"
