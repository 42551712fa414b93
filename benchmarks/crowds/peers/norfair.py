"""norfair: a Kalman filter for both corners of a box, and distances in px, greedily assigned."""

from typing import Any

import numpy as np
from norfair import Detection as NorfairDetection
from norfair import OptimizedKalmanFilterFactory, Tracker

from benchmarks.crowds.peers.peer import Detection, Named, Step


def start(_: str, parameters: dict[str, Any]) -> Step:
    """Follow circles by the corners of their boxes; `predicted`: answer also where nothing was detected."""
    tracker = Tracker(
        distance_function="mean_euclidean",
        distance_threshold=parameters["distance_threshold"],
        hit_counter_max=parameters["hit_counter_max"],
        initialization_delay=min(parameters["initialization_delay"], parameters["hit_counter_max"] - 1),
        filter_factory=OptimizedKalmanFilterFactory(R=parameters["measurement_noise"], Q=parameters["process_noise"]),
    )

    def step(found: list[Detection]) -> list[Named]:
        detections = [
            NorfairDetection(points=np.array([[x - r, y - r], [x + r, y + r]]), data=(x, y, r)) for x, y, r, _ in found
        ]
        here = {id(each) for each in detections}
        answers: list[Named] = []
        for each in tracker.update(detections):
            if id(each.last_detection) in here:
                answers.append((int(each.id), *each.last_detection.data))
            elif parameters["predicted"]:
                (left, top), (right, bottom) = each.estimate.tolist()
                radius = max((right - left + bottom - top) / 4.0, 0.1)
                answers.append((int(each.id), (left + right) / 2.0, (top + bottom) / 2.0, radius))
        return answers

    return step
