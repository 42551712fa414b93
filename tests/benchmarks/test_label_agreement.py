from pathlib import Path

import pytest
from benchmarks.real.clips import LABELS
from benchmarks.real.labels.agreement import BLIND, agreement, line

from matchset.app.track.score import TruthRow, read_truth

LABELLED = [
    TruthRow(0, (10.0, 20.0, 5.0)),
    TruthRow(1, (30.0, 20.0, 6.0)),
    TruthRow(2, (50.0, 20.0, 6.0), lowconf=True),
]


def test_rows_that_both_know_well_are_compared() -> None:
    blind = [TruthRow(0, (11.0, 18.0, 5.5)), TruthRow(1, (33.0, 22.0, 6.5)), TruthRow(2, (50.0, 20.0, 6.0))]
    found = agreement(LABELLED, blind)
    assert found is not None
    assert (found.rows, found.right) == (2, 0.5)
    assert found.medians == pytest.approx((2.0, 2.0, 0.5, 4.5))


def test_without_a_common_row_nothing_is_said(tmp_path: Path) -> None:
    assert agreement(LABELLED, [TruthRow(7, (1.0, 1.0, 1.0))]) is None
    assert agreement(LABELLED, [TruthRow(2, (1.0, 1.0, 1.0))]) is None
    assert line("nothing", LABELLED, tmp_path) == ""


def test_a_line_has_a_cell_for_each_heading(tmp_path: Path) -> None:
    header = "video,frame,x,y,r,visible,method\n"
    (tmp_path / "again").mkdir()
    (tmp_path / "a.csv").write_text(f"{header}a.mp4,0,11,20,5,1,blind\n")
    assert line("a", LABELLED, tmp_path) == "| a | 1 | 100% | 1.0 | 0.0 | 0.0 | 1.0 | - | - |"
    (tmp_path / "again" / "a.csv").write_text(f"{header}a.mp4,0,11,22,5,1,blind\n")
    assert line("a", LABELLED, tmp_path) == "| a | 1 | 100% | 1.0 | 0.0 | 0.0 | 1.0 | 1 | 2.0 |"


@pytest.mark.parametrize("path", sorted(BLIND.rglob("*.csv")), ids=lambda path: f"{path.parent.name}/{path.stem}")
def test_what_was_labelled_blind_is_a_truth_file_of_rows_that_are_labelled(path: Path) -> None:
    rows = read_truth(path)
    assert rows
    assert all(row.tight for row in rows)
    labels = LABELS / path.name
    if labels.exists():
        assert {row.frame for row in rows} <= {row.frame for row in read_truth(labels) if row.tight}
