"""SORT, ByteTrack and OC-SORT, written anew under Apache-2.0 in Roboflow's `trackers`."""

from typing import Any

import numpy as np
import supervision
from trackers import BIoU, ByteTrackTracker, DIoU, GIoU, IoU, OCSORTTracker, SORTTracker
from trackers.utils.state_representations import XCYCSRStateEstimator, XYXYStateEstimator

from benchmarks.crowds.peers.peer import Detection, Named, Step

KINDS = {
    "sort": SORTTracker,
    "edges": SORTTracker,
    "byte_track": ByteTrackTracker,
    "recipe_byte": ByteTrackTracker,
    "oc_sort": OCSORTTracker,
}
STATES = {"XYXY": XYXYStateEstimator, "XCYCSR": XCYCSRStateEstimator}
OVERLAPS = {"iou": IoU, "giou": GIoU, "diou": DIoU, "wide_iou": lambda: BIoU(0.5)}


def start(key: str, parameters: dict[str, Any]) -> Step:
    """Follow the boxes around circles; the support of a circle, or what its finder says, is how sure it is."""
    given = dict(parameters)
    state, overlap = STATES[given.pop("state")], OVERLAPS[given.pop("overlap")]()
    tracker = KINDS[key](frame_rate=30.0, state_estimator_class=state, iou=overlap, **given)

    def step(found: list[Detection]) -> list[Named]:
        x, y, r, sure = np.array(found, float).reshape(-1, 4).T
        boxes = np.column_stack((x - r, y - r, x + r, y + r)).astype(np.float32)
        detections = supervision.Detections(
            xyxy=boxes, confidence=sure.astype(np.float32), class_id=np.zeros(len(found), int)
        )
        named = tracker.update(detections)
        names = [] if named.tracker_id is None else named.tracker_id.tolist()
        answers: list[Named] = []
        for name, (left, top, right, bottom) in zip(names, named.xyxy.tolist(), strict=True):
            if name >= 0:
                answers.append((int(name), (left + right) / 2.0, (top + bottom) / 2.0, (right - left) / 2.0))
        return answers

    return step
