"""What is shared in tests: poses and a track."""

import numpy as np

import matchset as ms
from matchset.sharing.messages import TargetMessage
from matchset.sharing.sent_targets import Named, sent_targets, target_message

LEVEL = ms.Pose(
    position=np.array((0.1, -0.2, 1.9)),
    rotation_matrix=None,
    covariance=np.eye(6) * 1e-4,
    observed="position",
    time=2.0,
)
FULL = ms.Pose(
    position=np.array((0.1 + 1e-17, -0.2, 1 / 3)),
    rotation_matrix=np.array(((0.0, -1.0, 0.0), (1.0, 0.0, 0.0), (0.0, 0.0, 1.0))),
    covariance=np.diag((1e-4, 2e-4, 3e-4, 1e-3, 2e-3, 3e-3)) + 1e-5,
    observed="full",
    time=2.5,
    systematic_covariance=np.eye(6) * 1e-5,
)
TRACK: ms.Track[ms.Circle] = ms.Track(
    ms.Circle(70.5, 50.25, 25.0), np.diag((0.01, 0.01, np.inf)), 0.9, np.zeros((12, 2)), 2.0
)


def target_messages(found: Named, captured: float) -> list[TargetMessage]:
    """The targets of a message."""
    return [target_message(each, captured) for each in sent_targets(found)]
