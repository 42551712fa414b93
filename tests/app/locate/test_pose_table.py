import json
from pathlib import Path

import numpy as np

from matchset.app.locate.rows import PoseRow, pose_row, pose_table, read_poses
from matchset.localization.pose import UNOBSERVED_VARIANCE, Pose
from matchset.tracking.track import Lost

UNTURNED = np.diag((0.01, 0.02, 0.03, 1.0, 1.0, 1.0)) ** 2


def pose(turn: bool) -> Pose:
    covariance = UNTURNED.copy()
    covariance[3:, 3:] = (0.0001 if turn else UNOBSERVED_VARIANCE) * np.eye(3)
    matrix = np.diag((-1.0, 1.0, -1.0)) if turn else None
    return Pose(
        position=np.array((0.1, -0.0, 2.0)),
        rotation_matrix=matrix,
        covariance=covariance,
        observed="full" if turn else "position",
        time=0.5,
    )


def rows() -> list[PoseRow]:
    return [pose_row(0, pose(True)), pose_row(1, pose(False)), pose_row(7, Lost('gone, "far"', 0.9))]


def test_poses_are_read_back_as_they_were_written(tmp_path: Path) -> None:
    table = pose_table(tmp_path, jsonl=True)
    for row in rows():
        table.write(row)
    assert read_poses(tmp_path / "poses.csv") == rows()  # every row is on disk before the next one
    table.close()
    lines = [json.loads(line) for line in (tmp_path / "poses.jsonl").read_text().splitlines()]
    assert [line["side"] for line in lines] == [0.1, None, None]
    assert [line["reason"] for line in lines] == ["", "", 'gone, "far"']


def test_what_is_not_known_stays_empty(tmp_path: Path) -> None:
    table = pose_table(tmp_path, jsonl=False)
    for row in rows():
        table.write(row)
    table.close()
    _, full, position, lost = (tmp_path / "poses.csv").read_text().splitlines()
    assert full.startswith("0,0.5,1,0.1,0.0,2.0,0.01,0.02,0.03,0.1,0.0,2.0,0.049958,")
    assert position == "1,0.5,1,0.1,0.0,2.0,0.01,0.02,0.03,,,,,,,,,position,"
    assert lost == '7,0.9,0,,,,,,,,,,,,,,,,"gone, ""far"""'
    assert not (tmp_path / "poses.jsonl").exists()


def test_a_row_in_a_few_words() -> None:
    assert rows()[0].brief == "x  +0.100  y  +0.000  z  +2.000 m  full"
    assert rows()[2].brief == ""


def test_a_table_of_an_older_version_keeps_the_bearing_that_it_had(tmp_path: Path) -> None:
    head = "frame,time,found,x,y,z,x_std,y_std,z_std,side,height,heading,yaw,side_std,height_std,heading_std,yaw_std"
    old = f"{head},observed,reason\n1,0.5,1,0.1,0.0,2.0,0.01,0.02,0.03,,,,0.049958,,,,0.005043,position,\n"
    (tmp_path / "poses.csv").write_text(old)
    (row,) = read_poses(tmp_path / "poses.csv")
    assert row.values == {"x": 0.1, "y": 0.0, "z": 2.0, "yaw": 0.049958}
    assert row.observed == "position"
