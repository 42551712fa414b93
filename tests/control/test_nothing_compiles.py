"""Nothing is compiled after a constructor: a flight would wait for it."""

import numpy as np
import pytest
from numba.core import event

from matchset.control.command import Command
from matchset.control.follower import Follower
from matchset.localization.pose import Pose
from matchset.tracking.track import Lost


@pytest.mark.parametrize("order", ["C", "F"])
def test_a_follower_compiles_in_its_constructor_alone(order: str) -> None:
    follower = Follower()
    with event.install_recorder("numba:compile") as recorder:
        for k in range(40):
            turn = np.array(np.diag((1.0, -1.0, -1.0)), order=order)  # type: ignore[call-overload]
            turn.flags.writeable = k % 2 == 0
            pose = Pose(
                position=np.array((0.0, 0.0, 1.5)),
                rotation_matrix=turn if k % 3 else None,
                covariance=np.array(np.diag([1e-4] * 6), order=order),  # type: ignore[call-overload]
                observed="level" if k % 3 else "position",
                time=k / 30,
            )
            answer = follower.update(pose if k % 5 else Lost[Pose]("hidden", k / 30), k / 30 + 0.067)
            follower.sent(Command(throttle=0.5 * (k > 3)), k / 30 + 0.067)
            follower.expected(k / 30 + 0.1)
    assert answer is not None
    assert recorder.buffer == []
